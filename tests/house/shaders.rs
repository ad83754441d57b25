//! Promise: every choice of variants, with no effect, each, all and every pair of effects, links
//! and validates, with 64-bit atomics only where an option asks for them, within eight storage
//! buffers, and is translated for Vulkan, Direct3D 12 and Metal. Needs no adapter.
//!
//! With `RASTERLAB_LINKED=FOLDER` every linked text that a browser may be given is also written there:
//! `tests/web/run.py --kernels FOLDER` has the browser's own compiler read them.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex},
};

use rasterlab::{
    accuracy::{AXES, Axis, Culling, DotCulling, Parameters, Visibility},
    effects::{
        EFFECTS, Effect,
        dots::LineSource,
        draw_order::Mode,
        hooks::{Shape, Slot},
    },
    preset_file,
    shader::{
        Fetch, KernelKey, Pass,
        backends::translate,
        library::Library,
        link::{self, Linked},
        pass::RasterPhase,
        reflect::{self, BindingKind, Reflected},
        specialize::specialized,
    },
};

pub fn key(
    fetch: Fetch,
    visibility: Visibility,
    has_queues: bool,
    effects: Vec<Arc<Effect>>,
) -> KernelKey {
    let mut key = KernelKey::complete(fetch, visibility, effects);
    (
        key.paths.has_clipping,
        key.paths.has_medium,
        key.paths.has_large,
    ) = (has_queues, has_queues, has_queues);
    key.work.listed_tiles = has_queues;
    key
}

pub fn all_passes(key: &KernelKey) -> Vec<Pass> {
    let mut passes = key.frame();
    passes.extend(key.passes(&[RasterPhase::Count]));
    if key.effects.dots.is_some() {
        passes.push(Pass::DotsProbe);
    }
    passes
}

/// Nothing, and each effect in the visibility slot alone and together with effects on other hooks.
fn slot_stacks() -> Vec<Vec<Arc<Effect>>> {
    let mut stacks = vec![vec![]];
    let slotted = EFFECTS
        .iter()
        .filter(|effect| effect.hooks.slot == Some(Slot::Visibility));
    for effect in slotted.cloned() {
        let others = EFFECTS
            .iter()
            .filter(|other| other.hooks.slot.is_none())
            .cloned();
        stacks.extend([vec![effect.clone()], others.chain([effect]).collect()]);
    }
    stacks
}

pub fn linked(key: &KernelKey, pass: Pass) -> Linked {
    link::link(&Library::Embedded, &pass.path(), key, &key.variants(pass))
        .unwrap_or_else(|error| panic!("{} of {key}: {error}", pass.label()))
}

/// Gives the text its constants and translates it for Vulkan, Direct3D 12 and Metal.
fn translates(linked: &Linked, reflected: &Reflected, constants: &[(&str, f64)], int64: bool) {
    let text = specialized(linked, &reflected.overrides(), constants)
        .unwrap_or_else(|error| panic!("{error}"));
    let specialized = Linked {
        text,
        parts: linked.parts.clone(),
    };
    let reflected = reflect::reflect(&specialized, int64).unwrap_or_else(|error| panic!("{error}"));
    assert!(reflected.module.overrides.is_empty());
    // No browser has 64-bit words.
    if let Some(folder) = std::env::var_os("RASTERLAB_LINKED").filter(|_| !int64) {
        let folder = std::path::PathBuf::from(folder);
        let hash = preset_file::Fnv::new().bytes(specialized.text.as_bytes());
        let name = format!("{}.wgsl", preset_file::hex(hash));
        std::fs::create_dir_all(&folder)
            .and_then(|()| std::fs::write(folder.join(name), &specialized.text))
            .expect("the folder takes files");
    }
    if let Err(error) = translate(&reflected.module, &reflected.info) {
        panic!("{error}\n{}", specialized.text);
    }
}

/// Validates one pass and returns the number of storage buffers it binds. Most keys share most
/// texts: each text is validated once.
pub fn validate(key: &KernelKey, pass: Pass) -> usize {
    static VALID: Mutex<BTreeMap<(String, &str, bool), usize>> = Mutex::new(BTreeMap::new());
    let valid = || {
        VALID
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    };
    let int64 = matches!(
        pass.phase(),
        Some(RasterPhase::Packed | RasterPhase::NearestAndSum)
    );
    let linked = linked(key, pass);
    let identity = (linked.text.clone(), pass.stem(), int64);
    if let Some(&storage) = valid().get(&identity) {
        return storage;
    }
    let reflected = reflect::reflect(&linked, int64)
        .unwrap_or_else(|error| panic!("{} of {key}: {error}", pass.label()));
    translates(&linked, &reflected, &key.constants(pass), int64);
    let bindings = reflected.bindings(pass.stem());
    assert!(!bindings.is_empty(), "{} has no entry point", pass.stem());
    let is_storage = |kind: &BindingKind| matches!(kind, BindingKind::Storage { .. });
    let storage = bindings
        .iter()
        .filter(|binding| is_storage(&binding.kind))
        .count();
    valid().insert(identity, storage);
    storage
}

/// Validates all its passes, each within eight storage buffers.
fn validate_all(key: &KernelKey) {
    for pass in all_passes(key) {
        let storage = validate(key, pass);
        assert!(
            storage <= 8,
            "{} of {key} binds {storage} storage buffers",
            pass.label()
        );
    }
}

#[test]
fn every_variant_links_and_validates_within_eight_storage_buffers() {
    for fetch in [Fetch::Direct, Fetch::Indexed] {
        for visibility in Visibility::EXACT {
            for has_queues in [false, true] {
                for (is_single_draw, is_instanced) in [(false, false), (false, true), (true, false)]
                {
                    let is_fullest = has_queues && !is_single_draw && !is_instanced;
                    let stacks = if is_fullest {
                        slot_stacks()
                    } else {
                        vec![vec![]]
                    };
                    for effects in stacks {
                        let mut key = key(fetch, visibility, has_queues, effects);
                        (key.vertices.is_single_draw, key.vertices.is_instanced) =
                            (is_single_draw, is_instanced);
                        validate_all(&key);
                    }
                }
            }
        }
    }
}

/// Sample tests differ by shape, by order and by effects.
#[test]
fn every_shape_and_order_validates_within_eight_storage_buffers() {
    for shape in [Shape::Triangles, Shape::Boxes, Shape::Points] {
        for draw_order in [None, Some(Mode::Submission), Some(Mode::Scheduler)] {
            for has_large in [false, true] {
                let effects = ["dissolve", "draw_order", "xray"]
                    .map(|name| Effect::find(name).expect("a listed effect").clone())
                    .to_vec();
                let mut key = key(Fetch::Indexed, Visibility::Split32, true, effects);
                (
                    key.samples.shape,
                    key.samples.draw_order,
                    key.paths.has_large,
                ) = (shape, draw_order, has_large);
                key.samples.has_points = has_large;
                validate_all(&key);
            }
        }
    }
}

/// Every option of every axis, alone and with the effects that choose among the same variants.
#[test]
fn every_option_of_every_axis_links_and_validates() {
    let effect = |name| Effect::find(name).expect("an effect").clone();
    let stacks = [
        vec![],
        vec![effect("overdraw"), effect("outline")],
        vec![effect("dissolve"), effect("draw_order")],
        vec![effect("xray")],
        vec![effect("glass")],
    ];
    // Only these choose among the variants in which the stacks differ.
    let with_stacks: Vec<&str> = "visibility sample_counter xray_sums transparency depth culling"
        .split(' ')
        .map(|name| Axis::find(name).expect("an axis").name)
        .collect();
    for axis in AXES {
        let has_stacks = with_stacks.contains(&axis.name);
        for index in 0..axis.words.len() {
            for effects in if has_stacks {
                &stacks[..]
            } else {
                &stacks[1..2]
            } {
                let mut key = key(Fetch::Indexed, Visibility::Split32, true, effects.clone());
                key.options.set(axis, index);
                let has_order = effects.contains(&effect("draw_order"));
                key.samples.draw_order = has_order.then_some(Mode::Submission);
                if key.options.parameters == Parameters::Baked {
                    key.effects.baked = effects
                        .iter()
                        .map(|effect| effect.defaults.clone())
                        .collect();
                }
                validate_all(&key);
            }
        }
    }
}

/// Meshlets take the last storage buffer that a pass may bind.
#[test]
fn every_way_of_culling_validates_on_every_exact_rung() {
    for visibility in Visibility::EXACT {
        for &culling in Culling::ALL {
            for effects in slot_stacks() {
                let mut key = key(Fetch::Indexed, visibility, true, effects);
                key.options.culling = culling;
                validate_all(&key);
            }
        }
    }
}

/// Links and validates every pass of these stacks.
fn validate_stacks(stacks: impl IntoIterator<Item = Vec<Arc<Effect>>>) {
    for effects in stacks {
        validate_all(&key(Fetch::Indexed, Visibility::Split32, true, effects));
    }
}

#[test]
fn every_effect_alone_and_all_together_validates() {
    validate_stacks([vec![], EFFECTS.to_vec()]);
    validate_stacks(EFFECTS.iter().map(|effect| vec![effect.clone()]));
}

#[test]
#[ignore = "slow: .ci/full"]
fn every_pair_of_effects_validates() {
    // A pass over the picture has the text of its own effect alone.
    let inside = || {
        EFFECTS
            .iter()
            .filter(|effect| effect.hooks.passes.is_none())
    };
    let others = |a| inside().filter(move |b| *b != a);
    validate_stacks(inside().flat_map(|a| others(a).map(|b| vec![a.clone(), b.clone()])));
}

#[test]
fn the_hardware_baseline_is_translated_with_every_effect() {
    for effects in [vec![], EFFECTS.to_vec()] {
        let mut key = key(Fetch::Indexed, Visibility::Split32, true, effects);
        key.vertices.is_single_draw = false;
        let variants = key.variants(Pass::Resolve);
        let linked = link::link(&Library::Embedded, "baselines/hardware", &key, &variants)
            .unwrap_or_else(|error| panic!("{error}"));
        let reflected = reflect::reflect(&linked, false).unwrap_or_else(|error| panic!("{error}"));
        for is_set in [0.0, 1.0] {
            let flags = ["HAS_BASE_IMAGE", "HAS_EMISSION_IMAGE", "IS_UNLIT"];
            let constants = flags.map(|flag| (flag, is_set));
            translates(&linked, &reflected, &constants, false);
        }
    }
}

#[test]
fn an_empty_stack_leaves_no_trace_of_effects() {
    let key = key(Fetch::Direct, Visibility::Split32, false, vec![]);
    let linked = linked(&key, Pass::Resolve);
    let reflected = reflect::reflect(&linked, false).expect("valid");
    let bindings = reflected.bindings("resolve");
    assert!(bindings.iter().all(|binding| binding.name != "effects"));
    assert!(!linked.text.contains("struct Effects"));
}

#[test]
fn a_stack_that_moves_nothing_leaves_no_trace_of_movement() {
    let still = EFFECTS
        .iter()
        .filter(|effect| effect.hooks.vertex.is_none());
    for effects in [vec![], still.cloned().collect()] {
        let key = key(Fetch::Indexed, Visibility::Split32, true, effects);
        assert!(!key.to_string().contains("vertex_effects"), "{key}");
        for pass in all_passes(&key) {
            let text = linked(&key, pass).text;
            for trace in ["struct Vertex {", "glue_vertex", "vertex_effects_corner"] {
                assert!(!text.contains(trace), "{}: {trace}", pass.label());
            }
        }
    }
}

#[test]
fn triangles_that_stay_together_share_their_vertices() {
    for (name, has_unshared_vertices) in [("inflate", false), ("wobble", false), ("explode", true)]
    {
        let effects = vec![Effect::find(name).expect("a listed effect").clone()];
        let key = key(Fetch::Indexed, Visibility::Split32, true, effects);
        assert!(
            key.moves() && key.unshares_vertices() == has_unshared_vertices,
            "{name}"
        );
        let project = reflect::reflect(&linked(&key, Pass::Project), false).expect("valid");
        let bindings = project.bindings("project");
        // The projection looks up triangles only where it must.
        let reads_indices = bindings.iter().any(|binding| binding.name == "index_bytes");
        assert_eq!(reads_indices, has_unshared_vertices, "{name}");
    }
}

#[test]
fn portable_sources_hold_no_enable_and_no_requires() {
    let key = key(Fetch::Indexed, Visibility::Split32, true, EFFECTS.to_vec());
    for pass in all_passes(&key) {
        let text = linked(&key, pass).text;
        let is_bad =
            |l: &&str| l.starts_with("enable ") || l.starts_with("requires ") || l.contains("u64");
        assert_eq!(text.lines().find(is_bad), None, "{}", pass.label());
    }
}

#[test]
fn every_way_of_choosing_dots_validates_for_every_line_and_backend() {
    let dots = Effect::find("dots").expect("a listed effect");
    for visibility in Visibility::ALL {
        for way in DotCulling::ALL {
            for line_source in [LineSource::Edges, LineSource::Creases, LineSource::Polyline] {
                let mut key = key(Fetch::Indexed, *visibility, true, vec![dots.clone()]);
                key.effects.dots = Some(line_source);
                key.options.dot_culling = *way;
                validate_all(&key);
            }
        }
    }
}
