//! Which canvases are two sides of one sheet, what it is called, how large it is, and what its
//! pictures show.

use std::collections::{BTreeMap, BTreeSet};

use super::{Role, read::Canvas, words::Texts};
use crate::{
    exchange::{ASSUMED_MM_PER_PX, Known, error::Faulty},
    manifest::{
        Pattern as _, SideName,
        document::Words,
        raw::values::{BandKey, Id},
    },
    maps::Header,
};

/// How far apart the shapes of a sheet and of its canvas may be: size is written in whole mm.
const SAME_SHAPE: f64 = 0.03;
/// Coarser pictures have their resolution from a program that wrote it without thinking.
const LEAST_DPI: f64 = 100.0;

/// A sheet.
pub struct Sheet<'c, 'j> {
    pub id: String,
    pub title: Texts,
    recto: &'c Canvas<'j>,
    verso: Option<&'c Canvas<'j>>,
}

/// Ids that differ from each other.
#[derive(Default)]
pub struct Ids {
    taken: BTreeSet<String>,
    /// Of an id that was wanted again, the last number behind it.
    last: BTreeMap<String, usize>,
}

impl Ids {
    /// The id itself, or with the first number behind it, from 2, with which it is free.
    pub fn free(&mut self, wanted: &str) -> String {
        let mut id = wanted.to_owned();
        while !self.taken.insert(id.clone()) {
            let last = self.last.entry(wanted.to_owned()).or_insert(1);
            *last += 1;
            id = with_tail(wanted, &format!("-{last}"));
        }
        id
    }
}

/// An id with something behind it, cut where it would be too long.
fn with_tail(id: &str, tail: &str) -> String {
    const LONGEST: usize = 64;
    let kept = id.len().min(LONGEST - tail.len());
    // It is of ASCII alone.
    format!("{}{tail}", id.get(..kept).unwrap_or_default())
}

/// Groups canvases in their order: a recto and the verso behind it are one sheet, and every other
/// canvas is one of its own.
pub fn sheets<'c, 'j>(canvases: &'c [Canvas<'j>], faulty: &mut Faulty<'_>) -> Vec<Sheet<'c, 'j>> {
    let mut sheets: Vec<Sheet<'c, 'j>> = Vec::new();
    let mut ids = Ids::default();
    let mut rest = canvases;
    while let [recto, after @ ..] = rest {
        let own = face(recto);
        let verso = after.first().filter(|next| {
            let (own, next) = (&own, face(next));
            own.as_ref().zip(next.as_ref()).is_some_and(|(own, next)| {
                own.1 == SideName::Recto && next.1 == SideName::Verso && own.0 == next.0
            })
        });
        if verso.is_none() && own.as_ref().is_some_and(|own| own.1 == SideName::Verso) {
            let found = "a verso without its recto before it";
            let remedy = "it is taken for the recto of a sheet of its own";
            faulty.warning(&recto.path, Words::new(found, "", remedy));
        }
        let title = match verso {
            Some(_) => recto.label.each(|text| without_side(text).0.to_owned()),
            None => recto.label.clone(),
        };
        sheets.push(Sheet {
            id: ids.free(&name(recto, verso.is_some(), sheets.len())),
            title,
            recto,
            verso,
        });
        rest = &after[usize::from(verso.is_some())..];
    }
    sheets
}

/// The last two parts of a canvas's id.
fn last_parts<'c>(canvas: &'c Canvas<'_>) -> [&'c str; 2] {
    let mut parts = canvas.id.trim_end_matches('/').rsplit('/');
    let last = parts.next().unwrap_or_default();
    [parts.next().unwrap_or_default(), last]
}

/// Which side a canvas is, and the name that it has in common with the other one: by its id, or by
/// its label.
fn face(canvas: &Canvas<'_>) -> Option<(String, SideName)> {
    let [before, last] = last_parts(canvas);
    let by_id = match last.to_lowercase().as_str() {
        "recto" => Some(SideName::Recto),
        "verso" => Some(SideName::Verso),
        _ => None,
    };
    if let Some(side) = by_id {
        return Some((before.to_owned(), side));
    }
    let (name, side) = without_side(canvas.label.any()?);
    Some((name.to_owned(), side?))
}

/// A label without what says its side: `Study, recto`, `Study (verso)`, `f. 12r`.
fn without_side(label: &str) -> (&str, Option<SideName>) {
    let text = label.trim().trim_end_matches(['.', ')']);
    let split = |word: &str| {
        let at = text.len().checked_sub(word.len())?;
        let (before, last) = text.split_at_checked(at)?;
        let is_word = before.ends_with(|c: char| !c.is_alphanumeric()) || before.is_empty();
        (last.eq_ignore_ascii_case(word) && is_word)
            .then(|| before.trim_end_matches(|c: char| !c.is_alphanumeric() && c != ']'))
    };
    for (word, side) in [("recto", SideName::Recto), ("verso", SideName::Verso)] {
        if let Some(name) = split(word) {
            return (name, Some(side));
        }
    }
    for (letter, side) in [('r', SideName::Recto), ('v', SideName::Verso)] {
        if let Some(number) = text.strip_suffix(letter)
            && number.ends_with(|c: char| c.is_ascii_digit())
        {
            return (number, Some(side));
        }
    }
    (label.trim(), None)
}

/// An id for a drawing.
fn name(canvas: &Canvas<'_>, has_sides: bool, before: usize) -> String {
    let [drawing, last] = last_parts(canvas);
    let by_id = matches!(last, "recto" | "verso").then_some(drawing);
    let by_id = by_id.filter(|id| Id::from_text(id).is_some());
    let label = canvas.label.any().unwrap_or_default();
    let label = if has_sides {
        without_side(label).0
    } else {
        label
    };
    by_id
        .map(str::to_owned)
        .or_else(|| slug(label))
        .unwrap_or_else(|| format!("sheet-{}", before + 1))
}

/// A plain short name of a label; `None` where no letter of it is one.
fn slug(label: &str) -> Option<String> {
    const LONGEST: usize = 40;
    let mut slug = String::new();
    for c in label.chars() {
        if c.is_ascii_alphanumeric() {
            slug.push(c.to_ascii_lowercase());
        } else if !slug.is_empty() && !slug.ends_with('-') {
            slug.push('-');
        }
        if slug.len() == LONGEST {
            break;
        }
    }
    let slug = slug.trim_end_matches('-');
    (!slug.is_empty()).then(|| slug.to_owned())
}

/// What a further picture of a canvas shows, by its path or else by its label; different from what
/// the `others` of its side show, and by another name than what the recto has where it is of a
/// verso: overlays and stacks are of one side, and their ids of a sheet.
pub fn role(path: &str, label: &Texts, others: &[Role], recto: &[Role]) -> Role {
    let is_new = |role: &Role| !others.contains(role);
    let apart = |role: Role| match role {
        Role::Overlay(id) => Role::Overlay(behind(&id, |id| {
            recto
                .iter()
                .any(|role| matches!(role, Role::Overlay(own) if own == id))
        })),
        Role::Band(stack, nm) => {
            let is_taken = |id: &str| {
                recto
                    .iter()
                    .any(|role| matches!(role, Role::Band(own, _) if own == id))
            };
            Role::Band(behind(&stack, is_taken), nm)
        }
        role => role,
    };
    let plain = |role: Role| match role {
        Role::Albedo => None,
        Role::State(id) => Id::from_text(&id).map(|_| Role::State(id)),
        Role::Overlay(id) => Id::from_text(&id).map(|_| Role::Overlay(id)),
        Role::Band(stack, nm) => {
            let nm = Id::from_text(&stack).and_then(|_| band(&nm))?;
            Some(Role::Band(stack, nm))
        }
    };
    let by_path = Role::of(path).and_then(plain);
    let by_label = label.any().and_then(|label| {
        let nm = wavelength(label)?;
        Some(Role::Band("bands".to_owned(), nm))
    });
    if let Some(role) = by_path.or(by_label).map(apart).filter(|role| is_new(role)) {
        return role;
    }
    let named = label.any().and_then(slug).map(Role::Overlay);
    let numbered = (others.len()..).map(|i| Role::Overlay(format!("picture-{i}")));
    let mut offered = named.into_iter().chain(numbered).map(apart);
    // There are more numbers than pictures.
    offered.find(is_new).unwrap_or(Role::Albedo)
}

/// An id of the verso that the recto does not take.
fn behind(id: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(id) {
        return id.to_owned();
    }
    let numbered = (2..).map(|number| format!("-verso-{number}"));
    let tails = std::iter::once("-verso".to_owned()).chain(numbered);
    let mut ids = tails.map(|tail| with_tail(id, &tail));
    // The recto has not all of them.
    ids.find(|id| !is_taken(id)).unwrap_or_default()
}

/// A wavelength that a band may have, as it is written shortest.
fn band(nm: &str) -> Option<String> {
    let number = BandKey::from_text(nm).and_then(|_| nm.parse::<f64>().ok());
    let number = number.filter(|nm| (100.0..=20000.0).contains(nm));
    number.map(|nm| nm.to_string())
}

/// The wavelength in a label such as `Infrared, 940 nm`.
fn wavelength(label: &str) -> Option<String> {
    let at = label.find("nm")?;
    let before = label[..at].trim_end();
    let start = before
        .rfind(|c: char| !c.is_ascii_digit() && c != '.')
        .map_or(0, |i| {
            i + before[i..].chars().next().map_or(1, char::len_utf8)
        });
    let nm = before[start..].trim_matches('.');
    band(nm)
}

impl<'c, 'j> Sheet<'c, 'j> {
    /// Its sides that have a canvas.
    pub fn sides(&self) -> impl Iterator<Item = (SideName, &'c Canvas<'j>)> {
        let verso = self.verso.map(|canvas| (SideName::Verso, canvas));
        [(SideName::Recto, self.recto)].into_iter().chain(verso)
    }

    /// Width and height in mm: as is known, as metadata says where it fits the canvas's shape, as
    /// the physical dimensions say, as the picture says, or assumed.
    pub fn size_mm(&self, known: &Known, header: &Header, faulty: &mut Faulty<'_>) -> [f64; 2] {
        if let Some(size_mm) = known.size_mm {
            return size_mm;
        }
        let canvas = self.recto;
        let rounded = |mm: f64| (mm * 100.0).round() / 100.0;
        let by_scale = canvas
            .mm_per_px
            .map(|mm| canvas.size.map(|px| rounded(px * mm)));
        let written = canvas
            .about
            .dimensions
            .as_deref()
            .and_then(|text| measured(text, canvas.size));
        // Written sizes may be of the frame.
        let agree = |one: [f64; 2], other: [f64; 2]| (one[0] / other[0] - 1.0).abs() < SAME_SHAPE;
        let written = written.filter(|written| by_scale.is_none_or(|scale| agree(*written, scale)));
        let dpi = header
            .dpi
            .filter(|dpi| dpi[0] >= LEAST_DPI && dpi[1] >= LEAST_DPI);
        let by_picture =
            dpi.map(|dpi| [0, 1].map(|i| rounded(f64::from(header.size[i]) / dpi[i] * 25.4)));
        let possible = |size: &[f64; 2]| size.iter().all(|mm| (1.0..=5000.0).contains(mm));
        let said = [written, by_scale, by_picture];
        if let Some(size) = said.into_iter().flatten().find(possible) {
            return size;
        }
        let most = 5000.0 / f64::from(header.size[0].max(header.size[1]));
        let scale = ASSUMED_MM_PER_PX.min(most);
        let assumed = header
            .size
            .map(|px| rounded(f64::from(px) * scale).max(1.0));
        let found = "nothing about how large the sheet is";
        let remedy = format!(
            "{} × {} mm are assumed; give --size-mm, or correct size_mm in the manifest",
            assumed[0], assumed[1]
        );
        faulty.warning(&canvas.path, Words::new(found, "", remedy));
        assumed
    }
}

/// Width and height in mm of `285 × 194 mm` or `28.5 x 19.4 cm`, in whichever order fits the shape
/// of the canvas: museums write the height first.
fn measured(text: &str, canvas: [f64; 2]) -> Option<[f64; 2]> {
    let text = text.to_lowercase().replace(',', ".");
    let unit = if text.contains("mm") {
        1.0
    } else if text.contains("cm") {
        10.0
    } else {
        return None;
    };
    let numbers = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    let numbers: Vec<f64> = numbers
        .filter_map(|number| number.trim_matches('.').parse().ok())
        .collect();
    let [a, b] = numbers[..] else { return None };
    let fits = |size: &[f64; 2]| {
        let ratio = (size[0] / size[1]) / (canvas[0] / canvas[1]);
        (ratio - 1.0).abs() < SAME_SHAPE
    };
    let mm = [a * unit, b * unit];
    [mm, [mm[1], mm[0]]].into_iter().find(fits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_say_sides_wavelengths_and_sizes() {
        let side = |text| without_side(text);
        assert_eq!(side("Study, recto"), ("Study", Some(SideName::Recto)));
        assert_eq!(side("Study (Verso)"), ("Study", Some(SideName::Verso)));
        assert_eq!(side("f. 12r"), ("f. 12", Some(SideName::Recto)));
        assert_eq!(side("12v."), ("12", Some(SideName::Verso)));
        assert_eq!(side("Tiger"), ("Tiger", None));
        assert_eq!(side("Conversoverso"), ("Conversoverso", None));
        assert_eq!(side("recto"), ("", Some(SideName::Recto)));
        assert_eq!(side("夢v"), ("夢v", None));
        assert_eq!(wavelength("Infrared, 940 nm").as_deref(), Some("940"));
        assert_eq!(wavelength("é365.5nm").as_deref(), Some("365.5"));
        assert_eq!(wavelength("nm"), None);
        assert_eq!(wavelength("5 nm"), None);
        assert_eq!(
            measured("194 x 285 mm", [2850.0, 1940.0]),
            Some([285.0, 194.0])
        );
        assert_eq!(
            measured("28,5 × 19,4 cm", [285.0, 194.0]),
            Some([285.0, 194.0])
        );
        assert_eq!(measured("50 × 50 cm", [285.0, 194.0]), None);
        assert_eq!(measured("about a foot", [1.0, 1.0]), None);
        assert_eq!(slug("Öl & Wasser, 2").as_deref(), Some("l-wasser-2"));
        assert_eq!(slug("夢"), None);
    }

    #[test]
    fn ids_differ() {
        let mut ids = Ids::default();
        let free: Vec<String> = ["sheet-2", "a", "sheet-2", "sheet-2-2", "sheet-2", "a"]
            .map(|wanted| ids.free(wanted))
            .to_vec();
        let expected = [
            "sheet-2",
            "a",
            "sheet-2-2",
            "sheet-2-2-2",
            "sheet-2-3",
            "a-2",
        ];
        assert_eq!(free, expected);
        let long = "x".repeat(64);
        for _ in 0..20 {
            assert!(Id::from_text(&ids.free(&long)).is_some());
        }
        let recto = [
            Role::Overlay(long.clone()),
            Role::Overlay("infrared".to_owned()),
            Role::Overlay("infrared-verso".to_owned()),
            Role::Band("bands".to_owned(), "940".to_owned()),
        ];
        let of = |path: &str| role(path, &Texts::default(), &[], &recto);
        assert_eq!(
            of("overlay/infrared.png"),
            Role::Overlay("infrared-verso-2".to_owned())
        );
        // Another wavelength of it would be of its own side.
        assert_eq!(
            of("band/bands/550.png"),
            Role::Band("bands-verso".to_owned(), "550".to_owned())
        );
        assert_eq!(of("state/bands.png"), Role::State("bands".to_owned()));
        let Role::Overlay(cut) = of(&format!("overlay/{long}.png")) else {
            panic!("no overlay");
        };
        assert!(cut.ends_with("-verso") && Id::from_text(&cut).is_some());
    }
}
