//! How far the study tier is from the judge where nobody has walked: between the views of the
//! subjects.
//!
//! Of each view and channel the logarithm of judge over study is known. It is smooth in what
//! decides the light's way: both inner cosines, the azimuth between light and eye, the roughness
//! of the surface, and how much of the paper's light the photograph shows. In between, the
//! logarithms are averaged with weights that fall with the distance in these (Shepard 1968).

use std::sync::LazyLock;

use glam::DVec3;

use super::{
    errors,
    judged::Judged,
    subject::{Lit, SUBJECTS, Subject, View},
};
use crate::optics::tier::Tier;

/// Distances that count as one: cosines, azimuth (as its cosine times both sines), roughness, and
/// logarithm of the photographed share.
const SCALES: [f64; 5] = [0.15, 0.15, 0.4, 0.2, 0.7];
/// Nearer nodes are one.
const NEAR: f64 = 1e-4;
/// Power of the distance's square by which weights fall.
const POWER: i32 = 2;
/// A photograph darker than this share of the paper's tells no more.
const DARKEST: f64 = 0.01;
/// No correction is larger: beyond, the walk is noise.
const LARGEST: f64 = 1.5;

/// What decides the light's way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place([f64; 5]);

impl Place {
    fn new(l: DVec3, v: DVec3, alpha: f64, share: f64) -> Self {
        let along = l.x * v.x + l.y * v.y;
        Self([
            l.z.clamp(0.0, 1.0),
            v.z.clamp(0.0, 1.0),
            along,
            alpha,
            share.clamp(DARKEST, 1.0).ln(),
        ])
    }

    fn distance_squared(&self, other: &Self) -> f64 {
        let apart = |i: usize| (self.0[i] - other.0[i]) / SCALES[i];
        (0..SCALES.len()).map(|i| apart(i) * apart(i)).sum()
    }
}

/// Logarithms of judge over study at places.
struct Known(Vec<(Place, f64)>);

static REFLECTED: LazyLock<Known> = LazyLock::new(|| {
    Known::of(&|subject| subject.lit == Lit::Lamps && subject.particles().is_none())
});
static THROUGH: LazyLock<Known> = LazyLock::new(|| Known::of(&|subject| subject.lit == Lit::Table));

impl Known {
    fn of(wanted: &dyn Fn(&Subject) -> bool) -> Self {
        let mut known = Vec::new();
        for subject in SUBJECTS.iter().filter(|subject| wanted(subject)) {
            let judged = Judged::of(subject);
            let spot = errors::spot(subject, &judged);
            let share = judged.photograph.mean / judged.bare.mean;
            for (view, truth) in subject.views().iter().zip(&judged.views) {
                let found = errors::shown(subject, &spot, Tier::Study, view);
                for channel in 0..3 {
                    let (found, truth) = (found[channel], truth.mean[channel]);
                    if found > 0.0 && truth > 0.0 {
                        let l = if subject.lit == Lit::Table {
                            DVec3::Z
                        } else {
                            view.l
                        };
                        let place = Place::new(l, view.v, subject.alpha(), share[channel]);
                        let ratio = (truth / found).ln().clamp(-LARGEST, LARGEST);
                        known.push((place, ratio));
                    }
                }
            }
        }
        Self(known)
    }

    fn at(&self, place: &Place) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (at, ratio) in &self.0 {
            let weight = 1.0 / (at.distance_squared(place) + NEAR).powi(POWER);
            sum += weight * ratio;
            weights += weight;
        }
        if weights > 0.0 { sum / weights } else { 0.0 }
    }
}

fn channels(known: &Known, l: DVec3, v: DVec3, alpha: f64, share: DVec3) -> DVec3 {
    share.map(|share| known.at(&Place::new(l, v, alpha, share)).exp())
}

/// Judge over study per channel for reflected light: unit vectors in the frame of the normal, the
/// surface's roughness, and the photographed share of the bare paper's albedo.
pub fn reflected(l: DVec3, v: DVec3, alpha: f64, share: DVec3) -> DVec3 {
    channels(&REFLECTED, l, v, alpha, share)
}

/// The same for a light table.
pub fn through(v: DVec3, alpha: f64, share: DVec3) -> DVec3 {
    channels(&THROUGH, DVec3::Z, v, alpha, share)
}

/// How a view of a subject is placed, for tests of the interpolation.
pub fn at_view(subject: &Subject, view: &View, share: DVec3) -> DVec3 {
    match subject.lit {
        Lit::Table => through(view.v, subject.alpha(), share),
        Lit::Lamps | Lit::Raking => reflected(view.l, view.v, subject.alpha(), share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The neighbours pull a little at a node.
    const AT_NODES: f64 = 0.05;

    #[test]
    fn where_the_judge_has_walked_study_is_brought_to_the_judge() {
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for subject in &SUBJECTS {
            if subject.particles().is_some() || subject.lit == Lit::Raking {
                continue;
            }
            let judged = Judged::of(subject);
            let spot = errors::spot(subject, &judged);
            let share = judged.photograph.mean / judged.bare.mean;
            for (view, truth) in subject.views().iter().zip(&judged.views) {
                let found = errors::shown(subject, &spot, Tier::Study, view);
                let corrected = found * at_view(subject, view, share);
                before.push((found.y / truth.mean.y).ln().abs());
                after.push((corrected.y / truth.mean.y).ln().abs());
            }
        }
        let mean = |off: &[f64]| off.iter().sum::<f64>() / off.len() as f64;
        let (before, after) = (mean(&before), mean(&after));
        assert!(after < AT_NODES, "{before} {after}");
        // Uncorrected, the same comparison fails.
        assert!(before > 2.0 * after, "{before} {after}");
    }
}
