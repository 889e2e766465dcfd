//! The price of accuracy: the judge's findings, and the table that is part of the program.

use std::fs;

use recto::{
    optics::tier::Tier,
    tradeoff::{
        errors::{self, Errors},
        judged::{self, Judged},
        subject::SUBJECTS,
        table::Table,
    },
};

/// Walks for each eye: the walk's noise in the table is then .06 ΔE00 in the mean.
const WALKS: u64 = 1 << 17;
/// The judge's own noise over a display picture, mean ΔE00.
const NOISE: f64 = 0.15;
/// How far the shipped table may be from what the code gives today: ΔE00 and relative RMS, each
/// relative to itself or absolute, whichever is more. The CSV rounds to 1e-4.
const STALE: f64 = 2e-3;

#[test]
#[ignore = "writes the judge's findings: minutes of random walks"]
fn bake() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/tradeoff/judged.csv");
    fs::write(path, judged::bake(WALKS)).expect("the findings are written");
}

#[test]
fn the_judge_has_walked_every_subject_with_little_noise() {
    for subject in &SUBJECTS {
        let judged = Judged::of(subject);
        assert_eq!(
            judged.views.len(),
            subject.views().len(),
            "{}",
            subject.name
        );
        let noise = errors::noise(subject).mean;
        assert!(noise > 0.0 && noise < NOISE, "{}: {noise}", subject.name);
        // The photograph of bare paper is what the catalogue says it is.
        if subject.slab() == subject.on_whole_sheet().slab() {
            for (found, wanted) in judged.bare.mean.to_array().iter().zip(subject.bare()) {
                assert!((found - wanted).abs() < 0.01, "{}: {found}", subject.name);
            }
        }
    }
}

/// What of `table` is not what the code gives today.
fn stale(table: &Table) -> Vec<String> {
    let now = Table::of_subjects();
    let mut stale = Vec::new();
    for row in &now.rows {
        let name = format!("{} {}", row.subject, row.name());
        let Some(shipped) = table.row(&row.subject, row.tier) else {
            stale.push(format!("{name}: missing"));
            continue;
        };
        let numbers = |e: &Errors| [e.rms, e.mean, e.p95, e.max];
        for (was, is) in numbers(&shipped.errors).iter().zip(numbers(&row.errors)) {
            if (was - is).abs() > STALE * is.max(1.0) {
                stale.push(format!("{name}: {was} was shipped, {is} is found"));
            }
        }
        if row.tier.is_some() && (shipped.cost.is_none() || shipped.instructions.is_none()) {
            stale.push(format!("{name}: without cost"));
        }
    }
    if table.rows.len() != now.rows.len() {
        stale.push(format!("{} rows, not {}", table.rows.len(), now.rows.len()));
    }
    stale
}

#[test]
fn the_shipped_table_is_that_of_today() {
    let found = stale(Table::shipped());
    assert!(
        found.is_empty(),
        "the physics has changed; write the table anew with `recto tradeoff --out docs/tradeoff` \
         and build again:\n{}",
        found.join("\n")
    );
    // One number that is another is found.
    let mut changed = Table::shipped().clone();
    changed.rows[3].errors.mean += 0.05;
    assert_eq!(stale(&changed).len(), 1);
    changed.rows.pop();
    assert!(stale(&changed).len() >= 2);
}

#[test]
fn the_ladder_climbs() {
    let table = Table::of_subjects();
    let mean = |tier: Tier| {
        let rows = table.rows.iter().filter(|row| row.tier == Some(tier));
        rows.map(|row| row.errors.mean).sum::<f64>()
    };
    let ladder = [Tier::Lambert, Tier::Draft, Tier::Gallery, Tier::Study].map(mean);
    assert!(ladder.is_sorted_by(|a, b| a > b), "{ladder:?}");
}
