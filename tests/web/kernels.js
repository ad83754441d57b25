// The browser's own compiler reads every linked kernel that run.py --kernels was given.
import { report, text } from "/tests/report.js";

/** So many are fetched and read at once: the compiler never waits for a file. */
const AT_ONCE = 16;
const IN_A_REPORT = 1000;

export async function kernels() {
  const names = JSON.parse(await text("/kernels.json"));
  if (names === null) return;
  const device = await (await navigator.gpu.requestAdapter()).requestDevice();
  /** What the compiler says about a kernel. */
  const said = async (name) => {
    const module = device.createShaderModule({ code: await text(`/kernels/${name}`) });
    const { messages } = await module.getCompilationInfo();
    return messages.map(({ type, lineNum, linePos, message }) => `${name}:${lineNum}:${linePos}: ${type}: ${message}`);
  };
  for (let first = 0; first < names.length; first += IN_A_REPORT) {
    const part = names.slice(first, first + IN_A_REPORT);
    const [left, faults] = [part.values(), []];
    const reader = async () => {
      for (const name of left) faults.push(...(await said(name)));
    };
    const began = performance.now();
    await Promise.all(Array.from({ length: AT_ONCE }, reader));
    const each = (performance.now() - began) / part.length;
    await report(`${part.length} kernels from the ${first + 1}st of ${names.length}, ${each.toFixed(0)} ms each`, [...faults.slice(0, 20), faults.length > 20 && `and ${faults.length - 20} more`]);
  }
  await report("number of kernels", [names.length < 500 && `only ${names.length}`]);
}
