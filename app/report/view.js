// SPDX-License-Identifier: GPL-3.0-or-later
// One canvas: a picture, or two with a divider between them, what is drawn over it, and how pointers move it.

const kMostZoom = 64;
const kScrollPause = 250;  // [ms] after which the wheel over a picture no longer scrolls the page
const kStillTime = 140;    // [ms] after which a moved view is drawn in full

let lastPageScroll = -Infinity;
addEventListener('scroll', () => { lastPageScroll = performance.now(); }, {passive: true});

/** Sends a pressed pointer's events to the element until it is released. */
function capture(node, event) {
  try {
    node.setPointerCapture(event.pointerId);
  } catch {
    // It was released meanwhile.
  }
}

/** Where the pictures of a group are looked at: zoom 1 shows all; the centre is in pixels. */
class Placement {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.reset();
  }
  reset() {
    this.zoom = 1;
    this.x = 0.5 * this.width;
    this.y = 0.5 * this.height;
  }
  /** Keeps the pictures' borders out of the view. */
  limit() {
    this.zoom = Math.min(Math.max(this.zoom, 1), kMostZoom);
    const w = 0.5 * this.width / this.zoom, h = 0.5 * this.height / this.zoom;
    this.x = Math.min(Math.max(this.x, w), this.width - w);
    this.y = Math.min(Math.max(this.y, h), this.height - h);
  }
  /** Zooms so that the picture's point (x, y) stays where it is. */
  zoomAt(factor, x, y) {
    const before = this.zoom;
    this.zoom = Math.min(Math.max(before * factor, 1), kMostZoom);
    this.x = x + (this.x - x) * before / this.zoom;
    this.y = y + (this.y - y) * before / this.zoom;
    this.limit();
  }
}

/**
 * `host` is the viewer: {placement, state, onView(moving), onSplit(split), onCursor(point or null, view)}.
 * `show` draws what the host says.
 */
class View {
  #pointers = new Map();
  #lastTap = {time: -Infinity, x: 0, y: 0};
  #pinch = null;
  #still = 0;
  #recordsDrawn = '';

  constructor(host, label) {
    this.host = host;
    this.picture = element('canvas', {className: 'picture', tabIndex: 0, role: 'img', 'aria-label': label});
    this.records = element('canvas', {className: 'records', 'aria-hidden': 'true'});
    this.marks = element('canvas', {className: 'marks', 'aria-hidden': 'true'});
    this.left = element('span', {className: 'tag left'});
    this.right = element('span', {className: 'tag right', hidden: true});
    this.divider = this.#makeDivider();
    this.node = element('div', {className: 'stage'}, this.picture, this.records, this.marks, this.left, this.right,
                        this.divider);
    this.node.style.aspectRatio = `${host.placement.width} / ${host.placement.height}`;
    this.node.style.setProperty('--shape', host.placement.width / host.placement.height);
    this.#listen();
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.picture);
  }

  remove() {
    this.observer.disconnect();
    clearTimeout(this.#still);
    this.node.remove();
  }

  /** From pixels of the picture to those of the style sheet. */
  toView() {
    const {placement} = this.host;
    const width = this.picture.clientWidth, height = this.picture.clientHeight;
    const scale = width / placement.width * placement.zoom;
    return {
      scale, width, height,
      x: (x) => (x - placement.x) * scale + 0.5 * width,
      y: (y) => (y - placement.y) * scale + 0.5 * height,
    };
  }
  fromView(x, y) {
    const {placement} = this.host;
    const to = this.toView();
    return {x: (x - 0.5 * to.width) / to.scale + placement.x, y: (y - 0.5 * to.height) / to.scale + placement.y};
  }
  #pointOf(event) {
    const box = this.picture.getBoundingClientRect();
    return this.fromView(event.clientX - box.left, event.clientY - box.top);
  }

  /**
   * `content` is {first, second or null, split in [0, 1], records(context, toView, moving),
   * recordsKey, marks(context, toView)}: what is drawn over them, the records only when their key or the view
   * has changed.
   */
  show(content, moving = false) {
    this.content = content;
    this.draw(moving);
  }

  draw(moving = false) {
    const to = this.toView();
    if (!this.content || to.width === 0) return;
    const density = devicePixelRatio || 1;
    for (const canvas of [this.picture, this.records, this.marks]) {
      const width = Math.round(to.width * density), height = Math.round(to.height * density);
      if (canvas.width === width && canvas.height === height) continue;
      Object.assign(canvas, {width, height});
      this.#recordsDrawn = '';
    }
    this.#drawPictures(to, density);
    this.#drawRecords(to, density, moving);
    this.content.marks(this.#cleared(this.marks, density), to);
    this.picture.style.touchAction = this.host.placement.zoom > 1 ? 'none' : 'pan-y';
    this.node.classList.toggle('zoomed', this.host.placement.zoom > 1);
  }

  #drawPictures(to, density) {
    const {first, second, split} = this.content;
    const context = this.picture.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.picture.width, this.picture.height);
    // Enlarged pixels stay pixels.
    context.imageSmoothingEnabled = to.scale * density < 1;
    context.imageSmoothingQuality = 'high';
    const paint = (source, from, until) => {
      if (!source) return;
      context.save();
      context.beginPath();
      context.rect(from, 0, until - from, this.picture.height);
      context.clip();
      const scale = to.scale * density;
      context.drawImage(source, to.x(0) * density, to.y(0) * density, source.width * scale,
                        source.height * scale);
      context.restore();
    };
    const border = second ? Math.round(split * this.picture.width) : this.picture.width;
    paint(first, 0, border);
    if (second) paint(second, border, this.picture.width);
    this.divider.hidden = !second;
    this.right.hidden = !second;
    this.divider.style.left = `${100 * split}%`;
    this.divider.setAttribute('aria-valuenow', Math.round(100 * split));
  }

  #drawRecords(to, density, moving) {
    const {placement} = this.host;
    const key = [this.content.recordsKey, to.width, to.height, density, placement.zoom, placement.x, placement.y,
                 this.content.second ? this.content.split : ''].join(' ');
    if (moving) {
      clearTimeout(this.#still);
      this.#still = setTimeout(() => this.draw(), kStillTime);
    } else if (key === this.#recordsDrawn) {
      return;
    }
    this.#recordsDrawn = moving ? '' : key;
    this.content.records(this.#cleared(this.records, density), to, moving);
  }

  /** The canvas's context, to be drawn on in pixels of the style sheet. */
  #cleared(canvas, density) {
    const context = canvas.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.setTransform(density, 0, 0, density, 0, 0);
    return context;
  }

  #makeDivider() {
    const move = (split) => this.host.onSplit(Math.min(Math.max(split, 0), 1));
    const divider = element('div', {
      className: 'divider', tabIndex: 0, role: 'slider', hidden: true, 'aria-label': 'Divider between two methods',
      'aria-valuemin': 0, 'aria-valuemax': 100, 'aria-orientation': 'horizontal',
    });
    divider.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      capture(divider, event);
      divider.focus({preventScroll: true});
      divider.dragged = true;
    });
    divider.addEventListener('pointermove', (event) => {
      if (!divider.dragged) return;
      const box = this.picture.getBoundingClientRect();
      move((event.clientX - box.left) / box.width);
    });
    for (const end of ['pointerup', 'pointercancel'])
      divider.addEventListener(end, () => { divider.dragged = false; });
    divider.addEventListener('keydown', (event) => {
      const step = {ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1}[event.key];
      if (step === undefined || event.shiftKey) return;
      event.preventDefault();
      event.stopPropagation();
      move(this.host.state.split + step);
    });
    return divider;
  }

  #listen() {
    const canvas = this.picture;
    canvas.addEventListener('wheel', (event) => this.#onWheel(event), {passive: false});
    canvas.addEventListener('dblclick', () => this.#reset());
    canvas.addEventListener('pointerdown', (event) => this.#onDown(event));
    canvas.addEventListener('pointermove', (event) => this.#onMove(event));
    for (const end of ['pointerup', 'pointercancel'])
      canvas.addEventListener(end, (event) => this.#onUp(event));
    canvas.addEventListener('pointerleave', (event) => {
      if (event.pointerType === 'mouse') this.host.onCursor(null, this);
    });
  }

  #reset() {
    this.host.placement.reset();
    this.host.onView(false);
  }

  /** The page goes on scrolling when it is scrolled already, or when there is nothing to zoom out of. */
  #onWheel(event) {
    const inward = event.deltaY < 0;
    if (!event.ctrlKey && performance.now() - lastPageScroll < kScrollPause) return;
    if (!inward && this.host.placement.zoom === 1) return;
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 20 : 1);
    const point = this.#pointOf(event);
    this.host.placement.zoomAt(Math.exp(-Math.min(Math.max(pixels, -200), 200) / 300), point.x, point.y);
    this.host.onView(true);
  }

  #onDown(event) {
    if (event.pointerType === 'mouse' && event.button !== 0) return;
    capture(this.picture, event);
    this.#pointers.set(event.pointerId, {x: event.clientX, y: event.clientY, moved: 0});
    this.#pinch = null;
    if (event.pointerType !== 'mouse') this.host.onCursor(this.#pointOf(event), this);
  }

  #onMove(event) {
    const pointer = this.#pointers.get(event.pointerId);
    if (!pointer) {
      this.host.onCursor(this.#pointOf(event), this);
      return;
    }
    const dx = event.clientX - pointer.x, dy = event.clientY - pointer.y;
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    pointer.moved += Math.abs(dx) + Math.abs(dy);
    const {placement} = this.host;
    if (this.#pointers.size === 2) {
      this.#onPinch();
    } else if (this.#pointers.size === 1 && placement.zoom > 1) {
      const {scale} = this.toView();
      placement.x -= dx / scale;
      placement.y -= dy / scale;
      placement.limit();
      this.host.onView(true);
    } else {
      this.host.onCursor(this.#pointOf(event), this);
    }
  }

  #onPinch() {
    const [a, b] = [...this.#pointers.values()];
    const now = {x: 0.5 * (a.x + b.x), y: 0.5 * (a.y + b.y), spread: Math.hypot(a.x - b.x, a.y - b.y)};
    if (this.#pinch && this.#pinch.spread > 0) {
      const box = this.picture.getBoundingClientRect();
      const {scale} = this.toView();
      const {placement} = this.host;
      placement.x -= (now.x - this.#pinch.x) / scale;
      placement.y -= (now.y - this.#pinch.y) / scale;
      const point = this.fromView(now.x - box.left, now.y - box.top);
      placement.zoomAt(now.spread / this.#pinch.spread, point.x, point.y);
      this.host.onView(true);
    }
    this.#pinch = now;
  }

  #onUp(event) {
    const pointer = this.#pointers.get(event.pointerId);
    this.#pointers.delete(event.pointerId);
    this.#pinch = null;
    if (!pointer || event.type === 'pointercancel' || event.pointerType === 'mouse' || pointer.moved > 12) return;
    // Two taps count as a double click, which not all browsers make of them.
    const before = this.#lastTap;
    const twice = event.timeStamp - before.time < 350 && Math.hypot(pointer.x - before.x, pointer.y - before.y) < 30;
    this.#lastTap = {time: twice ? -Infinity : event.timeStamp, x: pointer.x, y: pointer.y};
    if (twice) this.#reset();
  }
}
