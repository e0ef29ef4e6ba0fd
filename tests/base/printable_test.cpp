#include "base/printable.hpp"
#include "base/diagnostics.hpp"

#include <gtest/gtest.h>

#include <string>

namespace troupe::printable_test {
namespace {

using namespace std::string_literals;

TEST(Printable, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(printable("red \x1b[31m, bell \a, \r\x7f and \0"s),
            R"(red \x1b[31m, bell \x07, \r\x7f and \x00)");
  EXPECT_EQ(printable("as UTF-8 \u009b2J, as a byte \x9b 2J"), R"(as UTF-8 \u009b2J, as a byte \x9b 2J)");
}

TEST(Printable, KeepsLettersOfAllScriptsAndTheLinesOfAMessage) {
  EXPECT_EQ(printable("\u00e4 \u6f22 \U0001f916 \u00a0\t1\n2"), "\u00e4 \u6f22 \U0001f916 \u00a0\t1\n2");
  EXPECT_EQ(printable("\xff is no UTF-8"), "\xff is no UTF-8");
  EXPECT_EQ(printable_line("1\n2\t\u00e4"), "1\\n2\t\u00e4");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, AFindingIsOneLine) {
  Diagnostics diagnostics;
  diagnostics.error({diagnostics.files()->add("a\nb.json"), 3}, "unknown key \"x\n\x1b[2J\"");
  EXPECT_EQ(diagnostics.text(diagnostics.findings()[0]), R"(a\nb.json:3: error: unknown key "x\n\x1b[2J")");
}

}  // namespace
}  // namespace troupe::printable_test
