// Unpacks what experiments/report/replay.py packed: the populations of a run in coordinates of the map.
"use strict";

const FEASIBLE = 1, NEW = 2, REMOVED = 4;

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Reads the values of frames, which are stored as differences to the same row in the frame before.
function readFrames(bytes, offset, rowsOfFrames, width) {
  const count = rowsOfFrames.reduce((sum, rows) => sum + rows * width, 0);
  const low = bytes.subarray(offset, offset + count);
  const high = bytes.subarray(offset + count, offset + 2 * count);
  const frames = [];
  let at = 0, before = new Int32Array(0);
  for (const rows of rowsOfFrames) {
    const values = new Int32Array(rows * width);
    for (let k = 0; k < values.length; k++, at++) {
      const zigzag = low[at] | (high[at] << 8);
      values[k] = ((zigzag >>> 1) ^ -(zigzag & 1)) + (k < before.length ? before[k] : 0);
    }
    frames.push((before = values));
  }
  return { frames, end: offset + 2 * count };
}

class Replay {
  static async unpack(packed) {
    const replay = Object.assign(new Replay(), packed);
    const bytes = await inflate(packed.data);
    const members = readFrames(bytes, 0, packed.sizes, packed.varying.length);
    const best = readFrames(bytes, members.end, packed.sizes.map(() => 1), packed.bestWidth);
    replay.moved = members.frames;
    replay.best = best.frames;
    replay.flags = [];
    let at = best.end;
    for (const size of packed.sizes) {
      replay.flags.push(bytes.subarray(at, at + size));
      at += size;
    }
    replay.bestFlags = bytes.subarray(at, at + packed.sizes.length);
    return replay;
  }

  // Coordinates x0, y0, x1, y1, ... of a member of a frame, between 0 and 2^bits - 1.
  member(frame, index) {
    const values = Int32Array.from(this.fixed);
    const width = this.varying.length;
    this.varying.forEach((column, k) => (values[column] = this.moved[frame][index * width + k]));
    return values;
  }

  // The last frame that is not after an iteration.
  frameAt(iteration) {
    let frame = 0;
    while (frame + 1 < this.frames.length && this.frames[frame + 1] <= iteration) frame++;
    return frame;
  }
}
