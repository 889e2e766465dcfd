//! What the wall does while nobody is there: waits, counts down, goes home, and tours until somebody
//! touches it. No window or engine is needed to let it wait.

use bevy::prelude::Resource;

/// How long the wall waits, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waits {
    /// Without a touch, until the countdown begins.
    pub idle_s: f64,
    /// Of the countdown.
    pub countdown_s: f64,
}

/// What the wall is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doing {
    /// Somebody is there, or was so many seconds ago.
    Waiting { idle_s: f64 },
    /// So many seconds are left to say that one is still there.
    Counting { left_s: f64 },
    /// Nobody is there: stop number `stop`, for so many seconds.
    Touring { stop: usize, seconds: f64 },
}

/// What came of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touched {
    /// Somebody who was there goes on.
    GoesOn,
    /// Somebody who is still there said so: the touch is about that alone.
    Refused,
    /// The tour ends: this visitor begins.
    Woke,
}

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// Everything as the first visitor found it.
    Home,
    /// The tour comes to this stop.
    Stop(usize),
}

/// Whether somebody is there.
#[derive(Resource, Clone, Debug)]
pub struct Attract {
    /// Without them, the wall waits for ever.
    waits: Option<Waits>,
    doing: Doing,
    visited: bool,
}

impl Attract {
    /// Nobody has touched anything yet.
    pub fn new(waits: Option<Waits>) -> Self {
        Self {
            waits,
            doing: Doing::Waiting { idle_s: 0.0 },
            visited: false,
        }
    }

    /// What it is doing.
    pub fn doing(&self) -> Doing {
        self.doing
    }

    /// As another machine does; nothing comes of it here.
    pub fn be(&mut self, doing: Doing) {
        (self.waits, self.doing) = (None, doing);
    }

    /// Whether it tours.
    pub fn is_touring(&self) -> bool {
        matches!(self.doing, Doing::Touring { .. })
    }

    /// Whether somebody has touched it since everything was as the first visitor found it.
    pub fn is_visited(&self) -> bool {
        self.visited
    }

    /// Whole seconds left to say that one is there.
    pub fn countdown(&self) -> Option<u32> {
        match self.doing {
            Doing::Counting { left_s } => Some(left_s.ceil().max(1.0) as u32),
            _ => None,
        }
    }

    /// Somebody touches something.
    pub fn touch(&mut self) -> Touched {
        self.visited = true;
        let was = std::mem::replace(&mut self.doing, Doing::Waiting { idle_s: 0.0 });
        match was {
            Doing::Waiting { .. } => Touched::GoesOn,
            Doing::Counting { .. } => Touched::Refused,
            Doing::Touring { .. } => Touched::Woke,
        }
    }

    /// Whoever was there is sent home: the screens go dark.
    pub fn close(&mut self) {
        (self.doing, self.visited) = (Doing::Waiting { idle_s: 0.0 }, false);
    }

    /// Lets `seconds` pass in which nothing was touched. Nobody is sent home while `busy`: something is
    /// held, or a measurement is being drawn. `stops` are the tour's, in seconds each.
    pub fn advance(&mut self, seconds: f64, busy: bool, stops: &[f64]) -> Vec<Due> {
        let Some(waits) = self.waits else {
            return Vec::new();
        };
        match &mut self.doing {
            Doing::Waiting { idle_s } => {
                *idle_s = if busy { 0.0 } else { *idle_s + seconds };
                if *idle_s >= waits.idle_s {
                    self.doing = Doing::Counting {
                        left_s: waits.countdown_s,
                    };
                }
                Vec::new()
            }
            Doing::Counting { left_s } => {
                *left_s -= seconds;
                if *left_s > 0.0 {
                    return Vec::new();
                }
                self.visited = false;
                self.doing = Doing::Touring {
                    stop: 0,
                    seconds: 0.0,
                };
                match stops.is_empty() {
                    true => vec![Due::Home],
                    false => vec![Due::Home, Due::Stop(0)],
                }
            }
            Doing::Touring { stop, seconds: of } => {
                *of += seconds;
                let Some(lasts) = stops.get(*stop % stops.len().max(1)) else {
                    return Vec::new();
                };
                // A tour of one stop stays there.
                if *of < *lasts || stops.len() < 2 {
                    return Vec::new();
                }
                (*stop, *of) = ((*stop + 1) % stops.len(), 0.0);
                vec![Due::Stop(*stop)]
            }
        }
    }

    /// Seconds until something changes by itself, where `stops` are the tour's; none if never.
    pub fn next_s(&self, stops: &[f64]) -> Option<f64> {
        let waits = self.waits?;
        match self.doing {
            Doing::Waiting { idle_s } => Some((waits.idle_s - idle_s).max(0.0)),
            // Each second is told.
            Doing::Counting { left_s } => Some(left_s - (left_s.ceil() - 1.0).max(0.0)),
            Doing::Touring { stop, seconds } if stops.len() > 1 => {
                let lasts = stops[stop % stops.len()];
                Some((lasts - seconds).max(0.0))
            }
            Doing::Touring { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOPS: [f64; 2] = [8.0, 10.0];

    fn attract() -> Attract {
        Attract::new(Some(Waits {
            idle_s: 60.0,
            countdown_s: 10.0,
        }))
    }

    #[test]
    fn idle_counts_down_goes_home_and_tours() {
        let mut attract = attract();
        assert_eq!(attract.advance(59.9, false, &STOPS), []);
        assert_eq!(attract.countdown(), None);
        attract.advance(0.2, false, &STOPS);
        assert_eq!(attract.countdown(), Some(10));
        attract.advance(9.5, false, &STOPS);
        assert_eq!(attract.countdown(), Some(1));
        let due = attract.advance(0.6, false, &STOPS);
        assert_eq!(due, [Due::Home, Due::Stop(0)]);
        assert!(attract.is_touring());
        assert_eq!(attract.advance(7.9, false, &STOPS), []);
        assert_eq!(attract.advance(0.2, false, &STOPS), [Due::Stop(1)]);
        assert_eq!(attract.advance(10.1, false, &STOPS), [Due::Stop(0)]);
        assert_eq!(attract.touch(), Touched::Woke);
        assert_eq!(attract.doing(), Doing::Waiting { idle_s: 0.0 });
    }

    #[test]
    fn whoever_is_there_refuses_and_whoever_measures_is_left_alone() {
        let mut attract = attract();
        attract.advance(61.0, false, &STOPS);
        assert_eq!(attract.touch(), Touched::Refused);
        assert_eq!(attract.touch(), Touched::GoesOn);
        for _ in 0..100 {
            assert_eq!(attract.advance(30.0, true, &STOPS), []);
        }
        assert_eq!(attract.countdown(), None);
        // Without a tour it goes home all the same, and one without waits never does.
        attract.advance(61.0, false, &[]);
        assert_eq!(attract.advance(11.0, false, &[]), [Due::Home]);
        assert_eq!(attract.advance(1e6, false, &[]), []);
        let mut never = Attract::new(None);
        assert_eq!(never.advance(1e9, false, &STOPS), []);
        assert_eq!((never.countdown(), never.next_s(&STOPS)), (None, None));
    }

    #[test]
    fn it_says_when_it_is_to_be_asked_again() {
        let mut attract = attract();
        let mut asked = 0;
        while !attract.is_touring() {
            let next = attract.next_s(&STOPS).expect("it waits");
            attract.advance(next.max(1e-3), false, &STOPS);
            asked += 1;
            assert!(asked < 20, "{attract:?}");
        }
        assert!(asked >= 11, "each second of the countdown is told");
        assert_eq!(
            attract.next_s(&STOPS),
            Some(STOPS[0]),
            "also where nothing moves"
        );
    }
}
