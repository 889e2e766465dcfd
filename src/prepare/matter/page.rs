//! What a side is made of, as a part of the report.

use std::fmt::Write as _;

use crate::{
    colour::format_hex,
    optics::medium::MediumId,
    prepare::{
        Report, SideReport,
        capture::{BARE_PAPER, Capture},
        gloss::{Roughness, first::Surfaces},
        materials::{BETTER, Materials, features, legend, network, sharpness, ways::Method},
    },
};

fn name(medium: Option<MediumId>) -> &'static str {
    medium.map_or(BARE_PAPER, MediumId::name)
}

fn percent(share: Option<f64>) -> String {
    share.map_or("none held out".to_owned(), |share| {
        format!("{:.1} %", share * 100.0)
    })
}

/// The lines of the table of what is measured.
pub fn sources(capture: &Capture, report: &Report) -> String {
    let sides = || report.sides.iter().map(|side| &side.matter);
    let media = match sides().any(|matter| matter.materials.is_some()) {
        true => "fitted to swatches",
        false => "none: no swatch names a medium, and what is darker than the paper counts as ink",
    };
    let all = || sides().flat_map(|matter| &matter.roughness);
    let fitted = all().filter(|of| of.within.is_some()).count();
    let gloss = match (fitted, all().count()) {
        (0, _) => "assumed, by the catalogue: the photographs do not show it",
        (fitted, all) if fitted == all => "fitted to the photographs, for each material",
        _ => "fitted to the photographs for some materials, see below; assumed for the others",
    };
    let depth = match sides().any(|matter| !matter.inks.is_empty()) {
        true => "fitted: the film's model inverted, over the paper as measured",
        false => "as a renderer finds it from the albedo",
    };
    let passes = match (
        &capture.transmitted,
        sides().find_map(|m| m.transmission.as_ref()),
    ) {
        (Some(_), Some(told)) if told.thickness_um.is_some() => {
            "measured, the recto's ink taken out; the level too"
        }
        (Some(_), Some(_)) => "measured, the recto's ink taken out; its level assumed",
        _ => "assumed: no photograph in transmitted light",
    };
    let bare = match sides().any(|matter| matter.materials.is_some()) {
        true => "measured, where no medium lies",
        false => "assumed: that of the lights",
    };
    format!(
        "<tr><td>Media<td>{media}<tr><td>Roughness<td>{gloss}<tr><td>Depth of ink<td>{depth}\
         <tr><td>Light through the sheet<td>{passes}<tr><td>Colour of the bare paper<td>{bare}\
         <tr><td>Kind of paper, refractive indices<td>assumed"
    )
}

/// The part about one side.
pub fn page(side: &SideReport) -> String {
    let matter = &side.matter;
    let mut out = String::new();
    match &matter.materials {
        Some(materials) => out += &of_materials(materials),
        None => {
            out += "<p>No swatch names a medium of this side: it has no map of media.</p>";
        }
    }
    if let Some(surfaces) = &matter.surfaces {
        out += &of_surfaces(surfaces);
    }
    out += "<table><tr><th>Surface<th>Roughness α<th>±<th>The photographs leave over<th>Places";
    for of in &matter.roughness {
        let within = of
            .within
            .map_or("assumed".to_owned(), |within| format!("{within:.3}"));
        // Writing to a string does not fail.
        let _ = write!(
            out,
            "<tr><td>{}<td>{:.3}<td>{within}<td>{:.1} %<td>{}",
            name(of.medium),
            of.alpha,
            of.residual * 100.0,
            of.places
        );
    }
    out += "</table><p>± is two standard deviations of the fit. Where it says assumed, the \
            photographs do not tell gloss from albedo, or there were too few places.</p>";
    if !matter.inks.is_empty() {
        out += "<table><tr><th>Ink<th>Usual depth τ, red, green, blue<th>At full strength";
        for ink in &matter.inks {
            let each = |values: [f64; 3]| values.map(|v| format!("{v:.2}")).join(" ");
            let _ = write!(
                out,
                "<tr><td>{}<td>{}<td>{}",
                ink.medium,
                each(ink.median),
                each(ink.strong)
            );
        }
        out += "</table>";
    }
    if let Some(told) = &matter.transmission {
        let _ = write!(
            out,
            "<p>On the light table, paper passes {:.0} to {:.0} % of its mean (5th and 95th \
             percentile). ",
            told.spread[0] * 100.0,
            told.spread[1] * 100.0
        );
        let _ = match (told.passes, told.thickness_um) {
            (Some(passes), Some(um)) => write!(
                out,
                "Bare paper passes {:.1} % of the table's light, as {um:.0} µm of laid paper do.",
                passes * 100.0
            ),
            _ if told.levelled => write!(
                out,
                "The table alone was not photographed at the same exposure: how much passes on the \
                 whole is assumed."
            ),
            _ => write!(
                out,
                "Without a photograph of the table alone it is taken for even, and how much passes \
                 on the whole is assumed."
            ),
        };
        let _ = write!(
            out,
            " Ink hides the paper on {:.2} % of the sheet, which is taken for mean paper there; ink \
             of the verso is not taken out.</p>",
            told.hidden * 100.0
        );
    }
    out
}

/// What normals were solved with.
fn of_surfaces(surfaces: &Surfaces) -> String {
    let told = |of: &Roughness| match of.within {
        Some(within) => format!("{:.2} (fitted, ± {within:.2})", of.alpha),
        None => format!("{:.2} (assumed)", of.alpha),
    };
    let dark = match &surfaces.dark {
        None => "; hardly anything is darker than that".to_owned(),
        Some(dark) => format!(
            ", and {} of roughness {} where the albedo is below {:.2}",
            match dark.is_film {
                true => "as ink in it",
                false => "as body colour on it",
            },
            told(&dark.roughness),
            dark.below
        ),
    };
    format!(
        "<p>Normals and albedo were solved as those of paper of roughness {}{dark}.</p>",
        told(&surfaces.paper)
    )
}

/// What was done about a blur of this variance in square pixels: a sentence, or nothing.
fn of_blur(variance: f64) -> String {
    if variance <= 0.0 {
        return String::new();
    }
    format!(
        " The sharpest edges of the sheet look blurred by {:.2} pixels (one standard deviation), which was taken out of \
         the colours that materials were told by; no more than {:.2} is.",
        variance.sqrt(),
        sharpness::MOST.sqrt()
    )
}

fn of_materials(materials: &Materials) -> String {
    let mut out = format!(
        "<h3>Materials</h3><p>Told apart by {}, learnt from blocks of the swatches, and small swatches as a \
         whole; others chose between {} ways, of which those that see more of a place's surroundings have to do \
         better by {BETTER} for each step, and others again, of which none knew, judge them. A \
         network then also weighs how often each is met on the sheet. Bare paper was learnt {}. {:.2} % of the side are like no swatch.{}</p>\
         <table><tr><th>Way<th>right where it was chosen<th>right on held-out places",
        features::NAMES.join(", "),
        materials.trials.len(),
        match materials.paper_shown {
            true => "from its swatches",
            false => "where the sheet is light, as no swatch shows it",
        },
        materials.unlike * 100.0,
        of_blur(materials.blur),
    );
    for trial in &materials.trials {
        let how = match trial.way.method {
            Method::Network => {
                format!(
                    "{} ({} neurons, Levenberg-Marquardt)",
                    trial.way,
                    network::HIDDEN
                )
            }
            Method::Discriminant => trial.way.to_string(),
        };
        let taken = match trial.way == materials.chosen {
            true => " (taken: what sees more is only where it does better by that much)",
            false => "",
        };
        let _ = write!(
            out,
            "<tr><td>{how}{taken}<td>{:.1} %<td>{:.1} %",
            trial.choosing * 100.0,
            trial.held_out.accuracy() * 100.0
        );
    }
    out += "</table><table><tr><th>Material<th>Colour in the map<th>Share of the side\
            <th>Learnt from so many places<th>Found, of held-out places";
    for medium in &materials.media {
        let _ = write!(out, "<th>places taken for {}", name(*medium));
    }
    let confusion = materials.confusion();
    for (class, medium) in materials.media.iter().enumerate() {
        let shown = match class {
            0 => "none".to_owned(),
            class => {
                let hex = format_hex(legend::colour(class));
                format!("<span style=\"color:{hex}\">■</span> {hex}")
            }
        };
        let _ = write!(
            out,
            "<tr><td>{}<td>{shown}<td>{:.2} %<td>{}<td>{}",
            name(*medium),
            materials.coverage.get(class).copied().unwrap_or_default() * 100.0,
            materials.learnt.get(class).copied().unwrap_or_default(),
            percent(confusion.and_then(|confusion| confusion.recall(class))),
        );
        let row = confusion.and_then(|confusion| confusion.counts.get(class));
        for count in row.into_iter().flatten() {
            let _ = write!(out, "<td>{count}");
        }
    }
    out += "</table>";
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_is_told_where_it_was_taken_out() {
        assert_eq!(of_blur(0.0), "");
        let told = of_blur(0.09);
        assert!(
            told.contains(" 0.30 pixels") && told.contains("than 0.59"),
            "{told}"
        );
    }
}
