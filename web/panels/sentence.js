// Field for a sentence. It offers words that the prior knows, and lists unknown words below.
import { h, fill, icon } from '../core/dom.js';
import { text } from '../text.js';

/** Function words, which every prior knows. */
const GLUE = 'a an the of in on at with and to by from made that has under over its it is'.split(' ');

export class Vocabulary {
  /** @param {import('../core/types.js').About['words']} words */
  constructor(words) {
    /** @type {Map<string, string>} kind of each word */
    this.kinds = new Map();
    for (const word of words.all ?? []) this.kinds.set(word, '');
    for (const kind of /** @type {const} */ (['lights', 'objects', 'patterns', 'materials', 'colors']))
      for (const { spellings } of words[kind] ?? []) for (const spelling of spellings) this.kinds.set(spelling, kind);
    this.single = new Set([...GLUE, ...[...this.kinds.keys()].flatMap((phrase) => phrase.split(/[\s-]+/))]);
    this.list = [...this.kinds.keys()].sort();
  }

  /** Returns the words of a sentence that the prior does not know. @param {string} sentence @returns {string[]} */
  unknown(sentence) {
    const words = sentence.toLowerCase().match(/[\p{L}\p{N}']+/gu) ?? [];
    return [...new Set(words.filter((word) => !this.single.has(word) && !(word.endsWith('s') && this.single.has(word.slice(0, -1)))))];
  }

  /** Returns objects, looks and lights; other words of captions, such as "render", describe no model. @param {string} begin @returns {string[]} */
  completions(begin) {
    const wanted = begin.toLowerCase();
    return this.list.filter((word) => this.kinds.get(word) && word.startsWith(wanted) && word !== wanted).slice(0, 8);
  }

  /** Returns the known word with the most similar spelling. It has the same first letter, and at most two differences, one in three letters. @param {string} word */
  nearest(word) {
    let best = '', least = Math.min(2, Math.floor(word.length / 3)) + 1;
    for (const known of this.single) {
      if (Math.abs(known.length - word.length) >= least || known.length < 3 || known[0] !== word[0]) continue;
      const distance = editDistance(word, known);
      if (distance < least) [best, least] = [known, distance];
    }
    return best;
  }
}

/** Returns the number of letters to insert, delete or replace, or of adjacent pairs to swap. @param {string} a @param {string} b */
function editDistance(a, b) {
  let above = [0], row = Array.from({ length: b.length + 1 }, (_, i) => i);
  for (let i = 1; i <= a.length; ++i) {
    const next = [i];
    for (let j = 1; j <= b.length; ++j) {
      next[j] = Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + Number(a[i - 1] !== b[j - 1]));
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1]) next[j] = Math.min(next[j], above[j - 2] + 1);
    }
    [above, row] = [row, next];
  }
  return row[b.length];
}

let count = 0;

/**
 * @param {{label: string, placeholder: string, vocabulary: () => Vocabulary|null, change: (value: string) => void, submit: () => void}} options
 */
export function sentenceField({ label, placeholder, vocabulary, change, submit }) {
  const id = `sentence${++count}`;
  let chosen = -1;
  const list = h('ul.completions', { role: 'listbox', id: `${id}-list`, hidden: true });
  const warning = h('div.unknown', { 'aria-live': 'polite' });
  const input = h('textarea', { id, rows: 1, placeholder, spellcheck: false, role: 'combobox', 'aria-autocomplete': 'list', 'aria-expanded': 'false', 'aria-controls': `${id}-list`, maxLength: 300, autocomplete: 'off' });

  const word = () => {
    const before = input.value.slice(0, input.selectionStart);
    const begin = before.match(/[\p{L}]*$/u)?.[0] ?? '';
    return { begin, at: input.selectionStart - begin.length };
  };
  const close = () => {
    if (list.hidden) return;
    list.hidden = true;
    chosen = -1;
    input.setAttribute('aria-expanded', 'false');
    input.removeAttribute('aria-activedescendant');
    warn();
  };
  const take = (/** @type {string} */ completion) => {
    const { begin, at } = word();
    input.setRangeText(completion, at, at + begin.length, 'end');
    close();
    changed();
    input.focus();
  };
  const mark = () => {
    [...list.children].forEach((item, i) => item.setAttribute('aria-selected', String(i === chosen)));
    if (chosen >= 0) input.setAttribute('aria-activedescendant', `${id}-${chosen}`);
  };
  const suggest = () => {
    const { begin } = word();
    const words = begin.length ? vocabulary()?.completions(begin) ?? [] : [];
    fill(list, ...words.map((completion, i) => h('li', { role: 'option', id: `${id}-${i}`, onmousedown: (/** @type {Event} */ event) => { event.preventDefault(); take(completion); } },
      h('span', {}, h('b', {}, completion.slice(0, begin.length)), completion.slice(begin.length)), h('small', {}, text.edit.kinds[/** @type {keyof typeof text.edit.kinds} */ (vocabulary()?.kinds.get(completion))]))));
    list.hidden = !words.length;
    input.setAttribute('aria-expanded', String(words.length > 0));
    chosen = -1;
  };
  const grow = () => {
    input.style.height = 'auto';
    input.style.height = `${input.scrollHeight}px`;
  };
  const warn = () => {
    const begun = list.hidden ? '' : word().begin.toLowerCase(); // a word that can still be completed is not unknown yet
    const unknown = (vocabulary()?.unknown(input.value) ?? []).filter((one) => one !== begun);
    if (!unknown.length) return fill(warning);
    const nearest = unknown.map((one) => [one, vocabulary()?.nearest(one)]).find(([, near]) => near);
    fill(warning, icon('warning'), h('div', {}, h('span', { title: text.edit.unknownHint }, text.edit.unknown(unknown), ' '),
      nearest && h('button.link', { type: 'button', onclick: () => {
        input.value = input.value.replace(new RegExp(`\\b${nearest[0]}\\b`, 'i'), nearest[1]);
        changed();
      } }, text.edit.nearest(/** @type {string} */ (nearest[1])))));
  };
  const changed = () => {
    grow();
    warn();
    change(input.value);
  };

  input.addEventListener('input', () => {
    input.value = input.value.replace(/\n/g, ' ');
    suggest();
    changed();
  });
  input.addEventListener('blur', close);
  input.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    if (event.key === 'Enter') {
      event.preventDefault();
      if (event.ctrlKey || event.metaKey) submit();
      else if (chosen >= 0) take(/** @type {HTMLElement} */ (list.children[chosen].firstChild).textContent ?? '');
      return;
    }
    if (list.hidden) return;
    const n = list.children.length;
    if (event.key === 'ArrowDown') chosen = (chosen + 1) % n;
    else if (event.key === 'ArrowUp') chosen = (chosen + n - 1) % n;
    else if (event.key === 'Tab' && !event.shiftKey && word().begin.length > 1) {
      take(/** @type {HTMLElement} */ (list.children[Math.max(chosen, 0)].firstChild).textContent ?? '');
      event.preventDefault();
      return;
    } else if (event.key === 'Escape') {
      close();
      event.stopPropagation();
      return;
    } else return;
    event.preventDefault();
    mark();
  });

  const element = h('div.sentence', {}, h('label', { htmlFor: id }, label), h('div.anchor', {}, input, list), warning);
  element.set = (/** @type {string} */ value) => {
    if (input.value !== value) input.value = value;
    requestAnimationFrame(grow);
    warn();
  };
  element.input = input;
  return element;
}
