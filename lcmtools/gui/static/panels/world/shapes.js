// Markers as meshes. All markers of a body share one mesh, so that many robots are drawn quickly.

import * as THREE from "../../vendor/three/three.js";
import { UNIT, geometryOf, matrixOf, ribbonOf, triples } from "./geometry.js";
import { groundMaterial } from "./ground.js";
import { light, litMaterial } from "./light.js";

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
export const TRIANGLES = 11; // the last one
export const SOLIDS = [ARROW, CUBE, SPHERE, CYLINDER, CUBE_LIST, SPHERE_LIST]; // which have no size without a scale
const LARGE = 30; // [m]; longer and wider boxes are ground, which casts no shadow
const ROUNDING = 0.012; // [m] of edges
const LONGEST = 120; // characters of a text: a texture is no wider

/** The cached shapes of markers, by type and size. */
const known = new Map();

/**
 * Create a group with the markers of one body, in its frame.
 * @param {Marker[]} markers
 * @returns {any} a group
 */
export function bodyOf(markers) {
  const group = new THREE.Group();
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
  const point = new THREE.Vector3();
  let at = 0;
  for (const { shape, matrix, color } of parts) {
    const { position, normal } = shape.attributes;
    for (let index = 0; index < position.count; index += 1, at += 3) {
      point.fromBufferAttribute(position, index).applyMatrix4(matrix).toArray(places, at);
      point.fromBufferAttribute(normal, index).transformDirection(matrix).toArray(normals, at);
      colors.set(color, at);
    }
  }
  const material = litMaterial({
    vertexColors: true,
    transparent: opacity < 1,
    opacity,
    depthWrite: opacity === 1,
    side: offset ? THREE.DoubleSide : THREE.FrontSide,
    polygonOffset: offset !== 0,
    polygonOffsetFactor: offset,
    polygonOffsetUnits: 4 * offset,
  });
  const mesh = new THREE.Mesh(geometryOf({ position: places, normal: normals, color: colors }), material);
  return Object.assign(mesh, { castShadow: shadow, receiveShadow: true });
}

/** @param {Marker} marker @returns {{shape: any, matrix: any, color: number[]}[]} */
function partsOf(marker) {
  const { type, scale, points } = marker;
  const own = matrixOf(marker.pose);
  const color = linear(marker.color);
  if (type === ARROW) return arrow(marker).map((part) => ({ ...part, color }));
  if (type === CUBE_LIST || type === SPHERE_LIST) {
    const shape = solid(type === CUBE_LIST ? CUBE : SPHERE, scale);
    return triples(points).map(([x, y, z], index) => ({
      shape,
      matrix: own.clone().multiply(new THREE.Matrix4().makeTranslation(x, y, z)),
      color: colorAt(marker, index),
    }));
  }
  const isSimple = type === CUBE || type === SPHERE || type === CYLINDER;
  const shape = isSimple ? solid(type, scale) : type === TRIANGLES ? triangles(points) : ribbon(marker);
  return [{ shape, matrix: own, color }];
}

/** @param {Marker} marker @param {number} index */
function colorAt({ color, colors }, index) {
  return linear(/** @type {any} */ (colors.length > 4 * index + 3 ? colors.slice(4 * index, 4 * index + 4) : color));
}

/** @param {[number, number, number, number]} color sRGB */
function linear([r, g, b]) {
  return [r, g, b].map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4));
}

/** @param {number} type @param {number[]} scale */
function solid(type, scale) {
  const key = `${light.isPlain} ${type} ${scale}`;
  let shape = known.get(key);
  if (!shape) {
    shape = newSolid(type, /** @type {[number, number, number]} */ (scale));
    if (shape.index) shape = shape.toNonIndexed();
    if (known.size > 2000) known.clear();
    known.set(key, shape);
  }
  return shape;
}

/** @param {number} type @param {[number, number, number]} scale */
function newSolid(type, [x, y, z]) {
  const { isPlain } = light;
  const least = Math.min(x, y, z);
  const rounding = Math.min(ROUNDING, 0.18 * least);
  if (type === CUBE) {
    return least > 0 && !isPlain && Math.min(x, y) < LARGE ? new THREE.RoundedBoxGeometry(x, y, z, 2, rounding) : new THREE.BoxGeometry(x, y, z);
  }
  if (type === SPHERE) return (isPlain ? new THREE.SphereGeometry(0.5, 16, 10) : new THREE.SphereGeometry(0.5, 24, 16)).scale(x, y, z);
  if (isPlain) return new THREE.CylinderGeometry(0.5, 0.5, z, 20).rotateX(Math.PI / 2).scale(x, y, 1);
  const [radius, half] = [x / 2, z / 2];
  const edge = Math.min(rounding, 0.3 * radius);
  const top = [[0, half], [radius - edge, half], [radius - 0.3 * edge, half - 0.3 * edge], [radius, half - edge]];
  const bottom = top.map(([across, up = 0]) => [across, -up]);
  const shape = sharp([...bottom, ...top.toReversed()].map((at) => new THREE.Vector2(...at)), 36);
  return x === y ? shape : shape.scale(1, y / x, 1);
}

/**
 * Create a solid of revolution about z, shaded flat along the outline and smooth about the axis.
 * @param {any[]} outline
 * @param {number} segments
 */
function sharp(outline, segments) {
  const pieces = outline.slice(1).map((end, index) =>
    new THREE.LatheGeometry([outline[index], end], segments).toNonIndexed().rotateX(Math.PI / 2),
  );
  /** @param {string} name */
  const joined = (name) => new Float32Array(pieces.flatMap(({ attributes }) => [...attributes[name].array]));
  return geometryOf({ position: joined("position"), normal: joined("normal") });
}

/** @param {Marker} marker */
function arrow({ pose, scale, points }) {
  const own = matrixOf(pose);
  let [length, width, head] = [scale[0], scale[1], 0.25 * scale[0]];
  let headWidth = 2 * width;
  if (points.length >= 6) {
    const [from, to] = triples(points).map((at) => new THREE.Vector3().fromArray(at));
    const along = to.clone().sub(from);
    length = along.length();
    [width, headWidth] = [scale[0], scale[1]];
    head = scale[2] || 0.25 * length;
    const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(1, 0, 0), along.normalize());
    own.multiply(new THREE.Matrix4().compose(from, turn, UNIT));
  }
  const shaft = new THREE.CylinderGeometry(width / 2, width / 2, length - head, 16).toNonIndexed();
  const tip = new THREE.CylinderGeometry(0, headWidth / 2, head, 20).toNonIndexed();
  shaft.rotateZ(-Math.PI / 2).translate((length - head) / 2, 0, 0);
  tip.rotateZ(-Math.PI / 2).translate(length - head / 2, 0, 0);
  return [shaft, tip].map((shape) => ({ shape, matrix: own }));
}

/** @param {number[]} points */
function triangles(points) {
  const whole = points.length - (points.length % 9);
  const geometry = geometryOf({ position: new Float32Array(points.slice(0, whole)) });
  geometry.computeVertexNormals();
  return geometry;
}

/** @param {Marker} marker */
function ribbon({ type, scale, points }) {
  const at = triples(points);
  const strips = type === LINE_STRIP ? [at] : at.filter((_, index) => index % 2 === 0).map((one, index) => [one, at[2 * index + 1] ?? one]);
  return ribbonOf(/** @type {[number, number, number][][]} */ (strips), scale[0] || 0.01);
}

/** @param {Pick<Marker, "pose" | "scale" | "text" | "color">} marker */
export function label({ pose, scale, text: whole, color }) {
  const text = whole.length > LONGEST ? `${whole.slice(0, LONGEST)}…` : whole;
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
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), depthTest: true }));
  const height = 1.4 * (scale[2] || 0.2);
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  sprite.position.fromArray(pose);
  return sprite;
}

/** @param {Marker} marker */
function dots(marker) {
  const colors = triples(marker.points).flatMap((_, index) => colorAt(marker, index));
  const geometry = geometryOf({ position: new Float32Array(marker.points), color: new Float32Array(colors) });
  const found = new THREE.Points(geometry, new THREE.PointsMaterial({ size: marker.scale[0] || 0.03, vertexColors: true }));
  found.applyMatrix4(matrixOf(marker.pose));
  return found;
}
