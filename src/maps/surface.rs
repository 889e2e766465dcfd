//! The macroscopic shape of a sheet from a glTF file.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::MapError;

/// A modelled sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// In the file's own units, taken as mm.
    pub positions: Vec<DVec3>,
    /// Texture coordinates, v down.
    pub uvs: Vec<DVec2>,
    /// Triangles.
    pub indices: Vec<u32>,
}

/// Loads the first triangles of a binary glTF file (`.glb`) whose data lie in the file itself.
///
/// # Errors
/// [`MapError::Read`], [`MapError::Damaged`], or [`MapError::Unsupported`] for data in other
/// files, other primitives, or missing texture coordinates.
pub fn load_gltf(path: &Path) -> Result<Model, MapError> {
    let bytes = std::fs::read(path).map_err(|error| MapError::read(path, error))?;
    let gltf = gltf::Gltf::from_slice(&bytes).map_err(|error| MapError::damaged(path, error))?;
    let unsupported = |found: &str| {
        MapError::unsupported(
            path,
            found,
            "export the sheet as one triangle mesh with texture coordinates in one .glb file",
        )
    };
    if gltf
        .buffers()
        .any(|buffer| !matches!(buffer.source(), gltf::buffer::Source::Bin))
    {
        return Err(unsupported("keeps its data in other files"));
    }
    let primitive = gltf
        .meshes()
        .flat_map(|mesh| mesh.primitives())
        .next()
        .ok_or_else(|| unsupported("holds no mesh"))?;
    if primitive.mode() != gltf::mesh::Mode::Triangles {
        return Err(unsupported("holds no plain triangles"));
    }
    let blob = gltf.blob.as_deref();
    let reader = primitive.reader(|_| blob);
    let positions: Vec<DVec3> = reader
        .read_positions()
        .ok_or_else(|| unsupported("holds no positions"))?
        .map(|p| DVec3::from_array(p.map(f64::from)))
        .collect();
    let uvs: Vec<DVec2> = reader
        .read_tex_coords(0)
        .ok_or_else(|| unsupported("holds no texture coordinates"))?
        .into_f32()
        .map(|uv| DVec2::from_array(uv.map(f64::from)))
        .collect();
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..positions.len() as u32).collect(),
    };
    let whole = uvs.len() == positions.len()
        && indices.len().is_multiple_of(3)
        && indices.iter().all(|i| (*i as usize) < positions.len())
        && positions.iter().all(|p| p.is_finite())
        && uvs.iter().all(|uv| uv.is_finite());
    if !whole || indices.is_empty() {
        return Err(MapError::damaged(path, "its mesh does not hold together"));
    }
    Ok(Model {
        positions,
        uvs,
        indices,
    })
}
