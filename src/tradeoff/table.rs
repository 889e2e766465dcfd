//! The table of errors and costs, as CSV; the one that is part of the program was written by
//! `recto tradeoff --out docs/tradeoff`.

use std::{fmt, sync::LazyLock};

use super::{
    errors::{self, Errors},
    subject::{Lit, SUBJECTS, Subject},
};
use crate::optics::tier::Tier;

const SHIPPED: &str = include_str!("../../docs/tradeoff/tradeoff.csv");
const COLUMNS: [&str; 9] = [
    "subject",
    "tier",
    "relative_rms",
    "delta_e00_mean",
    "delta_e00_p95",
    "delta_e00_max",
    "cost",
    "ns_per_pixel",
    "instructions",
];
/// The name of the row that is the judge's own.
pub const REFERENCE: &str = "reference";

/// What a tier costs on one kind of sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Time of a shaded pixel over that of the floor.
    pub ratio: f64,
    /// The same time in ns.
    pub ns: f64,
}

/// A tier on a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub subject: String,
    /// `None` is the judge: its errors are its own noise, one standard deviation.
    pub tier: Option<Tier>,
    pub errors: Errors,
    pub cost: Option<Cost>,
    /// In the compiled fragment shader, see [`crate::cost::instructions`].
    pub instructions: Option<u64>,
}

/// Rows with where their costs were measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The graphics device, in words.
    pub device: String,
    pub rows: Vec<Row>,
}

/// Why a text is no table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct TableFault {
    pub line: usize,
    pub what: String,
}

impl Table {
    /// The table that is part of the program.
    pub fn shipped() -> &'static Self {
        // A test reads it; an empty one would choose the most exact tier everywhere.
        static TABLE: LazyLock<Table> = LazyLock::new(|| Table::read(SHIPPED).unwrap_or_default());
        &TABLE
    }

    /// Errors of every tier on every listed subject, without costs.
    pub fn of_subjects() -> Self {
        let listed = SUBJECTS.iter().filter(|subject| subject.listed);
        let rows = listed.flat_map(|subject| {
            let judge = Row::new(subject.name, None, errors::noise(subject));
            let tiers = Tier::ALL
                .into_iter()
                .map(|tier| Row::new(subject.name, Some(tier), errors::of(subject, tier)));
            std::iter::once(judge).chain(tiers)
        });
        Self {
            device: String::new(),
            rows: rows.collect(),
        }
    }

    /// The row of a tier on a subject.
    pub fn row(&self, subject: &str, tier: Option<Tier>) -> Option<&Row> {
        self.rows
            .iter()
            .find(|row| row.subject == subject && row.tier == tier)
    }

    /// The subjects, each once, in their order.
    pub fn subjects(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.subject.as_str()) {
                names.push(&row.subject);
            }
        }
        names
    }

    /// Cost ratio of a tier on a kind of sheet, as `Subject::work` names it.
    pub fn cost(&self, work: &str, tier: Tier) -> Option<Cost> {
        let of_work = |row: &&Row| {
            row.tier == Some(tier)
                && Subject::named(&row.subject).is_some_and(|subject| subject.work() == work)
        };
        self.rows.iter().find(of_work).and_then(|row| row.cost)
    }

    /// Reads what [`fmt::Display`] writes.
    ///
    /// # Errors
    /// The first fault.
    pub fn read(text: &str) -> Result<Self, TableFault> {
        let mut table = Self::default();
        let mut header = false;
        for (i, line) in text.lines().enumerate() {
            let fault = |what: String| TableFault { line: i + 1, what };
            if let Some(words) = line.strip_prefix('#') {
                if let Some(device) = words.trim().strip_prefix(DEVICE) {
                    table.device = device.to_owned();
                }
                continue;
            }
            let cells: Vec<&str> = line.split(',').collect();
            if !header {
                if cells != COLUMNS {
                    return Err(fault(format!("the header is {}", COLUMNS.join(","))));
                }
                header = true;
                continue;
            }
            let [subject, tier, rms, mean, p95, max, ratio, ns, instructions] = cells[..] else {
                return Err(fault(format!(
                    "{} cells, not {}",
                    cells.len(),
                    COLUMNS.len()
                )));
            };
            let tier = if tier == REFERENCE {
                None
            } else {
                Some(tier.parse().map_err(|_| fault(format!("no tier {tier}")))?)
            };
            let number = |cell: &str| -> Result<f64, TableFault> {
                cell.parse()
                    .map_err(|_| fault(format!("{cell} is no number")))
            };
            let cost = match (ratio, ns) {
                ("", _) | (_, "") => None,
                (ratio, ns) => Some(Cost {
                    ratio: number(ratio)?,
                    ns: number(ns)?,
                }),
            };
            let instructions = match instructions {
                "" => None,
                cell => Some(
                    cell.parse()
                        .map_err(|_| fault(format!("{cell} is no count")))?,
                ),
            };
            table.rows.push(Row {
                subject: subject.into(),
                tier,
                errors: Errors {
                    rms: number(rms)?,
                    mean: number(mean)?,
                    p95: number(p95)?,
                    max: number(max)?,
                },
                cost,
                instructions,
            });
        }
        Ok(table)
    }
}

impl Row {
    /// Without costs.
    pub fn new(subject: &str, tier: Option<Tier>, errors: Errors) -> Self {
        Self {
            subject: subject.into(),
            tier,
            errors,
            cost: None,
            instructions: None,
        }
    }

    /// The tier's name, or the judge's.
    pub fn name(&self) -> &'static str {
        self.tier.map_or(REFERENCE, Tier::name)
    }
}

impl Subject {
    /// The kind of work that it makes for a device, as `cost::Sheets` draws it.
    pub fn work(&self) -> &'static str {
        match self.lit {
            Lit::Table => "table",
            Lit::Raking => "relief",
            Lit::Lamps if self.particles().is_some() => "particles",
            Lit::Lamps => "paper",
        }
    }
}

const DEVICE: &str = "costs measured on ";

/// What stands over every table.
const LEGEND: &str = "\
# Error of each tier against the reference (a random walk), and its cost.
# relative_rms: root mean square of (tier - reference)/reference, channels alike, below 2% of white
# over that; delta_e00: of what a display shows, a perfect white at full level, lamp by lamp.
# Rows named reference: its own noise, one standard deviation.
# cost: time of a shaded pixel over that of the floor, which reads the maps and is no more than
# Lambert; instructions: SPIR-V of the fragment shader by naga, functions written out in place.
";

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(LEGEND)?;
        writeln!(f, "# {DEVICE}{}", self.device)?;
        writeln!(f, "{}", COLUMNS.join(","))?;
        for row in &self.rows {
            let Errors {
                rms,
                mean,
                p95,
                max,
            } = row.errors;
            write!(
                f,
                "{},{},{rms:.5},{mean:.4},{p95:.4},{max:.4},",
                row.subject,
                row.name()
            )?;
            match row.cost {
                Some(Cost { ratio, ns }) => write!(f, "{ratio:.3},{ns:.2},")?,
                None => f.write_str(",,")?,
            }
            match row.instructions {
                Some(count) => writeln!(f, "{count}")?,
                None => writeln!(f)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_back_as_it_was_written() {
        let mut table = Table {
            device: "a device".into(),
            rows: vec![
                Row::new("wash", None, Errors::default()),
                Row::new(
                    "wash",
                    Some(Tier::Study),
                    Errors {
                        rms: 0.125,
                        mean: 0.5,
                        p95: 1.5,
                        max: 2.5,
                    },
                ),
            ],
        };
        table.rows[1].cost = Some(Cost {
            ratio: 2.5,
            ns: 31.25,
        });
        table.rows[1].instructions = Some(1234);
        assert_eq!(Table::read(&table.to_string()), Ok(table.clone()));
        let faulty = table.to_string().replace("study", "studio");
        let fault = Table::read(&faulty).expect_err("no such tier");
        assert!(fault.to_string().contains("no tier studio"), "{fault}");
        assert!(Table::read("a,b").is_err(), "no header");
        let short = table.to_string().replace(",1234", "");
        assert!(Table::read(&short).is_err(), "a cell is missing");
    }
}
