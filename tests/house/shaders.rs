//! Promise: every choice of variants, with no effect, each, all and every pair of effects, links
//! and validates, with 64-bit atomics only where an option asks for them, within eight storage
//! buffers, and is translated for Vulkan, Direct3D 12 and Metal; every file names only what it and the files that it uses declare; and few files must be
//! opened to read a pass. Needs no adapter.
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
    host, preset_file,
    shader::{
        Fetch, KernelKey, Pass,
        backends::translate,
        library::{self, Library},
        link::{self, LinkError, Linked},
        pass::RasterPhase,
        reflect::{self, BindingKind, Reflected},
        specialize::specialized,
    },
};

use super::shader_parts;

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
    for effect in EFFECTS
        .iter()
        .filter(|&effect| effect.hooks.slot == Some(Slot::Visibility))
        .cloned()
    {
        let others = EFFECTS
            .iter()
            .filter(|&other| other.hooks.slot.is_none())
            .cloned();
        stacks.extend([vec![effect.clone()], others.chain([effect]).collect()]);
    }
    stacks
}

fn linked(key: &KernelKey, pass: Pass) -> Linked {
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
    assert!(
        !bindings.is_empty(),
        "{} has no entry point {}",
        pass.stem(),
        pass.stem()
    );
    let storage = bindings
        .iter()
        .filter(|b| matches!(b.kind, BindingKind::Storage { .. }))
        .count();
    valid().insert(identity, storage);
    storage
}

#[test]
fn every_variant_links_and_validates_within_eight_storage_buffers() {
    for fetch in [Fetch::Direct, Fetch::Indexed] {
        for visibility in Visibility::EXACT {
            for has_queues in [false, true] {
                for (is_single_draw, is_instanced) in [(false, false), (false, true), (true, false)]
                {
                    let is_fullest = has_queues && !is_single_draw && !is_instanced;
                    for effects in if is_fullest {
                        slot_stacks()
                    } else {
                        vec![vec![]]
                    } {
                        let mut key = key(fetch, visibility, has_queues, effects);
                        (key.vertices.is_single_draw, key.vertices.is_instanced) =
                            (is_single_draw, is_instanced);
                        for pass in all_passes(&key) {
                            let storage = validate(&key, pass);
                            assert!(
                                storage <= 8,
                                "{} of {key} binds {storage} storage buffers",
                                pass.label()
                            );
                        }
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
                for pass in all_passes(&key) {
                    let storage = validate(&key, pass);
                    assert!(
                        storage <= 8,
                        "{} of {key} binds {storage} storage buffers",
                        pass.label()
                    );
                }
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
    let with_stacks = [
        "visibility",
        "sample_counter",
        "xray_sums",
        "transparency",
        "depth",
        "culling",
    ]
    .map(|name| Axis::find(name).expect("an axis").name);
    for axis in AXES {
        for index in 0..axis.words.len() {
            for effects in if with_stacks.contains(&axis.name) {
                &stacks[..]
            } else {
                &stacks[1..2]
            } {
                let mut key = key(Fetch::Indexed, Visibility::Split32, true, effects.clone());
                key.options.set(axis, index);
                key.samples.draw_order = effects
                    .contains(&effect("draw_order"))
                    .then_some(Mode::Submission);
                if key.options.parameters == Parameters::Baked {
                    key.effects.baked = effects
                        .iter()
                        .map(|effect| effect.defaults.clone())
                        .collect();
                }
                for pass in all_passes(&key) {
                    let storage = validate(&key, pass);
                    assert!(
                        storage <= 8,
                        "{} of {key} binds {storage} storage buffers",
                        pass.label()
                    );
                }
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
                for pass in all_passes(&key) {
                    let storage = validate(&key, pass);
                    assert!(
                        storage <= 8,
                        "{} of {key} binds {storage} storage buffers",
                        pass.label()
                    );
                }
            }
        }
    }
}

/// Links and validates every pass of these stacks.
fn validates_stacks(stacks: impl IntoIterator<Item = Vec<Arc<Effect>>>) {
    for effects in stacks {
        let key = key(Fetch::Indexed, Visibility::Split32, true, effects);
        for pass in all_passes(&key) {
            let storage = validate(&key, pass);
            assert!(
                storage <= 8,
                "{} of {key} binds {storage} storage buffers",
                pass.label()
            );
        }
    }
}

#[test]
fn every_effect_alone_and_all_together_validates() {
    validates_stacks([vec![], EFFECTS.to_vec()]);
    validates_stacks(EFFECTS.iter().map(|effect| vec![effect.clone()]));
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
    validates_stacks(inside().flat_map(|a| {
        inside()
            .filter(move |b| *b != a)
            .map(move |b| vec![a.clone(), b.clone()])
    }));
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
            translates(
                &linked,
                &reflected,
                &flags.map(|flag| (flag, is_set)),
                false,
            );
        }
    }
}

#[test]
fn an_empty_stack_leaves_no_trace_of_effects() {
    let key = key(Fetch::Direct, Visibility::Split32, false, vec![]);
    let linked = linked(&key, Pass::Resolve);
    let reflected = reflect::reflect(&linked, false).expect("valid");
    assert!(
        reflected
            .bindings("resolve")
            .iter()
            .all(|b| b.name != "effects")
    );
    assert!(!linked.text.contains("struct Effects"));
}

#[test]
fn a_stack_that_moves_nothing_leaves_no_trace_of_movement() {
    for effects in [
        vec![],
        EFFECTS
            .iter()
            .filter(|&effect| effect.hooks.vertex.is_none())
            .cloned()
            .collect(),
    ] {
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
    let effect = |name: &str| Effect::find(name).expect("a listed effect");
    for (name, has_unshared_vertices) in [("inflate", false), ("wobble", false), ("explode", true)]
    {
        let key = key(
            Fetch::Indexed,
            Visibility::Split32,
            true,
            vec![effect(name).clone()],
        );
        assert!(
            key.moves() && key.unshares_vertices() == has_unshared_vertices,
            "{name}"
        );
        let project = linked(&key, Pass::Project);
        let reads_indices = reflect::reflect(&project, false)
            .expect("valid")
            .bindings("project")
            .iter()
            .any(|b| b.name == "index_bytes");
        assert_eq!(
            reads_indices, has_unshared_vertices,
            "{name}: the projection looks up triangles only where it must"
        );
    }
}

#[test]
fn portable_sources_hold_no_enable_and_no_requires() {
    let key = key(Fetch::Indexed, Visibility::Split32, true, EFFECTS.to_vec());
    for pass in all_passes(&key) {
        let text = linked(&key, pass).text;
        let bad = text
            .lines()
            .find(|l| l.starts_with("enable ") || l.starts_with("requires ") || l.contains("u64"));
        assert_eq!(bad, None, "{}", pass.label());
    }
}

#[test]
fn an_error_names_the_file_and_line_a_person_wrote() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let shaders = folder.path();
    for below in ["stages", "effects"] {
        std::fs::create_dir(shaders.join(below)).expect("a folder");
    }
    std::fs::write(
        shaders.join("stages/project.wgsl"),
        "//@ use effects/wrong\n@compute @workgroup_size(1)\nfn project() { wrong(); }\n",
    )
    .expect("written");
    std::fs::write(
        shaders.join("effects/wrong.wgsl"),
        "// A mistake\nfn wrong() { let x: u32 = 1.5; }\n",
    )
    .expect("written");
    let key = key(Fetch::Direct, Visibility::Split32, false, vec![]);
    let linked = link::link(
        &host::shaders::library(shaders),
        "stages/project",
        &key,
        &[],
    )
    .expect("links");
    let Err(error) = reflect::reflect(&linked, false) else {
        panic!("a wrong type was accepted")
    };
    assert!(
        error
            .to_string()
            .starts_with("shaders/effects/wrong.wgsl:2:"),
        "{error}"
    );
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
                for pass in all_passes(&key) {
                    let storage = validate(&key, pass);
                    assert!(
                        storage <= 8,
                        "{} of {key} binds {storage} storage buffers",
                        pass.label()
                    );
                }
            }
        }
    }
}

/// A scene of plain indexed meshes with the default options, on a graphics card.
fn plain_key() -> KernelKey {
    let mut key = key(Fetch::Indexed, Visibility::Split32, true, vec![]);
    key.work.listed_tiles = false;
    (key.generated.has_particles, key.surface.has_material_atlas) = (false, false);
    key.surface.has_finish = false;
    (key.surface.has_finish_maps, key.surface.has_normal_maps) = (false, false);
    key.surface.lights = 0;
    key
}

#[test]
fn a_pass_is_read_in_few_files() {
    for (pass, most) in [
        (Pass::RasterSmall(RasterPhase::Depth), 12),
        (Pass::Resolve, 16),
    ] {
        let linked = linked(&plain_key(), pass);
        let files = linked.files();
        assert!(
            files.len() <= most,
            "{} files for {}: {files:?}",
            files.len(),
            pass.label()
        );
    }
}

#[test]
fn every_use_line_is_needed_and_a_missing_one_is_refused() {
    let folder = shader_parts::copied();
    let library = host::shaders::library(folder.path());
    let effects = ["dissolve", "explode", "shadow", "outline"]
        .map(|name| Effect::find(name).expect("an effect").clone())
        .to_vec();
    let mut full = key(Fetch::Indexed, Visibility::Split32, true, effects);
    full.samples.has_mask = true;
    let mut seen = std::collections::BTreeSet::new();
    let (mut refused_by_linker, mut needless) = (0, std::collections::BTreeSet::new());
    let mut unmasked = full.clone();
    unmasked.samples.has_mask = false;
    for key in [plain_key(), unmasked, full] {
        let passes = key.frame();
        for pass in passes {
            for part in linked(&key, pass).parts {
                let Some((file, first)) = part.origin else {
                    continue;
                };
                let path = folder.path().join(format!("{file}.wgsl"));
                let text = std::fs::read_to_string(&path).expect("a shader");
                let lines: Vec<&str> = text.lines().collect();
                let is_section =
                    |line: &&str| line.starts_with("//@ variant ") || line.starts_with("//@ step ");
                let end = lines
                    .iter()
                    .skip(first + 1)
                    .position(is_section)
                    .map_or(lines.len(), |found| first + 1 + found);
                for at in (first..end).filter(|at| lines[*at].starts_with("//@ use ")) {
                    let line = lines[at];
                    // A line that one key needs may be idle in another, where a further file uses
                    // the same one.
                    let use_line = (part.name.clone(), line.to_owned());
                    if seen.contains(&use_line) {
                        continue;
                    }
                    let mut without = lines.clone();
                    without[at] = "//";
                    std::fs::write(&path, without.join("\n")).expect("written");
                    match link::link(&library, &pass.path(), &key, &key.variants(pass)) {
                        Err(LinkError::Undeclared {
                            file: blamed,
                            name: missing,
                            ..
                        }) => {
                            refused_by_linker += 1;
                            needless.remove(&use_line);
                            assert!(
                                blamed == file && !missing.is_empty(),
                                "{file} without {line}: {blamed} is blamed"
                            );
                        }
                        Err(error) => panic!("{file} without {line}: {error}"),
                        // A file that nothing else uses is not linked at all.
                        Ok(linked) if reflect::reflect(&linked, false).is_err() => {
                            needless.remove(&use_line);
                        }
                        Ok(_) => {
                            needless.insert(use_line);
                            continue;
                        }
                    }
                    seen.insert(use_line);
                }
                std::fs::write(&path, &text).expect("written");
            }
        }
    }
    assert!(
        needless.is_empty(),
        "no key needs these lines: {needless:#?}"
    );
    assert!(
        seen.len() > 150 && refused_by_linker > 100,
        "{} lines, {refused_by_linker} refused",
        seen.len()
    );
}

#[test]
fn an_undeclared_name_is_refused_with_file_line_and_name() {
    let folder = shader_parts::copied();
    let path = folder.path().join("variants/coverage.wgsl");
    let text = std::fs::read_to_string(&path).expect("a shader");
    let line = text
        .lines()
        .position(|line| line.contains("    return coverage.row + "))
        .expect("the line")
        + 1;
    let wrong = text.replacen(
        "    return coverage.row + ",
        "    return vec3i(i32(frame.size.x)) + coverage.row + ",
        1,
    );
    std::fs::write(&path, wrong).expect("written");
    let (key, pass) = (plain_key(), Pass::RasterMedium(RasterPhase::Depth));
    let error = link::link(
        &host::shaders::library(folder.path()),
        &pass.path(),
        &key,
        &key.variants(pass),
    )
    .expect_err("refused");
    let expected = format!(
        "shaders/variants/coverage.wgsl:{line}: names frame, which lib/frame declares; add //@ use for it"
    );
    assert_eq!(error.to_string(), expected);
}

#[test]
fn no_file_can_use_a_stage() {
    let folder = shader_parts::copied();
    let path = folder.path().join("variants/coverage.wgsl");
    let text = std::fs::read_to_string(&path).expect("a shader");
    let section = "//@ variant fixed\n";
    let begin = text.find(section).expect("the section");
    let begin_line = text[..begin].lines().count() as u32 + 1;
    std::fs::write(
        &path,
        text.replace(
            section,
            &format!("{section}//@ use stages/raster/raster_small\n"),
        ),
    )
    .expect("written");
    let (key, pass) = (plain_key(), Pass::RasterMedium(RasterPhase::Depth));
    let error = link::link(
        &host::shaders::library(folder.path()),
        &pass.path(),
        &key,
        &key.variants(pass),
    )
    .expect_err("refused");
    assert!(
        matches!(error, LinkError::UsesStage { line, .. } if line == begin_line + 1),
        "{error}"
    );
}

#[test]
fn a_variant_that_lacks_what_its_interface_declares_is_refused() {
    let folder = shader_parts::copied();
    let path = folder.path().join("variants/coverage.wgsl");
    let text = std::fs::read_to_string(&path).expect("a shader");
    std::fs::write(
        &path,
        text.replacen(
            "\nfn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32",
            "\nfn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: u32",
            1,
        ),
    )
    .expect("written");
    let (key, pass) = (plain_key(), Pass::RasterMedium(RasterPhase::Depth));
    let error = link::link(
        &host::shaders::library(folder.path()),
        &pass.path(),
        &key,
        &key.variants(pass),
    )
    .expect_err("refused");
    assert!(
        matches!(&error, LinkError::Incomplete { signature, .. } if signature.contains("coverage_begin")),
        "{error}"
    );
}

#[test]
fn a_file_of_variants_has_all_its_code_in_sections_of_different_names() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/variants"))
        .expect("a folder")
    {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a shader");
        let sections = library::sections(&text);
        let code = text[sections[0].1.clone()]
            .lines()
            .find(|line| !line.is_empty() && !line.starts_with("//"));
        assert_eq!(
            code,
            None,
            "{}: no kernel links what stands before the first section",
            path.display()
        );
        let names: std::collections::BTreeSet<&str> =
            sections.iter().map(|(name, _)| *name).collect();
        assert!(
            names.len() == sections.len() && sections.len() > 1,
            "{}: {names:?}",
            path.display()
        );
    }
}
