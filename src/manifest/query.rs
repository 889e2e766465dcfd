//! What others ask of an exhibit.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::{
    decode::{Brief, Pattern},
    document::{self, Document, Words},
    exhibit::{
        Band, Camera, Drawing, Exhibit, HeightMap, MapFile, MediaContent, MediaMap, Over, Overlay,
        OverlayKind, Scene, ShowThrough, Side, SideName, SidePatch, State, Surface, Wording,
    },
    fault::{Fault, Faults, Severity, quote},
    raw::{lamp::RawLampKind, values::FilePath},
    validate::{PICTURE, map_words},
};
use crate::{
    maps::{self, ColourEncoding},
    units::Degrees,
};

/// How much wider than the sheet the view of the whole sheet is.
const MARGIN: f64 = 1.08;

impl Exhibit {
    /// The index and the scene with this id.
    pub fn scene(&self, id: &str) -> Option<(usize, &Scene)> {
        self.scenes
            .iter()
            .enumerate()
            .find(|(_, scene)| scene.id == id)
    }

    /// The index and the drawing with this id.
    pub fn drawing(&self, id: &str) -> Option<(usize, &Drawing)> {
        self.drawings
            .iter()
            .enumerate()
            .find(|(_, drawing)| drawing.id == id)
    }

    /// The drawing of a scene of this exhibit.
    pub fn drawing_of(&self, scene: &Scene) -> &Drawing {
        &self.drawings[scene.drawing]
    }

    /// A text in `language`, or as near to it as there is one: the same language of another
    /// region, then the exhibit's languages in their order, then any.
    pub fn text<'w>(&self, wording: &'w Wording, language: &str) -> Option<&'w str> {
        wording.in_language(language, &self.languages)
    }

    /// Every picture of the exhibit.
    pub fn maps(&self) -> impl Iterator<Item = &MapFile> {
        self.drawings.iter().flat_map(Drawing::maps)
    }

    /// The files that the lamps of a scene are read from: photometric ones, and spectra.
    pub fn lamp_files(&self, scene: &Scene) -> Vec<PathBuf> {
        let lamps = scene.lamps.iter().map(|lamp| &self.lamps[*lamp]);
        let written = lamps.filter_map(|lamp| lamp.written.as_deref());
        let files = written.flat_map(|lamp| {
            let photometry = match &lamp.kind {
                RawLampKind::Ies(ies) => Some(&ies.file),
                _ => None,
            };
            let spectrum = match &lamp.common.spectrum {
                Some(Brief::Full(spectrum)) => spectrum.file.as_ref(),
                _ => None,
            };
            photometry.into_iter().chain(spectrum)
        });
        files.map(|file| self.folder.join(file.as_str())).collect()
    }

    /// [`verify_files`](Self::verify_files) of these pictures.
    ///
    /// # Errors
    /// As there.
    pub fn verify<'m>(
        &self,
        maps: impl IntoIterator<Item = &'m MapFile>,
    ) -> Result<Vec<Fault>, Faults> {
        self.verify_files(maps.into_iter().map(|map| map.path.as_path()))
    }

    /// Decodes whole pictures, which finds truncated and damaged ones. Reading an exhibit looks
    /// at their headers only. Returns warnings of pixels that will not be shown as they are.
    ///
    /// # Errors
    /// All faults, each at the place in the manifest that names the picture.
    pub fn verify_files<'p>(
        &self,
        files: impl IntoIterator<Item = &'p Path>,
    ) -> Result<Vec<Fault>, Faults> {
        let mut paths: Vec<&Path> = files.into_iter().collect();
        paths.sort();
        paths.dedup();
        let (mut warnings, mut faults) = (Vec::new(), Vec::new());
        for path in paths {
            match self.verify_file(path) {
                Ok(all) => {
                    let placed = |words| self.placed(path, Severity::Warning, words);
                    warnings.extend(all.into_iter().map(placed));
                }
                Err(error) => faults.push(self.map_fault(path, &error)),
            }
        }
        match Faults::new(faults) {
            Some(faults) => Err(faults),
            None => Ok(warnings),
        }
    }

    /// What to warn of in a picture.
    fn verify_file(&self, path: &Path) -> Result<Vec<Words>, maps::MapError> {
        let name = self.name_of(path);
        let mut warnings = Vec::new();
        let mut missing = None;
        let encodings = self.drawings.iter().flat_map(Drawing::colour_maps);
        for (_, encoding) in encodings.filter(|(file, _)| file.path == path) {
            missing = Some(maps::verify_colour(path, encoding)?);
        }
        let legends = self.drawings.iter().flat_map(Drawing::legends);
        for (_, legend) in legends.filter(|(file, _)| file.path == path) {
            let (found, unlisted) = maps::verify_legend(path, &legend)?;
            missing = Some(found);
            warnings.extend(unlisted_words(&name, &unlisted, &legend));
        }
        let missing = match missing {
            Some(missing) => missing,
            None => maps::verify(path)?,
        };
        warnings.extend(missing_words(&name, &missing));
        Ok(warnings)
    }

    /// A file's name as the manifest gives it.
    fn name_of(&self, path: &Path) -> String {
        let name = path.strip_prefix(&self.folder).unwrap_or(path);
        name.to_string_lossy().into_owned()
    }

    /// The fault for a picture of the exhibit that could not be loaded, at the place in the
    /// manifest that first names it.
    pub fn map_fault(&self, path: &Path, error: &maps::MapError) -> Fault {
        let words = map_words(&self.name_of(path), error, PICTURE);
        self.placed(path, Severity::Error, words)
    }

    /// What is to be said of a picture, at the place in the manifest that first names it.
    fn placed(&self, path: &Path, severity: Severity, words: Words) -> Fault {
        let named = document::read_text(&self.manifest).ok().and_then(|text| {
            let document = Document::parse(&self.manifest, &text).ok()?;
            let same = |text: &str| {
                FilePath::from_text(text)
                    .is_some_and(|file| self.folder.join(file.as_str()) == path)
            };
            let trail = document.find_text(same)?;
            Some(document.fault(&trail, document::At::Value, severity, words.clone()))
        });
        // The manifest may have changed since it was read.
        named.unwrap_or_else(|| Fault {
            severity,
            ..words.of_file(&self.manifest)
        })
    }
}

impl Drawing {
    /// The index and the state with this id.
    pub fn state(&self, id: &str) -> Option<(usize, &State)> {
        self.states
            .iter()
            .enumerate()
            .find(|(_, state)| state.id == id)
    }

    /// The index and the overlay with this id.
    pub fn overlay(&self, id: &str) -> Option<(usize, &Overlay)> {
        self.overlays
            .iter()
            .enumerate()
            .find(|(_, overlay)| overlay.id == id)
    }

    /// A side with what the state, by its index, replaces on it; `None` is bare paper.
    pub fn side_in_state(&self, side: SideName, state: Option<usize>) -> Option<Side> {
        let own = match side {
            SideName::Recto => Some(&self.recto),
            SideName::Verso => self.verso.as_ref(),
        };
        let patch = state
            .and_then(|index| self.states.get(index))
            .map(|state| match side {
                SideName::Recto => &state.recto,
                SideName::Verso => &state.verso,
            });
        match (own, patch) {
            (Some(own), Some(patch)) => Some(own.clone().replaced(patch)),
            (Some(own), None) => Some(own.clone()),
            (None, Some(patch)) => Some(Side {
                albedo: patch.albedo.clone()?,
                normal: patch.normal.clone(),
                height: patch.height.clone(),
                roughness: patch.roughness.clone(),
                media: patch.media.clone().unwrap_or_default(),
            }),
            (None, None) => None,
        }
    }

    /// What lay on the other side of `side` when the picture was made that `side` has in a state, by
    /// its index. A state that replaces the picture of one side alone leaves that of the other as it
    /// was photographed before.
    pub fn photographed_over(&self, side: SideName, state: Option<usize>) -> Over<'_> {
        if self.paper.show_through == ShowThrough::Modelled {
            return Over::Nothing;
        }
        let Some(state) = state.and_then(|index| self.states.get(index)) else {
            return Over::Same;
        };
        let (here, there, before) = match side {
            SideName::Recto => (&state.recto, &state.verso, self.verso.as_ref()),
            SideName::Verso => (&state.verso, &state.recto, Some(&self.recto)),
        };
        match (&here.albedo, &there.albedo, before) {
            (None, Some(_), None) => Over::Nothing,
            (None, Some(now), Some(before)) if *now != before.albedo => Over::Other(&before.albedo),
            _ => Over::Same,
        }
    }

    /// The overlays that the manifest names as such, without what can be shown of stacks.
    pub fn own_overlays(&self) -> impl Iterator<Item = &Overlay> {
        let own = |overlay: &&Overlay| !matches!(overlay.kind, OverlayKind::Bands(_));
        self.overlays.iter().filter(own)
    }

    /// The bands of every stack.
    pub fn bands(&self) -> impl Iterator<Item = &Band> {
        self.stacks.iter().flat_map(|stack| &stack.bands)
    }

    /// Every picture of the drawing.
    pub fn maps(&self) -> impl Iterator<Item = &MapFile> {
        let surface = match &self.surface {
            Surface::Height(HeightMap { file, .. }) => Some(file),
            Surface::Flat | Surface::Gltf(_) => None,
        };
        let sides = [Some(&self.recto), self.verso.as_ref()]
            .into_iter()
            .flatten();
        let patches = self
            .states
            .iter()
            .flat_map(|state| [&state.recto, &state.verso]);
        self.outline
            .iter()
            .chain(surface)
            .chain(sides.flat_map(Side::maps))
            .chain(&self.transmission)
            .chain(patches.flat_map(SidePatch::maps))
            .chain(self.own_overlays().map(|overlay| &overlay.file))
            .chain(self.bands().map(|band| &band.map.file))
    }
}

impl Drawing {
    /// The pictures whose colours are meant as such, and how they are encoded.
    pub(crate) fn colour_maps(&self) -> impl Iterator<Item = (&MapFile, ColourEncoding)> {
        let sides = [Some(&self.recto), self.verso.as_ref()]
            .into_iter()
            .flatten();
        let patches = self
            .states
            .iter()
            .flat_map(|state| [&state.recto, &state.verso]);
        let pictures = self
            .overlays
            .iter()
            .filter_map(|overlay| match overlay.kind {
                OverlayKind::Picture(encoding) => Some((&overlay.file, encoding)),
                OverlayKind::Categorical(_)
                | OverlayKind::Continuous { .. }
                | OverlayKind::Bands(_) => None,
            });
        sides
            .map(|side| &side.albedo)
            .chain(patches.filter_map(|patch| patch.albedo.as_ref()))
            .chain(self.bands().map(|band| &band.map))
            .map(|map| (&map.file, map.encoding))
            .chain(pictures)
    }
}

impl Drawing {
    /// The media maps of both sides in every state.
    pub fn media_maps(&self) -> impl Iterator<Item = &MediaMap> {
        let sides = [Some(&self.recto), self.verso.as_ref()]
            .into_iter()
            .flatten()
            .flat_map(|side| &side.media);
        let patches = self
            .states
            .iter()
            .flat_map(|state| [&state.recto, &state.verso])
            .flat_map(|patch| patch.media.iter().flatten());
        sides.chain(patches)
    }

    /// The pictures whose colours stand for something, with those that their legends name.
    fn legends(&self) -> impl Iterator<Item = (&MapFile, Vec<[u8; 3]>)> {
        let media = self.media_maps().filter_map(|map| match &map.content {
            MediaContent::Legend(legend) => {
                Some((&map.file, legend.iter().map(|entry| entry.0).collect()))
            }
            MediaContent::Weights(_) => None,
        });
        let overlays = self
            .overlays
            .iter()
            .filter_map(|overlay| match &overlay.kind {
                OverlayKind::Categorical(legend) => {
                    let colours = legend.iter().map(|entry| entry.colour).collect();
                    Some((&overlay.file, colours))
                }
                OverlayKind::Continuous { .. }
                | OverlayKind::Picture(_)
                | OverlayKind::Bands(_) => None,
            });
        media.chain(overlays)
    }
}

/// What to say of colours, the commonest first, that a legend does not name. White and black
/// ones are taken for the ground that the others lie on.
/// Pixels without a number.
fn missing_words(name: &str, missing: &maps::Missing) -> Option<Words> {
    let mut places: Vec<String> = missing
        .places
        .iter()
        .map(|[column, row]| format!("({column}, {row})"))
        .collect();
    let more = missing.count - places.len() as u64;
    if more > 0 {
        places.push(format!("{more} more"));
    }
    (missing.count > 0).then(|| {
        let plural = if missing.count == 1 { "" } else { "s" };
        Words::new(
            format!(
                "{} with NaN or infinity in {} pixel{plural} (column, row from 0 at the top \
                 left): {}",
                quote(name),
                missing.count,
                places.join(", ")
            ),
            "numbers",
            "export it again without NaN and infinities; such pixels are missing and are shown \
             as their nearest neighbours",
        )
    })
}

fn unlisted_words(name: &str, unlisted: &[([u8; 3], u64)], legend: &[[u8; 3]]) -> Option<Words> {
    /// How many colours are named.
    const MOST: usize = 3;
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    let is_ground = |colour: &[u8; 3]| matches!(colour, [0, 0, 0] | [255, 255, 255]);
    let mut colours: Vec<String> = unlisted
        .iter()
        .filter(|(colour, _)| !is_ground(colour))
        .map(|(colour, count)| match count {
            1 => format!("{} (1 pixel)", hex(*colour)),
            count => format!("{} ({count} pixels)", hex(*colour)),
        })
        .collect();
    let more = colours.len().saturating_sub(MOST);
    colours.truncate(MOST);
    if more > 0 {
        colours.push(format!("{more} more"));
    }
    (!colours.is_empty()).then(|| {
        let allowed: Vec<String> = legend.iter().copied().map(hex).collect();
        Words::new(
            format!(
                "{} with colours that its legend does not name: {}",
                quote(name),
                colours.join(", ")
            ),
            allowed.join(", "),
            "correct the colours or add them to the legend; such pixels count as bare",
        )
    })
}

impl Side {
    /// Every picture of the side.
    pub fn maps(&self) -> impl Iterator<Item = &MapFile> {
        std::iter::once(&self.albedo.file)
            .chain(self.normal.iter().map(|map| &map.file))
            .chain(self.height.iter().map(|map| &map.file))
            .chain(self.roughness.iter().map(|map| &map.file))
            .chain(self.media.iter().map(|map| &map.file))
    }

    fn replaced(self, patch: &SidePatch) -> Self {
        let patch = patch.clone();
        Self {
            albedo: patch.albedo.unwrap_or(self.albedo),
            normal: patch.normal.or(self.normal),
            height: patch.height.or(self.height),
            roughness: patch.roughness.or(self.roughness),
            media: patch.media.unwrap_or(self.media),
        }
    }
}

impl SidePatch {
    /// Every picture that it replaces one by.
    pub fn maps(&self) -> impl Iterator<Item = &MapFile> {
        self.albedo
            .iter()
            .map(|map| &map.file)
            .chain(self.normal.iter().map(|map| &map.file))
            .chain(self.height.iter().map(|map| &map.file))
            .chain(self.roughness.iter().map(|map| &map.file))
            .chain(self.media.iter().flatten().map(|map| &map.file))
    }
}

impl Wording {
    /// The text in `language` (a BCP 47 tag), or as near to it as there is one: without its last
    /// subtags, in another region, then in each of `fallbacks`, then in any language. `None` if
    /// there is no text at all.
    pub fn in_language(&self, language: &str, fallbacks: &[String]) -> Option<&str> {
        std::iter::once(language)
            .chain(fallbacks.iter().map(String::as_str))
            .find_map(|language| self.near(language))
            .or_else(|| self.0.values().next().map(String::as_str))
    }

    fn near(&self, language: &str) -> Option<&str> {
        let mut tag = language;
        loop {
            let exact = self.0.iter().find(|(own, _)| own.eq_ignore_ascii_case(tag));
            if let Some((_, text)) = exact {
                return Some(text);
            }
            match tag.rfind('-') {
                Some(hyphen) => tag = &tag[..hyphen],
                None => break,
            }
        }
        let primary = |tag: &str| {
            tag.split('-')
                .next()
                .unwrap_or_default()
                .to_ascii_lowercase()
        };
        let relative = self.0.iter().find(|(own, _)| primary(own) == primary(tag));
        relative.map(|(_, text)| text.as_str())
    }
}

impl Camera {
    /// From straight above onto the whole sheet of `size_mm`, somewhat wider than it.
    pub fn whole_sheet(size_mm: DVec2) -> Self {
        Self {
            centre_mm: size_mm / 2.0,
            width_mm: size_mm.x * MARGIN,
            tilt: Degrees(0.0),
            turn: Degrees(0.0),
            distance_mm: None,
        }
    }

    /// The same camera for a picture of `aspect` (width by height), where one that shows the
    /// whole sheet goes on showing the whole of it; others keep their width.
    pub fn fitted(self, size_mm: DVec2, aspect: f64) -> Self {
        if self != Self::whole_sheet(size_mm) {
            return self;
        }
        Self {
            width_mm: self.width_mm.max(size_mm.y * MARGIN * aspect),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wording(texts: &[(&str, &str)]) -> Wording {
        Wording(
            texts
                .iter()
                .map(|(tag, text)| ((*tag).into(), (*text).into()))
                .collect(),
        )
    }

    #[test]
    fn a_text_is_found_in_the_nearest_language() {
        let wording = wording(&[("it", "foglio"), ("pt-BR", "folha"), ("en", "sheet")]);
        let fallbacks = ["en".to_owned()];
        assert_eq!(wording.in_language("it-CH", &fallbacks), Some("foglio"));
        assert_eq!(wording.in_language("pt-PT", &fallbacks), Some("folha"));
        assert_eq!(wording.in_language("IT", &fallbacks), Some("foglio"));
        assert_eq!(wording.in_language("ja", &fallbacks), Some("sheet"));
        assert_eq!(wording.in_language("ja", &[]), Some("sheet"));
        assert_eq!(Wording::default().in_language("en", &fallbacks), None);
    }

    #[test]
    fn the_whole_of_a_tall_sheet_is_seen_in_a_wide_picture() {
        let size = DVec2::new(200.0, 300.0);
        let whole = Camera::whole_sheet(size);
        assert_eq!(whole.fitted(size, 0.5).width_mm, 200.0 * MARGIN);
        assert_eq!(whole.fitted(size, 2.0).width_mm, 600.0 * MARGIN);
        let closer = Camera {
            width_mm: 50.0,
            ..whole
        };
        assert_eq!(closer.fitted(size, 2.0), closer);
    }
}
