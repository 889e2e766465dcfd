//! The verso's ink in the recto's reflected light, against its f64 twin.

use std::{f64::consts::PI, sync::Arc};

use glam::DVec3;
use recto::{
    colour::linear_from_srgb8,
    manifest::{Exhibit, exhibit::Paper},
    maps::encode::save_png_rgb8,
    needs::{MapUse, Needs},
    optics::{
        bsdf::Specimen,
        lamp::Incidence,
        matter::{Cover, Particle},
        refraction::PathTable,
        shade::{Beam, Behind, Illumination, Spot},
        study::Study,
        table::InterfaceTable,
        tier::{Surface, Tier, albedo_of},
    },
    shot::Picture,
};

use crate::room::{Fixture, darkroom, largest_difference, mean, picture};

const SIDE: u32 = 64;
/// Bare paper, ink, and the recto's own stroke, as they photograph.
const BARE: u8 = 214;
const INK: u8 = 60;
/// Of a perfect diffuser's light: a half-float picture, and the shader's own arithmetic.
const NEAR: f64 = 1e-3;

/// Bare paper whose verso is inked in its right half; in a state, it is not.
fn fixture(paper: &str) -> Fixture {
    let manifest = format!(
        "[exhibit]\ntitle = \"Sheet\"\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [64, 64]\n\
         paper = {{ kind = \"laid\", albedo = \"#d6d6d6\", {paper} }}\n\
         recto.albedo = \"recto.png\"\nverso.albedo = \"verso.png\"\n\
         [[drawing.state]]\nid = \"cleaned\"\nverso.albedo = \"clean.png\"\n\
         [[drawing.state]]\nid = \"again\"\nrecto.albedo = \"recto.png\"\n\
         verso.albedo = \"clean.png\"\n\
         [[lamp]]\nid = \"lamp\"\nkind = \"distant\"\nlux_at_sheet = 1000\nkelvin = 6504\n\
         elevation_deg = 45\nazimuth_deg = 135\n\
         [[scene]]\nid = \"recto\"\ncamera = {{ centre_mm = [32, 32], width_mm = 64 }}\n\
         [[scene]]\nid = \"cleaned\"\nlike = \"recto\"\nstate = \"cleaned\"\n\
         [[scene]]\nid = \"again\"\nlike = \"recto\"\nstate = \"again\"\n\
         [[scene]]\nid = \"relief\"\nlike = \"recto\"\nenhance = {{ relief_only = true }}\n"
    );
    Fixture::new(&manifest, |folder| {
        let save = |name: &str, of: &dyn Fn(u32) -> u8| {
            let pixels: Vec<[u8; 3]> = (0..SIDE * SIDE).map(|i| [of(i % SIDE); 3]).collect();
            save_png_rgb8(&folder.join(name), SIDE, SIDE, &pixels, None).expect(name);
        };
        save("recto.png", &|_| BARE);
        save("clean.png", &|_| BARE);
        save("verso.png", &|x| if x < SIDE / 2 { BARE } else { INK });
    })
}

fn shoot(exhibit: &Arc<Exhibit>, id: &str, tier: Tier) -> Picture {
    let mut room = darkroom(1);
    let (_, scene) = exhibit.scene(id).expect(id);
    picture(&mut room, exhibit, scene, tier, [SIDE, SIDE])
}

/// The recto's left, behind which the verso's right lies, and its right.
fn halves(frame: &Picture) -> [f64; 2] {
    [
        mean(frame, [4, 4], [28, 60]),
        mean(frame, [36, 4], [60, 60]),
    ]
}

/// What the f64 twin shows of bare paper where the verso photographs as `now`, and photographed as
/// `then` together with the recto.
fn twin(paper: &Paper, now: u8, then: u8) -> f64 {
    let grey = |value: u8| DVec3::from(linear_from_srgb8([value; 3]));
    let bare = grey(BARE);
    let surface = Surface::new(bare, paper.roughness, paper.index, paper.specular);
    let interface = InterfaceTable::at_roughness(paper.roughness, paper.index, paper.specular);
    let mean = interface.mean_at(paper.roughness);
    let paths = Arc::new(PathTable::at_roughness(paper.roughness, paper.index));
    let study = Study::new(&surface, &interface, paths, paper.slab());
    let share = |value: u8| {
        let of_other = Surface {
            albedo: grey(value),
            ..surface
        };
        albedo_of(&of_other, &mean) / study.bare
    };
    let mut specimen = Specimen {
        surface,
        interface,
        study: study.clone(),
        cover: Cover {
            film: 1.0,
            ..Cover::default()
        },
        particle: Particle {
            alpha: 1.0,
            ..Particle::default()
        },
        body_albedo: DVec3::ZERO,
        body_through: DVec3::ONE,
        left: DVec3::ONE,
    };
    specimen.left = specimen.left(share(now), share(then));
    let behind = Behind {
        bare,
        other: bare,
        other_bare: bare,
        clear: 1.0,
    };
    let l = DVec3::new(1.0, 0.0, 1.0).normalize();
    let beam = Beam {
        incidence: Incidence {
            l,
            e: DVec3::splat(PI / l.z),
        },
        visible: 1.0,
    };
    let light = Illumination {
        beams: vec![beam],
        ..Illumination::default()
    };
    Spot::flat(specimen, behind)
        .radiance(Tier::Study, DVec3::Z, &light)
        .y
}

#[test]
fn the_recto_is_darker_where_the_verso_is_inked() {
    for thickness in [60, 120] {
        let fixture = fixture(&format!(
            "thickness_um = {thickness}, show_through = \"modelled\""
        ));
        let exhibit = fixture.exhibit();
        let paper = &exhibit.drawings[0].paper;
        let [inked, bare] = halves(&shoot(&exhibit, "recto", Tier::Study));
        let expected = twin(paper, INK, BARE);
        println!("{thickness} µm: {inked:.4} for {expected:.4}, of {bare:.4}");
        assert!((inked - expected).abs() < NEAR, "{inked} {expected}");
        let without = twin(paper, BARE, BARE);
        assert!((bare - without).abs() < NEAR, "{bare} {without}");
        // Left out, or through a sheet twice as thick, it is another picture.
        assert!((inked - without).abs() > 10.0 * NEAR);
        let thicker = Paper {
            thickness: recto::units::Micrometres(2.0 * f64::from(thickness)),
            ..paper.clone()
        };
        assert!((inked - twin(&thicker, INK, BARE)).abs() > 10.0 * NEAR);
    }
}

#[test]
fn what_the_photograph_holds_is_not_counted_again() {
    let fixture = fixture("thickness_um = 60");
    let exhibit = fixture.exhibit();
    let paper = &exhibit.drawings[0].paper;
    let own = shoot(&exhibit, "recto", Tier::Study);
    let [inked, bare] = halves(&own);
    assert_eq!(inked, bare);
    // A state whose recto was photographed too.
    let again = shoot(&exhibit, "again", Tier::Study);
    assert_eq!(largest_difference(&own, &again), 0.0);
    // The verso was cleaned since the recto was photographed.
    let cleaned = shoot(&exhibit, "cleaned", Tier::Study);
    let [lighter, same] = halves(&cleaned);
    let expected = twin(paper, BARE, INK);
    println!("cleaned: {lighter:.4} for {expected:.4}, of {bare:.4}");
    assert!((lighter - expected).abs() < NEAR, "{lighter} {expected}");
    assert!((same - bare).abs() < NEAR);
    assert!((lighter - inked).abs() > 10.0 * NEAR);
    // Brighter than that no sheet is, whatever the pictures say.
    assert!(lighter < 1.0);
}

#[test]
fn needs_say_when_ink_shows_through_and_what_that_is_worth() {
    let needs = |paper: &str, id: &str, tier: Tier| {
        let fixture = fixture(paper);
        let exhibit = fixture.exhibit();
        let (_, scene) = exhibit.scene(id).expect(id);
        Needs::of(&exhibit, scene, tier, false)
    };
    let says = |needs: &Needs, words: &str| {
        let found = needs.reasons.iter().any(|reason| reason.contains(words));
        assert!(found, "{words}: {:?}", needs.reasons);
    };
    let loads = |needs: &Needs| {
        let maps = needs.sides[0].maps.iter();
        maps.filter(|map| matches!(map, MapUse::OtherAlbedo(_) | MapUse::Photographed(_)))
            .count()
    };
    let thin = "thickness_um = 60, show_through = \"modelled\"";
    let modelled = needs(thin, "recto", Tier::Study);
    let terms = &modelled.sides[0].terms;
    assert!(terms.show_through && terms.other_albedo && !terms.photographed);
    assert!(!terms.transmission && loads(&modelled) == 1);
    says(
        &modelled,
        "show-through of the verso's ink, of which the picture",
    );
    let left_out = [
        (
            thin,
            "recto",
            Tier::Gallery,
            "only the study tier computes it",
        ),
        (
            "thickness_um = 1000, show_through = \"modelled\"",
            "recto",
            Tier::Study,
            "less than a quarter of the 1 that is allowed",
        ),
        ("thickness_um = 60", "recto", Tier::Study, "holds it"),
        ("thickness_um = 60", "again", Tier::Study, "holds it"),
    ];
    for (paper, id, tier, words) in left_out {
        let needs = needs(paper, id, tier);
        says(&needs, words);
        assert!(!needs.sides[0].terms.show_through, "{paper} {id}");
        assert_eq!(loads(&needs), 0, "{paper} {id}");
    }
    let relief = needs(thin, "relief", Tier::Study);
    assert_eq!(
        (relief.sides[0].terms.show_through, loads(&relief)),
        (false, 0)
    );
    let cleaned = needs("thickness_um = 60", "cleaned", Tier::Study);
    assert!(cleaned.sides[0].terms.photographed && loads(&cleaned) == 2);
    says(&cleaned, "other than when the recto was photographed");
}
