// SPDX-License-Identifier: GPL-3.0-or-later
// The cache records of a picture: their ellipses in the picture, drawn and found again.

const kTaylorColor = '#56b4e9', kHarmonicsColor = '#e65e00';
const kFewRecords = 4000;  // drawn while the view moves
const kPathLength = 100;   // ellipses

const kReasons = {
  'flat': 'flat surface',
  'turns-little': 'its normals turn little',
  'ellipse-turns': 'normals turn within the ellipse',
  'surface-turns': 'its surface turns',
  'always': 'as all records',
  'turns': 'normals turn within the ellipse',
  'replaces-many': 'stands for many Taylor records',
  'narrow': 'on an edge as narrow as a pixel',
};

class RecordLayer {
  constructor(columns, count, width, height) {
    this.columns = columns;
    this.count = count;
    this.width = width;
    this.height = height;
    if (count > 0) {
      this.#findEllipses();
      this.#sortIntoGrid();
    }
  }

  /** Half axes `a` >= `b` and the angle of `a`, of the rim p + cos(t) p1 + sin(t) p2. [pixels] */
  #findEllipses() {
    const {p1x, p1y, p2x, p2y} = this.columns;
    this.a = new Float32Array(this.count);
    this.b = new Float32Array(this.count);
    this.angle = new Float32Array(this.count);
    for (let i = 0; i < this.count; ++i) {
      const xx = p1x[i] ** 2 + p2x[i] ** 2, yy = p1y[i] ** 2 + p2y[i] ** 2;
      const xy = p1x[i] * p1y[i] + p2x[i] * p2y[i];
      const middle = 0.5 * (xx + yy), half = Math.hypot(0.5 * (xx - yy), xy);
      this.a[i] = Math.sqrt(middle + half);
      this.b[i] = Math.sqrt(Math.max(middle - half, 0));
      this.angle[i] = 0.5 * Math.atan2(2 * xy, xx - yy);
    }
    this.typicalRadius = this.a.slice().sort()[this.count >> 1];
  }

  /** Cells name the records whose whole ellipse's box meets them. */
  #sortIntoGrid() {
    const size = Math.max(4, Math.ceil(Math.max(this.width, this.height) / 96));
    const columns = Math.ceil(this.width / size), rows = Math.ceil(this.height / size);
    this.grid = {size, columns, rows, starts: new Uint32Array(columns * rows + 1)};
    const {starts} = this.grid;
    this.#forEachCell((cell) => ++starts[cell + 1]);
    for (let c = 0; c < columns * rows; ++c) starts[c + 1] += starts[c];
    const next = starts.slice();
    this.grid.members = new Uint32Array(starts[columns * rows]);
    this.#forEachCell((cell, i) => { this.grid.members[next[cell]++] = i; });
  }

  #forEachCell(body) {
    const {size, columns, rows} = this.grid;
    const {px, py, p1x, p1y, p2x, p2y} = this.columns;
    for (let i = 0; i < this.count; ++i) {
      const w = Math.max(Math.hypot(p1x[i], p2x[i]), 2), h = Math.max(Math.hypot(p1y[i], p2y[i]), 2);
      const x0 = Math.max(0, Math.floor((px[i] - w) / size)), y0 = Math.max(0, Math.floor((py[i] - h) / size));
      const x1 = Math.min(columns - 1, Math.floor((px[i] + w) / size));
      const y1 = Math.min(rows - 1, Math.floor((py[i] + h) / size));
      for (let y = y0; y <= y1; ++y) for (let x = x0; x <= x1; ++x) body(y * columns + x, i);
    }
  }

  /** In units of the ellipse's half axes, which are at least `least` pixels. */
  #distance(i, x, y, scale, least) {
    const dx = x - this.columns.px[i], dy = y - this.columns.py[i];
    const c = Math.cos(this.angle[i]), s = Math.sin(this.angle[i]);
    return Math.hypot((c * dx + s * dy) / Math.max(scale * this.a[i], least),
                      (c * dy - s * dx) / Math.max(scale * this.b[i], least));
  }

  /** The record whose drawn ellipse holds the point, and whose centre is the nearest to it; or -1. */
  find(x, y, scale, least) {
    if (this.count === 0 || x < 0 || y < 0 || x >= this.width || y >= this.height) return -1;
    const {size, columns, starts, members} = this.grid;
    const cell = Math.floor(y / size) * columns + Math.floor(x / size);
    let best = -1, bestDistance = Infinity;
    for (let k = starts[cell]; k < starts[cell + 1]; ++k) {
      const i = members[k];
      if (this.#distance(i, x, y, scale, least) > 1) continue;
      const distance = Math.hypot(x - this.columns.px[i], y - this.columns.py[i]);
      if (distance < bestDistance) [best, bestDistance] = [i, distance];
    }
    return best;
  }

  holdsHarmonics(i) { return this.columns.is_sh?.[i] > 0; }

  #trace(context, i, toView, scale) {
    const x = toView.x(this.columns.px[i]), y = toView.y(this.columns.py[i]);
    const a = scale * this.a[i] * toView.scale, b = scale * this.b[i] * toView.scale;
    if (!(a < 1e6)) return;
    if (a < 0.7) {
      context.rect(x - 0.5, y - 0.5, 1, 1);
      return;
    }
    context.moveTo(x + a * Math.cos(this.angle[i]), y + a * Math.sin(this.angle[i]));
    context.ellipse(x, y, a, b, this.angle[i], 0, 2 * Math.PI);
  }

  /** All ellipses that the view shows, or a fair share of them while it moves. */
  draw(context, toView, scale, moving) {
    const stride = moving ? Math.max(1, Math.ceil(this.count / kFewRecords)) : 1;
    // Ellipses that are small, which crowd, have thin lines.
    const radius = scale * this.typicalRadius * toView.scale;
    const lineWidth = Math.min(1.5, Math.max(0.4, 0.2 * radius));
    const shown = this.#shown(toView, scale, stride);
    // Dark rims make lines stand out from bright pictures and from errors.
    if (!moving && radius > 5) {
      context.strokeStyle = 'rgba(0,0,0,.3)';
      context.lineWidth = lineWidth + 1.2;
      for (const list of shown) this.#stroke(context, list, toView, scale);
    }
    context.lineWidth = lineWidth;
    [kTaylorColor, kHarmonicsColor].forEach((color, k) => {
      context.strokeStyle = color;
      this.#stroke(context, shown[k], toView, scale);
    });
  }

  /** Taylor records and those of harmonics that reach into the view. */
  #shown(toView, scale, stride) {
    const shown = [[], []];
    for (let i = 0; i < this.count; i += stride) {
      const x = toView.x(this.columns.px[i]), y = toView.y(this.columns.py[i]);
      const reach = scale * this.a[i] * toView.scale + 2;
      if (x < -reach || y < -reach || x > toView.width + reach || y > toView.height + reach) continue;
      shown[this.holdsHarmonics(i) ? 1 : 0].push(i);
    }
    return shown;
  }

  /** In short paths: browsers take much longer for one of many thousand ellipses. */
  #stroke(context, list, toView, scale) {
    for (let begin = 0; begin < list.length; begin += kPathLength) {
      context.beginPath();
      for (const i of list.slice(begin, begin + kPathLength)) this.#trace(context, i, toView, scale);
      context.stroke();
    }
  }

  /** One record at its full size, with its half axes. */
  drawChosen(context, i, toView) {
    const {px, py, p1x, p1y, p2x, p2y} = this.columns;
    const x = toView.x(px[i]), y = toView.y(py[i]), s = toView.scale;
    for (const [color, lineWidth] of [['rgba(0,0,0,.65)', 4], ['#fff', 1.75]]) {
      context.beginPath();
      this.#trace(context, i, toView, 1);
      context.moveTo(x, y);
      context.lineTo(x + s * p1x[i], y + s * p1y[i]);
      context.moveTo(x, y);
      context.lineTo(x + s * p2x[i], y + s * p2y[i]);
      context.strokeStyle = color;
      context.lineWidth = lineWidth;
      context.stroke();
    }
  }

  /** Pairs of a name and a text; what the record map lacks is left out. */
  describe(i) {
    const c = this.columns;
    const rows = [];
    if (c.r1) {
      rows.push(['radii', `${readable(c.r1[i])} × ${readable(c.r2[i])}`]);
    }
    rows.push(['in pixels', `${readable(this.a[i])} × ${readable(this.b[i])}`]);
    if (c.L_r) {
      const luminance = 0.212671 * c.L_r[i] + 0.715160 * c.L_g[i] + 0.072169 * c.L_b[i];
      rows.push(['L', [c.L_r[i], c.L_g[i], c.L_b[i]].map(readable).join('  ')]);
      if (c.L_stddev) {
        const share = luminance > 0 ? ` (${readable(100 * c.L_stddev[i] / luminance)} %)` : '';
        rows.push(['noise', `± ${readable(c.L_stddev[i])}${share}`]);
      }
    }
    if (c.g1) rows.push(['gradient', `${readable(Math.hypot(c.g1[i], c.g2[i]))} per unit`]);
    if (c.rays) rows.push(['rays', c.rays[i].toFixed(0)]);
    return rows;
  }

  /** What it holds and why. */
  classOf(i) {
    const harmonics = this.holdsHarmonics(i);
    const reason = harmonics ? this.columns.sh_reason?.[i] : this.columns.reason?.[i];
    return {
      color: harmonics ? kHarmonicsColor : kTaylorColor,
      name: harmonics ? 'Spherical harmonics' : 'Taylor',
      reason: kReasons[reason] ?? reason ?? '',
    };
  }
}
