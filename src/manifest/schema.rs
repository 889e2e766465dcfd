//! The JSON Schema of the manifest, for the editors of curators.

use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::raw::RawManifest;

/// The schema that `recto schema` prints: what it accepts has the right keys, types, ranges and
/// words; files and references are checked by [`Exhibit::read`](super::Exhibit::read) alone.
pub fn schema() -> Value {
    // Editors for TOML know draft 7 best.
    let settings = SchemaSettings::draft07();
    settings
        .into_generator()
        .into_root_schema_for::<RawManifest>()
        .to_value()
}
