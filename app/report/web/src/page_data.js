// The page's data from C++: one JSON text (page-data) and packed arrays (page_arrays.hpp).

export const pageData = () => JSON.parse(document.getElementById('page-data').textContent);

const types = {
  f4: [Float32Array, 4],
  f8: [Float64Array, 8],
  i4: [Int32Array, 4],
  share: [Uint16Array, 2],
};
const nobody = 65535;  // code for an unknown share
const whole = 65534;   // code for a share of 1
const unpacked = new Map();

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// Values from byte planes: all first bytes, then all second bytes, and so on. Byte planes compress better.
export function fromPlanes(planes, {type, size}) {
  const [Type, width] = types[type];
  const bytes = new Uint8Array(size * width);
  for (let b = 0; b < width; ++b) {
    for (let i = 0; i < size; ++i) bytes[i * width + b] = planes[b * size + i];
  }
  const values = new Type(bytes.buffer);
  return type === 'share' ? Float32Array.from(values, (v) => (v === nobody ? NaN : v / whole)) : values;
}

// Decodes and unpacks the array that an element of the page contains.
async function unpack(place) {
  const stored = bytesOf(document.getElementById(place.id).textContent);
  const stream = new Blob([stored]).stream().pipeThrough(new DecompressionStream('deflate'));
  return fromPlanes(new Uint8Array(await new Response(stream).arrayBuffer()), place);
}

// The typed array that a reference names. It is unpacked on first use. A typed array is returned unchanged.
export function array(place) {
  if (!place || ArrayBuffer.isView(place)) return Promise.resolve(place || null);
  if (!unpacked.has(place.id)) unpacked.set(place.id, unpack(place));
  return unpacked.get(place.id);
}
