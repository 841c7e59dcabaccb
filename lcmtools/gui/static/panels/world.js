// The world in 3D: robots, sensor data, and poses to send.

import { button, element, fill, iconButton, set, write } from "../elements.js";
import { mistakeText } from "../texts.js";
import { hexColor, isDark, onTheme } from "../theme.js";
import { stylesheet } from "./stylesheet.js";
import { Bodies } from "./world/bodies.js";
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
 * @typedef {{topic: string, type: string, kind: string, rate: number | null, silent: boolean}} Topic
 * @typedef {"look" | "move" | "pose"} Tool
 */

const TOOLS = /** @type {[Tool, string, string][]} */ ([
  ["look", "Look", "Turn the view: drag; move it: right button or Shift; closer: wheel"],
  ["move", "Move", "Drag robots and crates; Shift turns them"],
  ["pose", "Send pose", "Click a place and draw the heading: a PoseStamped is sent"],
]);
const SERIES = 8;
const SMOOTH = 200; // [ms] that the view keeps drawing after a message
const TOLD = 200; // [ms] between two updates of the poses in the list

/** The world panel. */
export default class World {
  /**
   * @param {import("../context.js").Context} context
   * @param {any} settings
   */
  constructor(context, settings) {
    stylesheet("world.css");
    this.context = context;
    this.title = "World";
    this.kept = { fixed: "", follow: "", goal: "/goal", side: true, shown: {}, colors: {}, camera: null, ...settings };
    this.frames = new Frames();
    /** @type {Map<string, {display: Display, close: () => void}>} */
    this.displays = new Map();
    /** @type {Topic[]} */
    this.topics = [];
    this.tool = /** @type {Tool} */ ("look");
    this.bodies = new Bodies(this.displays, this.frames);
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
    this.sidebar = new Sidebar({
      isShown: (topic) => this.isShown(topic),
      color: (topic) => this.colorOf(topic),
      show: (topic, isShown) => this.show(topic, isShown),
      paint: (topic, chosen) => this.paint(topic, chosen),
      look: (name) => this.camera?.lookAt(name),
    });
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
    this.camera = new Camera(view, this.bodies, this.kept, () => this.context.changed());
    const theme = () => view.setTheme(isDark());
    onTheme(theme, this.context.signal);
    theme();
    this.pointing = new Pointing({
      view,
      tool: () => (this.context.canCommand ? this.tool : "look"),
      bodyAt: (hit) => this.bodies.ofMesh(hit.object, this.simulator.nodes),
      poseOf: (frame) => this.frames.pose(frame, "world", performance.now()),
      hold: (frame, pose) => this.frames.hold(frame, pose),
      put: ({ node, name }, [x, y, , , , qz, qw]) => this.simulator.call("set_pose", { name, x, y, qz, qw }, node),
      send: (pose) => this.sendPose(pose),
      color: () => hexColor("--accent"),
    });
  }

  tools() {
    /** @type {Map<Tool, HTMLButtonElement>} */
    this.toolButtons = new Map();
    for (const [tool, name, title] of TOOLS) {
      this.toolButtons.set(tool, button(name, () => this.choose(tool), { title, "aria-pressed": tool === "look" }));
    }
    this.goal = element("input", {
      type: "text",
      class: "mono",
      "aria-label": "Topic of the pose",
      title: "Topic of the pose (geometry_msgs/PoseStamped)",
      hidden: true,
      onchange: () => {
        this.kept.goal = this.goal?.value.trim() || "/goal";
        this.context.changed();
      },
    });
    this.goal.value = this.kept.goal;
    this.fixedChoice = element("select", { "aria-label": "Fixed frame", title: "Fixed frame", onchange: () => this.setFixed() });
    this.followChoice = element("select", { "aria-label": "Follow", title: "The camera follows", onchange: () => this.camera?.setFollowed(this.followChoice?.value ?? "") });
    this.side = iconButton("settings", "Displays and poses", () => {
      this.kept.side = !this.kept.side;
      this.showTools();
      this.context.changed();
    });
    return element(
      "div",
      { class: "tools world-tools" },
      element("div", { class: "world-choice", role: "group", "aria-label": "Pointer" }, [...this.toolButtons.values()], this.goal),
      this.fixedChoice,
      this.followChoice,
      button("Reset view", () => this.camera?.reset(), { title: "Back to the initial view" }),
      button("Top", () => this.camera?.lookFromAbove(), { title: "Look from above" }),
      this.simulator.element,
      element("span", { class: "space" }),
      this.side,
    );
  }

  showTools() {
    const may = this.context.canCommand && this.context.source === "bus";
    this.toolButtons?.forEach((one, tool) => {
      set(one, "aria-pressed", String(tool === this.tool));
      one.disabled = tool !== "look" && !may;
    });
    if (this.goal) this.goal.hidden = this.tool !== "pose";
    if (this.side) set(this.side, "aria-pressed", String(this.kept.side));
    this.sidebar.element.classList.toggle("is-folded", !this.kept.side);
    this.stage.dataset["tool"] = may ? this.tool : "look";
  }

  /** @param {Tool} tool */
  choose(tool) {
    this.tool = tool;
    this.showTools();
  }

  /** @param {{topics: Topic[], undrawn: string[], simulators: string[]}} data */
  setTopics({ topics, undrawn, simulators }) {
    this.topics = topics;
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

  /**
   * @param {Topic} topic
   * @param {boolean} isShown
   */
  show(topic, isShown) {
    this.kept.shown[topic.topic] = isShown;
    if (isShown) this.open(topic);
    else this.hide(topic.topic);
    this.view?.invalidate();
    this.context.changed();
  }

  /**
   * @param {{topic: string}} topic
   * @param {string} chosen
   */
  paint({ topic }, chosen) {
    this.kept.colors[topic] = chosen;
    this.displays.get(topic)?.display.paint(chosen);
    this.view?.invalidate();
    this.context.changed();
  }

  /** @param {Topic} topic */
  open(topic) {
    const kind = KINDS[topic.kind];
    if (!kind || this.displays.has(topic.topic)) return;
    const display = new Display(topic.topic, topic.type);
    display.color = this.colorOf(topic);
    display.isPainted = topic.topic in this.kept.colors;
    const stream = this.context.connection.open(
      kind.stream ?? "newest",
      { topic: topic.topic },
      (data, payload) => this.receive(display, data, payload),
      (problem) => this.sidebar.setStatus(topic.topic, problem || kind.name, Boolean(problem)),
    );
    this.displays.set(topic.topic, { display, close: stream.close });
  }

  /** @param {string} topic */
  hide(topic) {
    const found = this.displays.get(topic);
    if (!found) return;
    found.close();
    found.display.close();
    this.displays.delete(topic);
    this.frames.drop(topic);
    this.sidebar.setStatus(topic, "", false);
  }

  /**
   * @param {Display} display
   * @param {any} sent
   * @param {ArrayBuffer} [payload]
   */
  receive(display, sent, payload) {
    const now = performance.now();
    const data = withNumbers(sent);
    if (data.kind === "frames") this.addFrames(display.topic, data, new Float32Array(payload ?? new ArrayBuffer(0)), now);
    else {
      if (data.kind === "odometry" && data.child && hasPlace(data)) {
        this.frames.add(display.topic, data.frame, data.child, data.pose, now, true);
      }
      display.receive(data, payload);
      display.leaveTrail(this.frames, this.bodies.fixed, now);
    }
    this.view?.invalidate(SMOOTH);
  }

  /**
   * @param {string} topic
   * @param {{frames: [string, string][], stamp: number}} data
   * @param {Float32Array} numbers
   * @param {number} now
   */
  addFrames(topic, data, numbers, now) {
    const before = this.frames.frames.size;
    data.frames.forEach(([parent, child], index) => {
      const pose = /** @type {Pose} */ (Array.from(numbers.subarray(7 * index, 7 * index + 7)));
      this.frames.add(topic, parent, child, pose, now);
    });
    this.simulator.updateTime(topic, data.stamp);
    if (this.frames.frames.size !== before) this.offerFrames();
  }

  offerFrames() {
    const names = this.frames.names();
    const fixed = names.includes(this.kept.fixed) ? this.kept.fixed : this.frames.root();
    this.bodies.fixed = fixed;
    const shown = names.filter((name) => !name.startsWith("ground_truth/") || name === fixed);
    offer(this.fixedChoice, shown.length ? shown : ["world"], fixed);
    offer(this.followChoice, ["", ...this.bodies.list().map(({ name }) => name)], this.kept.follow, "follow nothing");
  }

  /**
   * Place all displays at their poses.
   * @param {number} now
   */
  place(now) {
    const { view } = this;
    if (!view) return;
    for (const { display } of this.displays.values()) {
      display.place(view.content, this.frames, this.bodies, now);
    }
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
    for (const [topic, { display }] of this.displays) {
      const text = display.lost || display.status;
      if (text) this.sidebar.setStatus(topic, text, Boolean(display.lost));
    }
    if (this.followChoice && this.followChoice.options.length !== bodies.length + 1) this.offerFrames();
    if (this.camera && !this.camera.hasLooked && bodies.length) this.camera.reset();
  }

  setFixed() {
    this.kept.fixed = this.bodies.fixed = this.fixedChoice?.value ?? "world";
    this.view?.invalidate();
    this.context.changed();
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
    this.silence = setTimeout(() => {
      this.message.hidden = true;
    }, 4000);
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

/**
 * @param {HTMLSelectElement | undefined} select
 * @param {string[]} values
 * @param {string} value
 * @param {string} [none]
 */
function offer(select, values, value, none = "") {
  if (!select) return;
  const all = values.includes(value) ? values : [...values, value];
  fill(
    select,
    all.map((one) => element("option", { value: one }, one || none)),
  );
  select.value = value;
}
