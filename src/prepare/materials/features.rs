//! What is seen of a place that tells its material: colour, gloss and relief.
//!
//! Gloss has to be read while the photographs run through, and is kept as two bytes a pixel;
//! colour and relief are read from the solved maps.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::{
    colour::{srgb_decode, srgb_encode},
    prepare::{
        photographs::Band,
        stereo::{Rig, Solved},
    },
};

/// How many features a place has.
pub const FEATURES: usize = 8;
/// So many of them are a place's own.
pub const OWN: usize = 5;
/// So many are its own or tell of the relief around it; the others of its surroundings' colour.
pub const WITH_RELIEF: usize = 7;
/// The first ones are colours, sRGB-encoded.
const COLOURS: usize = 3;
/// How far in pixels a feature looks around.
pub const REACH: usize = 2;
/// Names of the features, in their order.
pub const NAMES: [&str; FEATURES] = [
    "red",
    "green",
    "blue",
    "gloss towards the mirror's angle",
    "what the photographs leave over",
    "unevenness of the relief",
    "hollowness of the relief",
    "unevenness of the colour",
];

/// What a camera's colours count as grey: as in stereo.
const GREY: [f32; 3] = [0.25, 0.5, 0.25];
/// How fast a lamp counts less as it stands off the mirror's angle: by half at 14°.
const NARROW: f32 = 12.0;
/// n·l below which a lamp says nothing of gloss.
const GRAZING: f32 = 0.1;
/// What is left over at which a byte's steps are half as fine as at none.
const FINE: f32 = 0.002;
/// The most that a byte tells.
const MOST: f32 = 0.5;
/// Lamps are looked up anew after so many pixels.
const TILE: usize = 32;
/// Slopes and shares of light below this are as good as even.
const EVEN: f32 = 0.004;

/// Features of a place.
pub type Features = [f32; FEATURES];

/// Gloss of all places of a side, a band after another.
#[derive(Clone, Debug, Default)]
pub struct Gloss {
    /// By how much lamps near the mirror's angle show more than the others, and the root of the
    /// mean square of all that is left over.
    codes: Vec<[u8; 2]>,
}

/// A number around 0 as a byte whose steps grow with it.
fn code(value: f32) -> u8 {
    let full = (1.0 + MOST / FINE).ln();
    let part = (1.0 + value.abs().min(MOST) / FINE).ln() / full;
    // Casts saturate, and NaN is 0.
    (127.5 + 127.5 * part * value.signum()) as u8
}

impl Gloss {
    /// Reads a band, whose light was divided out, and what it was solved to.
    pub fn add(&mut self, band: &Band, solved: &Solved, rig: &Rig) {
        let start = self.codes.len();
        self.codes.resize(start + band.rows * band.width, [0; 2]);
        let width = band.width.max(1);
        self.codes[start..]
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(row, out)| read_row(band, solved, rig, row, out));
    }
}

fn read_row(band: &Band, solved: &Solved, rig: &Rig, row: usize, out: &mut [[u8; 2]]) {
    let photographs: Vec<[&[f32]; 3]> = (0..rig.count()).map(|i| band.row(i, row)).collect();
    let mut lamps: Vec<([f32; 3], [f32; 3], f32)> = Vec::new();
    for (x, out) in out.iter_mut().enumerate() {
        if x % TILE == 0 && (x == 0 || !rig.is_uniform()) {
            let at = DVec2::new((x + TILE / 2) as f64, (band.top + row) as f64 + 0.5);
            lamps.clear();
            lamps.extend((0..rig.count()).map(|i| {
                let lit = rig.lamp(i, at);
                let half = (lit.l + DVec3::Z).normalize();
                (
                    lit.l.as_vec3().into(),
                    half.as_vec3().into(),
                    lit.gain as f32,
                )
            }));
        }
        let i = row * band.width + x;
        let n = solved.normal[i];
        let along = |v: &[f32; 3]| n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
        let albedo: f32 = (0..3).map(|c| GREY[c] * solved.albedo[c][i]).sum();
        let (mut near, mut weights, mut all, mut square, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for ((l, half, gain), shown) in lamps.iter().zip(&photographs) {
            let mu = along(l);
            if mu < GRAZING {
                continue;
            }
            let shown: f32 = (0..3).map(|c| GREY[c] * shown[c][x]).sum();
            // A cast shadow is no gloss.
            let left = (shown / gain - albedo * mu).max(-0.2 * albedo * mu);
            let off = 1.0 - along(half).powi(2);
            let weight = (-NARROW * off).exp();
            near += weight * left;
            weights += weight;
            all += left;
            square += left * left;
            count += 1.0;
        }
        *out = match count > 0.0 {
            true => [
                code(near / weights - all / count),
                code((square / count).sqrt()),
            ],
            false => [code(0.0); 2],
        };
    }
}

/// About what is seen of a place of which a medium covers `share` and bare paper the rest. Colours are mixed in light;
/// of the others, which are not linear, the mean is as near as is needed: gloss and relief of a stroke differ little
/// from those of its paper.
pub fn mixed(medium: &Features, paper: &Features, share: f32) -> Features {
    let between = |a: f32, b: f32| share * a + (1.0 - share) * b;
    let in_light = |a: f32, b: f32| {
        let [a, b] = [a, b].map(|v| srgb_decode(f64::from(v)) as f32);
        srgb_encode(f64::from(between(a, b))) as f32
    };
    std::array::from_fn(|k| match k < COLOURS {
        true => in_light(medium[k], paper[k]),
        false => between(medium[k], paper[k]),
    })
}

/// The maps that features are read from.
#[derive(Clone, Copy)]
pub struct Seen<'m> {
    pub width: usize,
    /// sRGB-encoded.
    pub albedo: &'m [[u16; 3]],
    pub normals: &'m [[f32; 3]],
    pub gloss: &'m Gloss,
}

impl Seen<'_> {
    pub fn height(&self) -> usize {
        self.albedo.len() / self.width.max(1)
    }

    /// Features of a place.
    pub fn at(&self, x: usize, y: usize) -> Features {
        let i = y * self.width + x;
        let [r, g, b] = self.albedo[i].map(|v| f32::from(v) / 65535.0);
        let [mirror, left] = self.gloss.codes[i].map(|code| f32::from(code) / 255.0);
        let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(self.height());
        let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(self.width);
        let (mut sums, mut squares, mut count) = ([0.0f32; 3], [0.0f32; 3], 0.0f32);
        let mut hollow = 0.0f32;
        for row in rows {
            let line = row * self.width;
            for column in columns.clone() {
                let i = line + column;
                let [nx, ny, nz] = self.normals[i];
                let up = 1.0 / nz.max(0.1);
                let values = [nx * up, ny * up, f32::from(self.albedo[i][1]) / 65535.0];
                for ((sum, square), value) in sums.iter_mut().zip(&mut squares).zip(values) {
                    *sum += value;
                    *square += value * value;
                }
                count += 1.0;
                // How slopes rise along x and along y, the mean of three central differences in each of three
                // rows. Normals point up the picture where rows go down it.
                let (right, down) = (column as f32 - x as f32, row as f32 - y as f32);
                if down.abs() <= 1.0 && right != 0.0 {
                    hollow -= right.signum() * values[0];
                }
                if right.abs() <= 1.0 && down != 0.0 {
                    hollow += down.signum() * values[1];
                }
            }
        }
        // At the picture's edge one side is missing.
        let whole = (2 * REACH + 1) * (2 * REACH + 1);
        // Of nine places, over two pixels each; in slope per pixel. What is no number is even, as with the others.
        let hollow = match count as usize == whole && hollow.is_finite() {
            true => hollow / 18.0,
            false => 0.0,
        };
        let variance = |c: usize| (squares[c] / count - (sums[c] / count).powi(2)).max(0.0);
        let uneven = |variance: f32| (1.0 + variance.sqrt() / EVEN).ln();
        [
            r,
            g,
            b,
            mirror,
            left,
            uneven(variance(0) + variance(1)),
            hollow.signum() * (1.0 + hollow.abs() / EVEN).ln(),
            uneven(variance(2)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_keep_order_and_sign() {
        let values = [-9.0, -0.5, -0.1, -0.01, -0.001, 0.0, 0.001, 0.01, 0.1, 0.5];
        let codes = values.map(code);
        assert!(codes.windows(2).all(|pair| pair[0] <= pair[1]), "{codes:?}");
        assert!(
            codes[1..].windows(2).all(|pair| pair[0] < pair[1]),
            "{codes:?}"
        );
        assert_eq!(code(f32::NAN), 0);
    }

    #[test]
    fn a_groove_is_hollow_and_a_ridge_is_not_whichever_way_it_runs() {
        const SIZE: usize = 13;
        /// Of their sides.
        const SLOPE: f32 = 0.2;
        let seen_of = |across: bool, height: f32| {
            let normals: Vec<[f32; 3]> = (0..SIZE * SIZE)
                .map(|i| {
                    let off = |place: usize| {
                        (place as f32 - 6.0).signum() * f32::from(u8::from(place != 6))
                    };
                    // Rises away from the middle, where `height` is 1; y points up the picture.
                    let rise = height * SLOPE;
                    let (x, y) = match across {
                        false => (-rise * off(i % SIZE), 0.0),
                        true => (0.0, rise * off(i / SIZE)),
                    };
                    let length = (x * x + y * y + 1.0).sqrt();
                    [x / length, y / length, 1.0 / length]
                })
                .collect();
            let albedo = vec![[40_000; 3]; SIZE * SIZE];
            let gloss = Gloss {
                codes: vec![[128, 0]; SIZE * SIZE],
            };
            let seen = Seen {
                width: SIZE,
                albedo: &albedo,
                normals: &normals,
                gloss: &gloss,
            };
            [seen.at(6, 6), seen.at(3, 3)].map(|features| features[OWN + 1])
        };
        // The mean of central differences over three places: both sides count twice of three.
        let curved = 2.0 * SLOPE / 3.0;
        let told = (1.0 + curved / EVEN).ln();
        for across in [false, true] {
            let [groove, beside] = seen_of(across, 1.0);
            assert!((groove - told).abs() < 0.01, "{groove} {told}");
            assert!(beside.abs() < 1e-3, "{beside}");
            let [ridge, _] = seen_of(across, -1.0);
            assert!((ridge + told).abs() < 0.01, "{ridge}");
        }
    }
}
