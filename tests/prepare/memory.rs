//! What work on a large sheet holds at once: so many bytes for each of its pixels, which is what a
//! sheet of 50 million pixels is bounded by.

use std::{env, fs, hint::black_box, process::Command};

use recto::prepare::{
    capture::Filter,
    relief::{
        filter::split,
        integrate::{Slopes, integrate_free},
    },
};

const WIDTH: usize = 2000;
const HEIGHT: usize = 1500;
/// What a test's own process does.
const CHILD: &str = "RECTO_TEST_MEMORY";

/// The most that this process has held, in bytes.
fn most() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0)
}

fn slope(i: usize) -> f32 {
    0.3 * ((i % WIDTH) as f32 / 31.0).sin()
}

fn normals() -> Vec<[f32; 3]> {
    let all = 0..WIDTH * HEIGHT;
    all.map(|i| [slope(i), 0.0, (1.0 - slope(i).powi(2)).sqrt()])
        .collect()
}

/// What is at work while it is measured; what it is given is there before.
fn work(name: &str) -> Box<dyn FnOnce() -> usize> {
    match name {
        "gaussian" => {
            let normals = normals();
            Box::new(|| split(normals, WIDTH, 6.0, Filter::Gaussian).small.len())
        }
        "bilateral" => {
            let normals = normals();
            Box::new(|| split(normals, WIDTH, 0.6, Filter::Bilateral).small.len())
        }
        "integrate" => {
            let slopes = Slopes {
                width: WIDTH,
                right: (0..WIDTH * HEIGHT).map(slope).collect(),
                down: vec![0.1; WIDTH * HEIGHT],
            };
            Box::new(|| integrate_free(slopes).len())
        }
        // A copy of what it is given, which has to show.
        _ => {
            let normals = normals();
            // Compilers know that its length is the other's.
            Box::new(move || black_box(normals.clone()).len() + normals.len())
        }
    }
}

/// Not a test of its own: what the other starts as processes, so that nothing else is in them.
#[test]
fn child() {
    let Ok(name) = env::var(CHILD) else {
        return;
    };
    let work = work(&name);
    let Some(before) = most() else {
        return;
    };
    let done = work();
    let held = most().expect("as before") - before;
    assert!(done > 0);
    println!("held: {}", held / (WIDTH * HEIGHT) as f64);
}

/// Bytes for each pixel beside what `name` is given; `None` where the system does not tell.
fn held(name: &str) -> Option<f64> {
    let output = Command::new(env::current_exe().expect("this program"))
        .args(["--exact", "memory::child", "--nocapture"])
        .env(CHILD, name)
        // Each has buffers of its own, and how many are there at once is chance.
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("started");
    assert!(output.status.success(), "{name}: {output:?}");
    let text = String::from_utf8_lossy(&output.stdout);
    let told = text.lines().find_map(|line| line.split_once("held: "))?;
    Some(told.1.parse().expect("a number"))
}

#[test]
fn relief_holds_no_copies_of_a_sheet() {
    let Some(copy) = held("copy") else {
        eprintln!("skipped: this system does not tell what a process holds");
        return;
    };
    assert!((11.0..14.0).contains(&copy), "{copy}");
    // Vectors of 12 bytes for the shape at large, and the filter in its place.
    for filter in ["gaussian", "bilateral"] {
        let held = held(filter).expect("told");
        assert!((11.0..15.0).contains(&held), "{filter}: {held}");
    }
    // Two pictures of 8 bytes, where one of the slopes was that are given up (4), and the transforms' own tables, 2 for a
    // picture of this size. With a copy of the slopes it was above 16.
    let held = held("integrate").expect("told");
    assert!((7.0..15.5).contains(&held), "{held}");
}
