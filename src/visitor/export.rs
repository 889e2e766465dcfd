//! What is seen, exported: the program renders the view again without a window, as a print with scale
//! bar, legend and sidecar, or in numbers; and what was measured becomes a table.

use std::{
    collections::HashSet,
    env,
    ffi::OsString,
    io::{self, Write},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::{Mutex, PoisonError, mpsc},
    thread,
};

use bevy::prelude::*;
use glam::UVec2;

use super::{
    caption::Texts, glass::Glass, hand::Hand, intent::Intent, measuring::Measuring, notice::Notice,
};
use crate::{
    figure::bar::LEAST_PX,
    manifest::{Exhibit, SaveError},
    maps::encode,
    readings::table,
    stage::{Waker, say},
};

/// Names beside a picture that belong to it.
const BESIDE: [&str; 4] = ["png", "exr", "json", "csv"];

/// The running program, on Linux.
const ITSELF: &str = "/proc/self/exe";

/// Exports on their way.
#[derive(Resource)]
pub struct Exports {
    /// Where they go; without it, the folder that the program was started in.
    folder: Option<PathBuf>,
    /// Names that were given away, also those whose files are still to come.
    given: HashSet<PathBuf>,
    // Ends of channels are not Sync; only `export` takes them, and never blocks.
    ends: Option<Mutex<(mpsc::Sender<Done>, mpsc::Receiver<Done>)>>,
}

/// A picture that is there, or why not.
type Done = Result<PathBuf, String>;

/// Why nothing is exported.
#[derive(Debug, thiserror::Error)]
enum ExportError {
    #[error(transparent)]
    View(#[from] SaveError),
    #[error("{}: {error}", folder.display())]
    Folder { folder: PathBuf, error: io::Error },
    #[error("{}: {error}", path.display())]
    Program { path: PathBuf, error: io::Error },
    #[error("{0}")]
    Table(String),
}

/// Follows wishes to export, and says what became of them.
pub fn export(
    mut intents: MessageReader<Intent>,
    (hand, measuring, waker): (Res<Hand>, Res<Measuring>, Res<Waker>),
    (mut exports, mut texts): (ResMut<Exports>, ResMut<Texts>),
    glass: Res<Glass>,
) {
    let exports = exports.bypass_change_detection();
    for done in exports.done() {
        texts.notice = Some(match done {
            Ok(path) => Notice::Exported(path),
            Err(words) => {
                say(format_args!("recto: {words}"));
                Notice::NotExported
            }
        });
    }
    for intent in intents.read() {
        let Intent::Export { linear } = *intent else {
            continue;
        };
        let size = glass.pixels.max(UVec2::from(LEAST_PX));
        texts.notice = Some(
            match exports.begin(&hand, &measuring, size, linear, &waker) {
                Ok(path) => Notice::Exporting(path),
                Err(error) => {
                    say(format_args!("recto: {error}"));
                    Notice::NotExported
                }
            },
        );
    }
}

impl Exports {
    /// Into a folder; without one, into that which the program was started in.
    pub fn into(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            given: HashSet::new(),
            ends: None,
        }
    }

    /// What came to an end since the last time.
    fn done(&mut self) -> Vec<Done> {
        let ends = self.ends.as_mut().map(Mutex::get_mut);
        let ends = ends.map(|ends| ends.unwrap_or_else(PoisonError::into_inner));
        ends.map_or_else(Vec::new, |ends| ends.1.try_iter().collect())
    }

    /// Begins a picture of `size` pixels, and names its file.
    fn begin(
        &mut self,
        hand: &Hand,
        measuring: &Measuring,
        size: UVec2,
        linear: bool,
        waker: &Waker,
    ) -> Result<PathBuf, ExportError> {
        let (exhibit, scene) = hand.view();
        let link = exhibit.link(&scene)?;
        let folder = match &self.folder {
            Some(folder) => folder.clone(),
            None => env::current_dir().map_err(|error| ExportError::Folder {
                folder: PathBuf::from("."),
                error,
            })?,
        };
        std::fs::create_dir_all(&folder).map_err(|error| ExportError::Folder {
            folder: folder.clone(),
            error,
        })?;
        let stem = free(&folder, &exhibit.drawing_of(&scene).id, &self.given);
        self.given.insert(folder.join(&stem));
        let out = folder.join(&stem).with_added_extension(match linear {
            true => "exr",
            false => "png",
        });
        let csv = folder.join(&stem).with_added_extension("csv");
        if measuring.readings().next().is_some() {
            let text = table::csv(measuring.readings());
            encode::write_whole(&csv, |file| file.write_all(text.as_bytes()))
                .map_err(|error| ExportError::Table(error.to_string()))?;
        }
        let program = env::current_exe().map_err(|error| ExportError::Program {
            path: PathBuf::from("recto"),
            error,
        })?;
        // A program that was replaced while it runs is still its own process's.
        let program = match program.exists() {
            true => program,
            false => PathBuf::from(ITSELF),
        };
        let arguments = arguments(&exhibit, &link, size, hand.tier().name(), &out);
        let child = Command::new(&program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| ExportError::Program {
                path: program.clone(),
                error,
            })?;
        let ends = self.ends.get_or_insert_with(|| Mutex::new(mpsc::channel()));
        let ends = ends.get_mut().unwrap_or_else(PoisonError::into_inner);
        let (sender, waker, path) = (ends.0.clone(), waker.clone(), out.clone());
        thread::spawn(move || {
            let done = match child.wait_with_output() {
                Ok(output) if output.status.success() => Ok(path),
                Ok(output) => Err(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
                Err(error) => Err(format!("{}: {error}", program.display())),
            };
            // Nobody is left to tell when the program is closing.
            let _ = sender.send(done);
            (waker.0)();
        });
        Ok(out)
    }
}

/// What makes the picture: the command that its sidecar and K say as well.
fn arguments(exhibit: &Exhibit, link: &str, size: UVec2, tier: &str, out: &Path) -> Vec<OsString> {
    let size = format!("{}x{}", size.x, size.y);
    let manifest = exhibit.manifest.as_os_str();
    let plain = [
        "--link", link, "--size", &size, "--tier", tier, "--figure", "--out",
    ];
    let words = std::iter::once("render".into()).chain([manifest.to_owned()]);
    let words = words.chain(plain.map(OsString::from));
    words.chain([out.as_os_str().to_owned()]).collect()
}

/// `ID-1`, `ID-2`, …: the first that no file of the folder is called, and that was not given away.
fn free(folder: &Path, id: &str, given: &HashSet<PathBuf>) -> String {
    let stems = (1u32..).map(|number| format!("{id}-{number}"));
    let is_taken = |stem: &String| {
        let name = |extension| folder.join(stem).with_added_extension(extension);
        given.contains(&folder.join(stem))
            || BESIDE.iter().any(|extension| name(extension).exists())
    };
    stems
        .into_iter()
        .find(|stem| !is_taken(stem))
        .unwrap_or_else(|| id.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_file_is_ever_written_over() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut given = HashSet::new();
        let free = |given: &HashSet<PathBuf>| free(folder.path(), "sheet", given);
        assert_eq!(free(&given), "sheet-1");
        for name in ["sheet-1.csv", "sheet-2.png.json", "sheet-3.exr"] {
            std::fs::write(folder.path().join(name), "").expect("written");
        }
        assert_eq!(free(&given), "sheet-2");
        std::fs::write(folder.path().join("sheet-2.json"), "").expect("written");
        assert_eq!(free(&given), "sheet-4");
        // One whose picture is still being made.
        given.insert(folder.path().join("sheet-4"));
        assert_eq!(free(&given), "sheet-5");
    }
}
