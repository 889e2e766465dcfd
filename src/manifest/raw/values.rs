//! The single values of a manifest: numbers with their ranges, words and texts of a fixed form.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;

use super::super::{
    decode::{Decode, Node, Pattern, Report},
    document::Words,
    exhibit::{CompareMode, FlipAxis, ShowThrough, SideName, Source},
    fault::{did_you_mean, quoted_list},
    macros::{choice, number, pattern},
};
use crate::{
    maps::{ColourEncoding, ColourMapName, NormalY, registration::FitKind},
    optics::medium::{MediumId, MediumKind, Preset},
    optics::spectrum::Illuminant,
};

number! {
    /// A width or height of a sheet.
    SheetMm = 1.0 ..= 5000.0, "mm";
    /// A place on a side, from its left or top edge; somewhat outside is possible.
    PlaceMm = -5000.0 ..= 10000.0, "mm";
    /// A shift on the sheet.
    OffsetMm = -5000.0 ..= 5000.0, "mm";
    /// A coordinate of a lamp, from the centre of the sheet.
    PositionMm = -100000.0 ..= 100000.0, "mm";
    /// A distance of a lamp or eye from the centre.
    DistanceMm = 1.0 ..= 100000.0, "mm";
    /// A width, height or diameter of a lamp.
    LampMm = 0.1 ..= 10000.0, "mm";
    /// A distance between chain lines.
    ChainLinesMm = 5.0 ..= 100.0, "mm";
    /// A width of the view.
    ViewMm = 0.1 ..= 20000.0, "mm";
    /// A thickness of paper.
    ThicknessUm = 1.0 ..= 2000.0, "µm", "thinner is no sheet and thicker is board";
    /// A height of relief.
    ReliefUm = -100000.0 ..= 100000.0, "µm";
    /// A coordinate in a picture, from its left or top edge; pixel centres lie at halves.
    PixelPx = -100000.0 ..= 100000.0, "pixels";
    /// A roughness α of the facet distribution; no paper is smoother than a tenth.
    Alpha = 0.1 ..= 1.0, "";
    /// A refractive index.
    RefractiveIndex = 1.0 ..= 3.0, "", "light is nowhere faster than in a vacuum";
    /// A share.
    Fraction = 0.0 ..= 1.0, "";
    /// A linear display level.
    Level = 0.01 ..= 1.0, "";
    /// An illuminance that a lamp gives or a picture is exposed for.
    LampLux = 0.001 ..= 1000000.0, "lx";
    /// An illuminance of room light.
    RoomLux = 0.0 ..= 1000000.0, "lx";
    /// A luminous intensity.
    LampCandela = 0.000001 ..= 1000000000.0, "cd";
    /// A luminous flux.
    LampLumen = 0.000001 ..= 1000000000.0, "lm";
    /// An electric power.
    LampWatts = 0.000001 ..= 1000000.0, "W";
    /// A luminous efficacy; 683 lm/W is that of green light of 555 nm (CIE 018:2019).
    LampEfficacy = 0.001 ..= 683.0, "lm/W";
    /// A luminance.
    LampNits = 0.000001 ..= 1000000000.0, "cd/m²";
    /// A wavelength of light.
    WavelengthNm = 10.0 ..= 100000.0, "nm";
    /// A middle of a band that a camera sees the sheet in: X-rays are shorter, thermography longer.
    BandNm = 100.0 ..= 20000.0, "nm";
    /// A weight of a band.
    Weight = -100.0 ..= 100.0, "";
    /// A spectral power in any unit.
    SpectralPower = 0.0 ..= 1000000000.0, "";
    /// A correlated colour temperature.
    Temperature = 1000.0 ..= 25000.0, "K";
    /// An angle above the plane of the sheet.
    ElevationDeg = 0.1 ..= 90.0, "degrees";
    /// An angle of any direction.
    TurnDeg = -360.0 ..= 360.0, "degrees";
    /// An angle from straight above.
    TiltDeg = 0.0 ..= 89.0, "degrees";
    /// A half angle of a cone of light.
    ConeDeg = 0.1 ..= 89.9, "degrees";
    /// A factor of size.
    Scale = 0.01 ..= 100.0, "";
    /// How much larger something is shown.
    Magnification = 1.0 ..= 20.0, "";
    /// The radius of a loupe as a share of a picture's height.
    LoupeRadius = 0.01 ..= 1.0, "";
    /// A value of a measured quantity in its own unit.
    Quantity = -1000000000.0 ..= 1000000000.0, "";
    /// A duration.
    Seconds = 0.1 ..= 3600.0, "s";
    /// A colour difference ΔE00.
    DeltaE = 0.01 ..= 100.0, "ΔE00";
    /// How many times steeper a relief is shown.
    Exaggeration = 1.0 ..= 20.0, "";
    /// A time for one frame.
    FrameMs = 1.0 ..= 1000.0, "ms";
    /// A roughness α of a drawing material.
    MediumAlpha = 0.01 ..= 1.0, "";
    /// A share of the light that is reflected.
    Reflectance = 0.0 ..= 1.0, "", "nothing reflects more light than falls on it";
    /// A scattering coefficient σs.
    ScatteringPerMm = 0.01 ..= 10000.0, "per mm", "what scatters less is glass and nothing drawn scatters more";
    /// A mean cosine of forward scattering.
    ForwardCosine = 0.0 ..= 0.99, "", "a forward lobe goes forwards and at 1 straight on";
    /// A mean cosine of backward scattering.
    BackwardCosine = -0.99 ..= 0.0, "", "a backward lobe goes backwards and at -1 straight back";
    /// A thickness of a layer.
    LayerUm = 0.1 ..= 2000.0, "µm", "thinner is no layer and thicker is board";
    /// An optical depth along the normal.
    OpticalDepth = 0.0 ..= 20.0, "", "a film takes light away and beyond 20 all of it";
    /// A real part of the refractive index of metal or pigment, which may be below 1.
    ParticleIndex = 0.01 ..= 6.0, "", "no metal or pigment has another";
    /// An imaginary part of a refractive index.
    Extinction = 0.0 ..= 20.0, "", "below 0 matter would give light off and no metal has more";
}

/// The range of a number.
#[derive(Clone, Copy)]
pub(crate) struct Range {
    pub min: f64,
    pub max: f64,
    pub unit: &'static str,
    /// Why nothing else can be, where it is not just unusual; may be empty.
    pub reason: &'static str,
}

pub(crate) fn number_allowed(min: f64, max: f64, unit: &str) -> String {
    format!("a number from {min} to {max} {unit}")
        .trim_end()
        .to_owned()
}

pub(crate) fn decode_number(node: &Node<'_>, range: Range, report: &mut Report<'_>) -> Option<f64> {
    let Range {
        min,
        max,
        unit,
        reason,
    } = range;
    let mut allowed = number_allowed(min, max, unit);
    let remedy = match node.number() {
        Some(number) if (min..=max).contains(&number) => return Some(number),
        Some(number) if !number.is_finite() => "write an ordinary number",
        Some(_) => {
            if !reason.is_empty() {
                allowed = format!("{allowed}, as {reason}");
            }
            "write a number within this range"
        }
        None if node
            .text()
            .is_some_and(|text| text.trim().parse::<f64>().is_ok()) =>
        {
            "remove the quotation marks"
        }
        None => "write a number",
    };
    let words = Words::new(node.found(), allowed, remedy);
    report.fault(node.trail(), words);
    None
}

/// An enum that a manifest writes as a word.
pub(crate) trait Choice: Copy + 'static {
    const WORDS: &'static [(&'static str, Self)];
}

choice! {
    SideName { Recto = "recto", Verso = "verso", }
    ShowThrough { Photographed = "photographed", Modelled = "modelled", }
    Source { Measured = "measured", Fitted = "fitted", Assumed = "assumed", }
    FitKind {
        Shift = "shift",
        Similarity = "similarity",
        Affine = "affine",
        ThinPlate = "thin-plate",
    }
    FlipAxis { Vertical = "horizontal", Horizontal = "vertical", }
    CompareMode {
        Curtain = "curtain",
        SideBySide = "side-by-side",
        Blend = "blend",
        Loupe = "loupe",
        Difference = "difference",
        Flicker = "flicker",
        Glass = "glass",
    }
    ColourEncoding { Embedded = "embedded", Srgb = "srgb", Linear = "linear", }
    Illuminant {
        A = "A",
        C = "C",
        D50 = "D50",
        D55 = "D55",
        D65 = "D65",
        D75 = "D75",
        E = "E",
        F1 = "F1",
        F2 = "F2",
        F3 = "F3",
        F4 = "F4",
        F5 = "F5",
        F6 = "F6",
        F7 = "F7",
        F8 = "F8",
        F9 = "F9",
        F10 = "F10",
        F11 = "F11",
        F12 = "F12",
        LedB1 = "LED-B1",
        LedB2 = "LED-B2",
        LedB3 = "LED-B3",
        LedB4 = "LED-B4",
        LedB5 = "LED-B5",
        LedBh1 = "LED-BH1",
        LedRgb1 = "LED-RGB1",
        LedV1 = "LED-V1",
        LedV2 = "LED-V2",
    }
    NormalY { Up = "up", Down = "down", }
    Preset { Recto = "recto", Isle2021 = "isle-2021", }
    ColourMapName {
        Viridis = "viridis",
        Magma = "magma",
        Cividis = "cividis",
        Grey = "grey",
        Diverging = "diverging",
    }
}

pub(crate) fn choice_allowed<T: Choice>() -> String {
    quoted_list(T::WORDS.iter().map(|(word, _)| *word))
}

pub(crate) fn decode_choice<T: Choice>(node: &Node<'_>, report: &mut Report<'_>) -> Option<T> {
    let word = node.text().unwrap_or_default();
    let choice = T::WORDS
        .iter()
        .find(|(name, _)| *name == word)
        .map(|(_, value)| *value);
    if choice.is_none() {
        let remedy = did_you_mean(
            word,
            T::WORDS.iter().map(|(word, _)| *word),
            "write one of these words",
        );
        report.fault(
            node.trail(),
            Words::new(node.found(), choice_allowed::<T>(), remedy),
        );
    }
    choice
}

pattern! {
    /// A name by which other parts of the manifest, links and commands refer to this.
    Id = "^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$", is_id,
        "an id of up to 64 letters a to z, digits, - and _, beginning with a letter or digit",
        "write a short plain name and keep spaces and accents for the title";
    /// A language by its BCP 47 tag.
    Language = "^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*$", is_language,
        "BCP 47 language tags such as \"en\", \"it\" or \"pt-BR\"",
        "write the language's tag";
    /// A text to read.
    Text = "[^ \\t\\r\\n]", is_text,
        "a text that is not empty",
        "write a text in quotation marks, or leave the key out";
    /// A file in the exhibit's folder.
    FilePath = "^[^\\u0000-\\u001f\\u007f/][^\\u0000-\\u001f\\u007f]*$", is_file_path,
        "the path of a file inside the exhibit's folder",
        "move the file into the exhibit's folder and write its path from there";
    /// A colour as in a style sheet, in sRGB.
    HexColour = "^#[0-9A-Fa-f]{6}$", is_hex_colour,
        "colours such as \"#d55e00\"",
        "write # and six hexadecimal digits";
    /// A day, a month or a year.
    DateText = "^[0-9]{4}(-(0[1-9]|1[0-2])(-(0[1-9]|[12][0-9]|3[01]))?)?$", is_date,
        "a date as \"YYYY\", \"YYYY-MM\" or \"YYYY-MM-DD\"",
        "write it in quotation marks, year first";
    /// A wavelength as the key of a table.
    BandKey = "^[0-9]{1,9}([.][0-9]{1,9})?$", is_band_key,
        "wavelengths in nm",
        "write the wavelength of a band in nm, such as 700";
    /// What lies over a side: an overlay, or what is shown of a stack.
    LayerName = "^[A-Za-z0-9][A-Za-z0-9_-]{0,63}(/[A-Za-z0-9][A-Za-z0-9_.-]{0,63})?$", is_layer,
        "the id of an overlay, or STACK/NM or STACK/ID of a stack",
        "write its id, and for a stack the wavelength of a band or the id of a view behind a /";
    /// A member of a comparison.
    MemberText = "^(state|drawing):[A-Za-z0-9][A-Za-z0-9_-]{0,63}$|^side:(recto|verso)$|^overlay:[A-Za-z0-9][A-Za-z0-9_-]{0,63}(/[A-Za-z0-9][A-Za-z0-9_.-]{0,63})?$|^band:[A-Za-z0-9][A-Za-z0-9_-]{0,63}/[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$",
        is_member,
        "\"state:ID\", \"side:recto\", \"side:verso\", \"overlay:ID\", \"band:STACK/NM\" or \"drawing:ID\"",
        "write what it is, a colon and its id";
}

pub(crate) fn decode_pattern<T: Pattern>(node: &Node<'_>, report: &mut Report<'_>) -> Option<T> {
    let value = node.text().and_then(T::from_text);
    if value.is_none() {
        let remedy = if node.number().is_some() {
            "put it in quotation marks"
        } else {
            T::REMEDY
        };
        report.fault(node.trail(), Words::new(node.found(), T::ALLOWED, remedy));
    }
    value
}

fn is_id(text: &str) -> bool {
    text.len() <= 64
        && text.starts_with(|c: char| c.is_ascii_alphanumeric())
        && text
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

fn is_language(text: &str) -> bool {
    text.split('-').enumerate().all(|(i, subtag)| {
        let shortest = if i == 0 { 2 } else { 1 };
        (shortest..=8).contains(&subtag.len())
            && subtag.chars().all(|c| {
                if i == 0 {
                    c.is_ascii_alphabetic()
                } else {
                    c.is_ascii_alphanumeric()
                }
            })
    })
}

fn is_text(text: &str) -> bool {
    text.contains(|c| !matches!(c, ' ' | '\t' | '\r' | '\n'))
}

fn is_file_path(text: &str) -> bool {
    !text.is_empty() && !text.starts_with('/') && !text.contains(|c: char| c.is_ascii_control())
}

fn is_hex_colour(text: &str) -> bool {
    crate::colour::parse_hex(text).is_some()
}

fn is_date(text: &str) -> bool {
    let number = |part: &str, digits: usize| {
        (part.len() == digits && part.bytes().all(|b| b.is_ascii_digit()))
            .then(|| part.parse::<u32>().ok())
            .flatten()
    };
    let parts: Vec<&str> = text.split('-').collect();
    let within = |part: Option<&&str>, range: std::ops::RangeInclusive<u32>| {
        part.is_none_or(|part| number(part, 2).is_some_and(|n| range.contains(&n)))
    };
    parts.len() <= 3
        && number(parts[0], 4).is_some()
        && within(parts.get(1), 1..=12)
        && within(parts.get(2), 1..=31)
}

fn is_member(text: &str) -> bool {
    match text.split_once(':') {
        Some(("side", side)) => matches!(side, "recto" | "verso"),
        Some(("state" | "drawing", id)) => is_id(id),
        Some(("overlay", id)) => is_layer(id),
        Some(("band", id)) => id.contains('/') && is_layer(id),
        _ => false,
    }
}

fn is_layer(text: &str) -> bool {
    match text.split_once('/') {
        None => is_id(text),
        // Wavelengths may have decimals.
        Some((stack, view)) => {
            is_id(stack) && !view.starts_with('.') && is_id(&view.replace('.', "-"))
        }
    }
}

fn is_band_key(text: &str) -> bool {
    let digits =
        |text: &str| (1..=9).contains(&text.len()) && text.chars().all(|c| c.is_ascii_digit());
    match text.split_once('.') {
        None => digits(text),
        Some((whole, part)) => digits(whole) && digits(part),
    }
}

/// A paper of the catalogue, or of the manifest's own media.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct PaperName(pub Id);

/// A drawing material of the catalogue, or of the manifest's own media.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct MediumName(pub Id);

macro_rules! catalogue_name {
    ($($name:ident of $kind:ident;)*) => {$(
        impl $name {
            fn words() -> impl Iterator<Item = &'static str> {
                MediumId::all().filter(|id| id.medium().kind == MediumKind::$kind).map(MediumId::name)
            }
        }

        impl Decode for $name {
            fn allowed() -> String {
                format!("{}, or the id of a [[medium]]", quoted_list(Self::words()))
            }

            // Whether there is such a medium is known when all media are.
            fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
                let id = node.text().and_then(Id::from_text);
                if id.is_none() {
                    let word = node.text().unwrap_or_default();
                    let remedy = did_you_mean(word, Self::words(), "write one of these words");
                    report.fault(node.trail(), Words::new(node.found(), Self::allowed(), remedy));
                }
                id.map(Self)
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                // The words first, for editors that complete them.
                json_schema!({
                    "anyOf": [
                        { "enum": Self::words().collect::<Vec<_>>() },
                        { "type": "string", "pattern": Id::PATTERN },
                    ],
                })
            }
        }
    )*};
}

catalogue_name! {
    PaperName of Paper;
    MediumName of Drawn;
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn same_words<T: Choice + Serialize>() {
        for (word, value) in T::WORDS {
            assert_eq!(serde_json::to_value(value).unwrap(), *word);
        }
    }

    #[test]
    fn words_are_written_as_they_are_read() {
        same_words::<SideName>();
        same_words::<Source>();
        same_words::<FitKind>();
        same_words::<FlipAxis>();
        same_words::<CompareMode>();
        same_words::<ColourEncoding>();
        same_words::<NormalY>();
        same_words::<ColourMapName>();
    }

    fn agrees<T: Pattern>(text: &str) {
        let schema = serde_json::json!({ "type": "string", "pattern": T::PATTERN });
        let accepts = jsonschema::is_valid(&schema, &text.into());
        assert_eq!(
            T::from_text(text).is_some(),
            accepts,
            "{text:?} against {}",
            T::PATTERN
        );
    }

    fn all_agree(text: &str) {
        agrees::<Id>(text);
        agrees::<Language>(text);
        agrees::<Text>(text);
        agrees::<FilePath>(text);
        agrees::<HexColour>(text);
        agrees::<DateText>(text);
        agrees::<MemberText>(text);
        agrees::<BandKey>(text);
        agrees::<LayerName>(text);
    }

    #[test]
    fn checks_and_patterns_agree_on_edge_cases() {
        for text in [
            "",
            " ",
            "\u{a0}",
            "a",
            "a\n",
            "-a",
            "_",
            "é",
            "en-",
            "e",
            "en-GB",
            "en-123456789",
            "/a",
            "a/b",
            "a\\b",
            "..",
            "a\u{7f}",
            "a\0",
            "a/450.5",
            "a/.5",
            "a/b/c",
            "450",
            "450.",
            "450.5",
            "band:a/450",
            "band:a",
            "overlay:a/450.5",
            "#abcdef",
            "#ABCDE",
            "#abcdeg",
            "abcdef",
            "1997",
            "1997-11",
            "1997-13",
            "1997-02-31",
            "1997-11-32",
            "1997-1",
            "97",
            "1997-11-",
            "1997-11-03-1",
            "١٩٩٧",
            "state:a",
            "side:recto",
            "side:left",
            "state:",
            "lamp:a",
        ] {
            all_agree(text);
        }
        all_agree(&"a".repeat(64));
        all_agree(&"a".repeat(65));
    }

    proptest! {
        #[test]
        fn checks_and_patterns_agree(text in ".{0,12}|[a-z0-9:#/-]{0,12}") {
            all_agree(&text);
        }
    }
}
