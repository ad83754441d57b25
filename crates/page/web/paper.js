// The scene of the scoreboard, as an OBJ: a ball of paper above a floor of rays, made so that every way but the exact one goes wrong somewhere.
// Float edges lose the floor: its triangles reach behind the eye and to the horizon, with another floor a hair below. 16 bits of depth and stores without
// atomics lose the leaves: each is four sheets a millimeter apart, of which an outer one, the one that is seen, is drawn neither first nor last.

const [RAYS, REACH_M, HAIR_M] = [56, 3000, 0.00003];
const [LEAVES, BANDS, RADIUS_M, MIDDLE_M, SHEETS_M] = [24, 8, 1.5, 1.75, [-0.0005, 0.0015, -0.0015, 0.0005]];
const FLOORS = [[[0.16, 0.22, 0.3], [0.27, 0.38, 0.46]], [[0.5, 0.3, 0.26], [0.62, 0.4, 0.3]]];
const INSIDE = [0.16, 0.3, 0.5];

const turned = (part) => [Math.cos(2 * Math.PI * part), Math.sin(2 * Math.PI * part)];

/** The text of the OBJ, in meters, y up. */
export function paper() {
  const lines = [];
  const facet = (color, corners) => {
    for (const corner of corners) lines.push(`v ${[...corner, ...color].map((number) => number.toFixed(7)).join(" ")}`);
    lines.push("f -3 -2 -1");
  };
  for (let ray = 0; ray < RAYS; ray++) {
    const [[x0, z0], [x1, z1]] = [turned(ray / RAYS), turned((ray + 1) / RAYS)].map((at) => at.map((part) => REACH_M * part));
    FLOORS.forEach((colors, i) => facet(colors[ray % 2], [[0, -i * HAIR_M, 0], [x1, -i * HAIR_M, z1], [x0, -i * HAIR_M, z0]]));
  }
  for (let leaf = 0; leaf < LEAVES; leaf++) {
    const [x, z] = turned(leaf / LEAVES);
    const radius = RADIUS_M * (leaf % 2 ? 0.82 : 1);
    for (let band = 0; band < BANDS; band++) {
      const [[y0, r0], [y1, r1]] = [band, band + 1].map((i) => turned(i / BANDS / 2).map((part) => radius * part));
      const outside = leaf % 2 ? [0.95, 0.35 + 0.06 * band, 0.2] : [0.98, 0.72 - 0.04 * band, 0.3];
      for (const corners of [[[0, y0], [r0, y0], [r1, y1]], [[0, y0], [r1, y1], [0, y1]]]) {
        for (const aside of SHEETS_M) {
          facet(Math.abs(aside) > 0.001 ? outside : INSIDE, corners.map(([r, y]) => [r * x - aside * z, y + MIDDLE_M, r * z + aside * x]));
        }
      }
    }
  }
  return lines.join("\n");
}
