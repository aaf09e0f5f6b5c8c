#include "pellicle/job/label_tracks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

namespace pellicle {

namespace {

constexpr double kLeastOverlap = 0.1;

std::map<int, LabelTracks::Track> tracks_in(const Image<std::uint16_t>& labels) {
  std::map<int, LabelTracks::Track> tracks;
  const Index3& size = labels.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const int label = labels.at(i, j, k);
        if (label == 0) continue;
        LabelTracks::Track& track = tracks[label];
        track.centre += Vec3(i, j, k);
        track.voxels += 1.0;
      }
    }
  }
  for (auto& [label, track] : tracks) {
    track.centre = labels.grid.world_from_index(track.centre / track.voxels);
    track.radius = std::cbrt(0.75 / std::numbers::pi * track.voxels * labels.grid.voxel_volume());
  }
  return tracks;
}

/// Score (smaller is better), label before, label now.
using Pairs = std::vector<std::tuple<double, int, int>>;

void take_best_first(Pairs pairs, std::set<int>& taken, std::map<int, int>& kept) {
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [score, old_label, new_label] : pairs) {
    if (taken.contains(old_label) || kept.contains(new_label)) continue;
    taken.insert(old_label);
    kept[new_label] = old_label;
  }
}

}  // namespace

std::map<int, int> LabelTracks::follow(Image<std::uint16_t>& labels) {
  const std::map<int, Track> now = tracks_in(labels);
  std::set<int> taken;
  std::map<int, int> kept;
  if (!before_.voxels.empty()) {
    std::map<std::pair<int, int>, double> shared;
    std::map<int, double> size_before;
    for (std::size_t n = 0; n < labels.voxels.size(); ++n) {
      if (before_.voxels[n] == 0) continue;
      size_before[before_.voxels[n]] += 1.0;
      if (labels.voxels[n] != 0) shared[{before_.voxels[n], labels.voxels[n]}] += 1.0;
    }
    Pairs by_overlap;
    for (const auto& [pair, both] : shared) {
      const double iou = both / (size_before.at(pair.first) + now.at(pair.second).voxels - both);
      if (iou >= kLeastOverlap) by_overlap.emplace_back(-iou, pair.first, pair.second);
    }
    take_best_first(std::move(by_overlap), taken, kept);
  }
  Pairs by_centre;
  for (const auto& [old_label, then] : tracks_) {
    for (const auto& [new_label, track] : now) {
      const double apart = (then.centre - track.centre).norm();
      if (apart <= then.radius + track.radius) by_centre.emplace_back(apart, old_label, new_label);
    }
  }
  take_best_first(std::move(by_centre), taken, kept);
  for (const auto& [label, track] : now) {
    if (!kept.contains(label)) kept[label] = next_++;
    next_ = std::max(next_, kept[label] + 1);
    tracks_[kept[label]] = track;
  }
  for (auto& voxel : labels.voxels) {
    if (voxel != 0) voxel = static_cast<std::uint16_t>(kept.at(voxel));
  }
  before_ = labels;
  return kept;
}

}  // namespace pellicle
