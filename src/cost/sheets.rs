//! Small exhibits on which costs are measured: one for each kind of work that subjects make.

use std::{fs, path::Path, sync::Arc};

use tempfile::TempDir;

use crate::{
    manifest::{Exhibit, Faults},
    maps::{MapError, encode},
    optics::tier::Tier,
    stage::Shown,
};

/// Texels along each edge of the maps.
const TEXELS: u32 = 512;

/// One drawing for each kind of work; the lamp is distant, and the sheet fills the picture.
const MANIFEST: &str = r##"
[[drawing]]
id = "paper"
size_mm = [100, 100]
paper = { kind = "laid", roughness = 0.6 }
recto.albedo = "albedo.png"

[[drawing]]
id = "particles"
size_mm = [100, 100]
paper = { kind = "laid", roughness = 0.6 }
recto.albedo = "albedo.png"
recto.media = { file = "media.png", legend = { "#404040" = "silver-point" } }

[[drawing]]
id = "table"
size_mm = [100, 100]
paper = { kind = "laid", roughness = 0.6 }
recto.albedo = "albedo.png"
verso.albedo = "albedo.png"

[[drawing]]
id = "relief"
size_mm = [100, 100]
paper = { kind = "laid", roughness = 0.6 }
recto.albedo = "albedo.png"
recto.height = { file = "height.png", range_um = [-25, 25] }

[[lamp]]
id = "lamp"
kind = "distant"
lux_at_sheet = 1000
elevation_deg = 45
azimuth_deg = 135

[[lamp]]
id = "raking"
kind = "distant"
lux_at_sheet = 1000
elevation_deg = 10
azimuth_deg = 180

[[lamp]]
id = "table"
kind = "light-table"
nits = 1000

[[scene]]
id = "paper"
drawing = "paper"
lamps = ["lamp"]
camera = { centre_mm = [50, 50], width_mm = 90 }

[[scene]]
id = "particles"
drawing = "particles"
lamps = ["lamp"]
camera = { centre_mm = [50, 50], width_mm = 90 }

[[scene]]
id = "table"
drawing = "table"
lamps = ["table"]
camera = { centre_mm = [50, 50], width_mm = 90 }

[[scene]]
id = "relief"
drawing = "relief"
lamps = ["raking"]
camera = { centre_mm = [50, 50], width_mm = 90 }
"##;

/// Why there is nothing to measure on.
#[derive(Debug, thiserror::Error)]
pub enum SheetsError {
    #[error("a temporary folder for the sheets to be measured: {0}")]
    Folder(#[from] std::io::Error),
    #[error(transparent)]
    Map(#[from] MapError),
    #[error(transparent)]
    Faults(#[from] Faults),
}

/// The exhibits, in a folder that goes with them.
pub struct Sheets {
    _folder: TempDir,
    exhibit: Arc<Exhibit>,
}

impl Sheets {
    /// Draws them.
    ///
    /// # Errors
    /// [`SheetsError`] where no temporary folder can be written.
    pub fn draw() -> Result<Self, SheetsError> {
        let folder = tempfile::tempdir()?;
        draw(folder.path())?;
        let (exhibit, _) = Exhibit::read(folder.path())?;
        Ok(Self {
            _folder: folder,
            exhibit: Arc::new(exhibit),
        })
    }

    /// The sheet of this kind of work (`paper`, `particles`, `table`, `relief`) in a square
    /// picture; `None` for another word.
    pub fn shown(&self, kind: &str, tier: Tier) -> Option<Shown> {
        let (_, scene) = self.exhibit.scene(kind)?;
        Some(Shown::at_rest(
            self.exhibit.clone(),
            scene.clone(),
            tier,
            1.0,
        ))
    }
}

fn draw(folder: &Path) -> Result<(), SheetsError> {
    fs::write(folder.join("exhibit.toml"), MANIFEST)?;
    // Light paper with strokes of ink across it, so that no branch is taken by all pixels.
    let inked = |i: u32| (i % TEXELS + i / TEXELS) % 32 < 6;
    let pixels = 0..TEXELS * TEXELS;
    let albedo: Vec<[u8; 3]> = pixels
        .clone()
        .map(|i| {
            if inked(i) {
                [96, 72, 56]
            } else {
                [221, 214, 198]
            }
        })
        .collect();
    let save = |name: &str, pixels: &[[u8; 3]]| {
        encode::save_png_rgb8(&folder.join(name), TEXELS, TEXELS, pixels, None)
    };
    save("albedo.png", &albedo)?;
    let media: Vec<[u8; 3]> = pixels
        .clone()
        .map(|i| if inked(i) { [64; 3] } else { [255; 3] })
        .collect();
    save("media.png", &media)?;
    let height: Vec<u16> = pixels
        .map(|i| {
            let turn = f64::from(i % TEXELS) / 16.0 * std::f64::consts::TAU;
            (32767.5 + 32767.0 * turn.sin()) as u16
        })
        .collect();
    encode::save_png_grey16(&folder.join("height.png"), TEXELS, TEXELS, &height, None)?;
    Ok(())
}
