//! Files that are read: what they say reaches the effect, and they link and validate beside
//! anything else.

use std::sync::Arc;

use rasterlab::{
    accuracy::{Parameters, Visibility},
    effect_files::{Hook, check_name, read, template},
    effects::{EFFECTS, Effect},
    params::ValueType,
    shader::Fetch,
};

use super::{
    super::shaders::{all_passes, key, validate},
    read_ink, with_declarations, with_members, with_statements,
};

/// Effects with as many features of the language as there are room for.
pub const EXAMPLES: [&str; 8] = [
    "// Ink: loops, helpers and every kind of parameter.
//@ use lib/surface
//@ use lib/hash
//@ use lib/color

const STEPS = 4u;
const TABLE = array<f32, STEPS>(0.1, 0.2, 0.3, 0.4);
alias Triple = vec3f;

struct Pair {
    amount: f32,
    helper: Triple,
}

struct Ink {
    /// How.
    @choice(plain, cross-hatch) @default(cross-hatch) mode: u32,
    @range(0.0, 1.0, 0.5) @hard(-4, 4) @unit(m) @when(mode, plain) amount: f32,
    @range(-8, 8, -3) offset: i32,
    @range(1, 9, 3) count: u32,
    @toggle(1) helper: u32,
    @color(1.0, 0.5, 0.25) tint: vec4f,
    @point(1.0, -2.0, 3.5) at: vec4<f32>,
}

fn helper(pair: Pair, amount: f32) -> Triple {
    var helper = pair.helper * amount;
    for (var i = 0u; i < STEPS; i++) {
        if i == 2u { continue; }
        helper += TABLE[i];
        while helper.x > 4.0 { helper -= 1.0; }
    }
    return helper;
}

fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    let pair = Pair(p.amount, s.normal);
    if p.mode == INK_MODE_CROSS_HATCH && p.helper != 0u {
        s.color = vec4f(helper(pair, hash_unit(s.triangle_id)), 1.0);
    }
    var turns = 0;
    loop { turns += p.offset; if turns > 10 { break; } continuing { turns++; } }
    switch p.count { case 1u, 2u: { s.rank = f32(turns); } default: { s.rank = color_luminance(p.tint.rgb); } }
    return s;
}
",
    "/* Ink: the sample hook with a helper
   /* and nested comments that name frame, draws and color */
*/
struct Ink { @range(1, 64, 8) side: u32 } // one line
fn helper(at: vec2u, side: u32) -> u32 { return at.x / side + at.y / side; }
fn is_drawn(sample: Sample, p: Ink) -> bool { return (helper(sample.at, p.side) & 1u) == 0u && sample_total_area(sample) > 0u; }
fn painted(surface: Surface, p: Ink) -> Surface { var s = surface; s.color.r = f32(helper(vec2u(s.pixel), p.side)); return s; }
//@ use lib/sample
",
    "struct Ink { @range(0.0, 0.5, 0.1) @unit(m) helper: f32 }
fn helper(x: f32) -> f32 { return x * 0.5; }
fn hook_vertex(vertex: Vertex, p: Ink) -> Vertex { var v = vertex; v.offset += v.normal * helper(p.helper); return v; }
fn limit(surface: Surface, p: Ink) -> Surface { var s = surface; for (var i = 0; i < 3; i++) { s.rank += helper(p.helper); } return s; }",
    "//@ use lib/image
struct Ink { @range(0.0, 0.5, 0.1) @unit(m) helper: f32 }
fn helper(x: f32) -> f32 { return x * 0.5; }
fn turns(pixel: Pixel, p: Ink) -> Pixel {
    var q = pixel;
    let id = image_at(i32(q.x) + 1, i32(q.y)).x;
    if image_has(i32(q.x), -1) || id == IMAGE_NO_TRIANGLE { q.color = image_background(); }
    q.color += vec4f(image_previous(pixel)) / 255.0 * helper(p.helper);
    return q;
}",
    "// Ink: passes of several sizes, with a helper and a loop.
struct Ink { @range(1, 8, 3) radius: i32 }
fn helper(at: ImageAt, p: Ink, step: i32) -> vec4f { return image_last(at.x + step * p.radius, at.y); }
@pass(quarter) fn small(at: ImageAt, p: Ink) -> vec4f { return image_color_at(image_middle(at).x, image_middle(at).y); }
@pass(full)
fn ink(at: ImageAt, p: Ink) -> vec4f {
    var sum = vec4f(0.0);
    for (var i = -2; i <= 2; i++) { sum += helper(at, p, i); }
    if image_at(at.x, at.y).x == IMAGE_NO_TRIANGLE { sum.r += image_depth_m(at.x, at.y) * image_pixel_size_m(1.0); }
    return sum;
}",
    "// Ink: a pass that is kept.
struct Ink { @range(0.0, 1.0, 0.5) helper: f32 }
@kept(3, 0.5) @pass(quarter)
fn kept(at: ImageAt, p: Ink) -> vec4f { return p.helper * image_kept(at.x - 1, at.y) + image_color(4 * at.x, 4 * at.y); }
fn ink(at: ImageAt, p: Ink) -> vec4f { return image_last(at.x / 4, at.y / 4) + image_kept_at(0.5, f32(at.size.y)); }",
    "// Ink: constants in let, of which naga's pipelines once made what its writers could not write; half words.
struct Ink { @range(0.0, 1.0, 0.5) helper: f32 }
fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    let g = vec2f(0.2, 0.3);
    let size = vec2f(320.0, 240.0);
    let aspect = size.x / size.y;
    let m = mat2x2f(0.8, 0.6, -0.6, 0.8);
    let halves = unpack2x16float(pack2x16float(g * p.helper));
    s.color = vec4f(abs(s.normal), g.x + 1.0) * aspect * m[0].y + reflect(g, halves).x;
    return s;
}
",
    "// Ink: a picture inside the text, and noise.
//@ use lib/noise
struct Ink {
    @color(1.0, 0.5, 0.25) tint: vec4f,
    @image(\"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mOIAgAAXABbdTws1wAAAABJRU5ErkJggg==\") helper: u32,
    @range(0.0, 1.0, 0.5) amount: f32,
}
fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    let found = noise_cellular(s.position, image_file_size(p.helper).x);
    let noise = noise_value(s.position, 1u) + noise_simplex(s.position, 2u) + noise_layers(s.position, 3u, 4u);
    s.color = p.tint * (image_file_at(p.helper, s.screen) + image_file_tiled(p.helper, found.xy) * noise * p.amount);
    return s;
}",
];

fn accepted(text: &str) -> Arc<Effect> {
    read_ink(text).unwrap_or_else(|error| panic!("{error}\n---\n{text}"))
}

/// Validates every pass with these effects.
fn validates(effects: Vec<Arc<Effect>>) {
    for is_baked in [false, true] {
        let mut key = key(Fetch::Indexed, Visibility::Split32, true, effects.clone());
        if is_baked {
            key.options.parameters = Parameters::Baked;
            key.effects.baked = effects
                .iter()
                .map(|effect| effect.defaults.clone())
                .collect();
        }
        for pass in all_passes(&key) {
            validate(&key, pass);
        }
    }
}

fn all_examples() -> Vec<String> {
    let mut texts: Vec<String> = Hook::ALL
        .iter()
        .map(|hook| template("ink", *hook))
        .collect();
    texts.extend(EXAMPLES.map(str::to_owned));
    texts
}

#[test]
fn templates_and_examples_link_alone_and_beside_all_others() {
    let texts = all_examples();
    let mut effects = Vec::new();
    for (index, text) in texts.iter().enumerate() {
        validates(vec![accepted(text)]);
        let stem = format!("ink{index}");
        let text = text.replace("INK_MODE", &format!("INK{index}_MODE"));
        effects.push(
            read(&format!("{stem}.wgsl"), &stem, &text).unwrap_or_else(|error| panic!("{error}")),
        );
    }
    validates(effects.clone());
    validates(EFFECTS.iter().cloned().chain(effects).collect());
}

#[test]
fn names_of_two_files_never_meet() {
    // Without a mark between the two parts these would both be custom_ink_a_b and INK_A_B_C.
    let one = with_members("@choice(x, c) a_b: u32,")
        + "fn a_b() -> f32 { return 1.0; }\nfn b() -> f32 { return a_b(); }\n";
    let other = one
        .replace("a_b: u32", "b: u32")
        .replace("fn a_b()", "fn b_()")
        .replace("a_b()", "b_()");
    let effects = [("ink", &one), ("ink_a", &other)].map(|(stem, text)| {
        let text = text.replace(
            "return surface;",
            &format!("var s = surface; s.rank = f32({}); return s;", "1u"),
        );
        read(&format!("{stem}.wgsl"), stem, &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    });
    validates(effects.to_vec());
}

#[test]
fn templates_suit_every_name() {
    for name in [
        "a",
        "s",
        "p",
        "v",
        "q",
        "rim",
        "a_1b",
        "type",
        "turns",
        "square",
        "center",
        "hook_surface",
        "x2",
        "dark",
        "wave",
    ] {
        if let Err(reason) = check_name(name) {
            assert!(reason.contains("word of WGSL"), "{name} {reason}");
            continue;
        }
        for hook in Hook::ALL {
            let text = template(name, hook);
            let effect = read("x.wgsl", name, &text).unwrap_or_else(|error| panic!("{error}"));
            validates(vec![effect.clone()]);
        }
    }
}

#[test]
fn line_ends_comments_and_marks_change_nothing() {
    for text in all_examples() {
        let plain = accepted(&text);
        let others = [
            text.replace('\n', "\r\n"),
            format!("\u{feff}{text}"),
            format!("\u{feff}{}", text.replace('\n', "\r\n")),
            text.trim_end().to_owned(),
            text.replace("    ", "\t"),
            text.replace("{\n", "{ /* frame draws /* color */ é */ // hash\n"),
            format!("{text}\n\n// frame"),
        ];
        for other in others {
            let effect = accepted(&other);
            assert_eq!(effect.about, plain.about);
            assert_eq!(effect.defaults, plain.defaults);
            validates(vec![effect.clone()]);
        }
    }
}

#[test]
fn names_of_ones_own_are_ones_own() {
    let statements = [
        "let größe = 2.0; s.rank = größe;",
        "let Δ = helper(1.0); s.rank = Δ;",
        "let helper = helper(1.0); s.rank = helper;",
        "var turns = 1.0; turns += 1.0; s.rank = turns;",
        "let frame = 1.0; let effects = frame; s.rank = effects;",
        "let size = 1.0; let color = size; s.rank = color;",
        "let v = 1.0; { let p = v; s.rank = p; }",
        "var private_part = 1.0; let storage = private_part; s.rank = storage;",
        "let custom_ink__helper = 1.0; s.rank = custom_ink__helper;",
        "let texture_like = 1.0; s.rank = (texture_like);",
        "s.rank = helper(s.rank) / helper(2.0);",
        "let f = helper(1.0); let ink = f; s.rank = ink;",
        "let q = &s; (*q).rank = 1.0; q.rank += 1.0;",
        "var a = array<vec2f, 16>(); a[s.triangle_id % 16u].x = 1.0; s.rank = a[3].x;",
        "s.rank = vec4f(1.0, 2.0, 3.0, 4.0).wzyx.x;",
        "if s.rank < 1.0 { s.rank = 1.0; } else if s.rank < 2.0 { s.rank = 2.0; } else { s.rank = 3.0; }",
    ];
    let mut effects = Vec::new();
    let mut add = |text: String| {
        let stem = format!("ink{}", effects.len());
        effects.push(read("x.wgsl", &stem, &text).unwrap_or_else(|error| panic!("{error}")));
    };
    statements
        .iter()
        .for_each(|statement| add(with_statements(statement)));
    let declarations = [
        "fn amount(color: f32) -> f32 { return color; }",
        "fn color(amount: f32) -> vec4f { return vec4f(amount); }",
        "fn frame() -> f32 { return 1.0; }\nfn uses_frame() -> f32 { return frame(); }",
        "fn hash(x: u32) -> u32 { return x; }\nfn uses_hash() -> u32 { return hash(1u); }",
        "struct Frame { size: f32 }\nfn size(f: Frame) -> f32 { return f.size; }",
        "struct Effects { x: f32 }\nfn effects(e: Effects) -> f32 { return e.x; }",
        "fn texture_size(x: f32) -> f32 { return x; }\nfn quad(x: f32) -> f32 { return texture_size(x); }\nfn q2() -> f32 { return quad(1.0); }",
        "fn atomic_number(x: f32) -> f32 { return x; }\nfn uses() -> f32 { return atomic_number(1.0); }",
        "fn turns() -> f32 { return 1.0; }\nfn hook_surface() -> f32 { return turns(); }",
        "fn größe() -> f32 { return 1.0; }\nfn uses() -> f32 { return größe(); }",
        "const_assert 1 < 2;\nconst A = 1.0; const B = A + 1.0;;",
        "struct Aligned { @align(16) x: f32, @size(32) y: vec2f }\nfn align(a: Aligned) -> f32 { return a.x; }\nfn size() -> f32 { return 1.0; }",
        "fn in_place(x: ptr<function, f32>) { *x += 1.0; }\nfn uses() -> f32 { var x = 1.0; in_place(&x); return x; }",
        "fn matrix(m: mat3x3f) -> vec3f { return m * vec3f(1.0) + m[0].zyx; }",
        "fn Helper(s: f32) -> f32 { return s; }",
    ];
    declarations
        .iter()
        .for_each(|declaration| add(with_declarations(declaration)));
    add(with_declarations("").replace("Ink", "ink_values"));
    // All declare the same names.
    validates(effects);
}

#[test]
fn loops_end() {
    use glam::DVec4;
    let statements = [
        "loop { s.rank += 1.0; }",
        "while true { s.rank += 1.0; }",
        "for (;;) { s.rank += 1.0; }",
        "for (;;) { for (;;) { loop { s.rank += 1.0; } } }",
        "for (var i = 0u; i < 4000000000u; i++) { s.rank += 1.0; continue; }",
        "loop { s.rank += 1.0; continuing { s.rank += 1.0; break if s.rank < 0.0; } }",
        "loop { switch 1u { case 1u: { continue; } default: { } } }",
        "loop { if helper(s.rank) < -1.0 { break; } else { continue; } }",
        "var i = 0u; while i < i + 1u { i += 0u; }",
    ];
    for statement in statements {
        let effect = accepted(&with_statements(statement));
        validates(vec![effect.clone()]);
        let surface = super::super::twins::plain_surface();
        let apply = effect.hooks.surface.as_ref().expect("a surface effect");
        // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
        let start = std::time::Instant::now();
        let mut result = [surface];
        apply(&mut result, &effect.defaults);
        let [result] = result;
        assert!(
            result.color != DVec4::NAN && !result.color.is_nan(),
            "{statement} did not end"
        );
        assert!(
            start.elapsed() < super::MOST_TIME,
            "{statement} took {:?}",
            start.elapsed()
        );
    }
}

#[test]
fn what_the_file_says_reaches_the_effect() {
    let effect = accepted(EXAMPLES[0]);
    assert_eq!(effect.about, "loops, helpers and every kind of parameter");
    let field = |name: &str| effect.field(name).unwrap_or_else(|| panic!("no {name}"));
    assert_eq!(field("mode").doc, "How.");
    assert_eq!(
        field("mode").value_type,
        ValueType::choice(&["plain", "cross-hatch"])
    );
    let words = &effect.defaults;
    assert_eq!(field("mode").get(words), [1.0]);
    assert_eq!(
        (
            field("amount").hard,
            field("amount").soft,
            field("amount").unit.as_str()
        ),
        ([-4.0, 4.0], [0.0, 1.0], "m")
    );
    assert_eq!(
        field("amount").when,
        Some(("mode".into(), vec!["plain".into()]))
    );
    assert_eq!(field("offset").get(words), [-3.0]);
    assert_eq!(field("count").get(words), [3.0]);
    assert_eq!(field("helper").get(words), [1.0]);
    assert_eq!(field("tint").get(words), [1.0, 0.5, 0.25, 1.0]);
    assert_eq!(field("at").get(words), [1.0, -2.0, 3.5]);
    let [one, other] = [
        accepted(EXAMPLES[2]).hooks.clone(),
        accepted(EXAMPLES[3]).hooks.clone(),
    ];
    assert!(
        one.vertex.is_some()
            && one.surface.is_some()
            && one.sample.is_none()
            && one.image.is_none()
    );
    assert!(
        other.image.is_some_and(|image| image.reads_previous)
            && other.surface.is_none()
            && other.vertex.is_none()
    );
}
