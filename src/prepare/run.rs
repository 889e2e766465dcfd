//! `recto prepare`: a capture → maps, a manifest and a report, all of them or none.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use rayon::prelude::*;

use super::{
    capture::{Capture, Circle, Light, Robustness, Shots},
    colour::{
        chart::ChartError,
        correct::{Correction, Fitted},
    },
    find::{self, FoundLamps},
    flat_field::FlatFieldError,
    lights::{self, Ill, ball::NoBall, sphere::NoHighlight},
    matter::{Bench, Gathering, MatterReport},
    moved::{self, Moved, Stillness},
    photographs::{Stack, StackError},
    relief::{
        compare::{Comparison, range, remove_plane},
        filter::{Split, split},
        integrate::{Slopes, integrate_free},
        surface,
    },
    report, stage,
    stereo::{
        Gain, Response, Rig, Rows, Solver, Standing,
        left_out::{LeftOut, Relit},
    },
    transmission::TransmissionError,
    verso,
    write::{self, SideFiles, SideText, SrgbCodes},
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
    /// The share of places at which a photograph was doubted.
    pub doubted: f64,
    /// How well photographs that were left out of the fit are computed from the others; `None`
    /// with three lamps.
    pub relit: Option<Relit>,
    /// The factor that albedo was multiplied with where nothing says how bright the light was.
    pub assumed_exposure: Option<f64>,
    /// Lowest and highest place of the shape at large in µm, its mean plane taken out.
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
    let existed = out.exists();
    let folder = |path: &Path| {
        let path = path.to_owned();
        move |reason| PrepareError::Folder { path, reason }
    };
    fs::create_dir_all(out).map_err(folder(out))?;
    let result = staged(capture, out, progress);
    if result.is_err() && !existed {
        // Only if it is empty: somebody else may have put something there meanwhile.
        let _ = fs::remove_dir(out);
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
    tell("reading the chart", 0.03);
    let colour = find::correction(capture, scratch)?;
    let correction = colour.as_ref().map(|fitted| &fitted.correction);
    let both = [
        (SideName::Recto, Some(&capture.recto)),
        (SideName::Verso, capture.verso.as_ref()),
    ];
    let shots: Vec<(SideName, &Shots)> = both
        .into_iter()
        .filter_map(|(side, shots)| Some((side, shots?)))
        .collect();
    tell("comparing the photographs", 0.04);
    let both_shots: Vec<&Shots> = shots.iter().map(|(_, shots)| *shots).collect();
    let stillness = moved::check_all(&both_shots, &lamps.standing.directions(), capture, scratch)?;
    let mut reports = Vec::new();
    let mut sides = Vec::new();
    let mut found_rig = None;
    for (i, (side, shots)) in shots.iter().enumerate() {
        let from = 0.1 + 0.85 * i as f64 / shots_count(&both);
        let share = 0.85 / shots_count(&both);
        let mut tell = |step, done: f64| tell(step, from + share * done);
        let rig = find::rig(capture, shots, &lamps, scratch)?;
        let (text, side) =
            prepare_side(capture, *side, shots, &rig, correction, scratch, &mut tell)?;
        found_rig.get_or_insert(rig);
        sides.push(text);
        reports.push(side);
    }
    tell("placing the verso", 0.95);
    let verso = capture.verso.as_ref();
    let placed = verso.map(|_| verso::place(scratch, capture.mm_per_px));
    let placed = placed.transpose()?;
    let report = Report {
        manifest: out.join(crate::manifest::MANIFEST),
        lamps: lamps_found(&lamps, found_rig.as_ref()),
        ball: lamps.circle,
        spread: lamps.spread,
        colour,
        sides: reports,
        stillness,
        verso: placed,
        interrupted: stage.interrupted,
    };
    write::manifest(capture, &sides, &report, scratch)?;
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

fn shots_count(both: &[(SideName, Option<&Shots>); 2]) -> f64 {
    both.iter().filter(|(_, shots)| shots.is_some()).count() as f64
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

/// Solves the photographs of one side, band by band, and writes its maps, each as soon as nothing
/// else needs it: of a large sheet, not all of them are in memory at once.
fn prepare_side(
    capture: &Capture,
    side: SideName,
    shots: &Shots,
    rig: &Rig,
    correction: Option<&Correction>,
    scratch: &Path,
    tell: &mut dyn FnMut(&'static str, f64),
) -> Result<(SideText, SideReport), PrepareError> {
    tell("reading grey cards", 0.0);
    let fields = find::flat_fields(capture, shots, scratch)?;
    let solver = Solver {
        rig: rig.clone(),
        response: Response::laid_paper(),
        robustness: capture.relief.against_outliers,
    };
    let size = [shots.crop.width(), shots.crop.height()];
    let count = size[0] * size[1];
    let mut normals: Vec<[f32; 3]> = Vec::with_capacity(count);
    let mut albedo: [Vec<f32>; 3] = [0, 1, 2].map(|_| Vec::with_capacity(count));
    let mut residuals = Histogram::default();
    let mut left_out = LeftOut::new(&solver, size[1]);
    let mut doubted = 0;
    let mut gathering = Gathering::new(capture, side, shots);
    let ambient = shots.ambient.as_deref();
    let mut stack = Stack::open(
        &shots.photographs,
        ambient,
        capture.encoding,
        shots.crop,
        scratch,
    )?;
    while let Some(mut band) = stack.next()? {
        band.divide(&fields);
        let rows = Rows {
            planes: &band.planes,
            width: band.width,
            top: band.top,
        };
        left_out.add(rows);
        let mut solved = solver.solve(rows);
        gathering.add(&band, &solved, rig);
        if let Some(correction) = correction {
            let [r, g, b] = &mut solved.albedo;
            correction.apply_planes([r, g, b]);
        }
        normals.append(&mut solved.normal);
        for (all, band) in albedo.iter_mut().zip(&mut solved.albedo) {
            all.append(band);
        }
        solved.residual.iter().for_each(|r| residuals.add(*r));
        doubted += solved.doubted;
        tell(
            "solving",
            0.1 + 0.4 * (band.top + band.rows) as f64 / size[1] as f64,
        );
        stack.recycle(band);
    }
    // Its buffers are as large as a map of its own.
    drop(stack);
    let measured = matches!(capture.lamps.light, Light::FlatField { .. }) || correction.is_some();
    let assumed_exposure = (!measured).then(|| exposure(&albedo[1]));
    let mut encoded = encoded(&albedo, assumed_exposure.unwrap_or(1.0));
    drop(albedo);
    tell("materials", 0.5);
    let maps = SideFiles::new(side, size, capture, scratch)?;
    let bench = Bench {
        capture,
        side,
        shots,
        rig,
        correction,
        exposure: assumed_exposure.unwrap_or(1.0),
        fields: &fields,
    };
    let matter = gathering.finish(&bench, &mut encoded, &mut normals, &maps, scratch)?;
    tell("relief", 0.65);
    let sigma_px = (capture.relief.split_mm / capture.mm_per_px).max(0.5);
    // A file is written by one processor: the others go on.
    let (written, Split { large, small }) = rayon::join(
        || maps.albedo(&encoded),
        || split(normals, size[0], sigma_px, capture.relief.filter),
    );
    written?;
    drop(encoded);
    let um_per_px = capture.mm_per_px * 1000.0;
    let extent = |heights: &[f64]| range(heights, [0.0, 1.0]).unwrap_or_default();
    let mut shape = heights(&large.vectors, large.width, um_per_px * large.step as f64);
    if let Some(known) = capture.relief.known_range_um {
        let [low, high] = extent(&shape);
        if high > low {
            shape.iter_mut().for_each(|h| *h *= known / (high - low));
        }
    }
    let shape_um = extent(&shape);
    let compared = match (&capture.compare, side) {
        (Some(other), SideName::Recto) => {
            let mm = capture.mm_per_px * large.step as f64;
            surface::compared(&shape, large.width, mm, other)?
        }
        _ => None,
    };
    let surface = maps.shape(&shape, large.width)?;
    drop((shape, large));
    tell("relief", 0.8);
    let slopes = Slopes::of_normals(&small, size[0]);
    let encoded = write::normal_codes(&small);
    // Before heights take their memory.
    drop(small);
    let (written, grain) = rayon::join(|| maps.normal(&encoded), || heights_of(slopes, um_per_px));
    written?;
    let grain_um = extent(&grain);
    tell("writing maps", 0.9);
    let text = maps.grain(&grain, surface)?;
    let report = SideReport {
        side,
        size,
        residual: [residuals.quantile(0.5), residuals.quantile(0.95)],
        doubted: match capture.relief.against_outliers {
            Robustness::None => 0.0,
            _ => doubted as f64 / count.max(1) as f64,
        },
        relit: left_out.relit(),
        assumed_exposure,
        shape_um,
        grain_um,
        matter,
        compared,
    };
    Ok((text, report))
}

/// Heights in µm of unit normals, their mean plane taken out.
fn heights(normals: &[[f32; 3]], width: usize, um_per_px: f64) -> Vec<f64> {
    heights_of(Slopes::of_normals(normals, width), um_per_px)
}

fn heights_of(slopes: Slopes, um_per_px: f64) -> Vec<f64> {
    let width = slopes.width;
    let mut heights = integrate_free(slopes);
    remove_plane(&mut heights, width);
    heights.par_iter_mut().for_each(|h| *h *= um_per_px);
    heights
}

/// What brings the brightest paper to a white sheet's albedo, where nothing says how bright the
/// light was.
fn exposure(green: &[f32]) -> f64 {
    /// Of white paper.
    const WHITE: f64 = 0.85;
    /// What is brighter is a gleam.
    const BRIGHTEST: f64 = 0.995;
    const EVERY: usize = 7;
    let mut sampled: Vec<f32> = green.iter().step_by(EVERY).copied().collect();
    if sampled.is_empty() {
        return 1.0;
    }
    let i = ((sampled.len() - 1) as f64 * BRIGHTEST) as usize;
    let white = f64::from(*sampled.select_nth_unstable_by(i, f32::total_cmp).1);
    if white > 0.0 { WHITE / white } else { 1.0 }
}

fn encoded(albedo: &[Vec<f32>; 3], factor: f64) -> Vec<[u16; 3]> {
    let codes = SrgbCodes::new();
    let factor = factor as f32;
    (0..albedo[0].len())
        .into_par_iter()
        .map(|i| [0, 1, 2].map(|c| codes.of(albedo[c][i] * factor)))
        .collect()
}

/// Residuals counted in steps of a thousandth.
struct Histogram {
    counts: Vec<u64>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            counts: vec![0; 1001],
        }
    }
}

impl Histogram {
    fn add(&mut self, residual: f32) {
        // Casts saturate, and NaN counts as none.
        let step = ((residual * 1000.0) as usize).min(1000);
        self.counts[step] += 1;
    }

    fn quantile(&self, share: f64) -> f64 {
        let all: u64 = self.counts.iter().sum();
        let wanted = share * all as f64;
        let mut sum = 0;
        for (step, count) in self.counts.iter().enumerate() {
            sum += count;
            if sum as f64 >= wanted {
                return step as f64 / 1000.0;
            }
        }
        1.0
    }
}
