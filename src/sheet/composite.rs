//! The last pass's material: of the pictures of two members, or of one that is enhanced, one.

use bevy::{
    mesh::MeshVertexBufferLayoutRef,
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::render_resource::{
        AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
    },
    shader::ShaderRef,
};

use crate::manifest::{
    exhibit::{CompareMode, Scene},
    lighting::TABLE,
};

/// Twin of `Composite` in `shaders/composite.wgsl`: what is made of the pictures.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
pub struct CompositeUniform {
    pub stretch: Vec2,
    pub mode: u32,
    pub at: f32,
    pub full: f32,
    pub level: f32,
    pub mirrored: u32,
    pub coded: u32,
    pub sharpen: f32,
    pub table: f32,
}

impl CompositeUniform {
    /// Of a scene, in f32.
    pub fn of(scene: &Scene) -> Self {
        let enhance = &scene.enhance;
        let mut uniform = Self {
            stretch: enhance.stretch.map_or(Vec2::Y, |stretch| stretch.as_vec2()),
            full: 1.0,
            level: scene.exposure.level as f32,
            coded: 1,
            sharpen: enhance.sharpen as f32,
            table: TABLE,
            ..Self::default()
        };
        if let Some(comparison) = scene.compare.as_ref().filter(|c| c.mode.combines()) {
            // The numbers of the modes in the shader.
            uniform.mode = match (comparison.mode, comparison.full_luminance) {
                (CompareMode::Difference, None) => 2,
                (CompareMode::Difference, Some(_)) => 3,
                _ => 1,
            };
            let full = comparison.full_luminance.unwrap_or(comparison.full_delta_e);
            uniform.full = full as f32;
            uniform.at = comparison.at as f32;
            uniform.coded = comparison.coded.into();
            uniform.mirrored = (comparison.mode == CompareMode::Glass).into();
        }
        uniform
    }
}

/// The last pass.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
#[bind_group_data(CompositeKey)]
pub struct CompositeMaterial {
    #[uniform(0)]
    pub composite: CompositeUniform,
    #[texture(1, filterable = false)]
    pub first: Handle<Image>,
    #[texture(2, filterable = false)]
    pub second: Handle<Image>,
    #[texture(3, filterable = false)]
    pub scale: Handle<Image>,
    /// As of [`PaperMaterial`](super::PaperMaterial).
    pub display: bool,
}

/// What its pipeline is specialised for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CompositeKey {
    display: bool,
}

impl From<&CompositeMaterial> for CompositeKey {
    fn from(material: &CompositeMaterial) -> Self {
        Self {
            display: material.display,
        }
    }
}

impl Material for CompositeMaterial {
    fn vertex_shader() -> ShaderRef {
        "embedded://recto/composite.wgsl".into()
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://recto/composite.wgsl".into()
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
        let corners = [Mesh::ATTRIBUTE_POSITION.at_shader_location(0)];
        descriptor.vertex.buffers = vec![layout.0.get_layout(&corners)?];
        if let Some(fragment) = &mut descriptor.fragment
            && key.bind_group_data.display
        {
            fragment.shader_defs.push("DISPLAY".into());
        }
        descriptor.primitive.cull_mode = None;
        Ok(())
    }
}
