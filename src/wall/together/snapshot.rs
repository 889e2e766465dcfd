//! What the leader says of its picture, and which of it a follower shows when.
//!
//! A *term* is one run of the leader's program; within it versions count up. What is older than what was
//! heard is never shown, and of what is due only the newest.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// The form of messages. Whoever speaks another one is not listened to.
pub const PROTOCOL: u32 = 1;
/// A longer message is none of ours: a snapshot has about two kilobytes.
pub const LONGEST: usize = 256 * 1024;
/// So many snapshots wait for their time.
const MOST: usize = 64;
/// A leader that was heard within this time, in µs, is not given up for another one.
const FAITHFUL_US: i64 = 1_500_000;
/// No snapshot is meant for later than this, in µs: whoever says so has another clock.
const LATEST_US: i64 = 2_000_000;

/// Which exhibit, of which version.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Which {
    /// Its place among the folders of the installation.
    pub turn: usize,
    /// Of its manifest and its files, the same wherever they lie.
    pub print: String,
}

/// One picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot<T> {
    pub recto: u32,
    /// Whose displays they are; other walls have others.
    pub wall: String,
    pub term: u64,
    pub version: u64,
    /// When it is to be shown, in µs of the leader's clock.
    pub at: i64,
    pub exhibit: Which,
    pub told: T,
}

/// A question of a follower, with what it says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Question {
    pub recto: u32,
    pub wall: String,
    /// The name of the machine.
    pub machine: String,
    /// By its own clock, in µs.
    pub asked: i64,
    /// The version that it shows, of which term.
    pub shown: Option<(u64, u64)>,
    /// Why it shows another.
    pub fault: Option<String>,
    /// How far it is from the leader's clock, and within which bounds, in µs.
    pub clock: Option<(i64, i64)>,
}

/// The leader's answer, by its clock in µs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    pub recto: u32,
    pub wall: String,
    pub term: u64,
    pub asked: i64,
    pub heard: i64,
    pub said: i64,
}

/// Why a message is not listened to.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    #[error("a message of {0} bytes, where {LONGEST} are the most")]
    Long(usize),
    #[error("a message that is none of Recto's")]
    Strange,
    #[error(
        "a message of protocol {0}, where {PROTOCOL} is spoken here; bring both machines to one version of Recto"
    )]
    Protocol(u32),
    #[error("a message of another wall; give all machines the same installation file")]
    Wall,
}

/// What every message says of itself.
#[derive(Deserialize)]
struct Head {
    recto: u32,
    #[serde(default)]
    wall: String,
}

/// Reads a message of this wall.
///
/// # Errors
/// [`Refusal`], the version of the protocol before anything else of it.
pub fn read<M: DeserializeOwned>(bytes: &[u8], wall: &str) -> Result<M, Refusal> {
    if bytes.len() > LONGEST {
        return Err(Refusal::Long(bytes.len()));
    }
    let head: Head = serde_json::from_slice(bytes).map_err(|_| Refusal::Strange)?;
    if head.recto != PROTOCOL {
        return Err(Refusal::Protocol(head.recto));
    }
    if head.wall != wall {
        return Err(Refusal::Wall);
    }
    serde_json::from_slice(bytes).map_err(|_| Refusal::Strange)
}

/// What became of a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It waits for its time.
    New,
    /// It is the newest that is known, said once more.
    Again,
    /// Something newer is known.
    Late,
}

/// Snapshots that wait for their time.
#[derive(Clone, Debug)]
pub struct Inbox<T> {
    term: Option<u64>,
    /// The newest version of this term, and when it was heard, in µs of the clock here.
    version: u64,
    heard: i64,
    waiting: VecDeque<Snapshot<T>>,
}

impl<T> Default for Inbox<T> {
    fn default() -> Self {
        Self {
            term: None,
            version: 0,
            heard: 0,
            waiting: VecDeque::new(),
        }
    }
}

impl<T> Inbox<T> {
    /// Takes in what came at `now` (µs of the clock here). Another term is that of a leader that began
    /// anew, which is followed once the one before is silent: clocks do not say which of two is newer.
    pub fn take_in(&mut self, snapshot: Snapshot<T>, now: i64) -> Taken {
        if self.term != Some(snapshot.term) {
            if self.term.is_some() && now.saturating_sub(self.heard) < FAITHFUL_US {
                return Taken::Late;
            }
            self.term = Some(snapshot.term);
            self.waiting.clear();
        } else if snapshot.version < self.version {
            return Taken::Late;
        } else if snapshot.version == self.version {
            self.heard = now;
            return Taken::Again;
        }
        (self.version, self.heard) = (snapshot.version, now);
        self.waiting.push_back(snapshot);
        if self.waiting.len() > MOST {
            self.waiting.pop_front();
        }
        Taken::New
    }

    /// The newest that is due at `now` (µs of the leader's clock); while that clock is not known, the
    /// newest of all. Those before it are never shown.
    pub fn due(&mut self, now: Option<i64>) -> Option<Snapshot<T>> {
        let is_due = |snapshot: &Snapshot<T>| match now {
            Some(now) => snapshot.at <= now || snapshot.at.saturating_sub(now) > LATEST_US,
            None => true,
        };
        let last = self.waiting.iter().rposition(is_due)?;
        self.waiting.drain(..=last).next_back()
    }

    /// When the next one is due, in µs of the leader's clock.
    pub fn next(&self) -> Option<i64> {
        self.waiting.front().map(|snapshot| snapshot.at)
    }

    /// The run of the leader that is followed.
    pub fn term(&self) -> Option<u64> {
        self.term
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WALL: &str = "0123456789abcdef";

    fn snapshot(term: u64, version: u64, at: i64) -> Snapshot<u32> {
        Snapshot {
            recto: PROTOCOL,
            wall: WALL.into(),
            term,
            version,
            at,
            exhibit: Which::default(),
            told: 7,
        }
    }

    #[test]
    fn a_snapshot_comes_as_it_went() {
        let went = snapshot(u64::MAX, 3, i64::MIN);
        let bytes = serde_json::to_vec(&went).unwrap();
        assert_eq!(read::<Snapshot<u32>>(&bytes, WALL), Ok(went));
    }

    #[test]
    fn what_is_none_of_ours_is_refused_in_words() {
        let sound = serde_json::to_string(&snapshot(1, 1, 0)).unwrap();
        let other = sound.replace("\"recto\":1", "\"recto\":2");
        let read = |text: &str| read::<Snapshot<u32>>(text.as_bytes(), WALL).unwrap_err();
        assert_eq!(read(&other), Refusal::Protocol(2));
        // Whatever else another version says.
        assert_eq!(read("{\"recto\":9,\"new\":[1]}"), Refusal::Protocol(9));
        assert_eq!(read(&sound.replace(WALL, "another")), Refusal::Wall);
        assert_eq!(read(&" ".repeat(LONGEST + 1)), Refusal::Long(LONGEST + 1));
        for strange in [
            "",
            "{",
            "[]",
            "nonsense",
            "{\"recto\":-1}",
            "{\"recto\":1e9}",
            "\u{0}\u{1}",
        ] {
            assert_eq!(read(strange), Refusal::Strange, "{strange}");
        }
        assert_eq!(read(&sound.replace(":7", ":\"x\"")), Refusal::Strange);
        assert_eq!(read(&"[".repeat(LONGEST)), Refusal::Strange, "deep");
    }

    #[test]
    fn what_is_late_is_never_shown_and_of_what_is_due_the_newest() {
        let mut inbox = Inbox::default();
        assert_eq!(inbox.due(None), None);
        for (version, at) in [(1, 100), (2, 200), (4, 400)] {
            assert_eq!(inbox.take_in(snapshot(5, version, at), 0), Taken::New);
        }
        assert_eq!(inbox.take_in(snapshot(5, 3, 300), 0), Taken::Late);
        assert_eq!(inbox.take_in(snapshot(5, 4, 400), 0), Taken::Again);
        assert_eq!(inbox.due(Some(99)), None);
        assert_eq!(inbox.next(), Some(100));
        let shown = inbox.due(Some(250)).unwrap();
        assert_eq!(shown.version, 2, "the first was passed over");
        assert_eq!(inbox.due(Some(250)), None);
        assert_eq!(inbox.due(Some(400)).unwrap().version, 4);
        let late = inbox.take_in(snapshot(5, 2, 900), 0);
        assert_eq!(late, Taken::Late, "also when all is shown");
    }

    #[test]
    fn a_leader_that_begins_anew_is_followed_and_never_two_at_once() {
        let mut inbox = Inbox::default();
        inbox.take_in(snapshot(9, 1000, 0), 0);
        inbox.take_in(snapshot(9, 1000, 0), 1_000_000);
        let other = |inbox: &mut Inbox<u32>, now| inbox.take_in(snapshot(3, 1, 5), now);
        assert_eq!(
            other(&mut inbox, 2_000_000),
            Taken::Late,
            "the first still speaks"
        );
        assert_eq!(other(&mut inbox, 2_600_000), Taken::New);
        assert_eq!(inbox.take_in(snapshot(9, 1001, 0), 2_700_000), Taken::Late);
        assert_eq!(inbox.due(None).unwrap().term, 3);
    }

    #[test]
    fn a_flood_fills_no_memory_and_a_strange_clock_stops_nothing() {
        let mut inbox = Inbox::default();
        for version in 1..10_000 {
            inbox.take_in(snapshot(1, version, 1_000_000), 0);
        }
        assert!(inbox.waiting.len() <= MOST);
        assert_eq!(inbox.due(Some(1_000_000)).unwrap().version, 9_999);
        // A time that is centuries away is no time to wait for.
        inbox.take_in(snapshot(1, 10_000, i64::MAX), 0);
        assert_eq!(inbox.due(Some(0)).unwrap().version, 10_000);
    }
}
