//! Dark places, whose light is gloss for a good part: normal and albedo that come nearest to all
//! channels of all photographs (Levenberg & Marquardt).
//!
//! To divide the response out round by round does not do here: a narrow gleam turns the normal,
//! which moves the gleam. Gloss is as white as its lamp, and the light from below has the ink's
//! colour: three channels tell them apart where four lamps alone hardly do. Shadows and specks lose
//! their weight (Cauchy's), as in [`crate::prepare::gloss`], whose noise and bounds these are.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use pulp::{Arch, Simd, WithSimd};

use super::{
    block::{self, LANES, Lamps, Lane, Lane3, Leaving, cosine},
    film::Depth,
    fit::WEIGHTS,
    response::Paper,
};

/// Noise of a photograph: of white, and of the value.
const NOISE: [f32; 2] = [0.0015, 0.01];
/// The square of how many times the noise is an outlier.
const OUTLIER: f32 = 9.0;
/// The inverse square of how well a slope is known where gloss was not.
const KNOWN: f32 = 1.0 / (0.3 * 0.3);
/// Slopes are moved by this for their derivatives.
const STEP: f32 = 4e-3;
/// Light from below the surface that a fit starts from, and keeps, at least.
const DARK: [f32; 2] = [3e-3, 1e-4];
/// What a logarithm of albedo and a slope move by in a round, at most.
const MOST: [f32; 2] = [0.7, 0.3];
/// Steeper, a slope is a mistake.
const STEEPEST: f32 = 3.0;
/// A round that moves no slope by more is the last: what is left then is less by far.
const STILL: f32 = 4e-3;

/// What has been found of places so far.
#[derive(Clone)]
pub struct Found {
    /// Slopes of the normal: n ∝ (p, q, 1).
    pub slopes: [Lane; 2],
    /// Albedo of each channel, without what the surface adds.
    pub body: Lane3,
    /// What is left over, outliers by their weight.
    pub cost: Lane,
}

impl Found {
    /// From normals and albedo as far as they are known, slopes by the factor `share`.
    pub fn start(paper: &Paper, normal: &Lane3, albedo: &Lane3, share: f32) -> Self {
        let mut found = Self {
            slopes: [[0.0; LANES]; 2],
            body: [[0.0; LANES]; 3],
            cost: [f32::INFINITY; LANES],
        };
        for lane in 0..LANES {
            let up = normal[2][lane].max(0.1);
            for k in 0..2 {
                found.slopes[k][lane] = share * normal[k][lane] / up;
            }
            for c in 0..3 {
                // NaN starts from the least.
                let body = albedo[c][lane] - paper.floor as f32;
                found.body[c][lane] = body.clamp(-1.0, 1e6).max(DARK[0]);
            }
        }
        found
    }

    /// Unit normals.
    #[inline(always)]
    pub fn normals(&self) -> Lane3 {
        let [p, q] = &self.slopes;
        let mut n = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let up = (p[lane] * p[lane] + q[lane] * q[lane] + 1.0).sqrt().recip();
            n[0][lane] = p[lane] * up;
            n[1][lane] = q[lane] * up;
            n[2][lane] = up;
        }
        n
    }

    /// Takes over the places at which `other` leaves less over.
    pub fn or(&mut self, other: &Self) {
        for lane in 0..LANES {
            if other.cost[lane] < self.cost[lane] {
                self.cost[lane] = other.cost[lane];
                for k in 0..2 {
                    self.slopes[k][lane] = other.slopes[k][lane];
                }
                for c in 0..3 {
                    self.body[c][lane] = other.body[c][lane];
                }
            }
        }
    }
}

/// What photographs show of a block, and what is known of its slopes.
pub struct Task<'t> {
    pub paper: &'t Paper,
    pub lamps: &'t Lamps,
    /// For each lamp and channel.
    pub colours: &'t [Lane3],
    pub known: [Lane; 2],
}

/// Light of each lamp and channel: from below the surface, and all.
type Light = Vec<[Lane3; 2]>;

impl Task<'_> {
    /// What photographs should show.
    fn light(&self, found: &Found) -> Light {
        Arch::new().dispatch(Lit { task: self, found })
    }

    #[inline(always)]
    fn wide_light(&self, found: &Found) -> Light {
        let n = found.normals();
        let leaving = Leaving::new(self.paper, &n);
        let film = self.paper.film.as_ref();
        let depth = film.map(|film| Depth::new(film, &found.body, &leaving.mu));
        let count = self.lamps.count();
        let mut light = vec![[[[0.0; LANES]; 3]; 2]; count];
        for (i, light) in light.iter_mut().enumerate() {
            let mu = cosine(&n, &self.lamps.l[i]);
            let seen = block::response(self.paper, &n, &leaving, self.lamps, i, &mu);
            let path = depth.as_ref().map(|depth| depth.beyond_capture(&mu));
            let mut factor = [0.0f32; LANES];
            for lane in 0..LANES {
                factor[lane] = self.lamps.gain[i][lane] * mu[lane].max(0.0);
            }
            for c in 0..3 {
                let mut body = [0.0f32; LANES];
                for lane in 0..LANES {
                    body[lane] = factor[lane] * seen.diffuse[lane] * found.body[c][lane];
                }
                if let (Some(depth), Some(path)) = (&depth, &path) {
                    for lane in 0..LANES {
                        body[lane] *= exp(-depth.tau[c][lane] * path[lane]);
                    }
                }
                for lane in 0..LANES {
                    light[1][c][lane] = body[lane] + factor[lane] * seen.gloss[lane];
                }
                light[0][c] = body;
            }
        }
        light
    }

    fn cost(&self, found: &Found, light: &Light) -> Lane {
        let mut cost = [0.0f32; LANES];
        for k in 0..2 {
            for lane in 0..LANES {
                let off = found.slopes[k][lane] - self.known[k][lane];
                cost[lane] += off * off * KNOWN;
            }
        }
        for (light, colours) in light.iter().zip(self.colours) {
            let mut product = [1.0f32; LANES];
            for c in 0..3 {
                for lane in 0..LANES {
                    let shown = colours[c][lane];
                    let u = (light[1][c][lane] - shown) / noise(shown);
                    // Beyond, the product of three would overflow.
                    product[lane] *= 1.0 + (u * u / OUTLIER).min(1e12);
                }
            }
            for lane in 0..LANES {
                cost[lane] += OUTLIER * product[lane].ln();
            }
        }
        cost
    }

    /// Brings places nearer to their photographs, in so many rounds at most.
    pub fn settle(&self, found: &mut Found, rounds: usize) {
        let mut light = self.light(found);
        found.cost = self.cost(found, &light);
        let mut damping = [1e-3f32; LANES];
        for _ in 0..rounds {
            let by_slope = [0, 1].map(|k| {
                let mut moved = found.clone();
                moved.slopes[k].iter_mut().for_each(|slope| *slope += STEP);
                self.light(&moved)
            });
            let (next, moved) = Arch::new().dispatch(Step {
                task: self,
                found,
                light: &light,
                by_slope: &by_slope,
                damping: &damping,
            });
            let ahead = self.light(&next);
            let cost = self.cost(&next, &ahead);
            for lane in 0..LANES {
                if cost[lane] < found.cost[lane] {
                    found.cost[lane] = cost[lane];
                    damping[lane] = (damping[lane] * 0.1).max(1e-5);
                    for k in 0..2 {
                        found.slopes[k][lane] = next.slopes[k][lane];
                    }
                    for c in 0..3 {
                        found.body[c][lane] = next.body[c][lane];
                    }
                    for (light, ahead) in light.iter_mut().zip(&ahead) {
                        for which in 0..2 {
                            for c in 0..3 {
                                light[which][c][lane] = ahead[which][c][lane];
                            }
                        }
                    }
                } else {
                    damping[lane] = (damping[lane] * 10.0).min(1e4);
                }
            }
            if moved < STILL {
                break;
            }
        }
    }

    /// The next of each place, and the most that a slope moves by; `moved` is the light of slopes that
    /// are a [`STEP`] more.
    #[inline(always)]
    fn wide_step(
        &self,
        found: &Found,
        light: &Light,
        moved: &[Light; 2],
        damping: &Lane,
    ) -> (Found, f32) {
        // Of the slopes: xx, xy, yy, and the right side; of each channel's albedo what couples it.
        let zero = [0.0f32; LANES];
        let [mut xx, xy, mut yy] = [[KNOWN; LANES], zero, [KNOWN; LANES]];
        let mut xy = xy;
        let mut right = [zero; 2];
        for k in 0..2 {
            for lane in 0..LANES {
                right[k][lane] = (self.known[k][lane] - found.slopes[k][lane]) * KNOWN;
            }
        }
        let mut with = [[zero; 3]; 2];
        let mut own = [zero; 3];
        let mut of_own = [zero; 3];
        for i in 0..light.len() {
            for c in 0..3 {
                for lane in 0..LANES {
                    let shown = self.colours[i][c][lane];
                    let now = light[i][1][c][lane];
                    let scale = noise(shown).recip();
                    let u = (shown - now) * scale;
                    let w = scale * scale / (1.0 + u * u / OUTLIER);
                    let off = shown - now;
                    let x = (moved[0][i][1][c][lane] - now) * (1.0 / STEP);
                    let y = (moved[1][i][1][c][lane] - now) * (1.0 / STEP);
                    let a = light[i][0][c][lane];
                    xx[lane] += w * x * x;
                    xy[lane] += w * x * y;
                    yy[lane] += w * y * y;
                    right[0][lane] += w * x * off;
                    right[1][lane] += w * y * off;
                    with[0][c][lane] += w * x * a;
                    with[1][c][lane] += w * y * a;
                    own[c][lane] += w * a * a;
                    of_own[c][lane] += w * a * off;
                }
            }
        }
        let mut next = found.clone();
        let mut most = 0.0f32;
        for lane in 0..LANES {
            let more = 1.0 + damping[lane];
            let [mut a, mut b, mut d] = [xx[lane] * more, xy[lane], yy[lane] * more];
            let [mut r, mut s] = [right[0][lane], right[1][lane]];
            // Each channel's albedo is eliminated (Schur's complement).
            let mut inverse = [0.0f32; 3];
            for c in 0..3 {
                inverse[c] = 1.0 / (own[c][lane] * more).max(1e-12);
                let [x, y] = [with[0][c][lane], with[1][c][lane]];
                a -= x * x * inverse[c];
                b -= x * y * inverse[c];
                d -= y * y * inverse[c];
                r -= x * of_own[c][lane] * inverse[c];
                s -= y * of_own[c][lane] * inverse[c];
            }
            let determinant = a * d - b * b;
            let sound = determinant > 1e-6 * a * d;
            let scale = if sound { determinant.recip() } else { 0.0 };
            let bounded = |step: f32, most: f32| step.clamp(-most, most);
            let x = bounded((d * r - b * s) * scale, MOST[1]);
            let y = bounded((a * s - b * r) * scale, MOST[1]);
            most = most.max(x.abs()).max(y.abs());
            for (slopes, step) in next.slopes.iter_mut().zip([x, y]) {
                slopes[lane] = (slopes[lane] + step).clamp(-STEEPEST, STEEPEST);
            }
            for c in 0..3 {
                let coupled = with[0][c][lane] * x + with[1][c][lane] * y;
                let step = bounded((of_own[c][lane] - coupled) * inverse[c], MOST[0]);
                next.body[c][lane] = (next.body[c][lane] * exp(step)).max(DARK[1]);
            }
        }
        (next, most)
    }

    /// Root of the mean square of what all channels together leave over, in shares of their mean,
    /// `least` being the least that it is a share of; 0 with three lamps.
    pub fn residual(&self, found: &Found, least: f32) -> Lane {
        let mut residual = [0.0f32; LANES];
        let count = self.lamps.count();
        let spare = count.saturating_sub(3);
        if spare == 0 {
            return residual;
        }
        let light = self.light(found);
        let mut mean = [0.0f32; LANES];
        for (light, colours) in light.iter().zip(self.colours) {
            let mut off = [0.0f32; LANES];
            for c in 0..3 {
                for lane in 0..LANES {
                    off[lane] += WEIGHTS[c] * (light[1][c][lane] - colours[c][lane]);
                    mean[lane] += WEIGHTS[c] * colours[c][lane].abs();
                }
            }
            for lane in 0..LANES {
                residual[lane] += off[lane] * off[lane];
            }
        }
        for lane in 0..LANES {
            let mean = (mean[lane] / count as f32).max(least);
            residual[lane] = (residual[lane] / spare as f32).sqrt() / mean;
        }
        residual
    }
}

/// [`Task::light`], in wide vectors where the processor has them.
struct Lit<'l> {
    task: &'l Task<'l>,
    found: &'l Found,
}

impl WithSimd for Lit<'_> {
    type Output = Light;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Light {
        self.task.wide_light(self.found)
    }
}

/// [`Task::wide_step`], likewise.
struct Step<'s> {
    task: &'s Task<'s>,
    found: &'s Found,
    light: &'s Light,
    by_slope: &'s [Light; 2],
    damping: &'s Lane,
}

impl WithSimd for Step<'_> {
    type Output = (Found, f32);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> (Found, f32) {
        self.task
            .wide_step(self.found, self.light, self.by_slope, self.damping)
    }
}

#[inline(always)]
fn noise(shown: f32) -> f32 {
    NOISE[0] + NOISE[1] * shown.max(0.0)
}

/// 2^f on 0…1, by the least relative error: 7.5e-8.
const TWO_TO: [f32; 6] = [
    0.999_999_94,
    0.693_153_1,
    0.240_153_62,
    0.055_826_31,
    0.008_989_34,
    0.001_877_58,
];

/// e^x within 1e-6 of it for |x| < 80, in few operations that compilers vectorise.
#[inline(always)]
fn exp(x: f32) -> f32 {
    let scaled = x.clamp(-80.0, 80.0) * std::f32::consts::LOG2_E;
    let whole = scaled.floor();
    let part = scaled - whole;
    let [a, b, c, d, e, f] = TWO_TO;
    let fraction = a + part * (b + part * (c + part * (d + part * (e + part * f))));
    fraction * f32::from_bits(((whole as i32 + 127) as u32) << 23)
}
