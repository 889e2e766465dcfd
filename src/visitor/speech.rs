//! The language that is read: chosen once, and the same wherever something is said.

use bevy::{ecs::system::SystemParam, prelude::*};

use super::{
    controls::{
        Interface,
        draw::{Languages, ProgramWords},
        facts,
    },
    hand::Hand,
};
use crate::{stage::legend::Speaks, wording::Spoken};

/// The words of whoever is there.
#[derive(SystemParam)]
pub struct Speech<'w> {
    words: Res<'w, ProgramWords>,
    languages: Res<'w, Languages>,
    interface: Res<'w, Interface>,
}

impl Speech<'_> {
    /// In the language that was chosen, or else the first on offer.
    pub fn spoken(&self) -> Spoken<'_> {
        Spoken {
            wordings: &self.words.0,
            language: self.languages.tag(self.interface.language.as_deref()),
        }
    }
}

/// The language that was chosen stays what it is in every exhibit that has it; in others, the first on
/// offer is read.
pub fn speak(
    interface: Res<Interface>,
    (mut hand, mut languages, mut speaks): (ResMut<Hand>, ResMut<Languages>, ResMut<Speaks>),
) {
    let offered = facts::languages(&languages.installed, hand.exhibit());
    if languages.offered != offered {
        languages.offered = offered;
    }
    let chosen = interface.language.as_deref();
    let wanted = languages.spoken(chosen);
    if hand.language() != wanted.as_deref() {
        hand.speak(wanted);
    }
    let tag = languages.tag(chosen);
    if speaks.0 != tag {
        speaks.0 = tag.to_owned();
    }
}
