//! Promise: files and parts are found by the names that people's programs write, in any encoding
//! and with the letters' case of another system; nothing outside the model's folder is.

use std::{fs, path::Path};

use rasterlab::{
    preset_file::ModelFormat,
    scene::{
        Scene,
        gltf::LoadError,
        mesh_files::{load_obj, load_ply, load_stl},
        parts::parts,
    },
};
use serde_json::json;

use super::{mesh_files::load, model::*};

const FACE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

fn loaded(folder: &Path, model: &str) -> Result<Scene, LoadError> {
    let path = folder.join(model);
    ModelFormat::of(&path).expect("a format").load(&path)
}

/// A folder with these files.
fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    }
    folder
}

#[test]
fn an_image_is_found_whatever_the_way_to_it() {
    let png = encoded(image::ImageFormat::Png);
    for (library, mtl, image, line) in [
        ("m.mtl", "m.mtl", "T.PNG", "map_Kd t.png"),
        ("M.MTL", "m.mtl", "Maps/T.png", "map_Kd maps/t.png"),
        ("mat/m.mtl", "mat/m.mtl", "t.png", "map_Kd t.png"),
        ("mat/m.mtl", "mat\\m.mtl", "mat/t.png", "map_Kd t.png"),
        (
            "my mats.mtl",
            "my\\ mats.mtl",
            "my tex.png",
            "map_Kd my\\ tex.png",
        ),
        ("m.mtl", "m.mtl", "t.png", "map_Kd -colorspace sRGB t.png"),
        (
            "m.mtl",
            "m.mtl",
            "my tex.png",
            "map_Kd -s 1 1 1 -colorspace sRGB my tex.png",
        ),
        (
            "m.mtl",
            "m.mtl",
            "t.png",
            "map_Kd -nobody 1 2 -s 1 1 1 t.png",
        ),
        ("m.mtl", "m.mtl", "-t.png", "map_Kd -t.png"),
    ] {
        let mtl = format!("mtllib {mtl}\nusemtl a\n{FACE}f 1/1 2/2 3/3\n");
        let of_library = format!("newmtl a\n{line}\n");
        let folder = folder(&[
            ("q.obj", mtl.as_bytes()),
            (library, of_library.as_bytes()),
            (image, &png),
        ]);
        let scene = loaded(folder.path(), "q.obj").expect("a model");
        assert_eq!(
            (scene.notes, scene.images.len()),
            (vec![], 1),
            "{library} {image} {line}"
        );
    }
}

#[test]
fn two_files_that_differ_in_case_alone_are_no_guess_and_nothing_outside_is_read() {
    let png = encoded(image::ImageFormat::Png);
    let mtl = format!("mtllib m.mtl\nusemtl a\n{FACE}f 1/1 2/2 3/3\n");
    let folder = folder(&[
        ("in/q.obj", mtl.as_bytes()),
        ("in/m.mtl", b"newmtl a\nmap_Kd t.png\n"),
        ("in/T.png", &png),
        ("in/t.PNG", &png),
        ("u.png", &png),
    ]);
    let inside = folder.path().join("in");
    let fault = |scene: Scene| (scene.faults.len(), scene.images.len());
    assert_eq!(fault(loaded(&inside, "q.obj").expect("a model")), (1, 0));
    fs::write(inside.join("m.mtl"), "newmtl a\nmap_Kd ../u.png\n").expect("a file");
    assert_eq!(fault(loaded(&inside, "q.obj").expect("a model")), (1, 0));
}

#[test]
fn names_of_another_encoding_stay_distinct() {
    // "red" and "black" in GBK, and a name in Shift JIS whose second byte is a backslash.
    let names: [&[u8]; 3] = [b"\xba\xec\xc9\xab", b"\xba\xda\xc9\xab", b"\x95\\"];
    let (mut model, mut mtl) = (format!("mtllib m.mtl\n{FACE}").into_bytes(), Vec::new());
    for (i, name) in names.iter().enumerate() {
        model.extend([b"usemtl ", *name, b"\nf 1 2 3\n"].concat());
        mtl.extend([b"newmtl ", *name, format!("\nKd {i} 1 1\n").as_bytes()].concat());
    }
    let scene = load(load_obj, &model, &[("m.mtl", &mtl)]).expect("a model");
    let colors: Vec<f32> = scene
        .primitives
        .iter()
        .map(|p| scene.materials[p.material].base_color[0])
        .collect();
    assert_eq!((colors, scene.notes.len()), (vec![0.0, 1.0, 1.0], 0));
    // Of a JSON too, whose other names stay as they are.
    let json = Model::textured()
        .with("/materials/0/name", json!("ROT \u{7ea2}"))
        .with("/images/0/name", json!("ROT"))
        .json
        .to_string();
    let bytes: Vec<u8> = json.replace("\"ROT\"", "\"%\"").into_bytes();
    let images = [0xba, 0xbb].map(|byte| {
        let mut bytes = bytes.clone();
        let at = bytes.iter().position(|&b| b == b'%').expect("a name");
        bytes[at] = byte;
        let scene = rasterlab::scene::gltf::load(
            &glb(&bytes, &Model::textured().bytes),
            &mut |_, _| unreachable!(),
        );
        let scene = scene.expect("a model");
        assert_eq!(scene.materials[0].name, "ROT \u{7ea2}");
        scene.images[0].name.clone()
    });
    assert_ne!(images[0], images[1]);
    let mut shown: Vec<String> = parts(&scene).into_iter().map(|part| part.name).collect();
    shown.sort();
    shown.dedup();
    assert!(shown.len() > 3, "{shown:?}");
}

#[cfg(unix)]
#[test]
fn a_file_is_found_by_the_bytes_of_its_name() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt as _};

    let png = encoded(image::ImageFormat::Png);
    for name in [&b"\xba\xec.png"[..], b"\x95\\.png"] {
        let model = format!("mtllib m.mtl\nusemtl a\n{FACE}f 1/1 2/2 3/3\n");
        let folder = folder(&[("q.obj", model.as_bytes())]);
        fs::write(
            folder.path().join("m.mtl"),
            [b"newmtl a\nmap_Kd ", name].concat(),
        )
        .expect("a file");
        fs::write(folder.path().join(OsStr::from_bytes(name)), &png).expect("a file");
        let scene = loaded(folder.path(), "q.obj").expect("a model");
        assert_eq!((scene.notes, scene.images.len()), (vec![], 1), "{name:?}");

        // The same in a URI, whose bytes are written in percent.
        let uri: String = name.iter().map(|byte| format!("%{byte:02x}")).collect();
        let mut model = Model::textured().with("/images/0", json!({ "uri": uri }));
        fs::write(folder.path().join("b.bin"), &model.bytes).expect("a file");
        model.json["buffers"][0]["uri"] = json!("B.bin");
        fs::write(folder.path().join("m.gltf"), model.json.to_string()).expect("a file");
        let scene = loaded(folder.path(), "m.gltf").expect("a model");
        assert_eq!(scene.images.len(), 1, "{name:?}: {:?}", scene.notes);
    }
}

#[test]
fn scale_and_offset_of_a_map_are_read_and_black_beside_one_is_left() {
    let png = encoded(image::ImageFormat::Png);
    let model = format!("mtllib m.mtl\nusemtl a\n{FACE}f 1/1 2/2 3/3\n");
    for (line, rows) in [
        ("map_Kd t.png", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        // With v up, 2 v + 0.25; stored is 1 - v, and so is the image's.
        (
            "map_Kd -s 3 2 1 -o 0.5 0.25 0 t.png",
            [[3.0, 0.0, 0.5], [0.0, 2.0, -1.25]],
        ),
        (
            "map_Kd -o 0.5 -clamp on -s 2 t.png",
            [[2.0, 0.0, 0.5], [0.0, 1.0, 0.0]],
        ),
    ] {
        let mtl = format!("newmtl a\nKd 0 0 0\n{line}\n");
        let scene = load(
            load_obj,
            model.as_bytes(),
            &[("m.mtl", mtl.as_bytes()), ("t.png", &png)],
        )
        .expect("a model");
        let material = &scene.materials[scene.primitives[0].material];
        let texture = material.base_texture.expect("a texture");
        assert_eq!(
            (texture.image_from_texcoord, material.base_color),
            (rows, [1.0; 4]),
            "{line}"
        );
    }
}

#[test]
fn a_byte_order_mark_opens_and_the_name_of_a_solid_is_no_keyword() {
    let ply = "\u{feff}ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let stl = "solid facet normal vertex 1 2 3\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
               endsolid facet normal vertex 1 2 3\n";
    for scene in [
        load(load_ply, ply.as_bytes(), &[]),
        load(load_stl, stl.as_bytes(), &[]),
    ] {
        let scene = scene.expect("a model");
        assert_eq!((scene.triangle_count(), scene.notes), (1, vec![]));
    }
}

#[test]
fn a_file_that_is_cut_off_says_so_once_and_counts_what_it_lost() {
    let mut model = Model::square();
    for copy in 0..40u8 {
        let positions = model.floats(
            "VEC3",
            &SQUARE
                .as_flattened()
                .iter()
                .map(|v| v + f32::from(copy))
                .collect::<Vec<_>>(),
        );
        model.primitive(json!({ "attributes": { "POSITION": positions } }));
    }
    let whole = model.glb();
    let kept = whole.len() - 20 * 48;
    let scene =
        rasterlab::scene::gltf::load(&whole[..kept], &mut |_, _| unreachable!()).expect("a part");
    let [there, stated] = [kept as u64, whole.len() as u64].map(rasterlab::params::group_digits);
    let sentence = format!(
        "the file is cut off after {there} of {stated} bytes; 20 parts that need them are left out"
    );
    assert_eq!((scene.faults, scene.instances.len()), (vec![sentence], 21));
    let error = rasterlab::scene::gltf::load(
        &whole[..whole.len() - model.bytes.len()],
        &mut |_, _| unreachable!(),
    );
    let error = error.expect_err("nothing is left").to_string();
    assert!(error.starts_with("the file is cut off after "), "{error}");
}

#[test]
fn hidden_nodes_show_nothing_and_a_range_of_zero_has_no_end() {
    let mut model = Model::square()
        .with(
            "/extensionsUsed",
            json!(["KHR_lights_punctual", "KHR_node_visibility"]),
        )
        .with(
            "/extensions",
            json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "range": 0 }] } }),
        )
        .with(
            "/cameras",
            json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]),
        );
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    let below = model.push(
        "nodes",
        json!({ "mesh": 0, "extensions": light, "camera": 0 }),
    );
    let above = model.push("nodes", json!({ "children": [below] }));
    model.json["scenes"][0]["nodes"] = json!([0, above]);
    let counts = |model: &Model| {
        let scene = model.scene();
        assert_eq!(scene.notes, [""; 0]);
        (
            scene.instances.len(),
            scene.lights.len(),
            scene.cameras.len(),
        )
    };
    assert_eq!(counts(&model), (2, 1, 1));
    assert_eq!(model.scene().lights[0].range_m, None);
    let visible = |visible: bool| json!({ "KHR_node_visibility": { "visible": visible } });
    let seen = format!("/nodes/{above}/extensions");
    assert_eq!(counts(&model.clone().with(&seen, visible(true))), (2, 1, 1));
    assert_eq!(counts(&model.with(&seen, visible(false))), (1, 0, 1));
}

#[test]
fn an_image_that_is_too_wide_is_halved_and_says_so() {
    let side = rasterlab::scene::gltf::limits::IMAGE_SIDE;
    let wide = image::GrayImage::from_fn(side + 2, 3, |x, _| {
        image::Luma([if x < 2 { 0 } else { 255 }])
    });
    let mut png = std::io::Cursor::new(Vec::new());
    wide.write_to(&mut png, image::ImageFormat::Png)
        .expect("it is encoded");
    let scene = Model::textured().showing(&png.into_inner()).scene();
    let sentence = "image \"flag\" has 8194 x 3 texels; it is drawn with 4097 x 1, at most 8192 along each side";
    assert_eq!(scene.notes, [sentence]);
    let level = &scene.images[0].levels[0];
    assert_eq!(
        (level.size, level.texels[0][0], level.texels[1][0]),
        ([4097, 1], 0, 255)
    );
}
