// A canvas with a picture that can be zoomed and panned, and a mark at one of its pixels.

import { element } from "../elements.js";
import { PanZoom } from "./panzoom.js";

const LARGEST = 64; // device pixels per pixel of the picture

/** A canvas that shows a drawing. */
export class Viewport {
  /**
   * @param {object} options
   * @param {(context: CanvasRenderingContext2D) => void} options.draw draws in the drawing's pixels
   * @param {() => {width: number, height: number}} options.size of the drawing
   * @param {(x: number, y: number) => void} options.point called with the point under the pointer
   * @param {() => void} options.zoomed called when the scale has changed
   */
  constructor({ draw, size, point, zoomed }) {
    this.draw = draw;
    this.size = size;
    /** @type {{x: number, y: number} | null} */
    this.marked = null;
    this.markSize = 1;
    /** The request for an animation frame; 0 for none. */
    this.waiting = 0;
    this.canvas = element("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": "Image. The arrows move the pointer, plus and minus zoom, 0 fits, 1 is one to one.",
      onpointerleave: (/** @type {PointerEvent} */ event) => {
        if (event.pointerType === "mouse") point(-1, -1);
      },
      ondblclick: () => this.view.fit(),
    });
    this.element = element("div", { class: "viewport" }, this.canvas);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.element);
    /** In device pixels; the scale is device pixels per pixel of the drawing. */
    this.view = new PanZoom(this.canvas, {
      size,
      limits: () => this.limits(),
      changed: (isZoomed) => {
        this.redraw();
        if (isZoomed) zoomed();
      },
      unit: () => devicePixelRatio,
    });
    for (const type of /** @type {const} */ (["pointerdown", "pointermove"])) {
      this.canvas.addEventListener(type, (event) => {
        const { x, y } = this.view.point(event);
        if (type === "pointerdown" || !event.buttons || event.pointerType !== "mouse") point(x, y);
      });
    }
  }

  close() {
    this.observer.disconnect();
    this.view.close();
  }

  /** @returns {[number, number]} */
  limits() {
    const { width, height } = this.size();
    return [Math.min(1, this.canvas.width / (width || 1), this.canvas.height / (height || 1)) / 2, LARGEST];
  }

  /** Return the number of available device pixels, or a minimum. */
  room() {
    const { width, height } = this.view.room();
    return Math.max(100_000, width * height);
  }

  resize() {
    const { clientWidth, clientHeight } = this.element;
    this.canvas.width = Math.round(clientWidth * devicePixelRatio);
    this.canvas.height = Math.round(clientHeight * devicePixelRatio);
    this.paint();
  }

  /**
   * Mark a pixel of the drawing; null removes the mark.
   * @param {{x: number, y: number} | null} mark
   * @param {number} size
   */
  mark(mark, size) {
    this.marked = mark;
    this.markSize = size;
    this.redraw();
  }

  redraw() {
    this.waiting ||= requestAnimationFrame(() => this.paint());
  }

  paint() {
    cancelAnimationFrame(this.waiting);
    this.waiting = 0;
    const context = this.canvas.getContext("2d");
    if (!context) return;
    const { scale, left, top } = this.view;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    if (!this.size().width) return;
    context.setTransform(scale, 0, 0, scale, left, top);
    context.imageSmoothingEnabled = scale < 1;
    this.draw(context);
    if (this.marked) this.paintMark(context, this.marked);
  }

  /** @param {CanvasRenderingContext2D} context @param {{x: number, y: number}} mark */
  paintMark(context, { x, y }) {
    const { scale, left, top } = this.view;
    const half = Math.max(4 * devicePixelRatio, (this.markSize * scale) / 2 + 1);
    context.setTransform(1, 0, 0, 1, 0, 0);
    const column = (Math.floor(x / this.markSize) + 0.5) * this.markSize;
    const row = (Math.floor(y / this.markSize) + 0.5) * this.markSize;
    for (const [color, width] of /** @type {const} */ ([["#000", 3], ["#fff", 1]])) {
      context.strokeStyle = color;
      context.lineWidth = width * devicePixelRatio;
      context.strokeRect(left + column * scale - half, top + row * scale - half, 2 * half, 2 * half);
    }
  }
}
