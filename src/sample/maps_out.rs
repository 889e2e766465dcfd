//! Maps → files below an exhibit's `maps` folder.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use super::{SampleError, grid::Grid};
use crate::maps::encode;

/// Red, green, blue and opacity of one code of a categorical map.
pub type Rgba = [u8; 4];

/// Writes the maps of one exhibit.
pub struct Out<'a> {
    folder: PathBuf,
    dpi: f64,
    /// Every file written so far.
    pub files: Vec<PathBuf>,
    progress: &'a (dyn Fn(f64, &str) + Sync),
    span: [f64; 2],
    expected: f64,
}

impl<'a> Out<'a> {
    /// Makes the exhibit's folders, and its manifest where there is none. `span` is the share of
    /// the whole work that this exhibit is, `expected` its number of files.
    pub fn open(
        folder: PathBuf,
        manifest: &str,
        dpi: f64,
        progress: &'a (dyn Fn(f64, &str) + Sync),
        span: [f64; 2],
        expected: usize,
    ) -> Result<Self, SampleError> {
        let maps = folder.join("maps");
        fs::create_dir_all(&maps).map_err(|source| SampleError::Folder {
            path: maps.clone(),
            source,
        })?;
        let mut files = Vec::new();
        let path = folder.join("exhibit.toml");
        if !path.exists() {
            encode::write_whole(&path, |file| file.write_all(manifest.as_bytes()))?;
            files.push(path);
        }
        Ok(Self {
            folder: maps,
            dpi,
            files,
            progress,
            span,
            expected: expected as f64,
        })
    }

    fn path(&self, name: &str) -> Result<PathBuf, SampleError> {
        let path = self.folder.join(name);
        let parent = path.parent().unwrap_or(Path::new(""));
        fs::create_dir_all(parent).map_err(|source| SampleError::Folder {
            path: parent.to_owned(),
            source,
        })?;
        Ok(path)
    }

    fn done(&mut self, path: PathBuf, name: &str) {
        self.files.push(path);
        let share = (self.files.len() as f64 / self.expected).min(1.0);
        (self.progress)(self.span[0] + (self.span[1] - self.span[0]) * share, name);
    }

    /// A grey map of 8 bits.
    pub fn grey8(&mut self, name: &str, grid: Grid, pixels: &[u8]) -> Result<(), SampleError> {
        let path = self.path(name)?;
        let dpi = Some(self.dpi_of(grid));
        encode::save_png_grey8(&path, grid.width as u32, grid.height as u32, pixels, dpi)?;
        self.done(path, name);
        Ok(())
    }

    /// A grey map of 16 bits.
    pub fn grey16(&mut self, name: &str, grid: Grid, pixels: &[u16]) -> Result<(), SampleError> {
        let path = self.path(name)?;
        let dpi = Some(self.dpi_of(grid));
        encode::save_png_grey16(&path, grid.width as u32, grid.height as u32, pixels, dpi)?;
        self.done(path, name);
        Ok(())
    }

    /// A map of three channels of 8 bits.
    pub fn rgb8(&mut self, name: &str, grid: Grid, pixels: &[[u8; 3]]) -> Result<(), SampleError> {
        let path = self.path(name)?;
        let dpi = Some(self.dpi_of(grid));
        encode::save_png_rgb8(&path, grid.width as u32, grid.height as u32, pixels, dpi)?;
        self.done(path, name);
        Ok(())
    }

    /// A map of four channels of 8 bits.
    pub fn rgba8(&mut self, name: &str, grid: Grid, pixels: &[Rgba]) -> Result<(), SampleError> {
        let path = self.path(name)?;
        let dpi = Some(self.dpi_of(grid));
        encode::save_png_rgba8(&path, grid.width as u32, grid.height as u32, pixels, dpi)?;
        self.done(path, name);
        Ok(())
    }

    /// A map of codes, each shown by its colour.
    pub fn codes(
        &mut self,
        name: &str,
        grid: Grid,
        codes: &[u8],
        colours: &[Rgba],
    ) -> Result<(), SampleError> {
        let pixels: Vec<Rgba> = codes
            .iter()
            .map(|&code| colours[usize::from(code)])
            .collect();
        self.rgba8(name, grid, &pixels)
    }

    /// Resolution of a grid, rounded to what was asked for where it differs by rounding only.
    fn dpi_of(&self, grid: Grid) -> f64 {
        let own = 25.4 / f64::from(grid.pitch_mm.x);
        if (own / self.dpi - 1.0).abs() < 0.01 {
            self.dpi
        } else {
            own
        }
    }
}
