//! A chart that is looked for in its photograph, and the light that it lies in.

use std::path::Path;

use glam::DVec2;

use super::whole;
use crate::{
    maps::ColourEncoding,
    prepare::{
        PrepareError,
        capture::{Capture, Chart, Light},
        colour::{chart::ChartError, look},
        flat_field::FlatField,
        reduced::{Reduced, step_to},
        stereo::{Gain, Rig},
    },
};

/// The middles of the patches at the chart's corners, in pixels of its photograph: as written, or
/// as found.
///
/// # Errors
/// [`PrepareError::Chart`], and of a photograph that cannot be read.
pub(super) fn corners(
    chart: &Chart,
    encoding: ColourEncoding,
    scratch: &Path,
) -> Result<[DVec2; 4], PrepareError> {
    if let Some(corners) = chart.corners {
        return Ok(corners);
    }
    let path = &chart.photograph;
    let size = crate::maps::probe(path)?.size;
    let mut why = ChartError::NotFound;
    let mut before = 0;
    for longest in look::LONGEST_PX {
        let step = step_to(longest, size.map(|side| side as usize));
        if step == before {
            break;
        }
        before = step;
        let small = Reduced::read(path, encoding, whole(size), step, scratch)?;
        match look::find(&small, &chart.lab) {
            Ok(corners) => return Ok(corners.map(|corner| corner * step as f64)),
            Err(ChartError::NotFound) => {}
            Err(other) => why = other,
        }
    }
    Err(PrepareError::Chart {
        path: path.clone(),
        why,
    })
}

/// What the photograph of a chart of this `size` is divided by. The room's light is left in cards
/// here, as it is in the chart, which so comes out as dark as it is.
///
/// # Errors
/// Of a card that cannot be used.
pub(super) fn field(
    chart: &Chart,
    capture: &Capture,
    size: [u32; 2],
    scratch: &Path,
) -> Result<Option<FlatField>, PrepareError> {
    let read = |card: &Path, size: [u32; 2], reflectance: f64| {
        let crop = whole(size);
        FlatField::read(card, None, capture.encoding, crop, reflectance, scratch)
    };
    let lamps = match &capture.lamps.light {
        Light::FlatField {
            photographs,
            reflectance,
            ..
        } => photographs.first().map(|card| (card, *reflectance)),
        _ => None,
    };
    Ok(match (&chart.flat_field, lamps) {
        (Some(card), Some((_, reflectance))) => Some(read(card, size, reflectance)?),
        // Of the sheet's light only the first lamp's is known, in the middle.
        (Some(card), None) => Some(read(card, size, 1.0)?.fall_off()),
        (None, Some((card, reflectance))) => {
            let field = read(card, capture.recto.size, reflectance)?;
            // Of a photograph of another size nobody knows what of the picture it shows.
            let same = size == capture.recto.size;
            Some(if same { field } else { field.even() })
        }
        (None, None) => None,
    })
}

/// What a photograph of a chart of this `size`, divided by its [`field`], shows of a perfect
/// diffuser at a place in pixels.
pub(super) fn diffuser<'r>(
    chart: &Chart,
    capture: &Capture,
    rig: &'r Rig,
    size: [u32; 2],
) -> impl Fn(DVec2) -> f64 + 'r {
    let recto = &capture.recto;
    let corner = DVec2::new(f64::from(recto.crop.left), f64::from(recto.crop.top));
    // Else near lamps are taken from the middle.
    let placed = size == recto.size && chart.flat_field.is_none();
    move |at| match rig.gain {
        Gain::FlatFielded => 1.0,
        Gain::Relative(_) => {
            let lit = rig.lamp(0, if placed { at - corner } else { rig.middle_px });
            lit.gain * lit.l.z
        }
    }
}
