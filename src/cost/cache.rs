//! What the tiers cost on this machine, measured once and kept.

use std::{fs, path::PathBuf};

use super::{
    CompileError, Composer, CostError, Sheets, SheetsError, Stopwatch, instructions, least,
};
use crate::{
    device,
    maps::encode,
    needs::Needs,
    optics::tier::Tier,
    tradeoff::{
        choice::LADDER,
        errors::Errors,
        subject::{SUBJECTS, Subject},
        table::{Cost, Row, Table},
    },
};

/// How thoroughly costs are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Size of the pictures in pixels.
    size: [u32; 2],
    /// How often each tier has its turn, so that a machine that slows down slows all of them.
    rounds: usize,
}

impl Effort {
    /// For a table.
    pub const THOROUGH: Self = Self {
        size: [512, 512],
        rounds: 3,
    };
    /// While somebody waits for something else.
    pub const QUICK: Self = Self {
        size: [256, 256],
        rounds: 2,
    };
}

/// Kinds of work, as [`Sheets`] draws them.
const WORKS: [&str; 4] = ["paper", "particles", "table", "relief"];

/// Why costs are not known.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    #[error(transparent)]
    Sheets(#[from] SheetsError),
    #[error(transparent)]
    Cost(#[from] CostError),
    #[error(transparent)]
    Compile(#[from] CompileError),
}

/// Fills in what the tiers of `table` cost on this machine, and how long their shaders are;
/// `step` is told of each of [`STEPS`] parts.
///
/// # Errors
/// [`MeasureError`] without a graphics device.
pub fn measure(
    table: &mut Table,
    effort: Effort,
    mut step: impl FnMut(&str),
) -> Result<(), MeasureError> {
    let sheets = Sheets::draw()?;
    let mut watch = Stopwatch::new(effort.size)?;
    let mut composer = Composer::new("");
    table.device = device_name();
    for work in WORKS {
        step(work);
        let rows: Vec<usize> = (0..table.rows.len())
            .filter(|&i| {
                let row = &table.rows[i];
                Subject::named(&row.subject).is_some_and(|subject| subject.work() == work)
            })
            .collect();
        let tiers: Vec<Tier> = Tier::ALL
            .into_iter()
            .filter(|tier| rows.iter().any(|&i| table.rows[i].tier == Some(*tier)))
            .collect();
        let costs = costs(&sheets, &mut watch, work, &tiers, effort)?;
        for (tier, cost) in costs {
            let Some(shown) = sheets.shown(work, tier) else {
                continue;
            };
            let needs = Needs::of(&shown.exhibit, &shown.scene, tier, false);
            let count = match needs.sides.first() {
                Some(side) => Some(instructions(&mut composer, &side.terms)?),
                None => None,
            };
            for &i in &rows {
                let row = &mut table.rows[i];
                if row.tier == Some(tier) {
                    row.cost = Some(cost);
                    row.instructions = count;
                }
            }
        }
    }
    Ok(())
}

/// How many parts [`measure`] has.
pub const STEPS: u64 = WORKS.len() as u64;

fn costs(
    sheets: &Sheets,
    watch: &mut Stopwatch,
    work: &str,
    tiers: &[Tier],
    effort: Effort,
) -> Result<Vec<(Tier, Cost)>, CostError> {
    let mut floor = Vec::new();
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); tiers.len()];
    for _ in 0..effort.rounds {
        if let Some(shown) = sheets.shown(work, Tier::Lambert) {
            floor.extend(watch.time_floor(shown)?);
        }
        for (tier, times) in tiers.iter().zip(&mut times) {
            if let Some(shown) = sheets.shown(work, *tier) {
                times.extend(watch.time(shown)?);
            }
        }
    }
    let floor = least(&floor);
    let pixels = f64::from(effort.size[0]) * f64::from(effort.size[1]);
    let costs = tiers.iter().zip(&times).map(|(tier, times)| {
        let ms = least(times);
        let cost = Cost {
            ratio: ms / floor.max(f64::MIN_POSITIVE),
            ns: ms * 1e6 / pixels,
        };
        (*tier, cost)
    });
    Ok(costs.collect())
}

/// The graphics device in words that name it; commas would part cells.
pub fn device_name() -> String {
    device::adapter().map_or_else(
        |_| "no device".to_owned(),
        |adapter| {
            let info = adapter.get_info();
            format!("{} ({} {})", info.name, info.driver, info.driver_info)
                .replace([',', '\n'], ";")
        },
    )
}

/// A table with a row for each tier that may be chosen and each kind of work, whose errors mean
/// nothing.
fn unpriced() -> Table {
    let rows = WORKS.into_iter().flat_map(|work| {
        let subject = SUBJECTS.iter().find(|subject| subject.work() == work);
        subject.into_iter().flat_map(|subject| {
            LADDER
                .into_iter()
                .map(|tier| Row::new(subject.name, Some(tier), Errors::default()))
        })
    });
    Table {
        device: String::new(),
        rows: rows.collect(),
    }
}

/// What was measured on this machine before, if it was, with this version and this device.
pub fn known() -> Option<Table> {
    let path = path(&device_name())?;
    Table::read(&fs::read_to_string(path).ok()?).ok()
}

/// What was measured before, or now; kept for the next time where a cache folder can be written.
///
/// # Errors
/// [`MeasureError`] without a graphics device.
pub fn measured(step: impl FnMut(&str)) -> Result<Table, MeasureError> {
    if let Some(known) = known() {
        return Ok(known);
    }
    let mut table = unpriced();
    measure(&mut table, Effort::QUICK, step)?;
    keep(&table);
    Ok(table)
}

/// Keeps costs for the next time. A cache that cannot be written is none.
pub fn keep(table: &Table) {
    let Some(path) = path(&table.device) else {
        return;
    };
    let Some(folder) = path.parent() else {
        return;
    };
    if fs::create_dir_all(folder).is_ok() {
        use std::io::Write;
        let _ = encode::write_whole(&path, |file| write!(file, "{table}"));
    }
}

/// Where the program keeps what it can make again: `$XDG_CACHE_HOME/recto`.
pub fn cache_folder() -> Option<PathBuf> {
    let absolute = |name| {
        std::env::var_os(name)
            .map(PathBuf::from)
            .filter(|p| p.is_absolute())
    };
    let cache = absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")))?;
    Some(cache.join("recto"))
}

/// `costs-VERSION-DEVICE.csv` in it.
fn path(device: &str) -> Option<PathBuf> {
    let cache = cache_folder()?;
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let device: String = device.chars().map(plain).collect();
    let version = env!("CARGO_PKG_VERSION");
    Some(cache.join(format!("costs-{version}-{device}.csv")))
}
