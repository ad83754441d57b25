//! Promise: the hardware baseline of `bench` draws what the oracle draws, but for edges and a few
//! steps of color: textures, masks, skins, morph targets, instances, vertex colors, and attributes
//! and index lists of every format. Needs an adapter.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use pollster::FutureExt as _;
use rasterlab::{
    frame::{Frame, NO_TRIANGLE},
    gpu::hardware::Hardware,
    scene::{Accessor, ComponentType, Scene, Topology, view::View},
};

use crate::common::*;

const SIZE: [u32; 2] = [200, 150];

/// Largest difference of a channel beyond all that the oracle has in a pixel and its neighbors, of
/// 255: filters of adapters are coarser than the oracle's.
const STEPS: u8 = 6;

/// Pixels of a thousand that may differ by more: those where an edge crosses a fine texture.
const STRAYS: f64 = 1.0;

/// Largest root mean square of all differences, of 255.
const RMS: f64 = 2.0;

/// The baseline's picture of a scene, the oracle's, and the number of its draw calls.
fn pictures(scene: &Arc<Scene>, view: &View) -> Option<(Vec<[u8; 4]>, Frame, usize)> {
    let mut renderer = loan()?;
    let stack = stack(&["lambert"]);
    let option = quick_option(&renderer);
    let (_, verdict) = renderer.judged(scene, view, &stack, &pinned(option));
    let (gpu, key) = (renderer.gpu(), renderer.key().expect("something was drawn"));
    let hardware = Hardware::new(gpu, scene, view, &stack, key)
        .block_on()
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let hardware = hardware.unwrap_or_else(|reason| panic!("{}: {reason}", scene.name));
    let picture = hardware
        .picture(gpu)
        .block_on()
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    Some((picture, verdict.expected, hardware.call_count()))
}

/// Insists that both pictures are alike, and returns the number of draw calls; none without an
/// adapter.
fn alike(scene: &Arc<Scene>, view: &View) -> Option<usize> {
    let (picture, expected, calls) = pictures(scene, view)?;
    let [width, height] = [view.width, view.height].map(|side| side as usize);
    let (mut strays, mut squares, mut both) = (0, 0.0, 0);
    for (at, drawn) in picture.iter().enumerate() {
        let (x, y) = (at % width, at / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        let near: Vec<usize> = rows
            .flat_map(|y| {
                (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| y * width + x)
            })
            .collect();
        let is_owned = |at: usize| expected.triangle_id[at] != NO_TRIANGLE;
        let is_like = if drawn[3] == 0 {
            near.iter().any(|&at| !is_owned(at))
        } else {
            let colors: Vec<[u8; 4]> = near
                .iter()
                .filter(|&&at| is_owned(at))
                .map(|&at| expected.color[at])
                .collect();
            let fits = |channel: usize| {
                let values = || colors.iter().map(|color| color[channel]);
                let (low, high) = (values().min().unwrap_or(255), values().max().unwrap_or(0));
                (low.saturating_sub(STEPS)..=high.saturating_add(STEPS)).contains(&drawn[channel])
            };
            (0..3).all(fits)
        };
        strays += usize::from(!is_like);
        if is_owned(at) && drawn[3] != 0 {
            both += 3;
            squares += (0..3)
                .map(|c| f64::from(drawn[c].abs_diff(expected.color[at][c])).powi(2))
                .sum::<f64>();
        }
    }
    let covered = expected
        .triangle_id
        .iter()
        .filter(|id| **id != NO_TRIANGLE)
        .count();
    assert!(
        covered > width * height / 200,
        "{} shows nothing",
        scene.name
    );
    let (rms, share) = (
        (squares / f64::from(both.max(1))).sqrt(),
        1000.0 * strays as f64 / (width * height) as f64,
    );
    println!(
        "{}: {calls} calls, {strays} strays ({share:.2} of 1000), rms {rms:.3}",
        scene.name
    );
    assert!(
        share <= STRAYS && rms <= RMS,
        "{}: {share:.2} pixels of 1000 differ by more than {STEPS}; rms {rms:.3}",
        scene.name
    );
    Some(calls)
}

fn alike_with_own_view(query: &str) -> Option<usize> {
    let scene = scene(query);
    alike(&scene, &view(&scene, SIZE))
}

#[test]
fn textures_emission_and_unlit_materials_look_as_in_the_oracle() {
    for query in ["globe?tess=6", "panels"] {
        alike_with_own_view(query);
    }
}

#[test]
fn masks_cut_the_same_holes() {
    alike_with_own_view("leaves?n=40");
}

#[test]
fn skins_and_morph_targets_bend_meshes_alike() {
    for query in DEFORMED_SCENES {
        alike_with_own_view(query);
    }
}

#[test]
fn vertex_colors_and_several_materials_look_as_in_the_oracle() {
    for query in GALLERY_SCENES {
        alike_with_own_view(query);
    }
}

#[test]
fn many_nodes_with_one_mesh_are_one_draw_call() {
    let Some(calls) = alike_with_own_view("field?count=27&triangles=200") else {
        return;
    };
    // Its three materials are base colors, which a draw's record holds.
    assert_eq!(calls, 1);
}

#[test]
fn mirrored_and_double_sided_meshes_show_the_right_faces() {
    let mut mirrored = (*scene("sphere?triangles=200")).clone();
    mirrored.name = "mirrored".into();
    mirrored.primitives.push(mirrored.primitives[0].clone());
    mirrored
        .materials
        .push(mirrored.materials[mirrored.primitives[0].material].clone());
    mirrored
        .materials
        .last_mut()
        .expect("a material")
        .double_sided = true;
    mirrored.primitives[1].material = mirrored.materials.len() - 1;
    mirrored.instances[0].world_from_object *= DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mut beside = mirrored.instances[0].clone();
    beside.primitive = 1;
    beside.world_from_object =
        DMat4::from_translation(DVec3::new(0.7, 0.2, 0.1)) * beside.world_from_object;
    mirrored.instances.push(beside);
    let view = view(&scene("sphere?triangles=200"), SIZE);
    assert!(alike(&Arc::new(mirrored), &view).is_none_or(|calls| calls == 2));
}

/// Appends numbers and describes them.
fn appended(
    bytes: &mut Vec<u8>,
    numbers: &[u8],
    component_type: ComponentType,
    components: u32,
) -> Accessor {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let (offset, size) = (bytes.len() as u32, component_type.bytes());
    bytes.extend(numbers);
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let count = numbers.len() as u32 / (size * components);
    Accessor {
        offset,
        stride: size * components,
        component_type,
        components,
        normalized: size < 4,
        count,
    }
}

#[test]
fn strips_fans_small_indices_and_quantized_attributes_are_drawn() {
    let base = scene("sphere?triangles=200");
    let view = view(&base, SIZE);
    let primitive = &base.primitives[0];
    let normals: Vec<[f64; 3]> = (0..primitive.vertex_count())
        .map(|v| primitive.normals.vector(&base.vertex_bytes, v))
        .collect();
    let bytes: Vec<u8> = normals
        .iter()
        .flat_map(|n| [n[0], n[1], n[2], 0.0])
        .map(|v| (v * 127.0).round() as i8 as u8)
        .collect();
    let corners: Vec<u32> = (0..primitive.triangle_count())
        .flat_map(|t| primitive.corners(&base, t))
        .collect();
    let toward_eye = |&vertex: &u32| DVec3::from(normals[vertex as usize]).dot(view.eye);
    let hub = (0..primitive.vertex_count())
        .max_by(|a, b| toward_eye(a).total_cmp(&toward_eye(b)))
        .expect("a vertex");
    for topology in [Topology::List, Topology::Strip, Topology::Fan] {
        let mut odd = (*base).clone();
        odd.name = format!("{topology:?} of u8");
        // Four bytes to a vertex, of which three are read.
        let mut quantized = appended(&mut odd.vertex_bytes, &bytes, ComponentType::I8, 4);
        quantized.components = 3;
        odd.primitives[0].normals = quantized;
        odd.primitives[0].topology = topology;
        odd.primitives[0].normals_agree = false;
        let list: Vec<u8> = match topology {
            Topology::List => corners.clone(),
            // Triangles without area join those of the list.
            Topology::Strip => corners
                .chunks(3)
                .flat_map(|t| [t[0], t[0], t[0], t[1], t[2], t[2]])
                .collect(),
            // The ring around the vertex that faces the eye.
            Topology::Fan => ring(&corners, hub),
            Topology::Points | Topology::Lines => unreachable!("lists of triangles"),
        }
        .iter()
        .map(|&corner| u8::try_from(corner).expect("few vertices"))
        .collect();
        let mut indices = appended(&mut odd.index_bytes, &list, ComponentType::U8, 1);
        indices.normalized = false;
        odd.primitives[0].indices = Some(indices);
        if topology == Topology::Fan {
            odd.materials[odd.primitives[0].material].double_sided = true;
        }
        alike(&Arc::new(odd), &view);
    }
}

/// A fan: a vertex, and those that share a triangle with it, one after another.
fn ring(corners: &[u32], hub: u32) -> Vec<u32> {
    let mut spokes: Vec<(u32, u32)> = corners
        .chunks(3)
        .filter_map(|t| {
            t.iter()
                .position(|&corner| corner == hub)
                .map(|at| (t[(at + 1) % 3], t[(at + 2) % 3]))
        })
        .collect();
    let (first, mut end) = spokes.remove(0);
    let mut fan = vec![hub, first, end];
    while let Some(next) = spokes.iter().position(|spoke| spoke.0 == end) {
        end = spokes.remove(next).1;
        fan.push(end);
    }
    fan
}
