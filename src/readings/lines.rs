//! Spacing of laid and chain lines in a rectangle, from the transmission map or else the albedo.

use glam::DVec2;

use super::{Desk, Note, Reading, ReadingError, Tool, Value, reading, words::plus_minus};
use crate::{
    colour::luminance,
    manifest::exhibit::MapFile,
    measure::{Lines, MeasureError, Measured, NoLines, Raster, mould_lines, raster::MAX_PIXELS},
};

impl Desk<'_> {
    pub(super) fn mould(
        &mut self,
        tool: &Tool,
        corners: [DVec2; 2],
    ) -> Result<Reading, ReadingError> {
        let [least, most] = [corners[0].min(corners[1]), corners[0].max(corners[1])];
        let on_sheet = self.on_sheet()?;
        let transmission = self.drawing().transmission.clone();
        let (file, picture, seen): (MapFile, _, fn([f64; 4]) -> f64) = match transmission {
            Some(file) => {
                let file = self.as_seen(file);
                let picture = self.pictures.height(&file)?;
                (file, picture, |[share, ..]| share)
            }
            None => {
                let (map, picture) = self.albedo(self.scene.state)?;
                (map.file, picture, |[r, g, b, _]| luminance([r, g, b]))
            }
        };
        let pitch = picture.pitch_mm();
        let [width, height] = ((most - least) / pitch).floor().to_array();
        if width * height > MAX_PIXELS as f64 || width < 1.0 || height < 1.0 {
            return Err(MeasureError::Range {
                what: "the smaller side of the rectangle in mm",
                found: (most - least).min_element(),
                allowed: "a pixel of the map at least, and fewer than 2^27 pixels in all",
            }
            .into());
        }
        let (width, height) = (width as usize, height as usize);
        let values = (0..width * height)
            .map(|i| {
                let place = DVec2::new((i % width) as f64, (i / width) as f64) + 0.5;
                let place = least + place * pitch;
                let value = picture.at(place).filter(|_| on_sheet(place)).map(seen);
                value.map_or(f32::NAN, |value| value as f32)
            })
            .collect();
        let mould = mould_lines(&Raster::new(width, height, values, pitch)?);
        let mut words = Vec::new();
        let mut read = Vec::new();
        for (lines, [name, spacing, direction]) in [
            (
                mould.laid,
                ["laid", "spacing of laid lines", "direction of laid lines"],
            ),
            (
                mould.chain,
                [
                    "chain",
                    "spacing of chain lines",
                    "direction of chain lines",
                ],
            ),
        ] {
            words.push(said(name, &lines));
            match lines {
                Ok(lines) => {
                    read.push(Value::new(spacing, spacing_of(&lines), "mm"));
                    read.push(Value::new(direction, direction_of(&lines), "°"));
                }
                Err(why) => read.push(Value::none(spacing, "mm", why)),
            }
        }
        let mut notes = vec![Note::Lines {
            file: self.name_of(&file),
        }];
        notes.extend(self.source(&file));
        Ok(reading(tool, read, words.join("; "), notes))
    }
}

fn spacing_of(lines: &Lines) -> Measured {
    Measured {
        value: lines.spacing_mm,
        sigma: lines.sigma_mm,
    }
}

fn direction_of(lines: &Lines) -> Measured {
    Measured {
        value: lines.direction_deg,
        sigma: lines.direction_sigma_deg,
    }
}

fn said(name: &str, lines: &Result<Lines, NoLines>) -> String {
    match lines {
        Ok(lines) => format!(
            "{name} lines every {}, along {}",
            plus_minus(spacing_of(lines), " mm"),
            plus_minus(direction_of(lines), "°")
        ),
        Err(why) => format!("{name} lines: none ({why})"),
    }
}
