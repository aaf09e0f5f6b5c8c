#include "pellicle/surface/model_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"

namespace pellicle {
namespace {

using nlohmann::json;

constexpr int kVersion = 1;
constexpr double kUnitTolerance = 1e-6;

/// Reads one file's keys, naming file and key in every complaint.
class Reader {
 public:
  Reader(const std::filesystem::path& path, const json& object) : path_(path), object_(object) {}

  [[noreturn]] void fail(const std::string& key, const std::string& why) const {
    throw BadData(fmt::format("model file ({}): \"{}\" {}", path_.string(), key, why));
  }
  bool has(const std::string& key) const { return object_.contains(key); }
  const json& at(const std::string& key) const {
    if (!object_.contains(key)) fail(key, "is missing");
    return object_[key];
  }
  void expect(const std::string& key, const std::string& value) const {
    if (text(key) != value) fail(key, fmt::format("must be \"{}\"", value));
  }
  std::string text(const std::string& key) const {
    if (!at(key).is_string()) fail(key, "must be a string");
    return at(key).get<std::string>();
  }
  std::vector<std::array<int, 3>> index_triples(const std::string& key) const {
    std::vector<std::array<int, 3>> result;
    for (const json& row : triples(key)) {
      std::array<int, 3> triple{};
      for (int i = 0; i < 3; ++i) {
        if (!row[i].is_number_integer()) fail(key, fmt::format("entry {}: must be whole numbers", result.size()));
        const auto value = row[i].get<std::int64_t>();
        if (value < 0 || value > 100'000'000)
          fail(key, fmt::format("entry {}: no such vertex {}", result.size(), value));
        triple[i] = static_cast<int>(value);
      }
      result.push_back(triple);
    }
    return result;
  }
  std::vector<Vec3> vectors(const std::string& key) const {
    std::vector<Vec3> result;
    for (const json& row : triples(key)) {
      Vec3 v;
      for (int i = 0; i < 3; ++i) {
        if (!row[i].is_number()) fail(key, fmt::format("entry {}: must be numbers", result.size()));
        v[i] = row[i].get<double>();
      }
      if (!v.allFinite()) fail(key, fmt::format("entry {}: must be finite", result.size()));
      result.push_back(v);
    }
    return result;
  }
  std::vector<Vec3> unit_vectors(const std::string& key) const {
    std::vector<Vec3> result = vectors(key);
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (!(std::abs(result[i].norm() - 1) <= kUnitTolerance)) {
        fail(key, fmt::format("entry {}: has length {}, must be 1", i, result[i].norm()));
      }
    }
    return result;
  }
  /// "points" and "normals" as blocks, as many of one as of the other.
  Parameters points_and_normals() const {
    const std::vector<Vec3> points = vectors("points"), normals = unit_vectors("normals");
    if (points.size() != normals.size()) {
      fail("normals", fmt::format("has {} entries, \"points\" has {}", normals.size(), points.size()));
    }
    Parameters result;
    for (std::size_t i = 0; i < points.size(); ++i) {
      result.insert(result.end(), points[i].begin(), points[i].end());
      result.insert(result.end(), normals[i].begin(), normals[i].end());
    }
    return result;
  }
  Reader inner(const std::string& key) const {
    if (!at(key).is_object()) fail(key, "must be an object");
    return {path_, at(key)};
  }

 private:
  const json& triples(const std::string& key) const {
    if (!at(key).is_array()) fail(key, "must be a list");
    std::size_t i = 0;
    for (const json& row : at(key)) {
      if (!row.is_array() || row.size() != 3) fail(key, fmt::format("entry {}: must be a list of 3 numbers", i));
      ++i;
    }
    return at(key);
  }

  const std::filesystem::path& path_;
  const json& object_;
};

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

SubdivisionRule read_rule(const Reader& reader) {
  const std::string name = reader.text("rule");
  for (const SubdivisionRule rule : {SubdivisionRule::smooth, SubdivisionRule::published, SubdivisionRule::balanced}) {
    if (name == rule_name(rule)) return rule;
  }
  reader.fail("rule", fmt::format("is \"{}\", must be smooth, published or balanced", name));
}

/// One block of each vertex (0: points, 1: normals), a line each; shortest digits that read back to the same bits.
std::string rows(const Parameters& parameters, std::size_t block, const char* indent) {
  std::string text = "[";
  for (std::size_t i = 3 * block; i + 2 < parameters.size(); i += 6) {
    text += fmt::format("{}\n{}[{}, {}, {}]", i == 3 * block ? "" : ",", indent, json(parameters[i]).dump(),
                        json(parameters[i + 1]).dump(), json(parameters[i + 2]).dump());
  }
  return text + "]";
}

std::string text_of(const NormalModel& model, const Parameters& parameters) {
  std::string text = fmt::format(
      "{{\n  \"format\": \"pellicle-model\",\n  \"version\": {},\n  \"model\": \"normal\",\n  \"rule\": \"{}\",\n"
      "  \"frame\": \"LPS\",\n  \"unit\": \"mm\",\n  \"triangles\": [",
      kVersion, rule_name(model.rule()));
  const auto& triangles = model.triangles();
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    text += fmt::format("{}\n    [{}, {}, {}]", f == 0 ? "" : ",", triangles[f][0], triangles[f][1], triangles[f][2]);
  }
  text +=
      fmt::format("],\n  \"points\": {},\n  \"normals\": {}", rows(parameters, 0, "    "), rows(parameters, 1, "    "));
  if (!model.reference().empty()) {
    text += fmt::format(",\n  \"reference\": {{\n    \"points\": {},\n    \"normals\": {}}}",
                        rows(model.reference(), 0, "      "), rows(model.reference(), 1, "      "));
  }
  return text + "\n}\n";
}

Surface read_normal_model(const std::filesystem::path& path, const Reader& reader) {
  reader.expect("frame", "LPS");
  reader.expect("unit", "mm");
  const SubdivisionRule rule = read_rule(reader);
  Parameters parameters = reader.points_and_normals();
  Parameters sphere;
  if (reader.has("reference")) sphere = reader.inner("reference").points_and_normals();
  const int count = static_cast<int>(parameters.size() / 6);
  try {
    NormalModel model(count, reader.index_triples("triangles"), rule, std::move(sphere));
    return {std::move(model), std::move(parameters)};
  } catch (const BadData& error) {
    if (std::string_view(error.what()).starts_with("model file")) throw;
    throw BadData(fmt::format("model file ({}): {}", path.string(), error.what()));
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
  write_text_file(path, text_of(std::get<NormalModel>(surface.model), surface.parameters));
}

Surface read_model(const std::filesystem::path& path) {
  const json document = parse(path);
  if (!document.is_object()) throw BadData(fmt::format("model file ({}): must hold one JSON object", path.string()));
  const Reader reader(path, document);
  reader.expect("format", "pellicle-model");
  if (!reader.at("version").is_number_integer() || reader.at("version") != kVersion) {
    reader.fail("version", fmt::format("is {}, this program reads {}", reader.at("version").dump(), kVersion));
  }
  const std::string model = reader.text("model");
  if (model == "normal") return read_normal_model(path, reader);
  reader.fail("model", fmt::format("is \"{}\", which this program does not know; known: normal", model));
}

}  // namespace pellicle
