// Fitting, zooming and panning a picture in an element, by pointer, touch and keys.

const STEP = 1.25; // zoom factor for a key, and for 100 px of a wheel
const FAR = 5; // [px] before a press becomes a drag

/** The position of a picture in an element: its scale, and the place of its corner. */
export class PanZoom {
  /**
   * @param {HTMLElement | SVGElement} target receives the events
   * @param {object} options
   * @param {() => {width: number, height: number}} options.size of the picture; 0 for none
   * @param {() => [number, number]} options.limits of the scale
   * @param {(isZoomed: boolean) => void} options.changed called when its position or scale has changed
   * @param {number} [options.largestFit] the largest scale to fit a small picture
   * @param {() => number} [options.unit] of the scale and the place [1/px]
   */
  constructor(target, { size, limits, changed, largestFit = Infinity, unit = () => 1 }) {
    this.target = target;
    this.size = size;
    this.limits = limits;
    this.changed = changed;
    this.largestFit = largestFit;
    this.unit = unit;
    this.scale = 1;
    this.left = 0;
    this.top = 0;
    /** True while the picture follows the size of the element. */
    this.isFitted = true;
    /** The distance that the pressed pointer has moved [px]: a click moves less than a drag. */
    this.moved = 0;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    const on = /** @type {(type: string, take: (event: any) => void, options?: object) => void} */ (
      target.addEventListener.bind(target)
    );
    on("wheel", (event) => this.wheel(event), { passive: false });
    on("pointerdown", (event) => this.press(event));
    on("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) on(end, (event) => this.pointers.delete(event.pointerId));
    on("keydown", (event) => this.key(event));
    this.observer = new ResizeObserver(() => this.isFitted && this.fit());
    this.observer.observe(target);
  }

  close() {
    this.observer.disconnect();
  }

  get isDragged() {
    return this.moved >= FAR;
  }

  /** Return the size of the element. */
  room() {
    const unit = this.unit();
    return { width: Math.round(this.target.clientWidth * unit), height: Math.round(this.target.clientHeight * unit) };
  }

  /** Fit the whole picture into the element. */
  fit() {
    const [{ width, height }, room] = [this.size(), this.room()];
    this.isFitted = true;
    if (!width || !height || !room.width || !room.height) return;
    this.scale = Math.min(this.largestFit, room.width / width, room.height / height);
    this.left = (room.width - width * this.scale) / 2;
    this.top = (room.height - height * this.scale) / 2;
    this.changed(true);
  }

  /**
   * Zoom about a point of the element, by default its centre.
   * @param {number} scale
   * @param {number} [x]
   * @param {number} [y]
   */
  zoomTo(scale, x = this.room().width / 2, y = this.room().height / 2) {
    const [least, most] = this.limits();
    const to = Math.max(least, Math.min(most, scale));
    this.left = x - ((x - this.left) * to) / this.scale;
    this.top = y - ((y - this.top) * to) / this.scale;
    this.scale = to;
    this.isFitted = false;
    this.changed(true);
  }

  /** @param {number} right @param {number} down */
  shift(right, down) {
    this.left += right;
    this.top += down;
    this.isFitted = false;
    this.changed(false);
  }

  /** Return the position of an event in the element. @param {MouseEvent} event */
  place(event) {
    const box = this.target.getBoundingClientRect();
    const unit = this.unit();
    return { x: (event.clientX - box.left) * unit, y: (event.clientY - box.top) * unit };
  }

  /** Return the point of the picture at an event. @param {MouseEvent} event */
  point(event) {
    const { x, y } = this.place(event);
    return { x: (x - this.left) / this.scale, y: (y - this.top) / this.scale };
  }

  /** @param {PointerEvent} event */
  press(event) {
    if (event.button) return;
    this.pointers.set(event.pointerId, this.place(event));
    this.moved = 0;
  }

  /** @param {PointerEvent} event */
  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    if (!(event.buttons & 1)) {
      this.pointers.delete(event.pointerId); // it was released elsewhere
      return;
    }
    const now = this.place(event);
    this.pointers.set(event.pointerId, now);
    this.moved += (Math.abs(now.x - before.x) + Math.abs(now.y - before.y)) / this.unit();
    if (!this.isDragged) return;
    if (!this.target.hasPointerCapture(event.pointerId)) this.target.setPointerCapture(event.pointerId);
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (!other) this.shift(now.x - before.x, now.y - before.y);
    else {
      const apart = Math.max(1, Math.hypot(before.x - other.x, before.y - other.y));
      this.zoomTo((this.scale * Math.hypot(now.x - other.x, now.y - other.y)) / apart, other.x, other.y);
    }
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const { x, y } = this.place(event);
    const way = event.deltaY * (event.deltaMode ? 33 : 1); // lines, or pixels
    this.zoomTo(this.scale * STEP ** (-way / 100), x, y);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.key === "+" || event.key === "=") this.zoomTo(this.scale * STEP);
    else if (event.key === "-") this.zoomTo(this.scale / STEP);
    else if (event.key === "0") this.fit();
    else if (event.key === "1") this.zoomTo(1);
    else return;
    event.preventDefault();
  }
}
