//! Colours of the side's picture, averaged over discs.

use super::{Desk, Disc, Note, Reading, ReadingError, Tool, Value, reading, words};
use crate::measure::{self, Measured, Patch, Probe, probe};

const NAMES: [[&str; 2]; 3] = [
    ["L* of the first", "L* of the second"],
    ["a* of the first", "a* of the second"],
    ["b* of the first", "b* of the second"],
];

impl Desk<'_> {
    pub(super) fn probe(&mut self, tool: &Tool, disc: Disc) -> Result<Reading, ReadingError> {
        let (probe, notes) = self.probed(disc, self.scene.state)?;
        let [l, a, b] = means(&probe).map(|mean| words::plus_minus(mean, ""));
        let [spread_l, spread_a, spread_b] = probe.deviation;
        let words = format!(
            "probe at {}: L* {l}, a* {a}, b* {b}; spread {spread_l:.2}, {spread_a:.2}, {spread_b:.2} over {} \
             places",
            said(disc),
            probe.places
        );
        Ok(reading(
            tool,
            values(&probe, ["L*", "a*", "b*"]),
            words,
            notes,
        ))
    }

    pub(super) fn difference(
        &mut self,
        tool: &Tool,
        discs: [Disc; 2],
    ) -> Result<Reading, ReadingError> {
        let state = self.scene.state;
        let (first, mut notes) = self.probed(discs[0], state)?;
        let (second, more) = self.probed(discs[1], state)?;
        notes.extend(more);
        let between = format!("{} and {}", said(discs[0]), said(discs[1]));
        Ok(compared(tool, &first, &second, &between, notes))
    }

    pub(super) fn against(
        &mut self,
        tool: &Tool,
        disc: Disc,
        state: Option<usize>,
    ) -> Result<Reading, ReadingError> {
        let own = self.scene.state;
        let (first, mut notes) = self.probed(disc, own)?;
        let (second, more) = self.probed(disc, state)?;
        notes.extend(more);
        let name = |state: Option<usize>| {
            state.map_or_else(
                || "the side's own picture".to_owned(),
                |index| format!("\"{}\"", self.drawing().states[index].id),
            )
        };
        let between = format!("{} and {}, at {}", name(own), name(state), said(disc));
        Ok(compared(tool, &first, &second, &between, notes))
    }

    /// The mean colour of a disc in a state.
    pub(super) fn probed(
        &mut self,
        disc: Disc,
        state: Option<usize>,
    ) -> Result<(Probe, Vec<Note>), ReadingError> {
        let (map, picture) = self.albedo(state)?;
        let on_sheet = self.on_sheet()?;
        let patch = Patch::Disc {
            middle: disc.middle,
            radius_mm: disc.radius_mm,
        };
        let probe = probe(patch, picture.pixel_mm.min_element(), |place| {
            picture.colour_at(place).filter(|_| on_sheet(place))
        })?;
        let mut notes = vec![Note::Colours {
            file: self.name_of(&map.file),
        }];
        notes.extend(self.registration(&map.file).1);
        notes.extend(self.source(&map.file));
        Ok((probe, notes))
    }
}

fn said(disc: Disc) -> String {
    format!("{} (r {} mm)", words::at(disc.middle), disc.radius_mm)
}

/// The means with the standard uncertainty of a mean of so many places of such a spread.
fn means(probe: &Probe) -> [Measured; 3] {
    let root = (probe.places as f64).sqrt();
    std::array::from_fn(|i| Measured {
        value: probe.lab[i],
        sigma: probe.deviation[i] / root,
    })
}

fn values(probe: &Probe, names: [&'static str; 3]) -> Vec<Value> {
    let means = means(probe);
    let value = |i: usize| Value {
        spread: Some(probe.deviation[i]),
        count: Some(probe.places),
        ..Value::new(names[i], means[i], "")
    };
    (0..3).map(value).collect()
}

fn compared(
    tool: &Tool,
    first: &Probe,
    second: &Probe,
    between: &str,
    mut notes: Vec<Note>,
) -> Reading {
    notes.dedup();
    let difference = Measured {
        value: measure::difference(first, second),
        sigma: sigma_of_difference(first, second),
    };
    let words = format!(
        "probe: ΔE00 {} between {between}",
        words::plus_minus(difference, "")
    );
    let mut all = vec![Value::new("ΔE00", difference, "")];
    all.extend(values(first, NAMES.map(|[first, _]| first)));
    all.extend(values(second, NAMES.map(|[_, second]| second)));
    reading(tool, all, words, notes)
}

/// The uncertainties of both means, each by what it changes in the difference: the formula has no
/// derivative where the colours are one, so that the larger of both ways is taken.
fn sigma_of_difference(first: &Probe, second: &Probe) -> f64 {
    let own = measure::difference(first, second);
    let mut square = 0.0;
    for (moved, other) in [(first, second), (second, first)] {
        for (i, mean) in means(moved).iter().enumerate() {
            let change = [-mean.sigma, mean.sigma].map(|step| {
                let mut probe = *moved;
                probe.lab[i] += step;
                (measure::difference(&probe, other) - own).abs()
            });
            square += change[0].max(change[1]).powi(2);
        }
    }
    square.sqrt()
}
