//! Edges that stay where they are while the light changes: orientation and strength, added up over
//! photographs whatever the sign of each.

use glam::DVec2;

/// The gradient of one step of 8 bits: what is fainter is no edge.
const FAINTEST: f32 = 1.0 / 255.0;
/// How much stronger than the middle of all pixels an edge is.
const ABOVE_NOISE: f32 = 3.0;

/// Gradients of several pictures of one size.
pub(super) struct Edges {
    pub size: [usize; 2],
    /// Sums of g gᵀ: xx, xy and yy.
    tensor: Vec<[f32; 3]>,
    /// The square of a gradient that counts by half.
    half: f32,
}

impl Edges {
    /// Of grey pictures with values in 0…1.
    pub fn new<'p>(size: [usize; 2], pictures: impl Iterator<Item = &'p [f32]>) -> Self {
        let [width, height] = size;
        let mut tensor = vec![[0.0f32; 3]; width * height];
        let mut count = 0;
        for picture in pictures {
            count += 1;
            add(&mut tensor, picture, size);
        }
        let count = count.max(1) as f32;
        tensor.iter_mut().flatten().for_each(|sum| *sum /= count);
        let mut edges = Self {
            size,
            tensor,
            half: FAINTEST * FAINTEST,
        };
        let mut strengths: Vec<f32> = (0..width * height).map(|i| edges.at(i).0).collect();
        if !strengths.is_empty() {
            let middle = strengths.len() / 2;
            let (_, &mut median, _) = strengths.select_nth_unstable_by(middle, f32::total_cmp);
            edges.half = edges.half.max(ABOVE_NOISE * ABOVE_NOISE * median);
        }
        edges
    }

    /// The difference of the tensor's eigenvalues at a pixel, which noise has little of, and the
    /// cosine and sine of twice the angle of the direction across the edge.
    fn at(&self, i: usize) -> (f32, [f32; 2]) {
        let [xx, xy, yy] = self.tensor[i];
        let (c, s) = (xx - yy, 2.0 * xy);
        let strength = c.hypot(s);
        let scale = strength.max(f32::MIN_POSITIVE).recip();
        (strength, [c * scale, s * scale])
    }

    fn saturated(&self, strength: f32) -> f32 {
        strength / (strength + self.half)
    }

    /// How much of an edge across the unit vector `across` there is at a place: its square
    /// strength. 0 outside.
    pub fn across(&self, at: DVec2, across: DVec2) -> f32 {
        let [width, height] = self.size;
        let place = at - 0.5;
        let inside = place.x >= 0.0
            && place.y >= 0.0
            && place.x < width as f64 - 1.0
            && place.y < height as f64 - 1.0;
        if !inside {
            return 0.0;
        }
        let (x, y) = (place.x as usize, place.y as usize);
        let (u, v) = ((place.x - x as f64) as f32, (place.y - y as f64) as f32);
        let mut sums = [0.0f32; 2];
        for (dx, dy, share) in [
            (0, 0, (1.0 - u) * (1.0 - v)),
            (1, 0, u * (1.0 - v)),
            (0, 1, (1.0 - u) * v),
            (1, 1, u * v),
        ] {
            let [xx, xy, yy] = self.tensor[(y + dy) * width + x + dx];
            sums[0] += share * (xx - yy);
            sums[1] += share * 2.0 * xy;
        }
        let double = DVec2::new(
            across.x * across.x - across.y * across.y,
            2.0 * across.x * across.y,
        );
        // cos² of the angle between them, of which what is more than 45° off is nothing.
        let along = sums[0] * double.x as f32 + sums[1] * double.y as f32;
        along.max(0.0)
    }

    /// As [`Self::across`], in 0…1: 1 for whatever is well above noise.
    pub fn evidence(&self, at: DVec2, across: DVec2) -> f32 {
        self.saturated(self.across(at, across))
    }

    /// Pixels on the ridges of edges: place, unit vector across, and evidence.
    pub fn ridges(&self, least: f32) -> Vec<(DVec2, DVec2, f32)> {
        let [width, height] = self.size;
        let mut found = Vec::new();
        for y in 1..height.saturating_sub(1) {
            for x in 1..width.saturating_sub(1) {
                let i = y * width + x;
                let (strength, [c, s]) = self.at(i);
                let evidence = self.saturated(strength);
                if evidence < least {
                    continue;
                }
                let angle = f64::from(s).atan2(f64::from(c)) / 2.0;
                let across = DVec2::from_angle(angle);
                let (dx, dy) = (across.x.round() as isize, across.y.round() as isize);
                let beside = dy * width as isize + dx;
                let [before, after] =
                    [-beside, beside].map(|by| self.at(i.wrapping_add_signed(by)).0);
                if strength >= before && strength > after {
                    found.push((DVec2::new(x as f64 + 0.5, y as f64 + 0.5), across, evidence));
                }
            }
        }
        found
    }
}

/// Adds one picture's gradients (Scharr's 3 × 3, per pixel), smoothed by a box of 3 × 3 first.
fn add(tensor: &mut [[f32; 3]], picture: &[f32], [width, height]: [usize; 2]) {
    if width < 5 || height < 5 || picture.len() != width * height {
        return;
    }
    let smooth = smoothed(picture, width);
    for y in 2..height - 2 {
        for x in 2..width - 2 {
            let at = |dx: isize, dy: isize| {
                smooth[(y * width + x).wrapping_add_signed(dy * width as isize + dx)]
            };
            let gx = 3.0 * (at(1, -1) + at(1, 1) - at(-1, -1) - at(-1, 1))
                + 10.0 * (at(1, 0) - at(-1, 0));
            let gy = 3.0 * (at(-1, 1) + at(1, 1) - at(-1, -1) - at(1, -1))
                + 10.0 * (at(0, 1) - at(0, -1));
            let (gx, gy) = (gx / 32.0, gy / 32.0);
            let sum = &mut tensor[y * width + x];
            sum[0] += gx * gx;
            sum[1] += gx * gy;
            sum[2] += gy * gy;
        }
    }
}

/// Means over 3 × 3 pixels; the outermost stay as they are.
fn smoothed(picture: &[f32], width: usize) -> Vec<f32> {
    let mut rows = picture.to_vec();
    for (out, row) in rows
        .chunks_exact_mut(width)
        .zip(picture.chunks_exact(width))
    {
        for x in 1..width - 1 {
            out[x] = (row[x - 1] + row[x] + row[x + 1]) / 3.0;
        }
    }
    let mut all = rows.clone();
    for i in width..rows.len() - width {
        all[i] = (rows[i - width] + rows[i] + rows[i + width]) / 3.0;
    }
    all
}
