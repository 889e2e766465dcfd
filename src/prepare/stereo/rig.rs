//! Lamps as a place of the sheet sees them.

use glam::{DMat3, DVec2, DVec3};

/// Where lamps stand, in the sheet's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// Unit vectors towards lamps far away.
    Far(Vec<DVec3>),
    /// In mm from the middle of the photograph, small in comparison with their distance.
    Near(Vec<DVec3>),
}

impl Standing {
    /// Unit vectors towards the lamps, from the middle of the photograph.
    pub fn directions(&self) -> Vec<DVec3> {
        let (Self::Far(lamps) | Self::Near(lamps)) = self;
        lamps.iter().map(|lamp| lamp.normalize()).collect()
    }
}

/// What photographs are in proportion to.
#[derive(Clone, Debug, PartialEq)]
pub enum Gain {
    /// They were divided by those of a grey card: 1 is what a perfect diffuser shows that lies flat
    /// in the same place.
    FlatFielded,
    /// They are as exposed, under lamps of these intensities: 1 is what a perfect diffuser shows
    /// that faces a lamp of intensity 1, from the middle of the photograph.
    Relative(Vec<f64>),
}

/// The lamps of a set of photographs.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    pub standing: Standing,
    pub gain: Gain,
    pub mm_per_px: f64,
    /// The middle of the photograph, in pixels from the left and top edge of what is solved.
    pub middle_px: DVec2,
}

/// A lamp from one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lit {
    /// Unit vector towards it.
    pub l: DVec3,
    /// What a photograph shows of a perfect diffuser that faces the lamp.
    pub gain: f64,
}

impl Rig {
    /// Lamps far away under which a grey card was photographed.
    pub fn far(directions: Vec<DVec3>) -> Self {
        Self {
            standing: Standing::Far(directions),
            gain: Gain::FlatFielded,
            mm_per_px: 1.0,
            middle_px: DVec2::ZERO,
        }
    }

    pub fn count(&self) -> usize {
        match &self.standing {
            Standing::Far(lamps) | Standing::Near(lamps) => lamps.len(),
        }
    }

    /// Whether every place sees the lamps alike.
    pub fn is_uniform(&self) -> bool {
        matches!(self.standing, Standing::Far(_))
    }

    /// These of its lamps alone.
    #[must_use]
    pub fn only(&self, lamps: &[usize]) -> Self {
        let places = |all: &[DVec3]| lamps.iter().map(|i| all[*i]).collect();
        Self {
            standing: match &self.standing {
                Standing::Far(all) => Standing::Far(places(all)),
                Standing::Near(all) => Standing::Near(places(all)),
            },
            gain: match &self.gain {
                Gain::FlatFielded => Gain::FlatFielded,
                Gain::Relative(all) => Gain::Relative(lamps.iter().map(|i| all[*i]).collect()),
            },
            ..self.clone()
        }
    }

    /// The lamp `i` from a pixel whose middle is `at`, in pixels from the left and top edge.
    pub fn lamp(&self, i: usize, at: DVec2) -> Lit {
        let (l, nearer) = match &self.standing {
            Standing::Far(lamps) => (lamps[i], 1.0),
            Standing::Near(lamps) => {
                let mm = (at - self.middle_px) * self.mm_per_px;
                let to = lamps[i] - DVec3::new(mm.x, -mm.y, 0.0);
                let square = to.length_squared();
                (to / square.sqrt(), lamps[i].length_squared() / square)
            }
        };
        let gain = match &self.gain {
            // The card lay flat under the same light.
            Gain::FlatFielded => l.z.recip(),
            Gain::Relative(intensities) => intensities[i] * nearer,
        };
        Lit { l, gain }
    }

    /// The rows of (AᵀA)⁻¹Aᵀ for the lamps as seen from `at`, where A has the rows gain·l: what
    /// brings values to the normal times the albedo. `None` where the lamps do not span space.
    pub fn pseudo_inverse(&self, at: DVec2) -> Option<Vec<DVec3>> {
        let rows: Vec<DVec3> = (0..self.count())
            .map(|i| {
                let Lit { l, gain } = self.lamp(i, at);
                l * gain
            })
            .collect();
        let mut gram = DMat3::ZERO;
        for a in &rows {
            gram += DMat3::from_cols(*a * a.x, *a * a.y, *a * a.z);
        }
        let inverse = gram.inverse();
        inverse
            .is_finite()
            .then(|| rows.into_iter().map(|a| inverse * a).collect())
    }
}
