//! Places that two materials share.
//!
//! Where a stroke ends, a pixel shows some of it and some of what lies beside it: half ink and half paper look
//! like pale ink, wash or lead point. Swatches are of one material throughout and do not say so. A place between
//! the lightest and the darkest of its neighbours, which are of two classes, therefore is given to one of these, by the
//! share that it has of their difference in light. That holds for edges about a pixel wide. Lead point that is no wider
//! is lost right beside ink.

use rayon::prelude::*;

use super::features::Seen;
use crate::{colour::luminance, prepare::codes::linear};

/// The share of a place that a medium covers from which on it is drawn there. A little less than half: what is
/// taken for a thin film of ink is shown as it is, what is taken for dark paper is not under other light.
const DRAWN: f32 = 0.45;
/// Of the lightest neighbour's light: less of a difference is the unevenness of one material.
const CONTRAST: f32 = 0.1;
/// Rows that are settled at a time.
const ROWS: usize = 64;

/// `classes` once the places that two of them share are given to one, which are `far` from no class any more. The
/// first class is bare paper.
pub fn settle(seen: &Seen<'_>, classes: &[u8], far: &mut [bool]) -> Vec<u8> {
    let (width, height) = (seen.width.max(1), seen.height());
    let mut settled = classes.to_vec();
    settled
        .par_chunks_mut(ROWS * width)
        .zip(far.par_chunks_mut(ROWS * width))
        .enumerate()
        .for_each(|(chunk, (out, far))| {
            let top = (chunk * ROWS).saturating_sub(1);
            let bottom = (chunk * ROWS + out.len() / width + 1).min(height);
            let luminance: Vec<f32> = seen.albedo[top * width..bottom * width]
                .iter()
                .map(|rgb| luminance(linear(*rgb).to_array()) as f32)
                .collect();
            let within = Window {
                width,
                luminance: &luminance,
                classes: &classes[top * width..bottom * width],
            };
            let first = chunk * ROWS - top;
            for (i, (out, far)) in out.iter_mut().zip(far).enumerate() {
                if let Some(class) = within.shared(i % width, first + i / width) {
                    (*out, *far) = (class, false);
                }
            }
        });
    settled
}

/// Some rows of a side.
struct Window<'w> {
    width: usize,
    /// Luminance, 1 that of a perfect diffuser.
    luminance: &'w [f32],
    classes: &'w [u8],
}

impl Window<'_> {
    /// The class of a place whose lightest and darkest neighbours are of different ones.
    fn shared(&self, x: usize, y: usize) -> Option<u8> {
        let rows = y.saturating_sub(1)..(y + 2).min(self.luminance.len() / self.width);
        let columns = x.saturating_sub(1)..(x + 2).min(self.width);
        let at = y * self.width + x;
        let (mut lightest, mut darkest) = (at, at);
        for row in rows {
            for i in row * self.width + columns.start..row * self.width + columns.end {
                if self.luminance[i] > self.luminance[lightest] {
                    lightest = i;
                }
                if self.luminance[i] < self.luminance[darkest] {
                    darkest = i;
                }
            }
        }
        let [above, below] = [lightest, darkest].map(|i| self.luminance[i]);
        let [lighter, darker] = [lightest, darkest].map(|i| self.classes[i]);
        let range = above - below;
        if lighter == darker || range <= CONTRAST * above {
            return None;
        }
        let share = (above - self.luminance[at]) / range;
        // Of white on paper it is the lighter one that is drawn.
        let is_darker = match darker {
            0 => 1.0 - share < DRAWN,
            _ => share >= DRAWN,
        };
        Some(if is_darker { darker } else { lighter })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{colour::srgb_encode, prepare::materials::features::Gloss};

    /// More rows than are settled at a time.
    const SIZE: usize = 2 * ROWS + 2;

    /// Of a sheet with this light, by a classifier of three classes that knows the light of each.
    fn told(light: impl Fn(usize, usize) -> f64, of: [f64; 3]) -> (Vec<u8>, Vec<u8>) {
        let code = |v: f64| [(srgb_encode(v) * 65535.0).round() as u16; 3];
        let places: Vec<f64> = (0..SIZE * SIZE)
            .map(|i| light(i % SIZE, i / SIZE))
            .collect();
        let nearest = |v: &f64| {
            let far = |class: &u8| (of[usize::from(*class)] - v).abs();
            (0..3)
                .min_by(|a: &u8, b| far(a).total_cmp(&far(b)))
                .unwrap_or_default()
        };
        let classes: Vec<u8> = places.iter().map(nearest).collect();
        let albedo: Vec<[u16; 3]> = places.iter().map(|v| code(*v)).collect();
        let seen = Seen {
            width: SIZE,
            albedo: &albedo,
            normals: &[],
            gloss: &Gloss::default(),
        };
        let mut far = vec![true; classes.len()];
        let settled = settle(&seen, &classes, &mut far);
        // What was given to another class is no longer far from its own.
        let mut places = classes.iter().zip(&settled).zip(&far);
        assert!(places.all(|((before, after), far)| before == after || !far));
        (classes, settled)
    }

    /// How much of pixel `x` lies between two edges.
    fn covered(x: usize, [from, to]: [f64; 2]) -> f64 {
        let x = x as f64;
        (to.min(x + 1.0) - from.max(x)).clamp(0.0, 1.0)
    }

    #[test]
    fn an_edge_of_ink_is_no_lead_point_and_lead_point_stays() {
        const OF: [f64; 3] = [0.8, 0.2, 0.5];
        // Ink of three pixels and two parts, and lead of two.
        let [ink, lead] = [[5.3, 9.5], [20.0, 22.0]];
        let light = |x: usize, _| {
            let [ink, lead] = [ink, lead].map(|edges| covered(x, edges));
            OF[0] + (OF[1] - OF[0]) * ink + (OF[2] - OF[0]) * lead
        };
        let (classes, settled) = told(light, OF);
        for (i, class) in settled.iter().enumerate() {
            let x = i % SIZE;
            let is = match x {
                20 | 21 => 2,
                // 9 has half of it.
                5..=9 => 1,
                _ => 0,
            };
            assert_eq!(*class, is, "{x}");
        }
        // By itself, what is half inked is lead.
        assert_eq!(classes[9], 2);
    }

    #[test]
    fn white_is_drawn_where_it_covers_as_much_of_paper() {
        const OF: [f64; 3] = [0.5, 0.9, 0.1];
        let at = |share: f64| {
            let light = move |x: usize, _| match x {
                0..10 => OF[1],
                10 => OF[0] + share * (OF[1] - OF[0]),
                _ => OF[0],
            };
            told(light, OF).1[10]
        };
        assert_eq!([0.3, 0.43, 0.47, 0.6].map(at), [0, 0, 1, 1]);
    }

    #[test]
    fn a_little_unevenness_changes_nothing() {
        // Classes that differ by a twentieth, and a place between both.
        const OF: [f64; 3] = [0.8, 0.76, 0.3];
        let light = |x: usize, y: usize| match (x + y) % 3 {
            0 => OF[0],
            1 => OF[1],
            _ => 0.781,
        };
        let (classes, settled) = told(light, OF);
        assert_eq!(classes, settled);
    }

    #[test]
    fn edges_are_settled_across_rows_as_across_columns() {
        const OF: [f64; 3] = [0.8, 0.2, 0.5];
        // Edges where one batch of rows ends and the next begins.
        let ink = |place: usize| {
            let edges = [[5.3, 9.5], [60.0, 64.3], [125.4, 128.5]];
            let covered: f64 = edges.iter().map(|edges| covered(place, *edges)).sum();
            OF[0] + (OF[1] - OF[0]) * covered
        };
        let (_, columns) = told(|x, _| ink(x), OF);
        let (_, rows) = told(|_, y| ink(y), OF);
        for i in 0..SIZE * SIZE {
            assert_eq!(rows[i], columns[i % SIZE * SIZE + i / SIZE], "{i}");
        }
        assert!(!columns.contains(&2));
        assert_eq!([columns[64], columns[125], columns[128]], [0, 1, 1]);
    }
}
