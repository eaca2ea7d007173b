// The page's state. Code that changes it sets keys, and code that shows it listens to keys.

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
   * Sets keys of the state. Each listener is called once in the next microtask, however many keys were set.
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

  /** @param {(keyof State)[]} keys @param {(state: State) => void} call called at once, and when one of the keys is set */
  on(keys, call) {
    this.listeners.push({ keys, call });
    call(this.state);
  }
}

/** Changes that the user can undo, stored as copies of some keys of the state. */
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

  /** Stores the state; call this before each change. */
  remember() {
    const now = this.copy();
    if (this.past.at(-1) !== now) this.past.push(now);
    if (this.past.length > 200) this.past.shift();
    this.future = [];
  }

  /** Forgets all changes, which belong to a project that is no longer open. */
  clear() {
    [this.past, this.future] = [[], []];
  }

  /** @returns {(keyof State)[]} the keys that were restored */
  undo() {
    return this.move(this.past, this.future);
  }

  /** @returns {(keyof State)[]} the keys that were restored */
  redo() {
    return this.move(this.future, this.past);
  }

  /** Restores the newest copy in `from` that differs from the present state, and adds the present state to `to`. @param {string[]} from @param {string[]} to */
  move(from, to) {
    const now = this.copy();
    let wanted = from.pop();
    if (wanted === now) wanted = from.pop();
    if (!wanted) return [];
    to.push(now);
    const copy = JSON.parse(wanted);
    const changed = this.keys.filter((key) => JSON.stringify(copy[key]) !== JSON.stringify(this.store.state[key]));
    this.store.set(Object.fromEntries(changed.map((key) => [key, copy[key]])));
    return changed;
  }
}
