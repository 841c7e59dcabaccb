// The graph of nodes, programs and topics, with wtf's findings.

import { button, element, fill, iconButton, more, write } from "../elements.js";
import { GraphDrawing } from "./graph/drawing.js";
import { SIGNS, findingText, isMeant, sentence, sides } from "./graph/words.js";
import { stylesheet } from "./stylesheet.js";

/**
 * @typedef {import("./graph/drawing.js").Graph} Graph
 * @typedef {import("./graph/drawing.js").Vertex} Vertex
 * @typedef {import("./graph/words.js").Finding} Finding
 */

const GRAVEST = ["error", "warning", "note"];

/** The options of the drawing: parameter, button, and initial value. */
const CHOICES = [
  { name: "topics", label: "Topics", title: "Draw topics; else nodes are connected directly", usual: true },
  { name: "groups", label: "Groups", title: "A band for each namespace", usual: false },
  { name: "leaves", label: "Unused", title: "Topics without a publisher or a subscriber", usual: true },
  { name: "services", label: "Services", title: "Services and their clients", usual: false },
  { name: "tools", label: "Commands", title: "Commands that look on, such as echo", usual: false },
  { name: "everything", label: "Quiet", title: "/clock, /rosout, and hidden names", usual: false },
  { name: "dead", label: "Gone", title: "Nodes that no longer announce themselves", usual: true },
];

/** The graph panel. */
export default class GraphPanel {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    stylesheet("./graph/graph.css");
    this.context = context;
    this.title = "Graph";
    /** @type {Record<string, boolean>} */
    this.choices = Object.fromEntries(
      CHOICES.map(({ name, usual }) => [name, typeof settings[name] === "boolean" ? settings[name] : usual]),
    );
    this.hasOutline = settings.outline === true;
    /** @type {Graph | null} */
    this.graph = null;
    /** @type {Finding[]} */
    this.findings = [];
    this.hasLooked = false;
    /** @type {string | null} */
    this.selected = null;
    /** @type {Finding | null} */
    this.chosen = null;

    this.search = element("input", {
      type: "search",
      placeholder: "Find",
      "aria-label": "Find in the graph",
      oninput: () => this.show(),
    });
    this.drawing = new GraphDrawing((key) => this.select(key));
    this.about = element("div", { class: "graph-about", "aria-live": "polite", hidden: true });
    this.list = element("ul", { class: "graph-findings", "aria-label": "Findings of wtf" });
    this.outline = element("ul", { class: "graph-outline", "aria-label": "The graph as text" });
    this.counted = element("span", { class: "muted" });
    this.choosers = CHOICES.map(({ name, label, title }) => button(label, () => this.choose(name), { title }));
    const toggleOutline = () => {
      this.hasOutline = !this.hasOutline;
      this.showChoices();
      context.changed();
    };
    this.outliner = button("Text", toggleOutline, { title: "The graph as text" });
    this.element = element(
      "div",
      { class: "graph" },
      element(
        "div",
        { class: "tools" },
        this.search,
        more(
          "More …",
          "What is drawn",
          this.choosers,
          this.outliner,
          button("Save as SVG", () => this.drawing.save("graph.svg"), { title: "Save the drawing as SVG" }),
        ),
        iconButton("larger", "Fit into the panel (0)", () => this.drawing.view.fit()),
        this.counted,
      ),
      element("div", { class: "graph-field" }, this.drawing.element, this.outline, this.about),
      this.list,
    );
    this.element.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && (this.selected || this.chosen)) this.select(null);
    });
    this.stream = context.open("graph", this.choices, (data) => {
      this.graph = data;
      this.show();
    });
    context.open("findings", {}, (data) => {
      this.findings = data.findings;
      this.hasLooked = true;
      this.findings.sort((a, b) => GRAVEST.indexOf(a.severity) - GRAVEST.indexOf(b.severity));
      this.chosen = this.findings.find(({ text }) => text === this.chosen?.text) ?? null;
      this.show();
    });
    this.showChoices();
  }

  settings() {
    return { ...this.choices, outline: this.hasOutline };
  }

  close() {
    this.drawing.close();
  }

  /** @param {string} name */
  choose(name) {
    this.choices[name] = !this.choices[name];
    this.showChoices();
    this.drawing.view.isFitted = true;
    this.stream.change(this.choices);
    this.context.changed();
  }

  showChoices() {
    CHOICES.forEach(({ name }, index) => this.choosers[index]?.setAttribute("aria-pressed", String(this.choices[name])));
    this.outliner.setAttribute("aria-pressed", String(this.hasOutline));
    this.element.classList.toggle("is-text", this.hasOutline);
  }

  /** @param {string | null} key */
  select(key) {
    this.selected = key;
    this.chosen = null;
    this.show();
  }

  /** @param {Finding} finding */
  chooseFinding(finding) {
    this.selected = null;
    this.chosen = this.chosen === finding ? null : finding;
    this.show();
  }

  show() {
    const { graph } = this;
    if (!graph) return;
    const marks = this.marks(graph);
    this.drawing.show(graph, {
      marks: new Map([...marks].map(([key, found]) => [key, /** @type {Finding} */ (found[0]).severity])),
      lit: this.lit(graph, marks),
      selected: this.selected,
    });
    write(this.counted, graph.counted);
    this.counted.title = graph.leftOut;
    this.showFindings(marks);
    this.showAbout(graph, marks);
    this.showOutline(graph, marks);
  }

  /** Return the findings at each vertex, the most severe first. @param {Graph} graph */
  marks(graph) {
    /** @type {Map<string, Finding[]>} */
    const found = new Map();
    for (const finding of this.findings) {
      for (const vertex of graph.vertices) {
        if (!finding.subjects.some((subject) => isMeant(vertex, subject))) continue;
        found.set(vertex.key, [...(found.get(vertex.key) ?? []), finding]);
      }
    }
    return found;
  }

  /**
   * Return the highlighted vertices; null for all.
   * @param {Graph} graph
   * @param {Map<string, Finding[]>} marks
   */
  lit(graph, marks) {
    const wanted = this.search.value.trim().toLowerCase();
    if (wanted) {
      const found = graph.vertices.filter(({ rows }) => rows.some((row) => row.toLowerCase().includes(wanted)));
      return new Set(found.map(({ key }) => key));
    }
    const { chosen } = this;
    const keys = chosen ? [...marks].filter(([, found]) => found.includes(chosen)).map(([key]) => key) : [];
    return keys.length ? new Set(keys) : null;
  }

  /** @param {Map<string, Finding[]>} marks */
  showFindings(marks) {
    const none = this.hasLooked ? "wtf finds nothing" : "wtf is looking …";
    const found = this.findings.map((finding) => this.findingButton(marks, finding));
    const rows = (found.length ? found : [none]).map((one) => element("li", { class: found.length ? null : "muted" }, one));
    if (rowsText(rows) === rowsText([...this.list.children]) && !this.chosenChanged()) return;
    const place = [...this.list.querySelectorAll("button")].findIndex((one) => one === document.activeElement);
    fill(this.list, rows);
    if (place >= 0) this.list.querySelectorAll("button")[place]?.focus();
  }

  /** @param {Map<string, Finding[]>} marks @param {Finding} finding */
  findingButton(marks, finding) {
    const { severity, text, subjects } = finding;
    const isShown = [...marks.values()].some((found) => found.includes(finding));
    return button(
      [
        element("span", { class: "sign", "aria-hidden": "true" }, SIGNS[severity]),
        element("span", { class: "spoken" }, `${severity}: `),
        element("span", {}, sentence(text)),
        element("small", {}, subjects.map(({ name }) => name).join(", ")),
      ],
      () => this.chooseFinding(finding),
      {
        class: `finding is-${severity}`,
        "aria-pressed": String(finding === this.chosen),
        title: isShown ? "Show where, and what to do" : "What to do",
      },
    );
  }

  chosenChanged() {
    const pressed = this.list.querySelector('[aria-pressed="true"]')?.textContent ?? "";
    return !pressed.includes(sentence(this.chosen?.text ?? "\0")) && Boolean(pressed || this.chosen);
  }

  /** @param {Graph} graph @param {Map<string, Finding[]>} marks */
  showAbout(graph, marks) {
    const vertex = graph.vertices.find(({ key }) => key === this.selected);
    const found = vertex ? (marks.get(vertex.key) ?? []) : this.chosen ? [this.chosen] : [];
    this.about.hidden = !vertex && !found.length;
    if (this.about.hidden) return;
    const texts = found.map((finding) => [finding.text, ...finding.items, ...finding.remedies]);
    const state = JSON.stringify([vertex?.tip, vertex && sides(graph, vertex), texts]);
    if (this.about.dataset.state === state) return;
    this.about.dataset.state = state;
    fill(
      this.about,
      iconButton("close", "Close", () => this.select(null)),
      vertex ? this.vertexText(graph, vertex) : null,
      found.map((finding) => findingText(finding)),
    );
  }

  /** @param {Graph} graph @param {Vertex} vertex */
  vertexText(graph, vertex) {
    const [name, ...about] = vertex.tip;
    return element(
      "div",
      {},
      element("h3", { class: "mono" }, name),
      about.map((line) => element("p", { class: "muted" }, line)),
      sides(graph, vertex).map((line) => element("p", {}, line)),
      vertex.kind === "topic"
        ? button("Show its messages", () => this.context.add("topics", { filter: vertex.name, topic: vertex.name }))
        : null,
    );
  }

  /** @param {Graph} graph @param {Map<string, Finding[]>} marks */
  showOutline(graph, marks) {
    const members = graph.vertices.filter(({ kind }) => kind === "node" || kind === "program");
    const rows = members.map((vertex) => {
      const found = marks.get(vertex.key) ?? [];
      const lines = [...sides(graph, vertex), ...found.map(({ severity, text }) => `${severity}: ${sentence(text)}`)];
      return element(
        "li",
        {},
        element("span", { class: "mono" }, vertex.rows.join(", ")),
        element("ul", {}, lines.map((line) => element("li", {}, line))),
      );
    });
    if (rowsText(rows) !== rowsText([...this.outline.children])) fill(this.outline, rows);
  }
}

/** @param {Element[]} rows */
function rowsText(rows) {
  return rows.map((row) => row.textContent).join("\n");
}
