//! A verso put in its place by the ink that shows through.

use std::fs;

use recto::{
    maps::{ColourEncoding, encode, registration::propose::Mismatch},
    prepare::verso::{Place, between},
};

use super::{folder, interrupted, support::data};
use crate::test_name;

/// The leaves were scanned at 400 dpi.
const MM_PER_PX: f64 = 25.4 / 400.0;

#[test]
fn a_leafs_verso_is_placed_and_another_leafs_is_not() {
    let Some(root) = data(test_name!(), "bnf_recto_verso") else {
        return;
    };
    let scratch = folder();
    let place = |recto: &str, verso: &str| {
        let [recto, verso] = [recto, verso].map(|name| root.join(name));
        between(
            &recto,
            &verso,
            MM_PER_PX,
            ColourEncoding::Embedded,
            scratch.path(),
        )
        .expect("pictures")
    };
    let placed = place("it820_3r_f11.jpg", "it820_3v_f12.jpg");
    let Place::ByInk {
        lines,
        points,
        rms_mm,
        shift_mm,
    } = &placed
    else {
        panic!("{placed:?}");
    };
    eprintln!("{}", placed.told());
    assert!(*points >= 10 && *rms_mm < 0.5, "{placed:?}");
    // The data's README: the mirrored verso lies 115 to 119 pixels beside the recto, of which the
    // difference of their widths is part; and hardly above or below.
    let mm = 117.0 * MM_PER_PX;
    assert!((shift_mm.x.abs() - mm).abs() < 1.5, "{shift_mm} for {mm}");
    assert!(shift_mm.y.abs() < 1.5, "{shift_mm}");
    assert_eq!(lines.matches("sheet_mm").count(), *points);
    let wrong = place("it820_2r_f9.jpg", "it820_3v_f12.jpg");
    let Place::ByEdges(why) = &wrong else {
        panic!("{wrong:?}");
    };
    assert!(matches!(
        why,
        Mismatch::FewPeaks { .. } | Mismatch::NoAgreement { .. }
    ));
    assert!(wrong.told().contains("assumed") && wrong.told().contains("control_points"));
}

#[test]
fn a_verso_without_show_through_keeps_its_edges() {
    let folder = folder();
    let capture = interrupted::capture(folder.path(), 160);
    let text = fs::read_to_string(&capture).expect("text");
    let scan = folder.path().join("scan.png");
    encode::save_png_grey16(&scan, 4, 4, &[30_000; 16], None).expect("written");
    let more = "verso.photographs = [\"r0.png\", \"r1.png\", \"r2.png\", \"r3.png\"]\n\
                relief = { compare = \"scan.png\", compare_range_um = [-100, 100] }\n";
    fs::write(&capture, text + more).expect("written");
    let out = folder.path().join("out");
    let report = interrupted::run(&capture, &out).expect("prepared");
    assert!(
        matches!(report.verso, Some(Place::ByEdges(_))),
        "{:?}",
        report.verso
    );
    let manifest = fs::read_to_string(out.join("exhibit.toml")).expect("text");
    assert!(
        manifest.contains("register = { flip = \"horizontal\" }"),
        "{manifest}"
    );
    // The page says so, and how the shape differs from the other surface, which is flat.
    let page = fs::read_to_string(out.join("report.html")).expect("text");
    super::page::check(&page);
    assert!(page.contains("the edges of its photographs"));
    assert!(page.contains("In comparison with") && page.contains("larger than the sheet"));
    let compared = report.sides[0].compared.as_ref().expect("a comparison");
    let [low, high] = report.sides[0].shape_um;
    assert!(compared.whole.sigma > 0.0 && compared.whole.sigma <= high - low);
    assert!(report.sides[1].compared.is_none());
    assert!(out.join("maps/shape.glb").is_file());
}
