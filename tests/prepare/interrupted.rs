//! Work that is interrupted, and disks that are full.

use std::{
    env,
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use recto::{
    manifest::Exhibit,
    maps::{MapError, encode},
    prepare::{self, PrepareError, Report, capture::Capture},
};

use super::folder;

const SIDE: usize = 120;

/// Where a test's own process finds a capture, and what it makes of it.
const CHILD_CAPTURE: &str = "RECTO_TEST_CAPTURE";
const CHILD_OUT: &str = "RECTO_TEST_OUT";

/// A number that looks as if it were drawn by chance.
fn mixed(seed: usize) -> usize {
    let mixed = (seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    mixed >> 40
}

/// Writes photographs of a sheet of `side` pixels, and a capture of them.
pub(super) fn capture(folder: &Path, side: usize) -> PathBuf {
    for i in 0..4 {
        let pixels: Vec<u16> = (0..side * side)
            .map(|p| {
                // Nowhere the same again: a pattern may be taken for itself, shifted.
                let (u, v) = (p % side / 7, p / side / 5);
                let stroke = mixed(u * 1000 + v).is_multiple_of(9);
                let noise = mixed(p * 4 + i) % 613;
                (if stroke { 9_000 } else { 38_000 } + 12 * noise) as u16
            })
            .collect();
        let path = folder.join(format!("r{i}.png"));
        encode::save_png_grey16(&path, side as u32, side as u32, &pixels, None).expect("written");
    }
    let text = "id = \"sheet\"\nencoding = \"linear\"\nscale.mm_per_px = 0.1\n\
                lamps = { azimuth_deg = [0, 90, 180, 270], elevation_deg = 45 }\n\
                recto.photographs = [\"r0.png\", \"r1.png\", \"r2.png\", \"r3.png\"]\n";
    let path = folder.join("capture.toml");
    fs::write(&path, text).expect("written");
    path
}

pub(super) fn run(capture: &Path, out: &Path) -> Result<Report, PrepareError> {
    let (capture, _) = Capture::read(capture).expect("a capture");
    prepare::run(&capture, out, &mut |_| {})
}

pub(super) fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

const WHOLE: [&str; 3] = ["exhibit.toml", "maps", "report.html"];

/// Not a test of its own: what the others start as a process that they end or starve.
#[test]
fn child() {
    let (Ok(capture), Ok(out)) = (env::var(CHILD_CAPTURE), env::var(CHILD_OUT)) else {
        return;
    };
    let out = PathBuf::from(out);
    let told = match run(Path::new(&capture), &out) {
        Ok(_) => "done".to_owned(),
        Err(error) => error.to_string(),
    };
    let _ = writeln!(io::stderr(), "told: {told}\nleft: {:?}", names(&out));
}

/// This test's own program, which runs [`child`].
fn child_of(capture: &Path, out: &Path, wrapped: &[&str]) -> Command {
    let program = env::current_exe().expect("this program");
    let mut command = match wrapped.split_first() {
        Some((first, rest)) => {
            let mut command = Command::new(first);
            command.args(rest).arg(program);
            command
        }
        None => Command::new(program),
    };
    command
        .args(["--exact", "interrupted::child", "--nocapture"])
        .env(CHILD_CAPTURE, capture)
        .env(CHILD_OUT, out);
    command
}

#[test]
fn what_was_killed_is_cleared_by_the_next_run() {
    let folder = folder();
    // Large enough to be at work for a while.
    let capture = capture(folder.path(), 900);
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("made");
    let mut child = child_of(&capture, &out, &[])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("started");
    let staged = |names: &[String]| names.iter().any(|name| name.starts_with(".recto-staging-"));
    for _ in 0..2000 {
        if staged(&names(&out)) || child.try_wait().expect("a state").is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(2));
    }
    child.kill().expect("killed");
    child.wait().expect("ended");
    let left = names(&out);
    assert!(
        staged(&left) && !left.contains(&"exhibit.toml".to_owned()),
        "{left:?}"
    );
    let report = run(&capture, &out).expect("prepared");
    assert_eq!(report.interrupted, 1);
    assert_eq!(names(&out), WHOLE);
    Exhibit::read(&out).expect("an exhibit");
}

#[test]
fn what_was_killed_while_it_took_its_place_is_cleared_too() {
    let folder = folder();
    let capture = capture(folder.path(), SIDE);
    let out = folder.path().join("out");
    run(&capture, &out).expect("prepared");
    // As if it had ended after the first change of names.
    let stage = out.join(".recto-staging-abc");
    fs::create_dir(&stage).expect("made");
    let order = "maps\nreport.html\nexhibit.toml";
    fs::write(stage.join(".publishing"), order).expect("written");
    for name in ["exhibit.toml", "report.html"] {
        fs::rename(out.join(name), stage.join(name)).expect("moved");
    }
    fs::write(out.join("notes.txt"), "mine").expect("written");
    let report = run(&capture, &out).expect("prepared");
    assert_eq!(report.interrupted, 1);
    assert_eq!(
        names(&out),
        ["exhibit.toml", "maps", "notes.txt", "report.html"]
    );
}

#[test]
fn what_is_somebody_elses_stays() {
    let folder = folder();
    let capture = capture(folder.path(), SIDE);
    let out = folder.path().join("out");
    for name in ["maps", "report.html"] {
        fs::create_dir_all(&out).expect("made");
        let own = out.join(name);
        fs::write(&own, "mine").expect("written");
        let error = run(&capture, &out).expect_err("it is there");
        assert!(
            matches!(&error, PrepareError::Exists(path) if *path == own),
            "{error}"
        );
        assert_eq!(names(&out), [name]);
        fs::remove_file(own).expect("removed");
    }
    // A staging folder that never began to take its place says nothing of what is there.
    fs::create_dir_all(out.join(".recto-staging-abc")).expect("made");
    fs::write(out.join("maps"), "mine").expect("written");
    assert!(matches!(run(&capture, &out), Err(PrepareError::Exists(_))));
    assert_eq!(fs::read_to_string(out.join("maps")).expect("text"), "mine");
}

#[test]
fn two_at_once_do_not_meet() {
    let folder = folder();
    let capture = capture(folder.path(), SIDE);
    let out = folder.path().join("out");
    let stage = out.join(".recto-staging-abc");
    fs::create_dir_all(&stage).expect("made");
    let lock = File::create(out.join(".recto.lock")).expect("made");
    lock.lock().expect("locked");
    let error = run(&capture, &out).expect_err("busy");
    assert!(matches!(error, PrepareError::Busy(_)));
    assert!(error.to_string().contains("at work"), "{error}");
    assert!(stage.exists());
    drop(lock);
    assert_eq!(run(&capture, &out).expect("prepared").interrupted, 1);
    assert_eq!(names(&out), WHOLE);
}

#[test]
fn a_full_disk_is_told_and_nothing_is_half_written() {
    let folder = folder();
    let path = folder.path().join("map.png");
    let full = |_: &mut io::BufWriter<encode::Kept<'_>>| Err(io::ErrorKind::StorageFull.into());
    let error = encode::write_whole(&path, full).expect_err("a full disk");
    assert!(matches!(error, MapError::Write { .. }));
    let told = error.to_string();
    assert!(
        told.contains("map.png") && told.contains("make room"),
        "{told}"
    );
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_disk_that_fills_up_is_told() {
    const MOUNTED: [&str; 5] = [
        "unshare",
        "-Urm",
        "sh",
        "-c",
        "mount -t tmpfs -o size=300k tmpfs \"$RECTO_TEST_OUT\" && exec \"$0\" \"$@\"",
    ];
    let folder = folder();
    let capture = capture(folder.path(), 300);
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("made");
    let output = child_of(&capture, &out, &MOUNTED).output();
    let told = output.map(|output| String::from_utf8_lossy(&output.stderr).into_owned());
    let told = match told {
        Ok(told) if told.contains("told:") => told,
        other => {
            // Without user namespaces there is no small disk to fill.
            let _ = writeln!(
                io::stderr(),
                "skipped: a_disk_that_fills_up_is_told: {other:?}"
            );
            return;
        }
    };
    assert!(
        told.contains("make room") && told.contains(".png"),
        "{told}"
    );
    assert!(told.contains("left: []"), "{told}");
}
