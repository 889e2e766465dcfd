//! Width of a stroke of ink or chalk.

use glam::DVec2;

use super::{MeasureError, blur::unblurred, count, finite, positive, spectrum::median};

/// Most cuts across one stroke.
pub const MAX_CUTS: usize = 256;
/// Samples per pixel along a cut.
const PER_PIXEL: f64 = 8.0;
/// Most samples of a cut.
const MAX_SAMPLES: f64 = 8192.0;
/// Share of a section at either end that must be paper.
const PAPER: f64 = 0.15;
/// A stroke is darker than the paper by so many standard deviations of the paper's noise: among
/// the samples of a section some are 3 off.
const VISIBLE: f64 = 5.0;
/// A stroke may run so far off square to the section, in degrees.
const MAX_OBLIQUE_DEG: f64 = 35.0;

/// Where a stroke is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// A place on the stroke, in mm.
    pub middle: DVec2,
    /// Direction across the stroke, of any length.
    pub across: DVec2,
    /// Length of each cut in mm, with paper on both sides of the stroke.
    pub length_mm: f64,
    /// Number of parallel cuts, 1 to [`MAX_CUTS`]; a dozen or more is wise.
    pub cuts: usize,
    /// Length of stroke over which they are spread, in mm.
    pub spread_mm: f64,
}

/// Width of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeWidth {
    /// Full width at half depth in µm, square to the stroke, without the pixels' own width.
    pub width_um: f64,
    /// Standard uncertainty in µm: of the mean of the cuts, and of where the pixels happened to
    /// lie if all cuts met them alike.
    pub sigma_um: f64,
    /// How much darker the stroke is than the paper, in reflectance as sampled.
    pub depth: f64,
    /// How far the stroke runs off square to the section, in degrees.
    pub oblique_deg: f64,
}

/// Measures a stroke in a picture of square pixels of `pixel_mm`. `reflectance` samples it at a
/// place in mm, linearly between pixels.
///
/// The paper's reflectance is a straight line between the medians of both ends. The cuts are laid
/// over each other along the straight line of least squares through the stroke's middles, which
/// samples the stroke more finely than the pixels (as ISO 12233:2017 does with an edge), and the
/// width is read where their mean crosses half its depth.
///
/// A pixel is a mean over its square, and linear interpolation blurs by two squares more; the
/// pixels' rows are taken to lie along the axes. Such a blur leaves the width of a wide stroke at
/// half depth as it is, but widens one of about a pixel. The width is that of the sharp stroke
/// which the blur makes as wide as the one read. A stroke's own soft edge is not touched: one much
/// narrower than two pixels is read too wide by it.
///
/// # Errors
/// No stroke, several, or one that leaves no paper at the ends, runs too obliquely or is narrower
/// than the pixels tell; a section or a sample that is not finite or out of range.
pub fn stroke_width(
    section: Section,
    pixel_mm: f64,
    reflectance: impl Fn(DVec2) -> f64,
) -> Result<StrokeWidth, MeasureError> {
    let pixel = positive("the pixel in mm", pixel_mm)?;
    super::places(&[section.middle, section.across], 2, 2)?;
    let length = positive("the length of the section in mm", section.length_mm)?;
    count("cuts", section.cuts, 1, MAX_CUTS)?;
    let spread = finite("the spread of the cuts in mm", section.spread_mm)?.abs();
    let across = section
        .across
        .try_normalize()
        .ok_or(MeasureError::NotFinite("the direction across"))?;
    let samples = (length / pixel * PER_PIXEL).ceil();
    if !(4.0 * PER_PIXEL..=MAX_SAMPLES).contains(&samples) {
        return Err(MeasureError::Range {
            what: "the length of the section in pixels",
            found: length / pixel,
            allowed: "4 to 1024",
        });
    }
    let n = samples as usize;
    let step = length / (samples - 1.0);
    let offset = |cut: usize| {
        let share = (cut as f64 + 0.5) / section.cuts as f64 - 0.5;
        if section.cuts == 1 {
            0.0
        } else {
            share * spread
        }
    };
    let mut cuts = Vec::with_capacity(section.cuts);
    for cut in 0..section.cuts {
        let middle = section.middle + across.perp() * offset(cut);
        let values = (0..n)
            .map(|i| {
                finite(
                    "a reflectance",
                    reflectance(middle + across * (i as f64 * step - 0.5 * length)),
                )
            })
            .collect::<Result<Vec<_>, _>>()?;
        cuts.push(Cut::new(values)?);
    }
    let runs = median(cuts.iter().map(|cut| cut.runs().len() as f64).collect());
    // Where most cuts show nothing their mean may still show a faint stroke.
    let visible: Vec<usize> = (0..cuts.len()).filter(|&i| cuts[i].visible()).collect();
    if 2 * visible.len() < cuts.len().max(1) {
        let depth = median(cuts.iter().map(Cut::depth).collect());
        let noise = median(cuts.iter().map(|cut| cut.noise).collect());
        return Err(MeasureError::NoStroke { depth, noise });
    }
    if runs > 1.0 {
        return Err(MeasureError::SeveralStrokes(runs as usize));
    }
    let places: Vec<(f64, f64)> = visible
        .iter()
        .map(|&i| (offset(i), cuts[i].middle() * step))
        .collect();
    let (start, slope) = line(&places);
    let oblique_deg = slope.atan().to_degrees();
    if oblique_deg.abs() > MAX_OBLIQUE_DEG {
        return Err(MeasureError::Oblique {
            found_deg: oblique_deg.abs(),
        });
    }
    let shift = |cut: usize| (start + slope * offset(cut)) / step - 0.5 * (n - 1) as f64;
    let mean: Vec<f64> = (0..n)
        .map(|i| {
            let sum: f64 = visible
                .iter()
                .map(|&c| cuts[c].at(i as f64 + shift(c)))
                .sum();
            sum / visible.len() as f64
        })
        .collect();
    let mean = Cut::from_depths(mean);
    let square = oblique_deg.to_radians().cos();
    let read = |cut: &Cut| cut.width().map(|samples| samples * step * square);
    let normal = (across - across.perp() * slope).normalize_or_zero();
    let width = unblurred(read(&mean)?, pixel, normal)?;
    let single: Vec<f64> = visible
        .iter()
        .filter_map(|&c| read(&cuts[c]).ok())
        .collect();
    let sigma = (scatter(&single).powi(2) / visible.len() as f64
        + phase_variance(across, slope, spread, pixel))
    .sqrt();
    Ok(StrokeWidth {
        width_um: 1e3 * width,
        sigma_um: 1e3 * finite("the uncertainty", sigma)?,
        depth: mean.depth(),
        oblique_deg,
    })
}

/// Variance by the place of the pixels in mm²: uniform over a pixel, less what the cuts cover. A
/// stroke along the pixels' rows meets them alike all along its length.
fn phase_variance(across: DVec2, slope: f64, spread: f64, pixel: f64) -> f64 {
    let direction = (across.perp() + slope * across).normalize_or_zero();
    let covered = (direction.abs().min_element() * spread / pixel).min(1.0);
    pixel * pixel / 12.0 * (1.0 - covered).powi(2)
}

/// How much darker than the paper each sample of a cut is.
struct Cut {
    depths: Vec<f64>,
    /// Standard deviation of the paper at both ends.
    noise: f64,
    half: f64,
}

impl Cut {
    fn new(values: Vec<f64>) -> Result<Self, MeasureError> {
        let n = values.len();
        let end = paper(n);
        let left = median(values[..end].to_vec());
        let right = median(values[n - end..].to_vec());
        // The medians stand for the middles of the ends.
        let inner = (n - end) as f64;
        let depth = |(i, v): (usize, f64)| {
            let share = (i as f64 - 0.5 * (end as f64 - 1.0)) / inner;
            left + (right - left) * share - v
        };
        let cut = Self::from_depths(values.into_iter().enumerate().map(depth).collect());
        finite("a reflectance", cut.depth())?;
        if (left - right).abs() > cut.half && cut.visible() {
            return Err(MeasureError::NoPaper);
        }
        Ok(cut)
    }

    fn from_depths(depths: Vec<f64>) -> Self {
        let n = depths.len();
        let end = paper(n);
        let both = depths[..end].iter().chain(&depths[n - end..]);
        let noise = (both.map(|d| d * d).sum::<f64>() / (2 * end) as f64).sqrt();
        // The mean over three samples, so that one does not set the depth. Over half a pixel it
        // would already flatten a stroke of one pixel, which then would be read 8 % too wide.
        let reach = 1;
        let depth = depths
            .windows(2 * reach + 1)
            .map(|w| w.iter().sum::<f64>() / w.len() as f64)
            .fold(0.0, f64::max);
        Self {
            depths,
            noise,
            half: 0.5 * depth,
        }
    }

    fn depth(&self) -> f64 {
        2.0 * self.half
    }

    fn visible(&self) -> bool {
        // Rounding of an even tone is no stroke.
        self.depth() > (VISIBLE * self.noise).max(1e-6)
    }

    /// Linear between the samples, and level beyond the ends.
    fn at(&self, place: f64) -> f64 {
        let last = self.depths.len() - 1;
        let place = place.clamp(0.0, last as f64);
        let i = (place as usize).min(last.saturating_sub(1));
        self.depths[i] + (self.depths[(i + 1).min(last)] - self.depths[i]) * (place - i as f64)
    }

    /// Stretches deeper than half, as (first, behind last). A gap or a stretch of less than half
    /// a pixel is noise at a crossing.
    fn runs(&self) -> Vec<(usize, usize)> {
        let least = (PER_PIXEL / 2.0) as usize;
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for (i, _) in self
            .depths
            .iter()
            .enumerate()
            .filter(|(_, d)| **d > self.half)
        {
            match runs.last_mut() {
                Some(run) if i < run.1 + least => run.1 = i + 1,
                _ => runs.push((i, i + 1)),
            }
        }
        runs.retain(|run| run.1 - run.0 >= least);
        runs
    }

    /// The middle of the stroke in samples: its centroid by depth.
    fn middle(&self) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (first, behind) in self.runs() {
            for i in first..behind {
                sum += i as f64 * self.depths[i];
                weight += self.depths[i];
            }
        }
        if weight > 0.0 {
            sum / weight
        } else {
            0.5 * (self.depths.len() - 1) as f64
        }
    }

    /// Width at half depth in samples.
    fn width(&self) -> Result<f64, MeasureError> {
        let runs = self.runs();
        let &[(first, behind)] = runs.as_slice() else {
            return Err(if runs.is_empty() {
                MeasureError::NoStroke {
                    depth: self.depth(),
                    noise: self.noise,
                }
            } else {
                MeasureError::SeveralStrokes(runs.len())
            });
        };
        let n = self.depths.len();
        if first < paper(n) || behind > n - paper(n) {
            return Err(MeasureError::NoPaper);
        }
        let crossing = |outside: usize, inside: usize| {
            let (a, b) = (self.depths[outside], self.depths[inside]);
            let share = (self.half - a) / (b - a);
            outside as f64 + (inside as f64 - outside as f64) * share
        };
        Ok(crossing(behind, behind - 1) - crossing(first - 1, first))
    }
}

/// Samples at either end of a cut that must be paper.
fn paper(samples: usize) -> usize {
    ((samples as f64 * PAPER) as usize).max(1)
}

/// The straight line of least squares, as (start, slope); level where the places do not tell.
fn line(places: &[(f64, f64)]) -> (f64, f64) {
    let n = places.len().max(1) as f64;
    let mean_x = places.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = places.iter().map(|p| p.1).sum::<f64>() / n;
    let moment: f64 = places.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let spread: f64 = places.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let slope = if spread > 0.0 { moment / spread } else { 0.0 };
    (mean_y - slope * mean_x, slope)
}

/// Standard deviation; 0 of fewer than two.
fn scatter(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::SQRT_2;

    use rand::{SeedableRng as _, rngs::Xoshiro256PlusPlus as Rng};
    use rand_distr::{Distribution as _, StandardNormal};

    /// The error function within 1.5e-7 (M. Abramowitz & I. A. Stegun, *Handbook*, 7.1.26).
    fn erf(x: f64) -> f64 {
        let t = 1.0 / (1.0 + 0.3275911 * x.abs());
        let series = [
            1.061405429,
            -1.453152027,
            1.421413741,
            -0.284496736,
            0.254829592,
        ]
        .into_iter()
        .fold(0.0, |sum, c| (sum + c) * t);
        (1.0 - series * (-x * x).exp()).copysign(x)
    }

    const TOLERANCE: f64 = 0.15;
    const SIDE_MM: f64 = 6.0;

    /// A picture of pixels that are means over their box.
    struct Picture {
        size: usize,
        pixel: f64,
        values: Vec<f64>,
    }

    impl Picture {
        /// `dark` is how much darker than paper a place is.
        fn new(dpi: f64, noise: f64, dark: impl Fn(DVec2) -> f64) -> Self {
            let pixel = 25.4 / dpi;
            let size = (SIDE_MM / pixel) as usize;
            let mut rng = Rng::seed_from_u64(11);
            let sub = 8;
            let values = (0..size * size)
                .map(|i| {
                    let corner = DVec2::new((i % size) as f64, (i / size) as f64);
                    let sum: f64 = (0..sub * sub)
                        .map(|s| {
                            let step = DVec2::new((s % sub) as f64, (s / sub) as f64) + 0.5;
                            dark((corner + step / sub as f64) * pixel)
                        })
                        .sum();
                    let normal: f64 = StandardNormal.sample(&mut rng);
                    0.75 - sum / (sub * sub) as f64 + noise * normal
                })
                .collect();
            Self {
                size,
                pixel,
                values,
            }
        }

        fn at(&self, place: DVec2) -> f64 {
            let place =
                (place / self.pixel - 0.5).clamp(DVec2::ZERO, DVec2::splat((self.size - 2) as f64));
            let (x, y) = (place.x as usize, place.y as usize);
            let (u, v) = (place.x.fract(), place.y.fract());
            let pixel = |x: usize, y: usize| self.values[y * self.size + x];
            (pixel(x, y) * (1.0 - u) + pixel(x + 1, y) * u) * (1.0 - v)
                + (pixel(x, y + 1) * (1.0 - u) + pixel(x + 1, y + 1) * u) * v
        }
    }

    fn middle() -> DVec2 {
        DVec2::new(3.013, 2.971)
    }

    /// A stroke through the middle, with an edge that is normal of this deviation.
    fn stroke(width_um: f64, degrees: f64, soft_um: f64) -> impl Fn(DVec2) -> f64 {
        let normal = DVec2::from_angle(degrees.to_radians()).perp();
        move |p| {
            let s = (p - middle()).dot(normal) * 1e3;
            let edge = |x: f64| {
                if soft_um > 0.0 {
                    erf(x / (SQRT_2 * soft_um))
                } else {
                    x.signum()
                }
            };
            0.3 * 0.5 * (edge(s + 0.5 * width_um) - edge(s - 0.5 * width_um))
        }
    }

    fn section(degrees: f64) -> Section {
        Section {
            middle: middle(),
            across: DVec2::from_angle(degrees.to_radians()).perp(),
            length_mm: 1.8,
            cuts: 24,
            spread_mm: 2.0,
        }
    }

    #[test]
    fn widths_are_within_15_percent() {
        let mut missed = Vec::new();
        for width in [90.0, 150.0, 250.0, 400.0] {
            for dpi in [300.0, 600.0] {
                for degrees in [4.0, 17.0, 33.0, 45.0, 62.0, 80.0, 128.0] {
                    // A soft edge adds to the width of a stroke of about a pixel.
                    for soft in [0.0, 0.08 * width, 0.15 * width] {
                        let picture = Picture::new(dpi, 0.006, stroke(width, degrees, soft));
                        if soft > 0.1 * width && width < 1.5e3 * picture.pixel {
                            continue;
                        }
                        let error =
                            stroke_width(section(degrees), picture.pixel, |p| picture.at(p))
                                .map(|found| found.width_um / width - 1.0);
                        if !error.is_ok_and(|e| e.abs() < TOLERANCE) {
                            missed.push((width, dpi, degrees, soft, error));
                        }
                    }
                }
            }
        }
        assert!(missed.is_empty(), "{missed:?}");
    }

    #[test]
    fn the_pixel_s_own_width_must_be_taken_off() {
        let picture = Picture::new(300.0, 0.0, stroke(90.0, 17.0, 0.0));
        let found = stroke_width(section(17.0), picture.pixel, |p| picture.at(p)).unwrap();
        assert!((found.width_um / 90.0 - 1.0).abs() < TOLERANCE);
        // As if the pixels were points.
        let point = 0.25 * picture.pixel;
        let blurred = stroke_width(section(17.0), point, |p| picture.at(p)).unwrap();
        assert!(blurred.width_um / 90.0 - 1.0 > TOLERANCE, "{blurred:?}");
    }

    #[test]
    fn a_section_off_square_still_gives_the_width() {
        let picture = Picture::new(600.0, 0.006, stroke(250.0, 30.0, 10.0));
        let found = stroke_width(section(50.0), picture.pixel, |p| picture.at(p)).unwrap();
        assert!((found.oblique_deg.abs() - 20.0).abs() < 2.0, "{found:?}");
        assert!((found.width_um / 250.0 - 1.0).abs() < 0.05, "{found:?}");
        let skew = stroke_width(section(70.0), picture.pixel, |p| picture.at(p));
        assert!(skew.is_err(), "{skew:?}");
    }

    #[test]
    fn strokes_along_the_rows_say_that_the_pixels_decide() {
        let at = |degrees: f64| {
            let picture = Picture::new(300.0, 0.0, stroke(250.0, degrees, 0.0));
            stroke_width(section(degrees), picture.pixel, |p| picture.at(p)).unwrap()
        };
        assert!(at(0.0).sigma_um > 20.0 && at(17.0).sigma_um < 15.0);
        assert!((at(0.0).width_um - 250.0).abs() < 2.0 * at(0.0).sigma_um);
    }

    #[test]
    fn no_stroke_several_strokes_and_no_paper_are_told() {
        let measure = |dark: &dyn Fn(DVec2) -> f64| {
            let picture = Picture::new(600.0, 0.01, dark);
            stroke_width(section(17.0), picture.pixel, |p| picture.at(p))
        };
        let one = stroke(200.0, 17.0, 10.0);
        assert!(measure(&one).is_ok());
        assert!(matches!(
            measure(&|_| 0.0),
            Err(MeasureError::NoStroke { .. })
        ));
        let normal = DVec2::from_angle(17f64.to_radians()).perp();
        let two = |p: DVec2| one(p + 0.25 * normal) + one(p - 0.25 * normal);
        assert_eq!(measure(&two), Err(MeasureError::SeveralStrokes(2)));
        let edge = |p: DVec2| {
            if (p - middle()).dot(normal) > 0.1 {
                0.3
            } else {
                0.0
            }
        };
        assert_eq!(measure(&edge), Err(MeasureError::NoPaper));
        let broad = stroke(1500.0, 17.0, 0.0);
        assert!(measure(&broad).is_err());
    }

    #[test]
    fn bad_sections_are_refused() {
        let dark = |p: DVec2| 0.8 - stroke(200.0, 0.0, 10.0)(p);
        let good = section(0.0);
        assert!(stroke_width(good, 0.05, dark).is_ok());
        let bad = [
            Section {
                middle: DVec2::NAN,
                ..good
            },
            Section {
                across: DVec2::ZERO,
                ..good
            },
            Section {
                length_mm: 0.0,
                ..good
            },
            Section {
                length_mm: f64::INFINITY,
                ..good
            },
            Section {
                length_mm: 1e9,
                ..good
            },
            Section { cuts: 0, ..good },
            Section {
                cuts: usize::MAX,
                ..good
            },
            Section {
                spread_mm: f64::NAN,
                ..good
            },
        ];
        for section in bad {
            assert!(stroke_width(section, 0.05, dark).is_err(), "{section:?}");
        }
        for pixel in [0.0, -1.0, f64::NAN, 1e-9, 10.0] {
            assert!(stroke_width(good, pixel, dark).is_err());
        }
        for value in [f64::NAN, f64::INFINITY, 0.0, -3.0, f64::MAX] {
            assert!(stroke_width(good, 0.05, |_| value).is_err(), "{value}");
        }
        assert!(stroke_width(Section { cuts: 1, ..good }, 0.05, dark).is_ok());
    }
}
