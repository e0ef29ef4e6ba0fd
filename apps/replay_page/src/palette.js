// Colours: dark on light, as in `troupe run --snapshot`, or light on dark.

/** `paper` is the background, `line` the grid, `none` robots without a value, `accent` the selection, `beam` scans. */
export const LIGHT = { paper: [250, 247, 240], line: [233, 227, 214], none: [176, 170, 158], accent: 0xd0442a, beam: 0x2f6fb0 };
export const DARK = { paper: [23, 25, 29], line: [40, 43, 49], none: [104, 106, 112], accent: 0xff7a5c, beam: 0x6fb4ff };

/** "#rrggbb" as three bytes. */
export function bytesOf(hex) {
  const number = parseInt(hex.slice(1), 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}

// Viridis (Smith and van der Walt, 2015; in the public domain) at nine points. It is perceptually uniform, also in grey and
// for the colour-blind. The end with too little contrast is omitted: yellow on light, purple on dark.
const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"].map(bytesOf);
const SHADES = 256;

let stops;
let none;
const scale = new Uint8Array(3 * SHADES);

/** Sets the colour scale for a theme. */
export function useTheme(theme) {
  stops = theme === DARK ? VIRIDIS.slice(2) : VIRIDIS.slice(0, -1);
  none = theme.none;
  for (let i = 0; i < SHADES; i++) {
    const at = (i / (SHADES - 1)) * (stops.length - 1);
    const low = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; c++) scale[3 * i + c] = Math.round(stops[low][c] + (at - low) * (stops[low + 1][c] - stops[low][c]));
  }
}
useTheme(LIGHT);

/** Writes the colour of a fraction, 0 to 1, as three bytes; that of `none` for NaN. */
export function shadeInto(share, out, at) {
  if (!(share === share)) {
    out[at] = none[0];
    out[at + 1] = none[1];
    out[at + 2] = none[2];
    return;
  }
  const from = 3 * Math.round(Math.min(Math.max(share, 0), 1) * (SHADES - 1));
  out[at] = scale[from];
  out[at + 1] = scale[from + 1];
  out[at + 2] = scale[from + 2];
}

/** The colour scale from left to right as a CSS gradient, for the legend. */
export function scaleGradient() {
  return `linear-gradient(to right, ${stops.map(([r, g, b]) => `rgb(${r} ${g} ${b})`).join(", ")})`;
}
