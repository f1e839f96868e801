// SPDX-License-Identifier: GPL-3.0-or-later
// A group of pictures: which of them are shown and how, in one view, split, or side by side.

class Viewer {
  #painted = new Map();   // by panel: {key, canvas}
  #pictures = new Map();  // by panel: promises of unpacked pictures
  #layers = new Map();    // by panel: promises of RecordLayer
  #ready = new Map();     // by promise's key: what it gave
  #views = [];

  /** `settings` is {colors, errorOffset} of the page. */
  constructor(node, group, settings) {
    this.node = node;
    this.group = group;
    this.panels = group.panels;
    this.settings = settings;
    this.placement = new Placement(group.width, group.height);
    const referred = this.panels.find((panel) => panel.reference !== undefined)?.reference;
    this.state = {
      panel: 0, other: referred || Math.min(1, this.panels.length - 1), before: 0, layout: 'one', error: false,
      records: false, size: 0.5, exposure: group.exposure, tone: 'none', split: 0.5,
    };
    this.cursor = null;
    this.chosen = -1;
    this.#build();
  }

  // What is there.

  #build() {
    this.views = element('div', {className: 'views'});
    this.strip = element('div', {className: 'strip'});
    this.legend = element('div', {className: 'legend'});
    this.tip = element('div', {className: 'tip', role: 'tooltip', hidden: true});
    this.methods = element('div', {className: 'methods', role: 'group', 'aria-label': 'Methods'});
    this.methodButtons = this.panels.map((panel, i) => {
      const button = element('button', {type: 'button', className: 'method', onclick: () => this.choose(i)},
          element('kbd', {'aria-hidden': 'true'}, i < 9 ? String(i + 1) : ''),
          element('span', {className: 'name'}, panel.name),
          element('span', {className: 'note'}, panel.note ?? ''));
      this.methods.append(button);
      return button;
    });
    this.#buildControls();
    this.node.append(
        element('div', {className: 'look'}, this.views, this.legend, this.strip),
        element('div', {className: 'side'}, this.methods, this.controls), this.tip);
    this.node.addEventListener('pointerleave', () => { this.tip.hidden = true; });
    this.#layOut();
    this.update();
  }

  #buildControls() {
    const set = (name) => (value) => this.set({[name]: value});
    const several = this.panels.length > 1;
    this.layoutChoice = choiceButtons('Layout', [
      ['one', 'One', 'One picture (O)'], ['split', 'Split', 'Two pictures and a divider (S)'],
      ['all', 'All', 'All pictures (A)']], set('layout'));
    this.otherChoice = selection('against', this.panels.map((panel, i) => [String(i), panel.name]),
                                 (value) => this.set({other: Number(value)}));
    this.errorChoice = choiceButtons('What is shown', [
      [false, 'Radiance', 'The pictures'], [true, 'Error', 'Relative error against the reference (E)']],
      set('error'));
    this.recordsButton = element('button', {
      type: 'button', className: 'choice alone', title: 'Ellipses of the cache records (R)', 'aria-pressed': 'false',
      onclick: () => this.set({records: !this.state.records}),
    }, 'Records');
    this.sizeSlider = slider('Size', {
      low: 0.1, high: 1, step: 0.05, rest: 0.5, text: (v) => `${Math.round(100 * v)} %`}, set('size'));
    this.exposureSlider = slider('Exposure', {
      low: -8, high: 8, step: 0.25, rest: this.group.exposure,
      text: (v) => `${v > 0 ? '+' : v < 0 ? '−' : ''}${Math.abs(v)} EV`}, set('exposure'));
    this.toneChoice = selection('Tone', Object.entries(toneNames), set('tone'));
    this.hasErrors = this.panels.some((panel) => panel.reference !== undefined);
    this.hasRecords = this.panels.some((panel) => panel.records);
    const line = (...children) => element('div', {className: 'line'}, ...children);
    this.controls = element('div', {className: 'controls'});
    if (several) this.controls.append(line(this.layoutChoice.node), this.otherChoice.node);
    const what = line();
    if (this.hasErrors) what.append(this.errorChoice.node);
    if (this.hasRecords) what.append(this.recordsButton);
    if (what.childElementCount > 0) this.controls.append(what);
    if (this.hasRecords) this.controls.append(this.sizeSlider.node);
    this.controls.append(this.exposureSlider.node, this.toneChoice.node);
  }

  /** The views of the layout, with what they show. */
  #layOut() {
    for (const view of this.#views) view.remove();
    const all = this.state.layout === 'all';
    const panels = all ? this.panels.map((_, i) => i) : [null];
    this.#views = panels.map((panel) => {
      const view = new View(this, this.group.name);
      view.panel = panel;
      return view;
    });
    this.views.replaceChildren(...this.#views.map((view) => view.node));
    this.views.classList.toggle('all', all);
    this.layoutShown = this.state.layout;
  }

  // What is loaded.

  /** Starts to unpack what is shown. */
  load() {
    if (this.loaded) return;
    this.loaded = true;
    this.update();
    this.#unpackOthers();
  }

  /** One after the other, so that flipping to them is instant. */
  async #unpackOthers() {
    for (let i = 0; i < this.panels.length && this.loaded; ++i) {
      this.#picture(i);
      await this.#pictures.get(i).catch(() => null);
    }
  }

  /** Gives the memory back; `load` brings everything again. */
  unload() {
    if (!this.loaded) return;
    this.loaded = false;
    for (const map of [this.#painted, this.#pictures, this.#layers, this.#ready]) map.clear();
    for (const view of this.#views) view.content = null;
  }

  /** What `make` promises, or null until it is there; everything is drawn again then. */
  #whenReady(promises, kind, index, make) {
    const key = `${kind} ${index}`;
    if (!promises.has(index)) {
      const promise = make();
      promises.set(index, promise);
      promise.then((result) => {
        if (promises.get(index) !== promise) return;  // unloaded meanwhile
        this.#ready.set(key, result);
        this.#draw();
      }).catch((error) => this.#fail(error));
    }
    return this.#ready.get(key) ?? null;
  }

  #picture(index) {
    return this.#whenReady(this.#pictures, 'picture', index, () =>
      unpackPicture(this.panels[index], this.group.width, this.group.height));
  }

  #layer(index) {
    const {records} = this.panels[index];
    if (!records) return null;
    return this.#whenReady(this.#layers, 'records', index, async () =>
      new RecordLayer(await unpackColumns(records), records.count, this.group.width, this.group.height));
  }

  #fail(error) {
    this.legend.replaceChildren(element('p', {className: 'notice', role: 'alert'},
        `A picture cannot be shown (${error.message}). The page needs a browser of 2023 or later.`));
  }

  /** A canvas of the picture's size with what the state asks for; the old one until that is there. */
  #paint(index) {
    const {state} = this;
    const picture = this.#picture(index);
    const asError = state.error && this.panels[index].reference !== undefined;
    const reference = asError ? this.#picture(this.panels[index].reference) : null;
    const known = this.#painted.get(index);
    if (!picture || (asError && !reference)) return known?.canvas ?? null;
    const key = asError ? 'error' : `${state.exposure} ${state.tone}`;
    if (known?.key === key) return known.canvas;
    const canvas = known?.canvas ?? element('canvas', {width: picture.width, height: picture.height});
    const context = canvas.getContext('2d');
    const pixels = context.createImageData(picture.width, picture.height);
    if (asError) showError(picture, reference, this.settings.colors, this.settings.errorOffset, pixels.data);
    else showPicture(picture, state.exposure, state.tone, pixels.data);
    context.putImageData(pixels, 0, 0);
    this.#painted.set(index, {key, canvas});
    return canvas;
  }

  // What changes.

  set(changes) {
    Object.assign(this.state, changes);
    this.update();
  }

  choose(index) {
    if (index < 0 || index >= this.panels.length || index === this.state.panel) return;
    this.set({before: this.state.panel, panel: index});
  }
  step(by) {
    const count = this.panels.length;
    this.choose((this.state.panel + by + count) % count);
  }
  back() { this.choose(this.state.before); }

  onView(moving) { this.#draw(moving); }
  onSplit(split) {
    this.state.split = split;
    this.#draw(true);
  }
  /** In pixels of the picture; null: the pointer has left. */
  onCursor(point, view) {
    const {width, height} = this.group;
    const inside = point && point.x >= 0 && point.y >= 0 && point.x < width && point.y < height;
    this.cursor = inside ? {...point, view} : null;
    this.#findRecord();
    this.#draw();
  }

  /** Brings everything that is seen in line with the state. */
  update() {
    const {state} = this;
    if (this.layoutShown !== state.layout) {
      this.cursor = null;
      this.#layOut();
    }
    this.methodButtons.forEach((button, i) =>
      button.setAttribute('aria-pressed', String(i === state.panel)));
    this.layoutChoice.show(state.layout);
    this.otherChoice.show(String(state.other));
    this.otherChoice.node.hidden = state.layout !== 'split';
    this.errorChoice.show(state.error);
    this.recordsButton.setAttribute('aria-pressed', String(state.records));
    this.sizeSlider.show(state.size);
    this.sizeSlider.node.hidden = !state.records;
    this.exposureSlider.show(state.exposure);
    this.toneChoice.show(state.tone);
    this.node.classList.toggle('errors', state.error);
    this.#findRecord();
    this.#showLegend();
    this.#draw();
  }

  /** The panel that a view shows at a point. */
  #panelAt(view, x) {
    if (view.panel !== null) return view.panel;
    const split = this.state.layout === 'split' && view.toView().x(x) > this.state.split * view.toView().width;
    return split ? this.state.other : this.state.panel;
  }

  #draw(moving = false) {
    if (!this.loaded) return;
    for (const view of this.#views) {
      const panel = view.panel ?? this.state.panel;
      const split = this.state.layout === 'split';
      view.left.textContent = this.#label(panel);
      view.right.textContent = this.#label(this.state.other);
      view.picture.setAttribute('aria-label', `${this.group.name}: ${this.#label(panel)}`);
      view.node.classList.toggle('current', view.panel === this.state.panel);
      view.show({
        first: this.#paint(panel) ?? view.content?.first,
        second: split ? this.#paint(this.state.other) ?? element('canvas') : null,
        split: this.state.split,
        records: (context, toView, now) => this.#drawRecords(panel, context, toView, now),
        recordsKey: this.#recordsKey(split ? [panel, this.state.other] : [panel]),
        marks: (context, toView) => this.#drawMarks(view, context, toView),
      }, moving);
    }
    this.#showReadout();
    this.#showTip();
  }

  #label(index) {
    const isReference = this.state.error && this.panels[index].reference === undefined;
    return this.panels[index].name + (isReference ? ' — radiance, no error' : '');
  }

  #recordsKey(panels) {
    if (!this.state.records) return '';
    return [this.state.size, ...panels.map((panel) => `${panel} ${this.#layer(panel) !== null}`)].join(' ');
  }

  /** Of one panel, or of two on their sides of the divider. */
  #drawRecords(panel, context, toView, moving) {
    if (!this.state.records) return;
    const side = (index, from, until) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, until - from, toView.height);
      context.clip();
      this.#layer(index)?.draw(context, toView, this.state.size, moving);
      context.restore();
    };
    const split = this.state.layout === 'split';
    const border = split ? this.state.split * toView.width : toView.width;
    side(panel, 0, border);
    if (split) side(this.state.other, border, toView.width);
  }

  #drawMarks(view, context, toView) {
    if (!this.cursor) return;
    if (this.chosen >= 0 && this.cursor.view === view)
      this.#layer(this.#panelAt(view, this.cursor.x))?.drawChosen(context, this.chosen, toView);
    if (this.#views.length > 1 || toView.scale >= 6) this.#drawPixel(context, toView);
  }

  /** A frame around the pixel under the cursor, in all views. */
  #drawPixel(context, toView) {
    const size = Math.max(toView.scale, 5);
    const x = toView.x(Math.floor(this.cursor.x) + 0.5) - 0.5 * size;
    const y = toView.y(Math.floor(this.cursor.y) + 0.5) - 0.5 * size;
    context.lineWidth = 1;
    context.strokeStyle = 'rgba(0,0,0,.8)';
    context.strokeRect(x - 1, y - 1, size + 2, size + 2);
    context.strokeStyle = '#fff';
    context.strokeRect(x, y, size, size);
  }

  #findRecord() {
    this.chosen = -1;
    if (!this.cursor || !this.state.records || !this.loaded) return;
    const {view, x, y} = this.cursor;
    const layer = this.#layer(this.#panelAt(view, x));
    if (layer) this.chosen = layer.find(x, y, this.state.size, 3 / view.toView().scale);
  }

  // What is told.

  #showTip() {
    this.tip.hidden = this.chosen < 0;
    if (this.chosen < 0) return;
    const {view, x, y} = this.cursor;
    const layer = this.#layer(this.#panelAt(view, x));
    const {color, name, reason} = layer.classOf(this.chosen);
    this.tip.dataset.record = this.chosen;
    this.tip.replaceChildren(
        element('p', {className: 'class'}, element('i', {style: `background:${color}`}), name),
        element('p', {className: 'reason'}, reason),
        element('dl', {}, ...layer.describe(this.chosen).flatMap(([key, text]) =>
          [element('dt', {}, key), element('dd', {}, text)])));
    const box = view.picture.getBoundingClientRect(), own = this.node.getBoundingClientRect();
    const to = view.toView();
    const at = {x: box.left - own.left + to.x(x), y: box.top - own.top + to.y(y)};
    const width = this.tip.offsetWidth, height = this.tip.offsetHeight;
    const left = at.x + 18 + width < own.width ? at.x + 18 : at.x - 18 - width;
    const top = Math.min(at.y + 14, own.height - height);
    this.tip.style.transform = `translate(${Math.max(0, left)}px, ${Math.max(0, top)}px)`;
  }

  /** Pixel values under the cursor: of the shown method, and of the reference. */
  #showReadout() {
    if (!this.cursor) {
      this.strip.replaceChildren(element('p', {className: 'hint'},
          'Point at a picture for its values. Wheel or pinch zooms.'));
      return;
    }
    const x = Math.floor(this.cursor.x), y = Math.floor(this.cursor.y);
    const shown = this.#panelAt(this.cursor.view, this.cursor.x);
    const rows = [shown];
    if (this.panels[shown].reference !== undefined) rows.push(this.panels[shown].reference);
    const [picture, reference] = rows.map((panel) => this.#picture(panel));
    const line = (name, values) => element('tr', {}, element('th', {scope: 'row'}, name),
        ...values.map((v) => element('td', {}, readable(v))));
    const body = rows.map((panel, i) => [panel, [picture, reference][i]])
        .filter(([, pixels]) => pixels)
        .map(([panel, pixels]) => line(this.panels[panel].name, pixelOf(pixels, x, y)));
    let error = '';
    if (picture && reference) {
      const value = relativeError(picture, reference, y * this.group.width + x, this.settings.errorOffset);
      error = `relative error ${readable(value)}`;
    }
    this.strip.replaceChildren(
        element('p', {className: 'place'}, element('span', {}, `x ${x}  y ${y}`), element('span', {}, error)),
        element('table', {}, element('tbody', {}, ...body)));
  }

  #showLegend() {
    const parts = [];
    if (this.state.error) {
      const {colors} = this.settings;
      const stops = Array.from({length: 33}, (_, i) => `rgb(${colors.subarray(3 * Math.round(i * 255 / 32)).slice(0, 3).join(',')})`);
      parts.push(element('div', {className: 'bar', role: 'img',
          'aria-label': 'Colours of relative errors from 0.001, dark violet, to 1, yellow, logarithmic'},
          element('span', {className: 'what'}, 'relative error'),
          element('span', {className: 'scale'},
              element('span', {className: 'ramp', style: `background:linear-gradient(90deg,${stops.join(',')})`}),
              element('span', {className: 'ticks'}, ...['0.001', '0.01', '0.1', '1'].map((t) => element('span', {}, t)))),
          element('span', {className: 'key'}, element('i', {style: 'background:#f0f'}), 'not finite')));
    }
    if (this.state.records) {
      parts.push(element('div', {className: 'keys'},
          ...[[kTaylorColor, 'Taylor records'], [kHarmonicsColor, 'spherical harmonics']].map(([color, name]) =>
            element('span', {className: 'key ring'}, element('i', {style: `border-color:${color}`}), name)),
          element('span', {className: 'note'}, this.#recordCount())));
    }
    this.legend.replaceChildren(...parts);
  }

  #recordCount() {
    const {records} = this.panels[this.state.panel];
    return records ? `${records.count} records` : 'no records of this method';
  }
}
