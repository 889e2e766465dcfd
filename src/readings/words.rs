//! Numbers as people read them.

use glam::DVec2;

use crate::measure::Measured;

/// Digits of an uncertainty that are worth writing (GUM 7.2.6).
const DIGITS: i32 = 2;
/// Decimals of an uncertainty of 0, and the most of any.
const MOST_DECIMALS: usize = 6;

/// A place in mm, to the hundredth.
pub fn at(place: DVec2) -> String {
    let number = |v: f64| {
        let text = format!("{v:.2}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    format!("{},{}", number(place.x), number(place.y))
}

/// `12.34 ± 0.05 mm`: the value to the two digits that its uncertainty has.
pub fn plus_minus(Measured { value, sigma }: Measured, unit: &str) -> String {
    let decimals = decimals(sigma);
    format!("{value:.decimals$} ± {sigma:.decimals$}{unit}")
}

/// How many decimals an uncertainty of two digits has.
pub fn decimals(sigma: f64) -> usize {
    let size = sigma.abs();
    if !(size.is_finite() && size > 0.0) {
        return 3;
    }
    let digits = DIGITS - 1 - size.log10().floor() as i32;
    usize::try_from(digits).unwrap_or(0).min(MOST_DECIMALS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_as_exactly_as_they_are_known() {
        for (value, sigma, written) in [
            (100.0, 0.0346, "100.000 ± 0.035 mm"),
            (1234.5678, 3.21, "1234.6 ± 3.2 mm"),
            (98765.4, 321.0, "98765 ± 321 mm"),
            (0.5, 0.0, "0.500 ± 0.000 mm"),
        ] {
            assert_eq!(plus_minus(Measured { value, sigma }, " mm"), written);
        }
    }

    #[test]
    fn places_are_short() {
        assert_eq!(at(DVec2::new(20.0, 7.505)), "20,7.5");
        assert_eq!(at(DVec2::new(-0.25, 100.0)), "-0.25,100");
    }
}
