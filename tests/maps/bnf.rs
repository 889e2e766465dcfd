//! A real leaf: its size from the file, and the ink of the verso seen through the recto.

use rayon::prelude::*;
use recto::maps::{self, ColourEncoding, probe};

use super::{channel, support::data};
use crate::test_name;

#[test]
fn dpi_gives_the_physical_size() {
    let Some(root) = data(test_name!(), "bnf_recto_verso") else {
        return;
    };
    for (name, height) in [("it820_3r_f11.jpg", 3522), ("it820_3v_f12.jpg", 3559)] {
        let header = probe(&root.join(name)).expect(name);
        assert_eq!((header.size, header.icc), ([2417, height], true));
        let [x, y] = header.dpi.expect("a resolution");
        let mm = [2417.0 / x * 25.4, f64::from(height) / y * 25.4];
        assert!(
            (mm[0] - 153.5).abs() < 0.1 && (223.0..227.0).contains(&mm[1]),
            "{mm:?}"
        );
    }
}

/// Levels are halved twice: correlation is direct, and strokes are still wider than a pixel.
const LEVEL: usize = 2;
const SHRINK: i32 = 1 << LEVEL;

/// One side's luminous reflectance at reduced size.
struct Page {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Page {
    /// Loads the high-passed encoded green: ink on paper without the paper's own shade.
    fn load(path: &std::path::Path, mirrored: bool) -> Self {
        let map = maps::load_colour(path, ColourEncoding::Embedded).expect("read");
        let level = &map.levels[LEVEL];
        let (width, height) = (level.width as usize, level.height as usize);
        let mut values: Vec<f32> = channel(&map, LEVEL, 1)
            .iter()
            .map(|v| v.max(0.0).sqrt())
            .collect();
        if mirrored {
            values.chunks_mut(width).for_each(|row| row.reverse());
        }
        let page = Self {
            width,
            height,
            values,
        };
        let smooth = page.blurred(8);
        let values = page
            .values
            .iter()
            .zip(&smooth)
            .map(|(v, s)| v - s)
            .collect();
        Self { values, ..page }
    }

    /// Mean over a square of ±`radius`, shrunk at the edges.
    fn blurred(&self, radius: usize) -> Vec<f32> {
        let line = |values: &[f32], stride: usize, count: usize, start: usize| -> Vec<f32> {
            let mean = |i: usize| {
                let range = i.saturating_sub(radius)..(i + radius + 1).min(count);
                let length = range.len() as f32;
                range.map(|k| values[start + k * stride]).sum::<f32>() / length
            };
            (0..count).map(mean).collect()
        };
        let rows: Vec<f32> = (0..self.height)
            .flat_map(|y| line(&self.values, 1, self.width, y * self.width))
            .collect();
        let columns: Vec<Vec<f32>> = (0..self.width)
            .map(|x| line(&rows, self.width, self.height, x))
            .collect();
        (0..rows.len())
            .map(|i| columns[i % self.width][i / self.width])
            .collect()
    }
}

/// How far beyond chance the best shift of the verso under a patch of the recto correlates (in
/// standard deviations over all shifts), and that shift in full pixels.
fn best_shift(recto: &Page, verso: &Page, left: usize, top: usize) -> (f64, [i32; 2]) {
    const SIDE: usize = 600 / SHRINK as usize;
    const REACH: i32 = 200 / SHRINK;
    // The recto's own ink is far darker than what shows through: it is noise here, so it is cut.
    const RESIDUE: f32 = 0.03;
    let patch: Vec<f32> = (0..SIDE * SIDE)
        .map(|i| recto.values[(top + i / SIDE) * recto.width + left + i % SIDE])
        .map(|v| v.clamp(-RESIDUE, RESIDUE))
        .collect();
    let shifts: Vec<[i32; 2]> = (-REACH / 4..=REACH / 4)
        .flat_map(|dy| (-REACH..=REACH).map(move |dx| [dx, dy]))
        .collect();
    let scores: Vec<f64> = shifts
        .par_iter()
        .map(|&[dx, dy]| {
            let other: Vec<f32> = (0..SIDE * SIDE)
                .map(|i| {
                    let x = (left + i % SIDE) as i32 - dx;
                    let y = (top + i / SIDE) as i32 - dy;
                    let inside = (0..verso.width as i32).contains(&x)
                        && (0..verso.height as i32).contains(&y);
                    if inside {
                        verso.values[y as usize * verso.width + x as usize]
                    } else {
                        0.0
                    }
                })
                .collect();
            super::correlation(&patch, &other)
        })
        .collect();
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    let variance = scores.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / scores.len() as f64;
    let best = (0..scores.len())
        .max_by(|&a, &b| scores[a].total_cmp(&scores[b]))
        .expect("some");
    (
        (scores[best] - mean) / variance.sqrt(),
        shifts[best].map(|v| v * SHRINK),
    )
}

/// Patches of text, clear of the margins, in reduced pixels.
const PATCHES: [[usize; 2]; 4] = [[150, 200], [300, 200], [150, 450], [300, 450]];

#[test]
fn the_versos_ink_shows_through_its_own_recto_only() {
    let Some(root) = data(test_name!(), "bnf_recto_verso") else {
        return;
    };
    let side = |name: &str, mirrored| Page::load(&root.join(name), mirrored);
    let verso = side("it820_3v_f12.jpg", true);
    let find = |recto: &Page| PATCHES.map(|[x, y]| best_shift(recto, &verso, x, y));
    let own = find(&side("it820_3r_f11.jpg", false));
    let wrong = find(&side("it820_2r_f9.jpg", false));
    // The README of the data finds z = 14–29 at 115–119 px for the true pair and 4–7 for the
    // wrong one at full size; a quarter of the size leaves a quarter of the independent shifts.
    for (z, [dx, dy]) in own {
        assert!(z > 7.0, "{own:?}");
        // Within a reduced pixel.
        assert!((112..=123).contains(&dx) && dy.abs() <= SHRINK, "{own:?}");
    }
    assert!(wrong.iter().all(|&(z, _)| z < 5.0), "{wrong:?}");
}
