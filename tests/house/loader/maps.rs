//! Promise: the textures that are no colors load as the standard defines them, with tangents of the
//! file or our own.

use glam::DVec3;
use rasterlab::scene::{
    Scene,
    material::{Material, TextureSlot},
};

use super::model::*;

/// The square with all five textures of one image.
fn mapped() -> Model {
    Model::textured().set(
        r#"
        M/pbrMetallicRoughness/metallicRoughnessTexture {"index":0}
        M/occlusionTexture {"index":0,"strength":0.25}
        M/normalTexture {"index":0,"scale":-2}
        M/emissiveTexture {"index":0}
        M/emissiveFactor [1,1,1]
        "#,
    )
}

/// Tangents of the corners in object space, and their sides.
fn tangents(scene: &Scene) -> Vec<(DVec3, f64)> {
    let primitive = &scene.primitives[0];
    let stored = primitive.tangents.expect("a texture of normals");
    assert_eq!(stored.count, 3 * primitive.triangle_count());
    let tangent = |corner| {
        let place = |v| DVec3::from(primitive.position(scene, v).map(f64::from));
        let [a, b, c] = primitive.corners(scene, corner / 3).map(place);
        let [x, y, side] = stored.vector(&scene.vertex_bytes, corner);
        ((b - a) * x + (c - a) * y, side)
    };
    (0..stored.count).map(tangent).collect()
}

#[test]
fn data_is_an_image_of_its_own_that_is_averaged_as_numbers() {
    let scene = mapped().silent();
    let material = &scene.materials[scene.primitives[0].material];
    let images = TextureSlot::ALL.map(|slot| material.texture(slot).map(|texture| texture.image));
    assert_eq!(images, [Some(0), Some(0), Some(1), Some(1), Some(1)]);
    assert_eq!(
        (material.occlusion_strength, material.normal_scale),
        (0.25, -2.0)
    );
    let [color, data] = [&scene.images[0], &scene.images[1]];
    assert!(!color.is_data && data.is_data);
    assert_eq!(color.levels[0], data.levels[0]);
    let [first, second] = [data.levels[0].texels[0], data.levels[0].texels[1]];
    let mean = [0, 1, 2, 3].map(|c| (u16::from(first[c]) + u16::from(second[c])).div_ceil(2) as u8);
    assert_eq!(data.levels[1].texels, [mean]);
    assert_ne!(
        color.levels[1].texels,
        [mean],
        "light is not averaged as bytes"
    );
}

#[test]
fn maps_have_sets_and_transforms_of_their_own_and_unlit_materials_none() {
    let model = mapped().set(
        r#"
        & VEC2 F32 0 1 0 0 1 0 1 1
        A/TEXCOORD_1 3
        M/normalTexture/texCoord 1
        M/occlusionTexture/extensions {"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,2]}}
        "#,
    );
    let scene = model.scene();
    let [base, _, _, occlusion, normal] = scene.primitives[0].texcoords;
    assert_eq!(base, occlusion);
    assert_ne!(base, normal);
    let material = &scene.materials[scene.primitives[0].material];
    let moved = material.occlusion_texture.expect("it has one");
    assert_eq!(
        moved.image_coordinates(glam::DVec2::ONE).to_array(),
        [2.5, 2.0]
    );
    // The other set is turned by a quarter: its u rises with the square's y.
    for (tangent, side) in tangents(&scene) {
        assert!((tangent - DVec3::Y).length() < 1e-6, "{tangent}");
        assert!((DVec3::Z.cross(tangent) * side - DVec3::X).length() < 1e-6 || side < 0.0);
    }
    let unlit = mapped()
        .set("M/extensions {\"KHR_materials_unlit\":{}}")
        .material();
    assert!(!unlit.has_finish_maps() && !unlit.has_normal_map());
    let lost = mapped()
        .set("M/normalTexture/texCoord 7")
        .dropped("mesh \"X\" primitive 0 TEXCOORD_7: it is missing, although a texture of the material uses it; the texture is left out");
    assert!(lost.primitives[0].tangents.is_none());
}

#[test]
fn tangents_of_the_file_are_kept_where_it_has_normals() {
    let mut model = mapped();
    model.floats("VEC4", &[0.6, 0.8, 0.0, -1.0].repeat(4));
    model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let is_as_given = |scene: &Scene| {
        let wanted = DVec3::new(0.6, 0.8, 0.0);
        let mut tangents = tangents(scene).into_iter();
        tangents.all(|(tangent, side)| (tangent - wanted).length() < 1e-6 && side == -1.0)
    };
    // Without normals of the file its tangents do not count.
    let model = model.set("A/TANGENT 3");
    assert!(!is_as_given(&model.scene()));
    assert!(is_as_given(&model.set("A/NORMAL 4").scene()));
    let wrong = mapped().set("& VEC3 F32 1 0 0 1 0 0 1 0 0 1 0 0\nA/TANGENT 3");
    let scene = wrong.dropped("mesh \"X\" primitive 0 TANGENT: accessor 3 has the type 3 x F32, which glTF does not allow for it");
    assert!(scene.primitives[0].tangents.is_some(), "our own");
}

#[test]
fn a_material_without_maps_needs_none() {
    let material = Model::textured().material();
    let wanted = Material {
        name: "paper".into(),
        base_texture: material.base_texture,
        metallic: 1.0,
        roughness: 1.0,
        ..Material::default()
    };
    assert_eq!(material, wanted);
}
