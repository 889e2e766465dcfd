//! The relief along a line: heights, their range and their roughness.

use glam::DVec2;

use super::{MeasureError, count, finite, positive};

/// Most samples of a profile.
pub const MAX_SAMPLES: usize = 1 << 16;

/// One sample of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// Distance from the start of the line, in mm.
    pub distance_mm: f64,
    /// Height as sampled, in µm.
    pub height_um: f64,
}

/// The relief along a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Equally spaced samples, the first and last at the ends of the line.
    pub samples: Vec<Relief>,
    /// Lowest and highest sample as it is, in µm.
    pub range_um: [f64; 2],
    /// Slope of the trend, in µm per mm.
    pub slope_um_per_mm: f64,
    /// Highest less lowest sample without the trend, in µm: Pt of ISO 21920-2:2021.
    pub height_um: f64,
    /// RMS of the samples without the trend, in µm: Pq of ISO 21920-2:2021, not filtered.
    pub roughness_um: f64,
}

/// Samples `height_um`, which takes a place in mm, at `samples` (3 to [`MAX_SAMPLES`]) equally
/// spaced places from `from` to `to`. The trend is the straight line of least squares.
///
/// # Errors
/// Ends that are not finite or coincide; too few or too many samples; a height that is not
/// finite.
pub fn profile(
    from: DVec2,
    to: DVec2,
    samples: usize,
    height_um: impl Fn(DVec2) -> f64,
) -> Result<Profile, MeasureError> {
    super::places(&[from, to], 2, 2)?;
    count("samples", samples, 3, MAX_SAMPLES)?;
    let length = positive("the length of the line in mm", from.distance(to))?;
    let samples = (0..samples)
        .map(|i| {
            let share = i as f64 / (samples - 1) as f64;
            Ok(Relief {
                distance_mm: share * length,
                height_um: finite("a height in µm", height_um(from.lerp(to, share)))?,
            })
        })
        .collect::<Result<Vec<_>, MeasureError>>()?;
    let n = samples.len() as f64;
    let mean = samples.iter().map(|s| s.height_um / n).sum::<f64>();
    let from_middle = |s: &Relief| s.distance_mm - 0.5 * length;
    let moment: f64 = samples
        .iter()
        .map(|s| from_middle(s) * (s.height_um - mean))
        .sum();
    let spread: f64 = samples.iter().map(|s| from_middle(s).powi(2)).sum();
    let slope = finite("the trend", moment / spread)?;
    let rest = |s: &Relief| s.height_um - mean - slope * from_middle(s);
    let [low, high] = extent(samples.iter().map(rest));
    let squares: f64 = samples.iter().map(|s| rest(s).powi(2)).sum();
    Ok(Profile {
        range_um: extent(samples.iter().map(|s| s.height_um)),
        slope_um_per_mm: slope,
        height_um: finite("the height in µm", high - low)?,
        roughness_um: finite("the roughness in µm", (squares / n).sqrt())?,
        samples,
    })
}

fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FROM: DVec2 = DVec2::new(10.0, 20.0);
    const TO: DVec2 = DVec2::new(40.0, 60.0);

    fn wave(slope: f64, amplitude: f64) -> Profile {
        // Twenty whole waves over the 50 mm, on a slope.
        let height = |p: DVec2| {
            let s = (p - FROM).length();
            100.0 + slope * s + amplitude * (std::f64::consts::TAU * s / 2.5).cos()
        };
        profile(FROM, TO, 2001, height).unwrap()
    }

    #[test]
    fn a_wave_on_a_slope_has_the_wave_s_roughness() {
        let found = wave(3.0, 8.0);
        assert_eq!(found.samples.len(), 2001);
        assert!((found.samples[1000].distance_mm - 25.0).abs() < 1e-9);
        assert_eq!(found.samples[2000].distance_mm, 50.0);
        assert!((found.slope_um_per_mm - 3.0).abs() < 0.01);
        assert!((found.roughness_um - 8.0 / 2f64.sqrt()).abs() < 0.01);
        assert!((found.height_um - 16.0).abs() < 0.1);
        assert!((found.range_um[1] - 258.0).abs() < 1e-9);
        // The trend left in would be told.
        let variance = found
            .samples
            .iter()
            .map(|s| (s.height_um - 175.0).powi(2))
            .sum::<f64>();
        assert!(((variance / 2001.0).sqrt() - 8.0 / 2f64.sqrt()).abs() > 10.0);
    }

    #[test]
    fn a_plane_has_no_roughness() {
        let found = wave(-7.0, 0.0);
        assert!(found.roughness_um < 1e-9 && found.height_um < 1e-9);
        assert!(wave(-7.0, 0.1).roughness_um > 0.05);
    }

    #[test]
    fn bad_lines_are_refused() {
        let flat = |_: DVec2| 0.0;
        assert!(profile(FROM, FROM, 10, flat).is_err());
        assert!(profile(FROM, DVec2::NAN, 10, flat).is_err());
        assert!(profile(FROM, TO, 2, flat).is_err());
        assert!(profile(FROM, TO, usize::MAX, flat).is_err());
        assert!(profile(FROM, TO, 10, |_| f64::NAN).is_err());
        assert!(profile(FROM, TO, 10, |p| if p.x > 20.0 { 1e308 } else { -1e308 }).is_err());
        assert!(profile(FROM, TO, 3, flat).is_ok());
    }
}
