// What the rangers of the selected robot read, as fans of light.

import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial } from "three";

const COLOR = 0x2f6fb0;

/** The rangers of a type whose readings were recorded: fans, and the field with the readings. */
function eyesOf(header, type) {
  return Object.entries(header.types[type].eyes).flatMap(([name, fans]) => {
    const field = header.fields.findIndex(
      ({ component, name: what }) => what === "ranges" && component.startsWith("sensors/") && component.endsWith(`/${name}`),
    );
    const beams = fans.reduce((sum, fan) => sum + fan.beams, 0);
    return field >= 0 && header.fields[field].columns === beams ? [{ field, fans, beams }] : [];
  });
}

export class Scan {
  constructor(recording) {
    this.recording = recording;
    this.object = new Group();
    this.object.visible = false;
    this.area = new Mesh(
      new BufferGeometry(),
      new MeshBasicMaterial({ color: COLOR, transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false }),
    );
    this.lines = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ color: COLOR, transparent: true, opacity: 0.55, depthWrite: false }),
    );
    this.object.add(this.area, this.lines);
    for (const object of this.object.children) object.frustumCulled = false;
    this.eyes = [];
  }

  get fields() {
    return this.eyes.map(({ field }) => field);
  }

  /** Whose readings are shown: a robot and its type, or null. */
  show(robot, type) {
    this.robot = robot;
    this.eyes = robot === null ? [] : eyesOf(this.recording.header, type).filter(({ field }) => this.recording.fieldRows[field].of[robot] >= 0);
    this.frame = null;
    this.object.visible = false;
  }

  update(frame, poses) {
    if (this.eyes.length === 0) return;
    const at = 4 * this.robot;
    this.object.position.set(poses[at], poses[at + 1], poses[at + 2]);
    this.object.rotation.z = poses[at + 3];
    if (frame !== this.frame) this.object.visible = this.redraw(frame);
  }

  redraw(frame) {
    const triangles = [];
    const lines = [];
    for (const { field, fans } of this.eyes) {
      let beam = 0;
      for (const fan of fans) {
        const [x, y, z, heading] = fan.pose;
        let last = null;
        for (let i = 0; i < fan.beams; i++, beam++) {
          const range = this.recording.value(field, frame, this.robot, beam);
          if (range === null) return false; // on its way
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
    }
    for (const [object, positions] of [[this.area, triangles], [this.lines, lines]]) {
      object.geometry.dispose();
      object.geometry = new BufferGeometry();
      object.geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
    }
    this.frame = frame;
    return true;
  }
}
