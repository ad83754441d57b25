//! Checks that every loaded scene must pass, and what it draws.

use glam::DVec3;
use rasterlab::scene::{
    Instance, Scene,
    pose::{Motion, Pose},
};

use super::model::SQUARE;

/// Corners of every triangle in world space, in drawing order.
pub fn triangles(scene: &Scene) -> Vec<[[f64; 3]; 3]> {
    let of_instance = |instance: &Instance| {
        let primitive = &scene.primitives[instance.primitive];
        let corner = |vertex| {
            let position = primitive.position(scene, vertex).map(f64::from);
            instance
                .world_from_object
                .transform_point3(position.into())
                .to_array()
        };
        let count = primitive.triangle_count();
        (0..count)
            .map(|t| primitive.corners(scene, t).map(corner))
            .collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(of_instance).collect()
}

/// The square's two triangles, for comparison.
pub fn square() -> Vec<[[f64; 3]; 3]> {
    [[0, 1, 2], [0, 2, 3]]
        .map(|t| t.map(|c: usize| SQUARE[c].map(f64::from)))
        .into()
}

fn pose(scene: &Scene, clip: Option<usize>, time_s: f64) -> Pose {
    let motion = Motion {
        clip,
        time_s,
        ..Motion::default()
    };
    Pose::at(scene, &motion)
}

/// Everything that later stages take for granted: each accessor can be read to its end, and every
/// pose is finite.
pub fn assert_sound(scene: &Scene) {
    if !scene.rig.is_empty() {
        let clips = (0..scene.rig.clips.len()).map(Some).chain([None]);
        for (clip, time_s) in
            clips.flat_map(|clip| [0.0, 0.7, 1e9, -3.5].map(|time_s| (clip, time_s)))
        {
            let pose = pose(scene, clip, time_s);
            for i in 0..scene.instances.len() {
                assert!(!pose.instance_transform(i).is_nan());
                let deform = pose.deform(i);
                assert!(deform.is_none_or(|b| b.weights.iter().all(|w| w.is_finite())));
            }
        }
        let mut nodes = scene.rig.nodes.iter().enumerate();
        assert!(nodes.all(|(i, node)| node.parent.is_none_or(|parent| parent < i)));
    }
    assert!(
        scene.vertex_bytes.len().is_multiple_of(4) && scene.index_bytes.len().is_multiple_of(4)
    );
    for instance in &scene.instances {
        assert!(
            instance.primitive < scene.primitives.len() && instance.world_from_object.is_finite()
        );
    }
    for primitive in &scene.primitives {
        assert!(primitive.material < scene.materials.len());
        let deformation = &primitive.deformation;
        let shapes = deformation.morph_targets.iter();
        let shapes = shapes.flat_map(|shape| [shape.positions, shape.normals]);
        let held = deformation.influences.iter();
        let held = held.flat_map(|set| [Some(set.joints), Some(set.weights)]);
        let attributes = [
            Some(primitive.positions),
            Some(primitive.normals),
            primitive.colors,
        ];
        for accessor in attributes.into_iter().chain(shapes).chain(held).flatten() {
            assert_eq!(accessor.count, primitive.vertex_count());
            let width = accessor.component_type.bytes();
            assert!(accessor.offset % width == 0 && accessor.stride % width == 0);
            for vertex in 0..accessor.count {
                let is_finite = |component| {
                    accessor
                        .value(&scene.vertex_bytes, vertex, component)
                        .is_finite()
                };
                assert!((0..accessor.components).all(is_finite));
            }
        }
        let place = |vertex| DVec3::from(primitive.position(scene, vertex).map(f64::from));
        for p in (0..primitive.vertex_count()).map(place) {
            assert!(p.cmpge(primitive.bounds.min).all() && p.cmple(primitive.bounds.max).all());
        }
        for t in 0..primitive.triangle_count() {
            let corners = primitive.corners(scene, t);
            assert!(corners.iter().all(|&c| c < primitive.vertex_count()));
            let [a, b, c] = corners.map(place);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            assert!(longest <= primitive.longest_edge * (1.0 + 1e-12));
        }
    }
}

/// Corners of every triangle as a moment of a clip places and bends them.
pub fn posed(scene: &Scene, clip: Option<usize>, time_s: f64) -> Vec<[[f64; 3]; 3]> {
    let pose = pose(scene, clip, time_s);
    let of_instance = |(index, instance): (usize, &Instance)| {
        let primitive = &scene.primitives[instance.primitive];
        let corner = |vertex| {
            let object = match pose.deform(index) {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => primitive.position(scene, vertex).map(f64::from).into(),
            };
            pose.instance_transform(index)
                .transform_point3(object)
                .to_array()
        };
        let count = primitive.triangle_count();
        (0..count)
            .map(|t| primitive.corners(scene, t).map(corner))
            .collect::<Vec<_>>()
    };
    scene
        .instances
        .iter()
        .enumerate()
        .flat_map(of_instance)
        .collect()
}
