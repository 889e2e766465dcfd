//! A small network with one hidden layer, fitted by Levenberg and Marquardt's method.
//!
//! y = softmax(W₂ tanh(W₁ x)), each layer with a constant input, x the features over their spread.
//! What is made least is the sum of squares of what the outputs miss (1 for a place's class, 0
//! for the others), as in the article's network, plus a little of the weights' own, which keeps
//! classes that are far apart from growing without end. The method: Hagan & Menhaj, *IEEE
//! Transactions on Neural Networks* 5 (1994) 989.

use rand::{RngExt as _, SeedableRng, rngs::Xoshiro256PlusPlus};
use rayon::prelude::*;

use super::features::{FEATURES, Features};
use crate::prepare::linear::solve_positive;

/// Neurons of the hidden layer.
pub const HIDDEN: usize = 8;
/// Steps at most.
const STEPS: usize = 40;
/// Share of the weights' squares, for each place.
const DECAY: f64 = 1e-4;
/// A step that makes the sum less by a smaller share is the last.
const STILL: f64 = 1e-4;
/// Damping at the start, the factor by which it falls and rises, and the most there may be.
const DAMPING: f64 = 1e-2;
const FACTOR: f64 = 10.0;
const MOST_DAMPING: f64 = 1e8;
/// Places whose products are summed together.
const CHUNK: usize = 64;

/// Inputs of a neuron of the hidden layer and of the last one.
const INPUTS: usize = FEATURES + 1;
const INNER: usize = HIDDEN + 1;

/// A network.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    classes: usize,
    middle: [f64; FEATURES],
    spread: [f64; FEATURES],
    /// Rows of W₁, then of W₂, each with its constant last.
    weights: Vec<f64>,
}

/// Values within.
struct Passed {
    x: [f64; INPUTS],
    hidden: [f64; INNER],
    y: Vec<f64>,
}

impl Network {
    /// Fits `classes` classes to places whose class is known, from a start by `seed`.
    pub fn fit(places: &[(Features, usize)], classes: usize, seed: u64) -> Self {
        let mut network = Self::start(places, classes, seed);
        let mut damping = DAMPING;
        let mut sum = network.sum(places);
        for _ in 0..STEPS {
            let (gram, gradient) = network.normal_equations(places);
            let mut taken = false;
            let mut gained = 0.0;
            while damping < MOST_DAMPING {
                let mut damped = gram.clone();
                for (i, row) in damped.iter_mut().enumerate() {
                    row[i] += damping * row[i].max(1e-9);
                }
                let step = solve_positive(&damped, std::slice::from_ref(&gradient));
                let next = step.and_then(|steps| steps.into_iter().next()).map(|step| {
                    let weights = network.weights.iter().zip(step);
                    Self {
                        weights: weights.map(|(w, s)| w - s).collect(),
                        ..network.clone()
                    }
                });
                if let Some(next) = next {
                    let less = next.sum(places);
                    if less < sum {
                        gained = (sum - less) / sum;
                        (network, sum, taken) = (next, less, true);
                        damping = (damping / FACTOR).max(1e-12);
                        break;
                    }
                }
                damping *= FACTOR;
            }
            if !taken || gained < STILL {
                break;
            }
        }
        network
    }

    fn start(places: &[(Features, usize)], classes: usize, seed: u64) -> Self {
        let count = places.len().max(1) as f64;
        let mut middle = [0.0; FEATURES];
        let mut spread = [0.0; FEATURES];
        for (features, _) in places {
            for (mean, value) in middle.iter_mut().zip(features) {
                *mean += f64::from(*value) / count;
            }
        }
        for (features, _) in places {
            for i in 0..FEATURES {
                spread[i] += (f64::from(features[i]) - middle[i]).powi(2) / count;
            }
        }
        // Not finer than a byte tells.
        let spread = spread.map(|variance: f64| variance.sqrt().max(1e-3));
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut within = |bound: f64| (2.0 * random.random::<f64>() - 1.0) * bound;
        // Small enough that no neuron is saturated.
        let first = (0..HIDDEN * INPUTS).map(|_| within(1.0 / (INPUTS as f64).sqrt()));
        let mut weights: Vec<f64> = first.collect();
        weights.extend((0..classes * INNER).map(|_| within(1.0 / (INNER as f64).sqrt())));
        Self {
            classes,
            middle,
            spread,
            weights,
        }
    }

    fn pass(&self, features: &Features) -> Passed {
        let mut x = [1.0; INPUTS];
        for i in 0..FEATURES {
            x[i] = (f64::from(features[i]) - self.middle[i]) / self.spread[i];
        }
        let (first, second) = self.weights.split_at(HIDDEN * INPUTS);
        let dot = |row: &[f64], v: &[f64]| row.iter().zip(v).map(|(a, b)| a * b).sum::<f64>();
        let mut hidden = [1.0; INNER];
        for (out, row) in hidden.iter_mut().zip(first.chunks_exact(INPUTS)) {
            *out = dot(row, &x).tanh();
        }
        let mut y: Vec<f64> = second
            .chunks_exact(INNER)
            .map(|row| dot(row, &hidden))
            .collect();
        let most = y.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        y.iter_mut().for_each(|v| *v = (*v - most).exp());
        let all: f64 = y.iter().sum();
        y.iter_mut().for_each(|v| *v /= all);
        Passed { x, hidden, y }
    }

    fn decay(&self, places: &[(Features, usize)]) -> f64 {
        DECAY * places.len() as f64
    }

    fn sum(&self, places: &[(Features, usize)]) -> f64 {
        let missed = |(features, class): &(Features, usize)| {
            let y = self.pass(features).y;
            let each = y.iter().enumerate();
            each.map(|(k, y)| (y - f64::from(u8::from(k == *class))).powi(2))
                .sum::<f64>()
        };
        // Summed in a fixed order, so that two runs agree to the last bit.
        let chunks: Vec<f64> = places
            .par_chunks(CHUNK)
            .map(|chunk| chunk.iter().map(missed).sum())
            .collect();
        let own: f64 = self.weights.iter().map(|w| w * w).sum();
        chunks.iter().sum::<f64>() + self.decay(places) * own
    }

    /// JᵀJ and Jᵀe, the decay included.
    fn normal_equations(&self, places: &[(Features, usize)]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let count = self.weights.len();
        let of_chunk = |chunk: &[(Features, usize)]| {
            let mut gram = vec![0.0; count * count];
            let mut gradient = vec![0.0; count];
            let mut row = vec![0.0; count];
            for (features, class) in chunk {
                let passed = self.pass(features);
                for k in 0..self.classes {
                    self.slopes(&passed, k, &mut row);
                    let missed = passed.y[k] - f64::from(u8::from(k == *class));
                    for i in 0..count {
                        gradient[i] += row[i] * missed;
                        let (a, line) = (row[i], &mut gram[i * count..i * count + i + 1]);
                        for (entry, b) in line.iter_mut().zip(&row) {
                            *entry += a * b;
                        }
                    }
                }
            }
            (gram, gradient)
        };
        let parts: Vec<(Vec<f64>, Vec<f64>)> = places
            .par_chunks((places.len().div_ceil(16)).max(CHUNK))
            .map(of_chunk)
            .collect();
        let decay = self.decay(places);
        let mut gram = vec![vec![0.0; count]; count];
        let mut gradient: Vec<f64> = self.weights.iter().map(|w| decay * w).collect();
        for (part, along) in &parts {
            for i in 0..count {
                gradient[i] += along[i];
                for j in 0..=i {
                    gram[i][j] += part[i * count + j];
                }
            }
        }
        // Only one half was added up.
        for i in 0..count {
            let (above, rest) = gram.split_at_mut(i);
            rest[0][i] += decay;
            for (row, value) in above.iter_mut().zip(&rest[0]) {
                row[i] = *value;
            }
        }
        (gram, gradient)
    }

    /// Derivatives of output `k` by each weight.
    fn slopes(&self, passed: &Passed, k: usize, out: &mut [f64]) {
        let Passed { x, hidden, y } = passed;
        let second = &self.weights[HIDDEN * INPUTS..];
        let by_sum = |j: usize| y[k] * (f64::from(u8::from(j == k)) - y[j]);
        let (of_first, of_second) = out.split_at_mut(HIDDEN * INPUTS);
        let mut back = [0.0; HIDDEN];
        for (j, row) in of_second.chunks_exact_mut(INNER).enumerate() {
            let slope = by_sum(j);
            for (out, value) in row.iter_mut().zip(hidden) {
                *out = slope * value;
            }
            for (back, weight) in back.iter_mut().zip(&second[j * INNER..]) {
                *back += slope * weight;
            }
        }
        for (h, row) in of_first.chunks_exact_mut(INPUTS).enumerate() {
            let slope = back[h] * (1.0 - hidden[h] * hidden[h]);
            for (out, value) in row.iter_mut().zip(x) {
                *out = slope * value;
            }
        }
    }

    /// How much a place looks like each class; their sum is 1.
    pub fn shares(&self, features: &Features) -> Vec<f64> {
        self.pass(features).y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken_for(network: &Network, features: &Features) -> usize {
        let shares = network.shares(features).into_iter().enumerate();
        let best = shares.max_by(|a, b| a.1.total_cmp(&b.1));
        best.expect("a class").0
    }

    fn places(
        classes: usize,
        of: impl Fn(usize, f64, f64) -> Option<usize>,
    ) -> Vec<(Features, usize)> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
        (0..400)
            .filter_map(|i| {
                let mut features = [0.5; FEATURES];
                features[0] = random.random();
                features[1] = random.random();
                let class = of(i, f64::from(features[0]), f64::from(features[1]))?;
                assert!(class < classes);
                Some((features, class))
            })
            .collect()
    }

    #[test]
    fn derivatives_are_those_of_the_outputs() {
        const STEP: f64 = 1e-6;
        let places = places(3, |i, _, _| Some(i % 3));
        let network = Network::start(&places, 3, 1);
        let features = &places[7].0;
        let mut row = vec![0.0; network.weights.len()];
        for k in 0..3 {
            network.slopes(&network.pass(features), k, &mut row);
            for (i, derivative) in row.iter().enumerate() {
                let moved = |by: f64| {
                    let mut moved = network.clone();
                    moved.weights[i] += by;
                    moved.pass(features).y[k]
                };
                let slope = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
                assert!(
                    (slope - derivative).abs() < 1e-8,
                    "{k} {i}: {slope} {derivative}"
                );
            }
        }
    }

    #[test]
    fn it_learns_what_no_line_divides() {
        let crossed = |_: usize, x: f64, y: f64| Some(usize::from((x < 0.5) == (y < 0.5)));
        let places = places(2, crossed);
        let network = Network::fit(&places, 2, 3);
        let right = places
            .iter()
            .filter(|(f, class)| taken_for(&network, f) == *class);
        let share = right.count() as f64 / places.len() as f64;
        assert!(share > 0.97, "{share}");
        let line = super::super::discriminant::Discriminant::fit(&places, 2).expect("a line");
        let right = places.iter().filter(|(f, class)| line.class(f) == *class);
        // The adversary: a line must not.
        assert!((right.count() as f64 / places.len() as f64) < 0.75);
    }
}
