#include "worldio/json/study.hpp"

#include "base/fp_environment.hpp"
#include "base/math.hpp"
#include "base/number_text.hpp"
#include "base/random.hpp"
#include "base/split.hpp"
#include "engine/fields/description.hpp"
#include "engine/spec/ticks.hpp"
#include "worldio/files.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/measures_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldType;
using engine::Unit;
using engine::Value;

constexpr std::int64_t k_study_version = 1;
constexpr std::array<std::string_view, 4> k_statistics{"last", "mean", "min", "max"};
/// The columns that the tables of every study have.
constexpr std::array<std::string_view, 7> k_own_columns{"run",        "seed",       "ticks", "time_s",
                                                        "stopped_by", "state_hash", "error"};

const Field k_for{.name = "for", .unit = Unit::seconds, .min = 0, .max = engine::k_longest_run_s};
const Field k_measure_every{
    .name = "measure_every", .unit = Unit::seconds, .min = 0, .max = engine::k_most_seconds};
const Field k_random_seed{.name = "random_seed",
                          .type = FieldType::integer,
                          .min = 0,
                          .max = static_cast<double>(std::numeric_limits<std::int32_t>::max())};

const Field k_series{.name = "series", .type = FieldType::boolean, .fallback = false};

Field whole(std::string_view name, double min, double max, std::string_view about) {
  return {.name = name, .type = FieldType::integer, .min = min, .max = max, .text = about};
}

/// Equally spaced values from `from` to `to`, including both.
struct Steps {
  double from = 0;
  double to = 0;
  std::int64_t steps = 2;

  static constexpr void describe(engine::Description<Steps>& d) {
    using namespace engine::facts;
    d.member<&Steps::from>("from", required, "the first of the equally spaced values");
    d.member<&Steps::to>("to", required, "the last of the equally spaced values");
    d.member<&Steps::steps>("steps", within(2, k_most_runs), required,
                            "number of equally spaced values, including the first and the last");
  }
};

constexpr double k_most_seed = 9007199254740991;  // 2^53 - 1

struct SeedRange {
  std::int64_t from = 0;
  std::int64_t count = 1;

  static constexpr void describe(engine::Description<SeedRange>& d) {
    using namespace engine::facts;
    d.member<&SeedRange::from>("from", within(0, k_most_seed), required, "the first seed");
    d.member<&SeedRange::count>("count", within(1, k_most_runs), required, "number of consecutive seeds");
  }
};

/// Reads all fields of a struct T from the keys of an object. Empty, with errors, if a field is missing or
/// wrong.
template <class T>
std::optional<T> read_all(JsonObject& object) {
  const engine::Record record = read_fields(object, engine::described<T>());
  if (!std::ranges::all_of(record, &Value::given)) return std::nullopt;
  return engine::from_record<T>(record);
}

/// Returns a value as the JSON text that --set reads back as this value.
std::string option_text(const JsonNode& node) {
  std::string text = json_text(node);
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

std::string option_text(double value) { return option_text(json_node(value)); }

/// Returns a text that is the same for equal values: 100000 and 1e5 are equal.
std::string text_of_equals(const JsonNode& node) {
  const auto* number = std::get_if<double>(&node.value);
  return number && *number == std::trunc(*number) ? fmt::format("{:.0f}", *number) : option_text(node);
}

/// The error for an entry of a list of seeds, values or statistics that the list already contains.
constexpr std::string_view k_twice = "the list already contains this entry: remove one of the two";

using Choice = Study::Choice;
using ChoiceKind = Choice::Kind;

/// Returns a random value of a parameter.
std::string drawn(const Choice& choice, Random& random) {
  switch (choice.kind) {
    case ChoiceKind::listed:
    case ChoiceKind::steps: return choice.value(random.below(static_cast<std::uint32_t>(choice.count())));
    case ChoiceKind::uniform: return option_text(random.uniform(choice.low, choice.high));
    case ChoiceKind::log_uniform:
      return option_text(
          std::clamp(exp(random.uniform(log(choice.low), log(choice.high))), choice.low, choice.high));
    case ChoiceKind::integers: break;
  }
  const auto first = static_cast<std::int64_t>(choice.low);
  const auto count = static_cast<std::uint32_t>(static_cast<std::int64_t>(choice.high) - first + 1);
  return option_text(json_node(first + std::int64_t{random.below(count)}));
}

class StudyReader {
 public:
  /// world: the text of the world; null: the study names a file
  StudyReader(const std::filesystem::path& file, const engine::Registry& registry, const std::string* world)
      : file_(file), registry_(registry), world_(world) {}

  Study read(const JsonNode& document, Diagnostics& diagnostics) {
    const JsonCursor root(document, diagnostics);
    study_.where = {document.where.file, 0};
    if (const JsonNode* world = document.find("troupe"); world && !document.find("troupe_study")) {
      diagnostics.error(world->where,
                        "this is a world, not a study: a study names it with the key \"world\"");
      return std::move(study_);
    }
    report_nul(root);
    JsonObject object(root);
    read_version(object);
    if (const JsonNode* node = object.find("$schema"))
      read_text(JsonCursor(root, "$schema", *node), "the path of the JSON Schema");
    if (const JsonNode* node = object.require("world", "the path of a world file, relative to this file"))
      if (const std::string* world =
              read_text(JsonCursor(root, "world", *node), "the path of a world file")) {
        study_.world = file_.parent_path() / *world;
        study_.where_world = node->where;
      }
    if (const Value end = read_field(object, k_for); end.given()) study_.for_s = end.number();
    // Before the parameters: a list of values may contain equal values only if the study has samples.
    if (const Value samples = read_field(object, whole("samples", 1, k_most_runs, "")); samples.given())
      study_.samples = static_cast<std::size_t>(samples.integer());
    each(object, "parameters", [&](const JsonCursor& at) { read_parameter(at); });
    check_combinations(root);
    read_seeds(object);
    read_measures(object);
    if (const Value seed = read_field(object, k_random_seed); seed.given())
      study_.random_seed = static_cast<std::uint64_t>(seed.integer());
    if (const Value series = read_field(object, k_series); series.given()) study_.series = series.boolean();
    object.finish();
    check_effects(root);
    if (!diagnostics.has_errors()) check_runs(root);
    return std::move(study_);
  }

 private:
  template <class Read>
  void each(JsonObject& object, std::string_view key, Read read) {
    const JsonNode* node = object.find(key);
    if (!node) return;
    const JsonCursor cursor(object.at(), key, *node);
    const JsonNode::List* list = read_list(cursor);
    for (std::size_t i = 0; list && i < list->size(); ++i) read(JsonCursor(cursor, i, (*list)[i]));
  }

  static void read_version(JsonObject& object) {
    const JsonNode* node =
        object.require("troupe_study", fmt::format("the version of the format, {}", k_study_version));
    const auto* version = node ? std::get_if<std::int64_t>(&node->value) : nullptr;
    if (node && (!version || *version != k_study_version))
      JsonCursor(object.at(), "troupe_study", *node)
          .expected(fmt::format("the version of the format, {}", k_study_version));
  }

  void read_parameter(const JsonCursor& at);
  std::optional<std::size_t> read_with(const JsonCursor& at, const Choice& choice) const;
  void check_combinations(const JsonCursor& root) const;
  Choice read_choice(JsonObject& object) const;
  static Choice read_list_of_values(const JsonCursor& at);
  Choice read_steps(JsonObject& object) const;
  static Choice read_interval(const JsonCursor& at, ChoiceKind kind);
  void read_seeds(JsonObject& object);
  void read_measures(JsonObject& object);
  /// Returns the names of the measures of the world. Empty if they are not known because the world cannot be
  /// read or is no valid JSON, which is reported when the world is loaded.
  std::optional<std::set<std::string>> measures_of_world() const;
  void check_effects(const JsonCursor& at) const;
  void check_runs(const JsonCursor& at);

  const std::filesystem::path& file_;
  const engine::Registry& registry_;
  const std::string* world_;
  Study study_;
};

void StudyReader::read_parameter(const JsonCursor& at) {
  JsonObject object(at);
  Study::Parameter parameter{.where = at.node().where};
  const std::string_view k_what = "a JSON pointer into the world, as in \"/populations/0/count\"";
  if (const JsonNode* node = object.require("set", k_what)) {
    const JsonCursor cursor(at, "set", *node);
    const std::string* pointer = read_text(cursor, k_what);
    if (pointer && pointer->starts_with('/'))
      parameter.pointer = *pointer;
    else if (pointer)
      cursor.expected(k_what);
  }
  parameter.name = parameter.pointer.empty() ? "" : parameter.pointer.substr(1);
  std::ranges::replace(parameter.name, '/', '.');
  if (const JsonNode* node = object.find("name"))
    if (const std::string* name = read_text(JsonCursor(at, "name", *node), "the name of the column"))
      parameter.name = *name;
  const auto& before = study_.parameters;
  if (!parameter.name.empty() &&
      (std::ranges::find(before, parameter.name, &Study::Parameter::name) != before.end() ||
       std::ranges::find(k_own_columns, parameter.name) != k_own_columns.end()))
    at.error(
        fmt::format("the table of results already has a column \"{}\": give this parameter another \"name\"",
                    parameter.name));
  Choice choice = read_choice(object);
  if (const JsonNode* node = object.find("with"))
    parameter.with = read_with(JsonCursor(at, "with", *node), choice);
  object.finish();
  study_.choices.push_back(std::move(choice));
  study_.parameters.push_back(std::move(parameter));
}

/// Returns the index of the parameter with which a parameter varies together. at: the name of the other one;
/// choice: the values of the parameter. Empty, with an error, if they cannot vary together.
std::optional<std::size_t> StudyReader::read_with(const JsonCursor& at, const Choice& choice) const {
  const std::string* name = read_text(at, "the name of an earlier parameter");
  if (!name) return std::nullopt;
  const auto& before = study_.parameters;
  const auto found = std::ranges::find(before, *name, &Study::Parameter::name);
  if (found == before.end()) {
    at.error(unknown_name("earlier parameter", *name, name_list(before)));
    return std::nullopt;
  }
  const auto leader = study_.leader_of(static_cast<std::size_t>(found - before.begin()));
  const Choice& other = study_.choices[leader];
  const auto is_random = [](const Choice& one) {
    return one.kind != ChoiceKind::listed && one.kind != ChoiceKind::steps;
  };
  if (is_random(choice) || is_random(other)) {
    at.error(
        fmt::format("values that vary together are at the same position of two lists: instead of random "
                    "numbers, give {} \"values\", or \"from\", \"to\" and \"steps\"",
                    is_random(choice) ? "this parameter" : fmt::format("\"{}\"", before[leader].name)));
    return std::nullopt;
  }
  // A list that was reported has no values.
  if (choice.count() > 0 && other.count() > 0 && choice.count() != other.count())
    at.error(fmt::format("the number of values is {}, but \"{}\" has {}: give both the same number of values",
                         choice.count(), before[leader].name, other.count()));
  return leader;
}

/// Reports combinations of values that a study without samples has twice, so that their runs would be equal.
void StudyReader::check_combinations(const JsonCursor& root) const {
  const JsonNode* node = root.node().find("parameters");
  if (!node || study_.samples || has_error_in(root.diagnostics(), "/parameters")) return;
  const JsonCursor all(root, "parameters", *node);
  // For each parameter that varies independently: its list, followed by those of the parameters that vary
  // with it, and whether one of them is equally spaced, so that all combinations differ.
  std::vector<std::vector<const JsonNode::List*>> lists(study_.choices.size());
  std::vector<bool> has_steps(study_.choices.size(), false);
  for (std::size_t p = 0; p < study_.choices.size(); ++p)
    if (study_.choices[p].kind == ChoiceKind::listed)
      lists[study_.leader_of(p)].push_back((*node->list())[p].find("values")->list());
    else if (study_.choices[p].low != study_.choices[p].high)
      has_steps[study_.leader_of(p)] = true;
  for (std::size_t p = 0; p < lists.size(); ++p) {
    std::set<std::string> known;
    for (std::size_t i = 0; !has_steps[p] && !lists[p].empty() && i < lists[p].front()->size(); ++i) {
      std::string texts;
      for (const JsonNode::List* list : lists[p]) texts.append(text_of_equals((*list)[i])).append(1, '\n');
      if (known.insert(std::move(texts)).second) continue;
      const JsonCursor parameter(all, p, (*node->list())[p]);
      const JsonCursor values(parameter, "values", *parameter.node().find("values"));
      JsonCursor(values, i, (*lists[p].front())[i])
          .error(lists[p].size() == 1 ? std::string(k_twice)
                                      : "the lists that vary together already contain this combination of "
                                        "values: remove one of the two");
    }
  }
}

Choice StudyReader::read_choice(JsonObject& object) const {
  constexpr std::array<std::string_view, 5> k_ways{"values", "steps", "uniform", "log_uniform", "integers"};
  std::string_view way;
  for (const std::string_view one : k_ways) {
    if (!object.find(one)) continue;
    if (!way.empty()) object.at().error(fmt::format("give \"{}\" or \"{}\", not both", way, one));
    way = one;
  }
  if (way.empty() && (object.find("from") || object.find("to"))) return read_steps(object);
  if (way.empty()) {
    object.missing("values",
                   "a list of values; or \"from\", \"to\" and \"steps\"; or, with \"samples\", \"uniform\", "
                   "\"log_uniform\" or \"integers\"");
    return {};
  }
  const JsonCursor at(object.at(), way, *object.find(way));
  if (way == "values") return read_list_of_values(at);
  if (way == "steps") return read_steps(object);
  return read_interval(at, way == "uniform"       ? ChoiceKind::uniform
                           : way == "log_uniform" ? ChoiceKind::log_uniform
                                                  : ChoiceKind::integers);
}

Choice StudyReader::read_list_of_values(const JsonCursor& at) {
  Choice choice;
  const JsonNode::List* list = read_list(at);
  if (list && (list->empty() || list->size() > k_most_runs))
    at.error(fmt::format("expected a list of 1 to {} values, found {}", k_most_runs, list->size()));
  else if (list)
    for (const JsonNode& value : *list) choice.values.push_back(option_text(value));
  return choice;
}

Choice StudyReader::read_steps(JsonObject& object) const {
  Choice choice;
  const std::optional<Steps> given = read_all<Steps>(object);
  if (!given) return choice;
  choice.kind = ChoiceKind::steps;
  choice.low = given->from;
  choice.high = given->to;
  choice.steps = static_cast<std::size_t>(given->steps);
  if (!std::isfinite(choice.high - choice.low))
    object.at().error(
        "\"from\" and \"to\" differ by more than 1.8e308, the largest number that can be represented");
  else if (choice.low == choice.high && !study_.samples && !object.find("with"))
    object.at().error(fmt::format(
        "\"from\" and \"to\" are both {}, so {} runs would be equal: give different numbers, or one number "
        "as \"values\"",
        plain_number(choice.low), choice.steps));
  return choice;
}

Choice StudyReader::read_interval(const JsonCursor& at, ChoiceKind kind) {
  constexpr double k_most = 2147483647;  // maximum difference of the integers
  Choice choice{.kind = kind};
  const Value limits = read_value(at, {.name = "interval", .type = FieldType::numbers, .columns = 2});
  if (!limits.given()) return choice;
  choice.low = limits.numbers()[0];
  choice.high = limits.numbers()[1];
  const auto is_whole = [](double x) { return x == static_cast<double>(static_cast<std::int64_t>(x)); };
  constexpr double k_exact = 9e15;
  if (!(choice.low < choice.high))
    at.error(fmt::format("the first number must be below the second, found {} and {}",
                         exact_number(choice.low), exact_number(choice.high)));
  else if (!std::isfinite(choice.high - choice.low))
    at.error("the numbers differ by more than 1.8e308, the largest number that can be represented");
  else if (kind == ChoiceKind::log_uniform && choice.low <= 0)
    at.error(fmt::format("both numbers must be above 0, found {} and {}", exact_number(choice.low),
                         exact_number(choice.high)));
  else if (kind == ChoiceKind::integers &&
           (std::max(-choice.low, choice.high) > k_exact || !is_whole(choice.low) || !is_whole(choice.high) ||
            choice.high - choice.low > k_most))
    at.error(fmt::format(
        "expected two whole numbers from -9e15 to 9e15 that differ by at most 2^31 - 1, found {} and {}",
        exact_number(choice.low), exact_number(choice.high)));
  return choice;
}

void StudyReader::read_seeds(JsonObject& object) {
  const JsonNode* node = object.find("seeds");
  if (!node) return;
  const JsonCursor at(object.at(), "seeds", *node);
  if (node->list()) {
    std::set<std::int64_t> known;
    for (std::size_t i = 0; i < node->list()->size(); ++i) {
      const JsonCursor entry(at, i, (*node->list())[i]);
      const Value seed = read_value(entry, whole("seed", 0, k_most_seed, ""));
      if (!seed.given()) continue;
      if (!known.insert(seed.integer()).second) entry.error(std::string(k_twice));
      study_.seeds.push_back(static_cast<std::uint64_t>(seed.integer()));
    }
    if (node->list()->empty()) at.expected("at least one seed");
    return;
  }
  if (!node->object()) return at.expected("a list of seeds, or {\"from\": 1, \"count\": 8}");
  JsonObject range(at);
  const std::optional<SeedRange> seeds = read_all<SeedRange>(range);
  range.finish();
  if (!seeds) return;
  constexpr auto k_last = static_cast<std::int64_t>(k_most_seed);
  if (const std::int64_t last = seeds->from + seeds->count - 1; last > k_last)
    return at.error(fmt::format(
        "the last seed would be {}, but the largest seed is {}: reduce \"from\" or \"count\"", last, k_last));
  for (std::int64_t i = 0; i < seeds->count; ++i)
    study_.seeds.push_back(static_cast<std::uint64_t>(seeds->from + i));
}

std::optional<std::set<std::string>> StudyReader::measures_of_world() const {
  std::set<std::string> names;
  if (study_.world.extension() == ".world") return names;  // Stage's syntax has no measures
  std::optional<std::string> text;
  if (world_ != nullptr)
    text = *world_;
  else if (check_readable(study_.world, k_most_input_bytes))
    text = read_file(study_.world);
  Diagnostics ignored;
  const std::optional<JsonNode> document = text ? parse_json(*text, {}, true, ignored) : std::nullopt;
  if (!document) return std::nullopt;
  const JsonNode* measures = document->find("measures");
  if (measures && measures->list())
    for (const JsonNode& entry : *measures->list())
      if (const JsonNode* name = entry.find("name"); name && name->text()) names.insert(*name->text());
  return names;
}

void StudyReader::read_measures(JsonObject& object) {
  const auto not_empty = [&](std::string_view key, std::string_view otherwise) {
    if (const JsonNode* node = object.find(key)) refuse_empty(JsonCursor(object.at(), key, *node), otherwise);
  };
  not_empty("measures", "the measures of the world");
  not_empty("statistics", "the last values");
  std::optional<std::set<std::string>> names;  // of the measures of the world, which is read only if needed
  bool has_looked = false;
  each(object, "measures", [&](const JsonCursor& at) {
    const std::string* text = at.node().text();
    bool is_of_world = text && !registry_.find_measure(text->substr(0, text->find(':')));
    if (is_of_world && !study_.world.empty()) {
      if (!std::exchange(has_looked, true)) names = measures_of_world();
      is_of_world = !names || names->contains(*text);
    }
    if (!is_of_world && text && names)
      if (const std::string error = misspelled_measure(*text, {names->begin(), names->end()}, registry_);
          !error.empty())
        return at.error(error);
    if (!is_of_world && !read_measure(at, registry_)) return;
    study_.measures.push_back(at.node().text() ? *at.node().text() : option_text(at.node()));
    study_.where_measures.push_back(at.where());
  });
  each(object, "statistics", [&](const JsonCursor& at) {
    const Value name = read_value(at, {.name = "statistic",
                                       .type = FieldType::text,
                                       .choices = {k_statistics.begin(), k_statistics.end()}});
    if (!name.given()) return;
    const auto statistic =
        static_cast<Statistic>(std::ranges::find(k_statistics, name.text()) - k_statistics.begin());
    if (std::ranges::find(study_.statistics, statistic) != study_.statistics.end())
      at.error(std::string(k_twice));
    study_.statistics.push_back(statistic);
  });
  if (study_.statistics.empty()) study_.statistics.push_back(Statistic::last);
  if (const Value every = read_field(object, k_measure_every); every.given())
    study_.measure_every_s = every.number();
}

/// Whether two tokens of JSON pointers mean the same key or index. Indices of lists are compared as numbers,
/// because `--set` takes 00 as 0.
bool same_token(std::string_view a, std::string_view b) {
  if (a == b) return true;
  const auto is_index = [](std::string_view token) {
    return !token.empty() && token.find_first_not_of("0123456789") == token.npos;
  };
  const auto digits = [](std::string_view index) {
    return index.substr(std::min(index.find_first_not_of('0'), index.size()));
  };
  return is_index(a) && is_index(b) && digits(a) == digits(b);
}

using Tokens = std::vector<std::string>;  // of a JSON pointer; empty for a malformed pointer

/// Whether setting the value at the JSON pointer `later` replaces the value at `earlier`, because both are
/// the same place or `later` contains `earlier`.
bool overwrites(const Tokens& later, const Tokens& earlier) {
  return !later.empty() && later.back() != "-" && later.size() <= earlier.size() &&
         std::equal(later.begin(), later.end(), earlier.begin(), same_token);
}

/// Reports parameters whose values cannot change any run, because another parameter, `seeds` or `for_s` sets
/// the same value afterwards.
void StudyReader::check_effects(const JsonCursor& at) const {
  const auto& all = study_.parameters;
  std::vector<Tokens> tokens;
  for (const Study::Parameter& one : all) tokens.push_back(pointer_tokens(one.pointer).value_or(Tokens{}));
  for (std::size_t p = 0; p < all.size(); ++p) {
    const std::string& pointer = all[p].pointer;
    const auto report = [&](const std::string& why) {
      at.error_at(all[p].where,
                  fmt::format("/parameters/{}: \"{}\" has no effect, because {}", p, pointer, why));
    };
    if (pointer == "/seed" && !study_.seeds.empty())
      report("\"seeds\" sets the seed of each run: remove this parameter or \"seeds\"");
    if ((pointer == "/quit_time_s" || pointer == "/quit_time_ms") && study_.for_s)
      report("\"for_s\" of the study sets the end of each run: remove this parameter or \"for_s\"");
    const auto later = std::find_if(tokens.begin() + static_cast<std::ptrdiff_t>(p) + 1, tokens.end(),
                                    [&](const Tokens& one) { return overwrites(one, tokens[p]); });
    if (later != tokens.end())
      report(fmt::format("/parameters/{} sets {}: remove one of these two parameters", later - tokens.begin(),
                         later->size() == tokens[p].size() ? "the same value" : "a value that contains it"));
  }
}

void StudyReader::check_runs(const JsonCursor& at) {
  auto count = static_cast<double>(std::max<std::size_t>(study_.seeds.size(), 1));
  if (study_.samples) count *= static_cast<double>(*study_.samples);
  for (std::size_t p = 0; !study_.samples && p < study_.choices.size(); ++p) {
    if (study_.choices[p].count() == 0)
      return at.error_at(study_.parameters[p].where,
                         fmt::format("/parameters/{}: the values of \"{}\" are random: give the number of "
                                     "samples, as in \"samples\": 100",
                                     p, study_.parameters[p].name));
    if (!study_.parameters[p].with) count *= static_cast<double>(study_.choices[p].count());
  }
  if (count > static_cast<double>(k_most_runs))
    at.error(fmt::format("the study has {} runs; at most {} are allowed: give fewer values, samples or seeds",
                         plain_number(count), k_most_runs));
}

/// Returns the name of the random stream of a parameter. Each parameter has an independent stream, so that
/// adding another parameter does not change the values of this one. Only pointers that append to a list can
/// occur several times; then the name also contains the number of earlier parameters with this pointer.
std::string stream_name(const std::vector<Study::Parameter>& parameters, std::size_t p) {
  const std::string& pointer = parameters[p].pointer;
  if (!pointer.ends_with("/-")) return pointer;
  const auto end = parameters.begin() + static_cast<std::ptrdiff_t>(p);
  const auto repeats = std::ranges::count(parameters.begin(), end, pointer, &Study::Parameter::pointer);
  return repeats == 0 ? pointer : fmt::format("{} #{}", pointer, repeats + 1);
}

}  // namespace

std::string_view statistic_name(Statistic statistic) {
  return k_statistics[static_cast<std::size_t>(statistic)];
}

std::string Study::Choice::value(std::size_t i) const {
  if (kind == Kind::listed) return values[i];
  if (i + 1 == steps) return option_text(high);
  const double last = static_cast<double>(steps - 1);
  const double at = static_cast<double>(i);
  // If both ends are whole multiples of 10^-n, the value is a quotient of whole numbers. One division rounds
  // it to the double that is nearest to the decimal number: 0.3, where the formula below gives
  // 0.30000000000000004.
  constexpr double k_most = 0x1p53;  // whole numbers up to here are exact
  for (double scale = 1; scale < 1e16; scale *= 10) {
    const double first = std::round(low * scale), end = std::round(high * scale);
    if (std::max({std::abs(first), std::abs(end), scale}) * last > k_most / 2) break;
    if (first / scale == low && end / scale == high)
      return option_text((first * (last - at) + end * at) / (last * scale));
  }
  return option_text(low + at / last * (high - low));
}

std::size_t Study::run_count() const {
  std::size_t count = std::max<std::size_t>(seeds.size(), 1) * samples.value_or(1);
  for (std::size_t p = 0; p < choices.size(); ++p)
    if (!samples && !parameters[p].with) count *= choices[p].count();
  return count;
}

Study::Run Study::run(std::size_t index) const {
  Run run;
  if (!seeds.empty()) {
    run.seed = seeds[index % seeds.size()];
    index /= seeds.size();
  }
  run.values.resize(choices.size());
  std::vector<std::size_t> positions(choices.size());  // in the lists of values; without samples
  for (std::size_t p = choices.size(); p-- > 0;) {
    if (samples || parameters[p].with) continue;
    positions[p] = index % choices[p].count();
    index /= choices[p].count();
  }
  for (std::size_t p = 0; p < choices.size(); ++p) {
    if (samples) {  // with the stream of its leader, a parameter draws the position that the leader draws
      Random random(random_seed, stream_id("study", stream_name(parameters, leader_of(p))),
                    static_cast<std::uint32_t>(index), 0);
      run.values[p] = drawn(choices[p], random);
    } else {
      run.values[p] = choices[p].value(positions[leader_of(p)]);
    }
  }
  return run;
}

std::optional<std::uint64_t> Study::seed_of(const Run& run, std::uint64_t world_seed) const {
  if (run.seed) return run.seed;
  for (std::size_t p = 0; p < parameters.size(); ++p)
    if (parameters[p].pointer == "/seed") return number_of<std::uint64_t>(run.values[p]);
  return world_seed;
}

std::vector<std::pair<std::string, std::string>> Study::settings(const Run& run) const {
  std::vector<std::pair<std::string, std::string>> set;
  for (std::size_t p = 0; p < parameters.size(); ++p) set.emplace_back(parameters[p].pointer, run.values[p]);
  return set;
}

std::vector<std::string> measure_columns(const std::vector<std::string>& measures,
                                         const std::vector<Statistic>& statistics) {
  std::vector<std::string> names;
  for (const std::string& measure : measures)
    for (const Statistic statistic : statistics)
      names.push_back(
          statistic == Statistic::last ? measure : fmt::format("{}_{}", measure, statistic_name(statistic)));
  return names;
}

void check_columns(const Study& study, const std::vector<std::string>& measures, Diagnostics& diagnostics) {
  std::vector<std::string> columns = measure_columns(measures, study.statistics);
  std::set<std::string_view> taken(k_own_columns.begin(), k_own_columns.end());
  // The columns of series.csv are those of the statistic `last`.
  for (const std::string& measure : measures)
    if (taken.contains(measure) && std::ranges::find(columns, measure) == columns.end())
      columns.push_back(measure);
  for (const std::string& column : columns)
    if (!taken.insert(column).second)
      diagnostics.error(study.where, fmt::format("the table of results already has a column \"{}\": give the "
                                                 "measure of this column another \"name\"",
                                                 column));
  taken.insert(measures.begin(), measures.end());
  for (std::size_t p = 0; p < study.parameters.size(); ++p)
    if (taken.contains(study.parameters[p].name))
      diagnostics.error(
          study.parameters[p].where,
          fmt::format("/parameters/{}: the table of results already has a column \"{}\", that of a measure: "
                      "give this parameter another \"name\"",
                      p, study.parameters[p].name));
}

std::string runs_text(std::span<const std::size_t> runs) {
  std::vector<std::string> ranges;
  for (std::size_t first = 0, last; first < runs.size(); first = last + 1) {
    last = first;
    while (last + 1 < runs.size() && runs[last + 1] == runs[last] + 1) ++last;
    ranges.push_back(first == last ? fmt::to_string(runs[first])
                                   : fmt::format("{} to {}", runs[first], runs[last]));
  }
  return joined(ranges, ", ");
}

Study load_study(const std::filesystem::path& file, const engine::Registry& registry,
                 Diagnostics& diagnostics) {
  const Where start{diagnostics.files()->add(file.string()), 0};
  const auto text = read_file(file);
  if (!text) {
    const Result<> readable = check_readable(file, k_most_input_bytes);
    diagnostics.error(start, readable ? "the file cannot be read" : readable.error().text);
    return {};
  }
  return load_study_text(file, *text, registry, diagnostics);
}

Study load_study_text(const std::filesystem::path& file, std::string_view text,
                      const engine::Registry& registry, Diagnostics& diagnostics, const std::string* world) {
  restore_fp_environment();  // before anything is computed from the file
  const Where start{diagnostics.files()->add(file.string()), 0};
  const std::optional<JsonNode> document = parse_json(text, start, false, diagnostics);
  return document ? StudyReader(file, registry, world).read(*document, diagnostics) : Study{};
}

}  // namespace troupe::worldio
