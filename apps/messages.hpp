#pragma once

#include <string_view>

namespace troupe::apps {

/// Prints a text on standard error. If this fails, for example because standard error is closed, its disk is
/// full or its terminal no longer exists, the text is lost. fmt::print() would throw an exception instead: a
/// warning would end the run, and an error that is printed in a `catch` block would abort the program.
void print_message(std::string_view text);

}  // namespace troupe::apps
