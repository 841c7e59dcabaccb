// Prints each message of an MCAP file as a line of JSON, decoded by Foxglove's own packages.
import { readFileSync } from "node:fs";
import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import { parse } from "@foxglove/rosmsg";
import { MessageReader as Ros1Reader } from "@foxglove/rosmsg-serialization";
import { MessageReader as Ros2Reader } from "@foxglove/rosmsg2-serialization";

const bytes = readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) =>
    new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: await loadDecompressHandlers(),
});
const plain = (_, value) =>
  typeof value === "bigint" ? value.toString() : ArrayBuffer.isView(value) ? Array.from(value) : value;
const readers = new Map();
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!readers.has(channel.id)) {
    const isRos2 = schema.encoding === "ros2msg";
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: isRos2 });
    readers.set(channel.id, isRos2 ? new Ros2Reader(definitions) : new Ros1Reader(definitions));
  }
  const value = readers.get(channel.id).readMessage(message.data);
  const line = { topic: channel.topic, type: schema.name, time: message.logTime, message: value };
  console.log(JSON.stringify(line, plain));
}
