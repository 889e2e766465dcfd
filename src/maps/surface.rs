//! The macroscopic shape of a sheet from a glTF file, and into one.

use std::{borrow::Cow, io::Write as _, path::Path};

use glam::{DVec2, DVec3};
use gltf::binary::{Glb, Header};

use super::{MapError, encode::write_whole};

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

/// Writes a modelled sheet as a binary glTF file (`.glb`) that [`load_gltf`] reads, in the same
/// units, with `normals` to its positions.
///
/// # Errors
/// [`MapError::Write`], also where the parts of the model do not belong together.
pub fn save_gltf(path: &Path, model: &Model, normals: &[DVec3]) -> Result<(), MapError> {
    const FLOAT: u32 = 5126;
    const UNSIGNED_INT: u32 = 5125;
    const VERTICES: u32 = 34962;
    const INDICES: u32 = 34963;
    let count = model.positions.len();
    let whole = model.uvs.len() == count
        && normals.len() == count
        && count > 0
        && !model.indices.is_empty()
        && model.indices.len().is_multiple_of(3)
        && model.indices.iter().all(|i| (*i as usize) < count);
    if !whole {
        let reason = std::io::Error::new(
            std::io::ErrorKind::InvalidInput,
            "its mesh does not hold together",
        );
        return Err(MapError::write(path, reason));
    }
    let positions: Vec<f32> = floats(model.positions.iter().map(|p| p.to_array()));
    let normals: Vec<f32> = floats(normals.iter().map(|n| n.to_array()));
    let uvs: Vec<f32> = floats(model.uvs.iter().map(|uv| uv.to_array()));
    let extreme = |pick: fn(f32, f32) -> f32| -> [f32; 3] {
        [0, 1, 2].map(|c| {
            let along = positions.iter().skip(c).step_by(3).copied();
            along.reduce(pick).unwrap_or_default()
        })
    };
    let mut bytes: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    for (values, target) in [
        (&positions, VERTICES),
        (&normals, VERTICES),
        (&uvs, VERTICES),
    ] {
        views.push(serde_json::json!({ "buffer": 0, "byteOffset": bytes.len(),
            "byteLength": 4 * values.len(), "target": target }));
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    }
    views.push(serde_json::json!({ "buffer": 0, "byteOffset": bytes.len(),
        "byteLength": 4 * model.indices.len(), "target": INDICES }));
    bytes.extend(model.indices.iter().flat_map(|i| i.to_le_bytes()));
    let vertices = |view: u32, kind: &str| serde_json::json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": kind });
    let mut places = vertices(0, "VEC3");
    places["min"] = extreme(f32::min).as_slice().into();
    places["max"] = extreme(f32::max).as_slice().into();
    let text = serde_json::json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("Recto ", env!("CARGO_PKG_VERSION")),
            "extras": { "unit": "mm" },
        },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "sheet" }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 },
            "indices": 3,
            "mode": 4,
        }] }],
        "accessors": [
            places,
            vertices(1, "VEC3"),
            vertices(2, "VEC2"),
            { "bufferView": 3, "componentType": UNSIGNED_INT, "count": model.indices.len(),
              "type": "SCALAR" },
        ],
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len() }],
    });
    let file = Glb {
        header: Header {
            magic: *b"glTF",
            version: 2,
            // Counted by the writer.
            length: 0,
        },
        json: Cow::Owned(text.to_string().into_bytes()),
        bin: Some(Cow::Owned(bytes)),
    };
    let refused = |error: gltf::Error| MapError::write(path, std::io::Error::other(error));
    let bytes = file.to_vec().map_err(refused)?;
    write_whole(path, |writer| writer.write_all(&bytes))
}

fn floats<const N: usize>(vectors: impl Iterator<Item = [f64; N]>) -> Vec<f32> {
    vectors.flatten().map(|v| v as f32).collect()
}
