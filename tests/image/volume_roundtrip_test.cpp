// What is written is read back by nibabel: the input's frame bit for bit, values, types.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "corpus.h"
#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"

namespace pellicle {
namespace {

namespace fs = std::filesystem;

// One line a file: "frame WRITTEN ORIGINAL" or "affine WRITTEN 12 numbers (RAS)".
class Manifest {
 public:
  explicit Manifest(const fs::path& folder) : path_(folder / "manifest.txt"), out_(path_) {}
  void same_frame(const fs::path& written, const fs::path& original) {
    out_ << "frame\t" << written.string() << '\t' << original.string() << '\n';
  }
  void same_affine(const fs::path& written, const ImageGrid& grid) {
    const Mat3 matrix = grid.world_from_index_matrix();
    out_ << "affine\t" << written.string() << '\t';
    for (int row = 0; row < 3; ++row) {
      const double sign = row < 2 ? -1.0 : 1.0;
      for (int column = 0; column < 3; ++column) out_ << fmt::format("{:.17g} ", sign * matrix(row, column));
      out_ << fmt::format("{:.17g} ", sign * grid.origin_in_world[row]);
    }
    out_ << '\n';
  }
  // The interpreter that the nibabel package belongs to, unless PELLICLE_PYTHON names another.
  int check() {
    out_.close();
    const char* named = std::getenv("PELLICLE_PYTHON");
    const std::string python = named != nullptr ? named : "/usr/bin/python3";
    return std::system(
        fmt::format("{} {}/tests/image/check_with_nibabel.py {}", python, PELLICLE_SOURCE_DIR, path_.string()).c_str());
  }

 private:
  fs::path path_;
  std::ofstream out_;
};

template <class T>
Image<T> converted(const Volume& volume) {
  Image<T> image(volume.header.grid);
  for (std::size_t v = 0; v < image.voxels.size(); ++v)
    image.voxels[v] = static_cast<T>(std::fmod(volume.image.voxels[v], 100.0F));
  return image;
}

template <class T>
void write_and_list(const Volume& volume, const fs::path& original, const fs::path& written, Manifest& manifest) {
  write_volume(written, converted<T>(volume), volume.header);
  if (volume.header.nifti)
    manifest.same_frame(written, original);
  else
    manifest.same_affine(written, volume.header.grid);
  const Volume again = read_volume(written);
  EXPECT_TRUE(same_grid(again.header.grid, volume.header.grid, 1e-5)) << written;
  const Image<T> sent = converted<T>(volume);
  for (std::size_t v = 0; v < sent.voxels.size(); ++v)
    ASSERT_EQ(again.image.voxels[v], static_cast<float>(sent.voxels[v]));
}

void round_trip(const fs::path& folder, const std::vector<test::Expectation>& table) {
  const test::TemporaryFolder temporary;
  Manifest manifest(temporary.path());
  int n = 0;
  for (const auto& expected : table) {
    if (expected.exit_code != 0) continue;
    SCOPED_TRACE(expected.file);
    const Volume volume = read_volume(folder / expected.file);
    const auto name = [&](const char* type, const char* extension) {
      return temporary.path() / fmt::format("{}_{}{}", n, type, extension);
    };
    write_and_list<std::uint8_t>(volume, folder / expected.file, name("uint8", ".nii.gz"), manifest);
    if (n++ % 5 != 0) continue;
    write_and_list<std::uint16_t>(volume, folder / expected.file, name("uint16", ".nii.gz"), manifest);
    write_and_list<std::int16_t>(volume, folder / expected.file, name("int16", ".nii"), manifest);
    write_and_list<std::int32_t>(volume, folder / expected.file, name("int32", ".nii.gz"), manifest);
    write_and_list<float>(volume, folder / expected.file, name("float32", ".nii"), manifest);
  }
  EXPECT_GT(n, 10);
  EXPECT_EQ(manifest.check(), 0) << "nibabel does not agree (it is Debian's python3-nibabel)";
}

TEST(WriteVolume, NibabelFindsTheFrameOfTheInput) {
  round_trip(test::corpus_folder(), test::read_table(test::corpus_folder() / "expected.csv"));
}

TEST(WriteVolume, NibabelFindsTheFrameOfSharedInputs) {
  const fs::path folder = test::shared_folder() / "data/bad-and-odd";
  if (!fs::exists(folder)) GTEST_SKIP() << "no volumes at " << folder;
  auto table = test::read_table(fs::path(PELLICLE_SOURCE_DIR) / "tests/image/shared_expected.csv");
  std::erase_if(table, [](const auto& row) {
    return !row.file.starts_with("made/") && !row.file.starts_with("sct/") && !row.file.starts_with("dicom") &&
           !row.file.starts_with("pyradiomics");
  });
  // An origin of 1e7 mm is beyond what the float32 of a NIfTI-1 header places to 1e-5 of a voxel.
  std::erase_if(table, [](const auto& row) { return row.file.find("huge_origin") != std::string::npos; });
  round_trip(folder, table);
}

TEST(WriteVolume, ObliqueGridOfAnotherFormatSurvives) {
  const test::TemporaryFolder temporary;
  Manifest manifest(temporary.path());
  for (const double sign : {1.0, -1.0}) {
    VolumeHeader header;
    header.grid.size = {4, 5, 6};
    header.grid.spacing = {0.3, 0.4, 1.7};
    header.grid.origin_in_world = {-31.25, 17.5, 400.0};
    header.grid.direction = (Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix());
    header.grid.direction.col(2) *= sign;
    const fs::path written = temporary.path() / fmt::format("oblique{}.nii.gz", sign);
    write_volume(written, Image<std::uint8_t>(header.grid, 1), header);
    manifest.same_affine(written, header.grid);
    EXPECT_TRUE(same_grid(read_header(written).grid, header.grid, 1e-5));
  }
  EXPECT_EQ(manifest.check(), 0);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(WriteVolume, SameInputSameBytes) {
  const test::TemporaryFolder temporary;
  const Volume volume = read_volume(test::corpus_folder() / "nifti2.nii.gz");
  write_volume(temporary.path() / "a.nii.gz", converted<std::uint8_t>(volume), volume.header);
  write_volume(temporary.path() / "b.nii.gz", converted<std::uint8_t>(volume), volume.header);
  EXPECT_EQ(bytes_of(temporary.path() / "a.nii.gz"), bytes_of(temporary.path() / "b.nii.gz"));
}

TEST(WriteVolume, LeavesNothingWhereItFails) {
  const test::TemporaryFolder temporary;
  const Volume volume = read_volume(test::corpus_folder() / "nifti2.nii.gz");
  EXPECT_THROW(write_volume(temporary.path() / "absent/a.nii.gz", volume.image, volume.header), CannotCreate);
  EXPECT_THROW(write_volume(temporary.path() / "a.png", volume.image, volume.header), CannotCreate);
  Volume other = volume;
  other.header.grid.size = {5, 4, 4};
  EXPECT_THROW(write_volume(temporary.path() / "a.nii.gz", volume.image, other.header), std::invalid_argument);
  EXPECT_TRUE(fs::is_empty(temporary.path()));
}

// The override is a new grid: the file's own frame must not travel on with it.
TEST(WriteVolume, SpacingOverrideReachesTheMask) {
  const test::TemporaryFolder temporary;
  const Volume volume = read_volume(test::corpus_folder() / "nifti2.nii.gz", {Vec3(1.5, 2.5, 3.5)});
  write_volume(temporary.path() / "a.nii.gz", converted<std::uint8_t>(volume), volume.header);
  EXPECT_LE((read_header(temporary.path() / "a.nii.gz").grid.spacing - Vec3(1.5, 2.5, 3.5)).norm(), 1e-6);
}

}  // namespace
}  // namespace pellicle
