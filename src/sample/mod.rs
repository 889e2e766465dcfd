//! The sample exhibits: every map of them is computed by this code, the same bytes on each run.
//!
//! Geometry is in mm throughout; the resolution only decides how finely it is sampled. The
//! landscape is a height field seen in perspective, hatched where it turns from the light
//! (`landscape`); the figure on its verso is a distance field treated the same way
//! (`figure`). Strokes (`stroke`, drawn by a `hand`) add their optical depths over a
//! `paper`, and `side` turns both into maps.

mod chart;
mod contour;
mod damage;
mod figure;
mod font;
mod grid;
mod hand;
mod hatching;
mod landscape;
mod maps_out;
mod noise;
mod paper;
mod script;
mod sheet;
mod side;
mod sprig;
mod stroke;
mod verso;

use std::{
    io,
    path::{Path, PathBuf},
};

use crate::maps::MapError;
use maps_out::Out;

/// Resolution of the maps where nothing else is asked for, in pixels per inch.
pub const DEFAULT_DPI: f64 = 300.0;
/// Resolutions that make sense, in pixels per inch.
pub const DPI_RANGE: [f64; 2] = [20.0, 1200.0];

/// Why the sample exhibits could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    /// The resolution lies outside [`DPI_RANGE`].
    #[error("{dpi} dpi: the resolution must lie between {} and {} dpi", DPI_RANGE[0], DPI_RANGE[1])]
    Resolution { dpi: f64 },
    /// A folder could not be made.
    #[error("{}: the folder cannot be made: {source}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    /// A file could not be written.
    #[error(transparent)]
    Map(#[from] MapError),
}

/// Writes the three sample exhibits into folders below `dir`: their maps at `dpi` pixels per
/// inch, and their manifests where there are none. Returns the files that were written.
///
/// `progress` is told the share of the work that is done, 0…1, and what was done last.
///
/// # Errors
/// [`SampleError`]; files that were complete stay, none is left half-written.
pub fn write_all(
    dir: &Path,
    dpi: f64,
    progress: &(dyn Fn(f64, &str) + Sync),
) -> Result<Vec<PathBuf>, SampleError> {
    let [least, most] = DPI_RANGE;
    if !(least..=most).contains(&dpi) {
        return Err(SampleError::Resolution { dpi });
    }
    let open = |name: &str, manifest: &str, span: [f64; 2], files: usize| {
        Out::open(dir.join(name), manifest, dpi, progress, span, files)
    };
    let manifest = include_str!("../../exhibits/one-picture/exhibit.toml");
    let mut picture = open("one-picture", manifest, [0.0, 0.04], sprig::FILES)?;
    sprig::write(&mut picture)?;
    let manifest = include_str!("../../exhibits/media-chart/exhibit.toml");
    let mut chart = open("media-chart", manifest, [0.04, 0.14], chart::FILES)?;
    chart::write(&mut chart, dpi)?;
    let manifest = include_str!("../../exhibits/landscape/exhibit.toml");
    let mut landscape = open("landscape", manifest, [0.14, 1.0], landscape::write::FILES)?;
    landscape::write::write(&mut landscape, dpi)?;
    Ok([picture.files, chart.files, landscape.files].concat())
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeMap, fs};

    use super::*;

    /// Coarse, since the drawing itself is the same at every resolution.
    const COARSE_DPI: f64 = 24.0;

    fn files(threads: usize) -> BTreeMap<PathBuf, Vec<u8>> {
        let folder = tempfile::tempdir().unwrap();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let written = pool.install(|| write_all(folder.path(), COARSE_DPI, &|_, _| ()).unwrap());
        written
            .into_iter()
            .map(|path| {
                let name = path.strip_prefix(folder.path()).unwrap().to_owned();
                (name, fs::read(path).unwrap())
            })
            .collect()
    }

    #[test]
    fn the_same_bytes_whatever_the_number_of_threads() {
        let (one, three) = (files(1), files(3));
        assert_eq!(
            one.len(),
            3 + sprig::FILES + chart::FILES + landscape::write::FILES
        );
        for (name, bytes) in &one {
            assert!(three.get(name) == Some(bytes), "{} differs", name.display());
        }
    }

    #[test]
    fn a_manifest_that_is_there_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("one-picture/exhibit.toml");
        fs::create_dir_all(own.parent().unwrap()).unwrap();
        fs::write(&own, "mine").unwrap();
        Out::open(
            folder.path().join("one-picture"),
            "theirs",
            20.0,
            &|_, _| (),
            [0.0, 1.0],
            1,
        )
        .unwrap();
        assert_eq!(fs::read_to_string(&own).unwrap(), "mine");
    }

    #[test]
    fn a_resolution_out_of_range_is_refused_before_anything_is_written() {
        let folder = tempfile::tempdir().unwrap();
        for dpi in [0.0, -300.0, f64::NAN, f64::INFINITY, 1e9] {
            let refused = write_all(folder.path(), dpi, &|_, _| ());
            assert!(
                matches!(refused, Err(SampleError::Resolution { .. })),
                "{dpi}"
            );
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
