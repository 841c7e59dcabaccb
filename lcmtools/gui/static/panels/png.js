// A decoder of 16-bit grey PNG files: browsers' own decoders keep only eight bits.

const SIGNATURE = 8; // bytes

/**
 * Return the pixel values of a 16-bit grey PNG file.
 * @param {ArrayBuffer} file
 * @returns {Promise<Uint16Array>}
 */
export async function decodeGrey16(file) {
  const view = new DataView(file);
  /** @type {Uint8Array<ArrayBuffer>[]} */
  const parts = [];
  let [width, height] = [0, 0];
  for (let at = SIGNATURE; at + 12 <= file.byteLength; ) {
    const length = view.getUint32(at);
    const kind = view.getUint32(at + 4);
    if (kind === 0x49484452) {
      [width, height] = [view.getUint32(at + 8), view.getUint32(at + 12)];
      if (view.getUint8(at + 20)) throw new Error("an interlaced PNG file is not shown");
    } else if (kind === 0x49444154) {
      parts.push(new Uint8Array(file, at + 8, Math.min(length, file.byteLength - at - 8)));
    }
    at += 12 + length;
  }
  const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream("deflate"));
  const rows = new Uint8Array(await new Response(stream).arrayBuffer());
  return unfiltered(rows, width, height);
}

/**
 * Reverse the filters of the rows.
 * @param {Uint8Array} data each row's filter and bytes
 * @param {number} width
 * @param {number} height
 */
function unfiltered(data, width, height) {
  const size = width * 2;
  if (data.length < height * (size + 1)) throw new Error("the PNG file is cut off");
  const numbers = new Uint16Array(width * height);
  /** @type {Uint8Array} */
  let above = new Uint8Array(size);
  for (let y = 0; y < height; y++) {
    const start = y * (size + 1);
    const filter = data[start];
    const row = data.subarray(start + 1, start + 1 + size);
    for (let x = 0; filter && x < size; x++) {
      const left = x > 1 ? at(row, x - 2) : 0;
      const corner = x > 1 ? at(above, x - 2) : 0;
      row[x] = at(row, x) + predicted(filter, left, at(above, x), corner);
    }
    for (let x = 0; x < width; x++) numbers[y * width + x] = (at(row, 2 * x) << 8) | at(row, 2 * x + 1);
    above = row;
  }
  return numbers;
}

/** @param {Uint8Array} bytes @param {number} index */
function at(bytes, index) {
  return /** @type {number} */ (bytes[index]);
}

/**
 * @param {number | undefined} filter 1: left, 2: above, 3: their mean, 4: Paeth's
 * @param {number} left
 * @param {number} above
 * @param {number} corner
 */
function predicted(filter, left, above, corner) {
  if (filter === 1) return left;
  if (filter === 2) return above;
  if (filter === 3) return (left + above) >> 1;
  const [byLeft, byAbove] = [Math.abs(above - corner), Math.abs(left - corner)];
  const byCorner = Math.abs(left + above - 2 * corner);
  if (byLeft <= byAbove && byLeft <= byCorner) return left;
  return byAbove <= byCorner ? above : corner;
}
