// Records, written: projected vertices, and behind them what sample effects decide per triangle.

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;
