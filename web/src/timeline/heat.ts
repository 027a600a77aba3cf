import type { Plan } from '../api/plan';
import { rampAt } from '../base/colour';
import type { Theme } from '../base/theme';

/** The plan as an image: a pixel a cell, first source frames below; hue is the moment of the clip, strength the weight. */
export function heatImage(plan: Plan, theme: Theme): HTMLCanvasElement | null {
  const { width, height, cells } = plan;
  if (width === 0 || height === 0) return null;
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext('2d');
  if (!context) return null;
  const image = context.createImageData(width, height);
  for (let source = 0; source < height; source += 1) {
    const [r, g, b] = rampAt(theme.ramp, (source + 0.5) / height);
    for (let control = 0; control < width; control += 1) {
      const pixel = 4 * ((height - 1 - source) * width + control);
      image.data[pixel] = r;
      image.data[pixel + 1] = g;
      image.data[pixel + 2] = b;
      // The faint is lifted: a hundredth of the weight is still a choice that was weighed.
      image.data[pixel + 3] = 255 * ((cells[source * width + control] ?? 0) / 255) ** 0.38;
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}
