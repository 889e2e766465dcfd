//! The lobes of paper that are off by default.

use super::Terms;
use crate::{manifest::exhibit::Paper, optics::tier::Tier};

/// Retro-reflection, sheen and a gloss with a grain, where the paper has them.
pub(super) fn lobes(
    paper: &Paper,
    directional: bool,
    terms: &mut Terms,
    say: &mut impl FnMut(String),
) {
    let study = terms.tier == Tier::Study;
    let glossy = study && terms.specular && directional;
    let mut lobe = |name: &str, strength: f64, shown: bool| -> bool {
        if strength <= 0.0 {
            return false;
        }
        if shown {
            say(format!(
                "{name} of strength {strength}, as the paper has it"
            ));
        } else if study {
            say(format!("no {name}: no directed light is mirrored"));
        } else {
            say(format!("no {name}: only the study tier has it"));
        }
        shown
    };
    terms.retro = lobe("retro-reflection", paper.retro, glossy);
    terms.anisotropic = lobe("anisotropy of the gloss", paper.anisotropy, glossy);
    terms.sheen = lobe("sheen", paper.sheen, study);
}
