//! The capture file as written: plain data, every key declared once.
//!
//! What is declared here is what [`schema`](super::schema()) publishes, and its comments are what
//! a photographer's editor shows; so they speak to photographers.

use super::{
    ChartValues, Filter, Integration, Intensities, MAX_LAMPS, Robustness,
    values::{
        CapturePath, CardReflectance, Each, Intensity, KnownUm, LampElevationDeg, PixelMm, RulerMm,
        SheetDpi, SplitMm,
    },
};
use crate::{
    manifest::{
        SideName,
        decode::{List, Rule},
        macros::record,
        raw::values::{DistanceMm, Id, MediumName, PixelPx, PositionMm, ReliefUm, Text, TurnDeg},
    },
    maps::ColourEncoding,
    optics::spectrum::Illuminant,
};

/// Photographs in the order of the lamps.
pub type RawFrames = List<CapturePath, 1, MAX_LAMPS>;

record! {
    /// Photographs of one sheet, to make maps of: a capture file.
    pub struct RawCapture {
        required {
            /// A short name of the sheet, for files and messages.
            id: Id,
            /// How large a pixel is on the sheet.
            scale: RawScale,
            /// Where the lamps stood.
            lamps: RawLamps,
            /// The photographs of the front.
            recto: RawShots,
        }
        optional {
            /// What the drawing is called.
            title: Text,
            /// How the photographs encode light: linear, srgb, or embedded (by their ICC profile).
            /// Without it: embedded.
            encoding: ColourEncoding,
            /// The light that colours are stated under. Without it: D50, under which charts are
            /// measured.
            illuminant: Illuminant,
            /// The photographs of the back.
            verso: RawShots,
            /// A colour chart, photographed under the same light.
            chart: RawChart,
            /// The sheet on a light table.
            transmitted: RawTransmitted,
            /// Places whose material is known, each below its own `[[swatch]]`.
            swatch: List<RawSwatch, 1, 1000>,
            /// How relief is read from the photographs.
            relief: RawRelief,
        }
        rules []
    }
}

record! {
    /// How large a pixel is on the sheet.
    pub struct RawScale {
        required {}
        optional {
            /// The side of a pixel in mm.
            mm_per_px: PixelMm,
            /// Pixels per inch on the sheet.
            dpi: SheetDpi,
            /// A ruler in the photographs.
            ruler: RawRuler,
        }
        rules [Rule::ExactlyOne(&["mm_per_px", "dpi", "ruler"])]
    }
}

record! {
    /// Two marks of a ruler in the photographs.
    pub struct RawRuler {
        required {
            /// The one mark, in pixels from the left and top edge.
            from_px: [PixelPx; 2],
            /// The other mark.
            to_px: [PixelPx; 2],
            /// How far they are from each other in mm.
            length_mm: RulerMm,
        }
        optional {}
        rules []
    }
}

record! {
    /// Where the lamps stood, in the order of the photographs: 3 to 500 of them.
    pub struct RawLamps {
        required {}
        optional {
            /// Where each lamp's light comes from, in degrees anticlockwise from the right.
            azimuth_deg: List<TurnDeg, 1, MAX_LAMPS>,
            /// How high each lamp stands above the plane of the sheet, in degrees: one number for
            /// all lamps, or one for each.
            elevation_deg: Each<LampElevationDeg>,
            /// How far each lamp is from the centre of the photograph, in mm: one number for all
            /// lamps, or one for each. Without it: far away.
            distance_mm: Each<DistanceMm>,
            /// Where each lamp stands in mm from the centre of the photograph: to the right,
            /// upwards in the photograph, and out of it towards the camera.
            position_mm: List<[PositionMm; 3], 1, MAX_LAMPS>,
            /// A file of light directions, as programs for RTI and PTM write it (.lp).
            lp: CapturePath,
            /// A glossy ball in which the lamps are mirrored.
            sphere: RawSphere,
            /// A photograph of a grey card under each lamp, of the same size and exposure.
            flat_field: RawFrames,
            /// What share of the light the grey card reflects. Without it: 0.18.
            grey_card: CardReflectance,
            /// A photograph of the grey card with all lamps off, of the same exposure: the room's
            /// light, which is taken from the others as `recto.ambient` is from the recto's.
            flat_field_ambient: CapturePath,
            /// How bright each lamp is in comparison with the others. Not together with
            /// flat_field, which says it.
            relative: List<Intensity, 1, MAX_LAMPS>,
            /// Where it is not known how bright each lamp is: solve finds it from the photographs
            /// of a sheet that lies flat on the whole, equal takes them as alike. Without it:
            /// solve, unless there are flat_field or relative.
            intensities: Intensities,
        }
        rules [
            Rule::ExactlyOne(&["azimuth_deg", "position_mm", "lp", "sphere"]),
            Rule::Needs("azimuth_deg", "elevation_deg"),
            Rule::Needs("elevation_deg", "azimuth_deg"),
            Rule::Needs("distance_mm", "azimuth_deg"),
            Rule::Needs("grey_card", "flat_field"),
            Rule::Needs("flat_field_ambient", "flat_field"),
            Rule::AtMostOne(&["flat_field", "relative", "intensities"]),
        ]
    }
}

record! {
    /// A glossy ball in which the lamps are mirrored.
    pub struct RawSphere {
        required {}
        optional {
            /// Its photographs, one under each lamp. Without them: it lies in those of the recto.
            photographs: RawFrames,
            /// Its outline in these photographs: the centre from the left and top edge, and the
            /// radius, in pixels. Without it: looked for.
            circle_px: [PixelPx; 3],
        }
        rules []
    }
}

record! {
    /// The photographs of one side.
    pub struct RawShots {
        required {}
        optional {
            /// One under each lamp, in the order of the lamps. May be left out where the .lp file
            /// names them.
            photographs: RawFrames,
            /// A photograph with all lamps off, of the same exposure: it is taken from the others.
            ambient: CapturePath,
            /// What of the photographs is the sheet: left, top, right and bottom edge in pixels.
            /// Without it: all.
            crop_px: [PixelPx; 4],
        }
        rules []
    }
}

record! {
    /// A colour chart of six by four patches.
    pub struct RawChart {
        required {
            /// The photograph that it is in, flat under the first lamp, at the sheet's exposure.
            photograph: CapturePath,
        }
        optional {
            /// The middles of the patches at its corners: dark skin, bluish green, black and white,
            /// in pixels from the left and top edge. Without it: looked for.
            corners_px: [[PixelPx; 2]; 4],
            /// Whose colours it has: those of the ColorChecker made since November 2014. Without
            /// it: colorchecker24, unless there is a file.
            values: ChartValues,
            /// A table of its colours: 24 lines of L*, a*, b* under D50.
            file: CapturePath,
            /// The grey card under the same lamps, of the same size.
            flat_field: CapturePath,
        }
        rules [Rule::AtMostOne(&["values", "file"])]
    }
}

record! {
    /// The sheet on a light table.
    pub struct RawTransmitted {
        required {
            /// The photograph, of the recto's size and in its place.
            photograph: CapturePath,
        }
        optional {
            /// The light table alone, at the same exposure.
            flat_field: CapturePath,
        }
        rules []
    }
}

record! {
    /// A place whose material is known.
    pub struct RawSwatch {
        required {
            /// What is there: a medium of the catalogue, or bare-paper.
            medium: MediumName,
            /// Left, top, right and bottom edge in pixels of the photographs.
            rect_px: [PixelPx; 4],
        }
        optional {
            /// The side that it is on. Without it: recto.
            side: SideName,
        }
        rules []
    }
}

record! {
    /// How relief is read from the photographs.
    pub struct RawRelief {
        required {}
        optional {
            /// Up to which radius in mm relief belongs to strokes and grain, and not to the shape
            /// of the sheet. Without it: 2.
            split_mm: SplitMm,
            /// How the two are separated: gaussian, or bilateral, which keeps creases. Without it:
            /// gaussian.
            filter: Filter,
            /// What is done against shadows and highlights: robust weighs each photograph at each
            /// place, drop leaves the brightest and darkest out, none trusts all. Without it:
            /// robust.
            against_outliers: Robustness,
            /// How slopes become the shape of the sheet: free asks nothing of its edges, anchored
            /// holds them at height 0, for a sheet whose edges are pressed flat, and robust does
            /// not trust slopes that contradict their surroundings, as at creases and torn edges.
            /// Without it: free.
            integrate: Integration,
            /// From the lowest to the highest place of the sheet in µm, where it was measured.
            /// Without it: as the lamps say.
            known_range_um: KnownUm,
            /// Another surface of the whole sheet to compare the shape with, such as one from
            /// photogrammetry: a .glb file as surface.gltf of an exhibit has it, or a picture of
            /// heights.
            compare: CapturePath,
            /// Of a picture of heights, those of black and of white in µm.
            compare_range_um: [ReliefUm; 2],
        }
        rules [Rule::Needs("compare_range_um", "compare")]
    }
}
