// The clock of the replay page.

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100];

export class Player {
  constructor(start, end) {
    this.start = start;
    this.end = end;
    this.time = start;
    this.speed = 1;
    this.playing = false;
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
  }

  /** Plays, from the start if at the end; or pauses. */
  play(on = true) {
    if (on && this.time >= this.end) this.time = this.start;
    this.playing = on && this.end > this.start;
  }

  faster(steps) {
    const at = SPEEDS.findIndex((speed) => speed >= this.speed);
    this.speed = SPEEDS[Math.min(Math.max(at + steps, 0), SPEEDS.length - 1)];
  }

  /** Advances by real time, s; at most 0.25 s, so that the recording does not jump after the machine has slept. */
  advance(seconds) {
    if (!this.playing) return;
    this.time += Math.min(seconds, 0.25) * this.speed;
    if (this.time < this.end) return;
    this.time = this.end;
    this.playing = false;
  }
}
