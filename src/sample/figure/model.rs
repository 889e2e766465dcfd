//! The figure's shape: a body and its cloth as a distance field.
//!
//! Places are in mm: x right, y down from the crown of the head, z towards the viewer.

use glam::{Vec2, Vec3};

use crate::sample::noise::{Noise, mix, smoothstep};

/// The body and its cloth as a distance field.
pub struct Model {
    crumple: Noise,
}

fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    let q = (p - centre) / radii;
    (q.length() - 1.0) * radii.min_element()
}

fn capsule(p: Vec3, a: Vec3, b: Vec3, from: f32, to: f32) -> f32 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (p - a - along * t).length() - mix(from, to, t)
}

fn join(a: f32, b: f32, softness: f32) -> f32 {
    let h = (0.5 + 0.5 * (b - a) / softness).clamp(0.0, 1.0);
    mix(b, a, h) - softness * h * (1.0 - h)
}

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

impl Model {
    /// The one figure of the sample exhibit.
    pub fn new() -> Self {
        Self {
            crumple: Noise::smooth(171, 17.0, 2),
        }
    }

    /// Distance from the surface, a lower bound; negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        let figure = self
            .head(p)
            .min(self.body(p))
            .min(self.mantle(p))
            .min(self.arms(p));
        figure.min(self.base(p))
    }

    fn head(&self, p: Vec3) -> f32 {
        let skull = ellipsoid(p, v(1.0, 10.5, 5.0), v(7.4, 9.2, 8.6));
        let jaw = ellipsoid(p, v(-1.2, 16.5, 8.5), v(4.9, 5.6, 5.4));
        let face = join(skull, jaw, 3.5);
        let nose = capsule(p, v(-3.6, 10.8, 12.6), v(-4.4, 14.6, 14.3), 0.8, 1.25);
        let face = join(face, nose, 1.0);
        let wave = 0.7 * (0.9 * p.y + 0.7 * p.x).sin() + 0.5 * (1.3 * p.x - 0.5 * p.y).sin();
        let hair = ellipsoid(p, v(3.0, 8.2, 1.8), v(9.2, 9.6, 10.0)) - 0.35 * wave;
        let knot = ellipsoid(p, v(9.0, 13.0, -4.0), v(6.2, 5.4, 6.0)) - 0.4 * wave;
        let brow = p.z - 7.5 + 0.35 * (p.y - 9.0) + 0.5 * (p.x + 2.0);
        let hair = join(hair, knot, 2.5).max(0.55 * brow);
        let neck = capsule(p, v(2.0, 17.0, 1.0), v(3.5, 31.0, -1.0), 5.2, 6.4);
        join(face.min(hair), neck, 2.0)
    }

    /// Torso, legs and the long robe over them.
    fn body(&self, p: Vec3) -> f32 {
        let chest = ellipsoid(p, v(2.0, 44.0, 0.0), v(16.5, 17.0, 10.5));
        let bust = ellipsoid(p, v(-4.0, 46.0, 7.5), v(6.0, 5.6, 5.0)).min(ellipsoid(
            p,
            v(9.0, 46.5, 7.0),
            v(6.0, 5.6, 5.0),
        ));
        let waist = ellipsoid(p, v(1.0, 63.0, 0.0), v(12.0, 14.0, 9.2));
        let hips = ellipsoid(p, v(-2.0, 82.0, 0.0), v(17.0, 16.0, 12.5));
        let torso = join(join(join(chest, bust, 3.0), waist, 6.0), hips, 8.0);
        let standing = capsule(p, v(-8.0, 86.0, 1.0), v(-9.0, 122.0, 2.0), 10.0, 7.4).min(capsule(
            p,
            v(-9.0, 122.0, 2.0),
            v(-8.0, 160.0, -2.0),
            7.4,
            5.0,
        ));
        let bent = capsule(p, v(7.0, 86.0, 4.0), v(14.5, 121.0, 17.0), 10.0, 7.8).min(capsule(
            p,
            v(14.5, 121.0, 17.0),
            v(16.0, 157.0, 2.0),
            7.6,
            5.0,
        ));
        let legs = join(standing, bent, 5.0);
        join(join(torso, legs, 6.0), self.robe(p), 3.5)
    }

    /// Cloth that hangs from the hips and breaks on the ground: pipes that widen downwards,
    /// pulled aside by the bent knee.
    fn robe(&self, p: Vec3) -> f32 {
        let fall = smoothstep(74.0, 165.0, p.y);
        let axis = Vec2::new(mix(-1.0, 3.0, fall), 0.0);
        let flat = Vec2::new(p.x - axis.x, 1.45 * p.z);
        let angle = flat.y.atan2(flat.x) + 0.10 * self.crumple.at(Vec2::new(p.x, p.y) * 0.8);
        let pulled = angle + 0.45 * (1.0 - fall) * smoothstep(-4.0, 14.0, p.x);
        let pipes = (9.0 * pulled + 0.6).cos().abs().powf(0.7) + 0.5 * (15.0 * pulled + 2.1).sin();
        let tight = ((p - v(14.5, 119.0, 17.0)) * v(1.0, 0.55, 1.0)).length();
        let slack = smoothstep(9.0, 24.0, tight) * smoothstep(70.0, 112.0, p.y);
        let radius = mix(13.5, 26.0, fall.powf(1.25)) + 4.3 * slack * (pipes - 0.6);
        let hem = 163.0 + 1.6 * (6.0 * angle).sin() + 2.0 * pipes * fall;
        ((flat.length() - radius) * 0.55)
            .max(p.y - hem)
            .max(66.0 - p.y)
    }

    /// The mantle: from the shoulder across the hips, gathered over the arm, and down.
    fn mantle(&self, p: Vec3) -> f32 {
        let crumple = self.crumple.at(Vec2::new(p.x + 90.0, p.y));
        // Across the body in catenaries from the right hip to the left arm.
        let sag = p.y - 0.030 * (p.x + 2.0).powi(2) + 0.42 * p.x;
        let rolls =
            1.5 * (sag * 0.86 + 1.4 * crumple).sin() + 0.8 * (sag * 1.9 + 2.0 * crumple).sin();
        let swathe = join(
            capsule(p, v(-14.5, 87.0, -2.0), v(3.0, 84.0, 9.0), 5.5, 8.5),
            capsule(p, v(3.0, 84.0, 9.0), v(24.0, 68.0, 9.0), 8.5, 5.5),
            6.0,
        ) - rolls;
        // The end over the forearm, in long zigzag folds.
        let drop = smoothstep(66.0, 140.0, p.y);
        let lean = Vec2::new(p.x - mix(25.0, 29.5, drop), 1.2 * (p.z - 7.0));
        let turn = lean.y.atan2(lean.x);
        let pleats = (5.0 * turn + 0.05 * p.y).sin() + 0.5 * (9.0 * turn + 1.0).sin();
        let hem = 136.0 - 4.2 * ((p.x - 20.0) * 0.48).sin().abs();
        let hanging = ((lean.length() - mix(4.0, 8.5, drop) - 1.1 * pleats) * 0.7)
            .max(p.y - hem)
            .max(64.0 - p.y);
        // Over the shoulder and down the back.
        let shoulder = capsule(p, v(12.0, 30.0, -2.0), v(19.0, 45.0, -3.0), 6.5, 8.5)
            - 0.55 * (0.8 * p.x + 0.9 * p.y).sin();
        let back = capsule(p, v(19.0, 45.0, -5.0), v(24.0, 75.0, -2.0), 8.0, 7.0)
            - 0.8 * (0.95 * p.x + 0.22 * p.y + crumple).sin();
        join(
            join(swathe * 0.75, hanging, 3.0),
            join(shoulder, back, 4.0) * 0.8,
            3.0,
        )
    }

    fn arms(&self, p: Vec3) -> f32 {
        let gather = 0.30 * (0.85 * p.y - 0.5 * p.x).sin();
        let upper = capsule(p, v(-13.0, 36.0, 0.0), v(-20.5, 58.0, 3.0), 6.8, 6.0) - gather;
        let lower = capsule(p, v(-20.5, 58.0, 3.0), v(-6.5, 47.5, 15.5), 5.4, 3.1)
            - 0.4 * (1.4 * p.x + 0.7 * p.y).sin() * smoothstep(-10.0, -16.0, p.x);
        let hand = ellipsoid(p, v(-3.2, 44.8, 16.6), v(3.9, 2.6, 2.0));
        let fingers = (0..4)
            .map(|i| {
                let f = i as f32;
                let root = v(-1.5 + 0.2 * f, 43.2 + 1.25 * f, 17.4);
                capsule(
                    p,
                    root,
                    root + v(4.4 - 0.5 * f, -1.6 + 0.9 * f, -0.6),
                    0.95,
                    0.65,
                )
            })
            .fold(f32::MAX, f32::min);
        let right = join(join(upper, lower, 2.5), join(hand, fingers, 0.6), 1.2);
        let left_arm = capsule(p, v(18.0, 40.0, 0.0), v(26.5, 62.0, 2.0), 6.6, 5.6);
        let forearm = capsule(p, v(26.5, 62.0, 2.0), v(13.0, 70.5, 17.5), 5.0, 3.0);
        let palm = ellipsoid(p, v(10.0, 71.5, 18.5), v(4.0, 2.5, 2.0));
        let left = join(join(left_arm, forearm, 3.0), palm, 1.5);
        right.min(left)
    }

    /// A foot that steps out from under the hem.
    fn base(&self, p: Vec3) -> f32 {
        capsule(p, v(15.0, 163.0, 6.0), v(19.5, 165.5, 16.0), 3.0, 1.9).min(capsule(
            p,
            v(-8.0, 163.5, 6.0),
            v(-12.5, 165.5, 13.0),
            3.0,
            1.8,
        ))
    }

    /// Direction away from the surface.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let h = 0.12;
        let d = |o: Vec3| self.distance(p + o) - self.distance(p - o);
        v(d(Vec3::X * h), d(Vec3::Y * h), d(Vec3::Z * h)).normalize_or(Vec3::Z)
    }
}
