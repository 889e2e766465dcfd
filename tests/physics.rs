//! The f64 physics against closed forms, direct integration and another renderer.

#[path = "physics/lobes.rs"]
mod lobes;
#[path = "physics/matter.rs"]
mod matter;
#[path = "physics/tiers.rs"]
mod tiers;

use std::{f64::consts::PI, fs, path::Path, sync::Arc};

use glam::{DVec2, DVec3};
use recto::{
    colour,
    manifest::{
        Exhibit, LampKind,
        lighting::{direction, grid_for, rings_for},
    },
    maps::encode::save_png_rgb8,
    optics::{
        lamp::{Light, Shape, polygon_form},
        lamp_units::{rectangle_form, spot_share},
        photometry::Photometry,
        quadrature::GRIDS,
    },
    units::{Degrees, Lux},
};

use tiers::{EXACT, at_cosine};

fn light(shape: Shape) -> Light {
    Light {
        shape,
        amount: DVec3::ONE,
    }
}

#[test]
fn lamps_without_area_follow_their_closed_forms() {
    let p = DVec3::new(30.0, -20.0, 0.0);
    for degrees in [0.0f64, 45.0, 80.0, 89.0] {
        let cos = degrees.to_radians().cos();
        let towards = at_cosine(cos, 0.7);
        let distance = 700.0;
        let position = p + towards * distance;
        let from = |shape| light(shape).illuminance(p, DVec3::Z).x;
        let close = |found: f64, expected: f64| {
            assert!(
                (found / expected - 1.0).abs() < EXACT,
                "{degrees}°: {found} {expected}"
            );
        };
        close(from(Shape::Distant { towards }), cos);
        let inverse_square = cos / (distance * distance);
        close(from(Shape::Point { position }), inverse_square);
        // A spot that aims 5° past the point, with its soft edge from 3° to 8°.
        let aside = towards.any_orthonormal_vector();
        let [cos_aim, cos_hotspot, cos_falloff] = [5.0f64, 3.0, 8.0].map(|x| x.to_radians().cos());
        let axis = -(towards * cos_aim + aside * 5.0f64.to_radians().sin());
        let spot = Shape::Spot {
            position,
            axis,
            cos_hotspot,
            cos_falloff,
        };
        let share = (cos_aim - cos_falloff) / (cos_hotspot - cos_falloff);
        assert!((from(spot) / (share * inverse_square) - 1.0).abs() < 1e-9);
        assert!((share - spot_share(cos_aim, cos_hotspot, cos_falloff)).abs() < EXACT);
    }
}

/// The rectangle with unit luminance, and its exact illuminance, where it is wholly above.
fn rectangle(centre: DVec3, axis: DVec3, half: DVec2, grid: u32) -> (Light, f64) {
    let u = axis.any_orthonormal_vector();
    let (half_u, half_v) = (u * half.x, axis.cross(u) * half.y);
    let corners = [
        centre - half_u - half_v,
        centre + half_u - half_v,
        centre + half_u + half_v,
        centre - half_u + half_v,
    ];
    let shape = Shape::Rectangle {
        centre,
        axis,
        half_u,
        half_v,
        grid,
    };
    let lamp = Light {
        shape,
        amount: DVec3::splat(4.0 * half.x * half.y),
    };
    (lamp, polygon_form(&corners, DVec3::Z))
}

#[test]
fn rectangles_meet_the_polygon_formula() {
    let tilted = DVec3::new(-0.6, 0.0, -0.8);
    // Centre, axis, half size, and the relative error that is expected of so few samples.
    for (centre, axis, half, expected) in [
        // A soft box overhead, far and near.
        (DVec3::Z * 1000.0, -DVec3::Z, DVec2::new(300.0, 300.0), 1e-3),
        (DVec3::Z * 400.0, -DVec3::Z, DVec2::new(300.0, 300.0), 1e-3),
        // Larger than its distance.
        (DVec3::Z * 150.0, -DVec3::Z, DVec2::new(300.0, 300.0), 2e-2),
        // Tilted, grazing, and a strip.
        (
            DVec3::new(600.0, 0.0, 800.0),
            tilted,
            DVec2::new(300.0, 100.0),
            1e-3,
        ),
        (
            DVec3::new(900.0, 0.0, 150.0),
            -DVec3::X,
            DVec2::new(100.0, 100.0),
            1e-3,
        ),
        (DVec3::Z * 500.0, -DVec3::Z, DVec2::new(600.0, 5.0), 1e-3),
    ] {
        let grid = grid_for(2.0 * half.max_element() / centre.length());
        let (lamp, exact) = rectangle(centre, axis, half, grid);
        let sampled = lamp.illuminance(DVec3::ZERO, DVec3::Z).x;
        let error = (sampled / exact - 1.0).abs();
        eprintln!("rectangle at {centre}, {grid} samples square: {error:.1e} off");
        assert!(error < expected, "{centre}: {sampled}, not {exact}");
    }
}

#[test]
fn a_rectangle_below_the_horizon_shines_with_its_upper_part() {
    // Its lower half lies below the plane. A Gauss rule expects a smooth light and meets a kink
    // at the horizon instead, where the light is dim: 3.4% were measured.
    let (centre, half) = (DVec3::X * 500.0, DVec2::splat(200.0));
    let (lamp, _) = rectangle(centre, -DVec3::X, half, *GRIDS.end());
    let sampled = lamp.illuminance(DVec3::ZERO, DVec3::Z).x;
    // Whole and halved have one light: nothing arrives from below.
    let upper = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(y, z)| centre + DVec3::new(0.0, y, z) * 200.0);
    let exact = polygon_form(&upper, DVec3::Z);
    assert!((sampled / exact - 1.0).abs() < 4e-2, "{sampled} {exact}");
}

/// A disc of unit luminance, sampled as a scene samples it.
fn disc(centre: DVec3, axis: DVec3, radius: f64) -> Light {
    let u = axis.any_orthonormal_vector();
    Light {
        shape: Shape::Disc {
            centre,
            axis,
            half_u: u * radius,
            half_v: axis.cross(u) * radius,
            rings: rings_for(2.0 * radius / centre.length()),
        },
        amount: DVec3::splat(PI * radius * radius),
    }
}

/// Illuminance of a disc of unit luminance at the origin with normal z, by a fine midpoint rule.
fn fine_disc(centre: DVec3, axis: DVec3, radius: f64) -> f64 {
    const STEPS: u32 = 400;
    let u = axis.any_orthonormal_vector();
    let v = axis.cross(u);
    let mut sum = 0.0;
    for ring in 0..STEPS {
        let r = radius * ((f64::from(ring) + 0.5) / f64::from(STEPS)).sqrt();
        for spoke in 0..STEPS {
            let (sin, cos) = ((f64::from(spoke) + 0.5) / f64::from(STEPS) * 2.0 * PI).sin_cos();
            let to = centre + (u * cos + v * sin) * r;
            let l = to.normalize();
            sum += l.z.max(0.0) * (-axis.dot(l)).max(0.0) / to.length_squared();
        }
    }
    sum * PI * radius * radius / f64::from(STEPS * STEPS)
}

#[test]
fn discs_meet_their_closed_form_on_the_axis_and_a_fine_integral_off_it() {
    // Radius over distance, and the relative error that is expected of so few samples.
    for (radius, expected) in [
        (10.0, 1e-5),
        (140.0, 5e-4),
        (450.0, 5e-4),
        (900.0, 5e-4),
        (3000.0, 2e-2),
    ] {
        let d = 1000.0;
        // E = π L r²/(r² + d²) (configuration factor B-13 of Howell's catalogue, times π).
        let exact = PI * radius * radius / (radius * radius + d * d);
        let sampled = disc(DVec3::Z * d, -DVec3::Z, radius).illuminance(DVec3::ZERO, DVec3::Z);
        let fine = fine_disc(DVec3::Z * d, -DVec3::Z, radius);
        assert!(
            (fine / exact - 1.0).abs() < 1e-4,
            "{radius}: {fine} {exact}"
        );
        let error = (sampled.x / exact - 1.0).abs();
        eprintln!("disc of radius {radius} at {d}: {error:.1e} off");
        assert!(error < expected, "{radius}: {sampled}, not {exact}");
    }
    let tilted = DVec3::new(-0.6, 0.0, -0.8);
    for (centre, axis, radius, expected) in [
        (DVec3::new(600.0, 0.0, 800.0), tilted, 120.0, 5e-4),
        (DVec3::new(600.0, 0.0, 800.0), tilted, 400.0, 5e-4),
        (DVec3::new(300.0, -500.0, 400.0), -DVec3::Z, 300.0, 5e-4),
        (DVec3::new(900.0, 0.0, 150.0), -DVec3::X, 100.0, 5e-4),
    ] {
        let sampled = disc(centre, axis, radius)
            .illuminance(DVec3::ZERO, DVec3::Z)
            .x;
        let exact = fine_disc(centre, axis, radius);
        let error = (sampled / exact - 1.0).abs();
        eprintln!("disc of radius {radius} at {centre}: {error:.1e} off");
        assert!(error < expected, "{centre}: {sampled}, not {exact}");
    }
    // It shines to one side only.
    let behind = disc(DVec3::Z * 500.0, DVec3::Z, 100.0);
    assert_eq!(behind.illuminance(DVec3::ZERO, DVec3::Z), DVec3::ZERO);
}

#[test]
fn the_strangest_lamps_stay_finite() {
    let places = [
        DVec3::ZERO,
        DVec3::X * 100.0,
        -DVec3::Z * 50.0,
        DVec3::Z * 1e-9,
        DVec3::new(1e5, 1e5, 1e-3),
    ];
    let file = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 9\n0 180\n0\n1 1\n";
    let photometry = Arc::new(Photometry::parse(file).expect("a lamp"));
    for lumen in [1e-3, 1.0, 1e7] {
        for position in places {
            let axis = -DVec3::Z;
            let rectangle = |half: f64| Shape::Rectangle {
                centre: position,
                axis,
                half_u: DVec3::X * half,
                half_v: DVec3::Y * half,
                grid: 4,
            };
            for shape in [
                Shape::Point { position },
                Shape::Spot {
                    position,
                    axis,
                    cos_hotspot: 1.0,
                    cos_falloff: 1.0,
                },
                rectangle(0.0),
                rectangle(1e5),
                disc(position, axis, 0.0).shape,
                disc(position, axis, 1e5).shape,
                Shape::Ies {
                    position,
                    axis,
                    across_u: DVec3::X,
                    across_v: -DVec3::Y,
                    photometry: Arc::clone(&photometry),
                },
            ] {
                let lamp = Light {
                    shape,
                    amount: DVec3::splat(lumen / (4.0 * PI) * 1e6),
                };
                let e = lamp.illuminance(DVec3::ZERO, DVec3::Z);
                assert!(e.is_finite() && e.min_element() >= 0.0, "{lamp:?}: {e}");
                let below = position.z <= 0.0;
                assert!(
                    !below || e == DVec3::ZERO,
                    "{lamp:?} lights from below: {e}"
                );
            }
        }
    }
}

/// An exhibit of one grey sheet, with `lamps` and further lines for its one scene.
fn exhibit(lamps: &str, scene: &str) -> Exhibit {
    let folder = tempfile::tempdir().expect("a folder");
    save_png_rgb8(&folder.path().join("grey.png"), 2, 1, &[[128; 3]; 2], None).expect("a picture");
    let manifest = format!(
        "[exhibit]\ntitle = \"Lamps\"\n[[drawing]]\nid = \"sheet\"\nsize_mm = [200, 100]\n\
         recto.albedo = \"grey.png\"\n{lamps}\n[[scene]]\nid = \"scene\"\ndrawing = \"sheet\"\n\
         {scene}\n"
    );
    fs::write(folder.path().join("exhibit.toml"), manifest).expect("a manifest");
    read(folder.path())
}

fn read(folder: &Path) -> Exhibit {
    let (exhibit, _) = Exhibit::read(folder).unwrap_or_else(|faults| panic!("{faults}"));
    exhibit
}

fn lamp(rest: &str) -> String {
    format!("[[lamp]]\nid = \"lamp\"\n{rest}\n")
}

/// What a perfect diffuser at the centre of the sheet shows, as luminance.
fn diffuser(exhibit: &Exhibit, n: DVec3) -> f64 {
    let lighting = exhibit.lighting(&exhibit.scenes[0]);
    let e: DVec3 = lighting
        .lights
        .iter()
        .map(|light| light.illuminance(DVec3::ZERO, n))
        .sum::<DVec3>()
        + lighting.ambient;
    colour::luminance((e / PI).to_array())
}

#[test]
fn a_perfect_diffuser_at_the_declared_illuminance_shows_1() {
    let close = |found: f64, expected: f64| {
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{found}, not {expected}"
        );
    };
    let raking = "kind = \"distant\"\nlux_at_sheet = 350\nelevation_deg = 20\nazimuth_deg = 30";
    let towards = direction(Degrees(20.0), Degrees(30.0));
    let lamps = "lamps = [\"lamp\"]\n";
    // Facing the lamp, it gets the lamp's illuminance; the sheet gets its cosine.
    let declared = exhibit(&lamp(raking), &format!("{lamps}exposure = {{ lux = 350 }}"));
    assert_eq!(declared.scenes[0].exposure.illuminance, Some(Lux(350.0)));
    close(diffuser(&declared, towards), 1.0);
    close(diffuser(&declared, DVec3::Z), 20.0f64.to_radians().sin());
    // Undeclared, it is what the lamps give to the sheet, whatever their colour.
    let warm = format!("{raking}\nkelvin = 2900");
    let found = exhibit(&lamp(&warm), lamps);
    close(diffuser(&found, DVec3::Z), 1.0);
    let lighting = found.lighting(&found.scenes[0]);
    close(lighting.reference_lux, 350.0 * 20.0f64.to_radians().sin());
    let [r, _, b] = lighting.lights[0].amount.to_array();
    assert!(r > b, "2900 K is warm for an eye used to daylight");
    // The room's light counts as well.
    let room = exhibit(&lamp(raking), &format!("{lamps}ambient = {{ lux = 40 }}"));
    close(diffuser(&room, DVec3::Z), 1.0);
    // At half the exposure it shows half as much.
    let darker = exhibit(&lamp(raking), &format!("{lamps}exposure = {{ lux = 700 }}"));
    close(diffuser(&darker, towards), 0.5);
}

#[test]
fn lumen_candela_and_nits_are_one_light() {
    /// Steps of the integrals over the sphere.
    const STEPS: u32 = 100_000;
    let placed = "position_mm = [0, 0, 500]";
    let of = |rest: &str| exhibit(&lamp(&format!("{rest}\n{placed}")), "lamps = [\"lamp\"]");
    let close = |found: f64, expected: f64| {
        assert!(
            (found / expected - 1.0).abs() < 1e-4,
            "{found}, not {expected}"
        );
    };
    let lux = |exhibit: &Exhibit| exhibit.lighting(&exhibit.scenes[0]).reference_lux;

    let bulb = of("kind = \"point\"\nlumen = 800");
    close(lux(&bulb), 800.0 / (4.0 * PI) / 0.25);
    close(lux(&of("kind = \"point\"\ncandela = 100")), 400.0);
    close(lux(&of("kind = \"point\"\nlux_at_sheet = 123")), 123.0);

    // The light of a spot as it arrives, integrated over a sphere around it, is what it sends.
    let spot = of("kind = \"spot\"\nlumen = 250\nhotspot_deg = 12\nfalloff_deg = 40");
    assert!(matches!(spot.lamps[0].kind, LampKind::Spot { .. }));
    let lighting = spot.lighting(&spot.scenes[0]);
    let exposure = PI / lighting.reference_lux;
    let beam = &lighting.lights[0];
    let lumen: f64 = (0..STEPS)
        .map(|i| {
            let cos = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(STEPS);
            let out = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
            // On a sphere of 1 m, in lm/m², facing the lamp.
            let e = beam.illuminance(DVec3::Z * 500.0 + out * 1000.0, -out).y / exposure;
            e * 4.0 * PI / f64::from(STEPS)
        })
        .sum();
    close(lumen, 250.0);

    let size = "kind = \"rectangle\"\nsize_mm = [40, 20]";
    let panel = of(&format!("{size}\nnits = 5000"));
    let form = rectangle_form(
        DVec3::Z * 500.0,
        DVec3::ZERO,
        DVec2::new(40.0, 20.0),
        DVec3::ZERO,
    );
    // Sampled, so within a cell's apparent size squared.
    assert!((lux(&panel) / (5000.0 * form) - 1.0).abs() < 2e-3);
    let same = of(&format!(
        "{size}\nlumen = {}",
        5000.0 * PI * 40.0 * 20.0 / 1e6
    ));
    close(lux(&same), lux(&panel));
}
