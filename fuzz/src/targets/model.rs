//! glTF and GLB models: read, posed, planned, and where they are small drawn by the oracle.

use rasterlab::{
    oracle,
    plan::{Caps, Planner},
    preset::{Preset, SceneSource},
    preset_file::PresetFile,
    scene::{
        Scene,
        draw::{draws, totals},
        gltf::{self, LoadError},
        meshlets::Meshlets,
        needs::Needs,
        parts::parts,
    },
};

use super::{Outcome, Target, assert_told};
use crate::{guard::Limit, views};

pub const TARGET: Target = Target {
    name: "model",
    about: "glTF and GLB models",
    views: &[views::GLB_JSON, views::GLB_JSON, views::GLB_BINARY],
    limit: Limit::new(20, 2048),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    use_scene(&read(bytes).map_err(|error| error.to_string())?);
    Ok(())
}

/// The model; the files that it refers to are not there.
pub fn read(bytes: &[u8]) -> Result<Scene, LoadError> {
    gltf::load(bytes, &mut |_, _| Err(LoadError::new("no files here")))
}

/// Everything that a model goes through until it is drawn.
pub fn use_scene(scene: &Scene) {
    scene
        .notes
        .iter()
        .chain(&scene.faults)
        .for_each(|note| assert_told(note));
    parts(scene);
    let mut preset = PresetFile::of_scene("fuzz", SceneSource::File("fuzz.glb".into())).preset;
    let clips = scene.rig.clips.iter().map(|clip| clip.name.clone()).take(2);
    for clip in [String::new()].into_iter().chain(clips) {
        preset.playback.clip = clip;
        for time_s in [0.0, 0.7, -3.5, 1e9] {
            preset.clock.time_s = time_s;
            let view = preset.view(scene, [16, 12]);
            let Ok(all) = draws(scene, &view) else { return };
            let needs = Needs::of(scene, &all, &view).into();
            let caps = Caps::ALL;
            let _ = Planner::default().plan(
                &needs,
                &preset.stack_on(scene, [16, 12]),
                &caps,
                &caps.tuning(),
                &preset.accuracy,
            );
            let [vertices, triangles] = totals(scene, &all);
            if vertices + triangles < 3_000 && scene.instances.len() < 200 {
                draw(&preset, scene);
            }
        }
    }
    scene
        .primitives
        .iter()
        .filter(|primitive| primitive.triangle_count() < 3_000)
        .for_each(|primitive| {
            Meshlets::of(scene, primitive);
        });
}

fn draw(preset: &Preset, scene: &Scene) {
    if let Err(error) = oracle::render_scaled(scene, &preset.moments(scene, [16, 12]), 1.0) {
        assert_told(&error.to_string());
    }
}
