//! What a tier shows of one spot of a sheet: the f64 twin of the fragment in
//! `shaders/paper_material.wgsl`, for judging and predicting tiers without a device.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use super::{
    bsdf::Specimen,
    ink::{beyond_capture, internal_reflectance, optical_depth},
    lamp::{Incidence, Light, Shape},
    matter::{passing, uncovered_share, veiled},
    microfacet::MU_MIN,
    refraction::mean_inner_cosine,
    study::split_even,
    through::{Seen, through_study, toned_paper},
    tier::{Surface, Tier, albedo_of, brdf_lambert},
};

/// A spot of a flat sheet, in the sheet's frame.
#[derive(Clone, Debug)]
pub struct Spot {
    pub specimen: Specimen,
    /// Unit normal of the relief.
    pub normal: DVec3,
    /// Length of the mean normal under the spot, in (0, 1]; 1 on even paper.
    pub shortening: f64,
    /// For light through the sheet.
    pub behind: Behind,
}

/// What light through the sheet meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind {
    /// Photographed albedo of bare paper on the side that is seen, linear sRGB.
    pub bare: DVec3,
    /// Photographed albedo of the other side, here and where it is bare.
    pub other: DVec3,
    pub other_bare: DVec3,
    /// Transmittance of the spot's paper over that of the sheet.
    pub clear: f64,
}

/// Light from one direction, with the share of it that the relief lets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    pub incidence: Incidence,
    pub visible: f64,
}

/// Everything that lights a spot, pre-exposed as [`Light::amount`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Illumination {
    pub beams: Vec<Beam>,
    /// Illuminance of the room's even light.
    pub ambient: DVec3,
    /// Radiance of a light table behind the sheet.
    pub table: DVec3,
}

impl Spot {
    /// Bare or inked paper without relief.
    pub fn flat(specimen: Specimen, behind: Behind) -> Self {
        Self {
            specimen,
            normal: DVec3::Z,
            shortening: 1.0,
            behind,
        }
    }

    /// Radiance towards `v` (a unit vector in the sheet's frame), in units in which a perfect
    /// diffuser at the reference illuminance shows 1.
    pub fn radiance(&self, tier: Tier, v: DVec3, light: &Illumination) -> DVec3 {
        let upright = DQuat::from_rotation_arc(self.normal, DVec3::Z);
        let eye = upright * v;
        let mut radiance = light.table * self.through(tier, eye.z);
        for beam in &light.beams {
            let l = upright * beam.incidence.l;
            if l.z > 0.0 && beam.incidence.l.z > 0.0 && beam.visible > 0.0 {
                let f = self.specimen.reflected(tier, l, eye, self.shortening);
                radiance += f * beam.incidence.e * (l.z * beam.visible);
            }
        }
        if light.ambient != DVec3::ZERO {
            radiance += self.even(tier, eye.z) * light.ambient / PI;
        }
        radiance
    }

    /// π times the radiance under even light of unit illuminance.
    fn even(&self, tier: Tier, mu_o: f64) -> DVec3 {
        let s = &self.specimen.surface;
        if !tier.is_coupled() {
            return brdf_lambert(s) * PI;
        }
        let study = &self.specimen.study;
        let mean = self.specimen.interface.mean_at(s.alpha);
        let mu_o = mu_o.max(MU_MIN);
        let at_o = self.specimen.interface.at(mu_o, s.alpha);
        let mut albedo = albedo_of(s, &mean);
        if tier == Tier::Study {
            albedo = self.specimen.remaining(albedo, &mean);
        }
        let mut diffuse = albedo * (at_o.t * mean.t_mean * mean.capture);
        if tier == Tier::Study {
            let (capture, path_o) = (self.specimen.capture(), self.specimen.path(mu_o));
            let depth = self.specimen.depth();
            diffuse *= beyond_capture(depth, capture, study.film.diffuse_path, path_o)
                * split_even(&study.split, mean_inner_cosine(path_o), depth);
        }
        diffuse + (1.0 - at_o.t)
    }

    /// Share of a light table's radiance that is seen through the sheet at cosine `mu_o`.
    fn through(&self, tier: Tier, mu_o: f64) -> DVec3 {
        let Specimen {
            surface: s,
            interface,
            study,
            ..
        } = &self.specimen;
        let behind = &self.behind;
        let crossed_once = |share: DVec3| share.clamp(DVec3::ZERO, DVec3::ONE).map(f64::sqrt);
        if !tier.is_coupled() {
            // Light crosses each ink once, where the photograph saw it crossed twice.
            let baked = crossed_once(s.albedo / behind.bare)
                * crossed_once(behind.other / behind.other_bare);
            return study.through.flat_share * behind.clear * baked;
        }
        let mean = interface.mean_at(s.alpha);
        let at_o = interface.at(mu_o.max(MU_MIN), s.alpha);
        let diffuse = |albedo: DVec3| {
            let surface = Surface { albedo, ..*s };
            albedo_of(&surface, &mean)
        };
        let share_f = diffuse(s.albedo) / study.bare;
        let share_b = diffuse(behind.other) / diffuse(behind.other_bare).max(DVec3::splat(1e-3));
        let film = &study.film;
        let (capture, path_o) = (
            self.specimen.capture(),
            self.specimen.path(mu_o.max(MU_MIN)),
        );
        let (cover, body_through) = (&self.specimen.cover, self.specimen.body_through);
        let (seen, baked) = if tier == Tier::Study {
            // Of what is neither grain nor body colour.
            let share_f = uncovered_share(&self.specimen.shares(), study.bare);
            let toned = toned_paper(&study.through, share_f);
            let darkness = optical_depth(film, capture, share_f);
            let seen = Seen {
                depth_f: veiled(cover, body_through, toned, darkness),
                clear: behind.clear,
                depth_b: optical_depth(film, capture, share_b),
                rho_f: internal_reflectance(film, DVec3::ONE.lerp(share_f, cover.film)),
                rho_b: internal_reflectance(film, share_b),
            };
            (seen, passing(cover, body_through, toned))
        } else {
            let r_i = DVec3::splat(1.0 - mean.t_mean / (s.eta * s.eta));
            let seen = Seen {
                depth_f: DVec3::ZERO,
                clear: behind.clear,
                depth_b: DVec3::ZERO,
                rho_f: r_i,
                rho_b: r_i,
            };
            let baked = crossed_once(share_f) * crossed_once(share_b);
            (seen, baked * passing(cover, body_through, DVec3::ONE))
        };
        baked * through_study(film, &study.through, &seen, &at_o, &mean, path_o, s.eta)
    }
}

/// The light of `light` at `p` (mm) as `tier` sees it, all of it visible: draft takes lamps with
/// an area for points in their middle.
pub fn beams(tier: Tier, light: &Light, p: DVec3) -> Vec<Beam> {
    let as_point = |centre, axis| Light {
        shape: Shape::Rectangle {
            centre,
            axis,
            half_u: DVec3::ZERO,
            half_v: DVec3::ZERO,
            grid: 1,
        },
        amount: light.amount,
    };
    let incidences = match light.shape {
        Shape::Rectangle { centre, axis, .. } | Shape::Disc { centre, axis, .. }
            if tier == Tier::Draft =>
        {
            as_point(centre, axis).at(p)
        }
        _ => light.at(p),
    };
    let beam = |incidence| Beam {
        incidence,
        visible: 1.0,
    };
    incidences.into_iter().map(beam).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::optics::medium::MediumId;

    /// Bare laid paper of this albedo.
    fn paper(albedo: DVec3) -> Spot {
        let laid = "laid".parse::<MediumId>().expect("laid paper").medium();
        let behind = Behind {
            bare: albedo,
            other: albedo,
            other_bare: albedo,
            clear: 1.0,
        };
        Spot::flat(Specimen::new(laid, albedo), behind)
    }

    #[test]
    fn a_facet_is_lit_by_what_it_faces_above_the_sheet() {
        let lit = |normal: DVec3, l: DVec3, visible: f64| {
            let incidence = Incidence {
                l: l.normalize(),
                e: DVec3::ONE,
            };
            let light = Illumination {
                beams: vec![Beam { incidence, visible }],
                ..Illumination::default()
            };
            let spot = Spot {
                normal: normal.normalize(),
                ..paper(DVec3::splat(0.7))
            };
            spot.radiance(Tier::Gallery, DVec3::Z, &light).max_element()
        };
        let leaning = DVec3::new(1.0, 0.0, 1.0);
        assert!(lit(leaning, DVec3::new(1.0, 0.0, 0.5), 1.0) > 0.0);
        assert!(lit(leaning, DVec3::new(-0.95, 0.0, 1.0), 1.0) > 0.0);
        // Turned away from a lamp above the sheet; towards one below it; in the shade.
        assert_eq!(lit(leaning, DVec3::new(-1.0, 0.0, 0.5), 1.0), 0.0);
        assert_eq!(lit(leaning, DVec3::new(1.0, 0.0, -0.5), 1.0), 0.0);
        assert_eq!(lit(leaning, DVec3::new(1.0, 0.0, 0.5), 0.0), 0.0);
    }

    /// Where a tier knows no films, light crosses the ink of the other side once.
    #[test]
    fn ink_behind_dims_by_the_root_of_what_is_photographed() {
        let shown = |ink: f64, bare: f64| {
            let mut spot = paper(DVec3::splat(0.7));
            spot.behind.other_bare = DVec3::splat(bare);
            spot.behind.other = ink * spot.behind.other_bare;
            let table = Illumination {
                table: DVec3::ONE,
                ..Illumination::default()
            };
            spot.radiance(Tier::Draft, DVec3::Z, &table)
        };
        assert!(
            (shown(0.25, 0.5) / shown(1.0, 0.7) - 0.5)
                .abs()
                .max_element()
                < 1e-12
        );
    }

    /// Even light is what beams from everywhere give together. The surface's own mirroring of
    /// them is coarser than this sum: matte paper has none to speak of.
    #[test]
    fn the_rooms_light_is_that_of_beams_from_everywhere() {
        const STEPS: u32 = 48;
        let mut beams = Vec::new();
        for i in 0..STEPS {
            // Of equal irradiance: dμ² is even.
            let mu = ((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt();
            for j in 0..STEPS {
                let (sin, cos) = (TAU * f64::from(j) / f64::from(STEPS)).sin_cos();
                let across = (1.0 - mu * mu).sqrt();
                let incidence = Incidence {
                    l: DVec3::new(across * cos, across * sin, mu),
                    e: DVec3::splat(PI / f64::from(STEPS * STEPS) / mu),
                };
                let visible = 1.0;
                beams.push(Beam { incidence, visible });
            }
        }
        let ambient = Illumination {
            ambient: DVec3::splat(PI),
            ..Illumination::default()
        };
        let beams = Illumination {
            beams,
            ..Illumination::default()
        };
        for (tier, within) in [
            (Tier::Lambert, 1e-6),
            (Tier::Gallery, 0.02),
            (Tier::Study, 0.02),
        ] {
            let spot = paper(DVec3::new(0.8, 0.5, 0.2));
            for tilt in [0.0_f64, 0.7] {
                let v = DVec3::new(tilt.sin(), 0.0, tilt.cos());
                let [even, sum] = [&ambient, &beams].map(|light| spot.radiance(tier, v, light));
                let off = (even / sum - 1.0).abs().max_element();
                assert!(off < within, "{tier} {tilt}: {even} {sum}");
                // A tenth less light is no longer the same.
                assert!((0.9 * even / sum - 1.0).abs().max_element() > within);
            }
        }
    }
}
