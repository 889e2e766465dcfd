//! What each tier would show of a scene, without rendering it: the sheet that is seen is sampled at
//! a few hundred places, and each tier's f64 twin is compared with what the judge would find there.

use std::{
    collections::{HashMap, hash_map::Entry},
    path::PathBuf,
    sync::Arc,
};

use glam::{DVec2, DVec3};

use super::{
    correction,
    errors::{Errors, displayed, summary},
};
use crate::{
    colour::delta_e00,
    manifest::{
        exhibit::{Drawing, Exhibit, Scene, Surface as Shape},
        eye::Eye,
        frames::side_from_table,
        lighting::Lighting,
    },
    maps::{self, Coding, MapError, Pyramid},
    needs::{MapUse, Needs, SideNeeds},
    optics::{
        bsdf::Specimen,
        lamp::Light,
        matter::{Cover, Media, Particle},
        microfacet::ALPHA_MIN,
        refraction::PathTable,
        relief::{Horizon, mean_length, rise_of, visible_over, widened},
        shade::{Beam, Behind, Illumination, Spot, beams},
        slab::{Phase, Slab, UM_PER_MM},
        study::Study,
        table::InterfaceTable,
        tier::{Surface, Tier, albedo_of},
    },
};

/// Places along the picture's width and height; a sheet that fills half of it has half of them.
const PLACES: [u32; 2] = [24, 18];
/// A picture of this width is meant where none is named.
pub const WIDTH_PX: u32 = 1920;
/// A place that is less sheet than this belongs to the table.
const SHEET: f64 = 0.5;
/// Albedo of a side without a picture, as the stage shows it.
const BARE_PAPER: DVec3 = DVec3::new(0.72, 0.67, 0.57);

/// A map that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{error}")]
pub struct MapFault {
    pub path: PathBuf,
    pub error: MapError,
}

/// Decoded maps, each read once.
#[derive(Default)]
pub struct Maps(HashMap<String, Pyramid>);

impl Maps {
    fn load(&mut self, map: &MapUse) -> Result<(), MapFault> {
        if let Entry::Vacant(place) = self.0.entry(key(map)) {
            let pyramid = map.load().map_err(|error| MapFault {
                path: map.file().path.clone(),
                error,
            })?;
            place.insert(pyramid);
        }
        Ok(())
    }

    fn get(&self, map: &MapUse) -> Option<&Pyramid> {
        self.0.get(&key(map))
    }
}

/// The same pixels for the same use, wherever they lie on the sheet.
fn key(map: &MapUse) -> String {
    let role = match map {
        // Both are pictures of a side.
        MapUse::OtherAlbedo(colour) => return key(&MapUse::Albedo(colour.clone())),
        map => map.role(),
    };
    format!("{role} {}", map.file().path.display())
}

/// What a tier is predicted to do with a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub tier: Tier,
    /// Against the judge, over the sheet that is seen.
    pub errors: Errors,
}

/// What a picture loses without a part of the model: ΔE00 between study with and without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worth {
    pub aspect: Aspect,
    pub mean: f64,
    pub p95: f64,
}

/// A scene's sheet at the places that are looked at.
pub struct Sampled {
    places: Vec<Place>,
    lighting: Lighting,
    level: f64,
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
}

impl Aspect {
    pub const ALL: [Self; 8] = [
        Self::Relief,
        Self::Shadows,
        Self::Areas,
        Self::Film,
        Self::SingleScatter,
        Self::Particles,
        Self::Gloss,
        Self::Coupling,
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
        }
    }

    /// Whether `tier` has it, where the scene's maps do.
    pub fn is_in(self, tier: Tier) -> bool {
        match self {
            Self::Relief => true,
            Self::Shadows | Self::Film | Self::SingleScatter | Self::Particles => {
                tier == Tier::Study
            }
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
        let places = self.places.iter();
        places
            .map(|place| self.shown(place, tier, None) * self.level)
            .collect()
    }

    /// How many places of the sheet are seen.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Every tier against the judge.
    pub fn forecasts(&self) -> Vec<Forecast> {
        let truth: Vec<DVec3> = self.places.iter().map(|place| self.judged(place)).collect();
        Tier::ALL
            .into_iter()
            .map(|tier| {
                let shown = self
                    .places
                    .iter()
                    .map(|place| self.shown(place, tier, None));
                Forecast {
                    tier,
                    errors: self.errors(&shown.collect::<Vec<_>>(), &truth),
                }
            })
            .collect()
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
        let places = self.places.iter();
        places
            .map(|place| self.shown(place, Tier::Study, without))
            .collect()
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

/// A side with its maps.
struct Sheet<'m> {
    drawing: &'m Drawing,
    maps: Vec<(&'m MapUse, &'m Pyramid)>,
    study: Study,
    media: Media,
    interface: InterfaceTable,
    bare: DVec3,
    other_bare: DVec3,
    specular: f64,
    coding: Option<Coding>,
    /// One over the mean of the transmission map.
    clear_scale: f64,
}

impl<'m> Sheet<'m> {
    fn new(drawing: &'m Drawing, side: &'m SideNeeds, maps: &'m Maps) -> Self {
        let paper = &drawing.paper;
        let held: Vec<(&MapUse, &Pyramid)> = side
            .maps
            .iter()
            .filter_map(|map| Some((map, maps.get(map)?)))
            .collect();
        let mut bare = [BARE_PAPER; 2];
        let (mut coding, mut clear_scale) = (None, 1.0);
        for (map, pyramid) in &held {
            match map {
                MapUse::Albedo(_) => bare[0] = maps::bare_albedo(pyramid).into(),
                MapUse::OtherAlbedo(_) => bare[1] = maps::bare_albedo(pyramid).into(),
                MapUse::Normal(_) | MapUse::NormalFromHeight(..) => {
                    coding = pyramid
                        .levels
                        .first()
                        .map(|l| maps::normal_coding(&l.texels));
                }
                MapUse::Transmission(_) => clear_scale = 1.0 / maps::mean_of(pyramid).max(1e-3),
                _ => {}
            }
        }
        let [bare, other_bare] = bare.map(|picture| paper.albedo.map_or(picture, DVec3::from));
        let specular = if side.terms.specular {
            paper.specular
        } else {
            0.0
        };
        let surface = Surface::new(bare, paper.roughness, paper.index, specular);
        let here = InterfaceTable::at_roughness(paper.roughness, paper.index, paper.specular);
        let slab = Slab {
            scattering: paper.scattering_per_mm,
            absorption: 0.0,
            thickness: paper.thickness.0 / UM_PER_MM,
            phase: Phase {
                forward_share: paper.forward_share,
                g_forward: paper.g_forward,
                g_backward: paper.g_backward,
            },
        };
        let varies = side.terms.roughness_map || side.terms.normal_map;
        let paths = if varies {
            PathTable::new(paper.index)
        } else {
            Arc::new(PathTable::at_roughness(paper.roughness, paper.index))
        };
        let mean = here.mean_at(paper.roughness);
        let study = Study::new(&surface, &here, paths, slab);
        let media = Media::new(&side.media, &surface, &mean, &study);
        let interface = if varies {
            InterfaceTable::new(paper.index, paper.specular)
        } else {
            here
        };
        Self {
            drawing,
            maps: held,
            study,
            media,
            interface,
            bare,
            other_bare,
            specular,
            coding,
            clear_scale,
        }
    }

    fn find(&self, wanted: impl Fn(&MapUse) -> bool) -> Option<(&MapUse, &Pyramid)> {
        let mut maps = self.maps.iter();
        maps.find(|(map, _)| wanted(map)).copied()
    }

    /// A map's texel at a place of the side, averaged over `width` mm.
    fn read(&self, (map, pyramid): (&MapUse, &Pyramid), on_side: DVec2, width: f64) -> [f64; 4] {
        let file = map.file();
        let texel = file.extent_mm().x / f64::from(file.size[0].max(1));
        let level = (width / texel).max(1.0).log2();
        sample(pyramid, file.uv_from_side.transform_point2(on_side), level)
    }

    fn coverage(&self, on_side: DVec2, width: f64) -> f64 {
        self.find(|map| matches!(map, MapUse::Outline(_)))
            .map_or(1.0, |map| self.read(map, on_side, width)[0])
    }

    /// The spot at a place, and its photographed share of the bare paper's albedo.
    fn spot(&self, on_side: DVec2, width: f64) -> (Spot, DVec3) {
        let paper = &self.drawing.paper;
        let colour = |wanted: &dyn Fn(&MapUse) -> bool| {
            let [r, g, b, _] = self.read(self.find(wanted)?, on_side, width);
            Some(DVec3::new(r, g, b))
        };
        let albedo = colour(&|map| matches!(map, MapUse::Albedo(_))).unwrap_or(BARE_PAPER);
        let mut alpha = self
            .find(|map| matches!(map, MapUse::Roughness(_) | MapUse::RoughnessOfMatter(..)))
            .map_or(paper.roughness, |map| self.read(map, on_side, width)[0]);
        let mut normal = DVec3::Z;
        let mut shortening = 1.0;
        let of_normals =
            self.find(|map| matches!(map, MapUse::Normal(_) | MapUse::NormalFromHeight(..)));
        if let (Some(map), Some(coding)) = (of_normals, self.coding) {
            let mean = self.normal(map, coding, on_side, width);
            shortening = mean_length(mean);
            normal = mean.normalize_or(DVec3::Z);
            alpha = widened(alpha.max(ALPHA_MIN), shortening);
        }
        let other = colour(&|map| matches!(map, MapUse::OtherAlbedo(_))).unwrap_or(self.other_bare);
        let clear = self
            .find(|map| matches!(map, MapUse::Transmission(_)))
            .map_or(1.0, |map| {
                self.read(map, on_side, width)[0] * self.clear_scale
            });
        let surface = Surface::new(albedo, alpha, paper.index, self.specular);
        let mean = self.interface.mean_at(surface.alpha);
        let share = albedo_of(&surface, &mean) / self.study.bare;
        let (cover, particle) = self.cover(on_side, width);
        let spot = Spot {
            specimen: Specimen {
                surface,
                interface: self.interface.clone(),
                study: self.study.clone(),
                cover,
                particle,
                body_albedo: self.media.body_albedo,
                body_through: self.media.body_through,
            },
            normal,
            shortening,
            behind: Behind {
                bare: self.bare,
                other,
                other_bare: self.other_bare,
                clear,
            },
        };
        (spot, share)
    }

    /// What lies on a spot, and the sort of particles of which there is most: all of them are
    /// taken for it.
    fn cover(&self, on_side: DVec2, width: f64) -> (Cover, Particle) {
        let mut cover = Cover::default();
        let mut particle = Particle {
            alpha: 1.0,
            ..Particle::default()
        };
        let Some(matter) = self.find(|map| matches!(map, MapUse::Matter(_))) else {
            // Without a map of media, what is darker than the paper is ink.
            cover.film = 1.0;
            return (cover, particle);
        };
        let [film, body, p_0, p_1] = self.read(matter, on_side, width);
        let more = self.find(|map| matches!(map, MapUse::MatterMore(_)));
        let [p_2, p_3, p_4, p_5] = more.map_or([0.0; 4], |map| self.read(map, on_side, width));
        let coverages = [p_0, p_1, p_2, p_3, p_4, p_5];
        let mut most = 0.0;
        for (of, covered) in self.media.particles.iter().zip(coverages) {
            cover.particles += covered;
            cover.grains += of.albedo * covered;
            if covered > most {
                (most, particle) = (covered, *of);
            }
        }
        cover.body = body;
        let open = (1.0 - body - cover.particles).max(1e-4);
        cover.film = (film / open).clamp(0.0, 1.0);
        (cover, particle)
    }

    /// The mean normal, in the local frame.
    fn normal(
        &self,
        map: (&MapUse, &Pyramid),
        coding: Coding,
        on_side: DVec2,
        width: f64,
    ) -> DVec3 {
        let [x, y, z, _] = self
            .read(map, on_side, width)
            .map(|stored| coding.scale * stored + coding.offset);
        // Directions on the side that the picture's axes point to; the local frame's y runs up.
        let side_from_uv = map.0.file().uv_from_side.matrix2.inverse();
        let right = side_from_uv.x_axis.normalize_or(DVec2::X);
        let up = -side_from_uv.y_axis.normalize_or(DVec2::Y);
        let on_side = right * x + up * y;
        DVec3::new(on_side.x, -on_side.y, z)
    }

    fn heights(&self) -> Option<((&MapUse, &Pyramid), [f64; 2])> {
        let map = self.find(|map| matches!(map, MapUse::Height(_)))?;
        let MapUse::Height(height) = map.0 else {
            return None;
        };
        Some((map, height.range_um.map(|um| um / UM_PER_MM)))
    }

    /// The horizon towards the middle of a lamp, where the relief has heights.
    fn horizon(&self, light: &Light, at: DVec3, on_side: DVec2, footprint: f64) -> Option<Horizon> {
        let (map, [low, high]) = self.heights()?;
        let file = map.0.file();
        let texel = file.extent_mm().x / f64::from(file.size[0].max(1));
        let to_lamp = beams(Tier::Draft, light, at).first()?.incidence.l;
        let rises = beams(Tier::Study, light, at);
        let lowest = rises
            .iter()
            .map(|beam| rise_of(beam.incidence.l))
            .fold(f64::INFINITY, f64::min);
        // The side frame's y runs down.
        let towards = DVec2::new(to_lamp.x, -to_lamp.y).normalize_or(DVec2::X);
        let height = |t: f64, width: f64| {
            low + (high - low) * self.read(map, on_side + towards * t, width)[0]
        };
        let width = texel.max(footprint);
        Some(Horizon::marched(lowest, width, low.max(high), height))
    }
}

/// A texel at texture coordinates, repeating nothing: linear within a level and between levels.
fn sample(pyramid: &Pyramid, uv: DVec2, level: f64) -> [f64; 4] {
    let last = pyramid.levels.len().saturating_sub(1);
    let level = level.clamp(0.0, last as f64);
    let near = in_level(pyramid, level as usize, uv);
    let part = level.fract();
    if part == 0.0 {
        return near;
    }
    let far = in_level(pyramid, (level as usize + 1).min(last), uv);
    std::array::from_fn(|c| near[c] + (far[c] - near[c]) * part)
}

fn in_level(pyramid: &Pyramid, level: usize, uv: DVec2) -> [f64; 4] {
    let Some(level) = pyramid.levels.get(level) else {
        return [0.0; 4];
    };
    let size = [level.width, level.height].map(|side| side.max(1) as usize);
    let channels = usize::from(pyramid.channels);
    let texel = |x: usize, y: usize, c: usize| {
        let at = (y * size[0] + x) * channels + c.min(channels - 1);
        f64::from(level.texels.get(at).unwrap_or_default())
    };
    let place = |u: f64, side: usize| {
        let at = (u * side as f64 - 0.5).clamp(0.0, (side - 1) as f64);
        (at as usize, (at as usize + 1).min(side - 1), at.fract())
    };
    let (x_0, x_1, s) = place(uv.x, size[0]);
    let (y_0, y_1, t) = place(uv.y, size[1]);
    std::array::from_fn(|c| {
        let top = texel(x_0, y_0, c) * (1.0 - s) + texel(x_1, y_0, c) * s;
        let bottom = texel(x_0, y_1, c) * (1.0 - s) + texel(x_1, y_1, c) * s;
        top * (1.0 - t) + bottom * t
    })
}

/// Whether the sheet is taken for flat although it is not.
pub fn is_flattened(drawing: &Drawing) -> bool {
    drawing.surface != Shape::Flat
}
