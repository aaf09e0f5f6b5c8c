#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "pellicle/pipeline/convergence_picture.h"
#include "pellicle/pipeline/font.h"
#include "pellicle/pipeline/report.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/pipeline/slice_view.h"
#include "pellicle/pipeline/voxels.h"
#include "pellicle/surface/surface.h"

namespace pellicle {
namespace {

// Every storage order and sign: 48 grids.
std::vector<ImageGrid> all_grids() {
  std::vector<ImageGrid> grids;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      ImageGrid grid;
      grid.size = {20, 24, 28};
      grid.spacing = {1.0, 0.8, 1.3};
      grid.direction.setZero();
      for (int a = 0; a < 3; ++a) {
        grid.direction(order[static_cast<std::size_t>(a)], a) = (signs >> a & 1) != 0 ? -1.0 : 1.0;
      }
      const Vec3 middle(9.5, 11.5, 13.5);
      grid.origin_in_world = -(grid.world_from_index_matrix() * middle);
      grids.push_back(grid);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return grids;
}

TEST(Orientation, CodeNamesTheDirectionOfEachAxis) {
  for (const auto& grid : all_grids()) {
    const std::string code = orientation_code(grid);
    for (int a = 0; a < 3; ++a) {
      const Vec3 towards = grid.direction.col(a);
      const std::string letters = "LPSRAI";
      const auto at = letters.find(code[static_cast<std::size_t>(a)]);
      ASSERT_NE(at, std::string::npos);
      EXPECT_EQ(towards[static_cast<int>(at % 3)], at < 3 ? 1.0 : -1.0);
    }
  }
}

TEST(Coords, AllFramesNameTheSamePlace) {
  for (const auto& grid : all_grids()) {
    const Vec3 index(3, 7, 11), lps = grid.world_from_index(index);
    EXPECT_LE((world_from_coords(index, Coords::ijk, grid) - lps).norm(), 1e-12);
    EXPECT_LE((world_from_coords(lps, Coords::lps, grid) - lps).norm(), 1e-12);
    EXPECT_LE((world_from_coords({-lps.x(), -lps.y(), lps.z()}, Coords::ras, grid) - lps).norm(), 1e-12);
  }
}

// A bright patch at the patient's left front must appear at the same place whatever the storage order.
TEST(SliceView, ShowsThePatientTheSameWayForEveryStorageOrder) {
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const TriangleMesh ball = tessellate({model, affine_image(model, Vec3::Zero(), 4.0 * Mat3::Identity())}, 3);
  for (const auto& grid : all_grids()) {
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
    const Canvas axial = draw_slice(image, {0, 1}, in_index, Plane::axial, size);
    EXPECT_TRUE(bright(axial, 66, 36)) << orientation_code(grid);  // left is right, front is up
    EXPECT_FALSE(bright(axial, 14, 80)) << orientation_code(grid);
    const Canvas coronal = draw_slice(image, {0, 1}, in_index, Plane::coronal, size);
    EXPECT_TRUE(bright(coronal, 66, 36)) << orientation_code(grid);
    EXPECT_FALSE(bright(coronal, 14, 80)) << orientation_code(grid);
    const Canvas sagittal = draw_slice(image, {0, 1}, in_index, Plane::sagittal, size);
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
    return draw_slice(image, {0, 1}, ball, Plane::axial, 300, {label}).pixels !=
           draw_slice(image, {0, 1}, ball, Plane::axial, 300).pixels;
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

TEST(Voxels, BoxHoldsTheMeshAndStaysInside) {
  const NormalModel model = NormalModel::start(StartSolid::octahedron, SubdivisionRule::smooth);
  for (const auto& grid : all_grids()) {
    const TriangleMesh ball = tessellate({model, affine_image(model, Vec3(5, 4, -9), 6.0 * Mat3::Identity())}, 3);
    const Box box = box_around(ball, grid, 1);
    ASSERT_FALSE(box.empty());
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(box.first[a], 0);
      EXPECT_LE(box.first[a] + box.grid.size[a], grid.size[a]);
    }
    for (const auto& v : ball.vertices) {
      if (grid.contains(v)) {
        EXPECT_TRUE(box.grid.contains(v));
      }
    }
    const TriangleMesh away = tessellate({model, affine_image(model, Vec3(500, 0, 0), Mat3::Identity())}, 2);
    EXPECT_TRUE(box_around(away, grid, 2).empty());
  }
}

TEST(SignedDistance, OfABallIsThatOfABall) {
  const NormalModel model = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
  const Vec3 center(1, 2, 3);
  const Surface ball{model, affine_image(model, center, 6.0 * Mat3::Identity())};
  ImageGrid grid;
  grid.size = {50, 40, 30};
  grid.spacing = {0.7, 0.9, 1.2};
  grid.origin_in_world = {-16, -17, -15};
  const Image<float> distance = signed_distance(ball, tessellate(ball, 6), grid);
  double worst_near = 0.0, worst_far = 0.0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const double exact = (grid.world_from_index(Vec3(i, j, k)) - center).norm() - 6.0;
        const double error = std::abs(static_cast<double>(distance.at(i, j, k)) - exact);
        double& worst = std::abs(exact) < 9.0 * grid.mean_spacing() ? worst_near : worst_far;
        worst = std::max(worst, std::abs(exact) < 9.0 * grid.mean_spacing() ? error : error / std::abs(exact));
      }
    }
  }
  EXPECT_LE(worst_near, 0.01);  // chords of the tessellation
  EXPECT_GT(worst_far, 0.0);
  EXPECT_LE(worst_far, 0.01);
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

TEST(Convergence, CurvesAreTheEnergiesAndBreakBetweenStages) {
  StageSummary first, none, second;
  first.name = "coarse";
  first.history = {{0.5, {{"edge", 4.0}, {"bending", 1.0}}}, {0.2, {{"edge", 2.0}, {"bending", 0.5}}}};
  second.name = "fine";
  second.history = {{0.1, {{"edge", 9.0}}}};
  FitSummary fit;
  fit.stages = {first, none, second};
  const LinePlot plot = convergence_of(fit, "it");
  ASSERT_EQ(plot.spans.size(), 2U);
  EXPECT_EQ(plot.spans[0].to, plot.spans[1].from);
  EXPECT_EQ(plot.spans[1].to - plot.spans[1].from, 1.0);
  ASSERT_EQ(plot.curves.size(), 3U);
  std::map<std::string, std::map<double, double>> drawn;
  for (const auto& curve : plot.curves) {
    double last_step = 0.0;
    for (const auto& p : curve.points) {
      if (std::isfinite(p.y())) drawn[curve.name][p.x()] = p.y();
      if (std::isfinite(p.y()) && p.x() == 3.0) {
        EXPECT_EQ(last_step, 2.5);  // a gap at the stage's start
      }
      last_step = p.x();
    }
  }
  EXPECT_EQ(drawn["edge"], (std::map<double, double>{{1, 4}, {2, 2}, {3, 9}}));
  EXPECT_EQ(drawn["bending"], (std::map<double, double>{{1, 1}, {2, 0.5}}));
  EXPECT_EQ(drawn["sum"], (std::map<double, double>{{1, 5}, {2, 2.5}, {3, 9}}));
}

TEST(Convergence, ThePlotHoldsEveryCurveAndItsGaps) {
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
