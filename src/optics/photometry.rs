//! A lamp's intensities as its photometric file gives them: IES LM-63, type C.
//!
//! # Why not a crate
//! `lidrs` 0.2.3 (MIT) was tried with generated files. It gives 1255.8 lm for an even 100 cd
//! (1256.6 lm, right), and the same 1255.8 lm with a candela multiplier of 3 or a ballast factor
//! of .5: neither is applied, and neither can be read from outside the crate. It panics on type
//! A and B (`todo!`), on a file cut short, on no vertical angles, on a count near 2⁶⁴, and on
//! `[MORE]` as the first keyword. It accepts too few candelas (630 lm where 1257 are due) and NaN.
//! It refuses tabs, a comma followed by a space, a trailing empty line, an empty keyword and a
//! lamp count written `1.0`, all of which files in use have; and it opens a path written behind
//! `TILT=` from the current folder. What is left to a wrapper is splitting a text into numbers.
//!
//! # Frame
//! γ is the angle to the lamp's axis, 0 along its light; C the azimuth around the axis, from the
//! lamp's width (0°) by its height (90°), as [`super::lamp_units::area_axes`] gives them. The
//! luminous opening is taken for a point.

use std::{f64::consts::PI, fmt};

/// Angles of one kind at most; the finest goniometers give some thousand.
const MOST_ANGLES: usize = 4000;
/// Candela values at most.
const MOST_VALUES: usize = 1_000_000;

/// Columns of a baked profile: γ by sixteenths of a degree. The angles of nearly all files lie on
/// columns; others bend between two, by less than 1e-3 of the peak for a beam of 10°.
pub const COLUMNS: usize = 2881;
/// Rows of a baked profile whose planes are unevenly spaced: C by half degrees.
pub const MOST_ROWS: usize = 720;

/// What is wrong with a photometric file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PhotometryError {
    /// The line, from 1.
    pub line: usize,
    pub found: String,
}

impl fmt::Display for PhotometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.found)
    }
}

/// How the planes that are given stand for the others (LM-63-2002, 5.12).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Symmetry {
    /// One plane: even around the axis.
    Axial,
    /// 0…90°: alike in the four quadrants.
    Quadrants,
    /// 0…180°: mirrored by the plane 0–180°.
    Halves,
    /// 90…270°: mirrored by the plane 90–270°.
    TurnedHalves,
    /// 0…360°.
    None,
}

/// Luminous intensities of a lamp, in cd, linear in both angles between those that are given.
#[derive(Clone, Debug, PartialEq)]
pub struct Photometry {
    /// γ in degrees, rising within 0…180. Beyond the first and the last there is no light.
    vertical: Vec<f64>,
    /// C in degrees, rising within 0…360.
    horizontal: Vec<f64>,
    symmetry: Symmetry,
    /// Plane by plane.
    candela: Vec<f64>,
    peak: f64,
    stated_lumens: Option<f64>,
}

/// The file's numbers with their lines.
struct Numbers<'t> {
    words: Box<dyn Iterator<Item = (usize, &'t str)> + 't>,
    line: usize,
}

impl Numbers<'_> {
    fn fault(&self, found: impl Into<String>) -> PhotometryError {
        PhotometryError {
            line: self.line,
            found: found.into(),
        }
    }

    fn next(&mut self, what: &str) -> Result<f64, PhotometryError> {
        let Some((line, word)) = self.words.next() else {
            return Err(self.fault(format!("the file ends where {what} is due")));
        };
        self.line = line;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => {
                let word: String = word.chars().take(20).collect();
                Err(self.fault(format!("{word:?} where {what} is due")))
            }
        }
    }

    fn within(&mut self, what: &str, least: f64, most: f64) -> Result<f64, PhotometryError> {
        let number = self.next(what)?;
        if (least..=most).contains(&number) {
            Ok(number)
        } else {
            Err(self.fault(format!("{number} as {what}, not {least} to {most}")))
        }
    }

    fn count(&mut self, what: &str, most: usize) -> Result<usize, PhotometryError> {
        let number = self.within(what, 1.0, most as f64)?;
        if number.fract() == 0.0 {
            Ok(number as usize)
        } else {
            Err(self.fault(format!("{number} as {what}, not a whole number")))
        }
    }

    fn angles(&mut self, what: &str, count: usize, most: f64) -> Result<Vec<f64>, PhotometryError> {
        let mut angles: Vec<f64> = Vec::with_capacity(count);
        for _ in 0..count {
            let angle = self.within(what, 0.0, most)?;
            if angles.last().is_some_and(|before| *before >= angle) {
                return Err(self.fault(format!("{what} {angle} not above the one before it")));
            }
            angles.push(angle);
        }
        Ok(angles)
    }
}

impl Photometry {
    /// The same lamp with `gain` times the light.
    pub fn dimmed(mut self, gain: f64) -> Self {
        self.candela.iter_mut().for_each(|candela| *candela *= gain);
        self.peak *= gain;
        self.stated_lumens = self.stated_lumens.map(|lumens| lumens * gain);
        self
    }

    /// Reads the text of a file of any edition that begins with its name, `IESNA…` or `IES:LM-63…`.
    ///
    /// # Errors
    /// With the line, where the text is no such file, is of type A or B, or corrects for a tilt.
    pub fn parse(text: &str) -> Result<Self, PhotometryError> {
        let at = |line, found: &str| PhotometryError {
            line,
            found: found.to_owned(),
        };
        let edition = text.lines().next().unwrap_or_default();
        if !(edition.starts_with("IESNA") || edition.starts_with("IES:L")) {
            return Err(at(1, "it does not begin with IESNA"));
        }
        let mut lines = (1..).zip(text.lines());
        let Some((tilt_line, tilt)) = lines.find(|(_, line)| line.starts_with("TILT=")) else {
            return Err(at(text.lines().count(), "the file ends without TILT=NONE"));
        };
        if tilt.trim() != "TILT=NONE" {
            return Err(at(
                tilt_line,
                "a correction for a tilted lamp (TILT=), where only TILT=NONE is read",
            ));
        }
        let words = lines.flat_map(|(line, text)| {
            text.split(|c: char| c.is_whitespace() || c == ',')
                .filter(|word| !word.is_empty())
                .map(move |word| (line, word))
        });
        let mut numbers = Numbers {
            words: Box::new(words),
            line: tilt_line,
        };

        let lamps = numbers.within("the number of lamps", 0.0, 1e6)?;
        let lumens = numbers.within("the lumens of a lamp", -1.0, 1e9)?;
        let multiplier = numbers.within("the candela multiplier", 1e-9, 1e9)?;
        let verticals = numbers.count("the number of vertical angles", MOST_ANGLES)?;
        let horizontals = numbers.count("the number of horizontal angles", MOST_ANGLES)?;
        if verticals * horizontals > MOST_VALUES {
            return Err(numbers.fault("more than a million candela values"));
        }
        let kind = numbers.next("the photometric type")?;
        match kind {
            1.0 => {}
            2.0 => return Err(numbers.fault("photometry of type B, where only type C is read")),
            3.0 => return Err(numbers.fault("photometry of type A, where only type C is read")),
            _ => return Err(numbers.fault(format!("{kind} as the photometric type, not 1"))),
        }
        for what in ["the unit of length", "a width", "a length", "a height"] {
            numbers.within(what, -1e6, 1e6)?;
        }
        let ballast = numbers.within("the ballast factor", 1e-6, 1e3)?;
        // The ballast-lamp photometric factor of old editions; of no meaning, or the way the file
        // was made, in those since 2002.
        let old = ["2002", "2019"].iter().all(|year| !edition.contains(year));
        let factor = numbers.within("the ballast-lamp factor", 0.0, 1e3)?;
        numbers.within("the input watts", 0.0, 1e9)?;

        let vertical = numbers.angles("a vertical angle", verticals, 180.0)?;
        let horizontal = numbers.angles("a horizontal angle", horizontals, 360.0)?;
        let (first, last) = (horizontal[0], horizontal[horizontals - 1]);
        let symmetry = match (first, last) {
            _ if horizontals == 1 => Symmetry::Axial,
            (0.0, 90.0) => Symmetry::Quadrants,
            (0.0, 180.0) => Symmetry::Halves,
            (90.0, 270.0) => Symmetry::TurnedHalves,
            (0.0, last) if last > 180.0 => Symmetry::None,
            _ => {
                let found = format!(
                    "horizontal angles from {first} to {last}, not from 0 to 90, 180 or 360, or \
                     from 90 to 270"
                );
                return Err(numbers.fault(found));
            }
        };
        if verticals < 2 {
            return Err(numbers.fault("one vertical angle, which makes no distribution"));
        }
        let scale = multiplier * ballast * if old && factor > 0.0 { factor } else { 1.0 };
        let mut candela = Vec::with_capacity(verticals * horizontals);
        for _ in 0..verticals * horizontals {
            candela.push(scale * numbers.within("a candela value", 0.0, 1e12)?);
        }
        if let Some((line, _)) = numbers.words.next() {
            return Err(at(line, "more numbers than the angles ask for"));
        }
        let peak = candela.iter().fold(0.0, |peak: f64, cd| peak.max(*cd));
        if peak <= 0.0 {
            return Err(numbers.fault("a lamp without light"));
        }
        Ok(Self {
            vertical,
            horizontal,
            symmetry,
            candela,
            peak,
            stated_lumens: (lumens > 0.0).then_some(lamps * lumens),
        })
    }

    /// The greatest intensity, in cd; above zero.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// The light of the bare lamps as the file states it, in lm; `None` for absolute photometry.
    pub fn stated_lumens(&self) -> Option<f64> {
        self.stated_lumens
    }

    /// Intensity in cd at γ in 0…π and any C, in radians.
    pub fn intensity(&self, gamma: f64, c: f64) -> f64 {
        let (i, t) = match place(&self.vertical, gamma.to_degrees()) {
            Some(place) => place,
            None => return 0.0,
        };
        let along = |plane: usize| {
            let row = plane * self.vertical.len() + i;
            self.candela[row] + (self.candela[row + 1] - self.candela[row]) * t
        };
        if self.symmetry == Symmetry::Axial {
            return along(0);
        }
        let c = c.to_degrees().rem_euclid(360.0);
        let c = match self.symmetry {
            Symmetry::Axial | Symmetry::None => c,
            Symmetry::Quadrants => (c % 180.0).min(180.0 - c % 180.0),
            Symmetry::Halves => c.min(360.0 - c),
            Symmetry::TurnedHalves if c < 90.0 => 180.0 - c,
            Symmetry::TurnedHalves if c > 270.0 => 540.0 - c,
            Symmetry::TurnedHalves => c,
        };
        match place(&self.horizontal, c) {
            Some((plane, t)) => along(plane) + (along(plane + 1) - along(plane)) * t,
            // Past the last plane of a full circle that is not closed: back to the first.
            None => {
                let last = self.horizontal.len() - 1;
                let t = (c - self.horizontal[last]) / (360.0 - self.horizontal[last]);
                along(last) + (along(0) - along(last)) * t
            }
        }
    }

    /// All light, in lm: the integral of the intensity, exact for what lies linearly between the
    /// angles.
    pub fn lumens(&self) -> f64 {
        let planes: Vec<f64> = self
            .candela
            .chunks(self.vertical.len())
            .map(|plane| {
                let zones = self.vertical.windows(2).zip(plane.windows(2));
                zones
                    .map(|(degrees, cd)| {
                        let [g, h] = [degrees[0].to_radians(), degrees[1].to_radians()];
                        // ∫ (a + b γ) sin γ dγ = −(a + b γ) cos γ + b sin γ
                        let b = (cd[1] - cd[0]) / (h - g);
                        cd[0] * g.cos() - cd[1] * h.cos() + b * (h.sin() - g.sin())
                    })
                    .sum()
            })
            .collect();
        let mut around: f64 = self
            .horizontal
            .windows(2)
            .zip(planes.windows(2))
            .map(|(c, plane)| (c[1] - c[0]).to_radians() * 0.5 * (plane[0] + plane[1]))
            .sum();
        match self.symmetry {
            Symmetry::Axial => 2.0 * PI * planes[0],
            Symmetry::Quadrants => 4.0 * around,
            Symmetry::Halves | Symmetry::TurnedHalves => 2.0 * around,
            Symmetry::None => {
                let last = planes.len() - 1;
                let open = (360.0 - self.horizontal[last]).to_radians();
                around += open * 0.5 * (planes[last] + planes[0]);
                around
            }
        }
    }

    /// Rows that it takes in a table of [`COLUMNS`] columns.
    pub fn rows(&self) -> usize {
        if self.symmetry == Symmetry::Axial {
            return 1;
        }
        // A row for each plane, where they are evenly spaced and close to a full circle.
        let step = self.horizontal[1] - self.horizontal[0];
        let even = self
            .horizontal
            .windows(2)
            .all(|c| (c[1] - c[0] - step).abs() < 1e-9);
        let rows = (360.0 / step).round();
        if even && rows <= MOST_ROWS as f64 && (rows * step - 360.0).abs() < 1e-6 {
            rows as usize
        } else {
            MOST_ROWS
        }
    }

    /// Shares, 0…1, of [`Self::peak`]: row by row, C = 2π·row/rows and γ = π·column/(columns − 1).
    pub fn baked(&self) -> Vec<f64> {
        let step = PI / (COLUMNS - 1) as f64;
        (0..self.rows() * COLUMNS)
            .map(|i| {
                let c = 2.0 * PI * (i / COLUMNS) as f64 / self.rows() as f64;
                self.intensity((i % COLUMNS) as f64 * step, c) / self.peak
            })
            .collect()
    }
}

/// Interval and place in it, 0…1, of `x` among rising `angles`; `None` outside them.
fn place(angles: &[f64], x: f64) -> Option<(usize, f64)> {
    // Radians and back move 90° by a rounding; no angle of a file is as fine.
    const SLACK: f64 = 1e-9;
    let last = angles.len() - 1;
    if x < angles[0] - SLACK || x > angles[last] + SLACK {
        return None;
    }
    let i = angles.partition_point(|angle| *angle <= x).clamp(1, last) - 1;
    let t = (x - angles[i]) / (angles[i + 1] - angles[i]);
    Some((i, t.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests;
