//! Control points found by correlation in two pictures of one sheet: two states or bands of a
//! side, or its recto and verso.
//!
//! 1. Both pictures are brought to one scale and freed of shading (high-passed).
//! 2. Patches of the first are correlated with the second over all shifts within reach; a peak
//!    counts if it stands out from its surface.
//! 3. The peaks are true where many of them agree on one shift, rotation and scale.
//!
//! Ink of the verso shows through the recto as a faint residue. Both are darker than paper, by
//! reflected and by transmitted light, so only a positive correlation counts there. What hides
//! it is the recto's own ink, which is masked. Two bands of one side may show the same ink dark
//! on light and light on dark, so there a negative correlation counts as much.

use glam::{DAffine2, DVec2};

use super::{
    ControlPoint, Fit,
    prepared::{Kind, Prepared},
    similarity,
};

/// A grey picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Grey {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// In rows from the top of the picture, 0 to 1, best as encoded for the eye and not linear in
    /// light. What is not finite is unknown there.
    pub values: Vec<f32>,
    /// Millimetres on the sheet from pixel to pixel.
    pub mm_per_px: f64,
}

/// A control point found in two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposed {
    /// Place on the sheet: in the first picture, in mm from its upper left corner, y down.
    pub mm: DVec2,
    /// The same place in the second picture, in its pixels (pixel centres at halves, y down).
    pub px: DVec2,
    /// Height of the correlation over the mean of all shifts, in their standard deviations;
    /// below 0 where one picture shows dark what the other shows light.
    pub z: f64,
}

impl Proposed {
    /// As the fits take it.
    pub fn control_point(&self) -> ControlPoint {
        (self.px, self.mm)
    }
}

/// `control_points` as a manifest has them, of places in a picture in pixels and on the side in mm.
pub fn control_points(places: impl Iterator<Item = (DVec2, DVec2)>) -> String {
    let lines: Vec<String> = places
        .map(|(px, mm)| {
            format!(
                "    {{ picture = [{:.1}, {:.1}], sheet_mm = [{:.2}, {:.2}] }},",
                px.x, px.y, mm.x, mm.y
            )
        })
        .collect();
    format!("control_points = [\n{}\n]", lines.join("\n"))
}

/// What two pictures have to do with each other.
#[derive(Clone, Debug, PartialEq)]
pub enum Proposal {
    /// They show one sheet.
    Matches {
        /// The control points that agree, by rows of the first picture.
        points: Vec<Proposed>,
        /// Similarity fitted to them, with a mirror in it for a verso, and their residuals.
        fit: Fit,
        /// Root of the mean square of the residuals, in mm.
        rms_mm: f64,
    },
    /// Nothing says that they do.
    DoesNotMatch {
        why: Mismatch,
        /// What stood out, although it did not suffice.
        points: Vec<Proposed>,
    },
}

/// Why two pictures are not taken to show one sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Mismatch {
    #[error("the {0} picture is empty, or its values do not fill it")]
    NoPicture(Which),
    #[error("the {0} picture's scale is not a positive number of mm per pixel")]
    NoScale(Which),
    #[error("the reach is not a positive number of mm")]
    NoReach,
    #[error(
        "the {0} picture is too small: this needs {LEAST_SIDE} pixels each way, both pictures at \
         the coarser one's scale and fine enough for the reach"
    )]
    TooSmall(Which),
    #[error("the {0} picture shows nothing: its values hardly differ")]
    Flat(Which),
    #[error("{found} of {patches} patches are found in the second picture; {needed} are needed")]
    FewPeaks {
        found: usize,
        patches: usize,
        needed: usize,
    },
    #[error("of {found} patches found in the second picture {agree} agree; {needed} are needed")]
    NoAgreement {
        found: usize,
        agree: usize,
        needed: usize,
    },
}

/// Which of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    First,
    Second,
}

impl std::fmt::Display for Which {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::First => "first",
            Self::Second => "second",
        })
    }
}

/// Smallest side of a picture, in pixels at the scale worked at.
pub const LEAST_SIDE: usize = 96;

/// A peak counts from here on, in standard deviations. Of the 10⁴ to 10⁵ shifts of a surface
/// the highest of Gaussian noise is at 4 to 4.5; lines of writing of another leaf reach 5 to 7.
pub const LEAST_Z: f64 = 7.0;

/// Peaks agree within this share of the first picture's diagonal: paper cockles, and lenses
/// distort, by less.
const AGREE: f64 = 0.003;

/// Fewer peaks than this agree by chance: two fix the similarity they agree on.
const LEAST_AGREEING: usize = 6;

/// The share of all patches, and of all peaks, that must agree. Edges of equal sheets agree too,
/// but only along the margin.
const AGREEING: f64 = 0.4;

/// How far scale and rotation (in radians) may be from those of the nominal scale: a patch
/// further off would not have correlated.
const STRETCH: f64 = 0.06;

/// Finds the places of one side's first picture in another picture of that side: another state
/// of the drawing, or another band of light.
///
/// Both pictures are best cropped to the sheet: a background that is the same in both is no sign
/// of the same drawing. `reach_mm` is how far, in mm, places may lie from where they would be if
/// the pictures' upper left corners were the same place. Time and memory grow with it; beyond a
/// sixth of the longest side it costs resolution instead. Deterministic.
///
/// Pictures that cannot be compared do not match either, and the [`Mismatch`] says why.
pub fn states(first: &Grey, second: &Grey, reach_mm: f64) -> Proposal {
    propose(first, second, reach_mm, Kind::States)
}

/// Finds the places of a recto in the picture of its verso, by the ink of the verso that shows
/// through. The verso is given as photographed, and the proposed places in it are too.
///
/// `reach_mm` is as for [`states`], for the upper left corner of the recto and the upper right
/// corner of the verso.
pub fn recto_verso(recto: &Grey, verso: &Grey, reach_mm: f64) -> Proposal {
    propose(recto, verso, reach_mm, Kind::Verso)
}

fn propose(first: &Grey, second: &Grey, reach_mm: f64, kind: Kind) -> Proposal {
    let prepared = match Prepared::new(first, second, reach_mm, kind) {
        Ok(prepared) => prepared,
        Err(why) => {
            return Proposal::DoesNotMatch {
                why,
                points: Vec::new(),
            };
        }
    };
    let (found, patches) = prepared.peaks(kind);
    // In pictures of their own size, the second still mirrored where it is a verso's.
    let to_second = prepared.mm_per_px / second.mm_per_px;
    let points: Vec<Proposed> = found
        .iter()
        .map(|&(at, shift, z)| Proposed {
            mm: at * prepared.mm_per_px,
            px: (at + shift) * to_second,
            z,
        })
        .filter(|point| {
            let size = DVec2::new(second.width as f64, second.height as f64);
            point.px.cmpge(DVec2::ZERO).all() && point.px.cmple(size).all()
        })
        .collect();
    let mirror = match kind {
        Kind::States => DAffine2::IDENTITY,
        Kind::Verso => DAffine2::from_cols_array(&[-1.0, 0.0, 0.0, 1.0, second.width as f64, 0.0]),
    };
    let as_given = |points: &[Proposed]| -> Vec<Proposed> {
        points
            .iter()
            .map(|point| Proposed {
                px: mirror.transform_point2(point.px),
                ..*point
            })
            .collect()
    };
    let no = |why| Proposal::DoesNotMatch {
        why,
        points: as_given(&points),
    };

    let share = |count: usize| LEAST_AGREEING.max((count as f64 * AGREEING).ceil() as usize);
    let needed = share(patches);
    if points.len() < needed {
        return no(Mismatch::FewPeaks {
            found: points.len(),
            patches,
            needed,
        });
    }
    let needed = needed.max(share(points.len()));
    let tolerance = AGREE * prepared.diagonal_mm();
    let (agreeing, fit) = agreement(&points, 1.0 / second.mm_per_px, tolerance);
    match fit {
        Some(fit) if agreeing.len() >= needed => {
            let squares: f64 = fit.residuals_mm.iter().map(|r| r * r).sum();
            Proposal::Matches {
                points: as_given(&agreeing),
                rms_mm: (squares / agreeing.len() as f64).sqrt(),
                fit: Fit {
                    px_from_mm: mirror * fit.px_from_mm,
                    ..fit
                },
            }
        }
        _ => no(Mismatch::NoAgreement {
            found: points.len(),
            agree: agreeing.len(),
            needed,
        }),
    }
}

/// The largest set of points that agree on a similarity, and that similarity: every two points
/// are tried (M. A. Fischler, R. C. Bolles, *Commun. ACM* 24 (1981) 381, without its chance).
fn agreement(
    points: &[Proposed],
    px_per_mm: f64,
    tolerance_mm: f64,
) -> (Vec<Proposed>, Option<Fit>) {
    let near = |px_from_mm: &DAffine2| -> Vec<Proposed> {
        let off = |p: &Proposed| px_from_mm.transform_point2(p.mm).distance(p.px) / px_per_mm;
        points
            .iter()
            .filter(|point| off(point) <= tolerance_mm)
            .copied()
            .collect()
    };
    let fitted = |points: &[Proposed]| {
        let points: Vec<ControlPoint> = points.iter().map(Proposed::control_point).collect();
        similarity(&points).ok().filter(|fit| {
            let along = fit.px_from_mm.matrix2.x_axis / px_per_mm;
            along.distance(DVec2::X) <= STRETCH
        })
    };
    let pairs = (0..points.len()).flat_map(|a| (0..a).map(move |b| [points[a], points[b]]));
    let mut best: (Vec<Proposed>, Option<Fit>) = (Vec::new(), None);
    for pair in pairs {
        let Some(fit) = fitted(&pair) else { continue };
        let agreeing = near(&fit.px_from_mm);
        if agreeing.len() > best.0.len() {
            best = (agreeing, Some(fit));
        }
    }
    // Two points are read with their errors; all that agree are better.
    for _ in 0..4 {
        let Some(fit) = fitted(&best.0) else { break };
        let agreeing = near(&fit.px_from_mm);
        if agreeing.len() < best.0.len() {
            break;
        }
        best = (agreeing, Some(fit));
    }
    let fit = fitted(&best.0);
    (best.0, fit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: usize, height: usize, value: impl Fn(usize) -> f32) -> Grey {
        Grey {
            width,
            height,
            values: (0..width * height).map(value).collect(),
            mm_per_px: 0.25,
        }
    }

    /// White noise, the same for the same seed.
    fn noise(seed: usize) -> impl Fn(usize) -> f32 {
        move |i| {
            let mixed = (i + seed * 7919 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            ((mixed >> 40) & 0xFFFF) as f32 / 65536.0
        }
    }

    fn why(first: &Grey, second: &Grey, reach_mm: f64) -> [Mismatch; 2] {
        [states, recto_verso].map(|propose| match propose(first, second, reach_mm) {
            Proposal::DoesNotMatch { why, .. } => why,
            matches @ Proposal::Matches { .. } => panic!("{matches:?}"),
        })
    }

    #[test]
    fn pictures_that_cannot_be_compared_say_why() {
        let good = grey(160, 200, noise(1));
        let empty = grey(0, 0, noise(1));
        assert_eq!(
            why(&empty, &good, 5.0),
            [Mismatch::NoPicture(Which::First); 2]
        );
        let short = Grey {
            height: 300,
            ..good.clone()
        };
        assert_eq!(
            why(&good, &short, 5.0),
            [Mismatch::NoPicture(Which::Second); 2]
        );
        let vast = Grey {
            width: usize::MAX,
            ..good.clone()
        };
        assert_eq!(
            why(&vast, &good, 5.0),
            [Mismatch::NoPicture(Which::First); 2]
        );
        let dot = grey(1, 1, noise(1));
        assert_eq!(why(&dot, &good, 5.0), [Mismatch::TooSmall(Which::First); 2]);
        let line = grey(160, 1, noise(1));
        assert_eq!(
            why(&good, &line, 5.0),
            [Mismatch::TooSmall(Which::Second); 2]
        );
        for value in [0.0, 0.7, f32::NAN, f32::INFINITY] {
            let flat = grey(160, 200, |_| value);
            assert_eq!(why(&flat, &good, 5.0), [Mismatch::Flat(Which::First); 2]);
            let [states, _] = why(&good, &flat, 5.0);
            assert_eq!(states, Mismatch::Flat(Which::Second));
        }
        for mm_per_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let scale = Grey {
                mm_per_px,
                ..good.clone()
            };
            assert_eq!(
                why(&good, &scale, 5.0),
                [Mismatch::NoScale(Which::Second); 2]
            );
        }
        for mm_per_px in [1e-300, 1e300] {
            let scale = Grey {
                mm_per_px,
                ..good.clone()
            };
            why(&scale, &good, 5.0);
            why(&scale, &scale, 5.0);
        }
        for reach in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(why(&good, &good, reach), [Mismatch::NoReach; 2]);
        }
        assert_eq!(
            why(&good, &good, 1e9),
            [Mismatch::TooSmall(Which::First); 2]
        );
    }

    #[test]
    fn a_picture_matches_itself_and_its_negative_but_no_other() {
        let first = grey(160, 200, noise(1));
        let negative = grey(160, 200, |i| 1.0 - noise(1)(i));
        for (second, sign) in [(&first, 1.0), (&negative, -1.0)] {
            let Proposal::Matches {
                points,
                fit,
                rms_mm,
            } = states(&first, second, 5.0)
            else {
                panic!("no match");
            };
            assert!(rms_mm < 0.01 && points.iter().all(|p| p.z * sign > LEAST_Z));
            let corner = fit.px_from_mm.transform_point2(DVec2::new(40.0, 50.0));
            assert!(
                corner.distance(DVec2::new(160.0, 200.0)) < 0.05,
                "{corner:?}"
            );
        }
        let [states, verso] = why(&first, &grey(160, 200, noise(2)), 5.0);
        assert!(matches!(states, Mismatch::FewPeaks { .. }), "{states}");
        // All of it is ink, which hides what might show through.
        assert_eq!(verso, Mismatch::Flat(Which::First));
    }

    #[test]
    fn the_same_peaks_at_other_places_do_not_agree() {
        let first = grey(160, 200, noise(1));
        // Bands of the picture, each pushed its own way.
        let torn = grey(160, 200, |i| {
            let [x, y] = [i % 160, i / 160];
            let push = [0, 16, 148, 8, 144][y / 40];
            noise(1)(y * 160 + (x + push) % 160)
        });
        let [states, _] = why(&first, &torn, 5.0);
        let Mismatch::NoAgreement { found, agree, .. } = states else {
            panic!("{states}");
        };
        assert!(agree * 2 < found, "{states}");
    }

    #[test]
    fn pictures_need_not_have_one_scale() {
        let coarse = grey(160, 200, noise(1));
        let fine = Grey {
            mm_per_px: 0.125,
            ..grey(320, 400, |i| noise(1)(i / 640 * 160 + i % 320 / 2))
        };
        for (first, second, px_per_mm) in [(&coarse, &fine, 8.0), (&fine, &coarse, 4.0)] {
            let proposal = states(first, second, 5.0);
            assert_eq!(proposal, states(first, second, 5.0));
            let Proposal::Matches { fit, .. } = proposal else {
                panic!("{proposal:?}");
            };
            let expected = DAffine2::from_scale(DVec2::splat(px_per_mm));
            assert!(fit.px_from_mm.abs_diff_eq(expected, 0.05), "{fit:?}");
        }
    }

    #[test]
    fn holes_do_no_harm() {
        let first = grey(160, 200, noise(1));
        let holes = grey(160, 200, |i| {
            if i % 160 > 100 && i / 160 > 120 {
                f32::NAN
            } else {
                noise(1)(i)
            }
        });
        for (a, b) in [(&first, &holes), (&holes, &first)] {
            assert!(matches!(states(a, b, 5.0), Proposal::Matches { .. }));
        }
    }

    #[test]
    fn agreement_leaves_out_what_lies_elsewhere() {
        let truth = DAffine2::from_scale_angle_translation(
            DVec2::splat(4.04),
            0.01,
            DVec2::new(20.0, -9.0),
        );
        let random = noise(5);
        let points: Vec<Proposed> = (0..30)
            .map(|i| {
                let mm = DVec2::new((i % 6) as f64, (i / 6) as f64) * 20.0;
                let astray = DVec2::new(f64::from(random(i)), f64::from(random(i + 99))) * 60.0;
                let px = truth.transform_point2(mm);
                let px = if i % 3 == 0 { px + astray + 10.0 } else { px };
                Proposed { mm, px, z: 9.0 }
            })
            .collect();
        let (agreeing, fit) = agreement(&points, 4.0, 0.4);
        assert_eq!(agreeing.len(), 20);
        let fit = fit.expect("a fit").px_from_mm;
        assert!(fit.abs_diff_eq(truth, 1e-9), "{fit}");
        // Nothing but stray points: no more than a few agree.
        let stray: Vec<Proposed> = (points.iter().enumerate())
            .map(|(i, point)| Proposed {
                px: DVec2::new(f64::from(random(i + 7)), f64::from(random(i + 77))) * 300.0,
                ..*point
            })
            .collect();
        assert!(agreement(&stray, 4.0, 0.4).0.len() < LEAST_AGREEING);
        assert_eq!(agreement(&[], 4.0, 0.4), (Vec::new(), None));
    }
}
