//! The photograph given back: the sheet lit and seen as it was photographed, at 45°/0°.

use std::path::Path;

use rayon::prelude::*;
use recto::{
    colour::{delta_e00, lab_from_linear},
    manifest::{
        Exhibit,
        capture::{GIVEN_BACK, SATURATED, TOO_DARK},
    },
    maps::{ColourEncoding, for_each_colour_row},
    optics::tier::Tier,
    sample,
    shot::Darkroom,
};

use crate::{
    room::{Fixture, darkroom, picture},
    support::data,
};

/// ΔE00 over the pixels that can be given back: in the mean, and at the 99.5th percentile.
const MEAN: f64 = 0.5;
const AT_99_5: f64 = 1.0;
/// Edge of a frame in pixels.
const TILE: u32 = 800;
/// A pixel of the photograph on the sheet, mm.
const PIXEL_MM: f64 = 0.1;

/// A flat sheet with this photograph: relief would shade it, which a photograph shows already.
fn sheet(size: [u32; 2], more: &str, fill: impl FnOnce(&Path)) -> Fixture {
    let mm = size.map(|px| f64::from(px) * PIXEL_MM);
    let manifest = format!(
        "[exhibit]\ntitle = \"Photograph\"\n[[drawing]]\nid = \"leaf\"\nsize_mm = {mm:?}\n\
         paper = {{ kind = \"laid\" }}\n{more}\n[[lamp]]\nid = \"copy-stand\"\n\
         kind = \"distant\"\nlux_at_sheet = 1000\nkelvin = 6504\nelevation_deg = 45\n\
         azimuth_deg = 135\n[[scene]]\nid = \"leaf\"\nlamps = [\"copy-stand\"]\n"
    );
    Fixture::new(&manifest, fill)
}

/// ΔE00 of each pixel of the photograph as it is shown, in rows from the top.
fn differences(
    room: &mut Darkroom,
    exhibit: &std::sync::Arc<Exhibit>,
    photograph: &[[f32; 3]],
    tier: Tier,
) -> Vec<f64> {
    let [width, height] = exhibit.drawings[0].recto.albedo.file.size;
    let mut all = vec![f64::NAN; photograph.len()];
    for top in (0..height).step_by(TILE as usize) {
        for left in (0..width).step_by(TILE as usize) {
            let mut scene = exhibit.scenes[0].clone();
            let middle = [left, top].map(|edge| f64::from(edge + TILE / 2) * PIXEL_MM);
            scene.camera.centre_mm = middle.into();
            scene.camera.width_mm = f64::from(TILE) * PIXEL_MM;
            let frame = picture(room, exhibit, &scene, tier, [TILE, TILE]);
            let (right, bottom) = ((left + TILE).min(width), (top + TILE).min(height));
            all.par_chunks_mut(width as usize)
                .enumerate()
                .skip(top as usize)
                .take((bottom - top) as usize)
                .for_each(|(y, row)| {
                    for x in left..right {
                        let at = (y as u32 - top) * TILE + x - left;
                        let shown = frame.pixels[at as usize].map(f64::from);
                        let meant = photograph[y * width as usize + x as usize].map(f64::from);
                        let labs = [shown, meant].map(lab_from_linear);
                        row[x as usize] = delta_e00(labs[0], labs[1]);
                    }
                });
        }
    }
    all
}

fn mean_and_percentile(mut differences: Vec<f64>) -> [f64; 2] {
    let count = differences.len();
    let mean = differences.iter().sum::<f64>() / count as f64;
    let at = (0.995 * (count - 1) as f64).ceil() as usize;
    let (_, at, _) = differences.select_nth_unstable_by(at, f64::total_cmp);
    [mean, *at]
}

/// Renders the sheet of `fixture` at the tiers that promise it; `draft`, which does not, must be
/// found out.
fn round_trip(name: &str, fixture: &Fixture, draft: bool) {
    let exhibit = fixture.exhibit();
    let photographs = exhibit.photographs();
    assert_eq!(photographs.len(), 1);
    let mask = photographs[0].mask().expect("the photograph");
    let map = &exhibit.drawings[0].recto.albedo;
    let mut pixels = Vec::new();
    let row = |_, row: &[[f32; 4]]| pixels.extend(row.iter().map(|&[r, g, b, _]| [r, g, b]));
    for_each_colour_row(&map.file.path, map.encoding, row).expect("the photograph");
    assert_eq!(mask.codes.len(), pixels.len());
    let share = |code| mask.count(code) as f64 / mask.codes.len() as f64;
    eprintln!(
        "{name}: {:.4} too dark, {:.4} saturated",
        share(TOO_DARK),
        share(SATURATED)
    );
    let mut room = darkroom(1);
    let mut judge = |tier| {
        let all = differences(&mut room, &exhibit, &pixels, tier);
        let of = |given: bool| -> Vec<f64> {
            let both = all.iter().zip(&mask.codes);
            both.filter(|(_, code)| (**code == GIVEN_BACK) == given)
                .map(|(difference, _)| *difference)
                .collect()
        };
        let (given, others) = (of(true), of(false));
        let worst = others.iter().copied().fold(0.0, f64::max);
        let [mean, at] = mean_and_percentile(given);
        eprintln!("{name}, {tier}: ΔE00 {mean:.3}, {at:.3} at 99.5%; masked up to {worst:.2}");
        [mean, at]
    };
    for tier in [Tier::Gallery, Tier::Study] {
        let [mean, at] = judge(tier);
        assert!(mean <= MEAN && at <= AT_99_5, "{name}, {tier}: {mean} {at}");
    }
    if draft {
        // Its gloss lies on top of the photograph.
        let [mean, _] = judge(Tier::Draft);
        assert!(mean > MEAN, "{mean}");
    }
}

#[test]
fn a_leaf_is_shown_as_it_was_photographed() {
    let Some(file) = data(crate::test_name!(), "bnf_recto_verso/it820_3r_f11.jpg") else {
        return;
    };
    let fixture = sheet([2417, 3522], "recto.albedo = \"leaf.jpg\"", |folder| {
        std::fs::copy(file, folder.join("leaf.jpg")).expect("the leaf");
    });
    round_trip("BnF it. 820, f. 3", &fixture, false);
}

#[test]
fn the_sample_is_shown_as_it_was_photographed() {
    const DPI: f64 = 72.0;
    let folder = tempfile::tempdir().expect("a folder");
    sample::write_all(folder.path(), DPI, &|_, _| {}).expect("the sample");
    let maps = folder.path().join("landscape/maps/recto");
    let size = recto::maps::probe(&maps.join("albedo.png"))
        .expect("its albedo")
        .size;
    let more = "recto.albedo = { file = \"albedo.png\", encoding = \"srgb\" }\n\
                recto.roughness = \"roughness.png\"";
    let fixture = sheet(size, more, |folder| {
        for name in ["albedo.png", "roughness.png"] {
            std::fs::copy(maps.join(name), folder.join(name)).expect("a map");
        }
    });
    assert_eq!(
        fixture.exhibit().drawings[0].recto.albedo.encoding,
        ColourEncoding::Srgb
    );
    round_trip("the sample", &fixture, true);
}
