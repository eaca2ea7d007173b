// The user's actions. Each one sends a request to the server and sets the state that follows from the answer.
import { api, asNumber, asResult } from './core/api.js';
import { h } from './core/dom.js';
import { editBody } from './panels/edit_form.js';
import { DEFAULT_LIGHT, lightBody } from './panels/light_panel.js';
import { failed, toast } from './panels/dialogs.js';
import { text } from './text.js';

/** @typedef {import('./core/types.js').Result} Result */

const MOST_BYTES = 512 * 2 ** 20;
const MODEL = /\.(glb|gltf|obj|zip|vrm)$/i;

export class Actions {
  /** @param {import('./core/store.js').Store} store @param {import('./viewer/viewer.js').Viewer|null} viewer */
  constructor(store, viewer) {
    this.store = store;
    this.viewer = viewer;
    for (const name of Object.getOwnPropertyNames(Actions.prototype)) {
      const method = /** @type {any} */ (this)[name];
      if (name !== 'constructor' && typeof method === 'function') /** @type {any} */ (this)[name] = method.bind(this);
    }
  }

  /** Opens the project and result that the address names, otherwise the newest project. @param {string} [asked] the project, if the address's hash names none */
  async first(asked = '') {
    const [, hashed, result] = location.hash.match(/^#([\w-]+)(?:\/([\w-]+))?/) ?? [];
    const project = hashed ?? asked;
    if (project) {
      try {
        return await this.openProject(project, result);
      } catch { /* it was deleted, so the newest is opened */ }
    }
    const [newest] = await api('projects?limit=1');
    if (newest) await this.openProject(newest.id);
  }

  /** @param {string} id @param {string} [result] to choose */
  async openProject(id, result) {
    const answer = await api(`projects/${encodeURIComponent(id)}`);
    const project = { ...answer, id: String(answer.id), model: answer.model?.url ? answer.model : null }; // null: photographs that are not reconstructed yet
    const results = ordered(answer.results);
    const chosen = results.find((other) => other.id === result) ?? results.findLast(({ state }) => state === 'running');
    const last = chosen ?? results.findLast(({ from }) => from);
    this.store.set({
      project, results, selected: chosen?.id ?? '', layout: 'single', side: [], layers: [], region: { include: [], exclude: [], feather: 0 }, tool: 'orbit',
      light: this.store.state.light.name.startsWith('result-') ? DEFAULT_LIGHT : this.store.state.light, // the light of another project's result is not available here
      from: last?.from || this.store.state.from, to: chosen?.to ?? (last ? '' : this.store.state.to), settings: {},
    });
    this.remember();
    if (!results.length) for (const warning of project.model?.warnings ?? []) failed({ message: warning, hint: warning.includes('does not exist') ? text.together : '' });
  }

  /** Puts the project and the selected result into the address, so that a reload shows them again. */
  remember() {
    const { project, selected } = this.store.state;
    history.replaceState(null, '', `#${project?.id ?? ''}${selected ? `/${selected}` : ''}`);
  }

  /** Handles the event that a project was renamed or removed. @param {any} changed */
  projectChanged(changed) {
    const { project } = this.store.state;
    if (!project || String(changed.id) !== project.id) return;
    if (changed.removed) this.store.set({ project: null, results: [], selected: '' });
    else if (changed.name) this.store.set({ project: { ...project, name: changed.name } });
  }

  /** Fetches the results again, after the connection was lost. */
  async refresh() {
    const { project, selected } = this.store.state;
    if (!project) return;
    try {
      const results = ordered((await api(`projects/${project.id}`)).results);
      this.store.set({ results, selected: results.some(({ id }) => id === selected) ? selected : '' });
    } catch (error) {
      failed(error);
    }
  }

  /** Opens a model, alone or with the files that it names. @param {import('./core/model_files.js').ModelFile[]} files */
  async upload(files) {
    const model = files.find(({ place }) => MODEL.test(place));
    const bytes = files.reduce((sum, { file }) => sum + file.size, 0);
    if (!model) return failed({ message: text.wrongKind(files[0]?.file.name ?? '') });
    if (bytes > MOST_BYTES) return failed({ message: text.tooLarge(bytes) });
    this.store.set({ busy: text.uploading(model.file.name) });
    const form = new FormData();
    for (const { file, place } of files) form.append('model', file, place);
    try {
      const { id } = await api(`projects?name=${encodeURIComponent(model.file.name)}`, { body: files.length > 1 ? form : model.file });
      this.store.set({ from: '', to: '' });
      await this.openProject(id);
    } catch (error) {
      failed(error);
    } finally {
      this.store.set({ busy: '' });
    }
  }

  async demo() {
    try {
      const { id } = await api('projects?demo=1', { method: 'POST' });
      this.store.set({ from: 'a red mug', to: 'a golden mug' });
      await this.openProject(id);
    } catch (error) {
      failed(error);
    }
  }

  async start() {
    const { project } = this.store.state;
    const result = asResult(await api(`projects/${project?.id}/edits`, { json: editBody(this.store.state) }));
    this.begun(result);
  }

  /** Runs a result again with the same settings. @param {Result} result */
  async retry(result) {
    if (result.kind !== 'edit') return this.act(result, 'resume');
    try {
      const again = asResult(await api(`projects/${result.project}/edits`, { json: { ...result.request, parent: asNumber(result.parent) } }));
      this.begun(again);
    } catch (error) {
      failed(error);
    }
  }

  /** @param {Result} result @param {'pause'|'resume'|'cancel'} what */
  async act(result, what) {
    try {
      await api(`results/${result.id}/${what}`, { method: 'POST' }); // an event reports the new state
    } catch (error) {
      failed(error);
    }
  }

  /** Adds and selects a result that was begun. If an event has already added it, the event's version is newer and stays. @param {Result} result */
  begun(result) {
    if (!this.store.state.results.some(({ id }) => id === result.id)) this.arrived(result);
    this.select(result.id);
  }

  /** Adds or replaces a result. @param {Result} result */
  arrived(result) {
    const { results, project } = this.store.state;
    if (result.project !== project?.id) return;
    const at = results.findIndex(({ id }) => id === result.id);
    const ended = result.state === 'done' && results[at]?.state !== 'done';
    if (ended && result.id === this.store.state.selected) this.lightOf(result);
    this.store.set({ results: at < 0 ? [...results, result] : results.with(at, result) });
    if (result.kind === 'reconstruct' && result.state === 'done' && !project.model) this.openProject(project.id, result.id).catch(failed); // the project has a model now
  }

  /** @param {string} id */
  select(id) {
    const { layout, results } = this.store.state;
    const result = results.find((other) => other.id === id);
    if (result) this.lightOf(result);
    this.store.set({ selected: id, ...(layout === 'side' || !result ? { layout: 'single', side: [] } : {}) });
    this.remember();
  }

  /** If the result is a light, shows the model in it. @param {Result} result */
  lightOf({ id, kind, files }) {
    if (kind === 'relight' && files.includes('light.hdr')) this.store.set({ light: { ...DEFAULT_LIGHT, name: `result-${id}`, backdrop: this.store.state.light.backdrop } });
  }

  /** Shows a result beside the selected one, or removes it from there. @param {string} id */
  compare(id) {
    const { side, selected, layout } = this.store.state;
    const before = layout === 'side' ? side : [selected];
    const now = before.includes(id) && before.length > 1 ? before.filter((other) => other !== id) : [...before.filter((other) => other !== id), id].slice(-6);
    this.store.set(now.length > 1 ? { side: now, layout: 'side' } : { side: [], layout: 'single', selected: now[0] ?? '' });
  }

  /** @param {'single'|'wipe'|'side'} layout */
  layout(layout) {
    const { selected, results } = this.store.state;
    const result = results.find(({ id }) => id === selected);
    if (layout === 'side') {
      const side = result ? [result.parent ?? '', selected] : ['', ...results.filter(({ state }) => state === 'done').slice(-1).map(({ id }) => id)];
      this.store.set(side.length > 1 ? { layout, side } : { layout: 'single' });
    } else {
      const last = results.findLast(({ state }) => state === 'done');
      this.store.set({ layout, side: [], ...(layout === 'wipe' && !result && last ? { selected: last.id } : {}) });
    }
  }

  /** Changes fields of a result. @param {Result} shown the result, perhaps an older version @param {object} patch */
  async patch(shown, patch) {
    const result = this.store.state.results.find(({ id }) => id === shown.id) ?? shown;
    this.arrived({ ...result, ...patch });
    try {
      await api(`results/${result.id}`, { method: 'PATCH', json: patch });
    } catch (error) {
      this.arrived(result);
      failed(error);
    }
  }

  /** @param {Result} result */
  async remove(result) {
    try {
      await api(`results/${result.id}`, { method: 'DELETE' });
      this.removed(result.id);
      toast(text.result.removed);
    } catch (error) {
      failed(error);
    }
  }

  /** Removes a result from the state. @param {string} id */
  removed(id) {
    const { results, selected, layers, side } = this.store.state;
    const gone = results.find((result) => result.id === id);
    if (!gone) return;
    this.store.set({ results: results.filter((result) => result !== gone), layers: layers.filter((layer) => layer.id !== id) });
    if (selected === id || side.includes(id)) this.store.set({ selected: selected === id ? gone.parent ?? '' : selected, layout: 'single', side: [] });
  }

  /** @param {Result} result */
  reuse(result) {
    const { region = [], exclude = [], feather = 0 } = result.request;
    this.store.set({ from: result.from, to: result.to, settings: result.settings ?? {}, region: { include: region, exclude, feather }, selected: result.parent ?? '', layout: 'single', tab: 'edit' });
  }

  async saveLayers() {
    const { project, layers } = this.store.state;
    this.store.set({ busy: text.layers.saving });
    try {
      const { url } = await api(`projects/${project?.id}/layers`, { json: { layers: layers.filter(({ on }) => on).map(({ id, strength, channels }) => ({ result: asNumber(id), strength, channels })) } });
      download(url, `${stem(project?.name)}_layers.glb`);
    } catch (error) {
      failed(error);
    } finally {
      this.store.set({ busy: '' });
    }
  }

  async variants() {
    const { project, results } = this.store.state;
    try {
      const { url } = await api(`projects/${project?.id}/variants`, { json: { results: results.filter(({ favourite, state }) => favourite && state === 'done').map(({ id }) => asNumber(id)) } });
      download(url, `${stem(project?.name)}_variants.glb`);
    } catch (error) {
      failed(error);
    }
  }

  /** Uploads a light and shows it. @param {File} file */
  async ownLight(file) {
    const { name } = await api(`lights?name=${encodeURIComponent(file.name)}`, { body: file });
    this.store.set({ light: { ...this.store.state.light, name: name.replace(/\.(hdr|exr)$/, ''), hour: null, sun: null, lit: '' } });
  }

  /** Starts a relight with the viewer's light. */
  async relight() {
    const { project, light } = this.store.state;
    const result = asResult(await api(`projects/${project?.id}/relight`, { json: { ...lightBody(light), parent: this.parent() } }));
    this.begun(result);
  }

  /** Starts a relight that optimises a light for two sentences. @param {string} to */
  async findLight(to) {
    const { project, light, from } = this.store.state;
    const result = asResult(await api(`projects/${project?.id}/relight`, { json: { from_light: light.name, from: from || 'an object', to, parent: this.parent() } }));
    this.begun(result);
  }

  parent() {
    const { results, selected } = this.store.state;
    return results.some(({ id, state, kind }) => id === selected && state === 'done' && kind === 'edit') ? asNumber(selected) : null;
  }
}

/** Returns a file name without its extension. @param {string} [name] */
export function stem(name = 'model') {
  return name.replace(/\.\w{2,4}$/, '');
}

/** Returns the results, the oldest first. @param {any[]} results */
function ordered(results) {
  return results.map(asResult).sort((a, b) => a.created === b.created ? Number(a.id) - Number(b.id) : a.created < b.created ? -1 : 1);
}

/** @param {string} url @param {string} name */
function download(url, name) {
  const link = h('a', { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}
