#include "pellicle/pipeline/qc_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/pipeline/canvas.h"
#include "pellicle/pipeline/contact_sheet.h"
#include "pellicle/pipeline/segment_many.h"
#include "pellicle/pipeline/slice_view.h"

namespace pellicle {

namespace {

constexpr int total_width = 1200, gap = 4, title_height = 34;
constexpr std::size_t most_rows = 40;  // a picture of hundreds of objects would help nobody

std::string title_of(const ObjectResult& object, const std::string& name, bool several) {
  const std::string who = several ? fmt::format("{} {} {}", name, object.label, object.name) : name;
  return fmt::format("{}   {:.4g} ml   {}", who, object.volume_surface_ml, to_string(object.fit.status));
}

std::vector<Canvas> panels_of(const Image<float>& image, const Window& window, const PictureRow& row, int size) {
  TriangleMesh in_index = row.mesh;
  for (auto& vertex : in_index.vertices) vertex = image.grid.index_from_world(vertex);
  std::vector<Canvas> panels;
  for (const Plane plane : {Plane::axial, Plane::coronal, Plane::sagittal}) {
    panels.push_back(draw_slice(image, window, in_index, plane, size, row.labels));
  }
  panels.push_back(draw_shaded(row.mesh, size));
  return panels;
}

}  // namespace

void write_pictures(const std::filesystem::path& path, const Image<float>& image, const std::vector<PictureRow>& rows) {
  const bool several = rows.size() > 1;
  const int columns = several ? 4 : 2;
  const int size = (total_width - gap * (columns - 1)) / columns;
  const std::size_t shown = std::min(rows.size(), most_rows);
  const int row_height = title_height + (4 / columns) * (size + gap);
  Canvas picture(total_width, row_height * static_cast<int>(std::max<std::size_t>(shown, 1)) - gap, {12, 13, 16});
  const Window window = robust_window(image);
  for (std::size_t r = 0; r < shown; ++r) {
    const int top = static_cast<int>(r) * row_height;
    draw_text(picture, 10, top + 10, fitting_text(rows[r].title, 2, total_width - 20), 2, {255, 255, 255});
    const auto panels = panels_of(image, window, rows[r], size);
    for (std::size_t p = 0; p < panels.size(); ++p) {
      const int column = static_cast<int>(p) % columns, row = static_cast<int>(p) / columns;
      paste(picture, panels[p], column * (size + gap), top + title_height + row * (size + gap));
    }
  }
  write_png(path, picture);
}

void write_qc_picture(const std::filesystem::path& path, const Image<float>& image,
                      const std::vector<ObjectResult>& objects, const std::string& name) {
  std::vector<PictureRow> rows;
  rows.reserve(objects.size());
  for (const ObjectResult& object : objects) rows.push_back({title_of(object, name, objects.size() > 1), object.mesh});
  write_pictures(path, image, rows);
}

void write_overview(const std::filesystem::path& path, const Image<float>& image,
                    const std::vector<ObjectResult>& objects, const std::string& name) {
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
  write_pictures(path, image, objects.empty() ? std::vector<PictureRow>{} : std::vector{std::move(all)});
}

}  // namespace pellicle
