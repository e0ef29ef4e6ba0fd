// How the engine and the library treat a kind follows from what the kind declares
// (engine/kinds/device_kind.hpp), never from its name, so that kinds of plug-ins can have all capabilities.

#include "tests/support/paths.hpp"
#include "troupe/registry.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::capabilities_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Names = std::set<std::string, std::less<>>;

Names kind_names() {
  const engine::Registry registry = make_registry();
  Names names;
  const auto add = [&](const auto& kinds) {
    for (const auto& kind : kinds) names.emplace(kind.name);
  };
  add(registry.devices);
  add(registry.drives);
  add(registry.controllers);
  add(registry.presets);
  add(registry.faults);
  return names;
}

/// `LINE: "ranger"` for each text of a source, comments and includes apart, that is one of these names; and
/// for each parameter that is looked up by a text.
std::vector<std::string> names_in(std::string_view source, const Names& names) {
  static const std::regex text(R"re("((?:[^"\\]|\\.)*)")re");
  static const std::regex look_up(R"re(((?:\bget|params\.find|fields\.find)\([^;]*?"[a-z_]+"))re");
  std::vector<std::string> found;
  std::size_t number = 0;
  for (std::size_t start = 0; start < source.size();) {
    const std::size_t end = std::min(source.find('\n', start), source.size());
    std::string line(source.substr(start, end - start));
    start = end + 1;
    ++number;
    line.resize(std::min(line.size(), line.find("//")));
    if (line.starts_with("#include")) continue;
    for (std::sregex_iterator it(line.begin(), line.end(), text), last; it != last; ++it)
      if (names.contains((*it)[1].str())) found.push_back(fmt::format("{}: {}", number, it->str()));
    std::smatch match;
    if (std::regex_search(line, match, look_up)) found.push_back(fmt::format("{}: {}", number, match.str()));
  }
  return found;
}

TEST(Capabilities, NoTextOfTheEngineOrTheLibraryIsTheNameOfAKind) {
  // Names of the same spelling that are no kinds, and the list of kinds itself.
  const std::set<std::string, std::less<>> allowed{
      R"(engine/spec/spec_description.cpp "fiducial")",  // a member of bodies
      R"(engine/spec/watch_spec.cpp "camera")",          // a parameter of a world's window
      R"(engine/spec/world_spec.cpp "ground")",          // the type of body 0
      R"(live/watched.cpp "radio")",                     // the name of a layer of lines
      R"(troupe/model.cpp "ranger")",                    // the word of a message for all that measures ranges
      R"(troupe/pictures.cpp "camera")",  // the same as in watch_spec.cpp, and the option --camera
      // Another parameter of a window.
      R"re(troupe/lint.cpp get(worldio::window_fields(), *spec_.window, "follow")re",
      R"(troupe/recorded_run.cpp "power_pack")"  // what to write behind --record-fields
  };
  const std::filesystem::path root(test::source_dir());
  const Names names = kind_names();
  std::vector<std::string> found;
  std::size_t files = 0;
  for (const char* folder : {"base", "partition", "engine", "troupe", "live"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      const std::string file = std::filesystem::relative(entry.path(), root).generic_string();
      if (extension != ".cpp" && extension != ".hpp") continue;
      if (file == "troupe/registry.cpp") continue;  // the list of kinds: presets name their controllers
      std::ifstream in(entry.path());
      const std::string source{std::istreambuf_iterator<char>(in), {}};
      ++files;
      for (const std::string& finding : names_in(source, names))
        if (!allowed.contains(file + finding.substr(finding.find(' '))))
          found.push_back(file + ":" + finding);
    }
  }
  EXPECT_GT(files, 100u);
  EXPECT_GT(names.size(), 40u);
  EXPECT_THAT(found, IsEmpty()) << "test what the kind declares, not its name: docs/extending.md";
}

TEST(Capabilities, ANameInASourceIsFound) {
  const Names names{"ranger", "power_pack"};
  EXPECT_THAT(names_in("if (kind.name == \"ranger\") sees();\n", names), ElementsAre("1: \"ranger\""));
  EXPECT_THAT(names_in("\n\nfor_each(world, \"power_pack\", [] {});\n", names),
              ElementsAre("3: \"power_pack\""));
  EXPECT_THAT(names_in("const int at = kind->params.find(\"pushes\");\n", names),
              ElementsAre("1: params.find(\"pushes\""));
  EXPECT_THAT(names_in("engine::get(kind.params, spec.params, \"fov\").number();\n", names),
              ElementsAre("1: get(kind.params, spec.params, \"fov\""));
  EXPECT_THAT(names_in("#include \"ranger\"\n// \"ranger\"\nerror(\"needs a ranger\");\n", names), IsEmpty());
}

}  // namespace
}  // namespace troupe::capabilities_test
