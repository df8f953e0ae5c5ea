"use strict";
// Plays a motion. `motion` is what src/player/player_document.cpp writes; places are in the scene's world, turned as a
// whole so that up is y.

(async () => {
const motion = JSON.parse(document.getElementById("motion").textContent);
const page = id => document.getElementById(id);
const told = document.body.dataset;  // for those who read the page by program

function complain(text) {
  page("message").textContent = told.error = text;
}

/// The numbers of an array that was packed: gzip, then base64.
async function unpacked(text, Numbers) {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Numbers(await new Response(stream).arrayBuffer());
}

if (typeof DecompressionStream === "undefined") {
  complain("This browser cannot unpack the motion; take one of 2023 or later.");
  return;
}
const times = await unpacked(motion.times, Float64Array);        // s, of each frame
const states = await unpacked(motion.states, Float64Array);      // 13 numbers a body that moves, frame by frame
const energies = await unpacked(motion.energies, Float64Array);  // J: kinetic, potential, dissipated, work; frame by frame
const forces = await unpacked(motion.forces, Float32Array);      // 6 numbers a contact: N; m
const firstForces = await unpacked(motion.firstForces, Uint32Array);  // of each frame, and the end
const other = motion.other && { ...motion.other, states: await unpacked(motion.other.states, Float64Array) };
const frames = times.length, moving = motion.moving;  // bodies that move, by number
const kState = 13;
const movingIndex = new Map(moving.map((body, index) => [body, index]));
const bodyByName = new Map(motion.bodies.map((body, number) => [body.name, number]));

// ---------------------------------------------------------------------------------------------------------- picture

const renderer = new THREE.WebGLRenderer({ canvas: page("picture"), antialias: true, preserveDrawingBuffer: true });
renderer.gammaOutput = true;
renderer.gammaFactor = 2.2;
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = THREE.PCFSoftShadowMap;
renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
const kSky = new THREE.Color(0xc9d5df);
const scene = new THREE.Scene();
scene.background = kSky;
const size = motion.size;  // m: of what is shown
scene.fog = new THREE.Fog(kSky, 12 * size, 40 * size);
const upright = new THREE.Group(), world = new THREE.Group();
const turn = new THREE.Quaternion(motion.uprightFromWorld[1], motion.uprightFromWorld[2], motion.uprightFromWorld[3], motion.uprightFromWorld[0]);
world.quaternion.copy(turn);
scene.add(upright, world);

const vector = numbers => new THREE.Vector3(...numbers);
// All is drawn from the middle of what is shown: 32-bit numbers are exact enough there, however far it is from the origin.
const middle = vector(motion.middle), origin = middle.clone().applyQuaternion(turn.clone().conjugate());  // of upright, of world
const camera = new THREE.PerspectiveCamera(motion.camera.verticalFieldOfView, 1, size / 500, 100 * size);
camera.position.copy(vector(motion.camera.position)).sub(middle);
camera.up.copy(vector(motion.camera.up));
const orbit = new THREE.OrbitControls(camera, renderer.domElement);
// On the way of the look, beside the middle: what is turned about.
const look = vector(motion.camera.target).sub(middle).sub(camera.position).normalize();
orbit.target.copy(camera.position).addScaledVector(look, Math.max(-look.dot(camera.position), size / 100));
orbit.enableKeys = false;  // the arrows are for frames
orbit.update();

scene.add(new THREE.HemisphereLight(0xffffff, 0x8d8577, 0.75));
const sun = new THREE.DirectionalLight(0xfff4e6, 0.9);
sun.position.set(0.45, 1, 0.35).normalize().multiplyScalar(3 * size);
sun.castShadow = true;
sun.shadow.mapSize.set(2048, 2048);
sun.shadow.bias = -0.0005;
Object.assign(sun.shadow.camera, { left: -1.2 * size, right: 1.2 * size, top: 1.2 * size, bottom: -1.2 * size, near: size / 10, far: 6 * size });
scene.add(sun, sun.target);

/// A material whose colour, pattern (kind, cell in m, whether the mesh's own colours count) and its colour are those of
/// each instance.
function paintedMaterial(options) {
  const material = new THREE.MeshStandardMaterial({ roughness: 0.5, metalness: 0.05, ...options });
  material.onBeforeCompile = shader => {
    shader.vertexShader = `
      attribute vec3 tint, patternTint, vertexTint;
      attribute vec3 pattern;
      varying vec3 vTint, vPatternTint, vPlace;
      varying vec2 vPattern;
    ` + shader.vertexShader.replace("#include <begin_vertex>", `#include <begin_vertex>
      vTint = tint * mix(vec3(1.0), vertexTint, pattern.z);
      vPatternTint = patternTint;
      vPattern = pattern.xy;
      vPlace = position * vec3(length(instanceMatrix[0].xyz), length(instanceMatrix[1].xyz), length(instanceMatrix[2].xyz));
    `);
    shader.fragmentShader = `
      #extension GL_OES_standard_derivatives : enable
      varying vec3 vTint, vPatternTint, vPlace;
      varying vec2 vPattern;
      // -1 and 1 in turn from whole number to whole number of x.
      float alternating(float x) {
        float wave = abs(mod(x + 0.5, 2.0) - 1.0) - 0.5;
        return clamp(2.0 * wave / max(fwidth(x), 1e-6), -1.0, 1.0);
      }
      vec3 painted() {
        if (vPattern.x < 0.5) return vTint;
        vec3 place = 0.999 * vPlace / vPattern.y + 0.002;
        float share = alternating(place.x);
        if (vPattern.x > 1.5) share *= alternating(place.y) * alternating(place.z);
        if (vPattern.x > 2.5) {
          float sine = place.z / max(length(place.xz), 1e-6), sixth = sine * (3.0 - 4.0 * sine * sine);
          share = clamp(2.0 * sixth / max(fwidth(sixth), 1e-6), -1.0, 1.0);
        }
        return mix(vTint, vPatternTint, 0.5 + 0.5 * share);
      }
    ` + shader.fragmentShader.replace("#include <color_fragment>", "diffuseColor.rgb *= painted();");
  };
  return material;
}

async function geometryOf(shape) {
  if (shape.kind === "sphere") return new THREE.SphereBufferGeometry(1, 32, 20);
  if (shape.kind === "box") return new THREE.BoxBufferGeometry(1, 1, 1);
  if (shape.kind === "cylinder") return new THREE.CylinderBufferGeometry(1, 1, 1, 32);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(await unpacked(shape.positions, Float32Array), 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(await unpacked(shape.normals, Float32Array), 3));
  if (shape.tints) geometry.setAttribute("vertexTint", new THREE.BufferAttribute(await unpacked(shape.tints, Float32Array), 3));
  geometry.setIndex(new THREE.BufferAttribute(await unpacked(shape.triangles, Uint32Array), 1));
  return geometry;
}

/// So many things of one shape, drawn at once.
function instances(geometry, things, material, castsShadow = true) {
  const own = geometry.clone();
  const attribute = (name, width, numbersOf) =>
      own.setAttribute(name, new THREE.InstancedBufferAttribute(new Float32Array(things.flatMap(numbersOf)), width));
  attribute("tint", 3, thing => thing.color);
  attribute("pattern", 3, thing => thing.pattern || [0, 1, 0]);
  attribute("patternTint", 3, thing => thing.patternColor || [0, 0, 0]);
  const mesh = new THREE.InstancedMesh(own, material, things.length);
  mesh.frustumCulled = false;
  mesh.castShadow = castsShadow, mesh.receiveShadow = true;
  world.add(mesh);
  return mesh;
}

// Poses of all bodies, of the frame that is shown: 7 numbers each, place of the reference point and quaternion w first.
const poses = new Float64Array(7 * motion.bodies.length), otherPoses = other && new Float64Array(7 * motion.bodies.length);
motion.bodies.forEach((body, number) => {
  if (!body.place) return;
  poses.set(body.place, 7 * number);
  if (other) otherPoses.set(body.place, 7 * number);
});

/// Between a frame and the next one, at a share of 0 to 1.
function takePoses(from, into, frame, share) {
  const width = kState * moving.length, next = Math.min(frame + 1, frames - 1);
  for (let i = 0; i < moving.length; ++i) {
    const a = frame * width + kState * i, b = next * width + kState * i, at = 7 * moving[i];
    let dot = 0, norm = 0;
    for (let k = 3; k < 7; ++k) dot += from[a + k] * from[b + k];
    const sign = dot < 0 ? -1 : 1;
    for (let k = 0; k < 7; ++k)
      into[at + k] = (1 - share) * from[a + k] + share * (k < 3 ? 1 : sign) * from[b + k];
    for (let k = 3; k < 7; ++k) norm += into[at + k] ** 2;
    norm = Math.sqrt(norm);
    for (let k = 3; k < 7; ++k) into[at + k] /= norm;
  }
}

/// Writes a matrix: a turn by the quaternion (w, x, y, z), of columns that are scaled, and a place in the world.
function writeMatrix(matrices, index, w, x, y, z, px, py, pz, sx, sy, sz) {
  const m = 16 * index;
  matrices[m] = sx * (1 - 2 * (y * y + z * z)), matrices[m + 1] = sx * 2 * (x * y + w * z), matrices[m + 2] = sx * 2 * (x * z - w * y);
  matrices[m + 4] = sy * 2 * (x * y - w * z), matrices[m + 5] = sy * (1 - 2 * (x * x + z * z)), matrices[m + 6] = sy * 2 * (y * z + w * x);
  matrices[m + 8] = sz * 2 * (x * z + w * y), matrices[m + 9] = sz * 2 * (y * z - w * x), matrices[m + 10] = sz * (1 - 2 * (x * x + y * y));
  matrices[m + 12] = px - origin.x, matrices[m + 13] = py - origin.y, matrices[m + 14] = pz - origin.z, matrices[m + 15] = 1;
}

/// A point (x, y, z) of a body in the world; body -1 is the world.
function worldPoint(from, body, x, y, z, out) {
  if (body < 0) return out.set(x, y, z);
  const at = 7 * body, w = from[at + 3], a = from[at + 4], b = from[at + 5], c = from[at + 6];
  const tx = 2 * (b * z - c * y), ty = 2 * (c * x - a * z), tz = 2 * (a * y - b * x);
  return out.set(from[at] + x + w * tx + b * tz - c * ty, from[at + 1] + y + w * ty + c * tx - a * tz, from[at + 2] + z + w * tz + a * ty - b * tx);
}

const point = new THREE.Vector3(), start = new THREE.Vector3(), end = new THREE.Vector3();
const kY = new THREE.Vector3(0, 1, 0), quaternion = new THREE.Quaternion();

function placeThings(group, from) {
  const matrices = group.mesh.instanceMatrix.array;
  group.things.forEach((thing, index) => {
    const [lx, ly, lz, lw, la, lb, lc] = thing.local, [sx, sy, sz] = thing.scale, at = 7 * thing.body;
    worldPoint(from, thing.body, lx, ly, lz, point);
    let w = lw, x = la, y = lb, z = lc;
    if (thing.body >= 0) {
      const qw = from[at + 3], qx = from[at + 4], qy = from[at + 5], qz = from[at + 6];
      w = qw * lw - qx * la - qy * lb - qz * lc, x = qw * la + qx * lw + qy * lc - qz * lb;
      y = qw * lb - qx * lc + qy * lw + qz * la, z = qw * lc + qx * lb - qy * la + qz * lw;
    }
    writeMatrix(matrices, index, w, x, y, z, point.x, point.y, point.z, sx, sy, sz);
  });
  group.mesh.instanceMatrix.needsUpdate = true;
}

/// A cylinder, coil or arrow from a place to another, of a radius (m).
function writeBar(matrices, index, from, to, radius) {
  point.subVectors(to, from);
  const length = point.length();
  if (length > 0) quaternion.setFromUnitVectors(kY, point.divideScalar(length));
  else quaternion.set(0, 0, 0, 1);
  writeMatrix(matrices, index, quaternion.w, quaternion.x, quaternion.y, quaternion.z, (from.x + to.x) / 2, (from.y + to.y) / 2,
              (from.z + to.z) / 2, radius, length, radius);
}

// Ground: an endless floor with squares.
if (motion.ground) {
  const ground = motion.ground, width = 80 * size;
  const material = new THREE.MeshStandardMaterial({ roughness: 0.9, metalness: 0 });
  material.onBeforeCompile = shader => {
    shader.vertexShader = "varying vec2 vSquare;\n" + shader.vertexShader.replace("#include <begin_vertex>",
        `#include <begin_vertex>\nvSquare = position.xz / ${ground.square.toFixed(9)};`);
    shader.fragmentShader = `
      #extension GL_OES_standard_derivatives : enable
      varying vec2 vSquare;
    ` + shader.fragmentShader.replace("#include <color_fragment>", `
      vec2 far = fwidth(vSquare), wave = abs(mod(vSquare + 0.5, 2.0) - 1.0) - 0.5;
      vec2 side = clamp(2.0 * wave / max(far, vec2(1e-6)), -1.0, 1.0);
      float share = 0.5 + 0.5 * side.x * side.y * clamp(1.5 - max(far.x, far.y), 0.0, 1.0);
      diffuseColor.rgb = mix(vec3(${ground.dark.map(c => c.toFixed(4))}), vec3(${ground.light.map(c => c.toFixed(4))}), share);
    `);
  };
  const floor = new THREE.Mesh(new THREE.PlaneBufferGeometry(width, width).rotateX(-Math.PI / 2), material);
  // Squares begin at the plane's own point, however far away the motion is.
  const normal = vector(ground.normal), place = vector(ground.point).sub(middle), period = 2 * ground.square;
  floor.quaternion.setFromUnitVectors(kY, normal);
  const local = place.clone().negate().applyQuaternion(floor.quaternion.clone().conjugate());
  local.set(period * Math.round(local.x / period), 0, period * Math.round(local.z / period));
  floor.position.copy(place).add(local.applyQuaternion(floor.quaternion));
  floor.receiveShadow = true;
  upright.add(floor);
}

const solid = paintedMaterial({}), ghost = paintedMaterial({ transparent: true, opacity: 0.45, depthWrite: false });
const geometries = await Promise.all(motion.shapes.map(geometryOf));
const groups = [], ghosts = [];
motion.shapes.forEach((shape, number) => {
  const things = motion.things.filter(thing => thing.shape === number);
  if (things.length === 0) return;
  groups.push({ things, mesh: instances(geometries[number], things, solid), geometry: geometries[number] });
  const moved = things.filter(thing => movingIndex.has(thing.body)).map(thing => ({ ...thing, color: [0.8, 0.05, 0.05], pattern: [0, 1, 0] }));
  if (other && moved.length > 0) ghosts.push({ things: moved, mesh: instances(geometries[number], moved, ghost, false) });
});

// Springs, rods and ropes.
const linksOf = (kind, color) => kind.map(ends => ({ ends, color }));
const bars = [...linksOf(motion.rods, motion.colors.rod), ...linksOf(motion.ropes, motion.colors.rope)];
const coils = linksOf(motion.springs, motion.colors.spring);
const barMesh = bars.length > 0 && instances(new THREE.CylinderBufferGeometry(1, 1, 1, 12), bars, solid);
class Helix extends THREE.Curve {
  getPoint(t) {
    const turns = 8, lead = 0.07, inner = Math.min(1, Math.max(0, (t - lead) / (1 - 2 * lead)));
    const out = Math.min(1, Math.min(t, 1 - t) / lead), angle = 2 * Math.PI * turns * inner;
    return new THREE.Vector3(out * Math.cos(angle), t - 0.5, out * Math.sin(angle));
  }
}
let coilMesh = null;
if (coils.length > 0) {
  // The wire is round in a coil as long as the first one is at the start.
  const geometry = new THREE.TubeBufferGeometry(new Helix(), 240, 0.16, 7), slender = motion.coilRadius / motion.coilLength;
  const positions = geometry.getAttribute("position"), normals = geometry.getAttribute("normal"), helix = new Helix();
  for (let i = 0; i < positions.count; ++i) {
    const offset = 0.16 * normals.getY(i);
    positions.setY(i, positions.getY(i) - offset + offset * slender);
  }
  coilMesh = instances(geometry, coils, solid);
}

function placeLinks() {
  const place = (links, mesh, radius) => {
    links.forEach(({ ends }, index) => {
      worldPoint(poses, ends[0], ends[1], ends[2], ends[3], start);
      worldPoint(poses, ends[4], ends[5], ends[6], ends[7], end);
      writeBar(mesh.instanceMatrix.array, index, start, end, radius);
    });
    mesh.instanceMatrix.needsUpdate = true;
  };
  if (barMesh) place(bars, barMesh, motion.linkRadius);
  if (coilMesh) place(coils, coilMesh, motion.coilRadius);
}

// Arrows, on the body that moves: forces of contacts that last, and impulses of impacts for a moment.
const kMaxArrows = 600, kImpulseShown = 0.12;  // s of film
const arrowGeometry = (() => {
  const shaft = new THREE.CylinderBufferGeometry(0.4, 0.4, 0.75, 10).translate(0, -0.125, 0), tip = new THREE.ConeBufferGeometry(1, 0.25, 16).translate(0, 0.375, 0);
  const joined = new THREE.BufferGeometry(), count = shaft.getAttribute("position").count;
  for (const name of ["position", "normal"])
    joined.setAttribute(name, new THREE.BufferAttribute(new Float32Array([...shaft.getAttribute(name).array, ...tip.getAttribute(name).array]), 3));
  joined.setIndex([...shaft.index.array, ...Array.from(tip.index.array, i => i + count)]);
  return joined;
})();
const arrowMesh = instances(arrowGeometry, Array.from({ length: kMaxArrows }, () => ({ color: [0.9, 0.35, 0.02] })), solid, false);
const largest = values => values.reduce((most, value) => Math.max(most, value), 0);
const forceSizes = Array.from({ length: forces.length / 6 }, (_, i) => Math.hypot(forces[6 * i], forces[6 * i + 1], forces[6 * i + 2])).sort((a, b) => a - b);
const largeForce = forceSizes[Math.floor(0.95 * (forceSizes.length - 1))] || 1;
const impacts = motion.events.filter(event => event.kind === "impact"), largeImpulse = largest(impacts.map(event => event.impulse)) || 1;
const kArrow = 0.22 * size;  // m: of a large force
let showsForces = false;

function placeArrows(frame, time) {
  let count = 0;
  const add = (x, y, z, dx, dy, dz, length) => {
    const norm = Math.hypot(dx, dy, dz);
    if (count === kMaxArrows || !(norm > 0) || !(length > 0.002 * size)) return;
    start.set(x, y, z);
    end.set(x + dx / norm * length, y + dy / norm * length, z + dz / norm * length);
    writeBar(arrowMesh.instanceMatrix.array, count++, start, end, 0.012 * size);
  };
  if (showsForces) {
    for (let i = firstForces[frame]; i < firstForces[frame + 1]; ++i)
      add(forces[6 * i + 3], forces[6 * i + 4], forces[6 * i + 5], forces[6 * i], forces[6 * i + 1], forces[6 * i + 2],
          kArrow * Math.min(1, forceSizes.length ? Math.hypot(forces[6 * i], forces[6 * i + 1], forces[6 * i + 2]) / largeForce : 0));
    for (const event of impacts) {
      const age = (time - event.time) / motion.playbackSpeed;
      if (age < -1e-9 || age > kImpulseShown) continue;
      add(...event.point, ...event.normal, kArrow * Math.max(0.15, event.impulse / largeImpulse));
    }
  }
  arrowMesh.count = count;
  arrowMesh.visible = count > 0;
  arrowMesh.instanceMatrix.needsUpdate = true;
}

// Trails: the ways of the centres of mass in the last second of the film.
const kMaxTrails = 40, kTrail = 1;  // bodies; s of film
const trails = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x2a4a6a, transparent: true, opacity: 0.8 }));
trails.frustumCulled = false;
world.add(trails);
let showsTrails = false, picked = -1;

function placeTrails(frame) {
  trails.visible = showsTrails;
  if (!showsTrails) return;
  const shown = moving.length <= kMaxTrails ? moving.map((_, i) => i) : movingIndex.has(picked) ? [movingIndex.get(picked)] : [0];
  let first = frame;
  while (first > 0 && times[frame] - times[first - 1] <= kTrail * motion.playbackSpeed) --first;
  const width = kState * moving.length, places = [];
  for (const i of shown)
    for (let k = first; k < frame; ++k)
      for (const at of [k * width + kState * i, (k + 1) * width + kState * i]) places.push(states[at] - origin.x, states[at + 1] - origin.y, states[at + 2] - origin.z);
  trails.geometry.dispose();
  trails.geometry = new THREE.BufferGeometry();
  trails.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
}

// ------------------------------------------------------------------------------------------------------------ curves

const [curveCanvas, cursorCanvas] = page("curves").querySelectorAll("canvas");
const kColors = ["#c0392b", "#2d6fb3", "#7a7a7a", "#1d2733", "#b7791f", "#2f855a", "#6b46c1", "#0e7490"];
const up = new THREE.Vector3(0, 1, 0).applyQuaternion(turn.clone().conjugate());
const heightOf = (from, frame, i) => {
  const at = kState * (frame * moving.length + i);
  return up.x * from[at] + up.y * from[at + 1] + up.z * from[at + 2];
};
let showsCurves = true, panelCount = 0;

function distances() {
  const far = new Float64Array(frames);
  for (let frame = 0; frame < frames; ++frame)
    for (let i = 0; i < moving.length; ++i) {
      const at = kState * (frame * moving.length + i);
      far[frame] = Math.max(far[frame], Math.hypot(states[at] - other.states[at], states[at + 1] - other.states[at + 1], states[at + 2] - other.states[at + 2]));
    }
  return far;
}
const farApart = other && distances();
let leastPotential = Infinity;
for (let k = 0; k < frames; ++k) leastPotential = Math.min(leastPotential, energies[4 * k + 1]);

/// What is drawn: panels of named curves.
function panels() {
  const energy = index => frame => energies[4 * frame + index], potential = frame => energy(1)(frame) - leastPotential;
  const sum = frame => energy(0)(frame) + potential(frame) + energy(2)(frame) - energy(3)(frame);
  const all = [{
    title: "energy, J",
    curves: [["kinetic", energy(0)], ["potential, from its least", potential], ["dissipated", energy(2)], ["sum less work", sum]]
  }];
  const shown = movingIndex.has(picked) ? [picked] : moving.slice(0, 5);
  if (shown.length > 0)
    all.push({ title: "height, m", curves: shown.map(body => [motion.bodies[body].name, frame => heightOf(states, frame, movingIndex.get(body))]) });
  if (other) all.push({ title: "largest distance, m (log)", curves: [["of all bodies", frame => Math.log10(Math.max(farApart[frame], 1e-16))]], isLog: true });
  return all;
}

const kMargin = 56;
function sized(canvas) {
  const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio;
  canvas.width = Math.round(box.width * ratio), canvas.height = Math.round(box.height * ratio);
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  return [context, box.width, box.height];
}
const shareOf = time => times[frames - 1] > times[0] ? (time - times[0]) / (times[frames - 1] - times[0]) : 0;

function drawCurves() {
  page("curves").hidden = !showsCurves;
  page("graphs").classList.toggle("on", showsCurves);
  if (!showsCurves) return;
  const [context, width, height] = sized(curveCanvas), all = panels(), each = width / all.length;
  panelCount = all.length;
  context.font = "11px 'DejaVu Sans', sans-serif";
  all.forEach((panel, number) => {
    const left = number * each + kMargin, right = (number + 1) * each - 8, top = 16, bottom = height - 4;
    const every = Math.max(1, Math.floor(frames / (2 * (right - left))));
    let least = Infinity, most = -Infinity;
    for (const [, valueAt] of panel.curves)
      for (let frame = 0; frame < frames; frame += every) least = Math.min(least, valueAt(frame)), most = Math.max(most, valueAt(frame));
    if (!(most > least)) least -= 0.5, most += 0.5;
    context.fillStyle = "#45525f";
    context.fillText(panel.title, left, 10);
    context.textAlign = "right";
    const digits = value => Math.min(15, 3 + Math.max(0, Math.floor(Math.log10(Math.abs(value) / (most - least)))));
    const label = value => panel.isLog ? "1e" + value.toFixed(1) : Math.abs(value) < 1e-6 * (most - least) ? "0" : value.toPrecision(digits(value));
    context.fillText(label(most), left - 4, top + 6), context.fillText(label(least), left - 4, bottom);
    context.textAlign = "left";
    context.strokeStyle = "#aab6c1";
    context.strokeRect(left, top, right - left, bottom - top);
    let textAt = left + context.measureText(panel.title).width + 12;
    panel.curves.forEach(([name, valueAt], k) => {
      context.strokeStyle = context.fillStyle = kColors[k % kColors.length];
      const shownName = name.length > 26 ? name.slice(0, 25) + "\u2026" : name;
      if (textAt + context.measureText(shownName).width < right) context.fillText(shownName, textAt, 10);
      textAt += context.measureText(shownName).width + 10;
      context.beginPath();
      for (let frame = 0; frame < frames; frame += every)
        context.lineTo(left + (right - left) * shareOf(times[frame]), bottom - (bottom - top) * (valueAt(frame) - least) / (most - least));
      context.stroke();
    });
  });
}

let cursorContext = null;
function drawCursor(time) {
  if (!showsCurves) return;
  const width = cursorCanvas.clientWidth, height = cursorCanvas.clientHeight, each = width / panelCount;
  if (!cursorContext) [cursorContext] = sized(cursorCanvas);
  cursorContext.clearRect(0, 0, width, height);
  cursorContext.strokeStyle = "#d35400";
  cursorContext.beginPath();
  for (let number = 0; number < panelCount; ++number) {
    const x = number * each + kMargin + (each - kMargin - 8) * shareOf(time);
    cursorContext.moveTo(x, 16), cursorContext.lineTo(x, height - 4);
  }
  cursorContext.stroke();
}

const kEventColors = { impact: "#c0392b", taut: "#8e44ad", slack: "#8e44ad", rest: "#2f855a", wake: "#2f855a" };
function drawMarks() {
  const [context, width, height] = sized(page("marks").firstElementChild);
  for (const event of motion.events) {
    context.fillStyle = kEventColors[event.kind] || "#7a8793";
    context.fillRect(width * shareOf(event.time) - 0.5, 0, 1.5, height);
  }
}

// --------------------------------------------------------------------------------------------------------- what is shown

const kSpeeds = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4];
let time = times[0], frame = 0, isPlaying = false, speed = 1, latest = 0, scriptTime = 0;

function frameAt(moment) {
  let low = 0, high = frames - 1;
  while (low < high) {
    const half = (low + high + 1) >> 1;
    times[half] <= moment + 1e-12 ? low = half : high = half - 1;
  }
  return low;
}

/// Of a body that moves, in a frame: place, quaternion, velocity, angular velocity.
function stateOf(body, number) {
  const at = kState * (number * moving.length + movingIndex.get(body));
  return Array.from(states.subarray(at, at + kState));
}

function tellBody() {
  page("body").hidden = picked < 0;
  told.body = picked < 0 ? "" : motion.bodies[picked].name;
  told.state = movingIndex.has(picked) ? JSON.stringify(stateOf(picked, frame)) : "";
  if (picked < 0) return;
  const body = motion.bodies[picked], rows = [], number = x => Math.abs(x) < 1e-12 ? "0" : (x < 0 ? "\u2212" : "") + Math.abs(x).toPrecision(5);
  const add = (name, values, unit) => rows.push([name, ...values.map(number), unit]);
  if (movingIndex.has(picked)) {
    const state = stateOf(picked, frame);
    add("centre of mass", state.slice(0, 3), "m");
    add("velocity", state.slice(7, 10), "m/s");
    add("angular velocity", state.slice(10, 13), "rad/s");
    add("orientation", state.slice(3, 7), "");
    add("height", [heightOf(states, frame, movingIndex.get(picked))], "m");
    if (other) {
      const at = kState * (frame * moving.length + movingIndex.get(picked));
      add("distance of the other", [Math.hypot(...[0, 1, 2].map(k => states[at + k] - other.states[at + k]))], "m");
    }
  }
  if (body.mass > 0) add("mass", [body.mass], "kg");
  page("body").querySelector("h2").textContent = body.name + (movingIndex.has(picked) ? "" : " (fixed)");
  const table = page("body").querySelector("table");
  table.replaceChildren(...rows.map(cells => {
    const row = document.createElement("tr");
    row.append(...cells.map(cell => Object.assign(document.createElement("td"), { textContent: cell })));
    return row;
  }));
}

function tellFrame() {
  told.frame = frame;
  page("time").value = frame;
  page("now").textContent = `${time.toFixed(3)} s, frame ${frame} of ${frames - 1}`;
  const until = frame + 1 < frames ? times[frame + 1] : Infinity;
  const events = motion.events.filter(event => event.time >= times[frame] - 1e-12 && event.time < until);
  page("event").textContent = events.slice(0, 3).map(event => `${event.kind} ${event.names} at ${event.time.toPrecision(6)} s` +
      (event.impulse > 0 ? `, ${event.impulse.toPrecision(3)} N s` : "")).join("; ") + (events.length > 3 ? `; and ${events.length - 3} more` : "");
}

function show(moment) {
  time = Math.min(Math.max(moment, times[0]), times[frames - 1]);
  const number = frameAt(time), isNew = number !== frame || !told.frame;
  frame = number;
  const span = frame + 1 < frames ? times[frame + 1] - times[frame] : 1, share = isPlaying ? (time - times[frame]) / span : 0;
  takePoses(states, poses, frame, share);
  groups.forEach(group => placeThings(group, poses));
  placeLinks();
  if (other) {
    takePoses(other.states, otherPoses, frame, share);
    ghosts.forEach(group => placeThings(group, otherPoses));
  }
  placeArrows(frame, time);
  placeTrails(frame);
  drawCursor(time);
  if (isNew || !isPlaying) tellFrame(), tellBody();
}

/// So that the address of the page is that of what is seen.
function keepInAddress() {
  const parts = [`frame=${frame}`];
  if (picked >= 0) parts.push("body=" + encodeURIComponent(motion.bodies[picked].name));
  history.replaceState(null, "", "#" + parts.join("&"));
}

function seek(number) {
  play(false);
  show(times[Math.min(Math.max(number, 0), frames - 1)]);
  keepInAddress();
}

function play(isOn) {
  isPlaying = isOn;
  if (isOn && time >= times[frames - 1]) time = times[0];
  page("play").textContent = isOn ? "\u275a\u275a" : "\u25b6";
  page("play").classList.toggle("on", isOn);
}

function pick(body) {
  picked = body;
  drawCurves();
  show(time);
  keepInAddress();
}

function setSpeed(value) {
  speed = value;
  page("speed").value = value;
}

function toggle(id, isOn) {
  page(id).classList.toggle("on", isOn);
  show(time);
}

/// The camera as a scene file has it, in the scene's world: to a hundred thousandth of its distance.
function cameraText() {
  const back = turn.clone().conjugate(), decimals = Math.max(0, 5 - Math.floor(Math.log10(camera.position.distanceTo(orbit.target))));
  const numbers = v => v.applyQuaternion(back).toArray().map(x => +x.toFixed(Math.min(decimals, 20)) + 0);
  const text = { position: numbers(camera.position.clone().add(middle)), target: numbers(orbit.target.clone().add(middle)),
                 verticalFieldOfViewDegrees: +motion.camera.verticalFieldOfView.toPrecision(6) };
  if (camera.up.distanceTo(kY) > 1e-6) text.up = camera.up.clone().applyQuaternion(back).toArray().map(x => +x.toFixed(6) + 0);
  return '"camera": ' + JSON.stringify(text);
}

function showCamera() {
  page("camera").hidden = false;
  const area = page("camera").querySelector("textarea");
  area.value = cameraText();
  area.select();
  if (navigator.clipboard) navigator.clipboard.writeText(area.value).catch(() => {});
}

// What was clicked at: each thing's triangles, in its own place.
const probe = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial());
function bodyAt(x, y) {
  const ray = new THREE.Raycaster(), hits = [];
  ray.setFromCamera(new THREE.Vector2(2 * x / window.innerWidth - 1, 1 - 2 * y / window.innerHeight), camera);
  for (const group of groups) {
    if (!group.geometry.boundingSphere) group.geometry.computeBoundingSphere();
    probe.geometry = group.geometry;
    group.things.forEach((thing, index) => {
      if (thing.body < 0) return;
      probe.matrixWorld.fromArray(group.mesh.instanceMatrix.array, 16 * index).premultiply(world.matrixWorld);
      const found = [];
      probe.raycast(ray, found);
      for (const hit of found) hits.push({ distance: hit.distance, body: thing.body });
    });
  }
  hits.sort((a, b) => a.distance - b.distance);
  return hits.length > 0 ? hits[0].body : -1;
}

// ------------------------------------------------------------------------------------------------------------- controls

let pressed = null;
const canvas = renderer.domElement;
canvas.addEventListener("pointerdown", event => pressed = [event.clientX, event.clientY]);
canvas.addEventListener("pointerup", event => {
  if (event.button === 0 && pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4)
    pick(bodyAt(event.clientX, event.clientY));
  pressed = null;
});
page("play").onclick = () => { play(!isPlaying); if (!isPlaying) seek(frame); };
page("back").onclick = () => seek(frame - 1);
page("forth").onclick = () => seek(frame + 1);
page("time").oninput = event => seek(+event.target.value);
page("speed").append(...kSpeeds.map(value => new Option(value + " \u00d7", value)));
page("speed").onchange = event => setSpeed(+event.target.value);
page("forces").onclick = () => toggle("forces", showsForces = !showsForces);
page("trails").onclick = () => toggle("trails", showsTrails = !showsTrails);
page("graphs").onclick = () => { showsCurves = !showsCurves; resize(); };
page("copy").onclick = showCamera;
page("camera").querySelector("button").onclick = () => page("camera").hidden = true;
page("marks").onclick = event => {
  const box = page("marks").getBoundingClientRect(), moment = times[0] + (event.clientX - box.left) / box.width * (times[frames - 1] - times[0]);
  const nearest = motion.events.reduce((best, one) => !best || Math.abs(one.time - moment) < Math.abs(best.time - moment) ? one : best, null);
  if (nearest) seek(frameAt(nearest.time));
};
window.addEventListener("keydown", event => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "TEXTAREA" || event.target.tagName === "SELECT") return;
  const step = event.shiftKey ? 10 : 1, at = kSpeeds.indexOf(speed);
  const actions = {
    " ": () => page("play").click(), ArrowLeft: () => seek(frame - step), ArrowRight: () => seek(frame + step),
    Home: () => seek(0), End: () => seek(frames - 1), Escape: () => pick(-1),
    "+": () => setSpeed(kSpeeds[Math.min(at + 1, kSpeeds.length - 1)]), "-": () => setSpeed(kSpeeds[Math.max(at - 1, 0)]),
    f: () => page("forces").click(), t: () => page("trails").click(), g: () => page("graphs").click(), c: showCamera
  };
  const action = actions[event.key] || actions[event.key.toLowerCase()];
  if (!action) return;
  event.preventDefault();
  if (document.activeElement) document.activeElement.blur();
  action();
});

function resize() {
  renderer.setSize(window.innerWidth, window.innerHeight, false);
  drawCurves();
  // What the scene's camera sees stands in what the controls leave free.
  const width = window.innerWidth, height = window.innerHeight, covered = document.querySelector("footer").offsetHeight;
  const free = Math.max(height - covered, height / 4), narrow = Math.max(1, motion.camera.aspect / (width / free));
  const half = Math.tan(motion.camera.verticalFieldOfView * Math.PI / 360) * narrow * height / free;
  camera.fov = 360 / Math.PI * Math.atan(half);
  camera.aspect = width / height;
  camera.setViewOffset(width, height, 0, (height - free) / 2, width, height);
  camera.updateProjectionMatrix();
  cursorContext = null;
  drawMarks();
  show(time);
}
window.addEventListener("resize", resize);

function followAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  delete told.error;
  page("message").textContent = "";
  picked = -1;
  if (asked.get("body")) {
    const body = bodyByName.get(asked.get("body"));
    if (body === undefined) complain(`There is no body "${asked.get("body")}".`);
    picked = body === undefined ? -1 : body;
  }
  drawCurves();
  if (asked.has("frame")) {
    const number = Number(asked.get("frame"));
    if (!Number.isInteger(number) || number < 0 || number >= frames) complain(`There is no frame ${asked.get("frame")}; there are 0 to ${frames - 1}.`);
    else time = times[number];
  }
  play(asked.has("play"));
  show(time);
}
window.addEventListener("hashchange", followAddress);

function draw(now) {
  const began = performance.now();
  if (isPlaying) {
    const passed = Math.min((now - latest) / 1000, 0.1) * speed * motion.playbackSpeed;
    show(time + passed);
    if (time >= times[frames - 1]) seek(frames - 1);
  }
  latest = now;
  renderer.render(scene, camera);
  told.calls = renderer.info.render.calls;
  scriptTime += 0.05 * (performance.now() - began - scriptTime);
  told.scriptMilliseconds = scriptTime.toFixed(2);
  requestAnimationFrame(draw);
}

page("time").max = frames - 1;
const length = `${frames} frame${frames === 1 ? "" : "s"} of ${(times[frames - 1] - times[0]).toPrecision(4)} s`;
page("about").textContent = [motion.method, length, other ? `in red: ${other.name}` : ""].filter(words => words).join("; ");
setSpeed(1);
followAddress();
resize();
requestAnimationFrame(draw);
told.ready = "yes";
})().catch(error => {
  document.body.dataset.error = document.getElementById("message").textContent = "The motion cannot be shown: " + error.message;
  throw error;
});
