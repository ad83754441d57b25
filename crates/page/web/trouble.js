// What a page says where it cannot go on: no device, a lost one, a mistake of the program.

/** Why nothing can be drawn on a device, and what to do about it, in one sentence each; nothing if it can. */
export async function whyNoDevice() {
  if (!navigator.gpu && !isSecureContext) {
    return ["This address is not secure, and browsers draw with WebGPU on secure ones alone: it needs https.", location.protocol === "http:" ? `Open https://${location.host}${location.pathname} if the site has it, or run the page on localhost.` : "Open the page over https."];
  }
  if (!navigator.gpu) return ["This browser has no WebGPU.", "Chrome and Edge have it since version 113, Safari since 26, Firefox since 141 on Windows and 145 on macOS."];
  if (await navigator.gpu.requestAdapter().catch(() => null)) return undefined;
  return ["This browser has WebGPU, but finds no graphics device for it.", "Turn on graphics acceleration in its settings, update the graphics driver, or try another browser; in Chrome the page chrome://gpu says what is off."];
}

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

/** The words for an error; those of a panic are kept by the module. Files that the page was given have their own names. */
export function words(error) {
  if (globalThis.rasterlabPanic) return `rasterlab made a mistake and has stopped: ${globalThis.rasterlabPanic}. Load the page again to go on`;
  if (isLoss(error)) return "The device was lost again and again: its driver restarts, or other pages take its memory. Load the page again to go on";
  return (error?.message ?? String(error)).replaceAll("/given/", "");
}

/** The name of the graphics device, as far as the browser tells it. */
export async function adapterName(page) {
  const { vendor, architecture, device, description } = (await navigator.gpu.requestAdapter().catch(() => null))?.info ?? {};
  return page?.adapter() || description || [vendor, architecture, device].filter(Boolean).join(" ") || "your device";
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
