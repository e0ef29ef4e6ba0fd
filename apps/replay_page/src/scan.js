// Draws the readings of the selected robot's rangers as fans.

import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial } from "three";

/** The rangers of a robot whose readings were recorded: fans, the joint that moves them, and the field of readings. */
function eyesOf({ header, fieldRows }, robot, type) {
  return Object.entries(header.types[type].eyes).flatMap(([name, { fans, joint }]) => {
    // Rangers of several types may have the same name. Each of them has its own field, which only robots of its type have.
    const field = header.fields.findIndex(
      ({ component, name: what }, index) =>
        what === "ranges" && component.startsWith("sensors/") && component.endsWith(`/${name}`) && fieldRows[index].of[robot] >= 0,
    );
    const beams = fans.reduce((sum, fan) => sum + fan.beams, 0);
    return field >= 0 && header.fields[field].columns === beams ? [{ field, fans, joint }] : [];
  });
}

/** The fans of one ranger, in the frame of the part that carries it. */
class Eye {
  constructor({ field, fans, joint }, materials) {
    Object.assign(this, { field, fans, joint });
    this.area = new Mesh(new BufferGeometry(), materials.area);
    this.lines = new LineSegments(new BufferGeometry(), materials.lines);
    this.object = new Group();
    this.object.add(this.area, this.lines);
    for (const object of this.object.children) object.frustumCulled = false;
  }

  dispose() {
    for (const object of this.object.children) object.geometry.dispose();
  }

  /** `reading(beam)` returns a range, m; NaN: none, null: not unpacked yet. */
  redraw(reading) {
    const triangles = [];
    const lines = [];
    let beam = 0;
    for (const fan of this.fans) {
      const [x, y, z, heading] = fan.pose;
      let last = null;
      for (let i = 0; i < fan.beams; i++, beam++) {
        const range = reading(beam);
        if (range === null) return false;
        const bearing = heading + (fan.beams === 1 ? 0 : fan.fov_rad * (i / (fan.beams - 1) - 0.5));
        const end = [x + range * Math.cos(bearing), y + range * Math.sin(bearing), z];
        if (Number.isNaN(range)) {
          last = null;
          continue;
        }
        if (last) {
          triangles.push(x, y, z, ...last, ...end);
          lines.push(...last, ...end);
        }
        if (fan.beams < 64 || i === 0 || i === fan.beams - 1) lines.push(x, y, z, ...end);
        last = end;
      }
    }
    for (const [object, positions] of [[this.area, triangles], [this.lines, lines]]) {
      object.geometry.dispose();
      object.geometry = new BufferGeometry();
      object.geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
    }
    return true;
  }
}

export class Scan {
  constructor(recording) {
    this.recording = recording;
    this.object = new Group();
    this.materials = {
      area: new MeshBasicMaterial({ transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false }),
      lines: new LineBasicMaterial({ transparent: true, opacity: 0.55, depthWrite: false }),
    };
    this.eyes = [];
  }

  theme({ beam }) {
    for (const material of Object.values(this.materials)) material.color.set(beam);
  }

  /** Whether readings are drawn. */
  get isDrawn() {
    return this.eyes.length > 0 && this.object.visible;
  }

  /** Indices of the fields that it shows. */
  get fields() {
    return this.eyes.map(({ field }) => field);
  }

  /** Shows the readings of a robot of this type; null: none. */
  show(robot, type) {
    for (const eye of this.eyes) eye.dispose();
    this.robot = robot;
    const known = robot === null ? [] : eyesOf(this.recording, robot, type);
    this.eyes = known.map((eye) => new Eye(eye, this.materials));
    this.object.clear();
    for (const eye of this.eyes) this.object.add(eye.object);
    this.frame = null;
    this.object.visible = false;
  }

  /** Updates the scan; `view` is the View, with the poses of robots. */
  update(frame, view) {
    for (const { object, joint } of this.eyes) {
      const [x, y, z, heading] = view.placeOf(this.robot, joint);
      object.position.set(x, y, z);
      object.rotation.z = heading;
    }
    if (frame === this.frame) return;
    const { recording, robot } = this;
    this.object.visible = this.eyes.map((eye) => eye.redraw((beam) => recording.value(eye.field, frame, robot, beam))).every(Boolean);
    this.frame = this.object.visible ? frame : null;
  }
}
