//! Writers: values, resolution, repeatable bytes, all or nothing.

use std::fs;

use recto::maps::{self, ColourEncoding, Texels, encode, probe};

use super::{channel, folder};

#[test]
fn pngs_come_back_as_written() {
    let folder = folder();
    let path = folder.path().join("map.png");
    let grey16 = [0, 1, 256, 40000, 65534, 65535];
    encode::save_png_grey16(&path, 3, 2, &grey16, Some(300.0)).expect("written");
    let header = probe(&path).expect("read");
    assert_eq!((header.size, header.channels, header.bits), ([3, 2], 1, 16));
    // PNG counts whole pixels per metre.
    let [x, y] = header.dpi.expect("a resolution");
    assert!((x - 300.0).abs() < 0.013 && x == y, "{x}");
    let map = maps::load_height(&path).expect("read");
    assert_eq!(map.levels[0].texels, Texels::Unorm16(grey16.to_vec()));

    encode::save_png_grey8(&path, 2, 1, &[7, 200], None).expect("written");
    let header = probe(&path).expect("read");
    assert_eq!((header.channels, header.bits, header.dpi), (1, 8, None));
    let map = maps::load_roughness(&path, false).expect("read");
    assert_eq!(map.levels[0].texels, Texels::Unorm8(vec![7, 200]));

    let rgb16 = [[1, 2, 3], [65535, 40000, 0]];
    encode::save_png_rgb16(&path, 1, 2, &rgb16, None).expect("written");
    let map = maps::load_colour(&path, ColourEncoding::Linear).expect("read");
    let expected = vec![1, 2, 3, 65535, 65535, 40000, 0, 65535];
    assert_eq!(map.levels[0].texels, Texels::Unorm16(expected));
}

#[test]
fn exr_values_are_untouched() {
    let folder = folder();
    let path = folder.path().join("map.exr");
    // All exact in half floats, some outside 0…1.
    let pixels = [[-0.125, 0.5, 3.0], [0.0, 1.0, 512.5], [0.25, 0.75, -2.0]];
    encode::save_exr_rgb(&path, 3, 1, &pixels).expect("written");
    let header = probe(&path).expect("read");
    assert_eq!(
        (header.size, header.channels, header.bits, header.float),
        ([3, 1], 3, 32, true)
    );
    let map = maps::load_colour(&path, ColourEncoding::Embedded).expect("read");
    for c in 0..3 {
        assert_eq!(channel(&map, 0, c), pixels.map(|pixel| pixel[c]));
    }
}

#[test]
fn bytes_are_repeatable() {
    let folder = folder();
    let float: Vec<_> = (0..300 * 300)
        .map(|i| [i as f32, (i % 7) as f32, 0.5])
        .collect();
    let [a, b] = ["a.exr", "b.exr"].map(|name| {
        let path = folder.path().join(name);
        encode::save_exr_rgb(&path, 300, 300, &float).expect("written");
        fs::read(path).expect("read")
    });
    assert!(a == b);
}

#[test]
fn a_failed_write_leaves_nothing() {
    let folder = folder();
    let path = folder.path().join("map.png");
    fs::write(&path, "old").expect("written");
    let error = encode::save_png_grey8(&path, 2, 2, &[0; 3], None).expect_err("too short");
    assert!(
        error
            .to_string()
            .ends_with("map.png: cannot be written: 2 × 2 pixels need 4 values, not 3")
    );
    let fail = encode::write_whole(&path, |_| Err(std::io::Error::other("no more ink")));
    assert!(fail.is_err());
    assert_eq!(fs::read(&path).expect("still there"), b"old");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    let nowhere = folder.path().join("no/such/folder/map.png");
    assert!(encode::save_png_grey8(&nowhere, 1, 1, &[0], None).is_err());
}
