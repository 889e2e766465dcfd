//! The visitor: wishes move the hand, and the real window shows it, rests and reloads.

#[path = "app/hand.rs"]
mod hand;
#[path = "app/hotspots.rs"]
mod hotspots;
#[path = "app/monkey.rs"]
mod monkey;
#[cfg(target_os = "linux")]
#[path = "support/screen.rs"]
mod screen;
#[path = "app/session.rs"]
mod session;
#[cfg(target_os = "linux")]
#[path = "app/trials.rs"]
mod trials;
#[path = "app/visit.rs"]
mod visit;
#[path = "app/week.rs"]
mod week;
#[cfg(target_os = "linux")]
#[path = "app/window.rs"]
mod window;
#[path = "app/words.rs"]
mod words;

use std::{fs, path::Path};

use recto::maps::encode::save_png_rgb8;

/// An exhibit with two drawings, one of them with two sides, a state and two overlays.
const MANIFEST: &str = r##"
[exhibit]
title = "Two sheets"

[[drawing]]
id = "sheet"
size_mm = [300.0, 200.0]
recto.albedo = "paper.png"
verso.albedo = "paper.png"
[[drawing.state]]
id = "before"
title = "Before 1998"
recto.albedo = "paper.png"
[[drawing.overlay]]
id = "damage"
side = "recto"
kind = "categorical"
file = "paper.png"
legend = [{ colour = "#d55e00", label = "Tear" }]
[[drawing.overlay]]
id = "uv"
side = "recto"
kind = "picture"
file = "paper.png"

[[drawing.hotspot]]
id = "field"
title = "The field"
polygon_mm = [[30, 30], [130, 30], [130, 130], [30, 130]]
scene = "detail"
[[drawing.hotspot]]
id = "house"
title = "The house"
text = "It stands in the field."
polygon_mm = [[60, 60], [90, 60], [75, 90]]
[[drawing.hotspot]]
id = "seal"
title = "The seal"
side = "verso"
polygon_mm = [[10, 10], [60, 10], [60, 60], [10, 60]]

[[drawing]]
id = "page"
size_mm = [200.0, 300.0]
recto.albedo = "paper.png"
verso.albedo = "paper.png"
verso.register = { flip = "vertical" }

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

[[scene]]
id = "page"
drawing = "page"
lamps = ["left"]
"##;

/// Writes the exhibit into `folder`.
fn write_exhibit(folder: &Path) {
    draw_paper(&folder.join("paper.png"), 200);
    fs::write(folder.join("exhibit.toml"), MANIFEST).expect("the manifest is written");
}

/// Even paper of this grey.
fn draw_paper(path: &Path, grey: u8) {
    const SIDE: u32 = 16;
    let pixels = [[grey; 3]; (SIDE * SIDE) as usize];
    save_png_rgb8(path, SIDE, SIDE, &pixels, None).expect("the picture is written");
}
