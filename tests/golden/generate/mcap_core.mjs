// tests/golden/data/mcap_core_*.mcap: forty messages, written by npm's @mcap/core (2.2.2), lz4js (0.2.0) and zstd-codec
// (0.1.5). Usage, in a folder where `npm install @mcap/core lz4js zstd-codec` was run: node mcap_core.mjs FOLDER
// tests/python/frames_test.py has the same numbers in closed form.
import { createRequire } from "node:module";
import { writeFileSync } from "node:fs";
import { join } from "node:path";

const require = createRequire(join(process.cwd(), "package.json"));
const { McapWriter } = require("@mcap/core");
const lz4 = require("lz4js");
const { ZstdCodec } = require("zstd-codec");

class Memory {
  constructor() { this.parts = []; this.bytes = 0n; }
  async write(data) { this.parts.push(Buffer.from(data)); this.bytes += BigInt(data.byteLength); }
  position() { return this.bytes; }
}

// XCDR1, little-endian: stamp at 0, x at 8, n at 16, the string's length at 20.
function message(k) {
  const text = Buffer.from(`m${k}\0`);
  const after = 24 + text.length + ((4 - (text.length % 4)) % 4);
  const out = Buffer.alloc(4 + after + 4 + 8);
  out[1] = 1;
  const body = out.subarray(4);
  body.writeInt32LE(1700000000, 0);
  body.writeUInt32LE(k * 25000000, 4);
  body.writeDoubleLE(k / 4, 8);
  body.writeInt32LE(-k, 16);
  body.writeUInt32LE(text.length, 20);
  text.copy(body, 24);
  body.writeUInt32LE(2, after);
  body.writeFloatLE(k, after + 4);
  body.writeFloatLE(k + 0.5, after + 8);
  return out;
}

async function write(path, options) {
  const memory = new Memory();
  const writer = new McapWriter({ writable: memory, chunkSize: 500, ...options });
  await writer.start({ profile: "ros2", library: "" });
  const definition = "builtin_interfaces/Time stamp\nfloat64 x\nint32 n\nstring s\nfloat32[] pair\n";
  const schemaId = await writer.registerSchema({ name: "golden/msg/Sample", encoding: "ros2msg", data: Buffer.from(definition) });
  const channelId = await writer.registerChannel({ schemaId, topic: "/golden", messageEncoding: "cdr", metadata: new Map() });
  for (let k = 0; k < 40; ++k) {
    const time = 1700000001000000000n + BigInt(k) * 25000000n;
    await writer.addMessage({ channelId, sequence: k, publishTime: time, logTime: time, data: message(k) });
  }
  await writer.end();
  writeFileSync(path, Buffer.concat(memory.parts));
}

ZstdCodec.run(async (codec) => {
  const zstd = new codec.Simple();
  const folder = process.argv[2];
  const forms = {
    none: {},
    lz4: { compressChunk: (data) => ({ compression: "lz4", compressedData: lz4.compress(data) }) },
    zstd: { compressChunk: (data) => ({ compression: "zstd", compressedData: zstd.compress(data) }) },
    unchunked: { useChunks: false },
    bare: { useStatistics: false, useSummaryOffsets: false, useChunkIndex: false, useMessageIndex: false, repeatSchemas: false, repeatChannels: false },
  };
  for (const [name, options] of Object.entries(forms)) await write(join(folder, `mcap_core_${name}.mcap`), options);
});
