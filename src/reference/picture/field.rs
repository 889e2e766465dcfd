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

    /// Width and height in texels.
    pub fn size(&self) -> [usize; 2] {
        [self.level.width, self.level.height].map(|edge| edge as usize)
    }

    /// The first channel at a texel inside.
    pub fn texel(&self, [x, y]: [usize; 2]) -> f64 {
        let stored = self
            .level
            .texels
            .get((y * self.size()[0] + x) * self.channels);
        f64::from(stored.unwrap_or_default())
    }

    /// A place of the side frame in texels, their middles at whole numbers.
    pub fn in_texels(&self, place: DVec2) -> DVec2 {
        let size = DVec2::new(self.level.width.into(), self.level.height.into());
        self.uv_from_side.transform_point2(place) * size - 0.5
    }

    /// The first channel at a place in texels: the cubic B-spline with the texels as its
    /// coefficients.
    pub fn spline(&self, at: DVec2) -> f64 {
        let [width, height] = self.size();
        let most = DVec2::new(width as f64, height as f64) - 1.0;
        let at = at.clamp(DVec2::ZERO, most);
        let (cell, part) = (at.floor(), at.fract());
        let weights = |t: f64| {
            let s = 1.0 - t;
            let near = |t: f64| (4.0 + t * t * (3.0 * t - 6.0)) / 6.0;
            [s * s * s / 6.0, near(t), near(s), t * t * t / 6.0]
        };
        let index =
            |cell: f64, k: usize, edge: usize| (cell as usize + k).saturating_sub(1).min(edge - 1);
        let (across, down) = (weights(part.x), weights(part.y));
        let row = |y: usize| {
            let each = across.iter().enumerate();
            each.map(|(k, w)| w * self.texel([index(cell.x, k, width), y]))
                .sum::<f64>()
        };
        let each = down.iter().enumerate();
        each.map(|(k, w)| w * row(index(cell.y, k, height))).sum()
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
