//! The sheet on a light table.

use recto::manifest::Exhibit;

use super::{
    made::{HEIGHT, WIDTH, clear, lies, swatches},
    materials::{pixels, prepared},
};

/// RMS error of what paper passes over the mean, where no ink hides it.
const CLEAR: f64 = 0.02;
/// Of the thickness.
const THICKNESS: f64 = 0.05;

/// RMS error under paper, ink, wash and chalk, where what lies there leaves light enough.
fn errors(path: &std::path::Path) -> [f64; 4] {
    let found = pixels(path);
    assert_eq!(found.len(), WIDTH * HEIGHT);
    let of_all =
        |of: &dyn Fn(usize) -> f64| (0..found.len()).map(of).sum::<f64>() / found.len() as f64;
    let mean = of_all(&|i| f64::from(found[i][0]));
    let truth = of_all(&|i| clear(i % WIDTH, i / WIDTH));
    let mut sums = [[0.0; 2]; 4];
    for (i, pixel) in found.iter().enumerate() {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let off = f64::from(pixel[0]) / mean - clear(x, y) / truth;
        let sum = &mut sums[lies(x, y).class()];
        sum[0] += off * off;
        sum[1] += 1.0;
    }
    sums.map(|[square, count]| f64::sqrt(square / f64::max(count, 1.0)))
}

#[test]
fn laid_lines_and_watermark_come_out_and_ink_does_not() {
    let (stand, out, report) = prepared();
    let told = report.sides[0].matter.transmission.as_ref().expect("a map");
    let found = errors(&out.join("maps/transmission.png"));
    eprintln!("{found:?} {told:?}");
    assert!(found[0] < CLEAR && found[2] < 2.0 * CLEAR, "{found:?}");
    let um = told.thickness_um.expect("a thickness");
    assert!((um / 150.0 - 1.0).abs() < THICKNESS, "{um}");
    let (exhibit, _) = Exhibit::read(out).expect("an exhibit");
    let drawing = &exhibit.drawings[0];
    assert!(drawing.transmission.is_some());
    assert!((drawing.paper.thickness.0 - um).abs() < 1.0);
    // The adversary: the photograph itself, in which the wash is dark.
    let raw = errors(&stand.path("through.png"));
    assert!(raw[2] > 5.0 * found[2], "{raw:?}");
}

#[test]
fn without_the_table_alone_its_level_is_assumed() {
    let (stand, ..) = prepared();
    let out = stand.path("level");
    let text = stand.text() + "[transmitted]\nphotograph = \"through.png\"\n" + &swatches();
    let report = stand.prepare(&text, &out).expect("prepared");
    let told = report.sides[0].matter.transmission.as_ref().expect("a map");
    assert!(told.thickness_um.is_none() && !told.levelled);
    let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("its level assumed"));
}

#[test]
fn what_is_saturated_or_dark_is_refused() {
    let (stand, ..) = prepared();
    let fails = |name: &str| {
        let out = stand.path("refused");
        let text = stand.text() + &format!("[transmitted]\nphotograph = \"{name}\"\n");
        let error = stand.prepare(&text, &out).expect_err("a fault");
        assert!(!out.exists());
        error.to_string()
    };
    let told = fails("bright.png");
    assert!(
        told.contains("bright.png") && told.contains("saturated"),
        "{told}"
    );
    let told = fails("black.png");
    assert!(
        told.contains("black.png") && told.contains("more exposure"),
        "{told}"
    );
}
