//! Promise: every struct shared by Rust and WGSL agrees by name, order, kind and offset. Needs no adapter.

use rasterlab::{
    accuracy::Visibility,
    effects::{EFFECTS, Effect},
    gpu::culling::{CullingUniform, InstanceRecord, MeshletRecord},
    gpu::deforms::{DeformRecord, ShapeRecord},
    gpu::dots::{DotFrame, DotRunRecord},
    gpu::particle_readback::{ParticleStepUniform, StepParams},
    gpu::texels::{LookupRecord, MaterialRecord},
    gpu::uniforms::{CounterRecord, DrawRecord, FrameUniform, GpuRecord, LightUniform, ScalingUniform},
    shader::{
        Fetch, KernelKey, Pass,
        library::Library,
        link,
        pass::{CullPhase, RasterPhase},
        reflect::{self, Reflected},
    },
};

fn reflected(pass: Pass, effects: Vec<&'static Effect>) -> Reflected {
    let key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, effects);
    let linked = link::link(&Library::Embedded, &format!("passes/{}", pass.stem()), &key, &key.variants(pass)).expect("links");
    reflect::reflect(&linked, false).expect("validates")
}

fn check_twin<T: GpuRecord>(reflected: &Reflected) {
    let (span, members) = reflected.layout(T::WGSL).unwrap_or_else(|| panic!("no WGSL struct {}", T::WGSL));
    let wgsl: Vec<_> = members.iter().map(|m| (m.name.as_str(), m.offset)).collect();
    assert_eq!(wgsl, T::MEMBERS, "{}: WGSL on the left, Rust on the right", T::WGSL);
    assert!(span.abs_diff(size_of::<T>()) < 16, "{}: WGSL spans {span} bytes, Rust {}", T::WGSL, size_of::<T>());
}

#[test]
fn uniforms_and_records_agree() {
    let small = reflected(Pass::RasterSmall(RasterPhase::Depth), vec![]);
    check_twin::<FrameUniform>(&small);
    check_twin::<DrawRecord>(&small);
    check_twin::<CounterRecord>(&small);
    check_twin::<ScalingUniform>(&reflected(Pass::Scale, vec![]));
    let dots = reflected(Pass::DotsDraw, vec![]);
    check_twin::<DotFrame>(&dots);
    check_twin::<DotRunRecord>(&dots);
    check_twin::<LightUniform>(&reflected(Pass::Resolve, vec![&rasterlab::effects::shadow::EFFECT]));
    let skin = reflected(Pass::Skin, vec![]);
    check_twin::<DeformRecord>(&skin);
    check_twin::<ShapeRecord>(&skin);
    let cull = reflected(Pass::Cull(CullPhase::Late), vec![]);
    check_twin::<MeshletRecord>(&cull);
    check_twin::<InstanceRecord>(&cull);
    check_twin::<CullingUniform>(&cull);
    // Read word by word, in the order of their members.
    let resolve = reflected(Pass::Resolve, vec![]);
    check_twin::<LookupRecord>(&resolve);
    check_twin::<MaterialRecord>(&resolve);
    let particles = reflected(Pass::Particles, vec![]);
    check_twin::<ParticleStepUniform>(&particles);
    check_twin::<StepParams>(&particles);
}

#[test]
fn arrays_of_records_have_one_stride() {
    let (span, _) = reflected(Pass::Project, vec![]).layout("Draw").expect("there");
    assert_eq!(span, size_of::<DrawRecord>());
    let (span, _) = reflected(Pass::Particles, vec![]).layout("StepParams").expect("there");
    assert_eq!(span, size_of::<StepParams>());
}

#[test]
fn every_effect_has_the_same_fields_on_both_sides() {
    for effect in EFFECTS {
        let reflected = reflected(Pass::Resolve, vec![effect]);
        let (_, members) = reflected.layout(effect.wgsl_struct).unwrap_or_else(|| panic!("no WGSL struct {}", effect.wgsl_struct));
        let wgsl: Vec<_> = members.iter().map(|m| (m.name.as_str(), m.offset, m.kind.as_str())).collect();
        let rust: Vec<_> = effect.fields.iter().map(|f| (f.name, f.offset, f.wgsl.name())).collect();
        assert_eq!(wgsl, rust, "{}: WGSL on the left, Rust on the right", effect.name);
        let words = (effect.defaults)();
        let last = effect.fields.last().expect("an effect has fields");
        assert_eq!(words.len() * 4, last.offset + last.wgsl.words() * 4, "{}: padding at the end", effect.name);
    }
}

#[test]
fn defaults_lie_inside_their_hard_ranges() {
    for effect in EFFECTS {
        let mut words = (effect.defaults)();
        for field in effect.fields {
            let values = field.get(&words);
            field.set(&mut words, &values).unwrap_or_else(|error| panic!("{}: {error}", effect.name));
            assert!(
                field.soft[0] >= field.hard[0] && field.soft[1] <= field.hard[1],
                "{}.{}: soft range beyond hard",
                effect.name,
                field.name
            );
        }
    }
}
