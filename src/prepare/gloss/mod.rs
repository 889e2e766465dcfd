//! How rough the surface of each material is, by what photographs show of it.
//!
//! The brightest pixel says little: it is clipped, or a speck, or the one facet that happened to
//! face right. Here the study tier itself is fitted. For a roughness α, each sampled place gets the
//! normal and the albedo with which the tier comes nearest to all its photographs; the α at which
//! what is left over is least is the material's (variable projection, Golub & Pereyra 1973).
//! Shadows and specks are outliers and lose their weight.
//!
//! The same fits say how far stereo's albedo is off, which took every surface for paper: glossier
//! ink gleams into it, and slanted light goes a longer way through ink. Of each class the
//! difference is put down to the albedo and the slope ([`Amendment`]), and every place of it gets
//! what it is on these.
//!
//! Before stereo, the same is done for light and dark places as such ([`first`]): it divides their
//! gloss out.
//!
//! Lamps of one height over an even surface show gloss and albedo as one: then nothing is least,
//! the bound is wide, and the roughness stays assumed.

mod amendment;
pub mod first;
mod place;
mod samples;

use glam::DVec3;
use rayon::prelude::*;

use self::place::{left_over, settle, settle_anew, start, weight};
use super::{
    model::{Model, Spot},
    stereo::Rig,
};
use crate::optics::medium::{Matter, Medium, MediumId};
pub use amendment::Amendment;
pub use samples::{Place, Samples, Sheet};

/// The fewest places that a fit is done with.
const FEWEST: usize = 40;
/// Roughnesses looked at first.
const GRID: [f64; 9] = [0.1, 0.14, 0.2, 0.28, 0.38, 0.5, 0.64, 0.8, 1.0];
/// Steps between the best of them and its neighbours.
const GOLDEN: usize = 6;
/// Steps of each place's own fit, first and once it starts from a roughness nearby.
const STEPS: [usize; 2] = [5, 3];
/// A bound wider than this share of the roughness says nothing.
const WIDEST: f64 = 0.25;
/// Standard deviations of the bound that is told.
const SIGMAS: f64 = 2.0;

/// The roughness of a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// `None` for bare paper.
    pub medium: Option<MediumId>,
    /// GGX roughness α: what was fitted, or else what the catalogue says.
    pub alpha: f64,
    /// Within how much of it photographs bear it out (two standard deviations); `None` where they
    /// do not, and it is assumed.
    pub within: Option<f64>,
    /// Root of the mean square that the photographs leave over, in shares of their mean; outliers
    /// count by their weight.
    pub residual: f64,
    /// How many places were fitted.
    pub places: usize,
}

/// Fits the roughness of `medium`, whose other constants are `constants`, or of bare paper, to
/// some of its places.
pub fn fit(
    model: &Model,
    medium: Option<MediumId>,
    constants: Option<&Medium>,
    places: &[Place],
    rig: &Rig,
) -> (Roughness, Option<Amendment>) {
    let assumed = match constants {
        Some(medium) if medium.matter != Matter::Relief => medium.roughness(),
        _ => model.surface.alpha,
    };
    let unknown = |residual| Roughness {
        medium,
        alpha: assumed,
        within: None,
        residual,
        places: places.len(),
    };
    // A groove has no surface of its own.
    if places.len() < FEWEST || constants.is_some_and(|medium| medium.matter == Matter::Relief) {
        return (unknown(0.0), None);
    }
    let mut fit = Fit::new(model, constants, places, rig);
    let mut tried: Vec<(f64, f64)> = GRID.iter().map(|alpha| (*alpha, fit.at(*alpha))).collect();
    let best = |tried: &[(f64, f64)]| {
        let order = |a: &(usize, &(f64, f64)), b: &(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        tried.iter().enumerate().min_by(order).map_or(0, |(i, _)| i)
    };
    for _ in 0..GOLDEN {
        let i = best(&tried);
        // Into the wider gap beside the best.
        let gap = |a: usize, b: usize| (tried[b].0 / tried[a].0).ln();
        let below = if i > 0 { gap(i - 1, i) } else { 0.0 };
        let above = if i + 1 < tried.len() {
            gap(i, i + 1)
        } else {
            0.0
        };
        let (place, alpha) = match below > above {
            true => (i, (tried[i - 1].0 * tried[i].0).sqrt()),
            false => (i + 1, (tried[i].0 * tried[i + 1].0).sqrt()),
        };
        tried.insert(place, (alpha, fit.at(alpha)));
    }
    let i = best(&tried);
    let known = places.len() as f64 * (3.0 * rig.count() as f64 - 5.0);
    let inside = i > 0 && i + 1 < tried.len() && known > 0.0;
    let fitted = inside.then(|| parabola(&tried, i, known));
    let fitted = fitted.filter(|(alpha, bound)| *bound < WIDEST * alpha);
    // As it will be shown.
    fit.first = true;
    fit.at(fitted.map_or(assumed, |(alpha, _)| alpha));
    let roughness = match fitted {
        Some((alpha, bound)) => Roughness {
            alpha,
            within: Some(bound),
            ..unknown(fit.residual())
        },
        None => unknown(fit.residual()),
    };
    (roughness, Amendment::new(places, &fit.albedo()))
}

/// The least of the parabola around the place `i`, and within how much of it the sum rises by what
/// it is uncertain by, of so many values.
fn parabola(tried: &[(f64, f64)], i: usize, known: f64) -> (f64, f64) {
    let (alpha, least) = tried[i];
    // Wide enough that the rise is more than rounding, on both sides.
    let rise = least / known;
    let below = (0..i)
        .rev()
        .find(|j| tried[*j].1 > least + rise)
        .unwrap_or(0);
    let above = (i + 1..tried.len()).find(|j| tried[*j].1 > least + rise);
    let above = above.unwrap_or(tried.len() - 1);
    let [(x_0, y_0), (x_2, y_2)] = [tried[below], tried[above]];
    let (d_0, d_2) = ((y_0 - least) / (x_0 - alpha), (y_2 - least) / (x_2 - alpha));
    let curvature = (d_2 - d_0) / (x_2 - x_0);
    if curvature.is_nan() || curvature <= 0.0 {
        return (alpha, f64::INFINITY);
    }
    let slope = d_0 - curvature * (x_0 - alpha);
    let found = (alpha - 0.5 * slope / curvature).clamp(x_0, x_2);
    (found, SIGMAS * (rise / curvature).sqrt())
}

/// Places with what has been found of them so far.
struct Fit<'f> {
    spot: Spot<'f>,
    places: &'f [Place],
    /// Towards each lamp from each place, and what a perfect diffuser shows there.
    lamps: Vec<Vec<(DVec3, f64)>>,
    /// As [`place`] has it.
    found: Vec<[f64; 5]>,
    first: bool,
}

impl<'f> Fit<'f> {
    fn new(model: &'f Model, medium: Option<&Medium>, places: &'f [Place], rig: &Rig) -> Self {
        let lamps = places.iter().map(|place| {
            let lamp = |i| {
                let lit = rig.lamp(i, place.at);
                (lit.l, lit.gain)
            };
            (0..rig.count()).map(lamp).collect()
        });
        let spot = model.spot(medium);
        let found: Vec<[f64; 5]> = places.iter().map(|place| start(&spot, place)).collect();
        Self {
            spot,
            places,
            lamps: lamps.collect(),
            found,
            first: true,
        }
    }

    /// The sum of what is left over at this roughness, outliers by their weight.
    fn at(&mut self, alpha: f64) -> f64 {
        self.spot.set_roughness(alpha);
        let first = std::mem::replace(&mut self.first, false);
        let (spot, places, lamps) = (&self.spot, self.places, &self.lamps);
        let sums: Vec<f64> = self
            .found
            .par_iter_mut()
            .enumerate()
            .map_init(
                || spot.clone(),
                |spot, (i, found)| match first {
                    true => settle_anew(spot, &places[i], &lamps[i], found, STEPS[0]),
                    false => settle(spot, &places[i], &lamps[i], found, STEPS[1]),
                },
            )
            .collect();
        sums.iter().sum()
    }

    /// The albedo of each place.
    fn albedo(&self) -> Vec<DVec3> {
        let each = self.found.iter();
        each.map(|found| place::albedo(&self.spot, found)).collect()
    }

    /// As [`Roughness::residual`], of the last roughness.
    fn residual(&self) -> f64 {
        let mut spot = self.spot.clone();
        let (mut square, mut weights, mut mean, mut count) = (0.0, 0.0, 0.0, 0.0);
        for ((place, lamps), found) in self.places.iter().zip(&self.lamps).zip(&self.found) {
            for (off, shown) in left_over(&mut spot, place, lamps, found)
                .iter()
                .zip(&place.shown)
            {
                for c in 0..3 {
                    let weight = weight(off[c], shown[c]);
                    square += weight * off[c] * off[c];
                    weights += weight;
                    mean += shown[c];
                    count += 1.0;
                }
            }
        }
        let mean: f64 = mean / f64::max(count, 1.0);
        (square / f64::max(weights, 1e-12)).sqrt() / mean.max(1e-6)
    }
}

/// Finds normal and albedo of single places of a class whose roughness is known.
#[derive(Clone, Debug)]
pub struct Settler<'m> {
    spot: Spot<'m>,
}

impl<'m> Settler<'m> {
    /// Of the class of `medium`.
    pub fn new(model: &'m Model, medium: &Medium) -> Self {
        Self {
            spot: model.spot(Some(medium)),
        }
    }

    /// The normal and the albedo of a place.
    pub fn settle(&mut self, place: &Place, rig: &Rig) -> (DVec3, DVec3) {
        let lamps: Vec<(DVec3, f64)> = (0..rig.count())
            .map(|i| {
                let lit = rig.lamp(i, place.at);
                (lit.l, lit.gain)
            })
            .collect();
        let mut found = start(&self.spot, place);
        settle_anew(&mut self.spot, place, &lamps, &mut found, STEPS[0]);
        let normal = DVec3::new(found[0], found[1], 1.0).normalize();
        (normal, place::albedo(&self.spot, &found))
    }
}
