//! The transform that control points ask for, and how well they agree with it.

use std::sync::Arc;

use glam::{DAffine2, DMat2, DVec2};
use serde::Serialize;

use super::{
    Centred, ControlPoint, Fit, Frame, RegistrationError, affine,
    plate::{LEAST_POINTS, Plate},
    similarity,
};
use crate::maps::Warp;

/// Places nearer than this on the sheet, in mm, or in the picture, in pixels, are one place: no
/// reading is as fine.
const ONE_PLACE: f64 = 1e-6;

/// A picture that is scaled so much less along one way than across it is pressed onto a line.
const FLAT: f64 = 0.01;

/// A point is at odds with the others whose residual is this many times the middle one: of a
/// thousand readings with normal errors the largest is at a little over three times it.
const AT_ODDS: f64 = 5.0;
/// And may be one where it is this many times the middle one of all, which it draws up itself.
const SUSPECT: f64 = 2.0;

/// What control points do to a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitKind {
    /// Shifts a picture that just covers the sheet.
    Shift,
    /// Shifts, turns and scales.
    Similarity,
    /// Also stretches and shears.
    Affine,
    /// Bends, so that every point lies where it was found.
    ThinPlate,
}

impl FitKind {
    /// What so many points are taken for that do not say.
    pub fn usual(points: usize) -> Self {
        match points {
            0 | 1 => Self::Shift,
            2 => Self::Similarity,
            _ => Self::Affine,
        }
    }

    /// How many points it takes.
    pub fn least_points(self) -> usize {
        match self {
            Self::Shift => 1,
            Self::Similarity => 2,
            Self::Affine => 3,
            Self::ThinPlate => LEAST_POINTS,
        }
    }

    /// In words.
    pub fn word(self) -> &'static str {
        match self {
            Self::Shift => "shift",
            Self::Similarity => "similarity",
            Self::Affine => "affine",
            Self::ThinPlate => "thin plate",
        }
    }
}

/// A picture put in its place by control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    pub fit: FitKind,
    /// How far each point lies from where the fit puts it, in mm on the sheet, in the order given.
    /// A thin plate goes through all of them.
    pub residuals_mm: Vec<f64>,
    /// How far each point lies from where the others alone put it; `None` where they are too few
    /// for the fit, or do not determine it.
    pub left_out_mm: Vec<Option<f64>>,
    /// From the side frame in mm to texture coordinates of the picture, or, of one that bends, of
    /// what its warp makes of it.
    pub uv_from_side: DAffine2,
    /// What bends the picture where it is loaded.
    pub warp: Option<Arc<Warp>>,
}

/// Residuals in short.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// Root of their mean square, in mm.
    pub rms_mm: f64,
    pub largest_mm: f64,
    /// Which point has the largest, counted from 1.
    pub at_point: usize,
}

/// Control points that the others contradict.
#[derive(Clone, Debug, PartialEq)]
pub struct AtOdds {
    /// Which, counted from 0, and how far it lies from where the others put it, in mm.
    pub points: Vec<(usize, f64)>,
    /// The middle one of such distances of the others, in mm.
    pub usual_mm: f64,
}

impl Residual {
    /// Of residuals in the points' order; `None` where there are none.
    pub fn of(residuals_mm: impl IntoIterator<Item = Option<f64>>) -> Option<Self> {
        let known: Vec<(usize, f64)> = residuals_mm
            .into_iter()
            .enumerate()
            .filter_map(|(i, mm)| Some((i + 1, mm?)))
            .collect();
        let (at_point, largest_mm) = known
            .iter()
            .copied()
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        let squares: f64 = known.iter().map(|(_, mm)| mm * mm).sum();
        Some(Self {
            rms_mm: (squares / known.len() as f64).sqrt(),
            largest_mm,
            at_point,
        })
    }
}

impl Fitted {
    /// Puts a picture of `pixels` on a side of `sheet_mm` by `fit`, or by what is
    /// [usual](FitKind::usual) for so many points.
    ///
    /// # Errors
    /// [`RegistrationError`] where the points do not determine the transform, where two of them
    /// are one place of the sheet or of the picture, where it folds the picture over, mirrors it or
    /// presses it onto a line, or where nothing of the picture comes to lie on the sheet.
    pub fn new(
        points: &[ControlPoint],
        fit: Option<FitKind>,
        pixels: [u32; 2],
        sheet_mm: DVec2,
    ) -> Result<Self, RegistrationError> {
        let fit = fit.unwrap_or(FitKind::usual(points.len()));
        refuse_doubled(points)?;
        let uv_from_px = DAffine2::from_scale(vector(pixels).recip());
        if fit == FitKind::ThinPlate {
            let plate = Plate::anywhere(points, 0.0)?;
            if affine(points)?.px_from_mm.matrix2.determinant() < 0.0 {
                return Err(RegistrationError::Mirrored);
            }
            let residual = |(px, mm): &ControlPoint| {
                let off = plate.px_at(*mm) - *px;
                (plate.jacobian_at(*mm).inverse() * off).length()
            };
            let residuals_mm = points.iter().map(residual).collect();
            let left_out_mm = plate.residuals_mm().to_vec();
            let warp = Warp::new(plate, pixels, sheet_mm)?;
            return Ok(Self {
                fit,
                residuals_mm,
                left_out_mm,
                uv_from_side: warp.uv_from_side(),
                warp: Some(Arc::new(warp)),
            });
        }
        let all = straight(fit, points, pixels, sheet_mm)?;
        refuse_flat_and_mirrored(points, all.px_from_mm.matrix2)?;
        let uv_from_side = uv_from_px * all.px_from_mm;
        if is_beside(uv_from_side, sheet_mm) {
            return Err(RegistrationError::Beside);
        }
        Ok(Self {
            fit,
            left_out_mm: left_out(fit, points, pixels, sheet_mm),
            uv_from_side,
            residuals_mm: all.residuals_mm,
            warp: None,
        })
    }

    /// Of the residuals.
    pub fn residual(&self) -> Option<Residual> {
        Residual::of(self.residuals_mm.iter().copied().map(Some))
    }

    /// Of the residuals of points that are left out.
    pub fn left_out(&self) -> Option<Residual> {
        Residual::of(self.left_out_mm.iter().copied())
    }

    /// The points, of those that it was fitted to, that are more than `least_mm` from where the others
    /// put them, and far more than is usual among the others; `None` where there are none, or too few
    /// to know what is usual. One after the other, the farthest first, as each of them draws all others
    /// away from where they are.
    pub fn at_odds(
        &self,
        points: &[ControlPoint],
        pixels: [u32; 2],
        sheet_mm: DVec2,
        least_mm: f64,
    ) -> Option<AtOdds> {
        let mut rest: Vec<usize> = (0..points.len()).collect();
        let mut of_rest = self.left_out_mm.clone();
        let mut found: Option<AtOdds> = None;
        // Where more contradict each other, none of them is what is usual.
        for _ in 0..points.len() / 4 {
            let Some(worst) = Residual::of(of_rest.iter().copied()) else {
                break;
            };
            let mm = worst.largest_mm;
            if mm <= least_mm || mm <= SUSPECT * median(&of_rest)? {
                break;
            }
            let point = rest.remove(worst.at_point - 1);
            let others: Vec<ControlPoint> = rest.iter().map(|i| points[*i]).collect();
            of_rest = left_out(self.fit, &others, pixels, sheet_mm);
            let Some(usual_mm) = median(&of_rest).filter(|usual| mm > AT_ODDS * usual) else {
                break;
            };
            let mut points = found.map_or_else(Vec::new, |found| found.points);
            points.push((point, mm));
            found = Some(AtOdds { points, usual_mm });
        }
        found
    }
}

/// The middle one of those that are known.
fn median(mm: &[Option<f64>]) -> Option<f64> {
    let mut known: Vec<f64> = mm.iter().copied().flatten().collect();
    known.sort_by(f64::total_cmp);
    known.get(known.len() / 2).copied()
}

fn straight(
    fit: FitKind,
    points: &[ControlPoint],
    pixels: [u32; 2],
    sheet_mm: DVec2,
) -> Result<Fit, RegistrationError> {
    match fit {
        FitKind::Shift => shift(points, pixels, sheet_mm),
        FitKind::Similarity => similarity(points),
        FitKind::Affine | FitKind::ThinPlate => affine(points),
    }
}

/// How far each point lies from where the others alone put it, in mm.
fn left_out(
    fit: FitKind,
    points: &[ControlPoint],
    pixels: [u32; 2],
    sheet_mm: DVec2,
) -> Vec<Option<f64>> {
    // As few points as the fit takes agree with it whatever they are.
    if points.len() <= fit.least_points() {
        return vec![None; points.len()];
    }
    if fit == FitKind::ThinPlate {
        let plate = Plate::anywhere(points, 0.0);
        return plate.map_or_else(
            |_| vec![None; points.len()],
            |plate| plate.residuals_mm().to_vec(),
        );
    }
    let one = |i: usize| {
        let mut others = points.to_vec();
        let (px, mm) = others.remove(i);
        let fitted = straight(fit, &others, pixels, sheet_mm).ok()?;
        Some(
            fitted
                .px_from_mm
                .inverse()
                .transform_point2(px)
                .distance(mm),
        )
    };
    (0..points.len()).map(one).collect()
}

/// Whether a picture that lies so covers nothing of a sheet. Both are convex: an edge of one of them
/// then parts them.
pub fn is_beside(uv_from_side: DAffine2, sheet_mm: DVec2) -> bool {
    const CORNERS: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let outside = |from: DAffine2, size: DVec2, of: DVec2| {
        let corners = CORNERS.map(|corner| from.transform_point2(corner * size));
        let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        high.cmple(DVec2::ZERO).any() || low.cmpge(of).any()
    };
    outside(uv_from_side, sheet_mm, DVec2::ONE)
        || outside(uv_from_side.inverse(), DVec2::ONE, sheet_mm)
}

fn vector([x, y]: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y))
}

/// The picture just covers the sheet and is shifted by the mean of what the points ask for.
fn shift(
    points: &[ControlPoint],
    pixels: [u32; 2],
    sheet_mm: DVec2,
) -> Result<Fit, RegistrationError> {
    if points.is_empty() {
        return Err(RegistrationError::TooFew {
            found: 0,
            needed: 1,
        });
    }
    let scale = vector(pixels) / sheet_mm;
    let sum: DVec2 = points.iter().map(|(px, mm)| *px - scale * *mm).sum();
    let px_from_mm =
        DAffine2::from_translation(sum / points.len() as f64) * DAffine2::from_scale(scale);
    let mm_from_px = px_from_mm.inverse();
    let residual = |(px, mm): &ControlPoint| mm_from_px.transform_point2(*px).distance(*mm);
    Ok(Fit {
        px_from_mm,
        residuals_mm: points.iter().map(residual).collect(),
    })
}

fn refuse_doubled(points: &[ControlPoint]) -> Result<(), RegistrationError> {
    for (second, (px, mm)) in points.iter().enumerate() {
        for (first, (other_px, other_mm)) in points[..second].iter().enumerate() {
            let of = if other_mm.distance(*mm) <= ONE_PLACE {
                Frame::Sheet
            } else if other_px.distance(*px) <= ONE_PLACE {
                Frame::Picture
            } else {
                continue;
            };
            return Err(RegistrationError::Doubled {
                first: first + 1,
                second: second + 1,
                of,
            });
        }
    }
    Ok(())
}

fn refuse_flat_and_mirrored(
    points: &[ControlPoint],
    px_from_mm: DMat2,
) -> Result<(), RegistrationError> {
    let squares = px_from_mm.transpose() * px_from_mm;
    // Of the singular values the product, and the sum of their squares.
    let determinant = px_from_mm.determinant();
    let sum = squares.x_axis.x + squares.y_axis.y;
    if determinant.abs() <= FLAT * sum {
        return Err(RegistrationError::Flattened);
    }
    if determinant < 0.0 || (points.len() > 2 && Centred::new(points, 2)?.is_mirrored(points)) {
        return Err(RegistrationError::Mirrored);
    }
    Ok(())
}
