// Records, read: projected vertices, and behind them what sample effects decided per triangle.

@group(0) @binding(4) var<storage, read> vertices: array<vec4u>;
