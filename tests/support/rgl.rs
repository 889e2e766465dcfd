//! A measured BRDF in the tensor format of Dupuy & Jakob 2018 (isotropic, RGB), read at the nodes
//! of its own grid, so that nothing is interpolated.
//!
//! A file is `tensor_file\0`, its version, and named fields with type, shape and place. The
//! measured numbers stand over the unit square: a point of it is warped, by the distribution of
//! visible facets, to a facet m, which mirrors the light towards the eye; the number there is
//! fr·μo over the density D(m)/(4σ) of that eye.

use std::{collections::HashMap, f64::consts::PI};

use glam::DVec3;

/// What was measured for one pair of directions.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Number of the light's direction, by its angle.
    pub light: usize,
    /// Unit vectors towards light and eye; z is the normal.
    pub l: DVec3,
    pub v: DVec3,
    /// In sr⁻¹ without the cosine, linear sRGB.
    pub f: DVec3,
}

/// A field of the file.
struct Tensor<'b> {
    shape: Vec<usize>,
    kind: u8,
    bytes: &'b [u8],
}

const UINT8: u8 = 1;
const FLOAT32: u8 = 10;

impl Tensor<'_> {
    fn floats(&self) -> Result<Vec<f64>, String> {
        let words = self.bytes.as_chunks::<4>().0.iter();
        match self.kind {
            FLOAT32 => Ok(words.map(|w| f32::from_le_bytes(*w).into()).collect()),
            kind => Err(format!("type {kind} where 32-bit floats are due")),
        }
    }
}

/// Takes from the front of what is left.
struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Cursor<'b> {
    fn take(&mut self, count: usize) -> Result<&'b [u8], String> {
        let end = self.at.checked_add(count);
        let taken = end.and_then(|end| self.bytes.get(self.at..end));
        self.at += count;
        taken.ok_or_else(|| format!("the file ends at {}", self.bytes.len()))
    }

    fn number(&mut self, bytes: usize) -> Result<usize, String> {
        let little_endian = self.take(bytes)?.iter().rev();
        Ok(little_endian.fold(0, |number, byte| number << 8 | usize::from(*byte)))
    }
}

fn tensors(bytes: &[u8]) -> Result<HashMap<String, Tensor<'_>>, String> {
    let mut cursor = Cursor { bytes, at: 0 };
    if cursor.take(12)? != b"tensor_file\0" {
        return Err("no tensor file".into());
    }
    let version = [cursor.number(1)?, cursor.number(1)?];
    if version != [1, 0] {
        return Err(format!("version {version:?}, not 1.0"));
    }
    let count = cursor.number(4)?;
    let mut found = HashMap::new();
    for _ in 0..count {
        let length = cursor.number(2)?;
        let name = String::from_utf8_lossy(cursor.take(length)?).into_owned();
        let dimensions = cursor.number(2)?;
        let kind = cursor.number(1)? as u8;
        let at = cursor.number(8)?;
        let shape: Vec<usize> = (0..dimensions)
            .map(|_| cursor.number(8))
            .collect::<Result<_, _>>()?;
        let size = if kind == FLOAT32 { 4 } else { 1 };
        let length = size * shape.iter().product::<usize>();
        let mut field = Cursor { bytes, at };
        let tensor = Tensor {
            shape,
            kind,
            bytes: match kind {
                FLOAT32 | UINT8 => field.take(length)?,
                _ => &[],
            },
        };
        found.insert(name, tensor);
    }
    Ok(found)
}

/// Where the share `u` of the area under the polygon through `values`, evenly spaced on [0, 1],
/// ends.
fn warped(values: &[f64], u: f64) -> f64 {
    let spans = values.len() - 1;
    let area = |i: usize| 0.5 * (values[i] + values[i + 1]);
    let mut left = u * (0..spans).map(area).sum::<f64>();
    let mut span = 0;
    while span + 1 < spans && left > area(span) {
        left -= area(span);
        span += 1;
    }
    // a t + (b − a) t²/2 = left.
    let (a, b) = (values[span], values[span + 1]);
    let root = (a * a + 2.0 * (b - a) * left).max(0.0).sqrt();
    let t = (2.0 * left / (a + root).max(1e-300)).min(1.0);
    (span as f64 + t) / spans as f64
}

/// Between the nodes of `values` on [0, 1].
fn between(values: &[f64], x: f64) -> f64 {
    let place = x.clamp(0.0, 1.0) * (values.len() - 1) as f64;
    let i = (place as usize).min(values.len() - 2);
    let t = place - i as f64;
    values[i] * (1.0 - t) + values[i + 1] * t
}

/// Angle from the normal of a place on [0, 1], and back.
fn theta_of(u: f64) -> f64 {
    u * u * PI / 2.0
}

fn u_of(theta: f64) -> f64 {
    (theta * 2.0 / PI).max(0.0).sqrt()
}

/// All readings above the horizon, or what is wrong with the file.
pub fn readings(bytes: &[u8]) -> Result<Vec<Reading>, String> {
    let tensors = tensors(bytes)?;
    let get = |name: &str| tensors.get(name).ok_or_else(|| format!("no field {name}"));
    let lights = get("theta_i")?.floats()?;
    if get("phi_i")?.shape != [1] || get("jacobian")?.bytes != [1] {
        return Err("only isotropic files with a Jacobian are read".into());
    }
    let (rgb, visible) = (get("rgb")?, get("vndf")?);
    let &[1, count, 3, rows, columns] = rgb.shape.as_slice() else {
        return Err(format!("rgb has the shape {:?}", rgb.shape));
    };
    let &[1, visible_count, v_rows, v_columns] = visible.shape.as_slice() else {
        return Err(format!("vndf has the shape {:?}", visible.shape));
    };
    if count != lights.len() || visible_count != count {
        return Err("theta_i, rgb and vndf differ in length".into());
    }
    // Isotropic: both rows are the same.
    let (d, sigma) = (get("ndf")?.floats()?, get("sigma")?.floats()?);
    let (d, sigma) = (&d[..get("ndf")?.shape[1]], &sigma[..get("sigma")?.shape[1]]);
    let (rgb, visible) = (rgb.floats()?, visible.floats()?);
    let mut found = Vec::new();
    for (light, &theta_i) in lights.iter().enumerate() {
        let l = DVec3::new(theta_i.sin(), 0.0, theta_i.cos());
        let slice = &visible[light * v_rows * v_columns..][..v_rows * v_columns];
        let of_row: Vec<f64> = slice
            .chunks(v_columns)
            .map(|row| row.windows(2).map(|two| 0.5 * (two[0] + two[1])).sum())
            .collect();
        for row in 0..rows {
            let y = warped(&of_row, row as f64 / (rows - 1) as f64);
            let place = y * (v_rows - 1) as f64;
            let i = (place as usize).min(v_rows - 2);
            let t = place - i as f64;
            let across: Vec<f64> = (0..v_columns)
                .map(|x| slice[i * v_columns + x] * (1.0 - t) + slice[(i + 1) * v_columns + x] * t)
                .collect();
            for column in 0..columns {
                let x = warped(&across, column as f64 / (columns - 1) as f64);
                let (theta_m, phi_m) = (theta_of(x), (2.0 * y - 1.0) * PI);
                let m = DVec3::new(
                    theta_m.sin() * phi_m.cos(),
                    theta_m.sin() * phi_m.sin(),
                    theta_m.cos(),
                );
                let v = 2.0 * m.dot(l) * m - l;
                if v.z <= 0.0 || l.z <= 0.0 {
                    continue;
                }
                let at = |channel: usize| {
                    let plane = (light * 3 + channel) * rows + row;
                    rgb[plane * columns + column]
                };
                let density = between(d, x) / (4.0 * between(sigma, u_of(theta_i)));
                found.push(Reading {
                    light,
                    l,
                    v,
                    f: DVec3::new(at(0), at(1), at(2)) * density / v.z,
                });
            }
        }
    }
    Ok(found)
}
