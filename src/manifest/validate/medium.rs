//! Media: those of the catalogue with what the manifest changes, and its own; and papers.

use super::{
    super::{
        decode::{Brief, Pattern},
        document::{Trail, Words},
        exhibit::{Paper, ResolvedMedium, Source},
        fault::{did_you_mean, quoted_list},
        raw::{
            RawManifest, RawMedium, RawPaper,
            values::{Id, PaperName},
        },
    },
    Validator,
    names::Names,
};
use crate::{
    optics::medium::{Matter, MediumId, MediumKind, Preset},
    units::{Degrees, Micrometres, Millimetres},
};

/// A sheet of drawing paper where the manifest says nothing.
const DEFAULT_PAPER: &str = "laid";
/// No paper is smoother.
const PAPER_ALPHA_MIN: f64 = 0.1;

impl Validator<'_, '_> {
    /// Gathers what media maps and papers can name.
    pub(super) fn media(&mut self, raw: &RawManifest, trail: &Trail) {
        let preset = raw.exhibit.as_ref().and_then(|about| about.optics);
        self.media = catalogue(preset.unwrap_or_default());
        let Some(list) = &raw.medium else { return };
        let ids = list.iter().map(|(i, medium)| (i, &medium.id));
        let names = Names::new("medium", ids, list.has_holes());
        self.unique(&names, trail);
        self.media_incomplete = list.has_holes();
        // Based on the catalogue, so that the order of the tables does not matter.
        let catalogue = self.media.clone();
        for (i, raw) in list.iter() {
            match self.changed(raw, &catalogue, &trail.index(i)) {
                Some(medium) => match self.media.iter_mut().find(|m| m.name == medium.name) {
                    Some(slot) => *slot = medium,
                    None => self.media.push(medium),
                },
                None => self.media_incomplete = true,
            }
        }
    }

    /// A medium of the catalogue with what `raw` changes of it.
    fn changed(
        &mut self,
        raw: &RawMedium,
        catalogue: &[ResolvedMedium],
        trail: &Trail,
    ) -> Option<ResolvedMedium> {
        let id = raw.id.as_str();
        let find = |name: &str| catalogue.iter().find(|medium| medium.name == name);
        let words = || catalogue.iter().map(|medium| medium.name.as_str());
        let base = match (&raw.based_on, find(id)) {
            (None, Some(base)) => base,
            (None, None) => {
                let words = Words::new(
                    format!("\"{id}\", which the catalogue lacks, without based_on"),
                    format!("{}, or a new name with based_on", quoted_list(words())),
                    did_you_mean(id, words(), "add based_on, the medium that it is like"),
                );
                self.report.fault(&trail.key("id"), words);
                return None;
            }
            (Some(_), Some(_)) => {
                let words = Words::new(
                    format!("based_on for \"{id}\", which the catalogue has"),
                    "based_on for a new name only",
                    "remove based_on, or choose another id",
                );
                self.report.fault(&trail.key("based_on"), words);
                return None;
            }
            (Some(name), None) => match find(name.as_str()) {
                Some(base) => base,
                None => {
                    let words = Words::new(
                        format!("\"{}\"", name.as_str()),
                        quoted_list(words()),
                        did_you_mean(name.as_str(), words(), "write one of these words"),
                    );
                    self.report.fault(&trail.key("based_on"), words);
                    return None;
                }
            },
        };
        let known = keys_of(&base.matter);
        let mut foreign = false;
        for (key, _) in given(raw)
            .into_iter()
            .filter(|(key, given)| *given && !known.contains(key))
        {
            let allowed = match known {
                [] => "no constants: it is a groove without matter".to_owned(),
                keys => format!("{}, which it has", keys.join(", ")),
            };
            let words = Words::new(
                format!("{key} for \"{id}\", which is {}", what(&base.matter)),
                allowed,
                "remove it, or base the medium on another",
            );
            self.report.fault(&trail.key(key), words);
            foreign = true;
        }
        if let (Matter::Paper(_), Some(alpha)) = (&base.matter, raw.roughness)
            && alpha.0 < PAPER_ALPHA_MIN
        {
            let words = Words::new(
                alpha.0.to_string(),
                format!("a number from {PAPER_ALPHA_MIN} to 1, as no paper is smoother"),
                "write a number within this range",
            );
            self.report.fault(&trail.key("roughness"), words);
            return None;
        }
        (!foreign).then(|| ResolvedMedium {
            name: id.to_owned(),
            kind: base.kind,
            matter: with_changes(base.matter, raw),
            source: raw.source.unwrap_or(Source::Assumed),
            origin: base.origin,
            albedo_given: raw.albedo.is_some(),
        })
    }

    /// The index of a drawing material that a map names at `trail`.
    pub(super) fn drawn(&mut self, name: &Id, trail: &Trail) -> Option<usize> {
        self.named(name, MediumKind::Drawn, trail)
    }

    /// `None` only where a name is at fault or the catalogue lacks the default paper.
    pub(super) fn paper(
        &mut self,
        raw: Option<&Brief<PaperName, RawPaper>>,
        trail: &Trail,
    ) -> Option<Paper> {
        let (name, details) = match raw {
            None => (None, None),
            Some(Brief::Short(name)) => (Some((name, trail.clone())), None),
            Some(Brief::Full(details)) => {
                let kind = details.kind.as_ref();
                (kind.map(|name| (name, trail.key("kind"))), Some(details))
            }
        };
        let index = match name {
            Some((name, trail)) => self.named(&name.0, MediumKind::Paper, &trail)?,
            None => self.media.iter().position(|m| m.name == DEFAULT_PAPER)?,
        };
        let medium = &self.media[index];
        let Matter::Paper(kind) = medium.matter else {
            return None;
        };
        macro_rules! detail {
            ($key:ident) => {
                details.and_then(|d| d.$key).map_or(kind.$key, |v| v.0)
            };
        }
        let given = details.and_then(|d| d.albedo.as_ref());
        Some(Paper {
            kind: medium.name.clone(),
            thickness: Micrometres(detail!(thickness_um)),
            chain_lines: details
                .and_then(|d| d.chain_lines_mm)
                .map(|mm| Millimetres(mm.0)),
            roughness: detail!(roughness),
            index: detail!(index),
            specular: details.and_then(|d| d.specular).map_or(1.0, |s| s.0),
            albedo: given
                .map(|albedo| albedo.linear())
                .or(medium.albedo_given.then_some(kind.albedo)),
            scattering_per_mm: detail!(scattering_per_mm),
            forward_share: detail!(forward_share),
            g_forward: detail!(g_forward),
            g_backward: detail!(g_backward),
            retro: detail!(retro),
            sheen: detail!(sheen),
            anisotropy: detail!(anisotropy),
            anisotropy_angle: Degrees(detail!(anisotropy_deg)),
            show_through: details.and_then(|d| d.show_through).unwrap_or_default(),
            source: details.and_then(|d| d.source).unwrap_or(medium.source),
        })
    }

    fn named(&mut self, name: &Id, kind: MediumKind, trail: &Trail) -> Option<usize> {
        let name = name.as_str();
        let found = self
            .media
            .iter()
            .position(|medium| medium.kind == kind && medium.name == name);
        if found.is_none() && !self.media_incomplete && !self.report.is_full() {
            let of_kind = self.media.iter().filter(|medium| medium.kind == kind);
            let names: Vec<&str> = of_kind.map(|medium| medium.name.as_str()).collect();
            let otherwise = match (self.media.iter().find(|m| m.name == name), kind) {
                (Some(_), MediumKind::Drawn) => "this is a paper: write one of these words",
                (Some(_), MediumKind::Paper) => "this is no paper: write one of these words",
                (None, _) => "write one of these words, or add a [[medium]] with this id",
            };
            let remedy = did_you_mean(name, names.iter().copied(), otherwise);
            let words = Words::new(format!("\"{name}\""), quoted_list(names), remedy);
            self.report.fault(trail, words);
        }
        found
    }
}

fn catalogue(preset: Preset) -> Vec<ResolvedMedium> {
    MediumId::all()
        .map(|id| {
            let medium = id.of_preset(preset);
            ResolvedMedium {
                name: medium.name.to_owned(),
                kind: medium.kind,
                matter: medium.matter,
                source: Source::Assumed,
                origin: medium.source,
                albedo_given: false,
            }
        })
        .collect()
}

/// The constants of each matter, by the keys of the manifest.
fn keys_of(matter: &Matter) -> &'static [&'static str] {
    match matter {
        Matter::Paper(_) => &[
            "index",
            "roughness",
            "scattering_per_mm",
            "forward_share",
            "g_forward",
            "g_backward",
            "thickness_um",
            "albedo",
            "retro",
            "sheen",
            "anisotropy",
            "anisotropy_deg",
        ],
        Matter::Film(_) => &["index", "roughness", "depth"],
        Matter::Particles(_) => &["n", "k", "roughness", "albedo"],
        Matter::Body(_) => &[
            "index",
            "roughness",
            "scattering_per_mm",
            "thickness_um",
            "albedo",
        ],
        Matter::Relief => &[],
    }
}

fn what(matter: &Matter) -> &'static str {
    match matter {
        Matter::Paper(_) => "a paper",
        Matter::Film(_) => "a transparent film",
        Matter::Particles(_) => "made of particles",
        Matter::Body(_) => "a body colour",
        Matter::Relief => "a groove",
    }
}

/// Every constant that a table can give, and whether this one does.
fn given(raw: &RawMedium) -> [(&'static str, bool); 15] {
    macro_rules! given {
        ($($key:ident),*) => { [$((stringify!($key), raw.$key.is_some())),*] };
    }
    given![
        index,
        roughness,
        scattering_per_mm,
        forward_share,
        g_forward,
        g_backward,
        thickness_um,
        albedo,
        retro,
        sheen,
        anisotropy,
        anisotropy_deg,
        depth,
        n,
        k
    ]
}

fn with_changes(mut matter: Matter, raw: &RawMedium) -> Matter {
    macro_rules! change {
        ($constants:ident: $($key:ident),*) => {$(
            if let Some(value) = raw.$key {
                $constants.$key = value.0;
            }
        )*};
    }
    macro_rules! change_each {
        ($constants:ident: $($key:ident),*) => {$(
            if let Some(values) = raw.$key {
                $constants.$key = values.map(|value| value.0);
            }
        )*};
    }
    let albedo = raw.albedo.as_ref().map(|albedo| albedo.linear());
    match &mut matter {
        Matter::Paper(paper) => {
            change!(paper: index, roughness, scattering_per_mm, forward_share, g_forward,
                g_backward, thickness_um, retro, sheen, anisotropy, anisotropy_deg);
            paper.albedo = albedo.unwrap_or(paper.albedo);
        }
        Matter::Film(film) => {
            change!(film: index, roughness);
            change_each!(film: depth);
        }
        Matter::Particles(particles) => {
            change!(particles: roughness);
            change_each!(particles: n, k);
            particles.albedo = albedo.unwrap_or(particles.albedo);
        }
        Matter::Body(body) => {
            change!(body: index, roughness, scattering_per_mm, thickness_um);
            body.albedo = albedo.unwrap_or(body.albedo);
        }
        Matter::Relief => {}
    }
    matter
}
