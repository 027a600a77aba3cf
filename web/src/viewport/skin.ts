import { AnimationMixer, type AnimationClip, type Object3D, type Scene } from 'three';

import type { Stage } from './stage';

/** The user's own mesh: the exported GLB of the result, played at the time that is shown. */
export async function showSkin(stage: Stage, glb: ArrayBuffer): Promise<() => void> {
  // Only who has a skin needs the reader.
  const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');
  const { scene, animations } = await new GLTFLoader().parseAsync(glb, '');
  const mixer = new AnimationMixer(scene);
  const newest: AnimationClip | undefined = animations.at(-1);
  if (newest) mixer.clipAction(newest).play();
  scene.traverse((object: Object3D) => (object.frustumCulled = false));
  const place: Scene = stage.scene;
  place.add(scene);
  stage.skin = { update: (seconds) => void mixer.setTime(seconds) };
  return () => {
    scene.removeFromParent();
    stage.skin = null;
  };
}
