//! Where lamps are: from what was written, from a file of directions, or from a glossy ball.
//!
//! | symbol | meaning |
//! |---|---|
//! | `l` | unit vector from the sheet towards a lamp |
//! | `v` | unit vector towards the camera, (0, 0, 1) |
//! | `n` | unit normal |
//!
//! All in the sheet's frame: x right, y up in the photograph, z towards the camera.

pub mod ball;
pub mod intensity;
pub mod lp;
mod outline;
pub mod sphere;

use glam::{DMat3, DVec3};

/// How ill-placed lamps may be: the least of the three singular values of their directions over
/// the largest. Noise in photographs grows by its inverse on the way to normals.
pub const LEAST_SPREAD: f64 = 0.02;

/// Why lamps do not tell where a surface faces.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Ill {
    /// Fewer than three.
    #[error("{0} lamps")]
    TooFew(usize),
    /// All in one plane with the sheet's middle, nearly.
    #[error(
        "lamps that are all in one plane with the sheet's middle (spread {0:.4}, at least {LEAST_SPREAD} is needed)"
    )]
    OnePlane(f64),
}

/// Unit vector towards a lamp at this azimuth (anticlockwise from the right) and elevation (above
/// the sheet), in degrees.
pub fn direction(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let (sin_a, cos_a) = azimuth_deg.to_radians().sin_cos();
    let (sin_e, cos_e) = elevation_deg.to_radians().sin_cos();
    DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// Azimuth in 0…360 and elevation in degrees of a direction.
pub fn angles(l: DVec3) -> [f64; 2] {
    let azimuth = l.y.atan2(l.x).to_degrees().rem_euclid(360.0);
    [azimuth, l.z.atan2(l.x.hypot(l.y)).to_degrees()]
}

/// So many of these directions at most, far from each other, by their places: the first one, and
/// then always the one that is farthest from those chosen.
pub fn far_apart(directions: &[DVec3], most: usize) -> Vec<usize> {
    let mut chosen = Vec::new();
    while chosen.len() < most.min(directions.len()) {
        let nearest = |i: &usize| {
            let each = chosen
                .iter()
                .map(|k: &usize| directions[*k].dot(directions[*i]));
            each.fold(f64::NEG_INFINITY, f64::max)
        };
        let others = (0..directions.len()).filter(|i| !chosen.contains(i));
        match others.min_by(|a, b| nearest(a).total_cmp(&nearest(b))) {
            Some(next) => chosen.push(next),
            None => break,
        }
    }
    chosen.sort_unstable();
    chosen
}

/// How well these directions (unit vectors) span space: the smallest singular value over the
/// largest, in [0, 1].
///
/// # Errors
/// [`Ill`] where they do not.
pub fn spread(directions: &[DVec3]) -> Result<f64, Ill> {
    if directions.len() < 3 {
        return Err(Ill::TooFew(directions.len()));
    }
    let mut gram = DMat3::ZERO;
    for l in directions {
        gram += DMat3::from_cols(*l * l.x, *l * l.y, *l * l.z);
    }
    let [low, _, high] = symmetric_eigenvalues(gram);
    let spread = (low.max(0.0) / high).sqrt();
    if spread >= LEAST_SPREAD {
        Ok(spread)
    } else {
        // NaN is no spread either.
        Err(Ill::OnePlane(spread))
    }
}

/// Eigenvalues of a symmetric matrix, rising (O. K. Smith, *Communications of the ACM* 4 (1961)
/// 168).
pub fn symmetric_eigenvalues(m: DMat3) -> [f64; 3] {
    let mean = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let off = m - DMat3::from_diagonal(DVec3::splat(mean));
    let square: f64 = off.to_cols_array().iter().map(|v| v * v).sum();
    let p = (square / 6.0).sqrt();
    if p == 0.0 {
        return [mean; 3];
    }
    let half = ((off * p.recip()).determinant() / 2.0).clamp(-1.0, 1.0);
    let angle = half.acos() / 3.0;
    let high = mean + 2.0 * p * angle.cos();
    let low = mean + 2.0 * p * (angle + std::f64::consts::TAU / 3.0).cos();
    [low, 3.0 * mean - high - low, high]
}
