//! A chart that is looked for in its photograph.

use std::path::Path;

use glam::DVec2;

use super::whole;
use crate::{
    maps::ColourEncoding,
    prepare::{
        PrepareError,
        capture::Chart,
        colour::{chart::ChartError, look},
        reduced::{Reduced, step_to},
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
