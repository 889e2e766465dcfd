//! Bands of light as one picture, and files read at one place, against numbers by hand.

use std::path::{Path, PathBuf};

use glam::{DAffine2, DVec2, dvec2};
use recto::maps::{
    BandPicture, ColourEncoding, ColourMapName, DIVERGING, Rasters, category_at, colour_at, encode,
    load_bands_as_colour, load_bands_as_difference, value_at,
};

use super::{channel, folder};

/// Half a code of 8 bits.
const HALF_CODE: f64 = 0.5 / 255.0;

fn grey(path: &Path, size: [u32; 2], values: &[u8]) -> PathBuf {
    encode::save_png_grey8(path, size[0], size[1], values, None).expect("written");
    path.to_owned()
}

fn band(path: &PathBuf, uv_from_side: DAffine2) -> BandPicture<'_> {
    BandPicture {
        file: path.into(),
        encoding: ColourEncoding::Linear,
        uv_from_side,
    }
}

#[test]
fn a_false_colour_is_the_sum_of_weights_times_reflectance() {
    let folder = folder();
    let red = grey(&folder.path().join("a.png"), [2, 1], &[51, 255]);
    let blue = grey(&folder.path().join("b.png"), [2, 1], &[102, 0]);
    let place = DAffine2::from_scale(dvec2(0.01, 0.02));
    let bands = [band(&red, place), band(&blue, place)];
    let weights = [[1.0, 0.5, 0.0], [0.0, 0.25, 3.0]];
    let shown = load_bands_as_colour(&bands, &weights).expect("read");
    let texel =
        |i: usize| -> [f64; 4] { std::array::from_fn(|c| f64::from(channel(&shown, 0, c)[i])) };
    // 0.2 and 0.4: 0.2, 0.1 + 0.1, and 1.2, which is more than a paper can reflect.
    for (found, expected) in texel(0).into_iter().zip([0.2, 0.2, 1.0, 1.0]) {
        assert!((found - expected).abs() < 1e-4, "{:?}", texel(0));
    }
    for (found, expected) in texel(1).into_iter().zip([1.0, 0.5, 0.0, 1.0]) {
        assert!((found - expected).abs() < 1e-4, "{:?}", texel(1));
    }
}

#[test]
fn a_difference_has_its_sign_and_its_scale() {
    let folder = folder();
    let first = grey(&folder.path().join("a.png"), [3, 1], &[51, 102, 255]);
    let second = grey(&folder.path().join("b.png"), [3, 1], &[102, 102, 0]);
    let place = DAffine2::from_scale(DVec2::splat(0.01));
    let bands = [band(&first, place), band(&second, place)];
    let shown = load_bands_as_difference(&bands, 0.4, DIVERGING).expect("read");
    // −0.2 of 0.4 is a quarter of the scale; 0 its middle; 1 beyond its end.
    for (i, at) in [(0, 0.25), (1, 0.5), (2, 1.0)] {
        let expected = ColourMapName::Diverging.colour(at);
        for (c, expected) in expected.into_iter().enumerate() {
            let found = f64::from(channel(&shown, 0, c)[i]);
            assert!((found - expected).abs() < 1e-3, "{i}: {found} {expected}");
        }
    }
    // Exchanged, the colours are too: blue and red are not one.
    let swapped = [bands[1], bands[0]];
    let shown = load_bands_as_difference(&swapped, 0.4, DIVERGING).expect("read");
    let expected = ColourMapName::Diverging.colour(0.75)[0];
    assert!((f64::from(channel(&shown, 0, 0)[0]) - expected).abs() < 1e-3);
}

#[test]
fn a_band_that_lies_elsewhere_is_brought_to_the_first_one_s_texels() {
    let folder = folder();
    // Four texels of 25 mm, and the same four shifted to the right by 50 mm.
    let first = grey(&folder.path().join("a.png"), [4, 1], &[0; 4]);
    let values = [10, 60, 110, 160];
    let second = grey(&folder.path().join("b.png"), [4, 1], &values);
    let place = DAffine2::from_scale(dvec2(0.01, 0.04));
    let moved = place * DAffine2::from_translation(dvec2(-50.0, 0.0));
    let bands = [band(&first, place), band(&second, moved)];
    let shown = load_bands_as_colour(&bands, &[[0.0; 3], [1.0; 3]]).expect("read");
    let [value, alpha] = [0, 3].map(|c| channel(&shown, 0, c));
    for (i, code) in [(2, 10), (3, 60)] {
        let expected = f64::from(code) / 255.0;
        assert!((f64::from(value[i]) - expected).abs() < 1e-4);
        assert_eq!(alpha[i], 1.0);
    }
    // Where one of them shows nothing, nothing is shown.
    assert_eq!((alpha[0], alpha[1]), (0.0, 0.0));
}

#[test]
fn a_place_is_read_between_the_middles_of_pixels() {
    let folder = folder();
    let path = grey(&folder.path().join("a.png"), [2, 2], &[0, 100, 200, 250]);
    let at = |u: f64, v: f64| value_at(&mut Rasters::default(), &path, dvec2(u, v)).expect("read");
    assert_eq!(at(0.25, 0.25), Some(0.0));
    let middle = at(0.5, 0.5).expect("a value");
    assert!((middle - 550.0 / 4.0 / 255.0).abs() < 1e-6, "{middle}");
    assert_eq!(at(1.2, 0.5), None);
    let linear = colour_at(
        &mut Rasters::default(),
        &path,
        ColourEncoding::Linear,
        dvec2(0.75, 0.25),
    )
    .expect("read");
    let [r, g, b] = linear.expect("a colour");
    assert!((r - 100.0 / 255.0).abs() < HALF_CODE && r == g && g == b);

    let path = folder.path().join("codes.png");
    let pixels = [[1, 2, 3, 255], [4, 5, 6, 255], [1, 2, 3, 0], [9, 9, 9, 255]];
    encode::save_png_rgba8(&path, 2, 2, &pixels, None).expect("written");
    let legend = [[1, 2, 3], [4, 5, 6]];
    let at = |u: f64, v: f64| {
        category_at(&mut Rasters::default(), &path, &legend, dvec2(u, v)).expect("read")
    };
    assert_eq!(at(0.2, 0.2), Some(0));
    assert_eq!(at(0.6, 0.4), Some(1));
    assert_eq!(at(0.2, 0.8), None, "transparent");
    assert_eq!(at(0.9, 0.9), None, "unlisted");
    assert_eq!(at(-0.1, 0.2), None, "beside");
}
