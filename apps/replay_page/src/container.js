// Reads the recording in the page: base64 of the length of the header (4 bytes, little-endian), the header (JSON) and the
// blocks. Header and blocks are compressed with zlib.

const PIECE = 1 << 20; // characters decoded at a time, a multiple of 4

export function decodeBase64(text) {
  const letters = text.length;
  const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
  const bytes = new Uint8Array((letters / 4) * 3 - padding);
  let to = 0;
  for (let from = 0; from < letters; from += PIECE) {
    const piece = atob(text.slice(from, from + PIECE));
    for (let i = 0; i < piece.length; i++) bytes[to++] = piece.charCodeAt(i);
  }
  return bytes;
}

export async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Returns the header, and for each block the compressed bytes of each of its streams. */
export async function openContainer(text) {
  const bytes = decodeBase64(text.trim());
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(await inflate(bytes.subarray(4, 4 + length))));
  let at = 4 + length;
  const blocks = header.block_bytes.map((streams) =>
    streams.map((size) => {
      const stream = bytes.subarray(at, at + size);
      at += size;
      return stream;
    }),
  );
  if (at !== bytes.length) throw new Error(`the recording in the page has ${bytes.length} bytes instead of ${at}: the page is incomplete`);
  return { header, blocks };
}
