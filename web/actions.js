// The user's actions on results, layers and lights. Each one sends a request to the server and sets the state that follows from the answer.
import { api, asNumber, asResult } from './core/api.js';
import { bindMethods } from './core/bound.js';
import { download } from './core/dom.js';
import { nameOf, startOf } from './core/results.js';
import { editBody } from './panels/edit_form.js';
import { DEFAULT_LIGHT, lightBody } from './panels/light_panel.js';
import { confirmDialog, failed, succeeded, toast } from './panels/dialogs.js';
import { text } from './text.js';

/** @typedef {import('./core/types.js').Result} Result */

export class Actions {
  /** @param {import('./core/store.js').Store} store @param {import('./projects.js').Projects} projects */
  constructor(store, projects) {
    this.store = store;
    this.projects = projects;
    bindMethods(this);
  }

  async start() {
    const { project } = this.store.state;
    const result = asResult(await api(`projects/${project?.id}/edits`, { json: editBody(this.store.state) }));
    this.store.set({ highlight: false });
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
    succeeded();
  }

  /** Adds or replaces a result. @param {Result} result */
  arrived(result) {
    const { results, project } = this.store.state;
    if (result.project !== project?.id) return;
    const at = results.findIndex(({ id }) => id === result.id);
    const ended = result.state === 'done' && results[at]?.state !== 'done';
    const before = results[at]?.progress;
    if (result.state === 'paused' && !result.progress && before) result = { ...result, progress: before }; // the server forgets it
    if (ended && result.id === this.store.state.selected) this.lightOf(result);
    this.store.set({ results: at < 0 ? [...results, result] : results.with(at, result) });
    if (result.kind === 'reconstruct' && result.state === 'done' && !project.model) this.projects.open(project.id, result.id).catch(failed); // the project has a model now
  }

  /** @param {string} id */
  select(id) {
    const { layout, results } = this.store.state;
    const result = results.find((other) => other.id === id);
    if (result) this.lightOf(result);
    this.store.set({ selected: id, blended: false, ...(layout === 'side' || !result ? { layout: 'single', side: [] } : {}) });
    this.projects.remember();
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
    this.store.set({ blended: false, ...(now.length > 1 ? { side: now, layout: 'side' } : { side: [], layout: 'single', selected: now[0] ?? '' }) });
  }

  /** @param {'single'|'wipe'|'side'} layout */
  layout(layout) {
    const { selected, results } = this.store.state;
    const result = results.find(({ id }) => id === selected);
    if (layout === 'side') {
      const side = result ? [result.parent ?? '', selected] : ['', ...results.filter(({ state }) => state === 'done').slice(-1).map(({ id }) => id)];
      this.store.set({ blended: false, ...(side.length > 1 ? { layout, side } : { layout: 'single' }) });
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

  /** Deletes a result after a question. @param {Result} result */
  remove(result) {
    const children = this.store.state.results.filter(({ parent }) => parent === result.id);
    const open = children.find(({ state }) => state === 'running' || state === 'waiting');
    if (open) return void failed({ message: text.result.inUse(nameOf(open)), hint: text.result.inUseHint });
    const edits = children.filter(({ kind }) => kind === 'edit').length;
    const said = [result.favourite ? text.result.favourite : '', edits ? text.result.children(edits) : '', text.result.removeSaid].filter(Boolean);
    confirmDialog(text.result.removeTitle(nameOf(result)), said, text.result.remove, async () => {
      try {
        await api(`results/${result.id}`, { method: 'DELETE' });
        this.removed(result.id);
        toast(text.result.removed);
      } catch (error) {
        failed(error);
      }
    });
  }

  /** Removes a result from the state. @param {string} id */
  removed(id) {
    const { results, selected, layers, side } = this.store.state;
    const gone = results.find((result) => result.id === id);
    if (!gone) return;
    const others = results.filter((result) => result !== gone).map((result) => result.parent === id ? { ...result, parent: null } : result);
    this.store.set({ results: others, layers: layers.filter((layer) => layer.id !== id) });
    if (selected === id || side.includes(id)) this.store.set({ selected: selected === id ? gone.parent ?? '' : selected, layout: 'single', side: [] });
    this.projects.remember();
  }

  /** @param {Result} result */
  reuse(result) {
    const { region = [], exclude = [], feather = 0 } = result.request;
    this.store.set({ from: result.from, to: result.to, settings: result.settings ?? {}, invalid: {}, region: { include: region, exclude, feather }, selected: result.parent ?? '', layout: 'single', tab: 'edit' });
  }

  async saveLayers() {
    const { project, layers } = this.store.state;
    this.store.set({ busy: text.layers.saving });
    try {
      const { url } = await api(`projects/${project?.id}/layers`, { json: { layers: layers.filter(({ on }) => on).map(({ id, strength, channels }) => ({ result: asNumber(id), strength, channels })) } });
      download(url, `${stem(project?.name)}_layers.glb`);
      succeeded();
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
      succeeded();
    } catch (error) {
      failed(error);
    }
  }

  /** Uploads a light and shows it. @param {File} file */
  async ownLight(file) {
    const { name } = await api(`lights?name=${encodeURIComponent(file.name)}`, { body: file });
    succeeded();
    this.store.set({ light: { ...this.store.state.light, name, hour: null, sun: null, lit: '' } });
  }

  /** Starts a relight with the viewer's light. */
  async relight() {
    const { project, light } = this.store.state;
    const result = asResult(await api(`projects/${project?.id}/relight`, { json: { ...lightBody(light), parent: this.parent() } }));
    this.begun(result);
  }

  /** Starts a relight that optimises a light for two sentences, the first of which describes the model that is lit. @param {string} to */
  async findLight(to) {
    const { project, light, from } = this.store.state;
    const result = asResult(await api(`projects/${project?.id}/relight`, { json: { from_light: light.name, from: from || 'an object', to, parent: this.parent() } }));
    this.begun(result);
  }

  /** Returns the result whose model is lit, or null for the source. Throws if there is no model. */
  parent() {
    const { project, results, selected } = this.store.state;
    if (!project?.model) throw new Error(text.edit.noModel);
    return asNumber(startOf(results, selected)?.id ?? null);
  }
}

/** Returns a file name without its extension. @param {string} [name] */
export function stem(name = 'model') {
  return name.replace(/\.\w{2,4}$/, '');
}
