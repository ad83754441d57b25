// How materials reflect, in the material atlas behind its records. Mirrors `gpu::records::FinishRecord`.
//@ use lib/finish
//@ use lib/material_atlas

// What the atlas says of how a primitive reflects.
struct FinishRecord {
    red: f32,      // reflectance straight on, of what is no metal
    green: f32,
    blue: f32,
    grazing: f32,
    metallic: f32,
    roughness: f32,
}

// Of the flags of a material, the lowest bit of the word of its finish.
const FINISH_SHIFT = 4u;

// The finish of the primitive whose record begins at this word.
fn finish_record(record: u32) -> FinishRecord {
    let first = atlas_word(record) >> FINISH_SHIFT;
    return FinishRecord(
        atlas_float(first), atlas_float(first + 1u), atlas_float(first + 2u), atlas_float(first + 3u),
        atlas_float(first + 4u), atlas_float(first + 5u));
}

fn finish_of(record: FinishRecord) -> Finish {
    return Finish(vec4f(record.red, record.green, record.blue, record.grazing), record.metallic, record.roughness, 1.0);
}
