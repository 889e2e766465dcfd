//! Scenes and tours as written.

use super::{
    super::{
        decode::{Brief, List, Rule},
        exhibit::{
            CompareMode, Comparison, Enhancement, MAX_LAMPS, MAX_OVERLAYS, Member, SideName,
        },
        macros::record,
    },
    RawWording,
    values::{
        DeltaE, DistanceMm, Exaggeration, Fraction, Id, LampLux, Language, LayerName, Level,
        LoupeRadius, Magnification, MemberText, PlaceMm, RoomLux, Seconds, Temperature, Text,
        TiltDeg, TurnDeg, ViewMm,
    },
};
use crate::units::Degrees;

record! {
    /// A view: everything that decides a picture.
    pub struct RawScene {
        required {
            /// The name by which tours, hotspots, links and commands refer to the scene.
            id: Id,
        }
        optional {
            /// The id of a scene from which everything is taken that is not given here.
            like: Id,
            /// What the scene is called.
            title: RawWording,
            /// A few lines about what there is to see.
            text: RawWording,
            /// The id of the drawing; may be left out where there is only one.
            drawing: Id,
            /// The side. Without it: recto.
            side: SideName,
            /// The id of the state of conservation, or none for the sheet as its sides describe
            /// it.
            state: Id,
            /// What lies over the sheet, from the lowest: ids of overlays, bands (STACK/700) and
            /// views (STACK/ID) of stacks, or tables with an opacity.
            overlays: List<Brief<LayerName, RawShownOverlay>, 0, MAX_OVERLAYS>,
            /// What is shown against each other.
            compare: RawCompare,
            /// Where the eye is. Without it: above the whole sheet.
            camera: RawCamera,
            /// The ids of the lamps. Without it: the first lamp of the manifest.
            lamps: List<Id, 0, MAX_LAMPS>,
            /// Even light from the whole room. Without it: none.
            ambient: RawAmbient,
            /// How much of the light comes through the sheet, 0 to 1: 1 is a light table alone, 0 the
            /// lamps alone. Without it: 0.
            transmitted: Fraction,
            /// What a display shows at full level.
            exposure: RawExposure,
            /// What is shown other than it is, for the eye; every picture says so. Without it: nothing.
            enhance: RawEnhance,
            /// The language of the texts, by its BCP 47 tag. Without it: the visitor's.
            language: Language,
        }
        rules []
    }
}

record! {
    /// An overlay on a scene.
    pub struct RawShownOverlay {
        required {
            /// The id of the overlay, or STACK/700 or STACK/ID of a stack.
            id: LayerName,
        }
        optional {
            /// How opaque it lies there, 0 to 1. Without it: 1.
            opacity: Fraction,
            /// Of an overlay of categories, the ids of those that are shown, or their labels where
            /// they have none. Without it: all.
            categories: List<Text, 1, 256>,
        }
        rules []
    }
}

record! {
    /// A comparison.
    pub struct RawCompare {
        required {
            /// How the members are shown against each other.
            mode: CompareMode,
            /// The members, such as state:before, state:none (the sheet as its sides describe it),
            /// side:verso, overlay:damage, band:stack/700, drawing:landscape.
            of: List<MemberText, 2, 8>,
        }
        optional {
            /// Where a curtain hangs, 0 to 1 of the way across, or how much of the second member a
            /// blend or glass shows. Without it: half.
            at: Fraction,
            /// The way across a curtain, in degrees anticlockwise from the right. Without it: 0, a
            /// curtain that is drawn sideways.
            angle_deg: TurnDeg,
            /// The centre of a loupe, from the left and top edges of the picture, each 0 to 1.
            /// Without it: the middle.
            centre: [Fraction; 2],
            /// The radius of a loupe as a share of the picture's height. Without it: a quarter.
            radius: LoupeRadius,
            /// How much larger a loupe shows its member. Without it: twice.
            magnify: Magnification,
            /// The ΔE00 that a difference shows at the top of its scale. Without it: 10.
            full_delta_e: DeltaE,
            /// Shows the difference of luminance, and at which share of a white sheet's it is at the
            /// top of its scale. Without it: the difference is in ΔE00.
            full_luminance: Level,
        }
        rules [
            Rule::AtMostOne(&["full_delta_e", "full_luminance"]),
            Rule::OnlyWith("at", "mode", &["curtain", "blend", "glass"]),
            Rule::OnlyWith("angle_deg", "mode", &["curtain"]),
            Rule::OnlyWith("centre", "mode", &["loupe"]),
            Rule::OnlyWith("radius", "mode", &["loupe"]),
            Rule::OnlyWith("magnify", "mode", &["loupe"]),
            Rule::OnlyWith("full_delta_e", "mode", &["difference"]),
            Rule::OnlyWith("full_luminance", "mode", &["difference"]),
        ]
    }
}

record! {
    /// What is shown other than it is; every picture says so.
    pub struct RawEnhance {
        required {}
        optional {
            /// Shows bare paper, without what is drawn on it. Without it: false.
            relief_only: bool,
            /// How many times steeper the relief is. Without it: 1.
            exaggerate: Exaggeration,
            /// The linear display levels shown as black and as white, each 0 to 1, the lower first.
            stretch: [Fraction; 2],
            /// How much the picture is sharpened, 0 to 1. Without it: 0.
            sharpen: Fraction,
        }
        rules []
    }
}

impl RawEnhance {
    /// As it is written.
    pub fn enhancement(&self) -> Enhancement {
        let usual = Enhancement::default();
        Enhancement {
            relief_only: self.relief_only.unwrap_or(usual.relief_only),
            exaggerate: self.exaggerate.map_or(usual.exaggerate, |times| times.0),
            stretch: self.stretch.map(|ends| ends.map(|end| end.0).into()),
            sharpen: self.sharpen.map_or(usual.sharpen, |share| share.0),
        }
    }

    /// Whether black and white of a stretched contrast are two, the lower first.
    pub fn is_stretch_sound(&self) -> bool {
        self.stretch
            .is_none_or(|[low, high]| high.0 - low.0 >= NARROWEST_STRETCH)
    }
}

/// A contrast that is stretched further shows nothing but noise.
const NARROWEST_STRETCH: f64 = 0.01;

impl RawCompare {
    /// As it is written, its members resolved to `of`.
    pub fn comparison(&self, of: Vec<Member>) -> Comparison {
        let usual = Comparison::new(self.mode, of);
        let share = |share: Option<Fraction>, usual: f64| share.map_or(usual, |share| share.0);
        let centre = self.centre.map(|centre| centre.map(|share| share.0).into());
        Comparison {
            at: share(self.at, usual.at),
            angle: Degrees(self.angle_deg.map_or(usual.angle.0, |angle| angle.0)),
            centre: centre.unwrap_or(usual.centre),
            radius: self.radius.map_or(usual.radius, |radius| radius.0),
            magnify: self.magnify.map_or(usual.magnify, |magnify| magnify.0),
            full_delta_e: self.full_delta_e.map_or(usual.full_delta_e, |e| e.0),
            full_luminance: self.full_luminance.map(|level| level.0),
            ..usual
        }
    }
}

record! {
    /// The eye.
    pub struct RawCamera {
        required {}
        optional {
            /// What it looks at, in mm from the left and top edges of the side. Without it: the
            /// centre.
            centre_mm: [PlaceMm; 2],
            /// The width of the view at this point in mm. Without it: the whole sheet.
            width_mm: ViewMm,
            /// How far the eye leans from straight above towards the bottom edge, in degrees.
            tilt_deg: TiltDeg,
            /// How far the eye walks around the sheet, in degrees, anticlockwise as seen from
            /// above.
            turn_deg: TurnDeg,
            /// How far the eye is away in mm. Without it: infinitely far, so that there is no
            /// perspective.
            distance_mm: DistanceMm,
        }
        rules []
    }
}

record! {
    /// Even light from the whole room.
    pub struct RawAmbient {
        required {
            /// The illuminance that it alone gives to the sheet, in lx.
            lux: RoomLux,
        }
        optional {
            /// Its colour temperature in K. Without it: 6504.
            kelvin: Temperature,
        }
        rules []
    }
}

record! {
    /// What a display shows at full level.
    pub struct RawExposure {
        required {}
        optional {
            /// The illuminance in lx at which a perfectly white sheet is shown at this level.
            /// Without it: what the scene's own light gives to the centre of the sheet.
            lux: LampLux,
            /// The linear display level of that white sheet. Without it: 1.
            level: Level,
            /// The colour temperature in K that is shown as neutral. Without it: 6504.
            white_kelvin: Temperature,
        }
        rules []
    }
}

record! {
    /// A series of scenes that runs by itself.
    pub struct RawTour {
        required {
            /// The name by which an installation refers to the tour; attract runs when nobody is
            /// there.
            id: Id,
            /// The scenes in their order: their ids, or tables with a time.
            scenes: List<Brief<Id, RawStop>, 1, 1000>,
        }
        optional {
            /// What the tour is called.
            title: RawWording,
        }
        rules []
    }
}

record! {
    /// A scene of a tour.
    pub struct RawStop {
        required {
            /// The id of the scene.
            scene: Id,
        }
        optional {
            /// How long it stays, in seconds. Without it: 10.
            seconds: Seconds,
        }
        rules []
    }
}
