export class BoxGeometry { constructor(...values: any[]); [name: string]: any }
export class BufferAttribute { constructor(...values: any[]); [name: string]: any }
export class BufferGeometry { constructor(...values: any[]); [name: string]: any }
export class CanvasTexture { constructor(...values: any[]); [name: string]: any }
export class Color { constructor(...values: any[]); [name: string]: any }
export class CylinderGeometry { constructor(...values: any[]); [name: string]: any }
export class DirectionalLight { constructor(...values: any[]); [name: string]: any }
export const DoubleSide: any;
export const BackSide: any;
export class Fog { constructor(...values: any[]); [name: string]: any }
export const FrontSide: any;
export class Group { constructor(...values: any[]); [name: string]: any }
export class HemisphereLight { constructor(...values: any[]); [name: string]: any }
export class InstancedMesh { constructor(...values: any[]); [name: string]: any }
export class LatheGeometry { constructor(...values: any[]); [name: string]: any }
export class Matrix4 { constructor(...values: any[]); [name: string]: any }
export class Mesh { constructor(...values: any[]); [name: string]: any }
export class MeshBasicMaterial { constructor(...values: any[]); [name: string]: any }
export class MeshStandardMaterial { constructor(...values: any[]); [name: string]: any }
export const NearestFilter: any;
export const PCFShadowMap: any;
export class PerspectiveCamera { constructor(...values: any[]); [name: string]: any }
export class PlaneGeometry { constructor(...values: any[]); [name: string]: any }
export class Points { constructor(...values: any[]); [name: string]: any }
export class PointsMaterial { constructor(...values: any[]); [name: string]: any }
export class Quaternion { constructor(...values: any[]); [name: string]: any }
export class Raycaster { constructor(...values: any[]); [name: string]: any }
export class Scene { constructor(...values: any[]); [name: string]: any }
export class ShaderMaterial { constructor(...values: any[]); [name: string]: any }
export class SphereGeometry { constructor(...values: any[]); [name: string]: any }
export class Sprite { constructor(...values: any[]); [name: string]: any }
export class SpriteMaterial { constructor(...values: any[]); [name: string]: any }
export class Vector2 { constructor(...values: any[]); [name: string]: any }
export class Vector3 { constructor(...values: any[]); [name: string]: any }
export class WebGLRenderer { constructor(...values: any[]); [name: string]: any }
export class OrbitControls { constructor(...values: any[]); [name: string]: any }
export class RoundedBoxGeometry { constructor(...values: any[]); [name: string]: any }
