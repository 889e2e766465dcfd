//! Options that several commands share, and how their values are read.

use std::path::Path;

use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::Failure;
use crate::{
    manifest::{Exhibit, Link, SideName, overrides::Overrides},
    maps::MAX_SIDE,
    optics::tier::Tier,
};

/// What is rendered.
#[derive(clap::Args)]
pub struct SceneArguments {
    /// The scene; without it, the first
    #[arg(long, value_name = "ID")]
    scene: Option<String>,
    /// A link as K prints it in a window, instead of a scene
    #[arg(long, value_name = "TEXT", conflicts_with = "scene")]
    link: Option<String>,
    /// Another drawing, the whole sheet of it, in the light of the scene
    #[arg(long, value_name = "ID")]
    drawing: Option<String>,
    /// The side
    #[arg(long, value_name = "SIDE", value_parser = side())]
    side: Option<SideName>,
    /// The state of conservation, or none
    #[arg(long, value_name = "ID")]
    state: Option<String>,
    /// An overlay instead of the scene's own, or STACK/NM or STACK/ID of a stack of bands; several
    /// from the lowest; opacity 0 to 1; of categories, those that are shown
    #[arg(long, value_name = "ID[=OPACITY][:CATEGORY,…]")]
    overlay: Vec<String>,
    /// A lamp instead of the scene's own: the id of one, or what a manifest says of one, such as
    /// kind=distant,lux_at_sheet=1000,elevation_deg=45,azimuth_deg=135
    #[arg(long, value_name = "SPEC")]
    lamp: Vec<String>,
    /// What to change in the camera, as in a manifest, such as centre_mm=92x60,width_mm=80; or
    /// true-size@PPI, for a display of so many pixels per inch
    #[arg(long, value_name = "SPEC")]
    camera: Option<String>,
    /// Members against each other, in the light and the camera of the scene: curtain, side-by-side,
    /// loupe, blend, difference, flicker or glass, a colon, and what is compared, such as
    /// curtain:state:before,state:after,at=0.4; further keys as in a manifest
    #[arg(long, value_name = "MODE:A,B")]
    compare: Option<String>,
    /// How much of the light comes through the sheet: 1 is a light table alone, 0 the lamps alone
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true)]
    transmitted: Option<f64>,
    /// Shows the sheet other than it is, and says so on the picture: relief_only=true, exaggerate=3,
    /// stretch=[0.2,0.8], sharpen=0.5
    #[arg(long, value_name = "SPEC")]
    enhance: Option<String>,
    /// The language of the legend, by its BCP 47 tag
    #[arg(long, value_name = "TAG")]
    language: Option<String>,
}

impl SceneArguments {
    /// Reads the exhibit at `path` and says its warnings; with the scene of the link, by whose id
    /// it then goes.
    pub fn read(&mut self, path: &Path) -> Result<Exhibit, Failure> {
        let link = self.link.as_deref().map(Link::read).transpose()?;
        let (exhibit, warnings) = Exhibit::read_with(path, link.as_ref())?;
        super::warn(&warnings);
        if link.is_some() {
            self.scene = exhibit.scenes.last().map(|scene| scene.id.clone());
        }
        Ok(exhibit)
    }

    /// The text of the link, if there is one.
    pub fn link(&self) -> Option<String> {
        self.link.clone()
    }

    pub fn overrides(self) -> Overrides {
        Overrides {
            scene: self.scene,
            drawing: self.drawing,
            side: self.side,
            state: self.state,
            overlays: self.overlay,
            lamps: self.lamp,
            camera: self.camera,
            compare: self.compare,
            transmitted: self.transmitted,
            enhance: self.enhance,
            language: self.language,
        }
    }
}

/// The words that say these overrides on the command line.
pub fn written(overrides: &Overrides) -> Vec<String> {
    let Overrides {
        scene,
        drawing,
        side,
        state,
        overlays,
        lamps,
        camera,
        compare,
        transmitted,
        enhance,
        language,
    } = overrides;
    let mut words = Vec::new();
    let mut say = |name: &str, value: &str| match value.starts_with('-') {
        // Two words would be taken for two options.
        true => words.push(format!("--{name}={value}")),
        false => words.extend([format!("--{name}"), value.to_owned()]),
    };
    let mut one = |name: &str, value: Option<&str>| {
        if let Some(value) = value {
            say(name, value);
        }
    };
    one("scene", scene.as_deref());
    one("drawing", drawing.as_deref());
    one("side", side.map(SideName::word));
    one("state", state.as_deref());
    for overlay in overlays {
        one("overlay", Some(overlay));
    }
    for lamp in lamps {
        one("lamp", Some(lamp));
    }
    one("camera", camera.as_deref());
    one("compare", compare.as_deref());
    let transmitted = transmitted.map(|share| share.to_string());
    one("transmitted", transmitted.as_deref());
    one("enhance", enhance.as_deref());
    one("language", language.as_deref());
    words
}

/// Refuses a name for a table that does not end in .csv.
pub fn csv(path: &Path) -> Result<(), Failure> {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("csv") => Ok(()),
        _ => Err(Failure::Usage(format!(
            "--csv {}: the file's name must end in .csv",
            path.display()
        ))),
    }
}

pub fn side() -> impl TypedValueParser<Value = SideName> {
    const SIDES: [SideName; 2] = [SideName::Recto, SideName::Verso];
    PossibleValuesParser::new(SIDES.map(SideName::word)).try_map(|word| {
        let named = |side: &SideName| side.word() == word;
        SIDES.into_iter().find(named).ok_or("no such side")
    })
}

/// The names of all tiers.
pub fn tier() -> impl TypedValueParser<Value = Tier> {
    PossibleValuesParser::new(Tier::ALL.map(Tier::name)).try_map(|name| name.parse::<Tier>())
}

/// From 0 to 1.
fn share(text: &str) -> Result<f64, String> {
    let share = text.trim().parse().ok();
    share
        .filter(|share| (0.0..=1.0).contains(share))
        .ok_or_else(|| {
            "write a number from 0 to 1: 1 for a light table alone, 0 for the lamps alone"
                .to_owned()
        })
}

/// More than nothing, in mm.
pub fn positive_mm(text: &str) -> Result<f64, String> {
    let mm = text.trim().parse().ok();
    mm.filter(|mm: &f64| mm.is_finite() && *mm > 0.0)
        .ok_or_else(|| "write a number of mm above 0, such as 13".to_owned())
}

/// `WIDTHxHEIGHT` in pixels.
pub fn size_px(text: &str) -> Result<[u32; 2], String> {
    pair(text)
        .filter(|size: &[u32; 2]| size.iter().all(|side| (1..=MAX_SIDE).contains(side)))
        .ok_or_else(|| {
            format!("write width and height in pixels, 1 to {MAX_SIDE} each, such as 1920x1080")
        })
}

/// `WIDTHxHEIGHT` in mm.
pub fn size_mm(text: &str) -> Result<[f64; 2], String> {
    pair(text).ok_or_else(|| "write width and height in mm, such as 285x194".to_owned())
}

/// `WIDTHxHEIGHT` of a display in mm.
pub fn display_mm(text: &str) -> Result<[f64; 2], String> {
    let size = pair(text).filter(|size: &[f64; 2]| size.iter().all(|mm| (10.0..=1e5).contains(mm)));
    size.ok_or_else(|| "write width and height in mm, such as 598x336".to_owned())
}

fn pair<T: std::str::FromStr>(text: &str) -> Option<[T; 2]> {
    let (width, height) = text.split_once(['x', '×'])?;
    Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
}
