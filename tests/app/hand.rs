//! Wishes → what is shown, without a window.

use std::{collections::BTreeSet, fs, sync::Arc};

use glam::{DVec2, DVec3};
use recto::{
    manifest::{
        exhibit::{CompareMode, Comparison, Exhibit, LampKind, SideName},
        eye::Eye,
    },
    optics::tier::Tier,
    stage::Shown,
    visitor::{
        Hand, Intent,
        hand::{Picture, Retreat},
    },
};

const PICTURE: Picture = Picture {
    aspect: 1.6,
    width_mm: 400.0,
    measured: true,
};
/// Lengths in mm agree when they differ by less.
const NEAR_MM: f64 = 1e-6;

fn exhibit() -> (tempfile::TempDir, Arc<Exhibit>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    let (exhibit, _) = Exhibit::read(folder.path()).expect("a sound exhibit");
    (folder, Arc::new(exhibit))
}

fn hand(scene: &str) -> (tempfile::TempDir, Hand) {
    let (folder, exhibit) = exhibit();
    let (index, _) = exhibit.scene(scene).expect("the scene");
    (
        folder,
        Hand::new(exhibit, index, Tier::Draft, PICTURE, false),
    )
}

/// Lets everything come to rest, and says how long it took in seconds.
fn settle(hand: &mut Hand) -> f64 {
    const FRAME_S: f64 = 1.0 / 60.0;
    const FRAMES: u32 = 600;
    for frame in 0..FRAMES {
        if !hand.is_moving() {
            return f64::from(frame) * FRAME_S;
        }
        hand.advance(FRAME_S, true);
    }
    panic!("it never comes to rest");
}

/// The point of the table under a place of the picture.
fn under(shown: &Shown, at: DVec2) -> DVec3 {
    let size = shown.exhibit.drawing_of(&shown.scene).size_mm;
    let eye = Eye::new(&shown.scene.camera, size);
    eye.table_point(at, shown.aspect).expect("on the table")
}

fn drag(hand: &mut Hand, from: DVec2, to: DVec2) {
    hand.apply(Intent::Take);
    hand.apply(Intent::Drag { from, to });
}

#[test]
fn a_drag_turns_a_whole_sheet_which_comes_back_to_rest() {
    let (_folder, mut hand) = hand("whole");
    let rest = hand.shown();
    drag(&mut hand, DVec2::ZERO, DVec2::new(0.5, 0.0));
    let turned = hand.shown();
    assert_eq!(turned.scene, rest.scene, "the camera stays");
    let normal = turned.pose * DVec3::Z;
    assert!(normal.x > 0.3 && normal.y.abs() < 1e-9, "{normal}");
    assert!(!hand.is_moving(), "a sheet that is held is held still");
    assert!(!turned.both_sides, "its other side stays hidden");
    drag(&mut hand, DVec2::ZERO, DVec2::new(9.0, 9.0));
    assert!(
        (hand.shown().pose * DVec3::Z).z > 0.49,
        "it turns no further"
    );
    hand.apply(Intent::Release);
    settle(&mut hand);
    assert_eq!(hand.shown().pose, rest.pose);
}

#[test]
fn a_drag_moves_a_detail_with_the_hand_and_stays_on_the_sheet() {
    let (_folder, mut hand) = hand("detail");
    let (from, to) = (DVec2::new(0.2, -0.3), DVec2::new(-0.1, 0.4));
    let place = under(&hand.shown(), from);
    drag(&mut hand, from, to);
    let shown = hand.shown();
    assert!((under(&shown, to) - place).length() < NEAR_MM);
    assert_eq!(
        shown.pose,
        shown.exhibit.drawings[0].rest_pose(SideName::Recto)
    );
    drag(&mut hand, DVec2::ZERO, DVec2::new(-90.0, 0.0));
    assert!(hand.shown().scene.camera.centre_mm.x <= 300.0);
}

#[test]
fn zoom_keeps_the_place_under_the_pointer_and_ends_at_the_whole_sheet() {
    let (_folder, mut hand) = hand("detail");
    let at = DVec2::new(0.5, 0.25);
    let before = hand.shown();
    hand.apply(Intent::Zoom { at, factor: 2.0 });
    settle(&mut hand);
    let after = hand.shown();
    assert!((after.scene.camera.width_mm - 30.0).abs() < NEAR_MM);
    assert!((under(&after, at) - under(&before, at)).length() < NEAR_MM);
    hand.apply(Intent::Zoom { at, factor: 1e-3 });
    settle(&mut hand);
    let camera = hand.shown().scene.camera;
    assert!((camera.width_mm - 200.0 * 1.08 * PICTURE.aspect).abs() < NEAR_MM);
    assert!((camera.centre_mm - DVec2::new(150.0, 100.0)).length() < NEAR_MM);
}

#[test]
fn true_size_is_a_millimetre_for_a_millimetre_and_there_is_a_way_back() {
    let (_folder, mut hand) = hand("detail");
    assert_eq!(hand.at_true_size(), None);
    hand.resize(Picture {
        width_mm: 120.0,
        ..PICTURE
    });
    let at = DVec2::ZERO;
    hand.apply(Intent::TrueSize { at });
    settle(&mut hand);
    assert_eq!(hand.shown().scene.camera.width_mm, 120.0);
    assert_eq!(hand.at_true_size(), Some(true));
    hand.apply(Intent::TrueSize { at });
    settle(&mut hand);
    assert!((hand.shown().scene.camera.width_mm - 60.0).abs() < NEAR_MM);
}

#[test]
fn a_flip_keeps_the_place_of_the_sheet_and_waits_for_its_other_side() {
    for (scene, there) in [
        ("detail", DVec2::new(200.0, 80.0)),
        ("page", DVec2::new(100.0, 150.0)),
    ] {
        let (_folder, mut hand) = hand(scene);
        let before = hand.shown();
        hand.apply(Intent::Flip);
        assert!(hand.shown().both_sides);
        hand.advance(10.0, false);
        assert_eq!(hand.shown().pose, before.pose, "not loaded yet");
        let took = settle(&mut hand);
        assert!((0.5..0.8).contains(&took), "{took}");
        let after = hand.shown();
        assert_eq!(after.scene.side, SideName::Verso);
        assert!((after.scene.camera.centre_mm - there).length() < NEAR_MM);
        // The verso lies up: where the recto's z was, there is the table.
        assert!((after.pose * DVec3::Z + DVec3::Z).length() < 1e-9);
        hand.apply(Intent::Flip);
        settle(&mut hand);
        let back = hand.shown();
        assert_eq!(back.scene, before.scene);
        assert!((back.pose * DVec3::X - DVec3::X).length() < 1e-9);
    }
}

#[test]
fn while_it_turns_over_its_near_edge_comes_towards_us_and_its_place_stays_in_view() {
    for (scene, edge) in [("detail", DVec3::X), ("page", -DVec3::Y)] {
        let (_folder, mut hand) = hand(scene);
        let centre = under(&hand.shown(), DVec2::ZERO);
        hand.apply(Intent::Flip);
        for _ in 0..8 {
            hand.advance(0.06, true);
            let shown = hand.shown();
            assert!((shown.pose * edge).z > 0.0);
            let seen = under(&shown, DVec2::ZERO).truncate();
            let place = (shown.pose * centre).truncate();
            assert!((seen - place).length() < NEAR_MM, "{seen} {place}");
        }
    }
}

#[test]
fn the_lamp_follows_the_hand_and_stays_in_the_room() {
    let (_folder, mut hand) = hand("whole");
    let as_read = hand.shown();
    hand.apply(Intent::RaiseLamp(12.0));
    let lamp = hand.lamp().expect("a lamp");
    assert_eq!(lamp.sector(), Some("left"));
    assert_eq!((lamp.elevation_deg, lamp.azimuth_deg), (12.0, 180.0));
    let LampKind::Distant { elevation, .. } = hand.shown().exhibit.lamps[0].kind else {
        panic!("its kind stays");
    };
    assert_eq!(elevation.0, 12.0);
    hand.apply(Intent::MoveLamp(DVec2::new(1.0, 1.0)));
    let lamp = hand.lamp().expect("a lamp");
    assert!(
        lamp.azimuth_deg > 80.0 && lamp.azimuth_deg < 100.0,
        "{lamp:?}"
    );
    hand.apply(Intent::Flip);
    settle(&mut hand);
    assert_eq!(hand.lamp(), Some(lamp), "it stays where it is");
    hand.apply(Intent::Home);
    assert_eq!(hand.shown().scene, as_read.scene);
    assert_eq!(*hand.shown().exhibit, *as_read.exhibit);
}

#[test]
fn states_overlays_and_scenes_go_round() {
    let (_folder, mut hand) = hand("whole");
    let mut states = Vec::new();
    let mut overlays = Vec::new();
    let mut scenes = Vec::new();
    for _ in 0..4 {
        hand.apply(Intent::StepState(1));
        states.push(hand.shown().scene.state);
        hand.apply(Intent::StepOverlay);
        let on = hand.shown().scene.overlays;
        overlays.push(
            on.into_iter()
                .map(|(overlay, _)| overlay)
                .collect::<Vec<_>>(),
        );
    }
    assert_eq!(states, [Some(0), None, Some(0), None]);
    assert_eq!(overlays, [vec![0], vec![1], vec![0, 1], vec![]]);
    for _ in 0..3 {
        hand.apply(Intent::StepScene(-1));
        scenes.push(hand.shown().scene.id);
    }
    assert_eq!(scenes, ["page", "detail", "whole"]);
    hand.apply(Intent::StepOverlay);
    hand.apply(Intent::Opacity(0.1));
    let [(_, opacity)] = hand.shown().scene.overlays[..] else {
        panic!("one overlay");
    };
    assert!((opacity - 0.8).abs() < 1e-9);
    hand.apply(Intent::Flip);
    settle(&mut hand);
    assert!(
        hand.shown().scene.overlays.is_empty(),
        "they are the recto's"
    );
}

#[test]
fn bands_take_their_turns_but_never_lie_over_each_other() {
    let (folder, _) = exhibit();
    let bands = "[[drawing.stack]]\nid = \"light\"\nbands = [ \
        { file = \"paper.png\", wavelength_nm = 550 }, \
        { file = \"paper.png\", wavelength_nm = 850 } ]\n";
    let text = super::MANIFEST.replacen(
        "[[drawing.overlay]]",
        &format!("{bands}[[drawing.overlay]]"),
        1,
    );
    fs::write(folder.path().join("exhibit.toml"), text).expect("the manifest is written");
    let (new, _) = Exhibit::read(folder.path()).expect("it is sound");
    let mut hand = Hand::new(Arc::new(new), 0, Tier::Draft, PICTURE, false);
    let mut overlays = Vec::new();
    for _ in 0..6 {
        hand.apply(Intent::StepOverlay);
        let on = hand.shown().scene.overlays.into_iter();
        overlays.push(on.map(|(overlay, _)| overlay).collect::<Vec<_>>());
    }
    let each = [vec![0], vec![1], vec![2], vec![3]];
    assert_eq!(overlays, [&each[..], &[vec![0, 1], vec![]]].concat());
}

#[test]
fn a_new_version_keeps_the_view_and_takes_what_the_hand_left_alone() {
    let (folder, mut hand) = hand("detail");
    hand.apply(Intent::StepState(1));
    hand.apply(Intent::RaiseLamp(60.0));
    let manifest = folder.path().join("exhibit.toml");
    let text = super::MANIFEST
        .replace("width_mm = 60", "width_mm = 50")
        .replace("id = \"whole\"", "id = \"first\"");
    fs::write(&manifest, text).expect("the manifest is written");
    let (new, _) = Exhibit::read(folder.path()).expect("it is sound");
    hand.replace(Arc::new(new));
    let shown = hand.shown();
    assert_eq!(shown.scene.id, "detail");
    assert_eq!(shown.scene.state, Some(0));
    assert_eq!(shown.scene.camera.width_mm, 50.0);
    assert_eq!(hand.lamp().map(|lamp| lamp.elevation_deg), Some(60.0));
    fs::write(&manifest, super::MANIFEST.replace("detail", "gone")).expect("it is written");
    let (new, _) = Exhibit::read(folder.path()).expect("it is sound");
    hand.replace(Arc::new(new));
    assert_eq!(hand.shown().scene.id, "whole");
}

#[test]
fn a_scene_that_cannot_be_shown_is_passed_over() {
    let (_folder, mut hand) = hand("whole");
    assert_eq!(hand.retreat(), Retreat::Nowhere, "nothing was shown yet");
    hand.keep();
    hand.apply(Intent::StepScene(1));
    assert_eq!(hand.shown().scene.id, "detail");
    assert_eq!(hand.retreat(), Retreat::Back);
    assert_eq!(hand.shown().scene.id, "whole");
    hand.apply(Intent::StepScene(1));
    assert_eq!(hand.shown().scene.id, "page");
}

/// The exhibit of `folder` after a save of `text`.
fn save(folder: &tempfile::TempDir, text: &str) -> Arc<Exhibit> {
    fs::write(folder.path().join("exhibit.toml"), text).expect("the manifest is written");
    let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
    Arc::new(exhibit)
}

#[test]
fn a_new_version_that_cannot_be_shown_gives_way_to_the_one_before() {
    let (folder, mut hand) = hand("detail");
    hand.apply(Intent::RaiseLamp(60.0));
    hand.keep();
    let before = hand.shown();
    // Two saves in a row, neither of which can be shown.
    for width in ["50", "40"] {
        let text = super::MANIFEST.replace("width_mm = 60", &format!("width_mm = {width}"));
        hand.replace(save(&folder, &text));
        assert_ne!(hand.shown().scene, before.scene);
    }
    assert_eq!(hand.retreat(), Retreat::Back);
    let after = hand.shown();
    assert_eq!(after.scene, before.scene);
    assert_eq!(*after.exhibit, *before.exhibit);
    // Its files may be damaged as well: the hand keeps what needs none.
    drag(&mut hand, DVec2::ZERO, DVec2::new(0.1, 0.0));
    let moved = hand.shown().scene.camera;
    assert_eq!(hand.retreat(), Retreat::Stuck);
    assert_eq!(hand.shown().scene.camera, moved);
    hand.apply(Intent::StepState(1));
    assert_eq!(hand.retreat(), Retreat::Back);
    assert_eq!(hand.shown().scene.state, None);
    // The next save is shown.
    hand.replace(save(&folder, super::MANIFEST));
    hand.keep();
    hand.apply(Intent::StepScene(1));
    assert_eq!(hand.retreat(), Retreat::Back);
    assert_eq!(hand.shown().scene.id, "detail");
}

#[test]
fn a_tiny_sheet_can_be_zoomed() {
    let (folder, _) = exhibit();
    let text = super::MANIFEST.replace("[300.0, 200.0]", "[1.0, 1.0]");
    let text = text.replace("centre_mm = [100, 80], width_mm = 60", "");
    // Nothing of a usual size lies on it.
    let tables = text
        .split("\n[[")
        .filter(|table| !table.starts_with("drawing.hotspot"));
    let text = tables.collect::<Vec<_>>().join("\n[[");
    let mut hand = Hand::new(save(&folder, &text), 0, Tier::Draft, PICTURE, false);
    let whole = hand.shown().scene.camera.width_mm;
    let at = DVec2::new(0.3, 0.3);
    for intent in [
        Intent::Zoom { at, factor: 3.0 },
        Intent::TrueSize { at },
        Intent::TrueSize { at },
        Intent::Zoom { at, factor: 0.1 },
    ] {
        hand.apply(intent);
        settle(&mut hand);
        assert_eq!(hand.shown().scene.camera.width_mm, whole);
    }
}

#[test]
fn a_lowered_lamp_darkens_the_sheet() {
    let (_folder, mut hand) = hand("whole");
    let lux = |hand: &Hand| {
        let shown = hand.shown();
        let lighting = shown.exhibit.lighting(&shown.scene);
        let [ref light] = lighting.lights[..] else {
            panic!("one lamp");
        };
        light.illuminance(DVec3::ZERO, DVec3::Z).y
    };
    let written = lux(&hand);
    let height = |hand: &Hand| {
        hand.lamp()
            .expect("a lamp")
            .elevation_deg
            .to_radians()
            .sin()
    };
    let high = height(&hand);
    hand.apply(Intent::MoveLamp(DVec2::new(-0.1, 0.0)));
    assert!(height(&hand) < high);
    let share = lux(&hand) / written;
    let expected = height(&hand) / high;
    assert!((share - expected).abs() < 1e-9, "{share} {expected}");
    // A key sets the lamp up anew, and the eye adapts; moved from there, it darkens again.
    hand.apply(Intent::RaiseLamp(5.0));
    assert!((lux(&hand) / written - 1.0).abs() < 1e-9);
    hand.apply(Intent::MoveLamp(DVec2::new(0.1, 0.0)));
    assert!(lux(&hand) > 1.2 * written);
    hand.apply(Intent::Home);
    assert_eq!(lux(&hand), written);
}

#[test]
fn a_cheap_tier_in_motion_and_the_exact_one_at_rest() {
    use recto::visitor::Serving;
    let (_folder, exhibit) = exhibit();
    let hand = |tier| Hand::new(exhibit.clone(), 0, tier, PICTURE, false);
    let serving = |at_rest, in_motion| Some(Serving { at_rest, in_motion });

    // Nobody asked for a tier: what is served decides, once something is known.
    let mut free = hand(Tier::Gallery);
    free.leave_tier_free();
    assert_eq!(free.wanted(), None);
    assert_eq!(free.shown().tier, Tier::Gallery);
    free.hurry(true);
    assert_eq!(
        free.shown().tier,
        Tier::Draft,
        "the cheapest while nothing is known"
    );
    free.hurry(false);
    free.serve(serving(Tier::Study, Tier::Gallery));
    assert_eq!(free.shown().tier, Tier::Study);
    free.hurry(true);
    assert_eq!(free.shown().tier, Tier::Gallery);
    free.hurry(false);
    assert_eq!(free.shown().tier, Tier::Study, "it refines");
    // A wish ends that.
    free.apply(Intent::StepTier(-1));
    assert_eq!(free.wanted(), Some(Tier::Gallery));
    free.hurry(true);
    assert_eq!(
        free.shown().tier,
        Tier::Gallery,
        "no dearer in motion than at rest"
    );

    let mut asked = hand(Tier::Study);
    asked.serve(serving(Tier::Lambert, Tier::Draft));
    assert_eq!(asked.shown().tier, Tier::Study, "what was asked for stays");
    asked.hurry(true);
    assert_eq!(asked.shown().tier, Tier::Draft);
    // Baselines from the literature are never replaced.
    let mut isle = hand(Tier::Isle);
    isle.serve(serving(Tier::Study, Tier::Draft));
    isle.hurry(true);
    assert_eq!(isle.shown().tier, Tier::Isle);
}

/// A hand on two sides of which a curtain, a loupe or a difference can be made.
fn comparing(steps: usize) -> (tempfile::TempDir, Hand) {
    let (folder, mut hand) = hand("whole");
    for _ in 0..steps {
        hand.apply(Intent::StepCompare(1));
    }
    (folder, hand)
}

fn comparison(hand: &Hand) -> Comparison {
    hand.shown().scene.compare.expect("a comparison")
}

#[test]
fn comparisons_are_gone_through_and_end_with_none() {
    let (_folder, mut hand) = comparing(0);
    let mut seen = Vec::new();
    for _ in 0..7 {
        hand.apply(Intent::StepCompare(1));
        seen.push(comparison(&hand).mode);
    }
    let all: BTreeSet<String> = seen.iter().map(|mode| format!("{mode:?}")).collect();
    assert_eq!(all.len(), 7, "{seen:?}");
    hand.apply(Intent::StepCompare(1));
    assert_eq!(hand.shown().scene.compare, None);
    hand.apply(Intent::StepCompare(-1));
    assert_eq!(comparison(&hand).mode, CompareMode::Glass);
    hand.apply(Intent::Home);
    assert_eq!(hand.shown().scene.compare, None);
}

#[test]
fn a_hand_on_the_curtain_moves_the_curtain_and_beside_it_the_sheet() {
    let (_folder, mut hand) = comparing(1);
    assert_eq!(comparison(&hand).mode, CompareMode::Curtain);
    let pose = hand.shown().pose;
    let drag = |hand: &mut Hand, from: DVec2, to: DVec2| {
        hand.apply(Intent::Take);
        hand.apply(Intent::Drag { from, to });
        hand.apply(Intent::Release);
    };
    drag(&mut hand, DVec2::ZERO, DVec2::new(0.4, 0.1));
    assert!((comparison(&hand).at - 0.7).abs() < 1e-9);
    assert_eq!(hand.shown().pose, pose);
    drag(&mut hand, DVec2::ZERO, DVec2::new(0.4, 0.1));
    assert!((comparison(&hand).at - 0.7).abs() < 1e-9);
    assert_ne!(hand.shown().pose, pose);
    settle(&mut hand);
    // However far it is dragged, it stays in the picture.
    drag(&mut hand, DVec2::new(0.4, 0.0), DVec2::new(9.0, 0.0));
    assert_eq!(comparison(&hand).at, 1.0);
}

#[test]
fn nothing_flashes_more_than_three_times_a_second() {
    const SECONDS: f64 = 10.0;
    for frame_s in [1e-3, 1.0 / 60.0, 0.7] {
        let (_folder, mut hand) = comparing(6);
        assert_eq!(comparison(&hand).mode, CompareMode::Flicker);
        assert!(hand.takes_turns());
        let (mut elapsed, mut changes, mut turn) = (0.0, 0, comparison(&hand).turn);
        while elapsed < SECONDS {
            hand.advance(frame_s, true);
            elapsed += frame_s;
            let now = comparison(&hand).turn;
            changes += u32::from(now != turn);
            turn = now;
        }
        assert!(
            changes >= 10 && f64::from(changes) <= 3.0 * SECONDS,
            "{frame_s}: {changes}"
        );
    }
    // With reduced motion nothing changes by itself, and a key goes on.
    let (_folder, exhibit) = exhibit();
    let mut calm = Hand::new(exhibit, 0, Tier::Draft, PICTURE, true);
    for _ in 0..6 {
        calm.apply(Intent::StepCompare(1));
    }
    for _ in 0..100 {
        calm.advance(0.1, true);
    }
    assert!(!calm.takes_turns() && comparison(&calm).turn == 0);
    calm.apply(Intent::ShiftCompare(1.0));
    assert_eq!(comparison(&calm).turn, 1);
}

#[test]
fn enhancement_and_light_through_the_sheet_are_steps_of_keys() {
    let (_folder, mut hand) = comparing(0);
    hand.apply(Intent::ReliefOnly);
    hand.apply(Intent::Exaggerate);
    hand.apply(Intent::Stretch);
    hand.apply(Intent::Sharpen);
    let enhance = hand.shown().scene.enhance;
    assert_eq!(enhance.marks().len(), 4, "{enhance:?}");
    for _ in 0..12 {
        hand.apply(Intent::Transmit(0.1));
    }
    assert_eq!(hand.shown().scene.transmitted, 1.0);
    for _ in 0..10 {
        hand.apply(Intent::Transmit(-0.1));
    }
    assert_eq!(hand.shown().scene.transmitted, 0.0, "none is none");
    hand.apply(Intent::Transmit(0.3));
    hand.apply(Intent::Home);
    assert_eq!(hand.shown().scene.enhance.marks().len(), 0);
    assert_eq!(hand.shown().scene.transmitted, 0.0);
}

#[test]
fn a_difference_stays_within_what_a_manifest_can_say() {
    let (_folder, mut hand) = comparing(5);
    assert_eq!(comparison(&hand).mode, CompareMode::Difference);
    hand.apply(Intent::TurnCompare(1.0));
    for (by, end) in [(-1.0, 1.0), (1.0, 0.01)] {
        for _ in 0..40 {
            hand.apply(Intent::ShiftCompare(by));
        }
        assert_eq!(comparison(&hand).full_luminance, Some(end));
    }
    hand.apply(Intent::TurnCompare(1.0));
    assert_eq!(comparison(&hand).full_luminance, None);
}

#[test]
fn a_comparison_with_a_drawing_that_is_gone_goes_with_it() {
    let (folder, _) = exhibit();
    let scene = "id = \"whole\"\n";
    let compare = "compare = { mode = \"flicker\", of = [\"drawing:sheet\", \"drawing:page\"] }\n";
    let text = super::MANIFEST.replace(scene, &format!("{scene}{compare}"));
    let mut hand = Hand::new(save(&folder, &text), 0, Tier::Draft, PICTURE, false);
    for _ in 0..2 {
        hand.advance(0.3, true);
    }
    assert_eq!(comparison(&hand).turn, 1);
    // An edit of the comparison is taken in, whosever turn it is.
    hand.replace(save(&folder, &text.replace("flicker", "curtain")));
    assert_eq!(comparison(&hand).mode, CompareMode::Curtain);
    hand.replace(save(&folder, &text));
    hand.advance(0.6, true);
    let tables = super::MANIFEST.split("\n[[");
    let tables: Vec<&str> = tables.filter(|table| !table.contains("\"page\"")).collect();
    hand.replace(save(&folder, &tables.join("\n[[")));
    assert_eq!(hand.shown().scene.compare, None);
    assert_eq!(hand.shown().members().len(), 1);
}

#[test]
fn sheets_beside_each_other_follow_the_finger_that_holds_one() {
    let (_folder, mut hand) = hand("whole");
    while hand.shown().scene.compare.as_ref().map(|c| c.mode) != Some(CompareMode::SideBySide) {
        hand.apply(Intent::StepCompare(1));
    }
    // The whole sheet fits into its cell, which is half as wide as the picture.
    let size = hand.shown().exhibit.drawing_of(&hand.shown().scene).size_mm;
    let width = hand.shown().scene.camera.width_mm;
    assert!(
        width < 1.1 * size.x.max(size.y * PICTURE.aspect / 2.0),
        "{width}"
    );
    hand.apply(Intent::Zoom {
        at: DVec2::new(-0.5, 0.0),
        factor: 4.0,
    });
    settle(&mut hand);
    let camera = hand.shown().scene.camera;
    let (centre, width) = (camera.centre_mm, camera.width_mm);
    // Zoomed about the middle of the recto's cell, it is still in the middle.
    assert!(centre.distance(size / 2.0) < NEAR_MM, "{centre}");
    // By a tenth of the picture, in a cell that is half of it. The recto moves with the finger; the
    // verso's left is the recto's right.
    assert_sides_follow(&mut hand, 0.1 * width);
}

/// Dragged to the right at its left and at its right, the picture's sheets go by `mm` with the finger: the
/// recto so, the verso as its mirror image.
fn assert_sides_follow(hand: &mut Hand, mm: f64) {
    for (from, sign) in [(-0.5, -1.0), (0.5, 1.0)] {
        let before = hand.shown().scene.camera.centre_mm;
        hand.apply(Intent::Take);
        hand.apply(Intent::Drag {
            from: DVec2::new(from, 0.0),
            to: DVec2::new(from + 0.1, 0.0),
        });
        let moved = hand.shown().scene.camera.centre_mm.x - before.x;
        hand.apply(Intent::Release);
        settle(hand);
        assert!((moved - sign * mm).abs() < NEAR_MM, "{moved} {mm}");
    }
}

#[test]
fn the_side_that_is_dragged_follows_the_finger_under_a_curtain_too() {
    let (_folder, mut hand) = hand("whole");
    hand.apply(Intent::StepCompare(1));
    let mode = hand.shown().scene.compare.as_ref().map(|c| c.mode);
    assert_eq!(mode, Some(CompareMode::Curtain));
    hand.apply(Intent::Zoom {
        at: DVec2::ZERO,
        factor: 4.0,
    });
    settle(&mut hand);
    let width = hand.shown().scene.camera.width_mm;
    // The curtain's edge is in the middle, the recto on its left.
    assert_sides_follow(&mut hand, 0.05 * width);
}
