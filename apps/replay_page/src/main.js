// The page of `troupe replay`.

import { openContainer } from "./container.js";
import { checkBrowser, Page, remote, show } from "./page.js";
import { Panel } from "./panel.js";
import { Player } from "./player.js";
import { Recording } from "./recording.js";
import { ReplayBar } from "./replay_bar.js";

/** For scripts: remote(), and functions that only a replay page has. */
function replayRemote(page) {
  const { recording, player } = page;
  const common = remote(page);
  return {
    ...common,
    state: () => ({
      ...common.state(),
      start: player.start,
      end: player.end,
      frames: recording.frames,
      coloured: page.coloring.done === "own" || page.coloring.done === page.drawn,
      shown: page.drawn === recording.frameAt(player.time).frame,
    }),
    seek: (time) => player.seek(time),
    setSpeed: (speed) => (player.speed = speed),
  };
}

async function begin() {
  checkBrowser();
  const place = document.getElementById("recording");
  const recording = new Recording(await openContainer(place.textContent));
  const page = new Page(recording, new Player(recording.start, recording.end), { Bar: ReplayBar, Panel, name: "replay" });
  place.remove(); // frees tens of megabytes of text
  window.troupe = replayRemote(page);
  show(page);
}

begin();
