//! Promise: the script that changes the shaders one line at a time changes what it says, and its
//! list of equivalent mutants fits the shaders.

use std::{path::Path, process::Command};

#[test]
fn the_parts_of_the_script_do_what_they_say() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let has_python = Command::new("python3")
        .args(["-c", "import concurrent.futures, unittest"])
        .output()
        .is_ok_and(|run| run.status.success());
    if !has_python {
        eprintln!(
            "skipped: scripts/mutants.py needs python3 with its standard library, which is not here"
        );
        return;
    }
    let run = Command::new("python3")
        .arg(root.join("scripts/mutants.py"))
        .arg("--self-test")
        .output()
        .expect("python3 starts");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && said.contains("OK"), "{said}");
}
