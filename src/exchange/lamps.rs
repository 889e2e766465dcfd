//! Light directions of other programs and their photographs → a starting capture file.
//!
//! `.lp` is read by [`prepare::lights::lp`](crate::prepare::lights::lp). `.dome` is the JSON of
//! RelightLab's domes: `lightConfiguration` (directional, spherical or lights3d), `directions`
//! as unit vectors, `positionsSphere` and `positions3d` in mm from the middle of the picture, x
//! right, y up in the picture and z towards the camera, and `imageWidth`, which is what the
//! pictures show across, in mm (`relightlab/docs/formats/dome.html`).

use std::{
    fs,
    io::Write as _,
    path::{Component, Path, PathBuf},
};

use glam::DVec3;
use serde_json::Value;

use super::{
    ASSUMED_MM_PER_PX, ExchangeError, Imported, Known,
    error::{Faulty, made_of, whole_file},
    json::{self, found},
    stage,
};
use crate::{
    manifest::{document::Words, fault::natural, quote, raw::values::PositionMm},
    maps::{self, encode::write_whole},
    prepare::{
        capture::{
            CAPTURE, Capture, MAX_LAMPS, MIN_LAMPS,
            values::{LampElevationDeg, PixelMm},
        },
        lights::{angles, lp},
    },
};

/// What photographs are called.
const PICTURES: [&str; 6] = ["tif", "tiff", "png", "jpg", "jpeg", "exr"];
/// No lamp of a dome is nearer to the sheet than this many mm; one that seems to be is in cm.
const NEAREST_MM: f64 = 30.0;
/// The key of what a dome's pictures show across.
const IMAGE_WIDTH: &str = "imageWidth";
/// How far a size may be from the photographs' proportions: it is measured with a ruler.
const PROPORTIONS: f64 = 0.03;

/// Makes a capture file of an `.lp` file and the photographs that it names.
pub(super) fn import_lp(file: &Path, out: &Path, known: &Known) -> Result<Imported, ExchangeError> {
    let mut faulty = Faulty::new(file);
    let bytes = json::bytes(file)?;
    let lamps = match lp::read(&String::from_utf8_lossy(&bytes)) {
        Ok(lamps) => lamps,
        Err(faults) => {
            for fault in faults {
                let words = Words::new(fault.found, "a line of an .lp file", fault.remedy);
                faulty.fault(format!("line {}", fault.line), words);
            }
            return Err(ended(file, faulty));
        }
    };
    if !(MIN_LAMPS..=MAX_LAMPS).contains(&lamps.len()) {
        let allowed = format!("{MIN_LAMPS} to {MAX_LAMPS} lamps");
        let remedy = match lamps.len() > MAX_LAMPS {
            true => {
                "leave some of them out, such as every second one, and correct the number above them"
            }
            false => "photograph under more lamps",
        };
        let words = Words::new(format!("{} lamps", lamps.len()), allowed, remedy);
        return Err(whole_file(file, words));
    }
    let own = file.parent().unwrap_or(Path::new(""));
    let folder = known.photographs.as_deref().unwrap_or(own);
    let photographs: Vec<PathBuf> = lamps.iter().map(|lamp| lamp.beside(folder)).collect();
    let missing: Vec<&str> = lamps
        .iter()
        .zip(&photographs)
        .filter(|(_, path)| !path.is_file())
        .map(|(lamp, _)| lamp.file.as_str())
        .collect();
    if let Some(first) = missing.first() {
        let found = match missing.len() {
            1 => format!("{}, which is not there", quote(first)),
            count => format!(
                "{count} of {} photographs missing, the first of them {}",
                lamps.len(),
                quote(first)
            ),
        };
        let there = match folder.as_os_str().is_empty() {
            true => "this folder".to_owned(),
            false => quote(&folder.to_string_lossy()),
        };
        let allowed = format!("a photograph of each line in {there}");
        let remedy = "put the photographs there, or name their folder with --photographs";
        faulty.fault("", Words::new(found, allowed, remedy));
    }
    faulty.check()?;
    let task = Task {
        file,
        known,
        faulty,
        photographs,
        shown_mm: None,
    };
    task.capture(out, |from_out| {
        Ok(format!("lp = {}\n", text(&from_out(file)?)))
    })
}

/// Makes a capture file of a `.dome` and the photographs of a folder, in the order of their names.
pub(super) fn import_dome(
    file: &Path,
    json: &Value,
    out: &Path,
    known: &Known,
) -> Result<Imported, ExchangeError> {
    let mut faulty = Faulty::new(file);
    let lamps = dome(json, &mut faulty);
    let count = lamps.as_ref().map(|(_, lamps)| lamps.len());
    let own = file.parent().filter(|own| !own.as_os_str().is_empty());
    let folder = known
        .photographs
        .as_deref()
        .or(own)
        .unwrap_or(Path::new("."));
    let photographs = pictures(folder)?;
    if let Some(count) = count.filter(|count| *count != photographs.len()) {
        let found = format!(
            "{count} lamps, and {} photographs in {}",
            photographs.len(),
            quote(&folder.to_string_lossy())
        );
        let allowed = "a photograph for each lamp, their names in the order of the lamps";
        let remedy = "name the folder of the photographs alone with --photographs";
        faulty.fault("", Words::new(found, allowed, remedy));
    }
    let width = json.get("imageWidth").filter(|width| !width.is_null());
    let shown_mm = width.and_then(Value::as_f64);
    if width.is_some() && shown_mm.is_none_or(|mm| mm < 0.0) {
        let allowed = "what the pictures show across, in mm, or 0 where it is not known";
        let remedy = "correct it, or leave it out and give --size-mm";
        faulty.fault(IMAGE_WIDTH, Words::new(found(width), allowed, remedy));
    }
    let Some((are_places, lamps)) = lamps else {
        return Err(ended(file, faulty));
    };
    faulty.check()?;
    let task = Task {
        file,
        known,
        faulty,
        photographs,
        shown_mm: shown_mm.filter(|mm| *mm > 0.0),
    };
    task.capture(out, |_| Ok(written(are_places, &lamps)))
}

/// The faults, which there must be.
fn ended(file: &Path, faulty: Faulty<'_>) -> ExchangeError {
    match faulty.warnings() {
        Err(faults) => faults.into(),
        Ok(_) => crate::manifest::shape::unexplained(file, "a file of lamps").into(),
    }
}

/// The lamps of a dome; true where they are places in mm and not directions.
fn dome(json: &Value, faulty: &mut Faulty<'_>) -> Option<(bool, Vec<DVec3>)> {
    let configuration = json.get("lightConfiguration").and_then(Value::as_str);
    // `positions` is what the format's first description calls them.
    let keys: &[&str] = match configuration {
        Some("spherical") => &["positionsSphere", "positions", "directions"],
        Some("lights3d") => &["positions3d", "positions", "directions"],
        Some("directional") => &["directions"],
        _ => &["positions", "directions"],
    };
    let filled = |key: &&&str| {
        let list = json.get(**key).and_then(Value::as_array);
        list.is_some_and(|list| !list.is_empty())
    };
    let key = *keys.iter().find(filled).unwrap_or(&"directions");
    let value = json.get(key);
    let list = value.and_then(Value::as_array);
    let list = list.filter(|list| (MIN_LAMPS..=MAX_LAMPS).contains(&list.len()));
    let Some(list) = list else {
        let allowed = format!("a list of {MIN_LAMPS} to {MAX_LAMPS} lamps");
        let remedy = "calibrate the dome in RelightLab, and save it again";
        faulty.fault(key, Words::new(found(value), allowed, remedy));
        return None;
    };
    let mut lamps = Vec::with_capacity(list.len());
    for (i, value) in list.iter().enumerate() {
        match vector(value).filter(|v| v.z > 0.0 && v.length() > 1e-9) {
            Some(lamp) => lamps.push(lamp),
            None => {
                let allowed = "x, y and z, with z above 0 towards the camera";
                let words = Words::new(value.to_string(), allowed, "calibrate this lamp again");
                faulty.fault(format!("{key}[{i}]"), words);
            }
        }
    }
    if lamps.len() != list.len() {
        return None;
    }
    let are_places = key != "directions";
    let nearest = lamps
        .iter()
        .map(|lamp| lamp.length())
        .fold(f64::INFINITY, f64::min);
    let in_mm = are_places && nearest >= NEAREST_MM;
    if are_places && !in_mm {
        let found = format!("a lamp {nearest:.1} mm from the middle of the picture");
        let remedy = "lamps are taken as far away; if these are cm, write position_mm yourself";
        faulty.warning(key, Words::new(found, "", remedy));
    }
    let (least, most) = (LampElevationDeg::RANGE.start(), PositionMm::RANGE.end());
    let mut sound = true;
    for (i, lamp) in lamps.iter().enumerate() {
        let elevation = angles(*lamp)[1];
        let (is_possible, found, allowed) = match in_mm {
            true => (
                lamp.abs().max_element() <= *most && rounded_mm(lamp.z) > 0.0,
                list[i].to_string(),
                format!("places up to {most} mm away, above the picture"),
            ),
            false => (
                elevation >= *least,
                format!("a lamp {elevation:.2}° above the picture"),
                format!("lamps from {least}° up"),
            ),
        };
        if !is_possible {
            let words = Words::new(found, allowed, "calibrate this lamp again");
            faulty.fault(format!("{key}[{i}]"), words);
            sound = false;
        }
    }
    sound.then_some((in_mm, lamps))
}

/// To a hundredth of a millimetre.
fn rounded_mm(mm: f64) -> f64 {
    (mm * 100.0).round() / 100.0
}

/// `{ x, y, z }`, or a list of three.
fn vector(value: &Value) -> Option<DVec3> {
    let number = |key: &str, i: usize| value.get(key).or_else(|| value.get(i))?.as_f64();
    Some(DVec3::new(
        number("x", 0)?,
        number("y", 1)?,
        number("z", 2)?,
    ))
}

/// Lamps as lines of `[lamps]`.
fn written(are_places: bool, lamps: &[DVec3]) -> String {
    /// Straight above there is no azimuth.
    const HIGHEST_DEG: f64 = 89.99;
    if are_places {
        let places = lamps.iter().map(|lamp| {
            format!(
                "    [{:?}, {:?}, {:?}],\n",
                rounded_mm(lamp.x),
                rounded_mm(lamp.y),
                rounded_mm(lamp.z)
            )
        });
        return format!("position_mm = [\n{}]\n", places.collect::<String>());
    }
    let rounded = |v: f64| format!("{:?}", (v * 1000.0).round() / 1000.0);
    let angles: Vec<[f64; 2]> = lamps.iter().map(|lamp| angles(*lamp)).collect();
    let list = |value: &dyn Fn(&[f64; 2]) -> f64| {
        let values: Vec<String> = angles.iter().map(|angle| rounded(value(angle))).collect();
        values.join(", ")
    };
    format!(
        "azimuth_deg = [{}]\nelevation_deg = [{}]\n",
        list(&|[azimuth, _]| *azimuth),
        list(&|[_, elevation]| elevation.min(HIGHEST_DEG))
    )
}

/// The pictures of a folder in the order of their names, numbers in them by their value.
fn pictures(folder: &Path) -> Result<Vec<PathBuf>, ExchangeError> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(ExchangeError::folder(folder))? {
        let path = entry.map_err(ExchangeError::folder(folder))?.path();
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let is_picture = extension.is_some_and(|e| PICTURES.contains(&e.as_str()));
        if is_picture && path.is_file() {
            found.push(path);
        }
    }
    found.sort_by_cached_key(|path| natural(&path.to_string_lossy()));
    Ok(found)
}

/// Photographs that become a capture.
struct Task<'t> {
    file: &'t Path,
    known: &'t Known,
    faulty: Faulty<'t>,
    /// Not empty.
    photographs: Vec<PathBuf>,
    /// What the pictures show across, where the file says it.
    shown_mm: Option<f64>,
}

impl Task<'_> {
    /// Writes the capture file to `out`; `lamps` gives the lines about the lamps, and is given what
    /// makes paths from there.
    fn capture(
        mut self,
        out: &Path,
        lamps: impl FnOnce(
            &dyn Fn(&Path) -> Result<PathBuf, ExchangeError>,
        ) -> Result<String, ExchangeError>,
    ) -> Result<Imported, ExchangeError> {
        let mm_per_px = self.mm_per_px()?;
        let id = id(self.file);
        let written = stage::whole(out, &[CAPTURE], |folder| {
            let real = out.canonicalize().map_err(ExchangeError::folder(out))?;
            let from_out = |path: &Path| {
                let path = path.canonicalize().map_err(ExchangeError::folder(path))?;
                Ok(relative(&real, &path))
            };
            let mut text = format!(
                "# Made by `recto import`. Make an exhibit of it with `recto prepare`; `recto schema\n\
                 # --capture` prints what an editor needs to check this file while you type.\n\
                 id = {id}\n{encoding}\n[scale]\nmm_per_px = {mm_per_px:?}\n\n[lamps]\n{lamps}\n\
                 [recto]\nphotographs = [\n",
                id = toml::Value::from(id),
                encoding = "# Of photographs without a profile: write encoding = \"linear\" where they are.\n",
                lamps = lamps(&from_out)?,
            );
            for photograph in &self.photographs {
                text += &format!("    {},\n", self::text(&from_out(photograph)?));
            }
            text += "]\n";
            // Where it will be, so that its paths are those that are checked.
            let (_, warnings) = Capture::parse(&out.join(CAPTURE), &text)
                .map_err(|faults| made_of(self.file, faults))?;
            write_whole(&folder.join(CAPTURE), |file| {
                file.write_all(text.as_bytes())
            })?;
            Ok(warnings)
        })?;
        let mut warnings = self.faulty.warnings()?;
        warnings.extend(written);
        Ok(Imported {
            file: out.join(CAPTURE),
            is_capture: true,
            warnings,
        })
    }

    fn mm_per_px(&mut self) -> Result<f64, ExchangeError> {
        let first = self.photographs.first().ok_or_else(|| {
            let words = Words::new("no photographs", "one for each lamp", "add them");
            whole_file(self.file, words)
        })?;
        let [width, height] = maps::probe(first)?.size.map(f64::from);
        if let Some([across, down]) = self.known.size_mm
            && ((width / height) / (across / down) - 1.0).abs() > PROPORTIONS
        {
            let words = Words::new(
                format!("--size-mm {across}x{down} of photographs of {width} × {height} pixels"),
                "what the photographs show, all of it, in their proportions",
                format!(
                    "write {across}x{:.1}, or measure again",
                    across * height / width
                ),
            );
            return Err(whole_file(self.file, words));
        }
        let shown = self.known.size_mm.map(|size| size[0]).or(self.shown_mm);
        let mm_per_px = shown.map(|mm| (mm / width * 1e6).round() / 1e6);
        if let (Some(shown), Some(mm_per_px)) = (shown, mm_per_px)
            && !PixelMm::RANGE.contains(&mm_per_px)
        {
            let (path, found) = match self.known.size_mm {
                Some(_) => ("", format!("--size-mm with a width of {shown}")),
                None => (IMAGE_WIDTH, shown.to_string()),
            };
            let [least, most] = [PixelMm::RANGE.start(), PixelMm::RANGE.end()].map(|mm| mm * width);
            let words = Words::new(
                found,
                format!("{least} to {most} mm across photographs of {width} pixels"),
                "write what the photographs show across, in mm",
            );
            self.faulty.fault(path, words);
        }
        self.faulty.check()?;
        Ok(mm_per_px.unwrap_or_else(|| {
            let found = "nothing about how large a pixel is on the sheet";
            let remedy = format!(
                "{ASSUMED_MM_PER_PX} mm are assumed; give --size-mm, or correct scale in the capture file"
            );
            self.faulty.warning("", Words::new(found, "", remedy));
            ASSUMED_MM_PER_PX
        }))
    }
}

/// A short name from that of a file.
fn id(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let plain = stem
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'));
    let plain: String = plain.take(64).collect();
    let begins = plain.trim_start_matches(['-', '_']);
    match begins {
        "" => "sheet".to_owned(),
        begins => begins.to_owned(),
    }
}

/// A path as the capture file writes it.
fn text(path: &Path) -> toml::Value {
    toml::Value::from(path.to_string_lossy().into_owned())
}

/// The way from the folder `from` to the file `to`, both without links, where they have a folder
/// in common; otherwise `to` itself.
fn relative(from: &Path, to: &Path) -> PathBuf {
    let common = from
        .components()
        .zip(to.components())
        .take_while(|(a, b)| a == b);
    let count = common.count();
    let mut own = from.components();
    if count == 0 || own.nth(count - 1) == Some(Component::RootDir) {
        return to.to_owned();
    }
    let up = from.components().skip(count).map(|_| Component::ParentDir);
    up.chain(to.components().skip(count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_lead_there() {
        let way = |from: &str, to: &str| relative(Path::new(from), Path::new(to));
        assert_eq!(
            way("/a/out", "/a/photos/1.jpg"),
            Path::new("../photos/1.jpg")
        );
        assert_eq!(way("/a", "/a/1.jpg"), Path::new("1.jpg"));
        assert_eq!(way("/x/out", "/a/1.jpg"), Path::new("/a/1.jpg"));
        assert_eq!(id(Path::new("über den Fluss.lp")), "berdenFluss");
        assert_eq!(id(Path::new("夢.lp")), "sheet");
    }
}
