// build.mjs -- bundles the runtime: each entry becomes one minified file in bundle/, which is committed.
//
//   node build.mjs               makes bundle/, and the page of the studio's remote (../../studio/remote/page/)
//   node build.mjs FILE OUT      bundles any module as one classic script, for tests
//
// The first line of a bundle holds a hash of everything that it may be made of, so that a bundle that is
// not up to date is found without Node (tests/publish/web/test_bundle.py).

import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const HERE = dirname(fileURLToPath(import.meta.url));

/** What runtime/ is bundled to: a classic script (iife) may be in a page that is opened from disk, where a
 *  module (esm) is refused.
 *  @type {Object<string, "iife" | "esm" | "css">} */
const ENTRIES = {
  "loader.js": "iife", "page.js": "iife", "page.css": "css", "trace.js": "iife", "trace.css": "css",
  "book.js": "iife", "book.css": "css",
  "notebook.js": "esm", "notebook.css": "css",
  "remote.js": "iife", "remote.css": "css",
};

/** The bundles that CodeMirror is in, whose licence goes with every copy. */
const EDITED = new Set(["page.js", "book.js"]);
const licence = () =>
  `/* Contains CodeMirror.\n${readFileSync(join(HERE, "node_modules/@codemirror/state/LICENSE"), "utf8")}*/\n`;

/** A hash of the runtime's files and of what bundles them: names and bytes, in the order of their names. */
function hashOfSources() {
  const names = readdirSync(join(HERE, "runtime")).filter((name) => /\.(js|css|json)$/.test(name)).sort();
  const hash = createHash("sha256");
  const others = ["build.mjs", "package-lock.json", "../../shader/widgets.json"];
  for (const name of [...others, ...names.map((name) => `runtime/${name}`)]) {
    hash.update(`${name}\0`).update(readFileSync(join(HERE, name))).update("\0");
  }
  return hash.digest("hex").slice(0, 16);
}

/** @param {string} entry @param {"iife" | "esm" | "css"} kind
 *  @param {Partial<import("esbuild").BuildOptions>} more */
async function bundled(entry, kind, more) {
  const made = await build({
    entryPoints: [entry],
    bundle: true,
    write: false,
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
    logLevel: "warning",
    ...(kind === "css" ? {} : { format: kind }),
    ...(kind === "iife" ? { globalName: "playground" } : {}),
    ...more,
  });
  return made.outputFiles[0].text;
}

/** A bundle as it ships: terser's is 6 % smaller, gzipped, than esbuild's, and takes a hundred times as long.
 *  @param {string} entry @param {"iife" | "esm" | "css"} kind */
async function smallest(entry, kind) {
  if (kind === "css") return bundled(entry, kind, { minify: true });
  const { minify } = await import("terser");
  const text = await bundled(entry, kind, { minifySyntax: true });
  const { code } = await minify(text, { ecma: 2020, module: kind === "esm", compress: { passes: 3 } });
  return `${code}\n`;
}

const [file, out] = process.argv.slice(2);
if (file && out) {
  writeFileSync(out, await bundled(file, "iife", { minify: true }));
} else {
  const bundle = join(HERE, "bundle"), remote = join(HERE, "../../studio/remote/page");
  rmSync(bundle, { recursive: true, force: true });
  mkdirSync(bundle);
  for (const [name, kind] of Object.entries(ENTRIES)) {
    const text = await smallest(join(HERE, "runtime", name), kind);
    const folder = name.startsWith("remote.") ? remote : bundle;
    const head = `/* sources ${hashOfSources()} */\n${EDITED.has(name) ? licence() : ""}`;
    writeFileSync(join(folder, name), head + text);
  }
}
