//! A frame of each baseline.

use recto::optics::tier::Tier;

use crate::room::{Fixture, darkroom, largest_difference, picture};

/// Less would be lost on a display with 8 bits.
const SEEN: f32 = 1e-3;

#[test]
fn every_tier_is_a_picture_of_its_own() {
    let manifest = "[exhibit]\ntitle = \"Bare\"\n[[drawing]]\nid = \"sheet\"\n\
         size_mm = [100, 100]\nrecto.albedo = \"grey.png\"\n\
         paper = { kind = \"burnished\" }\n\
         [[lamp]]\nid = \"near\"\nkind = \"point\"\ncandela = 200\nposition_mm = [80, 20, 120]\n\
         [[scene]]\nid = \"tilted\"\ncamera = { tilt_deg = 45, distance_mm = 300 }\n";
    let fixture = Fixture::new(manifest, |folder| {
        let grey = [150; 64];
        recto::maps::encode::save_png_grey8(&folder.join("grey.png"), 8, 8, &grey, None)
            .expect("the picture");
    });
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let frames: Vec<_> = Tier::ALL
        .into_iter()
        .map(|tier| {
            let frame = picture(&mut room, &exhibit, &exhibit.scenes[0], tier, [48, 32]);
            let sound = |v: &f32| v.is_finite() && *v >= 0.0;
            assert!(frame.pixels.iter().flatten().all(sound), "{tier}");
            (tier, frame)
        })
        .collect();
    for (i, (tier, frame)) in frames.iter().enumerate() {
        for (other, reference) in &frames[..i] {
            let difference = largest_difference(frame, reference);
            assert!(difference > SEEN, "{tier} is {other}: {difference}");
        }
    }
}
