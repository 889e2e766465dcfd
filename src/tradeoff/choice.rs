//! Which tier serves a scene.

use super::{
    places::{MapFault, Maps},
    scene::{Forecast, Seen},
    table::{Cost, Table},
};
use crate::{
    manifest::exhibit::{Exhibit, Scene},
    needs::{Needs, Terms},
    optics::tier::Tier,
};

/// A prediction may be too low by this factor at a scene that keeps its bound: the bound is kept in
/// 95 of 100 held-out scenes with it.
pub const MARGIN: f64 = 1.25;
/// Tiers that a program may choose by itself: the ladder. Baselines from the literature are never
/// chosen for anybody, however cheap; Lambert's diffuser among them, which costs hardly less than
/// draft and keeps a mean ΔE00 where it loses all gloss.
pub const LADDER: [Tier; 3] = [Tier::Draft, Tier::Gallery, Tier::Study];

/// What each tier costs on some sheet, as ratios to the floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Costs(Vec<(Tier, Cost)>);

impl Costs {
    /// From tiers with their cost.
    pub fn new(costs: impl IntoIterator<Item = (Tier, Cost)>) -> Self {
        Self(costs.into_iter().collect())
    }

    /// Those of the shipped table for a side with these terms.
    pub fn shipped(terms: &Terms) -> Self {
        Self::of(Table::shipped(), terms)
    }

    /// Those of a table.
    pub fn of(table: &Table, terms: &Terms) -> Self {
        let work = work(terms);
        Self::new(
            Tier::ALL
                .into_iter()
                .filter_map(|tier| Some((tier, table.cost(work, tier)?))),
        )
    }

    /// Of one tier.
    pub fn get(&self, tier: Tier) -> Option<Cost> {
        let mut costs = self.0.iter();
        costs.find(|(of, _)| *of == tier).map(|(_, cost)| *cost)
    }
}

/// What is to be expected of every tier of the ladder in a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outlook {
    pub forecasts: Vec<Forecast>,
    pub costs: Costs,
}

impl Outlook {
    /// Of `scene` in a picture of `size` pixels, at the costs of `table`.
    ///
    /// # Errors
    /// [`MapFault`] of the first map that cannot be read.
    pub fn of(
        exhibit: &Exhibit,
        scene: &Scene,
        size: [u32; 2],
        maps: &mut Maps,
        table: &Table,
    ) -> Result<Self, MapFault> {
        let needs = Needs::of(exhibit, scene, Tier::Study, false);
        let side = needs.sides.first();
        Ok(Self {
            forecasts: Seen::new(exhibit, scene, size, maps)?.forecasts(&LADDER),
            costs: side.map_or_else(Costs::default, |side| Costs::of(table, &side.terms)),
        })
    }

    /// See [`at_rest`].
    pub fn at_rest(&self, max_delta_e: f64) -> (Tier, bool) {
        at_rest(&self.forecasts, &self.costs, max_delta_e)
    }

    /// See [`in_motion`].
    pub fn in_motion(&self, wanted: Tier, frame_ms: f64, ms: impl Fn(Tier) -> Option<f64>) -> Tier {
        in_motion(&self.forecasts, wanted, frame_ms, ms)
    }
}

/// The kind of work that a side with these terms makes, as `cost::Sheets` draws it.
pub fn work(terms: &Terms) -> &'static str {
    if terms.transmission {
        "table"
    } else if terms.relief_shadows {
        "relief"
    } else if terms.matter > 0 {
        "particles"
    } else {
        "paper"
    }
}

/// The cheapest tier of the ladder whose predicted mean ΔE00 keeps `max_delta_e`, and whether any
/// does; otherwise the nearest to the judge.
pub fn at_rest(forecasts: &[Forecast], costs: &Costs, max_delta_e: f64) -> (Tier, bool) {
    let ladder = || {
        forecasts
            .iter()
            .filter(|forecast| LADDER.contains(&forecast.tier))
    };
    let price = |tier: Tier| {
        // Where nothing is known of the costs, the ladder's own order stands for them.
        let step = LADDER.iter().position(|of| *of == tier).unwrap_or_default();
        costs.get(tier).map_or(step as f64, |cost| cost.ratio)
    };
    let keeps = ladder()
        .filter(|forecast| forecast.errors.mean * MARGIN <= max_delta_e)
        .min_by(|a, b| price(a.tier).total_cmp(&price(b.tier)));
    match keeps {
        Some(forecast) => (forecast.tier, true),
        None => {
            let nearest = ladder().min_by(|a, b| a.errors.mean.total_cmp(&b.errors.mean));
            (nearest.map_or(Tier::Study, |forecast| forecast.tier), false)
        }
    }
}

/// The tier of the ladder nearest to the judge, of those whose frames are predicted to take
/// `frame_ms` at most and that cost no more than `wanted`; the cheapest where none is so fast.
/// `ms` predicts a frame's time.
pub fn in_motion(
    forecasts: &[Forecast],
    wanted: Tier,
    frame_ms: f64,
    ms: impl Fn(Tier) -> Option<f64>,
) -> Tier {
    let known = || {
        forecasts
            .iter()
            .filter(|forecast| LADDER.contains(&forecast.tier))
            .filter_map(|forecast| Some((forecast, ms(forecast.tier)?)))
    };
    let limit = ms(wanted).unwrap_or(f64::INFINITY);
    let fits = known()
        .filter(|(_, ms)| *ms <= frame_ms && *ms <= limit)
        .min_by(|(a, _), (b, _)| a.errors.mean.total_cmp(&b.errors.mean));
    let cheapest = || known().min_by(|(_, a), (_, b)| a.total_cmp(b));
    fits.or_else(cheapest)
        .map_or(wanted, |(forecast, _)| forecast.tier)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::errors::Errors;

    fn forecasts(means: [f64; 3]) -> Vec<Forecast> {
        LADDER
            .into_iter()
            .zip(means)
            .map(|(tier, mean)| Forecast {
                tier,
                errors: Errors {
                    mean,
                    ..Errors::default()
                },
            })
            .collect()
    }

    fn costs() -> Costs {
        let ratios = [1.2, 1.5, 2.6];
        Costs::new(LADDER.into_iter().zip(ratios).map(|(tier, ratio)| {
            (
                tier,
                Cost {
                    ratio,
                    ns: 10.0 * ratio,
                },
            )
        }))
    }

    #[test]
    fn the_cheapest_tier_that_keeps_the_bound_is_chosen() {
        let forecasts = forecasts([1.5, 0.7, 0.3]);
        let at_rest = |bound| at_rest(&forecasts, &costs(), bound);
        assert_eq!(at_rest(2.0), (Tier::Draft, true));
        assert_eq!(at_rest(1.0), (Tier::Gallery, true));
        assert_eq!(at_rest(0.5), (Tier::Study, true));
        assert_eq!(at_rest(0.1), (Tier::Study, false));
        // The margin: .7 is predicted, and .8 is not enough.
        assert_eq!(at_rest(0.8), (Tier::Study, true));
    }

    #[test]
    fn in_motion_the_nearest_of_the_fast_enough_is_taken() {
        let forecasts = forecasts([1.5, 0.7, 0.3]);
        let costs = costs();
        let ms = |tier| costs.get(tier).map(|cost| cost.ns);
        let in_motion = |wanted, frame_ms| in_motion(&forecasts, wanted, frame_ms, ms);
        assert_eq!(in_motion(Tier::Study, 30.0), Tier::Study);
        assert_eq!(in_motion(Tier::Study, 20.0), Tier::Gallery);
        assert_eq!(in_motion(Tier::Study, 12.5), Tier::Draft);
        assert_eq!(in_motion(Tier::Study, 1.0), Tier::Draft, "the cheapest");
        assert_eq!(
            in_motion(Tier::Gallery, 30.0),
            Tier::Gallery,
            "no dearer than asked for"
        );
    }
}
