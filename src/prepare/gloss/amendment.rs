//! What stereo's albedo is off by, as a class's own fits say.

use glam::DVec3;

use super::{
    place::{OUTLIER, slopes},
    samples::Place,
};
use crate::prepare::linear::least_squares;

/// How the albedo of a class differs from what stereo made of it: a sum of 1, the albedo and the
/// square of the slope, with these factors for each channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amendment {
    pub factors: [[f64; 3]; 3],
}

impl Amendment {
    fn terms(albedo: f64, normal: DVec3) -> [f64; 3] {
        /// Beyond, a slope is a mistake or an edge.
        const STEEPEST: f64 = 0.5;
        let [p, q] = slopes(normal);
        [1.0, albedo, (p * p + q * q).min(STEEPEST * STEEPEST)]
    }

    /// Of places before and after their fit. `None` where there are too few.
    pub(super) fn new(places: &[Place], found: &[DVec3]) -> Option<Self> {
        /// Of the mean square of the terms: where a class has one albedo, the constant is enough.
        const RIDGE: f64 = 1e-4;
        let mut factors = [[0.0; 3]; 3];
        for (c, factors) in factors.iter_mut().enumerate() {
            let rows = places
                .iter()
                .map(|place| Self::terms(place.albedo[c], place.normal));
            let rows: Vec<Vec<f64>> = rows.map(|row| row.to_vec()).collect();
            let each = places.iter().zip(found);
            let off: Vec<f64> = each
                .map(|(place, found)| found[c] - place.albedo[c])
                .collect();
            let mut weights = vec![1.0; rows.len()];
            // Places in shadow, and specks, are forgotten.
            for _ in 0..4 {
                let fitted = least_squares(&rows, &weights, std::slice::from_ref(&off), RIDGE)?;
                let fitted = fitted.first()?;
                let left = |i: usize| {
                    let terms = rows[i].iter().zip(fitted);
                    off[i] - terms.map(|(term, factor)| term * factor).sum::<f64>()
                };
                let mut sizes: Vec<f64> = (0..rows.len()).map(|i| left(i).abs()).collect();
                sizes.sort_by(f64::total_cmp);
                let scale = OUTLIER * sizes[sizes.len() / 2].max(1e-6);
                for (i, weight) in weights.iter_mut().enumerate() {
                    *weight = 1.0 / (1.0 + (left(i) / scale).powi(2));
                }
                factors.copy_from_slice(fitted);
            }
        }
        Some(Self { factors })
    }

    /// A linear albedo where the surface faces along `normal`, put right.
    pub fn apply(&self, albedo: DVec3, normal: DVec3) -> DVec3 {
        let amended = |c: usize| {
            let terms = Self::terms(albedo[c], normal);
            let off: f64 = terms.iter().zip(self.factors[c]).map(|(t, f)| t * f).sum();
            // No class is that far off.
            (albedo[c] + off).clamp(0.25 * albedo[c], 2.0 * albedo[c] + 0.02)
        };
        DVec3::new(amended(0), amended(1), amended(2))
    }
}
