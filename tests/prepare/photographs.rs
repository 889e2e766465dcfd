//! Photographs: read in bands as they are read whole, whatever their format; grey cards.

use std::path::{Path, PathBuf};

use recto::{
    maps::{self, ColourEncoding, ColourRows, encode},
    prepare::{
        capture::Crop,
        flat_field::{FlatField, FlatFieldError},
        photographs::Stack,
        reduced::Reduced,
    },
};

use super::{folder, support::data};
use crate::test_name;

fn whole(path: &Path) -> Crop {
    let [right, bottom] = maps::probe(path).expect("a picture").size;
    Crop {
        left: 0,
        top: 0,
        right,
        bottom,
    }
}

/// A crop of a picture by the loader of maps, which reads it whole.
fn at_once(path: &Path, encoding: ColourEncoding, crop: Crop) -> Vec<[f32; 3]> {
    let mut pixels = Vec::new();
    maps::for_each_colour_row(path, encoding, |y, row| {
        if (crop.top..crop.bottom).contains(&(y as u32)) {
            let row = &row[crop.left as usize..crop.right as usize];
            pixels.extend(row.iter().map(|p| [p[0], p[1], p[2]]));
        }
    })
    .expect("a picture");
    pixels
}

fn in_bands(paths: &[PathBuf], encoding: ColourEncoding, crop: Crop) -> Vec<Vec<[f32; 3]>> {
    let scratch = folder();
    let mut stack = Stack::open(paths, None, encoding, crop, scratch.path()).expect("a stack");
    let mut pixels = vec![Vec::new(); paths.len()];
    while let Some(band) = stack.next().expect("a band") {
        for (i, pixels) in pixels.iter_mut().enumerate() {
            for row in 0..band.rows {
                let [r, g, b] = band.row(i, row);
                pixels.extend((0..band.width).map(|x| [r[x], g[x], b[x]]));
            }
        }
    }
    pixels
}

/// Writes a picture of each format with the same content.
fn formats(folder: &Path) -> Vec<PathBuf> {
    let (width, height) = (97, 61);
    let value = |x: u32, y: u32, c: u32| ((x * 601 + y * 997 + c * 20011) % 65536) as u16;
    let pixels: Vec<[u16; 3]> = (0..width * height)
        .map(|i| [0, 1, 2].map(|c| value(i % width, i / width, c)))
        .collect();
    let png = folder.join("a.png");
    encode::save_png_rgb16(&png, width, height, &pixels, None).expect("written");
    let tiff = folder.join("a.tif");
    let mut file = std::fs::File::create(&tiff).expect("a file");
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).expect("a TIFF");
    // In strips of four rows; the last one has one.
    let mut image = encoder
        .new_image::<tiff::encoder::colortype::RGB16>(width, height)
        .expect("an image");
    image.rows_per_strip(4).expect("strips");
    image.write_data(pixels.as_flattened()).expect("written");
    drop(file);
    let exr = folder.join("a.exr");
    let floats: Vec<[f32; 3]> = pixels
        .iter()
        .map(|p| p.map(|v| f32::from(v) / 65535.0))
        .collect();
    encode::save_exr_rgb(&exr, width, height, &floats).expect("written");
    vec![png, tiff, exr]
}

#[test]
fn bands_hold_what_the_whole_picture_does() {
    let folder = folder();
    let paths = formats(folder.path());
    let crop = Crop {
        left: 5,
        top: 7,
        right: 90,
        bottom: 60,
    };
    for encoding in [ColourEncoding::Linear, ColourEncoding::Srgb] {
        for crop in [whole(&paths[0]), crop] {
            let bands = in_bands(&paths, encoding, crop);
            for (path, pixels) in paths.iter().zip(bands) {
                let expected = at_once(path, encoding, crop);
                assert_eq!(pixels.len(), crop.width() * crop.height());
                assert!(pixels == expected, "{}", path.display());
            }
        }
    }
}

#[test]
fn a_thin_stack_holds_every_so_manieth_row() {
    let folder = folder();
    let paths = formats(folder.path());
    let encoding = ColourEncoding::Linear;
    let crop = Crop {
        left: 5,
        top: 7,
        right: 90,
        bottom: 60,
    };
    // To the lower edge, where the last strip has one row, and not.
    for (bottom, step) in [60, 61]
        .into_iter()
        .flat_map(|bottom| [1, 2, 3, 4, 5, 9, 52, 53, 60].map(|step| (bottom, step)))
    {
        let crop = Crop { bottom, ..crop };
        let ambient = Some(paths[0].as_path());
        let mut stack =
            Stack::open(&paths[1..], ambient, encoding, crop, folder.path()).expect("a stack");
        stack.thin(step);
        let all = at_once(&paths[0], encoding, crop);
        let mut seen = Vec::new();
        while let Some(band) = stack.next().expect("a band") {
            for row in 0..band.rows {
                let y = band.y(row);
                seen.push(y);
                for i in 0..paths.len() - 1 {
                    // All show the same, which is also what is taken from them.
                    let [r, g, b] = band.row(i, row);
                    assert_eq!(band.width, crop.width());
                    assert!(
                        r.iter().chain(g).chain(b).all(|v| v.abs() < 1e-6),
                        "{step} {y}"
                    );
                }
            }
        }
        let expected: Vec<usize> = (0..crop.height()).step_by(step).collect();
        assert_eq!(seen, expected, "{step}");
        let mut alone = Stack::open(&paths, None, encoding, crop, folder.path()).expect("a stack");
        alone.thin(step);
        let band = alone.next().expect("a band").expect("rows");
        for (i, path) in paths.iter().enumerate() {
            for row in 0..band.rows {
                let [r, g, b] = band.row(i, row);
                let found: Vec<[f32; 3]> = (0..band.width).map(|x| [r[x], g[x], b[x]]).collect();
                let start = band.y(row) * crop.width();
                let expected = &all[start..start + crop.width()];
                assert!(found == expected, "{} {step} {row}", path.display());
            }
        }
    }
}

#[test]
fn bands_of_a_thin_stack_follow_each_other() {
    let folder = folder();
    // So wide that a band has 64 rows.
    let (width, height) = (5500, 300);
    let path = folder.path().join("wide.tif");
    let value = |x: usize, y: usize| ((x * 7 + y * 211) % 65536) as u16;
    let pixels: Vec<u16> = (0..width * height)
        .map(|i| value(i % width, i / width))
        .collect();
    let mut file = std::fs::File::create(&path).expect("a file");
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).expect("a TIFF");
    let mut image = encoder
        .new_image::<tiff::encoder::colortype::Gray16>(width as u32, height as u32)
        .expect("an image");
    image.rows_per_strip(7).expect("strips");
    image.write_data(&pixels).expect("written");
    drop(file);
    let grey = folder.path().join("grey.png");
    encode::save_png_grey16(&grey, 5500, 300, &vec![32768; width * height], None).expect("written");
    let (paths, crop) = ([path.clone(), path], whole(&grey));
    let encoding = ColourEncoding::Linear;
    // Half of the light is divided out.
    let field = FlatField::read(&grey, None, encoding, crop, 1.0, folder.path()).expect("a card");
    let mut stack = Stack::open(&paths, None, encoding, crop, folder.path()).expect("a stack");
    stack.thin(2);
    stack.divide(&[field.clone(), field]);
    let (mut rows, mut bands) = (0, 0);
    while let Some(band) = stack.next().expect("a band") {
        for row in 0..band.rows {
            assert_eq!(band.y(row), 2 * rows);
            for (x, found) in band.row(1, row)[2].iter().enumerate() {
                let shown = f32::from(value(x, 2 * rows)) / 32768.0;
                assert!((found - shown).abs() < 1e-3, "{x} {rows}: {found}");
            }
            rows += 1;
        }
        bands += 1;
        stack.recycle(band);
    }
    assert_eq!((rows, bands), (150, 3));
}

#[test]
fn what_is_left_out_beyond_the_lower_edge_is_told() {
    let folder = folder();
    for path in formats(folder.path()) {
        let open = || ColourRows::open(&path, ColourEncoding::Linear, folder.path()).expect("rows");
        let mut planes = [const { [0.0; 97] }; 3];
        let mut rows = open();
        rows.skip(60).expect("all but the last row");
        rows.read(planes.each_mut().map(|plane| &mut plane[..]))
            .expect("the last row");
        let mut rows = open();
        let beyond = rows
            .skip(64)
            .and_then(|()| rows.read(planes.each_mut().map(|plane| &mut plane[..])));
        assert!(beyond.is_err(), "{}", path.display());
    }
}

#[test]
fn real_files_are_read_in_bands_too() {
    let Some(root) = data(test_name!(), "") else {
        return;
    };
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["tiff", "exr/ScanLines", "exr/Chromaticities", "paper"] {
        let entries = std::fs::read_dir(root.join(folder)).expect("a folder");
        files.extend(entries.map(|entry| entry.expect("an entry").path()));
    }
    let mut read = 0;
    for path in files {
        if maps::verify_colour(&path, ColourEncoding::Embedded).is_err() {
            continue;
        }
        let crop = whole(&path);
        let expected = at_once(&path, ColourEncoding::Embedded, crop);
        let found = in_bands(std::slice::from_ref(&path), ColourEncoding::Embedded, crop);
        assert!(found[0] == expected, "{}", path.display());
        read += 1;
    }
    assert!(read > 10, "{read}");
}

#[test]
fn a_room_s_light_is_taken_away() {
    let folder = folder();
    let [lit, dark] = ["lit.png", "dark.png"].map(|name| folder.path().join(name));
    encode::save_png_grey16(&lit, 8, 8, &[30_000; 64], None).expect("written");
    encode::save_png_grey16(&dark, 8, 8, &[10_000; 64], None).expect("written");
    let mut stack = Stack::open(
        std::slice::from_ref(&lit),
        Some(&dark),
        ColourEncoding::Linear,
        whole(&lit),
        folder.path(),
    )
    .expect("a stack");
    let band = stack.next().expect("read").expect("a band");
    let left = band.row(0, 3)[1][3];
    assert!((left - 20_000.0 / 65535.0).abs() < 1e-6, "{left}");
}

#[test]
fn photographs_are_made_smaller_on_the_way_as_by_themselves() {
    let folder = folder();
    let paths = formats(folder.path());
    let crop = Crop {
        left: 3,
        top: 2,
        right: 96,
        bottom: 60,
    };
    for step in [1, 5, 7, 60] {
        let encoding = ColourEncoding::Linear;
        // The room's light, which is taken from a photograph, does not move either.
        let ambient = Some(paths[0].as_path());
        let mut stack =
            Stack::open(&paths, ambient, encoding, crop, folder.path()).expect("a stack");
        stack.reduce(step);
        while stack.next().expect("read").is_some() {}
        let greys = stack.greys();
        assert_eq!(greys.len(), paths.len());
        for (path, grey) in paths.iter().zip(greys) {
            let alone = Reduced::read(path, encoding, crop, step, folder.path()).expect("read");
            assert_eq!(alone.size, [93 / step, 58 / step]);
            assert_eq!(alone.planes[1].len(), alone.size[0] * alone.size[1]);
            assert!(grey.finish() == (alone.size, alone.grey()), "{step}");
        }
    }
}

/// How even a grey card is once divided by itself, a lamp falling off by half over it.
const EVEN: f32 = 2e-3;

#[test]
fn of_a_large_grey_card_some_rows_are_enough() {
    let folder = folder();
    let path = folder.path().join("grey.png");
    let (width, height) = (5200u32, 330u32);
    let light = |x: u32, y: u32| {
        0.6 / (1.0 + 0.7 * (f64::from(x) / 5200.0).powi(2) + 0.1 * f64::from(y) / 330.0)
    };
    let noise = |x: u32, y: u32| f64::from((x * 7919 + y * 104_729) % 101) / 101.0 - 0.5;
    let value = |x: u32, y: u32| 65535.0 * light(x, y) * (1.0 + 0.06 * noise(x, y));
    let pixels: Vec<u16> = (0..width * height)
        .map(|i| value(i % width, i / width) as u16)
        .collect();
    encode::save_png_grey16(&path, width, height, &pixels, None).expect("written");
    let (encoding, crop) = (ColourEncoding::Linear, whole(&path));
    let field = FlatField::read(&path, None, encoding, crop, 0.18, folder.path()).expect("a field");
    for y in [0, 1, 160, 329] {
        let row: Vec<f32> = (0..width).map(|x| light(x, y) as f32).collect();
        let mut planes = [row.clone(), row.clone(), row];
        let [r, g, b] = &mut planes;
        field.divide(y as usize, [r, g, b]);
        for value in planes.as_flattened_planes() {
            assert!((value / 0.18 - 1.0).abs() < EVEN, "{y}: {value}");
        }
    }
}

#[test]
fn a_grey_card_takes_the_fall_off_away_and_not_its_own_noise() {
    let folder = folder();
    let path = folder.path().join("grey.png");
    let (width, height) = (640u32, 400u32);
    let light = |x: u32, y: u32| {
        let (u, v) = (f64::from(x) / 640.0, f64::from(y) / 400.0);
        0.6 / ((1.0 + u * u * 0.7) * (1.0 + 0.3 * v))
    };
    // Noise of 3 %, which must not be divided into the sheet.
    let noise = |x: u32, y: u32| f64::from((x * 7919 + y * 104_729) % 101) / 101.0 - 0.5;
    let pixels: Vec<u16> = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            (65535.0 * light(x, y) * (1.0 + 0.06 * noise(x, y))).round() as u16
        })
        .collect();
    encode::save_png_grey16(&path, width, height, &pixels, None).expect("written");
    let read = || {
        FlatField::read(
            &path,
            None,
            ColourEncoding::Linear,
            whole(&path),
            0.18,
            folder.path(),
        )
    };
    let field = read().expect("a field");
    let mut worst = 0.0f32;
    for y in 0..height {
        let row: Vec<f32> = (0..width).map(|x| light(x, y) as f32).collect();
        let mut planes = [row.clone(), row.clone(), row];
        let [r, g, b] = &mut planes;
        field.divide(y as usize, [r, g, b]);
        for value in planes.as_flattened_planes() {
            worst = worst.max((value / 0.18 - 1.0).abs());
        }
    }
    assert!(worst < EVEN, "{worst}");

    encode::save_png_grey16(&path, width, height, &vec![65535; pixels.len()], None)
        .expect("written");
    assert!(matches!(read(), Err(FlatFieldError::Saturated { .. })));
    let mut dark = pixels;
    for y in 0..60 {
        dark[y * 640..y * 640 + 60].fill(20);
    }
    encode::save_png_grey16(&path, width, height, &dark, None).expect("written");
    let error = read().expect_err("a dark corner").to_string();
    assert!(
        error.contains("grey.png") && error.contains("column"),
        "{error}"
    );
}

trait Planes {
    fn as_flattened_planes(&self) -> impl Iterator<Item = f32>;
}

impl Planes for [Vec<f32>; 3] {
    fn as_flattened_planes(&self) -> impl Iterator<Item = f32> {
        self.iter().flatten().copied()
    }
}
