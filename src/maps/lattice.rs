//! A display whose profile is a table: the values that show a colour, found by turning the table round.

use glam::{DMat3, DVec3};
use moxcms::TransformF32Executor;
use rayon::prelude::*;

use crate::colour::{self, srgb_encode};

/// Places along each edge of a lattice.
pub const LATTICE_STEPS: usize = 33;
/// Of a colour's encoded difference; a quarter of an 8-bit step.
const CLOSE: f64 = 1e-3;
const ITERATIONS: usize = 40;
/// Steps from the lowest value to the highest.
const CODES: f64 = 255.0;

/// The values of a display's channels over colours in linear sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// 0 to 1, [`LATTICE_STEPS`] to each of red, green and blue, red fastest, at equal steps of the
    /// square root of the light.
    pub values: Vec<[f32; 3]>,
}

impl Lattice {
    /// Turns a table round. `table` goes from a display's values to a linear space, and
    /// `linear_from_table` from there to linear sRGB, adapted to the white of `white_xy`, which is
    /// the display's own.
    ///
    /// White is the white of sRGB, as bright as the display can show it; a colour that it cannot
    /// show becomes the nearest that it can.
    ///
    /// # Errors
    /// What is wrong with the table.
    pub(super) fn invert(
        table: &TransformF32Executor,
        linear_from_table: DMat3,
        white_xy: [f64; 2],
    ) -> Result<Self, String> {
        let own_white = colour::linear_from_xyz_matrix()
            * colour::bradford(colour::D65, white_xy)
            * colour::linear_from_xyz_matrix().inverse();
        let display = Display {
            table,
            linear: own_white * linear_from_table,
        };
        let (black, _) = display.shown(DVec3::ZERO)?;
        let (white, _) = display.shown(DVec3::ONE)?;
        if !(black.is_finite() && white.is_finite() && white.min_element() > black.max_element()) {
            return Err(format!(
                "its table makes {white:.2} of white and {black:.2} of black"
            ));
        }
        let brightest = display.brightest()?;
        let edge = (LATTICE_STEPS - 1) as f64;
        let rows: Result<Vec<_>, String> = (0..LATTICE_STEPS * LATTICE_STEPS)
            .into_par_iter()
            .map(|row| {
                let place = |k: usize| (k as f64 / edge).powi(2);
                let [green, blue] = [row % LATTICE_STEPS, row / LATTICE_STEPS].map(place);
                let row = (0..LATTICE_STEPS).map(|red| {
                    let meant = brightest * DVec3::new(place(red), green, blue);
                    let (values, _) = display.nearest(meant)?;
                    Ok(values.as_vec3().to_array())
                });
                row.collect::<Result<Vec<_>, String>>()
            })
            .collect();
        Ok(Self {
            values: rows?.concat(),
        })
    }

    /// The display's values, 0 to 1, for a colour in linear sRGB.
    pub fn encode(&self, linear: [f64; 3]) -> [f64; 3] {
        let edge = (LATTICE_STEPS - 1) as f64;
        let place = linear.map(|v| v.clamp(0.0, 1.0).sqrt() * edge);
        let low = place.map(|p| p.floor().min(edge - 1.0));
        let part = [0, 1, 2].map(|k| place[k] - low[k]);
        let mut value = [0.0; 3];
        for corner in 0..8_usize {
            let mut weight = 1.0;
            let mut at = 0;
            for k in [2, 1, 0] {
                let above = corner >> k & 1;
                weight *= if above == 1 { part[k] } else { 1.0 - part[k] };
                at = at * LATTICE_STEPS + low[k] as usize + above;
            }
            for (sum, v) in value.iter_mut().zip(self.values[at]) {
                *sum += weight * f64::from(v);
            }
        }
        value
    }
}

/// A display as its table says.
struct Display<'a> {
    table: &'a TransformF32Executor,
    /// From the table's space to linear sRGB.
    linear: DMat3,
}

impl Display<'_> {
    /// The colour in linear sRGB that values make, and its slope along each of them: between
    /// whole 8-bit values it is straight, as the engine takes the nearest entry of a table's input curves,
    /// which are seldom finer.
    fn shown(&self, values: DVec3) -> Result<(DVec3, DMat3), String> {
        let place = values * CODES;
        let low = place.floor().min(DVec3::splat(CODES - 1.0));
        let part = place - low;
        let mut from = [0.0; 24];
        for (corner, from) in from.chunks_exact_mut(3).enumerate() {
            let above = [0, 1, 2].map(|k| (corner >> k & 1) as f64);
            let values = (low + DVec3::from(above)) / CODES;
            from.copy_from_slice(&values.as_vec3().to_array());
        }
        let mut to = [0.0; 24];
        self.table
            .transform(&from, &mut to)
            .map_err(|error| error.to_string())?;
        let mut shown = DVec3::ZERO;
        let mut slopes = [DVec3::ZERO; 3];
        for (corner, to) in to.chunks_exact(3).enumerate() {
            let colour = self.linear * DVec3::from_slice(&[0, 1, 2].map(|k| f64::from(to[k])));
            let is_above = |k: usize| corner >> k & 1 == 1;
            let weight = |k: usize| if is_above(k) { part[k] } else { 1.0 - part[k] };
            shown += weight(0) * weight(1) * weight(2) * colour;
            for (k, slope) in slopes.iter_mut().enumerate() {
                let side = if is_above(k) { CODES } else { -CODES };
                *slope += side * weight((k + 1) % 3) * weight((k + 2) % 3) * colour;
            }
        }
        Ok((shown, DMat3::from_cols(slopes[0], slopes[1], slopes[2])))
    }

    /// The brightest white of sRGB that is shown as such, as a share of the display's own white.
    fn brightest(&self) -> Result<f64, String> {
        let is_shown = |share: f64| Ok::<_, String>(self.nearest(DVec3::splat(share))?.1 < CLOSE);
        if is_shown(1.0)? {
            return Ok(1.0);
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..16 {
            let middle = 0.5 * (low + high);
            if is_shown(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
        match low > 0.25 {
            true => Ok(low),
            false => Err("its table shows no neutral white brighter than a quarter".into()),
        }
    }

    /// The values that come nearest to a colour, and how far they are from it, by encoded
    /// components, where equal differences look about equal: Levenberg and Marquardt's steps, kept
    /// in the cube of values.
    fn nearest(&self, meant: DVec3) -> Result<(DVec3, f64), String> {
        let meant = encoded(meant);
        let mut values = meant.clamp(DVec3::ZERO, DVec3::ONE);
        let mut damping = 1e-4;
        let mut off = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let (here, slopes) = self.shown(values)?;
            let residual = encoded(here) - meant;
            off = residual.length();
            let jacobian = DMat3::from_diagonal(encoded_slope(here)) * slopes;
            let gradient = jacobian.transpose() * residual;
            // A value at its end that would leave the cube stays there.
            let free = [0, 1, 2].map(|k| {
                let leaves = (values[k] <= 0.0 && gradient[k] > 0.0)
                    || (values[k] >= 1.0 && gradient[k] < 0.0);
                if leaves { 0.0 } else { 1.0 }
            });
            let free = DVec3::from(free);
            if (gradient * free).abs().max_element() < 1e-9 {
                break;
            }
            let among_free = DMat3::from_diagonal(free);
            let normal = among_free * (jacobian.transpose() * jacobian) * among_free;
            let mut moved = false;
            while damping < 1e6 {
                let damped = normal + DMat3::from_diagonal(DVec3::splat(damping) + 1.0 - free);
                let next =
                    (values - damped.inverse() * (gradient * free)).clamp(DVec3::ZERO, DVec3::ONE);
                let trial = (encoded(self.shown(next)?.0) - meant).length();
                if next.is_finite() && trial < off {
                    moved = (next - values).abs().max_element() > 1e-7;
                    (values, off) = (next, trial);
                    damping = (damping * 0.1).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            if !moved {
                break;
            }
        }
        Ok((values, off))
    }
}

fn encoded(linear: DVec3) -> DVec3 {
    linear.to_array().map(srgb_encode).into()
}

/// The derivative of [`encoded`] by each component.
fn encoded_slope(linear: DVec3) -> DVec3 {
    const STEP: f64 = 1e-6;
    (encoded(linear + STEP) - encoded(linear - STEP)) / (2.0 * STEP)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use moxcms::{
        ColorProfile, DataColorSpace, LutDataType, LutStore, LutType, LutWarehouse, Matrix3d,
    };

    use super::*;
    use crate::{
        colour::{SRGB_PRIMARIES, delta_e00, lab_from_linear, xyz_from_rgb_matrix},
        maps::{DisplayProfile, MapError},
    };

    const WHITE_XY: [f64; 2] = [0.30, 0.31];
    const POINTS: usize = 33;

    /// A panel whose channels take light from each other and follow different curves: nothing that
    /// curves and primaries can say. CIE XYZ of values, Y = 1 for its white.
    fn panel(values: [f64; 3]) -> DVec3 {
        let [r, g, b] = values;
        let light = DVec3::new(r.powf(2.0), g.powf(2.2), b.powf(2.5));
        let taken = DVec3::new(g * b, r * b, r * g) * DVec3::new(0.06, 0.10, 0.14);
        // White stays white.
        let light = light * (1.0 - taken) / (1.0 - DVec3::new(0.06, 0.10, 0.14));
        xyz_from_rgb_matrix(SRGB_PRIMARIES, WHITE_XY) * (0.002 + 0.998 * light)
    }

    /// Its profile, as a colorimeter's software writes it: a table of XYZ under D50 behind curves that
    /// spread the dark.
    fn profile(panel: impl Fn([f64; 3]) -> DVec3) -> Vec<u8> {
        let to_d50 = colour::bradford(WHITE_XY, colour::D50);
        let edge = (POINTS - 1) as f64;
        let mut clut = Vec::new();
        for at in 0..POINTS.pow(3) {
            let places = [at / (POINTS * POINTS), at / POINTS % POINTS, at % POINTS];
            let xyz = to_d50 * panel(places.map(|place| (place as f64 / edge).powf(1.0 / 2.2)));
            clut.extend(xyz.to_array().map(|v| (v * 32768.0).round() as u16));
        }
        let steps = 256;
        let curve = (0..steps).map(|i| (f64::from(i) / f64::from(steps - 1)).powf(2.2));
        let curve: Vec<u16> = curve.map(|v| (v * 65535.0).round() as u16).collect();
        let mut profile = ColorProfile::new_srgb();
        profile.pcs = DataColorSpace::Xyz;
        let white = DVec3::from(colour::white_xyz(WHITE_XY));
        profile.media_white_point = Some(moxcms::Xyzd {
            x: white.x,
            y: white.y,
            z: white.z,
        });
        profile.chromatic_adaptation = None;
        profile.lut_a_to_b_colorimetric = Some(LutWarehouse::Lut(LutDataType {
            num_input_channels: 3,
            num_output_channels: 3,
            num_clut_grid_points: POINTS as u8,
            matrix: Matrix3d::IDENTITY,
            num_input_table_entries: steps as u16,
            num_output_table_entries: 2,
            input_table: LutStore::Store16(curve.repeat(3)),
            clut_table: LutStore::Store16(clut),
            output_table: LutStore::Store16([0, 65535].repeat(3)),
            lut_type: LutType::Lut16,
        }));
        profile.encode().unwrap()
    }

    fn read(bytes: &[u8]) -> Result<DisplayProfile, MapError> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        DisplayProfile::read(file.path())
    }

    /// ΔE00 of what `panel` makes of `values` from what was meant at its brightest.
    fn off(meant: [f64; 3], values: [f64; 3], brightest: f64) -> f64 {
        let shown = colour::linear_from_xyz_matrix() * panel(values) / brightest;
        delta_e00(lab_from_linear(meant), lab_from_linear(shown.into()))
    }

    #[test]
    fn colours_meant_are_colours_shown_on_a_panel_whose_channels_interact() {
        let Ok(DisplayProfile::Table(lattice)) = read(&profile(panel)) else {
            panic!("a table was expected: {:?}", read(&profile(panel)));
        };
        let white = lattice.encode([1.0; 3]);
        assert!(
            white.iter().any(|v| *v > 0.999),
            "as bright as it goes: {white:?}"
        );
        let brightest = (colour::linear_from_xyz_matrix() * panel(white)).element_sum() / 3.0;
        let (mut worst, mut sum) = (0.0_f64, 0.0);
        for r in [0.03, 0.1, 0.2, 0.45, 0.8] {
            for g in [0.03, 0.09, 0.21, 0.5, 0.77] {
                for b in [0.03, 0.11, 0.3, 0.6, 0.81] {
                    // What every display can show: no colour near its gamut's edge.
                    let meant = [r, g, b].map(|v| 0.5 * v + 0.5 * g);
                    let off = off(meant, lattice.encode(meant), brightest);
                    worst = worst.max(off);
                    sum += off / 125.0;
                }
            }
        }
        // The worst is the darkest, in the first cell of the profile's own table.
        assert!(worst < 1.0 && sum < 0.15, "ΔE00 {worst}, mean {sum}");
        // Without the table they are far off.
        let raw = off([0.4; 3], [0.4; 3].map(srgb_encode), brightest);
        assert!(raw > 2.0, "{raw}");
    }

    #[test]
    fn what_a_display_cannot_show_stays_in_its_values() {
        let Ok(DisplayProfile::Table(lattice)) = read(&profile(panel)) else {
            panic!("a table was expected: {:?}", read(&profile(panel)));
        };
        let sound = |v: &f64| (0.0..=1.0).contains(v);
        for colour in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [9.0, -1.0, 0.5]] {
            let values = lattice.encode(colour);
            assert!(values.iter().all(sound), "{colour:?}: {values:?}");
        }
        let [red, green, blue] = lattice.encode([1.0, 0.0, 0.0]);
        assert!(red > 0.9 && green < 0.3 && blue < 0.3);
    }

    #[test]
    fn a_table_that_shows_nothing_is_refused() {
        for dead in [DVec3::ZERO, DVec3::splat(0.5)] {
            let error = read(&profile(|_| dead)).unwrap_err();
            let MapError::Profile { path, detail } = error else {
                panic!("{error}");
            };
            assert_ne!(path, Path::new(""));
            assert!(detail.contains("table"), "{detail}");
        }
        // A display that has no blue at all has no white of sRGB.
        let yellow = |[r, g, _]: [f64; 3]| {
            xyz_from_rgb_matrix(SRGB_PRIMARIES, WHITE_XY) * DVec3::new(r, g, 0.01)
        };
        assert!(read(&profile(yellow)).is_err());
    }
}
