//! Tangents: which way along a surface the texture of its normals lies.
//!
//! They are those of the file, or as MikkTSpace makes them. Each corner of a triangle has its own, in
//! terms of the two edges from the triangle's first corner: so they follow the corners wherever
//! joints, morph targets and transforms put them, and no pass has to move them. Seen along the corner's normal,
//! `along[0] * (b - a) + along[1] * (c - a)` is the tangent. The third component, -1 or 1, tells to
//! which side of normal and tangent the image rises; it is the same at all corners of a triangle.

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{DVec2, DVec3};

use super::{
    accessor::Accessor,
    bounds::MAX_MAGNITUDE,
    material::TextureSlot,
    model::{Primitive, Scene},
    texture::{Texture, texcoord},
};

/// A triangle whose edges are parallel to within this, squared, has no tangents.
const PARALLEL: f64 = 1e-12;
/// Smallest cosine between a corner's normal and its triangle's for which the tangent is seen along
/// the former.
const LEAST_COSINE: f64 = 0.05;
/// Largest factor of an edge that is stored.
const LARGEST: f64 = 1e30;

/// The tangents of a primitive, three for each triangle in order, as [the module](self) says.
/// `texture` is that of its normals; `given` are those of the file, four components for each vertex.
pub fn of(
    scene: &Scene,
    primitive: &Primitive,
    texture: &Texture,
    given: Option<&Accessor>,
) -> Vec<[f32; 3]> {
    let corners = Corners {
        scene,
        primitive,
        texture,
    };
    let count = primitive.triangle_count();
    let mut tangents = match given {
        Some(given) if !primitive.is_faceted => (0..count)
            .flat_map(|triangle| primitive.corners(scene, triangle))
            .map(|vertex| {
                let [x, y, z, side] =
                    [0, 1, 2, 3].map(|c| given.value(&scene.vertex_bytes, vertex, c));
                (DVec3::new(x, y, z), if side < 0.0 { -1.0 } else { 1.0 })
            })
            .collect(),
        _ => {
            let mut made = Made {
                corners: &corners,
                tangents: vec![(DVec3::ZERO, 1.0); 3 * count as usize],
            };
            // It has no error yet; after one, surfaces would keep their own normals.
            if generate_tangents::<_, Libm>(&mut made).is_err() {
                made.tangents.fill((DVec3::ZERO, 1.0));
            }
            made.tangents
        }
    };
    for (triangle, of_triangle) in (0..count).zip(tangents.as_chunks_mut::<3>().0) {
        let side = of_triangle[0].1;
        of_triangle.iter_mut().for_each(|corner| corner.1 = side);
        let [a, b, c] = [0, 1, 2].map(|k| corners.position(triangle, k));
        for (k, corner) in (0..3).zip(of_triangle) {
            corner.0 = along([b - a, c - a], corners.normal(triangle, k), corner.0);
        }
    }
    tangents
        .into_iter()
        .map(|(along, side)| [along.x as f32, along.y as f32, side as f32])
        .collect()
}

/// Adds tangents to a primitive of a scene without a file.
pub fn add(scene: &mut Scene, primitive: usize, texture: &Texture) {
    let tangents = of(scene, &scene.primitives[primitive], texture, None);
    let at = scene.vertex_bytes.len();
    scene
        .vertex_bytes
        .extend_from_slice(bytemuck::cast_slice(&tangents));
    scene.primitives[primitive].tangents = Some(Accessor::packed_f32(at, 3, tangents.len()));
}

/// The factors of two edges whose sum, seen along `normal`, is `tangent`; zero where there are none.
fn along([ab, ac]: [DVec3; 2], normal: DVec3, tangent: DVec3) -> DVec3 {
    let plane = ab.cross(ac);
    let is_sliver = plane.length_squared() < PARALLEL * ab.length_squared() * ac.length_squared();
    let (Some(plane), Some(tangent), false) =
        (plane.try_normalize(), tangent.try_normalize(), is_sliver)
    else {
        return DVec3::ZERO;
    };
    let normal = match normal.try_normalize() {
        Some(normal) if normal.dot(plane).abs() > LEAST_COSINE => normal,
        _ => plane,
    };
    let volume = normal.dot(ab.cross(ac));
    let factors = DVec3::new(
        tangent.dot(ac.cross(normal)) / volume,
        tangent.dot(normal.cross(ab)) / volume,
        0.0,
    );
    if factors.abs().max_element() < LARGEST {
        factors
    } else {
        DVec3::ZERO
    }
}

/// What is known of the corners of a primitive.
struct Corners<'a> {
    scene: &'a Scene,
    primitive: &'a Primitive,
    texture: &'a Texture,
}

impl Corners<'_> {
    fn vertex(&self, triangle: u32, corner: usize) -> u32 {
        self.primitive.corners(self.scene, triangle)[corner]
    }

    /// In object space; the origin for a vertex that is never drawn.
    fn position(&self, triangle: u32, corner: usize) -> DVec3 {
        let vertex = self.vertex(triangle, corner);
        let position = DVec3::from(self.primitive.position(self.scene, vertex).map(f64::from));
        if position.is_finite() && position.abs().max_element() < MAX_MAGNITUDE {
            position
        } else {
            DVec3::ZERO
        }
    }

    /// A unit vector in object space; zero where there is none.
    fn normal(&self, triangle: u32, corner: usize) -> DVec3 {
        if self.primitive.is_faceted {
            let [a, b, c] = [0, 1, 2].map(|k| self.position(triangle, k));
            return (b - a).cross(c - a).normalize_or_zero();
        }
        let vertex = self.vertex(triangle, corner);
        let normals = &self.primitive.normals;
        DVec3::from(normals.vector(&self.scene.vertex_bytes, vertex)).normalize_or_zero()
    }

    /// Where it lies in the image.
    fn place(&self, triangle: u32, corner: usize) -> DVec2 {
        let texcoords = self.primitive.texcoords[TextureSlot::Normal as usize];
        texcoords.map_or(DVec2::ZERO, |texcoords| {
            let vertex = self.vertex(triangle, corner);
            let stored = texcoord(&texcoords, &self.scene.vertex_bytes, vertex);
            self.texture.image_coordinates(stored)
        })
    }
}

/// The same on every machine.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    fn acos(x: f32) -> f32 {
        libm::acos(x.into()) as f32
    }
}

/// Tangents that MikkTSpace makes: each with its side.
struct Made<'a> {
    corners: &'a Corners<'a>,
    tangents: Vec<(DVec3, f64)>,
}

impl Geometry<Libm> for Made<'_> {
    fn num_faces(&self) -> usize {
        self.tangents.len() / 3
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.corners.position(face as u32, corner).as_vec3().into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.corners.normal(face as u32, corner).as_vec3().into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.corners.place(face as u32, corner).as_vec2().into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        // Images of glTF grow downwards, while their normals count upwards.
        if let Some(space) = space {
            let tangent = DVec3::from(space.tangent().map(f64::from));
            let side = if space.is_orientation_preserving() {
                -1.0
            } else {
                1.0
            };
            self.tangents[3 * face + corner] = (tangent, side);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{material::Material, mesh_builder::MeshBuilder};

    /// A square that faces +z, whose image is mapped by `place` from a corner's x and y.
    fn square(place: impl Fn(f64, f64) -> [f64; 2]) -> Scene {
        let mut scene = Scene::default();
        scene.materials.push(Material {
            normal_texture: Some(Texture::plain(0)),
            ..Material::default()
        });
        let mut mesh = MeshBuilder::default();
        for (x, y) in [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)] {
            mesh.textured_vertex(DVec3::new(x, y, 0.0), DVec3::Z, place(x, y));
        }
        mesh.triangle([0, 1, 2]);
        mesh.triangle([0, 2, 3]);
        mesh.append(&mut scene, "square", 0);
        scene
    }

    #[test]
    fn tangents_point_along_the_image_and_normals_count_upwards_in_it() {
        type Case = (fn(f64, f64) -> [f64; 2], DVec3, DVec3);
        let cases: [Case; 4] = [
            (|x, y| [x, -y], DVec3::X, DVec3::Y),
            (|x, y| [-x, -y], DVec3::NEG_X, DVec3::Y),
            (|x, y| [x, y], DVec3::X, DVec3::NEG_Y),
            (|x, y| [y, x], DVec3::Y, DVec3::NEG_X),
        ];
        for (place, right, up) in cases {
            let scene = square(place);
            let primitive = &scene.primitives[0];
            let stored = primitive.tangents.expect("a normal map");
            assert_eq!(stored.count, 6);
            for triangle in 0..2 {
                let [a, b, c] = primitive
                    .corners(&scene, triangle)
                    .map(|v| DVec3::from(primitive.position(&scene, v).map(f64::from)));
                for k in 0..3 {
                    let [x, y, side] = stored.vector(&scene.vertex_bytes, 3 * triangle + k);
                    let tangent = (b - a) * x + (c - a) * y;
                    assert!((tangent - right).length() < 1e-6, "{tangent} for {right}");
                    assert!((DVec3::Z.cross(tangent) * side - up).length() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn a_sliver_and_a_corner_whose_normal_lies_in_its_plane_do_no_harm() {
        assert_eq!(along([DVec3::X, DVec3::X], DVec3::Z, DVec3::X), DVec3::ZERO);
        assert_eq!(
            along([DVec3::X, DVec3::Y], DVec3::Z, DVec3::ZERO),
            DVec3::ZERO
        );
        let flat = along([DVec3::X * 2.0, DVec3::Y], DVec3::Y, DVec3::X);
        assert!((flat - DVec3::new(0.5, 0.0, 0.0)).length() < 1e-12);
    }
}
