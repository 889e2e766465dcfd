//! Places whose photographs are kept while they run through.

use glam::{DVec2, DVec3};

use super::first::Seen;
use crate::prepare::{capture::Crop, materials::Known, photographs::Band};

/// Places kept of a side, and of each swatch, in the first run through the photographs.
const KEPT: usize = 60_000;
const KEPT_OF_SWATCH: usize = 1_500;
/// Bytes that they may take.
const KEPT_BYTES: usize = 48 << 20;
/// Places that a fit takes.
const PLACES: usize = 120;

/// Photographs of places all over a side.
#[derive(Clone, Debug)]
pub struct Samples {
    width: usize,
    step: usize,
    swatches: Vec<(Crop, usize)>,
    lamps: usize,
    /// Column and row.
    places: Vec<[u32; 2]>,
    /// Of each place, all its photographs.
    shown: Vec<[f32; 3]>,
}

impl Samples {
    /// Of a side of this size under so many lamps.
    pub fn new([width, height]: [usize; 2], lamps: usize, swatches: &[Known]) -> Self {
        let most = KEPT_BYTES / (lamps.max(1) * size_of::<[f32; 3]>());
        let of_swatches = (KEPT_OF_SWATCH * swatches.len()).min(most / 2);
        let most = KEPT.min(most - of_swatches).max(1);
        let every = |pixels: usize, most: usize| {
            ((pixels as f64 / most.max(1) as f64).sqrt().ceil() as usize).max(1)
        };
        let of_each = of_swatches / swatches.len().max(1);
        let swatches = swatches.iter().map(|swatch| {
            let pixels = swatch.rect.width() * swatch.rect.height();
            (swatch.rect, every(pixels, of_each))
        });
        Self {
            width,
            step: every(width * height, most),
            swatches: swatches.collect(),
            lamps,
            places: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Of so many rows one is asked for, unless there are swatches.
    pub fn step(&self) -> usize {
        self.step
    }

    fn wants(&self, x: usize, y: usize) -> bool {
        // A step aside in each row of samples, so that no column of laid lines is all there is.
        let row = y / self.step;
        if y.is_multiple_of(self.step) && (x + row).is_multiple_of(self.step) {
            return true;
        }
        self.swatches.iter().any(|(rect, step)| {
            let (left, top) = (rect.left as usize, rect.top as usize);
            let inside = (left..rect.right as usize).contains(&x)
                && (top..rect.bottom as usize).contains(&y);
            inside && (x - left).is_multiple_of(*step) && (y - top).is_multiple_of(*step)
        })
    }

    /// Reads a band whose light was divided out.
    pub fn add(&mut self, band: &Band) {
        for row in 0..band.rows {
            let y = band.y(row);
            let at_all = y.is_multiple_of(self.step)
                || self
                    .swatches
                    .iter()
                    .any(|(rect, _)| (rect.top as usize..rect.bottom as usize).contains(&y));
            if !at_all {
                continue;
            }
            let photographs: Vec<[&[f32]; 3]> = (0..self.lamps).map(|i| band.row(i, row)).collect();
            for x in 0..band.width.min(self.width) {
                if self.wants(x, y) {
                    self.places.push([x as u32, y as u32]);
                    let each = photographs.iter();
                    self.shown
                        .extend(each.map(|planes| planes.map(|plane| plane[x])));
                }
            }
        }
    }
}

/// A place with all its photographs, in the sheet's colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Where its middle is, in pixels.
    pub at: DVec2,
    pub shown: Vec<DVec3>,
    /// As stereo found them.
    pub normal: DVec3,
    pub albedo: DVec3,
}

/// What a side says of its sampled places.
pub struct Sheet<'s> {
    /// The class of each pixel.
    pub classes: &'s [u8],
    pub normals: &'s [[f32; 3]],
    /// Linear.
    pub albedo: &'s dyn Fn(usize) -> DVec3,
    /// From a photograph's colours to those of the albedo.
    pub colour: &'s dyn Fn([f32; 3]) -> DVec3,
}

impl Samples {
    /// All of them, as they were photographed.
    pub fn seen(&self) -> Vec<Seen> {
        let shown = self.shown.chunks(self.lamps.max(1));
        let each = self.places.iter().zip(shown);
        each.map(|([x, y], shown)| Seen {
            at: DVec2::new(f64::from(*x) + 0.5, f64::from(*y) + 0.5),
            shown: shown
                .iter()
                .map(|rgb| DVec3::from(rgb.map(f64::from)))
                .collect(),
        })
        .collect()
    }

    /// Places of a class that are surrounded by their own, at most as many as a fit takes, from
    /// all over.
    pub fn of_class(&self, class: u8, sheet: &Sheet<'_>) -> Vec<Place> {
        let height = sheet.classes.len() / self.width.max(1);
        let own = |i: &usize| {
            let [x, y] = self.places[*i].map(|v| v as usize);
            (y.saturating_sub(1)..(y + 2).min(height)).all(|y| {
                let line = y * self.width;
                let row = x.saturating_sub(1)..(x + 2).min(self.width);
                row.into_iter().all(|x| sheet.classes[line + x] == class)
            })
        };
        let inside: Vec<usize> = (0..self.places.len()).filter(own).collect();
        let count = inside.len().min(PLACES);
        let place = |k: usize| {
            let i = inside[k * inside.len() / count];
            let [x, y] = self.places[i].map(|v| v as usize);
            let at = y * self.width + x;
            let shown = &self.shown[i * self.lamps..(i + 1) * self.lamps];
            Place {
                at: DVec2::new(x as f64 + 0.5, y as f64 + 0.5),
                shown: shown.iter().map(|rgb| (sheet.colour)(*rgb)).collect(),
                normal: DVec3::from(sheet.normals[at].map(f64::from)).normalize_or(DVec3::Z),
                albedo: (sheet.albedo)(at),
            }
        };
        (0..count).map(place).collect()
    }
}
