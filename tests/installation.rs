//! Installation files from end to end: the shipped example, every fault in its own words, and the
//! published schema beside the parser.

use std::{fs, path::PathBuf};

use recto::{
    installation::{
        self, Closed, Every, Installation, Profile, Use, Windows, check_shape, schema,
        staff::EXAMPLE as EXAMPLE_PIN,
    },
    manifest::Severity,
    maps::encode,
};
use serde_json::{Value, json};
use tempfile::TempDir;

const EXAMPLE: &str = include_str!("../exhibits/installation.toml");
/// The least that can be written.
const SMALL: &str = "[exhibits]\nfolders = [\"exhibit\"]\n";

/// A folder with an exhibit and an installation file.
struct Place {
    root: TempDir,
}

impl Place {
    fn new(text: &str) -> Self {
        let place = Self {
            root: tempfile::tempdir().unwrap(),
        };
        for name in ["exhibit", "landscape", "media-chart"] {
            let folder = place.root.path().join(name);
            fs::create_dir(&folder).unwrap();
            encode::save_png_rgb8(&folder.join("a.png"), 2, 2, &[[200; 3]; 4], None).unwrap();
            let manifest =
                "[[drawing]]\nid = \"a\"\nsize_mm = [20, 20]\nrecto.albedo = \"a.png\"\n";
            fs::write(folder.join("exhibit.toml"), manifest).unwrap();
        }
        fs::write(place.file(), text).unwrap();
        place
    }

    fn file(&self) -> PathBuf {
        self.root.path().join("installation.toml")
    }

    fn read(&self, used: Use) -> Result<(Installation, Vec<String>), Vec<String>> {
        let words = |fault: &recto::manifest::Fault| {
            fault
                .to_string()
                .replace(&format!("{}:", self.file().display()), "")
        };
        match Installation::read_for(&self.file(), used) {
            Ok((installation, warnings)) => {
                Ok((installation, warnings.iter().map(words).collect()))
            }
            Err(faults) => Err(faults.iter().map(words).collect()),
        }
    }
}

fn sound(text: &str) -> Installation {
    match Place::new(text).read(Use::Desk) {
        Ok((installation, _)) => installation,
        Err(faults) => panic!("{faults:#?}"),
    }
}

fn faults(text: &str) -> Vec<String> {
    match Place::new(text).read(Use::Desk) {
        Ok((_, warnings)) => panic!("it was taken, with {warnings:?}"),
        Err(faults) => faults,
    }
}

#[test]
fn the_least_that_can_be_written_has_usual_values() {
    let place = sound(SMALL);
    assert_eq!(place.exhibits.every, Every::Day);
    assert!(place.languages.is_empty() && place.wall.is_none() && place.logs.is_none());
    assert!(place.pin.is_none());
    assert_eq!(place.idle.after.as_secs(), 120);
    assert_eq!(place.hours.next_change(&jiff::Zoned::now()), None);
    assert!(place.status.unwrap().ip().is_loopback());
    assert_eq!((place.reach.from_mm, place.reach.to_mm), (380.0, 1220.0));
}

#[test]
fn the_example_is_sound_and_means_what_it_says() {
    let place = Place::new(EXAMPLE);
    let (example, warnings) = place.read(Use::Desk).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert!(example.pin.is_none());
    let wall = example.wall.unwrap();
    assert_eq!(wall.windows, Windows::Spanning);
    assert!((wall.size_mm().x - 2431.2).abs() < 1e-9 && (wall.size_mm().y - 680.4).abs() < 1e-9);
    // The upper edge at 1240.4 mm, and hands reach up to 1220.
    let band = wall.reach_px(&wall.displays[1], &example.reach).unwrap();
    assert!((band.start - 20.4 / 680.4 * 1080.0).abs() < 1e-9);
    assert_eq!(band.end, 1080.0);
    assert!(matches!(wall.displays[0].profile, Profile::Measured { .. }));
    assert_eq!(wall.layout()[0].on_desktop.size, [3840, 1080]);
    assert_eq!(example.exhibits.every, Every::Minutes(60));
    assert!(example.hours.week[0].is_empty());
    assert_eq!(example.hours.week[4][1].to_string(), "19:00-01:00");
    assert_eq!(example.hours.closed[0], Closed::EveryYear(12, 25));
    assert_eq!(example.logs.unwrap().max_bytes, 10_000_000);
}

#[test]
fn a_kiosk_has_a_pin_and_not_the_example_s() {
    let without = Place::new(EXAMPLE).read(Use::Kiosk).unwrap_err();
    assert_eq!(without.len(), 1, "{without:?}");
    assert!(
        without[0].contains("staff.pin: found nothing"),
        "{without:?}"
    );
    let with = |pin: &str| {
        let line = format!("pin = \"{pin}\"");
        let text = EXAMPLE.replace(&format!("# pin = \"{EXAMPLE_PIN}\""), &line);
        assert!(text.contains(&line), "the example has its PIN");
        Place::new(&text).read(Use::Kiosk)
    };
    for pin in [EXAMPLE_PIN, "0000", "1234", "987654"] {
        let refused = with(pin).unwrap_err();
        assert!(refused[0].contains("staff.pin: found a PIN"), "{refused:?}");
        assert!(!refused.concat().contains(pin), "it is not repeated");
    }
    let (installation, _) = with("8305").unwrap();
    assert!(installation.pin.unwrap().matches("8305"));
    let long = with("83058305830583").unwrap_err();
    assert!(
        long[0].contains("14 digits") && !long[0].contains("8305"),
        "{long:?}"
    );
}

#[test]
fn all_faults_are_told_at_once_with_place_and_remedy() {
    let text = r#"
langauges = ["en"]
windows = "all"

[exhibits]
folders = ["exhibit", "nowhere"]
every_minutes = 1.5

[[display]]
id = "a"
pixels = [1920, 1080]
size_mm = [960, 540]
profile = { icc = "none.icc" }

[[display]]
id = "b"
pixels = [1920, 1080]
size_mm = [960, 540]
left_mm = 900

[reach]
from_mm = 1300

[hours]
time_zone = "Europe/Roma"
monday = ["10:00-10:00", "09:00-12:00", "11:00-14:00"]
tuesday = ["9:00-12:00"]
closed = ["2026-02-30", "2026-05-02/2026-05-01"]

[status]
address = "0.0.0.0:8017"
"#;
    let found = faults(text);
    for words in [
        "2:1: langauges: found the unknown key \"langauges\"; allowed: exhibits, languages",
        "did you mean \"languages\"?",
        "3:11: windows: found \"all\"; allowed: \"spanning\" or \"each\"",
        "every_minutes: found 1.5; allowed: a whole number from 1 to 10080 minutes",
    ] {
        assert!(
            found.iter().any(|fault| fault.contains(words)),
            "{words}: {found:#?}"
        );
    }
    assert!(
        found
            .iter()
            .any(|fault| fault.contains("hours.tuesday[0]: found \"9:00-12:00\""))
    );
    // What the shape allows is looked at as well, as far as the rest can be read.
    for words in [
        "exhibits.folders[1]: found \"nowhere\", which is not there",
        "display[0].profile.icc: found \"none.icc\"",
        "display[1].left_mm: found a place where it covers 60 × 540 mm of \"a\"",
        "reach: found from 1300 to 1220 mm",
        "hours.time_zone: found \"Europe/Roma\"",
        "hours.monday[0]: found \"10:00-10:00\", which ends as it begins",
        "hours.monday[2]: found \"11:00-14:00\", which begins before \"09:00-12:00\" ends",
        "hours.closed[0]: found \"2026-02-30\", which no calendar has",
        "hours.closed[1]: found",
        "status.address: found \"0.0.0.0:8017\", which other machines reach",
    ] {
        assert!(
            found.iter().any(|fault| fault.contains(words)),
            "{words}: {found:#?}"
        );
    }
}

#[test]
fn displays_are_placed_from_the_top_or_from_the_floor() {
    let two = |first: &str, second: &str, more: &str| {
        format!(
            "{more}\n{SMALL}\n[[display]]\nid = \"a\"\npixels = [100, 100]\nsize_mm = [100, 100]\n\
             {first}\n[[display]]\nid = \"b\"\npixels = [100, 100]\nsize_mm = [100, 100]\n\
             {second}\n"
        )
    };
    let floor = sound(&two(
        "bottom_above_floor_mm = 500",
        "bottom_above_floor_mm = 700\nleft_mm = 150",
        "",
    ));
    let wall = floor.wall.unwrap();
    assert_eq!(wall.top_above_floor_mm, Some(800.0));
    assert_eq!(wall.displays[0].on_wall.min.y, 200.0);
    assert_eq!(wall.displays[1].on_wall.min.to_array(), [150.0, 0.0]);
    assert_eq!(wall.size_mm().to_array(), [250.0, 300.0]);

    let top = sound(&two(
        "top_mm = 30",
        "left_mm = -120",
        "bottom_above_floor_mm = 400",
    ));
    let wall = top.wall.unwrap();
    assert_eq!(wall.top_above_floor_mm, Some(530.0));
    assert_eq!(wall.displays[0].on_wall.min.to_array(), [120.0, 30.0]);
    assert_eq!(wall.displays[1].on_desktop.at, [100, 0]);

    let mixed = faults(&two("bottom_above_floor_mm = 500", "left_mm = 150", ""));
    assert!(mixed[0].contains("no bottom_above_floor_mm"), "{mixed:?}");
    let high = faults(&two("", "left_mm = 150", "bottom_above_floor_mm = 4000"));
    assert!(
        high[0].contains("no display between 380 and 1220 mm"),
        "{high:?}"
    );
}

#[test]
fn other_machines_read_the_status_only_where_that_is_meant() {
    let with = |status: &str| format!("{SMALL}\n[status]\n{status}\n");
    let address = |status: &str| {
        sound(&with(status))
            .status
            .map(|address| address.to_string())
    };
    assert_eq!(address("address = \"off\""), None);
    assert_eq!(address("address = \"[::1]:9000\"").unwrap(), "[::1]:9000");
    let meant = "address = \"0.0.0.0:9000\"\nbeyond_this_machine = true";
    assert_eq!(address(meant).unwrap(), "0.0.0.0:9000");
    let refused = faults(&with("address = \"localhost:9000\""));
    assert!(
        refused[0].contains("write \"127.0.0.1:9000\""),
        "{refused:?}"
    );
}

/// Two displays, each with its machine.
fn machines(west: &str, east: &str, machines: &str) -> String {
    let display = |id: &str, left: u32, machine: &str| {
        format!(
            "[[display]]\nid = \"{id}\"\npixels = [100, 100]\nsize_mm = [100, 100]\n\
             left_mm = {left}\n{machine}\n"
        )
    };
    let (left, right) = (display("a", 0, west), display("b", 120, east));
    format!("{SMALL}{machines}\n{left}{right}")
}

const TWO: &str = "[machines]\nlead = \"west\"\naddress = \"127.0.0.1:7447\"\n";

#[test]
fn machines_carry_their_displays_and_know_who_leads() {
    let text = machines("machine = \"west\"", "machine = \"east\"", TWO);
    let place = sound(&text);
    let named = |asked, host| place.machine(asked, host);
    let east = named(Some("east"), Some("west")).unwrap().unwrap();
    assert!(!east.leads() && east.index() == 1);
    assert!(named(None, Some("west")).unwrap().unwrap().leads());
    assert_eq!(east.status("127.0.0.1:8017".parse().unwrap()).port(), 8018);
    assert_eq!(east.machines.delay.as_millis(), 10);
    let wall = place.wall.as_ref().unwrap();
    // Each desktop begins at its own first pixel.
    let [window] = &wall.layout_on(Some("east"))[..] else {
        panic!("one window");
    };
    assert_eq!(
        (window.on_desktop.at, window.on_desktop.size),
        ([0, 0], [100, 100])
    );
    assert_eq!(window.panes[0].display, 1);
    assert!(window.panes[0].of_picture.min.x > 0.5);
    assert!(wall.layout_on(Some("north")).is_empty());

    let unknown = named(Some("esat"), None).unwrap_err().to_string();
    assert!(
        unknown.contains("--machine: found \"esat\"; allowed: \"west\" or \"east\""),
        "{unknown}"
    );
    assert!(unknown.contains("did you mean \"east\"?"), "{unknown}");
    let nobody = named(None, Some("kiosk-7")).unwrap_err().to_string();
    assert!(nobody.contains("RECTO_MACHINE=NAME"), "{nobody}");
    let alone = sound(SMALL);
    assert_eq!(alone.machine(None, Some("west")).unwrap(), None);
    assert!(
        alone
            .machine(Some("west"), None)
            .unwrap_err()
            .to_string()
            .contains("[machines]")
    );
}

#[test]
fn faults_of_machines_are_told_and_nothing_is_open_to_others_by_mistake() {
    let (west, east) = ("machine = \"west\"", "machine = \"east\"");
    let with = |more: &str| machines(west, east, &format!("{TWO}{more}"));
    let at = |address: &str, more: &str| with(more).replace("127.0.0.1:7447", address);
    for (text, words) in [
        (
            machines(west, east, ""),
            "display[0].machine: found \"west\" without [machines]",
        ),
        (
            machines(west, "", TWO),
            "display[1]: found no machine, where there are several",
        ),
        (
            machines(east, east, TWO),
            "machines.lead: found \"west\"; allowed: \"east\"",
        ),
        (
            format!("{SMALL}{TWO}"),
            "machines: found machines without a display",
        ),
        (
            at("0.0.0.0:7447", ""),
            "machines.address: found \"0.0.0.0:7447\", which is nobody's own",
        ),
        (
            at("192.168.1.10:7447", ""),
            "found \"192.168.1.10:7447\", which other machines reach",
        ),
        (at("127.0.0.1:0", ""), "machines.address: found port 0"),
        (
            at("west:7447", ""),
            "machines.address: found \"west:7447\"; allowed: the leader's address",
        ),
        (with("delay_ms = 501\n"), "machines.delay_ms: found 501"),
        (
            with("lost_after_seconds = 1\n"),
            "machines.lost_after_seconds: found 1",
        ),
    ] {
        let found = faults(&text);
        assert!(
            found.iter().any(|fault| fault.contains(words)),
            "{words}: {found:#?}"
        );
    }
    sound(&at("192.168.1.10:7447", "beyond_this_machine = true\n"));
    let warned = |text: &str| Place::new(text).read(Use::Desk).unwrap().1;
    let one = machines(west, west, TWO);
    assert!(
        warned(&one)[0].contains("\"west\" alone"),
        "{:?}",
        warned(&one)
    );
    let meant = with("beyond_this_machine = true\n");
    assert!(warned(&meant)[0].contains("which only this machine reaches"));
}

#[test]
fn an_icc_profile_of_a_display_is_read() {
    let place = Place::new(&format!(
        "{SMALL}\n[[display]]\nid = \"a\"\npixels = [192, 108]\nsize_mm = [960, 540]\n\
         profile = {{ icc = \"a.icc\" }}\n"
    ));
    let icc = place.root.path().join("a.icc");
    fs::write(&icc, moxcms::ColorProfile::new_srgb().encode().unwrap()).unwrap();
    let (installation, _) = place.read(Use::Desk).unwrap();
    let wall = installation.wall.unwrap();
    let correction = wall.displays[0].profile.correction();
    // sRGB's own profile changes nothing, to a hundredth of what 8 bits tell.
    for colour in [[1.0, 1.0, 1.0], [0.2, 0.5, 0.7], [0.01, 0.0, 0.9]] {
        let code = correction.encode(colour);
        let expected = colour.map(recto::colour::srgb_encode);
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 4e-4;
        assert!(
            code.iter().zip(&expected).all(near),
            "{code:?} {expected:?}"
        );
    }
    let mut bluish = moxcms::ColorProfile::new_srgb();
    bluish.chromatic_adaptation = Some(moxcms::Matrix3d {
        // From a white of x = .285, y = .293 to D50, by Bradford.
        v: [
            [1.085131, 0.035382, -0.087959],
            [0.044477, 0.999261, -0.029525],
            [-0.016749, 0.027655, 0.564849],
        ],
    });
    fs::write(&icc, bluish.encode().unwrap()).unwrap();
    let (installation, _) = place.read(Use::Desk).unwrap();
    let wall = installation.wall.unwrap();
    let [red, _, blue] = wall.displays[0].profile.correction().encode([1.0; 3]);
    assert_eq!(red, 1.0, "what the display has least of stays");
    assert!(blue < 0.95, "what it has too much of is dimmed: {blue}");
    let grey = moxcms::ColorProfile::new_gray_with_gamma(2.2)
        .encode()
        .unwrap();
    fs::write(&icc, grey).unwrap();
    let refused = place.read(Use::Desk).unwrap_err();
    assert!(refused[0].contains("display[0].profile.icc"), "{refused:?}");
}

#[test]
fn strange_files_end_in_words() {
    for text in [
        "",
        "[",
        "exhibits = 1",
        "[exhibits]\nfolders = []",
        "[[exhibits]]",
        "\u{0}",
    ] {
        assert!(!faults(text).is_empty(), "{text:?}");
    }
    let missing = Installation::read(&PathBuf::from("no/such.toml")).unwrap_err();
    assert!(missing.to_string().contains("exhibits/installation.toml"));
    let warned = Place::new(&format!(
        "{SMALL}\n[[display]]\nid = \"a\"\npixels = [1920, 1080]\nsize_mm = [960, 560]\n"
    ));
    let fault = Installation::read(&warned.file()).unwrap().1;
    assert!(
        fault
            .iter()
            .all(|fault| fault.severity == Severity::Warning)
    );
    assert!(fault.iter().any(|fault| fault.path == "display[0].size_mm"));
}

fn to_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => json!(text),
        toml::Value::Integer(integer) => json!(integer),
        toml::Value::Float(float) => json!(float),
        toml::Value::Datetime(_) => Value::Null,
        toml::Value::Boolean(boolean) => json!(boolean),
        toml::Value::Array(array) => array.iter().map(to_json).collect(),
        toml::Value::Table(table) => table
            .iter()
            .map(|(key, value)| (key.clone(), to_json(value)))
            .collect(),
    }
}

#[test]
fn the_schema_accepts_what_the_parser_accepts() {
    let validator = jsonschema::draft7::new(&schema()).unwrap();
    let (mut accepted, mut refused) = (0, 0);
    let mut judge = |text: &str| {
        let table: toml::Table = toml::from_str(text).unwrap();
        let by_schema = validator.is_valid(&to_json(&toml::Value::Table(table)));
        let by_parser = check_shape(text);
        assert_eq!(by_schema, by_parser.is_ok(), "{text}\n{by_parser:?}");
        *if by_schema {
            &mut accepted
        } else {
            &mut refused
        } += 1;
    };
    judge(EXAMPLE);
    judge(SMALL);
    let two = machines("machine = \"west\"", "machine = \"east\"", TWO);
    judge(&two);
    for (line, other) in [
        ("lead = \"west\"\n", ""),
        ("lead = \"west\"\n", "lead = \"the west\"\n"),
        ("address =", "adress ="),
        ("machine = \"east\"", "machine = 7"),
        ("lead =", "delay_ms = 20\nlead ="),
        ("lead =", "delay_ms = -1\nlead ="),
        ("lead =", "lost_after_seconds = 5\nlead ="),
        ("lead =", "lost_after_seconds = \"5\"\nlead ="),
        ("lead =", "beyond_this_machine = true\nlead ="),
    ] {
        assert!(two.contains(line));
        judge(&two.replacen(line, other, 1));
    }
    // Every line of the example left out, misspelt, or with another value.
    for line in EXAMPLE
        .lines()
        .filter(|line| !line.starts_with('#') && line.contains(" = "))
    {
        let (key, _) = line.split_once(" = ").unwrap();
        judge(&EXAMPLE.replacen(&format!("\n{line}"), "", 1));
        judge(&EXAMPLE.replacen(&format!("\n{line}"), &format!("\nx{line}"), 1));
        for value in [
            "0",
            "-1",
            "0.5",
            "1e9",
            "\"\"",
            "\"12-25\"",
            "[]",
            "[1, 2]",
            "true",
            "{}",
            "\"10:00-24:00\"",
            "[\"24:00-10:00\"]",
            "[\"13-01\"]",
            "\"04:60\"",
            "\"12345\"",
            "{ white_xy = [0.3, 0.3], icc = \"a\" }",
            "{ gamma = 2 }",
            "{ icc = \"a\" }",
        ] {
            judge(&EXAMPLE.replacen(&format!("\n{line}"), &format!("\n{key} = {value}"), 1));
        }
    }
    assert!(
        accepted > 40 && refused > 300,
        "{accepted} accepted, {refused} refused"
    );
    assert!(installation::schema()["properties"]["display"]["description"].is_string());
}
