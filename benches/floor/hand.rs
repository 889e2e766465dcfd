//! The study tier as it would be written by hand for bare paper with a picture.

use std::path::Path;

use bevy::{
    asset::io::embedded::EmbeddedAssetRegistry,
    camera::visibility::NoFrustumCulling,
    ecs::system::SystemParamItem,
    mesh::MeshVertexBufferLayoutRef,
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::{
        render_resource::{
            AsBindGroup, AsBindGroupError, BindGroupLayout, BindGroupLayoutEntry,
            BufferInitDescriptor, BufferUsages, Face, OwnedBindingResource,
            RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
            UnpreparedBindGroup, encase::UniformBuffer,
        },
        renderer::RenderDevice,
    },
    shader::{Shader, ShaderRef},
};
use recto::{
    cost::{CostError, sheet},
    sheet::{PaperMaterial, uniform::PaperUniform},
};

const PATH: &str = "recto/hand.wgsl";
const SHADER: &str = "embedded://recto/hand.wgsl";

/// Twin of `Hand` in paper.wgsl.
#[derive(ShaderType)]
struct HandUniform {
    clip_from_local: Mat4,
    eye: Vec3,
    alpha: f32,
    towards_lamp: Vec3,
    eta: f32,
    light: Vec3,
    f_normal: f32,
    row_u: Vec3,
    specular: f32,
    row_v: Vec3,
    f_capture: f32,
    lit_bare: Vec3,
    table: Vec3,
    size: Vec2,
}

/// Registers the shader and its material.
pub struct HandPlugin;

impl Plugin for HandPlugin {
    fn build(&self, app: &mut App) {
        app.world_mut()
            .resource_mut::<EmbeddedAssetRegistry>()
            .insert_asset(
                PATH.into(),
                Path::new(PATH),
                include_bytes!("paper.wgsl").as_slice(),
            );
        app.add_plugins(MaterialPlugin::<Hand>::default());
        let shader = app.world().resource::<AssetServer>().load(SHADER);
        app.insert_resource(Kept(shader));
    }
}

#[derive(Resource)]
struct Kept(#[expect(dead_code, reason = "it is held, not read")] Handle<Shader>);

/// The sheet's own bindings under the shader by hand.
#[derive(Asset, TypePath, Clone)]
pub struct Hand(PaperMaterial);

impl AsBindGroup for Hand {
    type Data = ();
    type Param = <PaperMaterial as AsBindGroup>::Param;

    fn label() -> &'static str {
        "hand"
    }

    fn bind_group_data(&self) -> Self::Data {}

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
        let paper = &self.0.paper;
        let hand = HandUniform {
            clip_from_local: paper.clip_from_local,
            eye: paper.eye.truncate(),
            alpha: paper.alpha,
            towards_lamp: paper.lights[0].place,
            eta: paper.eta,
            light: paper.lights[0].amount,
            f_normal: paper.f_normal,
            row_u: paper.albedo_place.row_u,
            specular: paper.specular,
            row_v: paper.albedo_place.row_v,
            f_capture: paper.f_capture,
            lit_bare: paper.lit_bare,
            table: paper.table,
            size: paper.size,
        };
        let mut uniform = UniformBuffer::new(Vec::new());
        if uniform.write(&hand).is_err() {
            return Err(AsBindGroupError::RetryNextUpdate);
        }
        let mut contents = uniform.into_inner();
        // The layout asks for the sheet's whole uniform.
        contents.resize(PaperUniform::min_size().get() as usize, 0);
        let buffer = device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("hand"),
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

impl Material for Hand {
    fn vertex_shader() -> ShaderRef {
        SHADER.into()
    }

    fn fragment_shader() -> ShaderRef {
        SHADER.into()
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
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let position = Mesh::ATTRIBUTE_POSITION.at_shader_location(0);
        let side = Mesh::ATTRIBUTE_UV_0.at_shader_location(1);
        descriptor.vertex.buffers = vec![layout.0.get_layout(&[position, side])?];
        descriptor.primitive.cull_mode = Some(Face::Back);
        Ok(())
    }
}

/// Lays it where the one sheet lies that is on the stage, which is not to be arranged again.
pub fn lay(world: &mut World) -> Result<(), CostError> {
    let (entity, mesh, material) = sheet(world)?;
    world.despawn(entity);
    let hand = world.resource_mut::<Assets<Hand>>().add(Hand(material));
    world.spawn((mesh, MeshMaterial3d(hand), NoFrustumCulling));
    Ok(())
}
