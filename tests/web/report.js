/** Tells run.py the faults of a test; none if it passes. */
export const report = (test, faults) => fetch("/report", { method: "POST", body: JSON.stringify({ test, faults: faults.filter(Boolean) }) });

export const text = async (path) => {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(`${path} is not there`);
  return answer.text();
};

export function largestDifference(a, b) {
  if (a.length !== b.length) return 256;
  let largest = 0;
  for (let at = 0; at < a.length; at++) largest = Math.max(largest, Math.abs(a[at] - b[at]));
  return largest;
}

export const until = async (holds, what, seconds = 120) => {
  const end = performance.now() + 1000 * seconds;
  for (;;) {
    const found = holds();
    if (found) return found;
    if (performance.now() > end) throw new Error(`${what}: not within ${seconds} s`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
};
