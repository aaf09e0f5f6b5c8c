// --preset auto: measured facts, the conditions of preset files, and what comes of both.
#include "pellicle/settings/preset_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "../temporary_folder.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/settings/settings_toml.h"
#include "pellicle/synthetic/cluster.h"

namespace pellicle {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

TEST(PresetChoice, RangesDecideAndTheStricterConditionWins) {
  const std::vector<Preset> presets{{"a", "", "a.toml", {{{"seeds", {1, kNoEnd}}}}},
                                    {"b", "", "b.toml", {{{"seeds", {1, kNoEnd}}, {"voxel_mm", {0.5, 2.0}}}}},
                                    {"c", "", "c.toml", {{{"seeds", {5, 5}}}, {{"voxel_mm", {0.0, 0.1}}}}},
                                    {"never", "", "never.toml", {}}};
  const auto chosen = [&](double seeds, double voxel) {
    return choose_preset(presets, {{"seeds", seeds}, {"voxel_mm", voxel}}).name;
  };
  EXPECT_EQ(chosen(1, 3.0), "a");
  EXPECT_EQ(chosen(1, 2.0), "b");  // ends belong to ranges
  EXPECT_EQ(chosen(1, 2.01), "a");
  EXPECT_EQ(chosen(0, 0.05), "c");  // any of its conditions
  EXPECT_EQ(chosen(0, 1.0), "");
  EXPECT_THAT(choose_preset(presets, {{"seeds", 1}, {"voxel_mm", 1}}).reason,
              testing::AllOf(testing::HasSubstr("voxel_mm is 1"), testing::HasSubstr("0.5 to 2")));
  EXPECT_THROW(choose_preset(presets, {{"seeds", 1}}), UsageError);  // a condition on a fact that was not measured
}

TEST(PresetChoice, ConditionsAreReadFromFilesAndTheFactsThatTheyNameExist) {
  const test::TemporaryFolder folder;
  const auto notes = [&](const std::string& text) {
    std::ofstream(folder / "p.toml") << text;
    return read_toml_notes(folder / "p.toml");
  };
  const TomlNotes good = notes("polarity = \"bright\"\n[[when]]\nseeds = [1, inf]\n[[when]]\nblobs = [5, 9]\n");
  ASSERT_EQ(good.when.size(), 2U);
  EXPECT_EQ(good.when[0].at("seeds")[1], kNoEnd);
  EXPECT_EQ(good.when[1].at("blobs")[0], 5.0);
  SegmentSettings settings;
  EXPECT_NO_THROW(apply_toml_file(folder / "p.toml", settings));
  EXPECT_THROW(notes("[[when]]\nseeds = [2, 1]\n"), UsageError);
  EXPECT_THROW(notes("[[when]]\nseeds = 2\n"), UsageError);
  EXPECT_THROW(notes("[when]\nseeds = [1, 2]\n"), UsageError);

  const Facts facts = image_facts(make_phantom({.size = {32, 32, 32}, .radius = {8.0}}).image, 0, true);
  std::vector<std::string> described;
  for (const auto& fact : fact_descriptions()) described.push_back(fact.name);
  std::vector<std::string> measured;
  for (const auto& [name, value] : facts) measured.push_back(name);
  EXPECT_EQ(measured, described);
  EXPECT_NO_THROW(choose_preset(list_presets(), facts));
}

// With the presets that are installed.
std::string chosen_for(const Image<float>& image, std::size_t seeds, bool spacing_known = true) {
  return choose_preset(list_presets(), image_facts(image, seeds, spacing_known)).name;
}

TEST(PresetChoice, ManyBlobsOfOneSize) {
  ClusterSettings s;
  s.image.size = {60, 60, 32};
  s.image.spacing = {0.8, 0.8, 1.4};
  s.image.snr = 8;
  s.count = 8;
  s.radius_min = 5.0;
  s.radius_max = 7.0;
  Cluster cluster = make_cluster(s);
  EXPECT_EQ(chosen_for(cluster.image, 0), "nuclei");
  EXPECT_EQ(chosen_for(cluster.image, 1), "");  // somebody clicked at one
  for (float& v : cluster.image.voxels) v = 300.0F - v;
  EXPECT_EQ(chosen_for(cluster.image, 0), "membrane-cells");
  for (const std::string shape : {"sphere", "bean", "dumbbell"}) {
    EXPECT_EQ(chosen_for(make_phantom({.shape = shape, .size = {72, 72, 72}, .radius = {14.0}}).image, 0), "") << shape;
  }
}

// Air about a body of water in which an organ lies; noise as in CT.
Image<float> ct_like() {
  PhantomSettings s{.shape = "ellipsoid", .size = {64, 64, 64}, .spacing = {3, 3, 3}, .radius = {80.0, 60.0, 85.0}};
  s.inside = 0.0;
  s.outside = -1000.0;
  s.noise = PhantomNoise::none;
  Phantom phantom = make_phantom(s);
  RandomEngine random(3);
  for (float& v : phantom.image.voxels) v += static_cast<float>(15.0 * random.normal());
  return phantom.image;
}

TEST(PresetChoice, HounsfieldUnitsAndAClick) {
  Image<float> image = ct_like();
  EXPECT_GT(image_facts(image, 1, true).at("hounsfield"), 0.8);
  EXPECT_EQ(chosen_for(image, 1), "organ-ct");
  EXPECT_NE(chosen_for(image, 0), "organ-ct");
  for (float& v : image.voxels) v += 1000.0F;  // the same picture in other units
  EXPECT_EQ(image_facts(image, 1, true).at("hounsfield"), 0.0);
  EXPECT_NE(chosen_for(image, 1), "organ-ct");
}

TEST(PresetChoice, AHeadIsKnownByItsSizeInADarkSurround) {
  PhantomSettings s{
      .shape = "ellipsoid", .size = {60, 72, 64}, .spacing = {2.5, 2.5, 2.5}, .radius = {62.0, 82.0, 70.0}};
  s.inside = 100.0;
  s.outside = 2.0;
  s.snr = 30.0;
  Image<float> image = make_phantom(s).image;
  EXPECT_EQ(chosen_for(image, 0), "brain-t1");
  EXPECT_NE(chosen_for(image, 1), "brain-t1");  // somebody clicked: not the brain as such
  image.grid.spacing *= 0.4;
  EXPECT_NE(chosen_for(image, 0), "brain-t1");
}

}  // namespace
}  // namespace pellicle
