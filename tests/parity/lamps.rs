//! Lamps: directions and illuminance.

use super::{interfaces::words, *};

/// One lamp as the shader reads it, the point that it lights, and the sample.
struct LampCase {
    light: LightUniform,
    /// The same, widened.
    twin: Light,
    p: Vec3,
    sample: u32,
}

impl LampCase {
    /// Node and weight along both edges of a rectangle's sample, or a disc's ring and spoke.
    fn rule(&self) -> [[f64; 2]; 2] {
        let LightUniform { grid, rings, .. } = self.light;
        if let Shape::Ies { photometry, .. } = &self.twin.shape {
            let [gamma, c] = self.angles();
            return [
                [photometry.intensity(gamma, c) / photometry.peak(), 0.0],
                [0.0; 2],
            ];
        }
        if rings > 0 {
            let ring = gauss_legendre(rings, self.sample / (4 * rings));
            let ([x, y], _) = disc_rule(rings, self.sample);
            let r = (0.5 + 0.5 * ring[0]).sqrt();
            return [ring, [x / r, y / r]];
        }
        let grid = grid.max(1);
        [self.sample % grid, self.sample / grid].map(|i| gauss_legendre(grid, i))
    }
}

impl LampCase {
    /// γ and C of an IES lamp.
    fn angles(&self) -> [f64; 2] {
        let (light, p) = (&self.light, self.p.as_dvec3());
        let l = p - light.place.as_dvec3();
        let along = |axis: Vec3| axis.as_dvec3().dot(l);
        let (u, v) = (along(light.half_edge_u), along(light.half_edge_v));
        [u.hypot(v).atan2(along(light.axis) + 0.0), v.atan2(u)]
    }
}

/// The shader's functions for lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamps {
    Distant,
    Punctual,
    Rectangle,
    Disc,
    Ies,
}

impl Lamps {
    fn call(self) -> &'static str {
        match self {
            Self::Distant => "light_distant(x.light)",
            Self::Punctual => "light_punctual(x.light, x.p)",
            Self::Rectangle => "light_rectangle(x.light, x.p, x.u, x.v)",
            Self::Ies => "light_ies(x.light, x.p, x.u.x)",
            Self::Disc => "light_disc(x.light, x.p, x.u, x.v)",
        }
    }
}

/// A lamp of any size that `lamps` can be asked about, anywhere that a manifest can put it and
/// somewhat beyond.
fn lamp(seeded: &Seeded, lamps: Lamps) -> Light {
    // Of 1e-3…1e7 lm, over 4π sr, exposed for 1e-3…1e6 lx, with mm² for m².
    let brightness = seeded.log(1e-3, 1e7) / 4.0 * 1e6 / seeded.log(1e-3, 1e6);
    let amount = DVec3::new(1.0, seeded.unit(), seeded.log_or_zero(1e-5, 1.0)) * brightness;
    let mut position = seeded.direction() * seeded.log_or_zero(1e-3, 1e5);
    if seeded.bits().is_multiple_of(8) {
        position.z = 0.0;
    }
    let axis = seeded.pick(&[
        -position.normalize_or(DVec3::Z),
        -DVec3::Z,
        seeded.direction(),
    ]);
    let shape = match (lamps, seeded.bits() % 3) {
        (Lamps::Rectangle, _) => {
            let half_u = axis.any_orthonormal_vector();
            Shape::Rectangle {
                centre: position,
                axis,
                half_u: half_u * seeded.log_or_zero(0.05, 5e3),
                half_v: axis.cross(half_u) * seeded.log_or_zero(0.05, 5e3),
                grid: seeded.pick(&GRIDS.collect::<Vec<_>>()),
            }
        }
        (Lamps::Ies, _) => {
            let across_u = axis.any_orthonormal_vector();
            let text = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 3 1 2 0 0 0\n1 1 9\n0 90 180\n\
                        0 45 90\n9 5 2  9 3 4  9 1 8\n";
            Shape::Ies {
                position,
                axis,
                across_u,
                across_v: axis.cross(across_u),
                photometry: Arc::new(Photometry::parse(text).expect("a lamp")),
            }
        }
        (Lamps::Disc, _) => {
            let radius = seeded.log_or_zero(0.05, 5e3);
            let half_u = axis.any_orthonormal_vector();
            Shape::Disc {
                centre: position,
                axis,
                half_u: half_u * radius,
                half_v: axis.cross(half_u) * radius,
                rings: seeded.pick(&GRIDS.collect::<Vec<_>>()),
            }
        }
        (Lamps::Distant, _) | (_, 0) => Shape::Distant { towards: -axis },
        (_, 1) => Shape::Point { position },
        _ => {
            // Half angles of 0.1° to 89.9°, and beams without a soft edge.
            let cos_falloff = (1.0 - seeded.log(1.5e-6, 0.998)).min(1.0);
            let inside = seeded.log_or_zero(1e-7, 1.0);
            Shape::Spot {
                position,
                axis,
                cos_hotspot: cos_falloff + (1.0 - cos_falloff) * inside,
                cos_falloff,
            }
        }
    };
    Light { shape, amount }
}

fn lamp_cases(lamps: Lamps, every: usize) -> Vec<LampCase> {
    let seeded = Seeded::new(3);
    (0..200_000 / every)
        .map(|_| {
            let light = lamp(&seeded, lamps);
            let narrow = LightUniform::new(&light, false);
            let p = seeded.direction() * seeded.log_or_zero(1.0, 3e3);
            let wide = |v: Vec3| v.as_dvec3();
            let shape = match light.shape {
                Shape::Distant { .. } => Shape::Distant {
                    towards: wide(narrow.place),
                },
                Shape::Point { .. } => Shape::Point {
                    position: wide(narrow.place),
                },
                Shape::Spot { .. } => Shape::Spot {
                    position: wide(narrow.place),
                    axis: wide(narrow.axis),
                    cos_hotspot: f64::from(narrow.cos_falloff) + 1.0 / f64::from(narrow.beam_scale),
                    cos_falloff: f64::from(narrow.cos_falloff),
                },
                Shape::Rectangle { grid, .. } => Shape::Rectangle {
                    centre: wide(narrow.place),
                    axis: wide(narrow.axis),
                    half_u: wide(narrow.half_edge_u),
                    half_v: wide(narrow.half_edge_v),
                    grid,
                },
                Shape::Ies { ref photometry, .. } => Shape::Ies {
                    position: wide(narrow.place),
                    axis: wide(narrow.axis),
                    across_u: wide(narrow.half_edge_u),
                    across_v: wide(narrow.half_edge_v),
                    photometry: Arc::clone(photometry),
                },
                Shape::Disc { rings, .. } => Shape::Disc {
                    centre: wide(narrow.place),
                    axis: wide(narrow.axis),
                    half_u: wide(narrow.half_edge_u),
                    half_v: wide(narrow.half_edge_v),
                    rings,
                },
            };
            let samples = narrow.grid * narrow.grid + 4 * narrow.rings * narrow.rings;
            // Inside the lamp, at its very place, as well as anywhere.
            let p = seeded.pick(&[p.as_vec3(), p.as_vec3(), narrow.place, Vec3::ZERO]);
            LampCase {
                light: narrow,
                twin: Light {
                    shape,
                    amount: wide(narrow.amount),
                },
                p,
                sample: (seeded.bits() % u64::from(samples.max(1))) as u32,
            }
        })
        .collect()
}

/// How far the illuminance and direction of a case may be from their twins.
fn lamp_rounding(case: &LampCase, twin: &Incidence) -> (f64, f64) {
    let wide = |v: Vec3| v.as_dvec3();
    // Unshaped light: what the beam, or the lamp's own cosine, is a share of.
    let (towards, places, share, steepness) = match case.twin.shape {
        Shape::Distant { towards } => (towards, DVec3::ZERO, 1.0, 0.0),
        Shape::Point { position } | Shape::Ies { position, .. } => {
            (position - wide(case.p), DVec3::ZERO, 1.0, 0.0)
        }
        Shape::Spot { position, .. } => {
            let steepness = f64::from(case.light.beam_scale);
            (position - wide(case.p), DVec3::ZERO, 1.0, steepness)
        }
        Shape::Rectangle {
            centre,
            half_u,
            half_v,
            ..
        } => {
            let [[u, weight_u], [v, weight_v]] = case.rule();
            let towards = centre + half_u * u + half_v * v - wide(case.p);
            let share = weight_u * weight_v;
            let places = centre.abs() + half_u.abs() + half_v.abs() + wide(case.p).abs();
            (towards, places, share, 1.0)
        }
        Shape::Disc {
            centre,
            half_u,
            half_v,
            rings,
            ..
        } => {
            let ([x, y], share) = disc_rule(rings, case.sample);
            let towards = centre + half_u * x + half_v * y - wide(case.p);
            let places = centre.abs() + half_u.abs() + half_v.abs() + wide(case.p).abs();
            (towards, places, share, 1.0)
        }
    };
    let distance2 = towards.length_squared().max(1e-12);
    // Only an area's place is a sum of more than two: its rounding turns the direction.
    let turned = UNIT_PRODUCT * places.length() / distance2.sqrt();
    let unshaped = case.twin.amount.max_element() * share
        / distance2.max(f64::from(case.light.distance_squared_min));
    let of_light =
        unshaped * (UNIT_PRODUCT + turned) * steepness + twin.e.max_element() * 2.0 * turned;
    (RELATIVE + turned, of_light)
}

pub fn compare_lamps(gpu: &Gpu, physics: &str, lamps: Lamps) -> Result<f64, String> {
    let cases = lamp_cases(lamps, gpu.every);
    let given: Vec<f32> = cases
        .iter()
        .flat_map(|case| {
            let mut words = words(&case.light);
            words.extend(case.p.to_array());
            // A vector of two begins at a multiple of eight bytes.
            words.push(0.0);
            words.extend(case.rule().concat().iter().map(|v| *v as f32));
            words
        })
        .collect();
    let body = format!(
        "let x = given[index]; let incidence = {};
        found[to] = incidence.l.x; found[to + 1u] = incidence.l.y; found[to + 2u] = incidence.l.z;
        found[to + 3u] = incidence.e.x; found[to + 4u] = incidence.e.y;
        found[to + 5u] = incidence.e.z;",
        lamps.call()
    );
    let text = format!(
        "{physics}\nstruct Case {{ light: Light, p: vec3<f32>, u: vec2<f32>, v: vec2<f32> }}\n{}",
        entry("Case", cases.len(), 6, &body)
    );
    let found = gpu.run(&text, &given, cases.len(), 6);
    let (mut ways, mut lights) = (Vec::new(), Vec::new());
    for (case, found) in cases.iter().zip(found.chunks(6)) {
        let twin = case.twin.at(case.p.as_dvec3())[case.sample as usize];
        let (of_way, of_light) = lamp_rounding(case, &twin);
        let l = Vec3::from_slice(found).as_dvec3();
        // A length is not negative; the direction is judged by how far it is off.
        ways.push(Pair {
            gpu: (l - twin.l).length() as f32,
            cpu: 0.0,
            allowed: of_way,
        });
        for k in 0..3 {
            let mut pair = Pair::new(found[3 + k], twin.e[k], RELATIVE);
            pair.allowed += of_light;
            lights.push(pair);
        }
    }
    let case = |i: usize| {
        let LampCase {
            light, p, sample, ..
        } = &cases[i];
        format!("{light:?} at {p}, sample {sample}")
    };
    let of_way = judge(&format!("{lamps:?} lamps: direction"), &ways, case)?;
    let of_light = judge(&format!("{lamps:?} lamps: illuminance"), &lights, |i| {
        case(i / 3)
    })?;
    Ok(of_way.max(of_light))
}

pub fn judge_lamps(gpu: &Gpu) {
    for lamps in [
        Lamps::Distant,
        Lamps::Punctual,
        Lamps::Rectangle,
        Lamps::Disc,
        Lamps::Ies,
    ] {
        compare_lamps(gpu, bsdf(), lamps).unwrap();
    }
}

/// What an angle of an IES lamp may be off, in radians: a hundredth of the quarter degree in which
/// the narrowest beams lose a tenth of their peak.
const ANGLE: f64 = 2e-5;

/// Angles of IES lamps.
pub fn judge_angles(gpu: &Gpu) {
    let cases = lamp_cases(Lamps::Ies, gpu.every);
    let given: Vec<f32> = cases
        .iter()
        .flat_map(|case| {
            let mut words = words(&case.light);
            words.extend(case.p.to_array());
            words.push(0.0);
            words
        })
        .collect();
    let body = "let x = given[index]; let angles = ies_angles(x.light, x.p);
        found[to] = angles.x; found[to + 1u] = angles.y;";
    let text = format!(
        "{}\nstruct Case {{ light: Light, p: vec3<f32> }}\n{}",
        bsdf(),
        entry("Case", cases.len(), 2, body)
    );
    let found = gpu.run(&text, &given, cases.len(), 2);
    let mut worst = [0.0f64; 2];
    for (case, found) in cases.iter().zip(found.chunks(2)) {
        assert!(
            found.iter().all(|angle| angle.is_finite() && *angle >= 0.0),
            "{found:?}"
        );
        let l = (case.p - case.light.place).as_dvec3();
        // At the lamp's own place there is no direction.
        if l.length() < 1e-3 {
            continue;
        }
        let [gamma, c] = case.angles();
        worst[0] = worst[0].max((f64::from(found[0]) - gamma).abs());
        // On the axis every azimuth is as good: judge the arc.
        let turn = 2.0 * PI;
        let apart = (f64::from(found[1]) - c).rem_euclid(turn);
        worst[1] = worst[1].max(apart.min(turn - apart) * gamma.sin());
    }
    eprintln!("angles of IES lamps: {worst:?} rad off");
    assert!(worst.iter().all(|angle| *angle < ANGLE), "{worst:?}");
}
