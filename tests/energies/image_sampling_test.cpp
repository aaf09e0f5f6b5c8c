// What energies read from images: fields, smoothing, binning, noise.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "pellicle/image/resample.h"
#include "pellicle/image/scalar_field.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

Image<float> random_image(std::uint64_t seed) {
  RandomEngine random(seed);
  Image<float> image(test::centred_grid({9, 8, 7}, {0.7, 1.1, 1.9}, test::oblique()));
  for (float& v : image.voxels) v = static_cast<float>(random.uniform(-50.0, 50.0));
  return image;
}

TEST(Fields, interpolate_the_voxels) {
  const Image<float> image = random_image(1);
  const CubicField cubic(image);
  const TrilinearField linear(image);
  for (int k = 0; k < 7; ++k) {
    for (int j = 0; j < 8; ++j) {
      for (int i = 0; i < 9; ++i) {
        const Vec3 x = image.grid.world_from_index(Vec3(i, j, k));
        EXPECT_NEAR(cubic.value(x), image.at(i, j, k), 1e-4);
        EXPECT_NEAR(linear.at(x), image.at(i, j, k), 1e-3);
      }
    }
  }
}

TEST(CubicField, gradient_is_its_derivative) {
  const Image<float> image = random_image(2);
  const CubicField field(image);
  RandomEngine random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 x = image.grid.world_from_index(
        Vec3(random.uniform(-1.0, 9.0), random.uniform(-1.0, 8.0), random.uniform(-1.0, 7.0)));
    Vec3 gradient;
    EXPECT_EQ(field.value(x, gradient), field.value(x));
    for (int a = 0; a < 3; ++a) {
      const double step = 1e-5;
      const double slope = (field.value(x + step * Vec3::Unit(a)) - field.value(x - step * Vec3::Unit(a))) / (2 * step);
      EXPECT_NEAR(gradient[a], slope, 2e-3);
    }
  }
}

TEST(CubicField, value_and_gradient_are_continuous_across_voxels) {
  const Image<float> image = random_image(4);
  const CubicField field(image);
  RandomEngine random(5);
  for (int trial = 0; trial < 300; ++trial) {
    Vec3 index(random.uniform(0.0, 8.0), random.uniform(0.0, 7.0), random.uniform(0.0, 6.0));
    const int axis = trial % 3;
    index[axis] = std::floor(index[axis]);
    Vec3 before = index, after = index, slope_before, slope_after;
    before[axis] -= 1e-9;
    after[axis] += 1e-9;
    EXPECT_NEAR(field.value(image.grid.world_from_index(before), slope_before),
                field.value(image.grid.world_from_index(after), slope_after), 1e-5);
    EXPECT_LE((slope_before - slope_after).norm(), 1e-4);
  }
}

TEST(CubicField, reproduces_quadratics) {
  const ImageGrid grid = test::centred_grid({12, 11, 10}, {0.7, 1.1, 1.9}, test::oblique());
  const auto f = [](const Vec3& x) { return 1 + x.x() - 2 * x.y() * x.z() + 0.5 * x.z() * x.z() - x.x() * x.x(); };
  const Image<float> image = test::image_of(grid, f);
  const CubicField field(image);
  RandomEngine random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 x =
        grid.world_from_index(Vec3(random.uniform(2.0, 9.0), random.uniform(2.0, 8.0), random.uniform(2.0, 7.0)));
    Vec3 gradient;
    EXPECT_NEAR(field.value(x, gradient), f(x), 1e-4);
    EXPECT_LE((gradient - Vec3(1 - 2 * x.x(), -2 * x.z(), -2 * x.y() + x.z())).norm(), 1e-3);
  }
}

TEST(TrilinearField, is_nan_beyond_half_a_voxel_and_continued_up_to_there) {
  const Image<float> image = random_image(7);
  const TrilinearField field(image);
  const auto at = [&](double i, double j, double k) { return field.at(image.grid.world_from_index(Vec3(i, j, k))); };
  EXPECT_NEAR(at(-0.49, 3, 3), image.at(0, 3, 3), 1e-4);
  EXPECT_NEAR(at(8.49, 3, 3), image.at(8, 3, 3), 1e-4);
  for (const auto& [i, j, k] : {std::array{-0.51, 3.0, 3.0}, std::array{8.51, 3.0, 3.0}, std::array{3.0, -0.51, 3.0},
                                std::array{3.0, 7.51, 3.0}, std::array{3.0, 3.0, -0.51}, std::array{3.0, 3.0, 6.51},
                                std::array{1e9, 0.0, 0.0}, std::array{0.0, std::nan(""), 0.0}}) {
    EXPECT_TRUE(std::isnan(at(i, j, k))) << i << " " << j << " " << k;
  }
  std::vector<float> line(40);
  const Vec3 start = image.grid.world_from_index(Vec3(-3, 2.2, 3.3)), step = image.grid.direction.col(0) * 0.35;
  field.along_line(start, step, 40, line.data());
  for (int i = 0; i < 40; ++i) {
    const float single = field.at(start + i * step);
    if (std::isnan(single)) {
      EXPECT_TRUE(std::isnan(line[static_cast<std::size_t>(i)]));
    } else {
      EXPECT_NEAR(line[static_cast<std::size_t>(i)], single, 1e-4);
    }
  }
}

TEST(TrilinearField, one_slice_is_enough) {
  Image<float> image(test::centred_grid({3, 3, 1}, {1, 1, 1}), 4.0F);
  EXPECT_EQ(TrilinearField(image).at(Vec3(0.3, -0.2, 0.4)), 4.0F);
}

TEST(GaussianSmooth, variances_add_on_anisotropic_oblique_grids) {
  // A Gaussian of 4 mm becomes one of sqrt(16 + s^2) mm; its peak falls by the ratio of the widths cubed.
  const ImageGrid grid = test::centred_grid({61, 51, 31}, {0.8, 1.0, 1.6}, test::oblique());
  const double s0 = 4.0;
  const Image<float> image =
      test::image_of(grid, [&](const Vec3& x) { return 1000 * std::exp(-0.5 * x.squaredNorm() / (s0 * s0)); });
  for (const double s : {1.0, 2.0, 3.0}) {
    const Image<float> smooth = gaussian_smooth(image, s);
    const double s1 = std::sqrt(s0 * s0 + s * s), peak = 1000 * std::pow(s0 / s1, 3);
    double worst = 0.0;
    for (int k = 0; k < 31; ++k) {
      for (int j = 0; j < 51; ++j) {
        for (int i = 0; i < 61; ++i) {
          const Vec3 x = grid.world_from_index(Vec3(i, j, k));
          if (x.cwiseAbs().maxCoeff() > 10.0) continue;  // away from the border's continuation
          worst = std::max(worst, std::abs(smooth.at(i, j, k) - peak * std::exp(-0.5 * x.squaredNorm() / (s1 * s1))));
        }
      }
    }
    EXPECT_LE(worst / peak, 0.02) << "sigma " << s;
  }
}

TEST(GaussianSmooth, impulse_response_has_the_variance_asked_for) {
  for (const double s : {1.0, 1.5, 2.5}) {
    Image<float> image(test::centred_grid({41, 33, 25}, {0.6, 0.8, 1.1}));
    image.at(20, 16, 12) = 1000.0F;
    image = gaussian_smooth(image, s);
    Vec3 variance = Vec3::Zero();
    double mass = 0.0;
    for (int k = 0; k < 25; ++k) {
      for (int j = 0; j < 33; ++j) {
        for (int i = 0; i < 41; ++i) {
          variance += image.at(i, j, k) * image.grid.world_from_index(Vec3(i, j, k)).cwiseAbs2();
          mass += image.at(i, j, k);
        }
      }
    }
    variance /= mass;
    EXPECT_NEAR(mass, 1000.0, 0.1);
    // Integration over the voxel adds a twelfth of its square, the cut at 3.5 sigma takes a little.
    for (int a = 0; a < 3; ++a) {
      const double h = image.grid.spacing[a];
      EXPECT_NEAR(variance[a], s * s + h * h / 12.0, 0.02 * s * s) << "axis " << a << " sigma " << s;
    }
  }
}

TEST(GaussianSmooth, keeps_constants_up_to_the_border_and_leaves_tiny_sigmas_alone) {
  Image<float> constant(test::centred_grid({10, 7, 1}, {0.5, 1.0, 3.0}), 12.5F);
  for (const float v : gaussian_smooth(constant, 2.0).voxels) EXPECT_NEAR(v, 12.5, 1e-4);
  const Image<float> image = random_image(8);
  EXPECT_EQ(gaussian_smooth(image, 0.05).voxels, image.voxels);
  EXPECT_EQ(gaussian_smooth(image, 0.0).voxels, image.voxels);
}

TEST(CropAndBin, keeps_world_positions_and_means) {
  // A linear image: the mean of a block is the value at the block's centre, wherever the block lies.
  const ImageGrid grid = test::centred_grid({23, 18, 14}, {0.7, 1.1, 1.9}, test::oblique());
  const auto f = [](const Vec3& x) { return 3 + 2 * x.x() - x.y() + 0.5 * x.z(); };
  const Image<float> image = test::image_of(grid, f);
  const Image<float> out = crop_and_bin(image, {{3, 2, 1}, {18, 12, 12}}, {3, 2, 1});
  EXPECT_EQ(out.grid.size, (Index3{6, 6, 12}));
  EXPECT_LE((out.grid.spacing - Vec3(2.1, 2.2, 1.9)).norm(), 1e-12);
  for (int k = 0; k < 12; ++k) {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(out.at(i, j, k), f(out.grid.world_from_index(Vec3(i, j, k))), 1e-3);
    }
  }
  // Blocks cut short by the box are means of what they hold.
  const Image<float> constant(grid, 5.0F);
  for (const float v : crop_and_bin(constant, {{0, 0, 0}, grid.size}, {4, 4, 4}).voxels) EXPECT_EQ(v, 5.0F);
  EXPECT_EQ(crop_and_bin(image, {{0, 0, 0}, grid.size}, {1, 1, 1}).voxels, image.voxels);
}

TEST(BoxAround, holds_what_was_asked_for_and_never_nothing) {
  const ImageGrid grid = test::centred_grid({30, 30, 30}, {1, 1, 2}, test::oblique());
  const IndexBox box = box_around(grid, Vec3(-2, -3, -1), Vec3(4, 1, 2), 1.5);
  RandomEngine random(9);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 x(random.uniform(-3.5, 5.5), random.uniform(-4.5, 2.5), random.uniform(-2.5, 3.5));
    const Vec3 i = grid.index_from_world(x);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(i[static_cast<int>(a)], box.begin[a] - 1e-9);
      EXPECT_LE(i[static_cast<int>(a)], box.begin[a] + box.size[a] - 1 + 1e-9);
    }
  }
  const IndexBox away = box_around(grid, Vec3(500, 500, 500), Vec3(501, 501, 501), 1.0);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_GE(away.size[a], 1);
    EXPECT_GE(away.begin[a], 0);
    EXPECT_LE(away.begin[a] + away.size[a], 30);
  }
}

TEST(BinFactors, come_nearest_and_never_up_sample) {
  const ImageGrid grid = test::centred_grid({100, 100, 2}, {0.5, 1.0, 3.0});
  EXPECT_EQ(bin_factors(grid, 1.0), (Index3{2, 1, 1}));
  EXPECT_EQ(bin_factors(grid, 0.1), (Index3{1, 1, 1}));
  EXPECT_EQ(bin_factors(grid, 1e9), (Index3{100, 100, 2}));
}

TEST(Noise, of_known_deviation_is_found_with_and_without_an_object) {
  RandomEngine random(10);
  for (const double contrast : {0.0, 80.0}) {
    Image<float> image = test::image_of(test::centred_grid({48, 48, 48}, {1, 1, 1}), [&](const Vec3& x) {
      return 20.0 + contrast * test::blurred_ball(x.norm(), 12.0, 1.0) + 3.0 * random.normal();
    });
    EXPECT_NEAR(noise_of(image, {{0, 0, 0}, image.grid.size}), 3.0, contrast > 0.0 ? 0.3 : 0.1);
    for (float& v : image.voxels) v = 7 * v + 100;
    EXPECT_NEAR(noise_of(image, {{0, 0, 0}, image.grid.size}), 21.0, contrast > 0.0 ? 2.1 : 0.7);
  }
  const Image<float> flat(test::centred_grid({5, 5, 1}, {1, 1, 1}), 7.0F);
  EXPECT_EQ(noise_of(flat, {{0, 0, 0}, flat.grid.size}), 0.0);
}

}  // namespace
}  // namespace pellicle
