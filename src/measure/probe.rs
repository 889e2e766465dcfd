//! A colour probe: the mean colour of a patch of a side.

use glam::DVec2;

use super::{MeasureError, finite, positive};
use crate::colour::{delta_e00, lab_from_linear};

/// Most places a probe samples; a larger patch is sampled more coarsely.
const MAX_PLACES: f64 = 1e6;
/// Fewest places that have a standard deviation worth the name.
const MIN_PLACES: usize = 4;

/// A patch of a side, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Patch {
    /// All within `radius_mm` of `middle`.
    Disc { middle: DVec2, radius_mm: f64 },
    /// Upright, between two opposite corners in any order.
    Rectangle { corners: [DVec2; 2] },
}

/// Colour of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Mean in linear sRGB.
    pub linear: [f64; 3],
    /// CIELAB (D65) of that mean, which is what an instrument would read that sees the whole
    /// patch at once.
    pub lab: [f64; 3],
    /// Standard deviation of L*, a* and b* of the single places about their own mean.
    pub deviation: [f64; 3],
    /// How many places were on the sheet.
    pub places: usize,
}

/// Samples `linear` (linear sRGB at a place in mm; `None` off the sheet) over a patch, on a
/// square grid of `pitch_mm`, which should be the map's pixel.
///
/// # Errors
/// A patch or pitch that is not finite or has no extent; a colour that is not finite; fewer than
/// 4 places on the sheet.
pub fn probe(
    patch: Patch,
    pitch_mm: f64,
    linear: impl Fn(DVec2) -> Option<[f64; 3]>,
) -> Result<Probe, MeasureError> {
    let pitch = positive("the pitch in mm", pitch_mm)?;
    let (middle, half) = match patch {
        Patch::Disc { middle, radius_mm } => (
            middle,
            DVec2::splat(positive("the radius in mm", radius_mm)?),
        ),
        Patch::Rectangle { corners: [a, b] } => (0.5 * (a + b), 0.5 * (b - a).abs()),
    };
    super::places(&[middle, half], 2, 2)?;
    positive("the width of the patch in mm", half.x)?;
    positive("the height of the patch in mm", half.y)?;
    let pitch = finite(
        "the size of the patch",
        pitch.max((4.0 * half.x).sqrt() * half.y.sqrt() / MAX_PLACES.sqrt()),
    )?;
    // The grid is centred, so that a probe turned upside down reads the same. A long thin patch
    // keeps within the most places either way, as its shorter side has at least one row.
    let steps = (2.0 * half / pitch)
        .round()
        .clamp(DVec2::ONE, DVec2::splat(MAX_PLACES));
    let (mut sum, mut lab_sum, mut squares) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    let mut first: Option<[f64; 3]> = None;
    let mut places = 0;
    for row in 0..steps.y as usize {
        for column in 0..steps.x as usize {
            let share = (DVec2::new(column as f64, row as f64) + 0.5) / steps * 2.0 - 1.0;
            if matches!(patch, Patch::Disc { .. }) && share.length_squared() > 1.0 {
                continue;
            }
            let Some(here) = linear(middle + half * share) else {
                continue;
            };
            let lab = lab_from_linear(here);
            // Sums are taken about the first place: squares of L* near 90 lose digits.
            let shift = *first.get_or_insert(lab);
            for i in 0..3 {
                sum[i] += finite("a colour", here[i])?;
                lab_sum[i] += lab[i] - shift[i];
                squares[i] += (lab[i] - shift[i]).powi(2);
            }
            places += 1;
        }
    }
    if places < MIN_PLACES {
        return Err(MeasureError::OffSheet {
            found: places,
            needed: MIN_PLACES,
        });
    }
    let n = places as f64;
    let mean = sum.map(|s| s / n);
    let lab = lab_from_linear(mean);
    let deviation = std::array::from_fn(|i| {
        ((squares[i] - lab_sum[i] * lab_sum[i] / n).max(0.0) / (n - 1.0)).sqrt()
    });
    for value in lab.into_iter().chain(deviation) {
        finite("the mean colour", value)?;
    }
    Ok(Probe {
        linear: mean,
        lab,
        deviation,
        places,
    })
}

/// ΔE00 (CIE 142-2001) between the mean colours of two probes.
pub fn difference(a: &Probe, b: &Probe) -> f64 {
    delta_e00(a.lab, b.lab)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISC: Patch = Patch::Disc {
        middle: DVec2::new(30.0, 40.0),
        radius_mm: 2.0,
    };
    const PAPER: [f64; 3] = [0.70, 0.635, 0.515];
    const INK: [f64; 3] = [0.06, 0.045, 0.03];

    fn of(patch: Patch, colour: impl Fn(DVec2) -> [f64; 3]) -> Probe {
        probe(patch, 0.05, |p| Some(colour(p))).unwrap()
    }

    #[test]
    fn a_plain_patch_has_its_colour() {
        let found = of(DISC, |_| PAPER);
        for i in 0..3 {
            assert!((found.lab[i] - lab_from_linear(PAPER)[i]).abs() < 1e-9);
            assert!(found.deviation[i] < 1e-9);
        }
        let expected = std::f64::consts::PI * 1600.0;
        assert!((found.places as f64 / expected - 1.0).abs() < 0.01);
    }

    #[test]
    fn means_are_taken_in_linear_light() {
        let checks = |p: DVec2| {
            if (p.x * 10.0).floor() as i64 % 2 == 0 {
                PAPER
            } else {
                INK
            }
        };
        let patch = Patch::Rectangle {
            corners: [DVec2::new(14.0, 12.0), DVec2::new(10.0, 15.0)],
        };
        let found = of(patch, checks);
        let mixed = std::array::from_fn(|i| 0.5 * (PAPER[i] + INK[i]));
        assert!((found.lab[0] - lab_from_linear(mixed)[0]).abs() < 1e-6);
        let [light, dark] = [PAPER, INK].map(|c| lab_from_linear(c)[0]);
        // A mean of L* itself would be told.
        assert!((found.lab[0] - 0.5 * (light + dark)).abs() > 5.0);
        let spread = 0.5 * (light - dark);
        assert!((found.deviation[0] / spread - 1.0).abs() < 1e-3);
    }

    #[test]
    fn differences_are_delta_e00() {
        let (paper, ink) = (of(DISC, |_| PAPER), of(DISC, |_| INK));
        let expected = delta_e00(lab_from_linear(PAPER), lab_from_linear(INK));
        assert!((difference(&paper, &ink) - expected).abs() < 1e-9);
        assert!(expected > 30.0);
        assert!(difference(&paper, &paper) < 1e-12);
        // The distance in Lab (ΔE*ab) is another number.
        let lab: f64 = (0..3).map(|i| (paper.lab[i] - ink.lab[i]).powi(2)).sum();
        assert!((difference(&paper, &ink) - lab.sqrt()).abs() > 1.0);
    }

    #[test]
    fn bad_patches_are_refused() {
        let paper = |_: DVec2| Some(PAPER);
        let disc = |radius_mm| Patch::Disc {
            middle: DVec2::ONE,
            radius_mm,
        };
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(probe(disc(radius), 0.1, paper).is_err());
        }
        for pitch in [0.0, f64::NAN, f64::INFINITY] {
            assert!(probe(disc(1.0), pitch, paper).is_err());
        }
        let flat = Patch::Rectangle {
            corners: [DVec2::ONE, DVec2::new(5.0, 1.0)],
        };
        assert!(probe(flat, 0.1, paper).is_err());
        assert!(probe(disc(1.0), 0.1, |_| Some([f64::NAN; 3])).is_err());
        let off = probe(disc(1.0), 0.1, |_| None);
        assert_eq!(
            off,
            Err(MeasureError::OffSheet {
                found: 0,
                needed: 4
            })
        );
        // A patch as large as a field is sampled coarsely, not for hours.
        let field = probe(disc(1e6), 0.01, paper).unwrap();
        assert!(field.places < 1_000_000);
        let sliver = Patch::Rectangle {
            corners: [DVec2::ZERO, DVec2::new(1e9, 1e-3)],
        };
        assert!(probe(sliver, 0.01, paper).unwrap().places <= 1_000_000);
    }
}
