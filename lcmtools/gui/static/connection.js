// The connection to the server. It reconnects by itself and then reopens its streams, except those that send.

const SHORTEST = 250; // [ms] before the first attempt to reconnect
const LONGEST = 4000;
const ENDED = "the connection to lcmtools gui is gone";
const SENDING = "publishing"; // the stream that makes the server send; only a person starts it

/**
 * @typedef {{version: string, bus: string, source: "bus" | "log", rights: string[],
 *   limits: [number, number], view: {panel?: string, settings?: object}}} Hello
 * @typedef {(data: any, payload?: ArrayBuffer) => void} OnData
 * @typedef {{id: number, stream: string, parameters: object, onData: OnData,
 *   onProblem: (text: string) => void}} Opened
 * @typedef {{id: number, change: (parameters: object) => void, took: () => void, close: () => void}} Stream
 *   "took" lets the next update follow if the stream was opened with "paced"
 */

/** The connection. It dispatches "change" when the link, the rights or the state has changed. */
export class Connection extends EventTarget {
  /** @param {string} address */
  constructor(address) {
    super();
    this.address = address;
    /** @type {Hello | null} */
    this.hello = null;
    /** @type {{trouble?: string, log?: any}} */
    this.state = {};
    this.isOpen = false;
    /** The reason why the page does not reconnect; "" while it does. */
    this.refusal = "";
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {Map<number, Opened>} */
    this.streams = new Map();
    /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
    this.requests = new Map();
    this.next = 1;
    this.pause = SHORTEST;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.changed = () => this.dispatchEvent(new Event("change"));
    this.connect();
  }

  get canCommand() {
    return this.isOpen && Boolean(this.hello?.rights.includes("command"));
  }

  connect() {
    clearTimeout(this.timer);
    const socket = new WebSocket(this.address, "lcmtools.1");
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => this.lose(event);
    this.socket = socket;
  }

  /** Reconnect now instead of waiting for the next attempt. */
  retry() {
    if (!this.isOpen && this.socket?.readyState === WebSocket.CLOSED && !this.refusal) {
      this.connect();
    }
  }

  /** @param {CloseEvent} event */
  lose(event) {
    this.isOpen = false;
    for (const request of this.requests.values()) request.reject(new Error(ENDED));
    this.requests.clear();
    for (const opened of this.streams.values()) {
      if (opened.stream !== SENDING) continue;
      this.streams.delete(opened.id);
      opened.onProblem(`stopped: ${ENDED}`);
    }
    if (event.code === 1008) {
      this.refusal = `the server has closed this page: ${event.reason}`;
    } else {
      this.timer = setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(LONGEST, this.pause * 1.6);
    }
    this.changed();
  }

  /** @param {string | ArrayBuffer} data */
  receive(data) {
    if (typeof data !== "string") {
      const length = new DataView(data).getUint32(0, true);
      const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      this.streams.get(header.id)?.onData(header, data.slice(4 + length));
      return;
    }
    const frame = JSON.parse(data);
    if (frame.hello) this.begin(frame.hello);
    else if (frame.state) {
      this.state = frame.state;
      this.changed();
    } else if (frame.data) this.streams.get(frame.id)?.onData(frame.data);
    else if ("problem" in frame) this.streams.get(frame.id)?.onProblem(frame.problem);
    else this.answer(frame);
  }

  /** @param {Hello} hello */
  begin(hello) {
    this.hello = hello;
    this.isOpen = true;
    this.pause = SHORTEST;
    for (const opened of this.streams.values()) this.sendOpen(opened);
    this.changed();
  }

  /** @param {{id: number, answer?: any, error?: {what: string, hint: string}}} frame */
  answer(frame) {
    const request = this.requests.get(frame.id);
    this.requests.delete(frame.id);
    const { error } = frame;
    if (error) request?.reject(new Error(error.hint ? `${error.what}; ${error.hint}` : error.what));
    else request?.resolve(frame.answer);
  }

  /**
   * Send a message; return false if there is no connection.
   * @param {object} message
   */
  send(message) {
    if (!this.isOpen || this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify({ ...message, sent: performance.now() / 1000 }));
    return true;
  }

  /** @param {Opened} opened */
  sendOpen({ id, stream, parameters }) {
    this.send({ ...parameters, op: "open", id, stream });
  }

  /**
   * Open a stream; it is reopened after a lost connection, unless it sends.
   * @param {string} stream
   * @param {object} parameters
   * @param {OnData} onData called with each update
   * @param {(text: string) => void} onProblem called with each problem, "" when it is solved
   * @returns {Stream}
   */
  open(stream, parameters, onData, onProblem) {
    const opened = { id: this.next++, stream, parameters, onData, onProblem };
    this.streams.set(opened.id, opened);
    this.sendOpen(opened);
    return {
      id: opened.id,
      change: (changed) => {
        opened.parameters = changed;
        this.sendOpen(opened);
      },
      took: () => this.send({ op: "took", id: opened.id }),
      close: () => {
        if (this.streams.delete(opened.id)) this.send({ op: "close", id: opened.id });
      },
    };
  }

  /**
   * Send a request for a value ("ask") or an action ("do"); resolve to the response.
   * @param {"ask" | "do"} op
   * @param {string} what
   * @param {object} [parameters]
   * @returns {Promise<any>}
   */
  request(op, what, parameters = {}) {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      if (!this.send({ ...parameters, op, id, what })) reject(new Error(ENDED));
      else this.requests.set(id, { resolve, reject });
    });
  }
}
