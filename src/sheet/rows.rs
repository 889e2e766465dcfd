//! What a side's interface, films and paper do, as the shader reads it: rows of texels, the first
//! for what is the same at every roughness, then one for each of many roughnesses.
//!
//! The polynomials over roughness are summed here, in f64, and once. Summed for each pixel they
//! took most of a frame on lavapipe, where a number read from a uniform costs what thirty products
//! cost, and one of a texel half of that. Rows are [`ROWS`] to the range of √α, nearer to each other than the fits are to the
//! truth: half a step changes T by less than 5e-4.

use bevy::{
    asset::RenderAssetUsages,
    image::Image,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use glam::{DVec4, Vec2, Vec4};

use super::uniform::{FilmUniform, SplitUniform};
use crate::optics::{
    ink::{FILM_TERMS, capture_path},
    refraction::{PATH_TERMS, PathTable},
    study::Study,
    table::{ALPHA_FIT_MIN, InterfaceRow, InterfaceTable},
};

/// Rows over √α.
const ROWS: usize = 1024;
/// Texels of a row of the interface: what is the same for all directions; T; E₂.
const INTERFACE_TEXELS: usize = 5;
/// P_c and P behind them.
const PATH_TEXELS: usize = INTERFACE_TEXELS + 1 + PATH_TERMS;
/// The first row, which sides without paths lack: the film, then how light is split.
const TEXELS: usize = 2 * FILM_TERMS + 1 + 6;

/// The rows of one side.
pub struct Rows {
    texels: Vec<Vec4>,
    /// Scale and offset from √α to the row.
    place: Vec2,
    width: usize,
}

impl Rows {
    /// For a side whose roughness differs from spot to spot; with `study`, films and paper too.
    pub fn over_roughness(interface: &InterfaceTable, study: Option<&Study>) -> Self {
        let low = ALPHA_FIT_MIN.sqrt();
        let scale = (ROWS - 1) as f64 / (1.0 - low);
        let alphas = (0..ROWS).map(|k| (low + k as f64 / scale).powi(2));
        Self::new(interface, study, alphas, [scale, -low * scale])
    }

    /// For a side of one roughness (in [0, 1]).
    pub fn at_roughness(interface: &InterfaceTable, study: Option<&Study>, alpha: f64) -> Self {
        Self::new(interface, study, [alpha], [0.0; 2])
    }

    fn new(
        interface: &InterfaceTable,
        study: Option<&Study>,
        alphas: impl IntoIterator<Item = f64>,
        [scale, offset]: [f64; 2],
    ) -> Self {
        let width = if study.is_some() {
            TEXELS
        } else {
            INTERFACE_TEXELS
        };
        let paths = study.map(|study| &*study.film.paths);
        let each = alphas
            .into_iter()
            .map(|alpha| texels(interface, paths, alpha));
        let of_study = study.map(constants);
        let first = f64::from(u8::from(of_study.is_some()));
        let rows = of_study.into_iter().chain(each);
        let texels = rows.flat_map(|mut row| {
            row.resize(width, Vec4::ZERO);
            row
        });
        Self {
            texels: texels.collect(),
            // To the nearest.
            place: Vec2::new(scale as f32, (0.5 + first + offset) as f32),
            width,
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

/// What is the same at every roughness.
fn constants(study: &Study) -> Vec<Vec4> {
    let film = FilmUniform::new(&study.film);
    let split = SplitUniform::new(&study.split);
    let mut texels = [film.excess, film.internal].concat();
    texels.extend([
        film.diffuse_path,
        split.kappa.extend(split.mean),
        split.at_capture.extend(split.depth),
        split.leaning.extend(split.inner_mean),
        split.of_direction,
        Vec4::new(
            split.alike,
            split.captured,
            split.forward_share,
            split.g_forward,
        ),
        Vec4::new(split.g_backward, 0.0, 0.0, 0.0),
    ]);
    texels
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
        texels.reserve(PATH_TEXELS - INTERFACE_TEXELS);
        texels.push(capture_path(paths, alpha));
        texels.extend(paths.row(alpha));
    }
    texels.iter().map(|texel| texel.as_vec4()).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::optics::{
        refraction::{PathRow, path_at},
        slab::Slab,
        table::{fit_root, interface_at},
        tier::Surface,
    };
    use crate::units::Micrometres;

    fn study(interface: &InterfaceTable) -> Study {
        let bare = Surface::new(DVec3::new(0.8, 0.7, 0.5), 0.6, 1.5, 1.0);
        let slab = Slab::rag_paper(Micrometres(165.0));
        Study::new(&bare, interface, PathTable::new(1.5), slab)
    }

    /// The row that the shader reads, in its own precision.
    fn row_of(rows: &Rows, alpha: f32) -> &[Vec4] {
        let s = fit_root(alpha.into()) as f32;
        let y = (s * rows.place.x + rows.place.y) as usize;
        &rows.texels[y * rows.width..][..rows.width]
    }

    #[test]
    fn every_roughness_finds_a_row_of_its_own() {
        let interface = InterfaceTable::new(1.5, 1.0);
        let study = study(&interface);
        let rows = Rows::over_roughness(&interface, Some(&study));
        let paths = &study.film.paths;
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
                (row[5].as_dvec4() - capture_path(paths, alpha))
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
        // With films, those come first.
        let study = study(&interface);
        let rows = Rows::at_roughness(&interface, Some(&study), 0.02);
        assert_eq!(rows.image().height(), 2);
        assert_eq!(rows.texels[0].truncate(), study.film.excess[0].as_vec3());
        let mean = interface.mean_at(0.02).t_mean as f32;
        assert_eq!(row_of(&rows, 0.7)[0].y, mean);
    }
}
