//! `recto render`

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    Failure, later,
    options::{self, SceneArguments},
    output,
};
use crate::{
    develop::{self, Print},
    device,
    manifest::{Exhibit, Faults, Scene, overrides::Overrides},
    maps::encode,
    needs::{MapUse, Needs},
    optics::tier::Tier,
    shot::{Darkroom, Picture, ShotError},
    stage::Shown,
};

/// Samples along the steepest direction of a map that is seen at an angle. Straight above, more
/// than one changes the picture and costs time for nothing.
const TILTED_SAMPLES: u16 = 16;
/// Width of a picture on a contact sheet.
const THUMBNAIL_PX: u32 = 480;
/// The contact sheet's file name before its extension.
const CONTACT_SHEET: &str = "contact-sheet";

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    #[command(flatten)]
    scene: SceneArguments,
    /// States, sides or overlays against each other (not in this version yet)
    #[arg(long, value_name = "MODE:A,B")]
    compare: Option<String>,
    /// Every scene of the exhibit, and a contact sheet of them
    #[arg(long, conflicts_with_all = ["scene", "drawing"])]
    all_scenes: bool,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = options::size_px)]
    size: [u32; 2],
    /// How exactly light is calculated
    #[arg(long, default_value_t, value_parser = options::tier())]
    tier: Tier,
    /// The file to write, .png (as a display shows it) or .exr (linear light); with --all-scenes,
    /// the folder
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// What the pictures are written as.
#[derive(Clone, Copy)]
enum Format {
    Png,
    Exr,
}

impl Format {
    fn of(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(Failure::Usage(format!(
                "--out {}: the file's name must end in .png or .exr",
                path.display()
            ))),
        }
    }
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    if arguments.compare.is_some() {
        return Err(later::not_yet("--compare"));
    }
    let tier = arguments.tier;
    let (all, size, out) = (arguments.all_scenes, arguments.size, arguments.out);
    let format = if all { Format::Png } else { Format::of(&out)? };

    let exhibit = super::read(&arguments.exhibit)?;
    let (exhibit, scenes) = scenes(exhibit, arguments.scene.overrides(), all, size)?;
    if all {
        // A damaged map of the last scene must be found before the first is written.
        verify(&exhibit, &scenes, tier)?;
    }
    for sentence in &exhibit.not_shown_yet {
        output::say(sentence);
    }
    if all {
        output::can_write_folder(&out)?;
    } else {
        output::can_write_file(&out)?;
    }
    device::probe()?;

    let aspect = aspect(size);
    let exhibit = Arc::new(exhibit);
    let shown = |scene: &Scene| Shown::at_rest(exhibit.clone(), scene.clone(), tier, aspect);
    if all {
        return render_all(&scenes, &out, size, shown);
    }
    for scene in &scenes {
        let mut darkroom = Darkroom::new(samples(scene))?;
        let picture = darkroom
            .take(shown(scene), size)
            .map_err(|error| placed(&exhibit, error))?;
        match format {
            Format::Exr => {
                encode::save_exr_rgb(&out, picture.width, picture.height, &picture.pixels)?;
            }
            Format::Png => save(&out, &developed(scene, &picture))?,
        }
        output::result(out.display())?;
    }
    Ok(())
}

/// Renders every scene into a file of its own, and all of them onto a contact sheet.
fn render_all(
    scenes: &[Scene],
    out: &Path,
    size: [u32; 2],
    shown: impl Fn(&Scene) -> Shown,
) -> Result<(), Failure> {
    output::make_folder(out)?;
    let file = |id: &str| out.join(id).with_added_extension("png");
    let bar = output::progress(scenes.len() as u64);
    let mut thumbnails = Vec::new();
    // The number of samples is a darkroom's own: one for each, and one after the other.
    for wanted in [1, TILTED_SAMPLES] {
        let mut darkroom = None;
        for (at, scene) in scenes.iter().enumerate() {
            if samples(scene) != wanted {
                continue;
            }
            bar.set_message(scene.id.clone());
            let darkroom = match &mut darkroom {
                Some(darkroom) => darkroom,
                none => none.insert(Darkroom::new(wanted)?),
            };
            let print = developed(scene, &darkroom.take(shown(scene), size)?);
            save(&file(&scene.id), &print)?;
            thumbnails.push((at, print.reduced(THUMBNAIL_PX)));
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    thumbnails.sort_by_key(|(at, _)| *at);
    let thumbnails: Vec<Print> = thumbnails.into_iter().map(|(_, print)| print).collect();
    if let Some(sheet) = develop::contact_sheet(&thumbnails) {
        save(&file(CONTACT_SHEET), &sheet)?;
    }
    let ids = scenes.iter().map(|scene| scene.id.as_str());
    for id in ids.chain([CONTACT_SHEET]) {
        output::result(file(id).display())?;
    }
    Ok(())
}

/// The scenes to render, with the exhibit that they belong to.
fn scenes(
    mut exhibit: Exhibit,
    overrides: Overrides,
    all: bool,
    size: [u32; 2],
) -> Result<(Exhibit, Vec<Scene>), Failure> {
    if all && exhibit.scene(CONTACT_SHEET).is_some() {
        let why = format!("the scene {CONTACT_SHEET} and the contact sheet have one file name");
        return Err(Failure::Input(why.into()));
    }
    let ids = if all {
        let ids = exhibit.scenes.iter().map(|scene| Some(scene.id.clone()));
        ids.collect()
    } else {
        vec![overrides.scene.clone()]
    };
    let mut scenes = Vec::new();
    for scene in ids {
        let overrides = Overrides {
            scene,
            ..overrides.clone()
        };
        let (changed, mut scene) = overrides.apply(exhibit, size[0])?;
        exhibit = changed;
        let sheet = exhibit.drawing_of(&scene).size_mm;
        scene.camera = scene.camera.fitted(sheet, aspect(size));
        scenes.push(scene);
    }
    Ok((exhibit, scenes))
}

fn samples(scene: &Scene) -> u16 {
    if scene.camera.tilt.0 > 0.0 {
        TILTED_SAMPLES
    } else {
        1
    }
}

/// Decodes the maps that the scenes need, which finds damaged ones before anything is rendered,
/// and says its warnings.
fn verify(exhibit: &Exhibit, scenes: &[Scene], tier: Tier) -> Result<(), Failure> {
    let needs: Vec<Needs> = scenes
        .iter()
        .map(|scene| Needs::of(exhibit, scene, tier, false))
        .collect();
    let sides = needs.iter().flat_map(|needs| &needs.sides);
    let maps = sides.flat_map(|side| &side.maps);
    super::warn(&exhibit.verify(maps.map(MapUse::file))?);
    Ok(())
}

/// A map that cannot be decoded is a fault at the place in the manifest that names it.
fn placed(exhibit: &Exhibit, error: ShotError) -> Failure {
    match error {
        ShotError::Maps(maps) => {
            let faults = maps
                .iter()
                .map(|(path, error)| exhibit.map_fault(path, error));
            match Faults::new(faults.collect()) {
                Some(faults) => faults.into(),
                None => ShotError::Maps(maps).into(),
            }
        }
        error => error.into(),
    }
}

fn developed(scene: &Scene, picture: &Picture) -> Print {
    let Picture {
        width,
        height,
        pixels,
        legend,
    } = picture;
    Print::develop(*width, *height, pixels, legend, scene.exposure.level)
}

fn save(path: &Path, print: &Print) -> Result<(), Failure> {
    let (width, height) = (print.width, print.height);
    Ok(encode::save_png_rgb8(
        path,
        width,
        height,
        &print.pixels,
        None,
    )?)
}

/// Width over height.
fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width) / f64::from(height)
}
