//! The landscape's files.

use super::{composition, recto};
use crate::colour;
use crate::sample::{
    SampleError,
    damage::{Damage, Kind},
    grid::Grid,
    maps_out::{Out, Rgba},
    paper::Paper,
    sheet::{self, Thickness},
    side::{self, SideMaps},
    verso,
};

/// Files that the exhibit has, its manifest not counted.
pub const FILES: usize = 25;
/// Samples of the macroscopic surface.
const CURL_SAMPLES: [usize; 2] = [96, 65];
const CLEAR: Rgba = [0; 4];
/// Colours of the codes of the media planes, as the manifest's legends name them.
const LEAD: Rgba = [0x80, 0x80, 0x80, 0xff];
const STYLUS: Rgba = [0x2f, 0x9e, 0x8f, 0xff];
const WASHED: Rgba = [0xb8, 0x86, 0x4b, 0xff];
const PALE: Rgba = [0xc2, 0x5a, 0x1e, 0xff];
const DARK: Rgba = [0x3b, 0x2a, 0x1a, 0xff];
const MEDIA: [Rgba; 6] = [CLEAR, LEAD, STYLUS, WASHED, PALE, DARK];
/// Colours of the damages: none, tear, stain, foxing, loss.
const DAMAGES: [Rgba; 5] = [
    CLEAR,
    [0xd5, 0x5e, 0x00, 0xff],
    [0x56, 0xb4, 0xe9, 0xff],
    [0xe6, 0x9f, 0x00, 0xff],
    [0xcc, 0x79, 0xa7, 0xff],
];

/// Draws the landscape and writes its maps.
pub fn write(out: &mut Out, dpi: f64) -> Result<(), SampleError> {
    let size = composition::SIZE_MM;
    let grid = Grid::at_dpi(size, dpi);
    let half = grid.halved();
    let paper = Paper::new(size, 100);
    let damage = Damage::new(size);
    let drawn = composition::draw();

    let front = recto::maps(grid, &paper, &damage, &drawn);
    write_side(out, "recto", grid, &front)?;
    out.grey8("overlays/infrared.png", grid, &front.greys[recto::INFRARED])?;
    out.codes(
        "recto/media-lower.png",
        grid,
        &front.greys[recto::LOWER_MEDIA],
        &MEDIA,
    )?;
    out.codes(
        "recto/media-upper.png",
        grid,
        &front.greys[recto::UPPER_MEDIA],
        &MEDIA,
    )?;
    let media = every_other(grid, half, &front.greys[recto::ALL_MEDIA]);
    out.codes("overlays/media.png", half, &media, &MEDIA)?;
    for (band, nm) in recto::BANDS_NM.into_iter().enumerate() {
        let plane = &front.greys[recto::BANDS + band];
        out.grey8(
            &format!("bands/{nm}.png"),
            half,
            &mean_of_four(grid, half, plane),
        )?;
    }
    drop(front);

    let back = verso::maps(grid, size, &paper, &damage, &drawn.strokes);
    write_side(out, "verso", grid, &back)?;
    out.grey8("verso/media-chalk.png", grid, &back.greys[verso::CHALK])?;
    out.grey8("verso/media-ink.png", grid, &back.greys[verso::INK])?;
    drop(back);

    let thickness = Thickness::new(&paper, size);
    out.grey8("transmission.png", grid, &thickness.transmission(grid))?;
    out.grey8("overlays/thickness.png", half, &thickness.overlay(half))?;
    out.grey8("outline.png", grid, &sheet::outline(grid, &damage))?;
    let damages: Vec<u8> = half.map(|p| {
        damage.kind(p).map_or(0, |kind| match kind {
            Kind::Tear => 1,
            Kind::Stain => 2,
            Kind::Foxing => 3,
            Kind::Loss => 4,
        })
    });
    out.codes("overlays/damage.png", half, &damages, &DAMAGES)?;
    let coarse = Grid::with_pixels(size, CURL_SAMPLES[0], CURL_SAMPLES[1]);
    out.grey16("surface.png", coarse, &sheet::curl(coarse, size))
}

fn write_side(
    out: &mut Out,
    name: &str,
    grid: Grid,
    maps: &SideMaps<2>,
) -> Result<(), SampleError> {
    let [after, before] = &maps.colours;
    out.rgb8(&format!("{name}/albedo.png"), grid, after)?;
    out.rgb8(&format!("before/{name}-albedo.png"), grid, before)?;
    out.grey16(&format!("{name}/height.png"), grid, &maps.height)?;
    out.rgb8(&format!("{name}/normal.png"), grid, &maps.normal)?;
    out.grey8(&format!("{name}/roughness.png"), grid, &maps.roughness)
}

/// The mean light of each four pixels, sRGB-encoded as they are.
fn mean_of_four(grid: Grid, half: Grid, encoded: &[u8]) -> Vec<u8> {
    let light: Vec<f32> = (0..=255_u8)
        .map(|code| colour::srgb_decode(f64::from(code) / 255.0) as f32)
        .collect();
    let at = |column: usize, row: usize| {
        let i = row.min(grid.height - 1) * grid.width + column.min(grid.width - 1);
        light[usize::from(encoded[i])]
    };
    (0..half.width * half.height)
        .map(|i| {
            let (x, y) = (2 * (i % half.width), 2 * (i / half.width));
            let sum = at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1);
            side::srgb8(sum / 4.0)
        })
        .collect()
}

/// The strongest code of each four pixels: strokes survive the halving.
fn every_other(grid: Grid, half: Grid, codes: &[u8]) -> Vec<u8> {
    let code = |column: usize, row: usize| {
        codes[row.min(grid.height - 1) * grid.width + column.min(grid.width - 1)]
    };
    (0..half.width * half.height)
        .map(|i| {
            let (column, row) = (2 * (i % half.width), 2 * (i / half.width));
            let block = [(0, 0), (1, 0), (0, 1), (1, 1)];
            block
                .into_iter()
                .map(|(x, y)| code(column + x, row + y))
                .max()
                .unwrap_or_default()
        })
        .collect()
}
