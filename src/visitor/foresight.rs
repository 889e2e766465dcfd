//! Which tier serves what is shown: predicted in the background, once things have come to rest.

use std::sync::{Arc, Mutex, PoisonError, mpsc};

use bevy::prelude::*;

use super::hand::{Hand, Serving};
use crate::{
    cost,
    manifest::exhibit::{Comparison, Exhibit, Scene},
    optics::tier::Tier,
    stage::{Arranged, Shown, Waker},
    tradeoff::{
        choice::{LADDER, Outlook},
        places::Maps,
        table::Table,
    },
};

/// How long a frame took, at which tier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observed {
    pub tier: Tier,
    pub ms: f64,
}

type Asked = (Arc<Exhibit>, Scene);

/// What is known of the tiers on what is shown.
#[derive(Resource)]
pub struct Foresight {
    /// What a prediction was last asked for.
    asked: Option<Asked>,
    outlook: Option<Outlook>,
    /// What this machine was measured to take for each tier, or the ratios that Recto comes with.
    table: Table,
    maps: Arc<Mutex<Maps>>,
    sender: mpsc::Sender<Option<Outlook>>,
    // A receiver is not Sync; only `foresee` takes it, and never blocks.
    receiver: Mutex<mpsc::Receiver<Option<Outlook>>>,
}

impl Default for Foresight {
    fn default() -> Self {
        let (sender, receiver) = mpsc::channel();
        Self {
            asked: None,
            outlook: None,
            table: cost::known().unwrap_or_else(|| Table::shipped().clone()),
            maps: Arc::default(),
            sender,
            receiver: Mutex::new(receiver),
        }
    }
}

impl Foresight {
    /// The tiers for what is shown, where frames take as long as was `observed` at one of them.
    pub fn serving(
        &self,
        exhibit: &Exhibit,
        wanted: Option<Tier>,
        observed: Option<Observed>,
    ) -> Option<Serving> {
        let outlook = self.outlook.as_ref()?;
        let accuracy = &exhibit.accuracy;
        let at_rest = wanted.unwrap_or_else(|| outlook.at_rest(accuracy.max_delta_e).0);
        let ms = |tier: Tier| {
            let observed = observed?;
            // What does not depend on the tier makes the prediction too careful, never too bold.
            let of = |tier| outlook.costs.get(tier).map(|cost| cost.ratio);
            Some(observed.ms * of(tier)? / of(observed.tier)?)
        };
        Some(Serving {
            at_rest,
            in_motion: outlook.in_motion(at_rest, accuracy.frame_ms, ms),
        })
    }

    fn ask(&mut self, shown: &Shown, size: [u32; 2], waker: Option<Waker>) {
        let exhibit = shown.exhibit.clone();
        let scene = predicted(&shown.scene);
        self.asked = Some((exhibit.clone(), scene.clone()));
        let (sender, maps, table) = (self.sender.clone(), self.maps.clone(), self.table.clone());
        // Not among rayon's threads: the forecast waits for these while it holds the maps.
        std::thread::spawn(move || {
            // A panic elsewhere leaves whole maps behind.
            let mut maps = maps.lock().unwrap_or_else(PoisonError::into_inner);
            // A map that cannot be read is told by the stage; there is nothing to predict then.
            let outlook = Outlook::of(&exhibit, &scene, size, &mut maps, &table).ok();
            drop(maps);
            // Nobody listens any more where the program is closing.
            let _ = sender.send(outlook);
            if let Some(Waker(wake)) = waker {
                wake();
            }
        });
    }

    fn is_asked(&self, shown: &Shown) -> bool {
        self.asked.as_ref().is_some_and(|(exhibit, scene)| {
            Arc::ptr_eq(exhibit, &shown.exhibit) && *scene == predicted(&shown.scene)
        })
    }
}

/// What is predicted of a scene, as `recto check` does: of a comparison all members. Where a curtain is,
/// and whose turn, asks for nothing new.
fn predicted(scene: &Scene) -> Scene {
    let compare = scene.compare.as_ref();
    Scene {
        compare: compare.map(|comparison| Comparison::new(comparison.mode, comparison.of.clone())),
        ..scene.clone()
    }
}

/// Width of the picture that predictions are made for.
const WIDTH_PX: f64 = 1280.0;

/// Asks for a prediction of what has come to rest, and takes in what arrived.
pub fn foresee(
    mut foresight: ResMut<Foresight>,
    (hand, shown, arranged): (Res<Hand>, Res<Shown>, Res<Arranged>),
    waker: Option<Res<Waker>>,
) {
    let silent = foresight.bypass_change_detection();
    let receiver = match silent.receiver.get_mut() {
        Ok(receiver) => receiver,
        Err(poisoned) => poisoned.into_inner(),
    };
    if let Some(outlook) = receiver.try_iter().last() {
        silent.outlook = outlook;
    }
    // Baselines from the literature are never replaced.
    let on_ladder = LADDER.contains(&hand.tier());
    if on_ladder && arranged.is_settled() && !hand.is_moving() && !silent.is_asked(&shown) {
        let size = [WIDTH_PX, WIDTH_PX / shown.aspect.max(1e-3)].map(|side| side as u32);
        silent.ask(&shown, size, waker.map(|waker| waker.clone()));
    }
}
