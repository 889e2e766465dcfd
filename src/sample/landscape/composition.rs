//! The order in which the sheet came about.

use glam::Vec2;

use super::{
    boulders, foreground, land, pens, staffage,
    terrain::{Ground, TOWN_M, Terrain},
    town,
    trees::{Habit, Tree},
    underdrawing,
    view::{View, scale_at},
    water::{self, Bridge},
};
use crate::sample::{
    grid::{Grid, Plane},
    hand::{Hand, Pen},
    noise::{Chance, Noise, smoothstep},
    script::{self, Line},
    stroke::{Layer, Stroke},
};

/// Size of the sheet, in mm.
pub const SIZE_MM: Vec2 = Vec2::new(285.0, 194.0);
/// Samples of the washes per mm; their edges are finer, from noise at full resolution.
const WASH_PER_MM: f32 = 3.0;
/// Where the line of writing stands, and its colour's pen.
const SCRIPT_AT: Vec2 = Vec2::new(136.0, 14.5);
const SCRIPT_PEN: Pen = Pen::quill(Layer::DarkInk, 0.22, 1.5);

/// What was drawn on the recto.
pub struct Drawn {
    /// Every stroke in its order.
    pub strokes: Vec<Stroke>,
    /// Darkness that the brush should give, 0…1.
    pub wash: Plane,
}

/// Draws the landscape.
pub fn draw() -> Drawn {
    let mut view = View::new(SIZE_MM);
    let foreground = foreground::grow(&mut view);
    let bridge = Bridge::build(&mut view);
    let buildings = town::build(&mut view);
    let trees = plant(&mut view);
    let boulders = boulders::lay(&mut view);

    let mut hand = Hand::new(1473);
    underdrawing::stylus(&mut hand, SIZE_MM);
    underdrawing::lead(&mut hand, &view, SIZE_MM);
    land::contours(&mut hand, &view);
    land::cracks(&mut hand, &view);
    land::banks_and_road(&mut hand, &view);
    land::fields(&mut hand, &view);
    land::ground_lines(&mut hand, &view, SIZE_MM);
    land::hatching(&mut hand, &view, SIZE_MM);
    water::draw(&mut hand, &view, SIZE_MM);
    town::draw(&mut hand, &view, &buildings);
    bridge.draw(&mut hand, &view);
    for boulder in &boulders {
        boulder.draw(&mut hand, &view);
    }
    for tree in &trees {
        tree.draw(&mut hand, &view);
    }
    land::plants(&mut hand, &view, SIZE_MM);
    for plant in &foreground {
        plant.draw(&mut hand, &view);
    }
    staffage::traveller(&mut hand, &view, 47.0, 128.0, 0.6);
    staffage::traveller(&mut hand, &view, 51.5, 131.0, -0.3);
    staffage::birds(&mut hand, pens::contour(420.0));
    let line = Line {
        from: SCRIPT_AT,
        length_mm: -47.0,
        x_height_mm: 1.1,
        rise: 0.012,
    };
    script::cursive(&mut hand, SCRIPT_PEN, line);

    Drawn {
        strokes: hand.strokes,
        wash: wash(&view),
    }
}

/// The trees, from those at the viewer's feet to dots on the plain.
fn plant(view: &mut View) -> Vec<Tree> {
    let mut trees = Vec::new();
    let mut chance = Chance::new(61);
    for [x, y, height, slender, seed] in [
        [63.0, 128.0, 46.0, 1.0, 3.0],
        [70.0, 138.0, 36.0, 1.0, 8.0],
        [-57.0, 172.0, 19.0, 0.0, 5.0],
        [-78.0, 176.0, 15.0, 0.0, 6.0],
        [-62.0, 207.0, 19.0, 0.0, 7.0],
        [-84.0, 210.0, 17.0, 0.0, 9.0],
        [-43.0, 212.0, 13.0, 0.0, 12.0],
        [-100.0, 222.0, 20.0, 0.0, 15.0],
        [-92.0, 232.0, 14.0, 0.0, 16.0],
        [-112.0, 228.0, 16.0, 0.0, 17.0],
        [-73.0, 226.0, 11.0, 0.0, 18.0],
        [-58.0, 144.0, 9.0, 0.0, 19.0],
        [-70.0, 148.0, 17.0, 0.0, 13.0],
        [-48.0, 236.0, 12.0, 0.0, 14.0],
        [66.0, 185.0, 13.0, 0.0, 10.0],
        [84.0, 196.0, 16.0, 0.0, 11.0],
    ] {
        let habit = if slender > 0.5 {
            Habit::Slender
        } else {
            Habit::Round
        };
        trees.push(Tree::plant(view, x, y, height, habit, seed as u64));
    }
    trees.push(Tree::plant(view, -33.0, 196.0, 13.0, Habit::Bare, 4));
    // Woods: clumps where noise allows, thinner with distance.
    let woods = Noise::smooth(62, 130.0, 3);
    for _ in 0..3000 {
        let y = 235.0 * (1.0 + 8.0 * chance.unit().powf(1.6));
        let x = chance.between(-0.58, 0.58) * y;
        let p = Vec2::new(x, y);
        let slope = view.terrain.slope(p);
        let in_town = p.distance(TOWN_M.truncate()) < 66.0;
        let dry =
            !in_town && view.terrain.ground(p, slope) == Ground::Soil && slope.length() < 0.62;
        let beside_river = (x - Terrain::river_x(y)).abs() - Terrain::river_half_width(y);
        let riverside = (4.0..14.0).contains(&beside_river) && chance.happens(0.35);
        let hedge = ((x + 0.4 * y) / 72.0).fract().abs() < 0.06 && chance.happens(0.5);
        let wood = woods.at(p) > 0.22;
        let single = chance.happens(0.03);
        if !dry || beside_river < 3.0 || !(wood || riverside || hedge || single) {
            continue;
        }
        let height = chance.between(8.0, 14.0) * if riverside { 1.2 } else { 1.0 };
        if height * scale_at(y) < 0.8 {
            continue;
        }
        let habit = if chance.happens(0.22) {
            Habit::Slender
        } else {
            Habit::Round
        };
        let seed = 1000 + trees.len() as u64;
        trees.push(Tree::plant(view, x, y, height, habit, seed));
    }
    trees
}

/// Where the brush goes: over the pen's shadows, broadly, and never in the sky.
fn wash(view: &View) -> Plane {
    let (w, h) = (
        (SIZE_MM.x * WASH_PER_MM) as usize,
        (SIZE_MM.y * WASH_PER_MM) as usize,
    );
    let grid = Grid::with_pixels(SIZE_MM, w, h);
    let broad = Noise::smooth(71, 24.0, 3);
    Plane::from_fn(grid, |p| {
        let distance = view.distance(p);
        let land = if distance.is_finite() { 1.0 } else { 0.25 };
        let near = 1.0 - 0.35 * smoothstep(300.0, 2500.0, distance);
        view.tone(p) * land * near * (1.0 + 0.45 * broad.at(p))
    })
    .blurred(0.6)
}
