// Prints the dictionary of a fuzz target for libFuzzer: the keys, words and options that Troupe knows.
//   fuzz_dictionary json|stage|study|command

#include "apps/command_line.hpp"
#include "tests/fuzz/json_mutator.hpp"
#include "tests/fuzz/stage_mutator.hpp"

#include <fmt/format.h>

#include <set>
#include <string>
#include <string_view>

namespace troupe::fuzz {
namespace {

/// Prints entries in the format of libFuzzer: in quotes, with special characters as \xHH.
void print_entries(const std::set<std::string>& entries) {
  for (const std::string& entry : entries) {
    std::string text;
    for (const char c : entry) {
      const bool plain = c >= ' ' && c <= '~' && c != '"' && c != '\\';
      text += plain ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    if (!text.empty()) fmt::print("\"{}\"\n", text);
  }
}

std::set<std::string> json_entries(const JsonMutator& mutator) {
  std::set<std::string> entries{"1e300",         "1e-300", "-0.0", "18446744073709551615", "9007199254740993",
                                "\\ud83d\\ude00"};
  for (const std::string& key : mutator.keys()) entries.insert(fmt::format("\"{}\": ", key));
  for (const std::string& word : mutator.words()) entries.insert(fmt::format("\"{}\"", word));
  return entries;
}

std::set<std::string> stage_entries() {
  std::set<std::string> entries{"define ", "include \"parts.inc\"", " ) ",      " ] ",
                                "100000",  "9007199254740992",      "0.000001", "-1"};
  const StageWords& words = stage_words();
  for (const std::string& property : words.properties) entries.insert(property + " ");
  for (const std::string& type : words.types) entries.insert(type + "( ");
  for (const std::string& text : words.texts) entries.insert(fmt::format("\"{}\" ", text));
  return entries;
}

std::set<std::string> command_entries() {
  std::set<std::string> entries;
  for (const apps::Command& command : apps::known_commands()) {
    entries.insert(command.name + "\n");
    for (const apps::CommandOption& option : command.options)
      for (const std::string& name : option.names) entries.insert("\n" + name + "\n");
  }
  for (const char* file :
       {"room.json", "room.world", "study.json", "a.log", "b.log", "m.csv", "e.csv", "p.json", "run.h5",
        "c.h5", "folder", "new.json", "new.world", "new.h5", "new.html", "new.png"})
    entries.insert(fmt::format("\n{}\n", file));
  for (const char* value :
       {"1e308", "nan", "inf", "-1", "0", "18446744073709551616", "0x10", "1,2,8", "auto", "all",
        "--set=/populations/0/count=3", "--set=/seed=2", "--part=1/2", "--", "=", "{world}"})
    entries.insert(value);
  return entries;
}

}  // namespace
}  // namespace troupe::fuzz

int main(int argc, char** argv) {
  using namespace troupe::fuzz;
  const std::string_view target = argc == 2 ? argv[1] : "";
  if (target == "json") return print_entries(json_entries(world_mutator())), 0;
  if (target == "study") return print_entries(json_entries(study_mutator())), 0;
  if (target == "stage") return print_entries(stage_entries()), 0;
  if (target == "command") return print_entries(command_entries()), 0;
  fmt::print(stderr, "usage: fuzz_dictionary json|stage|study|command\n");
  return 2;
}
