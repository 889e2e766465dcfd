//! A follower's end: hears snapshots, and asks the leader for its time.

use std::{
    mem,
    sync::Arc,
    thread::JoinHandle,
    time::{Duration, Instant},
};

use serde::{Serialize, de::DeserializeOwned};
use zenoh::{Session, Wait, query::Reply, sample::Sample};

use super::{
    AGAIN, CLOCK, Ear, Line, SNAPSHOTS, Shared, brief, close, configuration, endpoint, held, join,
    missed, open, spawn,
};
use crate::wall::together::{
    clock::{Clock, Estimate, Exchange},
    snapshot::{Answer, Inbox, PROTOCOL, Question, Snapshot, Taken},
};

/// How often time is asked for: quickly at first, then every second.
const FIRST_ASKS: u32 = 8;
const FIRST_ASK: Duration = Duration::from_millis(100);
const ASK: Duration = Duration::from_secs(1);
/// Whoever was woken for a picture and has not taken it is woken again.
const NUDGE: Duration = Duration::from_millis(50);

/// How it is with the leader, as a follower knows it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Followed {
    /// How long ago the leader was heard; `None` if never.
    pub silent_s: Option<f64>,
    /// The newest version that was heard, and the one that is shown.
    pub heard_version: Option<u64>,
    pub shown_version: Option<u64>,
    /// The leader's clock less this one's, and within which bounds, in ms.
    pub clock_offset_ms: Option<f64>,
    pub clock_within_ms: Option<f64>,
}

/// A follower's end.
pub struct Follow<T> {
    shared: Arc<Shared<Post<T>>>,
    thread: Option<JoinHandle<()>>,
}

struct Post<T> {
    inbox: Inbox<T>,
    clock: Clock,
    /// Of whom the clock is.
    term: Option<u64>,
    heard: Option<Instant>,
    newest: Option<(u64, u64)>,
    shown: Option<(u64, u64)>,
    fault: Option<String>,
    /// Somebody was woken for what is due.
    rung: Option<Instant>,
    is_over: bool,
}

impl<T: DeserializeOwned + Send + 'static> Follow<T> {
    /// Calls the leader until it answers, and whenever it is gone. `wake` is called from another thread
    /// when a picture is due.
    pub fn call(line: Line, wake: impl Fn() + Send + Sync + 'static) -> Self {
        let post = Post {
            inbox: Inbox::default(),
            clock: Clock::default(),
            term: None,
            heard: None,
            newest: None,
            shown: None,
            fault: None,
            rung: None,
            is_over: false,
        };
        let shared = Shared::new(line, post);
        let mine = shared.clone();
        let thread = spawn(move || follow(&mine, &wake));
        Self { shared, thread }
    }

    /// The picture that is to be shown now, if it is another than before.
    pub fn due(&self) -> Option<Snapshot<T>> {
        let now = self.shared.watch.now();
        let mut post = held(&self.shared.mail);
        post.rung = None;
        let there = post.there(now);
        post.inbox.due(there)
    }

    /// What became of it: the version of a term that is shown, and why it is not the newest.
    pub fn tell(&self, shown: Option<(u64, u64)>, fault: Option<String>) {
        let mut post = held(&self.shared.mail);
        (post.shown, post.fault) = (shown, fault);
    }

    /// Why what was heard is not shown.
    pub fn fail(&self, fault: String) {
        held(&self.shared.mail).fault = Some(fault);
    }

    /// What is wrong, in words: the leader, or what keeps this one from following it.
    pub fn faults(&self) -> Vec<String> {
        let post = held(&self.shared.mail);
        let line = &self.shared.line;
        let missed = missed(line, &line.lead, post.heard, self.shared.watch.0);
        let missed = missed.map(|missed| format!("{missed}; its last picture stays"));
        missed.or_else(|| post.fault.clone()).into_iter().collect()
    }

    /// Whether the leader is heard.
    pub fn is_heard(&self) -> bool {
        let post = held(&self.shared.mail);
        let heard = post.heard.map(|heard| heard.elapsed());
        heard.is_some_and(|silent| silent < self.shared.line.lost_after)
    }

    /// How it is with the leader.
    pub fn followed(&self) -> Followed {
        let now = self.shared.watch.now();
        let post = held(&self.shared.mail);
        let ms = |us: i64| us as f64 / 1e3;
        let clock = post.clock.estimate(now);
        Followed {
            silent_s: post.heard.map(|heard| heard.elapsed().as_secs_f64()),
            heard_version: post.newest.map(|(_, version)| version),
            shown_version: post.shown.map(|(_, version)| version),
            clock_offset_ms: clock.map(|clock| ms(clock.offset_us)),
            clock_within_ms: clock.map(|clock| ms(clock.within_us)),
        }
    }
}

impl<T> Post<T> {
    /// The leader's time, where its clock is known.
    fn there(&self, now: i64) -> Option<i64> {
        let Estimate { offset_us, .. } = self.clock.estimate(now)?;
        (self.inbox.term() == self.term).then(|| now.saturating_add(offset_us))
    }
}

impl<T> Drop for Follow<T> {
    fn drop(&mut self) {
        held(&self.shared.mail).is_over = true;
        self.shared.news.notify_all();
        join(self.thread.take());
    }
}

fn follow<T: DeserializeOwned + Send + 'static>(shared: &Arc<Shared<Post<T>>>, wake: &dyn Fn()) {
    let line = &shared.line;
    let mut complained = false;
    while !held(&shared.mail).is_over {
        let opened = open(&configuration("", &endpoint(line.address))).and_then(|session| {
            let hearing = shared.clone();
            session
                .declare_subscriber(SNAPSHOTS)
                .callback(move |sample| hear(&hearing, &sample))
                .background()
                .wait()
                .map_err(brief)?;
            Ok(session)
        });
        let session = match opened {
            Ok(session) => session,
            Err(error) => {
                if !mem::replace(&mut complained, true) {
                    let words = format!("no line to {}: {error}", line.address);
                    (line.say)(true, words);
                }
                let post = held(&shared.mail);
                drop(
                    shared
                        .news
                        .wait_timeout_while(post, AGAIN, |post| !post.is_over),
                );
                continue;
            }
        };
        complained = false;
        let mut asks = 0;
        let mut ear = Ear::new();
        let mut next_ask = Instant::now();
        while !session.is_closed() {
            if next_ask <= Instant::now() {
                ask(shared, &session);
                asks += 1;
                next_ask = Instant::now() + if asks < FIRST_ASKS { FIRST_ASK } else { ASK };
            }
            let heard = held(&shared.mail).heard;
            ear.listen(line, &line.lead, heard);
            let post = held(&shared.mail);
            if post.is_over {
                break;
            }
            let mut until = next_ask.saturating_duration_since(Instant::now());
            until = until.min(ear.patience(line));
            let mut rings = false;
            if let Some(at) = post.inbox.next() {
                let now = shared.watch.now();
                let left = post.there(now).map_or(0, |there| at.saturating_sub(there));
                let left = Duration::from_micros(u64::try_from(left).unwrap_or(0));
                let nudge = post.rung.map(|rung| NUDGE.saturating_sub(rung.elapsed()));
                let left = left.max(nudge.unwrap_or_default());
                rings = left.is_zero();
                until = until.min(left);
            }
            if rings {
                let mut post = post;
                post.rung = Some(Instant::now());
                drop(post);
                wake();
            } else {
                // Whatever woke it, it looks again.
                drop(shared.news.wait_timeout(post, until));
            }
        }
        close(&session);
    }
}

fn hear<T: DeserializeOwned>(shared: &Shared<Post<T>>, sample: &Sample) {
    let Some(snapshot) = shared.read::<Snapshot<T>>(sample.payload()) else {
        return;
    };
    let version = (snapshot.term, snapshot.version);
    let mut post = held(&shared.mail);
    let now = shared.watch.now();
    match post.inbox.take_in(snapshot, now) {
        Taken::New => {
            post.heard = Some(Instant::now());
            post.newest = Some(version);
            shared.news.notify_all();
        }
        Taken::Again => post.heard = Some(Instant::now()),
        Taken::Late => {}
    }
}

/// Asks the leader for its time, and says how this machine is.
fn ask<T: Send + 'static>(shared: &Arc<Shared<Post<T>>>, session: &Session) {
    let asked = shared.watch.now();
    let question = {
        let post = held(&shared.mail);
        let clock = post.clock.estimate(asked);
        Question {
            recto: PROTOCOL,
            wall: shared.line.wall.clone(),
            machine: shared.line.machine.clone(),
            asked,
            shown: post.shown,
            fault: post.fault.clone(),
            clock: clock.map(|clock| (clock.offset_us, clock.within_us)),
        }
    };
    let Ok(bytes) = serde_json::to_vec(&question) else {
        return;
    };
    let hearing = shared.clone();
    // Where nobody answers, it asks again.
    let _ = session
        .get(CLOCK)
        .payload(bytes)
        .timeout(ASK)
        .express(true)
        .callback(move |reply| learn(&hearing, &reply))
        .wait();
}

fn learn<T>(shared: &Shared<Post<T>>, reply: &Reply) {
    let answered = shared.watch.now();
    let Ok(sample) = reply.result() else {
        return;
    };
    let Some(answer) = shared.read::<Answer>(sample.payload()) else {
        return;
    };
    let mut post = held(&shared.mail);
    if post.term != Some(answer.term) {
        post.clock.forget();
        post.term = Some(answer.term);
    }
    post.clock.learn(Exchange {
        asked: answer.asked,
        heard: answer.heard,
        said: answer.said,
        answered,
    });
    shared.news.notify_all();
}
