//! From what was written to what can be relied on: [`RawCapture`] → [`Capture`], gathering every
//! fault.

mod files;
mod lamps;

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::{
    BARE_PAPER, Capture, Chart, Crop, OtherSurface, Relief, Shots, Swatch, Transmitted,
    raw::{RawCapture, RawChart, RawRelief, RawScale, RawShots, RawSwatch, RawTransmitted},
};
use crate::{
    manifest::{
        Pattern, SideName,
        decode::{Decode, List, Report},
        did_you_mean,
        document::{Trail, Words},
        quote, quoted_list,
        raw::values::{PixelPx, SheetMm},
    },
    maps::surface::load_gltf,
    optics::{
        medium::{MediumId, MediumKind},
        spectrum::Illuminant,
    },
    prepare::colour::chart::{COLORCHECKER24, PATCHES, read_table},
};

/// mm in an inch.
const INCH_MM: f64 = 25.4;

/// What all parts of the validation share.
struct Validator<'r, 'd> {
    report: &'r mut Report<'d>,
    /// The capture file's own.
    folder: PathBuf,
}

/// Validates the capture of `file`. `None` only if there are faults in `report`.
pub(super) fn capture(raw: &RawCapture, file: &Path, report: &mut Report<'_>) -> Option<Capture> {
    let folder = file.parent().unwrap_or(Path::new("")).to_owned();
    Validator { report, folder }.capture(raw, file)
}

impl Validator<'_, '_> {
    fn capture(&mut self, raw: &RawCapture, file: &Path) -> Option<Capture> {
        let root = Trail::default();
        let mm_per_px = self.scale(&raw.scale, &root.key("scale"));
        let lamps_trail = root.key("lamps");
        let placed = self.placed(&raw.lamps, &lamps_trail);
        let named = placed.as_ref().map_or(&[][..], |placed| &placed.named);
        let recto = self.shots(&raw.recto, named, &root.key("recto"));
        let verso_raw = raw.verso.as_ref();
        let verso = verso_raw.map(|verso| self.shots(verso, &[], &root.key("verso")));
        if let (Some(placed), Some(recto)) = (&placed, &recto) {
            let count = placed.count(Some(recto)).unwrap_or_default();
            self.one_each(recto, count, &root.key("recto"));
            if let Some(Some(verso)) = &verso {
                self.one_each(verso, count, &root.key("verso"));
            }
        }
        self.room_light(raw, &root);
        let sides = [recto.as_ref(), verso.as_ref().and_then(Option::as_ref)];
        let lamps = placed.and_then(|placed| self.lamps(placed, &raw.lamps, sides, &lamps_trail));
        if let Some(mm) = mm_per_px {
            self.extent(mm, sides[0], &root.key("scale"));
        }
        let size = recto.as_ref().map(|shots| shots.size);
        let chart = raw.chart.as_ref();
        let chart = chart.map(|chart| self.chart(chart, &root.key("chart")));
        let transmitted = raw.transmitted.as_ref();
        let transmitted =
            transmitted.map(|raw| self.transmitted(raw, size, &root.key("transmitted")));
        let of_verso = verso.as_ref().and_then(Option::as_ref);
        let swatches = self.swatches(raw, recto.as_ref(), of_verso, &root.key("swatch"));
        let compare = raw.relief.as_ref();
        let compare = compare.and_then(|relief| self.compare(relief, &root.key("relief")));
        Some(Capture {
            file: file.to_owned(),
            id: raw.id.as_str().to_owned(),
            title: raw.title.as_ref().map(|title| title.as_str().to_owned()),
            encoding: raw.encoding.unwrap_or_default(),
            illuminant: raw.illuminant.unwrap_or(Illuminant::D50),
            mm_per_px: mm_per_px?,
            lamps: lamps?,
            recto: recto?,
            verso: match verso {
                Some(verso) => Some(verso?),
                None => None,
            },
            chart: match chart {
                Some(chart) => Some(chart?),
                None => None,
            },
            transmitted: match transmitted {
                Some(transmitted) => Some(transmitted?),
                None => None,
            },
            swatches,
            relief: relief(raw.relief.as_ref()),
            compare,
        })
    }

    fn scale(&mut self, raw: &RawScale, trail: &Trail) -> Option<f64> {
        if let Some(mm) = raw.mm_per_px {
            return Some(mm.0);
        }
        if let Some(dpi) = raw.dpi {
            return Some(INCH_MM / dpi.0);
        }
        let ruler = raw.ruler.as_ref()?;
        let length_px = point(ruler.from_px).distance(point(ruler.to_px));
        /// A mark is clicked within a pixel or two.
        const SHORTEST_PX: f64 = 50.0;
        if length_px < SHORTEST_PX {
            let words = Words::new(
                format!("marks that are {length_px:.1} pixels from each other"),
                format!("marks at least {SHORTEST_PX} pixels apart"),
                "choose marks further apart, as the error of each is about a pixel",
            );
            self.report.fault(&trail.key("ruler"), words);
            return None;
        }
        Some(ruler.length_mm.0 / length_px)
    }

    /// A sheet is of a size that an exhibit can have.
    fn extent(&mut self, mm_per_px: f64, recto: Option<&Shots>, trail: &Trail) {
        let Some(crop) = recto.map(|recto| recto.crop) else {
            return;
        };
        let size = [crop.width(), crop.height()].map(|px| px as f64 * mm_per_px);
        if size.iter().all(|mm| SheetMm::RANGE.contains(mm)) {
            return;
        }
        let words = Words::new(
            format!(
                "a sheet of {:.2} × {:.2} mm, by {} × {} pixels",
                size[0],
                size[1],
                crop.width(),
                crop.height()
            ),
            format!("sides of {}", SheetMm::allowed()),
            "correct the scale, or crop_px where it leaves hardly anything",
        );
        self.report.fault(trail, words);
    }

    /// Of a side; `named` are the photographs that a file of lamps names.
    fn shots(&mut self, raw: &RawShots, named: &[PathBuf], trail: &Trail) -> Option<Shots> {
        let key = trail.key("photographs");
        let photographs: Vec<(PathBuf, Trail)> = match &raw.photographs {
            Some(list) => {
                let paths = list.iter();
                paths
                    .map(|(i, path)| (self.path(path), key.index(i)))
                    .collect()
            }
            None if named.is_empty() => {
                let words = Words::new(
                    "no photographs",
                    "one under each lamp, in the order of the lamps",
                    "add photographs = [\"…\", …]",
                );
                self.report.fault(trail, words);
                return None;
            }
            None => named
                .iter()
                .map(|path| (path.clone(), key.clone()))
                .collect(),
        };
        let ambient = raw.ambient.as_ref().map(|path| self.path(path));
        let all = photographs
            .iter()
            .map(|(path, trail)| (path, trail.clone()));
        let ambient_trail = trail.key("ambient");
        let all = all.chain(ambient.iter().map(|path| (path, ambient_trail.clone())));
        let all: Vec<(&PathBuf, Trail)> = all.collect();
        let size = self.same_size(&all, None)?;
        let photographed: Vec<(&PathBuf, Trail)> = photographs
            .iter()
            .map(|(path, trail)| (path, trail.clone()))
            .collect();
        if !self.all_differ(&photographed) {
            return None;
        }
        let holes = raw.photographs.as_ref().is_some_and(List::has_holes);
        let crop = match raw.crop_px {
            Some(edges) => self.rect(edges, size, &trail.key("crop_px"))?,
            None => Crop {
                left: 0,
                top: 0,
                right: size[0],
                bottom: size[1],
            },
        };
        (!holes).then_some(Shots {
            photographs: photographs.into_iter().map(|(path, _)| path).collect(),
            ambient,
            size,
            crop,
        })
    }

    fn one_each(&mut self, shots: &Shots, lamps: usize, trail: &Trail) {
        let count = shots.photographs.len();
        if count != lamps {
            let words = Words::new(
                format!("{count} photographs for {lamps} lamps"),
                "one photograph for each lamp",
                "add or remove photographs, in the order of the lamps",
            );
            self.report.fault(&trail.key("photographs"), words);
        }
    }

    fn rect(&mut self, edges: [PixelPx; 4], size: [u32; 2], trail: &Trail) -> Option<Crop> {
        let [left, top, right, bottom] = edges.map(|px| px.0.round());
        let [width, height] = size.map(f64::from);
        let inside = left >= 0.0 && top >= 0.0 && right <= width && bottom <= height;
        if inside && right - left >= 1.0 && bottom - top >= 1.0 {
            return Some(Crop {
                left: left as u32,
                top: top as u32,
                right: right as u32,
                bottom: bottom as u32,
            });
        }
        let words = Words::new(
            format!("edges at {left}, {top}, {right} and {bottom}"),
            format!("left, top, right and bottom within {width} × {height} pixels"),
            "write the edges in this order, in pixels of the photographs",
        );
        self.report.fault(trail, words);
        None
    }

    fn chart(&mut self, raw: &RawChart, trail: &Trail) -> Option<Chart> {
        let photograph = self.path(&raw.photograph);
        let size = self.same_size(&[(&photograph, trail.key("photograph"))], None);
        let flat_field = raw.flat_field.as_ref().map(|path| self.path(path));
        if let (Some(path), Some(size)) = (&flat_field, size) {
            self.same_size(
                &[(path, trail.key("flat_field"))],
                Some((size, &photograph)),
            );
        }
        let corners = raw.corners_px.map(|corners| corners.map(point));
        if let (Some(corners), Some(size)) = (corners, size) {
            let key = trail.key("corners_px");
            let [width, height] = size.map(f64::from);
            for (i, corner) in corners.iter().enumerate() {
                let inside =
                    (0.0..=width).contains(&corner.x) && (0.0..=height).contains(&corner.y);
                if !inside {
                    let words = Words::new(
                        format!("a place at {}, {}", corner.x, corner.y),
                        format!("places within {width} × {height} pixels"),
                        "write pixels from the left and top edge",
                    );
                    self.report.fault(&key.index(i), words);
                }
            }
        }
        let lab = match &raw.file {
            None => COLORCHECKER24.map(|patch| patch.lab).to_vec(),
            Some(file) => self.table(&self.path(file), &trail.key("file"))?,
        };
        size?;
        Some(Chart {
            photograph,
            corners,
            lab,
            flat_field,
        })
    }

    /// Another surface of the sheet; `None` also where it cannot be used, of which there is a fault.
    fn compare(&mut self, raw: &RawRelief, trail: &Trail) -> Option<OtherSurface> {
        let path = self.path(raw.compare.as_ref()?);
        let key = trail.key("compare");
        let is_model = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        let range_um = raw.compare_range_um.map(|range| range.map(|um| um.0));
        if !is_model {
            self.same_size(&[(&path, key)], None)?;
        } else if !path.is_file() {
            let words = Words::new(
                format!("{}, which is not there", quote(&path.to_string_lossy())),
                "a .glb file, or a picture of heights",
                "correct the path, from the capture file's folder",
            );
            self.report.fault(&key, words);
            return None;
        } else if let Err(error) = load_gltf(&path) {
            let words = Words::new(
                error.to_string(),
                "a .glb file with one triangle mesh and texture coordinates, in mm",
                "export it again, or write a picture of heights and compare_range_um",
            );
            self.report.fault(&key, words);
            return None;
        }
        let (found, allowed, remedy) = match (is_model, range_um) {
            (true, None) => return Some(OtherSurface { path, range_um }),
            (false, Some([low, high])) if low < high => {
                return Some(OtherSurface { path, range_um });
            }
            (true, Some(_)) => (
                "a range of heights with a .glb file".to_owned(),
                "a range with pictures only",
                "remove compare_range_um: the file is in mm",
            ),
            (false, None) => (
                "a picture of heights without its range".to_owned(),
                "the heights of black and of white",
                "add compare_range_um = [black, white] in µm",
            ),
            (false, Some([low, high])) => (
                format!("black at {low} and white at {high} µm"),
                "white higher than black",
                "write the height of black first",
            ),
        };
        let words = Words::new(found, allowed, remedy);
        self.report.fault(&trail.key("compare_range_um"), words);
        None
    }

    fn table(&mut self, path: &Path, trail: &Trail) -> Option<Vec<[f64; 3]>> {
        let fault = match std::fs::read_to_string(path) {
            Err(error) => format!("{} ({error})", quote(&path.to_string_lossy())),
            Ok(text) => match read_table(&text) {
                Ok(lab) => return Some(lab),
                Err(why) => format!("{}: {why}", quote(&path.to_string_lossy())),
            },
        };
        let words = Words::new(
            fault,
            format!("{PATCHES} lines of L*, a*, b* under D50"),
            "correct the table, or leave it out for the usual ColorChecker",
        );
        self.report.fault(trail, words);
        None
    }

    fn transmitted(
        &mut self,
        raw: &RawTransmitted,
        size: Option<[u32; 2]>,
        trail: &Trail,
    ) -> Option<Transmitted> {
        let photograph = self.path(&raw.photograph);
        let flat_field = raw.flat_field.as_ref().map(|path| self.path(path));
        let mut files = vec![(&photograph, trail.key("photograph"))];
        files.extend(
            flat_field
                .iter()
                .map(|path| (path, trail.key("flat_field"))),
        );
        let recto = PathBuf::from("the recto's photographs");
        self.same_size(&files, size.map(|size| (size, recto.as_path())))?;
        Some(Transmitted {
            photograph,
            flat_field,
        })
    }

    fn swatches(
        &mut self,
        raw: &RawCapture,
        recto: Option<&Shots>,
        verso: Option<&Shots>,
        trail: &Trail,
    ) -> Vec<Swatch> {
        let mut swatches = Vec::new();
        for (i, swatch) in raw.swatch.iter().flat_map(|list| list.iter()) {
            let trail = trail.index(i);
            let side = swatch.side.unwrap_or_default();
            let shots = match side {
                SideName::Recto => recto,
                SideName::Verso => verso,
            };
            if side == SideName::Verso && raw.verso.is_none() {
                let words = Words::new(
                    "a swatch on the verso without photographs of it",
                    "sides that are photographed",
                    "add [verso], or correct the side",
                );
                self.report.fault(&trail.key("side"), words);
                continue;
            }
            let medium = self.medium(swatch, &trail);
            let rect = shots.and_then(|shots| self.on_sheet(swatch.rect_px, shots, &trail));
            if let (Some(medium), Some(rect)) = (medium, rect) {
                let swatch = Swatch { side, medium, rect };
                self.one_medium(&swatch, &swatches, &trail);
                swatches.push(swatch);
            }
        }
        self.enough(&swatches, trail);
        swatches
    }

    /// A place is drawn with one medium.
    fn one_medium(&mut self, swatch: &Swatch, earlier: &[Swatch], trail: &Trail) {
        let meets = |other: &&Swatch| {
            let (a, b) = (swatch.rect, other.rect);
            other.side == swatch.side
                && other.medium != swatch.medium
                && a.left.max(b.left) < a.right.min(b.right)
                && a.top.max(b.top) < a.bottom.min(b.bottom)
        };
        if let Some(other) = earlier.iter().find(meets) {
            let words = Words::new(
                format!(
                    "a place that another swatch says is {}",
                    other.medium.map_or(BARE_PAPER, MediumId::name)
                ),
                "swatches of different media apart",
                "correct one of the two",
            );
            self.report.fault(&trail.key("rect_px"), words);
        }
    }

    /// Each medium of a side has enough pixels to be learnt from.
    fn enough(&mut self, swatches: &[Swatch], trail: &Trail) {
        /// Half of them are learnt from, and the others choose and judge.
        const FEWEST_PX: usize = 40;
        let mut told = Vec::new();
        for (i, Swatch { side, medium, .. }) in swatches.iter().enumerate() {
            let all = swatches
                .iter()
                .filter(|other| (other.side, other.medium) == (*side, *medium));
            let pixels: usize = all
                .map(|swatch| swatch.rect.width() * swatch.rect.height())
                .sum();
            if pixels >= FEWEST_PX || told.contains(&(*side, *medium)) {
                continue;
            }
            told.push((*side, *medium));
            let name = medium.map_or(BARE_PAPER, MediumId::name);
            let words = Words::new(
                format!("{pixels} pixels of {name}"),
                format!("{FEWEST_PX} pixels or more of each medium, better a few hundred"),
                "enlarge its swatches, or add some",
            );
            self.report.fault(&trail.index(i).key("rect_px"), words);
        }
    }

    /// The rectangle of a swatch, which has to lie on what is the sheet.
    fn on_sheet(&mut self, edges: [PixelPx; 4], shots: &Shots, trail: &Trail) -> Option<Crop> {
        let trail = trail.key("rect_px");
        let rect = self.rect(edges, shots.size, &trail)?;
        let crop = shots.crop;
        let within = rect.left >= crop.left
            && rect.top >= crop.top
            && rect.right <= crop.right
            && rect.bottom <= crop.bottom;
        if within {
            return Some(rect);
        }
        let Crop {
            left,
            top,
            right,
            bottom,
        } = rect;
        let words = Words::new(
            format!("edges at {left}, {top}, {right} and {bottom}"),
            format!(
                "edges within crop_px: {}, {}, {} and {}",
                crop.left, crop.top, crop.right, crop.bottom
            ),
            "choose a place on the sheet, or correct crop_px",
        );
        self.report.fault(&trail, words);
        None
    }

    /// `Some(None)` for bare paper.
    fn medium(&mut self, swatch: &RawSwatch, trail: &Trail) -> Option<Option<MediumId>> {
        let name = swatch.medium.0.as_str();
        if name == BARE_PAPER {
            return Some(None);
        }
        let drawn = |id: &MediumId| id.medium().kind == MediumKind::Drawn;
        let words = || {
            let names = MediumId::all().filter(drawn).map(MediumId::name);
            names.chain([BARE_PAPER])
        };
        let found = name.parse::<MediumId>().ok().filter(drawn);
        if found.is_none() {
            let remedy = did_you_mean(name, words(), "write one of these words");
            let words = Words::new(quote(name), quoted_list(words()), remedy);
            self.report.fault(&trail.key("medium"), words);
        }
        found.map(Some)
    }
}

fn relief(raw: Option<&RawRelief>) -> Relief {
    let usual = Relief::default();
    let Some(raw) = raw else {
        return usual;
    };
    Relief {
        split_mm: raw.split_mm.map_or(usual.split_mm, |mm| mm.0),
        filter: raw.filter.unwrap_or_default(),
        against_outliers: raw.against_outliers.unwrap_or_default(),
        integrate: raw.integrate.unwrap_or_default(),
        known_range_um: raw.known_range_um.map(|um| um.0),
    }
}

fn point(px: [PixelPx; 2]) -> DVec2 {
    DVec2::from(px.map(|px| px.0))
}
