//! Maps read at places in the background: the hand never waits for a file.

use std::{
    panic::{self, AssertUnwindSafe},
    sync::{Arc, Mutex, PoisonError, mpsc},
};

use bevy::prelude::Resource;
use glam::DVec2;

use super::measuring::Said;
use crate::{
    manifest::exhibit::{Exhibit, Scene},
    readings::{Desk, ReadingError, Shelf, Tool, Under, Why},
    stage::{Waker, say},
};

/// What is to be read.
#[derive(Clone, Debug)]
pub enum Errand {
    /// The tool of this number.
    Tool {
        number: u64,
        tool: Tool,
        screen_mm: f64,
    },
    /// What lies at a place; only the last that was asked for counts.
    Under(DVec2),
}

/// What was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    Tool(u64, Said),
    Under(DVec2, Result<Under, Why>),
}

/// An errand with the scene whose side is read.
struct Asked {
    exhibit: Arc<Exhibit>,
    scene: Scene,
    errand: Errand,
}

/// Reads on a thread of its own, which begins with the first errand.
#[derive(Resource, Default)]
pub struct Reader {
    // Ends of channels are not Sync; only one system takes them, and never blocks.
    ends: Option<Mutex<(mpsc::Sender<Asked>, mpsc::Receiver<Answer>)>>,
}

impl Reader {
    /// Asks for something on the side that `scene` shows.
    pub fn ask(&mut self, exhibit: Arc<Exhibit>, scene: Scene, errand: Errand, waker: &Waker) {
        let ends = self.ends.get_or_insert_with(|| {
            let (sender, asked) = mpsc::channel();
            let (answers, receiver) = mpsc::channel();
            let waker = waker.clone();
            std::thread::spawn(move || read_all(&asked, &answers, &waker));
            Mutex::new((sender, receiver))
        });
        let ends = ends.get_mut().unwrap_or_else(PoisonError::into_inner);
        // The thread ends with this end of the channel, and not before.
        let _ = ends.0.send(Asked {
            exhibit,
            scene,
            errand,
        });
    }

    /// Lets go of all maps that were decoded, and of what is still being read.
    pub fn rest(&mut self) {
        self.ends = None;
    }

    /// What was read since the last time.
    pub fn answers(&mut self) -> Vec<Answer> {
        let ends = self.ends.as_mut().map(Mutex::get_mut);
        let ends = ends.map(|ends| ends.unwrap_or_else(PoisonError::into_inner));
        ends.map_or_else(Vec::new, |ends| ends.1.try_iter().collect())
    }
}

fn read_all(asked: &mpsc::Receiver<Asked>, answers: &mpsc::Sender<Answer>, waker: &Waker) {
    // Of one drawing of one version of the exhibit.
    let mut shelf = Shelf::default();
    let mut of: Option<(Arc<Exhibit>, usize)> = None;
    while let Ok(first) = asked.recv() {
        let waiting: Vec<Asked> = std::iter::once(first).chain(asked.try_iter()).collect();
        let is_under = |asked: &Asked| matches!(asked.errand, Errand::Under(_));
        let last_under = waiting.iter().rposition(is_under);
        for (k, asked) in waiting.into_iter().enumerate() {
            if is_under(&asked) && Some(k) != last_under {
                continue;
            }
            let same = of.as_ref().is_some_and(|(exhibit, drawing)| {
                Arc::ptr_eq(exhibit, &asked.exhibit) && *drawing == asked.scene.drawing
            });
            if !same {
                shelf = Shelf::default();
                of = Some((asked.exhibit.clone(), asked.scene.drawing));
            }
            let answer = answer(&asked, &mut shelf);
            if answers.send(answer).is_err() {
                return;
            }
            (waker.0)();
        }
    }
}

fn answer(asked: &Asked, shelf: &mut Shelf) -> Answer {
    let Asked {
        exhibit,
        scene,
        errand,
    } = asked;
    // Visitors are told in short; a file at fault is the curator's.
    let why = |error: &ReadingError| {
        if let ReadingError::Map { path, error } = error {
            say(exhibit.map_fault(path, error));
        }
        Why::from(error)
    };
    let held = std::mem::take(shelf);
    // A file that a decoder trips over is the file's fault, and no reason to go.
    let read = panic::catch_unwind(AssertUnwindSafe(|| {
        let mut desk = Desk::with(exhibit, scene.clone(), held);
        let answer = match errand {
            Errand::Tool {
                number,
                tool,
                screen_mm,
            } => {
                let said = match desk.read(tool, *screen_mm) {
                    Ok(reading) => Said::Read(reading),
                    Err(errors) => Said::Nothing(errors.first().map_or(Why::Nothing, why)),
                };
                Answer::Tool(*number, said)
            }
            Errand::Under(place) => {
                Answer::Under(*place, desk.under(*place).map_err(|error| why(&error)))
            }
        };
        (answer, desk.clear())
    }));
    match read {
        Ok((answer, cleared)) => {
            *shelf = cleared;
            answer
        }
        Err(_) => match errand {
            Errand::Tool { number, .. } => Answer::Tool(*number, Said::Nothing(Why::Unreadable)),
            Errand::Under(place) => Answer::Under(*place, Err(Why::Unreadable)),
        },
    }
}
