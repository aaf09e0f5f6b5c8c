// A batch end to end on small phantoms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <thread>

#include "run_program.h"

namespace pellicle::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

class Batch : public testing::Test {
 protected:
  void make_cases() const {
    for (const std::string name : {"a", "b"}) {
      const Outcome made = run({"phantom", "-o", scratch_.path().string(), "--name", name, "--shape", "sphere",
                                "--radius", "5", "--size", "20,20,20", "--snr", "10", "--contrast", "20,100"},
                               scratch_);
      EXPECT_EQ(made.exit_code, 0) << made.err;
    }
    std::ofstream(scratch_ / "broken.nii") << "no volume";
    std::ofstream(scratch_ / "m.csv")
        << "name,input,seed-sphere\none,a.nii.gz,\"0,0,0,3\"\nbroken,broken.nii,\ntwo,b.nii.gz,\"1,0,0,3\"\n";
  }
  std::vector<std::string> command(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> words{"batch", scratch_("m.csv"), "-o",    scratch_(out), "--detail",
                                   "0",     "--preset",        "bright"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Scratch scratch_;
};

TEST_F(Batch, GivesTheFilesOfSingleRunsAndGoesOnAfterAnInterrupt) {
  make_cases();
  const Outcome whole = run(command("whole", {"--keep-going", "--jobs", "2"}), scratch_);
  EXPECT_EQ(whole.exit_code, 1);
  EXPECT_EQ(line_count(whole.out), 3);
  EXPECT_THAT(whole.out, HasSubstr("broken n/a failed"));
  EXPECT_THAT(whole.err, HasSubstr("failed (broken): "));
  const std::string table = read_text(scratch_ / "whole/batch.tsv");
  EXPECT_EQ(line_count(table), 4);
  EXPECT_THAT(table, HasSubstr("\nbroken\tfailed\t65\t"));

  const Outcome single = run({"segment", "-i", scratch_("a.nii.gz"), "-o", scratch_("single"), "--name", "one",
                              "--seed-sphere", "0,0,0,3", "--detail", "0", "--preset", "bright"},
                             scratch_);
  ASSERT_LE(single.exit_code, 3) << single.err;
  for (const std::string file : {"one_mask.nii.gz", "one_surface.ply", "one_model.json"}) {
    EXPECT_EQ(read_text(scratch_ / ("whole/one/" + file)), read_text(scratch_ / ("single/" + file))) << file;
  }

  const pid_t child = start(command("stopped", {"--keep-going"}), scratch_);
  while (!fs::exists(scratch_ / "stopped/batch.tsv")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(child, SIGINT);
  const Outcome stopped = finish(child, scratch_);
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_EQ(line_count(read_text(scratch_ / "stopped/batch.tsv")), 4);
  EXPECT_EQ(run(command("stopped", {"--keep-going", "--resume"}), scratch_).exit_code, 1);
  for (const std::string file : {"one/one_mask.nii.gz", "two/two_surface.ply", "two/two_model.json"}) {
    EXPECT_EQ(read_text(scratch_ / ("whole/" + file)), read_text(scratch_ / ("stopped/" + file))) << file;
  }
}

TEST_F(Batch, WrongUseIsOneLineAndTouchesNothing) {
  std::ofstream(scratch_ / "m.csv") << "input\na.nii.gz\n";
  std::ofstream(scratch_ / "twice.csv") << "name,input\na,a.nii.gz\na,b.nii.gz\n";
  const std::vector<std::pair<std::vector<std::string>, int>> wrong{
      {command("out", {"--shard", "3/2"}), 64},
      {command("out", {"--jobs", "0"}), 64},
      {command("out", {"--resume", "--overwrite"}), 64},
      {command("out", {"--polarity", "blue"}), 64},
      {command("out", {"--name", "x"}), 64},
      {command("m.csv", {}), 73},
      {{"batch", scratch_("m.csv")}, 64},
      {{"batch", scratch_("none.csv"), "-o", scratch_("out")}, 66},
      {{"batch", scratch_("*.mha"), "-o", scratch_("out")}, 66},
      {{"batch", scratch_("twice.csv"), "-o", scratch_("out")}, 64}};
  for (const auto& [words, code] : wrong) {
    const Outcome outcome = run(words, scratch_);
    EXPECT_EQ(outcome.exit_code, code) << testing::PrintToString(words) << outcome.err;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(fs::exists(scratch_ / "out"));
  }
}

}  // namespace
}  // namespace pellicle::test
