// The timeline of a log, at the bottom of the page: play, pause, step, rate and seeking.

import { div, drawing, element, fill, iconButton, relabel, selection, set, write } from "./elements.js";
import { clockText } from "./texts.js";

/**
 * @typedef {{time: number, length: number, rate: number, isPaused: boolean, isOver: boolean}} Position
 * @typedef {{start: number, length: number, histogram: number[], losses: number[]}} About
 */

const RATES = [1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8, 16];
const STEP = 5; // [s] of the arrow keys
const SMALL_STEP = 0.5; // with Shift
const OFTEN = 60; // [ms] between two seek requests while the pointer moves
const PLAYING = "button, input, select, textarea, [contenteditable], [role=tree], [role=grid], svg";

/** The timeline. */
export class Timeline {
  /** @param {import("./connection.js").Connection} connection */
  constructor(connection) {
    this.connection = connection;
    /** @type {About | null} */
    this.about = null;
    /** @type {Position | null} */
    this.position = null;
    this.received = 0;
    this.isDragged = false;
    this.nextSeek = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.bars = drawing("svg", { class: "timeline-bars", preserveAspectRatio: "none", "aria-hidden": "true" });
    this.done = div("timeline-done");
    this.hand = div("timeline-hand");
    const drop = () => (this.isDragged = false);
    this.track = element(
      "div",
      {
        class: "timeline-track",
        role: "slider",
        tabindex: 0,
        "aria-label": "Time in the log",
        "aria-valuemin": 0,
        onpointerdown: (/** @type {PointerEvent} */ event) => this.press(event),
        onpointermove: (/** @type {PointerEvent} */ event) => this.drag(event),
        onpointerup: drop,
        onpointercancel: drop,
      },
      this.bars,
      this.done,
      this.hand,
    );
    this.play = iconButton("play", "Play (Space)", () => this.toggle());
    this.stepper = iconButton("step", "One message (.)", () => this.act("step"));
    const rates = /** @type {[string, string][]} */ (RATES.map((rate) => [String(rate), rateText(rate)]));
    this.rate = selection("Rate", rates, "1", (rate) => this.act("rate", { rate: Number(rate) }));
    this.rate.title = "Rate (< and >)";
    this.clock = element("span", { class: "mono timeline-clock" });
    this.date = element("span", { class: "mono muted timeline-date" });
    const times = div("timeline-times", this.clock, this.date);
    const parts = [this.play, this.stepper, this.rate, this.track, times];
    this.element = element("footer", { class: "timeline", "aria-label": "Playing the log", hidden: true }, parts);
    connection.addEventListener("change", () => this.update());
    addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(this.track);
    this.update();
  }

  get mayPlay() {
    return this.connection.isOpen && Boolean(this.connection.hello?.rights.includes("play"));
  }

  get isStill() {
    return this.position?.isPaused !== false || this.position.isOver;
  }

  /** Update the state of the log; request its histogram first. */
  update() {
    const { hello, state, isOpen } = this.connection;
    this.element.hidden = hello?.source !== "log";
    if (this.element.hidden) return;
    if (!this.about && isOpen) this.ask();
    for (const part of [this.play, this.stepper, this.rate]) part.disabled = !this.mayPlay;
    set(this.track, "aria-disabled", String(!this.mayPlay));
    if (state.log && state.log !== this.position) {
      this.position = state.log;
      this.received = performance.now();
      this.showState(state.log);
    }
  }

  async ask() {
    try {
      this.about = await this.connection.request("ask", "timeline", {});
      this.draw();
      this.follow();
    } catch {
      this.about = null; // it is requested again after reconnecting
    }
  }

  /** @param {Position} position */
  showState({ rate, length }) {
    if (this.isStill) relabel(this.play, "play", "Play (Space)");
    else relabel(this.play, "pause", "Pause (Space)");
    const nearest = RATES.reduce((best, one) => (Math.abs(one - rate) < Math.abs(best - rate) ? one : best), 1);
    if (document.activeElement !== this.rate) this.rate.value = String(nearest);
    set(this.track, "aria-valuemax", length.toFixed(1));
  }

  /** Move the playhead at the log's rate between two updates, so that it does not jump. */
  follow() {
    if (!this.isDragged && this.about) this.showAt(this.now());
    requestAnimationFrame(() => this.follow());
  }

  /** Return the present time in the log [s]. */
  now() {
    const { position } = this;
    if (!position) return 0;
    const isMoving = !this.isStill && this.connection.isOpen;
    const since = isMoving ? ((performance.now() - this.received) / 1000) * position.rate : 0;
    return Math.min(position.time + Math.min(since, position.rate), position.length);
  }

  /** @param {number} time */
  showAt(time) {
    const { start = 0, length = 1 } = this.about ?? {};
    const part = `${((100 * time) / Math.max(length, 1e-9)).toFixed(3)}%`;
    this.hand.style.left = this.done.style.width = part;
    write(this.clock, `${timeText(time)} / ${timeText(length)}`);
    write(this.date, dateText(start + time));
    set(this.track, "aria-valuenow", time.toFixed(1));
    set(this.track, "aria-valuetext", `${timeText(time)} of ${timeText(length)}`);
  }

  /** Draw the histogram of messages, the gaps and the losses. */
  draw() {
    const { about } = this;
    if (!about) return;
    const { histogram, losses, length } = about;
    const bins = histogram.length;
    const most = Math.max(1, ...histogram);
    set(this.bars, "viewBox", `0 0 ${bins} 100`);
    const high = histogram.map((count) => (count ? Math.max(8, 92 * Math.sqrt(count / most)) : 0));
    fill(
      this.bars,
      drawing("path", { class: "bars", d: high.map((value, at) => (value ? `M${at} 100V${100 - value}H${at + 0.86}V100Z` : "")).join("") }),
      gaps(histogram).map(([from, to]) =>
        drawing("rect", { class: "gap", x: from, y: 0, width: to - from, height: 100 }, drawing("title", {}, "no messages")),
      ),
      losses.map((time) => drawing("rect", { class: "loss", x: (bins * time) / Math.max(length, 1e-9) - 0.4, y: 0, width: 0.8, height: 16 })),
    );
  }

  /** @param {PointerEvent} event */
  press(event) {
    if (!this.mayPlay || event.button) return;
    this.isDragged = true;
    this.track.setPointerCapture(event.pointerId);
    this.drag(event);
  }

  /** @param {PointerEvent} event */
  drag(event) {
    if (!this.isDragged || !this.about) return;
    const { left, width } = this.track.getBoundingClientRect();
    const part = (event.clientX - left) / Math.max(1, width);
    const time = this.about.length * Math.min(1, Math.max(0, part));
    this.showAt(time);
    clearTimeout(this.timer);
    const wait = Math.max(0, this.nextSeek - performance.now());
    this.timer = setTimeout(() => this.seek(time), wait);
    if (!wait) this.nextSeek = performance.now() + OFTEN;
  }

  /** @param {number} time */
  seek(time) {
    const now = performance.now();
    this.nextSeek = now + OFTEN;
    const within = Math.min(this.position?.length ?? 0, Math.max(0, time));
    if (this.position) this.position = { ...this.position, time: within, isOver: false };
    this.received = now;
    this.act("seek", { time: within });
  }

  toggle() {
    this.act(this.isStill ? "play" : "pause");
  }

  /** @param {number} step */
  changeRate(step) {
    const at = RATES.indexOf(Number(this.rate.value));
    const rate = RATES[Math.min(RATES.length - 1, Math.max(0, at + step))] ?? 1;
    this.rate.value = String(rate);
    this.act("rate", { rate });
  }

  /** @param {string} action @param {object} [more] */
  async act(action, more = {}) {
    // the page shows that the connection is lost
    if (this.mayPlay) await this.connection.request("do", "play", { action, ...more }).catch(() => {});
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const target = event.target instanceof Element ? event.target : null;
    const isOwn = target === this.track;
    if (this.element.hidden || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!isOwn && target?.closest(PLAYING)) return;
    const step = event.shiftKey ? SMALL_STEP : STEP;
    if (event.key === " ") this.toggle();
    else if (event.key === "ArrowLeft") this.seek(this.now() - step);
    else if (event.key === "ArrowRight") this.seek(this.now() + step);
    else if (isOwn && event.key === "Home") this.seek(0);
    else if (isOwn && event.key === "End") this.seek(this.position?.length ?? 0);
    else if (event.key === ".") this.act("step");
    else if (event.key === "<") this.changeRate(-1);
    else if (event.key === ">") this.changeRate(1);
    else return;
    event.preventDefault();
  }
}

/**
 * Return the gaps without messages, from and to, except single empty bins of a sparse log.
 * @param {number[]} histogram
 */
function gaps(histogram) {
  /** @type {[number, number][]} */
  const found = [];
  histogram.forEach((count, at) => {
    const last = found.at(-1);
    if (count) return;
    if (last?.[1] === at) last[1] = at + 1;
    else found.push([at, at + 1]);
  });
  return found.filter(([from, to]) => to - from > 1);
}

/** @param {number} rate */
function rateText(rate) {
  return rate < 1 ? `1/${Math.round(1 / rate)} ×` : `${rate} ×`;
}

/** @param {number} seconds */
function timeText(seconds) {
  const [hours, minutes] = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60];
  const rest = (seconds % 60).toFixed(1).padStart(4, "0");
  return `${hours ? `${hours}:${String(minutes).padStart(2, "0")}` : minutes}:${rest}`;
}

/** @param {number} time [s since 1970] */
function dateText(time) {
  const date = new Date(time * 1000);
  const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const day = [date.getFullYear(), two(date.getMonth() + 1), two(date.getDate())].join("-");
  return `${day} ${clockText(time).slice(0, 8)}`;
}
