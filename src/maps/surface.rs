//! The macroscopic shape of a sheet from a glTF file, and into one.

use std::{borrow::Cow, io::Write as _, path::Path};

use glam::{DVec2, DVec3};
use gltf::{
    Semantic,
    accessor::{DataType, Dimensions},
    binary::{Glb, Header},
    mesh::Primitive,
};

use super::{
    MapError,
    accessors::{self, Expected, MOST_INDICES, MOST_VERTICES},
    encode::write_whole,
};

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
/// files, other primitives, missing texture coordinates, or more vertices than a sheet has.
pub fn load_gltf(path: &Path) -> Result<Model, MapError> {
    let bytes = std::fs::read(path).map_err(|error| MapError::read(path, error))?;
    model(path, &bytes)
}

fn model(path: &Path, bytes: &[u8]) -> Result<Model, MapError> {
    // The header's own 12 bytes are taken from this number without a look.
    let length = bytes.get(8..12).and_then(|bytes| bytes.try_into().ok());
    if bytes.starts_with(b"glTF") && length.is_none_or(|length| u32::from_le_bytes(length) < 12) {
        return Err(MapError::damaged(path, "its header ends too early"));
    }
    // The crate's own validation looks at arrays by numbers that it has not checked.
    let unchecked = gltf::Gltf::from_slice_without_validation(bytes)
        .map_err(|error| MapError::damaged(path, error))?;
    let root = unchecked.document.as_json();
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut named = primitives.flat_map(|primitive| primitive.attributes.values());
    if named.any(|accessor| accessor.value() >= root.accessors.len()) {
        return Err(MapError::damaged(
            path,
            "a mesh names an array that is not there",
        ));
    }
    let gltf = gltf::Gltf::from_slice(bytes).map_err(|error| MapError::damaged(path, error))?;
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
    check(path, &primitive, blob.map_or(0, <[u8]>::len))?;
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

/// Checks the arrays that are read.
fn check(path: &Path, primitive: &Primitive<'_>, bytes: usize) -> Result<(), MapError> {
    let arrays = [
        (
            primitive.get(&Semantic::Positions),
            Expected {
                name: "positions",
                types: &[DataType::F32],
                dimensions: Dimensions::Vec3,
                most: MOST_VERTICES,
            },
        ),
        (
            primitive.get(&Semantic::TexCoords(0)),
            Expected {
                name: "texture coordinates",
                types: &[DataType::U8, DataType::U16, DataType::F32],
                dimensions: Dimensions::Vec2,
                most: MOST_VERTICES,
            },
        ),
        (
            primitive.indices(),
            Expected {
                name: "indices",
                types: &[DataType::U8, DataType::U16, DataType::U32],
                dimensions: Dimensions::Scalar,
                most: MOST_INDICES,
            },
        ),
    ];
    for (accessor, expected) in &arrays {
        if let Some(accessor) = accessor {
            accessors::check(path, accessor, expected, bytes)?;
        }
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// A sound file of a sheet with two triangles.
    fn sound() -> Vec<u8> {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let model = Model {
            positions: corners.map(|uv| (uv * 100.0).extend(1.0)).to_vec(),
            uvs: corners.to_vec(),
            indices: vec![0, 1, 2, 1, 3, 2],
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.glb");
        save_gltf(&path, &model, &[DVec3::Z; 4]).unwrap();
        std::fs::read(path).unwrap()
    }

    /// The same with its JSON changed.
    fn changed(change: &dyn Fn(&mut Value)) -> Vec<u8> {
        let bytes = sound();
        let glb = Glb::from_slice(&bytes).unwrap();
        let mut json: Value = serde_json::from_slice(&glb.json).unwrap();
        change(&mut json);
        let json = json.to_string().into_bytes().into();
        Glb { json, ..glb }.to_vec().unwrap()
    }

    fn refusal(bytes: &[u8]) -> String {
        let error = model(Path::new("sheet.glb"), bytes).unwrap_err();
        error.to_string()
    }

    #[test]
    fn arrays_that_are_not_there_are_refused_in_words() {
        let path = Path::new("sheet.glb");
        assert_eq!(model(path, &sound()).unwrap().positions.len(), 4);
        let sparse = |count: u64, view: u64| {
            json!({ "count": count, "indices": { "bufferView": view, "componentType": 5121 },
                "values": { "bufferView": 0 } })
        };
        type Change<'c> = (&'c dyn Fn(&mut Value), &'c str);
        let cases: [Change; 13] = [
            (
                &|v| v["bufferViews"][0]["byteStride"] = json!(4),
                "every 4 bytes",
            ),
            (
                &|v| v["accessors"][0]["count"] = json!(5),
                "take 60 bytes of a bufferView of 48",
            ),
            (
                &|v| v["accessors"][2]["count"] = json!(0),
                "0 texture coordinates",
            ),
            (
                &|v| v["accessors"][3]["count"] = json!(1_u64 << 40),
                "fewer triangles",
            ),
            (&|v| v["accessors"][1]["byteOffset"] = json!(4), ""),
            (
                &|v| v["accessors"][0]["byteOffset"] = json!(u64::MAX),
                "of a bufferView of 48",
            ),
            (
                &|v| v["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
                "in the file",
            ),
            (
                &|v| v["bufferViews"][3]["byteLength"] = json!(u64::MAX),
                "in the file",
            ),
            (
                &|v| v["accessors"][0]["type"] = json!("VEC2"),
                "positions as",
            ),
            (
                &|v| v["accessors"][2]["componentType"] = json!(5125),
                "texture coordinates as",
            ),
            (
                &|v| {
                    let accessor = v["accessors"][0].as_object_mut().unwrap();
                    accessor.remove("bufferView");
                    accessor.insert("count".to_owned(), json!(1_u64 << 40));
                    accessor.insert("sparse".to_owned(), sparse(1, 3));
                },
                "1099511627776 positions, more than 4000000",
            ),
            (
                &|v| v["accessors"][0]["sparse"] = sparse(5, 3),
                "5 are sparse",
            ),
            (
                &|v| v["accessors"][0]["sparse"] = sparse(0, 3),
                "0 are sparse",
            ),
        ];
        for (change, words) in cases {
            let bytes = changed(change);
            if words.is_empty() {
                // Normals are not read.
                model(path, &bytes).unwrap();
                continue;
            }
            let found = refusal(&bytes);
            assert!(
                found.starts_with("sheet.glb: ") && found.contains(words),
                "{words}: {found}"
            );
        }
        // Within the bytes that there are, a sparse array is read.
        let bytes = changed(&|v| {
            v["accessors"][0]["sparse"] = json!({ "count": 1, "indices": { "bufferView": 3,
                "componentType": 5125 }, "values": { "bufferView": 0, "byteOffset": 36 } });
        });
        let moved = model(path, &bytes).unwrap();
        assert_eq!(moved.positions[0], DVec3::new(100.0, 100.0, 1.0));
    }

    #[test]
    fn broken_files_never_panic() {
        let path = Path::new("sheet.glb");
        let sound = sound();
        for end in 0..sound.len() {
            let _ = model(path, &sound[..end]);
        }
        for at in 0..sound.len() {
            for mask in [1, 2, 4, 8, 0x10, 0x40, 0x80, 0xff] {
                let mut bytes = sound.clone();
                bytes[at] ^= mask;
                let _ = model(path, &bytes);
            }
        }
        // Numbers of all sizes, in the place of every digit.
        let glb = Glb::from_slice(&sound).unwrap();
        let json = glb.json.clone();
        for at in (0..json.len()).filter(|at| json[*at].is_ascii_digit()) {
            for digits in [
                "0",
                "99",
                "4294967295",
                "1099511627776",
                "18446744073709551615",
            ] {
                let json = [&json[..at], digits.as_bytes(), &json[at + 1..]].concat();
                let glb = Glb {
                    json: json.into(),
                    ..glb.clone()
                };
                let _ = model(path, &glb.to_vec().unwrap());
            }
        }
        for length in 0..16 {
            let mut bytes = sound.clone();
            bytes[8..12].copy_from_slice(&u32::to_le_bytes(length));
            let _ = model(path, &bytes);
        }
    }
}
