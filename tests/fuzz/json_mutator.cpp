#include "tests/fuzz/json_mutator.hpp"

#include "tests/fuzz/draws.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/world_schema.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace troupe::fuzz {
namespace {

using Json = nlohmann::ordered_json;
using Schemas = std::vector<const Json*>;

constexpr int k_most_depth = 64;   // greatest nesting depth of a document
constexpr int k_deepest_made = 6;  // greatest nesting depth of a generated value
constexpr std::size_t k_most_nodes = 20000;

double edge(Random& random) {
  using Limits = std::numeric_limits<double>;
  constexpr std::array k_edges{0.0,
                               -0.0,
                               1.0,
                               -1.0,
                               0.5,
                               2.0,
                               1e-9,
                               1e-6,
                               1e9,
                               1e12,
                               -1e12,
                               1e-300,
                               1e300,
                               1e16,
                               1e-5,
                               2147483647.0,
                               2147483648.0,
                               4294967296.0,
                               3.141592653589793,
                               Limits::max(),
                               Limits::min(),
                               Limits::denorm_min(),
                               Limits::epsilon(),
                               360.0,
                               -180.0};
  return any_of(k_edges, random);
}

Json whole_edge(Random& random) {
  constexpr std::array<std::int64_t, 14> k_edges{
      0,   1,     -1,      2,        3,          7,          100,
      255, 65536, 1000000, 10000000, 2147483647, 2147483648, std::numeric_limits<std::int64_t>::max()};
  if (chance(random, 3)) return Json(std::numeric_limits<std::uint64_t>::max());
  return Json(any_of(k_edges, random));
}

/// A value in a document, the schemas that apply to it, and its place in the document.
struct Node {
  Json* value;
  Schemas schemas;
  Json* parent = nullptr;  ///< the object or list that contains the value; null for the root
  std::string key;         ///< key of the value, if the parent is an object
  std::size_t index = 0;   ///< index of the value, if the parent is a list
};

bool holds(const Json& schema, const char* key) { return schema.is_object() && schema.contains(key); }

/// Parses a text. Returns a discarded value if the text is not JSON or is nested more than k_most_depth
/// levels deep.
Json parsed(std::string_view text) {
  bool too_deep = false;
  const auto callback = [&too_deep](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > k_most_depth;
    return !too_deep;
  };
  Json json = Json::parse(text, callback, false);
  return too_deep ? Json(Json::value_t::discarded) : json;
}

/// Returns the text of a document. Mutated texts in it may be invalid UTF-8; invalid bytes are replaced.
std::string dumped(const Json& json) {
  try {
    return json.dump(1, ' ');
  } catch (const Json::exception&) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace);
  }
}

}  // namespace

struct JsonMutator::Impl {
  Json schema;
  std::vector<std::pair<std::string, const Json*>> properties;  // all keys, with the schemas of their values
  std::vector<std::string> texts;                               // the texts in `const` and `enum`

  void collect(const Json& node) {
    if (node.is_array())
      for (const Json& one : node) collect(one);
    if (!node.is_object()) return;
    if (holds(node, "properties"))
      for (const auto& [key, value] : node["properties"].items()) properties.emplace_back(key, &value);
    if (holds(node, "const") && node["const"].is_string()) texts.push_back(node["const"]);
    if (holds(node, "enum"))
      for (const Json& one : node["enum"])
        if (one.is_string()) texts.push_back(one);
    for (const auto& [key, value] : node.items()) collect(value);
  }

  /// Adds to `found` the alternatives of a schema (`anyOf`, `oneOf`, `allOf`), with references resolved.
  void expand(const Json& node, Schemas& found, int depth = 0) const {
    if (depth > 20 || !node.is_object() || found.size() > 200) return;
    if (holds(node, "$ref")) {
      const auto target = Json::json_pointer(node["$ref"].get<std::string>().substr(1));
      if (schema.contains(target)) expand(schema[target], found, depth + 1);
    }
    for (const char* list : {"anyOf", "oneOf", "allOf"})
      if (holds(node, list))
        for (const Json& one : node[list]) expand(one, found, depth + 1);
    if (holds(node, "type") || holds(node, "const") || holds(node, "enum") || holds(node, "properties"))
      found.push_back(&node);
  }
  Schemas expanded(const Json& node) const {
    Schemas found;
    expand(node, found);
    return found;
  }

  /// Returns those of the schemas whose "kind" equals that of the value; all schemas if the value has no
  /// "kind" or if no schema has the same one.
  static Schemas fitting(const Json& value, const Schemas& schemas) {
    if (!value.is_object() || !value.contains("kind")) return schemas;
    Schemas fit;
    std::ranges::copy_if(schemas, std::back_inserter(fit), [&](const Json* one) {
      return holds(*one, "properties") && holds((*one)["properties"], "kind") &&
             (*one)["properties"]["kind"].value("const", Json()) == value["kind"];
    });
    return fit.empty() ? schemas : fit;
  }

  void walk(Node node, std::vector<Node>& all) const {
    if (all.size() >= k_most_nodes) return;
    all.push_back(node);
    Json& value = *node.value;
    const Schemas schemas = fitting(value, node.schemas);
    if (value.is_object())
      for (auto& [key, child] : value.items()) {
        Node next{&child, {}, &value, key};
        for (const Json* one : schemas) {
          if (holds(*one, "properties") && holds((*one)["properties"], key.c_str()))
            expand((*one)["properties"][key], next.schemas);
          else if (holds(*one, "additionalProperties"))
            expand((*one)["additionalProperties"], next.schemas);
        }
        walk(std::move(next), all);
      }
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) {
        Node next{&value[i], {}, &value, {}, i};
        for (const Json* one : schemas)
          if (holds(*one, "items")) expand((*one)["items"], next.schemas);
        walk(std::move(next), all);
      }
  }

  std::vector<Node> nodes_of(Json& document) const {
    std::vector<Node> all;
    walk({&document, expanded(schema)}, all);
    return all;
  }

  Json made_number(const Json& one, bool whole, Random& random) const {
    if (holds(one, "default") && chance(random, 20)) return one["default"];
    const double low = one.value("minimum", one.value("exclusiveMinimum", -1e3));
    const double high = std::min(one.value("maximum", low + 1e3), std::max(low + 10, 10.0));
    if (chance(random, 25)) {
      // At a limit, or just beyond it.
      const double limit = chance(random, 50) ? low : one.value("maximum", high);
      const double beyond = std::nextafter(limit, chance(random, 50) ? -1e308 : 1e308);
      const double x = chance(random, 50) ? limit : beyond;
      if (whole && std::abs(limit) < 9e15)
        return static_cast<std::int64_t>(limit) + static_cast<std::int64_t>(below(random, 3)) - 1;
      return x;
    }
    if (chance(random, 10)) return whole ? whole_edge(random) : Json(edge(random));
    const double share = static_cast<double>(random()) / static_cast<double>(Random::max());
    const double x = low + share * (high - low);
    if (whole) return static_cast<std::int64_t>(std::clamp(x, -9e15, 9e15));
    return x;
  }

  Json made_object(const Json& one, Random& random, int depth) const {
    Json made = Json::object();
    if (!holds(one, "properties")) {
      if (holds(one, "additionalProperties") && one["additionalProperties"].is_object())
        made["made"] = made_of(one["additionalProperties"], random, depth + 1);
      return made;
    }
    const Json& known = one["properties"];
    const auto add = [&](const std::string& key) {
      if (known.contains(key)) made[key] = made_of(known[key], random, depth + 1);
    };
    if (holds(one, "required"))
      for (const Json& key : one["required"]) add(key);
    // A quantity has one key per unit; exactly one of these keys must be given.
    if (holds(one, "allOf"))
      for (const Json& rule : one["allOf"]) {
        if (!holds(rule, "oneOf")) continue;
        const Json& way = any_of(rule["oneOf"], random);
        if (holds(way, "required"))
          for (const Json& key : way["required"]) add(key);
      }
    for (std::size_t i = below(random, 4); i > 0 && !known.empty(); --i)
      add(std::next(known.begin(), static_cast<std::ptrdiff_t>(below(random, known.size()))).key());
    return made;
  }

  /// Returns a random value that fits a schema, or nearly fits it.
  Json made_of(const Json& node, Random& random, int depth) const {
    const Schemas ways = expanded(node);
    if (ways.empty() || depth > k_deepest_made) return Json(whole_edge(random));
    const Json& one = *any_of(ways, random);
    if (holds(one, "const")) return one["const"];
    if (holds(one, "enum")) return any_of(one["enum"], random);
    const std::string type =
        holds(one, "type") && one["type"].is_string() ? one["type"].get<std::string>() : "object";
    if (type == "boolean") return chance(random, 50);
    if (type == "integer") return made_number(one, true, random);
    if (type == "number") return made_number(one, false, random);
    if (type == "string") return made_text(random);
    if (type == "array") {
      Json list = Json::array();
      const std::size_t least = one.value("minItems", 0u);
      const std::size_t most = std::min<std::size_t>(one.value("maxItems", 1000000u), least + 3);
      const std::size_t count = least + below(random, most - least + 1);
      for (std::size_t i = 0; i < count && holds(one, "items"); ++i)
        list.push_back(made_of(one["items"], random, depth + 1));
      return list;
    }
    return made_object(one, random, depth);
  }

  std::string made_text(Random& random) const {
    constexpr std::array k_texts{"",    "r", "cave.png", "red",   "random", "coverage >= 0.5",
                                 "a/b", "~", "../x",     "\u20ac"};
    return texts.empty() || chance(random, 50) ? any_of(k_texts, random) : any_of(texts, random);
  }

  /// Inserts or replaces a member of a random object: mostly a member that the schema allows in this object,
  /// sometimes one that it allows only elsewhere.
  void insert(Json& document, Random& random) const {
    std::vector<Node> all = nodes_of(document);
    std::erase_if(all, [](const Node& node) { return !node.value->is_object(); });
    if (all.empty()) return;
    const Node& node = any_of(all, random);
    Schemas known;
    for (const Json* one : fitting(*node.value, node.schemas))
      if (holds(*one, "properties") && !(*one)["properties"].empty()) known.push_back(one);
    if (known.empty() || chance(random, 10)) {
      const auto& [key, schema_of_key] = any_of(properties, random);
      (*node.value)[key] = made_of(*schema_of_key, random, 0);
      return;
    }
    const Json& from = (*any_of(known, random))["properties"];
    const auto member = std::next(from.begin(), static_cast<std::ptrdiff_t>(below(random, from.size())));
    (*node.value)[member.key()] = made_of(member.value(), random, 0);
  }

  void generate(Json& document, Random& random) const {
    std::vector<Node> all = nodes_of(document);
    std::erase_if(all, [](const Node& node) { return node.schemas.empty() || !node.parent; });
    if (all.empty()) return;
    const Node& node = any_of(all, random);
    *node.value = made_of(*any_of(node.schemas, random), random, 0);
  }

  void change_number(Json& document, Random& random) const {
    std::vector<Node> all = nodes_of(document);
    std::erase_if(all, [](const Node& node) { return !node.value->is_number(); });
    if (all.empty()) return;
    Json& value = *any_of(all, random).value;
    const double x = value.get<double>();
    switch (below(random, 8)) {
      case 0: value = edge(random); break;
      case 1: value = whole_edge(random); break;
      case 2: value = -x; break;
      case 3: value = x * 2; break;
      case 4: value = x / 3; break;
      case 5: value = x + 1; break;
      case 6: value = std::nextafter(x, chance(random, 50) ? -1e308 : 1e308); break;
      default: value = std::abs(x) < 9e15 ? Json(static_cast<std::int64_t>(x) + 1) : Json(0);
    }
    if (value.is_number_float() && !std::isfinite(value.get<double>())) value = edge(random);
  }

  void remove(Json& document, Random& random) const {
    std::vector<Node> all = nodes_of(document);
    const Node& node = any_of(all, random);
    if (!node.parent) return;
    if (node.parent->is_object())
      node.parent->erase(node.key);
    else
      node.parent->erase(node.index);
  }

  void duplicate(Json& document, Random& random) const {
    std::vector<Node> all = nodes_of(document);
    std::erase_if(all, [](const Node& node) { return !node.parent; });
    if (all.empty()) return;
    const Node& node = any_of(all, random);
    const Json copy = *node.value;
    if (node.parent->is_array()) {
      for (std::size_t i = 1 + below(random, chance(random, 10) ? 20 : 2); i > 0; --i)
        node.parent->push_back(copy);
    } else {
      (*node.parent)[chance(random, 50) ? any_of(properties, random).first : node.key + "2"] = copy;
    }
  }

  void swap(Json& document, Random& random) const {
    std::vector<Node> all = nodes_of(document);
    const Node& a = any_of(all, random);
    const Node& b = any_of(all, random);
    const Json copy_a = *a.value;
    const Json copy_b = *b.value;
    if (!a.parent || !b.parent) return;
    // If `a` was a part of `b`, it no longer exists: look for it again.
    *b.value = copy_a;
    if (chance(random, 50)) return;  // only copy `a` to the place of `b`
    std::vector<Node> now = nodes_of(document);
    const auto found = std::ranges::find(now, a.value, &Node::value);
    if (found != now.end()) *found->value = copy_b;
  }

  void change_text(Json& document, Random& random, const MutateText& mutate_text) const {
    std::vector<Node> all = nodes_of(document);
    std::erase_if(all, [](const Node& node) { return !node.value->is_string(); });
    if (all.empty()) return;
    Json& value = *any_of(all, random).value;
    if (mutate_text && chance(random, 40)) {
      std::string text = value;
      mutate_text(text);
      value = text;
    } else {
      // Documents contain references by name, so another text of the document may be a valid reference.
      value = chance(random, 50) ? std::string(*any_of(all, random).value) : made_text(random);
    }
  }
};

JsonMutator::JsonMutator(std::string_view schema) : impl_(std::make_unique<Impl>()) {
  impl_->schema = Json::parse(schema);
  impl_->collect(impl_->schema);
  std::ranges::sort(impl_->texts);
  impl_->texts.erase(std::unique(impl_->texts.begin(), impl_->texts.end()), impl_->texts.end());
}
JsonMutator::~JsonMutator() = default;

std::string JsonMutator::mutate(std::string_view text, std::uint32_t seed,
                                const MutateText& mutate_text) const {
  Json document = parsed(text);
  if (document.is_discarded()) return {};
  Random random(seed);
  random.discard(3);  // with nearly equal seeds, the first numbers are nearly equal
  for (std::size_t times = 1 + below(random, 3); times > 0; --times) switch (below(random, 9)) {
      case 0:
      case 1:
      case 2: impl_->insert(document, random); break;
      case 3: impl_->generate(document, random); break;
      case 4: impl_->change_number(document, random); break;
      case 5: impl_->remove(document, random); break;
      case 6: impl_->duplicate(document, random); break;
      case 7: impl_->swap(document, random); break;
      default: impl_->change_text(document, random, mutate_text);
    }
  return dumped(document);
}

std::string JsonMutator::cross(std::string_view first, std::string_view second, std::uint32_t seed) const {
  Json document = parsed(first);
  Json other = parsed(second);
  if (document.is_discarded() || other.is_discarded()) return {};
  Random random(seed);
  random.discard(3);
  std::vector<Node> from = impl_->nodes_of(other);
  std::vector<Node> to = impl_->nodes_of(document);
  const Node& taken = any_of(from, random);
  std::vector<Node> alike;
  std::ranges::copy_if(to, std::back_inserter(alike),
                       [&](const Node& node) { return !node.key.empty() && node.key == taken.key; });
  *any_of(alike.empty() ? to : alike, random).value = *taken.value;
  return dumped(document);
}

std::vector<std::string> JsonMutator::keys() const {
  std::set<std::string> keys;
  for (const auto& [key, schema] : impl_->properties) keys.insert(key);
  return {keys.begin(), keys.end()};
}

std::vector<std::string> JsonMutator::words() const { return impl_->texts; }

const JsonMutator& world_mutator() {
  static const JsonMutator mutator(worldio::world_schema(make_registry()));
  return mutator;
}

const JsonMutator& study_mutator() {
  static const JsonMutator mutator([] {
    const Json world = Json::parse(worldio::world_schema(make_registry()));
    Json study = Json::parse(R"({"type": "object", "required": ["troupe_study", "world"], "properties": {
      "troupe_study": {"const": 1}, "world": {"enum": ["study_room.json"]},
      "for_s": {"type": "number", "minimum": 0, "maximum": 1e12},
      "for_ms": {"type": "number", "minimum": 0, "maximum": 1e15},
      "seeds": {"oneOf": [{"type": "array", "items": {"type": "integer", "minimum": 0, "maximum": 9007199254740991}},
        {"type": "object", "required": ["from", "count"], "properties": {
          "from": {"type": "integer", "minimum": 0, "maximum": 9007199254740991},
          "count": {"type": "integer", "minimum": 1, "maximum": 1000000}}}]},
      "samples": {"type": "integer", "minimum": 1, "maximum": 1000000},
      "random_seed": {"type": "integer", "minimum": 0, "maximum": 2147483647},
      "measure_every_s": {"type": "number", "minimum": 0, "maximum": 1e9},
      "statistics": {"type": "array", "items": {"enum": ["last", "mean", "min", "max"]}},
      "parameters": {"type": "array", "items": {"type": "object", "required": ["set"], "properties": {
        "set": {"enum": ["/populations/0/count", "/types/bot/drive/velocity_max_x_mps", "/tick_s", "/seed", "/populations/0",
          "/populations/0/name", "/types/bot/size_m/0", "/models/-", "/quit_time_s", "/types/bot", "/"]},
        "name": {"type": "string"}, "with": {"type": "string"},
        "values": {"type": "array", "minItems": 1, "items": {"anyOf": [{"type": "number"}, {"type": "integer"},
          {"type": "string"}, {"type": "boolean"}]}},
        "from": {"type": "number"}, "to": {"type": "number"}, "steps": {"type": "integer", "minimum": 2, "maximum": 1000000},
        "uniform": {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number"}},
        "log_uniform": {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number", "minimum": 0}},
        "integers": {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "integer", "minimum": -9}}}}}}})");
    study["properties"]["measures"] = world["properties"]["measures"];
    study["definitions"] = world["definitions"];
    return study.dump();
  }());
  return mutator;
}

}  // namespace troupe::fuzz
