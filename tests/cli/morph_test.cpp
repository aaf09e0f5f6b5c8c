// pellicle morph: files, lines on stdout, exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pellicle/surface/model_file.h"
#include "run_program.h"

namespace pellicle::test {
namespace {

Surface ellipsoid(const Vec3& half_axes, StartSolid solid) {
  ModelChoice choice;
  choice.solid = solid;
  const SurfaceModel model = start_model(choice);
  return {model, affine_image(model, half_axes, half_axes.asDiagonal())};
}

/// Two ellipsoids of one control mesh and one of another.
class MorphProgram : public testing::Test {
 protected:
  MorphProgram() {
    write_model(scratch_ / "long_model.json", ellipsoid({12, 6, 6}, StartSolid::icosahedron));
    write_model(scratch_ / "flat_model.json", ellipsoid({9, 9, 4}, StartSolid::icosahedron));
    write_model(scratch_ / "other.json", ellipsoid({9, 9, 4}, StartSolid::octahedron));
  }
  Outcome morph(const std::string& a, const std::string& b, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"morph", scratch_(a), scratch_(b), "-o", scratch_("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, scratch_);
  }
  Scratch scratch_;
};

TEST_F(MorphProgram, WritesEveryStepAndPrintsALineEach) {
  const Outcome outcome = morph("long_model.json", "flat_model.json", {"--steps", "3", "--space", "sphere"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(line_count(outcome.out), 3);
  EXPECT_THAT(outcome.out, testing::StartsWith("1 0 "));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("2 0\\.5 [0-9.]+ [0-9.]+ ok"));
  for (const char* name : {"out/long_to_flat_morph-001_model.json", "out/long_to_flat_morph-003_surface.ply",
                           "out/long_to_flat_morph.tsv", "out/long_to_flat_morph.png"}) {
    EXPECT_TRUE(std::filesystem::exists(scratch_ / name)) << name;
  }
  const auto report = nlohmann::json::parse(read_text(scratch_ / "out/long_to_flat_morph.json"));
  EXPECT_EQ(report["steps"].size(), 3U);
  EXPECT_EQ(report["inputs"][1]["sha256"].get<std::string>().size(), 64U);
  // A step is a model like any other.
  const Outcome again =
      run({"export", scratch_("out/long_to_flat_morph-002_model.json"), "--mesh", scratch_("m.ply")}, scratch_);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const Outcome refused = morph("long_model.json", "flat_model.json", {"--steps", "3"});
  EXPECT_EQ(refused.exit_code, 73);
  EXPECT_THAT(refused.err, testing::HasSubstr("--overwrite"));
}

TEST_F(MorphProgram, ExtrapolatesAndTellsOfWhatFolds) {
  const std::vector<std::string> far{"--steps", "2",      "--from", "-30",           "--to",
                                     "30",      "--name", "far",    "--mesh-format", "stl"};
  const Outcome outcome = morph("long_model.json", "flat_model.json", far);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.out;
  EXPECT_EQ(line_count(outcome.out), 2);
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "out/far_morph-002_surface.stl"));
  EXPECT_THAT(read_text(scratch_ / "out/far_morph.tsv"), testing::HasSubstr("folded"));
}

TEST_F(MorphProgram, RefusesWithTheCodeOfTheContractAndOneLine) {
  std::ofstream(scratch_ / "broken.json") << "{";
  struct Wrong {
    std::string a, b;
    std::vector<std::string> more;
    int code;
    std::string text;
  };
  const std::string good = "long_model.json";
  for (const Wrong& wrong :
       {Wrong{good, "other.json", {}, 64, "6 control points"}, Wrong{good, "absent.json", {}, 66, "absent.json"},
        Wrong{good, "broken.json", {}, 65, "broken.json"}, Wrong{good, good, {"--steps", "0"}, 64, "--steps 0"},
        Wrong{good, good, {"--space", "cube"}, 64, "plane, sphere"},
        Wrong{good, good, {"--from", "2", "--to", "2"}, 64, "--to 2"},
        Wrong{good, good, {"--from", "nan"}, 64, "--from nan"},
        Wrong{good, good, {"--mesh-density", "9"}, 64, "--mesh-density 9"},
        Wrong{good, good, {"--mesh-format", "doc"}, 64, "doc"}, Wrong{good, good, {"--name", "a/b"}, 64, "a/b"}}) {
    const Outcome outcome = morph(wrong.a, wrong.b, wrong.more);
    EXPECT_EQ(outcome.exit_code, wrong.code) << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(wrong.text));
    EXPECT_THAT(outcome.err, testing::StartsWith("pellicle: error: "));
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "out")) << outcome.err;
  }
}

}  // namespace
}  // namespace pellicle::test
