// What the page uses of three.js, and nothing else.
export {
  BufferAttribute, BufferGeometry, Color, GLSL3, Group, LineSegments, Mesh, PerspectiveCamera,
  RawShaderMaterial, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
