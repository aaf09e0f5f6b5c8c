#include "pellicle/surface/model_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/surface/internal/model_json.h"

namespace pellicle {
namespace {

using nlohmann::json;

std::string rule_name(SubdivisionRule rule) {
  switch (rule) {
    case SubdivisionRule::published:
      return "published";
    case SubdivisionRule::balanced:
      return "balanced";
    case SubdivisionRule::smooth:
      break;
  }
  return "smooth";
}

SubdivisionRule read_rule(const ModelReader& reader) {
  const std::string name = reader.text("rule");
  for (const SubdivisionRule rule : {SubdivisionRule::smooth, SubdivisionRule::published, SubdivisionRule::balanced}) {
    if (name == rule_name(rule)) return rule;
  }
  reader.fail("rule", fmt::format("is \"{}\", must be smooth, published or balanced", name));
}

/// "points" and "normals" as blocks, as many of one as of the other.
Parameters points_and_normals(const ModelReader& reader) {
  const std::vector<Vec3> points = reader.vectors("points"), normals = reader.unit_vectors("normals");
  if (points.size() != normals.size()) {
    reader.fail("normals", fmt::format("has {} entries, \"points\" has {}", normals.size(), points.size()));
  }
  Parameters result;
  result.reserve(6 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.insert(result.end(), points[i].begin(), points[i].end());
    result.insert(result.end(), normals[i].begin(), normals[i].end());
  }
  return result;
}

std::string text_of(const NormalModel& model, const Parameters& parameters) {
  std::string text =
      json_head("normal") + fmt::format(",\n  \"rule\": \"{}\",\n  \"triangles\": [", rule_name(model.rule()));
  const auto& triangles = model.triangles();
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    text += fmt::format("{}\n    [{}, {}, {}]", f == 0 ? "" : ",", triangles[f][0], triangles[f][1], triangles[f][2]);
  }
  text += fmt::format("],\n  \"points\": {},\n  \"normals\": {}", json_rows(parameters, 0, 6, "    "),
                      json_rows(parameters, 3, 6, "    "));
  if (!model.reference().empty()) {
    text += fmt::format(",\n  \"reference\": {{\n    \"points\": {},\n    \"normals\": {}}}",
                        json_rows(model.reference(), 0, 6, "      "), json_rows(model.reference(), 3, 6, "      "));
  }
  return text + "\n}\n";
}

Surface read_normal_model(const ModelReader& reader) {
  const SubdivisionRule rule = read_rule(reader);
  Parameters parameters = points_and_normals(reader);
  Parameters sphere;
  if (reader.has("reference")) sphere = points_and_normals(reader.inner("reference"));
  const int count = static_cast<int>(parameters.size() / 6);
  try {
    NormalModel model(count, reader.index_triples("triangles"), rule, std::move(sphere));
    return {std::move(model), std::move(parameters)};
  } catch (const BadData& error) {
    if (std::string_view(error.what()).starts_with("model file")) throw;
    throw BadData(fmt::format("model file ({}): {}", reader.path().string(), error.what()));
  }
}

json parse(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    throw NoInput(fmt::format("model file ({}): is a folder; name a .json file", path.string()));
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw NoInput(fmt::format("model file ({}): does not exist or cannot be opened", path.string()));
  try {
    return json::parse(in);
  } catch (const json::exception& error) {
    throw BadData(fmt::format("model file ({}): is not JSON: {}", path.string(), error.what()));
  }
}

}  // namespace

void write_model(const std::filesystem::path& path, const Surface& surface) {
  write_text_file(path,
                  std::visit([&](const auto& model) { return text_of(model, surface.parameters); }, surface.model));
}

Surface read_model(const std::filesystem::path& path) {
  const json document = parse(path);
  if (!document.is_object()) throw BadData(fmt::format("model file ({}): must hold one JSON object", path.string()));
  const ModelReader reader(path, document);
  reader.expect("format", "pellicle-model");
  if (!reader.at("version").is_number_integer() || reader.at("version") != kModelFileVersion) {
    reader.fail("version", fmt::format("is {}, this program reads {}", reader.at("version").dump(), kModelFileVersion));
  }
  const std::string model = reader.text("model");
  const std::vector<std::string> known{"normal", "spline", "catmull-clark", "slime"};
  if (std::find(known.begin(), known.end(), model) == known.end()) {
    reader.fail("model",
                fmt::format("is \"{}\", which this program does not know; known: {}", model, fmt::join(known, ", ")));
  }
  reader.expect("frame", "LPS");
  reader.expect("unit", "mm");
  if (model == "normal") return read_normal_model(reader);
  return model == "spline" ? read_spline_model(reader) : read_quad_model(reader);
}

}  // namespace pellicle
