//! A new file in `shaders/` is embedded by the next build.

fn main() {
    println!("cargo:rerun-if-changed=../../shaders");
}
