//! `recto publish`: the last good version or the whole new one, whoever interrupts it.

use std::{
    fs,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
    process::Command,
    sync::atomic::{AtomicBool, Ordering},
    thread,
};

use recto::{
    manifest::{Exhibit, published},
    maps::encode,
};
use tempfile::TempDir;

use super::{code, recto};

/// An exhibit, and where it is published to.
struct Museum {
    root: TempDir,
}

impl Museum {
    fn new() -> Self {
        let museum = Self {
            root: tempfile::tempdir().unwrap(),
        };
        fs::create_dir(museum.exhibit()).unwrap();
        museum.write(1);
        museum
    }

    fn exhibit(&self) -> PathBuf {
        self.root.path().join("exhibit")
    }

    fn wall(&self) -> PathBuf {
        self.root.path().join("wall")
    }

    /// A version whose title and picture belong together.
    fn write(&self, edge: u32) {
        let maps = self.exhibit().join("maps");
        fs::create_dir_all(&maps).unwrap();
        let pixels = vec![[200; 3]; (edge * edge) as usize];
        encode::save_png_rgb8(&maps.join("a.png"), edge, edge, &pixels, None).unwrap();
        let manifest = format!(
            "[exhibit]\ntitle = \"{edge}\"\n[[drawing]]\nid = \"a\"\nsize_mm = [20, 20]\n\
             recto.albedo = \"maps/a.png\"\n"
        );
        fs::write(self.exhibit().join("exhibit.toml"), manifest).unwrap();
    }

    fn command(&self) -> Command {
        let mut command = recto();
        command.arg("publish").arg(self.exhibit());
        command.arg("--to").arg(self.wall());
        command
    }

    #[track_caller]
    fn publish(&self) -> String {
        let output = self.command().output().unwrap();
        code(&output, 0);
        String::from_utf8(output.stdout).unwrap().trim().to_owned()
    }

    /// The number of the version that is shown, if its parts belong together.
    fn shown(&self) -> u32 {
        let (exhibit, _) = Exhibit::read(&self.wall()).unwrap();
        let title: u32 = exhibit.title.0["en"].parse().unwrap();
        let albedo = &exhibit.drawings[0].recto.albedo.file;
        assert_eq!(albedo.size, [title; 2], "{}", albedo.path.display());
        title
    }

    /// The names of all that lies among the versions.
    fn versions(&self) -> Vec<String> {
        names(&self.wall().join("versions"))
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_reader_never_sees_half_an_exhibit() {
    /// How many versions are published while somebody reads.
    const VERSIONS: u32 = 24;
    let museum = Museum::new();
    museum.publish();
    let over = AtomicBool::new(false);
    let reads = thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut seen = vec![museum.shown()];
            while !over.load(Ordering::Relaxed) {
                let shown = museum.shown();
                if seen.last() != Some(&shown) {
                    seen.push(shown);
                }
            }
            seen
        });
        for edge in 2..=VERSIONS {
            museum.write(edge);
            museum.publish();
        }
        over.store(true, Ordering::Relaxed);
        reader.join().unwrap()
    });
    assert!(reads.is_sorted(), "none comes back: {reads:?}");
    assert!(reads.len() > 5, "it was read meanwhile: {reads:?}");
    assert_eq!(museum.shown(), VERSIONS);
    assert_eq!(museum.versions().len(), 5, "the last ones are kept");
}

#[test]
fn what_is_shown_is_a_version_of_its_own() {
    let museum = Museum::new();
    let version = museum.publish();
    let (exhibit, _) = Exhibit::read(&museum.wall()).unwrap();
    assert_eq!(exhibit.published, Some(museum.wall()));
    assert_eq!(exhibit.folder, PathBuf::from(&version));
    museum.write(3);
    let (same, _) = Exhibit::read(&exhibit.manifest).unwrap();
    assert_eq!(same.title, exhibit.title, "it is a copy");
    assert_eq!(same.published, None);
    let second = museum.publish();
    // Going back is publishing an older version again.
    let mut back = recto();
    back.arg("publish")
        .arg(&version)
        .arg("--to")
        .arg(museum.wall());
    code(&back.output().unwrap(), 0);
    assert_eq!(museum.shown(), 1);
    assert_ne!(version, second);
}

#[test]
fn the_same_files_are_not_published_twice() {
    let museum = Museum::new();
    let first = museum.publish();
    let output = museum.command().output().unwrap();
    assert!(code(&output, 0).contains("shown already"));
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), first);
    assert_eq!(museum.versions().len(), 1);
}

#[test]
fn a_faulty_exhibit_is_refused_and_the_last_one_stays() {
    let museum = Museum::new();
    museum.publish();
    let before = museum.versions();
    museum.write(2);
    let picture = museum.exhibit().join("maps/a.png");
    let bytes = fs::read(&picture).unwrap();
    // Its header is sound, and its pixels are not.
    fs::write(&picture, &bytes[..bytes.len() - 20]).unwrap();
    let stderr = code(&museum.command().output().unwrap(), 1);
    assert!(stderr.contains("a.png"), "{stderr}");
    fs::write(
        museum.exhibit().join("exhibit.toml"),
        "[exhibit]\ntitel = 1\n",
    )
    .unwrap();
    let stderr = code(&museum.command().output().unwrap(), 1);
    assert!(stderr.contains("exhibit.toml:2:1"), "{stderr}");
    assert_eq!(museum.shown(), 1);
    assert_eq!(museum.versions(), before);
}

#[test]
fn what_an_interrupted_one_left_is_removed_by_the_next() {
    let museum = Museum::new();
    museum.publish();
    let left = museum.wall().join("versions/.publishing-Xk2p9");
    fs::create_dir_all(left.join("maps")).unwrap();
    fs::write(left.join("maps/half.png"), "half").unwrap();
    symlink(
        "versions/nothing",
        museum.wall().join(".publishing-current"),
    )
    .unwrap();
    let own = museum.wall().join("versions/notes-of-the-curator");
    fs::create_dir(&own).unwrap();
    assert_eq!(museum.shown(), 1, "nobody takes it for a version");
    museum.write(2);
    museum.publish();
    assert!(!left.exists() && own.exists());
    assert_eq!(museum.shown(), 2);
    assert_eq!(
        names(&museum.wall()),
        [".publish.lock", "current", "versions"]
    );
}

#[test]
fn killed_at_any_moment_it_leaves_the_last_version_or_the_new_one() {
    let museum = Museum::new();
    museum.publish();
    // Enough to be copied for a while.
    let noise: Vec<u8> = (0..4_000_000_u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    for k in 0..8 {
        fs::write(museum.exhibit().join(format!("maps/extra-{k}.bin")), &noise).unwrap();
    }
    for (edge, wait) in (2_u32..).zip([0, 1, 5, 10, 20, 30, 40, 60]) {
        museum.write(edge);
        let mut child = museum.command().spawn().unwrap();
        thread::sleep(std::time::Duration::from_millis(wait));
        child.kill().unwrap();
        child.wait().unwrap();
        // Some one of those so far, whole.
        assert!((1..=edge).contains(&museum.shown()));
    }
    museum.write(99);
    museum.publish();
    assert_eq!(museum.shown(), 99);
    let unfinished = |name: &String| name.starts_with('.');
    assert!(!museum.versions().iter().any(unfinished));
}

#[test]
fn a_full_disk_is_told_and_nothing_changes() {
    let museum = Museum::new();
    museum.publish();
    let before = museum.versions();
    museum.write(2);
    fs::write(museum.exhibit().join("maps/large.bin"), vec![7; 300_000]).unwrap();
    // A file may not grow beyond 64 blocks, of 512 or 1024 bytes; the signal that says so is
    // ignored, and the write fails as on a full disk.
    let limited = Command::new("sh")
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 64; exec \"$@\"")
        .arg("sh")
        .arg(env!("CARGO_BIN_EXE_recto"))
        .arg("publish")
        .arg(museum.exhibit())
        .arg("--to")
        .arg(museum.wall())
        .output()
        .unwrap();
    let stderr = code(&limited, 1);
    assert!(
        stderr.contains("no room for the 1 MB of the exhibit"),
        "{stderr}"
    );
    assert_eq!(museum.shown(), 1);
    assert_eq!(museum.versions(), before);
    museum.publish();
    assert_eq!(museum.shown(), 2);
}

#[test]
fn strange_places_are_refused_in_words() {
    let museum = Museum::new();
    let to = |root: &Path| {
        let mut command = recto();
        command
            .arg("publish")
            .arg(museum.exhibit())
            .arg("--to")
            .arg(root);
        code(&command.output().unwrap(), 1)
    };
    let stderr = to(&museum.exhibit().join("published"));
    assert!(
        stderr.contains("lies in the exhibit's own folder"),
        "{stderr}"
    );
    fs::remove_dir_all(museum.exhibit().join("published")).unwrap();
    fs::create_dir_all(museum.wall().join("current")).unwrap();
    let stderr = to(&museum.wall());
    assert!(stderr.contains("neither a link nor a file"), "{stderr}");
    let file = museum.root.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(to(&file).contains("file/versions"));
    let stderr = code(
        &museum.command().arg("--keep").arg("1").output().unwrap(),
        2,
    );
    assert!(stderr.contains("from 2 to 1000"), "{stderr}");
}

#[test]
fn a_pointer_that_is_a_file_serves_where_there_are_no_links() {
    let museum = Museum::new();
    let version = museum.publish();
    let name = Path::new(&version).file_name().unwrap().to_str().unwrap();
    let pointer = museum.wall().join("current");
    fs::remove_file(&pointer).unwrap();
    fs::write(&pointer, format!("versions/{name}\n")).unwrap();
    assert_eq!(museum.shown(), 1);
    museum.write(2);
    museum.publish();
    assert_eq!(museum.shown(), 2);
    assert!(published::pointed_to(&museum.wall()).is_some());
}

#[test]
fn links_out_of_the_folder_and_version_control_are_not_copied() {
    let museum = Museum::new();
    fs::create_dir(museum.exhibit().join(".git")).unwrap();
    fs::write(museum.exhibit().join(".git/config"), "secret").unwrap();
    symlink("/etc", museum.exhibit().join("system")).unwrap();
    symlink(museum.exhibit(), museum.exhibit().join("maps/round")).unwrap();
    let version = PathBuf::from(museum.publish());
    assert!(!version.join(".git").exists() && !version.join("system").exists());
    assert_eq!(names(&version.join("maps")), ["a.png"]);
    assert_eq!(museum.shown(), 1);
}
