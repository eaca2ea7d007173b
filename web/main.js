// Entry point of the studio: builds the page and connects its parts with the server.
import { h, fill, iconButton, icon, oneStop } from './core/dom.js';
import { api, listen } from './core/api.js';
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
import { failed, keysDialog, projectMenu, toast } from './panels/dialogs.js';
import { paneLabels, viewerBar } from './panels/viewer_bar.js';
import { RegionTools } from './panels/region_tools.js';
import { showPictures } from './viewer/pictures.js';
import { showReconstruction } from './viewer/reconstruction.js';
import { hasWebGL } from './viewer/stage.js';
import { Viewer } from './viewer/viewer.js';
import { text } from './text.js';
import { keyboard } from './keyboard.js';
import { Actions, stem } from './actions.js';

applyTheme();
const asked = new URLSearchParams(location.search).get('project') ?? '';
if (location.search) history.replaceState(null, '', location.pathname + location.hash); // removes the token from the address bar

const NOTHING = { include: [], exclude: [], feather: 0 };
const store = new Store({
  about: null, project: null, results: [], selected: '', layout: 'single', side: [], view: 'shaded', wires: false, turning: false, tool: 'orbit', tab: 'edit',
  from: '', to: '', settings: {}, region: NOTHING, layers: [], light: DEFAULT_LIGHT, connected: true, busy: '',
});
const undo = new History(store, ['from', 'to', 'settings', 'region', 'layers']);
const remember = () => undo.remember();

const host = h('div.stage');
const webgl = hasWebGL();
const viewer = webgl ? new Viewer(host, store, failed) : null;
const actions = new Actions(store, viewer);
const tools = viewer ? new RegionTools(store, viewer.stage, failed) : null;
const job = jobBar(store, { act: actions.act, retry: actions.retry });

const file = h('input', { type: 'file', multiple: true, accept: '.glb,.gltf,.obj,.zip,.vrm,.mtl,.bin,image/*,.ktx2,.tga', hidden: true, onchange: () => {
  if (file.files[0]) actions.upload(chosenFiles(file.files));
  file.value = '';
} });
const upload = () => file.click();
const photographs = () => photographsDialog((answer) => actions.openProject(String(answer.project), String(answer.id)).catch(failed));

const panels = {
  edit: editForm(store, { start: actions.start, remember, tools }),
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
  tools?.showVeil();
});

const picture = async () => {
  if (!viewer) return;
  const blob = await viewer.stage.picture();
  const link = h('a', { href: URL.createObjectURL(blob), download: `${stem(store.state.project?.name)}.png` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
const facts = h('div.facts');
const undoButton = iconButton('undo', text.undo, () => undo.undo()), redoButton = iconButton('redo', text.redo, () => undo.redo());
const toEdit = (/** @type {Event} */ event) => { // prevents the link from changing the address, which names the project
  event.preventDefault();
  store.set({ tab: 'edit' });
  requestAnimationFrame(() => document.getElementById('from')?.focus());
};
const bar = h('header.top', {},
  h('a.skip', { href: '#from', onclick: toEdit }, text.skip),
  h('span.brand', {}, h('img', { src: 'app/icon.svg', alt: '', width: 18, height: 18 }), text.title),
  projectMenu(store, { open: (id) => actions.openProject(id).catch(failed), upload, photographs, demo: actions.demo }),
  iconButton('open', text.open, upload, { id: 'open' }), iconButton('camera', text.photographs, photographs, { id: 'photographs' }),
  h('span.spring'), facts, undoButton, redoButton, iconButton('theme', text.theme, switchTheme), iconButton('help', text.help, keysDialog));
const empty = h('div.empty', { hidden: true },
  h('img', { src: 'app/icon.svg', alt: '', width: 48, height: 48 }), h('h1', {}, text.empty.title), h('p', {}, text.empty.lede),
  h('div.row', {}, h('button.primary', { type: 'button', onclick: upload }, icon('open'), text.open), h('button', { type: 'button', onclick: photographs }, icon('camera'), text.photographs),
    h('button', { type: 'button', id: 'demo', onclick: actions.demo }, text.openDemo)), h('p.hint', {}, text.empty.kinds));
const busy = h('div.busy', { role: 'status', hidden: true });
host.append(busy, job);
document.body.append(h('div.app', {}, bar, historyPanel(store, { select: actions.select, compare: actions.compare, favourite: (result) => actions.patch(result, { favourite: !result.favourite }) }),
  h('main.viewer', {}, webgl ? viewerBar(store, { frame: () => viewer?.stage.frame(), picture, layout: actions.layout }) : null, host, empty),
  h('aside.inspector', { 'aria-label': text.edit.what }, tabs, ...Object.values(panels))), file);
if (viewer) paneLabels(viewer.stage);
else showPictures(host, store);
showReconstruction(host, store);

store.on(['project'], ({ project }) => {
  document.title = project ? `${project.name} · ${text.title}` : text.title;
  fill(facts, project?.model ? text.viewer.model(project.model.triangles, project.model.materials.length) : '');
  document.body.classList.toggle('no-project', !project);
});
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
    else droppedFiles(/** @type {DataTransfer} */ (event.dataTransfer)).then(actions.upload).catch(failed);
  });
document.body.dataset.drop = text.dropHere;

keyboard(store, { undo, frame: () => viewer?.stage.frame(), picture, start: () => /** @type {any} */ (document.getElementById('start')).click(), layout: actions.layout, help: keysDialog,
  favourite: () => {
    const result = store.state.results.find(({ id }) => id === store.state.selected);
    if (result) actions.patch(result, { favourite: !result.favourite });
  } });

/** @type {(() => void)|null} */
let lost = null;
listen({
  result: actions.arrived,
  removed: actions.removed,
  project: actions.projectChanged,
  reset: actions.refresh,
  preview: (preview) => {
    viewer?.preview(preview);
    if (preview.id === store.state.selected && preview.direction) job.direction(preview.direction);
  },
  lost: () => { lost ??= toast(text.lost, { bad: true, stays: true }); },
  back: () => {
    lost?.();
    lost = null;
    toast(text.back);
    actions.refresh();
  },
});

Promise.all([api('about'), actions.first(asked)]).then(([about]) => {
  store.set({ about });
  document.body.classList.toggle('no-project', !store.state.project);
  empty.hidden = Boolean(store.state.project);
}).catch(failed);
store.on(['project'], ({ project }) => { empty.hidden = Boolean(project) || !store.state.about; });
/** @type {any} */ (window).studio = { store, viewer }; // for the browser's console, and for tests

