//! What the tiers are judged on: nine subjects, and the light and eyes in which they are shown.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use crate::{
    optics::{
        medium::{Matter, MediumId, PaperConstants, ParticleConstants},
        relief::Horizon,
        slab::{Phase, Slab, UM_PER_MM},
    },
    reference,
};

/// Elevation of the lamps above the sheet in degrees.
pub const ELEVATIONS_DEG: [f64; 7] = [80.0, 60.0, 45.0, 30.0, 20.0, 10.0, 5.0];
/// How far the eye leans from straight above, in degrees.
pub const TILTS_DEG: [f64; 3] = [0.0, 30.0, 60.0];
/// Azimuth between lamp and eye where the eye leans: opposite, across, and behind the eye.
pub const AZIMUTHS_DEG: [f64; 3] = [180.0, 90.0, 0.0];
/// Tilts under which a light table is seen.
const TABLE_TILTS_DEG: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];
/// The relief's lamps stand so high, across its ridges.
const RAKING_DEG: [f64; 5] = [30.0, 20.0, 12.0, 8.0, 5.0];
/// Eyes over the relief.
const RAKING_TILTS_DEG: [f64; 2] = [0.0, 30.0];
/// Places along one ridge of the relief.
const PHASES: usize = 24;
/// Ridges as laid lines and brush grain make them: so far apart, and so high, in mm.
const RIDGE_MM: f64 = 1.0;
const RIDGE_HEIGHT_MM: f64 = 0.05;
/// Samples of a ray through the relief.
const RAY_STEPS: u32 = 4000;

/// How a subject is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lit {
    /// By one distant lamp at a time.
    Lamps,
    /// From behind, by an even table.
    Table,
    /// By low distant lamps, over ridges.
    Raking,
}

/// A sheet, or a spot of one, with what lies on it.
#[derive(Clone, Copy, Debug)]
pub struct Subject {
    /// As tables name it.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    paper: &'static str,
    /// A film or particles on the front.
    medium: Option<&'static str>,
    /// Share of the film's full depth, or of the spot that particles cover.
    amount: f64,
    /// σs in mm⁻¹ and thickness in mm, where they are not the paper's own.
    body: Option<[f64; 2]>,
    /// τ of a film on the back.
    back: f64,
    pub lit: Lit,
    /// Whether it has a row in the table; the others only tell how far study is from the judge.
    pub listed: bool,
}

const PLAIN: Subject = Subject {
    name: "",
    title: "",
    paper: "laid",
    medium: None,
    amount: 0.0,
    body: None,
    back: 0.0,
    lit: Lit::Lamps,
    listed: true,
};

/// The nine subjects of the table, then those that only the prediction needs.
pub const SUBJECTS: [Subject; 12] = [
    Subject {
        name: "paper-matte",
        title: "matte paper",
        ..PLAIN
    },
    Subject {
        name: "paper-burnished",
        title: "burnished paper",
        paper: "burnished",
        ..PLAIN
    },
    Subject {
        name: "ink-pale",
        title: "pale ink",
        medium: Some("iron-gall-ink"),
        amount: 0.12,
        ..PLAIN
    },
    Subject {
        name: "ink-dark",
        title: "dark ink",
        medium: Some("iron-gall-ink"),
        amount: 0.6,
        ..PLAIN
    },
    Subject {
        name: "wash",
        title: "wash",
        medium: Some("wash"),
        amount: 0.5,
        ..PLAIN
    },
    Subject {
        name: "silver-point",
        title: "silver point",
        medium: Some("silver-point"),
        amount: 0.5,
        ..PLAIN
    },
    Subject {
        name: "black-chalk",
        title: "black chalk",
        medium: Some("black-chalk"),
        amount: 0.7,
        ..PLAIN
    },
    Subject {
        name: "light-table",
        title: "thin sheet on a light table",
        medium: Some("iron-gall-ink"),
        amount: 0.2,
        body: Some([20.0, 0.15]),
        back: 0.3,
        lit: Lit::Table,
        ..PLAIN
    },
    Subject {
        name: "raking",
        title: "raking relief",
        lit: Lit::Raking,
        ..PLAIN
    },
    Subject {
        name: "ink-full",
        title: "ink at full depth",
        medium: Some("iron-gall-ink"),
        amount: 1.0,
        listed: false,
        ..PLAIN
    },
    Subject {
        name: "light-table-bare",
        title: "laid paper on a light table",
        lit: Lit::Table,
        listed: false,
        ..PLAIN
    },
    Subject {
        name: "light-table-inked",
        title: "inked laid paper on a light table",
        medium: Some("iron-gall-ink"),
        amount: 0.3,
        back: 0.5,
        lit: Lit::Table,
        listed: false,
        ..PLAIN
    },
];

/// One element of the display picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Towards lamp and eye, unit vectors in the sheet's frame; the lamp's is without meaning on a
    /// light table.
    pub l: DVec3,
    pub v: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Place along a ridge in mm.
    pub place: f64,
}

/// A unit vector at an elevation and an azimuth in degrees.
fn direction(elevation: f64, azimuth: f64) -> DVec3 {
    let (sin_e, cos_e) = elevation.to_radians().sin_cos();
    let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
    DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// Light and eye of reproduction photography, 45°/0°.
pub const CAPTURE: View = View {
    l: DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2),
    v: DVec3::Z,
    normal: DVec3::Z,
    place: 0.0,
};

impl Subject {
    /// The one of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SUBJECTS.iter().find(|subject| subject.name == name)
    }

    /// The elements of its display picture, all of one size.
    pub fn views(&self) -> Vec<View> {
        let flat = |l, v| View {
            l,
            v,
            normal: DVec3::Z,
            place: 0.0,
        };
        match self.lit {
            Lit::Lamps => TILTS_DEG
                .iter()
                .flat_map(|&tilt| {
                    let azimuths = if tilt == 0.0 {
                        &AZIMUTHS_DEG[..1]
                    } else {
                        &AZIMUTHS_DEG
                    };
                    azimuths.iter().flat_map(move |&azimuth| {
                        ELEVATIONS_DEG.iter().map(move |&elevation| {
                            flat(direction(elevation, azimuth), direction(90.0 - tilt, 0.0))
                        })
                    })
                })
                .collect(),
            Lit::Table => TABLE_TILTS_DEG
                .iter()
                .map(|tilt| flat(DVec3::NEG_Z, direction(90.0 - tilt, 0.0)))
                .collect(),
            Lit::Raking => RAKING_TILTS_DEG
                .iter()
                .flat_map(|&tilt| {
                    (0..PHASES).flat_map(move |phase| {
                        let place = RIDGE_MM * (phase as f64 + 0.5) / PHASES as f64;
                        RAKING_DEG.iter().map(move |&elevation| View {
                            l: direction(elevation, 180.0),
                            v: direction(90.0 - tilt, 90.0),
                            normal: normal_at(place),
                            place,
                        })
                    })
                })
                .collect(),
        }
    }

    /// Name of its paper in the catalogue.
    pub fn paper(&self) -> &'static str {
        self.paper
    }

    /// The same on a whole sheet of the catalogue, of which a thinner one is made too.
    pub fn on_whole_sheet(&self) -> Self {
        Self {
            body: None,
            ..*self
        }
    }

    fn constants(&self) -> PaperConstants {
        match matter(self.paper) {
            Some(Matter::Paper(paper)) => paper,
            // The names above are constants, and a test looks all of them up.
            _ => unreachable!("{} is no paper of the catalogue", self.paper),
        }
    }

    /// Index of the surface, for judge and tiers alike.
    pub fn index(&self) -> f64 {
        self.constants().index
    }

    /// GGX roughness of the bare paper.
    pub fn bare_alpha(&self) -> f64 {
        self.constants().roughness
    }

    /// GGX roughness of the spot: a film has its own, particles leave the paper's between them.
    pub fn alpha(&self) -> f64 {
        match self.matter() {
            Some(Matter::Film(film)) => film.roughness,
            _ => self.bare_alpha(),
        }
    }

    /// What its bare paper photographs as on a sheet of the catalogue, linear sRGB.
    pub fn bare(&self) -> [f64; 3] {
        self.constants().albedo
    }

    fn matter(&self) -> Option<Matter> {
        self.medium.and_then(matter)
    }

    /// τ of the film on the front.
    pub fn depth(&self) -> [f64; 3] {
        match self.matter() {
            Some(Matter::Film(film)) => film.depth.map(|depth| depth * self.amount),
            _ => [0.0; 3],
        }
    }

    /// τ of the film on the back, the same ink.
    pub fn depth_behind(&self) -> [f64; 3] {
        match self.matter() {
            Some(Matter::Film(film)) => film.depth.map(|depth| depth * self.back),
            _ => [0.0; 3],
        }
    }

    /// Particles, and the share of the spot that they cover.
    pub fn particles(&self) -> Option<(ParticleConstants, f64)> {
        match self.matter() {
            Some(Matter::Particles(particles)) => Some((particles, self.amount)),
            _ => None,
        }
    }

    fn scattering(&self) -> [f64; 2] {
        let paper = self.constants();
        self.body
            .unwrap_or([paper.scattering_per_mm, paper.thickness_um / UM_PER_MM])
    }

    /// The body as the tiers know it; its absorption follows from the photograph.
    pub fn slab(&self) -> Slab {
        let paper = self.constants();
        let [scattering, thickness] = self.scattering();
        Slab {
            scattering,
            absorption: 0.0,
            thickness,
            phase: Phase {
                forward_share: paper.forward_share,
                g_forward: paper.g_forward,
                g_backward: paper.g_backward,
            },
        }
    }

    /// The body as the judge knows it, with this roughness of the front; the back is bare paper.
    pub fn layers(&self, alpha: f64) -> reference::Layers {
        let paper = self.constants();
        let [sigma_s, thickness_mm] = self.scattering();
        reference::Layers {
            n: paper.index,
            alpha: [alpha, self.bare_alpha()],
            sigma_s,
            phase: reference::Phase {
                w_f: paper.forward_share,
                g_f: paper.g_forward,
                g_b: paper.g_backward,
            },
            thickness_mm,
        }
    }
}

fn matter(name: &str) -> Option<Matter> {
    let id = name.parse::<MediumId>().ok()?;
    Some(id.medium().matter)
}

/// Height of the relief in mm.
fn height_at(place: f64) -> f64 {
    0.5 * RIDGE_HEIGHT_MM * (std::f64::consts::TAU * place / RIDGE_MM).sin()
}

fn normal_at(place: f64) -> DVec3 {
    let turn = std::f64::consts::TAU / RIDGE_MM;
    let slope = 0.5 * RIDGE_HEIGHT_MM * turn * (turn * place).cos();
    DVec3::new(-slope, 0.0, 1.0).normalize()
}

impl View {
    /// Whether the relief leaves the lamp in sight, by following a ray: the truth.
    pub fn is_lit(&self) -> bool {
        let rise = self.l.z / self.l.x.abs().max(1e-9);
        let reach = RIDGE_HEIGHT_MM / rise;
        let here = height_at(self.place);
        let towards = self.l.x.signum();
        (1..=RAY_STEPS).all(|step| {
            let t = reach * f64::from(step) / f64::from(RAY_STEPS);
            height_at(self.place + towards * t) <= here + rise * t
        })
    }

    /// The share of the lamp that study's march leaves, in a picture of so many readings a ridge.
    pub fn marched(&self) -> f64 {
        let rise = crate::optics::relief::rise_of(self.l);
        let width = RIDGE_MM / PHASES as f64;
        let towards = self.l.x.signum();
        let horizon = Horizon::marched(rise, width, 0.5 * RIDGE_HEIGHT_MM, |t, _| {
            height_at(self.place + towards * t)
        });
        crate::optics::relief::visible_over(horizon, rise)
    }
}
