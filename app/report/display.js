// SPDX-License-Identifier: GPL-3.0-or-later
// From linear radiance to the colours of a screen, and from errors to those of the map. Exposure, tone
// curves and colours are those of io/display.h and io/color.h.

const kNanColor = [255, 0, 255];
const kErrorDecades = [-3, 0];  // of relative errors: the ends of the colour map

/** 8 bits of sRGB for linear light; what is outside [0, 1] is cut off. */
function encodeSrgb(linear) {
  const x = linear > 1 ? 1 : linear > 0 ? linear : 0;
  return Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
}

/** [Narkowicz2016] */
function aces(x) {
  const v = Math.max(x, 0);
  return v > 1e6 ? 1 : v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
}

const toneNames = {none: 'cut off at 1', reinhard: 'Reinhard', aces: 'ACES'};

/** Bytes for all 16-bit floats, for curves that treat the channels alike. */
function toneTable(scale, tone) {
  const table = new Uint8ClampedArray(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const exposed = halfValues[bits] * scale;
    table[bits] = encodeSrgb(tone === 'aces' ? aces(exposed) : exposed);
  }
  return table;
}

/** sRGB of [0, 1] in steps too small to see. */
const encodedSteps = (() => {
  const table = new Uint8ClampedArray(16385);
  for (let i = 0; i < table.length; ++i) table[i] = encodeSrgb(i / 16384);
  return table;
})();
const encodeFast = (x) => encodedSteps[x >= 1 ? 16384 : x > 0 ? Math.round(16384 * x) : 0];

/** Writes the pixels of a picture as a screen shows them: [Reinhard2002, eq. 3] or by a table. */
function showPicture(picture, exposure, tone, rgba) {
  const {bits} = picture;
  const scale = 2 ** (picture.exponent + exposure);
  const table = tone === 'reinhard' ? null : toneTable(scale, tone);
  for (let p = 0, i = 0; i < bits.length; ++p, i += 3) {
    const at = 4 * p;
    rgba[at + 3] = 255;
    if (isNan(bits[i]) || isNan(bits[i + 1]) || isNan(bits[i + 2])) {
      [rgba[at], rgba[at + 1], rgba[at + 2]] = kNanColor;
    } else if (table) {
      rgba[at] = table[bits[i]];
      rgba[at + 1] = table[bits[i + 1]];
      rgba[at + 2] = table[bits[i + 2]];
    } else {
      const r = scale * halfValues[bits[i]], g = scale * halfValues[bits[i + 1]];
      const b = scale * halfValues[bits[i + 2]];
      const y = 0.212671 * r + 0.715160 * g + 0.072169 * b;
      const share = Number.isFinite(y) && y > 0 ? 1 / (1 + y) : 1;
      rgba[at] = encodeFast(share * r);
      rgba[at + 1] = encodeFast(share * g);
      rgba[at + 2] = encodeFast(share * b);
    }
  }
}

/** R, G, B of a pixel. */
function pixelOf(picture, x, y) {
  const i = 3 * (y * picture.width + x);
  const scale = 2 ** picture.exponent;
  return [0, 1, 2].map((c) => scale * halfValues[picture.bits[i + c]]);
}

/** Of one pixel, as `vrc compare` has it; NaN where either picture is not finite. */
function relativeError(picture, reference, p, offset) {
  const a = 2 ** picture.exponent, b = 2 ** reference.exponent;
  let sum = 0;
  for (let c = 0; c < 3; ++c) {
    const r = b * halfValues[reference.bits[3 * p + c]];
    const d = a * halfValues[picture.bits[3 * p + c]] - r;
    sum += d * d / (r * r + offset);
  }
  return Math.sqrt(sum / 3);
}

/** The map's colours, from "rrggbb" for each of 256. */
function parseColorMap(text) {
  return Uint8Array.from(text.match(/../g), (digits) => parseInt(digits, 16));
}

function showError(picture, reference, colors, offset, rgba) {
  const [low, high] = kErrorDecades;
  for (let p = 0; 4 * p < rgba.length; ++p) {
    const error = relativeError(picture, reference, p, offset);
    const place = (Math.log10(error) - low) / (high - low);
    const at = 3 * Math.round(255 * Math.min(Math.max(place, 0), 1));
    const color = Number.isFinite(error) ? colors.subarray(at, at + 3) : kNanColor;
    rgba[4 * p] = color[0];
    rgba[4 * p + 1] = color[1];
    rgba[4 * p + 2] = color[2];
    rgba[4 * p + 3] = 255;
  }
}

/** Three digits. */
function readable(value) {
  if (Number.isNaN(value)) return 'NaN';
  if (!Number.isFinite(value)) return value < 0 ? '−∞' : '∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential(2)
      : size >= 100 ? value.toFixed(0) : value.toPrecision(3);
  return text.replace('e+', 'e').replace(/-/g, '−');
}
