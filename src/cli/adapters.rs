//! `adapters`: lists the adapters of this machine. The last one is always `cpu`, the oracle.

use pollster::FutureExt as _;
use serde_json::{Value, json};

use super::{
    backend::{adapter_json, usable_options},
    error::{CliError, Exit},
    streams::{Streams, table},
};
use crate::gpu::device;

pub fn run(streams: &mut Streams) -> Result<Exit, CliError> {
    let adapters = device::list().block_on();
    if streams.json {
        let mut results: Vec<Value> = adapters
            .iter()
            .map(|(summary, caps)| {
                let mut object = adapter_json(summary, caps);
                object["options"] = usable_options(caps)
                    .iter()
                    .map(|option| option.name())
                    .collect();
                object["limits"] = json!(caps);
                object
            })
            .collect();
        results.push(json!({ "name": "cpu", "backend": "cpu", "software": true, "class": "oracle", "options": [] }));
        streams.object("adapters", Value::Null, results)?;
        return Ok(Exit::Done);
    }
    let head = [
        "ADAPTER",
        "BACKEND",
        "DRIVER",
        "CLASS",
        "OPTIONS",
        "BINDING",
        "TIMESTAMPS",
        "KIND",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(adapters.iter().map(|(summary, caps)| {
        let options: Vec<_> = usable_options(caps)
            .iter()
            .map(|option| option.name())
            .collect();
        vec![
            summary.name.clone(),
            summary.backend.clone(),
            summary.driver.clone(),
            caps.class().into(),
            options.join(" "),
            format!("{} MiB", caps.max_storage_binding_bytes >> 20),
            if caps.timestamps { "yes" } else { "no" }.into(),
            if summary.software {
                "software"
            } else {
                "hardware"
            }
            .into(),
        ]
    }));
    let cpu = [
        "cpu", "cpu", "built in", "oracle", "exact", "-", "no", "software",
    ];
    rows.push(cpu.map(str::to_owned).to_vec());
    streams.text(&table(&rows))?;
    if adapters.is_empty() {
        streams.note("there is no GPU adapter; --adapter cpu draws with the built-in oracle");
    }
    Ok(Exit::Done)
}
