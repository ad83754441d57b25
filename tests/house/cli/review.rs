//! Promise: `review` lists the presets whose picture is not their golden, with numbers and their
//! pictures, and nothing else.

use super::*;

#[test]
fn what_differs_from_its_golden_is_listed_with_numbers_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let presets = folder.path().join("presets");
    fs::create_dir(&presets).unwrap();
    let text = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.lambert]\n[output]\nsize = [64, 48]\n[test]\n";
    for name in ["one", "two", "three"] {
        fs::write(presets.join(format!("{name}.toml")), text).unwrap();
    }
    let go = |args: &[&str]| run_in(folder.path(), args);
    assert_eq!(go(&["bless", "one", "two"]).code, 0);
    let agreed = go(&["review", "one", "two"]);
    assert_eq!((agreed.code, agreed.out.as_str()), (0, ""));
    assert!(
        agreed.err.contains("none of 2 presets differs"),
        "{}",
        agreed.err
    );

    let wider = text.replace("[output]", "[effects.posterize]\n[output]");
    fs::write(presets.join("two.toml"), wider).unwrap();
    // A budget is for adapters: what the oracle draws is exact.
    let budget = text.replace("[test]\n", "[test]\nmax_channel = 255\nwhy = \"all\"\n");
    fs::write(presets.join("one.toml"), &budget).unwrap();
    let found = go(&["review", "one", "two", "three", "-o", "found"]);
    assert_eq!(found.code, 1);
    let lines: Vec<&str> = found.out.lines().collect();
    assert_eq!(lines.len(), 2, "{}", found.out);
    assert!(lines[0].starts_with("three: ") && lines[0].contains("three.png is missing"));
    assert!(
        lines[1].starts_with("two: ") && lines[1].contains(" of 3072 pixels differ, at most by "),
        "{}",
        lines[1]
    );
    assert!(found.err.contains("2 of 3 presets differ"), "{}", found.err);
    let file = |name: &str| fs::read(folder.path().join("found").join(name));
    assert_eq!(file("review.txt").unwrap(), found.out.as_bytes());
    assert_eq!(
        file("two.golden.png").unwrap(),
        fs::read(presets.join("snapshots/two.png")).unwrap()
    );
    assert!(file("two.difference.png").is_ok() && file("three.now.png").is_err());
    // What was written is accepted as it is.
    assert_eq!(go(&["bless", "two"]).code, 0);
    assert_eq!(
        file("two.now.png").unwrap(),
        fs::read(presets.join("snapshots/two.png")).unwrap()
    );

    let again = go(&["review", "three", "-o", "found"]);
    assert_eq!(again.code, 2, "nothing is overwritten: {}", again.err);
    let object = json(&go(&["review", "one", "three", "--json"]));
    assert_eq!(object["results"][0]["preset"], "three");
    assert_eq!(object["results"].as_array().unwrap().len(), 1);
}
