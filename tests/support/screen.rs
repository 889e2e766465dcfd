//! An X server of a test's own, with a mouse: what is on its screen can be looked at, and touched.

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    os::unix::net::UnixStream,
    path::PathBuf,
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

/// Set to skip these tests on a machine that cannot have an X server.
const SKIP: &str = "RECTO_SKIP_WINDOW";

/// Types of core events, as XTEST fakes them.
const PRESS: u8 = 4;
const RELEASE: u8 = 5;
const MOTION: u8 = 6;

/// A process that ends with the test.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Whether such tests are to be skipped, which is told.
pub fn is_skipped() -> bool {
    let skipped = std::env::var_os(SKIP).is_some();
    if skipped {
        eprintln!("skipped: {SKIP} is set");
    }
    skipped
}

/// A server, and the screen that it serves.
pub struct Screen {
    _server: Running,
    /// As `DISPLAY` has it.
    pub display: String,
    folder: tempfile::TempDir,
    mouse: Mouse,
}

impl Screen {
    /// Of so many pixels.
    pub fn new([width, height]: [u32; 2]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0"])
            .arg(format!("{width}x{height}x24"))
            .arg("-fbdir")
            .arg(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = Running(started.unwrap_or_else(|error| {
            panic!(
                "Xvfb does not start ({error}); install it with: sudo apt-get install xvfb\n\
                 or set {SKIP}=1 to go without the window's tests"
            )
        }));
        let mut number = String::new();
        let output = server.0.stdout.take().expect("its output");
        BufReader::new(output)
            .read_line(&mut number)
            .expect("the display's number");
        let mouse = Mouse::at(number.trim()).expect("a connection to the server");
        Self {
            _server: server,
            display: format!(":{}", number.trim()),
            folder,
            mouse,
        }
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("Xvfb_screen0")
    }

    /// What is on it: width, height and pixels, rows from the top.
    pub fn see(&self) -> (u32, u32, Vec<[u8; 3]>) {
        // The server's own memory, as an X window dump: big-endian words, then pixels of BGRX.
        let dump = fs::read(self.file()).expect("the screen's pixels");
        let word = |k: usize| {
            let bytes = dump[4 * k..4 * k + 4].try_into().expect("four bytes");
            u32::from_be_bytes(bytes) as usize
        };
        let (header, width, height) = (word(0), word(4), word(5));
        let (row_bytes, colours) = (word(12), word(19));
        let start = header + 12 * colours;
        let rows = dump[start..].chunks_exact(row_bytes).take(height);
        let pixels = rows.flat_map(|row| {
            let pixels = row.chunks_exact(4).take(width);
            pixels.map(|pixel| [pixel[2], pixel[1], pixel[0]])
        });
        (width as u32, height as u32, pixels.collect())
    }

    /// Mean of all channels of what is on it, 0 to 255.
    pub fn light(&self) -> f64 {
        let (_, _, pixels) = self.see();
        let sum: f64 = pixels.iter().flatten().map(|v| f64::from(*v)).sum();
        sum / (3 * pixels.len()).max(1) as f64
    }

    /// Mean difference of all channels from what was `seen` before, 0 to 255.
    pub fn differs(&self, seen: &[[u8; 3]]) -> f64 {
        let (_, _, pixels) = self.see();
        let both = pixels.iter().flatten().zip(seen.iter().flatten());
        let sum: f64 = both.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
        sum / (3 * pixels.len()).max(1) as f64
    }

    /// Moves the pointer there.
    pub fn point(&mut self, [x, y]: [i16; 2]) {
        self.mouse.fake(MOTION, 0, [x, y]);
    }

    /// Presses the left button there, moves, and lets go.
    pub fn drag(&mut self, from: [i16; 2], to: [i16; 2]) {
        const STEPS: i16 = 8;
        const STEP: Duration = Duration::from_millis(30);
        self.point(from);
        thread::sleep(STEP);
        self.mouse.fake(PRESS, 1, from);
        for step in 1..=STEPS {
            thread::sleep(STEP);
            self.point([0, 1].map(|k| from[k] + (to[k] - from[k]) * step / STEPS));
        }
        thread::sleep(STEP);
        self.mouse.fake(RELEASE, 1, to);
    }

    pub fn click(&mut self, at: [i16; 2]) {
        self.drag(at, at);
    }
}

/// The pointer, by way of the XTEST extension.
struct Mouse {
    stream: UnixStream,
    root: u32,
    xtest: u8,
}

impl Mouse {
    fn at(display: &str) -> std::io::Result<Self> {
        let mut stream = UnixStream::connect(format!("/tmp/.X11-unix/X{display}"))?;
        // Little-endian, version 11.0, and no name or secret.
        stream.write_all(&[b'l', 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0])?;
        let mut head = [0; 8];
        stream.read_exact(&mut head)?;
        assert_eq!(head[0], 1, "the server refuses");
        let mut body = vec![0; 4 * usize::from(u16::from_le_bytes([head[6], head[7]]))];
        stream.read_exact(&mut body)?;
        let vendor = usize::from(u16::from_le_bytes([body[16], body[17]])).next_multiple_of(4);
        let screen = 32 + vendor + 8 * usize::from(body[21]);
        let root = body[screen..screen + 4].try_into().expect("four bytes");
        let name = b"XTEST";
        let mut ask = vec![98, 0, 4, 0, name.len() as u8, 0, 0, 0];
        ask.extend(name);
        ask.resize(16, 0);
        stream.write_all(&ask)?;
        let mut reply = [0; 32];
        stream.read_exact(&mut reply)?;
        assert_eq!(reply[8], 1, "the server has no XTEST");
        Ok(Self {
            stream,
            root: u32::from_le_bytes(root),
            xtest: reply[9],
        })
    }

    fn fake(&mut self, kind: u8, button: u8, [x, y]: [i16; 2]) {
        let mut event = vec![self.xtest, 2, 9, 0, kind, button, 0, 0];
        event.extend(0u32.to_le_bytes());
        event.extend(self.root.to_le_bytes());
        event.extend([0; 8]);
        event.extend(x.to_le_bytes());
        event.extend(y.to_le_bytes());
        event.resize(36, 0);
        self.stream.write_all(&event).expect("the server listens");
    }
}
