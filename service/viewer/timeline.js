/** The slider over steps: marks where the graph changed, play and pause, live at the right end. */

import { byId } from "./dom.js";
import { colour } from "./palette.js";
import { onTheme } from "./theme.js";

const PLAY_SECONDS = 12; // for all of a session, but no faster than a screen shows
const FRAME_MS = 50;
const THUMB = 9; // half of its width in pixels

export class Timeline {
  /** @param {import("./session.js").Session} session */
  constructor(session) {
    this.session = session;
    this.slider = byId("time");
    this.playing = 0;
    this.slider.oninput = () => {
      this.pause();
      const at = Number(this.slider.value);
      session.go(at >= session.state.seq ? null : at);
    };
    byId("live").onclick = () => { this.pause(); session.go(null); };
    byId("play").onclick = () => (this.playing ? this.pause() : this.play());
    byId("earlier").onclick = () => this.jump(-1);
    byId("later").onclick = () => this.jump(1);
    session.store.on(["seq", "at", "exact"], () => this.tell());
    session.store.on(["seq", "changes"], () => this.drawMarks());
    this.observer = new ResizeObserver(() => this.drawMarks());
    this.observer.observe(byId("marks"));
    onTheme(() => this.drawMarks());
    this.tell();
  }

  close() {
    this.pause();
    this.observer.disconnect();
  }

  tell() {
    const { seq, at, exact } = this.session.state;
    const shown = this.session.shown;
    this.slider.max = String(seq);
    this.slider.value = String(shown);
    this.slider.disabled = seq === 0;
    const found = this.foundAt(shown);
    this.slider.setAttribute("aria-valuetext", `Step ${shown} of ${seq}${at === null ? ", live" : ""}${found && `: ${found}`}`);
    byId("moment").textContent = `${shown.toLocaleString("en")} / ${seq.toLocaleString("en")}`;
    byId("moment").dataset.exact = String(exact);
    byId("live").setAttribute("aria-pressed", String(at === null));
    byId("session-view").dataset.at = String(shown);
    byId("session-view").dataset.exact = String(exact);
  }

  /** @param {number} seq @returns {string} what a step found, in words */
  foundAt(seq) {
    const change = this.session.state.changes.find((one) => one.seq === seq);
    return (change?.events ?? []).map(inWords).join(", ");
  }

  /** @param {number} direction to the change before or after */
  jump(direction) {
    this.pause();
    const { changes, seq } = this.session.state;
    const shown = this.session.shown;
    const steps = changes.map((one) => one.seq);
    const next = direction < 0
      ? [0, ...steps].filter((one) => one < shown).pop() ?? 0
      : steps.find((one) => one > shown) ?? seq;
    this.session.go(next >= seq ? null : next);
  }

  play() {
    const { seq, at } = this.session.state;
    let position = at ?? 0;
    const stride = Math.max(seq / ((PLAY_SECONDS * 1000) / FRAME_MS), 0.25);
    this.playing = window.setInterval(() => {
      position += stride;
      const next = Math.floor(position);
      if (next >= this.session.state.seq) {
        this.pause();
        this.session.go(null);
      } else if (next !== this.session.state.at) this.session.play(next);
    }, FRAME_MS);
    this.session.play(Math.floor(position));
    byId("play").classList.add("playing");
    byId("play").setAttribute("aria-label", "Pause");
  }

  pause() {
    clearInterval(this.playing);
    this.playing = 0;
    byId("play").classList.remove("playing");
    byId("play").setAttribute("aria-label", "Play");
  }

  /** A stroke for each step that found something: high for a zone, low for a passage. */
  drawMarks() {
    const canvas = byId("marks");
    const ratio = Math.min(window.devicePixelRatio || 1, 3);
    const { clientWidth: width, clientHeight: height } = canvas;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { seq, changes } = this.session.state;
    const middle = height / 2;
    context.fillStyle = colour("line");
    context.fillRect(THUMB, middle - 2, width - 2 * THUMB, 4);
    const dense = changes.length > width / 6;
    context.globalAlpha = dense ? 0.3 : 1;
    for (const { seq: at, events } of changes) {
      const x = THUMB + (at / Math.max(seq, 1)) * (width - 2 * THUMB);
      const isZone = events.some((/** @type {any} */ event) => event.type === "node" || event.type === "merge");
      context.fillStyle = isZone ? colour("accent") : colour("passage");
      const high = isZone ? 9 : 6;
      context.fillRect(x - 1, middle - high, dense ? 1 : 2, 2 * high);
    }
  }
}

/** @param {any} event of a step */
function inWords(event) {
  if (event.type === "node") return `found ${event.zone_id}`;
  if (event.type === "merge") return `${event.zone_id} is part of ${event.into}`;
  const ends = `${event.source} to ${event.target}`;
  return event.type === "join" ? `two passages from ${ends} are one` : ends;
}
