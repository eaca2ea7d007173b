// The page's state in one place: who changes it sets keys, who shows it listens to keys.

/**
 * @typedef {import('./types.js').State} State
 */

export class Store {
  /** @param {State} state */
  constructor(state) {
    this.state = state;
    /** @type {{keys: (keyof State)[], call: (state: State) => void}[]} */
    this.listeners = [];
    /** @type {Set<keyof State>} */
    this.changed = new Set();
  }

  /**
   * Listeners are called once, in the next microtask, however many keys were set.
   * @param {Partial<State>} patch
   */
  set(patch) {
    if (!this.changed.size) queueMicrotask(() => this.tell());
    Object.assign(this.state, patch);
    for (const key of Object.keys(patch)) this.changed.add(/** @type {keyof State} */ (key));
  }

  tell() {
    const changed = this.changed;
    this.changed = new Set();
    for (const { keys, call } of this.listeners) if (keys.some((key) => changed.has(key))) call(this.state);
  }

  /** @param {(keyof State)[]} keys @param {(state: State) => void} call at once, and when one of the keys is set */
  on(keys, call) {
    this.listeners.push({ keys, call });
    call(this.state);
  }
}

/** What a person can undo: copies of some keys of the state. */
export class History {
  /** @param {Store} store @param {(keyof State)[]} keys */
  constructor(store, keys) {
    this.store = store;
    this.keys = keys;
    /** @type {string[]} */
    this.past = [];
    /** @type {string[]} */
    this.future = [];
  }

  copy() {
    return JSON.stringify(Object.fromEntries(this.keys.map((key) => [key, this.store.state[key]])));
  }

  /** Called before a change. */
  remember() {
    const now = this.copy();
    if (this.past.at(-1) !== now) this.past.push(now);
    if (this.past.length > 200) this.past.shift();
    this.future = [];
  }

  undo() {
    this.move(this.past, this.future);
  }

  redo() {
    this.move(this.future, this.past);
  }

  /** @param {string[]} from @param {string[]} to */
  move(from, to) {
    const now = this.copy();
    let wanted = from.pop();
    if (wanted === now) wanted = from.pop();
    if (!wanted) return;
    to.push(now);
    this.store.set(JSON.parse(wanted));
  }
}
