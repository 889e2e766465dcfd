//! The face of the texts that are drawn on the CPU: in plots, and on scale bars.

use std::{error::Error, sync::Once};

use plotters::style::{FontStyle, IntoFont, RGBColor, TextStyle, register_font};

/// The name that [`register`] gives the face.
pub const FACE: &str = "sans-serif";
/// The colour of texts and axes in plots.
pub const INK: RGBColor = RGBColor(32, 32, 36);
/// The colour of the lines behind them.
pub const FAINT: RGBColor = RGBColor(150, 150, 156);

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[error("the plot cannot be drawn: {0}")]
pub struct PlotError(String);

/// As the drawing library's own error, which differs by what is drawn on.
pub fn fault(error: impl Error) -> PlotError {
    PlotError(error.to_string())
}

/// Makes `face`, a TrueType file, that of all texts, once for the whole program: the library keeps
/// it for ever.
pub fn register(face: Vec<u8>) {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let face: &'static [u8] = Box::leak(face.into_boxed_slice());
        // A face that does not parse is missed by the first text, which says so.
        let _ = register_font(FACE, FontStyle::Normal, face);
    });
}

/// Text in the registered face.
pub fn text(px: f64, colour: &'static RGBColor) -> TextStyle<'static> {
    TextStyle::from((FACE, px).into_font()).color(colour)
}
