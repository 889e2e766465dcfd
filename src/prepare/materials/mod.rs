//! Materials: what each place of a side is drawn with, learnt from swatches.
//!
//! | step | where |
//! |---|---|
//! | how far photographs blur, and colours without | [`sharpness`] |
//! | what is seen of a place | [`features`] |
//! | swatches → places to learn from, to choose by, to be judged by | [`blocks`] |
//! | a small network, by Levenberg and Marquardt's method | [`network`] |
//! | what it has to beat: a linear discriminant | [`discriminant`] |
//! | which of them does better, and how often each class is met | [`ways`] |
//! | places that two materials share | [`edges`] |
//! | what is taken for what | [`confusion`] |
//! | classes → a picture with a legend | [`legend`] |

pub mod blocks;
pub mod confusion;
pub mod discriminant;
pub mod edges;
pub mod features;
pub mod legend;
pub mod network;
pub mod sharpness;
pub mod ways;

use rayon::prelude::*;

use self::{
    blocks::{Blocks, Part},
    confusion::Confusion,
    discriminant::Discriminant,
    features::{Features, Seen},
    ways::{Classifier, Surroundings, Way},
};
use super::capture::Crop;
use crate::optics::medium::{Matter, MediumId};

/// Places of a class that are learnt from, at most.
const LEARNT: usize = 1000;
/// Places of a class that choose or judge, at most.
const JUDGED: usize = 2000;
/// Shares of all places, from the darkest, between which bare paper is looked for where no swatch
/// shows it: as `maps::bare_albedo` does.
const PAPER: [f64; 2] = [0.6, 0.9];
/// How much farther from its class than nearly all of its swatch a place is unlike it, in squares.
const UNLIKE: f64 = 2.0;

/// By how much better places have to be told for each step of surroundings that is seen (see [`Surroundings`]). What
/// a way is chosen by are parts of the swatches that it has learnt from other parts of, and a few swatches say little:
/// surroundings that come with the places where they happen to lie are not those of the sheet. On the sample, with
/// swatches of 400 pixels, seeing all of them does better by .010 and .023 there, and takes 18 and 8% more of the sheet
/// for what it is not.
pub const BETTER: f64 = 0.05;

/// Media that are laid on broadly: where they are thin they are pale all over. Bistre is drawn with as well as washed.
const BROAD: [&str; 4] = ["wash", "watercolour", "prepared-ground", "tinted-ground"];
/// The least share of a place that strokes are learnt from. Less is told by the neighbours (see [`edges`]), and would
/// be lead point by itself.
const THINNEST: f32 = 0.6;
/// Its multiples lie evenly in the unit interval.
const GOLDEN: f32 = 0.618_034;

/// How a way did.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    pub way: Way,
    /// Mean share of each class's places that it found, of those it was chosen by.
    pub choosing: f64,
    /// Of places that had no say before.
    pub held_out: Confusion,
}

/// What came of the swatches of a side.
#[derive(Clone, Debug, PartialEq)]
pub struct Materials {
    /// The classes; the first is bare paper.
    pub media: Vec<Option<MediumId>>,
    /// Whether a swatch shows bare paper; else it is where the sheet is light.
    pub paper_shown: bool,
    /// How many places of each class were learnt from.
    pub learnt: Vec<usize>,
    /// All ways.
    pub trials: Vec<Trial>,
    pub chosen: Way,
    /// The share of the side that each class has.
    pub coverage: Vec<f64>,
    /// The share of the side that is like no swatch.
    pub unlike: f64,
    /// How the places of each swatch are told.
    pub swatches: Vec<SwatchTold>,
    /// The variance in square pixels of the blur that was taken out of the colours before, as
    /// [`sharpness::blur`] found it.
    pub blur: f64,
}

impl Materials {
    /// How often the chosen way took one class for another, on held-out places.
    pub fn confusion(&self) -> Option<&Confusion> {
        let chosen = self.trials.iter().find(|trial| trial.way == self.chosen);
        chosen.map(|trial| &trial.held_out)
    }
}

/// How the places of a swatch are told in the end, whose class it says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwatchTold {
    pub swatch: Known,
    /// The share that is told as it says.
    pub right: f64,
    /// What most of the others are told as.
    pub taken_for: Option<MediumId>,
}

/// A swatch, in pixels of what is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// `None` for bare paper.
    pub medium: Option<MediumId>,
    pub rect: Crop,
}

/// The class of every place, and what came of the swatches. `None` where they name no medium.
pub fn classify(seen: &Seen<'_>, swatches: &[Known]) -> Option<(Vec<u8>, Materials)> {
    let mut media = vec![None];
    for swatch in swatches {
        if !media.contains(&swatch.medium) {
            media.push(swatch.medium);
        }
    }
    if media.len() < 2 {
        return None;
    }
    let blur = sharpness::blur(seen.albedo, seen.width);
    let sharp = (blur > 0.0).then(|| sharpness::sharpened(seen.albedo, seen.width, blur));
    let seen = &Seen {
        albedo: sharp.as_deref().unwrap_or(seen.albedo),
        ..*seen
    };
    let paper_shown = swatches.iter().any(|swatch| swatch.medium.is_none());
    let mut places = Places::new(media.len());
    for swatch in swatches {
        let class = media.iter().position(|medium| *medium == swatch.medium)?;
        places.add_swatch(seen, swatch.rect, class);
    }
    if !paper_shown {
        places.add_paper(seen);
    }
    let learning = places.thinned(Part::Learning, LEARNT);
    let choosing = places.thinned(Part::Choosing, JUDGED);
    let held_out = places.thinned(Part::HeldOut, JUDGED);
    let learnt = counts(&learning, media.len());
    let mut with_thin = learning.clone();
    with_thin.extend(thinly_drawn(&learning, &media));
    // Its distances tell places that are like no swatch, whatever tells classes apart. Thinly drawn ones have no say in
    // that: what no swatch shows would mostly look like a thin stroke.
    let discriminant = Discriminant::fit(&learning, media.len())?;
    let limits = limits(&discriminant, &learning, media.len());
    let fitted: Vec<Option<Classifier>> = Way::ALL
        .into_par_iter()
        .map(|way| Classifier::fit(way, &with_thin, &choosing, media.len()))
        .collect();
    let judged: Vec<(Trial, Classifier)> = fitted
        .into_iter()
        .flatten()
        .map(|one| {
            let trial = Trial {
                way: one.way,
                choosing: one.judged(&choosing).accuracy(),
                held_out: one.judged(&held_out),
            };
            (trial, one)
        })
        .collect();
    let trials: Vec<Trial> = judged.iter().map(|(trial, _)| trial.clone()).collect();
    let best = best_of(trials.iter().map(|trial| (trial.way, trial.choosing)))?;
    let (_, mut chosen) = judged.into_iter().nth(best)?;
    chosen.meet(&everywhere(seen), &counts(&with_thin, media.len()));
    let width = seen.width.max(1);
    let mut classes = vec![0u8; seen.albedo.len()];
    let mut far = vec![false; classes.len()];
    let rows = classes.par_chunks_mut(width).zip(far.par_chunks_mut(width));
    rows.enumerate().for_each(|(y, (row, far))| {
        for (x, (class, far)) in row.iter_mut().zip(far).enumerate() {
            let features = seen.at(x, y);
            let found = chosen.class(&features);
            *far = discriminant.distance(&features, found) > limits[found];
            *class = found as u8;
        }
    });
    // What is like no swatch as it is a little of two is known.
    let settled = edges::settle(seen, &classes, &mut far);
    let told = swatches.iter().map(|swatch| {
        let rows = swatch.rect.top as usize..swatch.rect.bottom as usize;
        let columns = swatch.rect.left as usize..swatch.rect.right as usize;
        let mut met = vec![0usize; media.len()];
        for row in rows.map(|y| &settled[y * width..(y + 1) * width]) {
            row[columns.clone()]
                .iter()
                .for_each(|class| met[usize::from(*class)] += 1);
        }
        let all: usize = met.iter().sum();
        let own = media.iter().position(|medium| *medium == swatch.medium);
        let right = own.map_or(0, |own| std::mem::take(&mut met[own]));
        let most = (0..met.len()).max_by_key(|class| met[*class]);
        SwatchTold {
            swatch: *swatch,
            right: right as f64 / all.max(1) as f64,
            taken_for: most.and_then(|class| media[class]),
        }
    });
    let told = told.collect();
    let total = classes.len().max(1) as f64;
    let unlike = far.iter().filter(|far| **far).count() as f64 / total;
    let mut met = vec![0u64; media.len()];
    for class in &settled {
        met[usize::from(*class)] += 1;
    }
    let materials = Materials {
        coverage: met.into_iter().map(|count| count as f64 / total).collect(),
        unlike,
        swatches: told,
        blur,
        media,
        paper_shown,
        learnt,
        trials,
        chosen: chosen.way,
    };
    Some((settled, materials))
}

/// Which of these ways, the simpler ones first, is to be taken by how it did.
fn best_of(did: impl Iterator<Item = (Way, f64)>) -> Option<usize> {
    let worth = |(way, share): (Way, f64)| match way.surroundings {
        Surroundings::Nothing => share,
        Surroundings::Relief => share - BETTER,
        Surroundings::All => share - 2.0 * BETTER,
    };
    // Of equals the first.
    let best = did
        .map(worth)
        .enumerate()
        .reduce(|best, next| match next.1 > best.1 {
            true => next,
            false => best,
        });
    best.map(|(index, _)| index)
}

/// What is seen of the whole side, at as many places as are needed.
fn everywhere(seen: &Seen<'_>) -> Vec<Features> {
    let step = every(seen.albedo.len());
    let rows: Vec<usize> = (0..seen.height()).step_by(step).collect();
    let of_row = |y: &usize| {
        (0..seen.width)
            .step_by(step)
            .map(|x| seen.at(x, *y))
            .collect()
    };
    let rows: Vec<Vec<Features>> = rows.par_iter().map(of_row).collect();
    rows.concat()
}

/// How many places each class has.
fn counts(places: &[(Features, usize)], classes: usize) -> Vec<usize> {
    let of = |class| places.iter().filter(|(_, of)| *of == class).count();
    (0..classes).map(of).collect()
}

/// Media as a stroke shows them that is thinner than a pixel, where swatches are of places that are covered: as many
/// as there are of each, bare paper showing through by shares from none on.
fn thinly_drawn(
    learning: &[(Features, usize)],
    media: &[Option<MediumId>],
) -> Vec<(Features, usize)> {
    let of_strokes: Vec<bool> = media
        .iter()
        .map(|medium| {
            // A groove covers nothing.
            medium.is_some_and(|id| {
                id.medium().matter != Matter::Relief && !BROAD.contains(&id.name())
            })
        })
        .collect();
    let paper: Vec<&Features> = learning
        .iter()
        .filter(|(_, class)| *class == 0)
        .map(|(features, _)| features)
        .collect();
    if paper.is_empty() {
        return Vec::new();
    }
    let drawn = learning.iter().filter(|(_, class)| of_strokes[*class]);
    drawn
        .enumerate()
        .map(|(i, (features, class))| {
            // Each share as often as any other, and in no step with the places.
            let share = THINNEST + (1.0 - THINNEST) * (i as f32 * GOLDEN).fract();
            let under = paper[i % paper.len()];
            (features::mixed(features, under, share), *class)
        })
        .collect()
}

/// How far from each class a place is unlike it.
fn limits(discriminant: &Discriminant, places: &[(Features, usize)], classes: usize) -> Vec<f64> {
    /// Of a swatch's own places, which noise and specks are in.
    const NEARLY_ALL: f64 = 0.99;
    (0..classes)
        .map(|class| {
            let own = places.iter().filter(|(_, of)| *of == class);
            let mut far: Vec<f64> = own.map(|(f, _)| discriminant.distance(f, class)).collect();
            far.sort_by(f64::total_cmp);
            let last = far.len().saturating_sub(1) as f64;
            far.get((last * NEARLY_ALL) as usize)
                .map_or(f64::INFINITY, |far| UNLIKE * far)
        })
        .collect()
}

/// Places whose class is known, by class and what they are for.
struct Places {
    by_class: Vec<[Vec<Features>; 3]>,
    /// How many swatches each class has had so far.
    swatches: Vec<usize>,
}

impl Places {
    fn new(classes: usize) -> Self {
        Self {
            by_class: vec![<[Vec<Features>; 3]>::default(); classes],
            swatches: vec![0; classes],
        }
    }

    fn add_swatch(&mut self, seen: &Seen<'_>, rect: Crop, class: usize) {
        // A large swatch need not be read whole.
        let step = every(rect.width() * rect.height());
        let number = self.swatches[class];
        self.swatches[class] += 1;
        let blocks = Blocks::new(rect, number);
        for y in (rect.top as usize..rect.bottom as usize).step_by(step) {
            for x in (rect.left as usize..rect.right as usize).step_by(step) {
                if let Some(part) = blocks.part(x, y) {
                    self.by_class[class][part as usize].push(seen.at(x, y));
                }
            }
        }
    }

    /// Takes light places for bare paper.
    fn add_paper(&mut self, seen: &Seen<'_>) {
        let whole = Crop {
            left: 0,
            top: 0,
            right: seen.width as u32,
            bottom: seen.height() as u32,
        };
        let step = every(seen.albedo.len());
        let blocks = Blocks::new(whole, 0);
        let mut found: Vec<(f32, Part, usize, usize)> = Vec::new();
        for y in (0..seen.height()).step_by(step) {
            for x in (0..seen.width).step_by(step) {
                let Some(part) = blocks.part(x, y) else {
                    continue;
                };
                let [r, g, b] = seen.albedo[y * seen.width + x].map(f32::from);
                found.push((r + 2.0 * g + b, part, x, y));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |share: f64| (share * found.len() as f64) as usize;
        for (_, part, x, y) in &found[at(PAPER[0])..at(PAPER[1])] {
            self.by_class[0][*part as usize].push(seen.at(*x, *y));
        }
    }

    /// At most so many of each class, from all over.
    fn thinned(&self, part: Part, most: usize) -> Vec<(Features, usize)> {
        let mut thinned = Vec::new();
        for (class, parts) in self.by_class.iter().enumerate() {
            let all = &parts[part as usize];
            let count = all.len().min(most);
            thinned.extend((0..count).map(|i| (all[i * all.len() / count], class)));
        }
        thinned
    }
}

/// Every how manieth row and column of so many pixels is read.
fn every(pixels: usize) -> usize {
    const MOST: usize = 40_000;
    ((pixels as f64 / MOST as f64).sqrt().ceil() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::{features::FEATURES, *};
    use crate::colour::srgb_encode;

    #[test]
    fn surroundings_are_seen_where_they_help_clearly() {
        let chosen = |did: [f64; 6]| best_of(Way::ALL.into_iter().zip(did));
        assert_eq!(chosen([0.81, 0.80, 0.76, 0.985, 0.99, 0.9955]), Some(3));
        assert_eq!(chosen([0.81, 0.85, 0.93, 0.96, 0.96, 0.985]), Some(3));
        assert_eq!(chosen([0.81, 0.70, 0.70, 0.82, 0.90, 0.94]), Some(4));
        assert_eq!(chosen([0.81, 0.70, 0.70, 0.82, 0.90, 0.985]), Some(5));
        assert_eq!(chosen([0.5, 0.9, 0.6, 0.6, 0.9, 0.9]), Some(1));
        assert_eq!(chosen([1.0; 6]), Some(0));
        assert_eq!(best_of(std::iter::empty()), None);
    }

    #[test]
    fn strokes_are_learnt_thinner_than_swatches_show_them_and_washes_are_not() {
        let medium = |name: &str| name.parse::<MediumId>().ok();
        assert!(BROAD.iter().all(|name| medium(name).is_some()));
        let media = [None, medium("iron-gall-ink"), medium("wash")];
        assert!(media[1..].iter().all(Option::is_some));
        let place = |class: usize| ([[0.9, 0.2, 0.6][class]; FEATURES], class);
        let learning: Vec<(Features, usize)> = (0..300).map(|i| place(i % 3)).collect();
        let thin = thinly_drawn(&learning, &media);
        assert_eq!(thin.len(), 100);
        assert!(thin.iter().all(|(_, class)| *class == 1));
        let shades: Vec<f32> = thin.iter().map(|(features, _)| features[0]).collect();
        let least = shades.iter().copied().fold(1.0, f32::min);
        let most = shades.iter().copied().fold(0.0, f32::max);
        assert!((least - 0.2).abs() < 0.05, "{least}");
        // In light: .787 of paper, .033 of ink.
        let thinnest = srgb_encode(0.6 * 0.033 + 0.4 * 0.787) as f32;
        assert!((most - thinnest).abs() < 0.02, "{most} {thinnest}");
        // Without bare paper nothing shows through.
        let inked: Vec<(Features, usize)> = (0..9).map(|_| place(1)).collect();
        assert!(thinly_drawn(&inked, &media).is_empty());
    }
}
