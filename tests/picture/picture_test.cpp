#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../all_grids.h"
#include "pellicle/image/orientation.h"
#include "pellicle/picture/font.h"
#include "pellicle/picture/line_plot.h"
#include "pellicle/picture/slice_view.h"
#include "pellicle/surface/surface.h"

namespace pellicle {
namespace {

// A bright patch at the patient's left front must appear at the same place whatever the storage order.
TEST(SliceView, ShowsThePatientTheSameWayForEveryStorageOrder) {
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const TriangleMesh ball = tessellate({model, affine_image(model, Vec3::Zero(), 4.0 * Mat3::Identity())}, 3);
  for (const auto& grid : test::all_grids()) {
    Image<float> image(grid);
    for (int k = 0; k < grid.size[2]; ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        for (int i = 0; i < grid.size[0]; ++i) {
          const Vec3 x = grid.world_from_index(Vec3(i, j, k));
          image.at(i, j, k) = x.x() > 1.5 && x.y() < -1.5 && x.z() > 1.5 ? 1.0F : (x.norm() < 2.0 ? 0.4F : 0.0F);
        }
      }
    }
    // Move the slice into the patch by moving the ball there.
    TriangleMesh in_index = ball;
    for (auto& v : in_index.vertices) v = grid.index_from_world(v + Vec3(3, -3, 3));
    constexpr int size = 101;
    const auto bright = [](const Canvas& c, int x, int y) {
      return c.pixels[static_cast<std::size_t>(y * size + x)][0] > 200;
    };
    const Canvas axial = draw_slice(image, {0, 1}, in_index, SlicePlane::axial, size);
    EXPECT_TRUE(bright(axial, 66, 36)) << orientation_code(grid);  // left is right, front is up
    EXPECT_FALSE(bright(axial, 14, 80)) << orientation_code(grid);
    const Canvas coronal = draw_slice(image, {0, 1}, in_index, SlicePlane::coronal, size);
    EXPECT_TRUE(bright(coronal, 66, 36)) << orientation_code(grid);
    EXPECT_FALSE(bright(coronal, 14, 80)) << orientation_code(grid);
    const Canvas sagittal = draw_slice(image, {0, 1}, in_index, SlicePlane::sagittal, size);
    EXPECT_TRUE(bright(sagittal, 36, 36)) << orientation_code(grid);  // front is left
    EXPECT_FALSE(bright(sagittal, 80, 80)) << orientation_code(grid);
  }
}

TEST(SliceView, LabelsStandWhereTheirObjectIsCutAndHasRoom) {
  ImageGrid grid;
  grid.size = {40, 40, 40};
  const Image<float> image(grid);
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const TriangleMesh ball = tessellate({model, affine_image(model, Vec3(20, 20, 20), 8.0 * Mat3::Identity())}, 3);
  const auto drawn = [&](const SliceLabel& label) {
    return draw_slice(image, {0, 1}, ball, SlicePlane::axial, 300, {label}).pixels !=
           draw_slice(image, {0, 1}, ball, SlicePlane::axial, 300).pixels;
  };
  EXPECT_TRUE(drawn({"7", Vec3(20, 20, 20), 8.0}));
  EXPECT_TRUE(drawn({"7", Vec3(20, 20, 15), 8.0}));
  EXPECT_FALSE(drawn({"7", Vec3(20, 20, 10), 8.0}));  // the slice passes it by
  EXPECT_FALSE(drawn({"7", Vec3(20, 20, 20), 0.5}));  // smaller than the figure
}

TEST(SliceView, CutOfABallIsAClosedCircle) {
  const NormalModel model = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
  const TriangleMesh ball = tessellate({model, affine_image(model, Vec3(10, 10, 10), 6.0 * Mat3::Identity())}, 5);
  const auto pieces = cut_by_plane(ball, 2, 12.0);
  const double radius = std::sqrt(36.0 - 4.0);
  double length = 0.0;
  for (const auto& piece : pieces) {
    for (const auto& end : piece) EXPECT_NEAR((end - Vec3(10, 10, 12)).norm(), radius, 0.02);
    length += (piece[1] - piece[0]).norm();
  }
  EXPECT_NEAR(length, 2.0 * std::numbers::pi * radius, 0.1);
}

TEST(CountTicks, AreRoundEvenAndFew) {
  for (const double high : {1.5, 7.5, 33.5, 120.5, 4711.5}) {
    const auto ticks = count_ticks(0.5, high, 12);
    ASSERT_FALSE(ticks.empty()) << high;
    EXPECT_LE(ticks.size(), 13U) << high;
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      EXPECT_EQ(ticks[i], std::round(ticks[i]));
      EXPECT_TRUE(ticks[i] >= 0.5 && ticks[i] <= high);
      if (i > 1) {
        EXPECT_EQ(ticks[i] - ticks[i - 1], ticks[1] - ticks[0]) << high;
      }
    }
  }
}

TEST(LinearTicks, AreRoundEvenAndFew) {
  for (const auto& [low, high] :
       std::vector<std::pair<double, double>>{{0, 3.3}, {-0.4, 7}, {1e-5, 9e-5}, {970, 1030}}) {
    const auto ticks = linear_ticks(low, high);
    ASSERT_GE(ticks.size(), 3U) << low << " " << high;
    EXPECT_LE(ticks.size(), 11U);
    EXPECT_GE(ticks.front(), low - 1e-12);
    EXPECT_LE(ticks.back(), high * (1 + 1e-12));
    for (std::size_t i = 2; i < ticks.size(); ++i)
      EXPECT_NEAR(ticks[i] - ticks[i - 1], ticks[1] - ticks[0], 1e-9 * (high - low));
  }
}

TEST(LinePlot, HoldsEveryCurveAndItsGaps) {
  LinePlot plot{.title = "t",
                .x_label = "step",
                .y_label = "e",
                .curves = {},
                .x_scale = PlotScale::counts,
                .spans = {{"a", 0.5, 2.5}, {"b", 2.5, 4.5}}};
  const Rgb red{255, 0, 0};
  const double gap = std::nan("");
  plot.curves = {{"c", red, {{1, 10}, {2, 10}, {2.5, gap}, {3, 10}, {4, 10}}}};
  const auto columns = [&](const LinePlot& one) {
    const Canvas canvas = draw_line_plot(one, 600, 400);
    int count = 0;
    for (int x = 115; x < 565; ++x) {  // below the key
      bool hit = false;
      for (int y = 150; y < 320; ++y) hit = hit || canvas.pixels[static_cast<std::size_t>(y * 600 + x)] == red;
      count += hit ? 1 : 0;
    }
    return count;
  };
  const int with_gap = columns(plot);
  plot.curves[0].points.erase(plot.curves[0].points.begin() + 2);
  const int without = columns(plot);
  EXPECT_GT(with_gap, 200);
  EXPECT_GT(without, with_gap + 80);  // a step is 115 pixels wide
}

TEST(Font, PrintableCharactersDiffer) {
  const auto bits = [](char c) {
    std::string text;
    for (int row = 0; row < glyph_height; ++row) {
      for (int column = 0; column < glyph_width; ++column) text += glyph_pixel(c, column, row) ? '#' : '.';
    }
    return text;
  };
  std::vector<std::string> all;
  for (char c = 32; c < 127; ++c) all.push_back(bits(c));
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
  EXPECT_EQ(bits('\n'), bits('?'));
  EXPECT_EQ(bits('L'), "#....#....#....#....#....#....#####");
}

}  // namespace
}  // namespace pellicle
