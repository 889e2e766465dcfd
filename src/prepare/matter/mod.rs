//! What a side is made of, by its photographs: materials, gloss, depth of ink, and what it passes
//! of light.
//!
//! | step | where |
//! |---|---|
//! | what stereo is told of the surfaces | `surfaces` |
//! | while the photographs run through | [`Gathering`] |
//! | swatches → classes | [`super::materials`] |
//! | roughness of each class | [`super::gloss`] |
//! | depth of each ink | [`super::depth`] |
//! | the sheet on a light table | [`super::transmission`] |
//! | ink solved again, its gloss known | `again` |
//! | lines of a manifest | `lines` |
//! | the report's page | `page` |

mod again;
mod lines;
mod page;
mod surfaces;

use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    PrepareError,
    capture::{Capture, Crop, Shots},
    codes::{encoded, linear},
    colour::correct::Correction,
    depth::{self, InkDepth},
    flat_field::FlatField,
    gloss::{self, Amendment, Roughness, Samples, first::Surfaces},
    materials::{
        self, Known, Materials,
        features::{Gloss, Seen},
        legend::{self, MediaFile},
    },
    model::Model,
    photographs::Band,
    stereo::{Rig, Solved},
    transmission::{self, Transmission},
    write::SideFiles,
};
use crate::{
    manifest::SideName,
    maps::{Level, Pyramid, Texels, bare_albedo},
    optics::medium::{Matter, Medium, MediumId},
};
pub(super) use lines::{drawing_lines, media_lines, paper_line, side_lines};
pub(super) use page::{page, sources};
pub(super) use surfaces::surfaces;

/// The share of grains' or body colour's places, from the darkest, that cover the paper wholly.
const COVERING: f64 = 0.1;
/// Places of a class that its colour is taken from, at most.
const COLOURED: usize = 50_000;

/// What came of a side's materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MatterReport {
    /// What normals and albedo were solved with.
    pub surfaces: Option<Surfaces>,
    /// Linear albedo of the bare paper.
    pub paper_albedo: [f64; 3],
    /// `None` where no swatch names a medium of this side.
    pub materials: Option<Materials>,
    pub files: Vec<MediaFile>,
    /// Linear albedo at full coverage of media that have one, in the order of the classes.
    pub albedo: Vec<Option<[f64; 3]>>,
    /// Of each class; of bare paper alone where there are no swatches.
    pub roughness: Vec<Roughness>,
    pub inks: Vec<InkDepth>,
    /// τ that is white in the map of depths; 0 where there is none.
    pub depth_white: f64,
    /// Of the recto, where there is a photograph in transmitted light.
    pub transmission: Option<Transmission>,
}

/// What is kept of photographs while they run through.
pub(super) struct Gathering {
    surfaces: Surfaces,
    swatches: Vec<Known>,
    gloss: Gloss,
    samples: Samples,
}

impl Gathering {
    pub fn new(capture: &Capture, side: SideName, shots: &Shots, surfaces: Surfaces) -> Self {
        let crop = shots.crop;
        let within = |rect: Crop| Crop {
            left: rect.left.max(crop.left) - crop.left,
            top: rect.top.max(crop.top) - crop.top,
            right: rect.right.min(crop.right).saturating_sub(crop.left),
            bottom: rect.bottom.min(crop.bottom).saturating_sub(crop.top),
        };
        let own = capture.swatches.iter().filter(|swatch| swatch.side == side);
        let swatches: Vec<Known> = own
            .map(|swatch| Known {
                medium: swatch.medium,
                rect: within(swatch.rect),
            })
            .filter(|known| {
                known.rect.left < known.rect.right && known.rect.top < known.rect.bottom
            })
            .collect();
        let size = [crop.width(), crop.height()];
        Self {
            surfaces,
            gloss: Gloss::default(),
            samples: Samples::new(size, shots.photographs.len(), &swatches),
            swatches,
        }
    }

    /// Reads a band whose light was divided out, and what it was solved to, before its colours
    /// are corrected.
    pub fn add(&mut self, band: &Band, solved: &Solved, rig: &Rig) {
        // Without media nobody asks for it.
        if self.swatches.iter().any(|swatch| swatch.medium.is_some()) {
            self.gloss.add(band, solved, rig);
        }
        self.samples.add(band);
    }

    /// Finds out what the side is made of, puts its sRGB-encoded albedo and its normals right where
    /// a surface is not paper's, and writes its maps.
    ///
    /// # Errors
    /// Where a photograph in transmitted light cannot be used, or a map cannot be written.
    pub fn finish(
        self,
        bench: &Bench<'_>,
        albedo: &mut [[u16; 3]],
        normals: &mut [[f32; 3]],
        maps: &SideFiles<'_>,
        scratch: &Path,
    ) -> Result<MatterReport, PrepareError> {
        let Self {
            surfaces,
            swatches,
            gloss,
            samples,
        } = self;
        let size = maps.size();
        let seen = Seen {
            width: size[0],
            albedo,
            normals,
            gloss: &gloss,
        };
        let mut classified = materials::classify(&seen, &swatches);
        // In pixels of the photographs, as the capture file has them.
        for told in classified.iter_mut().flat_map(|(_, of)| &mut of.swatches) {
            let (rect, crop) = (&mut told.swatch.rect, bench.shots.crop);
            for x in [&mut rect.left, &mut rect.right] {
                *x += crop.left;
            }
            for y in [&mut rect.top, &mut rect.bottom] {
                *y += crop.top;
            }
        }
        drop(gloss);
        let (classes, materials) = match classified {
            Some((classes, materials)) => (classes, Some(materials)),
            None => (vec![0; albedo.len()], None),
        };
        let names = match &materials {
            Some(materials) => materials.media.clone(),
            None => vec![None],
        };
        let mut report = MatterReport::default();
        let lit;
        let of_fit: &[u8] = match &materials {
            Some(_) => &classes,
            None => {
                lit = only_light(albedo);
                &lit
            }
        };
        let mut side = Sheet {
            bench,
            albedo,
            normals,
            classes: of_fit,
            samples: &samples,
            told: materials.is_some(),
            size,
        };
        let (mut model, mut media) = side.measure(&mut report, &names, false);
        // Without media nothing would be found anew.
        if let (Some(first), Some(_)) = (&model, &materials) {
            side.solve_again(first, &media, surfaces.paper.alpha, scratch)?;
            (model, media) = side.measure(&mut report, &names, true);
        }
        report.surfaces = Some(surfaces);
        drop(samples);
        let Some(model) = model else {
            return Ok(report);
        };
        if let Some(materials) = &materials {
            let depths = depth::depths(&model, &media, &names, &classes, albedo);
            report.files = legend::files(&materials.media);
            maps.media(&report.files, &classes)?;
            maps.depth(&depths)?;
            (report.inks, report.depth_white) = (depths.inks, depths.white);
        }
        if bench.side == SideName::Recto {
            // Without media what is dark is taken for ink, as a renderer does.
            let ink = "iron-gall-ink".parse::<MediumId>().ok();
            let unknown = [ink.map(|id| *id.medium())];
            let side = transmission::Side {
                shots: bench.shots,
                albedo,
                classes: &classes,
                media: if materials.is_some() {
                    &media
                } else {
                    &unknown
                },
            };
            let found = transmission::transmission(bench.capture, &side, &model, scratch)?;
            if let Some((map, told)) = found {
                maps.transmission(&map)?;
                report.transmission = Some(told);
            }
        }
        report.materials = materials;
        Ok(report)
    }
}

/// What is known of a side once its photographs have run through.
#[derive(Clone, Copy)]
pub(super) struct Bench<'b> {
    pub capture: &'b Capture,
    pub side: SideName,
    pub shots: &'b Shots,
    pub rig: &'b Rig,
    pub correction: Option<&'b Correction>,
    /// What albedo was multiplied with.
    pub exposure: f64,
    pub fields: &'b [FlatField],
}

impl Bench<'_> {
    /// A photograph's colour, its light divided out, as the albedo's.
    fn colour(&self, rgb: [f32; 3]) -> DVec3 {
        let rgb = rgb.map(f64::from);
        let rgb = match self.correction {
            Some(correction) => correction.apply(rgb),
            None => rgb,
        };
        DVec3::from(rgb) * self.exposure
    }
}

/// A side whose classes are known.
struct Sheet<'s, 'b> {
    bench: &'s Bench<'b>,
    albedo: &'s mut [[u16; 3]],
    normals: &'s mut [[f32; 3]],
    classes: &'s [u8],
    samples: &'s Samples,
    /// Whether swatches tell paper from media.
    told: bool,
    /// In pixels.
    size: [usize; 2],
}

impl Sheet<'_, '_> {
    /// Colour and roughness of the paper first, which all else lies on, and then of each medium.
    /// `amends`: whether albedo is put right by it.
    fn measure(
        &mut self,
        report: &mut MatterReport,
        names: &[Option<MediumId>],
        amends: bool,
    ) -> (Option<Model>, Vec<Option<Medium>>) {
        let mut media: Vec<Option<Medium>> = names
            .iter()
            .map(|name| name.map(|id| *id.medium()))
            .collect();
        // Without media the paper is where the sheet is light, as a renderer takes it.
        let paper = |side: &Self| {
            let found = if side.told { side.colour(0, 1.0) } else { None };
            found.unwrap_or_else(|| DVec3::from(light(side.albedo, side.size)))
        };
        report.roughness.clear();
        report.albedo = vec![None; names.len()];
        let Some(mut model) = Model::laid(paper(self)) else {
            return (None, media);
        };
        for class in 0..names.len() {
            self.set_colour(class, &mut media);
            let (found, amendment) = self.fit(&model, names[class], media[class].as_ref(), class);
            // Where light and dark are all that is known, a step between them would be seen.
            if let Some(amendment) = amendment.filter(|_| amends) {
                self.amend(class, &amendment);
            }
            report.albedo[class] = self.set_colour(class, &mut media);
            let alpha = found.within.map(|_| found.alpha);
            match &mut media[class] {
                None => {
                    let albedo = paper(self).to_array();
                    model = model.with(|paper| {
                        paper.albedo = albedo;
                        paper.roughness = alpha.unwrap_or(paper.roughness);
                    });
                    report.paper_albedo = albedo;
                }
                Some(medium) => set_roughness(medium, alpha),
            }
            report.roughness.push(found);
        }
        (Some(model), media)
    }

    /// Solves films and body colours again whose surface differs from that of paper, which stereo
    /// took for one of this roughness.
    fn solve_again(
        &mut self,
        model: &Model,
        media: &[Option<Medium>],
        paper: f64,
        scratch: &Path,
    ) -> Result<(), PrepareError> {
        /// Nearer to each other, roughnesses turn no normal by a degree.
        const ALIKE: f64 = 0.05;
        let glossy = media.iter().map(|medium| {
            let of = medium.filter(|m| matches!(m.matter, Matter::Film(_) | Matter::Body(_)));
            of.filter(|medium| (medium.roughness() - paper).abs() > ALIKE)
        });
        let glossy: Vec<Option<Medium>> = glossy.collect();
        let maps = again::Maps {
            albedo: self.albedo,
            normals: self.normals,
        };
        again::solve(self.bench, scratch, model, &glossy, self.classes, maps)
    }

    fn fit(
        &self,
        model: &Model,
        name: Option<MediumId>,
        medium: Option<&Medium>,
        class: usize,
    ) -> (Roughness, Option<Amendment>) {
        let sheet = gloss::Sheet {
            classes: self.classes,
            normals: self.normals,
            albedo: &|i| linear(self.albedo[i]),
            colour: &|rgb| self.bench.colour(rgb),
        };
        let places = self.samples.of_class(class as u8, &sheet);
        gloss::fit(model, name, medium, &places, self.bench.rig)
    }

    fn amend(&mut self, class: usize, amendment: &Amendment) {
        let places = self.albedo.par_iter_mut().zip(self.classes);
        let places = places.zip(&*self.normals);
        places.for_each(|((rgb, of), normal)| {
            if usize::from(*of) == class {
                let normal = DVec3::from(normal.map(f64::from));
                *rgb = encoded(amendment.apply(linear(*rgb), normal));
            }
        });
    }

    /// Sets the colour of grains and body colour at full coverage, and gives it.
    fn set_colour(&self, class: usize, media: &mut [Option<Medium>]) -> Option<[f64; 3]> {
        let (albedo, share) = match &mut media[class].as_mut()?.matter {
            Matter::Particles(particles) => (&mut particles.albedo, COVERING),
            Matter::Body(body) => (&mut body.albedo, 1.0),
            _ => return None,
        };
        *albedo = self.colour(class, share)?.to_array();
        Some(*albedo)
    }

    /// Mean colour of a class's places between their quartiles of light, among the share `darkest`
    /// of them; `None` where it has none.
    fn colour(&self, class: usize, darkest: f64) -> Option<DVec3> {
        let own = (0..self.classes.len()).filter(|i| usize::from(self.classes[*i]) == class);
        let count = own.clone().count();
        let step = (count / COLOURED).max(1) | 1;
        let mut found: Vec<DVec3> = own.step_by(step).map(|i| linear(self.albedo[i])).collect();
        found.sort_by(|a, b| a.element_sum().total_cmp(&b.element_sum()));
        found.truncate(((found.len() as f64 * darkest).ceil() as usize).max(1));
        let middle = found.get(found.len() / 4..(3 * found.len()).div_ceil(4))?;
        let sum: DVec3 = middle.iter().sum();
        (!middle.is_empty()).then(|| sum / middle.len() as f64)
    }
}

fn set_roughness(medium: &mut Medium, alpha: Option<f64>) {
    let of = match &mut medium.matter {
        Matter::Film(film) => &mut film.roughness,
        Matter::Body(body) => &mut body.roughness,
        Matter::Particles(particles) => &mut particles.roughness,
        Matter::Paper(_) | Matter::Relief => return,
    };
    *of = alpha.unwrap_or(*of);
}

/// Linear albedo of the sheet where it is light, as `maps::bare_albedo` takes it.
fn light(albedo: &[[u16; 3]], [width, height]: [usize; 2]) -> [f64; 3] {
    // Its coarse level, by the nearest pixels.
    let step = width.max(height).div_ceil(512).max(1);
    let rows = (0..height).step_by(step);
    let texels: Vec<u16> = rows
        .flat_map(|y| (0..width).step_by(step).map(move |x| y * width + x))
        .flat_map(|i| linear(albedo[i]).to_array().map(|v| (v * 65535.0) as u16))
        .collect();
    bare_albedo(&Pyramid {
        channels: 3,
        levels: vec![Level {
            width: width.div_ceil(step) as u32,
            height: height.div_ceil(step) as u32,
            texels: Texels::Unorm16(texels),
        }],
        missing: 0,
    })
}

/// 0 where the sheet is lighter than its median, and 1 elsewhere.
fn only_light(albedo: &[[u16; 3]]) -> Vec<u8> {
    let light = |rgb: &[u16; 3]| u32::from(rgb[0]) + 2 * u32::from(rgb[1]) + u32::from(rgb[2]);
    let step = (albedo.len() / COLOURED).max(1) | 1;
    let mut sampled: Vec<u32> = albedo.iter().step_by(step).map(light).collect();
    let middle = sampled.len() / 2;
    let median = match sampled.is_empty() {
        true => 0,
        false => *sampled.select_nth_unstable(middle).1,
    };
    albedo
        .par_iter()
        .map(|rgb| u8::from(light(rgb) < median))
        .collect()
}
