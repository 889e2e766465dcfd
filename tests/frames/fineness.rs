//! A picture of fewer pixels is the same picture, a little softer.

use recto::{
    maps::encode::save_png_rgb8, optics::tier::Tier, shot::Picture, stage::fineness::Fineness,
};

use crate::room::{Fixture, darkroom, mean, picture};

const SIZE: [u32; 2] = [96, 64];
/// Means over a quarter of the picture agree to this: a pixel's row at its edge is a fiftieth of it.
const WITHIN: f64 = 0.02;
/// Of the contrast of stripes of eight pixels of the picture, so much is left at least, and no more is
/// made of them than so much.
const LEFT: f64 = 0.8;
const MADE: f64 = 1.15;

const MANIFEST: &str = r#"
[[drawing]]
id = "sheet"
size_mm = [96, 64]
recto.albedo = "recto.png"
[[lamp]]
id = "above"
kind = "distant"
lux_at_sheet = 500
elevation_deg = 90
azimuth_deg = 0
[[scene]]
id = "whole"
lamps = ["above"]
camera = { width_mm = 96 }
"#;

/// Four quarters of different greys, the last of them in upright stripes.
fn draw(path: &std::path::Path) {
    let [width, height] = SIZE;
    let grey = |x: u32, y: u32| match (x < width / 2, y < height / 2) {
        (true, true) => 220,
        (false, true) => 180,
        (true, false) => 140,
        (false, false) => [90, 170][(x / 8 % 2) as usize],
    };
    let pixels = (0..width * height).map(|k| [grey(k % width, k / width); 3]);
    let pixels: Vec<[u8; 3]> = pixels.collect();
    save_png_rgb8(path, width, height, &pixels, None).expect("the picture is written");
}

fn quarters(picture: &Picture) -> [f64; 4] {
    let [w, h] = SIZE;
    let of = |x: u32, y: u32| mean(picture, [x, y], [x + w / 2, y + h / 2]);
    [of(0, 0), of(w / 2, 0), of(0, h / 2), of(w / 2, h / 2)]
}

fn agree(a: &Picture, b: &Picture) -> bool {
    let both = quarters(a).into_iter().zip(quarters(b));
    both.into_iter().all(|(a, b)| (a / b - 1.0).abs() < WITHIN)
}

/// Light between the darkest and the lightest columns of the stripes.
fn contrast(picture: &Picture) -> f64 {
    let [w, h] = SIZE;
    let column = |x: u32| mean(picture, [x, h / 2 + 4], [x + 1, h - 4]);
    let columns: Vec<f64> = (w / 2 + 4..w - 4).map(column).collect();
    let most = columns.iter().copied().fold(0.0, f64::max);
    most - columns.iter().copied().fold(f64::INFINITY, f64::min)
}

#[test]
fn fewer_pixels_make_the_same_picture() {
    let fixture = Fixture::new(MANIFEST, |folder| draw(&folder.join("recto.png")));
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let mut at = |share: f32| {
        room.world().insert_resource(Fineness(share));
        picture(&mut room, &exhibit, &exhibit.scenes[0], Tier::Draft, SIZE)
    };
    let whole = at(1.0);
    for share in [0.8, 0.65, 0.5] {
        let part = at(share);
        assert!(part.pixels != whole.pixels, "{share}: nothing was left out");
        assert!(agree(&part, &whole), "{share}: {:?}", quarters(&part));
        let left = contrast(&part) / contrast(&whole);
        assert!((LEFT..MADE).contains(&left), "{share}: {left}");
    }
    assert_eq!(at(1.0).pixels, whole.pixels, "all of it again");

    // What would be seen if a part were not brought to the whole.
    let [w, h] = SIZE;
    let mut corner = whole.clone();
    for y in 0..h {
        for x in 0..w {
            let from = |v: u32, side: u32| (2 * v).min(side - 1);
            let from = (from(y, h) * w + from(x, w)) as usize;
            corner.pixels[(y * w + x) as usize] = whole.pixels[from];
        }
    }
    assert!(!agree(&corner, &whole));
}
