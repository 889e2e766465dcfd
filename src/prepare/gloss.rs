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
//! Lamps of one height over an even surface show gloss and albedo as one: then nothing is least,
//! the bound is wide, and the roughness stays assumed.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    capture::Crop,
    linear::{least_squares, solve_positive},
    materials::Known,
    model::{Model, Spot},
    photographs::Band,
    stereo::Rig,
};
use crate::optics::medium::{Matter, Medium, MediumId};

/// Places kept of a side, and of each swatch, in the first run through the photographs.
const KEPT: usize = 60_000;
const KEPT_OF_SWATCH: usize = 1_500;
/// Bytes that they may take.
const KEPT_BYTES: usize = 96 << 20;
/// Places that a fit takes, and the fewest that it is done with.
const PLACES: usize = 120;
const FEWEST: usize = 40;
/// Roughnesses looked at first.
const GRID: [f64; 9] = [0.1, 0.14, 0.2, 0.28, 0.38, 0.5, 0.64, 0.8, 1.0];
/// Steps between the best of them and its neighbours.
const GOLDEN: usize = 6;
/// Steps of each place's own fit, first and once it starts from a roughness nearby.
const STEPS: [usize; 2] = [5, 3];
/// Noise of a photograph: of white, and of the value.
const NOISE: [f64; 2] = [0.0015, 0.01];
/// How many times the noise is an outlier.
const OUTLIER: f64 = 3.0;
/// How well stereo knows a slope where it did not know the gloss.
const SLOPE_OFF: f64 = 0.3;
/// Shares of stereo's slope that each place's fit starts from, the first time: a narrow gleam has
/// turned it towards a lamp.
const STARTS: [f64; 3] = [1.0, 0.5, 0.0];
/// A bound wider than this share of the roughness says nothing.
const WIDEST: f64 = 0.25;
/// Standard deviations of the bound that is told.
const SIGMAS: f64 = 2.0;
/// What slopes and the logarithm of an albedo move by for their derivatives.
const STEP: f64 = 1e-4;
/// Light from below the surface that is as good as none.
const BLACK: f64 = 1e-4;
/// The least of it that a fit starts from.
const DARK: f64 = 3e-3;

/// Photographs of places all over a side.
#[derive(Clone, Debug)]
pub struct Samples {
    width: usize,
    step: usize,
    swatches: Vec<(Crop, usize)>,
    lamps: usize,
    /// Column and row.
    places: Vec<[u32; 2]>,
    /// Of each place, all its photographs.
    shown: Vec<[f32; 3]>,
}

impl Samples {
    /// Of a side of this size under so many lamps.
    pub fn new([width, height]: [usize; 2], lamps: usize, swatches: &[Known]) -> Self {
        let most = KEPT_BYTES / (lamps.max(1) * size_of::<[f32; 3]>());
        let of_swatches = (KEPT_OF_SWATCH * swatches.len()).min(most / 2);
        let most = KEPT.min(most - of_swatches).max(1);
        let every = |pixels: usize, most: usize| {
            ((pixels as f64 / most.max(1) as f64).sqrt().ceil() as usize).max(1)
        };
        let of_each = of_swatches / swatches.len().max(1);
        let swatches = swatches.iter().map(|swatch| {
            let pixels = swatch.rect.width() * swatch.rect.height();
            (swatch.rect, every(pixels, of_each))
        });
        Self {
            width,
            step: every(width * height, most),
            swatches: swatches.collect(),
            lamps,
            places: Vec::new(),
            shown: Vec::new(),
        }
    }

    fn wants(&self, x: usize, y: usize) -> bool {
        // A step aside in each row of samples, so that no column of laid lines is all there is.
        let row = y / self.step;
        if y.is_multiple_of(self.step) && (x + row).is_multiple_of(self.step) {
            return true;
        }
        self.swatches.iter().any(|(rect, step)| {
            let (left, top) = (rect.left as usize, rect.top as usize);
            let inside = (left..rect.right as usize).contains(&x)
                && (top..rect.bottom as usize).contains(&y);
            inside && (x - left).is_multiple_of(*step) && (y - top).is_multiple_of(*step)
        })
    }

    /// Reads a band whose light was divided out.
    pub fn add(&mut self, band: &Band) {
        for row in 0..band.rows {
            let y = band.top + row;
            let at_all = y.is_multiple_of(self.step)
                || self
                    .swatches
                    .iter()
                    .any(|(rect, _)| (rect.top as usize..rect.bottom as usize).contains(&y));
            if !at_all {
                continue;
            }
            let photographs: Vec<[&[f32]; 3]> = (0..self.lamps).map(|i| band.row(i, row)).collect();
            for x in 0..band.width.min(self.width) {
                if self.wants(x, y) {
                    self.places.push([x as u32, y as u32]);
                    let each = photographs.iter();
                    self.shown
                        .extend(each.map(|planes| planes.map(|plane| plane[x])));
                }
            }
        }
    }
}

/// A place with all its photographs, in the sheet's colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Where its middle is, in pixels.
    pub at: DVec2,
    pub shown: Vec<DVec3>,
    /// As stereo found them.
    pub normal: DVec3,
    pub albedo: DVec3,
}

/// What a side says of its sampled places.
pub struct Sheet<'s> {
    /// The class of each pixel.
    pub classes: &'s [u8],
    pub normals: &'s [[f32; 3]],
    /// Linear.
    pub albedo: &'s dyn Fn(usize) -> DVec3,
    /// From a photograph's colours to those of the albedo.
    pub colour: &'s dyn Fn([f32; 3]) -> DVec3,
}

impl Samples {
    /// Places of a class that are surrounded by their own, at most as many as a fit takes, from
    /// all over.
    pub fn of_class(&self, class: u8, sheet: &Sheet<'_>) -> Vec<Place> {
        let height = sheet.classes.len() / self.width.max(1);
        let own = |i: &usize| {
            let [x, y] = self.places[*i].map(|v| v as usize);
            (y.saturating_sub(1)..(y + 2).min(height)).all(|y| {
                let line = y * self.width;
                let row = x.saturating_sub(1)..(x + 2).min(self.width);
                row.into_iter().all(|x| sheet.classes[line + x] == class)
            })
        };
        let inside: Vec<usize> = (0..self.places.len()).filter(own).collect();
        let count = inside.len().min(PLACES);
        let place = |k: usize| {
            let i = inside[k * inside.len() / count];
            let [x, y] = self.places[i].map(|v| v as usize);
            let at = y * self.width + x;
            let shown = &self.shown[i * self.lamps..(i + 1) * self.lamps];
            Place {
                at: DVec2::new(x as f64 + 0.5, y as f64 + 0.5),
                shown: shown.iter().map(|rgb| (sheet.colour)(*rgb)).collect(),
                normal: DVec3::from(sheet.normals[at].map(f64::from)).normalize_or(DVec3::Z),
                albedo: (sheet.albedo)(at),
            }
        };
        (0..count).map(place).collect()
    }
}

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

/// How the albedo of a class differs from what stereo made of it: a sum of 1, the albedo and the
/// square of the slope, with these factors for each channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amendment {
    pub factors: [[f64; 3]; 3],
}

impl Amendment {
    fn terms(albedo: f64, normal: DVec3) -> [f64; 3] {
        /// Beyond, a slope is a mistake or an edge.
        const STEEPEST: f64 = 0.5;
        let [p, q] = slopes(normal);
        [1.0, albedo, (p * p + q * q).min(STEEPEST * STEEPEST)]
    }

    /// Of places before and after their fit. `None` where there are too few.
    fn new(places: &[Place], found: &[DVec3]) -> Option<Self> {
        /// Of the mean square of the terms: where a class has one albedo, the constant is enough.
        const RIDGE: f64 = 1e-4;
        let mut factors = [[0.0; 3]; 3];
        for (c, factors) in factors.iter_mut().enumerate() {
            let rows = places
                .iter()
                .map(|place| Self::terms(place.albedo[c], place.normal));
            let rows: Vec<Vec<f64>> = rows.map(|row| row.to_vec()).collect();
            let each = places.iter().zip(found);
            let off: Vec<f64> = each
                .map(|(place, found)| found[c] - place.albedo[c])
                .collect();
            let mut weights = vec![1.0; rows.len()];
            // Places in shadow, and specks, are forgotten.
            for _ in 0..4 {
                let fitted = least_squares(&rows, &weights, std::slice::from_ref(&off), RIDGE)?;
                let fitted = fitted.first()?;
                let left = |i: usize| {
                    let terms = rows[i].iter().zip(fitted);
                    off[i] - terms.map(|(term, factor)| term * factor).sum::<f64>()
                };
                let mut sizes: Vec<f64> = (0..rows.len()).map(|i| left(i).abs()).collect();
                sizes.sort_by(f64::total_cmp);
                let scale = OUTLIER * sizes[sizes.len() / 2].max(1e-6);
                for (i, weight) in weights.iter_mut().enumerate() {
                    *weight = 1.0 / (1.0 + (left(i) / scale).powi(2));
                }
                factors.copy_from_slice(fitted);
            }
        }
        Some(Self { factors })
    }

    /// A linear albedo where the surface faces along `normal`, put right.
    pub fn apply(&self, albedo: DVec3, normal: DVec3) -> DVec3 {
        let amended = |c: usize| {
            let terms = Self::terms(albedo[c], normal);
            let off: f64 = terms.iter().zip(self.factors[c]).map(|(t, f)| t * f).sum();
            // No class is that far off.
            (albedo[c] + off).clamp(0.25 * albedo[c], 2.0 * albedo[c] + 0.02)
        };
        DVec3::new(amended(0), amended(1), amended(2))
    }
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
    /// Slopes of the normal, and the logarithm of the albedo without what the surface itself adds:
    /// so it never is below none, where nothing would change with it.
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
        let floor = spot.floor();
        let found = places.iter().map(|place| {
            let [p, q] = slopes(place.normal);
            let [r, g, b] = (place.albedo - floor).to_array().map(|v| v.max(DARK).ln());
            [p, q, r, g, b]
        });
        Self {
            spot,
            places,
            lamps: lamps.collect(),
            found: found.collect(),
            first: true,
        }
    }

    /// The sum of what is left over at this roughness, outliers by their weight.
    fn at(&mut self, alpha: f64) -> f64 {
        self.spot.set_roughness(alpha);
        let starts: &[f64] = if self.first { &STARTS } else { &[1.0] };
        let steps = STEPS[usize::from(!self.first)];
        self.first = false;
        let (spot, places, lamps) = (&self.spot, self.places, &self.lamps);
        let sums: Vec<f64> = self
            .found
            .par_iter_mut()
            .enumerate()
            .map_init(
                || spot.clone(),
                |spot, (i, found)| {
                    let settled = starts.iter().map(|share| {
                        let mut start = *found;
                        start[..2].iter_mut().for_each(|slope| *slope *= share);
                        let left = settle(spot, &places[i], &lamps[i], &mut start, steps);
                        (left, start)
                    });
                    let best = settled.min_by(|a, b| a.0.total_cmp(&b.0));
                    let (left, start) = best.unwrap_or((0.0, *found));
                    *found = start;
                    left
                },
            )
            .collect();
        sums.iter().sum()
    }

    /// The albedo of each place.
    fn albedo(&self) -> Vec<DVec3> {
        let floor = self.spot.floor();
        let each = self.found.iter();
        each.map(|[_, _, r, g, b]| DVec3::new(*r, *g, *b).exp() + floor)
            .collect()
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

fn slopes(n: DVec3) -> [f64; 2] {
    let up = n.z.max(0.1);
    [n.x / up, n.y / up]
}

fn noise(shown: f64) -> f64 {
    NOISE[0] + NOISE[1] * shown.max(0.0)
}

/// Cauchy's, of what is left over.
fn weight(off: f64, shown: f64) -> f64 {
    let u = off / (OUTLIER * noise(shown));
    1.0 / (1.0 + u * u)
}

fn left_over(
    spot: &mut Spot<'_>,
    place: &Place,
    lamps: &[(DVec3, f64)],
    found: &[f64; 5],
) -> Vec<DVec3> {
    let [p, q, r, g, b] = *found;
    let normal = DVec3::new(p, q, 1.0).normalize();
    let below = DVec3::new(r, g, b).clamp(DVec3::splat(BLACK.ln()), DVec3::ZERO);
    spot.set_albedo(below.exp() + spot.floor());
    let each = lamps.iter().zip(&place.shown);
    each.map(|((l, gain), shown)| spot.shown(normal, *l) * *gain - *shown)
        .collect()
}

/// What is left over of a place, outliers by their weight, and of what is known of its normal.
fn sum(off: &[DVec3], place: &Place, found: &[f64; 5]) -> f64 {
    let s = OUTLIER * OUTLIER;
    let each = off.iter().zip(&place.shown).flat_map(|(off, shown)| {
        (0..3).map(|c| {
            let u = off[c] / noise(shown[c]);
            s * (u * u / s).ln_1p()
        })
    });
    let known = slopes(place.normal);
    let moved = (0..2).map(|i| ((found[i] - known[i]) / SLOPE_OFF).powi(2));
    each.sum::<f64>() + moved.sum::<f64>()
}

/// Brings a place's normal and albedo nearest to its photographs (Levenberg & Marquardt), and
/// gives what is left over.
fn settle(
    spot: &mut Spot<'_>,
    place: &Place,
    lamps: &[(DVec3, f64)],
    found: &mut [f64; 5],
    steps: usize,
) -> f64 {
    let mut off = left_over(spot, place, lamps, found);
    let mut least = sum(&off, place, found);
    let known = slopes(place.normal);
    let mut damping = 1e-3;
    for _ in 0..steps {
        let moved = |spot: &mut Spot<'_>, which: std::ops::Range<usize>| {
            let mut moved = *found;
            moved[which].iter_mut().for_each(|v| *v += STEP);
            left_over(spot, place, lamps, &moved)
        };
        // A channel's albedo changes its own light alone, or nearly so.
        let by = [moved(spot, 0..1), moved(spot, 1..2), moved(spot, 2..5)];
        let mut a = vec![vec![0.0; 5]; 5];
        let mut right = vec![0.0; 5];
        for i in 0..2 {
            a[i][i] += 1.0 / (SLOPE_OFF * SLOPE_OFF);
            right[i] += (known[i] - found[i]) / (SLOPE_OFF * SLOPE_OFF);
        }
        for (k, shown) in place.shown.iter().enumerate() {
            for c in 0..3 {
                let w = weight(off[k][c], shown[c]) / noise(shown[c]).powi(2);
                let mut row = [0.0; 5];
                row[0] = (by[0][k][c] - off[k][c]) / STEP;
                row[1] = (by[1][k][c] - off[k][c]) / STEP;
                row[2 + c] = (by[2][k][c] - off[k][c]) / STEP;
                for i in 0..5 {
                    right[i] -= w * row[i] * off[k][c];
                    for j in 0..5 {
                        a[i][j] += w * row[i] * row[j];
                    }
                }
            }
        }
        let mut taken = false;
        while damping < 1e4 {
            let mut damped = a.clone();
            for (i, row) in damped.iter_mut().enumerate() {
                row[i] *= 1.0 + damping;
                row[i] += 1e-9;
            }
            let step = solve_positive(&damped, std::slice::from_ref(&right));
            let Some(step) = step.and_then(|steps| steps.into_iter().next()) else {
                break;
            };
            let next: [f64; 5] = std::array::from_fn(|i| found[i] + step[i]);
            let left = left_over(spot, place, lamps, &next);
            let less = sum(&left, place, &next);
            if less < least {
                (*found, off, least) = (next, left, less);
                damping = (damping * 0.1).max(1e-6);
                taken = true;
                break;
            }
            damping *= 10.0;
        }
        if !taken {
            break;
        }
    }
    least
}
