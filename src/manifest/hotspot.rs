//! Regions of a side: what lies inside one, where its outline lies on the sheet, and which
//! outlines bound no region.

use std::fmt;

use glam::{DVec2, DVec3};

use super::{
    exhibit::{Drawing, Hotspot, SideName},
    frames::other_side,
};

/// How many places an outline has at most.
pub const MAX_PLACES: usize = 256;
/// An outline around less is none: nobody could see or touch it.
const LEAST_AREA_MM2: f64 = 0.01;
/// Places nearer to each other are one: rounding in a frame of metres is far below.
const SAME_MM: f64 = 1e-6;

/// What is wrong with an outline. Places are by their index, edges by that of their first place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineFault {
    /// The second place is the first once more.
    Doubled(usize, usize),
    /// Two edges cross, touch or lie on each other.
    Crossing(usize, usize),
    /// It goes around this area in mm², which is too small.
    NoArea(f64),
}

/// Finds everything that is wrong with the outline `places`: doubled places, or else edges that
/// meet, or else its area.
pub fn outline_faults(places: &[DVec2]) -> Vec<OutlineFault> {
    let mut faults = Vec::new();
    for (j, place) in places.iter().enumerate() {
        let earlier = places[..j]
            .iter()
            .position(|p| p.distance(*place) < SAME_MM);
        faults.extend(earlier.map(|i| OutlineFault::Doubled(i, j)));
    }
    if !faults.is_empty() {
        return faults;
    }
    let area = area(places).abs();
    if in_one_line(places) {
        return vec![OutlineFault::NoArea(area)];
    }
    let count = places.len();
    let edge = |i: usize| [places[i], places[(i + 1) % count]];
    for j in 0..count {
        for i in 0..j {
            let meets = if i + 1 == j {
                doubles_back(edge(i), edge(j))
            } else if (j + 1) % count == i {
                doubles_back(edge(j), edge(i))
            } else {
                meet(edge(i), edge(j))
            };
            if meets {
                faults.push(OutlineFault::Crossing(i, j));
            }
        }
    }
    if faults.is_empty() && area < LEAST_AREA_MM2 {
        faults.push(OutlineFault::NoArea(area));
    }
    faults
}

/// Whether all of `places`, which differ, lie on one line.
fn in_one_line(places: &[DVec2]) -> bool {
    let [first, second, ..] = places else {
        return true;
    };
    let along = (second - first).normalize();
    let off = |place: &DVec2| along.perp_dot(place - first).abs();
    places.iter().all(|place| off(place) < SAME_MM)
}

/// The area that the outline `places` goes around, > 0 where it goes from x to y.
fn area(places: &[DVec2]) -> f64 {
    let edges = places.iter().zip(places.iter().cycle().skip(1));
    edges.map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
}

/// Whether the second of two edges that share a place goes back along the first.
fn doubles_back([a, b]: [DVec2; 2], [_, c]: [DVec2; 2]) -> bool {
    let (back, on) = (a - b, c - b);
    back.dot(on) > 0.0 && is_on(c, [a, b]) | is_on(a, [b, c])
}

/// Whether two edges have a place in common.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |[p, q]: [DVec2; 2], r: DVec2| (q - p).perp_dot(r - p);
    let crosses =
        side([a, b], c) * side([a, b], d) < 0.0 && side([c, d], a) * side([c, d], b) < 0.0;
    crosses || is_on(a, [c, d]) || is_on(b, [c, d]) || is_on(c, [a, b]) || is_on(d, [a, b])
}

/// Whether a place lies on an edge.
fn is_on(place: DVec2, [a, b]: [DVec2; 2]) -> bool {
    let along = b - a;
    let t = (place - a).dot(along) / along.length_squared();
    // An edge without length is its place.
    let t = if t.is_finite() {
        t.clamp(0.0, 1.0)
    } else {
        0.0
    };
    place.distance(a + along * t) < SAME_MM
}

/// Whether `place` lies inside the outline `places` or on it.
pub fn contains(places: &[DVec2], place: DVec2) -> bool {
    let edges = || places.iter().zip(places.iter().cycle().skip(1));
    if edges().any(|(a, b)| is_on(place, [*a, *b])) {
        return true;
    }
    // A ray to the right enters and leaves; of a place at its own height it counts only edges that
    // come from above, so that each is counted once.
    let crossed = edges().filter(|(a, b)| {
        let spans = (a.y > place.y) != (b.y > place.y);
        spans && place.x < a.x + (b.x - a.x) * (place.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

impl Hotspot {
    /// Whether `place`, in the frame of its side, lies inside it or on its outline.
    pub fn contains(&self, place: DVec2) -> bool {
        contains(&self.polygon_mm, place)
    }

    /// In mm².
    pub fn area_mm2(&self) -> f64 {
        area(&self.polygon_mm).abs()
    }
}

impl Drawing {
    /// The outline of one of its hotspots in the sheet's own frame: mm around its centre, x right
    /// and y up on the recto, z = 0 its flat surface.
    pub fn outline(&self, hotspot: &Hotspot) -> Vec<DVec3> {
        let places = hotspot.polygon_mm.iter();
        places
            .map(|place| self.on_sheet(hotspot.side, *place))
            .collect()
    }

    /// A place of one side in the sheet's own frame, as in [`Self::outline`].
    pub fn on_sheet(&self, side: SideName, place: DVec2) -> DVec3 {
        let place = match side {
            SideName::Recto => place,
            SideName::Verso => other_side(place, self.size_mm, self.flip),
        };
        let half = self.size_mm / 2.0;
        DVec3::new(place.x - half.x, half.y - place.y, 0.0)
    }
}

impl fmt::Display for OutlineFault {
    /// What was found.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Doubled(first, again) => {
                write!(f, "place {} once more as place {}", first + 1, again + 1)
            }
            Self::Crossing(a, b) => write!(
                f,
                "an outline that meets itself, behind place {} and behind place {}",
                a + 1,
                b + 1
            ),
            Self::NoArea(area) => write!(f, "an outline around {area:.3} mm²"),
        }
    }
}

impl OutlineFault {
    /// What is allowed.
    pub fn allowed(&self) -> String {
        match self {
            Self::Doubled(..) => "each place once: the last is joined to the first".to_owned(),
            Self::Crossing(..) => "an outline that goes around one region".to_owned(),
            Self::NoArea(_) => format!("at least {LEAST_AREA_MM2} mm²"),
        }
    }

    /// What to do.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Doubled(..) => "remove one of the two",
            Self::Crossing(..) => "write the places in their order around the region",
            Self::NoArea(_) => "write places that do not lie on one line",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(places: &[[f64; 2]]) -> Vec<DVec2> {
        places.iter().copied().map(DVec2::from).collect()
    }

    /// An L with its notch at the upper right.
    fn angle() -> Vec<DVec2> {
        places(&[[0., 0.], [4., 0.], [4., 4.], [8., 4.], [8., 8.], [0., 8.]])
    }

    #[test]
    fn a_place_is_inside_outside_or_on_the_edge_which_is_inside() {
        for (place, inside) in [
            ([1.0, 1.0], true),
            ([7.0, 7.0], true),
            ([6.0, 2.0], false),
            ([-1.0, 4.0], false),
            // At the height of corners, where rays meet two edges at once.
            ([-1.0, 0.0], false),
            ([5.0, 0.0], false),
            ([1.0, 4.0], true),
            ([9.0, 4.0], false),
            ([-1.0, 8.0], false),
            // Edges and corners.
            ([0.0, 0.0], true),
            ([4.0, 2.0], true),
            ([6.0, 4.0], true),
            ([8.0, 8.0], true),
            ([0.0, 5.0], true),
            ([4.0001, 2.0], false),
        ] {
            for reversed in [false, true] {
                let mut outline = angle();
                if reversed {
                    outline.reverse();
                }
                assert_eq!(contains(&outline, DVec2::from(place)), inside, "{place:?}");
            }
        }
    }

    #[test]
    fn outlines_that_bound_no_region_are_told_and_others_are_not() {
        use OutlineFault::{Crossing, Doubled, NoArea};
        assert_eq!(outline_faults(&angle()), []);
        for (outline, expected) in [
            // A bow tie.
            (
                places(&[[0., 0.], [4., 3.], [4., 0.], [0., 4.]]),
                vec![Crossing(0, 2)],
            ),
            // One whose two halves go around in opposite ways and cancel.
            (
                places(&[[0., 0.], [4., 4.], [4., 0.], [0., 4.]]),
                vec![Crossing(0, 2)],
            ),
            // Smaller than anybody can see.
            (
                places(&[[0., 0.], [0.125, 0.], [0., 0.125]]),
                vec![NoArea(0.0078125)],
            ),
            // Closed by hand.
            (
                places(&[[0., 0.], [4., 0.], [4., 4.], [0., 0.]]),
                vec![Doubled(0, 3)],
            ),
            // On one line.
            (places(&[[0., 0.], [1., 1.], [3., 3.]]), vec![NoArea(0.0)]),
            // A corner that touches another edge.
            (
                places(&[[0., 0.], [8., 0.], [8., 4.], [4., 0.], [0., 4.]]),
                vec![Crossing(0, 2), Crossing(0, 3)],
            ),
            // A spike that goes out and back again.
            (
                places(&[[0., 0.], [8., 0.], [4., 0.], [4., 4.]]),
                vec![Crossing(0, 1), Crossing(0, 2)],
            ),
        ] {
            assert_eq!(outline_faults(&outline), expected, "{outline:?}");
        }
    }

    #[test]
    fn two_edges_may_run_on_in_one_line() {
        let outline = places(&[[0., 0.], [4., 0.], [8., 0.], [8., 4.]]);
        assert_eq!(outline_faults(&outline), []);
    }
}
