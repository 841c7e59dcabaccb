// Steering by joystick, sliders, keys and gamepad, which drive while they are held.

import { button, element, set, write } from "../elements.js";
import { choiceField } from "./choice.js";
import { cross, heldSlider, limitField, limited, partField, signed } from "./steer/controls.js";
import { HeldKeys, gamepadShare, joystickShare, together } from "./steer/held.js";
import { stylesheet } from "./stylesheet.js";

/**
 * @typedef {import("./steer/held.js").Share} Share
 * @typedef {{topic?: string, type?: string, listeners?: string[], others?: string[],
 *   refused?: string}} State
 */

const PERIOD = 100; // [ms] in which the sender hears of what is held
const SHORTEST = 40; // [ms] between two different commands
const RIM = 50 / 0.34; // [%] of the knob's size, which is 0.34 of the joystick's
const GAMEPAD_PERIOD = 50; // [ms]
const HELP = "Hold W A S D or the arrows; with Shift at full speed. Space or Esc stops.";
const PROMISE =
  "If the network to the robot or the computer with lcmtools gui fails, only a robot with a timeout of its own stops.";

/** The steering panel. */
export default class Steer {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    stylesheet("./steer/steer.css");
    this.context = context;
    this.topic = typeof settings.topic === "string" ? settings.topic : "";
    const [linear, angular] = context.connection.hello?.limits ?? [1, 2];
    this.largest = { linear, angular };
    this.linear = limited(settings.linear, 1, linear);
    this.angular = limited(settings.angular, 2, angular);
    this.part = limited(settings.part, 0.5, 1);
    this.usesGamepad = settings.gamepad === true;
    /** @type {State} */
    this.state = {};
    this.refusal = "";
    /** True if the sender has a connection of its own. */
    this.isConnected = false;
    /** The commands of the controls that are held. */
    /** @type {Record<"pad" | "forward" | "turn" | "gamepad", Share | null>} */
    this.held = { pad: null, forward: null, turn: null, gamepad: null };
    this.keys = new HeldKeys();
    /** Controls that were held at a stop must be released before they drive again. */
    this.isEnded = { slider: false, gamepad: false };
    this.pointer = -1;
    this.lastSent = 0;
    /** @type {ReturnType<typeof setInterval> | undefined} */
    this.repeats = undefined;
    const choice = choiceField({
      label: "Topic of velocity commands",
      value: this.topic,
      placeholder: "/robot/cmd_vel",
      suggest: () => this.context.ask("topics", { kind: "velocity" }),
      choose: (topic) => this.choose(topic),
      fills: true,
    });
    this.topicField = choice.input;
    this.knob = element("div", { class: "knob" });
    this.pad = element(
      "div",
      {
        class: "pad",
        tabindex: 0,
        role: "application",
        "aria-label": `Joystick. ${HELP}`,
        onpointerdown: (/** @type {PointerEvent} */ event) => this.grab(event),
        onpointermove: (/** @type {PointerEvent} */ event) => this.move(event),
        onpointerup: () => this.hold("pad", null),
        onpointercancel: () => this.hold("pad", null),
        onlostpointercapture: () => this.hold("pad", null),
      },
      cross(),
      this.knob,
    );
    this.forward = this.slider("forward", "Forward speed, held", (value) => ({ forward: value, turn: 0 }));
    this.turn = this.slider("turn", "Turn rate, held; left is positive", (value) => ({ forward: 0, turn: -value }));
    this.speed = element("output", { class: "mono" });
    this.rate = element("output", { class: "mono" });
    this.status = element("p", { class: "steer-status", role: "status" });
    this.stopButton = button("Stop", () => this.stop(), { class: "stop" });
    this.gamepad = element("input", {
      type: "checkbox",
      checked: this.usesGamepad,
      onchange: () => {
        this.usesGamepad = this.gamepad.checked;
        this.hold("gamepad", null);
        this.context.changed();
      },
    });
    this.gamepadName = element("span", {}, "Gamepad");
    this.element = this.layOut(choice.element);
    this.show();
    this.sender = new Worker(new URL("./steer/sender.js", import.meta.url), { type: "module" });
    this.sender.onmessage = ({ data }) => this.hear(data);
    this.sender.onerror = () => this.hear({ problem: "this browser cannot start the worker that sends commands" });
    this.sender.postMessage({ address: context.connection.address, follow: this.topic });
    context.onChange(() => {
      if (context.connection.isOpen) this.sender.postMessage({ retry: true });
      this.showAccess();
    });
    const { signal } = context;
    addEventListener("blur", () => this.letGo(), { signal });
    addEventListener("pagehide", () => this.letGo(), { signal });
    document.addEventListener("visibilitychange", () => this.letGo(), { signal });
    this.polls = setInterval(() => this.readGamepad(), GAMEPAD_PERIOD);
  }

  get title() {
    return this.topic ? `Steer ${this.topic}` : "Steer";
  }

  settings() {
    const { topic, linear, angular, part, usesGamepad } = this;
    return { topic, linear, angular, part, gamepad: usesGamepad };
  }

  /** Let keys drive. */
  focus() {
    this.pad.focus({ preventScroll: true });
  }

  close() {
    this.letGo();
    clearInterval(this.polls);
    this.sender.terminate();
  }

  /** @param {HTMLElement} choice */
  layOut(choice) {
    const { linear, angular } = this.largest;
    return element(
      "div",
      {
        class: "steer",
        onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
        onkeyup: (/** @type {KeyboardEvent} */ event) => this.key(event),
        onfocusout: (/** @type {FocusEvent} */ event) => this.leave(event),
      },
      element("div", { class: "tools" }, choice),
      element(
        "div",
        { class: "steer-room" },
        this.context.notice,
        element("div", { class: "steer-pad" }, this.forward, this.pad, this.turn),
        element(
          "div",
          { class: "steer-side" },
          this.stopButton,
          element("div", { class: "reading" }, element("span", {}, "Forward"), this.speed, element("small", {}, "m/s")),
          element("div", { class: "reading" }, element("span", {}, "Turn"), this.rate, element("small", {}, "rad/s")),
          element(
            "div",
            { class: "limits" },
            limitField("Max speed", "Largest forward speed", "m/s", this.linear, linear, (value) => this.limit({ linear: value })),
            limitField("Max turn", "Largest turn rate", "rad/s", this.angular, angular, (value) => this.limit({ angular: value })),
            partField(this.part, (part) => this.limit({ part })),
            element("label", {}, this.gamepad, this.gamepadName),
          ),
          element("small", { class: "steer-help" }, HELP, element("br"), PROMISE),
        ),
      ),
      this.status,
    );
  }

  /**
   * @param {"forward" | "turn"} name
   * @param {string} label
   * @param {(value: number) => Share} shareOf
   */
  slider(name, label, shareOf) {
    return heldSlider(name, label, {
      isEnded: () => this.isEnded.slider,
      begin: () => (this.isEnded.slider = false),
      hold: (value) => this.hold(name, value === null ? null : shareOf(value)),
    });
  }

  /** @param {{linear?: number, angular?: number, part?: number}} limits */
  limit(limits) {
    Object.assign(this, limits);
    this.show();
    this.context.changed();
  }

  /** @param {string} topic */
  choose(topic) {
    this.letGo();
    this.topic = topic;
    this.state = {};
    this.sender.postMessage({ follow: topic });
    this.show();
    this.context.changed();
  }

  /** @param {{isOpen?: boolean, problem?: string, data?: State}} said by the sender */
  hear({ isOpen, problem, data }) {
    if (isOpen !== undefined) {
      this.isConnected = isOpen;
      this.showAccess();
    }
    if (problem !== undefined) this.context.showProblem(this.sender, problem);
    if (data) this.receive(data);
  }

  /** @param {State} data */
  receive(data) {
    if (data.refused !== undefined) {
      this.refusal = data.refused;
      if (data.refused) this.context.announce(data.refused);
    } else if (data.topic === this.topic || data.topic === `/${this.topic}`) {
      this.topic = this.topicField.value = data.topic ?? ""; // a slash may have been missing
      this.state = data;
    }
    this.show();
  }

  /** Return the reason why no commands can be sent now; "" if they can. */
  obstacle() {
    if (!this.isConnected || !this.context.connection.isOpen) return "The server is gone: nothing is sent.";
    if (this.context.source === "log") return "This is a log: nothing obeys.";
    if (!this.context.canCommand) return "This page may only watch, not command.";
    if (!this.topic) return "Choose the robot's command topic.";
    return this.state.type ? "" : "Waiting for the topic's type.";
  }

  /** @param {PointerEvent} event */
  grab(event) {
    if (event.button || this.obstacle()) return;
    this.pad.focus();
    this.pointer = event.pointerId;
    this.pad.setPointerCapture(this.pointer);
    this.move(event);
    event.preventDefault();
  }

  /** @param {PointerEvent} event */
  move(event) {
    if (!this.pad.hasPointerCapture(event.pointerId)) return;
    const { left, top, width } = this.pad.getBoundingClientRect();
    const right = (2 * (event.clientX - left)) / width - 1;
    const down = (2 * (event.clientY - top)) / width - 1;
    this.hold("pad", joystickShare(right, down));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    const isStop = event.key === "Escape" || event.key === " ";
    if (event.type === "keydown" && isStop && !(event.key === " " && target.matches("input, button"))) {
      this.stop();
    } else if (target.matches("input") || !this.keys.handle(event)) {
      return;
    } else {
      this.refresh();
    }
    event.preventDefault();
  }

  /** @param {FocusEvent} event */
  leave(event) {
    if (!this.element.contains(/** @type {Node | null} */ (event.relatedTarget))) this.letGo();
  }

  readGamepad() {
    const found = navigator.getGamepads?.().find((one) => one?.connected) ?? null;
    write(this.gamepadName, found ? "Gamepad, a button held" : "Gamepad (none yet)");
    set(this.gamepadName, "title", found?.id ?? "Connect one and press one of its buttons");
    const counts = this.usesGamepad && document.hasFocus() && !document.hidden;
    let share = counts ? gamepadShare(found) : null;
    if (!share) this.isEnded.gamepad = false;
    if (this.isEnded.gamepad) share = null;
    if (share || this.held.gamepad) this.hold("gamepad", share);
  }

  /** @param {"pad" | "forward" | "turn" | "gamepad"} name @param {Share | null} share */
  hold(name, share) {
    if (!share && !this.held[name]) return;
    this.held[name] = share;
    this.refresh();
  }

  /** Release all controls. */
  letGo() {
    this.keys.clear();
    this.isEnded = { slider: true, gamepad: true };
    if (this.pad.hasPointerCapture(this.pointer)) this.pad.releasePointerCapture(this.pointer);
    for (const slider of [this.forward, this.turn]) slider.value = "0";
    this.held = { pad: null, forward: null, turn: null, gamepad: null };
    this.refresh();
  }

  /** Stop the robot, even if another page drives it. */
  stop() {
    this.letGo();
    if (this.obstacle()) return;
    this.sender.postMessage({ stop: { topic: this.topic, type: this.state.type } });
    this.context.announce("Stopped");
  }

  share() {
    const { pad, forward, turn, gamepad } = this.held;
    return together([pad, forward, turn, gamepad, this.keys.share(this.part)]);
  }

  /** Send the held command periodically, or the release of all controls once. */
  refresh() {
    const share = this.obstacle() ? null : this.share();
    if (share) {
      const isFirst = this.repeats === undefined;
      this.repeats ??= setInterval(() => this.drive(), PERIOD);
      if (isFirst || performance.now() - this.lastSent > SHORTEST) this.drive();
    } else if (this.repeats !== undefined) {
      clearInterval(this.repeats);
      this.repeats = undefined;
      this.refusal = "";
      this.sender.postMessage({ release: this.topic });
    }
    this.show();
  }

  drive() {
    const share = this.obstacle() ? null : this.share();
    if (!share) {
      this.refresh();
      return;
    }
    this.lastSent = performance.now();
    const drive = { topic: this.topic, type: this.state.type, forward: share.forward * this.linear, turn: share.turn * this.angular };
    this.sender.postMessage({ drive });
  }

  showAccess() {
    if (this.obstacle()) this.letGo();
    else this.show();
  }

  show() {
    const obstacle = this.obstacle();
    const share = obstacle ? null : this.share();
    const isDriving = Boolean(share) && !this.refusal;
    const { forward, turn } = (isDriving && share) || { forward: 0, turn: 0 };
    write(this.speed, signed(forward * this.linear));
    write(this.rate, signed(turn * this.angular));
    this.knob.style.transform = `translate(${-turn * RIM}%, ${-forward * RIM}%)`;
    this.element.classList.toggle("is-held", Boolean(share));
    this.element.classList.toggle("is-off", Boolean(obstacle));
    set(this.pad, "aria-disabled", Boolean(obstacle) || null);
    for (const control of [this.forward, this.turn, this.stopButton]) control.disabled = Boolean(obstacle);
    const others = this.state.others ?? [];
    const also = others.length && !obstacle ? `${others.join(", ")} commands ${this.topic} too` : "";
    this.context.showProblem(this, this.refusal || also);
    write(this.status, obstacle || this.stateText(isDriving));
  }

  /** @param {boolean} isDriving */
  stateText(isDriving) {
    const who = this.state.listeners?.length ? this.state.listeners.join(", ") : "nobody that is known";
    return `${isDriving ? "Driving" : "Not driving"}. ${this.state.type}, obeyed by ${who}.`;
  }
}
