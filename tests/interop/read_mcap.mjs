// What an MCAP file holds, by its own library, as JSON: messages and the last one's fields by topic. Every checksum is
// compared, and the way by the index is held to the way from front to back.
// read_mcap.mjs FILE.mcap FOLDER of node_modules (@mcap/core, @foxglove/rosmsg, @foxglove/rosmsg2-serialization)
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import assert from "node:assert/strict";

const [path, folder] = process.argv.slice(2);
const use = createRequire(`${folder}/`);
const { McapIndexedReader, McapStreamReader } = use("@mcap/core");
const { parse } = use("@foxglove/rosmsg");
const { MessageReader } = use("@foxglove/rosmsg2-serialization");
const bytes = readFileSync(path);
const decompressHandlers = {
  zstd: (packed) => execFileSync("zstd", ["-d", "-c", "-q"], { input: packed, maxBuffer: 2 ** 30 }),
};

const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
const streamed = {};
const ends = {};
const channels = new Map();
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Channel") {
    channels.set(record.id, record.topic);
  } else if (record.type === "Message") {
    const topic = channels.get(record.channelId);
    streamed[topic] = (streamed[topic] ?? 0) + 1;
  } else if (record.type === "DataEnd" || record.type === "Footer" || record.type === "Statistics") {
    ends[record.type] = record;
  }
}
assert(stream.done(), "the file goes on to its magic");
assert(ends.DataEnd.dataSectionCrc !== 0 && ends.Footer.summaryCrc !== 0, "checksums are there");

const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
};
const indexed = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const readers = new Map();
for (const [id, schema] of indexed.schemasById) {
  assert.equal(schema.encoding, "ros2msg");
  readers.set(id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
}
const topics = {};
let before = 0n;
for await (const message of indexed.readMessages()) {
  assert(message.logTime >= before, "messages come by time");
  before = message.logTime;
  const channel = indexed.channelsById.get(message.channelId);
  const topic = (topics[channel.topic] ??= { type: indexed.schemasById.get(channel.schemaId).name, messages: 0 });
  topic.last = readers.get(channel.schemaId).readMessage(message.data);
  topic.messages += 1;
}
for (const [topic, { messages }] of Object.entries(topics)) {
  assert.equal(messages, streamed[topic]);
}
const total = Object.values(topics).reduce((sum, { messages }) => sum + messages, 0);
assert.equal(indexed.statistics.messageCount, BigInt(total));
assert.equal(indexed.statistics.chunkCount, indexed.chunkIndexes.length);
const plain = (key, value) =>
  typeof value === "bigint" ? Number(value) : ArrayBuffer.isView(value) ? Array.from(value) : value;
console.log(JSON.stringify({ profile: indexed.header.profile, chunks: indexed.chunkIndexes.length, topics }, plain));
