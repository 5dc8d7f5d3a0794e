// OpenEXR, as far as `render` and `report` write it: one part, scanlines, half or float, not compressed or ZIP.
// https://openexr.com/en/latest/OpenEXRFileLayout.html
import { unzlibSync } from "fflate";

const bytesOf = { 0: 4, 1: 2, 2: 4 }; // uint, half, float
const linesOf = { 0: 1, 2: 1, 3: 16 }; // none, ZIPS, ZIP

let halves = null;
/** All 65536 halves as floats, made when first wanted. */
function halfTable() {
  if (halves) return halves;
  halves = new Float32Array(65536);
  for (let i = 0; i < 65536; i++) {
    const sign = i & 0x8000 ? -1 : 1;
    const exponent = (i >> 10) & 31;
    const fraction = i & 1023;
    if (exponent === 31) halves[i] = fraction ? NaN : sign * Infinity;
    else halves[i] = sign * (exponent ? (1 + fraction / 1024) * 2 ** (exponent - 15) : fraction * 2 ** -24);
  }
  return halves;
}

class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }
  byte() {
    return this.view.getUint8(this.at++);
  }
  int() {
    this.at += 4;
    return this.view.getInt32(this.at - 4, true);
  }
  long() {
    const low = this.view.getUint32(this.at, true);
    const high = this.view.getUint32(this.at + 4, true);
    this.at += 8;
    return high * 2 ** 32 + low;
  }
  string() {
    const end = this.bytes.indexOf(0, this.at);
    if (end < 0) throw new Error("EXR: a name does not end");
    const text = new TextDecoder().decode(this.bytes.subarray(this.at, end));
    this.at = end + 1;
    return text;
  }
}

function readHeader(reader) {
  if (reader.int() !== 20000630) throw new Error("not an OpenEXR file");
  if (reader.int() & 0x1a00) throw new Error("EXR: tiles, deep data or several parts are not read");
  const header = { channels: [], compression: 0, window: null };
  for (let name = reader.string(); name; name = reader.string()) {
    const type = reader.string();
    const size = reader.int();
    const end = reader.at + size;
    if (type === "chlist") {
      for (let channel = reader.string(); channel; channel = reader.string()) {
        header.channels.push({ name: channel, type: reader.int() });
        reader.at += 12;
      }
    } else if (name === "compression") header.compression = reader.byte();
    else if (name === "dataWindow") header.window = [reader.int(), reader.int(), reader.int(), reader.int()];
    reader.at = end;
  }
  if (!header.window || !header.channels.length) throw new Error("EXR: no channels or no size");
  if (!(header.compression in linesOf)) throw new Error(`EXR: compression ${header.compression} is not read`);
  return header;
}

/** Undoes ZIP's two filters: differences of bytes, and halves of the bytes set apart. */
function unfilter(data) {
  for (let i = 1; i < data.length; i++) data[i] = (data[i - 1] + data[i] - 128) & 255;
  const out = new Uint8Array(data.length);
  const half = (data.length + 1) >> 1;
  for (let i = 0; i < half; i++) out[2 * i] = data[i];
  for (let i = half; i < data.length; i++) out[2 * (i - half) + 1] = data[i];
  return out;
}

function copyLine(view, at, channel, width, target, to, step) {
  const table = halfTable();
  for (let x = 0; x < width; x++) {
    const value =
      channel.type === 1
        ? table[view.getUint16(at + 2 * x, true)]
        : channel.type === 2
          ? view.getFloat32(at + 4 * x, true)
          : view.getUint32(at + 4 * x, true);
    target[to + step * x] = value;
  }
}

/** bytes -> {width, height, channels: 1 or 3, data: Float32Array, R G B interleaved or Y}. */
export function decodeExr(bytes) {
  const reader = new Reader(bytes);
  const header = readHeader(reader);
  const [left, top, right, bottom] = header.window;
  const width = right - left + 1;
  const height = bottom - top + 1;
  if (width < 1 || height < 1 || width * height > 1 << 26) throw new Error("EXR: impossible size");
  const names = header.channels.map((channel) => channel.name);
  const wanted = ["R", "G", "B"].every((name) => names.includes(name))
    ? ["R", "G", "B"]
    : [names.includes("Y") ? "Y" : names[0]];
  const data = new Float32Array(width * height * wanted.length);
  const lineBytes = header.channels.reduce((sum, channel) => sum + bytesOf[channel.type] * width, 0);
  const lines = linesOf[header.compression];
  const offsets = Array.from({ length: Math.ceil(height / lines) }, () => reader.long());
  for (const offset of offsets) {
    reader.at = offset;
    const y = reader.int() - top;
    const size = reader.int();
    const count = Math.min(lines, height - y);
    if (y < 0 || count < 1 || offset + 8 + size > bytes.length) throw new Error("EXR: a block lies outside the file");
    const packed = bytes.subarray(offset + 8, offset + 8 + size);
    const plain =
      size < lineBytes * count ? unfilter(unzlibSync(packed, { out: new Uint8Array(lineBytes * count) })) : packed;
    const view = new DataView(plain.buffer, plain.byteOffset, plain.byteLength);
    let at = 0;
    for (let line = 0; line < count; line++)
      for (const channel of header.channels) {
        const c = wanted.indexOf(channel.name);
        if (c >= 0) copyLine(view, at, channel, width, data, (y + line) * width * wanted.length + c, wanted.length);
        at += bytesOf[channel.type] * width;
      }
  }
  return { width, height, channels: wanted.length, data };
}

export function fromBase64(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}
