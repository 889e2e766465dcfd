//! The photographs of a side, band by band → its normals and albedo, and what else is gathered while
//! they run through, so that each is read once.

use std::path::Path;

use rayon::prelude::*;

use super::{
    PrepareError,
    albedo::Albedo,
    capture::{Capture, Light, Robustness, Shots},
    colour::correct::Correction,
    exposed, find,
    flat_field::FlatField,
    matter::{Gathering, surfaces},
    moved::{self, Stillness},
    photographs::Stack,
    residuals::Residuals,
    stereo::{
        self, Rig, Rows, Solver,
        left_out::{LeftOut, Relit, RelitOne},
    },
};
use crate::manifest::SideName;

/// A side's photographs, and the lamps as they see them.
pub(super) struct Side<'c> {
    pub side: SideName,
    pub shots: &'c Shots,
    pub rig: Rig,
}

/// What came of them.
pub(super) struct Solved {
    pub normals: Vec<[f32; 3]>,
    /// sRGB-encoded.
    pub albedo: Vec<[u16; 3]>,
    /// The factor that albedo was multiplied with where nothing says how bright the light was.
    pub assumed_exposure: Option<f64>,
    pub gathering: Gathering,
    pub fields: Vec<FlatField>,
    /// Median and 95th percentile of what the photographs leave over, in shares of their mean.
    pub residual: [f64; 2],
    /// What they leave over at each place.
    pub residuals: Residuals,
    /// The share of places at which a photograph was doubted.
    pub doubted: f64,
    pub relit: Option<Relit>,
    /// What is to be said of how the photographs are exposed.
    pub doubts: Vec<String>,
    /// Of each photograph that was left out.
    pub relit_each: Vec<RelitOne>,
    pub stillness: Stillness,
}

/// Solves the photographs of a side. Unless it is known how `still` the camera was, that is found
/// out too.
///
/// # Errors
/// Of the first file that cannot be used, and [`PrepareError::Moved`].
pub(super) fn solve_side(
    capture: &Capture,
    side: &Side<'_>,
    still: Option<Stillness>,
    correction: Option<&Correction>,
    scratch: &Path,
    tell: &mut dyn FnMut(&'static str, f64),
) -> Result<Solved, PrepareError> {
    let Side { side, shots, rig } = side;
    tell("reading grey cards", 0.0);
    let fields = find::flat_fields(capture, shots, correction, scratch)?;
    tell("looking at the surfaces", 0.02);
    let surfaces = surfaces(capture, *side, (*shots, rig), correction, &fields, scratch)?;
    let solver = Solver {
        rig: rig.clone(),
        response: surfaces.response.clone(),
        robustness: capture.relief.against_outliers,
    };
    let size = [shots.crop.width(), shots.crop.height()];
    let count = size[0] * size[1];
    let measured = matches!(capture.lamps.light, Light::FlatField { .. }) || correction.is_some();
    let mut normals: Vec<[f32; 3]> = Vec::with_capacity(count);
    let mut albedo = Albedo::new(count, measured);
    let mut residuals = Residuals::default();
    let mut left_out = LeftOut::new(&solver, size[1]);
    let mut doubted = 0;
    let mut gathering = Gathering::new(capture, *side, shots, surfaces);
    let ambient = shots.ambient.as_deref();
    let mut stack = Stack::open(
        &shots.photographs,
        ambient,
        capture.encoding,
        shots.crop,
        scratch,
    )?;
    stack.tally();
    stack.divide(&fields);
    if let (None, Some(step)) = (&still, moved::step(shots)) {
        stack.reduce(step);
    }
    let mut solved = stereo::Solved::default();
    let mut next = stack.next()?;
    while let Some(band) = next {
        let done = (band.top + band.rows) as f64 / size[1] as f64;
        // What of one band has to wait for something, the next one's reading does not wait for.
        let (ahead, ()) = rayon::join(
            || stack.next(),
            || {
                let rows = Rows {
                    planes: &band.planes,
                    width: band.width,
                    top: band.top,
                };
                left_out.add(rows);
                solver.solve_to(rows, &mut solved);
                gathering.add(&band, &solved, rig);
                if let Some(correction) = correction {
                    let [r, g, b] = &mut solved.albedo;
                    correction.apply_planes([r, g, b]);
                }
                normals.par_extend(&solved.normal);
                albedo.add(&solved.albedo);
                solved.residual.iter().for_each(|r| residuals.add(*r));
                doubted += solved.doubted;
            },
        );
        next = ahead?;
        tell("solving", 0.1 + 0.4 * done);
        stack.recycle(band);
    }
    let greys = stack.greys();
    let tallies = stack.tallies();
    exposed::check(&shots.photographs, &tallies).map_err(PrepareError::Unusable)?;
    let doubts = exposed::doubts(&shots.photographs, &tallies);
    // Its buffers are as large as a map of its own.
    drop(stack);
    let stillness = match still {
        Some(stillness) => stillness,
        None => {
            let towards = rig.standing.directions();
            moved::check_seen(shots, &towards, capture.mm_per_px, greys)?
        }
    };
    let (albedo, assumed_exposure) = albedo.finish();
    Ok(Solved {
        normals,
        albedo,
        assumed_exposure,
        gathering,
        fields,
        residual: [residuals.quantile(0.5), residuals.quantile(0.95)],
        doubted: match capture.relief.against_outliers {
            Robustness::None => 0.0,
            _ => doubted as f64 / count.max(1) as f64,
        },
        residuals,
        relit: left_out.relit(),
        doubts,
        relit_each: left_out.each(),
        stillness,
    })
}
