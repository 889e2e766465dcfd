//! Writing that nobody can read: a mirror-wise cursive, pen trials and accounts.

use glam::Vec2;

use super::{
    hand::{Hand, Pen},
    noise::Chance,
};

/// One line of writing.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Where it begins, in mm, on the base line.
    pub from: Vec2,
    /// Length in mm; negative runs to the left, as mirror writing does.
    pub length_mm: f32,
    /// Height of the small letters in mm.
    pub x_height_mm: f32,
    /// Slope of the base line.
    pub rise: f32,
}

/// Writes one line of cursive words.
pub fn cursive(hand: &mut Hand, pen: Pen, line: Line) {
    let way = line.length_mm.signum();
    let x = line.x_height_mm;
    let mut at = 0.0;
    while at < line.length_mm.abs() {
        let letters = 2 + (hand.chance.unit() * 6.0) as usize;
        let mut points = Vec::new();
        for _ in 0..letters {
            letter(&mut hand.chance, &mut points, &mut at, x);
        }
        let slanted: Vec<Vec2> = points
            .iter()
            .map(|p: &Vec2| {
                let lean = p.x + 0.25 * p.y;
                line.from + Vec2::new(way * lean, -p.y - line.rise * p.x)
            })
            .collect();
        hand.curve(pen, &slanted);
        if hand.chance.happens(0.35) {
            let over = line.from + Vec2::new(way * (at - x * 1.5), -x * 1.9);
            hand.line(
                pen.scaled(0.9),
                &[over, over + Vec2::new(way * x * 0.5, -0.1 * x)],
            );
        }
        at += x * hand.chance.between(0.9, 1.5);
    }
}

/// Adds the joints of one letter, in units of mm from the line's start, y up.
fn letter(chance: &mut Chance, points: &mut Vec<Vec2>, at: &mut f32, x: f32) {
    let kind = (chance.unit() * 8.0) as usize;
    let shape: &[[f32; 2]] = match kind {
        0 => &[
            [0.0, 0.1],
            [0.35, 1.0],
            [0.5, 0.1],
            [0.85, 0.95],
            [1.0, 0.1],
        ],
        1 => &[
            [0.1, 0.1],
            [0.6, 1.9],
            [0.35, 2.3],
            [0.25, 0.4],
            [0.6, 0.05],
        ],
        2 => &[
            [0.6, 0.9],
            [0.1, 0.6],
            [0.3, 0.0],
            [0.65, 0.8],
            [0.6, -1.1],
            [0.2, -1.2],
            [0.75, 0.1],
        ],
        3 => &[
            [0.5, 0.9],
            [0.05, 0.5],
            [0.4, 0.0],
            [0.7, 0.5],
            [0.45, 0.95],
            [0.85, 0.6],
        ],
        4 => &[[0.1, 0.1], [0.4, 0.95], [0.45, 0.15], [0.75, 0.1]],
        5 => &[
            [0.1, 0.4],
            [0.5, 0.7],
            [0.3, 1.0],
            [0.05, 0.5],
            [0.35, 0.0],
            [0.7, 0.2],
        ],
        6 => &[
            [0.3, 0.9],
            [0.3, -1.3],
            [0.35, 0.6],
            [0.7, 0.9],
            [0.85, 0.2],
            [0.4, 0.05],
            [0.9, 0.2],
        ],
        _ => &[
            [0.0, 0.1],
            [0.3, 0.95],
            [0.4, 0.1],
            [0.7, 0.95],
            [0.8, 0.1],
            [1.1, 0.95],
            [1.2, 0.1],
        ],
    };
    let width = shape.iter().map(|p| p[0]).fold(0.0, f32::max);
    for [u, v] in shape {
        let v = v * chance.between(0.85, 1.12);
        points.push(Vec2::new(*at + u * x * 0.8, v * x));
    }
    *at += width * x * 0.8 * chance.between(0.9, 1.1);
}

/// Strokes, crosses and rings that try a new pen.
pub fn pen_trials(hand: &mut Hand, pen: Pen, at: Vec2) {
    for i in 0..9 {
        let from = at + Vec2::new(3.2 * i as f32, 0.4 * hand.chance.centred());
        let tip = from + Vec2::new(1.2, -5.5) * hand.chance.between(0.8, 1.1);
        hand.line(
            pen.scaled(0.4 + 0.12 * i as f32).with_ends(1.1, 0.4),
            &[from, tip],
        );
    }
    let row = at + Vec2::new(0.0, 9.0);
    hand.loops(
        pen.scaled(0.7),
        &[row, row + Vec2::new(15.0, -0.8), row + Vec2::new(30.0, 0.6)],
        1.7,
        2.1,
    );
    let flourish: Vec<Vec2> = (0..60)
        .map(|i| {
            let t = i as f32 / 59.0;
            let angle = 15.0 * t;
            at + Vec2::new(14.0 + 20.0 * t, 19.0)
                + Vec2::from_angle(angle) * (5.5 * (1.0 - t) + 0.5)
        })
        .collect();
    hand.curve(pen.scaled(0.6), &flourish);
}

/// A column of sums: short words, numerals, a rule and a total.
pub fn accounts(hand: &mut Hand, pen: Pen, at: Vec2, rows: usize) {
    for row in 0..=rows {
        let total = row == rows;
        let y = at.y + 4.6 * row as f32 + if total { 1.6 } else { 0.0 };
        if !total {
            let from = Vec2::new(at.x, y);
            let length_mm = hand.chance.between(9.0, 15.0);
            cursive(
                hand,
                pen,
                Line {
                    from,
                    length_mm,
                    x_height_mm: 1.05,
                    rise: 0.01,
                },
            );
        }
        let digits = 2 + usize::from(total) + usize::from(hand.chance.happens(0.4));
        for digit in 0..digits {
            let p = Vec2::new(at.x + 25.0 - 2.1 * digit as f32, y);
            numeral(hand, pen, p);
        }
    }
    let rule = at + Vec2::new(17.0, 4.6 * rows as f32 - 1.9);
    hand.line(pen, &[rule, rule + Vec2::new(10.5, -0.3)]);
}

fn numeral(hand: &mut Hand, pen: Pen, at: Vec2) {
    let shape: &[[f32; 2]] = match (hand.chance.unit() * 6.0) as usize {
        0 => &[[0.3, 1.8], [0.4, 0.0]],
        1 => &[[0.0, 1.4], [0.4, 1.8], [0.7, 1.4], [0.0, 0.0], [0.8, 0.05]],
        2 => &[[0.4, 1.8], [0.0, 0.9], [0.4, 0.0], [0.8, 0.9], [0.4, 1.8]],
        3 => &[[0.0, 1.8], [0.7, 1.7], [0.3, 1.0], [0.7, 0.5], [0.0, -0.1]],
        4 => &[[0.8, 1.7], [0.1, 0.7], [0.4, 0.0], [0.7, 0.5], [0.1, 0.6]],
        _ => &[[0.0, 1.8], [0.8, 1.8], [0.3, -0.2]],
    };
    let points: Vec<Vec2> = shape
        .iter()
        .map(|p| at + Vec2::new(1.3 * p[0], -1.3 * p[1]))
        .collect();
    hand.curve(pen.scaled(0.9), &points);
}
