// The frame of one panel: its title, its buttons, its problems, and the panel itself.

import { Context } from "./context.js";
import { OPENS_MENU, element, iconButton, openMenu, relabel, set, write } from "./elements.js";
import { PANELS } from "./panels/index.js";
import { styled } from "./panels/stylesheet.js";

const LATER = 400; // [ms]

/** The sides to which a panel can move. @type {import("./tree.js").Side[]} */
export const SIDES = ["left", "right", "up", "down"];

/** The frame of a panel. */
export class Frame {
  /** @param {import("./layout.js").Layout} layout @param {import("./tree.js").Leaf} leaf */
  constructor(layout, leaf) {
    this.layout = layout;
    this.leaf = leaf;
    const kind = /** @type {import("./panels/index.js").Kind} */ (PANELS[leaf.panel]);
    this.kind = kind;
    /** @type {import("./panels/index.js").Panel | null} */
    this.panel = null;
    this.context = new Context(layout.connection, {
      changed: () => this.changed(),
      announce: layout.page.announce,
      add: (panel, settings) => layout.add(panel, settings, leaf),
    });
    this.title = element("h2", {}, kind.title);
    this.large = iconButton("larger", "Enlarge", () => layout.enlarge(leaf));
    this.body = element("div", { class: "panel-body" });
    this.header = element(
      "header",
      { onpointerdown: (/** @type {PointerEvent} */ event) => layout.drag(leaf, event) },
      this.title,
      iconButton("menu", "Arrange", (event) => this.openMenu(event), OPENS_MENU),
      this.large,
      iconButton("close", "Close", () => layout.remove(leaf)),
    );
    this.element = element(
      "section",
      { class: "panel", "data-panel": leaf.panel, "aria-label": kind.title, tabindex: -1, onfocus: () => this.panel?.focus?.() },
      this.header,
      this.context.notice,
      this.body,
    );
    this.load();
  }

  /** True if no other panel is open. */
  get isAlone() {
    return this.layout.tree === this.leaf;
  }

  async load() {
    try {
      // let other panels show something before a module that loads slowly
      if (this.kind.isLarge) await new Promise((done) => setTimeout(done, this.isAlone ? 0 : LATER));
      const { default: PanelClass } = await this.kind.module();
      if (this.context.signal.aborted) return;
      this.panel = new PanelClass(this.context, this.leaf.settings ?? {});
      await styled();
      this.body.append(this.panel.element);
      if (this.isAlone && document.activeElement === document.body) this.panel.focus?.();
      this.showTitle();
    } catch (error) {
      this.context.showProblem(this, `this panel cannot be shown: ${error}`);
    }
  }

  changed() {
    this.showTitle();
    this.layout.page.changed();
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
    if (isLarge) relabel(this.large, "smaller", "Back to its place");
    else relabel(this.large, "larger", "Enlarge");
  }

  /** @param {Event} event */
  openMenu(event) {
    openMenu(
      /** @type {HTMLButtonElement} */ (event.currentTarget),
      SIDES.map((side) => ({ label: `Move ${side}`, run: () => this.layout.move(this.leaf, side) })),
    );
  }

  /** Return the panel's current settings. */
  settings() {
    return this.panel ? (this.panel.settings?.() ?? {}) : (this.leaf.settings ?? {});
  }

  close() {
    this.panel?.close?.();
    this.context.close();
    this.element.remove();
  }
}
