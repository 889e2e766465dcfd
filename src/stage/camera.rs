//! The camera that every picture is taken with, on screen and in files.

use bevy::{
    core_pipeline::tonemapping::Tonemapping,
    light::cluster::{ClusterConfig, GlobalClusterSettings},
    prelude::*,
};

use super::TABLE;

/// Bevy's clustered lights are not used; without this they cost a pass a frame.
pub fn without_clusters(mut settings: ResMut<GlobalClusterSettings>) {
    settings.gpu_clustering = None;
}

/// The camera that draws the sheet. Its projection is not used: the sheet's shader has the
/// eye's own, in f64 until it is narrowed.
/// `order` is that among several cameras, the lowest first.
pub fn camera_bundle(order: isize) -> impl Bundle {
    (
        Camera3d::default(),
        Camera {
            order,
            clear_color: ClearColorConfig::Custom(Color::linear_rgb(TABLE, TABLE, TABLE)),
            ..default()
        },
        ClusterConfig::None,
        Tonemapping::None,
        Msaa::Off,
    )
}
