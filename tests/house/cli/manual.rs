//! Promise: every command has a manual page with its flags, and what is installed beside the
//! program names what there is.

use super::*;

#[test]
fn every_command_has_a_manual_page_with_its_flags() {
    let folder = tempfile::tempdir().unwrap();
    let written = run_in(folder.path(), &["man", "."]);
    assert_eq!(
        (written.code, written.out.as_str(), written.err.as_str()),
        (0, "", "")
    );
    let help = run(&["--help"]).out;
    let listed = help
        .split("Commands:")
        .nth(1)
        .unwrap()
        .lines()
        .skip(1)
        .take_while(|line| !line.is_empty());
    let commands: Vec<&str> = listed
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(
        commands.len() > 10 && !commands.contains(&"man"),
        "{commands:?}"
    );
    for command in &commands {
        let page = fs::read_to_string(folder.path().join(format!("rasterlab-{command}.1")))
            .unwrap_or_else(|e| panic!("{command}: {e}"));
        assert!(page.contains(".TH rasterlab-"), "{command}: {page}");
    }
    let sequence = fs::read_to_string(folder.path().join("rasterlab-sequence.1")).unwrap();
    assert!(
        sequence.contains("video") && sequence.contains("turntable"),
        "{sequence}"
    );
    assert_eq!(
        run(&["man"]).out,
        fs::read_to_string(folder.path().join("rasterlab.1")).unwrap()
    );
    let absent = run_in(folder.path(), &["man", "absent"]);
    assert!(
        absent.code == 2
            && absent
                .err
                .contains("absent: the manual pages cannot be written"),
        "{}",
        absent.err
    );
}

#[test]
fn the_files_of_the_package_agree_with_each_other() {
    let read = |name: &str| {
        fs::read_to_string(
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("scripts/package")
                .join(name),
        )
        .unwrap()
    };
    let (desktop, types) = (read("rasterlab.desktop"), read("rasterlab.xml"));
    let opened = desktop
        .lines()
        .find_map(|line| line.strip_prefix("MimeType="))
        .unwrap();
    for kind in opened.split(';').filter(|kind| !kind.is_empty()) {
        assert!(
            types.contains(&format!("type=\"{kind}\"")),
            "{kind} is opened, and no file has it"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("icon.rasterlab.toml"), read("icon.toml")).unwrap();
    let checked = run_in(folder.path(), &["check", "icon.rasterlab.toml", "--strict"]);
    assert_eq!(checked.code, 0, "{}{}", checked.out, checked.err);
}
