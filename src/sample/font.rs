//! Letters of single strokes on a grid of 4 × 6, for labels.

use glam::Vec2;

use super::hand::{Hand, Pen};

/// Strokes of each glyph: points of two digits (x, y up), strokes separated by `|`.
const GLYPHS: &[(char, &str)] = &[
    ('a', "00 26 40|12 32"),
    ('b', "00 06 36 45 44 33 03|33 42 41 30 00"),
    ('c', "45 36 16 05 01 10 30 41"),
    ('d', "00 06 26 44 42 20 00"),
    ('e', "40 00 06 46|03 33"),
    ('f', "00 06 46|03 33"),
    ('g', "45 36 16 05 01 10 30 41 43 23"),
    ('h', "00 06|40 46|03 43"),
    ('i', "20 26"),
    ('j', "46 41 30 10 01"),
    ('k', "00 06|46 03 40"),
    ('l', "06 00 40"),
    ('m', "00 06 23 46 40"),
    ('n', "00 06 40 46"),
    ('o', "10 01 05 16 36 45 41 30 10"),
    ('p', "00 06 36 45 44 33 03"),
    ('q', "10 01 05 16 36 45 41 30 10|21 40"),
    ('r', "00 06 36 45 44 33 03|23 40"),
    ('s', "45 36 16 05 04 13 33 42 41 30 10 01"),
    ('t', "06 46|20 26"),
    ('u', "06 01 10 30 41 46"),
    ('v', "06 20 46"),
    ('w', "06 10 23 30 46"),
    ('x', "00 46|06 40"),
    ('y', "06 23 46|23 20"),
    ('z', "06 46 00 40"),
    ('0', "10 01 05 16 36 45 41 30 10"),
    ('1', "15 26 20"),
    ('2', "05 16 36 45 44 00 40"),
    ('3', "05 16 36 45 44 33 23|33 42 41 30 10 01"),
    ('4', "30 36 02 42"),
    ('5', "46 06 03 33 42 41 30 00"),
    ('6', "45 36 16 05 01 10 30 41 42 33 03"),
    ('7', "06 46 20"),
    ('8', "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33"),
    ('9', "01 10 30 41 45 36 16 05 04 13 43"),
    ('-', "13 33"),
    ('/', "00 46"),
];

/// Writes a text with its base line's start at a place; letters are `height_mm` high. Signs
/// without a glyph leave a space.
pub fn write(hand: &mut Hand, pen: Pen, text: &str, at: Vec2, height_mm: f32) {
    let unit = height_mm / 6.0;
    let mut left = at.x;
    for sign in text.chars().flat_map(char::to_lowercase) {
        let glyph = GLYPHS
            .iter()
            .find(|(name, _)| *name == sign)
            .map_or("", |(_, strokes)| strokes);
        for stroke in glyph.split('|') {
            let points: Vec<Vec2> = stroke
                .split_whitespace()
                .map(|pair| {
                    let digit = |i: usize| f32::from(pair.as_bytes()[i] - b'0');
                    Vec2::new(left + unit * digit(0), at.y - unit * digit(1))
                })
                .collect();
            hand.line(pen, &points);
        }
        left += unit * 5.6;
    }
}
