//! What `recto check` says of a sound exhibit: what its scenes require and why, the memory it
//! takes, what anchors the exposure, and where maps and constants come from.

use std::{
    collections::{BTreeMap, BTreeSet},
    f64::consts::PI,
    fmt::{self, Display},
    path::{Path, PathBuf},
};

use glam::{DAffine2, DVec3};
use serde::Serialize;

use super::{
    accuracy::{Detail, Prices, SceneAccuracy},
    output,
};
use crate::{
    colour,
    manifest::{
        Accuracy, Exhibit, Fault, Faults, Registered, Scene, SideName, Source,
        capture::{self, Mask, Photograph},
        exhibit::{CompareMode, LampKind},
        lighting::light_table_lux,
    },
    maps::registration::{FitKind, Residual},
    needs::{MapUse, Needs, SideNeeds},
    tradeoff::places::Maps,
};

/// A faulty exhibit, for programs.
#[derive(Serialize)]
pub struct Refused<'f> {
    sound: bool,
    faults: &'f Faults,
}

impl<'f> Refused<'f> {
    pub fn new(faults: &'f Faults) -> Self {
        Self {
            sound: false,
            faults,
        }
    }
}

/// A sound exhibit. `{}` is short, `{:#}` explains.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub sound: bool,
    pub manifest: PathBuf,
    pub drawings: usize,
    pub hotspots: usize,
    pub tours: usize,
    pub warnings: Vec<Fault>,
    pub photographs: Vec<PhotographReport>,
    pub registered: Vec<Registered>,
    pub scenes: Vec<SceneReport>,
    pub sources: Vec<SourceReport>,
    pub not_shown_yet: Vec<String>,
    pub accuracy: AccuracyReport,
}

/// What of a photograph no sheet of its paper gives back.
#[derive(Clone, Debug, Serialize)]
pub struct PhotographReport {
    pub drawing: String,
    pub side: SideName,
    pub state: Option<String>,
    pub file: PathBuf,
    pub pixels: u64,
    /// Pixels darker than what the surface itself mirrors.
    pub too_dark: u64,
    /// Pixels that are clipped, or lighter than any sheet.
    pub saturated: u64,
}

impl PhotographReport {
    pub fn new(exhibit: &Exhibit, photograph: &Photograph<'_>, mask: &Mask) -> Self {
        Self {
            drawing: photograph.drawing.id.clone(),
            side: photograph.side,
            state: photograph.state.map(str::to_owned),
            file: relative(exhibit, &photograph.albedo.file.path),
            pixels: mask.codes.len() as u64,
            too_dark: mask.count(capture::TOO_DARK),
            saturated: mask.count(capture::SATURATED),
        }
    }
}

/// What one scene requires of the tier that is named for it.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    pub id: String,
    pub drawing: String,
    pub side: SideName,
    /// What is shown against each other, by the mode; nothing in a scene without a comparison.
    pub compared: Option<ComparedReport>,
    /// What is shown other than it is.
    pub enhanced: Vec<String>,
    pub reasons: Vec<String>,
    pub maps: Vec<MapReport>,
    /// Bytes of its maps on the graphics device, those of all members, each counted once.
    pub gpu_bytes: u64,
    /// The same in a window, where the sheet can be turned over.
    pub gpu_bytes_in_window: u64,
    pub exposure: ExposureReport,
    pub accuracy: SceneAccuracy,
}

/// A comparison.
#[derive(Clone, Debug, Serialize)]
pub struct ComparedReport {
    pub mode: CompareMode,
    pub of: Vec<String>,
}

/// A map that a scene needs.
#[derive(Clone, Debug, Serialize)]
pub struct MapReport {
    pub side: SideName,
    pub role: &'static str,
    pub file: PathBuf,
    pub size_px: [u32; 2],
    pub gpu_bytes: u64,
}

/// What is shown at which level.
#[derive(Clone, Debug, Serialize)]
pub struct ExposureReport {
    /// A perfect diffuser at this illuminance is shown at `level`.
    pub lux: f64,
    pub level: f64,
    /// Whether the manifest says so; otherwise `light` adds up to it.
    pub declared: bool,
    /// The illuminance that each lamp, and the room, gives to the centre of the flat sheet.
    pub light: Vec<LightReport>,
}

/// The light of one lamp or of the room.
#[derive(Clone, Debug, Serialize)]
pub struct LightReport {
    pub lamp: String,
    pub lux: f64,
}

/// Where a map or constant comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct SourceReport {
    pub drawing: String,
    pub what: String,
    pub source: &'static str,
}

/// What the curator asks for.
#[derive(Clone, Debug, Serialize)]
pub struct AccuracyReport {
    pub max_delta_e: f64,
    pub frame_ms: f64,
    /// Where the costs of tiers are known from.
    pub costs: String,
}

impl Report {
    /// Of an exhibit that was read with `warnings`.
    ///
    /// # Errors
    /// The fault of a map that a scene cannot be predicted without.
    pub fn new(
        exhibit: &Exhibit,
        warnings: Vec<Fault>,
        photographs: Vec<PhotographReport>,
        prices: &Prices,
        detail: Detail,
    ) -> Result<Self, Faults> {
        let mut maps = Maps::default();
        let bar = output::progress(exhibit.scenes.len() as u64);
        let scenes: Result<Vec<SceneReport>, Faults> = exhibit
            .scenes
            .iter()
            .map(|scene| {
                bar.set_message(format!("{}: what each tier would err by", scene.id));
                bar.tick();
                let report = SceneReport::new(exhibit, scene, prices, detail, &mut maps);
                bar.inc(1);
                report
            })
            .collect();
        bar.finish_and_clear();
        let Accuracy {
            max_delta_e,
            frame_ms,
        } = exhibit.accuracy;
        Ok(Self {
            sound: true,
            manifest: exhibit.manifest.clone(),
            drawings: exhibit.drawings.len(),
            hotspots: exhibit.drawings.iter().map(|d| d.hotspots.len()).sum(),
            tours: exhibit.tours.len(),
            warnings,
            photographs,
            registered: exhibit
                .registered
                .iter()
                .map(|registered| Registered {
                    file: relative(exhibit, &registered.file),
                    ..registered.clone()
                })
                .collect(),
            scenes: scenes?,
            sources: sources(exhibit),
            not_shown_yet: exhibit.not_shown_yet.clone(),
            accuracy: AccuracyReport {
                max_delta_e,
                frame_ms,
                costs: prices.words.clone(),
            },
        })
    }
}

impl SceneReport {
    fn new(
        exhibit: &Exhibit,
        scene: &Scene,
        prices: &Prices,
        detail: Detail,
        held: &mut Maps,
    ) -> Result<Self, Faults> {
        let accuracy = SceneAccuracy::new(exhibit, scene, prices, detail, held)
            .map_err(|fault| exhibit.map_fault(&fault.path, &fault.error))?;
        let tier = accuracy.chosen;
        let drawing = exhibit.drawing_of(scene);
        let compared = scene.compare.as_ref().map(|comparison| ComparedReport {
            mode: comparison.mode,
            of: comparison
                .of
                .iter()
                .map(|member| exhibit.written_member(drawing, *member))
                .collect(),
        });
        let mut reasons = Vec::new();
        let (mut maps, mut in_window) = (Vec::new(), Vec::new());
        for (k, member) in exhibit.each_alone(scene).iter().enumerate() {
            let needs = Needs::of(exhibit, member, tier, false);
            distinct(&mut maps, needs.sides);
            distinct(&mut in_window, Needs::of(exhibit, member, tier, true).sides);
            let of = compared.as_ref().and_then(|compared| compared.of.get(k));
            reasons.extend(needs.reasons.into_iter().map(|reason| match of {
                Some(of) => format!("{of}: {reason}"),
                None => reason,
            }));
        }
        let bytes = |maps: &[(SideName, MapUse)]| maps.iter().map(|(_, map)| map.gpu_bytes()).sum();
        let gpu_bytes = bytes(&maps);
        let maps = maps.into_iter().map(|(side, map)| MapReport {
            side,
            role: map.role(),
            file: relative(exhibit, &map.file().path),
            size_px: map.file().size,
            gpu_bytes: map.gpu_bytes(),
        });
        Ok(Self {
            id: scene.id.clone(),
            drawing: drawing.id.clone(),
            side: scene.side,
            compared,
            enhanced: scene.enhance.marks(),
            maps: maps.collect(),
            gpu_bytes,
            gpu_bytes_in_window: bytes(&in_window),
            exposure: ExposureReport::new(exhibit, scene),
            reasons,
            accuracy,
        })
    }
}

/// Adds those maps of `sides` that are not there yet, wherever they lie on the sheet: they are loaded
/// once.
fn distinct(maps: &mut Vec<(SideName, MapUse)>, sides: Vec<SideNeeds>) {
    let pixels = |map: &MapUse| {
        let mut map = match map {
            // Both are pictures of a side.
            MapUse::OtherAlbedo(colour) => MapUse::Albedo(colour.clone()),
            map => map.clone(),
        };
        map.file_mut().uv_from_side = DAffine2::IDENTITY;
        map
    };
    for side in sides {
        for map in side.maps {
            let same = |(_, known): &(SideName, MapUse)| pixels(known) == pixels(&map);
            if !maps.iter().any(same) {
                maps.push((side.side, map));
            }
        }
    }
}

impl ExposureReport {
    fn new(exhibit: &Exhibit, scene: &Scene) -> Self {
        let lighting = exhibit.lighting(scene);
        // Amounts are exposed; this takes them back to lx.
        let lux = |exposed: DVec3| colour::luminance(exposed.into()) * lighting.reference_lux / PI;
        let lamps = scene
            .lamps
            .iter()
            .map(|lamp| &exhibit.lamps[*lamp])
            .filter(|lamp| !lamp.kind.is_behind());
        let mut light: Vec<LightReport> = lamps
            .zip(&lighting.lights)
            .map(|(lamp, light)| LightReport {
                lamp: lamp.id.clone(),
                lux: lux(light.illuminance(DVec3::ZERO, DVec3::Z)),
            })
            .collect();
        for lamp in scene.lamps.iter().map(|lamp| &exhibit.lamps[*lamp]) {
            if let LampKind::LightTable { luminance } = lamp.kind {
                light.push(LightReport {
                    lamp: lamp.id.clone(),
                    lux: light_table_lux(luminance.0),
                });
            }
        }
        if scene.ambient.illuminance.0 > 0.0 {
            light.push(LightReport {
                lamp: "the room".to_owned(),
                lux: scene.ambient.illuminance.0,
            });
        }
        Self {
            lux: lighting.reference_lux,
            level: scene.exposure.level,
            declared: scene.exposure.illuminance.is_some(),
            light,
        }
    }
}

fn sources(exhibit: &Exhibit) -> Vec<SourceReport> {
    let mut all = Vec::new();
    for drawing in &exhibit.drawings {
        let report = |what: String, source: Source| SourceReport {
            drawing: drawing.id.clone(),
            what,
            source: word(source),
        };
        let paper = &drawing.paper;
        let constants = format!(
            "paper: {}, {} thick, roughness {}, index {}",
            paper.kind, paper.thickness, paper.roughness, paper.index
        );
        all.push(report(constants, paper.source));
        let media: BTreeSet<usize> = drawing
            .media_maps()
            .flat_map(|map| map.content.media())
            .collect();
        all.extend(media.into_iter().map(|medium| {
            let medium = &exhibit.media[medium];
            report(
                format!("{} ({})", medium.name, medium.origin),
                medium.source,
            )
        }));
        // One file may serve several states; what is said of it last holds.
        let files: BTreeMap<PathBuf, Source> = drawing
            .maps()
            .map(|map| (relative(exhibit, &map.path), map.source))
            .collect();
        let maps = files.into_iter();
        all.extend(maps.map(|(file, source)| report(file.display().to_string(), source)));
    }
    all
}

fn relative(exhibit: &Exhibit, path: &Path) -> PathBuf {
    path.strip_prefix(&exhibit.folder)
        .unwrap_or(path)
        .to_owned()
}

fn word(source: Source) -> &'static str {
    match source {
        Source::Measured => "measured",
        Source::Fitted => "fitted",
        Source::Assumed => "assumed",
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: sound: {}, {}, {}, {}, {}",
            self.manifest.display(),
            counted(self.drawings, "drawing"),
            counted(self.hotspots, "hotspot"),
            counted(self.scenes.len(), "scene"),
            counted(self.tours, "tour"),
            counted(self.warnings.len(), "warning"),
        )?;
        let most = self.scenes.iter().max_by_key(|s| s.gpu_bytes_in_window);
        if let Some(scene) = most {
            write!(
                f,
                "\nGraphics memory for maps: {} at most, in a window (scene {})",
                mebibytes(scene.gpu_bytes_in_window),
                scene.id
            )?;
        }
        if f.alternate() {
            for scene in &self.scenes {
                write!(f, "\n\n{scene}")?;
            }
            f.write_str("\n\nWhere things come from")?;
            for source in &self.sources {
                write!(
                    f,
                    "\n  {}: {}: {}",
                    source.drawing, source.what, source.source
                )?;
            }
            f.write_str("\n")?;
        }
        for registered in &self.registered {
            write!(f, "\n{registered}")?;
        }
        for photograph in &self.photographs {
            if f.alternate() || photograph.too_dark + photograph.saturated > 0 {
                write!(f, "\n{photograph}")?;
            }
        }
        write!(
            f,
            "\nAccuracy asked for: ΔE00 {} in the mean over the visible sheet, {} ms a frame while \
             something moves. {}",
            self.accuracy.max_delta_e, self.accuracy.frame_ms, self.accuracy.costs
        )?;
        if !f.alternate() {
            for scene in &self.scenes {
                write!(f, "\n  {}: {}", scene.id, scene.accuracy)?;
            }
        }
        if !self.not_shown_yet.is_empty() {
            f.write_str("\nRead and checked, but not shown by this version:")?;
        }
        for sentence in &self.not_shown_yet {
            write!(f, "\n  {sentence}")?;
        }
        Ok(())
    }
}

impl Display for PhotographReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |count: u64| {
            let share = 100.0 * count as f64 / self.pixels.max(1) as f64;
            format!("{count} pixels ({share:.2}%)")
        };
        write!(
            f,
            "Photograph {} ({}",
            self.file.display(),
            self.side.word()
        )?;
        if let Some(state) = &self.state {
            write!(f, ", {state}")?;
        }
        write!(
            f,
            "): {} darker than what the paper's surface mirrors, {} clipped or lighter than any \
             sheet; gallery and study do not give them back (--masks shows where)",
            share(self.too_dark),
            share(self.saturated)
        )
    }
}

impl Display for Registered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Registered {} ({}): ", self.file.display(), self.place)?;
        let Some(fit) = self.fit else {
            return f.write_str("by offset, turn and scale; without control points no residual");
        };
        write!(f, "{} by {}", fit.word(), counted(self.points, "point"))?;
        match (&self.left_out, &self.residual) {
            (Some(left_out), _) if fit == FitKind::ThinPlate => {
                f.write_str(", through all of them; each left out, it lies ")?;
                spread(f, left_out)
            }
            (Some(left_out), Some(residual)) => {
                f.write_str(", residual ")?;
                spread(f, residual)?;
                f.write_str("; each left out, it lies ")?;
                spread(f, left_out)
            }
            _ => write!(f, ", as many as it takes, so that nothing tests them"),
        }
    }
}

fn spread(f: &mut fmt::Formatter<'_>, of: &Residual) -> fmt::Result {
    write!(
        f,
        "{:.3} mm (root mean square), {:.3} mm at most (point {})",
        of.rms_mm, of.largest_mm, of.at_point
    )
}

impl Display for SceneReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Scene {} ({}, {})",
            self.id,
            self.drawing,
            self.side.word()
        )?;
        if let Some(ComparedReport { mode, of }) = &self.compared {
            write!(
                f,
                "\n  {} of {}, whose maps are all loaded",
                mode.word(),
                of.join(" and ")
            )?;
        }
        if !self.enhanced.is_empty() {
            write!(
                f,
                "\n  enhanced for the eye, and said so on the picture: {}; what is measured stays as it is",
                self.enhanced.join("; ")
            )?;
        }
        for reason in &self.reasons {
            write!(f, "\n  {reason}")?;
        }
        for map in &self.maps {
            let [width, height] = map.size_px;
            write!(
                f,
                "\n  {}: {} map, {}, {width} × {height} pixels, {}",
                map.side.word(),
                map.role,
                map.file.display(),
                mebibytes(map.gpu_bytes)
            )?;
        }
        write!(
            f,
            "\n  memory for maps: {}, in a window {}",
            mebibytes(self.gpu_bytes),
            mebibytes(self.gpu_bytes_in_window)
        )?;
        let ExposureReport {
            lux,
            level,
            declared,
            light,
        } = &self.exposure;
        let anchor = if *declared {
            "as the manifest says; its light gives to the centre of the sheet"
        } else {
            "which its light gives to the centre of the sheet"
        };
        write!(
            f,
            "\n  exposure: a perfect white at {lux:.1} lx is shown at level {level}, {anchor}:"
        )?;
        for (i, LightReport { lamp, lux }) in light.iter().enumerate() {
            let comma = if i > 0 { "," } else { "" };
            write!(f, "{comma} {lamp} {lux:.1} lx")?;
        }
        write!(f, "\n  {:#}", self.accuracy)
    }
}

pub(super) fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}
