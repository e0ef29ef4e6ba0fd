#pragma once

#include "base/printable.hpp"

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace troupe::apps {

/// Prints a text on standard error, in which control characters are escaped (printable()). If this fails, for
/// example because standard error is closed, its disk is full or its terminal no longer exists, the text is
/// lost. fmt::print() would throw an exception instead: a warning would end the run, and an error that is
/// printed in a `catch` block would abort the program.
void print_message(std::string_view text);
/// Prints texts, such as the warnings about a world, each with a line break, as print_message() does.
void print_lines(std::span<const std::string> lines);
/// Prints a text and a line break, as print_message() does.
void print_line(std::string_view line);

/// Returns the argument of a format; a text is escaped with printable_line().
template <class Argument>
decltype(auto) shown(const Argument& argument) {
  if constexpr (std::is_convertible_v<const Argument&, std::string_view>)
    return printable_line(argument);
  else
    return (argument);
}

/// Prints a text on standard output. Control characters in the arguments, also line breaks, are escaped
/// (printable_line()).
template <class... Arguments>
void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::print("{}", fmt::format(fmt::runtime(format), shown(arguments)...));
}

}  // namespace troupe::apps
