//! A picture of fewer pixels, while one of all of them would come too slowly: drawn on a corner of the
//! target, brought to the whole of it, and sharpened by how much contrast there is (contrast-adaptive
//! sharpening, AMD FidelityFX, by Bevy). Words and controls are drawn over it with all their pixels.

use std::{collections::HashMap, path::Path};

use bevy::{
    anti_alias::contrast_adaptive_sharpening::{ContrastAdaptiveSharpening, cas},
    asset::io::embedded::EmbeddedAssetRegistry,
    camera::MainPassResolutionOverride,
    core_pipeline::{Core3d, Core3dSystems, FullscreenShader},
    ecs::query::QueryItem,
    prelude::*,
    render::{
        Render, RenderApp, RenderStartup, RenderSystems,
        camera::ExtractedCamera,
        extract_component::{
            ComponentUniforms, DynamicUniformIndex, ExtractComponent, ExtractComponentPlugin,
            UniformComponentPlugin,
        },
        render_resource::{
            BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries,
            CachedRenderPipelineId, ColorTargetState, ColorWrites, FilterMode, FragmentState,
            Operations, PipelineCache, RenderPassColorAttachment, RenderPassDescriptor,
            RenderPipelineDescriptor, Sampler, SamplerBindingType, SamplerDescriptor, ShaderStages,
            ShaderType, TextureFormat, TextureSampleType,
            binding_types::{sampler, texture_2d, uniform_buffer},
        },
        renderer::{RenderContext, RenderDevice, ViewQuery},
        sync_component::SyncComponent,
        view::{ExtractedView, ViewTarget},
    },
};

use super::composite::{PictureCamera, PictureSize};

const SHADER: &str = include_str!("../../shaders/upscale.wgsl");
const SHADER_PATH: &str = "embedded://recto/upscale.wgsl";
/// Of the sharpening, from 0 to 1: edges of pen strokes come back, and no bright seam runs along them.
const SHARPENING: f32 = 0.6;

/// The share of the picture's pixels, along each side, that the main pass draws; all of them at 1.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Fineness(pub f32);

impl Default for Fineness {
    fn default() -> Self {
        Self(1.0)
    }
}

impl Fineness {
    /// What is drawn of a picture of so many pixels.
    fn of(self, whole: UVec2) -> UVec2 {
        let share = if self.0.is_finite() { self.0 } else { 1.0 };
        let drawn = whole.as_vec2() * share.clamp(0.0, 1.0);
        drawn.ceil().as_uvec2().clamp(UVec2::ONE, whole)
    }
}

/// What a camera draws, in pixels.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drawn {
    part: UVec2,
    whole: UVec2,
    /// A part is wanted, though it may be all of a small picture.
    is_coarse: bool,
}

/// Twin of `Upscale` in the shader.
#[derive(Component, ShaderType, Clone, Copy, Debug)]
pub struct Upscale {
    drawn: Vec2,
    whole: Vec2,
}

/// Draws the picture as finely as [`Fineness`] says.
pub struct FinenessPlugin;

impl Plugin for FinenessPlugin {
    fn build(&self, app: &mut App) {
        let registry = app.world_mut().resource_mut::<EmbeddedAssetRegistry>();
        let path = "recto/upscale.wgsl";
        registry.insert_asset(path.into(), Path::new(path), SHADER.as_bytes());
        app.init_resource::<Fineness>()
            .add_plugins((
                ExtractComponentPlugin::<Drawn>::default(),
                UniformComponentPlugin::<Upscale>::default(),
            ))
            .add_systems(PostUpdate, follow);
        let Some(render) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render
            .add_systems(RenderStartup, set_up)
            .add_systems(Render, choose.in_set(RenderSystems::PrepareAssets))
            .add_systems(
                Core3d,
                bring_to_whole
                    .before(cas)
                    .in_set(Core3dSystems::PostProcess),
            );
    }
}

/// Tells the picture's camera how much it draws.
fn follow(
    mut commands: Commands,
    (fineness, size): (Res<Fineness>, Option<Res<PictureSize>>),
    cameras: Query<(Entity, Option<&Drawn>), With<PictureCamera>>,
) {
    let Some(size) = size else {
        return;
    };
    let whole = size.0.max(UVec2::ONE);
    let wanted = Drawn {
        part: fineness.of(whole),
        whole,
        is_coarse: *fineness != Fineness::default(),
    };
    for (camera, drawn) in &cameras {
        if drawn == Some(&wanted) {
            continue;
        }
        let mut camera = commands.entity(camera);
        camera.insert(wanted);
        if wanted.part == whole {
            camera.remove::<ContrastAdaptiveSharpening>();
        } else {
            camera.insert(ContrastAdaptiveSharpening {
                sharpening_strength: SHARPENING,
                ..default()
            });
        }
    }
}

impl SyncComponent for Drawn {
    type Target = (Drawn, Upscale, MainPassResolutionOverride);
}

impl ExtractComponent for Drawn {
    type QueryData = &'static Self;
    type QueryFilter = With<Camera>;
    type Out = (Drawn, Upscale);

    fn extract_component(drawn: QueryItem<Self::QueryData>) -> Option<Self::Out> {
        let upscale = Upscale {
            drawn: drawn.part.as_vec2(),
            whole: drawn.whole.as_vec2(),
        };
        Some((*drawn, upscale))
    }
}

/// How a part is brought to the whole.
#[derive(Resource)]
struct Pipelines {
    layout: BindGroupLayoutDescriptor,
    sampler: Sampler,
    made: HashMap<TextureFormat, CachedRenderPipelineId>,
}

fn set_up(mut commands: Commands, device: Res<RenderDevice>) {
    let entries = BindGroupLayoutEntries::sequential(
        ShaderStages::FRAGMENT,
        (
            texture_2d(TextureSampleType::Float { filterable: true }),
            sampler(SamplerBindingType::Filtering),
            uniform_buffer::<Upscale>(true),
        ),
    );
    commands.insert_resource(Pipelines {
        layout: BindGroupLayoutDescriptor::new("upscale", &entries),
        sampler: device.create_sampler(&SamplerDescriptor {
            mag_filter: FilterMode::Linear,
            ..default()
        }),
        made: HashMap::new(),
    });
}

/// A part is drawn only where it can be brought to the whole: as soon as one is wanted, everything for that
/// is made ready. A picture of all pixels waits for none of it.
fn choose(
    mut commands: Commands,
    mut pipelines: ResMut<Pipelines>,
    cache: Res<PipelineCache>,
    (assets, fullscreen): (Res<AssetServer>, Res<FullscreenShader>),
    views: Query<(Entity, &ExtractedView, &Drawn), With<ExtractedCamera>>,
) {
    for (view, extracted, drawn) in &views {
        if !drawn.is_coarse {
            commands.entity(view).remove::<MainPassResolutionOverride>();
            continue;
        }
        let format = extracted.target_format;
        let layout = pipelines.layout.clone();
        let pipeline = *pipelines.made.entry(format).or_insert_with(|| {
            cache.queue_render_pipeline(RenderPipelineDescriptor {
                label: Some("upscale".into()),
                layout: vec![layout],
                vertex: fullscreen.to_vertex_state(),
                fragment: Some(FragmentState {
                    shader: assets.load(SHADER_PATH),
                    targets: vec![Some(ColorTargetState {
                        format,
                        blend: None,
                        write_mask: ColorWrites::ALL,
                    })],
                    ..default()
                }),
                ..default()
            })
        });
        let is_ready = cache.get_render_pipeline(pipeline).is_some();
        let mut view = commands.entity(view);
        if drawn.part != drawn.whole && is_ready {
            view.insert(MainPassResolutionOverride(drawn.part));
        } else {
            view.remove::<MainPassResolutionOverride>();
        }
    }
}

fn bring_to_whole(
    view: ViewQuery<(
        &ViewTarget,
        &ExtractedView,
        &DynamicUniformIndex<Upscale>,
        &MainPassResolutionOverride,
    )>,
    (pipelines, cache): (Res<Pipelines>, Res<PipelineCache>),
    uniforms: Res<ComponentUniforms<Upscale>>,
    mut context: RenderContext,
) {
    let (target, extracted, index, _) = view.into_inner();
    let pipeline = pipelines.made.get(&extracted.target_format);
    let pipeline = pipeline.and_then(|pipeline| cache.get_render_pipeline(*pipeline));
    let (Some(pipeline), Some(uniforms)) = (pipeline, uniforms.binding()) else {
        return;
    };
    let pass = target.post_process_write();
    let bound = context.render_device().create_bind_group(
        "upscale",
        &cache.get_bind_group_layout(&pipelines.layout),
        &BindGroupEntries::sequential((pass.source, &pipelines.sampler, uniforms)),
    );
    let mut render = context
        .command_encoder()
        .begin_render_pass(&RenderPassDescriptor {
            label: Some("upscale"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: pass.destination,
                depth_slice: None,
                resolve_target: None,
                ops: Operations::default(),
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
    render.set_pipeline(pipeline);
    render.set_bind_group(0, &bound, &[index.index()]);
    render.draw(0..3, 0..1);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_at_least_a_pixel_and_never_more_than_all() {
        let whole = UVec2::new(1920, 1080);
        for (share, part) in [
            (1.0, whole),
            (0.5, UVec2::new(960, 540)),
            (0.0, UVec2::ONE),
            (-3.0, UVec2::ONE),
            (7.0, whole),
            (f32::NAN, whole),
        ] {
            assert_eq!(Fineness(share).of(whole), part, "{share}");
        }
        assert_eq!(Fineness(0.5).of(UVec2::ONE), UVec2::ONE);
    }
}
