//! A new file in `presets/` is embedded by the next build.

fn main() {
    println!("cargo:rerun-if-changed=../../presets");
}
