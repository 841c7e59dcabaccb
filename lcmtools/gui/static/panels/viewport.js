// A view of a picture that is fitted, zoomed and moved, by pointers, fingers and keys.

import { element } from "../elements.js";

const LARGEST = 64; // device pixels for a pixel of the picture
const ZOOM_STEP = 1.25;

/**
 * A canvas that shows a drawing of some size.
 */
export class Viewport {
  /**
   * @param {object} options
   * @param {(context: CanvasRenderingContext2D) => void} options.draw draws it in its own pixels
   * @param {() => {width: number, height: number}} options.size of the drawing
   * @param {(x: number, y: number) => void} options.point called with the point under the pointer
   * @param {() => void} options.zoomed called when the scale has changed
   */
  constructor({ draw, size, point, zoomed }) {
    this.draw = draw;
    this.size = size;
    this.point = point;
    this.zoomed = zoomed;
    /** Device pixels for a pixel of the drawing. */
    this.scale = 1;
    this.isFitted = true;
    this.left = 0;
    this.top = 0;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    this.hasMoved = false;
    /** @type {{x: number, y: number} | null} */
    this.marked = null;
    this.markSize = 1;
    this.isWaiting = false;
    this.canvas = element("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": "Image. The arrows move the pointer, plus and minus zoom, 0 fits, 1 is one to one.",
      onpointerdown: (/** @type {PointerEvent} */ event) => this.press(event),
      onpointermove: (/** @type {PointerEvent} */ event) => this.move(event),
      onpointerup: (/** @type {PointerEvent} */ event) => this.pointers.delete(event.pointerId),
      onpointercancel: (/** @type {PointerEvent} */ event) => this.pointers.delete(event.pointerId),
      onpointerleave: (/** @type {PointerEvent} */ event) => {
        if (event.pointerType === "mouse") this.point(-1, -1);
      },
      ondblclick: () => this.fit(),
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
    });
    this.canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.element = element("div", { class: "viewport" }, this.canvas);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.element);
  }

  close() {
    this.observer.disconnect();
  }

  /** The device pixels that there are. */
  room() {
    const { clientWidth, clientHeight } = this.element;
    return Math.max(100_000, Math.round(clientWidth * clientHeight * devicePixelRatio ** 2));
  }

  resize() {
    const { clientWidth, clientHeight } = this.element;
    this.canvas.width = Math.round(clientWidth * devicePixelRatio);
    this.canvas.height = Math.round(clientHeight * devicePixelRatio);
    if (this.isFitted) this.fit();
    this.paint();
  }

  fit() {
    const { width, height } = this.size();
    this.isFitted = true;
    if (!width || !height || !this.canvas.width) return;
    this.scale = Math.min(this.canvas.width / width, this.canvas.height / height);
    this.left = (this.canvas.width - width * this.scale) / 2;
    this.top = (this.canvas.height - height * this.scale) / 2;
    this.redraw();
    this.zoomed();
  }

  /**
   * Zoom about a point of the canvas, else about its middle.
   * @param {number} scale
   * @param {number} [x]
   * @param {number} [y]
   */
  zoomTo(scale, x = this.canvas.width / 2, y = this.canvas.height / 2) {
    const { width, height } = this.size();
    const least = Math.min(1, this.canvas.width / (width || 1), this.canvas.height / (height || 1)) / 2;
    const to = Math.max(least, Math.min(LARGEST, scale));
    this.left = x - ((x - this.left) * to) / this.scale;
    this.top = y - ((y - this.top) * to) / this.scale;
    this.scale = to;
    this.isFitted = false;
    this.redraw();
    this.zoomed();
  }

  /**
   * Mark a pixel of the drawing, of some size; null for none.
   * @param {{x: number, y: number} | null} mark
   * @param {number} size
   */
  mark(mark, size) {
    this.marked = mark;
    this.markSize = size;
    this.redraw();
  }

  redraw() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.paint();
    });
  }

  paint() {
    const context = this.canvas.getContext("2d");
    if (!context) return;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    if (!this.size().width) return;
    context.setTransform(this.scale, 0, 0, this.scale, this.left, this.top);
    context.imageSmoothingEnabled = this.scale < 1;
    this.draw(context);
    if (this.marked) this.paintMark(context, this.marked);
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {{x: number, y: number}} mark
   */
  paintMark(context, { x, y }) {
    const size = this.markSize * this.scale;
    const half = Math.max(4 * devicePixelRatio, size / 2 + 1);
    context.setTransform(1, 0, 0, 1, 0, 0);
    const column = Math.floor(x / this.markSize) * this.markSize + this.markSize / 2;
    const row = Math.floor(y / this.markSize) * this.markSize + this.markSize / 2;
    const [left, top] = [this.left + column * this.scale, this.top + row * this.scale];
    for (const [color, width] of /** @type {const} */ ([["#000", 3], ["#fff", 1]])) {
      context.strokeStyle = color;
      context.lineWidth = width * devicePixelRatio;
      context.strokeRect(left - half, top - half, 2 * half, 2 * half);
    }
  }

  /**
   * The place of an event on the canvas [device pixels].
   * @param {MouseEvent} event
   */
  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return { x: (event.clientX - box.left) * devicePixelRatio, y: (event.clientY - box.top) * devicePixelRatio };
  }

  /** @param {PointerEvent} event */
  press(event) {
    if (event.button) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.place(event));
    this.showPoint(event);
  }

  /** @param {PointerEvent} event */
  move(event) {
    const before = this.pointers.get(event.pointerId);
    const now = this.place(event);
    if (before) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
      this.pointers.set(event.pointerId, now);
      if (other) {
        const grows = Math.hypot(now.x - other.x, now.y - other.y) / Math.hypot(before.x - other.x, before.y - other.y);
        this.zoomTo(this.scale * grows, other.x, other.y);
      } else {
        this.left += now.x - before.x;
        this.top += now.y - before.y;
        this.isFitted = false;
        this.redraw();
      }
    }
    if (!before || event.pointerType !== "mouse") this.showPoint(event);
  }

  /** @param {MouseEvent} event */
  showPoint(event) {
    const { x, y } = this.place(event);
    this.point((x - this.left) / this.scale, (y - this.top) / this.scale);
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const { x, y } = this.place(event);
    this.zoomTo(this.scale * ZOOM_STEP ** (-event.deltaY / 100), x, y);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.key === "+" || event.key === "=") this.zoomTo(this.scale * ZOOM_STEP);
    else if (event.key === "-") this.zoomTo(this.scale / ZOOM_STEP);
    else if (event.key === "0") this.fit();
    else if (event.key === "1") this.zoomTo(1);
    else return;
    event.preventDefault();
  }
}
