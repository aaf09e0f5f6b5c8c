#include "pellicle/settings/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_fields.h"

namespace pellicle {
namespace fs = std::filesystem;

bool SegmentSettings::writes(const std::string& kind) const {
  return !output.empty() && std::find(write.begin(), write.end(), kind) != write.end();
}

std::vector<std::array<double, 4>> SegmentSettings::all_seed_spheres() const {
  std::vector<std::array<double, 4>> all = seed_spheres;
  for (const auto& x : seed_points) all.push_back({x[0], x[1], x[2], seed_radius});
  return all;
}

ModelKind SegmentSettings::model_kind() const {
  return model.value_or(wants_many() ? ModelKind::catmull_clark : fit.model.kind);
}

namespace {

void validate_seeds(const SegmentSettings& s) {
  const int kinds = static_cast<int>(!s.seed_spheres.empty() || !s.seed_points.empty() || s.seeds_file) +
                    static_cast<int>(s.seed_mask.has_value()) + static_cast<int>(s.seed_model.has_value()) +
                    static_cast<int>(s.seed_auto);
  if (kinds > 1) {
    throw SettingError(
        "conflicting settings", "seed-*",
        "spheres (`seed-sphere`, `seed-point`, `seeds`), `seed-mask`, `seed-model` and `seed-auto` exclude each other; "
        "keep one kind");
  }
  if (!(s.seed_radius > 0.0)) refuse_setting("seed-radius", fmt::format("{}", s.seed_radius), "must be above 0 mm");
  for (const auto& sphere : s.seed_spheres) {
    if (!(sphere[3] > 0.0)) {
      refuse_setting("seed-sphere", fmt::format("{},{},{},{}", sphere[0], sphere[1], sphere[2], sphere[3]),
                     "the radius must be above 0 mm");
    }
  }
}

void validate_many(const SegmentSettings& s) {
  if (s.radius && !(s.radius->min > 0.0 && s.radius->max >= s.radius->min && std::isfinite(s.radius->max))) {
    refuse_setting("radius", fmt::format("{},{}", s.radius->min, s.radius->max),
                   "MIN must be above 0 mm and MAX not below it");
  }
  if (!(s.valley > 0.0 && s.valley <= 1.0)) {
    refuse_setting("valley", fmt::format("{}", s.valley), "must be above 0 and at most 1");
  }
  if (!s.wants_many()) {
    if (s.radius) refuse_setting("radius", fmt::format("{},{}", s.radius->min, s.radius->max), "needs `objects` many");
    return;
  }
  if (s.points)
    throw SettingError("conflicting settings", "points, objects",
                       "expert points are for one object, not `objects` many");
  if (s.trace)
    throw SettingError("conflicting settings", "trace, objects", "a trace is of one object, not `objects` many");
  if (s.fit.start_rule == StartRule::head)
    refuse_setting("start-rule", "head", "finds one brain; it is not for `objects` many");
  if (s.fit.boundary == Boundary::ridge) {
    refuse_setting("boundary", "ridge",
                   "many objects are found by their inside; membranes are not available with `objects` many");
  }
}

void validate_outputs(const SegmentSettings& s) {
  static const std::vector<std::string> kinds{"mask", "mesh", "model", "report", "qc", "convergence", "sdf", "prob"};
  if (s.write.empty())
    refuse_setting("write", "",
                   "the list is empty; name at least one of mask, mesh, model, report, qc, convergence, sdf, prob");
  for (const auto& kind : s.write) {
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      refuse_setting("write", kind,
                     "no such output; choose from mask, mesh, model, report, qc, convergence, sdf, prob");
    }
  }
  if (s.mesh_density && (*s.mesh_density < 0 || *s.mesh_density > 7)) {
    refuse_setting("mesh-density", fmt::format("{}", *s.mesh_density),
                   "must be 0 to 7 (2^N facets along a control edge)");
  }
  if (s.output_mask && !s.output_mask->string().ends_with(".nii") && !s.output_mask->string().ends_with(".nii.gz")) {
    refuse_setting("output-mask", s.output_mask->string(), "masks are NIfTI: the name must end in .nii or .nii.gz");
  }
  if (s.output_mesh) static_cast<void>(mesh_format_of_path(*s.output_mesh));
  if (s.trace && s.trace->empty()) refuse_setting("trace", "", "name a folder");
  if (s.trace_every < 1) refuse_setting("trace-every", fmt::format("{}", s.trace_every), "must be 1 or more");
  if (s.name.find('/') != std::string::npos || s.name == "." || s.name == "..") {
    refuse_setting("name", s.name, "must be a file stem without folders; `output` names the folder");
  }
}

}  // namespace

void SegmentSettings::validate() const {
  if (input.empty()) throw SettingError("missing setting", "input", "no input volume; give `input` VOLUME");
  if (output.empty() && !output_mask && !output_mesh) {
    throw SettingError("missing setting", "output",
                       "no output folder; give `output` DIR, or `output-mask` or `output-mesh` with a file");
  }
  validate_values();
}

void SegmentSettings::validate_values() const {
  if (threads < 0) refuse_setting("threads", fmt::format("{}", threads), "must be 1 or more; 0 means all cores");
  if (spacing && !(spacing->minCoeff() > 0.0)) {
    refuse_setting("spacing", fmt::format("{},{},{}", (*spacing)[0], (*spacing)[1], (*spacing)[2]),
                   "must be above 0 mm");
  }
  validate_seeds(*this);
  validate_many(*this);
  validate_outputs(*this);
  fit.validate(points.has_value());
}

FitPlan plan_of(const SegmentSettings& settings) {
  StartKind start = StartKind::ball;
  if (settings.wants_many()) {
    start = StartKind::many;
  } else if (settings.points && may_start_at_points(settings.fit)) {
    start = StartKind::outlined;
  } else if (settings.seed_mask || settings.seed_model) {
    start = StartKind::surface;
  }
  return plan_for(settings.fit, start, settings.points.has_value());
}

std::string stem_of(const SegmentSettings& settings) {
  if (!settings.name.empty()) return settings.name;
  fs::path input = settings.input;
  if (!input.has_filename() || input.filename() == ".") input = fs::absolute(input).lexically_normal().parent_path();
  std::string stem = input.filename().string();
  static const std::vector<std::string> extensions{".gz",  ".nii",  ".nrrd", ".nhdr", ".mha", ".mhd",
                                                   ".tif", ".tiff", ".ome",  ".hdr",  ".img", ".dcm"};
  for (bool again = true; again;) {
    again = false;
    std::string lower = stem;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const auto& extension : extensions) {
      if (lower.size() > extension.size() && lower.ends_with(extension)) {
        stem.resize(stem.size() - extension.size());
        again = true;
        break;
      }
    }
  }
  return stem;
}

}  // namespace pellicle
