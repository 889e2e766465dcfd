//! Maps and manifest of what was prepared.

use std::{fs, io::Write as _, path::Path};

use rayon::prelude::*;

use super::{
    PrepareError,
    capture::Capture,
    run::{Report, SideMaps},
};
use crate::{
    manifest::{MANIFEST, SideName, check_shape},
    maps::encode::{save_png_grey16, save_png_rgb16, write_whole},
};

/// The folder of maps, within the exhibit's.
const MAPS: &str = "maps";
/// The longer side of the map of the sheet's shape: it has nothing smaller than the split.
const SHAPE_PX: usize = 1024;

/// Lines of a manifest about one side.
pub(super) struct SideText {
    side: SideName,
    text: String,
    /// Of the sheet's shape.
    surface: String,
    size: [usize; 2],
}

fn word(side: SideName) -> &'static str {
    match side {
        SideName::Recto => "recto",
        SideName::Verso => "verso",
    }
}

/// Writes a side's maps below `folder`.
pub(super) fn side(
    maps: &SideMaps,
    capture: &Capture,
    folder: &Path,
) -> Result<SideText, PrepareError> {
    let name = word(maps.side);
    let within = folder.join(MAPS).join(name);
    fs::create_dir_all(&within).map_err(|reason| PrepareError::Folder {
        path: within.clone(),
        reason,
    })?;
    let [width, height] = maps.size;
    let [w, h] = maps.size.map(|v| v as u32);
    let dpi = Some(25.4 / capture.mm_per_px);
    save_png_rgb16(&within.join("albedo.png"), w, h, &maps.albedo, dpi)?;
    let normals: Vec<[u16; 3]> = maps
        .normal
        .par_iter()
        .map(|n| n.map(|v| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 65535.0).round() as u16))
        .collect();
    save_png_rgb16(&within.join("normal.png"), w, h, &normals, dpi)?;
    drop(normals);
    let grain = Levels::new(&maps.grain_um);
    save_png_grey16(&within.join("height.png"), w, h, &grain.values, dpi)?;
    let text = format!(
        "albedo = {{ file = \"{MAPS}/{name}/albedo.png\", encoding = \"srgb\" }}\n\
         normal = {{ file = \"{MAPS}/{name}/normal.png\", y = \"up\" }}\n\
         height = {{ file = \"{MAPS}/{name}/height.png\", range_um = [{}, {}] }}\n\
         source = \"measured\"\n",
        grain.range[0], grain.range[1]
    );
    let mut surface = String::new();
    if maps.side == SideName::Recto {
        let step = width.max(height).div_ceil(SHAPE_PX).max(1);
        let (small, [w, h]) = means(&maps.shape_um, width, step);
        let shape = Levels::new(&small);
        save_png_grey16(
            &folder.join(MAPS).join("shape.png"),
            w as u32,
            h as u32,
            &shape.values,
            None,
        )?;
        surface = format!(
            "[drawing.surface]\n\
             height = {{ file = \"{MAPS}/shape.png\", range_um = [{}, {}], source = \"measured\" }}\n",
            shape.range[0], shape.range[1]
        );
    }
    Ok(SideText {
        side: maps.side,
        text,
        surface,
        size: maps.size,
    })
}

/// Heights as 16-bit values.
struct Levels {
    values: Vec<u16>,
    /// Of 0 and of 65535, in µm.
    range: [f64; 2],
}

impl Levels {
    fn new(um: &[f64]) -> Self {
        let fold = |f: fn(f64, f64) -> f64| um.iter().copied().fold(0.0, f);
        // To a hundredth, as it is written, and never without extent.
        let low = (fold(f64::min) * 100.0).floor() / 100.0;
        let high = ((fold(f64::max) * 100.0).ceil() / 100.0).max(low + 0.01);
        let value = |h: &f64| ((h - low) / (high - low) * 65535.0).round() as u16;
        Self {
            values: um.par_iter().map(value).collect(),
            range: [low, high],
        }
    }
}

/// Means of squares of `step` pixels; those at the right and lower edge may be smaller.
fn means(values: &[f64], width: usize, step: usize) -> (Vec<f64>, [usize; 2]) {
    let height = values.len() / width;
    let size = [width.div_ceil(step), height.div_ceil(step)];
    let mean = |i: usize| {
        let (left, top) = (i % size[0] * step, i / size[0] * step);
        let rows = top..(top + step).min(height);
        let columns = left..(left + step).min(width);
        let count = rows.len() * columns.len();
        let sum: f64 = rows
            .flat_map(|y| &values[y * width + columns.start..y * width + columns.end])
            .sum();
        sum / count as f64
    };
    ((0..size[0] * size[1]).map(mean).collect(), size)
}

/// Writes the manifest that shows the maps.
pub(super) fn manifest(
    capture: &Capture,
    sides: &[SideText],
    report: &Report,
    folder: &Path,
) -> Result<(), PrepareError> {
    let title = capture.title.as_deref().unwrap_or(&capture.id);
    let size = sides.first().map_or([1, 1], |side| side.size);
    let [width, height] = size.map(|px| (px as f64 * capture.mm_per_px * 100.0).round() / 100.0);
    let mut text = format!(
        "# Made by `recto prepare` from {} photographs; report.html says how well. `recto schema`\n\
         # prints what an editor needs to check this file while you type.\n\n\
         [exhibit]\ntitle = {{ en = {title} }}\n\n\
         [[drawing]]\nid = {id}\nsize_mm = [{width:?}, {height:?}]\n\
         # What it is made of was not measured.\npaper = {{ kind = \"laid\", source = \"assumed\" }}\n\n",
        report.lamps.len(),
        title = toml::Value::from(title),
        id = toml::Value::from(capture.id.as_str()),
    );
    for side in sides {
        if !side.surface.is_empty() {
            text += &side.surface;
            text += "\n";
        }
        text += &format!("[drawing.{}]\n{}", word(side.side), side.text);
        if side.side == SideName::Verso {
            text += "register = { flip = \"horizontal\" }\n";
        }
        text += "\n";
    }
    // Lamps as they stood, so that the photographs can be looked at again.
    for (i, lamp) in report.lamps.iter().enumerate().take(8) {
        text += &format!(
            "[[lamp]]\nid = \"photographed-{}\"\nkind = \"distant\"\nelevation_deg = {:?}\n\
             azimuth_deg = {:?}\nlux_at_sheet = 150\n\n",
            i + 1,
            (lamp.elevation_deg * 10.0).round() / 10.0,
            (lamp.azimuth_deg * 10.0).round() / 10.0,
        );
    }
    check_shape(&text)?;
    write_whole(&folder.join(MANIFEST), |file| {
        file.write_all(text.trim_end().as_bytes())?;
        file.write_all(b"\n")
    })?;
    Ok(())
}

/// Moves what was staged to its place, the manifest last: whoever opens the folder meanwhile sees
/// no exhibit, or the whole.
pub(super) fn publish(stage: &Path, out: &Path) -> Result<(), PrepareError> {
    let refused = |path: &Path| {
        let path = path.to_owned();
        move |reason| PrepareError::Folder { path, reason }
    };
    let maps = out.join(MAPS);
    if maps.exists() {
        return Err(PrepareError::Exists(maps));
    }
    for name in [MAPS, super::report::REPORT, MANIFEST] {
        let to = out.join(name);
        fs::rename(stage.join(name), &to).map_err(refused(&to))?;
    }
    Ok(())
}
