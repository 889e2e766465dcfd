//! The shaders as texts: they parse and validate alone and composed, and every twin of theirs in
//! Rust has the same names, order and places in memory.

use std::collections::{BTreeMap, BTreeSet};

use bevy::render::render_resource::{
    ShaderType,
    encase::{StorageBuffer, internal::WriteInto},
};
use glam::{Mat4, Vec2, Vec3, Vec4};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use recto::{
    manifest::{MAX_LAMPS, MAX_OVERLAYS},
    maps::MAX_PARTICLES,
    optics::{
        baselines::BASE_MIN,
        ink::FILM_TERMS,
        lobes::SHEEN_MEAN,
        matter::SHARE_LEAST,
        microfacet::{ALPHA_MIN, MU_MIN},
        quadrature::GAUSS_LEGENDRE,
        refraction::COSINE_MIN,
        show_through::{BACKED_MIN, LIGHTER_MAX},
        study::{DIFFUSE_COSINE, LOST_DEPTH},
        table::{ALPHA_FIT_MIN, LATE_TERMS, MU_TERMS},
        through::{TONE_LOG_MAX, TONE_MIN, TONE_TERMS},
    },
    sheet::{
        PAPER_BASELINES, PAPER_BSDF, PAPER_MATERIAL, PAPER_MEDIA,
        material::CLIPS,
        uniform::{
            FilmUniform, LightUniform, MapPlace, MeanUniform, MediaUniform, PaperUniform,
            ParticleUniform, RowUniform, SplitUniform, ThroughUniform,
        },
    },
};

#[path = "support/glue.rs"]
mod glue;

use glue::{Composer, DEFINITIONS};

fn validate(module: &naga::Module) -> Result<(), String> {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .map(|_| ())
        .map_err(|error| format!("{error:?}"))
}

/// All plain WGSL, in the order in which it is read.
fn physics() -> String {
    format!("{PAPER_BSDF}\n{PAPER_BASELINES}\n{PAPER_MEDIA}")
}

#[test]
fn the_physics_parses_and_validates_by_itself() {
    validate(&parse(PAPER_BSDF)).unwrap();
    let module = parse(&physics());
    validate(&module).unwrap();
    assert_eq!(module.global_variables.len(), 0, "it binds nothing");
    assert_eq!(
        module.entry_points.len(),
        0,
        "entry points belong to the glue"
    );
    assert!(
        !physics()
            .lines()
            .any(|line| line.trim_start().starts_with('#')),
        "directives belong to the glue"
    );
}

/// The text without `//` comments and directives.
fn plain(text: &str) -> String {
    text.lines()
        .map(|line| line.split_once("//").map_or(line, |(code, _)| code))
        .filter(|line| !line.trim_start().starts_with('#'))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Splits at commas outside of brackets.
fn split_list(text: &str) -> Vec<&str> {
    let mut depth = 0;
    let parts = text.split(|c: char| {
        match c {
            '(' | '<' | '[' => depth += 1,
            ')' | '>' | ']' => depth -= 1,
            _ => {}
        }
        c == ',' && depth == 0
    });
    parts
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .collect()
}

/// The name of `@attribute(…) pub name: type`.
fn declared(declaration: &str) -> &str {
    let name = declaration
        .split_once(':')
        .map_or(declaration, |(name, _)| name);
    name.trim()
        .rsplit([' ', '\n'])
        .next()
        .unwrap_or_default()
        .trim()
}

/// Name and declarations behind every `keyword name open … close` of a text.
fn blocks<'t>(
    text: &'t str,
    keyword: &str,
    open: char,
    close: char,
) -> Vec<(&'t str, Vec<&'t str>)> {
    text.split(keyword)
        .skip(1)
        .filter_map(|rest| {
            let (name, rest) = rest.split_once(open)?;
            let (inside, _) = rest.split_once(close)?;
            Some((name.trim(), split_list(inside)))
        })
        .collect()
}

fn members_that_end_in_a_digit(text: &str) -> Vec<String> {
    blocks(&plain(text), "struct ", '{', '}')
        .into_iter()
        .flat_map(|(name, members)| {
            members
                .into_iter()
                .map(declared)
                .filter(|member| member.ends_with(|c: char| c.is_ascii_digit()))
                .map(move |member| format!("{name}.{member}"))
        })
        .collect()
}

#[test]
fn no_struct_member_ends_in_a_digit() {
    // Bevy's composer breaks on one with a type error, and the app then shows no sheet.
    for text in [PAPER_BSDF, PAPER_BASELINES, PAPER_MEDIA, PAPER_MATERIAL] {
        assert_eq!(members_that_end_in_a_digit(text), [""; 0]);
    }
    let bad =
        "struct S { // f1: f32\n @location(0) f0: f32,\n#ifdef X\n place: vec3<f32>, a_2: S }";
    assert_eq!(members_that_end_in_a_digit(bad), ["S.f0", "S.a_2"]);
}

/// Each part of the physics with the source that its heading names.
fn twin_sections() -> Vec<(String, String)> {
    const HEADING: &str = "// Twins of src/optics/";
    physics()
        .split(HEADING)
        .skip(1)
        .map(|section| {
            let (file, rest) = section.split_once(".rs").expect("a file");
            let path = format!("{}/src/optics/{file}.rs", env!("CARGO_MANIFEST_DIR"));
            let source = std::fs::read_to_string(&path).unwrap_or_else(|error| {
                panic!("{path}: {error}");
            });
            let source = source
                .split_once("#[cfg(test)]")
                .map_or(source.as_str(), |(code, _)| code);
            (plain(&format!("//{rest}")), plain(source))
        })
        .collect()
}

/// Names of parameters or fields, in their order, by name of the function or struct.
fn signatures(text: &str, keyword: &str, open: char, close: char) -> BTreeMap<String, Vec<String>> {
    blocks(text, keyword, open, close)
        .into_iter()
        .map(|(name, declarations)| {
            let names = declarations
                .iter()
                .map(|each| declared(each).to_owned())
                .collect();
            (name.to_owned(), names)
        })
        .collect()
}

/// Functions of the twin sources that only the CPU calls.
const CPU_ONLY: [&str; 7] = [
    "capture_path",
    "directional_albedo",
    "layer_of_pigment",
    "normal_reflectance",
    "polygon_form",
    "stretch",
    "ways_back",
];
/// The shader has one layout for lamps of every shape: these stand for a method, `Light::at`.
const GPU_ONLY: [&str; 7] = [
    "angle_of",
    "ies_angles",
    "light_disc",
    "light_distant",
    "light_ies",
    "light_punctual",
    "light_rectangle",
];
/// Layouts of the shader's own. Where a uniform fills one, its offsets are compared.
const GPU_LAYOUTS: [&str; 3] = ["Film", "Light", "Split"];

#[test]
fn twins_have_the_same_names_and_order() {
    let mut compared = 0;
    for (wgsl, rust) in twin_sections() {
        let of_shader = signatures(&wgsl, "fn ", '(', ')');
        // Free functions start at the margin; methods have no twins.
        let of_source = signatures(&rust, "\npub fn ", '(', ')');
        let without_twin = |names: &[&str], name: &str| names.contains(&name);
        for (name, parameters) in &of_shader {
            if !without_twin(&GPU_ONLY, name) {
                assert_eq!(Some(parameters), of_source.get(name), "{name}");
                compared += 1;
            }
        }
        for name in of_source.keys() {
            let twin = of_shader.contains_key(name) || without_twin(&CPU_ONLY, name);
            assert!(twin, "{name} has no twin in the shader");
        }
        let structs = signatures(&rust, "\npub struct ", '{', '}');
        for (name, members) in signatures(&wgsl, "struct ", '{', '}') {
            if !without_twin(&GPU_LAYOUTS, &name) {
                assert_eq!(Some(&members), structs.get(&name), "{name}");
                compared += 1;
            }
        }
    }
    assert!(
        compared >= 12,
        "only {compared} twins found: the reader is broken"
    );
}

#[test]
fn constants_of_the_shaders_are_those_of_the_sources() {
    let constant = |text: &str, name: &str| -> f64 {
        let (_, rest) = text.split_once(&format!("const {name}:")).expect(name);
        let (value, _) = rest
            .split_once('=')
            .and_then(|(_, value)| value.split_once(';'))
            .expect(name);
        value.trim().parse().expect(name)
    };
    assert_eq!(constant(PAPER_BSDF, "PI") as f32, std::f32::consts::PI);
    let inverse = constant(PAPER_BSDF, "INV_PI") as f32;
    assert_eq!(inverse, std::f32::consts::FRAC_1_PI);
    assert_eq!(constant(PAPER_BSDF, "ALPHA_MIN"), ALPHA_MIN);
    assert_eq!(constant(PAPER_BSDF, "MU_MIN"), MU_MIN);
    assert_eq!(constant(PAPER_BSDF, "ALPHA_FIT_MIN"), ALPHA_FIT_MIN);
    assert_eq!(constant(PAPER_BSDF, "COSINE_MIN"), COSINE_MIN);
    assert_eq!(constant(PAPER_BSDF, "TONE_MIN"), TONE_MIN);
    assert_eq!(constant(PAPER_BSDF, "BACKED_MIN"), BACKED_MIN);
    assert_eq!(constant(PAPER_BSDF, "LIGHTER_MAX"), LIGHTER_MAX);
    assert_eq!(constant(PAPER_BSDF, "TONE_LOG_MAX"), TONE_LOG_MAX);
    for (name, value) in [
        ("DIFFUSE_COSINE", DIFFUSE_COSINE),
        ("LOST_DEPTH", LOST_DEPTH),
    ] {
        assert_eq!(constant(PAPER_BSDF, name) as f32, value as f32, "{name}");
    }
    assert_eq!(constant(PAPER_BASELINES, "BASE_MIN"), BASE_MIN);
    assert_eq!(constant(PAPER_MEDIA, "SHARE_LEAST"), SHARE_LEAST);
    assert_eq!(constant(PAPER_MEDIA, "SHEEN_MEAN"), SHEEN_MEAN);
}

/// Bytes of a value as the uniform buffer holds them.
fn bytes<T: ShaderType + WriteInto>(value: &T) -> Vec<u8> {
    let mut buffer = StorageBuffer::new(Vec::new());
    buffer.write(value).expect("a Vec grows");
    buffer.into_inner()
}

/// Name and bytes of each field.
type Fields = Vec<(&'static str, Vec<u8>)>;
/// A uniform's bytes, and those of its fields.
type Filled = (Vec<u8>, Fields);

/// Fills every field, by name, with a value of its own.
macro_rules! filled {
    ($type:ident { $($field:ident: $value:expr,)* }) => {{
        let filled = $type { $($field: $value,)* };
        let fields = vec![$((stringify!($field), bytes(&filled.$field)),)*];
        (filled, fields)
    }};
}

/// Numbers of which no two are alike.
struct Sentinel(u32);

impl Sentinel {
    fn u32(&mut self) -> u32 {
        self.0 += 1;
        self.0
    }

    fn f32(&mut self) -> f32 {
        self.u32() as f32
    }

    fn vec2(&mut self) -> Vec2 {
        Vec2::from_array(std::array::from_fn(|_| self.f32()))
    }

    fn vec3(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.f32()))
    }

    fn vec4(&mut self) -> Vec4 {
        Vec4::from_array(std::array::from_fn(|_| self.f32()))
    }

    fn light(&mut self) -> (LightUniform, Fields) {
        filled!(LightUniform {
            place: self.vec3(),
            near: self.f32(),
            amount: self.vec3(),
            grid: self.u32(),
            axis: self.vec3(),
            beam_scale: self.f32(),
            half_edge_u: self.vec3(),
            cos_falloff: self.f32(),
            half_edge_v: self.vec3(),
            distance_squared_min: self.f32(),
            rings: self.u32(),
            profile_row: self.u32(),
            profile_rows: self.u32(),
        })
    }

    fn map_place(&mut self) -> (MapPlace, Fields) {
        filled!(MapPlace {
            row_u: self.vec3(),
            opacity: self.f32(),
            row_v: self.vec3(),
            lit: self.f32(),
        })
    }

    fn particle(&mut self) -> (ParticleUniform, Fields) {
        filled!(ParticleUniform {
            n: self.vec3(),
            alpha: self.f32(),
            k: self.vec3(),
            f_capture: self.vec3(),
            albedo: self.vec3(),
        })
    }

    fn media(&mut self) -> (MediaUniform, Fields) {
        filled!(MediaUniform {
            particles: std::array::from_fn::<_, MAX_PARTICLES, _>(|_| self.particle().0),
            body_albedo: self.vec3(),
            body_through: self.vec3(),
            film_eta: self.f32(),
            film_gain: self.vec3(),
            body_eta: self.f32(),
            other_body_albedo: self.vec3(),
            film_reflects: self.f32(),
            other_body_through: self.vec3(),
            body_reflects: self.f32(),
            other_grains: self.vec3(),
            sheen: self.f32(),
            along: self.vec2(),
            stretch: self.f32(),
            retro: self.f32(),
        })
    }

    fn interface_row(&mut self) -> (RowUniform, Fields) {
        filled!(RowUniform {
            t: std::array::from_fn::<_, MU_TERMS, _>(|_| self.f32()),
            late: std::array::from_fn::<_, LATE_TERMS, _>(|_| self.f32()),
        })
    }

    fn interface_mean(&mut self) -> (MeanUniform, Fields) {
        filled!(MeanUniform {
            compensation: self.f32(),
            t_mean: self.f32(),
            capture: self.f32(),
            floor: self.f32(),
        })
    }

    fn film(&mut self) -> (FilmUniform, Fields) {
        filled!(FilmUniform {
            excess: std::array::from_fn::<_, FILM_TERMS, _>(|_| self.vec4()),
            internal: std::array::from_fn::<_, FILM_TERMS, _>(|_| self.vec4()),
            diffuse_path: self.vec4(),
        })
    }

    fn split(&mut self) -> (SplitUniform, Fields) {
        filled!(SplitUniform {
            kappa: self.vec3(),
            mean: self.f32(),
            at_capture: self.vec3(),
            depth: self.f32(),
            leaning: self.vec3(),
            inner_mean: self.f32(),
            alike: self.f32(),
            captured: self.f32(),
            of_direction: self.vec4(),
            forward_share: self.f32(),
            g_forward: self.f32(),
            g_backward: self.f32(),
        })
    }

    fn through(&mut self) -> (ThroughUniform, Fields) {
        filled!(ThroughUniform {
            reflected: self.vec3(),
            inner_mean: self.f32(),
            transmitted: self.vec3(),
            ballistic: self.vec3(),
            reflected_leaning: self.vec3(),
            transmitted_leaning: self.vec3(),
            straight_mean: self.vec3(),
            flat_share: self.vec3(),
            toned: std::array::from_fn::<_, TONE_TERMS, _>(|_| self.vec3()),
            lightest: self.vec3(),
        })
    }

    fn paper(&mut self) -> (PaperUniform, Fields) {
        filled!(PaperUniform {
            clip_from_local: Mat4::from_cols(self.vec4(), self.vec4(), self.vec4(), self.vec4()),
            eye: self.vec4(),
            ambient: self.vec3(),
            lamp_count: self.u32(),
            table: self.vec3(),
            alpha: self.f32(),
            bare: self.vec3(),
            specular: self.f32(),
            size: self.vec2(),
            eta: self.f32(),
            f_normal: self.f32(),
            normal_axes: self.vec4(),
            normal_offset: self.vec2(),
            sign_gain: self.f32(),
            overlay_count: self.u32(),
            albedo_place: self.map_place().0,
            normal_place: self.map_place().0,
            roughness_place: self.map_place().0,
            matter_place: self.map_place().0,
            media: self.media().0,
            outline_place: self.map_place().0,
            level: self.vec4(),
            light_table: self.vec3(),
            normal_out: self.vec4(),
            lights: std::array::from_fn::<_, MAX_LAMPS, _>(|_| self.light().0),
            overlays: std::array::from_fn::<_, MAX_OVERLAYS, _>(|_| self.map_place().0),
            quadrature: std::array::from_fn::<_, { GAUSS_LEGENDRE.len() }, _>(|_| self.vec4()),
            through: self.through().0,
            lit_bare: self.vec3(),
            f_capture: self.f32(),
            other_bare: self.vec3(),
            clear_scale: self.f32(),
            other_place: self.map_place().0,
            other_matter_place: self.map_place().0,
            photographed_place: self.map_place().0,
            photographed_bare: self.vec3(),
            transmission_place: self.map_place().0,
            height_place: self.map_place().0,
            height_range: self.vec2(),
            height_texel: self.f32(),
            row_scale: self.f32(),
            row_offset: self.f32(),
            picture_aspect: self.f32(),
            cut_circle: self.vec4(),
            cut_lines: std::array::from_fn::<_, 4, _>(|_| self.vec4()),
        })
    }
}

/// Where the shader's struct `name` does not read what the uniform writes.
fn misread(module: &naga::Module, name: &str, (whole, fields): &Filled) -> Vec<String> {
    // The composer marks the names of imported types.
    let imported = format!("{name}X_naga_oil");
    let is_it = |each: &str| each == name || each.starts_with(&imported);
    let (members, span) = module
        .types
        .iter()
        .find_map(|(_, of)| match (&of.name, &of.inner) {
            (Some(each), naga::TypeInner::Struct { members, span }) if is_it(each) => {
                Some((members, *span))
            }
            _ => None,
        })
        .unwrap_or_else(|| panic!("no struct {name}"));
    let mut faults = Vec::new();
    if span as usize != whole.len() {
        faults.push(format!("{name}: {span} bytes, not {}", whole.len()));
    }
    let mut fields: BTreeMap<_, _> = fields.iter().map(|(name, own)| (*name, own)).collect();
    for member in members {
        let of_member = member.name.as_deref().unwrap_or_default();
        let offset = member.offset as usize;
        match fields.remove(of_member) {
            None => faults.push(format!("{name}.{of_member} is never written")),
            Some(own) if whole.get(offset..offset + own.len()) == Some(own) => {}
            Some(_) => faults.push(format!("{name}.{of_member} reads another field")),
        }
    }
    faults.extend(
        fields
            .keys()
            .map(|field| format!("{name}.{field} is never read")),
    );
    faults
}

fn parse(text: &str) -> naga::Module {
    naga::front::wgsl::parse_str(text).expect("plain WGSL")
}

#[test]
fn uniforms_lie_in_memory_as_the_shader_reads_them() {
    fn whole<T: ShaderType + WriteInto>((value, fields): (T, Fields)) -> Filled {
        (bytes(&value), fields)
    }
    let mut sentinel = Sentinel(0);
    let light = whole(sentinel.light());
    let row = whole(sentinel.interface_row());
    let mean = whole(sentinel.interface_mean());
    let place = whole(sentinel.map_place());
    let particle = whole(sentinel.particle());
    let media = whole(sentinel.media());
    let paper = whole(sentinel.paper());
    let physics = parse(PAPER_BSDF);
    let glue = Composer::new("")
        .compose(&["TIER_GALLERY", "COUPLED"])
        .unwrap();
    let (film, split) = (whole(sentinel.film()), whole(sentinel.split()));
    let through = whole(sentinel.through());
    for faults in [
        misread(&physics, "Film", &film),
        misread(&physics, "Split", &split),
        misread(&physics, "Through", &through),
        misread(&physics, "Light", &light),
        misread(&physics, "InterfaceRow", &row),
        misread(&physics, "InterfaceMean", &mean),
        misread(&glue, "Light", &light),
        misread(&glue, "MapPlace", &place),
        misread(&glue, "Particle", &particle),
        misread(&glue, "Media", &media),
        misread(&glue, "Paper", &paper),
    ] {
        assert_eq!(faults, [""; 0]);
    }
}

#[test]
fn members_out_of_place_are_found() {
    let (place, fields) = Sentinel(0).map_place();
    let place = (bytes(&place), fields);
    let swapped = "struct MapPlace { row_u: vec3<f32>, lit: f32, row_v: vec3<f32>, opacity: f32 }";
    assert_eq!(
        misread(&parse(swapped), "MapPlace", &place),
        [
            "MapPlace.lit reads another field",
            "MapPlace.opacity reads another field"
        ]
    );
    let shorter = "struct MapPlace { row_u: vec3<f32>, opacity: f32, row_v: vec2<f32> }";
    let faults = misread(&parse(shorter), "MapPlace", &place);
    assert!(
        faults.contains(&"MapPlace.lit is never read".to_owned()),
        "{faults:?}"
    );
}

/// Where the glue differs by more than a call.
const TIERS: [&str; 4] = ["TIER_LAMBERT", "TIER_DRAFT", "TIER_GALLERY", "TIER_STUDY"];
/// Defined with these tiers, and with them alone.
const COUPLED: [&str; 2] = ["TIER_GALLERY", "TIER_STUDY"];
/// Defined with these terms, and with them alone.
const GLOSS: [&str; 2] = ["RETRO", "ANISOTROPIC"];
/// What follows from other definitions.
const DERIVED: [&str; 3] = ["COUPLED", "PATHS", "GLOSS"];
/// These differ in the function that is called, and in nothing else.
const BASELINES: [&str; 9] = [
    "TIER_ISLE",
    "TIER_PHONG",
    "TIER_PHONG_PLAIN",
    "TIER_BLINN_PHONG",
    "TIER_BLINN_PHONG_PLAIN",
    "TIER_COOK_TORRANCE",
    "TIER_COOK_TORRANCE_GAUSS",
    "TIER_COOK_TORRANCE_BLINN",
    "TIER_OREN_NAYAR",
];

#[test]
fn the_material_defines_what_the_glue_asks_for() {
    let material = include_str!("../src/sheet/material.rs");
    let (_, rest) = material
        .split_once("pub fn definitions")
        .expect("the definitions");
    let (list, _) = rest.split_once(".into_iter()").expect("their end");
    let defined: BTreeSet<&str> = list.split('"').skip(1).step_by(2).collect();
    let asked: BTreeSet<&str> = DEFINITIONS.iter().copied().collect();
    assert_eq!(defined, asked);
    let tiers: BTreeSet<&str> = TIERS.into_iter().chain(BASELINES).collect();
    let asked = asked.into_iter().filter(|name| name.starts_with("TIER_"));
    assert_eq!(asked.collect::<BTreeSet<_>>(), tiers);
}

/// Terms that are needed with others only: see `side_needs` in src/needs.rs. The needed stand
/// before those that need them.
const NEEDS: [(&str, &str); 18] = [
    ("TRANSMISSION", "BEHIND"),
    ("TRANSMISSION_MAP", "TRANSMISSION"),
    ("OTHER_ALBEDO", "BEHIND"),
    ("SHOW_THROUGH", "OTHER_ALBEDO"),
    ("SHOW_THROUGH", "TIER_STUDY"),
    ("PHOTOGRAPHED", "SHOW_THROUGH"),
    ("OTHER_MATTER", "OTHER_ALBEDO"),
    ("OTHER_MATTER", "TIER_STUDY"),
    ("MATTER", "ALBEDO_MAP"),
    ("MATTER", "TIER_STUDY"),
    ("PARTICLES", "MATTER"),
    ("BODY", "MATTER"),
    ("MEDIA_INDEX", "MATTER"),
    ("MATTER_MORE", "PARTICLES"),
    ("RETRO", "TIER_STUDY"),
    ("ANISOTROPIC", "TIER_STUDY"),
    ("SHEEN", "TIER_STUDY"),
    ("RELIEF_SHADOWS", "TIER_STUDY"),
];

/// Whether a side can need these terms.
fn can_occur(defined: &[&str]) -> bool {
    let has = |name| defined.contains(&name);
    let tiers = TIERS.iter().chain([&BASELINES[0]]);
    // Nothing of the Lambert tier is rough, and the draft tier takes a rectangle for a point.
    tiers.filter(|tier| has(tier)).count() == 1
        && NEEDS.iter().all(|(term, needed)| has(needed) || !has(term))
        && (!has("BEHIND") || has("TRANSMISSION") || has("SHOW_THROUGH"))
        && !(has("TIER_LAMBERT") && has("ROUGHNESS_MAP"))
        && !(has("AREA_LAMPS") && (has("DISTANT_LAMPS") || has("TIER_DRAFT")))
}

/// How many needs are drawn: each that shows four terms in a state that occurs is one in some
/// thousands of them.
const DRAWN: u64 = 100_000;

/// Needs at random, the same each time; most at the study tier, which has most terms.
fn drawn(names: &[&str]) -> impl Iterator<Item = u64> {
    let bit = |name: &str| 1 << names.iter().position(|each| *each == name).expect(name);
    let tiers: Vec<u64> = TIERS
        .iter()
        .chain([&BASELINES[0]])
        .map(|tier| bit(tier))
        .collect();
    let needs = NEEDS.map(|(term, needed)| (bit(term), bit(needed)));
    let study = bit("TIER_STUDY");
    (0..DRAWN).map(move |i| {
        let mut z = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let (set, turn) = (z ^ (z >> 31), i as usize);
        let tier = if turn % 2 == 0 {
            study
        } else {
            tiers[turn / 2 % tiers.len()]
        };
        let none = tiers.iter().fold(set, |set, tier| set & !tier);
        needs.iter().fold(none | tier, |set, (term, needed)| {
            if set & needed == 0 { set & !term } else { set }
        })
    })
}

/// Of the sets of bits, as few as show every four bits in each of the sixteen states that some
/// set shows.
fn every_four(sets: impl Iterator<Item = u64>, bits: u32) -> Vec<u64> {
    let mut fours = Vec::new();
    for a in 0..bits {
        for b in a + 1..bits {
            for c in b + 1..bits {
                fours.extend((c + 1..bits).map(|d| [a, b, c, d]));
            }
        }
    }
    let mut seen = vec![0u16; fours.len()];
    sets.filter(|set| {
        let mut new = false;
        for (four, seen) in fours.iter().zip(&mut seen) {
            let state = four
                .iter()
                .fold(0, |state, bit| state << 1 | (set >> bit & 1));
            new |= *seen & 1 << state == 0;
            *seen |= 1 << state;
        }
        new
    })
    .collect()
}

/// The terms are too many for every need. The glue nests two definitions and reads what two
/// others declare, so that a fault shows in some four of them.
#[test]
fn the_glue_is_valid_for_every_four_terms() {
    // One baseline stands for all of them: below they take turns.
    let names: Vec<&str> = DEFINITIONS
        .iter()
        .copied()
        .filter(|name| !BASELINES[1..].contains(name) && !DERIVED.contains(name))
        .collect();
    let bits = names.len() as u32;
    let defined = |set: u64| -> Vec<&str> {
        let on = (0..names.len()).filter(|i| set >> i & 1 == 1);
        on.map(|i| names[i]).collect()
    };
    let needs = every_four(drawn(&names).filter(|&set| can_occur(&defined(set))), bits);
    assert!(needs.len() > 100);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for share in needs.chunks(needs.len().div_ceil(threads)) {
            scope.spawn(move || {
                let mut composer = Composer::new("");
                for (turn, &set) in share.iter().enumerate() {
                    let mut defined = defined(set);
                    let any = |terms: &[&str]| terms.iter().any(|term| defined.contains(term));
                    let (coupled, gloss) = (any(&COUPLED), any(&GLOSS));
                    let paths = coupled && any(&["TIER_STUDY", "TRANSMISSION"]);
                    defined.extend(coupled.then_some("COUPLED"));
                    defined.extend(paths.then_some("PATHS"));
                    defined.extend(gloss.then_some("GLOSS"));
                    if let Some(tier) = defined.iter_mut().find(|name| **name == BASELINES[0]) {
                        *tier = BASELINES[turn % BASELINES.len()];
                    }
                    let module = composer.compose(&defined).unwrap();
                    validate(&module).unwrap_or_else(|error| panic!("{defined:?}: {error}"));
                    assert_eq!(module.entry_points.len(), 2, "{defined:?}");
                }
            });
        }
    });
    eprintln!("{} shaders composed and validated", needs.len());
}

/// What no paper and no media ask for is not in the shader.
#[test]
fn terms_that_are_not_needed_are_absent() {
    let mut composer = Composer::new("");
    let mut functions = |more: &[&str]| -> BTreeSet<String> {
        let always = [
            "TIER_STUDY",
            "COUPLED",
            "PATHS",
            "ALBEDO_MAP",
            "DISTANT_LAMPS",
            "ONE_LAMP",
        ];
        let module = composer.compose(&[&always, more].concat()).unwrap();
        let mut reached = BTreeSet::new();
        let mut left: Vec<&naga::Function> = module
            .entry_points
            .iter()
            .map(|entry| &entry.function)
            .collect();
        while let Some(function) = left.pop() {
            for called in calls(&function.body) {
                let name = module.functions[called].name.clone().unwrap_or_default();
                let name = name
                    .split("X_naga_oil")
                    .next()
                    .unwrap_or_default()
                    .to_owned();
                if reached.insert(name) {
                    left.push(&module.functions[called]);
                }
            }
        }
        reached
    };
    let plain = functions(&[]);
    assert!(plain.contains("brdf_study"));
    for (terms, own) in [
        (&["MATTER"][..], "shares_of"),
        (&["MATTER", "PARTICLES"], "particle_lobe"),
        (&["MATTER", "BODY"], "brdf_body"),
        (&["MATTER", "MEDIA_INDEX"], "interface_of"),
        (&["GLOSS", "RETRO"], "turned"),
        (&["GLOSS", "ANISOTROPIC"], "gloss_lobe_anisotropic"),
        (&["SHEEN"], "brdf_sheen"),
        (&["BEHIND", "OTHER_ALBEDO", "SHOW_THROUGH"], "shown_through"),
    ] {
        assert!(!plain.contains(own), "{own}");
        assert!(functions(terms).contains(own), "{terms:?}: {own}");
    }
}

/// The functions that statements call.
fn calls(block: &naga::Block) -> Vec<naga::Handle<naga::Function>> {
    let mut found = Vec::new();
    for statement in block.iter() {
        match statement {
            naga::Statement::Call { function, .. } => found.push(*function),
            naga::Statement::Block(block) => found.extend(calls(block)),
            naga::Statement::If { accept, reject, .. } => {
                found.extend(calls(accept));
                found.extend(calls(reject));
            }
            naga::Statement::Switch { cases, .. } => {
                found.extend(cases.iter().flat_map(|case| calls(&case.body)));
            }
            naga::Statement::Loop {
                body, continuing, ..
            } => {
                found.extend(calls(body));
                found.extend(calls(continuing));
            }
            _ => {}
        }
    }
    found
}

#[test]
fn the_glue_is_valid_for_every_baseline() {
    let mut composer = Composer::new("");
    for tier in BASELINES {
        for more in [&[][..], &["ALBEDO_MAP", "ROUGHNESS_MAP", "AMBIENT"]] {
            let module = composer.compose(&[&[tier], more].concat()).unwrap();
            validate(&module).unwrap_or_else(|error| panic!("{tier}: {error}"));
        }
    }
}

/// What another member of a comparison shows is spared by the rasteriser: the vertex shader has the
/// distances, and no fragment shader beside it, which could not read them.
#[test]
fn the_clipping_vertex_shader_is_valid() {
    let mut composer = Composer::new("");
    for more in [&[][..], &["CURVED"], &["SHARED_UV"], &["CUT"]] {
        let defined = [&["TIER_GALLERY", "COUPLED", CLIPS], more].concat();
        let module = composer.compose(&defined).unwrap();
        // The one thing that the device must offer: without it the vertex shader has no distances.
        assert!(validate(&module).is_err());
        Validator::new(ValidationFlags::all(), Capabilities::CLIP_DISTANCE)
            .validate(&module)
            .unwrap_or_else(|error| panic!("{more:?}: {error:?}"));
        let stages: Vec<naga::ShaderStage> = module.entry_points.iter().map(|e| e.stage).collect();
        assert_eq!(stages, [naga::ShaderStage::Vertex]);
        let clips = |binding: &Option<naga::Binding>| {
            *binding == Some(naga::Binding::BuiltIn(naga::BuiltIn::ClipDistance))
        };
        let members = module.types.iter().filter_map(|(_, t)| match &t.inner {
            naga::TypeInner::Struct { members, .. } => Some(members),
            _ => None,
        });
        assert!(members.flatten().any(|member| clips(&member.binding)));
    }
}

#[test]
fn a_glue_that_is_not_valid_is_found() {
    let mut composer = Composer::new("fn wrong() -> f32 { return 1u; }");
    let outcome = composer
        .compose(&["TIER_LAMBERT"])
        .and_then(|module| validate(&module));
    assert!(outcome.is_err());
}
