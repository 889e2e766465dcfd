//! The price of accuracy: judged, priced and predicted.

use std::fs;

use recto::tradeoff::judged;

/// Walks for each eye; the walk's noise in the table is then below .1 ΔE00 nearly everywhere.
const WALKS: u64 = 1 << 17;

#[test]
#[ignore = "writes the judge's findings: minutes of random walks"]
fn bake() {
    let samples = std::env::var("RECTO_WALKS").ok().and_then(|n| n.parse().ok());
    let text = judged::bake(samples.unwrap_or(WALKS));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/tradeoff/judged.csv");
    fs::write(path, text).expect("the findings are written");
}

#[test]
fn print() {
    use recto::{optics::tier::Tier, tradeoff::{errors, subject::SUBJECTS}};
    for subject in &SUBJECTS {
        println!("{} noise {:.3?}", subject.name, errors::noise(subject));
        for tier in Tier::ALL {
            let e = errors::of(subject, tier);
            println!("  {tier:20} {:.3} {:.2} {:.2} {:.2}", e.rms, e.mean, e.p95, e.max);
        }
    }
}

#[test]
fn plot_it() {
    use recto::{optics::tier::Tier, tradeoff::{plot, table::{Cost, Table}}};
    let mut table = Table::of_subjects();
    for row in &mut table.rows {
        if let Some(tier) = row.tier {
            let i = Tier::ALL.iter().position(|t| *t == tier).unwrap();
            let ratio = [1.1, 1.5, 2.6, 1.4, 1.02, 1.2, 1.25, 1.3, 1.06, 1.2, 1.24, 1.33, 1.31][i];
            row.cost = Some(Cost { ratio, ns: 18.0 * ratio });
        }
    }
    let face = fs::read("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf").unwrap();
    let pixels = plot::pixels(&table, face).unwrap();
    recto::maps::encode::save_png_rgb8(std::path::Path::new("/tmp/plot.png"), plot::SIZE[0], plot::SIZE[1], &pixels, None).unwrap();
}
