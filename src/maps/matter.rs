//! The media of a side, laid over each other: how much of each texel is film, body colour and
//! each sort of particles.
//!
//! Media maps lie over each other in their order, and the upper covers the lower: of a lower
//! medium's coverage, 1 − (coverage of all above) remains. Media of one map lie side by side;
//! where their coverages add up to more than 1 they are scaled to 1. What no medium covers is
//! paper.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    MAX_WEIGHTS, MapError, Pyramid, Warp,
    decode::{self, Raster},
    legend::{check_weights, find, for_each_colour},
    load,
    warp::{self, Beyond},
};

/// The most sorts of particles on one side.
pub const MAX_PARTICLES: usize = 6;
/// Film, body colour and all sorts of particles.
const SHARES: usize = 2 + MAX_PARTICLES;

/// What the medium of a channel counts as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatterSlot {
    /// It has no matter and covers nothing: a blind stylus.
    Nothing,
    Film,
    Body,
    /// By its number, below [`MAX_PARTICLES`].
    Particles(usize),
}

/// A media map, with something for each medium of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MediaLayer<T> {
    pub path: PathBuf,
    /// What bends it into its place; all maps of a side lie alike.
    pub warp: Option<Arc<Warp>>,
    pub channels: MediaChannels<T>,
}

/// How a media map tells its media apart.
#[derive(Clone, Debug, PartialEq)]
pub enum MediaChannels<T> {
    /// 8-bit sRGB colours in the file.
    Legend(Vec<([u8; 3], T)>),
    /// The channels of the file in their order hold coverage.
    Weights(Vec<T>),
}

impl<T: Copy> MediaChannels<T> {
    fn each(&self) -> Vec<T> {
        match self {
            Self::Legend(legend) => legend.iter().map(|(_, each)| *each).collect(),
            Self::Weights(each) => each.clone(),
        }
    }
}

/// Which half of the shares a texture holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatterPart {
    /// Film, body colour, particles 0 and 1.
    First,
    /// Particles 2 to 5.
    More,
}

/// Loads the shares of a side's media, `layers` from the lowest to the uppermost: four channels of
/// 8 bits, as `part` says. The shares of a texel, of both parts together, add up to 1 at most,
/// after rounding too.
///
/// # Errors
/// As [`super::verify`], and [`MapError::Unsupported`] for a map that differs in size from the
/// first, or has fewer channels than media.
pub fn load_matter(
    layers: &[MediaLayer<MatterSlot>],
    part: MatterPart,
) -> Result<Pyramid, MapError> {
    let stack = Stack::open(layers)?;
    let slot = |slot: MatterSlot| match slot {
        MatterSlot::Nothing => None,
        MatterSlot::Film => Some(0),
        MatterSlot::Body => Some(1),
        MatterSlot::Particles(number) => Some(2 + number.min(MAX_PARTICLES - 1)),
    };
    let row = |y: usize, out: &mut [[f32; SHARES]]| {
        out.fill([0.0; SHARES]);
        stack.row(y, out.len(), slot, |x, slot, share| out[x][slot] += share);
    };
    let first = match part {
        MatterPart::First => 0,
        MatterPart::More => 4,
    };
    let paint = |shares| {
        let codes = codes(shares);
        std::array::from_fn(|i| codes[first + i])
    };
    let pyramid = warp::build::<u8, SHARES, 4>(stack.warp, stack.size, row, paint, Beyond::Edge);
    Ok(stack.finish(pyramid))
}

/// Shares as multiples of 1/255 whose sum is that of the shares, rounded: each is the step of the
/// rounded running sum, so none is off by more than one code.
fn codes(shares: [f32; SHARES]) -> [f32; SHARES] {
    let mut sum = 0.0;
    let mut before = 0.0;
    shares.map(|share| {
        sum += share;
        let after = (sum.min(1.0) * 255.0).round();
        let code = after - before;
        before = after;
        code / 255.0
    })
}

/// Loads a roughness that is put together from that of each medium and of the `paper` between
/// them, where no map of it is given: their mean, weighted by what shows of each; 8 bits, read as
/// [`super::load_roughness`]'s. `layers` from the lowest to the uppermost; `None` for a medium
/// that has no surface of its own.
///
/// # Errors
/// As [`load_matter`].
pub fn load_roughness_of_matter(
    layers: &[MediaLayer<Option<f64>>],
    paper: f64,
) -> Result<Pyramid, MapError> {
    let stack = Stack::open(layers)?;
    let paper = paper as f32;
    let row = |y: usize, out: &mut [[f32; 1]]| {
        out.fill([paper]);
        stack.row(
            y,
            out.len(),
            |alpha| alpha,
            |x, alpha, share| out[x][0] += share * (alpha as f32 - paper),
        );
    };
    let pyramid = warp::build::<u8, 1, 1>(stack.warp, stack.size, row, |mean| mean, Beyond::Edge);
    Ok(stack.finish(pyramid))
}

/// Media maps of one size, decoded.
struct Stack<'l, T> {
    /// From the lowest to the uppermost.
    layers: Vec<Layer<'l, T>>,
    size: [usize; 2],
    warp: Option<&'l Warp>,
}

struct Layer<'l, T> {
    raster: Raster,
    channels: &'l MediaChannels<T>,
    each: Vec<T>,
    colours: Vec<[u8; 3]>,
}

impl<'l, T: Copy + Sync> Stack<'l, T> {
    fn open(layers: &'l [MediaLayer<T>]) -> Result<Self, MapError> {
        let opened: Vec<Layer<'l, T>> = layers
            .iter()
            .map(|layer| Layer::open(&layer.path, &layer.channels))
            .collect::<Result<_, _>>()?;
        // Of nothing at all a single texel of paper is left.
        let size = opened.first().map_or([1, 1], |layer| layer.raster.size());
        for (layer, opened) in layers.iter().zip(&opened) {
            let [width, height] = opened.raster.size();
            if [width, height] != size {
                return Err(MapError::unsupported(
                    &layer.path,
                    format!(
                        "is {width} × {height} pixels where the media map below it has {} × {}",
                        size[0], size[1]
                    ),
                    "bring all maps of one side to one size",
                ));
            }
        }
        Ok(Self {
            layers: opened,
            size,
            warp: layers.first().and_then(|layer| layer.warp.as_deref()),
        })
    }

    /// Calls `add` with a place in the row, what `count` makes of a medium there, and the share
    /// of the texel that shows it; media of which it makes nothing cover nothing.
    fn row<U: Copy>(
        &self,
        y: usize,
        width: usize,
        count: impl Fn(T) -> Option<U>,
        mut add: impl FnMut(usize, U, f32),
    ) {
        // What the layers above leave of each texel.
        let mut open = vec![1.0_f32; width];
        let mut weights = vec![[0.0_f32; MAX_WEIGHTS]; width];
        for layer in self.layers.iter().rev() {
            let counted: Vec<Option<U>> = layer.each.iter().map(|each| count(*each)).collect();
            layer.row(y, &mut weights);
            for (x, (weights, open)) in weights.iter().zip(&mut open).enumerate() {
                let covering = || {
                    let both = counted.iter().zip(weights);
                    both.filter_map(|(counted, weight)| Some(((*counted)?, *weight)))
                };
                let covered: f32 = covering().map(|(_, weight)| weight).sum();
                let scale = *open / covered.max(1.0);
                for (counted, weight) in covering().filter(|(_, weight)| *weight > 0.0) {
                    add(x, counted, weight * scale);
                }
                *open *= 1.0 - covered.min(1.0);
            }
        }
    }

    fn finish(&self, pyramid: Pyramid) -> Pyramid {
        Pyramid {
            missing: self
                .layers
                .iter()
                .map(|layer| layer.raster.missing.count)
                .sum(),
            ..pyramid
        }
    }
}

impl<'l, T: Copy> Layer<'l, T> {
    fn open(path: &Path, channels: &'l MediaChannels<T>) -> Result<Self, MapError> {
        let each = channels.each();
        check_weights(path, "media", each.len())?;
        let (raster, colours) = match channels {
            MediaChannels::Legend(legend) => (
                load::decode(path)?,
                legend.iter().map(|(colour, _)| *colour).collect(),
            ),
            // Every channel is an amount of its own, a fourth one too.
            MediaChannels::Weights(_) => (decode::read(path)?, Vec::new()),
        };
        if matches!(channels, MediaChannels::Weights(_)) && raster.channels < each.len() {
            return Err(MapError::unsupported(
                path,
                format!("has {} channels for {} media", raster.channels, each.len()),
                "give each medium a channel of its own",
            ));
        }
        Ok(Self {
            raster,
            channels,
            each,
            colours,
        })
    }

    /// The coverage of each medium, within 0…1.
    fn row(&self, y: usize, out: &mut [[f32; MAX_WEIGHTS]]) {
        match self.channels {
            MediaChannels::Legend(_) => {
                let mut last = None;
                for_each_colour(&self.raster, y, |x, colour| {
                    out[x] = [0.0; MAX_WEIGHTS];
                    let found = colour.and_then(|colour| find(&self.colours, colour, &mut last));
                    if let Some(i) = found {
                        out[x][i] = 1.0;
                    }
                });
            }
            MediaChannels::Weights(_) => {
                self.raster
                    .for_each_in_row(y, |x, pixel| out[x] = pixel.map(|v| v.clamp(0.0, 1.0)));
            }
        }
    }
}
