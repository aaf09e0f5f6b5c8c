// The morph command without a command line: settings, files, figures.

#include "../temporary_folder.h"
#include "pellicle/output/morph_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/picture/contact_sheet.h"
#include "pellicle/picture/shaded_view.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace {
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class MorphFiles : public testing::Test {
 protected:
  MorphFiles() {
    write_model(folder_ / "small_model.json", ball(10.0));
    write_model(folder_ / "large.json", ball(20.0));
    settings_.a = folder_ / "small_model.json";
    settings_.b = folder_ / "large.json";
    settings_.output = folder_ / "out";
    settings_.mesh_density = 3;
  }
  static Surface ball(double radius) {
    const SurfaceModel model = start_model({});
    return {model, affine_image(model, Vec3(radius, 0, 0), radius * Mat3::Identity())};
  }

  const test::TemporaryFolder temporary_;
  const fs::path& folder_ = temporary_.path();
  MorphSettings settings_;
};

TEST_F(MorphFiles, AreAllThereAndTellOneStory) {
  settings_.steps = 3;
  settings_.space = MorphSpace::sphere;
  const MorphResult result = morph_to_files(settings_, {.command_line = {"pellicle", "morph"}}, {});
  EXPECT_EQ(result.exit_code(), 0);
  const std::string stem = "small_to_large_morph";
  for (const char* suffix :
       {"-001_surface.ply", "-001_model.json", "-003_surface.ply", "-003_model.json", ".tsv", ".png", ".json"}) {
    EXPECT_TRUE(fs::exists(settings_.output / (stem + suffix))) << suffix;
  }
  EXPECT_EQ(text_of(settings_.output / (stem + "-001_model.json")), text_of(settings_.a));
  EXPECT_EQ(text_of(settings_.output / (stem + "-003_model.json")), text_of(settings_.b));
  const auto json = nlohmann::json::parse(text_of(settings_.output / (stem + ".json")));
  EXPECT_EQ(json["format"], "pellicle-morph");
  EXPECT_EQ(json["settings"]["space"], "sphere");
  EXPECT_EQ(json["command_line"][1], "morph");
  ASSERT_EQ(json["steps"].size(), 3U);
  // Half way: the geometric mean of the sizes; the smooth surface's volume, not that of coarse facets.
  const double radius = std::sqrt(200.0), exact = 4.0 / 3.0 * 3.14159265358979 * std::pow(radius, 3) / 1000.0;
  EXPECT_NEAR(json["steps"][1]["volume_ml"].get<double>() / exact, 1.0, 3e-4);
  EXPECT_NEAR(json["steps"][1]["area_mm2"].get<double>() / (4.0 * 3.14159265 * radius * radius), 1.0, 0.02);
  EXPECT_EQ(json["steps"][1]["tau"], 0.5);
  EXPECT_EQ(json["steps"][1]["status"], "ok");
  EXPECT_EQ(json["steps"][1]["genus"], 0);
  EXPECT_EQ(json["a"]["moved_by_matching_mm"], 0.0);
  EXPECT_NEAR(json["b"]["size_mm"].get<double>(), 20.0, 1e-6);
  EXPECT_EQ(json["outputs"].size(), 8U);
  const std::string table = text_of(settings_.output / (stem + ".tsv"));
  EXPECT_THAT(table, testing::StartsWith("step\ttau\tvolume_ml\tarea_mm2\tself_intersections\tstatus\n1\t0\t"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
  EXPECT_THROW(morph_to_files(settings_, {}, {}), CannotCreate);
}

TEST_F(MorphFiles, HaveTheSameBytesForAnyNumberOfThreads) {
  settings_.overwrite = true;
  const auto bytes = [this](int threads) {
    settings_.threads = threads;
    morph_to_files(settings_, {}, {});
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(settings_.output)) {
      if (entry.path().filename() != "small_to_large_morph.json") all.push_back(text_of(entry.path()));
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(bytes(1), bytes(2));
}

TEST_F(MorphFiles, InsideOutShapesAreTurnedAndToldOf) {
  // Beyond the smaller ball the plane's path runs through a point and comes out inverted.
  settings_.from = settings_.to = -2.0;
  settings_.steps = 1;
  const MorphResult result = morph_to_files(settings_, {}, {});
  ASSERT_EQ(result.morphing.steps.size(), 1U);
  EXPECT_NE(result.morphing.steps[0].status, FitStatus::ok);
  EXPECT_EQ(result.exit_code(), 3);
  EXPECT_GT(volume_of(result.morphing.steps[0].mesh), 0.0);
}

TEST_F(MorphFiles, ACoarserModelIsRefinedAndTheReportSaysSo) {
  write_model(settings_.b, refine(ball(20.0)));
  settings_.steps = 2;
  const MorphResult result = morph_to_files(settings_, {}, {});
  EXPECT_EQ(result.morphing.points_a, 4);
  EXPECT_EQ(result.morphing.points, 10);
  EXPECT_LE(result.morphing.moved_a_mm, 0.05) << "a sphere stays a sphere";
}

TEST_F(MorphFiles, SplinesMeetAtTheLargerSizeAndOpenOnesHaveNoVolume) {
  const auto write = [](const fs::path& path, const SurfaceModel& model, const Vec3& half_axes) {
    write_model(path, {model, affine_image(model, Vec3(5, 6, 7), half_axes.asDiagonal())});
  };
  write(settings_.a, SplineModel({.topology = SplineTopology::sphere, .m1 = 8, .m2 = 3}), {10, 12, 8});
  write(settings_.b, SplineModel({.topology = SplineTopology::sphere, .m1 = 5, .m2 = 4}), {9, 9, 14});
  settings_.steps = 3;
  settings_.mesh_density = 4;
  const MorphResult closed = morph_to_files(settings_, {}, {});
  EXPECT_EQ(closed.morphing.points, 8 * 3 + 2);
  EXPECT_NE(closed.morphing.points, closed.morphing.points_a);
  EXPECT_LE(closed.morphing.moved_a_mm, 0.02) << "ellipsoids are kept exactly";
  EXPECT_LE(closed.morphing.moved_b_mm, 0.02);
  // Between two ellipsoids on the plane lies the ellipsoid of the mean half axes.
  EXPECT_NEAR(*closed.morphing.steps[1].volume_ml / (4.0 / 3.0 * 3.14159265358979 * 9.5 * 10.5 * 11.0 / 1000.0), 1.0,
              2e-4);

  const SplineModel cylinder({.topology = SplineTopology::cylinder, .m1 = 6, .m2 = 2});
  write(settings_.a, cylinder, {5, 5, 10});
  write(settings_.b, cylinder, {8, 4, 5});
  settings_.overwrite = true;
  const MorphResult open = morph_to_files(settings_, {}, {});
  EXPECT_EQ(open.exit_code(), 0);
  EXPECT_FALSE(open.morphing.steps[1].volume_ml.has_value());
  const auto json = nlohmann::json::parse(text_of(settings_.output / "small_to_large_morph.json"));
  EXPECT_TRUE(json["steps"][1]["volume_ml"].is_null());
  EXPECT_FALSE(json["steps"][1]["watertight"].get<bool>());
}

TEST(MorphSettings, StepsAreEquallySpacedOneIsTheMiddle) {
  MorphOptions options;
  EXPECT_THAT(taus_of(options), testing::ElementsAre(0.0, 0.25, 0.5, 0.75, 1.0));
  options.from = 1.5;
  options.to = -0.5;
  options.steps = 3;
  EXPECT_THAT(taus_of(options), testing::ElementsAre(1.5, 0.5, -0.5));
  options.steps = 1;
  EXPECT_THAT(taus_of(options), testing::ElementsAre(0.5));
  options.from = -0.3;
  options.to = 1.2;
  options.steps = 6;
  EXPECT_EQ(taus_of(options)[1], 0.0) << "an end that is met is met exactly";
}

TEST(ContactSheet, ShowsEveryShapeAtOneScale) {
  const SurfaceModel model = start_model({});
  const auto mesh = [&model](double radius) {
    return tessellate({model, affine_image(model, Vec3::Zero(), radius * Mat3::Identity())}, 3);
  };
  const TriangleMesh small = mesh(5.0), large = mesh(10.0);
  const Canvas sheet = contact_sheet({{&small, "small"}, {&large, "large"}}, "two balls");
  // Bright pixels of either half: a quarter of the area for half the radius.
  const int half = sheet.width / 2;
  double lit[2] = {0.0, 0.0};
  for (int y = 40; y < sheet.height - 30; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      if (sheet.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(sheet.width) +
                       static_cast<std::size_t>(x)][0] > 45)
        lit[x < half ? 0 : 1] += 1.0;
    }
  }
  EXPECT_NEAR(lit[0] / lit[1], 0.25, 0.02);
  EXPECT_NEAR(shaded_extent(large) / shaded_extent(small), 2.0, 1e-9);
}

TEST(ContactSheet, OfManyShapesStaysReadable) {
  const TriangleMesh mesh =
      tessellate({start_model({}), affine_image(start_model({}), Vec3::Zero(), Mat3::Identity())}, 1);
  const std::vector<SheetPanel> many(500, SheetPanel{&mesh, "x"});
  const Canvas sheet = contact_sheet(many, "many");
  EXPECT_LE(sheet.width, 1600);
  EXPECT_LE(sheet.height, 1600);
  EXPECT_LE(text_width(fitting_text(std::string(300, 'a') + "end", 2, 200), 2), 200);
  EXPECT_THAT(fitting_text(std::string(300, 'a') + "end", 2, 200), testing::EndsWith("end"));
}

}  // namespace
}  // namespace pellicle
