// Trails: positions of robots in the last seconds, fading with age. A texture holds the positions at past times, called
// marks: a few rows per mark. A new mark overwrites the oldest, and nothing else is sent to the graphics card.

import {
  BufferAttribute,
  DataTexture,
  FloatType,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  NearestFilter,
  RGFormat,
  Vector2,
} from "three";
import { trailsMaterial } from "./materials.js";
import { ABSENT } from "./series.js";

const MOST_MARKS = 64;
const COLUMNS = 2048; // WebGL 2 guarantees textures of this width
const TRIANGLES = 6; // triangle corners between two marks
const UPLOADS = 4; // most marks sent per picture, so that trails grow back quickly after a jump in time

export class Trails {
  constructor(renderer, recording, poses, tints) {
    this.renderer = renderer;
    this.recording = recording;
    const places = Math.max(recording.robots, 1); // a texture must not be empty
    this.columns = Math.min(places, COLUMNS);
    this.rowsEach = Math.ceil(places / this.columns);
    this.ring = Math.max(1, Math.min(MOST_MARKS, Math.floor(renderer.capabilities.maxTextureSize / this.rowsEach)));
    this.texture = this.makeTexture(this.rowsEach * this.ring);
    this.piece = this.makeTexture(this.rowsEach);
    this.held = new Int32Array(this.ring).fill(-1); // the mark in each slot of the ring
    this.seconds = 0;

    const geometry = new InstancedBufferGeometry();
    const vertices = [];
    const triangles = [];
    for (let k = 0; k <= this.ring; k++) {
      vertices.push(k, -1, 0, k, 1, 0);
      if (k > 0) triangles.push(2 * k - 2, 2 * k - 1, 2 * k, 2 * k - 1, 2 * k + 1, 2 * k);
    }
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(vertices), 3));
    geometry.setIndex(triangles);
    this.pose = new InstancedBufferAttribute(poses, 4);
    this.tint = new InstancedBufferAttribute(tints, 3, true);
    geometry.setAttribute("pose", this.pose);
    geometry.setAttribute("tint", this.tint);
    geometry.instanceCount = recording.robots;
    this.material = trailsMaterial(this.texture, { columns: this.columns, rowsEach: this.rowsEach, marks: this.ring });
    this.object = new Mesh(geometry, this.material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  makeTexture(rows) {
    const texture = new DataTexture(new Float32Array(2 * this.columns * rows), this.columns, rows, RGFormat, FloatType);
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    return texture;
  }

  /** Sets the length of trails, s; 0: none. */
  setLength(seconds) {
    this.seconds = seconds;
    this.held.fill(-1);
    this.spacing = this.leastSpacing(this.meanFrame); // frames between marks
    this.shown = 0; // s, the age of the oldest mark that is drawn
  }

  /** The least number of frames, of so many seconds, between marks that together reach back over the length of trails. */
  leastSpacing(frameTime) {
    return Math.max(1, Math.ceil(this.seconds / frameTime / this.ring));
  }

  /** Mean time between frames, s. */
  get meanFrame() {
    const { frames, start, end } = this.recording;
    return frames > 1 ? (end - start) / (frames - 1) : 1;
  }

  /** Call this when the poses are those of `frame`. */
  update(frame) {
    this.object.visible = this.seconds > 0;
    if (this.seconds === 0) return;
    const frameTime = this.meanFrame; // of a running world, it changes with the rate
    const least = this.leastSpacing(frameTime);
    if (least > this.spacing || 2 * least <= this.spacing) this.setLength(this.seconds);
    const { times } = this.recording;
    const newest = Math.floor(frame / this.spacing);
    let count = 0;
    let uploads = 0;
    for (; count < this.ring && newest - count >= 0; count++) {
      const mark = newest - count;
      const age = times[frame] - times[mark * this.spacing];
      if (age > this.seconds + frameTime / 2) break; // NaN, of a frame that a live page no longer stores: the mark may be held
      this.shown = age;
      if (this.held[mark % this.ring] === mark) continue;
      if (uploads === UPLOADS || !this.upload(mark)) break;
      uploads++;
    }
    this.object.geometry.setDrawRange(0, TRIANGLES * count);
    this.material.uniforms.newest.value = newest % this.ring;
    this.material.uniforms.last.value = count;
    // A trail that is still short, such as at the beginning of a run, fades as if it had its full length.
    this.material.uniforms.count.value = Math.max(count, Math.min(this.ring, Math.round(this.seconds / (frameTime * this.spacing)))) + 1;
    this.pose.needsUpdate = true;
  }

  /** Sends the positions of one mark; false if they are not unpacked yet. */
  upload(mark) {
    const found = this.recording.poses(mark * this.spacing);
    if (!found) return false;
    const step = this.recording.header.pose.step_m;
    const data = this.piece.image.data;
    for (let r = 0, i = found.at; r < this.recording.robots; r++, i++) {
      const x = found.x[i];
      data[2 * r] = x === ABSENT ? 1e9 : x * step;
      data[2 * r + 1] = found.y[i] * step;
    }
    this.renderer.copyTextureToTexture(this.piece, this.texture, null, new Vector2(0, (mark % this.ring) * this.rowsEach));
    this.held[mark % this.ring] = mark;
    return true;
  }
}
