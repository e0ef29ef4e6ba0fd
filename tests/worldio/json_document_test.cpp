#include "worldio/json/json_document.hpp"

#include "tests/worldio/json_test_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio::json_document_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Parsed {
  Diagnostics diagnostics;
  std::optional<JsonNode> root;
  std::vector<std::string> errors;

  explicit Parsed(std::string_view text) {
    root = parse_json(text, {diagnostics.files()->add("maze.json"), 0}, false, diagnostics);
    errors = findings(diagnostics);
  }
};

std::string error(std::string_view text) {
  const Parsed parsed(text);
  EXPECT_FALSE(parsed.root);
  return parsed.errors.empty() ? std::string("none") : parsed.errors[0];
}

TEST(JsonDocument, KnowsTheLineOfEveryValue) {
  const Parsed parsed(
      "{\n"
      "  \"a\": 1,\n"
      "  \"b\": 2.5\n"
      ",\n"
      "  \"c\": [\n"
      "    3\n"
      "    ,\"x\",\n"
      "    true], \"d\": {\n"
      "    \"e\":\n"
      "      null}}\n");
  ASSERT_THAT(parsed.errors, IsEmpty());
  const JsonNode& root = *parsed.root;
  EXPECT_EQ(root.where.line, 1u);
  EXPECT_EQ(root.find("a")->where.line, 2u);
  EXPECT_EQ(root.find("b")->where.line, 3u);  // the number ends with its line
  EXPECT_EQ(root.find("c")->where.line, 5u);
  const JsonNode::List& list = *root.find("c")->list();
  EXPECT_EQ(list[0].where.line, 6u);
  EXPECT_EQ(list[1].where.line, 7u);
  EXPECT_EQ(list[2].where.line, 8u);
  EXPECT_EQ(root.find("d")->where.line, 8u);
  EXPECT_EQ((*root.find("d")->object())[0].where.line, 9u);  // the key
  EXPECT_EQ(root.find("d")->find("e")->where.line, 10u);     // its value
  EXPECT_EQ(std::get<std::int64_t>(root.find("a")->value), 1);
  EXPECT_EQ(std::get<double>(root.find("b")->value), 2.5);
}

TEST(JsonDocument, LinesEndWithLfOrCrOrBoth) {
  for (const std::string end : {"\n", "\r", "\r\n"}) {
    const Parsed parsed("{" + end + "\"a\": 1," + end + end + "\"b\": 2" + end + ", \"c\": [" + end + "3]}");
    ASSERT_THAT(parsed.errors, IsEmpty());
    EXPECT_EQ(parsed.root->find("a")->where.line, 2u);
    EXPECT_EQ(parsed.root->find("b")->where.line, 4u);
    EXPECT_EQ(parsed.root->find("c")->where.line, 5u);
    EXPECT_EQ(parsed.root->find("c")->list()->front().where.line, 6u);
    EXPECT_EQ(error("{" + end + end + " \"a\" 1}"),
              "maze.json:3: error: column 6: expected a colon after the key \"a\", found 1");
    EXPECT_EQ(error(end + "[" + end + "1"),
              "maze.json:3: error: column 2: the text ends too early: the [ of line 2 has no closing ]");
    EXPECT_EQ(error("{" + end + "\"a\": \"b" + end + "\"}"),
              "maze.json:2: error: column 6: this string has no closing quotation mark on its line; a line "
              "break in a string is written as \\n");
    EXPECT_EQ(error("{" + end + "'b" + end + "'}"),
              "maze.json:2: error: column 1: JSON has no single quotes: write strings in double quotes, \"");
    EXPECT_EQ(error("[" + end + std::string("\0]", 2)),
              "maze.json:2: error: the text contains a NUL byte (U+0000), which is not allowed in JSON");
  }
}

TEST(JsonDocument, KeepsWholeNumbersWhole) {
  const Parsed parsed("[-9223372036854775808, 9223372036854775807, 18446744073709551615, 1e3]");
  const JsonNode::List& list = *parsed.root->list();
  EXPECT_EQ(std::get<std::int64_t>(list[0].value), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(std::get<std::int64_t>(list[1].value), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(std::get<std::uint64_t>(list[2].value), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(std::get<double>(list[3].value), 1000);
}

TEST(JsonDocument, SyntaxErrorsSayWhatToWriteInstead) {
  const std::string no_comments = "JSON has no comments: remove this comment";
  const std::string unclosed =
      "this string has no closing quotation mark on its line; a line break in a string is written as \\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"{\n  // one\n  \"a\": 1\n}", "2: error: column 3: " + no_comments},
      {"{\n  \"a\": 1, /* one */\n  \"b\": 2\n}", "2: error: column 11: " + no_comments},
      {"{\n  \"a\": 1 // one\n}", "2: error: column 10: " + no_comments},
      {"# one\n{}", "1: error: column 1: " + no_comments},
      {"{\n  \"a\": 1,\n}",
       "2: error: column 9: JSON has no trailing commas: remove this comma before the }"},
      {"[1,\n2, ]", "2: error: column 2: JSON has no trailing commas: remove this comma before the ]"},
      {"[1,, 2]", "1: error: column 4: found , after a comma: remove one of the two"},
      {"[, 2]", "1: error: column 2: expected a value, found ,"},
      {"{\n  \"a\": 1\n  \"b\": 2\n}", "3: error: column 3: a comma is missing before \"b\""},
      {"[1 2]", "1: error: column 4: a comma is missing before 2"},
      {"[1 {}]", "1: error: column 4: a comma is missing before {"},
      {"[1; 2]", "1: error: column 3: expected a comma or ], found ;"},
      {"[1\n}", "2: error: column 1: expected a comma or ], which closes the [ of line 1, found }"},
      {"[\"say \"hi\"\"]",
       "1: error: column 8: expected a comma or ], found hi; a quotation mark in a string is written as "
       "\\\""},
      {"{'a': 1}", "1: error: column 2: JSON has no single quotes: write \"a\""},
      {"{\"a\": 'b c'}", "1: error: column 7: JSON has no single quotes: write \"b c\""},
      {"{\"a\": 'b\n}", "1: error: column 7: JSON has no single quotes: write strings in double quotes, \""},
      {"{a: 1}", "1: error: column 2: a key must be in double quotes: write \"a\""},
      {"{1: 1}", "1: error: column 2: expected a key in double quotes, found 1"},
      {"{\"a\" = 1}", "1: error: column 6: expected a colon after the key \"a\", found ="},
      {"{\"gr\u00fcn\": 1, \"\u00fc\" 1}",
       "1: error: column 17: expected a colon after the key \"\u00fc\", found 1"},
      {"{\"a\": }", "1: error: column 7: expected a value after the colon, found }"},
      {"{\n\"a\": NaN}", "2: error: column 6: JSON has no NaN: write a finite number"},
      {"[-Infinity]", "1: error: column 2: JSON has no -Infinity: write a finite number"},
      {"[inf]", "1: error: column 2: JSON has no inf: write a finite number"},
      {"[True]", "1: error: column 2: expected a value, found True: write true"},
      {"[None]", "1: error: column 2: expected a value, found None: write null"},
      {"[red]", "1: error: column 2: expected a value, found red: a text must be in double quotes"},
      {"[.5]", "1: error: column 2: .5 is not a number of JSON: write a digit before the point, as in 0.5"},
      {"[1.]", "1: error: column 2: 1. is not a number of JSON: write a digit after the point, as in 1.0"},
      {"[+1]", "1: error: column 2: +1 is not a number of JSON: write it without +"},
      {"[01]", "1: error: column 2: 01 is not a number of JSON: write it without the leading 0"},
      {"[0x1f]", "1: error: column 2: 0x1f is not a number of JSON: write it in decimal digits"},
      {"[1m]", "1: error: column 2: 1m is not a number of JSON: numbers are written as in 12, -0.5 or 2e-3"},
      {"{\n\"a\": \"b\n\"}", "2: error: column 6: " + unclosed},
      {"[\"b", "1: error: column 2: " + unclosed},
      {"[\"a\tb\"]", "1: error: column 4: a string contains a tab: write it as \\t"},
      {"[\"C:\\maps\"]",
       "1: error: column 5: a backslash in a string must begin an escape sequence, and JSON has no \\m: "
       "write "
       "a backslash as \\\\"},
      {"[\"\\u12\"]",
       "1: error: column 3: four hexadecimal digits must follow \\u in a string; a backslash is written as "
       "\\\\"},
      {"[\"\\ud800\"]",
       "1: error: column 3: \\ud800 to \\udfff must come in pairs, which stand for one character"},
      {"{\n\"a\": [1,\n", "3: error: column 1: the text ends too early: the [ of line 2 has no closing ]"},
      {"", "1: error: column 1: the text is empty: expected a JSON value, such as an object in braces {}"},
      {"{} {}",
       "1: error: column 4: found { after the end of the JSON value: remove it, or remove a closing bracket "
       "before it"},
      {"\xef\xbb\xbf[1 2]", "1: error: column 4: a comma is missing before 2"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(error(text), "maze.json:" + expected) << text;
  using std::string_view_literals::operator""sv;
  EXPECT_EQ(error("{\"a\": 1}\n\0garbage {{{"sv),
            "maze.json:2: error: the text contains a NUL byte (U+0000), which is not allowed in JSON");
}

TEST(JsonDocument, SyntaxErrorsOfTextsWithoutAFileNameTheLineOfTheText) {
  const auto error_of = [](std::string_view text) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse_json(text, {diagnostics.files()->add("c.h5"), 0}, true, diagnostics));
    return findings(diagnostics).at(0);
  };
  EXPECT_EQ(error_of("[1 2]"), "c.h5: error: column 4: a comma is missing before 2");
  EXPECT_EQ(error_of("[1\n2]"), "c.h5: error: line 2, column 1: a comma is missing before 2");
}

TEST(JsonDocument, TooLargeNumbersHaveAPointer) {
  const std::string limits = "1e999 is too large: numbers are from -1.7e308 to 1.7e308";
  EXPECT_EQ(error("{\n\"a\": 1e999\n}"), "maze.json:2: error: /a: " + limits);
  EXPECT_EQ(error("{\"a\": [1, {\"b/c\": [[2], [3],\n1e999]}]}"),
            "maze.json:2: error: /a/1/b~1c/2: " + limits);
  EXPECT_EQ(error("1e999"), "maze.json:1: error: " + limits);
}

TEST(JsonDocument, CharactersThatAreNotAsciiAreNamedWhole) {
  EXPECT_EQ(error("{\"a\": 1,\n \u201cb\u201d: 2}"),
            "maze.json:2: error: column 2: unexpected quotation mark \u201c: write the straight one, \"");
  EXPECT_EQ(error("{\"a\": \u22121}"),
            "maze.json:1: error: column 7: unexpected dash \u2212: write the minus sign of ASCII, -");
  EXPECT_EQ(error("{\"a\":\u00a01}"),
            "maze.json:1: error: column 6: unexpected blank U+00A0: write an ordinary blank");
  EXPECT_EQ(error("{\"a\": t\u00fc}"),
            "maze.json:1: error: column 8: unexpected character U+00FC (\u00fc): it may be only in strings");
  EXPECT_EQ(error("{\"a\":\n\"\xff\"}"),
            "maze.json:2: error: column 2: a string contains bytes that are not valid UTF-8: save the file "
            "in UTF-8");
  using std::string_view_literals::operator""sv;
  EXPECT_EQ(error("{\0\n\0}\0"sv), "maze.json: error: the file is encoded in UTF-16: save it in UTF-8");
}

TEST(JsonDocument, RepeatedKeysAreErrors) {
  EXPECT_THAT(Parsed("{\n\"a\": 1,\n\"b\": {\"a\": 2},\n\"a\": 3,\n\"a\": 4}").errors,
              ElementsAre("maze.json:4: error: repeated key \"a\": first given on line 2",
                          "maze.json:5: error: repeated key \"a\": first given on line 2"));
}

TEST(JsonDocument, DepthIsBounded) {
  EXPECT_TRUE(Parsed(std::string(64, '[') + std::string(64, ']')).root);
  EXPECT_THAT(Parsed("\n" + std::string(100000, '[')).errors,
              ElementsAre("maze.json:2: error: lists and objects are nested too deeply: at most 64 "
                          "levels are allowed"));
}

TEST(JsonDocument, SetReplacesAndAdds) {
  Parsed parsed(R"({"a": {"b": [1, 2]}, "x/y": 1, "m~n": 2})");
  Diagnostics& diagnostics = parsed.diagnostics;
  set_json_value(*parsed.root, "/a/b/1", "7", diagnostics);
  set_json_value(*parsed.root, "/a/b/-", "8", diagnostics);
  set_json_value(*parsed.root, "/a/b/3", "[9]", diagnostics);
  set_json_value(*parsed.root, "/a/new", "red", diagnostics);
  set_json_value(*parsed.root, "/x~1y", "{\"k\": null}", diagnostics);
  set_json_value(*parsed.root, "/m~0n", "\"3\"", diagnostics);
  EXPECT_THAT(findings(diagnostics), IsEmpty());
  const JsonNode::List& list = *parsed.root->find("a")->find("b")->list();
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(std::get<std::int64_t>(list[1].value), 7);
  EXPECT_EQ(std::get<std::int64_t>(list[2].value), 8);
  EXPECT_EQ(std::get<std::int64_t>((*list[3].list())[0].value), 9);
  EXPECT_EQ(*parsed.root->find("a")->find("new")->text(), "red");  // not JSON: a text
  EXPECT_NE(parsed.root->find("x/y")->find("k"), nullptr);
  EXPECT_EQ(*parsed.root->find("m~n")->text(), "3");
}

TEST(JsonDocument, SetTakesNoBrokenListOrObjectAsAText) {
  Parsed parsed(R"({"a": 1})");
  for (const char* value : {"[1, 2", " {\"k\": 1e400}", "{\"k\": 1, \"k\": 2}"})
    set_json_value(*parsed.root, "/a", value, parsed.diagnostics);
  EXPECT_THAT(findings(parsed.diagnostics),
              ElementsAre(HasSubstr("--set /a: error: "), HasSubstr("--set /a: error: "),
                          "--set /a: error: repeated key \"k\""));
  EXPECT_EQ(std::get<std::int64_t>(parsed.root->find("a")->value), 1);
}

TEST(JsonDocument, SetSaysWhatIsWrong) {
  Parsed parsed(R"({"count": 3, "list": [{"name": "a"}]})");
  Diagnostics& diagnostics = parsed.diagnostics;
  for (const char* pointer :
       {"", "count", "/list/1/name", "/list/2", "/list/x", "/lst/0", "/count/x", "/a~2"})
    set_json_value(*parsed.root, pointer, "1", diagnostics);
  EXPECT_THAT(
      findings(diagnostics),
      ElementsAre(
          "--set : error: this is not a JSON pointer: it must begin with /, as in /populations/0/count, and "
          "contain ~ only as ~0 or ~1",
          "--set count: error: this is not a JSON pointer: it must begin with /, as in /populations/0/count, "
          "and "
          "contain ~ only as ~0 or ~1",
          "--set /list/1/name: error: /list is a list of length 1, whose entries are counted from 0: there "
          "is "
          "no /list/1",
          "--set /list/2: error: /list is a list of length 1, whose entries are counted from 0: there is "
          "no /list/2",
          "--set /list/x: error: /list is a list: \"x\" is neither an index nor \"-\", which appends an "
          "entry",
          "--set /lst/0: error: the world has no key \"lst\" (did you mean \"list\"?)",
          "--set /count/x: error: /count is the number 3, not an object or a list: there is no /count/x",
          "--set /a~2: error: this is not a JSON pointer: it must begin with /, as in /populations/0/count, "
          "and "
          "contain ~ only as ~0 or ~1"));
}

TEST(JsonDocument, SetNamesTheIndexOfAnEntryThatThePointerCallsByItsName) {
  Parsed parsed(R"({"list": [3, {"name": 4}, {"kind": "x", "name": "eye"}]})");
  for (const char* pointer : {"/list/eye/range_m", "/list/x", "/list/4"})
    set_json_value(*parsed.root, pointer, "1", parsed.diagnostics);
  const std::string neither = "is neither an index nor \"-\", which appends an entry";
  EXPECT_THAT(
      findings(parsed.diagnostics),
      ElementsAre(
          "--set /list/eye/range_m: error: /list is a list: \"eye\" " + neither +
              "; the entry called \"eye\" is /list/2",
          "--set /list/x: error: /list is a list: \"x\" " + neither,
          "--set /list/4: error: /list is a list of length 3, whose entries are counted from 0: there "
          "is no /list/4"));
}

TEST(JsonDocument, SetNamesTheTypeFromWhichATypeInheritsTheKeyOfThePointer) {
  Parsed parsed(R"({"types": {"bot": {"drive": {}, "size_m": [1, 1, 1]}, "scout": {"extends": "bot"},
      "spy": {"extends": "scout", "device": {}}, "a": {"extends": "b"}, "b": {"extends": "a"}}})");
  for (const char* pointer :
       {"/types/spy/drive/period_s", "/types/spy/devise/name", "/types/a/drive/period_s", "/types/spy/color"})
    set_json_value(*parsed.root, pointer, "1", parsed.diagnostics);
  EXPECT_THAT(
      findings(parsed.diagnostics),
      ElementsAre(
          "--set /types/spy/drive/period_s: error: /types/spy has no key \"drive\" of its own: change "
          "the inherited key in /types/bot, or add a \"drive\" to this type",
          "--set /types/spy/devise/name: error: /types/spy has no key \"devise\" (did you mean "
          "\"device\"?)",
          "--set /types/a/drive/period_s: error: /types/a has no key \"drive\": to add it, set "
          "/types/a/drive as "
          "a whole"));
}

}  // namespace
}  // namespace troupe::worldio::json_document_test
