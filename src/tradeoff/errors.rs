//! How far each tier is from the judge.

use std::sync::Arc;

use glam::DVec3;

use super::{
    judged::Judged,
    subject::{Lit, Subject, View},
};
use crate::{
    colour::{delta_e00, lab_from_linear},
    optics::{
        bsdf::Specimen,
        lamp::Incidence,
        matter::{Cover, Particle},
        refraction::PathTable,
        shade::{Beam, Behind, Illumination, Spot},
        study::Study,
        table::InterfaceTable,
        tier::{Surface, Tier},
    },
};

/// Error of a tier over the display picture of a subject.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square of the error over the judge's value, all channels of all elements; the
    /// walk's own variance is taken out.
    pub rms: f64,
    /// ΔE00 of what a display shows.
    pub mean: f64,
    pub p95: f64,
    pub max: f64,
}

/// What a display shows of light where a perfect diffuser is shown as full white: CIELAB (D65) of
/// linear sRGB within its gamut.
pub fn displayed(light: DVec3) -> [f64; 3] {
    lab_from_linear(light.clamp(DVec3::ZERO, DVec3::ONE).to_array())
}

/// Mean, 95th percentile and maximum; zeros of nothing.
pub fn summary(mut differences: Vec<f64>) -> [f64; 3] {
    differences.sort_by(f64::total_cmp);
    let Some(&max) = differences.last() else {
        return [0.0; 3];
    };
    let count = differences.len();
    let p95 = differences[((0.95 * count as f64).ceil() as usize).clamp(1, count) - 1];
    [differences.iter().sum::<f64>() / count as f64, p95, max]
}

/// A subject as the tiers know it: from its photographs.
pub fn spot(subject: &Subject, judged: &Judged) -> Spot {
    let surface = |albedo: DVec3, alpha: f64| Surface::new(albedo, alpha, subject.index(), 1.0);
    let bare = surface(judged.bare.mean, subject.bare_alpha());
    let table = |alpha: f64| InterfaceTable::at_roughness(alpha, subject.index(), 1.0);
    // As on the stage, one table of paths serves paper and ink of another roughness.
    let paths = if subject.alpha() == subject.bare_alpha() {
        Arc::new(PathTable::at_roughness(bare.alpha, subject.index()))
    } else {
        PathTable::new(subject.index())
    };
    let study = Study::new(&bare, &table(bare.alpha), paths, subject.slab());
    let mut cover = Cover::default();
    let mut particle = Particle {
        alpha: 1.0,
        ..Particle::default()
    };
    if let Some((constants, covered)) = subject.particles() {
        particle = Particle::new(&constants);
        cover.particles = covered;
        cover.grains = particle.albedo * covered;
    } else if subject.depth() != [0.0; 3] {
        cover.film = 1.0;
    }
    let specimen = Specimen {
        surface: surface(judged.photograph.mean, subject.alpha()),
        interface: table(subject.alpha()),
        study,
        cover,
        particle,
        body_albedo: DVec3::ZERO,
        body_through: DVec3::ONE,
        left: DVec3::ONE,
    };
    let behind = Behind {
        bare: judged.bare.mean,
        other: judged.back.mean,
        other_bare: judged.bare.mean,
        clear: 1.0,
    };
    Spot::flat(specimen, behind)
}

/// π times what `tier` says of one view.
pub fn shown(subject: &Subject, spot: &Spot, tier: Tier, view: &View) -> DVec3 {
    let mut light = Illumination::default();
    match subject.lit {
        Lit::Table => light.table = DVec3::ONE,
        Lit::Lamps | Lit::Raking => light.beams.push(Beam {
            incidence: Incidence {
                l: view.l,
                e: DVec3::splat(std::f64::consts::PI / view.l.z),
            },
            // Only study casts the relief's shadows.
            visible: if subject.lit == Lit::Raking && tier == Tier::Study {
                view.marched()
            } else {
                1.0
            },
        }),
    }
    let spot = Spot {
        normal: view.normal,
        ..spot.clone()
    };
    spot.radiance(tier, view.v, &light)
}

/// The errors of `tier` on `subject`.
pub fn of(subject: &Subject, tier: Tier) -> Errors {
    let judged = Judged::of(subject);
    let spot = spot(subject, &judged);
    let views = subject.views();
    let pairs = views.iter().zip(&judged.views);
    let shown: Vec<(DVec3, &super::judged::Colour)> = pairs
        .map(|(view, truth)| (shown(subject, &spot, tier, view), truth))
        .collect();
    let differences = shown
        .iter()
        .map(|(found, truth)| delta_e00(displayed(*found), displayed(truth.mean)))
        .collect();
    let [mean, p95, max] = summary(differences);
    Errors {
        rms: rms(&shown),
        mean,
        p95,
        max,
    }
}

/// Where the judge finds less, as in shadows and full ink, errors are over this share of white.
const DARK: f64 = 0.02;

fn rms(shown: &[(DVec3, &super::judged::Colour)]) -> f64 {
    let sum: f64 = shown
        .iter()
        .map(|(found, truth)| {
            let off = *found - truth.mean;
            let scale = truth.mean.max(DVec3::splat(DARK));
            ((off * off - truth.variance) / (scale * scale)).element_sum() / 3.0
        })
        .sum();
    (sum / shown.len().max(1) as f64).max(0.0).sqrt()
}

/// What the judge's own noise makes of a display picture: ΔE00 of one standard deviation, mean,
/// 95th percentile and maximum, and its relative RMS.
pub fn noise(subject: &Subject) -> Errors {
    let judged = Judged::of(subject);
    let deviate = |colour: &super::judged::Colour| {
        let sigma = colour.variance.map(f64::sqrt);
        delta_e00(displayed(colour.mean + sigma), displayed(colour.mean))
    };
    let [mean, p95, max] = summary(judged.views.iter().map(deviate).collect());
    let relative = |colour: &super::judged::Colour| {
        let scale = colour.mean.max(DVec3::splat(DARK));
        (colour.variance / (scale * scale)).element_sum() / 3.0
    };
    let sum: f64 = judged.views.iter().map(relative).sum();
    Errors {
        rms: (sum / judged.views.len().max(1) as f64).sqrt(),
        mean,
        p95,
        max,
    }
}
