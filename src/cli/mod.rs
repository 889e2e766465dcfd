//! The command line. Results go to standard output and words to standard error; the program
//! ends with 0 (done), 1 (the input is at fault), 2 (wrong usage) or 3 (no graphics device).

pub mod accuracy;
mod bsdf;
mod check;
mod export;
mod failure;
mod import;
mod measure;
mod new;
mod options;
mod output;
mod place;
mod prepare;
mod probe;
mod publish;
mod reference;
mod register;
mod render;
pub mod report;
mod sample;
mod saving;
mod schema;
mod show;
mod supervise;
mod tradeoff;

use std::{ffi::OsString, path::Path};

use clap::{Parser, Subcommand};

use crate::manifest::{Exhibit, Fault};
pub use failure::Failure;

/// Shows old-master drawings as if the sheet lay in your hands.
#[derive(Parser)]
#[command(name = "recto", version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    show: show::Arguments,
}

#[derive(Subcommand)]
enum Command {
    /// Open an exhibit in a window
    #[command(after_help = show::keys())]
    Show(show::Arguments),
    /// Render scenes into files, without a window
    Render(render::Arguments),
    /// Render scenes by random walks of light: slowly, exactly, and with their noise
    Reference(reference::Arguments),
    /// Name every fault of an exhibit or an installation, and what they require
    Check(check::Arguments),
    /// Print a medium's BSDF at pairs of directions
    Bsdf(bsdf::Arguments),
    /// Judge every tier: its error against the reference, and what it costs
    Tradeoff(tradeoff::Arguments),
    /// Measure on a side: distances, areas, relief, laid lines, strokes, colours
    Measure(measure::Arguments),
    /// Propose control points from the pictures themselves
    Register(register::Arguments),
    /// Say what overlays and stacks of bands show at one place
    Probe(probe::Arguments),
    /// Make maps and an exhibit from photographs under several lamps
    ///
    /// The photographs are written down in a capture file, of which README.md has an example; `recto schema
    /// --capture` prints every key with its meaning.
    Prepare(prepare::Arguments),
    /// Make an exhibit of a relightable image or a IIIF manifest, or a capture file of lamps
    #[command(after_help = import::HELP)]
    Import(import::Arguments),
    /// Write an exhibit for other programs: as IIIF
    #[command(after_help = export::HELP)]
    Export(export::Arguments),
    /// Start an exhibit from one picture
    New(new::Arguments),
    /// Write the sample exhibits and their maps
    Sample(sample::Arguments),
    /// Print the JSON Schema of the manifest, the installation or the capture file, for editors
    Schema(schema::Arguments),
    /// Publish an exhibit: copy it, whole or not at all, for a wall that goes on meanwhile
    Publish(publish::Arguments),
    /// Keep a window running: begin it anew when it crashes, hangs or ends
    Supervise(supervise::Arguments),
}

/// Runs the command that `arguments`, the program's name first, ask for.
///
/// # Errors
/// [`Failure`], which knows its words and its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = Arguments::try_parse_from(arguments)?;
    match arguments.command.unwrap_or(Command::Show(arguments.show)) {
        Command::Show(arguments) => show::run(arguments),
        Command::Render(arguments) => render::run(arguments),
        Command::Reference(arguments) => reference::run(arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Bsdf(arguments) => bsdf::run(&arguments),
        Command::Tradeoff(arguments) => tradeoff::run(&arguments),
        Command::Measure(arguments) => measure::run(arguments),
        Command::Register(arguments) => register::run(&arguments),
        Command::Probe(arguments) => probe::run(&arguments),
        Command::Prepare(arguments) => prepare::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Sample(arguments) => sample::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Publish(arguments) => publish::run(&arguments),
        Command::Supervise(arguments) => supervise::run(arguments),
    }
}

/// Reads an exhibit and says its warnings.
fn read(path: &Path) -> Result<Exhibit, Failure> {
    let (exhibit, warnings) = Exhibit::read(path)?;
    warn(&warnings);
    Ok(exhibit)
}

fn warn(warnings: &[Fault]) {
    for warning in warnings {
        output::say(warning);
    }
}
