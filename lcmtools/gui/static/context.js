// A panel's interface to the page: streams, requests, and the display of problems.

import { element, write } from "./elements.js";

/** @typedef {(what: string, parameters?: object) => Promise<any>} Request rejected with an Error */

/** The context of one panel; the streams opened through it are closed with the panel. */
export class Context {
  /**
   * @param {import("./connection.js").Connection} connection
   * @param {{changed: () => void, announce: (text: string) => void,
   *   add: (panel: string, settings: object) => void}} page
   */
  constructor(connection, page) {
    this.connection = connection;
    /** Save the panel's settings after a change. */
    this.changed = page.changed;
    /** Announce a text to screen readers. */
    this.announce = page.announce;
    /** Open another panel. */
    this.add = page.add;
    /** Request a value from the server. @type {Request} */
    this.ask = (what, parameters) => connection.request("ask", what, parameters);
    /** Request an action from the server; only pages with the right to command may. @type {Request} */
    this.do = (what, parameters) => connection.request("do", what, parameters);
    /** The problems of the panel's streams, which the frame shows above the panel. */
    this.notice = element("p", { class: "notice", role: "status", hidden: true });
    /** @type {Map<object, string>} */
    this.problems = new Map();
    this.ends = new AbortController();
    /** Aborts when the panel is closed, for example for listeners of the window. */
    this.signal = this.ends.signal;
  }

  get canCommand() {
    return this.connection.canCommand;
  }

  /** The source: "bus" or "log". */
  get source() {
    return this.connection.hello?.source ?? "bus";
  }

  /**
   * Open a stream until the panel is closed. Its problems are shown above the panel.
   * @param {string} stream
   * @param {object} parameters
   * @param {import("./connection.js").OnData} onData called with each update
   * @param {(text: string) => void} [onProblem] also called with each problem, "" when it is solved
   * @returns {import("./connection.js").Stream} to change its parameters, or to close it
   */
  open(stream, parameters, onData, onProblem) {
    const key = {};
    const opened = this.connection.open(stream, parameters, onData, (text) => {
      this.showProblem(key, text);
      onProblem?.(text);
    });
    const close = () => {
      opened.close();
      this.showProblem(key, "");
    };
    this.signal.addEventListener("abort", close);
    return { ...opened, close };
  }

  /**
   * Show a problem above the panel; "" removes it.
   * @param {object} key identifies its owner
   * @param {string} text
   */
  showProblem(key, text) {
    if (text) this.problems.set(key, text);
    else this.problems.delete(key);
    const told = [...new Set(this.problems.values())].join("\n");
    this.notice.hidden = !told;
    write(this.notice, told);
  }

  /**
   * Call a function now, and whenever the connection or the rights have changed.
   * @param {() => void} listener
   */
  onChange(listener) {
    this.connection.addEventListener("change", listener, { signal: this.signal });
    listener();
  }

  close() {
    this.ends.abort();
  }
}
