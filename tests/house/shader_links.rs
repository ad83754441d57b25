//! Promise: every file of the shaders names only what it and the files that it uses declare, an
//! error names the file and the line that a person wrote, and few files must be opened to read a
//! pass.

use rasterlab::{
    accuracy::Visibility,
    effects::Effect,
    host,
    shader::{
        Fetch, KernelKey, Pass, library,
        link::{self, LinkError},
        pass::RasterPhase,
        reflect,
    },
};

use super::{
    shader_parts,
    shaders::{key, linked},
};

/// A scene of plain indexed meshes with the default options, on a graphics card.
fn plain_key() -> KernelKey {
    let mut key = key(Fetch::Indexed, Visibility::Split32, true, vec![]);
    key.work.listed_tiles = false;
    (key.generated.has_particles, key.surface.has_material_atlas) = (false, false);
    key.surface.has_finish = false;
    (key.surface.has_finish_maps, key.surface.has_normal_maps) = (false, false);
    key.surface.lights = 0;
    key
}

/// What the linker says where `old` stands as `new` in the variants of coverage, and the line of it.
fn refusal_with(old: &str, new: &str) -> (LinkError, usize) {
    let folder = shader_parts::copied();
    let path = folder.path().join("variants/coverage.wgsl");
    let text = std::fs::read_to_string(&path).expect("a shader");
    let at = text.find(old).expect("the text");
    std::fs::write(&path, text.replacen(old, new, 1)).expect("written");
    let (key, pass) = (plain_key(), Pass::RasterMedium(RasterPhase::Depth));
    let library = host::shaders::library(folder.path());
    let error = link::link(&library, &pass.path(), &key, &key.variants(pass)).expect_err("refused");
    (error, text[..at].lines().count() + 1)
}

#[test]
fn an_error_names_the_file_and_line_a_person_wrote() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let project = "//@ use effects/wrong\n@compute @workgroup_size(1)\nfn project() { wrong(); }\n";
    let wrong = "// A mistake\nfn wrong() { let x: u32 = 1.5; }\n";
    for (below, name, text) in [("stages", "project", project), ("effects", "wrong", wrong)] {
        std::fs::create_dir(folder.path().join(below)).expect("a folder");
        let path = folder.path().join(format!("{below}/{name}.wgsl"));
        std::fs::write(path, text).expect("written");
    }
    let key = key(Fetch::Direct, Visibility::Split32, false, vec![]);
    let library = host::shaders::library(folder.path());
    let linked = link::link(&library, "stages/project", &key, &[]).expect("links");
    let error = reflect::reflect(&linked, false)
        .map(|_| ())
        .expect_err("a wrong type")
        .to_string();
    assert!(
        error.starts_with("shaders/effects/wrong.wgsl:2:"),
        "{error}"
    );
}

#[test]
fn a_pass_is_read_in_few_files() {
    for (pass, most) in [
        (Pass::RasterSmall(RasterPhase::Depth), 14),
        (Pass::Resolve, 18),
    ] {
        let linked = linked(&plain_key(), pass);
        let files = linked.files();
        assert!(files.len() <= most, "{}: {files:?}", pass.label());
    }
}

#[test]
fn every_use_line_is_needed_and_a_missing_one_is_refused() {
    let folder = shader_parts::copied();
    let library = host::shaders::library(folder.path());
    let effects = ["dissolve", "explode", "shadow", "outline"]
        .map(|name| Effect::find(name).expect("an effect").clone())
        .to_vec();
    let mut full = key(Fetch::Indexed, Visibility::Split32, true, effects);
    full.samples.has_mask = true;
    let mut seen = std::collections::BTreeSet::new();
    let (mut refused_by_linker, mut needless) = (0, std::collections::BTreeSet::new());
    let mut unmasked = full.clone();
    unmasked.samples.has_mask = false;
    for key in [plain_key(), unmasked, full] {
        let passes = key.frame();
        for pass in passes {
            for part in linked(&key, pass).parts {
                let Some((file, first)) = part.origin else {
                    continue;
                };
                let path = folder.path().join(format!("{file}.wgsl"));
                let text = std::fs::read_to_string(&path).expect("a shader");
                let lines: Vec<&str> = text.lines().collect();
                let is_section =
                    |line: &&str| line.starts_with("//@ variant ") || line.starts_with("//@ step ");
                let end = lines
                    .iter()
                    .skip(first + 1)
                    .position(is_section)
                    .map_or(lines.len(), |found| first + 1 + found);
                for at in (first..end).filter(|at| lines[*at].starts_with("//@ use ")) {
                    let line = lines[at];
                    // A line that one key needs may be idle in another, where a further file uses
                    // the same one.
                    let use_line = (part.name.clone(), line.to_owned());
                    if seen.contains(&use_line) {
                        continue;
                    }
                    let mut without = lines.clone();
                    without[at] = "//";
                    std::fs::write(&path, without.join("\n")).expect("written");
                    match link::link(&library, &pass.path(), &key, &key.variants(pass)) {
                        Err(LinkError::Undeclared {
                            file: blamed,
                            name: missing,
                            ..
                        }) => {
                            refused_by_linker += 1;
                            needless.remove(&use_line);
                            assert!(
                                blamed == file && !missing.is_empty(),
                                "{file} without {line}: {blamed} is blamed"
                            );
                        }
                        Err(error) => panic!("{file} without {line}: {error}"),
                        // A file that nothing else uses is not linked at all.
                        Ok(linked) if reflect::reflect(&linked, false).is_err() => {
                            needless.remove(&use_line);
                        }
                        Ok(_) => {
                            needless.insert(use_line);
                            continue;
                        }
                    }
                    seen.insert(use_line);
                }
                std::fs::write(&path, &text).expect("written");
            }
        }
    }
    assert!(
        needless.is_empty(),
        "no key needs these lines: {needless:#?}"
    );
    assert!(
        seen.len() > 150 && refused_by_linker > 100,
        "{} lines, {refused_by_linker} refused",
        seen.len()
    );
}

#[test]
fn an_undeclared_name_is_refused_with_file_line_and_name() {
    let wrong = "    return vec3i(i32(frame.size.x)) + coverage.row + ";
    let (error, line) = refusal_with("    return coverage.row + ", wrong);
    let expected = format!(
        "shaders/variants/coverage.wgsl:{line}: names frame, which lib/frame declares; add //@ use for it"
    );
    assert_eq!(error.to_string(), expected);
}

#[test]
fn no_file_can_use_a_stage() {
    let section = "//@ variant fixed\n";
    let using = format!("{section}//@ use stages/raster/raster_small\n");
    let (error, at) = refusal_with(section, &using);
    let is_told = matches!(error, LinkError::UsesStage { line, .. } if line as usize == at + 1);
    assert!(is_told, "{error}");
}

#[test]
fn a_variant_that_lacks_what_its_interface_declares_is_refused() {
    let declared = "\nfn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32";
    let (error, _) = refusal_with(declared, &declared.replace("i32", "u32"));
    let is_told = matches!(&error, LinkError::Incomplete { signature, .. } if signature.contains("coverage_begin"));
    assert!(is_told, "{error}");
}

#[test]
fn a_file_of_variants_has_all_its_code_in_sections_of_different_names() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/variants"))
        .expect("a folder")
    {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a shader");
        let sections = library::sections(&text);
        let code = text[sections[0].1.clone()]
            .lines()
            .find(|line| !line.is_empty() && !line.starts_with("//"));
        assert_eq!(
            code,
            None,
            "{}: no kernel links what stands before the first section",
            path.display()
        );
        let names: std::collections::BTreeSet<&str> =
            sections.iter().map(|(name, _)| *name).collect();
        assert!(
            names.len() == sections.len() && sections.len() > 1,
            "{}: {names:?}",
            path.display()
        );
    }
}
