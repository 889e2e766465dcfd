//! A side's albedo, a band after another. Where it is known how bright the light was, it is encoded
//! at once, in half of the memory; otherwise all of the sheet says how bright, and it is kept linear
//! until then.

use rayon::prelude::*;

use super::codes::SrgbCodes;

pub(super) struct Albedo {
    codes: SrgbCodes,
    /// Whether it is known how bright the light was.
    measured: bool,
    encoded: Vec<[u16; 3]>,
    linear: [Vec<f32>; 3],
}

impl Albedo {
    /// Of `count` places.
    pub fn new(count: usize, measured: bool) -> Self {
        let [encoded, linear] = if measured { [count, 0] } else { [0, count] };
        Self {
            codes: SrgbCodes::new(),
            measured,
            encoded: Vec::with_capacity(encoded),
            linear: [0, 1, 2].map(|_| Vec::with_capacity(linear)),
        }
    }

    /// Takes planes of linear red, green and blue.
    pub fn add(&mut self, band: &[Vec<f32>; 3]) {
        if !self.measured {
            for (all, band) in self.linear.iter_mut().zip(band) {
                all.extend_from_slice(band);
            }
            return;
        }
        let [r, g, b] = band;
        let start = self.encoded.len();
        self.encoded.resize(start + r.len(), [0; 3]);
        let out = self.encoded[start..].par_iter_mut().zip(r).zip(g).zip(b);
        out.for_each(|(((out, r), g), b)| *out = [*r, *g, *b].map(|v| self.codes.of(v)));
    }

    /// sRGB-encoded, and the factor that it was multiplied with where nothing says how bright the
    /// light was.
    pub fn finish(self) -> (Vec<[u16; 3]>, Option<f64>) {
        if self.measured {
            return (self.encoded, None);
        }
        let exposure = exposure(&self.linear[1]);
        let (codes, factor) = (&self.codes, exposure as f32);
        // Plane after plane, each of which is given up.
        let encode = |plane: Vec<f32>| -> Vec<u16> {
            let codes = plane.par_iter().map(|v| codes.of(v * factor));
            codes.collect()
        };
        let [r, g, b] = self.linear.map(encode);
        let together = r.par_iter().zip(&g).zip(&b);
        let encoded = together.map(|((r, g), b)| [*r, *g, *b]).collect();
        (encoded, Some(exposure))
    }
}

/// What brings the brightest paper to a white sheet's albedo, where nothing says how bright the
/// light was.
pub(super) fn exposure(green: &[f32]) -> f64 {
    /// Of white paper.
    const WHITE: f64 = 0.85;
    /// What is brighter is a gleam.
    const BRIGHTEST: f64 = 0.995;
    const EVERY: usize = 7;
    let mut sampled: Vec<f32> = green.iter().step_by(EVERY).copied().collect();
    if sampled.is_empty() {
        return 1.0;
    }
    let i = ((sampled.len() - 1) as f64 * BRIGHTEST) as usize;
    let white = f64::from(*sampled.select_nth_unstable_by(i, f32::total_cmp).1);
    if white > 0.0 { WHITE / white } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bands of a ramp, as they come and all at once.
    fn encoded(measured: bool, bands: usize) -> (Vec<[u16; 3]>, Option<f64>) {
        let count = 1200;
        let value = |i: usize| 0.7 * i as f32 / count as f32;
        let mut albedo = Albedo::new(count, measured);
        for band in 0..bands {
            let range = band * count / bands..(band + 1) * count / bands;
            let plane = |scale: f32| range.clone().map(|i| value(i) * scale).collect();
            albedo.add(&[plane(1.0), plane(0.8), plane(0.5)]);
        }
        albedo.finish()
    }

    #[test]
    fn bands_make_the_whole() {
        for measured in [false, true] {
            assert_eq!(encoded(measured, 7), encoded(measured, 1), "{measured}");
        }
    }

    #[test]
    fn light_that_is_known_is_not_changed() {
        let codes = SrgbCodes::new();
        let (known, none) = encoded(true, 3);
        let (unknown, exposure) = encoded(false, 3);
        let exposure = exposure.expect("assumed");
        assert_eq!(none, None);
        // The brightest green becomes white paper.
        assert!((exposure * 0.7 * 0.8 - 0.85).abs() < 0.01, "{exposure}");
        let green = 0.7 * 600.0 / 1200.0 * 0.8;
        assert_eq!(known[600][1], codes.of(green));
        assert_eq!(unknown[600][1], codes.of(green * exposure as f32));
    }
}
