//! Small exhibits by the walk.

use std::{f64::consts::FRAC_1_SQRT_2, f64::consts::PI, path::Path};

use glam::DVec3;
use recto::{
    manifest::Exhibit,
    maps::encode::{save_exr_rgb, save_png_grey16, save_png_rgb8},
    optics::lamp::{Shape, polygon_form},
    reference::{
        Absorption, Capture, Estimate, Lamp, Layers, Lighting, Phase,
        picture::{Crop, Exposure, Mode, Plate, Studio},
        radiance,
        rng::stream,
    },
};

use crate::statistic::{Z_MAX, exact, p_value, sidak, z};

/// Paths that undo a photograph here.
const CAPTURE_PATHS: u64 = 20_000;
const SEED: u64 = 70;

/// What the manifest says of the paper.
const LAYERS: Layers = Layers {
    n: 1.5,
    alpha: [0.5; 2],
    sigma_s: 81.38,
    phase: Phase {
        w_f: 1.0,
        g_f: 1.0 / 3.0,
        g_b: 0.0,
    },
    thickness_mm: 0.3,
};
const BARE: [f64; 3] = [0.7, 0.65, 0.6];

const HEAD: &str = "[exhibit]\ntitle = \"Sheet\"\nexposure = { lux = 500 }\n\
    [[drawing]]\nid = \"sheet\"\nsize_mm = [32, 32]\n\
    paper = { kind = \"laid\", thickness_um = 300, roughness = 0.5, albedo = [0.7, 0.65, 0.6], source = \"assumed\" }\n\
    [drawing.recto]\nalbedo = { file = \"albedo.exr\", encoding = \"linear\" }\n";

fn studio(more: &str, fill: impl FnOnce(&Path)) -> (Exhibit, Studio) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("exhibit.toml"), format!("{HEAD}{more}")).expect("text");
    fill(folder.path());
    let (exhibit, _) = Exhibit::read(folder.path()).unwrap_or_else(|faults| panic!("{faults}"));
    let studio = Studio::new(&exhibit, &exhibit.scenes[0], CAPTURE_PATHS, SEED);
    (exhibit, studio.unwrap_or_else(|error| panic!("{error}")))
}

/// A map of `edge` texels along each edge.
fn albedo(folder: &Path, edge: u32, at: impl Fn(u32, u32) -> [f32; 3]) {
    let pixels: Vec<[f32; 3]> = (0..edge * edge).map(|i| at(i % edge, i / edge)).collect();
    save_exr_rgb(&folder.join("albedo.exr"), edge, edge, &pixels).expect("the albedo");
}

fn take(studio: &Studio, size: u32, samples: u64, mode: Mode) -> Plate {
    let exposure = Exposure {
        size: [size; 2],
        crop: Crop {
            x: 0,
            y: 0,
            width: size,
            height: size,
        },
        samples,
        seed: SEED,
        mode,
    };
    let plate = studio.take(&exposure, || ());
    let numbers = plate.mean.iter().chain(&plate.variance).flatten();
    assert!(numbers.into_iter().all(|v| v.is_finite() && *v >= 0.0));
    plate
}

/// Mean over all pixels, per channel.
fn mean(plate: &Plate) -> [Estimate; 3] {
    let count = plate.mean.len() as f64;
    std::array::from_fn(|c| Estimate {
        mean: plate.mean.iter().map(|pixel| pixel[c]).sum::<f64>() / count,
        variance: plate.variance.iter().map(|pixel| pixel[c]).sum::<f64>() / (count * count),
    })
}

const INK: [f64; 3] = [0.2, 0.3, 0.5];

fn inked(folder: &Path) {
    albedo(folder, 4, |_, _| INK.map(|v| v as f32));
}

const SLANTED: &str = "[[lamp]]\nid = \"lamp\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
    elevation_deg = 35\nazimuth_deg = 180\n\
    [[scene]]\nid = \"scene\"\nlamps = [\"lamp\"]\n\
    camera = { centre_mm = [16, 16], width_mm = 8 }\n";

#[test]
fn an_even_sheet_is_the_walk_of_one_spot() {
    let (exhibit, studio) = studio(SLANTED, inked);
    let capture = Capture::new(&LAYERS, CAPTURE_PATHS, SEED);
    let with = |more: f64| -> [Absorption; 3] {
        std::array::from_fn(|c| {
            let sigma_a = capture.solve_sigma_a(BARE[c]).value;
            let paper = Absorption {
                sigma_a,
                ..Absorption::NONE
            };
            let tau = capture.solve_tau(f64::from(INK[c] as f32), &paper).value;
            Absorption {
                tau_f: tau * more,
                ..paper
            }
        })
    };
    let light = &exhibit.lighting(&exhibit.scenes[0]).lights[0];
    let Shape::Distant { towards } = light.shape else {
        panic!("a distant lamp");
    };
    let lamps = [Lamp {
        direction: towards,
        irradiance: light.amount.to_array(),
    }];
    let lighting = Lighting {
        lamps: &lamps,
        table: [0.0; 3],
    };
    let spot = |more: f64| {
        let mut rng = stream(71, 0);
        radiance(&LAYERS, &with(more), DVec3::Z, &lighting, 60_000, &mut rng)
    };
    let truth = spot(1.0);
    for mode in Mode::ALL {
        let plate = take(&studio, 6, 800, mode);
        for (c, (found, truth)) in mean(&plate).iter().zip(&truth).enumerate() {
            assert!(
                z(found, truth).abs() < Z_MAX,
                "{mode:?} {c}: {found:?} {truth:?}"
            );
        }
        // Each pixel's own variance is right too.
        let square = |pixel: usize| {
            let estimate = Estimate {
                mean: plate.mean[pixel][1],
                variance: plate.variance[pixel][1],
            };
            z(&estimate, &truth[1]).powi(2)
        };
        let count = plate.mean.len();
        let p = p_value((0..count).map(square).sum(), count as f64);
        assert!(p > sidak(2), "{mode:?}: {p}");
        // A twentieth more ink must be seen.
        let darker = spot(1.05);
        assert!(z(&mean(&plate)[1], &darker[1]).abs() > Z_MAX, "{mode:?}");
    }
}

#[test]
fn a_photograph_is_given_back_whatever_lies_on_the_paper() {
    // Of the capture's own 20 000 paths and of as many here, as a share of the albedo.
    const GIVEN_BACK: f64 = 0.04;
    // In quarters: ink, body colour, grains, and paper that is paler than the bare sheet.
    let quarters = [
        [0.20, 0.15, 0.10],
        [0.75, 0.74, 0.70],
        [0.35, 0.15, 0.10],
        [0.72, 0.68, 0.62],
    ];
    let more = "media = [{ file = \"media.png\", legend = { \"#ff0000\" = \"iron-gall-ink\", \
        \"#00ff00\" = \"white-gouache\", \"#0000ff\" = \"red-chalk\" } }]\n\
        [[lamp]]\nid = \"lamp\"\nkind = \"distant\"\nlux_at_sheet = 500\nelevation_deg = 45\n\
        azimuth_deg = 135\n\
        [[scene]]\nid = \"scene\"\nlamps = [\"lamp\"]\nexposure = { lux = 353.553390593 }\n\
        camera = { centre_mm = [16, 16], width_mm = 32 }\n";
    let quarter = |x: u32, y: u32| (2 * (y / 2) + x / 2) as usize;
    let (_, studio) = studio(more, |folder| {
        albedo(folder, 4, |x, y| {
            quarters[quarter(x, y)].map(|v: f64| v as f32)
        });
        let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]];
        let pixels: Vec<[u8; 3]> = (0..16).map(|i| colours[quarter(i % 4, i / 4)]).collect();
        save_png_rgb8(&folder.join("media.png"), 4, 4, &pixels, None).expect("the media");
    });
    // Pixels in the corners, where no texel of another quarter is near.
    for (i, [x, y]) in [[0, 0], [7, 0], [0, 7], [7, 7]].into_iter().enumerate() {
        let pixel = studio.take(
            &Exposure {
                size: [8; 2],
                crop: Crop {
                    x,
                    y,
                    width: 1,
                    height: 1,
                },
                samples: 20_000,
                seed: SEED,
                mode: Mode::Local,
            },
            || (),
        );
        let others = quarters[(i + 1) % 4];
        for (c, (quarter, other)) in quarters[i].into_iter().zip(others).enumerate() {
            let found = pixel.mean[0][c];
            let off = found / quarter - 1.0;
            let noise = Z_MAX * pixel.variance[0][c].sqrt() / found;
            eprintln!("quarter {i} channel {c}: {off:+.4} ± {noise:.4}");
            assert!(off.abs() < GIVEN_BACK + noise, "{i} {c}: {off}");
            // Another quarter's photograph is another one.
            assert!((found / other - 1.0).abs() > GIVEN_BACK, "{i} {c}");
        }
    }
}

#[test]
fn a_rectangle_lamp_gives_what_the_closed_form_says() {
    // Grains whose blue is black mirror nothing, as the photograph bounds their gloss: what is left
    // is a perfect diffuser. As dark as this they cover all of the paper.
    let more = "media = [{ file = \"media.png\", legend = { \"#0000ff\" = \"red-chalk\" } }]\n\
        [[lamp]]\nid = \"lamp\"\nkind = \"rectangle\"\nnits = 1000\nposition_mm = [150, 40, 120]\n\
        aim_mm = [0, 0, 0]\nsize_mm = [160, 90]\n\
        [[scene]]\nid = \"scene\"\nlamps = [\"lamp\"]\nambient = { lux = 100 }\n\
        camera = { centre_mm = [16, 16], width_mm = 0.1 }\n";
    let (exhibit, studio) = studio(more, |folder| {
        albedo(folder, 4, |_, _| [0.3, 0.15, 0.0]);
        let pixels = [[0, 0, 255]; 16];
        save_png_rgb8(&folder.join("media.png"), 4, 4, &pixels, None).expect("the media");
    });
    let lighting = exhibit.lighting(&exhibit.scenes[0]);
    let light = &lighting.lights[0];
    let Shape::Rectangle {
        centre,
        half_u,
        half_v,
        ..
    } = light.shape
    else {
        panic!("a rectangle");
    };
    let corners = [
        centre - half_u - half_v,
        centre + half_u - half_v,
        centre + half_u + half_v,
        centre - half_u + half_v,
    ];
    let area = 4.0 * half_u.length() * half_v.length();
    let lit = light.amount / area * polygon_form(&corners, DVec3::Z) + lighting.ambient;
    let plate = take(&studio, 2, 50_000, Mode::Local);
    let found = mean(&plate);
    for (c, albedo) in [(0, 0.3), (1, 0.15)] {
        let truth = exact(albedo * lit[c] / PI);
        assert!(
            z(&found[c], &truth).abs() < Z_MAX,
            "{c}: {found:?} {truth:?}"
        );
        assert!(found[c].deviation() < 2e-3 * found[c].mean);
        // A lamp that is a point in its middle must be told apart.
        let way = centre.length();
        let l = centre / way;
        let facing = -(half_u.cross(half_v).normalize()).dot(l);
        let point = light.amount[c] * facing.abs() * l.z / (way * way) + lighting.ambient[c];
        assert!(z(&found[c], &exact(albedo * point / PI)).abs() > Z_MAX);
    }
    assert_eq!(found[2].mean, 0.0);
}

#[test]
fn a_ridge_is_dark_behind_and_lit_before() {
    const EDGE: u32 = 64;
    let more = SLANTED.replace("elevation_deg = 35", "elevation_deg = 15");
    let more = format!("height = {{ file = \"height.png\", range_um = [0, 500] }}\n{more}");
    let more = more.replace("width_mm = 8", "width_mm = 16");
    let (_, studio) = studio(&more, |folder| {
        albedo(folder, EDGE, |_, _| [0.5; 3]);
        // A wall of 2 mm across the middle, wide enough for a smooth surface to come to its full
        // height; the lamp is to the left.
        let wall = |x: u32| if (30..34).contains(&x) { u16::MAX } else { 0 };
        let pixels: Vec<u16> = (0..EDGE * EDGE).map(|i| wall(i % EDGE)).collect();
        save_png_grey16(&folder.join("height.png"), EDGE, EDGE, &pixels, None).expect("heights");
    });
    for mode in Mode::ALL {
        let plate = take(&studio, 16, 40, mode);
        // Pixels of a mm from the left edge of the middle 16 mm: the wall ends about 9.
        let column = |x: usize| (0..16).map(|y| plate.mean[16 * y + x][1]).sum::<f64>() / 16.0;
        let paper = column(2);
        assert!(paper > 0.1, "{paper}");
        // The shadow is .5 mm / tan 15° = 1.87 mm long.
        assert!(column(9) < 0.02 * paper, "{mode:?}: {} {paper}", column(9));
        for lit in [4, 5, 12, 14] {
            let share = column(lit) / paper;
            assert!((share - 1.0).abs() < 0.2, "{mode:?} {lit}: {share}");
        }
    }
}

#[test]
fn a_seed_decides_whatever_the_threads() {
    let (_, studio) = studio(SLANTED, inked);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool")
            .install(|| take(&studio, 6, 5, Mode::Local))
    };
    assert_eq!(run(1), run(2));
    let other = studio.take(
        &Exposure {
            size: [6; 2],
            crop: Crop {
                x: 0,
                y: 0,
                width: 6,
                height: 6,
            },
            samples: 5,
            seed: SEED + 1,
            mode: Mode::Local,
        },
        || (),
    );
    assert_ne!(run(1), other);
}

#[test]
fn a_light_table_shines_through_and_the_bare_table_surrounds() {
    let more = "[[lamp]]\nid = \"lamp\"\nkind = \"light-table\"\nnits = 1000\n\
        [[scene]]\nid = \"scene\"\nlamps = [\"lamp\"]\n\
        camera = { centre_mm = [16, 16], width_mm = 64 }\n";
    let (exhibit, studio) = studio(more, |folder| {
        albedo(folder, 4, |_, _| BARE.map(|v| v as f32))
    });
    let light_table = exhibit.lighting(&exhibit.scenes[0]).light_table;
    let lighting = Lighting {
        lamps: &[],
        table: light_table.to_array(),
    };
    let capture = Capture::new(&LAYERS, CAPTURE_PATHS, SEED);
    let spot = |share: f64| {
        let paper = BARE.map(|albedo| Absorption {
            sigma_a: share * capture.solve_sigma_a(albedo).value,
            ..Absorption::NONE
        });
        let mut rng = stream(72, 0);
        radiance(&LAYERS, &paper, DVec3::Z, &lighting, 60_000, &mut rng)
    };
    let (truth, clearer) = (spot(1.0), spot(0.8));
    let frame = [16; 2];
    let part = |x: u32, width: u32| Exposure {
        size: frame,
        crop: Crop {
            x,
            y: 6,
            width,
            height: 4,
        },
        samples: 1_000,
        seed: SEED,
        mode: Mode::Local,
    };
    let found = mean(&studio.take(&part(6, 4), || ()));
    for c in 0..3 {
        assert!(
            z(&found[c], &truth[c]).abs() < Z_MAX,
            "{c}: {found:?} {truth:?}"
        );
        assert!(
            z(&found[c], &clearer[c]).abs() > Z_MAX,
            "{c}: {found:?} {clearer:?}"
        );
    }
    let around = studio.take(&part(0, 2), || ());
    let table = f64::from(recto::manifest::lighting::TABLE);
    assert!(
        around
            .mean
            .iter()
            .flatten()
            .all(|v| (v - table).abs() < 1e-9)
    );
}

/// Towards a lamp at 45°, as the photographer's.
#[test]
fn the_capture_is_what_the_picture_shows_at_45_0() {
    let more = SLANTED.replace("elevation_deg = 35", "elevation_deg = 45");
    let (exhibit, studio) = studio(&more, inked);
    let light = exhibit.lighting(&exhibit.scenes[0]).lights[0].amount;
    let found = mean(&take(&studio, 4, 2_000, Mode::Local));
    for c in 0..3 {
        let albedo = found[c].mean * PI / (light[c] * FRAC_1_SQRT_2);
        // Of the capture's paths, and of these.
        assert!((albedo / INK[c] - 1.0).abs() < 0.04, "{c}: {albedo}");
    }
}
