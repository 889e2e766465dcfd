//! `recto measure`

use std::{io::Write as _, path::PathBuf};

use clap::ArgGroup;
use glam::DVec2;
use serde::Serialize;

use super::{
    Failure,
    options::{self, SceneArguments},
    output,
    report::Refused,
};
use crate::{
    manifest::{
        Exhibit, Fault, Faults, Scene, Severity, SideName, did_you_mean,
        overrides::{NO_STATE, Overrides},
        quote, quoted_list,
    },
    maps::encode,
    readings::{
        Desk, Disc, Note, PROBE_MM, Reading, ReadingError, Tool,
        plot::{self, Labels},
        sight::{Seen, Sight},
        table,
    },
    stage::legend,
};

/// Width in pixels of the picture that a camera in true size is for, where none is named.
const WIDTH_PX: u32 = 1920;

#[derive(clap::Args)]
#[command(group(
    ArgGroup::new("tools")
        .args(["ruler", "path", "angle", "profile", "lines", "stroke", "probe"])
        .required(true)
        .multiple(true)
))]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    #[command(flatten)]
    scene: SceneArguments,
    /// The distance of two places, in mm from the top left corner of the side that is seen
    #[arg(long, value_name = "X,Y:X,Y", allow_hyphen_values = true)]
    ruler: Vec<String>,
    /// The length of a line through places
    #[arg(long, value_name = "X,Y:X,Y:…", allow_hyphen_values = true)]
    path: Vec<String>,
    /// Close every --path, and say the area within
    #[arg(long, requires = "path")]
    area: bool,
    /// The angle at the second of three places
    #[arg(long, value_name = "A:B:C", allow_hyphen_values = true)]
    angle: Vec<String>,
    /// The relief along a line, from the height map
    #[arg(long, value_name = "X,Y:X,Y", allow_hyphen_values = true)]
    profile: Vec<String>,
    /// Draw the profile into this file, .png
    #[arg(long, value_name = "FILE", requires = "profile")]
    plot: Option<PathBuf>,
    /// Spacing and direction of laid and chain lines in the rectangle between two corners
    #[arg(long, value_name = "X,Y:X,Y", allow_hyphen_values = true)]
    lines: Vec<String>,
    /// The width of the stroke that a section crosses, from paper to paper
    #[arg(long, value_name = "X,Y:X,Y", allow_hyphen_values = true)]
    stroke: Vec<String>,
    /// The mean L*a*b* of a disc, of 2 mm radius unless that is given; or the ΔE00 of two
    #[arg(long, value_name = "X,Y[,R][:X,Y[,R]]", allow_hyphen_values = true)]
    probe: Vec<String>,
    /// Give the ΔE00 of every --probe from the same disc in this state, or none
    #[arg(long, value_name = "ID", requires = "probe")]
    against: Option<String>,
    /// Places are not in mm but in pixels, from the top left corner, of the picture of this size that
    /// recto render makes of the same scene
    #[arg(long, value_name = "WxH", value_parser = options::size_px)]
    px: Option<[u32; 2]>,
    /// Say all of it as JSON
    #[arg(long)]
    json: bool,
    /// Write all of it into this file as well, .csv: a row for each value, and for each place of a
    /// profile
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// All that was read, as `--json` says it.
#[derive(Serialize)]
struct Sheet<'r> {
    sound: bool,
    program: &'static str,
    version: &'static str,
    manifest: String,
    scene: &'r str,
    drawing: &'r str,
    side: SideName,
    state: Option<&'r str>,
    /// What `sigma` is.
    uncertainty: &'static str,
    readings: &'r [Reading],
}

pub fn run(mut arguments: Arguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.plot {
        let is_png = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if !is_png {
            return Err(Failure::Usage(format!(
                "--plot {}: the file's name must end in .png",
                path.display()
            )));
        }
        if arguments.profile.len() > 1 {
            return Err(Failure::Usage(
                "--plot draws one profile; give --profile once".to_owned(),
            ));
        }
    }
    arguments.csv.as_deref().map(options::csv).transpose()?;
    let exhibit = arguments.scene.read(&arguments.exhibit)?;
    for path in arguments.plot.iter().chain(&arguments.csv) {
        output::can_write_file(path, &exhibit)?;
    }
    let json = arguments.json;
    let measured = Asked::new(&arguments).measure(arguments, exhibit);
    if let (true, Err(Failure::Faults(faults))) = (json, &measured) {
        output::result(as_json(&Refused::new(faults))?)?;
    }
    measured
}

/// A tool as it was asked for, and the option that asks.
struct Wanted {
    option: String,
    tool: Result<Tool, Vec<Fault>>,
}

/// All tools, with places in mm or in pixels.
struct Asked(Vec<Wanted>);

impl Asked {
    fn new(arguments: &Arguments) -> Self {
        let mut wanted = Vec::new();
        let mut ask = |name: &str, specs: &[String], read: &dyn Fn(&Spec) -> Read| {
            for (i, text) in specs.iter().enumerate() {
                let option = match specs.len() {
                    1 => format!("--{name}"),
                    _ => format!("--{name}[{i}]"),
                };
                let tool = read(&Spec {
                    option: &option,
                    text,
                });
                wanted.push(Wanted { option, tool });
            }
        };
        let (area, against) = (arguments.area, arguments.against.is_some());
        ask("ruler", &arguments.ruler, &|s| s.places().map(Tool::Ruler));
        ask("path", &arguments.path, &|s| {
            let places = s.any(if area { 3 } else { 2 })?;
            Ok(Tool::Path {
                places,
                closed: area,
            })
        });
        ask("angle", &arguments.angle, &|s| s.places().map(Tool::Angle));
        ask("profile", &arguments.profile, &|s| {
            s.places().map(Tool::Profile)
        });
        ask("lines", &arguments.lines, &|s| s.places().map(Tool::Lines));
        ask("stroke", &arguments.stroke, &|s| {
            s.places().map(Tool::Stroke)
        });
        ask("probe", &arguments.probe, &|s| s.probe(against));
        Self(wanted)
    }

    /// Measures, and says what was read; every fault of the arguments at once.
    fn measure(self, arguments: Arguments, exhibit: Exhibit) -> Result<(), Failure> {
        let mut faults = Vec::new();
        let width = arguments.px.map_or(WIDTH_PX, |[width, _]| width);
        let overrides = arguments.scene.overrides();
        let scene = overrides.apply(exhibit.clone(), width).or_else(|found| {
            faults.extend(found);
            // Places are judged on the side all the same, so that all is said at once.
            let side = Overrides {
                scene: overrides.scene.clone(),
                drawing: overrides.drawing.clone(),
                side: overrides.side,
                ..Overrides::default()
            };
            side.apply(exhibit, width)
        });
        let mut read = Vec::new();
        if let Ok((exhibit, mut scene)) = scene {
            let sheet = exhibit.drawing_of(&scene).size_mm;
            if let Some([width, height]) = arguments.px {
                // As recto render does.
                let aspect = f64::from(width) / f64::from(height);
                let aspect = exhibit.own_aspect(&scene, aspect);
                scene.camera = scene.camera.fitted(sheet, aspect);
            }
            let state = arguments
                .against
                .as_deref()
                .map(|id| state(&exhibit, &scene, id));
            let state = match state.transpose() {
                Ok(state) => state.flatten(),
                Err(fault) => {
                    faults.push(*fault);
                    None
                }
            };
            let sight = match arguments
                .px
                .map(|px| Sight::new(&exhibit, &scene, px))
                .transpose()
            {
                Ok(sight) => sight,
                Err(error) => {
                    faults.push(told(&exhibit, "--px", &error));
                    None
                }
            };
            let mut desk = Desk::new(&exhibit, scene.clone());
            for Wanted { option, tool } in self.0 {
                let tool = tool.and_then(|tool| placed(tool, &option, sight.as_ref(), scene.side));
                match tool {
                    Ok(Placed {
                        tool,
                        screen_mm,
                        of,
                    }) => match on(&mut desk, &exhibit, of.unwrap_or(&scene))
                        .read(&with_state(tool, state), screen_mm)
                    {
                        Ok(reading) => read.push(reading),
                        Err(errors) => {
                            let told = errors.iter().map(|error| told(&exhibit, &option, error));
                            faults.extend(told);
                        }
                    },
                    Err(found) => faults.extend(found),
                }
            }
            if let Some(faults) = Faults::new(faults) {
                return Err(faults.into());
            }
            return say(
                &exhibit,
                &scene,
                &read,
                arguments.json,
                arguments.csv.as_deref(),
                arguments.plot.as_deref(),
            );
        }
        faults.extend(self.0.into_iter().filter_map(|w| w.tool.err()).flatten());
        match Faults::new(faults) {
            Some(faults) => Err(faults.into()),
            None => Err(Failure::Usage("nothing to measure".to_owned())),
        }
    }
}

type Read = Result<Tool, Vec<Fault>>;

/// Places as an option says them.
struct Spec<'a> {
    option: &'a str,
    text: &'a str,
}

impl Spec<'_> {
    fn fault(&self, found: String, allowed: &str) -> Vec<Fault> {
        let remedy = match self.option.starts_with("--probe") {
            true => "write it like 20,30 or 20,30,2",
            false => "write it like 20,30:120,30",
        };
        vec![Fault {
            unreadable: true,
            ..fault(self.option, found, allowed, remedy)
        }]
    }

    /// The numbers of each place, 2 or up to `most`.
    fn numbers(&self, most: usize) -> Result<Vec<Vec<f64>>, Vec<Fault>> {
        let mut places = Vec::new();
        for text in self.text.split(':') {
            let numbers: Option<Vec<f64>> = text
                .split([',', 'x'])
                .map(|number| number.trim().parse().ok().filter(|n: &f64| n.is_finite()))
                .collect();
            match numbers.filter(|numbers| (2..=most).contains(&numbers.len())) {
                Some(numbers) => places.push(numbers),
                None => {
                    let allowed = match most {
                        2 => "places of two numbers, x,y",
                        _ => "places of two or three numbers, x,y or x,y,radius",
                    };
                    return Err(self.fault(quote(text), allowed));
                }
            }
        }
        Ok(places)
    }

    fn any(&self, least: usize) -> Result<Vec<DVec2>, Vec<Fault>> {
        let places = self.numbers(2)?;
        if places.len() < least {
            let found = format!("{} places", places.len());
            return Err(self.fault(
                found,
                &format!("{least} places or more, with colons between"),
            ));
        }
        Ok(places.iter().map(|p| DVec2::new(p[0], p[1])).collect())
    }

    fn places<const N: usize>(&self) -> Result<[DVec2; N], Vec<Fault>> {
        let places = self.any(1)?;
        let count = places.len();
        places.try_into().map_err(|_| {
            let plural = if count == 1 { "" } else { "s" };
            self.fault(
                format!("{count} place{plural}"),
                &format!("{N} places, with colons between"),
            )
        })
    }

    fn probe(&self, against: bool) -> Read {
        let places = self.numbers(3)?;
        let mut faults = Vec::new();
        let mut disc = |place: &Vec<f64>| {
            let radius_mm = place.get(2).copied().unwrap_or(PROBE_MM);
            if radius_mm <= 0.0 {
                let found = format!("a radius of {radius_mm} mm");
                faults.extend(self.fault(found, "a radius above 0"));
            }
            Disc {
                middle: DVec2::new(place[0], place[1]),
                radius_mm,
            }
        };
        let discs: Vec<Disc> = places.iter().map(&mut disc).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        match (discs.as_slice(), against) {
            // The state is filled in when it is known.
            ([one], true) => Ok(Tool::Against(*one, None)),
            ([one], false) => Ok(Tool::Probe(*one)),
            ([first, second], false) => Ok(Tool::Difference([*first, *second])),
            (_, true) => Err(self.fault(
                format!("{} places together with --against", discs.len()),
                "one place",
            )),
            (_, false) => Err(self.fault(format!("{} places", discs.len()), "one place or two")),
        }
    }
}

fn with_state(tool: Tool, state: Option<usize>) -> Tool {
    match tool {
        Tool::Against(disc, _) => Tool::Against(disc, state),
        tool => tool,
    }
}

/// A state of the drawing by its id; `None` is the sheet as its sides describe it.
fn state(exhibit: &Exhibit, scene: &Scene, id: &str) -> Result<Option<usize>, Box<Fault>> {
    let drawing = exhibit.drawing_of(scene);
    if id == NO_STATE {
        return Ok(None);
    }
    drawing
        .state(id)
        .map(|(index, _)| Some(index))
        .ok_or_else(|| {
            let ids = drawing.states.iter().map(|state| state.id.as_str());
            let ids = ids.chain([NO_STATE]);
            Box::new(fault(
                "--against",
                quote(id),
                format!("the id of a state: {}", quoted_list(ids.clone())),
                did_you_mean(id, ids, "correct it"),
            ))
        })
}

/// A tool with its places in mm.
struct Placed<'s> {
    tool: Tool,
    /// Size of a pixel there, in mm.
    screen_mm: f64,
    /// The member of a comparison that its places were seen on.
    of: Option<&'s Scene>,
}

/// The same desk, at another member of a comparison.
fn on<'d, 'e>(desk: &'d mut Desk<'e>, exhibit: &'e Exhibit, scene: &Scene) -> &'d mut Desk<'e> {
    let shelf = std::mem::replace(desk, Desk::new(exhibit, scene.clone())).clear();
    *desk = Desk::with(exhibit, scene.clone(), shelf);
    desk
}

/// The tool with its places in mm.
fn placed<'s>(
    tool: Tool,
    option: &str,
    sight: Option<&'s Sight>,
    side: SideName,
) -> Result<Placed<'s>, Vec<Fault>> {
    let Some(sight) = sight else {
        return Ok(Placed {
            tool,
            screen_mm: 0.0,
            of: None,
        });
    };
    let mut of: Vec<&Scene> = Vec::new();
    let mut screen_mm = 0.0f64;
    let mut faults = Vec::new();
    // What curls up far enough shows its back.
    let seen = |pixel: DVec2| sight.seen(pixel).filter(|seen| seen.side == side);
    let mut place = |pixel: DVec2| match seen(pixel) {
        Some(Seen {
            mm,
            pixel_mm,
            sheet,
            ..
        }) => {
            screen_mm = screen_mm.max(pixel_mm);
            of.extend(sight.scene(sheet));
            mm
        }
        None => {
            faults.push(fault(
                option,
                format!("{},{} px, beside the sheet", pixel.x, pixel.y),
                "pixels in which the sheet is seen",
                "count them from the top left corner of the picture",
            ));
            pixel
        }
    };
    let mut disc = |disc: Disc| Disc {
        middle: place(disc.middle),
        ..disc
    };
    let tool = match tool {
        Tool::Probe(one) => Tool::Probe(disc(one)),
        Tool::Against(one, state) => Tool::Against(disc(one), state),
        Tool::Difference(two) => Tool::Difference(two.map(disc)),
        Tool::Ruler(two) => Tool::Ruler(two.map(place)),
        Tool::Profile(two) => Tool::Profile(two.map(place)),
        Tool::Lines(two) => Tool::Lines(two.map(place)),
        Tool::Stroke(two) => Tool::Stroke(two.map(place)),
        Tool::Angle(three) => Tool::Angle(three.map(place)),
        Tool::Path { places, closed } => Tool::Path {
            places: places.into_iter().map(place).collect(),
            closed,
        },
    };
    if of.iter().any(|member| member.state != of[0].state) {
        faults.push(fault(
            option,
            "places on members in different states",
            "places on one member",
            "move them, or give two tools",
        ));
    }
    if faults.is_empty() {
        Ok(Placed {
            tool,
            screen_mm,
            of: of.first().copied(),
        })
    } else {
        Err(faults)
    }
}

fn told(exhibit: &Exhibit, option: &str, error: &ReadingError) -> Fault {
    if let ReadingError::Map { path, error } = error {
        return exhibit.map_fault(path, error);
    }
    let (allowed, remedy) = error.remedy();
    fault(option, error.to_string(), allowed, remedy)
}

fn fault(
    option: &str,
    found: impl Into<String>,
    allowed: impl Into<String>,
    remedy: impl Into<String>,
) -> Fault {
    Fault {
        severity: Severity::Error,
        file: None,
        place: None,
        path: option.to_owned(),
        found: found.into(),
        allowed: allowed.into(),
        remedy: remedy.into(),
        unreadable: false,
    }
}

fn say(
    exhibit: &Exhibit,
    scene: &Scene,
    readings: &[Reading],
    json: bool,
    csv: Option<&std::path::Path>,
    plot_file: Option<&std::path::Path>,
) -> Result<(), Failure> {
    if let Some(path) = csv {
        let text = table::csv((1..).zip(readings));
        encode::write_whole(path, |file| file.write_all(text.as_bytes()))?;
    }
    let profile = readings.iter().find(|reading| !reading.samples.is_empty());
    if let (Some(path), Some(profile)) = (plot_file, profile) {
        let title = format!("{}: {}", scene.side.word(), profile.words);
        let pixels = plot::pixels(&Labels::english(&title), &profile.samples, legend::face())
            .map_err(|error| Failure::Input(Box::new(error)))?;
        let [width, height] = plot::SIZE;
        encode::save_png_rgb8(path, width, height, &pixels, None)?;
    }
    if json {
        let drawing = exhibit.drawing_of(scene);
        return output::result(as_json(&Sheet {
            sound: true,
            program: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            manifest: exhibit.manifest.display().to_string(),
            scene: &scene.id,
            drawing: &drawing.id,
            side: scene.side,
            state: scene.state.map(|index| drawing.states[index].id.as_str()),
            uncertainty: "standard uncertainty, 1 sigma",
            readings,
        })?);
    }
    for reading in readings {
        output::result(&reading.words)?;
    }
    let mut said: Vec<&Note> = Vec::new();
    for note in readings.iter().flat_map(|reading| &reading.notes) {
        if !said.contains(&note) {
            said.push(note);
            output::say(format_args!("note: {note}"));
        }
    }
    output::say("± is one standard uncertainty (1 σ)");
    Ok(())
}

fn as_json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|error| Failure::Input(Box::new(error)))
}
