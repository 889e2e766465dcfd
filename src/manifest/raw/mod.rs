//! The manifest as written: plain data, every key of the format declared once.
//!
//! What is declared here is what [`schema`](super::schema) publishes, and its comments are what
//! a curator's editor shows; so they speak to curators. `prepare` writes manifests through these
//! types.

pub mod lamp;
pub mod medium;
pub mod scene;
pub mod stack;
pub mod values;

use super::{
    decode::{Brief, Decode, Dictionary, List, Node, OfKind, OneOrMany, Report, Rule, required},
    exhibit::{FlipAxis, ShowThrough, SideName, Source},
    hotspot::MAX_PLACES,
    macros::{kinds, placed_record, record},
};
use crate::{
    maps::{ColourEncoding, ColourMapName, MAX_WEIGHTS, NormalY, registration::FitKind},
    optics::medium::Preset,
};
pub use lamp::RawLamp;
pub use medium::{RawAlbedo, RawMedium};
pub use scene::{
    RawAmbient, RawCamera, RawCompare, RawEnhance, RawExposure, RawScene, RawShownOverlay, RawStop,
    RawTour,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
pub use stack::{RawBand, RawDifference, RawFalseColour, RawStack};
use values::{
    Alpha, BackwardCosine, ChainLinesMm, DateText, DeltaE, FilePath, ForwardCosine, Fraction,
    FrameMs, HexColour, Id, Language, MediumName, OffsetMm, PaperName, PixelPx, PlaceMm, Quantity,
    RefractiveIndex, ReliefUm, Scale, ScatteringPerMm, SheetMm, Text, ThicknessUm, TurnDeg,
};

/// A text in one language, or in several by their tags.
pub type RawWording = Brief<Text, Dictionary<Language, Text>>;

record! {
    /// An exhibit of drawings: the file exhibit.toml.
    pub struct RawManifest {
        required {
            /// The sheets, each below its own `[[drawing]]`.
            drawing: List<RawDrawing, 1>,
        }
        optional {
            /// The exhibit as a whole.
            exhibit: RawExhibit,
            /// The lamps that scenes name, each below its own `[[lamp]]`. Without any, one distant
            /// lamp shines from the top left at 45°.
            lamp: List<RawLamp>,
            /// Media with constants of their own, each below its own `[[medium]]`.
            medium: List<RawMedium>,
            /// The views, each below its own `[[scene]]`. Without any, the recto of each drawing
            /// is one.
            scene: List<RawScene>,
            /// Series of scenes that run by themselves, each below its own `[[tour]]`.
            tour: List<RawTour>,
            /// How exact the pictures have to be.
            accuracy: RawAccuracy,
        }
        rules []
    }
}

record! {
    /// The exhibit as a whole.
    pub struct RawExhibit {
        required {}
        optional {
            /// What the exhibit is called.
            title: RawWording,
            /// The languages offered, by their BCP 47 tags, the preferred one first. Without it:
            /// English.
            languages: List<Language, 1, 64>,
            /// What a display shows at full level, for every scene that does not say otherwise.
            exposure: RawExposure,
            /// Whose constants the media of the catalogue have: recto, or isle-2021 for those
            /// that an article of 2021 prints. Without it: recto.
            optics: Preset,
        }
        rules []
    }
}

record! {
    /// One sheet.
    pub struct RawDrawing {
        required {
            /// The name by which scenes refer to the drawing.
            id: Id,
            /// Width and height of the sheet in mm.
            size_mm: [SheetMm; 2],
            /// The front of the sheet.
            recto: Complete,
        }
        optional {
            /// What the drawing is called.
            title: RawWording,
            /// A few lines about it.
            caption: RawWording,
            /// Whose picture it is.
            credit: Text,
            /// When it was drawn, in words or numbers.
            date: Text,
            /// The inventory number.
            inventory: Text,
            /// What the sheet is made of: a word, or a table with details.
            paper: Brief<PaperName, RawPaper>,
            /// A picture that is white where the sheet is and black where it is not, as seen on
            /// the recto: for irregular edges, losses and holes.
            outline: Brief<FilePath, RawPlainMap>,
            /// The shape of the sheet at large, where it does not lie flat.
            surface: RawSurface,
            /// The back of the sheet. Without it: bare paper.
            verso: Complete,
            /// What shows when light comes through the sheet.
            transmission: RawTransmission,
            /// States of conservation, each below its own `[[drawing.state]]`.
            state: List<RawState>,
            /// Thematic maps laid over the sheet, each below its own `[[drawing.overlay]]`.
            overlay: List<RawOverlay>,
            /// Sets of pictures in several bands of light, each below its own
            /// `[[drawing.stack]]`.
            stack: List<RawStack>,
            /// Regions that something is said about, each below its own `[[drawing.hotspot]]`.
            hotspot: List<RawHotspot>,
        }
        rules []
    }
}

record! {
    /// What a sheet is made of.
    pub struct RawPaper {
        required {}
        optional {
            /// The paper, by its name in the catalogue. Without it: laid.
            kind: PaperName,
            /// Thickness in µm. Without it: the catalogue's.
            thickness_um: ThicknessUm,
            /// Distance between chain lines in mm, for laid paper.
            chain_lines_mm: ChainLinesMm,
            /// Roughness α of the bare surface, 0.01 (mirror) to 1. Without it: the catalogue's.
            roughness: Alpha,
            /// Refractive index of the surface. Without it: the catalogue's.
            index: RefractiveIndex,
            /// Strength of the surface's gloss, 0 (off) to 1 (physical). Without it: 1.
            specular: Fraction,
            /// Colour of the bare paper as photographed. Without it: what the picture shows
            /// where it is lightest.
            albedo: RawAlbedo,
            /// Scattering coefficient in 1/mm. Without it: the catalogue's.
            scattering_per_mm: ScatteringPerMm,
            /// Share of the light that is scattered forwards. Without it: the catalogue's.
            forward_share: Fraction,
            /// Mean cosine of what is scattered forwards. Without it: the catalogue's.
            g_forward: ForwardCosine,
            /// Mean cosine of what is scattered backwards. Without it: the catalogue's.
            g_backward: BackwardCosine,
            /// Share of the gloss that goes back to the lamp, 0 (off) to 1. Without it: 0.
            retro: Fraction,
            /// Strength of the sheen, 0 (off) to 1. Without it: 0.
            sheen: Fraction,
            /// How much more the gloss spreads one way than across it, 0 to 1. Without it: 0.
            anisotropy: Fraction,
            /// The way it spreads more, in degrees anticlockwise from the right as the recto is
            /// seen. Without it: 0.
            anisotropy_deg: TurnDeg,
            /// Where the other side's ink, as it shows in reflected light, comes from: photographed
            /// (the pictures of the sides hold it) or modelled (they hold none, being generated or
            /// cleaned, and the study tier computes it). Without it: photographed.
            show_through: ShowThrough,
            /// Where these constants come from. Without it: assumed.
            source: Source,
        }
        rules []
    }
}

record! {
    /// The shape of a sheet that does not lie flat.
    pub struct RawSurface {
        required {}
        optional {
            /// Heights of the sheet towards whoever looks at the recto.
            height: RawHeightMap,
            /// A binary glTF file (.glb) whose first mesh is the sheet, in mm around its centre,
            /// with texture coordinates over the recto.
            gltf: FilePath,
        }
        rules [Rule::ExactlyOne(&["height", "gltf"])]
    }
}

record! {
    /// The maps of one side.
    pub struct RawSide {
        required {}
        optional {
            /// The colour of the side: its picture in even light.
            albedo: Brief<FilePath, RawColourMap>,
            /// The directions of the surface.
            normal: Brief<FilePath, RawNormalMap>,
            /// The heights of the surface.
            height: RawHeightMap,
            /// The roughness of the surface: white is rough.
            roughness: Brief<FilePath, RawPlainMap>,
            /// The gloss of the surface: white is smooth.
            gloss: Brief<FilePath, RawPlainMap>,
            /// What was drawn with; several tables, from the lowest, where media lie over each
            /// other.
            media: OneOrMany<RawMediaMap>,
            /// How the maps lie on the sheet, where they do not cover it exactly.
            register: RawRegister,
            /// Points of the maps and where they lie on the sheet; one shifts the maps, two turn
            /// and scale them too, three or more also stretch them.
            control_points: List<RawControlPoint, 1, 1000>,
            /// What the points do: shift, similarity (also turn and scale), affine (also stretch)
            /// or thin-plate (also bend, so that every point lies where it was found). Without
            /// it: by their number, and never bend.
            fit: FitKind,
            /// Where the maps come from, for each that does not say so itself. Without it:
            /// assumed.
            source: Source,
        }
        rules [
            Rule::AtMostOne(&["roughness", "gloss"]),
            Rule::Needs("fit", "control_points"),
        ]
    }
}

/// The maps of a side that has at least an albedo.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Complete(pub RawSide);

impl Decode for Complete {
    fn allowed() -> String {
        "a table with an albedo".to_owned()
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        let side = RawSide::decode(node, report)?;
        if side.albedo.is_none() && node.get("albedo").is_none() {
            required::<Brief<FilePath, RawColourMap>>(node, "albedo", report)?;
        }
        side.albedo.is_some().then_some(Self(side))
    }
}

impl JsonSchema for Complete {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "CompleteSide".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "allOf": [generator.subschema_for::<RawSide>(), { "required": ["albedo"] }],
        })
    }
}

record! {
    /// A map of colour.
    pub struct RawColourMap {
        required {
            /// The picture.
            file: FilePath,
        }
        optional {
            /// How its values encode light. Without it: by the embedded ICC profile, or else
            /// sRGB for integers and linear for floats.
            encoding: ColourEncoding,
            /// Where it comes from.
            source: Source,
        }
        rules []
    }
}

record! {
    /// A map of surface directions.
    pub struct RawNormalMap {
        required {
            /// The picture.
            file: FilePath,
        }
        optional {
            /// Whether its green points up (OpenGL) or down (DirectX). Without it: up.
            y: NormalY,
            /// Where it comes from.
            source: Source,
        }
        rules []
    }
}

record! {
    /// A map of heights.
    pub struct RawHeightMap {
        required {
            /// The picture.
            file: FilePath,
            /// The heights of black and of white in µm.
            range_um: [ReliefUm; 2],
        }
        optional {
            /// Where it comes from.
            source: Source,
        }
        rules []
    }
}

record! {
    /// A map of grey values.
    pub struct RawPlainMap {
        required {
            /// The picture.
            file: FilePath,
        }
        optional {
            /// Where it comes from.
            source: Source,
        }
        rules []
    }
}

record! {
    /// A map of media: either a legend says which colour is which medium, or each channel is the
    /// coverage of one.
    pub struct RawMediaMap {
        required {
            /// The picture.
            file: FilePath,
        }
        optional {
            /// Up to four colours in the file and the medium that each means; other colours are
            /// bare paper.
            legend: Dictionary<HexColour, MediumName, MAX_WEIGHTS>,
            /// The medium of each channel, in their order.
            weights: List<MediumName, 1, MAX_WEIGHTS>,
            /// Where it comes from.
            source: Source,
        }
        rules [Rule::ExactlyOne(&["legend", "weights"])]
    }
}

record! {
    /// How pictures lie on the sheet: scaled and turned about its centre, then shifted.
    pub struct RawRegister {
        required {}
        optional {
            /// Only for the verso: how the sheet is turned over, horizontal (as a page is) or
            /// vertical. Without it: horizontal.
            flip: FlipAxis,
            /// The shift to the right and down in mm.
            offset_mm: [OffsetMm; 2],
            /// The turn in degrees, anticlockwise as somebody sees who looks at the side.
            rotate_deg: TurnDeg,
            /// The size relative to a picture that just covers the sheet.
            scale: Scale,
        }
        rules []
    }
}

record! {
    /// A point that is known both in a picture and on the sheet.
    pub struct RawControlPoint {
        required {
            /// Pixels from the left and top edges of the picture.
            picture: [PixelPx; 2],
            /// mm from the left and top edges of the sheet, on the side in question.
            sheet_mm: [PlaceMm; 2],
        }
        optional {}
        rules []
    }
}

record! {
    /// What shows in transmitted light.
    pub struct RawTransmission {
        required {
            /// A picture of the sheet on a light table: thickness, laid and chain lines,
            /// watermark.
            map: Brief<FilePath, RawPlainMap>,
        }
        optional {}
        rules []
    }
}

record! {
    /// A state of conservation: the maps given here replace those of the drawing's sides.
    pub struct RawState {
        required {
            /// The name by which scenes refer to the state.
            id: Id,
        }
        optional {
            /// What the state is called.
            title: RawWording,
            /// When it was: a year, a month or a day.
            date: DateText,
            /// What it replaces on the recto.
            recto: RawSide,
            /// What it replaces on the verso.
            verso: RawSide,
        }
        rules [Rule::AtLeastOne(&["recto", "verso"])]
    }
}

/// A thematic map.
pub type RawOverlay = OfKind<RawOverlayCommon, RawOverlayKind>;

placed_record! {
    /// A thematic map laid over the sheet.
    pub struct RawOverlayCommon {
        required {
            /// The name by which scenes refer to the overlay.
            id: Id,
            /// The picture.
            file: FilePath,
        }
        optional {
            /// What the overlay is called.
            title: RawWording,
            /// The side that it belongs to. Without it: recto.
            side: SideName,
        }
        placed by {
            /// How it lies on the sheet, where it does not cover it exactly.
            register,
            /// Points of the picture and where they lie on the sheet.
            control_points,
            /// Where it comes from. Without it: assumed.
            source,
        }
    }
}

kinds! {
    /// The kinds of overlay.
    pub enum RawOverlayKind {
        /// A map of categories, each a colour.
        Categorical(RawCategorical) = "categorical",
        /// A map of a measured quantity.
        Continuous(RawContinuous) = "continuous",
        /// Another picture of the sheet, such as an infrared one.
        Picture(RawPicture) = "picture",
    }
}

record! {
    /// A map of categories.
    pub struct RawCategorical {
        required {
            /// The categories in the order in which they are listed.
            legend: List<RawLegendEntry, 1, 256>,
        }
        optional {}
        rules []
    }
}

record! {
    /// One category.
    pub struct RawLegendEntry {
        required {
            /// Its colour in the file and on the screen.
            colour: HexColour,
            /// What it is.
            label: RawWording,
        }
        optional {
            /// The name by which scenes switch it on. Without it: its label.
            id: Id,
        }
        rules []
    }
}

record! {
    /// A map of a quantity.
    pub struct RawContinuous {
        required {
            /// The unit of the quantity.
            unit: Text,
            /// The values of black and of white in this unit.
            range: [Quantity; 2],
        }
        optional {
            /// The colours that show it. Without it: viridis.
            colour_map: ColourMapName,
        }
        rules []
    }
}

record! {
    /// Another picture.
    pub struct RawPicture {
        required {}
        optional {
            /// How its values encode light. Without it: by the embedded ICC profile, or else
            /// sRGB for integers and linear for floats.
            encoding: ColourEncoding,
        }
        rules []
    }
}

record! {
    /// A region of a side that something is said about.
    pub struct RawHotspot {
        required {
            /// The name by which the hotspot is told from the others of its drawing.
            id: Id,
            /// The places around it, in mm from the left and top edges of its side, in order either
            /// way round; the last is joined to the first.
            polygon_mm: List<[PlaceMm; 2], 3, MAX_PLACES>,
            /// What there is.
            title: RawWording,
        }
        optional {
            /// The side that it lies on. Without it: recto.
            side: SideName,
            /// A few lines about it.
            text: RawWording,
            /// The id of a scene that it leads to.
            scene: Id,
        }
        rules []
    }
}

record! {
    /// How exact the pictures have to be.
    pub struct RawAccuracy {
        required {}
        optional {
            /// The largest colour difference ΔE00 from the exact picture, in the mean over the visible
            /// sheet. Without it: 1.
            max_delta_e: DeltaE,
            /// The longest time in ms for one frame while something moves. Without it: 16.
            frame_ms: FrameMs,
        }
        rules []
    }
}
