//! What three centuries did to the sheet before it was restored, and what is left of it.

use glam::{Vec2, Vec3};

use super::{
    grid::{Grid, Plane},
    hand::resampled,
    noise::{Chance, Noise, smoothstep},
    paper::{Face, Paper},
};

/// Samples per mm of the soft damages.
const PER_MM: f32 = 4.0;
/// Optical depth of foxing, water stains and adhesive by channel, relative to green.
const RUST: Vec3 = Vec3::new(0.30, 1.0, 2.0);
const TIDE: Vec3 = Vec3::new(0.42, 1.0, 1.75);
const GLUE: Vec3 = Vec3::new(0.18, 0.62, 1.7);
const DIRT: Vec3 = Vec3::new(0.85, 1.0, 1.2);
/// Width of the mending strip, in mm.
const STRIP_MM: f32 = 13.0;
/// Where hinges begin and end along the top of the verso, and how deep they reach, in mm.
const HINGES_MM: [[f32; 2]; 2] = [[38.0, 71.0], [219.0, 250.0]];
const HINGE_DEEP_MM: f32 = 12.5;
/// Deepest that the worn edge eats into the rectangle of the sheet, in mm.
const WORN_MM: f32 = 0.9;

/// Kinds of damage, as the overlay maps them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Tear,
    Stain,
    Foxing,
    Loss,
}

/// All damages of the sheet, in the recto's frame.
pub struct Damage {
    size_mm: Vec2,
    foxing: Plane,
    stain: Plane,
    tear: Vec<Vec2>,
    ragged: Noise,
    coarse: Noise,
    torn: Noise,
    smear: Plane,
}

/// Round holes and losses: x, y, radius in mm.
const HOLES: [[f32; 3]; 3] = [[71.5, 21.0, 0.75], [73.8, 23.2, 0.5], [233.0, 188.9, 1.9]];

impl Damage {
    /// The damages of a sheet of this size.
    pub fn new(size_mm: Vec2) -> Self {
        let grid = Grid::with_pixels(
            size_mm,
            (size_mm.x * PER_MM) as usize,
            (size_mm.y * PER_MM) as usize,
        );
        let down = [
            [0.0, -1.0],
            [0.6, 5.0],
            [-0.8, 11.0],
            [1.6, 17.0],
            [2.2, 24.0],
            [5.1, 30.5],
            [5.4, 36.0],
        ];
        let tear = down
            .map(|[x, y]| Vec2::new(0.715 * size_mm.x + x, y))
            .to_vec();
        Self {
            size_mm,
            foxing: foxing(grid, size_mm),
            stain: stain(grid, size_mm),
            tear: resampled(&tear, 0.5),
            ragged: Noise::smooth(84, 1.6, 4),
            coarse: Noise::smooth(85, 17.0, 3),
            torn: Noise::smooth(86, 2.2, 3),
            smear: Plane::of_noise(size_mm, &Noise::smooth(87, 21.0, 4)),
        }
    }

    /// Distance from the tear in mm; large away from it.
    fn tear_mm(&self, recto: Vec2) -> f32 {
        let far = f32::MAX;
        if recto.y > 55.0 || (recto.x - self.tear[0].x).abs() > 25.0 {
            return far;
        }
        let jag = 0.35 * Vec2::new(self.torn.at(recto), 0.5 * self.torn.at(recto + 40.0));
        let p = recto + jag;
        self.tear
            .iter()
            .map(|knot| knot.distance_squared(p))
            .fold(far, f32::min)
            .sqrt()
    }

    /// Optical depth that the state before restoration adds to a face.
    pub fn before(&self, paper: &Paper, face: Face, at: Vec2) -> Vec3 {
        let recto = paper.on_recto(face, at);
        let smear = self.smear.at(recto);
        let dirt =
            0.05 + 0.13 * smoothstep(0.0, 0.7, smear) + 0.16 * (-paper.edge_mm(recto) / 12.0).exp();
        let mut tau = DIRT * dirt + RUST * self.foxing.at(recto) + TIDE * self.stain.at(recto);
        tau += hinges(face, at);
        let tear = self.tear_mm(recto);
        if tear < STRIP_MM {
            tau += self.strip(face, recto, tear);
            tau += Vec3::splat(1.5) * (1.0 - smoothstep(0.05, 0.22, tear));
            tau += DIRT * 0.5 * (-tear / 0.6).exp();
        }
        tau
    }

    /// A strip of paper glued along the tear, on the verso; its glue has struck through.
    fn strip(&self, face: Face, recto: Vec2, tear: f32) -> Vec3 {
        let half = 0.5 * STRIP_MM + 0.25 * self.torn.at(recto * 0.4);
        let within = smoothstep(half, half - 0.3, tear);
        match face {
            Face::Recto => GLUE * within * (0.20 + 0.06 * self.torn.at(recto * 0.3)),
            Face::Verso => {
                let rim = (-((tear - half + 0.2) / 0.3).powi(2)).exp();
                GLUE * (0.16 * within + 0.25 * rim) - Vec3::splat(0.10) * within
            }
        }
    }

    /// Optical depth that restoration left: ghosts of stains, the closed tear.
    pub fn after(&self, paper: &Paper, face: Face, at: Vec2) -> Vec3 {
        let recto = paper.on_recto(face, at);
        let ghost = RUST * 0.10 * self.foxing.at(recto) + TIDE * 0.09 * self.stain.at(recto);
        let tear = self.tear_mm(recto);
        ghost + Vec3::splat(0.28) * (1.0 - smoothstep(0.03, 0.16, tear))
    }

    /// Which damage a curator would map here.
    pub fn kind(&self, recto: Vec2) -> Option<Kind> {
        let lost = !self.present(recto) || self.hole_mm(recto) < 0.5;
        if lost {
            Some(Kind::Loss)
        } else if self.tear_mm(recto) < 0.7 {
            Some(Kind::Tear)
        } else if self.foxing.at(recto) > 0.12 {
            Some(Kind::Foxing)
        } else if self.stain.at(recto) > 0.05 {
            Some(Kind::Stain)
        } else {
            None
        }
    }

    fn hole_mm(&self, recto: Vec2) -> f32 {
        HOLES
            .iter()
            .map(|&[x, y, radius]| recto.distance(Vec2::new(x, y)) - radius)
            .fold(f32::MAX, f32::min)
    }

    /// Whether there is paper here: a worn, torn edge, a nibbled corner, worm holes, a loss.
    pub fn present(&self, recto: Vec2) -> bool {
        let far = self.size_mm - recto;
        let edge = recto.x.min(recto.y).min(far.x).min(far.y);
        if edge > 4.0 && self.hole_mm(recto) > 1.0 && recto.x > 12.0 {
            return true;
        }
        let frayed = 0.11 * self.ragged.at(recto * 2.2);
        if edge < 4.0 {
            // Long lazy wear, and bites where it has torn.
            let worn = 0.5 + 0.5 * self.coarse.at(recto);
            let bite = smoothstep(0.35, 0.75, self.torn.at(recto * 0.22)) * 0.9;
            if edge < WORN_MM * worn * 0.55 + bite * 0.8 + frayed + 0.16 {
                return false;
            }
        }
        // The corner that mice found.
        let corner = Vec2::new(recto.x, self.size_mm.y - recto.y);
        if corner.length() < 12.0 {
            let gnawed = corner.x * 1.15 + corner.y < 11.0 + 2.2 * self.torn.at(recto * 0.5);
            let teeth = corner.length() < 8.4 + 1.7 * self.ragged.at(recto * 0.35);
            if gnawed && teeth {
                return false;
            }
        }
        let hole = self.hole_mm(recto);
        hole > 1.0 || hole + 0.35 * self.ragged.at(recto) + frayed > 0.0
    }
}

/// Two paper hinges along the top of the verso, by which an album once held the sheet.
fn hinges(face: Face, at: Vec2) -> Vec3 {
    if face == Face::Recto {
        return Vec3::ZERO;
    }
    let gap = HINGES_MM
        .iter()
        .map(|&[left, right]| (left - at.x).max(at.x - right).max(at.y - HINGE_DEEP_MM))
        .fold(f32::MAX, f32::min);
    let within = smoothstep(0.1, -0.1, gap);
    let rim = (-(gap / 0.5).powi(2)).exp();
    GLUE * (0.26 * rim + 0.05 * within) - Vec3::new(0.07, 0.08, 0.06) * within
}

/// Rusty spots, single and in colonies, with soft rims and darker hearts.
fn foxing(grid: Grid, size_mm: Vec2) -> Plane {
    let mut chance = Chance::new(81);
    let mut plane = Plane::filled(grid, 0.0);
    let mut spots = Vec::new();
    for _ in 0..15 {
        let colony = Vec2::new(chance.unit(), chance.unit()) * size_mm;
        let spread = chance.between(5.0, 26.0);
        for _ in 0..(chance.between(5.0, 22.0) as usize) {
            let at = colony + Vec2::new(chance.centred(), chance.centred()) * spread;
            spots.push((
                at,
                0.25 + 2.1 * chance.unit().powi(3),
                chance.between(0.12, 0.6),
            ));
        }
    }
    let ragged = Noise::smooth(82, 1.3, 2);
    for (at, radius, tau) in spots {
        let reach = 2.4 * radius;
        let low = ((at - reach) / grid.pitch_mm).max(Vec2::ZERO);
        let high = ((at + reach) / grid.pitch_mm).max(Vec2::ZERO);
        for row in (low.y as usize)..(high.y as usize + 1).min(grid.height) {
            for column in (low.x as usize)..(high.x as usize + 1).min(grid.width) {
                let p = grid.centre(column, row);
                let r = p.distance(at) / radius * (1.0 + 0.3 * ragged.at(p));
                let heart = 0.45 * (-(r / 0.35).powi(2)).exp();
                plane.data[row * grid.width + column] += tau * (0.6 * (-r * r).exp() + heart);
            }
        }
    }
    plane
}

/// Water came in from the lower right and dried in several fronts.
fn stain(grid: Grid, size_mm: Vec2) -> Plane {
    let rough = Noise::smooth(83, 34.0, 4);
    let source = size_mm * Vec2::new(1.03, 0.86);
    Plane::from_fn(grid, |p| {
        let r = (p - source) * Vec2::new(0.82, 1.0);
        let front = r.length() + 13.0 * rough.at(p);
        let line = |at: f32, inside: f32, tau: f32| {
            let d = at - front;
            let crest = (-(d / 0.45).powi(2)).exp();
            let behind = if d > 0.0 {
                (-d / inside).exp()
            } else {
                (-(d / 0.3).powi(2)).exp()
            };
            tau * (0.55 * crest + 0.45 * behind)
        };
        let pool = 0.16 * smoothstep(74.0, 66.0, front);
        pool + line(73.0, 5.0, 0.52) + line(61.5, 3.5, 0.22) + line(42.0, 2.5, 0.16)
    })
}
