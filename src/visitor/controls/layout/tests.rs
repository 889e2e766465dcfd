use super::*;
use crate::visitor::controls::Preset;

/// As much as there ever is.
fn all() -> Facts {
    let button =
        |control, words: &str| Item::button(control, Some(Icon::Home), words.to_owned(), false);
    let slider = |control| Item {
        control,
        icon: None,
        words: "Colour 3000 K".into(),
        look: Look::Slider { value: 0.5 },
    };
    Facts {
        open: [Panel::Light, Panel::Scenes, Panel::More].into(),
        bar: (0..8)
            .map(|k| button(Control::Scene(k), "Fourteen signs"))
            .collect(),
        scenes: vec!["A scene".into(); 20],
        lamp: Some(Vec2::ZERO),
        lamp_words: "lamp 45° high, from the upper left (135°)".into(),
        presets: Preset::ALL
            .map(|p| button(Control::Preset(p), "From left"))
            .into(),
        sliders: vec![
            slider(Control::Warmth),
            slider(Control::Intensity),
            slider(Control::Through),
        ],
        list: (0..11)
            .map(|k| button(Control::Language(k), "Deutsch"))
            .collect(),
        hint: Some("Touch place after place, the last one twice".into()),
        ..Facts::default()
    }
}

/// Windows and displays: a desk's, a wall's, portrait, two of them, a table's.
fn rooms() -> Vec<Room> {
    let mut rooms = Vec::new();
    for (size, px_per_mm) in [
        ([1280.0, 800.0], 3.78),
        ([1920.0, 1080.0], 1.6),
        ([3840.0, 2160.0], 2.33),
        ([1080.0, 1920.0], 1.6),
        ([5760.0, 2160.0], 2.33),
    ] {
        for factor in [1.0, 1.3, 1.6] {
            for right_to_left in [false, true] {
                let size: Vec2 = Vec2::from(size);
                rooms.push(Room {
                    size,
                    px_per_mm,
                    reach: None,
                    text: (0.02 * size.y.min(0.75 * size.x)).max(11.0) * 0.85 * factor,
                    right_to_left,
                });
            }
        }
    }
    rooms
}

#[test]
fn everything_is_large_enough_within_the_picture_and_beside_all_else() {
    for room in rooms() {
        let laid = lay(&room, &all());
        let touched: Vec<&Widget> = laid
            .widgets
            .iter()
            .filter(|w| w.look != Look::Words)
            .collect();
        assert!(touched.len() > 20, "{room:?}");
        let said = laid.widgets.iter().find(|w| w.control == Control::Said);
        let said = said.expect("a hint").rect;
        assert!(!laid.covers(said.center()), "it is touched through");
        let least = TARGET_MM * room.px_per_mm - 0.01;
        let picture = Rect::from_corners(Vec2::ZERO, room.size).inflate(0.5);
        for (k, widget) in touched.iter().enumerate() {
            let size = widget.rect.size();
            assert!(size.min_element() >= least, "{widget:?} in {room:?}");
            let inside = picture.contains(widget.rect.min) && picture.contains(widget.rect.max);
            assert!(inside, "{widget:?} in {room:?}");
            let under = widget.rect.intersect(said);
            assert!(under.is_empty(), "{widget:?} under the hint in {room:?}");
            assert_eq!(laid.at(widget.rect.center()), Some(*widget));
            for other in &touched[..k] {
                let shared = widget.rect.intersect(other.rect);
                assert!(
                    shared.is_empty(),
                    "{widget:?} lies on {other:?} in {room:?}"
                );
            }
        }
    }
}

#[test]
fn controls_stay_within_the_reach_that_is_stated() {
    let mut room = Room {
        size: Vec2::new(1080.0, 3840.0),
        px_per_mm: 1.6,
        reach: Some([1500.0, 2900.0]),
        text: 16.0,
        right_to_left: false,
    };
    let within = |room: &Room| {
        let laid = lay(room, &all());
        let reach = [1500.0, 2900.0];
        let is_in = |w: &&Widget| w.rect.min.y >= reach[0] && w.rect.max.y <= reach[1];
        laid.widgets.iter().filter(is_in).count() == laid.widgets.len()
    };
    assert!(within(&room));
    room.reach = None;
    assert!(!within(&room), "it can fail");
}

#[test]
fn of_two_that_do_not_fit_the_one_opened_last_is_there() {
    let room = Room {
        size: Vec2::new(1280.0, 800.0),
        px_per_mm: 3.78,
        reach: None,
        text: 21.76,
        right_to_left: false,
    };
    for (latest, dial) in [(Panel::Light, true), (Panel::More, false)] {
        let facts = Facts {
            latest: Some(latest),
            ..all()
        };
        let laid = lay(&room, &facts);
        let has = |control| laid.widgets.iter().any(|w| w.control == control);
        assert_eq!(has(Control::Dial), dial);
        assert_eq!(has(Control::Language(0)), !dial);
    }
}

#[test]
fn a_window_too_small_for_fingers_has_none() {
    let room = Room {
        size: Vec2::new(320.0, 240.0),
        px_per_mm: 3.78,
        reach: None,
        text: 11.0,
        right_to_left: false,
    };
    assert_eq!(lay(&room, &all()), Laid::default());
}

#[test]
fn a_countdown_and_the_staff_s_pad_cover_all_else() {
    let room = rooms()[0];
    let countdown = vec![Item::button(Control::Stay, None, "Stay".into(), true)];
    let facts = Facts {
        countdown: Some(countdown),
        ..all()
    };
    let laid = lay(&room, &facts);
    assert_eq!(laid.widgets.len(), 1);
}

#[test]
fn signs_as_wide_as_they_are_high_have_room_in_one_line() {
    let room = Room {
        size: Vec2::new(1080.0, 1920.0),
        px_per_mm: 2.04,
        reach: None,
        text: 16.0,
        right_to_left: false,
    };
    let mut facts = all();
    for item in &mut facts.bar {
        item.words = "見どころ".into();
    }
    let laid = lay(&room, &facts);
    let mut bar = laid.widgets.iter();
    let widget = bar.find(|widget| widget.control == Control::Scene(0));
    let width = widget.expect("a bar").rect.width();
    assert!(width >= 4.0 * room.text, "{width}");
    assert!(width < 6.5 * room.text, "no wider than it needs: {width}");
}
