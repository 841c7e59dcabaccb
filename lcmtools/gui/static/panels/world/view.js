// The view: sky, sun, ground and camera. It is drawn only after changes.

import {
  BackSide,
  Color,
  DirectionalLight,
  Fog,
  Group,
  HemisphereLight,
  Mesh,
  OrbitControls,
  PCFShadowMap,
  PerspectiveCamera,
  Raycaster,
  Scene,
  ShaderMaterial,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "../../vendor/three/three.js";
import { lines, plainGround } from "./ground.js";

const FARTHEST = 250; // [m]
const LIGHT = { zenith: "#5f9fe0", horizon: "#e3ecf4", below: "#c9cfd0", sun: 2.5, sky: 2.1 };
const DARK = { zenith: "#0d1622", horizon: "#33424f", below: "#20262c", sun: 1.3, sky: 0.8 };
const START = new Vector3(-2.5, -2.6, 1.15);
const SUN = new Vector3(-6, 3, 10);
const SHADOW_REACH = 14; // [m]

/** A scene on a canvas. */
export class View {
  /** @param {HTMLElement} place throws without WebGL */
  constructor(place) {
    // three.js writes an error to the console before it throws
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("no WebGL");
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.canvas = /** @type {HTMLCanvasElement} */ (this.renderer.domElement);
    place.append(this.canvas);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(45, 1, 0.05, 2 * FARTHEST);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.minDistance = 0.3;
    this.controls.maxDistance = 120;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.invalidate());
    this.content = new Group();
    this.scene.add(this.content);
    this.raycaster = new Raycaster();
    this.raycaster.params.Points.threshold = 0.03;
    this.until = Infinity;
    const { sky, sun, dome } = lights();
    this.sky = sky;
    this.sun = sun;
    this.dome = dome;
    this.ground = plainGround();
    this.scene.add(sky, sun, sun.target, dome, this.ground);
    this.scene.fog = new Fog("#ffffff", 30, 150);
    this.lookAt(START.toArray(), [0, 0, 0]);
    this.sizes = new ResizeObserver(() => this.resize(place));
    this.sizes.observe(place);
    this.resize(place);
    /** @type {(now: number) => void} */
    this.beforeDrawing = () => {};
    const draw = () => {
      this.frame = requestAnimationFrame(draw);
      const now = performance.now();
      if (now > this.until || !this.canvas.clientWidth) return;
      this.beforeDrawing(now);
      this.controls.update();
      this.follow();
      this.renderer.render(this.scene, this.camera);
      if (this.until === Infinity) this.until = now;
    };
    this.until = 0;
    this.frame = requestAnimationFrame(draw);
    this.invalidate();
  }

  /**
   * Draw again, and keep drawing for some time [ms].
   * @param {number} [time]
   */
  invalidate(time = 100) {
    this.until = Math.max(this.until, performance.now() + time);
  }

  /** Update all poses now, for pointer events that cannot wait for the next frame. */
  refresh() {
    this.beforeDrawing(performance.now());
    this.camera.updateMatrixWorld();
    this.scene.updateMatrixWorld();
  }

  /** @param {boolean} isDark */
  setTheme(isDark) {
    const look = isDark ? DARK : LIGHT;
    for (const name of /** @type {("zenith" | "horizon" | "below")[]} */ (["zenith", "horizon", "below"])) {
      this.dome.material.uniforms[name].value.set(look[name]);
    }
    this.sky.color.set(isDark ? "#8fa6c4" : "#dcebff");
    this.sky.groundColor.set(isDark ? "#4a4f55" : "#d8d3ca");
    this.sky.intensity = look.sky;
    this.sun.intensity = look.sun;
    this.scene.fog.color.set(look.horizon);
    lines.color.value.set(isDark ? "#06090c" : "#20303c");
    this.invalidate();
  }

  /** Move the sun, the sky and the ground's lines with the camera. */
  follow() {
    this.dome.position.copy(this.camera.position);
    lines.centre.value.copy(this.controls.target);
    const distance = this.camera.position.distanceTo(this.controls.target);
    const reach = Math.min(60, Math.max(5, distance * 1.1, SHADOW_REACH * 0.5));
    const { target, shadow, position } = this.sun;
    const texel = (2 * reach) / shadow.mapSize.x;
    target.position.copy(this.controls.target);
    target.position.x = Math.round(target.position.x / (16 * texel)) * 16 * texel;
    target.position.y = Math.round(target.position.y / (16 * texel)) * 16 * texel;
    target.position.z = 0;
    position.copy(target.position).addScaledVector(SUN, 3);
    if (shadow.camera.right !== reach) {
      Object.assign(shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 1, far: 90 });
      shadow.camera.updateProjectionMatrix();
    }
  }

  /**
   * Place the camera at a position, looking at a target.
   * @param {number[]} position
   * @param {number[]} target
   */
  lookAt(position, target) {
    this.camera.position.fromArray(position);
    this.controls.target.fromArray(target);
    this.controls.update();
    this.invalidate();
  }

  /** @param {number[]} target */
  lookFromBehind(target) {
    const at = new Vector3().fromArray(target);
    this.lookAt(START.clone().add(at).toArray(), target);
  }

  lookFromAbove() {
    const { target } = this.controls;
    const distance = Math.max(6, this.camera.position.distanceTo(target));
    this.lookAt([target.x - 0.001 * distance, target.y, target.z + distance], target.toArray());
  }

  /**
   * Move the camera and its target.
   * @param {number} x
   * @param {number} y
   * @param {number} z
   */
  shift(x, y, z) {
    for (const place of [this.camera.position, this.controls.target]) {
      place.x += x;
      place.y += y;
      place.z += z;
    }
    this.invalidate();
  }

  /**
   * Turn the camera about the target [rad], and change its distance by a factor.
   * @param {number} turn
   * @param {number} rise
   * @param {number} factor
   */
  move(turn, rise, factor) {
    const { position } = this.camera;
    const { target } = this.controls;
    const offset = position.clone().sub(target);
    const flat = Math.hypot(offset.x, offset.y) || 1e-6;
    const distance = Math.min(120, Math.max(0.3, offset.length() * factor));
    const up = Math.min(1.55, Math.max(0.02, Math.atan2(offset.z, flat) + rise));
    const around = Math.atan2(offset.y, offset.x) + turn;
    position.set(
      target.x + distance * Math.cos(up) * Math.cos(around),
      target.y + distance * Math.cos(up) * Math.sin(around),
      target.z + distance * Math.sin(up),
    );
    this.invalidate();
  }

  /**
   * Return the ray through a point of the window.
   * @param {PointerEvent} event
   */
  ray(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.raycaster.setFromCamera(new Vector2(x, y), this.camera);
    return this.raycaster;
  }

  /**
   * Return the intersection of the ray through a point of the window with a height; null if there is none.
   * @param {PointerEvent} event
   * @param {number} height
   * @returns {[number, number] | null}
   */
  place(event, height = 0) {
    const { origin, direction } = this.ray(event).ray;
    const way = (height - origin.z) / direction.z;
    if (!(way > 0) || way > FARTHEST) return null;
    return [origin.x + way * direction.x, origin.y + way * direction.y];
  }

  /** @param {HTMLElement} place */
  resize(place) {
    const { clientWidth: width, clientHeight: height } = place;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  close() {
    cancelAnimationFrame(this.frame);
    this.sizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

/** Create the light of the sky and the sun, and the sky itself. */
function lights() {
  const sky = new HemisphereLight();
  const sun = new DirectionalLight("#fff4e2");
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.bias = -0.0004;
  sun.shadow.normalBias = 0.012;
  sun.shadow.radius = 4;
  const dome = new Mesh(
    new SphereGeometry(FARTHEST, 32, 16),
    new ShaderMaterial({
      side: BackSide,
      depthWrite: false,
      fog: false,
      uniforms: { zenith: { value: new Color() }, horizon: { value: new Color() }, below: { value: new Color() } },
      vertexShader: `varying vec3 direction;
        void main() { direction = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
      fragmentShader: `varying vec3 direction; uniform vec3 zenith, horizon, below;
        void main() {
          float height = normalize(direction).z;
          vec3 color = height > 0.0 ? mix(horizon, zenith, pow(height, 0.55)) : mix(horizon, below, min(1.0, -height * 8.0));
          gl_FragColor = vec4(color, 1.0);
          #include <colorspace_fragment>
        }`,
    }),
  );
  dome.renderOrder = -1;
  return { sky, sun, dome };
}
