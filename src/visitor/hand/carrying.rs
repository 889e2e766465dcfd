//! Where the hand holds the sheet before the eye: moved, magnified, tilted and turned over, and no
//! further than there is something to see.

use std::f64::consts::PI;

use glam::{DQuat, DVec2, DVec3};

use super::{ARRIVED, FARTHEST_TURN_DEG, Grip, Hand, Speed};
use crate::manifest::{
    comparison::Part,
    exhibit::{Camera, Comparison, FlipAxis, Scene, SideName},
    eye::Eye,
    frames::other_side,
};
use crate::units::Degrees;

/// Degrees by which the sheet turns when a hand crosses half the picture.
const TURN_DEG: f64 = 70.0;
/// Seen at this angle from straight above, in degrees, a sheet can show its other side.
const STEEP_DEG: f64 = 75.0;
/// Narrowest picture, in mm.
const NARROWEST_MM: f64 = 2.0;
/// A picture narrower than the whole sheet by this factor is zoomed in.
const ZOOMED: f64 = 0.85;

/// A picture that is let go of within so many degrees of upright is set upright.
const NEARLY_STRAIGHT_DEG: f64 = 8.0;

/// How a hand holds one of the sheets that share a picture.
struct Hold {
    /// What of the picture that sheet has.
    part: Part,
    /// Signs of right and up on the table: a sheet that shows its other side goes the other way.
    mirror: DVec2,
}

impl Hand {
    /// The camera in a picture of this shape.
    pub(super) fn camera(&self) -> Camera {
        let size = self.drawing().size_mm;
        self.view.camera.fitted(size, self.aspect())
    }

    /// The sheet's own picture in that which is shown: of sheets beside each other, a cell.
    fn own(&self) -> Part {
        let cells = self.view.compare.as_ref().map(Comparison::cells);
        let first = cells.and_then(|cells| cells.first().copied());
        first.unwrap_or(Part::WHOLE)
    }

    /// Its width over its height.
    pub(super) fn aspect(&self) -> f64 {
        self.own().aspect(self.picture.aspect)
    }

    /// Width in mm of the sheet that is as wide as its own picture on the display.
    pub(super) fn true_width_mm(&self) -> f64 {
        self.picture.width_mm * self.own().scale.x
    }

    /// The sheet at a place of the picture, where several share it.
    fn hold(&self, at: DVec2) -> Hold {
        let first = Hold {
            part: self.own(),
            mirror: DVec2::ONE,
        };
        let Some(comparison) = self.view.compare.as_ref().filter(|c| !c.mode.combines()) else {
            return first;
        };
        let scene = Scene {
            side: self.view.side,
            compare: Some(comparison.clone()),
            ..self.written().clone()
        };
        let parts = self.exhibit.parts(&scene, self.picture.aspect).into_iter();
        let mut held = parts.filter(|(_, part)| part.shows(at, self.picture.aspect));
        // Beyond the picture's edge a drag goes on as it began.
        held.next().map_or(first, |(member, part)| Hold {
            part,
            mirror: match self.drawing().flip {
                _ if member.side == self.view.side => DVec2::ONE,
                FlipAxis::Vertical => DVec2::new(-1.0, 1.0),
                FlipAxis::Horizontal => DVec2::new(1.0, -1.0),
            },
        })
    }

    /// The widest picture in mm: the whole sheet, or more if the scene says so.
    fn widest(&self) -> f64 {
        let fit = |camera: Camera| camera.fitted(self.drawing().size_mm, self.aspect());
        let whole = fit(Camera::whole_sheet(self.drawing().size_mm));
        whole.width_mm.max(fit(self.written().camera).width_mm)
    }

    /// The nearest width in mm that the picture may have. A tiny sheet is not shown any larger
    /// than whole.
    fn within_reach(&self, width_mm: f64) -> f64 {
        let widest = self.widest();
        width_mm.clamp(NARROWEST_MM.min(widest), widest)
    }

    /// Right and up in the picture, as right and up on the table.
    pub(super) fn on_table(&self, seen: DVec2) -> DVec2 {
        DVec2::from_angle(self.view.camera.turn.radians()).rotate(seen)
    }

    /// Whether one finger moves the sheet, which has been brought closer, instead of turning it.
    pub fn moves_by_one_finger(&self) -> bool {
        self.camera().width_mm < ZOOMED * self.widest() && self.turn == DVec2::ZERO
    }

    pub(super) fn drag(&mut self, from: DVec2, to: DVec2) {
        let grip = match self.grip {
            Some(Grip::Undecided) | None => {
                let aspect = self.picture.aspect;
                let taken = |comparison: &Comparison| comparison.is_taken_at(from, aspect);
                if self.view.compare.as_ref().is_some_and(taken) {
                    Grip::Compare
                } else if self.moves_by_one_finger() {
                    Grip::Move
                } else {
                    Grip::Turn
                }
            }
            Some(grip) => grip,
        };
        self.grip = Some(grip);
        if grip == Grip::Compare {
            if let Some(comparison) = &mut self.view.compare {
                comparison.drag(from, to, self.picture.aspect);
            }
        } else if grip == Grip::Turn {
            // The side that faces us follows the hand.
            let by = self.on_table(DVec2::new(-(to.y - from.y), to.x - from.x) * TURN_DEG);
            self.turn = (self.turn + by).clamp_length_max(FARTHEST_TURN_DEG);
            self.speed.push(by);
        } else {
            self.shift(from, to);
        }
    }

    /// Brings what lies at `from` to `to`.
    pub(super) fn shift(&mut self, from: DVec2, to: DVec2) {
        // The sheet that was taken is moved, and the others with it.
        let hold = self.hold(from);
        let places = (self.table_point(from, &hold), self.table_point(to, &hold));
        if let (Some(start), Some(end)) = places {
            let by = (start - end) * hold.mirror;
            self.move_centre(by);
            self.speed.push(by);
        }
    }

    fn table_point(&self, at: DVec2, hold: &Hold) -> Option<DVec2> {
        let eye = Eye::new(&self.camera(), self.drawing().size_mm);
        let own = (at - hold.part.shift) / hold.part.scale;
        let point = eye.table_point(own, hold.part.aspect(self.picture.aspect))?;
        Some(point.truncate())
    }

    /// Moves what the eye looks at, right and up on the table in mm, within the sheet.
    pub(super) fn move_centre(&mut self, by: DVec2) {
        let mut camera = self.camera();
        camera.centre_mm += DVec2::new(by.x, -by.y);
        self.set_camera(camera);
    }

    fn set_camera(&mut self, mut camera: Camera) {
        let size = self.drawing().size_mm;
        let widest = self.widest();
        camera.width_mm = self.within_reach(camera.width_mm);
        // The picture stays within the widest one, which is centred.
        let spare = (widest - camera.width_mm) / 2.0;
        let spare = DVec2::new(spare, spare / self.aspect());
        let seen = self.on_table(DVec2::X).abs();
        let reach = DVec2::new(
            seen.x * spare.x + seen.y * spare.y,
            seen.y * spare.x + seen.x * spare.y,
        );
        let middle = size / 2.0;
        camera.centre_mm = camera.centre_mm.clamp(middle - reach, middle + reach);
        let whole = Camera::whole_sheet(size);
        // The whole sheet goes on filling a picture that changes its shape.
        self.view.camera = if camera == whole.fitted(size, self.aspect()) {
            whole
        } else {
            camera
        };
    }

    pub(super) fn set_width(&mut self, width_mm: f64, at: DVec2) {
        let hold = self.hold(at);
        let before = self.table_point(at, &hold);
        let camera = Camera {
            width_mm,
            ..self.camera()
        };
        self.set_camera(camera);
        if let (Some(before), Some(after)) = (before, self.table_point(at, &hold)) {
            self.move_centre((before - after) * hold.mirror);
        }
    }

    /// Turns the picture by `turn` radians, anticlockwise, about what lies at `at`.
    pub(super) fn turn_picture(&mut self, turn: f64, at: DVec2) {
        if turn == 0.0 || !turn.is_finite() {
            return;
        }
        let hold = self.hold(at);
        let before = self.table_point(at, &hold);
        let mut camera = self.camera();
        // The camera goes the other way round than the sheet that it sees.
        let turned = camera.turn.0 - turn.to_degrees();
        camera.turn = Degrees((turned + 180.0).rem_euclid(360.0) - 180.0);
        self.set_camera(camera);
        if let (Some(before), Some(after)) = (before, self.table_point(at, &hold)) {
            self.move_centre((before - after) * hold.mirror);
        }
    }

    /// A picture that is nearly straight comes to be so.
    pub(super) fn straighten(&mut self) {
        let turn = self.view.camera.turn.0;
        let written = self.written().camera.turn.0;
        let straight = ((turn - written) / 90.0).round() * 90.0 + written;
        if turn != straight && (turn - straight).abs() <= NEARLY_STRAIGHT_DEG {
            if self.calm {
                self.view.camera.turn = Degrees(straight);
            } else {
                self.straight = Some(straight);
            }
        }
    }

    pub(super) fn zoom_to(&mut self, width_mm: f64, at: DVec2) {
        let target = self.within_reach(width_mm);
        if self.calm {
            self.set_width(target, at);
        } else {
            self.zoom = Some((target, at));
        }
    }

    pub(super) fn true_size(&mut self, at: DVec2) {
        let width = self.zoom.map_or(self.camera().width_mm, |(width, _)| width);
        let target = self.within_reach(self.true_width_mm());
        if (width / target - 1.0).abs() < 2.0 * ARRIVED {
            let back = self.before_true_size.take().unwrap_or(self.widest());
            self.zoom_to(back, at);
        } else {
            self.before_true_size = Some(width);
            self.zoom_to(target, at);
        }
    }

    pub(super) fn turn_over(&mut self) {
        if self.flip.is_some() {
            return;
        }
        self.both_sides = true;
        self.speed = Speed::default();
        if self.calm {
            self.finish_flip();
        } else {
            self.flip = Some(0.0);
        }
    }

    pub(super) fn finish_flip(&mut self) {
        let drawing = self.drawing();
        let (size, axis) = (drawing.size_mm, drawing.flip);
        let mut camera = self.camera();
        camera.centre_mm = other_side(camera.centre_mm, size, axis);
        self.set_camera(camera);
        self.view.side = self.view.side.other();
        self.flip = None;
    }

    /// Whether the sheet is seen so flatly that its other side may come into sight.
    pub(super) fn is_steep(&self) -> bool {
        let towards = Eye::new(&self.view.camera, self.drawing().size_mm).towards;
        (self.turned() * DVec3::Z).dot(towards) < STEEP_DEG.to_radians().cos()
    }

    pub(super) fn turned(&self) -> DQuat {
        let turn = self.turn * (PI / 180.0);
        DQuat::from_scaled_axis(turn.extend(0.0))
    }

    /// The sheet on its way to its other side: its right, or lower, edge comes up towards us and
    /// goes over, and comes back the same way.
    pub(super) fn half_turned(&self, progress: f64) -> DQuat {
        let part = match self.view.side {
            SideName::Recto => progress,
            SideName::Verso => 1.0 - progress,
        };
        DQuat::from_axis_angle(self.drawing().flip.axis(), -PI * part)
    }
}
