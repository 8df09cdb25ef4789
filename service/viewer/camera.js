/** Where a view looks: the place in its middle, and how many pixels a metre has. y points up. */

const MARGIN = 24; // pixels around what is fitted

export class Camera {
  /** @param {number} foot pixels more below, where a legend is */
  constructor(foot = 0) {
    this.foot = foot;
    this.x = 0;
    this.y = 0;
    this.scale = 40;
    this.width = 1;
    this.height = 1;
    this.least = 1e-4;
    this.most = 4_000;
    /** @type {number | null} */
    this.drawnAs = null;
  }

  /** Look at the same place as another camera, with a margin around it. @param {Camera} other @param {number} margin */
  wider(other, margin) {
    this.resize(other.width * (1 + 2 * margin), other.height * (1 + 2 * margin));
    this.x = other.x;
    this.y = other.y;
    this.scale = other.scale;
    this.drawnAs = other.size;
  }

  /** @param {Camera} other @returns {boolean} whether both look at the same place as near */
  looksAs(other) {
    return this.x === other.x && this.y === other.y && this.scale === other.scale;
  }

  /** @param {number} width @param {number} height in pixels */
  resize(width, height) {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
  }

  /** @param {import("./geometry.js").Box} box @param {number} [most] pixels per m at most */
  fit(box, most = 160) {
    const width = Math.max(box[2] - box[0], 1e-9);
    const height = Math.max(box[3] - box[1], 1e-9);
    const across = Math.max(this.width - 2 * MARGIN, 10) / width;
    const up = Math.max(this.height - 2 * MARGIN - this.foot, 10) / height;
    this.scale = Math.min(across, up, most);
    this.x = (box[0] + box[2]) / 2;
    this.y = (box[1] + box[3]) / 2 - this.foot / 2 / this.scale;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} in pixels */
  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  /** @param {number} px @param {number} py @returns {[number, number]} in m */
  toMap(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }

  /** @param {number} dx @param {number} dy in pixels */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  /** @param {number} factor @param {number} [px] @param {number} [py] what stays where it is */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toMap(px, py);
    this.scale = Math.min(Math.max(this.scale * factor, this.least), this.most);
    const [nx, ny] = this.toMap(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }

  /** How much larger lines and letters are on a wall than on a desk. */
  get size() {
    return this.drawnAs ?? Math.min(Math.max(Math.sqrt(this.width * this.height) / 760, 1), 1.7);
  }

  /** A pixel in m, or somewhat more on a wall. */
  get pixel() {
    return this.size / this.scale;
  }

  /** @returns {import("./geometry.js").Box} what can be seen, in m */
  get window() {
    const [x0, y1] = this.toMap(0, 0);
    const [x1, y0] = this.toMap(this.width, this.height);
    return [x0, y0, x1, y1];
  }

  /** @param {CanvasRenderingContext2D} context @param {number} ratio of device to CSS pixels */
  apply(context, ratio) {
    const s = this.scale * ratio;
    context.setTransform(s, 0, 0, -s,
      (this.width / 2 - this.x * this.scale) * ratio, (this.height / 2 + this.y * this.scale) * ratio);
  }
}
