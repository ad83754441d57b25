//! Promise: OBJ with MTL, STL, PLY, XYZ, LAS and LAZ open: every form that they allow, exactly; a part that breaks
//! them is left out with one sentence that counts; what leaves nothing to draw is refused in words.

use std::{io::Cursor, path::Path};

use glam::DVec3;
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr, LazVlrBuilder};
use rasterlab::scene::{
    Scene,
    gltf::LoadError,
    memory::MemoryBudget,
    mesh_files::{
        LoadCloud, LoadModel, load_las, load_las_shown, load_obj, load_ply, load_stl, load_xyz,
        load_xyz_shown,
    },
    model::Primitive,
    parts::parts,
    texture::Texture,
};

use super::model::{assert_sound, encoded, square, triangles};

/// The corners of [`square`] as an OBJ has them.
const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

type Files<'a> = &'a [(&'a str, &'a [u8])];

/// Loads a model with these files beside it.
pub fn load(load: LoadModel, bytes: &[u8], beside: Files) -> Result<Scene, LoadError> {
    load(&bytes, MemoryBudget::LEAST, &mut |path, _| {
        let found = beside.iter().find(|(name, _)| Path::new(name) == path);
        found
            .map(|(_, bytes)| bytes.to_vec())
            .ok_or_else(|| LoadError::new("cannot read the file"))
    })
}

/// It loads and says just this.
#[track_caller]
fn told(format: LoadModel, bytes: impl AsRef<[u8]>, beside: Files, sentences: &[&str]) -> Scene {
    let text = String::from_utf8_lossy(bytes.as_ref());
    let scene =
        load(format, bytes.as_ref(), beside).unwrap_or_else(|error| panic!("{error}: {text}"));
    assert_sound(&scene);
    assert_eq!(scene.notes, sentences, "{text}");
    assert!(scene.triangle_count() > 0, "{text}");
    scene
}

/// It loads without a message.
#[track_caller]
fn opened(format: LoadModel, bytes: impl AsRef<[u8]>, beside: Files) -> Scene {
    told(format, bytes, beside, &[])
}

/// A transcript: a line with the name of a format and a file, in which `\n` ends a line; below it
/// what is said where the file opens, each with a `~`, or after a `!` why it is refused. `obj+` is
/// an OBJ that begins with the four corners.
#[track_caller]
fn play(transcript: &str, beside: Files) {
    let lines: Vec<&str> = transcript
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect();
    let starts = lines
        .iter()
        .enumerate()
        .filter(|(_, line)| !line.starts_with(['~', '!']));
    for (start, line) in starts {
        let (kind, text) = line.split_once(' ').unwrap_or((line, ""));
        let text = text.replace("\\n", "\n");
        let text = if kind == "obj+" {
            format!("{CORNERS}{text}")
        } else {
            text
        };
        let format = match kind {
            "stl" => load_stl as LoadModel,
            "ply" => load_ply,
            "xyz" => load_xyz,
            _ => load_obj,
        };
        if let Some(sentence) = lines[start + 1].strip_prefix("! ") {
            refused(format, text.as_bytes(), sentence);
            continue;
        }
        let sentences = lines[start + 1..]
            .iter()
            .map_while(|line| line.strip_prefix("~ "));
        told(format, &text, beside, &sentences.collect::<Vec<_>>());
    }
}

#[track_caller]
fn refused(format: LoadModel, bytes: &[u8], sentence: &str) {
    let error = load(format, bytes, &[]).expect_err(sentence).to_string();
    assert_eq!(error, sentence);
}

#[test]
fn every_form_of_an_obj_face_and_line_is_read() {
    let lists = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";
    for text in [
        format!("{CORNERS}f 1 2 3 4"),
        format!("{CORNERS}f -4 -3 -2 -1\n"),
        format!("{CORNERS}{lists}f 1/1 2/2 3/3 4/4\n"),
        format!("{CORNERS}{lists}f 1//1 2//1 3//1 4//1\n"),
        format!("{CORNERS}{lists}f 1/-4/-1 2/2/1 3/3/1 4/4/1\n"),
        format!("f 1 2 3\nf 1 3 4\n{CORNERS}"),
        format!("{CORNERS}f 1 2 \\\n 3 \\\n 4 # the end\n").replace('\n', "\r\n"),
        format!("\u{feff}# C:\\models\\\n{CORNERS}\t f  1\t2 3 3 4 \n").replace('\n', "\r"),
        CORNERS.replace(" 1", " 1.000e+0 ") + "s off\ng\nfo 1/ 2/ 3// 4\n",
        CORNERS.replace(" 1", " 1,0") + "vp 1\nlod 3\nf 1 2 3 4\n",
        "v 0 0 0 1\nv 1 0 0 0.5\nv 1 1 0 1\nv 0 1 0 1\nf 1 2 3 4".into(),
    ] {
        let scene = opened(load_obj, &text, &[]);
        assert_eq!(triangles(&scene), square(), "{text}");
        let has_normals = text.contains("//1") || text.contains("/3/1");
        assert_eq!(scene.primitives[0].is_faceted, !has_normals, "{text}");
    }
}

#[test]
fn objects_groups_and_materials_are_parts_with_names() {
    let faces = "mtllib m.mtl\no body\nf 1 2 3\ng left arm\nusemtl red\nf 1 2 4\no head\ng empty\nf 1 3 4\no body\nf 2 3 4\n";
    let mtl: Files = &[("m.mtl", b"newmtl red\nKd 1 0 0\nnewmtl unused\nKd 0 0 0\n")];
    let scene = opened(load_obj, format!("{CORNERS}{faces}"), mtl);
    let parts = parts(&scene).into_iter();
    let mut names: Vec<String> = parts
        .map(|part| format!("{:?} {}", part.kind, part.name))
        .collect();
    names.sort();
    let wanted = "Material default, Material red, Mesh body, Mesh empty, Mesh left arm, Node body, Node empty, Node head, Node left arm";
    assert_eq!(names.join(", "), wanted);
    assert_eq!(scene.named_nodes[1].parent, Some(0));
}

#[test]
fn smoothing_groups_share_normals_across_materials_and_not_across_groups() {
    // Two squares that meet at a right angle.
    let normals =
        |faces: &str| -> Vec<DVec3> {
            let scene = opened(load_obj, format!("{CORNERS}v 0 0 1\nv 0 1 1\n{faces}"), &[]);
            let mut normals = Vec::new();
            for primitive in scene
                .primitives
                .iter()
                .filter(|primitive| !primitive.is_faceted)
            {
                let vertices = 0..primitive.vertex_count();
                let at_origin =
                    vertices.filter(|&vertex| primitive.position(&scene, vertex) == [0.0; 3]);
                normals.extend(at_origin.map(|vertex| {
                    DVec3::from(primitive.normals.vector(&scene.vertex_bytes, vertex))
                }));
            }
            normals
        };
    let half = 0.5f64.sqrt();
    let shared = normals("s 1\nf 1 2 3 4\nf 1 4 6 5\n");
    assert!(shared.len() == 1 && shared[0].distance(DVec3::new(half, 0.0, half)) < 1e-6);
    assert_eq!(
        normals("s 1\nf 1 2 3 4\ns 2\nf 1 4 6 5\n"),
        [DVec3::Z, DVec3::X]
    );
    assert_eq!(normals("f 1 2 3 4\ns off\nf 1 4 6 5\n"), [DVec3::ZERO; 0]);
}

#[test]
fn materials_have_colors_and_images_however_their_names_are_written() {
    let png = encoded(image::ImageFormat::Png);
    let with = |library: &str| {
        format!(
            "{CORNERS}mtllib {library}\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl my stuff\nf 1/1 2/2 3/3\n"
        )
    };
    for (library, file, map, image) in [
        ("a.mtl", "a.mtl", "map_Kd flag.png", "flag.png"),
        (
            "my lib.mtl",
            "my lib.mtl",
            "map_kd the flag.png",
            "the flag.png",
        ),
        (
            "b.mtl a.mtl",
            "a.mtl",
            "map_Kd -s 1 2 1 -clamp on -o .5 flag.png",
            "flag.png",
        ),
        (
            "./sub\\a.mtl",
            "sub/a.mtl",
            "map_Kd tex\\flag.png",
            "sub/tex/flag.png",
        ),
        (
            "C:\\x\\a.mtl",
            "a.mtl",
            "map_Kd \"/home/me/flag.png\"",
            "flag.png",
        ),
        ("../a.mtl", "a.mtl", "map_Kd ../../../flag.png", "flag.png"),
    ] {
        let mtl = format!("newmtl  my stuff\r\nKd 0.5 1 0\r\nKe 0 0 2\r\n{map}\r\nillum 2\r\n");
        let beside: Files = &[(file, mtl.as_bytes()), ("b.mtl", b""), (image, &png)];
        let scene = load(load_obj, with(library).as_bytes(), beside).expect(library);
        let faults = usize::from(library.starts_with("b.mtl"));
        assert_eq!(scene.faults.len(), faults, "{:?}", scene.notes);
        let material = &scene.materials[scene.primitives[0].material];
        assert_eq!(material.name, "my stuff");
        assert!((material.base_color[0] - 0.214_041).abs() < 1e-5, "sRGB");
        assert_eq!(material.base_color[1..], [1.0, 0.0, 1.0]);
        assert_eq!(material.emission, [0.0, 0.0, 2.0]);
        let texture = material.base_texture.expect("a texture");
        assert_eq!((texture.image, texture.wrap), (0, Texture::plain(0).wrap));
        let texcoords = scene.primitives[0].texcoords[0].expect("coordinates");
        let v = [0, 1, 2].map(|vertex| texcoords.value(&scene.vertex_bytes, vertex, 1));
        assert_eq!(v, [1.0, 1.0, 0.0], "v points up");
    }
    let glowing = "newmtl my stuff\nKe 0 0 0\nmap_Ke flag.png\nmap_Kd flag.png\nmap_d flag.png\n";
    let beside: Files = &[("a.mtl", glowing.as_bytes()), ("flag.png", &png)];
    let note = "material \"my stuff\": blending is not supported; it is masked where the alpha of its map_Kd is below one half";
    let scene = told(load_obj, with("a.mtl"), beside, &[note]);
    let material = &scene.materials[0];
    let read = (material.emission, material.alpha_cutoff, scene.images.len());
    assert_eq!(read, ([1.0; 3], Some(0.5), 1));
}

#[test]
fn colors_of_vertices_are_read_where_a_format_has_them() {
    let color = |scene: &Scene, vertex| {
        let colors = scene.primitives[0].colors.expect("colors");
        [0, 1, 2].map(|c| (colors.value(&scene.vertex_bytes, vertex, c) * 1000.0).round())
    };
    let red = [1000.0, 0.0, 0.0];
    let scene = opened(
        load_obj,
        "v 0 0 0 1 0 0.5\nv 1 0 0 1 0 1 0.5\nv 1 1 0\nf 1 2 3\n",
        &[],
    );
    let colors = [0, 1, 2].map(|vertex| color(&scene, vertex));
    assert_eq!(
        colors,
        [[1000.0, 0.0, 214.0], [1000.0, 0.0, 1000.0], [1000.0; 3]]
    );
    for (kind, full) in [("uchar", "255"), ("float", "1"), ("ushort", "65535")] {
        let channels =
            ["red", "green", "blue", "alpha"].map(|name| format!("property {kind} {name}\n"));
        let vertices = format!("0 0 0 {full} 0 0 0\n1 0 0 0 0 0 0\n1 1 0 0 0 0 0\n");
        let text = ply_text("", &channels.concat(), &vertices, "3 0 1 2\n");
        assert_eq!(color(&opened(load_ply, &text, &[]), 0), red);
    }
    // VisCAM: red in the upper bits; Magics: in the lower ones, and a color for the rest.
    let scene = opened(load_stl, stl(b"", &[(SQUARE_HALF, 0xfc00)]), &[]);
    assert_eq!(color(&scene, 0), red);
    let facets = [(SQUARE_HALF, 0x001f), (SQUARE_HALF, 0x8000)];
    let scene = opened(load_stl, stl(b"COLOR=\0\xff\0\xff", &facets), &[]);
    assert_eq!(
        (color(&scene, 0), color(&scene, 3)),
        (red, [0.0, 1000.0, 0.0])
    );
}

const SQUARE_HALF: [[f32; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
const OTHER_HALF: [[f32; 3]; 3] = [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// A binary STL of facets with their attributes.
pub fn stl(head: &[u8], facets: &[([[f32; 3]; 3], u16)]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((facets.len() as u32).to_le_bytes());
    for (corners, attribute) in facets {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flatten().flat_map(|v| v.to_le_bytes()));
        bytes.extend(attribute.to_le_bytes());
    }
    bytes
}

pub fn stl_text(corners: &[[[f32; 3]; 3]]) -> String {
    let facet = |corners: &[[f32; 3]; 3]| {
        let vertices = corners
            .map(|[x, y, z]| format!("   vertex {x} {y} {z}\n"))
            .concat();
        format!(" facet normal 0 0 0\n  outer loop\n{vertices}  endloop\n endfacet\n")
    };
    let facets: String = corners.iter().map(facet).collect();
    format!("solid part\n{facets}endsolid part\n")
}

#[test]
fn stl_is_text_or_binary_whatever_it_begins_with() {
    let halves = [SQUARE_HALF, OTHER_HALF];
    let text = stl_text(&halves);
    let binary = stl(b"solid but binary", &halves.map(|half| (half, 0)));
    for bytes in [
        text.as_bytes(),
        text.to_uppercase().replace('\n', "\r\n").as_bytes(),
        text.replace('\n', " ")
            .replace("solid part", "solid\n")
            .as_bytes(),
        &binary,
    ] {
        let scene = opened(load_stl, bytes, &[]);
        assert_eq!(triangles(&scene), square());
        assert_eq!(scene.vertex_count(), 4, "equal corners are one vertex");
        assert!(scene.primitives[0].is_faceted);
    }
    let two = text + &stl_text(&halves[..1]).replace("part", "the lid");
    let scene = opened(load_stl, &two, &[]);
    let names: Vec<&str> = scene
        .named_nodes
        .iter()
        .map(|node| node.name.as_str())
        .collect();
    assert_eq!(
        (names, scene.triangle_count()),
        (vec!["part", "the lid"], 3)
    );
    let note = "the file states 2 triangles and has 1; those that are whole are drawn";
    told(load_stl, &binary[..binary.len() - 1], &[], &[note]);
}

/// A PLY as text, of vertices with x, y, z and more.
fn ply_text(comments: &str, more: &str, vertices: &str, faces: &str) -> String {
    let [v, f] = [vertices, faces].map(|rows| rows.lines().count());
    format!(
        "ply\nformat ascii 1.0\n{comments}element vertex {v}\nproperty float x\nproperty double y\nproperty float32 z\n{more}element face {f}\nproperty list uchar int vertex_indices\nend_header\n{vertices}{faces}"
    )
}

const PLACES: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

#[test]
fn vertices_that_no_face_has_are_points() {
    for (places, faces, points) in [(PLACES, "", 4), (PLACES, "3 0 1 2\n", 1)] {
        let scene = opened(load_ply, ply_text("", "", places, faces), &[]);
        let cloud = scene.primitives.last().expect("a primitive");
        assert_eq!((cloud.is_points(), cloud.triangle_count()), (true, points));
        assert_eq!(scene.primitives.len(), 1 + usize::from(!faces.is_empty()));
    }
}

/// The colors of the points of a scene, from 0 to 1 in linear light, and how many have a normal.
fn clouds(scene: &Scene) -> Vec<([f32; 3], u32)> {
    let of = |primitive: &Primitive| {
        let color = |at| match primitive.colors {
            Some(colors) => colors.vector(&scene.vertex_bytes, at).map(|v| v as f32),
            None => [1.0; 3],
        };
        let normals = u32::from(primitive.normals.stride > 0);
        assert!(primitive.is_points());
        (0..primitive.vertex_count())
            .map(move |at| (color(at), normals))
            .collect::<Vec<_>>()
    };
    scene.primitives.iter().flat_map(of).collect()
}

#[test]
fn numbers_behind_the_place_of_a_point_of_text_are_a_gray_a_color_or_a_color_and_a_normal() {
    let (white, red) = ([1.0; 3], [1.0, 0.0, 0.0]);
    for (text, wanted) in [
        ("0 0 0\n1 0 0\n", (white, 0)),
        ("# x y z\n0,0,0,255\n1;0;0;255\n", (white, 0)),
        ("2\n0 0 0 255 0 0\n1 0 0 255 0 0", (red, 0)),
        ("0 0 0 1 0 0 name\n1 0 0 1 0 0 name", (red, 0)),
        ("0 0 0 -7 65535 0 0\n1 0 0 -7 65535 0 0", (red, 0)),
        (
            "x y z r g b nx ny nz\n0 0 0 255 0 0 0 0 1\n1 0 0 255 0 0 0 0 1",
            (red, 1),
        ),
    ] {
        assert_eq!(clouds(&opened(load_xyz, text, &[])), [wanted; 2], "{text}");
    }
}

/// A LAS file of this point format, whose steps are a centimeter.
fn las(format: u8, stride: usize, points: &[([i32; 3], u8)]) -> Vec<u8> {
    let mut bytes = vec![0; 227];
    bytes[..4].copy_from_slice(b"LASF");
    (bytes[24], bytes[25], bytes[96], bytes[104]) = (1, 2, 227, format);
    bytes[105..107].copy_from_slice(&(stride as u16).to_le_bytes());
    bytes[107..111].copy_from_slice(&(points.len() as u32).to_le_bytes());
    for (axis, offset) in [500_000.0f64, 5_400_000.0, 100.0].into_iter().enumerate() {
        bytes[131 + 8 * axis..][..8].copy_from_slice(&0.01f64.to_le_bytes());
        bytes[155 + 8 * axis..][..8].copy_from_slice(&offset.to_le_bytes());
    }
    for (place, class) in points {
        let mut point = vec![0; stride];
        point[..12].copy_from_slice(bytemuck::cast_slice(place));
        // An intensity, and where the format has a color, red.
        point[13] = 200;
        match format {
            2 => point[21] = 200,
            7 => point[31] = 200,
            _ => {}
        }
        point[if format < 6 { 15 } else { 16 }] = *class;
        bytes.extend(point);
    }
    bytes
}

/// The same file, compressed in chunks of two points.
fn laz(las: &[u8]) -> Vec<u8> {
    let items = LazItemRecordBuilder::default_for_point_format_id(las[104], 0);
    let vlr = LazVlrBuilder::new(items.expect("a format"))
        .with_fixed_chunk_size(2)
        .build();
    let (mut said, mut packed) = (Vec::new(), Cursor::new(Vec::new()));
    vlr.write_to(&mut said).expect("written");
    let mut packer = LasZipCompressor::new(&mut packed, vlr).expect("a way to compress");
    packer.compress_many(&las[227..]).expect("compressed");
    packer.done().expect("compressed");
    drop(packer);
    let mut record = vec![0; 54];
    record[2..2 + LazVlr::USER_ID.len()].copy_from_slice(LazVlr::USER_ID.as_bytes());
    record[18..20].copy_from_slice(&LazVlr::RECORD_ID.to_le_bytes());
    record[20] = said.len() as u8;
    let first = 227 + 54 + said.len();
    let mut bytes = [&las[..227], &record, &said, packed.get_ref()].concat();
    bytes[94] = 227;
    bytes[96..98].copy_from_slice(&(first as u16).to_le_bytes());
    bytes[100] = 1;
    bytes[104] |= 0x80;
    bytes
}

const SURVEYED: &[([i32; 3], u8)] = &[([0, 0, 0], 2), ([1, 0, 0], 6), ([0, 300, 40], 6)];

#[test]
fn points_of_las_keep_their_place_color_and_class() {
    let formats = [(0, 20), (1, 28), (2, 26), (6, 30), (7, 36)];
    for (format, stride) in formats {
        let plain = las(format, stride, SURVEYED);
        for bytes in [laz(&plain), plain] {
            let scene = opened(load_las, bytes, &[]);
            let names = scene.named_nodes.iter().map(|node| &*node.name);
            assert_eq!(names.collect::<Vec<_>>(), ["ground", "building"]);
            let places = scene.instances.iter().flat_map(|instance| {
                let (scene, primitive) = (&scene, &scene.primitives[instance.primitive]);
                let place = |at| DVec3::from(primitive.position(scene, at).map(f64::from));
                (0..primitive.vertex_count())
                    .map(move |at| instance.world_from_object.transform_point3(place(at)))
            });
            for (place, (wanted, _)) in places.zip(SURVEYED) {
                let [x, y, z] = wanted.map(|steps| 0.01 * f64::from(steps));
                let wanted = DVec3::new(500_000.0 + x, 5_400_000.0 + y, 100.0 + z);
                assert!(place.distance(wanted) < 1e-4, "{place}, not {wanted}");
            }
            let has_color = matches!(format, 2 | 7);
            let is_red =
                |([r, g, b], _): &([f32; 3], u32)| *r > 0.5 && g == b && (*g == *r) != has_color;
            assert!(clouds(&scene).iter().all(is_red), "{:?}", clouds(&scene));
        }
    }
}

#[test]
fn a_variant_colors_the_points_of_a_cloud() {
    let read = |load: LoadCloud, bytes: &[u8], shown: &str| {
        let scene = load(&bytes, MemoryBudget::LEAST, shown, &mut |_, _| {
            Err(LoadError::new("no other file"))
        });
        scene.expect("a cloud")
    };
    let gray = |scene: &Scene| clouds(scene).iter().all(|([r, g, b], _)| r == g && g == b);
    let survey = las(2, 26, SURVEYED);
    for (shown, is_gray) in [("", false), ("color", false), ("intensity", true)] {
        let scene = read(load_las_shown, &survey, shown);
        assert_eq!(scene.variants, ["color", "intensity", "class"]);
        assert_eq!(gray(&scene), is_gray, "{shown}");
    }
    // Colors that are all black say nothing.
    let black: Vec<u8> = survey
        .iter()
        .map(|byte| if *byte == 200 { 0 } else { *byte })
        .collect();
    let scene = read(load_las_shown, &black, "");
    assert_eq!(scene.variants, ["class"]);
    assert!(
        scene.notes[0].contains("class is shown"),
        "{:?}",
        scene.notes
    );
    assert_ne!(clouds(&scene)[0], clouds(&scene)[1]);
    let by_class = clouds(&read(load_las_shown, &survey, "class"));
    assert!(by_class[0] != by_class[1] && by_class[1] == by_class[2]);
    for (shown, is_gray) in [("", false), ("intensity", true)] {
        let scene = read(load_xyz_shown, b"0 0 0 -7 255 0 0\n1 0 0 9 0 0 255", shown);
        assert_eq!(scene.variants, ["color", "intensity"]);
        assert_eq!(gray(&scene), is_gray, "{shown}");
    }
}

#[test]
fn a_damaged_las_opens_as_far_as_it_goes_or_is_refused_in_words() {
    let whole = las(0, 20, SURVEYED);
    let note = "the file ends after 2 of 3 points; what is there is drawn";
    told(load_las, &whole[..whole.len() - 1], &[], &[note]);
    let packed = [laz(&whole), laz(&las(7, 36, SURVEYED))];
    // The last chunk has one point, and a table of four words and more stands behind it.
    let note = "the file ends or is damaged after 2 of 3 points; what is there is drawn";
    told(load_las, &packed[1][..packed[1].len() - 60], &[], &[note]);
    let with = |whole: &[u8], at: usize, value: u8| {
        let mut bytes = whole.to_vec();
        bytes[at] = value;
        bytes
    };
    for whole in packed.iter().chain([&whole]) {
        for length in 0..whole.len() {
            let _ = load(load_las, &whole[..length], &[]);
        }
        for at in 24..whole.len() {
            for value in [0x7f, 0xff] {
                let _ = load(load_las, &with(whole, at, value), &[]);
            }
        }
    }
    let header =
        "it is no LAS file: it does not begin with \"LASF\" and a header; fetch or export it again";
    for (bytes, sentence) in [
        (whole[..226].to_vec(), header),
        (
            with(&whole, 104, 0x80),
            "it does not say how its points are compressed; fetch or export it again",
        ),
        (
            with(&packed[0], 227 + 54 + 34, 7),
            "its points of the format 0 are compressed in a way that is not read; unpack it to LAS",
        ),
        (
            with(&whole, 104, 11),
            "its points are of the format 11; allowed: 0 to 10",
        ),
        (
            with(&whole, 105, 19),
            "its points have 19 bytes; those of the format 0 have 20 or more",
        ),
        (
            with(&whole, 107, 0),
            "there is nothing to draw: it has no points; export it again",
        ),
    ] {
        refused(load_las, &bytes, sentence);
    }
}

#[test]
fn ply_is_read_by_what_its_header_says() {
    let plain = ply_text("comment hi\nobj_info x\n", "", PLACES, "4 0 1 2 3\n");
    let late = "ply\nformat ascii 1.0\nelement edge 1\nproperty int a\nelement face 2\nproperty uchar flags\nproperty list uint8 ushort vertex_index\nelement none 5\nelement vertex 4\nproperty list char float extra\nproperty float z\nproperty float x\nproperty float y\nend_header\n7\n0 3 0 1 2\n0 3 0 2 3\n0 0 0 0\n2 8 9 0 1 0\n1 5 0 1 1\n0 0 0 1\n";
    let strip = plain.replace("element face 1", "element tristrips 1");
    let strip = strip.replace("4 0 1 2 3", "8 0 1 2 -1 2 3 0 0");
    for text in [plain.as_str(), &plain.replace('\n', "\r\n"), late, &strip] {
        let mut found = triangles(&opened(load_ply, text, &[]));
        if text.contains("tristrips") {
            found[1].rotate_right(1);
        }
        assert_eq!(found, square(), "{text}");
    }
    for format in ["little", "big"] {
        let order = |bytes: &[u8]| -> Vec<u8> {
            let mut bytes = bytes.to_vec();
            if format == "big" {
                bytes.reverse();
            }
            bytes
        };
        let mut bytes = format!("ply\nformat binary_{format}_endian 1.0\nelement odd 2\nproperty list ushort short skipped\nelement vertex 4\nproperty double x\nproperty short y\nproperty float z\nelement face 1\nproperty list uint char vertex_indices\nend_header\n").into_bytes();
        for list in [&[][..], &[-3i16, 500]] {
            bytes.extend(order(&(list.len() as u16).to_le_bytes()));
            list.iter()
                .for_each(|v| bytes.extend(order(&v.to_le_bytes())));
        }
        for [x, y, z] in [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] {
            bytes.extend(order(&f64::from(x).to_le_bytes()));
            bytes.extend(order(&(y as i16).to_le_bytes()));
            bytes.extend(order(&(z as f32).to_le_bytes()));
        }
        bytes.extend(order(&4u32.to_le_bytes()));
        bytes.extend([0, 1, 2, 3]);
        assert_eq!(
            triangles(&opened(load_ply, &bytes, &[])),
            square(),
            "{format}"
        );
        // Of a row that is cut off nothing is drawn.
        bytes.pop();
        let sentence = "there is nothing to draw: the file ends after 0 of 1 rows of \"face\"; fetch or export it again";
        refused(load_ply, &bytes, sentence);
    }
}

#[test]
fn ply_shows_its_image_by_coordinates_of_vertices_or_of_corners() {
    let png = encoded(image::ImageFormat::Png);
    let name = "comment TextureFile my flag.png\n";
    let rows = "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n";
    let of_vertices = ply_text(
        name,
        "property float s\nproperty float t\n",
        rows,
        "3 0 1 2\n",
    );
    let of_corners = ply_text(name, "", PLACES, "3 0 1 2 6 0 0 1 0 1 1\n").replace(
        "vertex_indices\n",
        "vertex_indices\nproperty list uchar float texcoord\n",
    );
    for text in [of_vertices, of_corners] {
        let scene = opened(load_ply, &text, &[("my flag.png", &png)]);
        let texcoords = scene.primitives[0].texcoords[0].expect("coordinates");
        let corner = |vertex| [0, 1].map(|c| texcoords.value(&scene.vertex_bytes, vertex, c));
        assert_eq!([0, 1, 2].map(corner), [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        let note = "texture 0: \"my flag.png\": cannot read the file; it is left out";
        let scene = told(load_ply, &text, &[], &[note]);
        assert_eq!(scene.primitives[0].texcoords, [None; 5]);
    }
}

#[test]
fn a_broken_part_is_left_out_and_told_once_and_what_leaves_nothing_is_refused() {
    let faces = "3 0 1 2\n3 0 1 3\n3 0 1 9\n3 0 -1 2\n2 0 1\n3 0 1\n";
    let nan = ply_text("", "", "0 0 0\n1 0 0\n1 1 0\nnan 1 0\n", faces).replace('\n', "\\n");
    let facets = "facet\nvertex 1 x 2\nendfacet\nfacet\nvertex 1 1 1\nendfacet\nendsolid";
    let broken = stl_text(&[SQUARE_HALF])
        .replace("endsolid", facets)
        .replace('\n', "\\n");
    let bad = b"Kd 1 1 1\nnewmtl a\nKd x y z\nd 0.5\nmap_Kd gone.png\nbump a.png\nmap_Ks b.png\nmap_d c.png\n";
    let beside: Files = &[
        ("bad.mtl", bad),
        ("text.mtl", b"newmtl a\nmap_Kd bad.mtl\n"),
        ("flag.mtl", b"newmtl a\nmap_Kd flag.png\n"),
        ("flag.png", &encoded(image::ImageFormat::Png)),
    ];
    let transcript = include_str!("mesh_files.txt").replace("BROKEN", &broken);
    let points = "ply\\nformat ascii 1.0\\nelement vertex 8\\nproperty float x\\nproperty float y\\nproperty float z\\nend_header\\n";
    play(
        &transcript.replace("NAN", &nan).replace("POINTS", points),
        beside,
    );
    let mut far = stl(b"", &[(SQUARE_HALF, 0), (OTHER_HALF, 0)]);
    far[84 + 12..84 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    told(
        load_stl,
        far,
        &[],
        &["triangle 0: the numbers of a corner are not below 6.9e10; it is left out"],
    );
}

#[test]
fn a_file_of_another_kind_is_refused_in_a_sentence() {
    refused(
        load_ply,
        b"PK\x03\x04",
        "it is not a PLY file: it is a zip archive; unpack it first",
    );
    let sentence = "it is not an STL file: it is a glTF model; let its name end with .glb";
    refused(load_stl, b"glTF\x02", sentence);
    refused(
        load_obj,
        b"\xff\xd8\xff",
        "it is not an OBJ file: it is a JPEG picture",
    );
}
