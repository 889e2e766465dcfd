//! Whether there is a graphics device, found out before Bevy would panic for want of one.

use bevy::render::settings::{Backends, RenderCreation, WgpuSettings};

/// No driver for any graphics interface that Recto can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no graphics device: no Vulkan driver answers (nor Metal, nor Direct3D 12). On Debian or \
     Ubuntu this installs a software driver: sudo apt-get install mesa-vulkan-drivers"
)]
pub struct NoDevice;

/// OpenGL is left out: it lacks the filtered 16-bit and float formats of the maps.
const BACKENDS: Backends = Backends::PRIMARY;

/// Asks for an adapter as Bevy will.
///
/// # Errors
/// [`NoDevice`] if there is none.
pub fn probe() -> Result<(), NoDevice> {
    adapter().map(drop)
}

/// The adapter that Bevy will take.
///
/// # Errors
/// [`NoDevice`] if there is none.
pub fn adapter() -> Result<wgpu::Adapter, NoDevice> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: BACKENDS,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let options = wgpu::RequestAdapterOptions::default();
    bevy::tasks::block_on(instance.request_adapter(&options)).map_err(|_| NoDevice)
}

/// How Bevy is to create its renderer.
pub fn render_creation() -> RenderCreation {
    WgpuSettings {
        backends: Some(BACKENDS),
        ..WgpuSettings::default()
    }
    .into()
}
