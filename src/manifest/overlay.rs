//! What lies over a side in a scene, and how its files become one picture.

use std::{collections::BTreeSet, path::Path};

use super::{
    document::Words,
    exhibit::{
        Band, BandMix, BandView, Drawing, LegendEntry, Overlay, OverlayKind, Scene, Stack, Wording,
    },
    fault::{did_you_mean, quote, quoted_list},
};
use crate::maps::{self, BandPicture, DIVERGING, MapError, Pyramid};

impl Scene {
    /// The overlays that are seen, from the lowest, each with its opacity and with no more
    /// categories than are shown.
    pub fn laid(&self, drawing: &Drawing) -> Vec<(Overlay, f64)> {
        let seen = self.overlays.iter().filter(|(_, opacity)| *opacity > 0.0);
        seen.map(|&(index, opacity)| (self.laid_as(drawing, index), opacity))
            .collect()
    }

    fn laid_as(&self, drawing: &Drawing, index: usize) -> Overlay {
        let mut overlay = drawing.overlays[index].clone();
        if let (OverlayKind::Categorical(legend), Some(shown)) =
            (&mut overlay.kind, self.categories.get(&index))
        {
            let entries = shown.iter().filter_map(|entry| legend.get(*entry));
            *legend = entries.cloned().collect();
        }
        overlay
    }
}

impl LegendEntry {
    /// The name by which scenes switch it.
    pub fn name(&self) -> &str {
        let label = || self.label.0.values().next().map(String::as_str);
        self.id.as_deref().or_else(label).unwrap_or_default()
    }

    /// Whether `name` is its id, or, where it has none, its label in any language.
    pub fn is_called(&self, name: &str) -> bool {
        match &self.id {
            Some(id) => id == name,
            None => self.label.0.values().any(|label| label == name),
        }
    }
}

/// The entries of a legend that these names call, in its order, and what is wrong with which name.
pub fn chosen<'n>(
    legend: &[LegendEntry],
    names: impl Iterator<Item = (usize, &'n str)>,
) -> (Vec<usize>, Vec<(usize, Words)>) {
    let mut entries = BTreeSet::new();
    let mut faults = Vec::new();
    let mut known: Vec<&str> = Vec::new();
    for (i, name) in names {
        if known.contains(&name) {
            let words = Words::new(
                format!("the category {} a second time", quote(name)),
                "each category once",
                "remove one of the two",
            );
            faults.push((i, words));
            continue;
        }
        known.push(name);
        match legend.iter().position(|entry| entry.is_called(name)) {
            // By another name, perhaps in another language, it may be there.
            Some(entry) => drop(entries.insert(entry)),
            None => faults.push((i, no_category(legend, name))),
        }
    }
    (entries.into_iter().collect(), faults)
}

fn no_category(legend: &[LegendEntry], name: &str) -> Words {
    let names = || legend.iter().map(LegendEntry::name);
    let found = format!("the category {}", quote(name));
    if legend.is_empty() {
        let allowed = "categories of an overlay that has some";
        return Words::new(found, allowed, "leave categories out");
    }
    let remedy = did_you_mean(name, names(), "write one of these");
    Words::new(found, quoted_list(names()), remedy)
}

impl Overlay {
    /// Decodes it as it is shown.
    ///
    /// # Errors
    /// Where a file cannot be read, or is not what it is read for.
    pub fn load(&self) -> Result<Pyramid, MapError> {
        match &self.kind {
            OverlayKind::Categorical(legend) => {
                let colours: Vec<[u8; 3]> = legend.iter().map(|entry| entry.colour).collect();
                maps::load_overlay_categorical(&self.file, &colours).map(|map| map.pyramid)
            }
            OverlayKind::Continuous { colour_map, .. } => {
                maps::load_overlay_continuous(&self.file, *colour_map)
            }
            OverlayKind::Picture(encoding) => maps::load_overlay_picture(&self.file, *encoding),
            OverlayKind::Bands(view) => {
                let pictures: Vec<BandPicture<'_>> = view.bands.iter().map(Band::picture).collect();
                match &view.mix {
                    BandMix::Colour(weights) => maps::load_bands_as_colour(&pictures, weights),
                    BandMix::Difference { full } => {
                        maps::load_bands_as_difference(&pictures, *full, DIVERGING)
                    }
                }
            }
        }
    }
}

impl Overlay {
    /// Every file that it is made of.
    pub fn files(&self) -> Vec<&Path> {
        match &self.kind {
            OverlayKind::Bands(view) => view
                .bands
                .iter()
                .map(|b| b.map.file.path.as_path())
                .collect(),
            _ => vec![&self.file.path],
        }
    }
}

impl OverlayKind {
    /// Whether the lamps light it as they light the paper: a photograph in another band is
    /// paper, a category or a value is a sign.
    pub fn is_lit(&self) -> bool {
        match self {
            Self::Picture(_) => true,
            Self::Bands(view) => matches!(view.mix, BandMix::Colour(_)),
            Self::Categorical(_) | Self::Continuous { .. } => false,
        }
    }
}

impl Band {
    fn picture(&self) -> BandPicture<'_> {
        BandPicture {
            file: (&self.map.file).into(),
            encoding: self.map.encoding,
            uv_from_side: self.map.file.uv_from_side,
        }
    }

    /// As it is written behind the id of its stack.
    pub fn name(&self) -> String {
        self.wavelength_nm.to_string()
    }
}

impl Stack {
    /// The band of this wavelength.
    pub fn band(&self, wavelength_nm: f64) -> Option<&Band> {
        self.bands
            .iter()
            .find(|band| band.wavelength_nm == wavelength_nm)
    }

    /// Each band as something to be laid over the side.
    pub fn of_each_band(&self) -> impl Iterator<Item = Overlay> {
        self.bands.iter().map(|band| {
            let said = |title: &str| format!("{title}, {} nm", band.wavelength_nm);
            let title = self.title.0.iter();
            let view = BandView {
                bands: vec![band.clone()],
                mix: BandMix::Colour(vec![[1.0; 3]]),
            };
            let title = Wording(title.map(|(l, title)| (l.clone(), said(title))).collect());
            self.shown_as(&band.name(), title, view)
        })
    }

    /// A view of it as something to be laid over the side.
    pub fn shown_as(&self, name: &str, title: Wording, view: BandView) -> Overlay {
        Overlay {
            id: format!("{}/{name}", self.id),
            title,
            side: self.side,
            file: view.bands[0].map.file.clone(),
            kind: OverlayKind::Bands(view),
        }
    }
}

impl BandView {
    /// What it shows, in a few words: which bands as which colours.
    pub fn words(&self) -> String {
        let nm = |band: &Band| format!("{} nm", band.wavelength_nm);
        match &self.mix {
            BandMix::Difference { .. } => {
                let [first, second] = [self.bands.first(), self.bands.last()]
                    .map(|band| band.map(nm).unwrap_or_default());
                format!("reflectance at {first} − {second}")
            }
            BandMix::Colour(_) if self.bands.len() == 1 => {
                format!("reflectance at {}", nm(&self.bands[0]))
            }
            BandMix::Colour(weights) => {
                let channel = |(c, colour): (usize, &str)| {
                    let taken = self.bands.iter().zip(weights);
                    let sum: Vec<String> = taken
                        .filter(|(_, weight)| weight[c] != 0.0)
                        .map(|(band, weight)| match weight[c] {
                            1.0 => nm(band),
                            weight => format!("{weight} × {}", nm(band)),
                        })
                        .collect();
                    format!("{colour} {}", sum.join(" + "))
                };
                let channels = ["red", "green", "blue"].into_iter().enumerate();
                channels.map(channel).collect::<Vec<_>>().join(", ")
            }
        }
    }
}
