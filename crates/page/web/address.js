// What the address names.
//
//   ?preset=ID          a preset of the gallery, from presets/ID.toml; by default hero-night
//   #rasterlab1:…       the line that the window copies
//   #rasterlab1:…;IDS-KEYS   the same from rasterlab link, with the bits that its picture must have
const FIRST = "hero-night";

/** The text of the preset that the address names, what errors call it, and the bits of its picture if the link has them. */
export async function wanted() {
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
  const id = new URLSearchParams(location.search).get("preset") || FIRST;
  if (!/^[\w-]+$/.test(id)) throw new Error(`"${id}" is no id of a preset; ids have letters, digits and hyphens`);
  const answer = await fetch(`presets/${id}.toml`);
  if (!answer.ok) throw new Error(`the gallery has no preset "${id}"`);
  return { text: await answer.text(), id };
}
