// The user's actions on projects: a project is opened, uploaded, renamed and deleted.
import { api, asResult, fileUrl } from './core/api.js';
import { bindMethods } from './core/bound.js';
import { keptSettings } from './core/kept.js';
import { sentenceOf, startOf } from './core/results.js';
import { failed, succeeded, toast } from './panels/dialogs.js';
import { DEFAULT_LIGHT } from './panels/light_panel.js';
import { recentProjects } from './panels/project_menu.js';
import { text } from './text.js';

/** @typedef {import('./core/types.js').Result} Result */

const MOST_BYTES = 512 * 2 ** 20;
const MOST_TRIED = 10; // projects, of which the first with a model is opened
const PROGRESS = 'live/progress.json'; // written by a running job
const MODEL = /\.(glb|gltf|obj|zip|vrm)$/i;

export class Projects {
  /** @param {import('./core/store.js').Store} store @param {import('./core/store.js').History} undo */
  constructor(store, undo) {
    this.store = store;
    this.undo = undo;
    bindMethods(this);
  }

  /** Opens the project and result that the address names, otherwise the project with a model that was used last. @param {string} [asked] the project, if the address's hash names none */
  async first(asked = '') {
    const [, hashed, result] = location.hash.match(/^#([\w-]+)(?:\/([\w-]+))?/) ?? [];
    const project = hashed ?? asked;
    if (project) {
      try {
        return await this.open(project, result);
      } catch { /* it was deleted, so another is opened */ }
    }
    const recent = (await recentProjects()).slice(0, MOST_TRIED);
    for (const { id } of recent) {
      const answer = await api(`projects/${id}`);
      if (answer.model?.url) return this.show(answer);
    }
    if (recent[0]) await this.open(recent[0].id); // photographs alone
  }

  /** @param {string} id @param {string} [result] to choose */
  async open(id, result) {
    this.show(await api(`projects/${encodeURIComponent(id)}`), result);
  }

  /** @param {any} answer a project as the server describes it @param {string} [result] to choose */
  show(answer, result) {
    const project = { ...answer, id: String(answer.id), model: answer.model?.url ? answer.model : null }; // null: photographs that are not reconstructed yet
    const results = ordered(answer.results);
    const chosen = results.find((other) => other.id === result) ?? results.findLast(({ state }) => state === 'running') ?? (project.model ? undefined : results[0]);
    const selected = chosen?.id ?? '';
    this.store.set({
      project, results, selected, layout: 'single', side: [], layers: [], region: { include: [], exclude: [], feather: 0 }, tool: 'orbit',
      light: this.store.state.light.name.startsWith('result-') ? DEFAULT_LIGHT : this.store.state.light, // the light of another project's result is not available here
      from: sentenceOf(results, startOf(results, selected)?.id ?? ''), to: chosen?.kind === 'edit' && chosen.state !== 'done' ? chosen.to : '',
      settings: keptSettings(project.id), invalid: {},
    });
    this.undo.clear();
    this.remember();
    results.forEach(this.recall);
    succeeded();
    if (!results.length) for (const warning of project.model?.warnings ?? []) failed({ message: warning, hint: warning.includes('does not exist') ? text.together : '' });
  }

  /** Reads the progress of a paused result, of which the server has only the file. @param {Result} result */
  async recall(result) {
    if (result.state !== 'paused' || result.progress) return;
    const response = await fetch(fileUrl(result.id, PROGRESS)).catch(() => null); // without it, the bar shows no share
    const progress = response?.ok ? await response.json() : null;
    const now = this.store.state.results.find(({ id }) => id === result.id);
    if (!progress || now?.state !== 'paused' || now.progress) return;
    const known = { ...now, progress: { ...progress, seconds: now.seconds } };
    this.store.set({ results: this.store.state.results.map((other) => other === now ? known : other) });
  }

  /** Puts the project and the selected result into the address, so that a reload shows them again. */
  remember() {
    const { project, selected } = this.store.state;
    history.replaceState(null, '', `#${project?.id ?? ''}${selected ? `/${selected}` : ''}`);
  }

  /** Handles the event that a project was renamed or removed. @param {any} changed */
  changed(changed) {
    const { project } = this.store.state;
    if (!project || String(changed.id) !== project.id) return;
    if (changed.removed) {
      this.store.set({ project: null, results: [], selected: '', layers: [] });
      this.remember();
      this.first().catch(failed);
    } else if (changed.name) this.store.set({ project: { ...project, name: changed.name } });
  }

  /** Fetches the results again, after the connection was lost. */
  async refresh() {
    const { project, selected } = this.store.state;
    if (!project) return;
    try {
      if (!project.model) return await this.open(project.id, selected); // it may have been reconstructed
      const results = ordered((await api(`projects/${project.id}`)).results);
      this.store.set({ results, selected: results.some(({ id }) => id === selected) ? selected : '' });
      results.forEach(this.recall);
    } catch (error) {
      failed(error);
    }
  }

  /** Opens a model, alone or with the files that it names. @param {import('./core/model_files.js').ModelFile[]} files */
  async upload(files) {
    const model = files.find(({ place }) => MODEL.test(place));
    const bytes = files.reduce((sum, { file }) => sum + file.size, 0);
    if (!model) return void failed({ message: text.wrongKind(files[0]?.file.name ?? '') });
    if (bytes > MOST_BYTES) return void failed({ message: text.tooLarge(bytes) });
    this.store.set({ busy: text.uploading(model.file.name) });
    const form = new FormData();
    for (const { file, place } of files) form.append('model', file, place);
    try {
      const { id } = await api(`projects?name=${encodeURIComponent(model.file.name)}`, { body: files.length > 1 ? form : model.file });
      await this.open(id);
    } catch (error) {
      failed(error);
    } finally {
      this.store.set({ busy: '' });
    }
  }

  async demo() {
    try {
      const { id } = await api('projects?demo=1', { method: 'POST' });
      await this.open(id);
      if (!this.store.state.from) this.store.set({ from: 'a red mug', to: 'a golden mug' });
    } catch (error) {
      failed(error);
    }
  }

  /** @param {{id: string}} project @param {string} name */
  async rename({ id }, name) {
    try {
      this.changed(await api(`projects/${id}`, { method: 'PATCH', json: { name } }));
    } catch (error) {
      failed(error);
    }
  }

  /** @param {{id: string}} project */
  async remove({ id }) {
    try {
      await api(`projects/${id}`, { method: 'DELETE' }); // an event reports that it is gone
      toast(text.projects.removed);
    } catch (error) {
      failed(error);
    }
  }
}

/** Returns the results, the oldest first. @param {any[]} results */
function ordered(results) {
  return results.map(asResult).sort((a, b) => a.created === b.created ? Number(a.id) - Number(b.id) : a.created < b.created ? -1 : 1);
}
