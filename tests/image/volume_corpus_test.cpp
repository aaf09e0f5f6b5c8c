// Every odd or broken file has its outcome: exit code, one line that names file and reason, nothing printed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "../../cli/exit_codes.h"
#include "corpus.h"
#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"

namespace pellicle {
namespace {

namespace fs = std::filesystem;
using test::Expectation;

void check_failure(const Expectation& expected, const Error& error) {
  const std::string message = error.what();
  EXPECT_EQ(cli::exit_code_of(error.category()), expected.exit_code) << message;
  EXPECT_THAT(message, testing::HasSubstr(expected.text));
  EXPECT_THAT(message, testing::HasSubstr(fs::path(expected.file).filename().string()));
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(message.size(), 500U) << message;
}

void check_success(const Expectation& expected, const Volume& volume) {
  EXPECT_EQ(expected.exit_code, 0) << "was read, but must be refused";
  const auto& warnings = volume.header.warnings;
  if (expected.text.empty()) {
    EXPECT_THAT(warnings, testing::IsEmpty());
  } else {
    EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr(expected.text)));
  }
  const auto& voxels = volume.image.voxels;
  ASSERT_EQ(voxels.size(), volume.header.grid.voxel_count());
  EXPECT_TRUE(std::all_of(voxels.begin(), voxels.end(), [](float v) { return std::isfinite(v); }));
  EXPECT_EQ(*std::min_element(voxels.begin(), voxels.end()), volume.min);
  EXPECT_EQ(*std::max_element(voxels.begin(), voxels.end()), volume.max);
  EXPECT_NEAR(std::abs(volume.header.grid.direction.determinant()), 1.0, 1e-9);
  EXPECT_GT(volume.header.grid.spacing.minCoeff(), 0.0);
}

std::optional<Volume> run(const fs::path& folder, const Expectation& expected) {
  SCOPED_TRACE(expected.file);
  std::optional<Volume> volume;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::optional<Error> error;
  try {
    volume = read_volume(folder / expected.file);
  } catch (const Error& caught) {
    error = caught;
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  if (error)
    check_failure(expected, *error);
  else
    check_success(expected, *volume);
  return volume;
}

// read_header must agree with read_volume wherever it can tell without the voxels.
void check_header(const fs::path& folder, const Expectation& expected, const Volume& volume) {
  SCOPED_TRACE(expected.file);
  const VolumeHeader header = read_header(folder / expected.file);
  EXPECT_TRUE(same_grid(header.grid, volume.header.grid, 1e-12));
  EXPECT_EQ(header.component_type, volume.header.component_type);
}

TEST(VolumeCorpus, EveryFileHasItsOutcome) {
  for (const auto& expected : test::read_table(test::corpus_folder() / "expected.csv")) {
    const auto volume = run(test::corpus_folder(), expected);
    if (volume) check_header(test::corpus_folder(), expected, *volume);
  }
}

TEST(VolumeCorpus, EverySharedFileHasItsOutcome) {
  const fs::path folder = test::shared_folder() / "data/bad-and-odd";
  if (!fs::exists(folder)) GTEST_SKIP() << "no volumes at " << folder;
  for (const auto& expected : test::read_table(fs::path(PELLICLE_SOURCE_DIR) / "tests/image/shared_expected.csv"))
    run(folder, expected);
}

// All types, byte orders, containers and units hold one and the same image.
TEST(VolumeCorpus, ValuesDoNotDependOnFormat) {
  const std::set<std::string> other_values = {"nan_inf.nii.gz", "constant.nii.gz", "dicom_slopes"};
  int compared = 0;
  for (const auto& expected : test::read_table(test::corpus_folder() / "expected.csv")) {
    if (expected.exit_code != 0 || other_values.contains(expected.file)) continue;
    SCOPED_TRACE(expected.file);
    const Volume volume = read_volume(test::corpus_folder() / expected.file);
    ASSERT_EQ(volume.header.grid.size, (Index3{5, 4, 3}));
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 5; ++i) ASSERT_EQ(volume.image.at(i, j, k), static_cast<float>(1 + i + 10 * j + 20 * k));
      }
    }
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

// The far corner, index (4, 3, 2), lies where the affine that the files were made with puts it (LPS mm).
TEST(VolumeCorpus, WorldIsLpsMillimetres) {
  const Vec3 nifti_corner(-10.0, 4.75, 7.0), tiff_corner(2.0, 2.25, 4.0), dicom_corner(-10.0, 9.25, 7.0);
  std::vector<std::pair<std::string, Vec3>> cases;
  for (const char* name :
       {"nifti2.nii.gz", "one_volume_4d.nii.gz", "unit_micron.nii.gz", "unit_metre.nii.gz", "scaled.nii.gz",
        "qform_only.nii.gz", "sform_only.nii.gz", "scanner_sform_wins.nii.gz", "template_sform_yields.nii.gz",
        "sheared_but_qform.nii.gz", "dtype_f4_be.nii.gz", "pair.img", "lps.nrrd", "ras.nrrd", "micron.nrrd",
        "no_space.nrrd", "meta.mha", "meta.mhd", "micron.mha"}) {
    cases.emplace_back(name, nifti_corner);
  }
  for (const char* name : {"imagej.tif", "imagej_micron.tif", "ome.tif"}) cases.emplace_back(name, tiff_corner);
  for (const char* name : {"dicom_even", "dicom_slopes"}) cases.emplace_back(name, dicom_corner);
  for (const auto& [name, corner] : cases) {
    SCOPED_TRACE(name);
    const VolumeHeader header = read_header(test::corpus_folder() / name);
    EXPECT_LE((header.grid.world_from_index(Vec3(4, 3, 2)) - corner).norm(), 1e-5);
    EXPECT_TRUE(header.spacing_known);
  }
}

TEST(VolumeCorpus, NeverASilentMillimetre) {
  for (const auto& expected : test::read_table(test::corpus_folder() / "expected.csv")) {
    if (expected.exit_code != 0) continue;
    SCOPED_TRACE(expected.file);
    const VolumeHeader header = read_header(test::corpus_folder() / expected.file);
    const bool warned = std::any_of(header.warnings.begin(), header.warnings.end(),
                                    [](const std::string& w) { return w.starts_with("NO SPACING"); });
    EXPECT_EQ(warned, !header.spacing_known);
  }
}

TEST(VolumeCorpus, SpacingOverridesTheFile) {
  const VolumeHeader header = read_header(test::corpus_folder() / "plain.tif", {Vec3(0.1, 0.2, 0.3)});
  EXPECT_EQ(header.grid.spacing, Vec3(0.1, 0.2, 0.3));
  EXPECT_TRUE(header.spacing_known);
  EXPECT_THAT(header.warnings, testing::IsEmpty());
  EXPECT_THROW(read_header(test::corpus_folder() / "plain.tif", {Vec3(0.1, 0.0, 0.3)}), UsageError);
  EXPECT_THROW(read_header(test::corpus_folder() / "plain.tif", {Vec3(0.1, std::nan(""), 0.3)}), UsageError);
}

TEST(VolumeCorpus, RescaleOfSlicesIsApplied) {
  const Volume plain = read_volume(test::corpus_folder() / "dicom_even"),
               doubled = read_volume(test::corpus_folder() / "dicom_slopes");
  for (std::size_t v = 0; v < plain.image.voxels.size(); ++v)
    ASSERT_EQ(doubled.image.voxels[v], 2.0F * plain.image.voxels[v]);
}

TEST(Labels, WholeNumbersOnly) {
  const LabelVolume labels = read_labels(test::corpus_folder() / "dtype_f8_be.nii.gz");
  EXPECT_EQ(labels.labels.at(4, 3, 2), 75);
  EXPECT_THROW(read_labels(test::corpus_folder() / "nan_inf.nii.gz"), BadData);
  EXPECT_THROW(read_labels(test::corpus_folder() / "absent.nii"), NoInput);
  const fs::path made = test::shared_folder() / "data/bad-and-odd/made";
  if (!fs::exists(made)) GTEST_SKIP() << "no volumes at " << made;
  EXPECT_THROW(read_labels(made / "dtype_f8_image.nii.gz"), BadData);
  const auto noisy = read_labels(made / "float_label.nii.gz").labels.voxels,
             exact = read_labels(made / "ref_label.nii.gz").labels.voxels;
  EXPECT_EQ(noisy, exact);  // 1.99999994 is the label 2
  const auto big = read_labels(made / "big_label_ids_int32.nii.gz").labels.voxels;
  EXPECT_EQ(*std::max_element(big.begin(), big.end()), 200000);
}

}  // namespace
}  // namespace pellicle
