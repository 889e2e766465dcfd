//! Runs shader text in compute passes, compiled as Bevy compiles it.

use std::{
    borrow::Cow,
    cell::{Cell, RefCell},
    sync::LazyLock,
};

use recto::{
    device::NoDevice,
    sheet::{PAPER_BASELINES, PAPER_BSDF, PAPER_MEDIA},
};

/// Where the mutation run (tests/mutation/run.py) lays a file of this name in place of a shader.
const MUTANTS: &str = "RECTO_MUTANTS";

/// The shipped text, or the mutant of it that is to be caught.
fn judged(name: &str, shipped: &'static str) -> Cow<'static, str> {
    let Some(folder) = std::env::var_os(MUTANTS) else {
        return shipped.into();
    };
    // One failure is enough.
    std::panic::set_hook(Box::new(|panic| {
        eprintln!("{panic}");
        std::process::exit(101);
    }));
    let path = std::path::Path::new(&folder).join(name);
    match std::fs::read_to_string(path) {
        Ok(text) => text.into(),
        Err(_) => shipped.into(),
    }
}

/// The text of paper_bsdf.wgsl.
pub fn bsdf() -> &'static str {
    static TEXT: LazyLock<Cow<str>> = LazyLock::new(|| judged("paper_bsdf.wgsl", PAPER_BSDF));
    &TEXT
}

/// The text of paper_media.wgsl.
pub fn media() -> &'static str {
    static TEXT: LazyLock<Cow<str>> = LazyLock::new(|| judged("paper_media.wgsl", PAPER_MEDIA));
    &TEXT
}

/// The text of paper_baselines.wgsl.
pub fn baselines() -> &'static str {
    static TEXT: LazyLock<Cow<str>> =
        LazyLock::new(|| judged("paper_baselines.wgsl", PAPER_BASELINES));
    &TEXT
}

/// How an entry point begins.
const ENTRY: &str = "@group(0) @binding(0)";
/// Threads in a workgroup.
const WORKGROUP: u32 = 64;

/// A device without a window.
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Of how many prepared inputs one is run.
    pub every: usize,
    /// Inputs so far.
    tuples: Cell<usize>,
    /// Entry points so far.
    asked: RefCell<String>,
}

impl Gpu {
    /// The device that Recto would take.
    ///
    /// # Panics
    /// With the line that installs a driver where there is none.
    pub fn new() -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::PRIMARY,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = pollster::block_on(instance.request_adapter(&Default::default()))
            .unwrap_or_else(|_| panic!("{NoDevice}"));
        let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))
            .unwrap_or_else(|error| panic!("{error}"));
        Self {
            device,
            queue,
            // What is wrong in one case in a few is wrong enough to be caught.
            every: if std::env::var_os(MUTANTS).is_some() {
                8
            } else {
                1
            },
            tuples: Cell::default(),
            asked: RefCell::default(),
        }
    }

    /// The same for a share of the inputs: enough to see what is plainly broken.
    pub fn sampling(every: usize) -> Self {
        Self {
            every,
            ..Self::new()
        }
    }

    /// How many inputs were run.
    pub fn tuples(&self) -> usize {
        self.tuples.get()
    }

    /// Whether an entry point called the function of this name itself.
    pub fn has_called(&self, function: &str) -> bool {
        let asked = self.asked.borrow();
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        asked.match_indices(function).any(|(at, _)| {
            let after = asked[at + function.len()..].trim_start();
            !asked[..at].ends_with(is_name) && after.starts_with('(')
        })
    }

    /// Runs the entry point [`entry`] wrote for `cases` inputs; returns `outputs` numbers each.
    pub fn run(&self, text: &str, given: &[f32], cases: usize, outputs: usize) -> Vec<f32> {
        self.tuples.set(self.tuples.get() + cases);
        if let Some(at) = text.find(ENTRY) {
            self.asked.borrow_mut().push_str(&text[at..]);
        }
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(text)),
        };
        // SAFETY: with checks off, indices must be in range and loops must end. The entry point
        // returns before it reads past `given`, and the shader has no loops. With checks on this
        // would be another program than the one that Bevy runs.
        let module = unsafe {
            self.device
                .create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        };
        let pipeline = self
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: None,
                layout: None,
                module: &module,
                entry_point: Some("parity"),
                compilation_options: Default::default(),
                cache: None,
            });
        let buffer = |words: usize, usage| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: (words * size_of::<f32>()) as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let input = buffer(given.len(), Usage::STORAGE | Usage::COPY_DST);
        let output = buffer(cases * outputs, Usage::STORAGE | Usage::COPY_SRC);
        let copy = buffer(cases * outputs, Usage::MAP_READ | Usage::COPY_DST);
        let bytes: Vec<u8> = given.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.queue.write_buffer(&input, 0, &bytes);
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let numbers = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, input.as_entire_binding()),
                entry(1, output.as_entire_binding()),
            ],
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &numbers, &[]);
            pass.dispatch_workgroups((cases as u32).div_ceil(WORKGROUP), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&output, 0, &copy, 0, output.size());
        self.queue.submit([encoder.finish()]);
        copy.slice(..)
            .map_async(wgpu::MapMode::Read, |outcome| outcome.expect("mapped"));
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("the device answers");
        let bytes = copy.slice(..).get_mapped_range();
        bytes
            .chunks_exact(size_of::<f32>())
            .map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect()
    }
}

/// An entry point that runs `body` once for each of `cases` inputs in `given`, an array of
/// `element`; `index` is the input's number, and `found[to + k]` takes output k of `outputs`.
pub fn entry(element: &str, cases: usize, outputs: usize, body: &str) -> String {
    format!(
        "{ENTRY} var<storage, read> given: array<{element}>;
        @group(0) @binding(1) var<storage, read_write> found: array<f32>;
        @compute @workgroup_size({WORKGROUP})
        fn parity(@builtin(global_invocation_id) id: vec3<u32>) {{
            let index = id.x;
            if index >= {cases}u {{ return; }}
            let to = index * {outputs}u;
            {body}
        }}"
    )
}
