//! A pixel's function of the light's direction → its normal and albedo.
//!
//! | symbol | meaning |
//! |---|---|
//! | `l` | unit vector towards the light |
//! | `n` | unit normal |
//! | `a` | coefficients of lu², lv², lu·lv, lu, lv, 1 |
//! | `g` | normal times albedo: Lambert's law is g · l |

use glam::{DMat3, DVec2, DVec3};

use super::{Colours, Relightable, basis};
use crate::{
    colour::{luminance, srgb_decode},
    prepare::lights,
};

/// Light is compared with Lambert's law from straight above down to this elevation in degrees,
/// where a surface that is less steep than this lies in no shadow of its own.
const LOWEST_DEG: f64 = 45.0;
/// Rings of directions, and how many are on the first; each further ring has as many more.
const RINGS: usize = 3;
const ON_FIRST: usize = 8;
/// A brightest direction that is farther from straight above, as the sine, is no normal: the
/// polynomial rises to the horizon.
const STEEPEST: f64 = 0.97;
/// Surfaces as dark as this have no direction.
const DARKEST: f64 = 1e-6;

/// What all pixels of an image have in common.
pub struct Solver {
    /// Coefficients of luminance, constant first, at each direction.
    luma: Vec<Vec<f64>>,
    /// Light at the directions → g.
    fit: Vec<DVec3>,
    /// Coefficients of red, green and blue under light from straight above.
    above: [Vec<f64>; 3],
    quadratic: bool,
    colours: Colours,
}

/// A pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    pub normal: DVec3,
    /// Linear sRGB, lit straight on.
    pub albedo: [f64; 3],
    /// False where the pixel's polynomial has no brightest direction and Lambert's law stood in.
    pub has_brightest: bool,
}

/// Directions all around, straight above first.
fn directions() -> Vec<DVec3> {
    let rings = (1..=RINGS).flat_map(|ring| {
        let elevation = 90.0 - (90.0 - LOWEST_DEG) * ring as f64 / RINGS as f64;
        let count = ON_FIRST * ring;
        (0..count).map(move |i| {
            let azimuth = 360.0 * (i as f64 + 0.5 * (ring % 2) as f64) / count as f64;
            lights::direction(azimuth, elevation)
        })
    });
    std::iter::once(DVec3::Z).chain(rings).collect()
}

impl Solver {
    pub fn new(image: &Relightable) -> Self {
        let directions = directions();
        // The symmetric matrix Σ l lᵀ; directions span space, so it has an inverse.
        let gram = directions.iter().fold(DMat3::ZERO, |sum, l| {
            sum + DMat3::from_cols(*l * l.x, *l * l.y, *l * l.z)
        });
        let inverse = gram.inverse();
        let luma = directions.iter().map(|l| {
            let [r, g, b] = channels(image, *l);
            let of = r.iter().zip(&g).zip(&b);
            of.map(|((r, g), b)| luminance([*r, *g, *b])).collect()
        });
        Self {
            luma: luma.collect(),
            fit: directions.iter().map(|l| inverse * *l).collect(),
            above: channels(image, DVec3::Z),
            quadratic: image.basis == basis::Basis::Ptm,
            colours: image.colours,
        }
    }

    /// Solves the pixel with these coefficients. Values that are no numbers are flat and black.
    pub fn solve(&self, planes: &[f64]) -> Solved {
        let tint = match self.colours {
            Colours::Luminance => [0, 1, 2].map(|c| planes[planes.len() - 3 + c]),
            Colours::Each | Colours::Together => [1.0; 3],
        };
        let linear =
            |encoded: [f64; 3]| [0, 1, 2].map(|c| srgb_decode((encoded[c] * tint[c]).max(0.0)));
        if let Some(normal) = self.brightest(planes) {
            let albedo = linear(self.polynomials(planes, normal));
            return Solved {
                normal,
                albedo: albedo.map(sound),
                has_brightest: true,
            };
        }
        let (normal, strength) = self.lambert(planes);
        let above = self.above.each_ref().map(|weights| sum(weights, planes));
        // As bright as Lambert's law says, and of the colour that it has from straight above.
        let own = match self.colours {
            Colours::Luminance => srgb_decode(above[0].max(0.0)),
            Colours::Each | Colours::Together => luminance(linear(above)),
        };
        let factor = if own > DARKEST { strength / own } else { 0.0 };
        Solved {
            normal,
            albedo: linear(above).map(|v| sound(v * factor)),
            has_brightest: !self.quadratic,
        }
    }

    /// What the polynomials of red, green and blue are under light from `l`.
    fn polynomials(&self, planes: &[f64], l: DVec3) -> [f64; 3] {
        let terms = basis::ptm(l);
        let value = |channel: usize| {
            let coefficient = |k: usize| match self.colours {
                Colours::Luminance | Colours::Together => planes[k],
                Colours::Each => planes[3 * k + channel],
            };
            terms
                .iter()
                .enumerate()
                .map(|(k, t)| coefficient(k) * t)
                .sum()
        };
        [value(0), value(1), value(2)]
    }

    /// The coefficients of luminance of a polynomial.
    fn quadratic_of(&self, planes: &[f64]) -> [f64; basis::PTM_TERMS] {
        std::array::from_fn(|k| match self.colours {
            Colours::Luminance => planes[k],
            _ => luminance([planes[3 * k], planes[3 * k + 1], planes[3 * k + 2]]),
        })
    }

    /// The direction from which a polynomial is brightest (Malzbender et al. 2001, equations 16 to
    /// 18), which is the normal of a matte surface; `None` where there is none above the sheet.
    fn brightest(&self, planes: &[f64]) -> Option<DVec3> {
        if !self.quadratic {
            return None;
        }
        let a = self.quadratic_of(planes);
        let determinant = 4.0 * a[0] * a[1] - a[2] * a[2];
        if !(a[0] < 0.0 && determinant > 0.0) {
            return None;
        }
        let top = DVec2::new(
            a[2] * a[4] - 2.0 * a[1] * a[3],
            a[2] * a[3] - 2.0 * a[0] * a[4],
        ) / determinant;
        let n = top.extend((1.0 - top.length_squared()).max(0.0).sqrt());
        (top.length() < STEEPEST).then_some(n)
    }

    /// Normal and strength of Lambert's law that is nearest to the function in linear light.
    fn lambert(&self, planes: &[f64]) -> (DVec3, f64) {
        let g = self
            .luma
            .iter()
            .zip(&self.fit)
            .fold(DVec3::ZERO, |g, (weights, fit)| {
                g + *fit * srgb_decode(sum(weights, planes).max(0.0))
            });
        let length = g.length();
        if length.is_finite() && length > DARKEST && g.z > 0.0 {
            (g / length, length)
        } else {
            (DVec3::Z, 0.0)
        }
    }
}

/// The constant and the coefficients of all planes for red, green and blue under light from `l`.
fn channels(image: &Relightable, l: DVec3) -> [Vec<f64>; 3] {
    let weights = image.basis.weights(l);
    let of = |channel: usize| {
        let mut all = vec![0.0; image.planes + 1];
        all[0] = weights[0][channel];
        for (term, weight) in weights[1..].iter().enumerate() {
            let plane = match image.colours {
                Colours::Luminance | Colours::Together => term,
                Colours::Each => 3 * term + channel,
            };
            all[1 + plane] = weight[channel];
        }
        all
    };
    [of(0), of(1), of(2)]
}

/// A number, whatever overflowed on the way to it.
fn sound(v: f64) -> f64 {
    if v.is_finite() { v } else { 0.0 }
}

fn sum(weights: &[f64], planes: &[f64]) -> f64 {
    weights[0]
        + weights[1..]
            .iter()
            .zip(planes)
            .map(|(w, p)| w * p)
            .sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{colour::srgb_encode, exchange::relightable::basis::Basis};

    fn image(basis: Basis, colours: Colours, planes: usize) -> Relightable {
        Relightable {
            size: [1, 1],
            basis,
            colours,
            planes,
        }
    }

    fn degrees(a: DVec3, b: DVec3) -> f64 {
        a.angle_between(b).to_degrees()
    }

    #[test]
    fn a_polynomial_with_a_known_top_has_it_as_normal() {
        let solver = Solver::new(&image(Basis::Ptm, Colours::Luminance, 9));
        for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-0.5, 0.4)] {
            // −(lu − x)² − 2 (lv − y)² + ½ (lu − x)(lv − y) + 0.9, multiplied out.
            let planes = [
                -1.0,
                -2.0,
                0.5,
                2.0 * x - 0.5 * y,
                4.0 * y - 0.5 * x,
                0.9 - x * x - 2.0 * y * y + 0.5 * x * y,
                0.8,
                0.6,
                0.4,
            ];
            let solved = solver.solve(&planes);
            let expected = DVec3::new(x, y, f64::sqrt(1.0 - x * x - y * y));
            assert!(degrees(solved.normal, expected) < 1e-5);
            assert!(solved.has_brightest);
            // 0.9 of white there, in a colour.
            let white = srgb_decode(0.9);
            let encoded = solved.albedo.map(srgb_encode);
            assert!(solved.albedo[0] < white, "{encoded:?}");
            assert!(encoded[0] > encoded[1] && encoded[1] > encoded[2]);
        }
    }

    #[test]
    fn a_saddle_and_no_numbers_are_still_normals() {
        let solver = Solver::new(&image(Basis::Ptm, Colours::Luminance, 9));
        let saddle = [1.0, -1.0, 0.0, 0.3, 0.0, 0.5, 1.0, 1.0, 1.0];
        let solved = solver.solve(&saddle);
        assert!(!solved.has_brightest && solved.normal.z > 0.5 && solved.normal.x > 0.0);
        for broken in [[f64::NAN; 9], [0.0; 9], [-1e300; 9], [1e300; 9]] {
            let solved = solver.solve(&broken);
            assert!((solved.normal.length() - 1.0).abs() < 1e-9, "{broken:?}");
            assert!(solved.albedo.iter().all(|v| v.is_finite()), "{broken:?}");
        }
    }

    /// The table of Lambert's law at a grid of directions: three planes are g, the fourth nothing.
    #[test]
    fn a_function_that_is_lamberts_law_gives_its_normal_and_albedo() {
        let n = DVec3::new(0.35, -0.2, 1.0).normalize();
        let albedo = [0.7, 0.5, 0.3];
        let lamps: Vec<DVec3> = directions();
        // One row holds the whole function as its mean.
        let seen = |l: &DVec3| albedo.map(|a| srgb_encode(a * n.dot(*l).max(0.0)));
        let table = basis::Table {
            rows: vec![
                lamps.iter().map(seen).collect(),
                vec![[0.0; 3]; lamps.len()],
            ],
            samples: basis::Samples::Lamps { lamps, sigma: 0.01 },
            luma_chroma: None,
        };
        let solver = Solver::new(&image(Basis::Table(table), Colours::Together, 1));
        let solved = solver.solve(&[0.0]);
        let off = degrees(solved.normal, n);
        assert!(off < 0.5, "{off}°");
        for (found, given) in solved.albedo.iter().zip(albedo) {
            assert!((found - given).abs() < 0.01, "{:?}", solved.albedo);
        }
    }
}
