// The buttons of a simulator: pause, step, reset, rate; and its time.

import { button, element, fill, icon, iconButton, set, write } from "../../elements.js";
import { mistakeText } from "../../texts.js";

const RATES = ["0.1", "0.25", "0.5", "1", "2", "4", "10", "0"];

/** The simulator's part of the tools. */
export class Simulator {
  /**
   * @param {import("../../context.js").Context} context
   * @param {(text: string) => void} tell
   */
  constructor(context, tell) {
    this.context = context;
    this.tell = tell;
    /** The full names of simulators, the one that is controlled first. */
    this.nodes = /** @type {string[]} */ ([]);
    this.isPaused = false;
    /** Messages since the last one whose time was that of the one before. */
    this.advances = 0;
    this.time = NaN;
    this.pause = iconButton("pause", "Pause", () => this.toggle());
    this.step = button("Step", () => this.call("step", { steps: 24 }), { title: "Do 24 steps while paused" });
    this.reset = button("Reset", () => this.call("reset"), { title: "Start again" });
    this.rate = element(
      "select",
      { "aria-label": "Rate of simulated time", title: "Rate of simulated time", onchange: () => this.call("set_rate", { rate: Number(this.rate.value) }) },
      RATES.map((rate) => element("option", { value: rate }, rate === "0" ? "fastest" : `${rate} ×`)),
    );
    this.rate.value = "1";
    this.clock = element("output", { class: "number", "aria-label": "Simulated time" });
    this.element = element(
      "div",
      { class: "world-simulator", role: "group", "aria-label": "Simulator" },
      this.pause,
      this.step,
      this.reset,
      this.rate,
      this.clock,
    );
    context.onChange(() => this.show());
  }

  /** @param {string[]} nodes */
  setNodes(nodes) {
    this.nodes = nodes;
    this.show();
  }

  /**
   * Take the time of a message; the same one twice means that it is paused.
   * @param {string} topic
   * @param {number} stamp [s]
   */
  take(topic, stamp) {
    if (!this.nodes.some((node) => topic.startsWith(`${node}/`))) return;
    this.advances = stamp === this.time ? 0 : this.advances + 1;
    const isPaused = this.advances === 0 || (this.isPaused && this.advances < 2);
    this.time = stamp;
    write(this.clock, `${stamp.toFixed(1)} s`);
    if (isPaused !== this.isPaused) {
      this.isPaused = isPaused;
      this.show();
    }
  }

  show() {
    const may = this.context.canCommand;
    this.element.hidden = !this.nodes.length;
    const label = this.isPaused ? "Resume" : "Pause";
    set(this.pause, "aria-label", label);
    set(this.pause, "title", label);
    fill(this.pause, icon(this.isPaused ? "play" : "pause"));
    this.pause.disabled = this.reset.disabled = this.rate.disabled = !may;
    this.step.disabled = !may || !this.isPaused;
  }

  async toggle() {
    const verb = this.isPaused ? "resume" : "pause";
    if (await this.call(verb)) {
      this.isPaused = verb === "pause";
      this.show();
    }
  }

  /**
   * Let the simulators do something; the first one's answer counts.
   * @param {string} verb
   * @param {object} [fields]
   * @param {string} [node]
   */
  async call(verb, fields = {}, node = this.nodes[0]) {
    try {
      const { message } = await this.context.do("simulate", { node, verb, ...fields });
      this.advances = 0;
      this.tell(verb === "set_pose" ? "" : message);
      return true;
    } catch (error) {
      this.tell(mistakeText(error));
      return false;
    }
  }
}
