//! What each tier costs against the floor, in one run: the landscape's recto at 1024², one
//! distant lamp, from the render pass's own GPU span. Then the time and memory from start to
//! the first picture. `cargo bench`; `RECTO_BENCH_EXHIBIT` names another exhibit.

use std::{
    error::Error,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::Arc,
    time::{Duration, Instant},
};

use bevy::{camera::ScalingMode, prelude::*, render::diagnostic::RenderDiagnosticsPlugin};
use recto::{
    cost::{Floor, FloorPlugin, median, sheet},
    manifest::{
        Exhibit,
        exhibit::{Ambient, Camera as SceneCamera, LampKind, Scene, SideName},
    },
    optics::tier::Tier,
    shot::Darkroom,
    stage::{Shown, TABLE},
    units::{Degrees, Lux},
};

const SIZE: u32 = 1024;
/// Frames not counted, then counted, in each of the rounds.
const WARM_UP: usize = 4;
const FRAMES: usize = 12;
const ROUNDS: usize = 4;

type Anything = Box<dyn Error>;

/// What is measured.
#[derive(Clone, Copy, PartialEq)]
enum Case {
    Floor,
    Tier(Tier),
    Standard,
}

impl Case {
    const ALL: [Self; 6] = [
        Self::Floor,
        Self::Tier(Tier::Lambert),
        Self::Tier(Tier::Draft),
        Self::Tier(Tier::Gallery),
        Self::Tier(Tier::Study),
        Self::Standard,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Floor => "the floor",
            Self::Tier(tier) => tier.name(),
            Self::Standard => "StandardMaterial",
        }
    }
}

fn main() -> Result<(), Anything> {
    let folder = std::env::var_os("RECTO_BENCH_EXHIBIT").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/exhibits/landscape")),
        PathBuf::from,
    );
    let (mut exhibit, _) = Exhibit::read(&folder)?;
    exhibit.lamps.truncate(1);
    exhibit.lamps[0].kind = LampKind::Distant {
        illuminance: Lux(1000.0),
        elevation: Degrees(45.0),
        azimuth: Degrees(135.0),
    };
    let scene = standard_scene(&exhibit);
    let exhibit = Arc::new(exhibit);
    let mut samples: Vec<Vec<f64>> = vec![Vec::new(); Case::ALL.len()];
    let mut shaded = 0;
    for _ in 0..ROUNDS {
        for (case, samples) in Case::ALL.into_iter().zip(&mut samples) {
            let tier = if let Case::Tier(tier) = case {
                tier
            } else {
                Tier::Gallery
            };
            let shown = Shown::at_rest(exhibit.clone(), scene.clone(), tier, 1.0);
            let mut room = Darkroom::with(1, |app| {
                app.add_plugins((FloorPlugin, RenderDiagnosticsPlugin));
            })?;
            let picture = room.take(shown.clone(), [SIZE, SIZE])?;
            // A picture taken is a room at rest: frames begin again.
            room.arrange(shown, [SIZE, SIZE])?;
            shaded = picture
                .pixels
                .iter()
                .filter(|pixel| **pixel != [TABLE; 3])
                .count();
            match case {
                Case::Floor => Floor::lay(room.world())?,
                Case::Standard => lay_standard(room.world())?,
                Case::Tier(_) => {}
            }
            samples.extend(recto::cost::spans(&mut room, WARM_UP, FRAMES)?);
        }
    }
    println!(
        "{} at {SIZE}², one distant lamp, {shaded} shaded pixels",
        folder.display()
    );
    println!(
        "{:18} {:>9} {:>9} {:>9} {:>7}",
        "", "min ms", "median ms", "ns/pixel", "ratio"
    );
    let floor = median(&mut samples[0]);
    for (case, samples) in Case::ALL.into_iter().zip(&mut samples) {
        let middle = median(samples);
        println!(
            "{:18} {:9.3} {:9.3} {:9.2} {:7.2}",
            case.name(),
            samples[0],
            middle,
            middle * 1e6 / shaded as f64,
            middle / floor
        );
    }
    first_picture(&folder)
}

/// The whole recto, looked at straight, filling the square's width.
fn standard_scene(exhibit: &Exhibit) -> Scene {
    let mut scene = exhibit.scenes[0].clone();
    let size = exhibit.drawings[scene.drawing].size_mm;
    scene.side = SideName::Recto;
    scene.state = None;
    scene.overlays.clear();
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
