//! What a side is made of, as lines of a manifest.

use std::fmt::Write as _;

use super::MatterReport;
use crate::{
    colour::format_hex,
    manifest::SideName,
    optics::medium::{Matter, MediumId},
    prepare::{Report, SideReport, materials::legend::MediaFile, write::word},
};

fn rounded(v: f64) -> f64 {
    (v * 10_000.0).round() / 10_000.0
}

fn triple(values: [f64; 3], most: f64) -> String {
    let [r, g, b] = values.map(|v| rounded(v.clamp(0.0, most)));
    format!("[{r:?}, {g:?}, {b:?}]")
}

/// The line of a drawing about its paper.
pub fn paper_line(report: &Report) -> String {
    let Some(matter) = report.sides.first().map(|side| &side.matter) else {
        return "paper = { kind = \"laid\", source = \"assumed\" }\n".to_owned();
    };
    let mut known = Vec::new();
    let mut words = Vec::new();
    // Without media a renderer looks for the bare paper itself.
    if matter.materials.is_some() {
        known.push(format!("albedo = {}", triple(matter.paper_albedo, 1.0)));
        words.push("its colour was measured");
    }
    let roughness = matter.roughness.iter().find(|of| of.medium.is_none());
    if let Some(found) = roughness.filter(|of| of.within.is_some()) {
        known.push(format!(
            "roughness = {:?}",
            rounded(found.alpha.clamp(0.1, 1.0))
        ));
        words.push("its roughness was fitted");
    }
    let thickness = matter
        .transmission
        .as_ref()
        .and_then(|told| told.thickness_um);
    if let Some(um) = thickness {
        known.push(format!("thickness_um = {:?}", um.round()));
        words.push("its thickness was fitted to the light that comes through");
    }
    words.push("what it is made of was not measured");
    let words = words.join(", ");
    let source = match known.is_empty() {
        true => "assumed",
        false => "fitted",
    };
    let known: String = known.iter().map(|each| format!("{each}, ")).collect();
    format!(
        "# Of the paper: {words}.\npaper = {{ kind = \"laid\", {known}source = \"{source}\" }}\n"
    )
}

/// Lines of a side.
pub fn side_lines(side: &SideReport) -> String {
    let files = side.matter.files.iter().map(|file| {
        let legend = file
            .legend
            .iter()
            .map(|(colour, medium)| format!("\"{}\" = \"{medium}\"", format_hex(*colour)));
        format!(
            "    {{ file = \"maps/{}/{}\", legend = {{ {} }}, source = \"fitted\" }},\n",
            word(side.side),
            file.name,
            legend.collect::<Vec<_>>().join(", ")
        )
    });
    let files: String = files.collect();
    match files.is_empty() {
        true => String::new(),
        false => format!("media = [\n{files}]\n"),
    }
}

/// Tables of the drawing.
pub fn drawing_lines(report: &Report) -> String {
    let mut out = String::new();
    for side in &report.sides {
        let MatterReport {
            transmission,
            depth_white,
            ..
        } = &side.matter;
        if transmission.is_some() {
            out += "[drawing.transmission]\n\
                    map = { file = \"maps/transmission.png\", source = \"fitted\" }\n\n";
        }
        out += &overlays(side);
        if *depth_white > 0.0 {
            let name = word(side.side);
            let id = match side.side {
                SideName::Recto => "ink-depth",
                SideName::Verso => "ink-depth-verso",
            };
            let _ = write!(
                out,
                "[[drawing.overlay]]\nid = \"{id}\"\ntitle = {{ en = \"Depth of the ink\" }}\n\
                 side = \"{name}\"\nkind = \"continuous\"\nfile = \"maps/{name}/ink-depth.png\"\n\
                 unit = \"optical depth, green\"\nrange = [0, {depth_white:?}]\n\
                 source = \"fitted\"\n\n"
            );
        }
    }
    out
}

/// Its maps of media, to be looked at: what a scene shows of them is matter otherwise.
fn overlays(side: &SideReport) -> String {
    let name = word(side.side);
    let overlay = |(i, file): (usize, &MediaFile)| {
        let of_verso = match side.side {
            SideName::Recto => "",
            SideName::Verso => "-verso",
        };
        let number = match i {
            0 => String::new(),
            i => format!("-{}", i + 1),
        };
        let legend = file.legend.iter().map(|(colour, medium)| {
            format!(
                "    {{ id = \"{medium}\", colour = \"{}\", label = {{ en = \"{}\" }} }},\n",
                format_hex(*colour),
                spoken(medium.name())
            )
        });
        format!(
            "[[drawing.overlay]]\nid = \"media{of_verso}{number}\"\n\
             title = {{ en = \"What it is drawn with\" }}\nside = \"{name}\"\nkind = \"categorical\"\n\
             file = \"maps/{name}/{}\"\nlegend = [\n{}]\nsource = \"fitted\"\n\n",
            file.name,
            legend.collect::<String>()
        )
    };
    side.matter.files.iter().enumerate().map(overlay).collect()
}

/// A medium's name in words: "Lead point".
fn spoken(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().collect::<String>() + &letters.as_str().replace('-', " ")
}

/// Media with the constants that were found, each once: of both sides, where both show it, as the
/// side with the narrower bound says.
pub fn media_lines(report: &Report) -> String {
    let mut media: Vec<MediumId> = Vec::new();
    for side in &report.sides {
        for medium in side.matter.roughness.iter().filter_map(|of| of.medium) {
            if !media.contains(&medium) {
                media.push(medium);
            }
        }
    }
    media
        .into_iter()
        .map(|medium| medium_lines(report, medium))
        .collect()
}

fn medium_lines(report: &Report, medium: MediumId) -> String {
    let mut known = String::new();
    let sides = || report.sides.iter().map(|side| &side.matter);
    let found = sides()
        .flat_map(|matter| &matter.roughness)
        .filter(|of| of.medium == Some(medium))
        .filter_map(|of| Some((of.within?, of.alpha)))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, alpha)) = found {
        let _ = writeln!(known, "roughness = {:?}", rounded(alpha.clamp(0.01, 1.0)));
    }
    let albedo = sides().find_map(|matter| {
        let media = &matter.materials.as_ref()?.media;
        let class = media.iter().position(|of| *of == Some(medium))?;
        *matter.albedo.get(class)?
    });
    if let Some(albedo) = albedo {
        let _ = writeln!(known, "albedo = {}", triple(albedo, 1.0));
    }
    let ink = sides()
        .flat_map(|matter| &matter.inks)
        .find(|ink| ink.medium == medium);
    if let (Some(ink), Matter::Film(_)) = (ink, medium.medium().matter) {
        let _ = writeln!(known, "depth = {}", triple(ink.strong, 20.0));
    }
    match known.is_empty() {
        true => String::new(),
        false => format!("[[medium]]\nid = \"{medium}\"\n{known}source = \"fitted\"\n\n"),
    }
}
