//! How a picture lies on the sheet: by offset, turn and scale, or by control points.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{DAffine2, DMat2, DVec2};

use super::super::{
    decode::List,
    document::{Trail, Words},
    exhibit::{MapFile, Registered, Source},
    raw::{RawControlPoint, RawRegister},
};
use super::Validator;
use crate::maps::{
    Warp,
    registration::{AtOdds, FitKind, Fitted, RegistrationError, is_beside},
};

/// How far a picture's proportions may be from the sheet's without a word: less than a scan
/// loses at its edges.
const ASPECT_TOLERANCE: f64 = 0.02;

/// How far beside the sheet a control point may lie without a word, as a share of the sheet's size:
/// pictures show some of what the sheet lies on.
const BESIDE_TOLERANCE: f64 = 0.1;
/// Control points that agree less well than within this share of the sheet's diagonal are not of one
/// sheet: paper cockles, and lenses distort, by less.
const AGREEMENT: f64 = 0.01;
/// Control points are read no better than this, in pixels of their picture,
const READ_PX: f64 = 2.0;
/// and this, in mm on the sheet.
const READ_MM: f64 = 0.5;
/// How many control points a warning names.
const MOST_NAMED: usize = 5;

/// What the manifest says of a picture's place.
#[derive(Clone, Copy)]
pub(super) struct Placement<'p> {
    pub register: Option<&'p RawRegister>,
    pub control_points: Option<&'p List<RawControlPoint, 1, 1000>>,
    pub fit: Option<FitKind>,
    /// Of the table that these are keys of.
    pub trail: &'p Trail,
}

/// How a picture lies on a side.
#[derive(Clone)]
pub(super) struct Lie {
    /// From the side's mm to texture coordinates.
    pub uv_from_side: DAffine2,
    /// Width and height in pixels, once it is bent.
    pub size: [u32; 2],
    pub warp: Option<Arc<Warp>>,
}

impl Lie {
    /// A picture that lies so.
    pub fn of(self, path: PathBuf, source: Source) -> MapFile {
        MapFile {
            path,
            size: self.size,
            uv_from_side: self.uv_from_side,
            warp: self.warp,
            source,
        }
    }
}

impl From<&MapFile> for Lie {
    fn from(map: &MapFile) -> Self {
        Self {
            uv_from_side: map.uv_from_side,
            size: map.size,
            warp: map.warp.clone(),
        }
    }
}

impl Validator<'_, '_> {
    /// How a picture of `pixels` lies on a side; `named` is where the picture is named, and
    /// `file` what it is.
    pub(super) fn lie(
        &mut self,
        placement: Placement<'_>,
        sheet_mm: DVec2,
        pixels: [u32; 2],
        named: &Trail,
        file: &Path,
    ) -> Option<Lie> {
        let moved = placement.register.is_some_and(moves);
        if placement.control_points.is_none() && !moved {
            self.warn_of_proportions(sheet_mm, vector(pixels), named);
        }
        if let Some(points) = placement.control_points {
            let fitted = self.by_points(points, placement, sheet_mm, pixels)?;
            self.registered.push(Registered {
                place: placement.trail.to_string(),
                file: file.to_owned(),
                fit: Some(fitted.fit),
                points: fitted.residuals_mm.len(),
                residual: fitted.residual(),
                left_out: fitted.left_out(),
            });
            return Some(Lie {
                uv_from_side: fitted.uv_from_side,
                size: fitted.warp.as_ref().map_or(pixels, |warp| warp.size()),
                warp: fitted.warp,
            });
        }
        if moved {
            self.registered.push(Registered {
                place: placement.trail.to_string(),
                file: file.to_owned(),
                fit: None,
                points: 0,
                residual: None,
                left_out: None,
            });
        }
        let uv_from_side = placement.register.map_or_else(
            || DAffine2::from_scale(sheet_mm.recip()),
            |register| by_register(register, sheet_mm),
        );
        if is_beside(uv_from_side, sheet_mm) {
            let words = Words::new(
                "a place that puts the whole picture beside the sheet",
                format!(
                    "a picture that covers some of the {} × {} mm",
                    sheet_mm.x, sheet_mm.y
                ),
                "correct offset_mm, rotate_deg or scale",
            );
            self.report.fault(&placement.trail.key("register"), words);
            return None;
        }
        Some(Lie {
            uv_from_side,
            size: pixels,
            warp: None,
        })
    }

    fn by_points(
        &mut self,
        points: &List<RawControlPoint, 1, 1000>,
        placement: Placement<'_>,
        sheet_mm: DVec2,
        pixels: [u32; 2],
    ) -> Option<Fitted> {
        let pairs: Vec<(DVec2, DVec2)> = points
            .iter()
            .map(|(_, point)| {
                (
                    DVec2::from(point.picture.map(|p| p.0)),
                    DVec2::from(point.sheet_mm.map(|mm| mm.0)),
                )
            })
            .collect();
        if points.has_holes() {
            return None;
        }
        let trail = placement.trail.key("control_points");
        let error = match Fitted::new(&pairs, placement.fit, pixels, sheet_mm) {
            Ok(fitted) => {
                self.warn_of_points_beside(&pairs, sheet_mm, vector(pixels), &trail);
                self.warn_of_points_at_odds(&fitted, &pairs, pixels, sheet_mm, &trail);
                return Some(fitted);
            }
            Err(error) => error,
        };
        let apart = "points that lie apart and not on one line";
        let (trail, allowed, remedy) = match error {
            RegistrationError::TooFew { .. } => (trail, apart, "add points, or leave fit out"),
            RegistrationError::Doubled { second, .. } => (
                trail.index(second - 1),
                "each place once, in the picture and on the sheet",
                "remove one of the two, or correct it",
            ),
            RegistrationError::Mirrored
            | RegistrationError::Flattened
            | RegistrationError::NoSimilarity => (
                trail,
                "places of which each is the same in the picture and on the side as it is seen, \
                 both counted from the top left corner",
                "correct the points; a file that is mirrored itself has to be mirrored back",
            ),
            RegistrationError::Beside => (
                trail,
                "a picture that covers some of the sheet",
                "correct sheet_mm, which is counted from the top left corner of the side, or picture",
            ),
            RegistrationError::Folded { near_mm } => {
                let near = DVec2::from(near_mm.map(f64::from));
                let nearest = (0..pairs.len()).min_by(|a, b| {
                    let off = |i: usize| pairs[i].1.distance(near);
                    off(*a).total_cmp(&off(*b))
                });
                let trail = nearest.map_or(trail.clone(), |i| trail.index(i));
                (
                    trail,
                    "points between which the picture only bends",
                    "correct the points there, or leave fit out",
                )
            }
            _ => (trail, apart, "choose points near the corners"),
        };
        let words = Words::new(
            format!("points that do not place the picture ({error})"),
            allowed,
            remedy,
        );
        self.report.fault(&trail, words);
        None
    }

    /// Warns of control points that are not in the picture, or far beside the sheet.
    fn warn_of_points_beside(
        &mut self,
        points: &[(DVec2, DVec2)],
        sheet_mm: DVec2,
        pixels: DVec2,
        trail: &Trail,
    ) {
        let beside = |at: DVec2, size: DVec2, margin: DVec2| {
            at.cmplt(-margin).any() || at.cmpgt(size + margin).any()
        };
        let which = |is_one: &dyn Fn(&(DVec2, DVec2)) -> bool| -> Vec<usize> {
            let points = points.iter().enumerate();
            points
                .filter_map(|(i, point)| is_one(point).then_some(i))
                .collect()
        };
        let outside = which(&|(px, _)| beside(*px, pixels, DVec2::ZERO));
        if let Some(&first) = outside.first() {
            let DVec2 { x, y } = points[first].0;
            let words = Words::new(
                format!("{} outside the picture, at {x}, {y} px", named(&outside)),
                format!("0 to {} px and 0 to {} px", pixels.x, pixels.y),
                "count the pixels of this very file, from its top left corner: one that was reduced or \
                 cropped has others",
            );
            self.report.warn(&trail.index(first).key("picture"), words);
        }
        let margin = sheet_mm * BESIDE_TOLERANCE;
        let outside = which(&|(_, mm)| beside(*mm, sheet_mm, margin));
        if let Some(&first) = outside.first() {
            let DVec2 { x, y } = points[first].1;
            let words = Words::new(
                format!("{} beside the sheet, at {x}, {y} mm", named(&outside)),
                format!("about 0 to {} mm and 0 to {} mm", sheet_mm.x, sheet_mm.y),
                "measure in mm from the top left corner of the side",
            );
            self.report.warn(&trail.index(first).key("sheet_mm"), words);
        }
    }

    /// Warns of points that contradict each other.
    fn warn_of_points_at_odds(
        &mut self,
        fitted: &Fitted,
        points: &[(DVec2, DVec2)],
        pixels: [u32; 2],
        sheet_mm: DVec2,
        trail: &Trail,
    ) {
        let read_mm = READ_MM.max(READ_PX * mm_per_px(points));
        let at_odds = fitted.at_odds(points, pixels, sheet_mm, read_mm);
        if let Some(AtOdds { points, usual_mm }) = at_odds {
            let (worst, mm) = points[0];
            let which: Vec<usize> = points.iter().map(|(i, _)| *i).collect();
            let words = Words::new(
                format!("{} {mm:.2} mm from where the others put it", named(&which)),
                format!("about {usual_mm:.2} mm, as is usual for these points"),
                "correct its picture or sheet_mm, or remove it",
            );
            self.report.warn(&trail.index(worst), words);
            return;
        }
        let Some(left_out) = fitted.left_out() else {
            return;
        };
        let most_mm = read_mm.max(AGREEMENT * sheet_mm.length());
        if left_out.rms_mm > most_mm {
            let words = Words::new(
                format!(
                    "points that put each other {:.2} mm (root mean square) from where they are, point \
                     {} the farthest",
                    left_out.rms_mm, left_out.at_point
                ),
                format!("up to {most_mm:.1} mm on a sheet of this size"),
                "correct the points, or add some, so that the wrong one shows",
            );
            self.report.warn(trail, words);
        }
    }

    fn warn_of_proportions(&mut self, sheet_mm: DVec2, pixels: DVec2, picture: &Trail) {
        let ratio = (pixels.x / pixels.y) / (sheet_mm.x / sheet_mm.y);
        // A small picture's sides are rounded to whole pixels.
        let rounded = pixels.min_element().max(1.0).recip();
        if (ratio - 1.0).abs() <= ASPECT_TOLERANCE.max(rounded) {
            return;
        }
        let (percent, compared) = if ratio > 1.0 {
            (100.0 * (ratio - 1.0), "wider")
        } else {
            (100.0 * (1.0 / ratio - 1.0), "taller")
        };
        let words = Words::new(
            format!(
                "a picture of {} × {} pixels, which is {percent:.0} % {compared} in proportion \
                 than the sheet of {} × {} mm",
                pixels.x, pixels.y, sheet_mm.x, sheet_mm.y
            ),
            format!(
                "the sheet's proportions within {:.0} %",
                100.0 * ASPECT_TOLERANCE
            ),
            "check size_mm, crop the picture to the sheet, or register it",
        );
        self.report.warn(picture, words);
    }

    /// Reports what a picture that is not the verso's cannot have.
    pub(super) fn refuse_flip(&mut self, register: Option<&RawRegister>, trail: &Trail) {
        if register.is_some_and(|register| register.flip.is_some()) {
            let words = Words::new(
                "a flip",
                "flip in the drawing's verso.register alone",
                "move it there",
            );
            self.report.fault(&trail.key("register").key("flip"), words);
        }
    }

    /// Reports two ways of placing at once.
    pub(super) fn one_way_of_placing(&mut self, placement: Placement<'_>) {
        if placement.control_points.is_some() && placement.register.is_some_and(moves) {
            let words = Words::new(
                "a register beside control_points",
                "one of the two, but for register.flip",
                "keep the control points and only flip here",
            );
            self.report.fault(&placement.trail.key("register"), words);
        }
    }
}

/// How large a pixel of a picture is on the sheet, by how far its control points lie apart.
fn mm_per_px(points: &[(DVec2, DVec2)]) -> f64 {
    let spread = |of: fn(&(DVec2, DVec2)) -> DVec2| {
        let mean = points.iter().map(of).sum::<DVec2>() / points.len() as f64;
        points
            .iter()
            .map(|point| (of(point) - mean).length_squared())
            .sum::<f64>()
            .sqrt()
    };
    spread(|point| point.1) / spread(|point| point.0)
}

/// `point 3`, or `points 3, 5 and 8 more, the first`, of indices from 0.
fn named(points: &[usize]) -> String {
    let number = |i: &usize| (i + 1).to_string();
    let [only] = points else {
        let listed: Vec<String> = points.iter().take(MOST_NAMED).map(number).collect();
        let rest = points.len().saturating_sub(MOST_NAMED);
        let more = match rest {
            0 => String::new(),
            _ => format!(" and {rest} more"),
        };
        return format!("points {}{more}, the first", listed.join(", "));
    };
    format!("point {}", number(only))
}

fn vector([x, y]: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y))
}

/// Whether it does more than say how the sheet is turned over.
fn moves(register: &RawRegister) -> bool {
    register.offset_mm.is_some() || register.rotate_deg.is_some() || register.scale.is_some()
}

/// The picture covers the sheet, is scaled and turned anticlockwise about its centre, and then
/// shifted.
fn by_register(register: &RawRegister, sheet_mm: DVec2) -> DAffine2 {
    let centre = sheet_mm / 2.0;
    let offset = register
        .offset_mm
        .map_or(DVec2::ZERO, |mm| DVec2::from(mm.map(|mm| mm.0)));
    let angle = register
        .rotate_deg
        .map_or(0.0, |degrees| degrees.0.to_radians());
    let scale = register.scale.map_or(1.0, |scale| scale.0);
    // y runs down, so that an anticlockwise turn has a negative angle.
    let turn = DMat2::from_angle(-angle) * scale;
    let side_from_picture = DAffine2::from_translation(centre + offset)
        * DAffine2::from_mat2(turn)
        * DAffine2::from_translation(-centre);
    DAffine2::from_scale(sheet_mm.recip()) * side_from_picture.inverse()
}

#[cfg(test)]
mod tests {
    use super::super::super::raw::values::{OffsetMm, Scale, TurnDeg};
    use super::*;

    const SHEET: DVec2 = DVec2::new(200.0, 100.0);

    fn register(offset: [f64; 2], turn: f64, scale: f64) -> RawRegister {
        RawRegister {
            flip: None,
            offset_mm: Some(offset.map(OffsetMm)),
            rotate_deg: Some(TurnDeg(turn)),
            scale: Some(Scale(scale)),
        }
    }

    fn close(a: DVec2, b: DVec2) {
        assert!((a - b).length() < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn an_offset_moves_the_picture_right_and_down() {
        let uv = by_register(&register([20.0, 10.0], 0.0, 1.0), SHEET);
        close(uv.transform_point2(DVec2::new(20.0, 10.0)), DVec2::ZERO);
    }

    #[test]
    fn a_quarter_turn_anticlockwise_brings_the_right_edge_to_the_top() {
        let uv = by_register(&register([0.0, 0.0], 90.0, 1.0), SHEET);
        // 50 mm above the centre lies what was 50 mm to its right: three quarters of the width.
        close(
            uv.transform_point2(DVec2::new(100.0, 0.0)),
            DVec2::new(0.75, 0.5),
        );
    }

    #[test]
    fn a_picture_of_twice_the_size_is_seen_in_its_middle_half() {
        let uv = by_register(&register([0.0, 0.0], 0.0, 2.0), SHEET);
        close(uv.transform_point2(DVec2::ZERO), DVec2::splat(0.25));
        close(uv.transform_point2(SHEET), DVec2::splat(0.75));
    }
}
