//! Tools in the hand: which one, the places where it is being laid, and what was read. No device,
//! window or engine is needed to lay one.

use bevy::prelude::Resource;
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{
    hand::mirrored::{Exact, Pair, pair, vector},
    view::wrapped,
};
use crate::{
    manifest::{exhibit::SideName, hotspot::contains},
    readings::{Disc, PROBE_MM, Reading, Tool, Why, sight::Seen},
};

/// Places nearer to each other are one, in pixels of the picture.
const SAME_PX: f64 = 2.0;

/// What can be laid on the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Ruler,
    Path,
    Area,
    Angle,
    Profile,
    Lines,
    Stroke,
    Probe,
    Difference,
}

impl Kind {
    /// In the order in which a key goes through them.
    pub const ALL: [Self; 9] = [
        Self::Ruler,
        Self::Path,
        Self::Area,
        Self::Angle,
        Self::Profile,
        Self::Lines,
        Self::Stroke,
        Self::Probe,
        Self::Difference,
    ];

    /// Whether it ends only when somebody says so.
    fn is_open(self) -> bool {
        matches!(self, Self::Path | Self::Area)
    }

    /// How many places it has, or has at least.
    fn places(self) -> usize {
        match self {
            Self::Probe => 1,
            Self::Angle | Self::Area => 3,
            _ => 2,
        }
    }

    /// Whether the last place is joined to the first.
    pub fn is_closed(self) -> bool {
        self == Self::Area
    }

    /// The tool at its places.
    fn at(self, places: &[DVec2]) -> Option<Tool> {
        let disc = |middle| Disc {
            middle,
            radius_mm: PROBE_MM,
        };
        Some(match (self, places) {
            (Self::Ruler, &[a, b]) => Tool::Ruler([a, b]),
            (Self::Path, [_, _, ..]) => Tool::Path {
                places: places.to_vec(),
                closed: false,
            },
            (Self::Area, [_, _, _, ..]) => Tool::Path {
                places: places.to_vec(),
                closed: true,
            },
            (Self::Angle, &[a, b, c]) => Tool::Angle([a, b, c]),
            (Self::Profile, &[a, b]) => Tool::Profile([a, b]),
            (Self::Lines, &[a, b]) => Tool::Lines([a, b]),
            (Self::Stroke, &[a, b]) => Tool::Stroke([a, b]),
            (Self::Probe, &[a]) => Tool::Probe(disc(a)),
            (Self::Difference, &[a, b]) => Tool::Difference([disc(a), disc(b)]),
            _ => return None,
        })
    }
}

/// A side of a drawing in a state, by their ids.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnSide {
    pub drawing: String,
    pub side: SideName,
    /// `None` for the sheet as its sides describe it.
    pub state: Option<String>,
}

/// What came of a tool.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// Its maps are being read.
    Waiting,
    Read(Reading),
    /// Why there is no reading.
    Nothing(Why),
}

/// A tool that lies on the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Laid {
    /// Its own, never another's.
    pub number: u64,
    pub on: OnSide,
    pub kind: Kind,
    pub tool: Tool,
    pub places: Vec<DVec2>,
    /// Size of a pixel on the sheet in mm, where its places were pointed at.
    pub screen_mm: f64,
    /// On which of the sheets that share the picture.
    pub sheet: usize,
    pub said: Said,
}

/// The tool in the hand, and those that lie on the sheet.
#[derive(Resource, Clone, Debug, Default)]
pub struct Measuring {
    kind: Option<Kind>,
    /// Where the tool in the hand was laid down so far.
    laying: Option<Laying>,
    laid: Vec<Laid>,
    numbers: u64,
    /// The click that ends a path is no place of the next one.
    ended: bool,
}

/// A tool that is being laid.
#[derive(Clone, Debug, PartialEq)]
pub struct Laying {
    pub on: OnSide,
    pub places: Vec<DVec2>,
    screen_mm: f64,
    sheet: usize,
}

impl Measuring {
    /// The tool in the hand.
    pub fn kind(&self) -> Option<Kind> {
        self.kind
    }

    /// What is being laid.
    pub fn laying(&self) -> Option<&Laying> {
        self.laying.as_ref()
    }

    /// What lies on the sheet, in the order in which it was laid.
    pub fn laid(&self) -> &[Laid] {
        &self.laid
    }

    /// What was read, with its place among all that lies there, from 1.
    pub fn readings(&self) -> impl Iterator<Item = (usize, &Reading)> {
        (1..)
            .zip(&self.laid)
            .filter_map(|(number, laid)| match &laid.said {
                Said::Read(reading) => Some((number, reading)),
                Said::Waiting | Said::Nothing(_) => None,
            })
    }

    /// Whether nothing is being measured, nor waited for.
    pub fn is_idle(&self) -> bool {
        let waits = |laid: &Laid| laid.said == Said::Waiting;
        self.kind.is_none() && !self.laid.iter().any(waits)
    }

    /// Takes the next tool (1) or the one before (−1), and none between the last and the first.
    pub fn step(&mut self, by: i32) {
        let place = self
            .kind
            .and_then(|kind| Kind::ALL.iter().position(|k| *k == kind));
        let next = wrapped(place.map_or(0, |place| place + 1), by, Kind::ALL.len() + 1);
        self.kind = next.checked_sub(1).map(|index| Kind::ALL[index]);
        self.laying = None;
        self.ended = false;
    }

    /// Takes this tool in the hand, or none.
    pub fn take(&mut self, kind: Option<Kind>) {
        self.kind = kind;
        self.laying = None;
        self.ended = false;
    }

    /// Puts the tool in the hand away; whether there was one.
    pub fn put_away(&mut self) -> bool {
        self.laying = None;
        self.ended = false;
        self.kind.take().is_some()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        let numbers = self.numbers;
        *self = Self {
            numbers,
            ..Self::default()
        };
    }

    /// Lays the tool down at a place that is seen on a side. Says which one lies there when it is
    /// complete.
    pub fn lay(&mut self, on: OnSide, seen: &Seen) -> Option<&Laid> {
        let kind = self.kind?;
        if std::mem::take(&mut self.ended) {
            return None;
        }
        // A tool lies on one side of one sheet in one state.
        let laying = self.laying.take().filter(|laying| laying.on == on);
        let mut laying = laying.unwrap_or(Laying {
            on,
            places: Vec::new(),
            screen_mm: 0.0,
            sheet: seen.sheet,
        });
        // One place twice is a double click that came too slowly.
        let is_same = |last: &DVec2| last.distance(seen.mm) <= SAME_PX * seen.pixel_mm;
        if laying.places.last().is_some_and(is_same) {
            self.laying = Some(laying);
            return None;
        }
        laying.places.push(seen.mm);
        laying.screen_mm = laying.screen_mm.max(seen.pixel_mm);
        let complete = !kind.is_open() && laying.places.len() == kind.places();
        self.laying = Some(laying);
        if complete { self.end() } else { None }
    }

    /// A second click at the same place ends what is laid place by place, and its own place is not
    /// one of the next.
    pub fn end_by_click(&mut self) -> Option<&Laid> {
        if self.laying.is_none() || !self.kind.is_some_and(Kind::is_open) {
            return None;
        }
        self.ended = true;
        self.end()
    }

    /// Something is dragged: the click that comes next is one of its own.
    pub fn forget_double_click(&mut self) {
        self.ended = false;
    }

    /// The files were read anew: what was read of the old ones is read again. Says what.
    pub fn reread(&mut self) -> &[Laid] {
        for laid in &mut self.laid {
            laid.said = Said::Waiting;
        }
        &self.laid
    }

    /// Ends what is being laid, if it has places enough.
    pub fn end(&mut self) -> Option<&Laid> {
        let kind = self.kind?;
        let tool = kind.at(&self.laying.as_ref()?.places)?;
        let laying = self.laying.take()?;
        self.numbers += 1;
        self.laid.push(Laid {
            number: self.numbers,
            on: laying.on,
            kind,
            tool,
            places: laying.places,
            screen_mm: laying.screen_mm,
            sheet: laying.sheet,
            said: Said::Waiting,
        });
        self.laid.last()
    }

    /// Takes back the last place of what is being laid, or else the last that was laid.
    pub fn take_back(&mut self) {
        match &mut self.laying {
            Some(laying) if laying.places.len() > 1 => drop(laying.places.pop()),
            Some(_) => self.laying = None,
            None => drop(self.laid.pop()),
        }
    }

    /// Takes in what came of a tool; one that was taken back is not there any more.
    pub fn hear(&mut self, number: u64, said: Said) {
        if let Some(laid) = self.laid.iter_mut().find(|laid| laid.number == number) {
            laid.said = said;
        }
    }
}

/// Tools as another machine is told of them, which reads by itself what they say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToldMeasuring {
    kind: Option<Kind>,
    laying: Option<ToldTool>,
    laid: Vec<(u64, Kind, ToldTool)>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ToldTool {
    on: OnSide,
    places: Vec<Pair>,
    screen_mm: Exact,
    sheet: usize,
}

impl ToldTool {
    fn places(&self) -> Vec<DVec2> {
        self.places.iter().copied().map(vector).collect()
    }
}

impl ToldMeasuring {
    /// Whether tools have the places that they need.
    pub fn check(&self) -> Result<(), String> {
        for (_, kind, told) in &self.laid {
            if kind.at(&told.places()).is_none() {
                return Err(format!("a tool of {} places", told.places.len()));
            }
        }
        Ok(())
    }
}

impl Measuring {
    /// What another machine is told.
    pub fn told(&self) -> ToldMeasuring {
        let tool = |on: &OnSide, places: &[DVec2], screen_mm, sheet| ToldTool {
            on: on.clone(),
            places: places.iter().copied().map(pair).collect(),
            screen_mm: Exact(screen_mm),
            sheet,
        };
        ToldMeasuring {
            kind: self.kind,
            laying: self
                .laying
                .as_ref()
                .map(|l| tool(&l.on, &l.places, l.screen_mm, l.sheet)),
            laid: self
                .laid
                .iter()
                .map(|l| {
                    let told = tool(&l.on, &l.places, l.screen_mm, l.sheet);
                    (l.number, l.kind, told)
                })
                .collect(),
        }
    }

    /// As another machine says; what was read of the same tools stays.
    pub fn be(&mut self, told: &ToldMeasuring) {
        let before = std::mem::take(&mut self.laid);
        self.kind = told.kind;
        self.ended = false;
        self.laying = told.laying.as_ref().map(|laying| Laying {
            on: laying.on.clone(),
            places: laying.places(),
            screen_mm: laying.screen_mm.0,
            sheet: laying.sheet,
        });
        let laid = told.laid.iter().filter_map(|(number, kind, told)| {
            let places = told.places();
            let laid = Laid {
                number: *number,
                on: told.on.clone(),
                kind: *kind,
                tool: kind.at(&places)?,
                places,
                screen_mm: told.screen_mm.0,
                sheet: told.sheet,
                said: Said::Waiting,
            };
            let same = before.iter().find(|before| {
                (before.number, &before.tool, &before.on) == (laid.number, &laid.tool, &laid.on)
            });
            Some(match same {
                Some(same) => same.clone(),
                None => laid,
            })
        });
        self.laid = laid.collect();
    }
}

/// The corners of an upright rectangle between two opposite ones.
pub fn rectangle([a, b]: [DVec2; 2]) -> Vec<DVec2> {
    vec![a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)]
}

/// Whether a place lies on a sheet of `size_mm`.
pub fn is_on(place: DVec2, size_mm: DVec2) -> bool {
    contains(&rectangle([DVec2::ZERO, size_mm]), place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(x: f64, y: f64, side: SideName) -> Seen {
        Seen {
            mm: DVec2::new(x, y),
            pixel_mm: 0.1 + x / 1000.0,
            side,
            sheet: 0,
        }
    }

    fn on(side: SideName) -> OnSide {
        OnSide {
            drawing: "sheet".to_owned(),
            side,
            state: None,
        }
    }

    fn lay(measuring: &mut Measuring, x: f64, y: f64, side: SideName) -> Option<Laid> {
        measuring.lay(on(side), &seen(x, y, side)).cloned()
    }

    fn with(kind: Kind) -> Measuring {
        let mut measuring = Measuring::default();
        while measuring.kind() != Some(kind) {
            measuring.step(1);
        }
        measuring
    }

    #[test]
    fn a_key_goes_through_all_tools_and_back_to_none() {
        let mut measuring = Measuring::default();
        for kind in Kind::ALL {
            measuring.step(1);
            assert_eq!(measuring.kind(), Some(kind));
        }
        measuring.step(1);
        assert_eq!(measuring.kind(), None);
        measuring.step(-1);
        assert_eq!(measuring.kind(), Some(Kind::Difference));
        assert!(measuring.put_away() && !measuring.put_away());
    }

    #[test]
    fn a_ruler_lies_on_two_places_of_one_side() {
        let mut measuring = with(Kind::Ruler);
        assert!(lay(&mut measuring, 10.0, 20.0, SideName::Recto).is_none());
        // The sheet was turned over meanwhile.
        assert!(lay(&mut measuring, 50.0, 20.0, SideName::Verso).is_none());
        let laid = lay(&mut measuring, 80.0, 60.0, SideName::Verso).unwrap();
        let ends = [DVec2::new(50.0, 20.0), DVec2::new(80.0, 60.0)];
        assert_eq!(laid.tool, Tool::Ruler(ends));
        assert_eq!(laid.on.side, SideName::Verso);
        // Where the sheet is seen least exactly.
        assert!((laid.screen_mm - 0.18).abs() < 1e-12);
        // Another one begins anew.
        assert!(lay(&mut measuring, 1.0, 2.0, SideName::Verso).is_none());
        assert_eq!(measuring.laid().len(), 1);
    }

    #[test]
    fn a_path_ends_when_somebody_says_so() {
        let mut measuring = with(Kind::Area);
        for (x, y) in [(10.0, 10.0), (30.0, 10.0)] {
            lay(&mut measuring, x, y, SideName::Recto);
            assert!(measuring.end().is_none());
        }
        lay(&mut measuring, 30.0, 40.0, SideName::Recto);
        // The second press of a double click ends it, and its release is no new place.
        assert!(measuring.end_by_click().is_some());
        assert!(lay(&mut measuring, 30.0, 40.0, SideName::Recto).is_none());
        assert!(measuring.laying().is_none());
        lay(&mut measuring, 5.0, 5.0, SideName::Recto);
        assert_eq!(measuring.laying().unwrap().places.len(), 1);
        // A double click that ends nothing swallows no click.
        let mut ruler = with(Kind::Ruler);
        assert!(ruler.end_by_click().is_none());
        lay(&mut ruler, 5.0, 5.0, SideName::Recto);
        assert!(ruler.laying().is_some());
    }

    #[test]
    fn two_colours_are_of_one_state_and_one_place_is_no_second_one() {
        let mut measuring = with(Kind::Difference);
        lay(&mut measuring, 10.0, 10.0, SideName::Recto);
        let before = OnSide {
            state: Some("before".to_owned()),
            ..on(SideName::Recto)
        };
        let other = measuring.lay(before.clone(), &seen(50.0, 10.0, SideName::Recto));
        assert!(other.is_none(), "it begins anew on the other member");
        let other = measuring
            .lay(before, &seen(80.0, 10.0, SideName::Recto))
            .unwrap();
        assert_eq!(
            other.places,
            [DVec2::new(50.0, 10.0), DVec2::new(80.0, 10.0)]
        );
        let mut area = with(Kind::Area);
        for x in [10.0, 30.0, 30.0, 30.1] {
            lay(&mut area, x, 10.0, SideName::Recto);
        }
        assert_eq!(area.laying().unwrap().places.len(), 2);
    }

    #[test]
    fn places_and_tools_are_taken_back_one_by_one() {
        let mut measuring = with(Kind::Ruler);
        lay(&mut measuring, 1.0, 1.0, SideName::Recto);
        lay(&mut measuring, 2.0, 2.0, SideName::Recto);
        lay(&mut measuring, 3.0, 3.0, SideName::Recto);
        measuring.take_back();
        assert!(measuring.laying().is_none() && measuring.laid().len() == 1);
        let number = measuring.laid()[0].number;
        measuring.take_back();
        assert!(measuring.laid().is_empty());
        measuring.hear(number, Said::Nothing(Why::Gone));
        measuring.take_back();
        // Numbers are never given twice: an answer that comes late is nobody's.
        lay(&mut measuring, 1.0, 1.0, SideName::Recto);
        let next = lay(&mut measuring, 2.0, 2.0, SideName::Recto).unwrap();
        assert!(next.number > number);
    }
}
