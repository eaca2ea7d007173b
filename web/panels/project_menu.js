// The menu of projects: those used last come first. Each can be opened, renamed and deleted.
import { h, fill, icon, iconButton } from '../core/dom.js';
import { api } from '../core/api.js';
import { when } from '../core/format.js';
import { confirmDialog, failed, nameDialog } from './dialogs.js';
import { text } from '../text.js';

/** @typedef {{id: string, name: string, results: number, modified: string}} Listed */

/** Returns the projects, those whose results changed last first. @returns {Promise<Listed[]>} */
export async function recentProjects() {
  /** @type {any[]} */
  const projects = await api('projects?limit=1000');
  return projects.map((project) => ({ ...project, id: String(project.id) }))
    .sort((a, b) => a.modified === b.modified ? Number(b.id) - Number(a.id) : a.modified < b.modified ? 1 : -1);
}

/**
 * Creates the button that opens the list of projects.
 * @param {import('../core/store.js').Store} store
 * @param {{open: (id: string) => void, rename: (project: Listed, name: string) => void, remove: (project: Listed) => void, upload: () => void, photographs: () => void, demo: () => void}} actions
 */
export function projectMenu(store, actions) {
  const name = h('span');
  const menu = h('div.popover.projects', { id: 'projects', hidden: true });
  const button = h('button.project', { type: 'button', 'aria-haspopup': 'true', 'aria-controls': 'projects', onclick: () => toggle() }, name, icon('chevron'));
  const element = h('div.anchor', {}, button, menu);
  const close = () => { menu.hidden = true; };
  const ask = (/** @type {() => void} */ dialog) => { // when the dialog closes, the focus returns to the menu's button
    close();
    button.focus();
    dialog();
  };
  const item = (/** @type {string} */ symbol, /** @type {string} */ label, /** @type {() => void} */ action) =>
    h('button.item', { type: 'button', onclick: () => { close(); action(); } }, icon(symbol), label);
  const toggle = async () => {
    menu.hidden = !menu.hidden;
    if (menu.hidden) return;
    const list = h('div.list', {}, h('p.hint', {}, text.loading));
    fill(menu, item('open', text.open, actions.upload), item('camera', text.photographs, actions.photographs),
      item('box', text.openDemo, actions.demo), h('h3', {}, text.projects.title), list);
    const projects = await recentProjects().catch((error) => void failed(error)) ?? [];
    fill(list, ...projects.map(row), !projects.length && h('p.hint', {}, text.projects.none));
  };
  const row = (/** @type {Listed} */ project) => h('div.row', {},
    h('button.item', { type: 'button', 'aria-current': String(project.id === store.state.project?.id), onclick: () => { close(); actions.open(project.id); } },
      h('span', {}, project.name), h('small', {}, `${text.history.count(project.results)} · ${when(project.modified)}`)),
    iconButton('pen', `${text.projects.rename}: ${project.name}`, () => ask(() => nameDialog(text.projects.renameTitle, text.projects.name, project.name, text.projects.save, (name) => actions.rename(project, name)))),
    iconButton('trash', `${text.projects.remove}: ${project.name}`, () => ask(() => confirmDialog(text.projects.removeTitle(project.name), [text.projects.removeSaid(project.results)], text.projects.remove, () => actions.remove(project)))));
  document.addEventListener('pointerdown', (event) => { if (!element.contains(/** @type {Node} */ (event.target))) close(); });
  element.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Escape') { close(); button.focus(); } });
  store.on(['project'], ({ project }) => fill(name, project?.name ?? text.open));
  return element;
}
