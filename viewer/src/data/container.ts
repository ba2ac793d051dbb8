/**
 * The binary container that carries a run into the page: a JSON header and named arrays.
 *
 * Layout, little endian: "GTV1" | u32 header bytes | header (UTF-8 JSON) | zero padding to 8 | data.
 * The header's "arrays" say where each array lies: byte offset into the data (a multiple of 8),
 * element type, element count, and an optional "stride": elements are then differences to the
 * element `stride` places before (modulo the type's range), which deflates well.
 */

export type ElementType = "u8" | "u16" | "i16" | "u32" | "f32" | "f64";
export type NumberArray =
  | Uint8Array | Uint16Array | Int16Array | Uint32Array | Float32Array | Float64Array;

export interface ArrayEntry {
  offset: number;
  type: ElementType;
  count: number;
  stride?: number;
}

const constructors = {
  u8: Uint8Array,
  u16: Uint16Array,
  i16: Int16Array,
  u32: Uint32Array,
  f32: Float32Array,
  f64: Float64Array,
} as const;

/** A decoded container: its header and access to the arrays it names. */
export class Container<Header> {
  constructor(
    readonly header: Header,
    private readonly entries: Record<string, ArrayEntry>,
    private readonly data: ArrayBuffer,
    private readonly start: number,
  ) {}

  has(name: string): boolean {
    return name in this.entries;
  }

  /** The array of that name, with differences summed up. Throws when there is none. */
  array(name: string): NumberArray {
    const entry = this.entries[name];
    if (!entry) throw new Error(`the data has no array "${name}"`);
    const type = constructors[entry.type];
    const begin = this.start + entry.offset;
    if (!type || begin + entry.count * type.BYTES_PER_ELEMENT > this.data.byteLength)
      throw new Error(`array "${name}" does not fit into the data`);
    const values = new type(this.data, begin, entry.count);
    if (!entry.stride) return values;
    const sums = values.slice();
    for (let i = entry.stride; i < sums.length; ++i) sums[i] += sums[i - entry.stride];
    return sums;
  }
}

const kMagic = 0x31565447; // "GTV1"

/** Reads a container. Throws an Error that says what is wrong with the bytes. */
export function readContainer<Header>(bytes: Uint8Array): Container<Header> {
  // A copy at offset 0, because typed arrays must be aligned within their buffer.
  const data = bytes.slice().buffer;
  const view = new DataView(data);
  if (data.byteLength < 8 || view.getUint32(0, true) !== kMagic)
    throw new Error("this is not the data of a Gotai run");
  const headerBytes = view.getUint32(4, true);
  if (8 + headerBytes > data.byteLength) throw new Error("the data of the run is cut off");
  const text = new TextDecoder().decode(new Uint8Array(data, 8, headerBytes));
  const { arrays, ...header } = JSON.parse(text);
  const start = Math.ceil((8 + headerBytes) / 8) * 8;
  return new Container<Header>(header as Header, arrays ?? {}, data, start);
}

/** Bytes of a base64 text; white space is allowed. */
export function fromBase64(text: string): Uint8Array {
  const raw = atob(text.replace(/\s+/g, ""));
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

/** Undoes zlib's deflate. */
export async function inflate(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
