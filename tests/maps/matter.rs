//! Media over each other: what shows of each, and how rough that is.

use std::path::{Path, PathBuf};

use recto::maps::{
    self, MatterPart,
    MatterSlot::{self, Body, Film, Nothing, Particles},
    MediaChannels::{Legend, Weights},
    MediaLayer, Pyramid, encode,
};

use super::{channel, folder, mean};

/// One code of 8 bits: what cumulative rounding may be off by.
const CODE: f64 = 1.0 / 255.0;

fn grey(folder: &Path, name: &str, size: [u32; 2], value: impl Fn(usize) -> u8) -> PathBuf {
    let path = folder.join(name);
    let values: Vec<u8> = (0..(size[0] * size[1]) as usize).map(value).collect();
    encode::save_png_grey8(&path, size[0], size[1], &values, None).expect("written");
    path
}

fn layer<T>(path: &Path, each: impl IntoIterator<Item = T>) -> MediaLayer<T> {
    MediaLayer {
        path: path.to_owned(),
        warp: None,
        channels: Weights(each.into_iter().collect()),
    }
}

fn first(layers: &[MediaLayer<MatterSlot>]) -> Pyramid {
    maps::load_matter(layers, MatterPart::First).expect("read")
}

/// The four shares of a texel.
fn texel(pyramid: &Pyramid, level: usize, at: usize) -> [f64; 4] {
    std::array::from_fn(|c| f64::from(channel(pyramid, level, c)[at]))
}

fn near(found: [f64; 4], expected: [f64; 4]) {
    for (found, ideal) in found.into_iter().zip(expected) {
        assert!(
            (found - ideal).abs() <= CODE,
            "{found:?} is not {expected:?}"
        );
    }
}

#[test]
fn the_upper_medium_covers_the_lower_and_the_order_decides() {
    let folder = folder();
    let half = |i: usize| if i % 4 >= 2 { 255 } else { 0 };
    let chalk = grey(folder.path(), "chalk.png", [4, 2], |_| 255);
    let gouache = grey(folder.path(), "gouache.png", [4, 2], half);
    let over = first(&[layer(&chalk, [Particles(0)]), layer(&gouache, [Body])]);
    assert_eq!(texel(&over, 0, 0), [0.0, 0.0, 1.0, 0.0]);
    assert_eq!(texel(&over, 0, 3), [0.0, 1.0, 0.0, 0.0]);
    let under = first(&[layer(&gouache, [Body]), layer(&chalk, [Particles(0)])]);
    for at in 0..8 {
        assert_eq!(texel(&under, 0, at), [0.0, 0.0, 1.0, 0.0]);
    }
}

#[test]
fn soft_coverage_lets_the_rest_of_what_lies_below_through() {
    let folder = folder();
    let chalk = grey(folder.path(), "chalk.png", [1, 1], |_| 128);
    let wash = grey(folder.path(), "wash.png", [1, 1], |_| 153);
    let shares = first(&[layer(&chalk, [Particles(1)]), layer(&wash, [Film])]);
    let (c, w) = (128.0 / 255.0, 153.0 / 255.0);
    near(texel(&shares, 0, 0), [w, 0.0, 0.0, c * (1.0 - w)]);
    let swapped = first(&[layer(&wash, [Film]), layer(&chalk, [Particles(1)])]);
    near(texel(&swapped, 0, 0), [w * (1.0 - c), 0.0, 0.0, c]);
}

#[test]
fn a_stylus_weighs_nothing_and_covers_nothing() {
    let folder = folder();
    let chalk = grey(folder.path(), "chalk.png", [1, 1], |_| 200);
    let groove = grey(folder.path(), "groove.png", [1, 1], |_| 255);
    let with = first(&[layer(&chalk, [Particles(0)]), layer(&groove, [Nothing])]);
    assert_eq!(with, first(&[layer(&chalk, [Particles(0)])]));
    let alone = first(&[layer(&groove, [Nothing])]);
    assert_eq!(texel(&alone, 0, 0), [0.0; 4]);
}

#[test]
fn media_of_one_map_lie_side_by_side() {
    let folder = folder();
    let path = folder.path().join("both.png");
    // Together less, and more, than the whole.
    encode::save_png_rgb8(&path, 2, 1, &[[51, 102, 0], [255, 255, 255]], None).expect("written");
    let shares = first(&[layer(&path, [Film, Body, Particles(0)])]);
    near(texel(&shares, 0, 0), [0.2, 0.4, 0.0, 0.0]);
    let third = 1.0 / 3.0;
    near(texel(&shares, 0, 1), [third, third, third, 0.0]);
    let named = MediaLayer {
        path,
        warp: None,
        channels: Legend(vec![([51, 102, 0], Particles(1)), ([9, 9, 9], Film)]),
    };
    let shares = first(&[named]);
    assert_eq!(texel(&shares, 0, 0), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(texel(&shares, 0, 1), [0.0; 4]);
}

#[test]
fn shares_of_both_parts_add_up_to_at_most_one_at_every_level() {
    let folder = folder();
    let mut state = 1_u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let mut layers = Vec::new();
    let slots = [
        [Film, Particles(0), Particles(5)],
        [Body, Particles(1), Particles(3)],
        [Particles(2), Particles(4), Film],
    ];
    let mut weights = Vec::new();
    for (i, slots) in slots.into_iter().enumerate() {
        let path = folder.path().join(format!("{i}.png"));
        let pixels: Vec<[u8; 3]> = (0..19 * 11)
            .map(|_| std::array::from_fn(|_| noise()))
            .collect();
        encode::save_png_rgb8(&path, 19, 11, &pixels, None).expect("written");
        layers.push(layer(&path, slots));
        weights.push((slots, pixels));
    }
    let more = maps::load_matter(&layers, MatterPart::More).expect("read");
    let first = first(&layers);
    for level in 0..first.levels.len() {
        for at in 0..channel(&first, level, 0).len() {
            let sum: f64 = [&first, &more]
                .into_iter()
                .flat_map(|part| texel(part, level, at))
                .sum();
            assert!(sum <= 1.0 + 1e-6, "level {level}: {sum}");
        }
    }
    for part in [&first, &more] {
        let (full, last) = (&part, part.levels.len() - 1);
        for c in 0..4 {
            let (fine, coarse) = (mean(&channel(full, 0, c)), mean(&channel(full, last, c)));
            assert!((fine - coarse).abs() < CODE, "channel {c}: {fine} {coarse}");
        }
    }
    // Every texel by itself, in f64.
    for at in 0..19 * 11 {
        let mut expected = [0.0; 8];
        let mut open = 1.0;
        for (slots, pixels) in weights.iter().rev() {
            let weight = pixels[at].map(|v| f64::from(v) / 255.0);
            let covered: f64 = weight.iter().sum();
            for (slot, weight) in slots.iter().zip(weight) {
                let slot = match slot {
                    Film => 0,
                    Body => 1,
                    Particles(number) => 2 + number,
                    Nothing => unreachable!("none here"),
                };
                expected[slot] += open * weight / covered.max(1.0);
            }
            open *= 1.0 - covered.min(1.0);
        }
        let [a, b] = [[0, 1, 2, 3], [4, 5, 6, 7]].map(|slots| slots.map(|i| expected[i]));
        near(texel(&first, 0, at), a);
        near(texel(&more, 0, at), b);
    }
}

#[test]
fn maps_of_different_sizes_are_refused_in_words() {
    let folder = folder();
    let one = grey(folder.path(), "one.png", [2, 1], |_| 1);
    let other = grey(folder.path(), "other.png", [1, 2], |_| 1);
    let error = maps::load_matter(
        &[layer(&one, [Film]), layer(&other, [Body])],
        MatterPart::First,
    )
    .expect_err("two sizes")
    .to_string();
    assert!(
        error.ends_with(
            "other.png: is 1 × 2 pixels where the media map below it has 2 × 1; bring all maps of \
             one side to one size"
        ),
        "{error}"
    );
    let error = maps::load_matter(&[layer(&one, [Film, Body])], MatterPart::First)
        .expect_err("one channel")
        .to_string();
    assert!(
        error.contains("one.png: has 1 channels for 2 media"),
        "{error}"
    );
}

#[test]
fn roughness_is_the_mean_of_what_shows() {
    let folder = folder();
    let steps = |i: usize| [0, 128, 255][i];
    let chalk = grey(folder.path(), "chalk.png", [3, 1], steps);
    let ink = grey(folder.path(), "ink.png", [3, 1], |_| 64);
    let groove = grey(folder.path(), "groove.png", [3, 1], |_| 255);
    let chalk = layer(&chalk, [Some(0.9)]);
    let ink = layer(&ink, [Some(0.35)]);
    let groove = layer(&groove, [None]);
    const PAPER: f64 = 0.6;
    let alphas = |layers: &[MediaLayer<Option<f64>>]| {
        let map = maps::load_roughness_of_matter(layers, PAPER).expect("read");
        assert_eq!(map.channels, 1);
        channel(&map, 0, 0)
    };
    let (w, inks) = (64.0 / 255.0, 0.35);
    for (i, found) in alphas(&[chalk.clone(), ink.clone(), groove.clone()])
        .into_iter()
        .enumerate()
    {
        let c = steps(i) as f64 / 255.0;
        let below = c * 0.9 + (1.0 - c) * PAPER;
        let expected = w * inks + (1.0 - w) * below;
        assert!(
            (f64::from(found) - expected).abs() < CODE,
            "{found} {expected}"
        );
    }
    // Under full chalk nothing of the ink shows.
    let swapped = alphas(&[ink, chalk]);
    assert!((f64::from(swapped[2]) - 0.9).abs() < CODE, "{swapped:?}");
    for alpha in alphas(&[groove]) {
        assert!((f64::from(alpha) - PAPER).abs() < CODE, "{alpha}");
    }
}
