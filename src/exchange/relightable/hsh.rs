//! Hemispherical harmonics in the universal RTI format (`.rti`).
//!
//! The layout is that of M. Mudge, Cultural Heritage Imaging, *RTI file format*, as RTIBuilder's
//! HSH fitter writes it and Relight reads it: lines of comment that begin with #, then the type (3
//! for hemispherical harmonics), width, height and channels, and terms, layout (2: for each
//! channel) and bytes of an element; then, as little-endian 32-bit floats, the scale of each term
//! and its bias; then bytes, rows from the top of the picture, each pixel's terms of red, of green
//! and of blue. A coefficient is byte / 255 · scale + bias, and 1 is white.

use std::path::Path;

use super::{
    super::{
        ExchangeError, Imported, Known,
        error::{Faulty, whole_file},
    },
    ByteRows, Coefficients, Colours, Relightable,
    basis::{Basis, HSH_TERMS},
    head, sides, write,
};
use crate::manifest::{document::Words, quote};

/// Terms that fitters write, up to the third order.
const TERMS: std::ops::RangeInclusive<usize> = 4..=16;

/// Makes an exhibit of a `.rti` file.
pub fn import(file: &Path, out: &Path, known: &Known) -> Result<Imported, ExchangeError> {
    let (header, mut warnings) = Header::read(file)?;
    // Signs of terms of the third order differ between programs, and they say little of normals.
    let used = header.terms.min(HSH_TERMS);
    if used < header.terms {
        let found = format!("{} terms", header.terms);
        let words = Words::new(found, "", "only the nine up to the second order are used");
        warnings.warning("", words);
    }
    let image = Relightable {
        size: header.size,
        basis: Basis::Hsh(used),
        colours: Colours::Each,
        planes: 3 * used,
    };
    let rows = ByteRows::open(file, header.bytes())?;
    let mut rows = Rows {
        next: 0,
        used,
        header,
        rows,
    };
    write::exhibit(
        write::Task {
            file,
            known,
            warnings,
            image: &image,
            rows: &mut rows,
        },
        out,
    )
}

struct Header {
    size: [usize; 2],
    terms: usize,
    scale: Vec<f64>,
    bias: Vec<f64>,
    /// Where bytes begin.
    length: usize,
}

impl Header {
    fn read(file: &Path) -> Result<(Self, Faulty<'_>), ExchangeError> {
        let bytes = head(file)?;
        let refused = |found: String, allowed: &str, remedy: &str| {
            Err(whole_file(file, Words::new(found, allowed, remedy)))
        };
        let mut lines = Vec::new();
        let mut length = 0;
        while lines.len() < 3 {
            let Some(feed) = bytes[length..].iter().position(|b| *b == b'\n') else {
                let remedy = "check that it is the right file, and copy it again";
                return refused(
                    "a header that does not end".to_owned(),
                    "an RTI header",
                    remedy,
                );
            };
            let line = String::from_utf8_lossy(&bytes[length..length + feed]);
            length += feed + 1;
            if !line.starts_with('#') {
                lines.push(line.trim().to_owned());
            }
        }
        if lines[0] != "3" {
            let found = match lines[0].as_str() {
                "1" => "a polynomial texture map in an .rti file".to_owned(),
                other => format!("RTI type {}", quote(other)),
            };
            let allowed = "type 3, hemispherical harmonics";
            return refused(found, allowed, "save it as .ptm, or as HSH in RTIBuilder");
        }
        let mut faulty = Faulty::new(file);
        let mut size = lines[1].split_whitespace();
        let sides = sides([size.next(), size.next()], &mut faulty);
        let mut exactly = |key: &str, found: Option<&str>, allowed: &str| {
            if found != Some(allowed) {
                let found = found.map_or("nothing".to_owned(), quote);
                let remedy = "save it as HSH in RGB, with a byte for each value";
                faulty.fault(key, Words::new(found, allowed, remedy));
            }
        };
        exactly("channels", size.next(), "3");
        let mut layout = lines[2].split_whitespace();
        let (terms, kind, element) = (layout.next(), layout.next(), layout.next());
        exactly("layout", kind, "2");
        exactly("bytes of an element", element, "1");
        let number = terms.and_then(|word| word.parse().ok());
        let number: Option<usize> = number.filter(|number| TERMS.contains(number));
        if number.is_none() {
            let found = terms.map_or("nothing".to_owned(), quote);
            let allowed = format!("{} to {} terms", TERMS.start(), TERMS.end());
            let remedy = "fit it again, to the second or third order";
            faulty.fault("terms", Words::new(found, allowed, remedy));
        }
        faulty.check()?;
        let terms = number.unwrap_or(*TERMS.start());
        let floats = |from: usize| -> Vec<f64> {
            let bytes = bytes.get(from..).unwrap_or_default().chunks_exact(4);
            let floats = bytes.map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
            floats.take(terms).collect()
        };
        let (scale, bias) = (floats(length), floats(length + 4 * terms));
        for (key, values) in [("scale", &scale), ("bias", &bias)] {
            if values.len() < terms {
                let found = format!("{} of {terms} numbers", values.len());
                let remedy = "it ends too early; copy it again";
                faulty.fault(key, Words::new(found, "one for each term", remedy));
            }
            for (i, value) in values
                .iter()
                .enumerate()
                .filter(|(_, value)| !value.is_finite())
            {
                let words = Words::new(value.to_string(), "an ordinary number", "fit it again");
                faulty.fault(format!("{key}[{i}]"), words);
            }
        }
        faulty.check()?;
        let header = Self {
            size: sides.unwrap_or([1, 1]),
            terms,
            scale,
            bias,
            length: length + 8 * terms,
        };
        Ok((header, faulty))
    }

    fn bytes(&self) -> u64 {
        let [width, height] = self.size.map(|n| n as u64);
        self.length as u64 + width * height * 3 * self.terms as u64
    }
}

struct Rows {
    header: Header,
    rows: ByteRows,
    used: usize,
    next: usize,
}

impl Coefficients for Rows {
    fn next_row(&mut self, row: &mut [f64]) -> Result<(), ExchangeError> {
        let terms = self.header.terms;
        let mut bytes = vec![0; self.header.size[0] * 3 * terms];
        let at = self.header.length as u64 + self.next as u64 * bytes.len() as u64;
        self.rows.read(at, &mut bytes)?;
        let pixels = row.chunks_exact_mut(3 * self.used);
        for (pixel, bytes) in pixels.zip(bytes.chunks_exact(3 * terms)) {
            for (i, value) in pixel.iter_mut().enumerate() {
                let (term, channel) = (i / 3, i % 3);
                let byte = f64::from(bytes[channel * terms + term]);
                *value = byte / 255.0 * self.header.scale[term] + self.header.bias[term];
            }
        }
        self.next += 1;
        Ok(())
    }
}
