// The frame of one panel: its title, its buttons, its problems, and the panel itself.

import { Context } from "./context.js";
import { element, iconButton, openMenu, set, write, fill, icon } from "./elements.js";
import { PANELS } from "./panels/index.js";
import { styled } from "./panels/stylesheet.js";

const LATER = 400; // [ms]

/**
 * @typedef {import("./tree.js").Side} Side
 * @typedef {{changed: () => void, announce: (text: string) => void,
 *   add: (panel: string, settings: object, beside?: import("./tree.js").Leaf) => void,
 *   remove: (leaf: import("./tree.js").Leaf) => void,
 *   move: (leaf: import("./tree.js").Leaf, side: Side) => void,
 *   enlarge: (leaf: import("./tree.js").Leaf) => void,
 *   isAlone: (leaf: import("./tree.js").Leaf) => boolean,
 *   drag: (leaf: import("./tree.js").Leaf, event: PointerEvent) => void}} Owner
 */

/** The frame of a panel. */
export class Frame {
  /**
   * @param {import("./connection.js").Connection} connection
   * @param {import("./tree.js").Leaf} leaf
   * @param {Owner} owner
   */
  constructor(connection, leaf, owner) {
    this.leaf = leaf;
    this.owner = owner;
    const kind = /** @type {import("./panels/index.js").Kind} */ (PANELS[leaf.panel]);
    this.kind = kind;
    /** @type {import("./panels/index.js").Panel | null} */
    this.panel = null;
    this.context = new Context(connection, {
      changed: () => this.changed(),
      announce: owner.announce,
      add: (panel, settings) => owner.add(panel, settings, leaf),
    });
    this.title = element("h2", {}, kind.title);
    this.large = iconButton("larger", "Enlarge", () => owner.enlarge(leaf));
    this.body = element("div", { class: "panel-body" });
    this.header = element(
      "header",
      { onpointerdown: (/** @type {PointerEvent} */ event) => owner.drag(leaf, event) },
      this.title,
      iconButton("menu", "Arrange", (event) => this.openMenu(event), {
        "aria-haspopup": "menu",
        "aria-expanded": "false",
      }),
      this.large,
      iconButton("close", "Close", () => owner.remove(leaf)),
    );
    this.element = element(
      "section",
      { class: "panel", "data-panel": leaf.panel, "aria-label": kind.title, tabindex: -1 },
      this.header,
      this.context.notice,
      this.body,
    );
    this.load();
  }

  async load() {
    try {
      // let other panels show something before a module that loads slowly
      if (this.kind.isLarge) await new Promise((done) => setTimeout(done, this.owner.isAlone(this.leaf) ? 0 : LATER));
      const { default: PanelClass } = await this.kind.module();
      if (this.context.signal.aborted) return;
      this.panel = new PanelClass(this.context, this.leaf.settings ?? {});
      await styled();
      this.body.append(this.panel.element);
      this.showTitle();
    } catch (error) {
      this.context.showProblem(this, `this panel cannot be shown: ${error}`);
    }
  }

  changed() {
    this.showTitle();
    this.owner.changed();
  }

  showTitle() {
    const title = this.panel?.title || this.kind.title;
    write(this.title, title);
    set(this.title, "title", title);
    set(this.element, "aria-label", title);
  }

  /** @param {boolean} isLarge */
  setLarge(isLarge) {
    this.element.classList.toggle("is-large", isLarge);
    const label = isLarge ? "Back to its place" : "Enlarge";
    set(this.large, "aria-label", label);
    set(this.large, "title", label);
    fill(this.large, icon(isLarge ? "smaller" : "larger"));
  }

  /** @param {Event} event */
  openMenu(event) {
    /** @type {[Side, string][]} */
    const sides = [
      ["left", "Move left"],
      ["right", "Move right"],
      ["up", "Move up"],
      ["down", "Move down"],
    ];
    openMenu(
      /** @type {HTMLButtonElement} */ (event.currentTarget),
      sides.map(([side, label]) => ({ label, run: () => this.owner.move(this.leaf, side) })),
    );
  }

  /** Return the panel's current settings. */
  settings() {
    return this.panel ? this.panel.settings() : (this.leaf.settings ?? {});
  }

  close() {
    this.panel?.close();
    this.context.close();
    this.element.remove();
  }
}
