//! What `recto check` says of accuracy: what each tier is predicted to err by in a scene, what it
//! costs, and which is the cheapest that keeps what the curator asks for.

use std::fmt::{self, Display};

use serde::Serialize;

use crate::{
    cost, device,
    manifest::{Exhibit, Scene},
    needs::Needs,
    optics::tier::Tier,
    tradeoff::{
        choice::{self, Costs, LADDER, MARGIN},
        places::{MapFault, Maps},
        scene::{Seen, WIDTH_PX, is_flattened},
        table::Table,
    },
};

/// Pictures are taken to have this shape.
const HEIGHT_PX: u32 = 1080;
/// A part of the model that changes less than this in ΔE00 is not worth a word.
const NOTHING: f64 = 0.005;
/// What no tier has.
const NEVER: &str = "light that spreads sideways in the paper (a photograph holds that blur \
                     already) and fluorescence; recto reference can say what the first costs";

/// What tiers cost, and where that is known from.
pub struct Prices {
    table: Table,
    pub words: String,
}

impl Prices {
    /// Of this machine, measured once; the shipped ones where that cannot be.
    pub fn here() -> Self {
        let shipped = |why: String| {
            let table = Table::shipped().clone();
            let words = format!(
                "Costs are the ratios that Recto comes with, measured on {}, {why}.",
                table.device
            );
            Self { table, words }
        };
        if device::probe().is_err() {
            return shipped("as there is no graphics device here".to_owned());
        }
        match cost::measured(|_| {}) {
            Ok(table) => {
                let words = format!("Costs were measured here, on {}.", table.device);
                Self { table, words }
            }
            Err(error) => shipped(format!("as they could not be measured here: {error}")),
        }
    }
}

/// How much is asked: predictions take a second for a scene with large lamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The tiers that may be chosen.
    Choice,
    /// The baselines too, and what each part of the model is worth.
    Whole,
}

/// Of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneAccuracy {
    /// The cheapest tier that keeps the bound, or the nearest to the reference.
    pub tier: &'static str,
    #[serde(skip)]
    pub chosen: Tier,
    /// Whether it keeps it.
    pub kept: bool,
    pub max_delta_e: f64,
    /// How many places of the visible sheet were looked at.
    pub places: usize,
    pub tiers: Vec<TierReport>,
    pub parts: Vec<PartReport>,
    pub never_modelled: &'static str,
    pub remarks: Vec<String>,
}

/// A tier in a scene.
#[derive(Clone, Debug, Serialize)]
pub struct TierReport {
    pub tier: &'static str,
    /// Predicted ΔE00 from the reference over the visible sheet.
    pub delta_e_mean: f64,
    pub delta_e_p95: f64,
    /// Time of a shaded pixel over the floor's; only of tiers that are measured.
    pub cost: Option<f64>,
}

/// A part of the model in a scene.
#[derive(Clone, Debug, Serialize)]
pub struct PartReport {
    pub what: &'static str,
    /// Whether the tier that is named for the scene models it.
    pub modelled: bool,
    /// ΔE00 that leaving it out costs.
    pub delta_e_mean: f64,
    pub delta_e_p95: f64,
}

impl SceneAccuracy {
    /// Of `scene`, with the maps that it reads kept in `maps`.
    ///
    /// # Errors
    /// [`MapFault`] of a map that cannot be read.
    pub fn new(
        exhibit: &Exhibit,
        scene: &Scene,
        prices: &Prices,
        detail: Detail,
        maps: &mut Maps,
    ) -> Result<Self, MapFault> {
        let seen = Seen::new(exhibit, scene, [WIDTH_PX, HEIGHT_PX], maps)?;
        let (tiers, worths) = match detail {
            Detail::Choice => (&LADDER[..], Vec::new()),
            Detail::Whole => (&Tier::ALL[..], seen.worths()),
        };
        let forecasts = seen.forecasts(tiers);
        let needs = Needs::of(exhibit, scene, Tier::Study, false);
        let costs = needs
            .sides
            .first()
            .map_or_else(Costs::default, |side| Costs::of(&prices.table, &side.terms));
        let max_delta_e = exhibit.accuracy.max_delta_e;
        let (tier, kept) = choice::at_rest(&forecasts, &costs, max_delta_e);
        let mut remarks = Vec::new();
        if is_flattened(exhibit.drawing_of(scene)) {
            remarks.push("the sheet is taken for flat".to_owned());
        }
        if !scene.overlays.is_empty() {
            remarks.push("overlays are left aside".to_owned());
        }
        if scene.compare.is_some() {
            remarks.push("the worst of the members is taken".to_owned());
        }
        if scene.enhance.is_of_picture() {
            remarks.push("contrast and sharpness are left as they are".to_owned());
        }
        if seen.count() == 0 {
            remarks.push("nothing of the sheet is in the picture".to_owned());
        }
        Ok(Self {
            tier: tier.name(),
            chosen: tier,
            kept,
            max_delta_e,
            places: seen.count(),
            tiers: forecasts
                .iter()
                .map(|forecast| TierReport {
                    tier: forecast.tier.name(),
                    delta_e_mean: forecast.errors.mean,
                    delta_e_p95: forecast.errors.p95,
                    cost: costs.get(forecast.tier).map(|cost| cost.ratio),
                })
                .collect(),
            parts: worths
                .iter()
                .map(|worth| PartReport {
                    what: worth.aspect.name(),
                    modelled: worth.aspect.is_in(tier),
                    delta_e_mean: worth.mean,
                    delta_e_p95: worth.p95,
                })
                .collect(),
            never_modelled: NEVER,
            remarks,
        })
    }

    fn list(&self, f: &mut fmt::Formatter<'_>, modelled: bool, title: &str) -> fmt::Result {
        let mut parts: Vec<&PartReport> = self
            .parts
            .iter()
            .filter(|part| part.modelled == modelled && part.delta_e_mean >= NOTHING)
            .collect();
        if parts.is_empty() {
            return Ok(());
        }
        parts.sort_by(|a, b| b.delta_e_mean.total_cmp(&a.delta_e_mean));
        write!(f, "\n  {title}")?;
        for part in parts {
            write!(
                f,
                "\n    {}: ΔE00 {:.2} in the mean, {:.2} at the 95th percentile",
                part.what, part.delta_e_mean, part.delta_e_p95
            )?;
        }
        Ok(())
    }
}

/// One line; `{:#}` is the whole explanation.
impl Display for SceneAccuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            tier, max_delta_e, ..
        } = self;
        let chosen = self.tiers.iter().find(|report| report.tier == *tier);
        let predicted = chosen.map_or(0.0, |report| report.delta_e_mean);
        if self.kept {
            write!(
                f,
                "{tier} is the cheapest tier that keeps ΔE00 {max_delta_e}: {predicted:.2} \
                 predicted"
            )?;
        } else {
            write!(
                f,
                "no tier keeps ΔE00 {max_delta_e}; {tier} comes nearest: {predicted:.2} predicted"
            )?;
        }
        if !f.alternate() {
            return Ok(());
        }
        if self.kept {
            write!(
                f,
                ", which {MARGIN} times over keeps it, as predictions err"
            )?;
        }
        let ladder = |report: &&TierReport| LADDER.iter().any(|tier| tier.name() == report.tier);
        for report in self.tiers.iter().filter(ladder) {
            write!(
                f,
                "\n    {}: ΔE00 {:.2} in the mean, {:.2} at the 95th percentile",
                report.tier, report.delta_e_mean, report.delta_e_p95
            )?;
            if let Some(cost) = report.cost {
                write!(f, ", {cost:.2} times the cost of reading the maps")?;
            }
        }
        self.list(f, true, &format!("modelled by {tier}, and without it:"))?;
        self.list(
            f,
            false,
            &format!("left out by {tier}, which costs (each by itself; together not their sum):"),
        )?;
        write!(f, "\n  left out by every tier: {}", self.never_modelled)?;
        for remark in &self.remarks {
            write!(f, "\n  for this prediction {remark}")?;
        }
        Ok(())
    }
}
