//! Photographs that show nothing, or too much: a lamp that did not fire, and light that the camera had no
//! room for.

use std::path::PathBuf;

use super::reduced::sum_of;

/// Linear light from which a channel of a file without floats counts as clipped.
const CLIPPED: f32 = 0.995;
/// Mean linear light, noise included, below which a photograph shows nothing; and of the brightest one's.
const DARK: f64 = 2e-3;
const DARK_SHARE: f64 = 0.01;
/// The share that may be clipped of a photograph that is used, and of one that is not worth a word.
const MOST_CLIPPED: f64 = 0.5;
const SOME_CLIPPED: f64 = 0.01;

/// Pixels of a photograph by how much light they hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    pub count: u64,
    pub clipped: u64,
    /// Sum of the greatest channel.
    pub light: f64,
    /// With a channel that is no number.
    pub unknown: u64,
}

impl Tally {
    /// Counts pixels of linear red, green and blue; floats have no level of clipping.
    pub fn add(&mut self, [r, g, b]: [&[f32]; 3], is_float: bool) {
        /// Pixels whose counts and light are summed in 32 bits.
        const TOGETHER: usize = 256;
        let pixels = r.chunks(TOGETHER).zip(g.chunks(TOGETHER));
        for ((r, g), b) in pixels.zip(b.chunks(TOGETHER)) {
            let (mut clipped, mut unknown) = (0u32, 0u32);
            let mut most = [0.0f32; TOGETHER];
            for (((r, g), b), most) in r.iter().zip(g).zip(b).zip(&mut most) {
                let brightest = r.max(*g).max(*b);
                clipped += u32::from(brightest >= CLIPPED);
                unknown += u32::from(!(r + g + b).is_finite());
                // What is no number counts as none, which `clamp` would keep; and the sum of many
                // floats that are no light would be no number.
                let light = brightest.max(0.0);
                *most = light.min(1e30);
            }
            self.count += r.len() as u64;
            self.clipped += u64::from(if is_float { 0 } else { clipped });
            self.unknown += u64::from(unknown);
            self.light += f64::from(sum_of(&most));
        }
    }

    fn mean(&self) -> f64 {
        self.light / self.count.max(1) as f64
    }

    fn share(&self, part: u64) -> f64 {
        part as f64 / self.count.max(1) as f64
    }
}

/// A photograph that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unusable {
    #[error("{} is black: its lamp did not fire, or it is under-exposed", .0.display())]
    Black(PathBuf),
    #[error("{} is over-exposed on {:.0} % of the sheet", path.display(), 100.0 * share)]
    Clipped { path: PathBuf, share: f64 },
}

/// Photographs that cannot be used.
///
/// # Errors
/// All of them.
pub fn check(photographs: &[PathBuf], tallies: &[Tally]) -> Result<(), Vec<Unusable>> {
    let brightest = tallies.iter().map(Tally::mean).fold(0.0, f64::max);
    let dark = DARK.max(DARK_SHARE * brightest);
    let each = photographs.iter().zip(tallies);
    let unusable: Vec<Unusable> = each
        .filter_map(|(path, tally)| {
            let clipped = tally.share(tally.clipped);
            if tally.mean() < dark {
                Some(Unusable::Black(path.clone()))
            } else if clipped > MOST_CLIPPED {
                Some(Unusable::Clipped {
                    path: path.clone(),
                    share: clipped,
                })
            } else {
                None
            }
        })
        .collect();
    match unusable.is_empty() {
        true => Ok(()),
        false => Err(unusable),
    }
}

/// What is to be said of photographs that are used.
pub fn doubts(photographs: &[PathBuf], tallies: &[Tally]) -> Vec<String> {
    let each = photographs.iter().zip(tallies);
    each.flat_map(|(path, tally)| {
        let clipped = tally.share(tally.clipped);
        let clipped = (clipped > SOME_CLIPPED).then(|| {
            format!(
                "{} is over-exposed on {:.1} % of the sheet: what gleams there is not measured; photograph all \
                 of them with less light",
                path.display(),
                100.0 * clipped
            )
        });
        let unknown = (tally.unknown > 0).then(|| {
            let count = tally.unknown;
            format!("{}: {count} pixels are no numbers; export it again", path.display())
        });
        clipped.into_iter().chain(unknown)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(values: &[f32], is_float: bool) -> Tally {
        let mut tally = Tally::default();
        tally.add([values; 3], is_float);
        tally
    }

    #[test]
    fn black_white_and_nan_are_told_and_a_lit_sheet_is_not() {
        let paths: Vec<PathBuf> = ["a", "b", "c", "d", "e"]
            .iter()
            .map(PathBuf::from)
            .collect();
        let lit = vec![0.4; 1000];
        let mut gleaming = lit.clone();
        gleaming[..30].fill(1.0);
        let mut holed = lit.clone();
        holed[7] = f32::NAN;
        let tallies = [
            tally(&lit, false),
            // As a sensor's noise has it.
            tally(&[0.0, 0.003].repeat(500), false),
            tally(&[1.0; 1000], false),
            tally(&gleaming, false),
            tally(&holed, true),
        ];
        assert!(tallies.iter().all(|tally| tally.light.is_finite()));
        assert!(tally(&[3e38; 600], true).light.is_finite());
        let unusable = check(&paths, &tallies).expect_err("two of them");
        assert_eq!(unusable.len(), 2);
        assert!(matches!(&unusable[0], Unusable::Black(path) if path.ends_with("b")));
        assert!(matches!(&unusable[1], Unusable::Clipped { path, .. } if path.ends_with("c")));
        let told = doubts(&paths[3..], &tallies[3..]);
        assert!(
            told[0].starts_with("d is over-exposed on 3.0 %"),
            "{told:?}"
        );
        assert!(told[1].starts_with("e: 1 pixels"), "{told:?}");
        assert!(doubts(&paths[..1], &tallies[..1]).is_empty());
        // Floats may be above 1.
        assert!(check(&paths[..1], &[tally(&[3.0; 10], true)]).is_ok());
    }
}
