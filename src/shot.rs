//! Pictures without a window: the stage rendered into a float image and read back.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use bevy::{
    app::{AppLabel, PluginsState, SubApps},
    asset::RenderAssetUsages,
    camera::RenderTarget,
    core_pipeline::tonemapping::Tonemapping,
    prelude::*,
    render::{
        RenderApp, RenderPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_resource::{
            CachedPipelineState, Extent3d, PipelineCache, PollType, TextureDimension,
            TextureFormat, TextureUsages,
        },
        renderer::RenderDevice,
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
    shader::ShaderCacheError,
    window::ExitCondition,
    winit::WinitPlugin,
};

use crate::{
    colour,
    device::{self, NoDevice},
    manifest::exhibit::{CompareMode, Comparison, Member, Scene},
    maps::MapError,
    stage::{
        Arranged, Library, Shown, StagePlugin,
        camera::{camera_bundle, without_clusters},
        composite::{PictureCamera, PictureSize},
        legend::TextCamera,
    },
};

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum ShotError {
    #[error(transparent)]
    NoDevice(#[from] NoDevice),
    /// Maps that cannot be decoded, with their paths.
    #[error("{}", lines(.0))]
    Maps(Vec<(PathBuf, MapError)>),
    /// A fault of Recto's own shaders or of the driver.
    #[error("the graphics device refused: {0}")]
    Device(String),
}

fn lines(faults: &[(PathBuf, MapError)]) -> String {
    let lines: Vec<String> = faults.iter().map(|(_, error)| error.to_string()).collect();
    lines.join("\n")
}

/// A rendered picture.
#[derive(Clone, Debug)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    /// Linear sRGB relative to a perfect diffuser, rows from the top.
    pub pixels: Vec<[f32; 3]>,
    /// Legend to lay over it: premultiplied linear RGBA, empty where there is none.
    pub legend: Vec<[f32; 4]>,
}

/// How long a picture may take to come back from the device: a large one is a gigabyte.
const PATIENCE: Duration = Duration::from_secs(120);
/// Frames between settling and capture: maps reach the GPU in the first, materials in the
/// second.
const SETTLING_FRAMES: u32 = 3;

/// An app without a window that takes one picture after another.
pub struct Darkroom {
    apps: SubApps,
    camera: Entity,
    size: UVec2,
    target: Handle<Image>,
    text_camera: Entity,
    text_target: Handle<Image>,
}

impl Darkroom {
    /// Starts the renderer.
    ///
    /// # Errors
    /// [`ShotError::NoDevice`] without a graphics driver.
    pub fn new(anisotropy: u16) -> Result<Self, ShotError> {
        Self::with(anisotropy, |_| {})
    }

    /// The same with more plugins, which benchmarks need.
    ///
    /// # Errors
    /// [`ShotError::NoDevice`] without a graphics driver.
    pub fn with(anisotropy: u16, add: impl FnOnce(&mut App)) -> Result<Self, ShotError> {
        device::probe()?;
        let mut app = App::new();
        app.add_plugins(
            DefaultPlugins
                .set(WindowPlugin {
                    primary_window: None,
                    exit_condition: ExitCondition::DontExit,
                    ..default()
                })
                .set(RenderPlugin {
                    render_creation: device::render_creation(),
                    synchronous_pipeline_compilation: true,
                    ..default()
                })
                .disable::<WinitPlugin>()
                .disable::<PipelinedRenderingPlugin>()
                .disable::<bevy::log::LogPlugin>(),
        )
        .add_plugins(StagePlugin {
            display: false,
            anisotropy,
        })
        .add_systems(Startup, without_clusters);
        add(&mut app);
        while app.plugins_state() == PluginsState::Adding {
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        app.finish();
        app.cleanup();
        let mut apps = std::mem::take(app.sub_apps_mut());
        let world = apps.main.world_mut();
        let size = UVec2::ONE;
        let (target, text_target) = (
            add_target(world, size, PICTURE),
            add_target(world, size, TEXT),
        );
        world.insert_resource(PictureSize(size));
        let camera = (PictureCamera, camera_bundle(0), target_of(&target));
        let camera = world.spawn(camera).id();
        let text_camera = world
            .spawn((
                Camera2d,
                Camera {
                    order: 1,
                    clear_color: ClearColorConfig::Custom(Color::NONE),
                    is_active: false,
                    ..default()
                },
                target_of(&text_target),
                TextCamera {
                    height: 1.0,
                    width: f32::INFINITY,
                    foot: 0.0,
                },
                Msaa::Off,
                Tonemapping::None,
            ))
            .id();
        Ok(Self {
            apps,
            camera,
            size,
            target,
            text_camera,
            text_target,
        })
    }

    /// The main world, for benchmarks and tests.
    pub fn world(&mut self) -> &mut World {
        self.apps.main.world_mut()
    }

    /// Runs one frame to its end.
    ///
    /// # Errors
    /// [`ShotError::Device`] when the device is lost.
    pub fn frame(&mut self) -> Result<(), ShotError> {
        self.apps.update();
        let device = self.apps.main.world().resource::<RenderDevice>();
        device
            .wgpu_device()
            .poll(PollType::Wait {
                submission_index: None,
                timeout: None,
            })
            .map(|_| ())
            .map_err(|error| ShotError::Device(error.to_string()))
    }

    /// Arranges `shown` and waits until everything it needs is on the GPU; the next frame is
    /// the picture.
    ///
    /// # Errors
    /// [`ShotError::Maps`] with every map that cannot be decoded, or [`ShotError::Device`].
    pub fn arrange(&mut self, shown: Shown, size: [u32; 2]) -> Result<(), ShotError> {
        // Maps and pipelines are made ready on a picture of one pixel, which costs no time.
        self.look(UVec2::ONE);
        self.activate(true, has_legend(&shown.scene));
        self.world().insert_resource(shown);
        loop {
            self.frame()?;
            let world = self.apps.main.world_mut();
            let settled = world.resource::<Arranged>().is_settled();
            let mut library = world.resource_mut::<Library>();
            if !library.faults.is_empty() && !library.is_busy() {
                let faults = std::mem::take(&mut library.faults);
                library.clear();
                return Err(ShotError::Maps(faults));
            }
            if settled {
                break;
            }
            library.wait();
        }
        for _ in 0..SETTLING_FRAMES {
            self.frame()?;
        }
        self.finish_pipelines()?;
        self.look(UVec2::from_array(size));
        // The legend is laid out for the new height, and a new target's first frame is empty.
        self.world().resource_mut::<Shown>().set_changed();
        self.frame()
    }

    /// One picture of `shown`, with a legend if overlays lie on it, colours stand for
    /// differences, or it is enhanced.
    ///
    /// # Errors
    /// As [`Darkroom::arrange`].
    pub fn take(&mut self, shown: Shown, size: [u32; 2]) -> Result<Picture, ShotError> {
        let has_legend = has_legend(&shown.scene);
        self.arrange(shown, size)?;
        self.capture(has_legend)
    }

    /// What the room shows of itself, where somebody in it steers, with all its texts and controls: as
    /// it is in the next frames, when everything for it is on the GPU.
    ///
    /// # Errors
    /// As [`Darkroom::arrange`].
    pub fn see(&mut self, size: [u32; 2]) -> Result<Picture, ShotError> {
        self.look(UVec2::from_array(size));
        self.activate(true, true);
        for _ in 0..SETTLING_FRAMES {
            self.frame()?;
        }
        while !self.world().resource::<Arranged>().is_settled() {
            self.world().resource_mut::<Library>().wait();
            self.frame()?;
        }
        self.finish_pipelines()?;
        let picture = self.capture(true);
        self.look(UVec2::ONE);
        self.activate(true, true);
        picture
    }

    /// The picture of the frame that comes next.
    fn capture(&mut self, has_legend: bool) -> Result<Picture, ShotError> {
        let wanted = [Some(&self.target), has_legend.then_some(&self.text_target)];
        let targets: Vec<Handle<Image>> = wanted.into_iter().flatten().cloned().collect();
        let taken: Vec<Taken> = targets
            .into_iter()
            .map(|target| self.expose(target))
            .collect();
        self.frame()?;
        // While the bytes come back nothing needs to be drawn again.
        self.activate(false, false);
        let mut bytes = self.develop(&taken)?.into_iter();
        let (bytes, text) = (
            bytes.next().unwrap_or_default(),
            bytes.next().unwrap_or_default(),
        );
        let pixels = bytes
            .chunks_exact(16)
            .map(|texel| {
                std::array::from_fn(|c| {
                    let at = 4 * c;
                    f32::from_le_bytes([texel[at], texel[at + 1], texel[at + 2], texel[at + 3]])
                })
            })
            .collect();
        let linear = |byte: u8| colour::srgb_decode(f64::from(byte) / 255.0);
        let legend = text
            .chunks_exact(4)
            .map(|texel| {
                let [r, g, b] = [texel[0], texel[1], texel[2]].map(|c| linear(c) as f32);
                [r, g, b, f32::from(texel[3]) / 255.0]
            })
            .collect();
        Ok(Picture {
            width: self.size.x,
            height: self.size.y,
            pixels,
            legend,
        })
    }

    /// Points the cameras at pictures of `size`.
    fn look(&mut self, size: UVec2) {
        if size == self.size {
            return;
        }
        self.size = size;
        let world = self.apps.main.world_mut();
        world.insert_resource(PictureSize(size));
        self.target = add_target(world, size, PICTURE);
        self.text_target = add_target(world, size, TEXT);
        world
            .entity_mut(self.camera)
            .insert(target_of(&self.target));
        world.entity_mut(self.text_camera).insert((
            target_of(&self.text_target),
            TextCamera {
                height: size.y as f32,
                width: f32::INFINITY,
                foot: 0.0,
            },
        ));
    }

    fn activate(&mut self, picture: bool, text: bool) {
        for (entity, active) in [(self.camera, picture), (self.text_camera, text)] {
            if let Some(mut camera) = self.world().get_mut::<Camera>(entity) {
                camera.is_active = active;
            }
        }
    }

    /// Asks for what the next frame draws into `target`.
    fn expose(&mut self, target: Handle<Image>) -> Taken {
        let taken = Taken::default();
        let slot = taken.clone();
        self.world().spawn(Screenshot::image(target)).observe(
            move |event: On<ScreenshotCaptured>| {
                if let Ok(mut slot) = slot.lock() {
                    *slot = event.image.data.clone();
                }
            },
        );
        taken
    }

    /// Waits for the bytes of all that was taken.
    fn develop(&mut self, taken: &[Taken]) -> Result<Vec<Vec<u8>>, ShotError> {
        let mut bytes = vec![None; taken.len()];
        let asked = Instant::now();
        while asked.elapsed() < PATIENCE {
            self.frame()?;
            for (bytes, taken) in bytes.iter_mut().zip(taken) {
                if let Some(arrived) = taken.lock().ok().and_then(|mut slot| slot.take()) {
                    *bytes = Some(arrived);
                }
            }
            if bytes.iter().all(Option::is_some) {
                return Ok(bytes.into_iter().flatten().collect());
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Err(ShotError::Device(
            "the picture did not come back from the device".into(),
        ))
    }

    /// Runs frames until every pipeline that was asked for is there: on a busy machine shaders are read for
    /// longer than maps are, and one that is missing draws nothing and says so only here.
    ///
    /// # Errors
    /// [`ShotError::Device`] with a pipeline that cannot be made, or whose shader is not read in time.
    pub fn finish_pipelines(&mut self) -> Result<(), ShotError> {
        let begun = Instant::now();
        loop {
            let Some(render) = self.apps.sub_apps.get(&RenderApp.intern()) else {
                return Err(ShotError::Device("there is no renderer".into()));
            };
            let mut waits = false;
            for pipeline in render.world().resource::<PipelineCache>().pipelines() {
                let CachedPipelineState::Err(error) = &pipeline.state else {
                    continue;
                };
                if !is_on_its_way(error) || begun.elapsed() > PATIENCE {
                    return Err(ShotError::Device(error.to_string()));
                }
                waits = true;
            }
            if !waits {
                return Ok(());
            }
            self.frame()?;
        }
    }
}

/// Whether a shader, or one that it imports, is still being read.
fn is_on_its_way(error: &ShaderCacheError) -> bool {
    matches!(
        error,
        ShaderCacheError::ShaderNotLoaded(_) | ShaderCacheError::ShaderImportNotYetAvailable
    )
}

fn has_legend(scene: &Scene) -> bool {
    let is_overlay = |member: &Member| matches!(member, Member::Overlay(_));
    let is_coded = |comparison: &Comparison| {
        comparison.mode == CompareMode::Difference || comparison.of.iter().any(is_overlay)
    };
    !scene.enhance.marks().is_empty()
        || scene.overlays.iter().any(|(_, opacity)| *opacity > 0.0)
        || scene.compare.as_ref().is_some_and(is_coded)
}

/// Where the device leaves a captured picture.
type Taken = Arc<Mutex<Option<Vec<u8>>>>;

const PICTURE: TextureFormat = TextureFormat::Rgba32Float;
const TEXT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

fn target_of(image: &Handle<Image>) -> RenderTarget {
    RenderTarget::Image(image.clone().into())
}

fn add_target(world: &mut World, size: UVec2, format: TextureFormat) -> Handle<Image> {
    let extent = Extent3d {
        width: size.x,
        height: size.y,
        depth_or_array_layers: 1,
    };
    let mut image = Image::new_uninit(
        extent,
        TextureDimension::D2,
        format,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.usage |= TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
    world.resource_mut::<Assets<Image>>().add(image)
}
