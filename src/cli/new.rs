//! `recto new`

use std::path::PathBuf;

use super::{Failure, options, output};
use crate::{
    manifest,
    maps::{self, Header},
};

#[derive(clap::Args)]
pub struct Arguments {
    /// The folder to make
    dir: PathBuf,
    /// The picture of the sheet's recto
    #[arg(long, value_name = "FILE")]
    albedo: PathBuf,
    /// Width and height of the sheet in mm; without it, as the picture's own resolution says
    #[arg(long, value_name = "WxH", value_parser = options::size_mm)]
    size_mm: Option<[f64; 2]>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let size_mm = match arguments.size_mm {
        Some(size_mm) => size_mm,
        None => size_from_dpi(&maps::probe(&arguments.albedo)?).ok_or_else(|| {
            Failure::Usage(format!(
                "{}: does not say its resolution; add --size-mm WxH, the size of the sheet in mm",
                arguments.albedo.display()
            ))
        })?,
    };
    let (manifest, warnings) = manifest::create(&arguments.dir, &arguments.albedo, size_mm)?;
    super::warn(&warnings);
    output::result(manifest.display())?;
    output::say(format_args!(
        "Look at it with `recto show {0}`; after changes, `recto check {0}` names every fault.",
        arguments.dir.display()
    ));
    Ok(())
}

/// The size of what a picture shows, to a tenth of a millimetre.
fn size_from_dpi(header: &Header) -> Option<[f64; 2]> {
    const MM_PER_INCH: f64 = 25.4;
    let dpi = header.dpi?;
    let side = |i: usize| f64::from(header.size[i]) / dpi[i] * MM_PER_INCH;
    Some([side(0), side(1)].map(|mm| (mm * 10.0).round() / 10.0))
}
