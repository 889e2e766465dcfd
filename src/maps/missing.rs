//! Pixels without a number.

/// The most places that are kept.
const PLACES: usize = 8;

/// Pixels of a float map in which a value was NaN or infinite. Such a pixel is missing: it takes
/// what the nearest pixel of its row has, or of the nearest row where its own has none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    /// How many pixels.
    pub count: u64,
    /// Column and row of the first of them, from 0 at the top left of the upright picture.
    pub places: Vec<[u32; 2]>,
}

impl Missing {
    /// Finds and fills the missing pixels of `values`, rows of `width` pixels of `channels`.
    pub(super) fn fill(values: &mut [f32], width: usize, channels: usize) -> Self {
        let mut missing = Self::default();
        let stride = width * channels;
        if stride == 0 || values.iter().all(|value| value.is_finite()) {
            return missing;
        }
        let is_missing = |pixel: &[f32]| pixel.iter().any(|value| !value.is_finite());
        // Rows in which nothing is a number, and the last before them in which something was.
        let mut empty: Vec<usize> = Vec::new();
        let mut sound: Vec<usize> = Vec::new();
        for y in 0..values.len() / stride {
            let row = &mut values[y * stride..(y + 1) * stride];
            let there: Vec<usize> = (0..width)
                .filter(|x| !is_missing(&row[x * channels..(x + 1) * channels]))
                .collect();
            if there.is_empty() {
                empty.push(y);
            } else {
                sound.push(y);
            }
            if there.len() == width {
                continue;
            }
            for x in 0..width {
                let after = there.partition_point(|sound| *sound < x);
                if there.get(after) == Some(&x) {
                    continue;
                }
                missing.count += 1;
                if missing.places.len() < PLACES {
                    missing.places.push([x as u32, y as u32]);
                }
                if let Some(from) = nearest(&there, after, x) {
                    row.copy_within(from * channels..(from + 1) * channels, x * channels);
                }
            }
        }
        for y in empty {
            let after = sound.partition_point(|sound| *sound < y);
            match nearest(&sound, after, y) {
                Some(from) => values.copy_within(from * stride..(from + 1) * stride, y * stride),
                None => values[y * stride..(y + 1) * stride].fill(0.0),
            }
        }
        missing
    }
}

/// The one of `there`, rising, that is nearest to `x`, of which `after` is the first beyond it.
fn nearest(there: &[usize], after: usize, x: usize) -> Option<usize> {
    let before = after.checked_sub(1).map(|i| there[i]);
    let beyond = there.get(after).copied();
    match (before, beyond) {
        (Some(before), Some(beyond)) if beyond - x < x - before => Some(beyond),
        (before, beyond) => before.or(beyond),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_pixels_take_their_nearest_neighbour_s() {
        const N: f32 = f32::NAN;
        // Two channels, four columns, three rows.
        let mut values = vec![
            1.0,
            2.0,
            N,
            3.0,
            4.0,
            f32::INFINITY,
            5.0,
            6.0, //
            N,
            N,
            N,
            N,
            0.0,
            N,
            -N,
            N, //
            7.0,
            8.0,
            7.0,
            8.0,
            7.0,
            8.0,
            7.0,
            8.0,
        ];
        let missing = Missing::fill(&mut values, 4, 2);
        assert_eq!(missing.count, 6);
        let places = [[1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [3, 1]];
        assert_eq!(missing.places, places);
        let first = [1.0, 2.0, 1.0, 2.0, 5.0, 6.0, 5.0, 6.0];
        assert_eq!(values[..8], first);
        assert_eq!(values[8..16], first);
        assert_eq!(values[16..], [7.0, 8.0, 7.0, 8.0, 7.0, 8.0, 7.0, 8.0]);
    }

    #[test]
    fn a_map_without_numbers_is_none_and_only_its_first_places_are_kept() {
        let mut values = vec![f32::NEG_INFINITY; 100];
        let missing = Missing::fill(&mut values, 10, 1);
        assert_eq!((missing.count, missing.places.len()), (100, PLACES));
        assert_eq!(values, [0.0; 100]);
        assert_eq!(Missing::fill(&mut values, 10, 1), Missing::default());
        assert_eq!(Missing::fill(&mut [], 0, 3), Missing::default());
    }
}
