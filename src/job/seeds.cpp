#include "pellicle/job/seeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pellicle/base/errors.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/fit/fit.h"
#include "pellicle/seed/point_outline.h"

namespace pellicle {

std::optional<Seed> seed_of_points(const ExpertPoints& points, const ImageGrid& grid, const FitOptions& fit) {
  if (!ellipsoid_of(points, {}, grid.mean_spacing())) return std::nullopt;
  try {
    return surface_from_mask(mask_of_points(points.points), fit.model, std::min(2, fit.detail.value_or(2)));
  } catch (const BadData&) {  // nothing enclosed
  }
  SeedSphere ball;
  const auto count = static_cast<double>(points.points.size());
  for (const Vec3& x : points.points) ball.center += x / count;
  for (const Vec3& x : points.points) ball.radius += 0.5 * (x - ball.center).norm() / count;
  return ball;
}

std::vector<ObjectSeed> seeds_of_labels(const Image<std::int32_t>& map, std::optional<int> wanted,
                                        const FitOptions& fit, const std::string& name) {
  std::set<int> labels;
  for (const std::int32_t label : map.voxels) {
    if (label != 0) labels.insert(label);
  }
  if (wanted) {
    if (labels.count(*wanted) == 0 || *wanted == 0) {
      throw BadData(fmt::format("empty seed ({}): label {} has no voxel; the file holds {} labels", name, *wanted,
                                labels.size()));
    }
    labels = {*wanted};
  }
  if (labels.empty()) throw BadData(fmt::format("empty seed ({}): the mask has no voxel; seed with a sphere", name));
  if (*labels.begin() < 1 || *labels.rbegin() > 65535) {
    throw BadData(fmt::format("bad label ({}): labels must lie in 1 to 65535; name one with FILE:LABEL", name));
  }
  std::vector<ObjectSeed> objects;
  for (const int label : labels) {
    Image<std::uint8_t> mask(map.grid);
    std::transform(map.voxels.begin(), map.voxels.end(), mask.voxels.begin(),
                   [label](std::int32_t v) { return static_cast<std::uint8_t>(v == label ? 1 : 0); });
    objects.push_back({.label = label, .candidates = {surface_from_mask(mask, fit.model, fit.detail.value_or(2))}});
  }
  return objects;
}

ObjectSeed find_object(const Image<float>& image, const FitOptions& fit) {
  ObjectSeed object;
  if (fit.start_rule == StartRule::head) {
    object.candidates = {find_head(image)};
  } else {
    for (const SeedSphere& sphere : find_candidates(image)) object.candidates.emplace_back(sphere);
  }
  return object;
}

std::vector<ObjectSeed> numbered(std::vector<ObjectSeed> seeds) {
  std::set<int> labels;
  for (ObjectSeed& object : seeds) {
    if (!labels.insert(object.label).second) {
      throw SettingError("label given twice", "seeds",
                         fmt::format("{} names two objects; make the labels unique", object.label));
    }
    if (object.name.empty()) object.name = fmt::format("object-{}", object.label);
  }
  return seeds;
}

}  // namespace pellicle
