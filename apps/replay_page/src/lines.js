// Layers of lines: radio links, detected fiducials, what grippers hold, what robots carry.

import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments } from "three";

const LIGHT_COLORS = { radio: 0x2f6fb0, sights: 0x2e8b57, grips: 0xb8860b, carries: 0x8b3a9e };
const DARK_COLORS = { radio: 0x6fb4ff, sights: 0x66d19a, grips: 0xffc857, carries: 0xd79bf0 };
const FAINT = 0.25; // opacity at the end at which a line begins: the sender, or the sensor

export class Lines {
  constructor() {
    this.object = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, transparent: true, depthTest: false }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    this.colors = LIGHT_COLORS;
    this.count = 0; // lines on the screen
    this.shown = null;
  }

  theme(dark) {
    this.colors = dark ? DARK_COLORS : LIGHT_COLORS;
    this.shown = null;
  }

  /** Shows the lines of a state of the program: {layer: [x, y, z, ...]}, two points per line. */
  update(lines) {
    if (lines === this.shown) return;
    this.shown = lines;
    const places = Object.values(lines).flat();
    const tints = new Float32Array((places.length / 3) * 4);
    let at = 0;
    for (const [layer, numbers] of Object.entries(lines)) {
      const { r, g, b } = new Color(this.colors[layer]);
      for (let i = 0; i < numbers.length; i += 6, at += 8) tints.set([r, g, b, FAINT, r, g, b, 1], at);
    }
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
    this.object.geometry.setAttribute("color", new BufferAttribute(tints, 4));
    this.count = places.length / 6;
  }
}
