//! Numbers that heights are computed in.

use rayon::prelude::*;
use rustfft::FftNum;

/// What heights are computed in: f64, or f32, which takes half the memory and half the time where a
/// millionth of their range is enough.
pub trait Real: FftNum + Default + PartialOrd {
    /// The nearest of its values.
    fn of(value: f64) -> Self;
    fn wide(self) -> f64;
    /// Slopes as they are stored, in the same memory where it can be.
    fn of_all(values: Vec<f32>) -> Vec<Self>;
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn wide(self) -> f64 {
        self
    }

    fn of_all(values: Vec<f32>) -> Vec<Self> {
        values.par_iter().map(|value| Self::from(*value)).collect()
    }
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }

    fn wide(self) -> f64 {
        self.into()
    }

    fn of_all(values: Vec<f32>) -> Vec<Self> {
        values
    }
}
