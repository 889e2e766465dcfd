//! A real leaf: its size from the file, and the ink of the verso seen through the recto.

use recto::maps::{self, ColourEncoding, probe};

use super::{
    channel,
    show_through::{PATCHES, Page, SHRINK, best_shift},
    support::data,
};
use crate::test_name;

#[test]
fn dpi_gives_the_physical_size() {
    let Some(root) = data(test_name!(), "bnf_recto_verso") else {
        return;
    };
    for (name, height) in [("it820_3r_f11.jpg", 3522), ("it820_3v_f12.jpg", 3559)] {
        let header = probe(&root.join(name)).expect(name);
        assert_eq!((header.size, header.icc), ([2417, height], true));
        let [x, y] = header.dpi.expect("a resolution");
        let mm = [2417.0 / x * 25.4, f64::from(height) / y * 25.4];
        assert!(
            (mm[0] - 153.5).abs() < 0.1 && (223.0..227.0).contains(&mm[1]),
            "{mm:?}"
        );
    }
}

/// A page at a quarter of its size.
fn page(path: &std::path::Path, mirrored: bool) -> Page {
    let level = SHRINK.ilog2() as usize;
    let map = maps::load_colour(path, ColourEncoding::Embedded).expect("read");
    let (width, height) = (
        map.levels[level].width as usize,
        map.levels[level].height as usize,
    );
    Page::new(width, height, &channel(&map, level, 1), mirrored)
}

#[test]
fn the_versos_ink_shows_through_its_own_recto_only() {
    let Some(root) = data(test_name!(), "bnf_recto_verso") else {
        return;
    };
    let side = |name: &str, mirrored| page(&root.join(name), mirrored);
    let verso = side("it820_3v_f12.jpg", true);
    let find = |recto: &Page| PATCHES.map(|[x, y]| best_shift(recto, &verso, x, y));
    let own = find(&side("it820_3r_f11.jpg", false));
    let wrong = find(&side("it820_2r_f9.jpg", false));
    // The README of the data finds z = 14–29 at 115–119 px for the true pair and 4–7 for the
    // wrong one at full size; a quarter of the size leaves a quarter of the independent shifts.
    for (z, [dx, dy]) in own {
        assert!(z > 7.0, "{own:?}");
        // Within a reduced pixel.
        assert!(
            (112.0..=123.0).contains(&dx) && dy.abs() <= f64::from(SHRINK),
            "{own:?}"
        );
    }
    assert!(wrong.iter().all(|&(z, _)| z < 5.0), "{wrong:?}");
}
