//! The WGSL of each pass: which files it is made of. Files of `passes/` hold bindings and entry points, all others pure functions.

use crate::arrays::Arrays;

macro_rules! files {
    ($($path:literal),* $(,)?) => { &[$(($path, include_str!(concat!("../../../shaders/", $path)))),*] };
}

type Files = &'static [(&'static str, &'static str)];

const SCENE: Files = files![
    "layout/scene.wgsl",
    "math/hash.wgsl",
    "math/pack.wgsl",
    "math/texel.wgsl",
    "math/view.wgsl",
    "curve/segment.wgsl",
    "yarn/fiber.wgsl",
    "yarn/detail.wgsl",
    "yarn/steps.wgsl",
    "passes/scene.wgsl",
];
const ARRAYS_UNIFORM: Files = files!["passes/arrays_uniform.wgsl"];
const ARRAYS_STORAGE: Files = files!["passes/arrays_storage.wgsl"];
const WORK: Files = files!["passes/work.wgsl"];
const RASTER: Files = files![
    "math/capsule.wgsl",
    "math/quad.wgsl",
    "yarn/core_fiber.wgsl",
    "passes/tables.wgsl",
    "passes/key.wgsl",
    "passes/fiber_line.wgsl",
    "passes/core_line.wgsl",
];
const SHADING: Files = files![
    "scattering/angles.wgsl",
    "scattering/longitudinal.wgsl",
    "scattering/azimuthal.wgsl",
    "scattering/physical.wgsl",
    "scattering/simple.wgsl",
    "light/sample.wgsl",
    "light/self_shadow.wgsl",
    "passes/lighting.wgsl",
    "passes/transport.wgsl",
    "passes/film.wgsl",
    "passes/shade.wgsl",
];

const KEYS: Files = files!["passes/key.wgsl", "passes/film.wgsl", "passes/mesh_target.wgsl"];
const BACKGROUND_SKY: Files = files!["passes/background_sky.wgsl"];
const MESHES: Files = files!["passes/meshes.wgsl"];

/// How visibility keys reach memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Store {
    /// One 64-bit atomic.
    Wide,
    /// Upper halves, by 32-bit atomics.
    High,
    /// Lower halves where the upper has won.
    Low,
}

/// What lies behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// One colour.
    Even,
    /// A picture of the sky.
    Sky,
}

/// What the resolve passes add to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Film {
    /// What every picture has.
    Plain,
    /// Further passes too.
    Aovs,
}

/// How fibers are shaded. Each has its own shaders: the software driver pays for both sides of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Lambert and a highlight.
    Simple,
    /// R + TT, light scattered once.
    Physical,
    /// The same with light scattered more than once.
    Multiple,
}

/// What a resolve pass is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolve {
    pub film: Film,
    pub model: Model,
}

impl Resolve {
    #[cfg(test)]
    pub const ALL: [Self; 6] = {
        const fn of(film: Film, model: Model) -> Resolve {
            Resolve { film, model }
        }
        [
            of(Film::Plain, Model::Simple),
            of(Film::Plain, Model::Physical),
            of(Film::Plain, Model::Multiple),
            of(Film::Aovs, Model::Simple),
            of(Film::Aovs, Model::Physical),
            of(Film::Aovs, Model::Multiple),
        ]
    };

    fn files(self) -> [Files; 2] {
        let film = match self.film {
            Film::Plain => files!["passes/no_aov.wgsl"],
            Film::Aovs => files!["passes/aov.wgsl"],
        };
        let model = match self.model {
            Model::Simple => files!["passes/model_simple.wgsl"],
            Model::Physical => files!["passes/model_physical.wgsl"],
            Model::Multiple => files!["passes/model_multiple.wgsl"],
        };
        [film, model]
    }
}

/// A compute pass; its entry point has the name of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    Cull,
    Scan,
    Fibers(Store),
    Cores(Store),
    Shadow,
    Classify(Background),
    SizeLists,
    ResolveFibers(Resolve),
    ResolveCores(Resolve),
    ResolveMeshes(Resolve),
    Follow,
    MoveKnots,
}

/// A pass of the hardware's rasteriser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Raster {
    Visibility,
    Shadow,
}

impl Pass {
    #[cfg(test)]
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::Cull,
            Self::Scan,
            Self::Fibers(Store::Wide),
            Self::Fibers(Store::High),
            Self::Fibers(Store::Low),
            Self::Cores(Store::Wide),
            Self::Cores(Store::High),
            Self::Cores(Store::Low),
            Self::Shadow,
            Self::Classify(Background::Even),
            Self::Classify(Background::Sky),
            Self::SizeLists,
            Self::Follow,
            Self::MoveKnots,
        ];
        for resolve in Resolve::ALL {
            all.extend([Self::ResolveFibers(resolve), Self::ResolveCores(resolve), Self::ResolveMeshes(resolve)]);
        }
        all
    }

    pub fn entry_point(self) -> &'static str {
        match self {
            Self::Cull => "cull",
            Self::Scan => "scan",
            Self::Fibers(_) => "visibility_fibers",
            Self::Cores(_) => "visibility_cores",
            Self::Shadow => "shadow",
            Self::Classify(_) => "classify",
            Self::SizeLists => "size_lists",
            Self::ResolveFibers(_) => "resolve_fibers",
            Self::ResolveCores(_) => "resolve_cores",
            Self::ResolveMeshes(_) => "resolve_meshes",
            Self::Follow => "follow",
            Self::MoveKnots => "move_knots",
        }
    }

    /// The pass's files in one piece.
    pub fn source(self, arrays: Arrays) -> String {
        let store = |store| match store {
            Store::Wide => files!["passes/store_wide.wgsl"],
            Store::High => files!["passes/store_high.wgsl"],
            Store::Low => files!["passes/store_low.wgsl"],
        };
        let arrays = match arrays {
            Arrays::Uniform => ARRAYS_UNIFORM,
            Arrays::Storage => ARRAYS_STORAGE,
        };
        let mut parts: Vec<Files> = match self {
            Self::Cull => vec![SCENE, WORK, files!["passes/cull.wgsl"]],
            Self::Scan => vec![SCENE, WORK, files!["passes/scan.wgsl"]],
            Self::Fibers(s) => vec![SCENE, WORK, RASTER, store(s), files!["passes/visibility_fibers.wgsl"]],
            Self::Cores(s) => vec![SCENE, WORK, RASTER, store(s), files!["passes/visibility_cores.wgsl"]],
            Self::Shadow => vec![SCENE, files!["math/capsule.wgsl", "passes/work.wgsl", "passes/shadow.wgsl"]],
            Self::Classify(background) => {
                let background = match background {
                    Background::Even => files!["passes/background_even.wgsl"],
                    Background::Sky => BACKGROUND_SKY,
                };
                vec![SCENE, WORK, KEYS, background, files!["passes/classify.wgsl"]]
            }
            Self::SizeLists => vec![SCENE, WORK, files!["passes/film.wgsl", "passes/size_lists.wgsl"]],
            Self::ResolveFibers(of) => {
                let [film, model] = of.files();
                vec![SCENE, WORK, RASTER, SHADING, film, model, files!["passes/resolve_fibers.wgsl"]]
            }
            Self::ResolveCores(of) => {
                let [film, model] = of.files();
                vec![SCENE, WORK, RASTER, SHADING, film, model, files!["passes/resolve_cores.wgsl"]]
            }
            Self::ResolveMeshes(of) => {
                let [film, model] = of.files();
                vec![
                    SCENE,
                    WORK,
                    RASTER,
                    SHADING,
                    film,
                    model,
                    BACKGROUND_SKY,
                    files!["passes/mesh_target.wgsl"],
                    MESHES,
                    files!["passes/resolve_meshes.wgsl"],
                ]
            }
            Self::Follow => vec![SCENE, WORK, files!["passes/follow.wgsl"]],
            // Without a scene.
            Self::MoveKnots => {
                let own = files!["math/pack.wgsl", "math/texel.wgsl", "passes/work.wgsl", "passes/move_knots.wgsl"];
                return joined(&[own]);
            }
        };
        parts.push(arrays);
        joined(&parts)
    }

    fn needs_wide_atomics(self) -> bool {
        matches!(self, Self::Fibers(Store::Wide) | Self::Cores(Store::Wide))
    }

    /// Parsed and validated; the bindings that the entry point uses.
    pub fn reflect(self, arrays: Arrays) -> Result<Reflection, String> {
        reflect(&self.source(arrays), self.needs_wide_atomics())
    }
}

impl Raster {
    pub fn name(self) -> &'static str {
        match self {
            Self::Visibility => "visibility_meshes",
            Self::Shadow => "shadow_meshes",
        }
    }

    /// Of the vertices, and of the fragments.
    pub fn entry_points(self) -> [&'static str; 2] {
        match self {
            Self::Visibility => ["mesh_vertex", "mesh_fragment"],
            Self::Shadow => ["mesh_shadow_vertex", "mesh_shadow_fragment"],
        }
    }

    /// The pass's files in one piece.
    pub fn source(self) -> String {
        let own = match self {
            Self::Visibility => files!["passes/visibility_meshes.wgsl"],
            Self::Shadow => files!["passes/shadow_meshes.wgsl"],
        };
        joined(&[SCENE, ARRAYS_STORAGE, MESHES, own])
    }

    /// Parsed and validated; the bindings that either entry point uses.
    pub fn bindings(self) -> Result<Vec<u32>, String> {
        reflect(&self.source(), false).map(|reflection| reflection.bindings)
    }
}

fn joined(parts: &[Files]) -> String {
    parts.iter().flat_map(|files| files.iter()).map(|(_, text)| *text).collect::<Vec<_>>().join("\n")
}

fn reflect(source: &str, wide_atomics: bool) -> Result<Reflection, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
    let mut capabilities = naga::valid::Capabilities::default() | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    if wide_atomics {
        capabilities |=
            naga::valid::Capabilities::SHADER_INT64 | naga::valid::Capabilities::SHADER_INT64_ATOMIC_MIN_MAX;
    }
    let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| e.emit_to_string(source))?;
    let is_used = |variable: naga::Handle<naga::GlobalVariable>| {
        (0..module.entry_points.len()).any(|i| !info.get_entry_point(i)[variable].is_empty())
    };
    let bindings = module
        .global_variables
        .iter()
        .filter(|(handle, _)| is_used(*handle))
        .filter_map(|(_, variable)| variable.binding.map(|b| b.binding))
        .collect();
    Ok(Reflection {
        #[cfg(test)]
        module,
        bindings,
    })
}

/// What naga finds in a pass.
pub struct Reflection {
    #[cfg(test)]
    pub module: naga::Module,
    /// Binding numbers of group 0 that its entry points use.
    pub bindings: Vec<u32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    const AOVS: Resolve = Resolve { film: Film::Aovs, model: Model::Multiple };
    use crate::layout::shared_structs;

    #[test]
    fn every_pass_is_valid() {
        for pass in Pass::all() {
            for arrays in Arrays::ALL {
                if let Err(message) = pass.reflect(arrays) {
                    panic!("{pass:?}, {arrays:?}:\n{message}");
                }
            }
        }
        for raster in [Raster::Visibility, Raster::Shadow] {
            if let Err(message) = raster.bindings() {
                panic!("{raster:?}:\n{message}");
            }
        }
    }

    /// Differences between the Rust structs and those of a WGSL module.
    fn mismatches(module: &naga::Module) -> Vec<String> {
        let mut found = Vec::new();
        for (name, size, members) in shared_structs() {
            let wgsl = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
            let Some((_, naga::Type { inner: naga::TypeInner::Struct { members: theirs, span }, .. })) = wgsl else {
                found.push(format!("{name}: no such struct"));
                continue;
            };
            let theirs: Vec<_> =
                theirs.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
            let ours: Vec<_> = members.iter().map(|(n, o)| ((*n).to_owned(), *o)).collect();
            if *span as usize != size {
                found.push(format!("{name}: {size} bytes here, {span} there"));
            }
            if theirs != ours {
                found.push(format!("{name}: {ours:?} here, {theirs:?} there"));
            }
        }
        found
    }

    #[test]
    fn shared_structs_match_the_shaders() {
        let module = Pass::ResolveFibers(AOVS).reflect(Arrays::Uniform).expect("valid").module;
        assert_eq!(mismatches(&module), Vec::<String>::new());
    }

    #[test]
    fn arrays_fill_a_uniform() {
        let module = Pass::ResolveMeshes(AOVS).reflect(Arrays::Uniform).expect("valid").module;
        let array = |variable: &naga::GlobalVariable| match module.types[variable.ty].inner {
            naga::TypeInner::Array { size: naga::ArraySize::Constant(count), stride, .. }
                if variable.space == naga::AddressSpace::Uniform && count.get() > 1 =>
            {
                Some((count.get() * stride, stride))
            }
            _ => None,
        };
        let sizes: Vec<(u32, u32)> =
            module.global_variables.iter().filter_map(|(_, variable)| array(variable)).collect();
        assert_eq!(sizes.len(), 5);
        let most = crate::arrays::UNIFORM_BYTES as u32;
        assert!(sizes.iter().all(|(size, stride)| *size <= most && size + stride > most), "{sizes:?}");
    }

    /// Constants that are written both here and in WGSL.
    fn shared_constants() -> Vec<(&'static str, f64)> {
        use crate::{aov, cryptomatte, frame, layout, tables, word_texture};
        use lisle_precompute::{HALF_WAY, HOLE, TURNS, Transport, TransportSize};
        let size = TransportSize::ALL;
        vec![
            ("KNOT_BEGINS_SEGMENT", layout::KNOT_BEGINS_SEGMENT.into()),
            ("LIGHT_SUN", layout::LIGHT_SUN.into()),
            ("LIGHT_POINT", layout::LIGHT_POINT.into()),
            ("LIGHT_AREA", layout::LIGHT_AREA.into()),
            ("NONE", layout::NONE.into()),
            ("MESH_SHADED", layout::MESH_SHADED.into()),
            ("MESH_SHADOW_CATCHER", layout::MESH_SHADOW_CATCHER.into()),
            ("MESH_HOLDOUT", layout::MESH_HOLDOUT.into()),
            ("NO_PLANE", aov::NO_PLANE.into()),
            ("MATTE_SLOTS", cryptomatte::SLOTS as f64),
            ("VECTOR_PLACE", aov::VECTOR_PLACE.into()),
            ("BLOCK", frame::BLOCK.into()),
            ("LANES", frame::LANES.into()),
            ("ROW", frame::ROW.into()),
            ("MOST_SKY_VIEWS", frame::MOST_SKY_VIEWS.into()),
            ("TURNS_KEPT", TURNS as f64),
            ("CORE_HOLE", HOLE.into()),
            ("CORE_PLACE_BITS", tables::CORE_PLACE_BITS.into()),
            ("TEXELS_IN_ROW", word_texture::TEXELS_IN_ROW.into()),
            ("HALF_WAY", HALF_WAY),
            ("TRANSPORT_LIGHT_LONGITUDES", size.light_longitudes as f64),
            ("TRANSPORT_LIGHT_AZIMUTHS", size.light_azimuths as f64),
            ("TRANSPORT_RINGS", size.rings as f64),
            ("TRANSPORT_VIEW_LONGITUDES", size.view_longitudes as f64),
            ("TRANSPORT_VIEW_AZIMUTHS", size.view_azimuths as f64),
            ("TRANSPORT_ANGLES", size.sides as f64),
            ("TRANSPORT_REACH", Transport::REACH),
        ]
    }

    /// Shared constants that a pass has otherwise, and how many it has at all.
    fn constants_apart(source: &str) -> (Vec<String>, usize) {
        let module = naga::front::wgsl::parse_str(source).expect("parses");
        let value = |name: &str| {
            let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name))?;
            match module.global_expressions[constant.init] {
                naga::Expression::Literal(naga::Literal::U32(value)) => Some(f64::from(value)),
                naga::Expression::Literal(naga::Literal::F32(value)) => Some(f64::from(value)),
                _ => None,
            }
        };
        let known: Vec<_> =
            shared_constants().into_iter().filter_map(|(name, ours)| Some((name, ours, value(name)?))).collect();
        let apart = known.iter().filter(|(_, ours, theirs)| (ours - theirs).abs() > 1e-6);
        (apart.map(|(name, ours, theirs)| format!("{name}: {ours} here, {theirs} there")).collect(), known.len())
    }

    #[test]
    fn shared_constants_match_the_shaders() {
        let source = Pass::ResolveFibers(AOVS).source(Arrays::Uniform);
        assert_eq!(constants_apart(&source), (Vec::new(), shared_constants().len()));
        let other = source.replace("const HALF_WAY: f32 = 0.2;", "const HALF_WAY: f32 = 0.25;");
        assert_eq!(constants_apart(&other).0.len(), 1);
    }

    #[test]
    fn a_moved_member_is_noticed() {
        let source = Pass::ResolveFibers(AOVS).source(Arrays::Uniform);
        let moved =
            source.replace("    first_knot: u32,\n    knot_count: u32,", "    knot_count: u32,\n    first_knot: u32,");
        assert_ne!(source, moved);
        let module = naga::front::wgsl::parse_str(&moved).expect("parses");
        assert_eq!(mismatches(&module).len(), 1);
    }
}
