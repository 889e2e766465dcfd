//! The transform that control points ask for, and how well they agree with it.

use std::sync::Arc;

use glam::{DAffine2, DVec2};
use serde::Serialize;

use super::{
    ControlPoint, Fit, RegistrationError, affine,
    plate::{LEAST_POINTS, Plate},
    similarity,
};
use crate::maps::Warp;

/// Places nearer than this on the sheet, in mm, are one place: no reading is as fine.
const ONE_PLACE_MM: f64 = 1e-6;

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
    /// are one place of the sheet, or where it folds the picture over.
    pub fn new(
        points: &[ControlPoint],
        fit: Option<FitKind>,
        pixels: [u32; 2],
        sheet_mm: DVec2,
    ) -> Result<Self, RegistrationError> {
        let fit = fit.unwrap_or(FitKind::usual(points.len()));
        let uv_from_px = DAffine2::from_scale(vector(pixels).recip());
        let straight = |points: &[ControlPoint]| match fit {
            FitKind::Shift => shift(points, pixels, sheet_mm),
            FitKind::Similarity => similarity(points),
            FitKind::Affine | FitKind::ThinPlate => affine(points),
        };
        if fit == FitKind::ThinPlate {
            let plate = Plate::fit(points, sheet_mm, 0.0)?;
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
        let all = straight(points)?;
        refuse_doubled(points)?;
        let left_out = |i: usize| {
            let others: Vec<ControlPoint> = points
                .iter()
                .enumerate()
                .filter_map(|(k, point)| (k != i).then_some(*point))
                .collect();
            // As few points as the fit takes agree with it whatever they are.
            if points.len() <= fit.least_points() {
                return None;
            }
            let mm_from_px = straight(&others).ok()?.px_from_mm.inverse();
            let (px, mm) = points[i];
            Some(mm_from_px.transform_point2(px).distance(mm))
        };
        Ok(Self {
            fit,
            left_out_mm: (0..points.len()).map(left_out).collect(),
            uv_from_side: uv_from_px * all.px_from_mm,
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
    for (second, (_, mm)) in points.iter().enumerate() {
        let before = &points[..second];
        let same = |(_, other): &ControlPoint| other.distance(*mm) <= ONE_PLACE_MM;
        if let Some(first) = before.iter().position(same) {
            return Err(RegistrationError::Doubled {
                first: first + 1,
                second: second + 1,
            });
        }
    }
    Ok(())
}
