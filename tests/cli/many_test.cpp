// Many objects end to end: from a stack to a label map and its table.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.h"

namespace pellicle::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

class ManyObjects : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    data_ = new Scratch;
    const Outcome made =
        run({"phantom", "-o", data_->path().string(), "--name", "cells", "--shape", "cluster", "--count", "6",
             "--radius", "5,7", "--size", "60,60,32", "--spacing", "0.8,0.8,1.4", "--snr", "8", "--seed", "2"},
            *data_);
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  static void TearDownTestSuite() {
    delete data_;
    data_ = nullptr;
  }
  static Outcome segment(const Scratch& scratch, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"segment", "-i", (*data_)("cells.nii.gz"), "-o", scratch("out"), "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, scratch);
  }
  static double f1(const Scratch& scratch) {
    const Outcome outcome = run({"evaluate", (*data_)("cells_truth.nii.gz"), scratch("out/cells_dseg.nii.gz"),
                                 "--multi", "--json", scratch("scores.json"), "--overwrite"},
                                scratch);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(read_text(scratch / "scores.json"))["f1"].get<double>();
  }
  static Scratch* data_;
};
Scratch* ManyObjects::data_ = nullptr;

TEST_F(ManyObjects, FoundUnattended) {
  const Scratch scratch;
  const Outcome outcome = segment(scratch, {"--objects", "many", "--write", "mask,mesh,model,report,qc"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(line_count(outcome.out), 6);
  EXPECT_EQ(f1(scratch), 1.0);
  std::istringstream table(read_text(scratch / "out/cells_dseg.tsv"));
  std::string line;
  ASSERT_TRUE(std::getline(table, line));
  EXPECT_THAT(line, testing::StartsWith("index\tlabel\tname\tvolume_ml\tstatus\t"));
  int rows = 0;
  for (; std::getline(table, line); ++rows) EXPECT_EQ(std::count(line.begin(), line.end(), '\t'), 16) << line;
  EXPECT_EQ(rows, 6);
  for (int label = 1; label <= 6; ++label) {
    EXPECT_TRUE(fs::exists(scratch / fmt::format("out/cells_surface-{:03}.ply", label)));
    EXPECT_TRUE(fs::exists(scratch / fmt::format("out/cells_model-{:03}.json", label)));
  }
  EXPECT_TRUE(fs::exists(scratch / "out/cells_qc.png"));
  const json report = json::parse(read_text(scratch / "out/cells_report.json"));
  EXPECT_EQ(report["objects"].size(), 6U);
  EXPECT_NEAR(report["many"]["typical_radius_mm"].get<double>(), 6.0, 1.5);
  EXPECT_NEAR(report["many"]["z_to_xy_extent"].get<double>(), 1.0, 0.25);
  EXPECT_EQ(report["settings"]["model"], "catmull-clark");
}

TEST_F(ManyObjects, TheSameBytesForAnyNumberOfThreads) {
  const Scratch one, two;
  ASSERT_EQ(segment(one, {"--preset", "nuclei", "--write", "mask", "--threads", "1"}).exit_code, 0);
  ASSERT_EQ(segment(two, {"--preset", "nuclei", "--write", "mask", "--threads", "2"}).exit_code, 0);
  EXPECT_EQ(read_text(one / "out/cells_dseg.nii.gz"), read_text(two / "out/cells_dseg.nii.gz"));
  EXPECT_EQ(read_text(one / "out/cells_dseg.tsv"), read_text(two / "out/cells_dseg.tsv"));
}

TEST_F(ManyObjects, SeedsNameTheObjects) {
  const Scratch scratch;
  const json truth = json::parse(read_text(*data_ / "cells_truth.json"));
  std::ofstream seeds(scratch("seeds.csv"));
  seeds << "x,y,z,r,label,name\n";
  int label = 10;
  for (const auto& object : truth["objects"]) {
    const auto& c = object["center"];
    seeds << fmt::format("{},{},{},5,{},cell {}\n", c[0].get<double>(), c[1].get<double>(), c[2].get<double>(), label,
                         label);
    ++label;
  }
  seeds.close();
  const Outcome outcome = segment(scratch, {"--objects", "many", "--seeds", scratch("seeds.csv"), "--write", "mask"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(f1(scratch), 1.0);
  EXPECT_THAT(read_text(scratch / "out/cells_dseg.tsv"), testing::HasSubstr("\n13\t13\tcell 13\t"));
  // Every label of that map is refined in turn.
  const Outcome refined =
      segment(scratch, {"--objects", "many", "--seed-mask", (*data_)("cells_truth.nii.gz"), "--write", "mask"});
  ASSERT_EQ(refined.exit_code, 0) << refined.err;
  EXPECT_EQ(f1(scratch), 1.0);
}

TEST_F(ManyObjects, PresetAutoSaysWhatItChoseAndDryRunDrawsThePlaces) {
  const Scratch scratch;
  const Outcome dry = segment(scratch, {"--preset", "auto", "--dry-run"});
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_THAT(dry.err, testing::HasSubstr("--preset auto: nuclei, because"));
  EXPECT_THAT(dry.out, testing::HasSubstr("preset = \"nuclei\""));
  EXPECT_THAT(dry.out, testing::HasSubstr("# 6 places to try"));
  EXPECT_THAT(read_text(scratch / "out/cells_seeds.png"), testing::StartsWith("\x89PNG"));
  const Outcome outcome = segment(scratch, {"--preset", "auto", "--write", "mask,report"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(f1(scratch), 1.0);
  const json report = json::parse(read_text(scratch / "out/cells_report.json"));
  EXPECT_EQ(report["preset_auto"]["chosen"], "nuclei");
  EXPECT_GE(report["preset_auto"]["facts"]["blobs"].get<double>(), 5.0);
  EXPECT_EQ(report["settings"]["preset"], "nuclei");
}

TEST_F(ManyObjects, NoObjectIsNoError) {
  const Scratch scratch;
  const Outcome outcome = run({"segment", "-i", std::string(PELLICLE_SOURCE_DIR) + "/tests/corpus/constant.nii.gz",
                               "-o", scratch("out"), "--name", "cells", "--objects", "many", "--write", "mask,report"},
                              scratch);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, testing::HasSubstr("no object found"));
  EXPECT_TRUE(fs::exists(scratch / "out/cells_dseg.nii.gz"));
  EXPECT_TRUE(json::parse(read_text(scratch / "out/cells_report.json"))["objects"].empty());
}

}  // namespace
}  // namespace pellicle::test
