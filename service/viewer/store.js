/**
 * What the page shows, in one place; whoever changes it tells nobody else.
 * @template {Record<string, any>} S
 */
export class Store {
  /** @param {S} state */
  constructor(state) {
    this.state = state;
    /** @type {{keys: Set<string>, listener: () => void}[]} */
    this.listeners = [];
  }

  /**
   * Change some of it, and tell those who listen to what is no longer the same.
   * @param {Partial<S>} patch
   */
  set(patch) {
    const changed = Object.keys(patch).filter((key) => patch[key] !== this.state[key]);
    if (changed.length === 0) return;
    this.state = { ...this.state, ...patch };
    for (const { keys, listener } of [...this.listeners]) {
      if (changed.some((key) => keys.has(key))) listener();
    }
  }

  /**
   * @param {string[]} keys
   * @param {() => void} listener
   */
  on(keys, listener) {
    this.listeners.push({ keys: new Set(keys), listener });
  }
}
