//! Recto shows old-master drawings as if the sheet lay in your hands: an exhibit manifest
//! becomes lit sheets of paper, in a window or in files.
//!
//! # The house
//! | module | what it is |
//! |---|---|
//! | [`units`], [`colour`] | quantities with their unit; encoded and linear colour, CIELAB, lamps' white |
//! | [`optics`] | what paper, ink and lamps do with light, in f64; twins in `shaders/paper_bsdf.wgsl` |
//! | [`mod@reference`] | the judge: the same light by a random walk, of a spot or a picture, with mean and variance |
//! | [`maps`] | picture files → mip chains, each kind filtered in its own way; files written whole |
//! | [`measure`] | lengths, profiles, laid lines, strokes and colours, each with its uncertainty |
//! | [`manifest`] | `exhibit.toml` → a validated [`Exhibit`](manifest::Exhibit), or every fault at once |
//! | [`installation`] | `installation.toml`, the place: displays on the wall, reach, hours, turns of exhibits |
//! | [`needs`] | what a scene requires and why: terms, maps, sides |
//! | [`sheet`] | the sheet in Bevy: mesh, its one material and that of the last pass, the narrowing from f64 to f32 |
//! | [`stage`] | what is shown: loading, sides, camera, legend, the last pass over two members or an enhanced one, reload on save |
//! | [`visitor`] | the window: hands, lamp, controls, keys, caption, hotspots, tools, views saved and exported, the tour while nobody is there |
//! | [`readings`] | tools laid on a side of an exhibit: values, units, uncertainty, one line of words |
//! | [`wall`] | the wall by itself: the house of an installation, also of several machines; health, status page, log and counts; publishing, heartbeat, supervisor |
//! | [`wording`] | what the program says on the screen, in every language, and the museum's own |
//! | [`shot`], [`develop`] | pictures without a window, and their encoding for display |
//! | [`figure`] | a print that can be made again: its scale bar and its sidecar |
//! | [`lettering`] | the letters of plots and scale bars |
//! | [`device`] | whether there is a graphics device |
//! | [`compute`] | the shipped physics on the graphics device, without a picture |
//! | [`tradeoff`] | how far each tier is from the judge, and which one serves a scene |
//! | [`cost`] | what each tier costs: instructions, and time on this machine |
//! | [`prepare`] | the photographer's bench: photographs under several lamps → maps of a sheet |
//! | [`exchange`] | what other programs write → exhibits and captures; an exhibit → IIIF |
//! | [`sample`] | the sample exhibits, drawn by code |
//! | [`cli`] | one file for each command |
//!
//! Data flows one way: manifest → `Exhibit` → `Scene` → [`Needs`](needs::Needs) → maps →
//! sheet → window or file; the judge goes from `Scene` to a file on a way of its own. `units`,
//! `colour`, `maps`, `measure`, `readings`, `figure`, `manifest`, `installation`, `needs`, `optics`,
//! `reference`, `tradeoff`, `prepare`, `exchange`, `sample` and `wording` never name Bevy;
//! `tests/layers.rs` holds the table of who may import whom.
//!
//! In one frame the systems run in the order of [`stage::StageSet`]: whoever steers changes
//! [`stage::Shown`], then the stage is arranged from it.
#![forbid(unsafe_code)]

pub mod cli;
pub mod colour;
pub mod compute;
pub mod cost;
pub mod develop;
pub mod device;
pub mod exchange;
pub mod figure;
pub mod installation;
pub mod lettering;
pub mod manifest;
pub mod maps;
pub mod measure;
pub mod needs;
pub mod optics;
pub mod prepare;
pub mod readings;
pub mod reference;
pub mod sample;
pub mod sheet;
pub mod shot;
pub mod stage;
pub mod tradeoff;
pub mod units;
pub mod visitor;
pub mod wall;
pub mod wording;
