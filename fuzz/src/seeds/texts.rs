//! Presets, shared lines, command lines and effect files.

use rasterlab::{
    effect_files::{Hook, template},
    preset_file::{self, BUILTIN_DIR},
};
use rasterlab_fuzz::views;

use crate::Seed;

/// Small presets by name; what `not-` begins is refused.
pub const PRESETS: &[(&str, &str)] = &[
    ("empty", "schema = 2\n"),
    ("not-old", "schema = 1\n[clock]\nspeed = 0.5\n"),
    (
        "newer",
        "schema = 99\nname = \"Later\"\n[effects.facet]\namount = 0.5\n",
    ),
    (
        "scene",
        "schema = 2\nname = \"Ink on glass\"\nabout = '''two\nlines'''\ntags = [\"a\", \"b\"]\n[scene]\nbuiltin = \"knot?tess=3\"\nspin_deg_per_s = 90.0\nroom = 2.0\nunit = \"scene\"\n",
    ),
    (
        "camera",
        "schema = 2\n[camera]\neye = [0, 1, 5]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nfov_y_deg = 40\n[output]\nsize = [64, 48]\nbackground = [0, 0.5, 1, 1]\n",
    ),
    (
        "parallel-camera",
        "schema = 2\n[camera]\neye = [0, 1, 5]\ntarget = [0, 0, 0]\nheight_m = 3.0\nnear_m = 0.5\n",
    ),
    (
        "keyframes",
        "schema = 2\n[clock]\nrange_s = [0.0, 2.5]\nloop = false\n[effects.facet]\namount = 0.5\n[animation.facet]\namount = [{ time_s = 0, value = 0 }, { time_s = 2, value = 1, ease = \"hold\" }]\n",
    ),
    (
        "stack",
        "schema = 2\nstack = [\"fog\", \"lambert\", \"hatch\"]\n[effects.fog]\nfalloff = 10.0\n[effects.lambert]\n[effects.hatch]\non = [\"material:*\", \"node:a?\"]\n",
    ),
    (
        "twice",
        "schema = 2\n[effects.facet]\n[effects.facet2]\neffect = \"facet\"\namount = 0.25\n[animation]\nfacet2.amount = [{ time_s = 0, value = 0.5 }]\n",
    ),
    (
        "accuracy",
        "schema = 2\n[accuracy]\ntier = \"fast\"\nwrong_ppm = 5\nchannel = 2\ndepth = \"log16\"\ncoverage = \"float\"\n[test]\nmax_channel = 3\nmax_pixels = 7\nwhy = \"because\"\n",
    ),
    (
        "playback",
        "schema = 2\n[scene]\npath = \"a b/fox.glb\"\ncamera = \"from above\"\n[playback]\nclip = \"Walk\"\nspeed = -2.0\nclip_time_s = 0.5\nsecond_clip = \"Run\"\nblend = 0.25\n",
    ),
    (
        "comments",
        "# first\nschema = 2 # the schema\n\n[effects]\n# inside\nfacet = { amount = 0.5, later = { a = [1, 2] } } # behind\nunknown = {}\n[mine]\nkept = 1979-05-27T07:32:00Z\n",
    ),
    (
        "values",
        "effects.toon = { steps = 3 }\nanimation.toon = { steps = [{ time_s = 0, value = 3 }] }\n",
    ),
    (
        "brings",
        "schema = 2\n[effects.ink]\namount = 0.75\n[effect_files]\nink = '''\nstruct Ink {\n    @range(0.0, 1.0, 0.5) amount: f32,\n}\n\nfn ink(surface: Surface, p: Ink) -> Surface {\n    var s = surface;\n    s.color *= p.amount;\n    return s;\n}\n'''\n",
    ),
    (
        "not-a-number",
        "schema = 2\n[effects.facet]\namount = nan\n",
    ),
    ("not-in-range", "schema = 2\n[clock]\nrange_s = [2, 2]\n"),
    ("not-toml", "schema = 2\n[effects.facet\n"),
    (
        "not-here",
        "schema = 2\n[scene]\npath = \"../../../../etc/passwd\"\n",
    ),
    (
        "not-deep",
        "schema = 2\nx = [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[\n",
    ),
];

/// The small ones, and some of the gallery.
pub fn presets() -> Vec<Seed> {
    let small = PRESETS
        .iter()
        .map(|(name, text)| (format!("{name}.toml"), text.as_bytes().to_vec()));
    let gallery = BUILTIN_DIR.files().filter(|file| {
        file.path()
            .extension()
            .is_some_and(|extension| extension == "toml")
    });
    let gallery = gallery.map(|file| {
        (
            format!("gallery-{}", file.path().display()),
            file.contents().to_vec(),
        )
    });
    small.chain(gallery).collect()
}

pub fn shared() -> Vec<Seed> {
    let small = PRESETS
        .iter()
        .map(|(name, text)| (*name, (views::SHARED_TOML.close)(b"", text.as_bytes())));
    let line = preset_file::to_line(&preset_file::parse(PRESETS[6].1, "seed").expect("a preset"));
    let bomb = (views::SHARED_TOML.close)(b"", "# ".repeat(600_000).as_bytes());
    let broken = line
        .as_bytes()
        .chunks(40)
        .collect::<Vec<_>>()
        .join(&b"\r\n  "[..]);
    let others = [
        ("whole", line.clone().into_bytes()),
        ("cut", line.as_bytes()[..line.len() / 2].to_vec()),
        ("in-pieces", broken),
        ("unpacks-to-more", bomb),
        ("no-line", b"rasterlab2:AAAA".to_vec()),
        ("nothing", b"rasterlab1:".to_vec()),
    ];
    small
        .chain(others)
        .map(|(name, bytes)| (format!("{name}.txt"), bytes))
        .collect()
}

pub fn command_lines() -> Vec<Seed> {
    const LINES: &[&str] = &[
        "render facet -o {preset}_{n:3}.png --size 4x3 --time -1.5 --tier fast --bare",
        "sequence hero-day -o f_{frame:4}.png --frames 0..3 --fps 24 --from 0 --to 2 --turntable=scene --apng a.png",
        "sweep facet --vary facet.amount=0..1:5 --vary facet.pattern=uniform,sweep,radial -o a.png",
        "sweep facet --vary clock.time_s=0,1e9,-3 --vary output.size=1..5:3",
        "check --set facet.amount=.5 --set fog --unset lambert --strict --json",
        "check --set effects.facet.on=material:* --set stack=[\"lambert\",\"facet\"] --set scene.builtin=knot?tess=3",
        "check --set facet2.effect=facet --set facet2.amount=0.1 --set animation.facet2.amount=[{time_s=0,value=1}]",
        "check --set camera.eye=[1,2,3] --set camera --set test.max_pixels=5 --set test.why=broad --set polyline=[[0,0,0],[1,1,1]]",
        "check --set output.size=[64,48] --set output.background=[0,0,0,1] --set clock.range_s=[1,2] --set accuracy.depth=log16 --set accuracy.tier=strict",
        "check --set name=\"a\\nb\" --set tags=[\"x\"] --unset animation --unset stack --unset camera --unset facet.amount",
        "verify a.toml --frames 3 --size 1920x1080 --adapter cpu",
        "compare a.png b.png --max-channel 300",
        "bench --scene builtin:knot?tess=4 --axes depth,coverage",
        "fuzz --seed 18446744073709551615 --count 4294967295",
        "new-effect ink --hook pixel",
        "completions bash",
        "--set facet.amount",
    ];
    let seed = |(number, line): (usize, &&str)| {
        (
            format!("{number:02}.txt"),
            line.replace(' ', "\n").into_bytes(),
        )
    };
    LINES.iter().enumerate().map(seed).collect()
}

pub fn effects() -> Vec<Seed> {
    let templates = Hook::ALL.map(|hook| {
        (
            format!("{}.wgsl", hook.name()),
            template("ink", hook).into_bytes(),
        )
    });
    let surface = |name: &str, statements: &str| {
        let head = "//@ use lib/surface\n\nstruct Ink {\n    /// Strength.\n    @range(0.0, 1.0, 0.5) amount: f32,\n}\n\nfn helper(x: f32) -> f32 {\n    return 2.0 * x;\n}\n\n";
        let text = format!(
            "{head}fn ink(surface: Surface, p: Ink) -> Surface {{\n    var s = surface;\n    {statements}\n    return s;\n}}\n"
        );
        (format!("{name}.wgsl"), text.into_bytes())
    };
    let deep = format!("s.color *= {}p.amount{};", "(".repeat(80), ")".repeat(80));
    let others = [
        surface("calls", "s.color *= helper(p.amount);"),
        surface(
            "loop",
            "for (var i = 0u; i < 10u; i++) { s.color *= 0.99; if i == 7u { continue; } }",
        ),
        surface("endless", "loop { s.color *= 0.99; }"),
        surface(
            "nested-loops",
            "for (var i = 0u; i < 999u; i++) { for (var j = 0u; j < 999u; j++) { s.color *= 0.9; } }",
        ),
        surface(
            "array",
            "var a = array<f32, 4096>(); s.color *= a[u32(p.amount)];",
        ),
        surface(
            "large-array",
            "var a: array<array<f32, 4096>, 4096>; s.color *= a[0][0];",
        ),
        surface(
            "switch",
            "switch u32(p.amount) { case 0u, 1u: { s.color *= 0.5; } default: { } }",
        ),
        surface(
            "matrix",
            "let m = mat3x3<f32>(s.color, s.color, s.color); s.color = transpose(m) * s.color;",
        ),
        surface(
            "bits",
            "s.color *= bitcast<f32>(bitcast<u32>(p.amount) & 0xffu) + f32(countOneBits(7u));",
        ),
        surface("pointer", "let q = &s.color; *q *= 0.5;"),
        surface("deep", &deep),
        surface("long-name", &format!("let {} = 1.0;", "a".repeat(3000))),
        ("not-utf8.wgsl".into(), b"fn ink(\xff".to_vec()),
        (
            "reordering.wgsl".into(),
            "// \u{202e}text\nfn ink() {}".into(),
        ),
    ];
    templates.into_iter().chain(others).collect()
}
