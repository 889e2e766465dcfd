//! States, overlays and their legend.

use recto::{
    colour::linear_from_srgb8,
    maps::encode::{save_png_grey16, save_png_rgb8, save_png_rgba8},
    optics::tier::Tier,
    shot::Picture,
};

use crate::room::{Fixture, darkroom, mean, picture, pixel};

const SIDE: u32 = 64;

fn fixture() -> Fixture {
    let manifest = "[exhibit]\ntitle = \"Layers\"\n\
        [[drawing]]\nid = \"sheet\"\nsize_mm = [64, 64]\n\
        paper = { kind = \"laid\", specular = 0 }\nrecto.albedo = \"grey.png\"\n\
        [[drawing.state]]\nid = \"before\"\nrecto.albedo = \"dark.png\"\n\
        [[drawing.overlay]]\nid = \"damage\"\nkind = \"categorical\"\nfile = \"damage.png\"\n\
        legend = [ { colour = \"#d55e00\", label = \"Tear\" }, \
        { colour = \"#0072b2\", label = \"Stain\" } ]\n\
        [[drawing.overlay]]\nid = \"moisture\"\nkind = \"continuous\"\nfile = \"ramp.png\"\n\
        unit = \"%\"\nrange = [0, 40]\n\
        [[drawing.overlay]]\nid = \"band\"\nkind = \"picture\"\nfile = \"band.png\"\n\
        [[drawing.overlay]]\nid = \"moved\"\nkind = \"categorical\"\nfile = \"damage.png\"\n\
        legend = [ { colour = \"#d55e00\", label = \"Tear\" }, \
        { colour = \"#0072b2\", label = \"Stain\" } ]\n\
        register = { offset_mm = [16, 0] }\n\
        [[drawing.stack]]\nid = \"light\"\nencoding = \"srgb\"\n\
        bands = [ { file = \"dark.png\", wavelength_nm = 550 }, \
        { file = \"band.png\", wavelength_nm = 850 } ]\n\
        false_colour = [ { id = \"false\", red = { 850 = 1 }, green = { 550 = 1 }, \
        blue = { 550 = 0.5 } } ]\n\
        difference = [ { id = \"less\", of = [550, 850], full = 1 } ]\n\
        [[lamp]]\nid = \"lamp\"\nkind = \"distant\"\nlux_at_sheet = 1000\nkelvin = 6504\n\
        elevation_deg = 45\nazimuth_deg = 135\n\
        [[scene]]\nid = \"bare\"\ncamera = { centre_mm = [32, 32], width_mm = 64 }\n\
        [[scene]]\nid = \"before\"\nlike = \"bare\"\nstate = \"before\"\n\
        [[scene]]\nid = \"half\"\nlike = \"bare\"\noverlays = [{ id = \"damage\", opacity = 0.5 }]\n\
        [[scene]]\nid = \"whole\"\nlike = \"bare\"\noverlays = [\"damage\"]\n\
        [[scene]]\nid = \"values\"\nlike = \"bare\"\noverlays = [\"moisture\"]\n\
        [[scene]]\nid = \"band\"\nlike = \"bare\"\noverlays = [\"band\"]\n\
        [[scene]]\nid = \"moved\"\nlike = \"bare\"\noverlays = [\"moved\"]\n\
        [[scene]]\nid = \"both\"\nlike = \"bare\"\noverlays = [\"band\", \"damage\"]\n\
        [[scene]]\nid = \"tears\"\nlike = \"bare\"\n\
        overlays = [{ id = \"damage\", categories = [\"Tear\"] }]\n\
        [[scene]]\nid = \"lit\"\nlike = \"bare\"\noverlays = [\"light/850\"]\n\
        [[scene]]\nid = \"false\"\nlike = \"bare\"\noverlays = [\"light/false\"]\n\
        [[scene]]\nid = \"less\"\nlike = \"bare\"\noverlays = [\"light/less\"]\n\
        [[scene]]\nid = \"halves\"\nlike = \"bare\"\n\
        compare = { mode = \"curtain\", of = [\"band:light/550\", \"band:light/850\"] }\n\
        [[scene]]\nid = \"clear\"\nlike = \"bare\"\noverlays = [{ id = \"damage\", opacity = 0 }]\n";
    let count = (SIDE * SIDE) as usize;
    Fixture::new(manifest, |folder| {
        let plain = |name: &str, grey: u8| {
            save_png_rgb8(
                &folder.join(name),
                SIDE,
                SIDE,
                &vec![[grey; 3]; count],
                None,
            )
            .expect(name);
        };
        plain("grey.png", 128);
        plain("dark.png", 60);
        plain("band.png", 200);
        // Left quarter a tear, then nothing, right quarter a stain.
        let damage: Vec<[u8; 4]> = (0..count)
            .map(|i| match i as u32 % SIDE {
                0..16 => [0xd5, 0x5e, 0x00, 255],
                48.. => [0x00, 0x72, 0xb2, 255],
                _ => [0; 4],
            })
            .collect();
        save_png_rgba8(&folder.join("damage.png"), SIDE, SIDE, &damage, None).expect("damage");
        let ramp: Vec<u16> = (0..count)
            .map(|i| (i as u32 % SIDE * 65535 / (SIDE - 1)) as u16)
            .collect();
        save_png_grey16(&folder.join("ramp.png"), SIDE, SIDE, &ramp, None).expect("ramp");
    })
}

fn close(found: [f64; 3], expected: [f64; 3]) -> bool {
    (0..3).all(|c| (found[c] - expected[c]).abs() < 2e-3)
}

#[test]
fn layers_lie_as_the_scene_says() {
    let fixture = fixture();
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let mut shoot = |id: &str| -> Picture {
        let (_, scene) = exhibit.scene(id).expect(id);
        picture(&mut room, &exhibit, scene, Tier::Gallery, [SIDE, SIDE])
    };
    let grey = linear_from_srgb8([128; 3]);
    let (tear, stain) = (
        linear_from_srgb8([0xd5, 0x5e, 0x00]),
        linear_from_srgb8([0x00, 0x72, 0xb2]),
    );
    let bare = shoot("bare");
    assert!(
        close(pixel(&bare, 32, 32), grey),
        "{:?}",
        pixel(&bare, 32, 32)
    );
    assert!(bare.legend.is_empty());

    let before = shoot("before");
    assert!(close(pixel(&before, 32, 32), linear_from_srgb8([60; 3])));

    // A sign is shown in its legend's colour, whatever the lamp.
    let whole = shoot("whole");
    assert!(
        close(pixel(&whole, 4, 32), tear),
        "{:?}",
        pixel(&whole, 4, 32)
    );
    assert!(close(pixel(&whole, 60, 32), stain));
    assert!(close(pixel(&whole, 32, 32), grey));
    let half = shoot("half");
    let mixed = std::array::from_fn(|c| 0.5 * (tear[c] + grey[c]));
    assert!(close(pixel(&half, 4, 32), mixed));
    assert!(close(pixel(&shoot("clear"), 4, 32), grey));

    // A band is lit like paper: a perfect stand-in for the albedo.
    let band = shoot("band");
    assert!(close(pixel(&band, 32, 32), linear_from_srgb8([200; 3])));
    let both = shoot("both");
    assert!(close(pixel(&both, 4, 32), tear));
    assert!(close(pixel(&both, 32, 32), linear_from_srgb8([200; 3])));

    let values = shoot("values");
    let [low, high] = [0.0, 1.0].map(|at| recto::maps::ColourMapName::Viridis.colour(at));
    assert!(
        close(pixel(&values, 0, 32), low),
        "{:?} {low:?}",
        pixel(&values, 0, 32)
    );
    assert!(close(pixel(&values, 63, 32), high));

    // Moved 16 mm to the right: nothing where the tear was, and nothing beyond the picture.
    let moved = shoot("moved");
    assert!(close(pixel(&moved, 4, 32), grey));
    assert!(close(pixel(&moved, 20, 32), tear));
}

#[test]
fn a_category_that_is_switched_off_is_gone_from_picture_and_legend() {
    let fixture = fixture();
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let mut shoot = |id: &str, size: [u32; 2]| -> Picture {
        let (_, scene) = exhibit.scene(id).expect(id);
        picture(&mut room, &exhibit, scene, Tier::Gallery, size)
    };
    let tears = shoot("tears", [SIDE, SIDE]);
    assert!(close(pixel(&tears, 4, 32), linear_from_srgb8(TEAR)));
    assert!(close(pixel(&tears, 60, 32), linear_from_srgb8([128; 3])));
    let tears = shoot("tears", [640, 480]);
    assert!(has_swatch(&tears, TEAR) && !has_swatch(&tears, STAIN));
    let whole = shoot("whole", [640, 480]);
    assert!(has_swatch(&whole, TEAR) && has_swatch(&whole, STAIN));
}

#[test]
fn bands_of_a_stack_are_seen_as_the_scene_says() {
    let fixture = fixture();
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let mut shoot = |id: &str| -> Picture {
        let (_, scene) = exhibit.scene(id).expect(id);
        picture(&mut room, &exhibit, scene, Tier::Gallery, [SIDE, SIDE])
    };
    let [dark, light] = [60, 200].map(|grey| linear_from_srgb8([grey; 3])[0]);
    // Reflectance is lit like paper.
    let lit = shoot("lit");
    assert!(
        close(pixel(&lit, 32, 32), [light; 3]),
        "{:?}",
        pixel(&lit, 32, 32)
    );
    let mixed = shoot("false");
    let expected = [light, dark, 0.5 * dark];
    assert!(
        close(pixel(&mixed, 32, 32), expected),
        "{:?}",
        pixel(&mixed, 32, 32)
    );
    // A difference is a sign, whatever the lamp: less is blue.
    let less = shoot("less");
    let at = 0.5 + 0.5 * (dark - light);
    let expected = recto::maps::ColourMapName::Diverging.colour(at);
    let found = pixel(&less, 32, 32);
    assert!(
        close(found, expected) && found[2] > found[0],
        "{found:?} {expected:?}"
    );
    // Against each other, as members of a comparison, whose legend names them.
    let halves = shoot("halves");
    assert!(close(pixel(&halves, 8, 32), [dark; 3]));
    assert!(close(pixel(&halves, 56, 32), [light; 3]));
    assert!(!halves.legend.is_empty());
}

const TEAR: [u8; 3] = [0xd5, 0x5e, 0x00];
const STAIN: [u8; 3] = [0x00, 0x72, 0xb2];

fn has_swatch(frame: &Picture, colour: [u8; 3]) -> bool {
    let linear = linear_from_srgb8(colour);
    frame.legend.iter().any(|texel| {
        texel[3] > 0.99 && (0..3).all(|c| (f64::from(texel[c]) - linear[c]).abs() < 0.02)
    })
}

#[test]
fn a_legend_is_drawn_with_its_colours() {
    let fixture = fixture();
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let (_, scene) = exhibit.scene("whole").expect("the scene");
    let frame = picture(&mut room, &exhibit, scene, Tier::Draft, [640, 480]);
    assert_eq!(frame.legend.len(), frame.pixels.len());
    for colour in [TEAR, STAIN] {
        assert!(has_swatch(&frame, colour), "no swatch of {colour:?}");
    }
    // It stands in a corner, and leaves the sheet alone elsewhere.
    assert!(frame.legend[0][3] == 0.0);
    let drawn = frame.legend.iter().filter(|texel| texel[3] > 0.0).count();
    assert!(drawn > 1000 && drawn < frame.legend.len() / 4, "{drawn}");
}

#[test]
fn fine_stripes_of_two_categories_never_make_a_third() {
    // Far away, tear and stain side by side are a mixture of both colours, within their hull,
    // and not the category whose code lies between.
    let fixture = fixture();
    let count = (SIDE * SIDE) as usize;
    let stripes: Vec<[u8; 4]> = (0..count)
        .map(|i| {
            if i % 2 == 0 {
                [0xd5, 0x5e, 0x00, 255]
            } else {
                [0x00, 0x72, 0xb2, 255]
            }
        })
        .collect();
    save_png_rgba8(
        &fixture.folder.path().join("damage.png"),
        SIDE,
        SIDE,
        &stripes,
        None,
    )
    .expect("stripes");
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let (_, scene) = exhibit.scene("whole").expect("the scene");
    let frame = picture(&mut room, &exhibit, scene, Tier::Lambert, [16, 16]);
    let (tear, stain) = (
        linear_from_srgb8([0xd5, 0x5e, 0x00]),
        linear_from_srgb8([0x00, 0x72, 0xb2]),
    );
    let expected = 0.5 * (tear[1] + stain[1]);
    assert!((mean(&frame, [2, 2], [14, 14]) - expected).abs() < 2e-3);
}
