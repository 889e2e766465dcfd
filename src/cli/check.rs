//! `recto check`

use std::path::{Path, PathBuf};

use super::{
    Failure,
    accuracy::{Detail, Prices},
    output, place,
    report::{PhotographReport, Refused, Report},
};
use crate::{
    manifest::{Exhibit, Faults, capture::Mask},
    maps::encode,
};

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    #[arg(required_unless_present = "installation")]
    exhibit: Option<PathBuf>,
    /// Check an installation file instead, and every exhibit that it names
    #[arg(long, value_name = "FILE", conflicts_with_all = ["exhibit", "explain", "json", "masks"])]
    installation: Option<PathBuf>,
    /// Say what each scene requires and why, and where each map and constant comes from
    #[arg(long)]
    explain: bool,
    /// Say all of it as JSON
    #[arg(long)]
    json: bool,
    /// Write a mask of each photograph into this folder: black where a sheet lit and seen as it
    /// was photographed gives it back, grey where the photograph is darker than what the surface
    /// mirrors, white where it is clipped or lighter than any sheet
    #[arg(long, value_name = "DIR")]
    masks: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.installation {
        return place::check(file);
    }
    if let Some(folder) = &arguments.masks {
        output::can_write_folder(folder)?;
    }
    match report(arguments) {
        Ok((report, masks)) => {
            if let Some(folder) = &arguments.masks {
                output::make_folder(folder)?;
                for (name, Mask { size, codes }) in &masks {
                    let file = folder.join(name).with_added_extension("png");
                    encode::save_png_grey8(&file, size[0], size[1], codes, None)?;
                }
            }
            say(arguments, &report)
        }
        Err(faults) => {
            if arguments.json {
                output::result(json(&Refused::new(&faults))?)?;
            }
            Err(faults.into())
        }
    }
}

fn say(arguments: &Arguments, report: &Report) -> Result<(), Failure> {
    match report {
        report if arguments.json => output::result(json(report)?),
        report if arguments.explain => output::result(format_args!("{report:#}")),
        report => output::result(report),
    }
}

/// What is to be said, and the masks by name where they are asked for.
fn report(arguments: &Arguments) -> Result<(Report, Vec<(String, Mask)>), Faults> {
    // Without an installation there is an exhibit.
    let path = arguments.exhibit.as_deref().unwrap_or(Path::new("."));
    let (exhibit, mut warnings) = Exhibit::read(path)?;
    // Those that no scene needs today are still part of the exhibit.
    warnings.extend(exhibit.verify(exhibit.maps())?);
    super::warn(&warnings);
    let mut photographs = Vec::new();
    let mut masks = Vec::new();
    let all = exhibit.photographs();
    let bar = output::progress(all.len() as u64);
    for photograph in all {
        bar.set_message(format!("{}: read as a photograph", photograph.name()));
        bar.tick();
        let path = &photograph.albedo.file.path;
        let mask = photograph
            .mask()
            .map_err(|error| Faults::from(exhibit.map_fault(path, &error)))?;
        photographs.push(PhotographReport::new(&exhibit, &photograph, &mask));
        if arguments.masks.is_some() {
            masks.push((photograph.name(), mask));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let detail = if arguments.explain || arguments.json {
        Detail::Whole
    } else {
        Detail::Choice
    };
    let report = Report::new(&exhibit, warnings, photographs, &Prices::here(), detail)?;
    Ok((report, masks))
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|error| Failure::Input(Box::new(error)))
}
