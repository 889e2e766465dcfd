//! The arithmetic of many pixels at once: arrays of lanes that compilers turn into vector
//! instructions.
//!
//! Most of a sheet's time goes into it. Those that call these functions most ([`super::fit`]'s
//! `facing` and `albedo`, [`super::refine`]'s `light` and steps) are compiled for vectors of 256 bits as well, by
//! `pulp`, which are used where the processor has them: what they call has to be inlined for that. What
//! is found is the same.
//!
//! | symbol | meaning |
//! |---|---|
//! | `a` | a lamp's gain times its direction, as a pixel sees it |
//! | `v` | what a photograph shows there |
//! | `w` | the weight of a photograph, 1 where it is trusted |
//! | `g` | the normal times the albedo |

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use glam::{DVec2, DVec3};

use super::{
    response::{Paper, Response},
    rig::{Lit, Rig},
};

/// Pixels that are worked on together.
pub const LANES: usize = 32;

/// One value of each of them.
pub type Lane = [f32; LANES];

/// A vector of each of them.
pub type Lane3 = [Lane; 3];

/// Weights of photographs that are all trusted.
pub const ONES: Lane = [1.0; LANES];

/// The lamps as the pixels of a block see them.
pub struct Lamps {
    pub l: Vec<Lane3>,
    /// Half way between a lamp and the eye, where the surface is paper.
    pub h: Vec<Lane3>,
    pub gain: Vec<Lane>,
    /// π times Fresnel's factor for each lamp, where the surface is paper.
    pub fresnel: Vec<Lane>,
    /// The rows of the pseudo-inverse where all pixels have it in common.
    pub inverse: Option<Vec<[f32; 3]>>,
}

impl Lamps {
    /// For pixels whose middles are `at`, in pixels from the left and top edge.
    pub fn new(rig: &Rig, response: &Response, at: &[DVec2; LANES]) -> Self {
        let count = rig.count();
        let mut lamps = Self {
            l: vec![[[0.0; LANES]; 3]; count],
            h: vec![[[0.0; LANES]; 3]; count],
            gain: vec![[0.0; LANES]; count],
            fresnel: vec![[0.0; LANES]; count],
            inverse: None,
        };
        let uniform = rig.is_uniform();
        for i in 0..count {
            for lane in 0..if uniform { 1 } else { LANES } {
                let Lit { l, gain } = rig.lamp(i, at[lane]);
                let l32: [f32; 3] = l.as_vec3().into();
                for c in 0..3 {
                    lamps.l[i][c][lane] = l32[c];
                }
                lamps.gain[i][lane] = gain as f32;
                if let Some(paper) = response.paper() {
                    lamps.fresnel[i][lane] = paper.fresnel(l);
                    let h: [f32; 3] = (l + DVec3::Z).normalize().as_vec3().into();
                    for c in 0..3 {
                        lamps.h[i][c][lane] = h[c];
                    }
                }
            }
            if uniform {
                for c in 0..3 {
                    lamps.l[i][c] = [lamps.l[i][c][0]; LANES];
                    lamps.h[i][c] = [lamps.h[i][c][0]; LANES];
                }
                lamps.gain[i] = [lamps.gain[i][0]; LANES];
                lamps.fresnel[i] = [lamps.fresnel[i][0]; LANES];
            }
        }
        if uniform {
            let rows = rig.pseudo_inverse(DVec2::ZERO);
            let single = |row: DVec3| row.as_vec3().into();
            lamps.inverse = rows.map(|rows| rows.into_iter().map(single).collect());
        }
        lamps
    }

    pub fn count(&self) -> usize {
        self.gain.len()
    }
}

/// The greatest of values that are not negative.
#[inline(always)]
pub fn most(values: &Lane) -> f32 {
    let mut most = *values;
    let mut half = LANES / 2;
    while half > 0 {
        let (below, above) = most.split_at_mut(half);
        for (a, b) in below.iter_mut().zip(above) {
            *a = a.max(*b);
        }
        half /= 2;
    }
    most[0]
}

/// g by least squares, all photographs alike.
#[inline(always)]
pub fn solve(lamps: &Lamps, v: &[Lane]) -> Lane3 {
    let Some(inverse) = &lamps.inverse else {
        return solve_weighted(lamps, v, None);
    };
    let mut g = [[0.0; LANES]; 3];
    for (row, v) in inverse.iter().zip(v) {
        for c in 0..3 {
            for lane in 0..LANES {
                g[c][lane] += row[c] * v[lane];
            }
        }
    }
    g
}

/// g by least squares with weights, by the normal equations of each pixel.
#[inline(always)]
pub fn solve_weighted(lamps: &Lamps, v: &[Lane], w: Option<&[Lane]>) -> Lane3 {
    let zero = [0.0f32; LANES];
    let [mut xx, mut xy, mut xz, mut yy, mut yz, mut zz] = [zero; 6];
    let [mut bx, mut by, mut bz] = [zero; 3];
    for i in 0..lamps.count() {
        let [lx, ly, lz] = &lamps.l[i];
        let gain = &lamps.gain[i];
        let weights = w.map_or(&ONES, |w| &w[i]);
        for lane in 0..LANES {
            let weight = weights[lane];
            let (x, y, z) = (
                lx[lane] * gain[lane],
                ly[lane] * gain[lane],
                lz[lane] * gain[lane],
            );
            let (wx, wy, wz) = (weight * x, weight * y, weight * z);
            xx[lane] += wx * x;
            xy[lane] += wx * y;
            xz[lane] += wx * z;
            yy[lane] += wy * y;
            yz[lane] += wy * z;
            zz[lane] += wz * z;
            bx[lane] += wx * v[i][lane];
            by[lane] += wy * v[i][lane];
            bz[lane] += wz * v[i][lane];
        }
    }
    let mut g = [zero; 3];
    for lane in 0..LANES {
        let (a, b, c, d, e, f) = (xx[lane], xy[lane], xz[lane], yy[lane], yz[lane], zz[lane]);
        let (p, q, r) = (bx[lane], by[lane], bz[lane]);
        // Cofactors of a symmetric matrix.
        let (ca, cb, cc) = (d * f - e * e, c * e - b * f, b * e - c * d);
        let (cd, ce, cf) = (a * f - c * c, b * c - a * e, a * d - b * b);
        let determinant = a * ca + b * cb + c * cc;
        let scale = 1.0 / determinant.max(f32::MIN_POSITIVE);
        g[0][lane] = (ca * p + cb * q + cc * r) * scale;
        g[1][lane] = (cb * p + cd * q + ce * r) * scale;
        g[2][lane] = (cc * p + ce * q + cf * r) * scale;
    }
    g
}

/// The unit normals along g, upright where there is none, and not below the horizon.
#[inline(always)]
pub fn normals(g: &Lane3) -> Lane3 {
    let mut n = *g;
    for lane in 0..LANES {
        let z = g[2][lane].max(0.0);
        let square = g[0][lane] * g[0][lane] + g[1][lane] * g[1][lane] + z * z;
        let lit = square > 1e-20;
        let scale = if lit {
            square.max(1e-20).sqrt().recip()
        } else {
            0.0
        };
        n[0][lane] = g[0][lane] * scale;
        n[1][lane] = g[1][lane] * scale;
        n[2][lane] = if lit { z * scale } else { 1.0 };
    }
    n
}

/// n·l.
#[inline(always)]
pub fn cosine(n: &Lane3, l: &Lane3) -> Lane {
    let mut mu = [0.0; LANES];
    for lane in 0..LANES {
        mu[lane] = n[0][lane] * l[0][lane] + n[1][lane] * l[1][lane] + n[2][lane] * l[2][lane];
    }
    mu
}

/// Cosines below which the paper's response is not followed: nothing is seen of it there.
pub const MU_FLOOR: f32 = 0.03;

/// What of a surface's response depends on the way to the eye alone.
pub struct Leaving {
    pub mu: Lane,
    /// √(α² + (1 − α²)μ²)
    masked: Lane,
    t: Lane,
    late: Lane,
}

impl Leaving {
    /// At normals `n`, for an eye straight above.
    #[inline(always)]
    pub fn new(paper: &Paper, n: &Lane3) -> Self {
        let mut leaving = Self {
            mu: [0.0; LANES],
            masked: [0.0; LANES],
            t: [0.0; LANES],
            late: [0.0; LANES],
        };
        let alpha2 = paper.alpha * paper.alpha;
        for lane in 0..LANES {
            let mu = n[2][lane].clamp(MU_FLOOR, 1.0);
            let x = mu.sqrt();
            leaving.mu[lane] = mu;
            leaving.masked[lane] = (alpha2 + (1.0 - alpha2) * mu * mu).sqrt();
            leaving.t[lane] = polynomial(&paper.t, x) * paper.capture;
            leaving.late[lane] = polynomial(&paper.late, x);
        }
        leaving
    }
}

/// What a surface adds to, and makes of, n·l.
pub struct Seen {
    /// Share of the body's light, 1 for a perfect diffuser.
    pub diffuse: Lane,
    /// π times the gloss.
    pub gloss: Lane,
}

/// The response to the lamp `i` at normals `n`, with n·l = `mu`, ink left out.
#[inline(always)]
pub fn response(
    paper: &Paper,
    n: &Lane3,
    leaving: &Leaving,
    lamps: &Lamps,
    i: usize,
    mu: &Lane,
) -> Seen {
    let mut seen = Seen {
        diffuse: [0.0; LANES],
        gloss: [0.0; LANES],
    };
    let alpha2 = paper.alpha * paper.alpha;
    let over_pi = paper.specular * alpha2 / std::f32::consts::PI;
    let (h, fresnel) = (&lamps.h[i], &lamps.fresnel[i]);
    for lane in 0..LANES {
        let mu_i = mu[lane].clamp(MU_FLOOR, 1.0);
        let x = mu_i.sqrt();
        seen.diffuse[lane] = polynomial(&paper.t, x) * leaving.t[lane];
        // GGX with Smith's correlated masking, as d_ggx and v_smith of optics::microfacet.
        let (hx, hy, hz) = (h[0][lane], h[1][lane], h[2][lane]);
        let (nx, ny, nz) = (n[0][lane], n[1][lane], n[2][lane]);
        let (cx, cy, cz) = (ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx);
        let sin2 = (cx * cx + cy * cy + cz * cz).min(1.0);
        let spread = alpha2 + sin2 * (1.0 - alpha2);
        let masked = (alpha2 + (1.0 - alpha2) * mu_i * mu_i).sqrt();
        let way = 2.0 * (leaving.mu[lane] * masked + mu_i * leaving.masked[lane]);
        let late = polynomial(&paper.late, x) * leaving.late[lane];
        seen.gloss[lane] = over_pi * fresnel[lane] / (spread * spread * way) + late;
    }
    seen
}

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f32; N], x: f32) -> f32 {
    let mut sum = 0.0;
    for c in coefficients.iter().rev() {
        sum = sum * x + c;
    }
    sum
}
