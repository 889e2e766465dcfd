//! Pixels in memory: reads PNG, JPEG, TIFF and OpenEXR, applies their colour profiles, and
//! builds the mip chains that go to the graphics card, each kind of map filtered in its own way.
//!
//! | step | where |
//! |---|---|
//! | what a file is, without its pixels | [`probe`] |
//! | file → raster at full depth | `decode` |
//! | raster → linear sRGB | `icc`, [`load_colour`] |
//! | raster → levels for the GPU | [`Pyramid`] |
//! | media over each other → what shows of each | [`load_matter`] |
//! | several bands of light → one picture | [`load_bands_as_colour`] |
//! | raster → rows of planes, a few at a time | [`ColourRows`] |
//! | what a file says at one place | [`colour_at`], [`value_at`], [`category_at`] |
//! | pixels → file, whole or not at all | [`encode`] |
//! | another picture's place on the sheet | [`registration`] |
//! | a picture bent into its place while it is loaded | [`Warp`] |
//!
//! Rows run from the top of the picture, pixels from its left, channels interleaved.

mod accessors;
mod bands;
mod bare;
mod colour_map;
mod decode;
mod display;
pub mod encode;
mod error;
mod header;
mod icc;
mod lattice;
mod legend;
mod linear;
mod load;
mod matter;
mod missing;
mod pyramid;
mod readout;
pub mod registration;
mod rows;
mod slope;
pub mod surface;
mod warp;

use serde::{Deserialize, Serialize};

pub use bands::{BandPicture, DIVERGING, load_bands_as_colour, load_bands_as_difference};
pub use bare::{bare_albedo, mean_of};
pub use display::DisplayProfile;
pub use error::{MapError, room};
pub use header::{Header, probe, verify, verify_colour};
pub use lattice::{LATTICE_STEPS, Lattice};
pub use legend::{
    ColourCounts, LegendMap, MAX_WEIGHTS, load_media_legend, load_media_weights,
    load_overlay_categorical, load_overlay_continuous, verify_legend,
};
pub use load::{
    Coding, for_each_colour_row, load_colour, load_height, load_normal, load_outline,
    load_overlay_picture, load_roughness, normal_coding,
};
pub use matter::{
    MAX_PARTICLES, MatterPart, MatterSlot, MediaChannels, MediaLayer, load_matter,
    load_roughness_of_matter,
};
pub use missing::Missing;
pub use pyramid::{Level, Pyramid, Texels};
pub use readout::{Rasters, category_at, colour_at, value_at};
pub use rows::ColourRows;
pub use slope::load_normal_from_height;
pub use warp::{Placed, Warp};

/// The largest width or height in pixels: what graphics cards take as a 2-D texture.
pub const MAX_SIDE: u32 = 16384;

/// How a colour map's values encode light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColourEncoding {
    /// By the embedded ICC profile; without one, sRGB for integers and linear for floats.
    #[default]
    Embedded,
    /// The sRGB transfer function, any profile ignored.
    Srgb,
    /// Linear light in the sRGB primaries, any profile ignored.
    Linear,
}

/// Which way a normal map's green channel points on the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NormalY {
    /// Towards the top of the picture (OpenGL).
    #[default]
    Up,
    /// Towards the bottom of the picture (DirectX).
    Down,
}

/// A colour map for values, from low to high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColourMapName {
    /// Dark violet over green to yellow.
    #[default]
    Viridis,
    /// Black over magenta to cream.
    Magma,
    /// Dark blue to yellow, alike for red-green colour-blind eyes.
    Cividis,
    /// Black to white.
    Grey,
    /// Blue over white to red, for values on both sides of the middle of their range.
    Diverging,
}
