//! Files of a capture: there, readable, no camera's raw files, and of one size.

use std::{
    collections::HashMap,
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

use super::{
    super::{raw::RawFrames, values::CapturePath},
    Validator,
};
use crate::{
    manifest::{
        Pattern,
        document::{Trail, Words},
        quote,
    },
    maps::{self, MapError},
};

/// What cameras call their raw files.
const RAW_EXTENSIONS: [&str; 27] = [
    "3fr", "arw", "cr2", "cr3", "crw", "dcr", "dng", "erf", "fff", "gpr", "iiq", "kdc", "mef",
    "mos", "mrw", "nef", "nrw", "orf", "pef", "raf", "raw", "rw2", "rwl", "sr2", "srf", "srw",
    "x3f",
];

/// How a raw file becomes a picture that is read here.
const DEVELOP: &str = "develop it to a 16-bit linear TIFF without sharpening or tone curve, all \
     of them alike (such as `dcraw -v -4 -T -W -r 1 1 1 1 FILE`, or a neutral linear profile in \
     RawTherapee or darktable), and write encoding = \"linear\"";

impl Validator<'_, '_> {
    /// A path as the program opens it.
    pub(super) fn path(&self, path: &CapturePath) -> PathBuf {
        self.folder.join(path.as_str())
    }

    /// The files of a list, and the size that all of them and `like` have.
    pub(super) fn photographs(
        &mut self,
        list: &RawFrames,
        key: &Trail,
        like: Option<([u32; 2], &Path)>,
    ) -> (Vec<PathBuf>, Option<[u32; 2]>) {
        let named = list.iter();
        let named = named.map(|(i, path)| (self.path(path), key.index(i)));
        let files: Vec<(PathBuf, Trail)> = named.collect();
        let of: Vec<_> = files
            .iter()
            .map(|(path, trail)| (path, trail.clone()))
            .collect();
        let size = self.same_size(&of, like);
        (files.into_iter().map(|(path, _)| path).collect(), size)
    }

    /// The size in pixels that all these files have, and that of `like` where there is one; says
    /// what is wrong with each of them.
    pub(super) fn same_size(
        &mut self,
        files: &[(&PathBuf, Trail)],
        like: Option<([u32; 2], &Path)>,
    ) -> Option<[u32; 2]> {
        let mut first: Option<([u32; 2], &Path)> = like;
        let mut sound = true;
        for (path, trail) in files {
            let Some(size) = self.size(path, trail) else {
                sound = false;
                continue;
            };
            match first {
                None => first = Some((size, path)),
                Some((expected, _)) if expected == size => {}
                Some((expected, of)) => {
                    sound = false;
                    let words = Words::new(
                        format!(
                            "{} with {} × {} pixels",
                            quote(&path.to_string_lossy()),
                            size[0],
                            size[1]
                        ),
                        format!(
                            "{} × {} pixels, as {} has",
                            expected[0],
                            expected[1],
                            of.display()
                        ),
                        "use photographs as the camera took them, none cropped or resized",
                    );
                    self.report.fault(trail, words);
                }
            }
        }
        first.map(|(size, _)| size).filter(|_| sound)
    }

    /// Whether no picture is there twice: each is under a lamp of its own. Of a grey card one may do for all.
    pub(super) fn all_differ(&mut self, files: &[(&PathBuf, Trail)]) -> bool {
        let mut alike: HashMap<(u64, Vec<u8>), Vec<usize>> = HashMap::new();
        let mut sound = true;
        for (i, (path, trail)) in files.iter().enumerate() {
            // One that cannot be read has its own fault.
            let Ok(print) = print_of(path) else { continue };
            let earlier = alike.entry(print).or_default();
            let same = earlier
                .iter()
                .find(|other| are_same(files[**other].0, path).unwrap_or(false));
            if let Some(other) = same {
                let words = Words::new(
                    format!(
                        "{}, the same picture as {}",
                        quote(&path.to_string_lossy()),
                        files[*other].0.display()
                    ),
                    "a photograph of its own for each lamp",
                    "name the one that was taken under this lamp, or leave the lamp out",
                );
                self.report.fault(trail, words);
                sound = false;
            }
            earlier.push(i);
        }
        sound
    }

    /// The size of one picture in pixels.
    fn size(&mut self, path: &Path, trail: &Trail) -> Option<[u32; 2]> {
        let shown = quote(&path.to_string_lossy());
        if is_raw(path) && path.is_file() {
            let words = Words::new(
                format!("{shown}, a camera's raw file"),
                "TIFF, PNG, JPEG or OpenEXR",
                DEVELOP,
            );
            self.report.fault(trail, words);
            return None;
        }
        let error = match maps::probe(path) {
            Ok(header) => return Some(header.size),
            Err(error) => error,
        };
        let (found, remedy) = match &error {
            MapError::Read { reason, .. } => {
                let there = reason.kind() != std::io::ErrorKind::NotFound;
                let found = match there {
                    true => format!("{shown} ({reason})"),
                    false => format!("{shown}, which is not there"),
                };
                (found, "correct the path, from the capture file's folder")
            }
            _ if std::fs::metadata(path).is_ok_and(|data| data.len() == 0) => (
                format!("{shown}, an empty file"),
                "copy or export this photograph again",
            ),
            MapError::UnknownFormat { .. } => (
                format!("{shown}, which is none of these"),
                "export this photograph as one of these",
            ),
            _ => (error.to_string(), "export this photograph again"),
        };
        let words = Words::new(found, "TIFF, PNG, JPEG or OpenEXR", remedy);
        self.report.fault(trail, words);
        None
    }
}

/// Whether a file is what a camera writes before it makes a picture of it: by its name, or by what
/// it begins with.
pub(super) fn is_raw(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.map(str::to_ascii_lowercase);
    if extension.is_some_and(|extension| RAW_EXTENSIONS.contains(&extension.as_str())) {
        return true;
    }
    let mut start = [0; 16];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    read.is_ok()
        && matches!(
            &start,
            [b'I', b'I', 42, 0, _, _, _, _, b'C', b'R', ..]
                | [b'I', b'I', b'R', b'O' | b'S', ..]
                | [b'I', b'I', b'U', 0, ..]
                | [b'F', b'U', b'J', b'I', b'F', b'I', b'L', b'M', ..]
                | [_, _, _, _, b'f', b't', b'y', b'p', b'c', b'r', b'x', ..]
                | [b'F', b'O', b'V', b'b', ..]
                | [0, b'M', b'R', b'M', ..]
        )
}

/// How much of a file's end two files are told apart by, before they are compared whole.
const PRINT_BYTES: u64 = 4096;

/// The length of a file and its end: two photographs hardly ever have both in common.
fn print_of(path: &Path) -> io::Result<(u64, Vec<u8>)> {
    let mut file = File::open(path)?;
    let length = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(length.saturating_sub(PRINT_BYTES)))?;
    let mut end = Vec::new();
    file.take(PRINT_BYTES).read_to_end(&mut end)?;
    Ok((length, end))
}

/// Whether two files of one length hold the same.
fn are_same(a: &Path, b: &Path) -> io::Result<bool> {
    let [a, b] = [File::open(a)?, File::open(b)?].map(BufReader::new);
    let mut pairs = a.bytes().zip(b.bytes());
    let differs = |(a, b): (io::Result<u8>, io::Result<u8>)| match (a, b) {
        (Ok(a), Ok(b)) => a != b,
        _ => true,
    };
    Ok(!pairs.any(differs))
}
