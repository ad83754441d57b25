//! Pipelines: compiled once for each device, found again by kernel key. A switch back to a known
//! key compiles nothing, unless very many came in between.

use std::{
    collections::HashMap,
    sync::{Arc, Weak, atomic::AtomicU64},
};

use rayon::prelude::*;

use crate::{
    accuracy::ShaderChecks,
    device::{
        Gpu,
        compile_watch::CompileWatch,
        error::RenderError,
        pipeline_store::{Identity, Pipeline},
        preparations::Preparation,
    },
    layout::ResourceId,
    shader::{
        key::KernelKey,
        library::Library,
        link,
        pass::Pass,
        reflect::{Binding, BindingKind},
        specialize::specialized,
    },
};

/// Pipelines that are kept on a graphics card, and on a CPU adapter, whose compiled kernels take 10
/// MB and more each.
const MOST_KEPT: [usize; 2] = [1024, 96];

/// What is to be compiled.
struct PipelineDesc {
    label: String,
    identity: Identity,
    bindings: Vec<Binding>,
}

/// The pipelines of a renderer, by what asks for them.
pub struct Pipelines {
    library: Library,
    known: HashMap<KernelKey, HashMap<Pass, Weak<Pipeline>>>,
    compiled: usize,
    watch: Option<Arc<CompileWatch>>,
}

impl Pipelines {
    pub fn new(library: Library) -> Self {
        Self {
            library,
            known: HashMap::new(),
            compiled: 0,
            watch: None,
        }
    }

    /// Tells `watch` before something is compiled, and lets it stop that.
    pub fn watch(&mut self, watch: Arc<CompileWatch>) {
        self.watch = Some(watch);
    }

    /// Where the shaders come from.
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// Number of pipelines that this renderer compiled so far.
    pub fn compiled(&self) -> usize {
        self.compiled
    }

    /// The pipeline of a pass; compiles it at first use.
    pub async fn get(
        &mut self,
        gpu: &Gpu,
        key: &KernelKey,
        pass: Pass,
    ) -> Result<Arc<Pipeline>, RenderError> {
        if let Some(pipeline) = self
            .known
            .get(key)
            .and_then(|of_key| of_key.get(&pass))
            .and_then(Weak::upgrade)
        {
            gpu.pipelines.mark(&pipeline);
            return Ok(pipeline);
        }
        let desc = self.desc_of(gpu, key, pass)?;
        let pipeline = self.found_or_compiled(gpu, desc).await?;
        self.remember(key, pass, &pipeline);
        Ok(pipeline)
    }

    /// The pipeline of an entry point of `shaders/<root>.wgsl`.
    #[allow(
        clippy::too_many_arguments,
        reason = "the two callers name every argument's value on the spot"
    )]
    pub async fn build(
        &mut self,
        gpu: &Gpu,
        root: &str,
        label: &str,
        entry: &str,
        key: &KernelKey,
        variants: &[(&str, &str)],
        constants: &[(&str, f64)],
    ) -> Result<Arc<Pipeline>, RenderError> {
        let desc = self.desc(gpu, root, label, entry, key, variants, constants)?;
        self.found_or_compiled(gpu, desc).await
    }

    /// What was built already, or else is compiled now.
    async fn found_or_compiled(
        &mut self,
        gpu: &Gpu,
        desc: PipelineDesc,
    ) -> Result<Arc<Pipeline>, RenderError> {
        let pipeline = match gpu.pipelines.find(&desc.identity) {
            Some(pipeline) => pipeline,
            None => {
                self.watch.iter().for_each(|watch| watch.begin());
                let pipeline = compile(gpu, &desc)?.finish().await?;
                self.keep(gpu, desc.identity, pipeline)
            }
        };
        gpu.pipelines.mark(&pipeline);
        Ok(pipeline)
    }

    /// Compiles what `passes` lack, all at once, since a driver compiles each on the thread that
    /// asks for it.
    pub async fn prepare(
        &mut self,
        gpu: &Gpu,
        key: &KernelKey,
        passes: &[Pass],
    ) -> Result<(), RenderError> {
        let of_key = self.known.get(key);
        let is_known = |pass: &Pass| {
            of_key
                .and_then(|of_key| of_key.get(pass))
                .is_some_and(|pipeline| pipeline.strong_count() > 0)
        };
        let missing: Vec<Pass> = passes
            .iter()
            .copied()
            .filter(|pass| !is_known(pass))
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        let descs: Vec<PipelineDesc> = missing
            .par_iter()
            .map(|&pass| self.desc_of(gpu, key, pass))
            .collect::<Result<_, _>>()?;
        let mut fresh: Vec<&PipelineDesc> = Vec::new();
        for desc in descs
            .iter()
            .filter(|desc| gpu.pipelines.find(&desc.identity).is_none())
        {
            if fresh.iter().all(|other| other.identity != desc.identity) {
                fresh.push(desc);
            }
        }
        self.compile_all(gpu, &fresh).await?;
        for (pass, desc) in missing.into_iter().zip(descs) {
            if let Some(pipeline) = gpu.pipelines.find(&desc.identity) {
                gpu.pipelines.mark(&pipeline);
                self.remember(key, pass, &pipeline);
            }
        }
        Ok(())
    }

    /// Compiles and keeps pipelines. What was compiled is kept even where compiling was stopped or
    /// another pipeline was refused.
    async fn compile_all(&mut self, gpu: &Gpu, fresh: &[&PipelineDesc]) -> Result<(), RenderError> {
        if fresh.is_empty() {
            return Ok(());
        }
        let watch = self.watch.clone();
        watch.iter().for_each(|watch| watch.begin());
        let check = || watch.as_ref().map_or(Ok(()), |watch| watch.check());
        let begun: Vec<Result<_, RenderError>> = fresh
            .par_iter()
            .map(|desc| check().and_then(|()| compile(gpu, desc)))
            .collect();
        let mut all = Ok(());
        for (desc, begun) in fresh.iter().zip(begun) {
            let outcome = match begun {
                Ok(compiling) => compiling.finish().await,
                Err(error) => Err(error),
            };
            match outcome {
                Ok(pipeline) => {
                    let pipeline = self.keep(gpu, desc.identity.clone(), pipeline);
                    gpu.pipelines.mark(&pipeline);
                }
                Err(error) => all = all.and(Err(error)),
            }
        }
        all
    }

    fn remember(&mut self, key: &KernelKey, pass: Pass, pipeline: &Arc<Pipeline>) {
        let is_kept = |pipeline: &Weak<Pipeline>| pipeline.strong_count() > 0;
        if !self.known.contains_key(key) {
            // Keys whose pipelines the store dropped.
            self.known.retain(|_, of_key| of_key.values().any(is_kept));
        }
        self.known
            .entry(key.clone())
            .or_default()
            .insert(pass, Arc::downgrade(pipeline));
    }

    fn desc_of(&self, gpu: &Gpu, key: &KernelKey, pass: Pass) -> Result<PipelineDesc, RenderError> {
        self.desc(
            gpu,
            &pass.path(),
            &key.label_of(pass),
            pass.stem(),
            key,
            &key.variants(pass),
            &key.constants(pass),
        )
    }

    #[allow(clippy::too_many_arguments, reason = "as `build`")]
    fn desc(
        &self,
        gpu: &Gpu,
        root: &str,
        label: &str,
        entry: &str,
        key: &KernelKey,
        variants: &[(&str, &str)],
        constants: &[(&str, f64)],
    ) -> Result<PipelineDesc, RenderError> {
        let is_trusted = key.options.shader_checks == ShaderChecks::Trusted;
        // The planner has refused effects of files.
        if is_trusted && !matches!(self.library, Library::Embedded) {
            return Err(RenderError::Untrusted);
        }
        gpu.prepared.count(Preparation::Text);
        let linked = link::link(&self.library, root, key, variants)?;
        let interface = gpu
            .pipelines
            .interface(&linked, entry, gpu.caps.int64_atomics)?;
        let identity = Identity {
            text: specialized(&linked, &interface.overrides, constants)?,
            entry: entry.to_owned(),
            // Without checks, NVIDIA's driver 580.159 shades some triangles that `wobble` has moved
            // in wrong colors; why is not known.
            is_trusted: is_trusted && !(entry == Pass::Resolve.stem() && key.moves()),
        };
        Ok(PipelineDesc {
            label: label.to_owned(),
            identity,
            bindings: interface.bindings.clone(),
        })
    }

    fn keep(&mut self, gpu: &Gpu, identity: Identity, pipeline: Pipeline) -> Arc<Pipeline> {
        self.compiled += 1;
        gpu.prepared.count(Preparation::Pipeline);
        gpu.pipelines.keep(
            identity,
            pipeline,
            MOST_KEPT[usize::from(gpu.caps.software)],
        )
    }
}

/// A module without the compiler's own checks.
#[allow(
    unsafe_code,
    reason = "the option `trusted`: only for the shaders inside this program, and only where a preset pins it"
)]
fn trusted(gpu: &Gpu, descriptor: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
    // SAFETY: every loop of the embedded kernels has a constant or counted bound, and every index
    // is held inside its buffer by the kernel itself; the checked option draws the same
    // pictures (tests/exact/accuracy_axes.rs).
    unsafe {
        gpu.device
            .create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
    }
}

/// A pipeline that was asked for, and what the device will say about it.
struct Compiling<F> {
    pipeline: Pipeline,
    error: F,
}

impl<F: Future<Output = Option<wgpu::Error>>> Compiling<F> {
    async fn finish(self) -> Result<Pipeline, RenderError> {
        match self.error.await {
            Some(error) => Err(RenderError::Pipeline {
                label: self.pipeline.label,
                reason: error.to_string(),
            }),
            None => Ok(self.pipeline),
        }
    }
}

/// Begins to compile. A driver that compiles on the calling thread has finished then.
fn compile(
    gpu: &Gpu,
    desc: &PipelineDesc,
) -> Result<
    Compiling<impl Future<Output = Option<wgpu::Error>> + wgpu::WasmNotSend + use<>>,
    RenderError,
> {
    let PipelineDesc {
        label,
        identity,
        bindings,
    } = desc;
    let resource = |binding: &Binding| match ResourceId::of_binding(&binding.name) {
        Some(id) => Ok((binding.index, id)),
        None => {
            let reason = format!(
                "it binds {}, which is no resource of rasterlab; crates/gpu/src/resource_id.rs lists all",
                binding.name
            );
            Err(RenderError::Pipeline {
                label: label.clone(),
                reason,
            })
        }
    };
    let resources = bindings.iter().map(resource).collect::<Result<_, _>>()?;
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let source = wgpu::ShaderSource::Wgsl(identity.text.as_str().into());
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source,
    };
    let module = if identity.is_trusted {
        trusted(gpu, descriptor)
    } else {
        gpu.device.create_shader_module(descriptor)
    };
    let entries: Vec<_> = bindings
        .iter()
        .map(|binding| layout_entry(binding, wgpu::ShaderStages::COMPUTE))
        .collect();
    let layout = gpu
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        });
    let pipeline_layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
    let pipeline = gpu
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(&identity.entry),
            // Our kernels write all workgroup memory before they read it.
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
    let pipeline = Pipeline {
        label: label.clone(),
        pipeline,
        layout,
        bindings: resources,
        used: AtomicU64::new(0),
    };
    Ok(Compiling {
        pipeline,
        error: scope.pop(),
    })
}

/// The layout entry of a reflected binding.
pub fn layout_entry(
    binding: &Binding,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let ty = match binding.kind {
        BindingKind::Uniform => buffer(wgpu::BufferBindingType::Uniform),
        BindingKind::Storage { read_only } => {
            buffer(wgpu::BufferBindingType::Storage { read_only })
        }
        BindingKind::Texture { layered } => wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: if layered {
                wgpu::TextureViewDimension::D2Array
            } else {
                wgpu::TextureViewDimension::D2
            },
            multisampled: false,
        },
    };
    wgpu::BindGroupLayoutEntry {
        binding: binding.index,
        visibility,
        ty,
        count: None,
    }
}
