//! Promise: every command has a manual page with its flags, and what is installed beside the
//! program names what there is.

use super::*;

#[test]
fn every_command_has_a_manual_page_with_its_flags() {
    let place = Place::new();
    place.play("$ man .\n>=\n!=\n$2 man absent\n! absent: the manual pages cannot be written");
    let page = |name: &str| String::from_utf8(place.read(name)).unwrap();
    let help = place.run("--help").out;
    let listed = help.split("Commands:").nth(1).unwrap().lines().skip(1);
    let commands: Vec<&str> = listed
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(
        commands.len() > 10 && !commands.contains(&"man"),
        "{commands:?}"
    );
    for command in &commands {
        assert!(
            page(&format!("rasterlab-{command}.1")).contains(".TH rasterlab-"),
            "{command}"
        );
    }
    let sequence = page("rasterlab-sequence.1");
    assert!(
        sequence.contains("video") && sequence.contains("turntable"),
        "{sequence}"
    );
    assert_eq!(place.run("man").out, page("rasterlab.1"));
}

#[test]
fn help_lists_shared_options_apart_and_not_what_a_command_refuses() {
    let place = Place::new();
    for (command, taken, refused) in [
        ("list", "--json", "--adapter <"),
        ("check", "--adapter <", "--preset <"),
        ("bench", "--preset <", "--force"),
        ("render", "--preset <", "--log"),
    ] {
        let help = place.run(&format!("{command} --help")).out;
        let (own, shared) = help.split_once("Shared options:").unwrap();
        assert!(!own.contains(taken) && shared.contains(taken), "{help}");
        assert!(!help.contains(refused), "{help}");
    }
    let help = place.run("completions --help").out;
    assert!(!help.contains("Shared options"), "{help}");
    // What they refuse is refused at once, before or behind the command.
    for (line, option) in [
        ("--adapter x list", "--adapter"),
        ("gallery --device-memory 1GiB", "--device-memory"),
        ("completions bash --quiet", "--quiet"),
        ("adapters --set facet", "--set"),
        ("bless facet --adapter cpu", "--adapter"),
        ("list --preset hatch", "--preset"),
    ] {
        place.play(&format!("$2 {line}\n! {option} has no meaning for "));
    }
}

#[test]
fn the_files_of_the_package_agree_with_each_other() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/package");
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
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
    let place = Place::with([("icon.rasterlab.toml", &read("icon.toml"))]);
    place.play("$ check icon.rasterlab.toml --strict");
}
