//! From one frame of the sheet to another (see [`super::exhibit`]).

use glam::{DAffine2, DMat2, DQuat, DVec2, DVec3};

use super::exhibit::{Drawing, FlipAxis, MapFile, SideName};
use crate::maps::Placed;

/// A point of the table frame, in the side frame of whichever side lies up on a sheet at rest.
pub fn side_from_table(point: DVec3, size_mm: DVec2) -> DVec2 {
    DVec2::new(point.x + size_mm.x / 2.0, size_mm.y / 2.0 - point.y)
}

/// A place of one side, in the other side's frame.
pub fn other_side(point: DVec2, size_mm: DVec2, flip: FlipAxis) -> DVec2 {
    other_side_frame(size_mm, flip).transform_point2(point)
}

fn other_side_frame(size_mm: DVec2, flip: FlipAxis) -> DAffine2 {
    let (mirror, shift) = match flip {
        FlipAxis::Vertical => (DVec2::new(-1.0, 1.0), DVec2::new(size_mm.x, 0.0)),
        FlipAxis::Horizontal => (DVec2::new(1.0, -1.0), DVec2::new(0.0, size_mm.y)),
    };
    DAffine2::from_mat2_translation(DMat2::from_diagonal(mirror), shift)
}

impl FlipAxis {
    /// The axis in the table frame.
    pub fn axis(self) -> DVec3 {
        match self {
            Self::Vertical => DVec3::Y,
            Self::Horizontal => DVec3::X,
        }
    }
}

impl SideName {
    /// The word that manifests use.
    pub fn word(self) -> &'static str {
        match self {
            Self::Recto => "recto",
            Self::Verso => "verso",
        }
    }

    /// The side behind this one.
    pub fn other(self) -> Self {
        match self {
            Self::Recto => Self::Verso,
            Self::Verso => Self::Recto,
        }
    }
}

impl Drawing {
    /// How the sheet lies at rest with `side` up: table frame from the recto's local frame,
    /// and just as well that side's local frame from the recto's.
    pub fn rest_pose(&self, side: SideName) -> DQuat {
        match side {
            SideName::Recto => DQuat::IDENTITY,
            SideName::Verso => DQuat::from_axis_angle(self.flip.axis(), std::f64::consts::PI),
        }
    }

    /// `side`'s frame → the recto's frame.
    pub fn recto_from(&self, side: SideName) -> DAffine2 {
        match side {
            SideName::Recto => DAffine2::IDENTITY,
            SideName::Verso => other_side_frame(self.size_mm, self.flip),
        }
    }
}

impl<'f> From<&'f MapFile> for Placed<'f> {
    fn from(file: &'f MapFile) -> Self {
        Self {
            path: &file.path,
            warp: file.warp.as_deref(),
        }
    }
}

impl MapFile {
    /// Width and height in mm that the picture covers on the sheet.
    pub fn extent_mm(&self) -> DVec2 {
        let m = self.uv_from_side.matrix2;
        DVec2::new(m.x_axis.x.hypot(m.y_axis.x), m.x_axis.y.hypot(m.y_axis.y)).recip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_keeps_itself_when_turned_over_twice() {
        let size = DVec2::new(285.0, 194.0);
        let place = DVec2::new(10.0, 20.0);
        for flip in [FlipAxis::Vertical, FlipAxis::Horizontal] {
            let there = other_side(place, size, flip);
            assert_ne!(there, place);
            assert_eq!(other_side(there, size, flip), place);
        }
    }
}
