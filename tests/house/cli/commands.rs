//! Promise: what is listed, described, or refused before anything is drawn.

use std::io::Read as _;

use super::*;

#[test]
fn the_version_is_told_and_adapters_end_with_cpu() {
    let place = Place::new();
    let version = concat!("rasterlab ", env!("CARGO_PKG_VERSION"));
    assert_eq!(place.run("--version").out.trim(), version);
    assert!(
        place
            .run("adapters")
            .out
            .lines()
            .last()
            .unwrap()
            .starts_with("cpu ")
    );
    let adapters = place.json("adapters --json");
    assert_eq!(
        adapters["results"].as_array().unwrap().last().unwrap()["name"],
        "cpu"
    );
}

#[test]
fn list_as_json_has_every_preset_and_effect() {
    let object = Place::new().json("list --json");
    assert_eq!(object["command"], "list");
    let of_kind = |kind: &'static str| {
        let results = object["results"].as_array().unwrap().iter();
        results.filter(move |result| result["kind"] == kind)
    };
    for effect in rasterlab::effects::EFFECTS.iter() {
        for kind in ["effect", "preset"] {
            assert!(
                of_kind(kind).any(|result| result["id"] == effect.name),
                "{kind} {}",
                effect.name
            );
        }
    }
}

#[test]
fn a_mistyped_command_is_one_sentence_with_the_command_that_was_meant() {
    for line in ["rendr", "rendr fox.glb -o x.png"] {
        let run = Place::new().run(line);
        assert!(
            run.code == 2 && run.err.contains("did you mean \"render\""),
            "{}",
            run.err
        );
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
    }
    #[cfg(feature = "gui")]
    Place::new().play("$2 verfy\n! did you mean \"verify\"?");
}

#[test]
fn what_no_adapter_could_draw_is_wrong_usage_from_check_on() {
    let place = Place::new();
    for line in [
        "facet --set accuracy.tier=strict --set wobble",
        "facet --set accuracy.coverage=float --set accuracy.depth=integer",
        "walk-dissolve --set accuracy.position_format=packed10",
    ] {
        place.play(&format!("$2 check {line}\n> FAIL"));
        // On an adapter, too, if one is here: another one would not help.
        let render = place.run(&format!("render {line} --size 8x6 -o {{preset}}.png"));
        assert!(
            render.code == 2 || render.err.contains("no adapter"),
            "{line}: {}: {}",
            render.code,
            render.err
        );
    }
    // Every preset of the gallery has a kernel.
    place.play("$ check");
}

#[test]
fn a_model_that_breaks_its_standard_loads_and_strictness_refuses_it() {
    let nodes = r#""nodes":[0,1]}],"nodes":[{"mesh":0},{"children":[0]}]"#;
    let model = TRIANGLE.replace(r#""nodes":[0]}],"nodes":[{"name":"tri","mesh":0}]"#, nodes);
    let place = Place::with([("m.gltf", &model)]);
    let drawn = place.run("render m.gltf CPU8x6");
    let notes = drawn.err.matches("must list root nodes only").count();
    assert_eq!((drawn.code, notes), (0, 1), "{}", drawn.err);
    place.play("$2 render m.gltf CPU8x6 --strict --force\n! must list root nodes only");
}

#[test]
fn a_preset_is_found_by_its_id_and_else_by_its_name_in_any_case() {
    let place = Place::new();
    for (id, name) in [
        ("mine", "First light"),
        ("facet", "Second light"),
        ("other", "second light"),
        ("third", "mine"),
    ] {
        let text = format!(
            "schema = 2\nname = \"{name}\"\n[scene]\nbuiltin = \"teapot?tess=2\"\n[effects.facet]\n"
        );
        place.put(&format!("{id}.toml"), text);
    }
    let render = |name: &str| format!("render '{name}' --presets . CPU8x6 --force");
    for (name, id) in [
        ("First light", "mine"),
        ("FIRST LIGHT", "mine"),
        ("Third", "third"),
        ("mine", "mine"),
        ("cel", "toon"),
    ] {
        place.play(&format!(
            "$ {} --json\n/results/0/preset \"{id}\"",
            render(name)
        ));
    }
    for (name, ids) in [("SECOND LIGHT", "facet, other"), ("Mine", "mine, third")] {
        place.play(&format!(
            "$2 {}\n! several presets are called {name:?}: {ids}; give the id of one",
            render(name)
        ));
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let place = Place::new();
    for line in ["list --json", "completions bash", "render facet CPU -o -"] {
        let mut child = place.start(line);
        drop(child.stdout.take());
        let mut err = String::new();
        child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut err)
            .unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{line}: {err}");
        assert!(
            !err.contains("panicked") && !err.contains("error"),
            "{line}: {err}"
        );
    }
}

#[test]
fn the_oracle_agrees_with_itself() {
    let place = Place::new();
    place.play("$ verify shadow-soft CPU64x48");
    let object = place.json("verify facet-radial depth CPU64x48 --frames 2 --json");
    let rows = object["results"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        for figure in
            "wrong_triangles explained_by_snap holes double_hits depth_without_id overflow max_color_delta".split(' ')
        {
            assert_eq!(row[figure], 0, "{figure} of {row}");
        }
        let told = (&row["rms_color_delta"], &row["ok"], &row["class"]);
        assert_eq!(told, (&0.0.into(), &true.into(), &"oracle".into()));
    }
}

#[test]
fn stress_lists_its_cases_without_an_adapter() {
    let list = Place::new().run("stress --list");
    assert_eq!((list.code, list.err.as_str()), (0, ""));
    let lines: Vec<_> = list.out.lines().collect();
    assert!(lines[0].starts_with("NAME ") && lines[0].ends_with("WHAT"));
    assert_eq!(lines.len(), 1 + rasterlab::extremes::names(None).len());
    let one = Place::new().run("stress --list --filter d3d-rect").out;
    assert!(
        one.lines().count() == 2 && one.contains("25 pixels"),
        "{one}"
    );
}

#[test]
fn stress_says_what_it_expected_and_what_became_of_it() {
    if skips_gpu() {
        return;
    }
    let place = Place::new();
    place.play("$ stress --filter d3d-rectangle\n! adapter:  && 1 case in  && 0 failed");
    let table = place.run("stress --filter d3d-rectangle").out;
    let lines: Vec<Vec<_>> = table
        .lines()
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert_eq!(lines[0], ["NAME", "OUTCOME", "PICTURES", "TRIANGLES", "MS"]);
    assert_eq!(lines[1][..2], ["d3d-rectangle", "passed"]);
    let object = place.json("stress --filter too-many-layers-of-glass --json --quiet");
    assert_eq!(object["command"], "stress");
    assert!(object["adapter"]["name"].is_string());
    let result = &object["results"][0];
    assert_eq!(result["name"], "too-many-layers-of-glass");
    assert_eq!(result["outcome"], "refused as expected");
    assert!(
        result["why"]
            .as_str()
            .is_some_and(|why| why.contains("layers of glass, the most")),
        "{result}"
    );
    assert!(result["ms"].as_f64().is_some_and(|ms| ms > 0.0), "{result}");
}

#[test]
fn explain_measures_the_frame_and_its_passes_when_asked() {
    if skips_gpu() {
        return;
    }
    let place = Place::new();
    let asked = "explain facet --size 64x48 --quiet";
    let times = place.json(&format!("{asked} --measure --json"))["results"][0]["times"].clone();
    assert!(
        times["whole_ms"].as_f64().is_some_and(|ms| ms > 0.0),
        "{times}"
    );
    assert!(
        times["frames"].as_u64().is_some_and(|frames| frames > 2),
        "{times}"
    );
    let is_timed = |pass: &Value| {
        pass[0].as_str().is_some_and(|label| !label.is_empty())
            && pass[1].as_f64().is_some_and(|ms| ms >= 0.0)
    };
    assert!(
        times["passes"]
            .as_array()
            .expect("a list")
            .iter()
            .all(is_timed),
        "{times}"
    );
    place.play(&format!(
        "$ {asked} --measure\n>  ms, measured in \n$ {asked} --json\n/results/0/times null"
    ));
}
