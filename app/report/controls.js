// SPDX-License-Identifier: GPL-3.0-or-later
// Small building blocks of the user interface.

/** An element with properties, attributes ("aria-..." and the like) and children. */
function element(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes('-') || name === 'role' || name === 'for') node.setAttribute(name, value);
    else node[name] = value;
  }
  node.append(...children);
  return node;
}

let namesGiven = 0;
const newName = (word) => `${word}-${++namesGiven}`;

/** Buttons of which one is chosen: `choices` are [value, text, title]; `show(value)` marks one. */
function choiceButtons(label, choices, onChoose) {
  const buttons = new Map(choices.map(([value, text, title]) => [value, element('button', {
    type: 'button', className: 'choice', title: title ?? '', 'aria-pressed': 'false',
    onclick: () => onChoose(value),
  }, text)]));
  const node = element('div', {className: 'choices', role: 'group', 'aria-label': label}, ...buttons.values());
  return {
    node,
    buttons,
    show(chosen) {
      for (const [value, button] of buttons) button.setAttribute('aria-pressed', String(value === chosen));
    },
  };
}

/** A labelled slider; `text(value)` is what stands beside it, a double click brings `rest` back. */
function slider(label, {low, high, step, rest, text}, onChange) {
  const id = newName('slider');
  const output = element('output', {'for': id});
  const input = element('input', {
    type: 'range', id, min: low, max: high, step,
    oninput: () => onChange(Number(input.value)),
    ondblclick: () => onChange(rest),
  });
  const node = element('div', {className: 'slider'}, element('label', {'for': id}, label), input, output);
  return {
    node,
    show(value) {
      input.value = value;
      output.textContent = text(value);
      input.setAttribute('aria-valuetext', output.textContent);
    },
  };
}

/** A labelled list of which one is chosen: `choices` are [value, text]. */
function selection(label, choices, onChange) {
  const id = newName('select');
  const select = element('select', {id, onchange: () => onChange(select.value)},
                         ...choices.map(([value, text]) => element('option', {value}, text)));
  const node = element('div', {className: 'selection'}, element('label', {'for': id}, label), select);
  return {node, show(value) { select.value = value; }};
}
