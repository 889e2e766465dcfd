//! Hotspots under the hand, and views that are saved from it.

use std::{fs, sync::Arc};

use glam::{DVec2, DVec3};
use recto::{
    manifest::{Exhibit, Link, SaveAs, SideName, eye::Eye},
    optics::tier::Tier,
    visitor::{Hand, Intent, hand::Picture},
};

const PICTURE: Picture = Picture {
    aspect: 1.6,
    width_mm: 400.0,
    measured: true,
};

fn hand(scene: &str) -> (tempfile::TempDir, Hand) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    let (exhibit, _) = Exhibit::read(folder.path()).expect("a sound exhibit");
    let (index, _) = exhibit.scene(scene).expect("the scene");
    // Calm: what is asked for is there at once.
    let hand = Hand::new(Arc::new(exhibit), index, Tier::Draft, PICTURE, true);
    (folder, hand)
}

/// Where a place of the side in view is seen in the picture.
fn seen(hand: &Hand, place: [f64; 2]) -> DVec2 {
    let shown = hand.shown();
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    let eye = Eye::new(&shown.scene.camera, drawing.size_mm);
    let on_sheet = drawing.on_sheet(shown.scene.side, place.into());
    let at = eye.clip_from_table(shown.aspect) * (shown.pose * on_sheet).extend(1.0);
    DVec2::new(at.x, at.y) / at.w
}

fn tap(hand: &mut Hand, place: [f64; 2]) {
    let at = seen(hand, place);
    hand.apply(Intent::Tap(at));
}

fn open(hand: &Hand) -> Option<&str> {
    hand.open_hotspot().map(|hotspot| hotspot.id.as_str())
}

const FIELD: [f64; 2] = [40.0, 120.0];
const HOUSE: [f64; 2] = [75.0, 70.0];
const NOTHING: [f64; 2] = [250.0, 150.0];

#[test]
fn hotspots_answer_once_they_are_asked_for() {
    let (_folder, mut hand) = hand("whole");
    tap(&mut hand, FIELD);
    assert_eq!(open(&hand), None, "nobody asked");
    hand.apply(Intent::Hotspots);
    tap(&mut hand, FIELD);
    assert_eq!(open(&hand), Some("field"));
    tap(&mut hand, HOUSE);
    assert_eq!(open(&hand), Some("house"), "the smaller of the two");
    tap(&mut hand, HOUSE);
    assert_eq!(open(&hand), Some("house"), "it leads nowhere");
    tap(&mut hand, NOTHING);
    assert_eq!(open(&hand), None);
    tap(&mut hand, FIELD);
    assert!(hand.close_hotspot() && !hand.close_hotspot());
    tap(&mut hand, FIELD);
    tap(&mut hand, FIELD);
    assert_eq!(hand.shown().scene.id, "detail");
    assert_eq!(open(&hand), None);
    hand.apply(Intent::Hotspots);
    tap(&mut hand, [90.0, 80.0]);
    assert_eq!(open(&hand), None, "they are hidden again");
}

#[test]
fn two_clicks_on_a_hotspot_are_about_it_and_elsewhere_about_true_size() {
    let (_folder, mut hand) = hand("whole");
    hand.resize(Picture {
        width_mm: 120.0,
        ..PICTURE
    });
    hand.apply(Intent::Hotspots);
    let at = seen(&hand, FIELD);
    hand.apply(Intent::TrueSize { at });
    assert_eq!(hand.at_true_size(), None);
    let at = seen(&hand, NOTHING);
    hand.apply(Intent::TrueSize { at });
    assert_eq!(hand.at_true_size(), Some(true));
}

#[test]
fn keys_step_through_those_of_the_side_in_view() {
    let (_folder, mut hand) = hand("whole");
    let mut steps = Vec::new();
    for by in [1, 1, 1, -1, -1] {
        hand.apply(Intent::StepHotspot(by));
        steps.push(open(&hand).unwrap_or_default().to_owned());
    }
    assert_eq!(steps, ["field", "house", "field", "house", "field"]);
    hand.apply(Intent::Flip);
    assert_eq!(hand.shown().scene.side, SideName::Verso);
    assert_eq!(open(&hand), None, "it is on the other side");
    hand.apply(Intent::StepHotspot(-1));
    assert_eq!(open(&hand), Some("seal"));
    tap(&mut hand, [200.0, 150.0]);
    tap(&mut hand, [20.0, 20.0]);
    assert_eq!(open(&hand), Some("seal"), "measured on its own side");
    hand.apply(Intent::Flip);
    hand.apply(Intent::StepHotspot(1));
    hand.apply(Intent::GoOn);
    assert_eq!(hand.shown().scene.id, "detail");
}

#[test]
fn a_hotspot_goes_wherever_the_sheet_goes() {
    let (_folder, mut hand) = hand("whole");
    hand.apply(Intent::Hotspots);
    let before = seen(&hand, HOUSE);
    hand.apply(Intent::Take);
    let (from, to) = (DVec2::ZERO, DVec2::new(0.6, -0.5));
    hand.apply(Intent::Drag { from, to });
    assert!((hand.shown().pose * DVec3::Z).z < 0.9, "it is turned");
    let after = seen(&hand, HOUSE);
    assert!(before.distance(after) > 0.1);
    hand.apply(Intent::Tap(after));
    assert_eq!(open(&hand), Some("house"));
    hand.apply(Intent::Tap(before));
    assert_ne!(open(&hand), Some("house"));
}

#[test]
fn an_open_hotspot_stays_open_when_the_manifest_is_saved() {
    let (folder, mut hand) = hand("whole");
    hand.apply(Intent::Hotspots);
    tap(&mut hand, HOUSE);
    let text = super::MANIFEST.replace("It stands", "It stood");
    fs::write(folder.path().join("exhibit.toml"), text).expect("the manifest is written");
    let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
    hand.replace(Arc::new(exhibit));
    let hotspot = hand.open_hotspot().expect("it is open");
    assert_eq!(hotspot.text.0["en"], "It stood in the field.");
}

/// Changes all that a hand can change of a scene.
fn change(hand: &mut Hand) {
    for intent in [
        Intent::StepState(1),
        Intent::StepOverlay,
        Intent::Opacity(-0.1),
        Intent::Zoom {
            at: DVec2::new(0.3, 0.1),
            factor: 1.7,
        },
        Intent::MoveLamp(DVec2::new(0.3, 0.2)),
    ] {
        hand.apply(intent);
    }
}

#[test]
fn a_view_that_is_saved_is_the_view_and_disturbs_nothing() {
    let (folder, mut hand) = hand("whole");
    change(&mut hand);
    let before = hand.shown();
    let (exhibit, scene) = hand.view();
    let draft = exhibit.draft(&scene, SaveAs::Next("view"), &[]);
    let draft = draft.unwrap_or_else(|error| panic!("{error}"));
    let written = draft.write().unwrap_or_else(|error| panic!("{error}"));
    let (read, _) = Exhibit::read(folder.path()).expect("it is sound");
    assert_eq!(read.fingerprint, written);
    let (index, _) = read.scene("view-1").expect("it is there");
    let read = Arc::new(read);
    // As the window reads it again: nothing moves.
    hand.replace(read.clone());
    let after = hand.shown();
    assert_eq!(after.scene, before.scene);
    assert_eq!(after.pose, before.pose);
    let kinds = |exhibit: &Exhibit| exhibit.lamps[0].kind.clone();
    assert_eq!(kinds(&after.exhibit), kinds(&before.exhibit));
    // And the scene that was saved shows the same.
    let saved = Hand::new(read, index, Tier::Draft, PICTURE, true).shown();
    assert_eq!(saved.scene.camera, before.scene.camera);
    assert_eq!(saved.scene.overlays, before.scene.overlays);
    assert_eq!(saved.scene.state, before.scene.state);
    let light = |shown: &recto::stage::Shown| shown.exhibit.lighting(&shown.scene);
    assert_eq!(light(&saved), light(&before));
    // So does a link.
    let link = hand.view();
    let link = link
        .0
        .link(&link.1)
        .unwrap_or_else(|error| panic!("{error}"));
    let link = Link::read(&link).unwrap_or_else(|faults| panic!("{faults}"));
    let (linked, _) = Exhibit::read_with(folder.path(), Some(&link)).expect("it is sound");
    let index = linked.scenes.len() - 1;
    let linked = Hand::new(Arc::new(linked), index, Tier::Draft, PICTURE, true).shown();
    assert_eq!(light(&linked), light(&before));
    assert_eq!(linked.scene.camera, before.scene.camera);
}
