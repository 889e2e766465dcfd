//! Hotspots: regions within their side, bounded by outlines that bound something.

use glam::DVec2;

use super::{
    super::{
        decode::{List, Pattern},
        document::{Trail, Words},
        exhibit::Hotspot,
        hotspot::outline_faults,
        raw::{RawDrawing, RawHotspot},
    },
    Validator,
    names::Names,
};

impl Validator<'_, '_> {
    /// Reports every id that an earlier hotspot of the drawing has already.
    pub(super) fn unique_hotspots(&mut self, drawing: &RawDrawing, trail: &Trail) {
        let hotspots = drawing.hotspot.iter().flat_map(List::iter);
        let ids = hotspots.map(|(i, hotspot)| (i, &hotspot.id));
        self.unique(&Names::new("hotspot of this drawing", ids, false), trail);
    }

    pub(super) fn hotspot(
        &mut self,
        raw: &RawHotspot,
        trail: &Trail,
        size_mm: DVec2,
        scenes: &Names,
    ) -> Option<Hotspot> {
        let title = self.wording(Some(&raw.title), &trail.key("title"));
        let text = self.wording(raw.text.as_ref(), &trail.key("text"));
        let scene = match &raw.scene {
            Some(id) => self
                .resolve(id.as_str(), scenes, &trail.key("scene"))
                .map(Some),
            None => Some(None),
        };
        let trail = trail.key("polygon_mm");
        let mut polygon_mm = Vec::new();
        for (i, place) in raw.polygon_mm.iter() {
            let place = DVec2::from(place.map(|mm| mm.0));
            if place.cmplt(DVec2::ZERO).any() || place.cmpgt(size_mm).any() {
                let words = Words::new(
                    format!("a place beside the sheet, {} mm, {} mm", place.x, place.y),
                    format!("0 to {} mm and 0 to {} mm", size_mm.x, size_mm.y),
                    "measure from the left and top edges of its side",
                );
                self.report.fault(&trail.index(i), words);
            }
            polygon_mm.push(place);
        }
        // Of places that are missing because they are at fault nothing follows.
        if !raw.polygon_mm.has_holes() && !self.report.is_full() {
            for fault in outline_faults(&polygon_mm) {
                let words = Words::new(fault.to_string(), fault.allowed(), fault.remedy());
                self.report.fault(&trail, words);
            }
        }
        Some(Hotspot {
            id: raw.id.as_str().to_owned(),
            side: raw.side.unwrap_or_default(),
            polygon_mm,
            title,
            text,
            scene: scene?,
        })
    }
}
