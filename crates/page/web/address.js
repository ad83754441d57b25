// What the address names.
//
//   ?preset=ID          a preset of the gallery, from presets/ID.toml; by default hero-night
//   ?preset=URL         the file of a preset
//   ?model=URL          a model, with the look of ?preset if there is one
//   #rasterlab1:…       the line that the window copies
//   #rasterlab1:…;IDS-KEYS   the same from rasterlab link, with the bits that its picture must have
import { OpenPreset, give_file } from "./rasterlab_page.js";
import { isAddress, modelAt, presetAt } from "./fetched.js";
import { give } from "./workers.js";

const FIRST = "hero-night";

/** The text of the preset that the address names, what errors call it, the bits of its picture if the link has them, and the address of a model. */
export async function wanted() {
  const query = new URLSearchParams(location.search);
  const model = query.get("model") || undefined;
  let link = location.hash.slice(1);
  try {
    link = decodeURIComponent(link);
  } catch {
    throw new Error("the link is cut off or garbled; copy it once more, whole");
  }
  if (link) {
    const [text, proof] = link.split(";");
    if (!text.startsWith("rasterlab1:")) throw new Error("the link is none of rasterlab's: behind # it must begin with rasterlab1:");
    if (proof !== undefined && !/^[0-9a-f]{16}-[0-9a-f]{16}$/.test(proof)) throw new Error("the bits behind the link's line are cut off or garbled; copy it once more, whole");
    return { text, id: "link", bits: proof?.split("-") };
  }
  const id = query.get("preset") || (model ? undefined : FIRST);
  if (!id) return { id: "model", model };
  if (isAddress(id)) return { ...(await presetAt(id)), model };
  if (!/^[\w-]+$/.test(id)) throw new Error(`"${id}" is no id of a preset; ids have letters, digits and hyphens`);
  const answer = await fetch(`presets/${id}.toml`);
  if (!answer.ok) throw new Error(`the gallery has no preset "${id}"`);
  return { text: await answer.text(), id, model };
}

/** Opens what the address names; `progress` is told in words how far fetching a model is. */
export async function open({ text, id, model }, progress) {
  const look = text === undefined ? undefined : new OpenPreset(text, id);
  if (!model) return look;
  const files = await modelAt(model, progress);
  files.forEach(([path, bytes]) => give_file(path, bytes));
  give(files);
  const [path] = files[0];
  return look ? look.on_model(path) : OpenPreset.of_model(path);
}
