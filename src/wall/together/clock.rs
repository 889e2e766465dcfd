//! An agreed time: how far another machine's clock is ahead of this one, and how sure that is.
//!
//! A question is asked and answered, and both sides say when (Mills 1991, eq. 1 and 2, as in NTP). However
//! unequal the two ways are, the true offset lies within half of the time that was spent on them.

use std::collections::VecDeque;

/// Clocks of two machines drift apart by less: twice the 50 ppm that a usual quartz is allowed.
const DRIFT: f64 = 100e-6;
/// So many exchanges are remembered.
const MOST: usize = 16;

/// One question and its answer, each time in µs of its machine's own clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// Here, when it was asked.
    pub asked: i64,
    /// There, when it was heard.
    pub heard: i64,
    /// There, when it was answered.
    pub said: i64,
    /// Here, when the answer came.
    pub answered: i64,
}

/// How far the other clock is ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Theirs less ours, in µs.
    pub offset_us: i64,
    /// The true offset is no farther away than this, in µs.
    pub within_us: i64,
}

impl Exchange {
    /// What it says; `None` where its times run backwards.
    pub fn estimate(&self) -> Option<Estimate> {
        let there = self.said.checked_sub(self.heard)?;
        let both_ways = self.answered.checked_sub(self.asked)?.checked_sub(there)?;
        if there < 0 || both_ways < 0 {
            return None;
        }
        let out = self.heard.checked_sub(self.asked)?;
        let back = self.said.checked_sub(self.answered)?;
        Some(Estimate {
            offset_us: out.checked_add(back)? / 2,
            // Halves are rounded, and clocks are read to the µs.
            within_us: both_ways / 2 + 2,
        })
    }
}

/// The exchanges of late.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    exchanges: VecDeque<(i64, Estimate)>,
}

impl Clock {
    /// Learns from an exchange; one whose times run backwards teaches nothing.
    pub fn learn(&mut self, exchange: Exchange) {
        if let Some(estimate) = exchange.estimate() {
            self.exchanges.push_back((exchange.answered, estimate));
            if self.exchanges.len() > MOST {
                self.exchanges.pop_front();
            }
        }
    }

    /// The other clock has begun anew.
    pub fn forget(&mut self) {
        self.exchanges.clear();
    }

    /// The surest of what is known, at `now` (µs of the clock here): an exchange that was quick, and not
    /// long ago. `None` before the first.
    pub fn estimate(&self, now: i64) -> Option<Estimate> {
        let aged = |(then, estimate): &(i64, Estimate)| Estimate {
            within_us: estimate.within_us
                + (now.saturating_sub(*then).max(0) as f64 * DRIFT) as i64,
            ..*estimate
        };
        self.exchanges
            .iter()
            .map(aged)
            .min_by_key(|estimate| estimate.within_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An exchange with a clock that is ahead by `offset`, after ways of so many µs.
    fn exchange(asked: i64, offset: i64, out: i64, back: i64) -> Exchange {
        let heard = asked + out + offset;
        let said = heard + 40;
        Exchange {
            asked,
            heard,
            said,
            answered: said - offset + back,
        }
    }

    fn misses(estimate: Estimate, offset: i64) -> bool {
        (estimate.offset_us - offset).abs() > estimate.within_us
    }

    #[test]
    fn however_unequal_the_ways_the_truth_is_within_what_is_stated() {
        for offset in [-86_400_000_000, -7, 0, 3_000, 5_000_000_001] {
            for (out, back) in [(0, 0), (200, 200), (9_000, 100), (0, 30_000), (45_001, 2)] {
                let estimate = exchange(1_000, offset, out, back).estimate().unwrap();
                assert!(
                    !misses(estimate, offset),
                    "{offset} {out} {back}: {estimate:?}"
                );
            }
        }
        // Who takes one way alone for the offset, and states the same, is wrong.
        let unequal = exchange(0, 3_000, 30_000, 0);
        let naive = Estimate {
            offset_us: unequal.heard - unequal.asked,
            ..unequal.estimate().unwrap()
        };
        assert!(misses(naive, 3_000), "the test can fail");
    }

    #[test]
    fn the_surest_exchange_counts_until_it_is_old() {
        let mut clock = Clock::default();
        assert_eq!(clock.estimate(0), None);
        clock.learn(exchange(0, 500, 8_000, 1_000));
        clock.learn(exchange(1_000_000, 500, 100, 120));
        clock.learn(exchange(2_000_000, 500, 20_000, 100));
        let best = clock.estimate(2_100_000).unwrap();
        assert!(best.within_us < 250 && !misses(best, 500), "{best:?}");
        // An hour later it may have drifted by more than the slow one's doubt.
        let later = clock.estimate(3_600_000_000).unwrap();
        assert!(later.within_us > 300_000, "{later:?}");
        for k in 0..100 {
            clock.learn(exchange(4_000_000_000 + k, 900, 5_000, 5_000));
        }
        assert!(clock.exchanges.len() <= MOST);
        assert!(!misses(clock.estimate(4_000_100_000).unwrap(), 900));
    }

    #[test]
    fn times_that_run_backwards_teach_nothing() {
        let mut clock = Clock::default();
        let sound = exchange(0, 0, 10, 10);
        for broken in [
            Exchange {
                answered: -1,
                ..sound
            },
            Exchange {
                said: i64::MIN,
                ..sound
            },
            Exchange {
                heard: i64::MAX,
                ..sound
            },
            Exchange {
                asked: i64::MIN,
                answered: i64::MAX,
                ..sound
            },
        ] {
            clock.learn(broken);
        }
        assert_eq!(clock.estimate(0), None);
    }
}
