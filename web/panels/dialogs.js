// Temporary elements: messages, questions, and the list of keys.
import { h, icon } from '../core/dom.js';
import { text } from '../text.js';

const toasts = h('div.toasts', { role: 'status', 'aria-live': 'polite' });
document.body.append(toasts);
/** Functions that remove the messages of errors. @type {Set<() => void>} */
const errors = new Set();

/** Shows a message. @param {string} said @param {{bad?: boolean, hint?: string, stays?: boolean}} [options] @returns {() => void} a function that removes the message */
export function toast(said, { bad = false, hint = '', stays = false } = {}) {
  const close = () => element.remove();
  const element = h('div.toast', { className: bad ? 'toast bad' : 'toast' }, bad ? icon('warning') : null, h('div', {}, said, hint && h('small', {}, hint)),
    h('button.icon', { type: 'button', 'aria-label': text.close, onclick: close }, icon('close')));
  toasts.append(element);
  if (!stays) setTimeout(close, bad ? 12000 : 3500);
  return close;
}

/** Shows the message of an error. @param {any} error @returns {() => void} a function that removes the message */
export function failed(error) {
  if (error?.name === 'AbortError') return () => {};
  const close = toast(error?.message ?? String(error), { bad: true, hint: error?.hint });
  errors.add(close);
  return close;
}

/** Removes the messages of earlier errors, because an action succeeded. */
export function succeeded() {
  for (const close of errors) close();
  errors.clear();
}

export function keysDialog() {
  const dialog = h('dialog.keys', { 'aria-label': text.keys.title, onclose: () => dialog.remove() },
    h('header', {}, h('h1', {}, text.keys.title), h('button.icon', { type: 'button', 'aria-label': text.close, onclick: () => dialog.close() }, icon('close'))),
    h('dl', {}, ...text.keys.list.flatMap(([keys, what]) => [h('dt', {}, ...keys.split(', ').map((one) => h('kbd', {}, one))), h('dd', {}, what)])));
  document.body.append(dialog);
  dialog.showModal();
}

/**
 * Asks before something is deleted. The dialog begins with the focus on "Cancel".
 * @param {string} title @param {string[]} said sentences @param {string} label of the button that deletes @param {() => void} action
 */
export function confirmDialog(title, said, label, action) {
  const dialog = h('dialog.confirm', { role: 'alertdialog', 'aria-label': title, onclose: () => dialog.remove() },
    h('h1', {}, title), ...said.map((sentence) => h('p', {}, sentence)),
    h('footer', {}, h('span.spring'), h('button', { type: 'button', autofocus: true, onclick: () => dialog.close() }, text.cancel),
      h('button.danger', { type: 'button', onclick: () => { dialog.close(); action(); } }, icon('trash'), label)));
  document.body.append(dialog);
  dialog.showModal();
}

/**
 * Asks for a name.
 * @param {string} title @param {string} label of the field @param {string} value the present name @param {string} save label of the button @param {(name: string) => void} action
 */
export function nameDialog(title, label, value, save, action) {
  const input = h('input', { type: 'text', value, maxLength: 120, 'aria-label': label, autofocus: true });
  const done = () => {
    const name = input.value.trim();
    dialog.close();
    if (name && name !== value) action(name);
  };
  const dialog = h('dialog.confirm', { 'aria-label': title, onclose: () => dialog.remove() },
    h('form', { onsubmit: (/** @type {Event} */ event) => { event.preventDefault(); done(); } }, h('h1', {}, title), input,
      h('footer', {}, h('span.spring'), h('button', { type: 'button', onclick: () => dialog.close() }, text.cancel), h('button.primary', { type: 'submit' }, save))));
  document.body.append(dialog);
  dialog.showModal();
  input.select();
}
