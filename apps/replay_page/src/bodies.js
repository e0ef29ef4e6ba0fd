// Bodies of one type, drawn as instances of a mesh with a pose and a colour each.

import { InstancedBufferAttribute, InstancedBufferGeometry, LineSegments, Mesh } from "three";
import { LEAST_WITH_EDGES, LEAST_WITH_SHADOW, edgesMaterial, facesMaterial, shadowsMaterial } from "./materials.js";

function instanced(mesh, count, attributes) {
  const geometry = new InstancedBufferGeometry();
  for (const [name, attribute] of Object.entries(mesh.attributes)) geometry.setAttribute(name, attribute);
  for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
  geometry.instanceCount = count;
  return geometry;
}

export class Bodies {
  /**
   * meshes    from geometry.js
   * radius    of a circle around a body, m
   * poses     x, y, z (m) and heading (rad) of each body
   * tints     three bytes per body
   * smallest  least size on the screen, pixels
   */
  constructor(meshes, radius, poses, tints, smallest) {
    const count = tints.length / 3;
    this.pose = new InstancedBufferAttribute(poses, 4);
    this.tint = new InstancedBufferAttribute(tints, 3, true);
    this.radius = radius;
    const attributes = { pose: this.pose, tint: this.tint };
    this.edges = new LineSegments(instanced(meshes.edges, count, attributes), edgesMaterial(radius, smallest));
    this.shadows = new Mesh(instanced(meshes.faces, count, attributes), shadowsMaterial(radius, smallest));
    this.objects = [new Mesh(instanced(meshes.faces, count, attributes), facesMaterial(radius, smallest)), this.edges, this.shadows];
    for (const object of this.objects) object.frustumCulled = false; // positions are known only in the shader
  }

  /** Hides edges and shadows that would be too small to see. `nearest`: largest pixels per metre of any of the bodies. */
  simplify(nearest) {
    this.edges.visible = 2 * this.radius * nearest >= LEAST_WITH_EDGES;
    this.shadows.visible = 2 * this.radius * nearest >= LEAST_WITH_SHADOW;
  }

  posesChanged() {
    this.pose.needsUpdate = true;
  }

  tintsChanged() {
    this.tint.needsUpdate = true;
  }
}
