// The browser's own compiler reads every linked kernel that run.py --kernels was given.
import { report, text } from "/tests/report.js";

export async function kernels() {
  const names = JSON.parse(await text("/kernels.json"));
  if (names === null) return;
  const device = await (await navigator.gpu.requestAdapter()).requestDevice();
  const faults = [];
  for (const name of names) {
    device.pushErrorScope("validation");
    const module = device.createShaderModule({ code: await text(`/kernels/${name}`) });
    const { messages } = await module.getCompilationInfo();
    faults.push(...messages.map(({ type, lineNum, linePos, message }) => `${name}:${lineNum}:${linePos}: ${type}: ${message}`));
    await device.popErrorScope();
  }
  await report(`${names.length} kernels`, [...faults.slice(0, 20), faults.length > 20 && `and ${faults.length - 20} more`, names.length < 500 && "too few"]);
}
