// png.js -- the exact values of a PNG with 8 bits a channel, RGB or RGBA.
//
// A canvas keeps colours multiplied by alpha, so what is read back from one is not what
// the file holds wherever a picture is not opaque. Here the file is read itself (W3C PNG
// specification, third edition, 2025, clauses 5, 7 and 9). For any other kind of PNG the
// browser decodes it, and its values are as good as the canvas gives them.
"use strict";

const CHANNELS = { 2: 3, 6: 4 }; // by colour type

/** Returns {width, height, data}, RGBA with straight alpha, top row first. */
async function readPicture(bytes) {
  try {
    return await decodePng(bytes);
  } catch {
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(0, 0, bitmap.width, bitmap.height);
  }
}

async function decodePng(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (view.getUint32(0) !== 0x89504e47) throw new Error("no PNG");
  const width = view.getUint32(16);
  const height = view.getUint32(20);
  const channels = CHANNELS[bytes[25]];
  if (bytes[24] !== 8 || !channels || bytes[28] !== 0) throw new Error("another kind of PNG");
  const packed = [];
  for (let at = 8; at + 12 <= bytes.length; ) {
    const length = view.getUint32(at);
    const kind = String.fromCharCode(...bytes.subarray(at + 4, at + 8));
    if (kind === "IDAT") packed.push(bytes.subarray(at + 8, at + 8 + length));
    at += length + 12;
  }
  const stream = new Blob(packed).stream().pipeThrough(new DecompressionStream("deflate"));
  const lines = new Uint8Array(await new Response(stream).arrayBuffer());
  if (lines.length !== height * (width * channels + 1)) throw new Error("cut short");
  unfilter(lines, width * channels, height, channels);
  return { width, height, data: asRgba(lines, width, height, channels) };
}

// Each byte was stored less a guess from the bytes left, above, and above left of it.
function unfilter(lines, stride, height, channels) {
  const guesses = [
    () => 0,
    (left) => left,
    (left, above) => above,
    (left, above) => (left + above) >> 1,
    paeth,
  ];
  for (let row = 0; row < height; row++) {
    const start = row * (stride + 1) + 1;
    const guess = guesses[lines[start - 1]];
    for (let i = 0; i < stride; i++) {
      const left = i < channels ? 0 : lines[start + i - channels];
      const above = row === 0 ? 0 : lines[start + i - stride - 1];
      const corner = row === 0 || i < channels ? 0 : lines[start + i - stride - 1 - channels];
      lines[start + i] += guess(left, above, corner);
    }
  }
}

function paeth(left, above, corner) {
  const sum = left + above - corner;
  const toLeft = Math.abs(sum - left);
  const toAbove = Math.abs(sum - above);
  const toCorner = Math.abs(sum - corner);
  if (toLeft <= toAbove && toLeft <= toCorner) return left;
  return toAbove <= toCorner ? above : corner;
}

function asRgba(lines, width, height, channels) {
  const data = new Uint8ClampedArray(width * height * 4).fill(255);
  let to = 0;
  for (let row = 0; row < height; row++) {
    let from = row * (width * channels + 1) + 1;
    for (let column = 0; column < width; column++) {
      for (let channel = 0; channel < channels; channel++) data[to + channel] = lines[from++];
      to += 4;
    }
  }
  return data;
}
