//! Lengths, areas and angles between places on a side, each with its standard uncertainty.
//!
//! Every place is taken to be uncertain by the same [`Accuracy::place_mm`] along each axis,
//! independently of the others. A registration's error that two places share would cancel in
//! their distance, so that the stated uncertainty is then on the safe side.

use glam::DVec2;

use super::{MeasureError, count, finite, places, positive};

/// Most places of a polyline or outline. (Whether an outline crosses itself is asked of every
/// pair of its sides.)
pub const MAX_PLACES: usize = 4096;

/// How exactly a place is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Size of a pixel of the map that is measured on, in mm.
    pub map_mm: f64,
    /// RMS distance of the registration's control points from where its transform puts them, in
    /// mm; 0 for the map that defines the side.
    pub registration_mm: f64,
    /// Size of a screen pixel in mm on the sheet when the place was pointed at.
    pub screen_mm: f64,
}

impl Accuracy {
    /// Standard uncertainty of a place along each axis, in mm. Pixels are uniform distributions
    /// of their width, whose variance is width²/12 (GUM 4.3.7); the registration's distance has
    /// half its mean square along each axis.
    ///
    /// # Errors
    /// A component that is negative or not finite.
    pub fn place_mm(&self) -> Result<f64, MeasureError> {
        let checked = |what, found: f64| {
            if finite(what, found)? < 0.0 {
                return Err(MeasureError::Range {
                    what,
                    found,
                    allowed: "0 or above",
                });
            }
            Ok(found)
        };
        let map = checked("the map's pixel in mm", self.map_mm)?;
        let registration = checked("the registration's residual in mm", self.registration_mm)?;
        let screen = checked("the screen's pixel in mm", self.screen_mm)?;
        let variance = (map * map + screen * screen) / 12.0 + registration * registration / 2.0;
        finite("the accuracy", variance.sqrt())
    }
}

/// A value with its standard uncertainty (1 σ), both in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub value: f64,
    pub sigma: f64,
}

impl Measured {
    fn new(value: f64, sigma: f64) -> Result<Self, MeasureError> {
        Ok(Self {
            value: finite("the result", value)?,
            sigma: finite("its uncertainty", sigma)?,
        })
    }
}

/// Distance of two places in mm. Only errors along the line count: σ_L = √2 σ.
///
/// # Errors
/// Places that are not finite, or nearer than their distance's uncertainty.
pub fn ruler(from: DVec2, to: DVec2, accuracy: Accuracy) -> Result<Measured, MeasureError> {
    polyline(&[from, to], accuracy)
}

/// Length in mm of the line through 2 to [`MAX_PLACES`] places. The derivative by a place is the
/// difference u₋ − u₊ of the unit vectors of the segments that meet there, so that the
/// uncertainty of a straight line does not grow with its number of places.
///
/// # Errors
/// Places that are not finite; neighbours in one place; a line shorter than its uncertainty.
pub fn polyline(line: &[DVec2], accuracy: Accuracy) -> Result<Measured, MeasureError> {
    places(line, 2, MAX_PLACES)?;
    let sigma = accuracy.place_mm()?;
    let mut length = 0.0;
    let mut squares = 0.0;
    let mut before = DVec2::ZERO;
    for (first, pair) in line.windows(2).enumerate() {
        let arm = arm(pair[0], pair[1], 0.0, [first, first + 1])?;
        length += arm.length;
        squares += (before - arm.unit).length_squared();
        before = arm.unit;
    }
    squares += before.length_squared();
    let sigma = sigma * squares.sqrt();
    if length <= sigma {
        return Err(MeasureError::OnePlace {
            first: 0,
            second: line.len() - 1,
            distance_mm: length,
            sigma_mm: sigma,
        });
    }
    Measured::new(length, sigma)
}

/// Length in mm of the closed line through 3 to [`MAX_PLACES`] − 1 corners, in their order. Every
/// corner moves two of its sides, as in [`polyline`].
///
/// # Errors
/// As [`polyline`].
pub fn perimeter(outline: &[DVec2], accuracy: Accuracy) -> Result<Measured, MeasureError> {
    places(outline, 3, MAX_PLACES - 1)?;
    let sigma = accuracy.place_mm()?;
    let n = outline.len();
    let sides = (0..n)
        .map(|i| arm(outline[i], outline[(i + 1) % n], 0.0, [i, (i + 1) % n]))
        .collect::<Result<Vec<_>, _>>()?;
    let squares = (0..n).map(|i| (sides[i].unit - sides[(i + 1) % n].unit).length_squared());
    let sigma = sigma * squares.sum::<f64>().sqrt();
    Measured::new(sides.iter().map(|side| side.length).sum(), sigma)
}

/// Area in mm² within an outline of 3 to [`MAX_PLACES`] corners, in either sense of turning. By
/// the shoelace formula A = ½ Σ (xᵢ yᵢ₊₁ − xᵢ₊₁ yᵢ) the derivative by corner i is half the
/// vector between its neighbours, turned by 90°: σ_A = σ/2 √Σ |pᵢ₊₁ − pᵢ₋₁|².
///
/// # Errors
/// Corners that are not finite or coincide; an outline that crosses or touches itself, or
/// encloses nothing.
pub fn area(outline: &[DVec2], accuracy: Accuracy) -> Result<Measured, MeasureError> {
    places(outline, 3, MAX_PLACES)?;
    let sigma = accuracy.place_mm()?;
    let n = outline.len();
    // Far from the origin the products would cancel in their leading digits.
    let corners: Vec<DVec2> = outline.iter().map(|&p| p - outline[0]).collect();
    let mut doubled = 0.0;
    let mut squares = 0.0;
    for i in 0..n {
        let next = (i + 1) % n;
        arm(corners[i], corners[next], 0.0, [i, next])?;
        doubled += corners[i].perp_dot(corners[next]);
        squares += corners[next].distance_squared(corners[(i + n - 1) % n]);
    }
    let extent = corners
        .iter()
        .fold(0.0, |most: f64, p| most.max(p.length_squared()));
    // A thinner outline than rounding can tell from a line.
    if doubled.abs() <= 1e-12 * extent {
        return Err(MeasureError::NoArea);
    }
    crossing(&corners)?;
    Measured::new(0.5 * doubled.abs(), 0.5 * sigma * squares.sqrt())
}

/// Angle at `corner` between the arms to `from` and `to`, in degrees within 0…180. By
/// θ = φ_to − φ_from with ∂φ/∂p = u⊥/l, the corner moving both:
/// σ_θ² = 2 σ² (1/l₁² + 1/l₂² − cos θ/(l₁ l₂)).
///
/// An angle within its own uncertainty of 0° or 180° is biased inwards by being folded there.
///
/// # Errors
/// Places that are not finite; an arm shorter than its uncertainty.
pub fn angle(
    from: DVec2,
    corner: DVec2,
    to: DVec2,
    accuracy: Accuracy,
) -> Result<Measured, MeasureError> {
    places(&[from, corner, to], 3, 3)?;
    let sigma = accuracy.place_mm()?;
    let least = std::f64::consts::SQRT_2 * sigma;
    let a = arm(corner, from, least, [1, 0])?;
    let b = arm(corner, to, least, [1, 2])?;
    let cos = a.unit.dot(b.unit);
    let theta = a.unit.perp_dot(b.unit).abs().atan2(cos);
    let squares =
        1.0 / (a.length * a.length) + 1.0 / (b.length * b.length) - cos / (a.length * b.length);
    let sigma = sigma * (2.0 * squares.max(0.0)).sqrt();
    Measured::new(theta.to_degrees(), sigma.to_degrees())
}

/// The longest scale bar of 1, 2 or 5 × 10^k mm that fits into `longest_px` screen pixels, as
/// (mm, pixels).
///
/// # Errors
/// A pixel or a length that is not finite or not above 0.
pub fn scale_bar(mm_per_pixel: f64, longest_px: f64) -> Result<(f64, f64), MeasureError> {
    let mm_per_pixel = positive("the screen's pixel in mm", mm_per_pixel)?;
    let longest_px = positive("the longest scale bar in pixels", longest_px)?;
    let longest = positive("the longest scale bar in mm", mm_per_pixel * longest_px)?;
    let k = longest.log10().floor() as i32;
    // Rounding in the logarithm can miss by one decade; rounding in the product must not refuse a
    // bar that fits exactly.
    let candidates = (k - 1..=k + 1).flat_map(|k| {
        [1.0, 2.0, 5.0].map(|digit| {
            digit
                * if k < 0 {
                    1.0 / 10f64.powi(-k)
                } else {
                    10f64.powi(k)
                }
        })
    });
    let mm = candidates
        .filter(|&mm| mm <= longest * (1.0 + 1e-12))
        .fold(0.0, f64::max);
    let mm = positive("the scale bar in mm", mm)?;
    Ok((mm, mm / mm_per_pixel))
}

/// From one place to another.
struct Arm {
    length: f64,
    unit: DVec2,
}

fn arm(
    from: DVec2,
    to: DVec2,
    sigma_mm: f64,
    [first, second]: [usize; 2],
) -> Result<Arm, MeasureError> {
    let length = from.distance(to);
    if !length.is_finite() {
        return Err(MeasureError::NotFinite("a distance"));
    }
    match (to - from).try_normalize() {
        Some(unit) if length > sigma_mm => Ok(Arm { length, unit }),
        _ => Err(MeasureError::OnePlace {
            first,
            second,
            distance_mm: length,
            sigma_mm,
        }),
    }
}

/// Refuses a closed outline of which two sides meet other than in their common corner.
fn crossing(corners: &[DVec2]) -> Result<(), MeasureError> {
    let n = corners.len();
    count("corners", n, 3, MAX_PLACES)?;
    let side = |i: usize| (corners[i], corners[(i + 1) % n]);
    for first in 0..n {
        for second in first + 1..n {
            let (a, b) = side(first);
            let (c, d) = side(second);
            let meets = if second == first + 1 {
                folds_back(a, b, d)
            } else if first == 0 && second == n - 1 {
                folds_back(c, d, b)
            } else {
                segments_meet(a, b, c, d)
            };
            if meets {
                return Err(MeasureError::CrossesItself { first, second });
            }
        }
    }
    Ok(())
}

/// Whether the way a → b → c goes back along itself.
fn folds_back(a: DVec2, b: DVec2, c: DVec2) -> bool {
    (b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0
}

/// Whether two closed segments have a point in common.
fn segments_meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let apart = |p: f64, q: f64, r: f64, s: f64| p.max(q) < r.min(s) || r.max(s) < p.min(q);
    if apart(a.x, b.x, c.x, d.x) || apart(a.y, b.y, c.y, d.y) {
        return false;
    }
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _, rngs::Xoshiro256PlusPlus as Rng};
    use rand_distr::{Distribution as _, StandardNormal};

    const ACCURACY: Accuracy = Accuracy {
        map_mm: 0.0847,
        registration_mm: 0.12,
        screen_mm: 0.2,
    };
    const TRIALS: usize = 4000;

    /// A place as somebody reads it off: each part of the accuracy drawn by itself.
    fn read(truth: DVec2, rng: &mut Rng) -> DVec2 {
        let axis = |rng: &mut Rng, truth: f64| {
            let normal: f64 = StandardNormal.sample(rng);
            truth
                + ACCURACY.map_mm * (rng.random::<f64>() - 0.5)
                + ACCURACY.screen_mm * (rng.random::<f64>() - 0.5)
                + ACCURACY.registration_mm * std::f64::consts::FRAC_1_SQRT_2 * normal
        };
        DVec2::new(axis(rng, truth.x), axis(rng, truth.y))
    }

    /// Share of trials whose truth lies within 2 σ, with σ scaled by `scale`.
    fn coverage(
        truth: &[DVec2],
        scale: f64,
        measure: impl Fn(&[DVec2]) -> Result<Measured, MeasureError>,
    ) -> f64 {
        let mut rng = Rng::seed_from_u64(5);
        let exact = measure(truth).unwrap().value;
        let hits = (0..TRIALS)
            .filter(|_| {
                let seen: Vec<DVec2> = truth.iter().map(|&p| read(p, &mut rng)).collect();
                let found = measure(&seen).unwrap();
                (found.value - exact).abs() <= 2.0 * scale * found.sigma
            })
            .count();
        hits as f64 / TRIALS as f64
    }

    fn shapes() -> Vec<DVec2> {
        [
            (12.0, 30.0),
            (48.0, 33.0),
            (61.0, 70.0),
            (40.0, 52.0),
            (9.0, 77.0),
        ]
        .map(DVec2::from)
        .to_vec()
    }

    #[test]
    fn two_sigma_cover_95_percent() {
        let places = shapes();
        let all: [(&str, f64); 5] = [
            (
                "ruler",
                coverage(&places[..2], 1.0, |p| ruler(p[0], p[1], ACCURACY)),
            ),
            (
                "polyline",
                coverage(&places, 1.0, |p| polyline(p, ACCURACY)),
            ),
            (
                "perimeter",
                coverage(&places, 1.0, |p| perimeter(p, ACCURACY)),
            ),
            ("area", coverage(&places, 1.0, |p| area(p, ACCURACY))),
            (
                "angle",
                coverage(&places[..3], 1.0, |p| angle(p[0], p[1], p[2], ACCURACY)),
            ),
        ];
        for (name, share) in all {
            assert!((0.90..=0.99).contains(&share), "{name}: {share}");
        }
        // Half and twice the uncertainty must be told from the right one.
        for scale in [0.5, 2.0] {
            let share = coverage(&places, scale, |p| area(p, ACCURACY));
            assert!(!(0.90..=0.99).contains(&share), "{scale}: {share}");
        }
    }

    #[test]
    fn known_figures() {
        let exact = Accuracy {
            map_mm: 12f64.sqrt(),
            registration_mm: 0.0,
            screen_mm: 0.0,
        };
        let [a, b, c, d] = [(0.0, 0.0), (30.0, 0.0), (30.0, 40.0), (0.0, 40.0)].map(DVec2::from);
        let near = |found: Measured, value: f64, sigma: f64| {
            (found.value - value).abs() < 1e-9 && (found.sigma - sigma).abs() < 1e-9
        };
        assert!(near(ruler(a, c, exact).unwrap(), 50.0, 2f64.sqrt()));
        assert!(near(polyline(&[a, b, c], exact).unwrap(), 70.0, 2.0));
        // Each corner's neighbours are a diagonal of 50 apart.
        assert!(near(area(&[a, b, c, d], exact).unwrap(), 1200.0, 50.0));
        assert!(near(area(&[d, c, b, a], exact).unwrap(), 1200.0, 50.0));
        let right = (2.0f64 / 900.0 + 2.0 / 1600.0).sqrt().to_degrees();
        assert!(near(angle(a, b, c, exact).unwrap(), 90.0, right));
        assert!(!near(ruler(a, b, exact).unwrap(), 50.0, 2f64.sqrt()));
        let straight = polyline(&[a, a.lerp(c, 0.2), a.lerp(c, 0.7), c], exact).unwrap();
        assert!(near(straight, 50.0, 2f64.sqrt()));
    }

    #[test]
    fn degenerate_places_are_refused() {
        let p = DVec2::new(3.0, 4.0);
        let q = DVec2::new(30.0, 4.0);
        let one_place =
            |r: Result<Measured, MeasureError>| matches!(r, Err(MeasureError::OnePlace { .. }));
        assert!(one_place(ruler(p, p, ACCURACY)));
        assert!(one_place(ruler(p, p + 0.01, ACCURACY)));
        assert!(!one_place(ruler(p, q, ACCURACY)));
        assert!(one_place(polyline(&[p, q, q], ACCURACY)));
        assert!(one_place(area(&[p, q, q], ACCURACY)));
        assert!(one_place(angle(p, p, q, ACCURACY)));
        for few in [&[][..], &[p]] {
            assert!(matches!(
                polyline(few, ACCURACY),
                Err(MeasureError::Count { .. })
            ));
            assert!(matches!(
                area(few, ACCURACY),
                Err(MeasureError::Count { .. })
            ));
        }
        let line = [p, q, DVec2::new(50.0, 4.0)];
        assert_eq!(area(&line, ACCURACY), Err(MeasureError::NoArea));
        let bow = [(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 14.0)].map(DVec2::from);
        assert_eq!(
            area(&bow, ACCURACY),
            Err(MeasureError::CrossesItself {
                first: 0,
                second: 2
            })
        );
        let spike = [
            (0.0, 0.0),
            (10.0, 0.0),
            (20.0, 0.0),
            (10.0, 0.0),
            (5.0, 8.0),
        ]
        .map(DVec2::from);
        assert!(matches!(
            area(&spike, ACCURACY),
            Err(MeasureError::CrossesItself { .. })
        ));
        for bad in [DVec2::NAN, DVec2::INFINITY] {
            assert!(ruler(p, bad, ACCURACY).is_err());
            assert!(area(&[p, q, bad], ACCURACY).is_err());
            assert!(angle(p, q, bad, ACCURACY).is_err());
        }
        assert!(ruler(DVec2::splat(-1e308), DVec2::splat(1e308), ACCURACY).is_err());
        let negative = Accuracy {
            map_mm: -1.0,
            ..ACCURACY
        };
        assert!(matches!(
            ruler(p, q, negative),
            Err(MeasureError::Range { .. })
        ));
    }

    #[test]
    fn scale_bars_are_round_and_fit() {
        assert_eq!(scale_bar(0.1, 100.0), Ok((10.0, 100.0)));
        assert_eq!(scale_bar(0.1, 99.0), Ok((5.0, 50.0)));
        let (mm, px) = scale_bar(0.013, 240.0).unwrap();
        assert_eq!(mm, 2.0);
        assert!((px - 2.0 / 0.013).abs() < 1e-9);
        let mut rng = Rng::seed_from_u64(1);
        for _ in 0..2000 {
            let (pitch, longest) = (
                10f64.powf(rng.random_range(-6.0..3.0)),
                rng.random_range(1.0..4000.0),
            );
            let (mm, px) = scale_bar(pitch, longest).unwrap();
            assert!(
                px <= longest * (1.0 + 1e-9) && px > longest / 2.5 * (1.0 - 1e-9),
                "{mm} {px}"
            );
        }
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(scale_bar(bad, 100.0).is_err() && scale_bar(0.1, bad).is_err());
        }
    }
}
