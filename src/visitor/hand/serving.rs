//! Tiers: what somebody asked for, and otherwise what is exact enough and comes fast enough.

use super::Hand;
use crate::optics::tier::Tier;

/// Tiers for what is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Serving {
    /// The cheapest that is as exact as the exhibit asks.
    pub at_rest: Tier,
    /// The most exact, up to that one, whose frames come fast enough.
    pub in_motion: Tier,
}

impl Hand {
    /// Nobody asked for a tier: what is served decides, and until then the one of
    /// [`Hand::new`].
    pub fn leave_tier_free(&mut self) {
        self.free = true;
    }

    /// The tier that somebody asked for.
    pub fn wanted(&self) -> Option<Tier> {
        (!self.free).then_some(self.tier)
    }

    /// Tiers for what is shown, as they are predicted; `None` while nothing is known.
    pub fn serve(&mut self, serving: Option<Serving>) {
        self.serving = serving;
    }

    pub(super) fn tier_at_rest(&self) -> Tier {
        match self.serving {
            Some(serving) if self.free => serving.at_rest,
            _ => self.tier,
        }
    }

    /// Something moves and frames come too slowly: the tier that is served in motion, the cheapest
    /// while nothing is known, or again the one at rest. Tiers from the literature are never
    /// replaced.
    pub fn hurry(&mut self, hurried: bool) {
        self.hurried = hurried;
    }

    /// Whether a cheaper tier is good enough just now.
    pub fn is_hurried(&self) -> bool {
        self.hurried && !self.is_led
    }

    /// The tier at rest, which a hurried picture may not have.
    pub fn tier(&self) -> Tier {
        self.tier_at_rest()
    }
}
