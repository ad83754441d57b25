//! `explain`: which passes and buffers a look needs on this adapter, which it does without, and why.

use serde_json::{Value, json};

use super::{
    args::{Common, Explain},
    fault::{Exit, Fault},
    open,
    painter::{Painter, scene_of},
    streams::{Streams, table},
};
use crate::{effects::Stack, gpu::Explanation, scene::Scene};

pub fn run(common: &Common, args: &Explain, streams: &mut Streams) -> Result<Exit, Fault> {
    let mut look = open(common, &args.look)?;
    look.session.output.size = args.size.unwrap_or(look.session.output.size);
    let scene = scene_of(&look)?;
    // Without an adapter the plan cannot be made, but the look can still be told.
    let painter = match Painter::open(common, streams) {
        Ok(painter) => Some(painter),
        Err(fault) if common.adapter_name().is_none() && fault.exit == Exit::NoAdapter => {
            streams.note(&format!("{}; passes and buffers are not planned", fault.sentence()));
            None
        }
        Err(fault) => return Err(fault),
    };
    let (adapter, plan) = match painter {
        Some(Painter::Gpu(mut renderer, gpu)) => {
            renderer.set_scene(&scene)?;
            let session = &look.session;
            renderer.draw(&session.view(&scene, session.output.size), &session.posed_stack(), &session.accuracy)?;
            (Painter::Gpu(Box::new(crate::gpu::Renderer::new(gpu.clone())), gpu).json(), Some(renderer.explain()))
        }
        Some(painter) => (painter.json(), None),
        None => (Value::Null, None),
    };
    if streams.json {
        let result = json!({
            "look": look.id, "scene": scene_json(&scene), "size": look.session.output.size,
            "effects": effects_json(&look.session.stack), "plan": plan,
        });
        streams.object("explain", adapter, vec![result])?;
    } else {
        streams.text(&text(&look.id, &scene, &look.session.stack, plan.as_ref()))?;
    }
    Ok(Exit::Done)
}

/// Lowest and highest corner of the scene's box; none when it is empty.
fn corners(scene: &Scene) -> Option<[[f64; 3]; 2]> {
    let bounds = scene.bounds();
    (!bounds.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()])
}

fn scene_json(scene: &Scene) -> Value {
    json!({
        "name": scene.name, "triangles": scene.triangle_count(), "vertices": scene.vertex_count(),
        "instances": scene.instances.len(), "box_m": corners(scene), "notes": scene.notes,
    })
}

fn effects_json(stack: &Stack) -> Vec<Value> {
    stack.0.iter().map(|enabled| json!({ "effect": enabled.effect.name, "hook": enabled.effect.hooks.names() })).collect()
}

fn text(id: &str, scene: &Scene, stack: &Stack, plan: Option<&Explanation>) -> String {
    let effects: Vec<_> = stack.0.iter().map(|enabled| format!("{} ({})", enabled.effect.name, enabled.effect.hooks.names())).collect();
    let mut text = format!(
        "look     {id}\nscene    {}: {} triangles, {} vertices, {} instances\nbox      {}\neffects  {}\n",
        scene.name,
        scene.triangle_count(),
        scene.vertex_count(),
        scene.instances.len(),
        corners(scene).map_or_else(|| "empty".into(), |[min, max]| format!("{min:.3?} to {max:.3?} m")),
        if effects.is_empty() { "none".into() } else { effects.join(", ") },
    );
    let Some(plan) = plan else { return text };
    text += &format!("key      {}\n", plan.key);
    let rows = |head: [&str; 3], rows: Vec<Vec<String>>| {
        let all: Vec<_> = std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect();
        if all.len() > 1 { format!("\n{}", table(&all)) } else { String::new() }
    };
    let notes = |notes: &[crate::gpu::Note]| notes.iter().map(|n| vec![n.name.clone(), String::new(), n.why.clone()]).collect();
    let buffers: Vec<_> = plan.buffers.iter().map(|b| vec![b.name.clone(), b.bytes.to_string(), b.why.clone()]).collect();
    let total: u64 = plan.buffers.iter().map(|b| b.bytes).sum();
    text += &rows(["PASS", "", "WHY"], notes(&plan.passes));
    text += &rows(["BUFFER", "BYTES", "WHY"], buffers);
    text += &format!("{total} bytes in all\n");
    text + &rows(["OMITTED", "", "WHY"], notes(&plan.omitted))
}
