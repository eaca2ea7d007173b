// Entry point of the studio: builds the page and connects its parts with the server.
import { h, fill, iconButton, icon, oneStop } from './core/dom.js';
import { api, listen } from './core/api.js';
import { keepSettings } from './core/kept.js';
import { chosenFiles, droppedFiles } from './core/model_files.js';
import { Store, History } from './core/store.js';
import { applyTheme, switchTheme } from './core/appearance.js';
import { DEFAULT_LIGHT, lightPanel } from './panels/light_panel.js';
import { editForm } from './panels/edit_form.js';
import { historyPanel } from './panels/history.js';
import { jobBar } from './panels/job_bar.js';
import { layersPanel } from './panels/layers_panel.js';
import { photographsDialog } from './panels/photographs.js';
import { resultPanel } from './panels/result_panel.js';
import { failed, keysDialog, toast } from './panels/dialogs.js';
import { projectMenu } from './panels/project_menu.js';
import { paneLabels, viewerBar } from './panels/viewer_bar.js';
import { RegionMeasure } from './panels/region_measure.js';
import { RegionTools } from './panels/region_tools.js';
import { showPictures } from './viewer/pictures.js';
import { takePortraits } from './viewer/portrait.js';
import { showReconstruction } from './viewer/reconstruction.js';
import { hasWebGL } from './viewer/stage.js';
import { Viewer } from './viewer/viewer.js';
import { text } from './text.js';
import { keyboard } from './keyboard.js';
import { Actions, stem } from './actions.js';
import { Projects } from './projects.js';

applyTheme();
const asked = new URLSearchParams(location.search).get('project') ?? '';
if (location.search) history.replaceState(null, '', location.pathname + location.hash); // removes the token from the address bar

const NOTHING = { include: [], exclude: [], feather: 0 };
const store = new Store({
  about: null, project: null, portrait: null, results: [], selected: '', layout: 'single', side: [], view: 'shaded', wires: false, turning: false, tool: 'orbit', tab: 'edit',
  from: '', to: '', settings: {}, invalid: {}, region: NOTHING, highlight: false, layers: [], blended: true, light: DEFAULT_LIGHT, connected: true, busy: '',
});
const undo = new History(store, ['from', 'to', 'settings', 'region', 'layers']);
const remember = () => undo.remember();
/** Shows the tab of what an undo or redo has changed. @param {(keyof import('./core/types.js').State)[]} changed */
const reveal = (changed) => {
  if (changed.length) store.set({ tab: changed.includes('layers') ? 'layers' : 'edit', ...(changed.includes('settings') && { invalid: {} }) });
};
/** Undoes or redoes a brush stroke, or else a change of the state. @param {'undo'|'redo'} what */
const step = (what) => { if (!tools?.stepStroke(what)) reveal(undo[what]()); };

const host = h('div.stage');
const webgl = hasWebGL();
const viewer = webgl ? new Viewer(host, store, failed) : null;
if (viewer) takePortraits(viewer, store);
const projects = new Projects(store, undo);
const actions = new Actions(store, projects);
const measure = new RegionMeasure(store);
const tools = viewer ? new RegionTools(store, viewer.stage, measure, failed) : null;
const job = jobBar(store, { act: actions.act, retry: actions.retry });

const file = h('input', { type: 'file', multiple: true, accept: '.glb,.gltf,.obj,.zip,.vrm,.mtl,.bin,image/*,.ktx2,.tga', hidden: true, onchange: () => {
  if (file.files[0]) projects.upload(chosenFiles(file.files));
  file.value = '';
} });
const upload = () => file.click();
const photographs = () => photographsDialog((answer) => projects.open(String(answer.project), String(answer.id)).catch(failed));

const panels = {
  edit: editForm(store, { start: actions.start, remember, tools, measure }),
  layers: layersPanel(store, { remember, save: actions.saveLayers, blends: (id) => !viewer?.apart.has(id) }),
  light: lightPanel(store, { own: actions.ownLight, render: actions.relight, find: actions.findLight }),
  result: resultPanel(store, { patch: actions.patch, remove: actions.remove, reuse: actions.reuse, variants: actions.variants, toast }),
};
const tabs = h('div.tabs', { role: 'tablist' }, ...Object.entries(text.tabs).map(([name, label]) =>
  h('button', { type: 'button', role: 'tab', id: `tab-${name}`, 'data-tab': name, 'aria-controls': `panel-${name}`, onclick: () => store.set({ tab: /** @type {any} */ (name) }) }, label)));
oneStop(tabs, (button) => button.click());
for (const [name, panel] of Object.entries(panels)) {
  panel.id = `panel-${name}`;
  panel.setAttribute('role', 'tabpanel');
  panel.setAttribute('aria-labelledby', `tab-${name}`);
}
store.on(['tab'], ({ tab }) => {
  for (const button of tabs.children) {
    button.setAttribute('aria-selected', String(button.dataset.tab === tab));
    button.tabIndex = button.dataset.tab === tab ? 0 : -1;
  }
  for (const [name, panel] of Object.entries(panels)) panel.hidden = name !== tab;
  if (tab !== 'edit') store.set({ tool: 'orbit' });
  if (tab === 'layers') store.set({ blended: true });
});

const picture = async () => {
  if (!viewer) return;
  const blob = await viewer.stage.picture();
  const link = h('a', { href: URL.createObjectURL(blob), download: `${stem(store.state.project?.name)}.png` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
const facts = h('div.facts');
const undoButton = iconButton('undo', text.undo, () => step('undo')), redoButton = iconButton('redo', text.redo, () => step('redo'));
const toEdit = (/** @type {Event} */ event) => { // prevents the link from changing the address, which names the project
  event.preventDefault();
  store.set({ tab: 'edit' });
  requestAnimationFrame(() => document.getElementById('from')?.focus());
};
const bar = h('header.top', {},
  h('a.skip', { href: '#from', onclick: toEdit }, text.skip),
  h('span.brand', {}, h('img', { src: 'app/icon.svg', alt: '', width: 18, height: 18 }), text.title),
  projectMenu(store, { open: (id) => projects.open(id).catch(failed), rename: projects.rename, remove: projects.remove, upload, photographs, demo: projects.demo }),
  iconButton('open', text.open, upload, { id: 'open' }), iconButton('camera', text.photographs, photographs, { id: 'photographs' }),
  h('span.spring'), facts, undoButton, redoButton, iconButton('theme', text.theme, switchTheme), iconButton('help', text.help, keysDialog));
const empty = h('div.empty', { hidden: true },
  h('img', { src: 'app/icon.svg', alt: '', width: 48, height: 48 }), h('h1', {}, text.empty.title), h('p', {}, text.empty.lede),
  h('div.row', {}, h('button.primary', { type: 'button', onclick: upload }, icon('open'), text.open), h('button', { type: 'button', onclick: photographs }, icon('camera'), text.photographs),
    h('button', { type: 'button', id: 'demo', onclick: projects.demo }, text.openDemo)), h('p.hint', {}, text.empty.kinds));
const busy = h('div.busy', { role: 'status', hidden: true });
host.append(busy);
document.body.append(h('div.app', {}, bar, historyPanel(store, { select: actions.select, compare: actions.compare, favourite: (result) => actions.patch(result, { favourite: !result.favourite }) }),
  h('main.viewer', {}, webgl ? viewerBar(store, { frame: () => viewer?.stage.frame(), picture, layout: actions.layout }) : null, host, job, empty),
  h('aside.inspector', { 'aria-label': text.edit.what }, tabs, ...Object.values(panels))), file);
if (viewer) paneLabels(viewer.stage);
else showPictures(host, store);
showReconstruction(host, store);

store.on(['project'], ({ project }) => {
  document.title = project ? `${project.name} · ${text.title}` : text.title;
  fill(facts, project?.model ? text.viewer.model(project.model.triangles, project.model.materials.length) : '');
  document.body.classList.toggle('no-project', !project);
});
store.on(['settings'], ({ project, settings }) => { if (project) keepSettings(project.id, settings); });
store.on(['busy'], (state) => {
  busy.hidden = !state.busy;
  fill(busy, state.busy);
});

for (const kind of /** @type {const} */ (['dragover', 'dragleave', 'drop']))
  document.addEventListener(kind, (event) => {
    event.preventDefault();
    document.body.classList.toggle('dropping', kind === 'dragover');
    const dropped = kind === 'drop' && event.dataTransfer?.files[0];
    if (!dropped) return;
    if (/\.(hdr|exr)$/i.test(dropped.name)) actions.ownLight(dropped).catch(failed);
    else droppedFiles(/** @type {DataTransfer} */ (event.dataTransfer)).then(projects.upload).catch(failed);
  });
document.body.dataset.drop = text.dropHere;

keyboard(store, { step, frame: () => viewer?.stage.frame(), picture, start: () => /** @type {any} */ (document.getElementById('start')).click(), layout: actions.layout, help: keysDialog,
  favourite: () => {
    const result = store.state.results.find(({ id }) => id === store.state.selected);
    if (result) actions.patch(result, { favourite: !result.favourite });
  } });

/** @type {(() => void)|null} */
let lost = null;
let restarted = false;
listen({
  result: actions.arrived,
  removed: actions.removed,
  project: projects.changed,
  reset: projects.refresh,
  preview: (preview) => {
    viewer?.preview(preview);
    if (preview.id === store.state.selected && preview.direction) job.direction(preview.direction);
  },
  lost: () => { lost ??= toast(text.lost, { bad: true, stays: true }); },
  refused: () => {
    if (restarted) return;
    restarted = true;
    lost?.();
    lost = toast(text.restarted, { bad: true, hint: text.restartedHint, stays: true });
  },
  back: () => {
    lost?.();
    lost = null;
    restarted = false;
    toast(text.back);
    projects.refresh();
  },
});

Promise.all([api('about'), projects.first(asked)]).then(([about]) => {
  store.set({ about });
  document.body.classList.toggle('no-project', !store.state.project);
  empty.hidden = Boolean(store.state.project);
}).catch(failed);
store.on(['project'], ({ project }) => { empty.hidden = Boolean(project) || !store.state.about; });
/** @type {any} */ (window).studio = { store, viewer }; // for the browser's console, and for tests

