// Makes the bundle of the page. esbuild leaves shaders as they are: here their lines lose comments, tabs, and spaces beside signs.

import { writeFileSync } from "node:fs";
import { build } from "esbuild";

const { outputFiles: [{ text }] } = await build({
  entryPoints: ["main.mjs"], bundle: true, minify: true, format: "iife", target: "es2022", legalComments: "none", write: false,
});
const closer = (line) => (/([-+/]) \1/.test(line) ? line : line.replace(/ ?([-+*/=<>,;(){}]) ?/g, "$1")); // a - -b has no --
const small = text
  .replace(/\n\s*\/\/.*(?=\n)/g, "")
  .replace(/\n\t+/g, "\n")
  .replace(/(?<=\n)[^\n`"'$#\\]*[;{}](?=\n)/g, closer); // whole lines that are of shaders alone
writeFileSync("view.js", small);
