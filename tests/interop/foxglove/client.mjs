// A client of Foxglove's protocol: subscribes to every channel, and prints each event as a line of
// JSON, messages decoded by Foxglove's own packages. Further words are messages that it
// publishes.
import protocol from "@foxglove/ws-protocol";
import { parse } from "@foxglove/rosmsg";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg-serialization";
import WebSocket from "ws";

const plain = (_, value) =>
  typeof value === "bigint" ? value.toString() : ArrayBuffer.isView(value) ? Array.from(value) : value;
const print = (event, value) => console.log(JSON.stringify({ event, ...value }, plain));

const socket = new WebSocket(process.argv[2], ["foxglove.sdk.v1"]);
const client = new protocol.FoxgloveClient({ ws: socket });
const subscribed = new Map();
client.on("serverInfo", ({ capabilities }) => print("info", { capabilities }));
client.on("status", ({ message }) => print("status", { message }));
client.on("error", (error) => print("error", { message: String(error) }));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    const isRos = channel.encoding === "ros1";
    const reader = isRos && new MessageReader(parse(channel.schema, { ros2: false }));
    subscribed.set(client.subscribe(channel.id), { channel, reader });
    print("channel", { topic: channel.topic, type: channel.schemaName, encoding: channel.encoding });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { channel, reader } = subscribed.get(subscriptionId);
  const message = reader ? reader.readMessage(data) : JSON.parse(new TextDecoder().decode(data));
  print("message", { topic: channel.topic, time: timestamp, message });
});
client.on("connectionGraphUpdate", ({ publishedTopics }) => print("graph", { publishedTopics }));
client.on("open", () => client.subscribeConnectionGraph());

for (const wish of process.argv.slice(3).map((text) => JSON.parse(text))) {
  const { topic, schemaName, encoding, message, definition } = wish;
  const bytes = definition
    ? new MessageWriter(parse(definition, { ros2: false })).writeMessage(message)
    : new TextEncoder().encode(JSON.stringify(message));
  client.on("serverInfo", () => {
    const channel = client.advertise({ topic, encoding, schemaName });
    setInterval(() => client.sendMessage(channel, bytes), 100);
  });
}
