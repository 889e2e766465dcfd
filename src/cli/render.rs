//! `recto render`

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    Failure,
    options::{self, SceneArguments},
    output, saving,
};
use crate::{
    develop::{self, Print},
    device,
    figure::{self, bar, sidecar::Facts},
    manifest::{Exhibit, Faults, Scene, overrides::Overrides},
    maps::{MapError, encode},
    needs::{MapUse, Needs},
    optics::tier::Tier,
    shot::{Darkroom, Picture, ShotError},
    stage::{Shown, legend},
};

/// Samples along the steepest direction of a map that is seen at an angle. Straight above, more
/// than one changes the picture and costs time for nothing.
const TILTED_SAMPLES: u16 = 16;
/// Width of a picture on a contact sheet.
const THUMBNAIL_PX: u32 = 480;
/// The contact sheet's file name before its extension.
const CONTACT_SHEET: &str = "contact-sheet";

/// What is rendered, and into which files: of every command that makes pictures.
#[derive(clap::Args)]
pub struct Pictures {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    #[command(flatten)]
    scene: SceneArguments,
    /// Every scene of the exhibit, and a contact sheet of them
    #[arg(long, conflicts_with_all = ["scene", "drawing", "link"])]
    all_scenes: bool,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = options::size_px)]
    pub size: [u32; 2],
    /// The file to write, .png (as a display shows it) or .exr (linear light); with --all-scenes,
    /// the folder
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    pictures: Pictures,
    /// How exactly light is calculated
    #[arg(long, default_value_t, value_parser = options::tier())]
    tier: Tier,
    /// A figure that can be made again: a scale bar on the .png, and beside each picture a .json that
    /// says what it was made from, how large and how exactly, and by which command
    #[arg(long, conflicts_with = "save_scene")]
    figure: bool,
    /// Write the scene into the manifest as well, by this id; one that has it is replaced
    #[arg(long, value_name = "ID", conflicts_with = "all_scenes")]
    save_scene: Option<String>,
}

/// What the pictures are written as.
#[derive(Clone, Copy)]
enum Format {
    Png,
    Exr,
}

/// The scenes to render, found sound, and where their pictures go, found to be writable.
pub struct Commission {
    pub exhibit: Exhibit,
    /// One, or all with `all`.
    pub scenes: Vec<Scene>,
    pub all: bool,
    pub size: [u32; 2],
    pub out: PathBuf,
    format: Format,
    /// As given: what makes each picture again.
    path: PathBuf,
    link: Option<String>,
    overrides: Overrides,
}

/// What every picture of a figure needs.
struct Figures {
    facts: Vec<Facts>,
    face: Vec<u8>,
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

impl Pictures {
    /// Reads and checks all there is to know before anything is rendered: every fault of options
    /// and exhibit, with `verify_maps` of the pictures too, and whether the files can be written.
    pub fn commission(mut self, tier: Tier, verify_maps: bool) -> Result<Commission, Failure> {
        let (all, size, out) = (self.all_scenes, self.size, self.out);
        let format = if all { Format::Png } else { Format::of(&out)? };
        let path = self.exhibit;
        let exhibit = self.scene.read(&path)?;
        let link = self.scene.link();
        let overrides = self.scene.overrides();
        let (exhibit, mut scenes) = scenes(exhibit, overrides.clone(), all, size)?;
        // Files of light hold the numbers of a difference; its colours are for the eye.
        let compared = scenes.iter_mut().filter_map(|scene| scene.compare.as_mut());
        compared.for_each(|comparison| comparison.coded = matches!(format, Format::Png));
        if all || verify_maps {
            // A damaged map of the last scene must be found before the first is written.
            verify(&exhibit, &scenes, tier)?;
        }
        if all {
            output::can_write_folder(&out)?;
            for scene in &scenes {
                output::spares(&exhibit, &out.join(&scene.id).with_added_extension("png"))?;
            }
        } else {
            output::can_write_file(&out, &exhibit)?;
        }
        Ok(Commission {
            exhibit,
            scenes,
            all,
            size,
            out,
            format,
            path,
            link,
            overrides,
        })
    }
}

impl Commission {
    /// Writes the picture of one scene into its file, and names it.
    pub fn deliver(&self, scene: &Scene, picture: &Picture) -> Result<(), Failure> {
        match self.format {
            Format::Exr => save_exr(&self.out, picture)?,
            Format::Png => save(&self.out, &developed(scene, picture))?,
        }
        output::result(self.out.display())
    }

    /// The file of a scene among all, or of their contact sheet.
    fn file(&self, id: &str) -> PathBuf {
        self.out.join(id).with_added_extension("png")
    }

    /// Writes the picture of one scene among all; gives a small one for the contact sheet.
    pub fn deliver_one(&self, scene: &Scene, picture: &Picture) -> Result<Print, Failure> {
        let print = developed(scene, picture);
        save(&self.file(&scene.id), &print)?;
        Ok(print.reduced(THUMBNAIL_PX))
    }

    /// Writes the contact sheet, and names all files.
    pub fn deliver_contact_sheet(&self, thumbnails: &[Print]) -> Result<(), Failure> {
        if let Some(sheet) = develop::contact_sheet(thumbnails) {
            save(&self.file(CONTACT_SHEET), &sheet)?;
        }
        let ids = self.scenes.iter().map(|scene| scene.id.as_str());
        for id in ids.chain([CONTACT_SHEET]) {
            output::result(self.file(id).display())?;
        }
        Ok(())
    }

    /// Gathers what figures of all scenes need, before any is rendered.
    fn figures(&self, tier: Tier) -> Result<Figures, Failure> {
        let too_small = |(side, least): (&u32, &u32)| side < least;
        if matches!(self.format, Format::Png) && self.size.iter().zip(&bar::LEAST_PX).any(too_small)
        {
            let [width, height] = bar::LEAST_PX;
            return Err(Failure::Usage(format!(
                "--figure: a scale bar with its words needs a picture of {width}x{height} pixels or more"
            )));
        }
        let mut facts = Vec::new();
        for scene in &self.scenes {
            let out = if self.all {
                self.file(&scene.id)
            } else {
                self.out.clone()
            };
            figure::is_free(&out)?;
            let arguments = self.again(scene, tier, &out);
            let found = Facts::new(&self.exhibit, scene, tier, self.size, arguments)?;
            bar::length(&found.scale, self.size[0])
                .map_err(|error| Failure::Input(Box::new(error)))?;
            facts.push(found);
        }
        Ok(Figures {
            facts,
            face: legend::face(),
        })
    }

    /// What the program is called with to make the picture of one scene again, beside its name only.
    fn again(&self, scene: &Scene, tier: Tier, out: &Path) -> Vec<String> {
        let path = fs::canonicalize(&self.path).unwrap_or_else(|_| self.path.clone());
        let mut overrides = self.overrides.clone();
        if self.all {
            overrides.scene = Some(scene.id.clone());
        }
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        let [width, height] = self.size;
        let mut words = vec!["render".to_owned(), path.display().to_string()];
        if let Some(link) = &self.link {
            // It holds the scene.
            overrides.scene = None;
            words.extend(["--link".to_owned(), link.clone()]);
        }
        words.extend(options::written(&overrides));
        let size = format!("{width}x{height}");
        let rest = ["--size", &size, "--tier", tier.name(), "--figure", "--out"];
        words.extend(rest.map(str::to_owned));
        // A name that begins with a hyphen would be taken for an option.
        words.push(match name.starts_with('-') {
            true => format!("./{name}"),
            false => name.into_owned(),
        });
        words
    }

    /// Writes a picture of scene `k` with its sidecar; gives its print, where it is one.
    fn deliver_figure(
        &self,
        k: usize,
        picture: &Picture,
        figures: &Figures,
        out: &Path,
    ) -> Result<Option<Print>, Failure> {
        let facts = &figures.facts[k];
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        let describe = |bytes: &[u8], bar| facts.of_picture(&name, bytes, bar);
        match self.format {
            Format::Exr => {
                let write = |path: &Path| save_exr(path, picture);
                figure::save(out, write, |bytes| describe(bytes, None))?;
                Ok(None)
            }
            Format::Png => {
                let mut print = developed(&self.scenes[k], picture);
                let width = picture.width;
                let taken = |x: u32, y: u32| {
                    let at = y as usize * width as usize + x as usize;
                    picture.legend.get(at).is_some_and(|pixel| pixel[3] > 0.0)
                };
                let text_px = f64::from(legend::text_size(picture.height as f32));
                let face = figures.face.clone();
                let bar = bar::lay(&mut print, &facts.scale, text_px, face, taken)?;
                let write = |path: &Path| save(path, &print);
                figure::save(out, write, |bytes| describe(bytes, Some((bar.mm, bar.px))))?;
                Ok(Some(print))
            }
        }
    }
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    let tier = arguments.tier;
    let commission = arguments.pictures.commission(tier, false)?;
    let figures = match arguments.figure {
        true => {
            // Maps that cannot be read are to be named as faults of the manifest.
            verify(&commission.exhibit, &commission.scenes, tier)?;
            Some(commission.figures(tier)?)
        }
        false => None,
    };
    // Whatever is wrong with it is known before the picture is made.
    let draft = match (&arguments.save_scene, commission.scenes.first()) {
        (Some(id), Some(scene)) => Some(saving::draft(&commission, scene, id)?),
        _ => None,
    };
    device::probe()?;

    let size = commission.size;
    let exhibit = Arc::new(commission.exhibit.clone());
    let shown = |scene: &Scene| Shown::at_rest(exhibit.clone(), scene.clone(), tier, aspect(size));
    if commission.all {
        return render_all(&commission, figures.as_ref(), shown);
    }
    for (k, scene) in commission.scenes.iter().enumerate() {
        let mut darkroom = Darkroom::new(samples(scene))?;
        let picture = darkroom
            .take(shown(scene), size)
            .map_err(|error| placed(&exhibit, error))?;
        match &figures {
            Some(figures) => {
                let out = &commission.out;
                commission.deliver_figure(k, &picture, figures, out)?;
                output::result(out.display())?;
                output::result(figure::sidecar_of(out).display())?;
            }
            None => commission.deliver(scene, &picture)?,
        }
    }
    draft.map_or(Ok(()), |draft| saving::write(&draft))
}

/// Renders every scene into a file of its own, and all of them onto a contact sheet.
fn render_all(
    commission: &Commission,
    figures: Option<&Figures>,
    shown: impl Fn(&Scene) -> Shown,
) -> Result<(), Failure> {
    output::make_folder(&commission.out)?;
    let scenes = &commission.scenes;
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
            let picture = darkroom.take(shown(scene), commission.size)?;
            let print = match figures {
                Some(figures) => {
                    let out = commission.file(&scene.id);
                    let print = commission.deliver_figure(at, &picture, figures, &out)?;
                    print.map(|print| print.reduced(THUMBNAIL_PX))
                }
                None => Some(commission.deliver_one(scene, &picture)?),
            };
            thumbnails.extend(print.map(|print| (at, print)));
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    thumbnails.sort_by_key(|(at, _)| *at);
    let thumbnails: Vec<Print> = thumbnails.into_iter().map(|(_, print)| print).collect();
    commission.deliver_contact_sheet(&thumbnails)
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
        let aspect = exhibit.own_aspect(&scene, aspect(size));
        scene.camera = scene.camera.fitted(sheet, aspect);
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

/// Decodes the maps that the scenes and the members of their comparisons need, which finds damaged ones before anything is rendered,
/// and says its warnings.
fn verify(exhibit: &Exhibit, scenes: &[Scene], tier: Tier) -> Result<(), Failure> {
    let needs: Vec<Needs> = scenes
        .iter()
        .flat_map(|scene| exhibit.each_alone(scene))
        .map(|scene| Needs::of(exhibit, &scene, tier, false))
        .collect();
    let sides = needs.iter().flat_map(|needs| &needs.sides);
    let maps = sides.flat_map(|side| &side.maps);
    super::warn(&exhibit.verify_files(maps.flat_map(MapUse::files))?);
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

fn save(path: &Path, print: &Print) -> Result<(), MapError> {
    let (width, height) = (print.width, print.height);
    encode::save_png_rgb8(path, width, height, &print.pixels, None)
}

fn save_exr(path: &Path, picture: &Picture) -> Result<(), MapError> {
    encode::save_exr_rgb(path, picture.width, picture.height, &picture.pixels)
}

/// Width over height.
fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width) / f64::from(height)
}
