//! The maps of one side.

use std::path::Path;

use glam::DVec2;

use super::{
    super::{
        decode::{Brief, List, OneOrMany, Pattern},
        document::{Trail, Words},
        exhibit::{
            ColourMap, HeightMap, MapFile, MediaContent, MediaMap, NormalMap, RoughnessMap,
            SideName, SidePatch, Source,
        },
        raw::{
            RawColourMap, RawHeightMap, RawMediaMap, RawNormalMap, RawPlainMap, RawSide,
            values::FilePath,
        },
    },
    Validator,
    placement::{Lie, Placement},
};
use crate::maps::{Header, MAX_WEIGHTS};

/// A map's file as its key gives it, in short or in full.
pub(super) struct Named<'m> {
    pub file: &'m FilePath,
    pub source: Option<Source>,
    /// Of the file's name.
    pub trail: Trail,
}

impl<'m> Named<'m> {
    pub fn of_table(file: &'m FilePath, source: Option<Source>, table: &Trail) -> Self {
        Self {
            file,
            source,
            trail: table.key("file"),
        }
    }

    fn of<T>(
        map: &'m Brief<FilePath, T>,
        trail: &Trail,
        full: impl FnOnce(&'m T) -> (&'m FilePath, Option<Source>),
    ) -> Self {
        match map {
            Brief::Short(file) => Self {
                file,
                source: None,
                trail: trail.clone(),
            },
            Brief::Full(table) => {
                let (file, source) = full(table);
                Self::of_table(file, source, trail)
            }
        }
    }

    pub fn plain(map: &'m Brief<FilePath, RawPlainMap>, trail: &Trail) -> Self {
        Self::of(map, trail, |table| (&table.file, table.source))
    }
}

/// The maps of one side while they are read: the first decides their size.
struct SideMaps<'v, 'r, 'd, 'p> {
    validator: &'v mut Validator<'r, 'd>,
    placement: Placement<'p>,
    sheet_mm: DVec2,
    source: Source,
    first: Option<First>,
}

/// The map of a side that was read first: all others share its size and place.
struct First {
    /// Of the file.
    pixels: [u32; 2],
    lie: Lie,
    path: String,
}

impl Validator<'_, '_> {
    /// The maps of a side, or those that a state replaces. What is at fault is left out, having
    /// been reported.
    pub(super) fn side(
        &mut self,
        raw: &RawSide,
        trail: &Trail,
        side: SideName,
        in_state: bool,
        sheet_mm: DVec2,
    ) -> SidePatch {
        let placement = Placement {
            register: raw.register.as_ref(),
            control_points: raw.control_points.as_ref(),
            fit: raw.fit,
            trail,
        };
        if side == SideName::Recto || in_state {
            self.refuse_flip(raw.register.as_ref(), trail);
        }
        self.one_way_of_placing(placement);
        if in_state && no_maps(raw) {
            let words = Words::new(
                "no map",
                "albedo, normal, height, roughness, gloss or media",
                "add the maps that this state replaces, or leave the side out",
            );
            self.report.fault(trail, words);
        }
        let mut maps = SideMaps {
            validator: self,
            placement,
            sheet_mm,
            source: raw.source.unwrap_or(Source::Assumed),
            first: None,
        };
        SidePatch {
            albedo: raw
                .albedo
                .as_ref()
                .and_then(|map| maps.albedo(map, &trail.key("albedo"))),
            normal: raw
                .normal
                .as_ref()
                .and_then(|map| maps.normal(map, &trail.key("normal"))),
            height: raw
                .height
                .as_ref()
                .and_then(|map| maps.height(map, &trail.key("height"))),
            roughness: maps.roughness(raw, trail),
            media: raw
                .media
                .as_ref()
                .map(|media| maps.media(media, &trail.key("media"))),
        }
    }

    /// A picture that lies on the sheet.
    pub(super) fn map_file(
        &mut self,
        named: &Named<'_>,
        placement: Placement<'_>,
        sheet_mm: DVec2,
        source: Source,
    ) -> Option<(MapFile, Header)> {
        let (path, header) = self.picture(named.file, &named.trail)?;
        let lie = self.lie(placement, sheet_mm, header.size, &named.trail, &path)?;
        let source = named.source.unwrap_or(source);
        Some((lie.of(path, source), header))
    }

    /// Reports a range whose ends are one.
    pub(super) fn has_extent(&mut self, range: [f64; 2], trail: &Trail) {
        if range[0] == range[1] {
            let words = Words::new(
                format!("{} for black and for white", range[0]),
                "two values that differ",
                "write what black and what white mean",
            );
            self.report.fault(trail, words);
        }
    }

    /// Warns of, or reports, what keeps a colour in a file from being looked up in a legend.
    pub(super) fn exact_colours(&mut self, path: &Path, header: &Header, trail: &Trail) {
        if header.float || header.bits != 8 {
            let words = Words::new(
                format!("a picture of {} bits a channel", header.bits),
                "8 bits a channel, which a legend's colours have",
                "export it with 8 bits",
            );
            self.report.fault(trail, words);
        }
        let extension = path
            .extension()
            .map(|extension| extension.to_ascii_lowercase());
        if extension.is_some_and(|extension| extension == "jpg" || extension == "jpeg") {
            let words = Words::new(
                "a JPEG file, which changes colours at every edge",
                "colours exactly as in the legend",
                "export it as PNG",
            );
            self.report.warn(trail, words);
        }
    }
}

/// Whether a side names no map at all.
pub(super) fn no_maps(raw: &RawSide) -> bool {
    raw.albedo.is_none()
        && raw.normal.is_none()
        && raw.height.is_none()
        && raw.roughness.is_none()
        && raw.gloss.is_none()
        && raw.media.is_none()
}

impl SideMaps<'_, '_, '_, '_> {
    fn map(&mut self, named: &Named<'_>) -> Option<(MapFile, Header)> {
        let Some(first) = &self.first else {
            let (map, header) =
                self.validator
                    .map_file(named, self.placement, self.sheet_mm, self.source)?;
            self.first = Some(First {
                pixels: header.size,
                lie: Lie::from(&map),
                path: named.trail.to_string(),
            });
            return Some((map, header));
        };
        let (path, header) = self.validator.picture(named.file, &named.trail)?;
        if header.size != first.pixels {
            let [width, height] = header.size;
            let words = Words::new(
                format!("a picture of {width} × {height} pixels"),
                format!(
                    "{} × {} pixels, as {} has",
                    first.pixels[0], first.pixels[1], first.path
                ),
                "bring all maps of one side to one size",
            );
            self.validator.report.fault(&named.trail, words);
            return None;
        }
        let source = named.source.unwrap_or(self.source);
        Some((first.lie.clone().of(path, source), header))
    }

    fn albedo(&mut self, raw: &Brief<FilePath, RawColourMap>, trail: &Trail) -> Option<ColourMap> {
        let named = Named::of(raw, trail, |table| (&table.file, table.source));
        let (file, _) = self.map(&named)?;
        let encoding = match raw {
            Brief::Short(_) => None,
            Brief::Full(table) => table.encoding,
        };
        Some(ColourMap {
            file,
            encoding: encoding.unwrap_or_default(),
        })
    }

    fn normal(&mut self, raw: &Brief<FilePath, RawNormalMap>, trail: &Trail) -> Option<NormalMap> {
        let named = Named::of(raw, trail, |table| (&table.file, table.source));
        let (file, header) = self.map(&named)?;
        if header.channels < 3 {
            let words = Words::new(
                "a grey picture",
                "a normal map in RGB",
                "name a grey map of heights as height, with its range_um",
            );
            self.validator.report.fault(&named.trail, words);
        }
        let y = match raw {
            Brief::Short(_) => None,
            Brief::Full(table) => table.y,
        };
        Some(NormalMap {
            file,
            y: y.unwrap_or_default(),
        })
    }

    fn height(&mut self, raw: &RawHeightMap, trail: &Trail) -> Option<HeightMap> {
        let range_um = raw.range_um.map(|um| um.0);
        self.validator.has_extent(range_um, &trail.key("range_um"));
        let (file, _) = self.map(&Named::of_table(&raw.file, raw.source, trail))?;
        Some(HeightMap { file, range_um })
    }

    fn roughness(&mut self, raw: &RawSide, trail: &Trail) -> Option<RoughnessMap> {
        let (map, key, gloss) = match (&raw.roughness, &raw.gloss) {
            (Some(map), _) => (map, "roughness", false),
            (None, Some(map)) => (map, "gloss", true),
            (None, None) => return None,
        };
        let (file, _) = self.map(&Named::plain(map, &trail.key(key)))?;
        Some(RoughnessMap { file, gloss })
    }

    fn media(&mut self, raw: &OneOrMany<RawMediaMap>, trail: &Trail) -> Vec<MediaMap> {
        match raw {
            OneOrMany::One(map) => self.medium(map, trail).into_iter().collect(),
            OneOrMany::Many(maps) => maps
                .iter()
                .filter_map(|(i, map)| self.medium(map, &trail.index(i)))
                .collect(),
        }
    }

    fn medium(&mut self, raw: &RawMediaMap, trail: &Trail) -> Option<MediaMap> {
        let named = Named::of_table(&raw.file, raw.source, trail);
        let content = self.media_content(raw, trail);
        let (file, header) = self.map(&named)?;
        let content = content?;
        match &content {
            MediaContent::Legend(_) => {
                self.validator
                    .exact_colours(&file.path, &header, &named.trail);
            }
            MediaContent::Weights(media) if media.len() > usize::from(header.channels) => {
                let words = Words::new(
                    format!("{} media", media.len()),
                    format!(
                        "at most as many as the picture has channels, which are {}",
                        header.channels
                    ),
                    "name the media in the order of the channels, or split them into several files",
                );
                self.validator.report.fault(&trail.key("weights"), words);
            }
            MediaContent::Weights(_) => {}
        }
        Some(MediaMap { file, content })
    }

    fn media_content(&mut self, raw: &RawMediaMap, trail: &Trail) -> Option<MediaContent> {
        let Some(legend) = &raw.legend else {
            let weights: &List<_, 1, MAX_WEIGHTS> = raw.weights.as_ref()?;
            let trail = trail.key("weights");
            let media: Vec<Option<usize>> = weights
                .iter()
                .map(|(i, name)| self.validator.drawn(&name.0, &trail.index(i)))
                .collect();
            return media
                .into_iter()
                .collect::<Option<_>>()
                .map(MediaContent::Weights);
        };
        let mut entries = Vec::new();
        for (text, name) in &legend.0 {
            let place = trail.key("legend").key(text.as_str());
            let medium = self.validator.drawn(&name.0, &place);
            let colour = crate::colour::parse_hex(text.as_str())?;
            if entries.iter().any(|(earlier, _)| *earlier == colour) {
                let words = Words::new(
                    format!("the colour {} a second time", text.as_str()),
                    "each colour once",
                    "remove one of the two",
                );
                self.validator.report.fault(&place, words);
            }
            entries.push((colour, medium));
        }
        let known = |(colour, medium): ([u8; 3], Option<usize>)| Some((colour, medium?));
        let entries: Option<Vec<_>> = entries.into_iter().map(known).collect();
        entries.map(MediaContent::Legend)
    }
}
