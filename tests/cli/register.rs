//! `recto register`

use std::fs;

use super::{Sheet, code, recto, stdout, support::data};

/// A manifest of the leaf whose sides are photographed in `recto` and `verso`, of 400 dpi.
fn leaf(sheet: &Sheet, root: &std::path::Path, [recto, verso]: [&str; 2]) {
    for (from, to) in [(recto, "recto.jpg"), (verso, "verso.jpg")] {
        fs::copy(root.join(from), sheet.exhibit().join(to)).unwrap();
    }
    let manifest = "[[drawing]]\nid = \"leaf\"\nsize_mm = [153.5, 223.6]\n\
                    recto.albedo = \"recto.jpg\"\nverso.albedo = \"verso.jpg\"\n";
    fs::write(sheet.exhibit().join("exhibit.toml"), manifest).unwrap();
}

#[test]
fn a_verso_is_placed_by_its_ink_and_a_stranger_s_is_refused() {
    let test = "cli::register::a_verso_is_placed_by_its_ink_and_a_stranger_s_is_refused";
    let Some(root) = data(test, "bnf_recto_verso") else {
        return;
    };
    let sheet = Sheet::new();
    let register = || {
        recto()
            .arg("register")
            .arg(sheet.exhibit())
            .output()
            .unwrap()
    };
    leaf(&sheet, &root, ["it820_3r_f11.jpg", "it820_3v_f12.jpg"]);
    let found = register();
    code(&found, 0);
    let points = stdout(&found);
    assert!(points.starts_with("control_points = ["), "{points}");
    assert!(points.lines().count() > 20, "{points}");
    // What is proposed is what a manifest takes.
    let manifest = sheet.exhibit().join("exhibit.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let placed = text.replace("verso.albedo", "[drawing.verso]\nalbedo");
    fs::write(&manifest, format!("{placed}{points}\n")).unwrap();
    code(&register(), 0);

    leaf(&sheet, &root, ["it820_2r_f9.jpg", "it820_3v_f12.jpg"]);
    let stderr = code(&register(), 1);
    assert!(stderr.contains("do not match"), "{stderr}");
}

#[test]
fn what_is_not_there_is_named() {
    let sheet = Sheet::new();
    let register = |more: &[&str]| {
        let output = recto()
            .arg("register")
            .arg(sheet.exhibit())
            .args(more)
            .output();
        code(&output.unwrap(), 1)
    };
    // Two small grey pictures.
    let stderr = register(&[]);
    assert!(stderr.contains("do not match"), "{stderr}");
    let stderr = register(&["--drawing", "none"]);
    assert!(
        stderr.contains("--drawing none: the exhibit has"),
        "{stderr}"
    );
    let stderr = register(&["--state", "none"]);
    assert!(stderr.contains("in the state none"), "{stderr}");
}
