//! `recto prepare` beside the same steps in NumPy, turn by turn in one run on the same cores:
//! `cargo bench --bench prepare`. The solve alone, from photographs in memory; and the chain, from
//! files to maps. Each takes a turn that is not counted, and the least of its turns counts. `PYTHON`
//! names an interpreter that has NumPy (without one Recto is measured alone), `RECTO_BENCH_MPX` the
//! size of a photograph (24), `RECTO_BENCH_ROUNDS` the number of turns (4), and `solve` or `chain`
//! after `--` measures that one alone. On Linux seconds of processors are told too, which a busy
//! machine disturbs less, and the most memory that Recto held: of the chain, after `-- chain`.

use std::{
    env,
    error::Error,
    fs::{self, File},
    io::{BufRead, BufReader, BufWriter, Write},
    path::Path,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::Instant,
};

use rayon::prelude::*;
use recto::prepare::{
    self,
    capture::{Capture, Robustness},
    lights::direction,
    stereo::{Response, Rig, Rows, Solver},
};

const LAMPS: usize = 4;
const MM_PER_PX: f64 = 0.05;
const SPLIT_MM: f64 = 2.0;
const CARD: f64 = 0.5;
const ELEVATION_DEG: f64 = 45.0;

type Anything = Box<dyn Error>;

/// A script that works once for each line that it is sent.
struct Script {
    process: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Script {
    /// `None` where Python or NumPy is missing.
    fn start(name: &str, arguments: &[String]) -> Option<Self> {
        let python = env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let probe = ["-c", "import numpy"];
        let found = Command::new(&python)
            .args(probe)
            .stderr(Stdio::null())
            .status();
        if !found.is_ok_and(|status| status.success()) {
            return None;
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/prepare");
        let mut process = Command::new(&python)
            .arg(folder.join(name))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .ok()?;
        let ask = process.stdin.take()?;
        let answers = BufReader::new(process.stdout.take()?);
        Some(Self {
            process,
            ask,
            answers,
        })
    }

    /// Seconds, and what else it says.
    fn turn(&mut self) -> Result<(f64, String), Anything> {
        writeln!(self.ask)?;
        self.ask.flush()?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let (seconds, rest) = line.trim().split_once(' ').unwrap_or((line.trim(), ""));
        Ok((seconds.parse()?, rest.to_owned()))
    }

    fn end(mut self) -> Result<(), Anything> {
        drop(self.ask);
        self.process.wait()?;
        Ok(())
    }
}

fn number(name: &str, otherwise: f64) -> f64 {
    let text = env::var(name).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

fn load() -> String {
    fs::read_to_string("/proc/loadavg").map_or_else(
        |_| "unknown".to_owned(),
        |text| text.split(' ').next().unwrap_or_default().to_owned(),
    )
}

/// Seconds of all processors that a process has used, in its own code and in the system's; 0 where
/// the system does not tell.
fn processors(process: &str) -> f64 {
    /// USER_HZ, which proc(5) counts in.
    const TICKS: f64 = 100.0;
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // A name in brackets may hold spaces.
    let fields = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
    let ticks = fields.split_whitespace().skip(11).take(2);
    ticks
        .filter_map(|text| text.parse::<f64>().ok())
        .sum::<f64>()
        / TICKS
}

/// The most memory that this process has held, in words.
fn memory() -> String {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kib.map_or_else(
        || "unknown".to_owned(),
        |kib| format!("{:.2} GiB", kib / f64::from(1 << 20)),
    )
}

/// Turn by turn, and what the least of the turns of both say.
fn compare(
    name: &str,
    mut ours: impl FnMut() -> Result<String, Anything>,
    mut theirs: Option<Script>,
) -> Result<(), Anything> {
    let rounds = number("RECTO_BENCH_ROUNDS", 4.0) as usize;
    let of_script = theirs
        .as_ref()
        .map(|script| script.process.id().to_string());
    let used = |process: &Option<String>| process.as_deref().map_or(0.0, processors);
    // Seconds on the clock, and of processors.
    let (mut least, mut least_theirs) = ([f64::INFINITY; 2], [f64::INFINITY; 2]);
    for round in 0..=rounds {
        let (start, before) = (Instant::now(), processors("self"));
        let more = ours()?;
        let found = [start.elapsed().as_secs_f64(), processors("self") - before];
        let before = used(&of_script);
        let other = theirs.as_mut().map(Script::turn).transpose()?;
        let of_other = used(&of_script) - before;
        if round == 0 {
            continue;
        }
        least = least_of(least, found);
        print!(
            "{name} {round}: Recto {:.2} s, {:.2} s of processors {more}",
            found[0], found[1]
        );
        if let Some((seconds, more)) = other {
            least_theirs = least_of(least_theirs, [seconds, of_other]);
            print!("; NumPy {seconds:.2} s, {of_other:.2} s of processors ({more})");
        }
        println!("; load {}", load());
    }
    println!("{name}: at most {} held", memory());
    match theirs {
        Some(script) => {
            script.end()?;
            let [clock, work] = [0, 1].map(|i| least_theirs[i] / least[i]);
            println!(
                "{name}: {clock:.2} times as fast as NumPy, with {work:.2} times less work of processors"
            );
        }
        None => {
            println!(
                "{name}: {:.2} s; no NumPy: set PYTHON to an interpreter that has it",
                least[0]
            );
        }
    }
    Ok(())
}

fn least_of(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].min(b[1])]
}

fn lamps() -> Vec<[f64; 2]> {
    let azimuth = |i| 360.0 / LAMPS as f64 * i as f64;
    (0..LAMPS).map(|i| [azimuth(i), ELEVATION_DEG]).collect()
}

fn solve([width, height]: [usize; 2]) -> Result<(), Anything> {
    let noise = |i: usize| {
        let mixed = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        0.5 + 0.1 * ((mixed ^ mixed >> 29) >> 40) as f32 / (1 << 24) as f32
    };
    let count = width * height;
    let plane = |p: usize| {
        (0..count)
            .into_par_iter()
            .map(|i| noise(p * count + i))
            .collect()
    };
    let planes: Vec<[Vec<f32>; 3]> = (0..LAMPS)
        .map(|lamp| [0, 1, 2].map(|c| plane(3 * lamp + c)))
        .collect();
    let towards = lamps()
        .into_iter()
        .map(|[azimuth, elevation]| direction(azimuth, elevation));
    let solver = Solver {
        rig: Rig::far(towards.collect()),
        response: Response::Lambert,
        robustness: Robustness::None,
    };
    let ours = || {
        let solved = solver.solve(Rows {
            planes: &planes,
            width,
            top: 0,
        });
        Ok(format!("({} normals)", solved.normal.len()))
    };
    let arguments = [width, height, LAMPS].map(|v| v.to_string());
    compare("solve", ours, Script::start("numpy_stereo.py", &arguments))
}

/// Writes 16-bit RGB without compression, strip after strip from byte 8 on.
fn tiff(
    path: &Path,
    [width, height]: [usize; 2],
    at: impl Fn(usize, usize) -> [f32; 3] + Sync,
) -> Result<(), Anything> {
    const ROWS_PER_STRIP: usize = 64;
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let bytes = (width * height * 6) as u32;
    file.write_all(b"II*\0")?;
    let strips = height.div_ceil(ROWS_PER_STRIP);
    let strip_bytes = (width * ROWS_PER_STRIP * 6) as u32;
    // Offsets and lengths of strips follow the pixels, then three times 16 bits, then the directory.
    let offsets = 8 + bytes;
    let lengths = offsets + 4 * strips as u32;
    let depths = lengths + 4 * strips as u32;
    let directory = depths + 8;
    file.write_all(&directory.to_le_bytes())?;
    for top in (0..height).step_by(16) {
        let rows: Vec<u8> = (top..(top + 16).min(height))
            .into_par_iter()
            .flat_map_iter(|y| {
                let at = &at;
                (0..width).flat_map(move |x| {
                    let codes = at(x, y).map(|v| (v.clamp(0.0, 1.0) * 65535.0) as u16);
                    codes.into_iter().flat_map(u16::to_le_bytes)
                })
            })
            .collect();
        file.write_all(&rows)?;
    }
    for i in 0..strips as u32 {
        file.write_all(&(8 + i * strip_bytes).to_le_bytes())?;
    }
    for i in 0..strips as u32 {
        file.write_all(&strip_bytes.min(bytes - i * strip_bytes).to_le_bytes())?;
    }
    file.write_all(&[16, 0, 16, 0, 16, 0, 0, 0])?;
    const SHORT: u16 = 3;
    const LONG: u16 = 4;
    let strips = strips as u32;
    let entries = [
        (256, LONG, 1, width as u32),
        (257, LONG, 1, height as u32),
        (258, SHORT, 3, depths),
        (259, SHORT, 1, 1),
        (262, SHORT, 1, 2),
        (273, LONG, strips, offsets),
        (277, SHORT, 1, 3),
        (278, LONG, 1, ROWS_PER_STRIP as u32),
        (279, LONG, strips, lengths),
    ];
    file.write_all(&(entries.len() as u16).to_le_bytes())?;
    for (tag, kind, count, value) in entries {
        file.write_all(&u16::to_le_bytes(tag))?;
        file.write_all(&u16::to_le_bytes(kind))?;
        file.write_all(&u32::to_le_bytes(count))?;
        file.write_all(&u32::to_le_bytes(value))?;
    }
    file.write_all(&[0; 4])?;
    file.flush()?;
    Ok(())
}

/// A sheet with grain, cockling and strokes.
fn shown(lamp: usize, x: usize, y: usize) -> [f32; 3] {
    let mixed = ((y * 100_003 + x) as u64 * 7 + lamp as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let noise = ((mixed ^ mixed >> 29) >> 40) as f32 / (1 << 24) as f32 - 0.5;
    let (u, v) = (x as f32, y as f32);
    let turn = lamp as f32 * std::f32::consts::TAU / LAMPS as f32;
    let slope = [
        0.06 * (u / 700.0).cos() + 0.08 * (u / 9.0).sin(),
        0.05 * (v / 900.0).sin(),
    ];
    let light = 0.7 - 0.7 * (slope[0] * turn.cos() - slope[1] * turn.sin());
    let ink = if (x / 9 + y / 5).is_multiple_of(11) {
        0.25
    } else {
        1.0
    };
    [0.8, 0.7, 0.55].map(|albedo| light * albedo * ink + 0.004 * noise)
}

fn chain(size: [usize; 2]) -> Result<(), Anything> {
    let folder = tempfile::tempdir()?;
    let path = |name: &str| folder.path().join(name);
    let [width, height] = size;
    let mut text = format!("{width} {height} {MM_PER_PX} {SPLIT_MM} {CARD}\n");
    let mut names = [Vec::new(), Vec::new()];
    for (i, [azimuth, elevation]) in lamps().into_iter().enumerate() {
        text += &format!("{azimuth} {elevation}\n");
        let [photograph, grey] = ["photograph", "grey"].map(|name| format!("{name}-{i}.tif"));
        let fall_off = |x: usize, y: usize| {
            let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
            0.9 - 0.2 * ((u - 0.5).powi(2) + (v - 0.4).powi(2))
        };
        tiff(&path(&photograph), size, |x, y| {
            shown(i, x, y).map(|v| v * fall_off(x, y))
        })?;
        tiff(&path(&grey), size, |x, y| {
            [CARD as f32 * 0.7 * fall_off(x, y); 3]
        })?;
        names[0].push(photograph);
        names[1].push(grey);
    }
    fs::write(path("lamps.txt"), text)?;
    let azimuths: Vec<f64> = lamps().into_iter().map(|[azimuth, _]| azimuth).collect();
    let capture = format!(
        "id = \"bench\"\nencoding = \"linear\"\nscale.mm_per_px = {MM_PER_PX}\n\
         [lamps]\nazimuth_deg = {azimuths:?}\nelevation_deg = {ELEVATION_DEG:?}\n\
         flat_field = {:?}\ngrey_card = {CARD}\n[recto]\nphotographs = {:?}\n\
         [relief]\nsplit_mm = {SPLIT_MM:?}\n",
        names[1], names[0],
    );
    fs::write(path("capture.toml"), capture)?;
    let (capture, _) = Capture::read(&path("capture.toml"))?;
    let out = path("out");
    let ours = || {
        if out.exists() {
            fs::remove_dir_all(&out)?;
        }
        let start = Instant::now();
        let mut last = ("", 0.0);
        let mut steps: Vec<(&str, f64)> = Vec::new();
        prepare::run(&capture, &out, &mut |progress| {
            let now = start.elapsed().as_secs_f64();
            match steps.iter_mut().find(|(name, _)| *name == last.0) {
                Some(step) => step.1 += now - last.1,
                None => steps.push((last.0, now - last.1)),
            }
            last = (progress.step, now);
        })?;
        let each = steps
            .iter()
            .skip(1)
            .map(|(name, s)| format!("{name} {s:.2}"));
        Ok(format!("({})", each.collect::<Vec<_>>().join(" ")))
    };
    let arguments = [folder.path().display().to_string()];
    compare("chain", ours, Script::start("numpy_chain.py", &arguments))
}

fn main() -> Result<(), Anything> {
    let wanted: Vec<String> = env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    let pixels = number("RECTO_BENCH_MPX", 24.0) * 1e6;
    let height = ((pixels / 1.5).sqrt()) as usize;
    let size = [(pixels / height as f64) as usize, height];
    println!(
        "{LAMPS} × {} × {} pixels, {} threads",
        size[0],
        size[1],
        rayon::current_num_threads()
    );
    if is_wanted("solve") {
        solve(size)?;
    }
    if is_wanted("chain") {
        chain(size)?;
    }
    Ok(())
}
