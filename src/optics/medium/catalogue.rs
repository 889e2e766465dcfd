//! Every medium a manifest can name, with its constants and where they come from.
//!
//! What is called assumed was chosen from the look of the material, and for optical depths and
//! albedos so that the step chart of `recto sample` shows the same: nobody has measured them.

use super::{
    BodyConstants, FilmConstants, Matter, Medium, MediumKind, PaperConstants, ParticleConstants,
};

/// σs of white paper in mm⁻¹, fitted by Papas, de Mesa & Jensen 2014, as OPTICS.md gives it
/// ("Paper slab").
const PAPER_SCATTERING: f64 = 81.38;
/// Mean cosine of one forward lobe: assumed, between the isotropic and the fibre's own.
const PAPER_G: f64 = 1.0 / 3.0;

const PAPER_SOURCE: &str = "index: customary for fibre, size and air, below the 1.557 of bleached \
     kraft (Fabritius 2006) and the 1.525 to 1.537 of delignified wood (Chen 2020); scattering: \
     Papas et al. 2014; phase, roughness, thickness and colour: assumed";

const fn paper(name: &'static str, roughness: f64, thickness_um: f64, albedo: [f64; 3]) -> Medium {
    Medium {
        name,
        kind: MediumKind::Paper,
        matter: Matter::Paper(PaperConstants {
            index: 1.5,
            roughness,
            scattering_per_mm: PAPER_SCATTERING,
            forward_share: 1.0,
            g_forward: PAPER_G,
            g_backward: 0.0,
            thickness_um,
            albedo,
            retro: 0.0,
            sheen: 0.0,
            anisotropy: 0.0,
            anisotropy_deg: 0.0,
        }),
        source: PAPER_SOURCE,
    }
}

const fn film(
    name: &'static str,
    index: f64,
    roughness: f64,
    depth: [f64; 3],
    source: &'static str,
) -> Medium {
    Medium {
        name,
        kind: MediumKind::Drawn,
        matter: Matter::Film(FilmConstants {
            index,
            roughness,
            depth,
        }),
        source,
    }
}

const fn particles(
    name: &'static str,
    [n, k]: [[f64; 3]; 2],
    roughness: f64,
    albedo: [f64; 3],
    source: &'static str,
) -> Medium {
    Medium {
        name,
        kind: MediumKind::Drawn,
        matter: Matter::Particles(ParticleConstants {
            n,
            k,
            roughness,
            albedo,
        }),
        source,
    }
}

const fn body(
    name: &'static str,
    scattering_per_mm: f64,
    thickness_um: f64,
    albedo: [f64; 3],
    source: &'static str,
) -> Medium {
    Medium {
        name,
        kind: MediumKind::Drawn,
        matter: Matter::Body(BodyConstants {
            index: 1.6,
            roughness: 0.7,
            scattering_per_mm,
            thickness_um,
            albedo,
        }),
        source,
    }
}

/// n and k of silver at 650, 550, 450 nm: Johnson & Christy 1972.
const SILVER: [[f64; 3]; 2] = [[0.052, 0.060, 0.040], [4.41, 3.60, 2.65]];
/// n and k of lead at 650, 550, 450 nm, 293 K: Golovashkin & Motulevich 1968.
const LEAD: [[f64; 3]; 2] = [[1.91, 1.83, 1.44], [3.51, 3.40, 3.18]];
/// n and k of soot, the same at every wavelength: Dalzell & Sarofim 1969.
const SOOT: [[f64; 3]; 2] = [[1.56; 3], [0.46; 3]];
/// n and k of hematite at 650, 550, 450 nm: Querry 1985.
const HEMATITE: [[f64; 3]; 2] = [[3.07, 3.32, 3.18], [0.06, 0.50, 1.02]];

const IRON_GALL_SOURCE: &str = "index: gum arabic, which binds it (OPTICS.md gives 1.47 to 1.50); \
     optical depth by recipe and age, and roughness: assumed";
const GUM_SOURCE: &str =
    "index: gum arabic, which binds it (1.47 to 1.50); optical depth and roughness: assumed";
const METAL_SOURCE: &str = "of fresh metal, the upper bound of a sparse and tarnished stroke; \
     roughness and albedo of what tarnish scatters: assumed";
const GROUND_SOURCE: &str = "lead white or bone in glue; index, scattering, thickness, roughness \
     and colour: assumed (lead white itself has 1.94 to 2.09)";

pub(super) const CATALOGUE: &[Medium] = &[
    paper("laid", 0.6, 150.0, [0.72, 0.67, 0.57]),
    paper("wove", 0.55, 180.0, [0.76, 0.72, 0.63]),
    paper("burnished", 0.25, 130.0, [0.72, 0.67, 0.57]),
    paper("parchment", 0.4, 200.0, [0.70, 0.61, 0.46]),
    paper("prepared", 0.7, 170.0, [0.78, 0.74, 0.66]),
    // Carta azzurra: white, blue and dark rags.
    paper("tinted", 0.65, 160.0, [0.30, 0.35, 0.38]),
    // The balanced recipe, aged: brown. The others are named by what they have more of, and
    // fresh inks are blue-black: little but the red is taken away less than later.
    film(
        "iron-gall-ink",
        1.49,
        0.35,
        [2.3, 2.7, 3.1],
        IRON_GALL_SOURCE,
    ),
    film(
        "iron-gall-ink-fresh",
        1.49,
        0.35,
        [3.3, 3.2, 2.9],
        IRON_GALL_SOURCE,
    ),
    film(
        "iron-gall-ink-iron-rich",
        1.49,
        0.4,
        [1.7, 2.5, 3.5],
        IRON_GALL_SOURCE,
    ),
    film(
        "iron-gall-ink-iron-rich-fresh",
        1.49,
        0.4,
        [3.6, 3.5, 3.2],
        IRON_GALL_SOURCE,
    ),
    film(
        "iron-gall-ink-tannin-rich",
        1.49,
        0.3,
        [2.1, 2.3, 2.6],
        IRON_GALL_SOURCE,
    ),
    film(
        "iron-gall-ink-tannin-rich-fresh",
        1.49,
        0.3,
        [2.7, 2.7, 2.5],
        IRON_GALL_SOURCE,
    ),
    film("wash", 1.48, 0.5, [0.55, 0.95, 1.5], GUM_SOURCE),
    particles("lead-point", LEAD, 0.3, [0.20, 0.20, 0.20], METAL_SOURCE),
    particles(
        "silver-point",
        SILVER,
        0.3,
        [0.26, 0.22, 0.18],
        METAL_SOURCE,
    ),
    particles(
        "black-chalk",
        SOOT,
        0.85,
        [0.035, 0.034, 0.034],
        "n + ik of soot as a stand-in for carbonaceous shale; roughness and albedo: assumed",
    ),
    particles(
        "charcoal",
        SOOT,
        0.9,
        [0.022, 0.021, 0.020],
        "n + ik of soot as a stand-in for charred wood; roughness and albedo: assumed",
    ),
    particles(
        "red-chalk",
        HEMATITE,
        0.8,
        [0.36, 0.090, 0.045],
        "n + ik of hematite, which clay dilutes; roughness and albedo: assumed",
    ),
    body(
        "white-gouache",
        400.0,
        25.0,
        [0.86, 0.86, 0.83],
        GROUND_SOURCE,
    ),
    film("watercolour", 1.48, 0.5, [1.5, 0.55, 0.25], GUM_SOURCE),
    film("carbon-ink", 1.49, 0.4, [3.3, 3.4, 3.5], GUM_SOURCE),
    film("bistre", 1.49, 0.45, [0.9, 1.7, 2.9], GUM_SOURCE),
    Medium {
        name: "blind-stylus",
        kind: MediumKind::Drawn,
        matter: Matter::Relief,
        source: "a groove without matter",
    },
    body(
        "prepared-ground",
        300.0,
        20.0,
        [0.72, 0.58, 0.52],
        GROUND_SOURCE,
    ),
    body(
        "tinted-ground",
        300.0,
        20.0,
        [0.30, 0.35, 0.38],
        GROUND_SOURCE,
    ),
];

/// The article's own values, as OPTICS.md quotes them: those of silver and lead are tabulated at
/// 1.937 µm and stand without k, those of ink and paper cite terahertz work. What it does not
/// print stays as in the catalogue.
pub(super) fn isle_2021(medium: &Medium) -> Medium {
    const SOURCE: &str = "Apollonio et al. 2021, doi 10.1145/3433606, as printed there: infrared \
         for metals, terahertz for ink and paper";
    let mut matter = medium.matter;
    match &mut matter {
        Matter::Paper(paper) => paper.index = 1.66,
        Matter::Film(ink) if medium.name.starts_with("iron-gall-ink") => ink.index = 1.35,
        Matter::Particles(metal) if medium.name == "silver-point" => {
            (metal.n, metal.k) = ([0.24; 3], [0.0; 3]);
        }
        Matter::Particles(metal) if medium.name == "lead-point" => {
            (metal.n, metal.k) = ([2.2318; 3], [0.0; 3]);
        }
        _ => return *medium,
    }
    Medium {
        matter,
        source: SOURCE,
        ..*medium
    }
}
