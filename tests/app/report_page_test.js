// SPDX-License-Identifier: GPL-3.0-or-later
// Runs in a page of `vrc report` of two pictures (report_command_test.cpp): works it by events as a reader
// would, and writes what it finds into the document. `expected` and `errors` are there already.

const testLines = [];
(async () => {
  const lines = testLines;
  const check = (name, holds, details = '') =>
    lines.push(holds ? `ok ${name}` : `FAILED ${name}: ${details}`);
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  /** Unpacking takes time that the browser's virtual clock does not count: waits by work of that kind. */
  async function until(condition) {
    for (let i = 0; i < 500 && !condition(); ++i) {
      await inflate('data-0');
      await pause(20);
    }
    return condition();
  }

  const viewer = document.querySelector('.viewer');
  const stages = () => [...viewer.querySelectorAll('.stage')];
  const stage = () => stages()[0];
  const canvas = () => stage().querySelector('.picture');
  const divider = () => stage().querySelector('.divider');
  const key = (name, more = {}, target = document.body) =>
    target.dispatchEvent(new KeyboardEvent('keydown', {key: name, bubbles: true, cancelable: true, ...more}));
  const input = (label) => viewer.querySelector(`#${[...viewer.querySelectorAll('label')]
      .find((node) => node.textContent === label).htmlFor}`);
  function enter(label, value) {
    const field = input(label);
    field.value = value;
    field.dispatchEvent(new Event(field.tagName === 'SELECT' ? 'change' : 'input', {bubbles: true}));
  }

  /** Of a place on a canvas in shares of its size. */
  function colorAt(u, v, node = canvas()) {
    const x = Math.floor(u * node.width), y = Math.floor(v * node.height);
    return [...node.getContext('2d').getImageData(x, y, 1, 1).data];
  }
  const pixelColor = (x, y, node) => colorAt((x + 0.5) / 32, (y + 0.5) / 24, node);
  const near = (color, wanted, tolerance = 1) =>
    color[3] === 255 && wanted.every((w, c) => Math.abs(w - color[c]) <= tolerance);
  function pointer(type, target, u, v, more = {}) {
    const box = canvas().getBoundingClientRect();
    const place = {clientX: box.left + u * box.width, clientY: box.top + v * box.height};
    const Event = type === 'wheel' ? WheelEvent : type === 'dblclick' ? MouseEvent : PointerEvent;
    target.dispatchEvent(new Event(type, {
      pointerId: 1, pointerType: 'mouse', bubbles: true, cancelable: true, ...place, ...more,
    }));
  }
  const label = () => stage().querySelector('.tag.left').textContent;

  viewer.scrollIntoView({block: 'center'});
  check('the picture appears', await until(() => colorAt(0.5, 0.5)[3] === 255));
  await pause(600);
  check('the page is no wider than the window', document.documentElement.scrollWidth <= innerWidth,
        `${document.documentElement.scrollWidth} > ${innerWidth}`);
  const plots = [...document.querySelectorAll('.plot svg')];
  check('the plots have series', plots.length === 3 && plots.every((svg) => svg.querySelector('polyline')));
  for (const svg of plots) {
    const frame = svg.getBoundingClientRect();
    const texts = [...svg.querySelectorAll('text')].map((node) => ({node, box: node.getBoundingClientRect()}));
    const title = texts[0].node.textContent;
    const names = (list) => list.map(({node}) => node.textContent).join(', ');
    const cut = texts.filter(({box}) => box.left < frame.left || box.right > frame.right || box.bottom > frame.bottom);
    check(`no text of the plot ${title} is cut off`, cut.length === 0, names(cut));
    const covered = texts.filter(({box}, i) => texts.some(
        (other, k) => k < i && box.left < other.box.right && other.box.left < box.right &&
            box.top < other.box.bottom && other.box.top < box.bottom));
    check(`no text of the plot ${title} covers another`, covered.length === 0, names(covered));
    const small = texts.filter(({node}) => node.getAttribute('font-size') * frame.width / svg.viewBox.baseVal.width < 9.5);
    check(`all texts of the plot ${title} can be read`, small.length === 0, names(small));
  }
  check('controls have names', [...document.querySelectorAll('button, input, select, canvas.picture, [role=slider]')]
      .every((node) => node.textContent.trim() || node.labels?.length || node.getAttribute('aria-label')));

  // Exposure and tone curves are the program's.
  for (const method of ['cache', 'path']) {
    key(method === 'cache' ? '1' : '2');
    check(`a key shows ${method}`, label().toLowerCase().startsWith(method), label());
    await until(() => colorAt(0.5, 0.5)[3] === 255);
    for (const pixel of expected.pixels) {
      for (const shown of pixel.shown) {
        enter('Exposure', shown.exposure);
        enter('Tone', shown.tone);
        const color = pixelColor(pixel.x, pixel.y);
        if (!near(color, shown[method]))
          check(`${method} ${pixel.x},${pixel.y} ${shown.tone} ${shown.exposure}`, false, `${color} is not ${shown[method]}`);
      }
    }
    check(`pixels of ${method}`, true);
  }
  key('0');
  const {exposure} = JSON.parse(document.getElementById('manifest').textContent).figures[0].groups[0];
  check('0 takes the exposure back', Number(input('Exposure').value) === exposure, input('Exposure').value);
  enter('Exposure', 0);
  enter('Tone', 'none');
  key('ArrowLeft');
  check('arrows step', label() === 'Cache', label());
  key('x');
  check('x goes back', label().startsWith('Path'), label());
  key('1');

  // Zoom.
  const before = pixelColor(9, 14);
  for (let i = 0; i < 30; ++i) pointer('wheel', canvas(), 9.5 / 32, 14.5 / 24, {deltaY: -100});
  check('the wheel zooms about the pointer', near(colorAt(9.5 / 32, 14.5 / 24), before.slice(0, 3), 0));
  const spot = [9.5 / 32, 14.5 / 24];
  check('enlarged pixels are crisp',
        [0.05, -0.05].every((d) => near(colorAt(spot[0] + d, spot[1] - d), before.slice(0, 3), 0)));
  pointer('pointerdown', canvas(), 0.5, 0.5);
  pointer('pointermove', canvas(), 0.9, 0.5);
  pointer('pointerup', canvas(), 0.9, 0.5);
  check('dragging moves', stage().classList.contains('zoomed') &&
        near(colorAt(spot[0] + 0.4, spot[1]), before.slice(0, 3), 0));
  pointer('dblclick', canvas(), 0.5, 0.5);
  check('a double click resets', !stage().classList.contains('zoomed') && near(pixelColor(9, 14), before.slice(0, 3), 0));

  // Two fingers, and two taps.
  const touch = {pointerType: 'touch', pointerId: 11}, second = {pointerType: 'touch', pointerId: 12};
  pointer('pointerdown', canvas(), 0.4, 0.5, touch);
  pointer('pointerdown', canvas(), 0.6, 0.5, second);
  pointer('pointermove', canvas(), 0.6, 0.5, second);
  pointer('pointermove', canvas(), 0.3, 0.5, touch);
  pointer('pointermove', canvas(), 0.7, 0.5, second);
  for (const finger of [touch, second]) pointer('pointerup', canvas(), 0.5, 0.5, finger);
  check('pinching zooms', stage().classList.contains('zoomed'));
  for (let tap = 0; tap < 2; ++tap) {
    pointer('pointerdown', canvas(), 0.5, 0.5, touch);
    pointer('pointerup', canvas(), 0.5, 0.5, touch);
  }
  check('two taps reset', !stage().classList.contains('zoomed'));
  check('a mouse that was pressed and released does not drag', (() => {
    pointer('pointerdown', canvas(), 0.5, 0.5);
    pointer('pointerup', canvas(), 0.5, 0.5);
    pointer('wheel', canvas(), 0.5, 0.5, {deltaY: -200});
    const color = String(colorAt(0.5, 0.5));
    pointer('pointermove', canvas(), 0.8, 0.8);
    const stays = String(colorAt(0.5, 0.5)) === color;
    pointer('dblclick', canvas(), 0.5, 0.5);
    return stays;
  })());

  // Values under the pointer.
  pointer('pointermove', canvas(), 2.5 / 32, 3.5 / 24);
  const strip = viewer.querySelector('.strip');
  check('values are read', strip.textContent.includes('x 2  y 3') && strip.textContent.includes('NaN') &&
        strip.querySelectorAll('tr').length === 2, strip.textContent);

  // Errors in the colours of vrc compare.
  key('e');
  for (const pixel of expected.pixels) {
    const color = pixelColor(pixel.x, pixel.y);
    check(`error at ${pixel.x},${pixel.y}`, near(color, pixel.error, 3), `${color} is not ${pixel.error}`);
  }
  check('the colours are explained', viewer.querySelector('.legend').textContent.includes('not finite'));
  key('e');

  // Split, and its divider by pointer and by key.
  key('s');
  const wanted = expected.pixels.find((pixel) => pixel.x === 16).shown[0];
  pointer('pointerdown', divider(), 0.5, 0.5);
  pointer('pointermove', divider(), 0.75, 0.5);
  pointer('pointerup', divider(), 0.75, 0.5);
  check('the divider follows', divider().style.left.startsWith('75') && near(pixelColor(16, 12), wanted.cache),
        divider().style.left);
  pointer('pointerdown', divider(), 0.75, 0.5);
  pointer('pointermove', divider(), 0.25, 0.5);
  pointer('pointerup', divider(), 0.25, 0.5);
  check('the other method is behind it', near(pixelColor(16, 12), wanted.path), pixelColor(16, 12));
  key('ArrowRight', {}, divider());
  check('keys move it', divider().getAttribute('aria-valuenow') === '27', divider().getAttribute('aria-valuenow'));
  check('both are named', !stage().querySelector('.tag.right').hidden);
  key('o');
  check('one picture again', divider().hidden);

  // All at once, moving together.
  key('a');
  check('all are shown', stages().length === 2);
  await until(() => stages().every((node) => colorAt(0.5, 0.5, node.querySelector('.picture'))[3] === 255));
  pointer('wheel', canvas(), 0.5, 0.5, {deltaY: -100});
  check('views are linked', stages().every((node) => node.classList.contains('zoomed')));
  key('0');
  enter('Exposure', 0);
  key('a');

  // Records.
  key('r');
  const {records} = JSON.parse(document.getElementById('manifest').textContent).figures[0].groups[0].panels[0];
  const columns = await unpackColumns(records);
  const marks = () => stage().querySelector('.records');
  const drawn = () => {
    const {data} = marks().getContext('2d').getImageData(0, 0, marks().width, marks().height);
    return data.reduce((sum, value, i) => sum + (i % 4 === 3 && value > 0 ? 1 : 0), 0);
  };
  check('records are drawn', await until(() => drawn() > 200), drawn());
  const inside = [...columns.px.keys()].filter((i) =>
    columns.px[i] > 1 && columns.px[i] < 31 && columns.py[i] > 1 && columns.py[i] < 23);
  const tip = viewer.querySelector('.tip');
  let right = 0;
  for (const i of inside) {
    pointer('pointermove', canvas(), columns.px[i] / 32, columns.py[i] / 24);
    if (!tip.hidden && tip.dataset.record === String(i) && tip.textContent.includes(readable(columns.r1[i]))) ++right;
  }
  check('each record is found at its place', inside.length > 10 && right === inside.length, `${right} of ${inside.length}`);
  check('the tip says what it holds', /Taylor.*flat surface.*radii.*noise.*gradient.*rays/.test(tip.textContent), tip.textContent);
  key('r');
  check('records go', await until(() => drawn() === 0), drawn());

  key('?');
  check('? explains the keys', document.getElementById('help').open);
  document.getElementById('help').close();
  check('no errors', errors.length === 0, errors.join('; '));
  lines.push('ok finished');
})().catch((error) => error).then((error) => {
  const text = (error ? [...testLines, `FAILED by ${error.stack}`] : testLines).join('\n');
  if (parent !== window) return parent.postMessage(text, '*');
  const pre = document.createElement('pre');
  pre.id = 'results';
  pre.textContent = text;
  document.body.append(pre);
});
