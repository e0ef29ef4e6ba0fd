#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe {

/// Returns true if an option of Simulation::effective_options() does not affect the simulated results. Such
/// options state how the run is computed (for example the number of threads) and at which tick it was
/// resumed. option: the key of the option.
constexpr bool changes_no_result(std::string_view option) {
  constexpr std::array<std::string_view, 5> k_options{"threads", "tile_m", "simd", "ranks",
                                                      "resumed_at_tick"};
  return std::ranges::find(k_options, option) != k_options.end();
}

/// An option whose value in a run differs from the value in a file with results.
struct OtherOption {
  std::string key;
  std::string here;     ///< the value in the run
  std::string in_file;  ///< `"VALUE"`, or `not given`
};

/// Returns the first option of a run that shows that another run wrote a file with results; std::nullopt if
/// there is none. Options that change no result, or that a resumed run may change for later ticks, are not
/// compared. Callers cannot compare only the states at one tick, because the states of two runs may be equal
/// for a while.
///
/// options: those of the run (Simulation::effective_options())
/// value_in_file: returns a pointer to the value of a key in the file; null if the file does not have the key
template <class Find>
std::optional<OtherOption> option_of_other_run(
    const std::vector<std::pair<std::string, std::string>>& options, Find&& value_in_file) {
  for (const auto& [key, here] : options) {
    if (changes_no_result(key) || key.starts_with("set ") || key.starts_with("plugin ")) continue;
    const std::string* in_file = value_in_file(key);
    if (!in_file) return OtherOption{key, here, "not given"};
    if (*in_file != here) return OtherOption{key, here, '"' + *in_file + '"'};
  }
  return {};
}

/// Returns the first part of a line of version_line(), such as `troupe 0.3.0`.
constexpr std::string_view program_of(std::string_view line) { return line.substr(0, line.find(" (")); }

/// Returns `text` as one line: each line break is replaced by the two characters `\n`, and each backslash by
/// `\\`. Hash logs (files with the hash of the simulated state after every time step) contain the options of
/// the run in this form.
inline std::string to_one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n' || c == '\\') line += '\\';
    line += c == '\n' ? 'n' : c;
  }
  return line;
}

/// Returns the text from which to_one_line() made `line`.
inline std::string from_one_line(std::string_view line) {
  std::string text;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_escape = line[i] == '\\' && i + 1 < line.size();
    if (is_escape) ++i;
    text += is_escape && line[i] == 'n' ? '\n' : line[i];
  }
  return text;
}

}  // namespace troupe
