//! No file makes the loaders panic, run away, or keep quiet about damage.

use std::{
    fs,
    io::Cursor,
    path::{Path, PathBuf},
    sync::LazyLock,
};

use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder};
use proptest::prelude::*;
use recto::maps::{self, ColourEncoding, MapError, NormalY, encode, probe, verify};
use tiff::encoder::{Compression, TiffEncoder, colortype};

use super::folder;

const WIDTH: u32 = 19;
const HEIGHT: u32 = 17;

/// A small valid file of every format and of several ways to store pixels.
static VALID: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let folder = folder();
    let path = folder.path().join("valid");
    let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8;
    let rgb: Vec<[u8; 3]> = (0..WIDTH * HEIGHT)
        .map(|i| [noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)])
        .collect();
    let written = |result: Result<(), MapError>| {
        result.expect("written");
        fs::read(&path).expect("read")
    };
    let rgb16: Vec<_> = rgb
        .iter()
        .map(|pixel| pixel.map(|v| u16::from(v) * 257))
        .collect();
    let float: Vec<_> = rgb.iter().map(|pixel| pixel.map(f32::from)).collect();
    let jpeg = |grey: bool| {
        let mut bytes = Cursor::new(Vec::new());
        let encoder = JpegEncoder::new_with_quality(&mut bytes, 80);
        let flat = rgb.as_flattened();
        let (samples, colour) = if grey {
            (&flat[..rgb.len()], ExtendedColorType::L8)
        } else {
            (flat, ExtendedColorType::Rgb8)
        };
        encoder
            .write_image(samples, WIDTH, HEIGHT, colour)
            .expect("encoded");
        bytes.into_inner()
    };
    let tiff = |compression| {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes)
            .expect("an encoder")
            .with_compression(compression);
        encoder
            .write_image::<colortype::RGB16>(WIDTH, HEIGHT, rgb16.as_flattened())
            .expect("encoded");
        bytes.into_inner()
    };
    vec![
        (
            "png8",
            written(encode::save_png_rgb8(
                &path,
                WIDTH,
                HEIGHT,
                &rgb,
                Some(300.0),
            )),
        ),
        (
            "png16",
            written(encode::save_png_rgb16(&path, WIDTH, HEIGHT, &rgb16, None)),
        ),
        (
            "exr",
            written(encode::save_exr_rgb(&path, WIDTH, HEIGHT, &float)),
        ),
        ("jpeg", jpeg(false)),
        ("grey jpeg", jpeg(true)),
        ("tiff", tiff(Compression::Uncompressed)),
        ("lzw tiff", tiff(Compression::Lzw)),
    ]
});

/// Loads a file in every way; whatever comes of it, each error is one line with the path.
fn load_every_way(path: &Path) -> usize {
    let results = [
        probe(path).map(drop),
        verify(path).map(drop),
        maps::load_colour(path, ColourEncoding::Embedded).map(drop),
        maps::load_normal(path, NormalY::Down).map(drop),
        maps::load_media_legend(path, &[[1, 2, 3]]).map(drop),
    ];
    let errors = results
        .into_iter()
        .filter_map(Result::err)
        .map(|error| error.to_string());
    errors
        .inspect(|line| {
            assert!(
                !line.contains('\n') && line.starts_with(&*path.to_string_lossy()),
                "{line}"
            );
        })
        .count()
}

fn write(folder: &tempfile::TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("map");
    fs::write(&path, bytes).expect("written");
    path
}

#[test]
fn the_unharmed_files_load() {
    let folder = folder();
    for (name, bytes) in VALID.iter() {
        let path = write(&folder, bytes);
        assert_eq!(probe(&path).expect(name).size, [WIDTH, HEIGHT]);
        assert_eq!(verify(&path).expect(name).count, 0);
    }
}

#[test]
fn truncated_files_are_damaged() {
    let folder = folder();
    for (name, bytes) in VALID.iter() {
        for length in 0..bytes.len() {
            let path = write(&folder, &bytes[..length]);
            let errors = load_every_way(&path);
            // The last bytes only close the file.
            let closing = 24;
            assert!(
                errors > 0 || length + closing > bytes.len(),
                "{name} cut to {length}"
            );
        }
    }
}

#[test]
fn impossible_sizes_are_refused_before_anything_is_allocated() {
    let folder = folder();
    let png = &VALID[0].1;
    for (width, height) in [
        (0, 5),
        (5, 0),
        (60_000, 60_000),
        (16_385, 1),
        (u32::MAX, u32::MAX),
    ] {
        let mut bytes = png.clone();
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        // The checksum of the header is right, so the size alone is at fault.
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        let error = probe(&write(&folder, &bytes)).expect_err("refused");
        let line = error.to_string();
        assert!(
            matches!(error, MapError::Size { .. }) || line.contains("is damaged"),
            "{width} × {height}: {line}"
        );
        if width > 16_384 && width < 100_000 {
            assert!(line.ends_with(&format!(
                "map: is {width} × {height} pixels; each side must have 1 to 16384 pixels: \
                 resample it"
            )));
        }
    }
}

/// CRC-32 of ISO 3309, as PNG uses it.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & (c & 1).wrapping_neg())
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_files_never_panic(
        which in 0usize..7,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        // Headers are short, and where the danger lies.
        near_start in any::<bool>(),
    ) {
        let folder = folder();
        let mut bytes = VALID[which].1.clone();
        let reach = if near_start { bytes.len().min(400) } else { bytes.len() };
        for (place, value) in changes {
            let place = place.index(reach);
            bytes[place] = value;
        }
        load_every_way(&write(&folder, &bytes));
    }
}
