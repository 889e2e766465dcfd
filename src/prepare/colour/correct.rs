//! The correction of a camera's colours to those of a chart.
//!
//! Two models, both of degree one in exposure, so that a shadow keeps its hue: linear,
//! `rgb = M (r, g, b)`, and root-polynomial of the second degree (Finlayson, Mackiewicz & Hurlbert,
//! *IEEE Transactions on Image Processing* 24 (2015) 1460),
//! `rgb = M (r, g, b, √(rg), √(gb), √(rb))`. Which one is taken is decided on patches that were
//! left out of the fit, one after another.

use std::fmt;

use glam::{DMat3, DVec3};

use super::{
    super::{lights::symmetric_eigenvalues, linear::least_squares},
    chart::{lab_under, linear_from_lab_d50},
};
use crate::colour::delta_e00;

/// How much better the root-polynomial has to predict patches that it has not seen, in mean ΔE00
/// over that of the linear model, to be worth its curvature.
const WORTH: f64 = 0.95;
/// Keeps a fit finite where a chart says nothing.
const RIDGE: f64 = 1e-9;

/// The form of a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    Linear,
    RootPolynomial,
}

impl Model {
    pub const ALL: [Self; 2] = [Self::Linear, Self::RootPolynomial];

    fn terms(self, [r, g, b]: [f64; 3]) -> Vec<f64> {
        // Noise around black may be negative.
        let root = |x: f64, y: f64| (x.max(0.0) * y.max(0.0)).sqrt();
        match self {
            Self::Linear => vec![r, g, b],
            Self::RootPolynomial => vec![r, g, b, root(r, g), root(g, b), root(r, b)],
        }
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linear => "linear",
            Self::RootPolynomial => "root-polynomial",
        })
    }
}

/// The least extent of a chart's colours over their greatest, squared: below, they lie in a plane.
const FLATTEST: f64 = 1e-6;

/// The least extent of colours over their greatest, squared.
fn flatness(colours: &[[f64; 3]]) -> f64 {
    let mut gram = DMat3::ZERO;
    for colour in colours {
        let v = DVec3::from(*colour);
        gram += DMat3::from_cols(v * v.x, v * v.y, v * v.z);
    }
    let [low, _, high] = symmetric_eigenvalues(gram);
    // NaN is flat.
    if high > 0.0 { low / high } else { 0.0 }
}

/// A correction of linear colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    pub model: Model,
    /// For red, green and blue, a factor for each term.
    pub factors: [Vec<f64>; 3],
    /// What photographs are divided by before they are solved and corrected, where no grey card
    /// says it: what they show of a perfect diffuser, in each channel.
    pub white: [f64; 3],
}

impl Correction {
    /// What leaves colours as they are.
    pub fn none() -> Self {
        let unit = |c: usize| (0..3).map(|i| f64::from(u8::from(i == c))).collect();
        Self {
            model: Model::Linear,
            factors: std::array::from_fn(unit),
            white: [1.0; 3],
        }
    }

    /// The same for colours that were divided by what becomes white: gloss is as white as its
    /// lamp, and is told from ink by that.
    #[must_use]
    pub fn balanced(mut self) -> Self {
        let white = self.shown_white();
        let terms = self.model.terms(white);
        for row in &mut self.factors {
            row.iter_mut().zip(&terms).for_each(|(f, term)| *f *= term);
        }
        self.white = white;
        self
    }

    /// The colour that becomes white, by Newton's method.
    fn shown_white(&self) -> [f64; 3] {
        const ROUNDS: usize = 20;
        const STEP: f64 = 1e-4;
        const NEAR: f64 = 1e-9;
        let apply = |rgb: DVec3| DVec3::from(self.apply(rgb.to_array()));
        let level = 3.0 / apply(DVec3::ONE).element_sum();
        let level = if level.is_finite() && level > 0.0 {
            level
        } else {
            1.0
        };
        let mut white = DVec3::splat(level);
        for _ in 0..ROUNDS {
            let now = apply(white);
            if (now - 1.0).abs().max_element() < NEAR && white.min_element() > 0.0 {
                return white.to_array();
            }
            let step = STEP * level;
            let slope = |axis: DVec3| (apply(white + axis * step) - now) / step;
            let jacobian = DMat3::from_cols(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
            white += jacobian.inverse() * (1.0 - now);
        }
        // Of channels that say nothing of white, their level alone.
        [level; 3]
    }

    /// A linear colour, corrected; it may leave the gamut.
    pub fn apply(&self, rgb: [f64; 3]) -> [f64; 3] {
        let terms = self.model.terms(rgb);
        std::array::from_fn(|c| terms.iter().zip(&self.factors[c]).map(|(t, f)| t * f).sum())
    }

    /// Corrects planes of linear red, green and blue of one length, in place.
    pub fn apply_planes(&self, [r, g, b]: [&mut [f32]; 3]) {
        let f = |c: usize, term: usize| self.factors[c].get(term).map_or(0.0, |f| *f as f32);
        let m: [[f32; 6]; 3] = std::array::from_fn(|c| std::array::from_fn(|term| f(c, term)));
        let rooted = self.model == Model::RootPolynomial;
        for ((red, green), blue) in r.iter_mut().zip(g).zip(b) {
            let (x, y, z) = (*red, *green, *blue);
            let mut out = [0.0; 3];
            for (out, m) in out.iter_mut().zip(&m) {
                *out = m[0] * x + m[1] * y + m[2] * z;
            }
            if rooted {
                let (x, y, z) = (x.max(0.0), y.max(0.0), z.max(0.0));
                let (xy, yz, xz) = ((x * y).sqrt(), (y * z).sqrt(), (x * z).sqrt());
                for (out, m) in out.iter_mut().zip(&m) {
                    *out += m[3] * xy + m[4] * yz + m[5] * xz;
                }
            }
            [*red, *green, *blue] = out;
        }
    }
}

/// A correction and how well it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    pub correction: Correction,
    /// ΔE00 of each patch as photographed, at the exposure at which the whole chart fits best.
    pub before: Vec<f64>,
    /// ΔE00 of each patch once corrected.
    pub after: Vec<f64>,
    /// For each model, the mean ΔE00 of patches that were left out of its fit.
    pub left_out: Vec<(Model, f64)>,
}

impl Fitted {
    /// Mean ΔE00 of left-out patches, of the model that does better; infinite where it is no number.
    pub fn off(&self) -> f64 {
        let each = self.left_out.iter().map(|(_, off)| *off);
        each.fold(f64::INFINITY, f64::min)
    }
}

/// Fits both models to `measured` linear colours of patches whose CIELAB under D50 is `lab`, and
/// takes the one that predicts left-out patches better. ΔE00 is taken under the white `xy`.
///
/// `None` where the colours do not span a space: a chart under coloured light, or none at all.
pub fn fit(measured: &[[f64; 3]], lab: &[[f64; 3]], xy: [f64; 2]) -> Option<Fitted> {
    if measured.len() != lab.len() || measured.len() < 8 || flatness(measured) < FLATTEST {
        return None;
    }
    let wanted: Vec<[f64; 3]> = lab.iter().map(|lab| linear_from_lab_d50(*lab)).collect();
    let difference = |a: [f64; 3], b: [f64; 3]| delta_e00(lab_under(a, xy), lab_under(b, xy));
    let mut left_out = Vec::new();
    for model in Model::ALL {
        let mut sum = 0.0;
        for out in 0..measured.len() {
            let correction = fit_model(model, measured, &wanted, Some(out))?;
            sum += difference(correction.apply(measured[out]), wanted[out]);
        }
        left_out.push((model, sum / measured.len() as f64));
    }
    let model = match left_out[1].1 < WORTH * left_out[0].1 {
        true => Model::RootPolynomial,
        false => Model::Linear,
    };
    let correction = fit_model(model, measured, &wanted, None)?;
    let exposure = exposure(measured, &wanted);
    let pairs = || measured.iter().zip(&wanted);
    let before = pairs().map(|(m, w)| difference(m.map(|v| v * exposure), *w));
    let after = pairs().map(|(m, w)| difference(correction.apply(*m), *w));
    Some(Fitted {
        before: before.collect(),
        after: after.collect(),
        correction,
        left_out,
    })
}

/// The factor that brings `measured` nearest to `wanted`.
fn exposure(measured: &[[f64; 3]], wanted: &[[f64; 3]]) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for (m, w) in measured.as_flattened().iter().zip(wanted.as_flattened()) {
        along += m * w;
        square += m * m;
    }
    along / square
}

fn fit_model(
    model: Model,
    measured: &[[f64; 3]],
    wanted: &[[f64; 3]],
    without: Option<usize>,
) -> Option<Correction> {
    let kept: Vec<usize> = (0..measured.len())
        .filter(|i| Some(*i) != without)
        .collect();
    let rows: Vec<Vec<f64>> = kept.iter().map(|&i| model.terms(measured[i])).collect();
    // A step of light is seen as dL* ∝ Y^(−2/3) dY (CIE 15:2018): so are squares of errors.
    let weights: Vec<f64> = kept
        .iter()
        .map(|&i| (crate::colour::luminance(wanted[i]).max(0.0) + 0.01).powf(-4.0 / 3.0))
        .collect();
    let right: Vec<Vec<f64>> = (0..3)
        .map(|c| kept.iter().map(|&i| wanted[i][c]).collect())
        .collect();
    let factors = least_squares(&rows, &weights, &right, RIDGE)?;
    let [r, g, b] = <[Vec<f64>; 3]>::try_from(factors).ok()?;
    let factors = [r, g, b];
    let finite = factors.iter().flatten().all(|f| f.is_finite());
    finite.then_some(Correction {
        model,
        factors,
        white: [1.0; 3],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_balanced_corrects_as_before() {
        let linear = vec![
            vec![1.9, -0.7, -0.1],
            vec![-0.3, 1.6, -0.4],
            vec![0.1, -0.6, 1.9],
        ];
        let rooted = linear
            .iter()
            .map(|row| [row.as_slice(), &[0.2, -0.1, 0.15]].concat());
        let rooted: Vec<Vec<f64>> = rooted.collect();
        for (model, rows) in [(Model::Linear, linear), (Model::RootPolynomial, rooted)] {
            for exposure in [0.01, 1.0, 30.0] {
                let rows = rows
                    .iter()
                    .map(|row| row.iter().map(|f| f / exposure).collect());
                let rows: Vec<Vec<f64>> = rows.collect();
                let plain = Correction {
                    model,
                    factors: rows.try_into().expect("three rows"),
                    white: [1.0; 3],
                };
                let balanced = plain.clone().balanced();
                let white = DVec3::from(balanced.apply([1.0; 3]));
                assert!((white - 1.0).abs().max_element() < 1e-6, "{model} {white}");
                let colour = DVec3::new(0.3, 0.2, 0.7) * exposure;
                let by = DVec3::from(plain.apply(colour.to_array()));
                let divided = colour / DVec3::from(balanced.white);
                let off = DVec3::from(balanced.apply(divided.to_array())) - by;
                assert!(off.abs().max_element() < 1e-6, "{model} {off}");
            }
        }
    }

    #[test]
    fn without_a_white_the_level_is_left() {
        let nothing = Correction {
            factors: [vec![0.0; 3], vec![0.0; 3], vec![0.0; 3]],
            ..Correction::none()
        };
        assert_eq!(nothing.balanced().white, [1.0; 3]);
    }
}
