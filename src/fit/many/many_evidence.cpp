#include "pellicle/fit/many/many_evidence.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"
#include "pellicle/image/resample.h"
#include "pellicle/raster/joint_labels.h"

namespace pellicle {

namespace {

double median_over(const std::vector<BodyEvidence>& evidence, const std::vector<bool>& which,
                   double BodyEvidence::*value) {
  std::vector<double> values;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (which[i]) values.push_back(evidence[i].*value);
  }
  return values.empty() ? 0.0 : median_of(std::move(values));
}

/// Of those that lie in the image as a whole, when there are some.
double typical_radius(const std::vector<BodyEvidence>& evidence, const std::vector<bool>& good) {
  std::vector<bool> whole(good.size());
  for (std::size_t i = 0; i < good.size(); ++i) whole[i] = good[i] && evidence[i].visible > 0.95;
  const bool enough = std::count(whole.begin(), whole.end(), true) >= 3;
  return median_over(evidence, enough ? whole : good, &BodyEvidence::radius);
}

}  // namespace

BodyEvidence evidence_of_body(const ImageGrid& grid, const std::vector<Vec3>& x, const std::vector<double>& area,
                              const BodyReading& reading) {
  BodyEvidence e;
  e.contrast = reading.inside - reading.beyond;
  double total = 0.0, inside = 0.0, visible = 0.0, limited = 0.0;
  std::vector<double> free_drop, free_support, drop, support;
  for (std::size_t i = 0; i < x.size(); ++i) {
    total += area[i];
    inside += grid.contains(x[i]) ? area[i] : 0.0;
    if (reading.outside[i] != 0) continue;
    visible += 1.0;
    drop.push_back(reading.drop[i]);
    support.push_back(reading.support[i]);
    if (reading.limited[i] != 0) {
      limited += 1.0;
      continue;
    }
    free_drop.push_back(reading.drop[i]);
    free_support.push_back(reading.support[i]);
  }
  if (!(visible > 0.0)) return e;
  const bool enough = static_cast<double>(free_drop.size()) > 0.25 * visible;
  e.visible = inside / total;
  e.limited = limited / visible;
  e.drop = median_of(enough ? free_drop : drop);
  e.support = median_of(enough ? free_support : support);
  return e;
}

double ground_deviation(const BlobField& field, double radius, const std::vector<Surface>& surfaces,
                        const std::vector<bool>& counted) {
  const IndexBox all{{0, 0, 0}, field.v.grid.size};
  const Image<float> smooth =
      gaussian_smooth(crop_and_bin(field.v, all, bin_factors(field.v.grid, 0.25 * radius)), 0.25 * radius);
  std::vector<MaskPiece> pieces(surfaces.size());
  parallel_for(surfaces.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (counted[i]) pieces[i] = rasterize_piece(tessellate(surfaces[i], 2), smooth.grid);
    }
  });
  Image<std::uint8_t> taken(smooth.grid);
  for (const MaskPiece& piece : pieces) {
    if (piece.count == 0) continue;
    std::size_t inner = 0;
    for (int k = 0; k < piece.mask.grid.size[2]; ++k) {
      for (int j = 0; j < piece.mask.grid.size[1]; ++j) {
        for (int i = 0; i < piece.mask.grid.size[0]; ++i, ++inner) {
          if (piece.mask.voxels[inner] != 0) taken.at(piece.first[0] + i, piece.first[1] + j, piece.first[2] + k) = 1;
        }
      }
    }
  }
  std::vector<double> ground;
  for (std::size_t i = 0; i < taken.voxels.size(); ++i) {
    if (taken.voxels[i] == 0) ground.push_back(static_cast<double>(smooth.voxels[i]));
  }
  const double deviation = ground.empty() ? 0.0 : robust_deviation(ground);
  return std::max(deviation, 0.05 * field.noise);
}

TypicalBody typical_body(const std::vector<BodyEvidence>& evidence) {
  const std::size_t n = evidence.size();
  std::vector<bool> fitted(n), good(n);
  for (std::size_t i = 0; i < n; ++i) fitted[i] = evidence[i].radius > 0.0;
  const double half = 0.5 * median_over(evidence, fitted, &BodyEvidence::contrast);
  const double usual = median_over(evidence, fitted, &BodyEvidence::support);
  // Typical objects are among the strong blobs; debris between them is plentiful but weak.
  std::vector<double> responses;
  for (std::size_t i = 0; i < n; ++i) {
    if (fitted[i]) responses.push_back(evidence[i].response);
  }
  const double strong = responses.empty() ? 0.0 : 0.5 * quantile_of(responses, 0.98);
  // In dense tissue hardly any object is free all around: then those that touch are the measure.
  for (const double most_limited : {0.5, 2.0}) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const BodyEvidence& e = evidence[i];
      good[i] = fitted[i] && e.support > 0.95 * usual && e.limited < most_limited && e.contrast > half &&
                e.response >= strong;
      count += good[i] ? 1 : 0;
    }
    if (count >= 5 || 4 * count > n) break;
  }
  if (std::none_of(good.begin(), good.end(), [](bool g) { return g; })) good = fitted;
  return {median_over(evidence, good, &BodyEvidence::contrast), median_over(evidence, good, &BodyEvidence::drop),
          median_over(evidence, good, &BodyEvidence::response), typical_radius(evidence, good), usual};
}

std::vector<bool> accepted_objects(const std::vector<BodyEvidence>& evidence, const TypicalBody& typical,
                                   double ground_deviation, const std::optional<RadiusRange>& range) {
  const std::size_t n = evidence.size();
  std::vector<bool> alike(n);
  for (std::size_t i = 0; i < n; ++i) {
    const BodyEvidence& e = evidence[i];
    const bool as_the_others =
        e.contrast > 0.5 * typical.contrast && e.drop > 0.4 * typical.drop && e.response >= 0.5 * typical.response;
    const bool outstanding = e.drop > 6.0 * ground_deviation;
    const double volume = std::pow(e.radius / typical.radius, 3);
    const bool size =
        range ? e.radius >= 0.8 * range->min && e.radius <= 1.25 * range->max : volume > 0.1 && volume < 5.0;
    alike[i] = e.radius > 0.0 && (as_the_others || outstanding) && e.support > 0.7 * typical.support && size;
  }
  return alike;
}

std::vector<bool> without_duplicates(const std::vector<Surface>& surfaces, const std::vector<BodyEvidence>& evidence,
                                     const std::vector<bool>& counted) {
  std::vector<double> radii;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (counted[i] && evidence[i].radius > 0.0) radii.push_back(evidence[i].radius);
  }
  std::vector<bool> keep = counted;
  if (radii.empty()) return keep;
  // A common grid in the axes of the world.
  std::vector<TriangleMesh> meshes(surfaces.size());
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (!counted[i] || !(evidence[i].radius > 0.0)) continue;
    meshes[i] = tessellate(surfaces[i], 2);
    for (const Vec3& v : meshes[i].vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  }
  ImageGrid grid;
  grid.spacing = Vec3::Constant(median_of(radii) / 6.0);
  grid.origin_in_world = low;
  for (int a = 0; a < 3; ++a)
    grid.size[static_cast<std::size_t>(a)] = static_cast<int>((high[a] - low[a]) / grid.spacing[a]) + 2;
  std::vector<MaskPiece> pieces(surfaces.size());
  parallel_for(surfaces.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!meshes[i].vertices.empty()) pieces[i] = rasterize_piece(meshes[i], grid);
    }
  });
  const auto merit = [&](std::size_t i) { return evidence[i].support * evidence[i].drop; };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size() && keep[i]; ++j) {
      if (!keep[j] || pieces[i].count == 0 || pieces[j].count == 0) continue;
      const double smaller = static_cast<double>(std::min(pieces[i].count, pieces[j].count));
      if (static_cast<double>(shared_voxels(pieces[i], pieces[j])) <= 0.5 * smaller) continue;
      keep[merit(j) > merit(i) ? i : j] = false;
    }
  }
  return keep;
}

}  // namespace pellicle
