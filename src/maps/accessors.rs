//! What a glTF file says of its arrays, held against the bytes that there are: its reader takes it
//! at its word.

use std::path::Path;

use gltf::{
    accessor::{Accessor, DataType, Dimensions},
    buffer::View,
};

use super::MapError;

/// Vertices of a sheet that there may be; a photogrammetric model has some 100 000.
pub const MOST_VERTICES: usize = 4_000_000;
/// Corners of their triangles: about two triangles for each vertex.
pub const MOST_INDICES: usize = 6 * MOST_VERTICES;

/// What an array is to be.
pub struct Expected {
    /// In the plural.
    pub name: &'static str,
    pub types: &'static [DataType],
    pub dimensions: Dimensions,
    pub most: usize,
}

/// Elements one after the other in a part of the buffer.
struct Run<'v> {
    view: View<'v>,
    offset: usize,
    count: usize,
    /// Of one element, in bytes.
    size: usize,
}

impl Run<'_> {
    /// What is wrong with it where the buffer has `bytes` bytes.
    fn fault(&self, bytes: usize) -> Option<String> {
        let stride = self.view.stride().unwrap_or(self.size);
        if stride < self.size {
            return Some(format!(
                "begin every {stride} bytes (byteStride) and take {} each",
                self.size
            ));
        }
        let wide = |number: usize| number as u128;
        let end = wide(self.offset) + wide(stride) * (wide(self.count) - 1) + wide(self.size);
        let length = wide(self.view.length());
        if end > length {
            return Some(format!("take {end} bytes of a bufferView of {length}"));
        }
        let end = wide(self.view.offset()) + length;
        (end > wide(bytes)).then(|| format!("reach to byte {end} of {bytes} in the file"))
    }
}

/// Checks an array before it is read: its type, how many elements it has, and that all of them,
/// sparse ones too, are within the `bytes` of the buffer.
///
/// # Errors
/// [`MapError::Unsupported`] and [`MapError::Damaged`].
pub fn check(
    path: &Path,
    accessor: &Accessor<'_>,
    expected: &Expected,
    bytes: usize,
) -> Result<(), MapError> {
    let Expected {
        name,
        types,
        dimensions,
        most,
    } = expected;
    if accessor.dimensions() != *dimensions || !types.contains(&accessor.data_type()) {
        let found = format!(
            "keeps its {name} as {:?} of {:?}",
            accessor.dimensions(),
            accessor.data_type()
        );
        let remedy = "export it again from a program that keeps to glTF 2.0";
        return Err(MapError::unsupported(path, found, remedy));
    }
    let count = accessor.count();
    if count > *most {
        let found = format!("has {count} {name}, more than {most}");
        let remedy = "export the sheet with fewer triangles";
        return Err(MapError::unsupported(path, found, remedy));
    }
    let sparse = accessor.sparse();
    let changed = sparse.as_ref().map_or(1, |sparse| sparse.count());
    if count == 0 || !(1..=count).contains(&changed) {
        let found = format!("it has {count} {name}, of which {changed} are sparse");
        return Err(MapError::damaged(path, found));
    }
    let size = accessor.size();
    let own = accessor.view().map(|view| Run {
        view,
        offset: accessor.offset(),
        count,
        size,
    });
    let mut runs: Vec<Run<'_>> = own.into_iter().collect();
    if let Some(sparse) = &sparse {
        let (indices, values) = (sparse.indices(), sparse.values());
        runs.push(Run {
            view: indices.view(),
            offset: indices.offset(),
            count: changed,
            size: indices.index_type().size(),
        });
        runs.push(Run {
            view: values.view(),
            offset: values.offset(),
            count: changed,
            size,
        });
    }
    match runs.iter().find_map(|run| run.fault(bytes)) {
        Some(fault) => Err(MapError::damaged(path, format!("its {name} {fault}"))),
        None => Ok(()),
    }
}
