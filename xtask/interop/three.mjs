// Reads motion files with the loaders of three.js: node three.mjs MODULES FOLDER OUT
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, folder, out] = process.argv.slice(2);
const part = (file) => import(pathToFileURL(join(modules, 'node_modules/three', file)));
const THREE = await part('build/three.module.js');
const { BVHLoader } = await part('examples/jsm/loaders/BVHLoader.js');
const { GLTFLoader } = await part('examples/jsm/loaders/GLTFLoader.js');
const { FBXLoader } = await part('examples/jsm/loaders/FBXLoader.js');
// Loaders look for a browser.
globalThis.self = globalThis;
globalThis.window = { innerWidth: 1, innerHeight: 1 };

/** What a loader is known not to read. */
class Skipped extends Error {}

/** The root object, its clips, and metres in a unit. */
const load = {
  bvh(bytes) {
    const text = bytes.toString();
    const roots = text.match(/^ROOT /gm).length;
    if (roots > 1) throw new Skipped(`it has ${roots} roots, the loader reads one`);
    const { skeleton, clip } = new BVHLoader().parse(text);
    // The loader keeps names that the names of tracks cannot hold.
    const tidy = THREE.PropertyBinding.sanitizeNodeName;
    for (const track of clip.tracks) {
      const [, bone, property] = track.name.match(/^(.*)\.(\w+)$/s);
      track.name = `${tidy(bone)}.${property}`;
    }
    for (const bone of skeleton.bones) bone.name = tidy(bone.name);
    // It adds a joint's OFFSET to its positions, which for us and for Blender are the whole way from the parent.
    const moving = /(?:ROOT|JOINT) (.+)\s*\{\s*OFFSET (\S+) (\S+) (\S+)\s*CHANNELS 6/g;
    for (const [, bone, ...offset] of text.matchAll(moving)) {
      const track = clip.tracks.find(({ name }) => name === `${tidy(bone.trim())}.position`);
      track.values = track.values.map((value, index) => value - Number(offset[index % 3]));
    }
    return { root: skeleton.bones[0], clips: [clip], unit: 0.01 };
  },
  async glb(bytes) {
    const loader = new GLTFLoader().register(() => ({
      name: 'no-pictures',
      loadTexture: async () => new THREE.Texture(),
    }));
    const data = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const { scene, animations } = await loader.parseAsync(data, '');
    return { root: scene, clips: animations, unit: 1 };
  },
  fbx(bytes) {
    const data = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const root = new FBXLoader().parse(data, '');
    return { root, clips: root.animations, unit: 0.01 * (root.userData.unitScaleFactor ?? 1) };
  },
};

/** All of a file but its clips: what a clip more must leave alone. */
function look({ root }) {
  const parts = [];
  root.traverse(({ name, type, geometry, material, skeleton }) => {
    const attributes = Object.entries(geometry?.attributes ?? {}).map(([key, { array }]) => [key, ...array]);
    const bones = skeleton?.bones.map((bone, index) => [bone.name, ...skeleton.boneInverses[index].elements]);
    const shade = material && [material.name, material.type, material.color?.getHex(), material.map !== null];
    parts.push([name, type, attributes, [...(geometry?.index?.array ?? [])], shade, bones]);
  });
  return JSON.stringify(parts);
}

/** Throws unless only the clip of the job was added to the original. */
async function checkOriginal(job, file) {
  const before = await load.glb(readFileSync(join(folder, job.original)));
  if (look(before) !== look(file)) throw new Error('mesh, skin or material changed');
  const names = ({ clips }) => clips.map(({ name }) => name).filter((name) => name !== job.clip);
  if (names(before).join() !== names(file).join()) throw new Error('other clips changed');
}

/** Names of the bones and where they are, frame by frame, in metres. */
function places({ root, clips, unit }, { clip: wanted, rate, frames }) {
  const clip = clips.find(({ name }) => name === wanted) ?? clips.at(-1);
  const bones = [];
  root.traverse((node) => node.isBone && bones.push(node));
  const mixer = new THREE.AnimationMixer(root);
  const action = mixer.clipAction(clip).setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const values = new Float32Array(frames * bones.length * 3);
  const at = new THREE.Vector3();
  for (let frame = 0; frame < frames; frame++) {
    action.paused = false;
    mixer.setTime(frame / rate);
    root.updateWorldMatrix(true, true);
    bones.forEach((bone, index) => {
      bone.getWorldPosition(at).multiplyScalar(unit).toArray(values, (frame * bones.length + index) * 3);
    });
  }
  return { joints: bones.map(({ name }) => name), values };
}

// A warning is a failure: a track that finds no bone is only warned of.
for (const level of ['warn', 'error']) {
  console[level] = (...words) => {
    throw new Error(words.join(' '));
  };
}
for (const job of JSON.parse(readFileSync(join(folder, 'files.json')))) {
  const read = load[job.file.split('.').at(-1)];
  if (!read) continue;
  try {
    const file = await read(readFileSync(join(folder, job.file)));
    if (job.original) await checkOriginal(job, file);
    const { joints, values } = places(file, job);
    const header = `${JSON.stringify({ joints, frames: job.frames })}\n`;
    writeFileSync(join(out, job.file), Buffer.concat([Buffer.from(header), Buffer.from(values.buffer)]));
  } catch (error) {
    // Said in the table; without such a line the missing file is.
    const kind = error instanceof Skipped ? 'skipped' : 'failed';
    writeFileSync(join(out, `${job.file}.${kind}`), error.message);
  }
}
