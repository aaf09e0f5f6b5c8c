// The parts of a result page that can be wrong without looking so; the page itself is tried in a browser
// (tests/report).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "../temporary_folder.h"
#include "pellicle/base/errors.h"
#include "pellicle/batch/page_cases.h"
#include "pellicle/output/page_case.h"
#include "pellicle/output/report_page.h"
#include "pellicle/output/viewer_files.h"

namespace pellicle {
namespace {

TriangleMesh tetrahedron(const Vec3& at, double size) {
  TriangleMesh mesh;
  mesh.vertices = {at, at + Vec3(size, 0, 0), at + Vec3(0, size, 0), at + Vec3(0, 0, size)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

// A ramp along each world axis tells where a voxel lies: averaging must keep it there, in any orientation.
TEST(CutOut, KeepsVoxelsWhereTheyAre) {
  ImageGrid grid;
  grid.size = {60, 50, 20};
  grid.spacing = {0.5, 0.6, 1.7};
  grid.origin_in_world = {10, -20, 30};
  grid.direction = (Eigen::AngleAxisd(0.3, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.4, Vec3::UnitX())).toRotationMatrix();
  const TriangleMesh mesh = tetrahedron(grid.world_from_index({25, 20, 8}), 5.0);
  for (int axis = 0; axis < 3; ++axis) {
    Image<float> image(grid);
    for (int k = 0; k < grid.size[2]; ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        for (int i = 0; i < grid.size[0]; ++i)
          image.at(i, j, k) = static_cast<float>(grid.world_from_index(Vec3(i, j, k))[axis]);
      }
    }
    const Image<std::uint8_t> small = cut_out(image, {mesh}, 12);
    EXPECT_LE(small.grid.voxel_count(), 12U * 12U * 12U);
    for (const auto& vertex : mesh.vertices) EXPECT_TRUE(small.grid.contains(vertex));
    // Grey is a linear function of the place: three voxels tell it, the rest must agree. Blocks at the end may be cut
    // short.
    const auto place = [&](int i, int j, int k) { return small.grid.world_from_index(Vec3(i, j, k))[axis]; };
    double sxx = 0, sx = 0, sxy = 0, sy = 0, n = 0;
    std::vector<std::pair<double, double>> pairs;
    for (int k = 0; k + 1 < small.grid.size[2]; ++k) {
      for (int j = 0; j + 1 < small.grid.size[1]; ++j) {
        for (int i = 0; i + 1 < small.grid.size[0]; ++i) {
          const double grey = small.at(i, j, k);
          if (grey < 2 || grey > 253) continue;
          pairs.emplace_back(place(i, j, k), grey);
        }
      }
    }
    ASSERT_GT(pairs.size(), 50U);
    for (const auto& [x, y] : pairs) {
      sxx += x * x;
      sx += x;
      sxy += x * y;
      sy += y;
      n += 1.0;
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), shift = (sy - slope * sx) / n;
    for (const auto& [x, y] : pairs)
      EXPECT_TRUE(std::abs(slope * x + shift - y) <= 0.75) << axis << " " << x << " " << y;
  }
}

TEST(CutOut, OfASurfaceOutsideIsStillAVolume) {
  ImageGrid grid;
  grid.size = {9, 8, 7};
  const Image<float> image(grid, 3.0F);
  EXPECT_GE(cut_out(image, {tetrahedron({100, 100, 100}, 1.0)}, 16).grid.voxel_count(), 1U);
  EXPECT_EQ(cut_out(image, {}, 16).grid.size, grid.size);
}

TEST(Mz3, HoldsEveryMeshInRas) {
  const std::vector<TriangleMesh> meshes{tetrahedron({1, 2, 3}, 1.0), tetrahedron({-5, 0, 0}, 2.0)};
  const std::string bytes = mz3_of(meshes, {{255, 0, 0}, {0, 255, 0}});
  ASSERT_EQ(bytes.size(), 16U + 8 * 12 + 8 * 12 + 8 * 4);
  EXPECT_EQ(bytes.substr(0, 2), "MZ");
  std::uint32_t counts[2];
  std::memcpy(counts, bytes.data() + 4, 8);
  EXPECT_EQ(counts[0], 8U);
  EXPECT_EQ(counts[1], 8U);
  std::int32_t corner = 0;
  std::memcpy(&corner, bytes.data() + 16 + 4 * 12, 4);
  EXPECT_EQ(corner, 4);  // the second mesh's own first vertex
  float first[3];
  std::memcpy(first, bytes.data() + 16 + 8 * 12, 12);
  EXPECT_EQ(first[0], -1.0F);
  EXPECT_EQ(first[1], -2.0F);
  EXPECT_EQ(first[2], 3.0F);
  EXPECT_EQ(static_cast<unsigned char>(bytes[bytes.size() - 3]), 255);
}

TEST(Base64, OfTheStandardsExamples) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(Page, FindsCasesAndRefusesWhatIsNoResult) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(find_page_cases({folder.path()}), NoInput);
  EXPECT_THROW(find_page_cases({folder / "none"}), NoInput);
  std::filesystem::create_directories(folder / "b");
  for (const std::string name : {"z_report.json", "b/a_report.json"}) std::ofstream(folder / name) << "{}";
  const auto cases = find_page_cases({folder.path(), folder / "z_report.json"});
  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[0].name, "a");
  EXPECT_EQ(cases[1].name, "z");
  EXPECT_THROW(page_of(cases, {}, {}), BadData);
  std::ofstream(folder / "z_report.json") << R"({"format": "pellicle-report", "objects": [{}]})";
  EXPECT_THROW(page_of({cases[1]}, {}, {}), BadData);
}

TEST(Page, NothingInItBreaksOut) {
  PageCase one;
  one.name = "</script><b>";
  one.outcome = CaseOutcome{};
  one.outcome->status = "failed";
  one.outcome->message = "<!-- {{DATA}}";
  const std::string page = page_of({one}, {.title = "a < b & {{DATA}}", .viewer = true, .edge = {}}, {});
  EXPECT_THAT(page, testing::HasSubstr("<h1>a &lt; b &amp; {{DATA}}</h1>"));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr("</script><b>")));
  EXPECT_THAT(page, testing::HasSubstr(R"(\u003c!-- {{DATA}})"));
}

}  // namespace
}  // namespace pellicle
