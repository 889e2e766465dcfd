//! The view that is shown, kept: as a scene of the manifest, or as a link.

use std::io::{self, Write};

use bevy::prelude::*;
use glam::UVec2;

use super::{caption::Texts, glass::Glass, hand::Hand, intent::Intent, notice::Notice};
use crate::{
    manifest::{Fingerprint, SaveAs, SaveError, Wording},
    stage::say,
};

/// Saved views are called after this: view-1, view-2, …
const STEM: &str = "view";

/// What this window wrote last: it may be built upon before it is read again.
#[derive(Resource, Default)]
pub struct Saved(Option<Fingerprint>);

/// Follows wishes to keep the view.
pub fn keep(
    mut intents: MessageReader<Intent>,
    (hand, mut texts, mut saved): (Res<Hand>, ResMut<Texts>, ResMut<Saved>),
    glass: Res<Glass>,
) {
    for intent in intents.read() {
        let said = match intent {
            Intent::SaveView => match save(&hand, &mut saved) {
                Ok(id) => Some(Notice::Saved(id)),
                Err(error) => {
                    say(format_args!("recto: {error}"));
                    Some(Notice::NotSaved((&error).into()))
                }
            },
            Intent::Link => {
                match link(&hand, glass.pixels) {
                    Ok(command) => {
                        // Nobody may be reading there any more.
                        let _ = writeln!(io::stdout(), "{command}");
                        Some(Notice::Linked)
                    }
                    Err(error) => {
                        say(format_args!("recto: {error}"));
                        Some(Notice::NotSaved((&error).into()))
                    }
                }
            }
            // Whatever comes next takes the words away.
            _ => None,
        };
        if texts.notice != said {
            texts.notice = said;
        }
    }
}

fn save(hand: &Hand, saved: &mut Saved) -> Result<String, SaveError> {
    let (exhibit, mut scene) = hand.view();
    // What is said of the scene that it began with is not about this view.
    (scene.title, scene.text) = (Wording::default(), Wording::default());
    let known: Vec<Fingerprint> = saved.0.into_iter().collect();
    let draft = exhibit.draft(&scene, SaveAs::Next(STEM), &known)?;
    saved.0 = Some(draft.write()?);
    Ok(draft.id().to_owned())
}

/// The command that makes the same picture.
fn link(hand: &Hand, size: UVec2) -> Result<String, SaveError> {
    let (exhibit, scene) = hand.view();
    let link = exhibit.link(&scene)?;
    let path = exhibit.manifest.canonicalize();
    let path = path.as_ref().unwrap_or(&exhibit.manifest);
    Ok(format!(
        "recto render {} --link {link} --size {}x{} --tier {} --out {STEM}.png",
        quoted(&path.display().to_string()),
        size.x.max(1),
        size.y.max(1),
        hand.tier().name(),
    ))
}

/// For a shell.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    match text.chars().all(plain) {
        true => text.to_owned(),
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_a_path_as_it_is() {
        assert_eq!(quoted("/srv/a-b_c.d"), "/srv/a-b_c.d");
        assert_eq!(quoted("/srv/l'aria e $x"), r"'/srv/l'\''aria e $x'");
    }
}
