// build.mjs -- bundles the runtime: each entry becomes one minified file in bundle/, which is committed.
//
//   node build.mjs               makes bundle/ anew
//   node build.mjs FILE OUT      bundles any module as one classic script, for tests
//
// The first line of a bundle holds a hash of everything that it may be made of, so that a bundle that is
// not up to date is found without Node (tests/web/test_bundle.py).

import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const HERE = dirname(fileURLToPath(import.meta.url));

/** What runtime/ is bundled to: a classic script (iife) may be in a page that is opened from disk, where a
 *  module (esm) is refused.
 *  @type {Object<string, "iife" | "esm" | "css">} */
const ENTRIES = { "book.js": "iife", "book.css": "css" };

/** A hash of the runtime's files and of what bundles them: names and bytes, in the order of their names. */
function hashOfSources() {
  const names = readdirSync(join(HERE, "runtime")).filter((name) => /\.(js|css)$/.test(name)).sort();
  const hash = createHash("sha256");
  for (const name of ["build.mjs", "package-lock.json", ...names.map((name) => `runtime/${name}`)]) {
    hash.update(`${name}\0`).update(readFileSync(join(HERE, name))).update("\0");
  }
  return hash.digest("hex").slice(0, 16);
}

/** @param {string} entry @param {"iife" | "esm" | "css"} kind @param {string} outfile */
function bundled(entry, kind, outfile) {
  const style = kind === "css";
  return build({
    entryPoints: [entry],
    outfile,
    bundle: true,
    minify: true,
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
    logLevel: "warning",
    ...(style ? {} : { format: kind }),
    ...(kind === "iife" ? { globalName: "playground" } : {}),
    banner: { [style ? "css" : "js"]: `/* sources ${hashOfSources()} */` },
  });
}

const [file, out] = process.argv.slice(2);
if (file && out) {
  await bundled(file, "iife", out);
} else {
  rmSync(join(HERE, "bundle"), { recursive: true, force: true });
  mkdirSync(join(HERE, "bundle"));
  for (const [name, kind] of Object.entries(ENTRIES)) {
    await bundled(join(HERE, "runtime", name), kind, join(HERE, "bundle", name));
  }
}
