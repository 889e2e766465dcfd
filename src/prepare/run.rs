//! `recto prepare`: a capture → maps, a manifest and a report, all of them or none.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{
    capture::{Capture, Circle, Shots},
    colour::{
        chart::ChartError,
        correct::{Correction, Fitted},
    },
    exposed::Unusable,
    find::{self, FoundLamps},
    flat_field::FlatFieldError,
    lights::{self, Ill, ball::NoBall, sphere::NoHighlight},
    matter::{Bench, MatterReport},
    moved::{self, Moved, Stillness},
    photographs::StackError,
    relief::compare::Comparison,
    report,
    residuals::Residuals,
    shape::{Shaped, grain, shape},
    solve::{Side, Solved, solve_side},
    stage,
    stereo::{
        Gain, Rig, Standing,
        left_out::{Relit, RelitOne},
    },
    transmission::TransmissionError,
    turned, verso,
    write::{self, SideFiles, SideText},
};
use crate::{
    manifest::{Exhibit, Faults, SideName, staging::StagingError},
    maps::{MapError, room},
};

/// Why photographs could not be prepared. Every message names a file.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    #[error(transparent)]
    Map(#[from] MapError),
    #[error(transparent)]
    Stack(#[from] StackError),
    #[error(transparent)]
    FlatField(#[from] FlatFieldError),
    /// Of what was written: it should not happen.
    #[error(transparent)]
    Faults(#[from] Faults),
    #[error("{}: {why}; write circle_px as centre and radius of the whole ball, or lamps by azimuth_deg and elevation_deg", path.display())]
    Ball { path: PathBuf, why: NoHighlight },
    #[error("{}: {why}; photograph one whole ball, or write circle_px as its centre and radius in pixels", path.display())]
    NoBall { path: PathBuf, why: NoBall },
    #[error("the camera or the sheet moved: {}; photograph them again with nothing touched in between, or bring them to the place of the others and crop all alike", listed(.0))]
    Moved(Vec<Moved>),
    #[error("{}; photograph these again, or leave them out with their lamps", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Unusable(Vec<Unusable>),
    #[error("{}: {why}; correct [lamps]", file.display())]
    Lamps { file: PathBuf, why: Ill },
    #[error("{}: {why}", path.display())]
    Chart { path: PathBuf, why: ChartError },
    #[error("{}: no place is lit in all photographs; check the order of the lamps, or write intensities = \"equal\"", path.display())]
    Dark { path: PathBuf },
    #[error("{}: {why}", path.display())]
    Transmitted {
        path: PathBuf,
        why: TransmissionError,
    },
    #[error("{}: an exhibit is there already; choose another folder or remove the file", .0.display())]
    Exists(PathBuf),
    #[error("{}", StagingError::Busy(.0.clone()))]
    Busy(PathBuf),
    #[error("{}: {reason}{}", path.display(), room(reason))]
    Folder { path: PathBuf, reason: io::Error },
}

fn listed(moved: &[Moved]) -> String {
    let each: Vec<String> = moved.iter().map(Moved::to_string).collect();
    each.join("; ")
}

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What is being done, in a few words.
    pub step: &'static str,
    /// Of the whole, in 0…1.
    pub done: f64,
}

/// What came of a capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The manifest that shows the sheet.
    pub manifest: PathBuf,
    /// The side of a pixel on the sheet in mm.
    pub mm_per_px: f64,
    /// In the order of the photographs.
    pub lamps: Vec<LampFound>,
    /// The ball that they were found in.
    pub ball: Option<Circle>,
    /// How well the lamps span space, in 0…1.
    pub spread: f64,
    /// How colours were corrected; `None` without a chart.
    pub colour: Option<Fitted>,
    pub sides: Vec<SideReport>,
    /// Of each side, how far each photograph is shifted against the others.
    pub stillness: Vec<Stillness>,
    /// How the verso was put in its place; `None` without one.
    pub verso: Option<verso::Place>,
    /// How many interrupted runs left something in the folder, which was removed.
    pub interrupted: usize,
}

/// A lamp as found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampFound {
    pub azimuth_deg: f64,
    pub elevation_deg: f64,
    /// Relative to the others; `None` where a grey card says it for each place.
    pub intensity: Option<f64>,
}

/// What came of one side.
#[derive(Clone, Debug, PartialEq)]
pub struct SideReport {
    pub side: SideName,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Median and 95th percentile of what the photographs leave over, in shares of their mean.
    pub residual: [f64; 2],
    /// All of what they leave over; 0 everywhere with three lamps.
    pub residuals: Residuals,
    /// The share of places at which a photograph was doubted.
    pub doubted: f64,
    /// How well photographs that were left out of the fit are computed from the others; `None`
    /// with three lamps.
    pub relit: Option<Relit>,
    /// What is to be said of the photographs and their lamps, a sentence each.
    pub doubts: Vec<String>,
    /// The same of each photograph that was left out.
    pub relit_each: Vec<RelitOne>,
    /// The factor that albedo was multiplied with where nothing says how bright the light was.
    pub assumed_exposure: Option<f64>,
    /// Lowest and highest place of the shape at large in µm, its mean plane taken out unless its
    /// perimeter was held at 0.
    pub shape_um: [f64; 2],
    /// Of grain and strokes.
    pub grain_um: [f64; 2],
    /// What it is made of.
    pub matter: MatterReport,
    /// How the shape differs from the other surface that the capture names, in µm.
    pub compared: Option<Comparison>,
}

/// Makes maps of a capture, a manifest that shows them and a report, in the folder `out`, which
/// may be yet to be made. `progress` is told of each step.
///
/// # Errors
/// [`PrepareError`]; then nothing is in `out` that was not there before.
pub fn run(
    capture: &Capture,
    out: &Path,
    progress: &mut dyn FnMut(Progress),
) -> Result<Report, PrepareError> {
    let manifest = out.join(crate::manifest::MANIFEST);
    if manifest.exists() {
        return Err(PrepareError::Exists(manifest));
    }
    // Of the folders on the way there, those that are made here go again with it.
    let made: Vec<&Path> = out
        .ancestors()
        .take_while(|folder| !folder.exists())
        .collect();
    let folder = |path: &Path| {
        let path = path.to_owned();
        move |reason| PrepareError::Folder { path, reason }
    };
    fs::create_dir_all(out).map_err(folder(out))?;
    let result = staged(capture, out, progress);
    if result.is_err() {
        for folder in made {
            // Only if it is empty: somebody else may have put something there meanwhile.
            let _ = fs::remove_dir(folder);
        }
    }
    result
}

/// Writes everything to a folder in `out` first.
fn staged(
    capture: &Capture,
    out: &Path,
    progress: &mut dyn FnMut(Progress),
) -> Result<Report, PrepareError> {
    let stage = stage::begin(out)?;
    let scratch = stage.path();
    let mut tell = |step, done| progress(Progress { step, done });
    tell("looking for the lamps", 0.0);
    let lamps = find::lamps(capture, scratch)?;
    let both = [
        (SideName::Recto, Some(&capture.recto)),
        (SideName::Verso, capture.verso.as_ref()),
    ];
    let shots: Vec<(SideName, &Shots)> = both
        .into_iter()
        .filter_map(|(side, shots)| Some((side, shots?)))
        .collect();
    tell("comparing the photographs", 0.04);
    let mut looked = Vec::new();
    let mut seen = Vec::new();
    for (_, shots) in &shots {
        let mut side = find::look(capture, shots, &lamps, scratch)?;
        seen.push((*shots, side.greys.take()));
        looked.push(side);
    }
    let towards = lamps.standing.directions();
    let checked = moved::check_all(seen, &towards, capture, scratch)?;
    let mut sides = Vec::new();
    for ((side, shots), looked) in shots.into_iter().zip(looked) {
        let rig = looked.rig(shots)?;
        sides.push(Side { side, shots, rig });
    }
    tell("reading the chart", 0.09);
    let colour = match sides.first() {
        Some(recto) => find::correction(capture, &recto.rig, scratch)?,
        None => None,
    };
    let correction = colour.as_ref().map(|fitted| &fitted.correction);
    let mut reports = Vec::new();
    let mut texts = Vec::new();
    let mut stillness = Vec::new();
    for (i, (side, still)) in sides.iter().zip(checked).enumerate() {
        let share = 0.85 / sides.len() as f64;
        let from = 0.1 + share * i as f64;
        let mut tell = |step, done: f64| tell(step, from + share * done);
        let solved = solve_side(capture, side, still, correction, scratch, &mut tell)?;
        stillness.push(solved.stillness.clone());
        let (text, report) = prepare_side(capture, side, solved, correction, scratch, &mut tell)?;
        texts.push(text);
        reports.push(report);
    }
    let verso = capture.verso.as_ref();
    if verso.is_some() {
        tell("placing the verso", 0.95);
    }
    let placed = verso.map(|_| verso::place(scratch, capture.mm_per_px));
    let placed = placed.transpose()?;
    let report = Report {
        manifest: out.join(crate::manifest::MANIFEST),
        mm_per_px: capture.mm_per_px,
        lamps: lamps_found(&lamps, sides.first().map(|side| &side.rig)),
        ball: lamps.circle,
        spread: lamps.spread,
        colour,
        sides: reports,
        stillness,
        verso: placed,
        interrupted: stage.interrupted,
    };
    write::manifest(capture, &texts, &report, scratch)?;
    report::html(capture, &report, scratch)?;
    // What is written is what `recto check` passes.
    Exhibit::read(scratch)?;
    stage.publish()?;
    progress(Progress {
        step: "done",
        done: 1.0,
    });
    Ok(report)
}

fn lamps_found(lamps: &FoundLamps, rig: Option<&Rig>) -> Vec<LampFound> {
    let (Standing::Far(places) | Standing::Near(places)) = &lamps.standing;
    let intensities = match rig.map(|rig| &rig.gain) {
        Some(Gain::Relative(values)) => Some(values),
        _ => None,
    };
    let found = places.iter().enumerate().map(|(i, place)| {
        let [azimuth_deg, elevation_deg] = lights::angles(*place);
        LampFound {
            azimuth_deg,
            elevation_deg,
            intensity: intensities.and_then(|values| values.get(i).copied()),
        }
    });
    found.collect()
}

/// Writes the maps of one side, each as soon as nothing else needs it: of a large sheet, not all of
/// them are in memory at once.
fn prepare_side(
    capture: &Capture,
    of: &Side<'_>,
    mut solved: Solved,
    correction: Option<&Correction>,
    scratch: &Path,
    tell: &mut dyn FnMut(&'static str, f64),
) -> Result<(SideText, SideReport), PrepareError> {
    let Side { side, shots, rig } = of;
    let side = *side;
    let Solved {
        mut normals,
        albedo: mut encoded,
        assumed_exposure,
        ref mut doubts,
        ..
    } = solved;
    let mut doubts = std::mem::take(doubts);
    if turned::by_a_quarter(&normals, shots.crop.width()) {
        doubts.push(
            "the slopes found turn around as no surface's do: lamps are probably a quarter of a turn away from \
             where [lamps] says, or the photographs in another order"
                .to_owned(),
        );
    }
    let size = [shots.crop.width(), shots.crop.height()];
    tell("materials", 0.5);
    let maps = SideFiles::new(side, size, capture, scratch)?;
    let bench = Bench {
        capture,
        side,
        shots,
        rig,
        correction,
        exposure: assumed_exposure.unwrap_or(1.0),
        fields: &solved.fields,
    };
    let matter = solved
        .gathering
        .finish(&bench, &mut encoded, &mut normals, &maps, scratch)?;
    tell("relief", 0.65);
    // A file is written by one processor: the others go on.
    let (written, shaped) = rayon::join(
        || maps.albedo(&encoded),
        || shape(capture, side, &maps, normals, size[0]),
    );
    written?;
    drop(encoded);
    let Shaped {
        small,
        slopes,
        um: shape_um,
        compared,
        text: surface,
    } = shaped?;
    tell("relief", 0.8);
    let encoded = write::normal_codes(&small);
    // Before heights take their memory.
    drop(small);
    let (written, (heights, grain_um)) = rayon::join(
        || maps.normal(&encoded),
        || grain(slopes, capture.mm_per_px * 1000.0),
    );
    written?;
    tell("writing maps", 0.9);
    let text = maps.grain(&heights, grain_um, surface)?;
    let report = SideReport {
        side,
        size,
        residual: solved.residual,
        residuals: solved.residuals,
        doubted: solved.doubted,
        relit: solved.relit,
        doubts,
        relit_each: solved.relit_each,
        assumed_exposure,
        shape_um,
        grain_um,
        matter,
        compared,
    };
    Ok((text, report))
}
