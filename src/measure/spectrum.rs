//! The power spectrum of an area, averaged over tiles, and the sharp peaks in it.
//!
//! Welch's method (P. D. Welch, *IEEE Trans. Audio Electroacoust.* 15 (1967) 70) in two dimensions:
//! a sheet that has cockled bends its lines, which one transform of the whole area would smear.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use rustfft::{FftPlanner, num_complex::Complex};

use super::raster::Cleaned;

/// Side of a tile in mm: some forty laid lines.
const TILE_MM: f64 = 48.0;
/// Most tiles each way; on a larger area they lie apart.
const MOST_TILES: usize = 6;
/// Strongest places of the spectrum that are looked at closely.
const CANDIDATES: usize = 16;
/// The background of a peak is the median over the bins between these distances from it, in
/// elements of resolution (1 / side of a tile). A Hann window's own peak reaches 2.
const RING: [f64; 2] = [3.5, 10.0];

/// A peak of the spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak {
    /// Frequency in cycles per mm; across the lines, with y ≥ 0.
    pub f: DVec2,
    /// Power over the mean of the background.
    pub ratio: f64,
    /// Significance in standard deviations.
    pub z: f64,
}

/// Power of a cleaned area by frequency.
pub(super) struct Spectrum<'a> {
    field: &'a Cleaned,
    window: [Vec<f64>; 2],
    /// Left upper corner of each tile in pixels.
    tiles: Vec<[usize; 2]>,
    /// Bins each way.
    bins: [usize; 2],
    power: Vec<f64>,
}

impl<'a> Spectrum<'a> {
    pub fn new(field: &'a Cleaned) -> Self {
        let longest = ((TILE_MM / field.mm_per_pixel).round() as usize).max(1);
        let sizes = [field.width, field.height].map(|n| n.min(longest));
        let starts = |whole: usize, tile: usize| {
            let tiles = (2 * whole / tile).saturating_sub(1).clamp(1, MOST_TILES);
            (0..tiles).map(move |i| (whole - tile) * i / (tiles - 1).max(1))
        };
        let tiles: Vec<[usize; 2]> = starts(field.height, sizes[1])
            .flat_map(|top| starts(field.width, sizes[0]).map(move |left| [left, top]))
            .collect();
        let mut spectrum = Self {
            field,
            window: sizes.map(hann),
            tiles,
            bins: sizes.map(usize::next_power_of_two),
            power: Vec::new(),
        };
        spectrum.transform();
        spectrum
    }

    fn transform(&mut self) {
        let [columns, rows] = self.bins;
        let mut planner = FftPlanner::<f32>::new();
        let along = planner.plan_fft_forward(columns);
        let down = planner.plan_fft_forward(rows);
        let mut power = vec![0.0; columns * rows];
        let mut plane = vec![Complex::default(); columns * rows];
        let mut turned = plane.clone();
        for &tile in &self.tiles {
            plane.fill(Complex::default());
            for (y, row) in plane
                .chunks_exact_mut(columns)
                .take(self.window[1].len())
                .enumerate()
            {
                for (x, value) in row.iter_mut().take(self.window[0].len()).enumerate() {
                    value.re = self.windowed(tile, x, y) as f32;
                }
                along.process(row);
            }
            for (y, row) in plane.chunks_exact(columns).enumerate() {
                for (x, &value) in row.iter().enumerate() {
                    turned[x * rows + y] = value;
                }
            }
            down.process(&mut turned);
            for (x, column) in turned.chunks_exact(rows).enumerate() {
                for (y, value) in column.iter().enumerate() {
                    power[y * columns + x] += f64::from(value.norm_sqr());
                }
            }
        }
        self.power = power;
    }

    fn windowed(&self, [left, top]: [usize; 2], x: usize, y: usize) -> f64 {
        let value = self.field.values[(top + y) * self.field.width + left + x];
        f64::from(value) * self.window[0][x] * self.window[1][y]
    }

    /// Frequency resolution each way, in cycles per mm.
    pub fn resolution(&self) -> DVec2 {
        let [x, y] = [0, 1].map(|i| 1.0 / (self.window[i].len() as f64 * self.field.mm_per_pixel));
        DVec2::new(x, y)
    }

    fn bin(&self) -> DVec2 {
        let [x, y] = self
            .bins
            .map(|n| 1.0 / (n as f64 * self.field.mm_per_pixel));
        DVec2::new(x, y)
    }

    fn at(&self, x: i64, y: i64) -> f64 {
        let [columns, rows] = self.bins;
        let (x, y) = (x.rem_euclid(columns as i64), y.rem_euclid(rows as i64));
        self.power[y as usize * columns + x as usize]
    }

    /// Peaks whose frequency lies in `band` (cycles per mm), the most significant first.
    pub fn peaks(&self, [low, high]: [f64; 2]) -> Vec<Peak> {
        let bin = self.bin();
        let [x_most, y_most] = self.bins.map(|n| n as i64 / 2 - 1);
        let mut shells: Vec<Vec<f64>> = Vec::new();
        let shell = |f: f64| ((f - low) / (2.0 * self.resolution().max_element())) as usize;
        let mut maxima = Vec::new();
        for y in 0..=y_most {
            for x in -x_most..=x_most {
                let f = (DVec2::new(x as f64, y as f64) * bin).length();
                if !(low..=high).contains(&f) || (y == 0 && x < 0) {
                    continue;
                }
                let power = self.at(x, y);
                let index = shell(f);
                if shells.len() <= index {
                    shells.resize(index + 1, Vec::new());
                }
                shells[index].push(power);
                let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j)));
                if around
                    .into_iter()
                    .all(|(i, j)| self.at(x + i, y + j) <= power)
                {
                    maxima.push((x, y, index, power));
                }
            }
        }
        let medians: Vec<f64> = shells.into_iter().map(median).collect();
        maxima.retain(|&(_, _, index, power)| power > 0.0 && medians[index] > 0.0);
        maxima.sort_by(|a, b| (b.3 / medians[b.2]).total_cmp(&(a.3 / medians[a.2])));
        maxima.truncate(CANDIDATES);
        let mut peaks: Vec<Peak> = maxima
            .into_iter()
            // The larger of the backgrounds near by and all around: a peak must be sharp in
            // frequency and in direction.
            .map(|(x, y, index, _)| self.peak(x, y, medians[index]))
            .filter(|peak| peak.z.is_finite())
            .collect();
        peaks.sort_by(|a, b| b.z.total_cmp(&a.z));
        peaks
    }

    fn peak(&self, x: i64, y: i64, least_background: f64) -> Peak {
        let shape = self.tiles.len() as f64;
        let background = self.ring(x, y).max(least_background);
        let ratio = self.at(x, y) / background * middle_of_gamma(shape);
        Peak {
            f: DVec2::new(x as f64, y as f64) * self.bin(),
            ratio,
            z: significance(ratio, shape),
        }
    }

    /// The strongest bin within an element of resolution of `f`, as a peak.
    pub fn near(&self, f: DVec2) -> Peak {
        let middle = f / self.bin();
        let reach = (self.resolution() / self.bin()).ceil();
        let range = |middle: f64, reach: f64| {
            let middle = middle.round() as i64;
            middle - reach as i64..=middle + reach as i64
        };
        range(middle.y, reach.y)
            .flat_map(|y| range(middle.x, reach.x).map(move |x| (x, y)))
            .max_by(|a, b| self.at(a.0, a.1).total_cmp(&self.at(b.0, b.1)))
            .map_or(
                Peak {
                    f,
                    ratio: 0.0,
                    z: 0.0,
                },
                |(x, y)| self.peak(x, y, f64::MIN_POSITIVE),
            )
    }

    /// Median power of the ring around a bin.
    fn ring(&self, x: i64, y: i64) -> f64 {
        let scale = self.bin() / self.resolution();
        let reach = (RING[1] / scale).ceil();
        let mut values = Vec::new();
        for j in -(reach.y as i64)..=reach.y as i64 {
            for i in -(reach.x as i64)..=reach.x as i64 {
                let distance = (DVec2::new(i as f64, j as f64) * scale).length();
                if (RING[0]..=RING[1]).contains(&distance) {
                    values.push(self.at(x + i, y + j));
                }
            }
        }
        median(values)
    }

    /// The exact place of a peak near `f` and its standard uncertainty each way, in cycles per mm.
    ///
    /// The power is summed directly at 3 × 3 frequencies half an element of resolution apart and a
    /// parabola laid through its logarithm, thrice. The uncertainty is that of leaving out one
    /// tile after another (jackknife; B. Efron, *Ann. Statist.* 7 (1979) 1), at least that of one
    /// wave in noise (D. C. Rife & R. R. Boorstyn, *IEEE Trans. Inf. Theory* 20 (1974) 591), times
    /// 1.6 for the window.
    pub fn refined(&self, peak: Peak) -> (DVec2, DVec2) {
        let step = 0.5 * self.resolution();
        let mut f = peak.f;
        let mut tiles = Vec::new();
        for _ in 0..3 {
            tiles = self
                .tiles
                .iter()
                .map(|&tile| self.around(tile, f, step))
                .collect();
            f += step * vertex(&total(&tiles));
        }
        let least = 1.6 * self.resolution() * (6.0 / peak.ratio.max(1.0)).sqrt()
            / (TAU * (self.tiles.len() as f64).sqrt());
        let n = tiles.len() as f64;
        let all = total(&tiles);
        let without: Vec<DVec2> = tiles
            .iter()
            .map(|tile| vertex(&std::array::from_fn(|i| all[i] - tile[i])) * step)
            .collect();
        let mean = without.iter().sum::<DVec2>() / n;
        let squares: DVec2 = without.iter().map(|v| (*v - mean) * (*v - mean)).sum();
        let root = |v: f64| (v * (n - 1.0) / n).sqrt();
        let scatter = DVec2::new(root(squares.x), root(squares.y));
        (f, scatter.max(least))
    }

    /// Power of one tile at the 3 × 3 frequencies around `f`, row by row.
    fn around(&self, tile: [usize; 2], f: DVec2, step: DVec2) -> [f64; 9] {
        let mm = self.field.mm_per_pixel;
        let phasors = |n: usize, f: f64| -> Vec<Complex<f64>> {
            (0..n)
                .map(|i| Complex::from_polar(1.0, -TAU * f * mm * i as f64))
                .collect()
        };
        let [columns, rows] = [0, 1].map(|i| self.window[i].len());
        let across = [-1.0, 0.0, 1.0].map(|i| phasors(columns, f.x + i * step.x));
        let down = [-1.0, 0.0, 1.0].map(|j| phasors(rows, f.y + j * step.y));
        let mut sums = [Complex::new(0.0, 0.0); 9];
        for (y, turn) in (0..rows).map(|y| (y, [0, 1, 2].map(|j: usize| down[j][y]))) {
            let mut line = [Complex::new(0.0, 0.0); 3];
            for x in 0..columns {
                let value = self.windowed(tile, x, y);
                for (sum, phasor) in line.iter_mut().zip(&across) {
                    *sum += phasor[x] * value;
                }
            }
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += line[i % 3] * turn[i / 3];
            }
        }
        sums.map(|sum| sum.norm_sqr())
    }
}

/// Vertex of the parabolas through the logarithms of 3 × 3 powers, in steps, within ±1.
fn vertex(power: &[f64; 9]) -> DVec2 {
    let one = |a: f64, b: f64, c: f64| {
        let [a, b, c] = [a, b, c].map(|v| v.max(f64::MIN_POSITIVE).ln());
        let bend = a - 2.0 * b + c;
        if bend < 0.0 {
            (0.5 * (a - c) / bend).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    };
    DVec2::new(
        one(power[3], power[4], power[5]),
        one(power[1], power[4], power[7]),
    )
}

fn total(tiles: &[[f64; 9]]) -> [f64; 9] {
    std::array::from_fn(|i| tiles.iter().map(|tile| tile[i]).sum())
}

/// The Hann window of `n` samples.
fn hann(n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| (PI * (i as f64 + 0.5) / n as f64).sin().powi(2))
        .collect()
}

/// Significance of `ratio`, a power over the mean of its noise, where the noise is the mean of
/// `shape` independent spectra, so a gamma distribution of that shape: the deviation of normal
/// noise that is as unlikely (E. B. Wilson & M. M. Hilferty, *PNAS* 17 (1931) 684).
pub(super) fn significance(ratio: f64, shape: f64) -> f64 {
    (ratio.cbrt() - (1.0 - 1.0 / (9.0 * shape))) * 3.0 * shape.sqrt()
}

/// Median over mean of a gamma distribution, by the same approximation.
fn middle_of_gamma(shape: f64) -> f64 {
    (1.0 - 1.0 / (9.0 * shape)).powi(3)
}

/// Median; 0 of nothing.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{SeedableRng as _, rngs::Xoshiro256PlusPlus as Rng};
    use rand_distr::{Distribution as _, StandardNormal};

    /// Normal noise and a wave of this amplitude in its deviations.
    fn field(f: DVec2, amplitude: f64, seed: u64, size: usize) -> Cleaned {
        let mut rng = Rng::seed_from_u64(seed);
        let mm_per_pixel = 0.12;
        let values = (0..size * size)
            .map(|i| {
                let at = DVec2::new((i % size) as f64, (i / size) as f64) * mm_per_pixel;
                let noise: f64 = StandardNormal.sample(&mut rng);
                (noise + amplitude * (TAU * f.dot(at) + 0.7).cos()) as f32
            })
            .collect();
        Cleaned {
            width: size,
            height: size,
            mm_per_pixel,
            values,
            paper: vec![true; size * size],
        }
    }

    const BAND: [f64; 2] = [0.45, 2.2];

    #[test]
    fn a_weak_wave_is_found_within_its_uncertainty() {
        let truth = DVec2::new(-0.1234, 0.9211);
        let mut hits = 0;
        for seed in 0..12 {
            let field = field(truth, 0.12, seed, 600);
            let spectrum = Spectrum::new(&field);
            let peak = spectrum.peaks(BAND)[0];
            assert!(peak.z > 6.0 && peak.ratio > 5.0, "{peak:?}");
            let (f, sigma) = spectrum.refined(peak);
            assert!(f.distance(truth) < 0.002 * truth.length(), "{f}");
            let error = (f - truth).abs();
            hits += usize::from(error.x < 2.0 * sigma.x) + usize::from(error.y < 2.0 * sigma.y);
        }
        assert!(hits >= 20, "{hits} of 24 within 2 sigma");
    }

    #[test]
    fn noise_alone_has_no_peak() {
        for (seed, size) in [(3, 600), (4, 600), (5, 150), (6, 150), (7, 40)] {
            let field = field(DVec2::X, 0.0, seed, size);
            let best = Spectrum::new(&field)
                .peaks(BAND)
                .first()
                .map_or(0.0, |p| p.z);
            assert!(best < 6.0, "{seed}: {best}");
        }
    }

    #[test]
    fn an_empty_area_has_no_peak() {
        for size in [1, 2, 50] {
            let mut field = field(DVec2::X, 0.0, 1, size);
            field.values.fill(0.0);
            assert!(Spectrum::new(&field).peaks(BAND).is_empty());
        }
    }
}
