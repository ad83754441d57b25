// What a page says where it cannot go on: no WebGPU, a lost device, a mistake of the program.
const GALLERY = ["hero-day", "hero-night", "hero-walk", "hero-herd", "hero-etching", "hero-swarm", "hero-blast", "hero-xray", "hero-town"];

export const BROWSERS = "Chrome and Edge have it since version 113, Safari since 26, Firefox since 141 on Windows and 145 on macOS";

/** A page goes on with another device where that was lost, but not for the third time within so long. */
const [MOST_LOSSES, WITHIN_MS] = [2, 60_000];
const losses = [];

export const isLoss = (error) => /device (was|is) lost/i.test(error?.message ?? String(error));

/** Is the error a lost device, and goes the page on with another one? */
export function goesOn(error) {
  if (!isLoss(error)) return false;
  const now = performance.now();
  losses.push(now);
  return losses.filter((at) => now - at < WITHIN_MS).length <= MOST_LOSSES;
}

/** The words for an error; those of a panic are kept by the module. */
export function words(error) {
  if (globalThis.rasterlabPanic) return `rasterlab made a mistake and has stopped: ${globalThis.rasterlabPanic}. Load the page again to go on`;
  if (isLoss(error)) return "The device was lost again and again: its driver restarts, or other pages take its memory. Load the page again to go on";
  return error?.message ?? String(error);
}

/** The name of the graphics device, as far as the browser tells it; empty if it does not. */
export async function adapterName() {
  const { vendor, architecture, device, description } = (await navigator.gpu.requestAdapter().catch(() => null))?.info ?? {};
  return description || [vendor, architecture, device].filter(Boolean).join(" ");
}

/** A link that saves the text of the preset as a file. */
export function saver(text) {
  const link = document.createElement("a");
  link.className = "save";
  link.textContent = "Save the preset";
  link.download = "preset.toml";
  link.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  return link;
}

/** Pictures of the gallery, in place of what cannot be drawn. */
export function gallery() {
  const pictures = document.createElement("div");
  pictures.className = "gallery";
  for (const id of GALLERY) {
    const picture = new Image();
    [picture.src, picture.alt, picture.loading] = [`goldens/${id}.png`, id, "lazy"];
    pictures.append(picture);
  }
  return pictures;
}
