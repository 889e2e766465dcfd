//! Composes the glue with the physics as Bevy does, without an app.

use std::sync::{Arc, LazyLock};

use bevy::{
    asset::{AssetId, uuid::Uuid},
    render::render_resource::WgpuFeatures,
    shader::{Shader, ShaderCache, ShaderCacheSource, ShaderDefVal},
};
use recto::sheet::{PAPER_BASELINES_MODULE, PAPER_BSDF, PAPER_MATERIAL, PAPER_MEDIA_MODULE};

const PHYSICS: AssetId<Shader> = AssetId::Uuid {
    uuid: Uuid::from_u128(1),
};
const GLUE: AssetId<Shader> = AssetId::Uuid {
    uuid: Uuid::from_u128(2),
};
const BASELINES: AssetId<Shader> = AssetId::Uuid {
    uuid: Uuid::from_u128(3),
};
const MEDIA: AssetId<Shader> = AssetId::Uuid {
    uuid: Uuid::from_u128(4),
};
/// The bind group that Bevy gives to materials.
const MATERIAL_BIND_GROUP: u32 = bevy::pbr::MATERIAL_BIND_GROUP_INDEX as u32;

/// The glue and what it imports.
pub struct Composer(ShaderCache<naga::Module, ()>);

impl Composer {
    /// With `more` WGSL behind the glue: entry points of a test.
    pub fn new(more: &str) -> Self {
        let keep = |(): &(), source: ShaderCacheSource<'_>, _: &_| match source {
            ShaderCacheSource::Naga(module) => Ok(module),
            ShaderCacheSource::SpirV(_) | ShaderCacheSource::Wgsl(_) => {
                unreachable!("WGSL comes out of the composer as a naga module")
            }
        };
        let everything = wgpu::DownlevelFlags::all();
        let mut cache = ShaderCache::new((), WgpuFeatures::empty(), everything, keep);
        let glue = format!("{PAPER_MATERIAL}\n{more}");
        for (id, text, name) in [
            (PHYSICS, PAPER_BSDF.to_owned(), "paper_bsdf"),
            (
                BASELINES,
                PAPER_BASELINES_MODULE.to_owned(),
                "paper_baselines",
            ),
            (MEDIA, PAPER_MEDIA_MODULE.to_owned(), "paper_media"),
            (GLUE, glue, "paper_material"),
        ] {
            let path = format!("embedded://recto/{name}.wgsl");
            cache.set_shader(id, Shader::from_wgsl(text, path));
        }
        Self(cache)
    }

    /// The module with these names defined.
    pub fn compose(&mut self, defined: &[&str]) -> Result<Arc<naga::Module>, String> {
        let group = ShaderDefVal::UInt("MATERIAL_BIND_GROUP".into(), MATERIAL_BIND_GROUP);
        let definitions: Vec<ShaderDefVal> = defined
            .iter()
            .map(|&name| name.into())
            .chain([group])
            .collect();
        self.0
            .get(0, GLUE, &definitions)
            .map_err(|error| format!("{defined:?}: {error}"))
    }
}

/// Every name that the glue asks for with `#ifdef`, sorted.
pub static DEFINITIONS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let mut names: Vec<&str> = PAPER_MATERIAL
        .lines()
        .filter_map(|line| line.trim().strip_prefix("#ifdef "))
        .map(str::trim)
        .collect();
    names.sort_unstable();
    names.dedup();
    names
});
