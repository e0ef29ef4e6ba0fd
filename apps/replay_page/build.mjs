// Bundles index.html, style.css and src/ into replay.html, one file that needs nothing else. Called by
// scripts/replay-page.

import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build, transform } from "esbuild";

const read = (name) => readFileSync(new URL(name, import.meta.url), "utf8");

// What it was made of: tests/replay_page_test.py computes it again, and so knows whether the bundle is of these sources.
const sources = ["build.mjs", "index.html", "package-lock.json", "package.json", "style.css"];
sources.push(...readdirSync(new URL("src", import.meta.url)).map((name) => `src/${name}`));
const hash = createHash("sha256");
for (const name of sources.sort()) hash.update(`${name}\n${read(name)}\n`);

const script = await build({
  absWorkingDir: new URL(".", import.meta.url).pathname,
  entryPoints: ["src/main.js"],
  bundle: true,
  minify: true,
  format: "esm",
  target: ["es2022"],
  legalComments: "inline",
  write: false,
});
const style = await transform(read("style.css"), { loader: "css", minify: true });

const license = read("node_modules/three/LICENSE").trim();
if (license.includes("--")) throw new Error("the license cannot stand in a comment of HTML");
const head = `<!--
Made by Troupe (Apache License 2.0), with three.js ${JSON.parse(read("node_modules/three/package.json")).version}:

${license}

Sources: apps/replay_page, sha256 ${hash.digest("hex")}
-->`;

const parts = { STYLE: style.code.trim(), SCRIPT: script.outputFiles[0].text.trim() };
for (const text of Object.values(parts))
  if (text.includes("@RECORDING@")) throw new Error("only index.html may say where the recording goes");
const page = read("index.html")
  .replace("<style>", () => `${head}\n<style>`) // behind the character set, which must stand in the first 1,024 bytes
  .replace(/@(STYLE|SCRIPT)@/g, (_, name) => parts[name]);
writeFileSync(new URL("replay.html", import.meta.url), page);
console.log(`apps/replay_page/replay.html: ${Math.round(page.length / 1000)} kB`);
