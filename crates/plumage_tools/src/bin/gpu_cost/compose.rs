//! WGSL of Bevy and of the plugin to SPIR-V, as Bevy and wgpu make it.

use bevy::shader::ShaderDefVal;
use naga::{
    Binding, Module, ScalarKind, ShaderStage, TypeInner,
    back::spv,
    proc::{BoundsCheckPolicies, BoundsCheckPolicy},
    valid::{Capabilities, ValidationFlags, Validator},
};
use naga_oil::compose::{
    ComposableModuleDescriptor, Composer, NagaModuleDescriptor, ShaderDefValue, ShaderLanguage,
    ShaderType, get_preprocessor_data,
};
use std::{
    collections::{HashMap, HashSet},
    fs,
    path::{Path, PathBuf},
};

struct Source {
    text: String,
    path: PathBuf,
    name: Option<String>,
    imports: Vec<String>,
}

/// Every shader below some folders, known by its import path and by its file.
pub struct Library {
    sources: Vec<Source>,
    by_name: HashMap<String, usize>,
    composer: Composer,
    added: HashSet<usize>,
}

/// One stage as the device compiler takes it.
pub struct Compiled {
    /// SPIR-V.
    pub words: Vec<u32>,
    /// Set, binding, `VkDescriptorType`, count.
    pub bindings: Vec<[u32; 4]>,
    /// Location, components, kind (0 float, 1 signed, 2 unsigned) of what the entry point takes.
    pub inputs: Vec<[u32; 3]>,
    /// Color targets that the entry point writes.
    pub targets: u32,
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            walk(&path, found);
        } else if path.extension().is_some_and(|end| end == "wgsl") {
            found.push(path);
        }
    }
}

impl Library {
    /// All `*.wgsl` below the folders; where two have one import path, the later folder's counts. `comparison`: with the modules of the
    /// published methods, which take the place of shipped ones.
    pub fn new(folders: &[PathBuf], comparison: bool) -> Result<Self, String> {
        let mut files = Vec::new();
        for folder in folders {
            let first = files.len();
            walk(folder, &mut files);
            files[first..].sort_by_key(|path| is_comparison(path));
        }
        files.retain(|path| comparison || !is_comparison(path));
        let mut sources = Vec::new();
        let mut by_name = HashMap::new();
        for path in files {
            let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            let (name, imports, _) = get_preprocessor_data(&text);
            if let Some(name) = &name {
                by_name.insert(name.clone(), sources.len());
            }
            let imports = imports.into_iter().map(|import| import.import).collect();
            sources.push(Source {
                text,
                path,
                name,
                imports,
            });
        }
        Ok(Self {
            sources,
            by_name,
            composer: Composer::non_validating(),
            added: HashSet::new(),
        })
    }

    /// Adds what a source imports, before it.
    fn add_imports(&mut self, of: usize) -> Result<(), String> {
        for import in self.sources[of].imports.clone() {
            // An import names a module or an item of one.
            let mut name = import.as_str();
            let found = loop {
                if let Some(&found) = self.by_name.get(name) {
                    break Some(found);
                }
                match name.rsplit_once("::") {
                    Some((outer, _)) => name = outer,
                    None => break None,
                }
            };
            let Some(found) = found else { continue };
            if !self.added.insert(found) {
                continue;
            }
            self.add_imports(found)?;
            let source = &self.sources[found];
            let described = ComposableModuleDescriptor {
                source: &source.text,
                file_path: &source.path.to_string_lossy(),
                language: ShaderLanguage::Wgsl,
                as_name: source.name.clone(),
                additional_imports: &[],
                shader_defs: HashMap::new(),
            };
            if let Err(error) = self.composer.add_composable_module(described) {
                return Err(error.emit_to_string(&self.composer));
            }
        }
        Ok(())
    }

    /// One entry point of a file; `file` is the end of its path.
    pub fn compile(
        &mut self,
        file: &str,
        stage: ShaderStage,
        entry: &str,
        defs: &[ShaderDefVal],
    ) -> Result<Compiled, String> {
        let at = self
            .sources
            .iter()
            .rposition(|source| source.path.ends_with(file))
            .ok_or_else(|| format!("no shader {file}"))?;
        self.add_imports(at)?;
        let source = &self.sources[at];
        let described = NagaModuleDescriptor {
            source: &source.text,
            file_path: &source.path.to_string_lossy(),
            shader_type: ShaderType::Wgsl,
            shader_defs: defs.iter().map(value_of).collect(),
            additional_imports: &[],
        };
        let made = self.composer.make_naga_module(described);
        let module = made.map_err(|error| error.emit_to_string(&self.composer))?;
        compile_entry(module, stage, entry).map_err(|error| format!("{file} {entry}: {error}"))
    }
}

fn is_comparison(path: &Path) -> bool {
    path.components()
        .any(|part| part.as_os_str() == "comparison")
}

fn value_of(def: &ShaderDefVal) -> (String, ShaderDefValue) {
    match def {
        ShaderDefVal::Bool(name, value) => (name.clone(), ShaderDefValue::Bool(*value)),
        ShaderDefVal::Int(name, value) => (name.clone(), ShaderDefValue::Int(*value)),
        ShaderDefVal::UInt(name, value) => (name.clone(), ShaderDefValue::UInt(*value)),
    }
}

fn compile_entry(mut module: Module, stage: ShaderStage, entry: &str) -> Result<Compiled, String> {
    module
        .entry_points
        .retain(|found| found.name == entry && found.stage == stage);
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .map_err(|error| error.emit_to_string(""))?;
    let mut options = spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::empty(),
        // Bevy trusts its shaders: no checks are written into them.
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Unchecked,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        force_loop_bounding: false,
        ..Default::default()
    };
    let mut bindings = Vec::new();
    for (_, variable) in module.global_variables.iter() {
        let Some(place) = variable.binding else {
            continue;
        };
        let target = spv::BindingInfo {
            descriptor_set: place.group,
            binding: place.binding,
            binding_array_size: None,
        };
        options.binding_map.insert(place, target);
        let (kind, count) = descriptor(&module, variable)?;
        bindings.push([place.group, place.binding, kind, count]);
    }
    let chosen = spv::PipelineOptions {
        shader_stage: stage,
        entry_point: entry.to_owned(),
    };
    let words = spv::write_vec(&module, &info, &options, Some(&chosen))
        .map_err(|error| error.to_string())?;
    let function = &module.entry_points[0].function;
    let mut inputs = Vec::new();
    for argument in &function.arguments {
        locations(
            &module,
            argument.ty,
            argument.binding.as_ref(),
            &mut |place, inner| {
                let (components, kind) = match *inner {
                    TypeInner::Scalar(scalar) => (1, scalar.kind),
                    TypeInner::Vector { size, scalar } => (size as u32, scalar.kind),
                    _ => (4, ScalarKind::Float),
                };
                let kind = match kind {
                    ScalarKind::Sint => 1,
                    ScalarKind::Uint => 2,
                    _ => 0,
                };
                inputs.push([place, components, kind]);
            },
        );
    }
    let mut targets = 0;
    if let Some(result) = &function.result {
        let binding = result.binding.as_ref();
        locations(&module, result.ty, binding, &mut |place, _| {
            targets = targets.max(place + 1);
        });
    }
    Ok(Compiled {
        words,
        bindings,
        inputs,
        targets,
    })
}

/// `VkDescriptorType` and count of a variable.
fn descriptor(module: &Module, variable: &naga::GlobalVariable) -> Result<(u32, u32), String> {
    // As many of an array without an end as Bevy binds.
    const ENDLESS: u32 = 64;
    const SAMPLER: u32 = 0;
    const SAMPLED: u32 = 2;
    const STORED: u32 = 3;
    const UNIFORM: u32 = 6;
    const STORAGE: u32 = 7;
    let mut inner = &module.types[variable.ty].inner;
    let mut count = 1;
    if let TypeInner::BindingArray { base, size } = *inner {
        count = match size {
            naga::ArraySize::Constant(count) => count.get(),
            _ => ENDLESS,
        };
        inner = &module.types[base].inner;
    }
    let kind = match (variable.space, inner) {
        (naga::AddressSpace::Uniform, _) => UNIFORM,
        (naga::AddressSpace::Storage { .. }, _) => STORAGE,
        (_, TypeInner::Sampler { .. }) => SAMPLER,
        (_, TypeInner::Image { class, .. }) => match class {
            naga::ImageClass::Storage { .. } => STORED,
            _ => SAMPLED,
        },
        (_, other) => return Err(format!("no descriptor for {other:?}")),
    };
    Ok((kind, count))
}

/// Calls `found` with every location of an argument or result.
fn locations(
    module: &Module,
    ty: naga::Handle<naga::Type>,
    binding: Option<&Binding>,
    found: &mut dyn FnMut(u32, &TypeInner),
) {
    let inner = &module.types[ty].inner;
    if let Some(Binding::Location { location, .. }) = binding {
        found(*location, inner);
    } else if let TypeInner::Struct { members, .. } = inner {
        for member in members {
            locations(module, member.ty, member.binding.as_ref(), found);
        }
    }
}
