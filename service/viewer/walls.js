/**
 * Walls, frontiers and doorways of what is in sight, as coarse as they are drawn.
 *
 * Of a thousand zones they are many megabytes, so they are read apart from the zones, for the part
 * of the map that is looked at. A border belongs to a zone as a step left it, and is kept for other
 * moments at which the zone was the same.
 */

import { complain } from "./dom.js";
import { bordersOf, doorwaysOf } from "./model.js";
import { added, changed } from "./since.js";

const WHOLE_MAX = 100; // zones; so few are read at once
const DRAWN_PIXELS = 0.5; // what is nearer to a line cannot be told from it
const FINEST = 1 / 64; // m; below that, all points are read
const MARGIN = 0.25; // of the view, read on each side of it
const PAUSE_MS = 60;
const KEPT = 6_000; // borders of zones
const COORDINATE_MAX = 1_000_000; // m

export class Walls {
  /** @param {(rest: string, signal?: AbortSignal) => Promise<any>} get @param {() => void} came */
  constructor(get, came) {
    this.get = get;
    this.came = came;
    /** @type {Map<string, import("./model.js").Borders>} by step of change, id and tolerance */
    this.known = new Map();
    /** @type {Map<string, import("./model.js").Borders>} those that came last, by id */
    this.latest = new Map();
    /** @type {any[]} */
    this.doorways = [];
    this.asked = "";
    /** @type {{query: string, seq: number} | null} what was read last of the newest map */
    this.last = null;
    this.tolerance = 0;
    this.timer = 0;
    /** @type {{moment: import("./moments.js").Moment, query: URLSearchParams, tolerance: number} | null} */
    this.wanted = null;
    /** @type {AbortController | null} */
    this.reading = null;
  }

  /** @param {import("./model.js").Zone} zone @returns {import("./model.js").Borders | undefined} */
  of(zone) {
    return this.known.get(version(zone, this.tolerance)) ?? this.latest.get(zone.id);
  }

  /**
   * Read what a camera shows of a moment, unless that was asked for already.
   * @param {import("./moments.js").Moment} moment @param {boolean} isNewest
   * @param {import("./camera.js").Camera} camera @param {import("./geometry.js").Box} extent of the map
   */
  want(moment, isNewest, camera, extent) {
    if (moment.zones.length === 0) return;
    this.tolerance = toleranceAt(camera.scale);
    const box = moment.zones.length <= WHOLE_MAX ? null : partSeen(camera, extent);
    const query = new URLSearchParams({
      ...(this.tolerance > 0 ? { tolerance: String(this.tolerance) } : {}),
      ...(box ? { bbox: box.join(",") } : {}),
    });
    const key = `${moment.seq} ${query}`;
    if (key === this.asked) return;
    this.asked = key;
    if (!isNewest) {
      query.set("at", String(moment.seq));
      this.reading?.abort(); // while a robot drives, each reading is let end, or none would
    }
    this.wanted = { moment, query, tolerance: this.tolerance };
    this.timer ||= window.setTimeout(() => this.readWanted(), PAUSE_MS);
  }

  async readWanted() {
    try {
      while (this.wanted) {
        const { moment, query, tolerance } = this.wanted;
        this.wanted = null;
        this.reading = new AbortController();
        const { signal } = this.reading;
        await this.read(moment, query, tolerance, signal).catch((error) => {
          if (!signal.aborted) throw error;
        });
      }
    } catch (error) {
      this.asked = "";
      complain(error);
    } finally {
      this.timer = 0;
    }
  }

  /** @param {import("./moments.js").Moment} moment @param {URLSearchParams} query @param {number} tolerance @param {AbortSignal} signal */
  async read(moment, query, tolerance, signal) {
    const since = this.last?.query === String(query) ? `&since=${this.last.seq}` : "";
    const [borders, doorways] = await Promise.all(
      ["borders", "doorways"].map((part) => changed(this.get, `/${part}?${query}${since}`, signal)));
    const news = doorways && doorwaysOf(doorways);
    const all = news && since ? added(this.doorways, news, (one) => one.name, doorways.total) : news;
    this.last = null;
    if (since && !(borders && all)) return this.read(moment, query, tolerance, signal); // doorways are gone
    if (!borders || !all) return; // the session is another one by now
    this.keep(bordersOf(borders), borders.seq === moment.seq ? moment.zones : [], tolerance);
    this.doorways = all;
    if (!query.has("at")) this.last = { query: String(query), seq: Math.min(borders.seq, doorways.seq) };
    this.came();
  }

  /** @param {Map<string, import("./model.js").Borders>} borders @param {import("./model.js").Zone[]} zones as they were then @param {number} tolerance */
  keep(borders, zones, tolerance) {
    for (const [id, one] of borders) this.latest.set(id, one);
    for (const zone of zones) {
      const one = borders.get(zone.id);
      if (one) this.known.set(version(zone, tolerance), one);
    }
    for (const key of this.known.keys()) {
      if (this.known.size <= KEPT) break;
      this.known.delete(key);
    }
  }
}

/** @param {import("./model.js").Zone} zone @param {number} tolerance */
function version(zone, tolerance) {
  return `${zone.seq} ${tolerance} ${zone.id}`;
}

/** @param {number} scale pixels per m @returns {number} a power of four in m, so that it seldom changes; 0 is all there is */
function toleranceAt(scale) {
  const tolerance = 4 ** Math.floor(Math.log(DRAWN_PIXELS / scale) / Math.log(4));
  return tolerance < FINEST ? 0 : tolerance;
}

/**
 * The part of a map that is in sight, out to the lines of a grid, so that it seldom changes.
 * @param {import("./camera.js").Camera} camera @param {import("./geometry.js").Box} extent of the map
 * @returns {import("./geometry.js").Box | null} nothing if that is all of it
 */
function partSeen(camera, extent) {
  const [x0, y0, x1, y1] = camera.window;
  const cell = 2 ** Math.ceil(Math.log2(Math.max(x1 - x0, y1 - y0) * MARGIN));
  /** @type {import("./geometry.js").Box} */
  const box = [
    inWorld(cell * Math.floor(x0 / cell - 1)), inWorld(cell * Math.floor(y0 / cell - 1)),
    inWorld(cell * Math.ceil(x1 / cell + 1)), inWorld(cell * Math.ceil(y1 / cell + 1)),
  ];
  const isAll = box[0] <= extent[0] && box[1] <= extent[1] && box[2] >= extent[2] && box[3] >= extent[3];
  return isAll ? null : box;
}

/** @param {number} coordinate in m @returns {number} the same, where the service lets a map be */
function inWorld(coordinate) {
  return Math.min(Math.max(coordinate, -COORDINATE_MAX), COORDINATE_MAX);
}
