// Controls that only the replay page has: the time bar and the speed.

import { Bar, byId, fill, timeText } from "./bar.js";
import { SPEEDS } from "./player.js";

export class ReplayBar extends Bar {
  constructor(page) {
    super(page);
    const { player } = page;
    const scrub = byId("scrub");
    scrub.min = player.start;
    scrub.max = player.end;
    scrub.oninput = () => player.seek(Number(scrub.value));
    byId("end").textContent = timeText(player.end);
    fill(byId("speed"), SPEEDS.map((speed) => `${speed}×`));
    byId("speed").onchange = (event) => (player.speed = SPEEDS[event.target.value]);
  }

  actions(event) {
    const { player, recording } = this.page;
    const second = event.shiftKey ? 10 : 1;
    const frame = (by) => {
      const { frame: now } = recording.frameAt(player.time);
      player.playing = false;
      player.seek(recording.times[Math.min(Math.max(now + by, 0), recording.frames - 1)]);
    };
    return {
      ...super.actions(event),
      ArrowLeft: () => player.seek(player.time - second),
      ArrowRight: () => player.seek(player.time + second),
      ",": () => frame(-1),
      ".": () => frame(1),
      Home: () => player.seek(player.start),
      End: () => player.seek(player.end),
      "+": () => player.faster(1),
      "=": () => player.faster(1),
      "-": () => player.faster(-1),
    };
  }

  update() {
    super.update();
    const { player } = this.page;
    this.set("scrub", player.time, (time) => (byId("scrub").value = time));
    this.set("speed", SPEEDS.indexOf(player.speed), (at) => (byId("speed").selectedIndex = at));
  }
}
