// Controls of the viewer: views, wireframe, turntable and comparison; also the panes' labels and the wipe's bar.
import { h, fill, icon, iconButton, segments } from '../core/dom.js';
import { text } from '../text.js';

/**
 * @param {import('../core/store.js').Store} store
 * @param {{frame: () => void, picture: () => void, layout: (layout: any) => void}} actions
 */
export function viewerBar(store, { frame, picture, layout }) {
  const view = h('select', { 'aria-label': text.viewer.view, title: text.viewer.view, onchange: () => store.set({ view: view.value }) },
    ...Object.entries(text.viewer.views).map(([value, label]) => h('option', { value }, label)));
  const toggle = (/** @type {'wires'|'turning'} */ key, /** @type {string} */ symbol, /** @type {string} */ label) =>
    iconButton(symbol, label, () => store.set({ [key]: !store.state[key] }));
  const wires = toggle('wires', 'wire', text.viewer.wires), turning = toggle('turning', 'turn', text.viewer.turn);
  const layouts = segments(text.viewer.layout, [{ value: 'single', label: text.viewer.single, icon: 'single' }, { value: 'wipe', label: text.viewer.wipe, icon: 'wipe' }, { value: 'side', label: text.viewer.side, icon: 'side' }], 'single', layout);
  store.on(['view', 'wires', 'turning', 'layout'], (state) => {
    view.value = state.view;
    wires.setAttribute('aria-pressed', String(state.wires));
    turning.setAttribute('aria-pressed', String(state.turning));
    layouts.set(state.layout);
  });
  return h('div.viewer-bar', { role: 'toolbar', 'aria-label': text.viewer.view }, view, wires, turning, iconButton('frame', text.viewer.frame, frame), iconButton('camera', text.viewer.picture, picture), h('span.spring'), layouts);
}

/** Creates the panes' labels, and the bar that the user drags between before and after. @param {import('../viewer/stage.js').Stage} stage */
export function paneLabels(stage) {
  const bar = h('div.wipe', { role: 'slider', tabIndex: 0, 'aria-label': text.viewer.wipeBar, 'aria-valuemin': 0, 'aria-valuemax': 100, hidden: true }, icon('wipe'));
  const labels = h('div.labels', { 'aria-hidden': 'true' });
  stage.host.append(labels, bar);
  let held = false;
  bar.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => {
    held = true;
    bar.setPointerCapture(event.pointerId);
  });
  bar.addEventListener('pointermove', (/** @type {PointerEvent} */ event) => {
    const area = stage.host.getBoundingClientRect();
    if (held) stage.setWipe((event.clientX - area.left) / area.width);
  });
  bar.addEventListener('pointerup', () => { held = false; });
  bar.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (!step) return;
    stage.setWipe(stage.wipe + step);
    event.preventDefault();
    event.stopPropagation();
  });
  const place = () => {
    const panes = stage.panes();
    bar.hidden = stage.layout !== 'wipe' || panes.length < 2;
    bar.style.left = `${100 * stage.wipe}%`;
    bar.setAttribute('aria-valuenow', String(Math.round(100 * stage.wipe)));
    fill(labels, ...(panes.length < 2 && !panes[0]?.shown.labelled ? [] : panes.map((pane, i) => {
      const right = stage.layout === 'wipe' && i === 1;
      return h('span', { style: right ? `right:${stage.host.clientWidth - pane.width + 12}px;bottom:12px` : `left:${pane.x + 12}px;bottom:${stage.host.clientHeight - pane.y - pane.height + 12}px` }, pane.shown.label);
    })));
  };
  stage.addEventListener('panes', place);
  place();
}
