//! `recto probe`

use std::{fmt::Write as _, io::Write as _, path::PathBuf};

use glam::DVec2;
use serde::Serialize;

use super::{Failure, options, output};
use crate::{
    colour,
    manifest::{
        Exhibit, Faults, SideName, Wording, did_you_mean,
        exhibit::{Drawing, Overlay, Stack},
        quoted_list,
        readout::{CurvePoint, ReadFault, Reading},
    },
    maps::{Rasters, encode},
};

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    /// The place, in mm from the left and top edges of the side
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    at: DVec2,
    /// The drawing; without it, the first
    #[arg(long, value_name = "ID")]
    drawing: Option<String>,
    /// The side
    #[arg(long, value_name = "SIDE", default_value = "recto", value_parser = options::side())]
    side: SideName,
    /// One stack of bands alone, and no overlays
    #[arg(long, value_name = "ID")]
    stack: Option<String>,
    /// Write the curves of reflectance into this file: stack, wavelength in nm, reflectance
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// The language of titles and labels, by its BCP 47 tag
    #[arg(long, value_name = "TAG")]
    language: Option<String>,
    /// Say all of it as JSON
    #[arg(long)]
    json: bool,
}

/// What lies at one place.
#[derive(Serialize)]
struct Probe {
    drawing: String,
    side: SideName,
    at_mm: [f64; 2],
    overlays: Vec<OverlayReport>,
    stacks: Vec<StackReport>,
}

/// What an overlay says there.
#[derive(Serialize)]
struct OverlayReport {
    id: String,
    title: String,
    #[serde(flatten)]
    says: Says,
    #[serde(skip)]
    words: String,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
enum Says {
    Nothing,
    Category {
        id: Option<String>,
        label: String,
        colour: String,
    },
    Quantity {
        value: f64,
        unit: String,
    },
    /// Of another picture, and of a false colour, which is no colour of the sheet.
    Colour {
        linear_srgb: [f64; 3],
        lab: Option<[f64; 3]>,
    },
    /// Of reflectance.
    Difference {
        value: f64,
    },
}

/// The curve of a stack there.
#[derive(Serialize)]
struct StackReport {
    id: String,
    title: String,
    curve: Vec<CurvePoint>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let exhibit = super::read(&arguments.exhibit)?;
    if let Some(file) = &arguments.csv {
        options::csv(file)?;
        output::can_write_file(file, &exhibit)?;
    }
    let drawing = named(
        "--drawing",
        arguments.drawing.as_deref(),
        &exhibit.drawings,
        |drawing| &drawing.id,
    )?
    .unwrap_or(&exhibit.drawings[0]);
    let side = arguments.side;
    let size = drawing.size_mm;
    let at = arguments.at;
    if at.cmplt(DVec2::ZERO).any() || at.cmpgt(size).any() {
        return Err(input(format!(
            "--at {},{}: found a place beside the sheet; allowed: 0 to {} mm and 0 to {} mm, from \
             the left and top edges of the {}",
            at.x,
            at.y,
            size.x,
            size.y,
            side.word()
        )));
    }
    let stack = named(
        "--stack",
        arguments.stack.as_deref(),
        &drawing.stacks,
        |stack| &stack.id,
    )?;
    if let Some(stack) = stack.filter(|stack| stack.side != side) {
        let word = stack.side.word();
        return Err(input(format!(
            "--stack {}: a stack of the {word}; add --side {word}",
            stack.id
        )));
    }
    let stacks: Vec<&Stack> = match stack {
        Some(stack) => vec![stack],
        None => drawing.stacks.iter().filter(|s| s.side == side).collect(),
    };
    if arguments.csv.is_some() && stacks.is_empty() {
        return Err(input(format!(
            "--csv: there is no stack of bands on the {} whose curve could be written",
            side.word()
        )));
    }
    let mut rasters = Rasters::default();
    let fault = |fault: ReadFault| Faults::from(exhibit.map_fault(&fault.path, &fault.error));
    let say = |wording: &Wording| {
        let first = exhibit.languages.first().map_or("en", String::as_str);
        let language = arguments.language.as_deref().unwrap_or(first);
        let text = exhibit.text(wording, language);
        text.unwrap_or_default().to_owned()
    };
    let overlays = match stack {
        Some(_) => Vec::new(),
        None => drawing.readings(&mut rasters, side, at).map_err(fault)?,
    };
    let report = |(overlay, reading): (&Overlay, Option<Reading<'_>>)| OverlayReport {
        id: overlay.id.clone(),
        title: say(&overlay.title),
        words: reading
            .as_ref()
            .map_or_else(|| "nothing".to_owned(), |reading| reading.words(say)),
        says: Says::of(reading, &say),
    };
    let probe = Probe {
        drawing: drawing.id.clone(),
        side,
        at_mm: at.into(),
        overlays: overlays.into_iter().map(report).collect(),
        stacks: stacks
            .into_iter()
            .map(|stack| {
                Ok(StackReport {
                    id: stack.id.clone(),
                    title: say(&stack.title),
                    curve: stack.curve(&mut rasters, at).map_err(fault)?,
                })
            })
            .collect::<Result<_, Faults>>()?,
    };
    if let Some(file) = &arguments.csv {
        let table = probe.table();
        encode::write_whole(file, |out| out.write_all(table.as_bytes()))?;
    }
    if arguments.json {
        let text = serde_json::to_string_pretty(&probe)
            .map_err(|error| Failure::Input(Box::new(error)))?;
        return output::result(text);
    }
    output::result(probe.words(&exhibit, drawing))
}

impl Says {
    fn of(reading: Option<Reading<'_>>, say: &impl Fn(&Wording) -> String) -> Self {
        match reading {
            None => Self::Nothing,
            Some(Reading::Category(entry)) => {
                let [r, g, b] = entry.colour;
                Self::Category {
                    id: entry.id.clone(),
                    label: say(&entry.label),
                    colour: format!("#{r:02x}{g:02x}{b:02x}"),
                }
            }
            Some(Reading::Quantity { value, unit }) => Self::Quantity {
                value,
                unit: unit.to_owned(),
            },
            Some(Reading::Colour(linear_srgb)) => Self::Colour {
                linear_srgb,
                lab: Some(colour::lab_from_linear(linear_srgb)),
            },
            Some(Reading::FalseColour(linear_srgb)) => Self::Colour {
                linear_srgb,
                lab: None,
            },
            Some(Reading::Difference(value)) => Self::Difference { value },
        }
    }
}

impl Probe {
    fn words(&self, exhibit: &Exhibit, drawing: &Drawing) -> String {
        let mut words = format!(
            "{}: {}, {}, {} mm from the left and {} mm from the top",
            exhibit.manifest.display(),
            drawing.id,
            self.side.word(),
            self.at_mm[0],
            self.at_mm[1]
        );
        let titled = |id: &str, title: &str| match title {
            "" => id.to_owned(),
            title => format!("{id} ({title})"),
        };
        let mut line = |text: String| {
            // Writing into a text cannot fail.
            let _ = write!(words, "\n{text}");
        };
        for overlay in &self.overlays {
            let name = titled(&overlay.id, &overlay.title);
            line(format!("  {name}: {}", overlay.words));
        }
        for stack in &self.stacks {
            line(format!("  {}:", titled(&stack.id, &stack.title)));
            for point in &stack.curve {
                let nm = point.wavelength_nm;
                line(match point.reflectance {
                    Some(reflectance) => format!("    {nm:>7} nm  {reflectance:.4}"),
                    None => format!("    {nm:>7} nm  nothing"),
                });
            }
        }
        if self.overlays.is_empty() && self.stacks.is_empty() {
            line("  no overlays and no stacks on this side".to_owned());
        }
        words
    }

    /// Curves as CSV; a band that shows nothing there has no value.
    fn table(&self) -> String {
        let mut table = "stack,wavelength_nm,reflectance\n".to_owned();
        for stack in &self.stacks {
            for point in &stack.curve {
                let value = point
                    .reflectance
                    .map_or(String::new(), |r| format!("{r:.6}"));
                let _ = writeln!(table, "{},{},{value}", stack.id, point.wavelength_nm);
            }
        }
        table
    }
}

fn named<'e, T>(
    option: &str,
    id: Option<&str>,
    all: &'e [T],
    id_of: impl Fn(&T) -> &String,
) -> Result<Option<&'e T>, Failure> {
    let Some(id) = id else { return Ok(None) };
    if let Some(found) = all.iter().find(|one| id_of(one) == id) {
        return Ok(Some(found));
    }
    let ids = || all.iter().map(|one| id_of(one).as_str());
    if all.is_empty() {
        return Err(input(format!("{option} {id}: there is none; leave it out")));
    }
    Err(input(format!(
        "{option} {id}: allowed: {}; {}",
        quoted_list(ids()),
        did_you_mean(id, ids(), "write one of these")
    )))
}

fn input(words: String) -> Failure {
    Failure::Input(words.into())
}

fn place(text: &str) -> Result<DVec2, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|v| v.is_finite()))
        .collect::<Option<_>>()
        .unwrap_or_default();
    match numbers[..] {
        [x, y] => Ok(DVec2::new(x, y)),
        _ => Err("write two numbers in mm, such as 92.5,60".to_owned()),
    }
}
