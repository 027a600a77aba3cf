/** The plan as a picture: a byte a cell, rows of source frames from first to last, columns of control samples. */
export interface Plan {
  readonly width: number;
  readonly height: number;
  readonly cells: Uint8Array;
}

const MAGIC = 0x314d4b49;

/** Throws when the bytes are no plan. */
export function readPlan(buffer: ArrayBuffer): Plan {
  const view = new DataView(buffer);
  if (buffer.byteLength < 16 || view.getUint32(0, true) !== MAGIC) throw new Error('these bytes are no plan');
  const [width, height] = [view.getUint32(4, true), view.getUint32(8, true)];
  return { width, height, cells: new Uint8Array(buffer, 16, width * height) };
}
