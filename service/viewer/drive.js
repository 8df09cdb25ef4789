/** Drive the simulated robot: towards where somebody clicks, or with the keys, step by step. */

import { sendJson } from "./api.js";
import { byId, complain } from "./dom.js";

const STRIDE = 0.25; // m; a door is wider
const STEPS_MAX = 400; // to one click

/** @type {Record<string, [number, number]>} */
const KEYS = {
  ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0],
  w: [0, 1], s: [0, -1], a: [-1, 0], d: [1, 0],
};

export class Driver {
  /** @param {import("./session.js").Session} session */
  constructor(session) {
    this.session = session;
    /** @type {[number, number, number][]} where to go next */
    this.waiting = [];
    this.moving = false;
    const button = byId("drive");
    button.onclick = () => session.store.set({ driving: !session.state.driving });
    session.store.on(["driving"], () => this.tell());
    session.store.on(["session", "world"], () => this.tell());
    this.tell();
  }

  tell() {
    const { session, driving } = this.session.state;
    const button = byId("drive");
    button.setAttribute("aria-pressed", String(driving));
    button.hidden = Boolean(session) && !session.world;
    if (driving) {
      this.session.go(null);
      byId("map").focus({ preventScroll: true });
    }
  }

  close() {
    this.waiting = [];
  }

  /** @returns {[number, number, number] | undefined} where the robot is, or is going */
  get last() {
    const { poses, seq } = this.session.state;
    return this.waiting[this.waiting.length - 1] ?? poses[seq - 1];
  }

  /** Go straight to a place; a first step is taken there at once. @param {number} x @param {number} y */
  goTo(x, y) {
    this.waiting = [];
    const { poses, seq } = this.session.state;
    const from = poses[seq - 1];
    if (!from) return this.follow([[x, y, 0]]);
    const length = Math.hypot(x - from[0], y - from[1]);
    const count = Math.min(Math.max(1, Math.ceil(length / STRIDE)), STEPS_MAX);
    const theta = Math.atan2(y - from[1], x - from[0]);
    return this.follow(Array.from({ length: count }, (_, n) => {
      const share = (n + 1) / count;
      return [from[0] + share * (x - from[0]), from[1] + share * (y - from[1]), theta];
    }));
  }

  /** @param {KeyboardEvent} event @returns {boolean} whether the key drives */
  key(event) {
    if (event.key === "Escape") {
      this.waiting = [];
      return true;
    }
    const direction = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    const from = this.last;
    if (!direction || !from) return false;
    if (this.waiting.length > 1) return true; // a key that is held must not run ahead
    const [dx, dy] = direction;
    this.follow([[from[0] + dx * STRIDE, from[1] + dy * STRIDE, Math.atan2(dy, dx)]]);
    return true;
  }

  /** Take steps one after the other. @param {[number, number, number][]} poses */
  follow(poses) {
    this.waiting.push(...poses);
    if (!this.moving) void this.drive();
  }

  async drive() {
    this.moving = true;
    byId("session-view").dataset.moving = "true";
    try {
      while (this.waiting.length > 0) {
        const [x, y, theta] = /** @type {[number, number, number]} */ (this.waiting[0]);
        const step = await sendJson(`${this.session.path}/step`, { pose: { x, y, theta } });
        this.waiting.shift();
        this.session.stepped({ ...step, pose: { x, y, theta } }); // the stream tells the same a little later
        await new Promise((resolve) => setTimeout(resolve, 25));
      }
    } catch (error) {
      this.waiting = [];
      complain(error);
    } finally {
      this.moving = false;
      byId("session-view").dataset.moving = "false";
    }
  }
}
