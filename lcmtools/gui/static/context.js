// What a panel has of the page: its streams and requests, and a place for its troubles.

import { element, write } from "./elements.js";

/** The context of one panel; all that it opens is closed with it. */
export class Context {
  /**
   * @param {import("./connection.js").Connection} connection
   * @param {{changed: () => void, announce: (text: string) => void,
   *   add: (panel: string, settings: object) => void}} page
   */
  constructor(connection, page) {
    this.connection = connection;
    this.page = page;
    /** Shows what is wrong with the panel's streams; the frame has it above the panel. */
    this.notice = element("p", { class: "notice", role: "status", hidden: true });
    /** @type {Map<object, string>} */
    this.problems = new Map();
    this.ends = new AbortController();
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
   * @param {(text: string) => void} [onProblem] called with each problem too, "" when it is over
   * @returns {import("./connection.js").Stream} to change its parameters, or to close it
   */
  open(stream, parameters, onData, onProblem) {
    const key = {};
    const opened = this.connection.open(stream, parameters, onData, (text) => {
      this.tell(key, text);
      onProblem?.(text);
    });
    const close = () => {
      opened.close();
      this.tell(key, "");
    };
    this.ends.signal.addEventListener("abort", close);
    return { id: opened.id, change: opened.change, close };
  }

  /**
   * Show a problem above the panel; "" takes it away.
   * @param {object} key whose it is
   * @param {string} text
   */
  tell(key, text) {
    if (text) this.problems.set(key, text);
    else this.problems.delete(key);
    const told = [...new Set(this.problems.values())].join("\n");
    this.notice.hidden = !told;
    write(this.notice, told);
  }

  /**
   * Ask the server something.
   * @param {string} what
   * @param {object} [parameters]
   * @returns {Promise<any>} rejected with a Failure
   */
  ask(what, parameters = {}) {
    return this.connection.request("ask", what, parameters);
  }

  /**
   * Let the server do something, where this page may command.
   * @param {string} what
   * @param {object} [parameters]
   * @returns {Promise<any>} rejected with a Failure
   */
  do(what, parameters = {}) {
    return this.connection.request("do", what, parameters);
  }

  /**
   * Send a message that has no answer; returns false where the server is gone.
   * @param {object} message
   */
  send(message) {
    return this.connection.send(message);
  }

  /**
   * Call a function when the connection or the rights have changed, and for the first time now.
   * @param {() => void} listener
   */
  onChange(listener) {
    this.connection.addEventListener("change", listener, { signal: this.ends.signal });
    listener();
  }

  /** Ends with the panel: for listeners of the window, for example. */
  get signal() {
    return this.ends.signal;
  }

  /** Keep the panel's settings: they have changed. */
  changed() {
    this.page.changed();
  }

  /**
   * Let a screen reader say something.
   * @param {string} text
   */
  announce(text) {
    this.page.announce(text);
  }

  /**
   * Open another panel.
   * @param {string} panel
   * @param {object} settings
   */
  add(panel, settings) {
    this.page.add(panel, settings);
  }

  close() {
    this.ends.abort();
  }
}
