//! Plots of a report: their marks have to lie where their values are.

use glam::DVec2;
use recto::{
    colour::{format_hex, srgb8_from_linear},
    prepare::{
        LampFound,
        colour::{
            chart::{COLORCHECKER24, linear_from_lab_d50},
            correct::{Correction, Fitted, Model},
        },
        report::plots,
        residuals::Residuals,
        stereo::left_out::RelitOne,
    },
};

use super::page::{self, Element};

const BLUE: &str = "#0072b2";
const VERMILLION: &str = "#d55e00";
/// Places in drawings are rounded to this.
const ROUNDED: f64 = 0.011;

fn drawn(figure: &str) -> Vec<Element> {
    let all = page::read(figure).unwrap_or_else(|fault| panic!("{fault}"));
    let svg = all.iter().find(|e| e.name == "svg").expect("a drawing");
    assert_eq!(svg.get("role"), "img");
    assert!(svg.get("aria-label").len() > 20);
    assert!(all.iter().any(|e| e.name == "figcaption"));
    all
}

/// The marks of this kind whose tooltips have these words, in their order.
fn marks<'e>(all: &'e [Element], name: &str, words: &str) -> Vec<&'e Element> {
    let tips = all.iter().filter(|e| e.name == "title");
    let tips = tips.filter(|tip| tip.text.contains(words));
    let of = tips.map(|tip| &all[tip.parent.expect("a mark")]);
    of.filter(|mark| mark.name == name).collect()
}

pub fn lamps() -> Vec<LampFound> {
    let lamp = |azimuth_deg, elevation_deg, intensity| LampFound {
        azimuth_deg,
        elevation_deg,
        intensity: Some(intensity),
    };
    vec![
        lamp(0.0, 30.0, 1.0),
        lamp(90.0, 45.0, 0.5),
        lamp(200.0, 60.0, 0.8),
        lamp(330.0, 20.0, 0.25),
    ]
}

/// Whether each lamp lies where it should, as large as it should be, with its number next to it.
fn lamps_agree(figure: &str, lamps: &[LampFound]) -> bool {
    let all = drawn(figure);
    let rim = all.iter().find(|e| e.name == "circle").expect("a rim");
    let at = |e: &Element| DVec2::new(e.number("cx"), e.number("cy"));
    let (middle, radius) = (at(rim), rim.number("r"));
    let area = |i: usize| {
        let words = format!("Lamp {}:", i + 1);
        marks(&all, "circle", &words)[0].number("r").powi(2)
    };
    let largest = (0..lamps.len()).map(area).fold(0.0, f64::max);
    let text = |words: &str| {
        let found = all.iter().find(|e| e.name == "text" && e.text == words);
        let found = found.expect("a number");
        DVec2::new(found.number("x"), found.number("y"))
    };
    lamps.iter().enumerate().all(|(i, lamp)| {
        let mark = marks(&all, "circle", &format!("Lamp {}:", i + 1))[0];
        let angle = lamp.azimuth_deg.to_radians();
        let towards = DVec2::new(angle.cos(), -angle.sin());
        let wanted = middle + towards * radius * (1.0 - lamp.elevation_deg / 90.0);
        let share = area(i) / largest;
        let number = text(&(i + 1).to_string());
        wanted.distance(at(mark)) < 2.0 * ROUNDED
            && (share - lamp.intensity.expect("one")).abs() < 0.01
            && number.distance(at(mark)) < 15.0
    })
}

#[test]
fn lamps_are_drawn_where_they_stand() {
    let right = lamps();
    let figure = plots::lamps(&right);
    assert!(lamps_agree(&figure, &right));
    let mut exchanged = right.clone();
    exchanged.swap(1, 2);
    assert!(!lamps_agree(&figure, &exchanged));
    let mut turned = right.clone();
    for lamp in &mut turned {
        (lamp.azimuth_deg, lamp.elevation_deg) = (lamp.elevation_deg, lamp.azimuth_deg);
    }
    assert!(!lamps_agree(&figure, &turned));
    let mut mirrored = right.clone();
    for lamp in &mut mirrored {
        lamp.azimuth_deg = -lamp.azimuth_deg;
    }
    assert!(!lamps_agree(&figure, &mirrored));
    let mut dimmed = right.clone();
    (dimmed[1].intensity, dimmed[2].intensity) = (dimmed[2].intensity, dimmed[1].intensity);
    assert!(!lamps_agree(&figure, &dimmed));
    // By a grey card all are alike, and hundreds are drawn too.
    let card = |i: usize| LampFound {
        azimuth_deg: 3.0 * i as f64,
        elevation_deg: 40.0,
        intensity: None,
    };
    let many: Vec<LampFound> = (0..300).map(card).collect();
    let all = drawn(&plots::lamps(&many));
    let radii: Vec<&str> = marks(&all, "circle", "Lamp")
        .iter()
        .map(|e| e.get("r"))
        .collect();
    assert_eq!(radii.len(), 300);
    assert!(radii.iter().all(|r| *r == radii[0]));
    drawn(&plots::lamps(&[]));
}

/// Many small ones, and a long tail.
pub fn left_over() -> (Residuals, [f64; 2]) {
    let mut residuals = Residuals::default();
    for i in 0..10_000 {
        let share = f64::from(i) / 10_000.0;
        residuals.add((0.0102 + 0.08 * share.powi(3)) as f32);
    }
    let figures = [residuals.quantile(0.5), residuals.quantile(0.95)];
    (residuals, figures)
}

/// Whether half of what is drawn lies to the left of the firm line and 95 % to the left of the
/// dashed one, and whether bars lie where the marks of the axis say.
fn histogram_agrees(figure: &str) -> bool {
    let all = drawn(figure);
    let bars = marks(&all, "rect", "of places");
    let area = |until: f64| -> f64 {
        let each = bars.iter().map(|bar| {
            let width = (until - bar.number("x")).clamp(0.0, bar.number("width"));
            width * bar.number("height")
        });
        each.sum()
    };
    let line = |dashed: bool| {
        let lines = all.iter().filter(|e| e.get("stroke") == VERMILLION);
        let mut own = lines.filter(|e| e.get("stroke-dasharray").is_empty() != dashed);
        own.next().expect("a line").number("x1")
    };
    let share = |dashed| area(line(dashed)) / area(f64::INFINITY);
    // The value that a bar begins at, by its tooltip and by the axis.
    let base = bars[0].number("y") + bars[0].number("height");
    let ticks: Vec<(f64, f64)> = all
        .iter()
        .filter(|e| e.name == "text" && e.get("text-anchor") == "middle")
        .filter(|e| (10.0..25.0).contains(&(e.number("y") - base)))
        .filter_map(|e| Some((e.text.parse().ok()?, e.number("x"))))
        .collect();
    let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
    let pitch = (last.1 - first.1) / (last.0 - first.0);
    let placed = bars.iter().all(|bar| {
        let tip = all.iter().find(|e| {
            e.name == "title"
                && e.parent
                    .is_some_and(|i| std::ptr::eq(&raw const all[i], *bar))
        });
        let text = &tip.expect("a tooltip").text;
        let from: f64 = text
            .split(' ')
            .next()
            .expect("a number")
            .parse()
            .expect("one");
        (first.1 + pitch * (from - first.0) - bar.number("x")).abs() < 0.2
    });
    placed && (share(false) - 0.5).abs() < 0.06 && (share(true) - 0.95).abs() < 0.02
}

#[test]
fn what_is_left_over_is_drawn_with_its_median() {
    let (residuals, [median, most]) = left_over();
    assert!(histogram_agrees(&plots::residuals(
        "Recto",
        &residuals,
        [median, most]
    )));
    assert!(!histogram_agrees(&plots::residuals(
        "Recto",
        &residuals,
        [most, median]
    )));
    let text = plots::residuals("Recto", &residuals, [median, most]);
    assert!(
        text.contains("50 % of them 2.0 %") && text.contains("95 % of them 7.8 %"),
        "{text}"
    );
    // With three lamps nothing is left over.
    let mut none = Residuals::default();
    (0..100).for_each(|_| none.add(0.0));
    assert_eq!(plots::residuals("Recto", &none, [0.0; 2]), "");
    assert_eq!(
        plots::residuals("Recto", &Residuals::default(), [0.0; 2]),
        ""
    );
    // All is wrong everywhere, and by next to nothing.
    for share in [f32::INFINITY, 0.0011] {
        let mut all = Residuals::default();
        (0..100).for_each(|_| all.add(share));
        let figures = [all.quantile(0.5), all.quantile(0.95)];
        drawn(&plots::residuals("Verso", &all, figures));
    }
}

pub fn fitted() -> Fitted {
    Fitted {
        correction: Correction::none(),
        before: (0..24).map(|i| 4.0 + 0.5 * f64::from(i)).collect(),
        after: (0..24).map(|i| 0.3 + 0.05 * f64::from(23 - i)).collect(),
        left_out: vec![(Model::Linear, 1.0)],
    }
}

fn lab() -> Vec<[f64; 3]> {
    COLORCHECKER24.iter().map(|patch| patch.lab).collect()
}

/// Whether bars are as long as ΔE00, before with a dashed rim and after without, in the patches'
/// colours.
fn chart_agrees(figure: &str, fitted: &Fitted, lab: &[[f64; 3]]) -> bool {
    let all = drawn(figure);
    // Without those of the legend.
    let bars: Vec<&Element> = marks(&all, "rect", ": ");
    assert_eq!(bars.len(), 48);
    let of = |dashed: bool| {
        let own = bars
            .iter()
            .filter(move |e| e.get("stroke-dasharray").is_empty() != dashed);
        own.copied().collect::<Vec<&Element>>()
    };
    let scale = of(true)[0].number("width") / fitted.before[0];
    let long = |bars: &[&Element], values: &[f64]| {
        let mut pairs = bars.iter().zip(values);
        pairs.all(|(bar, value)| (bar.number("width") - scale * value).abs() < 0.02)
    };
    let colours = lab
        .iter()
        .map(|lab| format_hex(srgb8_from_linear(linear_from_lab_d50(*lab))));
    let mut coloured = bars.chunks(2).zip(colours);
    long(&of(true), &fitted.before)
        && long(&of(false), &fitted.after)
        && coloured.all(|(two, colour)| two.iter().all(|bar| bar.get("fill") == colour))
        && bars.is_sorted_by(|a, b| a.number("y") < b.number("y"))
}

#[test]
fn patches_are_drawn_in_their_colours() {
    let (right, lab) = (fitted(), lab());
    let figure = plots::chart(&right, &lab);
    assert!(chart_agrees(&figure, &right, &lab));
    let exchanged = Fitted {
        before: right.after.clone(),
        after: right.before.clone(),
        ..right.clone()
    };
    assert!(!chart_agrees(&figure, &exchanged, &lab));
    let mut moved = right.clone();
    moved.after.swap(3, 17);
    assert!(!chart_agrees(&figure, &moved, &lab));
    let mut recoloured = lab.clone();
    recoloured.swap(3, 17);
    assert!(!chart_agrees(&figure, &right, &recoloured));
    assert!(figure.contains("13 blue") && figure.contains("ΔE00"));
}

pub fn photographs() -> Vec<RelitOne> {
    let one = |lamp, computed, neighbours| RelitOne {
        lamp,
        computed,
        neighbours,
    };
    vec![one(0, 0.02, 0.11), one(3, 0.05, 0.09), one(6, 0.13, 0.08)]
}

/// Whether full bars are as high as what is computed is off, and hollow ones as the neighbours.
fn photographs_agree(figure: &str, each: &[RelitOne]) -> bool {
    let all = drawn(figure);
    let bars = marks(&all, "rect", "Photograph");
    assert_eq!(bars.len(), 2 * each.len());
    let scale = bars[0].number("height") / each[0].computed;
    let high = |bar: &Element, share: f64| (bar.number("height") - scale * share).abs() < 0.05;
    bars.chunks(2).zip(each).all(|(two, one)| {
        let number = (one.lamp + 1).to_string();
        let middle = 0.5 * (two[0].number("x") + two[1].number("x") + two[1].number("width"));
        let label = all
            .iter()
            .any(|e| e.name == "text" && e.text == number && (e.number("x") - middle).abs() < 1.0);
        let forms = two[0].get("fill") == BLUE && two[1].get("fill") == "#fff";
        label && forms && high(two[0], one.computed) && high(two[1], one.neighbours)
    })
}

#[test]
fn left_out_photographs_are_drawn_beside_their_neighbours() {
    let right = photographs();
    let figure = plots::left_out("Recto", &right);
    assert!(photographs_agree(&figure, &right));
    let mut exchanged = right.clone();
    for one in &mut exchanged {
        (one.computed, one.neighbours) = (one.neighbours, one.computed);
    }
    assert!(!photographs_agree(&figure, &exchanged));
    let mut moved = right.clone();
    (moved[0].lamp, moved[2].lamp) = (moved[2].lamp, moved[0].lamp);
    assert!(!photographs_agree(&figure, &moved));
    assert!(figure.contains("<td>7<td>13.0 %<td>8.0 %"), "{figure}");
    assert_eq!(plots::left_out("Recto", &[]), "");
}
