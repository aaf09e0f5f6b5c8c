#include "pellicle/surface/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <sstream>

#include "pellicle/base/errors.h"
#include "quad_shapes.h"
#include "spline_cases.h"

namespace pellicle {
namespace {

using nlohmann::json;

class ModelFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("pellicle_model_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file(const std::string& name = "model.json") const { return folder_ / name; }
  std::filesystem::path written(const std::string& text) const {
    std::ofstream(file("given.json"), std::ios::binary) << text;
    return file("given.json");
  }

 private:
  std::filesystem::path folder_;
};

std::string text_of(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

Surface random_surface(SubdivisionRule rule, RandomEngine& random) {
  NormalModel model = NormalModel::start(StartSolid::icosahedron, rule);
  Parameters parameters = shapes::perturbed_sphere(model, 0.3, random);
  return {std::move(model), std::move(parameters)};
}

bool same_bits(const Parameters& a, const Parameters& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST_F(ModelFile, ReadsBackToTheSameBits) {
  RandomEngine random(41);
  for (const SubdivisionRule rule : shapes::kRules) {
    Surface surface = random_surface(rule, random);
    const double odd[] = {-0.0, 4.9e-324, 1.7976931348623157e308, 0.1 + 0.2, 1.0, -1e-300, 12345678901234567.0};
    for (int i = 0; i < 7; ++i) surface.parameters[6 * std::size_t(i)] = odd[i];
    write_model(file(), surface);
    const Surface back = read_model(file());
    const auto& model = std::get<NormalModel>(surface.model);
    const auto& read = std::get<NormalModel>(back.model);
    EXPECT_TRUE(same_bits(surface.parameters, back.parameters));
    EXPECT_TRUE(same_bits(model.reference(), read.reference()));
    EXPECT_EQ(model.triangles(), read.triangles());
    EXPECT_EQ(model.rule(), read.rule());
    write_model(file("again.json"), back);
    EXPECT_EQ(text_of(file()), text_of(file("again.json")));
  }
}

TEST_F(ModelFile, WorksWithoutAUnitSphere) {
  const NormalModel start = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
  const Surface surface{NormalModel(4, start.triangles(), start.rule(), {}), start.reference()};
  write_model(file(), surface);
  EXPECT_TRUE(std::get<NormalModel>(read_model(file()).model).reference().empty());
}

TEST_F(ModelFile, HasTheKeysOfTheSchema) {
  RandomEngine random(42);
  write_model(file(), random_surface(SubdivisionRule::smooth, random));
  const json document = json::parse(text_of(file()));
  const json schema = json::parse(text_of(std::string(PELLICLE_SOURCE_DIR) + "/docs/model.schema.json"));
  for (const auto& [key, value] : document.items()) EXPECT_TRUE(schema.at("properties").contains(key)) << key;
  for (const auto& key : schema.at("required")) EXPECT_TRUE(document.contains(key)) << key;
  EXPECT_EQ(schema.at("properties").at("version").at("const"), document.at("version"));
}

TEST_F(ModelFile, RefusesWhatBreaksARuleAndNamesTheKey) {
  RandomEngine random(43);
  write_model(file(), random_surface(SubdivisionRule::smooth, random));
  const json good = json::parse(text_of(file()));
  struct Case {
    const char* message;
    std::function<void(json&)> spoil;
  };
  const std::vector<Case> cases{
      {"\"format\" is missing", [](json& j) { j.erase("format"); }},
      {"\"format\" must be \"pellicle-model\"", [](json& j) { j["format"] = "mesh"; }},
      {"\"format\" must be a string", [](json& j) { j["format"] = 3; }},
      {"\"version\" is 2", [](json& j) { j["version"] = 2; }},
      {"\"version\" is \"1\"", [](json& j) { j["version"] = "1"; }},
      {"\"model\" is \"cube\"", [](json& j) { j["model"] = "cube"; }},
      {"\"rule\" is \"best\"", [](json& j) { j["rule"] = "best"; }},
      {"\"frame\" must be \"LPS\"", [](json& j) { j["frame"] = "RAS"; }},
      {"\"unit\" must be \"mm\"", [](json& j) { j["unit"] = "m"; }},
      {"\"points\" is missing", [](json& j) { j.erase("points"); }},
      {"\"points\" must be a list", [](json& j) { j["points"] = 1; }},
      {"\"points\" entry 3: must be a list of 3", [](json& j) { j["points"][3].push_back(1.0); }},
      {"\"points\" entry 2: must be numbers", [](json& j) { j["points"][2][1] = "1"; }},
      {"\"points\" entry 2: must be numbers", [](json& j) { j["points"][2][1] = nullptr; }},
      {"\"normals\" entry 5: has length",
       [](json& j) {
         j["normals"][5] = {1.0, 0.1, 0.0};
       }},
      {"\"normals\" entry 5: has length",
       [](json& j) {
         j["normals"][5] = {0, 0, 0};
       }},
      {"\"normals\" has 11 entries", [](json& j) { j["normals"].erase(11); }},
      {"\"triangles\" entry 0: must be whole", [](json& j) { j["triangles"][0][0] = 0.5; }},
      {"\"triangles\" entry 0: no such vertex -1", [](json& j) { j["triangles"][0][0] = -1; }},
      {"\"triangles\" entry 0: no such vertex", [](json& j) { j["triangles"][0][0] = 18446744073709551615U; }},
      {"is not among the 12 points", [](json& j) { j["triangles"][0][0] = 12; }},
      {"open", [](json& j) { j["triangles"].erase(4); }},
      {"no triangles", [](json& j) { j["triangles"] = json::array(); }},
      {"belongs to no triangle",
       [](json& j) {
         j["points"].push_back({1, 2, 3});
         j["normals"].push_back({0, 0, 1});
         j.erase("reference");
       }},
      {"\"reference\" must be an object", [](json& j) { j["reference"] = 1; }},
      {"\"normals\" is missing", [](json& j) { j["reference"].erase("normals"); }},
      {"\"normals\" entry 2: has length",
       [](json& j) {
         j["reference"]["normals"][2] = {0, 0, 2};
       }},
      {"reference shape of the control mesh (all)", [](json& j) {
         j["reference"]["points"].erase(2);
         j["reference"]["normals"].erase(2);
       }}};
  for (const auto& [message, spoil] : cases) {
    json bad = good;
    spoil(bad);
    try {
      read_model(written(bad.dump()));
      ADD_FAILURE() << "accepted, expected: " << message;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
      EXPECT_THAT(error.what(), testing::HasSubstr("given.json"));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }
}

/// A torus grid and an open sheet, jittered.
std::vector<Surface> quad_surfaces() {
  RandomEngine random(47);
  const QuadMesh ring = quad_shapes::jittered(torus_mesh(5, 4, 2, 0.7), 0.2, random);
  const QuadMesh sheet = quad_shapes::sheet(3, 2, random);
  const QuadReference shape{parameters_of(ring.vertices), false};
  const CatmullClarkModel ball = CatmullClarkModel::start(1);
  return {{CatmullClarkModel(20, ring.quads, shape), parameters_of(ring.vertices)},
          {SlimeModel(20, ring.quads, shape), parameters_of(ring.vertices)},
          {SlimeModel(20, ring.quads, {}), parameters_of(ring.vertices)},
          {CatmullClarkModel(12, sheet.quads, {}, Border::allowed), parameters_of(sheet.vertices)},
          {ball, ball.reference()}};
}

TEST_F(ModelFile, QuadSurfacesReadBackToTheSameBits) {
  for (const Surface& surface : quad_surfaces()) {
    write_model(file(), surface);
    const Surface back = read_model(file());
    EXPECT_EQ(model_name(back.model), model_name(surface.model));
    EXPECT_EQ(is_closed(back.model), is_closed(surface.model));
    EXPECT_TRUE(same_bits(surface.parameters, back.parameters));
    const TriangleMesh one = tessellate(surface, 2), two = tessellate(back, 2);
    EXPECT_EQ(one.vertices, two.vertices);
    EXPECT_EQ(layout_of(surface.model, 1).reference, layout_of(back.model, 1).reference);
    write_model(file("again.json"), back);
    EXPECT_EQ(text_of(file()), text_of(file("again.json")));
    const json document = json::parse(text_of(file()));
    const json schema = json::parse(text_of(std::string(PELLICLE_SOURCE_DIR) + "/docs/model.schema.json"));
    for (const auto& [key, value] : document.items()) EXPECT_TRUE(schema.at("properties").contains(key)) << key;
  }
}

TEST_F(ModelFile, RefusesQuadSurfacesThatBreakARule) {
  write_model(file(), quad_surfaces()[1]);
  const json good = json::parse(text_of(file()));
  struct Case {
    const char* message;
    std::function<void(json&)> spoil;
  };
  const std::vector<Case> cases{{"\"quads\" is missing", [](json& j) { j.erase("quads"); }},
                                {"\"quads\" entry 2: must be a list of 4", [](json& j) { j["quads"][2].erase(0); }},
                                {"\"quads\" entry 1: must be whole", [](json& j) { j["quads"][1][3] = 1.5; }},
                                {"is not among the 20", [](json& j) { j["quads"][1][3] = 20; }},
                                {"open", [](json& j) { j["quads"].erase(3); }},
                                {"no quads", [](json& j) { j["quads"] = json::array(); }},
                                {"\"points\" entry 2: must be numbers", [](json& j) { j["points"][2][1] = nullptr; }},
                                {"\"sphere\" must be true or false", [](json& j) { j["reference"]["sphere"] = 1; }},
                                {"\"points\" has 19 entries", [](json& j) { j["reference"]["points"].erase(3); }}};
  for (const auto& [message, spoil] : cases) {
    json bad = good;
    spoil(bad);
    try {
      read_model(written(bad.dump()));
      ADD_FAILURE() << "accepted, expected: " << message;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
      EXPECT_THAT(error.what(), testing::HasSubstr("given.json"));
    }
  }
}

TEST_F(ModelFile, SplinesReadBackToTheSameBits) {
  RandomEngine random(46);
  for (const SplineModel& model : shapes::all_splines()) {
    Surface surface{model, shapes::perturbed(model, 0.3, random)};
    const double odd[] = {-0.0, 4.9e-324, 1.7976931348623157e308, 0.1 + 0.2, 1.0, -1e-300, 12345678901234567.0};
    std::copy(std::begin(odd), std::end(odd), surface.parameters.begin());
    write_model(file(), surface);
    const Surface back = read_model(file());
    EXPECT_TRUE(same_bits(surface.parameters, back.parameters));
    EXPECT_EQ(std::get<SplineModel>(back.model).settings(), model.settings());
    write_model(file("again.json"), back);
    EXPECT_EQ(text_of(file()), text_of(file("again.json")));
    const json document = json::parse(text_of(file()));
    const json schema = json::parse(text_of(std::string(PELLICLE_SOURCE_DIR) + "/docs/model.schema.json"));
    for (const auto& [key, value] : document.items()) EXPECT_TRUE(schema.at("properties").contains(key)) << key;
  }
}

TEST_F(ModelFile, RefusesSplinesThatBreakARule) {
  const SplineModel torus = start_spline(SplineTopology::torus);
  write_model(file(), {torus, torus.reference()});
  const json good = json::parse(text_of(file()));
  struct Case {
    const char* message;
    std::function<void(json&)> spoil;
  };
  const std::vector<Case> cases{{"\"topology\" is \"knot\", must be one of sphere, torus, cylinder, rectangle",
                                 [](json& j) { j["topology"] = "knot"; }},
                                {"\"topology\" is missing", [](json& j) { j.erase("topology"); }},
                                {"\"generator\" is \"cubic\"", [](json& j) { j["generator"] = "cubic"; }},
                                {"\"m1\" must be a whole number", [](json& j) { j["m1"] = 6.5; }},
                                {"\"m1\" is missing", [](json& j) { j.erase("m1"); }},
                                {"\"m1\" is -6, out of range", [](json& j) { j["m1"] = -6; }},
                                {"\"m2\" is -1, out of range", [](json& j) { j["m2"] = 18446744073709551615U; }},
                                {"\"blocks\" has 24 entries, too few", [](json& j) { j["m1"] = 2000000000; }},
                                {"\"blocks\" has 24 entries, must have 20", [](json& j) { j["m1"] = 5; }},
                                {"\"blocks\" has 23 entries, must have 24", [](json& j) { j["blocks"].erase(3); }},
                                {"\"blocks\" entry 3: must be a list of 3", [](json& j) { j["blocks"][3] = 1; }},
                                {"\"blocks\" is missing", [](json& j) { j.erase("blocks"); }},
                                {"spline torus (m2 = 3)", [](json& j) { j["m2"] = 3; }},
                                {"\"reference_ratio\" is missing", [](json& j) { j.erase("reference_ratio"); }},
                                {"\"reference_ratio\" must be a number", [](json& j) { j["reference_ratio"] = "0.4"; }},
                                {"reference ratio 1.5", [](json& j) { j["reference_ratio"] = 1.5; }},
                                {"\"unit\" must be \"mm\"", [](json& j) { j["unit"] = "m"; }},
                                {"\"blocks\" has 24 entries, must have 26",
                                 [](json& j) { j["topology"] = "sphere", j["m1"] = 10, j["m2"] = 3; }}};
  for (const auto& [message, spoil] : cases) {
    json bad = good;
    spoil(bad);
    try {
      read_model(written(bad.dump()));
      ADD_FAILURE() << "accepted, expected: " << message;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
      EXPECT_THAT(error.what(), testing::HasSubstr("given.json"));
    }
  }
}

TEST_F(ModelFile, RefusesWhatIsNotJson) {
  RandomEngine random(44);
  write_model(file(), random_surface(SubdivisionRule::smooth, random));
  const std::string good = text_of(file());
  for (const std::string& text :
       {std::string(), std::string("{\n\"format\":\n\n"), good.substr(0, good.size() / 2),
        std::string("\x00\xff\x01", 3), std::string("[1, 2]"), std::string("{\"format\": NaN}"),
        std::string("{\"version\": 1e999}"), good + "}", std::string(100000, '[')}) {
    try {
      read_model(written(text));
      ADD_FAILURE() << "accepted: " << text.substr(0, 40);
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
      EXPECT_LE(std::strlen(error.what()), 2000U);
    }
  }
}

TEST_F(ModelFile, NamesFilesThatCannotBeOpened) {
  EXPECT_THROW(read_model(file("absent.json")), NoInput);
  EXPECT_THROW(read_model(file().parent_path()), NoInput);
  RandomEngine random(45);
  EXPECT_THROW(write_model(file("absent") / "model.json", random_surface(SubdivisionRule::smooth, random)),
               CannotCreate);
}

}  // namespace
}  // namespace pellicle
