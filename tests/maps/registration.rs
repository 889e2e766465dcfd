//! Control points → transforms.

use glam::{DAffine2, DMat2, DVec2, dvec2};
use recto::maps::registration::{ControlPoint, Frame, RegistrationError, affine, similarity};

/// Places on a sheet and where `px_from_mm` puts them in a picture.
fn points(px_from_mm: DAffine2, mm: &[DVec2]) -> Vec<ControlPoint> {
    mm.iter()
        .map(|&mm| (px_from_mm.transform_point2(mm), mm))
        .collect()
}

const PLACES: [DVec2; 4] = [
    dvec2(10.0, 12.0),
    dvec2(270.0, 9.0),
    dvec2(265.0, 180.0),
    dvec2(30.0, 150.0),
];

fn close(a: DAffine2, b: DAffine2) -> bool {
    // Pixels over a sheet of a metre.
    PLACES
        .iter()
        .all(|&mm| (a.transform_point2(mm) - b.transform_point2(mm)).length() < 1e-9)
}

#[test]
fn exact_points_give_the_transform_back() {
    let turned = DAffine2 {
        matrix2: DMat2::from_angle(0.3) * 11.8,
        translation: dvec2(-40.0, 1e4),
    };
    let fit = similarity(&points(turned, &PLACES[..2])).expect("two points");
    assert!(close(fit.px_from_mm, turned));
    assert!(fit.residuals_mm.iter().all(|&r| r < 1e-9));
    let sheared = DAffine2 {
        matrix2: DMat2::from_cols(dvec2(11.0, 1.0), dvec2(-2.0, -13.0)),
        translation: dvec2(5.0, 7.0),
    };
    let fit = affine(&points(sheared, &PLACES[..3])).expect("three points");
    assert!(close(fit.px_from_mm, sheared));
}

#[test]
fn residuals_are_in_millimetres() {
    // Twelve pixels a millimetre, and one point read 6 pixels off.
    let scale = DAffine2::from_scale(DVec2::splat(12.0));
    let mut points = points(scale, &PLACES);
    points[1].0.x += 6.0;
    let fit = similarity(&points).expect("four points");
    let worst = fit.residuals_mm.iter().copied().fold(0.0, f64::max);
    assert!((0.2..0.5).contains(&worst), "{:?}", fit.residuals_mm);
    assert_eq!(fit.residuals_mm[1], worst);
}

#[test]
fn degenerate_points_say_why() {
    let scale = DAffine2::from_scale(DVec2::splat(12.0));
    let too_few = affine(&points(scale, &PLACES[..2])).expect_err("two");
    assert_eq!(
        too_few.to_string(),
        "2 control points are not enough: this needs at least 3"
    );
    let same = similarity(&points(scale, &[PLACES[0]; 3])).expect_err("one place");
    assert!(matches!(same, RegistrationError::OnePlace(_)), "{same}");
    let line: Vec<_> = (0..5)
        .map(|i| dvec2(10.0, 20.0) + f64::from(i) * dvec2(3.0, 1.0))
        .collect();
    let line = affine(&points(scale, &line)).expect_err("a line");
    assert_eq!(line, RegistrationError::OneLine(Frame::Picture));
    let mut nan = points(scale, &PLACES);
    nan[2].1.y = f64::NAN;
    assert_eq!(similarity(&nan), Err(RegistrationError::NotFinite));
    // A square read as its mirror image: no rotation fits better than any other.
    let square = [
        dvec2(0.0, 0.0),
        dvec2(9.0, 0.0),
        dvec2(9.0, 9.0),
        dvec2(0.0, 9.0),
    ];
    let mirrored = points(DAffine2::from_scale(dvec2(-1.0, 1.0)), &square);
    assert_eq!(similarity(&mirrored), Err(RegistrationError::NoSimilarity));
}

const SHEET: DVec2 = dvec2(200.0, 100.0);
/// Pixels of the bent picture in a millimetre.
const PX_PER_MM: f64 = 4.0;
/// How far a plate of 17 × 9 points may leave the bend standing, in mm: half a pixel. (Of half as many
/// each way, 25 mm apart on a wave of 120 mm, 0.3 mm were measured.)
const UNDONE_MM: f64 = 0.125;
/// How far the sheet is bent, in mm.
const BENT_MM: f64 = 3.0;

/// Where a place of the sheet lies in a picture of it bent in a wave, in pixels.
fn bent(mm: DVec2) -> DVec2 {
    let wave = |v: f64| BENT_MM * (v * std::f64::consts::TAU / 120.0).sin();
    (mm + dvec2(wave(mm.y), wave(mm.x) * 0.5) + 6.0) * PX_PER_MM
}

/// A picture of the sheet with dots at `dots` and a grey ground.
fn picture(path: &std::path::Path, dots: &[DVec2]) -> [u32; 2] {
    let size = (SHEET + 12.0) * PX_PER_MM;
    let [width, height] = [size.x as u32, size.y as u32];
    let mut pixels = vec![230_u8; (width * height) as usize];
    for (i, value) in pixels.iter_mut().enumerate() {
        let at = dvec2(
            (i as u32 % width) as f64 + 0.5,
            (i as u32 / width) as f64 + 0.5,
        );
        let near = dots.iter().map(|dot| bent(*dot).distance(at));
        let near = near.fold(f64::INFINITY, f64::min);
        *value = (30.0 + 200.0 * (near / 6.0).min(1.0)) as u8;
    }
    recto::maps::encode::save_png_grey8(path, width, height, &pixels, None).expect("written");
    [width, height]
}

/// Centres of darkness within 3 mm of `mm`, in mm, in a map that covers the sheet.
fn dot_near(map: &recto::maps::Pyramid, uv_from_side: DAffine2, mm: DVec2) -> DVec2 {
    let level = &map.levels[0];
    let size = dvec2(level.width.into(), level.height.into());
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    for y in 0..level.height {
        for x in 0..level.width {
            let uv = dvec2(f64::from(x) + 0.5, f64::from(y) + 0.5) / size;
            let at = uv_from_side.inverse().transform_point2(uv);
            if at.distance(mm) < 3.0 {
                let i = (y * level.width + x) as usize * usize::from(map.channels);
                let dark = 0.79 - f64::from(level.texels.get(i).expect("a texel"));
                if dark > 0.0 {
                    sum += at * dark;
                    weight += dark;
                }
            }
        }
    }
    sum / weight
}

#[test]
fn a_plate_undoes_a_known_bend_where_the_map_is_loaded() {
    use recto::maps::{
        ColourEncoding, Placed, load_colour,
        registration::{FitKind, Fitted},
    };
    let folder = super::folder();
    let path = folder.path().join("bent.png");
    let dots = [
        dvec2(37.0, 31.0),
        dvec2(100.0, 50.0),
        dvec2(163.0, 70.0),
        dvec2(88.0, 88.0),
    ];
    let pixels = picture(&path, &dots);
    let points: Vec<ControlPoint> = (0..153)
        .map(|i| dvec2(f64::from(i % 17) * 12.5, f64::from(i / 17) * 12.5))
        .map(|mm| (bent(mm), mm))
        .collect();
    let worst = |fit: FitKind| {
        let fitted = Fitted::new(&points, Some(fit), pixels, SHEET).expect("a fit");
        let file = Placed {
            path: &path,
            warp: fitted.warp.as_deref(),
        };
        let map = load_colour(file, ColourEncoding::Srgb).expect("read");
        dots.iter()
            .map(|&dot| dot_near(&map, fitted.uv_from_side, dot).distance(dot))
            .fold(0.0, f64::max)
    };
    let undone = worst(FitKind::ThinPlate);
    assert!(undone < UNDONE_MM, "{undone} mm");
    // Without bending it is far off, so this is not trivially passed.
    let straight = worst(FitKind::Affine);
    assert!(straight > 5.0 * UNDONE_MM, "{straight} mm");
}

#[test]
fn a_bent_normal_turns_with_its_picture() {
    use recto::maps::{
        NormalY, Placed, encode, load_normal, normal_coding,
        registration::{FitKind, Fitted},
    };
    let folder = super::folder();
    let path = folder.path().join("normal.png");
    // All of it leans to the right by 30°.
    let lean = [128 + 63, 128, 237];
    encode::save_png_rgb8(&path, 80, 160, &[lean; 80 * 160], None).expect("written");
    // The picture lies on its side: its right is the sheet's up.
    let points: Vec<ControlPoint> = [
        (0.0, 0.0),
        (200.0, 0.0),
        (0.0, 100.0),
        (200.0, 100.0),
        (100.0, 50.0),
    ]
    .map(|(x, y)| (dvec2(80.0 - y * 0.8, x * 0.8), dvec2(x, y)))
    .to_vec();
    let fit = Some(FitKind::ThinPlate);
    let fitted = Fitted::new(&points, fit, [80, 160], SHEET).expect("a fit");
    let file = Placed {
        path: &path,
        warp: fitted.warp.as_deref(),
    };
    let map = load_normal(file, NormalY::Up).expect("read");
    let texels = &map.levels[0].texels;
    let coding = normal_coding(texels);
    let middle = (map.levels[0].width * (map.levels[0].height / 2) + 20) as usize * 4;
    let [x, y] = [0, 1].map(|c| {
        coding.scale * f64::from(texels.get(middle + c).expect("a texel")) + coding.offset
    });
    assert!(x.abs() < 0.02 && (y - 0.5).abs() < 0.02, "{x} {y}");
}
