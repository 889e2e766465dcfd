//! Every kind of fault, each with its exact words.

use std::{
    fs,
    process::Command,
    time::{Duration, Instant},
};

use recto::manifest::Exhibit;

use super::Folder;

/// Cases as `=== name`, manifest, `--- message`, message.
const TABLE: &str = include_str!("broken.txt");

/// Even the largest input is refused within this time by an unoptimised build on a machine that
/// is busy with other work; what grows with the square of the input would take minutes.
const AT_ONCE: Duration = Duration::from_secs(20);

struct Case {
    name: String,
    manifest: Vec<u8>,
    message: String,
}

fn case(name: &str, manifest: impl Into<Vec<u8>>, message: &str) -> Case {
    Case {
        name: name.to_owned(),
        manifest: manifest.into(),
        message: message.to_owned(),
    }
}

/// The cases that a text file can hold.
pub fn written_cases() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    TABLE.split("=== ").skip(1).map(|block| {
        let (name, rest) = block.split_once('\n').unwrap();
        let (manifest, message) = rest.split_once("--- message\n").unwrap();
        (name, manifest, message.trim_end())
    })
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = written_cases()
        .map(|(name, manifest, message)| case(name, manifest, message))
        .collect();
    let too_large = |bytes: usize| {
        format!(
            "exhibit.toml: found a file of {bytes} bytes; allowed: at most 4194304 bytes; keep \
             pictures in files of their own and split the exhibit in two"
        )
    };
    let too_deep = |place: &str| {
        format!(
            "exhibit.toml:{place} found tables or arrays nested too deeply; allowed: at most 80 \
             levels; a manifest needs fewer than ten; look for an unclosed bracket"
        )
    };
    const LARGE: usize = 10 << 20;
    cases.extend([
        case(
            "10 MB of brackets",
            format!("a = {}", "[".repeat(LARGE)),
            &too_large(LARGE + 4),
        ),
        case("10 MB of text", vec![b'#'; LARGE], &too_large(LARGE)),
        case(
            "4 MB of arrays",
            format!("a = {}", "[".repeat(4 << 20 >> 1)),
            &too_deep("1:85:"),
        ),
        case(
            "4 MB of tables",
            format!("a = {}", "{a=".repeat(1 << 20)),
            &too_deep("1:245:"),
        ),
        case(
            "4 MB of dots",
            format!("a{} = 1", ".a".repeat(1 << 20)),
            &too_deep(""),
        ),
        case(
            "4 MB of header",
            format!("[a{}]", ".a".repeat(1 << 20)),
            &too_deep(""),
        ),
        case(
            "UTF-16",
            b"\xff\xfe[\0e\0".as_slice(),
            "exhibit.toml:1:1: found the byte 0xff, which is not UTF-8; allowed: text in UTF-8; \
             save the file again with the encoding UTF-8",
        ),
        case(
            "Latin-1",
            b"[exhibit]\ntitle = \"Caf\xe9\"\n".as_slice(),
            "exhibit.toml:2:13: found the byte 0xe9, which is not UTF-8; allowed: text in UTF-8; \
             save the file again with the encoding UTF-8",
        ),
    ]);
    cases
}

#[test]
fn there_are_enough_cases_and_each_is_named_once() {
    let names: Vec<String> = cases().into_iter().map(|case| case.name).collect();
    assert!(names.len() >= 45, "{}", names.len());
    let unique: std::collections::BTreeSet<_> = names.iter().collect();
    assert_eq!(unique.len(), names.len());
}

#[test]
fn each_broken_manifest_has_its_message() {
    let folder = Folder::new();
    let mut wrong = String::new();
    for Case {
        name,
        manifest,
        message,
    } in cases()
    {
        folder.write(&manifest);
        let start = Instant::now();
        let result = Exhibit::read(&folder.exhibit)
            .and_then(|(exhibit, _)| exhibit.verify(exhibit.maps()).map(|_| exhibit));
        assert!(start.elapsed() < AT_ONCE, "{name}: {:?}", start.elapsed());
        let found = match result {
            Err(faults) => folder.relative(&faults.to_string()),
            Ok(_) => "no fault".to_owned(),
        };
        if found != message {
            wrong += &format!("=== {name}\n{found}\n--- instead of\n{message}\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn the_program_says_the_same_and_writes_nothing() {
    let folder = Folder::new();
    let out = folder.exhibit.join("x.png");
    for Case {
        name,
        manifest,
        message,
    } in cases()
    {
        folder.write(&manifest);
        let output = Command::new(env!("CARGO_BIN_EXE_recto"))
            .arg("render")
            .arg(&folder.exhibit)
            .arg("--out")
            .arg(&out)
            .output()
            .unwrap();
        let stderr = folder.relative(&String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.code(), Some(1), "{name}: {stderr}");
        for line in message.lines() {
            assert!(
                stderr.lines().any(|said| said.ends_with(line)),
                "{name}: {stderr}"
            );
        }
        assert!(output.stdout.is_empty(), "{name}");
        assert!(!out.exists(), "{name}");
    }
}

/// Inputs just below the size limit whose faults, names or files are many.
#[test]
fn many_faults_are_found_as_quickly_as_few() {
    const SIZE: usize = 4_000_000;
    let repeated = |line: &dyn Fn(usize) -> String| {
        let mut text = String::new();
        let mut i = 0;
        while text.len() < SIZE {
            text += &line(i);
            i += 1;
        }
        text
    };
    let sheet = |i: usize, file: &str| {
        format!("[[drawing]]\nid = \"s{i}\"\nsize_mm = [200, 100]\nrecto.albedo = \"{file}\"\n")
    };
    let one = sheet(0, "recto.png");
    let inputs = [
        repeated(&|i| format!("k{i} = 1\n")),
        repeated(&|i| sheet(i, "missing.png")),
        repeated(&|i| sheet(i % 2, "recto.png")),
        one.clone() + &repeated(&|i| format!("[[scene]]\nid = \"s{}\"\nlike = \"s{i}\"\n", i + 1)),
        one.clone() + &repeated(&|i| format!("[[scene]]\nid = \"s{i}\"\nstate = \"t{i}\"\n")),
        one + &repeated(&|i| format!("[[scene]]\nid = \"s{i}\"\nlike = \"t{i}\"\n")),
        "= \n".repeat(SIZE / 3),
    ];
    let folder = Folder::new();
    for (i, input) in inputs.iter().enumerate() {
        folder.write(input);
        let start = Instant::now();
        let faults = Exhibit::read(&folder.exhibit).unwrap_err();
        assert!(
            start.elapsed() < AT_ONCE,
            "input {i}: {:?}",
            start.elapsed()
        );
        assert!((20..=201).contains(&faults.iter().count()), "input {i}");
    }
}

#[test]
fn what_is_no_manifest_is_named() {
    let folder = Folder::new();
    let message =
        |path: &std::path::Path| folder.relative(&Exhibit::read(path).unwrap_err().to_string());
    assert_eq!(
        message(&folder.exhibit),
        "exhibit.toml: found no such file; allowed: an exhibit's folder with an exhibit.toml, or \
         that file itself; check the path, or begin an exhibit with `recto new`"
    );
    assert_eq!(
        message(&folder.exhibit.join("recto.png")),
        "recto.png:1:1: found the byte 0x89, which is not UTF-8; allowed: text in UTF-8; save the \
         file again with the encoding UTF-8"
    );
    fs::create_dir(folder.exhibit.join("exhibit.toml")).unwrap();
    assert_eq!(
        message(&folder.exhibit),
        "exhibit.toml: found something that is not a file; allowed: a TOML text file; put the \
         manifest's text in its place"
    );
}

#[test]
fn faults_can_be_read_by_programs() {
    let folder = Folder::with(
        "[[drawing]]\nid = \"sheet\"\nsize_mm = [0, 1]\nrecto.albedo = \"recto.png\"\n",
    );
    let faults = Exhibit::read(&folder.exhibit).unwrap_err();
    let json = serde_json::to_value(&faults).unwrap();
    assert_eq!(json[0]["severity"], "error");
    assert_eq!(json[0]["line"], 3);
    assert_eq!(json[0]["column"], 12);
    assert_eq!(json[0]["path"], "drawing[0].size_mm[0]");
    assert_eq!(json[0]["found"], "0");
}
