// What the address names.
//
//   ?preset=ID          a preset of the gallery, from presets/ID.toml; by default hero-night
//   ?preset=URL         the file of a preset
//   ?model=URL          a model, with the look of ?preset if there is one
//   #rasterlab1:…       the line that the window copies
//   #rasterlab1:…;IDS-KEYS   the same from rasterlab link, with the bits that its picture must have
import { OpenPreset, give_file } from "./rasterlab_page.js";
import { isAddress, modelAt, presetAt } from "./fetched.js";
import { presets } from "./gallery.js";
import { give } from "./workers.js";

export const FIRST = "hero-night";

const cut = () => new Error("This link is cut off. Copy it once more, whole");

/** Something that does not exist under these words: the page leads to what is like it. */
const absent = (text, like) => Object.assign(new Error(text), { like });

/** The text of the preset that the address names, what errors call it, the bits of its picture if the link has them, and the address of a model. */
export async function wanted() {
  const query = new URLSearchParams(location.search);
  const model = query.get("model") || undefined;
  let link = location.hash.slice(1);
  try {
    link = decodeURIComponent(link);
  } catch {
    throw cut();
  }
  if (link) {
    const [text, proof] = link.split(";");
    if (!text.startsWith("rasterlab1:")) throw new Error("This link is none of rasterlab's: behind # it must begin with rasterlab1:");
    if (proof !== undefined && !/^[0-9a-f]{16}-[0-9a-f]{16}$/.test(proof)) throw cut();
    return { text, id: "link", bits: proof?.split("-") };
  }
  const id = query.get("preset") || (model ? undefined : FIRST);
  if (!id) return { id: "model", model };
  if (isAddress(id)) return { ...(await presetAt(id)), model };
  const gallery = await presets();
  if (gallery.length && !gallery.some(([known]) => known === id)) throw absent(`The gallery has no preset "${id}"`, id);
  const answer = await fetch(`presets/${id}.toml`);
  if (!answer.ok) throw new Error(`The preset "${id}" cannot be fetched: the server answers ${answer.status}`);
  return { text: await answer.text(), id, model, isOfGallery: true };
}

/** Opens what the address names; `progress` is told in words how far fetching a model is. */
export async function open({ text, id, model }, progress) {
  let look;
  try {
    look = text === undefined ? undefined : new OpenPreset(text, id);
  } catch (error) {
    throw id === "link" && /cut off/.test(error.message) ? cut() : error;
  }
  if (!model) return look;
  const files = await modelAt(model, progress);
  files.forEach(([path, bytes]) => give_file(path, bytes));
  give(files);
  const [path] = files[0];
  return look ? look.on_model(path) : OpenPreset.of_model(path);
}
