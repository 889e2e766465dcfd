//! The leader's end: puts snapshots on the line, and answers those that follow.

use std::{
    collections::BTreeMap,
    mem,
    sync::{Arc, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use serde::Serialize;
use zenoh::{
    Session, Wait,
    qos::{CongestionControl, Priority},
    query::Query,
};

use super::{
    AGAIN, CLOCK, Ear, Line, SNAPSHOTS, Shared, brief, close, configuration, endpoint, held, join,
    missed, open, spawn,
};
use crate::wall::together::snapshot::{Answer, PROTOCOL, Question, Snapshot, Which};

/// The newest snapshot is said again as often as this: whoever was away has it by then.
const BEAT: Duration = Duration::from_millis(500);
/// Between two snapshots at least; no display draws more often.
const BREATH: Duration = Duration::from_millis(4);

/// A follower as the leader knows it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peer {
    pub machine: String,
    /// How long ago it was heard; `None` if never.
    pub silent_s: Option<f64>,
    /// How many versions it is behind.
    pub behind: Option<u64>,
    /// Of its clock and the leader's, and within which bounds, in ms.
    pub clock_offset_ms: Option<f64>,
    pub clock_within_ms: Option<f64>,
    /// Why it shows something else.
    pub fault: Option<String>,
}

/// The leader's end.
pub struct Lead<T> {
    shared: Arc<Shared<Outbox<T>>>,
    delay_us: i64,
    thread: Option<JoinHandle<()>>,
}

struct Outbox<T> {
    term: u64,
    version: u64,
    latest: Option<Snapshot<T>>,
    is_fresh: bool,
    is_over: bool,
    fault: Option<String>,
    heard: BTreeMap<String, (Instant, Question)>,
}

impl<T: Clone + Serialize + Send + 'static> Lead<T> {
    /// Listens, and goes on trying where it cannot. Followers show each picture `delay` later than the
    /// leader.
    pub fn listen(line: Line, delay: Duration) -> Self {
        let outbox = Outbox {
            term: term(),
            version: 0,
            latest: None,
            is_fresh: false,
            is_over: false,
            fault: None,
            heard: BTreeMap::new(),
        };
        let shared = Shared::new(line, outbox);
        let mine = shared.clone();
        let thread = spawn(move || lead(&mine));
        Self {
            shared,
            delay_us: i64::try_from(delay.as_micros()).unwrap_or(0),
            thread,
        }
    }

    /// What is shown from now on. Nobody is waited for.
    pub fn show(&self, exhibit: Which, told: T) {
        let at = self.shared.watch.now() + self.delay_us;
        let mut outbox = held(&self.shared.mail);
        outbox.version += 1;
        outbox.latest = Some(Snapshot {
            recto: PROTOCOL,
            wall: self.shared.line.wall.clone(),
            term: outbox.term,
            version: outbox.version,
            at,
            exhibit,
            told,
        });
        outbox.is_fresh = true;
        self.shared.news.notify_all();
    }

    /// The version that is shown.
    pub fn version(&self) -> u64 {
        held(&self.shared.mail).version
    }

    /// What is wrong, in words: with the line, and with each of those that are to follow.
    pub fn faults(&self) -> Vec<String> {
        let outbox = held(&self.shared.mail);
        let mut faults: Vec<String> = outbox.fault.iter().cloned().collect();
        let line = &self.shared.line;
        for name in line.others() {
            let heard = outbox.heard.get(name);
            let then = heard.map(|(then, _)| *then);
            let missed = missed(line, name, then, self.shared.watch.0);
            let own = heard.and_then(|(_, question)| question.fault.clone());
            let own = own.map(|fault| format!("{name}: {fault}"));
            faults.extend(missed.or(own));
        }
        faults
    }

    /// Those that are to follow.
    pub fn peers(&self) -> Vec<Peer> {
        let outbox = held(&self.shared.mail);
        let ms = |us: i64| us as f64 / 1e3;
        let peer = |name: &str| {
            let heard = outbox.heard.get(name);
            let question = heard.map(|(_, question)| question);
            let clock = question.and_then(|question| question.clock);
            let shown = question.and_then(|question| question.shown);
            Peer {
                machine: name.to_owned(),
                silent_s: heard.map(|(then, _)| then.elapsed().as_secs_f64()),
                behind: shown
                    .filter(|(term, _)| *term == outbox.term)
                    .map(|(_, version)| outbox.version.saturating_sub(version)),
                clock_offset_ms: clock.map(|(offset, _)| ms(offset)),
                clock_within_ms: clock.map(|(_, within)| ms(within)),
                fault: question.and_then(|question| question.fault.clone()),
            }
        };
        self.shared.line.others().map(peer).collect()
    }
}

impl<T> Drop for Lead<T> {
    fn drop(&mut self) {
        held(&self.shared.mail).is_over = true;
        self.shared.news.notify_all();
        join(self.thread.take());
    }
}

/// One run of a leader, unlike any other.
fn term() -> u64 {
    use std::hash::{BuildHasher, RandomState};
    RandomState::new().hash_one(std::process::id())
}

fn lead<T: Clone + Serialize + Send + 'static>(shared: &Arc<Shared<Outbox<T>>>) {
    let line = &shared.line;
    let mut complained = false;
    while !held(&shared.mail).is_over {
        let opened = open(&configuration(&endpoint(line.address), "")).and_then(|session| {
            let answering = shared.clone();
            session
                .declare_queryable(CLOCK)
                .callback(move |query| answer(&answering, &query))
                .background()
                .wait()
                .map_err(brief)?;
            Ok(session)
        });
        match opened {
            Ok(session) => {
                if mem::replace(&mut complained, false) {
                    (line.say)(
                        false,
                        format!("other machines are reached at {}", line.address),
                    );
                }
                held(&shared.mail).fault = None;
                if let Err(error) = put(shared, &session) {
                    (line.say)(true, format!("other machines are not reached: {error}"));
                }
                close(&session);
            }
            Err(error) => {
                let words = format!(
                    "other machines are not reached, as nothing can listen at {}: {error}",
                    line.address
                );
                held(&shared.mail).fault = Some(words.clone());
                if !mem::replace(&mut complained, true) {
                    (line.say)(true, words);
                }
                let outbox = held(&shared.mail);
                let waited = shared
                    .news
                    .wait_timeout_while(outbox, AGAIN, |outbox| !outbox.is_over);
                drop(waited);
            }
        }
    }
}

/// Puts snapshots on the line until the end, or until the line is broken.
fn put<T: Clone + Serialize>(
    shared: &Shared<Outbox<T>>,
    session: &Session,
) -> Result<(), zenoh::Error> {
    let publisher = session
        .declare_publisher(SNAPSHOTS)
        .congestion_control(CongestionControl::Drop)
        .priority(Priority::RealTime)
        .express(true)
        .wait()?;
    let others = shared.line.others();
    let mut ears: Vec<(&str, Ear)> = others.map(|name| (name, Ear::new())).collect();
    loop {
        for (name, ear) in &mut ears {
            let heard = held(&shared.mail).heard.get(*name).map(|(then, _)| *then);
            ear.listen(&shared.line, name, heard);
        }
        let latest = {
            let outbox = held(&shared.mail);
            let waited = shared
                .news
                .wait_timeout_while(outbox, BEAT, |outbox| !outbox.is_fresh && !outbox.is_over);
            let (mut outbox, _) = waited.unwrap_or_else(PoisonError::into_inner);
            if outbox.is_over {
                return Ok(());
            }
            outbox.is_fresh = false;
            outbox.latest.clone()
        };
        if let Some(bytes) = latest.and_then(|latest| serde_json::to_vec(&latest).ok()) {
            publisher.put(bytes).wait()?;
        }
        if session.is_closed() {
            return Ok(());
        }
        thread::sleep(BREATH);
    }
}

fn answer<T>(shared: &Shared<Outbox<T>>, query: &Query) {
    let heard = shared.watch.now();
    let Some(payload) = query.payload() else {
        return;
    };
    let Some(question) = shared.read::<Question>(payload) else {
        return;
    };
    let asked = question.asked;
    let term = {
        let mut outbox = held(&shared.mail);
        if shared.line.machines.contains(&question.machine) {
            if question.shown != Some((outbox.term, outbox.version)) {
                // It may have been away.
                outbox.is_fresh = true;
                shared.news.notify_all();
            }
            let machine = question.machine.clone();
            outbox.heard.insert(machine, (Instant::now(), question));
        }
        outbox.term
    };
    let answer = Answer {
        recto: PROTOCOL,
        wall: shared.line.wall.clone(),
        term,
        asked,
        heard,
        said: shared.watch.now(),
    };
    if let Ok(bytes) = serde_json::to_vec(&answer) {
        // Whoever asked asks again.
        let _ = query.reply(CLOCK, bytes).express(true).wait();
    }
}
