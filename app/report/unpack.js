'use strict';
// SPDX-License-Identifier: GPL-3.0-or-later
// From the bytes in the page to pictures and columns of numbers; the layout is that of report_pack.h.

/** Values of all 16-bit floats (IEEE 754 binary16). */
const halfValues = (() => {
  const values = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    let magnitude = fraction * 2 ** -24;
    if (exponent === 31) magnitude = fraction ? NaN : Infinity;
    else if (exponent > 0) magnitude = (1024 + fraction) * 2 ** (exponent - 25);
    values[bits] = bits & 0x8000 ? -magnitude : magnitude;
  }
  return values;
})();

const isNan = (bits) => (bits & 0x7fff) > 0x7c00;

/** The bytes of an element that holds a zlib stream in base64. */
async function inflate(id) {
  const text = atob(document.getElementById(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes the prediction from earlier neighbours; integers are those of 16 bits with sign. */
function unpredict(high, low, width) {
  const values = new Int16Array(high.length);
  for (let i = 0, x = 0; i < values.length; ++i) {
    const folded = (high[i] << 8) | low[i];
    let guess = 0;
    if (i < width) {
      guess = x > 0 ? values[i - 1] : 0;
    } else if (x === 0) {
      guess = values[i - width];
    } else {
      const left = values[i - 1], up = values[i - width];
      const least = left < up ? left : up, most = left < up ? up : left;
      guess = left + up - values[i - width - 1];
      guess = guess < least ? least : guess > most ? most : guess;
    }
    values[i] = guess + ((folded >> 1) ^ -(folded & 1));  // wraps as it did when it was packed
    if (++x === width) x = 0;
  }
  return values;
}

/**
 * A picture: `bits` holds 16-bit floats, three to a pixel; a value is halfValues[bits] * 2^exponent.
 * `broken` counts the pixels with NaN.
 */
async function unpackPicture(entry, width, height) {
  const bytes = await inflate(entry.data);
  const count = width * height;
  const channel = (k) => unpredict(bytes.subarray(2 * k * count, (2 * k + 1) * count),
                                   bytes.subarray((2 * k + 1) * count, (2 * k + 2) * count), width);
  const green = channel(0), red = channel(1), blue = channel(2);
  const bits = new Uint16Array(3 * count);
  const half = (ordered) => {
    const value = (ordered << 16) >> 16;
    return value < 0 ? 0x8000 | -value : value;
  };
  let broken = 0;
  for (let p = 0; p < count; ++p) {
    const r = half(green[p] + red[p]), g = half(green[p]), b = half(green[p] + blue[p]);
    bits[3 * p] = r;
    bits[3 * p + 1] = g;
    bits[3 * p + 2] = b;
    if (isNan(r) || isNan(g) || isNan(b)) ++broken;
  }
  return {width, height, bits, exponent: entry.exponent, broken};
}

/** Columns by name: arrays of numbers or of words. */
async function unpackColumns(entry) {
  const columns = {};
  if (entry.count === 0) return columns;
  const bytes = await inflate(entry.data);
  entry.columns.forEach((column, k) => {
    const high = bytes.subarray(2 * k * entry.count, (2 * k + 1) * entry.count);
    const low = bytes.subarray((2 * k + 1) * entry.count, (2 * k + 2) * entry.count);
    const quantum = (i) => (high[i] << 8) | low[i];
    if (column.words) {
      columns[column.name] = Array.from(high, (_, i) => column.words[quantum(i)]);
    } else if ('step' in column) {
      columns[column.name] = Float32Array.from(high, (_, i) => column.low + column.step * quantum(i));
    } else {
      const scale = 2 ** column.exponent;
      columns[column.name] = Float32Array.from(high, (_, i) => scale * halfValues[quantum(i)]);
    }
  });
  return columns;
}
