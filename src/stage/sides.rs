//! The sides of the sheet as entities.

use std::{f64::consts::FRAC_PI_8, sync::Arc};

use bevy::{
    camera::visibility::NoFrustumCulling,
    ecs::system::SystemParam,
    prelude::*,
    render::{render_resource::WgpuFeatures, renderer::RenderDevice},
};
use glam::{DMat4, DQuat, DVec3};

use super::{
    Library, Shared, Shown, TABLE, Waker,
    composite::{Retired, is_composite, layer_of},
    library::{Facts, Held, Request, is_lit},
};
use crate::{
    manifest::{
        exhibit::{BARE_PAPER, Drawing, SideName},
        eye::Eye,
        lighting::Lighting,
    },
    needs::{MapUse, Needs, SideNeeds},
    optics::{
        fresnel::{fresnel_dielectric, normal_reflectance},
        lobes::{albedo_under_sheen, alpha_towards, combed_capture, stretch},
        matter::Media,
        microfacet::ALPHA_MIN,
        photometry::Photometry,
        refraction::PathTable,
        study::Study,
        table::InterfaceTable,
        tier::{self, Tier, albedo_of},
    },
    sheet::{
        PaperMaps, PaperMaterial,
        mesh::SideSurface,
        rows::Rows,
        uniform::{MapPlace, MediaUniform, PaperUniform, ThroughUniform},
        upload::profile_image,
    },
};

/// What stands on the stage.
#[derive(Resource)]
pub struct Arranged {
    display: bool,
    /// Parts of a comparison are clipped, where the device can.
    clips: bool,
    /// Of each member of what is shown.
    needs: Option<Vec<(Needs, Request)>>,
    /// Whether they are drawn for a last pass.
    composite: bool,
    drawings: Vec<usize>,
    sides: Vec<ArrangedSide>,
    /// The photometric files of the IES lamps, and their texture.
    profiles: (Vec<Arc<Photometry>>, Option<Handle<Image>>),
    settled: bool,
    /// Something was built in this frame, which takes some frames to reach the picture.
    fresh: bool,
}

struct ArrangedSide {
    /// Index into what [`Shown::members`] gives.
    member: usize,
    name: SideName,
    entity: Entity,
    material: Handle<PaperMaterial>,
    needs: SideNeeds,
}

impl Arranged {
    pub(super) fn new(display: bool) -> Self {
        Self {
            display,
            clips: display,
            needs: None,
            composite: false,
            drawings: Vec::new(),
            sides: Vec::new(),
            profiles: (Vec::new(), None),
            settled: false,
            fresh: false,
        }
    }

    /// Whether something was built in this frame: it takes some frames to reach the picture.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// Whether the stage shows what [`Shown`] says, with all its maps.
    pub fn is_settled(&self) -> bool {
        self.settled
    }

    /// Spares what other members of a comparison show, or shades it and drops it. Clipped triangles are
    /// interpolated otherwise in the last bits: windows are to be fast, and files exact.
    pub fn clip(&mut self, clips: bool) {
        self.clips = clips;
        self.reset();
    }

    /// Whether pictures are drawn into a window.
    pub fn is_display(&self) -> bool {
        self.display
    }

    /// Asks for everything to be arranged anew: the exhibit was read again.
    pub fn reset(&mut self) {
        self.needs = None;
        self.settled = false;
    }
}

/// What the stage is made from.
#[derive(SystemParam)]
pub struct Supplies<'w> {
    library: ResMut<'w, Library>,
    device: Option<Res<'w, RenderDevice>>,
    waker: Option<Res<'w, Waker>>,
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<PaperMaterial>>,
    images: ResMut<'w, Assets<Image>>,
}

/// Brings the stage in line with [`Shown`]; until all its maps are there, the last picture
/// stays.
pub fn arrange(
    mut commands: Commands,
    shown: Res<Shown>,
    mut arranged: ResMut<Arranged>,
    supplies: Supplies,
) {
    let Supplies {
        mut library,
        device,
        waker,
        mut meshes,
        mut materials,
        mut images,
    } = supplies;
    if arranged.fresh {
        arranged.fresh = false;
    }
    if arranged.settled && !shown.is_changed() {
        return;
    }
    let clips = arranged.clips
        && device.is_some_and(|device| device.features().contains(WgpuFeatures::CLIP_DISTANCES));
    let members = shown.members();
    let wanted: Vec<(Needs, Request)> = members
        .iter()
        .map(|member| wanted(&shown, member))
        .collect();
    let composite = is_composite(&shown.scene);
    if arranged.needs.as_ref() != Some(&wanted) || arranged.composite != composite {
        arranged.settled = false;
        let requests: Vec<Request> = wanted
            .iter()
            .flat_map(|(needs, surface)| {
                let maps = needs.sides.iter().flat_map(|side| &side.maps);
                maps.cloned().map(Request::Map).chain([surface.clone()])
            })
            .collect();
        let Some(held) = library
            .bypass_change_detection()
            .take(&requests, waker.as_deref())
        else {
            // What is there follows the hand while the rest is on its way.
            let drawings: Vec<usize> = members.iter().map(|member| member.scene.drawing).collect();
            if arranged.drawings == drawings {
                for side in &arranged.sides {
                    let member = &members[side.member];
                    let seen_alike =
                        side.needs.terms.parallel_eye == member.scene.camera.distance_mm.is_none();
                    if seen_alike && let Some(mut material) = materials.get_mut(&side.material) {
                        aim(&mut material.paper, &shown, member, side.name);
                    }
                }
            }
            return;
        };
        library.bypass_change_detection().keep(&requests);
        // The last picture stays until there is another: a new sheet is drawn from its second frame on,
        // and a last pass that is only being built later still.
        let is_built = composite && !arranged.composite;
        let stays = if is_built {
            Retired::under_last_pass()
        } else {
            Retired::sheet()
        };
        for side in arranged.sides.drain(..) {
            commands.entity(side.entity).insert(stays);
        }
        arranged.fresh = true;
        let mut held = held.into_iter();
        for (k, (needs, _)) in wanted.iter().enumerate() {
            let drawing = &shown.exhibit.drawings[members[k].scene.drawing];
            let of_sides: Vec<Vec<(Handle<Image>, Facts)>> = needs
                .sides
                .iter()
                .map(|side| {
                    let maps = held.by_ref().take(side.maps.len());
                    maps.filter_map(Held::map).collect()
                })
                .collect();
            let Some(Held::Surface(surface)) = held.next() else {
                return;
            };
            for (side, maps) in needs.sides.iter().zip(of_sides) {
                let (images_of_side, facts): (Vec<Handle<Image>>, Vec<Facts>) =
                    maps.into_iter().unzip();
                let (paper, rows) = constants(drawing, side, &facts);
                let mut maps = bound(side, images_of_side);
                maps.rows = rows.map(|rows| images.add(rows.image()));
                let material = materials.add(PaperMaterial {
                    paper,
                    terms: side.terms,
                    maps,
                    display: arranged.display && !composite,
                    clips,
                });
                let mesh = meshes.add(side_surface(&surface, drawing, side.side).mesh());
                let entity = commands
                    .spawn((
                        Mesh3d(mesh),
                        MeshMaterial3d(material.clone()),
                        NoFrustumCulling,
                        layer_of(k, composite),
                    ))
                    .id();
                let (name, needs) = (side.side, side.clone());
                arranged.sides.push(ArrangedSide {
                    member: k,
                    name,
                    entity,
                    material,
                    needs,
                });
            }
        }
        arranged.needs = Some(wanted);
        arranged.composite = composite;
        arranged.drawings = members.iter().map(|member| member.scene.drawing).collect();
    }
    let lighting = shown.exhibit.lighting(&shown.scene);
    let photometry = lighting.photometry();
    // The exhibit shares what it has read: another file is another place in memory.
    let same = |(a, b): (&Arc<Photometry>, &Arc<Photometry>)| Arc::ptr_eq(a, b);
    let held = &arranged.profiles.0;
    if held.len() != photometry.len() || !held.iter().zip(&photometry).all(same) {
        let image = profile_image(&photometry).map(|image| images.add(image));
        arranged.profiles = (photometry, image);
    }
    for side in &arranged.sides {
        if let Some(mut material) = materials.get_mut(&side.material) {
            place(
                &mut material.paper,
                &shown,
                &members[side.member],
                side,
                &lighting,
            );
            material.maps.profiles.clone_from(&arranged.profiles.1);
        }
    }
    arranged.settled = true;
}

/// What a member requires.
fn wanted(shown: &Shown, member: &Shared) -> (Needs, Request) {
    let drawing = &shown.exhibit.drawings[member.scene.drawing];
    let mut needs = Needs::of(&shown.exhibit, &member.scene, shown.tier, shown.both_sides);
    for side in &mut needs.sides {
        side.terms.cut = member.part.is_cut();
    }
    (
        needs,
        Request::Surface(drawing.surface.clone(), drawing.size_mm),
    )
}

/// What does not change while the sheet and the lamps move.
fn constants(drawing: &Drawing, side: &SideNeeds, facts: &[Facts]) -> (PaperUniform, Option<Rows>) {
    let paper = &drawing.paper;
    let mut uniform = PaperUniform {
        table: Vec3::splat(TABLE),
        bare: DVec3::from_array(BARE_PAPER).as_vec3(),
        alpha: paper.roughness.max(ALPHA_MIN) as f32,
        specular: if side.terms.specular {
            paper.specular as f32
        } else {
            0.0
        },
        eta: paper.index as f32,
        f_normal: normal_reflectance(paper.index) as f32,
        size: drawing.size_mm.as_vec2(),
        ..PaperUniform::default()
    };
    let surface = |bare: [f64; 3]| {
        let specular = f64::from(uniform.specular);
        let bare = DVec3::from_array(bare);
        let sheen = if side.terms.sheen { paper.sheen } else { 0.0 };
        let mut surface = tier::Surface::new(
            albedo_under_sheen(sheen, bare),
            paper.roughness,
            paper.index,
            specular,
        );
        if side.terms.anisotropic {
            surface.f_capture *= combed_capture(surface.alpha, stretch(paper.anisotropy));
        }
        surface
    };
    // What bare paper shows on the side that is seen, and on the other, now and then.
    let mut bare = [BARE_PAPER; 3];
    for (map, facts) in side.maps.iter().zip(facts) {
        match map {
            MapUse::Albedo(_) => bare[0] = facts.bare,
            MapUse::OtherAlbedo(_) => bare[1] = facts.bare,
            MapUse::Photographed(_) => bare[2] = facts.bare,
            _ => {}
        }
    }
    let [seen, other, before] = bare.map(|of_picture| surface(paper.albedo.unwrap_or(of_picture)));
    // Per texel, what combs the gloss is known only there.
    uniform.f_capture = fresnel_dielectric(FRAC_PI_8.cos(), paper.index) as f32;
    uniform.lit_bare = seen.albedo.as_vec3();
    uniform.other_bare = other.albedo.as_vec3();
    let varies = side.terms.roughness_map || side.terms.normal_map;
    // What combed facets reflect all together is that of even ones a little rougher.
    let combed = if side.terms.anisotropic {
        stretch(paper.anisotropy)
    } else {
        1.0
    };
    let alpha = alpha_towards(paper.roughness, combed, DVec3::Z);
    let here = InterfaceTable::at_roughness(alpha, paper.index, paper.specular);
    let mean = here.mean_at(alpha);
    if side.terms.tier.is_coupled() {
        let lit = |of: &tier::Surface| albedo_of(of, &mean).max(DVec3::splat(1e-3)).as_vec3();
        (uniform.lit_bare, uniform.other_bare) = (lit(&seen), lit(&other));
        uniform.photographed_bare = lit(&before);
    }
    let mut films = None;
    if side.terms.tier == Tier::Study || side.terms.transmission {
        let eta = if side.terms.media_index {
            side.media.film_index(paper.index)
        } else {
            paper.index
        };
        let of_films = if varies {
            PathTable::new(eta)
        } else {
            Arc::new(PathTable::at_roughness(paper.roughness, eta))
        };
        let mut study = Study::new(&seen, &here, of_films, paper.slab());
        let media = Media::new(&side.media, &seen, &mean, &study);
        let on_other = Media::new(&side.other_media, &seen, &mean, &study);
        if side.terms.media_index {
            study = media.with_films(&seen, &mean, study);
        }
        uniform.through = ThroughUniform::new(&study.through);
        uniform.media = MediaUniform::new(&media, &on_other, paper, side.side);
        films = Some(study);
    }
    let rows = side.terms.tier.is_coupled().then(|| {
        if varies || side.terms.anisotropic {
            let table = InterfaceTable::new(paper.index, paper.specular);
            Rows::over_roughness(&table, films.as_ref())
        } else {
            Rows::at_roughness(&here, films.as_ref(), alpha)
        }
    });
    if let Some(rows) = &rows {
        [uniform.row_scale, uniform.row_offset] = rows.place().to_array();
    }
    // With shared coordinates, the vertex shader reads the albedo's place for every map.
    if let Some(first) = side.maps.first() {
        uniform.albedo_place = MapPlace::new(first.file().uv_from_side);
    }
    for (map, facts) in side.maps.iter().zip(facts) {
        let uv_from_side = map.file().uv_from_side;
        match map {
            MapUse::Albedo(_) | MapUse::Overlay(_) => {}
            MapUse::Normal(_) | MapUse::NormalFromHeight(..) => {
                uniform.set_normal_place(uv_from_side, facts.coding);
            }
            MapUse::Roughness(_) | MapUse::RoughnessOfMatter(..) => {
                uniform.roughness_place = MapPlace::new(uv_from_side);
            }
            MapUse::Matter(_) | MapUse::MatterMore(_) => {
                uniform.matter_place = MapPlace::new(uv_from_side);
            }
            MapUse::Outline(_) => uniform.outline_place = MapPlace::new(uv_from_side),
            MapUse::Height(height) => uniform.set_height(height),
            MapUse::OtherAlbedo(_) => uniform.other_place = MapPlace::new(uv_from_side),
            MapUse::Photographed(_) => uniform.photographed_place = MapPlace::new(uv_from_side),
            MapUse::OtherMatter(_) => uniform.other_matter_place = MapPlace::new(uv_from_side),
            MapUse::Transmission(_) => {
                uniform.transmission_place = MapPlace::new(uv_from_side);
                uniform.clear_scale = (1.0 / facts.mean.max(1e-3)) as f32;
            }
        }
    }
    uniform.exaggerate(side.exaggerate);
    (uniform, rows)
}

fn bound(side: &SideNeeds, images: Vec<Handle<Image>>) -> PaperMaps {
    let mut maps = PaperMaps::default();
    for (map, image) in side.maps.iter().zip(images) {
        match map {
            MapUse::Albedo(_) => maps.albedo = Some(image),
            MapUse::Normal(_) | MapUse::NormalFromHeight(..) => maps.normal = Some(image),
            MapUse::Roughness(_) | MapUse::RoughnessOfMatter(..) => maps.roughness = Some(image),
            MapUse::Matter(_) => maps.matter = Some(image),
            MapUse::MatterMore(_) => maps.matter_more = Some(image),
            MapUse::Outline(_) => maps.outline = Some(image),
            MapUse::Height(_) => maps.height = Some(image),
            MapUse::Transmission(_) => maps.transmission = Some(image),
            MapUse::OtherAlbedo(_) => maps.other = Some(image),
            MapUse::Photographed(_) => maps.photographed = Some(image),
            MapUse::OtherMatter(_) => maps.other_matter = Some(image),
            MapUse::Overlay(_) => maps.overlays.push(image),
        }
    }
    maps
}

fn side_surface(recto: &SideSurface, drawing: &Drawing, side: SideName) -> SideSurface {
    match side {
        SideName::Recto => recto.clone(),
        SideName::Verso => recto.other_side(drawing.size_mm, drawing.flip),
    }
}

/// Points the eye at a side as the sheet lies now; gives the side's turn, table from local.
fn aim(uniform: &mut PaperUniform, shown: &Shown, member: &Shared, side: SideName) -> DQuat {
    let Shared { scene, part, pose } = member;
    let drawing = &shown.exhibit.drawings[scene.drawing];
    let table_from_local = *pose * drawing.rest_pose(side).inverse();
    let aspect = part.aspect(shown.aspect);
    let eye = Eye::new(
        &scene.camera.fitted(drawing.size_mm, aspect),
        drawing.size_mm,
    );
    uniform.set_eye(
        part.clip_from_own() * eye.clip_from_table(aspect),
        eye.place(),
        DMat4::from_quat(table_from_local),
    );
    uniform.set_part(part, shown.aspect);
    table_from_local
}

/// Eye, lamps and overlays as they are now.
fn place(
    uniform: &mut PaperUniform,
    shown: &Shown,
    member: &Shared,
    side: &ArrangedSide,
    lighting: &Lighting,
) {
    let table_from_local = aim(uniform, shown, member, side.name);
    uniform.set_lights(
        &lighting.lights,
        lighting.ambient,
        table_from_local.inverse(),
        shown.tier == Tier::Draft,
    );
    uniform.light_table = lighting.light_table.as_vec3();
    let level = member.scene.exposure.level as f32;
    uniform.sign_gain = 1.0 / level;
    uniform.level = Vec4::splat(level);
    let overlays: Vec<MapPlace> = side
        .needs
        .maps
        .iter()
        .filter_map(|map| match map {
            MapUse::Overlay(overlay) => Some(overlay),
            _ => None,
        })
        .zip(
            member
                .scene
                .overlays
                .iter()
                .filter(|(_, opacity)| *opacity > 0.0),
        )
        .map(|(overlay, (_, opacity))| {
            MapPlace::overlay(overlay.file.uv_from_side, *opacity, is_lit(&overlay.kind))
        })
        .collect();
    uniform.overlay_count = overlays.len() as u32;
    for (slot, overlay) in uniform.overlays.iter_mut().zip(overlays) {
        *slot = overlay;
    }
}
