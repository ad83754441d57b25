// dots_args: converts the number of listed dots into a workgroup count, folded to two dimensions above 65,535 workgroups, and
// notes it among the frame's counters.
//@ use lib/frame

@group(0) @binding(25) var<storage, read> dot_count: u32;
@group(0) @binding(26) var<storage, read_write> dot_args: array<u32, 3>;

@compute @workgroup_size(1)
fn dots_args() {
    let groups = (dot_count + 63u) / 64u;
    dot_args[0] = min(groups, 65535u);
    dot_args[1] = (groups + 65534u) / 65535u;
    dot_args[2] = 1u;
    atomicStore(&counters.listed_dots, dot_count);
}
