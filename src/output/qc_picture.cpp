#include "pellicle/output/qc_picture.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "pellicle/job/measure.h"
#include "pellicle/picture/slice_rows.h"

namespace pellicle {

namespace {

std::string title_of(const ObjectResult& object, const std::string& name, bool several) {
  const std::string who = several ? fmt::format("{} {} {}", name, object.label, object.name) : name;
  return fmt::format("{}   {:.4g} ml   {}", who, object.volume_surface_ml, to_string(object.fit.status));
}

}  // namespace

Canvas qc_picture(const Image<float>& image, const std::vector<ObjectResult>& objects, const std::string& name) {
  std::vector<PictureRow> rows;
  rows.reserve(objects.size());
  for (const ObjectResult& object : objects) rows.push_back({title_of(object, name, objects.size() > 1), object.mesh});
  return draw_slice_rows(image, rows);
}

Canvas overview_picture(const Image<float>& image, const std::vector<ObjectResult>& objects, const std::string& name) {
  PictureRow all{.title = {}, .mesh = merged_mesh(objects)};
  double volume = 0.0;
  std::size_t sound = 0;
  for (const ObjectResult& object : objects) {
    volume += object.volume_surface_ml;
    sound += object.fit.status == FitStatus::ok ? 1 : 0;
    const double radius = std::cbrt(750.0 * object.volume_surface_ml / std::numbers::pi);
    all.labels.push_back({std::to_string(object.label), object.shape->centre, radius});
  }
  all.title = fmt::format("{}   {} objects, {} ok   {:.4g} ml", name, objects.size(), sound, volume);
  return draw_slice_rows(image, objects.empty() ? std::vector<PictureRow>{} : std::vector{std::move(all)});
}

}  // namespace pellicle
