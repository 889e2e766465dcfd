//! Wakes a window that rests when something is due: resting, it draws nothing and asks for nothing.

use std::{
    sync::{Mutex, PoisonError, mpsc},
    thread,
    time::Duration,
};

use bevy::prelude::Resource;

use crate::stage::Waker;

/// Whoever is not woken is called again after so long.
const AGAIN: Duration = Duration::from_millis(500);
/// Sooner, a window that draws would not yet rest.
const LEAST: Duration = Duration::from_millis(30);

/// One alarm, which is set anew each time.
#[derive(Resource)]
pub struct Alarm(Mutex<mpsc::Sender<Option<Duration>>>);

impl Alarm {
    /// Wakes by `waker`.
    pub fn new(waker: Waker) -> Self {
        let (sender, receiver) = mpsc::channel::<Option<Duration>>();
        thread::spawn(move || {
            let mut due = None;
            loop {
                let heard = match due {
                    Some(after) => receiver.recv_timeout(after),
                    None => receiver
                        .recv()
                        .map_err(|_| mpsc::RecvTimeoutError::Disconnected),
                };
                match heard {
                    Ok(after) => due = after,
                    Err(mpsc::RecvTimeoutError::Timeout) => {
                        // A window that was just about to rest may sleep on: each frame that it draws sets
                        // the alarm anew.
                        due = Some(AGAIN);
                        (waker.0)();
                    }
                    Err(mpsc::RecvTimeoutError::Disconnected) => return,
                }
            }
        });
        Self(Mutex::new(sender))
    }

    /// Rings after so long, and not when it was to ring before.
    pub fn set(&self, after: Option<Duration>) {
        let after = after.map(|after| after.max(LEAST));
        let sender = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // Without its thread nobody is woken, who is closing then.
        let _ = sender.send(after);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    };

    use super::*;

    #[test]
    fn only_the_last_time_counts_and_it_rings_until_somebody_wakes() {
        let rung = Arc::new(AtomicUsize::new(0));
        let counted = rung.clone();
        let alarm = Alarm::new(Waker(Arc::new(move || {
            counted.fetch_add(1, Ordering::SeqCst);
        })));
        alarm.set(Some(Duration::from_millis(50)));
        alarm.set(None);
        thread::sleep(Duration::from_millis(200));
        assert_eq!(rung.load(Ordering::SeqCst), 0);
        alarm.set(Some(Duration::ZERO));
        while rung.load(Ordering::SeqCst) < 2 {
            thread::sleep(Duration::from_millis(5));
        }
        alarm.set(None);
        // One ring may be on its way.
        thread::sleep(LEAST);
        let before = rung.load(Ordering::SeqCst);
        thread::sleep(2 * AGAIN);
        assert_eq!(
            rung.load(Ordering::SeqCst),
            before,
            "whoever is awake is left alone"
        );
    }
}
