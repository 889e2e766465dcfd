//! Time of the render pass, from its own span on the graphics device.

use bevy::{
    diagnostic::{DiagnosticPath, DiagnosticsStore},
    prelude::*,
    render::diagnostic::RenderDiagnosticsPlugin,
};

use super::{Floor, FloorPlugin};
use crate::{
    sheet::PaperMaterial,
    shot::{Darkroom, ShotError},
    stage::Shown,
};

/// The span of the pass that draws the sheet.
pub const PASS: &str = "render/main_opaque_pass_3d/elapsed_gpu";
/// Frames not counted, then counted, after each change of what is drawn.
const WARM_UP: usize = 2;
const FRAMES: usize = 5;

/// Why a cost could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum CostError {
    #[error(transparent)]
    Shot(#[from] ShotError),
    #[error("the graphics device does not time its passes")]
    NoTimes,
    #[error("one sheet is measured at a time, and {0} lie on the stage")]
    Sheets(usize),
}

/// Times pictures that the sheet fills.
pub struct Stopwatch {
    room: Darkroom,
    size: [u32; 2],
}

impl Stopwatch {
    /// For pictures of `size` pixels.
    ///
    /// # Errors
    /// [`CostError`] without a graphics device.
    pub fn new(size: [u32; 2]) -> Result<Self, CostError> {
        Ok(Self {
            room: room()?,
            size,
        })
    }

    /// Milliseconds of some frames of `shown`.
    ///
    /// # Errors
    /// [`CostError`] where it cannot be shown, or the device does not tell the time.
    pub fn time(&mut self, shown: Shown) -> Result<Vec<f64>, CostError> {
        self.room.arrange(shown, self.size)?;
        spans(&mut self.room, WARM_UP, FRAMES)
    }

    /// The same for the floor under the maps of `shown`.
    ///
    /// # Errors
    /// As [`Stopwatch::time`], and where more than one side of the sheet is in sight.
    pub fn time_floor(&self, shown: Shown) -> Result<Vec<f64>, CostError> {
        // A room of its own, whose stage need not know what became of its sheet.
        let mut room = room()?;
        room.arrange(shown, self.size)?;
        Floor::lay(room.world())?;
        // A new material is prepared in the first frame, and its pipeline in the second.
        room.frame()?;
        room.frame()?;
        room.finish_pipelines()?;
        spans(&mut room, WARM_UP, FRAMES)
    }
}

fn room() -> Result<Darkroom, ShotError> {
    Darkroom::with(1, |app| {
        app.add_plugins((FloorPlugin, RenderDiagnosticsPlugin));
    })
}

/// Milliseconds of the pass on the device over `frames` frames, the first `warm_up` not counted.
///
/// # Errors
/// [`CostError`] where the device does not tell the time, or is lost.
pub fn spans(room: &mut Darkroom, warm_up: usize, frames: usize) -> Result<Vec<f64>, CostError> {
    let path = DiagnosticPath::new(PASS);
    let mut spans = Vec::with_capacity(frames);
    for frame in 0..warm_up + frames {
        room.frame()?;
        let store = room.world().resource::<DiagnosticsStore>();
        let measured = store.get(&path).and_then(|diagnostic| diagnostic.value());
        if frame >= warm_up {
            spans.push(measured.ok_or(CostError::NoTimes)?);
        }
    }
    Ok(spans)
}

/// The least of `samples`, 0 of none: what else a machine does only ever adds.
pub fn least(samples: &[f64]) -> f64 {
    samples.iter().copied().reduce(f64::min).unwrap_or_default()
}

/// The middle of `samples`, which it sorts; 0 of none.
pub fn median(samples: &mut [f64]) -> f64 {
    samples.sort_by(f64::total_cmp);
    samples.get(samples.len() / 2).copied().unwrap_or_default()
}

/// The sheet on the stage: entity, mesh and material.
///
/// # Errors
/// [`CostError::Sheets`] where there is not exactly one.
pub fn sheet(world: &mut World) -> Result<(Entity, Mesh3d, PaperMaterial), CostError> {
    let mut query = world.query::<(Entity, &Mesh3d, &MeshMaterial3d<PaperMaterial>)>();
    let mut found: Vec<_> = query
        .iter(world)
        .map(|(entity, mesh, material)| (entity, mesh.clone(), material.0.clone()))
        .collect();
    let count = found.len();
    let (entity, mesh, material) = found
        .pop()
        .filter(|_| count == 1)
        .ok_or(CostError::Sheets(count))?;
    let materials = world.resource::<Assets<PaperMaterial>>();
    let material = materials.get(&material).ok_or(CostError::Sheets(0))?;
    Ok((entity, mesh, material.clone()))
}
