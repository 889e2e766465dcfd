//! How fine the picture is while something moves: the cheapest tier comes first, and where even that is too
//! slow, fewer pixels. What was learnt in one movement serves the next.

/// Shares of the pixels along each side. Half of them leave a pen stroke of two pixels.
const SHARES: [f32; 4] = [1.0, 0.8, 0.65, 0.5];
/// Frames after a change that still come from before it, and frames that are judged together.
const LATE: usize = 3;
const JUDGED: usize = 5;
/// A coarser picture has to take less than this share of the time, or pixels are not what takes it.
const WORTH: f64 = 0.9;
/// A finer one is tried where it is expected within this share of the time.
const ROOM: f64 = 0.85;

/// Learns from frames how fine the picture may be.
#[derive(Clone, Debug, Default)]
pub struct Fineness {
    /// Of [`SHARES`].
    step: usize,
    late: usize,
    frames: Vec<f64>,
    /// What a frame took at the step before, in ms.
    before: Option<f64>,
    /// Fewer pixels do not help, in this movement.
    in_vain: bool,
}

impl Fineness {
    /// The share of pixels along each side, at most 1.
    pub fn share(&self) -> f32 {
        SHARES[self.step]
    }

    /// The movement has ended.
    pub fn rest(&mut self) {
        self.frames.clear();
        (self.late, self.before, self.in_vain) = (LATE, None, false);
    }

    /// A frame that followed another at once took `ms`, where it may take `most_ms`.
    pub fn frame(&mut self, ms: f64, most_ms: f64) {
        if self.late > 0 {
            self.late -= 1;
            return;
        }
        self.frames.push(ms);
        if self.frames.len() < JUDGED {
            return;
        }
        self.frames.sort_by(f64::total_cmp);
        let took = self.frames[JUDGED / 2];
        self.frames.clear();
        let helped = self.before.is_none_or(|before| took < WORTH * before);
        self.before = None;
        if !helped {
            self.in_vain = true;
            self.go(self.step - 1);
        } else if took > most_ms {
            if self.step + 1 < SHARES.len() && !self.in_vain {
                self.before = Some(took);
                self.go(self.step + 1);
            }
        } else if self.step > 0 {
            let more = f64::from(SHARES[self.step - 1] / SHARES[self.step]).powi(2);
            if took * more < ROOM * most_ms {
                self.go(self.step - 1);
            }
        }
    }

    fn go(&mut self, step: usize) {
        (self.step, self.late) = (step, LATE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As long as a movement of 200 frames, each of which takes `ms` of its share of pixels.
    fn moved(fineness: &mut Fineness, most_ms: f64, ms: impl Fn(f64) -> f64) -> f32 {
        for _ in 0..200 {
            let side = f64::from(fineness.share());
            fineness.frame(ms(side * side), most_ms);
        }
        fineness.share()
    }

    #[test]
    fn it_is_as_fine_as_the_time_allows() {
        let mut fineness = Fineness::default();
        assert_eq!(moved(&mut fineness, 16.0, |pixels| 10.0 * pixels), 1.0);
        assert_eq!(moved(&mut fineness, 16.0, |pixels| 30.0 * pixels), 0.65);
        fineness.rest();
        assert_eq!(fineness.share(), 0.65, "the next movement begins there");
        assert_eq!(moved(&mut fineness, 16.0, |pixels| 900.0 * pixels), 0.5);
        assert_eq!(moved(&mut fineness, 16.0, |pixels| 12.0 * pixels), 1.0);
    }

    #[test]
    fn where_pixels_are_not_what_takes_the_time_all_of_them_are_drawn() {
        let mut fineness = Fineness::default();
        assert_eq!(moved(&mut fineness, 16.0, |_| 40.0), 1.0);
        // Once the hand has rested it is tried again.
        fineness.rest();
        assert_eq!(moved(&mut fineness, 16.0, |pixels| 30.0 * pixels), 0.65);
    }

    #[test]
    fn a_frame_that_hangs_changes_nothing() {
        let mut fineness = Fineness::default();
        for k in 0..200 {
            fineness.frame(if k % 5 == 0 { 500.0 } else { 9.0 }, 16.0);
        }
        assert_eq!(fineness.share(), 1.0);
    }
}
