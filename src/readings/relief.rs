//! The relief along a line, from the side's height map.

use glam::DVec2;

use super::{Desk, Reading, ReadingError, Tool, Value, reading, samples, words};
use crate::{
    maps::probe,
    measure::{self, MeasureError, Measured, profile::MAX_SAMPLES},
};

impl Desk<'_> {
    pub(super) fn relief(
        &mut self,
        tool: &Tool,
        [from, to]: [DVec2; 2],
        screen_mm: f64,
    ) -> Result<Reading, ReadingError> {
        let state = self.scene.state;
        let (side, in_state) = (self.scene.side, self.in_state(state));
        let map = self.side(state).and_then(|side| side.height);
        let map = map.ok_or(ReadingError::NoHeight { side, in_state })?;
        let picture = self.pictures.height(&map.file)?;
        let [low, high] = map.range_um;
        let height = |place: DVec2| {
            let share = picture.at(place).map_or(f64::NAN, |[share, ..]| share);
            low + (high - low) * share
        };
        let (mut accuracy, mut notes) = self.accuracy(screen_mm);
        let (residual, note) = self.registration(&map.file);
        accuracy.registration_mm = accuracy.registration_mm.max(residual);
        notes.extend(note);
        let length = measure::ruler(from, to, accuracy)?;
        let pitch = picture.pixel_mm.min_element();
        let count = (length.value / pitch).ceil() + 1.0;
        let profile = measure::profile(from, to, (count as usize).clamp(3, MAX_SAMPLES), height)
            .map_err(|error| match error {
                // Beside the picture there is no height.
                MeasureError::NotFinite("a height in µm") => MeasureError::OffSheet {
                    found: 0,
                    needed: 1,
                },
                error => error,
            })?;
        // A step of the file is a uniform distribution (GUM 4.3.7); 16 bits are kept of floats.
        let bits = probe(&map.file.path).map_or(16, |header| header.bits.min(16));
        let step = (high - low).abs() / (f64::from(1u32 << bits) - 1.0);
        // Where the relief is steep, its height is known as badly as the place is.
        let slopes = profile.samples.windows(2).map(|pair| {
            let rise = pair[1].height_um - pair[0].height_um;
            rise / (pair[1].distance_mm - pair[0].distance_mm)
        });
        let square =
            slopes.map(|slope| slope * slope).sum::<f64>() / (profile.samples.len() - 1) as f64;
        let sigma = (step * step / 12.0 + square * accuracy.place_mm()?.powi(2)).sqrt();
        let total = Measured {
            value: profile.height_um,
            sigma: std::f64::consts::SQRT_2 * sigma,
        };
        let roughness = Measured {
            value: profile.roughness_um,
            sigma,
        };
        let slope = Measured {
            value: profile.slope_um_per_mm,
            // Of the two ends.
            sigma: std::f64::consts::SQRT_2 * sigma / length.value,
        };
        let words = format!(
            "profile {} to {}: height {} (Pt), roughness {} (Pq), over {}",
            words::at(from),
            words::at(to),
            words::plus_minus(total, " µm"),
            words::plus_minus(roughness, " µm"),
            words::plus_minus(length, " mm")
        );
        notes.extend(self.source(&map.file));
        let values = vec![
            Value::new("length", length, "mm"),
            Value::new("height without the trend (Pt)", total, "µm"),
            Value::new("roughness without the trend (Pq)", roughness, "µm"),
            Value::new("trend", slope, "µm/mm"),
        ];
        Ok(Reading {
            samples: samples(&profile.samples, sigma),
            ..reading(tool, values, words, notes)
        })
    }
}
