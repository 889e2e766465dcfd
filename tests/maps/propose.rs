//! Two pictures of one sheet → control points, or the verdict that they are none.

use std::path::Path;

use glam::{DAffine2, DVec2, dvec2};
use recto::maps::{
    self, ColourEncoding,
    registration::{
        plate::Plate,
        propose::{Grey, LEAST_Z, Mismatch, Proposal, Proposed, recto_verso, states},
    },
};

use super::{channel, support::data};
use crate::test_name;

/// What the files of the leaves say: 400 dpi.
const LEAF_MM_PER_PX: f64 = 25.4 / 400.0;

/// Twice the shift between recto and verso.
const REACH_MM: f64 = 13.0;

fn leaf(root: &Path, name: &str) -> Grey {
    let map = maps::load_colour(&root.join(name), ColourEncoding::Embedded).expect(name);
    Grey {
        width: map.levels[0].width as usize,
        height: map.levels[0].height as usize,
        values: channel(&map, 0, 1)
            .iter()
            .map(|v| v.max(0.0).sqrt())
            .collect(),
        mm_per_px: LEAF_MM_PER_PX,
    }
}

/// The points of a match and the root mean square of their residuals.
fn matching(proposal: Proposal) -> (Vec<Proposed>, DAffine2, f64) {
    match proposal {
        Proposal::Matches {
            points,
            fit,
            rms_mm,
        } => (points, fit.px_from_mm, rms_mm),
        Proposal::DoesNotMatch { why, points } => panic!("{why}: {points:?}"),
    }
}

/// Why not, and the points that stood out all the same.
fn not_matching(proposal: Proposal) -> (Mismatch, Vec<Proposed>) {
    match proposal {
        Proposal::DoesNotMatch { why, points } => (why, points),
        Proposal::Matches { points, .. } => panic!("it matches in {} points", points.len()),
    }
}

#[test]
fn a_leafs_recto_matches_its_own_verso_only() {
    let Some(root) = data(test_name!(), "bnf_recto_verso") else {
        return;
    };
    let [r2, v2, r3, v3] = [
        "it820_2r_f9.jpg",
        "it820_2v_f10.jpg",
        "it820_3r_f11.jpg",
        "it820_3v_f12.jpg",
    ]
    .map(|name| leaf(&root, name));

    let (points, _, rms_mm) = matching(recto_verso(&r3, &v3, REACH_MM));
    assert!(points.len() >= 30 && rms_mm < 0.2, "{rms_mm} mm");
    // Half a millimetre beyond what the README of the data finds.
    let beyond = 0.5 / LEAF_MM_PER_PX;
    for point in &points {
        let mirrored = dvec2(v3.width as f64 - point.px.x, point.px.y);
        let shift = mirrored - point.mm / LEAF_MM_PER_PX;
        assert!(
            (-119.0 - beyond..=-115.0 + beyond).contains(&shift.x) && shift.y.abs() <= 1.0 + beyond,
            "{point:?} {shift}"
        );
        assert!(point.z >= LEAST_Z);
    }
    // They bend a spline as little as paper bends.
    let control: Vec<_> = points.iter().map(Proposed::control_point).collect();
    let sheet_mm = dvec2(r3.width as f64, r3.height as f64) * LEAF_MM_PER_PX;
    let plate = Plate::fit(&control, sheet_mm, 0.0).expect("a plate");
    assert!(plate.rms_residual_mm().is_some_and(|rms| rms < 0.2));

    let (points, _, rms_mm) = matching(recto_verso(&r2, &v2, REACH_MM));
    assert!(points.len() >= 30 && rms_mm < 0.2, "{rms_mm} mm");

    let (why, points) = not_matching(recto_verso(&r2, &v3, REACH_MM));
    assert!(matches!(why, Mismatch::FewPeaks { .. }), "{why}");
    assert!(points.len() <= 3, "{points:?}");
    // Two rectos share the scanner, the book and the edges of the page, but no drawing.
    not_matching(states(&r2, &r3, REACH_MM));
}

/// Strokes of a pen: dots of ink in mm on a sheet of [`SHEET_MM`].
fn drawing(seed: u64) -> Vec<DVec2> {
    let mut random = Random(seed);
    let mut dots = Vec::new();
    for _ in 0..150 {
        let mut at = dvec2(random.next(), random.next()) * SHEET_MM;
        let mut angle = random.next() * std::f64::consts::TAU;
        for _ in 0..30 {
            dots.push(at);
            angle += random.next() - 0.5;
            at += DVec2::from_angle(angle) * 0.4;
        }
    }
    dots
}

const SHEET_MM: DVec2 = dvec2(100.0, 130.0);
const MM_PER_PX: f64 = 0.2;

/// A small generator (D. Lehmer's, with the multiplier of P. L'Ecuyer, *Math. Comput.* 68 (1999)
/// 249), seeded.
struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(2_862_933_555_777_941_757)
            .wrapping_add(3037);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Paper with noise, and drawings on it: their dots, where they lie, and how dark they are.
fn picture(seed: u64, layers: &[(&[DVec2], DAffine2, f64)]) -> Grey {
    const INK_PX: f64 = 1.5;
    let (width, height) = (
        (SHEET_MM.x / MM_PER_PX) as usize,
        (SHEET_MM.y / MM_PER_PX) as usize,
    );
    let mut random = Random(seed);
    let mut values: Vec<f64> = (0..width * height)
        .map(|_| 0.8 + 0.02 * (random.next() - 0.5))
        .collect();
    for (dots, px_from_mm, depth) in layers {
        let mut ink = vec![0.0_f64; width * height];
        for &dot in *dots {
            let at = px_from_mm.transform_point2(dot);
            for y in (at.y - 5.0).max(0.0) as usize..((at.y + 5.0).max(0.0) as usize).min(height) {
                for x in (at.x - 5.0).max(0.0) as usize..((at.x + 5.0).max(0.0) as usize).min(width)
                {
                    let off = dvec2(x as f64 + 0.5, y as f64 + 0.5).distance_squared(at);
                    let here = (-off / (2.0 * INK_PX * INK_PX)).exp();
                    ink[y * width + x] = ink[y * width + x].max(here);
                }
            }
        }
        for (v, ink) in values.iter_mut().zip(ink) {
            *v -= depth * ink;
        }
    }
    Grey {
        width,
        height,
        values: values.iter().map(|&v| v as f32).collect(),
        mm_per_px: MM_PER_PX,
    }
}

const AS_IS: DAffine2 = DAffine2::from_cols(
    dvec2(1.0 / MM_PER_PX, 0.0),
    dvec2(0.0, 1.0 / MM_PER_PX),
    DVec2::ZERO,
);

/// Turned by 0.4°, a hundredth larger, shifted.
fn moved() -> DAffine2 {
    DAffine2::from_scale_angle_translation(
        DVec2::splat(1.01 / MM_PER_PX),
        0.4_f64.to_radians(),
        dvec2(9.3, -6.6),
    )
}

/// The largest distance between two transforms over the sheet, in mm.
fn apart(a: DAffine2, b: DAffine2) -> f64 {
    [
        dvec2(0.0, 0.0),
        dvec2(1.0, 0.0),
        dvec2(0.0, 1.0),
        DVec2::ONE,
    ]
    .map(|corner| {
        let mm = corner * SHEET_MM;
        a.transform_point2(mm).distance(b.transform_point2(mm)) * MM_PER_PX
    })
    .into_iter()
    .fold(0.0, f64::max)
}

/// Known to be asked for, in mm.
const TRUE_WITHIN_MM: f64 = 0.1;

#[test]
fn a_known_rotation_scale_and_shift_is_found() {
    let dots = drawing(1);
    let first = picture(2, &[(&dots, AS_IS, 0.5)]);
    // A negative depth is light on dark.
    for depth in [0.5, 0.1, -0.15] {
        let second = picture(3, &[(&dots, moved(), depth)]);
        let (points, found, _) = matching(states(&first, &second, 5.0));
        let off = apart(found, moved());
        assert!(off < TRUE_WITHIN_MM, "{off} mm at {depth}");
        assert!(apart(found, AS_IS) > 10.0 * TRUE_WITHIN_MM);
        for point in points {
            let off = moved().transform_point2(point.mm).distance(point.px) * MM_PER_PX;
            assert!(off < 2.0 * TRUE_WITHIN_MM, "{point:?}: {off} mm");
            assert_eq!(point.z.signum(), depth.signum());
        }
    }
}

#[test]
fn pictures_of_two_sheets_are_refused() {
    let [one, other] = [drawing(1), drawing(4)];
    let first = picture(2, &[(&one, AS_IS, 0.5)]);
    let second = picture(3, &[(&other, AS_IS, 0.5)]);
    let (why, _) = not_matching(states(&first, &second, 5.0));
    // Not by a hair: a stroke looks like another here and there.
    assert!(
        matches!(why, Mismatch::FewPeaks { found, needed, .. } if 2 * found < needed),
        "{why}"
    );
}

#[test]
fn ink_shows_through_mirrored_and_dark() {
    let [own, verso] = [drawing(1), drawing(4)];
    let mirror = DAffine2::from_cols(
        dvec2(-1.0, 0.0),
        DVec2::Y,
        dvec2(SHEET_MM.x / MM_PER_PX, 0.0),
    );
    let behind = picture(3, &[(&verso, mirror * moved(), 0.5)]);
    let recto =
        |through: DAffine2, depth: f64| picture(2, &[(&own, AS_IS, 0.5), (&verso, through, depth)]);
    let (_, found, _) = matching(recto_verso(&recto(AS_IS, 0.03), &behind, 5.0));
    let off = apart(found, mirror * moved());
    assert!(off < TRUE_WITHIN_MM, "{off} mm");
    // Not mirrored, lighter than paper, or not there at all.
    for wrong in [
        recto(mirror * AS_IS, 0.03),
        recto(AS_IS, -0.03),
        picture(2, &[(&own, AS_IS, 0.5)]),
    ] {
        not_matching(recto_verso(&wrong, &behind, 5.0));
    }
}
