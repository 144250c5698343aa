// Messages (JSON: topic, type, stamp_ns, base64 data) to MCAP, by its own library:
// write_mcap.mjs MESSAGES.json OUT.mcap none|lz4|zstd [FOLDER of node_modules]
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const [messagesPath, out, packing, folder] = process.argv.slice(2);
const { McapWriter } = createRequire(`${folder ?? process.cwd()}/`)("@mcap/core");

class Memory {
  parts = [];
  size = 0n;
  async write(part) {
    this.parts.push(Buffer.from(part));
    this.size += BigInt(part.byteLength);
  }
  position() {
    return this.size;
  }
}

const pack = (data) => ({ compression: packing, compressedData: execFileSync(packing, ["-c", "-q"], { input: data }) });
const memory = new Memory();
const writer = new McapWriter({ writable: memory, chunkSize: 30000, compressChunk: packing === "none" ? undefined : pack });
await writer.start({ profile: "ros2", library: "" });
const channels = new Map();
for (const message of JSON.parse(readFileSync(messagesPath, "utf8"))) {
  if (!channels.has(message.topic)) {
    const schemaId = await writer.registerSchema({ name: message.type, encoding: "ros2msg", data: Buffer.from("") });
    const channel = { schemaId, topic: message.topic, messageEncoding: "cdr", metadata: new Map() };
    channels.set(message.topic, await writer.registerChannel(channel));
  }
  const time = BigInt(message.stamp_ns);
  const data = Buffer.from(message.data, "base64");
  await writer.addMessage({ channelId: channels.get(message.topic), sequence: 0, logTime: time, publishTime: time, data });
}
await writer.end();
writeFileSync(out, Buffer.concat(memory.parts));
