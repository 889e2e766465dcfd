//! The fonts of every language that is on offer, one asked after the other for a letter.

use std::path::PathBuf;

use bevy::{prelude::*, text::FontCx};

use super::{caption::Texts, controls::draw::ProgramWords};
use crate::{stage::say, wording::fonts::Fonts};

/// Where an installation's own fonts are.
#[derive(Resource, Clone, Debug, Default)]
pub struct FontFolder(pub Option<PathBuf>);

/// The faces that are asked when the first one lacks a letter.
#[derive(Resource)]
pub struct Letters {
    fonts: Fonts,
    /// Faces that nobody held would be forgotten.
    _held: Vec<Handle<Font>>,
    hinted: bool,
}

/// Finds them.
pub fn load(
    mut commands: Commands,
    (words, folder): (Res<ProgramWords>, Res<FontFolder>),
    mut assets: ResMut<Assets<Font>>,
) {
    let fonts = Fonts::find(&words.0.letters(), folder.0.as_deref());
    for warning in fonts.warnings() {
        say(warning);
    }
    let held = fonts.faces().iter();
    let held = held.map(|face| assets.add(Font::from_bytes(face.data().as_ref().to_vec())));
    commands.insert_resource(Letters {
        _held: held.collect(),
        fonts,
        hinted: false,
    });
}

/// Says which is asked for which script, when all of them are there. What was laid out before is laid out
/// anew: it would keep the boxes of letters that nobody was asked for.
pub fn hint(
    letters: Option<ResMut<Letters>>,
    (mut context, mut texts): (ResMut<FontCx>, ResMut<Texts>),
    mut laid: Query<&mut TextFont>,
) {
    if let Some(mut letters) = letters
        && !letters.hinted
    {
        letters.hinted = letters.fonts.hint(&mut context.context.collection);
        if letters.hinted {
            laid.iter_mut().for_each(|mut font| font.set_changed());
            texts.set_changed();
        }
    }
}
