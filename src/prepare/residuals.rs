//! What the photographs of a side leave over, counted.

/// Steps of a share of 1.
const STEPS: usize = 1000;

/// What the photographs leave over at each place, as shares of their mean, counted in steps of a
/// thousandth; the last step holds all that is 1 or more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Residuals {
    counts: Vec<u64>,
}

impl Default for Residuals {
    fn default() -> Self {
        Self {
            counts: vec![0; STEPS + 1],
        }
    }
}

impl Residuals {
    pub fn add(&mut self, residual: f32) {
        // Casts saturate, and NaN counts as none.
        let step = ((residual * STEPS as f32) as usize).min(STEPS);
        self.counts[step] += 1;
    }

    /// The share that this share of all places stays within; 0 where there are none.
    pub fn quantile(&self, share: f64) -> f64 {
        let wanted = share * self.all() as f64;
        let mut sum = 0;
        for (step, count) in self.counts.iter().enumerate() {
            sum += count;
            if sum as f64 >= wanted {
                return step as f64 / STEPS as f64;
            }
        }
        1.0
    }

    /// How many places there are.
    pub fn all(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The shares of all places in `bins` of `width` thousandths each, from 0 on, and what lies
    /// beyond them.
    pub fn shares(&self, width: usize, bins: usize) -> (Vec<f64>, f64) {
        let all = self.all().max(1) as f64;
        let of = |counts: &[u64]| counts.iter().sum::<u64>() as f64 / all;
        let mut each: Vec<f64> = self.counts.chunks(width.max(1)).map(of).collect();
        let beyond = each.get(bins..).map_or(0.0, |rest| rest.iter().sum());
        each.truncate(bins);
        (each, beyond)
    }
}
