//! The step chart: every medium of the catalogue in eight steps over one paper.

use glam::{Vec2, Vec3};

use super::{
    SampleError, font,
    grid::{Grid, Plane},
    hand::{Hand, Pen},
    maps_out::Out,
    noise::smoothstep,
    paper::{Face, PAPER, Paper},
    side,
    stroke::{Band, Layer},
};

/// Size of the chart, in mm.
pub const SIZE_MM: Vec2 = Vec2::new(180.0, 120.0);
/// Files that it has, its manifest not counted.
pub const FILES: usize = 8;
/// Steps of coverage or density: 1/8 … 8/8.
pub const STEPS: usize = 8;
/// Where the first field's corner lies, the distance between fields, and their size, in mm.
const FIRST_MM: Vec2 = Vec2::new(50.0, 12.0);
const PITCH_MM: Vec2 = Vec2::new(15.5, 8.0);
const FIELD_MM: Vec2 = Vec2::new(13.0, 6.2);
/// Media that one file of weights holds.
const PER_FILE: usize = 4;

/// How a medium shows.
enum Body {
    /// A transparent film: its optical depth by channel at full density.
    Film(Vec3),
    /// Particles that cover the paper: their colour in linear light.
    Cover(Vec3),
    /// A groove.
    Groove,
}

/// One row of the chart.
struct Row {
    medium: &'static str,
    body: Body,
    roughness: f32,
    /// Height at full density, in µm.
    height_um: f32,
}

const fn film(medium: &'static str, tau: [f32; 3], roughness: f32, height_um: f32) -> Row {
    Row {
        medium,
        body: Body::Film(Vec3::from_array(tau)),
        roughness,
        height_um,
    }
}

const fn cover(medium: &'static str, colour: [f32; 3], roughness: f32, height_um: f32) -> Row {
    Row {
        medium,
        body: Body::Cover(Vec3::from_array(colour)),
        roughness,
        height_um,
    }
}

/// The drawn media of the catalogue in its order, by name as manifests use it; of the recipes of
/// iron-gall ink the balanced one, aged.
const ROWS: [Row; 13] = [
    film("iron-gall-ink", [2.3, 2.7, 3.1], 0.35, 10.0),
    film("wash", [0.55, 0.95, 1.5], 0.5, 1.0),
    cover("lead-point", [0.20, 0.20, 0.20], 0.3, -4.0),
    cover("silver-point", [0.26, 0.22, 0.18], 0.3, -3.0),
    cover("black-chalk", [0.035, 0.034, 0.034], 0.85, 8.0),
    cover("charcoal", [0.022, 0.021, 0.020], 0.9, 6.0),
    cover("red-chalk", [0.36, 0.090, 0.045], 0.8, 8.0),
    cover("white-gouache", [0.86, 0.86, 0.83], 0.7, 25.0),
    film("watercolour", [1.5, 0.55, 0.25], 0.5, 2.0),
    film("carbon-ink", [3.3, 3.4, 3.5], 0.4, 8.0),
    film("bistre", [0.9, 1.7, 2.9], 0.45, 5.0),
    Row {
        medium: "blind-stylus",
        body: Body::Groove,
        roughness: 0.5,
        height_um: -30.0,
    },
    cover("prepared-ground", [0.72, 0.58, 0.52], 0.7, 20.0),
];

/// A place of a field: row, density of its step, and how far the tool has reached the paper
/// there (1 but for the soft rim of the field).
struct Place {
    row: usize,
    density: f32,
}

fn place(at: Vec2) -> Option<Place> {
    let cell = ((at - FIRST_MM) / PITCH_MM).floor();
    let (column, row) = (cell.x as i32, cell.y as i32);
    let fits = (0..STEPS as i32).contains(&column) && (0..ROWS.len() as i32).contains(&row);
    let within = at - FIRST_MM - cell * PITCH_MM;
    (fits && within.cmplt(FIELD_MM).all()).then(|| Place {
        row: row as usize,
        density: (column + 1) as f32 / STEPS as f32,
    })
}

/// Everything at one pixel.
struct Texel {
    colour: Vec3,
    height_um: f32,
    roughness: f32,
    /// Row and coverage.
    weight: Option<(usize, f32)>,
}

/// Writes the chart's maps.
pub fn write(out: &mut Out, dpi: f64) -> Result<(), SampleError> {
    let grid = Grid::at_dpi(SIZE_MM, dpi);
    let paper = Paper::new(SIZE_MM, 300);
    let labels = labels(grid);
    let texels = grid.map(|at| texel(&paper, &labels, at));
    let colour: Vec<[u8; 3]> = texels
        .iter()
        .map(|t| t.colour.to_array().map(side::srgb8))
        .collect();
    out.rgb8("albedo.png", grid, &colour)?;
    let heights: Vec<f32> = texels.iter().map(|t| t.height_um).collect();
    let height: Vec<u16> = heights.iter().map(|&um| side::height16(um)).collect();
    out.grey16("height.png", grid, &height)?;
    out.rgb8("normal.png", grid, &side::normals(grid, &heights))?;
    let roughness: Vec<u8> = texels.iter().map(|t| side::unit8(t.roughness)).collect();
    out.grey8("roughness.png", grid, &roughness)?;
    for (file, rows) in ROWS.chunks(PER_FILE).enumerate() {
        let weight = |texel: &Texel, row: usize| match texel.weight {
            Some((own, weight)) if own == row => side::unit8(weight),
            _ => 0,
        };
        let first = file * PER_FILE;
        let name = format!("media-{}.png", file + 1);
        if rows.len() == PER_FILE {
            let channels = |t| std::array::from_fn(|channel| weight(t, first + channel));
            out.rgba8(
                &name,
                grid,
                &texels.iter().map(channels).collect::<Vec<_>>(),
            )?;
        } else {
            let only = |t| weight(t, first);
            out.grey8(&name, grid, &texels.iter().map(only).collect::<Vec<_>>())?;
        }
    }
    Ok(())
}

fn texel(paper: &Paper, labels: &Plane, at: Vec2) -> Texel {
    let tooth = paper.tooth(Face::Recto, at);
    let bare = PAPER * (1.0 + 0.012 * tooth) * (-1.9 * labels.at(at)).exp();
    let ground_um = paper.relief_um(Face::Recto, at, tooth);
    let paper_roughness = 0.6 + 0.03 * tooth;
    let Some(Place { row, density }) = place(at) else {
        return Texel {
            colour: bare,
            height_um: ground_um,
            roughness: paper_roughness,
            weight: None,
        };
    };
    let Row {
        body,
        roughness,
        height_um,
        ..
    } = &ROWS[row];
    let (colour, weight) = match body {
        Body::Film(tau) => (
            bare * (-*tau * density * (1.0 - 0.06 * tooth)).exp(),
            density,
        ),
        Body::Cover(pigment) => {
            let dry = matches!(ROWS[row].medium, "white-gouache" | "prepared-ground");
            let share = if dry { density } else { caught(tooth, density) };
            (bare.lerp(*pigment, share), share)
        }
        Body::Groove => (bare, density),
    };
    Texel {
        colour,
        height_um: ground_um + height_um * weight,
        roughness: paper_roughness + (roughness - paper_roughness) * weight,
        weight: Some((row, weight)),
    }
}

/// Coverage of a dry medium: a light stroke touches the crests of the paper only. The mean over
/// the tooth stays close to the density.
fn caught(tooth: f32, density: f32) -> f32 {
    let soft = smoothstep(-0.75, 0.75, tooth * 0.9 + 2.0 * density - 1.0);
    soft * smoothstep(0.0, 0.12, density)
}

/// Names of the media and numbers of the steps.
fn labels(grid: Grid) -> Plane {
    let mut hand = Hand::new(301);
    let pen = Pen {
        layer: Layer::DarkInk,
        width_mm: 0.22,
        tau: 1.0,
        ends: (1.0, 1.0),
        tremor_mm: 0.02,
    };
    for (i, row) in ROWS.iter().enumerate() {
        let base = FIRST_MM.y + PITCH_MM.y * i as f32 + 0.5 * FIELD_MM.y + 1.1;
        font::write(&mut hand, pen, row.medium, Vec2::new(9.0, base), 2.3);
    }
    for step in 0..STEPS {
        let left = FIRST_MM.x + PITCH_MM.x * step as f32 + 0.5 * FIELD_MM.x - 3.0;
        font::write(
            &mut hand,
            pen,
            &format!("{}/{STEPS}", step + 1),
            Vec2::new(left, 8.5),
            2.3,
        );
    }
    let mut band = Band::rasterise(grid, 0, grid.height, &hand.strokes);
    Plane {
        grid,
        data: std::mem::take(&mut band.tau[Layer::DarkInk as usize]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::medium::{MediumId, MediumKind};

    /// Recipes and ages of one ink, and a colour of one ground, have no row of their own.
    fn is_variety(name: &str) -> bool {
        name.starts_with("iron-gall-ink-") || name == "tinted-ground"
    }

    #[test]
    fn every_drawn_medium_of_the_catalogue_has_its_row() {
        let catalogue: Vec<&str> = MediumId::all()
            .map(MediumId::medium)
            .filter(|medium| medium.kind == MediumKind::Drawn)
            .map(|medium| medium.name)
            .filter(|name| !is_variety(name))
            .collect();
        assert_eq!(catalogue, ROWS.map(|row| row.medium));
    }

    #[test]
    fn dry_media_cover_about_as_much_as_their_step_says() {
        let paper = Paper::new(SIZE_MM, 300);
        for step in 1..=STEPS {
            let density = step as f32 / STEPS as f32;
            let count = 4000;
            let mean = (0..count)
                .map(|i| Vec2::new((i % 80) as f32, (i / 80) as f32) * 0.31)
                .map(|at| caught(paper.tooth(Face::Recto, at), density))
                .sum::<f32>()
                / count as f32;
            assert!((mean - density).abs() < 0.12, "step {step}: {mean}");
        }
    }
}
