// Makes three.min.js, which is committed: `npm ci && npm run build`. The page has shaders of its own
// and draws no shadows, no environments and nothing in virtual reality: what serves those is left
// out, which brings the library from 490 to 300 kB.
import * as esbuild from "esbuild";
import { readFileSync } from "node:fs";

const left_out = {
  "ShaderChunk.js": "export const ShaderChunk = {};",
  "ShaderLib.js": "export const ShaderLib = {};",
  "PMREMGenerator.js": "export class PMREMGenerator {}",
  "WebGLShadowMap.js":
    "export class WebGLShadowMap { constructor() { this.enabled = false; } render() {} }",
  "WebXRManager.js": `
    import { EventDispatcher } from "three/src/core/EventDispatcher.js";
    export class WebXRManager extends EventDispatcher {
      constructor() { super(); this.enabled = false; this.isPresenting = false; }
      getCamera() { return null; }
      setAnimationLoop() {}
      dispose() {}
      getEnvironmentBlendMode() {}
      hasDepthSensing() { return false; }
      getFoveation() {}
    }`,
  "WebGLBackground.js": `
    import { Color } from "three/src/math/Color.js";
    export function WebGLBackground(renderer, cubemaps, cubeuvmaps, state) {
      const color = new Color(0);
      let alpha = 0;
      const clear = () => state.buffers.color.setClear(color.r, color.g, color.b, alpha, false);
      return {
        getClearColor: () => color,
        setClearColor(c, a = 1) { color.set(c); alpha = a; clear(); },
        getClearAlpha: () => alpha,
        setClearAlpha(a) { alpha = a; clear(); },
        render() {
          clear();
          if (!renderer.autoClear) return;
          state.buffers.depth.setTest(true);
          state.buffers.depth.setMask(true);
          state.buffers.color.setMask(true);
          renderer.clear(true, true, true);
        },
        addToRenderList() {},
        dispose() {},
      };
    }`,
};

const source = new URL("node_modules/three/src/Three.js", import.meta.url).pathname;
const { version } = JSON.parse(
  readFileSync(new URL("node_modules/three/package.json", import.meta.url), "utf8"),
);
await esbuild.build({
  entryPoints: ["entry.js"],
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "THREE",
  outfile: "three.min.js",
  legalComments: "none",
  banner: { js: `/* three.js ${version}, MIT, copyright 2010-2025 three.js authors */` },
  plugins: [
    {
      name: "left out",
      setup(build) {
        build.onResolve({ filter: /^three$/ }, () => ({ path: source }));
        build.onLoad({ filter: /three\/src\/.*\.js$/ }, ({ path }) => {
          const contents = left_out[path.split("/").pop()];
          return contents && { contents, resolveDir: process.cwd() };
        });
      },
    },
  ],
});
