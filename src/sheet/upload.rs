//! Maps as textures.

use std::sync::Arc;

use bevy::{
    asset::RenderAssetUsages,
    image::{Image, ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

use crate::{
    maps::{Pyramid, Texels},
    optics::photometry::{COLUMNS, Photometry},
};

/// A map with its mip chain, filtered linearly; `anisotropy` 1 samples exactly as the
/// closed-form tests expect, 16 keeps tilted sheets sharp. Devices
/// without filtered 16-bit integers (`reads_unorm16`) get half floats.
pub fn map_image(pyramid: Pyramid, anisotropy: u16, reads_unorm16: bool) -> Image {
    let (width, height) = (pyramid.levels[0].width, pyramid.levels[0].height);
    let mut pyramid = pyramid;
    if !reads_unorm16 {
        for level in &mut pyramid.levels {
            let texels = std::mem::replace(&mut level.texels, Texels::Unorm8(Vec::new()));
            level.texels = texels.into_half();
        }
    }
    let format = format(&pyramid);
    let mip_level_count = pyramid.levels.len() as u32;
    let mut data = Vec::new();
    for level in pyramid.levels {
        level.texels.append_to(&mut data);
    }
    let mut image = texture(width, height, format);
    image.texture_descriptor.mip_level_count = mip_level_count;
    image.data = Some(data);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        label: Some("map".into()),
        address_mode_u: ImageAddressMode::ClampToEdge,
        address_mode_v: ImageAddressMode::ClampToEdge,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: anisotropy,
        ..ImageSamplerDescriptor::default()
    });
    image
}

/// The profiles of a scene's IES lamps, one under the other; `None` without such lamps.
pub fn profile_image(photometry: &[Arc<Photometry>]) -> Option<Image> {
    let rows: usize = photometry.iter().map(|lamp| lamp.rows()).sum();
    if rows == 0 {
        return None;
    }
    let mut image = texture(COLUMNS as u32, rows as u32, TextureFormat::R32Float);
    let texels = photometry.iter().flat_map(|lamp| lamp.baked());
    image.data = Some(
        texels
            .flat_map(|share| (share as f32).to_le_bytes())
            .collect(),
    );
    Some(image)
}

fn format(pyramid: &Pyramid) -> TextureFormat {
    match (&pyramid.levels[0].texels, pyramid.channels) {
        (Texels::Unorm8(_), 1) => TextureFormat::R8Unorm,
        (Texels::Unorm8(_), 2) => TextureFormat::Rg8Unorm,
        (Texels::Unorm8(_), _) => TextureFormat::Rgba8Unorm,
        (Texels::Unorm16(_), 1) => TextureFormat::R16Unorm,
        (Texels::Unorm16(_), 2) => TextureFormat::Rg16Unorm,
        (Texels::Unorm16(_), _) => TextureFormat::Rgba16Unorm,
        (Texels::Half(_), 1) => TextureFormat::R16Float,
        (Texels::Half(_), 2) => TextureFormat::Rg16Float,
        (Texels::Half(_), _) => TextureFormat::Rgba16Float,
    }
}

fn texture(width: u32, height: u32, format: TextureFormat) -> Image {
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    Image::new_uninit(
        size,
        TextureDimension::D2,
        format,
        RenderAssetUsages::RENDER_WORLD,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::Level;

    #[test]
    fn sixteen_bits_become_half_floats_where_they_must() {
        let pyramid = || Pyramid {
            channels: 1,
            levels: vec![Level {
                width: 2,
                height: 1,
                texels: Texels::Unorm16(vec![0, 65535]),
            }],
            missing: 0,
        };
        let exact = map_image(pyramid(), 1, true);
        assert_eq!(exact.texture_descriptor.format, TextureFormat::R16Unorm);
        assert_eq!(exact.data, Some(vec![0, 0, 255, 255]));
        let half = map_image(pyramid(), 1, false);
        assert_eq!(half.texture_descriptor.format, TextureFormat::R16Float);
        // 1.0 as a half float.
        assert_eq!(half.data, Some(vec![0, 0, 0x00, 0x3c]));
    }
}
