#include "pellicle/job/label_tracks.h"

#include <gtest/gtest.h>

namespace pellicle {
namespace {

using Balls = std::map<int, std::pair<Vec3, double>>;  // label, centre and radius in voxels of 0.5 mm

Image<std::uint16_t> frame_of(const Balls& balls) {
  ImageGrid grid;
  grid.size = {40, 40, 20};
  grid.spacing = {0.5, 0.5, 0.5};
  Image<std::uint16_t> labels(grid);
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 40; ++i) {
        for (const auto& [label, ball] : balls) {
          if ((Vec3(i, j, k) - ball.first).norm() <= ball.second)
            labels.at(i, j, k) = static_cast<std::uint16_t>(label);
        }
      }
    }
  }
  return labels;
}

const Vec3 kA(8, 8, 10), kB(30, 8, 10), kC(8, 30, 10);

TEST(LabelTracks, TheOrderOfDetectionDoesNotMatter) {
  LabelTracks tracks;
  Image<std::uint16_t> first = frame_of({{1, {kA, 5}}, {2, {kB, 5}}, {3, {kC, 5}}});
  const Image<std::uint16_t> as_found = first;
  tracks.follow(first);
  EXPECT_EQ(first.voxels, as_found.voxels);  // the first frame names the objects
  // All moved a little, in another order of labels.
  const Vec3 step(2, 1, 0);
  Image<std::uint16_t> second = frame_of({{3, {kA + step, 5}}, {1, {kB + step, 5}}, {2, {kC + step, 5}}});
  EXPECT_EQ(tracks.follow(second), (std::map<int, int>{{1, 2}, {2, 3}, {3, 1}}));
  EXPECT_EQ(second.voxels, frame_of({{1, {kA + step, 5}}, {2, {kB + step, 5}}, {3, {kC + step, 5}}}).voxels);
}

TEST(LabelTracks, AFastObjectIsFollowedByItsCentreAndALostOneKeepsItsName) {
  LabelTracks tracks;
  Image<std::uint16_t> frame = frame_of({{1, {kA, 4}}, {2, {kB, 4}}});
  tracks.follow(frame);
  // No voxel in common, but less than both radii away.
  frame = frame_of({{1, {kB, 4}}, {2, {kA + Vec3(7.5, 0, 0), 4}}});
  EXPECT_EQ(tracks.follow(frame), (std::map<int, int>{{1, 2}, {2, 1}}));
  frame = frame_of({{1, {kB, 4}}});  // the other is not seen
  EXPECT_EQ(tracks.follow(frame), (std::map<int, int>{{1, 2}}));
  // It is back; and something new is too far from everything to be anything that was.
  frame = frame_of({{1, {kC, 4}}, {2, {kA + Vec3(7.5, 1, 0), 4}}, {3, {kB, 4}}});
  EXPECT_EQ(tracks.follow(frame), (std::map<int, int>{{1, 3}, {2, 1}, {3, 2}}));
}

TEST(LabelTracks, OfTwoHalvesTheLargerKeepsTheLabel) {
  LabelTracks tracks;
  Image<std::uint16_t> frame = frame_of({{1, {kA, 7}}});
  tracks.follow(frame);
  frame = frame_of({{1, {kA + Vec3(-4, 0, 0), 3}}, {2, {kA + Vec3(3, 0, 0), 4.5}}});
  EXPECT_EQ(tracks.follow(frame), (std::map<int, int>{{1, 2}, {2, 1}}));
}

}  // namespace
}  // namespace pellicle
