//! A side of a drawing as its maps describe it, decoded, and what its spots are made of.

use glam::{DVec2, DVec3};

use super::{
    PictureError,
    field::Field,
    media::{self, Media},
    relief::Relief,
    shape::Shape,
    through::Thinner,
    tone::{Tone, Tones},
};
use crate::{
    manifest::{
        exhibit::{BARE_PAPER, Drawing, Exhibit, Over, Paper, Scene, SideName, Surface},
        surface::SideSurface,
    },
    maps::{self, Coding, normal_coding},
    optics::medium::BodyConstants,
    reference::{
        phase::Phase,
        rng::{Rng, uniform},
        walk::{Absorption, Layers},
    },
};

/// Micrometres in a millimetre.
const UM_PER_MM: f64 = 1000.0;

/// What lies over a side.
struct Overlay {
    field: Field,
    opacity: f64,
    /// Lit as paper is; otherwise a sign.
    is_lit: bool,
}

/// What lies on the other side, for light from behind.
struct Behind {
    albedo: Field,
    /// From its photograph to that of ink on this side's paper.
    scale: [f64; 3],
    media: Option<Media>,
}

/// A transmission map, and the thickness it stands for.
type Uneven = (Field, Thinner);

/// Optical depth of a grain: nothing passes.
const OPAQUE: f64 = 1e3;

pub(super) struct Sheet {
    pub shape: Shape,
    pub relief: Option<Relief>,
    layers: Layers,
    tones: Tones,
    albedo: Option<Field>,
    bare: [f64; 3],
    normal: Option<(Field, Coding)>,
    roughness: Option<Field>,
    outline: Option<Field>,
    overlays: Vec<Overlay>,
    media: Option<Media>,
    /// The slab of a body colour, and what it absorbs.
    body: Option<(Layers, Tones)>,
    behind: Option<Behind>,
    /// The other side's ink is in the light from before too: this side's picture holds none of it.
    shows_through: bool,
    thinner: Option<Uneven>,
}

/// What one path finds at a spot.
pub(super) enum Spot {
    /// Fibres between two films.
    Layered {
        layers: Layers,
        /// Of light from before the sheet, and from behind it.
        before: [Absorption; 3],
        behind: [Absorption; 3],
    },
    Grain(media::Grain),
}

impl Sheet {
    /// Loads what `scene` shows. `paths` walks calibrate each roughness.
    pub fn load(
        exhibit: &Exhibit,
        scene: &Scene,
        paths: u64,
        seed: u64,
    ) -> Result<Self, PictureError> {
        let drawing = exhibit.drawing_of(scene);
        let paper = &drawing.paper;
        let layers = layers_of(paper);
        layers.check()?;
        let side = drawing.side_in_state(scene.side, scene.state);
        let side = side.as_ref();
        let mut bare = paper.albedo.unwrap_or(BARE_PAPER);
        let albedo = match side {
            Some(side) => {
                let map = &side.albedo;
                let pyramid = maps::load_colour(&map.file, map.encoding)?;
                if paper.albedo.is_none() {
                    bare = maps::bare_albedo(&pyramid);
                }
                Field::new(pyramid, map.file.uv_from_side)
            }
            None => None,
        };
        let media = match side {
            Some(side) => Media::load(exhibit, &side.media, paths, seed)?,
            None => None,
        };
        let roughness = match side {
            Some(side) => media::roughness(exhibit, side, paper.roughness)?,
            None => None,
        };
        let range = roughness
            .as_ref()
            .map_or([paper.roughness; 2], |field| field.range())
            .map(|alpha| alpha.clamp(0.0, 1.0));
        let at = |alpha: f64| Layers {
            alpha: [alpha, paper.roughness],
            ..layers
        };
        let tones = Tones::new(at, paper.roughness, bare, range, paths, seed);
        let body = match media.as_ref().and_then(|media| media.body) {
            Some(body) => {
                let slab = body_slab(&body, &layers);
                slab.check()?;
                let at = |alpha: f64| Layers {
                    alpha: [alpha, paper.roughness],
                    ..slab
                };
                let tones = Tones::new(at, body.roughness, body.albedo, range, paths, seed);
                Some((slab, tones))
            }
            None => None,
        };
        let through = through(exhibit, scene, drawing, &layers, &tones, bare, paths, seed)?;
        let (behind, thinner) = through;
        Ok(Self {
            shape: shape(drawing, scene.side)?,
            relief: relief(side)?,
            normal: normal(side)?,
            outline: outline(drawing, scene.side)?,
            overlays: overlays(drawing, scene)?,
            layers,
            tones,
            albedo,
            bare,
            roughness,
            media,
            body,
            shows_through: behind.is_some() && is_modelled(drawing, scene),
            behind,
            thinner,
        })
    }

    /// Share of a place that is sheet.
    pub fn coverage(&self, place: DVec2) -> f64 {
        self.outline.as_ref().map_or(1.0, |outline| {
            let [coverage] = outline.at(place);
            coverage
        })
    }

    /// Photographed albedo, with what lies over it; and the signs above its light, as
    /// premultiplied colour and alpha.
    pub fn albedo(&self, place: DVec2) -> ([f64; 3], [f64; 4]) {
        let mut albedo = self
            .albedo
            .as_ref()
            .map_or(self.bare, |field| field.at(place));
        let mut sign = [0.0; 4];
        for overlay in &self.overlays {
            let laid: [f64; 4] = overlay.field.within(place);
            let laid = laid.map(|value| value * overlay.opacity);
            let open = 1.0 - laid[3];
            for c in 0..3 {
                if overlay.is_lit {
                    albedo[c] = albedo[c] * open + laid[c];
                    sign[c] *= open;
                } else {
                    sign[c] = sign[c] * open + laid[c];
                }
            }
            sign[3] *= open;
            if !overlay.is_lit {
                sign[3] += laid[3];
            }
        }
        (albedo, sign)
    }

    /// The relief's unit normal in the frame of the sheet's plane: x right, y up, z out.
    pub fn normal(&self, place: DVec2) -> DVec3 {
        let Some((field, coding)) = &self.normal else {
            return DVec3::Z;
        };
        let stored: [f64; 3] = field.at(place);
        let [x, y, z] = stored.map(|v| (coding.scale * v + coding.offset).max(-1.0));
        let [along, up] = field.axes();
        let flat = along * x + up * y;
        flat.extend(z).try_normalize().unwrap_or(DVec3::Z)
    }

    pub fn alpha(&self, place: DVec2) -> f64 {
        self.roughness.as_ref().map_or(self.layers.alpha[0], |map| {
            let [alpha] = map.at::<1>(place);
            alpha.clamp(0.0, 1.0)
        })
    }

    /// What a path finds at `place`: one of the things that lie there, each as likely as its
    /// share of the place.
    pub fn spot(&self, place: DVec2, albedo: [f64; 3], rng: &mut Rng) -> Spot {
        let alpha = self.alpha(place);
        let Some(media) = &self.media else {
            return self.layered(place, self.tones.film(albedo, alpha), alpha, rng);
        };
        let (bare, floor) = (self.tones.bare(alpha), self.tones.floor(alpha));
        let shares = media.shares(place, albedo, bare, floor);
        let divided = media.divided(&shares, albedo, bare, floor, rng);
        if let Some(grain) = divided.grain {
            return Spot::Grain(grain);
        }
        let choice = uniform(rng) * (1.0 - shares.covered());
        if choice < shares.film {
            return self.layered(place, self.tones.film(divided.paper, alpha), alpha, rng);
        }
        match &self.body {
            Some((slab, tones)) if choice < shares.film + shares.body => {
                let tone = tones.paper(divided.body, alpha);
                let absorption = tone.absorption([0.0; 3]);
                Spot::Layered {
                    layers: Layers {
                        alpha: [alpha, slab.alpha[1]],
                        ..*slab
                    },
                    before: absorption,
                    behind: absorption,
                }
            }
            _ => self.layered(place, self.tones.paper(divided.paper, alpha), alpha, rng),
        }
    }

    fn layered(&self, place: DVec2, tone: Tone, alpha: f64, rng: &mut Rng) -> Spot {
        let mut layers = Layers {
            alpha: [alpha, self.layers.alpha[1]],
            ..self.layers
        };
        if let Some((field, thinner)) = &self.thinner {
            let [clear] = field.at(place);
            layers.thickness_mm *= thinner.thickness(clear);
        }
        let behind = tone.absorption(self.back_tau(place, rng));
        Spot::Layered {
            layers,
            before: if self.shows_through {
                behind
            } else {
                tone.absorption([0.0; 3])
            },
            behind,
        }
    }

    /// Optical depth of the film on the seen side at `place`; a path that crosses there finds it
    /// or bare paper, as likely as their shares.
    pub fn front_tau(&self, place: DVec2, rng: &mut Rng) -> [f64; 3] {
        let (albedo, _) = self.albedo(place);
        let alpha = self.alpha(place);
        let Some(media) = &self.media else {
            return self.tones.film(albedo, alpha).tau;
        };
        let (bare, floor) = (self.tones.bare(alpha), self.tones.floor(alpha));
        let shares = media.shares(place, albedo, bare, floor);
        let open = 1.0 - shares.covered();
        if open <= 0.0 || uniform(rng) * open >= shares.film {
            return [0.0; 3];
        }
        let divided = media.divided(&shares, albedo, bare, floor, rng);
        self.tones.film(divided.paper, alpha).tau
    }

    /// Of what lies on the other side: a film, or a grain that a path finds there as likely as its
    /// share.
    pub fn back_tau(&self, place: DVec2, rng: &mut Rng) -> [f64; 3] {
        let Some(behind) = &self.behind else {
            return [0.0; 3];
        };
        let seen: [f64; 3] = behind.albedo.at(place);
        let mut on_this = std::array::from_fn(|c| seen[c] * behind.scale[c]);
        let alpha = self.layers.alpha[1];
        if let Some(media) = &behind.media {
            let (bare, floor) = (self.tones.bare(alpha), self.tones.floor(alpha));
            let shares = media.shares(place, on_this, bare, floor);
            let divided = media.divided(&shares, on_this, bare, floor, rng);
            if divided.grain.is_some() {
                return [OPAQUE; 3];
            }
            // The paper's own tone is that of this side.
            let open = 1.0 - shares.covered();
            if uniform(rng) * open >= shares.film {
                return [0.0; 3];
            }
            on_this = divided.paper;
        }
        self.tones.film(on_this, alpha).tau
    }
}

impl Tone {
    fn absorption(&self, tau_b: [f64; 3]) -> [Absorption; 3] {
        std::array::from_fn(|c| Absorption {
            sigma_a: self.sigma_a[c],
            tau_f: self.tau[c],
            tau_b: tau_b[c],
        })
    }
}

fn layers_of(paper: &Paper) -> Layers {
    Layers {
        n: paper.index,
        alpha: [paper.roughness; 2],
        sigma_s: paper.scattering_per_mm,
        phase: Phase {
            w_f: paper.forward_share,
            g_f: paper.g_forward,
            g_b: paper.g_backward,
        },
        thickness_mm: paper.thickness.0 / UM_PER_MM,
    }
}

/// A body colour and the paper under it as one slab that scatters as much as both together: dense
/// enough to photograph as white as the colour does, and no darker against the light than they are.
/// Its order is lost: what absorbs is spread evenly over both.
fn body_slab(body: &BodyConstants, paper: &Layers) -> Layers {
    let body_thickness_mm = body.thickness_um / UM_PER_MM;
    let thickness_mm = body_thickness_mm + paper.thickness_mm;
    let reduced = paper.sigma_s * (1.0 - paper.phase.mean_cosine());
    let depth = body.scattering_per_mm * body_thickness_mm + reduced * paper.thickness_mm;
    Layers {
        n: body.index,
        alpha: [body.roughness, paper.alpha[1]],
        sigma_s: depth / thickness_mm,
        phase: Phase::ISOTROPIC,
        thickness_mm,
    }
}

fn shape(drawing: &Drawing, side: SideName) -> Result<Shape, PictureError> {
    if drawing.surface == Surface::Flat {
        return Ok(Shape::flat(drawing.size_mm));
    }
    let recto = SideSurface::load(&drawing.surface, drawing.size_mm)?;
    Ok(Shape::bent(match side {
        SideName::Recto => recto,
        SideName::Verso => recto.other_side(drawing.size_mm, drawing.flip),
    }))
}

type SideMaps = crate::manifest::exhibit::Side;

fn relief(side: Option<&SideMaps>) -> Result<Option<Relief>, PictureError> {
    let Some(map) = side.and_then(|side| side.height.as_ref()) else {
        return Ok(None);
    };
    let heights = maps::load_height(&map.file)?;
    let field = Field::new(heights, map.file.uv_from_side);
    Ok(field.map(|field| Relief::new(field, map.range_um)))
}

fn normal(side: Option<&SideMaps>) -> Result<Option<(Field, Coding)>, PictureError> {
    let Some(side) = side else { return Ok(None) };
    let (pyramid, place) = match (&side.normal, &side.height) {
        (Some(map), _) => {
            let pyramid = maps::load_normal(&map.file, map.y)?;
            (pyramid, map.file.uv_from_side)
        }
        (None, Some(map)) => {
            let extent = map.file.extent_mm();
            let pyramid = maps::load_normal_from_height(&map.file, map.range_um, extent)?;
            (pyramid, map.file.uv_from_side)
        }
        (None, None) => return Ok(None),
    };
    let Some(level) = pyramid.levels.first() else {
        return Ok(None);
    };
    let coding = normal_coding(&level.texels);
    Ok(Field::new(pyramid, place).map(|field| (field, coding)))
}

fn outline(drawing: &Drawing, side: SideName) -> Result<Option<Field>, PictureError> {
    let Some(file) = &drawing.outline else {
        return Ok(None);
    };
    let pyramid = maps::load_outline(&file.path)?;
    let place = file.uv_from_side * drawing.recto_from(side);
    Ok(Field::new(pyramid, place))
}

fn overlays(drawing: &Drawing, scene: &Scene) -> Result<Vec<Overlay>, PictureError> {
    let mut laid = Vec::new();
    for (overlay, opacity) in scene.laid(drawing) {
        if let Some(field) = Field::new(overlay.load()?, overlay.file.uv_from_side) {
            laid.push(Overlay {
                field,
                opacity,
                is_lit: overlay.kind.is_lit(),
            });
        }
    }
    Ok(laid)
}

/// Whether the walk is to find the other side's ink in reflected light: in what was photographed over
/// it, it is already.
fn is_modelled(drawing: &Drawing, scene: &Scene) -> bool {
    drawing.photographed_over(scene.side, scene.state) == Over::Nothing
}

/// What light crosses within: the other side's ink, and paper of uneven thickness. Where nothing
/// shines from behind there is no more than the ink that shows in reflected light.
#[expect(
    clippy::too_many_arguments,
    reason = "parts of a sheet that is not yet put together"
)]
fn through(
    exhibit: &Exhibit,
    scene: &Scene,
    drawing: &Drawing,
    layers: &Layers,
    tones: &Tones,
    bare: [f64; 3],
    paths: u64,
    seed: u64,
) -> Result<(Option<Behind>, Option<Uneven>), PictureError> {
    let is_behind = |&lamp: &usize| {
        exhibit.lamps[lamp]
            .kind
            .elevation_deg()
            .is_none_or(|e| e < 0.0)
    };
    let from_behind = scene.transmitted > 0.0 || scene.lamps.iter().any(is_behind);
    if !from_behind && !is_modelled(drawing, scene) {
        return Ok((None, None));
    }
    let paper = &drawing.paper;
    let other = drawing.side_in_state(scene.side.other(), scene.state);
    let behind = match other {
        Some(side) => {
            let map = &side.albedo;
            let pyramid = maps::load_colour(&map.file, map.encoding)?;
            let of_other = paper.albedo.unwrap_or_else(|| maps::bare_albedo(&pyramid));
            let place = map.file.uv_from_side * drawing.recto_from(SideName::Verso);
            let scale = std::array::from_fn(|c| bare[c] / of_other[c].max(1e-3));
            let mut drawn = side.media.clone();
            for map in &mut drawn {
                map.file.uv_from_side *= drawing.recto_from(SideName::Verso);
            }
            let media = Media::load(exhibit, &drawn, paths, seed)?;
            Field::new(pyramid, place).map(|albedo| Behind {
                albedo,
                scale,
                media,
            })
        }
        None => None,
    };
    let thinner = match &drawing.transmission {
        Some(file) if from_behind => {
            let pyramid = maps::load_height(&file.path)?;
            let mean = maps::mean_of(&pyramid);
            let place = file.uv_from_side * drawing.recto_from(scene.side);
            let [_, sigma_a, _] = tones.bare_sigma_a();
            Field::new(pyramid, place)
                .map(|field| (field, Thinner::new(layers, sigma_a, mean, paths, seed)))
        }
        _ => None,
    };
    Ok((behind, thinner))
}
