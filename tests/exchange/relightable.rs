//! Relightable images of known polynomials, and of a matte surface with known normals.

use std::f64::consts::PI;

use glam::DVec3;
use image::{ImageFormat, Rgb, RgbImage};
use recto::{
    colour::{srgb_decode, srgb_encode},
    exchange::Known,
    manifest::Exhibit,
};
use serde_json::json;

use super::Desk;

/// A surface: width, height, and for each pixel from the top left normal and linear albedo.
struct Surface {
    size: [usize; 2],
    pixels: Vec<(DVec3, [f64; 3])>,
}

impl Surface {
    /// Different everywhere, and differently to the right and down; up to 30° steep.
    fn new(width: usize, height: usize) -> Self {
        let pixel = |i: usize| {
            let x = (i % width) as f64 / (width - 1) as f64;
            let y = (i / width) as f64 / (height - 1) as f64;
            let normal = DVec3::new(0.5 * (x - 0.3), 0.6 * (0.4 - y), 1.0).normalize();
            (normal, [0.3 + 0.5 * x, 0.6, 0.25 + 0.3 * y])
        };
        Self {
            size: [width, height],
            pixels: (0..width * height).map(pixel).collect(),
        }
    }

    /// What a camera with sRGB values sees of a pixel.
    fn seen(&self, pixel: usize, l: DVec3) -> [f64; 3] {
        let (n, albedo) = self.pixels[pixel];
        albedo.map(|a| srgb_encode(a * n.dot(l).max(0.0)))
    }

    /// Mean and greatest angle in degrees, and the greatest error of encoded albedo, of an exhibit.
    fn errors(&self, exhibit: &Exhibit) -> [f64; 3] {
        let (normals, albedo) = maps(exhibit);
        let mut angles = Vec::new();
        let mut colour = 0.0_f64;
        for (i, (n, own)) in self.pixels.iter().enumerate() {
            angles.push(normals[i].angle_between(*n).to_degrees());
            for (found, own) in albedo[i].iter().zip(own) {
                colour = colour.max((found - srgb_encode(*own)).abs());
            }
        }
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        [mean, angles.iter().copied().fold(0.0, f64::max), colour]
    }
}

/// Normals and encoded albedo of an exhibit, by another reader than Recto's.
fn maps(exhibit: &Exhibit) -> (Vec<DVec3>, Vec<[f64; 3]>) {
    let recto = &exhibit.drawings[0].recto;
    let open = |path: &std::path::Path| image::open(path).expect("a picture").to_rgb16();
    let normal = open(&recto.normal.as_ref().expect("normals").file.path);
    let component = |v: u16| (f64::from(v) - 32768.0) / 32767.0;
    let normals = normal.pixels().map(|p| DVec3::from(p.0.map(component)));
    let albedo = open(&recto.albedo.file.path);
    let colours = albedo.pixels().map(|p| p.0.map(|v| f64::from(v) / 65535.0));
    (normals.collect(), colours.collect())
}

/// Coefficients of −100 (lu − x)² − 100 (lv − y)² + c, in the order of a .ptm.
fn paraboloid(x: f64, y: f64, c: f64) -> [f64; 6] {
    let c = c - 100.0 * (x * x + y * y);
    [-100.0, -100.0, 0.0, 200.0 * x, 200.0 * y, c]
}

/// Six pixels, two wide; every coefficient is a byte's exactly.
const TOPS: [[f64; 2]; 6] = [
    [0.0, 0.0],
    [0.25, 0.0],
    [0.0, 0.5],
    [-0.25, 0.25],
    [0.5, -0.25],
    [-0.5, -0.5],
];

/// Scales and biases of these coefficients.
const PTM_NUMBERS: &str = "1 1 1 1 1 0.625\n128 128 128 128 128 0\n";

fn bytes_of(coefficients: [f64; 6]) -> [u8; 6] {
    let byte = |(k, c): (usize, f64)| match k {
        5 => (c / 0.625) as u8,
        _ => (c + 128.0) as u8,
    };
    let mut bytes = [0; 6];
    for (k, c) in coefficients.into_iter().enumerate() {
        bytes[k] = byte((k, c));
    }
    bytes
}

/// Top left first, as rows of two from the bottom.
fn from_bottom<T: Copy>(pixels: &[T]) -> Vec<T> {
    pixels.chunks(2).rev().flatten().copied().collect()
}

fn top(i: usize) -> DVec3 {
    let [x, y] = TOPS[i];
    DVec3::new(x, y, (1.0 - x * x - y * y).sqrt())
}

fn check_tops(exhibit: &Exhibit, albedo: impl Fn(usize) -> [f64; 3]) {
    let (normals, colours) = maps(exhibit);
    assert_eq!(exhibit.drawings[0].recto.albedo.file.size, [2, 3]);
    for i in 0..6 {
        let angle = normals[i].angle_between(top(i)).to_degrees();
        assert!(angle < 0.01, "pixel {i}: {angle}°");
        for (found, given) in colours[i].iter().zip(albedo(i)) {
            assert!((found - given).abs() < 1e-4, "pixel {i}: {:?}", colours[i]);
        }
    }
}

#[test]
fn a_ptm_with_luminance_and_colour_has_the_normals_of_its_tops() {
    let terms: Vec<[u8; 6]> = TOPS
        .map(|[x, y]| bytes_of(paraboloid(x, y, 120.0)))
        .to_vec();
    let colours: Vec<[u8; 3]> = (0..6).map(|i| [200, 100 + 20 * i, 51]).collect();
    let expected =
        |i: usize| [200, 100 + 20 * i as u8, 51].map(|v| 120.0 / 255.0 * f64::from(v) / 255.0);

    let desk = Desk::new();
    let mut file = format!("PTM_1.2\nPTM_FORMAT_LRGB\n2\n3\n{PTM_NUMBERS}").into_bytes();
    file.extend(from_bottom(&terms).as_flattened());
    file.extend(from_bottom(&colours).as_flattened());
    // Fitters end files so.
    file.push(b'\n');
    desk.write("study.ptm", &file);
    let (exhibit, warnings) = desk.exhibit("study.ptm", &Known::default());
    check_tops(&exhibit, expected);
    assert_eq!(exhibit.title.0["en"], "study");
    assert!(warnings.contains("--size-mm"), "{warnings}");
    assert_eq!(exhibit.drawings[0].size_mm, glam::DVec2::new(1.0, 1.0));

    // Before version 1.2 colours follow each pixel, and numbers may share lines.
    let desk = Desk::new();
    let mut file =
        b"PTM_1.1\r\nPTM_FORMAT_LRGB\r\n2 3\r\n1 1 1 1 1 0.625 128 128 128 128 128 0\r\n".to_vec();
    let pixels: Vec<[u8; 9]> = terms
        .iter()
        .zip(&colours)
        .map(|(t, c)| [t[0], t[1], t[2], t[3], t[4], t[5], c[0], c[1], c[2]])
        .collect();
    file.extend(from_bottom(&pixels).as_flattened());
    desk.write("old.ptm", &file);
    let known = Known {
        size_mm: Some([20.0, 30.0]),
        ..Known::default()
    };
    let (exhibit, warnings) = desk.exhibit("old.ptm", &known);
    check_tops(&exhibit, expected);
    assert_eq!(exhibit.drawings[0].size_mm, glam::DVec2::new(20.0, 30.0));
    assert!(warnings.is_empty(), "{warnings}");
}

#[test]
fn a_ptm_of_three_channels_has_the_top_of_their_luminance() {
    let desk = Desk::new();
    let mut file = format!("PTM_1.2\nPTM_FORMAT_RGB\n2\n3\n{PTM_NUMBERS}").into_bytes();
    for c in [120.0, 110.0, 100.0] {
        let terms: Vec<[u8; 6]> = TOPS.map(|[x, y]| bytes_of(paraboloid(x, y, c))).to_vec();
        file.extend(from_bottom(&terms).as_flattened());
    }
    desk.write("rgb.ptm", &file);
    let (exhibit, _) = desk.exhibit("rgb.ptm", &Known::default());
    check_tops(&exhibit, |_| [120.0, 110.0, 100.0].map(|c| c / 255.0));
}

#[test]
fn a_ptm_that_is_turned_over_is_told_from_one_that_is_not() {
    // The comparison above must see rows in the wrong order.
    let desk = Desk::new();
    let mut file = format!("PTM_1.2\nPTM_FORMAT_LRGB\n2\n3\n{PTM_NUMBERS}").into_bytes();
    file.extend(
        TOPS.map(|[x, y]| bytes_of(paraboloid(x, y, 120.0)))
            .as_flattened(),
    );
    file.extend([200; 18]);
    desk.write("upside.ptm", &file);
    let (exhibit, _) = desk.exhibit("upside.ptm", &Known::default());
    let (normals, _) = maps(&exhibit);
    let angle = normals[0].angle_between(top(0)).to_degrees();
    assert!(angle > 10.0, "{angle}°");
}

#[test]
fn pixels_without_a_brightest_direction_are_said_and_are_still_normals() {
    let desk = Desk::new();
    let mut file = format!("PTM_1.2\nPTM_FORMAT_LRGB\n2\n3\n{PTM_NUMBERS}").into_bytes();
    // Bowls: darkest in their middle.
    let bowl = bytes_of([100.0, 100.0, 0.0, 20.0, 0.0, 40.0]);
    file.extend([bowl; 6].as_flattened());
    file.extend([200; 18]);
    desk.write("bowl.ptm", &file);
    let (exhibit, warnings) = desk.exhibit("bowl.ptm", &Known::default());
    assert!(
        warnings.contains("no brightest direction in 100 %"),
        "{warnings}"
    );
    for normal in maps(&exhibit).0 {
        assert!((normal.length() - 1.0).abs() < 1e-3 && normal.z > 0.5);
    }
}

/// Lamps of a dome: five rings.
fn dome() -> Vec<DVec3> {
    let ring = |k: usize| {
        let elevation = (15.0 + 15.0 * k as f64).to_radians();
        (0..12).map(move |i| {
            let azimuth = 2.0 * PI * (i as f64 + 0.5 * (k % 2) as f64) / 12.0;
            DVec3::new(
                elevation.cos() * azimuth.cos(),
                elevation.cos() * azimuth.sin(),
                elevation.sin(),
            )
        })
    };
    (0..5).flat_map(ring).chain([DVec3::Z]).collect()
}

/// Hemispherical harmonics as RTIBuilder has them, of θ and φ.
fn hsh(l: DVec3) -> Vec<f64> {
    let (theta, phi) = (l.z.clamp(-1.0, 1.0).acos(), l.y.atan2(l.x));
    let c = theta.cos();
    let root = (c - c * c).max(0.0).sqrt();
    vec![
        1.0 / (2.0 * PI).sqrt(),
        (6.0 / PI).sqrt() * phi.cos() * root,
        (3.0 / (2.0 * PI)).sqrt() * (-1.0 + 2.0 * c),
        (6.0 / PI).sqrt() * root * phi.sin(),
        (30.0 / PI).sqrt() * (2.0 * phi).cos() * (-c + c * c),
        (30.0 / PI).sqrt() * phi.cos() * (-1.0 + 2.0 * c) * root,
        (5.0 / (2.0 * PI)).sqrt() * (1.0 - 6.0 * c + 6.0 * c * c),
        (30.0 / PI).sqrt() * (-1.0 + 2.0 * c) * root * phi.sin(),
        (30.0 / PI).sqrt() * (-c + c * c) * (2.0 * phi).sin(),
    ]
}

/// 1, x, y, x², xy, y²: Relight's polynomial.
fn polynomial(l: DVec3) -> Vec<f64> {
    vec![1.0, l.x, l.y, l.x * l.x, l.x * l.y, l.y * l.y]
}

/// Least squares by Gauss's elimination: the coefficients of `basis` that are nearest to `values`.
fn fit(lamps: &[DVec3], basis: fn(DVec3) -> Vec<f64>, values: &[f64]) -> Vec<f64> {
    let rows: Vec<Vec<f64>> = lamps.iter().map(|l| basis(*l)).collect();
    let n = rows[0].len();
    let mut a = vec![vec![0.0; n + 1]; n];
    for (row, value) in rows.iter().zip(values) {
        for i in 0..n {
            for j in 0..n {
                a[i][j] += row[i] * row[j];
            }
            a[i][n] += row[i] * value;
        }
    }
    for i in 0..n {
        for k in i + 1..n {
            let factor = a[k][i] / a[i][i];
            let above = a[i].clone();
            for (value, above) in a[k].iter_mut().zip(above) {
                *value -= factor * above;
            }
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| a[i][k] * a[k][n]).sum();
        a[i][n] = (a[i][n] - known) / a[i][i];
    }
    a.iter().map(|row| row[n]).collect()
}

/// Coefficients `[pixel][term][channel]`.
fn fitted(surface: &Surface, basis: fn(DVec3) -> Vec<f64>) -> Vec<Vec<[f64; 3]>> {
    let lamps = dome();
    let pixel = |i: usize| {
        let seen: Vec<[f64; 3]> = lamps.iter().map(|l| surface.seen(i, *l)).collect();
        let channels = [0, 1, 2].map(|c| {
            let values: Vec<f64> = seen.iter().map(|v| v[c]).collect();
            fit(&lamps, basis, &values)
        });
        (0..channels[0].len())
            .map(|k| [channels[0][k], channels[1][k], channels[2][k]])
            .collect()
    };
    (0..surface.pixels.len()).map(pixel).collect()
}

/// The range of each term over all pixels and channels.
fn ranges(coefficients: &[Vec<[f64; 3]>]) -> Vec<[f64; 2]> {
    let terms = coefficients[0].len();
    let range = |k: usize| {
        let values = coefficients.iter().flat_map(|pixel| pixel[k]);
        let [low, high] = values.fold([f64::MAX, f64::MIN], |[low, high], v| {
            [low.min(v), high.max(v)]
        });
        [low, high.max(low + 1e-3)]
    };
    (0..terms).map(range).collect()
}

#[test]
fn hemispherical_harmonics_of_a_matte_surface_give_it_back() {
    let surface = Surface::new(9, 7);
    let coefficients = fitted(&surface, hsh);
    let ranges = ranges(&coefficients);
    let mut file = b"#HSH1.2\r\n# made here\r\n3\r\n9 7 3\r\n9 2 1\r\n".to_vec();
    file.extend(
        ranges
            .iter()
            .flat_map(|[low, high]| ((high - low) as f32).to_le_bytes()),
    );
    file.extend(
        ranges
            .iter()
            .flat_map(|[low, _]| (*low as f32).to_le_bytes()),
    );
    for pixel in &coefficients {
        for c in 0..3 {
            for (term, [low, high]) in pixel.iter().zip(&ranges) {
                file.push(((term[c] - low) / (high - low) * 255.0).round() as u8);
            }
        }
    }
    let desk = Desk::new();
    desk.write("matte.rti", &file);
    let (exhibit, _) = desk.exhibit("matte.rti", &Known::default());
    let [mean, most, colour] = surface.errors(&exhibit);
    eprintln!("HSH: mean {mean:.2}°, most {most:.2}°, albedo {colour:.3}");
    assert!(mean < 1.0 && most < 2.0, "mean {mean}°, most {most}°");
    assert!(colour < 0.02, "{colour}");
}

/// Writes an `info.json` and its planes as PNG: `planes[pixel][plane]` are bytes.
fn relight(desk: &Desk, surface: &Surface, mut info: serde_json::Value, planes: &[Vec<u8>]) {
    let [width, height] = surface.size;
    info["width"] = json!(width);
    info["height"] = json!(height);
    info["format"] = json!("png");
    let count = planes[0].len();
    for i in 0..count.div_ceil(3) {
        let picture = RgbImage::from_fn(width as u32, height as u32, |x, y| {
            let pixel = &planes[y as usize * width + x as usize];
            let channel = |c: usize| pixel.get(3 * i + c).copied().unwrap_or(0);
            Rgb([channel(0), channel(1), channel(2)])
        });
        let path = desk.folder().join(format!("plane_{i}.png"));
        picture
            .save_with_format(path, ImageFormat::Png)
            .expect("written");
    }
    desk.write("info.json", info.to_string());
}

/// Coefficients as planes of Relight: scale and bias, and bytes.
fn quantised(coefficients: &[Vec<[f64; 3]>]) -> (Vec<f64>, Vec<f64>, Vec<Vec<u8>>) {
    let ranges = ranges(coefficients);
    let each = |value: fn(&[f64; 2]) -> f64| -> Vec<f64> {
        ranges.iter().flat_map(|range| [value(range); 3]).collect()
    };
    let scale = each(|[low, high]| high - low);
    let bias = each(|[low, high]| -low / (high - low));
    let bytes = coefficients.iter().map(|pixel| {
        let of = pixel.iter().zip(&ranges);
        of.flat_map(|(term, [low, high])| {
            term.map(|v| ((v - low) / (high - low) * 255.0).round() as u8)
        })
        .collect()
    });
    (scale, bias, bytes.collect())
}

#[test]
fn planes_of_relight_give_a_matte_surface_back() {
    let surface = Surface::new(9, 7);
    // A parabola is a poor arch: its top is off by degrees, as in every PTM.
    for (kind, basis, most_mean, most_colour) in [
        ("hsh", hsh as fn(DVec3) -> Vec<f64>, 1.0, 0.02),
        ("ptm", polynomial, 5.0, 0.1),
    ] {
        let (scale, bias, planes) = quantised(&fitted(&surface, basis));
        let info = json!({
            "type": kind, "colorspace": "rgb", "nplanes": scale.len(),
            "materials": [{ "scale": scale, "bias": bias }],
        });
        let desk = Desk::new();
        relight(&desk, &surface, info, &planes);
        let (exhibit, _) = desk.exhibit("info.json", &Known::default());
        let [mean, most, colour] = surface.errors(&exhibit);
        eprintln!("Relight {kind}: mean {mean:.2}°, most {most:.2}°, albedo {colour:.3}");
        assert!(mean < most_mean, "{kind}: {mean}°");
        assert!(colour < most_colour, "{kind}: {colour}");
    }
}

#[test]
fn luminance_planes_of_relight_are_those_of_a_ptm() {
    let surface = Surface::new(2, 3);
    // r, g, b, 1, x, y, x², xy, y²: where a .ptm has x², y², xy, x, y, 1.
    let planes: Vec<Vec<u8>> = TOPS
        .iter()
        .map(|[x, y]| {
            let [xx, yy, xy, lx, ly, one] = bytes_of(paraboloid(*x, *y, 120.0));
            vec![200, 100, 51, one, lx, ly, xx, xy, yy]
        })
        .collect();
    let b = 128.0 / 255.0;
    let info = json!({
        "type": "ptm", "colorspace": "lrgb", "nplanes": 9,
        "materials": [{
            "scale": [7, 7, 7, 0.625, 1, 1, 1, 1, 1],
            "bias": [0, 0, 0, 0, b, b, b, b, b],
        }],
    });
    let desk = Desk::new();
    relight(&desk, &surface, info, &planes);
    let (exhibit, _) = desk.exhibit("info.json", &Known::default());
    check_tops(&exhibit, |_| {
        [200.0, 100.0, 51.0].map(|v| 120.0 / 255.0 * v / 255.0)
    });
}

/// The whole functions of three pixels at places, as a basis of three planes: each pixel is one of
/// them.
fn table(surface: &Surface, places: &[DVec3], planes: usize, own: [usize; 3]) -> Vec<u8> {
    let mut bytes = vec![0; (planes + 1) * places.len() * 3];
    for (pixel, plane) in own.iter().enumerate() {
        for (i, l) in places.iter().enumerate() {
            for (c, v) in surface.seen(pixel, *l).iter().enumerate() {
                bytes[((plane + 1) * places.len() + i) * 3 + c] = (127.0 + v * 128.0).round() as u8;
            }
        }
    }
    // Elsewhere 127 is nothing, but for the mean.
    for plane in (1..=planes).filter(|plane| !own.contains(&(plane - 1))) {
        bytes[plane * places.len() * 3..(plane + 1) * places.len() * 3].fill(127);
    }
    bytes
}

fn one_hot(planes: usize, own: [usize; 3]) -> Vec<Vec<u8>> {
    let pixel = |i: usize| {
        (0..planes)
            .map(|plane| if own[i] == plane { 255 } else { 0 })
            .collect()
    };
    (0..3).map(pixel).collect()
}

#[test]
fn tables_of_relight_give_a_matte_surface_back() {
    let mut surface = Surface::new(3, 2);
    surface.size = [3, 1];
    surface.pixels.truncate(3);
    let lamps = dome();
    let flat: Vec<f64> = lamps.iter().flat_map(|l| l.to_array()).collect();
    let material = json!([{ "scale": [1, 1, 1], "bias": [0, 0, 0], "range": [128, 128, 128] }]);
    let rbf = json!({ "type": "rbf", "colorspace": "mrgb", "nplanes": 3, "lights": flat,
        "sigma": 0.125, "materials": material });
    let bilinear = |side: usize| {
        json!({ "type": "bilinear", "colorspace": "mrgb", "nplanes": 3,
            "resolution": side, "materials": material })
    };
    let mut worst = Vec::new();
    for (mut info, places, inside) in [
        (rbf, lamps, true),
        (bilinear(9), octahedron(9), false),
        (bilinear(33), octahedron(33), false),
    ] {
        let desk = Desk::new();
        let table = table(&surface, &places, 3, [0, 1, 2]);
        if inside {
            info["basis"] = json!(table);
        } else {
            desk.write("materials.bin", table);
        }
        let kind = info["type"].clone();
        relight(&desk, &surface, info, &one_hot(3, [0, 1, 2]));
        // A folder stands for what is in it.
        let (exhibit, _) = desk.exhibit("", &Known::default());
        let [mean, most, colour] = surface.errors(&exhibit);
        eprintln!("Relight {kind}: mean {mean:.2}°, most {most:.2}°, albedo {colour:.3}");
        assert!(colour < 0.03, "{kind}: {colour}");
        worst.push(most);
    }
    // Between nine places a side the table itself is straight where light is not.
    assert!(
        worst[0] < 0.5 && worst[1] < 3.0 && worst[2] < 0.7,
        "{worst:?}"
    );
    assert!(worst[2] < worst[1] / 3.0, "{worst:?}");
}

/// Places of an octahedron folded flat and turned by 45°, so many a side.
fn octahedron(side: usize) -> Vec<DVec3> {
    let place = |i: usize| {
        let [u, v] = [i % side, i / side].map(|k| 2.0 * k as f64 / (side - 1) as f64 - 1.0);
        let (x, y) = ((u - v) / 2.0, (u + v) / 2.0);
        DVec3::new(x, y, (1.0 - x.abs() - y.abs()).max(0.0)).normalize()
    };
    (0..side * side).map(place).collect()
}

#[test]
fn luminance_and_chroma_of_relight_give_a_grey_surface_back() {
    let mut surface = Surface::new(3, 2);
    surface.size = [3, 1];
    surface.pixels.truncate(3);
    surface
        .pixels
        .iter_mut()
        .for_each(|(_, albedo)| *albedo = [0.5; 3]);
    let lamps = dome();
    let flat: Vec<f64> = lamps.iter().flat_map(|l| l.to_array()).collect();
    // The first three planes are luminance and both chromas, which are nothing; then luminance.
    let own = [0, 3, 4];
    let mut bytes = table(&surface, &lamps, 5, own);
    // Of luminance the first number counts alone.
    for i in (0..bytes.len()).filter(|i| i % 3 != 0) {
        bytes[i] = 200;
    }
    for plane in [2, 3] {
        bytes[plane * lamps.len() * 3..(plane + 1) * lamps.len() * 3].fill(127);
    }
    bytes[..lamps.len() * 3].fill(0);
    let info = json!({ "type": "rbf", "colorspace": "mycc", "yccplanes": [3, 1, 1],
        "lights": flat, "sigma": 0.125, "basis": bytes,
        "materials": [{ "scale": vec![1; 5], "bias": vec![0; 5], "range": vec![128; 5] }] });
    let desk = Desk::new();
    relight(&desk, &surface, info, &one_hot(5, own));
    let (exhibit, _) = desk.exhibit("info.json", &Known::default());
    let [_, most, colour] = surface.errors(&exhibit);
    assert!(most < 1.5 && colour < 0.03, "{most}° {colour}");
}

#[test]
fn values_are_read_as_srgb() {
    // What a wrong curve would do to these tests: half of the light is .735 of the values.
    assert!((srgb_encode(0.5) - 0.7354).abs() < 1e-4);
    assert!((srgb_decode(0.5) - 0.2140).abs() < 1e-4);
}
