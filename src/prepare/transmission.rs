//! The sheet on a light table → how much its paper passes from place to place: thickness, laid and
//! chain lines, a watermark.
//!
//! Such a photograph has the ink in it, which the study tier adds anew from the albedo; so here it
//! is taken out, by solving for the paper alone what the tier would show:
//!
//! > photographed = level · through(ink of the place, clear),  clear = 1 on the mean paper.
//!
//! Where the light table was photographed alone at the same exposure, the level is known, and says
//! how thick the sheet is for light.

use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    PrepareError,
    capture::{Capture, Shots},
    flat_field::FlatField,
    model::Model,
    photographs::Stack,
};
use crate::{
    colour::srgb_decode,
    optics::medium::{Matter, Medium},
};

/// Linear light from which a channel counts as clipped.
const CLIPPED: f32 = 0.995;
/// The share of the sheet that may be clipped: holes, losses, and an irregular edge.
const CLIPPED_SHARE: f64 = 0.05;
/// What is darker on all the sheet was not lit.
const DARK: f64 = 2e-3;
/// What a camera's colours count: as in stereo.
const GREY: DVec3 = DVec3::new(0.25, 0.5, 0.25);
/// Nodes along each channel of the table of what passes.
const NODES: usize = 17;
/// Clearness at which what passes is tabulated.
const CLEAR: [f64; 3] = [0.5, 1.0, 2.0];
/// What leaves a smaller share of the bare paper's light hides the paper: ink, whose depth is known,
/// and grains or body colour, whose coverage is known less well.
const HIDDEN: [f64; 2] = [0.2, 0.5];
/// The least and the most that paper passes over the mean sheet, which the map shows as black and
/// white or nearly so: beyond are holes and patches.
const RANGE: [f64; 2] = [0.02, 2.0];
/// How often the mean of the map is brought to 1.
const ROUNDS: usize = 2;
/// Thicknesses in µm that a sheet may have; else the light table was exposed otherwise.
const THICKNESS_UM: [f64; 2] = [30.0, 600.0];
/// Places that the level is taken from, at most.
const LEVELLED: usize = 200_000;

/// Why a photograph in transmitted light cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TransmissionError {
    #[error(
        "the sheet is saturated on {share:.1} % of the picture; photograph it with less exposure"
    )]
    Saturated { share: f64 },
    #[error(
        "nothing of the light table comes through; photograph it with more exposure, other lamps off"
    )]
    Dark,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmission {
    /// Whether the light table was photographed alone; else it is taken for even.
    pub levelled: bool,
    /// In µm, at the catalogue's scattering, as the light that comes through says; `None` where the
    /// table's own light is not known.
    pub thickness_um: Option<f64>,
    /// Share of a light table's light that bare paper passes; `None` as above.
    pub passes: Option<f64>,
    /// The share of the sheet where ink hides the paper, which is taken for mean paper there.
    pub hidden: f64,
    /// 5th and 95th percentile of what paper passes, over its mean.
    pub spread: [f64; 2],
}

/// The recto, as far as it is known.
pub struct Side<'s> {
    pub shots: &'s Shots,
    /// sRGB-encoded.
    pub albedo: &'s [[u16; 3]],
    /// The class of each pixel, and what each class is; `None` is bare paper.
    pub classes: &'s [u8],
    pub media: &'s [Option<Medium>],
}

/// Reads the photograph, and gives how much more than the mean sheet the paper of each place
/// passes: 0 … 65535 for 0 … 2.
///
/// # Errors
/// [`PrepareError`] of the photograph, or of that of the light table.
pub fn transmission(
    capture: &Capture,
    side: &Side<'_>,
    model: &Model,
    scratch: &Path,
) -> Result<Option<(Vec<u16>, Transmission)>, PrepareError> {
    let Some(frame) = &capture.transmitted else {
        return Ok(None);
    };
    let refused = |why| PrepareError::Transmitted {
        path: frame.photograph.clone(),
        why,
    };
    let (grey, clipped) = read(capture, side, &frame.photograph, scratch)?;
    if clipped > CLIPPED_SHARE {
        return Err(refused(TransmissionError::Saturated {
            share: clipped * 100.0,
        }));
    }
    let bare = of_bare(&grey, side);
    if bare.is_nan() || bare < DARK {
        return Err(refused(TransmissionError::Dark));
    }
    // A renderer takes the mean of the map for the mean sheet: so it has to be.
    let mut mean = 1.0;
    let mut solved = solve(model, side, frame.flat_field.is_some(), (&grey, bare), mean);
    for _ in 1..ROUNDS {
        mean *= solved.mean;
        solved = solve(model, side, frame.flat_field.is_some(), (&grey, bare), mean);
    }
    let told = Transmission {
        levelled: frame.flat_field.is_some(),
        thickness_um: solved.thickness_um,
        passes: solved.thickness_um.map(|_| bare),
        hidden: solved.hidden,
        spread: solved.spread.map(|v| v / solved.mean),
    };
    Ok(Some((solved.map, told)))
}

/// A map, and what it rests on.
struct Solved {
    map: Vec<u16>,
    mean: f64,
    thickness_um: Option<f64>,
    hidden: f64,
    spread: [f64; 2],
}

/// Solves what is photographed, of which bare paper's median is `bare`, where the mean sheet
/// passes `mean` times what bare paper does.
fn solve(
    model: &Model,
    side: &Side<'_>,
    levelled: bool,
    (grey, bare): (&[f32], f64),
    mean: f64,
) -> Solved {
    let mut model = std::borrow::Cow::Borrowed(model);
    let mut thickness_um = None;
    if levelled {
        let found = thickness(&model, bare, 1.0 / mean);
        if (THICKNESS_UM[0]..=THICKNESS_UM[1]).contains(&found) {
            model = std::borrow::Cow::Owned(model.with(|paper| paper.thickness_um = found));
            thickness_um = Some(found);
        }
    }
    let tables: Vec<Table> = side
        .media
        .iter()
        .map(|medium| Table::new(&model, medium.as_ref()))
        .collect();
    let mut spot = model.spot(None);
    spot.set_albedo(model.surface.albedo);
    let whole = spot.passes(1.0).dot(GREY);
    let level = (bare / spot.passes(1.0 / mean).dot(GREY)).max(1e-12);
    let scale = 65535.0 / RANGE[1];
    let of_place = |((value, rgb), class): ((&f32, &[u16; 3]), &u8)| -> (u16, bool) {
        let Some(table) = tables.get(usize::from(*class)) else {
            return (scale as u16, true);
        };
        let at = table.at(*rgb);
        let hidden = at[1].exp() < table.hidden * whole;
        let clear = match hidden {
            true => 1.0,
            // What ink lets through, and the paper under it.
            false => clear(at, (f64::from(*value) / level).max(1e-9).ln()),
        };
        ((clear * scale).round() as u16, hidden)
    };
    let found = grey
        .par_iter()
        .zip(side.albedo)
        .zip(side.classes)
        .map(of_place);
    let (map, hidden): (Vec<u16>, Vec<bool>) = found.unzip();
    let count = map.len().max(1) as f64;
    let mut sampled: Vec<u16> = map
        .iter()
        .step_by((map.len() / LEVELLED).max(1) | 1)
        .copied()
        .collect();
    sampled.sort_unstable();
    let quantile = |share: f64| {
        let i = (share * sampled.len().saturating_sub(1) as f64) as usize;
        sampled.get(i).map_or(1.0, |v| f64::from(*v) / scale)
    };
    Solved {
        mean: map.iter().map(|v| f64::from(*v)).sum::<f64>() / count / scale,
        thickness_um,
        hidden: hidden.iter().filter(|hidden| **hidden).count() as f64 / count,
        spread: [quantile(0.05), quantile(0.95)],
        map,
    }
}

/// Grey of the photograph over that of the light table, and the share of it that is clipped.
fn read(
    capture: &Capture,
    side: &Side<'_>,
    path: &Path,
    scratch: &Path,
) -> Result<(Vec<f32>, f64), PrepareError> {
    let crop = side.shots.crop;
    let flat = capture
        .transmitted
        .as_ref()
        .and_then(|t| t.flat_field.as_ref());
    let field = flat
        .map(|card| FlatField::read(card, None, capture.encoding, crop, 1.0, scratch))
        .transpose()?;
    let paths = [path.to_owned()];
    let mut stack = Stack::open(&paths, None, capture.encoding, crop, scratch)?;
    let mut grey = Vec::with_capacity(crop.width() * crop.height());
    let mut clipped = 0u64;
    while let Some(mut band) = stack.next()? {
        let [r, g, b] = &mut band.planes[0];
        for row in 0..band.rows {
            let range = row * band.width..(row + 1) * band.width;
            let over = range
                .clone()
                .filter(|i| r[*i].max(g[*i]).max(b[*i]) >= CLIPPED);
            clipped += over.count() as u64;
            if let Some(field) = &field {
                let planes = [
                    &mut r[range.clone()],
                    &mut g[range.clone()],
                    &mut b[range.clone()],
                ];
                field.divide(band.top + row, planes);
            }
            let [x, y, z] = GREY.as_vec3().to_array();
            grey.extend(range.map(|i| x * r[i] + y * g[i] + z * b[i]));
        }
    }
    let share = match stack.is_float() {
        true => 0.0,
        false => clipped as f64 / grey.len().max(1) as f64,
    };
    Ok((grey, share))
}

/// Some of the values, from all over.
fn every(values: &[f32]) -> impl Iterator<Item = &f32> {
    values.iter().step_by((values.len() / LEVELLED).max(1) | 1)
}

/// The median of what bare paper passes; of all, where none is bare.
fn of_bare(grey: &[f32], side: &Side<'_>) -> f64 {
    let step = (grey.len() / LEVELLED).max(1) | 1;
    let places = grey.iter().zip(side.classes).step_by(step);
    let bare = |class: u8| {
        side.media
            .get(usize::from(class))
            .is_none_or(Option::is_none)
    };
    let mut found: Vec<f32> = places
        .filter(|(_, class)| bare(**class))
        .map(|(value, _)| *value)
        .collect();
    if found.is_empty() {
        found = every(grey).copied().collect();
    }
    let middle = found.len() / 2;
    f64::from(*found.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// The thickness in µm of the mean sheet at which paper that is `clear` passes `bare` of a light
/// table's light.
fn thickness(model: &Model, bare: f64, clear: f64) -> f64 {
    let passes = |um: f64| {
        let model = model.with(|paper| paper.thickness_um = um);
        let mut spot = model.spot(None);
        spot.set_albedo(model.surface.albedo);
        spot.passes(clear).dot(GREY)
    };
    // A little more than what a sheet may have, so that what is beyond shows as that.
    let (mut low, mut high) = (0.9 * THICKNESS_UM[0], 1.1 * THICKNESS_UM[1]);
    for _ in 0..14 {
        let middle = (low * high).sqrt();
        if passes(middle) > bare {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low * high).sqrt()
}

/// ln of what a place passes at each of [`CLEAR`], by its encoded colour.
struct Table {
    nodes: Vec<[f32; 3]>,
    /// As [`HIDDEN`].
    hidden: f64,
}

impl Table {
    fn new(model: &Model, medium: Option<&Medium>) -> Self {
        let spot = model.spot(medium);
        let nodes = (0..NODES * NODES * NODES)
            .into_par_iter()
            .map_init(
                || spot.clone(),
                |spot, i| {
                    let place = [i / (NODES * NODES), i / NODES % NODES, i % NODES];
                    let linear = place.map(|k| srgb_decode(k as f64 / (NODES - 1) as f64));
                    spot.set_albedo(linear.into());
                    CLEAR.map(|clear| spot.passes(clear).dot(GREY).max(1e-9).ln() as f32)
                },
            )
            .collect();
        let covers = medium
            .is_some_and(|medium| matches!(medium.matter, Matter::Particles(_) | Matter::Body(_)));
        Self {
            nodes,
            hidden: HIDDEN[usize::from(covers)],
        }
    }

    fn at(&self, rgb: [u16; 3]) -> [f64; 3] {
        let scale = (NODES - 1) as f64 / 65535.0;
        let place = rgb.map(|v| f64::from(v) * scale);
        let low = place.map(|v| (v as usize).min(NODES - 2));
        let part: [f64; 3] = std::array::from_fn(|c| place[c] - low[c] as f64);
        let mut sum = [0.0; 3];
        for corner in 0..8usize {
            let bit = |c: usize| corner >> c & 1;
            let weight: f64 = (0..3)
                .map(|c| if bit(c) == 1 { part[c] } else { 1.0 - part[c] })
                .product();
            let [r, g, b]: [usize; 3] = std::array::from_fn(|c| low[c] + bit(c));
            let node = self.nodes[(r * NODES + g) * NODES + b];
            for (sum, value) in sum.iter_mut().zip(node) {
                *sum += weight * f64::from(value);
            }
        }
        sum
    }
}

/// How clear paper is that passes `ln_passed`, where it would pass `at` at each of [`CLEAR`]: on
/// the parabola of both logarithms.
fn clear(at: [f64; 3], ln_passed: f64) -> f64 {
    // ln CLEAR is −u, 0 and u.
    let u = CLEAR[2].ln();
    let slope = (at[2] - at[0]) / (2.0 * u);
    let bend = (at[2] + at[0] - 2.0 * at[1]) / (2.0 * u * u);
    let wanted = ln_passed - at[1];
    let mut x = wanted / slope.max(0.05);
    for _ in 0..4 {
        let here = slope + 2.0 * bend * x;
        x -= (slope * x + bend * x * x - wanted) / here.max(0.2 * slope.max(0.05));
    }
    let [least, most] = RANGE;
    x.clamp(least.ln(), most.ln()).exp()
}
