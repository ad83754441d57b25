// The gallery beside the page: its presets, stills of them, and those that are like an id which does not exist.

/** Presets with one idea each, which stand first. */
const FIRST = ["hero-night", "hero-day", "hero-walk", "hero-etching", "hero-swarm", "hero-herd", "hero-town", "hero-blast", "hero-onebit", "hero-xray", "hero-heat", "smear"];
const MOST_SIMILAR = 3;

/** Ids and names of all presets. */
export const presets = (() => {
  let list;
  const rank = ([id]) => (FIRST.indexOf(id) + 1 || FIRST.length + 1) - 1;
  return () => (list ??= fetch("gallery.json").then(async (answer) => (answer.ok ? (await answer.json()).sort((a, b) => rank(a) - rank(b)) : []), () => []));
})();

const pairs = (text) => new Set([...text.toLowerCase().matchAll(/(?=(\w\w))/g)].map(([, pair]) => pair));

/** How much of its pairs of letters two words share, from 0 to 1. */
function likeness(a, b) {
  const [of, others] = [pairs(a), pairs(b)];
  return (2 * [...of].filter((pair) => others.has(pair)).length) / (of.size + others.size || 1);
}

/** Presets whose ids or names are like these words, the most similar first. */
export async function similar(words) {
  const rated = (await presets()).map((preset) => [Math.max(...preset.map((name) => likeness(words, name))), preset]);
  return rated.filter(([rate]) => rate > 0.35).sort(([a], [b]) => b - a).slice(0, MOST_SIMILAR).map(([, preset]) => preset);
}

/** Stills of these presets, each a link to its page. */
export function stills(list, name) {
  const pictures = document.createElement("nav");
  pictures.className = name;
  pictures.setAttribute("aria-label", "Presets");
  for (const [id, title] of list) {
    const link = document.createElement("a");
    link.href = `./?preset=${id}`;
    const still = Object.assign(new Image(320, 240), { loading: "lazy", src: `goldens/${id}.png`, alt: "" });
    link.append(still, title);
    pictures.append(link);
  }
  return pictures;
}

/** What leads on where something does not exist: presets like it, or the first of the gallery. */
export async function ways(words) {
  const like = await similar(words);
  return stills(like.length ? like : (await presets()).slice(0, MOST_SIMILAR), "gallery");
}
