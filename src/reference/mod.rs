//! The judge: light through paper and ink by a random walk in f64, with its variance.
//!
//! It shares constants, Fresnel's formula and the facets' distribution with the tiers, and
//! nothing else. Random numbers are seeded, and a result depends on its seed only, not on the
//! number of threads.

pub mod calibrate;
pub mod conductor;
pub mod flux;
pub mod interface;
pub mod lateral;
pub mod phase;
pub mod picture;
pub mod radiance;
pub mod rng;
pub mod statistics;
pub mod walk;

pub use calibrate::{Bound, Capture, Curve, Solved};
pub use conductor::Conductor;
pub use flux::{Bins, Flux, bins, reflectance_transmittance};
pub use phase::Phase;
pub use radiance::{Lamp, Lighting, radiance};
pub use statistics::Estimate;
pub use walk::{Absorption, Layers};
