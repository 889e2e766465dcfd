use std::{fs, path::Path};

use glam::DVec2;

use super::*;
use crate::manifest::LampKind;
use crate::{maps::encode, units::Degrees};

const MANIFEST: &str = r##"
[[drawing]]
id = "landscape"
size_mm = [200, 100]
recto.albedo = "a.png"
verso = { albedo = "a.png", register = { flip = "horizontal" } }

[[drawing.state]]
id = "before"
recto.albedo = "a.png"

[[drawing.overlay]]
id = "infrared"
kind = "picture"
file = "a.png"

[[drawing.overlay]]
id = "stains"
side = "verso"
kind = "picture"
file = "a.png"

[[drawing]]
id = "study"
size_mm = [50, 80]
recto.albedo = "a.png"

[[lamp]]
id = "window"
kind = "distant"
lux_at_sheet = 100
elevation_deg = 40
azimuth_deg = 0

[[lamp]]
id = "ring"
kind = "disc"
nits = 300
diameter_mm = 80
position_mm = [0, 0, 500]

[[scene]]
id = "near"
drawing = "landscape"
overlays = ["infrared"]
camera = { centre_mm = [20, 30], width_mm = 40, tilt_deg = 10 }

[[scene]]
id = "back"
drawing = "landscape"
side = "verso"
"##;

fn exhibit() -> Exhibit {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("exhibit.toml"), MANIFEST).unwrap();
    encode::save_png_grey8(&folder.path().join("a.png"), 2, 2, &[0, 1, 2, 3], None).unwrap();
    Exhibit::read(folder.path()).unwrap().0
}

fn applied(overrides: Overrides) -> (Exhibit, Scene) {
    overrides.apply(exhibit(), 1000).unwrap()
}

fn faults(overrides: Overrides) -> Vec<String> {
    let faults = overrides.apply(exhibit(), 1000).unwrap_err();
    assert!(
        faults
            .iter()
            .all(|fault| fault.file.is_none() && fault.place.is_none())
    );
    faults.iter().map(ToString::to_string).collect()
}

fn text(text: &str) -> Option<String> {
    Some(text.to_owned())
}

#[test]
fn without_options_the_first_scene_is_itself() {
    let (changed, scene) = applied(Overrides::default());
    assert_eq!(scene, changed.scenes[0]);
}

#[test]
fn another_drawing_is_seen_whole() {
    let (exhibit, scene) = applied(Overrides {
        drawing: text("study"),
        ..Overrides::default()
    });
    assert_eq!(exhibit.drawing_of(&scene).id, "study");
    assert_eq!(scene.camera, Camera::whole_sheet(DVec2::new(50.0, 80.0)));
    assert!(scene.overlays.is_empty());
    let (_, scene) = applied(Overrides {
        scene: text("back"),
        drawing: text("landscape"),
        ..Overrides::default()
    });
    assert_eq!(scene.id, "back");
}

#[test]
fn the_camera_stays_over_the_same_place_when_the_side_changes() {
    let (_, scene) = applied(Overrides {
        side: Some(SideName::Verso),
        overlays: vec!["stains=0.5".into()],
        state: text("before"),
        language: text("PT-br"),
        ..Overrides::default()
    });
    assert_eq!(scene.camera.centre_mm, DVec2::new(180.0, 30.0));
    assert_eq!(scene.camera.width_mm, 40.0);
    assert_eq!(scene.overlays, [(1, 0.5)]);
    assert_eq!(scene.state, Some(0));
    assert_eq!(scene.language, text("pt-BR"));
}

#[test]
fn lamps_are_named_or_described() {
    let (exhibit, scene) = applied(Overrides {
        lamps: vec![
            "kind=spot,candela=100,position_mm=0x-10x600,hotspot_deg=5,falloff_deg=9".into(),
            "window".into(),
        ],
        ..Overrides::default()
    });
    assert_eq!(scene.lamps, [2, 0]);
    let LampKind::Spot { position_mm, .. } = exhibit.lamps[2].kind else {
        panic!("{:?}", exhibit.lamps[2]);
    };
    assert_eq!(position_mm.to_array(), [0.0, -10.0, 600.0]);
}

#[test]
fn cameras_are_described_or_true_to_size() {
    let camera = |spec: &str| {
        applied(Overrides {
            camera: text(spec),
            ..Overrides::default()
        })
        .1
        .camera
    };
    let described = camera("centre_mm=92x60,width_mm=80,tilt_deg=30,distance_mm=500");
    assert_eq!(described.centre_mm, DVec2::new(92.0, 60.0));
    assert_eq!((described.width_mm, described.tilt), (80.0, Degrees(30.0)));
    assert_eq!(described.distance_mm, Some(500.0));
    assert_eq!(camera("centre_mm=[92, 60]").centre_mm, described.centre_mm);
    let true_size = camera("true-size@100");
    assert!((true_size.width_mm - 254.0).abs() < 1e-9);
    assert_eq!(true_size.centre_mm, DVec2::new(20.0, 30.0));
    assert_eq!(true_size.tilt, Degrees(10.0));
    let moved = camera("true-size@100,centre_mm=1x2");
    assert!((moved.width_mm - 254.0).abs() < 1e-9);
    assert_eq!(moved.centre_mm, DVec2::new(1.0, 2.0));
}

#[test]
fn all_faults_are_found_at_once() {
    let found = faults(Overrides {
        state: text("befor"),
        overlays: vec!["infraed".into(), "stains".into(), "infrared=2".into()],
        lamps: vec![
            "windw".into(),
            "rin".into(),
            "kind=distant,lux_at_sheet=1,elevation_deg=95,azimut_deg=0".into(),
        ],
        camera: text("width_mm=0,true-size@x"),
        language: text("e"),
        ..Overrides::default()
    });
    let begins = |path: &str| found.iter().filter(|fault| fault.starts_with(path)).count();
    assert_eq!(begins("--lamp[0]"), 1, "{found:#?}");
    assert_eq!(begins("--lamp[1]"), 1, "{found:#?}");
    assert_eq!(begins("--lamp[2]"), 2, "{found:#?}");
    assert_eq!(begins("--language"), 1, "{found:#?}");
}

#[test]
fn faults_say_what_is_there_and_what_was_meant() {
    let cases: [(Overrides, &[&str]); 10] = [
        (
            Overrides {
                scene: text("neer"),
                ..Overrides::default()
            },
            &[
                "--scene: found \"neer\"; allowed: the id of a scene: \"near\" or \"back\"; did \
               you mean \"near\"?",
            ],
        ),
        (
            Overrides {
                drawing: text("x"),
                ..Overrides::default()
            },
            &[
                "--drawing: found \"x\"; allowed: the id of a drawing: \"landscape\" or \
               \"study\"; correct it",
            ],
        ),
        (
            Overrides {
                state: text("befor"),
                ..Overrides::default()
            },
            &[
                "--state: found \"befor\"; allowed: the id of a state: \"before\" or \"none\"; \
               did you mean \"before\"?",
            ],
        ),
        (
            Overrides {
                overlays: vec!["stains".into()],
                ..Overrides::default()
            },
            &[
                "--overlay: found \"stains\", an overlay of the verso; allowed: overlays of the \
               side that is shown; add --side verso",
            ],
        ),
        (
            Overrides {
                overlays: vec!["infrared=2".into(), "infrared".into(), "infrared=1".into()],
                ..Overrides::default()
            },
            &[
                "--overlay[0].opacity: found 2; allowed: a number from 0 to 1; write a number \
                 within this range",
                "--overlay[2]: found \"infrared\" a second time; allowed: each overlay once; \
                 remove one of the two",
            ],
        ),
        (
            Overrides {
                camera: text("true-size@0"),
                ..Overrides::default()
            },
            &[
                "--camera: found \"true-size@0\"; allowed: true-size@ and a number from 10 to \
               2000; write how many pixels the display has in an inch",
            ],
        ),
        (
            Overrides {
                camera: text("true-size@96,true-size@97,width_mm=3"),
                ..Overrides::default()
            },
            &[
                "--camera: found \"true-size@97\" as well; allowed: one resolution; remove one of \
                 the two",
                "--camera: found width_mm together with true-size@; allowed: one of them; \
                 remove one of the two",
            ],
        ),
        (
            Overrides {
                enhance: text(""),
                ..Overrides::default()
            },
            &[
                "--enhance: found nothing; allowed: key=value,key=value…; write the keys that the \
                 manifest has, such as exaggerate=3",
            ],
        ),
        (
            Overrides {
                overlays: vec!["infrared:".into()],
                ..Overrides::default()
            },
            &[
                "--overlay: found \"infrared:\", a colon and no category; allowed: \
                 ID[=OPACITY][:CATEGORY,…]; name the categories to be shown, or leave the colon out to \
                 show all of them",
            ],
        ),
        (
            Overrides {
                compare: text("glass:state:before,state:none"),
                ..Overrides::default()
            },
            &[
                "--compare: found members that are not the two sides of the sheet; allowed: side:recto \
                 and side:verso for glass; change them, or choose another mode",
            ],
        ),
    ];
    for (overrides, expected) in cases {
        assert_eq!(faults(overrides), expected);
    }
}

#[test]
fn what_cannot_be_read_is_told_from_what_is_not_there() {
    let unreadable = |overrides: Overrides| {
        let faults = overrides.apply(exhibit(), 1000).unwrap_err();
        faults
            .iter()
            .map(|fault| fault.unreadable)
            .collect::<Vec<_>>()
    };
    let usual = Overrides::default;
    for overrides in [
        Overrides {
            transmitted: Some(2.0),
            ..usual()
        },
        Overrides {
            enhance: text("sharpen=2"),
            ..usual()
        },
        Overrides {
            enhance: text("stretch=[0.5,0.5]"),
            ..usual()
        },
        Overrides {
            overlays: vec!["infrared=2".into()],
            ..usual()
        },
        Overrides {
            lamps: vec!["kind=pint".into()],
            ..usual()
        },
        Overrides {
            camera: text("tilt"),
            ..usual()
        },
        Overrides {
            compare: text("curtain"),
            ..usual()
        },
        Overrides {
            compare: text("loupe:side:recto,side:verso,at=0.5"),
            ..usual()
        },
        Overrides {
            language: text("?"),
            ..usual()
        },
    ] {
        assert_eq!(unreadable(overrides.clone()), [true], "{overrides:?}");
    }
    for overrides in [
        Overrides {
            scene: text("x"),
            ..usual()
        },
        Overrides {
            state: text("x"),
            ..usual()
        },
        Overrides {
            overlays: vec!["x".into()],
            ..usual()
        },
        Overrides {
            lamps: vec!["x".into()],
            ..usual()
        },
        Overrides {
            compare: text("blend:state:x,side:recto"),
            ..usual()
        },
        Overrides {
            lamps: vec![
                "kind=distant,lux_at_sheet=1,elevation_deg=40,azimuth_deg=0,\
                                 spectrum={file=\"none.csv\"}"
                    .into(),
            ],
            ..usual()
        },
    ] {
        assert_eq!(unreadable(overrides.clone()), [false], "{overrides:?}");
    }
}

#[test]
fn hostile_specs_are_faults() {
    for spec in [
        "=",
        "a=",
        "[[[[",
        "kind=\"",
        "kind=point\nid=1",
        "k=1x",
        "𝕏=NaN",
        ",,,",
        "a=[b",
    ] {
        let lamp = faults(Overrides {
            lamps: vec![format!("{spec}=")],
            ..Overrides::default()
        });
        assert!(!lamp.is_empty(), "{spec}");
        let camera = faults(Overrides {
            camera: text(spec),
            ..Overrides::default()
        });
        assert!(!camera.is_empty(), "{spec}");
    }
    assert!(Exhibit::read(Path::new("/nonexistent")).is_err());
}
