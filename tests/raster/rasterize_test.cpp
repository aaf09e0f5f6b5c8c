#include "pellicle/raster/rasterize.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "../mesh/test_meshes.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {
namespace {

// Independent oracle: the solid angle of all facets seen from x over 4 pi (van Oosterom and Strackee 1983), in the
// world.
double winding_number(const TriangleMesh& m, const Vec3& x) {
  double sum = 0.0;
  for (const auto& t : m.triangles) {
    const Vec3 a = m.vertices[std::size_t(t[0])] - x, b = m.vertices[std::size_t(t[1])] - x,
               c = m.vertices[std::size_t(t[2])] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

// Oblique, anisotropic, every second one left-handed, about a given centre.
ImageGrid random_grid(RandomEngine& random, const Index3& size, double spacing, const Vec3& centre) {
  ImageGrid g;
  g.size = size;
  g.spacing = spacing * Vec3(random.uniform(0.6, 1.0), random.uniform(0.8, 1.2), random.uniform(1.5, 2.5));
  g.direction = test::random_rotation(random);
  if (random.next() % 2 == 0) g.direction.col(1) *= -1.0;
  const Vec3 middle(0.5 * (size[0] - 1), 0.5 * (size[1] - 1), 0.5 * (size[2] - 1));
  g.origin_in_world = centre - g.direction * g.spacing.cwiseProduct(middle);
  return g;
}

template <class Visit>
void for_each_voxel(const ImageGrid& g, const Visit& visit) {
  for (int k = 0; k < g.size[2]; ++k) {
    for (int j = 0; j < g.size[1]; ++j) {
      for (int i = 0; i < g.size[0]; ++i) visit(i, j, k);
    }
  }
}

double sum_of(const Image<float>& image) {
  return std::accumulate(image.voxels.begin(), image.voxels.end(), 0.0);
}
double sum_of(const Image<std::uint8_t>& image) {
  return static_cast<double>(std::accumulate(image.voxels.begin(), image.voxels.end(), std::size_t{0}));
}

TEST(RasterizeMask, IsTheWindingNumberOnAnyGrid) {
  RandomEngine random(1);
  for (int trial = 0; trial < 8; ++trial) {
    const Vec3 centre(300, -200, 100);
    const TriangleMesh m = trial % 2 == 0 ? test::blob(2, 8, centre) : test::torus(24, 12, 8, 2, centre);
    const ImageGrid g =
        random_grid(random, {27, 22, 14}, 0.9, centre + Vec3(random.normal(), random.normal(), random.normal()));
    const Image<std::uint8_t> mask = rasterize_mask(m, g);
    std::size_t inside = 0;
    for_each_voxel(g, [&](int i, int j, int k) {
      const double w = winding_number(m, g.world_from_index(Vec3(i, j, k)));
      ASSERT_EQ(mask.at(i, j, k) != 0, w > 0.5) << w << " at " << i << ' ' << j << ' ' << k;
      inside += mask.at(i, j, k);
    });
    EXPECT_GT(inside, 200U);
  }
}

TEST(RasterizeMask, CavitiesOverlapsAndThinWalls) {
  ImageGrid g;
  g.size = {48, 48, 48};
  const Vec3 c(23.4, 24.1, 23.8);
  const double outer = sum_of(rasterize_mask(test::sphere(4, 20, c), g)),
               inner = sum_of(rasterize_mask(test::sphere(4, 10, c), g));
  // A shell keeps its cavity, and an island in the cavity is back inside.
  const TriangleMesh shell = test::together(test::sphere(4, 20, c), test::inside_out(test::sphere(4, 10, c)));
  EXPECT_EQ(sum_of(rasterize_mask(shell, g)), outer - inner);
  EXPECT_EQ(sum_of(rasterize_mask(test::together(shell, test::sphere(4, 10, c)), g)), outer);
  // Nested shells of equal orientation are solid, not hollow.
  EXPECT_EQ(sum_of(rasterize_mask(test::together(test::sphere(4, 20, c), test::sphere(4, 10, c)), g)), outer);
  // A wall of 0.02 voxels about voxel centres is seen where it holds them, and nowhere else.
  EXPECT_EQ(sum_of(rasterize_mask(test::box({4.5, 4.5, 10.99}, {30.5, 30.5, 11.01}), g)), 26.0 * 26.0);
  EXPECT_EQ(sum_of(rasterize_mask(test::box({4.5, 4.5, 10.4}, {30.5, 30.5, 10.6}), g)), 0.0);
  // Inside out: nothing is enclosed.
  EXPECT_EQ(sum_of(rasterize_mask(test::inside_out(test::sphere(4, 20, c)), g)), 0.0);
}

// Faces exactly through voxel centres: half-open, so that boxes side by side have no voxel in common and leave none out.
TEST(RasterizeMask, BoxesOnVoxelCentresTile) {
  ImageGrid g;
  g.size = {12, 12, 12};
  Image<std::uint8_t> sum(g);
  for (int c = 0; c < 8; ++c) {
    const Vec3 lo((c & 1) * 4 + 1, (c >> 1 & 1) * 4 + 1, (c >> 2) * 4 + 1);
    const Image<std::uint8_t> mask = rasterize_mask(test::box(lo, lo + Vec3(4, 4, 4)), g);
    EXPECT_EQ(sum_of(mask), 64.0);
    for (std::size_t i = 0; i < sum.voxels.size(); ++i)
      sum.voxels[i] = static_cast<std::uint8_t>(sum.voxels[i] + mask.voxels[i]);
  }
  EXPECT_EQ(*std::max_element(sum.voxels.begin(), sum.voxels.end()), 1);
  EXPECT_EQ(sum_of(sum), 512.0);
}

// A window of a grid shows what the whole grid shows there, whatever of the surface lies outside.
TEST(Rasterize, WindowsAgreeWithTheWhole) {
  RandomEngine random(2);
  const TriangleMesh m = test::torus(40, 20, 10, 4, {1, 2, 3});
  const ImageGrid whole = random_grid(random, {48, 44, 24}, 0.8, {1, 2, 3});
  const auto mask = rasterize_mask(m, whole);
  const auto cover = rasterize_partial_volume(m, whole);
  const auto distance = rasterize_signed_distance(m, whole, 2.5);
  for (int trial = 0; trial < 10; ++trial) {
    Index3 begin{};
    ImageGrid g = whole;
    for (std::size_t a = 0; a < 3; ++a) {
      begin[a] = static_cast<int>(random.next() % static_cast<unsigned>(whole.size[a] - 3));
      g.size[a] = 1 + static_cast<int>(random.next() % static_cast<unsigned>(whole.size[a] - begin[a]));
    }
    g.origin_in_world = whole.world_from_index(Vec3(begin[0], begin[1], begin[2]));
    const auto mask_here = rasterize_mask(m, g);
    const auto cover_here = rasterize_partial_volume(m, g);
    const auto distance_here = rasterize_signed_distance(m, g, 2.5);
    for_each_voxel(g, [&](int i, int j, int k) {
      const int a = i + begin[0], b = j + begin[1], c = k + begin[2];
      ASSERT_EQ(mask_here.at(i, j, k), mask.at(a, b, c));
      ASSERT_NEAR(cover_here.at(i, j, k), cover.at(a, b, c), 1e-6);
      // the nodes of anisotropic grids lie elsewhere
      ASSERT_NEAR(distance_here.at(i, j, k), distance.at(a, b, c), 1e-5);
    });
  }
  ImageGrid away = whole;
  away.origin_in_world += Vec3(1e4, 0, 0);
  EXPECT_EQ(sum_of(rasterize_mask(m, away)), 0.0);
  EXPECT_EQ(sum_of(rasterize_partial_volume(m, away)), 0.0);
  const TriangleMesh around = test::sphere(3, 1e7);  // holds the whole image, far beyond any int of voxels
  EXPECT_EQ(sum_of(rasterize_mask(around, whole)), static_cast<double>(whole.voxel_count()));
  EXPECT_EQ(sum_of(rasterize_partial_volume(around, whole)), static_cast<double>(whole.voxel_count()));
}

TEST(Rasterize, SameBytesForAnyNumberOfThreads) {
  RandomEngine random(3);
  const TriangleMesh m = test::blob(4, 12, {0, 0, 0});
  const ImageGrid g = random_grid(random, {50, 50, 30}, 0.8, {0, 0, 0});
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    const auto mask = rasterize_mask(m, g);
    const TriangleMesh surface = surface_of_mask(mask);
    const SurfaceDistances d = surface_distances(surface, m, 0.5, 2000);
    return std::tuple(mask.voxels, rasterize_partial_volume(m, g).voxels, rasterize_signed_distance(m, g, 3).voxels,
                      surface.vertices, surface.triangles, d.assd, d.hd, d.nsd);
  };
  const auto one = run(1), four = run(4);
  EXPECT_TRUE(one == four);
}

TEST(Rasterize, AnOpenSurfaceIsBadDataAndItsEdgeIsNamed) {
  ImageGrid g;
  g.size = {8, 8, 8};
  TriangleMesh m = test::box({1, 1, 1}, {6, 6, 6});
  m.triangles.pop_back();
  try {
    rasterize_mask(m, g);
    ADD_FAILURE() << "an open surface was rasterised";
  } catch (const BadData& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("edge 4-6 is open"));
  }
  EXPECT_THROW(rasterize_partial_volume(m, g), BadData);
  EXPECT_THROW(rasterize_signed_distance(m, g, 2), BadData);
  EXPECT_THROW(rasterize_mask(TriangleMesh{}, g), BadData);
  m = test::box({1, 1, 1}, {6, 6, 6});
  m.vertices[0].x() = std::nan("");
  EXPECT_THROW(rasterize_mask(m, g), BadData);
  EXPECT_THROW(rasterize_signed_distance(test::sphere(1, 2), g, 0.0), UsageError);
}

TEST(PartialVolume, SumIsTheVolumeOfTheMesh) {
  RandomEngine random(4);
  for (int trial = 0; trial < 6; ++trial) {
    const Vec3 centre(10, 20, -30);
    const TriangleMesh m = trial % 2 == 0 ? test::blob(3, 8, centre) : test::torus(30, 15, 8, 3, centre);
    const ImageGrid g = random_grid(random, {60, 60, 40}, 0.7, centre);
    EXPECT_NEAR(sum_of(rasterize_partial_volume(m, g)) * g.voxel_volume() / volume_of(m), 1.0, 1e-7);
  }
}

// Against 10^3 points a voxel, by the solid angle.
TEST(PartialVolume, EachVoxelAgreesWithSampling) {
  RandomEngine random(5);
  const TriangleMesh m = test::blob(1, 2.5, {0, 0, 0});
  const ImageGrid g = random_grid(random, {8, 8, 5}, 1.0, {0.3, 0.2, -0.1});
  const auto cover = rasterize_partial_volume(m, g);
  constexpr int n = 10;
  for_each_voxel(g, [&](int i, int j, int k) {
    int inside = 0;
    for (int s = 0; s < n * n * n; ++s) {
      const Vec3 offset((s % n + 0.5) / n - 0.5, (s / n % n + 0.5) / n - 0.5, (s / (n * n) + 0.5) / n - 0.5);
      inside += winding_number(m, g.world_from_index(Vec3(i, j, k) + offset)) > 0.5 ? 1 : 0;
    }
    ASSERT_NEAR(cover.at(i, j, k), inside / double(n * n * n), 0.02) << i << ' ' << j << ' ' << k;
  });
}

TEST(SignedDistance, TrueInTheBandOnAnyGrid) {
  RandomEngine random(6);
  for (const double band : {0.7, 3.0, 100.0}) {
    const Vec3 centre(500, 0, -500);
    const TriangleMesh m = test::blob(2, 8, centre);
    const ImageGrid g = random_grid(random, {27, 22, 14}, 1.0, centre);
    const auto distance = rasterize_signed_distance(m, g, band);
    const auto mask = rasterize_mask(m, g);
    double sum = 0.0;
    const ClosestPoint closest(m);  // held to a brute-force oracle in tests/mesh
    for_each_voxel(g, [&](int i, int j, int k) {
      const double d = std::min(band, closest.query(g.world_from_index(Vec3(i, j, k))).distance);
      ASSERT_NEAR(std::abs(distance.at(i, j, k)), d, 1e-5);
      sum += std::pow(std::abs(distance.at(i, j, k)) - d, 2);
      ASSERT_EQ(distance.at(i, j, k) < 0.0F, mask.at(i, j, k) != 0);
    });
    EXPECT_LE(std::sqrt(sum / static_cast<double>(g.voxel_count())), 1e-5);
  }
}

}  // namespace
}  // namespace pellicle
