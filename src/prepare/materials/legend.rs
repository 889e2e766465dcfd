//! Classes as a picture that a manifest's legend names.

use std::path::Path;

use rayon::prelude::*;

use crate::{
    maps::{MAX_WEIGHTS, MapError, encode::save_png_rgba8},
    optics::medium::MediumId,
};

/// Colours that are told apart by anybody (Okabe & Ito 2008), those first that differ most also in thin
/// strokes, and as many darker ones.
const COLOURS: [[u8; 3]; 14] = [
    [0xd5, 0x5e, 0x00],
    [0x00, 0x72, 0xb2],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0xf0, 0xe4, 0x42],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
    [0x6a, 0x2f, 0x00],
    [0x00, 0x39, 0x59],
    [0x00, 0x4f, 0x39],
    [0x66, 0x3c, 0x53],
    [0x78, 0x72, 0x21],
    [0x2b, 0x5a, 0x74],
    [0x73, 0x4f, 0x00],
];

/// The colour of the class `class`, of which the first is bare paper.
pub fn colour(class: usize) -> [u8; 3] {
    let turn = class.saturating_sub(1);
    let [r, g, b] = COLOURS[turn % COLOURS.len()];
    // More classes than colours differ by a step that nobody sees, and no legend confuses.
    [r, g, b ^ (turn / COLOURS.len()) as u8]
}

/// A picture of media, with its legend.
#[derive(Clone, Debug, PartialEq)]
pub struct MediaFile {
    /// Its name, in the folder of the side's maps.
    pub name: String,
    pub legend: Vec<([u8; 3], MediumId)>,
}

/// The files that `media` need, of which the first is bare paper: a legend names four at most.
pub fn files(media: &[Option<MediumId>]) -> Vec<MediaFile> {
    let drawn: Vec<([u8; 3], MediumId)> = media
        .iter()
        .enumerate()
        .filter_map(|(class, medium)| Some((colour(class), (*medium)?)))
        .collect();
    let files = drawn.chunks(MAX_WEIGHTS).enumerate();
    files
        .map(|(i, legend)| MediaFile {
            name: match i {
                0 => "media.png".to_owned(),
                i => format!("media-{}.png", i + 1),
            },
            legend: legend.to_vec(),
        })
        .collect()
}

/// Writes `classes` of a side of this size to `files` in `folder`, transparent where a file does
/// not name the class.
///
/// # Errors
/// Where one cannot be written.
pub fn write(
    files: &[MediaFile],
    classes: &[u8],
    [width, height]: [usize; 2],
    dpi: f64,
    folder: &Path,
) -> Result<(), MapError> {
    for file in files {
        let mut table = [[0u8; 4]; 256];
        for (class, entry) in table.iter_mut().enumerate().skip(1) {
            let [r, g, b] = colour(class);
            if file.legend.iter().any(|(named, _)| *named == [r, g, b]) {
                *entry = [r, g, b, 255];
            }
        }
        let pixels: Vec<[u8; 4]> = classes
            .par_iter()
            .map(|class| table[usize::from(*class)])
            .collect();
        let path = folder.join(&file.name);
        save_png_rgba8(&path, width as u32, height as u32, &pixels, Some(dpi))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_has_a_colour_of_its_own() {
        let mut seen: Vec<[u8; 3]> = (1..60).map(colour).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 59);
    }

    #[test]
    fn a_legend_names_four_at_most() {
        let media: Vec<Option<MediumId>> = std::iter::once(None)
            .chain(MediumId::all().take(6).map(Some))
            .collect();
        let files = files(&media);
        let lengths: Vec<usize> = files.iter().map(|file| file.legend.len()).collect();
        assert_eq!(lengths, [4, 2]);
        assert_eq!(files[1].name, "media-2.png");
    }
}
