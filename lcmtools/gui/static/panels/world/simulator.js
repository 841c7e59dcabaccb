// The controls of a simulator: pause, step, reset and rate; and its time.

import { button, element, fill, icon, iconButton, selection, set, write } from "../../elements.js";
import { mistakeText } from "../../texts.js";

const RATES = ["0.1", "0.25", "0.5", "1", "2", "4", "10", "0"].map(
  (rate) => /** @type {[string, string]} */ ([rate, rate === "0" ? "fastest" : `${rate} ×`]),
);

/** The toolbar's controls of simulators. */
export class Simulator {
  /** @param {import("../../context.js").Context} context @param {(text: string) => void} say */
  constructor(context, say) {
    this.context = context;
    this.say = say;
    /** The simulators' full names; the first one is controlled. */
    this.nodes = /** @type {string[]} */ ([]);
    this.isPaused = false;
    /** The number of latest messages in a row that advanced the time. */
    this.advances = 0;
    this.time = NaN;
    this.pause = iconButton("pause", "Pause", () => this.toggle());
    this.step = button("Step", () => this.call("step", { steps: 24 }), { title: "Do 24 steps while paused" });
    this.reset = button("Reset", () => this.call("reset"), { title: "Start again" });
    this.rate = selection("Rate of simulated time", RATES, "1", (rate) => this.call("set_rate", { rate: Number(rate) }));
    this.clock = element("output", { class: "number", "aria-label": "Simulated time" });
    const about = { class: "world-simulator", role: "group", "aria-label": "Simulator" };
    this.element = element("div", about, this.pause, this.clock);
    this.others = [element("label", {}, "Rate ", this.rate), this.step, this.reset];
    context.onChange(() => this.show());
  }

  /** @param {string[]} nodes */
  setNodes(nodes) {
    this.nodes = nodes;
    this.show();
  }

  /**
   * Update the time from a message; an unchanged time means that the simulator is paused.
   * @param {string} topic
   * @param {number} stamp [s]
   */
  updateTime(topic, stamp) {
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
    for (const one of [this.element, ...this.others]) one.hidden = !this.nodes.length;
    for (const name of ["aria-label", "title"]) set(this.pause, name, this.isPaused ? "Resume" : "Pause");
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
   * Send a request to the simulators; the first one's response is used.
   * @param {string} verb
   * @param {object} [fields]
   * @param {string} [node]
   */
  async call(verb, fields = {}, node = this.nodes[0]) {
    try {
      const { message } = await this.context.do("simulate", { node, verb, ...fields });
      this.advances = 0;
      this.say(verb === "set_pose" ? "" : message);
      return true;
    } catch (error) {
      this.say(mistakeText(error));
      return false;
    }
  }
}
