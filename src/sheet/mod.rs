//! The sheet in Bevy: its mesh, its material, and the one place where f64 becomes f32.

pub mod composite;
pub mod material;
pub mod mesh;
pub mod rows;
pub mod uniform;
pub mod upload;

use std::path::Path;

use bevy::{asset::io::embedded::EmbeddedAssetRegistry, prelude::*};

pub use material::{PaperMaps, PaperMaterial};

/// The physics, as the material imports it and the tests run it.
pub const PAPER_BSDF: &str = include_str!("../../shaders/paper_bsdf.wgsl");
/// The glue around it.
pub const PAPER_MATERIAL: &str = include_str!("../../shaders/paper_material.wgsl");

/// What a display needs beyond light.
pub const DISPLAY: &str = include_str!("../../shaders/display.wgsl");
/// One picture of several.
pub const COMPOSITE: &str = include_str!("../../shaders/composite.wgsl");

/// The baselines, which are read behind the physics.
pub const PAPER_BASELINES: &str = include_str!("../../shaders/paper_baselines.wgsl");
/// The same as a module of its own: plain WGSL has no imports.
pub const PAPER_BASELINES_MODULE: &str = concat!(
    "#import \"embedded://recto/paper_bsdf.wgsl\"::{INV_PI, MU_MIN, Facing, Surface, d_ggx, v_smith, \
     fresnel_schlick}\n",
    include_str!("../../shaders/paper_baselines.wgsl")
);

/// Media on the paper and optional lobes, which are read behind the physics.
pub const PAPER_MEDIA: &str = include_str!("../../shaders/paper_media.wgsl");
/// The same as a module of its own.
pub const PAPER_MEDIA_MODULE: &str = concat!(
    "#import \"embedded://recto/paper_bsdf.wgsl\"::{PI, INV_PI, ALPHA_MIN, LENGTH_MIN, \
     CAPTURE_SIN2_H, FRAC_1_SQRT_2, Facing, Interface, InterfaceMean, Surface, capture_floor, \
     d_ggx, d_ggx_anisotropic, fresnel_conductor, fresnel_dielectric, v_smith, \
     v_smith_anisotropic}\n",
    include_str!("../../shaders/paper_media.wgsl")
);

/// Registers the shaders, the sheet's material and that of the last pass.
pub struct SheetPlugin;

impl Plugin for SheetPlugin {
    fn build(&self, app: &mut App) {
        let registry = app.world_mut().resource_mut::<EmbeddedAssetRegistry>();
        for (path, text) in [
            ("recto/paper_bsdf.wgsl", PAPER_BSDF),
            ("recto/paper_baselines.wgsl", PAPER_BASELINES_MODULE),
            ("recto/paper_media.wgsl", PAPER_MEDIA_MODULE),
            ("recto/paper_material.wgsl", PAPER_MATERIAL),
            ("recto/display.wgsl", DISPLAY),
            ("recto/composite.wgsl", COMPOSITE),
        ] {
            registry.insert_asset(path.into(), Path::new(path), text.as_bytes());
        }
        app.add_plugins((
            MaterialPlugin::<PaperMaterial>::default(),
            MaterialPlugin::<composite::CompositeMaterial>::default(),
        ));
    }
}
