//! What a side's interface and its films do at each roughness, as the shader reads it: rows of
//! texels, one row for each of many roughnesses.
//!
//! The polynomials over roughness are summed here, in f64, and once. Summed for each pixel they
//! took most of a frame on lavapipe, where a number read from a uniform costs what thirty products
//! cost. Rows are [`ROWS`] to the range of √α, nearer to each other than the fits are to the
//! truth: half a step changes T by less than 5e-4.

use bevy::{
    asset::RenderAssetUsages,
    image::Image,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use glam::{DVec4, Vec2, Vec4};

use crate::optics::{
    ink::capture_path,
    refraction::{PATH_TERMS, PathTable},
    table::{ALPHA_FIT_MIN, InterfaceRow, InterfaceTable},
};

/// Rows over √α.
const ROWS: usize = 1024;
/// Texels of a row without paths, and with them: what is the same for all directions; T; E₂;
/// P_c; P.
const INTERFACE_TEXELS: usize = 5;
const TEXELS: usize = INTERFACE_TEXELS + 1 + PATH_TERMS;

/// The rows of one side.
pub struct Rows {
    texels: Vec<Vec4>,
    /// Scale and offset from √α to the row.
    place: Vec2,
    width: usize,
}

impl Rows {
    /// For a side whose roughness differs from spot to spot.
    pub fn over_roughness(interface: &InterfaceTable, paths: Option<&PathTable>) -> Self {
        let low = ALPHA_FIT_MIN.sqrt();
        let scale = (ROWS - 1) as f64 / (1.0 - low);
        let alphas = (0..ROWS).map(|k| (low + k as f64 / scale).powi(2));
        Self {
            texels: alphas
                .flat_map(|alpha| texels(interface, paths, alpha))
                .collect(),
            // To the nearest.
            place: Vec2::new(scale as f32, (0.5 - low * scale) as f32),
            width: width(paths),
        }
    }

    /// For a side of one roughness (in [0, 1]).
    pub fn at_roughness(interface: &InterfaceTable, paths: Option<&PathTable>, alpha: f64) -> Self {
        Self {
            texels: texels(interface, paths, alpha),
            place: Vec2::ZERO,
            width: width(paths),
        }
    }

    /// Scale and offset that take √α, within the bounds of the fits, to a row.
    pub fn place(&self) -> Vec2 {
        self.place
    }

    /// The rows as a texture of 32-bit floats, to be read texel by texel.
    pub fn image(&self) -> Image {
        let size = Extent3d {
            width: self.width as u32,
            height: (self.texels.len() / self.width) as u32,
            depth_or_array_layers: 1,
        };
        let bytes = self.texels.iter().flat_map(|texel| texel.to_array());
        Image::new(
            size,
            TextureDimension::D2,
            bytes.flat_map(f32::to_le_bytes).collect(),
            TextureFormat::Rgba32Float,
            RenderAssetUsages::RENDER_WORLD,
        )
    }
}

fn width(paths: Option<&PathTable>) -> usize {
    if paths.is_some() {
        TEXELS
    } else {
        INTERFACE_TEXELS
    }
}

fn texels(interface: &InterfaceTable, paths: Option<&PathTable>, alpha: f64) -> Vec<Vec4> {
    let mean = interface.mean_at(alpha);
    let InterfaceRow { t, late } = interface.row(alpha);
    let n = paths.map_or(0.0, |paths| paths.n);
    let mut texels = vec![
        DVec4::new(mean.compensation, mean.t_mean, mean.capture, mean.floor),
        DVec4::new(t[0], t[1], t[2], t[3]),
        DVec4::new(t[4], t[5], t[6], n),
        DVec4::new(late[0], late[1], late[2], late[3]),
        DVec4::new(late[4], late[5], late[6], 0.0),
    ];
    if let Some(paths) = paths {
        texels.push(capture_path(paths, alpha));
        texels.extend(paths.row(alpha));
    }
    texels.iter().map(|texel| texel.as_vec4()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{
        refraction::{PathRow, path_at},
        table::{fit_root, interface_at},
    };

    /// The row that the shader reads, in its own precision.
    fn row_of(rows: &Rows, alpha: f32) -> &[Vec4] {
        let s = fit_root(alpha.into()) as f32;
        let y = (s * rows.place.x + rows.place.y) as usize;
        &rows.texels[y * rows.width..][..rows.width]
    }

    #[test]
    fn every_roughness_finds_a_row_of_its_own() {
        let (interface, paths) = (InterfaceTable::new(1.5, 1.0), PathTable::new(1.5));
        let rows = Rows::over_roughness(&interface, Some(&paths));
        let mut worst = [0.0f64; 3];
        for k in 0..=1000 {
            let alpha = 0.1 + 0.9 * f64::from(k) / 1000.0;
            let row = row_of(&rows, alpha as f32);
            let t: Vec<f64> = row[1..3]
                .iter()
                .flat_map(|c| c.as_dvec4().to_array())
                .collect();
            let late: Vec<f64> = row[3..5]
                .iter()
                .flat_map(|c| c.as_dvec4().to_array())
                .collect();
            let interface_row = InterfaceRow {
                t: std::array::from_fn(|i| t[i]),
                late: std::array::from_fn(|i| late[i]),
            };
            let path_row: PathRow = std::array::from_fn(|i| row[6 + i].as_dvec4());
            for mu in [0.0, 0.02, 0.3, 1.0] {
                let (found, exact) = (interface_at(&interface_row, mu), interface.at(mu, alpha));
                let path = path_at(&path_row, mu, t[7]);
                worst[0] = worst[0].max((found.t - exact.t).abs());
                worst[1] = worst[1].max((found.late - exact.late).abs());
                worst[2] = worst[2].max((path - paths.at(mu, alpha)).abs().max_element());
            }
            assert!(
                (row[5].as_dvec4() - capture_path(&paths, alpha))
                    .abs()
                    .max_element()
                    < 0.01
            );
            assert!((f64::from(row[0].y) - interface.mean_at(alpha).t_mean).abs() < 5e-4);
        }
        assert!(
            worst[0] < 5e-4 && worst[1] < 5e-4 && worst[2] < 0.02,
            "{worst:?}"
        );
        // Three rows further the test would fail.
        let further = (fit_root(0.1) + 3.0 / f64::from(rows.place.x)).powi(2);
        let (a, b) = (row_of(&rows, 0.1), row_of(&rows, further as f32));
        assert!((a[1] - b[1]).abs().max_element() > 5e-4);
    }

    #[test]
    fn one_roughness_has_one_row() {
        let interface = InterfaceTable::at_roughness(0.02, 1.5, 1.0);
        let rows = Rows::at_roughness(&interface, None, 0.02);
        for alpha in [0.0, 0.02, 0.7, 1.0] {
            assert_eq!(row_of(&rows, alpha).len(), INTERFACE_TEXELS);
        }
        assert_eq!(rows.image().height(), 1);
    }
}
