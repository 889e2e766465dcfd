//! Places all over a side, read before it is solved, and what its surfaces are like by them.

use std::path::Path;

use crate::{
    manifest::SideName,
    optics::medium::Matter,
    prepare::{
        PrepareError,
        albedo::exposure,
        capture::{Capture, Light, Shots},
        colour::correct::Correction,
        flat_field::FlatField,
        gloss::{
            Samples,
            first::{Surfaces, some_lamps},
        },
        photographs::Stack,
        stereo::Rig,
    },
};

/// Finds how rough paper and what is dark on it are. Of many photographs some are read.
///
/// # Errors
/// Of the first photograph that cannot be read.
pub fn surfaces(
    capture: &Capture,
    side: SideName,
    (shots, rig): (&Shots, &Rig),
    correction: Option<&Correction>,
    fields: &[FlatField],
    scratch: &Path,
) -> Result<Surfaces, PrepareError> {
    let lamps = some_lamps(rig);
    let rig = rig.only(&lamps);
    let photographs: Vec<_> = lamps
        .iter()
        .map(|i| shots.photographs[*i].clone())
        .collect();
    let fields: Vec<FlatField> = lamps
        .iter()
        .filter_map(|i| fields.get(*i).cloned())
        .collect();
    let size = [shots.crop.width(), shots.crop.height()];
    let mut samples = Samples::new(size, lamps.len(), &[]);
    let ambient = shots.ambient.as_deref();
    let mut stack = Stack::open(&photographs, ambient, capture.encoding, shots.crop, scratch)?;
    stack.thin(samples.step());
    stack.divide(&fields);
    while let Some(band) = stack.next()? {
        samples.add(&band);
        stack.recycle(band);
    }
    let level = |green: &[f32]| match (&capture.lamps.light, correction) {
        // What is white was divided out.
        (Light::FlatField { .. }, _) | (_, Some(_)) => 1.0,
        _ => 1.0 / exposure(green),
    };
    let own = capture.swatches.iter().filter(|swatch| swatch.side == side);
    let mut media = own.filter_map(|swatch| swatch.medium).peekable();
    let films =
        media.peek().is_none() || media.any(|of| matches!(of.medium().matter, Matter::Film(_)));
    Ok(Surfaces::new(&samples.seen(), &rig, &level, films))
}
