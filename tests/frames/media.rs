//! Media in the picture: metal shines, gouache and chalk hold light back, and photographs are
//! given back; and the lobes of paper that are off by default.

use std::{f64::consts::PI, path::Path, sync::Arc};

use recto::{
    colour::{delta_e00, lab_from_linear},
    manifest::{Exhibit, exhibit::SideName},
    maps::encode::{save_exr_rgb, save_png_rgba8},
    needs::{MapUse, Needs},
    optics::{
        bsdf::{Pair, Specimen},
        medium::MediumId,
        tier::Tier,
    },
    shot::{Darkroom, Picture},
};

use crate::room::{Fixture, darkroom, mean, picture, pixel};

/// Strips of 8 mm, from the left: paper, and full coverage of each medium of the map.
const STRIPS: [[f64; 3]; 5] = [
    [0.70, 0.66, 0.58],
    [0.26, 0.22, 0.18],
    [0.86, 0.86, 0.83],
    [0.035, 0.034, 0.034],
    [0.10, 0.08, 0.06],
];
const PAPER: u32 = 0;
const SILVER: u32 = 1;
const GOUACHE: u32 = 2;
const CHALK: u32 = 3;
const INK: u32 = 4;
const MM: u32 = 40;
/// The capture round trip of the issue, in ΔE00.
const ROUND_TRIP: f64 = 0.5;
/// A frame against f64: the albedo's half floats, and sums of many f32.
const OF_F64: f64 = 2e-3;

const LAMPS: &str = "
    [[lamp]]\nid = \"capture\"\nkind = \"distant\"\nlux_at_sheet = 1000\nkelvin = 6504
    elevation_deg = 45\nazimuth_deg = 90
    [[lamp]]\nid = \"table\"\nkind = \"light-table\"\nnits = 1000
    [[scene]]\nid = \"capture\"\nlamps = [\"capture\"]
    camera = { centre_mm = [20, 20], width_mm = 40 }
    [[scene]]\nid = \"mirror\"\nlike = \"capture\"
    camera = { centre_mm = [20, 20], width_mm = 40, tilt_deg = 45 }
    [[scene]]\nid = \"table\"\nlike = \"capture\"\nlamps = [\"table\"]\n";

const MEDIA: &str = "media = [ { file = \"media.png\", weights = [\"silver-point\", \
    \"white-gouache\", \"black-chalk\", \"iron-gall-ink\"] } ]\n";

fn strip(i: u32) -> usize {
    (i % MM / 8) as usize
}

/// The strips on one side, and a plain sheet on the other; with or without the map of media.
fn strips(side: &str, media: &str, paper: &str) -> Fixture {
    let other = if side == "recto" { "verso" } else { "recto" };
    let manifest = format!(
        "[exhibit]\ntitle = \"Strips\"
        [[drawing]]\nid = \"sheet\"\nsize_mm = [40, 40]\n{paper}
        [drawing.{side}]\nalbedo = {{ file = \"strips.exr\", encoding = \"linear\" }}\n{media}
        [drawing.{other}]\nalbedo = {{ file = \"plain.exr\", encoding = \"linear\" }}\n{LAMPS}"
    );
    Fixture::new(&manifest, write)
}

fn write(folder: &Path) {
    let narrow = |colour: [f64; 3]| colour.map(|v| v as f32);
    let plain = vec![narrow(STRIPS[0]); (MM * MM) as usize];
    save_exr_rgb(&folder.join("plain.exr"), MM, MM, &plain).expect("the plain side");
    let albedo: Vec<[f32; 3]> = (0..MM * MM).map(|i| narrow(STRIPS[strip(i)])).collect();
    save_exr_rgb(&folder.join("strips.exr"), MM, MM, &albedo).expect("the strips");
    let shares: Vec<[u8; 4]> = (0..MM * MM)
        .map(|i| std::array::from_fn(|c| if strip(i) == c + 1 { 255 } else { 0 }))
        .collect();
    save_png_rgba8(&folder.join("media.png"), MM, MM, &shares, None).expect("the media");
}

const PAPER_ALBEDO: &str = "paper = { kind = \"laid\", albedo = [0.70, 0.66, 0.58] }";

/// One pixel for each mm.
fn shoot(room: &mut Darkroom, exhibit: &Arc<Exhibit>, scene: &str, side: SideName) -> Picture {
    let (_, scene) = exhibit.scene(scene).expect("the scene");
    let mut scene = scene.clone();
    scene.side = side;
    picture(room, exhibit, &scene, Tier::Study, [MM, MM])
}

/// The middle of a strip, counted from the left of the picture.
fn at(frame: &Picture, strip: u32) -> [f64; 3] {
    pixel(frame, 8 * strip + 4, MM / 2)
}

#[test]
fn silver_shines_where_a_mirror_would() {
    let mut room = darkroom(1);
    let pair = |theta_o| Pair([45.0, 90.0, theta_o, 270.0]);
    let silver: MediumId = "silver-point".parse().expect("silver");
    let specimen = Specimen::new(silver.medium(), STRIPS[1].into());
    let mut ratios = Vec::new();
    for media in [MEDIA, ""] {
        let fixture = strips("recto", media, PAPER_ALBEDO);
        let exhibit = fixture.exhibit();
        let mut ratio = |scene: &str, theta_o: f64| {
            let frame = shoot(&mut room, &exhibit, scene, SideName::Recto);
            let shown = at(&frame, SILVER)[1];
            if !media.is_empty() {
                let f = PI * specimen.at(Tier::Study, &pair(theta_o)).f.y;
                assert!((shown / f - 1.0).abs() < OF_F64, "{scene}: {shown} {f}");
            }
            shown / at(&frame, PAPER)[1]
        };
        ratios.push([ratio("capture", 0.0), ratio("mirror", 45.0)]);
    }
    let [[captured, mirrored], [dull_captured, dull_mirrored]] = ratios[..] else {
        panic!("{ratios:?}")
    };
    // Metal that is a third of the paper's light in the photograph outshines it in the mirror.
    assert!(captured < 0.4 && mirrored > 1.5, "{ratios:?}");
    // Without the map it is ink: it stays dark.
    assert!(dull_captured < 0.4 && dull_mirrored < 0.5, "{ratios:?}");
}

#[test]
fn both_sides_give_their_photographs_back() {
    let mut room = darkroom(1);
    for side in [SideName::Recto, SideName::Verso] {
        let fixture = strips(side.word(), MEDIA, PAPER_ALBEDO);
        let exhibit = fixture.exhibit();
        let frame = shoot(&mut room, &exhibit, "capture", side);
        let lab = |of: [f64; 3]| lab_from_linear(of);
        let off: Vec<f64> = (0..5)
            .map(|strip| delta_e00(lab(at(&frame, strip)), lab(STRIPS[strip as usize])))
            .collect();
        assert!(off.iter().all(|off| *off < ROUND_TRIP), "{off:?}");
        // The comparator tells neighbours apart.
        assert!(delta_e00(lab(at(&frame, SILVER)), lab(STRIPS[4])) > ROUND_TRIP);
    }
}

#[test]
fn gouache_is_dark_on_a_light_table_and_particles_are_black() {
    let mut room = darkroom(1);
    for (drawn, seen) in [
        (SideName::Recto, SideName::Recto),
        (SideName::Verso, SideName::Recto),
        (SideName::Verso, SideName::Verso),
        (SideName::Recto, SideName::Verso),
    ] {
        for media in [MEDIA, ""] {
            let fixture = strips(drawn.word(), media, PAPER_ALBEDO);
            let exhibit = fixture.exhibit();
            let frame = shoot(&mut room, &exhibit, "table", seen);
            // From behind, the strips stand the other way round.
            let place = |strip: u32| if drawn == seen { strip } else { 4 - strip };
            let share = |strip: u32| at(&frame, place(strip))[1] / at(&frame, place(PAPER))[1];
            let shares = [GOUACHE, CHALK, SILVER, INK].map(share);
            let [gouache, chalk, silver, ink] = shares;
            assert!((0.02..0.5).contains(&ink), "{drawn:?} {seen:?}: {shares:?}");
            if media.is_empty() {
                // What is lighter than the paper is no ink: without the map it is not there.
                assert!(gouache > 0.95, "{drawn:?} {seen:?}: {shares:?}");
                assert!(chalk > 0.02, "{drawn:?} {seen:?}: {shares:?}");
            } else {
                assert!(
                    (0.1..0.6).contains(&gouache),
                    "{drawn:?} {seen:?}: {shares:?}"
                );
                assert!(
                    chalk < 1e-3 && silver < 1e-3,
                    "{drawn:?} {seen:?}: {shares:?}"
                );
            }
        }
    }
}

/// Plain paper under a lamp at these angles, seen at a tilt; the mean of its middle.
fn plain(
    room: &mut Darkroom,
    paper: &str,
    [elevation, azimuth]: [f64; 2],
    tilt: f64,
    side: &str,
) -> f64 {
    let manifest = format!(
        "[exhibit]\ntitle = \"Plain\"
        [[drawing]]\nid = \"sheet\"\nsize_mm = [40, 40]
        paper = {{ kind = \"burnished\", albedo = [0.7, 0.66, 0.58], {paper} }}
        recto.albedo = {{ file = \"plain.exr\", encoding = \"linear\" }}
        verso.albedo = {{ file = \"plain.exr\", encoding = \"linear\" }}
        [[lamp]]\nid = \"lamp\"\nkind = \"distant\"\nlux_at_sheet = 1000
        elevation_deg = {elevation}\nazimuth_deg = {azimuth}
        [[scene]]\nid = \"scene\"\nside = \"{side}\"
        camera = {{ centre_mm = [20, 20], width_mm = 40, tilt_deg = {tilt} }}\n"
    );
    let fixture = Fixture::new(&manifest, write);
    let exhibit = fixture.exhibit();
    let frame = picture(room, &exhibit, &exhibit.scenes[0], Tier::Study, [MM, MM]);
    mean(&frame, [18, 18], [22, 22])
}

#[test]
fn lobes_that_a_paper_switches_on_are_seen() {
    let mut room = darkroom(1);
    let off = "specular = 1";
    // Lamp and eye in one direction.
    let mut back = |paper| plain(&mut room, paper, [45.0, 270.0], 45.0, "recto");
    let (without, with) = (back(off), back("retro = 0.5"));
    assert!(with > 1.1 * without, "{with} {without}");
    // Grazing light from behind.
    let mut grazing = |paper| plain(&mut room, paper, [10.0, 90.0], 75.0, "recto");
    let (without, with) = (
        grazing("roughness = 1"),
        grazing("roughness = 1, sheen = 1"),
    );
    assert!(with > 1.05 * without, "{with} {without}");
    // Along and across the grain, steeper than a mirror.
    let combed = "anisotropy = 0.8, anisotropy_deg = 30";
    let mut across = |paper, azimuth, side| plain(&mut room, paper, [40.0, azimuth], 0.0, side);
    let (along, over) = (
        across(combed, 30.0, "recto"),
        across(combed, 120.0, "recto"),
    );
    assert!(along > 1.02 * over, "{along} {over}");
    let (any, way) = (across(off, 30.0, "recto"), across(off, 120.0, "recto"));
    assert!((any / way - 1.0).abs() < 1e-3, "{any} {way}");
    // The same fibres, seen from behind.
    let (turned, wrong) = (
        across(combed, 150.0, "verso"),
        across(combed, 30.0, "verso"),
    );
    assert!((turned / along - 1.0).abs() < 1e-3, "{turned} {along}");
    assert!((wrong / along - 1.0).abs() > 5e-3, "{wrong} {along}");
}

#[test]
fn needs_say_what_they_add_and_why() {
    let needs = |paper: &str, media: &str, tier: Tier, scene: &str| {
        let fixture = strips("verso", media, paper);
        let exhibit = fixture.exhibit();
        let (_, scene) = exhibit.scene(scene).expect("the scene");
        Needs::of(&exhibit, scene, tier, false)
    };
    let lobes = "paper = { kind = \"laid\", retro = 0.25, sheen = 0.5, anisotropy = 0.75 }";
    let says = |needs: &Needs, words: &str| needs.reasons.iter().any(|r| r.contains(words));
    let study = needs(lobes, MEDIA, Tier::Study, "capture");
    let terms = &study.sides[0].terms;
    assert!(terms.retro && terms.sheen && terms.anisotropic, "{terms:?}");
    for words in [
        "retro-reflection of strength 0.25",
        "sheen of strength 0.5",
        "anisotropy of the gloss of strength 0.75",
    ] {
        assert!(says(&study, words), "{words}: {:?}", study.reasons);
    }
    let gallery = needs(lobes, MEDIA, Tier::Gallery, "capture");
    let terms = &gallery.sides[0].terms;
    assert!(!(terms.retro || terms.sheen || terms.anisotropic));
    assert!(says(&gallery, "no sheen: only the study tier has it"));
    let table = needs(lobes, MEDIA, Tier::Study, "table");
    assert!(says(&table, "no retro-reflection: no directed light"));
    let none = needs(PAPER_ALBEDO, MEDIA, Tier::Study, "table");
    let terms = &none.sides[0].terms;
    assert!(!(terms.retro || terms.sheen || terms.anisotropic || says(&none, "sheen")));
    // The verso's media, seen through the recto; only where light comes through, and only
    // where they are given.
    let is_other = |map: &MapUse| matches!(map, MapUse::OtherMatter(_));
    let has = |needs: &Needs| needs.sides[0].maps.iter().any(is_other);
    assert!(has(&none) && terms.other_matter && says(&none, "hold light back"));
    assert!(!has(&study));
    assert!(!has(&needs(PAPER_ALBEDO, "", Tier::Study, "table")));
    assert!(!has(&needs(PAPER_ALBEDO, MEDIA, Tier::Gallery, "table")));
}
