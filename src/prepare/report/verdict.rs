//! What came of a capture in plain words: what is good, what was not measured, and what to look at
//! again, with what to do. All limits are here.

use std::fmt::Write as _;

use super::escaped;
use crate::{
    manifest::SideName,
    optics::medium::MediumId,
    prepare::{
        capture::BARE_PAPER,
        materials::SwatchTold,
        run::{Report, SideReport},
        stereo::left_out::Relit,
    },
};

/// The share of places at which a photograph may be doubted.
const DOUBTED: f64 = 0.30;
/// What photographs may leave over at half of all places, in shares of their mean.
const LEFT_OVER: f64 = 0.10;
/// How little lamps may span space, in 0…1: noise grows by its inverse.
const SPREAD: f64 = 0.20;
/// How far a photograph may be shifted against the others, in pixels.
const SHIFT_PX: f64 = 0.5;
/// Mean ΔE00 of a chart's patches once corrected.
const DELTA_E: f64 = 5.0;
/// From the lowest to the highest place of a sheet, in shares of its longer side.
const RISE: f64 = 0.10;
/// How far the shape may be from the other surface (σ), in shares of its own range.
const DIFFERS: f64 = 0.10;
/// The least share of each material's held-out places that is found.
const FOUND: f64 = 0.90;
/// The least share of a swatch's places that are told as it says.
const MIXED: f64 = 0.5;
/// The share of a side that may be like no swatch.
const UNLIKE: f64 = 0.20;

/// How a matter stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Measured, and within all limits.
    Good,
    /// Nothing is wrong, but something was not measured.
    NotMeasured,
    /// Beyond a limit.
    LookAgain,
}

impl Standing {
    fn words(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::NotMeasured => "not all of it is measured",
            Self::LookAgain => "look again",
        }
    }
}

/// How one matter stands, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Such as "lamps".
    pub matter: &'static str,
    pub standing: Standing,
    /// Why, and what to do, each in a sentence or two.
    pub told: Vec<String>,
}

/// What speaks about a matter.
#[derive(Default)]
struct Findings {
    wrong: Vec<String>,
    missing: Vec<String>,
    good: Vec<String>,
}

impl Findings {
    fn verdict(self, matter: &'static str) -> Verdict {
        let Self {
            wrong,
            missing,
            good,
        } = self;
        let (standing, told) = match (wrong.is_empty(), missing.is_empty()) {
            (false, _) => (Standing::LookAgain, wrong),
            (true, false) => (Standing::NotMeasured, missing),
            (true, true) => (Standing::Good, good),
        };
        Verdict {
            matter,
            standing,
            told,
        }
    }

    /// Takes a value that is beyond its limit, or no number, as wrong.
    fn limit(&mut self, value: f64, limit: f64, wrong: impl FnOnce() -> String) {
        // NaN is within nothing.
        let within = value <= limit;
        if !within {
            self.wrong.push(wrong());
        }
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}

fn side(of: &SideReport) -> &'static str {
    match of.side {
        SideName::Recto => "recto",
        SideName::Verso => "verso",
    }
}

impl Report {
    /// How each matter stands: lamps, photographs, colour, shape and materials.
    pub fn verdicts(&self) -> Vec<Verdict> {
        let lamps = lamps(self).verdict("lamps");
        let photographs = photographs(self).verdict("photographs and exposure");
        let is_wrong = |verdict: &Verdict| verdict.standing == Standing::LookAgain;
        let shape = shape(self, is_wrong(&lamps) || is_wrong(&photographs)).verdict("shape");
        let (colour, materials) = (colour(self), materials(self));
        vec![
            lamps,
            photographs,
            colour.verdict("colour"),
            shape,
            materials.verdict("materials"),
        ]
    }

    /// What to look at again, each with what to do: nothing where all is good.
    pub fn doubts(&self) -> Vec<String> {
        let verdicts = self.verdicts().into_iter();
        let wrong = verdicts.filter(|verdict| verdict.standing == Standing::LookAgain);
        wrong
            .flat_map(|Verdict { matter, told, .. }| {
                told.into_iter()
                    .map(move |told| format!("{matter}: {told}"))
            })
            .collect()
    }
}

fn lamps(report: &Report) -> Findings {
    let mut found = Findings::default();
    found.limit(SPREAD, report.spread, || {
        format!(
            "they stand so much alike that noise grows {:.0} times; spread them all around the sheet, \
             at 30 to 60° above it",
            1.0 / report.spread.max(1e-3)
        )
    });
    for of in &report.sides {
        let Some(Relit {
            computed,
            neighbours,
            ..
        }) = of.relit
        else {
            continue;
        };
        let (ours, theirs) = (percent(computed), percent(neighbours));
        found.limit(computed, neighbours, || {
            format!(
                "a photograph of the {} that was left out and computed from the others is off by {ours}, \
                 more than the mean of its neighbours ({theirs}): the order of the lamps is probably \
                 wrong; compare shadows in the photographs with the plot of the lamps",
                side(of)
            )
        });
        found.good.push(format!(
            "a photograph of the {} that was left out is computed from the others to within {ours}; the \
             mean of its neighbours is off by {theirs}",
            side(of)
        ));
    }
    if report.sides.iter().any(|of| of.relit.is_none()) {
        found.missing.push(
            "nothing is left to check them by; photograph the sheet under more lamps, four or better \
             eight"
                .to_owned(),
        );
    }
    found
}

fn photographs(report: &Report) -> Findings {
    let mut found = Findings::default();
    const CONTRADICT: &str = "photographs contradict each other: check the order of the lamps, the grey \
                              cards and the exposure, which has to be the same for all";
    for of in &report.sides {
        let (name, [half, _]) = (side(of), of.residual);
        found.wrong.extend(of.doubts.iter().cloned());
        found.limit(of.doubted, DOUBTED, || {
            format!(
                "on {} of the {name} a photograph does not fit the others; {CONTRADICT}",
                percent(of.doubted)
            )
        });
        found.limit(half, LEFT_OVER, || {
            format!(
                "at half of all places of the {name} the maps are off the photographs by {} or more; \
                 {CONTRADICT}",
                percent(half)
            )
        });
        if of.assumed_exposure.is_some() {
            found.missing.push(format!(
                "how light the {name} is was assumed, its brightest paper taken for white; photograph a \
                 grey card or a chart in the same light"
            ));
        }
        if report.lamps.len() > 3 {
            found.good.push(format!(
                "at half of all places of the {name} the photographs agree to within {}",
                percent(half)
            ));
        }
    }
    for (of, stillness) in report.sides.iter().zip(&report.stillness) {
        if let Some((lamp, by)) = stillness.farthest() {
            found.limit(by.length(), SHIFT_PX, || {
                format!(
                    "photograph {} of the {} is shifted by {:.2} pixels against the others, so that fine \
                     strokes blur; fix camera and sheet, and photograph it again",
                    lamp + 1,
                    side(of),
                    by.length()
                )
            });
        }
    }
    if report.lamps.len() <= 3 {
        found.missing.push(
            "three photographs always agree with some sheet, so that nothing shows a fault; photograph \
             it under four lamps or more"
                .to_owned(),
        );
    }
    found
}

fn colour(report: &Report) -> Findings {
    let mut found = Findings::default();
    match &report.colour {
        None => found.missing.push(
            "colours are as the camera saw them; photograph a colour chart in the same light"
                .to_owned(),
        ),
        Some(fitted) => {
            let after = super::mean(&fitted.after);
            found.limit(after, DELTA_E, || {
                format!(
                    "the chart's patches are still off by ΔE00 {after:.1} on the mean; check the corners of \
                     the chart, that nothing on it is too bright, and that the photographs are linear or \
                     say how they are encoded"
                )
            });
            found.good.push(format!(
                "the chart's patches are off by ΔE00 {after:.1} on the mean"
            ));
        }
    }
    found
}

fn shape(report: &Report, unfounded: bool) -> Findings {
    let mut found = Findings::default();
    for of in &report.sides {
        let [low, high] = of.shape_um;
        let longer = of.size[0].max(of.size[1]) as f64 * report.mm_per_px;
        let rise = (high - low) / 1000.0;
        found.limit(rise, RISE * longer, || {
            format!(
                "the {} rises by {rise:.1} mm over {longer:.0} mm, much for a sheet; if it lay flatter, \
                 write how far away the lamps were (distance_mm), and photograph a grey card under each",
                side(of)
            )
        });
        if let Some(compared) = &of.compared {
            let sigma = compared.whole.sigma;
            found.limit(sigma, DIFFERS * (high - low), || {
                format!(
                    "it differs from the other surface by {sigma:.0} µm (σ), of {:.0} µm in all; check \
                     that both show the same part of the sheet the same way up",
                    high - low
                )
            });
        }
        found.good.push(format!(
            "the {} rises by {rise:.2} mm over {longer:.0} mm",
            side(of)
        ));
    }
    if unfounded {
        found.missing.push(
            "it rests upon the lamps and the photographs; look at those first, and prepare it again"
                .to_owned(),
        );
    }
    found
}

fn materials(report: &Report) -> Findings {
    let mut found = Findings::default();
    for of in &report.sides {
        let name = side(of);
        let Some(materials) = &of.matter.materials else {
            found.missing.push(format!(
                "no swatch says what the {name} is drawn with; add a [[swatch]] for each material"
            ));
            continue;
        };
        found.limit(materials.unlike, UNLIKE, || {
            format!(
                "{} of the {name} are like no swatch; add swatches of what is missing",
                percent(materials.unlike)
            )
        });
        for told in &materials.swatches {
            found.limit(MIXED, told.right, || {
                let SwatchTold {
                    swatch,
                    right,
                    taken_for,
                } = told;
                let rect = swatch.rect;
                let word = |medium: Option<MediumId>| medium.map_or(BARE_PAPER, MediumId::name);
                format!(
                    "of the swatch of {} at [{}, {}, {}, {}] on the {name} only {} are told so, most others as {}; \
                     draw it again if it shows more than one material, or add swatches of the lighter and darker \
                     of both",
                    word(swatch.medium),
                    rect.left,
                    rect.top,
                    rect.right,
                    rect.bottom,
                    percent(*right),
                    word(*taken_for)
                )
            });
        }
        match materials.confusion().filter(|held| held.total() > 0) {
            None => found.missing.push(format!(
                "the swatches of the {name} are too small to check by a part of them; make them larger"
            )),
            Some(held_out) => {
                let right = held_out.accuracy();
                found.limit(FOUND, right, || {
                    format!(
                        "on the {name} only {} of what the swatches show is told right; see in report.html what is \
                         taken for what, and add swatches of these from other places",
                        percent(right)
                    )
                });
                found.good.push(format!(
                    "on the {name} {} of what the swatches show is told right",
                    percent(right)
                ));
            }
        }
    }
    found
}

/// "a", "a and b", "a, b and c".
fn listed(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// With its first letter a capital.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters
        .next()
        .map(|letter| letter.to_uppercase().to_string());
    escaped(&(first.unwrap_or_default() + letters.as_str()))
}

/// The part of the page that says all this.
pub(super) fn section(report: &Report) -> String {
    let verdicts = report.verdicts();
    let of = |standing| {
        let those = verdicts
            .iter()
            .filter(|verdict| verdict.standing == standing);
        let matters: Vec<&str> = those.map(|verdict| verdict.matter).collect();
        listed(&matters)
    };
    let (wrong, missing) = (of(Standing::LookAgain), of(Standing::NotMeasured));
    let good = of(Standing::Good);
    let mut out = "<h2>In short</h2><p>".to_owned();
    if wrong.is_empty() {
        out += "Nothing here speaks against these maps.";
    } else {
        // Writing to a string does not fail.
        let _ = write!(
            out,
            "<strong>Look again at {wrong}</strong> before you rely on these maps."
        );
    }
    if !good.is_empty() {
        let _ = write!(out, " Good: {good}.");
    }
    if !missing.is_empty() {
        let _ = write!(out, " Not everything was measured about {missing}.");
    }
    out += "</p><ul>";
    for verdict in &verdicts {
        let _ = write!(
            out,
            "<li><strong>{}: {}.</strong>",
            sentence(verdict.matter),
            verdict.standing.words()
        );
        for told in &verdict.told {
            let _ = write!(out, " {}.", sentence(told));
        }
        out += "</li>";
    }
    let _ = write!(
        out,
        "</ul><details><summary>When it says look again</summary><p>Lamps: noise grows more than \
         {:.0} times, or photographs that were left out are computed worse than by the mean of their \
         neighbours. Photographs: more than {:.0} % of places at which one was doubted, more than \
         {:.0} % left over at half of all places, or one shifted by more than {SHIFT_PX} pixels. Colour: \
         mean ΔE00 of the corrected chart above {DELTA_E:.0}. Shape: a rise above {:.0} % of the \
         longer side, or more than {:.0} % of it between it and another surface. Materials: less than \
         {:.0} % of held-out places or {:.0} % of a swatch told right, or more than {:.0} % like no swatch.</p></details>",
        1.0 / SPREAD,
        DOUBTED * 100.0,
        LEFT_OVER * 100.0,
        RISE * 100.0,
        DIFFERS * 100.0,
        FOUND * 100.0,
        MIXED * 100.0,
        UNLIKE * 100.0,
    );
    out
}
