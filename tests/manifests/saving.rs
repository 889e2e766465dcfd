//! Scenes written into a manifest and into links, and read again.

use std::{collections::BTreeMap, fs, os::unix::fs::PermissionsExt};

use glam::{DVec2, DVec3};
use proptest::{prelude::*, test_runner::TestRunner};
use recto::{
    manifest::{
        Camera, CompareMode, Comparison, Draft, Enhancement, Exhibit, Fingerprint, LampColour,
        LampKind, Link, Member, SaveAs, SaveError, Scene, SideName, Wording,
    },
    units::{Degrees, Kelvin, Lux},
};

use super::{Folder, sound::FULL};

const MODES: [CompareMode; 7] = [
    CompareMode::Curtain,
    CompareMode::SideBySide,
    CompareMode::Blend,
    CompareMode::Loupe,
    CompareMode::Difference,
    CompareMode::Flicker,
    CompareMode::Glass,
];

fn read(folder: &Folder) -> Exhibit {
    Exhibit::read(&folder.exhibit)
        .unwrap_or_else(|faults| panic!("{faults}"))
        .0
}

fn text(folder: &Folder) -> String {
    fs::read_to_string(folder.exhibit.join("exhibit.toml")).unwrap()
}

fn draft(exhibit: &Exhibit, scene: &Scene, id: &str) -> Draft {
    let draft = exhibit.draft(scene, SaveAs::Id(id), &[]);
    draft.unwrap_or_else(|error| panic!("{error}"))
}

fn refused(exhibit: &Exhibit, scene: &Scene, id: &str) -> String {
    let draft = exhibit.draft(scene, SaveAs::Id(id), &[]);
    draft
        .map(|draft| draft.id().to_owned())
        .unwrap_err()
        .to_string()
}

/// `scene` under another id, and without words, which are no part of a view.
fn called(scene: &Scene, id: &str) -> Scene {
    Scene {
        id: id.to_owned(),
        title: Wording::default(),
        text: Wording::default(),
        ..scene.clone()
    }
}

/// Saves `scene` and reads it again; leaves the file with it.
fn saved(folder: &Folder, exhibit: &Exhibit, scene: &Scene) -> Exhibit {
    draft(exhibit, scene, &scene.id).write().unwrap();
    let read = read(folder);
    assert!(read.has(scene, exhibit), "{scene:?}\n{}", text(folder));
    read
}

/// What was put into `old` to make `new`, if the rest of it stands as it did, byte for byte.
fn inserted<'n>(old: &str, new: &'n str) -> &'n str {
    let same = |(a, b): &(u8, u8)| a == b;
    let pairs = old.bytes().zip(new.bytes());
    let before = pairs.take_while(same).count();
    let pairs = old.bytes().rev().zip(new.bytes().rev());
    let behind = pairs.take_while(same).count().min(old.len() - before);
    assert_eq!(before + behind, old.len(), "{old}\n=== became\n{new}");
    &new[before..new.len() - behind]
}

#[test]
fn every_scene_is_the_same_when_it_is_read_again() {
    let folder = Folder::with(FULL);
    for id in ["washes", "closer", "restoration"] {
        let exhibit = read(&folder);
        let scene = called(exhibit.scene(id).unwrap().1, "saved");
        saved(&folder, &exhibit, &scene);
        folder.write(FULL);
    }
}

/// A scene in which everything is unlike what it is by itself.
fn strange(exhibit: &Exhibit, mode: CompareMode) -> Scene {
    let mut scene = called(exhibit.scene("washes").unwrap().1, "strange");
    let of = match mode {
        CompareMode::Glass => vec![Member::Side(SideName::Verso), Member::Side(SideName::Recto)],
        _ => vec![Member::State(None), Member::Side(SideName::Verso)],
    };
    scene.compare = Some(Comparison {
        at: 1.0 / 3.0,
        angle: Degrees(-0.1 - 0.2),
        centre: DVec2::new(0.1, 2.0 / 3.0),
        radius: 1.0 / 7.0,
        magnify: 10.0 / 3.0,
        full_delta_e: 100.0 / 7.0,
        full_luminance: Some(1.0 / 9.0),
        ..Comparison::new(mode, of)
    });
    scene.camera = Camera {
        centre_mm: DVec2::new(1.0 / 3.0, -2.0 / 7.0),
        width_mm: 100.0 / 3.0,
        tilt: Degrees(1e-7),
        turn: Degrees(-359.999_999_999_999_94),
        distance_mm: Some(1e5 / 3.0),
    };
    scene.overlays = vec![(2, 1.0 / 3.0), (0, 1e-300)];
    scene.categories = BTreeMap::from([(0, vec![1])]);
    scene.exposure.illuminance = Some(Lux(1e3 / 7.0));
    scene.exposure.level = 1.0 / 3.0;
    scene.transmitted = 1.0 / 7.0;
    scene.enhance = Enhancement {
        relief_only: true,
        exaggerate: 10.0 / 3.0,
        stretch: Some(DVec2::new(1.0 / 7.0, 2.0 / 3.0)),
        sharpen: 1.0 / 9.0,
    };
    scene.exposure.white = Kelvin(1e4 / 3.0);
    scene.ambient.illuminance = Lux(f64::MIN_POSITIVE);
    scene
}

#[test]
fn every_mode_of_comparison_is_the_same_when_it_is_read_again() {
    let folder = Folder::with(FULL);
    for mode in MODES {
        let exhibit = read(&folder);
        saved(&folder, &exhibit, &strange(&exhibit, mode));
        folder.write(FULL);
    }
}

fn compared(scene: &mut Scene) -> &mut Comparison {
    scene.compare.as_mut().unwrap()
}

#[test]
fn scenes_that_differ_in_anything_are_told_apart() {
    let folder = Folder::with(FULL);
    let exhibit = read(&folder);
    let scene = strange(&exhibit, CompareMode::Curtain);
    let read = saved(&folder, &exhibit, &scene);
    let other = |change: fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        !read.has(&scene, &exhibit)
    };
    assert!(other(|scene| scene.camera.width_mm += 1e-13));
    assert!(other(|scene| scene.overlays[1].1 = 0.0));
    assert!(other(|scene| scene.lamps.swap(0, 1)));
    assert!(other(|scene| scene.exposure.illuminance = None));
    assert!(other(|scene| scene.language = None));
    assert!(other(|scene| scene.state = None));
    assert!(other(|scene| scene.compare = None));
    assert!(other(|scene| compared(scene).at = 0.3));
    // What a curtain does not use is not told apart.
    assert!(!other(|scene| compared(scene).radius = 0.3));
    assert!(other(|scene| scene.transmitted = 0.0));
    assert!(other(|scene| scene.enhance.sharpen = 0.0));
    let mut moved = exhibit.clone();
    moved.lamps[scene.lamps[0]].colour = LampColour::Temperature(Kelvin(3001.0));
    assert!(!read.has(&scene, &moved));
}

/// Moves a lamp to a place that no decimal number names.
fn moved(kind: &mut LampKind) {
    let place = DVec3::new(-100.0 / 3.0, 200.0 / 7.0, 1e4 / 7.0);
    match kind {
        LampKind::Distant {
            elevation, azimuth, ..
        } => (*elevation, *azimuth) = (Degrees(100.0 / 3.0), Degrees(1000.0 / 7.0)),
        LampKind::Point { position_mm, .. }
        | LampKind::Spot { position_mm, .. }
        | LampKind::Rectangle { position_mm, .. }
        | LampKind::Disc { position_mm, .. }
        | LampKind::Ies { position_mm, .. } => *position_mm = place,
        LampKind::LightTable { luminance } => luminance.0 /= 3.0,
    }
}

#[test]
fn a_lamp_that_was_moved_is_a_lamp_of_its_own() {
    let folder = Folder::with(FULL);
    let original = read(&folder);
    for lamp in 0..original.lamps.len() {
        let mut exhibit = original.clone();
        moved(&mut exhibit.lamps[lamp].kind);
        let mut scene = called(exhibit.scene("washes").unwrap().1, "moved");
        scene.lamps = vec![0, lamp];
        scene.lamps.dedup();
        let read = saved(&folder, &exhibit, &scene);
        assert_eq!(read.lamps.len(), original.lamps.len() + 1);
        assert_eq!(
            read.lamps[..original.lamps.len()],
            original.lamps,
            "they stay"
        );
        let new = &read.lamps[original.lamps.len()];
        assert_eq!(new.id, "moved-lamp");
        assert_eq!(
            read.scene("moved").unwrap().1.lamps.len(),
            scene.lamps.len()
        );
        // Saved once more from there, it is known.
        let again = called(read.scene("moved").unwrap().1, "again");
        let twice = saved(&folder, &read, &again);
        assert_eq!(twice.lamps.len(), read.lamps.len());
        folder.write(FULL);
    }
    // A spectrum goes along, in whichever way it is written.
    let spectrum = FULL.replacen("kelvin = 5500", "spectrum = \"LED-B3\"", 1);
    folder.write(&spectrum);
    let mut exhibit = read(&folder);
    moved(&mut exhibit.lamps[0].kind);
    let mut scene = called(exhibit.scene("washes").unwrap().1, "moved");
    scene.lamps = vec![0];
    saved(&folder, &exhibit, &scene);
    assert_eq!(text(&folder).matches("LED-B3").count(), 2);
}

#[test]
fn whatever_number_there_is_is_kept_to_its_last_digit() {
    let folder = Folder::with(FULL);
    let exhibit = read(&folder);
    let numbers = (
        (0.0..=200.0, 0.0..=100.0, 0.1..=20000.0, 0.0..=89.0),
        (-360.0..=360.0, 0.0..=1.0, 0.001..=1e6, 0.0..=1e6),
        (0.0..=1.0, -360.0..=360.0, 0.1..=90.0),
    );
    let mut runner = TestRunner::new(ProptestConfig {
        failure_persistence: None,
        cases: 40,
        ..ProptestConfig::default()
    });
    let result = runner.run(
        &numbers,
        |((x, y, width, tilt), (turn, share, lux, room), rest)| {
            let mut exhibit = exhibit.clone();
            let mut scene = strange(&exhibit, CompareMode::Loupe);
            scene.camera = Camera {
                centre_mm: DVec2::new(x, y),
                width_mm: width,
                tilt: Degrees(tilt),
                turn: Degrees(turn),
                distance_mm: None,
            };
            scene.overlays = vec![(0, share)];
            scene.categories.clear();
            scene.exposure.illuminance = Some(Lux(lux));
            scene.ambient.illuminance = Lux(room);
            scene.lamps = vec![0];
            let (at, azimuth, elevation) = rest;
            scene.compare.as_mut().unwrap().radius = f64::max(at, 0.01);
            exhibit.lamps[0].kind = LampKind::Distant {
                illuminance: Lux(lux),
                elevation: Degrees(elevation),
                azimuth: Degrees(azimuth),
            };
            let draft = exhibit.draft(&scene, SaveAs::Id("strange"), &[]).unwrap();
            folder.write(draft.text());
            let read = Exhibit::read(&folder.exhibit).unwrap().0;
            folder.write(FULL);
            prop_assert!(read.has(&scene, &exhibit));
            let link = Link::read(&exhibit.link(&scene).unwrap()).unwrap();
            let linked = Exhibit::read_with(&folder.exhibit, Some(&link)).unwrap().0;
            prop_assert!(linked.has(&called(&scene, "link"), &exhibit));
            Ok(())
        },
    );
    result.unwrap_or_else(|error| panic!("{error}"));
}

/// A manifest in which everything could be lost that a program might tidy up.
const UNTIDY: &str = "\
# Above all.
   [exhibit]   # the exhibit
title   = 'One'

[[ drawing ]]
id='sheet' # and why
size_mm=[200,100,] # a comma too many
recto . albedo = \"recto.png\"


[[lamp]]   # the lamp
kind = \"distant\"
id = \"left\"
lux_at_sheet = 1_000
elevation_deg = 0x2d
azimuth_deg = +180
# lux_at_sheet = 500

# The scenes.
[[scene]]
id = \"first\"
text = \"\"\"
[[scene]]
# no comment\"\"\"
[scene.camera] # as a table
width_mm = 8e1
#\tcentre_mm = [1, 2]

# The second one.
[[scene]]
  id = \"second\"   # two
  # Its title.
  title = { en='Second' }
  camera = { width_mm = 50 } # near
  exposure = { lux = 100 }
# of the tour
[[tour]]
id = \"attract\"
scenes = [
  \"first\", # one
]
# The end.
";

#[test]
fn nothing_else_of_the_text_changes() {
    let unfinished = UNTIDY.trim_end().to_owned();
    let windows = UNTIDY.replace('\n', "\r\n");
    let marked = format!("\u{feff}{UNTIDY}");
    for old in [UNTIDY.to_owned(), unfinished, windows, marked] {
        let folder = Folder::with(&old);
        let mut exhibit = read(&folder);
        let mut scene = called(&exhibit.scenes[1], "view");
        scene.camera.width_mm = 33.0;
        let with_scene = draft(&exhibit, &scene, "view");
        let new = inserted(&old, with_scene.text());
        assert!(new.contains("[[scene]]") && new.contains("width_mm = 33"));
        // Behind the last scene and before what belongs to the tour.
        let at = with_scene.text().find(new.trim()).unwrap();
        assert!(at > old.find("lux = 100").unwrap());
        assert!(at < with_scene.text().find("# of the tour").unwrap());
        // All lines end as they do in the file.
        let whole = with_scene.text();
        if old.contains('\r') {
            assert_eq!(whole.matches('\n').count(), whole.matches("\r\n").count());
        } else {
            assert!(!whole.contains('\r'));
        }
        // A lamp stands behind its like, and nothing else changes but its name in the scene.
        moved(&mut exhibit.lamps[0].kind);
        let both = draft(&exhibit, &scene, "view");
        let named = both.text().replacen("\"view-lamp\"]", "\"left\"]", 1);
        assert!(inserted(whole, &named).contains("[[lamp]]"));
        let lamp = named.find("id = \"view-lamp\"").unwrap();
        assert!(lamp > named.find("# lux_at_sheet = 500").unwrap());
        assert!(lamp < named.find("# The scenes.").unwrap());
        folder.write(both.text());
        assert!(read(&folder).has(&scene, &exhibit));
    }
}

#[test]
fn a_scene_that_is_replaced_keeps_its_words_and_what_says_the_same() {
    for old in [UNTIDY.to_owned(), UNTIDY.replace('\n', "\r\n")] {
        let folder = Folder::with(&old);
        let exhibit = read(&folder);
        let second = exhibit.scene("second").unwrap().1;
        let mut scene = called(second, "second");
        scene.camera.tilt = Degrees(12.5);
        let new = draft(&exhibit, &scene, "second").text().to_owned();
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let (before, after) = (lines(&old), lines(&new));
        let second_begins = before
            .iter()
            .position(|line| line.contains("\"second\""))
            .unwrap();
        assert_eq!(before[..=second_begins], after[..=second_begins]);
        let tour = |lines: &[String]| lines.iter().position(|line| line == "# of the tour");
        assert_eq!(
            before[tour(&before).unwrap()..],
            after[tour(&after).unwrap()..]
        );
        for kept in [
            "  id = \"second\"   # two",
            "  # Its title.",
            "  title = { en='Second' }",
        ] {
            assert!(after.iter().any(|line| line == kept), "{new}");
        }
        assert!(
            new.contains("tilt_deg = 12.5") && new.contains(" # near"),
            "{new}"
        );
        folder.write(&new);
        let read = read(&folder);
        let words = Scene {
            title: second.title.clone(),
            ..scene
        };
        assert!(read.has(&words, &exhibit));
    }
    // One with a table of its own, and the first of them saved as it is.
    let folder = Folder::with(UNTIDY);
    let exhibit = read(&folder);
    let first = exhibit.scenes[0].clone();
    let new = draft(&exhibit, &first, "first").text().to_owned();
    assert!(
        new.contains("text = \"\"\"\n[[scene]]\n# no comment\"\"\"\n"),
        "{new}"
    );
    assert!(new.contains("# The second one.\n[[scene]]\n  id = \"second\"   # two\n"));
    folder.write(&new);
    assert!(read(&folder).has(&first, &exhibit));
}

#[test]
fn what_a_manifest_has_without_writing_it_stays() {
    let small = "[[drawing]]\nid = \"sheet\"\nsize_mm = [200, 100]\nrecto.albedo = \"recto.png\"";
    let folder = Folder::with(small);
    let mut exhibit = read(&folder);
    moved(&mut exhibit.lamps[0].kind);
    let scene = called(&exhibit.scenes[0], "view");
    let original = read(&folder);
    let read = saved(&folder, &exhibit, &scene);
    assert!(text(&folder).starts_with(small));
    assert_eq!(
        read.scenes[0], original.scenes[0],
        "the sheet's own comes first"
    );
    assert_eq!(read.lamps[0].kind, original.lamps[0].kind);
    assert_eq!((read.scenes.len(), read.lamps.len()), (2, 2));
}

#[test]
fn free_names_are_found() {
    let folder = Folder::with(UNTIDY);
    for expected in ["view-1", "view-2", "view-3"] {
        let exhibit = read(&folder);
        let scene = called(&exhibit.scenes[0], "");
        let draft = exhibit.draft(&scene, SaveAs::Next("view"), &[]).unwrap();
        assert_eq!(draft.id(), expected);
        draft.write().unwrap();
    }
}

#[test]
fn a_file_that_changed_is_left_alone() {
    let folder = Folder::with(UNTIDY);
    let exhibit = read(&folder);
    let scene = called(&exhibit.scenes[0], "view");
    let changed = format!("{UNTIDY}# by somebody else\n");
    folder.write(&changed);
    let message = refused(&exhibit, &scene, "view");
    assert!(
        message.contains("has changed since it was read"),
        "{message}"
    );
    assert_eq!(text(&folder), changed);
    // What is known to be one's own can be built upon.
    let known = [Fingerprint::of(&changed)];
    let draft = exhibit.draft(&scene, SaveAs::Id("view"), &known).unwrap();
    assert_eq!(
        inserted(&changed, draft.text())
            .matches("[[scene]]")
            .count(),
        1
    );
    // And between the draft and its writing.
    folder.write(UNTIDY);
    let error = draft.write().unwrap_err();
    assert!(matches!(error, SaveError::Changed(_)), "{error}");
    assert_eq!(text(&folder), UNTIDY);
    let files = fs::read_dir(&folder.exhibit).unwrap();
    let left = files.filter(|file| {
        let name = file.as_ref().unwrap().file_name();
        name.to_string_lossy().starts_with(".recto")
    });
    assert_eq!(left.count(), 0, "nothing is left behind");
}

#[test]
fn what_cannot_be_saved_is_refused_in_words_and_nothing_is_written() {
    let one_line =
        UNTIDY.split("# The scenes.").next().unwrap().to_owned() + "scene = [{ id = \"first\" }]\n";
    // A key cannot stand behind [[lamp]]: it comes first.
    let one_line = format!(
        "scene = [{{ id = \"first\" }}]\n{}",
        one_line.replace("scene = [{ id = \"first\" }]\n", "")
    );
    let apart = UNTIDY.replace(
        "[scene.camera] # as a table",
        "[[medium]]\nid = \"mine\"\nbased_on = \"laid\"\n[scene.camera]",
    );
    for (manifest, id, expected) in [
        (
            UNTIDY,
            "a view",
            "not saved: found \"a view\"; allowed: an id of up to 64",
        ),
        (UNTIDY, "", "not saved: found \"\""),
        (&one_line, "view", "not saved: it is written in one line"),
        (&apart, "first", "the parts of one stand apart"),
    ] {
        let folder = Folder::with(manifest);
        let exhibit = read(&folder);
        let scene = called(&exhibit.scenes[0], id);
        let message = refused(&exhibit, &scene, id);
        assert!(message.contains(expected), "{message}");
        assert_eq!(text(&folder), manifest);
    }
    let folder = Folder::with(UNTIDY);
    let exhibit = read(&folder);
    for change in [
        (|scene| scene.camera.width_mm = f64::NAN) as fn(&mut Scene),
        |scene| scene.exposure.illuminance = Some(Lux(1e9)),
        |scene| scene.lamps.clear(),
    ] {
        let mut scene = called(&exhibit.scenes[0], "view");
        change(&mut scene);
        let message = refused(&exhibit, &scene, "view");
        assert!(
            message.starts_with("not saved, for what is at fault:"),
            "{message}"
        );
        assert_eq!(text(&folder), UNTIDY);
    }
}

#[test]
fn a_file_keeps_its_permissions_and_its_links() {
    let folder = Folder::with(UNTIDY);
    let manifest = folder.exhibit.join("exhibit.toml");
    let real = folder.exhibit.join("real.toml");
    fs::rename(&manifest, &real).unwrap();
    std::os::unix::fs::symlink("real.toml", &manifest).unwrap();
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
    let exhibit = read(&folder);
    let scene = called(&exhibit.scenes[0], "view");
    saved(&folder, &exhibit, &scene);
    assert!(manifest.is_symlink());
    let mode = |path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(&real), 0o640);

    let exhibit = read(&folder);
    let before = text(&folder);
    fs::set_permissions(&real, fs::Permissions::from_mode(0o440)).unwrap();
    let message = refused(&exhibit, &scene, "another");
    assert!(message.contains("the file is read-only"), "{message}");
    assert_eq!(text(&folder), before);
    assert_eq!(mode(&real), 0o440);
}

#[test]
fn a_link_is_the_same_scene_wherever_the_manifest_s_own_went() {
    let folder = Folder::with(FULL);
    let mut exhibit = read(&folder);
    for lamp in &mut exhibit.lamps {
        moved(&mut lamp.kind);
    }
    let mut scenes: Vec<Scene> = MODES.map(|mode| strange(&exhibit, mode)).to_vec();
    scenes.extend(exhibit.scenes.clone());
    for mut scene in scenes {
        scene.lamps = (0..exhibit.lamps.len()).collect();
        let link = exhibit.link(&scene).unwrap();
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        assert!(
            link.chars().all(plain),
            "no shell or letter changes it: {link}"
        );
        // White space that a letter put in.
        let broken = format!("  {}\n  {}", &link[..40], &link[40..]);
        let link = Link::read(&broken).unwrap_or_else(|faults| panic!("{faults}"));
        let (linked, _) = Exhibit::read_with(&folder.exhibit, Some(&link)).unwrap();
        let last = linked.scenes.last().unwrap();
        assert_eq!(last.id, "link");
        assert!(linked.has(&called(&scene, "link"), &exhibit));
        assert_eq!(linked.link, Some(link));
    }
    // Where its names are taken it has others.
    let taken = FULL
        .replace("\"washes\"", "\"link\"")
        .replace("\"ring\"", "\"link-lamp\"");
    let link = Link::read(&exhibit.link(&exhibit.scenes[0]).unwrap()).unwrap();
    folder.write(taken);
    let (linked, _) = Exhibit::read_with(&folder.exhibit, Some(&link)).unwrap();
    assert_eq!(linked.scenes.last().unwrap().id, "link-2");
}

#[test]
fn a_link_that_is_none_is_refused_in_words() {
    let folder = Folder::with(FULL);
    let exhibit = read(&folder);
    let link = exhibit.link(&exhibit.scenes[0]).unwrap();
    let mut wrong = link.clone().into_bytes();
    wrong[30] = if wrong[30] == b'A' { b'B' } else { b'A' };
    let wrong = String::from_utf8(wrong).unwrap();
    for (text, expected) in [
        ("", "--link: found \"\""),
        (
            "https://example.org",
            "--link: found \"https://example.org\"",
        ),
        ("recto2.AAAA", "use the version of Recto that made it"),
        (&link[..link.len() - 1], "damaged or cut short"),
        (&link[..20], "damaged or cut short"),
        (&wrong, "damaged or cut short"),
        (
            &format!("recto1.{}", "A".repeat(1 << 20)),
            "damaged or cut short",
        ),
    ] {
        let message = Link::read(text).unwrap_err().to_string();
        assert!(message.contains(expected), "{text}: {message}");
    }
    // The drawing that it shows is gone: it is the link that is at fault, and not a line.
    let link = Link::read(&link).unwrap();
    folder.write(
        FULL.replace("id = \"before\"", "id = \"earlier\"")
            .replace("state = \"before\"", "state = \"earlier\"")
            .replace("state:before", "state:earlier"),
    );
    let faults = Exhibit::read_with(&folder.exhibit, Some(&link)).unwrap_err();
    let message = faults.to_string();
    assert!(
        message.starts_with("--link.state: found \"before\""),
        "{message}"
    );
    assert_eq!(faults.iter().count(), 1);
}

const LIKE: &str = "[exhibit]\ntitle = \"One\"\n[[drawing]]\nid = \"sheet\"\nsize_mm = [285, 194]\n\
    recto.albedo = \"recto.png\"\n[[scene]]\nid = \"a\"\n[[scene]]\nid = \"b\"\nlike = \"a\"\n";

#[test]
fn a_scene_that_another_is_like_is_not_replaced_under_it() {
    let folder = Folder::with(LIKE);
    let exhibit = read(&folder);
    let mut scene = exhibit.scenes[0].clone();
    scene.camera.tilt = Degrees(30.0);
    let words = refused(&exhibit, &scene, "a");
    assert!(words.contains("\"b\""), "{words}");
    assert_eq!(text(&folder), LIKE);
    // Beside it, it changes nothing.
    saved(&folder, &exhibit, &called(&scene, "c"));
}

#[test]
fn categories_of_an_overlay_that_is_off_are_no_part_of_a_view() {
    let folder = Folder::with(LIKE);
    let exhibit = read(&folder);
    let mut scene = called(&exhibit.scenes[0], "c");
    scene.categories.insert(0, vec![0]);
    draft(&exhibit, &scene, "c").write().unwrap();
    let (_, again) = read(&folder)
        .scene("c")
        .map(|(i, s)| (i, s.clone()))
        .unwrap();
    assert!(again.categories.is_empty());
    scene.categories.clear();
    assert_eq!(again.camera, scene.camera);
}
