//! The other side's ink in reflected light, against the walk.
//!
//! Bare and inked sheets are walked by the same paths, so that their difference is free of most of
//! the noise. What the walk finds stands in `fixtures/show_through.csv`:
//! `cargo test --release --test judged -- --ignored bake_show_through`.

use super::*;
use recto::optics::show_through::shown_through;

/// OPTICS' bound for what a thin sheet lets through, here of the change where that is above
/// [`TELLING`]. Measured: .149 at most, for ink on both sides.
const CHANGE: f64 = 0.15;
/// A change of this share of the sheet's light.
const TELLING: f64 = 0.01;
/// Standard deviations of the walk.
const NOISE: f64 = 3.0;
const ALPHA: f64 = 0.4;
const TAUS: [f64; 3] = [0.2, 1.0, 4.0];
/// Of ink on the side that is seen.
const FRONTS: [f64; 2] = [0.0, HELD];
const THICKNESSES: [f64; 5] = [0.02, 0.03, 0.05, 0.1, 0.15];
/// σs and σa in mm⁻¹.
const PAPERS: [[f64; 2]; 4] = [[81.38, 0.05], [81.38, 1.0], [40.0, 0.4], [20.0, 0.05]];
/// σs′d from which on a sheet is one: thinner ones hold no diffuse light.
const SHEET: f64 = 1.0;

fn sheets() -> impl Iterator<Item = Sheet> {
    PAPERS.into_iter().flat_map(|[sigma_s, sigma_a]| {
        THICKNESSES.map(|thickness_mm| Sheet {
            name: "backed",
            sigma_s,
            thickness_mm,
            sigma_a,
        })
    })
}

fn name(what: &str, sheet: &Sheet, front: f64, tau: f64) -> String {
    let Sheet {
        sigma_s,
        sigma_a,
        thickness_mm,
        ..
    } = sheet;
    format!("{what} {sigma_s} {sigma_a} {thickness_mm} {front} {tau}")
}

/// Mean and variance of the mean.
fn estimate(values: &[f64]) -> Estimate {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    Estimate {
        mean,
        variance: squares / (n * (n - 1.0)),
    }
}

#[test]
#[ignore = "writes the fixture: minutes of random walks"]
fn bake_show_through() {
    const SEEDS: u64 = 4;
    const PATHS: u64 = 1 << 17;
    const PHOTONS: u64 = 150_000;
    let mut text = String::from("name,mean,variance\n");
    for sheet in sheets() {
        let layers = sheet.layers(ALPHA);
        let captures: Vec<Capture> = (0..SEEDS)
            .map(|seed| Capture::new(&layers, PATHS, seed))
            .collect();
        let inks: Vec<Absorption> = FRONTS
            .iter()
            .flat_map(|f| {
                [0.0]
                    .into_iter()
                    .chain(TAUS)
                    .map(|tau| sheet.inked(*f, tau))
            })
            .collect();
        let beams = [0.0f64, 60.0].map(|angle| {
            let mu = angle.to_radians().cos();
            let walk = |seed| reflectance_transmittance(&layers, &inks, mu, PHOTONS, seed);
            (angle, (0..SEEDS).map(walk).collect::<Vec<_>>())
        });
        let mut row = |name: String, values: Vec<f64>| {
            let e = estimate(&values);
            writeln!(text, "{name},{:.6e},{:.3e}", e.mean, e.variance).expect("a String");
        };
        for (i, front) in FRONTS.into_iter().enumerate() {
            let photograph = |tau: f64| {
                let albedo = |capture: &Capture| capture.albedo(&sheet.inked(front, tau)).mean;
                captures.iter().map(albedo).collect::<Vec<f64>>()
            };
            let bare = photograph(0.0);
            row(name("photograph", &sheet, front, 0.0), bare.clone());
            for (k, tau) in TAUS.into_iter().enumerate() {
                let inked = photograph(tau);
                let change = bare.iter().zip(&inked).map(|(a, b)| b - a).collect();
                row(name("photograph", &sheet, front, tau), change);
                for (angle, walks) in &beams {
                    let at = i * (1 + TAUS.len());
                    let change = walks
                        .iter()
                        .map(|all| all[at + 1 + k].reflected.mean - all[at].reflected.mean);
                    row(
                        name(&format!("beam {angle}"), &sheet, front, tau),
                        change.collect(),
                    );
                }
            }
        }
    }
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/fixtures/show_through.csv"
    );
    fs::write(path, text).expect("the fixture is written");
}

/// Change of the diffuse light by ink `tau` on the other side of a spot that photographs as `seen`.
fn change(side: &Side, seen: f64, tau: f64) -> f64 {
    let film = &side.study.film;
    let rho = |share: DVec3| internal_reflectance(film, share);
    let inked = side.share(side.photograph_of(tau));
    let rho_f = rho(side.share(seen));
    shown_through(
        &side.study.through,
        1.0,
        rho_f,
        rho(inked),
        rho(DVec3::ONE),
        rho(DVec3::ONE),
    )
    .x - 1.0
}

/// Found over judged, and whether the walk is sure of it.
fn compared(judge: &Judge) -> Vec<(String, [f64; 2], f64, f64)> {
    let mut found = Vec::new();
    for sheet in sheets() {
        let photograph = |front: f64| judge.get(&name("photograph", &sheet, front, 0.0)).mean;
        let side = Side::new(&sheet, ALPHA, photograph(0.0));
        let floor = capture_floor(&side.bare, &side.mean);
        for front in FRONTS {
            let seen = photograph(front);
            for tau in TAUS {
                let expected = change(&side, seen, tau);
                let mut compare = |name: String, diffuse: f64| {
                    let truth = judge.get(&name);
                    if truth.mean.abs() > TELLING * diffuse {
                        let noise = NOISE * truth.variance.sqrt() / truth.mean.abs();
                        let ratio = |change: f64| change * diffuse / truth.mean;
                        // And that of a quarter as much ink.
                        let ratios = [expected, change(&side, seen, 0.25 * tau)].map(ratio);
                        found.push((name, ratios, noise, sheet.depth()));
                    }
                };
                compare(name("photograph", &sheet, front, tau), seen - floor);
                for angle in [0.0, 60.0] {
                    let all = side.average(seen, towards(angle), [0.0, 1.0], [0.0, TAU], 16)[1];
                    compare(name(&format!("beam {angle}"), &sheet, front, tau), PI * all);
                }
            }
        }
    }
    found
}

impl Sheet {
    /// σs′d.
    fn depth(&self) -> f64 {
        (1.0 - G) * self.sigma_s * self.thickness_mm
    }
}

#[test]
fn ink_on_the_other_side_darkens_as_the_judge_finds() {
    let judge = Judge::of(include_str!("../fixtures/show_through.csv"));
    let all = compared(&judge);
    let (mut worst, mut thinner) = (0.0f64, 0.0f64);
    let (mut count, mut told) = (0, 0);
    for (name, [ratio, of_less], noise, depth) in &all {
        println!("{name}: {ratio:.3} ± {noise:.3} (σs′d {depth:.2})");
        let off = (ratio - 1.0).abs();
        if *depth < SHEET {
            thinner = thinner.max(off);
            continue;
        }
        count += 1;
        worst = worst.max(off);
        assert!(off < CHANGE, "{name}: {ratio}");
        told += usize::from((of_less - 1.0).abs() > CHANGE);
    }
    println!("{count} changes of sheets, worst {worst:.3}; of what is thinner {thinner:.3}");
    assert!(count > 100);
    // Deep ink lets nothing back whether there is more of it or not: of the three depths, the least
    // tells how much there is.
    assert!(4 * told > count, "{told} of {count}");
    // The walk is surer than that.
    assert!(all.iter().all(|(_, _, noise, _)| *noise < 0.5 * CHANGE));
}
