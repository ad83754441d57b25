//! Promise: an effect file can be saved as often as its author likes: what nobody uses any more is
//! given back. Effect, preset, undo steps and the picture of the oracle follow each save as in the
//! window; the text of the kernels is linked and not compiled.
#![cfg(target_os = "linux")]

use std::sync::{Arc, atomic::AtomicBool};

use rasterlab::{
    accuracy::Visibility,
    effect_files::{Catalog, crossings, precision},
    effects::{Effect, Stack},
    oracle,
    preset_file::{load_scene, parse_with},
    shader::{Fetch, KernelKey, Pass, library::Library, link},
};

use crate::process::resident_mb;

const SAVES: u32 = 2000;
/// Saves after which the memory is compared.
const FIRST_SAVES: u32 = 100;
const MOST_GROWTH_MB: f64 = 20.0;

const PRESET: &str = "schema = 2\n[scene]\nbuiltin = \"sphere?triangles=100\"\n[effects.ink]\namount = 0.5\n[effects.blot]\neffect = \"ink\"\n\
                      [animation.ink]\namount = [{ time_s = 0.0, value = 0.1 }, { time_s = 1.0, value = 0.9 }]\n";

/// The file as it is saved the time `turn`: every name, word and text of it is another, but for the
/// name of one parameter.
fn text(turn: u32) -> String {
    format!(
        "// Ink: paints with {turn}.\n//@ use lib/surface\nstruct Ink{turn} {{\n    /// How much of {turn}.\n    @range(0, 1, 0.7) @unit(u{turn}) amount: f32,\n    \
         /// In which way, {turn}.\n    @choice(plain, w{turn}) way_{turn}: u32,\n}}\n\
         fn mixed_{turn}(a: f32, b: f32) -> f32 {{\n    var sum = 0.0;\n    for (var i = 0u; i < 3u; i += 1u) {{ sum += sin(a * f32(i) + b); }}\n    return sum;\n}}\n\
         fn ink(surface: Surface, p: Ink{turn}) -> Surface {{\n    var s = surface;\n    \
         if p.way_{turn} == INK_WAY_{turn}_PLAIN {{ s.color.x = {turn}.0 * 0.0001; }}\n    \
         s.color = vec4f(mixed_{turn}(s.color.x, p.amount), p.amount, mixed_{turn}(s.normal.x, s.normal.y), 1.0);\n    return s;\n}}\n"
    )
}

/// Run by the next test in a process of its own, whose memory nothing else uses.
#[test]
#[ignore = "run by memory_stays_when_an_effect_is_saved_again_and_again"]
fn child_that_saves() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let save =
        |turn: u32| std::fs::write(folder.path().join("ink.wgsl"), text(turn)).expect("a file");
    save(0);
    let mut catalog = Catalog::of_folders([folder.path()]);
    let mut preset_file = parse_with(PRESET, "saved", "saved.toml", &catalog)
        .unwrap_or_else(|error| panic!("{error}"));
    catalog = preset_file.effects.clone();
    let scene = load_scene(&preset_file.preset, None).expect("a scene");
    let view = preset_file.preset.view(&scene, [16, 12]);
    let mut undo_steps = vec![preset_file.preset.clone(); 8];
    let mut first_mb = 0.0;
    for turn in 1..=SAVES {
        save(turn);
        let [ink, blot] = ["ink", "blot"].map(|name| {
            catalog
                .find(name)
                .expect("a good file")
                .expect("it is there")
                .clone()
        });
        let reread = catalog.reread([folder.path()]).joined(&catalog);
        let new = reread
            .find("ink")
            .unwrap_or_else(|error| panic!("{error}"))
            .expect("it is there")
            .clone();
        assert_ne!(ink, new, "the file was not read anew");
        let replaced = [(blot, Arc::new(Effect::instance("blot", &new))), (ink, new)];
        catalog = reread.replaced(&replaced);
        preset_file.rebind(&replaced, catalog.clone());
        undo_steps
            .iter_mut()
            .for_each(|step| step.rebind(&replaced));
        let stack = preset_file.preset.evaluated_stack();
        assert!(
            stack
                .0
                .iter()
                .all(|enabled| enabled.effect.about == format!("paints with {turn}")),
            "{stack:?}"
        );
        oracle::render(&scene, &view, &stack).expect("a picture");
        let key = KernelKey::complete(
            Fetch::Indexed,
            Visibility::Split32,
            stack
                .0
                .iter()
                .map(|enabled| enabled.effect.clone())
                .collect(),
        );
        link::link(
            &Library::Embedded,
            &Pass::Resolve.path(),
            &key,
            &key.variants(Pass::Resolve),
        )
        .expect("links");
        if turn % 4 == 0 {
            let draw = |stack: &Stack| drop(oracle::render(&scene, &view, stack));
            precision(&stack, &Arc::new(AtomicBool::new(false)), draw).expect("it is evaluated");
            crossings(&stack, draw).expect("it is evaluated");
        }
        if turn == FIRST_SAVES {
            first_mb = resident_mb();
        }
    }
    let last_mb = resident_mb();
    println!("{first_mb:.1} MB after {FIRST_SAVES} saves, {last_mb:.1} MB after {SAVES}");
    assert!(
        last_mb <= first_mb + MOST_GROWTH_MB,
        "{first_mb:.1} MB after {FIRST_SAVES} saves, {last_mb:.1} MB after {SAVES}"
    );
}

#[test]
fn memory_stays_when_an_effect_is_saved_again_and_again() {
    // One arena: what is free in others would be counted as used.
    let child = std::process::Command::new(std::env::current_exe().expect("this test"))
        .args([
            "--exact",
            "effect_files::saved::child_that_saves",
            "--ignored",
            "--nocapture",
        ])
        .env("MALLOC_ARENA_MAX", "1")
        .output()
        .expect("the child starts");
    let said = String::from_utf8_lossy(&child.stdout).into_owned()
        + &String::from_utf8_lossy(&child.stderr);
    assert!(
        child.status.success() && said.contains("MB after 2000"),
        "{said}"
    );
}
