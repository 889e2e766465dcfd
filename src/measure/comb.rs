//! Equally spaced marks of any shape in a row of values: their spacing and phase.
//!
//! A comb of spacing P is a Fourier series of the frequencies k/P, so that its fit by least
//! squares explains the power of the row at these frequencies. A shorter comb's harmonics are
//! also those of twice and three times its spacing: each frequency therefore has to explain more
//! than noise would, as in an information criterion (G. Schwarz, *Ann. Statist.* 6 (1978) 461).

use std::f64::consts::TAU;

use rustfft::{FftPlanner, num_complex::Complex};

use super::spectrum::significance;

/// Harmonics up to this frequency in cycles per mm count: it is below that of laid lines, and
/// chain lines that are half a millimetre off their place still agree.
const HIGHEST: f64 = 0.4;
/// Power each frequency has to explain, in units of the noise.
const PRICE: f64 = 2.5;
/// One frequency counts for so much at most, in units of the noise: a comb has many, and a wave
/// of shade is none however strong.
const CAP: f64 = 20.0;
/// Bins per element of resolution.
const FINE: usize = 8;
/// The noise at a frequency is that of the row within this distance, in cycles per mm.
const NOISE_REACH: f64 = 0.1;
/// The noise is told from this quantile, as the comb's harmonics hold up to half of the bins.
const NOISE_QUANTILE: f64 = 0.4;
/// Half the width of a mark with the shades beside it, in mm.
const MARK_MM: f64 = 2.5;
/// Fewest periods that a row must have to tell a comb from single marks.
pub(super) const MIN_PERIODS: f64 = 3.0;
/// Spacings that could hide behind a multiple are those down to an eighth.
const DIVISORS: [f64; 7] = [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
/// A comb that explains this share of what a multiple explains is the true one.
const SAME: f64 = 0.8;

/// Equally spaced marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comb {
    /// Spacing in mm.
    pub spacing_mm: f64,
    /// Standard uncertainty of the spacing, in mm.
    pub sigma_mm: f64,
    /// Distance of a mark's middle from the start of the row, 0 ≤ `phase_mm` < `spacing_mm`. The
    /// marks may be darker or lighter than the rest.
    pub phase_mm: f64,
    /// Power explained beyond its price, in squares of the row's own unit.
    pub power: f64,
    /// Significance in standard deviations of the noise, of this one spacing.
    pub z: f64,
    /// How alike the marks are: the mean of their likeness to the others over its standard error.
    /// Two strong marks among weak ones, which a wide comb cannot avoid, have less than 2.
    pub steadiness: f64,
    /// The spacing, in mm, of which this is a multiple; then it is not a comb of its own.
    pub multiple_of_mm: Option<f64>,
}

/// The comb of spacing within `band_mm` that explains most of `row`, whose values are `pitch_mm`
/// apart and have a mean near 0; 0 stands for an unknown value. `None` where the row is shorter
/// than 3 of the shortest spacing, has no power, or the band is empty.
pub fn comb(row: &[f64], pitch_mm: f64, [shortest, longest]: [f64; 2]) -> Option<Comb> {
    let length = row.len() as f64 * pitch_mm;
    let longest = longest.min(length / MIN_PERIODS);
    let sane = shortest > 0.0
        && longest >= shortest
        && length.is_finite()
        && 2.0 * HIGHEST * pitch_mm < 1.0;
    if !sane {
        return None;
    }
    let table = Table::new(row, pitch_mm)?;
    let mut best = (shortest, f64::NEG_INFINITY);
    let mut spacing = shortest;
    while spacing <= longest {
        let score = table.score(spacing, CAP);
        if score > best.1 {
            best = (spacing, score);
        }
        // A tenth of an element of resolution at the highest harmonic.
        spacing *= 1.0 + 0.1 / (HIGHEST * length);
    }
    let mut spacing = best.0;
    // The cap would make the top flat.
    let mut score = table.score(spacing, f64::INFINITY);
    let mut step = 0.1 * spacing / (HIGHEST * length);
    for _ in 0..30 {
        for candidate in [spacing - step, spacing + step] {
            let found = table.score(candidate, f64::INFINITY);
            if found > score {
                (spacing, score) = (candidate, found);
            }
        }
        step *= 0.8;
    }
    let harmonics = Table::harmonics(spacing) as f64;
    let score = table.score(spacing, CAP);
    let z = significance(score / harmonics + PRICE, harmonics);
    let phase_mm = table.phase(spacing);
    let multiple_of_mm = DIVISORS
        .map(|d| spacing / d)
        .into_iter()
        .find(|&short| short * HIGHEST >= 1.0 && table.score(short, CAP) >= SAME * score);
    Some(Comb {
        spacing_mm: spacing,
        // No mark is known better than to a sample of the row: wires are not laid exactly. The
        // spacing of n marks known to σ is known to σ √12 / n^1.5.
        sigma_mm: table
            .sigma(spacing)
            .max(pitch_mm * 12f64.sqrt() / (length / spacing).powf(1.5)),
        phase_mm,
        steadiness: steadiness(row, pitch_mm, spacing, phase_mm),
        power: table.power(spacing),
        z,
        multiple_of_mm,
    })
}

/// Mean over standard error of what each mark has in common with the mean of the others.
fn steadiness(row: &[f64], pitch_mm: f64, spacing_mm: f64, phase_mm: f64) -> f64 {
    let reach = (MARK_MM / pitch_mm).ceil() as usize;
    let marks: Vec<&[f64]> = (0..)
        .map(|i| ((phase_mm + f64::from(i) * spacing_mm) / pitch_mm) as usize)
        .take_while(|&middle| middle + reach < row.len())
        .filter_map(|middle| row.get(middle.checked_sub(reach)?..middle + reach + 1))
        .collect();
    let n = marks.len() as f64;
    if n < 3.0 {
        return 0.0;
    }
    let sums: Vec<f64> = (0..2 * reach + 1)
        .map(|u| marks.iter().map(|mark| mark[u]).sum())
        .collect();
    let likeness: Vec<f64> = marks
        .iter()
        .map(|mark| mark.iter().zip(&sums).map(|(v, sum)| v * (sum - v)).sum())
        .collect();
    let mean = likeness.iter().sum::<f64>() / n;
    let variance = likeness.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if variance > 0.0 {
        mean / (variance / n).sqrt()
    } else {
        f64::INFINITY.copysign(mean)
    }
}

/// The spectrum of a row in units of its noise.
struct Table {
    bin: f64,
    wave: Vec<Complex<f64>>,
    noise: Vec<f64>,
    length_mm: f64,
    pitch_mm: f64,
}

impl Table {
    fn new(row: &[f64], pitch_mm: f64) -> Option<Self> {
        let bins = (row.len() * FINE).next_power_of_two();
        let mut wave: Vec<Complex<f64>> = row.iter().map(|&v| Complex::new(v, 0.0)).collect();
        wave.resize(bins, Complex::default());
        FftPlanner::new().plan_fft_forward(bins).process(&mut wave);
        let bin = 1.0 / (bins as f64 * pitch_mm);
        let last = ((HIGHEST / bin).ceil() as usize + 2).min(bins / 2);
        let reach = ((NOISE_REACH / bin).ceil() as usize).max(1);
        wave.truncate((last + reach).min(bins / 2));
        let power: Vec<f64> = wave.iter().map(Complex::norm_sqr).collect();
        let quantile = -(1.0 - NOISE_QUANTILE).ln();
        // The noise is smooth: it is told at intervals and taken from the nearest.
        let interval = FINE;
        let told: Vec<f64> = (0..power.len())
            .step_by(interval)
            .map(|i| {
                let mut near = power
                    [i.saturating_sub(reach).max(1).min(i)..(i + reach).min(power.len())]
                    .to_vec();
                let place = (near.len() as f64 * NOISE_QUANTILE) as usize;
                *near.select_nth_unstable_by(place, f64::total_cmp).1 / quantile
            })
            .collect();
        let noise: Vec<f64> = (0..power.len()).map(|i| told[i / interval]).collect();
        let usable = noise.iter().all(|n| n.is_finite() && *n > 0.0);
        usable.then_some(Self {
            bin,
            wave,
            noise,
            length_mm: row.len() as f64 * pitch_mm,
            pitch_mm,
        })
    }

    fn harmonics(spacing: f64) -> usize {
        (HIGHEST * spacing).floor().max(1.0) as usize
    }

    /// The spectrum over the root of its noise, at a frequency: linear between the bins.
    fn at(&self, f: f64) -> Complex<f64> {
        let place = f / self.bin;
        let i = place as usize;
        match (self.wave.get(i), self.wave.get(i + 1)) {
            (Some(a), Some(b)) => (a + (b - a) * (place - i as f64)) / self.noise[i].sqrt(),
            _ => Complex::default(),
        }
    }

    fn score(&self, spacing: f64, cap: f64) -> f64 {
        (1..=Self::harmonics(spacing))
            .map(|k| self.at(k as f64 / spacing).norm_sqr().min(cap) - PRICE)
            .sum()
    }

    fn power(&self, spacing: f64) -> f64 {
        let explained = |f: f64| (self.at(f).norm_sqr() - PRICE) * self.noise_at(f);
        (1..=Self::harmonics(spacing))
            .map(|k| explained(k as f64 / spacing))
            .sum()
    }

    fn noise_at(&self, f: f64) -> f64 {
        self.noise[((f / self.bin) as usize).min(self.noise.len() - 1)]
    }

    /// The score is the logarithm of the likelihood in normal noise; its curvature gives the
    /// uncertainty. Near its maximum harmonic k falls as sinc², whose curvature by frequency is
    /// 2π²L²/3 of its power, and df/dP = k/P².
    fn sigma(&self, spacing: f64) -> f64 {
        let information: f64 = (1..=Self::harmonics(spacing))
            .map(|k| {
                let k = k as f64;
                let power = (self.at(k / spacing).norm_sqr() - 1.0).max(0.0);
                power * (k / spacing.powi(2)).powi(2) * TAU * TAU * self.length_mm.powi(2) / 6.0
            })
            .sum();
        1.0 / information.sqrt()
    }

    /// Where the series of the harmonics is furthest from its mean.
    fn phase(&self, spacing: f64) -> f64 {
        let terms: Vec<Complex<f64>> = (1..=Self::harmonics(spacing))
            .map(|k| {
                let f = k as f64 / spacing;
                self.at(f) * self.noise_at(f).sqrt()
            })
            .collect();
        let value = |s: f64| -> f64 {
            let term = |(k, c): (usize, &Complex<f64>)| {
                (c * Complex::from_polar(1.0, TAU * (k + 1) as f64 * s / spacing)).re
            };
            terms.iter().enumerate().map(term).sum::<f64>().abs()
        };
        let steps = 400;
        let best = (0..steps)
            .map(|i| spacing * f64::from(i) / f64::from(steps))
            .max_by(|a, b| value(*a).total_cmp(&value(*b)))
            .unwrap_or(0.0);
        // Values stand for the middle of their pitch.
        (best + 0.5 * self.pitch_mm).rem_euclid(spacing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _, rngs::Xoshiro256PlusPlus as Rng};
    use rand_distr::{Distribution as _, StandardNormal};

    const PITCH: f64 = 0.25;
    const BAND: [f64; 2] = [14.0, 42.0];

    /// Marks of ±1 at a spacing, in noise; each off its place by up to `jitter` mm.
    fn row(spacing: f64, phase: f64, noise: f64, jitter: f64, seed: u64) -> Vec<f64> {
        let mut rng = Rng::seed_from_u64(seed);
        let marks: Vec<f64> = (-1..40)
            .map(|i| f64::from(i) * spacing + phase + jitter * rng.random_range(-1.0..1.0))
            .collect();
        (0..800)
            .map(|i| {
                let s = (f64::from(i) + 0.5) * PITCH;
                let normal: f64 = StandardNormal.sample(&mut rng);
                let near = marks
                    .iter()
                    .map(|m| (s - m).abs())
                    .fold(f64::INFINITY, f64::min);
                -(-(near / 0.6).powi(2)).exp() + noise * normal
            })
            .collect()
    }

    #[test]
    fn a_comb_in_noise_is_found_within_its_uncertainty() {
        let mut hits = 0;
        for seed in 0..40 {
            let truth = 16.0 + 0.6 * seed as f64;
            let found = comb(&row(truth, 7.0, 0.25, 0.0, seed), PITCH, BAND).unwrap();
            assert!(
                found.z > 6.0 && found.multiple_of_mm.is_none(),
                "{truth}: {found:?}"
            );
            assert!(
                (found.spacing_mm / truth - 1.0).abs() < 0.01,
                "{truth}: {found:?}"
            );
            assert!((found.phase_mm - 7.0).abs() < 0.7, "{truth}: {found:?}");
            hits += usize::from((found.spacing_mm - truth).abs() < 2.0 * found.sigma_mm);
        }
        assert!((34..=40).contains(&hits), "{hits} of 40");
    }

    #[test]
    fn marks_slightly_off_their_places_are_a_comb() {
        for seed in 0..10 {
            let found = comb(&row(24.0, 3.0, 0.1, 0.4, seed), PITCH, BAND).unwrap();
            assert!(found.z > 6.0, "{found:?}");
            assert!((found.spacing_mm / 24.0 - 1.0).abs() < 0.02, "{found:?}");
        }
    }

    #[test]
    fn noise_and_one_mark_are_none() {
        for seed in 0..20 {
            let noise: Vec<f64> = row(1e6, 50.0, 1.0, 0.0, seed);
            let z = comb(&noise, PITCH, BAND).unwrap().z;
            assert!(z < 6.0, "{z}");
        }
        let single = comb(&row(1e6, 90.0, 0.1, 0.0, 1), PITCH, BAND).unwrap();
        assert!(single.z < 6.0, "{single:?}");
    }

    #[test]
    fn a_few_strong_marks_are_unsteady() {
        let mut row = self::row(35.0, 10.0, 0.1, 0.0, 4);
        assert!(comb(&row, PITCH, BAND).unwrap().steadiness > 5.0);
        // Only the first two are left.
        let empty = self::row(1e6, 1e5, 0.1, 0.0, 5);
        row[240..].copy_from_slice(&empty[240..]);
        assert!(comb(&row, PITCH, BAND).unwrap().steadiness < 2.5);
    }

    #[test]
    fn a_multiple_is_told_from_its_comb() {
        let found = comb(&row(7.0, 2.0, 0.2, 0.0, 3), PITCH, BAND).unwrap();
        let short = found.multiple_of_mm.unwrap();
        assert!((short - 7.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn rows_without_content_are_none() {
        for row in [vec![], vec![1.0], vec![0.0; 800], vec![f64::NAN; 800]] {
            assert_eq!(comb(&row, PITCH, BAND), None);
        }
        let good = row(24.0, 3.0, 0.1, 0.0, 0);
        for pitch in [0.0, -1.0, f64::NAN, f64::INFINITY, 2.0] {
            assert_eq!(comb(&good, pitch, BAND), None);
        }
        assert_eq!(comb(&good, PITCH, [30.0, 20.0]), None);
        assert!(comb(&good, PITCH, BAND).is_some());
    }
}
