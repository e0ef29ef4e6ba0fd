// Numbers that change from frame to frame, as worldio/results/replay_codec.cpp packs them: of each value how far it is from what
// was expected, 7 bits a byte, the low ones first; 0 for an absent one.

/** A position or heading of a robot that is not there. */
export const ABSENT = -0x80000000;

const SLICE = 20000; // values between two chances to let a picture go first

/**
 * Unpacks `count` series of `frames` values each, which follow one another: value f of series s goes to
 * out[f * count + s].
 * line     whether values are expected on a line through the two before, not at the one before
 * absent   what stands for an absent value; `bias` is added to the others
 * Returns where in `bytes` the next series begins. A generator: it yields now and then.
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
