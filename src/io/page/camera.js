// SPDX-License-Identifier: BSD-3-Clause
// Where the map is seen from: vectors of the map (m, z up), matrices by columns as WebGL takes them.

const VIEW_RAD = 0.87;  // of the shorter side of the window
const NEAREST_M = 0.25;  // nearer than this the camera goes on into the room
const START = { azimuth: -2.2, elevation: 0.75 };

const add = (a, b, k = 1) => a.map((x, i) => x + k * b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

function product(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; ++column) {
    for (let row = 0; row < 4; ++row) {
      for (let k = 0; k < 4; ++k) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    }
  }
  return out;
}

/// Turns around a point of the map, at a distance of it, upright.
class Orbit {
  /// `box`: what there is to see, {low, high}.
  constructor(box) {
    this.box = box;
    this.size = Math.max(0.5, Math.hypot(...add(box.high, box.low, -1)));
    this.whole();
  }

  whole() {
    Object.assign(this, START);
    this.center();
  }

  /// As a plan: x to the right.
  above() {
    this.azimuth = -Math.PI / 2;
    this.elevation = Math.PI / 2;
    this.center();
  }

  center() {
    this.target = add(this.box.low, this.box.high).map(x => x / 2);
    this.distance = 0.5 * this.size / Math.sin(0.5 * VIEW_RAD);
  }

  /// From the camera towards the point, to its right, and to its top.
  axes() {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const ahead = [-ca * ce, -sa * ce, -se];
    const right = [-sa, ca, 0];
    return { ahead, right, top: cross(right, ahead) };
  }

  eye() {
    return add(this.target, this.axes().ahead, -this.distance);
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.elevation + elevation));
  }

  /// By parts of the shorter side of the window, as if the map were held.
  move(right, top) {
    const way = 2 * Math.tan(0.5 * VIEW_RAD) * this.distance;
    const axes = this.axes();
    this.target = add(add(this.target, axes.right, -right * way), axes.top, -top * way);
  }

  /// To `factor` times the distance. What would be nearer than NEAREST_M moves the point instead.
  approach(factor) {
    const wanted = this.distance * factor;
    this.distance = Math.min(20 * this.size, Math.max(NEAREST_M, wanted));
    if (wanted >= NEAREST_M) return;
    const step = Math.max(0.03 * this.size * (1 - factor), NEAREST_M - wanted);
    this.target = add(this.target, this.axes().ahead, step);
  }

  /// Metres that a part of the shorter side is long, at the point.
  metres(part) {
    return part * 2 * Math.tan(0.5 * VIEW_RAD) * this.distance;
  }

  /// For a window of this size; `pixels`: that a metre has at a metre's distance.
  matrices(width, height) {
    const shorter = Math.min(width, height);
    const focal = 1 / Math.tan(0.5 * VIEW_RAD);
    const near = Math.max(0.02, 0.01 * this.distance);
    const far = this.distance + 3 * this.size;
    const project = new Float32Array(16);
    project[0] = focal * shorter / width;
    project[5] = focal * shorter / height;
    project[10] = (far + near) / (near - far);
    project[11] = -1;
    project[14] = 2 * far * near / (near - far);
    const { ahead, right, top } = this.axes();
    const eye = this.eye();
    const look = new Float32Array(16);
    for (let i = 0; i < 3; ++i) look.set([right[i], top[i], -ahead[i], 0], 4 * i);
    look.set([-dot(right, eye), -dot(top, eye), dot(ahead, eye), 1], 12);
    return { view: look, projected: product(project, look), eye, pixels: 0.5 * focal * shorter };
  }
}
