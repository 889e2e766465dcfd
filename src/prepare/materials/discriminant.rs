//! Fisher's linear discriminant: what a network has to beat.
//!
//! Classes are normal with one covariance; all are as likely beforehand. It needs no search, and
//! its distances tell places that are like no swatch.

use super::features::{FEATURES, Features};
use crate::prepare::linear::solve_positive;

/// Shrinks the covariance towards its diagonal, where swatches say little of it.
const SHRINK: f64 = 0.02;
/// The least variance of a feature: a byte's rounding.
const LEAST_VARIANCE: f64 = 1e-6;

/// A linear discriminant.
#[derive(Clone, Debug, PartialEq)]
pub struct Discriminant {
    /// Of each class, factors of the features and a constant.
    weights: Vec<[f64; FEATURES]>,
    constants: Vec<f64>,
    means: Vec<[f64; FEATURES]>,
    inverse: Vec<Vec<f64>>,
}

impl Discriminant {
    /// Fits `classes` classes to places whose class is known, each class with one at least.
    /// `None` where they say nothing.
    pub fn fit(places: &[(Features, usize)], classes: usize) -> Option<Self> {
        let mut means = vec![[0.0; FEATURES]; classes];
        let mut counts = vec![0.0f64; classes];
        for (features, class) in places {
            counts[*class] += 1.0;
            for (mean, value) in means[*class].iter_mut().zip(features) {
                *mean += f64::from(*value);
            }
        }
        for (mean, count) in means.iter_mut().zip(&counts) {
            mean.iter_mut().for_each(|value| *value /= count.max(1.0));
        }
        // Of each class alike, however many places it has.
        let mut covariance = vec![vec![0.0; FEATURES]; FEATURES];
        for (features, class) in places {
            let off: [f64; FEATURES] =
                std::array::from_fn(|i| f64::from(features[i]) - means[*class][i]);
            let weight = 1.0 / (counts[*class] * classes as f64);
            for (row, a) in covariance.iter_mut().zip(off) {
                for (entry, b) in row.iter_mut().zip(off) {
                    *entry += weight * a * b;
                }
            }
        }
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                if i == j {
                    *entry += LEAST_VARIANCE;
                } else {
                    *entry *= 1.0 - SHRINK;
                }
            }
        }
        let unit = |i: usize| (0..FEATURES).map(|j| f64::from(u8::from(i == j))).collect();
        let units: Vec<Vec<f64>> = (0..FEATURES).map(unit).collect();
        let inverse = solve_positive(&covariance, &units)?;
        let mut weights = vec![[0.0; FEATURES]; classes];
        let mut constants = vec![0.0; classes];
        for class in 0..classes {
            for (weight, row) in weights[class].iter_mut().zip(&inverse) {
                *weight = row.iter().zip(&means[class]).map(|(a, m)| a * m).sum();
            }
            let square: f64 = weights[class]
                .iter()
                .zip(&means[class])
                .map(|(w, m)| w * m)
                .sum();
            constants[class] = -0.5 * square;
        }
        Some(Self {
            weights,
            constants,
            means,
            inverse,
        })
    }

    /// The class of a place.
    pub fn class(&self, features: &Features) -> usize {
        let score = |class: usize| {
            let terms = self.weights[class].iter().zip(features);
            self.constants[class] + terms.map(|(w, v)| w * f64::from(*v)).sum::<f64>()
        };
        let best = (0..self.weights.len()).map(|class| (class, score(class)));
        best.max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(class, _)| class)
    }

    /// Mahalanobis' squared distance of a place from a class: [`FEATURES`] on average for a place
    /// that belongs to it.
    pub fn distance(&self, features: &Features, class: usize) -> f64 {
        let off: [f64; FEATURES] =
            std::array::from_fn(|i| f64::from(features[i]) - self.means[class][i]);
        let rows = self.inverse.iter().zip(off);
        rows.map(|(row, a)| a * row.iter().zip(off).map(|(r, b)| r * b).sum::<f64>())
            .sum()
    }
}
