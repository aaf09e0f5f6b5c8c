// Point files: what is read, and the error message for each broken file.
#include "pellicle/mesh/files/point_file.h"

#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "../temporary_folder.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {
namespace {

struct Folder : test::TemporaryFolder {
  std::filesystem::path with(const std::string& name, const std::string& bytes) const {
    std::ofstream(path() / name, std::ios::binary) << bytes;
    return path() / name;
  }
};

struct Good {
  std::string name, bytes;
};

template <class T>
std::string raw(std::initializer_list<T> values) {
  std::string bytes;
  for (const T v : values) {
    char c[sizeof v];
    std::memcpy(c, &v, sizeof v);
    bytes.append(c, sizeof v);
  }
  return bytes;
}

std::string pcd_header(const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA " +
         data + "\n";
}

// LZF of literals only: runs of at most 32 bytes.
std::string lzf_of(const std::string& bytes) {
  std::string packed;
  for (std::size_t i = 0; i < bytes.size(); i += 32) {
    const std::string part = bytes.substr(i, 32);
    packed.push_back(static_cast<char>(part.size() - 1));
    packed += part;
  }
  const auto sizes = raw({static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(bytes.size())});
  return sizes + packed;
}

std::vector<Good> good_files() {
  return {{"a.xyz", "# made by hand\n1 2 3\n-4.5\t5e-1,6\n"},
          {"counted.xyz", "2\n1 2 3 0 0 1\n-4.5 0.5 6 0 1 0\n"},
          {"a.pts", "2\r\n1 2 3 17 255 0 0\r\n-4.5 0.5 6 3 0 0 0\r\n"},
          {"wa3d.pts", "# Created\nd 0 0 0\ns 0 0 0\np 1 2 3\np -4.5 0.5 6\n"},
          {"expe.pts", "[Expe/PointSet/Binary/0.1]\nproperty radius 4\nproperty position 12\nnofpoints 2\ndata\n" +
                           raw({9.F, 1.F, 2.F, 3.F, 9.F, -4.5F, 0.5F, 6.F})},
          {"a.csv", "z;x;y;weight\n3;1;2;1\n6;-4.5;0.5;2\n"},
          {"plain.csv", "1,2,3\n-4.5,0.5,6\n"},
          {"a.pcd", pcd_header("ascii") + "1 2 3 0\n-4.5 0.5 6 0\n"},
          {"binary.pcd", pcd_header("binary") + raw({1.F, 2.F, 3.F, 0.F, -4.5F, 0.5F, 6.F, 0.F})},
          {"packed.pcd", pcd_header("binary_compressed") + lzf_of(raw({1.F, -4.5F, 2.F, 0.5F, 3.F, 6.F, 0.F, 0.F}))},
          {"a.ply",
           "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
           "end_header\n1 2 3\n-4.5 0.5 6\n"}};
}

TEST(ReadPoints, EveryFormatHoldsTheSameTwoPoints) {
  const Folder folder;
  for (const auto& [name, bytes] : good_files()) {
    const auto path = folder.with(name, bytes);
    EXPECT_TRUE(is_point_file(path)) << name;
    const PointCloud cloud = read_points(path);
    ASSERT_EQ(cloud.points.size(), 2U) << name;
    EXPECT_EQ(cloud.points[0], Vec3(1, 2, 3)) << name;
    EXPECT_EQ(cloud.points[1], Vec3(-4.5, 0.5, 6)) << name;
    EXPECT_FALSE(cloud.grid.has_value()) << name;
  }
}

TEST(ReadPoints, WeightsFollowTheirPoints) {
  const Folder folder;
  EXPECT_THAT(read_points(folder.with("w.csv", "weight,x,y,z\n0.5,1,2,3\n2,4,5,6\n")).weights,
              testing::ElementsAre(0.5, 2.0));
  EXPECT_THAT(read_points(folder.with("four.csv", "1,2,3,0.25\n")).weights, testing::ElementsAre(0.25));
}

TEST(ReadPoints, MissingPointsOfAPcdAreLeftOut) {
  const Folder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(read_points(folder.with("n.pcd", pcd_header("binary") + raw({nan, nan, nan, 0.F, 4.F, 5.F, 6.F, 0.F})))
                .points.size(),
            1U);
}

TEST(ReadPoints, BackReferencesOfLzf) {
  // "abcabcabc...": three literals, then a copy from three bytes back.
  const Folder folder;
  const std::string word = raw({7.F});
  std::string packed(1, '\x03');
  packed += word;
  packed += std::string("\xe0\x13\x03", 3);  // length 7 + 19 + 2 = 28, four bytes back
  const std::string file =
      pcd_header("binary_compressed") + raw({static_cast<std::uint32_t>(packed.size()), std::uint32_t{32}}) + packed;
  const PointCloud cloud = read_points(folder.with("r.pcd", file));
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[1], Vec3(7, 7, 7));
}

TEST(ReadPoints, AGridIsPutInOrderAndPolesMayBeGivenOnce) {
  const Folder folder;
  std::string text = "u_index,v_index,x,y,z\n";
  text += "3,1,3,1,0\n0,0,9,9,9\n0,1,0,1,0\n2,1,2,1,0\n1,1,1,1,0\n0,2,8,8,8\n";
  const PointCloud cloud = read_points(folder.with("g.csv", text));
  ASSERT_TRUE(cloud.grid.has_value());
  const PointGrid& grid = *cloud.grid;
  EXPECT_EQ(grid.columns, 4);
  EXPECT_EQ(grid.rows, 3);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(grid.at(k, 0), Vec3(9, 9, 9));
    EXPECT_EQ(grid.at(k, 1), Vec3(k, 1, 0));
    EXPECT_EQ(grid.at(k, 2), Vec3(8, 8, 8));
  }
}

struct Bad {
  std::string name, bytes, text;
};

std::ostream& operator<<(std::ostream& out, const Bad& bad) {
  return out << bad.name;
}

class BrokenPoints : public testing::TestWithParam<Bad> {};

TEST_P(BrokenPoints, AreBadDataOnOneLineThatSaysWhy) {
  const Folder folder;
  const auto path = folder.with(GetParam().name, GetParam().bytes);
  try {
    read_points(path);
    FAIL() << "was read";
  } catch (const BadData& fault) {
    const std::string what = fault.what();
    EXPECT_THAT(what, testing::HasSubstr(path.string()));
    EXPECT_THAT(what, testing::HasSubstr(GetParam().text));
    EXPECT_THAT(what, testing::Not(testing::HasSubstr("\n")));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BrokenPoints,
    testing::Values(
        Bad{"empty.xyz", "", "empty"}, Bad{"blank.xyz", " \n\n", "empty"},
        Bad{"comments.xyz", "# nothing\n", "no points"},
        Bad{"words.xyz", "1 2 3\n1 two 3\n", "line 2: 'two' is not a number"},
        Bad{"two.xyz", "1 2 3\n1 2\n", "line 2 has 2 numbers"},
        Bad{"nan.xyz", "1 2 3\nnan 2 3\n", "line 2: a coordinate is not finite"},
        Bad{"inf.csv", "x,y,z\n1,2,inf\n", "not finite"},
        Bad{"short.pts", "3\n1 2 3\n4 5 6\n", "claims 3 points and holds 2"},
        Bad{"names.csv", "a,b,c\n1,2,3\n", "lack x, y or z"}, Bad{"ragged.csv", "x,y,z\n1,2\n", "line 2 has 2 columns"},
        Bad{"wide.csv", "1,2,3,4,5\n", "without names"}, Bad{"weight.csv", "x,y,z,weight\n1,2,3,-1\n", "weight -1"},
        Bad{"half.csv", "u_index,x,y,z\n0,1,2,3\n", "only one of the columns"},
        Bad{"twice.csv", "k,l,x,y,z\n0,0,1,2,3\n0,0,1,2,3\n", "given twice"},
        Bad{"missing.csv",
            "k,l,x,y,z\n0,0,1,2,3\n1,1,1,2,3\n0,1,1,2,3\n2,2,1,1,1\n2,1,1,1,1\n0,2,1,1,1\n1,2,2,2,2\n2,0,0,0,0\n",
            "is missing"},
        Bad{"far.csv", "k,l,x,y,z\n900000,0,1,2,3\n", "its indices go up to"},
        Bad{"fraction.csv", "k,l,x,y,z\n0.5,0,1,2,3\n", "whole numbers"},
        Bad{"cut.pcd", pcd_header("binary") + raw({1.F, 2.F, 3.F}), "truncated"},
        Bad{"cut_ascii.pcd", pcd_header("ascii") + "1 2 3 0\n", "truncated"},
        Bad{"columns.pcd", pcd_header("ascii") + "1 2 3\n4 5 6\n", "3 columns, 4 are due"},
        Bad{"fields.pcd", "FIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 1\nDATA ascii\n1 2\n", "lack x, y or z"},
        Bad{"huge.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 99999999999\nDATA binary\nxxx",
            "more than the file holds"},
        Bad{"lzf.pcd", pcd_header("binary_compressed") + lzf_of(std::string(32, 'a')).substr(0, 20),
            "before its data are complete"},
        Bad{"noise.pcd", std::string("\x01\x02\x03\x04", 4), "header"},
        Bad{"expe.pts", "[Expe/PointSet/Binary/0.1]\nproperty position 12\nnofpoints 5\ndata\nabc", "truncated"},
        Bad{"inf.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
            "z\nend_header\n1 2 inf\n",
            "not finite"}));

TEST(ReadPoints, AMissingFileIsNoInput) {
  EXPECT_THROW(read_points("/nowhere/points.xyz"), NoInput);
}

TEST(PointTree, AgreesWithALinearSearch) {
  RandomEngine random(3);
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i) points.emplace_back(random.normal(), random.normal(), 0.1 * random.normal());
  const PointTree tree(points);
  for (int q = 0; q < 50; ++q) {
    const Vec3 x(random.normal(), random.normal(), random.normal());
    std::vector<double> all;
    for (const Vec3& p : points) all.push_back((p - x).norm());
    std::sort(all.begin(), all.end());
    const auto near = tree.nearest(x, 7);
    ASSERT_EQ(near.size(), 7U);
    for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(near[k].distance, all[k], 1e-12);
  }
  EXPECT_EQ(tree.nearest(Vec3::Zero(), 1000).size(), 500U);
}

}  // namespace
}  // namespace pellicle
