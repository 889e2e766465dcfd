//! The shipped physics on the graphics device without a picture: `recto bsdf --device gpu`.
//!
//! This compiles the same text as a frame does, but with the bounds checks that wgpu adds by
//! default: leaving them out as Bevy does is `unsafe`. The checks concern indices and loops,
//! and the physics between them is the same.

use std::borrow::Cow;

use glam::DVec3;

use crate::{
    device::{self, NoDevice},
    optics::{
        bsdf::{Pair, Sample, Specimen},
        tier::Tier,
    },
    sheet::{PAPER_BASELINES, PAPER_BSDF},
};

/// Threads in a workgroup.
const WORKGROUP: u32 = 64;
/// Pairs in one pass: 1024 workgroups, of the 65535 that every device takes.
const BATCH: usize = 1 << 16;
/// Numbers of a pair, and of its answer.
const PAIR: usize = 6;
const ANSWER: usize = 3;

/// Why the device gave no numbers.
#[derive(Debug, thiserror::Error)]
pub enum ComputeError {
    #[error(transparent)]
    NoDevice(#[from] NoDevice),
    #[error("the graphics device refuses: {0}")]
    Refused(#[from] wgpu::RequestDeviceError),
    #[error("the graphics device gives no numbers back: {0}")]
    Lost(String),
}

/// The shader's call for a tier; `None` for one that this version cannot evaluate.
fn call(tier: Tier) -> Option<&'static str> {
    Some(match tier {
        Tier::Draft => "brdf_draft(s, g)",
        Tier::Gallery => {
            "brdf_gallery(s, g, interface_at(row, g.mu_i), interface_at(row, g.mu_o), mean)"
        }
        Tier::Study => return None,
        Tier::Isle => "brdf_isle(s, g)",
        Tier::Lambert => "brdf_lambert(s)",
        Tier::Phong => "brdf_phong(s, off)",
        Tier::BlinnPhong => "brdf_blinn_phong(s, g)",
        Tier::CookTorrance => "brdf_cook_torrance(s, g)",
        Tier::OrenNayar => "brdf_oren_nayar(s, g)",
        Tier::PhongPlain => "brdf_phong_plain(s, g, off)",
        Tier::BlinnPhongPlain => "brdf_blinn_phong_plain(s, g)",
        Tier::CookTorranceGauss => "brdf_cook_torrance_gauss(s, g)",
        Tier::CookTorranceBlinn => "brdf_cook_torrance_blinn(s, g)",
    })
}

/// The physics with an entry point that evaluates `tier`. The specimen's constants come first in
/// `given`, then the pairs.
fn text(tier: Tier) -> Option<String> {
    let call = call(tier)?;
    Some(format!(
        "{PAPER_BSDF}\n{PAPER_BASELINES}
        struct Specimen {{ albedo: vec4<f32>, rest: vec4<f32>, table: InterfaceTable }}
        @group(0) @binding(0) var<storage, read> specimen: Specimen;
        @group(0) @binding(1) var<storage, read> given: array<f32>;
        @group(0) @binding(2) var<storage, read_write> found: array<f32>;
        @compute @workgroup_size({WORKGROUP})
        fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {{
            let at = id.x * {PAIR}u;
            let to = id.x * {ANSWER}u;
            if to >= arrayLength(&found) {{ return; }}
            let l = vec3(given[at], given[at + 1u], given[at + 2u]);
            let v = vec3(given[at + 3u], given[at + 4u], given[at + 5u]);
            let rest = specimen.rest;
            let s = Surface(specimen.albedo.xyz, rest.x, rest.y, rest.z, rest.w);
            let n = vec3(0.0, 0.0, 1.0);
            let g = facing(n, l, v);
            let off = off_mirror(n, l, v);
            let powers = vec4(1.0, 0.0, 0.0, 0.0);
            let row = interface_row(specimen.table, powers);
            let mean = interface_mean_at(specimen.table, powers);
            let f = {call};
            found[to] = f.x; found[to + 1u] = f.y; found[to + 2u] = f.z;
        }}"
    ))
}

fn words(specimen: &Specimen) -> Vec<f32> {
    let s = &specimen.surface;
    let table = &specimen.interface;
    let head = [
        [s.albedo.x, s.albedo.y, s.albedo.z, 0.0],
        [s.alpha, s.eta, s.f_normal, s.specular],
    ];
    head.iter()
        .chain(&table.t)
        .chain(&table.lost)
        .chain([&table.compensation, &table.t_mean, &table.capture])
        .flatten()
        .map(|x| *x as f32)
        .collect()
}

fn bytes(words: impl IntoIterator<Item = f32>) -> Vec<u8> {
    words.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// The BSDF of `tier` at `pairs`, as [`Specimen::at`] but in the shader; `None` for a tier that
/// this version cannot evaluate.
///
/// # Errors
/// [`ComputeError`] where there is no device, or it fails.
pub fn evaluate(
    specimen: &Specimen,
    tier: Tier,
    pairs: &[Pair],
) -> Result<Option<Vec<Sample>>, ComputeError> {
    let Some(text) = text(tier) else {
        return Ok(None);
    };
    let adapter = device::adapter()?;
    let request = adapter.request_device(&wgpu::DeviceDescriptor::default());
    let (device, queue) = bevy::tasks::block_on(request)?;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(Cow::Owned(text)),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("evaluate"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let mut samples = Vec::with_capacity(pairs.len());
    for batch in pairs.chunks(BATCH) {
        let found = run(&device, &queue, &pipeline, &words(specimen), batch)?;
        samples.extend(batch.iter().zip(found).map(|(pair, f)| Sample {
            f: if pair.is_transmitted() {
                DVec3::ZERO
            } else {
                f
            },
            ..Sample::default()
        }));
    }
    Ok(Some(samples))
}

fn run(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    pipeline: &wgpu::ComputePipeline,
    constants: &[f32],
    pairs: &[Pair],
) -> Result<Vec<DVec3>, ComputeError> {
    use wgpu::BufferUsages as Usage;
    let buffer = |words: usize, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (words * size_of::<f32>()) as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    let directions = pairs
        .iter()
        .flat_map(Pair::directions)
        .flat_map(|direction| direction.as_vec3().to_array());
    let of_specimen = buffer(constants.len(), Usage::STORAGE | Usage::COPY_DST);
    let input = buffer(pairs.len() * PAIR, Usage::STORAGE | Usage::COPY_DST);
    let output = buffer(pairs.len() * ANSWER, Usage::STORAGE | Usage::COPY_SRC);
    let copy = buffer(pairs.len() * ANSWER, Usage::MAP_READ | Usage::COPY_DST);
    queue.write_buffer(&of_specimen, 0, &bytes(constants.iter().copied()));
    queue.write_buffer(&input, 0, &bytes(directions));
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            entry(0, of_specimen.as_entire_binding()),
            entry(1, input.as_entire_binding()),
            entry(2, output.as_entire_binding()),
        ],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((pairs.len() as u32).div_ceil(WORKGROUP), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &copy, 0, output.size());
    queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    copy.slice(..)
        .map_async(wgpu::MapMode::Read, move |outcome| {
            // Nobody listens any more only where polling has failed, which is said below.
            drop(sender.send(outcome));
        });
    let lost = |error: &dyn std::error::Error| ComputeError::Lost(error.to_string());
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|error| lost(&error))?;
    receiver
        .recv()
        .map_err(|error| lost(&error))?
        .map_err(|error| lost(&error))?;
    let bytes = copy.slice(..).get_mapped_range();
    let words: Vec<f64> = bytes
        .chunks_exact(size_of::<f32>())
        .map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]]).into())
        .collect();
    Ok(words.chunks_exact(ANSWER).map(DVec3::from_slice).collect())
}
