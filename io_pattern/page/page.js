"use strict";
// Everything that is said to people. Steps, needs and openings come with the data.
const TEXT = {
  model: "Model", sheet: "Pattern", steps: "Steps", pieces: "Pieces", seams: "Seams",
  needs: "What you need", about: "Selected", license: "Licence of three.js",
  explode: "Explode", colors: "Colours", reset: "Reset view", fit: "Whole pattern",
  measure: "Measure", back: "Back", play: "Play", next: "Next", pause: "Pause",
  zoomIn: "Zoom in", zoomOut: "Zoom out", step: "Step",
  dark: "Dark", light: "Light",
  byPiece: "Pieces", bySection: "Sections", byStrain: "Strain",
  strain: (percent) => [`compressed ${percent} %`, `stretched ${percent} %`],
  canvas: (title) => `${title} in 3D. Arrow keys turn it, plus and minus zoom.`,
  paper: "Pattern pieces on their sheets. Arrow keys move, plus and minus zoom.",
  page: (n) => `page ${n}`,
  nothing: "Point at a piece or a seam, or choose one below.",
  all: (n) => `${n} steps. Press Next to see the first.`,
  stepOf: (n, count, text) => `Step ${n} of ${count}. ${text}`,
  piece: (p) => `${p.name}, section ${p.section}: ${p.length} × ${p.width} mm, ${p.area} cm². ` +
    `Strained from −${p.compression} % to +${p.extension} % at the worst places.` +
    (p.cloth ? ` On the model: ${p.cloth}.` : ""),
  seam: (s, names, allowance) => `Seam ${s.label}${s.dart ? " (dart)" : ""}: ${names[0]} ` +
    `${s.sides[0].mm} mm to ${names[1]} ${s.sides[1].mm} mm` +
    (allowance > 0 ? `, allowance ${allowance} mm` : "") + `, done in step ${s.step}. ` +
    "Dots mark where both sides start.",
  distance: (mm) => `${mm.toFixed(1)} mm`,
  measureHint: "Choose two points.",
  noWebgl: "This browser shows no 3D (WebGL 2 is off): the pattern and the steps work without it.",
};

const DATA = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";

function element(name, attributes, parent) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
  return made;
}

function numbers(text, Type) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return new Type(bytes.buffer);
}

// What is shown: one state, which both views draw.
const state = { piece: -1, seam: -1, step: 0, colors: "byPiece", explode: 0, pinned: false };
const stepOfPiece = DATA.pieces.map((_, p) =>
  1 + DATA.steps.findIndex((step) => step.pieces.includes(p) ||
    step.seams.some((s) => DATA.seams[s].sides.some((side) => side.piece === p))));

// ---------------------------------------------------------------- the model

class ModelView {
  constructor(canvas, context) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 1, 1000);
    this.meshes = [];
    this.seams = [];
    this.flight = DATA.pieces.map(() => 0); // of each piece: 1 = far from its place
    const { low, size } = DATA.box;
    this.low = new THREE.Vector3(...low);
    this.size = size;
    const box = new THREE.Vector3();
    const high = new THREE.Vector3(-1e30, -1e30, -1e30);
    const centers = DATA.pieces.map((piece) => {
      const points = numbers(piece.points, Uint16Array);
      const center = new THREE.Vector3();
      for (let i = 0; i < points.length; i += 3) {
        box.set(points[i], points[i + 1], points[i + 2]);
        center.add(box);
        high.max(box);
      }
      piece.pointArray = points;
      return center.multiplyScalar(3 / points.length / 65535);
    });
    this.middle = high.multiplyScalar(0.5 / 65535);
    DATA.pieces.forEach((piece, p) => this.addPiece(piece, p, centers[p]));
    DATA.seams.forEach((seam) => this.addSeam(seam));
    this.radius = this.middle.length() * size;
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.raycaster = new THREE.Raycaster();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.reset();
    this.resize();
  }

  material(uniforms, isLine) {
    return new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      side: 2,
      depthTest: true,
      uniforms,
      vertexShader: `
        in vec3 position; ${isLine ? "" : "in float strain; out float v_strain; out vec3 v_place;"}
        uniform mat4 projectionMatrix, modelViewMatrix;
        void main() {
          vec4 place = modelViewMatrix * vec4(position, 1.0);
          ${isLine ? "place.xyz *= 0.9985;" : "v_strain = strain; v_place = place.xyz;"}
          gl_Position = projectionMatrix * place;
        }`,
      fragmentShader: `
        precision highp float;
        ${isLine ? "" : "in float v_strain; in vec3 v_place; uniform float by_strain, lit;"}
        uniform vec3 color;
        out vec4 pixel;
        void main() {
          vec3 c = color;
          ${isLine ? "" : `
          float s = clamp((v_strain * 255.0 - 128.0) / 127.0, -1.0, 1.0);
          vec3 end = s < 0.0 ? vec3(0.13, 0.40, 0.67) : vec3(0.70, 0.09, 0.17);
          c = mix(c, mix(vec3(0.95), end, abs(s)), by_strain);
          c = mix(c, vec3(1.0, 0.80, 0.22), lit);
          vec3 n = normalize(cross(dFdx(v_place), dFdy(v_place)));
          c *= 0.55 + 0.45 * abs(dot(n, normalize(vec3(-0.35, 0.55, 0.75))));`}
          pixel = vec4(c, 1.0);
        }`,
    });
  }

  addPiece(piece, p, center) {
    const Index = piece.bits === 16 ? Uint16Array : Uint32Array;
    const place = new THREE.BufferAttribute(piece.pointArray, 3, true);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", place);
    geometry.setAttribute("strain",
      new THREE.BufferAttribute(numbers(piece.strain, Uint8Array), 1, true));
    geometry.setIndex(new THREE.BufferAttribute(numbers(piece.faces, Index), 1));
    const uniforms = { color: { value: new THREE.Color() }, by_strain: { value: 0 }, lit: { value: 0 } };
    const mesh = new THREE.Mesh(geometry, this.material(uniforms, false));
    const border = new THREE.BufferGeometry();
    border.setAttribute("position", place);
    border.setIndex(new THREE.BufferAttribute(numbers(piece.border, Index), 1));
    const lines = new THREE.LineSegments(border,
      this.material({ color: { value: new THREE.Color(0x1b1b1b) } }, true));
    const group = new THREE.Group();
    group.add(mesh, lines);
    group.scale.setScalar(this.size);
    group.userData = { piece: p, away: center.sub(this.middle) };
    if (group.userData.away.length() < 0.02) group.userData.away.set(0, 0, 0.1);
    mesh.userData = group.userData;
    this.scene.add(group);
    this.meshes.push({ group, mesh, uniforms });
  }

  addSeam(seam) {
    this.seams.push(seam.sides.map((side) => {
      const points = numbers(side.model, Uint16Array);
      const pairs = [];
      for (let i = 0; i + 1 < points.length / 3; ++i) pairs.push(i, i + 1);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(points, 3, true));
      geometry.setIndex(pairs);
      const material = this.material({ color: { value: new THREE.Color(0xd01010) } }, true);
      material.depthTest = false;
      const line = new THREE.LineSegments(geometry, material);
      line.renderOrder = 2;
      line.visible = false;
      this.meshes[side.piece].group.add(line);
      return line;
    }));
  }

  reset() {
    const distance = 0.88 * spread() * this.radius / Math.sin((this.camera.fov / 2) * Math.PI / 180);
    this.controls.target.copy(this.middle).multiplyScalar(this.size).add(this.low);
    this.camera.position.set(-0.5, 0.3, 0.8).normalize().multiplyScalar(distance)
      .add(this.controls.target);
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = width < height ? 35 * height / width : 35;
    this.camera.updateProjectionMatrix();
    this.draw(true);
  }

  turn(x, y) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = offset.length();
    let azimuth = Math.atan2(offset.x, offset.z) + x;
    let height = Math.max(-1.5, Math.min(1.5, Math.asin(offset.y / length) + y));
    offset.set(Math.sin(azimuth) * Math.cos(height), Math.sin(height),
      Math.cos(azimuth) * Math.cos(height)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  pieceAt(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const place = new THREE.Vector2(2 * (x - box.left) / box.width - 1,
      1 - 2 * (y - box.top) / box.height);
    this.raycaster.setFromCamera(place, this.camera);
    const hits = this.raycaster.intersectObjects(
      this.meshes.filter(({ group }) => group.visible).map(({ mesh }) => mesh), false);
    return hits.length > 0 ? hits[0].object.userData.piece : -1;
  }

  // The colours of the state, at the next frame; `now` at once.
  draw(now) {
    if (!now) {
      if (this.waiting) return;
      this.waiting = true;
      requestAnimationFrame(() => this.draw(true));
      return;
    }
    this.waiting = false;
    this.meshes.forEach(({ group, uniforms }, p) => {
      const [r, g, b] = colorOf(p);
      uniforms.color.value.setRGB(r / 255, g / 255, b / 255, "srgb-linear");
      uniforms.by_strain.value = state.colors === "byStrain" ? 1 : 0;
      uniforms.lit.value = isLit(p) ? 0.75 : 0;
      const away = spread() - 1 + 2.5 * this.flight[p];
      group.position.copy(group.userData.away).multiplyScalar(away * this.size).add(this.low);
      group.visible = state.step === 0 || stepOfPiece[p] <= state.step;
    });
    this.seams.forEach((lines, s) => {
      const shown = s === state.seam || currentSeams().includes(s);
      for (const line of lines) line.visible = shown;
    });
    this.canvas.dataset.lit = DATA.pieces.filter((_, p) => isLit(p)).map((piece) => piece.name).join(" ");
    this.renderer.render(this.scene, this.camera);
  }
}

function sectionColor(section) {
  let number = 0;
  for (const letter of section) number = 26 * number + letter.charCodeAt(0) - 64;
  const hue = (60 + number * 137.5) % 360; // the first ones are not the yellow of what is lit
  const part = (n) => {
    const k = (n + hue / 30) % 12;
    return 255 * (0.62 - 0.27 * Math.max(-1, Math.min(k - 3, 9 - k, 1)));
  };
  return [part(0), part(8), part(4)];
}

const colorOf = (p) => (state.colors === "bySection"
  ? sectionColor(DATA.pieces[p].section) : DATA.pieces[p].color);
// Of the model, as far as it is exploded.
const spread = () => 1 + 1.1 * state.explode;
const currentSeams = () => (state.step > 0 ? DATA.steps[state.step - 1].seams : []);
const isLit = (p) => p === state.piece ||
  (state.seam >= 0 && DATA.seams[state.seam].sides.some((side) => side.piece === p)) ||
  (state.piece < 0 && state.seam < 0 && state.step > 0 && stepOfPiece[p] === state.step);

// ---------------------------------------------------------------- the sheet

class SheetView {
  constructor(paper) {
    this.paper = paper;
    this.svg = paper.querySelector("svg");
    for (const name of ["width", "height"]) this.svg.removeAttribute(name);
    this.svg.setAttribute("aria-label", TEXT.paper);
    const under = document.createElementNS(SVG, "g");
    this.svg.prepend(under);
    const pages = DATA.pages.length > 0 ? DATA.pages : [[0, 0, ...DATA.size]];
    // Pages that are glued overlap: the borders of all lie above their paper.
    for (const kind of ["paper", "border"])
      for (const [x, y, width, height] of pages)
        element("rect", { class: kind, x, y, width, height }, under);
    this.labels = [];
    const label = (text, x, y, room, name, parent) => {
      const made = element("text", { class: name, x, y }, parent);
      made.textContent = text;
      this.labels.push({ made, room });
    };
    this.groups = DATA.pieces.map((piece, p) => {
      const group = this.svg.querySelector(`[id="${piece.name}"]`);
      group.dataset.piece = p;
      group.setAttribute("role", "img");
      group.setAttribute("aria-label", TEXT.piece(piece));
      group.querySelector(`[id="${piece.name}-cut"]`).classList.add("outline");
      return group;
    });
    const over = element("g", {}, this.svg);
    if (DATA.pages.length > 0)
      pages.forEach(([x, y, width], i) => label(TEXT.page(i + 1), x, y, width, "number", over));
    this.names = element("g", { "aria-hidden": true }, this.svg);
    DATA.pieces.forEach((piece) => label(piece.name, ...piece.label, piece.length, "name", this.names));
    this.sides = DATA.seams.map((seam, s) => seam.sides.map((side) =>
      element("polyline", { class: "side", points: side.sheet.join(" "), "data-seam": s }, over)));
    this.marks = element("g", {}, this.svg);
    this.ruler = element("g", {}, this.svg);
    this.fit();
    this.listen();
  }

  show(x, y, width, height) {
    this.view = { x, y, width, height };
    this.svg.setAttribute("viewBox", `${x} ${y} ${width} ${height}`);
    // Names stay as large on the screen, until those of the drawing can be read.
    const size = Math.max(width, height) / 45;
    for (const { made, room } of this.labels) {
      made.style.fontSize = `${size}px`;
      made.style.display = room < 2 * size ? "none" : "";
    }
    this.names.style.display = size < 5 ? "none" : "";
  }
  fit() {
    const [width, height] = DATA.size;
    const border = 0.02 * Math.max(width, height);
    this.show(-border, -border, width + 2 * border, height + 2 * border);
  }
  zoom(factor, x, y) {
    const v = this.view;
    const cx = x === undefined ? v.x + v.width / 2 : x;
    const cy = y === undefined ? v.y + v.height / 2 : y;
    this.show(cx + (v.x - cx) * factor, cy + (v.y - cy) * factor, v.width * factor, v.height * factor);
  }
  move(x, y) {
    this.show(this.view.x + x, this.view.y + y, this.view.width, this.view.height);
  }
  point(event) {
    const at = new DOMPoint(event.clientX, event.clientY);
    return at.matrixTransform(this.svg.getScreenCTM().inverse());
  }

  listen() {
    const fingers = new Map();
    let moved = 0;
    this.paper.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, event);
      moved = 0;
    });
    this.paper.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (before === undefined) {
        if (event.pointerType !== "touch") this.pointAt(event.target, false);
        return;
      }
      const a = this.point(before);
      const b = this.point(event);
      moved += Math.hypot(event.clientX - before.clientX, event.clientY - before.clientY);
      if (fingers.size === 1) {
        this.move(a.x - b.x, a.y - b.y);
      } else {
        const other = [...fingers.values()].find((f) => f.pointerId !== event.pointerId);
        const o = this.point(other);
        const length = Math.hypot(b.x - o.x, b.y - o.y);
        if (length > 0) this.zoom(Math.hypot(a.x - o.x, a.y - o.y) / length, o.x, o.y);
      }
      fingers.set(event.pointerId, event);
    });
    const end = (event) => {
      const started = fingers.delete(event.pointerId);
      if (!started || moved > 6 || event.type !== "pointerup") return;
      if (this.measuring) this.addPoint(this.point(event));
      else this.pointAt(event.target, true);
    };
    for (const name of ["pointerup", "pointercancel"]) this.paper.addEventListener(name, end);
    this.paper.addEventListener("pointerleave", () => { fingers.clear(); choose(-1, -1, false); });
    this.paper.addEventListener("wheel", (event) => {
      event.preventDefault();
      const p = this.point(event);
      this.zoom(event.deltaY > 0 ? 1.15 : 1 / 1.15, p.x, p.y);
    }, { passive: false });
  }

  pointAt(target, pin) {
    const seam = target.closest("[data-seam]");
    const piece = target.closest("[data-piece]");
    if (seam) choose(-1, Number(seam.dataset.seam), pin);
    else choose(piece ? Number(piece.dataset.piece) : -1, -1, pin);
  }

  addPoint(p) {
    if (this.first === undefined) {
      this.first = p;
      this.ruler.replaceChildren();
      byId("distance").textContent = TEXT.measureHint;
      return;
    }
    element("line", { class: "ruler", x1: this.first.x, y1: this.first.y, x2: p.x, y2: p.y }, this.ruler);
    byId("distance").textContent = TEXT.distance(Math.hypot(p.x - this.first.x, p.y - this.first.y));
    this.first = undefined;
  }
  measure(on) {
    this.measuring = on;
    this.first = undefined;
    this.paper.classList.toggle("measuring", on);
    this.ruler.replaceChildren();
    byId("distance").textContent = on ? TEXT.measureHint : "";
  }

  draw() {
    this.groups.forEach((group, p) => {
      group.classList.toggle("piece-lit", isLit(p));
      group.classList.toggle("piece-later", state.step > 0 && stepOfPiece[p] > state.step);
      group.style.setProperty("--tint", `rgb(${colorOf(p).map(Math.round).join()})`);
    });
    this.svg.classList.toggle("tinted", state.colors !== "byStrain");
    this.sides.forEach((lines, s) => {
      const now = s === state.seam || currentSeams().includes(s);
      const done = state.step > 0 && DATA.seams[s].step < state.step;
      for (const line of lines) {
        line.classList.toggle("side-lit", now);
        line.classList.toggle("side-done", done && !now);
      }
    });
    this.marks.replaceChildren();
    if (state.seam >= 0)
      for (const side of DATA.seams[state.seam].sides)
        element("circle", { class: "start", cx: side.sheet[0], cy: side.sheet[1],
          r: 0.006 * this.view.width }, this.marks);
  }
}

// ---------------------------------------------------------------- lists and steps

let model = null;
let sheet = null;
let timer = 0;

function choose(piece, seam, pin) {
  if (!pin && state.pinned && piece < 0 && seam < 0) return;
  const same = piece === state.piece && seam === state.seam;
  if (pin && same && state.pinned) {
    state.pinned = false;
  } else if (pin) {
    state.pinned = piece >= 0 || seam >= 0;
  } else if (same) {
    return;
  }
  if (!pin) state.pinned = false;
  state.piece = piece;
  state.seam = seam;
  draw();
}

function draw() {
  if (model) model.draw();
  sheet.draw();
  [...byId("piece-list").children].forEach((button, p) => button.classList.toggle("lit", isLit(p)));
  [...byId("seam-list").children].forEach((button, s) =>
    button.classList.toggle("lit", s === state.seam || currentSeams().includes(s)));
  const names = (s) => s.sides.map((side) => DATA.pieces[side.piece].name);
  byId("about").textContent = state.seam >= 0
    ? TEXT.seam(DATA.seams[state.seam], names(DATA.seams[state.seam]), DATA.allowance)
    : state.piece >= 0 ? TEXT.piece(DATA.pieces[state.piece]) : TEXT.nothing;
}

function goTo(step) {
  const count = DATA.steps.length;
  const before = state.step;
  state.step = Math.max(0, Math.min(count, step));
  state.piece = state.seam = -1;
  state.pinned = false;
  byId("step").value = state.step;
  byId("back").disabled = state.step === 0;
  byId("next").disabled = state.step === count;
  byId("step-text").textContent = state.step === 0 ? TEXT.all(count)
    : TEXT.stepOf(state.step, count, DATA.steps[state.step - 1].text);
  byId("step").setAttribute("aria-valuetext", byId("step-text").textContent);
  [...byId("step-list").children].forEach((item, k) => {
    if (k + 1 === state.step) item.setAttribute("aria-current", "step");
    else item.removeAttribute("aria-current");
  });
  if (model && state.step > before && before + 1 === state.step) fly();
  draw();
}

// The pieces of the step fly to their place.
function fly() {
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const start = performance.now();
  const duration = still ? 0 : 700;
  const step = state.step;
  const frame = (now) => {
    const t = duration > 0 ? Math.min(1, (now - start) / duration) : 1;
    stepOfPiece.forEach((s, p) => { model.flight[p] = s === step && state.step === step ? (1 - t) ** 3 : 0; });
    model.draw(true);
    if (t < 1 && state.step === step) requestAnimationFrame(frame);
  };
  frame(start);
}

function play(on) {
  clearInterval(timer);
  byId("play").setAttribute("aria-pressed", String(on));
  byId("play").textContent = on ? TEXT.pause : TEXT.play;
  if (!on) return;
  if (state.step === DATA.steps.length) goTo(0);
  const go = () => (state.step < DATA.steps.length ? goTo(state.step + 1) : play(false));
  go();
  timer = setInterval(go, 1800);
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  byId("theme").textContent = theme === "dark" ? TEXT.light : TEXT.dark;
}

function fillTexts() {
  for (const place of document.querySelectorAll("[data-text]"))
    place.textContent = TEXT[place.dataset.text];
  byId("canvas").setAttribute("aria-label", TEXT.canvas(DATA.title));
  byId("paper").setAttribute("aria-label", TEXT.paper);
  byId("zoom-in").setAttribute("aria-label", TEXT.zoomIn);
  byId("zoom-out").setAttribute("aria-label", TEXT.zoomOut);
  byId("step").setAttribute("aria-label", TEXT.step);
  byId("step").max = DATA.steps.length;
  for (const name of ["byPiece", "bySection", "byStrain"])
    byId("colors").add(new Option(TEXT[name], name));
}

function fillLists() {
  const chip = (text, list, over) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(text);
    button.addEventListener("pointerenter", () => over(false));
    button.addEventListener("focus", () => over(false));
    button.addEventListener("click", () => over(true));
    list.append(button);
    return button;
  };
  DATA.pieces.forEach((piece, p) => {
    const button = chip(piece.name, byId("piece-list"), (pin) => choose(p, -1, pin));
    const dot = document.createElement("i");
    dot.style.background = `rgb(${piece.color.join()})`;
    button.prepend(dot);
  });
  DATA.seams.forEach((seam, s) =>
    chip(seam.label, byId("seam-list"), (pin) => choose(-1, s, pin)));
  DATA.steps.forEach((step, k) => {
    const item = document.createElement("li");
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = step.text;
    button.addEventListener("click", () => goTo(k + 1));
    item.append(button);
    byId("step-list").append(item);
  });
  for (const [name, value] of DATA.needs) {
    const dt = document.createElement("dt");
    const dd = document.createElement("dd");
    dt.textContent = name;
    dd.textContent = value;
    byId("needs").append(dt, dd);
  }
  for (const text of DATA.openings) {
    const item = document.createElement("li");
    item.textContent = text;
    byId("openings").append(item);
  }
}

function listen() {
  const canvas = byId("canvas");
  const keys = (move, zoom) => (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (way) move(...way);
    else if (event.key === "+" || event.key === "=") zoom(1 / 1.2);
    else if (event.key === "-") zoom(1.2);
    else return;
    event.preventDefault();
  };
  byId("paper").addEventListener("keydown", keys(
    (x, y) => sheet.move(0.1 * x * sheet.view.width, -0.1 * y * sheet.view.height),
    (factor) => sheet.zoom(factor)));
  if (model) {
    canvas.addEventListener("keydown",
      keys((x, y) => model.turn(0.15 * x, 0.15 * y), (factor) => model.zoom(factor)));
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = event; });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) choose(model.pieceAt(event.clientX, event.clientY), -1, false);
    });
    canvas.addEventListener("pointerup", (event) => {
      const still = down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 5;
      if (still) choose(model.pieceAt(event.clientX, event.clientY), -1, true);
    });
    canvas.addEventListener("pointerleave", () => choose(-1, -1, false));
    byId("reset").addEventListener("click", () => model.reset());
  }
  byId("explode").addEventListener("input", (event) => {
    const before = spread();
    state.explode = event.target.value / 100;
    model?.zoom(spread() / before); // all of it stays in sight
    draw();
  });
  byId("colors").addEventListener("change", (event) => {
    state.colors = event.target.value;
    byId("legend").hidden = state.colors !== "byStrain";
    draw();
  });
  const ends = TEXT.strain(Math.round(100 * DATA.strain));
  byId("legend").append(ends[0], document.createElement("span"), ends[1]);
  byId("fit").addEventListener("click", () => sheet.fit());
  byId("zoom-in").addEventListener("click", () => sheet.zoom(1 / 1.3));
  byId("zoom-out").addEventListener("click", () => sheet.zoom(1.3));
  byId("measure").addEventListener("click", (event) => {
    const on = event.target.getAttribute("aria-pressed") !== "true";
    event.target.setAttribute("aria-pressed", String(on));
    sheet.measure(on);
  });
  byId("back").addEventListener("click", () => { play(false); goTo(state.step - 1); });
  byId("next").addEventListener("click", () => { play(false); goTo(state.step + 1); });
  byId("play").addEventListener("click", (event) =>
    play(event.currentTarget.getAttribute("aria-pressed") !== "true"));
  byId("step").addEventListener("input", (event) => { play(false); goTo(Number(event.target.value)); });
  byId("theme").addEventListener("click", () =>
    setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
}

setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
fillTexts();
const context = byId("canvas").getContext("webgl2", { antialias: true });
if (context) model = new ModelView(byId("canvas"), context);
else byId("view").textContent = TEXT.noWebgl;
// The model is on the screen before lists and sheet are made: a browser that draws in software paints
// outlines and texts far longer than a model, and a new WebGL context would wait for them.
requestAnimationFrame(() => requestAnimationFrame(() => {
  performance.mark("model");
  fillLists();
  sheet = new SheetView(byId("paper"));
  listen();
  goTo(0);
  byId("paper").classList.add("shown");
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
}));
