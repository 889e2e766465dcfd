//! Relight's `info.json` with its planes.
//!
//! The format is that of Relight (F. Ponchio, M. Corsini and R. Scopigno, *A Compact Representation
//! of Relightable Images for the Web*, Web3D 2018): JSON with size, type, colour space, and scale
//! and bias of each plane; planes are the channels of `plane_0.jpg` and so on, three in each, rows
//! from the top. A coefficient is (value − bias) · scale, 1 for white. Bases that were found in
//! the photographs follow in `basis`, or in `materials.bin`, one byte for each number: the mean,
//! and for each plane (byte − 127) / range, each of red, green and blue at every sample.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::Value;

use super::{
    super::{
        ExchangeError, Imported, Known,
        error::Faulty,
        json::{self, found},
    },
    Coefficients, Colours, Relightable,
    basis::{Basis, HSH_TERMS, PTM_TERMS, Samples, Table},
    write,
};
use crate::{
    manifest::{document::Words, quoted_list, shape::unexplained},
    maps::{self, ColourEncoding, ColourRows, MAX_SIDE},
};

/// Planes of coefficients that there may be: Relight offers some tens.
const MOST_PLANES: u64 = 99;
/// Lamps of a dome, and more.
const MOST_LAMPS: usize = 1000;
/// Places along a side of a bilinear grid.
const MOST_RESOLUTION: u64 = 64;

/// Makes an exhibit of an `info.json`.
pub fn import(
    file: &Path,
    json: &Value,
    out: &Path,
    known: &Known,
) -> Result<Imported, ExchangeError> {
    let mut faulty = Faulty::new(file);
    let info = Info::read(file, json, &mut faulty);
    faulty.check()?;
    let info = info.ok_or_else(|| unexplained(file, "an info.json"))?;
    let mut planes = Planes::find(file, &info, &mut faulty)?;
    let image = Relightable {
        size: info.size,
        planes: info.kept,
        basis: info.basis,
        colours: info.colours,
    };
    let task = write::Task {
        file,
        known,
        warnings: faulty,
        image: &image,
        rows: &mut planes,
    };
    write::exhibit(task, out)
}

/// What the file says.
struct Info {
    size: [usize; 2],
    basis: Basis,
    colours: Colours,
    /// Of each plane: where its value belongs among a pixel's, its scale and its bias.
    planes: Vec<Plane>,
    /// How many values of a pixel are used.
    kept: usize,
    extensions: &'static [&'static str],
}

#[derive(Clone, Copy)]
struct Plane {
    to: usize,
    scale: f64,
    bias: f64,
}

impl Info {
    /// `None` only where a fault is recorded.
    fn read(file: &Path, json: &Value, faulty: &mut Faulty<'_>) -> Option<Self> {
        let mut side = |key| json::whole(json, key, 1..=MAX_SIDE.into(), faulty);
        let size = [side("width"), side("height")];
        let kind = word(json, "type", &["ptm", "hsh", "rbf", "bilinear"], faulty);
        let space = word(json, "colorspace", &["rgb", "lrgb", "mrgb", "mycc"], faulty);
        let format = match json.get("format") {
            None => Some("jpg"),
            Some(_) => word(json, "format", &["jpg", "jpeg", "png"], faulty),
        };
        let (kind, space) = (kind?, space?);
        let allowed = "ptm with rgb or lrgb, hsh with rgb, rbf or bilinear with mrgb or mycc";
        let together = [
            ("ptm", "lrgb"),
            ("ptm", "rgb"),
            ("hsh", "rgb"),
            ("rbf", "mrgb"),
            ("rbf", "mycc"),
            ("bilinear", "mrgb"),
            ("bilinear", "mycc"),
        ];
        if !together.contains(&(kind, space)) {
            let found = format!("{kind} with {space}");
            faulty.fault("colorspace", Words::new(found, allowed, "export it again"));
            return None;
        }
        let luma_chroma = match space {
            "mycc" => Some(luma_chroma(json, faulty)?),
            _ => None,
        };
        let count = match luma_chroma {
            Some([luma, chroma, other]) => luma + chroma + other,
            None => json::whole(json, "nplanes", 1..=MOST_PLANES, faulty)? as usize,
        };
        let needed = match (kind, space) {
            ("ptm", "lrgb") => vec![PTM_TERMS + 3],
            ("ptm", _) => vec![3 * PTM_TERMS],
            // Of the first to the third order.
            ("hsh", _) => vec![12, 27, 48],
            _ => vec![count],
        };
        if !needed.contains(&count) {
            let allowed: Vec<String> = needed.iter().map(ToString::to_string).collect();
            let words = Words::new(count.to_string(), allowed.join(" or "), "export it again");
            faulty.fault("nplanes", words);
            return None;
        }
        let Some([material]) = json
            .get("materials")
            .and_then(Value::as_array)
            .map(Vec::as_slice)
        else {
            let found = found(json.get("materials"));
            let remedy = "export it without telling materials apart";
            faulty.fault("materials", Words::new(found, "a list of one", remedy));
            return None;
        };
        let mut of = |key| json::numbers(material, "materials[0]", key, count, faulty);
        let (scale, bias) = (of("scale"), of("bias"));
        let (basis, colours, kept) = match kind {
            "ptm" if space == "lrgb" => (Basis::Ptm, Colours::Luminance, count),
            "ptm" => (Basis::Ptm, Colours::Each, count),
            "hsh" => {
                let terms = (count / 3).min(HSH_TERMS);
                (Basis::Hsh(terms), Colours::Each, 3 * terms)
            }
            _ => {
                let samples = samples(json, kind, faulty)?;
                let rows = rows(file, json, [count, samples.count()], faulty)?;
                let table = Table {
                    samples,
                    rows,
                    luma_chroma,
                };
                (Basis::Table(table), Colours::Together, count)
            }
        };
        let (scale, bias) = (scale?, bias?);
        let planes = (0..count).map(|plane| {
            let (scale, bias) = match (colours, plane) {
                // Colours are stored as they are.
                (Colours::Luminance, 0..3) => (1.0, 0.0),
                _ => (scale[plane], bias[plane]),
            };
            Plane {
                to: place(kind, colours, plane),
                scale,
                bias,
            }
        });
        Some(Self {
            planes: planes.collect(),
            size: [size[0]? as usize, size[1]? as usize],
            basis,
            colours,
            kept,
            extensions: match format? {
                "png" => &["png"],
                _ => &["jpg", "jpeg"],
            },
        })
    }
}

/// Where a plane's value belongs among those of a pixel, as [`Colours`] says.
fn place(kind: &str, colours: Colours, plane: usize) -> usize {
    /// Relight's 1, lu, lv, lu², lu·lv, lv² among the terms of [`super::basis::ptm`].
    const TERM: [usize; PTM_TERMS] = [5, 3, 4, 0, 2, 1];
    match (kind, colours) {
        ("ptm", Colours::Luminance) if plane < 3 => PTM_TERMS + plane,
        ("ptm", Colours::Luminance) => TERM[plane - 3],
        ("ptm", _) => 3 * TERM[plane / 3] + plane % 3,
        _ => plane,
    }
}

/// A word of the file that must be one of these.
fn word<'j>(
    json: &'j Value,
    key: &str,
    words: &[&str],
    faulty: &mut Faulty<'_>,
) -> Option<&'j str> {
    let value = json.get(key);
    let word = value
        .and_then(Value::as_str)
        .filter(|word| words.contains(word));
    if word.is_none() {
        let allowed = quoted_list(words.iter().copied());
        let remedy = "export it from Relight in one of these";
        faulty.fault(key, Words::new(found(value), allowed, remedy));
    }
    word
}

/// How many planes luminance and each chroma have.
fn luma_chroma(json: &Value, faulty: &mut Faulty<'_>) -> Option<[usize; 3]> {
    let list = json::numbers(json, "", "yccplanes", 3, faulty)?;
    let whole = |number: &f64| number.fract() == 0.0 && (1.0..=MOST_PLANES as f64).contains(number);
    let [luma, chroma, other] = [list[0], list[1], list[2]];
    if list.iter().all(whole) && chroma == other && chroma <= luma {
        return Some([luma as usize, chroma as usize, other as usize]);
    }
    let found = format!("{list:?}");
    let allowed = "planes of luminance, and for each chroma as many and not more";
    faulty.fault("yccplanes", Words::new(found, allowed, "export it again"));
    None
}

/// Where the basis was sampled.
fn samples(json: &Value, kind: &str, faulty: &mut Faulty<'_>) -> Option<Samples> {
    if kind == "bilinear" {
        let side = json::whole(json, "resolution", 2..=MOST_RESOLUTION, faulty)?;
        return Some(Samples::Octahedron(side as usize));
    }
    let value = json.get("lights");
    let numbers = value.and_then(Value::as_array);
    let numbers: Option<Vec<f64>> = numbers
        .filter(|list| (3..=3 * MOST_LAMPS).contains(&list.len()) && list.len().is_multiple_of(3))
        .and_then(|list| list.iter().map(Value::as_f64).collect());
    if numbers.is_none() {
        let allowed = format!("x, y and z of 1 to {MOST_LAMPS} lamps, one after the other");
        faulty.fault(
            "lights",
            Words::new(found(value), allowed, "export it again"),
        );
    }
    let sigma = json.get("sigma").and_then(Value::as_f64);
    let sigma = sigma.filter(|sigma| (1e-3..=10.0).contains(sigma));
    if sigma.is_none() {
        let words = Words::new(
            found(json.get("sigma")),
            "a number from 0.001 to 10",
            "write the width of the Gaussian that it was made with, usually 0.125",
        );
        faulty.fault("sigma", words);
    }
    let lamps = numbers?;
    let lamps = lamps.chunks_exact(3).map(DVec3::from_slice).collect();
    Some(Samples::Lamps {
        lamps,
        sigma: sigma?,
    })
}

/// The mean and the vectors of each plane at each sample.
fn rows(
    file: &Path,
    json: &Value,
    [planes, samples]: [usize; 2],
    faulty: &mut Faulty<'_>,
) -> Option<Vec<Vec<[f64; 3]>>> {
    const REMEDY: &str = "export it again, and keep its files together";
    let needed = (planes + 1) * samples * 3;
    let material = json.get("materials").and_then(|list| list.get(0))?;
    let range = json::numbers(material, "materials[0]", "range", planes, faulty)?;
    if let Some(i) = range.iter().position(|range| range.abs() < 1e-9) {
        let words = Words::new("0", "a range that is not 0", REMEDY);
        faulty.fault(format!("materials[0].range[{i}]"), words);
        return None;
    }
    let bytes: Vec<f64> = match json.get("basis") {
        Some(_) => json::numbers(json, "", "basis", needed, faulty)?,
        None => {
            let beside = file.with_file_name("materials.bin");
            let read = json::bytes(&beside).ok();
            let found = read.as_ref().map_or("no such file".to_owned(), |bytes| {
                format!("{} bytes", bytes.len())
            });
            match read.filter(|bytes| bytes.len() >= needed) {
                Some(bytes) => bytes[..needed].iter().map(|b| f64::from(*b)).collect(),
                None => {
                    let allowed = format!("{needed} numbers in basis, or bytes in materials.bin");
                    faulty.fault("basis", Words::new(found, allowed, REMEDY));
                    return None;
                }
            }
        }
    };
    let row = |(plane, values): (usize, &[f64])| {
        let number = |value: f64| match plane {
            0 => value / 255.0,
            // The coefficient is 1 at white, where Relight's is 255.
            _ => (value - 127.0) / range[plane - 1],
        };
        let vectors = values.chunks_exact(3);
        vectors
            .map(|v| [number(v[0]), number(v[1]), number(v[2])])
            .collect()
    };
    Some(
        bytes
            .chunks_exact(3 * samples)
            .enumerate()
            .map(row)
            .collect(),
    )
}

/// The pictures of planes, three in each.
struct Planes {
    paths: Vec<PathBuf>,
    /// Of these, from when on rows are read.
    pictures: Vec<ColourRows>,
    planes: Vec<Plane>,
    kept: usize,
    width: usize,
}

impl Planes {
    /// Looks at the headers of all of them: a picture that does not belong here is not unpacked.
    fn find(file: &Path, info: &Info, faulty: &mut Faulty<'_>) -> Result<Self, ExchangeError> {
        let mut paths = Vec::new();
        for i in 0..info.planes.len().div_ceil(3) {
            let Some(path) = picture(file, i, info.extensions) else {
                let found = format!("no plane_{i}.{}", info.extensions[0]);
                faulty.fault(
                    "",
                    Words::new(found, "a picture of planes beside it", absent(file)),
                );
                continue;
            };
            let header = maps::probe(&path)?;
            let size = header.size.map(|side| side as usize);
            if size != info.size || header.channels < 3 {
                let found = format!(
                    "{} × {} pixels of {} channels in {}",
                    size[0],
                    size[1],
                    header.channels,
                    path.file_name().unwrap_or_default().to_string_lossy()
                );
                let allowed = format!("{} × {} pixels of colour", info.size[0], info.size[1]);
                let remedy = "keep the files of one export together";
                faulty.fault("width", Words::new(found, allowed, remedy));
            }
            paths.push(path);
        }
        faulty.check()?;
        Ok(Self {
            paths,
            pictures: Vec::new(),
            planes: info.planes.clone(),
            kept: info.kept,
            width: info.size[0],
        })
    }
}

/// The picture of planes with this number, as Relight's versions call it.
fn picture(file: &Path, i: usize, extensions: &[&str]) -> Option<PathBuf> {
    let names = extensions
        .iter()
        .flat_map(|extension| ["plane", "planes"].map(|stem| format!("{stem}_{i}.{extension}")));
    let mut paths = names.map(|name| file.with_file_name(name));
    paths.find(|path| path.is_file())
}

/// What to do where planes are absent.
fn absent(file: &Path) -> &'static str {
    let tiled = [
        "plane_0.dzi",
        "planes_0.dzi",
        "plane_0.tzi",
        "planes.tzi",
        "plane_0_files",
    ];
    match tiled.iter().any(|name| file.with_file_name(name).exists()) {
        true => "it was cut into tiles: export it again as images",
        false => "keep the files of one export together",
    }
}

impl Coefficients for Planes {
    fn begin(&mut self, scratch: &Path) -> Result<(), ExchangeError> {
        // Codes as they are: coefficients are no colours.
        let opened = self.paths.iter();
        let opened = opened.map(|path| ColourRows::open(path, ColourEncoding::Linear, scratch));
        self.pictures = opened.collect::<Result<_, _>>()?;
        Ok(())
    }

    fn next_row(&mut self, row: &mut [f64]) -> Result<(), ExchangeError> {
        let mut channels = [0, 1, 2].map(|_| vec![0.0; self.width]);
        for (i, picture) in self.pictures.iter_mut().enumerate() {
            let [r, g, b] = &mut channels;
            picture.read([r, g, b])?;
            let own = self.planes.iter().skip(3 * i).zip(&channels);
            for (plane, values) in own.filter(|(plane, _)| plane.to < self.kept) {
                let pixels = row.chunks_exact_mut(self.kept).zip(values);
                for (pixel, value) in pixels {
                    pixel[plane.to] = (f64::from(*value) - plane.bias) * plane.scale;
                }
            }
        }
        Ok(())
    }
}
