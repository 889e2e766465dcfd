//! What each tier costs against the floor, in one run: the landscape's recto at 1024², one
//! distant lamp, from the render pass's own GPU span; what a further lamp, the relief's shadows, a
//! sampled rectangle and light through the sheet add to a tier; and what the study tier costs on
//! bare paper beside a shader written by hand for that alone. Then what whole frames of fewer pixels take, and
//! the time and memory from start to the first picture. `cargo bench --bench floor`; names of cases after `--` measure these alone
//! and what their ratios are to; `RECTO_BENCH_EXHIBIT` names another exhibit.

mod hand;

use std::{
    error::Error,
    f64::consts::SQRT_2,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::Arc,
    time::{Duration, Instant},
};

use bevy::{camera::ScalingMode, prelude::*, render::diagnostic::RenderDiagnosticsPlugin};
use glam::{DVec2, DVec3};
use recto::{
    cost::{Floor, FloorPlugin, least, median, sheet},
    manifest::{
        Exhibit,
        exhibit::{
            Ambient, Camera as SceneCamera, CompareMode, Comparison, Lamp, LampKind, Member, Scene,
            SideName, Surface,
        },
    },
    optics::tier::Tier,
    shot::{Darkroom, Picture},
    stage::{Arranged, Shown, TABLE, fineness::Fineness},
    units::{Degrees, Lux, Nits},
};

const SIZE: u32 = 1024;
/// Frames not counted, then counted, in each of the rounds.
const WARM_UP: usize = 4;
const FRAMES: usize = 12;
const ROUNDS: usize = 4;

/// Of a perfect diffuser's light: the shader by hand is to draw the same picture.
const ALIKE: f32 = 1e-3;

type Anything = Box<dyn Error>;

/// What lies on the stage.
#[derive(Clone, Copy, PartialEq)]
enum Sheet {
    Floor,
    Tier(Tier),
    Standard,
    ByHand,
}

/// How it is lit, and what of it there is.
#[derive(Clone, Copy, PartialEq)]
enum Setting {
    /// One distant lamp at 45°.
    Plain,
    TwoLamps,
    /// The lamp at 10°, where the relief shades itself.
    Raking,
    Rectangle,
    LightTable,
    /// Two states of it under a curtain, and beside each other.
    Curtain,
    SideBySide,
    /// From as far away that the sheet fills as many pixels as both do beside each other.
    Farther,
    /// A flat side with a picture and nothing else.
    PaperAlone,
}

struct Case {
    name: &'static str,
    sheet: Sheet,
    setting: Setting,
    /// The case that its ratio is to.
    to: usize,
}

const fn case(name: &'static str, sheet: Sheet, setting: Setting, to: usize) -> Case {
    Case {
        name,
        sheet,
        setting,
        to,
    }
}

const GALLERY: Sheet = Sheet::Tier(Tier::Gallery);
const STUDY: Sheet = Sheet::Tier(Tier::Study);
/// Places of what others are measured by.
const OF_FLOOR: usize = 0;
const OF_GALLERY: usize = 3;
const OF_STUDY: usize = 4;
const OF_HAND: usize = 14;
const OF_FARTHER: usize = 17;
const CASES: [Case; 19] = [
    case("the floor", Sheet::Floor, Setting::Plain, OF_FLOOR),
    case(
        "lambert",
        Sheet::Tier(Tier::Lambert),
        Setting::Plain,
        OF_FLOOR,
    ),
    case("draft", Sheet::Tier(Tier::Draft), Setting::Plain, OF_FLOOR),
    case("gallery", GALLERY, Setting::Plain, OF_FLOOR),
    case("study", STUDY, Setting::Plain, OF_FLOOR),
    case(
        "StandardMaterial",
        Sheet::Standard,
        Setting::Plain,
        OF_FLOOR,
    ),
    case("gallery, two lamps", GALLERY, Setting::TwoLamps, OF_GALLERY),
    case("study, two lamps", STUDY, Setting::TwoLamps, OF_STUDY),
    case("gallery, shadows", GALLERY, Setting::Raking, OF_GALLERY),
    case("study, shadows", STUDY, Setting::Raking, OF_STUDY),
    case(
        "gallery, rectangle",
        GALLERY,
        Setting::Rectangle,
        OF_GALLERY,
    ),
    case("study, rectangle", STUDY, Setting::Rectangle, OF_STUDY),
    case("gallery, table", GALLERY, Setting::LightTable, OF_GALLERY),
    case("study, table", STUDY, Setting::LightTable, OF_STUDY),
    case("paper by hand", Sheet::ByHand, Setting::PaperAlone, OF_HAND),
    case("study, paper", STUDY, Setting::PaperAlone, OF_HAND),
    case("gallery, curtain", GALLERY, Setting::Curtain, OF_GALLERY),
    case("gallery, farther", GALLERY, Setting::Farther, OF_FARTHER),
    case(
        "gallery, side by side",
        GALLERY,
        Setting::SideBySide,
        OF_FARTHER,
    ),
];

fn main() -> Result<(), Anything> {
    let folder = std::env::var_os("RECTO_BENCH_EXHIBIT").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/exhibits/landscape")),
        PathBuf::from,
    );
    let (exhibit, _) = Exhibit::read(&folder)?;
    let names: Vec<String> = std::env::args().skip(1).collect();
    let named = |case: &Case| names.iter().any(|name| name == case.name);
    // Cargo passes a flag of its own.
    let is_all = names.iter().all(|name| name.starts_with("--"));
    let wanted: Vec<bool> = (0..CASES.len())
        .map(|i| {
            is_all
                || CASES
                    .iter()
                    .enumerate()
                    .any(|(k, c)| named(c) && (k == i || c.to == i))
        })
        .collect();
    if let Some(name) = names.iter().find(|name| {
        !name.starts_with("--") && !CASES.iter().any(|case| case.name == name.as_str())
    }) {
        let known: Vec<&str> = CASES.iter().map(|case| case.name).collect();
        return Err(format!("no case is named {name}; there are {}", known.join("; ")).into());
    }
    let mut samples: Vec<Vec<f64>> = CASES.iter().map(|_| Vec::new()).collect();
    let mut shaded = vec![0; CASES.len()];
    for _ in 0..ROUNDS {
        for (i, case) in CASES.iter().enumerate().filter(|(i, _)| wanted[*i]) {
            let tier = match case.sheet {
                Sheet::Tier(tier) => tier,
                Sheet::Floor | Sheet::Standard => Tier::Gallery,
                Sheet::ByHand => Tier::Study,
            };
            let (exhibit, scene) = case.setting.of(&exhibit);
            let shown = Shown::at_rest(Arc::new(exhibit), scene, tier, 1.0);
            let mut room = Darkroom::with(1, |app| {
                app.add_plugins((FloorPlugin, hand::HandPlugin, RenderDiagnosticsPlugin));
                // As in a window.
                app.world_mut().resource_mut::<Arranged>().clip(true);
            })?;
            let picture = room.take(shown.clone(), [SIZE, SIZE])?;
            // A picture taken is a room at rest: frames begin again.
            room.arrange(shown.clone(), [SIZE, SIZE])?;
            let is_shaded = |pixel: &&[f32; 3]| **pixel != [TABLE; 3];
            shaded[i] = picture.pixels.iter().filter(is_shaded).count();
            match case.sheet {
                Sheet::Floor => Floor::lay(room.world())?,
                Sheet::Standard => lay_standard(room.world())?,
                Sheet::ByHand => hand::lay(room.world())?,
                Sheet::Tier(_) => {}
            }
            samples[i].extend(recto::cost::spans(&mut room, WARM_UP, FRAMES)?);
            if case.sheet == Sheet::ByHand {
                let by_hand = room.take(shown, [SIZE, SIZE])?;
                let off = difference(&by_hand, &picture);
                if off > ALIKE {
                    return Err(format!("the shader by hand differs by {off}").into());
                }
            }
        }
    }
    println!("{} at {SIZE}²", folder.display());
    println!(
        "{:18} {:>9} {:>9} {:>9} {:>7} {:>7}  of",
        "", "least ms", "median ms", "ns/pixel", "least", "median"
    );
    let all: Vec<[f64; 2]> = samples
        .iter_mut()
        .zip(&wanted)
        .map(|(samples, wanted)| {
            if *wanted {
                [least(samples), median(samples)]
            } else {
                [f64::NAN; 2]
            }
        })
        .collect();
    for (i, case) in CASES.iter().enumerate().filter(|(i, _)| wanted[*i]) {
        let ([low, middle], [of_low, of_middle]) = (all[i], all[case.to]);
        println!(
            "{:18} {low:9.3} {middle:9.3} {:9.2} {:7.2} {:7.2}  {}",
            case.name,
            low * 1e6 / shaded[i] as f64,
            low / of_low,
            middle / of_middle,
            CASES[case.to].name
        );
    }
    if is_all {
        coarser(&exhibit)?;
        first_picture(&folder)?;
    }
    Ok(())
}

/// What a whole frame takes, of which the pass is a part, where fewer pixels are drawn and brought to all
/// of them.
fn coarser(exhibit: &Exhibit) -> Result<(), Anything> {
    const PICTURE: [u32; 2] = [1920, 1080];
    const SHARES: [f32; 4] = [1.0, 0.8, 0.65, 0.5];
    println!(
        "a whole frame at {} × {}, by the share of pixels a side",
        PICTURE[0], PICTURE[1]
    );
    for tier in [Tier::Draft, Tier::Gallery, Tier::Study] {
        let (exhibit, scene) = Setting::Plain.of(exhibit);
        let shown = Shown::at_rest(Arc::new(exhibit), scene, tier, 1.0);
        let mut room = Darkroom::with(1, |_| {})?;
        room.arrange(shown, PICTURE)?;
        let mut samples = SHARES.map(|_| Vec::new());
        for _ in 0..ROUNDS {
            for (share, samples) in SHARES.into_iter().zip(&mut samples) {
                room.world().insert_resource(Fineness(share));
                for frame in 0..WARM_UP + FRAMES {
                    let began = Instant::now();
                    room.frame()?;
                    if frame >= WARM_UP {
                        samples.push(began.elapsed().as_secs_f64() * 1e3);
                    }
                }
            }
        }
        let all = least(&samples[0]);
        for (share, samples) in SHARES.into_iter().zip(&samples) {
            let low = least(samples);
            let name = tier.name();
            println!("{name:18} {share:9.2} {low:9.3} ms {:7.2}", low / all);
        }
    }
    Ok(())
}

/// The largest difference of a channel.
fn difference(a: &Picture, b: &Picture) -> f32 {
    let channels = |picture: &Picture| picture.pixels.clone().into_iter().flatten();
    channels(a)
        .zip(channels(b))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

impl Setting {
    /// The exhibit and the scene to be shown.
    fn of(self, exhibit: &Exhibit) -> (Exhibit, Scene) {
        let mut exhibit = exhibit.clone();
        let lamp = |kind| Lamp {
            kind,
            ..exhibit.lamps[0].clone()
        };
        let distant = |elevation: f64, azimuth: f64| {
            lamp(LampKind::Distant {
                illuminance: Lux(1000.0),
                elevation: Degrees(elevation),
                azimuth: Degrees(azimuth),
            })
        };
        exhibit.lamps = match self {
            Self::Plain | Self::PaperAlone | Self::Curtain | Self::SideBySide | Self::Farther => {
                vec![distant(45.0, 135.0)]
            }
            Self::TwoLamps => vec![distant(45.0, 135.0), distant(45.0, -135.0)],
            Self::Raking => vec![distant(10.0, 135.0)],
            Self::Rectangle => vec![lamp(LampKind::Rectangle {
                luminance: Nits(10_000.0),
                position_mm: DVec3::new(-300.0, 300.0, 400.0),
                aim_mm: DVec3::new(150.0, -100.0, 0.0),
                size_mm: DVec2::new(200.0, 100.0),
            })],
            Self::LightTable => vec![lamp(LampKind::LightTable {
                luminance: Nits(1000.0),
            })],
        };
        let mut scene = standard_scene(&exhibit);
        scene.lamps = (0..exhibit.lamps.len()).collect();
        let mode = match self {
            Self::Curtain => Some(CompareMode::Curtain),
            Self::SideBySide => Some(CompareMode::SideBySide),
            _ => None,
        };
        let states = || vec![Member::State(Some(0)), Member::State(Some(1))];
        scene.compare = mode.map(|mode| Comparison::new(mode, states()));
        if self == Self::Farther {
            scene.camera.width_mm *= SQRT_2;
        }
        if self == Self::PaperAlone {
            let drawing = &mut exhibit.drawings[scene.drawing];
            drawing.surface = Surface::Flat;
            drawing.outline = None;
            let side = &mut drawing.recto;
            side.media.clear();
            (side.normal, side.height, side.roughness) = (None, None, None);
        }
        (exhibit, scene)
    }
}

/// The whole recto, looked at straight, filling the square's width.
fn standard_scene(exhibit: &Exhibit) -> Scene {
    let mut scene = exhibit.scenes[0].clone();
    let size = exhibit.drawings[scene.drawing].size_mm;
    scene.side = SideName::Recto;
    scene.state = None;
    scene.overlays.clear();
    scene.compare = None;
    scene.lamps = vec![0];
    scene.ambient = Ambient {
        illuminance: Lux(0.0),
        ..scene.ambient
    };
    scene.camera = SceneCamera {
        centre_mm: size / 2.0,
        width_mm: size.x,
        tilt: Degrees(0.0),
        turn: Degrees(0.0),
        distance_mm: None,
    };
    scene
}

fn lay_standard(world: &mut World) -> Result<(), Anything> {
    let (entity, _, material) = sheet(world)?;
    world.despawn(entity);
    let size = material.paper.size;
    let mesh = Mesh::from(Rectangle::new(size.x, size.y)).with_generated_tangents()?;
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let standard = StandardMaterial {
        base_color_texture: material.maps.albedo,
        normal_map_texture: material.maps.normal,
        metallic_roughness_texture: material.maps.roughness,
        occlusion_texture: material.maps.outline,
        ..default()
    };
    let standard = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(standard);
    world.spawn((Mesh3d(mesh), MeshMaterial3d(standard)));
    world.spawn((
        DirectionalLight {
            illuminance: 1000.0,
            ..default()
        },
        Transform::from_xyz(-1.0, 1.0, 1.4).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    let mut cameras = world.query_filtered::<Entity, With<Camera3d>>();
    let camera = cameras.single(world)?;
    world.entity_mut(camera).insert((
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::Fixed {
                width: size.x,
                height: size.x,
            },
            ..OrthographicProjection::default_3d()
        }),
        Transform::from_xyz(0.0, 0.0, 500.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    Ok(())
}

/// From starting the program to its first picture at 1920 × 1080, and its peak memory.
fn first_picture(folder: &Path) -> Result<(), Anything> {
    let picture = tempfile::tempdir()?;
    let started = Instant::now();
    let mut child = Command::new(env!("CARGO_BIN_EXE_recto"))
        .arg("render")
        .arg(folder)
        .args(["--size", "1920x1080", "--out"])
        .arg(picture.path().join("first.png"))
        .stdout(Stdio::null())
        .spawn()?;
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut peak_kib = 0u64;
    let exit = loop {
        if let Ok(text) = std::fs::read_to_string(&status) {
            let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let kib = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
            peak_kib = peak_kib.max(kib.unwrap_or(0));
        }
        if let Some(exit) = child.try_wait()? {
            break exit;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    println!(
        "start to first picture at 1920 × 1080: {:.2} s, peak memory {} MiB ({exit})",
        started.elapsed().as_secs_f64(),
        peak_kib / 1024
    );
    Ok(())
}
