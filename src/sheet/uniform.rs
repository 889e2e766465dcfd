//! The only narrowing from f64 to f32: a side's constants, lamps and places as the shader
//! reads them. Names and order are those of `paper_material.wgsl` and `paper_bsdf.wgsl`.

mod media;

use bevy::render::render_resource::ShaderType;
use glam::{DAffine2, DMat4, DQuat, DVec2, DVec3, DVec4, Mat4, Vec2, Vec3, Vec4};

use crate::{
    manifest::{
        comparison::Part,
        exhibit::{HeightMap, MAX_LAMPS, MAX_OVERLAYS},
    },
    maps::Coding,
    optics::{
        ink::{FILM_TERMS, Film},
        lamp::{DISTANCE2_MIN_MM2, Light, Shape},
        quadrature::{GAUSS_LEGENDRE, GRIDS, disc_spoke, gauss_legendre},
        refraction::{PATH_TERMS, PathRow},
        study::Split,
        table::{InterfaceMean, InterfaceRow, LATE_TERMS, MU_TERMS},
        through::{TONE_TERMS, Through},
    },
};
pub use media::{MediaUniform, ParticleUniform};

/// Cosine below every cosine: a lamp without a beam shines fully everywhere.
const NO_BEAM: f32 = -2.0;

/// Twin of `Light`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct LightUniform {
    pub place: Vec3,
    pub near: f32,
    pub amount: Vec3,
    pub grid: u32,
    pub axis: Vec3,
    pub beam_scale: f32,
    pub half_edge_u: Vec3,
    pub cos_falloff: f32,
    pub half_edge_v: Vec3,
    pub distance_squared_min: f32,
    pub rings: u32,
    pub profile_row: u32,
    pub profile_rows: u32,
}

impl LightUniform {
    /// Narrows `light`. With `as_points`, a rectangle or disc becomes a point in its middle
    /// that shines like a Lambertian facet (the draft tier). An IES lamp's profile is found by
    /// [`PaperUniform::set_lights`].
    pub fn new(light: &Light, as_points: bool) -> Self {
        let amount = light.amount.as_vec3();
        let near = Self {
            near: 1.0,
            amount,
            // Any scale: the cosine is always at least 1 above NO_BEAM.
            beam_scale: 1.0,
            cos_falloff: NO_BEAM,
            distance_squared_min: DISTANCE2_MIN_MM2 as f32,
            ..Self::default()
        };
        match light.shape {
            Shape::Ies {
                position,
                axis,
                across_u,
                across_v,
                ref photometry,
            } => Self {
                place: position.as_vec3(),
                axis: axis.as_vec3(),
                half_edge_u: across_u.as_vec3(),
                half_edge_v: across_v.as_vec3(),
                profile_rows: photometry.rows() as u32,
                ..near
            },
            Shape::Distant { towards } => Self {
                place: towards.as_vec3(),
                near: 0.0,
                distance_squared_min: 1e-6,
                ..near
            },
            Shape::Point { position } => Self {
                place: position.as_vec3(),
                ..near
            },
            Shape::Spot {
                position,
                axis,
                cos_hotspot,
                cos_falloff,
            } => Self {
                place: position.as_vec3(),
                axis: axis.as_vec3(),
                beam_scale: (1.0 / (cos_hotspot - cos_falloff).max(1e-6)) as f32,
                cos_falloff: cos_falloff as f32,
                ..near
            },
            Shape::Rectangle { centre, axis, .. } | Shape::Disc { centre, axis, .. }
                if as_points =>
            {
                Self {
                    place: centre.as_vec3(),
                    axis: axis.as_vec3(),
                    cos_falloff: 0.0,
                    ..near
                }
            }
            Shape::Rectangle {
                centre,
                axis,
                half_u,
                half_v,
                grid,
            } => Self {
                place: centre.as_vec3(),
                axis: axis.as_vec3(),
                grid,
                half_edge_u: half_u.as_vec3(),
                half_edge_v: half_v.as_vec3(),
                ..near
            },
            Shape::Disc {
                centre,
                axis,
                half_u,
                half_v,
                rings,
            } => Self {
                place: centre.as_vec3(),
                axis: axis.as_vec3(),
                rings,
                half_edge_u: half_u.as_vec3(),
                half_edge_v: half_v.as_vec3(),
                ..near
            },
        }
    }
}

/// Twin of `MapPlace`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct MapPlace {
    pub row_u: Vec3,
    pub opacity: f32,
    pub row_v: Vec3,
    pub lit: f32,
}

impl MapPlace {
    /// From side frame (mm) → texture coordinates.
    pub fn new(uv_from_side: DAffine2) -> Self {
        let (m, t) = (uv_from_side.matrix2, uv_from_side.translation);
        Self {
            row_u: DVec3::new(m.x_axis.x, m.y_axis.x, t.x).as_vec3(),
            row_v: DVec3::new(m.x_axis.y, m.y_axis.y, t.y).as_vec3(),
            ..Self::default()
        }
    }

    /// The same place for an overlay.
    pub fn overlay(uv_from_side: DAffine2, opacity: f64, lit: bool) -> Self {
        Self {
            opacity: opacity as f32,
            lit: f32::from(u8::from(lit)),
            ..Self::new(uv_from_side)
        }
    }
}

/// Twin of `InterfaceMean`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct MeanUniform {
    pub compensation: f32,
    pub t_mean: f32,
    pub capture: f32,
    pub floor: f32,
}

impl MeanUniform {
    /// Narrows `mean`.
    pub fn new(mean: &InterfaceMean) -> Self {
        Self {
            compensation: mean.compensation as f32,
            t_mean: mean.t_mean as f32,
            capture: mean.capture as f32,
            floor: mean.floor as f32,
        }
    }
}

/// Twin of `InterfaceRow`, for storage buffers.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct RowUniform {
    pub t: [f32; MU_TERMS],
    pub late: [f32; LATE_TERMS],
}

impl RowUniform {
    /// Narrows `row`.
    pub fn new(row: &InterfaceRow) -> Self {
        Self {
            t: row.t.map(|c| c as f32),
            late: row.late.map(|c| c as f32),
        }
    }
}

/// Narrows a row of paths.
pub fn narrow_paths(row: &PathRow) -> [Vec4; PATH_TERMS] {
    row.map(|term| term.as_vec4())
}

/// Twin of `Film`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct FilmUniform {
    pub excess: [Vec4; FILM_TERMS],
    pub internal: [Vec4; FILM_TERMS],
    pub diffuse_path: Vec4,
}

impl FilmUniform {
    /// Narrows `film`.
    pub fn new(film: &Film) -> Self {
        let narrow = |c: DVec3| c.as_vec3().extend(0.0);
        Self {
            excess: film.excess.map(narrow),
            internal: film.internal.map(narrow),
            diffuse_path: film.diffuse_path.as_vec4(),
        }
    }
}

/// Twin of `Split`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct SplitUniform {
    pub kappa: Vec3,
    pub mean: f32,
    pub at_capture: Vec3,
    pub depth: f32,
    pub leaning: Vec3,
    pub inner_mean: f32,
    pub alike: f32,
    pub captured: f32,
    pub of_direction: Vec4,
    pub forward_share: f32,
    pub g_forward: f32,
    pub g_backward: f32,
}

impl SplitUniform {
    /// Narrows `split`.
    pub fn new(split: &Split) -> Self {
        Self {
            kappa: split.kappa.as_vec3(),
            mean: split.mean as f32,
            at_capture: split.at_capture.as_vec3(),
            depth: split.depth as f32,
            leaning: split.leaning.as_vec3(),
            inner_mean: split.inner_mean as f32,
            alike: split.alike as f32,
            captured: split.captured as f32,
            of_direction: split.of_direction.as_vec4(),
            forward_share: split.phase.forward_share as f32,
            g_forward: split.phase.g_forward as f32,
            g_backward: split.phase.g_backward as f32,
        }
    }
}

/// Twin of `Through`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct ThroughUniform {
    pub reflected: Vec3,
    pub inner_mean: f32,
    pub transmitted: Vec3,
    pub ballistic: Vec3,
    pub reflected_leaning: Vec3,
    pub transmitted_leaning: Vec3,
    pub straight_mean: Vec3,
    pub flat_share: Vec3,
    pub toned: [Vec3; TONE_TERMS],
    pub lightest: Vec3,
}

impl ThroughUniform {
    /// Narrows `through`.
    pub fn new(through: &Through) -> Self {
        Self {
            reflected: through.reflected.as_vec3(),
            inner_mean: through.inner_mean as f32,
            transmitted: through.transmitted.as_vec3(),
            ballistic: through.ballistic.as_vec3(),
            reflected_leaning: through.reflected_leaning.as_vec3(),
            transmitted_leaning: through.transmitted_leaning.as_vec3(),
            straight_mean: through.straight_mean.as_vec3(),
            flat_share: through.flat_share.as_vec3(),
            toned: through.toned.map(|c| c.as_vec3()),
            lightest: through.lightest.as_vec3(),
        }
    }
}

/// Twin of `Paper`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct PaperUniform {
    pub clip_from_local: Mat4,
    pub eye: Vec4,
    pub ambient: Vec3,
    pub lamp_count: u32,
    pub table: Vec3,
    pub alpha: f32,
    pub bare: Vec3,
    pub specular: f32,
    pub size: Vec2,
    pub eta: f32,
    pub f_normal: f32,
    pub normal_axes: Vec4,
    pub normal_offset: Vec2,
    pub sign_gain: f32,
    pub overlay_count: u32,
    pub albedo_place: MapPlace,
    pub normal_place: MapPlace,
    pub roughness_place: MapPlace,
    pub matter_place: MapPlace,
    pub media: MediaUniform,
    pub outline_place: MapPlace,
    pub level: Vec4,
    pub light_table: Vec3,
    pub normal_out: Vec4,
    pub lights: [LightUniform; MAX_LAMPS],
    pub overlays: [MapPlace; MAX_OVERLAYS],
    pub quadrature: [Vec4; GAUSS_LEGENDRE.len()],
    pub through: ThroughUniform,
    pub lit_bare: Vec3,
    pub f_capture: f32,
    pub other_bare: Vec3,
    pub clear_scale: f32,
    pub other_place: MapPlace,
    pub other_matter_place: MapPlace,
    pub photographed_place: MapPlace,
    pub photographed_bare: Vec3,
    pub transmission_place: MapPlace,
    pub height_place: MapPlace,
    pub height_range: Vec2,
    pub height_texel: f32,
    pub row_scale: f32,
    pub row_offset: f32,
    pub picture_aspect: f32,
    pub cut_circle: Vec4,
    pub cut_lines: [Vec4; 4],
}

impl PaperUniform {
    /// Says where the relief's heights lie, and how high they are.
    pub fn set_height(&mut self, map: &HeightMap) {
        let [low, high] = map.range_um;
        let size = DVec2::new(map.file.size[0].into(), map.file.size[1].into());
        self.height_place = MapPlace::new(map.file.uv_from_side);
        self.height_range = DVec2::new(low / 1000.0, (high - low) / 1000.0).as_vec2();
        self.height_texel = (map.file.extent_mm() / size).max_element() as f32;
    }

    /// Makes the relief of the maps that are set steeper by `times`: for the eye alone, what is
    /// widened by it stays.
    pub fn exaggerate(&mut self, times: f64) {
        self.normal_axes *= times as f32;
        self.normal_offset *= times as f32;
        self.height_range *= times as f32;
    }

    /// Sets eye and projection, given in the table frame, for a side whose local frame is
    /// `table_from_local`.
    pub fn set_eye(&mut self, clip_from_table: DMat4, eye: DVec4, table_from_local: DMat4) {
        self.clip_from_local = (clip_from_table * table_from_local).as_mat4();
        self.eye = (table_from_local.inverse() * eye).as_vec4();
    }

    /// Says what of a picture of `aspect` the side is seen in.
    pub fn set_part(&mut self, part: &Part, aspect: f64) {
        self.picture_aspect = aspect as f32;
        self.cut_circle = part.circle.as_vec4();
        self.cut_lines = part.lines.map(|line| line.as_vec3().extend(0.0));
    }

    /// Sets the lamps, given in the table frame.
    pub fn set_lights(
        &mut self,
        lights: &[Light],
        ambient: DVec3,
        local_from_table: DQuat,
        as_points: bool,
    ) {
        self.lamp_count = lights.len().min(MAX_LAMPS) as u32;
        for (slot, light) in self.lights.iter_mut().zip(lights) {
            *slot = LightUniform::new(&light.rotated(local_from_table), as_points);
        }
        // One profile under the other, as `profile_image` stacks them.
        let mut row = 0;
        for slot in &mut self.lights[..self.lamp_count as usize] {
            slot.profile_row = row;
            row += slot.profile_rows;
        }
        self.ambient = ambient.as_vec3();
        let points = GRIDS.flat_map(|points| (0..points).map(move |i| (points, i)));
        for (slot, (points, i)) in self.quadrature.iter_mut().zip(points) {
            let ([node, weight], [cos, sin]) = (gauss_legendre(points, i), disc_spoke(points, i));
            *slot = DVec4::new(node, weight, cos, sin).as_vec4();
        }
    }

    /// Sets the place of the normal map, and how its texels are coded.
    pub fn set_normal_place(&mut self, uv_from_side: DAffine2, coding: Coding) {
        self.normal_place = MapPlace::new(uv_from_side);
        // Directions on the side that the picture's x (right) and y (up) axes point to.
        let side_from_uv = uv_from_side.matrix2.inverse();
        let x = side_from_uv.x_axis.normalize();
        let y = -side_from_uv.y_axis.normalize();
        // The side frame counts y downwards, the local frame upwards.
        let (x, y) = (DVec2::new(x.x, -x.y), DVec2::new(y.x, -y.y));
        self.normal_axes = DVec4::new(x.x, x.y, y.x, y.y).as_vec4() * coding.scale as f32;
        self.normal_offset = ((x + y) * coding.offset).as_vec2();
        self.normal_out = DVec4::new(coding.scale, coding.offset, 0.0, 0.0).as_vec4();
    }
}
