#pragma once

// The parser of command lines, for headers that only name it. <CLI/CLI.hpp> takes three seconds to compile.
namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
class Option;
}  // namespace CLI
