//! Correlation of a patch of one picture with another picture over all shifts within reach.

use std::sync::Arc;

use rustfft::{Fft, FftPlanner, num_complex::Complex32};

/// Values in rows and how far each may be trusted, 0 or 1.
pub(super) struct Field {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<f32>,
    pub(super) trust: Vec<f32>,
}

/// The peak of a correlation surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    /// The place in the first field that the shift belongs to, in pixels from its corner: the
    /// centre of what coincides. In a patch half of which is empty it is not the patch's.
    pub(super) at: [f64; 2],
    /// How far the second field is shifted against the first, in pixels.
    pub(super) shift: [f64; 2],
    /// Height over the mean of the surface, in its standard deviations, both away from the peak.
    /// Below 0 where the fields are each other's negative.
    pub(super) z: f64,
}

/// Which peaks count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    Same,
    Either,
}

/// Correlates square patches of one size at shifts of up to `reach` pixels each way.
pub(super) struct Correlator {
    side: usize,
    reach: usize,
    apart: usize,
    length: usize,
    forward: Arc<dyn Fft<f32>>,
    backward: Arc<dyn Fft<f32>>,
}

/// A patch whose trusted share is smaller than this says too little.
const TRUSTED: f32 = 0.2;

/// Variance of a patch below which there is nothing to correlate; that of a field is 1.
const FAINT: f32 = 1e-3;

/// Least variance of the second field to divide by; that of the field is 1. Where the patch hangs
/// half over the second picture's edge, a stroke or two would else correlate highly by chance.
const LEAST_VARIANCE: f32 = 0.1;

impl Correlator {
    /// `apart` is how far around a peak the surface still belongs to it, in pixels.
    pub(super) fn new(side: usize, reach: usize, apart: usize) -> Self {
        let length = smooth_length(side + 2 * reach);
        let mut planner = FftPlanner::new();
        Self {
            side,
            reach,
            apart,
            length,
            forward: planner.plan_fft_forward(length),
            backward: planner.plan_fft_inverse(length),
        }
    }

    /// The best shift of `second` under the patch of `first` whose corner is at `left`, `top`;
    /// `None` where either is without contrast there, or where the best shift is at the end of
    /// the reach. The patch must lie inside `first`. The values of `second` have a mean square of 1.
    ///
    /// D. Padfield, *IEEE Trans. Image Process.* 21 (2012) 2706, with a mask on the first only:
    /// outside `second` its values are 0, as on bare paper.
    pub(super) fn best(
        &self,
        first: &Field,
        second: &Field,
        [left, top]: [usize; 2],
        sign: Sign,
    ) -> Option<Peak> {
        let rows = || (0..self.side).map(|y| (top + y) * first.width + left);
        let indices = || rows().flat_map(|start| start..start + self.side);
        let count: f32 = indices().map(|i| first.trust[i]).sum();
        if count < TRUSTED * (self.side * self.side) as f32 {
            return None;
        }
        let mean = indices()
            .map(|i| first.trust[i] * first.values[i])
            .sum::<f32>()
            / count;
        let deviation = |i: usize| first.trust[i] * (first.values[i] - mean);
        let energy: f32 = indices().map(|i| deviation(i).powi(2)).sum();
        if energy <= FAINT * count {
            return None;
        }

        // Two real fields to a transform: the patch and its mask, the window and its square.
        let mut patch = vec![Complex32::ZERO; self.length * self.length];
        for (out, start) in patch.chunks_exact_mut(self.length).zip(rows()) {
            for (out, i) in out.iter_mut().zip(start..start + self.side) {
                *out = Complex32::new(deviation(i), first.trust[i]);
            }
        }
        self.transform(&*self.forward, &mut patch);
        let beside = |x: usize, y: usize| {
            let x = (left + x).checked_sub(self.reach);
            let y = (top + y).checked_sub(self.reach);
            match (x, y) {
                (Some(x), Some(y)) if x < second.width && y < second.height => {
                    let i = y * second.width + x;
                    second.values[i] * second.trust[i]
                }
                _ => 0.0,
            }
        };
        let mut window = vec![Complex32::ZERO; self.length * self.length];
        for (y, out) in window.chunks_exact_mut(self.length).enumerate() {
            for (x, out) in out.iter_mut().enumerate() {
                let value = beside(x, y);
                *out = Complex32::new(value, value * value);
            }
        }
        self.transform(&*self.forward, &mut window);
        self.products(&mut patch, &mut window);
        self.transform(&*self.backward, &mut patch);
        self.transform(&*self.backward, &mut window);
        let scale = 1.0 / (self.length * self.length) as f32;

        let shifts = 2 * self.reach + 1;
        let surface: Vec<f32> = (0..shifts * shifts)
            .map(|i| {
                let at = i / shifts * self.length + i % shifts;
                let [cross, sum, squares] =
                    [patch[at].re, patch[at].im, window[at].re].map(|v| v * scale);
                let variance = (squares - sum * sum / count).max(LEAST_VARIANCE * count);
                cross / (energy * variance).sqrt()
            })
            .collect();
        let ([dx, dy], peak) = self.peak(&surface, shifts, sign)?;
        let (mut weight, mut moment) = (0.0, [0.0; 2]);
        for (y, start) in rows().enumerate() {
            for x in 0..self.side {
                let product = deviation(start + x) * beside(x + dx, y + dy);
                let share = f64::from(product) * peak.z.signum();
                if share > 0.0 {
                    weight += share;
                    moment[0] += share * (x as f64 + 0.5);
                    moment[1] += share * (y as f64 + 0.5);
                }
            }
        }
        let [x, y] = moment.map(|v| v / weight);
        let at = [left as f64 + x, top as f64 + y];
        (x.is_finite() && y.is_finite()).then_some(Peak { at, ..peak })
    }

    /// From the spectra of patch + i·mask and window + i·window² to those of
    /// patch⋆window + i·mask⋆window, and of mask⋆window².
    fn products(&self, patch: &mut [Complex32], window: &mut [Complex32]) {
        let n = self.length;
        let split = |v: Complex32, opposite: Complex32| {
            let [sum, difference] = [v + opposite.conj(), v - opposite.conj()];
            (sum * 0.5, difference * Complex32::new(0.0, -0.5))
        };
        let both = |at: usize, opposite: usize, p: &[Complex32], w: &[Complex32]| {
            let (deviation, mask) = split(p[at], p[opposite]);
            let (value, square) = split(w[at], w[opposite]);
            (
                deviation.conj() * value + Complex32::I * mask.conj() * value,
                mask.conj() * square,
            )
        };
        let mirror = |i: usize| if i == 0 { 0 } else { n - i };
        for y in 0..n {
            for x in 0..n {
                let at = y * n + x;
                let opposite = mirror(y) * n + mirror(x);
                if at > opposite {
                    continue;
                }
                let here = both(at, opposite, patch, window);
                let there = both(opposite, at, patch, window);
                (patch[at], window[at]) = here;
                (patch[opposite], window[opposite]) = there;
            }
        }
    }

    /// In two dimensions; rows come out as rows.
    fn transform(&self, fft: &dyn Fft<f32>, field: &mut [Complex32]) {
        let mut scratch = vec![Complex32::ZERO; fft.get_inplace_scratch_len()];
        for _ in 0..2 {
            fft.process_with_scratch(field, &mut scratch);
            transpose(field, self.length);
        }
    }

    /// The highest place of a surface, and the peak there, as yet nowhere in the first field.
    fn peak(&self, surface: &[f32], shifts: usize, sign: Sign) -> Option<([usize; 2], Peak)> {
        let rank = |v: f32| match sign {
            Sign::Same => v,
            Sign::Either => v.abs(),
        };
        let best =
            (0..surface.len()).max_by(|&a, &b| rank(surface[a]).total_cmp(&rank(surface[b])))?;
        let [x, y] = [best % shifts, best / shifts];
        if !(1..shifts - 1).contains(&x) || !(1..shifts - 1).contains(&y) {
            return None;
        }
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (i, &v) in surface.iter().enumerate() {
            let far = (i % shifts).abs_diff(x).max((i / shifts).abs_diff(y)) > self.apart;
            if far {
                let v = f64::from(v);
                (count, sum, squares) = (count + 1.0, sum + v, squares + v * v);
            }
        }
        let mean = sum / count;
        let deviation = (squares / count - mean * mean).sqrt();
        let z = (f64::from(surface[best]) - mean) / deviation;
        let offset = |step: usize| {
            let [before, at, after] =
                [best - step, best, best + step].map(|i| f64::from(surface[i]));
            let bend = before - 2.0 * at + after;
            let offset = 0.5 * (before - after) / bend;
            if offset.is_finite() {
                offset.clamp(-0.5, 0.5)
            } else {
                0.0
            }
        };
        let reach = self.reach as f64;
        let peak = Peak {
            at: [0.0; 2],
            shift: [
                x as f64 - reach + offset(1),
                y as f64 - reach + offset(shifts),
            ],
            z,
        };
        z.is_finite().then_some(([x, y], peak))
    }
}

/// Exchanges rows and columns, in squares of which a cache holds both.
fn transpose(field: &mut [Complex32], length: usize) {
    const SQUARE: usize = 16;
    for top in (0..length).step_by(SQUARE) {
        for left in (0..=top).step_by(SQUARE) {
            for y in top..(top + SQUARE).min(length) {
                for x in left..(left + SQUARE).min(y) {
                    field.swap(y * length + x, x * length + y);
                }
            }
        }
    }
}

/// The next length whose only prime factors are 2, 3 and 5: others transform slowly.
fn smooth_length(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for prime in [2, 3, 5] {
            while n.is_multiple_of(prime) {
                n /= prime;
            }
        }
        n == 1
    };
    let mut length = least.max(1);
    while !smooth(length) {
        length += 1;
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 150;

    /// A sum of waves without a common period, at a place that need not be a whole pixel.
    fn waves(x: f64, y: f64) -> f32 {
        let wave = |i: f64| {
            let [u, v] = [(i * 2.4).cos(), (i * 2.4).sin()].map(|v| v * (0.3 + 0.05 * i));
            (u * x + v * y + i * i).cos()
        };
        ((1..=14).map(|i| wave(f64::from(i))).sum::<f64>() / 7.0_f64.sqrt()) as f32
    }

    fn field(value: impl Fn(usize, usize) -> f32) -> Field {
        Field {
            width: WIDTH,
            height: WIDTH,
            values: (0..WIDTH * WIDTH)
                .map(|i| value(i % WIDTH, i / WIDTH))
                .collect(),
            trust: vec![1.0; WIDTH * WIDTH],
        }
    }

    #[test]
    fn the_surface_is_the_correlation_coefficient() {
        let first = field(|x, y| waves(x as f64, y as f64));
        let second = field(|x, y| waves(x as f64 - 5.0, y as f64 + 3.0));
        let correlator = Correlator::new(48, 20, 6);
        let best = |sign| correlator.best(&first, &second, [50, 50], sign);
        let peak = best(Sign::Same).expect("a peak");
        let off = (peak.shift[0] - 5.0).hypot(peak.shift[1] + 3.0);
        assert!(off < 0.1 && peak.z > 5.0, "{peak:?}");
        let quarter = field(|x, y| waves(x as f64 - 5.3, y as f64 + 2.75));
        let peak = correlator
            .best(&first, &quarter, [50, 50], Sign::Same)
            .expect("a peak");
        let off = (peak.shift[0] - 5.3).hypot(peak.shift[1] + 2.75);
        assert!(off < 0.1, "{peak:?}");
    }

    #[test]
    fn a_negative_counts_only_where_it_may() {
        let first = field(|x, y| waves(x as f64, y as f64));
        let second = field(|x, y| -waves(x as f64 - 5.0, y as f64 + 3.0));
        let correlator = Correlator::new(48, 20, 6);
        let best = |sign| correlator.best(&first, &second, [50, 50], sign);
        let either = best(Sign::Either).expect("a peak");
        assert!(
            either.z < -5.0 && (either.shift[0] - 5.0).abs() < 0.1,
            "{either:?}"
        );
        assert!(
            best(Sign::Same).is_none_or(|peak| (peak.shift[0] - 5.0).abs() > 2.0 && peak.z < 5.0)
        );
    }

    #[test]
    fn what_is_masked_has_no_say() {
        let mut first = field(|x, y| {
            let own = if x % 9 < 3 { -20.0 } else { 0.0 };
            waves(x as f64, y as f64) + own
        });
        let second = field(|x, y| waves(x as f64 - 5.0, y as f64 + 3.0));
        let correlator = Correlator::new(48, 20, 6);
        let found = |first: &Field| {
            let peak = correlator.best(first, &second, [50, 50], Sign::Same);
            peak.is_some_and(|p| (p.shift[0] - 5.0).hypot(p.shift[1] + 3.0) < 0.2)
        };
        assert!(!found(&first));
        for i in 0..WIDTH * WIDTH {
            first.trust[i] = if i % WIDTH % 9 < 3 { 0.0 } else { 1.0 };
        }
        assert!(found(&first));
    }

    #[test]
    fn a_shift_belongs_to_where_something_is() {
        let half = |x: f64, y: f64| if x < 66.0 { waves(x, y) } else { 0.0 };
        let first = field(|x, y| half(x as f64, y as f64));
        let second = field(|x, y| half(x as f64 - 5.0, y as f64 + 3.0));
        let correlator = Correlator::new(48, 20, 6);
        let at = |first: &Field, second: &Field| {
            let peak = correlator.best(first, second, [50, 50], Sign::Same);
            peak.expect("a peak").at
        };
        // Columns 50 to 66 of 50 to 98.
        let [x, y] = at(&first, &second);
        assert!((x - 58.0).abs() < 2.0 && (y - 74.0).abs() < 4.0, "{x} {y}");
        let whole = field(|x, y| waves(x as f64, y as f64));
        let [x, _] = at(&whole, &whole);
        assert!((x - 74.0).abs() < 4.0, "{x}");
    }

    #[test]
    fn nothing_to_correlate_gives_no_peak() {
        let flat = field(|_, _| 0.0);
        let some = field(|x, y| waves(x as f64, y as f64));
        let correlator = Correlator::new(48, 20, 6);
        for (a, b) in [(&flat, &some), (&some, &flat), (&flat, &flat)] {
            assert!(correlator.best(a, b, [50, 50], Sign::Either).is_none());
        }
    }
}
