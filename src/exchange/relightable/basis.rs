//! Functions of the light's direction that relightable images are written in.

use std::f64::consts::PI;

use glam::DVec3;

/// Terms of a polynomial texture map: lu², lv², lu·lv, lu, lv, 1 (T. Malzbender, D. Gelb and
/// H. Wolters, *Polynomial Texture Maps*, SIGGRAPH 2001, equation 1).
pub const PTM_TERMS: usize = 6;
/// Hemispherical harmonics up to the second order.
pub const HSH_TERMS: usize = 9;

/// A set of functions.
#[derive(Clone, Debug, PartialEq)]
pub enum Basis {
    /// Six terms.
    Ptm,
    /// So many, at most [`HSH_TERMS`].
    Hsh(usize),
    Table(Table),
}

/// Vectors of colour that were sampled at some directions, one row for the mean and one for each
/// plane of coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub samples: Samples,
    /// `[plane][sample]`, the mean first; 1 is a display's white.
    pub rows: Vec<Vec<[f64; 3]>>,
    /// The planes of luminance and of each chroma, where the vectors are not of red, green and
    /// blue.
    pub luma_chroma: Option<[usize; 3]>,
}

/// Where a table was sampled.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// At these lamps, with Gaussian weights of this width in between.
    Lamps { lamps: Vec<DVec3>, sigma: f64 },
    /// On a square grid of so many places a side over the hemisphere, folded flat as an octahedron
    /// and turned by 45°.
    Octahedron(usize),
}

/// The six terms of a polynomial texture map.
pub fn ptm(l: DVec3) -> [f64; PTM_TERMS] {
    [l.x * l.x, l.y * l.y, l.x * l.y, l.x, l.y, 1.0]
}

/// Hemispherical harmonics (P. Gautron et al., *A Novel Hemispherical Basis for Accurate and
/// Efficient Rendering*, EGSR 2004) in the order and with the signs of RTIBuilder's fitter, as
/// F. Ponchio writes them out in the presentation of Relight (Web3D 2018).
fn hsh(l: DVec3) -> [f64; HSH_TERMS] {
    let cos_theta = l.z.clamp(0.0, 1.0);
    let (sin_phi, cos_phi) = l.y.atan2(l.x).sin_cos();
    // What the polynomials have of θ, with the square root of cos θ − cos² θ.
    let arch = cos_theta - cos_theta * cos_theta;
    let root = arch.max(0.0).sqrt();
    let shifted = 2.0 * cos_theta - 1.0;
    let (cos_2phi, sin_2phi) = (
        cos_phi * cos_phi - sin_phi * sin_phi,
        2.0 * sin_phi * cos_phi,
    );
    [
        (0.5 / PI).sqrt(),
        (6.0 / PI).sqrt() * cos_phi * root,
        (1.5 / PI).sqrt() * shifted,
        (6.0 / PI).sqrt() * sin_phi * root,
        -(30.0 / PI).sqrt() * cos_2phi * arch,
        (30.0 / PI).sqrt() * cos_phi * shifted * root,
        (2.5 / PI).sqrt() * (1.0 - 6.0 * arch),
        (30.0 / PI).sqrt() * sin_phi * shifted * root,
        -(30.0 / PI).sqrt() * sin_2phi * arch,
    ]
}

impl Basis {
    /// What the mean and each term give to red, green and blue under light from `l`, a unit vector
    /// with z ≥ 0.
    pub fn weights(&self, l: DVec3) -> Vec<[f64; 3]> {
        let alike = |terms: &[f64]| {
            let rows = terms.iter().map(|term| [*term; 3]);
            std::iter::once([0.0; 3]).chain(rows).collect()
        };
        match self {
            Self::Ptm => alike(&ptm(l)),
            Self::Hsh(terms) => alike(&hsh(l)[..*terms]),
            Self::Table(table) => table.weights(l),
        }
    }
}

impl Table {
    fn weights(&self, l: DVec3) -> Vec<[f64; 3]> {
        let shares = self.samples.shares(l);
        let mut rows: Vec<[f64; 3]> = self
            .rows
            .iter()
            .map(|row| {
                let mut sum = [0.0; 3];
                for (sample, share) in &shares {
                    for (sum, value) in sum.iter_mut().zip(row[*sample]) {
                        *sum += share * value;
                    }
                }
                sum
            })
            .collect();
        if let Some([_, chroma, _]) = self.luma_chroma {
            rows[0] = rgb(rows[0]);
            for (plane, row) in rows[1..].iter_mut().enumerate() {
                // As long as there are planes of chroma, luminance and both chromas take turns.
                let own = if plane < 3 * chroma { plane % 3 } else { 0 };
                let mut vector = [0.0; 3];
                vector[own] = row[own];
                *row = rgb(vector);
            }
        }
        rows
    }
}

/// Relight's luminance and two chromas (a lossless YCoCg, the second chroma before the first) to
/// red, green and blue.
fn rgb([y, orange, green]: [f64; 3]) -> [f64; 3] {
    let g = y + green / 2.0;
    let b = y - green / 2.0 - orange / 2.0;
    [b + orange, g, b]
}

impl Samples {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Lamps { lamps, .. } => lamps.len(),
            Self::Octahedron(side) => side * side,
        }
    }

    /// The samples that say what is seen under light from `l`, and the share of each.
    fn shares(&self, l: DVec3) -> Vec<(usize, f64)> {
        match self {
            Self::Lamps { lamps, sigma } => {
                // Relative to the nearest: far from all, exponentials would be nothing.
                let squares: Vec<f64> = lamps.iter().map(|lamp| lamp.distance_squared(l)).collect();
                let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
                let weights = squares
                    .iter()
                    .map(|square| (-(square - least) / (sigma * sigma)).exp());
                let weights: Vec<f64> = weights.collect();
                let sum: f64 = weights.iter().sum();
                let shares = weights.iter().map(|weight| weight / sum).enumerate();
                shares.collect()
            }
            Self::Octahedron(side) => {
                let s = l.x.abs() + l.y.abs() + l.z.abs();
                let last = (*side - 1) as f64;
                let place = |v: f64| ((v / s + 1.0) / 2.0 * last).clamp(0.0, last);
                let (x, y) = (place(l.x + l.y), place(l.y - l.x));
                let corner = |v: f64| (v as usize).min(side - 2);
                let (left, low) = (corner(x), corner(y));
                let (dx, dy) = (x - left as f64, y - low as f64);
                let at = |x: usize, y: usize| x + y * side;
                vec![
                    (at(left, low), (1.0 - dx) * (1.0 - dy)),
                    (at(left + 1, low), dx * (1.0 - dy)),
                    (at(left, low + 1), (1.0 - dx) * dy),
                    (at(left + 1, low + 1), dx * dy),
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ over the hemisphere by the midpoint rule.
    fn integral(f: impl Fn(DVec3) -> f64) -> f64 {
        const STEPS: usize = 400;
        let mut sum = 0.0;
        for i in 0..STEPS {
            let z = (i as f64 + 0.5) / STEPS as f64;
            let sin = (1.0 - z * z).sqrt();
            for j in 0..STEPS {
                let phi = (j as f64 + 0.5) / STEPS as f64 * 2.0 * PI;
                sum += f(DVec3::new(sin * phi.cos(), sin * phi.sin(), z));
            }
        }
        sum * 2.0 * PI / (STEPS * STEPS) as f64
    }

    #[test]
    fn hemispherical_harmonics_are_orthonormal() {
        for i in 0..HSH_TERMS {
            for j in 0..=i {
                let product = integral(|l| hsh(l)[i] * hsh(l)[j]);
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 1e-4, "{i} {j}: {product}");
            }
        }
    }

    #[test]
    fn shares_add_up_and_a_sample_is_itself() {
        let lamps = vec![
            DVec3::new(0.6, 0.0, 0.8),
            DVec3::new(-0.6, 0.0, 0.8),
            DVec3::Z,
        ];
        let near = Samples::Lamps { lamps, sigma: 0.05 };
        // Far from every lamp there still is light.
        let low = DVec3::new(0.0, -1.0, 0.0);
        for samples in [near.clone(), Samples::Octahedron(5)] {
            for l in [DVec3::Z, low, DVec3::new(0.48, 0.36, 0.8)] {
                let sum: f64 = samples.shares(l).iter().map(|(_, share)| share).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{samples:?} {l}: {sum}");
            }
        }
        let own = near.shares(DVec3::new(0.6, 0.0, 0.8));
        assert!(own[0].1 > 0.999, "{own:?}");
        let middle = Samples::Octahedron(5).shares(DVec3::Z);
        assert!(middle.iter().any(|(i, share)| *i == 12 && *share > 0.999));
    }
}
