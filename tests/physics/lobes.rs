//! Lobes that are off by default: reciprocity, and how much light they may add.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use glam::DVec3;
use recto::optics::{
    lobes::{
        SHEEN_MEAN, albedo_under_sheen, alpha_towards, brdf_gloss, brdf_sheen, combed_capture,
        gloss_lobe, gloss_lobe_anisotropic, sheen_albedo, stretch, turned, under_sheen,
    },
    table::InterfaceTable,
    tier::{Surface, brdf_gallery, brdf_gallery_specular, facing},
};

const RECIPROCITY: f64 = 1e-6;
/// OPTICS.md, "energy": a lossless sheet at gallery and above.
const LOSSLESS: f64 = 5e-3;
/// What full anisotropy adds to a lossless sheet of index 1.5, and takes from it. Measured: up to
/// +.019 and −.038, at α = .2 and .5 and grazing light; half as much anisotropy +.004 and −.006.
const COMBED: [f64; 2] = [0.02, 0.04];
/// What Burley's sheen of strength 1, laid on without taking light from below, adds at 85°.
const LAID_ON: f64 = 0.05;
/// What tables over all roughnesses give of the product of their own factors.
const TABLE: f64 = 1e-3;
/// Four lamps stand for all around: too few for a lobe as narrow as full anisotropy makes
/// that of α = .2. Measured .0076 there.
const FULL_GRAIN: f64 = 0.01;
const STEPS: u32 = 160;

fn towards(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), phi) = (theta.to_radians().sin_cos(), phi.to_radians());
    DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

/// ∫ f μ dω over the eye's hemisphere.
fn integral(f: impl Fn(DVec3) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..STEPS {
        let x = (f64::from(i) + 0.5) / f64::from(STEPS);
        let (mu, step) = (x * x, 2.0 * x / f64::from(STEPS));
        let sin = (1.0 - mu * mu).sqrt();
        for j in 0..STEPS {
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(STEPS);
            sum += f(DVec3::new(sin * phi.cos(), sin * phi.sin(), mu)) * mu * step;
        }
    }
    sum * TAU / f64::from(STEPS)
}

#[derive(Clone, Debug)]
struct Sheet {
    s: Surface,
    table: InterfaceTable,
    retro: f64,
    stretch: f64,
    sheen: f64,
}

impl Sheet {
    /// A lossless one, or one that photographs as `albedo`.
    fn new(alpha: f64, albedo: f64) -> Self {
        Self {
            s: Surface::new(DVec3::splat(albedo), alpha, 1.5, 1.0),
            table: InterfaceTable::new(1.5, 1.0),
            retro: 0.0,
            stretch: 1.0,
            sheen: 0.0,
        }
    }

    fn f(&self, l: DVec3, v: DVec3) -> f64 {
        let mut s = self.s;
        s.albedo = albedo_under_sheen(self.sheen, s.albedo);
        s.f_capture *= combed_capture(s.alpha, self.stretch);
        let (g, back) = (facing(DVec3::Z, l, v), turned(DVec3::Z, v));
        let at = |d: DVec3| {
            let alpha = alpha_towards(s.alpha, self.stretch, d);
            self.table.at(d.z, alpha)
        };
        let even = alpha_towards(s.alpha, self.stretch, DVec3::Z);
        let (at_i, at_o, mean) = (at(l), at(v), self.table.mean_at(even));
        let diffuse = brdf_gallery(&s, &g, &at_i, &at_o, &mean).x
            - brdf_gallery_specular(&s, &g, &at_i, &at_o, &mean);
        let lobe = |v: DVec3| {
            if self.stretch > 1.0 {
                gloss_lobe_anisotropic(&s, self.stretch, l, v)
            } else {
                gloss_lobe(&s, &facing(DVec3::Z, l, v))
            }
        };
        let gloss = brdf_gloss(&s, lobe(v), lobe(back), self.retro, &at_i, &at_o, &mean);
        (diffuse + gloss) * under_sheen(self.sheen, g.mu_i, g.mu_o)
            + brdf_sheen(self.sheen, g.cos_d)
    }
}

fn sheets(albedo: f64) -> Vec<Sheet> {
    let mut sheets = Vec::new();
    for alpha in [0.2, 0.5, 1.0] {
        for [retro, anisotropy, sheen] in [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.5, 0.0, 0.0],
            [0.0, 0.5, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.3, 0.3, 0.5],
        ] {
            sheets.push(Sheet {
                retro,
                stretch: stretch(anisotropy),
                sheen,
                ..Sheet::new(alpha, albedo)
            });
        }
    }
    sheets
}

#[test]
fn light_and_eye_can_be_exchanged() {
    for sheet in sheets(0.7) {
        for (l, v) in [
            (towards(10.0, 20.0), towards(70.0, 100.0)),
            (towards(85.0, 0.0), towards(40.0, 178.0)),
            (towards(60.0, 45.0), towards(60.0, 44.0)),
        ] {
            let (there, back) = (sheet.f(l, v), sheet.f(v, l));
            assert!((there - back).abs() < RECIPROCITY * there, "{there} {back}");
        }
    }
}

#[test]
fn no_lobe_gives_more_light_than_it_gets() {
    for sheet in sheets(9.0) {
        let most = match (sheet.stretch > 1.0, sheet.sheen > 0.0) {
            (true, _) => COMBED,
            // A sheen's own light is taken from what a white sheet can photograph.
            (false, true) => [LOSSLESS, 0.02],
            (false, false) => [LOSSLESS; 2],
        };
        let mut range = [f64::MAX, 0.0_f64];
        for theta in [0.0, 45.0, 70.0, 85.0] {
            for phi in [0.0, 45.0, 90.0] {
                let l = towards(theta, phi);
                let all = integral(|v| sheet.f(l, v));
                range = [range[0].min(all), range[1].max(all)];
                let sound = all < 1.0 + most[0] && all > 1.0 - most[1];
                assert!(sound, "{sheet:?} {theta}° {phi}°: {all}");
            }
        }
        println!(
            "α {} retro {} stretch {:.2} sheen {}: {:.4} to {:.4}",
            sheet.s.alpha, sheet.retro, sheet.stretch, sheet.sheen, range[0], range[1]
        );
    }
    // Burley's own sheen, laid on without taking light from below, is found.
    let sheet = Sheet::new(0.5, 9.0);
    let l = towards(85.0, 0.0);
    let laid_on = integral(|v| sheet.f(l, v) + brdf_sheen(1.0, facing(DVec3::Z, l, v).cos_d));
    assert!(laid_on > 1.0 + LAID_ON, "{laid_on}");
}

#[test]
fn the_photograph_is_kept_where_the_lobe_has_no_direction() {
    // Light at 45° from any side, the eye on the normal.
    for sheet in sheets(0.6) {
        let mut mean = 0.0;
        for i in 0..64 {
            let phi = (f64::from(i) + 0.5) * 360.0 / 64.0;
            mean += PI * sheet.f(towards(45.0, phi), DVec3::Z) / 64.0;
        }
        let plain = PI
            * Sheet {
                sheen: sheet.sheen,
                ..Sheet::new(sheet.s.alpha, 0.6)
            }
            .f(towards(45.0, 0.0), DVec3::Z);
        assert!((plain - 0.6).abs() < TABLE, "{plain}");
        // A grain has a direction: the mean of lamps all around is the photograph.
        let bound = if sheet.stretch > 1.0 {
            FULL_GRAIN
        } else {
            TABLE
        };
        println!(
            "photograph {} {:.2}: {mean:.5}",
            sheet.s.alpha, sheet.stretch
        );
        assert!((mean - 0.6).abs() < bound, "{mean}");
        if sheet.stretch > 2.0 && sheet.s.alpha < 0.6 {
            let across = PI * sheet.f(towards(45.0, 90.0), DVec3::Z);
            assert!((across - 0.6).abs() > TABLE, "{sheet:?}: {across}");
        }
    }
}

#[test]
fn retro_reflection_shines_back_and_a_grain_across() {
    let lamp = towards(60.0, 0.0);
    let retro = Sheet {
        retro: 0.5,
        ..Sheet::new(0.3, 0.5)
    };
    let plain = Sheet::new(0.3, 0.5);
    assert!(retro.f(lamp, lamp) > 1.5 * plain.f(lamp, lamp));
    let mirror = towards(60.0, 180.0);
    assert!(retro.f(lamp, mirror) < 0.7 * plain.f(lamp, mirror));
    // The rougher way is x: off the mirror there is more light along it.
    let combed = Sheet {
        stretch: stretch(0.8),
        ..Sheet::new(0.3, 0.0)
    };
    let steep = towards(50.0, 0.0);
    let along = combed.f(steep, DVec3::Z);
    let across = combed.f(towards(50.0, 90.0), DVec3::Z);
    assert!(along > 2.0 * across, "{along} {across}");
    assert_eq!(stretch(0.0), 1.0);
    assert!(
        (gloss_lobe_anisotropic(&plain.s, 1.0, lamp, DVec3::Z)
            / gloss_lobe(&plain.s, &facing(DVec3::Z, lamp, DVec3::Z))
            - 1.0)
            .abs()
            < 1e-9
    );
}

#[test]
fn the_sheens_albedo_is_its_integral() {
    let mut mean = 0.0;
    for i in 0..50 {
        let mu = (f64::from(i) + 0.5) / 50.0;
        let l = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
        let exact = integral(|v| brdf_sheen(1.0, facing(DVec3::Z, l, v).cos_d));
        assert!((sheen_albedo(mu) - exact).abs() < 5e-5, "{mu}: {exact}");
        mean += 2.0 * mu * exact / 50.0;
    }
    assert!((SHEEN_MEAN - mean).abs() < 5e-5, "{mean}");
    assert!(sheen_albedo(FRAC_1_SQRT_2) < 0.006);
}
