//! Compressed streams, as the reference encoders wrote them for the tests of the loader.

use base64::{Engine as _, prelude::BASE64_STANDARD};
use serde_json::Value;

use crate::Seed;

/// Streams behind the five bytes that `targets/compressed.rs` reads.
pub fn seeds() -> Vec<Seed> {
    let draco = entries(include_str!("../../../tests/house/loader/draco.json"));
    let meshopt = entries(include_str!("../../../tests/house/loader/meshopt.json"));
    let of_draco = draco.iter().map(|entry| {
        seed(
            entry,
            "draco",
            [0, indices(entry) as u8, 0],
            number(entry, "points"),
        )
    });
    let of_meshopt = meshopt.iter().map(|entry| {
        let kind = 1 + position(entry, "mode", &["ATTRIBUTES", "TRIANGLES", "INDICES"]);
        let filter = position(
            entry,
            "filter",
            &["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"],
        );
        seed(
            entry,
            "meshopt",
            [kind, number(entry, "stride") as u8, filter],
            number(entry, "count"),
        )
    });
    of_draco.chain(of_meshopt).collect()
}

fn entries(text: &str) -> Vec<Value> {
    serde_json::from_str(text).expect("a list of entries")
}

fn number(entry: &Value, name: &str) -> usize {
    entry[name].as_u64().unwrap_or_default() as usize
}

fn position(entry: &Value, name: &str, of: &[&str]) -> u8 {
    of.iter()
        .position(|known| entry[name] == **known)
        .unwrap_or_default() as u8
}

fn indices(entry: &Value) -> usize {
    entry["indices"].as_array().map_or(0, Vec::len)
}

fn seed(entry: &Value, codec: &str, [kind, stride, filter]: [u8; 3], count: usize) -> Seed {
    let [low, high] = (count as u16).to_le_bytes();
    let stream = BASE64_STANDARD
        .decode(entry["encoded"].as_str().expect("a stream"))
        .expect("base64");
    let name = format!(
        "{codec}-{}",
        entry["name"].as_str().expect("a name").replace(' ', "-")
    );
    (
        name,
        [&[kind, stride, filter, low, high], &stream[..]].concat(),
    )
}
