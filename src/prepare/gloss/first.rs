//! The surfaces of a sheet before anything of it is solved: how rough its paper is, and what is
//! dark on it.
//!
//! Stereo has to know both: a gleam that it does not expect turns normals towards the lamps, most
//! of all where it is dark and hardly anything but gleam is seen. So places all over the sheet are
//! taken for bare paper of the catalogue's roughness first, told apart by how light they are, and
//! [`fit`] finds the roughness of the light ones and of the dark ones. What is dark is ink in the
//! paper, as a renderer takes it, unless the photographs are nearer to body colour on it.

use glam::{DVec2, DVec3};

use super::{Roughness, fit, samples::Place};
use crate::{
    optics::medium::{Matter, Medium, MediumId},
    prepare::{
        capture::Robustness,
        lights::far_apart,
        model::Model,
        stereo::{Inked, Paper, Response, Rig, Rows, Solved, Solver, Standing},
    },
};

/// Photographs of places that a fit takes: with four lamps twice as many places tell as much as
/// with eight. With 400, a glossy sheet under four lamps was found too glossy by a third.
const SHOWN: usize = 1000;
/// Places that it takes.
const PLACES: [usize; 2] = [120, 320];
/// The fewest dark ones that have a surface of their own.
const FEWEST: usize = 40;
/// How much darker than paper they are, at least.
const DARKER: f64 = 0.6;
/// Lamps that a fit takes: more hardly add to it.
const LAMPS: usize = 8;

/// How far from 1 the level of photographs is for the gloss in them to matter.
const LEVEL: f64 = 0.05;

/// A place with all its photographs, before it is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Where its middle is, in pixels.
    pub at: DVec2,
    pub shown: Vec<DVec3>,
}

/// What a sheet is like, by some of its places.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    pub paper: Roughness,
    /// Of what is dark on it; `None` where too little is.
    pub dark: Option<Dark>,
    /// What is divided out when the sheet is solved.
    pub response: Response,
}

/// What is dark on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Dark {
    pub roughness: Roughness,
    /// Whether it is ink in the paper; it lies on it otherwise.
    pub is_film: bool,
    /// The mean linear albedo (a quarter of red and blue, half of green) below which it is dark.
    pub below: f64,
}

/// Lamps that are enough for a fit, far from each other.
pub fn some_lamps(rig: &Rig) -> Vec<usize> {
    far_apart(&rig.standing.directions(), LAMPS)
}

impl Surfaces {
    /// What places show under the lamps of `rig`. `level` is what photographs show of a perfect
    /// diffuser that they should show 1 of, or what says it by the green albedo of all places;
    /// `films` is whether dark places may be ink in the paper.
    pub fn new(places: &[Seen], rig: &Rig, level: &dyn Fn(&[f32]) -> f64, films: bool) -> Self {
        let level = |of: &Solved| {
            let level = level(&of.albedo[1]);
            match level > 0.0 && level.is_finite() {
                true => level,
                false => 1.0,
            }
        };
        let mut first = solved(places, rig, 1.0);
        let rough = level(&first);
        if (rough - 1.0).abs() > LEVEL {
            // The gloss that was taken off was as much too bright.
            first = solved(places, rig, rough);
        }
        let level = level(&first);
        let place = |i: usize| Place {
            at: places[i].at,
            shown: places[i].shown.iter().map(|rgb| *rgb / level).collect(),
            normal: DVec3::from(first.normal[i].map(f64::from)).normalize_or(DVec3::Z),
            albedo: DVec3::from([0, 1, 2].map(|c| f64::from(first.albedo[c][i]))) / level,
        };
        let all: Vec<Place> = (0..places.len()).map(place).collect();
        let (light, dark, below) = split(&all);
        let assumed = |alpha| Roughness {
            medium: None,
            alpha,
            within: None,
            residual: 0.0,
            places: 0,
        };
        let Some(model) = Model::laid(colour(&light)) else {
            // The catalogue has laid paper.
            return Self {
                paper: assumed(1.0),
                dark: None,
                response: Response::Lambert,
            };
        };
        let paper = fit(&model, None, None, &some(&light, rig), rig).0;
        let model = model.with(|of| of.roughness = paper.alpha);
        let index = model.paper().index;
        let of_paper = Paper::new(paper.alpha, index, 1.0);
        if dark.len() < FEWEST {
            return Self {
                paper,
                dark: None,
                response: Response::Paper(of_paper.at_level(level)),
            };
        }
        let dark = some(&dark, rig);
        let film = films.then(|| film(&model)).flatten();
        let (body, film) = rayon::join(
            || fit(&model, None, None, &dark, rig).0,
            || film.map(|film| fit(&model, None, Some(&film), &dark, rig).0),
        );
        let film = film.filter(|film| film.residual <= body.residual);
        let roughness = film.unwrap_or(body);
        let of_dark = match film {
            Some(_) => Paper::inked(&model, roughness.alpha, index),
            None => Paper::new(roughness.alpha, index, 1.0),
        };
        Self {
            paper,
            dark: Some(Dark {
                roughness,
                is_film: film.is_some(),
                below,
            }),
            response: Response::Inked(Box::new(Inked {
                paper: of_paper.at_level(level),
                dark: of_dark.at_level(level),
                below: (below * level) as f32,
            })),
        }
    }
}

/// Ink under a surface that is the paper's, unless it shows another one.
fn film(model: &Model) -> Option<Medium> {
    let mut medium = *"iron-gall-ink".parse::<MediumId>().ok()?.medium();
    let Matter::Film(film) = &mut medium.matter else {
        return None;
    };
    film.roughness = model.paper().roughness;
    film.index = model.paper().index;
    Some(medium)
}

/// Each place as bare paper of the catalogue, where photographs show this much of a perfect
/// diffuser.
fn solved(places: &[Seen], rig: &Rig, level: f64) -> Solved {
    let rows = |places: &[Seen]| -> Vec<[Vec<f32>; 3]> {
        let plane = |i: usize, c: usize| places.iter().map(|of| of.shown[i][c] as f32).collect();
        (0..rig.count())
            .map(|i| [0, 1, 2].map(|c| plane(i, c)))
            .collect()
    };
    let solver = |rig: Rig| Solver {
        rig,
        response: match Response::laid_paper() {
            Response::Paper(paper) => Response::Paper(paper.at_level(level)),
            other => other,
        },
        robustness: Robustness::Robust,
    };
    if matches!(rig.standing, Standing::Far(_)) {
        let planes = rows(places);
        return solver(rig.clone()).solve(Rows {
            planes: &planes,
            width: places.len(),
            top: 0,
        });
    }
    let mut all = Solved::default();
    for place in places {
        let mut rig = rig.clone();
        // Its only pixel is where the place is.
        rig.middle_px -= place.at - 0.5;
        let planes = rows(std::slice::from_ref(place));
        let mut solved = solver(rig).solve(Rows {
            planes: &planes,
            width: 1,
            top: 0,
        });
        all.normal.append(&mut solved.normal);
        for (all, own) in all.albedo.iter_mut().zip(&mut solved.albedo) {
            all.append(own);
        }
    }
    all
}

fn grey(albedo: DVec3) -> f64 {
    albedo.dot(DVec3::new(0.25, 0.5, 0.25))
}

/// Light and dark places, and the albedo between them: where the logarithms of both groups vary
/// least (N. Otsu, *IEEE Transactions on Systems, Man, and Cybernetics* 9 (1979) 62).
fn split(all: &[Place]) -> (Vec<&Place>, Vec<&Place>, f64) {
    /// Darker is as dark.
    const BLACKEST: f64 = 1e-3;
    let mut sorted: Vec<&Place> = all.iter().filter(|of| of.albedo.is_finite()).collect();
    sorted.sort_by(|a, b| grey(a.albedo).total_cmp(&grey(b.albedo)));
    let logarithm = |of: &Place| grey(of.albedo).max(BLACKEST).ln();
    let total: f64 = sorted.iter().map(|of| logarithm(of)).sum();
    let count = sorted.len() as f64;
    let (mut below, mut best) = (0.0, (0, 0.0));
    for (i, of) in sorted.iter().enumerate() {
        let n = i as f64;
        if i > 0 {
            let between = n * (count - n) * (below / n - (total - below) / (count - n)).powi(2);
            if between > best.1 {
                best = (i, between);
            }
        }
        below += logarithm(of);
    }
    let at = best.0;
    let middle = |of: &[&Place]| of.get(of.len() / 2).map_or(0.0, |of| grey(of.albedo));
    let [dark, light] = [middle(&sorted[..at]), middle(&sorted[at..])];
    // Else it is one group.
    let apart = dark < DARKER * light;
    let limit = (dark.max(BLACKEST) * light).sqrt();
    let is_dark = |of: &Place| apart && grey(of.albedo) < limit;
    // As they came: from all over.
    let (dark, light) = all
        .iter()
        .filter(|of| of.albedo.is_finite())
        .partition(|of| is_dark(of));
    (light, dark, limit)
}

/// Mean colour between the quartiles of light.
fn colour(places: &[&Place]) -> DVec3 {
    let mut found: Vec<DVec3> = places.iter().map(|of| of.albedo).collect();
    found.sort_by(|a, b| grey(*a).total_cmp(&grey(*b)));
    let middle = &found[found.len() / 4..(3 * found.len()).div_ceil(4)];
    let sum: DVec3 = middle.iter().sum();
    (sum / middle.len().max(1) as f64).clamp(DVec3::splat(0.01), DVec3::ONE)
}

/// As many as a fit takes, from all over.
fn some(places: &[&Place], rig: &Rig) -> Vec<Place> {
    let [least, most] = PLACES;
    let count = (SHOWN / rig.count().max(1))
        .clamp(least, most)
        .min(places.len());
    (0..count)
        .map(|k| places[k * places.len() / count].clone())
        .collect()
}
