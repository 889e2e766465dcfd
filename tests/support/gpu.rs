//! Runs shader text in compute passes, compiled as Bevy compiles it.

use std::borrow::Cow;

use recto::device::NoDevice;

/// Threads in a workgroup.
const WORKGROUP: u32 = 64;

/// A device without a window.
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
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
        Self { device, queue }
    }

    /// Runs the entry point [`entry`] wrote for `cases` inputs; returns `outputs` numbers each.
    pub fn run(&self, text: &str, given: &[f32], cases: usize, outputs: usize) -> Vec<f32> {
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
        "@group(0) @binding(0) var<storage, read> given: array<{element}>;
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
