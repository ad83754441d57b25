// Maps in the material atlas: textures that are no colors, behind the finish of a primitive. Mirrors `gpu::records::MapsRecord`.
//@ use lib/finish_atlas
//@ use lib/material_atlas

// Which maps a primitive has.
struct Maps {
    flags: u32,              // MAPS_* bits: bit k where lookup k is there
    occlusion_strength: f32,
    normal_scale: f32,       // of the first two components of the normals
    tangents: u32,           // byte of the first tangent: three floats for each corner of each triangle
}

const MAPS_FINISH = 0u;
const MAPS_OCCLUSION = 1u;
const MAPS_NORMAL = 2u;
const MAPS_FINISH_WORDS = 6u; // of the finish before them
const MAPS_WORDS = 4u;

// Word of the maps of the primitive whose record begins at this word.
fn maps_record(record: u32) -> u32 {
    return (atlas_word(record) >> FINISH_SHIFT) + MAPS_FINISH_WORDS;
}

fn maps_at(first: u32) -> Maps {
    return Maps(atlas_word(first), atlas_float(first + 1u), atlas_float(first + 2u), atlas_word(first + 3u));
}

fn maps_have(maps: Maps, map: u32) -> bool { return (maps.flags & (1u << map)) != 0u; }

fn maps_lookup(first: u32, map: u32) -> Lookup {
    return atlas_lookup(first + MAPS_WORDS + map * ATLAS_LOOKUP);
}
