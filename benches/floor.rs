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

use bevy::{
    asset::io::embedded::EmbeddedAssetRegistry,
    camera::{ScalingMode, visibility::NoFrustumCulling},
    diagnostic::{DiagnosticPath, DiagnosticsStore},
    ecs::system::SystemParamItem,
    mesh::MeshVertexBufferLayoutRef,
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::{
        diagnostic::RenderDiagnosticsPlugin,
        render_resource::{
            AsBindGroup, AsBindGroupError, BindGroupLayout, BindGroupLayoutEntry,
            BufferInitDescriptor, BufferUsages, Face, OwnedBindingResource,
            RenderPipelineDescriptor, SpecializedMeshPipelineError, UnpreparedBindGroup,
        },
        renderer::RenderDevice,
    },
    shader::ShaderRef,
};
use recto::{
    manifest::{
        Exhibit,
        exhibit::{Ambient, Camera as SceneCamera, LampKind, Scene, SideName},
    },
    optics::tier::Tier,
    sheet::PaperMaterial,
    shot::Darkroom,
    stage::{Shown, TABLE},
    units::{Degrees, Lux},
};

const SIZE: u32 = 1024;
/// Frames not counted, then counted, in each of the rounds.
const WARM_UP: usize = 4;
const FRAMES: usize = 12;
const ROUNDS: usize = 4;
const SPAN: &str = "render/main_opaque_pass_3d/elapsed_gpu";

type Anything = Box<dyn Error>;

/// The sheet's own bindings under the floor's shader.
#[derive(Asset, TypePath, Clone)]
struct Floor(PaperMaterial);

impl AsBindGroup for Floor {
    type Data = [bool; 3];
    type Param = <PaperMaterial as AsBindGroup>::Param;

    fn label() -> &'static str {
        "floor"
    }

    fn bind_group_data(&self) -> Self::Data {
        let maps = &self.0.maps;
        [
            maps.normal.is_some(),
            maps.roughness.is_some(),
            maps.outline.is_some(),
        ]
    }

    fn unprepared_bind_group(
        &self,
        layout: &BindGroupLayout,
        device: &RenderDevice,
        param: &mut SystemParamItem<'_, '_, Self::Param>,
        force_no_bindless: bool,
    ) -> Result<UnpreparedBindGroup, AsBindGroupError> {
        let mut group = self
            .0
            .unprepared_bind_group(layout, device, param, force_no_bindless)?;
        // The layout asks for the sheet's whole uniform; the floor reads its beginning.
        let paper = &self.0.paper;
        let mut values = paper.clip_from_local.to_cols_array().to_vec();
        values.extend(paper.lights[0].place.extend(0.0).to_array());
        values.extend(paper.albedo_place.row_u.extend(0.0).to_array());
        values.extend(paper.albedo_place.row_v.extend(0.0).to_array());
        values.resize(1024, 0.0);
        let contents: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let buffer = device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("floor"),
            contents: &contents,
            usage: BufferUsages::UNIFORM,
        });
        for (binding, resource) in group.bindings.iter_mut() {
            if *binding == 0 {
                *resource = OwnedBindingResource::Buffer(buffer.clone());
            }
        }
        Ok(group)
    }

    fn bind_group_layout_entries(device: &RenderDevice, flag: bool) -> Vec<BindGroupLayoutEntry> {
        PaperMaterial::bind_group_layout_entries(device, flag)
    }
}

impl Material for Floor {
    fn vertex_shader() -> ShaderRef {
        "embedded://bench/floor.wgsl".into()
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://bench/floor.wgsl".into()
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let names = ["NORMAL_MAP", "ROUGHNESS_MAP", "OUTLINE"];
        if let Some(fragment) = &mut descriptor.fragment {
            let wanted = names
                .iter()
                .zip(key.bind_group_data)
                .filter(|(_, present)| *present);
            fragment
                .shader_defs
                .extend(wanted.map(|(name, _)| (*name).into()));
        }
        let position = Mesh::ATTRIBUTE_POSITION.at_shader_location(0);
        let side = Mesh::ATTRIBUTE_UV_0.at_shader_location(1);
        descriptor.vertex.buffers = vec![layout.0.get_layout(&[position, side])?];
        descriptor.primitive.cull_mode = Some(Face::Back);
        Ok(())
    }
}

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
            let mut room = Darkroom::with(1, add_floor)?;
            let picture = room.take(shown.clone(), [SIZE, SIZE])?;
            // A picture taken is a room at rest: frames begin again.
            room.arrange(shown, [SIZE, SIZE])?;
            shaded = picture
                .pixels
                .iter()
                .filter(|pixel| **pixel != [TABLE; 3])
                .count();
            match case {
                Case::Floor => lay_floor(room.world())?,
                Case::Standard => lay_standard(room.world())?,
                Case::Tier(_) => {}
            }
            samples.extend(spans(&mut room)?);
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

fn add_floor(app: &mut App) {
    let path = "bench/floor.wgsl";
    app.world_mut()
        .resource_mut::<EmbeddedAssetRegistry>()
        .insert_asset(
            path.into(),
            Path::new(path),
            include_bytes!("floor.wgsl").as_slice(),
        );
    app.add_plugins((MaterialPlugin::<Floor>::default(), RenderDiagnosticsPlugin));
}

/// The sheet on the stage: entity, mesh and material.
fn sheet(world: &mut World) -> Result<(Entity, Mesh3d, PaperMaterial), Anything> {
    let mut query = world.query::<(Entity, &Mesh3d, &MeshMaterial3d<PaperMaterial>)>();
    let (entity, mesh, material) = query.single(world)?;
    let (mesh, material) = (mesh.clone(), material.0.clone());
    let materials = world.resource::<Assets<PaperMaterial>>();
    Ok((
        entity,
        mesh,
        materials
            .get(&material)
            .ok_or("the sheet has no material")?
            .clone(),
    ))
}

fn lay_floor(world: &mut World) -> Result<(), Anything> {
    let (entity, mesh, material) = sheet(world)?;
    world.despawn(entity);
    let floor = world.resource_mut::<Assets<Floor>>().add(Floor(material));
    world.spawn((mesh, MeshMaterial3d(floor), NoFrustumCulling));
    Ok(())
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

/// GPU milliseconds of the opaque pass over some frames.
fn spans(room: &mut Darkroom) -> Result<Vec<f64>, Anything> {
    let path = DiagnosticPath::new(SPAN);
    let mut spans = Vec::new();
    for frame in 0..WARM_UP + FRAMES {
        room.frame()?;
        let store = room.world().resource::<DiagnosticsStore>();
        let measured = store.get(&path).and_then(|diagnostic| diagnostic.value());
        if frame >= WARM_UP {
            spans.push(measured.ok_or("the device does not time its passes")?);
        }
    }
    Ok(spans)
}

/// Sorts, and gives the middle one.
fn median(samples: &mut [f64]) -> f64 {
    samples.sort_by(f64::total_cmp);
    samples[samples.len() / 2]
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
