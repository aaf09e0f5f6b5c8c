// The main job end to end on small phantoms.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "pellicle/mesh/files/mesh_file.h"
#include "run_program.h"

namespace pellicle::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

// One oblique, anisotropic phantom for all tests of this file.
class Segment : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    data_ = new Scratch;
    const Outcome made = run({"phantom",     "-o",          data_->path().string(),
                              "--name",      "egg",         "--shape",
                              "ellipsoid",   "--radius",    "7",
                              "--size",      "40,40,20",    "--spacing",
                              "0.9,0.9,1.6", "--direction", "12,-20,30",
                              "--snr",       "8",           "--blur",
                              "0.8",         "--center",    "1,-2,0.5"},
                             *data_);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    ASSERT_EQ(line_count(made.out), 1);
  }
  static void TearDownTestSuite() {
    delete data_;
    data_ = nullptr;
  }
  static std::vector<std::string> command(const Scratch& scratch, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"segment", "-i", (*data_)("egg.nii.gz"), "-o", scratch("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
    return names;
  }
  static double dice(const Scratch& scratch, const std::string& truth, const std::string& result) {
    const Outcome outcome = run({"evaluate", truth, result, "--json", scratch("scores.json"), "--overwrite"}, scratch);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(read_text(scratch / "scores.json"))["dice"].get<double>();
  }
  static Scratch* data_;
};
Scratch* Segment::data_ = nullptr;

bool python_has_nibabel() {
  return std::system("/usr/bin/python3 -c 'import nibabel, numpy' 2>/dev/null") == 0;
}

TEST_F(Segment, WritesEverythingThatIsAskedForAndItReadsBack) {
  const Scratch scratch;
  const Outcome outcome = run(
      command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--write", "mask,mesh,model,report,qc,convergence,sdf,prob"}),
      scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(line_count(outcome.out), 1);
  EXPECT_THAT(outcome.out, testing::MatchesRegex("1 [0-9.]+ ok [0-9.]+\n"));
  EXPECT_THAT(files_in(scratch / "out"),
              testing::UnorderedElementsAre("egg_mask.nii.gz", "egg_surface.ply", "egg_model.json", "egg_report.json",
                                            "egg_qc.png", "egg_convergence.png", "egg_sdf.nii.gz", "egg_prob.nii.gz"));
  EXPECT_GT(dice(scratch, (*data_)("egg_truth.json"), scratch("out/egg_mask.nii.gz")), 0.95);
  EXPECT_GT(dice(scratch, (*data_)("egg_truth.json"), scratch("out/egg_surface.ply")), 0.95);
  EXPECT_GT(dice(scratch, (*data_)("egg_truth.nii.gz"), scratch("out/egg_model.json")), 0.95);
  EXPECT_EQ(read_text(scratch / "out/egg_qc.png").substr(1, 3), "PNG");
  EXPECT_EQ(read_text(scratch / "out/egg_convergence.png").substr(1, 3), "PNG");
  if (!python_has_nibabel()) GTEST_SKIP() << "python3-nibabel is not installed";
  const std::string check = std::string("/usr/bin/python3 ") + PELLICLE_SOURCE_DIR + "/tests/cli/check_outputs.py " +
                            (*data_)("egg.nii.gz") + " " + scratch("out") + " egg " + PELLICLE_SOURCE_DIR +
                            "/docs/report.schema.json";
  EXPECT_EQ(std::system(check.c_str()), 0);
}

TEST_F(Segment, SameBytesForEveryNumberOfThreads) {
  const Scratch one, two;
  for (const auto* scratch : {&one, &two}) {
    const Outcome outcome = run(command(*scratch, {"--seed-sphere", "1,-2,0.5,4", "--write", "mask,mesh,model,qc",
                                                   "--threads", scratch == &one ? "1" : "2"}),
                                *scratch);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  for (const std::string file : {"egg_mask.nii.gz", "egg_surface.ply", "egg_model.json", "egg_qc.png"}) {
    EXPECT_EQ(read_text(one / ("out/" + file)), read_text(two / ("out/" + file))) << file;
    EXPECT_FALSE(read_text(one / ("out/" + file)).empty());
  }
}

TEST_F(Segment, CoordinatesInEveryFrameMeanTheSamePlace) {
  const Scratch scratch;
  const json info = [&] { return json::parse(run({"info", (*data_)("egg.nii.gz"), "--json"}, scratch).out); }();
  // index = diag(1/spacing) direction^T (x - origin), by hand from what `info` prints.
  const std::array<double, 3> x{2.0, -1.0, 1.5};
  std::array<double, 3> index{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t r = 0; r < 3; ++r) {
      index[a] += info["direction"][r][a].get<double>() * (x[r] - info["origin_lps_mm"][r].get<double>());
    }
    index[a] /= info["spacing_mm"][a].get<double>();
  }
  const auto text = [](double a, double b, double c) {
    return std::to_string(a) + "," + std::to_string(b) + "," + std::to_string(c) + ",4";
  };
  const std::vector<std::pair<std::string, std::string>> seeds{
      {"lps", text(x[0], x[1], x[2])}, {"ras", text(-x[0], -x[1], x[2])}, {"ijk", text(index[0], index[1], index[2])}};
  for (const auto& [frame, seed] : seeds) {
    const Outcome outcome =
        run(command(scratch, {"--seed-sphere", seed, "--coords", frame, "--name", frame, "--write", "mask"}), scratch);
    ASSERT_EQ(outcome.exit_code, 0) << frame << outcome.err;
  }
  EXPECT_GE(dice(scratch, scratch("out/lps_mask.nii.gz"), scratch("out/ras_mask.nii.gz")), 0.999);
  EXPECT_GE(dice(scratch, scratch("out/lps_mask.nii.gz"), scratch("out/ijk_mask.nii.gz")), 0.999);
  // A seeds file is in the same frame as the flags.
  std::ofstream(scratch / "seeds.csv") << "x,y,z,r,label,name\n" << seeds[1].second << ",5,\"egg, fried\"\n";
  const Outcome table =
      run(command(scratch, {"--seeds", scratch("seeds.csv"), "--coords", "ras", "--name", "csv"}), scratch);
  ASSERT_EQ(table.exit_code, 0) << table.err;
  EXPECT_GE(dice(scratch, scratch("out/lps_mask.nii.gz"), scratch("out/csv_mask.nii.gz")), 0.999);
  EXPECT_EQ(json::parse(read_text(scratch / "out/csv_report.json"))["objects"][0]["name"], "egg, fried");
}

TEST_F(Segment, SeveralObjectsGetLabelsTableAndNumberedFiles) {
  const Scratch scratch;
  const Outcome outcome =
      run(command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--seed-sphere", "2,-2,0.5,5"}), scratch);
  ASSERT_THAT(outcome.exit_code, testing::AnyOf(0, 3)) << outcome.err;
  EXPECT_EQ(line_count(outcome.out), 2);
  EXPECT_THAT(
      files_in(scratch / "out"),
      testing::UnorderedElementsAre("egg_dseg.nii.gz", "egg_dseg.tsv", "egg_surface-001.ply", "egg_surface-002.ply",
                                    "egg_model-001.json", "egg_model-002.json", "egg_report.json"));
  EXPECT_THAT(read_text(scratch / "out/egg_dseg.tsv"), testing::StartsWith("index\tname\tvolume_ml\tstatus\n1\t"));
  const json report = json::parse(read_text(scratch / "out/egg_report.json"));
  // Both seeds lie in the one egg: nearly all voxels of either are claimed by both.
  EXPECT_GT(report["objects"][1]["overlap_voxels"].get<int>(), 500);
  EXPECT_EQ(report["objects"][0]["overlap_voxels"], report["objects"][1]["overlap_voxels"]);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, testing::HasSubstr("object-2: other objects claim"));
  EXPECT_THAT(read_text(scratch / "out/egg_dseg.tsv"), testing::HasSubstr("ambiguous"));
}

TEST_F(Segment, FilesOfAnEarlierRunWithMoreObjectsDoNotStay) {
  const Scratch scratch;
  const auto with = [&](int seeds, bool overwrite, const std::string& kinds) {
    auto arguments = command(scratch, {"--write", kinds, "--detail", "1"});
    for (int i = 0; i < seeds; ++i) {
      arguments.insert(arguments.end(), {"--seed-sphere", "1,-2," + std::to_string(0.2 * i) + ",4"});
    }
    if (overwrite) arguments.emplace_back("--overwrite");
    return run(arguments, scratch).exit_code;
  };
  ASSERT_THAT(with(3, false, "mesh,model"), testing::AnyOf(0, 3));
  std::ofstream(scratch / "out/egg_surface-note.ply") << "a user's own";
  // All its own files are new, but two others would pass for its results.
  EXPECT_EQ(with(1, false, "mask"), 73);
  EXPECT_TRUE(fs::exists(scratch / "out/egg_surface-003.ply"));
  ASSERT_THAT(with(2, true, "mesh,model"), testing::AnyOf(0, 3));
  EXPECT_THAT(files_in(scratch / "out"),
              testing::UnorderedElementsAre("egg_surface-001.ply", "egg_surface-002.ply", "egg_model-001.json",
                                            "egg_model-002.json", "egg_surface-note.ply"));
}

TEST_F(Segment, FilesOfOwnNamesNeedNoFolderAndHoldTheSame) {
  const Scratch scratch;
  const std::vector<std::string> own{"--output-mask", scratch("there/m.nii.gz"), "--output-mesh",
                                     scratch("there/m.vtp")};
  auto both = command(scratch, {"--seed-point", "1,-2,0.5", "--seed-radius", "4", "--mesh-format", "vtp"});
  both.insert(both.end(), own.begin(), own.end());
  const Outcome first = run(both, scratch);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::string mask = read_text(scratch / "there/m.nii.gz");
  EXPECT_EQ(mask, read_text(scratch / "out/egg_mask.nii.gz"));
  EXPECT_EQ(read_text(scratch / "there/m.vtp"), read_text(scratch / "out/egg_surface.vtp"));
  // A point with its radius is a sphere. Without a folder nothing else is written; nothing is replaced unasked.
  std::vector<std::string> alone{"segment", "-i", (*data_)("egg.nii.gz"), "--seed-sphere", "1,-2,0.5,4"};
  alone.insert(alone.end(), own.begin(), own.end());
  EXPECT_EQ(run(alone, scratch).exit_code, 73);
  fs::remove_all(scratch / "there");
  fs::remove_all(scratch / "out");
  const Outcome second = run(alone, scratch);
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(read_text(scratch / "there/m.nii.gz"), mask);
  EXPECT_THAT(files_in(scratch / "there"), testing::UnorderedElementsAre("m.nii.gz", "m.vtp"));
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

TEST_F(Segment, NothingIsReplacedWithoutBeingAskedTo) {
  const Scratch scratch;
  const auto arguments = command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--write", "model"});
  ASSERT_EQ(run(arguments, scratch).exit_code, 0);
  std::ofstream(scratch / "out/egg_model.json") << "mine";
  const Outcome refused = run(arguments, scratch);
  EXPECT_EQ(refused.exit_code, 73);
  EXPECT_THAT(refused.err, testing::HasSubstr("--overwrite"));
  EXPECT_EQ(read_text(scratch / "out/egg_model.json"), "mine");
  auto replacing = arguments;
  replacing.emplace_back("--overwrite");
  EXPECT_EQ(run(replacing, scratch).exit_code, 0);
  EXPECT_NE(read_text(scratch / "out/egg_model.json"), "mine");
}

TEST_F(Segment, DryRunWritesAConfigThatGivesTheSameRun) {
  const Scratch scratch;
  const auto arguments = command(scratch, {"--preset", "bright", "--seed-sphere", "1,-2,0.5,4", "--energy",
                                           "bending=0.5", "--tolerance", "0.1", "--write", "model"});
  auto dry = arguments;
  dry.emplace_back("--dry-run");
  const Outcome printed = run(dry, scratch);
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(files_in(scratch / "out"), testing::ElementsAre("egg_seeds.png"));
  EXPECT_THAT(printed.out, testing::HasSubstr("polarity = \"bright\""));
  EXPECT_THAT(printed.out, testing::HasSubstr("# 1 object-1: a ball at 1,-2,0.5 LPS mm, radius 4 mm"));
  EXPECT_THAT(printed.out, testing::HasSubstr("# would write " + scratch("out/egg_model.json")));
  std::ofstream(scratch / "run.toml") << printed.out;
  EXPECT_EQ(run({"segment", "--config", scratch("run.toml"), "--dry-run"}, scratch).out, printed.out);
  ASSERT_EQ(run(arguments, scratch).exit_code, 0);
  ASSERT_EQ(run({"segment", "--config", scratch("run.toml"), "--name", "again"}, scratch).exit_code, 0);
  EXPECT_EQ(read_text(scratch / "out/egg_model.json"), read_text(scratch / "out/again_model.json"));
}

TEST_F(Segment, CommandLineBeatsConfigBeatsPreset) {
  const Scratch scratch;
  std::ofstream(scratch / "c.toml") << "preset = \"dark\"\nboundary = \"ridge\"\ndetail = 1\n";
  const std::string out = run({"segment", "--config", scratch("c.toml"), "--detail", "2", "--dry-run"}, scratch).out;
  EXPECT_THAT(out, testing::HasSubstr("preset = \"dark\""));
  EXPECT_THAT(out, testing::HasSubstr("polarity = \"dark\""));   // preset
  EXPECT_THAT(out, testing::HasSubstr("boundary = \"ridge\""));  // config over preset
  EXPECT_THAT(out, testing::HasSubstr("detail = 2"));            // command line over config
  const std::string bright =
      run({"segment", "--config", scratch("c.toml"), "--preset", "bright", "--dry-run"}, scratch).out;
  EXPECT_THAT(bright, testing::HasSubstr("polarity = \"bright\""));
}

TEST_F(Segment, ExportAgreesWithWhatSegmentWrote) {
  const Scratch scratch;
  ASSERT_EQ(run(command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--write", "mask,model"}), scratch).exit_code, 0);
  const Outcome outcome = run({"export", scratch("out/egg_model.json"), "--mesh", scratch("m.stl"), "--density", "3",
                               "--mask", scratch("m.nii.gz"), "--sdf", scratch("s.nii.gz"), "--prob",
                               scratch("p.nii.gz"), "--control", scratch("c.ply"), "--like", (*data_)("egg.nii.gz")},
                              scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GE(dice(scratch, scratch("out/egg_mask.nii.gz"), scratch("m.nii.gz")), 0.99);
  EXPECT_GE(dice(scratch, scratch("out/egg_mask.nii.gz"), scratch("m.stl")), 0.98);
  const json info = json::parse(run({"info", scratch("m.stl"), "--json"}, scratch).out);
  EXPECT_EQ(info["watertight"], true);
  EXPECT_EQ(run({"export", scratch("out/egg_model.json"), "--mesh", scratch("m.stl")}, scratch).exit_code, 73);
}

// Whether the process comes to catch the signal; a slow start, as under a sanitizer, is waited for.
bool waits_for(pid_t process, int signal) {
  const std::string mask_name = "SigCgt:";
  for (int tries = 0; tries < 3000; ++tries, usleep(10000)) {
    std::ifstream status(fmt::format("/proc/{}/status", process));
    for (std::string line; std::getline(status, line);)
      if (line.starts_with(mask_name) &&
          ((std::stoull(line.substr(mask_name.size()), nullptr, 16) >> (signal - 1)) & 1U))
        return true;
  }
  return false;
}

TEST_F(Segment, InterruptLeavesNoHalfFile) {
  const Scratch scratch;
  const Outcome made =
      run({"phantom", "-o", scratch.path().string(), "--name", "big", "--size", "160", "--radius", "40"}, scratch);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const pid_t child = start(
      {"segment", "-i", scratch("big.nii.gz"), "-o", scratch("out"), "--tolerance", "1e-9", "--max-iterations", "1000"},
      scratch);
  ASSERT_TRUE(waits_for(child, SIGINT));
  usleep(400000);
  kill(child, SIGINT);
  const Outcome outcome = finish(child, scratch);
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(line_count(outcome.err), 1);
  EXPECT_THAT(outcome.err, testing::HasSubstr("interrupted"));
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

TEST_F(Segment, QuietSaysNothingAndVerboseJsonIsOneObjectALine) {
  const Scratch scratch;
  const Outcome quiet = run(command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--write", "report", "-q"}), scratch);
  EXPECT_EQ(quiet.err, "");
  const Outcome loud =
      run(command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--write", "report", "-v", "--log-json", "--overwrite"}),
          scratch);
  EXPECT_GT(line_count(loud.err), 2);
  std::istringstream lines(loud.err);
  for (std::string line; std::getline(lines, line);) {  // docs/log.schema.json
    const json record = json::parse(line);
    EXPECT_EQ(record.size(), 3U) << line;
    EXPECT_THAT(record.at("time").get<std::string>(), testing::MatchesRegex("....-..-..T..:..:..Z"));
    EXPECT_THAT(record.at("level").get<std::string>(), testing::AnyOf("info", "warning"));
    EXPECT_THAT(record.at("message").get<std::string>(),
                testing::StartsWith("pellicle: " + record["level"].get<std::string>()));
  }
}

// Points of the truth's surface, in the frame asked for.
void write_points(const fs::path& file, const TriangleMesh& mesh, double sign, int count) {
  std::ofstream out(file);
  out << "x,y,z,weight\n";
  const std::size_t step = mesh.vertices.size() / static_cast<std::size_t>(count);
  for (std::size_t v = 0; v < mesh.vertices.size(); v += step) {
    const Vec3& x = mesh.vertices[v];
    out << fmt::format("{},{},{},2\n", sign * x.x(), sign * x.y(), x.z());
  }
}

TEST_F(Segment, ExpertPointsAreReadInTheirFrameAndReported) {
  const Scratch scratch;
  const TriangleMesh truth = read_mesh((*data_)("egg_truth.ply"));
  write_points(scratch / "lps.csv", truth, 1.0, 60);
  write_points(scratch / "ras.csv", truth, -1.0, 60);
  for (const std::string frame : {"lps", "ras"}) {
    const Outcome outcome = run(command(scratch, {"--points", scratch(frame + ".csv"), "--coords", frame, "--name",
                                                  frame, "--detail", "1", "--write", "model,mask,report"}),
                                scratch);
    ASSERT_THAT(outcome.exit_code, testing::AnyOf(0, 3)) << outcome.err;
    const json report = json::parse(read_text(scratch / ("out/" + frame + "_report.json")));
    const json& points = report["objects"][0]["fit"]["points"];
    EXPECT_GE(points["count"].get<int>(), 60);
    EXPECT_LE(points["rms_mm"].get<double>(), 0.5);
    EXPECT_GE(points["max_mm"].get<double>(), points["rms_mm"].get<double>());
    EXPECT_EQ(report["inputs"].back()["role"], "points");
    EXPECT_GE(report["settings"]["stage"][0]["energies"]["springs"].get<double>(), 1.0);
    EXPECT_GE(dice(scratch, (*data_)("egg_truth.nii.gz"), scratch("out/" + frame + "_mask.nii.gz")), 0.95);
  }
  std::ofstream(scratch / "far.csv") << "900,900,900\n";
  const Outcome outside = run(command(scratch, {"--points", scratch("far.csv"), "--name", "far"}), scratch);
  EXPECT_EQ(outside.exit_code, 65);
  EXPECT_THAT(outside.err, testing::HasSubstr("--coords"));
  EXPECT_EQ(run(command(scratch, {"--points", scratch("none.csv")}), scratch).exit_code, 66);
  EXPECT_EQ(run(command(scratch, {"--energy", "springs=1"}), scratch).exit_code, 64);
}

TEST_F(Segment, TraceIsWrittenBesideTheSameResult) {
  const Scratch scratch;
  const std::vector<std::string> base{"--seed-sphere", "1,-2,0.5,4", "--detail", "1", "--write", "mask,mesh,model"};
  ASSERT_EQ(run(command(scratch, base), scratch).exit_code, 0);
  std::vector<std::string> traced = base;
  traced.insert(traced.end(), {"--name", "again", "--trace", scratch("trace"), "--trace-every", "2"});
  ASSERT_EQ(run(command(scratch, traced), scratch).exit_code, 0);
  for (const std::string file : {"_mask.nii.gz", "_surface.ply", "_model.json"}) {
    EXPECT_EQ(read_text(scratch / ("out/egg" + file)), read_text(scratch / ("out/again" + file))) << file;
  }
  const std::set<std::string> files = files_in(scratch / "trace");
  EXPECT_THAT(files, testing::IsSupersetOf({"again_trace-0001.ply", "again_trace.png", "again_trace.tsv"}));
  EXPECT_EQ(line_count(read_text(scratch / "trace/again_trace.tsv")), static_cast<int>(files.size()) - 1);
  for (const std::string& file : files) EXPECT_THAT(file, testing::StartsWith("again_trace"));
  // The last one is the result.
  const std::string last = *std::prev(std::find(files.begin(), files.end(), "again_trace.png"));
  EXPECT_GE(dice(scratch, scratch("out/again_surface.ply"), scratch("trace/" + last)), 0.99);

  EXPECT_EQ(
      run(command(scratch, {"--name", "again", "--write", "report", "--trace", scratch("trace")}), scratch).exit_code,
      73);
  std::ofstream(scratch / "trace/again_trace-0999.ply") << "old";
  std::ofstream(scratch / "trace/other.txt") << "mine";
  traced.emplace_back("--overwrite");
  ASSERT_EQ(run(command(scratch, traced), scratch).exit_code, 0);
  std::set<std::string> expected = files;
  expected.insert("other.txt");
  EXPECT_EQ(files_in(scratch / "trace"), expected);
}

TEST_F(Segment, AMovingSurfaceComesToTheSamePlace) {
  const Scratch scratch;
  for (const std::string solver : {"least-squares", "dynamic"}) {
    ASSERT_EQ(run(command(scratch, {"--seed-sphere", "1,-2,0.5,4", "--detail", "1", "--solver", solver, "--name",
                                    solver, "--write", "mask,report"}),
                  scratch)
                  .exit_code,
              0);
  }
  EXPECT_GE(dice(scratch, scratch("out/dynamic_mask.nii.gz"), scratch("out/least-squares_mask.nii.gz")), 0.98);
  EXPECT_EQ(json::parse(read_text(scratch / "out/dynamic_report.json"))["settings"]["stage"][0]["solver"], "dynamic");
  EXPECT_EQ(run(command(scratch, {"--mass", "1"}), scratch).exit_code, 64);
}

}  // namespace
}  // namespace pellicle::test
