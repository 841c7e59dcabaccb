// The layout of panels as a tree of rows and columns. Plain values; must not know the DOM.

/**
 * @typedef {{panel: string, settings?: any}} Leaf
 * @typedef {{split: "row" | "column", parts: Tree[], sizes: number[]}} Split
 * @typedef {Leaf | Split} Tree
 * @typedef {"left" | "right" | "up" | "down"} Side
 */

/** @param {Tree} tree @returns {tree is Split} */
export function isSplit(tree) {
  return "split" in tree;
}

/** @param {{sizes: number[]}} split */
export function total({ sizes }) {
  return sizes.reduce((one, other) => one + other, 0);
}

/**
 * Return the panels of a tree, from the first to the last.
 * @param {Tree | null} tree
 * @returns {Leaf[]}
 */
export function leaves(tree) {
  if (!tree) return [];
  return isSplit(tree) ? tree.parts.flatMap(leaves) : [tree];
}

/**
 * Return a tree without a panel; null if nothing is left.
 * @param {Tree} tree
 * @param {Leaf} leaf
 * @returns {Tree | null}
 */
export function without(tree, leaf) {
  if (!isSplit(tree)) return tree === leaf ? null : tree;
  return joined(tree.split, tree.parts.map((part) => without(part, leaf)), tree.sizes);
}

/**
 * Return a tree with a panel added next to a part of it.
 * @param {Tree} tree
 * @param {Tree} target
 * @param {Leaf} leaf
 * @param {Side} side of the target
 * @returns {Tree}
 */
export function beside(tree, target, leaf, side) {
  if (tree === target) {
    const split = side === "left" || side === "right" ? "row" : "column";
    const parts = side === "left" || side === "up" ? [leaf, tree] : [tree, leaf];
    return joined(split, parts, [1, 1]) ?? leaf;
  }
  if (!isSplit(tree)) return tree;
  const parts = tree.parts.map((part) => beside(part, target, leaf, side));
  return joined(tree.split, parts, tree.sizes) ?? leaf;
}

/**
 * Return a split without the parts that are null, and without splits of the same direction in it;
 * one part alone is returned itself, null if there is none.
 * @param {Split["split"]} split
 * @param {(Tree | null)[]} all
 * @param {number[]} shares the sizes of all
 * @returns {Tree | null}
 */
function joined(split, all, shares) {
  /** @type {Split} */
  const made = { split, parts: [], sizes: [] };
  all.forEach((part, index) => {
    const size = shares[index] ?? 1;
    const inner = part && isSplit(part) && part.split === split ? part : { parts: part ? [part] : [], sizes: [1] };
    made.parts.push(...inner.parts);
    made.sizes.push(...inner.sizes.map((one) => (one / total(inner)) * size));
  });
  return made.parts.length < 2 ? (made.parts[0] ?? null) : made;
}

/**
 * Return a copy of a tree with the same panels.
 * @param {Tree | null} tree
 * @returns {Tree | null}
 */
export function copied(tree) {
  if (!tree || !isSplit(tree)) return tree;
  return { ...tree, parts: /** @type {Tree[]} */ (tree.parts.map(copied)), sizes: [...tree.sizes] };
}

/**
 * Return true if two trees have the same panels in the same places, of the same sizes.
 * @param {Tree | null | undefined} a
 * @param {Tree | null | undefined} b
 * @returns {boolean}
 */
export function areEqual(a, b) {
  if (a === b || !a || !b || !isSplit(a) || !isSplit(b)) return a === b;
  const isAlike = a.split === b.split && String(a.sizes) === String(b.sizes);
  return isAlike && a.parts.every((part, index) => areEqual(part, b.parts[index]));
}

/**
 * Validate a saved or received tree; return null if it is invalid.
 * @param {any} value
 * @param {(panel: string) => boolean} isKnown
 * @param {number} [depth]
 * @returns {Tree | null}
 */
export function checked(value, isKnown, depth = 0) {
  if (!value || typeof value !== "object" || depth > 12) return null;
  if (typeof value.panel === "string" && isKnown(value.panel)) {
    const settings = value.settings && typeof value.settings === "object" ? value.settings : {};
    return { panel: value.panel, settings };
  }
  if (!Array.isArray(value.parts) || !["row", "column"].includes(value.split)) return null;
  /** @type {any[]} */
  const parts = value.parts.slice(0, 20);
  const sizes = parts.map((_, index) => Number(value.sizes?.[index]));
  return joined(
    value.split,
    parts.map((part) => checked(part, isKnown, depth + 1)),
    sizes.map((size) => (size > 0 && size < 1000 ? size : 1)),
  );
}
