//! Before the bands run through: where the lamps are, how bright, what they give to each place,
//! and how colours are corrected.

mod ball;
mod chart;

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    PrepareError,
    capture::{Capture, Chart, Circle, Crop, Intensities, Light, Places, Shots},
    colour::{
        chart::{ChartError, MOST_OFF, colours, colours_unclipped, middles},
        correct::{self, Correction, Fitted},
    },
    flat_field::FlatField,
    lights::{self, intensity, sphere},
    moved,
    photographs::Stack,
    reduced::Grey,
    stereo::{Gain, Rig, Standing},
};

/// Places that brightness is compared at, along the longer side.
const SAMPLES: usize = 96;

/// The lamps of a capture, as found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLamps {
    pub standing: Standing,
    /// The ball that they were found in.
    pub circle: Option<Circle>,
    /// How well they span space: see [`lights::spread`].
    pub spread: f64,
}

/// Finds the lamps.
///
/// # Errors
/// Where a ball shows none, or they do not stand around the sheet.
pub fn lamps(capture: &Capture, scratch: &Path) -> Result<FoundLamps, PrepareError> {
    let (standing, circle) = match &capture.lamps.places {
        Places::Directions(directions) => (Standing::Far(directions.clone()), None),
        Places::Positions(positions) => (Standing::Near(positions.clone()), None),
        Places::Sphere(ball) => {
            let photographs = match ball.photographs.is_empty() {
                true => &capture.recto.photographs,
                false => &ball.photographs,
            };
            let circle = match ball.circle {
                Some(circle) => circle,
                None => self::ball::outline(photographs, capture.encoding, scratch)?,
            };
            let found: Result<Vec<DVec3>, PrepareError> = photographs
                .iter()
                .map(|path| in_ball(path, capture, circle, scratch))
                .collect();
            (Standing::Far(found?), Some(circle))
        }
    };
    let spread = lights::spread(&standing.directions()).map_err(|why| PrepareError::Lamps {
        file: capture.file.clone(),
        why,
    })?;
    Ok(FoundLamps {
        standing,
        circle,
        spread,
    })
}

/// The lamp that a ball shows in one photograph.
fn in_ball(
    path: &Path,
    capture: &Capture,
    circle: Circle,
    scratch: &Path,
) -> Result<DVec3, PrepareError> {
    let refused = |why| PrepareError::Ball {
        path: path.to_owned(),
        why,
    };
    let size = crate::maps::probe(path)?.size;
    let low = circle.centre - circle.radius;
    let high = circle.centre + circle.radius;
    let whole =
        low.min_element() >= 0.0 && high.x <= f64::from(size[0]) && high.y <= f64::from(size[1]);
    if !whole {
        return Err(refused(sphere::NoHighlight::Outside));
    }
    let crop = Crop {
        left: low.x as u32,
        top: low.y as u32,
        right: (high.x.ceil() as u32).min(size[0]),
        bottom: (high.y.ceil() as u32).min(size[1]),
    };
    let planes = planes(path, capture, crop, scratch)?;
    let luma = sphere::luma(planes.each_ref().map(Vec::as_slice));
    let within = Circle {
        centre: circle.centre - DVec2::new(f64::from(crop.left), f64::from(crop.top)),
        ..circle
    };
    let found = sphere::highlight(&luma, [crop.width(), crop.height()], within);
    found.map(|found| found.direction).map_err(refused)
}

/// Part of a photograph, as planes.
pub fn planes(
    path: &Path,
    capture: &Capture,
    crop: Crop,
    scratch: &Path,
) -> Result<[Vec<f32>; 3], PrepareError> {
    let paths = [path.to_owned()];
    let mut stack = Stack::open(&paths, None, capture.encoding, crop, scratch)?;
    let mut planes = [Vec::new(), Vec::new(), Vec::new()];
    while let Some(band) = stack.next()? {
        for (plane, rows) in planes.iter_mut().zip(&band.planes[0]) {
            plane.extend_from_slice(rows);
        }
    }
    Ok(planes)
}

/// The whole of a picture of this size.
pub fn whole([right, bottom]: [u32; 2]) -> Crop {
    Crop {
        left: 0,
        top: 0,
        right,
        bottom,
    }
}

/// What each lamp gives to each place of a side; without grey cards what a chart says of white,
/// and empty without a chart.
///
/// # Errors
/// Of the first card that cannot be used.
pub fn flat_fields(
    capture: &Capture,
    shots: &Shots,
    correction: Option<&Correction>,
    scratch: &Path,
) -> Result<Vec<FlatField>, PrepareError> {
    let Light::FlatField {
        photographs,
        reflectance,
        ambient,
    } = &capture.lamps.light
    else {
        let of_white = |of: &Correction| {
            let field = FlatField::of_white(of.white);
            vec![field; shots.photographs.len()]
        };
        return Ok(correction.map(of_white).unwrap_or_default());
    };
    let (ambient, encoding) = (ambient.as_deref(), capture.encoding);
    let read = |path: &PathBuf| {
        FlatField::read(path, ambient, encoding, shots.crop, *reflectance, scratch)
            .map_err(PrepareError::from)
    };
    photographs.par_iter().map(read).collect()
}

/// The lamps as the photographs of a side see them, but for how bright they are.
pub struct Looked {
    rig: Rig,
    samples: Option<Samples>,
    /// The photographs made smaller by [`moved::step`], where they had to be read for their lamps.
    pub greys: Option<Vec<Grey>>,
}

/// Looks at the photographs of a side as far as its lamps need it.
///
/// # Errors
/// Of the first photograph that cannot be read.
pub fn look(
    capture: &Capture,
    shots: &Shots,
    lamps: &FoundLamps,
    scratch: &Path,
) -> Result<Looked, PrepareError> {
    let crop = shots.crop;
    let [width, height] = shots.size.map(f64::from);
    let mut rig = Rig {
        standing: lamps.standing.clone(),
        gain: Gain::FlatFielded,
        mm_per_px: capture.mm_per_px,
        middle_px: DVec2::new(width, height) / 2.0
            - DVec2::new(f64::from(crop.left), f64::from(crop.top)),
    };
    let equal = vec![1.0; rig.count()];
    let (mut samples, mut greys) = (None, None);
    rig.gain = match &capture.lamps.light {
        Light::FlatField { .. } => Gain::FlatFielded,
        Light::Relative(values) => {
            // Only their ratios are known.
            let mut values = values.clone();
            intensity::normalise(&mut values);
            Gain::Relative(values)
        }
        Light::Unknown(Intensities::Equal) => Gain::Relative(equal),
        Light::Unknown(Intensities::Solve) => {
            rig.gain = Gain::Relative(equal);
            let (shown, seen) = self::samples(capture, shots, &rig, scratch)?;
            (samples, greys) = (Some(shown), seen);
            rig.gain
        }
    };
    Ok(Looked {
        rig,
        samples,
        greys,
    })
}

impl Looked {
    /// The lamps as the photographs `shots` see them.
    ///
    /// # Errors
    /// [`PrepareError::Dark`] where they cannot be compared in brightness.
    pub fn rig(self, shots: &Shots) -> Result<Rig, PrepareError> {
        let mut rig = self.rig;
        if let Some(samples) = self.samples {
            let directions = rig.standing.directions();
            let found = intensity::solve(&directions, &samples);
            rig.gain = Gain::Relative(found.ok_or_else(|| PrepareError::Dark {
                path: shots.photographs[0].clone(),
            })?);
        }
        Ok(rig)
    }
}

/// Of each place, what each photograph shows.
type Samples = Vec<Vec<f64>>;

/// What all photographs show at places all over the sheet, each for its own distance and angle
/// to a near lamp of `middle`, which are equally bright; and the photographs made smaller, where
/// memory allows.
fn samples(
    capture: &Capture,
    shots: &Shots,
    middle: &Rig,
    scratch: &Path,
) -> Result<(Samples, Option<Vec<Grey>>), PrepareError> {
    let step = (shots.crop.width().max(shots.crop.height()) / SAMPLES).max(1);
    let ambient = shots.ambient.as_deref();
    let mut stack = Stack::open(
        &shots.photographs,
        ambient,
        capture.encoding,
        shots.crop,
        scratch,
    )?;
    let reduced = moved::step(shots);
    if let Some(step) = reduced {
        stack.reduce(step);
    }
    let mut samples = Vec::new();
    while let Some(band) = stack.next()? {
        for row in (0..band.rows).filter(|row| (band.top + row).is_multiple_of(step)) {
            for x in (step / 2..band.width).step_by(step) {
                let at = DVec2::new(x as f64 + 0.5, (band.top + row) as f64 + 0.5);
                let shown = (0..middle.count()).map(|i| {
                    let grey: f32 = band.row(i, row).iter().map(|plane| plane[x]).sum();
                    let lit = middle.lamp(i, at);
                    // As the lamp would show it from the middle.
                    let from_middle = middle.lamp(i, middle.middle_px).l.z;
                    f64::from(grey) / (lit.gain * lit.l.z.max(1e-3)) * from_middle
                });
                samples.push(shown.collect());
            }
        }
        stack.recycle(band);
    }
    Ok((samples, reduced.map(|_| stack.greys())))
}

/// The correction of colours, where there is a chart: from stereo's units under the recto's `rig`,
/// under the first lamp of which the chart lies flat.
///
/// # Errors
/// Where its patches cannot be read.
pub fn correction(
    capture: &Capture,
    rig: &Rig,
    scratch: &Path,
) -> Result<Option<Fitted>, PrepareError> {
    let Some(chart) = &capture.chart else {
        return Ok(None);
    };
    let corners = self::chart::corners(chart, capture.encoding, scratch)?;
    let Chart {
        photograph, lab, ..
    } = chart;
    let refused = |why| PrepareError::Chart {
        path: photograph.clone(),
        why,
    };
    let header = crate::maps::probe(photograph)?;
    let size = header.size;
    let mut planes = planes(photograph, capture, whole(size), scratch)?;
    let [width, height] = size.map(|v| v as usize);
    // Clipping shows before the light is evened out; floats have no level of it.
    let read = if header.float {
        colours_unclipped
    } else {
        colours
    };
    let mut measured = read(
        planes.each_ref().map(Vec::as_slice),
        [width, height],
        corners,
    )
    .map_err(refused)?;
    if let Some(field) = self::chart::field(chart, capture, size, scratch)? {
        let [r, g, b] = &mut planes;
        for y in 0..height {
            let row = y * width..(y + 1) * width;
            let planes = [&mut r[row.clone()], &mut g[row.clone()], &mut b[row]];
            field.divide(y, planes);
        }
        measured = colours_unclipped(
            planes.each_ref().map(Vec::as_slice),
            [width, height],
            corners,
        )
        .map_err(refused)?;
    }
    let places = middles(corners).map_err(refused)?;
    let shown = self::chart::diffuser(chart, capture, rig, size);
    for (rgb, at) in measured.iter_mut().zip(places) {
        let shown = shown(at);
        rgb.iter_mut().for_each(|v| *v /= shown);
    }
    let fitted = correct::fit(&measured, lab, capture.illuminant.xy());
    match fitted {
        None => Err(refused(ChartError::Flat)),
        Some(fitted) if fitted.off() > MOST_OFF => Err(refused(ChartError::Unlike(fitted.off()))),
        Some(mut fitted) => {
            if matches!(rig.gain, Gain::Relative(_)) {
                fitted.correction = fitted.correction.balanced();
            }
            Ok(Some(fitted))
        }
    }
}
