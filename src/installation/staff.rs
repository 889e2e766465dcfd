//! The PIN that opens the staff's panel.

use std::fmt;

/// The PIN of the example file, which everybody knows.
pub const EXAMPLE: &str = "271828";

/// 4 to 12 digits, none of those that are tried first. It is never printed.
#[derive(Clone, PartialEq, Eq)]
pub struct Pin(String);

impl Pin {
    /// # Errors
    /// Why it is none, in a word that follows "a PIN ".
    pub fn new(digits: &str) -> Result<Self, &'static str> {
        let values: Option<Vec<u32>> = digits.chars().map(|c| c.to_digit(10)).collect();
        let values = values
            .filter(|values| (4..=12).contains(&values.len()))
            .ok_or("that is not 4 to 12 digits")?;
        let steps_by = |step: u32| {
            values
                .windows(2)
                .all(|pair| (pair[0] + step) % 10 == pair[1])
        };
        if digits == EXAMPLE {
            return Err("that is the example's, which everybody knows");
        }
        if steps_by(0) {
            return Err("of one digit over and over");
        }
        if steps_by(1) || steps_by(9) {
            return Err("of digits that follow each other");
        }
        Ok(Self(digits.to_owned()))
    }

    /// Whether these digits are it. How long it takes does not tell how many are right.
    pub fn matches(&self, digits: &str) -> bool {
        let (own, other) = (self.0.as_bytes(), digits.as_bytes());
        let differences = (0..own.len()).fold(0, |sum, k| {
            sum | (own[k] ^ other.get(k).copied().unwrap_or_default())
        });
        own.len() == other.len() && differences == 0
    }
}

impl fmt::Debug for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Pin(…)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_that_are_tried_first_are_refused() {
        for digits in [
            "0000",
            "1234",
            "4321",
            "7890",
            "3210",
            "111111",
            "271828",
            "123",
            "12a4",
            "",
            "1234567890123",
        ] {
            assert!(Pin::new(digits).is_err(), "{digits}");
        }
        for digits in ["8305", "1235", "2468", "090909", "271829"] {
            assert!(Pin::new(digits).is_ok(), "{digits}");
        }
    }

    #[test]
    fn a_pin_matches_itself_alone_and_is_not_printed() {
        let pin = Pin::new("8305").unwrap();
        assert!(pin.matches("8305"));
        for digits in ["8306", "830", "83055", "", "0305"] {
            assert!(!pin.matches(digits), "{digits}");
        }
        assert!(!format!("{pin:?}").contains("8305"));
    }
}
