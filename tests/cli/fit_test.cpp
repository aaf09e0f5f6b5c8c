// pellicle fit as a user runs it: files, table, exit codes.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/base/random.h"
#include "run_program.h"

namespace pellicle::test {
namespace {

using nlohmann::json;

/// Points evenly spread over an ellipsoid of half axes 10, 14, 20 mm.
std::string ellipsoid_points(int count) {
  std::ostringstream text;
  text.precision(12);
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / count, r = std::sqrt(1.0 - z * z), angle = 2.399963229728653 * k;
    text << 10.0 * r * std::cos(angle) << " " << 14.0 * r * std::sin(angle) << " " << 20.0 * z << "\n";
  }
  return text.str();
}

/// The same on meridians and parallels, for interpolation.
std::string ellipsoid_grid(int columns, int rows) {
  std::ostringstream text;
  text.precision(17);
  text << "u_index,v_index,x,y,z\n";
  for (int l = 0; l < rows; ++l) {
    for (int k = 0; k < columns; ++k) {
      const double u = 2.0 * std::numbers::pi * k / columns, v = std::numbers::pi * l / (rows - 1);
      const double s = l == 0 || l == rows - 1 ? 0.0 : std::sin(v);
      text << k << "," << l << "," << 10.0 * s * std::cos(u) << "," << 14.0 * s * std::sin(u) << ","
           << 20.0 * std::cos(v) << "\n";
    }
  }
  return text.str();
}

json report_in(const Scratch& scratch, const std::string& name) {
  return json::parse(read_text(scratch / ("out/" + name + "_report.json")));
}

TEST(Fit, PointsToModelMeshAndReport) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(800);
  const Outcome outcome =
      run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("out"), "--model", "spline", "--size", "6,4"}, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(line_count(outcome.out), 2) << outcome.out;
  for (const char* name : {"out/egg_model.json", "out/egg_surface.ply", "out/egg_report.json"}) {
    EXPECT_TRUE(std::filesystem::exists(scratch / name)) << name;
  }
  const json report = report_in(scratch, "egg");
  EXPECT_EQ(report["object"]["status"], "ok");
  EXPECT_EQ(report["object"]["self_intersections"], 0);
  EXPECT_EQ(report["object"]["genus"], 0);
  EXPECT_TRUE(report["object"]["watertight"].get<bool>());
  EXPECT_NEAR(report["input"]["diameter_mm"].get<double>(), 40.0, 0.2);
  EXPECT_TRUE(report["object"]["data_to_surface"]["rms_percent"].get<double>() < 0.1);
  EXPECT_NEAR(report["object"]["volume_ml"].get<double>(), 4.0 / 3.0 * std::numbers::pi * 2.8, 0.05);
  EXPECT_EQ(report["inputs"][0]["sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(report["outputs"].size(), 2U);
  // The files may be used: the model is exported, the mesh fitted again.
  EXPECT_EQ(run({"export", scratch("out/egg_model.json"), "--mesh", scratch("again.stl"), "--density", "3"}, scratch)
                .exit_code,
            0);
  EXPECT_EQ(
      run({"fit", "-i", scratch("again.stl"), "-o", scratch("out2"), "--detail", "1", "--write", "report"}, scratch)
          .exit_code,
      0);
  EXPECT_FALSE(std::filesystem::exists(scratch / "out2/again_model.json"));
}

TEST(Fit, TheToleranceTakesTheFewestControlPoints) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(500);
  const Outcome outcome =
      run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("out"), "--tolerance-percent", "1"}, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json report = report_in(scratch, "egg");
  const json& levels = report["levels"];
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
    EXPECT_TRUE(levels[i]["data_to_surface"]["rms_percent"].get<double>() > 1.0);
  }
  EXPECT_TRUE(report["object"]["data_to_surface"]["rms_percent"].get<double>() <= 1.0);
}

TEST(Fit, OfGridsThatMeetTheToleranceTheCoarsestIsKept) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(500);
  ASSERT_EQ(
      run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("egg"), "--model", "spline", "--write", "mesh"}, scratch)
          .exit_code,
      0);
  const Outcome outcome = run({"fit", "-i", scratch("egg/egg_surface.ply"), "-o", scratch("out"), "--model",
                               "catmull-clark", "--tolerance-percent", "0.05"},
                              scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json report = report_in(scratch, "egg_surface");
  const json& kept = report["object"];
  EXPECT_TRUE(kept["data_to_surface"]["rms_percent"].get<double>() <= 0.05);
  int missed = 0;
  for (const json& level : report["levels"]) {
    const bool meets = level["data_to_surface"]["rms_percent"].get<double>() <= 0.05;
    missed += meets ? 0 : 1;
    EXPECT_TRUE(!meets || level["model"]["control_points"] >= kept["model"]["control_points"]) << level["name"];
  }
  EXPECT_TRUE(missed > 0);  // else nothing was chosen between
}

TEST(Fit, AMissedToleranceIsExitCodeThreeAndFilesAreThere) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(500);
  const Outcome outcome =
      run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("out"), "--tolerance-mm", "1e-9", "--detail", "0"}, scratch);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(report_in(scratch, "egg")["object"]["status"], "tolerance_missed");
  EXPECT_TRUE(std::filesystem::exists(scratch / "out/egg_model.json"));
}

TEST(Fit, AGridIsInterpolated) {
  const Scratch scratch;
  std::ofstream(scratch / "grid.csv") << ellipsoid_grid(8, 7);
  const Outcome outcome = run({"fit", "-i", scratch("grid.csv"), "-o", scratch("out"), "--model", "spline"}, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json report = report_in(scratch, "grid");
  EXPECT_EQ(report["object"]["model"]["control_points"], 8 * 5 + 2);
  // An ellipsoid is reproduced exactly, poles included.
  EXPECT_NEAR(report["object"]["volume_ml"].get<double>(), 4.0 / 3.0 * std::numbers::pi * 2.8, 1e-4);
  EXPECT_TRUE(report["object"]["data_to_surface"]["max_mm"].get<double>() < 1e-2);
}

TEST(Fit, ALadderIsATableAndAPicture) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(400);
  const Outcome outcome =
      run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("out"), "--model", "spline", "--ladder", "4,6,8"}, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(line_count(outcome.out), 4) << outcome.out;
  EXPECT_THAT(read_text(scratch / "out/egg_ladder.png"), testing::StartsWith("\x89PNG"));
  EXPECT_EQ(report_in(scratch, "egg")["levels"].size(), 3U);
}

TEST(Fit, DetailOfASplineIsTheLadderOfDoubledSizes) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(400);
  const Outcome outcome =
      run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("out"), "--model", "spline", "--detail", "0"}, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(line_count(outcome.out), 2) << outcome.out;
  EXPECT_THAT(outcome.out, testing::HasSubstr("10 x 10"));
  EXPECT_THAT(read_text(scratch / "out/egg_ladder.png"), testing::StartsWith("\x89PNG"));
}

/// Those with z above 0, 0.9 mm apart.
std::string half_ellipsoid_points() {
  std::string half;
  std::istringstream all(ellipsoid_points(1600));
  for (std::string line; std::getline(all, line);) {
    if (std::stod(line.substr(line.rfind(' '))) > 0.0) half += line + "\n";
  }
  return half;
}

TEST(Fit, AnOpenSurface) {
  const Scratch scratch;
  std::ofstream(scratch / "half.xyz") << half_ellipsoid_points();
  const Outcome outcome = run(
      {"fit", "-i", scratch("half.xyz"), "-o", scratch("out"), "--model", "catmull-clark", "--open", "--detail", "0"},
      scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json object = report_in(scratch, "half")["object"];
  EXPECT_EQ(object["border_loops"], 1);
  EXPECT_EQ(object["genus"], 0);
  EXPECT_FALSE(object["watertight"].get<bool>());
  EXPECT_TRUE(object["volume_ml"].is_null());
  EXPECT_TRUE(object["data_to_surface"]["rms_percent"].get<double>() < 0.5);
  EXPECT_EQ(run({"export", scratch("out/half_model.json"), "--mesh", scratch("open.ply")}, scratch).exit_code, 0);
  EXPECT_EQ(run({"fit", "-i", scratch("half.xyz"), "-o", scratch("out"), "--open"}, scratch).exit_code, 64);
}

TEST(Fit, StrayPointsDoNotMoveTheRimOfAnOpenSurface) {
  const Scratch scratch;
  std::ofstream file(scratch / "half.xyz");
  RandomEngine random(1);
  for (int k = 0; k < 750; ++k) {
    const double z = random.uniform(), angle = random.uniform(0.0, 2.0 * std::numbers::pi), r = std::sqrt(1.0 - z * z);
    file << 10.0 * r * std::cos(angle) << " " << 10.0 * r * std::sin(angle) << " " << 10.0 * z << "\n";
  }
  for (int k = 0; k < 30; ++k) {
    file << random.uniform(-15, 15) << " " << random.uniform(-15, 15) << " " << random.uniform(-15, 15) << "\n";
  }
  file.close();
  const Outcome outcome = run({"fit", "-i", scratch("half.xyz"), "-o", scratch("out"), "--model", "catmull-clark",
                               "--open", "--detail", "0", "--mesh-format", "obj"},
                              scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr("of 780 points lie apart"));
  EXPECT_EQ(report_in(scratch, "half")["object"]["border_loops"], 1);
}

TEST(Fit, TheSameBytesForAnyNumberOfThreads) {
  const Scratch scratch;
  std::ofstream(scratch / "egg.xyz") << ellipsoid_points(400);
  for (const char* threads : {"1", "2"}) {
    run({"fit", "-i", scratch("egg.xyz"), "-o", scratch("out"), "--name", threads, "--model", "spline", "--size", "6,4",
         "--threads", threads},
        scratch);
  }
  EXPECT_EQ(read_text(scratch / "out/1_model.json"), read_text(scratch / "out/2_model.json"));
  EXPECT_NE(read_text(scratch / "out/1_model.json"), "");
}

struct Broken {
  std::string file, bytes;
  std::vector<std::string> flags;
  int exit_code;
  std::string text;
};

std::ostream& operator<<(std::ostream& out, const Broken& broken) {
  return out << broken.file << " " << broken.text;
}

class BrokenFits : public testing::TestWithParam<Broken> {};

TEST_P(BrokenFits, OneLineTheRightCodeAndNoOutput) {
  const Scratch scratch;
  const Broken& c = GetParam();
  if (c.bytes != "-") std::ofstream(scratch / c.file, std::ios::binary) << c.bytes;
  std::vector<std::string> arguments{"fit", "-i", scratch(c.file), "-o", scratch("out")};
  arguments.insert(arguments.end(), c.flags.begin(), c.flags.end());
  const Outcome outcome = run(arguments, scratch);
  EXPECT_EQ(outcome.exit_code, c.exit_code) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, testing::StartsWith("pellicle: error: "));
  EXPECT_THAT(outcome.err, testing::HasSubstr(c.text));
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BrokenFits,
    testing::Values(
        Broken{"none.xyz", "-", {}, 66, "no such file"}, Broken{"empty.xyz", "", {}, 65, "empty"},
        Broken{"nan.xyz", "1 2 3\n1 nan 3\n", {}, 65, "not finite"},
        Broken{"two.xyz", "1 2\n", {}, 65, "line 1 has 2 numbers"},
        Broken{"few.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", {}, 65, "too few points"},
        Broken{"cut.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 9\nDATA binary\nabc", {}, 65, "truncated"},
        Broken{
            "flat.xyz", "0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n0 2 0\n1 2 0\n2 2 0\n3 3 0\n", {}, 65, "one plane"},
        Broken{"not_a_mesh.obj", "hello\n", {}, 65, "no facets"},
        Broken{"cut.off", "OFF\n9 9 0\n1 2 3\n", {}, 65, "cannot read mesh"},
        Broken{"empty.nii.gz", "", {}, 65, "empty.nii.gz"},
        Broken{"a.xyz", "1 2 3\n", {"--model", "cube"}, 64, "--model cube"},
        Broken{"a.xyz", "1 2 3\n", {"--size", "4"}, 64, "--size"},
        Broken{"a.xyz", "1 2 3\n", {"--size", "10,10"}, 64, "--model spline"},
        Broken{"a.xyz", "1 2 3\n", {"--model", "spline", "--detail", "4"}, 64, "0 to 3"},
        Broken{"a.xyz", "1 2 3\n", {"--tolerance-mm", "-1"}, 64, "must be positive"},
        Broken{"a.xyz", "1 2 3\n", {"--tolerance-mm", "1", "--tolerance-percent", "1"}, 64, "give one of them"},
        Broken{"a.xyz", "1 2 3\n", {"--model", "spline", "--ladder", "10", "--detail", "1"}, 64, "give one"},
        Broken{"a.xyz", "1 2 3\n", {"--write", "mask"}, 64, "--write mask"}));

}  // namespace
}  // namespace pellicle::test
