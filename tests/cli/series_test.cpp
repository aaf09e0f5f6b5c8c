// A time series end to end: a 4D file to a result a frame, a table and a plot.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/base/random.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/synthetic/phantom.h"
#include "run_program.h"

namespace pellicle::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

// 3D files one after the other under the first one's header, as NIfTI-1 lays a series out.
fs::path join_frames(const Scratch& scratch, const std::vector<Image<float>>& frames, float step, char time_unit) {
  std::string bytes;
  for (const auto& frame : frames) {
    VolumeHeader header;
    header.grid = frame.grid;
    write_volume(scratch / "one.nii", frame, header);
    const std::string one = read_text(scratch / "one.nii");
    bytes += bytes.empty() ? one : one.substr(352);
  }
  const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  put(40, static_cast<std::int16_t>(4));
  put(48, static_cast<std::int16_t>(frames.size()));
  put(92, step);
  bytes[123] = static_cast<char>(bytes[123] | time_unit);
  std::ofstream(scratch / "series.nii", std::ios::binary) << bytes;
  return scratch / "series.nii";
}

std::vector<std::vector<std::string>> table_of(const fs::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(read_text(path));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, '\t');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(Series, AGrowingBallIsFollowed) {
  const Scratch scratch;
  std::vector<Image<float>> frames;
  std::vector<double> truth;
  for (int t = 0; t < 4; ++t) {
    PhantomSettings s{.size = {40, 40, 40}, .radius = {7.0 + 1.5 * t}, .snr = 8.0};
    s.center = {0.5 * t, 0, 0};
    s.seed = 7 + static_cast<std::uint64_t>(t);
    const Phantom phantom = make_phantom(s);
    frames.push_back(phantom.image);
    truth.push_back(phantom.exact_volume_ml);
  }
  const fs::path file = join_frames(scratch, frames, 2.5F, 8);
  const std::vector<std::string> arguments{
      "segment", "-i", file.string(), "-o", scratch("out"), "--seed-sphere", "0,0,0,4", "--write", "mask,model,report"};
  const Outcome outcome = run(arguments, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(line_count(outcome.out), 4);
  const auto rows = table_of(scratch / "out/series_series.tsv");
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_THAT(rows[0], testing::ElementsAre("frame", "time_s", "label", "name", "volume_ml", "status"));
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(rows[t + 1][1], fmt::format("{:.6g}", 2.5 * static_cast<double>(t)));
    EXPECT_NEAR(std::stod(rows[t + 1][4]), truth[t], 0.04 * truth[t]) << t;
    EXPECT_EQ(rows[t + 1][5], "ok");
    EXPECT_TRUE(fs::exists(scratch / fmt::format("out/series_t{:03}_mask.nii.gz", t)));
  }
  EXPECT_THAT(read_text(scratch / "out/series_series.png"), testing::StartsWith("\x89PNG"));
  // A frame begins with the surface of the last, not with the click.
  const json report = json::parse(read_text(scratch / "out/series_t002_report.json"));
  EXPECT_EQ(report["input"]["frame"]["index"], 2);
  EXPECT_EQ(report["input"]["frame"]["time"], 5.0);
  EXPECT_THAT(report["objects"][0]["fit"]["hypotheses"][0]["name"].get<std::string>(),
              testing::HasSubstr("seed surface"));
  // Each frame's mask is a 3D file on the frame's grid.
  EXPECT_EQ(run({"info", scratch("out/series_t000_mask.nii.gz")}, scratch).exit_code, 0);
  EXPECT_EQ(run(arguments, scratch).exit_code, 73);  // nothing is replaced, and nothing is done before that is known
}

TEST(Series, ManyObjectsKeepTheirLabels) {
  const Scratch scratch;
  // Three balls that drift; the third is gone in the second frame, a fourth comes in the third.
  const std::vector<Vec3> start{{12, 12, 14}, {34, 14, 14}, {14, 34, 14}, {34, 35, 14}};
  const auto is_there = [](std::size_t ball, int t) { return ball == 2 ? t != 1 : ball != 3 || t == 2; };
  std::vector<Image<float>> frames;
  RandomEngine random(5);
  ImageGrid grid;
  grid.size = {48, 48, 28};
  for (int t = 0; t < 3; ++t) {
    Image<float> frame(grid);
    std::size_t n = 0;
    for (int k = 0; k < 28; ++k) {
      for (int j = 0; j < 48; ++j) {
        for (int i = 0; i < 48; ++i) {
          double value = 20.0 + 5.0 * random.normal();
          for (std::size_t b = 0; b < start.size(); ++b) {
            // Brightness changes from frame to frame and with it the order of detection.
            const double height = 80.0 + 40.0 * static_cast<double>((b + static_cast<std::size_t>(t)) % 3);
            const double depth = 6.0 - (Vec3(i, j, k) - start[b] - t * Vec3(1.5, 1, 0)).norm();
            if (is_there(b, t)) value += height / (1.0 + std::exp(-2.0 * depth));
          }
          frame.voxels[n++] = static_cast<float>(value);
        }
      }
    }
    frames.push_back(std::move(frame));
  }
  const fs::path file = join_frames(scratch, frames, 1.0F, 0);
  const Outcome outcome =
      run({"segment", "-i", file.string(), "-o", scratch("out"), "--objects", "many", "--write", "mask"}, scratch);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  // Who is who, by the label map at the balls' true centres.
  std::vector<std::map<std::size_t, int>> label(3);
  for (int t = 0; t < 3; ++t) {
    const LabelVolume map = read_labels(scratch / fmt::format("out/series_t{:03}_dseg.nii.gz", t));
    for (std::size_t b = 0; b < start.size(); ++b) {
      const Vec3 x = start[b] + t * Vec3(1.5, 1, 0);
      const int found = map.labels.at(static_cast<int>(x[0]), static_cast<int>(x[1]), static_cast<int>(x[2]));
      EXPECT_EQ(found != 0, is_there(b, t)) << "ball " << b << " frame " << t;
      if (found != 0) label[static_cast<std::size_t>(t)][b] = found;
    }
  }
  for (const std::size_t ball : {0U, 1U}) {
    EXPECT_EQ(label[1][ball], label[0][ball]);
    EXPECT_EQ(label[2][ball], label[0][ball]);
  }
  EXPECT_EQ(label[2][2], label[0][2]);  // back again
  EXPECT_EQ(label[2][3], 4);            // new
  const auto rows = table_of(scratch / "out/series_series.tsv");
  ASSERT_EQ(rows.size(), 1U + 3U + 2U + 4U);
  EXPECT_EQ(rows[0][1], "time_frame");
}

TEST(Series, WhatIsNoTimeIsRefusedInOneLine) {
  const Scratch scratch;
  const Image<float> frame = make_phantom({.size = {24, 24, 24}, .radius = {6.0}}).image;
  const std::string file = join_frames(scratch, {frame, frame}, 1.0F, 32).string();  // Hz: a spectrum
  const Outcome spectrum = run({"segment", "-i", file, "-o", scratch("out")}, scratch);
  EXPECT_EQ(spectrum.exit_code, 65);
  EXPECT_THAT(spectrum.err, testing::HasSubstr("the fourth axis is not time (Hz)"));
  EXPECT_EQ(line_count(spectrum.err), 1);
  std::string bytes = read_text(file);
  bytes[40] = 5;
  bytes[50] = 2;  // vectors, or what else
  std::ofstream(scratch / "five.nii", std::ios::binary) << bytes << bytes.substr(352);
  EXPECT_EQ(run({"segment", "-i", scratch("five.nii"), "-o", scratch("out")}, scratch).exit_code, 65);
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

}  // namespace
}  // namespace pellicle::test
