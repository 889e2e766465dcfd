//! `recto reference`

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::{
    Failure, output,
    render::{Commission, Pictures},
};
use crate::{
    manifest::exhibit::Scene,
    maps::encode,
    optics::tier::Tier,
    reference::picture::{self, Crop, Exposure, Mode, PictureError, Plate, Studio},
    shot::Picture,
};

/// The most paths of a pixel: more than anybody waits for.
const SAMPLES_MAX: u64 = 1_000_000_000;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    pictures: Pictures,
    /// Random walks for each pixel
    #[arg(long, value_name = "N", default_value = "256", value_parser = samples)]
    samples: u64,
    /// A second file, .exr: the variance of each pixel's mean
    #[arg(long, value_name = "FILE", conflicts_with = "all_scenes")]
    variance: Option<PathBuf>,
    /// Where light may leave the paper: where it entered, as the tiers have it, or wherever it
    /// gets to
    #[arg(long, default_value = Mode::default().name(), value_parser = mode())]
    mode: Mode,
    /// Decides all chance: the same seed gives the same picture
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Only this part of the picture: left, top, width and height in its pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    crop: Option<Crop>,
}

fn mode() -> impl TypedValueParser<Value = Mode> {
    PossibleValuesParser::new(Mode::ALL.map(Mode::name)).try_map(|name| {
        let named = |mode: &Mode| mode.name() == name;
        Mode::ALL.into_iter().find(named).ok_or("no such mode")
    })
}

fn samples(text: &str) -> Result<u64, String> {
    let number = text.parse().ok();
    number
        .filter(|samples| (1..=SAMPLES_MAX).contains(samples))
        .ok_or_else(|| format!("write a whole number from 1 to {SAMPLES_MAX}"))
}

fn crop(text: &str) -> Result<Crop, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => Ok(Crop {
            x,
            y,
            width,
            height,
        }),
        _ => Err("write left, top, width and height in pixels, such as 600,400,32,32".to_owned()),
    }
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    let size = arguments.pictures.size;
    let [width, height] = size;
    let whole = Crop {
        x: 0,
        y: 0,
        width,
        height,
    };
    let crop = arguments.crop.unwrap_or(whole);
    if !crop.is_within(size) {
        let Crop {
            x,
            y,
            width: across,
            height: down,
        } = crop;
        return Err(Failure::Usage(format!(
            "--crop {x},{y},{across},{down}: the picture has {width} × {height} pixels, and the \
             crop reaches to {} × {}; choose one within it, or a larger --size",
            u64::from(x) + u64::from(across),
            u64::from(y) + u64::from(down)
        )));
    }
    let variance = arguments.variance;
    if let Some(file) = &variance {
        let extension = file.extension().and_then(|extension| extension.to_str());
        if !extension.is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            return Err(Failure::Usage(format!(
                "--variance {}: the file's name must end in .exr",
                file.display()
            )));
        }
    }
    // The study tier asks for the most maps.
    let commission = arguments.pictures.commission(Tier::Study, true)?;
    if let Some(file) = &variance {
        if same_file(file, &commission.out) {
            return Err(Failure::Usage(format!(
                "--variance {}: --out names the same file; choose a file for each",
                file.display()
            )));
        }
        output::can_write_file(file, &commission.exhibit)?;
    }
    let exposure = Exposure {
        size,
        crop,
        samples: arguments.samples,
        seed: arguments.seed,
        mode: arguments.mode,
    };
    if commission.all {
        output::make_folder(&commission.out)?;
        let mut thumbnails = Vec::new();
        for scene in &commission.scenes {
            let plate = walk(&commission, scene, &exposure)?;
            thumbnails.push(commission.deliver_one(scene, &picture_of(&plate))?);
        }
        return commission.deliver_contact_sheet(&thumbnails);
    }
    for scene in &commission.scenes {
        let plate = walk(&commission, scene, &exposure)?;
        if let Some(file) = &variance {
            let narrow = narrowed(&plate.variance);
            encode::save_exr_rgb(file, plate.width, plate.height, &narrow)?;
        }
        commission.deliver(scene, &picture_of(&plate))?;
        if let Some(file) = &variance {
            output::result(file.display())?;
        }
    }
    Ok(())
}

/// Whether two paths of files, of which neither has to be there, lead to one place.
fn same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        (
            folder.canonicalize().ok(),
            path.file_name().map(OsStr::to_owned),
        )
    };
    place(a) == place(b)
}

/// Walks one scene, with a bar where somebody watches.
fn walk(commission: &Commission, scene: &Scene, exposure: &Exposure) -> Result<Plate, Failure> {
    let exhibit = &commission.exhibit;
    for sentence in picture::left_out(exhibit, scene) {
        output::say(sentence);
    }
    let Crop { width, height, .. } = exposure.crop;
    let bar = output::progress(u64::from(width) * u64::from(height));
    bar.set_message(format!("{}: the photograph undone", scene.id));
    bar.tick();
    let studio = Studio::new(
        exhibit,
        scene,
        picture::capture_paths(exposure.samples),
        exposure.seed,
    )
    .map_err(|error| match error {
        PictureError::Map(error) => Failure::from(error),
        PictureError::Layers(error) => Failure::Input(error.into()),
    })?;
    bar.set_message(scene.id.clone());
    let plate = studio.take(exposure, || bar.inc(1));
    bar.finish_and_clear();
    Ok(plate)
}

fn picture_of(plate: &Plate) -> Picture {
    Picture {
        width: plate.width,
        height: plate.height,
        pixels: narrowed(&plate.mean),
        legend: Vec::new(),
    }
}

fn narrowed(pixels: &[[f64; 3]]) -> Vec<[f32; 3]> {
    pixels.iter().map(|pixel| pixel.map(|v| v as f32)).collect()
}
