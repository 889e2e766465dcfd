//! One picture over several displays: drawn once, and shown by each display in its own colours, without
//! what lies under the frames between them.

use std::path::Path;

use bevy::{
    asset::{RenderAssetUsages, io::embedded::EmbeddedAssetRegistry},
    camera::RenderTarget,
    core_pipeline::tonemapping::Tonemapping,
    image::ImageSampler,
    prelude::*,
    render::render_resource::{
        AsBindGroup, Extent3d, ShaderType, TextureDimension, TextureFormat, TextureUsages,
    },
    shader::ShaderRef,
    window::{WindowMode, WindowPosition, WindowRef, WindowResolution},
};
use glam::{DMat3, DVec2};

use crate::{
    colour::srgb_decode,
    installation::{Correction, Pane, Tone, Wall},
    maps::{LATTICE_STEPS, Lattice},
};

/// Steps of a tone curve.
const STEPS: u32 = 4096;
/// The picture has no more pixels a side than graphics devices promise.
const LARGEST: f64 = 16384.0;
const SHADER: &str = include_str!("../../shaders/pane.wgsl");
const SHADER_PATH: &str = "embedded://recto/pane.wgsl";

/// The material of panes.
pub struct PanesPlugin;

impl Plugin for PanesPlugin {
    fn build(&self, app: &mut App) {
        let registry = app.world_mut().resource_mut::<EmbeddedAssetRegistry>();
        let path = "recto/pane.wgsl";
        registry.insert_asset(path.into(), Path::new(path), SHADER.as_bytes());
        app.add_plugins(UiMaterialPlugin::<PaneMaterial>::default());
    }
}

/// What one display shows.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
pub struct PaneMaterial {
    #[uniform(0)]
    pub pane: PaneUniform,
    #[texture(1)]
    #[sampler(2)]
    pub picture: Handle<Image>,
    #[texture(3, sample_type = "float", filterable = false)]
    pub tone: Handle<Image>,
    #[texture(4, dimension = "3d")]
    #[sampler(5)]
    pub table: Handle<Image>,
}

/// Twin of `Pane` in the shader.
#[derive(ShaderType, Clone, Copy, Debug)]
pub struct PaneUniform {
    pub part: Vec4,
    pub rows: [Vec4; 3],
    pub has_table: u32,
}

impl UiMaterial for PaneMaterial {
    fn fragment_shader() -> ShaderRef {
        SHADER_PATH.into()
    }
}

/// Size in pixels of the picture over the whole wall: as fine as its finest display.
pub fn picture_size(wall: &Wall) -> UVec2 {
    let finest = wall.displays.iter().map(|display| display.px_per_mm());
    let finest = finest.fold(DVec2::ZERO, DVec2::max);
    let size = (wall.size_mm() * finest).ceil();
    let size = size * (LARGEST / size.max_element()).min(1.0);
    size.as_uvec2().max(UVec2::ONE)
}

/// An image of that size, to be drawn into and shown from.
pub fn picture(size: UVec2) -> Image {
    let extent = Extent3d {
        width: size.x,
        height: size.y,
        depth_or_array_layers: 1,
    };
    let mut image = Image::new_fill(
        extent,
        TextureDimension::D2,
        &[0; 8],
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.usage |= TextureUsages::RENDER_ATTACHMENT;
    image
}

/// What shows a part of `picture` on a display.
pub fn material(
    images: &mut Assets<Image>,
    picture: &Handle<Image>,
    pane: &Pane,
    correction: &Correction,
) -> PaneMaterial {
    let identity = [Tone::Srgb, Tone::Srgb, Tone::Srgb];
    let (matrix, tone, table) = match correction {
        Correction::Curves { matrix, tone } => (*matrix, tone, blank_table()),
        Correction::Table(lattice) => (DMat3::IDENTITY, &identity, table_image(lattice)),
    };
    let part = [pane.of_picture.min, pane.of_picture.max].map(DVec2::as_vec2);
    PaneMaterial {
        pane: PaneUniform {
            part: Vec4::new(part[0].x, part[0].y, part[1].x, part[1].y),
            rows: [0, 1, 2].map(|k| matrix.row(k).as_vec3().extend(0.0)),
            has_table: u32::from(matches!(correction, Correction::Table(_))),
        },
        picture: picture.clone(),
        tone: images.add(tone_image(tone)),
        table: images.add(table),
    }
}

/// What a display with an sRGB surface is given for each light, so that its own values come out.
fn tone_image(tone: &[Tone; 3]) -> Image {
    let mut bytes = Vec::with_capacity(STEPS as usize * 16);
    for step in 0..STEPS {
        let light = (f64::from(step) / f64::from(STEPS - 1)).powi(2);
        for tone in tone {
            bytes.extend((srgb_decode(tone.value(light)) as f32).to_le_bytes());
        }
        bytes.extend(1f32.to_le_bytes());
    }
    let size = [STEPS, 1, 1];
    texture(
        size,
        TextureDimension::D2,
        bytes,
        TextureFormat::Rgba32Float,
    )
}

/// The values of a display over the square roots of light.
fn table_image(lattice: &Lattice) -> Image {
    let texels = lattice.values.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]);
    let halves = texels.flatten().map(half::f16::from_f32);
    table_of(
        LATTICE_STEPS as u32,
        halves.flat_map(half::f16::to_le_bytes).collect(),
    )
}

/// In the place of a table that nobody reads.
fn blank_table() -> Image {
    table_of(1, vec![0; 8])
}

fn table_of(steps: u32, bytes: Vec<u8>) -> Image {
    let mut image = texture(
        [steps; 3],
        TextureDimension::D3,
        bytes,
        TextureFormat::Rgba16Float,
    );
    image.sampler = ImageSampler::linear();
    image
}

fn texture(
    [width, height, depth_or_array_layers]: [u32; 3],
    dimension: TextureDimension,
    bytes: Vec<u8>,
    format: TextureFormat,
) -> Image {
    let extent = Extent3d {
        width,
        height,
        depth_or_array_layers,
    };
    let usage = RenderAssetUsages::RENDER_WORLD;
    Image::new(extent, dimension, bytes, format, usage)
}

/// The window over some displays, without a frame, where it lies on the desktop.
pub fn window(of: &crate::installation::WallWindow, title: &str) -> Window {
    let [x, y] = of.on_desktop.at;
    let [width, height] = of.on_desktop.size;
    Window {
        title: title.to_owned(),
        position: WindowPosition::At(IVec2::new(x, y)),
        resolution: WindowResolution::new(width, height).with_scale_factor_override(1.0),
        mode: WindowMode::Windowed,
        decorations: false,
        resizable: false,
        ..default()
    }
}

/// The camera of a window, and the panes in it.
pub fn hang(
    commands: &mut Commands,
    (window, order): (Entity, isize),
    panes: &[(Pane, Handle<PaneMaterial>)],
) {
    let camera = commands
        .spawn((
            Camera2d,
            Camera {
                order,
                clear_color: ClearColorConfig::Custom(Color::BLACK),
                ..default()
            },
            RenderTarget::Window(WindowRef::Entity(window)),
            Tonemapping::None,
            Msaa::Off,
        ))
        .id();
    hang_on(commands, camera, panes);
}

/// Panes before a camera.
pub fn hang_on(commands: &mut Commands, camera: Entity, panes: &[(Pane, Handle<PaneMaterial>)]) {
    for (pane, material) in panes {
        let [x, y] = pane.in_window.at.map(|v| Val::Px(v as f32));
        let [width, height] = pane.in_window.size.map(|v| Val::Px(v as f32));
        commands.spawn((
            UiTargetCamera(camera),
            Node {
                position_type: PositionType::Absolute,
                left: x,
                top: y,
                width,
                height,
                ..default()
            },
            MaterialNode(material.clone()),
        ));
    }
}
