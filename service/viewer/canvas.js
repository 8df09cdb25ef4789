/**
 * A canvas in two layers: a ground that is kept as a picture, and what moves above it.
 *
 * While the camera moves, the picture is moved along; it is drawn anew when the camera rests, or as
 * often as that takes little of the time. So panning is smooth however much there is to draw.
 */

import { Camera } from "./camera.js";
import { onTheme } from "./theme.js";

const MARGIN = 0.2; // of the view, on each side of the picture
const CHEAP_MS = 5; // a picture that takes no longer is drawn anew each frame
const REST_MS = 110;
const SHARE = 5; // a dear picture is drawn for a fifth of the time at most

export class Stage {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Camera} camera
   * @param {(context: CanvasRenderingContext2D, camera: Camera, ratio: number) => void} ground
   * @param {(context: CanvasRenderingContext2D, camera: Camera, ratio: number) => void} above
   * @param {() => void} resized
   */
  constructor(canvas, camera, ground, above, resized) {
    this.canvas = canvas;
    this.camera = camera;
    this.ground = ground;
    this.above = above;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
    this.picture = document.createElement("canvas");
    this.taken = new Camera();
    this.valid = false;
    this.cost = 0;
    this.takenAt = -Infinity;
    this.movedAt = -Infinity;
    this.waiting = 0;
    this.resting = 0;
    this.ratio = 1;
    new ResizeObserver(() => {
      this.ratio = Math.min(window.devicePixelRatio || 1, 3);
      canvas.width = Math.round(canvas.clientWidth * this.ratio);
      canvas.height = Math.round(canvas.clientHeight * this.ratio);
      camera.resize(canvas.clientWidth, canvas.clientHeight);
      resized();
      this.renew();
    }).observe(canvas);
    onTheme(() => this.renew());
  }

  /** What is drawn on the ground has changed. */
  invalidate() {
    this.valid = false;
    this.refresh();
  }

  /** The camera looks elsewhere, all at once. */
  renew() {
    this.takenAt = this.movedAt = -Infinity;
    this.invalidate();
  }

  /** The camera is being moved. */
  move() {
    this.movedAt = performance.now();
    this.refresh();
  }

  /** What is above has changed. */
  refresh() {
    this.waiting ||= requestAnimationFrame(() => {
      this.waiting = 0;
      if (this.canvas.width > 0 && this.canvas.height > 0) this.draw();
    });
  }

  draw() {
    const { context, camera, ratio } = this;
    const still = this.valid && this.taken.looksAs(camera);
    const now = performance.now();
    const resting = now - this.movedAt > REST_MS;
    const due = this.valid || now - this.takenAt > SHARE * this.cost;
    const take = !still && (this.cost <= CHEAP_MS || (resting && due));
    if (take) this.take();
    else if (!still) this.rest();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const [x0, y0] = camera.toScreen(...this.taken.toMap(0, 0));
    const [x1, y1] = camera.toScreen(...this.taken.toMap(this.taken.width, this.taken.height));
    if (x0 > 0 || y0 > 0 || x1 < camera.width || y1 < camera.height) {
      context.fillStyle = getComputedStyle(this.canvas.parentElement ?? this.canvas).backgroundColor;
      context.fillRect(0, 0, camera.width, camera.height);
    }
    context.drawImage(this.picture, x0, y0, x1 - x0, y1 - y0);
    if (take) { // browsers put off the drawing until the picture is needed
      this.takenAt = performance.now();
      this.cost = this.takenAt - now;
    }
    this.above(context, camera, ratio);
  }

  /** Draw the picture for where the camera is. */
  take() {
    this.taken.wider(this.camera, MARGIN);
    const width = Math.round(this.taken.width * this.ratio);
    const height = Math.round(this.taken.height * this.ratio);
    if (this.picture.width !== width) this.picture.width = width;
    if (this.picture.height !== height) this.picture.height = height;
    const context = /** @type {CanvasRenderingContext2D} */ (this.picture.getContext("2d", { alpha: false }));
    this.ground(context, this.taken, this.ratio);
    this.valid = true;
  }

  /** Look again, soon, whether it is to be drawn anew. */
  rest() {
    this.resting ||= window.setTimeout(() => {
      this.resting = 0;
      this.refresh();
    }, REST_MS);
  }
}
