//! A glossy ball in photographs under several lamps: its outline, found by itself.
//!
//! 1. Edges that stay while the light changes (`outline`) vote for the centres of circles that
//!    they lie on (D. H. Ballard, *Pattern Recognition* 13 (1981) 111).
//! 2. Circles that edges lie on nearly all around, and in which something gleams under each lamp,
//!    are balls. There must be one.
//! 3. At full scale, the circle is fitted to the edge all around, those who disagree left out
//!    (J. W. Tukey's weights).

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;

use super::{
    super::{capture::Circle, linear::solve_positive},
    outline::Edges,
};

/// Pixels along the longer side of the pictures that a ball is looked for in.
pub const COARSE_PX: usize = 480;
/// The least radius that is looked for, in pixels of these.
const LEAST_RADIUS: f64 = 8.0;
/// The greatest, as a share of the shorter side: a little more than what still is inside, to tell
/// of a ball that is not.
const GREATEST_RADIUS: f64 = 0.6;
/// From radius to radius that is tried.
const RADIUS_STEP: f64 = 1.03;
/// How much of the way around an outline must be seen: what carries the ball hides some.
const SEEN: f64 = 0.6;
/// Of a ball that reaches out of the picture, the part that must be in it to tell.
const PART_INSIDE: f64 = 0.4;
/// The least side of a picture, in its pixels, that a ball is looked for in.
const LEAST_SIDE: usize = 16;
/// Directions that outlines are looked at in.
const DIRECTIONS: usize = 120;
/// Votes that are looked at closer.
const CANDIDATES: usize = 40;
/// How far an edge may lie from a circle of the first search, in radii.
const NEAR: f64 = 0.03;
/// How much brighter, in linear light, a highlight is than the middle of the ball's pixels.
const GLEAM: f32 = 2.0;
/// The share of the ball that is brighter than halfway to its highlight: of a matte one, half.
const GLEAM_SHARE: f64 = 0.2;
/// The share of photographs in which a ball gleams.
const GLEAMS: f64 = 0.8;
/// The radius in pixels from which on an outline is clear: below, it is looked at again, closer.
pub const CLEAR_RADIUS: f64 = 40.0;
/// Circles whose radii differ by less, as a share, around nearly one centre, are one outline.
const ONE_OUTLINE: f64 = 0.4;
/// Of a round outline in a ball, the greatest radius, in radii of the ball, that is taken for
/// something that it mirrors.
const MIRRORED: f64 = 0.35;

/// Why no ball was found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoBall {
    #[error("no glossy ball is seen whole, with a highlight under each lamp")]
    None,
    #[error("the round outline at {:.0}, {:.0} with radius {:.0} shows no highlight under each lamp, as a glossy ball does", .0.centre.x, .0.centre.y, .0.radius)]
    Dull(Circle),
    #[error("the ball at {:.0}, {:.0} with radius {:.0} reaches out of the photograph", .0.centre.x, .0.centre.y, .0.radius)]
    Outside(Circle),
    #[error("the outline of the ball at {:.0}, {:.0} with radius {:.0} is no circle", .0.centre.x, .0.centre.y, .0.radius)]
    Ragged(Circle),
    #[error("more than one glossy ball is seen: at {:.0}, {:.0} with radius {:.0}, and at {:.0}, {:.0} with radius {:.0}", .0.centre.x, .0.centre.y, .0.radius, .1.centre.x, .1.centre.y, .1.radius)]
    Several(Circle, Circle),
}

impl NoBall {
    /// The same, told in pixels that are `step` times smaller.
    pub fn scaled(self, step: f64) -> Self {
        self.with(|circle| scaled(circle, step))
    }

    /// The same, told from another corner.
    pub fn moved(self, by: DVec2) -> Self {
        self.with(|circle| moved(circle, by))
    }

    fn with(self, change: impl Fn(Circle) -> Circle) -> Self {
        match self {
            Self::None => Self::None,
            Self::Dull(circle) => Self::Dull(change(circle)),
            Self::Outside(circle) => Self::Outside(change(circle)),
            Self::Ragged(circle) => Self::Ragged(change(circle)),
            Self::Several(a, b) => Self::Several(change(a), change(b)),
        }
    }
}

/// A circle in pixels from another corner.
pub fn moved(circle: Circle, by: DVec2) -> Circle {
    Circle {
        centre: circle.centre + by,
        ..circle
    }
}

/// A circle told in pixels that are `step` times smaller.
pub fn scaled(circle: Circle, step: f64) -> Circle {
    Circle {
        centre: circle.centre * step,
        radius: circle.radius * step,
    }
}

/// Finds the ball in pictures of one size, one under each lamp, of values around 0…1 that are
/// the root of linear light. The outline is within a few hundredths of its radius.
///
/// # Errors
/// [`NoBall`].
pub fn find(pictures: &[Vec<f32>], size: [usize; 2]) -> Result<Circle, NoBall> {
    // Of nothing, or a line of pixels, there are no edges to look at.
    if size.iter().any(|side| *side < LEAST_SIDE) {
        return Err(NoBall::None);
    }
    let edges = Edges::new(size, pictures.iter().map(Vec::as_slice));
    let mut balls: Vec<(Circle, f64)> = Vec::new();
    let (mut outside, mut dull) = (None, None);
    for candidate in candidates(&edges) {
        let (circle, Seen { share, inside }) = settled(&edges, candidate);
        if share < SEEN || inside < PART_INSIDE {
            continue;
        }
        if inside < 1.0 {
            outside = outside.or(gleams(pictures, size, circle).then_some(circle));
        } else if gleams(pictures, size, circle) {
            balls.push((circle, share));
        } else {
            dull = dull.or(Some(circle));
        }
    }
    // A round reflection in a ball may be seen all around: its share counts by its size.
    let rank = |(circle, share): &(Circle, f64)| share * circle.radius.sqrt();
    balls.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    let Some(&(best, _)) = balls.first() else {
        return Err(match (outside, dull) {
            (Some(circle), _) => NoBall::Outside(circle),
            (None, Some(circle)) => NoBall::Dull(circle),
            (None, None) => NoBall::None,
        });
    };
    // What a ball mirrors may be round, but is small; and of a ball of few pixels, circles of other
    // sizes in it say nothing.
    let mirrored = |circle: Circle| {
        let small = circle.radius < MIRRORED * best.radius || best.radius < CLEAR_RADIUS;
        small && best.centre.distance(circle.centre) < best.radius
    };
    let other = balls
        .iter()
        .find(|(circle, _)| !is_one(best, *circle) && !mirrored(*circle));
    match other {
        Some((other, _)) => Err(NoBall::Several(best, *other)),
        None => Ok(best),
    }
}

fn is_one(a: Circle, b: Circle) -> bool {
    let larger = a.radius.max(b.radius);
    (a.radius - b.radius).abs().max(a.centre.distance(b.centre)) < ONE_OUTLINE * larger
}

/// Circles with the most votes, best first.
fn candidates(edges: &Edges) -> Vec<Circle> {
    let [width, height] = edges.size;
    let shorter = width.min(height) as f64;
    let ridges = edges.ridges(0.2);
    let steps = ((GREATEST_RADIUS * shorter / LEAST_RADIUS).ln() / RADIUS_STEP.ln()).max(0.0);
    let radii = (0..=steps as i32).map(|i| LEAST_RADIUS * RADIUS_STEP.powi(i));
    let radii: Vec<f64> = radii.collect();
    // Centres may lie outside: a ball may reach out of the picture.
    let margin = (shorter * GREATEST_RADIUS / 2.0) as usize;
    let [w, h] = [width + 2 * margin, height + 2 * margin];
    let of_radius = |radius: &f64| -> Vec<(Circle, f32)> {
        let mut votes = vec![0.0f32; w * h];
        for (at, across, evidence) in &ridges {
            for way in [-1.0, 1.0] {
                let centre = *at + *across * (way * radius) + margin as f64;
                let inside = centre.x >= 0.0
                    && centre.y >= 0.0
                    && centre.x < w as f64
                    && centre.y < h as f64;
                if inside {
                    votes[centre.y as usize * w + centre.x as usize] += evidence;
                }
            }
        }
        let reach = (radius * NEAR).round().max(1.0) as usize;
        let sums = box_sums(&votes, [w, h], reach);
        let mut best: Vec<(usize, f32)> = sums.iter().copied().enumerate().collect();
        let many = best.len().min(2000);
        if many == 0 {
            return Vec::new();
        }
        best.select_nth_unstable_by(many - 1, |a, b| b.1.total_cmp(&a.1));
        best.truncate(many);
        best.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut peaks: Vec<(Circle, f32)> = Vec::new();
        for (i, sum) in best {
            let centre = DVec2::new((i % w) as f64, (i / w) as f64) + 0.5 - margin as f64;
            let apart = |other: &(Circle, f32)| other.0.centre.distance(centre) > 0.3 * radius;
            if peaks.iter().all(apart) {
                let circle = Circle {
                    centre,
                    radius: *radius,
                };
                peaks.push((circle, sum / (TAU * radius) as f32));
            }
            if peaks.len() >= CANDIDATES / 4 {
                break;
            }
        }
        peaks
    };
    let mut all: Vec<(Circle, f32)> = radii.par_iter().flat_map_iter(of_radius).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut kept: Vec<Circle> = Vec::new();
    for (circle, _) in all {
        let near = |other: &Circle| {
            let apart = other.centre.distance(circle.centre);
            let ratio = (other.radius / circle.radius).ln().abs();
            apart < 0.1 * circle.radius && ratio < 0.1
        };
        if !kept.iter().any(near) {
            kept.push(circle);
        }
        if kept.len() >= CANDIDATES {
            break;
        }
    }
    kept
}

/// Sums over squares that reach so many pixels each way.
fn box_sums(values: &[f32], [width, height]: [usize; 2], reach: usize) -> Vec<f32> {
    let along = |values: &[f32], width: usize, height: usize| {
        // Transposed, so that two passes come out as rows.
        let mut out = vec![0.0f32; values.len()];
        for (y, row) in values.chunks_exact(width).enumerate() {
            let mut sum: f32 = row.iter().take(reach).sum();
            for x in 0..width {
                sum += row.get(x + reach).copied().unwrap_or_default();
                if let Some(gone) = x.checked_sub(reach + 1) {
                    sum -= row[gone];
                }
                out[x * height + y] = sum;
            }
        }
        out
    };
    along(&along(values, width, height), height, width)
}

/// How much of an outline is seen.
#[derive(Clone, Copy)]
struct Seen {
    /// Of the part that is in the picture, in 0…1.
    share: f64,
    /// The part that is in the picture.
    inside: f64,
}

fn direction(i: usize, of: usize) -> DVec2 {
    DVec2::from_angle(TAU * i as f64 / of as f64)
}

/// The nearest strong edge across each direction: how far out, and its evidence.
fn radial(edges: &Edges, circle: Circle, across: DVec2, reach: f64) -> (f64, f32) {
    const STEP: f64 = 0.5;
    let steps = (reach / STEP).ceil() as i32;
    let mut best = (0.0, 0.0f32);
    for i in -steps..=steps {
        let off = f64::from(i) * STEP;
        let at = circle.centre + across * (circle.radius + off);
        // What is nearer weighs more.
        let taper = 1.0 - 0.5 * (off / (reach + STEP)).powi(2);
        let evidence = edges.evidence(at, across) * taper as f32;
        if evidence > best.1 {
            best = (off, evidence);
        }
    }
    best
}

fn seen(edges: &Edges, circle: Circle) -> Seen {
    /// More than half of what is well above noise.
    const EVIDENT: f32 = 0.4;
    let reach = (NEAR * circle.radius).max(1.0);
    let size = DVec2::new(edges.size[0] as f64, edges.size[1] as f64);
    let (mut inside, mut found) = (0, 0);
    for i in 0..DIRECTIONS {
        let across = direction(i, DIRECTIONS);
        let at = circle.centre + across * circle.radius;
        if at.cmplt(DVec2::ZERO).any() || at.cmpgt(size).any() {
            continue;
        }
        inside += 1;
        found += usize::from(radial(edges, circle, across, reach).1 >= EVIDENT);
    }
    Seen {
        share: found as f64 / inside.max(1) as f64,
        inside: inside as f64 / DIRECTIONS as f64,
    }
}

/// A candidate drawn to the edges around it.
fn settled(edges: &Edges, candidate: Circle) -> (Circle, Seen) {
    let mut best = (candidate, seen(edges, candidate));
    let mut circle = candidate;
    for reach in [2.0, 1.5, 1.0, 1.0] {
        let Some((next, _)) = fitted(
            edges,
            circle,
            (reach * NEAR * circle.radius).max(2.0),
            DIRECTIONS,
        ) else {
            break;
        };
        let moved = (next.radius - candidate.radius).abs() + next.centre.distance(candidate.centre);
        if moved > 0.25 * candidate.radius {
            break;
        }
        circle = next;
        let seen = seen(edges, circle);
        if seen.share * seen.inside > best.1.share * best.1.inside {
            best = (circle, seen);
        }
    }
    best
}

/// Whether something small shines in a circle under nearly each lamp.
fn gleams(pictures: &[Vec<f32>], [width, height]: [usize; 2], circle: Circle) -> bool {
    let within = circle.radius * 0.9;
    let low = (circle.centre - within).max(DVec2::ZERO);
    let high = circle.centre + within;
    let rows = low.y as usize..(high.y.max(0.0) as usize).min(height);
    let columns = low.x as usize..(high.x.max(0.0) as usize).min(width);
    let gleams = |picture: &&Vec<f32>| {
        let mut linear: Vec<f32> = rows
            .clone()
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            .filter(|(x, y)| {
                DVec2::new(*x as f64 + 0.5, *y as f64 + 0.5).distance(circle.centre) < within
            })
            .map(|(x, y)| picture[y * width + x].powi(2))
            .collect();
        if linear.is_empty() {
            return false;
        }
        let middle = linear.len() / 2;
        let (_, &mut median, above) = linear.select_nth_unstable_by(middle, f32::total_cmp);
        let brightest = above.iter().copied().fold(median, f32::max);
        let half = 0.5 * (median + brightest);
        let bright = above.iter().filter(|v| **v > half).count();
        brightest > GLEAM * median && bright as f64 <= GLEAM_SHARE * linear.len() as f64
    };
    let count = pictures.iter().filter(gleams).count();
    count as f64 >= GLEAMS * pictures.len() as f64
}

/// Fits a circle to the edges around it, by Gauss and Newton. Gives it with the share of
/// directions that agree.
fn fitted(edges: &Edges, around: Circle, reach: f64, directions: usize) -> Option<(Circle, f64)> {
    /// From where on Tukey's weights are 0, in standard deviations.
    const TUKEY: f64 = 4.685;
    /// Of normal residuals, the standard deviation over the median of their sizes.
    const SIGMA: f64 = 1.4826;
    /// An edge is not found closer than this, in pixels.
    const FINEST: f64 = 0.15;
    let mut points: Vec<(DVec2, f64)> = Vec::with_capacity(directions);
    for i in 0..directions {
        let across = direction(i, directions);
        let (off, evidence) = radial(edges, around, across, reach);
        if evidence < 0.2 {
            continue;
        }
        let at = |off: f64| around.centre + across * (around.radius + off);
        let off = peak(|off| f64::from(edges.across(at(off), across)), off);
        points.push((at(off), f64::from(evidence)));
    }
    if points.len() * 4 < directions {
        return None;
    }
    let mut circle = around;
    let mut agree = 0.0;
    for _ in 0..20 {
        let off = |at: &DVec2| at.distance(circle.centre) - circle.radius;
        let mut sizes: Vec<f64> = points.iter().map(|(at, _)| off(at).abs()).collect();
        let middle = sizes.len() / 2;
        let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        let limit = TUKEY * (SIGMA * median).max(FINEST);
        let mut normal = vec![vec![0.0; 3]; 3];
        let mut right = vec![0.0; 3];
        let mut count = 0;
        for (at, evidence) in &points {
            let residual = off(at);
            let share = residual / limit;
            if share.abs() >= 1.0 {
                continue;
            }
            count += 1;
            let weight = evidence * (1.0 - share * share).powi(2);
            let out = (*at - circle.centre).normalize_or(DVec2::X);
            let row = [-out.x, -out.y, -1.0];
            for j in 0..3 {
                for k in 0..3 {
                    normal[j][k] += weight * row[j] * row[k];
                }
                right[j] -= weight * row[j] * residual;
            }
        }
        agree = f64::from(count) / directions as f64;
        let step = solve_positive(&normal, &[right])?.pop()?;
        circle.centre += DVec2::new(step[0], step[1]);
        circle.radius += step[2];
        if step.iter().all(|s| s.abs() < 1e-6) {
            break;
        }
    }
    let sound = circle.centre.is_finite() && circle.radius.is_finite() && circle.radius > 1.0;
    sound.then_some((circle, agree))
}

/// The place of the maximum of `value` near `from`, between samples by a parabola.
fn peak(value: impl Fn(f64) -> f64, from: f64) -> f64 {
    const STEP: f64 = 0.5;
    let mut at = from;
    for _ in 0..3 {
        let [before, here, after] = [at - STEP, at, at + STEP].map(&value);
        if after > here && after >= before {
            at += STEP;
        } else if before > here {
            at -= STEP;
        } else {
            let bend = before - 2.0 * here + after;
            let by = 0.5 * (before - after) / bend;
            return if by.is_finite() {
                at + STEP * by.clamp(-1.0, 1.0)
            } else {
                at
            };
        }
    }
    at
}

/// Draws the outline of a ball that was [found](find) to the edge itself, in pictures of the ball
/// and a little more, as for [`find`] but finer. `None` where too little of it agrees.
pub fn refine(pictures: &[Vec<f32>], size: [usize; 2], around: Circle) -> Option<Circle> {
    const FINE_DIRECTIONS: usize = 720;
    /// The share of directions that must agree on the circle.
    const AGREE: f64 = 0.4;
    let edges = Edges::new(size, pictures.iter().map(Vec::as_slice));
    let mut circle = around;
    let mut agree = 0.0;
    for share in [0.12, 0.06, 0.03, 0.015, 0.01, 0.01] {
        let reach = (share * circle.radius).max(2.0);
        (circle, agree) = fitted(&edges, circle, reach, FINE_DIRECTIONS)?;
    }
    (agree >= AGREE && is_one(around, circle)).then_some(circle)
}
