//! A lamp's direction from its highlight on a glossy ball.
//!
//! The highlight lies where the ball mirrors the lamp into the camera: l = 2(n·v)n − v, with n the
//! ball's normal there, v = (0, 0, 1). The lamp is seen as its *saturated* pixels, of which the
//! median is taken: what is merely bright is the room, and its mean was measured to be 3.4° to
//! 7.6° off (PSBox's probes). The ball bends the picture of a large lamp: the median of one of
//! 3.4° radius was measured to be 0.2° off, with the square of the radius.

use glam::{DVec2, DVec3};

use super::super::capture::Circle;
use crate::colour::srgb_encode;

/// From which luma on a pixel belongs to the highlight: 250 of 255, rounded.
pub const HIGHLIGHT: f32 = 249.5 / 255.0;
/// How far outside the ball its outline's own gleam begins.
const WITHIN: f64 = 0.98;
/// How far around its middle most of a highlight lies, in radii of the ball; what is scattered more
/// is noise, or a ball that is not glossy.
const COMPACT: f64 = 0.25;
/// The fewest pixels of a highlight: single ones are dust, or noise in the dark.
const FEWEST: usize = 4;
/// The largest share of the ball that a lamp covers; more is overexposure or a white ball.
const LARGEST_SHARE: f64 = 0.25;

/// Sine of the lowest elevation of a lamp: that of 1°, as a capture file allows.
const LOWEST: f64 = 0.0174;

/// Why a ball shows no lamp.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoHighlight {
    #[error("the ball's outline reaches out of the photograph")]
    Outside,
    #[error("the ball shows no highlight")]
    None,
    #[error("the highlight at {:.0}, {:.0} is that of a lamp below the sheet; the ball's outline is another one, or the highlight is the room's", .0.x, .0.y)]
    Below(DVec2),
    #[error("{0:.0} % of the ball are white: it is overexposed, or not a glossy ball")]
    Overexposed(f64),
}

/// A highlight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Where in the photograph, in pixels.
    pub at: DVec2,
    /// Unit vector towards the lamp.
    pub direction: DVec3,
    /// How many pixels belong to it.
    pub pixels: usize,
}

/// Luma (ITU-R BT.601, of values encoded as sRGB, as cameras and viewers make grey pictures) of
/// planes of linear red, green and blue, in 0…1 of the brightest value there.
pub fn luma([r, g, b]: [&[f32]; 3]) -> Vec<f32> {
    let brightest = [r, g, b].into_iter().flatten().copied().fold(0.0, f32::max);
    let brightest = f64::from(brightest.max(f32::MIN_POSITIVE));
    let encoded = |v: f32| srgb_encode((f64::from(v) / brightest).clamp(0.0, 1.0));
    let pixels = r.iter().zip(g).zip(b);
    pixels
        .map(|((r, g), b)| (0.299 * encoded(*r) + 0.587 * encoded(*g) + 0.114 * encoded(*b)) as f32)
        .collect()
}

/// The highlight on a ball with this outline in a picture of [`luma`], rows from the top. Values
/// are taken in comparison with the brightest on the ball.
///
/// # Errors
/// [`NoHighlight`].
pub fn highlight(
    luma: &[f32],
    [width, height]: [usize; 2],
    circle: Circle,
) -> Result<Highlight, NoHighlight> {
    let Circle { centre, radius } = circle;
    let low = centre - radius;
    let high = centre + radius;
    let whole = low.min_element() >= 0.0 && high.x <= width as f64 && high.y <= height as f64;
    if !whole || luma.len() != width * height {
        return Err(NoHighlight::Outside);
    }
    let rows = low.y.floor() as usize..(high.y.ceil() as usize).min(height);
    let columns = low.x.floor() as usize..(high.x.ceil() as usize).min(width);
    let on_ball = || {
        let columns = columns.clone();
        rows.clone().flat_map(move |y| {
            columns.clone().filter_map(move |x| {
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                (at.distance(centre) <= radius * WITHIN).then_some((x, y))
            })
        })
    };
    let value = |(x, y): (usize, usize)| luma[y * width + x];
    let brightest = on_ball().map(value).fold(0.0, f32::max);
    if brightest <= 0.0 || !brightest.is_finite() {
        return Err(NoHighlight::None);
    }
    let mut count = 0;
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for place in on_ball() {
        count += 1;
        if value(place) >= HIGHLIGHT * brightest {
            xs.push(place.0);
            ys.push(place.1);
        }
    }
    let share = xs.len() as f64 / f64::from(count.max(1));
    if share > LARGEST_SHARE {
        return Err(NoHighlight::Overexposed(share * 100.0));
    }
    let (x, y) = (median(&xs), median(&ys));
    let near = |(a, b): (&usize, &usize)| (*a as f64 - x).hypot(*b as f64 - y) <= COMPACT * radius;
    let compact = xs.iter().zip(&ys).filter(|place| near(*place)).count();
    if compact < FEWEST || 2 * compact < xs.len() {
        return Err(NoHighlight::None);
    }
    let at = DVec2::new(x + 0.5, y + 0.5);
    let direction = mirrored(at, circle);
    if direction.z < LOWEST {
        return Err(NoHighlight::Below(at));
    }
    Ok(Highlight {
        at,
        direction,
        pixels: xs.len(),
    })
}

/// Towards what a ball mirrors to the camera at a place of a photograph.
pub fn mirrored(at: DVec2, circle: Circle) -> DVec3 {
    let DVec2 { x, y } = (at - circle.centre) / circle.radius;
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let n = DVec3::new(x, -y, z);
    2.0 * n.z * n - DVec3::Z
}

/// The median of whole numbers, one of them: of an even count the upper one.
fn median(values: &[usize]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).map_or(0.0, |v| *v as f64)
}
