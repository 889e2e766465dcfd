//! Several machines of one wall: one leads, with touch and state, the others show what it says.
//!
//! | step | where |
//! |---|---|
//! | what is shown, whole, with a version and a time | [`snapshot`], [`Told`] |
//! | whose time that is | [`clock`] |
//! | from machine to machine | [`link`] |
//! | a window that leads, or is led | here |
//!
//! The leader shows its picture at once, as a hand waits for it; a snapshot goes to the others in the same
//! frame, to be shown a stated time later. They draw the same picture over the whole wall as it does, each
//! with its own displays' part of it, so that nothing but the snapshot has to agree. One that hears nothing
//! keeps its picture.

pub mod clock;
pub mod link;
pub mod snapshot;

use std::{
    collections::hash_map::DefaultHasher,
    fs,
    hash::{Hash, Hasher},
    path::{Path, PathBuf},
    sync::{Arc, Weak},
    time::Duration,
};

use bevy::prelude::*;
use serde::Serialize;

use super::{
    health::Health,
    journal::{Journal, Level},
};
use crate::{
    installation::{Installation, Machine},
    manifest::exhibit::Exhibit,
    stage::{
        StageSet, Waker,
        reload::{self, Reread},
    },
    visitor::{
        Hand,
        mirror::{Led, Told, Unfollowed},
    },
};
use link::{Follow, Followed, Lead, Line, Peer};
use snapshot::{Snapshot, Which};

/// An exhibit that is not the leader's is looked at again after so long.
const LOOK_AGAIN: Duration = Duration::from_secs(2);

/// Who this machine is among others, for the status.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Standing {
    pub machine: String,
    pub role: Role,
    pub address: String,
    /// What the leader knows of those that follow.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub followers: Vec<Peer>,
    /// What a follower knows of the leader.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leader: Option<Followed>,
    #[serde(skip)]
    pub faults: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    Leads,
    Follows,
}

/// What a machine needs to be one of several.
pub struct Party {
    pub machine: Machine,
    /// Of the wall, as [`wall_print`].
    pub wall: String,
    /// The exhibits of the installation.
    pub folders: Vec<PathBuf>,
    pub journal: Journal,
    pub health: Arc<Health>,
}

/// The exhibit that is shown, by its place among those of the installation.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turn(pub usize);

#[derive(Resource)]
struct Leading {
    lead: Arc<Lead<Told>>,
    last: Option<(Arc<Exhibit>, Told)>,
    which: Which,
}

/// A machine that follows.
#[derive(Resource)]
pub struct Following {
    follow: Arc<Follow<Told>>,
    folders: Vec<PathBuf>,
    /// What is to be shown.
    wanted: Option<Snapshot<Told>>,
    /// What the exhibit is that is held, and its print.
    held: Option<(Arc<Exhibit>, String)>,
    /// Since the last look at an exhibit that is not the leader's.
    looked: Option<Duration>,
    journal: Journal,
    told: Option<String>,
}

impl Following {
    /// Whether the leader's screens are dark, while it is heard.
    pub fn is_dark(&self) -> Option<bool> {
        let wanted = self.wanted.as_ref().filter(|_| self.follow.is_heard())?;
        Some(wanted.told.is_dark())
    }

    /// When it wants to be asked again.
    pub fn due(&self) -> Option<Duration> {
        self.looked.map(|_| LOOK_AGAIN)
    }

    /// How it is with the leader.
    pub fn followed(&self) -> Followed {
        self.follow.followed()
    }
}

/// Makes `app` one of several.
pub fn join(app: &mut App, party: Party) {
    let Party {
        machine,
        wall,
        folders,
        journal,
        health,
    } = party;
    let written = journal.clone();
    let line = Line {
        wall,
        machine: machine.name.clone(),
        machines: machine.machines.names.clone(),
        lead: machine.machines.lead.clone(),
        address: machine.machines.address,
        lost_after: machine.machines.lost_after,
        say: Arc::new(move |is_fault, words| {
            let level = if is_fault { Level::Error } else { Level::Info };
            written.write(level, &words, &[]);
            crate::stage::say(format_args!("recto: {words}"));
        }),
    };
    app.init_resource::<Turn>();
    let asked = machine.clone();
    if machine.leads() {
        let lead = Arc::new(Lead::listen(line, machine.machines.delay));
        let known = Arc::downgrade(&lead);
        health.ask_machines(move || leads(&asked, &known));
        app.insert_resource(Leading {
            lead,
            last: None,
            which: Which::default(),
        })
        .add_systems(PostUpdate, tell);
        return;
    }
    // Where nobody is to be woken, everybody is awake.
    let waker = app.world().get_resource::<Waker>().cloned();
    let wake = move || {
        if let Some(Waker(wake)) = &waker {
            wake();
        }
    };
    let follow = Arc::new(Follow::call(line, wake));
    let known = Arc::downgrade(&follow);
    health.ask_machines(move || follows(&asked, &known));
    app.insert_resource(Following {
        follow,
        folders,
        wanted: None,
        held: None,
        looked: None,
        journal,
        told: None,
    })
    .init_resource::<Led>()
    .add_systems(Update, hear.before(StageSet::Steer))
    .add_systems(PostUpdate, complain);
}

fn leads(machine: &Machine, lead: &Weak<Lead<Told>>) -> Option<Standing> {
    let lead = lead.upgrade()?;
    Some(Standing {
        machine: machine.name.clone(),
        role: Role::Leads,
        address: machine.machines.address.to_string(),
        followers: lead.peers(),
        leader: None,
        faults: lead.faults(),
    })
}

fn follows(machine: &Machine, follow: &Weak<Follow<Told>>) -> Option<Standing> {
    let follow = follow.upgrade()?;
    Some(Standing {
        machine: machine.name.clone(),
        role: Role::Follows,
        address: machine.machines.address.to_string(),
        followers: Vec::new(),
        leader: Some(follow.followed()),
        faults: follow.faults(),
    })
}

/// Tells the others what is shown, when it is something else than before.
fn tell(world: &mut World) {
    let Some(told) = Told::of(world) else { return };
    let Some(exhibit) = world
        .get_resource::<Hand>()
        .map(|hand| hand.exhibit().clone())
    else {
        return;
    };
    let turn = world.resource::<Turn>().0;
    let mut leading = world.resource_mut::<Leading>();
    let is_held = |(held, _): &(Arc<Exhibit>, Told)| Arc::ptr_eq(held, &exhibit);
    if !leading.last.as_ref().is_some_and(is_held) {
        leading.which.print = exhibit_print(&exhibit);
    } else if leading.last.as_ref().is_some_and(|(_, last)| *last == told)
        && leading.which.turn == turn
    {
        return;
    }
    leading.which.turn = turn;
    leading.lead.show(leading.which.clone(), told.clone());
    leading.last = Some((exhibit, told));
}

/// Takes in what is due, as far as this machine has the exhibit that it is about.
fn hear(
    time: Res<Time<Real>>,
    hand: Res<Hand>,
    (mut following, mut led, mut turn): (ResMut<Following>, ResMut<Led>, ResMut<Turn>),
    mut reread: MessageWriter<Reread>,
    mut commands: Commands,
) {
    let following = &mut *following;
    let due = following.follow.due();
    let mut is_news = due.is_some();
    if due.is_some() {
        following.wanted = due;
    }
    let exhibit = hand.exhibit();
    if !following
        .held
        .as_ref()
        .is_some_and(|(held, _)| Arc::ptr_eq(held, exhibit))
    {
        following.held = Some((exhibit.clone(), exhibit_print(exhibit)));
        is_news = true;
    }
    let Some(wanted) = &following.wanted else {
        return;
    };
    let print = following.held.as_ref().map(|(_, print)| print);
    if print == Some(&wanted.exhibit.print) {
        following.looked = None;
        if is_news {
            turn.0 = wanted.exhibit.turn;
            led.0 = Some(wanted.told.clone());
        }
        return;
    }
    let now = time.elapsed();
    let is_soon = |looked: Duration| now.saturating_sub(looked) < LOOK_AGAIN;
    if following.looked.is_some_and(is_soon) {
        return;
    }
    following.looked = Some(now);
    let Some(folder) = following.folders.get(wanted.exhibit.turn) else {
        let fault = format!(
            "the leader shows exhibit number {} of its installation, where this one has {}",
            wanted.exhibit.turn + 1,
            following.folders.len()
        );
        following.unfollow(fault);
        return;
    };
    match Exhibit::read(folder) {
        Ok((exhibit, _)) if exhibit_print(&exhibit) == wanted.exhibit.print => {
            let exhibit = Arc::new(exhibit);
            reread.write(Reread(exhibit.clone()));
            commands.queue(move |world: &mut World| reload::follow(world, &exhibit));
        }
        Ok(_) => {
            let fault = format!(
                "{} is another version here than the leader's, whose last picture stays; publish the \
                 same on both machines",
                folder.display()
            );
            following.unfollow(fault);
        }
        Err(faults) => {
            let fault = format!("{faults}");
            following.unfollow(fault);
        }
    }
}

/// Says once why what was told is not shown, and what is.
fn complain(mut following: ResMut<Following>, (led, unfollowed): (Res<Led>, Res<Unfollowed>)) {
    if !led.is_changed() && !unfollowed.is_changed() {
        return;
    }
    match &unfollowed.0 {
        Some(found) => {
            let fault = format!("the leader's picture cannot be shown here: it has {found}");
            following.unfollow(fault);
        }
        None => {
            if led.0.is_some() {
                following.told = None;
                let shown = following.wanted.as_ref();
                let shown = shown.map(|shown| (shown.term, shown.version));
                following.follow.tell(shown, None);
            }
        }
    }
}

impl Following {
    fn unfollow(&mut self, fault: String) {
        if self.told.as_ref() != Some(&fault) {
            self.journal.write(Level::Error, &fault, &[]);
            crate::stage::say(format_args!("recto: {fault}"));
        }
        self.follow.fail(fault.clone());
        self.told = Some(fault);
    }
}

/// The same for the same wall: its displays, and what the installation says of texts on it.
pub fn wall_print(installation: &Installation) -> String {
    let interface = &installation.interface;
    let mut hasher = DefaultHasher::new();
    let displays = installation.wall.iter().flat_map(|wall| &wall.displays);
    for display in displays {
        display.id.hash(&mut hasher);
        display.machine.hash(&mut hasher);
        display.on_desktop.size.hash(&mut hasher);
        let corners = [display.on_wall.min, display.on_wall.max];
        corners
            .map(|corner| corner.to_array().map(f64::to_bits))
            .hash(&mut hasher);
    }
    installation.languages.hash(&mut hasher);
    interface.enlarge.to_bits().hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// The same for the same manifest and maps, wherever they lie: of a published version what it is made of,
/// and otherwise the manifest's text with names and lengths of the maps.
pub fn exhibit_print(exhibit: &Exhibit) -> String {
    let mut hasher = DefaultHasher::new();
    exhibit.fingerprint.hash(&mut hasher);
    let version = exhibit.published.as_ref().and(exhibit.folder.file_name());
    let version = version.map(|name| name.to_string_lossy().into_owned());
    match version.as_deref().and_then(|name| name.rsplit_once('-')) {
        Some((_, content)) => content.hash(&mut hasher),
        None => {
            let mut maps: Vec<(&Path, u64)> = exhibit
                .maps()
                .map(|map| {
                    let name = map.path.strip_prefix(&exhibit.folder).unwrap_or(&map.path);
                    (name, fs::metadata(&map.path).map_or(0, |file| file.len()))
                })
                .collect();
            maps.sort_unstable();
            maps.dedup();
            maps.hash(&mut hasher);
        }
    }
    format!("{:016x}", hasher.finish())
}
