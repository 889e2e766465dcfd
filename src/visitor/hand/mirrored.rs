//! The hand as another machine is told of it, and a hand that is led: what is shown follows from it alone,
//! and nothing moves by itself.

use std::{collections::BTreeMap, str::FromStr};

use glam::DVec2;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::{FARTHEST_TURN_DEG, Hand, Serving};
use crate::{
    manifest::exhibit::{
        Camera, CompareMode, Comparison, Enhancement, Exhibit, Member, OverlayKind, SideName,
    },
    optics::tier::Tier,
    units::{Degrees, Lux},
    visitor::{
        lamp::LampPlace,
        view::{Glow, Layer, View},
    },
};

/// No sheet, and no picture of one, is larger, in mm.
const LARGEST_MM: f64 = 1e6;
/// No lamp of a hand is farther from these, in kelvin, and none is stronger by more.
const KELVIN: [f64; 2] = [1000.0, 40_000.0];
const MOST_GAIN: f64 = 1000.0;

/// A finite number that arrives as it went, to the last bit: as text, since readers of JSON round.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exact(pub f64);

impl Serialize for Exact {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{:?}", self.0))
    }
}

impl<'de> Deserialize<'de> for Exact {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number
            .map(Self)
            .ok_or_else(|| de::Error::custom("a finite number was expected"))
    }
}

/// Two of them.
pub type Pair = [Exact; 2];

pub fn pair(of: DVec2) -> Pair {
    of.to_array().map(Exact)
}

pub fn vector([x, y]: Pair) -> DVec2 {
    DVec2::new(x.0, y.0)
}

/// A member of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ToldMember {
    State(Option<usize>),
    Side(SideName),
    Overlay(usize),
    Drawing(usize),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ToldComparison {
    mode: CompareMode,
    of: Vec<ToldMember>,
    at: Exact,
    angle: Exact,
    centre: Pair,
    radius: Exact,
    magnify: Exact,
    full_delta_e: Exact,
    full_luminance: Option<Exact>,
    coded: bool,
    turn: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ToldCamera {
    centre_mm: Pair,
    width_mm: Exact,
    tilt: Exact,
    turn: Exact,
    distance_mm: Option<Exact>,
}

/// Everything of a hand that decides the picture, for one that holds the same exhibit. Scenes, states,
/// overlays and drawings are told by their places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToldHand {
    scene: usize,
    side: SideName,
    camera: ToldCamera,
    state: Option<usize>,
    /// Overlay, opacity, and whether it is on, from the lowest.
    layers: Vec<(usize, Exact, bool)>,
    categories: BTreeMap<usize, Vec<usize>>,
    /// Elevation and azimuth.
    lamp: Option<Pair>,
    kelvin: Option<Exact>,
    gain: Exact,
    exposed_for: Option<Exact>,
    compare: Option<ToldComparison>,
    relief_only: bool,
    exaggerate: Exact,
    stretch: Option<Pair>,
    sharpen: Exact,
    transmitted: Exact,
    /// How the sheet is turned, and since when it is being turned over.
    turn: Pair,
    flip: Option<Exact>,
    both_sides: bool,
    language: Option<String>,
    calm: bool,
    /// At rest, and in which it is drawn just now.
    tier: String,
    drawn: String,
    hotspots: bool,
    open: Option<String>,
}

impl Hand {
    /// What another machine needs to show the same.
    pub fn told(&self) -> ToldHand {
        let view = &self.view;
        let drawn = self.shown().tier;
        ToldHand {
            scene: self.scene,
            side: view.side,
            camera: ToldCamera {
                centre_mm: pair(view.camera.centre_mm),
                width_mm: Exact(view.camera.width_mm),
                tilt: Exact(view.camera.tilt.0),
                turn: Exact(view.camera.turn.0),
                distance_mm: view.camera.distance_mm.map(Exact),
            },
            state: view.state,
            layers: view
                .layers
                .iter()
                .map(|layer| (layer.overlay, Exact(layer.opacity), layer.on))
                .collect(),
            categories: view.categories.clone(),
            lamp: view
                .lamp
                .map(|lamp| [lamp.elevation_deg, lamp.azimuth_deg].map(Exact)),
            kelvin: view.glow.kelvin.map(Exact),
            gain: Exact(view.glow.gain),
            exposed_for: self.exposed_for.map(|lux| Exact(lux.0)),
            compare: view.compare.as_ref().map(ToldComparison::of),
            relief_only: view.enhance.relief_only,
            exaggerate: Exact(view.enhance.exaggerate),
            stretch: view.enhance.stretch.map(pair),
            sharpen: Exact(view.enhance.sharpen),
            transmitted: Exact(view.transmitted),
            turn: pair(self.turn),
            flip: self.flip.map(Exact),
            both_sides: self.both_sides,
            language: self.language.clone(),
            calm: self.calm,
            tier: self.tier_at_rest().name().to_owned(),
            drawn: drawn.name().to_owned(),
            hotspots: self.hotspots.is_shown(),
            open: self.hotspots.open_id().map(str::to_owned),
        }
    }

    /// From now on it is what it is told, and moves by itself no more.
    ///
    /// # Errors
    /// In words, where what is told is none of this exhibit's; the hand stays as it is then.
    pub fn be(&mut self, told: &ToldHand) -> Result<(), String> {
        told.check(&self.exhibit)?;
        let [tier, drawn] = [&told.tier, &told.drawn].map(|name| Tier::from_str(name));
        let (Ok(tier), Ok(drawn)) = (tier, drawn) else {
            return Err(format!("the tiers {} and {}", told.tier, told.drawn));
        };
        let view = told.view();
        let relit =
            (view.lamp, view.glow) != (self.view.lamp, self.view.glow) || told.scene != self.scene;
        self.still();
        (self.scene, self.view) = (told.scene, view);
        self.is_led = true;
        if relit {
            self.relight();
        }
        self.exposed_for = told.exposed_for.map(|lux| Lux(lux.0));
        self.turn = vector(told.turn).clamp_length_max(FARTHEST_TURN_DEG);
        self.flip = told.flip.map(|seconds| seconds.0);
        self.both_sides = told.both_sides;
        self.language.clone_from(&told.language);
        self.calm = told.calm;
        (self.free, self.tier, self.hurried) = (true, tier, drawn != tier);
        self.serving = Some(Serving {
            at_rest: tier,
            in_motion: drawn,
        });
        self.stop = None;
        self.hotspots.be(told.hotspots, told.open.clone());
        Ok(())
    }
}

impl ToldComparison {
    fn of(comparison: &Comparison) -> Self {
        let member = |member: &Member| match *member {
            Member::State(state) => ToldMember::State(state),
            Member::Side(side) => ToldMember::Side(side),
            Member::Overlay(overlay) => ToldMember::Overlay(overlay),
            Member::Drawing(drawing) => ToldMember::Drawing(drawing),
        };
        Self {
            mode: comparison.mode,
            of: comparison.of.iter().map(member).collect(),
            at: Exact(comparison.at),
            angle: Exact(comparison.angle.0),
            centre: pair(comparison.centre),
            radius: Exact(comparison.radius),
            magnify: Exact(comparison.magnify),
            full_delta_e: Exact(comparison.full_delta_e),
            full_luminance: comparison.full_luminance.map(Exact),
            coded: comparison.coded,
            turn: comparison.turn,
        }
    }

    fn comparison(&self) -> Comparison {
        let member = |member: &ToldMember| match *member {
            ToldMember::State(state) => Member::State(state),
            ToldMember::Side(side) => Member::Side(side),
            ToldMember::Overlay(overlay) => Member::Overlay(overlay),
            ToldMember::Drawing(drawing) => Member::Drawing(drawing),
        };
        Comparison {
            mode: self.mode,
            of: self.of.iter().map(member).collect(),
            at: self.at.0,
            angle: Degrees(self.angle.0),
            centre: vector(self.centre),
            radius: self.radius.0,
            magnify: self.magnify.0,
            full_delta_e: self.full_delta_e.0,
            full_luminance: self.full_luminance.map(|full| full.0),
            coded: self.coded,
            turn: self.turn,
        }
    }
}

impl ToldHand {
    fn view(&self) -> View {
        let camera = Camera {
            centre_mm: vector(self.camera.centre_mm),
            width_mm: self.camera.width_mm.0,
            tilt: Degrees(self.camera.tilt.0),
            turn: Degrees(self.camera.turn.0),
            distance_mm: self.camera.distance_mm.map(|mm| mm.0),
        };
        let layer = |(overlay, opacity, on): &(usize, Exact, bool)| Layer {
            overlay: *overlay,
            opacity: opacity.0,
            on: *on,
        };
        View {
            side: self.side,
            camera,
            state: self.state,
            layers: self.layers.iter().map(layer).collect(),
            categories: self.categories.clone(),
            lamp: self.lamp.map(|[elevation, azimuth]| LampPlace {
                elevation_deg: elevation.0,
                azimuth_deg: azimuth.0,
            }),
            glow: Glow {
                kelvin: self.kelvin.map(|kelvin| kelvin.0),
                gain: self.gain.0,
            },
            compare: self.compare.as_ref().map(ToldComparison::comparison),
            enhance: Enhancement {
                relief_only: self.relief_only,
                exaggerate: self.exaggerate.0,
                stretch: self.stretch.map(vector),
                sharpen: self.sharpen.0,
            },
            transmitted: self.transmitted.0,
        }
    }

    /// Whether all of it is of this exhibit, and all numbers are such as hands make them.
    fn check(&self, exhibit: &Exhibit) -> Result<(), String> {
        let scene = exhibit.scenes.get(self.scene);
        let scene = scene.ok_or_else(|| format!("scene number {}", self.scene))?;
        let drawing = exhibit.drawing_of(scene);
        let within = |name: &str, value: f64, [least, most]: [f64; 2]| match value {
            value if (least..=most).contains(&value) => Ok(()),
            value => Err(format!("{name} of {value}")),
        };
        let there = |name: &str, index: usize, count: usize| match index < count {
            true => Ok(()),
            false => Err(format!("{name} number {index} of {count}")),
        };
        let overlays = drawing.overlays.len();
        let mut seen = vec![false; overlays];
        for (overlay, opacity, _) in &self.layers {
            there("overlay", *overlay, overlays)?;
            within("an opacity", opacity.0, [0.0, 1.0])?;
            if std::mem::replace(&mut seen[*overlay], true) {
                return Err(format!("overlay number {overlay} twice"));
            }
        }
        if seen.contains(&false) {
            return Err("overlays that are missing".to_owned());
        }
        for (overlay, categories) in &self.categories {
            there("overlay", *overlay, overlays)?;
            let count = match &drawing.overlays[*overlay].kind {
                OverlayKind::Categorical(entries) => entries.len(),
                _ => 0,
            };
            for category in categories {
                there("category", *category, count)?;
            }
        }
        if let Some(state) = self.state {
            there("state", state, drawing.states.len())?;
        }
        let place = [-LARGEST_MM, LARGEST_MM];
        for mm in self.camera.centre_mm {
            within("a place", mm.0, place)?;
        }
        within("a width", self.camera.width_mm.0, [1e-3, LARGEST_MM])?;
        within("a tilt", self.camera.tilt.0, [0.0, 89.0])?;
        within("a turn", self.camera.turn.0, [-720.0, 720.0])?;
        if let Some(mm) = self.camera.distance_mm {
            within("a distance", mm.0, [1e-3, LARGEST_MM])?;
        }
        if let Some([elevation, azimuth]) = self.lamp {
            within("an elevation", elevation.0, [0.0, 90.0])?;
            within("an azimuth", azimuth.0, [-720.0, 720.0])?;
        }
        if let Some(kelvin) = self.kelvin {
            within("a temperature", kelvin.0, KELVIN)?;
        }
        within("a gain", self.gain.0, [0.0, MOST_GAIN])?;
        if let Some(lux) = self.exposed_for {
            within("an exposure", lux.0, [1e-9, 1e9])?;
        }
        within("an exaggeration", self.exaggerate.0, [0.0, 1000.0])?;
        if let Some([black, white]) = self.stretch {
            within("a level", white.0, [black.0.max(-1.0) + 1e-6, 1000.0])?;
        }
        within("sharpening", self.sharpen.0, [0.0, 1.0])?;
        within("transmitted light", self.transmitted.0, [0.0, 1.0])?;
        if let Some(seconds) = self.flip {
            within("a time", seconds.0, [0.0, 60.0])?;
        }
        let Some(compare) = &self.compare else {
            return Ok(());
        };
        for member in &compare.of {
            match *member {
                ToldMember::State(Some(state)) => there("state", state, drawing.states.len())?,
                ToldMember::Overlay(overlay) => there("overlay", overlay, overlays)?,
                ToldMember::Drawing(other) => there("drawing", other, exhibit.drawings.len())?,
                ToldMember::State(None) | ToldMember::Side(_) => {}
            }
        }
        there("member", compare.turn, compare.of.len())?;
        within("a curtain", compare.at.0, [-1.0, 2.0])?;
        within("an angle", compare.angle.0, [-720.0, 720.0])?;
        for share in compare.centre {
            within("a loupe's place", share.0, [-100.0, 100.0])?;
        }
        within("a loupe's radius", compare.radius.0, [1e-3, 100.0])?;
        within("a magnification", compare.magnify.0, [1e-3, 1000.0])?;
        within("a scale", compare.full_delta_e.0, [1e-6, 1e6])?;
        if let Some(full) = compare.full_luminance {
            within("a scale", full.0, [1e-6, 1e6])?;
        }
        match compare.mode.refuses(&compare.comparison().of) {
            Some((found, _)) => Err(found),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_arrives_to_the_last_bit_and_only_a_finite_one() {
        for number in [0.1 + 0.2, -0.0, 1e-308, 210.0, f64::MAX, 1.0 / 3.0] {
            let text = serde_json::to_string(&Exact(number)).unwrap();
            let back: Exact = serde_json::from_str(&text).unwrap();
            assert_eq!(back.0.to_bits(), number.to_bits(), "{text}");
        }
        for text in ["\"NaN\"", "\"inf\"", "\"\"", "1.5", "\"1e999\""] {
            assert!(serde_json::from_str::<Exact>(text).is_err(), "{text}");
        }
    }
}
