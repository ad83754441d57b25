// A worker of the window, with an instance of its module for itself. Words that it sends are stages of what it does; an array is the end: the answer, or
// nothing and why. What it is told meanwhile is no array: for how many milliseconds it waits, or nothing where it ends with what it has.
import init, { answer, heed } from "./rasterlab_window.js";

let isThere = false;

onmessage = async ({ data }) => {
  if (!Array.isArray(data)) return isThere && heed(data);
  const [module, question] = data;
  try {
    await init({ module_or_path: module });
    isThere = true;
    postMessage([await answer(...question)]);
  } catch (error) {
    postMessage([undefined, globalThis.rasterlabPanic ?? error.message ?? String(error)]);
  }
};
