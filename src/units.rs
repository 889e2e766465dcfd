//! Physical quantities that cross module borders, each a thin wrapper that names its unit.
//!
//! Inside one function plain `f64` is fine where the name carries the unit (`width_mm`).

use serde::{Deserialize, Serialize};

macro_rules! quantity {
    ($($(#[$doc:meta])* $name:ident, $symbol:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)?;
                f.write_str(concat!(" ", $symbol))
            }
        }
    )*};
}

quantity! {
    /// A length on or around the sheet, in mm.
    Millimetres, "mm";
    /// A height or thickness of paper and ink, in µm.
    Micrometres, "µm";
    /// An angle in degrees of arc.
    Degrees, "°";
    /// Illuminance, in lm/m².
    Lux, "lx";
    /// Luminous intensity, in lm/sr.
    Candela, "cd";
    /// Luminous flux.
    Lumen, "lm";
    /// Luminance, in cd/m².
    Nits, "cd/m²";
    /// Correlated colour temperature.
    Kelvin, "K";
}

impl Degrees {
    /// The same angle in radians.
    pub fn radians(self) -> f64 {
        self.0.to_radians()
    }
}
