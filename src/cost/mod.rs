//! What a tier costs: instructions of its compiled shader, and time on this machine's graphics
//! device over that of the floor, which only reads the maps.

mod cache;
mod compiled;
mod floor;
mod sheets;
mod stopwatch;

pub use cache::{
    Effort, MeasureError, STEPS, cache_folder, device_name, keep, known, measure, measured,
};
pub use compiled::{CompileError, Composer, instructions};
pub use floor::{Floor, FloorPlugin};
pub use sheets::{Sheets, SheetsError};
pub use stopwatch::{CostError, PASS, Stopwatch, least, median, sheet, spans};
