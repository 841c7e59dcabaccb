// The images of a topic: colour, grey and depth, with the value under the pointer.

import { button, element, iconButton, offer, selection, set, write } from "../elements.js";
import { fileTimeText, mistakeText, rateText } from "../texts.js";
import { choiceField } from "./choice.js";
import { mix, readPicture } from "./pixels.js";
import { fileName, savePicture } from "./save.js";
import { stylesheet } from "./stylesheet.js";
import { Viewport } from "./viewport.js";

/** @typedef {import("./pixels.js").Picture} Picture */

const RATE_TIME = 2; // [s] over which the rate is measured
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const LARGE_STEP = 10; // pixels, with Shift

/** The image panel. */
export default class ImagePanel {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    stylesheet("./image.css");
    this.context = context;
    this.topic = typeof settings.topic === "string" ? settings.topic : "";
    this.map = typeof settings.map === "string" ? settings.map : "warm";
    /** The limits of a fixed scale [m, or grey]; null if it adapts to each picture. */
    this.fixed = readScale(settings.near, settings.far);
    /** The highest rate of pictures [Hz]; undefined for as many as can be shown. @type {number | undefined} */
    this.rate = Number.isFinite(settings.rate) && settings.rate > 0 ? Number(settings.rate) : undefined;
    /** @type {Record<string, number[][]>} */
    this.maps = { warm: [[255, 255, 255], [0, 0, 0]] };
    /** @type {Picture | null} */
    this.picture = null;
    this.isPaused = false;
    this.isReading = false;
    /** The newest image that has not been decoded yet. @type {{header: any, payload: ArrayBuffer} | null} */
    this.waiting = null;
    /** @type {{count: number, time: number}[]} */
    this.arrivals = [];
    /** The pixel with the shown value. @type {{x: number, y: number} | null} */
    this.mark = null;
    this.canvas = document.createElement("canvas");
    const choice = choiceField({
      label: "Topic of images",
      value: this.topic,
      placeholder: "/camera/image_raw",
      suggest: () => this.context.ask("topics", { kind: "image" }),
      choose: (topic) => this.choose(topic),
      fills: true,
    });
    this.viewport = new Viewport({
      draw: (context) => context.drawImage(this.canvas, 0, 0, this.size.width, this.size.height),
      size: () => this.size,
      point: (x, y) => this.point(x, y),
      zoomed: () => this.askForPixels(),
    });
    this.viewport.element.addEventListener("keydown", (event) => this.key(event));
    this.pauseButton = iconButton("pause", "Pause", () => this.pause(!this.isPaused), { "aria-pressed": "false" });
    this.mapChoice = selection("Colours of depth", [], "", (name) => {
      this.map = name;
      this.show();
      context.changed();
    });
    const onchange = () => this.setScale(this.automatic.checked);
    this.automatic = element("input", { type: "checkbox", checked: !this.fixed, onchange });
    this.near = this.scaleInput("Value of the first colour");
    this.far = this.scaleInput("Value of the last colour");
    this.bar = element("span", { class: "legend-bar", "aria-hidden": "true" });
    this.unit = element("small", {});
    const auto = element("label", {}, this.automatic, "Auto");
    this.legend = element("div", { class: "legend" }, this.near, this.bar, this.far, this.unit, auto, this.mapChoice);
    this.legend.hidden = true;
    this.reading = element("output", { class: "mono reading-at", "aria-label": "Value at the pointer" });
    this.about = element("span", { class: "muted" });
    this.element = this.layOut(choice.element);
    this.pixels = 0;
    this.stream = context.open("image", this.wanted(), (data, payload) => this.receive(data, payload));
    context.ask("color maps").then((maps) => this.setMaps(maps), () => {});
  }

  get title() {
    return this.topic ? `Image ${this.topic}` : "Image";
  }

  settings() {
    return { topic: this.topic, map: this.map, rate: this.rate, ...this.fixed };
  }

  close() {
    this.viewport.close();
  }

  /** @param {HTMLElement} choice */
  layOut(choice) {
    return element(
      "div",
      { class: "image" },
      element(
        "div",
        { class: "tools" },
        choice,
        element("span", { class: "space" }),
        this.pauseButton,
        iconButton("smaller", "Fit the picture into the panel (0)", () => this.viewport.view.fit()),
        button("1:1", () => this.viewport.view.zoomTo(1), { title: "One pixel of the picture as one of the screen (1)" }),
        iconButton("save", "Save as PNG", () => this.save()),
      ),
      this.viewport.element,
      this.legend,
      element("div", { class: "image-status" }, this.reading, element("span", { class: "space" }), this.about),
    );
  }

  /** @param {string} label */
  scaleInput(label) {
    return element("input", {
      type: "number",
      step: 0.1,
      class: "mono",
      "aria-label": label,
      title: label,
      onchange: () => {
        this.automatic.checked = false;
        this.setScale(false);
      },
    });
  }

  get size() {
    return { width: this.picture?.width ?? 0, height: this.picture?.height ?? 0 };
  }

  /** Return the stream's parameters, which request no more pixels than are visible. */
  wanted() {
    const { width, height } = this.size;
    const step = Math.max(1, Math.floor(1 / this.viewport.view.scale));
    const room = this.viewport.room();
    this.pixels = width ? Math.ceil((width * height) / step ** 2) : room;
    return { topic: this.topic, pixels: Math.max(1000, this.pixels), rate: this.rate, paced: true };
  }

  askForPixels() {
    const before = this.pixels;
    const parameters = this.wanted();
    if (this.pixels !== before && !this.picture?.header.file) this.stream.change(parameters);
  }

  /** @param {string} topic */
  choose(topic) {
    this.topic = topic;
    this.picture = this.waiting = null;
    this.mark = null;
    this.arrivals = [];
    this.pause(false);
    write(this.about, "");
    this.stream.change(this.wanted());
    this.show();
    this.context.changed();
  }

  /** @param {any} header @param {ArrayBuffer} [payload] */
  receive(header, payload) {
    if (header.topic !== this.topic) return this.stream.took(); // sent before the topic was changed
    this.arrivals.push({ count: header.count, time: header.time });
    const oldest = header.time - RATE_TIME;
    while (this.arrivals.length > 2 && (this.arrivals[0]?.time ?? 0) < oldest) this.arrivals.shift();
    if (!payload || this.isPaused) return this.stream.took();
    this.waiting = { header, payload };
    if (!this.isReading) this.read();
  }

  /** Decode an image with the next animation frame, and ask for the next one: a slow page keeps up. */
  async read() {
    this.isReading = true;
    await new Promise(requestAnimationFrame);
    this.stream.took();
    const { waiting } = this;
    this.waiting = null;
    try {
      const picture = waiting && (await readPicture(waiting.header, waiting.payload));
      if (picture?.header.topic === this.topic) {
        const before = this.picture;
        this.picture = picture;
        before?.bitmap?.close();
        if (!before) this.viewport.view.fit();
        this.context.showProblem(this, "");
      }
    } catch (error) {
      this.context.showProblem(this, `the image cannot be read: ${mistakeText(error)}`);
    }
    this.show();
    this.isReading = false;
    if (this.waiting) this.read();
  }

  /** @param {Record<string, number[][]>} maps */
  setMaps(maps) {
    this.maps = maps;
    if (!maps[this.map]) this.map = Object.keys(maps)[0] ?? "warm";
    offer(this.mapChoice, Object.keys(maps).map((name) => [name, name]), this.map);
    this.show();
  }

  /** @param {boolean} isAutomatic */
  setScale(isAutomatic) {
    const ends = readScale(Number(this.near.value), Number(this.far.value));
    for (const input of [this.near, this.far]) set(input, "aria-invalid", !isAutomatic && !ends);
    if (!isAutomatic && !ends) return;
    this.fixed = isAutomatic ? null : ends;
    this.show();
    this.context.changed();
  }

  scale() {
    const ends = this.fixed ?? this.picture?.usualScale() ?? { near: 0, far: 255 };
    return { ...ends, colors: this.maps[this.map] ?? [] };
  }

  /** @param {boolean} isPaused */
  pause(isPaused) {
    this.isPaused = isPaused;
    set(this.pauseButton, "aria-pressed", String(isPaused));
  }

  save() {
    if (!this.picture) return;
    const time = fileTimeText(this.picture.header.time);
    savePicture(`${fileName(this.topic)}_${time}.png`, this.canvas);
  }

  /**
   * Show the value at a point of the picture; nothing outside of it.
   * @param {number} x
   * @param {number} y
   */
  point(x, y) {
    const { width, height } = this.size;
    const isInside = x >= 0 && y >= 0 && x < width && y < height;
    this.mark = isInside ? { x: Math.floor(x), y: Math.floor(y) } : null;
    this.showReading();
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const step = STEPS[/** @type {keyof typeof STEPS} */ (event.key)];
    if (!step || !this.picture) return;
    const { width, height } = this.size;
    const far = (event.shiftKey ? LARGE_STEP : 1) * this.picture.step;
    const from = this.mark ?? { x: width >> 1, y: height >> 1 };
    const x = Math.max(0, Math.min(width - 1, from.x + (step[0] ?? 0) * far));
    const y = Math.max(0, Math.min(height - 1, from.y + (step[1] ?? 0) * far));
    this.mark = { x, y };
    this.showReading();
    this.context.announce(this.reading.value);
    event.preventDefault();
  }

  show() {
    if (this.picture) this.picture.paint(this.canvas, this.scale());
    else this.canvas.width = 0;
    this.showLegend();
    this.showReading();
    if (this.picture) write(this.about, this.aboutText(this.picture));
    this.viewport.paint(); // in this animation frame, not in the next
  }

  showLegend() {
    const isScaled = Boolean(this.picture && this.picture.kind !== "color" && this.picture.header.number !== "B");
    this.legend.hidden = !isScaled;
    if (!isScaled) return;
    const isDepth = this.picture?.kind === "depth";
    const { near, far, colors } = this.scale();
    for (const [input, value] of /** @type {const} */ ([[this.near, near], [this.far, far]])) {
      if (document.activeElement !== input && this.automatic.checked) input.value = String(Math.round(value * 100) / 100);
      else if (this.fixed && document.activeElement !== input) input.value = String(value);
    }
    const stops = isDepth ? Array.from({ length: 9 }, (_, index) => mix(colors, index / 8)) : [[0, 0, 0], [255, 255, 255]];
    this.bar.style.background = `linear-gradient(to right, ${stops.map((stop) => `rgb(${stop.join(" ")})`).join(", ")})`;
    write(this.unit, isDepth ? "m" : "");
    this.mapChoice.hidden = !isDepth;
  }

  showReading() {
    const text = this.mark && this.picture ? this.readingText(this.picture, this.mark) : "";
    write(this.reading, text);
    this.viewport.mark(this.mark, this.picture?.step ?? 1);
  }

  /** @param {Picture} picture @param {{x: number, y: number}} mark */
  readingText(picture, { x, y }) {
    const [column, row] = [Math.floor(x / picture.step), Math.floor(y / picture.step)];
    const at = `(${column * picture.step}, ${row * picture.step})`;
    const value = picture.value(column, row);
    if (value === null) {
      const [red, green, blue] = this.canvas.getContext("2d")?.getImageData(column, row, 1, 1).data ?? [];
      return `${at}  R ${red}  G ${green}  B ${blue}`;
    }
    if (picture.kind === "grey") return `${at}  ${value}`;
    return Number.isNaN(value) ? `${at}  no value` : `${at}  ${value.toFixed(3)} m`;
  }

  /** @param {Picture} picture */
  aboutText({ width, height, step, header }) {
    const [first, last] = [this.arrivals[0], this.arrivals.at(-1)];
    const time = first && last ? last.time - first.time : 0;
    const rate = first && last && time > 0 ? rateText((last.count - first.count) / time) : "";
    const part = step > 1 ? `1:${step}` : "";
    const size = header.bytes < 1e6 ? `${Math.round(header.bytes / 1000)} kB` : `${(header.bytes / 1e6).toFixed(1)} MB`;
    return [`${width} × ${height}`, header.encoding, size, rate, part, header.frame].filter(Boolean).join(" · ");
  }
}

/**
 * Return the limits of a scale, or null if they are invalid.
 * @param {any} near
 * @param {any} far
 */
function readScale(near, far) {
  const isScale = Number.isFinite(near) && Number.isFinite(far) && near < far;
  return isScale ? { near: Number(near), far: Number(far) } : null;
}
