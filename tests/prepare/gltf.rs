//! The sheet's shape as a mesh, and in comparison with another surface.

use std::{fs, path::Path};

use glam::DVec2;
use recto::{
    manifest::{exhibit::Surface, surface::SideSurface},
    maps::{
        self, MapError, encode,
        surface::{Model, load_gltf, save_gltf},
    },
    prepare::{
        capture::{Capture, OtherSurface},
        relief::surface::{self, MESH, compared, heights},
    },
};

use super::{folder, interrupted};

const SIZE_MM: DVec2 = DVec2::new(240.0, 160.0);
const WIDTH: usize = 120;
const HEIGHT: usize = 80;
const MM: f64 = 2.0;
/// The mesh is as near as its triangles may be, and the slope beyond the outermost middles.
const MESH_UM: f64 = 30.0;

/// A sheet that cockles by 3 mm, in µm.
fn shape(at: DVec2) -> f64 {
    1500.0 * (at.x / 45.0).sin() * (at.y / 60.0).cos() + 2.0 * at.x
}

fn middles() -> impl Iterator<Item = DVec2> {
    (0..WIDTH * HEIGHT).map(|i| (DVec2::new((i % WIDTH) as f64, (i / WIDTH) as f64) + 0.5) * MM)
}

fn written(folder: &Path) -> Vec<f64> {
    let um: Vec<f64> = middles().map(shape).collect();
    surface::save(&um, WIDTH, SIZE_MM, folder).expect("written");
    um
}

fn mesh(folder: &Path) -> OtherSurface {
    OtherSurface {
        path: folder.join(MESH),
        range_um: None,
    }
}

#[test]
fn the_mesh_is_the_shape() {
    let folder = folder();
    let um = written(folder.path());
    let path = folder.path().join(MESH);
    let bytes = fs::read(&path).expect("a file");
    // Sound by the letter of the format, with normals and bounds.
    let read = gltf::Gltf::from_slice(&bytes).expect("valid");
    let primitive = read
        .meshes()
        .next()
        .and_then(|mesh| mesh.primitives().next())
        .expect("a mesh");
    let bounds = primitive.bounding_box();
    assert!((f64::from(bounds.max[0]) - SIZE_MM.x / 2.0).abs() < 1e-3);
    assert!((f64::from(bounds.min[1]) + SIZE_MM.y / 2.0).abs() < 1e-3);
    assert!(primitive.get(&gltf::Semantic::Normals).is_some());
    let model = load_gltf(&path).expect("a model");
    let triangles = model.indices.len() / 3;
    eprintln!("{triangles} triangles, {} bytes", bytes.len());
    assert!(triangles <= 2 * 128 * 128);
    // As a manifest takes it.
    let sheet = SideSurface::load(&Surface::Gltf(path.clone()), SIZE_MM).expect("a surface");
    for (position, at) in sheet.positions.iter().zip(&sheet.side) {
        assert!((position.x - (at.x - SIZE_MM.x / 2.0)).abs() < 1e-3);
        assert!((position.y - (SIZE_MM.y / 2.0 - at.y)).abs() < 1e-3);
    }
    assert!(sheet.normals.iter().all(|n| n.z > 0.5));
    let back = heights(&mesh(folder.path()), [WIDTH, HEIGHT]).expect("heights");
    let worst = um
        .iter()
        .zip(&back)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    eprintln!("off by at most {worst:.1} µm");
    assert!(worst < MESH_UM, "{worst}");
    // A flat sheet is two triangles.
    surface::save(&[0.0; 6], 3, SIZE_MM, folder.path()).expect("written");
    assert_eq!(load_gltf(&path).expect("a model").indices.len(), 6);
}

#[test]
fn the_same_bytes_come_of_the_same_shape() {
    let [one, other] = [folder(), folder()];
    for folder in [&one, &other] {
        written(folder.path());
    }
    let bytes = |folder: &tempfile::TempDir| fs::read(folder.path().join(MESH)).expect("a file");
    assert_eq!(bytes(&one), bytes(&other));
}

#[test]
fn another_surface_is_compared_over_patches() {
    let folder = folder();
    written(folder.path());
    // Tilted and shifted, which is no difference, and with a bump of 200 µm on the first patch.
    let bump = |at: DVec2| 200.0 * (-(at - 50.0).length_squared() / (2.0 * 100.0)).exp();
    let um: Vec<f64> = middles()
        .map(|at| shape(at) + bump(at) + 700.0 - 3.0 * at.x + at.y)
        .collect();
    let found = compared(&um, WIDTH, MM, &mesh(folder.path()))
        .expect("a mesh")
        .expect("a comparison");
    let [(large, hundreds), (small, fifties)] = &found.patches[..] else {
        panic!("{found:?}");
    };
    assert_eq!((*large, hundreds.len()), (100.0, 2));
    assert_eq!((*small, fifties.len()), (50.0, 12));
    let expected = {
        let bumps: Vec<f64> = middles().map(bump).collect();
        let mean = bumps.iter().sum::<f64>() / bumps.len() as f64;
        let squares: f64 = bumps.iter().map(|b| (b - mean).powi(2)).sum();
        (squares / bumps.len() as f64).sqrt()
    };
    eprintln!(
        "σ {:.1} of {expected:.1} µm; patches {:.1} and {:.1}",
        found.whole.sigma, hundreds[0].sigma, hundreds[1].sigma
    );
    // A plane takes a little of the bump with it.
    assert!(
        (found.whole.sigma / expected - 1.0).abs() < 0.15,
        "{}",
        found.whole.sigma
    );
    assert!(hundreds[0].sigma > 3.0 * hundreds[1].sigma);
    assert!(hundreds[0].mean > hundreds[1].mean);
    // Without the bump there is no more than the triangles' own.
    let um: Vec<f64> = middles().map(|at| shape(at) - 3.0 * at.x).collect();
    let same = compared(&um, WIDTH, MM, &mesh(folder.path()))
        .expect("a mesh")
        .expect("a comparison");
    assert!(same.whole.sigma < MESH_UM / 2.0, "{}", same.whole.sigma);
}

#[test]
fn a_picture_of_heights_is_a_surface_too() {
    let folder = folder();
    let path = folder.path().join("scan.png");
    let [low, high] = [-2000.0, 2500.0];
    // Twice as fine as what it is compared with.
    let (w, h) = (2 * WIDTH, 2 * HEIGHT);
    let pixels: Vec<u16> = (0..w * h)
        .map(|i| {
            let at = (DVec2::new((i % w) as f64, (i / w) as f64) + 0.5) * MM / 2.0;
            ((shape(at) - low) / (high - low) * 65535.0).round() as u16
        })
        .collect();
    encode::save_png_grey16(&path, w as u32, h as u32, &pixels, None).expect("written");
    let scan = OtherSurface {
        path,
        range_um: Some([low, high]),
    };
    let um: Vec<f64> = middles().map(shape).collect();
    let same = compared(&um, WIDTH, MM, &scan)
        .expect("a picture")
        .expect("a comparison");
    assert!(same.whole.sigma < 1.0, "{}", same.whole.sigma);
}

#[test]
fn holes_and_faults_of_meshes_do_no_harm() {
    let folder = folder();
    let path = folder.path().join("half.glb");
    // Only the left half of the sheet.
    let whole = SideSurface::curled(SIZE_MM, |at| shape(at) / 1000.0);
    let mut model = Model {
        uvs: whole.side.iter().map(|at| *at / SIZE_MM).collect(),
        positions: whole.positions,
        indices: whole.indices,
    };
    model.indices = model
        .indices
        .chunks_exact(3)
        .filter(|t| t.iter().all(|i| model.uvs[*i as usize].x <= 0.5))
        .flatten()
        .copied()
        .collect();
    save_gltf(&path, &model, &whole.normals).expect("written");
    let half = OtherSurface {
        path: path.clone(),
        range_um: None,
    };
    let um: Vec<f64> = middles().map(shape).collect();
    let found = compared(&um, WIDTH, MM, &half)
        .expect("a mesh")
        .expect("a comparison");
    let share = found.whole.count as f64 / um.len() as f64;
    assert!((0.4..0.55).contains(&share), "{share}");
    // What does not hold together is not written.
    model.indices.push(0);
    let error = save_gltf(&path, &model, &whole.normals).expect_err("a torn mesh");
    assert!(matches!(error, MapError::Write { .. }));
    assert!(maps::surface::load_gltf(&folder.path().join("none.glb")).is_err());
}

#[test]
fn another_surface_is_checked_before_any_work() {
    let folder = folder();
    let file = interrupted::capture(folder.path(), 64);
    let text = fs::read_to_string(&file).expect("text");
    written(folder.path());
    fs::write(folder.path().join("torn.glb"), "glTF, but no more").expect("written");
    let parsed = |relief: &str| Capture::parse(&file, &format!("{text}relief = {{ {relief} }}\n"));
    let told = |relief: &str| {
        let faults: Vec<_> = parsed(relief).expect_err("a fault").into_iter().collect();
        assert_eq!(faults.len(), 1, "{relief}: {faults:?}");
        faults[0].to_string()
    };
    let (capture, _) = parsed("compare = \"shape.glb\"").expect("a capture");
    assert_eq!(capture.compare, Some(mesh(folder.path())));
    let (capture, _) =
        parsed("compare = \"r0.png\", compare_range_um = [-5, 10.5]").expect("a capture");
    assert_eq!(
        capture.compare.expect("a picture").range_um,
        Some([-5.0, 10.5])
    );
    assert!(
        parsed("split_mm = 1")
            .expect("a capture")
            .0
            .compare
            .is_none()
    );
    for (relief, words) in [
        ("compare = \"none.glb\"", "none.glb"),
        (
            "compare = \"none.png\", compare_range_um = [0, 1]",
            "none.png",
        ),
        ("compare = \"torn.glb\"", "torn.glb"),
        ("compare = \"r0.png\"", "compare_range_um = [black, white]"),
        (
            "compare = \"r0.png\", compare_range_um = [10, 10]",
            "higher",
        ),
        (
            "compare = \"shape.glb\", compare_range_um = [0, 10]",
            "in mm",
        ),
        ("compare_range_um = [0, 10]", "compare"),
    ] {
        let told = told(relief);
        assert!(told.contains(words), "{relief}: {told}");
    }
}
