#include "pellicle/picture/slice_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/image/orientation.h"

namespace pellicle {

namespace {

constexpr Rgb contour_color{230, 159, 0};  // orange of the Okabe-Ito palette: distinct for every kind of colour vision
constexpr Rgb label_color{86, 180, 233};   // sky blue of the same
constexpr int label_scale = 2;
constexpr Rgb text_color{255, 255, 255};

// Index axis whose nearest anatomical axis is `axis` (0 left, 1 posterior, 2 superior) and its sign.
std::pair<int, int> axis_towards(const ImageGrid& grid, int axis) {
  static const std::string positive = "LPS", negative = "RAI";
  const std::string code = orientation_code(grid);
  const auto letter = static_cast<std::size_t>(axis);
  for (int a = 0; a < 3; ++a) {
    if (code[static_cast<std::size_t>(a)] == positive[letter]) return {a, 1};
    if (code[static_cast<std::size_t>(a)] == negative[letter]) return {a, -1};
  }
  return {axis, 1};
}

struct Span {
  double from = 0.0, to = 0.0;  ///< index coordinates
  double middle() const { return 0.5 * (from + to); }
};

// What is shown along an index axis: the object with half its size around it, within the volume, or all of it when
// the object is large anyway.
Span shown(const TriangleMesh& mesh, const ImageGrid& grid, int axis, double least_mm) {
  Span box{1e300, -1e300};
  for (const auto& v : mesh.vertices) {
    box.from = std::min(box.from, v[axis]);
    box.to = std::max(box.to, v[axis]);
  }
  const double half = std::max(1.0 * (box.to - box.from), 0.5 * least_mm / grid.spacing[axis]);
  const double last = grid.size[static_cast<std::size_t>(axis)] - 0.5;
  Span span{std::max(-0.5, box.middle() - half), std::min(last, box.middle() + half)};
  if (!(span.to - span.from >= 1.0)) span = {-0.5, last};
  return span;
}

void draw_scale_bar(Canvas& canvas, double pixels_per_mm) {
  const double wanted = 0.25 * canvas.width / pixels_per_mm;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  double length = decade;
  for (const double step : {2.0, 5.0}) {
    if (step * decade <= wanted) length = step * decade;
  }
  const int pixels = static_cast<int>(std::lround(length * pixels_per_mm));
  const int y = canvas.height - 16;
  fill_rectangle(canvas, 11, y - 1, pixels + 2, 6, {0, 0, 0});
  fill_rectangle(canvas, 12, y, pixels, 4, text_color);
  const std::string label = length >= 0.1 ? fmt::format("{:g} mm", length) : fmt::format("{:g} um", length * 1000.0);
  draw_text(canvas, 12, y - 20, label, 2, text_color);
}

void draw_letters(Canvas& canvas, const SliceAxes& axes) {
  const int middle_y = canvas.height / 2 - 10, middle_x = canvas.width / 2 - 7;
  draw_text(canvas, 8, middle_y, std::string(1, axes.left_letter), 3, text_color);
  draw_text(canvas, canvas.width - 23, middle_y, std::string(1, axes.right_letter), 3, text_color);
  draw_text(canvas, middle_x, 8, std::string(1, axes.up_letter), 3, text_color);
  draw_text(canvas, middle_x, canvas.height - 29, std::string(1, axes.down_letter), 3, text_color);
}

/// A slice on its canvas: what it shows, and where each voxel comes to lie.
struct SliceFrame {
  SliceAxes axes;
  Span across = {}, down = {};  ///< index coordinates along the picture
  double scale = 1.0;           ///< pixels per mm, the same in both directions
  double middle = 0.0;          ///< of the canvas, pixels
  int slice = 0;                ///< along the third axis

  Vec2 pixel_of(const Vec3& index, const Vec3& spacing) const {
    return {middle + axes.right_sign * (index[axes.right] - across.middle()) * spacing[axes.right] * scale,
            middle + axes.down_sign * (index[axes.down] - down.middle()) * spacing[axes.down] * scale};
  }
};

SliceFrame frame_of(const ImageGrid& grid, const TriangleMesh& mesh, const SliceAxes& axes, int size) {
  SliceFrame frame{.axes = axes};
  const double least = 12.0 * grid.mean_spacing();
  frame.across = shown(mesh, grid, axes.right, least);
  frame.down = shown(mesh, grid, axes.down, least);
  const double width_mm = (frame.across.to - frame.across.from) * grid.spacing[axes.right];
  const double height_mm = (frame.down.to - frame.down.from) * grid.spacing[axes.down];
  frame.scale = size / std::max(width_mm, height_mm);
  frame.middle = 0.5 * (size - 1);
  Span box{1e300, -1e300};
  for (const auto& v : mesh.vertices) {
    box.from = std::min(box.from, v[axes.through]);
    box.to = std::max(box.to, v[axes.through]);
  }
  const int last = grid.size[static_cast<std::size_t>(axes.through)] - 1;
  frame.slice = static_cast<int>(std::lround(std::clamp(box.middle(), 0.0, static_cast<double>(last))));
  return frame;
}

void draw_voxels(Canvas& canvas, const Image<float>& image, const Window& window, const SliceFrame& frame) {
  const ImageGrid& grid = image.grid;
  const SliceAxes& axes = frame.axes;
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      const double i =
          frame.across.middle() + axes.right_sign * (x - frame.middle) / (grid.spacing[axes.right] * frame.scale);
      const double j =
          frame.down.middle() + axes.down_sign * (y - frame.middle) / (grid.spacing[axes.down] * frame.scale);
      if (!(i >= frame.across.from && i < frame.across.to && j >= frame.down.from && j < frame.down.to)) continue;
      std::array<int, 3> index{};
      index[static_cast<std::size_t>(axes.right)] = static_cast<int>(std::lround(i));
      index[static_cast<std::size_t>(axes.down)] = static_cast<int>(std::lround(j));
      index[static_cast<std::size_t>(axes.through)] = frame.slice;
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a) inside = inside && index[a] >= 0 && index[a] < grid.size[a];
      if (!inside) continue;
      const double value = static_cast<double>(image.at(index[0], index[1], index[2]));
      const double grey = std::clamp((value - window.black) / (window.white - window.black), 0.0, 1.0);
      const auto level = static_cast<std::uint8_t>(std::lround(255.0 * grey));
      canvas.at(x, y) = {level, level, level};
    }
  }
}

void draw_label(Canvas& canvas, const ImageGrid& grid, const SliceFrame& frame, const SliceLabel& label) {
  const Vec3 at = grid.index_from_world(label.centre);
  const double off = (at[frame.axes.through] - frame.slice) * grid.spacing[frame.axes.through];
  const double radius = std::sqrt(std::max(0.0, label.radius * label.radius - off * off)) * frame.scale;  // of the cut
  const int width = text_width(label.text, label_scale);
  if (2.0 * radius < width + 4.0) return;
  const Vec2 middle_of_cut = frame.pixel_of(at, grid.spacing);
  draw_text(canvas, static_cast<int>(std::lround(middle_of_cut.x())) - width / 2,
            static_cast<int>(std::lround(middle_of_cut.y())) - 4 * label_scale, label.text, label_scale, label_color);
}

}  // namespace

SliceAxes slice_axes(const ImageGrid& grid, SlicePlane plane) {
  const auto left = axis_towards(grid, 0), posterior = axis_towards(grid, 1), superior = axis_towards(grid, 2);
  switch (plane) {
    case SlicePlane::axial:
      return {left.first, posterior.first, superior.first, left.second, posterior.second, 'R', 'L', 'A', 'P'};
    case SlicePlane::coronal:
      return {left.first, superior.first, posterior.first, left.second, -superior.second, 'R', 'L', 'S', 'I'};
    case SlicePlane::sagittal:
      return {posterior.first, superior.first, left.first, posterior.second, -superior.second, 'A', 'P', 'S', 'I'};
  }
  return {};
}

Window robust_window(const Image<float>& image) {
  const std::size_t stride = std::max<std::size_t>(1, image.voxels.size() / 200000);
  std::vector<float> values;
  for (std::size_t i = 0; i < image.voxels.size(); i += stride) values.push_back(image.voxels[i]);
  if (values.empty()) return {};
  const auto at = [&](double fraction) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return static_cast<double>(*nth);
  };
  Window window{at(0.005), at(0.995)};
  if (!(window.white > window.black)) {
    const auto [low, high] = std::minmax_element(image.voxels.begin(), image.voxels.end());
    window = {static_cast<double>(*low), static_cast<double>(*high)};
  }
  if (!(window.white > window.black)) window.white = window.black + 1.0;
  return window;
}

std::vector<std::array<Vec3, 2>> cut_by_plane(const TriangleMesh& mesh, int axis, double position) {
  std::vector<std::array<Vec3, 2>> pieces;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3, 2> ends;
    std::size_t count = 0;
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3& a = mesh.vertices[static_cast<std::size_t>(triangle[e])];
      const Vec3& b = mesh.vertices[static_cast<std::size_t>(triangle[(e + 1) % 3])];
      // A vertex exactly on the plane counts as above, so that every facet is crossed by two edges or none.
      if ((a[axis] >= position) == (b[axis] >= position)) continue;
      if (count < 2) ends[count++] = a + (position - a[axis]) / (b[axis] - a[axis]) * (b - a);
    }
    if (count == 2) pieces.push_back(ends);
  }
  return pieces;
}

Canvas draw_slice(const Image<float>& image, const Window& window, const TriangleMesh& mesh, SlicePlane plane, int size,
                  const std::vector<SliceLabel>& labels) {
  const ImageGrid& grid = image.grid;
  const SliceFrame frame = frame_of(grid, mesh, slice_axes(grid, plane), size);
  Canvas canvas(size, size);
  draw_voxels(canvas, image, window, frame);
  for (const auto& piece : cut_by_plane(mesh, frame.axes.through, frame.slice)) {
    draw_line(canvas, frame.pixel_of(piece[0], grid.spacing), frame.pixel_of(piece[1], grid.spacing),
              size >= 500 ? 2.0 : 1.5, contour_color);
  }
  for (const SliceLabel& label : labels) draw_label(canvas, grid, frame, label);
  draw_letters(canvas, frame.axes);
  draw_scale_bar(canvas, frame.scale);
  return canvas;
}

}  // namespace pellicle
