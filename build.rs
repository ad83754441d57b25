//! A new file in `presets/` or `shaders/` is embedded by the next build.

fn main() {
    println!("cargo:rerun-if-changed=presets");
    println!("cargo:rerun-if-changed=shaders");
}
