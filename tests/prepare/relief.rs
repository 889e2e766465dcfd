//! Relief: split by scale, integrated, and compared with what is known.

use std::path::Path;

use recto::{
    maps::{self, ColourEncoding},
    prepare::{
        capture::Filter,
        relief::{
            compare::{compare, range, remove_plane},
            filter::{gaussian, split},
            integrate::{Perimeter, Slopes, integrate, integrate_level, integrate_robust},
        },
    },
};

use super::support::data;
use crate::test_name;

/// Integrated normals against the displacement that they were made from.
const CORRELATION: f64 = 0.95;
/// RMS of heights over their range, on a surface whose slopes are known.
const HEIGHT: f64 = 0.01;

fn picture(width: usize, height: usize, at: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    (0..width * height)
        .map(|i| at((i % width) as f64, (i / width) as f64))
        .collect()
}

/// Slopes by the surface's derivatives, not by its differences.
fn slopes(width: usize, height: usize, at: impl Fn(f64, f64) -> f64) -> Slopes {
    const STEP: f64 = 1e-3;
    let right = picture(width, height, |x, y| {
        (at(x + STEP, y) - at(x - STEP, y)) / (2.0 * STEP)
    });
    let down = picture(width, height, |x, y| {
        (at(x, y + STEP) - at(x, y - STEP)) / (2.0 * STEP)
    });
    let narrow = |v: Vec<f64>| v.into_iter().map(|v| v as f32).collect();
    Slopes {
        width,
        right: narrow(right),
        down: narrow(down),
    }
}

/// RMS of the difference over the range of `truth`, means taken out.
fn off(found: &[f64], truth: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (a, b) = (mean(found), mean(truth));
    let square: f64 = found
        .iter()
        .zip(truth)
        .map(|(f, t)| (f - a - t + b).powi(2))
        .sum();
    let [low, high] = range(truth, [0.0, 1.0]).expect("heights");
    (square / truth.len() as f64).sqrt() / (high - low)
}

fn hills(x: f64, y: f64) -> f64 {
    12.0 * (x / 31.0).sin() * (y / 19.0).cos() + 0.05 * x - 0.02 * y + 3.0 * ((x + y) / 11.0).sin()
}

#[test]
fn slopes_give_their_surface_back() {
    // Odd, prime and even lengths, none of them square.
    for (width, height) in [(128, 96), (97, 61), (2, 5), (1, 7), (64, 1)] {
        let found = integrate(&slopes(width, height, hills), Perimeter::Free);
        let truth = picture(width, height, hills);
        let rms = off(&found, &truth);
        eprintln!("{width} × {height}: {:.5} % of the range", 100.0 * rms);
        assert!(rms < HEIGHT, "{width} × {height}: {rms}");
    }
    // Half the slopes are another surface.
    let mut wrong = slopes(128, 96, hills);
    wrong.right.iter_mut().for_each(|p| *p *= 0.5);
    let found = integrate(&wrong, Perimeter::Free);
    assert!(off(&found, &picture(128, 96, hills)) > HEIGHT);
}

/// What heights in f32 are off by, RMS over their range: a tenth of a step of a map's 16 bits.
const SINGLE: f64 = 1.5e-6;

#[test]
fn heights_in_single_precision_are_those_in_double() {
    // Grain on waves as long as the sheet, as what is small keeps them at a wide split.
    let (width, height) = (1201, 700);
    let sheet = |x: f64, y: f64| {
        hills(x, y) + 40.0 * (x / 390.0).sin() * (y / 260.0).cos() + 0.2 * (1.9 * x + 2.3 * y).sin()
    };
    let slopes = slopes(width, height, sheet);
    let double: Vec<f64> = integrate_level(slopes.clone(), 50.0);
    let single: Vec<f32> = integrate_level(slopes, 50.0);
    let single: Vec<f64> = single.into_iter().map(f64::from).collect();
    let rms = off(&single, &double);
    eprintln!("{rms:.1e} of the range");
    assert!(rms < SINGLE, "{rms}");
    // Rounded to eleven bits they are not.
    let coarse: Vec<f64> = single
        .iter()
        .map(|h| f64::from(f32::from_bits((*h as f32).to_bits() & !0x1fff)))
        .collect();
    assert!(off(&coarse, &double) > SINGLE);
}

#[test]
fn differences_are_met_exactly() {
    // A surface that is linear between pixels has the slopes of its differences.
    let (width, height) = (45, 38);
    let truth = picture(width, height, |x, y| 0.3 * x - 0.7 * y);
    let found = integrate(
        &Slopes {
            width,
            right: vec![0.3; width * height],
            down: vec![-0.7; width * height],
        },
        Perimeter::Free,
    );
    assert!(off(&found, &truth) < 1e-6);
}

#[test]
fn an_anchored_perimeter_lies_at_zero() {
    let bump = |x: f64, y: f64| {
        let (u, v) = (x / 80.0, y / 60.0);
        100.0 * u * (1.0 - u) * v * (1.0 - v)
    };
    let (width, height) = (81, 61);
    let found = integrate(&slopes(width, height, bump), Perimeter::Anchored);
    let truth = picture(width, height, bump);
    assert!(off(&found, &truth) < 1e-3, "{}", off(&found, &truth));
    for x in 0..width {
        assert_eq!([found[x], found[(height - 1) * width + x]], [0.0; 2]);
    }
    assert_eq!(
        integrate(&slopes(2, 2, bump), Perimeter::Anchored),
        [0.0; 4]
    );
}

#[test]
fn creases_and_wild_slopes_are_borne_by_the_robust_way() {
    let (width, height) = (120, 90);
    // Two folds like a roof, and a step that no slope shows.
    let shape = |x: f64, y: f64| {
        let step = if x > 70.0 && y > 30.0 { 8.0 } else { 0.0 };
        10.0 - 0.25 * (x - 40.0).abs() + step
    };
    let smooth = |x: f64, _: f64| 10.0 - 0.25 * (x - 40.0).abs();
    let mut given = slopes(width, height, smooth);
    for y in (5..80).step_by(7) {
        given.right[y * width + 20] = 6.0;
    }
    let truth = picture(width, height, smooth);
    let plain = off(&integrate(&given, Perimeter::Free), &truth);
    let robust = off(&integrate_robust(&given, 0.02), &truth);
    eprintln!(
        "wild slopes: plain {:.3} %, robust {:.3} %",
        100.0 * plain,
        100.0 * robust
    );
    assert!(robust < HEIGHT && plain > 2.0 * robust, "{plain} {robust}");
    // What no slope shows cannot be found by either.
    let hidden = picture(width, height, shape);
    assert!(off(&integrate_robust(&given, 0.02), &hidden) > HEIGHT);
}

fn values(path: &Path) -> (Vec<[f32; 4]>, usize) {
    let mut pixels = Vec::new();
    let mut width = 0;
    maps::for_each_colour_row(path, ColourEncoding::Linear, |_, row| {
        width = row.len();
        pixels.extend_from_slice(row);
    })
    .expect("a picture");
    (pixels, width)
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        ab += (a - ma) * (b - mb);
        aa += (a - ma).powi(2);
        bb += (b - mb).powi(2);
    }
    ab / (aa * bb).sqrt()
}

/// Of the integrated normals with the displacement, both without their planes.
fn agreement(normal: &Path, displacement: &Path, y_down: bool) -> f64 {
    let (pixels, width) = values(normal);
    let normals: Vec<[f32; 3]> = pixels
        .iter()
        .map(|p| {
            let y = p[1] * 2.0 - 1.0;
            [
                p[0] * 2.0 - 1.0,
                if y_down { -y } else { y },
                p[2] * 2.0 - 1.0,
            ]
        })
        .collect();
    let mut found = integrate(&Slopes::of_normals(&normals, width), Perimeter::Free);
    let mut given: Vec<f64> = values(displacement)
        .0
        .iter()
        .map(|p| f64::from(p[0]))
        .collect();
    remove_plane(&mut found, width).expect("a plane");
    remove_plane(&mut given, width).expect("a plane");
    correlation(&found, &given)
}

#[test]
fn normals_of_paper_give_its_displacement_back() {
    let Some(root) = data(test_name!(), "paper") else {
        return;
    };
    let both = |normal: &str, displacement: &str, y_down| {
        agreement(&root.join(normal), &root.join(displacement), y_down)
    };
    let sheets = [
        (
            "Paper001_1K_Normal.jpg",
            "Paper001_1K_Displacement.jpg",
            false,
        ),
        (
            "Paper003_1K_Normal.jpg",
            "Paper003_1K_Displacement.jpg",
            false,
        ),
        (
            "gl_dx/Paper001_1K-JPG_NormalGL.jpg",
            "gl_dx/Paper001_1K-JPG_Displacement.jpg",
            false,
        ),
        (
            "gl_dx/Paper001_1K-JPG_NormalDX.jpg",
            "gl_dx/Paper001_1K-JPG_Displacement.jpg",
            true,
        ),
    ];
    for (normal, displacement, y_down) in sheets {
        let found = both(normal, displacement, y_down);
        let wrong = both(normal, displacement, !y_down);
        eprintln!("{normal}: {found:.4}, the other convention {wrong:.4}");
        assert!(found >= CORRELATION, "{normal}: {found}");
        assert!(wrong < CORRELATION, "{normal}: {wrong}");
    }
}

fn waves(width: usize, height: usize) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let unit = |p: f64, q: f64| {
        let length = (1.0 + p * p + q * q).sqrt();
        [-p / length, q / length, 1.0 / length].map(|v| v as f32)
    };
    let long = |x: f64| 0.1 * (x / 40.0).cos();
    let short = |y: f64| 0.1 * (y * 1.3).cos();
    let at = |with: bool| {
        (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width) as f64, (i / width) as f64);
                unit(long(x), if with { short(y) } else { 0.0 })
            })
            .collect()
    };
    (at(true), at(false))
}

#[test]
fn long_waves_and_short_ones_are_told_apart() {
    let (width, height) = (300, 200);
    let (both, long) = waves(width, height);
    for filter in [Filter::Gaussian, Filter::Bilateral] {
        let parts = split(both.clone(), width, 8.0, filter);
        let large = parts.large.sampled([width, height]);
        let mut worst = [0.0f32; 2];
        for y in 30..170 {
            for x in 30..270 {
                let i = y * width + x;
                worst[0] = worst[0].max((large[i][0] - long[i][0]).abs());
                worst[1] = worst[1].max(parts.small[i][0].abs());
            }
        }
        eprintln!("{filter:?}: {worst:?}");
        assert!(worst[0] < 0.01 && worst[1] < 0.01, "{filter:?}: {worst:?}");
        // Short waves are in the other part.
        let share = parts.small.iter().map(|n| n[1].abs()).fold(0.0, f32::max);
        assert!(share > 0.08, "{share}");
    }
}

/// What a smaller picture may cost the split.
const SMALLER: f32 = 2e-3;

#[test]
fn wide_filters_on_a_smaller_picture_are_those_on_the_whole() {
    let (width, height) = (401, 283);
    let (both, _) = waves(width, height);
    let whole = gaussian(&both, width, 33.0);
    let found = split(both, width, 33.0, Filter::Gaussian).large;
    assert!(found.step > 1);
    let found = found.sampled([width, height]);
    // Beyond the edge one goes on as the last pixel, and the other as the last square.
    let inner = |i: &usize| (100..300).contains(&(i % width)) && (100..183).contains(&(i / width));
    let off = |c: usize| {
        let each = (0..found.len()).filter(inner);
        each.map(|i| (found[i][c] - whole[i][c]).abs())
            .fold(0.0, f32::max)
    };
    let worst = [off(0), off(1)];
    assert!(worst.iter().all(|off| *off < SMALLER), "{worst:?}");
}

#[test]
fn a_gaussian_of_boxes_has_its_width() {
    for sigma in [0.7, 3.3, 12.0] {
        let (width, height) = (161, 161);
        let mut spot = vec![[0.0; 3]; width * height];
        spot[80 * width + 80] = [1.0, 0.0, 1.0];
        let smooth = gaussian(&spot, width, sigma);
        let (mut sum, mut across, mut down) = (0.0, 0.0, 0.0);
        for (i, v) in smooth.iter().enumerate() {
            let (x, y) = ((i % width) as f64 - 80.0, (i / width) as f64 - 80.0);
            sum += f64::from(v[0]);
            across += f64::from(v[0]) * x * x;
            down += f64::from(v[0]) * y * y;
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        for variance in [across / sum, down / sum] {
            assert!(
                (variance.sqrt() / sigma - 1.0).abs() < 0.01,
                "{sigma}: {}",
                variance.sqrt()
            );
        }
    }
}

#[test]
fn a_crease_is_kept_by_the_bilateral_filter() {
    let (width, height) = (200, 60);
    let side = |x: usize| if x < 100 { -0.35f32 } else { 0.35 };
    let normals: Vec<[f32; 3]> = (0..width * height)
        .map(|i| [side(i % width), 0.0, (1.0f32 - 0.35 * 0.35).sqrt()])
        .collect();
    let error = |filter| {
        let parts = split(normals.clone(), width, 12.0, filter);
        let large = parts.large.sampled([width, height]);
        let each = large.iter().zip(&normals).map(|(a, b)| (a[0] - b[0]).abs());
        each.sum::<f32>() / normals.len() as f32
    };
    let (gaussian, bilateral) = (error(Filter::Gaussian), error(Filter::Bilateral));
    assert!(bilateral < 0.3 * gaussian, "{gaussian} {bilateral}");
}

#[test]
fn surfaces_are_compared_over_the_whole_and_over_patches() {
    // 240 × 160 mm at half a millimetre.
    let (width, height) = (480, 320);
    let a = picture(width, height, hills);
    let shifted = picture(width, height, |x, y| {
        hills(x, y) + 5.0 + 0.01 * x - 0.02 * y
    });
    let same = compare(&a, &shifted, width, 0.5, &[100.0, 50.0]).expect("a comparison");
    assert!(same.whole.sigma < 1e-9 && same.whole.mean.abs() < 1e-9);
    assert_eq!(same.patches[0].1.len(), 2);
    assert_eq!(same.patches[1].1.len(), 12);
    // A dent in one patch is seen there.
    let mut dented = a.clone();
    for y in 0..100 {
        for x in 0..100 {
            dented[y * width + x] -= 1.0;
        }
    }
    dented[200 * width + 300] = f64::NAN;
    let other = compare(&dented, &a, width, 0.5, &[100.0, 50.0]).expect("a comparison");
    let patches = &other.patches[1].1;
    assert!(
        patches[0].mean < -0.5 && patches[11].mean.abs() < 0.2,
        "{patches:?}"
    );
    assert_eq!(other.whole.count, width * height - 1);
    assert!(compare(&[f64::NAN; 4], &[0.0; 4], 2, 1.0, &[]).is_none());
}
