// Temporary elements: messages, the list of projects, and the list of keys.
import { h, fill, icon } from '../core/dom.js';
import { api } from '../core/api.js';
import { when } from '../core/format.js';
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
 * Creates the button that opens the list of projects.
 * @param {import('../core/store.js').Store} store
 * @param {{open: (id: string) => void, upload: () => void, photographs: () => void, demo: () => void}} actions
 */
export function projectMenu(store, actions) {
  const name = h('span');
  const menu = h('div.popover.projects', { id: 'projects', hidden: true });
  const button = h('button.project', { type: 'button', 'aria-haspopup': 'true', 'aria-controls': 'projects', onclick: () => toggle() }, name, icon('chevron'));
  const element = h('div.anchor', {}, button, menu);
  const close = () => { menu.hidden = true; };
  const item = (/** @type {string} */ symbol, /** @type {string} */ label, /** @type {() => void} */ action) =>
    h('button.item', { type: 'button', onclick: () => { close(); action(); } }, icon(symbol), label);
  const toggle = async () => {
    menu.hidden = !menu.hidden;
    if (menu.hidden) return;
    const list = h('div.list', {}, h('p.hint', {}, text.loading));
    fill(menu, item('open', text.open, actions.upload), item('camera', text.photographs, actions.photographs),
      item('box', text.openDemo, actions.demo), h('h3', {}, text.projects), list);
    const projects = await api('projects?limit=100').catch(failed) ?? [];
    fill(list, ...projects.map((/** @type {any} */ project) => h('button.item', { type: 'button', 'aria-current': String(String(project.id) === store.state.project?.id), onclick: () => { close(); actions.open(String(project.id)); } },
      h('span', {}, project.name), h('small', {}, `${text.history.count(project.results)} · ${when(project.modified)}`))), !projects.length && h('p.hint', {}, text.noProjects));
  };
  document.addEventListener('pointerdown', (event) => { if (!element.contains(/** @type {Node} */ (event.target))) close(); });
  element.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Escape') { close(); button.focus(); } });
  store.on(['project'], ({ project }) => fill(name, project?.name ?? text.open));
  return element;
}
