#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pellicle/synthetic/cluster.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {
namespace {

nlohmann::ordered_json list(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Column after column.
nlohmann::ordered_json list(const Mat3& m) {
  return {list(Vec3(m.col(0))), list(Vec3(m.col(1))), list(Vec3(m.col(2)))};
}

nlohmann::ordered_json json_of(const SeedDraw& seed) {
  return {{"center", list(seed.center)}, {"radius", seed.radius}};
}

/// What every phantom has, whatever the object.
void add_image_settings(const PhantomSettings& s, nlohmann::ordered_json& json) {
  json["inside"] = s.inside;
  json["outside"] = s.outside;
  json["blur_mm"] = s.blur_mm;
  json["noise"] = name_of(s.noise);
  json["snr"] = s.snr;
  json["bias"] = s.bias;
  json["seed"] = s.seed;
}

void add_grid_settings(const PhantomSettings& s, nlohmann::ordered_json& json) {
  json["size"] = s.size;
  json["spacing_mm"] = list(s.spacing);
  json["direction_degrees"] = list(s.direction_degrees);
}

nlohmann::ordered_json json_of(const PhantomSettings& s) {
  nlohmann::ordered_json json;
  json["shape"] = s.shape;
  add_grid_settings(s, json);
  json["radius_mm"] = s.radius;
  json["blob_amplitude"] = s.blob_amplitude;
  json["center_mm"] = list(s.center);
  json["fill"] = name_of(s.fill);
  json["shell_thickness_mm"] = s.shell_thickness_mm;
  add_image_settings(s, json);
  return json;
}

nlohmann::ordered_json json_of(const ClusterSettings& s) {
  nlohmann::ordered_json json;
  json["shape"] = "cluster";
  add_grid_settings(s.image, json);
  json["count"] = s.count;
  json["radius_range_mm"] = {s.radius_min, s.radius_max};
  json["elongation"] = s.elongation;
  json["distance"] = s.distance;
  json["contrast_range"] = {s.contrast_min, s.contrast_max};
  add_image_settings(s.image, json);
  return json;
}

nlohmann::ordered_json header_of(const std::string& shape) {
  nlohmann::ordered_json json;
  json["kind"] = "pellicle phantom truth";
  json["version"] = 1;
  json["space"] = "LPS";
  json["unit"] = "mm";
  json["shape"] = shape;
  return json;
}

}  // namespace

std::string truth_json(const Phantom& phantom) {
  nlohmann::ordered_json json = header_of(phantom.settings.shape);
  json["genus"] = shape_genus(phantom.settings.shape);
  json["exact_volume_ml"] = phantom.exact_volume_ml;
  json["center"] = list(phantom.body.center);
  json["natural_center"] = list(phantom.natural_center);
  json["inner_radius"] = phantom.inner_radius;
  json["shell_thickness"] = phantom.shell_thickness_mm;
  json["seeds"] = nlohmann::ordered_json::array();
  for (const SeedDraw& seed : phantom.seeds) json["seeds"].push_back(json_of(seed));
  json["settings"] = json_of(phantom.settings);
  return json.dump(2) + "\n";
}

std::string truth_json(const Cluster& cluster) {
  nlohmann::ordered_json json = header_of("cluster");
  double sum_ml = 0.0;
  nlohmann::ordered_json objects = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < cluster.bodies.size(); ++i) {
    const Body& body = cluster.bodies[i];
    const double volume_ml = exact_volume(body.shape) / 1000.0;
    sum_ml += volume_ml;
    objects.push_back({{"label", i + 1},
                       {"exact_volume_ml", volume_ml},
                       {"contrast", cluster.contrast[i]},
                       {"center", list(body.center)},
                       {"half_axes", list(half_bounds(body.shape))},
                       {"axes", list(body.world_from_shape)},
                       {"seed", json_of(cluster.seeds[i])}});
  }
  json["exact_volume_ml"] = sum_ml;
  json["objects"] = std::move(objects);
  json["settings"] = json_of(cluster.settings);
  return json.dump(2) + "\n";
}

std::string name_of(PhantomFill fill) {
  return fill == PhantomFill::solid ? "solid" : "shell";
}

std::string name_of(PhantomNoise noise) {
  switch (noise) {
    case PhantomNoise::none:
      return "none";
    case PhantomNoise::gaussian:
      return "gaussian";
    case PhantomNoise::rician:
      return "rician";
    case PhantomNoise::poisson:
      return "poisson";
  }
  return "none";
}

}  // namespace pellicle
