//! `recto bsdf`

use std::{fmt::Write, path::PathBuf};

use clap::ValueEnum;
use glam::DVec3;

use super::{Failure, options, output};
use crate::{
    compute::{self, ComputeError},
    manifest::{did_you_mean, quote},
    optics::{
        bsdf::{COLUMNS, Pair, Sample, Specimen, read_pairs},
        medium::{MediumId, Preset},
        tier::Tier,
    },
};

/// Reflectance of a specimen of which nothing is said: paper, nearly.
const ALBEDO: &str = "0.8,0.8,0.8";

#[derive(clap::Args)]
pub struct Arguments {
    /// A paper or drawing medium of the catalogue
    #[arg(long, value_name = "NAME")]
    medium: String,
    /// Whose constants: of the visible range, or those that the ISLe article prints
    #[arg(long, value_enum, default_value_t = Optics::Recto)]
    optics: Optics,
    /// How exactly light is calculated
    #[arg(long, default_value_t, value_parser = options::tier())]
    tier: Tier,
    /// What calculates: f64, or the shader
    #[arg(long, value_enum, default_value_t = Device::Cpu)]
    device: Device,
    /// Reflectance of the medium as photographed, linear sRGB, 0 to 1 each; a drawn one at full
    /// coverage
    #[arg(long, value_name = "R,G,B", default_value = ALBEDO, value_parser = albedo)]
    albedo: DVec3,
    /// CSV with the columns theta_i, phi_i, theta_o, phi_o in degrees; theta_o above 90 is light
    /// that goes through
    #[arg(long, value_name = "FILE.csv")]
    pairs: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Optics {
    Recto,
    #[value(name = "isle-2021")]
    Isle2021,
}

impl From<Optics> for Preset {
    fn from(optics: Optics) -> Self {
        match optics {
            Optics::Recto => Self::Recto,
            Optics::Isle2021 => Self::Isle2021,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Device {
    Cpu,
    Gpu,
}

fn albedo(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|x| x.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([r, g, b]) if [r, g, b].iter().all(|x| (0.0..=1.0).contains(*x)) => {
            Ok(DVec3::new(*r, *g, *b))
        }
        _ => Err("write three numbers from 0 to 1, such as 0.8,0.75,0.6".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let names = || MediumId::all().map(MediumId::name);
    let medium = arguments.medium.parse::<MediumId>().map_err(|unknown| {
        let name = &arguments.medium;
        let remedy = did_you_mean(name, names(), "name a medium of the catalogue");
        let all = names().collect::<Vec<_>>().join(", ");
        Failure::Usage(format!(
            "--medium {}: {unknown}; {remedy} ({all})",
            quote(name)
        ))
    })?;
    let path = &arguments.pairs;
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::Input(format!("{}: {error}", path.display()).into()))?;
    let pairs = read_pairs(&text).map_err(|faults| {
        let lines = faults
            .iter()
            .map(|fault| format!("{}: {fault}", path.display()));
        Failure::Input(lines.collect::<Vec<_>>().join("\n").into())
    })?;
    let specimen = Specimen::new(&medium.of_preset(arguments.optics.into()), arguments.albedo);
    let samples = match arguments.device {
        Device::Cpu => pairs
            .iter()
            .map(|pair| specimen.at(arguments.tier, pair))
            .collect::<Vec<Sample>>(),
        Device::Gpu => compute::evaluate(&specimen, arguments.tier, &pairs)?,
    };
    output::result(table(&pairs, &samples).trim_end())
}

fn table(pairs: &[Pair], samples: &[Sample]) -> String {
    let mut text = COLUMNS.join(",");
    for part in ["f", "mirror", "ballistic"] {
        for channel in ["red", "green", "blue"] {
            text += &format!(",{part}_{channel}");
        }
    }
    text.push('\n');
    for (pair, sample) in pairs.iter().zip(samples) {
        let parts = [sample.f, sample.mirror, sample.ballistic];
        let numbers = pair
            .0
            .into_iter()
            .chain(parts.map(|part| part.to_array()).concat());
        for (i, number) in numbers.enumerate() {
            let comma = if i == 0 { "" } else { "," };
            // A String takes everything.
            let _ = write!(text, "{comma}{number}");
        }
        text.push('\n');
    }
    text
}

impl From<ComputeError> for Failure {
    fn from(error: ComputeError) -> Self {
        Self::Device(Box::new(error))
    }
}
