use super::*;

/// Another version of `path`, which a coarse clock cannot take for the one before.
fn save(path: &Path, text: &str) {
    std::fs::write(path, text).expect("the file is written");
}

#[test]
fn only_what_is_new_and_sound_comes_out_and_faults_are_told_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let manifest = folder.path().join("exhibit.toml");
    let picture = folder.path().join("recto.png");
    let draw = |level: u8, side: u32| {
        let pixels = vec![[level; 3]; (side * side) as usize];
        crate::maps::encode::save_png_rgb8(&picture, side, side, &pixels, None)
            .expect("the picture is written");
    };
    let sound = "[exhibit]\ntitle = \"One\"\n[[drawing]]\nid = \"sheet\"\n\
                 size_mm = [20.0, 20.0]\nrecto.albedo = \"recto.png\"\n";
    draw(200, 8);
    save(&manifest, sound);
    let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
    let mut reader = Reader::new(&exhibit);
    assert!(reader.read().expect("it is sound").is_none());

    save(&manifest, &sound.replace("One", "Another"));
    let (read, _) = reader.read().expect("it is sound").expect("it is new");
    assert!(!read.maps_changed);

    save(&manifest, &sound.replace("size_mm", "size_nm"));
    assert!(reader.read().is_err());
    assert!(reader.read().expect("it is told already").is_none());

    save(&manifest, sound);
    draw(100, 9);
    let (read, _) = reader.read().expect("it is sound").expect("it is new");
    assert!(read.maps_changed);

    let bytes = std::fs::read(&picture).expect("a picture");
    std::fs::write(&picture, &bytes[..bytes.len() / 2]).expect("the file is written");
    assert!(reader.read().is_err(), "half a picture is a fault");
    std::fs::write(&picture, &bytes).expect("the file is written");
    let (read, _) = reader.read().expect("it is sound").expect("it is new");
    assert!(read.maps_changed);
}

/// Publishes `text`, as `recto publish` does, as the version `name`.
#[cfg(unix)]
fn publish(root: &Path, name: &str, text: &str) {
    let version = root.join("versions").join(name);
    std::fs::create_dir_all(&version).expect("a folder");
    draw(&version.join("one.png"));
    draw(&version.join("two.png"));
    save(&version.join("exhibit.toml"), text);
    let link = root.join("new");
    std::os::unix::fs::symlink(Path::new("versions").join(name), &link).expect("a link");
    std::fs::rename(&link, root.join("current")).expect("it takes its place");
}

#[cfg(unix)]
#[test]
fn another_version_is_read_when_the_pointer_leads_to_it() {
    let root = tempfile::tempdir().expect("a temporary folder");
    let text = two_drawings("\"two.png\"");
    publish(root.path(), "a", &text);
    let (exhibit, _) = Exhibit::read(root.path()).expect("it is sound");
    let mut reader = Reader::new(&exhibit);
    assert!(reader.read().expect("it is sound").is_none());
    publish(root.path(), "b", &text.replace("\"Two\"", "\"Second\""));
    let watched = reader.places();
    assert!(
        watched
            .iter()
            .any(|(place, _)| place.ends_with("versions/b"))
    );
    let (sound, _) = reader.read().expect("it is sound").expect("it is new");
    assert!(sound.exhibit.folder.ends_with("versions/b"));
    assert!(sound.maps_changed, "its maps are others");
    assert!(reader.read().expect("it is sound").is_none());
}

/// The titles that come out of a thread that watches, each waited for.
struct Watched {
    news: News,
}

impl Watched {
    fn of(path: &Path) -> Self {
        let (exhibit, _) = Exhibit::read(path).expect("it is sound");
        let (news, thread) = News::of(&exhibit, None);
        thread.expect("a thread");
        Self { news }
    }

    fn heard(&self, within: Duration) -> Result<Sound, RecvTimeoutError> {
        let receiver = self.news.receiver.lock().expect("nobody panicked");
        loop {
            if let Read::Sound(sound) = receiver.recv_timeout(within)? {
                return Ok(*sound);
            }
        }
    }

    /// What comes out once `change` was made; made again where the watch was not yet there.
    fn title_after(&self, mut change: impl FnMut()) -> String {
        loop {
            change();
            if let Ok(sound) = self.heard(Duration::from_secs(3)) {
                return sound.exhibit.title.0["en"].clone();
            }
        }
    }
}

#[test]
fn an_exhibit_that_is_no_longer_shown_is_no_longer_watched() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    draw(&folder.path().join("one.png"));
    draw(&folder.path().join("two.png"));
    save(
        &folder.path().join("exhibit.toml"),
        &two_drawings("\"two.png\""),
    );
    let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
    let (news, thread) = News::of(&exhibit, None);
    let thread = thread.expect("a thread");
    thread::sleep(Duration::from_millis(300));
    assert!(!thread.is_finished(), "it watches");
    drop(news);
    thread.join().expect("it ends");
}

#[cfg(unix)]
#[test]
fn a_published_version_comes_out_and_so_does_the_one_after_it() {
    let root = tempfile::tempdir().expect("a temporary folder");
    let text = |title: &str| two_drawings("\"two.png\"").replace("Two", title);
    publish(root.path(), "v0", &text("0"));
    let watched = Watched::of(root.path());
    for number in ["1", "2", "3"] {
        let mut tries = 0;
        let title = watched.title_after(|| {
            tries += 1;
            publish(root.path(), &format!("v{number}-{tries}"), &text(number));
        });
        assert_eq!(title, number);
    }
}

#[test]
fn a_folder_that_was_removed_is_read_when_it_is_back() {
    let root = tempfile::tempdir().expect("a temporary folder");
    let folder = root.path().join("exhibit");
    let write = |title: &str| {
        std::fs::create_dir_all(&folder).expect("a folder");
        draw(&folder.join("one.png"));
        draw(&folder.join("two.png"));
        let text = two_drawings("\"two.png\"").replace("Two", title);
        save(&folder.join("exhibit.toml"), &text);
    };
    write("here");
    let watched = Watched::of(&folder);
    for title in ["back", "back again"] {
        let found = watched.title_after(|| {
            std::fs::remove_dir_all(&folder).expect("it is removed");
            thread::sleep(Duration::from_millis(400));
            write(title);
        });
        assert_eq!(found, title);
    }
}

/// Two drawings, the second with this albedo.
fn two_drawings(second: &str) -> String {
    format!(
        "[exhibit]\ntitle = \"Two\"\n\
         [[drawing]]\nid = \"one\"\nsize_mm = [20.0, 20.0]\n\
         recto.albedo = \"one.png\"\n\
         [[drawing]]\nid = \"two\"\nsize_mm = [20.0, 20.0]\n\
         recto.albedo = {second}\n"
    )
}

fn draw(path: &Path) {
    crate::maps::encode::save_png_rgb8(path, 8, 8, &[[200; 3]; 64], None)
        .expect("the picture is written");
}

fn draw_with_broken_profile(path: &Path) {
    let mut info = png::Info::with_size(8, 8);
    info.color_type = png::ColorType::Rgb;
    info.bit_depth = png::BitDepth::Eight;
    info.icc_profile = Some(b"no profile".into());
    let file = std::fs::File::create(path).expect("the file is created");
    png::Encoder::with_info(file, info)
        .and_then(|encoder| encoder.write_header())
        .and_then(|mut writer| writer.write_image_data(&[200; 3 * 64]))
        .expect("the picture is written");
}

#[test]
fn a_map_that_was_never_decoded_is_looked_at_before_it_comes_out() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let manifest = folder.path().join("exhibit.toml");
    let second = folder.path().join("two.png");
    draw(&folder.path().join("one.png"));
    draw(&second);
    let whole = std::fs::read(&second).expect("a picture");
    std::fs::write(&second, &whole[..whole.len() - 20]).expect("the file is written");
    let text = two_drawings("\"two.png\"");
    save(&manifest, &text);
    let (exhibit, _) = Exhibit::read(folder.path()).expect("its headers are sound");
    let mut reader = Reader::new(&exhibit);

    save(&manifest, &text.replace("\"Two\"", "\"Second\""));
    assert!(reader.read().is_err(), "half a picture is a fault");
    std::fs::write(&second, &whole).expect("the file is written");
    assert!(reader.read().expect("it is sound").is_some());
}

#[test]
fn a_map_that_is_read_in_another_way_is_looked_at_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let manifest = folder.path().join("exhibit.toml");
    draw(&folder.path().join("one.png"));
    draw_with_broken_profile(&folder.path().join("two.png"));
    let text = two_drawings("{ file = \"two.png\", encoding = \"srgb\" }");
    save(&manifest, &text);
    let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
    let mut reader = Reader::new(&exhibit);
    save(&manifest, &text.replace("\"Two\"", "\"Second\""));
    assert!(reader.read().expect("it is sound").is_some());

    save(&manifest, &two_drawings("\"two.png\""));
    assert!(reader.read().is_err(), "its profile is broken");
}

#[test]
fn a_fault_that_comes_back_is_told_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let manifest = folder.path().join("exhibit.toml");
    for picture in ["one.png", "two.png"] {
        draw(&folder.path().join(picture));
    }
    let text = two_drawings("\"two.png\"");
    let at = |text: &str, time: SystemTime| {
        save(&manifest, text);
        let file = std::fs::File::options().write(true).open(&manifest);
        let file = file.expect("the manifest opens");
        file.set_modified(time).expect("its time is set");
    };
    let sound = SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000);
    let faulty = sound + Duration::from_secs(1);
    at(&text, sound);
    let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
    let mut reader = Reader::new(&exhibit);
    for _ in 0..2 {
        at(&text.replace("size_mm", "size_nm"), faulty);
        assert!(reader.read().is_err());
        assert!(reader.read().expect("it is told already").is_none());
        at(&text, sound);
        assert!(reader.read().expect("it is sound").is_none());
    }
}
