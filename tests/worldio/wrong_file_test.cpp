#include "worldio/wrong_file.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/registry.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio::wrong_file_test {
namespace {

using testing::ElementsAre;

/// Contents of files that are no worlds, and the texts that name them.
const std::vector<std::pair<std::string, std::string>> k_files{
    {"<?xml version=\"1.0\" ?>\n<!-- a comment -->\n<sdf version=\"1.6\"><world name=\"a\"/></sdf>",
     "a world or model of Gazebo (SDF), not a world of Stage or Troupe: no command of Troupe reads it"},
    {"\xef\xbb\xbf<gazebo/>",
     "a world or model of Gazebo (SDF), not a world of Stage or Troupe: no command of Troupe reads it"},
    {"<robot name=\"r\" xmlns:xacro=\"x\">",
     "a robot description (URDF), not a world of Stage or Troupe: no command of Troupe reads it"},
    {"<?xml?>\n<argos-configuration>\n",
     "an experiment of ARGoS (.argos), not a world of Stage or Troupe: docs/from-argos.md shows how to write "
     "it as a "
     "world"},
    {"<launch>", "a launch file of ROS, not a world of Stage or Troupe: give the world file that it names"},
    {"<!DOCTYPE html>\n<HTML>",
     "a web page, not a world of Stage or Troupe: download the file itself, not the page that shows it"},
    {"<foo bar=\"1\">",
     "an XML file with the root element <foo>, not a world of Stage or Troupe: no command of Troupe reads "
     "it"},
    {"#VRML_SIM R2022a utf8\nWorldInfo {\n}\n",
     "a world of Webots (.wbt), not a world of Stage or Troupe: no command of Troupe reads it"},
    {"image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n",
     "the YAML file of a ROS map, not a world of Stage or Troupe: a model of a world can name it as its "
     "\"bitmap\""},
    {"# flatland\nproperties:\n  a: 1\n",
     "a YAML file, not a world of Stage or Troupe: no command of Troupe reads it"},
    {"# player\n\ndriver\n(\n  name \"stage\"\n  worldfile \"simple.world\"\n)\n",
     "a configuration of the Player server, not a world of Stage or Troupe: give the world file that it "
     "names, "
     "\"simple.world\""},
    {"driver( name \"amcl\" )",
     "a configuration of the Player server, not a world of Stage or Troupe: give the world file that it "
     "names"},
    {"# sample\n\nbegin environment\n  file cave.pnm\nend\n",
     "in the syntax of the first versions of Stage, not a world of Stage or Troupe: write each model in "
     "parentheses, as in position( pose [0 0 0 0] )"},
    {"troupe checkpoint\nlayout 1\n",
     "a checkpoint, not a world of Stage or Troupe: troupe resume continues its run"},
    {"\x89HDF\r\n\x1a\n...",
     "an HDF5 file, not a world of Stage or Troupe: if it is a recording, troupe replay plays it; troupe "
     "info describes "
     "it"},
    {"{\"troupe_session\":1}\n",
     "a session of troupe view, not a world of Stage or Troupe: troupe run WORLD --session FILE repeats it"},
    {"\x89PNG\r\n\x1a\n",
     "a PNG picture, not a world of Stage or Troupe: a model of a world can name it as its \"bitmap\""},
    {"P2\n# CREATOR\n2 1\n255\n0 1\n",
     "a PBM, PGM or PPM picture, not a world of Stage or Troupe: a model of a world can name it as its "
     "\"bitmap\""},
    {"\x1f\x8b\x08", "compressed (gzip), not a world of Stage or Troupe: unpack it first"},
    {std::string("\0\1\2\3\4\5\6\0\0", 9),
     "a binary file, not a world of Stage or Troupe: no command of Troupe reads it"},
};

TEST(WrongFile, IsNamedByItsContent) {
  for (const auto& [content, text] : k_files) EXPECT_EQ(wrong_file_text(content), "this is " + text);
  for (const char* empty : {"", "\n \t\n"})
    EXPECT_EQ(wrong_file_text(empty), "the file is empty: a world has at least one model") << empty;
}

TEST(WrongFile, MayBeAWorld) {
  for (const char* world : {"# a comment\nmodel( name \"x\" )", "include \"pioneer.inc\"", "{\"troupe\": 1}",
                            " {", "name \"image: x\"", "# image: a\n# resolution: b\nposition()",
                            "position( name \"driver\" )", "define driver position()",
                            "\xef\xbb\xbfresolution 0.02", "# \xe9t\xe9\nmodel()", "P2", "# only comments\n"})
    EXPECT_EQ(wrong_file_text(world), std::nullopt) << world;
  EXPECT_EQ(wrong_file_text(std::string("\xff\xfem\0o\0", 6)), std::nullopt) << "the readers name UTF-16";
}

class WrongFileTest : public test::ScratchTest {};

TEST_F(WrongFileTest, IsOneErrorWhateverItsName) {
  for (const char* name : {"a.world", "b.json", "c.txt"})
    for (const auto& [content, text] : k_files) {
      std::ofstream(folder_ / name, std::ios::binary) << content;
      Diagnostics diagnostics;
      load_world(folder_ / name, engine::Registry(), {}, diagnostics);
      std::vector<std::string> found;
      for (const Finding& finding : diagnostics.findings()) found.push_back(diagnostics.text(finding));
      EXPECT_THAT(found, ElementsAre((folder_ / name).string() + ": error: this is " + text)) << content;
    }
}

}  // namespace
}  // namespace troupe::worldio::wrong_file_test
