// A line plot of a measure over time.

import { unitText } from "./panel.js";

const MOST_POINTS = 600;

/** A card for a Plot; `close` is called when its button is pressed. */
export function plotCard(close) {
  const card = document.createElement("div");
  card.className = "plot";
  card.innerHTML =
    '<button aria-label="Close" title="Close">×</button><p class="now"></p><svg viewBox="0 0 300 60" preserveAspectRatio="none"><path d=""/></svg><div class="ends"><span></span><span></span></div>';
  card.querySelector("button").onclick = close;
  return card;
}

export class Plot {
  constructor(root) {
    this.root = root;
    this.path = root.querySelector("path");
    this.clear();
  }

  clear() {
    this.points = [];
    this.root.classList.add("empty");
    this.root.querySelector(".now").textContent = "";
    this.path.setAttribute("d", "");
  }

  /** Adds a value at a world time, s; null: no value. */
  add(time, { column, value, unit = "" }) {
    const last = this.points[this.points.length - 1];
    if (value === null || (last && last[0] >= time)) return;
    this.points.push([time, value]);
    this.root.classList.remove("empty");
    if (this.points.length > MOST_POINTS) this.points.shift();
    const values = this.points.map(([, y]) => y);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const [begin, span] = [this.points[0][0], time - this.points[0][0] || 1];
    const place = ([x, y]) => `${((x - begin) / span) * 300} ${58 - ((y - low) / (high - low || 1)) * 56}`;
    this.path.setAttribute("d", `M${this.points.map(place).join("L")}`);
    this.root.querySelector(".now").textContent = `${column} ${Number(value.toPrecision(5))}${unitText(unit)}`;
    const [left, right] = this.root.querySelectorAll(".ends span");
    left.textContent = `${Number(low.toPrecision(4))} to ${Number(high.toPrecision(4))}`;
    right.textContent = `last ${span.toFixed(0)} s`;
  }
}
