// Divide step: raster_medium finds the tiles of large triangles beside its own work, since neither needs the other.
// Chosen where the number of workgroups is fixed, in the first pass over the medium queue; without it, tile_large is a pass of its own.
//@ steps fn divide_step(group: u32, groups: u32, invocation_index: u32)
