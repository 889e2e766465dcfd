//! Tools on the sheet that is shown: from wishes to what is asked of the maps, and from what they say to
//! marks over the picture.

use std::sync::Arc;

use bevy::prelude::*;
use glam::DVec2;

use super::{
    caption::Texts,
    glass::Glass,
    hand::Hand,
    intent::Intent,
    marks::{self, Ink, Mark, Marks, Shape},
    measuring::{self, Kind, Laid, Measuring, OnSide, Said},
    phrases,
    pointing::{Pointer, View},
    reader::{Answer, Errand, Reader},
    speech::Speech,
};
use crate::{
    manifest::exhibit::{Exhibit, Scene, SideName},
    readings::Why,
    stage::{Shown, Waker},
};

/// Whether a wish is the tool's that is in the hand, and nobody else's.
pub fn is_for_tool(measuring: &Measuring, intent: Intent) -> bool {
    match intent {
        Intent::Tap(_) | Intent::TrueSize { .. } => measuring.kind().is_some(),
        Intent::GoOn => measuring.laying().is_some(),
        _ => false,
    }
}

/// Follows wishes that are about tools and the pointer, once what is shown is what the hand holds.
pub fn follow(
    mut intents: MessageReader<Intent>,
    (hand, shown, shape): (Res<Hand>, Res<Shown>, Res<Shape>),
    glass: Res<Glass>,
    (mut measuring, mut pointer, mut texts): (ResMut<Measuring>, ResMut<Pointer>, ResMut<Texts>),
    (mut reader, waker): (ResMut<Reader>, Res<Waker>),
    mut version: Local<Option<Arc<Exhibit>>>,
) {
    let mut ask = |laid: &Laid| -> Option<()> {
        let errand = Errand::Tool {
            number: laid.number,
            tool: laid.tool.clone(),
            screen_mm: laid.screen_mm,
        };
        let scene = read_on(hand.exhibit(), &shown.scene, &laid.on)?;
        reader.ask(hand.exhibit().clone(), scene, errand, &waker);
        Some(())
    };
    let is_same = |version: &Arc<Exhibit>| Arc::ptr_eq(version, hand.exhibit());
    if !version.as_ref().is_some_and(is_same) {
        // What was read of the files before may not be so any more.
        if version.is_some() && !measuring.laid().is_empty() {
            let laid = measuring.reread().to_vec();
            for laid in laid.iter().filter(|laid| ask(laid).is_none()) {
                measuring.hear(laid.number, Said::Nothing(Why::Gone));
            }
        }
        *version = Some(hand.exhibit().clone());
    }
    for intent in intents.read() {
        match *intent {
            Intent::StepTool(by) => {
                measuring.step(by);
                texts.notice = None;
            }
            Intent::Tool(kind) => measuring.take(kind),
            Intent::TakeBack => measuring.take_back(),
            Intent::Home => {
                measuring.clear();
                pointer.rest();
            }
            Intent::ReadOut => pointer.switch(),
            Intent::Drag { .. } => measuring.bypass_change_detection().forget_double_click(),
            intent if is_for_tool(&measuring, intent) => {
                let view = View::new(&shown, &shape, glass.size);
                let laid = match intent {
                    // A sheet that is being turned is not measured.
                    Intent::Tap(at) if !hand.is_moving() => {
                        let seen = view.seen(&shown, marks::px(at, glass.size));
                        seen.and_then(|seen| {
                            let scene = &view.sheets[seen.sheet].scene;
                            measuring.lay(on(&shown.exhibit, scene, seen.side), &seen)
                        })
                    }
                    Intent::TrueSize { .. } => measuring.end_by_click(),
                    Intent::GoOn => measuring.end(),
                    _ => None,
                };
                if let Some(laid) = laid {
                    ask(laid);
                }
            }
            _ => {}
        }
    }
    if measuring.is_idle() && !pointer.is_read() {
        reader.bypass_change_detection().rest();
    }
}

/// Reads what the tools say that another machine laid, each once.
pub fn ask_for_told(
    (hand, shown, waker): (Res<Hand>, Res<Shown>, Res<Waker>),
    (mut measuring, mut reader): (ResMut<Measuring>, ResMut<Reader>),
    mut asked: Local<Vec<u64>>,
) {
    let measuring = measuring.bypass_change_detection();
    asked.retain(|number| measuring.laid().iter().any(|laid| laid.number == *number));
    let new: Vec<Laid> = measuring
        .laid()
        .iter()
        .filter(|laid| laid.said == Said::Waiting && !asked.contains(&laid.number))
        .cloned()
        .collect();
    for laid in new {
        asked.push(laid.number);
        match read_on(hand.exhibit(), &shown.scene, &laid.on) {
            Some(scene) => {
                let errand = Errand::Tool {
                    number: laid.number,
                    tool: laid.tool,
                    screen_mm: laid.screen_mm,
                };
                reader.ask(hand.exhibit().clone(), scene, errand, &waker);
            }
            None => measuring.hear(laid.number, Said::Nothing(Why::Gone)),
        }
    }
}

/// The side that a scene without a comparison shows, or the other one.
fn on(exhibit: &Exhibit, scene: &Scene, side: SideName) -> OnSide {
    let drawing = exhibit.drawing_of(scene);
    OnSide {
        drawing: drawing.id.clone(),
        side,
        state: scene.state.map(|state| drawing.states[state].id.clone()),
    }
}

/// The scene that shows a side, otherwise as `like`; `None` where the exhibit has it no more.
fn read_on(exhibit: &Exhibit, like: &Scene, on: &OnSide) -> Option<Scene> {
    let drawing = exhibit.drawings.iter().position(|d| d.id == on.drawing)?;
    let state = match &on.state {
        Some(id) => Some(exhibit.drawings[drawing].state(id)?.0),
        None => None,
    };
    let mut scene = Scene {
        drawing,
        side: on.side,
        state,
        compare: None,
        ..like.clone()
    };
    if drawing != like.drawing {
        scene.overlays.clear();
        scene.categories.clear();
    }
    Some(scene)
}

/// Takes in what was read.
pub fn hear(
    mut reader: ResMut<Reader>,
    (mut measuring, mut pointer): (ResMut<Measuring>, ResMut<Pointer>),
) {
    for answer in reader.bypass_change_detection().answers() {
        match answer {
            Answer::Tool(number, said) => measuring.hear(number, said),
            Answer::Under(place, under) => pointer.hear(place, under),
        }
    }
}

/// Lays what is measured over the picture.
pub fn lay(
    (measuring, pointer, shown, shape): (Res<Measuring>, Res<Pointer>, Res<Shown>, Res<Shape>),
    (glass, speech): (Res<Glass>, Speech),
    mut marks: ResMut<Marks>,
) {
    let spoken = speech.spoken();
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    let surface = shape.of(drawing).map(|surface| &**surface);
    let picture = (shown.aspect, glass.size);
    let mut wanted = Vec::new();
    let empty = measuring.laid().is_empty() && measuring.laying().is_none();
    let sheets = if empty {
        Vec::new()
    } else {
        marks::in_view(&shown)
    };
    for (number, sheet) in sheets.iter().enumerate() {
        let is_here = |drawing_id: &str, side| drawing_id == drawing.id && side == sheet.side;
        let seen = |places: &[DVec2], closed| -> Option<Vec<DVec2>> {
            let line = marks::on_sheet(drawing, surface, sheet.side, places, closed);
            line.iter().map(|point| sheet.ndc(*point)).collect()
        };
        let draw = |wanted: &mut Vec<Mark>,
                    places: &[DVec2],
                    line: &[DVec2],
                    closed: bool|
         -> Option<Vec<DVec2>> {
            let part = &sheet.lying.part;
            let line = seen(line, closed)?;
            wanted.extend(marks::lines(&line, closed, part, picture, Ink::Measured));
            let places: Option<Vec<DVec2>> = places
                .iter()
                .map(|place| seen(&[*place], false)?.pop())
                .collect();
            let shows = |at: &DVec2| part.shows(*at, shown.aspect);
            let places: Vec<DVec2> = places?.into_iter().filter(shows).collect();
            wanted.extend(places.iter().map(|at| Mark::Ring {
                middle: marks::px(*at, glass.size),
                ink: Ink::Measured,
            }));
            Some(places)
        };
        for laid in measuring.laid() {
            if !is_here(&laid.on.drawing, laid.on.side) {
                continue;
            }
            let (line, closed) = outline(laid.kind, &laid.places);
            let places = draw(&mut wanted, &laid.places, &line, closed);
            let is_own = laid.sheet == number || laid.sheet >= sheets.len();
            let last = places.and_then(|places| places.last().copied());
            if let Some(at) = last.filter(|_| is_own) {
                wanted.push(Mark::Words {
                    at: marks::px(at, glass.size),
                    text: phrases::label(laid, spoken),
                    is_centred: false,
                });
            }
        }
        let laying = measuring.laying().zip(measuring.kind());
        if let Some((laying, kind)) = laying.filter(|(l, _)| is_here(&l.on.drawing, l.on.side)) {
            // To where the next place would be.
            let next = pointer.seen().filter(|seen| seen.side == laying.on.side);
            let mut places = laying.places.clone();
            places.extend(next.map(|seen| seen.mm));
            let (line, closed) = outline(kind, &places);
            draw(&mut wanted, &laying.places, &line, closed);
        }
    }
    if marks.measured != wanted {
        marks.measured = wanted;
    }
}

/// The line that is drawn through the places of a tool, and whether it is closed.
fn outline(kind: Kind, places: &[DVec2]) -> (Vec<DVec2>, bool) {
    match (kind, places) {
        (Kind::Lines, &[a, b]) => (measuring::rectangle([a, b]), true),
        // Nothing lies between two discs.
        (Kind::Difference, _) => (Vec::new(), false),
        _ => (places.to_vec(), kind.is_closed()),
    }
}

#[cfg(test)]
mod tests {
    use std::{
        fs,
        time::{Duration, Instant},
    };

    use bevy::window::WindowEvent;

    use super::*;
    use crate::{
        maps::encode,
        optics::tier::Tier,
        visitor::{
            controls::{
                self, Interface,
                draw::{Languages, ProgramWords},
            },
            hand::Picture,
            input::{Devices, Ground},
            pointing::point,
        },
    };

    const SIZE: Vec2 = Vec2::new(400.0, 200.0);
    /// How long a small picture may take to be read on a slow machine.
    const PATIENCE: Duration = Duration::from_secs(60);

    /// A sheet of 200 × 100 mm with two sides, in a window that it fills.
    fn app(compare: &str) -> (tempfile::TempDir, App) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (name, grey) in [("recto.png", 200), ("verso.png", 40)] {
            let pixels = vec![[grey; 3]; 40 * 20];
            encode::save_png_rgb8(&folder.path().join(name), 40, 20, &pixels, None)
                .expect("written");
        }
        let manifest = format!(
            "[exhibit]\ntitle = \"One sheet\"\n[[drawing]]\nid = \"sheet\"\n\
             size_mm = [200.0, 100.0]\nrecto.albedo = \"recto.png\"\n\
             verso.albedo = \"verso.png\"\n[[scene]]\nid = \"scene\"\ndrawing = \"sheet\"\n\
             camera = {{ centre_mm = [100, 50], width_mm = 200 }}\n{compare}\n"
        );
        fs::write(folder.path().join("exhibit.toml"), manifest).expect("written");
        let (exhibit, _) = Exhibit::read(folder.path()).expect("a sound exhibit");
        let picture = Picture {
            aspect: 2.0,
            width_mm: 400.0,
            measured: true,
        };
        let hand = Hand::new(Arc::new(exhibit), 0, Tier::Draft, picture, true);
        let mut app = App::new();
        app.insert_resource(Glass {
            size: SIZE,
            pixels: SIZE.as_uvec2(),
            ..Glass::default()
        });
        let mut devices = Devices::default();
        devices.resize(SIZE, 1.0);
        app.insert_resource(hand.shown())
            .insert_resource(Shape::flat(hand.drawing()))
            .insert_resource(hand)
            .insert_resource(devices)
            .insert_resource(Waker(Arc::new(|| {})))
            .insert_resource(Interface::new(true, controls::Reading::default()))
            .init_resource::<ProgramWords>()
            .init_resource::<Languages>()
            .init_resource::<Measuring>()
            .init_resource::<Pointer>()
            .init_resource::<Texts>()
            .init_resource::<Reader>()
            .init_resource::<Marks>()
            .add_message::<Intent>()
            .add_systems(Update, (show, follow, hear, point, lay).chain());
        (folder, app)
    }

    fn show(hand: Res<Hand>, mut shown: ResMut<Shown>) {
        *shown = hand.shown();
    }

    fn wish(app: &mut App, intent: Intent) {
        app.world_mut().write_message(intent);
        app.update();
    }

    /// Clicks on a place in mm from the top left corner of the side in view.
    fn click(app: &mut App, x: f64, y: f64) {
        wish(
            app,
            Intent::Tap(DVec2::new(x / 100.0 - 1.0, 1.0 - y / 50.0)),
        );
    }

    fn points_at(app: &mut App, x: f32, y: f32) {
        let event = WindowEvent::CursorMoved(CursorMoved {
            window: Entity::PLACEHOLDER,
            position: Vec2::new(x, y),
            delta: None,
        });
        let mut devices = app.world_mut().resource_mut::<Devices>();
        let laid = controls::Laid::default();
        let ground = Ground {
            controls: &laid,
            compare: &|_| false,
        };
        devices.take(&event, Duration::ZERO, ground, |_| {});
        app.update();
    }

    fn until<T>(app: &mut App, look: impl Fn(&App) -> Option<T>) -> T {
        let begun = Instant::now();
        loop {
            if let Some(found) = look(app) {
                return found;
            }
            assert!(begun.elapsed() < PATIENCE, "it never comes");
            std::thread::sleep(Duration::from_millis(5));
            app.update();
        }
    }

    fn last(app: &App) -> Option<Laid> {
        let laid = app.world().resource::<Measuring>().laid().last()?;
        (laid.said != Said::Waiting).then(|| laid.clone())
    }

    fn words(app: &App) -> Vec<String> {
        let marks = &app.world().resource::<Marks>().measured;
        let words = marks.iter().filter_map(|mark| match mark {
            Mark::Words { text, .. } => Some(text.clone()),
            _ => None,
        });
        words.collect()
    }

    #[test]
    fn a_ruler_measures_where_it_was_laid_and_goes_with_its_side() {
        let (_folder, mut app) = app("");
        click(&mut app, 20.0, 50.0);
        assert_eq!(last(&app), None, "no tool is in the hand");
        wish(&mut app, Intent::StepTool(1));
        click(&mut app, 20.0, 50.0);
        click(&mut app, 180.0, 50.0);
        let laid = until(&mut app, last);
        let Said::Read(reading) = &laid.said else {
            panic!("{:?}", laid.said)
        };
        let [value, sigma] = [reading.values[0].value, reading.values[0].sigma].map(Option::unwrap);
        assert!((value - 160.0).abs() < 1e-6, "{value}");
        // Pixels of half a millimetre on the screen, and of five in the picture.
        assert!(sigma > 0.5 && sigma < 5.0, "{sigma}");
        assert_eq!(words(&app), [reading.values[0].words()]);
        let marks = app.world().resource::<Marks>().measured.clone();
        assert!(marks.contains(&Mark::Line {
            from: Vec2::new(40.0, 100.0),
            to: Vec2::new(360.0, 100.0),
            ink: Ink::Measured,
        }));
        // The other side does not have it, and a turn back shows it again.
        for (side, count) in [(SideName::Verso, 0), (SideName::Recto, 1)] {
            app.world_mut().resource_mut::<Hand>().apply(Intent::Flip);
            app.update();
            assert_eq!(app.world().resource::<Shown>().scene.side, side);
            app.update();
            assert_eq!(words(&app).len(), count);
        }
    }

    #[test]
    fn a_click_beside_the_sheet_lays_nothing() {
        let (_folder, mut app) = app("");
        wish(
            &mut app,
            Intent::Zoom {
                at: DVec2::ZERO,
                factor: 0.5,
            },
        );
        wish(&mut app, Intent::StepTool(1));
        click(&mut app, -5.0, 50.0);
        assert!(app.world().resource::<Measuring>().laying().is_none());
        click(&mut app, 100.0, 50.0);
        assert!(app.world().resource::<Measuring>().laying().is_some());
    }

    #[test]
    fn a_side_without_heights_says_why_there_is_no_profile() {
        let (_folder, mut app) = app("");
        for _ in 0..5 {
            wish(&mut app, Intent::StepTool(1));
        }
        click(&mut app, 20.0, 50.0);
        click(&mut app, 180.0, 50.0);
        let laid = until(&mut app, last);
        assert_eq!(laid.kind, Kind::Profile);
        assert_eq!(laid.said, Said::Nothing(Why::NoHeight));
    }

    #[test]
    fn the_pointer_reads_the_side_that_it_points_at() {
        let (_folder, mut app) = app("");
        points_at(&mut app, 100.0, 50.0);
        assert!(
            app.world().resource::<Pointer>().under().is_none(),
            "nobody asked"
        );
        wish(&mut app, Intent::ReadOut);
        let under = |app: &App| Some(app.world().resource::<Pointer>().under()?.clone().unwrap());
        let read = until(&mut app, under);
        assert_eq!(read.place_mm, DVec2::new(50.0, 25.0));
        assert!(read.lab.is_some_and(|[l, ..]| l > 80.0), "{read:?}");
        app.world_mut().resource_mut::<Hand>().apply(Intent::Flip);
        app.update();
        let dark = |app: &App| under(app).filter(|under| under.lab.is_some_and(|[l, ..]| l < 20.0));
        until(&mut app, dark);
        // Beside the sheet nothing lies under it.
        points_at(&mut app, -50.0, 50.0);
        assert!(app.world().resource::<Pointer>().under().is_none());
    }

    #[test]
    fn one_pointer_is_on_both_sides() {
        let beside = "compare = { mode = \"side-by-side\", of = [\"side:recto\", \"side:verso\"] }";
        let (_folder, mut app) = app(beside);
        // Cells of 200 × 200 pixels, whose sheets are a pixel to the mm.
        points_at(&mut app, 30.0, 90.0);
        let [Mark::Ring { middle, .. }] = app.world().resource::<Marks>().pointer[..] else {
            panic!("{:?}", app.world().resource::<Marks>().pointer)
        };
        // The sheet is turned over about its upright axis: left is right.
        assert!(middle.distance(Vec2::new(370.0, 90.0)) < 1e-3, "{middle}");
        points_at(&mut app, 370.0, 90.0);
        let [Mark::Ring { middle, .. }] = app.world().resource::<Marks>().pointer[..] else {
            panic!("no ring on the recto")
        };
        assert!(middle.distance(Vec2::new(30.0, 90.0)) < 1e-3, "{middle}");
        points_at(&mut app, 30.0, 10.0);
        assert!(
            app.world().resource::<Marks>().pointer.is_empty(),
            "beside the sheet"
        );
    }
}
