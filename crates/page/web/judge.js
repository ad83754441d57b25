// A judge: draws a preset on a device of its own and judges it with the oracle, beside the page. With
// wantsOracle it also sends the oracle's own picture.
import init, { OpenPreset, Page, oracle_picture } from "./rasterlab_page.js";

onmessage = async ({ data: { text, id, wantsOracle } }) => {
  try {
    await init();
    const preset = new OpenPreset(text, id);
    const page = await Page.open();
    const picture = await page.draw(preset);
    const faults = picture.faults(preset);
    postMessage({ faults, oracle: wantsOracle ? oracle_picture(preset).colors() : undefined });
  } catch (error) {
    postMessage({ error: error.message ?? String(error) });
  }
};
