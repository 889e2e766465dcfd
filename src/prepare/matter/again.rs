//! Places whose surface is not paper's, solved again: stereo took every surface for paper's, and
//! ink's narrower gleam turned its normals towards the lamps. Now that its roughness is known, it
//! is divided out with that.

use std::path::Path;

use super::Bench;
use crate::{
    colour::srgb_encode,
    prepare::{
        PrepareError,
        photographs::Stack,
        stereo::{Paper, Response, Rows, Solver},
    },
};

/// A class and what light does at its surface.
pub struct Glossy {
    pub class: u8,
    pub surface: Paper,
}

/// Reads the photographs once more, and replaces the normal and the sRGB-encoded albedo of each
/// place that is of one of these classes.
///
/// # Errors
/// Of the first photograph that cannot be read now.
pub fn solve(
    bench: &Bench<'_>,
    scratch: &Path,
    glossy: &[Glossy],
    classes: &[u8],
    albedo: &mut [[u16; 3]],
    normals: &mut [[f32; 3]],
) -> Result<(), PrepareError> {
    if glossy.is_empty() {
        return Ok(());
    }
    let shots = bench.shots;
    let ambient = shots.ambient.as_deref();
    let encoding = bench.capture.encoding;
    let mut stack = Stack::open(&shots.photographs, ambient, encoding, shots.crop, scratch)?;
    while let Some(mut band) = stack.next()? {
        let start = band.top * band.width;
        let end = start + band.rows * band.width;
        let of_band = &classes[start..end];
        let here: Vec<&Glossy> = glossy
            .iter()
            .filter(|glossy| of_band.contains(&glossy.class))
            .collect();
        if here.is_empty() {
            continue;
        }
        band.divide(bench.fields);
        for Glossy { class, surface } in here {
            let solver = Solver {
                response: Response::Paper(surface.clone()),
                ..bench.solver.clone()
            };
            let mut solved = solver.solve(Rows {
                planes: &band.planes,
                width: band.width,
                top: band.top,
            });
            if let Some(correction) = bench.correction {
                let [r, g, b] = &mut solved.albedo;
                correction.apply_planes([r, g, b]);
            }
            for (i, _) in of_band.iter().enumerate().filter(|(_, of)| *of == class) {
                normals[start + i] = solved.normal[i];
                albedo[start + i] = [0, 1, 2].map(|c| {
                    let linear = f64::from(solved.albedo[c][i]) * bench.exposure;
                    // Casts saturate.
                    (srgb_encode(linear).clamp(0.0, 1.0) * 65535.0).round() as u16
                });
            }
        }
    }
    Ok(())
}
