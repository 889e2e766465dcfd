//! `recto check --installation`: what an installation file means, in words.

use std::{
    fmt::{self, Display, Formatter},
    path::Path,
};

use jiff::{ToSpan, Zoned};

use super::{Failure, output};
use crate::{
    installation::{Every, Installation, Machines, Profile, Wall, WallWindow, Windows},
    manifest::{Exhibit, Fault, Faults},
    wall::house,
};

/// Checks the installation of `file` and every exhibit that it names.
pub fn check(file: &Path) -> Result<(), Failure> {
    let (installation, mut warnings) = Installation::read(file)?;
    let mut exhibits = Vec::new();
    let mut faults = Vec::new();
    match house::wordings(&installation) {
        Ok((_, more)) => warnings.extend(more),
        Err(found) => faults.extend(found),
    }
    for folder in &installation.exhibits.folders {
        match checked(folder) {
            Ok((exhibit, more)) => {
                exhibits.push(exhibit);
                warnings.extend(more);
            }
            Err(found) => faults.extend(found),
        }
    }
    if let Some(faults) = Faults::new(faults) {
        super::warn(&warnings);
        return Err(faults.into());
    }
    super::warn(&warnings);
    let now = Zoned::now();
    output::result(Place {
        installation: &installation,
        exhibits: &exhibits,
        now: &now,
    })
}

/// An exhibit, its pixels included, with its warnings.
fn checked(folder: &Path) -> Result<(Exhibit, Vec<Fault>), Faults> {
    let (exhibit, mut warnings) = Exhibit::read(folder)?;
    warnings.extend(exhibit.verify(exhibit.maps())?);
    Ok((exhibit, warnings))
}

/// An installation in words.
struct Place<'i> {
    installation: &'i Installation,
    /// In the order of its folders.
    exhibits: &'i [Exhibit],
    now: &'i Zoned,
}

impl Display for Place<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let place = self.installation;
        writeln!(f, "{}: sound", place.file.display())?;
        match &place.wall {
            Some(wall) => self.wall(wall, f)?,
            None => writeln!(f, "  the display that there is, as the system describes it")?,
        }
        if let (Some(machines), Some(wall)) = (&place.machines, &place.wall) {
            self.machines(machines, wall, f)?;
        }
        self.hours(f)?;
        let turns = match (place.exhibits.every, self.exhibits.len()) {
            (_, 1) => "always".to_owned(),
            (Every::Day, _) => "each for a day".to_owned(),
            (Every::Minutes(1), _) => "each for a minute".to_owned(),
            (Every::Minutes(minutes), _) => format!("each for {minutes} minutes"),
        };
        writeln!(f, "  exhibits, {turns}:")?;
        for exhibit in self.exhibits {
            let title = exhibit
                .title
                .0
                .values()
                .next()
                .map_or(String::new(), |title| format!(" \"{title}\""));
            let scenes = exhibit.scenes.len();
            let scenes = match scenes {
                1 => "1 scene".to_owned(),
                scenes => format!("{scenes} scenes"),
            };
            writeln!(
                f,
                "    {}{title}, {scenes}, sound",
                exhibit.folder.display()
            )?;
        }
        let languages = match &place.languages[..] {
            [] => "those of each exhibit".to_owned(),
            [home] => home.clone(),
            [home, others @ ..] => format!("{home}, and {}", others.join(", ")),
        };
        writeln!(f, "  languages: {languages}")?;
        writeln!(
            f,
            "  after {} s without a touch a countdown of {} s",
            place.idle.after.as_secs_f64(),
            place.idle.countdown.as_secs_f64()
        )?;
        match &place.logs {
            Some(logs) => writeln!(
                f,
                "  logs in {}, {} files of {} MB at most; scenes and languages are {}counted",
                logs.folder.display(),
                logs.keep,
                logs.max_bytes / 1_000_000,
                if logs.usage_counts { "" } else { "not " }
            )?,
            None => writeln!(f, "  no logs, and nothing is counted")?,
        }
        match place.status {
            Some(address) => writeln!(f, "  status at http://{address}/")?,
            None => writeln!(f, "  no status page")?,
        }
        match place.pin {
            Some(_) => write!(f, "  the staff's panel opens with the PIN"),
            None => write!(f, "  no PIN: --kiosk is refused until [staff] has one"),
        }
    }
}

/// How windows lie on displays.
fn windows(wall: &Wall, windows: &[WallWindow]) -> String {
    match (wall.windows, windows) {
        (Windows::Spanning, [window]) => {
            let [width, height] = window.on_desktop.size;
            format!("one window of {width} × {height} pixels")
        }
        (_, [_]) => "1 window".to_owned(),
        (_, windows) => format!("{} windows", windows.len()),
    }
}

impl Place<'_> {
    fn machines(&self, machines: &Machines, wall: &Wall, f: &mut Formatter<'_>) -> fmt::Result {
        for name in &machines.names {
            let layout = wall.layout_on(Some(name));
            let mine = layout.iter().flat_map(|window| &window.panes);
            let mine: Vec<&str> = mine
                .map(|pane| wall.displays[pane.display].id.as_str())
                .collect();
            let role = match *name == machines.lead {
                true => format!("leads, at {}", machines.address),
                false => format!("follows after {} ms", machines.delay.as_secs_f64() * 1e3),
            };
            writeln!(
                f,
                "    machine {name} {role}: {}, {}",
                mine.join(", "),
                windows(wall, &layout)
            )?;
        }
        Ok(())
    }

    fn wall(&self, wall: &Wall, f: &mut Formatter<'_>) -> fmt::Result {
        let size = wall.size_mm();
        let displays = match wall.displays.len() {
            1 => "1 display".to_owned(),
            count => format!("{count} displays"),
        };
        let windows = match &self.installation.machines {
            Some(machines) => format!("{} machines", machines.names.len()),
            None => windows(wall, &wall.layout()),
        };
        let height = wall.top_above_floor_mm.map_or(String::new(), |top| {
            format!(", from {:.0} to {top:.0} mm above the floor", top - size.y)
        });
        writeln!(
            f,
            "  {displays} on {:.1} × {:.1} mm{height}, {windows}",
            size.x, size.y
        )?;
        for display in &wall.displays {
            let [width, height] = display.on_desktop.size;
            let [x, y] = display.on_desktop.at;
            let ppi = display.px_per_mm().x * 25.4;
            let controls = match wall.reach_px(display, &self.installation.reach) {
                Some(band) => format!("controls in rows {:.0} to {:.0}", band.start, band.end),
                None => "out of reach, without controls".to_owned(),
            };
            let profile = match &display.profile {
                Profile::Srgb => "sRGB".to_owned(),
                Profile::Measured {
                    white_xy: [x, y],
                    gamma,
                    ..
                } => format!("white measured at {x}, {y}, gamma {gamma}"),
                Profile::Icc { path, .. } => path.display().to_string(),
            };
            writeln!(
                f,
                "    {}: {width} × {height} pixels from {x}, {y}, {ppi:.0} per inch, at {:.1}, {:.1} mm; \
                 {controls}; {profile}",
                display.id, display.on_wall.min.x, display.on_wall.min.y
            )?;
        }
        Ok(())
    }

    fn hours(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let hours = &self.installation.hours;
        let here = self.now.with_time_zone(hours.time_zone.clone());
        let zone = hours.time_zone.iana_name().unwrap_or("the system's time");
        let state = match hours.is_open(self.now) {
            true => "open",
            false => "closed",
        };
        let until = hours.next_change(self.now).map_or(String::new(), |next| {
            format!(" until {}", next.strftime("%a %Y-%m-%d %H:%M"))
        });
        writeln!(f, "  hours ({zone}), now {state}{until}:")?;
        for date in here.date().series(1.day()).take(7) {
            let spans: Vec<String> = hours.spans(date).iter().map(ToString::to_string).collect();
            let spans = match &spans[..] {
                [] => "closed".to_owned(),
                spans => spans.join(", "),
            };
            writeln!(f, "    {}  {spans}", date.strftime("%a %Y-%m-%d"))?;
        }
        match hours.next_restart(self.now) {
            Some(restart) => writeln!(
                f,
                "  begins anew next at {}",
                restart.strftime("%a %Y-%m-%d %H:%M")
            ),
            None => Ok(()),
        }
    }
}
