//! Laid and chain lines: what the papermaker's mould left in a sheet, and how far apart.
//!
//! Laid lines are found as a sharp peak of the power spectrum. There are too few chain lines for
//! that: the area is averaged along them, square to the laid lines, and a comb fitted.

use glam::DVec2;

use super::{
    comb::{Comb, MIN_PERIODS, comb},
    raster::{Cleaned, Raster},
    spectrum::{Peak, Spectrum, median},
};

/// Spacings that are searched for laid lines, in mm.
pub const LAID_MM: [f64; 2] = [0.45, 2.2];
/// Spacings that are searched for chain lines, in mm.
pub const CHAIN_MM: [f64; 2] = [14.0, 42.0];
/// Largest pixel that shows the narrowest laid lines without folding finer ones onto them, in mm.
const COARSEST_MM: f64 = 0.2;
/// Shortest side of an area, in mm: a dozen of common laid lines.
const SHORTEST_MM: f64 = 12.0;
/// Pixels in which laid and chain lines are sought, in mm.
const LAID_PIXEL_MM: f64 = 0.13;
const CHAIN_PIXEL_MM: f64 = 0.26;
/// Half the side of the square whose mean is the paper's shade, in mm: more than a laid line's
/// spacing, or a chain line's width, and less than stains and clouds.
const LAID_SHADE_MM: f64 = 1.6;
const CHAIN_SHADE_MM: f64 = 3.0;
/// A peak is that of the writing if the places left out have one there of at least this share of
/// its height over the background. (Laid lines themselves move the edges of what is left out.)
const OF_WRITING: f64 = 0.5;
/// Lines are reported from this significance on: some ten thousand places of a spectrum are
/// looked at, and paper is not as even as noise.
pub const SIGNIFICANT: f64 = 6.0;
/// A laid peak must also be so many times its background, however long it was averaged.
const LEAST_RATIO: f64 = 5.0;
/// Below this share of bare paper too little is left between the strokes.
const LEAST_BARE: f64 = 0.25;
/// Chain lines are reported from this significance on: the trials are the directions times the
/// spacings, and clouds of pulp, of which few fit into a page, have reached 8.4.
pub const CHAIN_SIGNIFICANT: f64 = 9.0;
/// Chain lines' marks are alike by so many standard errors.
const STEADY: f64 = 3.0;
/// Chain lines are sought within this of square to the laid lines, in degrees.
const SQUARE_DEG: f64 = 3.0;
/// Steps of their direction smear a chain line by this at the ends, in mm.
const SMEAR_MM: f64 = 0.5;

/// Parallel lines in the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lines {
    /// Distance from line to line, in mm.
    pub spacing_mm: f64,
    /// Standard uncertainty of the spacing, in mm. That of the map's scale is not in it.
    pub sigma_mm: f64,
    /// Direction the lines run in, in degrees from the side's x axis towards its y axis (so
    /// clockwise as seen), in −90 < d ≤ 90.
    pub direction_deg: f64,
    /// Standard uncertainty of the direction, in degrees.
    pub direction_sigma_deg: f64,
    /// Significance in standard deviations of the noise; at least [`SIGNIFICANT`],
    /// of chain lines [`CHAIN_SIGNIFICANT`].
    pub significance: f64,
}

/// Why no lines are reported.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoLines {
    /// The map does not resolve them.
    #[error("the map's pixel of {0:.3} mm is too coarse: this needs {COARSEST_MM} mm or less")]
    Coarse(f64),
    /// The area is too small.
    #[error("the area is {found_mm:.0} mm across: this needs {needed_mm:.0} mm")]
    Small { found_mm: f64, needed_mm: f64 },
    /// Hardly any bare paper in the area.
    #[error("only {:.0} % of the area is bare paper; choose one with less drawing", 100.0 * .0)]
    Covered(f64),
    /// Nothing in the area stands out of its noise.
    #[error("no lines: the best candidate has {found:.1} σ, and {needed} σ are needed")]
    Faint { found: f64, needed: f64 },
    /// Chain lines are square to laid lines, of which there are none.
    #[error("no laid lines to be square to")]
    NoLaid,
    /// The best chain lines are a few marks at equal distances, without the others.
    #[error("marks {0:.1} mm apart are too unlike each other for chain lines")]
    Uneven(f64),
    /// The best chain lines are every other mark, or the like, of something finer.
    #[error("the area has marks every {0:.1} mm, too near for chain lines")]
    Finer(f64),
}

/// The lines of the mould in an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mould {
    pub laid: Result<Lines, NoLines>,
    pub chain: Result<Lines, NoLines>,
}

/// Finds laid and chain lines in an area. Transmission shows them best; albedo will do where they
/// are seen in it. Writing and specks are left out first.
pub fn mould_lines(raster: &Raster) -> Mould {
    let laid = laid(raster);
    Mould {
        laid,
        chain: match laid {
            Ok(laid) => chain(raster, laid.direction_deg),
            Err(NoLines::Faint { .. }) => Err(NoLines::NoLaid),
            Err(reason) => Err(reason),
        },
    }
}

fn laid(raster: &Raster) -> Result<Lines, NoLines> {
    if raster.mm_per_pixel() > COARSEST_MM {
        return Err(NoLines::Coarse(raster.mm_per_pixel()));
    }
    let [width, height] = raster.size_mm();
    if width.min(height) < SHORTEST_MM {
        return Err(NoLines::Small {
            found_mm: width.min(height),
            needed_mm: SHORTEST_MM,
        });
    }
    let field = bare(raster.coarser(LAID_PIXEL_MM), LAID_SHADE_MM)?;
    let spectrum = Spectrum::new(&field);
    let band = [LAID_MM[1].recip(), LAID_MM[0].recip()];
    let gaps = field.gaps(LAID_SHADE_MM);
    let writing = Spectrum::new(&gaps);
    let peaks: Vec<Peak> = spectrum
        .peaks(band)
        .into_iter()
        .filter(|peak| writing.near(peak.f).ratio < OF_WRITING * peak.ratio)
        .collect();
    let significant = |p: &Peak| p.z >= SIGNIFICANT && p.ratio >= LEAST_RATIO;
    // A peak that is significant and yet too low counts as just not enough.
    let found = peaks.first().map_or(0.0, |p| p.z.min(SIGNIFICANT));
    let best = *peaks
        .iter()
        .find(|p| significant(p))
        .ok_or(NoLines::Faint {
            found,
            needed: SIGNIFICANT,
        })?;
    // Lines that are not a plain wave have harmonics, of which one may be the strongest.
    let near = 2.0 * spectrum.resolution().max_element();
    let fundamental = peaks
        .iter()
        .filter(|p| significant(p))
        .find(|p| (2.0 * p.f).distance(best.f) < near || (2.0 * p.f).distance(-best.f) < near);
    let peak = fundamental.copied().unwrap_or(best);
    let (f, sigma) = spectrum.refined(peak);
    let spacing_mm = f.length().recip();
    // dP = P² df along f.
    let sigma_mm = spacing_mm.powi(2) * (f.normalize_or_zero() * sigma).length();
    Ok(Lines {
        spacing_mm,
        sigma_mm,
        direction_deg: along(f),
        direction_sigma_deg: (f.perp().normalize_or_zero() * sigma)
            .length()
            .atan2(f.length())
            .to_degrees(),
        significance: peak.z,
    })
}

fn chain(raster: &Raster, laid_deg: f64) -> Result<Lines, NoLines> {
    let field = bare(raster.coarser(CHAIN_PIXEL_MM), CHAIN_SHADE_MM)?;
    let across = DVec2::from_angle(laid_deg.to_radians());
    let [width, height] = raster.size_mm();
    let extent = |d: DVec2| width * d.x.abs() + height * d.y.abs();
    let needed_mm = MIN_PERIODS * CHAIN_MM[0];
    if extent(across) < needed_mm {
        return Err(NoLines::Small {
            found_mm: extent(across),
            needed_mm,
        });
    }
    let step = (2.0 * SMEAR_MM / extent(across.perp())).min(0.01);
    let steps = (SQUARE_DEG.to_radians() / step).ceil() as i32;
    // The direction is that in which the lines are least smeared, so have most power.
    let mut best: Option<(Comb, DVec2)> = None;
    for i in -steps..=steps {
        let normal = DVec2::from_angle(laid_deg.to_radians() + f64::from(i) * step);
        let row = averaged(&field, normal);
        if let Some(found) = comb(&row, field.mm_per_pixel, CHAIN_MM)
            && best.is_none_or(|(b, _)| found.power > b.power)
        {
            best = Some((found, normal));
        }
    }
    let (found, normal) = best.ok_or(NoLines::Faint {
        found: 0.0,
        needed: CHAIN_SIGNIFICANT,
    })?;
    if found.z < CHAIN_SIGNIFICANT {
        return Err(NoLines::Faint {
            found: found.z,
            needed: CHAIN_SIGNIFICANT,
        });
    }
    if found.steadiness < STEADY {
        return Err(NoLines::Uneven(found.spacing_mm));
    }
    if let Some(short) = found.multiple_of_mm {
        return Err(NoLines::Finer(short));
    }
    Ok(Lines {
        spacing_mm: found.spacing_mm,
        sigma_mm: found.sigma_mm,
        direction_deg: along(normal),
        // Of the directions that were tried one is the best: uniform over a step.
        direction_sigma_deg: (step / 12f64.sqrt()).to_degrees(),
        significance: found.z,
    })
}

fn bare(raster: Raster, shade_mm: f64) -> Result<Cleaned, NoLines> {
    let field = raster.cleaned(shade_mm);
    if field.bare() < LEAST_BARE {
        return Err(NoLines::Covered(field.bare()));
    }
    Ok(field)
}

/// Means of the bare paper along lines square to `normal`, in steps of a pixel. The corners of a
/// turned area, where lines are short, are left at 0, and so are lines full of ink.
fn averaged(field: &Cleaned, normal: DVec2) -> Vec<f64> {
    let corner = |d: f64, n: usize| (d * n as f64).min(0.0);
    let start = corner(normal.x, field.width) + corner(normal.y, field.height);
    let length = normal.x.abs() * field.width as f64 + normal.y.abs() * field.height as f64;
    let bins = length.ceil() as usize + 1;
    let mut sums = vec![(0.0, 0.0); bins];
    for (y, row) in field.values.chunks_exact(field.width).enumerate() {
        let line_start = normal.y * (y as f64 + 0.5) - start;
        for (x, &value) in row.iter().enumerate() {
            let bin = ((line_start + normal.x * (x as f64 + 0.5)) as usize).min(bins - 1);
            if field.paper[y * field.width + x] {
                sums[bin].0 += f64::from(value);
                sums[bin].1 += 1.0;
            }
        }
    }
    let enough = 0.3 * median(sums.iter().map(|s| s.1).collect());
    let mean = |(sum, weight): (f64, f64)| {
        if weight > enough.max(0.5) {
            sum / weight
        } else {
            0.0
        }
    };
    sums.into_iter().map(mean).collect()
}

/// Direction in degrees of lines whose normal is `f`.
fn along(f: DVec2) -> f64 {
    let degrees = f.x.atan2(-f.y).to_degrees();
    if degrees > 90.0 {
        degrees - 180.0
    } else if degrees <= -90.0 {
        degrees + 180.0
    } else {
        degrees
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    use rand::{RngExt as _, SeedableRng as _, rngs::Xoshiro256PlusPlus as Rng};
    use rand_distr::{Distribution as _, StandardNormal};

    const LAID: f64 = 1.05;
    const CHAIN: f64 = 24.0;
    /// What the brief of the exhibition asks for.
    const LAID_TOLERANCE: f64 = 0.01;
    const CHAIN_TOLERANCE: f64 = 0.02;

    /// A page of 160 × 120 mm on a light table.
    #[derive(Clone, Copy)]
    struct Page {
        laid: f64,
        chain: f64,
        skew_deg: f64,
        noise: f64,
        writing: bool,
        /// Shift of the lines by cockling, in mm.
        bend: f64,
        pixel: f64,
        seed: u64,
    }

    const CLEAN: Page = Page {
        laid: 0.06,
        chain: 0.08,
        skew_deg: 0.0,
        noise: 0.01,
        writing: false,
        bend: 0.0,
        pixel: 0.125,
        seed: 1,
    };

    /// Lines of text 7 mm apart, each of slanting minims.
    fn write(values: &mut [f32], width: usize, height: usize, pixel: f64, rng: &mut Rng) {
        let mut dab = |at: DVec2| {
            let (x, y) = ((at.x / pixel) as usize, (at.y / pixel) as usize);
            for j in y..(y + 3).min(height) {
                for value in values[j * width..(j + 1) * width]
                    .iter_mut()
                    .skip(x)
                    .take(3)
                {
                    *value = value.min(0.12);
                }
            }
        };
        let mut line = 9.0;
        while line < height as f64 * pixel - 6.0 {
            let mut x = 8.0;
            while x < width as f64 * pixel - 10.0 {
                let tall = if rng.random_bool(0.2) { 4.0 } else { 2.2 };
                for i in 0..60 {
                    let s = f64::from(i) / 60.0;
                    dab(DVec2::new(x + 0.9 * s, line - tall * s));
                }
                x += if rng.random_bool(0.15) {
                    3.5
                } else {
                    rng.random_range(0.8..1.5)
                };
            }
            line += 7.0;
        }
    }

    fn raster(page: Page) -> Raster {
        let (width, height) = ((160.0 / page.pixel) as usize, (120.0 / page.pixel) as usize);
        let mut rng = Rng::seed_from_u64(page.seed);
        let laid_along = DVec2::from_angle(page.skew_deg.to_radians());
        let lattice: Vec<f64> = (0..60 * 60).map(|_| rng.random_range(-1.0..1.0)).collect();
        // Clouds of pulp some 5 mm across, with no period.
        let clouds = |at: DVec2| {
            // Turned, so that the lattice shows in no direction that is searched.
            let place = DVec2::from_angle(0.6).rotate(at) / 5.0 + DVec2::new(16.0, 2.0);
            let (x, y) = (place.x as usize, place.y as usize);
            let share = place.fract() * place.fract() * (3.0 - 2.0 * place.fract());
            let row = |y: usize| {
                let (a, b) = (lattice[y * 60 + x], lattice[y * 60 + x + 1]);
                a + (b - a) * share.x
            };
            row(y) + (row(y + 1) - row(y)) * share.y
        };
        let mut values: Vec<f32> = (0..width * height)
            .map(|i| {
                let at = (DVec2::new((i % width) as f64, (i / width) as f64) + 0.5) * page.pixel;
                let bend = page.bend * (at.x * 0.11 + 1.0).sin() * (at.y * 0.13).cos();
                let laid = (TAU * (at.dot(laid_along.perp()) + bend) / LAID).cos();
                let off = ((at.dot(laid_along) + 5.0) / CHAIN).rem_euclid(1.0) - 0.5;
                let chain = (-(off * CHAIN / 0.55).powi(2)).exp();
                let cloud = 0.12 * clouds(at);
                let normal: f64 = StandardNormal.sample(&mut rng);
                let lines = page.laid * laid + page.chain * chain;
                (0.55 * (1.0 + lines + cloud) + page.noise * normal) as f32
            })
            .collect();
        if page.writing {
            write(&mut values, width, height, page.pixel, &mut rng);
        }
        Raster::new(width, height, values, page.pixel).unwrap()
    }

    fn near(found: Lines, spacing: f64, tolerance: f64, direction: f64, turn: f64) -> bool {
        let turned = (found.direction_deg - direction + 90.0).rem_euclid(180.0) - 90.0;
        (found.spacing_mm / spacing - 1.0).abs() < tolerance && turned.abs() < turn
    }

    fn check(name: &str, page: Page) {
        let found = mould_lines(&raster(page));
        let laid = found.laid.unwrap_or_else(|e| panic!("{name}: laid: {e}"));
        let chain = found.chain.unwrap_or_else(|e| panic!("{name}: chain: {e}"));
        println!("{name}: {laid:?} {chain:?}");
        // Bent lines have no single direction.
        let turn = if page.bend > 0.0 { 1.0 } else { 0.3 };
        let (across, up) = (page.skew_deg, page.skew_deg + 90.0);
        assert!(
            near(laid, LAID, LAID_TOLERANCE, across, turn),
            "{name}: {laid:?}"
        );
        assert!(
            near(chain, CHAIN, CHAIN_TOLERANCE, up, turn),
            "{name}: {chain:?}"
        );
        assert!(laid.sigma_mm > 0.0 && laid.sigma_mm < LAID_TOLERANCE * LAID);
        assert!(chain.sigma_mm > 0.0 && chain.sigma_mm < CHAIN_TOLERANCE * CHAIN);
        // The comparator can tell other lines.
        assert!(!near(laid, LAID * 1.02, LAID_TOLERANCE, across, turn));
        assert!(!near(laid, LAID, LAID_TOLERANCE, across + 2.0, turn));
        assert!(!near(chain, CHAIN * 1.03, CHAIN_TOLERANCE, up, turn));
    }

    #[test]
    fn lines_are_found_clean_skewed_noisy_and_written_over() {
        check("clean", CLEAN);
        check(
            "skewed",
            Page {
                skew_deg: 3.0,
                ..CLEAN
            },
        );
        check(
            "skewed the other way",
            Page {
                skew_deg: -3.0,
                ..CLEAN
            },
        );
        check(
            "turned",
            Page {
                skew_deg: 90.0,
                ..CLEAN
            },
        );
        check(
            "noisy",
            Page {
                noise: 0.1,
                ..CLEAN
            },
        );
        check(
            "written",
            Page {
                writing: true,
                ..CLEAN
            },
        );
        check("bent", Page { bend: 0.4, ..CLEAN });
        let worst = Page {
            noise: 0.06,
            writing: true,
            skew_deg: 3.0,
            bend: 0.3,
            ..CLEAN
        };
        check("all at once", worst);
        check(
            "fine pixels",
            Page {
                pixel: 0.05,
                noise: 0.06,
                skew_deg: 3.0,
                ..CLEAN
            },
        );
    }

    #[test]
    fn wove_paper_has_none() {
        let wove = Page {
            laid: 0.0,
            chain: 0.0,
            noise: 0.03,
            ..CLEAN
        };
        for seed in 0..3 {
            for writing in [false, true] {
                let found = mould_lines(&raster(Page {
                    writing,
                    seed,
                    ..wove
                }));
                assert!(
                    matches!(found.laid, Err(NoLines::Faint { .. })),
                    "{writing}: {found:?}"
                );
                assert_eq!(found.chain, Err(NoLines::NoLaid));
            }
        }
    }

    #[test]
    fn laid_lines_without_chains_have_no_chains() {
        for (seed, writing, skew_deg) in [(1, false, 0.0), (2, true, 0.0), (3, true, 90.0)] {
            let page = Page {
                chain: 0.0,
                noise: 0.03,
                writing,
                skew_deg,
                seed,
                ..CLEAN
            };
            let found = mould_lines(&raster(page));
            assert!(found.laid.is_ok());
            assert!(found.chain.is_err(), "{writing} {skew_deg}: {found:?}");
        }
    }

    #[test]
    fn directions_run_along_the_lines() {
        assert_eq!(along(DVec2::Y), 180.0 - 180.0);
        assert_eq!(along(DVec2::X), 90.0);
        assert!((along(DVec2::from_angle(93f64.to_radians())) - 3.0).abs() < 1e-9);
        assert!((along(DVec2::from_angle(-87f64.to_radians())) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn areas_that_cannot_tell_say_why() {
        let plain = |width: usize, height: usize, value: f32, mm: f64| {
            mould_lines(&Raster::new(width, height, vec![value; width * height], mm).unwrap()).laid
        };
        assert!(matches!(plain(1, 1, 0.5, 0.1), Err(NoLines::Small { .. })));
        assert!(matches!(plain(300, 300, 0.5, 0.3), Err(NoLines::Coarse(_))));
        assert!(matches!(
            plain(300, 300, f32::NAN, 0.1),
            Err(NoLines::Covered(_))
        ));
        assert!(matches!(
            plain(300, 300, 0.5, 0.1),
            Err(NoLines::Faint { .. })
        ));
        assert!(matches!(
            plain(300, 300, f32::MAX, 0.1),
            Err(NoLines::Faint { .. })
        ));
        assert!(matches!(
            plain(1, 3000, 0.5, 0.1),
            Err(NoLines::Small { .. })
        ));
        // A strip shows laid lines but too few chain lines.
        let page = raster(CLEAN);
        let strip: Vec<f32> = (0..960 * 320)
            .map(|i| page.value(i % 320, i / 320))
            .collect();
        let found = mould_lines(&Raster::new(320, 960, strip, 0.125).unwrap());
        assert!(found.laid.is_ok());
        assert!(
            matches!(found.chain, Err(NoLines::Small { .. })),
            "{found:?}"
        );
    }
}
