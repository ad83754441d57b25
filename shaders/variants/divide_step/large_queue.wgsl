// Divide step, large queue.
//@ use lib/large_queue

fn divide_step_large_queue(group: u32, groups: u32, invocation_index: u32) {
    large_queue_divide(group, groups, invocation_index);
}
