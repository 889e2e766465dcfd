//! Maps and manifest of what was prepared.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    PrepareError,
    capture::Capture,
    depth::Depths,
    lights,
    materials::legend::{self, MediaFile},
    matter,
    relief::{real::Real, surface},
    report,
    run::{LampFound, Report, SideReport},
    verso::Place,
};
use crate::{
    manifest::{MANIFEST, MAX_LAMPS, SideName, check_shape},
    maps::encode::{save_png_grey16, save_png_rgb16, write_whole},
};

/// The folder of maps, within the exhibit's.
pub(super) const MAPS: &str = "maps";

/// Lines of a manifest about one side.
pub(super) struct SideText {
    side: SideName,
    /// Of grain and strokes, in µm of black and of white.
    grain_um: [f64; 2],
    /// Of the sheet's shape.
    surface: String,
    size: [usize; 2],
}

/// What a side is called in a manifest.
pub(super) fn word(side: SideName) -> &'static str {
    match side {
        SideName::Recto => "recto",
        SideName::Verso => "verso",
    }
}

/// The files of a side's maps.
pub(super) struct SideFiles<'s> {
    side: SideName,
    size: [usize; 2],
    dpi: f64,
    /// The exhibit's.
    folder: &'s Path,
    within: PathBuf,
}

impl<'s> SideFiles<'s> {
    /// Makes the folder of a side's maps below `folder`.
    pub fn new(
        side: SideName,
        size: [usize; 2],
        capture: &Capture,
        folder: &'s Path,
    ) -> Result<Self, PrepareError> {
        let within = folder.join(MAPS).join(word(side));
        fs::create_dir_all(&within).map_err(|reason| PrepareError::Folder {
            path: within.clone(),
            reason,
        })?;
        Ok(Self {
            side,
            size,
            dpi: 25.4 / capture.mm_per_px,
            folder,
            within,
        })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    fn preview(
        &self,
        kind: &str,
        width: usize,
        at: &dyn Fn(usize) -> [u8; 3],
        count: usize,
    ) -> Result<(), PrepareError> {
        report::preview(
            self.side,
            kind,
            [width, count / width.max(1)],
            at,
            self.folder,
        )
    }

    /// Writes sRGB-encoded albedo.
    pub fn albedo(&self, albedo: &[[u16; 3]]) -> Result<(), PrepareError> {
        let [w, h] = self.size.map(|v| v as u32);
        save_png_rgb16(
            &self.within.join("albedo.png"),
            w,
            h,
            albedo,
            Some(self.dpi),
        )?;
        let at = |i: usize| albedo[i].map(|v| (v >> 8) as u8);
        self.preview("albedo", self.size[0], &at, albedo.len())
    }

    /// Writes the class of each place to `files`.
    pub fn media(&self, files: &[MediaFile], classes: &[u8]) -> Result<(), PrepareError> {
        legend::write(files, classes, self.size, self.dpi, &self.within)?;
        let at = |i: usize| match classes[i] {
            0 => [255; 3],
            class => legend::colour(usize::from(class)),
        };
        self.preview("media", self.size[0], &at, classes.len())
    }

    /// Writes the depths of ink, where there is any.
    pub fn depth(&self, depths: &Depths) -> Result<(), PrepareError> {
        if depths.map.is_empty() {
            return Ok(());
        }
        self.grey16(&self.within.join("ink-depth.png"), &depths.map)?;
        let at = |i: usize| [255 - (depths.map[i] >> 8) as u8; 3];
        self.preview("ink-depth", self.size[0], &at, depths.map.len())
    }

    /// Writes what paper passes over the mean sheet; there is one for both sides.
    pub fn transmission(&self, map: &[u16]) -> Result<(), PrepareError> {
        self.grey16(&self.folder.join(MAPS).join("transmission.png"), map)?;
        let at = |i: usize| [(map[i] >> 8) as u8; 3];
        self.preview("transmission", self.size[0], &at, map.len())
    }

    fn grey16(&self, path: &Path, values: &[u16]) -> Result<(), PrepareError> {
        let [w, h] = self.size.map(|v| v as u32);
        save_png_grey16(path, w, h, values, Some(self.dpi))?;
        Ok(())
    }

    /// Writes unit normals of grain and strokes, as [`normal_codes`] has them.
    pub fn normal(&self, encoded: &[[u16; 3]]) -> Result<(), PrepareError> {
        let [w, h] = self.size.map(|v| v as u32);
        let path = self.within.join("normal.png");
        save_png_rgb16(&path, w, h, encoded, Some(self.dpi))?;
        let at = |i: usize| encoded[i].map(|v| (v >> 8) as u8);
        self.preview("normal", self.size[0], &at, encoded.len())
    }

    /// Writes the shape at large in µm, which is within `range`, and gives the lines of a manifest
    /// about it; the recto's alone is the sheet's.
    pub fn shape(&self, um: &[f64], width: usize, range: [f64; 2]) -> Result<String, PrepareError> {
        let levels = Levels::new(um, range);
        let at = |i: usize| [(levels.values[i] >> 8) as u8; 3];
        self.preview("shape", width, &at, um.len())?;
        if self.side == SideName::Verso {
            return Ok(String::new());
        }
        let (w, h) = (width as u32, (um.len() / width.max(1)) as u32);
        let path = self.folder.join(MAPS).join("shape.png");
        save_png_grey16(&path, w, h, &levels.values, None)?;
        let [across, down] = self.size.map(|px| px as f64 * 25.4 / self.dpi);
        let folder = self.folder.join(MAPS);
        surface::save(um, width, DVec2::new(across, down), &folder)?;
        Ok(format!(
            "[drawing.surface]\n\
             height = {{ file = \"{MAPS}/shape.png\", range_um = [{}, {}], source = \"measured\" }}\n",
            levels.range[0], levels.range[1]
        ))
    }

    /// Writes heights of grain and strokes in µm, which are within `range`, the last of the maps,
    /// and gives the lines of a manifest about the side.
    pub fn grain(
        self,
        um: &[f32],
        range: [f64; 2],
        surface: String,
    ) -> Result<SideText, PrepareError> {
        let levels = Levels::new(um, range);
        self.grey16(&self.within.join("height.png"), &levels.values)?;
        Ok(SideText {
            side: self.side,
            grain_um: levels.range,
            surface,
            size: self.size,
        })
    }
}

impl SideText {
    /// The lines about its maps.
    fn maps(&self, found: &SideReport) -> String {
        let name = word(self.side);
        // What the brightest paper is was not measured.
        let level = match found.assumed_exposure {
            Some(_) => ", source = \"assumed\"",
            None => "",
        };
        let [low, high] = self.grain_um;
        format!(
            "albedo = {{ file = \"{MAPS}/{name}/albedo.png\", encoding = \"srgb\"{level} }}\n\
             normal = {{ file = \"{MAPS}/{name}/normal.png\", y = \"up\" }}\n\
             height = {{ file = \"{MAPS}/{name}/height.png\", range_um = [{low}, {high}] }}\n\
             source = \"measured\"\n",
        )
    }
}

/// Unit normals → codes of 16 bits.
pub(super) fn normal_codes(normals: &[[f32; 3]]) -> Vec<[u16; 3]> {
    const TOGETHER: usize = 1 << 12;
    // Casts cut, which half a step makes the nearest. Compilers vectorise those to 32 bits.
    let code = |v: f32| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 65535.0 + 0.5) as i32 as u16;
    let mut codes = vec![[0; 3]; normals.len()];
    let chunks = codes.par_chunks_mut(TOGETHER);
    chunks
        .zip(normals.par_chunks(TOGETHER))
        .for_each(|(codes, normals)| {
            let codes = codes.as_flattened_mut().iter_mut();
            for (out, v) in codes.zip(normals.as_flattened()) {
                *out = code(*v);
            }
        });
    codes
}

/// Heights as 16-bit values.
struct Levels {
    values: Vec<u16>,
    /// Of 0 and of 65535, in µm.
    range: [f64; 2],
}

impl Levels {
    /// Of heights within a range.
    fn new<T: Real>(um: &[T], [low, high]: [f64; 2]) -> Self {
        // To a hundredth, as it is written, and never without extent.
        let low = (low.min(0.0) * 100.0).floor() / 100.0;
        let high = ((high.max(0.0) * 100.0).ceil() / 100.0).max(low + 0.01);
        let scale = 65535.0 / (high - low);
        // Casts cut, which half a step makes the nearest.
        let value = |h: &T| ((h.wide() - low) * scale + 0.5) as u16;
        Self {
            values: um.par_iter().map(value).collect(),
            range: [low, high],
        }
    }
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
         [[drawing]]\nid = {id}\nsize_mm = [{width:?}, {height:?}]\n{paper}\n",
        report.lamps.len(),
        title = toml::Value::from(title),
        id = toml::Value::from(capture.id.as_str()),
        paper = matter::paper_line(report),
    );
    for (side, found) in sides.iter().zip(&report.sides) {
        if !side.surface.is_empty() {
            text += &side.surface;
            text += "\n";
        }
        text += &format!("[drawing.{}]\n{}", word(side.side), side.maps(found));
        text += &matter::side_lines(found);
        if side.side == SideName::Verso {
            text += &report.verso.as_ref().map(Place::lines).unwrap_or_default();
        }
        text += "\n";
    }
    text += &matter::drawing_lines(report);
    text += &matter::media_lines(report);
    text += &lamp_lines(&report.lamps);
    check_shape(&text)?;
    write_whole(&folder.join(MANIFEST), |file| {
        file.write_all(text.trim_end().as_bytes())?;
        file.write_all(b"\n")
    })?;
    Ok(())
}

/// Of `lamps`, which an exhibit shows its sheet under: as many as a scene may have, from all
/// around.
fn shown_lamps(lamps: &[LampFound]) -> Vec<usize> {
    let directions: Vec<DVec3> = lamps
        .iter()
        .map(|lamp| lights::direction(lamp.azimuth_deg, lamp.elevation_deg))
        .collect();
    lights::far_apart(&directions, MAX_LAMPS)
}

/// Which lamps an exhibit shows, where it cannot show all: a paragraph of a page, or nothing.
pub(super) fn lamps_told(lamps: &[LampFound]) -> String {
    let shown = shown_lamps(lamps);
    if shown.len() == lamps.len() {
        return String::new();
    }
    let names: Vec<String> = shown.iter().map(|i| (i + 1).to_string()).collect();
    format!(
        "<p>The exhibit shows the sheet under {} of the {} lamps, those farthest from each other: \
         {}.</p>",
        shown.len(),
        lamps.len(),
        names.join(", ")
    )
}

/// Lamps as they stood, so that the photographs can be looked at again; as bright in comparison
/// with each other as they were, where that is known.
fn lamp_lines(lamps: &[LampFound]) -> String {
    /// Of all of them on the mean.
    const LUX: f64 = 150.0;
    /// What is darker gives no light.
    const DARKEST_LUX: f64 = 0.01;
    let shown = shown_lamps(lamps);
    let sum: f64 = shown.iter().filter_map(|i| lamps[*i].intensity).sum();
    let mean = sum / shown.len().max(1) as f64;
    let lines = shown.into_iter().map(|i| {
        let lamp = &lamps[i];
        let lux = LUX * lamp.intensity.map_or(1.0, |of| of / mean);
        format!(
            "[[lamp]]\nid = \"photographed-{}\"\nkind = \"distant\"\nelevation_deg = {:?}\n\
             azimuth_deg = {:?}\nlux_at_sheet = {:?}\n\n",
            i + 1,
            (lamp.elevation_deg * 10.0).round() / 10.0,
            (lamp.azimuth_deg * 10.0).round() / 10.0,
            (lux.max(DARKEST_LUX) * 100.0).round() / 100.0,
        )
    });
    lines.collect()
}
