// Bytes, written: attributes as the file has them, and behind them the vertices that are bent.

@group(0) @binding(2) var<storage, read_write> vertex_bytes: array<u32>;
