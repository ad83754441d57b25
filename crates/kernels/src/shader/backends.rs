//! The languages of graphics interfaces: naga writes a valid module in each of them, as a device of
//! that interface does before its driver compiles it. So a text that one machine cannot compile is
//! found on every machine. In a page the browser has compilers of its own, and nothing is written.

use naga::{Module, valid::ModuleInfo};

/// A module that cannot be written in the language of an interface.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{interface} cannot be given it: {reason}")]
pub struct Untranslatable {
    /// The interface with its language, for instance `Metal (MSL)`.
    pub interface: &'static str,
    /// What naga says, if it says more than a panic.
    pub reason: String,
}

/// Writes a validated module, all its entry points and functions, in every language. A module has
/// no overrides left.
/// Errors: the first interface that cannot be given it. A panic of naga's counts as such an error.
#[cfg(not(target_arch = "wasm32"))]
pub fn translate(module: &Module, info: &ModuleInfo) -> Result<(), Untranslatable> {
    type Write = fn(&Module, &ModuleInfo) -> Result<(), String>;
    let interfaces: [(&str, Write); 3] = [
        ("Vulkan (SPIR-V)", native::spirv),
        ("Direct3D 12 (HLSL)", native::hlsl),
        ("Metal (MSL)", native::msl),
    ];
    for (interface, write) in interfaces {
        caught(|| write(module, info))
            .unwrap_or_else(|_| Err("its translator fails".into()))
            .map_err(|reason| Untranslatable { interface, reason })?;
    }
    Ok(())
}

/// A page does not translate: its browser does.
#[cfg(target_arch = "wasm32")]
pub fn translate(_: &Module, _: &ModuleInfo) -> Result<(), Untranslatable> {
    Ok(())
}

/// A panic that was caught.
#[derive(Clone, Copy, Debug)]
pub struct Panicked;

/// Does `work`, which reads what anyone may have written with code that is not ours, and catches
/// its panic without the message that a panic prints. In a page a panic ends the program.
#[cfg(not(target_arch = "wasm32"))]
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Panicked> {
    use std::{
        cell::Cell,
        panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook},
        sync::Once,
    };
    thread_local! {
        static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
    }
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let hook = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_CAUGHT.get() {
                hook(panic);
            }
        }));
    });
    let outer = IS_CAUGHT.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(work));
    IS_CAUGHT.set(outer);
    outcome.map_err(|_| Panicked)
}

/// Does `work`.
/// Errors: never: in a page a panic ends the program.
#[cfg(target_arch = "wasm32")]
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Panicked> {
    Ok(work())
}

/// What wgpu asks naga for, with all its checks.
#[cfg(not(target_arch = "wasm32"))]
mod native {
    use naga::{
        Module, TypeInner,
        back::{hlsl, msl, spv},
        proc::{BoundsCheckPolicies, BoundsCheckPolicy},
        valid::ModuleInfo,
    };

    const CHECKED: BoundsCheckPolicies = BoundsCheckPolicies {
        index: BoundsCheckPolicy::Restrict,
        buffer: BoundsCheckPolicy::Restrict,
        image_load: BoundsCheckPolicy::Restrict,
        binding_array: BoundsCheckPolicy::Unchecked,
    };

    pub fn spirv(module: &Module, info: &ModuleInfo) -> Result<(), String> {
        let options = spv::Options {
            lang_version: (1, 3),
            bounds_check_policies: CHECKED,
            fake_missing_bindings: true,
            ..spv::Options::default()
        };
        if module.entry_points.is_empty() {
            spv::write_vec(module, info, &options, None).map_err(|error| error.to_string())?;
        }
        for entry in &module.entry_points {
            let entry = spv::PipelineOptions {
                shader_stage: entry.stage,
                entry_point: entry.name.clone(),
            };
            spv::write_vec(module, info, &options, Some(&entry))
                .map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    pub fn hlsl(module: &Module, info: &ModuleInfo) -> Result<(), String> {
        let is_wide = |ty: &naga::Type| match ty.inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => scalar.width == 8,
            _ => false,
        };
        let has_wide = module.types.iter().any(|(_, ty)| is_wide(ty));
        let options = hlsl::Options {
            // 64-bit words are an extension that newer shader models have.
            shader_model: if has_wide {
                hlsl::ShaderModel::V6_6
            } else {
                hlsl::ShaderModel::V5_1
            },
            ..hlsl::Options::default()
        };
        let (mut text, pipeline) = (String::new(), hlsl::PipelineOptions::default());
        hlsl::Writer::new(&mut text, &options, &pipeline)
            .write(module, info, None)
            .map_err(|error| error.to_string())?
            .entry_point_names
            .into_iter()
            .try_for_each(|name| name.map(drop))
            .map_err(|error| error.to_string())
    }

    pub fn msl(module: &Module, info: &ModuleInfo) -> Result<(), String> {
        let options = msl::Options {
            lang_version: (2, 4),
            bounds_check_policies: CHECKED,
            ..msl::Options::default()
        };
        msl::write_string(module, info, &options, &msl::PipelineOptions::default())
            .map_err(|error| error.to_string())?
            .1
            .entry_point_names
            .into_iter()
            .try_for_each(|name| name.map(drop))
            .map_err(|error| error.to_string())
    }
}
