//! A map as a field over the sheet: its finest level, linear between the middles of texels, as the
//! renderer magnifies it. Areas are averaged by looking often.

use glam::{DAffine2, DVec2};

use crate::maps::{Level, Pyramid};

pub(super) struct Field {
    level: Level,
    channels: usize,
    uv_from_side: DAffine2,
}

impl Field {
    pub fn new(pyramid: Pyramid, uv_from_side: DAffine2) -> Option<Self> {
        Some(Self {
            channels: usize::from(pyramid.channels),
            level: pyramid.levels.into_iter().next()?,
            uv_from_side,
        })
    }

    /// The channels at a place of the side frame; absent ones are 0, and beyond its border a map
    /// goes on as it ends.
    pub fn at<const N: usize>(&self, place: DVec2) -> [f64; N] {
        let size = DVec2::new(self.level.width.into(), self.level.height.into());
        let uv = self.uv_from_side.transform_point2(place);
        let at = (uv * size - 0.5).clamp(DVec2::ZERO, size - 1.0);
        let (x, y) = (at.x as usize, at.y as usize);
        let (width, height) = (self.level.width as usize, self.level.height as usize);
        let (x_1, y_1) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
        let part = at.fract();
        let mut values = [0.0; N];
        for (c, value) in values.iter_mut().enumerate().take(self.channels) {
            let texel = |x: usize, y: usize| {
                let stored = self.level.texels.get((y * width + x) * self.channels + c);
                f64::from(stored.unwrap_or_default())
            };
            let (a, b) = (texel(x, y), texel(x_1, y));
            let top = a + (b - a) * part.x;
            let (a, b) = (texel(x, y_1), texel(x_1, y_1));
            let bottom = a + (b - a) * part.x;
            *value = top + (bottom - top) * part.y;
        }
        values
    }

    /// The same, and nothing beyond its border.
    pub fn within<const N: usize>(&self, place: DVec2) -> [f64; N] {
        let uv = self.uv_from_side.transform_point2(place);
        let inside = uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all();
        if inside { self.at(place) } else { [0.0; N] }
    }

    /// The least and the most that the first channel holds.
    pub fn range(&self) -> [f64; 2] {
        let texels = (0..self.level.texels.len()).step_by(self.channels.max(1));
        texels
            .filter_map(|i| self.level.texels.get(i))
            .map(f64::from)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            })
    }

    /// The smaller edge of a texel on the sheet, in mm.
    pub fn texel_mm(&self) -> f64 {
        let size = DVec2::new(self.level.width.into(), self.level.height.into());
        let m = self.uv_from_side.matrix2.inverse();
        let (x, y) = (m.x_axis.length() / size.x, m.y_axis.length() / size.y);
        x.min(y)
    }

    /// Unit directions on the sheet (x right, y up) of the picture's x and y.
    pub fn axes(&self) -> [DVec2; 2] {
        let m = self.uv_from_side.matrix2.inverse();
        let up = |v: DVec2| DVec2::new(v.x, -v.y).normalize_or(DVec2::X);
        [up(m.x_axis), up(-m.y_axis)]
    }
}
