// Colours, as those of `troupe run --snapshot`: dark on paper.

export const PAPER = [250, 247, 240];
export const GRID = [233, 227, 214];
export const INK = [38, 36, 33];
export const NEUTRAL = [176, 170, 158]; // of robots without a value

/** "#rrggbb" as three bytes. */
export function bytesOf(hex) {
  const number = parseInt(hex.slice(1), 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}

// Viridis (Smith and van der Walt, 2015; in the public domain) at nine places: even steps look even, in grey and to the
// colour-blind too. The yellow end is left out: it would vanish on paper.
const STOPS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30"].map(bytesOf);
const SHADES = 256;

const scale = new Uint8Array(3 * SHADES);
for (let i = 0; i < SHADES; i++) {
  const at = (i / (SHADES - 1)) * (STOPS.length - 1);
  const low = Math.min(Math.floor(at), STOPS.length - 2);
  for (let c = 0; c < 3; c++) scale[3 * i + c] = Math.round(STOPS[low][c] + (at - low) * (STOPS[low + 1][c] - STOPS[low][c]));
}

/** Writes the colour of a share, 0 to 1, as three bytes; the neutral one where it is NaN. */
export function shadeInto(share, out, at) {
  if (!(share === share)) {
    out[at] = NEUTRAL[0];
    out[at + 1] = NEUTRAL[1];
    out[at + 2] = NEUTRAL[2];
    return;
  }
  const from = 3 * Math.round(Math.min(Math.max(share, 0), 1) * (SHADES - 1));
  out[at] = scale[from];
  out[at + 1] = scale[from + 1];
  out[at + 2] = scale[from + 2];
}

/** The scale from left to right, for a legend. */
export function scaleGradient() {
  return `linear-gradient(to right, ${STOPS.map(([r, g, b]) => `rgb(${r} ${g} ${b})`).join(", ")})`;
}
