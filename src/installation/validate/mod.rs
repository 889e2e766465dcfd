//! From what was written to what can be relied on: [`RawInstallation`] → [`Installation`],
//! gathering every fault.

mod displays;
mod hours;
mod machines;

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
    time::Duration,
};

use super::{
    Every, Exhibits, Idle, Installation, Interface, Logs, Pin, PlaceAccuracy, Reach, Use,
    raw::{RawExhibits, RawInstallation, RawStatus},
    values::MachinePath,
};
use crate::manifest::{
    MANIFEST, Pattern,
    decode::Report,
    document::{Trail, Words},
    normalised, published, quote,
    raw::values::Language,
};

/// Where the status page is read unless the installation says otherwise.
const STATUS: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8017);
/// Where there is no status page.
const OFF: &str = "off";

/// What all parts of the validation share.
struct Validator<'r, 'd> {
    report: &'r mut Report<'d>,
    /// The installation file's own.
    folder: PathBuf,
}

/// Validates the installation of `file`. `None` only if there are faults in `report`.
pub(super) fn installation(
    raw: &RawInstallation,
    file: &Path,
    used: Use,
    report: &mut Report<'_>,
) -> Option<Installation> {
    let folder = file.parent().unwrap_or(Path::new("")).to_owned();
    Validator { report, folder }.installation(raw, file, used)
}

impl Validator<'_, '_> {
    fn installation(
        &mut self,
        raw: &RawInstallation,
        file: &Path,
        used: Use,
    ) -> Option<Installation> {
        let root = Trail::default();
        let exhibits = self.exhibits(&raw.exhibits, &root.key("exhibits"));
        let languages = self.languages(raw, &root.key("languages"));
        let wall = self.wall(raw, &root);
        let machines = self.machines(raw, &root);
        let reach = self.reach(raw, wall.as_ref(), &root.key("reach"));
        let idle = idle(raw);
        let hours = self.hours(raw.hours.as_ref(), &root.key("hours"));
        let interface = self.interface(raw, &root.key("interface"));
        let logs = self.logs(raw, &root.key("logs"));
        let status = self.status(raw.status.as_ref(), &root.key("status"));
        let pin = self.pin(raw, used, &root.key("staff"));
        let accuracy = raw.accuracy.as_ref();
        Some(Installation {
            file: file.to_owned(),
            exhibits: exhibits?,
            languages,
            wall,
            machines,
            reach: reach?,
            idle,
            hours: hours?,
            accuracy: PlaceAccuracy {
                max_delta_e: accuracy.and_then(|a| a.max_delta_e).map(|e| e.0),
                frame_ms: accuracy.and_then(|a| a.frame_ms).map(|ms| ms.0),
            },
            interface,
            logs,
            status,
            pin,
        })
    }

    /// A path as the program opens it.
    fn path(&self, path: &MachinePath) -> PathBuf {
        self.folder.join(path.as_str())
    }

    fn exhibits(&mut self, raw: &RawExhibits, trail: &Trail) -> Option<Exhibits> {
        let mut folders = Vec::new();
        for (i, folder) in raw.folders.iter() {
            let path = self.path(folder);
            if published::current(&path)
                .unwrap_or(path.clone())
                .join(MANIFEST)
                .is_file()
            {
                folders.push(path);
                continue;
            }
            let found = match path.is_dir() {
                true => format!("{}, a folder without an {MANIFEST}", quote(folder.as_str())),
                false => format!("{}, which is not there", quote(folder.as_str())),
            };
            let words = Words::new(
                found,
                "an exhibit's folder, or one that `recto publish` writes to",
                "correct the path, or put the exhibit there",
            );
            self.report.fault(&trail.key("folders").index(i), words);
        }
        let every = raw.every_minutes.map_or(Every::Day, |minutes| {
            Every::Minutes(minutes.0.unsigned_abs())
        });
        if raw.every_day == Some(false) {
            let words = Words::new("false", "true", "write every_minutes instead, or remove it");
            self.report.fault(&trail.key("every_day"), words);
        }
        (!folders.is_empty()).then_some(Exhibits { folders, every })
    }

    fn languages(&mut self, raw: &RawInstallation, trail: &Trail) -> Vec<String> {
        let mut languages = Vec::new();
        for (i, language) in raw.languages.iter().flat_map(|list| list.iter()) {
            let words = match normalised(language.as_str()) {
                Ok(tag) if languages.contains(&tag) => Words::new(
                    format!("\"{tag}\" a second time"),
                    "each language once",
                    "remove one of the two",
                ),
                Ok(tag) => {
                    languages.push(tag);
                    continue;
                }
                Err(reason) => Words::new(
                    format!("\"{}\" ({reason})", language.as_str()),
                    Language::ALLOWED,
                    Language::REMEDY,
                ),
            };
            self.report.fault(&trail.index(i), words);
        }
        languages
    }

    fn interface(&mut self, raw: &RawInstallation, trail: &Trail) -> Interface {
        let Some(raw) = &raw.interface else {
            return Interface::default();
        };
        let mut folder = |path: &Option<MachinePath>, key: &str| {
            let name = path.as_ref()?;
            let path = self.path(name);
            if !path.is_dir() {
                let found = match path.exists() {
                    true => format!("{}, which is not a folder", quote(name.as_str())),
                    false => format!("{}, which is not there", quote(name.as_str())),
                };
                let words = Words::new(found, "a folder", "make it, correct the path or remove it");
                self.report.fault(&trail.key(key), words);
            }
            Some(path)
        };
        Interface {
            wording: folder(&raw.wording, "wording"),
            fonts: folder(&raw.fonts, "fonts"),
            enlarge: raw.enlarge.map_or(1.0, |enlarge| enlarge.0),
            contrast: raw.contrast.unwrap_or_default(),
            reduced_motion: raw.reduced_motion.unwrap_or(false),
        }
    }

    fn logs(&mut self, raw: &RawInstallation, trail: &Trail) -> Option<Logs> {
        /// As disks are sold.
        const MEGABYTE: u64 = 1_000_000;
        let raw = raw.logs.as_ref()?;
        let folder = self.path(&raw.folder);
        if folder.exists() && !folder.is_dir() {
            let words = Words::new(
                format!("{}, which is not a folder", quote(raw.folder.as_str())),
                "a folder, which may be yet to be made",
                "choose another name",
            );
            self.report.fault(&trail.key("folder"), words);
        }
        Some(Logs {
            folder,
            max_bytes: raw
                .max_megabytes
                .map_or(10, |megabytes| u64::from(megabytes.0.unsigned_abs()))
                * MEGABYTE,
            keep: raw.keep.map_or(7, |keep| keep.0.unsigned_abs() as usize),
            usage_counts: raw.usage_counts.unwrap_or(false),
        })
    }

    fn status(&mut self, raw: Option<&RawStatus>, trail: &Trail) -> Option<SocketAddr> {
        let Some(text) = raw.and_then(|raw| raw.address.as_ref()) else {
            return Some(STATUS);
        };
        let text = text.as_str();
        if text == OFF {
            return None;
        }
        let trail = trail.key("address");
        let allowed = format!("an address and a port such as \"{STATUS}\", or \"{OFF}\"");
        let address: SocketAddr = match text.parse() {
            Ok(address) => address,
            Err(_) => {
                let remedy = match text.strip_prefix("localhost:") {
                    Some(port) => format!("write \"127.0.0.1:{port}\""),
                    None => "write numbers, a colon and the port".to_owned(),
                };
                self.report
                    .fault(&trail, Words::new(quote(text), allowed, remedy));
                return None;
            }
        };
        let meant = raw.and_then(|raw| raw.beyond_this_machine) == Some(true);
        if address.port() == 0 {
            let words = Words::new("port 0", "ports from 1 to 65535", "write another port");
            self.report.fault(&trail, words);
        } else if !address.ip().is_loopback() && !meant {
            let words = Words::new(
                format!("{}, which other machines reach", quote(text)),
                "addresses that only this machine reaches, such as \"127.0.0.1:8017\"",
                "change it, or add beyond_this_machine = true if that is meant",
            );
            self.report.fault(&trail, words);
        } else if address.ip().is_loopback() && meant {
            let words = Words::new(
                format!("{}, which only this machine reaches", quote(text)),
                "an address of this machine in its network, such as \"0.0.0.0:8017\"",
                "change it, or remove beyond_this_machine",
            );
            self.report.warn(&trail, words);
        }
        Some(address)
    }

    fn pin(&mut self, raw: &RawInstallation, used: Use, trail: &Trail) -> Option<Pin> {
        let trail = trail.key("pin");
        let allowed = "4 to 12 digits in quotation marks that nobody tries first";
        let Some(digits) = raw.staff.as_ref().and_then(|staff| staff.pin.as_ref()) else {
            // One at fault has said so.
            if used == Use::Kiosk && !self.report.faulty_within(&trail) {
                let remedy = "add pin = \"…\" below [staff]; --kiosk needs one";
                let words = Words::new("nothing", allowed, remedy);
                self.report.fault(&trail, words);
            }
            return None;
        };
        match Pin::new(&digits.0) {
            Ok(pin) => Some(pin),
            Err(why) => {
                let words = Words::new(format!("a PIN {why}"), allowed, "choose another one");
                self.report.fault(&trail, words);
                None
            }
        }
    }

    fn reach(
        &mut self,
        raw: &RawInstallation,
        wall: Option<&super::Wall>,
        trail: &Trail,
    ) -> Option<Reach> {
        let usual = Reach::default();
        let written = raw.reach.as_ref();
        let from = written.and_then(|reach| reach.from_mm);
        let to = written.and_then(|reach| reach.to_mm);
        let reach = Reach {
            from_mm: from.map_or(usual.from_mm, |mm| mm.0),
            to_mm: to.map_or(usual.to_mm, |mm| mm.0),
        };
        if reach.from_mm >= reach.to_mm {
            let words = Words::new(
                format!("from {} to {} mm", reach.from_mm, reach.to_mm),
                "to_mm above from_mm",
                "exchange or correct them",
            );
            self.report.fault(trail, words);
            return None;
        }
        let out_of_reach = wall.filter(|wall| {
            let reached = |display| wall.reach_px(display, &reach).is_some();
            !wall.displays.iter().any(reached)
        });
        if out_of_reach.is_some() {
            let words = Words::new(
                format!(
                    "no display between {} and {} mm above the floor",
                    reach.from_mm, reach.to_mm
                ),
                "a display that hands reach",
                "correct bottom_above_floor_mm, or [reach] if these hands reach elsewhere",
            );
            self.report.fault(trail, words);
        }
        // The usual reach says nothing either, but nobody has asked for it.
        let is_asked = from.is_some() || to.is_some();
        let knows_floor = wall.is_some_and(|wall| wall.top_above_floor_mm.is_some());
        let floor = Trail::default().key("bottom_above_floor_mm");
        if is_asked && !knows_floor && !self.report.faulty_within(&floor) {
            let words = Words::new(
                "a reach above a floor that no display is said to be above",
                "it together with bottom_above_floor_mm, without which controls lie anywhere",
                "add bottom_above_floor_mm above the first table, and each [[display]] with its size_mm",
            );
            self.report.warn(trail, words);
        }
        Some(reach)
    }
}

fn idle(raw: &RawInstallation) -> Idle {
    let usual = Idle::default();
    let raw = raw.idle.as_ref();
    let after = raw.and_then(|idle| idle.seconds);
    let countdown = raw.and_then(|idle| idle.countdown_seconds);
    Idle {
        after: after.map_or(usual.after, |s| Duration::from_secs_f64(s.0)),
        countdown: countdown.map_or(usual.countdown, |s| Duration::from_secs_f64(s.0)),
        chime: raw.and_then(|idle| idle.chime).unwrap_or(usual.chime),
    }
}
