//! The picture of the shortest manifest: a sprig of oak with two acorns, in pen over red chalk.

use glam::{Vec2, Vec3};

use super::{
    SampleError,
    grid::Grid,
    hand::{Hand, Pen, arc, inside, resampled, smooth},
    maps_out::Out,
    noise::{Noise, mix, smoothstep},
    paper::{Face, Paper},
    side::{self, Shown},
    stroke::Layer,
};

/// Size of the sheet, in mm.
pub const SIZE_MM: Vec2 = Vec2::new(120.0, 150.0);
/// Files that it has, its manifest not counted.
pub const FILES: usize = 1;
/// Resolution of the picture.
const DPI: f64 = 200.0;
/// Optical depth by channel of a thin brown wash in the shaded halves of the leaves.
const WASH: Vec3 = Vec3::new(0.12, 0.19, 0.30);
const PEN: Pen = Pen::quill(Layer::DarkInk, 0.32, 1.7);
const CHALK: Pen = Pen {
    layer: Layer::Chalk,
    width_mm: 0.7,
    tau: 0.30,
    ends: (0.5, 0.3),
    tremor_mm: 0.1,
};

/// A leaf: from its stalk to its tip, with half its width in mm.
struct Leaf {
    stalk: Vec2,
    tip: Vec2,
    half_mm: f32,
    bend: f32,
}

const LEAVES: [Leaf; 6] = [
    Leaf {
        stalk: Vec2::new(61.0, 62.0),
        tip: Vec2::new(70.0, 13.0),
        half_mm: 13.0,
        bend: 4.0,
    },
    Leaf {
        stalk: Vec2::new(60.0, 70.0),
        tip: Vec2::new(22.0, 33.0),
        half_mm: 12.0,
        bend: -5.0,
    },
    Leaf {
        stalk: Vec2::new(60.0, 74.0),
        tip: Vec2::new(103.0, 47.0),
        half_mm: 12.0,
        bend: 5.0,
    },
    Leaf {
        stalk: Vec2::new(57.0, 86.0),
        tip: Vec2::new(13.0, 80.0),
        half_mm: 11.5,
        bend: 5.0,
    },
    Leaf {
        stalk: Vec2::new(58.0, 90.0),
        tip: Vec2::new(106.0, 92.0),
        half_mm: 11.5,
        bend: -6.0,
    },
    Leaf {
        stalk: Vec2::new(55.0, 100.0),
        tip: Vec2::new(26.0, 124.0),
        half_mm: 9.5,
        bend: 3.0,
    },
];

impl Leaf {
    fn rib(&self, t: f32) -> Vec2 {
        let along = self.tip - self.stalk;
        self.stalk + along * t + along.normalize().perp() * self.bend * (4.0 * t * (1.0 - t))
    }

    /// Half the width at a place of the rib: four rounded lobes a side.
    fn half(&self, t: f32) -> f32 {
        let body = (t.powf(0.75) * std::f32::consts::PI).sin().max(0.0) * smoothstep(0.04, 0.3, t);
        let lobes = 0.62 + 0.38 * (t * 4.4 * std::f32::consts::TAU - 1.2).cos();
        self.half_mm * (body * lobes + 0.35 * smoothstep(0.02, 0.1, t) * (1.0 - t).powf(0.5) * 0.4)
    }

    fn edge(&self, t: f32, side: f32) -> Vec2 {
        let along = (self.rib(t + 0.01) - self.rib(t - 0.01)).normalize();
        // Lobes lean towards the tip.
        self.rib((t + 0.07 * self.half(t) / self.half_mm).min(1.02))
            + along.perp() * side * self.half(t)
    }

    fn outline(&self) -> Vec<Vec2> {
        let up = (0..=90).map(|i| self.edge(i as f32 / 90.0, -1.0));
        let down = (0..=90).rev().map(|i| self.edge(i as f32 / 90.0, 1.0));
        up.chain(down).collect()
    }
}

/// Writes the picture.
pub fn write(out: &mut Out) -> Result<(), SampleError> {
    let grid = Grid::at_dpi(SIZE_MM, DPI);
    let paper = Paper::new(SIZE_MM, 400);
    let outlines: Vec<Vec<Vec2>> = LEAVES.iter().map(Leaf::outline).collect();
    let mut hand = Hand::new(401);
    draw(&mut hand, &outlines);
    let uneven = Noise::smooth(402, 5.0, 3);
    let shades: Vec<Vec<Vec2>> = LEAVES.iter().map(shaded_half).collect();
    let mut strokes = paper.fibres(403);
    strokes.append(&mut hand.strokes);
    let maps = side::maps(grid, &paper, Face::Recto, &strokes, |texel| {
        let washed = shades.iter().any(|shade| inside(shade, texel.at));
        let wash = if washed {
            WASH * (1.0 + 0.5 * uneven.at(texel.at))
        } else {
            Vec3::ZERO
        };
        Shown {
            colours: [texel.colour(wash, Vec3::ZERO)],
            roughness: 0.6,
            greys: [0; side::GREYS],
        }
    });
    let [albedo] = maps.colours;
    out.rgb8("sprig.png", grid, &albedo)
}

/// The half of a leaf that lies below its rib.
fn shaded_half(leaf: &Leaf) -> Vec<Vec2> {
    let side = lower_side(leaf);
    let rib = (0..=40).map(|i| leaf.rib(i as f32 / 40.0));
    let edge = (0..=90).rev().map(|i| leaf.edge(i as f32 / 90.0, side));
    rib.chain(edge).collect()
}

fn lower_side(leaf: &Leaf) -> f32 {
    let across = (leaf.tip - leaf.stalk).perp();
    if across.y + 0.6 * across.x > 0.0 {
        1.0
    } else {
        -1.0
    }
}

fn draw(hand: &mut Hand, outlines: &[Vec<Vec2>]) {
    for outline in outlines {
        let shift = Vec2::new(hand.chance.centred(), hand.chance.centred());
        let loose: Vec<Vec2> = outline.iter().step_by(6).map(|&p| p + shift).collect();
        hand.curve(CHALK, &loose);
    }
    let stem = [
        [66.0, 140.0],
        [60.0, 122.0],
        [55.0, 100.0],
        [58.0, 82.0],
        [61.0, 62.0],
    ]
    .map(Vec2::from_array);
    for (aside, weight) in [(-0.9, 0.9), (0.9, 1.3)] {
        let edge: Vec<Vec2> = smooth(&stem)
            .iter()
            .map(|&p| p + Vec2::new(aside * mix(0.5, 1.3, (p.y - 60.0) / 80.0), 0.0))
            .collect();
        hand.line(PEN.scaled(weight), &edge);
    }
    for (i, leaf) in LEAVES.iter().enumerate() {
        let covered = |p: Vec2| outlines[..i].iter().any(|nearer| inside(nearer, p));
        let pieces = |path: &[Vec2]| -> Vec<Vec<Vec2>> {
            let fine = resampled(path, 0.2);
            let runs = fine.chunk_by(|&a, &b| !covered(a) && !covered(b));
            runs.filter(|run| run.len() > 3)
                .map(<[Vec2]>::to_vec)
                .collect()
        };
        let lower = lower_side(leaf);
        for side in [-1.0, 1.0] {
            let edge: Vec<Vec2> = (0..=90).map(|k| leaf.edge(k as f32 / 90.0, side)).collect();
            for run in pieces(&edge) {
                hand.line(PEN.scaled(if side == lower { 1.3 } else { 0.85 }), &run);
            }
        }
        let rib: Vec<Vec2> = (-1..=50).map(|k| leaf.rib(k as f32 / 50.0)).collect();
        for run in pieces(&rib) {
            hand.line(PEN.with_ends(1.3, 0.3), &run);
        }
        for k in 1..=6 {
            let t = k as f32 / 7.5;
            for side in [-1.0, 1.0] {
                let end = leaf.rib(t).lerp(leaf.edge((t + 0.1).min(1.0), side), 0.85);
                let middle = leaf.rib(t).midpoint(end) + (leaf.tip - leaf.stalk).normalize() * 0.8;
                for run in pieces(&smooth(&[leaf.rib(t), middle, end])) {
                    hand.line(PEN.scaled(0.6).with_ends(0.9, 0.3), &run);
                }
            }
        }
        let shade = shaded_half(leaf);
        let step = 0.75;
        let count = (leaf.tip.distance(leaf.stalk) / step) as usize;
        for k in 0..count {
            let t = (k as f32 + 0.4 * hand.chance.centred()) / count as f32;
            let from = leaf.rib(t);
            let to = from.lerp(
                leaf.edge((t + 0.12).min(1.0), lower),
                hand.chance.between(0.55, 1.0),
            );
            for run in pieces(&[from, to]) {
                let kept: Vec<Vec2> = run.into_iter().filter(|&p| inside(&shade, p)).collect();
                hand.line(PEN.scaled(0.45).inked(0.85).with_ends(0.9, 0.2), &kept);
            }
        }
    }
    acorn(hand, Vec2::new(78.0, 116.0), 0.5);
    acorn(hand, Vec2::new(87.0, 109.0), 0.15);
    hand.curve(
        PEN.scaled(1.2),
        &[
            Vec2::new(57.0, 106.0),
            Vec2::new(66.0, 108.0),
            Vec2::new(75.0, 111.5),
        ],
    );
    hand.curve(
        PEN.scaled(1.0),
        &[
            Vec2::new(68.0, 108.4),
            Vec2::new(76.0, 106.0),
            Vec2::new(84.5, 104.5),
        ],
    );
}

/// A nut in its cup, turned by an angle in radians.
fn acorn(hand: &mut Hand, at: Vec2, turn: f32) {
    let place = |p: Vec2| at + Vec2::from_angle(turn - 0.9).rotate(p);
    let nut: Vec<Vec2> = arc(Vec2::new(0.0, 5.0), Vec2::new(3.9, 8.0), -0.25, 3.39)
        .into_iter()
        .map(place)
        .collect();
    hand.line(PEN.scaled(1.1), &nut);
    hand.line(
        PEN.scaled(0.8),
        &[place(Vec2::new(0.0, 12.9)), place(Vec2::new(0.2, 14.6))],
    );
    let cup: Vec<Vec2> = arc(Vec2::new(0.0, 2.6), Vec2::new(5.0, 5.4), 3.05, 6.4)
        .into_iter()
        .map(place)
        .collect();
    hand.line(PEN.scaled(1.2), &cup);
    let rim: Vec<Vec2> = arc(Vec2::new(0.0, 2.8), Vec2::new(4.9, 1.7), 0.0, 3.2)
        .into_iter()
        .map(place)
        .collect();
    hand.line(PEN, &rim);
    for row in 0..4 {
        let y = 1.8 - 1.35 * row as f32;
        let half = 4.5 * (1.0 - ((y - 2.6) / 5.6).powi(2)).max(0.0).sqrt();
        let path = [
            Vec2::new(-half, y),
            Vec2::new(0.0, y + 0.8),
            Vec2::new(half, y),
        ]
        .map(place);
        hand.loops(PEN.scaled(0.5), &path, 0.38, 1.05);
    }
    for i in 0..11 {
        let u = 0.4 + 0.3 * i as f32;
        let reach = 7.4 * (1.0 - (u / 3.9).powi(2)).max(0.0).sqrt();
        let path = [
            Vec2::new(u, 4.6),
            Vec2::new(u + 0.25, 5.0 + 0.5 * reach),
            Vec2::new(u - 0.2, 4.6 + reach),
        ]
        .map(place);
        hand.curve(PEN.scaled(0.5).with_ends(0.8, 0.3), &path);
    }
}
