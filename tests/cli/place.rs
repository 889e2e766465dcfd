//! `recto check --installation` and `recto schema --installation`.

use std::fs;

use super::{Sheet, code, recto, run, stdout};

/// An installation beside the sheet's exhibit.
fn place(text: &str) -> Sheet {
    let sheet = Sheet::new();
    fs::write(sheet.out("installation.toml"), text).unwrap();
    sheet
}

#[test]
fn an_installation_is_told_in_words_with_the_hours_of_a_week() {
    let sheet = place(
        "languages = [\"it\", \"en\"]\nbottom_above_floor_mm = 900\n\
         [exhibits]\nfolders = [\"exhibit\"]\n\
         [[display]]\nid = \"left\"\npixels = [1920, 1080]\nsize_mm = [960, 540]\n\
         [[display]]\nid = \"right\"\npixels = [1920, 1080]\nsize_mm = [960, 540]\n\
         left_mm = 980\n\
         [hours]\nevery_day = [\"10:00-13:00\", \"14:00-01:00\"]\nrestart = \"04:00\"\n",
    );
    let file = sheet.out("installation.toml");
    let mut check = recto();
    check.arg("check").arg("--installation").arg(&file);
    let output = check.output().unwrap();
    let stderr = code(&output, 0);
    assert!(stderr.is_empty(), "{stderr}");
    let words = stdout(&output);
    for part in [
        "installation.toml: sound",
        "2 displays on 1940.0 × 540.0 mm, from 900 to 1440 mm above the floor, one window of \
         3840 × 1080 pixels",
        "right: 1920 × 1080 pixels from 1920, 0, 51 per inch, at 980.0, 0.0 mm; controls in rows \
         440 to 1080; sRGB",
        "exhibits, always:",
        "2 scenes, sound",
        "languages: it, and en",
        "begins anew next at",
        "no PIN: --kiosk is refused",
    ] {
        assert!(words.contains(part), "{part}\n{words}");
    }
    assert_eq!(
        words.matches("10:00-13:00, 14:00-01:00").count(),
        7,
        "{words}"
    );
}

#[test]
fn faults_of_the_file_and_of_its_exhibits_are_named() {
    let sheet = place("[exhibits]\nfolder = [\"exhibit\"]\n");
    let file = sheet.out("installation.toml");
    let check = || {
        let output = recto()
            .arg("check")
            .arg("--installation")
            .arg(&file)
            .output();
        code(&output.unwrap(), 1)
    };
    let stderr = check();
    assert!(
        stderr.contains("installation.toml:2:1: exhibits.folder: found"),
        "{stderr}"
    );
    assert!(stderr.contains("did you mean \"folders\"?"), "{stderr}");
    fs::write(&file, "[exhibits]\nfolders = [\"exhibit\"]\n").unwrap();
    fs::write(sheet.exhibit().join("sheet.png"), "no picture").unwrap();
    let stderr = check();
    assert!(stderr.contains("exhibit.toml:"), "{stderr}");
    assert!(stderr.contains("sheet.png"), "{stderr}");
}

#[test]
fn the_schema_of_the_installation_is_json() {
    let output = run(&["schema", "--installation"]);
    code(&output, 0);
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(schema["properties"]["display"].is_object());
    assert_eq!(schema["additionalProperties"], false);
}
