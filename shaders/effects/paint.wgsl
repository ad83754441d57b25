// Paint: brush strokes that follow the shapes. An anisotropic Kuwahara filter.
//@ use lib/image_pass

struct Paint {
    /// Size of the brush.
    @range(1, 10, 4) @hard(1, 24) @unit(px) radius_px: f32,
    /// How much longer strokes get along shapes.
    @range(0, 2, 1.2) stretch: f32,
    /// How far the directions of strokes are smoothed.
    @range(0, 8, 3) @hard(0, 32) @unit(px) smooth_px: f32,
    /// How sharply the edges of strokes are cut.
    @range(1, 10000, 1000) @hard(0, 100000) @log hardness: f32,
    /// Strength of the colors: 1 as they are.
    @range(0, 2, 1.15) @hard(0, 4) saturation: f32,
}

// Sums over four sectors, one in each component.
struct PaintSectors {
    weight: vec4f,
    red: vec4f,
    green: vec4f,
    blue: vec4f,
    square: vec4f,
}

// How the picture changes across and down: squares and product, as the eye sees it.
fn paint_tensor(at: ImageAt, p: Paint) -> vec4f {
    var across = vec3f(0.0);
    var down = vec3f(0.0);
    for (var i = -1; i <= 1; i += 1) {
        let weight = f32(2 - abs(i));
        across += weight * (paint_tone(at.x + 1, at.y + i) - paint_tone(at.x - 1, at.y + i));
        down += weight * (paint_tone(at.x + i, at.y + 1) - paint_tone(at.x + i, at.y - 1));
    }
    return vec4f(dot(across, across), dot(across, down), dot(down, down), 1.0);
}

fn paint_across(at: ImageAt, p: Paint) -> vec4f {
    return paint_mean(at, vec2i(1, 0), p.smooth_px);
}

fn paint_down(at: ImageAt, p: Paint) -> vec4f {
    return paint_mean(at, vec2i(0, 1), p.smooth_px);
}

// Of eight sectors around a pixel, stretched along the shape that it lies on, the calmest give their color.
fn paint_stroke(at: ImageAt, p: Paint) -> vec4f {
    let tensor = image_last(at.x, at.y);
    let difference = tensor.x - tensor.z;
    let root = sqrt(difference * difference + 4.0 * tensor.y * tensor.y);
    let trace = tensor.x + tensor.z;
    // Along the shape: the direction of least change.
    let first = vec2f(root - difference, -2.0 * tensor.y);
    let second = vec2f(-2.0 * tensor.y, root + difference);
    let along = select(second, first, difference < 0.0);
    let size = length(along);
    let calm = select(vec2f(1.0, 0.0), along / max(size, 1e-12), size > 1e-9);
    let narrow = 1.0 + p.stretch * root / (trace + 0.002);
    let long = p.radius_px * narrow;
    let wide = p.radius_px / narrow;
    let reach = vec2i(ceil(sqrt(calm * calm * long * long + calm.yx * calm.yx * wide * wide)));

    var straight: PaintSectors;
    var slanted: PaintSectors;
    let middle = paint_tone(at.x, at.y);
    for (var j = -reach.y; j <= reach.y; j += 1) {
        for (var i = -reach.x; i <= reach.x; i += 1) {
            let step = vec2f(vec2i(i, j));
            let v = vec2f(dot(step, calm) / long, dot(step, vec2f(-calm.y, calm.x)) / wide);
            let near = 1.0 - dot(v, v);
            if near > 0.0 {
                let tone = paint_tone(at.x + i, at.y + j) - middle;
                straight = paint_added(straight, tone, near, v);
                slanted = paint_added(slanted, tone, near, 0.7071067811865476 * vec2f(v.x - v.y, v.x + v.y));
            }
        }
    }
    let sums = paint_calmest(straight, p.hardness) + paint_calmest(slanted, p.hardness);
    let sum = sums.rgb;
    let weights = sums.w;
    let tone = max(middle + sum / weights, vec3f(0.0));
    let gray = (tone.r + tone.g + tone.b) / 3.0;
    let vivid = max(gray + p.saturation * (tone - gray), vec3f(0.0));
    return vec4f(vivid * vivid, image_color(at.x, at.y).a);
}

// The sums of four sectors and of one tone more, at a place of the ellipse.
fn paint_added(sums: PaintSectors, tone: vec3f, near: f32, place: vec2f) -> PaintSectors {
    let shape = paint_sectors(place);
    let weight = near * near * shape * shape;
    return PaintSectors(
        sums.weight + weight,
        sums.red + tone.r * weight,
        sums.green + tone.g * weight,
        sums.blue + tone.b * weight,
        sums.square + dot(tone, tone) * weight);
}

// The mean tones of four sectors, each as often as it is calm, and how often that is.
fn paint_calmest(sums: PaintSectors, hardness: f32) -> vec4f {
    let share = max(sums.weight, vec4f(1e-9));
    let red = sums.red / share;
    let green = sums.green / share;
    let blue = sums.blue / share;
    let rough = hardness * max(sums.square / share - (red * red + green * green + blue * blue), vec4f(0.0));
    let weight = 1.0 / (1.0 + rough * rough);
    return vec4f(dot(red, weight), dot(green, weight), dot(blue, weight), dot(weight, vec4f(1.0)));
}

// How far a place belongs to the sectors on the right, below, on the left and above; of all, the neighbors overlap.
fn paint_sectors(v: vec2f) -> vec4f {
    let across = 0.25 - 0.6 * v.y * v.y;
    let down = 0.25 - 0.6 * v.x * v.x;
    return max(vec4f(v.x + across, v.y + down, -v.x + across, -v.y + down), vec4f(0.0));
}

// Square roots are about what the eye sees.
fn paint_tone(x: i32, y: i32) -> vec3f {
    return sqrt(max(image_color(x, y).rgb, vec3f(0.0)));
}

fn paint_mean(at: ImageAt, along: vec2i, radius: f32) -> vec4f {
    let reach = i32(ceil(radius));
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -reach; i <= reach; i += 1) {
        let t = f32(i) / (radius + 1.0);
        let weight = max(1.0 - t * t, 0.0);
        sum += weight * image_last(at.x + i * along.x, at.y + i * along.y);
        weights += weight;
    }
    return sum / weights;
}
