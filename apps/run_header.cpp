#include "apps/run_header.hpp"

#include "base/diagnostics.hpp"
#include "troupe/effective_options.hpp"

#include <fmt/format.h>

#include <array>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {
namespace {

// Entries that compare_runs() does not compare, in addition to options that change no result. They describe
// the file, except "version", which compare_domains() compares part by part.
constexpr std::array<std::string_view, 5> k_free = {"version", "kind", "layout", "record_every_ticks",
                                                    "record_fields"};

/// A part of a version line, such as the compiler, on which results may depend.
struct DomainPart {
  std::string_view name;
  std::string value;
};

/// Splits a version line, `troupe 0.3.0 (GNU 12.2.0; Release -O3; x86_64; assertions off)`, into its parts.
/// The last part is omitted, because assertions change no result. A line of another form is returned as one
/// part.
std::vector<DomainPart> domain_of(const std::string& version_line) {
  constexpr std::array<std::string_view, 3> k_names = {"compiler", "flags", "instruction set"};
  std::vector<DomainPart> parts;
  std::size_t start = version_line.find(" (");
  if (start == version_line.npos) return {{"version", version_line}};
  parts.push_back({"version", version_line.substr(0, start)});
  start += 2;
  for (const std::string_view name : k_names) {
    const std::size_t end = version_line.find("; ", start);
    if (end == version_line.npos) return {{"version", version_line}};
    parts.push_back({name, version_line.substr(start, end - start)});
    start = end + 2;
  }
  return parts;
}

/// Collects the differences between two headers as the lines of an error message. Each line begins with the
/// name of the second file and, if this is a text file, a line number.
class Unlike {
 public:
  Unlike(const RunHeader& first, const RunHeader& second) : first_(first), second_(second) {}

  void compare_domains() {
    const std::vector<DomainPart> a = domain_of(value(first_, "version"));
    const std::vector<DomainPart> b = domain_of(value(second_, "version"));
    if (a.size() != b.size()) {
      note("version", "version", value(first_, "version"), value(second_, "version"), k_domain);
      return;
    }
    for (std::size_t i = 0; i < a.size(); ++i) note("version", a[i].name, a[i].value, b[i].value, k_domain);
  }

  void compare_runs() {
    std::set<std::string> keys;
    for (const RunHeader* header : {&first_, &second_})
      for (const auto& [key, entry] : header->entries) keys.insert(key);
    for (const std::string_view free : k_free) keys.erase(std::string(free));
    std::erase_if(keys, changes_no_result);
    for (const std::string& key : keys) {
      std::string a = value(first_, key);
      std::string b = value(second_, key);
      if (key == "world") {  // compared without its folder
        a = std::filesystem::path(a).filename().string();
        b = std::filesystem::path(b).filename().string();
      }
      note(key, key, a, b, k_run);
    }
  }

  void throw_if_any() const {
    if (!text_.empty()) throw InputError(text_);
  }

 private:
  static constexpr const char* k_domain = "the results may differ; --across-domains";
  static constexpr const char* k_run = "these are different runs; --across-runs";

  static std::string value(const RunHeader& header, const std::string& key) {
    const auto entry = header.entries.find(key);
    return entry == header.entries.end() ? "" : entry->second.value;
  }

  /// Returns the name of the second file and, if it is a text file, the line number of the entry `key`, or
  /// line 1 if the file has no such entry.
  std::string place(const std::string& key) const {
    const auto entry = second_.entries.find(key);
    const bool in_lines = !second_.entries.empty() && second_.entries.begin()->second.line > 0;
    if (!in_lines) return second_.file.string();
    return fmt::format("{}:{}", second_.file.string(),
                       entry == second_.entries.end() ? 1 : entry->second.line);
  }

  void note(const std::string& key, std::string_view what, const std::string& a, const std::string& b,
            const char* reason) {
    if (a == b) return;
    if (!text_.empty()) text_ += '\n';
    text_ += fmt::format("{}: error: {} is \"{}\", but \"{}\" in {}: {} compares the files anyway",
                         place(key), what, b, a, first_.file.string(), reason);
  }

  const RunHeader& first_;
  const RunHeader& second_;
  std::string text_;
};

}  // namespace

void refuse_unlike(const RunHeader& first, const RunHeader& second, bool across_domains, bool across_runs) {
  Unlike unlike(first, second);
  if (!across_domains) unlike.compare_domains();
  if (!across_runs) unlike.compare_runs();
  unlike.throw_if_any();
}

}  // namespace troupe::apps
