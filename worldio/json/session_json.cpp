#include "worldio/json/session_json.hpp"

#include "engine/spec/ticks.hpp"
#include "worldio/files.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/json_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

namespace troupe::worldio {
namespace {

using engine::Act;
using OrderedJson = nlohmann::ordered_json;
using Kind = Act::Kind;

constexpr std::string_view k_end = "end";

std::string line_of(const OrderedJson& json) {
  try {
    return json.dump();
  } catch (const OrderedJson::type_error&) {
    throw std::invalid_argument(
        "a name is not UTF-8, which the JSON lines of a session require: write names in UTF-8");
  }
}

OrderedJson pose_json(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

std::uint64_t read_count(JsonObject& object, std::string_view key, std::string_view hint) {
  const JsonNode* node = object.require(key, hint);
  if (!node) return 0;
  const auto* x = std::get_if<std::int64_t>(&node->value);
  if (x && *x >= 0) return static_cast<std::uint64_t>(*x);
  JsonCursor(object.at(), key, *node).expected("a whole number, at least 0");
  return 0;
}

std::uint64_t read_tick(JsonObject& object, std::string_view hint) {
  const std::uint64_t tick = read_count(object, "tick", hint);
  if (tick > engine::k_most_ticks)
    object.at().error(fmt::format("\"tick\" must be at most {}, found {}", engine::k_most_ticks, tick));
  return tick;
}

std::string read_name(JsonObject& object, std::string_view key, std::string_view what) {
  const JsonNode* node = object.require(key, what);
  const std::string* text = node ? read_text(JsonCursor(object.at(), key, *node), what) : nullptr;
  return text ? *text : std::string();
}

void read_numbers(JsonObject& object, std::string_view key, std::string_view what, std::span<double> into) {
  const JsonNode* node = object.require(key, what);
  if (!node) return;
  const JsonNode::List* list = node->list();
  bool is_good = list && list->size() == into.size();
  for (std::size_t i = 0; is_good && i < into.size(); ++i) {
    const std::optional<double> x = real_number_of((*list)[i]);
    is_good = x && std::isfinite(*x);
    if (is_good) into[i] = *x;
  }
  if (!is_good) JsonCursor(object.at(), key, *node).expected(what);
}

void read_pose(JsonObject& object, Act& act) {
  std::array<double, 4> pose{};
  read_numbers(object, "pose", "[x, y, z, heading] in m and rad", pose);
  act.pose = {pose[0], pose[1], pose[2], pose[3]};
}

void read_values(JsonObject& object, Act& act) {
  constexpr std::string_view k_expected =
      "an object with a number or a list of numbers for each field of the command";
  const JsonNode* node = object.require("values", k_expected);
  if (!node) return;
  const JsonCursor at(object.at(), "values", *node);
  if (!node->object() || node->object()->empty()) return at.expected(k_expected);
  for (const JsonMember& member : *node->object()) {
    std::vector<double>& numbers = act.values.emplace_back(member.key, std::vector<double>()).second;
    const auto add = [&](const JsonNode& one) {
      const std::optional<double> x = real_number_of(one);
      const auto* flag = std::get_if<bool>(&one.value);
      if (x && std::isfinite(*x))
        numbers.push_back(*x);
      else if (flag)
        numbers.push_back(*flag ? 1 : 0);
      else
        JsonCursor(at, member.key, one).expected("a number");
    };
    if (const JsonNode::List* list = member.node.list())
      std::ranges::for_each(*list, add);
    else
      add(member.node);
  }
}

/// Reads the new parameters of an act of kind `set`. They are checked against the type when the act is
/// performed.
void read_setting_keys(JsonObject& object, Act& act) {
  JsonNode::Object setting;
  for (const std::string_view key : {"drive", "device", "controller"})
    if (const JsonNode* node = object.find(key)) add_node(setting, key, *node);
  act.setting = json_line(json_node(std::move(setting)));
}

/// Returns the key that names what an act changes.
std::string_view whom_key(Kind kind) {
  return kind == Kind::add ? "population" : kind == Kind::set ? "type" : "robot";
}

/// Reads all keys of an act except `do`.
void read_members(JsonObject& object, Act& act) {
  act.whom = read_name(object, whom_key(act.kind),
                       act.kind == Kind::add   ? "the name of a population"
                       : act.kind == Kind::set ? "the name of a type"
                                               : "the name of a body");
  switch (act.kind) {
    case Kind::move:
    case Kind::add: read_pose(object, act); break;
    case Kind::speed:
    case Kind::hold:
      read_numbers(object, "speed", "[forward, left, turn] in m/s and rad/s", act.speed);
      break;
    case Kind::command:
      act.device = read_name(object, "device", "the name of a device");
      read_values(object, act);
      break;
    case Kind::set: read_setting_keys(object, act); break;
    case Kind::release:
    case Kind::remove:
    case Kind::disable:
    case Kind::enable: break;
  }
}

/// Reads the act named `what`, the value of the key `do`. Empty, with an error, for an unknown act.
std::optional<Act> act_of(JsonObject& object, std::string_view what) {
  const std::vector<std::string_view> known(engine::k_acts.begin(), engine::k_acts.end());
  const auto kind = std::ranges::find(known, what);
  if (kind == known.end()) {
    object.at().error(unknown_name("action", what, known));
    return {};
  }
  Act act{.kind = static_cast<Kind>(kind - known.begin())};
  read_members(object, act);
  return act;
}

std::string read_do(JsonObject& object) { return read_name(object, "do", "the name of an action"); }

SessionHeader read_header(JsonObject& object) {
  SessionHeader header;
  if (const std::uint64_t format = read_count(object, "troupe_session", "the version of the format");
      format != k_session_format && object.is_object())
    object.at().error(fmt::format("unknown version {} of the session format: this program reads version {}",
                                  format, k_session_format));
  header.version = read_name(object, "version", "the version of the program that wrote the session");
  header.tick = read_tick(object, "the tick at which the session began");
  header.hash = read_name(object, "hash", "the hash of the state at the tick at which the session began");
  if (object.find("world_hash"))
    header.world_hash = read_name(object, "world_hash", "the hash of the content of the world");
  if (const JsonNode* node = object.require("options", "the options of the run")) {
    const JsonCursor at(object.at(), "options", *node);
    if (!node->object()) at.expected("an object whose values are texts");
    for (const JsonMember& member : node->object() ? *node->object() : JsonNode::Object())
      if (const std::string* text = member.node.text())
        header.options.emplace_back(member.key, *text);
      else
        JsonCursor(at, member.key, member.node).expected("a text");
  }
  object.finish();
  return header;
}

/// Reads a line after the header, which has an act or the end of the session, and adds it to `session`.
/// line: the number of the line after the header, from 1
void read_line(JsonObject& object, std::uint64_t line, Session& session, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.findings().size();
  LoggedAct logged{.tick = read_tick(object, "the tick at the end of which the action was applied"),
                   .n = read_count(object, "n", "the number of the action, counted from 1"),
                   .where = object.at().where()};
  const std::string what = read_do(object);
  const std::optional<Act> act = what.empty() || what == k_end ? std::nullopt : act_of(object, what);
  if (act || what == k_end) object.finish();  // the keys of an unknown action are unknown
  if (diagnostics.findings().size() > before) return;
  const std::uint64_t last = session.acts.empty() ? session.header.tick : session.acts.back().tick;
  if (session.end)
    object.at().error("no line may follow the line that ends the session: remove this line");
  else if (logged.tick < last)
    object.at().error(fmt::format(
        "tick {} is less than tick {} of an earlier line: actions must be in the order of their ticks",
        logged.tick, last));
  else if (logged.n != line)
    object.at().error(
        fmt::format("\"n\" must be {}, found {}: the lines are numbered 1, 2, 3, ...", line, logged.n));
  else if (what == k_end)
    session.end = logged.tick;
  else if (act) {
    logged.act = *act;
    session.acts.push_back(std::move(logged));
  }
}

}  // namespace

std::string header_line(const SessionHeader& header) {
  OrderedJson json{{"troupe_session", k_session_format},
                   {"version", header.version},
                   {"tick", header.tick},
                   {"hash", header.hash}};
  if (!header.world_hash.empty()) json["world_hash"] = header.world_hash;
  json["options"] = OrderedJson::object();
  for (const auto& [key, value] : header.options) json["options"][key] = value;
  return line_of(json);
}

std::string act_line(std::uint64_t tick, std::uint64_t n, const Act& act) {
  OrderedJson json{{"tick", tick}, {"n", n}, {"do", engine::k_acts[static_cast<std::size_t>(act.kind)]}};
  json[std::string(whom_key(act.kind))] = act.whom;
  if (act.kind == Kind::move || act.kind == Kind::add) json["pose"] = pose_json(act.pose);
  if (act.kind == Kind::speed || act.kind == Kind::hold) json["speed"] = act.speed;
  if (act.kind == Kind::command) {
    json["device"] = act.device;
    json["values"] = OrderedJson::object();
    for (const auto& [name, numbers] : act.values) json["values"][name] = numbers;
  }
  if (act.kind == Kind::set) json.update(OrderedJson::parse(act.setting));
  return line_of(json);
}

std::string end_line(std::uint64_t tick, std::uint64_t n) {
  return line_of(OrderedJson{{"tick", tick}, {"n", n}, {"do", k_end}});
}

std::optional<Act> read_act(std::string_view json, const std::vector<std::string_view>& also, Where where,
                            Diagnostics& diagnostics) {
  const std::optional<JsonNode> document = parse_json(json, where, true, diagnostics);
  if (!document) return {};
  const std::size_t before = diagnostics.findings().size();
  const JsonCursor root(*document, diagnostics);
  JsonObject object(root);
  for (const std::string_view key : also) object.find(key);
  const std::string what = read_do(object);
  std::optional<Act> act = what.empty() ? std::nullopt : act_of(object, what);
  if (act) object.finish();  // the keys of an unknown action are unknown
  return diagnostics.findings().size() > before ? std::nullopt : act;
}

Session load_session(const std::filesystem::path& file) {
  if (const Result<> readable = check_readable(file, k_most_input_bytes); !readable)
    throw InputError(fmt::format("{}: error: {}", file.string(), readable.error().text));
  const std::optional<std::string> text = read_file(file);
  if (!text) throw InputError(fmt::format("{}: error: the file cannot be read", file.string()));
  Diagnostics diagnostics;
  Where where{diagnostics.files()->add(file.string()), 0};
  Session session;
  for (std::size_t begin = 0; begin < text->size();) {
    ++where.line;
    const std::size_t end = text->find('\n', begin);
    if (end == text->npos) {
      if (where.line > 1) {
        session.warnings.push_back(fmt::format("{}:{}: warning: the last line is incomplete and is skipped",
                                               file.string(), where.line));
        break;
      }
    }
    const std::string_view line = std::string_view(*text).substr(begin, end - begin);
    begin = end == text->npos ? text->size() : end + 1;
    const std::optional<JsonNode> document = parse_json(line, where, true, diagnostics);
    if (document) {
      const JsonCursor root(*document, diagnostics);
      JsonObject object(root);
      if (where.line == 1)
        session.header = read_header(object);
      else
        read_line(object, where.line - 1, session, diagnostics);
    }
    if (where.line == 1) diagnostics.throw_if_errors();
  }
  if (where.line == 0) diagnostics.error(where, "the file is empty: a session begins with a header line");
  diagnostics.throw_if_errors();
  return session;
}

}  // namespace troupe::worldio
