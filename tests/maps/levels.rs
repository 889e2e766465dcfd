//! Mip chains against closed forms.

use recto::{
    colour,
    maps::{
        self, Coding, ColourEncoding, ColourMapName, NormalY, Pyramid, Texels, encode,
        normal_coding,
    },
};

use super::{channel, folder, mean};

/// Half a step of the stored texels, and a little for the arithmetic in f32.
const UNORM8: f64 = 0.51 / 255.0;
const UNORM16: f64 = 0.51 / 65535.0;

fn load(
    width: u32,
    height: u32,
    pixel: impl Fn(u32, u32) -> [u8; 3],
    load: impl FnOnce(&std::path::Path) -> Pyramid,
) -> Pyramid {
    let folder = folder();
    let path = folder.path().join("map.png");
    let pixels: Vec<_> = (0..width * height)
        .map(|i| pixel(i % width, i / width))
        .collect();
    encode::save_png_rgb8(&path, width, height, &pixels, None).expect("written");
    load(&path)
}

fn sizes(pyramid: &Pyramid) -> Vec<(u32, u32)> {
    pyramid
        .levels
        .iter()
        .map(|level| (level.width, level.height))
        .collect()
}

#[test]
fn a_checkerboard_becomes_its_mean_in_linear_light() {
    let pyramid = load(
        8,
        8,
        |x, y| if (x + y) % 2 == 0 { [255; 3] } else { [0; 3] },
        |path| maps::load_colour(path, ColourEncoding::Srgb).expect("read"),
    );
    assert_eq!(sizes(&pyramid), [(8, 8), (4, 4), (2, 2), (1, 1)]);
    for level in 1..4 {
        for c in 0..3 {
            for value in channel(&pyramid, level, c) {
                // Averaging codes instead would give 0.214.
                assert!(
                    (f64::from(value) - 0.5).abs() < UNORM16,
                    "level {level}: {value}"
                );
            }
        }
        assert!(
            channel(&pyramid, level, 3)
                .iter()
                .all(|&alpha| alpha == 1.0)
        );
    }
}

#[test]
fn odd_sizes_conserve_the_mean() {
    // The last row and column are bright: a filter that drops them loses much of the mean.
    for (w, h) in [(7, 5), (9, 1), (1, 13), (37, 23), (3, 3), (1, 1), (2, 3)] {
        let pyramid = load(
            w,
            h,
            |x, y| {
                if x == w - 1 || y == h - 1 {
                    [250; 3]
                } else {
                    [(x * 5 + y * 3) as u8; 3]
                }
            },
            |path| maps::load_colour(path, ColourEncoding::Linear).expect("read"),
        );
        let expected = mean(&channel(&pyramid, 0, 0));
        for level in 0..pyramid.levels.len() {
            let found = mean(&channel(&pyramid, level, 0));
            assert!(
                (found - expected).abs() < UNORM16,
                "{w}×{h}, level {level}: {found}"
            );
        }
        assert_eq!(sizes(&pyramid).last(), Some(&(1, 1)));
    }
}

#[test]
fn integers_decode_within_one_step_of_linear_16_bits() {
    let folder = folder();
    let path = folder.path().join("all.png");
    let codes: Vec<u16> = (0..=u16::MAX).collect();
    encode::save_png_grey16(&path, 256, 256, &codes, None).expect("written");
    let pyramid = maps::load_colour(&path, ColourEncoding::Embedded).expect("read");
    assert!(matches!(pyramid.levels[0].texels, Texels::Unorm16(_)));
    for (code, value) in codes.iter().zip(channel(&pyramid, 0, 1)) {
        let exact = colour::srgb_decode(f64::from(*code) / 65535.0);
        assert!(
            (f64::from(value) - exact).abs() < UNORM16,
            "{code}: {value} not {exact}"
        );
    }
}

fn decoded(pyramid: &Pyramid, level: usize) -> Vec<[f64; 3]> {
    let Coding { scale, offset } = normal_coding(&pyramid.levels[level].texels);
    let decode = |stored: f32| scale * f64::from(stored) + offset;
    let [x, y, z] = [0, 1, 2].map(|c| channel(pyramid, level, c));
    (0..x.len())
        .map(|i| [x[i], y[i], z[i]].map(decode))
        .collect()
}

#[test]
fn flat_normals_are_exactly_flat() {
    for y in [NormalY::Up, NormalY::Down] {
        let load = |path: &std::path::Path| maps::load_normal(path, y).expect("read");
        // Plain, without length, and facing away.
        for code in [[128, 128, 255], [128, 128, 128], [200, 128, 10]] {
            let pyramid = self::load(5, 4, |_, _| code, load);
            for level in 0..pyramid.levels.len() {
                let Texels::Unorm16(stored) = &pyramid.levels[level].texels else {
                    panic!("normals have 16 bits");
                };
                assert!(
                    stored
                        .chunks(4)
                        .all(|v| v == [32768, 32768, u16::MAX, u16::MAX]),
                    "{code:?}: {stored:?}"
                );
                for [x, y, z] in decoded(&pyramid, level) {
                    // What f32 leaves of 32768/65535.
                    assert!(x.abs() < 1e-7 && y.abs() < 1e-7 && (z - 1.0).abs() < 1e-7);
                }
            }
        }
    }
}

#[test]
fn normals_are_averaged_as_vectors_and_stay_short() {
    // (0.6, 0, 0.8) beside (−0.8, 0, 0.6): their mean is (−0.1, 0, 0.7), of length √½.
    let folder = folder();
    let path = folder.path().join("normal.png");
    let code = |n: f64| (n * 32767.0).round() as i32 + 32768;
    let pixel = |n: [f64; 3]| n.map(|v| code(v) as u16);
    let pixels = [pixel([0.6, 0.0, 0.8]), pixel([-0.8, 0.0, 0.6])];
    encode::save_png_rgb16(&path, 2, 1, &pixels, None).expect("written");
    let pyramid = maps::load_normal(&path, NormalY::Up).expect("read");
    let [[x, y, z]] = decoded(&pyramid, 1)[..] else {
        panic!("one texel")
    };
    assert!(
        (x + 0.1).abs() < 4.0 * UNORM16 && (z - 0.7).abs() < 4.0 * UNORM16 && y.abs() < 1e-7,
        "{x}, {y}, {z}"
    );
}

#[test]
fn y_down_is_y_up_turned_over() {
    let pixel = |x: u32, y: u32| [128, (90 + 20 * x + 7 * y) as u8, 240];
    let up = load(4, 4, pixel, |path| {
        maps::load_normal(path, NormalY::Up).expect("read")
    });
    let down = load(4, 4, pixel, |path| {
        maps::load_normal(path, NormalY::Down).expect("read")
    });
    for level in 0..up.levels.len() {
        for (a, b) in decoded(&up, level).into_iter().zip(decoded(&down, level)) {
            // −1 itself is stored as 1 − 127·2, so mirrored codes differ by rounding alone.
            assert!((a[0] - b[0]).abs() < 1e-6 && (a[1] + b[1]).abs() < 2.1 * UNORM8 * 2.0);
        }
    }
    assert_ne!(up, down);
}

#[test]
fn gloss_is_inverted_roughness() {
    let pixel = |x: u32, y: u32| [(x * 16 + y) as u8; 3];
    let rough = load(5, 3, pixel, |path| {
        maps::load_roughness(path, false).expect("read")
    });
    let gloss = load(5, 3, pixel, |path| {
        maps::load_roughness(path, true).expect("read")
    });
    assert_eq!(rough.channels, 1);
    for (a, b) in channel(&rough, 0, 0).iter().zip(channel(&gloss, 0, 0)) {
        assert!((f64::from(a + b) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn height_keeps_16_bits_and_clamps_floats() {
    let folder = folder();
    let path = folder.path().join("height.png");
    let codes = [0, 1, 32767, 65535];
    encode::save_png_grey16(&path, 2, 2, &codes, None).expect("written");
    let pyramid = maps::load_height(&path).expect("read");
    assert_eq!(pyramid.levels[0].texels, Texels::Unorm16(codes.to_vec()));
    let path = folder.path().join("height.exr");
    encode::save_exr_rgb(&path, 2, 1, &[[-3.0; 3], [9.0; 3]]).expect("written");
    let pyramid = maps::load_height(&path).expect("read");
    assert_eq!(pyramid.levels[0].texels, Texels::Unorm16(vec![0, 65535]));
}

const INK: [u8; 3] = [0x3b, 0x2a, 0x1a];
const LEAD: [u8; 3] = [0x80, 0x80, 0x80];
const CHALK: [u8; 3] = [0xd5, 0x5e, 0x00];

/// Three legend colours and white in vertical bands of 4 pixels.
fn bands(x: u32, _: u32) -> [u8; 3] {
    [INK, LEAD, CHALK, [255; 3]][(x / 4 % 4) as usize]
}

#[test]
fn legend_weights_are_coverage() {
    let map =
        |path: &std::path::Path| maps::load_media_legend(path, &[INK, LEAD, CHALK]).expect("read");
    let folder = folder();
    let path = folder.path().join("media.png");
    let pixels: Vec<_> = (0..16 * 5).map(|i| bands(i % 16, 0)).collect();
    encode::save_png_rgb8(&path, 16, 5, &pixels, None).expect("written");
    let map = map(&path);
    assert_eq!(map.unlisted, [([255; 3], 20)]);
    assert_eq!(map.pyramid.channels, 4);
    for level in 0..map.pyramid.levels.len() {
        let weights: [_; 4] = std::array::from_fn(|c| channel(&map.pyramid, level, c));
        for i in 0..weights[0].len() {
            let sum: f64 = weights.iter().map(|w| f64::from(w[i])).sum();
            assert!(sum < 1.0 + 4.0 * UNORM8, "level {level}: {sum}");
        }
        for w in &weights[..3] {
            assert!(
                (mean(w) - 0.25).abs() < UNORM8,
                "level {level}: {}",
                mean(w)
            );
        }
        assert_eq!(mean(&weights[3]), 0.0);
    }
    assert_eq!(channel(&map.pyramid, 0, 1)[4..8], [1.0; 4]);
}

#[test]
fn too_many_media_are_refused_in_words() {
    let folder = folder();
    let path = folder.path().join("media.png");
    encode::save_png_rgb8(&path, 1, 1, &[INK], None).expect("written");
    let error = maps::load_media_legend(&path, &[INK; 5])
        .expect_err("five")
        .to_string();
    assert!(error.ends_with(
        "media.png: is declared with 5 colours in its legend, and 1 to 4 are allowed; split it \
         into several files"
    ));
    let error = maps::load_media_weights(&path, 4)
        .expect_err("three")
        .to_string();
    assert!(
        error.ends_with(
            "media.png: has 3 channels for 4 media; give each medium a channel of its own"
        )
    );
}

#[test]
fn categorical_overlays_are_premultiplied_legend_colours() {
    let folder = folder();
    let path = folder.path().join("damage.png");
    let pixels: Vec<_> = (0..16 * 4).map(|i| bands(i % 16, 0)).collect();
    encode::save_png_rgb8(&path, 16, 4, &pixels, None).expect("written");
    let map = maps::load_overlay_categorical(&path, &[CHALK]).expect("read");
    assert_eq!(map.unlisted.len(), 3);
    let expected = colour::linear_from_srgb8(CHALK);
    for level in 0..map.pyramid.levels.len() {
        let alpha = channel(&map.pyramid, level, 3);
        for (c, expected) in expected.into_iter().enumerate() {
            for (value, alpha) in channel(&map.pyramid, level, c).iter().zip(&alpha) {
                let ideal = expected * f64::from(*alpha);
                assert!(
                    (f64::from(*value) - ideal).abs() < 2.0 * UNORM16,
                    "{value} {ideal}"
                );
            }
        }
        assert!((mean(&alpha) - 0.25).abs() < UNORM16);
    }
}

#[test]
fn continuous_overlays_show_colours_of_the_map_only() {
    let folder = folder();
    let path = folder.path().join("moisture.png");
    let values = [0, 0, 65535, 65535];
    encode::save_png_grey16(&path, 4, 1, &values, None).expect("written");
    let pyramid = maps::load_overlay_continuous(&path, ColourMapName::Viridis).expect("read");
    // The middle of the map, not the mean of its ends.
    let expected = ColourMapName::Viridis.colour(0.5);
    let last = pyramid.levels.len() - 1;
    for (c, expected) in expected.into_iter().enumerate() {
        let value = f64::from(channel(&pyramid, last, c)[0]);
        // The table has 4096 steps.
        assert!((value - expected).abs() < 5e-4, "{value} not {expected}");
    }
    assert_eq!(channel(&pyramid, last, 3), [1.0]);
}

#[test]
fn pictures_are_premultiplied_and_outlines_use_alpha() {
    let folder = folder();
    let path = folder.path().join("uv.png");
    let pixels = [
        [255, 188, 0, 255],
        [255, 255, 255, 0],
        [255, 0, 0, 51],
        [0, 0, 0, 255],
    ];
    encode::save_png_rgba8(&path, 2, 2, &pixels, None).expect("written");
    let pyramid = maps::load_overlay_picture(&path, ColourEncoding::Embedded).expect("read");
    assert_eq!(channel(&pyramid, 0, 3), [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(channel(&pyramid, 0, 0), [1.0, 0.0, 0.2, 0.0]);
    let green = f64::from(channel(&pyramid, 0, 1)[0]);
    assert!((green - colour::srgb_decode(188.0 / 255.0)).abs() < UNORM16);
    let outline = maps::load_outline(&path).expect("read");
    assert_eq!(
        outline.levels[0].texels,
        Texels::Unorm8(vec![255, 0, 51, 0])
    );
}
