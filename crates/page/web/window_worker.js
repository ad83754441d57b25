// A worker of the window, with an instance of its module for itself. Words that it sends are stages of what it does; an array is the end: the answer, or
// nothing and why.
import init, { answer } from "./rasterlab_window.js";

onmessage = async ({ data: [module, question] }) => {
  try {
    await init({ module_or_path: module });
    postMessage([await answer(...question)]);
  } catch (error) {
    postMessage([undefined, globalThis.rasterlabPanic ?? error.message ?? String(error)]);
  }
};
