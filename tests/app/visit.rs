//! Somebody at the glass, with touches and time that the test decides.

use std::{path::Path, sync::Arc, time::Duration};

use bevy::{
    input::touch::{TouchInput, TouchPhase},
    prelude::*,
    time::TimeUpdateStrategy,
    window::{PrimaryWindow, WindowEvent, WindowResolution},
};
use recto::{
    manifest::exhibit::Exhibit,
    optics::tier::Tier,
    shot::{Darkroom, Picture},
    stage::{Arranged, Library, Shown, Waker, reload::ReloadPlugin},
    visitor::{
        Hand, Manners, VisitorPlugin, Waits,
        controls::{Control, Look, draw::Controls},
        hand::Picture as HandPicture,
    },
};

/// Of the window; its display has 96 pixels an inch.
pub const SIZE: [u32; 2] = [960, 640];
const FRAME: Duration = Duration::from_millis(16);

pub const WAITS: Waits = Waits {
    idle_s: 60.0,
    countdown_s: 10.0,
};

/// Somebody at the glass.
pub struct Session {
    room: Darkroom,
    window: Entity,
    folder: tempfile::TempDir,
}

impl Session {
    pub fn new(manners: Manners) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        super::write_exhibit(folder.path());
        Self::with(manners, folder)
    }

    /// Before the exhibit in `folder`.
    pub fn with(manners: Manners, folder: tempfile::TempDir) -> Self {
        let exhibit = folder.path().to_owned();
        Self::at(&exhibit, manners, folder, |_| {})
    }

    /// Before the exhibit that lies within `folder`, in a house that adds what it needs.
    pub fn at(
        exhibit: &Path,
        manners: Manners,
        folder: tempfile::TempDir,
        furnish: impl FnOnce(&mut App),
    ) -> Self {
        let (exhibit, _) = Exhibit::read(exhibit).unwrap_or_else(|faults| panic!("{faults}"));
        let exhibit = Arc::new(exhibit);
        let [width, height] = SIZE.map(f64::from);
        let picture = HandPicture {
            aspect: width / height,
            width_mm: width * 25.4 / 96.0,
            measured: false,
        };
        let hand = Hand::new(exhibit.clone(), 0, Tier::Draft, picture, manners.calm);
        let built = Darkroom::with(1, |app| {
            app.insert_resource(Waker(Arc::new(|| {})))
                .add_plugins((
                    ReloadPlugin { exhibit },
                    VisitorPlugin {
                        hand,
                        display_mm: None,
                        export: None,
                        manners,
                    },
                ))
                .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
            furnish(app);
        });
        let mut room = built.unwrap_or_else(|error| panic!("{error}"));
        let window = Window {
            resolution: WindowResolution::new(SIZE[0], SIZE[1]),
            ..default()
        };
        let window = room.world().spawn((window, PrimaryWindow)).id();
        let mut session = Self {
            room,
            window,
            folder,
        };
        session.settle();
        session
    }

    pub fn frame(&mut self) {
        self.room.frame().unwrap_or_else(|error| panic!("{error}"));
    }

    /// Frames until all that is wanted is there.
    pub fn settle(&mut self) {
        for _ in 0..6 {
            self.frame();
        }
        while !self.room.world().resource::<Arranged>().is_settled() {
            self.room.world().resource_mut::<Library>().wait();
            self.frame();
        }
    }

    /// Lets so much time pass.
    pub fn wait(&mut self, seconds: f64) {
        let mut left = seconds;
        while left > 0.0 {
            let step = left.min(0.25);
            self.pass(Duration::from_secs_f64(step));
            left -= step;
        }
    }

    /// One frame that comes so long after the one before.
    pub fn pass(&mut self, time: Duration) {
        *self.room.world().resource_mut::<TimeUpdateStrategy>() =
            TimeUpdateStrategy::ManualDuration(time);
        self.frame();
        *self.room.world().resource_mut::<TimeUpdateStrategy>() =
            TimeUpdateStrategy::ManualDuration(FRAME);
    }

    pub fn send(&mut self, event: WindowEvent) {
        self.room.world().write_message(event);
    }

    pub fn touch(&mut self, id: u64, phase: TouchPhase, at: Vec2) {
        let touch = TouchInput {
            phase,
            position: at,
            window: self.window,
            force: None,
            id,
        };
        self.send(WindowEvent::TouchInput(touch));
    }

    /// A finger goes from one place to another in some frames, and stays there.
    pub fn drag(&mut self, id: u64, from: Vec2, to: Vec2) {
        const STEPS: u32 = 8;
        self.touch(id, TouchPhase::Started, from);
        self.frame();
        for step in 1..=STEPS {
            let at = from.lerp(to, step as f32 / STEPS as f32);
            self.touch(id, TouchPhase::Moved, at);
            self.frame();
        }
    }

    pub fn lift(&mut self, id: u64, at: Vec2) {
        self.touch(id, TouchPhase::Ended, at);
        self.frame();
    }

    pub fn tap(&mut self, at: Vec2) {
        self.touch(77, TouchPhase::Started, at);
        self.frame();
        self.lift(77, at);
        self.frame();
    }

    /// Where a control is.
    pub fn find(&mut self, control: Control) -> Option<Rect> {
        let controls = self.room.world().resource::<Controls>();
        let mut widgets = controls.laid.widgets.iter();
        let is_it =
            |w: &&recto::visitor::controls::Widget| w.control == control && w.look != Look::Words;
        widgets.find(is_it).map(|widget| widget.rect)
    }

    pub fn press(&mut self, control: Control) {
        let rect = self.find(control);
        let rect = rect.unwrap_or_else(|| panic!("{control:?} is not there"));
        self.tap(rect.center());
    }

    /// The end of the program; what it wrote is left.
    pub fn close(self) -> tempfile::TempDir {
        self.folder
    }

    /// Where its files lie.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn world(&mut self) -> &mut World {
        self.room.world()
    }

    pub fn shown(&mut self) -> Shown {
        self.room.world().resource::<Shown>().clone()
    }

    pub fn resource<R: Resource + Clone>(&mut self) -> R {
        self.room.world().resource::<R>().clone()
    }

    /// How many entities, images and meshes it holds.
    pub fn holds(&mut self) -> [usize; 3] {
        let world = self.room.world();
        let entities = world.query::<Entity>().iter(world).count();
        [
            entities,
            world.resource::<Assets<Image>>().len(),
            world.resource::<Assets<Mesh>>().len(),
        ]
    }

    pub fn see(&mut self) -> Picture {
        self.room
            .see(SIZE)
            .unwrap_or_else(|error| panic!("{error}"))
    }

    pub fn camera_moves(&mut self) -> bool {
        let before = self.shown().scene.camera;
        self.frame();
        self.shown().scene.camera != before
    }
}

/// Memory of this process, in MiB; 0 where the system does not say.
pub fn resident_mib() -> f64 {
    const PAGE: f64 = 4096.0;
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split_whitespace().nth(1);
    let pages: f64 = pages.and_then(|pages| pages.parse().ok()).unwrap_or(0.0);
    pages * PAGE / f64::from(1 << 20)
}

/// Writes a picture with what lies over it, for eyes, where a test is asked to.
pub fn keep(picture: &Picture, name: &str) {
    if let Some(folder) = std::env::var_os("RECTO_KEEP_PICTURES") {
        let print = recto::develop::Print::develop(
            picture.width,
            picture.height,
            &picture.pixels,
            &picture.legend,
            1.0,
        );
        let pixels: Vec<[u8; 3]> = print.pixels.clone();
        let path = Path::new(&folder).join(name);
        recto::maps::encode::save_png_rgb8(&path, picture.width, picture.height, &pixels, None)
            .expect("the picture is written");
    }
}
