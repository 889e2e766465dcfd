//! Scenes that a command writes into the manifest.

use super::{Failure, output, render::Commission};
use crate::manifest::{Camera, Draft, SaveAs, Scene, Wording};

/// The manifest with `scene` by `id`; nothing is written yet.
pub fn draft(commission: &Commission, scene: &Scene, id: &str) -> Result<Draft, Failure> {
    let Commission { exhibit, size, .. } = commission;
    let sheet = exhibit.drawing_of(scene).size_mm;
    let mut scene = scene.clone();
    // The whole sheet stays the whole sheet in pictures of another shape.
    let whole = Camera::whole_sheet(sheet);
    let aspect = exhibit.own_aspect(&scene, f64::from(size[0]) / f64::from(size[1]));
    if scene.camera == whole.fitted(sheet, aspect) {
        scene.camera = whole;
    }
    // Words about one view are not about another.
    if scene.id != id {
        (scene.title, scene.text) = (Wording::default(), Wording::default());
    }
    Ok(exhibit.draft(&scene, SaveAs::Id(id), &[])?)
}

/// Writes it, and names the manifest.
pub fn write(draft: &Draft) -> Result<(), Failure> {
    draft.write()?;
    output::say(format_args!(
        "{}: saved as scene {}",
        draft.path().display(),
        draft.id()
    ));
    Ok(())
}
