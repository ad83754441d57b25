//! Promise: textures of normals and of how materials reflect appear as in the oracle's pictures,
//! whichever way a surface is turned, and cost nothing where no effect reads them.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use rasterlab::{
    gpu::Renderer,
    measure::compare,
    oracle,
    scene::{
        Scene,
        material::Material,
        texture::{Image, Texture},
        view::View,
    },
};

use crate::common::*;

const SIZE: [u32; 2] = [160, 100];

/// The golf balls from near.
fn balls(change: impl FnOnce(&mut Scene)) -> (Arc<Scene>, View) {
    let mut golf = scene("golf?tess=5").as_ref().clone();
    change(&mut golf);
    let view = view(&golf, SIZE);
    (Arc::new(golf), view)
}

fn maps_look_as_in_the_oracle_on_mirrored_sheared_faceted_and_moved_surfaces_and_from_behind(
    reach: Reach,
) {
    let Some(mut renderer) = loan() else { return };
    let place = |scene: &mut Scene, matrix: DMat4| {
        for instance in &mut scene.instances {
            instance.world_from_object *= matrix;
        }
    };
    let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let shear = DMat4::from_cols_array(&[
        1.0, 0.3, 0.0, 0.0, 0.0, 0.7, 0.0, 0.0, 0.2, 0.0, 1.2, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]);
    let behind = |scene: &mut Scene| {
        // Nearer halves are left out, so that the inside is seen.
        scene
            .materials
            .iter_mut()
            .for_each(|m| m.double_sided = true);
        place(scene, DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)));
        for primitive in &mut scene.primitives {
            let indices = primitive.indices.as_mut().expect("a list of triangles");
            indices.count /= 2;
        }
    };
    type Change<'a> = &'a dyn Fn(&mut Scene);
    let cases: [(&str, &[&str], Change); 5] = [
        ("mirrored", &["studio"], &|scene| place(scene, mirror)),
        ("sheared", &["lambert"], &|scene| place(scene, shear)),
        ("faceted", &["normals"], &|scene| {
            scene.primitives.iter_mut().for_each(|primitive| {
                (primitive.is_faceted, primitive.normals_agree) = (true, false);
            });
        }),
        ("from behind", &["toon"], &behind),
        ("moved", &["wobble", "studio"], &|_| {}),
    ];
    let option = pinned(quick_option(&renderer));
    for (what, effects, change) in reach.of(2, cases) {
        let (scene, view) = balls(change);
        renderer.exact(&scene, &view, &stack(effects), &option, what);
    }
}

/// The golf balls without their maps, which `change` then gives others.
fn changed(change: impl Fn(&mut Material)) -> Vec<[u8; 4]> {
    let (scene, view) = balls(|scene| {
        let constant = |texel| Image::new("even", [1, 1], vec![texel]).of_data();
        scene.images = vec![constant([128, 128, 255, 255]), constant([9, 102, 51, 255])];
        for material in &mut scene.materials {
            material.finish_texture = None;
            material.occlusion_texture = None;
            material.normal_texture = None;
            change(material);
        }
    });
    let picture = oracle::render(&scene, &view, &stack(&["studio"]));
    picture.expect("it fits").color
}

#[test]
fn a_flat_map_of_normals_changes_nothing_and_an_even_map_is_a_factor() {
    let plain = changed(|_| {});
    let flat = changed(|material| material.normal_texture = Some(Texture::plain(0)));
    // Bytes have no middle: 128 leans by a quarter of a degree.
    let beyond = compare::pictures(&flat, &plain, 2).pixels_over_tolerance;
    assert!(beyond < plain.len() as u64 / 400, "{beyond} pixels");
    let factors = changed(|material| {
        material.roughness *= 102.0 / 255.0;
        material.metallic *= 51.0 / 255.0;
    });
    let even = changed(|material| material.finish_texture = Some(Texture::plain(1)));
    assert_eq!(
        compare::pictures(&even, &factors, 1).pixels_over_tolerance,
        0
    );
    assert!(compare::pictures(&even, &plain, 8).pixels_over_tolerance > 1000);
    let dark = changed(|material| {
        material.occlusion_texture = Some(Texture::plain(1));
        material.occlusion_strength = 0.0;
    });
    assert_eq!(dark, plain, "an occlusion that does not count");
}

#[test]
fn maps_are_in_the_kernel_only_where_an_effect_reads_them() {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = balls(|_| {});
    let option = pinned(quick_option(&renderer));
    let mut maps = |effects: &[&str]| {
        renderer.judged(&scene, &view, &stack(effects), &option);
        let surface = &renderer.key().expect("something was drawn").surface;
        (
            surface.has_material_atlas,
            surface.has_finish_maps,
            surface.has_normal_maps,
        )
    };
    assert_eq!(maps(&["depth"]), (false, false, false));
    assert_eq!(maps(&["lambert"]), (true, false, true));
    assert_eq!(maps(&["studio"]), (true, true, true));
}

fn mistakes_in_maps_are_caught(reach: Reach) {
    let Some(healthy) = loan() else {
        return;
    };
    let (scene, view) = balls(|_| {});
    let (stack, option) = (stack(&["studio"]), pinned(quick_option(&healthy)));
    let mistakes = [
        (
            "s.finish.metallic *= texel.b;",
            "s.finish.metallic *= texel.g;",
        ),
        (
            "select(tangent.w, -tangent.w, is_mirrored)",
            "select(-tangent.w, tangent.w, is_mirrored)",
        ),
    ];
    for (from, to) in reach.of(1, mistakes) {
        let library = mutated(from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        let (_, verdict) = wrong.judged(&scene, &view, &stack, &option);
        assert!(exactness(&verdict.report).is_err(), "{to}");
    }
}

few_and_all!(
    maps_look_as_in_the_oracle_on_mirrored_sheared_faceted_and_moved_surfaces_and_from_behind,
    mistakes_in_maps_are_caught,
);
