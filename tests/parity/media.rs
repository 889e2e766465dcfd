//! Media on the paper, and the lobes of paper that are off by default.

use recto::optics::{
    lobes::{
        albedo_under_sheen, alpha_towards, brdf_gloss, brdf_sheen, combed_capture, gloss_lobe,
        gloss_lobe_anisotropic, sheen_albedo, turned, under_sheen,
    },
    matter::{
        Cover, Particle, Shares, borne_out, brdf_body, interface_of, mean_of, particle_capture,
        particle_gloss, particle_lobe, passing, shares_of, uncovered_share, veiled, with_borne,
    },
};

use super::*;

fn physics() -> String {
    format!("{}\n{}", bsdf(), gpu::media())
}

/// Writes colours and numbers, in this order.
fn outputs(colours: &[&str], numbers: &[&str]) -> String {
    let mut text = String::new();
    let channels = colours
        .iter()
        .flat_map(|colour| ["x", "y", "z"].map(|c| format!("({colour}).{c}")));
    let numbers = numbers.iter().map(|number| (*number).to_owned());
    for (k, value) in channels.chain(numbers).enumerate() {
        text += &format!("found[to + {k}u] = {value};\n");
    }
    text
}

fn colour_at(at: usize) -> String {
    format!(
        "vec3(given[at + {at}u], given[at + {}u], given[at + {}u])",
        at + 1,
        at + 2
    )
}

fn colour(x: &[f64], at: usize) -> DVec3 {
    DVec3::from_slice(&x[at..])
}

fn narrow(case: Vec<f64>) -> Vec<f32> {
    case.into_iter().map(|x| x as f32).collect()
}

/// Photograph, bare paper, body colour, grains, shares, roughness, index, the interface's means.
fn spots() -> Vec<Vec<f32>> {
    let seeded = Seeded::new(21);
    (0..100_000)
        .map(|_| {
            let mut case = Vec::new();
            // From black to beyond white.
            case.extend((0..3).map(|_| seeded.log_or_zero(1e-4, 2.0)));
            case.extend((0..6).map(|_| seeded.log(1e-3, 1.0)));
            let body = seeded.pick(&[0.0, 0.0, 1.0, seeded.unit()]);
            let particles = (1.0 - body) * seeded.pick(&[0.0, 1.0, seeded.unit(), seeded.unit()]);
            case.extend((0..3).map(|_| particles * seeded.log(1e-3, 1.0)));
            case.extend([seeded.pick(&[0.0, 1.0, seeded.unit()]), body, particles]);
            case.extend([seeded.log(1e-3, 1.0), 1.0 + seeded.log(1e-2, 2.0)]);
            // Compensation, t̄, capture, floor.
            case.extend([seeded.log_or_zero(1e-4, 0.1), 1.0 - 0.7 * seeded.unit()]);
            case.extend([1.0 + seeded.unit(), seeded.log_or_zero(1e-5, 0.05)]);
            narrow(case)
        })
        .collect()
}

fn spot(x: &[f64]) -> (Surface, InterfaceMean, Shares, Cover) {
    let s = Surface::new(colour(x, 0), x[15], x[16], 1.0);
    let mean = InterfaceMean {
        compensation: x[17],
        t_mean: x[18],
        capture: x[19],
        floor: x[20],
    };
    let cover = Cover {
        film: x[12],
        body: x[13],
        particles: x[14],
        grains: colour(x, 9),
    };
    let shares = shares_of(&s, &mean, colour(x, 3), colour(x, 6), &cover);
    (s, mean, shares, cover)
}

fn flat(colours: &[DVec3], numbers: &[f64]) -> Vec<f64> {
    let channels = colours.iter().flat_map(|colour| colour.to_array());
    channels.chain(numbers.iter().copied()).collect()
}

fn divided() -> Twins {
    let sums = [
        // Differences of equals round to either side of nothing.
        "max(shares.paper, vec3(0.0))",
        "shares.body",
        "cover.grains * shares.scale",
        "shares.lit",
        // From here on of what is hardly anything, by its share.
        "max(uncovered_share(shares, bare) * bare * max(shares.uncovered, SHARE_LEAST), vec3(0.0))",
        "passing(cover, body, 2.0 * bare)",
        "veiled(cover, body, 2.0 * bare, bare)",
    ];
    Twins {
        name: "a spot's photograph, divided",
        body: format!(
            "let bare = {}; let body = {};
            let f = given[at + 16u];
            let s = Surface({}, given[at + 15u], f, 0.0, 1.0, fresnel_dielectric(CAPTURE_COS_D, f));
            let mean = InterfaceMean(given[at + 17u], given[at + 18u], given[at + 19u],
                given[at + 20u]);
            let cover = Cover(given[at + 12u], given[at + 13u], given[at + 14u], {});
            let shares = shares_of(s, mean, bare, body, cover);
            {}",
            colour_at(3),
            colour_at(6),
            colour_at(0),
            colour_at(9),
            outputs(
                &sums,
                &[
                    "shares.surface",
                    "shares.uncovered",
                    "borne_out(s, mean, bare, body, cover)",
                    "with_borne(cover, 0.25).film",
                    "with_borne(cover, 0.25).particles",
                ]
            ),
        ),
        twin: |x| {
            let (s, mean, shares, cover) = spot(x);
            let bare = colour(x, 3);
            let of_open = uncovered_share(&shares, bare) * bare * shares.uncovered.max(1e-4);
            flat(
                &[
                    shares.paper.max(DVec3::ZERO),
                    shares.body,
                    cover.grains * shares.scale,
                    shares.lit,
                    of_open.max(DVec3::ZERO),
                    passing(&cover, colour(x, 6), 2.0 * bare),
                    veiled(&cover, colour(x, 6), 2.0 * bare, bare),
                ],
                &[
                    shares.surface,
                    shares.uncovered,
                    borne_out(&s, &mean, bare, colour(x, 6), &cover),
                    with_borne(&cover, 0.25).film,
                    with_borne(&cover, 0.25).particles,
                ],
            )
        },
        relative: |_| RELATIVE,
        cases: spots(),
    }
}

/// What the rounding of differences of albedos costs.
fn rounding_of_albedos(x: &[f64]) -> f64 {
    let (s, mean, ..) = spot(x);
    let terms = s.albedo.max_element() + capture_floor(&s, &mean) + 1.0;
    // What is left uncovered is rounded too, and told from what is covered.
    let cover = &x[12..15];
    let covered = colour(x, 6) * cover[1] + colour(x, 9);
    let open = (1.0 - cover[1] - cover[2]).max(0.0);
    let expected = covered + colour(x, 3) * open;
    let told = (colour(x, 3) / expected.max(DVec3::splat(1e-6))).max_element();
    // A quotient of sums of products of differences.
    let less = (colour(x, 3) + capture_floor(&s, &mean)) * cover[2] - colour(x, 9);
    let borne = terms * terms / less.dot(less).max(1e-8);
    // So it is against what body colour lets through.
    let passes = open + 1e-6 + cover[1] * colour(x, 6).min_element();
    4.0 * terms * UNIT_PRODUCT * (1.0 + told + borne) + UNIT_PRODUCT / passes
}

fn particles() -> Twins {
    let seeded = Seeded::new(22);
    Twins {
        name: "particles",
        body: format!(
            "let particle = Particle({}, given[at + 3u], {}, {}, vec3(0.0));
            let g = Facing(given[at + 10u], given[at + 11u], given[at + 12u], given[at + 13u]);
            {}",
            colour_at(0),
            colour_at(4),
            colour_at(7),
            outputs(
                &[
                    "particle_lobe(particle, particle.alpha, g)",
                    "particle_capture(particle, particle.alpha)",
                ],
                &[]
            ),
        ),
        twin: |x| {
            let particle = Particle {
                n: colour(x, 0),
                alpha: x[3],
                k: colour(x, 4),
                f_capture: colour(x, 7),
                albedo: DVec3::ZERO,
            };
            let g = Facing {
                mu_i: x[10],
                mu_o: x[11],
                cos_d: x[12],
                sin2_h: x[13],
            };
            let lobe = particle_lobe(&particle, particle.alpha, &g);
            flat(&[lobe, particle_capture(&particle, particle.alpha)], &[])
        },
        relative: |x| near_mirror(x[3]),
        cases: (0..100_000)
            .map(|_| {
                let mut case: Vec<f64> = (0..3).map(|_| seeded.log(1e-2, 6.0)).collect();
                case.push(seeded.log(1e-4, 1.0));
                case.extend((0..3).map(|_| seeded.log_or_zero(1e-4, 20.0)));
                case.extend((0..3).map(|_| seeded.unit()));
                case.extend([seeded.log(1e-4, 1.0), seeded.log(1e-4, 1.0)]);
                case.extend([
                    seeded.log_or_zero(1e-4, 1.0),
                    seeded.log_or_zero(1e-14, 1.0),
                ]);
                narrow(case)
            })
            .collect(),
    }
}

fn gloss() -> Twins {
    let seeded = Seeded::new(23);
    Twins {
        name: "particle_gloss",
        body: format!(
            "found[to] = particle_gloss({}, {}, {});",
            colour_at(0),
            colour_at(3),
            colour_at(6)
        ),
        twin: |x| vec![particle_gloss(colour(x, 0), colour(x, 3), colour(x, 6))],
        relative: |_| RELATIVE,
        cases: (0..100_000)
            .map(|_| {
                let mut case: Vec<f64> = (0..3).map(|_| seeded.log_or_zero(1e-6, 2.0)).collect();
                // No lobe of these facets mirrors more than .7 into the photograph.
                case.extend((0..3).map(|_| seeded.log_or_zero(1e-9, 0.7)));
                case.extend((0..3).map(|_| seeded.log_or_zero(1e-6, 1.2)));
                narrow(case)
            })
            .collect(),
    }
}

fn surfaces() -> Twins {
    let seeded = Seeded::new(24);
    Twins {
        name: "body colour, and surfaces of another index",
        body: format!(
            "let at_i = Interface(given[at + 3u], given[at + 4u]);
            let at_o = Interface(given[at + 5u], given[at + 6u]);
            let mean = InterfaceMean(given[at + 7u], given[at + 8u], given[at + 9u],
                given[at + 10u]);
            let other = interface_of(at_i, given[at + 11u]);
            let means = mean_of(mean, given[at + 11u]);
            {}",
            outputs(
                &[&format!("brdf_body({}, at_i, at_o, mean)", colour_at(0))],
                &[
                    "other.t",
                    "other.late",
                    "means.compensation",
                    "means.t_mean",
                    "means.capture",
                    "means.floor"
                ]
            ),
        ),
        twin: |x| {
            let (at_i, at_o) = (
                Interface {
                    t: x[3],
                    late: x[4],
                },
                Interface {
                    t: x[5],
                    late: x[6],
                },
            );
            let mean = InterfaceMean {
                compensation: x[7],
                t_mean: x[8],
                capture: x[9],
                floor: x[10],
            };
            let other = interface_of(&at_i, x[11]);
            let means = mean_of(&mean, x[11]);
            flat(
                &[brdf_body(colour(x, 0), &at_i, &at_o, &mean)],
                &[
                    other.t,
                    other.late,
                    means.compensation,
                    means.t_mean,
                    means.capture,
                    means.floor,
                ],
            )
        },
        relative: |_| RELATIVE,
        cases: (0..100_000)
            .map(|_| {
                let mut case: Vec<f64> = (0..3).map(|_| seeded.log_or_zero(1e-6, 1.1)).collect();
                case.extend((0..4).map(|_| seeded.log_or_zero(1e-6, 1.0)));
                case.extend([seeded.log_or_zero(1e-4, 0.1), 1.0 - 0.25 * seeded.unit()]);
                case.extend([1.0 + 0.3 * seeded.unit(), seeded.log_or_zero(1e-5, 0.05)]);
                // From index 1 to 2.1 over 1.5.
                case.push(seeded.log_or_zero(1e-2, 2.5));
                narrow(case)
            })
            .collect(),
    }
}

/// Light, eye, roughness, stretch, index, share turned back.
fn combed() -> Twins {
    let seeded = Seeded::new(25);
    Twins {
        name: "combed gloss",
        body: format!(
            "let l = {}; let v = {};
            let s = Surface(vec3(0.0), given[at + 6u], given[at + 8u], 0.0, 1.0, 0.0);
            let stretch = given[at + 7u];
            let n = vec3(0.0, 0.0, 1.0);
            let straight = gloss_lobe_anisotropic(s, stretch, l, v);
            let back = gloss_lobe_anisotropic(s, stretch, l, turned(n, v));
            let at_i = Interface(given[at + 10u], given[at + 11u]);
            let at_o = Interface(given[at + 12u], given[at + 13u]);
            let mean = InterfaceMean(given[at + 14u], 0.9, 1.1, 0.0);
            {}",
            colour_at(0),
            colour_at(3),
            outputs(
                &[],
                &[
                    "straight",
                    "gloss_lobe(s, facing(n, l, v))",
                    "brdf_gloss(s, straight, back, given[at + 9u], at_i, at_o, mean)",
                    "combed_capture(s.alpha, stretch)",
                    "alpha_towards(s.alpha, stretch, l)",
                ]
            ),
        ),
        twin: |x| {
            let (l, v) = (colour(x, 0), colour(x, 3));
            let s = Surface::new(DVec3::ZERO, x[6], x[8], 1.0);
            let straight = gloss_lobe_anisotropic(&s, x[7], l, v);
            let back = gloss_lobe_anisotropic(&s, x[7], l, turned(DVec3::Z, v));
            let (at_i, at_o) = (
                Interface {
                    t: x[10],
                    late: x[11],
                },
                Interface {
                    t: x[12],
                    late: x[13],
                },
            );
            let mean = InterfaceMean {
                compensation: x[14],
                ..InterfaceMean::default()
            };
            vec![
                straight,
                gloss_lobe(&s, &facing(DVec3::Z, l, v)),
                brdf_gloss(&s, straight, back, x[9], &at_i, &at_o, &mean),
                combed_capture(x[6], x[7]),
                alpha_towards(x[6], x[7], l),
            ]
        },
        relative: |_| RELATIVE,
        cases: (0..100_000)
            .map(|_| {
                let up = |d: DVec3| [d.x, d.y, d.z.abs().max(1e-3)];
                let mut case = up(seeded.direction()).to_vec();
                case.extend(up(seeded.direction()));
                case.extend([seeded.log(0.05, 1.0), 1.0 + seeded.log_or_zero(1e-3, 2.16)]);
                case.extend([1.0 + seeded.log(1e-2, 2.0), seeded.log_or_zero(1e-3, 1.0)]);
                case.extend((0..4).map(|_| seeded.log_or_zero(1e-6, 1.0)));
                case.push(seeded.log_or_zero(1e-4, 0.1));
                narrow(case)
            })
            .collect(),
    }
}

/// A direction's rounding, in a lobe as narrow as the facets across their grain.
fn rounding_of_directions(x: &[f64]) -> f64 {
    let (l, v) = (colour(x, 0), colour(x, 3));
    let s = Surface::new(DVec3::ZERO, x[6], x[8], 1.0);
    let narrow = s.alpha / x[7];
    let lobe = |v: DVec3| {
        let even = gloss_lobe(&s, &facing(DVec3::Z, l, v));
        let off = 8.0 * UNIT_PRODUCT / (narrow * narrow * (l + v).length().max(1e-3));
        off * gloss_lobe_anisotropic(&s, x[7], l, v).max(even)
    };
    lobe(v).max(lobe(turned(DVec3::Z, v)))
}

fn sheen() -> Twins {
    let mut cosines = cosines();
    cosines.extend(log_spaced(1e-7, 0.5, 20).iter().map(|x| 1.0 - x));
    let mut strengths = log_spaced(1e-3, 1.0, 12);
    strengths.push(0.0);
    Twins {
        name: "sheen",
        body: outputs(
            &[],
            &[
                "sheen_albedo(given[at])",
                "brdf_sheen(given[at + 1u], given[at])",
                "under_sheen(given[at + 1u], given[at], given[at + 2u])",
                "albedo_under_sheen(given[at + 1u], vec3(given[at])).x + 1.0",
            ],
        ),
        twin: |x| {
            vec![
                sheen_albedo(x[0]),
                brdf_sheen(x[1], x[0]),
                under_sheen(x[1], x[0], x[2]),
                albedo_under_sheen(x[1], DVec3::splat(x[0])).x + 1.0,
            ]
        },
        relative: |_| RELATIVE,
        cases: grid(&[cosines, strengths, log_spaced(1e-4, 1.0, 20)]),
    }
}

/// (1 − cos)⁵ and the fit's sum cancel towards 1.
fn rounding_of_sheen(x: &[f64]) -> f64 {
    2.0 * UNIT_PRODUCT * (0.3 + x[1])
}

/// Spots divided among media, particles and body colour, and the lobes that are off by default.
pub fn judge_media(gpu: &Gpu) {
    let physics = physics();
    divided()
        .compare_rounded(gpu, &physics, rounding_of_albedos)
        .unwrap();
    gloss()
        .compare_rounded(gpu, &physics, |_| 4.0 * UNIT_PRODUCT)
        .unwrap();
    particles().compare(gpu, &physics).unwrap();
    surfaces()
        .compare_rounded(gpu, &physics, |_| 4.0 * UNIT_PRODUCT)
        .unwrap();
    combed()
        .compare_rounded(gpu, &physics, rounding_of_directions)
        .unwrap();
    sheen()
        .compare_rounded(gpu, &physics, rounding_of_sheen)
        .unwrap();
}

#[test]
fn broken_media_are_found() {
    let gpu = Gpu::sampling(BROKEN);
    type Rounding = fn(&[f64]) -> f64;
    let tests: [(Twins, Rounding, &str, &str); 10] = [
        (
            particles(),
            |_| 0.0,
            "let q = 2.0 * n * k;",
            "let q = n * k;",
        ),
        (
            divided(),
            rounding_of_albedos,
            "inked * exp(-depth)",
            "inked",
        ),
        (divided(), rounding_of_albedos, "* cover.film;", "* 1.0;"),
        (
            divided(),
            rounding_of_albedos,
            "capture_floor(s, mean) * surface",
            "capture_floor(s, mean)",
        ),
        (
            divided(),
            rounding_of_albedos,
            "1.0 - cover.particles - cover.body",
            "1.0 - cover.particles",
        ),
        (
            gloss(),
            |_| 4.0 * UNIT_PRODUCT,
            "max(albedo, lit)",
            "albedo",
        ),
        (
            surfaces(),
            |_| 4.0 * UNIT_PRODUCT,
            "mean.floor * bounces",
            "mean.floor",
        ),
        (
            combed(),
            rounding_of_directions,
            "alpha * stretch, ALPHA_MIN",
            "alpha, ALPHA_MIN",
        ),
        (
            combed(),
            rounding_of_directions,
            "2.0 * dot(n, v)",
            "dot(n, v)",
        ),
        (
            sheen(),
            rounding_of_sheen,
            "m * m * m * m * m",
            "m * m * m * m",
        ),
    ];
    for (twins, rounding, sound, wrong) in tests {
        let shipped = physics();
        assert!(shipped.contains(sound), "{sound} is not in the shader");
        let physics = shipped.replace(sound, wrong);
        let outcome = twins.compare_rounded(&gpu, &physics, rounding);
        assert!(outcome.is_err(), "{wrong} passed: {outcome:?}");
    }
}
