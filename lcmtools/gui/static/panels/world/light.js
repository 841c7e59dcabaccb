// The materials that a sky and a sun light: each pixel, or only each corner on a computer without a GPU.

import * as THREE from "../../vendor/three/three.js";

/** The light, which all views share. With `isPlain`, new materials and shapes cost little to draw. */
export const light = {
  isPlain: false,
  /** Light from above, from the ground and from the sun, as a white surface reflects it. */
  uniforms: {
    skyColor: { value: new THREE.Color() },
    groundColor: { value: new THREE.Color() },
    sunColor: { value: new THREE.Color() },
    sunDirection: { value: new THREE.Vector3(0, 0, 1) },
  },
};

/** Create a material that is lit. @param {any} look the properties of a MeshStandardMaterial */
export function litMaterial({ roughness = 0.72, ...look }) {
  if (!light.isPlain) return new THREE.MeshStandardMaterial({ ...look, roughness, metalness: 0.03 });
  return Object.assign(new THREE.MeshBasicMaterial(look), { onBeforeCompile: lightCorners });
}

/** Light the corners of a material that has no light. @param {any} shader */
export function lightCorners(shader) {
  Object.assign(shader.uniforms, light.uniforms);
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", "#include <common>\nvarying vec3 shade; uniform vec3 skyColor, groundColor, sunColor, sunDirection;")
    .replace(
      "#include <begin_vertex>",
      `#include <begin_vertex>
      vec3 facing = normalize(mat3(modelMatrix) * normal);
      shade = mix(groundColor, skyColor, 0.5 + 0.5 * facing.z) + sunColor * max(0.0, dot(facing, sunDirection));`,
    );
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <common>", "#include <common>\nvarying vec3 shade;")
    .replace("#include <opaque_fragment>", "outgoingLight *= shade;\n#include <opaque_fragment>");
}
