#include "base/diagnostics.hpp"
#include "base/printable.hpp"
#include "base/split.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <numeric>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t k_names_listed = 50;
constexpr std::size_t k_names_listed_with_hint = 24;
constexpr std::size_t k_names_compared = 2000;
constexpr std::size_t k_longest_compared = 100;  // bytes of a name
constexpr std::size_t k_longest_message = 8000;
// Length, in bytes, of the beginning by which long messages are compared. It must be far below
// k_longest_message, because messages about a base and its heir are not cut after the same letter.
constexpr std::size_t k_message_compared = 4000;

std::string_view name_of(Severity severity) { return severity == Severity::warning ? "warning" : "error"; }

std::string shortened(std::string message) {
  if (message.size() > k_longest_message) {
    message.resize(first_characters(message, k_longest_message).size());
    message += " ...";
  }
  return message;
}

/// The number of insertions, deletions, substitutions and swaps of adjacent letters that turn a into b.
/// rows: scratch memory, reused between calls
std::size_t edit_distance(std::string_view a, std::string_view b,
                          std::array<std::vector<std::size_t>, 3>& rows) {
  auto& [before_last, last, row] = rows;
  for (auto* r : {&before_last, &last, &row}) r->resize(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// The names of units by quantity, as the last word of a name may have them: those of keys in JSON worlds,
/// and others that a user may expect.
constexpr std::string_view k_units[][12] = {
    {"m", "cm", "mm", "km", "meter", "meters", "metre", "metres", "px"},
    {"rad", "deg", "rads", "degree", "degrees", "radian", "radians"},
    {"s", "ms", "us", "sec", "secs", "msec", "second", "seconds", "minutes"},
    {"mps", "cmps", "mmps", "kmh", "kph", "mph"},
    {"radps", "degps", "rps", "dps", "rpm"},
    {"mps2", "cmps2", "ms2"},
    {"radps2", "degps2", "rps2", "dps2"},
    {"hz", "Hz"},
    {"kg", "g", "gram", "grams", "kilogram", "kilograms"},
    {"J", "kJ", "joule", "joules", "kjoule", "kjoules"},
    {"W", "kW", "watt", "watts"}};

/// A name as a list of words.
struct Words {
  std::vector<std::string_view> words;  ///< without the unit
  std::size_t unit = 0;                 ///< number of the quantity in k_units, from 1; 0: no unit
};

Words words_of(std::string_view name) {
  constexpr std::string_view k_separators = "_-. ";
  Words out;
  for (std::size_t at = 0; (at = name.find_first_not_of(k_separators, at)) != name.npos;) {
    const std::size_t end = std::min(name.size(), name.find_first_of(k_separators, at));
    out.words.push_back(name.substr(at, end - at));
    at = end;
  }
  if (out.words.size() < 2) return out;
  for (std::size_t q = 0; q < std::size(k_units); ++q)
    if (std::ranges::find(k_units[q], out.words.back()) != std::end(k_units[q])) out.unit = q + 1;
  if (out.unit > 0) out.words.pop_back();
  return out;
}

using EditRows = std::array<std::vector<std::size_t>, 3>;

/// Whether two words of names correspond: they are equal, differ by few edits, or one, of at least three
/// letters, begins the other, as "max" begins "maximum".
bool correspond(std::string_view a, std::string_view b, EditRows& rows) {
  const auto [shorter, longer] = std::minmax({a.size(), b.size()});
  if (shorter >= 3 && (a.starts_with(b) || b.starts_with(a))) return true;
  return longer - shorter <= shorter / 3 && edit_distance(a, b, rows) <= shorter / 3;
}

/// Returns the name in `known` that corresponds to `word` best, word by word; null if there is none.
const std::string_view* nearest_by_words(std::string_view word, std::span<const std::string_view> known,
                                         EditRows& rows) {
  const Words wanted = words_of(word);
  const std::string_view* best = nullptr;
  std::size_t fewest = 0;
  if (wanted.words.size() + (wanted.unit > 0) < 2 || word.size() > k_longest_compared) return nullptr;
  for (const std::string_view& name : known) {
    if (name.size() > k_longest_compared) continue;
    Words other = words_of(name);
    const bool same_unit = wanted.unit > 0 && wanted.unit == other.unit;
    std::size_t alone = (wanted.unit > 0) + (other.unit > 0) - 2 * same_unit;
    std::size_t pairs = 0;
    for (const std::string_view part : wanted.words) {
      const auto same =
          std::ranges::find_if(other.words, [&](std::string_view x) { return correspond(part, x, rows); });
      if (same == other.words.end()) {
        ++alone;
        continue;
      }
      ++pairs;
      other.words.erase(same);
    }
    alone += other.words.size();
    if (pairs == 0 || alone > pairs + same_unit || (best != nullptr && alone >= fewest)) continue;
    best = &name;
    fewest = alone;
  }
  return best;
}

/// Returns the value of the longest key with which `text` begins and after which `text` has one of the
/// characters `ends`. Null if there is no such key.
const std::size_t* longest_beginning(const std::map<std::string, std::size_t, std::less<>>& keys,
                                     std::string_view text, std::string_view ends) {
  std::string_view beginning = text;
  while (true) {
    auto entry = keys.upper_bound(beginning);
    if (entry == keys.begin()) return nullptr;
    const std::string& key = (--entry)->first;
    const auto same = static_cast<std::size_t>(std::ranges::mismatch(key, beginning).in1 - key.begin());
    if (same == 0) return nullptr;
    const bool is_whole = same == key.size();
    if (is_whole && same < text.size() && ends.find(text[same]) != ends.npos) return &entry->second;
    // There is no key between this one and `beginning`, so a shorter one ends within their common characters.
    beginning = beginning.substr(0, is_whole ? same - 1 : same);
  }
}

}  // namespace

std::uint32_t SourceFiles::add(std::string_view name) {
  if (const auto found = numbers_.find(name); found != numbers_.end()) return found->second;
  const auto number = static_cast<std::uint32_t>(names_.size());
  names_.emplace_back(name);
  numbers_.emplace(name, number);
  return number;
}

Diagnostics::Diagnostics(bool thorough) : thorough_(thorough), files_(std::make_shared<SourceFiles>()) {}
Diagnostics::Diagnostics(std::shared_ptr<SourceFiles> files)
    : thorough_(false), files_(files ? std::move(files) : std::make_shared<SourceFiles>()) {}

void Diagnostics::error(Where where, std::string message) {
  if (is_inherited(Severity::error, where, message)) return;
  findings_.push_back({Severity::error, where, shortened(std::move(message))});
  repeats_.push_back(0);
  if (++errors_ == k_most_errors) throw_if_errors();
}

void Diagnostics::warning(Where where, std::string message) {
  if (is_inherited(Severity::warning, where, message)) return;
  findings_.push_back({Severity::warning, where, shortened(std::move(message))});
  repeats_.push_back(0);
}

void Diagnostics::warning_once(Where where, std::string message) {
  const auto [place, is_new] =
      once_.try_emplace(thorough_ ? text({Severity::warning, where, message}) : message, findings_.size());
  if (is_new) {
    const std::size_t before = findings_.size();
    warning(where, std::move(message));
    if (findings_.size() == before) once_.erase(place);  // an inherited finding, which is not listed again
  } else {
    ++repeats_[place->second];
  }
}

void Diagnostics::explain(Where where, std::string message) {
  const std::size_t before = findings_.size();
  warning_once(where, std::move(message));
  if (findings_.size() > before) findings_.back().explains = true;
}

std::size_t Diagnostics::kin_of(const Inheritable& part) {
  const auto [place, is_new] = paths_.emplace(part.path, kin_.size());
  if (is_new) {
    names_.emplace(part.name, kin_.size());
    kin_.push_back({part, kin_.size()});
  }
  return place->second;
}

void Diagnostics::inherits(const Inheritable& heir, const Inheritable& base) {
  const std::size_t from = kin_of(base);
  kin_[kin_of(heir)].base = from;
  alike_.clear();  // the most distant bases may have changed
  listed_ = 0;
}

bool Diagnostics::is_heir(std::size_t heir, std::size_t base) const {
  while (heir != base && kin_[heir].base != heir) heir = kin_[heir].base;
  return heir == base;
}

std::optional<std::size_t> Diagnostics::to_common_base(std::string& message) const {
  const auto root = [this](std::size_t part) {
    while (kin_[part].base != part) part = kin_[part].base;
    return part;
  };
  if (const std::size_t* part = longest_beginning(paths_, message, "/:")) {
    message.replace(0, kin_[*part].part.path.size(), kin_[root(*part)].part.path);
    return *part;
  }
  for (std::size_t at = message.find('"'); at != message.npos; at = message.find('"', at + 1)) {
    const std::size_t* part = longest_beginning(names_, std::string_view(message).substr(at + 1), "\"");
    if (!part) continue;
    message.replace(at + 1, kin_[*part].part.name.size(), kin_[root(*part)].part.name);
    return *part;
  }
  return std::nullopt;
}

std::string Diagnostics::common_text(Severity severity, Where where, std::string_view common) const {
  return text({severity, where, std::string(first_characters(common, k_message_compared))});
}

bool Diagnostics::is_inherited(Severity severity, Where where, const std::string& message) {
  const auto same_place = [](const Where& a, const Where& b) { return a.file == b.file && a.line == b.line; };
  if (kin_.empty()) return false;
  for (; listed_ < findings_.size(); ++listed_) {
    const Finding& finding = findings_[listed_];
    std::string common = finding.message;
    const auto about = to_common_base(common);
    alike_[common_text(finding.severity, finding.where, common)].push_back({listed_, about});
  }
  std::string common = message;
  const auto about = to_common_base(common);
  const auto alike = alike_.find(common_text(severity, where, common));
  if (alike == alike_.end()) return false;
  for (auto& [finding, its_about] : alike->second) {
    if (about.has_value() != its_about.has_value()) continue;
    if (!about) return true;
    if (is_heir(*about, *its_about)) return true;
    const bool has_heir = is_heir(*its_about, *about);
    const auto is_own = [&](std::size_t part) { return same_place(kin_[part].part.where, where); };
    if (!has_heir && (is_own(*about) || is_own(*its_about))) continue;
    if (has_heir) {
      findings_[finding].message = shortened(message);
      its_about = about;
    }
    return true;
  }
  return false;
}

std::string Diagnostics::text(const Finding& finding) const {
  std::string text = fmt::format("{}: {}", name_of(finding.severity), printable_line(finding.message));
  if (finding.where.file == Where::k_no_file) return text;
  const std::string file = printable_line(files_->name(finding.where.file));
  return finding.where.line == 0 ? fmt::format("{}: {}", file, text)
                                 : fmt::format("{}:{}: {}", file, finding.where.line, text);
}

std::vector<std::string> Diagnostics::warnings() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < findings_.size(); ++i) {
    if (findings_[i].severity != Severity::warning) continue;
    lines.push_back(text(findings_[i]));
    if (repeats_[i] > 0)
      lines.back() += fmt::format(" (and {} more such warning{})", repeats_[i], repeats_[i] == 1 ? "" : "s");
  }
  return lines;
}

void Diagnostics::throw_if_errors() const {
  if (!has_errors()) return;
  std::string message;
  std::size_t listed = 0;
  std::size_t explained = 0;
  for (const Finding& finding : findings_) {
    const bool is_error = finding.severity == Severity::error;
    if (!is_error && !finding.explains) continue;
    if (std::size_t& count = is_error ? listed : explained; count++ == k_most_listed) {
      --count;
      continue;
    }
    if (!message.empty()) message += '\n';
    message += text(finding);
  }
  if (errors_ > listed) {
    const std::size_t more = errors_ - listed;
    message += fmt::format("\n... and {} more error{}{}", more, more == 1 ? "" : "s",
                           errors_ == k_most_errors ? "; the rest of the input was not read" : "");
  }
  throw InputError(message);
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> known) {
  const std::string_view* best = nullptr;
  std::size_t best_distance = 0;
  EditRows rows;
  constexpr std::string_view k_separators = "_-. ";
  constexpr std::size_t k_most_in_words = 2;  // edits of a name of several words
  const bool has_words = word.find_first_of(k_separators) != word.npos;
  const auto lower = [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  for (const std::string_view& name : known) {
    if (std::ranges::equal(word, name, {}, lower, lower)) {
      best = &name;
      break;
    }
    const auto [shorter, longer] = std::minmax({word.size(), name.size()});
    // A third of the letters may be wrong. Names of one or two letters get no suggestion.
    const std::size_t most = has_words ? std::min(k_most_in_words, shorter / 3) : shorter / 3;
    // The edit distance is at least the difference in length, so most names of a large world are skipped
    // cheaply.
    if (longer > k_longest_compared || longer - shorter > most ||
        (best != nullptr && longer - shorter >= best_distance))
      continue;
    const std::size_t distance = edit_distance(word, name, rows);
    if (distance > most) continue;
    if (best == nullptr || distance < best_distance) {
      best = &name;
      best_distance = distance;
    }
  }
  if (best == nullptr) best = nearest_by_words(word, known, rows);
  return best == nullptr ? std::string() : fmt::format(" (did you mean \"{}\"?)", *best);
}

std::string comma_list(std::span<const std::string_view> names) { return joined(names, ", "); }

std::string exception_text(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ? "not enough memory" : error.what();
}

std::string_view first_characters(std::string_view text, std::size_t most) {
  const auto goes_on = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  if (text.size() <= most) return text;
  while (most > 0 && goes_on(text[most])) --most;
  return text.substr(0, most);
}

std::string unknown_name(std::string_view what, std::string_view name, std::vector<std::string_view> known,
                         std::string hint) {
  if (known.empty()) return fmt::format("unknown {} \"{}\"; no {} exists", what, name, what);
  if (hint.empty() && known.size() <= k_names_compared) hint = did_you_mean(name, known);
  if (!hint.empty() && known.size() > k_names_listed_with_hint)
    return fmt::format("unknown {} \"{}\"{}", what, name, hint);
  const std::size_t listed = std::min(known.size(), k_names_listed);
  std::ranges::partial_sort(known, known.begin() + static_cast<std::ptrdiff_t>(listed));
  const std::string more =
      known.size() > listed ? fmt::format(" and {} more", known.size() - listed) : std::string();
  return fmt::format("unknown {} \"{}\"; known: {}{}{}", what, name,
                     comma_list(std::span(known).first(listed)), more, hint);
}

}  // namespace troupe
