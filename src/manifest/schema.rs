//! The JSON Schema of the manifest, for the editors of curators.

use serde_json::Value;

use super::{raw::RawManifest, shape::schema_of};

/// The schema that `recto schema` prints: what it accepts has the right keys, types, ranges and
/// words; files and references are checked by [`Exhibit::read`](super::Exhibit::read) alone.
pub fn schema() -> Value {
    schema_of::<RawManifest>()
}
