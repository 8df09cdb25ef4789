/** A canvas that is as large as its box and is drawn when something has changed, once a frame. */

import { onTheme } from "./theme.js";

export class Stage {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {(context: CanvasRenderingContext2D, ratio: number) => void} draw
   * @param {(width: number, height: number) => void} resized in CSS pixels
   */
  constructor(canvas, draw, resized) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
    this.draw = draw;
    this.waiting = 0;
    this.ratio = 1;
    new ResizeObserver(() => {
      this.ratio = Math.min(window.devicePixelRatio || 1, 3);
      const { clientWidth, clientHeight } = canvas;
      canvas.width = Math.round(clientWidth * this.ratio);
      canvas.height = Math.round(clientHeight * this.ratio);
      resized(clientWidth, clientHeight);
      this.invalidate();
    }).observe(canvas);
    onTheme(() => this.invalidate());
  }

  invalidate() {
    this.waiting ||= requestAnimationFrame(() => {
      this.waiting = 0;
      if (this.canvas.width > 0 && this.canvas.height > 0) this.draw(this.context, this.ratio);
    });
  }
}
