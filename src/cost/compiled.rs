//! The shader that a need compiles to, and how long it is.

use std::{collections::HashMap, sync::Arc};

use bevy::{
    asset::{AssetId, uuid::Uuid},
    render::render_resource::WgpuFeatures,
    shader::{Shader, ShaderCache, ShaderCacheSource, ShaderDefVal},
};
use naga::{
    ShaderStage,
    back::spv,
    proc::{BoundsCheckPolicies, BoundsCheckPolicy},
    valid::{Capabilities, ValidationFlags, Validator},
};

use crate::{
    maps::MAX_PARTICLES,
    needs::Terms,
    sheet::{
        DISPLAY, PAPER_BASELINES_MODULE, PAPER_BSDF, PAPER_MATERIAL, PAPER_MEDIA_MODULE, material,
    },
};

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
const OF_DISPLAY: AssetId<Shader> = AssetId::Uuid {
    uuid: Uuid::from_u128(5),
};
/// The bind group that Bevy gives to materials.
const MATERIAL_BIND_GROUP: u32 = bevy::pbr::MATERIAL_BIND_GROUP_INDEX as u32;
/// The entry point that is counted.
const ENTRY: &str = "fragment";

/// A fault of Recto's own shaders.
#[derive(Clone, Debug, thiserror::Error)]
#[error("the shader does not compile with {0}")]
pub struct CompileError(String);

/// Composes the glue with the physics as Bevy does, without an app.
pub struct Composer(ShaderCache<naga::Module, ()>);

impl Composer {
    /// With `more` WGSL behind the glue: entry points of a test.
    pub fn new(more: &str) -> Self {
        let keep = |(): &(), source: ShaderCacheSource<'_>, _: &_| match source {
            ShaderCacheSource::Naga(module) => Ok(module),
            // WGSL comes out of the composer as a naga module.
            ShaderCacheSource::SpirV(_) | ShaderCacheSource::Wgsl(_) => Ok(naga::Module::default()),
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
            (OF_DISPLAY, DISPLAY.to_owned(), "display"),
            (GLUE, glue, "paper_material"),
        ] {
            let path = format!("embedded://recto/{name}.wgsl");
            cache.set_shader(id, Shader::from_wgsl(text, path));
        }
        Self(cache)
    }

    /// The module with these names defined, with the most sorts of particles.
    ///
    /// # Errors
    /// What the composer says, with the names.
    pub fn compose(&mut self, defined: &[&str]) -> Result<Arc<naga::Module>, String> {
        let group = ShaderDefVal::UInt("MATERIAL_BIND_GROUP".into(), MATERIAL_BIND_GROUP);
        let sorts = ShaderDefVal::UInt(material::SORTS.into(), MAX_PARTICLES as u32);
        let definitions: Vec<ShaderDefVal> = defined
            .iter()
            .map(|&name| name.into())
            .chain([group, sorts])
            .collect();
        self.0
            .get(0, GLUE, &definitions)
            .map_err(|error| format!("{defined:?}: {error}"))
    }
}

/// How many SPIR-V instructions the fragment shader for `terms` has, of a side with a picture: those
/// in the bodies of all functions that its entry point reaches, a function as often as it is
/// called, as drivers write them out in place; loops once; without labels, parameters,
/// declarations of variables and the calls themselves. naga writes them, without checks of
/// bounds, as Bevy asks for. The same text gives the same number on every machine.
///
/// # Errors
/// [`CompileError`], a fault of Recto's own.
pub fn instructions(composer: &mut Composer, terms: &Terms) -> Result<u64, CompileError> {
    let defined = material::definitions(terms, true, false);
    let fault = |error: String| CompileError(format!("{defined:?}: {error}"));
    let module = composer.compose(&defined).map_err(CompileError)?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .map_err(|error| fault(format!("{error:?}")))?;
    let unchecked = BoundsCheckPolicies {
        index: BoundsCheckPolicy::Unchecked,
        buffer: BoundsCheckPolicy::Unchecked,
        image_load: BoundsCheckPolicy::Unchecked,
        binding_array: BoundsCheckPolicy::Unchecked,
    };
    let options = spv::Options {
        flags: spv::WriterFlags::empty(),
        bounds_check_policies: unchecked,
        force_loop_bounding: false,
        ..spv::Options::default()
    };
    let entry = spv::PipelineOptions {
        shader_stage: ShaderStage::Fragment,
        entry_point: ENTRY.into(),
    };
    let words = spv::write_vec(&module, &info, &options, Some(&entry))
        .map_err(|error| fault(error.to_string()))?;
    count(&words).ok_or_else(|| fault("its entry point is missing".into()))
}

/// The body of a function.
#[derive(Default)]
struct Body {
    own: u64,
    calls: Vec<u32>,
}

/// Instructions that the entry point reaches, by the words of a SPIR-V module with one.
fn count(words: &[u32]) -> Option<u64> {
    const HEADER: usize = 5;
    const NOP: u32 = 0;
    const LINE: u32 = 8;
    const ENTRY_POINT: u32 = 15;
    const FUNCTION: u32 = 54;
    const PARAMETER: u32 = 55;
    const FUNCTION_END: u32 = 56;
    const CALL: u32 = 57;
    const VARIABLE: u32 = 59;
    const LABEL: u32 = 248;
    const NO_LINE: u32 = 317;
    let mut bodies: HashMap<u32, Body> = HashMap::new();
    let mut entry = None;
    let mut inside = None;
    let mut rest = words.get(HEADER..)?;
    while let Some(first) = rest.first() {
        let (operation, length) = (first & 0xffff, (first >> 16) as usize);
        let instruction = rest.get(..length).filter(|_| length > 0)?;
        rest = &rest[length..];
        match (operation, inside) {
            (ENTRY_POINT, _) => entry = instruction.get(2).copied(),
            (FUNCTION, _) => inside = instruction.get(2).copied(),
            (FUNCTION_END, _) => inside = None,
            (NOP | LINE | NO_LINE | PARAMETER | VARIABLE | LABEL, _) | (_, None) => {}
            (CALL, Some(function)) => {
                let called = *instruction.get(3)?;
                bodies.entry(function).or_default().calls.push(called);
            }
            (_, Some(function)) => bodies.entry(function).or_default().own += 1,
        }
    }
    let mut known = HashMap::new();
    Some(written_out(&bodies, &mut known, entry?))
}

/// WGSL has no recursion, so this ends.
fn written_out(bodies: &HashMap<u32, Body>, known: &mut HashMap<u32, u64>, function: u32) -> u64 {
    if let Some(count) = known.get(&function) {
        return *count;
    }
    let Some(body) = bodies.get(&function) else {
        return 0;
    };
    let called = body.calls.iter();
    let count = body.own
        + called
            .map(|called| written_out(bodies, known, *called))
            .sum::<u64>();
    known.insert(function, count);
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::tier::Tier;

    #[test]
    fn functions_count_as_often_as_they_are_called() {
        let op = |operation: u32, operands: &[u32]| {
            let mut words = vec![((operands.len() as u32 + 1) << 16) | operation];
            words.extend(operands);
            words
        };
        let words = [
            vec![0; 5],
            op(15, &[4, 2, 0]),
            // Function 1: one addition and a return.
            op(54, &[9, 1, 0, 8]),
            op(248, &[5]),
            op(129, &[9, 6, 7, 7]),
            op(254, &[6]),
            op(56, &[]),
            // Function 2, the entry: two calls and a return.
            op(54, &[9, 2, 0, 8]),
            op(248, &[10]),
            op(57, &[9, 11, 1]),
            op(57, &[9, 12, 1]),
            op(253, &[]),
            op(56, &[]),
            // Function 3: nobody calls it.
            op(54, &[9, 3, 0, 8]),
            op(253, &[]),
            op(56, &[]),
        ]
        .concat();
        assert_eq!(count(&words), Some(5));
        assert_eq!(count(&words[..words.len() - 4].repeat(0)), None, "no words");
        assert_eq!(count(&[0; 6]), None, "an instruction without length");
    }

    #[test]
    fn more_physics_is_more_instructions_and_each_time_as_many() {
        let mut composer = Composer::new("");
        let mut of = |tier| {
            let terms = Terms {
                tier,
                one_lamp: true,
                distant_lamps: true,
                parallel_eye: true,
                edge: true,
                specular: tier != Tier::Lambert,
                ..Terms::default()
            };
            instructions(&mut composer, &terms).expect("it compiles")
        };
        let ladder = [Tier::Lambert, Tier::Draft, Tier::Gallery, Tier::Study].map(&mut of);
        assert!(ladder.is_sorted() && ladder[0] < ladder[3], "{ladder:?}");
        assert_eq!(of(Tier::Study), ladder[3]);
    }
}
