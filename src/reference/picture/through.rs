//! The transmission map: paper of uneven thickness.
//!
//! A map of how much light the sheet lets through does not say what differs from place to place.
//! Here it is the thickness, as in laid lines and watermarks: where twice as much light comes
//! through, the sheet is as much thinner as makes its own walk let twice as much through.

use crate::reference::{
    flux::reflectance_transmittance,
    walk::{Absorption, Layers},
};

/// Thicknesses that are walked, as powers of 2 of the sheet's own.
const POWERS: [f64; 7] = [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5];
/// Natural logarithms of the thickness beyond which none is looked for.
const LN_MOST: f64 = 1.4;

/// How thick paper is that lets through more or less than the sheet does on average.
pub(super) struct Thinner {
    /// ln(T(kd)/T(d)) = a ln k + b ln² k: the walks' transmittances, fitted.
    a: f64,
    b: f64,
    /// What the map says on average.
    mean: f64,
}

impl Thinner {
    pub fn new(layers: &Layers, sigma_a: f64, mean: f64, paths: u64, seed: u64) -> Self {
        let grey = Absorption {
            sigma_a,
            ..Absorption::NONE
        };
        let points = POWERS.map(|power| {
            let x = power * std::f64::consts::LN_2;
            let layers = Layers {
                thickness_mm: layers.thickness_mm * x.exp(),
                ..*layers
            };
            let flux = reflectance_transmittance(&layers, &[grey], 1.0, paths, seed);
            (x, flux[0].transmitted.mean.max(1e-9).ln())
        });
        // Least squares with powers that lie evenly about 0: odd and even terms do not mix.
        let count = points.len() as f64;
        let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(x, y)| of(x, y)).sum::<f64>();
        let (x_2, x_4) = (sum(&|x, _| x * x), sum(&|x, _| x.powi(4)));
        let a = sum(&|x, y| x * y) / x_2;
        let (y, x_2_y) = (sum(&|_, y| y), sum(&|x, y| x * x * y));
        let b = (x_2_y - x_2 * y / count) / (x_4 - x_2 * x_2 / count);
        Self { a, b, mean }
    }

    /// Thickness over the sheet's own where the map says `clear`.
    pub fn thickness(&self, clear: f64) -> f64 {
        let wanted = (clear.max(1e-6) / self.mean.max(1e-3)).ln();
        let mut x = wanted / self.a;
        for _ in 0..8 {
            let slope = self.a + 2.0 * self.b * x;
            if slope >= 0.0 {
                break;
            }
            x -= (self.a * x + self.b * x * x - wanted) / slope;
        }
        if x.is_finite() {
            x.clamp(-LN_MOST, LN_MOST).exp()
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::phase::Phase;

    #[test]
    fn half_the_light_comes_through_the_thickness_that_is_found_for_it() {
        // Of the fit and of both walks.
        const FOUND: f64 = 0.04;
        let layers = Layers {
            n: 1.5,
            alpha: [0.5; 2],
            sigma_s: 60.0,
            phase: Phase::ISOTROPIC,
            thickness_mm: 0.1,
        };
        let thinner = Thinner::new(&layers, 0.3, 0.4, 60_000, 1);
        let transmitted = |clear: f64| {
            let layers = Layers {
                thickness_mm: layers.thickness_mm * thinner.thickness(clear),
                ..layers
            };
            let grey = Absorption {
                sigma_a: 0.3,
                ..Absorption::NONE
            };
            reflectance_transmittance(&layers, &[grey], 1.0, 100_000, 2)[0]
                .transmitted
                .mean
        };
        let whole = transmitted(0.4);
        for share in [0.6, 0.8, 1.4] {
            let found = transmitted(0.4 * share) / whole;
            assert!((found / share - 1.0).abs() < FOUND, "{share}: {found}");
        }
        for bad in [0.0, -1.0, 1e9, f64::NAN] {
            let thickness = thinner.thickness(bad);
            assert!(thickness > 0.2 && thickness < 5.0, "{bad}: {thickness}");
        }
    }
}
