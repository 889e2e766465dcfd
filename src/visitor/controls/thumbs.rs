//! Small pictures of the scenes, rendered by the program itself in a process of its own, once for each
//! version of an exhibit, and kept where the user's caches are.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::Arc,
    thread,
    time::Duration,
};

use bevy::{
    asset::RenderAssetUsages,
    platform::collections::HashMap,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

use super::{Interface, Panel};
use crate::{
    cost,
    manifest::exhibit::Exhibit,
    stage::{Shown, Waker},
};

/// Size of the pictures in pixels.
const SIZE: &str = "264x180";
/// Between two looks at what the process has finished.
const LOOK: Duration = Duration::from_millis(700);
/// How deep below its folder an exhibit's files lie.
const DEPTH: usize = 4;
/// The running program, also where its file was replaced.
const ITSELF: &str = "/proc/self/exe";

/// The pictures of the exhibit's scenes that are there.
#[derive(Resource, Default)]
pub struct Thumbs {
    pictures: HashMap<usize, Handle<Image>>,
    /// The exhibit that they are of, and where they are kept.
    of: Option<(Arc<Exhibit>, Option<PathBuf>)>,
    at_work: Option<Work>,
    /// Renders them; without it there are none.
    program: Option<PathBuf>,
}

/// A process that renders, which ends with this one.
struct Work(Child);

impl Drop for Work {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Thumbs {
    /// Rendered by the program that runs.
    pub fn by_itself() -> Self {
        let program = env::current_exe().ok();
        // A program that was replaced while it runs is still its own process's.
        let program = program.map(|path| match path.exists() {
            true => path,
            false => PathBuf::from(ITSELF),
        });
        Self {
            program,
            ..Self::default()
        }
    }

    /// The picture of a scene.
    pub fn get(&self, scene: usize) -> Option<Handle<Image>> {
        self.pictures.get(&scene).cloned()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.pictures.len()
    }
}

/// Has them rendered when somebody first looks at them, and takes in those that are there.
pub fn gather(
    (shown, interface, waker): (Res<Shown>, Res<Interface>, Option<Res<Waker>>),
    mut images: ResMut<Assets<Image>>,
    mut thumbs: ResMut<Thumbs>,
) {
    let (Some(waker), true) = (waker, interface.open.contains(&Panel::Scenes)) else {
        return;
    };
    let exhibit = exhibit_of(&shown, &thumbs);
    if let Some(exhibit) = exhibit {
        thumbs.pictures.clear();
        thumbs.at_work = None;
        let folder = folder(&exhibit);
        if let Some(folder) = &folder
            && !is_complete(folder, &exhibit)
            && let Some(program) = &thumbs.program
        {
            thumbs.at_work = begin(program, &exhibit, folder, &waker).ok();
        }
        thumbs.of = Some((exhibit, folder));
    }
    let Some((exhibit, Some(folder))) = thumbs.of.clone() else {
        return;
    };
    if thumbs.pictures.len() == exhibit.scenes.len() {
        return;
    }
    for (index, scene) in exhibit.scenes.iter().enumerate() {
        if thumbs.pictures.contains_key(&index) {
            continue;
        }
        if let Some(image) = picture(&folder.join(&scene.id).with_added_extension("png")) {
            let handle = images.add(image);
            thumbs.pictures.insert(index, handle);
        }
    }
}

/// The exhibit that is shown, where it is another one than that of the pictures. One whose lamp was moved
/// is the same.
fn exhibit_of(shown: &Shown, thumbs: &Thumbs) -> Option<Arc<Exhibit>> {
    let same = |(of, _): &(Arc<Exhibit>, Option<PathBuf>)| {
        of.manifest == shown.exhibit.manifest
            && of.scenes == shown.exhibit.scenes
            && of.drawings == shown.exhibit.drawings
    };
    (!thumbs.of.as_ref().is_some_and(same)).then(|| shown.exhibit.clone())
}

/// Where the pictures of this version of an exhibit are kept: its manifest's text, and the names, times
/// and lengths of the files beside it, name it.
fn folder(exhibit: &Exhibit) -> Option<PathBuf> {
    let mut hash = blake3::Hasher::new();
    hash.update(env!("CARGO_PKG_VERSION").as_bytes());
    hash.update(exhibit.manifest.as_os_str().as_encoded_bytes());
    hash.update(&fs::read(&exhibit.manifest).ok()?);
    let mut files = Vec::new();
    list(exhibit.manifest.parent()?, DEPTH, &mut files);
    files.sort();
    for (path, said) in files {
        hash.update(path.as_os_str().as_encoded_bytes());
        hash.update(said.as_bytes());
    }
    let name = hash.finalize().to_hex();
    Some(cost::cache_folder()?.join("scenes").join(&name[..24]))
}

/// The files of a folder and of those in it, with their lengths and times.
fn list(folder: &Path, depth: usize, files: &mut Vec<(PathBuf, String)>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let Ok(data) = entry.metadata() else {
            continue;
        };
        if data.is_dir() && depth > 0 {
            list(&entry.path(), depth - 1, files);
        } else {
            let said = format!("{} {:?}", data.len(), data.modified().ok());
            files.push((entry.path(), said));
        }
    }
}

fn is_complete(folder: &Path, exhibit: &Exhibit) -> bool {
    let file = |id: &str| folder.join(id).with_added_extension("png");
    exhibit.scenes.iter().all(|scene| file(&scene.id).exists())
}

/// Begins to render them; whoever waits is woken by each that is finished.
fn begin(program: &Path, exhibit: &Exhibit, folder: &Path, waker: &Waker) -> io::Result<Work> {
    fs::create_dir_all(folder)?;
    let child = Command::new(program)
        .arg("render")
        .arg(&exhibit.manifest)
        .args(["--all-scenes", "--tier", "draft", "--size", SIZE, "--out"])
        .arg(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    let (folder, waker) = (folder.to_owned(), waker.clone());
    let all = exhibit.scenes.len();
    thread::spawn(move || {
        let mut before = 0;
        // One that never finishes is not waited for longer than it takes.
        for _ in 0..600 {
            thread::sleep(LOOK);
            let there = fs::read_dir(&folder).map_or(0, Iterator::count);
            if there != before {
                before = there;
                (waker.0)();
            }
            if there > all {
                return;
            }
        }
    });
    Ok(Work(child))
}

fn picture(path: &Path) -> Option<Image> {
    let file = fs::File::open(path).ok()?;
    let mut decoder = png::Decoder::new(io::BufReader::new(file));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().ok()?;
    let mut rgba = vec![0; reader.output_buffer_size()?];
    let frame = reader.next_frame(&mut rgba).ok()?;
    let (width, height) = (frame.width, frame.height);
    if rgba.len() != (width * height * 4) as usize {
        return None;
    }
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let format = TextureFormat::Rgba8UnormSrgb;
    let usage = RenderAssetUsages::RENDER_WORLD;
    Some(Image::new(size, TextureDimension::D2, rgba, format, usage))
}
