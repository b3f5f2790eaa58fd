export {
  AmbientLight, BufferAttribute, BufferGeometry, Box3, Color, CylinderGeometry, DirectionalLight, DoubleSide, DynamicDrawUsage, Group,
  HemisphereLight, InstancedMesh, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Quaternion, Scene, SphereGeometry,
  Vector3, WebGLRenderer, GridHelper,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
