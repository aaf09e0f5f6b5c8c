// Settings files and dry runs of every command that has them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run_program.h"

namespace pellicle::test {
namespace {

using testing::HasSubstr;

struct Command {
  std::string name;
  std::vector<std::string> flags;  ///< enough for a dry run, some of them not the defaults
  std::string line;                ///< of the settings that are printed then
};

std::ostream& operator<<(std::ostream& out, const Command& command) {
  return out << command.name;
}

class Commands : public testing::TestWithParam<Command> {
 protected:
  Outcome dry_run(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), GetParam().name);
    flags.emplace_back("--dry-run");
    return run(flags, scratch_);
  }
  const Scratch scratch_;
};

TEST_P(Commands, DryRunPrintsSettingsThatReadBackToTheSameBytes) {
  const Outcome typed = dry_run(GetParam().flags);
  ASSERT_EQ(typed.exit_code, 0) << typed.err;
  EXPECT_EQ(typed.err, "");
  EXPECT_THAT(typed.out, HasSubstr(GetParam().line + "\n"));
  EXPECT_THAT(typed.out, HasSubstr("quiet = false\n"));
  std::ofstream(scratch_ / "run.toml") << typed.out;
  const Outcome again = dry_run({"--config", scratch_("run.toml")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, typed.out);
}

TEST_P(Commands, TheCommandLineWinsOverTheFile) {
  std::ofstream(scratch_ / "run.toml") << "quiet = true\nlog-json = true\n";
  auto flags = GetParam().flags;
  flags.insert(flags.end(), {"--config", scratch_("run.toml"), "--quiet=false"});
  const Outcome outcome = dry_run(flags);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("quiet = false\n"));
  EXPECT_THAT(outcome.out, HasSubstr("log-json = true\n"));
}

TEST_P(Commands, FaultsInTheFileNameFileLineAndKey) {
  std::ofstream(scratch_ / "run.toml") << "\nquiet = 3\n";
  const Outcome bad = dry_run({"--config", scratch_("run.toml")});
  EXPECT_EQ(bad.exit_code, 64);
  EXPECT_EQ(bad.out, "");
  EXPECT_THAT(bad.err, HasSubstr("run.toml:2, quiet): '3' is not a choice"));
  std::ofstream(scratch_ / "run.toml") << "qiet = true\n";
  const Outcome unknown = dry_run({"--config", scratch_("run.toml")});
  EXPECT_EQ(unknown.exit_code, 64);
  EXPECT_THAT(unknown.err, HasSubstr("run.toml:1, qiet): 'pellicle " + GetParam().name + "' has no setting"));
  EXPECT_EQ(line_count(unknown.err), 1);
  EXPECT_EQ(dry_run({"--config", scratch_("absent.toml")}).exit_code, 66);
}

TEST_P(Commands, WhatNeitherFileNorCommandLineGivesIsMissing) {
  if (GetParam().name == "segment") return;  // needs no output folder where an output file is named: usage_test.cpp
  std::ofstream(scratch_ / "run.toml") << (GetParam().name == "export" ? "mesh = \"a.ply\"\n" : "quiet = false\n");
  const Outcome outcome = run({GetParam().name, "--config", scratch_("run.toml")}, scratch_);
  EXPECT_EQ(outcome.exit_code, 64);
  EXPECT_THAT(outcome.err, HasSubstr("missing setting"));
  EXPECT_EQ(line_count(outcome.err), 1);
}

INSTANTIATE_TEST_SUITE_P(
    All, Commands,
    testing::Values(
        Command{"segment", {"--detail", "2", "--energy", "edge=0.5"}, "detail = 2"},
        Command{"fit", {"-i", "a.xyz", "-o", "out", "--model", "spline", "--ladder", "10,20"}, "ladder = [10, 20]"},
        Command{"morph", {"a.json", "b.json", "-o", "out", "--from", "-0.5"}, "from = -0.5"},
        Command{"export", {"m.json", "--mesh", "a.ply", "--density", "3"}, "density = 3"},
        Command{"evaluate", {"a.nii", "b.nii", "--tolerance-mm", "0.25"}, "tolerance-mm = 0.25"},
        Command{"phantom", {"-o", "out", "--name", "n", "--shape", "cluster", "--size", "40"}, "size = [40, 40, 40]"},
        Command{"info", {"a.nii", "--spacing", "1,2,0.5"}, "spacing = [1, 2, 0.5]"},
        Command{"report", {"a b", "c", "-o", "r.html"}, "result = [\"a b\", \"c\"]"}));

TEST(ConfigFiles, RunWithoutAnyFlag) {
  const Scratch scratch;
  std::ofstream(scratch / "ball.toml") << "output = \"" << scratch("out") << "\"\nname = \"ball\"\nsize = 24\n"
                                       << "radius = 8\nspacing = [1, 1, 1.5]\nnoise = \"none\"\n";
  const Outcome made = run({"phantom", "--config", scratch("ball.toml")}, scratch);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  ASSERT_EQ(run({"phantom", "-o", scratch("out"), "--name", "same", "--size", "24,24,24", "--radius", "8", "--spacing",
                 "1,1,1.5", "--noise", "none"},
                scratch)
                .exit_code,
            0);
  EXPECT_EQ(read_text(scratch / "out/ball.nii.gz"), read_text(scratch / "out/same.nii.gz"));

  std::ofstream(scratch / "scores.toml") << "truth = \"" << scratch("out/ball_truth.nii.gz") << "\"\nresult = \""
                                         << scratch("out/same_truth.nii.gz") << "\"\n";
  const Outcome scores = run({"evaluate", "--config", scratch("scores.toml")}, scratch);
  EXPECT_EQ(scores.exit_code, 0) << scores.err;
  EXPECT_THAT(scores.out, HasSubstr("dice"));
  std::ofstream(scratch / "info.toml") << "file = \"" << scratch("out/ball.nii.gz") << "\"\njson = true\n";
  EXPECT_THAT(run({"info", "--config", scratch("info.toml")}, scratch).out, testing::StartsWith("{"));
}

TEST(ConfigFiles, AnArgumentKeepsItsPlaceBesideFlags) {
  const Scratch scratch;
  const Outcome outcome = run({"evaluate", "t.nii", "--tolerance-mm", "2", "r.nii", "--dry-run"}, scratch);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::StartsWith("truth = \"t.nii\"\nresult = \"r.nii\"\n"));
  const Outcome three = run({"evaluate", "t.nii", "r.nii", "u.nii", "--dry-run"}, scratch);
  EXPECT_EQ(three.exit_code, 64);
}

}  // namespace
}  // namespace pellicle::test
