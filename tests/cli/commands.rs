//! Everything that needs no graphics device.

use std::fs;

use super::{EDGE, Sheet, code, files, recto, run, stdout, with_closed_stdout, write_picture};

#[test]
fn wrong_usage_ends_with_2() {
    let sheet = Sheet::new();
    let exhibit = sheet.exhibit();
    let exhibit = exhibit.to_str().unwrap();
    let out = sheet.out("x.png");
    let out = out.to_str().unwrap();
    let render = |more: [&'static str; 2]| {
        let [option, value] = more;
        vec!["render", exhibit, "--out", out, option, value]
    };
    for arguments in [
        vec!["render"],
        vec!["render", exhibit],
        vec!["render", exhibit, "--out", "x.jpg"],
        vec!["check"],
        vec!["check", exhibit, "--explode"],
        vec!["sample", "x", "--dpi", "5"],
        vec!["sample", "x", "--dpi", "NaN"],
        vec!["new", "x"],
        vec!["new", "x", "--albedo", "a.png", "--size-mm", "10"],
        vec!["check", exhibit, "--installation", "x.toml"],
        vec!["schema", "--capture", "--installation"],
        vec!["prepare", "capture.toml"],
        vec!["import", "x.ptm"],
        vec!["import", "x.ptm", "--out", out, "--size-mm", "0x10"],
        vec!["import", "x.ptm", "--out", out, "--size-mm", "nanx10"],
        vec!["export", exhibit, "--out", out],
        vec!["export", exhibit, "--iiif"],
        vec![
            "export",
            exhibit,
            "--iiif",
            "--out",
            out,
            "--base",
            "museum.example",
        ],
        vec![
            "export",
            exhibit,
            "--iiif",
            "--out",
            out,
            "--base",
            "http://x/?y",
        ],
        render(["--size", "0x10"]),
        render(["--size", "16385x1"]),
        render(["--size", "-1x10"]),
        render(["--side", "front"]),
        render(["--tier", "best"]),
        render(["--all-scenes", "--scene=whole"]),
        render(["--transmitted", "-1"]),
        render(["--transmitted", "all"]),
        render(["--enhance", ""]),
        render(["--enhance", "sharpen=2"]),
        render(["--overlay", "picture:"]),
        render(["--overlay", "picture=2"]),
        render(["--camera", "tilt_deg=95"]),
        render(["--lamp", "kind=pint"]),
        render(["--compare", "curtain"]),
        render(["--language", "?"]),
        vec!["register", exhibit, "--reach-mm", "0"],
        vec!["register", exhibit, "--reach-mm", "-3"],
        vec!["measure", exhibit, "--ruler", "1,1"],
        vec!["measure", exhibit, "--probe", "1,1,0"],
        vec!["probe", exhibit, "--at", "1"],
    ] {
        let output = run(&arguments);
        let stderr = code(&output, 2);
        assert!(!stderr.is_empty(), "{arguments:?}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
    assert_eq!(files(sheet.root.path()), ["exhibit"]);
}

#[test]
fn a_comparison_s_faults_are_all_named_and_nothing_is_written() {
    let sheet = Sheet::new();
    let out = sheet.out("x.png");
    let ends = |spec: &str, with: i32| {
        let output = recto()
            .args(["render", "--size", "16x16", "--compare", spec, "--out"])
            .arg(&out)
            .arg(sheet.exhibit())
            .output();
        code(&output.unwrap(), with)
    };
    let compare = |spec: &str| ends(spec, 1);
    let stderr = compare("curtain:state:a,overlay:pictur");
    assert!(stderr.contains("--compare.of[0]: found \"a\""), "{stderr}");
    assert!(stderr.contains("did you mean \"picture\"?"), "{stderr}");
    let stderr = compare("blend:side:recto,side:verso,overlay:picture");
    assert!(
        stderr.contains("found 3 members; allowed: 2 for this mode"),
        "{stderr}"
    );
    for (spec, with) in [
        ("curtain", 2),
        ("curtian:side:recto,side:verso", 2),
        ("loupe:side:recto,side:recto", 1),
        ("glass:side:recto,overlay:picture", 1),
    ] {
        assert!(ends(spec, with).contains("--compare"), "{spec}");
    }
    assert!(ends("curtain:side:recto,side:verso,at=2", 2).contains("0 to 1"));
    let radius = ends("loupe:side:recto,side:verso,radius=0", 2);
    assert!(radius.contains("from 0.01 to 1"), "{radius}");
    let key = ends("loupe:side:recto,side:verso,at=.5", 2);
    let words = "--compare.at: found a key that mode \"loupe\" does not use";
    assert!(key.contains(words), "{key}");
    assert!(!out.exists());
}

#[test]
fn a_mistyped_tier_is_told_all_names() {
    let stderr = code(
        &run(&["render", "x", "--out", "x.png", "--tier", "studdy"]),
        2,
    );
    for name in ["draft", "gallery", "study", "isle", "oren-nayar"] {
        assert!(stderr.contains(name), "{stderr}");
    }
}

#[test]
fn an_exhibit_goes_out_as_iiif_and_comes_back() {
    let sheet = Sheet::new();
    let path = |path: &std::path::Path| path.to_str().unwrap().to_owned();
    let (exhibit, iiif, back) = (sheet.exhibit(), sheet.out("iiif"), sheet.out("back"));
    let (exhibit, iiif, back) = (path(&exhibit), path(&iiif), path(&back));
    let export = ["export", &exhibit, "--iiif", "--out", &iiif];
    let exported = run(&export);
    code(&exported, 0);
    let manifest = stdout(&exported).trim_end().to_owned();
    assert!(manifest.ends_with("manifest.json"), "{manifest}");
    let imported = run(&["import", &manifest, "--out", &back]);
    code(&imported, 0);
    assert!(stdout(&imported).trim_end().ends_with("exhibit.toml"));
    code(&run(&["check", &back]), 0);
    // What is there already stays.
    let again = code(&run(&export), 1);
    assert!(again.contains("manifest.json: is there already"), "{again}");
    code(&run(&["import", &manifest, "--out", &back]), 1);
    let nothing = code(
        &run(&["import", &exhibit, "--out", &path(&sheet.out("x"))]),
        1,
    );
    assert!(nothing.contains("info.json or manifest.json"), "{nothing}");
    assert_eq!(files(sheet.root.path()), ["back", "exhibit", "iiif"]);
}

#[test]
fn help_and_version_are_results() {
    for arguments in [
        vec!["--help"],
        vec!["render", "--help"],
        vec!["--version"],
        vec!["help", "check"],
    ] {
        let output = run(&arguments);
        assert_eq!(code(&output, 0), "");
        assert!(!output.stdout.is_empty());
    }
}

#[test]
fn a_missing_exhibit_ends_with_1() {
    for arguments in [
        vec!["check", "/nonexistent"],
        vec!["show", "/nonexistent"],
        vec!["/nonexistent"],
        vec!["render", "/nonexistent", "--out", "x.png"],
    ] {
        let output = run(&arguments);
        let stderr = code(&output, 1);
        assert_eq!(
            stderr,
            "/nonexistent: found no such file; allowed: an exhibit's folder with an \
             exhibit.toml, or that file itself; check the path, or begin an exhibit with `recto \
             new`\n"
        );
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn the_schema_is_json() {
    let output = run(&["schema"]);
    assert_eq!(code(&output, 0), "");
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(schema["properties"]["drawing"].is_object());
}

#[test]
fn a_new_exhibit_is_sound() {
    let root = tempfile::tempdir().unwrap();
    let (picture, folder) = (root.path().join("my sheet.png"), root.path().join("new"));
    write_picture(&picture, None);
    let new = |more: &[&str]| {
        let mut command = recto();
        command
            .arg("new")
            .arg(&folder)
            .arg("--albedo")
            .arg(&picture);
        command.args(more).output().unwrap()
    };
    // Neither the picture nor the curator says how large the sheet is.
    let stderr = code(&new(&[]), 2);
    assert!(stderr.contains("--size-mm"), "{stderr}");
    let stderr = code(&new(&["--size-mm", "0x10"]), 1);
    assert!(stderr.contains("size_mm"), "{stderr}");
    assert!(!folder.exists());

    let output = new(&["--size-mm", "210x210"]);
    code(&output, 0);
    let manifest = folder.join("exhibit.toml");
    assert_eq!(stdout(&output).trim_end(), manifest.to_str().unwrap());
    let text = fs::read_to_string(&manifest).unwrap();
    assert!(text.contains("size_mm = [210.0, 210.0]"), "{text}");
    let check = recto().arg("check").arg(&folder).output().unwrap();
    assert_eq!(code(&check, 0), "");
    assert!(stdout(&check).contains("sound"));

    let stderr = code(&new(&["--size-mm", "210x210"]), 1);
    assert!(stderr.contains("already"), "{stderr}");
    assert_eq!(fs::read_to_string(&manifest).unwrap(), text);
}

#[test]
fn a_new_exhibit_takes_its_size_from_the_picture() {
    let root = tempfile::tempdir().unwrap();
    let (picture, folder) = (root.path().join("a.png"), root.path().join("new"));
    write_picture(&picture, Some(25.4));
    let mut command = recto();
    command
        .arg("new")
        .arg(&folder)
        .arg("--albedo")
        .arg(&picture);
    code(&command.output().unwrap(), 0);
    let text = fs::read_to_string(folder.join("exhibit.toml")).unwrap();
    assert!(text.contains("size_mm = [16.0, 16.0]"), "{text}");
}

#[test]
fn check_tells_people_and_programs_the_same() {
    let sheet = Sheet::new();
    let check = |more: &[&str]| {
        recto()
            .arg("check")
            .arg(sheet.exhibit())
            .args(more)
            .output()
    };
    let short = check(&[]).unwrap();
    assert_eq!(code(&short, 0), "");
    assert!(!stdout(&short).contains("albedo"));
    let long = check(&["--explain"]).unwrap();
    code(&long, 0);
    for words in [
        "Scene whole",
        "albedo map",
        "sheet.png",
        "MiB",
        "assumed",
        "reference 7",
    ] {
        assert!(stdout(&long).contains(words), "{words}: {}", stdout(&long));
    }
    let json = check(&["--json"]).unwrap();
    code(&json, 0);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["sound"], true);
    assert_eq!(json["scenes"][1]["id"], "tilted");
    assert_eq!(json["scenes"][1]["maps"][1]["role"], "overlay");
    let lux = json["scenes"][0]["exposure"]["lux"].as_f64().unwrap();
    assert!(
        (lux - 1000.0 * 45f64.to_radians().cos()).abs() < 1e-6,
        "{lux}"
    );

    // A picture that ends early is found, by each form.
    let picture = sheet.exhibit().join("sheet.png");
    let bytes = fs::read(&picture).unwrap();
    fs::write(&picture, &bytes[..bytes.len() - 60]).unwrap();
    let refused = check(&[]).unwrap();
    let stderr = code(&refused, 1);
    assert!(stderr.contains("exhibit.toml:5:16: "), "{stderr}");
    assert!(refused.stdout.is_empty());
    let json = check(&["--json"]).unwrap();
    assert_eq!(code(&json, 1), stderr);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["sound"], false);
    assert_eq!(json["faults"][0]["line"], 5);
}

#[test]
fn a_comparison_is_checked_with_all_its_members() {
    let sheet = Sheet::rich();
    let check = |more: &str| {
        let output = recto().arg("check").arg(sheet.exhibit()).arg(more).output();
        output.unwrap()
    };
    let json = check("--json");
    code(&json, 0);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let scene = |id: &str| {
        let scenes = json["scenes"].as_array().unwrap();
        scenes.iter().find(|scene| scene["id"] == id).unwrap()
    };
    let [now, then, both] = ["now", "then", "both"].map(scene);
    let files = |scene: &serde_json::Value| {
        let maps = scene["maps"].as_array().unwrap().iter();
        let albedo = maps.filter(|map| map["role"] == "albedo");
        albedo
            .map(|map| map["file"].as_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(files(now), ["sheet.png"]);
    assert_eq!(files(then), ["before.png"]);
    assert_eq!(files(both), ["before.png", "sheet.png"]);
    // What both members need is there once.
    let bytes = |scene: &serde_json::Value| {
        let maps = scene["maps"].as_array().unwrap().iter();
        let sum: u64 = maps.map(|map| map["gpu_bytes"].as_u64().unwrap()).sum();
        assert_eq!(scene["gpu_bytes"], sum);
        sum
    };
    let albedo = u64::from(EDGE * EDGE) * 8 * 4 / 3;
    if both["accuracy"]["tier"] == now["accuracy"]["tier"] {
        assert_eq!(bytes(both), bytes(now) + albedo);
    }
    let in_window = |scene: &serde_json::Value| scene["gpu_bytes_in_window"].as_u64().unwrap();
    assert!(in_window(both) > in_window(now));
    // It is as exact as the worse of both.
    let errors = |scene: &serde_json::Value| -> Vec<f64> {
        let tiers = scene["accuracy"]["tiers"].as_array().unwrap().iter();
        tiers
            .map(|tier| tier["delta_e_mean"].as_f64().unwrap())
            .collect()
    };
    let [now_errors, then_errors, both_errors] = [now, then, both].map(errors);
    assert_ne!(now_errors, then_errors);
    for (k, error) in both_errors.iter().enumerate() {
        let worse = now_errors[k].max(then_errors[k]);
        assert!((error - worse).abs() < 1e-9, "{error} {worse}");
    }
    assert_eq!(both["compared"]["mode"], "curtain");
    assert_eq!(both["compared"]["of"][1], "state:none");
    assert!(now["compared"].is_null() && now["enhanced"].as_array().unwrap().is_empty());

    let long = check("--explain");
    for words in [
        "curtain of state:before and state:none, whose maps are all loaded",
        "enhanced for the eye, and said so on the picture: relief 2.0 times as steep; sharpened: 50 %",
        "state:before: recto: albedo from",
        "state:none: recto: albedo from",
    ] {
        assert!(stdout(&long).contains(words), "{words}: {}", stdout(&long));
    }
}

#[test]
fn a_closed_standard_output_is_no_panic() {
    let sheet = Sheet::new();
    let mut check = recto();
    check.arg("check").arg(sheet.exhibit()).arg("--explain");
    let mut schema = recto();
    schema.arg("schema");
    let mut help = recto();
    help.arg("--help");
    for command in [&mut check, &mut schema, &mut help] {
        let output = with_closed_stdout(command);
        assert_eq!(code(&output, 0), "");
    }
}
