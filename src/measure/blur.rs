//! What the pixels add to the width of a stroke, and the width without it.

use glam::DVec2;

use super::MeasureError;

/// Narrowest stroke that is told from a hair, in pixels.
const NARROWEST: f64 = 0.5;

/// The width in mm of the stroke that reads `read` mm at half depth through the pixels, where
/// `normal` is the unit vector across it in the pixels' axes.
pub(super) fn unblurred(read: f64, pixel: f64, normal: DVec2) -> Result<f64, MeasureError> {
    let blur = Blur::new(normal);
    let read = read / pixel;
    // Depth where the half width was read, less half the depth in the middle.
    let excess = |w: f64| {
        let edge = blur.share(0.5 * (read + w)) - blur.share(0.5 * (read - w));
        edge - 0.5 * (blur.share(0.5 * w) - blur.share(-0.5 * w))
    };
    let (mut low, mut high) = (NARROWEST, read);
    if !read.is_finite() || low >= high || excess(low) >= 0.0 {
        return Err(MeasureError::Range {
            what: "the width of the stroke in pixels as read",
            found: read,
            allowed: "above 1.3: the pixels do not tell it from a hair",
        });
    }
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(pixel * 0.5 * (low + high))
}

/// What pixels and linear interpolation make of a sharp edge, in pixels from it.
struct Blur {
    /// Share of the edge's step at −`REACH`…`REACH`.
    shares: Vec<f64>,
}

impl Blur {
    /// Steps per pixel.
    const FINE: f64 = 64.0;
    /// Three boxes of a pixel reach 1.5 √2 pixels at most.
    const REACH: f64 = 2.25;

    /// A pixel is a mean over a square, and linear interpolation the mean of a mean over one, so
    /// that three squares blur the picture. Across a stroke of this normal each is the
    /// convolution of two boxes, of widths |n_x| and |n_y|.
    fn new(normal: DVec2) -> Self {
        let last = (2.0 * Self::REACH * Self::FINE) as usize;
        let place = |i: usize| i as f64 / Self::FINE - Self::REACH;
        let sides = normal.abs();
        let widest = sides.max_element().max(1e-3);
        let mut blur = Self {
            shares: (0..=last)
                .map(|i| (place(i) / widest + 0.5).clamp(0.0, 1.0))
                .collect(),
        };
        let narrow = sides.min_element();
        for width in [widest, widest, narrow, narrow, narrow] {
            // Finer than the steps it is no blur.
            if width > 2.0 / Self::FINE {
                blur = blur.boxed(width);
            }
        }
        blur
    }

    /// The running mean over `width`.
    fn boxed(&self, width: f64) -> Self {
        let mut integral = vec![0.0; self.shares.len()];
        for i in 1..integral.len() {
            integral[i] =
                integral[i - 1] + 0.5 * (self.shares[i - 1] + self.shares[i]) / Self::FINE;
        }
        let last = integral.len() - 1;
        // Beyond the last step the share is 1, before the first 0.
        let upto = |x: f64| {
            let place = (x + Self::REACH) * Self::FINE;
            let inside = place.clamp(0.0, last as f64);
            let i = (inside as usize).min(last - 1);
            integral[i]
                + (integral[i + 1] - integral[i]) * (inside - i as f64)
                + (place - inside).max(0.0) / Self::FINE
        };
        let mean = |i: usize| {
            let x = i as f64 / Self::FINE - Self::REACH;
            (upto(x + 0.5 * width) - upto(x - 0.5 * width)) / width
        };
        Self {
            shares: (0..=last).map(mean).collect(),
        }
    }

    fn share(&self, x: f64) -> f64 {
        let last = self.shares.len() - 1;
        let place = ((x + Self::REACH) * Self::FINE).clamp(0.0, last as f64);
        let i = (place as usize).min(last - 1);
        self.shares[i] + (self.shares[i + 1] - self.shares[i]) * (place - i as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blur_is_three_squares_wide() {
        for degrees in [0.0f64, 20.0, 45.0, 90.0] {
            let blur = Blur::new(DVec2::from_angle(degrees.to_radians()));
            let steps = (2.0 * Blur::REACH * Blur::FINE) as usize;
            let (mut weight, mut variance) = (0.0, 0.0);
            for i in 0..steps {
                let x = (i as f64 + 0.5) / Blur::FINE - Blur::REACH;
                let density = blur.share(x + 0.5 / Blur::FINE) - blur.share(x - 0.5 / Blur::FINE);
                weight += density;
                variance += density * x * x;
            }
            assert!((weight - 1.0).abs() < 1e-6, "{degrees}: {weight}");
            // Three boxes of 1/12 in every direction; two would be 1/6.
            assert!((variance - 0.25).abs() < 0.005, "{degrees}: {variance}");
        }
    }

    #[test]
    fn wide_strokes_are_as_wide_as_read_and_hairs_are_refused() {
        let wide = unblurred(0.8, 0.1, DVec2::X).unwrap();
        assert!((wide - 0.8).abs() < 1e-3);
        assert!(unblurred(0.14, 0.1, DVec2::X).unwrap() < 0.11);
        for read in [0.0, 0.1, f64::NAN] {
            assert!(unblurred(read, 0.1, DVec2::X).is_err(), "{read}");
        }
    }
}
