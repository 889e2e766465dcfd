//! The maps that were asked for, decoded in the background, once each.

use std::{
    fmt,
    panic::{self, AssertUnwindSafe},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, mpsc},
};

use bevy::{
    prelude::*,
    render::{renderer::RenderDevice, settings::WgpuFeatures},
};
use glam::{DAffine2, DVec2};

use crate::{
    manifest::exhibit::{OverlayKind, Surface},
    maps::{self, Coding, MapError, normal_coding},
    needs::MapUse,
    sheet::{mesh::SideSurface, upload},
};

/// Called from the loader's threads when something arrived: a sleeping window must wake up.
#[derive(Resource, Clone)]
pub struct Waker(pub Arc<dyn Fn() + Send + Sync>);

impl fmt::Debug for Waker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Waker")
    }
}

/// What is asked of the library.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    Map(MapUse),
    /// The macroscopic shape of a sheet of this size.
    Surface(Surface, DVec2),
}

impl Request {
    /// The same pixels wherever they lie on the sheet.
    fn key(mut self) -> Self {
        if let Self::Map(map) = &mut self {
            map.file_mut().uv_from_side = DAffine2::IDENTITY;
            if let MapUse::OtherAlbedo(colour) | MapUse::Photographed(colour) = map {
                *map = MapUse::Albedo(colour.clone());
            }
        }
        self
    }
}

impl Request {
    /// The file behind it; empty for a flat sheet, which has none.
    fn path(&self) -> PathBuf {
        match self {
            Self::Map(map) => map.file().path.clone(),
            Self::Surface(Surface::Height(map), _) => map.file.path.clone(),
            Self::Surface(Surface::Gltf(path), _) => path.clone(),
            Self::Surface(Surface::Flat, _) => PathBuf::new(),
        }
    }
}

enum Decoded {
    Map(Box<Image>, Facts),
    Surface(SideSurface),
}

/// What became known of a map while it was decoded.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Applies if its values are normals.
    pub coding: Coding,
    /// Of a picture of the sheet: what its bare paper shows, linear sRGB.
    pub bare: [f64; 3],
    /// Mean of its first channel.
    pub mean: f64,
}

/// What the library holds.
#[derive(Clone, Debug)]
pub enum Held {
    Map(Handle<Image>, Facts),
    Surface(Arc<SideSurface>),
}

impl Held {
    /// A map, if it is one.
    pub fn map(self) -> Option<(Handle<Image>, Facts)> {
        match self {
            Self::Map(image, facts) => Some((image, facts)),
            Self::Surface(_) => None,
        }
    }
}

enum Entry {
    Decoding,
    Ready(Held),
    Faulty,
}

type Arrival = (u64, Request, Result<Decoded, MapError>);

/// Everything loaded, by what it was loaded for.
#[derive(Resource)]
pub struct Library {
    entries: Vec<(Request, Entry)>,
    /// What could not be decoded, and why.
    pub faults: Vec<(PathBuf, MapError)>,
    anisotropy: u16,
    /// Whether the device filters 16-bit integers.
    reads_unorm16: bool,
    arrived: Vec<Arrival>,
    /// Arrivals of an earlier exhibit are dropped.
    generation: u64,
    sender: mpsc::Sender<Arrival>,
    // A receiver is not Sync; only `receive` takes it, and never blocks.
    receiver: Mutex<mpsc::Receiver<Arrival>>,
}

impl Library {
    /// An empty library whose maps are filtered with `anisotropy` (1 to 16).
    pub fn new(anisotropy: u16) -> Self {
        let (sender, receiver) = mpsc::channel();
        Self {
            entries: Vec::new(),
            faults: Vec::new(),
            anisotropy,
            reads_unorm16: true,
            arrived: Vec::new(),
            generation: 0,
            sender,
            receiver: Mutex::new(receiver),
        }
    }

    /// Filters maps with `anisotropy` (1 to 16), those that are loaded from now on.
    pub fn set_anisotropy(&mut self, anisotropy: u16) {
        self.anisotropy = anisotropy;
    }

    /// Forgets everything: the files may have changed.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.faults.clear();
        self.generation += 1;
    }

    /// Forgets all but `wanted`.
    pub fn keep(&mut self, wanted: &[Request]) {
        let keys: Vec<Request> = wanted.iter().cloned().map(Request::key).collect();
        self.entries.retain(|(key, _)| keys.contains(key));
    }

    /// What was loaded for each of `requests`, in their order, or `None` while some are still
    /// on their way or cannot be had; those not asked for yet are started.
    pub fn take(&mut self, requests: &[Request], waker: Option<&Waker>) -> Option<Vec<Held>> {
        let mut held = Vec::new();
        for request in requests {
            let key = request.clone().key();
            match self.entries.iter().find(|(known, _)| *known == key) {
                Some((_, Entry::Ready(ready))) => held.push(ready.clone()),
                Some(_) => {}
                None => {
                    self.entries.push((key.clone(), Entry::Decoding));
                    self.decode(key, waker.cloned());
                }
            }
        }
        (held.len() == requests.len()).then_some(held)
    }

    /// Waits until all that is being decoded has arrived, for pictures without a window: a
    /// frame in the meantime would only take time from the decoding.
    pub fn wait(&mut self) {
        let decoding = |entry: &&(Request, Entry)| matches!(entry.1, Entry::Decoding);
        let outstanding = self.entries.iter().filter(decoding).count();
        let receiver = match self.receiver.get_mut() {
            Ok(receiver) => receiver,
            Err(poisoned) => poisoned.into_inner(),
        };
        // The library holds a sender itself, so this ends when everything is there.
        while self.arrived.len() < outstanding {
            let Ok(arrival) = receiver.recv() else { return };
            if arrival.0 == self.generation {
                self.arrived.push(arrival);
            }
        }
    }

    /// Whether something is still being decoded.
    pub fn is_busy(&self) -> bool {
        self.entries
            .iter()
            .any(|(_, entry)| matches!(entry, Entry::Decoding))
    }

    fn decode(&self, request: Request, waker: Option<Waker>) {
        let (sender, generation) = (self.sender.clone(), self.generation);
        let (anisotropy, reads_unorm16) = (self.anisotropy, self.reads_unorm16);
        rayon::spawn(move || {
            let decoded = unless_panicked(&request.path(), || match &request {
                Request::Map(map) => map.load().map(|pyramid| {
                    let facts = Facts {
                        coding: normal_coding(&pyramid.levels[0].texels),
                        bare: maps::bare_albedo(&pyramid),
                        mean: maps::mean_of(&pyramid),
                    };
                    let image = upload::map_image(pyramid, anisotropy, reads_unorm16);
                    Decoded::Map(Box::new(image), facts)
                }),
                Request::Surface(surface, size) => {
                    SideSurface::load(surface, *size).map(Decoded::Surface)
                }
            });
            // The receiver is gone when the program is closing: nobody is left to tell.
            let _ = sender.send((generation, request, decoded));
            if let Some(Waker(wake)) = waker {
                wake();
            }
        });
    }
}

/// Finds out what the device can read, once.
pub fn suit_device(device: Res<RenderDevice>, mut library: ResMut<Library>) {
    library.reads_unorm16 = device
        .features()
        .contains(WgpuFeatures::TEXTURE_FORMAT_16BIT_NORM);
}

/// Takes in what was decoded.
pub fn receive(mut library: ResMut<Library>, mut images: ResMut<Assets<Image>>) {
    // Looking must not count as a change.
    let silent = library.bypass_change_detection();
    let mut arrivals = std::mem::take(&mut silent.arrived);
    match silent.receiver.get_mut() {
        Ok(receiver) => arrivals.extend(receiver.try_iter()),
        Err(poisoned) => arrivals.extend(poisoned.into_inner().try_iter()),
    }
    for (generation, request, decoded) in arrivals {
        if generation != library.generation {
            continue;
        }
        let entry = match decoded {
            Ok(Decoded::Map(image, facts)) => Entry::Ready(Held::Map(images.add(*image), facts)),
            Ok(Decoded::Surface(surface)) => Entry::Ready(Held::Surface(Arc::new(surface))),
            Err(error) => {
                library.faults.push((request.path(), error));
                Entry::Faulty
            }
        };
        if let Some((_, slot)) = library
            .entries
            .iter_mut()
            .find(|(known, _)| *known == request)
        {
            *slot = entry;
        }
    }
}

/// What `load` gives; where it panics, as a decoder may over a damaged file, the fault of the
/// file at `path`: a panic would end the whole program from a thread of rayon's.
fn unless_panicked<T>(
    path: &Path,
    load: impl FnOnce() -> Result<T, MapError>,
) -> Result<T, MapError> {
    panic::catch_unwind(AssertUnwindSafe(load)).unwrap_or_else(|_| {
        Err(MapError::Damaged {
            path: path.to_owned(),
            detail: "its decoder failed".to_owned(),
        })
    })
}

/// Whether the lamps light an overlay as they light the paper: a photograph in another band
/// is paper, a category or a value is a sign.
pub fn is_lit(kind: &OverlayKind) -> bool {
    kind.is_lit()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decoder_that_panics_is_a_fault_of_its_file() {
        let path = Path::new("sheet.png");
        let error = unless_panicked::<()>(path, || panic!("a test of panics")).unwrap_err();
        assert!(
            error.to_string().starts_with("sheet.png: is damaged"),
            "{error}"
        );
        assert!(matches!(unless_panicked(path, || Ok(7)), Ok(7)));
    }
}
