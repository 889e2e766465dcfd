//! The line between machines of one wall, over zenoh: the leader puts its newest snapshot on it, followers
//! ask for its time and say how they are.
//!
//! Nothing is looked for on the network: the leader listens at one address, followers call there and
//! listen nowhere. Everything runs on threads of its own. Nobody waits for a slow machine: of snapshots
//! that could not be sent the newest is sent, and what a follower cannot take is dropped on the way.

mod follow;
mod lead;

use std::{
    collections::HashMap,
    mem::{self, Discriminant},
    net::SocketAddr,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use serde::de::DeserializeOwned;
use zenoh::{Session, Wait, bytes::ZBytes};

use super::snapshot::{LONGEST, Refusal, read};

pub use follow::{Follow, Followed};
pub use lead::{Lead, Peer};

/// Where snapshots are put, and where time is asked for.
pub const SNAPSHOTS: &str = "recto/wall/snapshot";
pub const CLOCK: &str = "recto/wall/clock";
/// A line that could not be opened is tried again after so long.
const AGAIN: Duration = Duration::from_secs(2);
/// One kind of complaint is written down as often as this.
const COMPLAIN: Duration = Duration::from_secs(60);

/// Hears what is to be written down: whether it is a fault, and words.
pub type Say = Arc<dyn Fn(bool, String) + Send + Sync>;

/// Whose line it is.
#[derive(Clone)]
pub struct Line {
    /// Of the wall's displays; what other walls say is not listened to.
    pub wall: String,
    /// This machine.
    pub machine: String,
    /// Who may be heard; others are not.
    pub machines: Vec<String>,
    /// The one that is followed.
    pub lead: String,
    /// Where the leader listens.
    pub address: SocketAddr,
    /// After so long without a word somebody is lost.
    pub lost_after: Duration,
    pub say: Say,
}

impl Line {
    fn others(&self) -> impl Iterator<Item = &str> {
        let names = self.machines.iter().map(String::as_str);
        names.filter(|name| *name != self.machine)
    }
}

/// A clock that never goes backwards, in µs since it was made.
#[derive(Clone, Copy, Debug)]
struct Watch(Instant);

impl Watch {
    fn now(self) -> i64 {
        i64::try_from(self.0.elapsed().as_micros()).unwrap_or(i64::MAX)
    }
}

/// Kinds of refusals, each when it was last told of.
#[derive(Default)]
struct Complaints(HashMap<Discriminant<Refusal>, Instant>);

impl Complaints {
    fn are_due(&mut self, refusal: &Refusal) -> bool {
        let now = Instant::now();
        let told = self.0.entry(mem::discriminant(refusal));
        let is_new = matches!(told, std::collections::hash_map::Entry::Vacant(_));
        let last = told.or_insert(now);
        let due = is_new || now.duration_since(*last) >= COMPLAIN;
        if due {
            *last = now;
        }
        due
    }
}

/// Whoever panicked while holding it has left it whole: changes are single assignments.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Somebody who is to be heard, or told of once when they are not.
struct Ear {
    since: Instant,
    is_lost: bool,
}

impl Ear {
    fn new() -> Self {
        Self {
            since: Instant::now(),
            is_lost: false,
        }
    }

    /// How long it is until somebody who is not heard is lost.
    fn patience(&self, line: &Line) -> Duration {
        match self.is_lost {
            true => line.lost_after,
            false => line.lost_after.saturating_sub(self.since.elapsed()),
        }
    }

    /// Looks whether `name` is heard, and says what changed.
    fn listen(&mut self, line: &Line, name: &str, heard: Option<Instant>) {
        let silent = heard.unwrap_or(self.since).elapsed();
        let is_lost = silent >= line.lost_after;
        if is_lost != self.is_lost {
            self.is_lost = is_lost;
            match is_lost {
                true => {
                    let words = format!("{name} has been silent for {} s", silent.as_secs());
                    (line.say)(true, words);
                }
                false => {
                    let gone = self.since.elapsed().as_secs();
                    (line.say)(false, format!("{name} is heard again after {gone} s"));
                }
            }
        }
        if let (false, Some(heard)) = (is_lost, heard) {
            self.since = heard;
        }
    }
}

/// Why somebody is missed, in words.
fn missed(line: &Line, name: &str, heard: Option<Instant>, since: Instant) -> Option<String> {
    let silent = heard.unwrap_or(since).elapsed();
    (silent >= line.lost_after).then(|| match heard {
        Some(_) => format!("{name} has been silent for {} s", silent.as_secs()),
        None => format!("{name} has not been heard yet, for {} s", silent.as_secs()),
    })
}

struct Shared<M> {
    watch: Watch,
    mail: Mutex<M>,
    news: Condvar,
    complaints: Mutex<Complaints>,
    line: Line,
}

impl<M> Shared<M> {
    fn new(line: Line, mail: M) -> Arc<Self> {
        Arc::new(Self {
            watch: Watch(Instant::now()),
            mail: Mutex::new(mail),
            news: Condvar::new(),
            complaints: Mutex::default(),
            line,
        })
    }

    fn read<R: DeserializeOwned>(&self, payload: &ZBytes) -> Option<R> {
        // What is too long is not even put together.
        let read = match payload.len() {
            len if len > LONGEST => Err(Refusal::Long(len)),
            _ => read(&payload.to_bytes(), &self.line.wall),
        };
        read.map_err(|refusal| self.refuse(&refusal)).ok()
    }

    fn refuse(&self, refusal: &Refusal) {
        if held(&self.complaints).are_due(refusal) {
            let words = format!("not listened to: {refusal}");
            (self.line.say)(true, words);
        }
    }
}

fn spawn(run: impl FnOnce() + Send + 'static) -> Option<JoinHandle<()>> {
    // Without a thread the wall goes on alone, and followers tell of it.
    thread::Builder::new()
        .name("together".to_owned())
        .spawn(run)
        .ok()
}

fn join(thread: Option<JoinHandle<()>>) {
    if let Some(thread) = thread {
        // One that panicked has said so.
        let _ = thread.join();
    }
}

/// In one line, without the places in sources that zenoh names.
fn brief(error: zenoh::Error) -> String {
    let words = error.to_string();
    let end = words.find(" at /").unwrap_or(words.len());
    // What is opened there is closed.
    words[..end].replace(['[', '\n'], " ").trim().to_owned()
}

/// Opens a line; told of once, and again when it works.
fn open(configuration: &str) -> Result<Session, String> {
    let configuration = zenoh::Config::from_json5(configuration).map_err(brief)?;
    zenoh::open(configuration).wait().map_err(brief)
}

/// What leader and followers have in common: no scouting, no gossip, no administration, small messages.
fn configuration(listen: &str, connect: &str) -> String {
    // Whoever reaches the leader may ask it, and says nothing in its name.
    let mute = "{ enabled: true, default_permission: 'allow',
        rules: [{ id: 'mute', permission: 'deny', messages: ['put', 'delete'],
            flows: ['ingress'], key_exprs: ['**'] }],
        subjects: [{ id: 'all' }],
        policies: [{ rules: ['mute'], subjects: ['all'] }] }";
    let control = if listen.is_empty() { "{}" } else { mute };
    format!(
        "{{ mode: 'peer',
            listen: {{ endpoints: [{listen}], exit_on_failure: true, timeout_ms: 0 }},
            connect: {{ endpoints: [{connect}], exit_on_failure: false, timeout_ms: -1,
                retry: {{ period_init_ms: 200, period_max_ms: 1000, period_increase_factor: 2 }} }},
            scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }},
            adminspace: {{ enabled: false }},
            access_control: {control},
            transport: {{
                unicast: {{ max_sessions: 64, accept_pending: 16 }},
                link: {{ tx: {{ lease: 3000 }}, rx: {{ max_message_size: 1048576 }} }} }} }}"
    )
}

fn endpoint(address: SocketAddr) -> String {
    format!("'tcp/{address}'")
}

fn close(session: &Session) {
    // It is gone either way.
    let _ = session.close().wait();
}
