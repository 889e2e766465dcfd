//! The sheet's shape for the GPU.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, Mesh, PrimitiveTopology},
};

pub use crate::manifest::surface::SideSurface;

impl SideSurface {
    /// For the GPU.
    pub fn mesh(&self) -> Mesh {
        let positions: Vec<[f32; 3]> = self
            .positions
            .iter()
            .map(|p| p.as_vec3().to_array())
            .collect();
        let side: Vec<[f32; 2]> = self.side.iter().map(|s| s.as_vec2().to_array()).collect();
        let normals: Vec<[f32; 3]> = self
            .normals
            .iter()
            .map(|n| n.as_vec3().to_array())
            .collect();
        let tangents: Vec<[f32; 4]> = self
            .tangents
            .iter()
            .map(|t| t.extend(1.0).as_vec4().to_array())
            .collect();
        Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::RENDER_WORLD,
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, side)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, tangents)
        .with_inserted_indices(Indices::U32(self.indices.clone()))
    }
}
