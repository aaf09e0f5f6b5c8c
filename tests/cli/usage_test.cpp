// Wrong flags and bad files: one clear line, the exit code of the contract, no output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "../image/corpus.h"
#include "run_program.h"

namespace pellicle::test {
namespace {

// {IN} is a good volume, {DIR} a scratch folder, {OUT} a folder in it that must not come into being.
struct WrongFlag {
  std::vector<std::string> arguments;
  int exit_code;
  std::string text;  ///< in the error
};

std::ostream& operator<<(std::ostream& out, const WrongFlag& flag) {
  for (const auto& argument : flag.arguments) out << argument << " ";
  return out;
}

class WrongFlags : public testing::TestWithParam<WrongFlag> {};

std::string filled(std::string text, const Scratch& scratch) {
  for (const auto& [name, value] :
       {std::pair<std::string, std::string>{"{IN}", (corpus_folder() / "ras.nrrd").string()},
        {"{OUT}", scratch("out")},
        {"{DIR}", scratch.path().string()}}) {
    for (auto at = text.find(name); at != std::string::npos; at = text.find(name)) text.replace(at, name.size(), value);
  }
  return text;
}

void write_helpers(const Scratch& scratch) {
  std::ofstream(scratch / "bad_key.toml") << "detail = 1\n\nsmothing = 2\n";
  std::ofstream(scratch / "syntax.toml") << "detail = = 1\n";
  std::ofstream(scratch / "no_row.csv") << "x,y,z,r\n";
  std::ofstream(scratch / "bad_row.csv") << "x,y,z,r\n1,2,three,4\n";
  std::ofstream(scratch / "far.csv") << "9000,0,0,4\n";
  std::ofstream(scratch / "not_a_model.json") << "{\"format\": \"other\"}";
  std::ofstream(scratch / "broken.json") << "{";
  std::ofstream(scratch / "plain_file") << "x";
  std::ofstream(scratch / "not_a_mesh.ply") << "plx\n";
}

TEST_P(WrongFlags, OneLineTheRightCodeAndNoOutput) {
  const Scratch scratch;
  write_helpers(scratch);
  std::vector<std::string> arguments;
  for (const auto& argument : GetParam().arguments) arguments.push_back(filled(argument, scratch));
  const Outcome outcome = run(arguments, scratch);
  EXPECT_EQ(outcome.exit_code, GetParam().exit_code) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, testing::StartsWith("pellicle: error: "));
  EXPECT_THAT(outcome.err, testing::HasSubstr(filled(GetParam().text, scratch)));
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

std::vector<WrongFlag> with_input(const std::vector<WrongFlag>& flags) {
  std::vector<WrongFlag> all;
  for (auto flag : flags) {
    const std::vector<std::string> front{"segment", "-i", "{IN}", "-o", "{OUT}"};
    flag.arguments.insert(flag.arguments.begin(), front.begin(), front.end());
    all.push_back(flag);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(
    Segment, WrongFlags,
    testing::ValuesIn(with_input({{{"--detial", "2"}, 64, "--detial"},
                                  {{"--detail", "two"}, 64, "--detail two"},
                                  {{"--detail", "-1"}, 64, "detail"},
                                  {{"--detail"}, 64, "--detail"},
                                  {{"--detail", "1", "--detail", "2"}, 64, "--detail"},
                                  {{"--seed-sphere", "1,2,3"}, 64, "--seed-sphere 1,2,3"},
                                  {{"--seed-sphere", "1,2,3,x"}, 64, "'x'"},
                                  {{"--seed-sphere", "1,2,nan,4"}, 64, "nan"},
                                  {{"--seed-sphere", "0,0,0,-4"}, 64, "radius"},
                                  {{"--seed-sphere", "9000,0,0,4"}, 64, "outside the volume"},
                                  {{"--seed-sphere", "0,0,0,4", "--seed-auto"}, 64, "exclude"},
                                  {{"--seed-point", "1,2"}, 64, "--seed-point 1,2"},
                                  {{"--seed-point", "0,0,0", "--seed-radius", "0"}, 64, "--seed-radius 0"},
                                  {{"--seed-point", "0,0,0", "--seed-auto"}, 64, "exclude"},
                                  {{"--output-mask", "{OUT}/m.nrrd"}, 64, "--output-mask"},
                                  {{"--output-mesh", "{OUT}/m.doc"}, 64, "doc"},
                                  {{"--output-mesh", "{DIR}/plain_file/m.ply"}, 73, "plain_file"},
                                  {{"--seeds", "{DIR}/absent.csv"}, 66, "absent.csv"},
                                  {{"--seeds", "{DIR}/no_row.csv"}, 65, "no_row.csv"},
                                  {{"--seeds", "{DIR}/bad_row.csv"}, 65, "bad_row.csv:2"},
                                  {{"--seeds", "{DIR}/far.csv"}, 65, "outside the volume"},
                                  {{"--seed-mask", "{DIR}/absent.nii.gz:3"}, 66, "absent.nii.gz"},
                                  {{"--seed-model", "{DIR}/absent.json"}, 66, "absent.json"},
                                  {{"--seed-model", "{DIR}/not_a_model.json"}, 65, "not_a_model.json"},
                                  {{"--seed-model", "{DIR}/broken.json"}, 65, "broken.json"},
                                  {{"--coords", "xyz"}, 64, "lps, ras, ijk"},
                                  {{"--objects", "many", "--radius", "4,2"}, 64, "--radius"},
                                  {{"--radius", "2,4"}, 64, "--objects many"},
                                  {{"--objects", "many", "--valley", "1.5"}, 64, "--valley"},
                                  {{"--objects", "many", "--boundary", "ridge"}, 64, "membranes"},
                                  {{"--model", "clay"}, 64, "clay"},
                                  {{"--points", "{DIR}/plain_file"}, 65, "plain_file"},
                                  {{"--rule", "rough"}, 64, "smooth, published, balanced"},
                                  {{"--start", "cube"}, 64, "tetrahedron"},
                                  {{"--boundary", "soft"}, 64, "ridge"},
                                  {{"--start-rule", "foot"}, 64, "head"},
                                  {{"--polarity", "grey"}, 64, "bright"},
                                  {{"--energy", "edge"}, 64, "NAME=WEIGHT"},
                                  {{"--energy", "edge=much"}, 64, "much"},
                                  {{"--energy", "courage=1"}, 64, "courage"},
                                  {{"--smoothing", "-2"}, 64, "smoothing"},
                                  {{"--max-iterations", "-1"}, 64, "iterations"},
                                  {{"--target-volume", "0"}, 64, "volume"},
                                  {{"--preset", "bright-ish"}, 64, "known are"},
                                  {{"--preset", "{DIR}/absent.toml"}, 66, "absent.toml"},
                                  {{"--config", "{DIR}/absent.toml"}, 66, "absent.toml"},
                                  {{"--config", "{DIR}/bad_key.toml"}, 64, "bad_key.toml:3, smothing"},
                                  {{"--config", "{DIR}/syntax.toml"}, 65, "syntax.toml:1"},
                                  {{"--write", "mask,photo"}, 64, "photo"},
                                  {{"--mesh-format", "ifc"}, 64, "ifc"},
                                  {{"--mesh-density", "9"}, 64, "mesh-density"},
                                  {{"--spacing", "1,1"}, 64, "--spacing"},
                                  {{"--spacing", "1,0,1"}, 64, "spacing"},
                                  {{"--threads", "-2"}, 64, "threads"},
                                  {{"--name", "a/b"}, 64, "a/b"}})));

INSTANTIATE_TEST_SUITE_P(
    All, WrongFlags,
    testing::Values(
        WrongFlag{{}, 64, "see 'pellicle --help'"}, WrongFlag{{"--fast"}, 64, "see 'pellicle --help'"},
        WrongFlag{{"melt"}, 64, "'melt' is not a subcommand"}, WrongFlag{{"segment"}, 64, "-i"},
        WrongFlag{{"segment", "-i", "{IN}"}, 64, "-o"},
        WrongFlag{{"segment", "-i", "{DIR}/absent.nii", "-o", "{OUT}"}, 66, "absent.nii"},
        WrongFlag{{"segment", "-i", "{IN}", "-o", "{DIR}/plain_file"}, 73, "plain_file"},
        WrongFlag{{"segment", "-i", "{IN}", "-o", "{DIR}/plain_file/deeper"}, 73, "plain_file"},
        WrongFlag{{"segment", "-i", "{IN}", "-o", "/proc/nowhere"}, 73, "/proc"},
        WrongFlag{{"info", "{DIR}/absent.nii"}, 66, "absent.nii"},
        WrongFlag{{"info", "{DIR}/not_a_mesh.ply"}, 65, "not_a_mesh.ply"}, WrongFlag{{"info"}, 64, "FILE"},
        WrongFlag{{"evaluate", "{IN}"}, 64, "RESULT"},
        WrongFlag{{"evaluate", "{IN}", "{DIR}/absent.ply"}, 66, "absent.ply"},
        WrongFlag{{"evaluate", "{IN}", "{DIR}/broken.json"}, 65, "broken.json"},
        WrongFlag{{"evaluate", "{IN}", "{IN}", "--tolerance-mm", "-1"}, 64, "tolerance-mm"},
        WrongFlag{{"export", "{DIR}/absent.json", "--mesh", "{OUT}.ply"}, 66, "absent.json"},
        WrongFlag{{"export", "{DIR}/not_a_model.json", "--mesh", "{OUT}.ply"}, 65, "not_a_model.json"},
        WrongFlag{{"export", "{DIR}/not_a_model.json"}, 64, "nothing to export"},
        WrongFlag{{"export", "{DIR}/not_a_model.json", "--mask", "{OUT}.nii.gz"}, 64, "--like"},
        WrongFlag{{"export", "{DIR}/not_a_model.json", "--mesh", "{OUT}.doc"}, 64, "doc"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--shape", "donkey"}, 64, "donkey"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--size", "1,2"}, 64, "--size"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--noise", "pink"}, 64, "pink"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--fill", "half"}, 64, "half"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--radius", "-3"}, 64, "radius"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--bias", "2"}, 64, "bias"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--contrast", "1"}, 64, "--contrast"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--shape", "torus", "--radius", "9,8"}, 64, "9,8"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--count", "3"}, 64, "--count"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--shape", "cluster", "--fill", "shell"}, 64, "--fill"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--shape", "cluster", "--radius", "1,2,3"}, 64, "MIN,MAX"},
        WrongFlag{{"phantom", "-o", "{OUT}", "--name", "a", "--shape", "cluster", "--count", "0"}, 64, "--count 0"},
        WrongFlag{{"phantom", "-o", "{OUT}"}, 64, "--name"}));

// Each broken volume of the corpus, given to the main command.
TEST(BadFiles, OneLineTheRightCodeAndNoOutput) {
  int broken = 0;
  for (const auto& entry : read_table(corpus_folder() / "expected.csv")) {
    if (entry.exit_code == 0 || entry.text == "4D") continue;  // to this command 4D is a series: series_test.cpp
    ++broken;
    const Scratch scratch;
    const Outcome outcome =
        run({"segment", "-i", (corpus_folder() / entry.file).string(), "-o", scratch("out")}, scratch);
    EXPECT_EQ(outcome.exit_code, entry.exit_code) << entry.file << ": " << outcome.err;
    EXPECT_EQ(line_count(outcome.err), 1) << entry.file << ": " << outcome.err;
    EXPECT_THAT(outcome.err, testing::StartsWith("pellicle: error: ")) << entry.file;
    EXPECT_THAT(outcome.err, testing::HasSubstr(entry.text)) << entry.file;
    EXPECT_EQ(outcome.out, "") << entry.file;
    EXPECT_FALSE(std::filesystem::exists(scratch / "out")) << entry.file;
  }
  EXPECT_GT(broken, 40);
}

TEST(BadFiles, ConstantVolumeAndEmptySeedMask) {
  const Scratch scratch;
  const std::string constant = (corpus_folder() / "constant.nii.gz").string();
  const Outcome outcome = run({"segment", "-i", constant, "-o", scratch("out")}, scratch);
  EXPECT_EQ(outcome.exit_code, 65);
  EXPECT_THAT(outcome.err, testing::HasSubstr("constant volume"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

TEST(BadFiles, ErrorsAsJsonLines) {
  const Scratch scratch;
  const Outcome outcome = run({"info", "--log-json", scratch("absent.nii")}, scratch);
  EXPECT_EQ(outcome.exit_code, 66);
  EXPECT_EQ(line_count(outcome.err), 1);
  EXPECT_THAT(outcome.err, testing::StartsWith("{\"time\":"));
  EXPECT_THAT(outcome.err, testing::HasSubstr("pellicle: error: "));
}

TEST(Phantoms, OfHigherGenusAndManyObjectsAreTheirOwnTruth) {
  const Scratch scratch;
  const auto make = [&scratch](std::vector<std::string> more) {
    std::vector<std::string> arguments{"phantom", "-o", scratch("out"), "--size", "40", "--snr", "8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, scratch);
  };
  const auto scores = [&scratch](const std::string& stem) {
    const Outcome outcome =
        run({"evaluate", scratch("out/" + stem + "_truth.json"), scratch("out/" + stem + "_truth.nii.gz"), "--multi",
             "--json", scratch(stem + ".json")},
            scratch);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(read_text(scratch / (stem + ".json")));
  };
  const Outcome torus = make({"--name", "ring", "--shape", "torus", "--radius", "11,4", "--fill", "shell"});
  EXPECT_EQ(torus.exit_code, 0) << torus.err;
  EXPECT_THAT(torus.out, testing::StartsWith("torus 3.4741 ml"));  // 2 pi^2 11 16 mm^3
  EXPECT_LE(std::abs(scores("ring")["volume_error"].get<double>()), 0.02);
  const Outcome two = make({"--name", "two", "--shape", "double-torus", "--radius", "11"});
  EXPECT_EQ(two.exit_code, 0) << two.err;
  EXPECT_THAT(run({"info", scratch("out/two_truth.ply")}, scratch).out, testing::ContainsRegex("genus +2"));
  const Outcome many =
      make({"--name", "many", "--shape", "cluster", "--count", "9", "--radius", "3,5", "--contrast-range", "0.5,1"});
  EXPECT_EQ(many.exit_code, 0) << many.err;
  EXPECT_THAT(many.out, testing::StartsWith("cluster of 9 "));
  EXPECT_FALSE(std::filesystem::exists(scratch / "out/many_truth.ply"));
  const auto json = scores("many");
  EXPECT_EQ(json["dice"].get<double>(), 1.0);
  EXPECT_EQ(json["labels"].size(), 9U);
}

TEST(Help, GoesToStdoutWithCodeZero) {
  const Scratch scratch;
  for (const std::string command : {"segment", "phantom", "evaluate", "export", "morph", "info"}) {
    const Outcome outcome = run({command, "--help"}, scratch);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, testing::HasSubstr("Example: pellicle " + command));
  }
  const Outcome version = run({"--version"}, scratch);
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, testing::StartsWith("pellicle "));
  EXPECT_EQ(run({"segment", "--preset", "list"}, scratch).exit_code, 0);
  EXPECT_THAT(run({"segment", "--energy", "list"}, scratch).out, testing::HasSubstr("bending"));
}

}  // namespace
}  // namespace pellicle::test
