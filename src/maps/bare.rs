//! What a picture of a sheet says of its bare paper.

use super::{Level, Pyramid};

/// The level that is looked at has no more texels along its longer edge: single fibres and
/// specks are gone from it.
const EDGE_MAX: u32 = 512;
/// Shares of the texels, from the darkest, between which paper is looked for: ink and what lies
/// around the sheet are darker, the lights of body colour lighter.
const PAPER: [f64; 2] = [0.6, 0.9];

/// Albedo of the bare paper, linear sRGB, from a colour map: the mean of the texels between the
/// 60th and the 90th percentile of luminance, as most of a drawn sheet is paper.
pub fn bare_albedo(pyramid: &Pyramid) -> [f64; 3] {
    let channels = usize::from(pyramid.channels);
    let Some(level) = coarse(pyramid) else {
        return [0.0; 3];
    };
    let mut texels: Vec<[f64; 3]> = (0..level.texels.len() / channels)
        .map(|i| {
            let value = |c: usize| {
                let at = i * channels + c.min(channels - 1);
                f64::from(level.texels.get(at).unwrap_or_default())
            };
            [value(0), value(1), value(2)]
        })
        .collect();
    texels.sort_by(|a, b| luminance(a).total_cmp(&luminance(b)));
    let last = texels.len() - 1;
    let [low, high] = PAPER.map(|share| (share * last as f64).round() as usize);
    let paper = &texels[low..=high];
    std::array::from_fn(|c| paper.iter().map(|texel| texel[c]).sum::<f64>() / paper.len() as f64)
}

/// Mean of the first channel.
pub fn mean_of(pyramid: &Pyramid) -> f64 {
    let last = pyramid.levels.last();
    last.and_then(|level| level.texels.get(0))
        .map_or(0.0, f64::from)
}

fn coarse(pyramid: &Pyramid) -> Option<&Level> {
    let fits = |level: &&Level| level.width.max(level.height) <= EDGE_MAX;
    pyramid.levels.iter().find(fits)
}

fn luminance(rgb: &[f64; 3]) -> f64 {
    crate::colour::luminance(*rgb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::Texels;

    fn picture(values: Vec<u16>, width: u32, height: u32) -> Pyramid {
        Pyramid {
            channels: 4,
            levels: vec![Level {
                width,
                height,
                texels: Texels::Unorm16(values),
            }],
            missing: 0,
        }
    }

    #[test]
    fn ink_and_highlights_do_not_change_what_is_paper() {
        // A third ink, half paper, a few lights.
        let texel = |i: u32| match i {
            0..=32 => [3000, 2000, 1000, 65535],
            33..=94 => [49151, 45875, 39321, 65535],
            _ => [65535; 4],
        };
        let found = bare_albedo(&picture((0..100).flat_map(texel).collect(), 10, 10));
        for (found, expected) in found.iter().zip([0.75, 0.7, 0.6]) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn one_texel_is_all_paper() {
        let one = picture(vec![32768, 16384, 8192, 65535], 1, 1);
        assert!((bare_albedo(&one)[0] - 0.5).abs() < 1e-4);
        assert!((mean_of(&one) - 0.5).abs() < 1e-4);
    }
}
