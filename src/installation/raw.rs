//! The installation file as written: plain data, every key declared once.
//!
//! What is declared here is what [`schema`](super::schema()) publishes, and its comments are what
//! a technician's editor shows; so they speak to technicians.

use super::{
    interface::Contrast,
    values::{
        ClockText, ClosedText, CountdownSeconds, DelayMs, DesktopPx, DisplayMm, DisplayNits,
        Enlargement, EveryMinutes, FloorMm, Gamma, IdleSeconds, LogFiles, LogMegabytes,
        LostSeconds, MachinePath, PinText, ReachMm, SidePx, SpanText, WallMm, WhiteXy,
    },
    wall::Windows,
};
use crate::manifest::{
    decode::{List, Rule},
    macros::record,
    raw::values::{DeltaE, FrameMs, Id, Language, Text},
};

record! {
    /// The place where exhibits are shown: the file installation.toml.
    pub struct RawInstallation {
        required {
            /// What is shown.
            exhibits: RawExhibits,
        }
        optional {
            /// The languages offered, by their BCP 47 tags; the first is the one that everything
            /// returns to. Without it: those of each exhibit.
            languages: List<Language, 1, 64>,
            /// One window over all displays (spanning), or one on each (each). Without it: spanning.
            windows: Windows,
            /// How far above the floor the lower edge of the lowest display's visible area is, in
            /// mm, where displays do not say it themselves.
            bottom_above_floor_mm: FloorMm,
            /// The displays, each below its own `[[display]]`. Without any, the one that there is.
            display: List<RawDisplay, 1, 32>,
            /// Several machines that carry this wall together; each of them has this file. Without it,
            /// this machine alone.
            machines: RawMachines,
            /// Where hands reach.
            reach: RawReach,
            /// When nobody is there.
            idle: RawIdle,
            /// When the screens are lit. Without it: always.
            hours: RawHours,
            /// How exact pictures have to be here, instead of what each exhibit asks for.
            accuracy: RawPlaceAccuracy,
            /// How texts and controls look before a visitor changes it.
            interface: RawInterface,
            /// What is written down.
            logs: RawLogs,
            /// The page that says how the wall is.
            status: RawStatus,
            /// Who may leave the exhibit.
            staff: RawStaff,
        }
        rules []
    }
}

record! {
    /// What is shown.
    pub struct RawExhibits {
        required {
            /// The exhibits' folders, or folders that `recto publish` writes to, in the order of
            /// their turns; from the installation file's folder or from /.
            folders: List<MachinePath, 1, 100>,
        }
        optional {
            /// How many minutes each is shown.
            every_minutes: EveryMinutes,
            /// Each is shown for a day; so it is without either, too.
            every_day: bool,
        }
        rules [Rule::AtMostOne(&["every_minutes", "every_day"])]
    }
}

record! {
    /// One display.
    pub struct RawDisplay {
        required {
            /// A name for messages and logs.
            id: Id,
            /// Width and height in pixels, as it hangs.
            pixels: [SidePx; 2],
            /// Width and height of the visible area in mm, without the frame, as it hangs.
            size_mm: [DisplayMm; 2],
        }
        optional {
            /// From the left end of the wall to the left edge of the visible area, in mm. Without
            /// it: 0.
            left_mm: WallMm,
            /// From the upper end of the wall down to the upper edge of the visible area, in mm.
            /// Without it: 0.
            top_mm: WallMm,
            /// From the floor up to the lower edge of the visible area, in mm; instead of top_mm.
            bottom_above_floor_mm: FloorMm,
            /// Where its first pixel lies on the desktop. Without it: right of those before it.
            desktop_px: [DesktopPx; 2],
            /// What the system calls it, such as DP-1 or HDMI-2. Without it: what shows
            /// desktop_px.
            monitor: Text,
            /// The machine that it is plugged into, where there are several.
            machine: Id,
            /// How it shows colours. Without it: as sRGB says.
            profile: RawProfile,
        }
        rules [Rule::AtMostOne(&["top_mm", "bottom_above_floor_mm"])]
    }
}

record! {
    /// Several machines that carry one wall together.
    pub struct RawMachines {
        required {
            /// The machine that hands touch, by the name that displays give it; the others follow it.
            lead: Id,
            /// That machine's address and a port of it, at which the others reach it.
            address: Text,
        }
        optional {
            /// The address is reached by other machines, and is meant to be.
            beyond_this_machine: bool,
            /// How many ms after the leader the others show a picture, to be even where the network is
            /// not. Without it: 10.
            delay_ms: DelayMs,
            /// After how many seconds without a word a machine is told of as lost. Without it: 5.
            lost_after_seconds: LostSeconds,
        }
        rules []
    }
}

record! {
    /// How a display shows colours: its ICC profile, or what was measured on it.
    pub struct RawProfile {
        required {}
        optional {
            /// The display's ICC profile (.icc).
            icc: MachinePath,
            /// CIE 1931 chromaticity of its white.
            white_xy: [WhiteXy; 2],
            /// Exponent of its tone curve. Without it: 2.2.
            gamma: Gamma,
            /// Luminance of its white in cd/m².
            luminance_nits: DisplayNits,
        }
        rules [
            Rule::ExactlyOne(&["icc", "white_xy"]),
            Rule::Needs("gamma", "white_xy"),
        ]
    }
}

record! {
    /// Where hands reach: controls lie within.
    pub struct RawReach {
        required {}
        optional {
            /// The lowest place in mm above the floor. Without it: 380.
            from_mm: ReachMm,
            /// The highest place in mm above the floor. Without it: 1220.
            to_mm: ReachMm,
        }
        rules []
    }
}

record! {
    /// When nobody is there.
    pub struct RawIdle {
        required {}
        optional {
            /// After how many seconds without a touch the countdown begins. Without it: 120.
            seconds: IdleSeconds,
            /// How many seconds the countdown can be refused. Without it: 15.
            countdown_seconds: CountdownSeconds,
            /// A soft sound begins the countdown, for those who do not look. Without it: true.
            chime: bool,
        }
        rules []
    }
}

record! {
    /// When the screens are lit; a day without hours of its own has those of every_day, or is
    /// closed; where no day has any, every day is open.
    pub struct RawHours {
        required {}
        optional {
            /// The time zone by its IANA name, such as Europe/Rome. Without it: the system's.
            time_zone: Text,
            /// Days without hours of their own.
            every_day: List<SpanText, 0, 12>,
            /// Mondays: "10:00-13:00" and so on; [] is closed; "18:00-02:00" ends on the next day.
            monday: List<SpanText, 0, 12>,
            /// Tuesdays.
            tuesday: List<SpanText, 0, 12>,
            /// Wednesdays.
            wednesday: List<SpanText, 0, 12>,
            /// Thursdays.
            thursday: List<SpanText, 0, 12>,
            /// Fridays.
            friday: List<SpanText, 0, 12>,
            /// Saturdays.
            saturday: List<SpanText, 0, 12>,
            /// Sundays.
            sunday: List<SpanText, 0, 12>,
            /// Days on which nothing opens: "2026-12-24", "12-25" of every year, or
            /// "2027-01-11/2027-02-05" from one to another. What opened the evening before stays
            /// open to its end.
            closed: List<ClosedText, 0, 1000>,
            /// When the program begins anew each night. Without it: never.
            restart: ClockText,
        }
        rules []
    }
}

record! {
    /// How exact pictures have to be here.
    pub struct RawPlaceAccuracy {
        required {}
        optional {
            /// The largest colour difference ΔE00 from the exact picture. Without it: the exhibit's.
            max_delta_e: DeltaE,
            /// The longest time in ms for one frame while something moves. Without it: the
            /// exhibit's.
            frame_ms: FrameMs,
        }
        rules []
    }
}

record! {
    /// How texts and controls look before a visitor changes it.
    pub struct RawInterface {
        required {}
        optional {
            /// A folder with the museum's own wording, as LANGUAGE.ftl.
            wording: MachinePath,
            /// A folder with fonts.
            fonts: MachinePath,
            /// How much larger texts are, 1 to 3. Without it: 1.
            enlarge: Enlargement,
            /// The contrast of texts and controls: normal or high. Without it: normal.
            contrast: Contrast,
            /// Nothing glides or fades. Without it: false.
            reduced_motion: bool,
        }
        rules []
    }
}

record! {
    /// What is written down.
    pub struct RawLogs {
        required {
            /// The folder that log files go to.
            folder: MachinePath,
        }
        optional {
            /// How large one file may be, in MB. Without it: 10.
            max_megabytes: LogMegabytes,
            /// How many files are kept. Without it: 7.
            keep: LogFiles,
            /// Whether scenes and languages are counted, in a table there and without anything
            /// about visitors. Without it: false.
            usage_counts: bool,
        }
        rules []
    }
}

record! {
    /// The page that says how the wall is.
    pub struct RawStatus {
        required {}
        optional {
            /// Address and port that it is read at, or off. Without it: 127.0.0.1:8017, which only
            /// this machine reaches.
            address: Text,
            /// The address is reached by other machines, and is meant to be.
            beyond_this_machine: bool,
        }
        rules [Rule::Needs("beyond_this_machine", "address")]
    }
}

record! {
    /// Who may leave the exhibit.
    pub struct RawStaff {
        required {}
        optional {
            /// 4 to 12 digits that open the staff's panel; --kiosk needs them.
            pin: PinText,
        }
        rules []
    }
}
