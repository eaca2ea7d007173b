// Handles the keys that text.keys lists. Letter keys do nothing while a field has the focus.
import { VIEWS } from './viewer/views.js';

/**
 * @param {import('./core/store.js').Store} store
 * @param {{step: (what: 'undo'|'redo') => void, frame: () => void, picture: () => void, start: () => void, layout: (layout: any) => void, help: () => void, favourite: () => void}} actions
 */
export function keyboard(store, actions) {
  document.addEventListener('keydown', (event) => {
    const control = event.ctrlKey || event.metaKey;
    const target = /** @type {HTMLElement} */ (event.target);
    const typing = target.isContentEditable || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName) && /** @type {any} */ (target).type !== 'range' && /** @type {any} */ (target).type !== 'checkbox';
    if (document.querySelector('dialog[open]')) return;
    if (control && event.key === 'Enter') return act(event, actions.start);
    if (control && event.key.toLowerCase() === 'z' && !typing) return act(event, () => actions.step(event.shiftKey ? 'redo' : 'undo'));
    if (event.key === 'Escape') return store.set({ tool: 'orbit' });
    if (typing || control || event.altKey) return;
    const { state } = store;
    /** @type {Record<string, () => void>} */
    const keys = {
      f: actions.frame, s: actions.picture, '?': actions.help, '*': actions.favourite,
      w: () => store.set({ wires: !state.wires }), t: () => store.set({ turning: !state.turning }), c: () => actions.layout(state.layout === 'wipe' ? 'single' : 'wipe'),
    };
    VIEWS.forEach((view, i) => { keys[String(i + 1)] = () => store.set({ view }); });
    const action = keys[event.key.toLowerCase()];
    if (action) act(event, action);
  });
}

/** @param {Event} event @param {() => void} action */
function act(event, action) {
  event.preventDefault();
  action();
}
