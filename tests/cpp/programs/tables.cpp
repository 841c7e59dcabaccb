// Answers questions about names, command lines, values and bytes, one a line, for comparison with
// Python: words are separated by 0x1f, lines by 0x1e.
#include <lcmtools/node.hpp>

#include <iterator>
#include <sstream>

using lcmtools::Error;
using Words = std::vector<std::string>;

static Words split(const std::string& text, char separator) {
  Words words(1);
  for (char c : text) {
    if (c == separator) words.emplace_back();
    else words.back() += c;
  }
  return words;
}

static std::string joined(const Words& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : "\x1f") + word;
  return text;
}

static std::string resolve(const Words& words) {  // namespace, node, name, from, to, ...
  lcmtools::names::Resolver resolver{words[1], words[2], {}};
  for (std::size_t i = 4; i + 1 < words.size(); i += 2) resolver.remaps.emplace_back(words[i], words[i + 1]);
  return resolver.resolve(words[3]);
}

static std::string arguments(const Words& words) {
  const auto said = lcmtools::split_arguments({words.begin() + 1, words.end()});
  Words result = {"ns=" + said.ns, "name=" + said.name, "url=" + said.lcm_url, "domain=" + said.domain};
  for (const auto& [from, to] : said.remaps) result.push_back("remap " + from + "=" + to);
  for (const auto& [name, text] : said.parameters) result.push_back("parameter " + name + "=" + text);
  for (const auto& word : said.rest) result.push_back("rest " + word);
  return joined(result);
}

static std::string value(const Words& words) {  // kind, text
  static const std::map<std::string, lcmtools::Value> likes = {
      {"bool", false}, {"int", std::int64_t(0)}, {"float", 0.0}, {"string", std::string()},
      {"bool[]", std::vector<bool>()}, {"int[]", std::vector<std::int64_t>()},
      {"float[]", std::vector<double>()}, {"string[]", std::vector<std::string>()}};
  return lcmtools::detail::write_value(lcmtools::detail::read_value(words[2], likes.at(words[1]), "parameter x"));
}

// Decode bytes, and return the same message encoded again.
template <class Message>
static std::string again(const std::string& hex) {
  lcmtools::wire::Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  Message message;
  if constexpr (std::is_same_v<Message, lcmtools::wire::NodeDetails> ||
                std::is_same_v<Message, lcmtools::wire::Endpoint> ||
                std::is_same_v<Message, lcmtools::wire::CallbackError>) {
    lcmtools::wire::Reader reader{bytes.data(), bytes.data() + bytes.size()};
    reader(message);
    if (!reader.is_good) throw Error("not decoded");
    bytes = lcmtools::wire::encoded(message);
  } else {
    if (message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) throw Error("not decoded");
    bytes = message.packed();
  }
  std::string text;
  for (auto byte : bytes) text += lcmtools::format("%02x", byte);
  return text;
}

static std::string bytes(const Words& words) {  // struct, hexadecimal digits
  namespace wire = lcmtools::wire;
  static const std::map<std::string, std::string (*)(const std::string&)> structs = {
      {"Announcement", again<wire::Announcement>}, {"NodeDetails", again<wire::NodeDetails>},
      {"Endpoint", again<wire::Endpoint>}, {"CallbackError", again<wire::CallbackError>},
      {"Probe", again<wire::Probe>}, {"Shutdown", again<wire::Shutdown>},
      {"ServiceRequest", again<wire::ServiceRequest>}, {"ServiceReply", again<wire::ServiceReply>},
      {"Parameters_Request", again<wire::Parameters_Request>},
      {"Parameters_Response", again<wire::Parameters_Response>}, {"Log", again<wire::Log>},
      {"Clock", again<wire::Clock>}};
  return structs.at(words[1])(words[2]);
}

int main() {
  static const std::map<std::string, std::string (*)(const Words&)> questions = {
      {"resolve", resolve}, {"arguments", arguments}, {"value", value}, {"bytes", bytes}};
  const std::string input{std::istreambuf_iterator<char>(std::cin), {}};
  std::string output;
  for (const auto& line : split(input, '\x1e')) {
    const Words words = split(line, '\x1f');
    try {
      output += "=" + questions.at(words[0])(words) + "\x1e";
    } catch (const Error& error) {
      output += std::string("!") + error.what() + "\x1e";
    }
  }
  std::cout << output;
}
