// Texts made small for an address, and files put into one.

const CODED = { "+": "-", "/": "_", "=": "" };

/** A text as letters that an address takes as they are. */
export async function deflated(text) {
  const bytes = await passed(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replace(/[+/=]/g, (sign) => CODED[sign]);
}

/** The text of `deflated`; rejects for other letters. */
export async function inflated(letters) {
  const binary = atob(letters.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  return new TextDecoder().decode(await passed(bytes, new DecompressionStream("deflate-raw")));
}

async function passed(bytes, through) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(through)).arrayBuffer());
}

/** A ZIP file of these [path, text], not compressed: APPNOTE 4.3.7, 4.3.12 and 4.3.16. */
export function zip(entries) {
  const [parts, directory] = [[], []];
  let offset = 0;
  for (const [path, text] of entries) {
    const [name, content] = [path, text].map((each) => new TextEncoder().encode(each));
    // Version 2.0, names in UTF-8, stored, 1 January 1980; then checksum and sizes.
    const about = [[20, 2], [0x800, 2], [0, 2], [0, 2], [33, 2], [checksum(content), 4], [content.length, 4],
      [content.length, 4], [name.length, 2], [0, 2]];
    parts.push(numbers([0x04034b50, 4], ...about), name, content);
    directory.push(numbers([0x02014b50, 4], [20, 2], ...about, [0, 2], [0, 2], [0, 2], [0, 4], [offset, 4]), name);
    offset += 30 + name.length + content.length;
  }
  const length = directory.reduce((sum, part) => sum + part.length, 0);
  const count = entries.length;
  const end = numbers([0x06054b50, 4], [0, 2], [0, 2], [count, 2], [count, 2], [length, 4], [offset, 4], [0, 2]);
  return new Blob([...parts, ...directory, end]);
}

/** Numbers, each of so many bytes, the lowest first. */
function numbers(...values) {
  return Uint8Array.from(values.flatMap(([value, bytes]) =>
    Array.from({ length: bytes }, (_, place) => (value >>> (8 * place)) & 255)));
}

/** CRC-32. */
function checksum(bytes) {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return (crc ^ -1) >>> 0;
}
