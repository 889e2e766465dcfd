//! `recto register`

use std::path::PathBuf;

use glam::DVec2;

use super::{Failure, options, output};
use crate::{
    manifest::{
        Exhibit, Faults, SideName,
        capture::Photograph,
        exhibit::{Drawing, FlipAxis},
        frames,
    },
    maps::{
        self, Placed,
        registration::propose::{Grey, Proposal, Proposed, control_points, recto_verso, states},
    },
};

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    /// The drawing; without it, the first
    #[arg(long, value_name = "ID")]
    drawing: Option<String>,
    /// The state whose picture is to be placed on the side's own; without it, the verso's picture
    /// is placed by the recto's, by the ink that shows through
    #[arg(long, value_name = "ID")]
    state: Option<String>,
    /// The side of the state
    #[arg(long, value_name = "SIDE", default_value = "recto", requires = "state",
        value_parser = options::side())]
    side: SideName,
    /// How far from where they are expected places may lie, in mm
    #[arg(long, value_name = "MM", default_value_t = 13.0, value_parser = options::positive_mm,
        allow_negative_numbers = true)]
    reach_mm: f64,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let exhibit = super::read(&arguments.exhibit)?;
    let drawing = drawing(&exhibit, arguments.drawing.as_deref())?;
    let all = exhibit.photographs();
    let find = |side: SideName, state: Option<&str>| {
        let is_it =
            |p: &&Photograph<'_>| p.drawing.id == drawing.id && p.side == side && p.state == state;
        all.iter().find(is_it).ok_or_else(|| {
            let state = state
                .map(|id| format!(" in the state {id}"))
                .unwrap_or_default();
            input(format!(
                "the drawing {} has no picture of its {}{state}; add albedo there",
                drawing.id,
                side.word()
            ))
        })
    };
    let (first, second) = match arguments.state.as_deref() {
        Some(state) => (
            find(arguments.side, None)?,
            find(arguments.side, Some(state))?,
        ),
        None => (find(SideName::Recto, None)?, find(SideName::Verso, None)?),
    };
    if arguments.state.is_none() && drawing.flip != FlipAxis::Vertical {
        return Err(input(
            "a verso that is turned about the horizontal axis cannot be proposed for; turn its \
             picture upside down"
                .to_owned(),
        ));
    }
    // Of the second the points are pixels of its file; of the first, places on the sheet.
    let of_first = grey(&exhibit, first, (&first.albedo.file).into())?;
    let of_second = grey(&exhibit, second, (&second.albedo.file.path).into())?;
    let proposal = match arguments.state {
        Some(_) => states(&of_first, &of_second, arguments.reach_mm),
        None => recto_verso(&of_first, &of_second, arguments.reach_mm),
    };
    match proposal {
        Proposal::Matches { points, rms_mm, .. } => {
            let table = match &arguments.state {
                Some(state) => format!("of the state {state}: {}.albedo", first.side.word()),
                None => "of the drawing: [drawing.verso]".to_owned(),
            };
            output::say(format_args!(
                "{} places agree; they lie {rms_mm:.2} mm (root mean square) from where one turn, scale \
                 and shift put them. To be copied into the manifest, {table}",
                points.len()
            ));
            output::result(written(
                &points,
                first,
                &of_first,
                drawing,
                arguments.state.is_none(),
            ))
        }
        Proposal::DoesNotMatch { why, points } => Err(input(format!(
            "{} and {} do not match: {why} ({} places stood out); are they of one sheet, and cropped to \
             it alike?",
            first.albedo.file.path.display(),
            second.albedo.file.path.display(),
            points.len()
        ))),
    }
}

fn input(words: String) -> Failure {
    Failure::Input(words.into())
}

fn drawing<'e>(exhibit: &'e Exhibit, id: Option<&str>) -> Result<&'e Drawing, Failure> {
    let Some(id) = id else {
        return Ok(&exhibit.drawings[0]);
    };
    let named = exhibit.drawings.iter().find(|drawing| drawing.id == id);
    named.ok_or_else(|| {
        let ids: Vec<&str> = exhibit.drawings.iter().map(|d| d.id.as_str()).collect();
        input(format!(
            "--drawing {id}: the exhibit has {}",
            ids.join(", ")
        ))
    })
}

/// A photograph as the eye sees its green, on a sheet that it covers.
fn grey(exhibit: &Exhibit, photograph: &Photograph<'_>, file: Placed<'_>) -> Result<Grey, Failure> {
    let albedo = photograph.albedo;
    let pyramid = maps::load_colour(file, albedo.encoding)
        .map_err(|error| Faults::from(exhibit.map_fault(&albedo.file.path, &error)))?;
    let channels = usize::from(pyramid.channels);
    let level = &pyramid.levels[0];
    let green = channels.min(2) - 1;
    let pixels = level.width as usize * level.height as usize;
    let value = |i: usize| level.texels.get(i * channels + green).unwrap_or_default();
    Ok(Grey {
        width: level.width as usize,
        height: level.height as usize,
        values: (0..pixels).map(|i| value(i).max(0.0).sqrt()).collect(),
        mm_per_px: match file.warp {
            Some(_) => albedo.file.extent_mm().x,
            None => photograph.drawing.size_mm.x,
        } / f64::from(level.width),
    })
}

/// `control_points` as the manifest has them.
fn written(
    points: &[Proposed],
    first: &Photograph<'_>,
    grey: &Grey,
    drawing: &Drawing,
    is_verso: bool,
) -> String {
    let file = &first.albedo.file;
    let size = DVec2::new(file.size[0].into(), file.size[1].into());
    control_points(points.iter().map(|point| {
        // The first picture itself may be registered.
        let uv = point.mm / grey.mm_per_px / size;
        let mut mm = file.uv_from_side.inverse().transform_point2(uv);
        if is_verso {
            mm = frames::other_side(mm, drawing.size_mm, drawing.flip);
        }
        (point.px, mm)
    }))
}
