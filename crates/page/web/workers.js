// The oracle in workers: one for each core, at most eight. Ending them cancels what they do.
import { can_share_rows } from "./rasterlab_page.js";

const MOST = 8;
/** Parts of the picture for each worker, so that its progress can be told. */
const PARTS = 2;

/** Files that every worker is given, [path, bytes] each. */
let given;

/** From now on workers have these files. */
export function give(files) {
  given = files;
}

/** A worker whose questions are answered one after another. */
function judge(signal) {
  const worker = new Worker(new URL("judge.js", import.meta.url), { type: "module" });
  let files = given;
  const ask = (question) =>
    new Promise((resolve, reject) => {
      const stop = () => {
        worker.terminate();
        reject(new Error("it was canceled"));
      };
      if (signal?.aborted) return stop();
      signal?.addEventListener("abort", stop, { once: true });
      worker.onmessage = ({ data }) => (data.error ? reject(new Error(data.error)) : resolve(data));
      worker.onerror = (event) => reject(new Error(event.message ?? "a worker did not start"));
      worker.postMessage({ ...question, files });
      files = undefined;
    });
  return { ask, end: () => worker.terminate() };
}

/** The answer of one worker to one question. */
export async function asked(question, signal) {
  const one = judge(signal);
  try {
    return await one.ask(question);
  } finally {
    one.end();
  }
}

/** The oracle's picture of an open preset, RGBA. `progress` is told the part that is done, from 0 to 1. */
export async function oraclePicture(preset, { progress = () => {}, signal, cores = navigator.hardwareConcurrency || 1 } = {}) {
  const [width, height] = preset.size();
  const text = preset.text();
  const workers = can_share_rows(preset) ? Math.max(1, Math.min(MOST, cores, height)) : 1;
  const parts = can_share_rows(preset) ? Math.min(workers * PARTS, height) : 1;
  const colors = new Uint8ClampedArray(4 * width * height);
  let [next, done] = [0, 0];
  const row = (part) => Math.floor((part * height) / parts);
  const judges = Array.from({ length: workers }, () => judge(signal));
  const draw = async ({ ask }) => {
    while (next < parts) {
      const part = next++;
      const { colors: rows } = await ask({ ask: "rows", text, id: "picture", begin: row(part), end: row(part + 1) });
      colors.set(rows, 4 * width * row(part));
      progress(++done / parts);
    }
  };
  try {
    await Promise.all(judges.map(draw));
  } finally {
    judges.forEach(({ end }) => end());
  }
  return colors;
}
