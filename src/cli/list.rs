//! `list`: looks, builtin scenes, effects with every parameter and its range, and the accuracy ladder.

use serde_json::{Value, json};

use super::{
    args::{Common, List},
    fault::{Exit, Fault},
    streams::{Streams, table},
};
use crate::{
    effects::{EFFECTS, Effect},
    ladder::{AXES, Axis},
    params::Field,
    preset::{self, GalleryEntry, form::Form, gallery},
    scene::builtin::BUILTINS,
};

pub fn run(common: &Common, args: &List, streams: &mut Streams) -> Result<Exit, Fault> {
    let all = !(args.effects || args.looks || args.scenes || args.axes);
    let entries = if all || args.looks { gallery(common.presets_dir().as_deref()) } else { Vec::new() };
    let effects = if all || args.effects { EFFECTS } else { &[] };
    let scenes = if all || args.scenes { BUILTINS } else { &[] };
    let axes = if all || args.axes { AXES } else { &[] };
    if streams.json {
        let looks = entries.iter().map(look_json);
        let effects = effects.iter().map(|effect| effect_json(effect));
        let scenes = scenes
            .iter()
            .map(|scene| json!({ "kind": "scene", "id": scene.name, "about": scene.about, "parameters": scene_parameters(scene.params) }));
        streams.object("list", Value::Null, looks.chain(effects).chain(scenes).chain(axes.iter().map(axis_json)).collect())?;
    } else {
        let parts = [looks_text(&entries), effects_text(effects), scenes_text(scenes), axes_text(axes)];
        streams.text(&parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n"))?;
    }
    entries.iter().filter_map(|entry| entry.look.as_ref().err()).for_each(|error| streams.note(&format!("warning: {error}")));
    Ok(Exit::Done)
}

fn origin(entry: &GalleryEntry) -> String {
    let word = |origin: preset::Origin| match origin {
        preset::Origin::Chosen => "--presets",
        preset::Origin::Beside => "beside the program",
        preset::Origin::User => "user",
        preset::Origin::Builtin => "built in",
    };
    let shadows: Vec<&str> = entry.shadows.iter().map(|origin| word(*origin)).collect();
    if shadows.is_empty() { word(entry.origin).into() } else { format!("{}, shadows {}", word(entry.origin), shadows.join(" and ")) }
}

fn effect_names(look: &preset::Look) -> Vec<&'static str> {
    look.session.stack.0.iter().map(|enabled| enabled.effect.name).collect()
}

fn looks_text(entries: &[GalleryEntry]) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let mut rows = vec![["LOOK", "NAME", "EFFECTS", "FROM"].map(str::to_owned).to_vec()];
    rows.extend(entries.iter().map(|entry| match &entry.look {
        Ok(look) => vec![entry.id.clone(), look.title().to_owned(), effect_names(look).join(" + "), origin(entry)],
        Err(_) => vec![entry.id.clone(), "(cannot be read)".into(), String::new(), origin(entry)],
    }));
    table(&rows)
}

fn default_text(field: &Field, words: &[u32]) -> String {
    Form::of(field).write(&preset::form::Plain::Numbers(field.get(words))).to_string().trim().to_owned()
}

fn effects_text(effects: &[&Effect]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let mut rows = vec![["EFFECT", "DEFAULT", "ALLOWED", "UNIT", "WHAT"].map(str::to_owned).to_vec()];
    for effect in effects {
        rows.push(vec![
            effect.name.into(),
            String::new(),
            String::new(),
            String::new(),
            format!("{} ({} hook)", effect.about, effect.hooks.names()),
        ]);
        let defaults = (effect.defaults)();
        rows.extend(effect.fields.iter().map(|field| {
            let name = format!("  {}.{}", effect.name, field.name);
            vec![name, default_text(field, &defaults), Form::of(field).allowed(), field.unit.into(), field.doc.trim().into()]
        }));
    }
    table(&rows)
}

fn scene_parameters(params: &[crate::scene::builtin::BuiltinParam]) -> Vec<Value> {
    let parameter = |p: &crate::scene::builtin::BuiltinParam| json!({ "name": p.name, "about": p.doc, "default": p.default, "hard": [p.range.start(), p.range.end()], "whole": p.whole });
    params.iter().map(parameter).collect()
}

fn scenes_text(scenes: &[crate::scene::builtin::Builtin]) -> String {
    if scenes.is_empty() {
        return String::new();
    }
    let mut rows = vec![["SCENE", "DEFAULT", "ALLOWED", "WHAT"].map(str::to_owned).to_vec()];
    for scene in scenes {
        rows.push(vec![scene.name.into(), String::new(), String::new(), scene.about.into()]);
        rows.extend(scene.params.iter().map(|p| {
            let allowed = format!("{}..={}", preset::form::brief(*p.range.start()), preset::form::brief(*p.range.end()));
            vec![format!("  ?{}", p.name), preset::form::brief(p.default), allowed, p.doc.into()]
        }));
    }
    table(&rows)
}

fn axes_text(axes: &[Axis]) -> String {
    if axes.is_empty() {
        return String::new();
    }
    let mut rows = vec![["AXIS", "USUAL", "WHAT"].map(str::to_owned).to_vec()];
    for axis in axes {
        rows.push(vec![format!("accuracy.{}", axis.name), axis.words[axis.usual].into(), axis.about.trim().into()]);
        rows.extend(axis.words.iter().zip(axis.abouts).map(|(word, about)| vec![format!("  {word}"), String::new(), about.trim().into()]));
    }
    table(&rows)
}

fn axis_json(axis: &Axis) -> Value {
    let rungs: Vec<Value> =
        axis.words.iter().zip(axis.abouts).map(|(word, about)| json!({ "name": word, "about": about.trim() })).collect();
    json!({ "kind": "axis", "id": axis.name, "about": axis.about.trim(), "usual": axis.words[axis.usual], "rungs": rungs })
}

fn look_json(entry: &GalleryEntry) -> Value {
    let mut object = json!({
        "kind": "look", "id": entry.id, "origin": entry.origin, "shadows": entry.shadows,
        "file": entry.path.as_ref().map(|path| path.to_string_lossy()),
    });
    match &entry.look {
        Ok(look) => {
            let session = &look.session;
            object["name"] = json!(session.name);
            object["about"] = json!(session.about);
            object["tags"] = json!(session.tags);
            object["effects"] = json!(effect_names(look));
            object["warnings"] = json!(look.warnings);
        }
        Err(error) => object["error"] = json!(error.to_string()),
    }
    object
}

fn effect_json(effect: &Effect) -> Value {
    let defaults = (effect.defaults)();
    let parameter = |field: &Field| {
        json!({
            "name": field.name, "about": field.doc.trim(), "type": field.kind.wgsl(), "unit": field.unit,
            "default": default_text(field, &defaults), "allowed": Form::of(field).allowed(),
            "hard": field.hard, "soft": field.soft, "log": field.log,
        })
    };
    let parameters: Vec<Value> = effect.fields.iter().map(parameter).collect();
    json!({ "kind": "effect", "id": effect.name, "about": effect.about, "hook": effect.hooks.names(), "parameters": parameters })
}
