//! What the files that people write have in common, whatever they describe: their schema, and whether a
//! text has the shape that it says.

use std::path::Path;

use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::Value;

use super::{
    Fault, Faults,
    decode::{Decode, Node, Report},
    document::{Document, Words},
};

/// The JSON Schema of a file: what it accepts has the right keys, types, ranges and words.
pub fn schema_of<R: JsonSchema>() -> Value {
    // Editors for TOML know draft 7 best.
    SchemaSettings::draft07()
        .into_generator()
        .into_root_schema_for::<R>()
        .to_value()
}

/// Checks keys, types, ranges and words of a text that would be a file of this name, which is what
/// [`schema_of`] describes, and touches no file.
///
/// # Errors
/// All faults of syntax, or else of shape.
pub fn check<R: Decode>(name: &str, text: &str) -> Result<(), Faults> {
    let document = Document::parse(Path::new(name), text)?;
    let mut report = Report::new(&document);
    R::decode(&Node::root(&document), &mut report);
    Faults::new(report.into_faults()).map_or(Ok(()), Err)
}

/// Stands in for a fault that the validation of `what` should have reported.
pub fn unexplained(file: &Path, what: &str) -> Fault {
    let words = Words::new(
        format!("{what} that cannot be used, for a reason that was not recorded"),
        "",
        "please report this with the file",
    );
    words.of_file(file)
}
