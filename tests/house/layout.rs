//! Promise: every struct shared by Rust and WGSL agrees by name, order, kind, offset and size, and
//! every binding has a resource. Needs no adapter.

use std::{collections::BTreeSet, sync::Arc};

use naga::{Module, TypeInner};
use rasterlab::{
    accuracy::{Culling, DotCulling, Visibility},
    effects::{EFFECTS, Effect, dots::LineSource, draw_order::Mode},
    gpu::{ResourceId, records::RECORDS},
    shader::{
        Fetch, KernelKey, Pass,
        library::Library,
        link,
        reflect::{self, Reflected},
    },
};

fn linked(key: &KernelKey, root: &str, variants: &[(&str, &str)], int64: bool) -> Reflected {
    let linked = link::link(&Library::Embedded, root, key, variants).expect("links");
    reflect::reflect(&linked, int64).expect("validates")
}

fn reflected(key: &KernelKey, pass: Pass) -> Reflected {
    linked(key, &pass.path(), &key.variants(pass), true)
}

fn whole(visibility: Visibility, effects: &[&Arc<Effect>]) -> KernelKey {
    let effects = effects.iter().map(|&effect| effect.clone()).collect();
    KernelKey::complete(Fetch::Indexed, visibility, effects)
}

/// Keys that together bind every resource and declare every shared struct.
fn keys() -> Vec<KernelKey> {
    let plain = whole(Visibility::Split32, &[]);
    let mut culling = plain.clone();
    culling.options.culling = Culling::TwoPass;
    let mut ordered = whole(
        Visibility::Packed64,
        &[&rasterlab::effects::draw_order::EFFECT],
    );
    ordered.samples.draw_order = Some(Mode::Submission);
    let dots = |line_source, dot_culling| {
        let mut key = whole(Visibility::Split32, &[&rasterlab::effects::dots::EFFECT]);
        (key.effects.dots, key.options.dot_culling) = (Some(line_source), dot_culling);
        key
    };
    let one = |effect| whole(Visibility::Split32, &[effect]);
    let mut buffered = one(&rasterlab::effects::shadow::EFFECT);
    buffered.work.buffered_shadow_map = true;
    let mut instanced = plain.clone();
    instanced.vertices.is_instanced = true;
    vec![
        plain,
        culling,
        ordered,
        dots(LineSource::Edges, DotCulling::Gpu),
        dots(LineSource::Polyline, DotCulling::Cpu),
        one(&rasterlab::effects::shadow::EFFECT),
        buffered,
        instanced,
        one(&rasterlab::effects::glass::EFFECT),
        one(&rasterlab::effects::overdraw::EFFECT),
        one(&rasterlab::effects::xray::EFFECT),
        one(Effect::named("bloom")),
        one(Effect::named("studio")),
        whole(Visibility::Packed32, &[]),
    ]
}

/// Every pass of those keys, with those that only some pictures have, and the baselines.
fn modules() -> Vec<(String, Reflected, Vec<reflect::Binding>)> {
    let mut modules = Vec::new();
    for key in keys() {
        let mut passes = key.frame();
        passes.extend([Pass::Skin, Pass::Particles, Pass::Scale]);
        passes.extend(key.effects.dots.map(|_| Pass::DotsProbe));
        let mut seen = BTreeSet::new();
        passes.retain(|pass| seen.insert(format!("{pass:?}")));
        for pass in passes {
            let module = reflected(&key, pass);
            let bindings = module.bindings(pass.stem());
            assert!(!bindings.is_empty(), "{key} {}: no bindings", pass.label());
            modules.push((format!("{key} {}", pass.label()), module, bindings));
        }
    }
    let mut key = whole(Visibility::Split32, &[]);
    let naive = linked(&key, "baselines/naive", &[], false);
    key.vertices.is_single_draw = false;
    let variants = key.variants(Pass::Resolve);
    let hardware = linked(&key, "baselines/hardware", &variants, false);
    for (name, module, entries) in [
        ("naive", naive, "clear raster resolve"),
        (
            "hardware",
            hardware,
            "vertex painted_vertex fragment painted masked",
        ),
    ] {
        let entries = entries.split(' ').map(|entry| format!("{name}_{entry}"));
        let bindings = entries.flat_map(|entry| module.bindings(&entry)).collect();
        modules.push((name.into(), module, bindings));
    }
    modules
}

/// Bytes from one element to the next, where a binding is an array, and the name of its struct,
/// where it has one.
fn element(module: &Module, binding: u32) -> (Option<usize>, Option<String>) {
    let is_it = |v: &naga::GlobalVariable| v.binding.as_ref().is_some_and(|b| b.binding == binding);
    let mut variables = module.global_variables.iter();
    let (_, variable) = variables
        .find(|(_, v)| is_it(v))
        .expect("a binding is a variable");
    let (stride, ty) = match module.types[variable.ty].inner {
        TypeInner::Array { base, stride, .. } => (Some(stride as usize), base),
        _ => (None, variable.ty),
    };
    let ty = &module.types[ty];
    let is_struct = matches!(ty.inner, TypeInner::Struct { .. });
    (stride, ty.name.clone().filter(|_| is_struct))
}

#[test]
fn every_shared_struct_agrees_by_name_order_kind_offset_and_size() {
    let mut seen = BTreeSet::new();
    for (what, module, _) in modules() {
        for record in RECORDS {
            let Some((span, members)) = module.layout(record.wgsl) else {
                continue;
            };
            let wgsl = members
                .iter()
                .map(|m| (m.name.as_str(), m.offset, m.kind.as_str()));
            let rust = record.members.iter().map(|m| (m.name, m.offset, m.kind));
            let [wgsl, rust]: [Vec<_>; 2] = [wgsl.collect(), rust.collect()];
            assert_eq!(wgsl, rust, "{what}, {}: WGSL and Rust", record.wgsl);
            // A struct of vectors spans more than its members in WGSL.
            let is_same = span.abs_diff(record.size) < 16;
            assert!(
                is_same,
                "{what}, {}: {span} bytes and {}",
                record.wgsl, record.size
            );
            seen.insert(record.wgsl);
        }
    }
    let names = RECORDS.iter().map(|record| record.wgsl);
    let missing: Vec<_> = names.filter(|name| !seen.contains(name)).collect();
    assert!(missing.is_empty(), "no pass declares {missing:?}");
}

#[test]
fn every_binding_has_a_resource_and_every_bound_struct_is_shared() {
    let mut bound = BTreeSet::new();
    for (what, module, bindings) in modules() {
        for binding in bindings {
            let resource = ResourceId::of_binding(&binding.name);
            bound.extend(resource);
            assert!(
                resource.is_some(),
                "{what} binds {}, which crates/gpu/src/layout/resource_id.rs does not list",
                binding.name
            );
            let (stride, name) = element(&module.module, binding.index);
            // The parameters of effects are compared with the effects below.
            let Some(name) = name.filter(|name| name != "Effects") else {
                continue;
            };
            let record = RECORDS.iter().find(|record| record.wgsl == name);
            let record = record.unwrap_or_else(|| {
                panic!("{what} binds {name}, which crates/gpu/src/layout/records.rs does not list")
            });
            assert!(
                stride.is_none_or(|stride| stride == record.size),
                "{what}: {name} lies {stride:?} bytes apart, Rust has {}",
                record.size
            );
        }
    }
    // Kernels bind neither what is only copied nor, without an effect of a file, its pictures and
    // what it keeps, nor the rest of attributes that one binding holds.
    let idle = [
        "background",
        "previous",
        "image_files",
        "image_kept",
        "image_kept_before",
        "vertex_bytes_rest",
    ];
    let unbound = ResourceId::all()
        .filter(|id| !bound.contains(id))
        .map(ResourceId::name);
    let idle: Vec<_> = unbound.filter(|name| !idle.contains(name)).collect();
    assert!(idle.is_empty(), "no pass binds {idle:?}");
}

#[test]
fn every_effect_has_the_same_fields_on_both_sides() {
    for effect in EFFECTS.iter() {
        let reflected = reflected(&whole(Visibility::Split32, &[effect]), Pass::Resolve);
        let (_, members) = reflected
            .layout(&effect.wgsl_struct)
            .unwrap_or_else(|| panic!("no WGSL struct {}", effect.wgsl_struct));
        let wgsl = members.into_iter().map(|m| (m.name, m.offset, m.kind));
        let fields = effect.members();
        let declared = fields
            .iter()
            .map(|f| (f.name.to_owned(), f.offset, f.wgsl.name().to_owned()));
        assert_eq!(
            wgsl.collect::<Vec<_>>(),
            declared.collect::<Vec<_>>(),
            "{}: as naga lays it out, and as the reader of declarations does",
            effect.name
        );
        let last = fields.last().expect("an effect has fields");
        let end = last.offset / 4 + last.wgsl.words();
        assert!(
            (end..end + 4).contains(&effect.defaults.len()),
            "{}: padding at the end",
            effect.name
        );
    }
}
