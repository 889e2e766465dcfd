//! The one material: its bindings, and one pipeline for each distinct need.

use bevy::{
    ecs::system::{SystemParamItem, lifetimeless::SRes},
    mesh::MeshVertexBufferLayoutRef,
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::{
        render_asset::RenderAssets,
        render_resource::{
            AsBindGroup, AsBindGroupError, BindGroupLayout, BindGroupLayoutEntry, BindingResources,
            BufferInitDescriptor, BufferUsages, Face, OwnedBindingResource,
            RenderPipelineDescriptor, SamplerBindingType, ShaderStages,
            SpecializedMeshPipelineError, TextureSampleType, TextureViewDimension,
            UnpreparedBindGroup,
            binding_types::{sampler, texture_2d, uniform_buffer},
            encase::UniformBuffer,
        },
        renderer::RenderDevice,
        texture::{FallbackImage, GpuImage},
    },
    shader::{ShaderDefVal, ShaderRef},
};

use super::uniform::PaperUniform;
use crate::{manifest::exhibit::MAX_OVERLAYS, needs::Terms, optics::tier::Tier};

/// The name of the number of sorts of particles in the shader.
pub const SORTS: &str = "SORTS";
/// The name in the vertex shader, and in it alone, that has the rasteriser spare what other members of
/// a comparison show.
pub const CLIPS: &str = "CLIPS";
/// Binding of the profiles of IES lamps.
const PROFILE_BINDING: u32 = 11;
/// Binding of the media of the other side.
const OTHER_MATTER_BINDING: u32 = 12;
/// Binding of the rows over roughness.
const ROW_BINDING: u32 = 13;
/// Binding of the other side as it was photographed.
const PHOTOGRAPHED_BINDING: u32 = 14;
/// Binding of the first overlay.
const OVERLAY_BINDING: u32 = 16;

/// Maps on the GPU; what a side does not need is `None` and absent from its shader.
#[derive(Clone, Debug, Default)]
pub struct PaperMaps {
    pub albedo: Option<Handle<Image>>,
    pub normal: Option<Handle<Image>>,
    pub roughness: Option<Handle<Image>>,
    /// Shares of film, body colour, and particles of slots 0 and 1.
    pub matter: Option<Handle<Image>>,
    /// Shares of particles of slots 2 to 5.
    pub matter_more: Option<Handle<Image>>,
    pub outline: Option<Handle<Image>>,
    /// Heights of the relief, for its shadows.
    pub height: Option<Handle<Image>>,
    pub transmission: Option<Handle<Image>>,
    /// Albedo of the other side, for light that comes through it or shows its ink.
    pub other: Option<Handle<Image>>,
    /// The same as it was when this side was photographed.
    pub photographed: Option<Handle<Image>>,
    pub overlays: Vec<Handle<Image>>,
    /// Shares of film, body colour and all particles of the other side.
    pub other_matter: Option<Handle<Image>>,
    /// Of IES lamps, see [`super::upload::profile_image`].
    pub profiles: Option<Handle<Image>>,
    /// What the interface does at each roughness, see [`super::rows`].
    pub rows: Option<Handle<Image>>,
}

/// One side of a sheet.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct PaperMaterial {
    pub paper: PaperUniform,
    pub terms: Terms,
    pub maps: PaperMaps,
    /// Drawn into a window: at the display's level, and with half an 8-bit step of noise
    /// against banding. Files stay exact.
    pub display: bool,
    /// Clipped by lines, which the device can: without, it shades what other members show and drops it.
    pub clips: bool,
}

/// What the pipeline is specialised for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PaperKey {
    terms: Terms,
    albedo_map: bool,
    display: bool,
    clips: bool,
    /// The part has a circle, which no line clips.
    round: bool,
}

impl PaperMaterial {
    /// Binding and image of every texture in the layout.
    fn textures(&self) -> impl Iterator<Item = (u32, Option<&Handle<Image>>)> {
        let maps = &self.maps;
        let fixed = [
            (2, &maps.albedo),
            (3, &maps.normal),
            (4, &maps.roughness),
            (5, &maps.outline),
            (6, &maps.height),
            (7, &maps.matter),
            (8, &maps.matter_more),
            (9, &maps.transmission),
            (10, &maps.other),
            (OTHER_MATTER_BINDING, &maps.other_matter),
            (PHOTOGRAPHED_BINDING, &maps.photographed),
        ];
        let overlays = (0..MAX_OVERLAYS).map(|i| maps.overlays.get(i));
        fixed
            .into_iter()
            .map(|(binding, map)| (binding, map.as_ref()))
            .chain((OVERLAY_BINDING..).zip(overlays))
    }
}

impl AsBindGroup for PaperMaterial {
    type Data = PaperKey;
    type Param = (SRes<RenderAssets<GpuImage>>, SRes<FallbackImage>);

    fn label() -> &'static str {
        "paper"
    }

    fn bind_group_data(&self) -> PaperKey {
        PaperKey {
            terms: self.terms,
            albedo_map: self.maps.albedo.is_some(),
            display: self.display,
            clips: self.clips,
            round: self.paper.cut_circle.w != 0.0,
        }
    }

    fn unprepared_bind_group(
        &self,
        _: &BindGroupLayout,
        device: &RenderDevice,
        (images, fallback): &mut SystemParamItem<'_, '_, Self::Param>,
        _: bool,
    ) -> Result<UnpreparedBindGroup, AsBindGroupError> {
        let mut uniform = UniformBuffer::new(Vec::new());
        if let Err(error) = uniform.write(&self.paper) {
            // The buffer is a Vec that grows; there is nothing to retry with.
            error!("the sheet's constants could not be written: {error}");
            return Err(AsBindGroupError::RetryNextUpdate);
        }
        let buffer = device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("paper"),
            contents: uniform.as_ref(),
            usage: BufferUsages::UNIFORM,
        });
        let mut map_sampler = &fallback.d2.sampler;
        let mut bindings = vec![(0, OwnedBindingResource::Buffer(buffer))];
        for (binding, handle) in self.textures() {
            let image = match handle {
                None => &fallback.d2,
                Some(handle) => {
                    let image = images
                        .get(handle)
                        .ok_or(AsBindGroupError::RetryNextUpdate)?;
                    map_sampler = &image.sampler;
                    image
                }
            };
            let view = image.texture_view.clone();
            bindings.push((
                binding,
                OwnedBindingResource::TextureView(TextureViewDimension::D2, view),
            ));
        }
        for (binding, handle) in [
            (PROFILE_BINDING, &self.maps.profiles),
            (ROW_BINDING, &self.maps.rows),
        ] {
            let image = match handle {
                None => &fallback.d2,
                Some(handle) => images
                    .get(handle)
                    .ok_or(AsBindGroupError::RetryNextUpdate)?,
            };
            let view = image.texture_view.clone();
            bindings.push((
                binding,
                OwnedBindingResource::TextureView(TextureViewDimension::D2, view),
            ));
        }
        let filtering = SamplerBindingType::Filtering;
        bindings.push((
            1,
            OwnedBindingResource::Sampler(filtering, map_sampler.clone()),
        ));
        Ok(UnpreparedBindGroup {
            bindings: BindingResources(bindings),
        })
    }

    fn bind_group_layout_entries(_: &RenderDevice, _: bool) -> Vec<BindGroupLayoutEntry> {
        let stages = ShaderStages::VERTEX_FRAGMENT;
        let map = texture_2d(TextureSampleType::Float { filterable: true });
        let mut entries = vec![
            uniform_buffer::<PaperUniform>(false).build(0, stages),
            sampler(SamplerBindingType::Filtering).build(1, ShaderStages::FRAGMENT),
        ];
        // Read texel by texel: 32-bit floats are not filtered everywhere.
        let table = texture_2d(TextureSampleType::Float { filterable: false });
        entries
            .extend([PROFILE_BINDING, ROW_BINDING].map(|i| table.build(i, ShaderStages::FRAGMENT)));
        let overlays = OVERLAY_BINDING..OVERLAY_BINDING + MAX_OVERLAYS as u32;
        entries.extend(
            (2..=10)
                .chain([OTHER_MATTER_BINDING, PHOTOGRAPHED_BINDING])
                .chain(overlays)
                .map(|i| map.build(i, ShaderStages::FRAGMENT)),
        );
        entries
    }
}

impl Material for PaperMaterial {
    fn vertex_shader() -> ShaderRef {
        "embedded://recto/paper_material.wgsl".into()
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://recto/paper_material.wgsl".into()
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let PaperKey {
            terms,
            albedo_map,
            display,
            clips,
            round,
        } = key.bind_group_data;
        let clips = clips && terms.cut;
        let defs: Vec<ShaderDefVal> = definitions(&terms, albedo_map, display)
            .into_iter()
            // What lines clip needs no fragment that drops it.
            .filter(|name| *name != "CUT" || !clips || round)
            .map(Into::into)
            .chain([ShaderDefVal::UInt(SORTS.into(), terms.sorts)])
            .collect();
        let mut attributes = vec![
            Mesh::ATTRIBUTE_POSITION.at_shader_location(0),
            Mesh::ATTRIBUTE_UV_0.at_shader_location(1),
        ];
        if terms.curved {
            attributes.push(Mesh::ATTRIBUTE_NORMAL.at_shader_location(2));
            attributes.push(Mesh::ATTRIBUTE_TANGENT.at_shader_location(3));
        }
        descriptor.vertex.buffers = vec![layout.0.get_layout(&attributes)?];
        descriptor.vertex.shader_defs.extend(defs.iter().cloned());
        if clips {
            descriptor.vertex.shader_defs.push(CLIPS.into());
        }
        if let Some(fragment) = &mut descriptor.fragment {
            fragment.shader_defs.extend(defs);
        }
        descriptor.primitive.cull_mode = Some(Face::Back);
        Ok(())
    }
}

/// The names that `paper_material.wgsl` is compiled with; `albedo_map`: the side has a picture;
/// `display`: it is drawn into a window.
pub fn definitions(terms: &Terms, albedo_map: bool, display: bool) -> Vec<&'static str> {
    [
        ("TIER_LAMBERT", terms.tier == Tier::Lambert),
        ("TIER_DRAFT", terms.tier == Tier::Draft),
        ("TIER_GALLERY", terms.tier == Tier::Gallery),
        ("TIER_STUDY", terms.tier == Tier::Study),
        ("COUPLED", terms.tier.is_coupled()),
        (
            "PATHS",
            terms.tier == Tier::Study || terms.tier.is_coupled() && terms.transmission,
        ),
        ("TRANSMISSION", terms.transmission),
        ("TRANSMISSION_MAP", terms.transmission_map),
        ("BEHIND", terms.transmission || terms.show_through),
        ("SHOW_THROUGH", terms.show_through),
        ("PHOTOGRAPHED", terms.photographed),
        ("OTHER_ALBEDO", terms.other_albedo),
        ("TIER_ISLE", terms.tier == Tier::Isle),
        ("TIER_PHONG", terms.tier == Tier::Phong),
        ("TIER_PHONG_PLAIN", terms.tier == Tier::PhongPlain),
        ("TIER_BLINN_PHONG", terms.tier == Tier::BlinnPhong),
        (
            "TIER_BLINN_PHONG_PLAIN",
            terms.tier == Tier::BlinnPhongPlain,
        ),
        ("TIER_COOK_TORRANCE", terms.tier == Tier::CookTorrance),
        (
            "TIER_COOK_TORRANCE_GAUSS",
            terms.tier == Tier::CookTorranceGauss,
        ),
        (
            "TIER_COOK_TORRANCE_BLINN",
            terms.tier == Tier::CookTorranceBlinn,
        ),
        ("TIER_OREN_NAYAR", terms.tier == Tier::OrenNayar),
        ("ALBEDO_MAP", albedo_map),
        ("CURVED", terms.curved),
        ("NORMAL_MAP", terms.normal_map),
        ("RELIEF_SHADOWS", terms.relief_shadows),
        ("ROUGHNESS_MAP", terms.roughness_map),
        ("OUTLINE", terms.outline),
        ("EDGE", terms.edge),
        ("SHARED_UV", terms.shared_uv),
        ("AMBIENT", terms.ambient),
        ("AREA_LAMPS", terms.area_lamps),
        ("DISTANT_LAMPS", terms.distant_lamps),
        ("IES", terms.ies),
        ("ONE_LAMP", terms.one_lamp),
        ("PARALLEL_EYE", terms.parallel_eye),
        ("OVERLAYS", terms.overlays > 0),
        ("MATTER", terms.matter > 0),
        ("MATTER_MORE", terms.matter > 1),
        ("OTHER_MATTER", terms.other_matter),
        ("PARTICLES", terms.sorts > 0),
        ("BODY", terms.body),
        ("MEDIA_INDEX", terms.media_index),
        ("GLOSS", terms.retro || terms.anisotropic),
        ("RETRO", terms.retro),
        ("ANISOTROPIC", terms.anisotropic),
        ("SHEEN", terms.sheen),
        ("CUT", terms.cut),
        ("DISPLAY", display),
    ]
    .into_iter()
    .filter(|(_, needed)| *needed)
    .map(|(name, _)| name)
    .collect()
}
