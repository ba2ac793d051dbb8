/** Writes containers, independently of the program that makes real ones. */

import { deflateSync } from "node:zlib";
import type { ElementType, NumberArray } from "../src/data/container";

export interface Part {
  type: ElementType;
  values: NumberArray;
  stride?: number;
}

export function writeContainer(header: object, parts: Record<string, Part>): Uint8Array {
  const arrays: Record<string, object> = {};
  const blocks: { offset: number; bytes: Uint8Array }[] = [];
  let size = 0;
  for (const [name, { type, values, stride }] of Object.entries(parts)) {
    let packed = values;
    if (stride) {
      packed = values.slice();
      for (let i = values.length - 1; i >= stride; --i) packed[i] = values[i] - values[i - stride];
    }
    arrays[name] = { offset: size, type, count: values.length, ...(stride ? { stride } : {}) };
    blocks.push({ offset: size, bytes: new Uint8Array(packed.buffer, packed.byteOffset, packed.byteLength) });
    size += Math.ceil(packed.byteLength / 8) * 8;
  }
  const json = new TextEncoder().encode(JSON.stringify({ ...header, arrays }));
  const start = Math.ceil((8 + json.length) / 8) * 8;
  const bytes = new Uint8Array(start + size);
  bytes.set(new TextEncoder().encode("GTV1"));
  new DataView(bytes.buffer).setUint32(4, json.length, true);
  bytes.set(json, 8);
  for (const { offset, bytes: block } of blocks) bytes.set(block, start + offset);
  return bytes;
}

/** The text that takes the place of @GOTAI_RUN@ in the page. */
export function toText(container: Uint8Array): string {
  return deflateSync(container).toString("base64");
}

/** Half-precision word nearest to a number of ordinary size. */
export function toHalf(value: number): number {
  const sign = value < 0 ? 0x8000 : 0;
  const size = Math.min(65504, Math.abs(value));
  if (size < 2 ** -24) return sign;
  const exponent = Math.max(-14, Math.floor(Math.log2(size)));
  const fraction = Math.round((size / 2 ** exponent - (size < 2 ** -14 ? 0 : 1)) * 1024);
  return sign + ((size < 2 ** -14 ? 0 : exponent + 15) << 10) + fraction;
}
