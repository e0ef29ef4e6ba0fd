// Unpacks time series that worldio/results/replay_codec.cpp has packed: the difference of each value from its prediction, 7
// bits per byte, low bits first; 0 for an absent value.

/** The position and heading that mark a robot as not in the world, in unpacked series. */
export const ABSENT = -0x80000000;

const SLICE = 20000; // values between two yields

/**
 * Unpacks `count` consecutive series of `frames` values each: value f of series s goes to out[f * count + s].
 * line     whether values are predicted on a line through the two before, instead of equal to the one before
 * absent   the output for an absent value; `bias` is added to the others
 * Returns the index in `bytes` at which the next series begins. A generator, which yields about every SLICE values.
 */
export function* unpackSeries(bytes, at, { frames, count, line, absent, bias }, out) {
  let left = SLICE;
  for (let s = 0; s < count; s++) {
    let last = 0;
    let before = 0;
    let begins = true;
    for (let f = 0, to = s; f < frames; f++, to += count) {
      let byte = bytes[at++];
      let code = byte & 127;
      for (let shift = 7; byte > 127; shift += 7) {
        byte = bytes[at++];
        code |= (byte & 127) << shift;
      }
      if (code === 0) {
        out[to] = absent;
        before = last;
        begins = true;
        continue;
      }
      const off = ((code - 1) >>> 1) ^ -((code - 1) & 1);
      const value = off + (line ? 2 * last - before : last);
      before = begins ? value : last;
      last = value;
      begins = false;
      out[to] = value + bias;
    }
    left -= frames;
    if (left <= 0) {
      left = SLICE;
      yield;
    }
  }
  return at;
}
