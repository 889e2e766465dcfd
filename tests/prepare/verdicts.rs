//! What a report says to look at again, on either side of each limit.

use glam::DVec2;
use recto::{
    manifest::SideName,
    prepare::{
        Report, SideReport,
        capture::Crop,
        materials::{
            Known, Materials, SwatchTold, Trial,
            confusion::Confusion,
            ways::{Method, Surroundings, Way},
        },
        matter::MatterReport,
        moved::Stillness,
        relief::compare::{Comparison, Spread},
        report::verdict::{Standing, Verdict},
        stereo::left_out::Relit,
    },
};

use super::reported::{fitted, lamps, left_over, photographs};

fn materials() -> Materials {
    let way = Way {
        method: Method::Discriminant,
        surroundings: Surroundings::Nothing,
    };
    Materials {
        media: vec![None, "wash".parse().ok()],
        paper_shown: true,
        learnt: vec![100, 100],
        trials: vec![Trial {
            way,
            choosing: 1.0,
            held_out: Confusion {
                counts: vec![vec![95, 5], vec![5, 95]],
            },
        }],
        chosen: way,
        coverage: vec![0.5, 0.5],
        unlike: 0.01,
        swatches: vec![SwatchTold {
            swatch: Known {
                medium: "wash".parse().ok(),
                rect: Crop {
                    left: 10,
                    top: 20,
                    right: 30,
                    bottom: 40,
                },
            },
            right: 0.9,
            taken_for: None,
        }],
        blur: 0.0,
    }
}

/// Of a sheet of 100 × 80 mm at which nothing is wrong and of which all was measured.
fn sound() -> Report {
    let (residuals, residual) = left_over();
    let side = SideReport {
        side: SideName::Recto,
        size: [1000, 800],
        residual,
        residuals,
        doubted: 0.05,
        relit: Some(Relit {
            computed: 0.02,
            neighbours: 0.10,
            photographs: 4,
        }),
        relit_each: photographs(),
        doubts: Vec::new(),
        assumed_exposure: None,
        shape_um: [-500.0, 700.0],
        grain_um: [-10.0, 10.0],
        matter: MatterReport {
            materials: Some(materials()),
            ..MatterReport::default()
        },
        compared: None,
    };
    Report {
        manifest: "exhibit.toml".into(),
        mm_per_px: 0.1,
        lamps: lamps(),
        ball: None,
        spread: 0.7,
        colour: Some(fitted()),
        sides: vec![side],
        stillness: vec![Stillness {
            shifts: vec![Some(DVec2::new(0.1, 0.0)), None],
            limit_px: 1.0,
        }],
        verso: None,
        interrupted: 0,
    }
}

fn with(change: impl Fn(&mut Report)) -> Report {
    let mut report = sound();
    change(&mut report);
    report
}

#[test]
fn each_limit_parts_good_from_doubtful() {
    assert_eq!(sound().doubts(), Vec::<String>::new());
    let good = |verdict: &Verdict| verdict.standing == Standing::Good && !verdict.told.is_empty();
    assert!(
        sound().verdicts().iter().all(good),
        "{:?}",
        sound().verdicts()
    );
    let compared = |sigma: f64| Comparison {
        whole: Spread {
            mean: 0.0,
            sigma,
            count: 100,
        },
        patches: Vec::new(),
    };
    let found = |right: u64| Confusion {
        counts: vec![vec![right, 1000 - right], vec![1000 - right, right]],
    };
    type Change<'c> = &'c dyn Fn(&mut Report, f64);
    // What is changed, just within the limit, just beyond it, and what is told of it.
    let cases: [(Change<'_>, [f64; 2], &str, &str); 11] = [
        (&|r, v| r.spread = v, [0.201, 0.199], "lamps", "noise"),
        (
            &|r, v| {
                r.sides[0].relit = Some(Relit {
                    computed: v,
                    neighbours: 0.1,
                    photographs: 4,
                });
            },
            [0.0999, 0.1001],
            "lamps",
            "order of the lamps is probably wrong",
        ),
        (
            &|r, v| r.sides[0].doubted = v,
            [0.299, 0.301],
            "photographs and exposure",
            "grey cards",
        ),
        (
            &|r, v| r.sides[0].residual[0] = v,
            [0.099, 0.101],
            "photographs and exposure",
            "contradict each other",
        ),
        (
            &|r, v| r.stillness[0].shifts[1] = Some(DVec2::new(0.0, -v)),
            [0.49, 0.51],
            "photographs and exposure",
            "photograph 2 of the recto is shifted",
        ),
        (
            &|r, v| r.colour.iter_mut().for_each(|f| f.after = vec![v; 24]),
            [4.99, 5.01],
            "colour",
            "corners of the chart",
        ),
        (
            &|r, v| r.sides[0].shape_um = [0.0, v],
            [9990.0, 10010.0],
            "shape",
            "distance_mm",
        ),
        (
            &|r, v| r.sides[0].compared = Some(compared(v)),
            [119.0, 121.0],
            "shape",
            "other surface",
        ),
        (
            &|r, v| {
                let materials = r.sides[0].matter.materials.as_mut();
                materials.expect("materials").trials[0].held_out = found(v as u64);
            },
            [901.0, 899.0],
            "materials",
            "add swatches",
        ),
        (
            &|r, v| {
                let materials = r.sides[0].matter.materials.as_mut();
                materials.expect("materials").unlike = v;
            },
            [0.199, 0.201],
            "materials",
            "like no swatch",
        ),
        (
            &|r, v| {
                let materials = r.sides[0].matter.materials.as_mut();
                materials.expect("materials").swatches[0].right = v;
            },
            [0.501, 0.499],
            "materials",
            "most others as bare-paper; draw it again",
        ),
    ];
    for (change, [within, beyond], matter, words) in cases {
        let right = with(|report| change(report, within));
        assert_eq!(right.doubts(), Vec::<String>::new(), "{matter}, {words}");
        // What is no number is doubtful too; which shift is the farthest is not told here.
        let shifted = words.contains("shifted");
        for value in [beyond, if shifted { beyond } else { f64::NAN }] {
            let wrong = with(|report| change(report, value)).doubts();
            assert_eq!(wrong.len(), 1, "{matter}: {wrong:?}");
            let told = wrong[0].strip_prefix(&format!("{matter}: "));
            assert!(told.is_some_and(|told| told.contains(words)), "{wrong:?}");
        }
    }
}

fn standing(report: &Report, matter: &str) -> Standing {
    let verdicts = report.verdicts();
    let of = verdicts.iter().find(|verdict| verdict.matter == matter);
    of.expect("a verdict").standing
}

#[test]
fn what_the_photographs_themselves_show_is_told() {
    let report = with(|report| {
        report.sides[0]
            .doubts
            .push("a.tif is over-exposed".to_owned())
    });
    assert_eq!(
        report.doubts(),
        ["photographs and exposure: a.tif is over-exposed"]
    );
    assert!(sound().doubts().is_empty());
}

#[test]
fn what_was_not_measured_is_neither_good_nor_doubtful() {
    type Change<'c> = &'c dyn Fn(&mut Report);
    let cases: [(Change, &str); 6] = [
        (&|r| r.colour = None, "colour"),
        (&|r| r.sides[0].matter.materials = None, "materials"),
        (&|r| r.sides[0].relit = None, "lamps"),
        (&|r| r.lamps.truncate(3), "photographs and exposure"),
        (
            &|r| r.sides[0].assumed_exposure = Some(1.3),
            "photographs and exposure",
        ),
        (
            &|r| {
                let materials = r.sides[0].matter.materials.as_mut();
                materials.expect("materials").trials.clear();
            },
            "materials",
        ),
    ];
    for (change, matter) in cases {
        let report = with(change);
        assert_eq!(report.doubts(), Vec::<String>::new(), "{matter}");
        assert_eq!(standing(&report, matter), Standing::NotMeasured, "{matter}");
    }
    // A shape that rests upon doubtful photographs is not good, and not told twice.
    let report = with(|report| report.sides[0].doubted = 0.9);
    assert_eq!(standing(&report, "shape"), Standing::NotMeasured);
    assert_eq!(report.doubts().len(), 1);
    // Each side is told by its name.
    let report = with(|report| {
        let mut verso = report.sides[0].clone();
        (verso.side, verso.doubted) = (SideName::Verso, 0.9);
        report.sides.push(verso);
        report.stillness.push(report.stillness[0].clone());
    });
    let doubts = report.doubts();
    assert!(
        doubts.len() == 1 && doubts[0].contains("of the verso"),
        "{doubts:?}"
    );
}
