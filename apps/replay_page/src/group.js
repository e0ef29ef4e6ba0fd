// A group of robots: selected with a box, marked with squares, and commanded together.

import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from "three";

const MARGIN = 1.4; // size of a mark, in radii of its robot
const LEAST_BOX = 5; // pixels; a smaller box is a click
const CORNERS = [[1, 1], [-1, 1], [-1, -1], [1, -1]];

/** The squares around the robots of a group. */
export class Marks {
  constructor() {
    this.object = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ depthTest: false, transparent: true }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 2;
    this.show([]);
  }

  theme({ accent }) {
    this.object.material.color.set(accent);
  }

  show(robots) {
    this.robots = robots;
    this.object.visible = robots.length > 0;
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.places = new BufferAttribute(new Float32Array(24 * robots.length), 3);
    this.object.geometry.setAttribute("position", this.places);
  }

  /** `view` is the View, with the poses of robots. */
  update(view) {
    const { array } = this.places;
    let to = 0;
    for (const robot of this.robots) {
      const [x, y, z, heading] = view.poses.subarray(4 * robot, 4 * robot + 4);
      const { radius, top } = view.trunks[view.typeOf[robot]];
      const size = heading > 1e8 ? 0 : MARGIN * radius; // 0: the robot is not in the world
      for (let i = 0; i < 4; i++)
        for (const [dx, dy] of [CORNERS[i], CORNERS[(i + 1) % 4]]) {
          array[to++] = x + size * dx;
          array[to++] = y + size * dy;
          array[to++] = z + top;
        }
    }
    this.places.needsUpdate = this.robots.length > 0;
  }
}

/** Selects robots with a box: calls `done` with the corners of the box (CSS pixels) after a drag with Shift. */
export function listenToBoxes(canvas, mayBegin, controls, done) {
  const box = document.getElementById("box");
  let from = null;
  const place = ({ clientX, clientY }) => {
    const corners = [Math.min(from[0], clientX), Math.min(from[1], clientY), Math.max(from[0], clientX), Math.max(from[1], clientY)];
    Object.assign(box.style, { left: `${corners[0]}px`, top: `${corners[1]}px`, width: `${corners[2] - corners[0]}px`, height: `${corners[3] - corners[1]}px` });
    return corners;
  };
  window.addEventListener(
    "pointerdown",
    (event) => {
      if (event.target !== canvas || !event.isPrimary || event.button !== 0 || !event.shiftKey || !mayBegin(event)) return;
      controls.enabled = false; // the drag must not move the view
      from = [event.clientX, event.clientY];
      place(event);
      box.hidden = false;
    },
    { capture: true },
  );
  window.addEventListener("pointermove", (event) => from && place(event));
  const end = (event) => {
    if (!from) return;
    const corners = place(event);
    from = null;
    box.hidden = true;
    controls.enabled = true;
    if (event.type === "pointerup" && Math.hypot(corners[2] - corners[0], corners[3] - corners[1]) > LEAST_BOX) done(...corners);
  };
  window.addEventListener("pointerup", end);
  window.addEventListener("pointercancel", end);
}
