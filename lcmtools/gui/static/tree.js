// The layout of panels as a tree of rows and columns. Plain values; must not know the DOM.

/**
 * @typedef {{panel: string, settings?: any}} Leaf
 * @typedef {{split: "row" | "column", parts: Tree[], sizes: number[]}} Split
 * @typedef {Leaf | Split} Tree
 * @typedef {"left" | "right" | "up" | "down"} Side
 */

/**
 * @param {Tree} tree
 * @returns {tree is Split}
 */
export function isSplit(tree) {
  return "split" in tree;
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
  /** @type {[Tree, number][]} */
  const kept = [];
  tree.parts.forEach((part, index) => {
    const left = without(part, leaf);
    if (left) kept.push([left, tree.sizes[index] ?? 1]);
  });
  if (kept.length < 2) return kept[0]?.[0] ?? null;
  return flat({ split: tree.split, parts: kept.map(([part]) => part), sizes: kept.map(([, s]) => s) });
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
    return flat({ split, parts, sizes: [1, 1] });
  }
  if (!isSplit(tree)) return tree;
  const parts = tree.parts.map((part) => beside(part, target, leaf, side));
  return flat({ split: tree.split, parts, sizes: tree.sizes });
}

/**
 * Flatten a split: no part of the result is a split of the same direction.
 * @param {Split} tree
 * @returns {Split}
 */
function flat(tree) {
  /** @type {Tree[]} */
  const parts = [];
  /** @type {number[]} */
  const sizes = [];
  tree.parts.forEach((part, index) => {
    const size = tree.sizes[index] ?? 1;
    if (isSplit(part) && part.split === tree.split) {
      const sum = part.sizes.reduce((one, other) => one + other, 0);
      parts.push(...part.parts);
      sizes.push(...part.sizes.map((one) => (one / sum) * size));
    } else {
      parts.push(part);
      sizes.push(size);
    }
  });
  return { split: tree.split, parts, sizes };
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
  /** @type {Tree[]} */
  const parts = [];
  /** @type {number[]} */
  const sizes = [];
  value.parts.slice(0, 20).forEach((/** @type {any} */ part, /** @type {number} */ index) => {
    const found = checked(part, isKnown, depth + 1);
    const size = Number(value.sizes?.[index]);
    if (found) {
      parts.push(found);
      sizes.push(size > 0 && size < 1000 ? size : 1);
    }
  });
  if (parts.length < 2) return parts[0] ?? null;
  return flat({ split: value.split, parts, sizes });
}
