//! Small meshes: one of everything that the readers of OBJ, MTL, STL and PLY follow.

use crate::Seed;

const OBJ: &str = "mtllib a.mtl\nnewmtl red\nKd 1 0 0\nKe 0 0 1\nd 0.5\nmap_Kd -s 1 1 1 a.png\nmap_d a.png\no box\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.2 0.5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\ng lid of it\nusemtl red\ns 1\nf 1 2 3 4 5\nf 1/1/1 2/2/1 3/3/1\ns off\nf -1//-1 -2//1 \\\n-3//1\nl 1 2\n";
const STL: &str = "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\nsolid c\nfacet\nvertex 0 0 0 vertex 1 1 1 vertex 1 0 0 vertex 2 0 0 endfacet\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 0 0 1 255 0 0 0 0\n1 0 0 0 0 1 0 255 0 1 0\n1 1 0 0 0 1 0 0 255 1 1\n0.9 0.2 0 0 0 1 9 9 9 0 1\n4 0 1 2 3 0 0\n3 0 1 2 6 0 0 1 0 1 1 0\n7 0 1 2 -1 1 2 3\n";

pub fn seeds() -> Vec<Seed> {
    let binary = |is_big: bool| {
        let word = |word: u32| {
            if is_big {
                word.to_be_bytes()
            } else {
                word.to_le_bytes()
            }
        };
        let format = if is_big { "big" } else { "little" };
        let mut bytes = format!("ply\nformat binary_{format}_endian 1.0\nelement extra 1\nproperty list uchar short a\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint uint vertex_index\nend_header\n").into_bytes();
        bytes.extend([1, 0, 0]);
        let places = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        bytes.extend(places.iter().flat_map(|value| word(value.to_bits())));
        bytes.extend([3, 0, 1, 2].into_iter().flat_map(word));
        bytes
    };
    let mut stl = b"solid COLOR=abcd".to_vec();
    stl.resize(80, b' ');
    stl.extend(2u32.to_le_bytes());
    for attribute in [0x8000u16, 0x1f] {
        stl.extend([0; 12]);
        let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        stl.extend(corners.iter().flat_map(|value| value.to_le_bytes()));
        stl.extend(attribute.to_le_bytes());
    }
    vec![
        ("everything.obj".into(), OBJ.into()),
        ("text.stl".into(), STL.into()),
        ("cut.stl".into(), stl[..150].to_vec()),
        ("binary.stl".into(), stl),
        ("text.ply".into(), PLY.into()),
        ("little.ply".into(), binary(false)),
        ("big.ply".into(), binary(true)),
    ]
}
