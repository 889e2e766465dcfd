//! From contacts with controls, and from keys that are about them, to intents.

use bevy::prelude::*;
use glam::DVec2;

use super::{
    Contact, Control, Interface, Laid, Look, Panel, Phase, Preset, TEXT_SIZES, Widget,
    draw::{Controls, Languages},
    facts::{self, OBLIQUE_DEG, OVERHEAD_DEG, RAKING_DEG},
};
use crate::visitor::{hand::Hand, intent::Intent, lamp::LOWEST_DEG};

/// A finger may leave a button by so many pixels and still press it.
const SLACK: f32 = 12.0;
/// Scenes that a page of the strip goes on by.
const PAGE: usize = 3;
/// Of a slider's way, by one press of an arrow.
const STEP: f32 = 0.05;
/// Of the lamp's hemisphere, by one press of an arrow.
const LAMP_STEP: f64 = 0.06;

/// What the staff asked for, or typed.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    Digit(u8),
    Erase,
    Enter,
    Staff(super::Staff),
    /// The countdown is refused.
    Stay,
}

/// Takes in what was touched, and what keys are about.
pub fn operate(
    mut contacts: MessageReader<Contact>,
    mut wishes: ParamSet<(MessageReader<Intent>, MessageWriter<Intent>)>,
    controls: Res<Controls>,
    languages: Res<Languages>,
    (mut interface, mut hand): (ResMut<Interface>, ResMut<Hand>),
    mut asked: MessageWriter<Asked>,
) {
    let mut intents = Vec::new();
    let laid = &controls.laid;
    for wish in wishes.p0().read() {
        match *wish {
            Intent::StepFocus(by) => step_focus(&mut interface, laid, by),
            Intent::Controls => interface.wanted = !interface.wanted,
            Intent::Activate => {
                if let Some(widget) = focused(&interface, laid) {
                    let at = widget.rect.center();
                    press(widget.control, at, laid, &mut intents);
                    apply(
                        widget.control,
                        &mut interface,
                        &mut hand,
                        &languages,
                        &mut asked,
                    );
                }
            }
            Intent::Pan(by) => {
                if let Some(widget) = focused(&interface, laid) {
                    nudge(widget, by.signum(), &hand, &mut intents);
                }
            }
            _ => {}
        }
    }
    for contact in contacts.read() {
        let Contact {
            id,
            control,
            phase,
            at,
        } = *contact;
        // Whoever touches needs no keys.
        if phase == Phase::Landed {
            interface.focus = None;
            interface.held.push((id, control));
        }
        let is_in = |widget: &&Widget| widget.control == control && widget.look != Look::Words;
        let widget = laid.widgets.iter().find(is_in);
        let slides = matches!(
            widget.map(|widget| &widget.look),
            Some(Look::Slider { .. } | Look::Dial { .. })
        );
        match phase {
            Phase::Landed | Phase::Moved if slides => press(control, at, laid, &mut intents),
            Phase::Lifted if !slides => {
                let rect = widget.map(|widget| widget.rect.inflate(SLACK));
                if rect.is_some_and(|rect| rect.contains(at)) {
                    press(control, at, laid, &mut intents);
                    apply(control, &mut interface, &mut hand, &languages, &mut asked);
                }
            }
            _ => {}
        }
        if matches!(phase, Phase::Lifted | Phase::Lost) {
            interface.held.retain(|(held, _)| *held != id);
        }
    }
    for intent in intents {
        wishes.p1().write(intent);
    }
}

/// Whether arrows are about a control and not about the sheet.
pub fn takes_arrows(interface: &Interface, controls: &Controls) -> bool {
    focused(interface, &controls.laid)
        .is_some_and(|widget| matches!(widget.look, Look::Slider { .. } | Look::Dial { .. }))
}

fn focused<'l>(interface: &Interface, laid: &'l Laid) -> Option<&'l Widget> {
    let focus = interface.focus?;
    let is_it = |widget: &&Widget| widget.control == focus && widget.look != Look::Words;
    laid.widgets.iter().find(is_it)
}

fn step_focus(interface: &mut Interface, laid: &Laid, by: i32) {
    let touched = |widget: &&Widget| widget.look != Look::Words;
    let all: Vec<Control> = laid
        .widgets
        .iter()
        .filter(touched)
        .map(|w| w.control)
        .collect();
    if all.is_empty() {
        interface.focus = None;
        return;
    }
    let at = interface
        .focus
        .and_then(|focus| all.iter().position(|control| *control == focus));
    let next = match (at, by < 0) {
        (Some(at), _) => crate::visitor::view::wrapped(at, by, all.len()),
        (None, false) => 0,
        (None, true) => all.len() - 1,
    };
    interface.focus = Some(all[next]);
}

/// An arrow moves what slides.
fn nudge(widget: &Widget, by: DVec2, hand: &Hand, intents: &mut Vec<Intent>) {
    match widget.look {
        Look::Dial { .. } => {
            if let Some(seen) = hand.lamp_seen() {
                let way = by * DVec2::new(by.x.abs(), by.y.abs()).min(DVec2::ONE);
                intents.push(Intent::LampTo(seen + way * LAMP_STEP));
            }
        }
        Look::Slider { value } => {
            let step = if by.x < 0.0 { -STEP } else { STEP };
            slide(
                widget.control,
                f64::from((value + step).clamp(0.0, 1.0)),
                intents,
            );
        }
        _ => {}
    }
}

/// What a place on a control says.
fn press(control: Control, at: Vec2, laid: &Laid, intents: &mut Vec<Intent>) {
    let is_it = |widget: &&Widget| widget.control == control && widget.look != Look::Words;
    let Some(widget) = laid.widgets.iter().find(is_it) else {
        return;
    };
    let rect = widget.rect;
    match widget.look {
        Look::Dial { .. } => {
            let seen = (at - rect.center()) / (rect.width() / 2.0) * Vec2::new(1.0, -1.0);
            let lowest = LOWEST_DEG.to_radians().cos();
            let seen = seen.as_dvec2().clamp_length_max(lowest);
            intents.push(Intent::LampTo(seen));
        }
        Look::Slider { .. } => {
            let share = (at.x - rect.min.x) / rect.width().max(1.0);
            let share = if laid.right_to_left {
                1.0 - share
            } else {
                share
            };
            slide(control, f64::from(share.clamp(0.0, 1.0)), intents);
        }
        _ => intents.extend(wish(control)),
    }
}

fn slide(control: Control, value: f64, intents: &mut Vec<Intent>) {
    intents.extend(match control {
        Control::Warmth => Some(Intent::Warmth(facts::kelvin(value))),
        Control::Intensity => Some(Intent::Intensity(facts::gain(value))),
        Control::Through => Some(Intent::TransmitTo((value * 100.0).round() / 100.0)),
        Control::Share => Some(Intent::CompareTo(value)),
        Control::Opacity => Some(Intent::OpacityTo(value)),
        _ => None,
    });
}

/// What a button is about, where it is about the sheet.
fn wish(control: Control) -> Option<Intent> {
    Some(match control {
        Control::Home => Intent::Home,
        Control::Flip => Intent::Flip,
        Control::Preset(preset) => match preset {
            Preset::Zenithal => Intent::RaiseLamp(OVERHEAD_DEG),
            Preset::Oblique => Intent::RaiseLamp(OBLIQUE_DEG),
            Preset::Raking(quarter) => Intent::SetLamp {
                elevation_deg: RAKING_DEG,
                azimuth_deg: 90.0 * f64::from(quarter),
            },
            Preset::LightTable => Intent::SwitchTable,
        },
        Control::Scene(scene) => Intent::GoTo(scene),
        Control::Mode(mode) => Intent::Compare(mode),
        Control::Layer(overlay) => Intent::Overlay(overlay),
        Control::Tool(tool) => Intent::Tool(tool),
        Control::TakeBack => Intent::TakeBack,
        Control::Done => Intent::GoOn,
        Control::Hotspots => Intent::Hotspots,
        Control::Caption => Intent::Caption,
        _ => return None,
    })
}

/// What a button is about, where it is about the controls themselves.
fn apply(
    control: Control,
    interface: &mut Interface,
    hand: &mut Hand,
    languages: &Languages,
    asked: &mut MessageWriter<Asked>,
) {
    match control {
        Control::Home => {
            interface.go_home();
            hand.go_home(languages.spoken(None));
            hand.calm(interface.calm);
        }
        Control::Open(panel) => {
            interface.toggle(panel);
            if panel == Panel::Scenes {
                interface.first_scene = hand.scene().saturating_sub(1);
            }
        }
        Control::Page(by) => {
            let scenes = hand.exhibit().scenes.len();
            let first = interface.first_scene.min(scenes.saturating_sub(1));
            interface.first_scene = match by < 0 {
                true => first.saturating_sub(PAGE),
                false => (first + PAGE).min(scenes.saturating_sub(1)),
            };
        }
        Control::Language(language) => {
            if let Some(tag) = languages.offered.get(language) {
                interface.language = Some(tag.clone());
                hand.speak(languages.spoken(Some(tag)));
            }
        }
        Control::TextSize => interface.text = (interface.text + 1) % TEXT_SIZES.len(),
        Control::Contrast => interface.contrast = !interface.contrast,
        Control::Calm => {
            interface.calm = !interface.calm;
            hand.calm(interface.calm);
        }
        Control::Stay => drop(asked.write(Asked::Stay)),
        Control::Digit(digit) => drop(asked.write(Asked::Digit(digit))),
        Control::Erase => drop(asked.write(Asked::Erase)),
        Control::Enter => drop(asked.write(Asked::Enter)),
        Control::Staff(staff) => drop(asked.write(Asked::Staff(staff))),
        _ => {}
    }
}
