//! The colour of a lamp from its spectral power.
//!
//! Only the chromaticity is used: the sheet is shaded in three channels, so that two lamps of one
//! colour show one picture whatever their spectra.

use std::fmt;

/// Wavelengths of the first row of [`CMF`] and between two rows, in nm.
const CMF_START_NM: f64 = 380.0;
const CMF_STEP_NM: f64 = 5.0;

/// x̄, ȳ, z̄ of the CIE 1931 standard observer (2°), 380…780 nm (ISO/CIE 11664-1:2019).
/// Between rows they are taken as linear, which moves the chromaticities of the CIE's
/// illuminants A, D, F and LED by at most 3e-4; the analytic lobes of Wyman et al. 2013 moved
/// them by up to 1.6e-3, and illuminant A by 1.3e-3.
#[rustfmt::skip]
const CMF: [[f64; 3]; 81] = [
    [0.001368, 0.000039, 0.00645],
    [0.002236, 0.000064, 0.01055],
    [0.004243, 0.00012, 0.02005],
    [0.00765, 0.000217, 0.03621],
    [0.01431, 0.000396, 0.06785],
    [0.02319, 0.00064, 0.1102],
    [0.04351, 0.00121, 0.2074],
    [0.07763, 0.00218, 0.3713],
    [0.13438, 0.004, 0.6456],
    [0.21477, 0.0073, 1.03905],
    [0.2839, 0.0116, 1.3856],
    [0.3285, 0.01684, 1.62296],
    [0.34828, 0.023, 1.74706],
    [0.34806, 0.0298, 1.7826],
    [0.3362, 0.038, 1.77211],
    [0.3187, 0.048, 1.7441],
    [0.2908, 0.06, 1.6692],
    [0.2511, 0.0739, 1.5281],
    [0.19536, 0.09098, 1.28764],
    [0.1421, 0.1126, 1.0419],
    [0.09564, 0.13902, 0.81295],
    [0.05795, 0.1693, 0.6162],
    [0.03201, 0.20802, 0.46518],
    [0.0147, 0.2586, 0.3533],
    [0.0049, 0.323, 0.272],
    [0.0024, 0.4073, 0.2123],
    [0.0093, 0.503, 0.1582],
    [0.0291, 0.6082, 0.1117],
    [0.06327, 0.71, 0.07825],
    [0.1096, 0.7932, 0.05725],
    [0.1655, 0.862, 0.04216],
    [0.22575, 0.91485, 0.02984],
    [0.2904, 0.954, 0.0203],
    [0.3597, 0.9803, 0.0134],
    [0.43345, 0.99495, 0.00875],
    [0.51205, 1.0, 0.00575],
    [0.5945, 0.995, 0.0039],
    [0.6784, 0.9786, 0.00275],
    [0.7621, 0.952, 0.0021],
    [0.8425, 0.9154, 0.0018],
    [0.9163, 0.87, 0.00165],
    [0.9786, 0.8163, 0.0014],
    [1.0263, 0.757, 0.0011],
    [1.0567, 0.6949, 0.001],
    [1.0622, 0.631, 0.0008],
    [1.0456, 0.5668, 0.0006],
    [1.0026, 0.503, 0.00034],
    [0.9384, 0.4412, 0.00024],
    [0.85445, 0.381, 0.00019],
    [0.7514, 0.321, 0.0001],
    [0.6424, 0.265, 0.00005],
    [0.5419, 0.217, 0.00003],
    [0.4479, 0.175, 0.00002],
    [0.3608, 0.1382, 0.00001],
    [0.2835, 0.107, 0.0],
    [0.2187, 0.0816, 0.0],
    [0.1649, 0.061, 0.0],
    [0.1212, 0.04458, 0.0],
    [0.0874, 0.032, 0.0],
    [0.0636, 0.0232, 0.0],
    [0.04677, 0.017, 0.0],
    [0.0329, 0.01192, 0.0],
    [0.0227, 0.00821, 0.0],
    [0.01584, 0.005723, 0.0],
    [0.0113592, 0.004102, 0.0],
    [0.00811092, 0.002929, 0.0],
    [0.00579035, 0.002091, 0.0],
    [0.00410946, 0.001484, 0.0],
    [0.00289933, 0.001047, 0.0],
    [0.00204919, 0.00074, 0.0],
    [0.00143997, 0.00052, 0.0],
    [0.000999949, 0.0003611, 0.0],
    [0.000690079, 0.0002492, 0.0],
    [0.000476021, 0.0001719, 0.0],
    [0.000332301, 0.00012, 0.0],
    [0.000234826, 0.0000848, 0.0],
    [0.000166151, 0.00006, 0.0],
    [0.000117413, 0.0000424, 0.0],
    [0.000083075, 0.00003, 0.0],
    [0.000058707, 0.0000212, 0.0],
    [0.00004151, 0.00001499, 0.0],
];

/// Points of a spectrum at most.
pub const MAX_POINTS: usize = 10_000;

/// An illuminant of the CIE by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Illuminant {
    A,
    C,
    D50,
    D55,
    D65,
    D75,
    E,
    F1,
    F2,
    F3,
    F4,
    F5,
    F6,
    F7,
    F8,
    F9,
    F10,
    F11,
    F12,
    #[serde(rename = "LED-B1")]
    LedB1,
    #[serde(rename = "LED-B2")]
    LedB2,
    #[serde(rename = "LED-B3")]
    LedB3,
    #[serde(rename = "LED-B4")]
    LedB4,
    #[serde(rename = "LED-B5")]
    LedB5,
    #[serde(rename = "LED-BH1")]
    LedBh1,
    #[serde(rename = "LED-RGB1")]
    LedRgb1,
    #[serde(rename = "LED-V1")]
    LedV1,
    #[serde(rename = "LED-V2")]
    LedV2,
}

impl Illuminant {
    /// Chromaticity x, y for the 2° observer as the CIE publishes it, to four or five digits
    /// (CIE 015:2018). Those of A, D50,
    /// D65, F and LED were integrated here from tabulated spectra and agree to 7e-5.
    pub fn xy(self) -> [f64; 2] {
        match self {
            Self::A => [0.44758, 0.40745],
            Self::C => [0.31006, 0.31616],
            Self::D50 => [0.34567, 0.35851],
            Self::D55 => [0.33243, 0.34744],
            Self::D65 => [0.31272, 0.32903],
            Self::D75 => [0.29903, 0.31488],
            Self::E => [1.0 / 3.0, 1.0 / 3.0],
            Self::F1 => [0.3131, 0.3371],
            Self::F2 => [0.3721, 0.3751],
            Self::F3 => [0.4091, 0.3941],
            Self::F4 => [0.4402, 0.4031],
            Self::F5 => [0.3138, 0.3452],
            Self::F6 => [0.3779, 0.3882],
            Self::F7 => [0.3129, 0.3292],
            Self::F8 => [0.3458, 0.3586],
            Self::F9 => [0.3741, 0.3727],
            Self::F10 => [0.3458, 0.3588],
            Self::F11 => [0.3805, 0.3769],
            Self::F12 => [0.4370, 0.4042],
            Self::LedB1 => [0.4560, 0.4078],
            Self::LedB2 => [0.4357, 0.4012],
            Self::LedB3 => [0.3756, 0.3723],
            Self::LedB4 => [0.3422, 0.3502],
            Self::LedB5 => [0.3118, 0.3236],
            Self::LedBh1 => [0.4474, 0.4066],
            Self::LedRgb1 => [0.4557, 0.4211],
            Self::LedV1 => [0.4548, 0.4044],
            Self::LedV2 => [0.3781, 0.3775],
        }
    }
}

/// Why a table of spectral power is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpectrumError {
    /// How many points there are, of 2 to [`MAX_POINTS`].
    Count(usize),
    /// Wavelengths and powers are not equally many.
    Uneven { wavelengths: usize, powers: usize },
    /// The wavelength of this point is not above that before it.
    Order(usize),
    /// The wavelength or power of this point is not a number, or below zero.
    Number(usize),
    /// No power between 380 and 780 nm.
    Invisible,
}

impl fmt::Display for SpectrumError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(points) => write!(f, "{points} points"),
            Self::Uneven {
                wavelengths,
                powers,
            } => write!(f, "{wavelengths} wavelengths with {powers} powers"),
            Self::Order(point) => {
                write!(
                    f,
                    "a wavelength not above the one before it, at point {}",
                    point + 1
                )
            }
            Self::Number(point) => write!(f, "no number from zero up, at point {}", point + 1),
            Self::Invisible => f.write_str("no power from 380 to 780 nm"),
        }
    }
}

/// Chromaticity x, y (2° observer) of light whose spectral power, in any unit per nm, is linear
/// between the points of rising `wavelengths` in nm and zero outside them.
///
/// # Errors
/// Where the table is none.
pub fn chromaticity(wavelengths: &[f64], power: &[f64]) -> Result<[f64; 2], SpectrumError> {
    if wavelengths.len() != power.len() {
        return Err(SpectrumError::Uneven {
            wavelengths: wavelengths.len(),
            powers: power.len(),
        });
    }
    if !(2..=MAX_POINTS).contains(&wavelengths.len()) {
        return Err(SpectrumError::Count(wavelengths.len()));
    }
    let sound = |v: &f64| v.is_finite() && *v >= 0.0;
    let unsound = |(w, p)| !(sound(w) && sound(p));
    if let Some(point) = wavelengths.iter().zip(power).position(unsound) {
        return Err(SpectrumError::Number(point));
    }
    if let Some(before) = wavelengths.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(SpectrumError::Order(before + 1));
    }
    // Any scale is as good: sums of the largest numbers must not overflow.
    let largest = power.iter().fold(0.0, |a: f64, b| a.max(*b));
    let end = CMF_START_NM + CMF_STEP_NM * (CMF.len() - 1) as f64;
    let mut stops: Vec<f64> = (0..CMF.len())
        .map(|i| CMF_START_NM + CMF_STEP_NM * i as f64)
        .chain(wavelengths.iter().copied())
        .filter(|w| (CMF_START_NM..=end).contains(w))
        .filter(|w| (wavelengths[0]..=wavelengths[wavelengths.len() - 1]).contains(w))
        .collect();
    stops.sort_by(f64::total_cmp);
    // Between two stops both factors are linear: Simpson's rule is exact.
    let mut xyz = [0.0; 3];
    for pair in stops.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        for (w, share) in [(a, 1.0), (0.5 * (a + b), 4.0), (b, 1.0)] {
            let weight = share
                * (b - a)
                * (power_at(wavelengths, power, w) / largest.max(f64::MIN_POSITIVE));
            let bar = observer(w);
            for k in 0..3 {
                xyz[k] += weight * bar[k];
            }
        }
    }
    let sum: f64 = xyz.iter().sum();
    if xyz[1] > 0.0 && sum.is_finite() {
        Ok([xyz[0] / sum, xyz[1] / sum])
    } else {
        Err(SpectrumError::Invisible)
    }
}

fn power_at(wavelengths: &[f64], power: &[f64], w: f64) -> f64 {
    let i = wavelengths
        .partition_point(|x| *x <= w)
        .clamp(1, wavelengths.len() - 1);
    let t = (w - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1]);
    power[i - 1] + (power[i] - power[i - 1]) * t
}

fn observer(w: f64) -> [f64; 3] {
    let place = ((w - CMF_START_NM) / CMF_STEP_NM).clamp(0.0, (CMF.len() - 1) as f64);
    let i = (place as usize).min(CMF.len() - 2);
    let t = place - i as f64;
    std::array::from_fn(|k| CMF[i][k] + (CMF[i + 1][k] - CMF[i][k]) * t)
}

/// Wavelengths in nm and powers of a text of two columns, separated by commas, semicolons, tabs
/// or spaces; a first line of headings and lines that begin with # are passed over.
///
/// # Errors
/// With the number of the first line that is none, from 1.
pub fn two_columns(text: &str) -> Result<[Vec<f64>; 2], usize> {
    let mut columns = [Vec::new(), Vec::new()];
    let mut headed = false;
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Vec<Option<f64>> = line
            .split([',', ';', '\t', ' '])
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().ok())
            .collect();
        match numbers[..] {
            [Some(wavelength), Some(power)] => {
                columns[0].push(wavelength);
                columns[1].push(power);
            }
            _ if !headed && columns[0].is_empty() && numbers.iter().all(Option::is_none) => {
                headed = true;
            }
            _ => return Err(i + 1),
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the tabulated observer may differ from the published figures (brief of issue 3).
    const PUBLISHED: f64 = 1e-3;

    fn near(found: [f64; 2], published: [f64; 2]) {
        for k in 0..2 {
            assert!(
                (found[k] - published[k]).abs() < PUBLISHED,
                "{found:?} {published:?}"
            );
        }
    }

    #[test]
    fn illuminant_a_and_daylight_come_out_as_published() {
        let wavelengths: Vec<f64> = (300..=830).step_by(5).map(f64::from).collect();
        // The formula of CIE 015:2018.
        let a = |w: f64| (560.0 / w).powi(5) / ((1.435e7 / (2848.0 * w)).exp() - 1.0);
        let power: Vec<f64> = wavelengths.iter().map(|w| a(*w)).collect();
        near(
            chromaticity(&wavelengths, &power).unwrap(),
            Illuminant::A.xy(),
        );
        // D65, 380…780 nm by 10 nm (CIE 015:2018).
        let d65 = [
            49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812,
            114.861, 115.923, 108.811, 109.354, 107.802, 104.79, 107.689, 104.405, 104.046, 100.0,
            96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
            80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087, 63.5927,
            46.4182, 66.8054, 63.3828,
        ];
        let wavelengths: Vec<f64> = (0..d65.len()).map(|i| 380.0 + 10.0 * i as f64).collect();
        near(
            chromaticity(&wavelengths, &d65).unwrap(),
            Illuminant::D65.xy(),
        );
        near(
            chromaticity(&[300.0, 900.0], &[7.0, 7.0]).unwrap(),
            Illuminant::E.xy(),
        );
    }

    /// As CIE 015:2018 states them beside the coordinates.
    #[test]
    fn lamps_have_the_temperatures_that_are_published() {
        use Illuminant as I;
        let published = [
            (I::F1, 6430.0),
            (I::F2, 4230.0),
            (I::F3, 3450.0),
            (I::F4, 2940.0),
            (I::F5, 6350.0),
            (I::F6, 4150.0),
            (I::F7, 6500.0),
            (I::F8, 5000.0),
            (I::F9, 4150.0),
            (I::F10, 5000.0),
            (I::F11, 4000.0),
            (I::F12, 3000.0),
            (I::LedB1, 2733.0),
            (I::LedB2, 2998.0),
            (I::LedB3, 4103.0),
            (I::LedB4, 5109.0),
            (I::LedB5, 6598.0),
            (I::LedBh1, 2851.0),
            (I::LedRgb1, 2840.0),
            (I::LedV1, 2724.0),
            (I::LedV2, 4070.0),
            (I::C, 6774.0),
            (I::D50, 5003.0),
            (I::D55, 5503.0),
            (I::D75, 7504.0),
        ];
        // McCamy 1992; and, in y, the line of daylight of CIE 015:2018, near which all of them are.
        let sound = |[x, y]: [f64; 2], kelvin: f64| {
            let n = (x - 0.332) / (0.1858 - y);
            let mccamy = ((449.0 * n + 3525.0) * n + 6823.3) * n + 5520.33;
            let daylight = (2.87 - 3.0 * x) * x - 0.275;
            (mccamy / kelvin - 1.0).abs() < 0.003 && (y - daylight).abs() < 0.016
        };
        for (illuminant, kelvin) in published {
            let [x, y] = illuminant.xy();
            assert!(sound([x, y], kelvin), "{illuminant:?}");
            // A tenth off in either coordinate is another lamp.
            assert!(!sound([1.1 * x, y], kelvin) && !sound([x, 1.1 * y], kelvin));
        }
    }

    #[test]
    fn a_line_is_on_the_spectral_locus_and_any_scale_is_the_same() {
        // 520 nm: x .0743, y .8338 (CIE 018:2019).
        for scale in [1e-300, 1.0, 1e300] {
            let line = chromaticity(&[519.999, 520.0, 520.001], &[0.0, scale, 0.0]).unwrap();
            near(line, [0.0743, 0.8338]);
        }
    }

    /// The rule between two stops is exact, so that one stop more changes nothing.
    #[test]
    fn a_point_on_the_line_between_two_others_changes_nothing() {
        let few = chromaticity(&[450.0, 470.0], &[0.0, 1.0]).unwrap();
        let more = chromaticity(&[450.0, 451.0, 470.0], &[0.0, 0.05, 1.0]).unwrap();
        for (few, more) in few.into_iter().zip(more) {
            assert!((few - more).abs() < 1e-12, "{few} {more}");
        }
    }

    #[test]
    fn what_is_no_spectrum_is_refused() {
        use SpectrumError as E;
        assert!(E::Number(1).to_string().ends_with("at point 2"));
        let of = |w: &[f64], p: &[f64]| chromaticity(w, p).unwrap_err();
        assert_eq!(of(&[500.0], &[1.0]), E::Count(1));
        assert_eq!(
            of(&[400.0, 500.0], &[1.0]),
            E::Uneven {
                wavelengths: 2,
                powers: 1
            }
        );
        assert_eq!(of(&[500.0, 500.0], &[1.0, 1.0]), E::Order(1));
        assert_eq!(of(&[400.0, 500.0], &[1.0, f64::NAN]), E::Number(1));
        assert_eq!(of(&[400.0, f64::INFINITY], &[1.0, 1.0]), E::Number(1));
        assert_eq!(of(&[400.0, 500.0], &[1.0, -1.0]), E::Number(1));
        assert_eq!(of(&[800.0, 900.0], &[1.0, 1.0]), E::Invisible);
        assert_eq!(of(&[400.0, 500.0], &[0.0, 0.0]), E::Invisible);
    }

    #[test]
    fn two_columns_are_read_however_they_are_separated() {
        let expected = [vec![400.0, 410.5], vec![1.0, 2e-3]];
        for text in [
            "nm,power\n400,1\n410.5,2e-3\n",
            "\u{feff}# measured\r\n400;1\r\n\r\n410.5; 2e-3",
            "400\t1\n410.5   2e-3",
        ] {
            assert_eq!(two_columns(text).unwrap(), expected, "{text}");
        }
        assert_eq!(two_columns("nm,power\n400,1\n410,2,3\n"), Err(3));
        assert_eq!(two_columns("a,b\nc,d\n"), Err(2));
    }
}
