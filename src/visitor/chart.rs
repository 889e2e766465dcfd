//! The test chart: what each display should show, so that a technician with a meter sees how far it has
//! drifted since it was measured. The staff's panel opens it, also outside the opening hours; the next touch closes it.

use std::time::Duration;

use bevy::prelude::*;

use super::glass::Glass;
use crate::{
    colour::{self, srgb_decode},
    stage::legend::TextCamera,
};

/// Steps of grey, sRGB of 255: even ones, and those next to black and to white, where displays fail first.
const GREYS: [u8; 11] = [0, 26, 51, 77, 102, 128, 153, 179, 204, 230, 255];
const ENDS: [u8; 10] = [2, 4, 6, 8, 12, 243, 247, 249, 251, 253];
const COLOURS: [[u8; 3]; 7] = [
    [255, 255, 255],
    [255, 0, 0],
    [0, 255, 0],
    [0, 0, 255],
    [0, 255, 255],
    [255, 0, 255],
    [255, 255, 0],
];
/// Around the patches, as a share of the display's lesser side: a meter sees nothing but its patch.
const MARGIN: f32 = 0.04;
/// Height of the labels, of the lesser side.
const LABEL: f32 = 0.016;
/// Level lines over all displays, which their frames must not break, as shares of the picture's height.
const LEVELS: [f32; 3] = [0.25, 0.5, 0.75];

/// One that is forgotten goes by itself, before it burns in.
const FORGOTTEN: Duration = Duration::from_secs(900);

/// Since when it is shown, while it is.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Chart(Option<Duration>);

impl Chart {
    pub fn is_shown(self) -> bool {
        self.0.is_some()
    }

    pub fn show(&mut self, now: Duration) {
        self.0 = Some(now);
    }

    pub fn close(&mut self) {
        self.0 = None;
    }

    /// How long it is until it goes by itself.
    pub fn next(self, now: Duration) -> Option<Duration> {
        self.0.map(|since| (since + FORGOTTEN).saturating_sub(now))
    }
}

/// Takes it away where it was forgotten.
pub fn forget(mut chart: ResMut<Chart>, time: Res<Time<Real>>) {
    if chart
        .next(time.elapsed())
        .is_some_and(|left| left.is_zero())
    {
        chart.close();
    }
}

/// All of it.
#[derive(Component)]
pub struct Charted;

/// What a meter should read: share of the luminance of white, and CIE 1931 chromaticity.
fn meant(code: [u8; 3]) -> (f64, [f64; 2]) {
    let linear = code.map(|v| srgb_decode(f64::from(v) / 255.0));
    let [x, y, z] = colour::xyz_from_linear(linear);
    let sum = x + y + z;
    let chromaticity = match sum > 0.0 {
        true => [x / sum, y / sum],
        false => colour::D65,
    };
    (y, chromaticity)
}

fn label(code: [u8; 3]) -> String {
    let (luminance, [x, y]) = meant(code);
    let [r, g, b] = code;
    let code = match r == g && g == b {
        true => r.to_string(),
        false => format!("{r} {g} {b}"),
    };
    let percent = 100.0 * luminance;
    match luminance > 0.0 {
        true => format!("{code}\n{percent:.2} %\nx {x:.4}\ny {y:.4}"),
        // Black has no colour.
        false => format!("{code}\n{percent:.2} %"),
    }
}

/// Draws it over everything, or takes it away.
pub fn draw(
    mut commands: Commands,
    (chart, glass): (Res<Chart>, Res<Glass>),
    cameras: Query<Entity, With<TextCamera>>,
    charted: Query<Entity, With<Charted>>,
) {
    if !chart.is_changed() {
        return;
    }
    for entity in &charted {
        commands.entity(entity).despawn();
    }
    let Some(camera) = cameras.iter().next().filter(|_| chart.is_shown()) else {
        return;
    };
    let whole = Rect::from_corners(Vec2::ZERO, glass.size);
    let panes = match glass.panes.is_empty() {
        true => vec![whole],
        false => glass.panes.iter().map(|pane| pane.in_picture).collect(),
    };
    let root = (
        Charted,
        UiTargetCamera(camera),
        GlobalZIndex(i32::MAX),
        at(whole),
        BackgroundColor(Color::BLACK),
    );
    commands.spawn(root).with_children(|root| {
        // Under the patches: a meter is to see nothing else.
        for level in LEVELS {
            let y = (level * glass.size.y).round();
            let line = Rect::new(0.0, y, glass.size.x, y + 1.0);
            root.spawn((at(line), BackgroundColor(Color::srgb_u8(96, 96, 96))));
        }
        for pane in panes {
            lay(root, pane);
        }
    });
}

/// The patches of one display, and a line of one pixel around its visible area.
fn lay(root: &mut ChildSpawnerCommands, pane: Rect) {
    let side = pane.size().min_element();
    let frame = Node {
        border: UiRect::all(px(1)),
        ..at(pane)
    };
    root.spawn((frame, BorderColor::all(Color::WHITE)));
    let rows: [Vec<[u8; 3]>; 3] = [
        COLOURS.into(),
        GREYS.map(|v| [v; 3]).into(),
        ENDS.map(|v| [v; 3]).into(),
    ];
    let inner = pane.inflate(-MARGIN * side);
    let height = inner.height() / rows.len() as f32;
    for (row, codes) in rows.iter().enumerate() {
        let width = inner.width() / codes.len() as f32;
        for (column, code) in codes.iter().enumerate() {
            let corner = inner.min + Vec2::new(column as f32 * width, row as f32 * height);
            let patch = Rect::from_corners(corner, corner + Vec2::new(width, 0.7 * height));
            let [r, g, b] = *code;
            root.spawn((at(patch), BackgroundColor(Color::srgb_u8(r, g, b))));
            let below = Node {
                position_type: PositionType::Absolute,
                left: px(corner.x),
                top: px(patch.max.y + 4.0),
                width: px(width),
                ..default()
            };
            root.spawn((
                below,
                Text::new(label(*code)),
                TextFont {
                    font_size: FontSize::Px(LABEL * side),
                    ..default()
                },
                TextColor(Color::srgb_u8(160, 160, 160)),
            ));
        }
    }
}

fn at(rect: Rect) -> Node {
    Node {
        position_type: PositionType::Absolute,
        left: px(rect.min.x),
        top: px(rect.min.y),
        width: px(rect.width()),
        height: px(rect.height()),
        ..default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_meter_is_told_what_the_standard_says() {
        // IEC 61966-2-1: the primaries of BT.709 around D65.
        let near = |a: f64, b: f64| (a - b).abs() < 2e-4;
        for (code, luminance, [x, y]) in [
            ([255, 255, 255], 1.0, [0.3127, 0.3290]),
            ([255, 0, 0], 0.2126, [0.64, 0.33]),
            ([0, 255, 0], 0.7152, [0.30, 0.60]),
            ([0, 0, 255], 0.0722, [0.15, 0.06]),
            ([128, 128, 128], 0.2159, [0.3127, 0.3290]),
        ] {
            let (found, [u, v]) = meant(code);
            assert!(
                near(found, luminance) && near(u, x) && near(v, y),
                "{code:?}"
            );
        }
        assert_eq!(label([0; 3]), "0\n0.00 %");
    }
}
