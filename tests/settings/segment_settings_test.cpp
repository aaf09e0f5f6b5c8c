#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/settings/presets.h"
#include "pellicle/settings/settings_toml.h"

namespace pellicle {
namespace {

// Doubles with all their bits in use, tiny and huge ones among them.
double awkward(RandomEngine& random) {
  return random.normal() * std::pow(10.0, random.uniform(-12, 12));
}

SegmentSettings random_settings(RandomEngine& random) {
  SegmentSettings s;
  s.input = "a \"quoted\" näme\\with\tall.nii.gz";
  s.output = "out";
  s.name = "stem";
  for (int i = 0; i < 3; ++i) s.seed_spheres.push_back({awkward(random), awkward(random), awkward(random), 1.0 / 3.0});
  s.seed_points = {{awkward(random), awkward(random), awkward(random)}};
  s.seed_radius = 0.1 + 0.2;
  s.output_mask = "m.nii.gz";
  s.output_mesh = "m.vtp";
  s.seeds_file = "seeds.csv";
  s.coords = Coords::ijk;
  s.spacing = Vec3(0.1, 1.0 / 3.0, 1e-7);
  s.fit.detail = 3;
  s.fit.model.rule = SubdivisionRule::balanced;
  s.fit.model.solid = StartSolid::icosahedron;
  s.fit.start_rule = StartRule::rays;
  s.fit.polarity = Polarity::dark;
  s.fit.boundary = Boundary::ridge;
  s.fit.smoothing_mm = std::abs(awkward(random));
  s.fit.energies = {{energy::edge, awkward(random)}, {energy::flux, awkward(random)}};
  s.fit.target_volume_ml = 0.1 + 0.2;
  s.fit.similarity = false;
  s.fit.max_iterations = 7;
  s.fit.solver = Solver::dynamic;
  s.fit.time_step = std::abs(awkward(random));
  s.fit.mass = std::abs(awkward(random));
  s.fit.damping = 0.1 + 0.2;
  s.fit.error_target_mm = 1.0 / 7.0;
  s.points = "p.csv";
  s.points_pull = PointsPull::point;
  s.trace = "way";
  s.trace_every = 11;
  s.fit.tolerance = std::abs(awkward(random));
  s.write = {"qc", "mask"};
  s.mesh_format = MeshFormat::vtp;
  s.mesh_density = 5;
  s.threads = 2;
  s.overwrite = true;
  Stage stage;
  stage.name = "first";
  stage.energies = {{energy::bending, awkward(random)}};
  stage.resolution = std::abs(awkward(random));
  stage.solver = Solver::gradient;
  stage.motion = {std::abs(awkward(random)), std::abs(awkward(random)), 1.0 / 3.0};
  s.fit.stages = {stage, Stage{}};
  return s;
}

TEST(Settings, TomlRoundTripIsExact) {
  RandomEngine random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const SegmentSettings before = random_settings(random);
    const std::string text = toml_of(before);
    SegmentSettings after;
    apply_toml_text(text, "test", after);
    EXPECT_EQ(toml_of(after), text);
    ASSERT_EQ(after.seed_spheres.size(), before.seed_spheres.size());
    EXPECT_EQ(after.seed_spheres, before.seed_spheres);  // to the last bit
    EXPECT_EQ(after.seed_points, before.seed_points);
    EXPECT_EQ(after.seed_radius, before.seed_radius);
    EXPECT_EQ(after.output_mesh, before.output_mesh);
    EXPECT_EQ(after.fit.energies, before.fit.energies);
    EXPECT_EQ(after.fit.smoothing_mm, before.fit.smoothing_mm);
    ASSERT_EQ(after.fit.stages.size(), 2U);
    EXPECT_EQ(after.fit.stages[0].energies, before.fit.stages[0].energies);
    EXPECT_EQ(after.fit.stages[0].resolution, before.fit.stages[0].resolution);
    EXPECT_EQ(after.fit.stages[0].solver, Solver::gradient);
    EXPECT_EQ(after.fit.stages[0].motion.mass, before.fit.stages[0].motion.mass);
    EXPECT_EQ(after.fit.solver, Solver::dynamic);
    EXPECT_EQ(after.fit.error_target_mm, before.fit.error_target_mm);
    EXPECT_EQ(after.points_pull, PointsPull::point);
    EXPECT_EQ(after.trace, before.trace);
    EXPECT_EQ(after.input, before.input);
    EXPECT_EQ(after.write, before.write);
    EXPECT_EQ(json_of(after).dump(), json_of(before).dump());
  }
}

struct Broken {
  const char* text;
  const char* message;
};

class BrokenToml : public testing::TestWithParam<Broken> {};

TEST_P(BrokenToml, NamesFileLineAndKey) {
  SegmentSettings settings;
  try {
    apply_toml_text(GetParam().text, "my.toml", settings);
    FAIL() << "accepted: " << GetParam().text;
  } catch (const Error& fault) {
    EXPECT_THAT(fault.what(), testing::HasSubstr(GetParam().message));
    EXPECT_THAT(fault.what(), testing::Not(testing::HasSubstr("\n")));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BrokenToml,
    testing::Values(Broken{"\n\npolarty = \"bright\"\n", "my.toml:3, polarty"},
                    Broken{"polarity = \"grey\"\n", "my.toml:1, polarity"},
                    Broken{"detail = \"two\"\n", "my.toml:1, detail"}, Broken{"detail = 1.5\n", "my.toml:1, detail"},
                    Broken{"seed-sphere = [[1, 2, 3]]\n", "my.toml:1, seed-sphere"},
                    Broken{"energy = 3\n", "my.toml:1, energy"}, Broken{"overwrite = 3\n", "my.toml:1, overwrite"},
                    Broken{"smoothing = inf\n", "my.toml:1, smoothing"},
                    Broken{"[[stage]]\nname = \"a\"\nreech = 3\n", "my.toml:3, stage.reech"},
                    Broken{"[stage]\nname = \"a\"\n", "my.toml:1, stage"}, Broken{"a = = 3\n", "my.toml:1"},
                    Broken{"spacing = [1.0, 2.0]\n", "my.toml:1, spacing"}));

TEST(Settings, RefusesWhatThisVersionCannotDo) {
  const auto refuses = [](auto change) {
    SegmentSettings s;
    s.input = "in.nii";
    s.output = "out";
    change(s);
    EXPECT_THROW(s.validate(), UsageError);
  };
  SegmentSettings good;
  good.input = "in.nii";
  good.output = "out";
  EXPECT_NO_THROW(good.validate());
  good.points = "p.csv";
  good.fit.energies[energy::springs] = 1.0;
  EXPECT_NO_THROW(good.validate());
  SegmentSettings many = good;
  many.points.reset();
  many.fit.energies = {};
  many.objects = Objects::many;
  many.radius = RadiusRange{2.0, 4.0};
  EXPECT_NO_THROW(many.validate());
  refuses([](auto& s) { s.input.clear(); });
  refuses([](auto& s) { s.output.clear(); });
  refuses([](auto& s) { s.trace_every = 0; });
  refuses([](auto& s) { s.fit.mass = 1.0; });
  refuses([](auto& s) { s.fit.energies[energy::springs] = 1.0; });
  refuses([](auto& s) { s.radius = RadiusRange{2.0, 4.0}; });  // of many objects alone
  refuses([](auto& s) {
    s.objects = Objects::many;
    s.radius = RadiusRange{4.0, 2.0};
  });
  refuses([](auto& s) {
    s.objects = Objects::many;
    s.valley = 1.5;
  });
  refuses([](auto& s) { s.write = {"picture"}; });
  refuses([](auto& s) { s.write = {}; });
  refuses([](auto& s) { s.threads = -1; });
  refuses([](auto& s) { s.mesh_density = 8; });
  refuses([](auto& s) { s.name = "a/b"; });
  refuses([](auto& s) { s.spacing = Vec3(1, 0, 1); });
  refuses([](auto& s) { s.seed_spheres = {{0, 0, 0, 0}}; });
  refuses([](auto& s) {
    s.seed_auto = true;
    s.seed_mask = "m.nii";
  });
}

TEST(Settings, StemDropsExtensionsOfVolumesOnly) {
  const auto stem = [](const char* input) {
    SegmentSettings s;
    s.input = input;
    return stem_of(s);
  };
  EXPECT_EQ(stem("a/scan.nii.gz"), "scan");
  EXPECT_EQ(stem("scan.v2.NRRD"), "scan.v2");
  EXPECT_EQ(stem("cells.ome.tif"), "cells");
  EXPECT_EQ(stem("data/series/"), "series");
  EXPECT_EQ(stem("data/series"), "series");
  EXPECT_EQ(stem("1.2.840.113"), "1.2.840.113");
}

TEST(SegmentSettings, AnEnergyThatIsNotInTheTableIsNamedInTheError) {
  SegmentSettings settings;
  try {
    apply_toml_text("[[stage]]\nname = 'a'\n[stage.energies]\nregoin = 1\n", "run.toml", settings);
    FAIL() << "an unknown energy was taken";
  } catch (const SettingError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("regoin"));
    EXPECT_THAT(e.what(), testing::HasSubstr("run.toml:4"));
  }
  EXPECT_THROW(apply_toml_text("energy = {gravity = 1}\n", "run.toml", settings), SettingError);
}

TEST(Presets, AreListedDescribedAndValid) {
  const auto presets = list_presets();
  std::vector<std::string> names;
  for (const auto& preset : presets) {
    names.push_back(preset.name);
    EXPECT_FALSE(preset.description.empty()) << preset.name;
    SegmentSettings settings;
    apply_toml_file(preset.path, settings);
    EXPECT_NO_THROW(settings.validate_values()) << preset.name;
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"bright", "dark", "membrane", "brain-t1", "organ-ct", "lesion"}));
  EXPECT_THROW(find_preset("no-such-preset"), UsageError);
  EXPECT_THROW(find_preset("no-such-preset.toml"), NoInput);
}

}  // namespace
}  // namespace pellicle
