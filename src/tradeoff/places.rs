//! What lies at each place of a side, read from its maps as the shader reads them, for the tiers'
//! f64 twins.

use std::{
    collections::{HashMap, hash_map::Entry},
    path::PathBuf,
    sync::Arc,
};

use glam::{DVec2, DVec3};

use crate::{
    manifest::exhibit::Drawing,
    maps::{self, Coding, MapError, Pyramid},
    needs::{MapUse, SideNeeds},
    optics::{
        bsdf::Specimen,
        lamp::Light,
        matter::{Cover, Media, Particle, borne_out, with_borne},
        microfacet::ALPHA_MIN,
        refraction::PathTable,
        relief::{Horizon, mean_length, rise_of, widened},
        shade::{Behind, Spot, beams},
        slab::UM_PER_MM,
        study::Study,
        table::InterfaceTable,
        tier::{Surface, Tier, albedo_of},
    },
};

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
    pub(super) fn load(&mut self, map: &MapUse) -> Result<(), MapFault> {
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
        MapUse::OtherAlbedo(colour) | MapUse::Photographed(colour) => {
            return key(&MapUse::Albedo(colour.clone()));
        }
        map => map.role(),
    };
    if let MapUse::Overlay(overlay) = map {
        return format!("{role} {}", overlay.id);
    }
    let file = map.file();
    // Of one exhibit, what bends a picture is told by where it is kept.
    let warp = file.warp.as_ref().map(std::sync::Arc::as_ptr);
    format!("{role} {} {warp:?}", file.path.display())
}

/// A side with its maps.
pub(super) struct Sheet<'m> {
    drawing: &'m Drawing,
    maps: Vec<(&'m MapUse, &'m Pyramid)>,
    study: Study,
    media: Media,
    interface: InterfaceTable,
    bare: DVec3,
    other_bare: DVec3,
    photographed_bare: DVec3,
    shows_through: bool,
    specular: f64,
    coding: Option<Coding>,
    /// One over the mean of the transmission map.
    clear_scale: f64,
}

impl<'m> Sheet<'m> {
    pub fn new(drawing: &'m Drawing, side: &'m SideNeeds, maps: &'m Maps) -> Self {
        let paper = &drawing.paper;
        let held: Vec<(&MapUse, &Pyramid)> = side
            .maps
            .iter()
            .filter_map(|map| Some((map, maps.get(map)?)))
            .collect();
        let mut bare = [BARE_PAPER; 3];
        let (mut coding, mut clear_scale) = (None, 1.0);
        for (map, pyramid) in &held {
            match map {
                MapUse::Albedo(_) => bare[0] = maps::bare_albedo(pyramid).into(),
                MapUse::OtherAlbedo(_) => bare[1] = maps::bare_albedo(pyramid).into(),
                MapUse::Photographed(_) => bare[2] = maps::bare_albedo(pyramid).into(),
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
        let [bare, other_bare, photographed_bare] =
            bare.map(|picture| paper.albedo.map_or(picture, DVec3::from));
        let specular = if side.terms.specular {
            paper.specular
        } else {
            0.0
        };
        let surface = Surface::new(bare, paper.roughness, paper.index, specular);
        let here = InterfaceTable::at_roughness(paper.roughness, paper.index, paper.specular);
        let varies = side.terms.roughness_map || side.terms.normal_map;
        let paths = if varies {
            PathTable::new(paper.index)
        } else {
            Arc::new(PathTable::at_roughness(paper.roughness, paper.index))
        };
        let mean = here.mean_at(paper.roughness);
        let study = Study::new(&surface, &here, paths, paper.slab());
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
            photographed_bare,
            shows_through: side.terms.show_through,
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

    pub fn coverage(&self, on_side: DVec2, width: f64) -> f64 {
        self.find(|map| matches!(map, MapUse::Outline(_)))
            .map_or(1.0, |map| self.read(map, on_side, width)[0])
    }

    /// The spot at a place, and its photographed share of the bare paper's albedo.
    pub fn spot(&self, on_side: DVec2, width: f64) -> (Spot, DVec3) {
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
        let (bare, body) = (self.study.bare, self.media.body_albedo);
        let borne = borne_out(&surface, &mean, bare, body, &cover);
        let cover = with_borne(&cover, borne);
        let mut specimen = Specimen {
            surface,
            interface: self.interface.clone(),
            study: self.study.clone(),
            cover,
            particle,
            body_albedo: self.media.body_albedo,
            body_through: self.media.body_through,
            left: DVec3::ONE,
        };
        if self.shows_through {
            let diffuse = |albedo: DVec3| albedo_of(&Surface { albedo, ..surface }, &mean);
            let of_bare = |albedo: DVec3, bare: DVec3| {
                diffuse(albedo) / diffuse(bare).max(DVec3::splat(1e-3))
            };
            let before = colour(&|map| matches!(map, MapUse::Photographed(_)));
            let before =
                before.map_or(DVec3::ONE, |albedo| of_bare(albedo, self.photographed_bare));
            specimen.left = specimen.left(of_bare(other, self.other_bare), before);
        }
        let spot = Spot {
            specimen,
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
    pub fn horizon(
        &self,
        light: &Light,
        at: DVec3,
        on_side: DVec2,
        footprint: f64,
    ) -> Option<Horizon> {
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
