//! Pictures that lie on a side, decoded once and sampled at places in mm.

use std::{path::Path, sync::Arc};

use glam::{DAffine2, DVec2};

use super::{Desk, ReadingError};
use crate::{
    manifest::{
        Exhibit,
        exhibit::{ColourMap, MapFile},
    },
    maps::{self, MapError, Pyramid, registration::FitKind},
};

/// A place that is less sheet than this is off it.
const SHEET: f64 = 0.5;

/// RMS distance in mm of the control points of a picture of `exhibit` from where they put it: of
/// those of a plate, which goes through all of them, from where the others alone put it. `None` where
/// there are none, or no more than determine its place and so agree whatever they are.
pub fn registration_mm(exhibit: &Exhibit, file: &MapFile) -> Option<f64> {
    // All maps of a side lie as the first of them does.
    let lies_alike = |path: &Path| {
        let alike = |map: &MapFile| {
            map.path == path && map.uv_from_side == file.uv_from_side && map.warp == file.warp
        };
        path == file.path || exhibit.maps().any(alike)
    };
    let mut registered = exhibit.registered.iter();
    let registered = registered.find(|registered| lies_alike(&registered.file))?;
    let left_out = registered.left_out?;
    let known = match registered.fit? {
        FitKind::ThinPlate => left_out,
        FitKind::Shift | FitKind::Similarity | FitKind::Affine => registered.residual?,
    };
    Some(known.rms_mm)
}

/// Whether a picture does more than cover its sheet.
pub(super) fn is_moved(file: &MapFile, size_mm: DVec2) -> bool {
    let covering = DAffine2::from_scale(size_mm.recip());
    !file.uv_from_side.abs_diff_eq(covering, 1e-12)
}

/// Size of a picture's pixel on the sheet in mm, along its rows and columns.
pub(super) fn pixel_mm(file: &MapFile) -> DVec2 {
    let [width, height] = file.size.map(|side| f64::from(side.max(1)));
    file.extent_mm() / DVec2::new(width, height)
}

/// What a picture is decoded as.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Colour,
    Height,
    Outline,
}

/// Decoded pictures.
#[derive(Default)]
pub(super) struct Pictures(Vec<(MapFile, Kind, Arc<Pyramid>)>);

/// A picture on a side.
pub(super) struct Picture {
    pyramid: Arc<Pyramid>,
    uv_from_side: DAffine2,
    /// Size of a pixel in mm.
    pub pixel_mm: DVec2,
}

impl Pictures {
    fn load(
        &mut self,
        file: &MapFile,
        kind: Kind,
        load: impl FnOnce() -> Result<Pyramid, MapError>,
    ) -> Result<Picture, ReadingError> {
        // One file that is bent in two ways is two pictures.
        let same = |held: &&(MapFile, Kind, Arc<Pyramid>)| {
            held.0.path == file.path && held.0.warp == file.warp && held.1 == kind
        };
        let pyramid = match self.0.iter().find(same) {
            Some((.., held)) => held.clone(),
            None => {
                let loaded = load().map_err(|error| ReadingError::Map {
                    path: file.path.clone(),
                    error,
                })?;
                let loaded = Arc::new(loaded);
                self.0.push((file.clone(), kind, loaded.clone()));
                loaded
            }
        };
        Ok(Picture {
            pyramid,
            uv_from_side: file.uv_from_side,
            pixel_mm: pixel_mm(file),
        })
    }

    /// Linear sRGB.
    pub fn colour(&mut self, map: &ColourMap) -> Result<Picture, ReadingError> {
        let load = || maps::load_colour(&map.file, map.encoding);
        self.load(&map.file, Kind::Colour, load)
    }

    /// Shares of a declared range.
    pub fn height(&mut self, file: &MapFile) -> Result<Picture, ReadingError> {
        self.load(file, Kind::Height, || maps::load_height(file))
    }

    fn outline(&mut self, file: &MapFile) -> Result<Picture, ReadingError> {
        self.load(file, Kind::Outline, || maps::load_outline(&file.path))
    }
}

impl Picture {
    /// Its values at a place of the side, linear between the middles of its pixels, without the
    /// smaller levels; `None` beside the picture.
    pub fn at(&self, on_side: DVec2) -> Option<[f64; 4]> {
        let uv = self.uv_from_side.transform_point2(on_side);
        // Rounding at the very edge is no reason to miss it.
        let inside =
            uv.cmpge(DVec2::splat(-1e-9)).all() && uv.cmple(DVec2::splat(1.0 + 1e-9)).all();
        let level = self.pyramid.levels.first().filter(|_| inside)?;
        let size = [level.width, level.height].map(|side| side.max(1) as usize);
        let channels = usize::from(self.pyramid.channels);
        let texel = |x: usize, y: usize, c: usize| {
            let at = (y * size[0] + x) * channels + c.min(channels - 1);
            f64::from(level.texels.get(at).unwrap_or_default())
        };
        let place = |u: f64, side: usize| {
            let at = (u * side as f64 - 0.5).clamp(0.0, (side - 1) as f64);
            (at as usize, (at as usize + 1).min(side - 1), at.fract())
        };
        let (x_0, x_1, s) = place(uv.x, size[0]);
        let (y_0, y_1, t) = place(uv.y, size[1]);
        Some(std::array::from_fn(|c| {
            let top = texel(x_0, y_0, c) * (1.0 - s) + texel(x_1, y_0, c) * s;
            let bottom = texel(x_0, y_1, c) * (1.0 - s) + texel(x_1, y_1, c) * s;
            top * (1.0 - t) + bottom * t
        }))
    }

    /// Its linear sRGB at a place.
    pub fn colour_at(&self, on_side: DVec2) -> Option<[f64; 3]> {
        self.at(on_side).map(|[r, g, b, _]| [r, g, b])
    }

    /// One size of its pixels, in mm.
    pub fn pitch_mm(&self) -> f64 {
        (self.pixel_mm.x * self.pixel_mm.y).sqrt()
    }
}

impl Desk<'_> {
    /// The picture of the side in a state.
    pub(super) fn albedo(
        &mut self,
        state: Option<usize>,
    ) -> Result<(ColourMap, Picture), ReadingError> {
        let side = self.side(state).ok_or_else(|| ReadingError::NoPicture {
            side: self.scene.side,
            in_state: self.in_state(state),
        })?;
        let picture = self.pictures.colour(&side.albedo)?;
        Ok((side.albedo, picture))
    }

    /// A picture that lies in the recto's frame, in that of the side that is seen.
    pub(super) fn as_seen(&self, mut file: MapFile) -> MapFile {
        file.uv_from_side *= self.drawing().recto_from(self.scene.side);
        file
    }

    /// Whether there is sheet at a place of the side: within its edge and its outline.
    pub(super) fn on_sheet(&mut self) -> Result<impl Fn(DVec2) -> bool + use<>, ReadingError> {
        let size_mm = self.drawing().size_mm;
        let outline = match self.drawing().outline.clone() {
            Some(file) => {
                let file = self.as_seen(file);
                Some(self.pictures.outline(&file)?)
            }
            None => None,
        };
        Ok(move |place: DVec2| {
            let inside = place.cmpge(DVec2::ZERO).all() && place.cmple(size_mm).all();
            inside
                && outline.as_ref().is_none_or(|outline| {
                    outline.at(place).is_some_and(|[cover, ..]| cover >= SHEET)
                })
        })
    }
}
