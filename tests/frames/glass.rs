//! A real leaf as if it were glass: placed by what `recto register` proposes, and judged in the
//! pictures by a correlation that knows nothing of the points.

use std::{path::Path, process::Command, sync::OnceLock};

use recto::{
    manifest::exhibit::{Comparison, Scene},
    optics::tier::Tier,
    shot::Darkroom,
};

use crate::{
    room::{Fixture, darkroom, picture},
    show_through::{Page, SHRINK, best_shift},
    support::data,
};

/// What the scans' 400 dpi say.
const MM_PER_PX: f64 = 25.4 / 400.0;
const SCAN_PX: [f64; 2] = [2417.0, 3522.0];
/// The bound on how far both sides may lie from each other.
const WITHIN_MM: f64 = 0.5;
/// Of this height over all shifts a peak is no chance: the wrong pair's are at 5 at most.
const LEAST_Z: f64 = 7.0;
/// Side of the patches that are correlated, in reduced pixels.
const SIDE: usize = 600 / SHRINK as usize;
/// Corner of the text, in reduced pixels, and how many patches it has each way.
const TEXT: [usize; 2] = [70, 60];
const PATCHES: [usize; 2] = [3, 5];

/// Recto and verso of the leaf.
const OWN: [&str; 2] = ["it820_3r_f11.jpg", "it820_3v_f12.jpg"];

/// In pixels of the verso's picture, and in mm on the verso.
type Point = ([f64; 2], [f64; 2]);

/// Recto and verso by their place in the manuscript, as one sheet.
fn leaf(root: &Path, [recto, verso]: [&str; 2], points: &[Point]) -> Fixture {
    let [width, height] = SCAN_PX.map(|px| px * MM_PER_PX);
    let points: Vec<String> = points
        .iter()
        .map(|(picture, mm)| format!("{{ picture = {picture:?}, sheet_mm = {mm:?} }}"))
        .collect();
    let points = match points[..] {
        [] => String::new(),
        _ => format!("control_points = [{}]\n", points.join(", ")),
    };
    let manifest = format!(
        "[[drawing]]\nid = \"leaf\"\nsize_mm = [{width}, {height}]\nrecto.albedo = \"recto.jpg\"\n\
         [drawing.verso]\nalbedo = \"verso.jpg\"\n{points}\
         [[lamp]]\nid = \"above\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
         elevation_deg = 90\nazimuth_deg = 0\n\
         [[scene]]\nid = \"glass\"\n\
         compare = {{ mode = \"glass\", of = [\"side:recto\", \"side:verso\"] }}\n\
         camera = {{ width_mm = {width} }}\n"
    );
    Fixture::new(&manifest, |folder| {
        for (scan, name) in [(recto, "recto.jpg"), (verso, "verso.jpg")] {
            std::fs::copy(root.join(scan), folder.join(name)).expect("the scan");
        }
    })
}

/// What `recto register` proposes for the verso: points, or the words and the code it ends with.
fn proposed(leaf: &Fixture) -> Result<Vec<Point>, (String, Option<i32>)> {
    let output = Command::new(env!("CARGO_BIN_EXE_recto"))
        .arg("register")
        .arg(leaf.folder.path())
        .output()
        .expect("the program");
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err((words, output.status.code()));
    }
    let text = String::from_utf8(output.stdout).expect("a table");
    let table: toml::Table = text.parse().expect("a table");
    let pair = |value: &toml::Value| {
        let numbers = value.as_array().expect("two numbers");
        [0, 1].map(|i| numbers[i].as_float().expect("a number"))
    };
    let points = table["control_points"].as_array().expect("points");
    let point = |point: &toml::Value| (pair(&point["picture"]), pair(&point["sheet_mm"]));
    Ok(points.iter().map(point).collect())
}

/// What is proposed for the leaf's own verso; looked for once.
fn own_points(root: &Path) -> Vec<Point> {
    static POINTS: OnceLock<Vec<Point>> = OnceLock::new();
    let found = POINTS.get_or_init(|| {
        proposed(&leaf(root, OWN, &[])).unwrap_or_else(|(words, _)| panic!("{words}"))
    });
    found.clone()
}

/// Of every patch of the text, row by row: how far its residue of the verso's ink stands out, and
/// how far from the verso it lies, in mm of the glass picture.
fn judged(room: &mut Darkroom, leaf: &Fixture) -> Vec<(f64, [f64; 2])> {
    let exhibit = leaf.exhibit();
    let scene = exhibit.scene("glass").expect("a scene").1;
    let size = SCAN_PX.map(|px| (px / f64::from(SHRINK)) as u32);
    // Each side alone, where the glass puts it.
    let mut page = |at: f64| {
        let compare = scene.compare.clone().expect("a comparison");
        let scene = Scene {
            compare: Some(Comparison { at, ..compare }),
            ..scene.clone()
        };
        let frame = picture(room, &exhibit, &scene, Tier::Lambert, size);
        let green: Vec<f32> = frame.pixels.iter().map(|pixel| pixel[1]).collect();
        Page::new(frame.width as usize, frame.height as usize, &green, false)
    };
    let (recto, verso) = (page(0.0), page(1.0));
    (0..PATCHES[0] * PATCHES[1])
        .map(|i| {
            let [left, top] = [i % PATCHES[0], i / PATCHES[0]].map(|k| k * SIDE);
            let (z, shift) = best_shift(&recto, &verso, TEXT[0] + left, TEXT[1] + top);
            (z, shift.map(|px| px * MM_PER_PX))
        })
        .collect()
}

/// Whether a patch is one of those whose own points are left out, as the dark fields of a board.
fn is_dark(column: usize, row: usize) -> bool {
    (column + row).is_multiple_of(2)
}

/// The patch that a place of the recto, in mm, lies in or nearest to.
fn patch_at(recto_mm: [f64; 2]) -> [usize; 2] {
    let reduced = MM_PER_PX * f64::from(SHRINK);
    [0, 1].map(|i| {
        let from_corner = recto_mm[i] / reduced - TEXT[i] as f64;
        let patch = (from_corner / SIDE as f64).floor();
        (patch.max(0.0) as usize).min(PATCHES[i] - 1)
    })
}

/// Distances in mm of the patches that stand out.
fn distances(judged: &[(f64, [f64; 2])]) -> Vec<f64> {
    let found = judged.iter().filter(|(z, _)| *z > LEAST_Z);
    found.map(|(_, [dx, dy])| dx.hypot(*dy)).collect()
}

fn largest(distances: &[f64]) -> f64 {
    distances.iter().copied().fold(0.0, f64::max)
}

#[test]
fn through_glass_the_verso_s_ink_lies_on_its_own_residue() {
    let Some(root) = data(crate::test_name!(), "bnf_recto_verso") else {
        return;
    };
    let scans = OWN;
    let mut room = darkroom(1);
    let points = own_points(&root);
    let placed = judged(&mut room, &leaf(&root, scans, &points));
    let off = distances(&placed);
    // All 15 stood out when this was written, and lay within 0.10 mm.
    assert!(off.len() >= 12, "{placed:?}");
    assert!(largest(&off) < WITHIN_MM, "{off:?}");

    // At places whose own points had no say.
    let width = SCAN_PX[0] * MM_PER_PX;
    let held_out: Vec<Point> = points
        .iter()
        .filter(|(_, [x, y])| {
            let [column, row] = patch_at([width - x, *y]);
            !is_dark(column, row)
        })
        .copied()
        .collect();
    assert!(held_out.len() >= 10 && held_out.len() + 10 <= points.len());
    let placed = judged(&mut room, &leaf(&root, scans, &held_out));
    let dark: Vec<_> = (0..placed.len())
        .filter(|i| is_dark(i % PATCHES[0], i / PATCHES[0]))
        .map(|i| placed[i])
        .collect();
    let off = distances(&dark);
    assert!(off.len() >= 6, "{dark:?}");
    assert!(largest(&off) < WITHIN_MM, "{off:?}");

    // The judge sees sides that are not in register, and by how much.
    let moved: Vec<Point> = points
        .iter()
        .map(|(picture, [x, y])| (*picture, [x + 0.8, *y]))
        .collect();
    let off = distances(&judged(&mut room, &leaf(&root, scans, &moved)));
    assert!(
        off.len() >= 12 && off.iter().all(|mm| (WITHIN_MM..1.1).contains(mm)),
        "{off:?}"
    );
    let off = distances(&judged(&mut room, &leaf(&root, scans, &[])));
    assert!(off.len() >= 6 && off.iter().all(|mm| *mm > 5.0), "{off:?}");
}

#[test]
fn a_stranger_s_verso_is_refused_and_lies_on_nothing() {
    let Some(root) = data(crate::test_name!(), "bnf_recto_verso") else {
        return;
    };
    let scans = ["it820_3r_f11.jpg", "it820_2v_f10.jpg"];
    let (words, code) = proposed(&leaf(&root, scans, &[])).expect_err("another leaf");
    assert_eq!(code, Some(1), "{words}");
    assert!(
        words.contains("recto.jpg and") && words.contains("do not match"),
        "{words}"
    );
    // Nor does the judge find anything, even where the leaf's own verso would lie.
    let points = own_points(&root);
    let judged = judged(&mut darkroom(1), &leaf(&root, scans, &points));
    assert!(distances(&judged).is_empty(), "{judged:?}");
}
