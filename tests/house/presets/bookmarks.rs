//! Promise: bookmarks are saved in their order, comments stay, what cannot be one is refused, and a
//! look brings none to another scene.

use rasterlab::preset_file::{merge, save, to_toml};

use super::*;

const TEXT: &str = "schema = 2\n[scene]\nbuiltin = \"knot\"\n\
    [bookmarks.front] # where it began\neye = [0.0, 0.0, 5.0] # far\n\
    [bookmarks.\"from above\"]\neye = [0.0, 5.0, 0.5]\northographic_height_m = 2.0\n\
    [effects.lambert]\n";

fn names(preset: &Preset) -> Vec<&str> {
    let names = preset.bookmarks.iter().map(|mark| mark.name.as_str());
    names.collect()
}

#[test]
fn bookmarks_are_saved_in_their_order_and_keep_their_comments() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, TEXT).expect("a file");
    let mut file = preset_file::load(&path).expect("a preset");
    assert_eq!(names(&file.preset), ["front", "from above"]);
    let aside = file.preset.bookmarks[0].camera;
    file.preset.rename_bookmark("front", "ahead").expect("free");
    file.preset.add_bookmark(aside).expect("room");
    file.preset.bookmarks[1].camera.eye.x = 0.25;
    save(&mut file, &path).expect("it is saved");
    let text = std::fs::read_to_string(&path).expect("it is there");
    let again = parse(&text).preset;
    assert_eq!(names(&again), ["ahead", "from above", "view 1"], "{text}");
    assert_eq!(bits(&again), bits(&file.preset), "{text}");
    assert!(text.contains("eye = [0.25, 5.0, 0.5]"), "{text}");
    assert!(!text.contains("front"), "{text}");

    // Nothing is left of those that were all removed.
    let mut none = parse(TEXT);
    none.preset.bookmarks.clear();
    assert!(!to_toml(&none).contains("bookmarks"));
    let mut moved = parse(TEXT);
    moved.preset.bookmarks[0].camera.eye.z = 6.0;
    let text = to_toml(&moved);
    assert!(
        text.contains("# where it began") && text.contains("eye = [0.0, 0.0, 6.0] # far"),
        "{text}"
    );
}

#[test]
fn what_is_no_bookmark_is_refused_by_name_and_line() {
    let many: String = (0..65).map(|n| format!("[bookmarks.a{n}]\n")).collect();
    let long = format!("[bookmarks.{}]\n", "x".repeat(41));
    let name = "must have 1 to 40 visible characters";
    for (tables, wanted) in [
        (many, "bookmarks.a64 is one bookmark too many"),
        (long, name),
    ] {
        let refused = refusal(&format!("schema = 2\n{tables}"));
        assert!(refused.contains(wanted), "{refused}");
    }
}

#[test]
fn bookmarks_belong_to_the_scene_and_are_merged_as_a_whole() {
    let (own, look) = (
        parse(TEXT).preset,
        parse("schema = 2\n[effects.toon]\n").preset,
    );
    assert_eq!(look.applied_to(&own).bookmarks, own.bookmarks);
    assert!(own.applied_to(&look).bookmarks.is_empty());

    let mut mine = own.clone();
    mine.bookmarks.remove(0);
    let kept = merge(&own, &mine, &own);
    assert_eq!(
        (names(&kept.preset), kept.conflicts),
        (vec!["from above"], vec![])
    );
    let mut theirs = own.clone();
    theirs.bookmarks.clear();
    let both = merge(&own, &mine, &theirs);
    assert_eq!(both.conflicts, ["bookmarks"]);
    assert_eq!(both.preset.bookmarks, mine.bookmarks);
    assert_eq!(merge(&own, &own, &theirs).preset.bookmarks, []);
}
