// Meshlets: patches of meshes, with bounds in object space. Mirror of `gpu::culling::MeshletRecord`.

struct Meshlet {
    center: vec4f,        // middle of a box round it. w: cosine of the angle that its normals stay within
    half: vec4f,          // half the box's sides. w: sine of that angle
    axis: vec4f,          // middle of its normals. w: least altitude of a triangle; 0: facing tells nothing
    first_triangle: u32,  // words of `meshlet_lists`
    first_vertex: u32,
    triangles: u32,
    vertices: u32,
}

@group(0) @binding(24) var<storage, read> meshlets: array<Meshlet>;
