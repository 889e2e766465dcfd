//! `recto import`

use std::path::PathBuf;

use super::{Failure, options, output, warn};
use crate::exchange::{self, ExchangeError, Known};

/// What help says below the options.
pub const HELP: &str = "\
FILE is one of these; a folder stands for the info.json or manifest.json in it:
  .ptm         polynomial texture map, LRGB or RGB, not compressed
  .rti         hemispherical harmonics in RGB, as RTIBuilder's HSH fitter writes them
  info.json    Relight's, with its planes beside it: ptm, hsh, rbf or bilinear
  .lp          light directions, with the photographs that they are of
  .dome        a dome calibrated in RelightLab, with a photograph for each lamp
  manifest     IIIF Presentation 3 (JSON), with its pictures beside it

Relightable images become albedo and normals of an exhibit, a IIIF manifest an exhibit with a side
for each canvas, and lamps a capture.toml for `recto prepare`. Nothing is fetched from the web:
pictures of a manifest are looked for beside it by the ends of their addresses. What had to be
assumed or left out is said. DIR is filled whole or not at all.";

#[derive(clap::Args)]
pub struct Arguments {
    /// What another program wrote
    file: PathBuf,
    /// The folder of the exhibit or the capture file, made if it is absent
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Width and height in mm of what the pictures show; without it, as the file says, or assumed
    #[arg(long, value_name = "WxH", value_parser = sheet_mm)]
    size_mm: Option<[f64; 2]>,
    /// The folder of the photographs of an .lp or .dome file; without it, the file's own
    #[arg(long, value_name = "DIR")]
    photographs: Option<PathBuf>,
}

fn sheet_mm(text: &str) -> Result<[f64; 2], String> {
    let size = options::size_mm(text)?;
    match size.iter().all(|mm| (1.0..=5000.0).contains(mm)) {
        true => Ok(size),
        false => Err("write width and height from 1 to 5000 mm, such as 285x194".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    output::can_write_folder(&arguments.out)?;
    let known = Known {
        size_mm: arguments.size_mm,
        photographs: arguments.photographs.clone(),
    };
    let imported = exchange::import(&arguments.file, &arguments.out, &known)?;
    warn(&imported.warnings);
    output::result(imported.file.display())?;
    let folder = arguments.out.display();
    if imported.is_capture {
        output::say(format_args!(
            "Make an exhibit of it with `recto prepare {} --out FOLDER`.",
            imported.file.display()
        ));
    } else {
        output::say(format_args!("Look at it with `recto show {folder}`."));
    }
    Ok(())
}

impl From<ExchangeError> for Failure {
    fn from(error: ExchangeError) -> Self {
        match error {
            ExchangeError::Faults(faults) => faults.into(),
            error => Self::Input(Box::new(error)),
        }
    }
}
