#include "tests/apps/program.hpp"

#include <cstdio>
#include <memory>

namespace troupe::apps::shell_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

class Shell : public ProgramTest {
 protected:
  std::string printed(const std::vector<std::string>& arguments) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out;
  }

  /// The words that bash offers for the last of these.
  std::vector<std::string> offered(const std::vector<std::string>& words) {
    write("completion.bash", printed({"completion", "bash"}));
    std::string line = "source '" + path("completion.bash").string() + "'; COMP_WORDS=(";
    for (const std::string& word : words) line += "'" + word + "' ";
    line +=
        "); COMP_CWORD=" + std::to_string(words.size() - 1) + "; _troupe; printf '%s\\n' \"${COMPREPLY[@]}\"";
    write("line.bash", line);
    const std::string command = "bash '" + path("line.bash").string() + "'";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::string out;
    for (int c = 0; pipe && (c = std::fgetc(pipe.get())) != EOF;) out += static_cast<char>(c);
    return lines_of(out);
  }
};

TEST_F(Shell, BashCompletesCommandsOptionsAndChoices) {
  EXPECT_THAT(offered({"troupe", "re"}), ::testing::IsSupersetOf({"resume", "repair"}));
  EXPECT_THAT(offered({"troupe", "run", "--rat"}), UnorderedElementsAre("--rate"));
  EXPECT_THAT(offered({"troupe", "run", "--ra"}), ::testing::IsSupersetOf({"--raytracer", "--rate"}));
  EXPECT_THAT(offered({"troupe", "run", "--raytracer", "g"}), ElementsAre("grid"));
  EXPECT_THAT(offered({"troupe", "run", "--simd", "avx"}), UnorderedElementsAre("avx2", "avx512"));
  EXPECT_THAT(offered({"troupe", "run", "--simd", "sve"}),
              UnorderedElementsAre("sve", "sve2", "sve_256", "sve2_128"));
  EXPECT_THAT(offered({"troupe", "describe", "blob"}), ::testing::Contains("blobfinder"));
  EXPECT_THAT(offered({"troupe", "describe", "popu"}), ::testing::Contains("populations"));
  EXPECT_THAT(offered({"troupe", "describe", "gripp"}), ElementsAre("gripper", "gripper_return"))
      << "a kind, a key";
  EXPECT_THAT(offered({"troupe", "describe", "quit_"}), ElementsAre("quit_time_s"));
  write("follow.py", "");
  EXPECT_THAT(offered({"troupe", "run", "--controller", path("fol").string()}),
              ElementsAre(path("follow.py").string()));
  EXPECT_THAT(offered({"troupe", "diff", "--acr"}),
              UnorderedElementsAre("--across-domains", "--across-runs"));
}

TEST_F(Shell, EveryOptionOfTheHelpStandsInEachScriptAndInTheManual) {
  const std::string help = printed({"run", "--help"});
  const std::string bash = printed({"completion", "bash"});
  const std::string zsh = printed({"completion", "zsh"});
  const std::string fish = printed({"completion", "fish"});
  const std::string manual = printed({"manual"});
  std::size_t options = 0;
  for (const std::string& line : lines_of(help)) {
    if (!line.starts_with("  --")) continue;
    ++options;
    const std::string name = line.substr(4, line.find_first_of(" ,", 4) - 4);
    EXPECT_THAT(bash, HasSubstr("--" + name));
    EXPECT_THAT(zsh, HasSubstr("--" + name + "["));
    EXPECT_THAT(fish, HasSubstr("-l " + name + " "));
    std::string in_roff = "\\fB\\-\\-";
    for (const char c : name) in_roff += c == '-' ? std::string("\\-") : std::string(1, c);
    EXPECT_THAT(manual, HasSubstr(in_roff + "\\fR"));
  }
  EXPECT_GT(options, 20u);
}

TEST_F(Shell, TheManualIsAPageWithoutWhatRoffWouldMisread) {
  const std::string manual = printed({"manual"});
  EXPECT_THAT(manual, StartsWith(".TH TROUPE 1 "));
  EXPECT_THAT(manual, AllOf(HasSubstr("\n.SH NAME\n"), HasSubstr("\n.SS troupe run\n"),
                            HasSubstr("\n.SH ENVIRONMENT\n")));
  for (const std::string variable : {"TROUPE_PLUGIN_PATH", "STAGEPATH", "TROUPE_SIMD", "TROUPE_PYTHON",
                                     "TROUPE_MPI", "SLURM_CPUS_PER_TASK"})
    EXPECT_THAT(manual, HasSubstr("\n.B " + variable + "\n"));
  for (const std::string& line : lines_of(manual))
    if (line.starts_with('.') || line.starts_with('\'')) {
      EXPECT_THAT(line, ::testing::MatchesRegex(R"(\.(TH|SH|SS|TP|PP|br|nf|fi|B)( .*)?)"));
    }
}

TEST_F(Shell, AnUnknownShellIsRefused) {
  const Outcome outcome = troupe({"completion", "tcsh"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(lines_of(outcome.err), ElementsAre("troupe completion: error: SHELL: \"tcsh\" is not bash, zsh "
                                                 "or fish; see troupe completion --help"));
}

}  // namespace
}  // namespace troupe::apps::shell_test
