//! How deep ink is, by inverting the film that the study tier shows it as.
//!
//! A manifest has no map of depths: the study tier finds τ of each texel from its albedo over that
//! of the bare paper (`optics::ink`). What it needs for that is what this chain writes instead of
//! leaving it to a guess: the albedo of the bare paper from its own places (the lights of the whole
//! sheet otherwise, inked or not), a map of what is ink and what is dark paper or chalk, and the
//! roughness of both, which decides how much of a photograph is gloss. With these, τ is found here
//! exactly as it will be shown, and laid beside the drawing as a map of its own.

use glam::DVec3;
use rayon::prelude::*;

use super::model::Model;
use crate::{
    colour::srgb_decode,
    optics::medium::{Matter, Medium, MediumId},
};

/// Values of an encoded channel that depths are tabulated at.
const LEVELS: usize = 4096;
/// Depths beyond are shown as this.
const SHOWN_MAX: f64 = 6.0;
/// The share of an ink's places, from the palest, that is its full strength.
const STRONG: f64 = 0.95;

/// How deep an ink is, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InkDepth {
    pub medium: MediumId,
    /// Of the usual place.
    pub median: [f64; 3],
    /// At full strength: deeper than 95 % of its places.
    pub strong: [f64; 3],
}

/// Depths of a side's inks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Depths {
    pub inks: Vec<InkDepth>,
    /// τ that white is, in the map of depths; 0 without ink.
    pub white: f64,
    /// τ of green, from 0 to `white`, over all places; empty without ink.
    pub map: Vec<u16>,
}

/// Finds the depths of `classes`, whose media are `media` (`None` is bare paper), in a picture
/// that is sRGB-encoded.
pub fn depths(
    model: &Model,
    media: &[Option<Medium>],
    names: &[Option<MediumId>],
    classes: &[u8],
    albedo: &[[u16; 3]],
) -> Depths {
    let tables: Vec<Option<Vec<DVec3>>> = media
        .par_iter()
        .map(|medium| match medium.map(|medium| medium.matter) {
            Some(Matter::Film(_)) => Some(table(model, medium.as_ref())),
            _ => None,
        })
        .collect();
    let level = |v: u16| usize::from(v) * (LEVELS - 1) / 65535;
    let mut inks = Vec::new();
    for (class, (table, name)) in tables.iter().zip(names).enumerate() {
        let (Some(table), Some(medium)) = (table, name) else {
            continue;
        };
        // Depth falls with light: quantiles of the one are those of the other.
        let mut counts = vec![[0u64; 3]; LEVELS];
        for (_, rgb) in classes
            .iter()
            .zip(albedo)
            .filter(|(of, _)| usize::from(**of) == class)
        {
            for c in 0..3 {
                counts[level(rgb[c])][c] += 1;
            }
        }
        let quantile = |share: f64, c: usize| {
            let all: u64 = counts.iter().map(|count| count[c]).sum();
            let mut left = (1.0 - share) * all as f64;
            let at = counts.iter().position(|count| {
                left -= count[c] as f64;
                left <= 0.0 && count[c] > 0
            });
            at.map_or(0.0, |at| table[at][c])
        };
        inks.push(InkDepth {
            medium: *medium,
            median: [0, 1, 2].map(|c| quantile(0.5, c)),
            strong: [0, 1, 2].map(|c| quantile(STRONG, c)),
        });
    }
    if inks.is_empty() {
        return Depths::default();
    }
    let strongest = inks.iter().map(|ink| ink.strong[1]).fold(0.0, f64::max);
    // Half as much again, as the deepest places are what one looks for; to a tenth, as written.
    let white = ((15.0 * strongest).ceil() / 10.0).clamp(0.5, SHOWN_MAX);
    let map = classes
        .par_iter()
        .zip(albedo)
        .map(|(class, rgb)| {
            let table = tables.get(usize::from(*class)).and_then(Option::as_ref);
            let tau = table.map_or(0.0, |table| table[level(rgb[1])].y);
            ((tau / white).min(1.0) * 65535.0).round() as u16
        })
        .collect();
    Depths { inks, white, map }
}

/// τ by the encoded value of each channel.
fn table(model: &Model, medium: Option<&Medium>) -> Vec<DVec3> {
    let mut spot = model.spot(medium);
    let each = (0..LEVELS).map(|i| {
        let linear = srgb_decode(i as f64 / (LEVELS - 1) as f64);
        spot.set_albedo(DVec3::splat(linear));
        spot.depth()
    });
    each.collect()
}
