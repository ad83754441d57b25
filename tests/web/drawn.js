// Pictures: drawn on the device and judged, and drawn by the oracle.
import { OpenPreset, Page, can_share_rows, oracle_bits } from "/rasterlab_page.js";
import { asked, oraclePicture } from "/workers.js";
import { largestDifference, report, text } from "/tests/report.js";

// One of every kind: surface, vertex, layers, particles, shadows, dots, image, joints, masks, a picture that needs those before it.
const PRESETS = ["toon", "explode", "xray", "particles", "shadow", "dots", "posterize", "tentacle-twist", "leaves", "smear"];

const golden = async (id) => OpenPreset.golden(new Uint8Array(await (await fetch(`/goldens/${id}.png`)).arrayBuffer()));

export async function refusals() {
  for (const broken of ["rasterlab1:AAAA", "schema = 1", "[scene]\nbuiltin = \"nothing\""]) {
    let said = "";
    try {
      new OpenPreset(broken, "broken");
    } catch (error) {
      said = error.message ?? String(error);
    }
    await report(`refused ${JSON.stringify(broken)}`, said.length > 20 ? [] : [`it says "${said}"`]);
  }
}

export async function presets() {
  const page = await Page.open();
  for (const id of PRESETS) {
    const toml = await text(`/presets/${id}.toml`);
    const preset = new OpenPreset(toml, id);
    const picture = await page.draw(preset);
    const { faults } = await asked({ ask: "verdict", text: toml, id });
    await report(`preset ${id}`, [...faults, ...preset.golden_faults(picture.colors(), await golden(id))]);
    const linked = await page.draw(new OpenPreset(preset.line(), "link"));
    await report(`link of ${id}`, largestDifference(linked.colors(), picture.colors()) > 0 ? ["another picture"] : []);
  }
}

/** The oracle draws every preset in three workers, however many cores the machine has, and its pictures are the goldens. */
export async function oracle() {
  let shared = 0;
  for (const id of JSON.parse(await text("/presets.json"))) {
    const preset = new OpenPreset(await text(`/presets/${id}.toml`), id);
    shared += can_share_rows(preset);
    const parts = [];
    const colors = await oraclePicture(preset, { cores: 3, progress: (part) => parts.push(part) });
    const rises = parts.every((part, i) => part > (parts[i - 1] ?? 0)) && parts.at(-1) === 1;
    const differs = largestDifference(colors, await golden(id));
    await report(`oracle ${id}`, [differs > 0 && `its picture is not the golden: by up to ${differs} of 255`, !rises && `progress ${parts}`]);
  }
  await report("oracle shares rows", shared > 50 ? [] : [`of ${shared} presets`]);
}

export async function cancel() {
  const preset = new OpenPreset(await text("/presets/hero-day.toml"), "hero-day");
  preset.resize(1600, 1200);
  const [stop, began] = [new AbortController(), performance.now()];
  setTimeout(() => stop.abort(), 300);
  const said = await oraclePicture(preset, { signal: stop.signal }).then(() => "it was drawn", (error) => error.message);
  const passed = performance.now() - began;
  await report("cancel", [said !== "it was canceled" && said, passed > 2000 && `after ${passed} ms`]);
}

export async function strictHashes() {
  const page = await Page.open();
  for (const line of (await text("/strict_hashes.txt")).trim().split("\n")) {
    const [query, size, ids, keys] = line.split(" ");
    // Pictures with effects or meshes of the test's own have names of another kind.
    if (size !== "320x240" || !/^[a-z-]+(\?[a-z]+=[\d.]+(&[a-z]+=[\d.]+)*)?$/.test(query) || ["direct", "parallel"].includes(query)) continue;
    const preset = OpenPreset.strict(query);
    const found = (await page.draw(preset)).hashes();
    const wrong = [found, oracle_bits(preset)].filter(([a, b]) => a !== ids || b !== keys);
    await report(`strict ${query}`, wrong.map((words) => `${words.join(" ")} instead of ${ids} ${keys}`));
  }
}
