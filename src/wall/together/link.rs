//! The line between machines of one wall, over zenoh: the leader puts its newest snapshot on it, followers
//! ask for its time and say how they are.
//!
//! Nothing is looked for on the network: the leader listens at one address, followers call there and
//! listen nowhere. Everything runs on threads of its own. Nobody waits for a slow machine: of snapshots
//! that could not be sent the newest is sent, and what a follower cannot take is dropped on the way.

use std::{
    collections::{BTreeMap, HashMap},
    mem::{self, Discriminant},
    net::SocketAddr,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use serde::{Serialize, de::DeserializeOwned};
use zenoh::{
    Session, Wait,
    bytes::ZBytes,
    qos::{CongestionControl, Priority},
    query::{Query, Reply},
    sample::Sample,
};

use super::{
    clock::{Clock, Estimate, Exchange},
    snapshot::{Answer, Inbox, PROTOCOL, Question, Refusal, Snapshot, Taken, Which, read},
};

/// Where snapshots are put, and where time is asked for.
pub const SNAPSHOTS: &str = "recto/wall/snapshot";
pub const CLOCK: &str = "recto/wall/clock";
/// The newest snapshot is said again as often as this: whoever was away has it by then.
const BEAT: Duration = Duration::from_millis(500);
/// Between two snapshots at least; no display draws more often.
const BREATH: Duration = Duration::from_millis(4);
/// How often time is asked for: quickly at first, then every second.
const FIRST_ASKS: u32 = 8;
const FIRST_ASK: Duration = Duration::from_millis(100);
const ASK: Duration = Duration::from_secs(1);
/// A line that could not be opened is tried again after so long.
const AGAIN: Duration = Duration::from_secs(2);
/// Whoever was woken for a picture and has not taken it is woken again.
const NUDGE: Duration = Duration::from_millis(50);
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
            len if len > super::snapshot::LONGEST => Err(Refusal::Long(len)),
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

fn close(session: &Session) {
    // It is gone either way.
    let _ = session.close().wait();
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
