// Bytes, read: attributes as the file has them, and behind them the vertices that were bent.

@group(0) @binding(2) var<storage, read> vertex_bytes: array<u32>;
