//! The photograph undone, at every roughness of a side: what a spot absorbs that photographs as
//! it does. By the judge's own [`Capture`]; no tier has a part in it.

use crate::reference::{
    calibrate::{Capture, Curve},
    walk::{Absorption, Layers},
};

/// Between two roughnesses at which the photograph was walked.
const ALPHA_STEP: f64 = 0.1;
/// Roughnesses nearer to each other are one.
const ALPHA_SAME: f64 = 1e-3;

/// What absorbs at a spot, per channel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tone {
    pub sigma_a: [f64; 3],
    pub tau: [f64; 3],
}

struct Node {
    alpha: f64,
    paper: Curve,
    /// Over the bare paper, per channel.
    films: [Curve; 3],
    /// Photographed albedo of bare paper.
    bare: [f64; 3],
}

/// Paper and film by their photographs, for a range of roughness.
pub(super) struct Tones {
    nodes: Vec<Node>,
    bare_sigma_a: [f64; 3],
}

impl Tones {
    /// Of sheets `layers(α)` whose bare spots photograph as `bare` at the roughness `own_alpha`, for
    /// roughness within `range`.
    pub fn new(
        layers: impl Fn(f64) -> Layers,
        own_alpha: f64,
        bare: [f64; 3],
        [least, most]: [f64; 2],
        paths: u64,
        seed: u64,
    ) -> Self {
        let at = |alpha: f64| Capture::new(&layers(alpha), paths, seed);
        let own = at(own_alpha);
        let bare_sigma_a = bare.map(|albedo| own.solve_sigma_a(albedo).value);
        let steps = if most - least < ALPHA_SAME {
            0
        } else {
            ((most - least) / ALPHA_STEP).ceil() as usize
        };
        let nodes = (0..=steps)
            .map(|step| {
                let share = step as f64 / steps.max(1) as f64;
                let alpha = least + (most - least) * share;
                let fresh;
                let capture = if (alpha - own_alpha).abs() < ALPHA_SAME {
                    &own
                } else {
                    fresh = at(alpha);
                    &fresh
                };
                let papers = bare_sigma_a.map(|sigma_a| Absorption {
                    sigma_a,
                    ..Absorption::NONE
                });
                Node {
                    alpha,
                    paper: capture.paper_curve(),
                    films: papers.each_ref().map(|paper| capture.film_curve(paper)),
                    bare: papers.each_ref().map(|paper| capture.albedo(paper).mean),
                }
            })
            .collect();
        Self {
            nodes,
            bare_sigma_a,
        }
    }

    pub fn bare_sigma_a(&self) -> [f64; 3] {
        self.bare_sigma_a
    }

    /// A film over bare paper that photographs as `albedo`; where that is brighter than bare
    /// paper, paper that is paler than it.
    pub fn film(&self, albedo: [f64; 3], alpha: f64) -> Tone {
        self.mixed(alpha, |node, c| {
            if albedo[c] <= node.bare[c] {
                (self.bare_sigma_a[c], node.films[c].solve(albedo[c]).value)
            } else {
                (node.paper.solve(albedo[c]).value, 0.0)
            }
        })
    }

    /// Bare paper that photographs as `albedo`.
    pub fn paper(&self, albedo: [f64; 3], alpha: f64) -> Tone {
        self.mixed(alpha, |node, c| (node.paper.solve(albedo[c]).value, 0.0))
    }

    /// Photographed albedo of bare paper.
    pub fn bare(&self, alpha: f64) -> [f64; 3] {
        self.mixed(alpha, |node, c| (node.bare[c], 0.0)).sigma_a
    }

    /// What the surface alone photographs as.
    pub fn floor(&self, alpha: f64) -> f64 {
        self.mixed(alpha, |node, _| (node.paper.floor(), 0.0))
            .sigma_a[0]
    }

    /// Linear between the roughnesses that were walked.
    fn mixed(&self, alpha: f64, of: impl Fn(&Node, usize) -> (f64, f64)) -> Tone {
        let above = self.nodes.partition_point(|node| node.alpha < alpha);
        let high = &self.nodes[above.min(self.nodes.len() - 1)];
        let low = &self.nodes[above.saturating_sub(1)];
        let width = high.alpha - low.alpha;
        let share = if width > 0.0 {
            ((alpha - low.alpha) / width).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mut tone = Tone::default();
        for c in 0..3 {
            let (a, b) = (of(low, c), of(high, c));
            tone.sigma_a[c] = a.0 + (b.0 - a.0) * share;
            tone.tau[c] = a.1 + (b.1 - a.1) * share;
        }
        tone
    }
}
