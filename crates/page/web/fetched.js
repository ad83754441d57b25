// Files from addresses: presets, and models with the files beside them. Every refusal is one sentence.
const MOST_MB = 256;
const MOST_FILES = 256;
const PRESET_MB = 1;
/** Where the module finds them. */
const FOLDER = "/given/";

/** Is it an address rather than the id of a preset? */
export const isAddress = (text) => /[/.:]/.test(text);

function located(address) {
  let url;
  try {
    url = new URL(address, location.href);
  } catch {
    /* Said below. */
  }
  if (!/^https?:$/.test(url?.protocol)) throw new Error(`"${address}" is no address of a file: it must begin with http:// or https://, or be relative to this page`);
  return url;
}

/** Part of an address, as a person reads it. */
function decoded(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

const named = (url) => decoded(url.pathname.split("/").at(-1));

const megabytes = (bytes) => `${Math.ceil(bytes / 1e6)} MB`;

/** The bytes at an address, at most `most`. `progress` is told how many are there, and how many there will be if the server says so. */
async function bytesAt(url, most, progress) {
  const name = named(url) || url.host;
  const tooLarge = () => new Error(`${name} is larger than ${megabytes(most)}, the most that a page fetches of it; save it and open it in the program on your computer`);
  let answer;
  try {
    answer = await fetch(url);
  } catch {
    throw new Error(`${name} cannot be fetched: ${url.host} cannot be reached, or does not let other pages read its files (CORS)`);
  }
  if (!answer.ok) throw new Error(`${name} cannot be fetched: ${url.host} answers ${answer.status} ${answer.statusText}`.trim());
  const length = Number(answer.headers.get("content-length"));
  if (length > most) {
    // What is left may end in an error, which nobody needs to hear of.
    answer.body?.cancel().catch(() => {});
    throw tooLarge();
  }
  const [parts, reader] = [[], answer.body.getReader()];
  let count = 0;
  try {
    for (let part; !(part = await reader.read()).done; ) {
      count += part.value.length;
      if (count > most) break;
      parts.push(part.value);
      progress(count, length);
    }
  } catch {
    throw new Error(`${name} cannot be fetched: the connection to ${url.host} ended early; load the page again`);
  }
  if (count > most) {
    reader.cancel().catch(() => {});
    throw tooLarge();
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/** The text of a preset, and what errors call it. */
export async function presetAt(address) {
  const url = located(address);
  const bytes = await bytesAt(url, PRESET_MB * 1e6, () => {});
  return { text: new TextDecoder().decode(bytes), id: named(url).replace(/\.toml$/i, "") || "preset" };
}

/** The addresses of the files that a .gltf names, as far as they are in its folder; the loader says what is wrong with others. */
function beside(url, bytes) {
  if (!/\.gltf$/i.test(url.pathname)) return [];
  let model;
  try {
    model = JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    return [];
  }
  const folder = new URL(".", url);
  const uris = [model?.buffers, model?.images].flatMap((list) => (Array.isArray(list) ? list : [])).map((item) => item?.uri);
  const addresses = uris.filter((uri) => typeof uri === "string" && !/^\s*data:/i.test(uri)).flatMap((uri) => {
    try {
      return [new URL(uri, folder).href.replace(/[?#].*$/, "")];
    } catch {
      return [];
    }
  });
  return [...new Set(addresses)].filter((address) => address.startsWith(folder.href)).map((address) => new URL(address));
}

/** A model and the files that it names, [path, bytes] each, the model first. `progress` is told in words how far it is. */
export async function modelAt(address, progress = () => {}) {
  const url = located(address);
  const folder = new URL(".", url).pathname;
  const path = ({ pathname }) => FOLDER + decoded(pathname.slice(folder.length));
  let left = MOST_MB * 1e6;
  const take = async (of, what) => {
    const bytes = await bytesAt(of, left, (count, length) => progress(`${what}: ${length ? `${Math.ceil(count / 1e6)} of ` : ""}${megabytes(length || count)}`));
    left -= bytes.length;
    return [path(of), bytes];
  };
  const model = await take(url, `${named(url)} is fetched`);
  const others = beside(url, model[1]);
  if (others.length >= MOST_FILES) throw new Error(`${named(url)} names ${others.length} files, and a page fetches at most ${MOST_FILES - 1} beside a model; make it one .glb file`);
  const files = [model];
  for (const [at, other] of others.entries()) files.push(await take(other, `${named(other)} is fetched, file ${at + 1} of ${others.length} beside the model`));
  return files;
}
