//! What each tier would show of a scene, without rendering it: the sheet that is seen is sampled at
//! a few hundred places, and each tier's f64 twin is compared with what the judge would find there.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    correction,
    errors::{Errors, displayed, summary},
    places::{MapFault, Maps, Sheet},
};
use crate::{
    colour::delta_e00,
    manifest::{
        exhibit::{Drawing, Exhibit, Scene, Surface as Shape},
        eye::Eye,
        frames::side_from_table,
        lighting::Lighting,
    },
    needs::Needs,
    optics::{
        relief::{Horizon, rise_of, visible_over},
        shade::{Beam, Illumination, Spot, beams},
        table::InterfaceTable,
        tier::Tier,
    },
};

/// Places along the picture's width and height; a sheet that fills half of it has half of them.
const PLACES: [u32; 2] = [24, 18];
/// A picture of this width is meant where none is named.
pub const WIDTH_PX: u32 = 1920;
/// A place that is less sheet than this belongs to the table.
const SHEET: f64 = 0.5;

/// What a tier is predicted to do with a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub tier: Tier,
    /// Against the judge, over the sheet that is seen.
    pub errors: Errors,
}

impl Forecast {
    /// Of a tier in two scenes that are seen at once: each error where it is worse.
    fn worse(self, other: Self) -> Self {
        let Errors {
            rms,
            mean,
            p95,
            max,
        } = other.errors;
        Self {
            tier: self.tier,
            errors: Errors {
                rms: self.errors.rms.max(rms),
                mean: self.errors.mean.max(mean),
                p95: self.errors.p95.max(p95),
                max: self.errors.max.max(max),
            },
        }
    }
}

/// What a picture loses without a part of the model: ΔE00 between study with and without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worth {
    pub aspect: Aspect,
    pub mean: f64,
    pub p95: f64,
}

impl Worth {
    /// Of a part in two scenes that are seen at once: what it is worth where that is more.
    fn more(self, other: Self) -> Self {
        Self {
            aspect: self.aspect,
            mean: self.mean.max(other.mean),
            p95: self.p95.max(other.p95),
        }
    }
}

/// A scene's sheet at the places that are looked at.
pub struct Sampled {
    places: Vec<Place>,
    lighting: Lighting,
    level: f64,
}

/// All sheets that a scene shows: its own, or those of its comparison's members. One tier shows them
/// all, and is as exact as where it is worst.
pub struct Seen(Vec<Sampled>);

impl Seen {
    /// [`Sampled::new`] of each.
    ///
    /// # Errors
    /// As there.
    pub fn new(
        exhibit: &Exhibit,
        scene: &Scene,
        size: [u32; 2],
        maps: &mut Maps,
    ) -> Result<Self, MapFault> {
        let alone = exhibit.each_alone(scene);
        let sampled = alone
            .iter()
            .map(|member| Sampled::new(exhibit, member, size, maps));
        Ok(Self(sampled.collect::<Result<_, _>>()?))
    }

    /// How many places are looked at.
    pub fn count(&self) -> usize {
        self.0.iter().map(Sampled::count).sum()
    }

    /// These tiers against the judge.
    pub fn forecasts(&self, tiers: &[Tier]) -> Vec<Forecast> {
        let each = self.0.iter().map(|sampled| sampled.forecasts(tiers));
        place_by_place(each, Forecast::worse)
    }

    /// What each part of the model is worth.
    pub fn worths(&self) -> Vec<Worth> {
        place_by_place(self.0.iter().map(Sampled::worths), Worth::more)
    }
}

/// Lists of one length put together.
fn place_by_place<T>(lists: impl Iterator<Item = Vec<T>>, of: fn(T, T) -> T) -> Vec<T> {
    let both = |a: Vec<T>, b: Vec<T>| a.into_iter().zip(b).map(|(a, b)| of(a, b)).collect();
    lists.reduce(both).unwrap_or_default()
}

/// One place.
struct Place {
    /// In the side's own frame around the centre of the sheet, in mm.
    at: DVec3,
    /// Towards the eye.
    v: DVec3,
    spot: Spot,
    /// For each lamp, the horizon of the relief towards its middle.
    horizons: Vec<Option<Horizon>>,
    /// Photographed share of the bare paper's albedo.
    share: DVec3,
}

/// A part of the model that a tier may leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aspect {
    Relief,
    Shadows,
    Areas,
    Film,
    SingleScatter,
    Particles,
    Gloss,
    Coupling,
    ShowThrough,
}

impl Aspect {
    pub const ALL: [Self; 9] = [
        Self::Relief,
        Self::Shadows,
        Self::Areas,
        Self::Film,
        Self::SingleScatter,
        Self::Particles,
        Self::Gloss,
        Self::Coupling,
        Self::ShowThrough,
    ];

    /// What it is, for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relief => "relief in the light",
            Self::Shadows => "shadows of the relief",
            Self::Areas => "lamps with their area",
            Self::Film => "ink as a film, which light at a slant crosses on a longer way",
            Self::SingleScatter => "light scattered once in the paper, apart from the rest",
            Self::Particles => "metal, chalk and body colour, apart from paper and ink",
            Self::Gloss => "gloss of the surface",
            Self::Coupling => "diffuse light coupled to the surface",
            Self::ShowThrough => "the other side's ink, as it shows through",
        }
    }

    /// Whether `tier` has it, where the scene's maps do.
    pub fn is_in(self, tier: Tier) -> bool {
        match self {
            Self::Relief => true,
            Self::Shadows
            | Self::Film
            | Self::SingleScatter
            | Self::Particles
            | Self::ShowThrough => tier == Tier::Study,
            Self::Areas => tier != Tier::Draft,
            Self::Gloss => !matches!(tier, Tier::Lambert | Tier::OrenNayar),
            Self::Coupling => tier.is_coupled(),
        }
    }
}

impl Sampled {
    /// Reads the maps of `scene` that are not in `maps` yet, and samples the sheet as it is seen
    /// in a picture of `size` pixels.
    ///
    /// # Errors
    /// [`MapFault`] of the first map that cannot be read.
    pub fn new(
        exhibit: &Exhibit,
        scene: &Scene,
        size: [u32; 2],
        maps: &mut Maps,
    ) -> Result<Self, MapFault> {
        let drawing = exhibit.drawing_of(scene);
        let [width, height] = size.map(|side| f64::from(side.max(1)));
        let aspect = width / height;
        let eye = Eye::new(
            &scene.camera.fitted(drawing.size_mm, aspect),
            drawing.size_mm,
        );
        let [across, down] = PLACES;
        let points = (0..across * down).filter_map(|i| {
            // A row is shifted against the one before: no grid of the paper is met twice alike.
            let (column, row) = (f64::from(i % across), i / across);
            let shift = f64::from(row * 5 % 8) / 8.0;
            let ndc = DVec2::new(
                2.0 * (column + shift) / f64::from(across) - 1.0,
                1.0 - 2.0 * (f64::from(row) + 0.5) / f64::from(down),
            );
            eye.table_point(ndc, aspect)
        });
        Self::at(exhibit, scene, size, points, maps)
    }

    /// The same at `points` of the table's plane, of which those beside the sheet are left out.
    ///
    /// # Errors
    /// As [`Sampled::new`].
    pub fn at(
        exhibit: &Exhibit,
        scene: &Scene,
        size: [u32; 2],
        points: impl IntoIterator<Item = DVec3>,
        maps: &mut Maps,
    ) -> Result<Self, MapFault> {
        // Study asks for all maps that any tier would.
        let needs = Needs::of(exhibit, scene, Tier::Study, false);
        let drawing = exhibit.drawing_of(scene);
        let mut sampled = Self {
            places: Vec::new(),
            lighting: exhibit.lighting(scene),
            level: scene.exposure.level,
        };
        let Some(side) = needs.sides.first() else {
            return Ok(sampled);
        };
        for map in &side.maps {
            maps.load(map)?;
        }
        let sheet = Sheet::new(drawing, side, maps);
        let [width, height] = size.map(|side| f64::from(side.max(1)));
        let camera = scene.camera.fitted(drawing.size_mm, width / height);
        let eye = Eye::new(&camera, drawing.size_mm);
        let footprint = camera.width_mm / width;
        for at in points {
            let on_side = side_from_table(at, drawing.size_mm);
            let inside = on_side.cmpge(DVec2::ZERO).all() && on_side.cmple(drawing.size_mm).all();
            if !inside || sheet.coverage(on_side, footprint) < SHEET {
                continue;
            }
            let place = eye.place();
            let v = if place.w > 0.0 {
                (place.truncate() - at).normalize_or(DVec3::Z)
            } else {
                eye.towards
            };
            let (spot, share) = sheet.spot(on_side, footprint);
            let lights = sampled.lighting.lights.iter();
            let horizons = lights
                .map(|light| sheet.horizon(light, at, on_side, footprint))
                .collect();
            sampled.places.push(Place {
                at,
                v,
                spot,
                horizons,
                share,
            });
        }
        Ok(sampled)
    }

    /// What `tier` shows at each place, where a perfect white is shown at the scene's level.
    pub fn lights(&self, tier: Tier) -> Vec<DVec3> {
        self.each(|place| self.shown(place, tier, None) * self.level)
    }

    /// How many places of the sheet are seen.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// These tiers against the judge.
    pub fn forecasts(&self, tiers: &[Tier]) -> Vec<Forecast> {
        let truth = self.each(|place| self.judged(place));
        tiers
            .iter()
            .map(|&tier| {
                let shown = self.each(|place| self.shown(place, tier, None));
                Forecast {
                    tier,
                    errors: self.errors(&shown, &truth),
                }
            })
            .collect()
    }

    fn each(&self, of: impl Fn(&Place) -> DVec3 + Send + Sync) -> Vec<DVec3> {
        self.places.par_iter().map(of).collect()
    }

    /// What each part of the model is worth in this scene.
    pub fn worths(&self) -> Vec<Worth> {
        let all = self.study(None);
        Aspect::ALL
            .into_iter()
            .map(|aspect| {
                let Errors { mean, p95, .. } = self.errors(&self.study(Some(aspect)), &all);
                Worth { aspect, mean, p95 }
            })
            .collect()
    }

    fn study(&self, without: Option<Aspect>) -> Vec<DVec3> {
        self.each(|place| self.shown(place, Tier::Study, without))
    }

    fn errors(&self, shown: &[DVec3], truth: &[DVec3]) -> Errors {
        let pairs = || shown.iter().zip(truth);
        let differences = pairs()
            .map(|(a, b)| delta_e00(displayed(*a * self.level), displayed(*b * self.level)))
            .collect();
        let [mean, p95, max] = summary(differences);
        let relative = |(a, b): (&DVec3, &DVec3)| {
            let off = (*a - *b) / b.max(DVec3::splat(0.02));
            (off * off).element_sum() / 3.0
        };
        let rms = pairs().map(relative).sum::<f64>() / shown.len().max(1) as f64;
        Errors {
            rms: rms.sqrt(),
            mean,
            p95,
            max,
        }
    }

    fn beams(&self, place: &Place, tier: Tier, without: Option<Aspect>) -> Vec<Beam> {
        let by = if without == Some(Aspect::Areas) {
            Tier::Draft
        } else {
            tier
        };
        let lights = self.lighting.lights.iter().zip(&place.horizons);
        lights
            .flat_map(|(light, horizon)| {
                let casts = tier == Tier::Study && without != Some(Aspect::Shadows);
                let horizon = horizon.filter(|_| casts);
                beams(by, light, place.at)
                    .into_iter()
                    .map(move |beam| Beam {
                        visible: horizon.map_or(1.0, |horizon| {
                            visible_over(horizon, rise_of(beam.incidence.l))
                        }),
                        ..beam
                    })
            })
            .collect()
    }

    fn shown(&self, place: &Place, tier: Tier, without: Option<Aspect>) -> DVec3 {
        let light = Illumination {
            beams: self.beams(place, tier, without),
            ambient: self.lighting.ambient,
            table: self.lighting.light_table,
        };
        let changed = without.and_then(|aspect| place.spot.without(aspect));
        let spot = changed.as_ref().unwrap_or(&place.spot);
        spot.radiance(tier, place.v, &light)
    }

    /// What the judge would find: study, brought to where it was judged.
    fn judged(&self, place: &Place) -> DVec3 {
        let spot = &place.spot;
        let alpha = spot.specimen.surface.alpha;
        let upright = glam::DQuat::from_rotation_arc(spot.normal, DVec3::Z);
        let eye = upright * place.v;
        let only = |light: Illumination| spot.radiance(Tier::Study, place.v, &light);
        let mut radiance = only(Illumination {
            ambient: self.lighting.ambient,
            ..Illumination::default()
        });
        if self.lighting.light_table != DVec3::ZERO {
            let table = only(Illumination {
                table: self.lighting.light_table,
                ..Illumination::default()
            });
            radiance += table * correction::through(eye, alpha, place.share);
        }
        for beam in self.beams(place, Tier::Study, None) {
            let l = upright * beam.incidence.l;
            let light = only(Illumination {
                beams: vec![beam],
                ..Illumination::default()
            });
            if light != DVec3::ZERO {
                radiance += light * correction::reflected(l, eye, alpha, place.share);
            }
        }
        radiance
    }
}

impl Spot {
    /// The spot with something left out of it; `None` where nothing of it changes.
    fn without(&self, aspect: Aspect) -> Option<Self> {
        let mut spot = self.clone();
        match aspect {
            Aspect::Shadows | Aspect::Areas => return None,
            Aspect::SingleScatter => {
                spot.specimen.study.split.kappa = DVec3::ZERO;
                // What enters at a slant goes on being sent back sooner.
                spot.specimen.study.split.at_capture = DVec3::ONE;
            }
            Aspect::Coupling => {
                // What the surface lets in and out is then what it does in the photograph.
                let interface = &mut spot.specimen.interface;
                let captured = interface.mean_at(spot.specimen.surface.alpha).capture;
                interface.t = Default::default();
                interface.t[0][0] = 1.0 / captured.sqrt();
            }
            Aspect::Particles => {
                spot.specimen.cover.particles = 0.0;
                spot.specimen.cover.body = 0.0;
                spot.specimen.cover.grains = DVec3::ZERO;
            }
            Aspect::Film => spot.specimen.cover.film = 0.0,
            Aspect::ShowThrough => spot.specimen.left = DVec3::ONE,
            Aspect::Relief => {
                spot.normal = DVec3::Z;
                spot.shortening = 1.0;
            }
            Aspect::Gloss => {
                spot.specimen.surface.specular = 0.0;
                let s = &spot.specimen.surface;
                spot.specimen.interface = InterfaceTable::at_roughness(s.alpha, s.eta, 0.0);
            }
        }
        Some(spot)
    }
}

/// Whether the sheet is taken for flat although it is not.
pub fn is_flattened(drawing: &Drawing) -> bool {
    drawing.surface != Shape::Flat
}
