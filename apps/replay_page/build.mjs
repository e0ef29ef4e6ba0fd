// Bundles index.html, style.css and src/ into replay.html, and live_index.html, style.css and src/ into live.html, which
// are self-contained. Called by scripts/replay-page.

import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build, transform } from "esbuild";

const read = (name) => readFileSync(new URL(name, import.meta.url), "utf8");

// A hash of the sources. tests/replay_page_test.py recomputes it to check that the bundles are up to date.
const sources = ["build.mjs", "index.html", "live_index.html", "package-lock.json", "package.json", "style.css"];
sources.push(...readdirSync(new URL("src", import.meta.url)).map((name) => `src/${name}`));
const hash = createHash("sha256");
for (const name of sources.sort()) hash.update(`${name}\n${read(name)}\n`);

const style = await transform(read("style.css"), { loader: "css", minify: true });

const license = read("node_modules/three/LICENSE").trim();
if (license.includes("--")) throw new Error('the license contains "--", which HTML comments do not allow');
const head = `<!--
Made by Troupe (Apache License 2.0), with three.js ${JSON.parse(read("node_modules/three/package.json")).version}:

${license}

Sources: apps/replay_page, sha256 ${hash.digest("hex")}
-->`;

async function bundle(entry, index, made) {
  const script = await build({
    absWorkingDir: new URL(".", import.meta.url).pathname,
    entryPoints: [entry],
    bundle: true,
    minify: true,
    format: "esm",
    target: ["es2022"],
    legalComments: "inline",
    write: false,
  });
  const parts = { STYLE: style.code.trim(), SCRIPT: script.outputFiles[0].text.trim() };
  for (const text of Object.values(parts))
    if (text.includes("@RECORDING@")) throw new Error("only index.html may contain @RECORDING@");
  const page = read(index)
    .replace("<style>", () => `${head}\n<style>`) // after the character set, which must be in the first 1,024 bytes
    .replace(/@(STYLE|SCRIPT)@/g, (_, name) => parts[name]);
  writeFileSync(new URL(made, import.meta.url), page);
  console.log(`apps/replay_page/${made}: ${Math.round(page.length / 1000)} kB`);
}

await bundle("src/main.js", "index.html", "replay.html");
await bundle("src/live.js", "live_index.html", "live.html");
