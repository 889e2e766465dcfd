//! Stacks of bands: every band with its wavelength, all of one size or put in their places, and
//! views that name bands that are there.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{
    super::{
        decode::{Dictionary, List, Pattern},
        document::{Trail, Words},
        exhibit::{Band, BandMix, BandView, ColourMap, Overlay, SideName, Source, Stack},
        raw::{
            RawBand, RawDifference, RawDrawing, RawFalseColour, RawStack,
            stack::MAX_BANDS,
            values::{BandKey, Id, Weight},
        },
    },
    Validator,
    placement::{Lie, Placement},
    side::Named,
};

/// Difference of reflectance at the ends of a scale that does not say.
const USUAL_FULL: f64 = 0.5;

/// The first band that lies as the stack says: all others share its size and place.
struct First {
    pixels: [u32; 2],
    /// `None` where it is at fault.
    lie: Option<Lie>,
    path: String,
}

impl Validator<'_, '_> {
    /// A stack, and what can be shown of it: its bands in the manifest's order, false colours,
    /// differences.
    pub(super) fn stack(
        &mut self,
        raw: &RawStack,
        trail: &Trail,
        sheet_mm: DVec2,
    ) -> Option<(Stack, Vec<Overlay>)> {
        let trail_of_stack = trail;
        self.refuse_flip(raw.register.as_ref(), trail);
        let title = self.wording(raw.title.as_ref(), &trail.key("title"));
        let bands_trail = trail.key("bands");
        let mut bands: Vec<Option<Band>> = Vec::new();
        let mut first = None;
        for (i, band) in raw.bands.iter() {
            let trail = bands_trail.index(i);
            let known = raw.bands.iter().take_while(|(k, _)| *k < i);
            let nm = band.wavelength_nm.0;
            if let Some((k, _)) = known.into_iter().find(|(_, b)| b.wavelength_nm.0 == nm) {
                let words = Words::new(
                    format!("{nm} nm, which {} has already", bands_trail.index(k)),
                    "each wavelength once",
                    "remove one of the two, or correct it",
                );
                self.report.fault(&trail.key("wavelength_nm"), words);
            }
            bands.push(self.band(raw, band, [trail_of_stack, &trail], sheet_mm, &mut first));
        }
        if raw.bands.has_holes() {
            return None;
        }
        let mut bands = bands.into_iter().collect::<Option<Vec<Band>>>()?;
        bands.sort_by(|a, b| a.wavelength_nm.total_cmp(&b.wavelength_nm));
        let stack = Stack {
            id: raw.id.as_str().to_owned(),
            title,
            side: raw.side.unwrap_or_default(),
            bands,
        };
        // In the order of [`view_names`].
        let mut shown: Vec<Option<Overlay>> = raw
            .bands
            .iter()
            .map(|(_, band)| {
                let name = band.wavelength_nm.0.to_string();
                stack
                    .of_each_band()
                    .find(|overlay| overlay.id.split_once('/').is_some_and(|(_, n)| n == name))
            })
            .collect();
        for (i, raw) in raw.false_colour.iter().flat_map(List::iter) {
            let trail = trail.key("false_colour").index(i);
            shown.push(self.false_colour(raw, &stack, &trail));
        }
        for (i, raw) in raw.difference.iter().flat_map(List::iter) {
            let trail = trail.key("difference").index(i);
            shown.push(self.difference(raw, &stack, &trail));
        }
        Some((stack, shown.into_iter().collect::<Option<_>>()?))
    }

    fn band(
        &mut self,
        stack: &RawStack,
        raw: &RawBand,
        [stack_trail, trail]: [&Trail; 2],
        sheet_mm: DVec2,
        first: &mut Option<First>,
    ) -> Option<Band> {
        self.refuse_flip(raw.register.as_ref(), trail);
        let source = raw.source.or(stack.source);
        let named = Named::of_table(&raw.file, source, trail);
        let source = source.unwrap_or(Source::Assumed);
        let file = if raw.register.is_some() || raw.control_points.is_some() {
            let placement = Placement {
                register: raw.register.as_ref(),
                control_points: raw.control_points.as_ref(),
                fit: raw.fit,
                trail,
            };
            self.map_file(&named, placement, sheet_mm, source)?.0
        } else {
            // They lie alike, so that pixels of one are pixels of another.
            let (path, header) = self.picture(named.file, &named.trail)?;
            if first.is_none() {
                let placement = Placement {
                    register: stack.register.as_ref(),
                    control_points: stack.control_points.as_ref(),
                    fit: stack.fit,
                    trail: stack_trail,
                };
                *first = Some(First {
                    pixels: header.size,
                    lie: self.lie(placement, sheet_mm, header.size, &named.trail, &path),
                    path: named.trail.to_string(),
                });
            }
            let first = first.as_ref()?;
            if header.size != first.pixels {
                let [width, height] = header.size;
                let words = Words::new(
                    format!("a picture of {width} × {height} pixels"),
                    format!(
                        "{} × {} pixels, as {} has",
                        first.pixels[0], first.pixels[1], first.path
                    ),
                    "bring the bands to one size, or register this one",
                );
                self.report.fault(&named.trail, words);
                return None;
            }
            first.lie.clone()?.of(path, source)
        };
        Some(Band {
            wavelength_nm: raw.wavelength_nm.0,
            map: ColourMap {
                file,
                encoding: stack.encoding.unwrap_or_default(),
            },
        })
    }

    fn false_colour(
        &mut self,
        raw: &RawFalseColour,
        stack: &Stack,
        trail: &Trail,
    ) -> Option<Overlay> {
        let mut weights: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        let mut complete = true;
        let channels: [(&str, &Dictionary<BandKey, Weight, MAX_BANDS>); 3] = [
            ("red", &raw.red),
            ("green", &raw.green),
            ("blue", &raw.blue),
        ];
        for (c, (key, channel)) in channels.into_iter().enumerate() {
            for (band, weight) in &channel.0 {
                let place = trail.key(key).key(band.as_str());
                let nm = band.as_str().parse().unwrap_or(f64::NAN);
                match self.known_band(nm, stack, &place) {
                    Some(index) => weights.entry(index).or_default()[c] += weight.0,
                    None => complete = false,
                }
            }
        }
        let title = self.wording(raw.title.as_ref(), &trail.key("title"));
        let view = BandView {
            bands: weights.keys().map(|i| stack.bands[*i].clone()).collect(),
            mix: BandMix::Colour(weights.into_values().collect()),
        };
        complete.then(|| stack.shown_as(raw.id.as_str(), title, view))
    }

    fn difference(&mut self, raw: &RawDifference, stack: &Stack, trail: &Trail) -> Option<Overlay> {
        let of = trail.key("of");
        let [first, second] = raw.of.map(|nm| nm.0);
        let full = raw.full.map_or(USUAL_FULL, |full| full.0);
        if first == second {
            let words = Words::new(
                format!("{first} nm twice"),
                "two bands that differ",
                "name another band",
            );
            self.report.fault(&of, words);
        }
        if full == 0.0 {
            let words = Words::new(
                "0",
                "a difference above 0",
                "write what the ends of the scale mean",
            );
            self.report.fault(&trail.key("full"), words);
        }
        let bands = [
            self.known_band(first, stack, &of.index(0)),
            self.known_band(second, stack, &of.index(1)),
        ];
        let title = self.wording(raw.title.as_ref(), &trail.key("title"));
        let [Some(first), Some(second)] = bands else {
            return None;
        };
        let view = BandView {
            bands: [first, second].map(|i| stack.bands[i].clone()).to_vec(),
            mix: BandMix::Difference { full },
        };
        Some(stack.shown_as(raw.id.as_str(), title, view))
    }

    /// Reports every view of a stack that is called as an earlier one, or as a band.
    pub(super) fn unique_views(&mut self, raw: &RawDrawing, drawing: &Trail) {
        for (i, stack) in raw.stack.iter().flat_map(List::iter) {
            let trail = drawing.key("stack").index(i);
            let bands = stack.bands.iter();
            let mut taken: Vec<String> =
                bands.map(|(_, b)| b.wavelength_nm.0.to_string()).collect();
            let colours = stack.false_colour.iter().flat_map(List::iter);
            let differences = stack.difference.iter().flat_map(List::iter);
            let views = colours
                .map(|(k, view)| ("false_colour", k, &view.id))
                .chain(differences.map(|(k, view)| ("difference", k, &view.id)));
            for (key, k, id) in views {
                if taken.iter().any(|taken| taken == id.as_str()) {
                    let words = Words::new(
                        format!("the id \"{}\" a second time in one stack", id.as_str()),
                        "ids that differ, and no wavelength of a band",
                        "rename one of the two",
                    );
                    self.report.fault(&trail.key(key).index(k).key("id"), words);
                }
                taken.push(id.as_str().to_owned());
            }
        }
    }

    fn known_band(&mut self, nm: f64, stack: &Stack, trail: &Trail) -> Option<usize> {
        let found = stack.bands.iter().position(|band| band.wavelength_nm == nm);
        if found.is_none() {
            let bands: Vec<String> = stack.bands.iter().map(Band::name).collect();
            let words = Words::new(
                format!("{nm} nm, a band that the stack has not"),
                format!("one of {} nm", bands.join(", ")),
                "correct the wavelength or add the band",
            );
            self.report.fault(trail, words);
        }
        found
    }
}

/// The names, and the side, of what [`Validator::stack`] shows of a stack, in its order.
pub(super) fn view_names(raw: &RawStack) -> (Vec<String>, SideName) {
    let bands = raw
        .bands
        .iter()
        .map(|(_, band)| band.wavelength_nm.0.to_string());
    let id = |id: &Id| id.as_str().to_owned();
    let colours = raw.false_colour.iter().flat_map(List::iter);
    let differences = raw.difference.iter().flat_map(List::iter);
    let views = colours
        .map(|(_, view)| id(&view.id))
        .chain(differences.map(|(_, view)| id(&view.id)));
    let named = |name: String| format!("{}/{name}", raw.id.as_str());
    let names = bands.chain(views).map(named).collect();
    (names, raw.side.unwrap_or_default())
}

/// Whether elements of it were left out because they are at fault.
pub(super) fn has_holes(raw: &RawStack) -> bool {
    raw.bands.has_holes()
        || raw.false_colour.as_ref().is_some_and(List::has_holes)
        || raw.difference.as_ref().is_some_and(List::has_holes)
}
