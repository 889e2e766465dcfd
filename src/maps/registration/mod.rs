//! Where another picture lies on the sheet: transforms fitted to control points.
//!
//! | what | where |
//! |---|---|
//! | shift, rotation and scale; any affine transform | [`similarity`], [`affine`] |
//! | a transform that bends | [`plate`] |
//! | the one that a picture's points ask for, with its residuals | [`Fitted`] |
//! | control points found in two pictures of one sheet | [`propose`] |
//! | how far a camera moved between two photographs | [`moved`] |

mod correlate;
mod fitted;
pub mod moved;
pub mod plate;
mod prepared;
pub mod propose;

use glam::{DAffine2, DMat2, DVec2};

pub use fitted::{AtOdds, FitKind, Fitted, Residual, is_beside};

/// One control point: a place in the picture in pixels (pixel centres at halves, y down) and the
/// same place on the side in millimetres (y down).
pub type ControlPoint = (DVec2, DVec2);

/// A transform fitted to control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// From the side frame in mm to picture pixels.
    pub px_from_mm: DAffine2,
    /// How far each control point lies from where the transform puts it, in mm on the side, in
    /// the order given.
    pub residuals_mm: Vec<f64>,
}

/// Why control points do not determine a transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegistrationError {
    #[error("{found} control points are not enough: this needs at least {needed}")]
    TooFew { found: usize, needed: usize },
    #[error("a control point is not a finite number")]
    NotFinite,
    #[error("the control points all lie in one place in the {0}; spread them over it")]
    OnePlace(Frame),
    #[error("the control points all lie on one line in the {0}; add one beside it")]
    OneLine(Frame),
    #[error("the control points fit no similarity; are their places exchanged, or mirrored?")]
    NoSimilarity,
    #[error("control points {first} and {second} lie in one place {}; remove one", of.place())]
    Doubled {
        /// Counted from 1, in the order given.
        first: usize,
        second: usize,
        of: Frame,
    },
    #[error(
        "the control points mirror the picture; are places exchanged, or counted from the bottom \
         or the right?"
    )]
    Mirrored,
    #[error("the control points press the picture onto a line; are the places of two exchanged?")]
    Flattened,
    #[error(
        "the transform folds the picture over near ({}, {}) mm on the sheet; \
         is a control point there misplaced?", near_mm[0], near_mm[1]
    )]
    Folded {
        /// The worst place, to a millimetre.
        near_mm: [i32; 2],
    },
    #[error("the control points put the whole picture beside the sheet")]
    Beside,
    #[error("the sheet has no size")]
    NoSheet,
    #[error("the smoothing must be a finite number of at least 0")]
    Smoothing,
}

/// Which of a control point's two places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    Picture,
    Sheet,
}

impl Frame {
    fn place(self) -> &'static str {
        match self {
            Self::Picture => "in the picture",
            Self::Sheet => "on the sheet",
        }
    }
}

impl std::fmt::Display for Frame {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Picture => "picture",
            Self::Sheet => "sheet",
        })
    }
}

/// What is this small a share of what it is held against is nothing but rounding.
const THIN: f64 = 1e-6;

/// Points whose spread in one direction is this small a share of that in another lie on a line:
/// reading errors, of half a pixel in a picture of a thousand, would then decide the transform.
const LINE: f64 = 1e-3;

/// Points are mirrored whose mirror image leaves this many times less of the squared residuals.
const MIRRORED: f64 = 4.0;

/// Shift, rotation and one scale from at least two control points, by least squares in the
/// picture (J. C. Gower, *Psychometrika* 40 (1975) 33, in closed form for the plane).
///
/// # Errors
/// [`RegistrationError`] where the points do not determine it.
pub fn similarity(points: &[ControlPoint]) -> Result<Fit, RegistrationError> {
    let centred = Centred::new(points, 2)?;
    // With the plane as complex numbers, px = z·mm and z = Σ conj(mm)·px / Σ |mm|².
    let (mut re, mut im, mut norm) = (0.0, 0.0, 0.0);
    for (px, mm) in centred.pairs(points) {
        re += mm.dot(px);
        im += mm.perp_dot(px);
        norm += mm.length_squared();
    }
    let z = DVec2::new(re, im) / norm;
    let scale = (centred.picture.sum() / centred.sheet.sum()).sqrt();
    if z.length() <= THIN * scale {
        return Err(RegistrationError::NoSimilarity);
    }
    let matrix = DMat2::from_cols(DVec2::new(z.x, z.y), DVec2::new(-z.y, z.x));
    Ok(centred.fit(matrix, points))
}

/// Any affine transform from at least three control points, by least squares in the picture.
///
/// # Errors
/// [`RegistrationError`] where the points do not determine it.
pub fn affine(points: &[ControlPoint]) -> Result<Fit, RegistrationError> {
    let centred = Centred::new(points, 3)?;
    centred.spans_a_plane()?;
    // Normal equations of centred points: M · Σ mm mmᵀ = Σ px mmᵀ.
    let mut cross = DMat2::ZERO;
    for (px, mm) in centred.pairs(points) {
        cross += DMat2::from_cols(px * mm.x, px * mm.y);
    }
    Ok(centred.fit(cross * centred.sheet.0.inverse(), points))
}

/// Second moments of points about their mean.
#[derive(Clone, Copy)]
struct Spread(DMat2);

impl Spread {
    fn sum(self) -> f64 {
        self.0.x_axis.x + self.0.y_axis.y
    }

    fn largest(self) -> f64 {
        let half = self.sum() / 2.0;
        let difference = (self.0.x_axis.x - self.0.y_axis.y) / 2.0;
        half + difference.hypot(self.0.x_axis.y)
    }

    fn smallest(self) -> f64 {
        // Not as a difference of nearly equal numbers.
        self.0.determinant() / self.largest()
    }
}

struct Centred {
    px_mean: DVec2,
    mm_mean: DVec2,
    picture: Spread,
    sheet: Spread,
}

impl Centred {
    fn new(points: &[ControlPoint], needed: usize) -> Result<Self, RegistrationError> {
        if points.len() < needed {
            return Err(RegistrationError::TooFew {
                found: points.len(),
                needed,
            });
        }
        if !points
            .iter()
            .all(|(px, mm)| px.is_finite() && mm.is_finite())
        {
            return Err(RegistrationError::NotFinite);
        }
        let n = points.len() as f64;
        let px_mean = points.iter().map(|(px, _)| *px).sum::<DVec2>() / n;
        let mm_mean = points.iter().map(|(_, mm)| *mm).sum::<DVec2>() / n;
        let spread = |v: DVec2| DMat2::from_cols(v * v.x, v * v.y);
        let (mut picture, mut sheet) = (DMat2::ZERO, DMat2::ZERO);
        for (px, mm) in points {
            picture += spread(*px - px_mean);
            sheet += spread(*mm - mm_mean);
        }
        let (picture, sheet) = (Spread(picture), Spread(sheet));
        for (frame, spread, mean) in [
            (Frame::Picture, picture, px_mean),
            (Frame::Sheet, sheet, mm_mean),
        ] {
            // Equal points are not exactly at their rounded mean.
            if spread.largest() <= (THIN * THIN * mean.length()).powi(2) {
                return Err(RegistrationError::OnePlace(frame));
            }
        }
        Ok(Self {
            px_mean,
            mm_mean,
            picture,
            sheet,
        })
    }

    fn spans_a_plane(&self) -> Result<(), RegistrationError> {
        for (frame, spread) in [(Frame::Picture, self.picture), (Frame::Sheet, self.sheet)] {
            if spread.smallest() <= LINE * LINE * spread.largest() {
                return Err(RegistrationError::OneLine(frame));
            }
        }
        Ok(())
    }

    /// Whether a mirror image fits the points far better than shift, rotation and scale do: of
    /// two points, or of those on a line, either fits as well.
    fn is_mirrored(&self, points: &[ControlPoint]) -> bool {
        // As in `similarity`, and with conj(mm) in the place of mm.
        let (mut upright, mut mirrored) = (DVec2::ZERO, DVec2::ZERO);
        for (px, mm) in self.pairs(points) {
            upright += DVec2::new(mm.dot(px), mm.perp_dot(px));
            let mm = DVec2::new(mm.x, -mm.y);
            mirrored += DVec2::new(mm.dot(px), mm.perp_dot(px));
        }
        let [picture, sheet] = [self.picture.sum(), self.sheet.sum()];
        let left = |z: DVec2| picture - z.length_squared() / sheet;
        let [upright, mirrored] = [left(upright), left(mirrored)];
        upright > LINE * LINE * picture && MIRRORED * mirrored < upright
    }

    fn pairs(&self, points: &[ControlPoint]) -> impl Iterator<Item = (DVec2, DVec2)> {
        points
            .iter()
            .map(|(px, mm)| (*px - self.px_mean, *mm - self.mm_mean))
    }

    fn fit(&self, matrix: DMat2, points: &[ControlPoint]) -> Fit {
        let px_from_mm = DAffine2 {
            matrix2: matrix,
            translation: self.px_mean - matrix * self.mm_mean,
        };
        let mm_from_px = px_from_mm.inverse();
        let residual = |(px, mm): &ControlPoint| mm_from_px.transform_point2(*px).distance(*mm);
        Fit {
            px_from_mm,
            residuals_mm: points.iter().map(residual).collect(),
        }
    }
}
