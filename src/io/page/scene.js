// SPDX-License-Identifier: BSD-3-Clause
// The map on the graphics card.

const VERTEX_BYTES = 12;

const COMMON = `#version 300 es
precision highp float;
in vec3 place;    // in the chunk's box, 0 .. 1
in vec2 folded;   // normal, octahedral
in vec4 paint;    // colour; radius as a part of the largest
uniform vec3 low, side, eye;
uniform float largest, pixels, most;
uniform mat4 view, projected;
out vec3 color;
out vec3 facing;
vec3 normal() {
  vec3 n = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
  float below = max(-n.z, 0.0);
  n.xy -= vec2(n.x < 0.0 ? -below : below, n.y < 0.0 ? -below : below);
  return normalize(n);
}
void main() {
  vec3 at = low + side * place;
  vec3 n = normal();
  vec3 ray = normalize(eye - at);
  gl_Position = projected * vec4(at, 1.0);
  // Colours have the light of the room; this shading shows the shape.
  color = paint.rgb * (0.72 + 0.28 * abs(dot(n, ray)));
  // As seen along the ray: to the right, to the top, towards the eye.
  vec3 right = normalize(cross(vec3(view[0][1], view[1][1], view[2][1]), ray));
  facing = vec3(dot(right, n), dot(cross(ray, right), n), dot(ray, n));
`;
// Surfels that are seen from behind are left out, as are triangles: one looks into the room.
const POINTS = COMMON + `
  gl_PointSize = clamp(2.0 * paint.a * largest * pixels / gl_Position.w, 1.5, most);
  if (dot(n, ray) < 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;
const TRIANGLES = COMMON + "}";
const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 color;
in vec3 facing;
uniform float discs;
out vec4 shown;
void main() {
  if (discs > 0.5) {
    vec2 from = vec2(2.0, -2.0) * (gl_PointCoord - 0.5);
    float depth = dot(facing.xy, from) / max(facing.z, 0.25);
    if (dot(from, from) + depth * depth > 1.0) discard;
  }
  shown = vec4(color, 1.0);
}`;

function bytesOf(element) {
  const text = atob(element.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

class Scene {
  /// Throws Error where the browser cannot draw.
  constructor(canvas, facts) {
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance" });
    if (!this.gl) throw new Error("This browser has no WebGL 2, or it is switched off: the map cannot be drawn here.");
    this.facts = facts;
    this.discs = facts.shows === "surfels";
    this.chunks = [];
    this.prepare();
  }

  prepare() {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, this.discs ? POINTS : TRIANGLES], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ["place", "folded", "paint"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      throw new Error("This graphics card does not take the program of the map: " + gl.getProgramInfoLog(program));
    }
    gl.useProgram(program);
    this.at = {};
    for (const name of ["low", "side", "eye", "largest", "pixels", "most", "view", "projected", "discs"]) {
      this.at[name] = gl.getUniformLocation(program, name);
    }
    gl.uniform1f(this.at.discs, this.discs ? 1 : 0);
    gl.uniform1f(this.at.most, gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE)[1]);
    gl.enable(gl.DEPTH_TEST);
    if (!this.discs) gl.enable(gl.CULL_FACE);
  }

  /// `about`: of facts.chunks.
  add(about, bytes) {
    const gl = this.gl;
    const size = about.vertices * VERTEX_BYTES;
    if (bytes.length !== size + 6 * about.triangles) throw new Error("This page is not whole: a piece of the map is missing.");
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, bytes.subarray(0, size), gl.STATIC_DRAW);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, VERTEX_BYTES, 0);
    gl.vertexAttribPointer(1, 2, gl.BYTE, true, VERTEX_BYTES, 6);
    gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, VERTEX_BYTES, 8);
    [0, 1, 2].forEach(i => gl.enableVertexAttribArray(i));
    if (about.triangles > 0) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, bytes.subarray(size), gl.STATIC_DRAW);
    }
    this.chunks.push({ about, array });
  }

  /// `ground`: colour behind the map, 0 .. 1.
  draw(orbit, ground) {
    const gl = this.gl;
    const { width, height } = gl.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const seen = orbit.matrices(width, height);
    gl.uniformMatrix4fv(this.at.view, false, seen.view);
    gl.uniformMatrix4fv(this.at.projected, false, seen.projected);
    gl.uniform3fv(this.at.eye, seen.eye);
    gl.uniform1f(this.at.pixels, seen.pixels);
    for (const { about, array } of this.chunks) {
      gl.bindVertexArray(array);
      gl.uniform3fv(this.at.low, about.low);
      gl.uniform3fv(this.at.side, about.side);
      gl.uniform1f(this.at.largest, about.largest_radius);
      if (this.discs) gl.drawArrays(gl.POINTS, 0, about.vertices);
      else gl.drawElements(gl.TRIANGLES, 3 * about.triangles, gl.UNSIGNED_SHORT, 0);
    }
  }

  /// Waits until all is drawn.
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}
