// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the viewers, loads what comes near the window and sends keys to the right one.

(() => {
  const manifest = JSON.parse(document.getElementById('manifest').textContent);
  const settings = {colors: parseColorMap(manifest.colorMap), errorOffset: manifest.errorOffset};
  const help = document.getElementById('help');
  const viewers = new Map();

  for (const node of document.querySelectorAll('.viewer')) {
    const [figure, group] = node.dataset.group.split('.').map(Number);
    viewers.set(node, new Viewer(node, manifest.figures[figure].groups[group], settings));
  }

  const near = new IntersectionObserver((entries) => {
    for (const {target, isIntersecting} of entries) {
      if (isIntersecting) viewers.get(target).load();
    }
  }, {rootMargin: '300px 0px'});
  const far = new IntersectionObserver((entries) => {
    for (const {target, isIntersecting} of entries) {
      if (!isIntersecting) viewers.get(target).unload();
    }
  }, {rootMargin: '3000px 0px'});
  for (const node of viewers.keys()) {
    near.observe(node);
    far.observe(node);
  }

  let pointed = null;
  for (const node of viewers.keys()) {
    for (const event of ['pointerenter', 'pointerdown', 'focusin'])
      node.addEventListener(event, () => activate(node));
  }
  let marked = null;
  function mark(node) {
    if (node === marked) return;
    marked?.classList.remove('active');
    marked = node;
    marked?.classList.add('active');
  }
  function activate(node) {
    pointed = node;
    mark(node);
  }

  /** Distance of an element from the middle of the window, 0 when it is there. */
  function distance(node) {
    const box = node.getBoundingClientRect();
    const middle = 0.5 * innerHeight;
    return Math.max(box.top - middle, middle - box.bottom, 0);
  }
  const nearest = (nodes) =>
    [...nodes].reduce((best, node) => (best && distance(best) <= distance(node) ? best : node), null);
  function activeNode() {
    const inWindow = (node) => {
      const box = node.getBoundingClientRect();
      return box.bottom > 0 && box.top < innerHeight;
    };
    return pointed && inWindow(pointed) ? pointed : nearest(viewers.keys());
  }
  addEventListener('scroll', () => {
    if (pointed && !pointed.matches(':hover, :focus-within')) pointed = null;
    mark(activeNode());
  }, {passive: true});
  mark(activeNode());

  function stepFigure(by) {
    const figures = [...document.querySelectorAll('section.figure')];
    const at = figures.indexOf(nearest(figures));
    const next = figures[Math.min(Math.max(at + by, 0), figures.length - 1)];
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    next.scrollIntoView({behavior: calm ? 'auto' : 'smooth', block: 'start'});
    next.focus({preventScroll: true});
    pointed = null;
  }

  const tones = Object.keys(toneNames);
  const actions = {
    ArrowLeft: (v) => v.step(-1),
    ArrowRight: (v) => v.step(1),
    x: (v) => v.back(),
    o: (v) => v.set({layout: 'one'}),
    s: (v) => v.set({layout: v.state.layout === 'split' ? 'one' : 'split'}),
    a: (v) => v.set({layout: v.state.layout === 'all' ? 'one' : 'all'}),
    e: (v) => v.set({error: !v.state.error && v.hasErrors}),
    r: (v) => v.set({records: !v.state.records && v.hasRecords}),
    t: (v) => v.set({tone: tones[(tones.indexOf(v.state.tone) + 1) % tones.length]}),
    '+': (v) => v.set({exposure: Math.min(v.state.exposure + 0.5, 8)}),
    '=': (v) => v.set({exposure: Math.min(v.state.exposure + 0.5, 8)}),
    '-': (v) => v.set({exposure: Math.max(v.state.exposure - 0.5, -8)}),
    0: (v) => {
      v.placement.reset();
      v.set({exposure: v.group.exposure});
    },
  };
  for (let digit = 1; digit <= 9; ++digit) actions[digit] = (v) => v.choose(digit - 1);

  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    const {key, target} = event;
    if (key === '?') return help.showModal();
    if (event.shiftKey && (key === 'ArrowUp' || key === 'ArrowDown')) {
      event.preventDefault();
      return stepFigure(key === 'ArrowUp' ? -1 : 1);
    }
    // Sliders, lists and tables that scroll use the arrows themselves; lists also letters.
    if (target.matches?.('select')) return;
    if (key.startsWith('Arrow') && target.matches?.('input, .scroll')) return;
    const act = actions[key.length === 1 ? key.toLowerCase() : key];
    const node = activeNode();
    if (!act || !node) return;
    event.preventDefault();
    act(viewers.get(node));
  });
  document.getElementById('help-button').addEventListener('click', () => help.showModal());
})();
