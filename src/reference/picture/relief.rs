//! Shadows of the mesostructure: rays cast over the height map.

use glam::DVec2;

use super::field::Field;
use crate::reference::rng::{Rng, uniform};

/// No ray is followed further, in mm: light then falls less than half a degree high on a relief of
/// 400 µm.
const REACH_MAX_MM: f64 = 50.0;
/// Steps over a texel.
const STEPS_PER_TEXEL: f64 = 2.0;
/// Heights above the ray by no more are the rounding of the map's texels, in mm.
const ROUNDING_MM: f64 = 1e-5;

pub(super) struct Relief {
    heights: Field,
    /// Height of black, and how much higher white is, in mm.
    range_mm: [f64; 2],
    top_mm: f64,
    step_mm: f64,
}

impl Relief {
    pub fn new(heights: Field, [low, high]: [f64; 2]) -> Self {
        let range_mm = [low / 1000.0, (high - low) / 1000.0];
        let [least, most] = heights.range();
        let at = |stored: f64| range_mm[0] + range_mm[1] * stored;
        Self {
            top_mm: at(least).max(at(most)),
            step_mm: heights.texel_mm() / STEPS_PER_TEXEL,
            heights,
            range_mm,
        }
    }

    fn height(&self, place: DVec2) -> f64 {
        let [stored] = self.heights.at(place);
        self.range_mm[0] + self.range_mm[1] * stored
    }

    /// Whether light comes to `place` (side frame) along `towards`, a unit vector of the side
    /// frame, from a lamp that rises by `rise` mm per mm.
    pub fn is_lit(&self, place: DVec2, towards: DVec2, rise: f64, rng: &mut Rng) -> bool {
        if rise <= 0.0 {
            return false;
        }
        let here = self.height(place) + ROUNDING_MM;
        let reach = ((self.top_mm - here) / rise).min(REACH_MAX_MM);
        // A start by chance keeps steps from beating with texels.
        let mut t = self.step_mm * (1.0 - 0.5 * uniform(rng));
        while t < reach {
            if self.height(place + towards * t) > here + rise * t {
                return false;
            }
            t += self.step_mm;
        }
        true
    }
}
