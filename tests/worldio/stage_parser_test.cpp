#include "tests/worldio/stage_fixture.hpp"

#include <rapidcheck/gtest.h>

#include <fmt/format.h>

namespace troupe::worldio::stage_parser_test {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class StageParser : public StageTest {};
class Conformance14 : public StageTest {};

// Conformance vector 14: the parser, row by row of what Stage gets wrong or refuses.

TEST_F(Conformance14, CommaInATuple) {
  load("model(\n  pose [1, 2 3 4] )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: unexpected ','; the values of a tuple are separated by "
                          "blanks: [1 2 3]"));
}

TEST_F(Conformance14, MissingParenthesis) {
  load("model()\n\nmodel(\n  size [1 1 1]\n");
  EXPECT_THAT(messages(), ElementsAre("w.world:3: error: the ( of \"model\" is never closed: add a )"));
}

TEST_F(Conformance14, ExtraParenthesis) {
  load("model()\n)\nmodel()");
  EXPECT_THAT(messages(), ElementsAre("w.world:2: error: this ) has no matching ("));
}

TEST_F(Conformance14, EntityWithoutParentheses) {
  load("model\nmodel( position\n name \"x\" )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: \"model\" needs a value on the same line, or a list of "
                          "properties in ( )",
                          "w.world:2: error: \"position\" needs a value on the same line, or a list of "
                          "properties in ( )"));
}

TEST_F(StageParser, AByteOrderMarkIsNoText) {
  const auto spec = load("\xef\xbb\xbfmodel( name \"x\" )");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(name_of(spec, 1), "x");
}

TEST_F(Conformance14, UnquotedString) {
  const auto spec = load("model(\n color red\n name \"x\" )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: the value of \"color\" must be a number, a string or a "
                          "tuple; a string needs quotes: color \"red\""));
  EXPECT_EQ(name_of(spec, 1), "x");  // reading goes on behind the error
}

TEST_F(Conformance14, DefineWithoutBase) {
  load("define foo (\n size [1 1 1] )\nmodel()");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: define foo needs a base, which is a model type or a macro: "
                          "define foo position( ... )"));
}

TEST_F(Conformance14, IncludeWithoutQuotes) {
  load("# one\ninclude map.inc\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: include needs a file name in double quotes: include "
                          "\"map.inc\"",
                          "w.world:2: error: \"map.inc\" needs a value on the same line, or a list of "
                          "properties in ( )"));
}

TEST_F(Conformance14, WordWithoutValueAtTheEnd) {
  load("model()\nfoo");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: \"foo\" needs a value on the same line, or a list of properties "
                          "in ( )"));
}

TEST_F(Conformance14, NamelessBody) {
  load("model(\n ( size [1 1 1] ) )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: a ( is allowed only directly after a word, such as a "
                          "model type or the name of a macro"));
}

TEST_F(Conformance14, ErrorsInAnIncludedFileNameIt) {
  write("a.inc", "# one\n# two\ndefine rob position( size [1 0 1] )\nfoo bar\n");
  load("include \"a.inc\"\n\nrob()\nmodel( pose [1 2] )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "a.inc:4: error: the value of \"foo\" must be a number, a string or a tuple; a string needs "
          "quotes: foo \"bar\"",
          "a.inc:3: error: \"size\" must be above 0 in x and y, found 0",
          "w.world:4: error: \"pose\" needs 4 values [x y z heading], found 2"));
}

TEST_F(Conformance14, ShortTuples) {
  load("model( pose [1 2] )\nmodel( size [1] )\nposition( velocity_bounds [1 2 3] )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: \"pose\" needs 4 values [x y z heading], found 2",
                  "w.world:2: error: \"size\" needs 3 values [x y z], found 1",
                  "w.world:3: error: \"velocity_bounds\" needs 8 values [xmin xmax ymin ymax zmin zmax amin "
                  "amax], found 3"));
}

TEST_F(Conformance14, UnknownType) {
  load("model( lazer() )\npositron()");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: \"lazer\" is neither a model type nor a macro defined above; "
                          "types: actuator, blinkenlight, blobfinder, bumper, camera, fiducial, gripper, "
                          "lightindicator, model, position, radio, ranger (did you mean \"laser\"?)",
                          "w.world:2: error: \"positron\" is neither a model type nor a macro defined above; "
                          "types: actuator, blinkenlight, blobfinder, bumper, camera, fiducial, gripper, "
                          "lightindicator, model, position, radio, ranger (did you mean \"position\"?)"));
}

TEST_F(Conformance14, UnknownProperty) {
  load("speedupp 2\nmodel( colour \"red\"\n wibble 3 )\nranger( samples 3 )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: the world has no property \"speedupp\"; the property is ignored (did you mean "
          "\"speedup\"?)",
          "w.world:2: warning: a model has no property \"colour\"; the property is ignored (did you mean "
          "\"color\"?)",
          "w.world:3: warning: a model has no property \"wibble\"; the property is ignored",
          "w.world:4: warning: a ranger has no property \"samples\"; the property is ignored: write it "
          "inside a sensor( ... )",
          "w.world:4: warning: a ranger without a sensor( ... ) measures nothing: add a sensor( ... )"));
}

TEST_F(Conformance14, UnknownPropertyOfALaser) {
  load(
      "position( laser( noize [0 0 0] ) )\nposition( laser( intensty 1 ) )\nposition( sonar( beam_wdth 3 ) "
      ")");
  const std::string ignored = "the property is ignored (did you mean ";
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: a laser has no property \"noize\"; " + ignored + "\"noise\"?)",
          "w.world:2: warning: a laser has no property \"intensty\"; " + ignored + "\"intensity\"?)",
          "w.world:3: warning: a sonar has no property \"beam_wdth\"; " + ignored + "\"beam_width\"?)"));
}

TEST_F(Conformance14, MissingOrUnreadableBitmap) {
  load("model(\n bitmap \"no.png\" )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: cannot read the image no.png: there is no such file"));
  write("text.png", "no image");
  load("model( bitmap \"text.png\" )");
  EXPECT_THAT(messages(),
              ElementsAre(HasSubstr(
                  "w.world:1: error: text.png is not a readable PNG, JPEG, BMP, PBM, PGM or PPM image")));
}

TEST_F(Conformance14, ColoursNeedNoFile) {  // Stage reads rgb.txt, and ends where there is none
  const auto spec = load("model( color \"SteelBlue\" )");
  EXPECT_EQ(spec.bodies[1].color, (Color{70 / 255.0f, 130 / 255.0f, 180 / 255.0f, 1}));
}

TEST_F(Conformance14, TheDebuggingAidLoads) {
  EXPECT_THAT(load("test 1\nmodel()").bodies, SizeIs(2));
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("w.world:1: warning: properties without effect")));
}

TEST_F(Conformance14, MissingController) {
  load("position(\n ctrl \"wandr 1\" )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: unknown controller \"wandr\"; known: expand, expand_pioneer, "
                          "expand_swarm, script, source, wander (did you mean \"wander\"?)"));
}

TEST_F(Conformance14, PiecesInWrongPlaces) {
  load(
      "block( points 3 )\nsensor()\nmodel( sensor() )\nmodel( block( points 3 model() ) )\n"
      "block( points 3 )");
  const auto found = messages();
  EXPECT_THAT(found,
              testing::IsSupersetOf(
                  {"w.world:1: error: a block must be inside a model, not at the top level",
                   "w.world:2: error: a sensor must be inside a ranger, not at the top level",
                   "w.world:3: error: a sensor must be inside a ranger, not inside a model of type model",
                   "w.world:4: error: a block can contain only properties, not \"model\"",
                   "w.world:5: error: a block must be inside a model, not at the top level"}));
}

TEST_F(Conformance14, FirstDefineWins) {
  const auto spec = load("define a model( name \"first\" )\ndefine a model( name \"second\" )\na()");
  EXPECT_THAT(messages(), ElementsAre("w.world:2: warning: macro \"a\" is already defined at line 1; this "
                                      "later definition is ignored: remove it"));
  EXPECT_EQ(name_of(spec, 1), "first");
}

TEST_F(Conformance14, LastPropertyWins) {
  EXPECT_EQ(name_of(load("model( name \"a\" size [1 1 1] name \"b\" )"), 1), "b");
}

TEST_F(Conformance14, IncludeInABody) {
  write("name.inc", "name \"inside\"\n");
  EXPECT_EQ(name_of(load("model(\n include \"name.inc\"\n size [1 1 1]\n)"), 1), "inside");
}

TEST_F(Conformance14, CommentBeforeTheBody) {
  EXPECT_THAT(load("model # a comment\n\n # another\n (name \"x\"#third\n)").bodies, SizeIs(2));
  EXPECT_THAT(load("define foo # c\n model # d\n ( )\nfoo()").bodies, SizeIs(2));
}

// What must be read.

TEST_F(Conformance14, OverridesInAnInstance) {
  const auto spec =
      load("define box model( name \"box\" size [1 2 3] )\nbox( name \"mine\" )\nbox( size [4 5 6] )\nbox()");
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "mine", "box", "box"));
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("the name \"box\" is already used")));
  EXPECT_EQ(type_of(spec, 1).parts[0].size, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(type_of(spec, 2).parts[0].size, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(type_of(spec, 3).parts[0].size, Eigen::Vector3d(1, 2, 3));
}

TEST_F(Conformance14, MacrosWithChildren) {
  const auto spec = load(
      "define wheel model( size [0.1 0.02 0.1] )\ndefine cart model( wheel() wheel() )\n"
      "define wagon cart( wheel() )\nwagon( wheel( name \"spare\" ) )");
  EXPECT_THAT(part_names(type_of(spec, 1)), ElementsAre("", "model:0", "model:1", "model:2", "spare"));
}

TEST_F(Conformance14, NestedThreeDeep) {
  const auto spec = load("model( name \"a\" model( name \"b\" model( name \"c\" model() ) ) )");
  EXPECT_THAT(part_names(type_of(spec, 1)), ElementsAre("", "b", "b.c", "b.c.model:0"));
}

TEST_F(Conformance14, NumberedNames) {
  load("ranger( spose[0] [1 2 3] spose[1] [ 4 5 6 ] sensor() )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: old syntax: \"spose[k]\" is ignored, as in Stage: write a "
                          "sensor( pose [0.1 0 0 90] range [0 5] fov 15 ) for each transducer"));
}

TEST_F(StageParser, ParsesWhatStageParses) {
  const auto spec = load(
      "define foo model( color \"blue\" )\n"
      "define bar foo( color \"NavyBlue\" model() )\n"
      "bar( model() model( model( name \"deep\" ) ) name \"top\" pose[0] [ 1 2 ] )\n"
      "model(name \"a\"size[1 1 1]pose [1 2 3 4])model( )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:3: warning: a model has no property \"pose[0]\"; the property is ignored",
                          "w.world:4: error: \"size[1\": a blank is needed before the ["));
  ASSERT_THAT(spec.bodies, SizeIs(4));
  EXPECT_EQ(name_of(spec, 1), "top");
  EXPECT_FLOAT_EQ(spec.bodies[1].color.b, 128 / 255.0f);
  EXPECT_THAT(part_names(type_of(spec, 1)), ElementsAre("", "model:0", "model:1", "model:2", "model:2.deep"));
}

TEST_F(StageParser, CountsEveryKindOfLineEnd) {
  for (const std::string end : {"\n", "\r", "\r\n", "\n\r"}) {
    load("# comment" + end + end + "model()" + end + "?" + end);
    EXPECT_THAT(
        messages(),
        ElementsAre("w.world:4: error: unexpected '?': this character may be only in strings and comments"));
  }
}

TEST_F(StageParser, CharactersOfWordProcessors) {
  load("a \u201cred\u201d\n b \u22121\n");
  EXPECT_THAT(
      messages(),
      testing::IsSupersetOf({"w.world:1: error: unexpected quotation mark \u201c: write the straight one, \"",
                             "w.world:1: error: unexpected quotation mark \u201d: write the straight one, \"",
                             "w.world:2: error: unexpected dash \u2212: write the minus sign of ASCII, -"}));
}

TEST_F(StageParser, ALineInLatin1IsRead) {
  const auto spec = load("# \xfc\nmodel( name \"caf\xe9\" )\nmodel( name \"caf\xc3\xa9s\" )\n");
  EXPECT_EQ(name_of(spec, 1), "caf\xc3\xa9");
  EXPECT_EQ(name_of(spec, 2), "caf\xc3\xa9s");
}

TEST_F(StageParser, AFileInUtf16IsOneError) {
  using std::string_view_literals::operator""sv;
  load(
      std::string("\xff\xfe"
                  "s\0i\0z\0e\0 \0[\0001\0"sv));
  EXPECT_THAT(messages(), ElementsAre("w.world: error: the file is encoded in UTF-16: save it in UTF-8"));
}

TEST_F(StageParser, AWrongTupleCausesNoFurtherSyntaxErrors) {
  load("model( pose [1 2\n 0 90] size [1 1 1] )\nmodel( pose [9 9 # far\n 0 0] )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: a tuple must end with ] on the line on which it begins",
                          "w.world:3: error: a tuple must end with ] on the line on which it begins"));
  load("model( wibble [1 [2] 3] name \"a\" )\n");
  EXPECT_THAT(messages(),
              ElementsAre(HasSubstr("w.world:1: warning: a model has no property \"wibble\""),
                          "w.world:1: error: a tuple cannot contain a tuple: remove the inner [ and ]"));
  load("model( pose [1 2 0 0 )\nmodel( size [1 1\n name \"a\" )\n");
  EXPECT_THAT(messages(), testing::IsSupersetOf(
                              {"w.world:1: error: a tuple must end with ] on the line on which it begins",
                               "w.world:2: error: a tuple must end with ] on the line on which it begins"}));
}

TEST_F(StageParser, NulIsAllowedOnlyInComments) {
  using std::string_view_literals::operator""sv;
  load("# \0\nmodel( name \"a\0b\" )\n\0model()\n"sv);
  EXPECT_THAT(messages(), ElementsAre("w.world:2: error: a string contains the byte 0x00: remove this byte",
                                      "w.world:3: error: unexpected byte 0x00: remove this byte"));
  write("a.inc", "model()");
  load("include \"a.inc\0.txt\"\n"sv);
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: a string contains the byte 0x00: remove this byte"));
}

TEST_F(StageParser, LexicalErrors) {
  load("a = 1\nb ; 2\nc { 3\nd '4'\ne \x01\nf \"open\ng 2e-2\nh [1 2\ni [1 [2] 3]\nj [1 two]\n5\n]\n[1 2]\n");
  EXPECT_THAT(
      messages(),
      testing::IsSupersetOf(
          {"w.world:1: error: unexpected '='; a property is written: name value",
           "w.world:2: error: unexpected ';'; a line end or a blank separates properties",
           "w.world:3: error: unexpected '{'; the properties of a model are written in ( )",
           "w.world:4: error: unexpected \"'\"; strings are written in double quotes",
           "w.world:5: error: unexpected byte 0x01: this byte may be only in strings and comments",
           "w.world:6: error: a string must end with \" on the line on which it begins",
           "w.world:7: error: \"2e-2\" is not a number; numbers are written without an exponent and without "
           "a unit, as in 0.02",
           "w.world:8: error: a tuple must end with ] on the line on which it begins",
           "w.world:9: error: a tuple cannot contain a tuple: remove the inner [ and ]",
           "w.world:10: error: \"two\" in a tuple is not a number; a text needs quotes: [\"two\"]",
           "w.world:11: error: the value 5 has no property name before it; a property is written: name value",
           "w.world:12: error: this ] has no matching [",
           "w.world:13: error: this tuple has no property name before it; a property is written: name [1 2 "
           "3]"}));
}

TEST_F(StageParser, TuplesStickToTheirBracket) {
  const auto spec = load("model( pose[1 2 3 90] )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: \"pose[1\": a blank is needed before the ["));
  EXPECT_EQ(spec.bodies[1].pose_world_body.y, 2);
}

TEST_F(StageParser, NumbersAreReadWhole) {
  load(
      "model( ranger_return 1.2.3 )\nmodel( ranger_return --4 )\nmodel( ranger_return + )\n"
      "model( ranger_return \"nan\" )\nmodel( ranger_return 99999999999999999999 )\nmodel( noblocks 0.5 )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: error: \"ranger_return\" needs a number such as 2, -0.5 or .25, found \"1.2.3\"",
          "w.world:2: error: \"ranger_return\" needs a number such as 2, -0.5 or .25, found \"--4\"",
          "w.world:3: error: \"ranger_return\" needs a number such as 2, -0.5 or .25, found \"+\"",
          "w.world:4: error: \"ranger_return\" needs a number such as 2, -0.5 or .25, found \"nan\"",
          "w.world:5: error: \"ranger_return\": 99999999999999999999 is out of range; numbers must be from "
          "-2^53 to 2^53",
          "w.world:6: error: \"noblocks\" needs a whole number, found 0.5"));
  const auto spec = load("model( pose [+1 -.5 2. \"90\"] name 5 )");
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{1, -0.5, 2, k_pi / 2}));
  EXPECT_EQ(name_of(spec, 1), "5");
}

TEST_F(StageParser, DefineInABodyIsAnError) {
  const auto spec = load("model(\n define x model( size [1 1 1] )\n name \"y\" )");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:2: error: define is only allowed at the top level of a file, not inside a model"));
  EXPECT_EQ(name_of(spec, 1), "y");
}

TEST_F(StageParser, IncompleteDefines) {
  load("define 5\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: error: define needs a name and a base, which is a model type or a macro: define robot "
          "position( ... )",
          "w.world:1: error: the value 5 has no property name before it; a property is written: name value"));
  load("define b model\nquit_time 5");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: define b needs a list of properties in ( )"));
}

// Includes.

TEST_F(StageParser, IncludesAreRelativeToTheWorldFile) {
  write("inc/a.inc", "include \"inc/b.inc\"\n");
  write("inc/b.inc", "define rob model( name \"b\" )\n");
  EXPECT_EQ(name_of(load("include \"inc/a.inc\"  # the rest may be a comment\nrob()"), 1), "b");
}

TEST_F(StageParser, AnIncludeMayEndTheFile) {
  write("a.inc", "model( name \"a\" )");
  EXPECT_THAT(load("include \"a.inc\"").bodies, SizeIs(2));
}

TEST_F(StageParser, WhatFollowsAnIncludeIsIgnoredWithAWarning) {
  write("a.inc", "model()\n");
  load("include \"a.inc\" model()\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: the rest of the line after an include is ignored, as in Stage: model()"));
}

TEST_F(StageParser, IncludeCyclesAreReported) {
  write("a.inc", "\ninclude \"b.inc\"\n");
  write("b.inc", "include \"./a.inc\"\n");
  load("include \"a.inc\"\nmodel()");
  EXPECT_THAT(messages(), ElementsAre("b.inc:1: error: include cycle: a.inc -> b.inc -> a.inc"));
}

TEST_F(StageParser, IncludesThatMultiplyAreReported) {
  for (int i = 0; i < 20; ++i)
    write(fmt::format("{}.inc", i), fmt::format("include \"{0}.inc\"\ninclude \"{0}.inc\"\n", i + 1));
  write("20.inc", "");
  load("include \"0.inc\"\n");
  EXPECT_THAT(messages(),
              ElementsAre(EndsWith("too many included files: at most 1000 are allowed, and a "
                                   "file counts each time it is included: merge some of the files")));
}

TEST_F(StageParser, AMissingIncludeIsReported) {
  load("\ninclude \"no.inc\"\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: cannot read the included file no.inc: there is no such file"));
}

TEST_F(StageParser, AMissingIncludeOfStageIsSaidToBeOne) {
  load("include \"pioneer.inc\"\ninclude \"inc/map.inc\"\npioneer2dx( floorplan() )\n");
  const std::string hint =
      ": there is no such file; it comes with Stage: name the folder that has it, such as worlds in the "
      "sources of "
      "Stage, in the environment variable STAGEPATH (in programs: search_path)";
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: error: cannot read the included file pioneer.inc" + hint,
          "w.world:2: error: cannot read the included file inc/map.inc" + hint,
          "w.world:3: error: \"pioneer2dx\" is no model type; pioneer.inc or map.inc may define it as a "
          "macro, but is missing"));
  LoadOptions options;
  options.search_path = {folder() / "nowhere"};
  load("include \"sick.inc\"", options);
  EXPECT_THAT(messages(),
              ElementsAre(HasSubstr("there is no such file, and none of that name in the folders of the "
                                    "search path; it comes with Stage: ")));
}

TEST_F(StageParser, ADanglingLinkIsCalledThat) {
  std::filesystem::create_symlink("../inc/gone.inc", folder() / "map.inc");
  load("include \"map.inc\"");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: cannot read the included file map.inc: this is a link to "
                          "../inc/gone.inc, which does not exist"));
  std::filesystem::create_symlink("gone.png", folder() / "plan.png");
  load("model( bitmap \"plan.png\" )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: cannot read the image plan.png: this is a link to gone.png, "
                          "which does not exist"));
}

TEST_F(StageParser, TheSearchPathIsTriedByBaseName) {
  write("elsewhere/a.inc", "include \"b.inc\"\n");
  write("elsewhere/b.inc", "model( name \"b\" )\n");
  LoadOptions options;
  options.search_path = {folder() / "nowhere", folder() / "elsewhere"};
  // The file found there moves the base of later paths: b.inc lies beside it.
  EXPECT_EQ(name_of(load("include \"inc/a.inc\"\n", options), 1), "b");
  load("include \"c.inc\"\n", options);
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: cannot read the included file c.inc: there is no "
                                      "such file, and none of that name in the folders of the search path"));
}

// Macros.

TEST_F(StageParser, ABaseMayBeDefinedLater) {
  EXPECT_EQ(name_of(load("define a b( name \"x\" )\ndefine b model( name \"y\" )\na()"), 1), "x");
}

TEST_F(StageParser, AMacroMustStandBeforeItsUse) {
  load("a()\ndefine a model()\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(HasSubstr("w.world:1: error: \"a\" is neither a model type nor a macro defined above")));
}

TEST_F(StageParser, AnUnknownBaseIsReportedWhereTheMacroIsDefined) {
  write("robots.inc", "define bot\n  positron( size [1 1 1] )\n");
  load("include \"robots.inc\"\ndefine scout bot()\nscout()\nscout( pose [3 0 0 0] )\nbot()\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(HasSubstr("robots.inc:2: error: \"positron\" is neither a model type nor a macro")));
}

TEST_F(StageParser, ManyModelsMayUseAMacroWithAnUnknownBase) {
  std::string text = "define bot positron()\n";
  for (int i = 0; i < 1900; ++i) text += fmt::format("define macro_with_a_long_name_{} model()\n", i);
  for (int i = 0; i < 100000; ++i) text += "bot()\n";
  load(text);
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("w.world:1: error: \"positron\" is neither a model type")));
}

TEST_F(StageParser, AMacroMayShadowAType) {
  load("define model position()\nmodel()");
  EXPECT_THAT(messages(), IsEmpty());
  load("define model model()\nmodel()");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: macro \"model\" is based on itself: base the macro on a model type"));
}

TEST_F(StageParser, EndlessMacrosAreReported) {
  load("define a b()\ndefine b a()\na()");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: macro \"a\" is based on itself: base the macro on a model type"));
  load("define a model( a() )\na()");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: macro \"a\" contains itself: remove this model from the macro"));
  load("define a model( b() )\ndefine b model( model( a() ) )\na()");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: error: macro \"a\" contains itself: remove this model from the macro"));
}

TEST_F(StageParser, MacrosThatMultiplyAreReported) {
  std::string text = "define a0 model()\n";
  for (int i = 1; i < 40; ++i) text += fmt::format("define a{0} model( a{1}() a{1}() )\n", i, i - 1);
  load(text + "a39()");
  EXPECT_THAT(messages(), ElementsAre("w.world:41: error: with its macros expanded, this model contains more "
                                      "than 20000 models and blocks: use smaller macros"));
}

TEST_F(StageParser, DeepNestingIsReported) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "model(";
  load(text);
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: models and blocks are nested too deep: at most 200 levels are allowed"));
  text = "define a0 model()\n";
  for (int i = 1; i < 1000; ++i) text += fmt::format("define a{} model( a{}() )\n", i, i - 1);
  load(text + "a999()");
  EXPECT_THAT(messages(), ElementsAre("w.world:1001: error: with its macros expanded, this model contains "
                                      "models or blocks nested more than 200 levels deep: nest fewer"));
}

TEST_F(StageParser, LongChainsOfBasesAreFine) {
  std::string text = "define a0 model( name \"x\" )\n";
  for (int i = 1; i < 20000; ++i) text += fmt::format("define a{} a{}()\n", i, i - 1);
  EXPECT_EQ(name_of(load(text + "a19999()"), 1), "x");
}

TEST_F(StageParser, GivesUpOnGarbage) {
  load(std::string(100000, '\0'));
  const auto found = messages();
  ASSERT_THAT(found, SizeIs(51));
  EXPECT_EQ(found.back(),
            "w.world:1: error: stopped after 50 syntax errors; the rest of the file is not read");
}

// Any input: never a crash, never a hang.

const std::vector<std::string>& soup_words() {
  static const std::vector<std::string> words{"model (",
                                              "position (",
                                              "ranger (",
                                              "sensor (",
                                              "block (",
                                              "window (",
                                              "fiducial (",
                                              "gripper (",
                                              "a (",
                                              "b (",
                                              "define a model (",
                                              "define b a (",
                                              "define position b (",
                                              ")",
                                              ")",
                                              ")",
                                              ")",
                                              ")",
                                              "\n",
                                              "\n",
                                              "name \"x\"",
                                              "name \"/g\"",
                                              "name \"\"",
                                              "pose [1 2 3 4]",
                                              "pose [1 2 3]",
                                              "pose [999999 0 0 0]",
                                              "size [0.1 0.2 0.3]",
                                              "size [1 2]",
                                              "size [0 1 1]",
                                              "origin [-0.1 0 0 0]",
                                              "color \"random\"",
                                              "color \"rde\"",
                                              "color_rgba [0 1 0 1]",
                                              "points 3",
                                              "points 900",
                                              "point[0] [0 0]",
                                              "point[1] [1 0]",
                                              "point[2] [0 1]",
                                              "point[7] [0 1]",
                                              "z [0 1]",
                                              "z [1 0]",
                                              "boundary 1",
                                              "noblocks 1",
                                              "bitmap \"x.png\"",
                                              "ctrl \"expand speed=1\"",
                                              "ctrl \"script line\"",
                                              "ctrl [\"wander\" \"x\"]",
                                              "ctrl \"\"",
                                              "drive \"car\"",
                                              "drive 7",
                                              "wheelbase 0",
                                              "range [0 5]",
                                              "range [5 1]",
                                              "fov 180",
                                              "fov -1",
                                              "samples 180",
                                              "samples 0.5",
                                              "noise [1 2 3]",
                                              "update_interval 250",
                                              "update_interval -1",
                                              "unit_length \"cm\"",
                                              "unit_angle \"radians\"",
                                              "quit_time 60",
                                              "interval_sim 0",
                                              "velocity_bounds [-1 1 -1 1 -1 1 -1 1]",
                                              "velocity_bounds [1 -1 1 -1 1 -1 1 -1]",
                                              "stack_children 0",
                                              "paddle_size [0.5 0.1 0.5]",
                                              "paddle_size [5 5 5]",
                                              "ranger_return -1",
                                              "obstacle_return 0",
                                              "alwayson 1",
                                              "mass 3",
                                              "wibble 3",
                                              "include \"w.inc\""};
  return words;
}

void read_soup(const std::string& text) {
  Diagnostics diagnostics;
  const auto spec = load_stage_world("/nowhere/w.world", text, test_registry(), {}, diagnostics);
  for (const engine::BodySpec& body : spec.bodies) RC_ASSERT(body.type.index() < spec.types.size());
  for (const Finding& finding : diagnostics.findings()) RC_ASSERT(!diagnostics.text(finding).empty());
}

RC_GTEST_PROP(StageSoup, AnyBodiesAreReadOrRefused, ()) {
  const auto words =
      *rc::gen::scale(5, rc::gen::container<std::vector<std::string>>(rc::gen::elementOf(soup_words())));
  std::string text;
  std::size_t depth = 0;
  for (const std::string& word : words) {
    if (word == ")" && depth == 0) continue;
    depth += word.ends_with('(');
    depth -= word == ")";
    text += word + ' ';
  }
  read_soup(text + std::string(depth, ')'));
}

RC_GTEST_PROP(StageSoup, TokensInAnyOrderAreReadOrRefused, ()) {
  std::vector<std::string> tokens = soup_words();
  for (const char* token :
       {"model", "define", "include", "[", "]", "(", "\"", "#", "1", "1.2.3", "--", "\xff", ","})
    tokens.emplace_back(token);
  const auto words =
      *rc::gen::scale(5, rc::gen::container<std::vector<std::string>>(rc::gen::elementOf(tokens)));
  std::string text;
  for (const std::string& word : words) text += word + ' ';
  read_soup(text);
}

RC_GTEST_PROP(StageSoup, BytesInAnyOrderAreReadOrRefused, (const std::string& text)) { read_soup(text); }

}  // namespace
}  // namespace troupe::worldio::stage_parser_test
