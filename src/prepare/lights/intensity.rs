//! How bright lamps are in comparison with each other, where nobody has photographed a grey card.
//!
//! What a lamp of intensity e gives at a place of albedo ρ and normal n is e ρ n·l. Intensities
//! and normals are told apart by what is known of a sheet: it lies flat on the whole, so that the
//! middle of all its normals is that of the table. From there both are found in turn by least
//! squares (each is linear when the other is known), which takes the sheet's own shape out.

use glam::{DMat3, DVec3};

/// Turns of the alternation; each leaves a tenth of what was missing, or less.
const TURNS: usize = 30;

/// Relative intensities, their mean 1, of lamps in `directions` that gave these grey values:
/// `samples` holds one value for each lamp, for each of many places.
///
/// Returns `None` where no place is lit by all lamps.
pub fn solve(directions: &[DVec3], samples: &[Vec<f64>]) -> Option<Vec<f64>> {
    let count = directions.len();
    let lit: Vec<&Vec<f64>> = samples
        .iter()
        .filter(|values| values.len() == count && values.iter().all(|v| *v > 0.0 && v.is_finite()))
        .collect();
    if lit.is_empty() || count < 3 {
        return None;
    }
    let mut intensities: Vec<f64> = (0..count)
        .map(|i| {
            let mut ratios: Vec<f64> = lit
                .iter()
                .map(|values| values[i] * count as f64 / values.iter().sum::<f64>())
                .collect();
            middle(&mut ratios) / directions[i].z.max(1e-3)
        })
        .collect();
    normalise(&mut intensities);
    for _ in 0..TURNS {
        let effective: Vec<DVec3> = directions
            .iter()
            .zip(&intensities)
            .map(|(l, e)| *l * *e)
            .collect();
        let mut gram = DMat3::ZERO;
        for a in &effective {
            gram += DMat3::from_cols(*a * a.x, *a * a.y, *a * a.z);
        }
        let inverse = gram.inverse();
        if !inverse.is_finite() {
            break;
        }
        let (mut along, mut square) = (vec![0.0; count], vec![0.0; count]);
        for values in &lit {
            let right: DVec3 = effective.iter().zip(*values).map(|(a, v)| *a * *v).sum();
            let facing = inverse * right;
            // Each place counts alike, however dark.
            let weight = facing.length_squared().max(1e-12).recip();
            for (i, l) in directions.iter().enumerate() {
                let shown = l.dot(facing);
                along[i] += values[i] * shown * weight;
                square[i] += shown * shown * weight;
            }
        }
        for (i, intensity) in intensities.iter_mut().enumerate() {
            if square[i] > 0.0 && along[i] > 0.0 {
                *intensity = along[i] / square[i];
            }
        }
        normalise(&mut intensities);
    }
    Some(intensities)
}

/// Brings their mean to 1.
pub(in crate::prepare) fn normalise(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value /= mean);
}

fn middle(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
