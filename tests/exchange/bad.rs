//! Files that are broken, hostile or of another kind: each refused in words that name the file, at
//! once, with nothing written.

use std::fs;

use image::{Rgb, RgbImage};
use recto::{
    exchange::{self, ExchangeError, Known},
    manifest::staging::StagingError,
};
use serde_json::{Value, json};

use super::Desk;

/// The words with which this file is refused.
fn refused(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let desk = Desk::new();
    desk.write(name, bytes);
    desk.refusal(name)
}

fn ptm(format: &str, size: &str, scale: &str, bytes: usize) -> Vec<u8> {
    let mut file = format!("PTM_1.2\n{format}\n{size}\n{scale}\n0 0 0 0 0 0\n").into_bytes();
    file.extend(vec![7; bytes]);
    file
}

const ONES: &str = "1 1 1 1 1 1";
const LRGB: &str = "PTM_FORMAT_LRGB";

#[test]
fn a_broken_ptm_is_refused_in_words() {
    let whole = ptm(LRGB, "2\n3", ONES, 54);
    for (bytes, words) in [
        (whole[..whole.len() - 1].to_vec(), "it ends too early"),
        (whole[..26].to_vec(), "height"),
        (ptm(LRGB, "2\n3", ONES, 540), "do not belong together"),
        (b"PTM_1.2".to_vec(), "PTM_FORMAT_LRGB"),
        (b"GIF89a".to_vec(), "PTM_1.2"),
        (Vec::new(), "PTM_1.2"),
        (vec![0xff; 9000], "PTM_1.2"),
        // More than there is memory for, and than a picture may have.
        (ptm(LRGB, "16384\n16384", ONES, 54), "2415919164 bytes"),
        (
            ptm(LRGB, "4294967295\n4294967295", ONES, 54),
            "1 to 16384 pixels",
        ),
        (ptm(LRGB, "0\n-3", ONES, 54), "height"),
        (ptm(LRGB, "2\n3", "1 1 nan 1 1 1", 54), "scale[2]"),
        (ptm(LRGB, "2\n3", "1 1 1 1 1 inf", 54), "scale[5]"),
        (ptm(LRGB, "2\n3", "1 1 1e999 1 1 1", 54), "scale[2]"),
        // One number too few, and what follows is no number.
        (
            b"PTM_1.2\nPTM_FORMAT_LRGB\n2\n3\n1 1 1 1 1 1\n0 0 0 0 0\n\x01\x02".to_vec(),
            "bias[5]",
        ),
        (
            ptm("PTM_FORMAT_JPEG_LRGB", "2\n3", ONES, 54),
            "save it uncompressed",
        ),
        (
            ptm("PTM_FORMAT_JPEGLS_RGB", "2\n3", ONES, 54),
            "save it uncompressed",
        ),
        (ptm("PTM_FORMAT_LUM", "2\n3", ONES, 54), "PTM_FORMAT_RGB"),
    ] {
        let found = refused("a.ptm", bytes);
        assert!(found.contains(words), "{words}: {found}");
    }
    // All faults of a header at once.
    let several = refused("a.ptm", ptm(LRGB, "0\n99999", "x 1 1 1 nan 1", 54));
    assert_eq!(several.lines().count(), 4, "{several}");
}

fn hsh(header: &str, floats: &[f32], bytes: usize) -> Vec<u8> {
    let mut file = header.as_bytes().to_vec();
    file.extend(floats.iter().flat_map(|v| v.to_le_bytes()));
    file.extend(vec![9; bytes]);
    file
}

#[test]
fn a_broken_rti_is_refused_in_words() {
    let head = "#HSH1.2\n3\n2 3 3\n9 2 1\n";
    let mut floats = vec![1.0; 18];
    let whole = hsh(head, &floats, 6 * 27);
    for (bytes, words) in [
        (whole[..whole.len() - 1].to_vec(), "it ends too early"),
        (hsh(head, &floats[..12], 0), "bias"),
        (hsh(head, &floats, 6000), "do not belong together"),
        (b"#HSH1.2\n#\n#".to_vec(), "does not end"),
        (
            hsh("#HSH1.2\n1\n2 3 3\n6 2 1\n", &floats, 200),
            "save it as .ptm",
        ),
        (hsh("#HSH1.2\n3\n99999 3 3\n9 2 1\n", &floats, 200), "width"),
        (
            hsh("#HSH1.2\n3\n2 3 3\n4000000000 2 1\n", &floats, 200),
            "terms",
        ),
        (hsh("#HSH1.2\n3\n2 3 1\n9 1 4\n", &floats, 200), "channels"),
    ] {
        let found = refused("a.rti", bytes);
        assert!(found.contains(words), "{words}: {found}");
    }
    floats[3] = f32::NAN;
    floats[11] = f32::NEG_INFINITY;
    let found = refused("a.rti", hsh(head, &floats, 6 * 27));
    assert!(
        found.contains("scale[3]") && found.contains("bias[2]"),
        "{found}"
    );
}

/// A sound `info.json` of a PTM with two by two pixels.
fn info() -> Value {
    json!({
        "width": 2, "height": 2, "format": "png", "type": "ptm", "colorspace": "lrgb", "nplanes": 9,
        "materials": [{ "scale": vec![1.0; 9], "bias": vec![0.0; 9] }],
    })
}

/// A folder with the planes of [`info`].
fn planes() -> Desk {
    let desk = Desk::new();
    for i in 0..3 {
        let picture = RgbImage::from_pixel(2, 2, Rgb([9, 8, 7]));
        picture
            .save(desk.folder().join(format!("plane_{i}.png")))
            .expect("written");
    }
    desk
}

#[test]
fn a_broken_info_json_is_refused_in_words() {
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut info = info();
        change(&mut info);
        let desk = planes();
        desk.write("info.json", info.to_string());
        desk.refusal("info.json")
    };
    type Change<'c> = (&'c dyn Fn(&mut Value), &'c str);
    let cases: [Change; 14] = [
        (&|v| v["width"] = json!(1_000_000_000_000_u64), "width"),
        (&|v| v["width"] = json!(3), "3 × 2 pixels"),
        (&|v| v["height"] = json!(-2), "height"),
        (&|v| v["nplanes"] = json!(8), "nplanes"),
        (&|v| v["nplanes"] = json!(4_000_000_000_u64), "nplanes"),
        (&|v| v["type"] = json!("dmd"), "bilinear"),
        (&|v| v["colorspace"] = json!("mrgb"), "colorspace"),
        // The planes' names are made of it.
        (&|v| v["format"] = json!("png/../../secret.png"), "format"),
        (&|v| v["format"] = json!("../../secret.png"), "format"),
        (&|v| v["materials"] = json!([]), "materials"),
        (
            &|v| v["materials"][0]["scale"] = json!([1, 2]),
            "materials[0].scale",
        ),
        (
            &|v| v["materials"][0]["bias"][3] = json!("0"),
            "materials[0].bias",
        ),
        (
            &|v| v["materials"][0]["bias"] = Value::Null,
            "materials[0].bias",
        ),
        (&|v| v["type"] = json!("rbf"), "colorspace"),
    ];
    for (change, words) in cases {
        let found = changed(change);
        assert!(found.contains(words), "{words}: {found}");
    }
    // Several at once.
    let several = changed(&|v| {
        v["width"] = json!(0);
        v["type"] = json!("x");
        v["colorspace"] = json!(7);
    });
    assert_eq!(several.lines().count(), 3, "{several}");

    let desk = planes();
    fs::remove_file(desk.folder().join("plane_1.png")).expect("removed");
    desk.write("info.json", info().to_string());
    assert!(desk.refusal("info.json").contains("plane_1.png"));
    desk.write("plane_0.dzi", "x");
    fs::remove_file(desk.folder().join("plane_0.png")).expect("removed");
    assert!(desk.refusal("info.json").contains("cut into tiles"));

    // One of another size is not unpacked: its body is cut off, and nobody looks.
    let desk = planes();
    let path = desk.folder().join("plane_1.png");
    let noise = |x: u32, y: u32| Rgb([x as u8, y as u8, (x ^ y) as u8]);
    RgbImage::from_fn(64, 64, noise)
        .save(&path)
        .expect("written");
    let bytes = fs::read(&path).expect("read");
    fs::write(&path, &bytes[..bytes.len() / 2]).expect("written");
    desk.write("info.json", info().to_string());
    let words = desk.refusal("info.json");
    assert!(words.contains("64 × 64 pixels"), "{words}");

    // A broken picture is told by its own name.
    let desk = planes();
    desk.write("plane_2.png", "no picture");
    desk.write("info.json", info().to_string());
    let error = desk.import("info.json").expect_err("refused").to_string();
    assert!(error.contains("plane_2.png"), "{error}");
    assert!(!desk.out().exists());
}

#[test]
fn a_broken_table_of_relight_is_refused_in_words() {
    let table = json!({
        "width": 2, "height": 2, "format": "png", "type": "bilinear", "colorspace": "mrgb",
        "nplanes": 9, "resolution": 3, "basis": vec![1; 10 * 9 * 3],
        "materials": [{ "scale": vec![1.0; 9], "bias": vec![0.0; 9], "range": vec![1.0; 9] }],
    });
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut info = table.clone();
        change(&mut info);
        let desk = planes();
        desk.write("info.json", info.to_string());
        desk.refusal("info.json")
    };
    assert!(changed(&|v| v["resolution"] = json!(1)).contains("resolution"));
    assert!(changed(&|v| v["resolution"] = json!(u32::MAX)).contains("resolution"));
    assert!(changed(&|v| v["basis"] = json!([1, 2, 3])).contains("a list of 270 numbers"));
    assert!(changed(&|v| v["materials"][0]["range"][4] = json!(0)).contains("range[4]"));
    let absent = changed(&|v| drop(v.as_object_mut().expect("an object").remove("basis")));
    assert!(absent.contains("materials.bin"), "{absent}");
    let rbf = |v: &mut Value| v["type"] = json!("rbf");
    let without = changed(&rbf);
    assert!(
        without.contains("lights") && without.contains("sigma"),
        "{without}"
    );
}

#[test]
fn json_of_another_kind_is_refused_in_words() {
    let deep = "[".repeat(200_000);
    let deep_object = "{\"items\":".repeat(100_000);
    for (name, text, words) in [
        ("info.json", deep.as_str(), "unclosed bracket"),
        ("manifest.json", deep_object.as_str(), "unclosed bracket"),
        ("info.json", "{\"width\": 2", "ends too early"),
        ("info.json", "{\"width\": 1e999}", "not JSON"),
        ("a.dome", "{]", "not JSON"),
        ("info.json", "{}", "without the keys"),
        (
            "manifest.json",
            "{\"@context\": \"http://iiif.io/api/presentation/2/context.json\"}",
            "version 3",
        ),
        (
            "manifest.json",
            "{\"@context\": \"http://iiif.io/api/presentation/3/context.json\", \"type\": \"Collection\"}",
            "not a manifest",
        ),
        ("letter.txt", "Dear Sir", ".ptm"),
        ("lamps.lp", "2\na.png 0 0 1\n", "2"),
        (
            "lamps.lp",
            "3\na.png 0 0 1\nb.png 0 0 -1\nc.png 1 nan 0\n",
            "line 3",
        ),
        ("a.dome", "{\"directions\": []}", "directions"),
        ("a.dome", "{\"directions\": 7}", "directions"),
    ] {
        let found = refused(name, text);
        assert!(found.contains(words), "{words}: {found}");
    }
    let desk = Desk::new();
    let nowhere = exchange::import(
        &desk.folder().join("no.ptm"),
        &desk.out(),
        &Known::default(),
    );
    assert!(nowhere.expect_err("absent").to_string().contains("no.ptm"));
    assert!(!desk.out().exists());
}

#[test]
fn what_is_there_already_is_left_as_it_is() {
    let desk = Desk::new();
    desk.write("a.ptm", ptm(LRGB, "2\n3", ONES, 54));
    for taken in ["exhibit.toml", "maps"] {
        let out = desk.root.path().join(format!("has-{taken}"));
        fs::create_dir(&out).expect("a folder");
        fs::write(out.join(taken), "mine").expect("written");
        let error = exchange::import(&desk.folder().join("a.ptm"), &out, &Known::default());
        let error = error.expect_err("refused");
        assert!(
            matches!(&error, ExchangeError::Staging(StagingError::Exists(path)) if path.ends_with(taken)),
            "{error}"
        );
        assert_eq!(
            fs::read_to_string(out.join(taken)).expect("still there"),
            "mine"
        );
        assert_eq!(fs::read_dir(&out).expect("a folder").count(), 1);
    }
    // A folder that was there, and is not at fault, stays.
    fs::create_dir(desk.out()).expect("a folder");
    desk.write("b.ptm", "PTM_1.2");
    desk.import("b.ptm").expect_err("refused");
    assert_eq!(fs::read_dir(desk.out()).expect("a folder").count(), 0);
    desk.import("a.ptm").expect("imported");
    let again = desk.import("a.ptm").expect_err("refused").to_string();
    assert!(again.contains("exhibit.toml: is there already"), "{again}");
}
