//! `recto show`, and `recto` alone

use std::{env, fs, path::PathBuf};

use super::{Failure, options};
use crate::{
    installation::{Installation, Use, machines::MACHINE},
    optics::tier::Tier,
    stage::say,
    visitor::{self, Manners, ShowError, ShowOptions, Waits},
    wall::house,
    wording::{FALLBACK, Spoken, Wordings, catalogue},
};

/// On a public wall that says nothing else.
const WAITS: Waits = Waits {
    idle_s: 120.0,
    countdown_s: 15.0,
};

/// The exhibit that is shown where none is named.
const SAMPLE: &str = "exhibits/landscape";

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest; without it, the sample exhibit
    exhibit: Option<PathBuf>,
    /// The scene to begin with
    #[arg(long, value_name = "ID")]
    scene: Option<String>,
    /// A link as K prints it in a window: the view to begin with
    #[arg(long, value_name = "TEXT", conflicts_with = "scene")]
    link: Option<String>,
    /// How exactly light is calculated; without it, as exactly as the exhibit asks
    #[arg(long, value_parser = options::tier())]
    tier: Option<Tier>,
    /// Width and height of the display's visible area in mm, for true size
    #[arg(long, value_name = "WxH", value_parser = options::display_mm)]
    display_mm: Option<[f64; 2]>,
    /// Width and height of the window in pixels
    #[arg(long, value_name = "WxH", value_parser = options::size_px)]
    size: Option<[u32; 2]>,
    /// Fill the display
    #[arg(long)]
    fullscreen: bool,
    /// Where E exports figures to; without it, the folder that recto was started in
    #[arg(long, value_name = "DIR")]
    export: Option<PathBuf>,
    /// For a public wall: fills the display, leads nowhere else, and tours while nobody is there
    #[arg(long)]
    kiosk: bool,
    /// The place, its displays, hours and exhibits, from a file as exhibits/installation.toml
    #[arg(long, value_name = "FILE", conflicts_with_all = ["exhibit", "scene", "link"])]
    installation: Option<PathBuf>,
    /// Which machine of the installation this is, where several carry the wall; without it,
    /// RECTO_MACHINE or the computer's own name says it
    #[arg(long, value_name = "NAME", requires = "installation")]
    machine: Option<String>,
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    let options = ShowOptions {
        scene: arguments.scene,
        link: arguments.link,
        tier: arguments.tier,
        display_mm: arguments.display_mm,
        size: arguments.size,
        fullscreen: arguments.fullscreen || arguments.kiosk,
        export: arguments.export,
        manners: Manners {
            kiosk: arguments.kiosk,
            waits: arguments.kiosk.then_some(WAITS),
            ..Manners::default()
        },
    };
    if let Some(file) = arguments.installation {
        let used = match arguments.kiosk {
            true => Use::Kiosk,
            false => Use::Desk,
        };
        let (installation, warnings) = Installation::read_for(&file, used)?;
        for warning in warnings {
            say(warning);
        }
        // A name that the environment has for all installations is none of one machine's.
        let named = || {
            env::var(MACHINE)
                .ok()
                .filter(|_| installation.machines.is_some())
        };
        let machine = arguments.machine.or_else(named);
        let machine = installation.machine(machine.as_deref(), host().as_deref())?;
        return ended(house::show(installation, machine, &options)?);
    }
    let path = arguments.exhibit.or_else(sample_exhibit).ok_or_else(|| {
        Failure::Usage(
            "name an exhibit; the sample exhibit is not here, but `recto sample exhibits` writes it"
                .to_owned(),
        )
    })?;
    ended(visitor::show(&path, &options)?)
}

/// The computer's own name, where the system tells it.
fn host() -> Option<String> {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").ok()?;
    Some(name.trim().to_owned())
}

fn ended(code: u8) -> Result<(), Failure> {
    match code {
        0 => Ok(()),
        code => Err(Failure::Ended(code)),
    }
}

/// What the keys do, for help.
pub fn keys() -> String {
    let wordings = Wordings::english();
    let spoken = Spoken {
        wordings: &wordings,
        language: FALLBACK,
    };
    let rows = catalogue::KEYS.map(|(keys, action)| {
        let keys = catalogue::keys(spoken, keys);
        format!("  {keys:38}{}", spoken.say(action))
    });
    format!("In the window:\n{}", rows.join("\n"))
}

/// The sample exhibit below the current folder, or beside the program.
fn sample_exhibit() -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(|program| program.parent());
    [Some(PathBuf::new()), beside.map(PathBuf::from)]
        .into_iter()
        .flatten()
        .map(|folder| folder.join(SAMPLE))
        .find(|exhibit| exhibit.is_dir())
}

impl From<ShowError> for Failure {
    fn from(error: ShowError) -> Self {
        match error {
            ShowError::Faults(faults) => faults.into(),
            error => Self::Device(Box::new(error)),
        }
    }
}
