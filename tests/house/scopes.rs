//! Promise: effects with a scope are called where their draw has the scope's bit, and text without
//! scopes reads no bits. Needs no adapter.

use std::sync::Arc;

use rasterlab::{
    accuracy::Visibility,
    effects::{EFFECTS, Effect},
    shader::{Fetch, KernelKey, Pass, library::Library, link},
};

use super::shaders::all_passes;

fn key(names: &[&str], scope_bits: &[Option<u32>]) -> KernelKey {
    let effects = names
        .iter()
        .map(|name| Effect::find(name).expect("a listed effect").clone())
        .collect();
    let mut key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, effects);
    key.effects.scope_bits = scope_bits.to_vec();
    key
}

fn text(key: &KernelKey, pass: Pass) -> String {
    link::link(&Library::Embedded, &pass.path(), key, &key.variants(pass))
        .expect("links")
        .text
}

#[test]
fn text_without_scopes_reads_no_bits() {
    let mut stacks: Vec<Vec<Arc<Effect>>> =
        EFFECTS.iter().map(|effect| vec![effect.clone()]).collect();
    stacks.extend([
        vec![],
        EFFECTS
            .iter()
            .filter(|&effect| effect.hooks.slot.is_none())
            .cloned()
            .collect(),
    ]);
    for effects in stacks {
        let key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, effects);
        for pass in all_passes(&key) {
            let text = text(&key, pass);
            let code = text
                .lines()
                .map(|line| line.split("//").next().unwrap_or_default());
            let bad = code
                .into_iter()
                .find(|line| line.contains("scopes") && line.trim() != "scopes: u32,");
            assert_eq!(bad, None, "{} of {key}", pass.label());
        }
    }
}

/// Each scoped call is the call of the text without scopes, inside a test of its own bit.
#[test]
fn scopes_add_tests_of_bits_and_nothing_else() {
    let names = [
        "explode", "wobble", "dissolve", "stipple", "facet", "toon", "fog",
    ];
    let plain = key(&names, &[]);
    let scoped = key(
        &names,
        &[Some(0), None, Some(1), Some(2), None, Some(3), Some(4)],
    );
    let mut tested = 0;
    for pass in all_passes(&plain) {
        let with = text(&scoped, pass);
        let mut lines = Vec::new();
        let mut is_inside = false;
        for line in with.lines() {
            match line {
                "    let scopes = draws[draw].scopes;" => {}
                line if line.starts_with("    if (scopes & ") => {
                    (is_inside, tested) = (true, tested + 1)
                }
                "    }" if is_inside => is_inside = false,
                line => lines.push(line),
            }
        }
        assert_eq!(
            lines.join("\n"),
            text(&plain, pass).lines().collect::<Vec<_>>().join("\n"),
            "{}",
            pass.label()
        );
        for (call, bit) in [
            ("v = explode(", 1u32),
            ("if !dissolve_sample(", 2),
            ("if !stipple(", 4),
            ("s = toon(", 8),
            ("s = fog(", 16),
        ] {
            for (before, line) in with
                .lines()
                .zip(with.lines().skip(1))
                .filter(|(_, line)| line.trim_start().starts_with(call))
            {
                let loads = line.contains("dissolve");
                let is_own = before == format!("    if (scopes & {bit}u) != 0u {{");
                assert!(
                    is_own || loads && before.contains("sample_setup_load"),
                    "{}: {before} {line}",
                    pass.label()
                );
            }
        }
    }
    assert!(tested > 10, "{tested}");
    assert_ne!(plain, scoped);
    assert!(
        scoped.to_string().contains("+toon@3")
            && scoped.to_string().contains("+facet +")
            && !plain.to_string().contains('@'),
        "{scoped}"
    );
}
