// Short messages to the user of the live page.

const TOLD_MS = 6000; // time for which a message is shown

let timer = 0;

export function tell(text) {
  const place = document.getElementById("told");
  place.textContent = text;
  place.hidden = false;
  clearTimeout(timer);
  timer = setTimeout(() => (place.hidden = true), TOLD_MS);
}
