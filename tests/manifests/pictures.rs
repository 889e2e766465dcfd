//! The folder in which every manifest of these tests lies: sound and broken pictures.

use std::{fs, path::Path};

use image::{ColorType, GrayImage, ImageFormat, RgbImage};

/// A sheet of 200 × 100 mm at this size has square pixels.
const SHEET: [u32; 2] = [20, 10];

/// A lamp of 500 cd along its axis, none from 90° on.
const IES: &str =
    "IESNA:LM-63-2002\nTILT=NONE\n1 -1 500 3 1 1 2 0 0 0\n1 1 40\n0 45 90\n0\n1 .7 0\n";

/// Fills `folder` with files; symbolic links lead to `outside`.
pub fn write(folder: &Path, outside: &Path) {
    let rgb = |name: &str, [width, height]: [u32; 2]| {
        RgbImage::from_pixel(width, height, [200, 190, 170].into())
            .save(folder.join(name))
            .unwrap();
    };
    rgb("recto.png", SHEET);
    rgb("verso.png", SHEET);
    rgb("legend.jpg", SHEET);
    rgb("small.png", [10, 5]);
    rgb("square.png", [10, 10]);
    rgb("noise.png", [40, 20]);
    GrayImage::new(SHEET[0], SHEET[1])
        .save(folder.join("grey.png"))
        .unwrap();
    image::save_buffer_with_format(
        folder.join("sixteen.png"),
        &[0; 20 * 10 * 6],
        SHEET[0],
        SHEET[1],
        ColorType::Rgb16,
        ImageFormat::Png,
    )
    .unwrap();

    let sound = fs::read(folder.join("noise.png")).unwrap();
    fs::write(folder.join("truncated.png"), &sound[..sound.len() - 30]).unwrap();
    fs::write(folder.join("beheaded.png"), &sound[..20]).unwrap();
    fs::write(
        folder.join("oversized.png"),
        resized(&sound, 100_000, 100_000),
    )
    .unwrap();
    fs::write(folder.join("empty.png"), []).unwrap();
    fs::write(
        folder.join("letter.png"),
        "Dear Sir, the picture follows by post.",
    )
    .unwrap();
    fs::create_dir(folder.join("folder.png")).unwrap();

    fs::write(folder.join("lamp.ies"), IES).unwrap();
    fs::write(folder.join("type-b.ies"), IES.replace("3 1 1 2", "3 1 2 2")).unwrap();
    fs::write(folder.join("tilt.ies"), IES.replace("NONE", "INCLUDE")).unwrap();
    fs::write(folder.join("short.ies"), IES.replace(".7 0", "")).unwrap();
    fs::write(folder.join("nan.ies"), IES.replace(".7", "nan")).unwrap();
    fs::write(folder.join("sheet.glb"), model()).unwrap();
    fs::write(
        folder.join("bare.glb"),
        glb(&[(b"JSON", br#"{"asset":{"version":"2.0"}} "#)]),
    )
    .unwrap();

    let secret = outside.join("secret.png");
    fs::write(&secret, &sound).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(secret, folder.join("link.png")).unwrap();
        std::os::unix::fs::symlink("dangling-target.png", folder.join("dangling.png")).unwrap();
        std::os::unix::fs::symlink(outside, folder.join("elsewhere")).unwrap();
    }
}

/// The smallest binary glTF file with a mesh that could be a sheet: one triangle.
fn model() -> Vec<u8> {
    let json = br#"{
  "asset": { "version": "2.0" },
  "buffers": [{ "byteLength": 60 }],
  "bufferViews": [
    { "buffer": 0, "byteLength": 36 },
    { "buffer": 0, "byteOffset": 36, "byteLength": 24 }
  ],
  "accessors": [
    { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
      "min": [0, 0, 0], "max": [1, 1, 0] },
    { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" }
  ],
  "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } }] }]
}"#;
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let numbers: [f32; 15] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 1., 1., 0., 0.];
    let numbers: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    glb(&[(b"JSON", &json), (b"BIN\0", &numbers)])
}

fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let length = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap().to_le_bytes();
    let body: Vec<u8> = chunks
        .iter()
        .flat_map(|(name, data)| [&length(data), name.as_slice(), data].concat())
        .collect();
    let total = u32::try_from(12 + body.len()).unwrap();
    [
        b"glTF".as_slice(),
        &2u32.to_le_bytes(),
        &total.to_le_bytes(),
        &body,
    ]
    .concat()
}

/// The same PNG file claiming another size.
fn resized(png: &[u8], width: u32, height: u32) -> Vec<u8> {
    // 8 bytes of signature, then IHDR: length, name, width, height, 5 more bytes, checksum.
    let mut bytes = png.to_vec();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let checksum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
    bytes
}

/// The checksum of PNG chunks (ISO/IEC 15948, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 {
                (crc >> 1) ^ 0xedb8_8320
            } else {
                crc >> 1
            }
        })
    })
}
