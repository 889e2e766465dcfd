//! Generated files of every symmetry, and hostile ones.

use super::*;

/// OPTICS.md: zonal against stated lumens.
const LUMENS: f64 = 2e-3;
/// A baked profile against the file, as a share of the peak.
const BAKED: f64 = 1e-3;

/// A file of the intensities `of` (γ, C in degrees).
fn file(
    vertical: &[f64],
    horizontal: &[f64],
    lumens: f64,
    factors: [f64; 2],
    of: impl Fn(f64, f64) -> f64,
) -> String {
    let list = |numbers: &mut dyn Iterator<Item = f64>| {
        numbers
            .map(|x| format!("{x:.6}"))
            .collect::<Vec<_>>()
            .join(" ")
    };
    let [multiplier, ballast] = factors;
    let mut text = format!(
        "IESNA:LM-63-2002\n[TEST]\n[MANUFAC] none\nTILT=NONE\n1.0\t{lumens:.6}, {multiplier} \
         {} {} 1 2 0 0 0\n{ballast} 1 40\n{}\n{}\n",
        vertical.len(),
        horizontal.len(),
        list(&mut vertical.iter().copied()),
        list(&mut horizontal.iter().copied()),
    );
    for &c in horizontal {
        text += &list(
            &mut vertical
                .iter()
                .map(|&gamma| of(gamma, c) / multiplier / ballast),
        );
        text += "\n";
    }
    text + "\n"
}

fn degrees(from: u32, to: u32, step: usize) -> Vec<f64> {
    (from..=to).step_by(step).map(f64::from).collect()
}

/// Generated files of each symmetry with the lumens of their closed form.
fn files() -> Vec<(&'static str, String)> {
    let cos = |gamma: f64| gamma.to_radians().cos().max(0.0);
    // Lobes over the azimuth add nothing to its mean.
    let lobed = |k: f64| {
        move |gamma: f64, c: f64| 300.0 * cos(gamma) * (1.0 + 0.5 * (k * c.to_radians()).cos())
    };
    let sided = move |gamma: f64, c: f64| 300.0 * cos(gamma) * (1.0 + 0.5 * c.to_radians().sin());
    let beam = |gamma: f64, _: f64| 5000.0 * cos(gamma).powi(200);
    let halves: Vec<f64> = (0..=180).map(|i| f64::from(i) / 2.0).collect();
    let odd: Vec<f64> = (0..=163).map(|i| f64::from(i) * 90.0 / 163.0).collect();
    vec![
        // I = 100 cd all around: 400π lm.
        (
            "even",
            file(
                &degrees(0, 180, 5),
                &[0.0],
                400.0 * PI,
                [3.0, 1.0],
                |_, _| 100.0,
            ),
        ),
        // I = I₀ cos γ: π I₀.
        (
            "axial",
            file(
                &degrees(0, 90, 5),
                &[0.0],
                300.0 * PI,
                [1.0, 0.8],
                |g, _| 300.0 * cos(g),
            ),
        ),
        (
            "quadrants",
            file(
                &degrees(0, 90, 5),
                &degrees(0, 90, 15),
                300.0 * PI,
                [0.5, 1.0],
                lobed(2.0),
            ),
        ),
        (
            "halves",
            file(
                &degrees(0, 90, 5),
                &degrees(0, 180, 15),
                300.0 * PI,
                [1.0, 1.0],
                lobed(1.0),
            ),
        ),
        (
            "turned",
            file(
                &degrees(0, 90, 5),
                &degrees(90, 270, 15),
                300.0 * PI,
                [1.0, 1.0],
                sided,
            ),
        ),
        (
            "full",
            file(
                &degrees(0, 90, 5),
                &degrees(0, 360, 10),
                300.0 * PI,
                [1.0, 1.0],
                sided,
            ),
        ),
        (
            "open",
            file(
                &degrees(0, 90, 5),
                &degrees(0, 345, 15),
                300.0 * PI,
                [1.0, 1.0],
                sided,
            ),
        ),
        // A narrow beam: I = I₀ cosⁿ γ gives 2π I₀/(n + 1).
        (
            "beam",
            file(&halves, &[0.0], 2.0 * PI * 5000.0 / 201.0, [1.0, 1.0], beam),
        ),
        // At angles that no table has.
        (
            "odd",
            file(
                &odd,
                &[0.0, 7.0, 90.0],
                2.0 * PI * 5000.0 / 201.0,
                [1.0, 1.0],
                beam,
            ),
        ),
    ]
}

#[test]
fn zonal_lumens_are_the_stated_ones() {
    for (name, text) in files() {
        let lamp = Photometry::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let stated = lamp.stated_lumens().unwrap();
        let error = (lamp.lumens() / stated - 1.0).abs();
        eprintln!("{name}: {:.4} lm, {error:.1e} off", lamp.lumens());
        assert!(error < LUMENS, "{name}: {} of {stated} lm", lamp.lumens());
    }
}

#[test]
fn symmetries_stand_for_the_planes_that_are_not_given() {
    let at = |name: &str, gamma: f64, c: f64| {
        let (_, text) = files().into_iter().find(|(file, _)| *file == name).unwrap();
        let lamp = Photometry::parse(&text).unwrap();
        lamp.intensity(gamma.to_radians(), c.to_radians()) / 150.0
    };
    let close = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    };
    // 300 cos 60° is 150.
    for (c, share) in [
        (0.0, 1.5),
        (90.0, 0.5),
        (180.0, 1.5),
        (270.0, 0.5),
        (-90.0, 0.5),
    ] {
        close(at("quadrants", 60.0, c), share);
    }
    close(at("quadrants", 60.0, 135.0), 1.0);
    for (c, share) in [
        (0.0, 1.5),
        (90.0, 1.0),
        (180.0, 0.5),
        (270.0, 1.0),
        (300.0, 1.25),
    ] {
        close(at("halves", 60.0, c), share);
    }
    for name in ["turned", "full", "open"] {
        for (c, share) in [
            (0.0, 1.0),
            (90.0, 1.5),
            (210.0, 0.75),
            (270.0, 0.5),
            (330.0, 0.75),
        ] {
            close(at(name, 60.0, c), share);
        }
    }
    close(at("axial", 90.5, 0.0), 0.0);
    // The last angle of a file is in it.
    close(at("even", 180.0, 0.0), 100.0 / 150.0);
}

#[test]
fn planes_that_are_evenly_spaced_are_rows() {
    for (name, rows) in [
        ("even", 1),
        ("quadrants", 24),
        ("halves", 24),
        ("turned", 24),
        ("full", 36),
        ("open", 24),
        ("odd", MOST_ROWS),
    ] {
        let (_, text) = files().into_iter().find(|(file, _)| *file == name).unwrap();
        assert_eq!(Photometry::parse(&text).unwrap().rows(), rows, "{name}");
    }
}

#[test]
fn factors_are_read_up_to_their_bounds() {
    let text = |multiplier: &str, watts: &str| {
        format!(
            "IESNA:LM-63-2002\nTILT=NONE\n1 100 {multiplier} 2 1 1 2 0 0 0\n1 1 {watts}\n\
             0 90\n0\n10 10\n"
        )
    };
    for (multiplier, watts) in [("1e-9", "0"), ("1e9", "1e9")] {
        Photometry::parse(&text(multiplier, watts)).unwrap();
    }
    for (multiplier, watts, found) in [
        ("9e-10", "0", "0.0000000009 as the candela multiplier"),
        ("1.01e9", "0", "1010000000 as the candela multiplier"),
        ("1", "1.01e9", "1010000000 as the input watts"),
    ] {
        let error = Photometry::parse(&text(multiplier, watts)).unwrap_err();
        assert!(error.to_string().contains(found), "{error}");
    }
}

#[test]
fn baked_profiles_keep_to_their_file() {
    for (name, text) in files() {
        let lamp = Photometry::parse(&text).unwrap();
        let baked = lamp.baked();
        let look = |row: usize, column: f64| {
            let i = (column as usize).min(COLUMNS - 2);
            let t = column - i as f64;
            let row = row % lamp.rows() * COLUMNS;
            baked[row + i] * (1.0 - t) + baked[row + i + 1] * t
        };
        let mut worst = 0.0f64;
        for k in 0..20_000 {
            // Evenly spread (Kronecker sequence of the golden and plastic ratios).
            let gamma = (f64::from(k) * 0.618_033_988_749_895).fract() * PI;
            let c = (f64::from(k) * 0.754_877_666_246_693).fract() * 2.0 * PI;
            // The edge at 90°, where a file ends, is steeper than any table.
            if (gamma.to_degrees() - 90.0).abs() < 0.3 {
                continue;
            }
            let (row, column) = (
                c / (2.0 * PI) * lamp.rows() as f64,
                gamma / PI * (COLUMNS - 1) as f64,
            );
            let t = row.fract();
            let found = look(row as usize, column) * (1.0 - t) + look(row as usize + 1, column) * t;
            worst = worst.max((found - lamp.intensity(gamma, c) / lamp.peak()).abs());
        }
        eprintln!("{name}: baked within {worst:.1e} of the peak");
        assert!(worst < BAKED, "{name}: {worst}");
    }
}

#[test]
fn what_is_no_such_file_is_refused_with_its_line() {
    let good = file(&[0.0, 90.0], &[0.0], 100.0, [1.0, 1.0], |_, _| 10.0);
    Photometry::parse(&good).unwrap();
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        Photometry::parse(&good.replacen(from, to, 1))
            .unwrap_err()
            .to_string()
    };
    let header = "2 1 1 2 0 0 0";
    for (from, to, found) in [
        ("IESNA", "Dear Sir", "line 1: it does not begin with IESNA"),
        (
            "TILT=NONE",
            "TILT=INCLUDE",
            "line 4: a correction for a tilted lamp (TILT=), where only TILT=NONE is read",
        ),
        (
            "TILT=NONE",
            "TILT=../../lamp.tlt",
            "line 4: a correction for a tilted lamp (TILT=), where only TILT=NONE is read",
        ),
        ("TILT=NONE", "", "line 10: the file ends without TILT=NONE"),
        (
            header,
            "2 1 2 2 0 0 0",
            "line 5: photometry of type B, where only type C is read",
        ),
        (
            header,
            "2 1 3 2 0 0 0",
            "line 5: photometry of type A, where only type C is read",
        ),
        (
            header,
            "2 1 0 2 0 0 0",
            "line 5: 0 as the photometric type, not 1",
        ),
        (
            header,
            "0 1 1 2 0 0 0",
            "line 5: 0 as the number of vertical angles, not 1 to 4000",
        ),
        (
            header,
            "18446744073709551615 1 1 2 0 0 0",
            "line 5: 18446744073709552000 as the number of vertical angles, not 1 to 4000",
        ),
        (
            header,
            "2.5 1 1 2 0 0 0",
            "line 5: 2.5 as the number of vertical angles, not a whole number",
        ),
        (
            header,
            "4000 4000 1 2 0 0 0",
            "line 5: more than a million candela values",
        ),
        (
            header,
            "3 1 1 2 0 0 0",
            "line 8: a vertical angle 0 not above the one before it",
        ),
        (
            "90.000000\n",
            "nan\n",
            "line 7: \"nan\" where a vertical angle is due",
        ),
        (
            "90.000000\n",
            "-90\n",
            "line 7: -90 as a vertical angle, not 0 to 180",
        ),
        (
            "\n0.000000\n",
            "\n0.000000\n1 2 3\n",
            "line 9: more numbers than the angles ask for",
        ),
        (
            "10.000000 10.000000\n",
            "10.0\n",
            "line 9: the file ends where a candela value is due",
        ),
        (
            "10.000000 10.000000\n",
            "10.0 -1\n",
            "line 9: -1 as a candela value, not 0 to 1000000000000",
        ),
        (
            "10.000000 10.000000\n",
            "0 0\n",
            "line 9: a lamp without light",
        ),
    ] {
        assert_eq!(changed(from, to), found);
    }
}

#[test]
fn every_beginning_of_a_file_and_noise_are_refused_without_a_panic() {
    let good = file(
        &degrees(0, 90, 15),
        &degrees(0, 90, 45),
        100.0,
        [1.0, 1.0],
        |_, _| 10.0,
    );
    let end = good.trim_end().len();
    for cut in 0..end - 9 {
        assert!(Photometry::parse(&good[..cut]).is_err(), "{cut}");
    }
    // Every byte in turn becomes something else; whatever comes out is finite.
    for i in 0..good.len() {
        for byte in [b' ', b'-', b'9', b'e', b'.', b'\n', 0] {
            let mut bytes = good.clone().into_bytes();
            bytes[i] = byte;
            if let Ok(lamp) = Photometry::parse(&String::from_utf8_lossy(&bytes)) {
                assert!(lamp.lumens().is_finite() && lamp.peak() > 0.0);
                assert!(lamp.intensity(0.7, 1.9).is_finite());
            }
        }
    }
}
