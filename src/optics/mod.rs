//! What paper and ink do with light, in f64: the truth that the shader is compared with.
//!
//! # Symbols
//! | symbol | meaning |
//! |---|---|
//! | `mu`, `mu_i`, `mu_o` | cosine of the angle to the normal; of the light, of the eye |
//! | `n`, `eta`, `k` | refractive index; index ratio inside/outside; extinction |
//! | `alpha` | GGX roughness, in (0, 1] |
//! | `f` | reflectance at an interface, or a BRDF in sr⁻¹ **without** the cosine |
//! | `e`, `t` | directional albedo of the interface; what it lets through |
//!
//! Directions point away from the surface, in the *local frame*: x right, y up on the side
//! that is looked at, z out of it. Functions with a twin in `shaders/paper_bsdf.wgsl` (or
//! `paper_baselines.wgsl`, `paper_media.wgsl`) carry the twin's name and order.

pub mod baselines;
pub mod bsdf;
pub mod fresnel;
pub mod ink;
pub mod lamp;
pub mod lamp_units;
mod late;
pub mod lobes;
pub mod matter;
pub mod medium;
pub mod microfacet;
pub mod photometry;
pub mod quadrature;
pub mod refraction;
pub mod relief;
pub mod shade;
pub mod show_through;
pub mod slab;
pub mod spectrum;
pub mod study;
pub mod table;
pub mod through;
pub mod tier;
