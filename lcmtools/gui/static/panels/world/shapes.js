// Markers as meshes. All markers of a body share one mesh, so that many robots are drawn quickly.

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  CylinderGeometry,
  DoubleSide,
  FrontSide,
  Group,
  LatheGeometry,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  Points,
  PointsMaterial,
  Quaternion,
  RoundedBoxGeometry,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  Vector2,
  Vector3,
} from "../../vendor/three/three.js";
import { UNIT, matrixOf, ribbonOf, triples } from "./geometry.js";
import { groundMaterial } from "./ground.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {{ns: string, frame: string, type: number, pose: Pose, scale: [number, number, number],
 *   color: [number, number, number, number], points: number[], colors: number[], text: string}} Marker
 */

// the types of markers
const ARROW = 0;
const CUBE = 1;
const SPHERE = 2;
const CYLINDER = 3;
const LINE_STRIP = 4;
const LINE_LIST = 5;
const CUBE_LIST = 6;
const SPHERE_LIST = 7;
const POINTS = 8;
const TEXT = 9;
export const MESH = 10; // from a file
const TRIANGLES = 11;
const LARGE = 30; // [m]; longer and wider boxes are ground, which casts no shadow
const ROUNDING = 0.012; // [m] of edges

/** The cached shapes of markers, by type and size. */
const known = new Map();

/**
 * Create a group with the markers of one body, in its frame.
 * @param {Marker[]} markers
 * @returns {any} a group
 */
export function bodyOf(markers) {
  const group = new Group();
  const opaque = markers.filter((marker) => isSolid(marker) && opacity(marker) === 1);
  const ground = opaque.filter(({ scale }) => Math.min(scale[0], scale[1]) > LARGE);
  const lines = opaque.filter((marker) => isLine(marker));
  const solids = opaque.filter((marker) => !ground.includes(marker) && !lines.includes(marker));
  if (solids.length) group.add(solidOf(solids, { shadow: true }));
  if (ground.length) group.add(Object.assign(solidOf(ground, {}), { material: groundMaterial() }));
  group.userData["isGround"] = ground.length > 0;
  if (lines.length) group.add(solidOf(lines, { offset: -2 }));
  for (const marker of markers) {
    if (isSolid(marker) && opacity(marker) < 1 && opacity(marker) > 0) {
      group.add(solidOf([marker], { opacity: opacity(marker), offset: isLine(marker) ? -2 : 0 }));
    } else if (marker.type === TEXT) group.add(label(marker));
    else if (marker.type === POINTS) group.add(dots(marker));
  }
  return group;
}

/** @param {Marker} marker */
const opacity = (marker) => Math.min(1, marker.color[3]);
/** @param {Marker} marker */
const isLine = (marker) => marker.type === LINE_STRIP || marker.type === LINE_LIST;
/** @param {Marker} marker */
const isSolid = (marker) => marker.type <= SPHERE_LIST || marker.type === TRIANGLES;

/**
 * Merge several markers into one mesh with vertex colours.
 * @param {Marker[]} markers
 * @param {{shadow?: boolean, opacity?: number, offset?: number}} look
 */
function solidOf(markers, { shadow = false, opacity = 1, offset = 0 }) {
  const parts = markers.flatMap(partsOf);
  const count = parts.reduce((sum, { shape }) => sum + shape.attributes.position.count, 0);
  const places = new Float32Array(3 * count);
  const normals = new Float32Array(3 * count);
  const colors = new Float32Array(3 * count);
  const point = new Vector3();
  let at = 0;
  for (const { shape, matrix, color } of parts) {
    const { position, normal } = shape.attributes;
    for (let index = 0; index < position.count; index += 1, at += 3) {
      point.fromBufferAttribute(position, index).applyMatrix4(matrix).toArray(places, at);
      point.fromBufferAttribute(normal, index).transformDirection(matrix).toArray(normals, at);
      colors.set(color, at);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3));
  geometry.setAttribute("color", new BufferAttribute(colors, 3));
  const material = new MeshStandardMaterial({
    vertexColors: true,
    roughness: 0.72,
    metalness: 0.03,
    transparent: opacity < 1,
    opacity,
    depthWrite: opacity === 1,
    side: offset ? DoubleSide : FrontSide,
    polygonOffset: offset !== 0,
    polygonOffsetFactor: offset,
    polygonOffsetUnits: 4 * offset,
  });
  const mesh = new Mesh(geometry, material);
  mesh.castShadow = shadow;
  mesh.receiveShadow = true;
  return mesh;
}

/**
 * @param {Marker} marker
 * @returns {{shape: any, matrix: any, color: number[]}[]}
 */
function partsOf(marker) {
  const { type, scale, points } = marker;
  const own = matrixOf(marker.pose);
  const color = linear(marker.color);
  if (type === CUBE || type === SPHERE || type === CYLINDER) {
    return [{ shape: solid(type, scale), matrix: own, color }];
  }
  if (type === CUBE_LIST || type === SPHERE_LIST) {
    const shape = solid(type === CUBE_LIST ? CUBE : SPHERE, scale);
    return triples(points).map(([x, y, z], index) => ({
      shape,
      matrix: own.clone().multiply(new Matrix4().makeTranslation(x, y, z)),
      color: colorAt(marker, index),
    }));
  }
  if (type === ARROW) return arrow(marker).map((part) => ({ ...part, color }));
  if (type === TRIANGLES) return [{ shape: triangles(points), matrix: own, color }];
  return [{ shape: ribbon(marker), matrix: own, color }];
}

/**
 * @param {Marker} marker
 * @param {number} index
 */
function colorAt({ color, colors }, index) {
  return linear(/** @type {any} */ (colors.length > 4 * index + 3 ? colors.slice(4 * index, 4 * index + 4) : color));
}

/** @param {[number, number, number, number]} color sRGB */
function linear([r, g, b]) {
  return [r, g, b].map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4));
}

/**
 * @param {number} type
 * @param {number[]} scale
 */
function solid(type, scale) {
  const key = `${type} ${scale}`;
  let shape = known.get(key);
  if (!shape) {
    shape = newSolid(type, /** @type {[number, number, number]} */ (scale));
    if (shape.index) shape = shape.toNonIndexed();
    if (known.size > 2000) known.clear();
    known.set(key, shape);
  }
  return shape;
}

/**
 * @param {number} type
 * @param {[number, number, number]} scale
 */
function newSolid(type, [x, y, z]) {
  const least = Math.min(x, y, z);
  const rounding = Math.min(ROUNDING, 0.18 * least);
  if (type === CUBE) {
    return least > 0 && Math.min(x, y) < LARGE ? new RoundedBoxGeometry(x, y, z, 2, rounding) : new BoxGeometry(x, y, z);
  }
  if (type === SPHERE) return new SphereGeometry(0.5, 24, 16).scale(x, y, z);
  const [radius, half] = [x / 2, z / 2];
  const edge = Math.min(rounding, 0.3 * radius);
  const outline = [
    new Vector2(0, -half),
    new Vector2(radius - edge, -half),
    new Vector2(radius - 0.3 * edge, -half + 0.3 * edge),
    new Vector2(radius, -half + edge),
    new Vector2(radius, half - edge),
    new Vector2(radius - 0.3 * edge, half - 0.3 * edge),
    new Vector2(radius - edge, half),
    new Vector2(0, half),
  ];
  const shape = sharp(outline, 36);
  return x === y ? shape : shape.scale(1, y / x, 1);
}

/**
 * Create a solid of revolution about z, shaded flat along the outline and smooth about the axis.
 * @param {any[]} outline
 * @param {number} segments
 */
function sharp(outline, segments) {
  const pieces = outline.slice(1).map((end, index) => {
    const piece = new LatheGeometry([outline[index], end], segments).toNonIndexed();
    return piece.rotateX(Math.PI / 2);
  });
  const count = pieces.reduce((sum, piece) => sum + piece.attributes.position.count, 0);
  const geometry = new BufferGeometry();
  for (const name of ["position", "normal"]) {
    const values = new Float32Array(3 * count);
    let at = 0;
    for (const piece of pieces) {
      values.set(piece.attributes[name].array, at);
      at += piece.attributes[name].array.length;
    }
    geometry.setAttribute(name, new BufferAttribute(values, 3));
  }
  return geometry;
}

/** @param {Marker} marker */
function arrow({ pose, scale, points }) {
  const own = matrixOf(pose);
  let [length, width, head] = [scale[0], scale[1], 0.25 * scale[0]];
  let headWidth = 2 * width;
  if (points.length >= 6) {
    const [from, to] = triples(points).map((at) => new Vector3().fromArray(at));
    const along = to.clone().sub(from);
    length = along.length();
    [width, headWidth] = [scale[0], scale[1]];
    head = scale[2] || 0.25 * length;
    const turn = new Quaternion().setFromUnitVectors(new Vector3(1, 0, 0), along.normalize());
    own.multiply(new Matrix4().compose(from, turn, UNIT));
  }
  const shaft = new CylinderGeometry(width / 2, width / 2, length - head, 16).toNonIndexed();
  const tip = new CylinderGeometry(0, headWidth / 2, head, 20).toNonIndexed();
  shaft.rotateZ(-Math.PI / 2).translate((length - head) / 2, 0, 0);
  tip.rotateZ(-Math.PI / 2).translate(length - head / 2, 0, 0);
  return [shaft, tip].map((shape) => ({ shape, matrix: own }));
}

/** @param {number[]} points */
function triangles(points) {
  const geometry = new BufferGeometry();
  const whole = points.length - (points.length % 9);
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points.slice(0, whole)), 3));
  geometry.computeVertexNormals();
  return geometry;
}

/** @param {Marker} marker */
function ribbon({ type, scale, points }) {
  const at = triples(points);
  const strips = type === LINE_STRIP ? [at] : at.filter((_, index) => index % 2 === 0).map((one, index) => [one, at[2 * index + 1] ?? one]);
  return ribbonOf(/** @type {[number, number, number][][]} */ (strips), scale[0] || 0.01);
}

/** @param {Marker} marker */
function label({ pose, scale, text, color }) {
  const canvas = document.createElement("canvas");
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const font = "600 48px system-ui, sans-serif";
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 24;
  canvas.height = 72;
  pen.font = font;
  pen.textBaseline = "middle";
  pen.lineWidth = 8;
  pen.strokeStyle = "#0008";
  pen.strokeText(text, 12, 38);
  pen.fillStyle = `rgba(${color.slice(0, 3).map((value) => Math.round(255 * value))}, ${color[3]})`;
  pen.fillText(text, 12, 38);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: true }));
  const height = 1.4 * (scale[2] || 0.2);
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  sprite.position.fromArray(pose);
  return sprite;
}

/** @param {Marker} marker */
function dots(marker) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(marker.points), 3));
  const colors = triples(marker.points).flatMap((_, index) => colorAt(marker, index));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 3));
  const found = new Points(geometry, new PointsMaterial({ size: marker.scale[0] || 0.03, vertexColors: true }));
  found.applyMatrix4(matrixOf(marker.pose));
  return found;
}
