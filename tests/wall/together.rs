//! Several machines of one wall: apps without windows, over loopback.

use std::{
    fs,
    io::Write,
    net::{TcpListener, TcpStream},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicU16, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use bevy::{
    input::touch::{TouchInput, TouchPhase},
    prelude::*,
    time::TimeUpdateStrategy,
    window::{PrimaryWindow, WindowEvent, WindowResolution},
};
use recto::{
    installation::Installation,
    manifest::exhibit::Exhibit,
    maps::encode::save_png_rgb8,
    optics::tier::Tier,
    shot::{Darkroom, Picture},
    stage::{Arranged, Library, Shown, Waker},
    visitor::{
        Hand, Intent, Manners, VisitorPlugin,
        controls::{Control, Interface, Panel},
        hand::Picture as HandPicture,
        mirror::Told,
    },
    wall::{
        health::Health,
        journal::{CURRENT, Journal},
        together::{
            self, Party, Standing, Turn,
            link::{CLOCK, SNAPSHOTS},
            snapshot::{LONGEST, PROTOCOL, Snapshot, Which},
        },
    },
};
use serde_json::{Value, json};
use tempfile::TempDir;
use zenoh::Wait;

/// Of the whole wall's picture.
const SIZE: [u32; 2] = [960, 480];
const FRAME: Duration = Duration::from_millis(16);
/// How long anything may take on a slow machine.
pub const PATIENCE: Duration = Duration::from_secs(120);
/// One program on one device draws the same twice.
const SAME: f32 = 0.0;
/// Letters lie in an atlas in the order in which they were first drawn, and are read there to a step of 8
/// bits, in linear light; few of them are read so exactly between two steps.
const STEP: f32 = 0.009;
const FEW: usize = 50;
/// What is seen to be another picture.
const OTHER: f32 = 0.02;

pub const MANIFEST: &str = r#"
[exhibit]
title = "Two sheets"
languages = ["en", "it"]
[[drawing]]
id = "sheet"
size_mm = [300.0, 200.0]
recto.albedo = "paper.png"
verso.albedo = "ink.png"
[[drawing.overlay]]
id = "uv"
side = "recto"
kind = "picture"
file = "ink.png"
[[lamp]]
id = "left"
kind = "distant"
lux_at_sheet = 1000
elevation_deg = 25
azimuth_deg = 180
[[scene]]
id = "whole"
drawing = "sheet"
lamps = ["left"]
[[scene]]
id = "detail"
drawing = "sheet"
lamps = ["left"]
camera = { centre_mm = [100, 80], width_mm = 60 }
"#;

/// An exhibit that differs from place to place of the sheet.
pub fn write_exhibit(folder: &Path, manifest: &str) {
    const SIDE: u32 = 64;
    fs::create_dir_all(folder).unwrap();
    let grey = |k: u32, of: u32| (k * 255 / of) as u8;
    let pixels = |ink: u8| -> Vec<[u8; 3]> {
        let place = |k: u32| [grey(k % SIDE, SIDE), grey(k / SIDE, SIDE), ink];
        (0..SIDE * SIDE).map(place).collect()
    };
    for (name, ink) in [("paper.png", 160), ("ink.png", 40)] {
        save_png_rgb8(&folder.join(name), SIDE, SIDE, &pixels(ink), None).unwrap();
    }
    fs::write(folder.join("exhibit.toml"), manifest).unwrap();
}

/// Two ports of loopback that nobody has, below those that the system gives to whoever asks.
fn free_ports() -> [u16; 2] {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    let first = 20_000 + (std::process::id() % 500) as u16 * 20;
    loop {
        let port = first + NEXT.fetch_add(2, Ordering::Relaxed) % 2_000;
        let ports = [port, port + 1];
        if ports
            .iter()
            .all(|port| TcpListener::bind(("127.0.0.1", *port)).is_ok())
        {
            return ports;
        }
    }
}

/// A wall of two displays, each of a machine of its own, which has its own copy of the exhibit.
pub struct Place {
    root: TempDir,
    port: u16,
    pub status: u16,
}

impl Place {
    pub fn new() -> Self {
        let place = Self {
            root: tempfile::tempdir().unwrap(),
            port: free_ports()[0],
            status: free_ports()[0],
        };
        for machine in ["west", "east"] {
            write_exhibit(&place.exhibit(machine), MANIFEST);
            let display = |id: &str, left: u32, desktop: u32| {
                format!(
                    "[[display]]\nid = \"{id}\"\nmachine = \"{id}\"\npixels = [240, 240]\n\
                     size_mm = [240, 240]\nleft_mm = {left}\ndesktop_px = [{desktop}, 0]\n"
                )
            };
            let text = format!(
                "[exhibits]\nfolders = [\"exhibit\"]\n[machines]\nlead = \"west\"\n\
                 address = \"127.0.0.1:{}\"\nlost_after_seconds = 2\n\
                 [status]\naddress = \"127.0.0.1:{}\"\n{}{}",
                place.port,
                place.status,
                display("west", 0, 0),
                display("east", 240, 240),
            );
            fs::write(place.file(machine), text).unwrap();
        }
        place
    }

    pub fn folder(&self, machine: &str) -> PathBuf {
        self.root.path().join(machine)
    }

    pub fn exhibit(&self, machine: &str) -> PathBuf {
        self.folder(machine).join("exhibit")
    }

    pub fn file(&self, machine: &str) -> PathBuf {
        self.folder(machine).join("installation.toml")
    }

    fn installation(&self, machine: &str) -> Installation {
        let read = Installation::read(&self.file(machine));
        read.unwrap_or_else(|faults| panic!("{faults}")).0
    }

    /// What a machine wrote down.
    fn log(&self, machine: &str) -> String {
        fs::read_to_string(self.folder(machine).join(CURRENT)).unwrap_or_default()
    }
}

/// One machine, without a window.
struct Machine {
    room: Darkroom,
    window: Entity,
    health: Arc<Health>,
}

impl Machine {
    fn new(place: &Place, name: &str) -> Self {
        let installation = place.installation(name);
        let machine = installation.machine(Some(name), None).unwrap().unwrap();
        let (exhibit, _) = Exhibit::read(&place.exhibit(name)).unwrap();
        let [width, height] = SIZE.map(f64::from);
        let picture = HandPicture {
            aspect: width / height,
            width_mm: width,
            measured: true,
        };
        let hand = Hand::new(Arc::new(exhibit), 0, Tier::Draft, picture, false);
        let health = Arc::new(Health::new());
        let party = Party {
            machine,
            wall: together::wall_print(&installation),
            folders: installation.exhibits.folders.clone(),
            journal: Journal::open(&place.folder(name), 1_000_000, 2, health.clone()),
            health: health.clone(),
        };
        let built = Darkroom::with(1, |app| {
            app.add_plugins(VisitorPlugin {
                hand,
                display_mm: None,
                export: None,
                manners: Manners::default(),
            })
            .insert_resource(Waker(Arc::new(|| {})))
            .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
            together::join(app, party);
            app.insert_resource(Turn(0));
        });
        let mut room = built.unwrap_or_else(|error| panic!("{error}"));
        let window = Window {
            resolution: WindowResolution::new(SIZE[0], SIZE[1]),
            ..default()
        };
        let window = room.world().spawn((window, PrimaryWindow)).id();
        let mut machine = Self {
            room,
            window,
            health,
        };
        machine.settle();
        machine
    }

    fn frame(&mut self) {
        self.room.frame().unwrap_or_else(|error| panic!("{error}"));
    }

    fn settle(&mut self) {
        for _ in 0..6 {
            self.frame();
        }
        while !self.room.world().resource::<Arranged>().is_settled() {
            self.room.world().resource_mut::<Library>().wait();
            self.frame();
        }
    }

    fn touch(&mut self, phase: TouchPhase, at: Vec2) {
        let touch = TouchInput {
            phase,
            position: at,
            window: self.window,
            force: None,
            id: 1,
        };
        self.room
            .world()
            .write_message(WindowEvent::TouchInput(touch));
        self.frame();
    }

    /// A hand that takes the sheet and holds it there.
    fn drag(&mut self, from: Vec2, to: Vec2) {
        self.touch(TouchPhase::Started, from);
        for step in 1..=8 {
            self.touch(TouchPhase::Moved, from.lerp(to, step as f32 / 8.0));
        }
    }

    fn wish(&mut self, intent: Intent) {
        self.room.world().write_message(intent);
        self.frame();
    }

    fn see(&mut self) -> Picture {
        let seen = self.room.see(SIZE);
        seen.unwrap_or_else(|error| panic!("{error}"))
    }

    fn shown(&mut self) -> Shown {
        self.room.world().resource::<Shown>().clone()
    }

    fn standing(&self) -> Standing {
        self.health.report().machines.expect("it is one of several")
    }

    fn faults(&self) -> Vec<String> {
        self.health.report().about.faults
    }

    fn told(&mut self) -> Told {
        Told::of(self.room.world()).expect("something is shown")
    }

    /// Frames until something holds; how long that took is printed.
    fn until(&mut self, what: &str, holds: impl Fn(&mut Self) -> bool) {
        let begun = Instant::now();
        while !holds(self) {
            assert!(
                begun.elapsed() < PATIENCE,
                "{what}: never, {:?}",
                self.faults()
            );
            self.frame();
            thread::sleep(Duration::from_millis(2));
        }
        println!("{what}: {:.0} ms", begun.elapsed().as_secs_f64() * 1e3);
    }
}

/// Largest difference of any value of the sheet, and of what lies over it, of which so many differ.
fn difference(a: &Picture, b: &Picture) -> ([f32; 2], usize) {
    let apart = |a: &[f32], b: &[f32]| -> Vec<f32> {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect()
    };
    let sheet = apart(a.pixels.as_flattened(), b.pixels.as_flattened());
    let over = apart(a.legend.as_flattened(), b.legend.as_flattened());
    let largest = |all: &[f32]| all.iter().copied().fold(0.0, f32::max);
    let count = over.iter().filter(|apart| **apart > 0.0).count();
    ([largest(&sheet), largest(&over)], count)
}

#[track_caller]
fn alike(a: &Picture, b: &Picture) {
    let ([sheet, over], count) = difference(a, b);
    let words = format!("sheet {sheet}, over it {over} of {count} values");
    assert!(sheet <= SAME && over <= STEP && count <= FEW, "{words}");
}

#[track_caller]
fn same(a: &mut Machine, b: &mut Machine) {
    alike(&a.see(), &b.see());
}

/// Writes pictures for eyes, where somebody asks for them.
fn keep(picture: &Picture, name: &str) {
    if let Some(folder) = std::env::var_os("RECTO_KEEP_PICTURES") {
        let (width, height) = (picture.width, picture.height);
        let print =
            recto::develop::Print::develop(width, height, &picture.pixels, &picture.legend, 1.0);
        let path = Path::new(&folder).join(name);
        save_png_rgb8(&path, width, height, &print.pixels, None).unwrap();
    }
}

/// What the leader shows is shown by the follower.
#[track_caller]
fn follows(leader: &mut Machine, follower: &mut Machine, what: &str) {
    let told = leader.told();
    // Both begin alike: the follower has to have heard it.
    let has_heard = |follower: &mut Machine| {
        let leader = follower.standing().leader;
        leader.is_some_and(|leader| leader.shown_version.is_some())
    };
    follower.until(what, |follower| {
        has_heard(follower) && follower.told() == told
    });
    follower.settle();
}

#[test]
fn a_follower_shows_what_the_leader_s_hand_turns() {
    let place = Place::new();
    let mut leader = Machine::new(&place, "west");
    let mut follower = Machine::new(&place, "east");
    follows(&mut leader, &mut follower, "first picture");
    let rest = leader.see();
    alike(&rest, &follower.see());

    // A sheet that is held turned, under another lamp, with a panel open.
    leader
        .room
        .world()
        .resource_mut::<Interface>()
        .toggle(Panel::Light);
    leader.wish(Intent::SetLamp {
        elevation_deg: 50.0,
        azimuth_deg: 90.0,
    });
    leader.drag(Vec2::new(300.0, 150.0), Vec2::new(390.0, 180.0));
    let turned = leader.see();
    assert!(
        difference(&turned, &rest).0[0] > OTHER,
        "it is another picture"
    );
    follows(&mut leader, &mut follower, "a turn of the hand");
    let followed = follower.see();
    keep(&turned, "together-leader.png");
    keep(&followed, "together-follower.png");
    alike(&turned, &followed);
    assert_eq!(follower.shown().pose, leader.shown().pose);

    // The other side, near, with an overlay and another language, without the caption.
    leader.touch(TouchPhase::Ended, Vec2::new(390.0, 180.0));
    for intent in [Intent::GoTo(1), Intent::StepOverlay, Intent::Caption] {
        leader.wish(intent);
    }
    leader.room.world().resource_mut::<Interface>().language = Some("it".to_owned());
    leader.frame();
    leader.settle();
    follows(
        &mut leader,
        &mut follower,
        "a scene, an overlay, a language",
    );
    assert_eq!(follower.shown().scene, leader.shown().scene);
    same(&mut leader, &mut follower);

    // Members of a comparison, and a tool that lies on the sheet.
    leader.wish(Intent::StepOverlay);
    leader.wish(Intent::StepCompare(1));
    leader.settle();
    follows(&mut leader, &mut follower, "a comparison");
    assert!(follower.shown().scene.compare.is_some());
    same(&mut leader, &mut follower);

    // Whoever touches a follower touches nothing.
    let before = follower.told();
    follower.drag(Vec2::new(100.0, 100.0), Vec2::new(200.0, 100.0));
    follower.wish(Intent::Flip);
    assert_eq!(follower.told(), before);

    let standing = follower.standing();
    let heard = standing.leader.expect("it follows");
    println!(
        "clock {:?} ± {:?} ms",
        heard.clock_offset_ms, heard.clock_within_ms
    );
    assert!(heard.clock_within_ms.expect("it is known") > 0.0);
    let bytes = serde_json::to_vec(&leader.told()).unwrap().len();
    println!("what is told: {bytes} bytes");
    assert!(bytes < LONGEST / 16);
    assert_eq!(leader.standing().followers[0].machine, "east");
    assert!(leader.faults().is_empty() && follower.faults().is_empty());
}

#[test]
fn what_staff_type_is_not_told() {
    let place = Place::new();
    let mut leader = Machine::new(&place, "west");
    let held = |leader: &mut Machine, control| {
        leader.room.world().resource_mut::<Interface>().held = vec![(1, control)];
        serde_json::to_string(&leader.told()).unwrap()
    };
    assert!(
        held(&mut leader, Control::Home).contains("Home"),
        "the test can fail"
    );
    let told = held(&mut leader, Control::Digit(7));
    assert!(!told.contains("Digit"), "{told}");
}

#[test]
fn a_follower_that_stood_still_catches_up_at_once() {
    let place = Place::new();
    let mut leader = Machine::new(&place, "west");
    let mut follower = Machine::new(&place, "east");
    follows(&mut leader, &mut follower, "first picture");
    let stopped = follower.told();
    let shown = follower.standing().leader.unwrap().shown_version;
    // The leader waits for nobody: as many pictures as are drawn in a long turn.
    leader.touch(TouchPhase::Started, Vec2::new(200.0, 100.0));
    for step in 0..200 {
        let by = 60.0 * (step as f32 / 20.0).sin();
        leader.touch(TouchPhase::Moved, Vec2::new(200.0 + by, 100.0 + by / 3.0));
    }
    assert_eq!(follower.told(), stopped, "it keeps its last picture");
    follows(
        &mut leader,
        &mut follower,
        "after 200 pictures that were missed",
    );
    let heard = follower.standing().leader.unwrap();
    assert!(heard.shown_version.unwrap() >= shown.unwrap() + 200);
    same(&mut leader, &mut follower);
}

#[test]
fn a_leader_that_is_lost_leaves_its_picture_and_is_followed_when_it_is_back() {
    let place = Place::new();
    let mut leader = Machine::new(&place, "west");
    let mut follower = Machine::new(&place, "east");
    leader.wish(Intent::GoTo(1));
    leader.settle();
    follows(&mut leader, &mut follower, "first picture");
    let last = follower.see();
    drop(leader);
    follower.until("the leader is missed", |follower| {
        follower
            .faults()
            .iter()
            .any(|fault| fault.contains("west has been silent for"))
    });
    alike(&last, &follower.see());
    let mut leader = Machine::new(&place, "west");
    leader.wish(Intent::RaiseLamp(80.0));
    follows(&mut leader, &mut follower, "the leader is back");
    follower.until("nothing is wrong any more", |follower| {
        follower.faults().is_empty()
    });
    same(&mut leader, &mut follower);
    let log = place.log("east");
    assert_eq!(log.matches("west has been silent").count(), 1, "{log}");
    assert_eq!(log.matches("west is heard again").count(), 1, "{log}");

    // It asks once a second, and can only be missed by a leader that has heard it.
    leader.until("the follower is heard", |leader| {
        leader.standing().followers[0].silent_s.is_some()
    });
    drop(follower);
    leader.until("a lost follower is told of", |leader| {
        leader
            .faults()
            .iter()
            .any(|fault| fault.contains("east has been silent for"))
    });
}

#[test]
fn without_the_leader_s_exhibit_the_last_picture_stays() {
    let place = Place::new();
    let mut leader = Machine::new(&place, "west");
    let mut follower = Machine::new(&place, "east");
    follows(&mut leader, &mut follower, "first picture");
    drop(leader);
    let other = MANIFEST.replace("width_mm = 60", "width_mm = 90");
    write_exhibit(&place.exhibit("west"), &other);
    let before = follower.see();
    let mut leader = Machine::new(&place, "west");
    leader.wish(Intent::GoTo(1));
    follower.until("another version is told of", |follower| {
        let faults = follower.faults();
        faults
            .iter()
            .any(|fault| fault.contains("is another version here"))
    });
    alike(&before, &follower.see());
    leader.until("the leader hears of it", |leader| {
        leader
            .faults()
            .iter()
            .any(|fault| fault.starts_with("east: "))
    });
    write_exhibit(&place.exhibit("east"), &other);
    follows(&mut leader, &mut follower, "the same version is here");
    assert!((follower.shown().scene.camera.width_mm - 90.0).abs() < 1e-9);
}

/// Somebody who speaks for the leader at its address.
fn impostor(place: &Place) -> zenoh::Session {
    let configuration = format!(
        "{{ mode: 'peer', listen: {{ endpoints: ['tcp/127.0.0.1:{}'] }},
            scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }} }}",
        place.port
    );
    let configuration = zenoh::Config::from_json5(&configuration).unwrap();
    zenoh::open(configuration).wait().unwrap()
}

#[test]
fn strange_messages_are_told_of_once_and_change_nothing() {
    let place = Place::new();
    let mut follower = Machine::new(&place, "east");
    let before = follower.told();
    let session = impostor(&place);
    let wall = together::wall_print(&place.installation("east"));
    let mut version = 0;
    let print = follower.print();
    let mut snapshot = |told: Value| {
        version += 1;
        let snapshot = Snapshot {
            recto: PROTOCOL,
            wall: wall.clone(),
            term: 1,
            version,
            at: 0,
            exhibit: Which {
                turn: 0,
                print: print.clone(),
            },
            told,
        };
        (serde_json::to_vec(&snapshot).unwrap(), version)
    };
    let told = serde_json::to_value(&before).unwrap();
    let with = |place: &str, value: Value| {
        let mut told = told.clone();
        *told.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = value;
        told
    };
    // Each with the version that is heard, where it has the shape of one.
    let mut messages: Vec<(Vec<u8>, Option<u64>)> = [
        Vec::new(),
        b"\xff\xfe nonsense".to_vec(),
        vec![b'['; LONGEST - 1],
        vec![b' '; LONGEST + 1],
        vec![b' '; 3 << 20],
        b"{\"recto\":2,\"wall\":\"\"}".to_vec(),
        b"{\"recto\":1,\"wall\":\"another\"}".to_vec(),
    ]
    .map(|bytes| (bytes, None))
    .into();
    for (place, value) in [
        ("/hand/scene", json!(99)),
        ("/hand/state", json!(0)),
        ("/hand/layers", json!([])),
        ("/hand/layers/0/0", json!(7)),
        ("/hand/camera/width_mm", json!("0")),
        ("/hand/camera/width_mm", json!("-1e300")),
        ("/hand/camera/centre_mm/0", json!("1e300")),
        ("/hand/categories", json!({"0": [3]})),
        ("/hand/tier", json!("magic")),
        (
            "/hand/compare",
            json!({
                "mode": "curtain", "of": [{"overlay": 9}, {"state": null}], "at": "0.5", "angle": "0",
                "centre": ["0.5", "0.5"], "radius": "0.2", "magnify": "2", "full_delta_e": "10",
                "full_luminance": null, "coded": true, "turn": 0,
            }),
        ),
        ("/interface/first_scene", json!(1_000_000)),
        ("/home", json!(40)),
        (
            "/measuring/laid",
            json!([[1, "ruler", {
                "on": {"drawing": "sheet", "side": "recto", "state": null},
                "places": [], "screen_mm": "1", "sheet": 0,
            }]]),
        ),
    ] {
        let (bytes, version) = snapshot(with(place, value));
        messages.push((bytes, Some(version)));
    }
    for (place, value) in [("/hand/turn", json!(["NaN", "0"])), ("/hand", json!(null))] {
        messages.push((snapshot(with(place, value)).0, None));
    }
    let publisher = session.declare_publisher(SNAPSHOTS).wait().unwrap();
    let begun = Instant::now();
    while !publisher.matching_status().wait().unwrap().matching() {
        assert!(begun.elapsed() < PATIENCE, "nobody hears");
        thread::sleep(Duration::from_millis(10));
    }
    for _ in 0..2 {
        for (message, version) in &messages {
            publisher.put(message.clone()).wait().unwrap();
            let heard = |follower: &Machine| follower.standing().leader.unwrap().heard_version;
            while version.is_some_and(|version| heard(&follower) < Some(version)) {
                assert!(begun.elapsed() < PATIENCE, "it is not heard");
                thread::sleep(Duration::from_millis(1));
            }
            follower.frame();
        }
    }
    assert_eq!(follower.told(), before, "nothing of it is shown");
    // A sound one after all of that.
    let sound = with("/hand/scene", json!(1));
    publisher.put(snapshot(sound).0).wait().unwrap();
    follower.until("a sound one is shown", |follower| {
        follower.shown().scene.id == "detail"
    });
    thread::sleep(Duration::from_millis(300));
    let log = place.log("east");
    for (words, count) in [
        ("none of Recto's", 1),
        ("bytes, where", 1),
        ("of protocol 2, where 1 is spoken here", 1),
        ("of another wall", 1),
        ("scene number 99", 1),
    ] {
        assert_eq!(log.matches(words).count(), count, "{words}: {log}");
    }
}

#[test]
fn a_stranger_says_nothing_in_the_leader_s_name() {
    let place = Place::new();
    let mut leader = Machine::new(&place, "west");
    let mut follower = Machine::new(&place, "east");
    follows(&mut leader, &mut follower, "first picture");
    // Bytes that are none of zenoh's.
    for bytes in [&b"GET / HTTP/1.1\r\n\r\n"[..], &[0xff; 4096], &[0; 3]] {
        let mut stream = TcpStream::connect(("127.0.0.1", place.port)).unwrap();
        // It may be closed already.
        let _ = stream.write_all(bytes);
    }
    let configuration = format!(
        "{{ mode: 'client', connect: {{ endpoints: ['tcp/127.0.0.1:{}'] }},
            scouting: {{ multicast: {{ enabled: false }} }} }}",
        place.port
    );
    let configuration = zenoh::Config::from_json5(&configuration).unwrap();
    let stranger = zenoh::open(configuration).wait().unwrap();
    let mut told = serde_json::to_value(leader.told()).unwrap();
    told["hand"]["scene"] = json!(1);
    let fake = Snapshot {
        recto: PROTOCOL,
        wall: together::wall_print(&place.installation("west")),
        term: 1,
        version: 1 << 40,
        at: 0,
        exhibit: Which {
            turn: 0,
            print: follower.print(),
        },
        told,
    };
    let before = follower.told();
    for _ in 0..20 {
        stranger
            .put(SNAPSHOTS, serde_json::to_vec(&fake).unwrap())
            .wait()
            .unwrap();
        let asked = stranger.get(CLOCK).payload("nonsense").wait();
        drop(asked);
        thread::sleep(Duration::from_millis(20));
        follower.frame();
        leader.frame();
    }
    assert_eq!(follower.told(), before);
    leader.wish(Intent::RaiseLamp(70.0));
    follows(&mut leader, &mut follower, "the leader goes on");
    let names: Vec<String> = leader
        .standing()
        .followers
        .into_iter()
        .map(|f| f.machine)
        .collect();
    assert_eq!(names, ["east"]);
}

impl Machine {
    /// Of its exhibit, as snapshots have it.
    fn print(&mut self) -> String {
        together::exhibit_print(self.room.world().resource::<Hand>().exhibit())
    }
}
