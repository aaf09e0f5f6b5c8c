#include "pellicle/picture/slice_rows.h"

#include <algorithm>

#include "pellicle/picture/contact_sheet.h"
#include "pellicle/picture/shaded_view.h"

namespace pellicle {

namespace {

constexpr int kTotalWidth = 1200, kGap = 4, kTitleHeight = 34;
constexpr std::size_t kMostRows = 40;  // a picture of hundreds of objects would help nobody

}  // namespace

std::vector<Canvas> views_of(const Image<float>* image, const Window& window, const PictureRow& row, int size) {
  std::vector<Canvas> views;
  if (image != nullptr) {
    TriangleMesh in_index = row.mesh;
    for (auto& vertex : in_index.vertices) vertex = image->grid.index_from_world(vertex);
    for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal}) {
      views.push_back(draw_slice(*image, window, in_index, plane, size, row.labels));
    }
  }
  views.push_back(draw_shaded(row.mesh, size));
  return views;
}

Canvas draw_slice_rows(const Image<float>& image, const std::vector<PictureRow>& rows) {
  const bool several = rows.size() > 1;
  const int columns = several ? 4 : 2;
  const int size = (kTotalWidth - kGap * (columns - 1)) / columns;
  const std::size_t shown = std::min(rows.size(), kMostRows);
  const int row_height = kTitleHeight + (4 / columns) * (size + kGap);
  Canvas picture(kTotalWidth, row_height * static_cast<int>(std::max<std::size_t>(shown, 1)) - kGap, {12, 13, 16});
  const Window window = robust_window(image);
  for (std::size_t r = 0; r < shown; ++r) {
    const int top = static_cast<int>(r) * row_height;
    draw_text(picture, 10, top + 10, fitting_text(rows[r].title, 2, kTotalWidth - 20), 2, {255, 255, 255});
    const auto views = views_of(&image, window, rows[r], size);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const int column = static_cast<int>(v) % columns, row = static_cast<int>(v) / columns;
      paste(picture, views[v], column * (size + kGap), top + kTitleHeight + row * (size + kGap));
    }
  }
  return picture;
}

}  // namespace pellicle
