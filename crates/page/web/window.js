// The program's window on a canvas of the page.
//
//   ?preset=ID   begins with a preset of the gallery; by default with what was open last
//   #rasterlab1: begins with the line that the window copies
import init, { open_window } from "./rasterlab_window.js";

const caption = document.getElementById("caption");

function fail(error) {
  caption.textContent = error.message ?? String(error);
  caption.hidden = false;
}

async function main() {
  if (!navigator.gpu) {
    throw new Error("This browser has no WebGPU. Chrome and Edge 113, Safari 26 and Firefox 141 have it.");
  }
  await init();
  const line = decodeURIComponent(location.hash.slice(1));
  const preset = new URLSearchParams(location.search).get("preset");
  await open_window(document.getElementById("window"), line || preset || undefined);
  caption.hidden = true;
}

// A file that misses the canvas would replace the page.
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => event.preventDefault());
main().catch(fail);
