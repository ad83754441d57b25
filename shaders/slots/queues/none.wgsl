// Queues, none: the planner proved from bounds that every triangle is small and none is clipped. Demand is still
// counted, so that a wrong proof shows at once.
//@ use common/counters

fn queues_push_clip(entry: u32) { atomicAdd(&counters.clip, 1u); }

fn queues_push_medium(entry: u32) { atomicAdd(&counters.medium, 1u); }

fn queues_push_large(entry: u32) { atomicAdd(&counters.large, 1u); }
