#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pellicle/base/errors.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {
namespace {

nlohmann::ordered_json list(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::ordered_json json_of(const PhantomSettings& s) {
  nlohmann::ordered_json json;
  json["shape"] = s.shape;
  json["size"] = s.size;
  json["spacing_mm"] = list(s.spacing);
  json["direction_degrees"] = list(s.direction_degrees);
  json["radius_mm"] = s.radius;
  json["blob_amplitude"] = s.blob_amplitude;
  json["center_mm"] = list(s.center);
  json["fill"] = name_of(s.fill);
  json["shell_thickness_mm"] = s.shell_thickness_mm;
  json["inside"] = s.inside;
  json["outside"] = s.outside;
  json["blur_mm"] = s.blur_mm;
  json["noise"] = name_of(s.noise);
  json["snr"] = s.snr;
  json["bias"] = s.bias;
  json["seed"] = s.seed;
  return json;
}

}  // namespace

std::string truth_json(const Phantom& phantom) {
  nlohmann::ordered_json json;
  json["kind"] = "pellicle phantom truth";
  json["version"] = 1;
  json["space"] = "LPS";
  json["unit"] = "mm";
  json["shape"] = phantom.settings.shape;
  json["exact_volume_ml"] = phantom.exact_volume_ml;
  json["center"] = list(phantom.body.center);
  json["natural_center"] = list(phantom.natural_center);
  json["inner_radius"] = phantom.inner_radius;
  json["shell_thickness"] = phantom.shell_thickness_mm;
  json["seeds"] = nlohmann::ordered_json::array();
  for (const SeedDraw& seed : phantom.seeds) {
    json["seeds"].push_back({{"center", list(seed.center)}, {"radius", seed.radius}});
  }
  json["settings"] = json_of(phantom.settings);
  return json.dump(2) + "\n";
}

PhantomFill phantom_fill_from_name(const std::string& name) {
  if (name == "solid") return PhantomFill::solid;
  if (name == "shell") return PhantomFill::shell;
  throw UsageError(fmt::format("unknown fill (--fill {}): choose solid or shell", name));
}

PhantomNoise phantom_noise_from_name(const std::string& name) {
  for (const PhantomNoise noise :
       {PhantomNoise::none, PhantomNoise::gaussian, PhantomNoise::rician, PhantomNoise::poisson}) {
    if (name == name_of(noise)) return noise;
  }
  throw UsageError(fmt::format("unknown noise (--noise {}): choose none, gaussian, rician or poisson", name));
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
