//! The choice of a tier where nothing was tuned: scenes drawn by seed, rendered in every tier and
//! held against the judge.
//!
//! What the judge finds stands in `held_out/judged.csv`; it is walked anew, in minutes, by
//! `cargo test --release --test held_out -- --ignored bake`.

#[path = "held_out/scenes.rs"]
mod scenes;

use std::sync::Arc;

use glam::DVec3;
use recto::{
    colour::delta_e00,
    manifest::Exhibit,
    needs::Needs,
    optics::tier::Tier,
    shot::Darkroom,
    stage::Shown,
    tradeoff::{
        choice::{self, Costs},
        errors::displayed,
        places::Maps,
        scene::{Forecast, Sampled},
    },
};
use scenes::{Draw, Judged, draws, targets};

/// Walks for each eye: half a per cent of noise.
const WALKS: u64 = 1 << 15;
/// A prediction is good within this factor.
const FACTOR: f64 = 2.0;
/// Below this ΔE00 both are the walk's noise: a factor says nothing there.
const NOISE: f64 = 0.3;
/// In so many of all scenes and tiers it is to be good, and the chosen tier is to keep its bound.
const SHARE: f64 = 0.95;
/// Bounds that curators may set.
const BOUNDS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

#[test]
#[ignore = "writes the judge's findings: minutes of random walks"]
fn bake() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/held_out/judged.csv");
    std::fs::write(path, scenes::bake(WALKS)).expect("the findings are written");
}

/// Tiers whose predictions are held against what is measured: the ladder, and a baseline.
const JUDGED: [Tier; 4] = [Tier::Lambert, Tier::Draft, Tier::Gallery, Tier::Study];

/// A scene as it was predicted, and mean ΔE00 of each tier's frame from the judge.
struct Outcome {
    name: String,
    forecasts: Vec<Forecast>,
    measured: Vec<(Tier, f64)>,
    costs: Costs,
}

impl Outcome {
    fn measured(&self, tier: Tier) -> f64 {
        let mut all = self.measured.iter();
        all.find(|(of, _)| *of == tier).expect("measured").1
    }

    fn predicted(&self, tier: Tier) -> f64 {
        let mut all = self.forecasts.iter();
        all.find(|of| of.tier == tier)
            .expect("predicted")
            .errors
            .mean
    }

    fn new(room: &mut Darkroom, judged: &Judged, draw: &Draw) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        draw.write(folder.path(), &judged.photographs(draw));
        let (exhibit, _) = Exhibit::read(folder.path()).unwrap_or_else(|faults| panic!("{faults}"));
        let exhibit = Arc::new(exhibit);
        let scene = &exhibit.scenes[0];
        let targets = targets(&exhibit, scene);
        let measured = JUDGED
            .into_iter()
            .map(|tier| {
                let aspect = f64::from(scenes::SIZE[0]) / f64::from(scenes::SIZE[1]);
                let shown = Shown::at_rest(exhibit.clone(), scene.clone(), tier, aspect);
                let picture = room
                    .take(shown, scenes::SIZE)
                    .unwrap_or_else(|error| panic!("{}: {error}", draw.name));
                let off: f64 = targets
                    .iter()
                    .map(|target| {
                        let [x, y] = target.pixel;
                        let shown = picture.pixels[(y * picture.width + x) as usize];
                        let shown = DVec3::from(shown.map(f64::from));
                        let truth = judged.seen(draw, target.field).mean;
                        delta_e00(displayed(shown), displayed(truth))
                    })
                    .sum();
                (tier, off / targets.len() as f64)
            })
            .collect();
        let mut maps = Maps::default();
        let sampled = Sampled::new(&exhibit, scene, scenes::SIZE, &mut maps)
            .unwrap_or_else(|fault| panic!("{fault}"));
        let needs = Needs::of(&exhibit, scene, Tier::Study, false);
        Self {
            name: draw.name.clone(),
            forecasts: sampled.forecasts(&Tier::ALL),
            measured,
            costs: Costs::shipped(&needs.sides[0].terms),
        }
    }
}

/// Share of `pairs` that are within [`FACTOR`] of each other.
fn within(pairs: &[(f64, f64)]) -> f64 {
    let good = |(predicted, measured): &&(f64, f64)| {
        let ratio = predicted.max(NOISE) / measured.max(NOISE);
        (1.0 / FACTOR..=FACTOR).contains(&ratio)
    };
    pairs.iter().filter(good).count() as f64 / pairs.len() as f64
}

/// Share of scenes and bounds in which the tier that is chosen keeps the bound, of those in which
/// one is said to; and how many those are.
fn kept(outcomes: &[Outcome], choose: impl Fn(&Outcome, f64) -> (Tier, bool)) -> (f64, usize) {
    let (mut promised, mut kept) = (0, 0);
    for outcome in outcomes {
        for bound in BOUNDS {
            let (tier, keeps) = choose(outcome, bound);
            if keeps {
                promised += 1;
                if outcome.measured(tier) <= bound {
                    kept += 1;
                } else {
                    let measured = outcome.measured(tier);
                    println!("{}: {tier} for {bound}: {measured:.2}", outcome.name);
                }
            }
        }
    }
    (
        f64::from(kept) / f64::from(promised.max(1)),
        promised as usize,
    )
}

#[test]
fn predictions_hold_and_the_chosen_tier_keeps_its_bound() {
    let judged = Judged::read();
    let mut room = Darkroom::new(1).unwrap_or_else(|error| panic!("{error}"));
    let outcomes: Vec<Outcome> = draws()
        .iter()
        .map(|draw| Outcome::new(&mut room, &judged, draw))
        .collect();
    for outcome in &outcomes {
        let cells: Vec<String> = JUDGED
            .into_iter()
            .map(|tier| {
                let (p, m) = (outcome.predicted(tier), outcome.measured(tier));
                format!("{tier} {p:.2}/{m:.2}")
            })
            .collect();
        println!("{:16} {}", outcome.name, cells.join("  "));
    }
    let pairs: Vec<(f64, f64)> = outcomes
        .iter()
        .flat_map(|outcome| JUDGED.map(|tier| (outcome.predicted(tier), outcome.measured(tier))))
        .collect();
    let share = within(&pairs);
    println!(
        "within a factor of {FACTOR}: {:.1}% of {}",
        share * 100.0,
        pairs.len()
    );
    assert!(share >= SHARE, "{share}");

    let choose =
        |outcome: &Outcome, bound| choice::at_rest(&outcome.forecasts, &outcome.costs, bound);
    let (share, promised) = kept(&outcomes, choose);
    println!("bounds kept: {:.1}% of {promised}", share * 100.0);
    assert!(
        promised >= outcomes.len(),
        "most bounds are promised by no tier: {promised}"
    );
    assert!(share >= SHARE, "{share}");

    // Predictions of other scenes fail both, and so does always taking the cheapest tier.
    let other: Vec<(f64, f64)> = (0..pairs.len())
        .map(|i| (pairs[(i + 4 * 7) % pairs.len()].0, pairs[i].1))
        .collect();
    assert!(within(&other) < SHARE);
    let tripled: Vec<(f64, f64)> = pairs.iter().map(|(p, m)| (3.0 * p, *m)).collect();
    assert!(within(&tripled) < SHARE);
    assert!(kept(&outcomes, |_, _| (Tier::Lambert, true)).0 < SHARE);
}
