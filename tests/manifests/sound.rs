//! What sound manifests mean.

use std::path::Path;

use glam::{DVec2, DVec3};
use recto::{
    manifest::{
        BandMix, CompareMode, Exhibit, FlipAxis, LampColour, LampKind, MediaContent, Member,
        OverlayKind, SideName, Source, Surface, check_shape, create, readout::Reading,
    },
    maps::{Rasters, registration::FitKind},
    optics::medium::{Matter, MediumId, Preset},
    units::{Candela, Degrees, Kelvin, Lux, Nits},
};

use super::Folder;

pub const FULL: &str = include_str!("full.toml");
pub const SMALL: &str = "\
[exhibit]
title = { en = \"One sheet\", it = \"Un foglio\" }

[[drawing]]
id = \"sheet\"
size_mm = [200.0, 100.0]
recto.albedo = \"recto.png\"
";

fn read(manifest: &str) -> Exhibit {
    let folder = Folder::with(manifest);
    let (exhibit, warnings) = Exhibit::read(&folder.exhibit).unwrap();
    assert_eq!(warnings, []);
    exhibit
}

fn warnings(manifest: &str) -> Vec<String> {
    let folder = Folder::with(manifest);
    let (_, warnings) = Exhibit::read(&folder.exhibit).unwrap();
    warnings
        .iter()
        .map(|warning| folder.relative(&warning.to_string()))
        .collect()
}

fn close(a: f64, b: f64) {
    assert!((a / b - 1.0).abs() < 1e-9, "{a} is not {b}");
}

#[test]
fn a_picture_and_a_size_are_enough() {
    let exhibit = read(SMALL);
    assert_eq!(exhibit.languages, ["en", "it"]);
    assert_eq!(exhibit.text(&exhibit.title, "it-CH"), Some("Un foglio"));
    let [scene] = &exhibit.scenes[..] else {
        panic!("{:?}", exhibit.scenes)
    };
    assert_eq!(
        (scene.id.as_str(), scene.drawing, scene.side),
        ("sheet", 0, SideName::Recto)
    );
    assert_eq!(scene.camera.centre_mm, DVec2::new(100.0, 50.0));
    assert!(scene.camera.width_mm > 200.0);
    assert_eq!(scene.lamps, [0]);
    // The lamp's colour is the one shown as neutral, and the exposure is the lamp's own: the
    // photograph is shown as it is.
    assert_eq!(
        exhibit.lamps[0].colour,
        LampColour::Temperature(scene.exposure.white)
    );
    assert_eq!(
        (scene.exposure.illuminance, scene.exposure.level),
        (None, 1.0)
    );
    assert_eq!(scene.ambient.illuminance, Lux(0.0));
    let drawing = &exhibit.drawings[0];
    assert_eq!(drawing.recto.albedo.file.size, [20, 10]);
    let uv = drawing.recto.albedo.file.uv_from_side;
    assert_eq!(
        uv.transform_point2(DVec2::new(200.0, 50.0)),
        DVec2::new(1.0, 0.5)
    );
    assert_eq!(drawing.side_in_state(SideName::Verso, None), None);
    assert_eq!(exhibit.not_shown_yet, Vec::<String>::new());
}

#[test]
fn the_manifest_is_found_by_folder_or_by_name() {
    let folder = Folder::with(SMALL);
    std::fs::rename(
        folder.exhibit.join("exhibit.toml"),
        folder.exhibit.join("other.toml"),
    )
    .unwrap();
    let (exhibit, _) = Exhibit::read(&folder.exhibit.join("other.toml")).unwrap();
    assert_eq!(exhibit.folder, folder.exhibit);
    assert!(exhibit.drawings[0].recto.albedo.file.path.is_file());
}

#[test]
fn a_byte_order_mark_is_no_fault() {
    read(&format!("\u{feff}{SMALL}"));
}

#[test]
fn every_key_arrives() {
    let exhibit = read(FULL);
    let sheet = &exhibit.drawings[0];
    assert_eq!(exhibit.languages, ["en", "it", "pt-BR"]);
    assert_eq!(sheet.flip, FlipAxis::Horizontal);
    assert_eq!(sheet.paper.source, Source::Fitted);
    assert!(matches!(&sheet.surface, Surface::Height(map) if map.range_um == [0.0, 4000.0]));
    assert!(
        matches!(&exhibit.drawings[1].surface, Surface::Gltf(path) if path.ends_with("sheet.glb"))
    );
    assert_eq!(
        sheet.recto.height.as_ref().unwrap().file.source,
        Source::Fitted
    );
    assert_eq!(sheet.recto.albedo.file.source, Source::Measured);
    let [first, second] = &sheet.recto.media[..] else {
        panic!("{:?}", sheet.recto.media)
    };
    assert!(matches!(&first.content, MediaContent::Legend(legend) if legend.len() == 2));
    assert!(matches!(&second.content, MediaContent::Weights(media) if media.len() == 1));
    assert!(
        sheet
            .verso
            .as_ref()
            .unwrap()
            .roughness
            .as_ref()
            .unwrap()
            .gloss
    );
    let verso = sheet.verso.as_ref().unwrap().albedo.file.uv_from_side;
    assert!((verso.transform_point2(DVec2::new(100.0, 50.5)) - DVec2::splat(0.5)).length() < 1e-9);
    let kinds: Vec<_> = sheet.overlays.iter().map(|overlay| &overlay.kind).collect();
    assert!(matches!(
        kinds[..],
        [
            OverlayKind::Categorical(_),
            OverlayKind::Continuous { .. },
            OverlayKind::Picture(_)
        ]
    ));
    let river = &sheet.hotspots[0];
    assert_eq!((river.id.as_str(), river.side), ("river", SideName::Recto));
    assert_eq!(river.polygon_mm[2], DVec2::new(40.0, 50.0));
    assert_eq!(exhibit.text(&river.title, "it"), Some("Il fiume"));
    assert_eq!(
        exhibit.text(&river.text, "it"),
        Some("Scorre verso sinistra.")
    );
    assert_eq!(river.scene, Some(0));
    let (_, washes) = exhibit.scene("washes").unwrap();
    assert_eq!(washes.overlays, [(0, 1.0), (2, 0.5)]);
    assert_eq!(washes.exposure.illuminance, Some(Lux(200.0)));
    assert_eq!(washes.exposure.level, 0.9);
    assert_eq!(washes.language.as_deref(), Some("it"));
    let (_, restoration) = exhibit.scene("restoration").unwrap();
    let compare = restoration.compare.as_ref().unwrap();
    assert_eq!(compare.mode, CompareMode::Curtain);
    assert_eq!(
        compare.of,
        [
            Member::State(Some(0)),
            Member::State(Some(1)),
            Member::Side(SideName::Verso),
            Member::Overlay(0),
            Member::Drawing(1)
        ]
    );
    assert_eq!(exhibit.tours[0].stops, [(0, 10.0), (2, 8.5)]);
    assert_eq!(exhibit.maps().count(), 19);
}

#[test]
fn media_have_the_constants_that_the_manifest_gives_and_otherwise_the_presets() {
    let exhibit = read(FULL);
    let medium = |name: &str| exhibit.media.iter().find(|m| m.name == name).unwrap();
    let Matter::Particles(silver) = medium("silver-point").matter else {
        panic!("{:?}", medium("silver-point"))
    };
    assert_eq!(
        (silver.n, silver.k, silver.roughness),
        ([0.1, 0.12, 0.2], [4.2, 3.5, 2.6], 0.4)
    );
    // #60 is 96/255 of the sRGB curve: ((96/255 + .055)/1.055)^2.4 in linear light.
    for albedo in silver.albedo {
        close(albedo, ((96.0 / 255.0 + 0.055) / 1.055_f64).powf(2.4));
    }
    assert_eq!(medium("silver-point").source, Source::Measured);
    let Matter::Film(ink) = medium("iron-gall-ink-of-leonardo").matter else {
        panic!("{:?}", exhibit.media.last())
    };
    assert_eq!((ink.index, ink.depth), (1.48, [1.0, 1.5, 2.0]));
    let Matter::Body(gouache) = medium("white-gouache").matter else {
        panic!("{:?}", medium("white-gouache"))
    };
    assert_eq!(
        (gouache.scattering_per_mm, gouache.thickness_um),
        (500.0, 12.5)
    );
    // What the manifest does not give is the preset's: here the article's.
    for id in MediumId::all() {
        let theirs = id.of_preset(Preset::Isle2021);
        let changed = ["silver-point", "white-gouache"].contains(&id.name());
        assert_eq!(medium(id.name()).matter == theirs.matter, !changed, "{id}");
    }
    let Matter::Film(catalogue) = medium("iron-gall-ink").matter else {
        panic!("{:?}", medium("iron-gall-ink"))
    };
    assert_eq!(
        (catalogue.index, ink.roughness),
        (1.35, catalogue.roughness)
    );
    // Media maps name them by their place.
    let [first, _] = &exhibit.drawings[0].recto.media[..] else {
        panic!("{:?}", exhibit.drawings[0].recto.media)
    };
    let MediaContent::Legend(legend) = &first.content else {
        panic!("{first:?}")
    };
    let named: Vec<&str> = legend
        .iter()
        .map(|(_, medium)| exhibit.media[*medium].name.as_str())
        .collect();
    assert_eq!(named, ["iron-gall-ink", "lead-point"]);
}

#[test]
fn a_papers_constants_are_its_own_then_its_mediums_then_the_catalogues() {
    let own = read(FULL).drawings[0].paper.clone();
    assert_eq!(own.kind, "rag");
    assert_eq!(own.scattering_per_mm, 60.0);
    assert_eq!(
        [own.forward_share, own.g_forward, own.g_backward],
        [0.8, 0.5, -0.2]
    );
    assert_eq!([own.retro, own.sheen, own.anisotropy], [0.1, 0.2, 0.3]);
    assert_eq!(own.anisotropy_angle, Degrees(-45.0));
    let [r, g, b] = own.albedo.unwrap();
    assert!(r > g && g > b);
    let rag = "[[medium]]\nid = \"rag\"\nbased_on = \"laid\"\nthickness_um = 90\n\
               albedo = [0.7, 0.6, 0.5]\nroughness = 0.45\nsource = \"measured\"\n";
    let of_medium = &read(&format!("{SMALL}paper = \"rag\"\n{rag}")).drawings[0].paper;
    assert_eq!(of_medium.thickness.0, 90.0);
    assert_eq!(of_medium.roughness, 0.45);
    assert_eq!(of_medium.albedo, Some([0.7, 0.6, 0.5]));
    assert_eq!(of_medium.source, Source::Measured);
    let bare = &read(SMALL).drawings[0].paper;
    assert_eq!((bare.kind.as_str(), bare.thickness.0), ("laid", 150.0));
    // Estimated from the picture, although the catalogue has one for other uses.
    assert_eq!(bare.albedo, None);
    assert_eq!((bare.index, bare.scattering_per_mm), (1.5, 81.38));
    assert_eq!([bare.retro, bare.sheen, bare.anisotropy], [0.0; 3]);
}

#[test]
fn sound_pictures_pass_and_a_damaged_one_is_named_where_it_is_written() {
    let folder = Folder::with(FULL);
    let (exhibit, _) = Exhibit::read(&folder.exhibit).unwrap();
    // Their one colour is none of the legends'.
    let warnings = exhibit.verify(exhibit.maps()).unwrap();
    let warnings: Vec<String> = warnings
        .iter()
        .map(|warning| folder.relative(&warning.to_string()))
        .collect();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert_eq!(
        warnings[0],
        "exhibit.toml:22:19: warning: drawing[0].recto.albedo.file: found \"recto.png\" with \
         colours that its legend does not name: #c8beaa (200 pixels); allowed: #3b2a1a, #808080; \
         correct the colours or add them to the legend; such pixels count as bare"
    );
    let truncated = std::fs::read(folder.exhibit.join("truncated.png")).unwrap();
    std::fs::write(folder.exhibit.join("small.png"), truncated).unwrap();
    let faults = exhibit.verify(exhibit.maps()).unwrap_err();
    assert_eq!(
        folder.relative(&faults.to_string()),
        "exhibit.toml:50:16: drawing[0].state[0].recto.albedo: found \"small.png\", which is damaged \
         (it ends too early); allowed: a whole file; export or copy it again"
    );
}

#[test]
fn what_is_not_shown_yet_is_named() {
    assert_eq!(
        read(FULL).not_shown_yet,
        ["Drawing \"landscape\": chain_lines_mm of the paper does not change the picture yet."]
    );
}

#[test]
fn a_scene_like_another_takes_over_what_it_does_not_give() {
    let exhibit = read(FULL);
    let (_, washes) = exhibit.scene("washes").unwrap();
    let (_, closer) = exhibit.scene("closer").unwrap();
    assert_eq!(closer.overlays, washes.overlays);
    assert_eq!(closer.lamps, washes.lamps);
    assert_eq!((washes.state, closer.state), (Some(0), None));
    assert_eq!(
        (closer.camera.width_mm, closer.camera.tilt),
        (30.0, Degrees(0.0))
    );
}

#[test]
fn a_state_replaces_maps_and_keeps_the_others() {
    let exhibit = read(FULL);
    let sheet = &exhibit.drawings[0];
    let before = sheet.side_in_state(SideName::Recto, Some(0)).unwrap();
    assert_eq!(before.albedo.file.size, [10, 5]);
    assert_eq!(before.height, sheet.recto.height);
    assert_eq!(
        sheet.side_in_state(SideName::Recto, None).as_ref(),
        Some(&sheet.recto)
    );
}

#[test]
fn lamps_stand_where_their_angles_say() {
    let exhibit = read(FULL);
    let LampKind::Rectangle {
        position_mm,
        aim_mm,
        ..
    } = exhibit.lamps[3].kind
    else {
        panic!()
    };
    let (sin, cos) = 12f64.to_radians().sin_cos();
    assert!((position_mm - DVec3::new(-600.0 * cos, 0.0, 600.0 * sin)).length() < 1e-9);
    assert_eq!(aim_mm, DVec3::ZERO);
    let LampKind::Spot { position_mm, .. } = exhibit.lamps[2].kind else {
        panic!()
    };
    assert!(
        position_mm.y < 0.0,
        "azimuth -90 is the bottom edge: {position_mm}"
    );
    assert_eq!(
        exhibit.lamps[3].colour,
        LampColour::Temperature(Kelvin(3000.0))
    );
}

#[test]
fn photometric_units_become_one() {
    let exhibit = read(FULL);
    let LampKind::Point {
        intensity: Candela(bulb),
        ..
    } = exhibit.lamps[1].kind
    else {
        panic!()
    };
    close(bulb, 400.0 / (4.0 * std::f64::consts::PI));
    // 150 lx from a small source would be L·A = E·d²; this one is nearly small.
    let LampKind::Rectangle {
        luminance: Nits(nits),
        ..
    } = exhibit.lamps[3].kind
    else {
        panic!()
    };
    let small = 150.0 * 0.6 * 0.6 / (0.2 * 0.04);
    assert!(nits > small && nits < 1.05 * small, "{nits} for {small}");
}

#[test]
fn one_control_point_moves_two_turn_and_three_stretch() {
    let points = |points: &str| {
        let exhibit = read(&format!("{SMALL}recto.control_points = [{points}]\n"));
        exhibit.drawings[0].recto.albedo.file.uv_from_side
    };
    let near = |a: DVec2, b: DVec2| assert!((a - b).length() < 1e-9, "{a} is not {b}");
    let moved = points("{ picture = [0, 0], sheet_mm = [10, 20] }");
    near(moved.transform_point2(DVec2::new(210.0, 120.0)), DVec2::ONE);
    let turned = points(
        "{ picture = [20, 10], sheet_mm = [0, 0] }, { picture = [0, 0], sheet_mm = [200, 100] }",
    );
    near(
        turned.transform_point2(DVec2::new(0.0, 100.0)),
        DVec2::new(1.0, 0.0),
    );
    let stretched = points(
        "{ picture = [0, 0], sheet_mm = [0, 0] }, { picture = [20, 0], sheet_mm = [100, 0] }, \
         { picture = [0, 10], sheet_mm = [0, 100] }",
    );
    near(
        stretched.transform_point2(DVec2::new(50.0, 100.0)),
        DVec2::new(0.5, 1.0),
    );
}

/// Corners of the sheet of 200 × 100 mm in a picture of 20 × 10 pixels.
const CORNERS: &str = "{ picture = [0, 0], sheet_mm = [0, 0] }, \
    { picture = [20, 0], sheet_mm = [200, 0] }, { picture = [20, 10], sheet_mm = [200, 100] }, \
    { picture = [0, 10], sheet_mm = [0, 100] }";

#[test]
fn how_well_control_points_agree_is_known() {
    let registered = |more: &str| read(&format!("{SMALL}{more}")).registered;
    assert_eq!(registered(""), []);
    let [turned] = &registered("recto.register = { rotate_deg = 1 }\n")[..] else {
        panic!("one picture")
    };
    assert_eq!((turned.fit, turned.residual), (None, None));

    // The last corner is read 1 pixel, which is 10 mm, too far to the right: an affine fit leaves a
    // quarter of it at each corner, and the three others alone miss it by all of it.
    let points = CORNERS.replace("[0, 10], sheet", "[1, 10], sheet");
    let points = format!("recto.control_points = [{points}]\n");
    let [stretched] = &registered(&points)[..] else {
        panic!("one picture")
    };
    assert_eq!(stretched.fit, Some(FitKind::Affine));
    assert_eq!(stretched.points, 4);
    assert_eq!(stretched.place, "drawing[0].recto");
    let residual = stretched.residual.unwrap();
    assert!((residual.rms_mm - 2.5).abs() < 0.1, "{residual:?}");
    let left_out = stretched.left_out.unwrap();
    assert!((left_out.largest_mm - 10.0).abs() < 0.6, "{left_out:?}");
    let fits = "recto.fit = \"similarity\"\n";
    let similar = &registered(&format!("{fits}{points}"))[0];
    assert_eq!(similar.fit, Some(FitKind::Similarity));
    assert!(similar.residual.unwrap().rms_mm > 1.1 * residual.rms_mm);

    let plate = "recto.fit = \"thin-plate\"\n";
    let exhibit = read(&format!("{SMALL}{plate}{points}"));
    let residual = exhibit.registered[0].residual.unwrap();
    assert!(residual.largest_mm < 1e-6, "{residual:?}");
    // It lies like a picture that just covers the sheet.
    let file = &exhibit.drawings[0].recto.albedo.file;
    assert!(file.warp.is_some());
    let corner = file.uv_from_side.transform_point2(DVec2::new(200.0, 100.0));
    assert!((corner - DVec2::ONE).length() < 1e-9, "{corner}");
}

/// Twelve points of a picture of 20 × 10 pixels that just covers the sheet of 200 × 100 mm, in rows of
/// four, each changed by `change` (its place in the picture and on the sheet).
fn twelve(change: impl Fn(usize, &mut DVec2, &mut DVec2)) -> String {
    let points = (0..12).map(|i| {
        let mut mm = DVec2::new(10.0 + 60.0 * (i % 4) as f64, 10.0 + 40.0 * (i / 4) as f64);
        let mut px = mm / 10.0;
        change(i, &mut px, &mut mm);
        format!(
            "{{ picture = [{}, {}], sheet_mm = [{}, {}] }}",
            px.x, px.y, mm.x, mm.y
        )
    });
    let points: Vec<String> = points.collect();
    format!("{SMALL}recto.control_points = [{}]\n", points.join(", "))
}

#[test]
fn control_points_at_odds_are_warned_of_and_small_errors_are_not() {
    // A pixel is 10 mm here, and nobody reads better than to two of them.
    let odd = |off: f64, fit: &str| {
        let manifest = twelve(|i, _, mm| mm.x += if i == 6 { off } else { 0.1 * (i % 3) as f64 });
        warnings(&(manifest + fit))
    };
    for fit in [
        "",
        "recto.fit = \"similarity\"\n",
        "recto.fit = \"thin-plate\"\n",
    ] {
        assert_eq!(odd(0.0, fit), [""; 0], "{fit}");
        assert_eq!(odd(3.0, fit), [""; 0], "{fit}");
        let [warning] = &odd(25.0, fit)[..] else {
            panic!("{:?}", odd(25.0, fit));
        };
        let place = "drawing[0].recto.control_points[6]: found point 7 ";
        assert!(warning.contains(place), "{warning}");
        assert!(
            warning.contains(" mm from where the others put it; allowed: about 0.")
                && warning.contains("correct its picture or sheet_mm, or remove it"),
            "{warning}"
        );
    }
    // Of few points none can be told to be the wrong one.
    let corners = |px: &str| {
        let points = CORNERS.replace("[0, 10], sheet", px);
        warnings(&format!("{SMALL}recto.control_points = [{points}]\n"))
    };
    assert_eq!(corners("[1, 10], sheet"), [""; 0]);
    let [warning] = &corners("[5, 10], sheet")[..] else {
        panic!("{:?}", corners("[5, 10], sheet"));
    };
    assert!(
        warning.contains("control_points: found points that put each other")
            && warning.contains("allowed: up to 2"),
        "{warning}"
    );
}

#[test]
fn control_points_beside_the_picture_or_the_sheet_are_warned_of() {
    assert_eq!(warnings(&twelve(|_, _, _| ())), [""; 0]);
    // A picture of the sheet on a table.
    let margin = twelve(|_, px, mm| *mm = (*px - 1.0) * 12.0);
    assert_eq!(warnings(&margin), [""; 0]);
    let larger = twelve(|_, px, _| *px *= 1.5);
    let [warning] = &warnings(&larger)[..] else {
        panic!("{:?}", warnings(&larger));
    };
    assert!(
        warning.contains(
            "control_points[3].picture: found points 4, 8, 9, 10, 11 and 1 more, the first outside the \
             picture, at 28.5, 1.5 px; allowed: 0 to 20 px and 0 to 10 px"
        ),
        "{warning}"
    );
    let beside = twelve(|_, _, mm| mm.x += 40.0);
    let [warning] = &warnings(&beside)[..] else {
        panic!("{:?}", warnings(&beside));
    };
    assert!(
        warning.contains(
            "control_points[3].sheet_mm: found points 4, 8, 12, the first beside the sheet, at 230, 10 mm; \
             allowed: about 0 to 200 mm and 0 to 100 mm"
        ),
        "{warning}"
    );
}

#[test]
fn a_state_is_compared_with_none() {
    let compared = |member: &str| {
        let exhibit = read(&format!(
            "{SMALL}[[drawing.state]]\nid = \"before\"\nrecto.albedo = \"grey.png\"\n\
             [[scene]]\nid = \"view\"\nstate = \"before\"\n\
             compare = {{ mode = \"blend\", of = [\"state:before\", \"{member}\"] }}\n"
        ));
        let scene = &exhibit.scenes[0];
        let states: Vec<_> = exhibit.members(scene).iter().map(|m| m.state).collect();
        (scene.compare.as_ref().unwrap().of.clone(), states)
    };
    let (of, states) = compared("state:none");
    assert_eq!(of, [Member::State(Some(0)), Member::State(None)]);
    assert_eq!(states, [Some(0), None]);
    // Another member stays in the scene's own state.
    assert_eq!(compared("side:recto").1, [Some(0), Some(0)]);
}

#[test]
fn a_stack_is_its_bands_and_what_is_made_of_them() {
    // small.png has half as many pixels each way.
    let corners = CORNERS
        .replace("[20,", "[10,")
        .replace(" 10], sheet", " 5], sheet");
    let exhibit = read(&format!(
        "{SMALL}[[drawing.overlay]]\nid = \"map\"\nfile = \"recto.png\"\nkind = \"picture\"\n\
         [[drawing.stack]]\nid = \"light\"\ntitle = {{ en = \"Light\", it = \"Luce\" }}\n\
         bands = [ {{ file = \"grey.png\", wavelength_nm = 850.5 }}, \
         {{ file = \"recto.png\", wavelength_nm = 550 }}, \
         {{ file = \"small.png\", wavelength_nm = 450, control_points = [{corners}], \
         fit = \"thin-plate\" }} ]\n\
         false_colour = [ {{ id = \"ir\", red = {{ \"850.5\" = 1 }}, green = {{ 550 = 0.5, 450 = 0.5 }}, \
         blue = {{ 550 = 1 }} }} ]\n\
         difference = [ {{ id = \"ink\", of = [850.5, 550], full = 0.25 }} ]\n\
         [[scene]]\nid = \"one\"\noverlays = [\"light/450\", {{ id = \"light/ink\", opacity = 0.5 }}]\n\
         compare = {{ mode = \"curtain\", of = [\"band:light/850.5\", \"overlay:light/ir\"] }}\n"
    ));
    let drawing = &exhibit.drawings[0];
    let ids: Vec<&str> = drawing
        .overlays
        .iter()
        .map(|overlay| &*overlay.id)
        .collect();
    let expected = [
        "map",
        "light/850.5",
        "light/550",
        "light/450",
        "light/ir",
        "light/ink",
    ];
    assert_eq!(ids, expected);
    let wavelengths = drawing.stacks[0]
        .bands
        .iter()
        .map(|band| band.wavelength_nm);
    assert_eq!(wavelengths.collect::<Vec<_>>(), [450.0, 550.0, 850.5]);
    let scene = &exhibit.scenes[0];
    assert_eq!(scene.overlays, [(3, 1.0), (5, 0.5)]);
    let members = &scene.compare.as_ref().unwrap().of;
    assert_eq!(members[..], [Member::Overlay(1), Member::Overlay(4)]);
    let OverlayKind::Bands(view) = &drawing.overlays[4].kind else {
        panic!("{:?}", drawing.overlays[4])
    };
    // By rising wavelength: what each gives to red, green and blue.
    let weights = vec![[0.0, 0.5, 0.0], [0.0, 0.5, 1.0], [1.0, 0.0, 0.0]];
    assert_eq!(view.mix, BandMix::Colour(weights));
    let words = "red 850.5 nm, green 0.5 × 450 nm + 0.5 × 550 nm, blue 550 nm";
    assert_eq!(view.words(), words);
    assert!(drawing.overlays[4].kind.is_lit() && !drawing.overlays[5].kind.is_lit());
    let title = &drawing.overlays[3].title;
    assert_eq!(title.in_language("it", &[]), Some("Luce, 450 nm"));
    // One band is registered by points of its own.
    assert_eq!(exhibit.registered[0].place, "drawing[0].stack[0].bands[2]");
    // The picture of the sheet, the overlay, which is the same file, and the bands.
    assert_eq!(drawing.maps().count(), 5);
}

#[test]
fn a_place_has_a_value_in_every_layer() {
    let folder = Folder::with(format!(
        "{SMALL}[[drawing.overlay]]\nid = \"map\"\nfile = \"recto.png\"\nkind = \"categorical\"\n\
         legend = [ {{ colour = \"#d55e00\", label = \"Tear\" }}, \
         {{ id = \"paper\", colour = \"#c8beaa\", label = \"Paper\" }} ]\n\
         [[drawing.overlay]]\nid = \"wet\"\nfile = \"recto.png\"\nkind = \"continuous\"\n\
         unit = \"%\"\nrange = [10, 20]\nregister = {{ offset_mm = [100, 0] }}\n\
         [[drawing.stack]]\nid = \"light\"\nencoding = \"linear\"\n\
         bands = [ {{ file = \"recto.png\", wavelength_nm = 850 }}, \
         {{ file = \"grey.png\", wavelength_nm = 550 }} ]\n\
         difference = [ {{ id = \"ink\", of = [850, 550] }} ]\n"
    ));
    let (exhibit, warnings) = Exhibit::read(&folder.exhibit).unwrap();
    assert_eq!(warnings, []);
    let drawing = &exhibit.drawings[0];
    let at = |x: f64| {
        drawing
            .readings(
                &mut Rasters::default(),
                SideName::Recto,
                DVec2::new(x, 50.0),
            )
            .unwrap()
    };
    let readings = at(150.0);
    let Some(Reading::Category(entry)) = &readings[0].1 else {
        panic!("{readings:?}")
    };
    assert_eq!(entry.name(), "paper");
    let Some(Reading::Quantity { value, unit: "%" }) = readings[1].1 else {
        panic!("{readings:?}")
    };
    // Maps are f32.
    assert!(
        (value - (10.0 + 10.0 * 200.0 / 255.0)).abs() < 1e-5,
        "{value}"
    );
    // The picture is shifted: nothing of it lies here.
    assert_eq!(at(50.0)[1].1, None);
    // The luminance of (200, 190, 170) in linear light, by Rec. 709.
    let light = (0.2126 * 200.0 + 0.7152 * 190.0 + 0.0722 * 170.0) / 255.0;
    let Some(Reading::Difference(difference)) = readings[2].1 else {
        panic!("{readings:?}")
    };
    assert!((difference - light).abs() < 1e-4, "{difference} {light}");
    let curve = drawing.stacks[0]
        .curve(&mut Rasters::default(), DVec2::new(150.0, 50.0))
        .unwrap();
    assert_eq!(
        curve.iter().map(|p| p.wavelength_nm).collect::<Vec<_>>(),
        [550.0, 850.0]
    );
    assert_eq!(curve[0].reflectance, Some(0.0));
    assert!((curve[1].reflectance.unwrap() - light).abs() < 1e-4);
}

#[test]
fn categories_are_chosen_by_id_or_label() {
    let exhibit = read(&format!(
        "{SMALL}[[drawing.overlay]]\nid = \"map\"\nfile = \"recto.png\"\nkind = \"categorical\"\n\
         legend = [ {{ id = \"tear\", colour = \"#d55e00\", label = \"A tear\" }}, \
         {{ colour = \"#0072b2\", label = {{ en = \"Stain\", it = \"Macchia\" }} }}, \
         {{ colour = \"#000000\", label = \"Hole\" }} ]\n\
         [[scene]]\nid = \"all\"\noverlays = [\"map\"]\n\
         [[scene]]\nid = \"some\"\n\
         overlays = [{{ id = \"map\", categories = [\"Macchia\", \"tear\", \"Stain\"] }}]\n"
    ));
    let drawing = &exhibit.drawings[0];
    let shown = |scene: usize| -> Vec<String> {
        let (overlay, _) = &exhibit.scenes[scene].laid(drawing)[0];
        let OverlayKind::Categorical(legend) = &overlay.kind else {
            panic!("{overlay:?}")
        };
        legend.iter().map(|entry| entry.name().to_owned()).collect()
    };
    assert_eq!(shown(0), ["tear", "Stain", "Hole"]);
    assert_eq!(shown(1), ["tear", "Stain"]);
}

#[test]
fn what_is_probably_not_meant_is_a_warning() {
    assert_eq!(
        warnings(&SMALL.replace("[200.0, 100.0]", "[200, 90]")),
        [
            "exhibit.toml:7:16: warning: drawing[0].recto.albedo: found a picture of 20 × 10 pixels, \
          which is 11 % taller in proportion than the sheet of 200 × 90 mm; allowed: the sheet's \
          proportions within 2 %; check size_mm, crop the picture to the sheet, or register it"
        ]
    );
    assert_eq!(
        warnings(&SMALL.replace("[exhibit]", "[exhibit]\nlanguages = [\"en\"]")),
        [
            "exhibit.toml:3:34: warning: exhibit.title.it: found a text in \"it\", which visitors \
          cannot choose; allowed: \"en\"; add this language to exhibit.languages"
        ]
    );
    assert_eq!(
        warnings(&format!(
            "{SMALL}recto.media = {{ file = \"legend.jpg\", legend = {{ \"#000000\" = \"wash\" }} }}\n"
        )),
        [
            "exhibit.toml:8:24: warning: drawing[0].recto.media.file: found a JPEG file, which \
          changes colours at every edge; allowed: colours exactly as in the legend; export it as \
          PNG"
        ]
    );
    assert_eq!(
        warnings(&format!(
            "{SMALL}[[scene]]\nid = \"a\"\ncamera.centre_mm = [300, 0]\n"
        )),
        [
            "exhibit.toml:10:20: warning: scene[0].camera.centre_mm: found a place beside the sheet, \
          300 mm, 0 mm; allowed: 0 to 200 mm and 0 to 100 mm; measure from the left and top edges \
          of the side that is shown"
        ]
    );
    let near = |height: u32| {
        format!(
            "{SMALL}[[lamp]]\nid = \"panel\"\nkind = \"rectangle\"\nnits = 1000\nsize_mm = [350, 200]\n\
             position_mm = [0, 0, {height}]\n"
        )
    };
    assert_eq!(
        warnings(&near(49)),
        [
            "exhibit.toml:8:1: warning: lamp[0]: found a lamp of 350 × 200 mm that comes as near as \
             49 mm to the sheet; allowed: at least 50 mm, a 7th of its longer edge: nearer, the \
             points that it is sampled at are seen; move the lamp away, or make several smaller ones \
             of it"
        ]
    );
    assert_eq!(warnings(&near(51)), [] as [&str; 0]);
}

#[test]
fn a_new_exhibit_is_sound_and_an_old_one_is_kept() {
    let folder = Folder::new();
    let picture = folder.exhibit.join("recto.png");
    let fresh = folder.exhibit.join("a/new \"exhibit\"");
    let (manifest, warnings) = create(&fresh, &picture, [200.0, 100.0]).unwrap();
    assert_eq!(warnings, []);
    let (exhibit, warnings) = Exhibit::read(&manifest).unwrap();
    assert_eq!(
        (warnings.len(), exhibit.drawings[0].size_mm),
        (0, DVec2::new(200.0, 100.0))
    );
    check_shape(&std::fs::read_to_string(&manifest).unwrap()).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As readable for others as any file that is made here.
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        let usual = folder.exhibit.join("usual");
        std::fs::write(&usual, "").unwrap();
        assert_eq!(mode(&manifest), mode(&usual));
        assert_eq!(mode(&fresh.join("recto.png")), mode(&usual));
    }

    let error = create(&fresh, &picture, [200.0, 100.0]).unwrap_err();
    assert!(error.to_string().ends_with(
        "exhibit.toml: an exhibit is there already; choose another folder or remove the file"
    ));
    let error = create(&folder.exhibit, &picture, [f64::NAN, 100.0]).unwrap_err();
    assert!(error.to_string().contains("found nan"), "{error}");
    assert!(!folder.exhibit.join("exhibit.toml").exists());
    let letter = folder.exhibit.join("letter.png");
    assert!(create(&folder.exhibit.join("b"), &letter, [200.0, 100.0]).is_err());
    assert!(!folder.exhibit.join("b").exists());
}

#[test]
fn a_new_exhibit_takes_no_other_picture_of_the_same_name_and_tells_its_warnings() {
    let folder = Folder::new();
    let picture = folder.exhibit.join("recto.png");
    let fresh = folder.exhibit.join("fresh");
    std::fs::create_dir(&fresh).unwrap();
    let taken = fresh.join("recto.png");
    std::fs::copy(folder.exhibit.join("noise.png"), &taken).unwrap();
    let error = create(&fresh, &picture, [200.0, 100.0]).unwrap_err();
    assert!(
        error.to_string().contains("another file than the picture"),
        "{error}"
    );
    assert!(!fresh.join("exhibit.toml").exists());

    // The same picture may be there already.
    std::fs::copy(&picture, &taken).unwrap();
    let (_, warnings) = create(&fresh, &picture, [200.0, 90.0]).unwrap();
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}")
    };
    assert!(warning.found.contains("taller in proportion"), "{warning}");
}

#[test]
fn watts_are_lumens_by_their_efficacy() {
    let place = "position_mm = [0, 0, 500]";
    for kind in [
        "kind = \"point\"",
        "kind = \"spot\"\nhotspot_deg = 10\nfalloff_deg = 20",
        "kind = \"rectangle\"\nsize_mm = [100, 50]",
        "kind = \"disc\"\ndiameter_mm = 80",
    ] {
        let kinds = ["lumen = 3600", "watts = 40\nefficacy_lm_per_w = 90"].map(|strength| {
            read(&format!(
                "{SMALL}[[lamp]]\nid = \"lamp\"\n{kind}\n{place}\n{strength}\n"
            ))
            .lamps[0]
                .kind
                .clone()
        });
        assert_eq!(kinds[0], kinds[1]);
    }
}

#[test]
fn a_spectrum_gives_the_lamp_its_colour_by_name_table_or_file() {
    let lamp = |spectrum: &str| {
        format!(
            "{SMALL}[[lamp]]\nid = \"lamp\"\nkind = \"point\"\nlumen = 100\n\
             position_mm = [0, 0, 500]\nspectrum = {spectrum}\n"
        )
    };
    let xy = |exhibit: &Exhibit| match exhibit.lamps[0].colour {
        LampColour::Chromaticity(xy) => xy,
        LampColour::Temperature(_) => panic!("a spectrum replaces the temperature"),
    };
    let named = read(&lamp("\"LED-B3\""));
    assert_eq!(xy(&named), [0.3756, 0.3723]);
    let table = read(&lamp("{ wavelengths_nm = [360, 800], power = [2, 2] }"));
    let folder = Folder::with(lamp("{ file = \"even.csv\" }"));
    std::fs::write(folder.exhibit.join("even.csv"), "nm,W\n360,2\n800,2\n").unwrap();
    let (file, _) = Exhibit::read(&folder.exhibit).unwrap();
    assert_eq!(xy(&table), xy(&file));
    assert!(xy(&table).iter().all(|v| (v - 1.0 / 3.0).abs() < 1e-3));
    // D65 under the default white is as good as neutral.
    let day = read(&lamp("\"D65\""));
    let amount = day.lighting(&day.scenes[0]).lights[0].amount;
    assert!(
        (amount / amount.y - 1.0).abs().max_element() < 2e-3,
        "{amount}"
    );
}

#[test]
fn a_spectrum_file_is_named_with_its_line() {
    let text = format!(
        "{SMALL}[[lamp]]\nid = \"lamp\"\nkind = \"point\"\nlumen = 100\n\
         position_mm = [0, 0, 500]\nspectrum = {{ file = \"lamp.csv\" }}\n"
    );
    for (table, found) in [
        (
            "nm,W\n400,1\n500,one\n",
            "\"lamp.csv\" (line 3 is not two numbers)",
        ),
        (
            "400,1\n300,1\n",
            "\"lamp.csv\" (a wavelength not above the one before it, at point 2)",
        ),
        ("", "\"lamp.csv\" (0 points)"),
        (
            "400,nan\n500,1\n",
            "\"lamp.csv\" (no number from zero up, at point 1)",
        ),
    ] {
        let folder = Folder::with(text.clone());
        std::fs::write(folder.exhibit.join("lamp.csv"), table).unwrap();
        let faults = Exhibit::read(&folder.exhibit).unwrap_err().to_string();
        assert!(faults.contains(found), "{faults}");
    }
}

#[test]
fn a_photometric_file_is_the_lamps_intensity() {
    let text = format!(
        "{SMALL}[[lamp]]\nid = \"lamp\"\nkind = \"ies\"\nfile = \"lamp.ies\"\n\
         position_mm = [0, 0, 2000]\n"
    );
    let exhibit = read(&text);
    // 500 cd straight ahead, at two metres.
    close(exhibit.lighting(&exhibit.scenes[0]).reference_lux, 125.0);
}

#[test]
fn a_light_table_anchors_the_exposure_by_what_comes_through_a_sheet() {
    let table = "[[lamp]]\nid = \"table\"\nkind = \"light-table\"\nnits = 1500\n";
    let scene = format!("{SMALL}{table}[[scene]]\nid = \"a\"\nlamps = [\"table\"]\n");
    assert_eq!(warnings(&scene), [""; 0]);
    let exhibit = read(&scene);
    let lighting = exhibit.lighting(&exhibit.scenes[0]);
    // It lights no side; through a sheet of transmittance 1/4 it shows 1.
    assert_eq!(lighting.lights, []);
    close(lighting.reference_lux, std::f64::consts::PI * 1500.0 / 4.0);
    close(lighting.light_table.y, 4.0);
    let declared = scene.replace("\nid = \"a\"", "\nid = \"a\"\nexposure = { lux = 100 }");
    let exhibit = read(&declared);
    let lighting = exhibit.lighting(&exhibit.scenes[0]);
    close(lighting.light_table.y, std::f64::consts::PI * 15.0);
}

#[test]
fn a_lamp_at_the_sheet_gives_it_what_was_asked_for() {
    let exhibit = read(&format!(
        "{SMALL}[[lamp]]\nid = \"near\"\nkind = \"point\"\nlux_at_sheet = 500\n\
         position_mm = [0, 0, 2]\n"
    ));
    let lighting = exhibit.lighting(&exhibit.scenes[0]);
    close(lighting.reference_lux, 500.0);
}

#[test]
fn white_and_black_are_the_ground_of_a_legend() {
    let folder = Folder::with(format!(
        "{SMALL}recto.media = {{ file = \"mask.png\", legend = {{ \"#ff0000\" = \"wash\" }} }}\n"
    ));
    let verify = |colours: [[u8; 3]; 4]| {
        let pixels: Vec<[u8; 3]> = (0..200).map(|i| colours[i % 4]).collect();
        let path = folder.exhibit.join("mask.png");
        recto::maps::encode::save_png_rgb8(&path, 20, 10, &pixels, None).unwrap();
        let (exhibit, _) = Exhibit::read(&folder.exhibit).unwrap();
        exhibit.verify(exhibit.maps()).unwrap()
    };
    let (red, ground) = ([255, 0, 0], [255; 3]);
    assert_eq!(verify([red, ground, ground, [0; 3]]), []);
    let [warning] = &verify([red, [254, 0, 0], [254, 0, 0], ground])[..] else {
        panic!()
    };
    assert_eq!(warning.path, "drawing[0].recto.media.file");
    assert!(warning.found.ends_with("#fe0000 (100 pixels)"), "{warning}");
}
