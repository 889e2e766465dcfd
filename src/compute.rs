//! The shipped physics on the graphics device without a picture: `recto bsdf --device gpu`.
//!
//! This compiles the same text as a frame does, but with the bounds checks that wgpu adds by
//! default: leaving them out as Bevy does is `unsafe`. The checks concern indices and loops,
//! and the physics between them is the same.

use std::borrow::Cow;

use bevy::render::render_resource::{ShaderType, encase::StorageBuffer};
use glam::{DVec3, Vec3, Vec4};

use crate::{
    device::{self, NoDevice},
    optics::{
        bsdf::{Pair, Sample, Specimen},
        refraction::PATH_TERMS,
        tier::Tier,
    },
    sheet::{
        PAPER_BASELINES, PAPER_BSDF, PAPER_MEDIA,
        uniform::{
            FilmUniform, MeanUniform, ParticleUniform, RowUniform, SplitUniform, ThroughUniform,
            narrow_paths,
        },
    },
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

/// The shader's call for a tier.
fn call(tier: Tier) -> &'static str {
    match tier {
        Tier::Draft => "brdf_draft(s, g)",
        Tier::Gallery => {
            "brdf_gallery(s, g, interface_at(specimen.row, g.mu_i), interface_at(specimen.row, g.mu_o), specimen.mean)"
        }
        Tier::Study => {
            "study(s, g, interface_at(specimen.row, g.mu_i), interface_at(specimen.row, g.mu_o), specimen.mean, v.z)"
        }
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
    }
}

/// The physics with an entry point that evaluates `tier`. The specimen's constants come first in
/// `given`, then the pairs.
fn text(tier: Tier) -> String {
    let call = call(tier);
    format!(
        "{PAPER_BSDF}\n{PAPER_BASELINES}\n{PAPER_MEDIA}
        struct Specimen {{
            albedo: vec3<f32>, alpha: f32, eta: f32, f_normal: f32, specular: f32, f_capture: f32,
            capture: vec4<f32>, paths: array<vec4<f32>, 7>, path_n: f32,
            mean: InterfaceMean, row: InterfaceRow, film: Film, split: Split, through: Through,
            bare: vec3<f32>, body_albedo: vec3<f32>, body_through: vec3<f32>,
            cover: Cover, particle: Particle,
        }}
        @group(0) @binding(0) var<storage, read> specimen: Specimen;
        @group(0) @binding(1) var<storage, read> given: array<f32>;
        @group(0) @binding(2) var<storage, read_write> found: array<f32>;
        fn path_towards(mu: f32) -> vec4<f32> {{
            return path_at(specimen.paths, mu, specimen.path_n);
        }}
        fn study(
            s: Surface, g: Facing, at_i: Interface, at_o: Interface, mean: InterfaceMean, v_z: f32,
        ) -> vec3<f32> {{
            let cover = specimen.cover;
            let shares = shares_of(s, mean, specimen.bare, specimen.body_albedo, cover);
            let share = uncovered_share(shares, specimen.bare);
            let depth = optical_depth(specimen.film, specimen.capture, share) * cover.film;
            if v_z < 0.0 {{
                let mu_o = max(-v_z, MU_MIN);
                let seen = Seen(
                    vec3(0.0), 1.0, depth, internal_reflectance(specimen.film, vec3(1.0)),
                    internal_reflectance(specimen.film, share),
                );
                return btdf_study(
                    specimen.through, seen, at_i, interface_at(specimen.row, mu_o), mean,
                    path_towards(g.mu_i), path_towards(mu_o), s.eta,
                ) * passing(cover, specimen.body_through, vec3(1.0));
            }}
            let particle = specimen.particle;
            let albedo = particle.albedo * shares.scale;
            let mirrored = particle_capture(particle, particle.alpha);
            let mirrors = particle_gloss(albedo, mirrored, shares.lit);
            let grains = max(albedo - mirrored * mirrors, vec3(0.0)) * INV_PI
                + particle_lobe(particle, particle.alpha, g) * mirrors;
            return brdf_study(
                s, g, at_i, at_o, mean, specimen.split, depth,
                Ways(specimen.capture, path_towards(g.mu_i), path_towards(g.mu_o)), shares.paper,
                shares.surface,
            ) + brdf_body(shares.body, at_i, at_o, mean) + grains * cover.particles;
        }}
        @compute @workgroup_size({WORKGROUP})
        fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {{
            let at = id.x * {PAIR}u;
            let to = id.x * {ANSWER}u;
            if to >= arrayLength(&found) {{ return; }}
            let l = vec3(given[at], given[at + 1u], given[at + 2u]);
            let v = vec3(given[at + 3u], given[at + 4u], given[at + 5u]);
            let s = Surface(
                specimen.albedo, specimen.alpha, specimen.eta, specimen.f_normal,
                specimen.specular, specimen.f_capture,
            );
            let n = vec3(0.0, 0.0, 1.0);
            let g = facing(n, l, v);
            let off = off_mirror(n, l, v);
            let f = {call};
            found[to] = f.x; found[to + 1u] = f.y; found[to + 2u] = f.z;
        }}"
    )
}

/// Twin of `Specimen` in [`text`].
#[derive(ShaderType)]
struct SpecimenUniform {
    albedo: Vec3,
    alpha: f32,
    eta: f32,
    f_normal: f32,
    specular: f32,
    f_capture: f32,
    capture: Vec4,
    paths: [Vec4; PATH_TERMS],
    path_n: f32,
    mean: MeanUniform,
    row: RowUniform,
    film: FilmUniform,
    split: SplitUniform,
    through: ThroughUniform,
    bare: Vec3,
    body_albedo: Vec3,
    body_through: Vec3,
    cover: CoverUniform,
    particle: ParticleUniform,
}

/// Twin of `Cover`.
#[derive(ShaderType)]
struct CoverUniform {
    film: f32,
    body: f32,
    particles: f32,
    grains: Vec3,
}

fn constants(specimen: &Specimen) -> Result<Vec<u8>, ComputeError> {
    let s = &specimen.surface;
    let cover = &specimen.cover;
    let uniform = SpecimenUniform {
        albedo: s.albedo.as_vec3(),
        alpha: s.alpha as f32,
        eta: s.eta as f32,
        f_normal: s.f_normal as f32,
        specular: s.specular as f32,
        f_capture: s.f_capture as f32,
        capture: specimen.capture().as_vec4(),
        paths: narrow_paths(&specimen.study.film.paths.row(s.alpha)),
        path_n: specimen.study.film.paths.n as f32,
        mean: MeanUniform::new(&specimen.interface.mean_at(s.alpha)),
        row: RowUniform::new(&specimen.interface.row(s.alpha)),
        film: FilmUniform::new(&specimen.study.film),
        split: SplitUniform::new(&specimen.study.split),
        through: ThroughUniform::new(&specimen.study.through),
        bare: specimen.study.bare.as_vec3(),
        body_albedo: specimen.body_albedo.as_vec3(),
        body_through: specimen.body_through.as_vec3(),
        cover: CoverUniform {
            film: cover.film as f32,
            body: cover.body as f32,
            particles: cover.particles as f32,
            grains: cover.grains.as_vec3(),
        },
        particle: ParticleUniform::new(&specimen.particle),
    };
    let mut buffer = StorageBuffer::new(Vec::new());
    buffer
        .write(&uniform)
        .map_err(|error| ComputeError::Lost(error.to_string()))?;
    Ok(buffer.into_inner())
}

fn bytes(words: impl IntoIterator<Item = f32>) -> Vec<u8> {
    words.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// The BSDF of `tier` at `pairs`, as [`Specimen::at`] but in the shader.
///
/// # Errors
/// [`ComputeError`] where there is no device, or it fails.
pub fn evaluate(
    specimen: &Specimen,
    tier: Tier,
    pairs: &[Pair],
) -> Result<Vec<Sample>, ComputeError> {
    let text = text(tier);
    let constants = constants(specimen)?;
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
        let found = run(&device, &queue, &pipeline, &constants, batch)?;
        samples.extend(batch.iter().zip(found).map(|(pair, f)| Sample {
            f: if pair.is_transmitted() && tier != Tier::Study {
                DVec3::ZERO
            } else {
                f
            },
            // One direction of the whole sphere: there is nothing to integrate on the device.
            ballistic: if tier == Tier::Study {
                specimen.ballistic(pair)
            } else {
                DVec3::ZERO
            },
            ..Sample::default()
        }));
    }
    Ok(samples)
}

fn run(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    pipeline: &wgpu::ComputePipeline,
    constants: &[u8],
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
    let of_specimen = buffer(
        constants.len() / size_of::<f32>(),
        Usage::STORAGE | Usage::COPY_DST,
    );
    let input = buffer(pairs.len() * PAIR, Usage::STORAGE | Usage::COPY_DST);
    let output = buffer(pairs.len() * ANSWER, Usage::STORAGE | Usage::COPY_SRC);
    let copy = buffer(pairs.len() * ANSWER, Usage::MAP_READ | Usage::COPY_DST);
    queue.write_buffer(&of_specimen, 0, constants);
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
