//! Contours of a form: lines along which its distance from the eye jumps.

use glam::Vec2;

use super::grid::Plane;

/// Contours shorter than this are crumbs, in mm.
const SHORTEST_MM: f32 = 1.4;
/// Samples of the search, in mm.
const STEP_MM: f32 = 0.25;
/// How far a contour may jump from one sample to the next, in mm.
const JUMP_MM: f32 = 0.9;
/// Relative change of distance along one contour from sample to sample.
const DRIFT: f32 = 0.12;

/// One contour.
pub struct Contour {
    /// Along it, in mm.
    pub points: Vec<Vec2>,
    /// Distance of the form in front, where the contour ends.
    pub near: f32,
    grown: bool,
}

/// Finds all contours of a plane of distances (∞ is the background); `jumps` compares the nearer
/// and the farther of two neighbours.
pub fn trace(distance: &Plane, jumps: impl Fn(f32, f32) -> bool) -> Vec<Contour> {
    let mut found = walk(distance, &jumps, false);
    found.extend(walk(distance, &jumps, true));
    for contour in &mut found {
        soften(&mut contour.points);
    }
    found
}

/// Walks column by column, or row by row for upright contours, and links neighbours.
fn walk(distance: &Plane, jumps: &impl Fn(f32, f32) -> bool, upright: bool) -> Vec<Contour> {
    let grid = distance.grid;
    let size = grid.pitch_mm * Vec2::new(grid.width as f32, grid.height as f32);
    let (outer, inner) = if upright {
        (size.y, size.x)
    } else {
        (size.x, size.y)
    };
    let place = |o: f32, i: f32| {
        if upright {
            Vec2::new(i, o)
        } else {
            Vec2::new(o, i)
        }
    };
    let mut open: Vec<Contour> = Vec::new();
    let mut done = Vec::new();
    let mut o = 0.5 * STEP_MM;
    while o < outer {
        let mut before = distance.nearest(place(o, 0.5 * STEP_MM));
        let mut i = 1.5 * STEP_MM;
        while i < inner {
            let here = distance.nearest(place(o, i));
            let (near, far) = (before.min(here), before.max(here));
            if near.is_finite() && jumps(near, far) {
                link(&mut open, place(o, i - 0.5 * STEP_MM), near);
            }
            before = here;
            i += STEP_MM;
        }
        let (going, ended): (Vec<_>, Vec<_>) = open.into_iter().partition(|line| line.grown);
        done.extend(ended);
        open = going;
        open.iter_mut().for_each(|line| line.grown = false);
        o += STEP_MM;
    }
    done.extend(open);
    done.retain(|line| line.points.len() as f32 * STEP_MM > SHORTEST_MM);
    done
}

fn link(open: &mut Vec<Contour>, at: Vec2, near: f32) {
    let ours = open.iter_mut().find(|line| {
        let end = line.points[line.points.len() - 1];
        !line.grown && end.distance(at) < JUMP_MM && (line.near / near - 1.0).abs() < DRIFT
    });
    match ours {
        Some(line) => {
            line.points.push(at);
            line.near = near;
            line.grown = true;
        }
        None => open.push(Contour {
            points: vec![at],
            near,
            grown: true,
        }),
    }
}

/// Takes the staircase of the samples out of a line.
fn soften(points: &mut [Vec2]) {
    for _ in 0..3 {
        let mut before = points[0];
        for i in 1..points.len() - 1 {
            let here = points[i];
            points[i] = (before + here * 2.0 + points[i + 1]) * 0.25;
            before = here;
        }
    }
}
