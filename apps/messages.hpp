#pragma once

#include <span>
#include <string>
#include <string_view>

namespace troupe::apps {

/// Prints a text on standard error. If this fails, for example because standard error is closed, its disk is
/// full or its terminal no longer exists, the text is lost. fmt::print() would throw an exception instead: a
/// warning would end the run, and an error that is printed in a `catch` block would abort the program.
void print_message(std::string_view text);
/// Prints texts, such as the warnings about a world, each with a line break, as print_message() does.
void print_lines(std::span<const std::string> lines);
/// Prints a text and a line break, as print_message() does.
void print_line(std::string_view line);

}  // namespace troupe::apps
