// Image, none: a pass before the resolve. The text of image effects comes along with their parameters, and nobody calls it.

fn image_at(x: i32, y: i32) -> vec3u { return vec3u(IMAGE_NO_TRIANGLE, 0u, 0u); }

fn image_previous(pixel: Pixel) -> vec4u { return vec4u(0u); }
