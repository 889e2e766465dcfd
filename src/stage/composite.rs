//! One picture of those of two members of a comparison, or of one that is enhanced: each is drawn
//! into an image of its own, and a last pass puts them together.

use bevy::{
    asset::RenderAssetUsages,
    camera::{
        RenderTarget,
        visibility::{NoFrustumCulling, RenderLayers},
    },
    ecs::system::SystemParam,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat, TextureUsages},
};

use super::{Arranged, Shown, camera::camera_bundle, legend::DIFFERENCE_COLOURS};
use crate::{
    manifest::exhibit::{Comparison, Scene},
    sheet::composite::{CompositeMaterial, CompositeUniform},
};

/// The members' pictures: exact enough for differences of a hundredth of a ΔE00.
const FORMAT: TextureFormat = TextureFormat::Rgba32Float;
/// Colours of the scale of differences, between which the shader goes straight.
const SCALE_STEPS: u32 = 1024;
/// Before the camera of the picture itself, which is 0.
const FIRST_ORDER: isize = -4;
/// Frames until new images, cameras and pipelines draw.
const LEAVING_FRAMES: u32 = 4;
/// A sheet that is new draws nothing in its first frame; the one before it goes with the second.
const SHEET_FRAMES: u32 = 2;

/// Size of the picture in pixels.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize(pub UVec2);

/// The camera whose picture this is.
#[derive(Component)]
pub struct PictureCamera;

/// Draws one member's picture.
#[derive(Component)]
pub struct MemberCamera;

/// Goes some frames later, when what takes its place has reached the picture.
#[derive(Component, Clone, Copy, Debug)]
pub struct Retired(u32);

impl Retired {
    /// A sheet in whose place another one lies.
    pub fn sheet() -> Self {
        Self(SHEET_FRAMES)
    }

    /// A sheet, or a last pass, over which a new pass is built.
    pub fn under_last_pass() -> Self {
        Self(LEAVING_FRAMES)
    }
}

/// Whether pictures are put together for `scene`: its sheets are drawn as plain light then.
pub fn is_composite(scene: &Scene) -> bool {
    let combines = |comparison: &Comparison| comparison.mode.combines();
    scene.compare.as_ref().is_some_and(combines) || scene.enhance.is_of_picture()
}

/// The layer that the sheets of member `k` are drawn on.
pub fn layer_of(k: usize, composite: bool) -> RenderLayers {
    RenderLayers::layer(if composite { k + 1 } else { 0 })
}

/// What is put together, while anything is.
#[derive(Resource, Default)]
pub struct Composite {
    size: UVec2,
    pictures: Vec<Handle<Image>>,
    entities: Vec<Entity>,
    material: Option<Handle<CompositeMaterial>>,
    fresh: bool,
}

impl Composite {
    /// Whether something was built in this frame: it takes some frames to reach the picture.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }
}

/// What it is made from.
#[derive(SystemParam)]
pub struct Workshop<'w> {
    images: ResMut<'w, Assets<Image>>,
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<CompositeMaterial>>,
}

/// Brings the last pass in line with what stands on the stage.
pub fn compose(
    mut commands: Commands,
    (shown, arranged, size): (Res<Shown>, Res<Arranged>, Option<Res<PictureSize>>),
    mut composite: ResMut<Composite>,
    mut workshop: Workshop,
) {
    if composite.fresh {
        composite.fresh = false;
    }
    // Until its maps are there, the last picture stays.
    if !arranged.is_settled() {
        return;
    }
    let count = match &shown.scene.compare {
        _ if !is_composite(&shown.scene) => 0,
        Some(comparison) if comparison.mode.combines() => 2,
        _ => 1,
    };
    let size = size.map_or(UVec2::ONE, |size| size.0.max(UVec2::ONE));
    if composite.pictures.len() != count || (composite.size != size && count > 0) {
        for entity in composite.entities.drain(..) {
            let mut entity = commands.entity(entity);
            // Two last passes would cover each other.
            if count == 0 {
                entity.insert(Retired::under_last_pass());
            } else {
                entity.despawn();
            }
        }
        *composite = Composite {
            size,
            fresh: true,
            ..Composite::default()
        };
        if count > 0 {
            build(
                &mut commands,
                &mut composite,
                &mut workshop,
                count,
                arranged.is_display(),
            );
        }
    }
    let uniform = CompositeUniform::of(&shown.scene);
    if let Some(handle) = &composite.material
        && workshop
            .materials
            .get(handle)
            .is_some_and(|material| material.composite != uniform)
        && let Some(mut material) = workshop.materials.get_mut(handle)
    {
        material.composite = uniform;
    }
}

fn build(
    commands: &mut Commands,
    composite: &mut Composite,
    workshop: &mut Workshop,
    count: usize,
    display: bool,
) {
    for k in 0..count {
        let picture = workshop.images.add(picture(composite.size));
        let camera = commands.spawn((
            MemberCamera,
            camera_bundle(FIRST_ORDER + k as isize),
            RenderTarget::Image(picture.clone().into()),
            layer_of(k, true),
        ));
        composite.entities.push(camera.id());
        composite.pictures.push(picture);
    }
    let [first, second] = [0, count - 1].map(|k| composite.pictures[k].clone());
    let material = workshop.materials.add(CompositeMaterial {
        composite: CompositeUniform::default(),
        first,
        second,
        scale: workshop.images.add(scale()),
        display,
    });
    let whole = commands.spawn((
        Mesh3d(workshop.meshes.add(Rectangle::new(2.0, 2.0))),
        MeshMaterial3d(material.clone()),
        NoFrustumCulling,
    ));
    composite.entities.push(whole.id());
    composite.material = Some(material);
}

/// Lets go of what was replaced.
pub fn retire(mut commands: Commands, mut retired: Query<(Entity, &mut Retired)>) {
    for (entity, mut retired) in &mut retired {
        retired.0 = retired.0.saturating_sub(1);
        if retired.0 == 0 {
            commands.entity(entity).despawn();
        }
    }
}

/// The members' cameras draw when the picture's own does.
pub fn follow(
    whole: Query<&Camera, (With<PictureCamera>, Without<MemberCamera>)>,
    mut members: Query<&mut Camera, With<MemberCamera>>,
) {
    let active = whole.iter().any(|camera| camera.is_active);
    for mut camera in &mut members {
        if camera.is_active != active {
            camera.is_active = active;
        }
    }
}

fn picture(size: UVec2) -> Image {
    let mut image = Image::new_uninit(
        extent(size),
        TextureDimension::D2,
        FORMAT,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.usage |=
        TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    image
}

fn scale() -> Image {
    let texels = (0..SCALE_STEPS).flat_map(|i| {
        let at = f64::from(i) / f64::from(SCALE_STEPS - 1);
        let [r, g, b] = DIFFERENCE_COLOURS.colour(at).map(|v| v as f32);
        [r, g, b, 1.0].map(f32::to_le_bytes).into_iter().flatten()
    });
    Image::new(
        extent(UVec2::new(SCALE_STEPS, 1)),
        TextureDimension::D2,
        texels.collect(),
        FORMAT,
        RenderAssetUsages::RENDER_WORLD,
    )
}

fn extent(size: UVec2) -> Extent3d {
    Extent3d {
        width: size.x,
        height: size.y,
        depth_or_array_layers: 1,
    }
}
