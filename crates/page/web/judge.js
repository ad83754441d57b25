// A worker with an instance of the module, and where it draws a device, for itself: the page goes on meanwhile.
//
//   { ask: "verdict", text, id }           the preset drawn on a device and judged: { faults, allowed }
//   { ask: "rows", text, id, begin, end }  those rows of the oracle's picture: { colors }, RGBA
//   { ask: "bits", text, id }              the hashes of the oracle's triangle ids and depth keys: { bits }
//
// The first question brings the files of a model, if there are any: { files }, [path, bytes] each.
import init, { OpenPreset, Page, give_file, oracle_bits, oracle_rows } from "./rasterlab_page.js";

const answers = {
  verdict: async (preset) => {
    const picture = await (await Page.open()).draw(preset);
    const { faults, allowed } = picture.judge(preset);
    return { faults, allowed };
  },
  rows: (preset, { begin, end }) => ({ colors: oracle_rows(preset, begin, end) }),
  bits: (preset) => ({ bits: oracle_bits(preset.in_portable_bits()) }),
};

let preset;
let presetText;

onmessage = async ({ data }) => {
  try {
    await init();
    data.files?.forEach(([path, bytes]) => give_file(path, bytes));
    if (data.text !== presetText) [preset, presetText] = [new OpenPreset(data.text, data.id), data.text];
    postMessage(await answers[data.ask](preset, data));
  } catch (error) {
    postMessage({ error: globalThis.rasterlabPanic ?? error.message ?? String(error) });
  }
};
