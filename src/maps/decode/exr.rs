//! OpenEXR: R, G, B (and A) or Y, half, float or integer, scan lines or tiles. The picture is the
//! display window; what the data window leaves of it is black.

use std::{
    fs::File,
    io::BufReader,
    path::{Path, PathBuf},
};

use exr::{
    block::{UncompressedBlock, reader::ChunksReader},
    error::Error,
    math::Vec2,
    meta::{
        MetaData,
        attribute::{Chromaticities, SampleType},
        header::Header as ExrHeader,
    },
};
use glam::{DMat3, Mat3, Vec3};

use super::{Header, MapError, Missing, Raster, Samples, check_memory, check_size, plausible_dpi};
use crate::colour;

pub(in super::super) struct ExrPicture {
    path: PathBuf,
    file: BufReader<File>,
    /// Which part of the file, and what of it.
    layer: usize,
    /// Indices into the layer's channels, in the order of the raster.
    channels: Vec<usize>,
    /// Where the display window's corner lies in the data window.
    offset: Vec2<i64>,
    /// To the sRGB primaries, unless the file has them.
    to_srgb: Option<Mat3>,
    pub header: Header,
}

impl ExrPicture {
    pub fn open(path: &Path, mut file: BufReader<File>) -> Result<Self, MapError> {
        let meta =
            MetaData::read_from_buffered(&mut file, false).map_err(|error| refused(path, error))?;
        let Some((layer, exr, channels)) = meta
            .headers
            .iter()
            .enumerate()
            .find_map(|(i, header)| Some((i, header, wanted_channels(header)?)))
        else {
            return Err(MapError::unsupported(
                path,
                "has no channels R, G, B or Y, or they are subsampled or deep",
                "save it as plain RGB",
            ));
        };
        let attributes = &exr.shared_attributes;
        let window = attributes.display_window;
        let size = check_size(path, window.size.x() as u64, window.size.y() as u64)?;
        check_size(path, exr.layer_size.x() as u64, exr.layer_size.y() as u64)?;
        let offset = |axis: fn(&Vec2<i32>) -> i32| {
            i64::from(axis(&window.position)) - i64::from(axis(&exr.own_attributes.layer_position))
        };
        let list = &exr.channels.list;
        let half = channels
            .iter()
            .all(|&c| list[c].sample_type == SampleType::F16);
        let density = exr.own_attributes.horizontal_density.map(f64::from);
        let header = Header {
            size,
            channels: channels.len() as u8,
            bits: if half { 16 } else { 32 },
            float: true,
            dpi: density.and_then(|x| plausible_dpi(x, x * f64::from(attributes.pixel_aspect))),
            icc: false,
        };
        // Every value becomes 32 bits in memory.
        check_memory(path, &Header { bits: 32, ..header })?;
        let to_srgb = match &attributes.chromaticities {
            Some(chromaticities) if channels.len() >= 3 => srgb_matrix(path, chromaticities)?,
            _ => None,
        };
        let file = BufReader::new(File::open(path).map_err(|source| MapError::read(path, source))?);
        Ok(Self {
            path: path.into(),
            file,
            layer,
            channels,
            offset: Vec2(offset(|v| v.x()), offset(|v| v.y())),
            to_srgb,
            header,
        })
    }

    pub fn decode(self) -> Result<Raster, MapError> {
        let Self {
            path,
            file,
            layer,
            channels,
            offset,
            to_srgb,
            header,
        } = self;
        let refused = |error| refused(&path, error);
        let [width, height] = header.size.map(|v| v as usize);
        let count = channels.len();
        let mut values = vec![0.0f32; width * height * count];
        let reader = exr::block::read(file, false).map_err(refused)?;
        // The file may have been replaced since its header was read.
        let same = |exr: &ExrHeader| wanted_channels(exr).as_ref() == Some(&channels);
        if !reader.meta_data().headers.get(layer).is_some_and(same) {
            return Err(MapError::damaged(&path, "it changed while it was read"));
        }
        let chunks = reader
            .filter_chunks(false, |_, tile, block| {
                block.layer == layer && tile.level_index == Vec2(0, 0)
            })
            .map_err(refused)?;
        let insert = |meta: &MetaData, block: UncompressedBlock| {
            let list = &meta.headers[layer].channels;
            for line in block.lines(list) {
                let at = line.location;
                let Some(slot) = channels.iter().position(|&c| c == at.channel) else {
                    continue;
                };
                let row = at.position.y() as i64 - offset.y();
                if !(0..height as i64).contains(&row) {
                    continue;
                }
                let start = row as usize * width;
                let first = at.position.x() as i64 - offset.x();
                let mut put = |i: usize, value: f32| {
                    let column = first + i as i64;
                    if (0..width as i64).contains(&column) {
                        values[(start + column as usize) * count + slot] = value;
                    }
                };
                match list.list[at.channel].sample_type {
                    SampleType::F16 => {
                        for (i, value) in line.read_samples::<half::f16>().enumerate() {
                            put(i, value?.to_f32());
                        }
                    }
                    SampleType::F32 => {
                        for (i, value) in line.read_samples::<f32>().enumerate() {
                            put(i, value?);
                        }
                    }
                    SampleType::U32 => {
                        for (i, value) in line.read_samples::<u32>().enumerate() {
                            put(i, value? as f32);
                        }
                    }
                }
            }
            Ok(())
        };
        chunks.decompress_parallel(false, insert).map_err(refused)?;
        if let Some(matrix) = to_srgb {
            let sound = |pixel: &&mut [f32]| pixel.iter().all(|value| value.is_finite());
            for pixel in values.chunks_exact_mut(count).filter(sound) {
                // Finite times finite may still overflow.
                let rgb = (matrix * Vec3::from_slice(pixel)).clamp(Vec3::MIN, Vec3::MAX);
                rgb.write_to_slice(pixel);
            }
        }
        Ok(Raster {
            width,
            height,
            channels: count,
            samples: Samples::F32(values),
            premultiplied: true,
            icc: None,
            missing: Missing::default(),
        })
    }
}

/// Which channels of a layer make the picture; `None` where the layer is none.
fn wanted_channels(header: &ExrHeader) -> Option<Vec<usize>> {
    let list = &header.channels.list;
    let subsampled = list.iter().any(|channel| channel.sampling != Vec2(1, 1));
    if header.deep || subsampled {
        return None;
    }
    let find = |name: &str| list.iter().position(|channel| channel.name.eq(name));
    let mut wanted = match (find("R"), find("G"), find("B")) {
        (Some(r), Some(g), Some(b)) => vec![r, g, b],
        _ => vec![find("Y")?],
    };
    wanted.extend(find("A"));
    Some(wanted)
}

/// From linear RGB of these chromaticities to linear sRGB; `None` where they are the same. The
/// white is not adapted: OpenEXR means absolute colours, so that a file in XYZ (whose own white
/// is equal energy) shows what its twin in Rec. 709 shows.
fn srgb_matrix(path: &Path, from: &Chromaticities) -> Result<Option<Mat3>, MapError> {
    /// Writers round the primaries of Rec. 709 to three or four digits.
    const SAME: f64 = 1e-4;
    let xy = |v: &Vec2<f32>| [f64::from(v.x()), f64::from(v.y())];
    let primaries = [&from.red, &from.green, &from.blue].map(xy);
    let white = xy(&from.white);
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) <= SAME;
    if near(white, colour::D65)
        && primaries
            .iter()
            .zip(colour::SRGB_PRIMARIES)
            .all(|(&a, b)| near(a, b))
    {
        return Ok(None);
    }
    let to_xyz = colour::xyz_from_rgb_matrix(primaries, white);
    let matrix: DMat3 = colour::linear_from_xyz_matrix() * to_xyz;
    if !matrix.is_finite() {
        return Err(MapError::damaged(
            path,
            "its chromaticities span no colours",
        ));
    }
    Ok(Some(matrix.as_mat3()))
}

fn refused(path: &Path, error: Error) -> MapError {
    match error {
        Error::NotSupported(what) => {
            let found = format!("is a kind of OpenEXR that is not read ({what})");
            MapError::unsupported(path, found, "save it as RGB scan lines")
        }
        Error::Io(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            MapError::read(path, source)
        }
        Error::Io(_) => MapError::damaged(path, "it ends too early"),
        other => MapError::damaged(path, other),
    }
}
