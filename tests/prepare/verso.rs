//! A verso put in its place by the ink that shows through.

use recto::{
    maps::{ColourEncoding, registration::propose::Mismatch},
    prepare::verso::{Place, between},
};

use super::{folder, support::data};
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
