//! Comparisons against pictures of their members, put together here.

use std::sync::Arc;

use glam::DVec2;
use recto::{
    colour::{delta_e00, lab_from_linear, luminance},
    develop::Print,
    manifest::{
        Exhibit, Scene,
        comparison::Part,
        exhibit::{Camera, CompareMode, Comparison, Member, SideName},
    },
    maps::ColourMapName,
    optics::tier::Tier,
    shot::{Darkroom, Picture},
    stage::{Arranged, TABLE},
};

use crate::{crop, room};

const SIZE: [u32; 2] = [96, 64];
const ASPECT: f64 = 1.5;
/// Of an 8-bit display.
const STEP: f32 = 1.0 / 255.0;

struct Compared {
    room: Darkroom,
    exhibit: Arc<Exhibit>,
    scene: Scene,
}

impl Compared {
    /// The landscape before and after its restoration.
    fn new(mode: CompareMode) -> Self {
        let (exhibit, _) =
            Exhibit::read(&crop::folder()).unwrap_or_else(|faults| panic!("{faults}"));
        let mut scene = exhibit.scene("two-inks").expect("a scene").1.clone();
        scene.compare = Some(Comparison::new(
            mode,
            vec![Member::State(Some(0)), Member::State(Some(1))],
        ));
        Self {
            room: room::darkroom(1),
            exhibit: Arc::new(exhibit),
            scene,
        }
    }

    fn comparison(&mut self) -> &mut Comparison {
        self.scene.compare.as_mut().expect("a comparison")
    }

    fn picture(&mut self) -> Picture {
        room::picture(
            &mut self.room,
            &self.exhibit,
            &self.scene,
            Tier::Gallery,
            SIZE,
        )
    }

    /// Each member alone.
    fn alone(&mut self, size: [u32; 2]) -> Vec<Picture> {
        let members = self.exhibit.members(&self.scene);
        members
            .iter()
            .map(|member| room::picture(&mut self.room, &self.exhibit, member, Tier::Gallery, size))
            .collect()
    }

    fn parts(&self) -> Vec<Part> {
        let parts = self.exhibit.parts(&self.scene, ASPECT);
        parts.into_iter().map(|(_, part)| part).collect()
    }
}

/// The middle of a pixel, in NDC.
fn ndc(x: u32, y: u32) -> DVec2 {
    let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let size = DVec2::new(SIZE[0].into(), SIZE[1].into());
    (at / size * 2.0 - 1.0) * DVec2::new(1.0, -1.0)
}

/// Of each pixel the member that is seen there.
fn composed(alone: &[Picture], parts: &[Part]) -> Picture {
    let mut composed = alone[0].clone();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let at = (y * SIZE[0] + x) as usize;
            let seen = parts.iter().position(|part| part.shows(ndc(x, y), ASPECT));
            composed.pixels[at] = alone[seen.expect("a member")].pixels[at];
        }
    }
    composed
}

/// As a file: where a part is drawn into a cell of its own, the rasteriser rounds the last bits of its
/// light otherwise.
fn print(picture: &Picture) -> Print {
    Print::develop(picture.width, picture.height, &picture.pixels, &[], 1.0)
}

#[test]
fn a_curtain_is_its_members_bit_by_bit() {
    let mut compared = Compared::new(CompareMode::Curtain);
    let alone = compared.alone(SIZE);
    for (at, angle) in [(0.37, 0.0), (0.61, 35.0), (0.5, 203.0)] {
        compared.comparison().at = at;
        compared.comparison().angle.0 = angle;
        let (found, parts) = (compared.picture(), compared.parts());
        let expected = composed(&alone, &parts);
        let (found_print, expected_print) = (print(&found), print(&expected));
        let differing = |a: &Print, b: &Print| {
            let pairs = a.pixels.iter().zip(&b.pixels);
            pairs.filter(|(a, b)| a != b).count()
        };
        assert_eq!(differing(&found_print, &expected_print), 0, "{at} {angle}");
        assert!(found.pixels == expected.pixels, "{at} {angle}: their light");
        // Exchanged, the members are told apart.
        let exchanged: Vec<Picture> = alone.iter().rev().cloned().collect();
        let wrong = composed(&exchanged, &parts);
        assert!(room::largest_difference(&found, &wrong) > 20.0 * STEP);
    }
}

/// The rasteriser rounds where an edge lies to a share of a pixel, so that a pixel whose middle it passes
/// may be either member's, and must not be the table's.
#[test]
fn a_window_s_clipped_parts_are_those_of_a_file_as_far_as_is_seen() {
    let mut compared = Compared::new(CompareMode::Curtain);
    let alone = compared.alone(SIZE);
    let clip = |compared: &mut Compared| {
        let world = compared.room.world();
        world.resource_mut::<Arranged>().clip(true);
    };
    compared.room = room::darkroom(1);
    clip(&mut compared);
    // Pixels of another member than theirs, without those whose middle an edge passes.
    let misplaced = |found: &Picture, parts: &[Part]| {
        let expected = composed(&alone, parts);
        let pairs = || found.pixels.iter().zip(&expected.pixels).enumerate();
        let is_off = |a: &[f32; 3], b: &[f32; 3]| (0..3).any(|c| (a[c] - b[c]).abs() > STEP);
        let off: Vec<usize> = pairs()
            .filter_map(|(i, (a, b))| is_off(a, b).then_some(i))
            .collect();
        for &i in &off {
            let is_of = |member: &Picture| !is_off(&found.pixels[i], &member.pixels[i]);
            assert!(alone.iter().any(is_of), "pixel {i} is nobody's");
        }
        let is_on_edge = |i: &usize| {
            let (x, y) = (*i as u32 % SIZE[0], *i as u32 / SIZE[0]);
            let nudges = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)];
            let seen = nudges.map(|(right, up)| {
                let nudge =
                    DVec2::new(right, up) * 0.05 / DVec2::new(SIZE[0].into(), SIZE[1].into());
                parts
                    .iter()
                    .position(|part| part.shows(ndc(x, y) + nudge, ASPECT))
            });
            seen.iter().any(|member| *member != seen[0])
        };
        off.iter().filter(|i| !is_on_edge(i)).count()
    };
    for (at, angle) in [
        (0.37, 0.0),
        (0.61, 35.0),
        (0.5, 203.0),
        (0.5, 45.0),
        (0.25, 90.0),
    ] {
        compared.comparison().at = at;
        compared.comparison().angle.0 = angle;
        let (found, parts) = (compared.picture(), compared.parts());
        assert_eq!(misplaced(&found, &parts), 0, "{at} {angle}");
        compared.comparison().at = at + 0.1;
        assert!(misplaced(&found, &compared.parts()) > 20);
    }
    // What lines do not clip is the fragment's.
    compared.scene.compare = Compared::new(CompareMode::Loupe).scene.compare;
    compared.comparison().magnify = 1.0;
    let found = compared.picture();
    assert_eq!(misplaced(&found, &compared.parts()), 0);
}

#[test]
fn side_by_side_is_its_members_bit_by_bit() {
    let mut compared = Compared::new(CompareMode::SideBySide);
    compared.comparison().of.push(Member::Side(SideName::Verso));
    let cell = [SIZE[0] / 3, SIZE[1]];
    let (found, alone) = (compared.picture(), compared.alone(cell));
    let found = print(&found);
    let prints: Vec<Print> = alone.iter().map(print).collect();
    let differing = |prints: &[Print]| {
        let places = (0..SIZE[0] * SIZE[1]).map(|i| (i % SIZE[0], i / SIZE[0]));
        let differs = |(x, y): &(u32, u32)| {
            let own = &prints[(x / cell[0]) as usize].pixels[(y * cell[0] + x % cell[0]) as usize];
            found.pixels[(y * SIZE[0] + x) as usize] != *own
        };
        places.filter(differs).count()
    };
    assert_eq!(differing(&prints), 0);
    let exchanged: Vec<Print> = prints.iter().rev().cloned().collect();
    assert!(differing(&exchanged) > 100);
}

#[test]
fn a_loupe_shows_the_other_member_larger() {
    let mut compared = Compared::new(CompareMode::Loupe);
    compared.comparison().magnify = 1.0;
    compared.comparison().centre = DVec2::new(0.4, 0.6);
    let alone = compared.alone(SIZE);
    let expected = composed(&alone, &compared.parts());
    assert!(room::largest_difference(&compared.picture(), &expected) < STEP);
    // Magnified about its centre, which stays.
    compared.comparison().magnify = 2.0;
    let larger = compared.picture();
    assert!(room::largest_difference(&larger, &expected) > 20.0 * STEP);
}

#[test]
fn a_blend_mixes_light_and_a_difference_measures_it() {
    let mut compared = Compared::new(CompareMode::Blend);
    compared.comparison().at = 0.3;
    let (found, alone) = (compared.picture(), compared.alone(SIZE));
    let mixed = |share: f64| {
        let mut mixed = alone[0].clone();
        for (a, b) in mixed.pixels.iter_mut().zip(&alone[1].pixels) {
            *a = std::array::from_fn(|c| {
                ((1.0 - share) * f64::from(a[c]) + share * f64::from(b[c])) as f32
            });
        }
        mixed
    };
    assert!(room::largest_difference(&found, &mixed(0.3)) < STEP);
    assert!(room::largest_difference(&found, &mixed(0.4)) > STEP);

    let mut compared = Compared::new(CompareMode::Difference);
    let found = compared.picture();
    let coded = |full: f64| {
        let mut coded = alone[0].clone();
        for (a, b) in coded.pixels.iter_mut().zip(&alone[1].pixels) {
            let [a_lab, b_lab] =
                [*a, *b].map(|light| lab_from_linear(light.map(|v| f64::from(v).clamp(0.0, 1.0))));
            let share = (delta_e00(a_lab, b_lab) / full).min(1.0);
            *a = ColourMapName::Magma.colour(share).map(|v| v as f32);
        }
        coded
    };
    assert_eq!(compared.scene.exposure.level, 1.0);
    assert!(room::largest_difference(&found, &coded(10.0)) < STEP);
    assert!(room::largest_difference(&found, &coded(11.0)) > STEP);
    assert!(!found.legend.is_empty() && found.legend.iter().any(|texel| texel[3] > 0.0));
}

#[test]
fn around_a_difference_lies_the_table() {
    let mut compared = Compared::new(CompareMode::Difference);
    let size_mm = compared.exhibit.drawing_of(&compared.scene).size_mm;
    compared.scene.camera = Camera::whole_sheet(size_mm);
    compared.scene.camera.width_mm *= 2.0;
    let of_both = [compared.picture(), {
        compared.comparison().coded = false;
        compared.picture()
    }];
    let [colours, numbers] = of_both.map(|picture| picture.pixels[0]);
    assert!(
        colours.iter().all(|v| (v - TABLE).abs() < 1e-6),
        "{colours:?}"
    );
    // As numbers there is none.
    assert!(numbers.iter().all(|v| *v == 0.0), "{numbers:?}");
}

/// The bound.
const DELTA_E: f64 = 0.05;

#[test]
fn a_difference_s_numbers_are_those_of_a_colour_crate() {
    let mut compared = Compared::new(CompareMode::Difference);
    compared.comparison().coded = false;
    let (found, alone) = (compared.picture(), compared.alone(SIZE));
    compared.comparison().full_luminance = Some(0.1);
    let of_light = compared.picture();
    let (mut largest, mut off, mut off_light) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (i, (a, b)) in alone[0].pixels.iter().zip(&alone[1].pixels).enumerate() {
        let [a, b] = [*a, *b].map(|light| light.map(f64::from));
        let [a_lab, b_lab] = [a, b].map(|light| lab_from_linear(light.map(|v| v.clamp(0.0, 1.0))));
        let expected = delta_e00(a_lab, b_lab);
        largest = largest.max(expected);
        off = off.max((f64::from(found.pixels[i][0]) - expected).abs());
        let expected = (luminance(a) - luminance(b)).abs();
        off_light = off_light.max((f64::from(of_light.pixels[i][1]) - expected).abs());
    }
    assert!(off < DELTA_E, "{off}");
    assert!(off_light < 1e-5, "{off_light}");
    // There is something to be wrong about.
    assert!(largest > 100.0 * DELTA_E, "{largest}");
}

#[test]
fn through_glass_the_other_side_lies_mirrored_under_this_one() {
    let mut compared = Compared::new(CompareMode::Glass);
    compared.comparison().of = vec![Member::Side(SideName::Recto), Member::Side(SideName::Verso)];
    compared.scene.camera.turn.0 = 20.0;
    let (found, alone) = (compared.picture(), compared.alone(SIZE));
    let mixed = |mirrored: bool| {
        let mut mixed = alone[0].clone();
        let width = SIZE[0] as usize;
        for (i, a) in mixed.pixels.iter_mut().enumerate() {
            let at = if mirrored {
                i / width * width + width - 1 - i % width
            } else {
                i
            };
            let b = alone[1].pixels[at];
            *a = std::array::from_fn(|c| 0.5 * (a[c] + b[c]));
        }
        mixed
    };
    assert!(room::largest_difference(&found, &mixed(true)) < STEP);
    assert!(room::largest_difference(&found, &mixed(false)) > STEP);
}

#[test]
fn those_who_take_turns_are_seen_one_at_a_time() {
    let mut compared = Compared::new(CompareMode::Flicker);
    let alone = compared.alone(SIZE);
    for turn in [0, 1, 2] {
        compared.comparison().turn = turn;
        let found = print(&compared.picture());
        assert!(found.pixels == print(&alone[turn % 2]).pixels, "{turn}");
        assert!(
            found.pixels != print(&alone[(turn + 1) % 2]).pixels,
            "{turn}"
        );
    }
}
