/** The metric map on its canvas: what is known, where the robot is, and what was asked for. */

import { Camera } from "./camera.js";
import { Stage } from "./canvas.js";
import { byId } from "./dom.js";
import { growBox, inside, isEmpty, meet, noBox, pointsAlong } from "./geometry.js";
import { handle } from "./gestures.js";
import { drawLabels } from "./labels.js";
import { layerMenu } from "./layermenu.js";
import * as layers from "./layers.js";
import { shade } from "./palette.js";
import { Walls } from "./walls.js";

const LEGEND = 28; // pixels
const HIT_PIXELS = 10;
const BEHIND_MAX = 3; // steps; older beams are none of where the robot is
const MARKED = 18; // pixels from mark to mark on a route
const MARKS_MAX = 200;
const WIDE = [1.8, 2.1]; // times as wide as high: less has the graph beside it on a wall screen, more below it
const PLAIN_MAX = 250; // so many have no passage points where they are small
const HINTS = {
  driving: "Click where the robot should begin.",
  world: "Nothing is explored yet. Press Drive, then click where the robot should begin.",
  robot: "Nothing is explored yet. The map begins with the first scan that the robot sends.",
};

export class MapView {
  /** @param {import("./session.js").Session} session @param {(x: number, y: number) => void} driveTo @param {(event: KeyboardEvent) => boolean} driveKey */
  constructor(session, driveTo, driveKey) {
    this.session = session;
    this.camera = new Camera(LEGEND);
    this.walls = new Walls((rest, signal) => session.get(rest, signal), () => this.stage.invalidate());
    this.touched = false;
    this.box = noBox();
    this.walked = 0;
    this.driveTo = driveTo;
    const canvas = (this.canvas = byId("map").cloneNode());
    byId("map").replaceWith(canvas); // a canvas of its own for each session
    this.stage = new Stage(canvas, this.camera,
      (context, camera, ratio) => this.drawGround(context, camera, ratio),
      (context, camera, ratio) => this.drawAbove(context, camera, ratio),
      () => { if (!this.touched) this.fit(); });
    handle(canvas, this.camera, {
      moved: () => this.moved(),
      fit: () => this.fit(),
      tapped: (px, py) => this.tapped(px, py),
      hovered: (at) => this.hovered(at),
      key: (event) => this.key(event, driveKey),
    });
    byId("map-in").onclick = () => { this.camera.zoom(1.4); this.moved(); };
    byId("map-out").onclick = () => { this.camera.zoom(1 / 1.4); this.moved(); };
    byId("map-fit").onclick = () => this.fit();
    this.shown = layerMenu(() => this.stage.invalidate());
    session.store.on(["moment", "exact", "poses", "seq", "at", "world", "driving", "graph"], () => this.changed());
    session.store.on(["hover", "selected"], () => this.stage.refresh());
    session.store.on(["answer"], () => this.stage.invalidate()); // names make room for it
  }

  moved() {
    this.touched = true;
    this.stage.move();
    this.wantWalls();
  }

  /** Ask for walls and doorways of what is in sight. */
  wantWalls() {
    const { moment, exact, at } = this.state;
    if (exact || at === null) this.walls.want(moment, at === null, this.camera, this.extent());
  }

  get state() {
    return this.session.state;
  }

  changed() {
    const { moment, poses, driving, world } = this.state;
    const box = this.extent();
    const times = (box[2] - box[0]) / Math.max(box[3] - box[1], 1e-9);
    const view = byId("session-view");
    view.classList.toggle("wide", times > WIDE[view.classList.contains("wide") ? 0 : 1]);
    if (!this.touched && String(box) !== String(this.fittedTo)) this.fit();
    this.canvas.classList.toggle("driving", driving);
    const hint = byId("map-hint");
    hint.hidden = moment.zones.length > 0 || poses.length > 0;
    hint.textContent = HINTS[driving ? "driving" : world ? "world" : "robot"];
    this.wantWalls();
    this.stage.invalidate();
  }

  /** @returns {import("./geometry.js").Box} all that was seen so far: going back in time does not make it less */
  extent() {
    const { moment, poses, world, driving } = this.state;
    for (const { box } of moment.zones) growBox(this.box, [[box[0], box[1]], [box[2], box[3]]]);
    for (; this.walked < poses.length && poses[this.walked]; this.walked += 1) growBox(this.box, [/** @type {any} */ (poses[this.walked])]);
    const box = /** @type {import("./geometry.js").Box} */ (this.box.slice());
    if (world && (isEmpty(box) || driving || this.shown.world)) growBox(box, [[world.box[0], world.box[1]], [world.box[2], world.box[3]]]);
    return isEmpty(box) ? [-5, -5, 5, 5] : box;
  }

  fit() {
    this.fittedTo = this.extent();
    this.camera.fit(this.fittedTo);
    this.touched = false;
    this.stage.renew();
    this.wantWalls();
  }

  /** @param {KeyboardEvent} event @param {(event: KeyboardEvent) => boolean} driveKey */
  key(event, driveKey) {
    if (event.key === "Escape" && this.state.selected) {
      this.session.store.set({ selected: null });
      return true;
    }
    return this.state.driving && driveKey(event);
  }

  /** @param {number} px @param {number} py @returns {{kind: "zone" | "edge", id: string} | null} */
  hit(px, py) {
    const { edges } = this.session.graphShown();
    let best = HIT_PIXELS;
    let found = null;
    for (const edge of edges) {
      const [x, y] = this.camera.toScreen(...edge.point);
      const distance = Math.hypot(x - px, y - py);
      if (distance < best) [best, found] = [distance, edge];
    }
    if (found) return { kind: "edge", id: found.key };
    const [x, y] = this.camera.toMap(px, py);
    const { zones } = this.state.moment;
    for (let n = zones.length - 1; n >= 0; n -= 1) {
      if (meet(zones[n].box, [x, y, x, y]) && inside(x, y, zones[n].rings)) return { kind: "zone", id: zones[n].id };
    }
    return null;
  }

  /** @param {number} px @param {number} py */
  tapped(px, py) {
    const found = this.hit(px, py);
    if (this.state.driving && found?.kind !== "edge") this.driveTo(...this.camera.toMap(px, py));
    else this.session.store.set({ selected: found });
  }

  /** @param {[number, number] | null} at */
  hovered(at) {
    const found = at && this.hit(...at);
    const { hover } = this.state;
    if (found?.id !== hover?.id || found?.kind !== hover?.kind) this.session.store.set({ hover: found });
    this.canvas.classList.toggle("pointing", Boolean(found) && !this.state.driving);
    const tip = byId("map-tip");
    const edge = found?.kind === "edge" && this.session.graphShown().edges.find((one) => one.key === found.id);
    tip.hidden = !(edge && at);
    if (!edge || !at) return;
    tip.textContent = `${edge.source} \u2192 ${edge.target}${this.session.closings.has(edge) ? ", closed" : ""}`;
    const left = Math.min(at[0] + 14, this.camera.width - tip.offsetWidth - 4);
    tip.style.transform = `translate(${left}px, ${Math.max(at[1] - 34, 4)}px)`;
  }

  /** What changes only with the map. @param {CanvasRenderingContext2D} context @param {Camera} camera @param {number} ratio */
  drawGround(context, camera, ratio) {
    const { shown } = this;
    const { moment, poses, world, driving, exact, at } = this.state;
    layers.drawGround(context, camera, ratio);
    camera.apply(context, ratio);
    if (world && (shown.world || driving)) layers.drawWorld(context, camera, world);
    layers.drawZones(context, camera, moment.zones);
    this.drawn = this.session.shown;
    if (exact || at === null) layers.drawDoorways(context, camera, this.walls.doorways, this.drawn);
    if (shown.walls && (exact || at === null || moment.zones.length <= PLAIN_MAX)) layers.drawBorders(context, camera, moment.zones, this.walls);
    if (shown.trail) layers.drawTrail(context, camera, poses, 0, this.drawn);
    this.drawPassages(context, camera, false);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (shown.names) drawLabels(context, camera, moment.zones, this.beside());
  }

  /** What moves. @param {CanvasRenderingContext2D} context @param {Camera} camera @param {number} ratio */
  drawAbove(context, camera, ratio) {
    const { shown } = this;
    const { moment, poses } = this.state;
    const step = this.session.shown;
    camera.apply(context, ratio);
    this.drawLit(context);
    if (shown.trail) layers.drawTrail(context, camera, poses, Math.max((this.drawn ?? 0) - 1, 0), step);
    const sight = this.sight();
    if (sight) layers.drawBeams(context, camera, sight);
    if (this.state.answer) layers.drawAnswer(context, camera, this.state.answer);
    this.drawPassages(context, camera, true);
    if (poses[step - 1]) layers.drawRobot(context, camera, poses[step - 1]);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const lit = this.lit();
    if (lit.size > 0) drawLabels(context, camera, moment.zones.filter((zone) => lit.has(zone.id)), { ...this.beside(), wanted: lit });
  }

  /** @returns {any} the beams that are drawn, if there are */
  sight() {
    const { sight } = this.state.moment;
    const isNear = sight?.pose && Math.abs(sight.seq - this.session.shown) <= BEHIND_MAX;
    return this.shown.beams && isNear ? sight : null;
  }

  /** @returns {import("./labels.js").Beside} what names are to be beside */
  beside() {
    const { poses, answer } = this.state;
    const pose = poses[this.session.shown - 1];
    const sight = this.sight();
    const onLines = [...(answer?.lines ?? []), ...(answer?.missing ?? [])].flatMap((/** @type {any} */ line) => pointsAlong(line, MARKED * this.camera.pixel, MARKS_MAX));
    const marks = [...(pose ? [pose.slice(0, 2)] : []), ...(answer?.points ?? []), ...(answer?.frontiers ?? []), ...onLines];
    return { marks, sight: sight && growBox(noBox(), sight.ends) };
  }

  /** @returns {Set<string>} zones that are hovered or selected, or ends of a passage that is */
  lit() {
    const lit = new Set();
    for (const one of [this.state.hover, this.state.selected]) {
      if (one?.kind === "zone") lit.add(one.id);
      if (one?.kind === "edge") JSON.parse(one.id).slice(0, 2).forEach((/** @type {string} */ id) => lit.add(id));
    }
    return lit;
  }

  /** @param {CanvasRenderingContext2D} context */
  drawLit(context) {
    const lit = this.lit();
    for (const zone of this.state.moment.zones) {
      if (!lit.has(zone.id)) continue;
      context.lineWidth = 3.5 * this.camera.pixel;
      context.strokeStyle = shade(zone.number).line;
      context.stroke(zone.path);
    }
  }

  /** @param {CanvasRenderingContext2D} context @param {Camera} camera @param {boolean} large those that are hovered or selected, or all */
  drawPassages(context, camera, large) {
    const { hover, selected, moment } = this.state;
    if (!large && camera.scale < 6 && moment.zones.length > PLAIN_MAX) return;
    const wanted = new Set([hover, selected].map((one) => (one?.kind === "edge" ? one.id : "")));
    const numbers = new Map(moment.zones.map((zone) => [zone.id, zone.number]));
    for (const edge of this.session.graphShown().edges) {
      if (large && !wanted.has(edge.key)) continue;
      const fill = shade(numbers.get(edge.source) ?? 0).line;
      layers.drawPoint(context, camera, edge.point, { fill, large, closed: this.session.closings.has(edge) });
    }
  }
}
