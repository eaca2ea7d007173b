// Helpers that create and fill elements.

/**
 * Creates an element.
 * @param {string} tag name and classes, separated by dots: "button.primary"
 * @param {Record<string, any>} [props] names on* are listeners; others are properties if the element has them, otherwise attributes
 * @param {...(Node|string|null|undefined|false)} children
 * @returns {any} the element
 */
export function h(tag, props = {}, ...children) {
  const [name, ...classes] = tag.split('.');
  const element = document.createElement(name);
  if (classes.length) element.className = classes.join(' ');
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith('on')) element.addEventListener(key.slice(2).toLowerCase(), value);
    else if (key === 'style') element.setAttribute('style', value);
    else if (key in element && key !== 'list') /** @type {any} */ (element)[key] = value;
    else element.setAttribute(key, value === true ? '' : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== false).map((child) => /** @type {Node|string} */ (child)));
  return element;
}

/**
 * Replaces an element's children. If the focus was inside, it stays on its element, or goes to one of the same name, or to the first that can have it.
 * @param {Element} element @param {...(Node|string|null|false|undefined)} children
 */
export function fill(element, ...children) {
  const focused = /** @type {HTMLElement|null} */ (document.activeElement);
  const held = focused !== null && focused !== element && element.contains(focused);
  element.replaceChildren(...children.filter((child) => child).map((child) => /** @type {Node|string} */ (child)));
  if (!held) return;
  const others = /** @type {HTMLElement[]} */ ([...element.querySelectorAll('a[href], button, input, select, textarea, [tabindex], [contenteditable]')]);
  const next = element.contains(focused) ? focused : others.find((other) => nameOf(other) === nameOf(focused)) ?? others[0];
  next?.focus({ preventScroll: true });
}

/** @param {HTMLElement} element */
function nameOf(element) {
  return `${element.tagName} ${element.id || element.getAttribute('aria-label') || element.textContent}`;
}

/**
 * Creates a button that shows an icon. Screen readers get its label.
 * @param {string} symbol @param {string} label @param {() => void} action @param {Record<string, any>} [props]
 */
export function iconButton(symbol, label, action, props = {}) {
  return h('button.icon', { type: 'button', title: label, 'aria-label': label, onclick: action, ...props }, icon(symbol));
}

const SVG = 'http://www.w3.org/2000/svg';
/** Stroked paths on a grid of 16 x 16. @type {Record<string, string>} */
const SYMBOLS = {
  orbit: 'M8 3.5a4.5 4.5 0 1 1-4.2 2.9M3.2 3v3.6h3.6',
  part: 'M3 2.5 13 7.2 8.6 8.8 7 13.2z',
  brush: 'M13.5 2.5 7 9M6.8 8.6c-1.9-.3-3 .9-3.1 2.5-.1 1-.6 1.6-1.4 1.9 2.6.9 5.6.2 5.8-2.3.1-.9-.4-1.8-1.3-2.1z',
  box: 'm8 1.8 5.5 3v6.4L8 14.2l-5.5-3V4.8zM2.5 4.8 8 7.8l5.5-3M8 7.8v6.4',
  words: 'M3 4V3h10v1M8 3v10M6 13h4',
  color: 'M8 2s4.3 4.6 4.3 7.4A4.3 4.3 0 0 1 8 13.7a4.3 4.3 0 0 1-4.3-4.3C3.7 6.6 8 2 8 2z',
  single: 'M2.5 3h11v10h-11z',
  wipe: 'M2.5 3h11v10h-11zM8 1.500v13M5 6.5 3.8 8 5 9.500M11 6.5 12.2 8 11 9.5',
  side: 'M2.5 3h11v10h-11zM8 3v10',
  wire: 'M2.5 3h11v10h-11zM2.5 8h11M8 3v10M2.5 13 13.5 3',
  turn: 'M13.5 8c0 1.4-2.5 2.5-5.5 2.500S2.5 9.4 2.5 8 5 5.5 8 5.500M8 3.200v4.600L5.4 5.500z',
  frame: 'M2.5 5.500v-3h3M10.5 2.500h3v3M13.5 10.500v3h-3M5.5 13.500h-3v-3',
  sun: 'M8 5.200a2.8 2.8 0 1 1 0 5.6 2.8 2.8 0 0 1 0-5.600zM8 1v1.800M8 13.200V15M1 8h1.800M13.2 8H15M3 3l1.3 1.300M11.7 11.7 13 13M13 3l-1.3 1.300M4.3 11.7 3 13',
  star: 'm8 2 1.8 3.8 4.2.6-3 2.9.7 4.200L8 11.500l-3.7 2 .7-4.2-3-2.9 4.2-.6z',
  play: 'M5 3.200v9.600l7.5-4.800z',
  pause: 'M5.5 3v10M10.5 3v10',
  stop: 'M4 4h8v8H4z',
  close: 'm4 4 8 8M12 4l-8 8',
  plus: 'M8 3v10M3 8h10',
  minus: 'M3 8h10',
  copy: 'M5.5 5.500v-3h8v8h-3M2.5 5.500h8v8h-8z',
  down: 'M8 2.500v8M4.5 7.5 8 11l3.5-3.500M3 13.500h10',
  open: 'M2 12.500v-9h4l1.5 2H14v7z',
  camera: 'M2 5h3l1-1.500h4L11 5h3v8H2zM8 6.800a2.2 2.2 0 1 1 0 4.4 2.2 2.2 0 0 1 0-4.400z',
  undo: 'M6 3.5 3 6.500l3 3M3 6.500h6.500a3.5 3.5 0 0 1 0 7H7',
  redo: 'm10 3.5 3 3-3 3M13 6.500H6.500a3.5 3.5 0 0 0 0 7H9',
  pen: 'M3 13l.6-2.800 7-7 2.200 2.200-7 7zM9.200 4.600l2.200 2.200',
  trash: 'M3 4.500h10M6.5 4.500v-2h3v2M4.5 4.500l.6 9h5.800l.6-9',
  more: 'M3.5 8h.01M8 8h.01M12.5 8h.01',
  theme: 'M8 2a6 6 0 1 0 0 12zM8 2a6 6 0 0 1 0 12',
  help: 'M6 6a2 2 0 1 1 2.8 1.900c-.5.2-.8.6-.8 1.100v.5M8 12h.01',
  folder: 'M2 12.500v-9h4l1.5 2H14v7z',
  retry: 'M13 8a5 5 0 1 1-1.5-3.500M13 2v3h-3',
  chevron: 'm4.5 6.5 3.5 3.5 3.5-3.5',
  eye: 'M1.5 8C3 5.2 5.300 3.800 8 3.800s5 1.400 6.500 4.200c-1.500 2.800-3.800 4.200-6.500 4.200S3 10.800 1.500 8zM8 6.100a1.900 1.900 0 1 1 0 3.800 1.900 1.900 0 0 1 0-3.800z',
  check: 'm3 8.5 3.2 3L13 4.5',
  warning: 'M8 2.5 14.5 13.500h-13zM8 6.500v3.500M8 11.800h.01',
};

/** @param {string} name */
export function icon(name) {
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(SVG, 'path');
  path.setAttribute('d', SYMBOLS[name] ?? '');
  svg.append(path);
  return svg;
}

/**
 * Creates a slider with its name and value. A double click restores the first value.
 * @param {{label: string, minimum: number, maximum: number, step: number, value: number, shown: (value: number) => string, change: (value: number) => void, settled?: (value: number) => void}} options
 */
export function slider({ label, minimum, maximum, step, value, shown, change, settled }) {
  const first = value;
  const output = h('output', {}, shown(value));
  const paint = (/** @type {number} */ v) => input.style.setProperty('--part', `${100 * (v - minimum) / (maximum - minimum)}%`);
  const input = h('input', { type: 'range', min: minimum, max: maximum, step, 'aria-label': label,
    oninput: () => update(Number(input.value)), onchange: () => settled?.(Number(input.value)),
    ondblclick: () => { element.set(first); change(first); settled?.(first); } });
  input.value = value;
  const update = (/** @type {number} */ v) => {
    output.textContent = shown(v);
    paint(v);
    change(v);
  };
  const element = h('label.slider', {}, h('span', {}, label), input, output);
  element.set = (/** @type {number} */ v) => {
    input.value = String(v);
    output.textContent = shown(v);
    paint(v);
  };
  paint(value);
  return element;
}

/**
 * Creates a row of buttons, one of which is chosen.
 * @param {string} label @param {{value: string, label: string, icon?: string}[]} choices @param {string} value @param {(value: string) => void} change
 */
export function segments(label, choices, value, change) {
  const buttons = choices.map((choice) => h('button', { type: 'button', title: choice.label, 'aria-label': choice.label, 'data-value': choice.value,
    onclick: () => { element.set(choice.value); change(choice.value); } }, choice.icon ? icon(choice.icon) : choice.label));
  const element = h('div.segments', { role: 'group', 'aria-label': label }, ...buttons);
  element.set = (/** @type {string} */ chosen) => {
    for (const button of buttons) button.setAttribute('aria-pressed', String(button.dataset.value === chosen));
  };
  element.set(value);
  return element;
}

/**
 * Makes a group of buttons a single stop of the Tab key. Arrow keys move between the buttons.
 * @param {HTMLElement} group @param {(button: HTMLElement) => void} [reached]
 */
export function oneStop(group, reached) {
  const buttons = /** @type {HTMLElement[]} */ ([...group.children]);
  buttons.forEach((button, i) => { button.tabIndex = i ? -1 : 0; });
  group.onkeydown = (event) => {
    const at = buttons.indexOf(/** @type {HTMLElement} */ (event.target));
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1, Home: -at, End: -at - 1 }[event.key];
    if (at < 0 || step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const next = buttons[(at + step + buttons.length) % buttons.length];
    buttons[at].tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
    reached?.(next);
  };
}

/** @param {string} text */
export async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch { // the page is not in a secure context, as with --host or an ssh tunnel to another name
    const area = h('textarea', { value: text, style: 'position:fixed;opacity:0' });
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

/** @param {string} url @param {string} name */
export function download(url, name) {
  const link = h('a', { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}
