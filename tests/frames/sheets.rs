//! Two sides in register, relief either way up, edges: real leaves and paper.

use std::path::Path;

use recto::{
    manifest::exhibit::SideName,
    maps::encode::{save_png_grey8, save_png_rgb8},
    optics::tier::Tier,
    shot::Picture,
};

use crate::{
    room::{Fixture, darkroom, largest_difference, mean, picture, pixel},
    show_through::{PATCHES, Page, SHRINK, best_shift, correlation},
    support::data,
};

/// A page of the shared scans by its place in the manuscript, copied beside the manifest.
fn leaf(folder: &Path, root: &Path, scan: &str, name: &str) {
    std::fs::copy(root.join(scan), folder.join(name)).expect("the scan");
}

/// The recto of one leaf with the verso of another as one sheet in true size: 400 dpi, and the
/// verso moved by the 117 px that the data's README found.
fn sheet(root: &Path, recto: &str) -> Fixture {
    let mm = |px: f64| px / 400.0 * 25.4;
    let (width, height) = (mm(2417.0), mm(3522.0));
    let left = -mm(117.0);
    let (right, bottom) = (left + mm(2417.0), mm(3559.0));
    let manifest = format!(
        "[exhibit]\ntitle = \"Leaf 3\"\n\
         [[drawing]]\nid = \"leaf\"\nsize_mm = [{width}, {height}]\n\
         recto.albedo = \"recto.jpg\"\n\
         [drawing.verso]\nalbedo = \"verso.jpg\"\ncontrol_points = [\n\
         {{ picture = [0, 0], sheet_mm = [{left}, 0] }},\n\
         {{ picture = [2417, 3559], sheet_mm = [{right}, {bottom}] }},\n]\n\
         [[lamp]]\nid = \"above\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
         elevation_deg = 90\nazimuth_deg = 0\n\
         [[scene]]\nid = \"recto\"\ncamera = {{ centre_mm = [{}, {}], width_mm = {width} }}\n\
         [[scene]]\nid = \"verso\"\nlike = \"recto\"\nside = \"verso\"\n",
        width / 2.0,
        height / 2.0
    );
    Fixture::new(&manifest, |folder| {
        leaf(folder, root, recto, "recto.jpg");
        leaf(folder, root, "it820_3v_f12.jpg", "verso.jpg");
    })
}

fn page(frame: &Picture, mirrored: bool) -> Page {
    let green: Vec<f32> = frame.pixels.iter().map(|pixel| pixel[1]).collect();
    Page::new(
        frame.width as usize,
        frame.height as usize,
        &green,
        mirrored,
    )
}

#[test]
fn turning_the_leaf_lays_the_verso_s_ink_on_its_own_residue() {
    let Some(root) = data(crate::test_name!(), "bnf_recto_verso") else {
        return;
    };
    let mut room = darkroom(1);
    let size = [2417 / SHRINK as u32, 3522 / SHRINK as u32];
    let mut find = |recto: &str| {
        let fixture = sheet(&root, recto);
        let exhibit = fixture.exhibit();
        let mut shoot = |scene: usize| {
            picture(
                &mut room,
                &exhibit,
                &exhibit.scenes[scene],
                Tier::Lambert,
                size,
            )
        };
        let (recto, verso) = (page(&shoot(0), false), page(&shoot(1), true));
        PATCHES.map(|[x, y]| best_shift(&recto, &verso, x, y))
    };
    let own = find("it820_3r_f11.jpg");
    for (z, [dx, dy]) in own {
        // Beyond chance, and within a reduced pixel and a half of where the sheet was turned to.
        assert!(z > 7.0, "{own:?}");
        assert!(
            dx.abs() <= f64::from(SHRINK + SHRINK / 2) && dy.abs() <= f64::from(SHRINK),
            "{own:?}"
        );
    }
    let wrong = find("it820_2r_f9.jpg");
    assert!(wrong.iter().all(|&(z, _)| z < 5.5), "{wrong:?}");
}

/// Paper with one of the two normal maps, raked from the top.
fn crumpled(root: &Path, normal: &str, y: &str) -> Fixture {
    let manifest = format!(
        "[exhibit]\ntitle = \"Paper\"\n[[drawing]]\nid = \"paper\"\nsize_mm = [100, 100]\n\
         [drawing.recto]\nalbedo = \"albedo.jpg\"\n\
         normal = {{ file = \"normal.jpg\", y = \"{y}\" }}\n\
         [[lamp]]\nid = \"top\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
         elevation_deg = 30\nazimuth_deg = 90\n\
         [[scene]]\nid = \"raking\"\ncamera = {{ centre_mm = [50, 50], width_mm = 100 }}\n"
    );
    Fixture::new(&manifest, |folder| {
        leaf(folder, root, "Paper001_1K-JPG_Color.jpg", "albedo.jpg");
        leaf(
            folder,
            root,
            &format!("Paper001_1K-JPG_{normal}.jpg"),
            "normal.jpg",
        );
    })
}

#[test]
fn both_conventions_of_normal_maps_give_one_picture() {
    let Some(root) = data(crate::test_name!(), "paper/gl_dx") else {
        return;
    };
    let mut room = darkroom(1);
    let mut relief = |normal: &str, y: &str| -> Vec<f32> {
        let fixture = crumpled(&root, normal, y);
        let exhibit = fixture.exhibit();
        let frame = picture(
            &mut room,
            &exhibit,
            &exhibit.scenes[0],
            Tier::Gallery,
            [256, 256],
        );
        let green: Vec<f32> = frame.pixels.iter().map(|pixel| pixel[1]).collect();
        let middle = green.iter().sum::<f32>() / green.len() as f32;
        green.iter().map(|value| value - middle).collect()
    };
    let up = relief("NormalGL", "up");
    let down = relief("NormalDX", "down");
    let wrong = [relief("NormalGL", "down"), relief("NormalDX", "up")];
    // Two JPEG files of one surface.
    assert!(correlation(&up, &down) > 0.9, "{}", correlation(&up, &down));
    for wrong in &wrong {
        assert!(correlation(&up, wrong) < 0.5, "{}", correlation(&up, wrong));
    }
}

/// A sheet with a red left half and a green right half, and a white left margin on the verso.
fn marked(register: &str) -> Fixture {
    let manifest = format!(
        "[exhibit]\ntitle = \"Marked\"\n[[drawing]]\nid = \"sheet\"\nsize_mm = [80, 40]\n\
         recto.albedo = \"recto.png\"\n[drawing.verso]\nalbedo = \"verso.png\"\n{register}\n\
         [[scene]]\nid = \"recto\"\ncamera = {{ centre_mm = [40, 20], width_mm = 80 }}\n\
         [[scene]]\nid = \"verso\"\nlike = \"recto\"\nside = \"verso\"\n"
    );
    Fixture::new(&manifest, |folder| {
        let paint = |left: [u8; 3], right: [u8; 3]| -> Vec<[u8; 3]> {
            (0..80 * 40)
                .map(|i| if i % 80 < 40 { left } else { right })
                .collect()
        };
        let recto = paint([200, 20, 20], [20, 200, 20]);
        save_png_rgb8(&folder.join("recto.png"), 80, 40, &recto, None).expect("recto");
        let verso = paint([20, 20, 200], [120, 120, 120]);
        save_png_rgb8(&folder.join("verso.png"), 80, 40, &verso, None).expect("verso");
    })
}

#[test]
fn each_side_is_seen_as_it_is_drawn() {
    let mut room = darkroom(1);
    for register in ["", "register = { flip = \"vertical\" }"] {
        let fixture = marked(register);
        let exhibit = fixture.exhibit();
        let recto = picture(
            &mut room,
            &exhibit,
            &exhibit.scenes[0],
            Tier::Lambert,
            [80, 40],
        );
        let (left, right) = (pixel(&recto, 10, 20), pixel(&recto, 70, 20));
        assert!(
            left[0] > 5.0 * left[1] && right[1] > 5.0 * right[0],
            "{left:?} {right:?}"
        );
        let verso = picture(
            &mut room,
            &exhibit,
            &exhibit.scenes[1],
            Tier::Lambert,
            [80, 40],
        );
        // Not mirrored: the verso's own left is at the left.
        let (left, right) = (pixel(&verso, 10, 20), pixel(&verso, 70, 20));
        assert!(
            left[2] > 5.0 * left[0] && right[2] < 1.2 * right[0],
            "{left:?} {right:?}"
        );
    }
}

#[test]
fn outline_cuts_and_table_shows_through() {
    let manifest = "[exhibit]\ntitle = \"Hole\"\n[[drawing]]\nid = \"sheet\"\nsize_mm = [40, 40]\n\
         outline = \"outline.png\"\nrecto.albedo = \"plain.png\"\nverso.albedo = \"plain.png\"\n\
         [[scene]]\nid = \"recto\"\ncamera = { centre_mm = [20, 20], width_mm = 40 }\n\
         [[scene]]\nid = \"verso\"\nlike = \"recto\"\nside = \"verso\"\n";
    let fixture = Fixture::new(manifest, |folder| {
        save_png_rgb8(&folder.join("plain.png"), 40, 40, &[[200; 3]; 1600], None).expect("plain");
        // A hole in the upper left quarter.
        let outline: Vec<u8> = (0..1600)
            .map(|i| if i % 40 < 20 && i / 40 < 20 { 0 } else { 255 })
            .collect();
        save_png_grey8(&folder.join("outline.png"), 40, 40, &outline, None).expect("outline");
    });
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let table = f64::from(recto::stage::TABLE);
    let recto = picture(
        &mut room,
        &exhibit,
        &exhibit.scenes[0],
        Tier::Gallery,
        [40, 40],
    );
    assert!((mean(&recto, [3, 3], [17, 17]) - table).abs() < 1e-6);
    assert!(mean(&recto, [23, 3], [37, 17]) > 0.3);
    // Seen from behind, the hole is on the other side.
    let verso = picture(
        &mut room,
        &exhibit,
        &exhibit.scenes[1],
        Tier::Gallery,
        [40, 40],
    );
    assert!((mean(&verso, [23, 3], [37, 17]) - table).abs() < 1e-6);
    assert!(mean(&verso, [3, 3], [17, 17]) > 0.3);
}

#[test]
fn a_curled_sheet_keeps_its_middle_and_turns_its_edges_to_the_lamp() {
    let manifest = "[exhibit]\ntitle = \"Curl\"\nexposure = { lux = 500 }\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [100, 100]\nrecto.albedo = \"plain.png\"\n\
         surface = { height = { file = \"curl.png\", range_um = [0, 20000] } }\n\
         [[lamp]]\nid = \"left\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
         elevation_deg = 30\nazimuth_deg = 180\n\
         [[scene]]\nid = \"curl\"\ncamera = { centre_mm = [50, 50], width_mm = 100 }\n";
    let fixture = Fixture::new(manifest, |folder| {
        save_png_rgb8(&folder.join("plain.png"), 64, 64, &[[200; 3]; 4096], None).expect("plain");
        // A trough along y: both edges rise.
        let curl: Vec<u16> = (0..4096)
            .map(|i| {
                let x = (f64::from(i % 64) - 31.5) / 31.5;
                (65535.0 * x * x) as u16
            })
            .collect();
        recto::maps::encode::save_png_grey16(&folder.join("curl.png"), 64, 64, &curl, None)
            .expect("curl");
    });
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let frame = picture(
        &mut room,
        &exhibit,
        &exhibit.scenes[0],
        Tier::Lambert,
        [100, 100],
    );
    // The right edge rises towards the viewer, so it faces the lamp on the left.
    let (left, middle, right) = (
        mean(&frame, [8, 40], [14, 60]),
        mean(&frame, [47, 40], [53, 60]),
        mean(&frame, [86, 40], [92, 60]),
    );
    assert!(right > middle && middle > left, "{left} {middle} {right}");
    // The trough's bottom is flat: E·ρ·cos 60°.
    let albedo = recto::colour::srgb_decode(200.0 / 255.0);
    assert!((middle / (albedo * 0.5) - 1.0).abs() < 0.02, "{middle}");
}

#[test]
fn one_input_gives_the_same_picture_twice() {
    let fixture = marked("");
    let exhibit = fixture.exhibit();
    let mut first = darkroom(16);
    let mut second = darkroom(16);
    let mut scene = exhibit.scenes[0].clone();
    scene.camera.tilt.0 = 40.0;
    scene.camera.distance_mm = Some(200.0);
    let mut shoot = |room: &mut recto::shot::Darkroom, side| {
        scene.side = side;
        picture(room, &exhibit, &scene, Tier::Gallery, [120, 80])
    };
    let a = shoot(&mut first, SideName::Recto);
    let other = shoot(&mut first, SideName::Verso);
    let b = shoot(&mut second, SideName::Recto);
    let again = shoot(&mut first, SideName::Recto);
    assert_eq!(largest_difference(&a, &b), 0.0);
    assert_eq!(largest_difference(&a, &again), 0.0);
    assert!(largest_difference(&a, &other) > 0.1);
}

#[test]
fn a_flat_sheet_ends_where_its_size_says() {
    let fixture = marked("");
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    // A narrow and high picture of a sheet 40 mm high, at a tenth of a millimetre a pixel.
    let mut scene = exhibit.scenes[0].clone();
    scene.camera.width_mm = 2.0;
    let frame = picture(&mut room, &exhibit, &scene, Tier::Lambert, [20, 500]);
    let table = f64::from(recto::stage::TABLE);
    let rows = (0..500)
        .filter(|&y| (pixel(&frame, 10, y)[1] - table).abs() > 0.02)
        .count();
    assert!((399..=401).contains(&rows), "{rows}");
}
