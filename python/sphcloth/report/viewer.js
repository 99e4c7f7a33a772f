// Draws the frames of a trajectory on a canvas, turned with the mouse.  No graphics card is needed:
// particles are shaded discs, triangles are filled, and a depth buffer says what is in front.
"use strict";

const LIGHT = normalized([-0.45, -0.55, 0.75]);
const COLORS = { front: [226, 138, 62], back: [188, 96, 66], obstacle: [150, 152, 160], wall: [176, 180, 188] };
const SLOW = [21, 84, 158], MIDDLE = [72, 158, 219], FAST = [232, 248, 255];
const LARGEST_RADIUS = 40, FULL = 65535, FRAME_MS = 80, SAMPLE = 12000;

function normalized(v) {
  const length = Math.hypot(...v);
  return v.map(x => x / length);
}

function numbers(text, Form) {
  const raw = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Form(raw.buffer);
}

function mixed(a, b, t) {
  return a.map((x, i) => x + (b[i] - x) * t);
}

// a disc that looks like a ball: offset, depth towards the eye and brightness of each pixel
const sprites = new Map();
function sprite(radius) {
  if (!sprites.has(radius)) {
    const pixels = [];
    for (let y = -radius; y <= radius; y++)
      for (let x = -radius; x <= radius; x++) {
        const square = (x * x + y * y) / ((radius + 0.3) * (radius + 0.3));
        if (square >= 1) continue;
        const z = Math.sqrt(1 - square);
        const lit = Math.max(0, (x / radius) * -0.45 + (y / radius) * -0.6 + z * 0.7);
        pixels.push([x, y, z, 0.5 + 0.6 * lit]);
      }
    sprites.set(radius, pixels);
  }
  return sprites.get(radius);
}

class Viewer {
  constructor(box) {
    const data = JSON.parse(box.querySelector("script").textContent);
    this.canvas = box.querySelector("canvas");
    this.slider = box.querySelector("input[type=range]");
    this.button = box.querySelector("button.play");
    this.label = box.querySelector(".label");
    this.data = data;
    this.triangles = numbers(data.triangles, Uint32Array);
    this.isCloth = numbers(data.cloth, Uint8Array);
    this.walls = numbers(data.walls, Uint16Array);
    this.frames = data.frames.map(frame => ({
      label: frame.label,
      water: numbers(frame.water, Uint16Array),
      speed: numbers(frame.speed, Uint8Array),
      vertices: numbers(frame.vertices, Float32Array),
    }));
    this.palette = Array.from({ length: 256 }, (_, i) =>
      i < 128 ? mixed(SLOW, MIDDLE, i / 128) : mixed(MIDDLE, FAST, (i - 128) / 127));
    this.center = this.middle();
    this.reset();
    this.frame = this.frames.length - 1;
    this.slider.max = this.frame;
    this.listen(box);
    this.show();
  }

  // the middle of what there is to see, in the unit cube of the data
  middle() {
    const low = [1, 1, 1], high = [0, 0, 0];
    const total = this.frames.reduce((n, each) => n + each.water.length + each.vertices.length, 0);
    const stride = 3 * Math.ceil(total / 3 / SAMPLE);
    this.sample = [];
    const meet = (values, scale) => {
      for (let i = 0; i < values.length; i += stride)
        this.sample.push([values[i] / scale, values[i + 1] / scale, values[i + 2] / scale]);
      for (let i = 0; i < values.length; i++) {
        const x = values[i] / scale;
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
      }
    };
    for (const frame of this.frames) {
      meet(frame.water, FULL);
      meet(frame.vertices, 1);
    }
    this.extent = Math.max(0.1, Math.hypot(...high.map((x, i) => x - low[i])));
    return high.map((x, i) => (x + low[i]) / 2);
  }

  reset() {
    Object.assign(this, { yaw: 0.6, pitch: 0.35, distance: 0 });
  }

  // as near as what there is in any frame is in the picture
  fit() {
    const out = [0, 0, 0], margin = 0.07;
    const isIn = point => this.project(...point, out) && out[2] > 0.01
      && out[0] > margin * this.width && out[0] < (1 - margin) * this.width
      && out[1] > margin * this.height && out[1] < (1 - margin) * this.height;
    this.distance = 0.5 * this.extent;
    while (this.distance < 8 * this.extent && !this.sample.every(isIn)) this.distance *= 1.03;
  }

  listen(box) {
    let last = null;
    this.canvas.addEventListener("pointerdown", event => {
      last = [event.clientX, event.clientY];
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", event => {
      if (!last) return;
      this.yaw -= (event.clientX - last[0]) * 0.01;
      this.pitch = Math.max(-1.57, Math.min(1.57, this.pitch + (event.clientY - last[1]) * 0.01));
      last = [event.clientX, event.clientY];
      this.show();
    });
    for (const end of ["pointerup", "pointercancel"])
      this.canvas.addEventListener(end, () => { last = null; });
    this.canvas.addEventListener("wheel", event => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.001));
    }, { passive: false });
    this.canvas.addEventListener("keydown", event => this.press(event));
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
    this.button.addEventListener("click", () => this.play(!this.timer));
    box.querySelector("button.reset").addEventListener("click", () => { this.reset(); this.show(); });
    new ResizeObserver(() => this.show()).observe(this.canvas);
  }

  press(event) {
    const turns = { ArrowLeft: -1, ArrowRight: 1 };
    if (event.key in turns) this.go(this.frame + turns[event.key]);
    else if (event.key === " ") this.play(!this.timer);
    else if (event.key === "+" || event.key === "-") this.zoom(event.key === "+" ? 0.9 : 1 / 0.9);
    else return;
    event.preventDefault();
  }

  zoom(factor) {
    this.distance = Math.max(0.2 * this.extent, Math.min(8 * this.extent, this.distance * factor));
    this.show();
  }

  play(on) {
    clearInterval(this.timer);
    this.timer = on ? setInterval(() => this.go((this.frame + 1) % this.frames.length), FRAME_MS) : 0;
    this.button.textContent = on ? "Pause" : "Play";
  }

  go(frame) {
    this.frame = Math.max(0, Math.min(this.frames.length - 1, frame));
    this.show();
  }

  show() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  draw() {
    const canvas = this.canvas, scale = Math.min(window.devicePixelRatio || 1, 1.5);
    const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
      this.picture = null;
    }
    const context = canvas.getContext("2d");
    this.picture ||= context.createImageData(width, height);
    this.pixels = new Uint32Array(this.picture.data.buffer);
    this.depth = new Float32Array(width * height).fill(Infinity);
    this.width = width;
    this.height = height;
    this.background();
    this.aim();
    if (!this.distance) this.fit();
    const frame = this.frames[this.frame];
    this.drawMesh(frame.vertices);
    this.drawBalls(this.walls, 0.2, () => COLORS.wall);
    this.drawBalls(frame.water, 0.5, i => this.palette[frame.speed[i]]);
    context.putImageData(this.picture, 0, 0);
    this.label.textContent = frame.label;
    this.slider.value = this.frame;
    Object.assign(canvas.dataset, {
      frame: this.frame, yaw: this.yaw.toFixed(3), pitch: this.pitch.toFixed(3),
      distance: this.distance.toFixed(3),
    });
  }

  background() {
    for (let y = 0; y < this.height; y++) {
      const t = y / this.height, c = mixed([250, 251, 253], [221, 227, 236], t);
      this.pixels.fill(packed(c), y * this.width, (y + 1) * this.width);
    }
  }

  // axes of the camera: to the right, up, and away from the eye
  aim() {
    const [sy, cy] = [Math.sin(this.yaw), Math.cos(this.yaw)];
    const [sp, cp] = [Math.sin(this.pitch), Math.cos(this.pitch)];
    this.right = [cy, sy, 0];
    this.up = [-sy * sp, cy * sp, cp];
    this.away = [-sy * cp, cy * cp, -sp];
    this.focus = 1.1 * Math.min(this.width, 1.4 * this.height);
  }

  // x, y and depth on the screen of a point in the unit cube; depth <= 0 behind the eye
  project(x, y, z, out) {
    x -= this.center[0]; y -= this.center[1]; z -= this.center[2];
    const { right, up, away } = this;
    const depth = this.distance + away[0] * x + away[1] * y + away[2] * z;
    const scale = this.focus / depth;
    out[0] = this.width / 2 + scale * (right[0] * x + right[1] * y + right[2] * z);
    out[1] = this.height / 2 - scale * (up[0] * x + up[1] * y + up[2] * z);
    out[2] = depth;
    return scale;
  }

  drawBalls(places, share, color) {
    const radius = share * this.data.spacing / this.data.size, out = [0, 0, 0];
    for (let i = 0; i < places.length; i += 3) {
      const scale = this.project(places[i] / FULL, places[i + 1] / FULL, places[i + 2] / FULL, out);
      if (out[2] <= 0.01) continue;
      const size = Math.max(1, Math.min(LARGEST_RADIUS, Math.round(scale * radius)));
      this.drawBall(Math.round(out[0]), Math.round(out[1]), out[2], size, radius, color(i / 3));
    }
  }

  drawBall(cx, cy, depth, size, radius, color) {
    for (const [dx, dy, dz, lit] of sprite(size)) {
      const x = cx + dx, y = cy + dy;
      if (x < 0 || y < 0 || x >= this.width || y >= this.height) continue;
      const at = y * this.width + x, z = depth - dz * radius;
      if (z >= this.depth[at]) continue;
      this.depth[at] = z;
      this.pixels[at] = packed(color, lit);
    }
  }

  drawMesh(vertices) {
    const seen = new Float32Array(vertices.length), out = [0, 0, 0];
    for (let i = 0; i < vertices.length; i += 3) {
      this.project(vertices[i], vertices[i + 1], vertices[i + 2], out);
      seen.set(out, i);
    }
    for (let t = 0; t < this.triangles.length; t += 3)
      this.drawTriangle(vertices, seen, this.triangles.subarray(t, t + 3), this.isCloth[t / 3]);
  }

  drawTriangle(vertices, seen, corners, isCloth) {
    const [a, b, c] = [...corners].map(n => seen.subarray(3 * n, 3 * n + 3));
    if (!(a[2] > 0.01 && b[2] > 0.01 && c[2] > 0.01)) return;
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (!area) return;
    const [p, q, r] = [...corners].map(n => vertices.subarray(3 * n, 3 * n + 3));
    const u = [q[0] - p[0], q[1] - p[1], q[2] - p[2]], v = [r[0] - p[0], r[1] - p[1], r[2] - p[2]];
    const normal = normalized([
      u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]);
    const lit = 0.5 + 0.55 * Math.abs(normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2]);
    const color = isCloth ? (area < 0 ? COLORS.front : COLORS.back) : COLORS.obstacle;
    const value = packed(color, lit);
    const left = Math.max(0, Math.floor(Math.min(a[0], b[0], c[0])));
    const last = Math.min(this.width - 1, Math.ceil(Math.max(a[0], b[0], c[0])));
    const top = Math.max(0, Math.floor(Math.min(a[1], b[1], c[1])));
    const bottom = Math.min(this.height - 1, Math.ceil(Math.max(a[1], b[1], c[1])));
    for (let y = top; y <= bottom; y++)
      for (let x = left; x <= last; x++) {
        const wb = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
        const wc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
        if (wb < 0 || wc < 0 || wb + wc > 1) continue;
        const z = a[2] + wb * (b[2] - a[2]) + wc * (c[2] - a[2]), at = y * this.width + x;
        if (z >= this.depth[at]) continue;
        this.depth[at] = z;
        this.pixels[at] = value;
      }
  }
}

// one opaque pixel, as ImageData stores it on little-endian machines
function packed(color, lit = 1) {
  const [r, g, b] = color.map(x => Math.min(255, x * lit) | 0);
  return (255 << 24 | b << 16 | g << 8 | r) >>> 0;
}

for (const box of document.querySelectorAll(".viewer")) new Viewer(box);
