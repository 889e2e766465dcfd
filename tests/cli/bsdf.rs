//! `recto bsdf`

use std::fs;

use super::{Sheet, code, run, stdout};

const PAIRS: &str = "# light, eye\ntheta_i,phi_i,theta_o,phi_o\n45,0,0,0\n\n0,0,30,90\n\
                     60,0,60,180\n89,10,85,-170\n45,0,135,180\n";
/// OPTICS.md: the device against f64; here the directions are rounded too.
const RELATIVE: f64 = 1e-3;

fn table(text: &str) -> Vec<Vec<f64>> {
    let rows = text.lines().skip(1);
    rows.map(|row| row.split(',').map(|x| x.parse().expect(row)).collect())
        .collect()
}

#[test]
fn shader_and_f64_agree_about_every_tier() {
    let sheet = Sheet::new();
    let file = sheet.out("pairs.csv");
    fs::write(&file, PAIRS).unwrap();
    let file = file.to_str().unwrap();
    for tier in recto::optics::tier::Tier::ALL {
        let evaluate = |device| {
            let medium = ["bsdf", "--medium", "burnished", "--albedo", "0.9,0.5,0.1"];
            let rest = ["--tier", tier.name(), "--device", device, "--pairs", file];
            run(&[&medium[..], &rest].concat())
        };
        let (cpu, gpu) = (evaluate("cpu"), evaluate("gpu"));
        assert_eq!(code(&cpu, 0) + &code(&gpu, 0), "", "{tier}");
        let header = "theta_i,phi_i,theta_o,phi_o,f_red,f_green,f_blue,mirror_red,mirror_green,\
                      mirror_blue,ballistic_red,ballistic_green,ballistic_blue";
        assert_eq!(stdout(&cpu).lines().next(), Some(header));
        let (cpu, gpu) = (table(stdout(&cpu)), table(stdout(&gpu)));
        assert_eq!((cpu.len(), gpu.len()), (5, 5), "{tier}");
        for (row, (cpu, gpu)) in cpu.iter().zip(&gpu).enumerate() {
            for (a, b) in cpu.iter().zip(gpu) {
                let sound = a.is_finite() && (a - b).abs() <= RELATIVE * a.abs();
                assert!(sound, "{tier}, row {row}: {cpu:?} {gpu:?}");
            }
            let through = tier.name() == "study";
            assert_eq!(cpu[4] > 0.0, row < 4 || through, "{tier}");
            assert!(cpu[7..10].iter().all(|part| *part == 0.0), "{tier}");
            // The last pair is opposite: light that no fibre met.
            let straight = cpu[10..].iter().all(|part| *part > 0.0);
            assert_eq!(straight, row == 4 && through, "{tier}");
        }
    }
    // A diffuser, in sr⁻¹ and without the cosine.
    let lambert = run(&[
        "bsdf", "--medium", "laid", "--tier", "lambert", "--albedo", "1,1,0", "--pairs", file,
    ]);
    let first = &table(stdout(&lambert))[0];
    assert_eq!(
        first[4..7],
        [1.0 / std::f64::consts::PI, 1.0 / std::f64::consts::PI, 0.0]
    );
}

#[test]
fn every_kind_of_medium_has_its_light_at_study_and_the_article_has_its_own() {
    let sheet = Sheet::new();
    let file = sheet.out("pairs.csv");
    fs::write(&file, PAIRS).unwrap();
    let file = file.to_str().unwrap();
    let evaluate = |medium: &str, optics: &str, device: &str| {
        let of = [
            "bsdf",
            "--medium",
            medium,
            "--albedo",
            "0.3,0.2,0.1",
            "--tier",
            "study",
        ];
        let how = ["--optics", optics, "--device", device, "--pairs", file];
        let output = run(&[&of[..], &how].concat());
        assert_eq!(code(&output, 0), "", "{medium}");
        table(stdout(&output))
    };
    // Of each matter; through those that only cover, no light comes.
    for (medium, passes) in [
        ("parchment", true),
        ("iron-gall-ink", true),
        ("wash", true),
        ("silver-point", false),
        ("red-chalk", false),
        ("white-gouache", true),
        ("tinted-ground", true),
        ("blind-stylus", true),
    ] {
        let [cpu, gpu] = ["cpu", "gpu"].map(|device| evaluate(medium, "recto", device));
        for (row, (cpu, gpu)) in cpu.iter().zip(&gpu).enumerate() {
            for (a, b) in cpu.iter().zip(gpu) {
                let sound = a.is_finite() && (a - b).abs() <= RELATIVE * a.abs();
                assert!(sound, "{medium}, row {row}: {cpu:?} {gpu:?}");
            }
            assert_eq!(cpu[4] > 0.0, row < 4 || passes, "{medium}, row {row}");
        }
        // The first pair is the photograph's.
        let shown = [0, 1, 2].map(|c| std::f64::consts::PI * cpu[0][4 + c]);
        for (shown, albedo) in shown.into_iter().zip([0.3, 0.2, 0.1]) {
            assert!((shown - albedo).abs() < 1e-3, "{medium}: {shown}");
        }
        let article = evaluate(medium, "isle-2021", "cpu");
        let printed = ["parchment", "iron-gall-ink", "silver-point"].contains(&medium);
        assert_eq!(article != cpu, printed, "{medium}");
    }
}

#[test]
fn faults_of_pairs_are_named_all_at_once() {
    let sheet = Sheet::new();
    let file = sheet.out("pairs.csv");
    fs::write(
        &file,
        "theta_i,phi_i,theta_o,phi_o\n91,0,0,0\n0,here,0,inf\n1,2\n",
    )
    .unwrap();
    let path = file.to_str().unwrap();
    let output = run(&["bsdf", "--medium", "laid", "--pairs", path]);
    let stderr = code(&output, 1);
    for words in [
        "line 2, column 1",
        "line 3, column 2",
        "line 3, column 4",
        "line 4",
        "theta_i",
    ] {
        assert!(stderr.contains(words), "{words}: {stderr}");
    }
    assert!(output.stdout.is_empty());
    let output = run(&["bsdf", "--medium", "laid", "--pairs", "/nonexistent.csv"]);
    assert!(code(&output, 1).contains("/nonexistent.csv"));
    let output = run(&["bsdf", "--medium", "iron-gal-ink", "--pairs", path]);
    assert!(code(&output, 2).contains("iron-gall-ink"));
    for albedo in ["1,1", "2,0,0", "NaN,0,0"] {
        let output = run(&[
            "bsdf", "--medium", "laid", "--albedo", albedo, "--pairs", path,
        ]);
        code(&output, 2);
    }
}
