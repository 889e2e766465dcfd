//! Ids of IIIF, which are addresses on the web → files beside the manifest.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

/// Longer paths are no addresses of pictures.
const MOST_SEGMENTS: usize = 64;
/// Formats of pictures that may have been downloaded.
const EXTENSIONS: [&str; 6] = ["jpg", "jpeg", "png", "tif", "tiff", "webp"];

/// The files beside a manifest.
pub struct Beside {
    /// Without links.
    folder: PathBuf,
    /// The address that the folder has, as the manifest's own id says, with a / at its end.
    base: Option<String>,
}

/// Why an id names no file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unresolved {
    /// No address of the web, or one that climbs out of its folder.
    NoAddress,
    /// No such file; it would be this one.
    Absent(String),
    /// There is one, behind a link that leads out of the folder.
    Outside(String),
}

impl Beside {
    pub fn new(folder: PathBuf, manifest_id: Option<&str>) -> Self {
        let base = manifest_id.and_then(|id| id.rsplit_once('/'));
        Self {
            folder,
            base: base.map(|(base, _)| format!("{base}/")),
        }
    }

    /// The file that one of these ids, the best first, means, and its path from the folder with /
    /// between its parts: by its path from the manifest's address, or as much of the end of its path as
    /// there is a file for.
    ///
    /// # Errors
    /// Of the first id.
    pub fn find(&self, ids: &[&str]) -> Result<(PathBuf, String), Unresolved> {
        let mut first = None;
        for id in ids {
            match self.find_one(id) {
                Ok(found) => return Ok(found),
                Err(why) => {
                    first.get_or_insert(why);
                }
            }
        }
        Err(first.unwrap_or(Unresolved::NoAddress))
    }

    fn find_one(&self, id: &str) -> Result<(PathBuf, String), Unresolved> {
        let address = id.split(['?', '#']).next().unwrap_or_default();
        let path = address
            .strip_prefix("https://")
            .or_else(|| address.strip_prefix("http://"))
            .and_then(|rest| rest.split_once('/'))
            .map(|(_, path)| path)
            .ok_or(Unresolved::NoAddress)?;
        let segments = segments(path)?;
        let own = match self
            .base
            .as_deref()
            .and_then(|base| address.strip_prefix(base))
        {
            Some(rest) => Some(self::segments(rest)?),
            None => None,
        };
        let mut candidates: Vec<String> = own.iter().map(|own| own.join("/")).collect();
        candidates.extend((0..segments.len()).map(|from| segments[from..].join("/")));
        candidates.extend(downloaded(&segments));
        let mut outside = None;
        for candidate in &candidates {
            let Ok(real) = self.folder.join(candidate).canonicalize() else {
                continue;
            };
            if !real.starts_with(&self.folder) {
                outside.get_or_insert(candidate);
            } else if real.is_file() {
                return Ok((real, candidate.clone()));
            }
        }
        Err(match outside {
            Some(candidate) => Unresolved::Outside(candidate.clone()),
            None => Unresolved::Absent(
                // Of a service the name of what it serves, otherwise the last part.
                downloaded(&segments)
                    .into_iter()
                    .next()
                    .or_else(|| own.map(|own| own.join("/")))
                    .or_else(|| segments.last().cloned())
                    .unwrap_or_default(),
            ),
        })
    }
}

/// The parts of a path, decoded.
fn segments(path: &str) -> Result<Vec<String>, Unresolved> {
    let parts = path.split('/').filter(|part| !part.is_empty());
    let parts: Option<Vec<String>> = parts.map(decoded).collect();
    let parts = parts.ok_or(Unresolved::NoAddress)?;
    let climbs = |part: &String| {
        matches!(part.as_str(), "." | "..")
            || part.contains(['/', '\\'])
            || part.contains(char::is_control)
            // A drive of Windows.
            || Path::new(part).components().count() != 1
    };
    match parts.is_empty() || parts.len() > MOST_SEGMENTS || parts.iter().any(climbs) {
        true => Err(Unresolved::NoAddress),
        false => Ok(parts),
    }
}

/// What somebody may have called the picture that they downloaded from an image service:
/// `IDENTIFIER/full/max/0/default.jpg`, or the service itself (IIIF Image API 3.0, section 4).
fn downloaded(segments: &[String]) -> Vec<String> {
    let identifier = match segments {
        [.., identifier, _, _, rotation, quality]
            if rotation.trim_start_matches('!').parse::<f64>().is_ok()
                && ["default.", "native.", "color.", "gray."]
                    .iter()
                    .any(|start| quality.starts_with(start)) =>
        {
            identifier
        }
        _ => return Vec::new(),
    };
    let named = EXTENSIONS
        .iter()
        .map(|extension| format!("{identifier}.{extension}"));
    named.chain([identifier.clone()]).collect()
}

/// A part of a path without %; `None` where it is no UTF-8 then.
fn decoded(part: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(part.len());
    let mut rest = part.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = (byte == b'%').then(|| after.get(..2)).flatten();
        let code = code.and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(code) => {
                bytes.push(code);
                rest = &after[2..];
            }
            None => {
                bytes.push(byte);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

/// A path as part of an address.
pub fn encoded(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => {
                out.push(char::from(byte));
            }
            other => {
                // Writing to a string does not fail.
                let _ = write!(out, "%{other:02X}");
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn ids_find_files_and_never_leave_the_folder() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("here");
        fs::create_dir_all(folder.join("images/a")).unwrap();
        for file in ["images/a/1.png", "2 b.jpg", "f7.tif"] {
            fs::write(folder.join(file), "x").unwrap();
        }
        fs::write(root.path().join("secret.png"), "x").unwrap();
        let folder = folder.canonicalize().unwrap();
        let beside = Beside::new(folder.clone(), Some("https://m.org/x/manifest.json"));
        let finds = |id: &str, path: &str| {
            let (file, found) = beside.find(&[id]).expect(id);
            assert_eq!((file, found.as_str()), (folder.join(path), path), "{id}");
        };
        finds("https://m.org/x/images/a/1.png", "images/a/1.png");
        finds(
            "http://elsewhere.org/deep/images/a/1.png?x=y",
            "images/a/1.png",
        );
        finds("https://m.org/2%20b.jpg#xywh=1,1,1,1", "2 b.jpg");
        finds("https://m.org/iiif/3/f7/full/max/0/default.jpg", "f7.tif");
        for id in [
            "https://m.org/x/../secret.png",
            "https://m.org/x/%2e%2e/secret.png",
            "https://m.org/x/..%2fsecret.png",
            "https://m.org/x/..%5csecret.png",
            "file:///etc/passwd",
            "../secret.png",
            "https://m.org",
            "",
            &format!("https://m.org/{}", "a/".repeat(10_000)),
        ] {
            assert_eq!(beside.find(&[id]), Err(Unresolved::NoAddress), "{id:.60}");
        }
        let absent = beside.find(&["https://m.org/iiif/f9/full/max/0/default.jpg"]);
        assert_eq!(absent, Err(Unresolved::Absent("f9.jpg".to_owned())));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.path().join("secret.png"), folder.join("s.png"))
                .unwrap();
            let outside = beside.find(&["https://m.org/s.png"]);
            assert_eq!(outside, Err(Unresolved::Outside("s.png".to_owned())));
        }
        assert_eq!(encoded("a b/ü.png"), "a%20b/%C3%BC.png");
    }
}
