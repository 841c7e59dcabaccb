// The worker that sends a panel's commands, in time however long the page takes to draw.

import { Connection } from "../../connection.js";

/** @typedef {{topic: string, type: string, forward: number, turn: number}} Command */

const PERIOD = 100; // [ms] between two commands while something is held
const LONGEST = 500; // [ms] from one word of the page to the next while something is held
const FROZEN = `stopped: this page did nothing for ${LONGEST / 1000} s`;

/** The commands of one panel. The page must repeat what it holds: if it is frozen, nobody can release it. */
class Sender {
  /** @param {string} address */
  constructor(address) {
    this.connection = new Connection(address);
    this.stream = this.connection.open(
      "steer",
      { topic: "" },
      (data) => postMessage({ data }),
      (problem) => postMessage({ problem }),
    );
    /** The command that is held. @type {Command | null} */
    this.command = null;
    this.isFrozen = false;
    /** @type {ReturnType<typeof setInterval> | undefined} */
    this.repeats = undefined;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.watch = undefined;
    this.connection.addEventListener("change", () => this.change());
  }

  /** Tell the page about the connection; what was held when it was lost is held no more. */
  change() {
    const { isOpen } = this.connection;
    if (!isOpen) this.end();
    postMessage({ isOpen });
  }

  /** @param {Command} command */
  drive(command) {
    clearTimeout(this.watch);
    this.watch = setTimeout(() => this.freeze(command), LONGEST);
    if (this.isFrozen) {
      this.thaw(); // a release may have waited with it: the next word counts
      return;
    }
    const isNew = JSON.stringify(command) !== JSON.stringify(this.command);
    this.command = command;
    if (isNew) this.send();
  }

  send() {
    clearInterval(this.repeats);
    this.repeats = setInterval(() => this.send(), PERIOD);
    this.connection.send({ ...this.command, op: "drive", id: this.stream.id });
  }

  /** @param {string} topic */
  release(topic) {
    this.end();
    this.thaw();
    this.connection.send({ op: "release", id: this.stream.id, topic });
  }

  /** @param {Command} command */
  freeze({ topic }) {
    this.release(topic);
    this.isFrozen = true;
    postMessage({ data: { refused: FROZEN } });
  }

  thaw() {
    if (this.isFrozen) postMessage({ data: { refused: "" } });
    this.isFrozen = false;
  }

  end() {
    clearInterval(this.repeats);
    clearTimeout(this.watch);
    this.command = null;
  }

  /** @param {{topic: string, type: string}} steered */
  stop(steered) {
    this.connection.send({ ...steered, op: "stop", id: this.stream.id });
  }
}

/** @type {Sender | undefined} */
let sender;

onmessage = ({ data }) => {
  if (data.address) sender = new Sender(data.address);
  if (data.follow !== undefined) sender?.stream.change({ topic: data.follow });
  if (data.drive) sender?.drive(data.drive);
  if (data.release !== undefined) sender?.release(data.release);
  if (data.stop) sender?.stop(data.stop);
  if (data.retry) sender?.connection.retry();
};
