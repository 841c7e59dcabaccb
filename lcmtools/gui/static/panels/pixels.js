// The pixels of an image from the server: their values, and their colours on the screen.

import { decodeGrey16 } from "./png.js";

/**
 * @typedef {{id: number, topic: string, encoding: string, frame: string, count: number, bytes: number,
 *   time: number, file?: string, kind?: "depth" | "grey" | "color", number?: "B" | "H" | "f",
 *   channels?: string, unit?: string, columns: number, rows: number, step: number,
 *   width: number, height: number}} Header
 * @typedef {number[]} Color
 * @typedef {{near: number, far: number, colors: Color[]}} Scale
 */

const LEVELS = 256;
const ROUNDING = 0.5; // [m] an automatic scale has round ends, so that it seldom changes
const NO_READING = 0xff000000;
const FARTHEST = 1e6; // [m]

/** An image with its pixels' values. */
export class Picture {
  /**
   * @param {Header} header
   * @param {ArrayLike<number> | null} values of a single channel, or of all
   * @param {ImageBitmap | null} bitmap instead of values
   */
  constructor(header, values, bitmap) {
    this.header = header;
    this.values = values;
    this.bitmap = bitmap;
    this.kind = header.kind ?? "color";
    /** The size of this picture [pixels]; each is one of ``step`` by ``step`` pixels of the image. */
    this.columns = bitmap?.width ?? header.columns;
    this.rows = bitmap?.height ?? header.rows;
    this.step = bitmap ? 1 : header.step;
    this.width = bitmap?.width ?? header.width;
    this.height = bitmap?.height ?? header.height;
    this.factor = header.unit === "mm" ? 0.001 : 1;
  }

  /**
   * Return the value of a pixel: depth [m] or grey, NaN for no reading; null for colours.
   * @param {number} column
   * @param {number} row
   */
  value(column, row) {
    if (!this.values || this.kind === "color") return null;
    const value = this.values[row * this.columns + column] ?? NaN;
    if (this.kind === "grey") return value;
    const depth = value * this.factor;
    return depth > 0 && depth < FARTHEST ? depth : NaN;
  }

  /** Return the smallest and the largest value, or null if there are none. */
  range() {
    const { values, factor } = this;
    if (!values || this.kind === "color") return null;
    const isDepth = this.kind === "depth";
    let least = Infinity;
    let most = -Infinity;
    for (let index = 0; index < values.length; index++) {
      const value = /** @type {number} */ (values[index]) * factor;
      if (isDepth && !(value > 0 && value < FARTHEST)) continue;
      if (value < least) least = value;
      if (value > most) most = value;
    }
    return least <= most ? { least, most } : null;
  }

  /** Return the limits of a fitting scale, rounded for depth; null if there are no values. */
  usualScale() {
    if (this.kind === "color") return null;
    if (this.kind === "grey" && this.header.number === "B") return { near: 0, far: 255 };
    const range = this.range();
    if (!range) return { near: 0, far: 1 };
    if (this.kind === "grey") return { near: range.least, far: Math.max(range.most, range.least + 1) };
    const near = Math.floor(range.least / ROUNDING) * ROUNDING;
    return { near, far: Math.max(Math.ceil(range.most / ROUNDING) * ROUNDING, near + ROUNDING) };
  }

  /**
   * Draw the picture on a canvas of its size.
   * @param {HTMLCanvasElement} canvas
   * @param {Scale} scale
   */
  paint(canvas, scale) {
    if (canvas.width !== this.columns) canvas.width = this.columns;
    if (canvas.height !== this.rows) canvas.height = this.rows;
    const context = canvas.getContext("2d", { willReadFrequently: true });
    if (!context) return;
    if (this.bitmap) {
      context.clearRect(0, 0, this.columns, this.rows);
      context.drawImage(this.bitmap, 0, 0);
      return;
    }
    const image = context.createImageData(this.columns, this.rows);
    const out = new Uint32Array(image.data.buffer);
    if (this.kind === "color") this.paintColors(out);
    else this.paintValues(out, scale);
    context.putImageData(image, 0, 0);
  }

  /** @param {Uint32Array} out */
  paintColors(out) {
    const values = /** @type {Uint8Array} */ (this.values);
    const channels = this.header.channels ?? "rgb";
    const size = channels.length;
    const [red, green, blue] = [channels.indexOf("r"), channels.indexOf("g"), channels.indexOf("b")];
    for (let index = 0, at = 0; index < out.length; index++, at += size) {
      const [r, g, b] = [values[at + red] ?? 0, values[at + green] ?? 0, values[at + blue] ?? 0];
      out[index] = 0xff000000 | (b << 16) | (g << 8) | r;
    }
  }

  /** @param {Uint32Array} out @param {Scale} scale */
  paintValues(out, { near, far, colors }) {
    const values = /** @type {ArrayLike<number>} */ (this.values);
    const isDepth = this.kind === "depth";
    const table = colorTable(isDepth ? colors : [[0, 0, 0], [255, 255, 255]]);
    const factor = (this.factor * (LEVELS - 1)) / (far - near);
    const offset = (near * (LEVELS - 1)) / (far - near) - 0.5;
    for (let index = 0; index < out.length; index++) {
      const value = /** @type {number} */ (values[index]);
      if (isDepth && !(value > 0 && value * this.factor < FARTHEST)) {
        out[index] = NO_READING;
        continue;
      }
      const level = (value * factor - offset) | 0;
      out[index] = /** @type {number} */ (table[level < 0 ? 0 : level >= LEVELS ? LEVELS - 1 : level]);
    }
  }
}

/** Return evenly interpolated colours, as pixels of a canvas. @param {Color[]} colors */
function colorTable(colors) {
  return Uint32Array.from({ length: LEVELS }, (_, level) => {
    const [r = 0, g = 0, b = 0] = mix(colors, level / (LEVELS - 1));
    return 0xff000000 | (b << 16) | (g << 8) | r;
  });
}

/**
 * Return the colour at a position from 0 to 1.
 * @param {Color[]} colors
 * @param {number} position
 * @returns {Color}
 */
export function mix(colors, position) {
  const place = position * (colors.length - 1);
  const index = Math.min(Math.floor(place), colors.length - 2);
  const [one, other] = [colors[index] ?? [], colors[index + 1] ?? []];
  return one.map((value, part) => Math.round(value + (place - index) * ((other[part] ?? value) - value)));
}

/**
 * Decode an image from the server.
 * @param {Header} header
 * @param {ArrayBuffer} payload
 * @returns {Promise<Picture>}
 */
export async function readPicture(header, payload) {
  if (header.file && header.kind) {
    const values = await decodeGrey16(payload);
    return new Picture({ ...header, columns: header.width, rows: header.height }, values, null);
  }
  if (header.file) {
    return new Picture(header, null, await createImageBitmap(new Blob([payload], { type: header.file })));
  }
  const kinds = { B: Uint8Array, H: Uint16Array, f: Float32Array };
  return new Picture(header, new kinds[header.number ?? "B"](payload), null);
}
