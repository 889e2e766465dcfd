//! Lamps where none should be: inside, behind and in the plane of the sheet.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use recto::{
    manifest::exhibit::LampKind,
    maps::encode::save_exr_rgb,
    optics::{lamp_units::point_intensity, tier::Tier},
    units::{Candela, Degrees, Nits},
};

use crate::room::{Fixture, darkroom, picture};

/// What a half float can hold, to which radiance is clamped.
const MOST: f32 = 65504.0;
/// Lamps that a curator may have meant, and those that no room has.
const LUMEN: [f64; 2] = [1e-3, 1e7];

fn manifest() -> String {
    let mut text = "[exhibit]\ntitle = \"Lamps\"\nexposure = { lux = 500 }\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [100, 100]\n\
         recto.albedo = { file = \"plain.exr\", encoding = \"linear\" }\n\
         [[lamp]]\nid = \"lamp\"\nkind = \"point\"\nlumen = 1\nposition_mm = [0, 0, 500]\n"
        .to_owned();
    for (id, camera) in [
        ("above", "width_mm = 90"),
        ("tilted", "width_mm = 20, tilt_deg = 60"),
    ] {
        text += &format!(
            "[[scene]]\nid = \"{id}\"\nlamps = [\"lamp\"]\n\
             camera = {{ centre_mm = [50, 50], {camera} }}\n"
        );
    }
    text
}

/// Lamps of every kind with a place, there, shining down; without size, and larger than the sheet.
fn kinds(lumen: f64, position_mm: DVec3) -> Vec<LampKind> {
    let intensity = Candela(point_intensity(lumen));
    let aim_mm = position_mm - DVec3::Z * 100.0;
    let mut all = vec![
        LampKind::Point {
            intensity,
            position_mm,
        },
        LampKind::Spot {
            intensity,
            position_mm,
            aim_mm,
            hotspot: Degrees(10.0),
            falloff: Degrees(10.0),
        },
        // Its aim is its place.
        LampKind::Spot {
            intensity,
            position_mm,
            aim_mm: position_mm,
            hotspot: Degrees(10.0),
            falloff: Degrees(60.0),
        },
    ];
    for size in [0.0, 20.0, 1e4] {
        let luminance = Nits(lumen * 1e3);
        all.push(LampKind::Rectangle {
            luminance,
            position_mm,
            aim_mm,
            size_mm: DVec2::splat(size),
        });
        all.push(LampKind::Disc {
            luminance,
            position_mm,
            aim_mm,
            diameter_mm: size,
        });
    }
    all
}

#[test]
fn lamps_inside_behind_and_in_the_plane_of_the_sheet_stay_sensible() {
    let fixture = Fixture::new(&manifest(), |folder| {
        save_exr_rgb(&folder.join("plain.exr"), 4, 4, &[[0.5, 0.25, 0.125]; 16]).expect("albedo");
    });
    let mut exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let places = [
        ("inside", DVec3::ZERO),
        ("just above", DVec3::Z * 1e-3),
        ("in the plane", DVec3::new(30.0, 0.0, 0.0)),
        ("beside", DVec3::new(200.0, 0.0, 0.0)),
        ("behind", DVec3::new(10.0, 0.0, -50.0)),
    ];
    for (place, position) in places {
        for lumen in LUMEN {
            for kind in kinds(lumen, position) {
                Arc::make_mut(&mut exhibit).lamps[0].kind = kind.clone();
                for tier in [Tier::Draft, Tier::Gallery, Tier::Study] {
                    for scene in &exhibit.scenes {
                        let frame = picture(&mut room, &exhibit, scene, tier, [6, 6]);
                        let values = || frame.pixels.iter().flatten();
                        let sound = |v: &f32| v.is_finite() && (0.0..=MOST).contains(v);
                        assert!(
                            values().all(sound),
                            "{tier}, {place}, {}: {kind:?}: {:?}",
                            scene.id,
                            frame.pixels
                        );
                        // Through the sheet only study sees, and dimly.
                        let most = values().copied().fold(0.0, f32::max);
                        let dark = position.z <= 0.0 && tier != Tier::Study;
                        assert!(
                            !dark || most == 0.0,
                            "{tier}, {place}: {kind:?} shines: {most}"
                        );
                    }
                }
            }
        }
    }
    // A lamp that is where it should be does shine.
    let kind = LampKind::Point {
        intensity: Candela(100.0),
        position_mm: DVec3::Z * 500.0,
    };
    Arc::make_mut(&mut exhibit).lamps[0].kind = kind;
    let scene = &exhibit.scenes[0];
    let frame = picture(&mut room, &exhibit, scene, Tier::Gallery, [6, 6]);
    assert!(frame.pixels.iter().flatten().all(|v| *v > 0.01));
}
