//! Albedo and normals of a relightable image, and the exhibit that shows them.

use std::{fs, io::Write as _, path::Path};

use rayon::prelude::*;

use super::{
    super::{
        ASSUMED_MM_PER_PX, ExchangeError, Imported, Known,
        error::{Faulty, made_of},
        stage,
    },
    Coefficients, Relightable,
    solve::{Solved, Solver},
};
use crate::{
    colour::srgb_encode,
    manifest::{MANIFEST, check_shape, document::Words},
    maps::encode::{save_png_rgb16, write_whole},
};

/// The folder of maps, within the exhibit's.
const MAPS: &str = "maps";
/// How many rows are solved at once.
const BAND: usize = 32;
/// Above this share of pixels without a brightest direction it is said.
const SAID: f64 = 0.01;

/// A file that is being imported.
pub(super) struct Task<'t> {
    pub file: &'t Path,
    pub known: &'t Known,
    pub warnings: Faulty<'t>,
    pub image: &'t Relightable,
    pub rows: &'t mut dyn Coefficients,
}

/// Makes an exhibit of an image in `out`.
pub(super) fn exhibit(task: Task<'_>, out: &Path) -> Result<Imported, ExchangeError> {
    let Task {
        file,
        known,
        mut warnings,
        image,
        rows,
    } = task;
    let size_mm = size_mm(known, image.size, &mut warnings);
    let found = stage::whole(out, &[MAPS, MANIFEST], |folder| {
        let maps = folder.join(MAPS);
        fs::create_dir(&maps).map_err(ExchangeError::folder(&maps))?;
        rows.begin(folder)?;
        let dpi = image.size[0] as f64 / (size_mm[0] / 25.4);
        let share = solve(image, rows, &maps, dpi)?;
        let text = text(file, size_mm);
        check_shape(&text).map_err(|faults| made_of(file, faults))?;
        write_whole(&folder.join(MANIFEST), |manifest| {
            manifest.write_all(text.as_bytes())
        })?;
        Ok((share, stage::checked(file, folder, out)?))
    });
    let (share, exhibit) = found?;
    if share > SAID {
        let found = format!(
            "no brightest direction in {:.0} % of its pixels",
            share * 100.0
        );
        let remedy = "there, normals are those of the matte surface that is nearest to it";
        warnings.warning("", Words::new(found, "", remedy));
    }
    let mut warnings = warnings.warnings()?;
    warnings.extend(exhibit);
    Ok(Imported {
        file: out.join(MANIFEST),
        is_capture: false,
        warnings,
    })
}

/// Width and height in mm of what a picture of this size shows.
fn size_mm(known: &Known, size: [usize; 2], warnings: &mut Faulty<'_>) -> [f64; 2] {
    if let Some(size_mm) = known.size_mm {
        return size_mm;
    }
    let assumed = size.map(|px| (px as f64 * ASSUMED_MM_PER_PX * 100.0).round() / 100.0);
    // Sheets are 1 to 5000 mm wide.
    let assumed = assumed.map(|mm| mm.max(1.0));
    let found = "nothing about how large the sheet is";
    let remedy = format!(
        "{} × {} mm are assumed; give --size-mm, or correct size_mm in the manifest",
        assumed[0], assumed[1]
    );
    warnings.warning("", Words::new(found, "", remedy));
    assumed
}

/// Solves and writes all pixels; gives the share of those without a brightest direction.
fn solve(
    image: &Relightable,
    rows: &mut dyn Coefficients,
    maps: &Path,
    dpi: f64,
) -> Result<f64, ExchangeError> {
    let [width, height] = image.size;
    let solver = Solver::new(image);
    let mut albedo: Vec<[u16; 3]> = Vec::with_capacity(width * height);
    let mut normal: Vec<[u16; 3]> = Vec::with_capacity(width * height);
    let mut without = 0;
    let mut band = vec![0.0; BAND * width * image.planes];
    for top in (0..height).step_by(BAND) {
        let count = BAND.min(height - top);
        let band = &mut band[..count * width * image.planes];
        for row in band.chunks_exact_mut(width * image.planes) {
            rows.next_row(row)?;
        }
        let solved: Vec<Solved> = band
            .par_chunks_exact(image.planes)
            .map(|planes| solver.solve(planes))
            .collect();
        without += solved.iter().filter(|pixel| !pixel.has_brightest).count();
        // Casts saturate.
        albedo.extend(solved.iter().map(|pixel| {
            pixel
                .albedo
                .map(|v| (srgb_encode(v).clamp(0.0, 1.0) * 65535.0).round() as u16)
        }));
        normal.extend(solved.iter().map(|pixel| {
            let n = pixel.normal.to_array();
            n.map(|v| (32768.0 + v * 32767.0).round() as u16)
        }));
    }
    let [w, h] = image.size.map(|n| n as u32);
    save_png_rgb16(&maps.join("albedo.png"), w, h, &albedo, Some(dpi))?;
    save_png_rgb16(&maps.join("normal.png"), w, h, &normal, Some(dpi))?;
    Ok(without as f64 / (width * height) as f64)
}

/// The manifest.
fn text(file: &Path, [width, height]: [f64; 2]) -> String {
    let name = file.file_stem().map(|stem| stem.to_string_lossy());
    let title = match name.as_deref() {
        // Relight's files are all called alike; their folders are not.
        Some("info") | None => file
            .parent()
            .and_then(Path::file_name)
            .map(|folder| folder.to_string_lossy().into_owned()),
        Some(name) => Some(name.to_owned()),
    };
    let title = title.filter(|title| !title.trim().is_empty());
    format!(
        "# Made by `recto import` from a relightable image. Its values are read as sRGB; what it was\n\
         # lit with is not known, so albedo is right but for a factor. `recto schema` prints what an\n\
         # editor needs to check this file while you type.\n\n\
         [exhibit]\ntitle = {{ en = {title} }}\n\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [{width:?}, {height:?}]\n\
         paper = {{ kind = \"laid\", source = \"assumed\" }}\n\n\
         [drawing.recto]\n\
         albedo = {{ file = \"{MAPS}/albedo.png\", encoding = \"srgb\" }}\n\
         normal = {{ file = \"{MAPS}/normal.png\", y = \"up\" }}\n\
         source = \"fitted\"\n",
        title = toml::Value::from(title.unwrap_or_else(|| "Sheet".to_owned())),
    )
}
