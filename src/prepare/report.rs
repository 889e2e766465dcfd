//! What came of a capture, as one page that needs nothing else.
//!
//! | part | where |
//! |---|---|
//! | what to look at again, in plain words | [`verdict`] |
//! | plots | [`plots`] |
//! | tables and pictures | here |

pub mod plots;
pub mod verdict;

use std::{fmt::Write as _, fs, io::Write as _, path::Path};

use super::{
    PrepareError,
    capture::{Capture, Circle, Integration, Light},
    colour::{chart::COLORCHECKER24, correct::Fitted},
    matter,
    moved::Stillness,
    run::{Report, SideReport},
    write,
};
use crate::{
    manifest::SideName,
    maps::encode::{save_png_rgb8, write_whole},
};

/// The page's file name.
pub const REPORT: &str = "report.html";
/// The longer side of pictures in it.
const PREVIEW_PX: usize = 640;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;\
    padding:0 1rem;color:#222;background:#fff}table{border-collapse:collapse;margin:1rem 0}\
    td,th{padding:.2rem .8rem;border-bottom:1px solid #ddd;text-align:right}\
    td:first-child,th:first-child{text-align:left}img,svg{max-width:100%;height:auto;margin:.5rem 0}\
    figure{margin:1rem 0;break-inside:avoid}svg{font-family:system-ui,sans-serif}";

fn preview_name(side: SideName, kind: &str) -> String {
    let side = match side {
        SideName::Recto => "recto",
        SideName::Verso => "verso",
    };
    format!(".preview-{side}-{kind}.png")
}

/// Writes a small picture of a map of this size into `folder`.
pub(super) fn preview(
    side: SideName,
    kind: &str,
    [width, height]: [usize; 2],
    at: &dyn Fn(usize) -> [u8; 3],
    folder: &Path,
) -> Result<(), PrepareError> {
    let step = width.max(height).div_ceil(PREVIEW_PX).max(1);
    let [w, h] = [width.div_ceil(step), height.div_ceil(step)];
    let pixels: Vec<[u8; 3]> = (0..w * h)
        .map(|i| at(i / w * step * width + i % w * step))
        .collect();
    let path = folder.join(preview_name(side, kind));
    save_png_rgb8(&path, w as u32, h as u32, &pixels, None)?;
    Ok(())
}

/// Text as HTML shows it.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// A number with so many decimals, in which nothing is not less than nothing.
fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}

/// Writes the page into `folder`, with the pictures that [`preview`] left there.
pub(super) fn html(capture: &Capture, report: &Report, folder: &Path) -> Result<(), PrepareError> {
    let page = page(capture, report, folder)?;
    write_whole(&folder.join(REPORT), |file| file.write_all(page.as_bytes()))?;
    Ok(())
}

fn page(capture: &Capture, report: &Report, folder: &Path) -> Result<String, PrepareError> {
    let title = escaped(capture.title.as_deref().unwrap_or(&capture.id));
    let mut out = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\
         <style>{STYLE}</style><h1>{title}</h1><p>Made by Recto {} from {} photographs a side, at \
         {:.4} mm a pixel.</p>",
        env!("CARGO_PKG_VERSION"),
        report.lamps.len(),
        capture.mm_per_px,
    );
    out += &verdict::section(report);
    out += &sources(capture, report);
    out += &of_lamps(report);
    if let Some(fitted) = &report.colour {
        let lab = capture.chart.as_ref().map_or(&[][..], |chart| &chart.lab);
        out += &of_colour(fitted, lab);
    }
    if let Some(verso) = &report.verso {
        // Writing to a string does not fail.
        let _ = write!(
            out,
            "<h2>Place of the verso</h2><p>{}.</p>",
            escaped(&verso.told())
        );
    }
    for (side, stillness) in report.sides.iter().zip(&report.stillness) {
        out += &of_side(capture, side, stillness);
        out += &pictures(side.side, folder)?;
    }
    Ok(out + "</html>")
}

fn of_lamps(report: &Report) -> String {
    let mut out =
        "<h2>Lamps</h2><table><tr><th>Lamp<th>Azimuth<th>Elevation<th>Intensity".to_owned();
    for (i, lamp) in report.lamps.iter().enumerate() {
        let intensity = match lamp.intensity {
            Some(value) => format!("{value:.3}"),
            None => "by the grey card".to_owned(),
        };
        let _ = write!(
            out,
            "<tr><td>{}<td>{:.2}°<td>{:.2}°<td>{intensity}",
            i + 1,
            lamp.azimuth_deg,
            lamp.elevation_deg
        );
    }
    let _ = write!(
        out,
        "</table><p>How well they stand all around the sheet: {:.2} (1 is best; noise in the maps grows \
         by its inverse).</p>{}",
        report.spread,
        write::lamps_told(&report.lamps),
    );
    out + &plots::lamps(&report.lamps)
}

fn of_colour(fitted: &Fitted, lab: &[[f64; 3]]) -> String {
    let mut out = "<h2>Colour</h2><table><tr><th>Patch<th>ΔE00 before<th>after".to_owned();
    for (i, (before, after)) in fitted.before.iter().zip(&fitted.after).enumerate() {
        let name = COLORCHECKER24.get(i).map_or("", |patch| patch.name);
        let _ = write!(out, "<tr><td>{} {name}<td>{before:.2}<td>{after:.2}", i + 1);
    }
    let _ = write!(
        out,
        "<tr><th>mean<th>{:.2}<th>{:.2}</table><p>The {} model was taken. Mean ΔE00 of patches \
         that were left out of the fit:",
        mean(&fitted.before),
        mean(&fitted.after),
        fitted.correction.model
    );
    for (model, error) in &fitted.left_out {
        let _ = write!(out, " {model} {error:.2};");
    }
    out += "</p>";
    out + &plots::chart(fitted, lab)
}

fn of_side(capture: &Capture, side: &SideReport, stillness: &Stillness) -> String {
    let name = match side.side {
        SideName::Recto => "Recto",
        SideName::Verso => "Verso",
    };
    let shots = match (side.side, &capture.verso) {
        (SideName::Verso, Some(verso)) => verso,
        _ => &capture.recto,
    };
    let [width, height] = side.size;
    let relit = side.relit.map_or_else(String::new, |relit| {
        format!(
            "<tr><td>A photograph left out of the fit and computed from the others is off by, root \
             mean square of {}<td>{:.1} %<tr><td>The mean of its two neighbours would be off by\
             <td>{:.1} %",
            relit.photographs,
            relit.computed * 100.0,
            relit.neighbours * 100.0,
        )
    });
    let range = |[low, high]: [f64; 2], decimals| {
        format!("{} … {} µm", number(low, decimals), number(high, decimals))
    };
    let mut out = format!(
        "<h2>{name}</h2><table><tr><td>Size<td>{width} × {height} pixels\
         <tr><td>How far the maps are off the photographs they were made from, in shares of the \
         brightness: at half of all places up to<td>{:.1} %<tr><td>and at 95 % of them up to\
         <td>{:.1} %<tr><td>Places at which a photograph was doubted, such as for a shadow or a \
         highlight<td>{:.1} %{relit}{}<tr><td>Shape at large<td>{}<tr><td>Grain and strokes<td>{}\
         </table>",
        side.residual[0] * 100.0,
        side.residual[1] * 100.0,
        side.doubted * 100.0,
        stillness.row(shots, capture.mm_per_px),
        range(side.shape_um, 0),
        range(side.grain_um, 1),
    );
    out += &match side.residuals.quantile(1.0) > 0.0 {
        true => plots::residuals(name, &side.residuals, side.residual),
        false => "<p>The photographs leave less than a thousandth over, as three always do: no plot of it.</p>"
            .to_owned(),
    };
    out += &plots::left_out(name, &side.relit_each);
    out += &matter::page(side);
    if let (Some(comparison), Some(other)) = (&side.compared, &capture.compare) {
        out += &comparison.table(&escaped(&other.path.to_string_lossy()));
    }
    out
}

/// The pictures of a side that [`preview`] left in `folder`.
fn pictures(side: SideName, folder: &Path) -> Result<String, PrepareError> {
    let mut out = String::new();
    for (kind, words) in [
        ("albedo", "Albedo"),
        ("normal", "Normals of grain and strokes"),
        (
            "shape",
            "Shape at large, from the lowest place (black) to the highest",
        ),
        ("media", "Materials, in the colours of the table"),
        ("ink-depth", "Depth of the ink: the darker, the deeper"),
        (
            "transmission",
            "What the paper passes of light, ink taken out",
        ),
    ] {
        let path = folder.join(preview_name(side, kind));
        // Not every side has all of them.
        if !path.exists() {
            continue;
        }
        let bytes = fs::read(&path).map_err(|reason| PrepareError::Folder { path, reason })?;
        let _ = write!(
            out,
            "<figure><img alt=\"{words}\"{} src=\"data:image/png;base64,{}\"><figcaption>{words}\
             </figcaption></figure>",
            enlarged(&bytes),
            base64::encode(bytes)
        );
    }
    Ok(out)
}

/// Attributes that show a small PNG as large as others are, its pixels as squares.
fn enlarged(png: &[u8]) -> String {
    // The header's chunk comes first, with width and height (PNG, ISO/IEC 15948, 11.2.1).
    let side = |at: usize| {
        let four = png.get(at..at + 4)?.first_chunk::<4>()?;
        usize::try_from(u32::from_be_bytes(*four)).ok()
    };
    let (Some(width), Some(height)) = (side(16), side(20)) else {
        return String::new();
    };
    match PREVIEW_PX / width.max(height).max(1) {
        0 | 1 => String::new(),
        times => format!(
            " width=\"{}\" height=\"{}\" style=\"image-rendering:pixelated\"",
            width * times,
            height * times
        ),
    }
}

/// Which maps are measured, fitted or assumed.
fn sources(capture: &Capture, report: &Report) -> String {
    let lamps = match report.ball {
        Some(Circle { centre, radius }) => format!(
            "measured, in a glossy ball of radius {radius:.1} at {:.1}, {:.1} (pixels)",
            centre.x, centre.y
        ),
        None => "as stated".to_owned(),
    };
    let light = match &capture.lamps.light {
        Light::FlatField { .. } => "measured, by a grey card for each place",
        Light::Relative(_) => "as stated",
        Light::Unknown(_) => "fitted, as the sheet lies flat on the whole",
    };
    let colour = match &report.colour {
        Some(_) => "measured, corrected by a chart",
        None => "as the camera saw it",
    };
    let assumed = report
        .sides
        .iter()
        .any(|side| side.assumed_exposure.is_some());
    let exposure = match assumed {
        true => "assumed: the brightest paper is taken for white",
        false => "measured",
    };
    let height = match capture.relief.known_range_um {
        Some(_) => "measured, and scaled to the stated range",
        None => "measured, scaled by the lamps",
    };
    let edges = match capture.relief.integrate {
        Integration::Free => "",
        Integration::Anchored => "; the shape at large with its edges held flat at 0",
        Integration::Robust => "; the shape at large robustly, against creases and torn edges",
    };
    format!(
        "<h2>What is measured</h2><table><tr><td>Places of the lamps<td>{lamps}<tr><td>Their \
         light<td>{light}<tr><td>Colour<td>{colour}<tr><td>Albedo's level<td>{exposure}<tr><td>\
         Normals<td>measured<tr><td>Heights<td>{height}{edges}{}</table>",
        matter::sources(capture, report)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_not_less_than_nothing() {
        for (value, decimals, text) in [
            (-0.3, 0, "0"),
            (-0.04, 1, "0.0"),
            (0.3, 0, "0"),
            (-0.0, 0, "0"),
            (-0.6, 0, "-1"),
            (-10.0, 0, "-10"),
            (-0.06, 1, "-0.1"),
            (12.34, 1, "12.3"),
        ] {
            assert_eq!(number(value, decimals), text, "{value}");
        }
    }
}
