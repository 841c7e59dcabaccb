// The world in 3D: robots, sensor data, and poses to send.

import { button, element, iconButton, more, offer, selection, set, write } from "../elements.js";
import { ageText, mistakeText } from "../texts.js";
import { hexColor, isDark, onTheme } from "../theme.js";
import { stylesheet } from "./stylesheet.js";
import { Axes } from "./world/axes.js";
import { Bodies, bodyText } from "./world/bodies.js";
import { Camera } from "./world/camera.js";
import { Display } from "./world/displays.js";
import { KINDS } from "./world/drawings.js";
import { Frames } from "./world/frames.js";
import { hasPlace, withNumbers } from "./world/numbers.js";
import { Pointing } from "./world/pointing.js";
import { Sidebar } from "./world/sidebar.js";
import { Simulator } from "./world/simulator.js";
import { View } from "./world/view.js";

/**
 * @typedef {import("./world/frames.js").Pose} Pose
 * @typedef {{topic: string, type: string, kind: string, silence: number | null}} Topic silence [s] of
 *   a topic that was sent repeatedly
 * @typedef {"look" | "move" | "pose"} Tool
 */

const TOOLS = /** @type {[Tool, string, string][]} */ ([
  ["look", "Look", "Turn the view: drag; move it: right button or Shift; closer: wheel"],
  ["move", "Move", "Drag robots and crates; Shift turns them"],
  ["pose", "Send pose", "Click a place and draw the heading: a goal (/goal), or an initial pose (/initialpose), as in RViz"],
]);
const SERIES = 8;
const SMOOTH = 200; // [ms] that the view keeps drawing after a message
const TOLD = 200; // [ms] between two updates of the poses in the list

/** The world panel. */
export default class World {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    stylesheet("world.css");
    this.context = context;
    this.title = "World";
    this.kept = { fixed: "", follow: null, goal: "/goal", side: true, axes: false, shown: {}, colors: {}, camera: null, ...settings };
    this.frames = new Frames();
    /** By topic. @type {Map<string, Display>} */
    this.displays = new Map();
    /** @type {Topic[]} */
    this.topics = [];
    this.tool = /** @type {Tool} */ ("look");
    this.bodies = new Bodies(this.displays, this.frames);
    /** The topics whose status is a problem. @type {Set<string>} */
    this.isBad = new Set();
    this.listed = "";
    this.message = element("p", { class: "world-message", role: "status", hidden: true });
    this.stage = element("div", {
      class: "world-stage",
      tabindex: 0,
      role: "application",
      "aria-label": "World in 3D: arrow keys turn the view, plus and minus change the distance, the list has the poses",
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.camera?.press(event),
    });
    this.simulator = new Simulator(context, (text) => this.say(text));
    this.sidebar = new Sidebar(this);
    this.toolButtons = TOOLS.map(([tool, name, title]) => button(name, () => this.choose(tool), { title }));
    this.goal = element("input", {
      type: "text",
      class: "mono",
      value: this.kept.goal,
      "aria-label": "Topic of the pose",
      title: "Topic of the pose (geometry_msgs/PoseStamped)",
      onchange: () => {
        this.kept.goal = this.goal.value.trim() || "/goal";
        context.changed();
      },
    });
    this.fixedChoice = selection("Fixed frame", [], "", (name) => {
      this.kept.fixed = this.bodies.fixed = name;
      this.changed();
    });
    this.followChoice = selection("The camera follows", [], "", (name) => this.camera?.setFollowed(name));
    set(this.followChoice, "aria-label", "Follow");
    this.axesButton = button("Frames", () => this.toggle("axes"), { title: "Show the frames as axes: x red, y green, z blue" });
    this.side = iconButton("settings", "Displays and poses", () => this.toggle("side"));
    this.element = element("div", { class: "world" }, this.tools(), element("div", { class: "world-room" }, this.stage, this.sidebar.element));
    this.stage.append(this.message);
    this.begin();
    this.timer = setInterval(() => this.listPoses(performance.now()), TOLD);
    context.open("drawable", {}, (data) => this.setTopics(data));
    context.onChange(() => this.showTools());
  }

  /** Start drawing if the browser supports WebGL. */
  begin() {
    try {
      this.view = new View(this.stage);
    } catch {
      this.stage.append(
        element("p", { class: "empty" }, "This browser has no WebGL, which the view needs: the list has the poses."),
      );
      return;
    }
    const { view } = this;
    view.beforeDrawing = (now) => this.place(now);
    view.onPlain = () => this.displays.forEach((display) => display.make());
    this.axes = new Axes(view.scene);
    this.camera = new Camera(view, this.bodies, this.kept, () => this.context.changed());
    const theme = () => view.setTheme(isDark());
    onTheme(theme, this.context.signal);
    theme();
    this.pointing = new Pointing(this, view);
  }

  tools() {
    return element(
      "div",
      { class: "tools world-tools" },
      element("div", { class: "world-choice", role: "group", "aria-label": "Pointer" }, this.toolButtons, this.goal),
      more(
        "More …",
        "The camera, the frames, and simulated time",
        element("label", {}, "Follow ", this.followChoice),
        element("label", {}, "Fixed frame ", this.fixedChoice),
        button("Top", () => this.camera?.lookFromAbove(), { title: "Look from above" }),
        this.axesButton,
        button("Reset view", () => this.camera?.reset(), { title: "Back to the initial view" }),
        this.simulator.others,
      ),
      this.simulator.element,
      element("span", { class: "space" }),
      this.side,
    );
  }

  showTools() {
    const may = this.context.canCommand && this.context.source === "bus";
    TOOLS.forEach(([tool], index) => {
      const one = /** @type {HTMLButtonElement} */ (this.toolButtons[index]);
      set(one, "aria-pressed", String(tool === this.tool));
      one.disabled = tool !== "look" && !may;
    });
    this.goal.hidden = this.tool !== "pose";
    set(this.side, "aria-pressed", String(this.kept.side));
    set(this.axesButton, "aria-pressed", String(this.kept.axes));
    this.sidebar.element.classList.toggle("is-folded", !this.kept.side);
    this.stage.dataset["tool"] = may ? this.tool : "look";
  }

  /** @param {Tool} tool */
  choose(tool) {
    this.tool = tool;
    this.showTools();
  }

  /** @param {"axes" | "side"} name */
  toggle(name) {
    this.kept[name] = !this.kept[name];
    this.showTools();
    this.changed();
  }

  /** Draw again, and save the settings. */
  changed() {
    this.view?.invalidate();
    this.context.changed();
  }

  /** @param {{topics: Topic[], undrawn: string[], simulators: string[]}} data */
  setTopics({ topics, undrawn, simulators }) {
    this.topics = topics;
    const silent = topics.filter(({ silence }) => silence !== null).map(({ topic }) => topic);
    if (String(silent) !== String([...this.frames.silent])) this.view?.invalidate();
    this.frames.silent = new Set(silent);
    this.simulator.setNodes(simulators);
    const names = new Set(topics.map(({ topic }) => topic));
    for (const topic of this.displays.keys()) if (!names.has(topic)) this.hide(topic);
    for (const topic of topics) if (this.isShown(topic)) this.open(topic);
    const key = JSON.stringify(topics.map(({ topic, type }) => [topic, type]));
    if (key !== this.listed) {
      this.listed = key;
      this.sidebar.setTopics(topics);
    }
    this.sidebar.setUndrawn(undrawn);
  }

  /** @param {{topic: string, kind: string}} topic */
  isShown({ topic, kind }) {
    return this.kept.shown[topic] ?? !KINDS[kind]?.isOff;
  }

  /** @param {{topic: string}} topic */
  colorOf({ topic }) {
    const colored = this.topics.filter(({ kind }) => KINDS[kind]?.hasColor).map((one) => one.topic);
    return this.kept.colors[topic] ?? hexColor(`--series-${(Math.max(0, colored.indexOf(topic)) % SERIES) + 1}`);
  }

  /** @param {Topic} topic @param {boolean} isShown */
  show(topic, isShown) {
    this.kept.shown[topic.topic] = isShown;
    if (isShown) this.open(topic);
    else this.hide(topic.topic);
    this.changed();
  }

  /** @param {{topic: string}} topic @param {string} chosen */
  paint({ topic }, chosen) {
    this.kept.colors[topic] = chosen;
    this.displays.get(topic)?.paint(chosen);
    this.changed();
  }

  /** @param {Topic} topic */
  open(topic) {
    const kind = KINDS[topic.kind];
    if (!kind || this.displays.has(topic.topic)) return;
    const display = new Display(topic.topic, topic.type);
    display.color = this.colorOf(topic);
    display.isPainted = topic.topic in this.kept.colors;
    display.stream = this.context.connection.open(
      kind.stream ?? "newest",
      { topic: topic.topic },
      (data, payload) => this.receive(display, data, payload),
      (problem) => (display.problem = problem),
    );
    this.displays.set(topic.topic, display);
  }

  /** @param {string} topic */
  hide(topic) {
    const found = this.displays.get(topic);
    if (!found) return;
    found.close();
    this.displays.delete(topic);
    this.frames.replace(topic, { frames: [], old: [] }, [], 0);
    this.sidebar.setStatus(topic, "", false);
  }

  /** @param {Display} display @param {any} sent @param {ArrayBuffer} [payload] */
  receive(display, sent, payload) {
    const now = performance.now();
    const data = withNumbers(sent);
    let hasChanged = false;
    if (data.kind === "frames") {
      const before = this.frames.frames.size;
      hasChanged = this.frames.replace(display.topic, data, Array.from(new Float32Array(payload ?? [])), now);
      this.simulator.updateTime(display.topic, data.stamp);
      if (this.frames.frames.size !== before) this.offerFrames();
    } else {
      if (data.kind === "odometry" && data.child && hasPlace(data)) {
        this.frames.add(display.topic, data.frame, data.child, data.pose, now, true);
      }
      // a simulator also paints the paths that it publishes
      if (data.kind === "markers") data.markers = data.markers.filter((/** @type {any} */ { ns }) => !this.isPath(ns));
      hasChanged = display.receive(data, payload);
      display.leaveTrail(this.frames, this.bodies.fixed, now);
    }
    if (hasChanged) this.view?.invalidate(SMOOTH);
  }

  /** @param {string} name */
  isPath(name) {
    return this.topics.some(({ topic, kind }) => topic === name && kind === "path");
  }

  offerFrames() {
    const names = this.frames.names();
    const fixed = names.includes(this.kept.fixed) ? this.kept.fixed : this.frames.root();
    this.bodies.fixed = fixed;
    const followed = this.camera?.name ?? "";
    const shown = new Set([...names.filter((name) => !name.startsWith("ground_truth/")), fixed]);
    const bodies = new Set(["", ...this.bodies.list().map(({ name }) => name), followed]);
    offer(this.fixedChoice, [...shown].map((name) => [name, name]), fixed);
    offer(this.followChoice, [...bodies].map((name) => [name, bodyText(name) || "nothing"]), followed);
  }

  /** Place all displays at their poses. @param {number} now */
  place(now) {
    const { view } = this;
    if (!view) return;
    for (const display of this.displays.values()) display.place(view.content, this.frames, this.bodies, now);
    this.axes?.place(this.kept.axes ? this.frames : null, this.bodies.fixed, now);
    view.ground.visible = !view.content.children.some((/** @type {any} */ one) => one.userData.isGround);
    this.camera?.follow(now);
  }

  /** @param {number} now */
  listPoses(now) {
    const bodies = this.bodies.list().flatMap((body) => {
      const pose = this.bodies.poseOf(body, now);
      return pose ? [{ name: body.name, pose }] : [];
    });
    this.sidebar.setBodies(bodies);
    for (const [topic, display] of this.displays) {
      const silence = this.topics.find((one) => one.topic === topic)?.silence ?? null;
      const age = silence === null ? "" : `old: the last message came ${ageText(silence)} ago`;
      const fault = display.problem || display.lost || age;
      const text = fault || display.status;
      const isBad = Boolean(fault) || display.status.includes("not drawn");
      if (text || this.isBad.has(topic)) this.sidebar.setStatus(topic, text || (KINDS[display.latest?.kind]?.name ?? ""), isBad);
      this.isBad[isBad ? "add" : "delete"](topic);
    }
    if (this.followChoice.options.length !== bodies.length + 1) this.offerFrames();
    if (this.camera && !this.camera.hasLooked && bodies.length) this.camera.reset();
  }

  /** @param {Pose} pose */
  async sendPose([x, y, , , , qz, qw]) {
    const topic = this.kept.goal;
    try {
      await this.context.do("send-pose", { topic, frame: this.bodies.fixed, x, y, qz, qw });
      this.say(`sent x ${x.toFixed(2)} m, y ${y.toFixed(2)} m on ${topic}`);
    } catch (error) {
      this.say(mistakeText(error));
    }
  }

  /** @param {string} text */
  say(text) {
    write(this.message, text);
    this.message.hidden = !text;
    clearTimeout(this.silence);
    this.silence = setTimeout(() => (this.message.hidden = true), 4000);
  }

  settings() {
    return this.kept;
  }

  close() {
    clearInterval(this.timer);
    clearTimeout(this.silence);
    for (const topic of [...this.displays.keys()]) this.hide(topic);
    this.view?.close();
  }
}

