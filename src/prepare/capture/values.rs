//! The single values of a capture file.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;

use crate::manifest::{
    decode::{Decode, List, Node, Report},
    macros::{choice, number, pattern},
};

use super::{ChartValues, Filter, Integration, Intensities, MAX_LAMPS, Robustness};

number! {
    /// A length of a pixel's side on the sheet.
    PixelMm = 0.001 ..= 10.0, "mm";
    /// A resolution on the sheet.
    SheetDpi = 2.54 ..= 25400.0, "pixels per inch";
    /// A length of a ruler, or of a part of it.
    RulerMm = 1.0 ..= 5000.0, "mm";
    /// A radius that separates the relief of strokes and grain from the shape of the sheet.
    SplitMm = 0.05 ..= 100.0, "mm";
    /// A relative intensity of a lamp.
    Intensity = 0.0001 ..= 10000.0, "", "a lamp that gives nothing lights nothing";
    /// An elevation of a lamp above the plane of the sheet.
    LampElevationDeg = 1.0 ..= 89.99, "degrees", "a lamp in the plane of the sheet does not light it and one straight above has no azimuth";
    /// A reflectance of a grey card.
    CardReflectance = 0.01 ..= 1.0, "", "a grey card reflects some of the light and not more than all of it";
    /// A range of heights that is known from elsewhere.
    KnownUm = 0.1 ..= 100000.0, "µm";
}

choice! {
    ChartValues { ColorChecker24 = "colorchecker24", }
    Intensities { Equal = "equal", Solve = "solve", }
    Robustness { None = "none", Drop = "drop", Robust = "robust", }
    Filter { Gaussian = "gaussian", Bilateral = "bilateral", }
    Integration { Free = "free", Anchored = "anchored", Robust = "robust", }
}

pattern! {
    /// A file of the capture.
    CapturePath = "^[^\\u0000-\\u001f\\u007f]+$", is_capture_path,
        "the path of a file, from the capture file's folder or from /",
        "write the path in quotation marks";
}

fn is_capture_path(text: &str) -> bool {
    !text.is_empty() && !text.contains(|c: char| c.is_ascii_control())
}

/// One value for all lamps, or one for each.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Each<T> {
    All(T),
    Each(List<T, 1, MAX_LAMPS>),
}

impl<T: Decode> Decode for Each<T> {
    fn allowed() -> String {
        format!("{}, or an array with one for each lamp", T::allowed())
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        if node.number().is_some() || node.text().is_some() {
            T::decode(node, report).map(Self::All)
        } else {
            List::decode(node, report).map(Self::Each)
        }
    }
}

impl<T: JsonSchema> JsonSchema for Each<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("Each_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [
                generator.subschema_for::<T>(),
                generator.subschema_for::<List<T, 1, MAX_LAMPS>>(),
            ],
        })
    }
}
