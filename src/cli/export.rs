//! `recto export`

use std::path::PathBuf;

use super::{Failure, output, report::counted};
use crate::exchange::{self, DEFAULT_BASE};

/// What help says below the options.
pub const HELP: &str = "\
With --iiif, DIR gets a manifest.json after IIIF Presentation 3 and a folder of images: a canvas for
each side with its size in mm, states, bands and overlays as choices of the same canvas, hotspots as
annotations, texts in all their languages. Pictures that browsers show are copied as they are;
others, and those that are placed by register or control points, are written as PNG. Relief, gloss,
lamps and the outline of the sheet (torn edges, holes) have no place in IIIF and stay behind.

Ids of IIIF are addresses on the web: say with --base where DIR will be. To try it here, run
`python3 -m http.server` in DIR and give a viewer the address of manifest.json there.";

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    /// After IIIF Presentation 3
    #[arg(long)]
    iiif: bool,
    /// The folder to write to, made if it is absent
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The address that this folder will have on the web
    #[arg(long, value_name = "URL", default_value = DEFAULT_BASE, value_parser = base)]
    base: String,
}

fn base(text: &str) -> Result<String, String> {
    let rest = text
        .strip_prefix("https://")
        .or_else(|| text.strip_prefix("http://"));
    let is_plain =
        |c: char| c.is_ascii_graphic() && !matches!(c, '?' | '#' | '"' | '<' | '>' | '\\');
    let sound =
        rest.is_some_and(|rest| !rest.trim_matches('/').is_empty() && rest.chars().all(is_plain));
    match sound {
        true => Ok(text.to_owned()),
        false => Err(
            "write the address of a folder, such as https://museum.example/iiif/valley/".to_owned(),
        ),
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !arguments.iiif {
        let words = "add --iiif: there is no other form to export to yet";
        return Err(Failure::Usage(words.to_owned()));
    }
    output::can_write_folder(&arguments.out)?;
    let exhibit = super::read(&arguments.exhibit)?;
    let exported = exchange::export_iiif(&exhibit, &arguments.out, &arguments.base)?;
    let canvases = match exported.canvases {
        1 => "1 canvas".to_owned(),
        several => format!("{several} canvases"),
    };
    output::say(format_args!(
        "{canvases} with {}, at {}",
        counted(exported.pictures, "picture"),
        arguments.base
    ));
    output::result(exported.manifest.display())
}
