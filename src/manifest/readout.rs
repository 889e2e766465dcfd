//! What overlays and stacks say at one place of a side.

use std::path::PathBuf;

use glam::DVec2;
use serde::Serialize;

use super::exhibit::{
    Band, BandMix, BandView, Drawing, LegendEntry, Overlay, OverlayKind, SideName, Stack, Wording,
};
use crate::{
    colour::{self, luminance},
    maps::{self, MapError, Rasters},
};

/// A picture that could not be read.
#[derive(Debug)]
pub struct ReadFault {
    pub path: PathBuf,
    pub error: MapError,
}

/// What an overlay says at a place.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading<'e> {
    /// The category that lies there.
    Category(&'e LegendEntry),
    /// A quantity in its unit.
    Quantity { value: f64, unit: &'e str },
    /// Linear sRGB of another picture.
    Colour([f64; 3]),
    /// A false colour of a stack, linear sRGB.
    FalseColour([f64; 3]),
    /// A difference of reflectance.
    Difference(f64),
}

/// How much is reflected in one band; `None` where its picture shows nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    pub wavelength_nm: f64,
    pub reflectance: Option<f64>,
}

impl Reading<'_> {
    /// What it says, for people; `say` words a label.
    pub fn words(&self, say: impl Fn(&Wording) -> String) -> String {
        match self {
            Self::Category(entry) => say(&entry.label),
            Self::Quantity { value, unit } => format!("{value:.4} {unit}"),
            Self::Colour(linear_srgb) => {
                let [l, a, b] = colour::lab_from_linear(*linear_srgb);
                format!("L* {l:.1}, a* {a:.1}, b* {b:.1}")
            }
            Self::FalseColour([r, g, b]) => {
                format!("false colour, linear red {r:.3}, green {g:.3}, blue {b:.3}")
            }
            Self::Difference(value) => format!("{value:+.4} of reflectance"),
        }
    }
}

impl Stack {
    /// The curve of reflectance at a place of its side, in mm from the left and top edges, by
    /// rising wavelength: linear between the pixels around it.
    ///
    /// # Errors
    /// The first picture that cannot be read.
    pub fn curve(&self, rasters: &mut Rasters, at_mm: DVec2) -> Result<Vec<CurvePoint>, ReadFault> {
        let point = |band: &Band| {
            Ok(CurvePoint {
                wavelength_nm: band.wavelength_nm,
                reflectance: reflectance(rasters, band, at_mm)?,
            })
        };
        self.bands.iter().map(point).collect()
    }
}

fn reflectance(rasters: &mut Rasters, band: &Band, at_mm: DVec2) -> Result<Option<f64>, ReadFault> {
    let file = &band.map.file;
    let uv = file.uv_from_side.transform_point2(at_mm);
    let colour =
        maps::colour_at(rasters, file, band.map.encoding, uv).map_err(|error| ReadFault {
            path: file.path.clone(),
            error,
        })?;
    Ok(colour.map(|colour| luminance(colour).clamp(0.0, 1.0)))
}

impl Overlay {
    /// What it says at a place of its side, in mm from the left and top edges; `None` where it
    /// says nothing.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn reading(
        &self,
        rasters: &mut Rasters,
        at_mm: DVec2,
    ) -> Result<Option<Reading<'_>>, ReadFault> {
        let uv = self.file.uv_from_side.transform_point2(at_mm);
        let fault = |error| ReadFault {
            path: self.file.path.clone(),
            error,
        };
        let reading = match &self.kind {
            OverlayKind::Categorical(legend) => {
                let colours: Vec<[u8; 3]> = legend.iter().map(|entry| entry.colour).collect();
                let found = maps::category_at(rasters, &self.file, &colours, uv).map_err(fault)?;
                found.map(|entry| Reading::Category(&legend[entry]))
            }
            OverlayKind::Continuous { unit, range, .. } => {
                let share = maps::value_at(rasters, &self.file, uv).map_err(fault)?;
                share.map(|share| Reading::Quantity {
                    value: range[0] + share * (range[1] - range[0]),
                    unit,
                })
            }
            OverlayKind::Picture(encoding) => {
                let colour = maps::colour_at(rasters, &self.file, *encoding, uv).map_err(fault)?;
                colour.map(Reading::Colour)
            }
            OverlayKind::Bands(view) => view.reading(rasters, at_mm)?,
        };
        Ok(reading)
    }
}

impl BandView {
    fn reading(
        &self,
        rasters: &mut Rasters,
        at_mm: DVec2,
    ) -> Result<Option<Reading<'static>>, ReadFault> {
        let values = self
            .bands
            .iter()
            .map(|band| reflectance(rasters, band, at_mm));
        let values: Option<Vec<f64>> = values.collect::<Result<_, _>>()?;
        Ok(values.map(|values| match &self.mix {
            BandMix::Difference { .. } => {
                let [first, second] = [values.first(), values.last()].map(|v| v.copied());
                Reading::Difference(first.unwrap_or_default() - second.unwrap_or_default())
            }
            BandMix::Colour(weights) => Reading::FalseColour(std::array::from_fn(|c| {
                let sum: f64 = values.iter().zip(weights).map(|(v, w)| v * w[c]).sum();
                sum.clamp(0.0, 1.0)
            })),
        }))
    }
}

impl Drawing {
    /// What each of the manifest's own overlays, and each view of a stack that is no single band,
    /// says at a place of a side.
    ///
    /// # Errors
    /// The first picture that cannot be read.
    pub fn readings(
        &self,
        rasters: &mut Rasters,
        side: SideName,
        at_mm: DVec2,
    ) -> Result<Vec<(&Overlay, Option<Reading<'_>>)>, ReadFault> {
        let on_side = self.overlays.iter().filter(|overlay| overlay.side == side);
        on_side
            .filter(|overlay| !overlay.is_single_band())
            .map(|overlay| Ok((overlay, overlay.reading(rasters, at_mm)?)))
            .collect()
    }
}

impl Overlay {
    /// Whether it is one band of a stack as it is.
    pub fn is_single_band(&self) -> bool {
        let OverlayKind::Bands(view) = &self.kind else {
            return false;
        };
        view.bands.len() == 1 && view.mix == BandMix::Colour(vec![[1.0; 3]])
    }
}
