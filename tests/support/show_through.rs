//! Ink of the verso that shows through the recto: a high-passed page against the other,
//! mirrored, over all shifts.

use rayon::prelude::*;

/// Pixels of the scan in one pixel here: correlation is direct, and strokes are still wider
/// than a pixel.
pub const SHRINK: i32 = 4;

/// Patches of text, clear of the margins, in reduced pixels.
pub const PATCHES: [[usize; 2]; 4] = [[150, 200], [300, 200], [150, 450], [300, 450]];

/// One side's reflectance at reduced size, high-passed: ink on paper without the paper's shade.
pub struct Page {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Page {
    /// From linear green in rows.
    pub fn new(width: usize, height: usize, green: &[f32], mirrored: bool) -> Self {
        let mut values: Vec<f32> = green.iter().map(|v| v.max(0.0).sqrt()).collect();
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

/// Side of a patch in reduced pixels: 600 of the scan, 38 mm.
const SIDE: usize = 600 / SHRINK as usize;

/// How far beyond chance the best shift of the verso under a patch of the recto correlates (in
/// standard deviations over all shifts), and that shift in full pixels: between those looked at by
/// a parabola through the peak and its neighbours, and NaN at the end of the reach.
pub fn best_shift(recto: &Page, verso: &Page, left: usize, top: usize) -> (f64, [f64; 2]) {
    let surface = Surface::new(recto, verso, left, top);
    let (best, z) = surface.best();
    let [dx, dy] = surface.shifts[best];
    let score = |dx: i32, dy: i32| {
        let found = surface.shifts.iter().position(|shift| *shift == [dx, dy]);
        found.map_or(f64::NAN, |i| surface.scores[i])
    };
    let offset = |before: f64, after: f64| {
        0.5 * (before - after) / (before - 2.0 * surface.scores[best] + after)
    };
    let fine = [
        f64::from(dx) + offset(score(dx - 1, dy), score(dx + 1, dy)),
        f64::from(dy) + offset(score(dx, dy - 1), score(dx, dy + 1)),
    ];
    (z, fine.map(|v| v * f64::from(SHRINK)))
}

/// Correlation of a patch at every shift within reach, in reduced pixels.
struct Surface {
    shifts: Vec<[i32; 2]>,
    scores: Vec<f64>,
}

impl Surface {
    fn new(recto: &Page, verso: &Page, left: usize, top: usize) -> Self {
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
                correlation(&patch, &other)
            })
            .collect();
        Self { shifts, scores }
    }

    /// The place of the highest, and how far it is beyond chance.
    fn best(&self) -> (usize, f64) {
        let scores = &self.scores;
        let mean = scores.iter().sum::<f64>() / scores.len() as f64;
        let variance = scores.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / scores.len() as f64;
        let best = (0..scores.len())
            .max_by(|&a, &b| scores[a].total_cmp(&scores[b]))
            .expect("some");
        (best, (scores[best] - mean) / variance.sqrt())
    }
}

/// Arithmetic mean.
pub fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64
}

/// Pearson's correlation coefficient.
pub fn correlation(a: &[f32], b: &[f32]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (&a, &b) in a.iter().zip(b) {
        let (a, b) = (f64::from(a) - mean_a, f64::from(b) - mean_b);
        ab += a * b;
        aa += a * a;
        bb += b * b;
    }
    ab / (aa * bb).sqrt()
}
