//! Where a photograph cannot be given back: what no sheet of its paper photographs as.
//!
//! Lit and seen as it was photographed, a coupled tier shows the photograph, but nothing darker
//! than what the surface itself mirrors, and nothing lighter than a sheet that gives back all
//! light. A photograph that is clipped has lost what was there.

use std::collections::BTreeSet;

use glam::DVec3;

use super::exhibit::{ColourMap, Drawing, Exhibit, RoughnessMap, SideName, SidePatch};
use crate::{
    maps::{self, MapError},
    optics::{
        table::InterfaceTable,
        tier::{Surface, capture_floor},
    },
};

/// In a mask: the photograph is given back.
pub const GIVEN_BACK: u8 = 0;
/// In a mask: a channel is darker than what the surface mirrors.
pub const TOO_DARK: u8 = 128;
/// In a mask: a channel is clipped, or lighter than any sheet.
pub const SATURATED: u8 = 255;

/// Steps of roughness at which the limits are computed.
const STEPS: usize = 1024;
/// Linear light from which a channel counts as clipped: what integers and profiles round 1 to.
const CLIPPED: f32 = 1.0 - 1e-4;

/// A photograph of a side, in one of its states.
#[derive(Clone, Debug, PartialEq)]
pub struct Photograph<'e> {
    pub drawing: &'e Drawing,
    pub side: SideName,
    /// The id of the state that brings the photograph, or its roughness.
    pub state: Option<&'e str>,
    pub albedo: &'e ColourMap,
    roughness: Option<&'e RoughnessMap>,
}

/// What of a photograph is not given back.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    pub size: [u32; 2],
    /// [`GIVEN_BACK`], [`TOO_DARK`] or [`SATURATED`] for each pixel, in rows from the top.
    pub codes: Vec<u8>,
}

impl Mask {
    /// How many pixels have this code.
    pub fn count(&self, code: u8) -> u64 {
        self.codes.iter().filter(|found| **found == code).count() as u64
    }
}

/// The least and the most that a channel can photograph as.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Limits {
    low: f32,
    high: f32,
}

impl Exhibit {
    /// The photographs of all sides and states, each once.
    pub fn photographs(&self) -> Vec<Photograph<'_>> {
        let mut seen = BTreeSet::new();
        let mut all = Vec::new();
        for drawing in &self.drawings {
            for side in [SideName::Recto, SideName::Verso] {
                let (own, patch): (_, fn(&super::exhibit::State) -> &SidePatch) = match side {
                    SideName::Recto => (Some(&drawing.recto), |state| &state.recto),
                    SideName::Verso => (drawing.verso.as_ref(), |state| &state.verso),
                };
                let states = drawing.states.iter().map(|state| {
                    let patch = patch(state);
                    let albedo = patch.albedo.as_ref().or(own.map(|side| &side.albedo));
                    let own = own.and_then(|side| side.roughness.as_ref());
                    let roughness = patch.roughness.as_ref().or(own);
                    (Some(state.id.as_str()), albedo, roughness)
                });
                let sound = own.map(|side| (None, Some(&side.albedo), side.roughness.as_ref()));
                for (state, albedo, roughness) in sound.into_iter().chain(states) {
                    let Some(albedo) = albedo else { continue };
                    let of = roughness.map(|map| &map.file.path);
                    if seen.insert((&drawing.id, side, &albedo.file.path, of)) {
                        all.push(Photograph {
                            drawing,
                            side,
                            state,
                            albedo,
                            roughness,
                        });
                    }
                }
            }
        }
        all
    }
}

impl Photograph<'_> {
    /// A name for its mask, from the ids of drawing, side and state.
    pub fn name(&self) -> String {
        let mut name = format!("{}-{}", self.drawing.id, self.side.word());
        if let Some(state) = self.state {
            name = format!("{name}-{state}");
        }
        name
    }

    /// What is not given back of it. A roughness map of another size than the photograph's is
    /// read at the nearest texel.
    ///
    /// # Errors
    /// As [`maps::load_colour`].
    pub fn mask(&self) -> Result<Mask, MapError> {
        let limits = self.limits();
        let roughness = match self.roughness {
            Some(map) => Some(maps::load_roughness(&map.file, map.gloss)?),
            None => None,
        };
        let level = roughness.as_ref().and_then(|map| map.levels.first());
        let size = self.albedo.file.size;
        let mut codes = Vec::new();
        let each = |y: usize, row: &[[f32; 4]]| {
            codes.extend(row.iter().enumerate().map(|(x, pixel)| {
                let alpha = level.and_then(|level| {
                    let [x, y] = [(x, level.width, size[0]), (y, level.height, size[1])]
                        .map(|(at, of, from)| at * of as usize / from.max(1) as usize);
                    level.texels.get(y * level.width as usize + x)
                });
                let step = alpha.map_or(0, |alpha| {
                    (alpha.clamp(0.0, 1.0) * (STEPS - 1) as f32).round() as usize
                });
                code(
                    &limits[step.min(limits.len() - 1)],
                    [pixel[0], pixel[1], pixel[2]],
                )
            }));
        };
        maps::for_each_colour_row(&self.albedo.file, self.albedo.encoding, each)?;
        Ok(Mask { size, codes })
    }

    /// By roughness, from 0 to 1, or for the paper's own.
    fn limits(&self) -> Vec<Limits> {
        let paper = &self.drawing.paper;
        let (index, specular) = (paper.index, paper.specular);
        let at = |table: &InterfaceTable, alpha: f64| {
            let surface = Surface::new(DVec3::ZERO, alpha, index, specular);
            let mean = table.mean_at(alpha);
            let floor = capture_floor(&surface, &mean);
            Limits {
                low: floor as f32,
                high: (floor + 1.0 / (mean.t_mean * mean.capture)) as f32,
            }
        };
        if self.roughness.is_none() {
            let table = InterfaceTable::at_roughness(paper.roughness, index, specular);
            return vec![at(&table, paper.roughness)];
        }
        let table = InterfaceTable::new(index, specular);
        (0..STEPS)
            .map(|step| at(&table, step as f64 / (STEPS - 1) as f64))
            .collect()
    }
}

fn code(limits: &Limits, rgb: [f32; 3]) -> u8 {
    let most = limits.high.min(CLIPPED);
    // A colour outside sRGB has negative channels, which are kept: not darker, but purer.
    if rgb.iter().any(|value| *value >= most) {
        SATURATED
    } else if rgb.iter().any(|value| (0.0..limits.low).contains(value)) {
        TOO_DARK
    } else {
        GIVEN_BACK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_tell_dark_from_clipped() {
        let limits = Limits {
            low: 0.02,
            high: 0.95,
        };
        for (rgb, expected) in [
            ([0.5, 0.5, 0.5], GIVEN_BACK),
            ([0.02, 0.02, 0.02], GIVEN_BACK),
            ([0.5, 0.019, 0.5], TOO_DARK),
            ([0.0, 0.0, 0.0], TOO_DARK),
            ([-0.1, 0.5, 0.5], GIVEN_BACK),
            ([0.5, 0.96, 0.0], SATURATED),
        ] {
            assert_eq!(code(&limits, rgb), expected, "{rgb:?}");
        }
        let clipped = Limits {
            high: 2.0,
            ..limits
        };
        assert_eq!(code(&clipped, [1.0, 0.5, 0.5]), SATURATED);
        assert_eq!(code(&clipped, [0.999, 0.5, 0.5]), GIVEN_BACK);
    }
}
