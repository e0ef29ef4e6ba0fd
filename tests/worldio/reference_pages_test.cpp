#include "tests/worldio/reference_pages.hpp"
#include "tests/support/paths.hpp"
#include "tests/worldio/json_test_world.hpp"
#include "troupe/registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::worldio::reference_pages_test {
namespace {

using reference_pages::document_key_tables;
using reference_pages::KeyTable;
using reference_pages::measures_reference;
using reference_pages::with_key_tables;
using reference_pages::world_format_reference;
using testing::HasSubstr;

std::string document(const char* name = "world-format.md") {
  std::ifstream file(test::source_dir().string() + "/docs/" + name);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(WorldFormatReference, ShowsKeysLimitsAndDefaults) {
  const std::string text = world_format_reference(json_test_registry());
  EXPECT_THAT(
      text,
      HasSubstr("| `heading_rad`, `heading_deg` | number, from -62.83185307 to 62.83185307 rad | 0 rad | "
                "counter-clockwise from +x |\n"));
  EXPECT_THAT(
      text,
      HasSubstr("### Drive `car`\n\nmoves\n\n| key | value | default | meaning |\n|---|---|---|---|\n"
                "| `speed_max_mps` | number, at least 0 m/s | 1 m/s | limit |\n"
                "| `wheelbase_m`, `wheelbase_cm`, `wheelbase_mm` | number, above 0 m | required | between "
                "the axles |\n"));
  EXPECT_THAT(text, HasSubstr("| `transducers` | list of objects | required | fans of beams |\n"
                              "| `intensity` | true or false | false | brightness too |\n\nEach object in "
                              "`transducers` has these keys:\n"));
  EXPECT_THAT(text, HasSubstr("| `pose` | object | the defaults of its keys | where it looks |\n"));
  EXPECT_THAT(text, HasSubstr("| `samples` | whole number, from 1 to 1000 | 1 | beams |\n"));
  EXPECT_THAT(text, HasSubstr("| `law` | near, far | \"near\" | which |\n"));
  EXPECT_THAT(text,
              HasSubstr("### Controller `expand_swarm`\n\nwith numbers: `expand` with other defaults.\n\n"
                        "| key | default |\n|---|---|\n| `gain_per_s` | 2.5 1/s |\n"));
}

TEST(WorldFormatReference, StandsInTheDocument) {
  const std::string reference = world_format_reference(make_registry());
  if (document().find(reference) == std::string::npos) {
    const std::string made = (test::binary_dir() / "world-format-reference.md").string();
    std::ofstream(made) << reference;
    ADD_FAILURE() << "docs/world-format.md does not hold what the field tables say; put in the contents of "
                  << made;
  }
}

TEST(WorldFormatReference, TablesOfKeysStandInTheDocument) {
  const std::string page = with_key_tables(document(), document_key_tables(make_registry()));
  if (page != document()) {
    const std::string made = (test::binary_dir() / "world-format.md").string();
    std::ofstream(made) << page;
    ADD_FAILURE() << "tables of keys in docs/world-format.md differ from the descriptions in "
                     "worldio/json/world_document.cpp; replace the page by "
                  << made;
  }
}

TEST(WorldFormatReference, AMissingHeadingOrTableIsAnError) {
  const std::vector<KeyTable> tables{{"## One", "| key |\n|---|\n| new |\n"}, {"## One", "| key |\n"}};
  const auto error = [&](const std::string& page) -> std::string {
    try {
      with_key_tables(page, tables);
    } catch (const std::runtime_error& found) {
      return found.what();
    }
    return {};
  };
  EXPECT_EQ(error("# Page\n"), "the documentation page has no heading \"## One\": add this heading");
  EXPECT_EQ(error("# Page\n\n## One\n\n| key |\n\n## Two\n\n| key |\n"),
            "the documentation page has too few tables below the heading \"## One\": add a table that begins "
            "with \"| key\"");
  EXPECT_EQ(with_key_tables("# Page\n\n## One\n\nText\n\n| key |\n|---|\n| old |\n\nMore\n\n| key |\nold\n",
                            tables),
            "# Page\n\n## One\n\nText\n\n| key |\n|---|\n| new |\n\nMore\n\n| key |\n");
}

TEST(MeasuresReference, StandsInTheDocument) {
  const std::string reference = measures_reference(make_registry());
  if (document("measures.md").find(reference) == std::string::npos) {
    const std::string made = (test::binary_dir() / "measures-reference.md").string();
    std::ofstream(made) << reference;
    ADD_FAILURE() << "docs/measures.md does not hold what the kinds say; put in the contents of " << made;
  }
}

TEST(WorldFormatReference, TheDocumentsExampleLoads) {
  const std::string text = document();
  const std::string fence = "```json\n";
  const std::size_t begin = text.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const std::string example =
      text.substr(begin + fence.size(), text.find("```", begin + fence.size()) - begin - fence.size());
  Diagnostics diagnostics;
  const engine::WorldSpec spec =
      load_json_world(test::source_dir() / "worlds/example.json", example, make_registry(), {}, diagnostics);
  EXPECT_THAT(findings(diagnostics), testing::IsEmpty());
  EXPECT_EQ(spec.bodies.size(), 1u + 1 + 2 + 50 + 10);
}

}  // namespace
}  // namespace troupe::worldio::reference_pages_test
