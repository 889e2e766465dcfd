//! The floor: what it costs to read a sheet's maps with the sheet's own samplers and call it
//! Lambert.

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
            UnpreparedBindGroup,
        },
        renderer::RenderDevice,
    },
    shader::{Shader, ShaderRef},
};

use super::{CostError, stopwatch::sheet};
use crate::sheet::{PaperMaterial, uniform::PaperUniform};

const PATH: &str = "recto/floor.wgsl";
const SHADER: &str = "embedded://recto/floor.wgsl";

/// Registers the floor's shader and material.
pub struct FloorPlugin;

impl Plugin for FloorPlugin {
    fn build(&self, app: &mut App) {
        app.world_mut()
            .resource_mut::<EmbeddedAssetRegistry>()
            .insert_asset(
                PATH.into(),
                Path::new(PATH),
                include_bytes!("../../shaders/floor.wgsl").as_slice(),
            );
        app.add_plugins(MaterialPlugin::<Floor>::default());
        let shader = app.world().resource::<AssetServer>().load(SHADER);
        app.insert_resource(Kept(shader));
    }
}

/// The floor comes and goes; without its shader, its pipelines would be faults.
#[derive(Resource)]
struct Kept(#[expect(dead_code, reason = "it is held, not read")] Handle<Shader>);

/// The sheet's own bindings under the floor's shader.
#[derive(Asset, TypePath, Clone)]
pub struct Floor(PaperMaterial);

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
        values.resize(
            PaperUniform::min_size().get() as usize / size_of::<f32>(),
            0.0,
        );
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

impl Floor {
    /// Lays the floor where the one sheet lies that is on the stage. The stage does not
    /// know, and is not to be arranged again.
    ///
    /// # Errors
    /// [`CostError`] where there is not exactly one sheet.
    pub fn lay(world: &mut World) -> Result<(), CostError> {
        let (entity, mesh, material) = sheet(world)?;
        world.despawn(entity);
        let floor = world.resource_mut::<Assets<Self>>().add(Self(material));
        world.spawn((mesh, MeshMaterial3d(floor), NoFrustumCulling));
        Ok(())
    }
}
