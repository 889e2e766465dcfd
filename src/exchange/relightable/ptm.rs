//! Polynomial texture maps (`.ptm`).
//!
//! The layout is that of T. Malzbender, *Polynomial Texture Map (.ptm) File Format*, version 1.2,
//! Hewlett-Packard Laboratories, 2001: lines of text with version, format, width, height, six
//! scales and six biases, then bytes, rows from the bottom of the picture. A coefficient is
//! (byte − bias) · scale and luminance 255 is white.

use std::path::Path;

use super::{
    super::{
        ExchangeError, Imported, Known,
        error::{Faulty, whole_file},
    },
    ByteRows, Coefficients, Colours, Relightable,
    basis::{Basis, PTM_TERMS},
    head, sides, write,
};
use crate::manifest::{document::Words, quote, shape::unexplained};

const FORMATS: &str = "PTM_FORMAT_LRGB or PTM_FORMAT_RGB";

/// Makes an exhibit of a `.ptm` file.
pub fn import(file: &Path, out: &Path, known: &Known) -> Result<Imported, ExchangeError> {
    let (header, warnings) = Header::read(file)?;
    let colours = match header.layout {
        Layout::Rgb => Colours::Each,
        _ => Colours::Luminance,
    };
    let image = Relightable {
        size: header.size,
        basis: Basis::Ptm,
        colours,
        planes: header.layout.planes(),
    };
    let rows = ByteRows::open(file, header.bytes())?;
    let mut rows = Rows {
        next: 0,
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

/// How bytes follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layout {
    /// Six coefficients of each pixel, and behind all of them three colours of each.
    Lrgb,
    /// Nine bytes of each pixel, before version 1.2.
    LrgbTogether,
    /// Six coefficients of each pixel for red, then for green, then for blue.
    Rgb,
}

impl Layout {
    fn planes(self) -> usize {
        match self {
            Self::Rgb => 3 * PTM_TERMS,
            Self::Lrgb | Self::LrgbTogether => PTM_TERMS + 3,
        }
    }
}

struct Header {
    layout: Layout,
    size: [usize; 2],
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
        let mut words = Tokens {
            bytes: &bytes,
            at: 0,
        };
        let version = words.next().unwrap_or_default();
        if !version.starts_with("PTM_") {
            let remedy = "check that it is the right file, and copy it again";
            return refused(quote(version), "a file that begins with PTM_1.2", remedy);
        }
        let format = words.next().unwrap_or_default();
        let layout = match format {
            "PTM_FORMAT_LRGB" if version == "PTM_1.2" => Layout::Lrgb,
            "PTM_FORMAT_LRGB" => Layout::LrgbTogether,
            "PTM_FORMAT_RGB" => Layout::Rgb,
            _ if format.contains("JPEG") => {
                let found = format!("{format}, which is compressed");
                let remedy = "save it uncompressed, as PTM_FORMAT_LRGB, in PTMfitter or RTIBuilder, \
                              or convert it with Relight";
                return refused(found, FORMATS, remedy);
            }
            _ => return refused(quote(format), FORMATS, "save it in one of these formats"),
        };
        let mut faulty = Faulty::new(file);
        let size = sides([words.next(), words.next()], &mut faulty);
        let scale = words.numbers("scale", &mut faulty);
        let bias = words.numbers("bias", &mut faulty);
        faulty.check()?;
        let (Some(size), Some(scale), Some(bias)) = (size, scale, bias) else {
            return Err(unexplained(file, "a header").into());
        };
        let header = Self {
            layout,
            size,
            scale,
            bias,
            length: words.line_end(),
        };
        Ok((header, faulty))
    }

    fn pixels(&self) -> u64 {
        self.size[0] as u64 * self.size[1] as u64
    }

    /// Of the whole file.
    fn bytes(&self) -> u64 {
        self.length as u64 + self.pixels() * self.layout.planes() as u64
    }
}

/// Words of a header between white space.
struct Tokens<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Tokens<'b> {
    fn next(&mut self) -> Option<&'b str> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let end = rest[start..]
            .iter()
            .position(u8::is_ascii_whitespace)
            .map_or(rest.len(), |length| start + length);
        self.at += end;
        std::str::from_utf8(&rest[start..end]).ok()
    }

    fn numbers(&mut self, key: &str, faulty: &mut Faulty<'_>) -> Option<Vec<f64>> {
        let mut sound = true;
        let mut numbers = Vec::with_capacity(PTM_TERMS);
        for i in 0..PTM_TERMS {
            let word = self.next();
            let number = word.and_then(|word| word.parse::<f64>().ok());
            match number.filter(|number| number.is_finite()) {
                Some(number) => numbers.push(number),
                None => {
                    sound = false;
                    let found = word.map_or("nothing".to_owned(), quote);
                    let words = Words::new(found, "an ordinary number", "save the file again");
                    faulty.fault(format!("{key}[{i}]"), words);
                }
            }
        }
        sound.then_some(numbers)
    }

    /// Behind the line feed that ends the line of the last word.
    fn line_end(&self) -> usize {
        let rest = &self.bytes[self.at..];
        let feed = rest
            .iter()
            .take_while(|b| b.is_ascii_whitespace())
            .position(|b| *b == b'\n');
        self.at + feed.map_or(usize::from(!rest.is_empty()), |feed| feed + 1)
    }
}

struct Rows {
    header: Header,
    rows: ByteRows,
    /// From the top.
    next: usize,
}

impl Rows {
    /// Reads the bytes of the row, of so many for each pixel, in the block that begins behind
    /// `before` bytes for each pixel.
    fn block(&mut self, before: usize, each: usize) -> Result<Vec<u8>, ExchangeError> {
        let [width, height] = self.header.size.map(|n| n as u64);
        let from_bottom = height - 1 - self.next as u64;
        let at = self.header.length as u64
            + before as u64 * self.header.pixels()
            + from_bottom * width * each as u64;
        let mut bytes = vec![0; self.header.size[0] * each];
        self.rows.read(at, &mut bytes)?;
        Ok(bytes)
    }

    /// A coefficient of luminance or of a channel, 1 for white.
    fn coefficient(&self, term: usize, byte: u8) -> f64 {
        (f64::from(byte) - self.header.bias[term]) * self.header.scale[term] / 255.0
    }
}

impl Coefficients for Rows {
    fn next_row(&mut self, row: &mut [f64]) -> Result<(), ExchangeError> {
        let layout = self.header.layout;
        let pixels = row.chunks_exact_mut(layout.planes());
        match layout {
            Layout::Rgb => {
                let channels = [0, 1, 2].map(|c| self.block(c * PTM_TERMS, PTM_TERMS));
                let [r, g, b] = channels;
                let channels = [r?, g?, b?];
                for (x, pixel) in pixels.enumerate() {
                    for (i, value) in pixel.iter_mut().enumerate() {
                        let (term, channel) = (i / 3, i % 3);
                        *value = self.coefficient(term, channels[channel][x * PTM_TERMS + term]);
                    }
                }
            }
            Layout::Lrgb | Layout::LrgbTogether => {
                let (terms, colours) = match layout {
                    Layout::Lrgb => (self.block(0, PTM_TERMS)?, self.block(PTM_TERMS, 3)?),
                    _ => {
                        let all = self.block(0, PTM_TERMS + 3)?;
                        let part = |from: usize, to: usize| {
                            let pixels = all.chunks_exact(PTM_TERMS + 3);
                            pixels.flat_map(|pixel| pixel[from..to].to_vec()).collect()
                        };
                        (part(0, PTM_TERMS), part(PTM_TERMS, PTM_TERMS + 3))
                    }
                };
                for (x, pixel) in pixels.enumerate() {
                    let (own, colour) = pixel.split_at_mut(PTM_TERMS);
                    for (term, value) in own.iter_mut().enumerate() {
                        *value = self.coefficient(term, terms[x * PTM_TERMS + term]);
                    }
                    for (c, value) in colour.iter_mut().enumerate() {
                        *value = f64::from(colours[x * 3 + c]) / 255.0;
                    }
                }
            }
        }
        self.next += 1;
        Ok(())
    }
}
