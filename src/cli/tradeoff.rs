//! `recto tradeoff`

use std::{
    io::Write,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{Failure, output};
use crate::{
    cost::{self, Composer, Effort, MeasureError, Stopwatch, least},
    manifest::{Exhibit, Faults, Scene},
    maps::encode,
    needs::Needs,
    optics::tier::Tier,
    stage::{Shown, legend},
    tradeoff::{
        places::Maps,
        plot,
        scene::{Sampled, WIDTH_PX},
        table::{Cost, Row, Table},
    },
};

/// Names of the files that are written.
const FILES: [&str; 3] = ["tradeoff.csv", "tradeoff.png", "tradeoff.svg"];
/// Scenes of an exhibit are timed on pictures of this size.
const SIZE: [u32; 2] = [768, 512];
/// How often each tier has its turn.
const ROUNDS: usize = 2;

#[derive(clap::Args)]
pub struct Arguments {
    /// An exhibit, whose own scenes are then judged; without it, the nine subjects of the table
    exhibit: Option<PathBuf>,
    /// The folder to write tradeoff.csv, tradeoff.png and tradeoff.svg into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let exhibit = arguments.exhibit.as_deref().map(super::read).transpose()?;
    output::can_write_folder(out)?;
    crate::device::probe()?;
    let table = match exhibit {
        None => of_subjects()?,
        Some(exhibit) => of_scenes(exhibit)?,
    };
    write(&table, out)
}

fn of_subjects() -> Result<Table, Failure> {
    let bar = output::progress(cost::STEPS + 1);
    bar.set_message("errors");
    let mut table = Table::of_subjects();
    cost::measure(&mut table, Effort::THOROUGH, |work| {
        bar.inc(1);
        bar.set_message(format!("costs: {work}"));
    })?;
    cost::keep(&table);
    bar.finish_and_clear();
    Ok(table)
}

/// Errors are predicted against the judge, costs are measured.
fn of_scenes(exhibit: Exhibit) -> Result<Table, Failure> {
    let exhibit = Arc::new(exhibit);
    let bar = output::progress(exhibit.scenes.len() as u64);
    let mut maps = Maps::default();
    let mut composer = Composer::new("");
    let mut watch = Stopwatch::new(SIZE).map_err(MeasureError::from)?;
    let mut table = Table {
        device: cost::device_name(),
        rows: Vec::new(),
    };
    for scene in &exhibit.scenes {
        bar.set_message(scene.id.clone());
        let height = WIDTH_PX * SIZE[1] / SIZE[0];
        let sampled = Sampled::new(&exhibit, scene, [WIDTH_PX, height], &mut maps)
            .map_err(|fault| exhibit.map_fault(&fault.path, &fault.error))
            .map_err(Faults::from)?;
        let costs = scene_costs(&exhibit, scene, &mut watch)?;
        for forecast in sampled.forecasts(&Tier::ALL) {
            let tier = forecast.tier;
            let needs = Needs::of(&exhibit, scene, tier, false);
            let side = needs.sides.first();
            let instructions = side
                .map(|side| cost::instructions(&mut composer, &side.terms))
                .transpose()
                .map_err(MeasureError::from)?;
            let cost = costs.iter().find(|(of, _)| *of == tier);
            table.rows.push(Row {
                subject: scene.id.clone(),
                tier: Some(tier),
                errors: forecast.errors,
                cost: cost.map(|(_, cost)| *cost),
                instructions,
            });
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(table)
}

fn scene_costs(
    exhibit: &Arc<Exhibit>,
    scene: &Scene,
    watch: &mut Stopwatch,
) -> Result<Vec<(Tier, Cost)>, MeasureError> {
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let shown = |tier| Shown::at_rest(exhibit.clone(), scene.clone(), tier, aspect);
    let mut floor = Vec::new();
    let mut times = vec![Vec::new(); Tier::ALL.len()];
    for _ in 0..ROUNDS {
        floor.extend(watch.time_floor(shown(Tier::Lambert))?);
        for (tier, times) in Tier::ALL.into_iter().zip(&mut times) {
            times.extend(watch.time(shown(tier))?);
        }
    }
    let floor = least(&floor);
    let pixels = f64::from(SIZE[0]) * f64::from(SIZE[1]);
    let costs = Tier::ALL.into_iter().zip(&times).map(|(tier, times)| {
        let ms = least(times);
        let cost = Cost {
            ratio: ms / floor.max(f64::MIN_POSITIVE),
            ns: ms * 1e6 / pixels,
        };
        (tier, cost)
    });
    Ok(costs.collect())
}

fn write(table: &Table, out: &Path) -> Result<(), Failure> {
    // All of it is made before anything is written.
    let face = legend::face();
    let pixels = plot::pixels(table, face.clone())?;
    let svg = plot::svg(table, face)?;
    output::make_folder(out)?;
    let [csv, png, vector] = FILES.map(|name| out.join(name));
    encode::write_whole(&csv, |file| write!(file, "{table}"))?;
    let [width, height] = plot::SIZE;
    encode::save_png_rgb8(&png, width, height, &pixels, None)?;
    encode::write_whole(&vector, |file| file.write_all(svg.as_bytes()))?;
    for file in [csv, png, vector] {
        output::result(file.display())?;
    }
    Ok(())
}

impl From<MeasureError> for Failure {
    fn from(error: MeasureError) -> Self {
        Self::Device(Box::new(error))
    }
}

impl From<plot::PlotError> for Failure {
    fn from(error: plot::PlotError) -> Self {
        Self::Input(Box::new(error))
    }
}
