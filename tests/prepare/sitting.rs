//! Sittings: exhibits photographed by the reference, and the files that a photographer would bring
//! home from them.

use std::{
    f64::consts::PI,
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use glam::{DVec2, DVec3};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, Normal};
use recto::{
    colour::srgb_encode,
    manifest::{Camera, Exhibit, overrides::Overrides},
    maps::{ColourEncoding, encode, for_each_colour_row},
    prepare::{self, Report, capture::Capture, lights},
    reference::picture::{Crop, Exposure, Mode, Studio},
    units::Degrees,
};

/// Paths that undo an exhibit's photograph at each roughness: its albedo within .5 %.
const CAPTURE_PATHS: u64 = 1 << 15;
/// What the grey card reflects.
const CARD: f64 = 0.5;
/// What a photograph shows of a perfect diffuser that lies flat in the middle.
const EXPOSED: f64 = 0.8;

/// A lamp far away: azimuth and elevation in degrees.
pub type Lamp = [f64; 2];

/// Lamps in rings, each turned against the one before.
pub fn rings(rings: &[(usize, f64)]) -> Vec<Lamp> {
    let ring = |(turn, (count, elevation)): (usize, &(usize, f64))| {
        let step = 360.0 / *count as f64;
        let (count, elevation) = (*count, *elevation);
        (0..count).map(move |i| [(i as f64 + 0.31 * turn as f64) * step + 12.0, elevation])
    };
    rings.iter().enumerate().flat_map(ring).collect()
}

/// A picture in linear light; 1 is a perfect diffuser that lies flat.
pub type Frame = Vec<[f64; 3]>;

/// What the reference sees of the whole recto of the exhibit in `folder` from straight above, under
/// one lamp.
pub fn seen(folder: &Path, lamp: Lamp, size: [usize; 2], samples: u64, seed: u64) -> Frame {
    let [azimuth, elevation] = lamp;
    let azimuth = azimuth.rem_euclid(360.0);
    let overrides = Overrides {
        lamps: vec![format!(
            "kind=distant,lux_at_sheet=150,kelvin=6504,elevation_deg={elevation},azimuth_deg={azimuth}"
        )],
        ..Overrides::default()
    };
    let (exhibit, _) = Exhibit::read(folder).unwrap_or_else(|faults| panic!("{faults}"));
    let applied = overrides.apply(exhibit, size[0] as u32);
    let (exhibit, mut scene) = applied.unwrap_or_else(|faults| panic!("{faults}"));
    let sheet = exhibit.drawing_of(&scene).size_mm;
    scene.camera = Camera {
        centre_mm: sheet / 2.0,
        width_mm: sheet.x,
        tilt: Degrees(0.0),
        turn: Degrees(0.0),
        distance_mm: None,
    };
    let lit = exhibit.lighting(&scene).lights[0].illuminance(DVec3::ZERO, DVec3::Z);
    assert!((lit - PI).abs().max_element() < 1e-9, "{lit}");
    let studio = Studio::new(&exhibit, &scene, CAPTURE_PATHS, 1);
    let studio = studio.unwrap_or_else(|error| panic!("{error}"));
    let [width, height] = size.map(|px| px as u32);
    let exposure = Exposure {
        size: [width, height],
        crop: Crop {
            x: 0,
            y: 0,
            width,
            height,
        },
        samples,
        seed,
        mode: Mode::Local,
    };
    studio.take(&exposure, || ()).mean
}

/// A sheet under lamps, before it is photographed.
pub struct Sitting {
    pub lamps: Vec<Lamp>,
    pub size: [usize; 2],
    pub mm_per_px: f64,
    /// One for each lamp.
    pub frames: Vec<Frame>,
}

/// How a sitting is photographed.
#[derive(Clone, Copy)]
pub struct Photographer {
    pub bits: u32,
    /// Standard deviation of the noise, where 1 is the sensor's full range.
    pub noise: f64,
    /// Whether light falls off over the picture; a grey card then says how.
    pub vignetted: bool,
    /// Whether lamps are to be found in a glossy ball; they are told otherwise.
    pub ball: bool,
    pub encoding: ColourEncoding,
}

impl Default for Photographer {
    fn default() -> Self {
        Self {
            bits: 16,
            noise: 5e-4,
            vignetted: true,
            ball: true,
            encoding: ColourEncoding::Linear,
        }
    }
}

/// A lamp's light over a picture, about 1 in its middle.
fn fall_off(lamp: usize, at: DVec2) -> f64 {
    let towards = DVec2::from_angle(lamp as f64 * 2.4);
    1.0 / (1.0 + 0.25 * (at - 0.5).dot(towards) + 0.3 * (at - 0.5).length_squared())
}

impl Photographer {
    /// Writes the files of a capture into `folder`, which has to be there, and reads the capture.
    pub fn capture(self, sitting: &Sitting, folder: &Path) -> Capture {
        let path = folder.join("capture.toml");
        let text = self.text(sitting);
        fs::write(&path, &text).expect("a capture file");
        for (i, frame) in sitting.frames.iter().enumerate() {
            let light = |at: DVec2| if self.vignetted { fall_off(i, at) } else { 1.0 };
            self.save(
                folder,
                &format!("recto-{i}.png"),
                sitting.size,
                |x, y, at| DVec3::from(frame[y * sitting.size[0] + x]) * light(at),
            );
            self.save(
                folder,
                &format!("grey-{i}.png"),
                sitting.size,
                |_, _, at| DVec3::splat(CARD * light(at)),
            );
            if self.ball {
                let [azimuth, elevation] = sitting.lamps[i];
                let lamp = lights::direction(azimuth, elevation);
                self.save(folder, &format!("ball-{i}.png"), [840; 2], |x, y, _| {
                    ball(lamp, DVec2::new(x as f64, y as f64) + 0.5)
                });
            }
        }
        let (capture, warnings) = Capture::read(&path).unwrap_or_else(|faults| panic!("{faults}"));
        assert!(warnings.is_empty(), "{warnings:?}");
        capture
    }

    /// Photographs a sitting in a folder of its own, and prepares it into `out` there.
    pub fn prepared(self, sitting: &Sitting, folder: &Path) -> (Report, PathBuf) {
        let out = folder.join("out");
        let capture = self.capture(sitting, folder);
        let report = prepare::run(&capture, &out, &mut |_| ());
        (report.unwrap_or_else(|error| panic!("{error}")), out)
    }

    fn save(
        self,
        folder: &Path,
        name: &str,
        size: [usize; 2],
        at: impl Fn(usize, usize, DVec2) -> DVec3,
    ) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed_of(name));
        let noise = Normal::new(0.0, self.noise).expect("a spread");
        let full = self.full();
        let whole = DVec2::new(size[0] as f64, size[1] as f64);
        let code = |linear: f64| {
            let value = match self.encoding {
                ColourEncoding::Linear => linear,
                _ => srgb_encode(linear),
            };
            // Casts saturate. A file of 16 bits holds what a camera of fewer made of it.
            ((value.clamp(0.0, 1.0) * full).round() / full * 65535.0).round() as u16
        };
        let pixels: Vec<[u16; 3]> = (0..size[0] * size[1])
            .map(|i| {
                let (x, y) = (i % size[0], i / size[0]);
                let place = (DVec2::new(x as f64, y as f64) + 0.5) / whole;
                let shown = at(x, y, place) * EXPOSED;
                let noisy = shown.to_array().map(|v| v + noise.sample(&mut random));
                noisy.map(code)
            })
            .collect();
        let (w, h) = (size[0] as u32, size[1] as u32);
        encode::save_png_rgb16(&folder.join(name), w, h, &pixels, None).expect("a photograph");
    }

    /// The highest code.
    fn full(self) -> f64 {
        f64::from((1u32 << self.bits) - 1)
    }

    /// What is read of a frame without its fall-off in linear light, as planes.
    pub fn planes(self, frame: &Frame, seed: u64) -> [Vec<f32>; 3] {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let noise = Normal::new(0.0, self.noise).expect("a spread");
        let full = self.full();
        let mut planes = [0, 1, 2].map(|_| Vec::with_capacity(frame.len()));
        for pixel in frame {
            for (plane, value) in planes.iter_mut().zip(pixel) {
                let shown = value * EXPOSED + noise.sample(&mut random);
                let read = (shown.clamp(0.0, 1.0) * full).round() / full;
                plane.push((read / EXPOSED) as f32);
            }
        }
        planes
    }

    fn text(self, sitting: &Sitting) -> String {
        let count = sitting.frames.len();
        let names = |name: &str| {
            let each = (0..count).map(|i| format!("\"{name}-{i}.png\""));
            each.collect::<Vec<_>>().join(", ")
        };
        let encoding = match self.encoding {
            ColourEncoding::Linear => "linear",
            _ => "srgb",
        };
        let mut text = format!(
            "id = \"sheet\"\nencoding = \"{encoding}\"\nscale.mm_per_px = {:?}\n[lamps]\n",
            sitting.mm_per_px
        );
        let list = |which: usize| {
            let each = sitting
                .lamps
                .iter()
                .map(|lamp| format!("{:?}", lamp[which]));
            each.collect::<Vec<_>>().join(", ")
        };
        // Writing to a string does not fail.
        let _ = match self.ball {
            true => writeln!(
                text,
                "sphere = {{ photographs = [{}], circle_px = [420, 420, 400] }}",
                names("ball")
            ),
            false => writeln!(
                text,
                "azimuth_deg = [{}]\nelevation_deg = [{}]",
                list(0),
                list(1)
            ),
        };
        let _ = write!(
            text,
            "flat_field = [{}]\ngrey_card = {CARD}\n[recto]\nphotographs = [{}]\n",
            names("grey"),
            names("recto"),
        );
        text
    }
}

/// Another one for each file.
fn seed_of(name: &str) -> u64 {
    name.bytes().fold(11, |seed: u64, byte| {
        (seed * 31 + u64::from(byte)) & 0xffff_ffff
    })
}

/// A glossy ball of radius 400 around (420, 420), on grey cloth, that mirrors a lamp of 60 mm at
/// 1.5 m.
fn ball(lamp: DVec3, at: DVec2) -> DVec3 {
    let d = (at - 420.0) / 400.0;
    let square = d.length_squared();
    if square >= 1.0 {
        return DVec3::splat(0.3);
    }
    let n = DVec3::new(d.x, -d.y, (1.0 - square).sqrt());
    let mirrored = 2.0 * n.z * n - DVec3::Z;
    let is_lamp = mirrored.angle_between(lamp) < 0.02;
    DVec3::splat(if is_lamp { 4.0 } else { 0.05 })
}

/// A map's pixels, in 0…1.
pub fn pixels(path: &Path, encoding: ColourEncoding) -> Vec<[f32; 4]> {
    let mut pixels = Vec::new();
    for_each_colour_row(path, encoding, |_, row| pixels.extend_from_slice(row))
        .unwrap_or_else(|error| panic!("{error}"));
    pixels
}

/// Heights in µm of a prepared recto: the sheet's shape and its grain together. For sheets so small
/// that both maps have their pixels in common.
pub fn heights(out: &Path, report: &Report) -> Vec<f64> {
    let text = fs::read_to_string(&report.manifest).expect("a manifest");
    let manifest: toml::Table = text.parse().expect("TOML");
    let drawing = &manifest["drawing"][0];
    let heights = |map: &toml::Value| {
        let number = |i: usize| {
            let value = &map["range_um"][i];
            let integer = value.as_integer().map(|v| v as f64);
            value.as_float().or(integer).expect("a number")
        };
        let (low, high) = (number(0), number(1));
        let file = out.join(map["file"].as_str().expect("a file"));
        let um = pixels(&file, ColourEncoding::Linear).into_iter();
        um.map(|p| low + (high - low) * f64::from(p[0]))
            .collect::<Vec<f64>>()
    };
    let shape = heights(&drawing["surface"]["height"]);
    let grain = heights(&drawing["recto"]["height"]);
    assert_eq!(shape.len(), grain.len());
    shape.iter().zip(&grain).map(|(a, b)| a + b).collect()
}

/// The value that a fixture's highest code stands for.
const FIXTURE_FULL: f64 = 2.0;

pub fn fixture_path(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures")).join(name)
}

/// Frames of one size, one below another in one picture.
pub fn write_fixture(name: &str, [width, height]: [usize; 2], frames: &[Frame]) {
    let code = |value: f64| ((value / FIXTURE_FULL).clamp(0.0, 1.0) * 65535.0).round() as u16;
    let pixels: Vec<[u16; 3]> = frames.iter().flatten().map(|p| p.map(code)).collect();
    let (w, h) = (width as u32, (height * frames.len()) as u32);
    encode::save_png_rgb16(&fixture_path(name), w, h, &pixels, None).expect("a fixture");
}

/// What [`write_fixture`] wrote.
pub fn fixture(name: &str, [width, height]: [usize; 2], count: usize) -> Vec<Frame> {
    let all = pixels(&fixture_path(name), ColourEncoding::Linear);
    assert_eq!(
        all.len(),
        width * height * count,
        "{name} must be baked anew"
    );
    let value = |v: f32| f64::from(v) * FIXTURE_FULL;
    let frame = |part: &[[f32; 4]]| {
        part.iter()
            .map(|p| [0, 1, 2].map(|c| value(p[c])))
            .collect()
    };
    all.chunks(width * height).map(frame).collect()
}
