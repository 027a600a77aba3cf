import { AnimationMixer, Mesh, Texture, type Material, type Object3D } from 'three';

import type { Stage } from './stage';

/** Shows the mesh of a GLB, played at the time that is shown by the last clip in it. Returns what takes it away again. */
export async function showSkin(stage: Stage, glb: ArrayBuffer): Promise<() => void> {
  // Only who has a skin needs the reader.
  const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');
  const { scene, animations } = await new GLTFLoader().parseAsync(glb, '');
  const mixer = new AnimationMixer(scene);
  const newest = animations.at(-1);
  if (newest) mixer.clipAction(newest).play();
  scene.traverse((object: Object3D) => (object.frustumCulled = false));
  stage.scene.add(scene);
  const skin = { update: (seconds: number) => void mixer.setTime(Math.min(seconds, (newest?.duration ?? 0) - 1e-4)) };
  stage.skin = skin;
  return () => {
    scene.removeFromParent();
    scene.traverse((object) => {
      if (object instanceof Mesh) for (const part of [object.geometry, ...[object.material as Material | Material[]].flat()]) release(part);
    });
    if (stage.skin === skin) stage.skin = null;
  };
}

/** Gives memory of the graphics card back, that of a material's pictures too. */
function release(part: { dispose(): void }): void {
  for (const value of Object.values(part)) if (value instanceof Texture) value.dispose();
  part.dispose();
}
