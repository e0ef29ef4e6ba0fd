#include "apps/messages.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace troupe::apps {

void print_message(std::string_view text) {
  const std::string shown = printable(text);
  static_cast<void>(std::fwrite(shown.data(), 1, shown.size(), stderr));
}

void print_lines(std::span<const std::string> lines) {
  for (const std::string& line : lines) print_line(line);
}

void print_line(std::string_view line) { print_message(fmt::format("{}\n", line)); }

}  // namespace troupe::apps
