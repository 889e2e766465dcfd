//! Rows of a picture one after another: straight from the file where its format allows it, and
//! from a file beside it where it has to be decoded whole first.

use std::{
    fs::File,
    io::{self, BufReader, BufWriter, Read, Seek, Write},
    ops::Range,
    path::{Path, PathBuf},
};

use super::{Header, Kind, MapError, Picture, Samples, png::PngPicture, tiff::TiffPicture};

/// Rows of a picture, from its top.
pub(in super::super) struct RowSource {
    pub header: Header,
    /// Of the samples.
    pub kind: Kind,
    pub icc: Option<Vec<u8>>,
    source: Source,
    /// Samples that are read and not asked for yet.
    ahead: Samples,
    used: usize,
}

enum Source {
    Png(Box<PngPicture>),
    Tiff {
        tiff: Box<TiffPicture>,
        strip: u32,
    },
    Spooled {
        path: PathBuf,
        file: BufReader<File>,
    },
}

impl RowSource {
    /// Opens a picture. What cannot be read row by row is decoded and laid down in a nameless file
    /// in the folder `scratch`, so that of many pictures only one is in memory at once.
    pub fn open(path: &Path, scratch: &Path) -> Result<Self, MapError> {
        let picture = Picture::open(path)?;
        let header = picture.header();
        let kind = match header.bits {
            8 => Kind::U8,
            _ => Kind::U16,
        };
        let (source, icc, kind) = match picture {
            Picture::Png(png) if png.is_streamed() => {
                let icc = png.icc();
                (Source::Png(png), icc, kind)
            }
            Picture::Tiff(tiff) if tiff.is_streamed() => {
                let icc = tiff.icc();
                (Source::Tiff { tiff, strip: 0 }, icc, kind)
            }
            other => {
                drop(other);
                let mut raster = super::read(path)?;
                raster.unmultiply();
                let kind = raster.samples.kind();
                let spooled = spool(scratch, &raster.samples);
                let file = spooled.map_err(|error| MapError::write(scratch, error))?;
                let path = path.to_owned();
                (Source::Spooled { path, file }, raster.icc, kind)
            }
        };
        Ok(Self {
            header,
            kind,
            icc,
            source,
            ahead: empty(kind),
            used: 0,
        })
    }

    /// The samples of the next row, interleaved: of all that is read and not asked for yet, which is
    /// whole rows, those in this range.
    pub fn next_row(&mut self) -> Result<(&Samples, Range<usize>), MapError> {
        let row = self.row();
        if self.used == length(&self.ahead) {
            self.ahead = self.more(row)?;
            self.used = 0;
        }
        let range = self.used..self.used + row;
        if range.end > length(&self.ahead) {
            return Err(MapError::damaged(self.path(), "it ends too early"));
        }
        if self.ahead.kind() != self.kind {
            let detail = "its channels contradict its header";
            return Err(MapError::damaged(self.path(), detail));
        }
        self.used = range.end;
        Ok((&self.ahead, range))
    }

    /// Samples of a row.
    fn row(&self) -> usize {
        self.header.size[0] as usize * usize::from(self.header.channels)
    }

    /// Leaves the next `rows` rows out. Strips of which nothing is asked for are not read; what has
    /// to be read goes through memory a few rows at a time.
    pub fn skip(&mut self, rows: usize) -> Result<(), MapError> {
        const ROWS: usize = 64;
        let [_, height] = self.header.size;
        let row = self.row();
        let mut left = rows * row;
        loop {
            let take = left.min(length(&self.ahead) - self.used);
            self.used += take;
            left -= take;
            if left == 0 {
                return Ok(());
            }
            match &mut self.source {
                Source::Tiff { tiff, strip } => {
                    let rows = tiff.strip_rows();
                    // The last strip may have fewer rows.
                    while left >= rows as usize * row && (*strip + 1) * rows <= height {
                        left -= rows as usize * row;
                        *strip += 1;
                    }
                    if left == 0 {
                        return Ok(());
                    }
                }
                Source::Spooled { path, file } => {
                    // Beyond the end nothing can be read, which is told then.
                    let bytes = (left * self.kind.bytes()) as i64;
                    let sought = file.seek_relative(bytes);
                    return sought.map_err(|error| MapError::read(path, error));
                }
                Source::Png(_) => {}
            }
            self.ahead = self.more(left.min(ROWS * row))?;
            self.used = 0;
            if length(&self.ahead) == 0 {
                return Err(MapError::damaged(self.path(), "it ends too early"));
            }
        }
    }

    fn path(&self) -> &Path {
        match &self.source {
            Source::Png(png) => png.path(),
            Source::Tiff { tiff, .. } => tiff.path(),
            Source::Spooled { path, .. } => path,
        }
    }

    /// Some of the next samples, at most `most` of them from a spooled file.
    fn more(&mut self, most: usize) -> Result<Samples, MapError> {
        match &mut self.source {
            Source::Tiff { tiff, strip } => {
                *strip += 1;
                tiff.strip(*strip - 1)
            }
            Source::Png(png) => {
                let row = png.next_row()?;
                Ok(match self.kind {
                    Kind::U8 => Samples::U8(row.to_vec()),
                    _ => {
                        let pairs = row.as_chunks::<2>().0.iter();
                        Samples::U16(pairs.map(|pair| u16::from_be_bytes(*pair)).collect())
                    }
                })
            }
            Source::Spooled { path, file } => {
                read_spooled(file, self.kind, most).map_err(|error| MapError::read(path, error))
            }
        }
    }
}

fn empty(kind: Kind) -> Samples {
    match kind {
        Kind::U8 => Samples::U8(Vec::new()),
        Kind::U16 => Samples::U16(Vec::new()),
        Kind::F32 => Samples::F32(Vec::new()),
    }
}

fn length(samples: &Samples) -> usize {
    match samples {
        Samples::U8(v) => v.len(),
        Samples::U16(v) => v.len(),
        Samples::F32(v) => v.len(),
    }
}

fn spool(folder: &Path, samples: &Samples) -> io::Result<BufReader<File>> {
    let file = tempfile::tempfile_in(folder)?;
    let mut writer = BufWriter::with_capacity(1 << 20, file);
    match samples {
        Samples::U8(v) => writer.write_all(v)?,
        Samples::U16(v) => {
            for value in v {
                writer.write_all(&value.to_ne_bytes())?;
            }
        }
        Samples::F32(v) => {
            for value in v {
                writer.write_all(&value.to_ne_bytes())?;
            }
        }
    }
    let mut file = writer.into_inner().map_err(|error| error.into_error())?;
    file.rewind()?;
    Ok(BufReader::with_capacity(1 << 20, file))
}

fn read_spooled(file: &mut BufReader<File>, kind: Kind, count: usize) -> io::Result<Samples> {
    fn bytes(file: &mut BufReader<File>, count: usize) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; count];
        file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
    Ok(match kind {
        Kind::U8 => Samples::U8(bytes(file, count)?),
        Kind::U16 => {
            let bytes = bytes(file, count * 2)?;
            let pairs = bytes.as_chunks().0.iter();
            Samples::U16(pairs.map(|pair| u16::from_ne_bytes(*pair)).collect())
        }
        Kind::F32 => {
            let bytes = bytes(file, count * 4)?;
            let fours = bytes.as_chunks().0.iter();
            Samples::F32(fours.map(|four| f32::from_ne_bytes(*four)).collect())
        }
    })
}
