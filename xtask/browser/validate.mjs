// Checks GLB files with Khronos' glTF-Validator; an error or a warning in one of them is a failure.
//
// node validate.mjs FOLDER-WITH-NODE_MODULES FILE...
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, join } from 'node:path';

const [modules, ...files] = process.argv.slice(2);
const validator = createRequire(join(modules, 'package.json'))('gltf-validator');

let failed = files.length === 0;
for (const file of files) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  const { numErrors, numWarnings, numInfos, messages } = issues;
  console.log(`${basename(file)}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos`);
  for (const { severity, code, message, pointer } of messages.filter((issue) => issue.severity < 2)) {
    console.log(`  ${severity === 0 ? 'error' : 'warning'} ${code} at ${pointer}: ${message}`);
  }
  failed ||= numErrors + numWarnings > 0;
}
process.exit(failed ? 1 : 0);
