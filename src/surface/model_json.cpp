#include "pellicle/surface/internal/model_json.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "pellicle/base/errors.h"

namespace pellicle {

using nlohmann::json;

namespace {

constexpr double kUnitTolerance = 1e-6;

}  // namespace

void ModelReader::fail(const std::string& key, const std::string& why) const {
  throw BadData(fmt::format("model file ({}): \"{}\" {}", path_.string(), key, why));
}

bool ModelReader::has(const std::string& key) const {
  return object_.contains(key);
}

const json& ModelReader::at(const std::string& key) const {
  if (!object_.contains(key)) fail(key, "is missing");
  return object_[key];
}

void ModelReader::expect(const std::string& key, const std::string& value) const {
  if (text(key) != value) fail(key, fmt::format("must be \"{}\"", value));
}

std::string ModelReader::text(const std::string& key) const {
  if (!at(key).is_string()) fail(key, "must be a string");
  return at(key).get<std::string>();
}

template <std::size_t N>
std::vector<std::array<int, N>> ModelReader::index_rows(const std::string& key) const {
  std::vector<std::array<int, N>> result;
  const json& list = rows(key, N);
  result.reserve(list.size());
  for (const json& row : list) {
    std::array<int, N> indices{};
    for (std::size_t i = 0; i < N; ++i) {
      if (!row[i].is_number_integer()) fail(key, fmt::format("entry {}: must be whole numbers", result.size()));
      const auto value = row[i].get<std::int64_t>();
      if (value < 0 || value > 100'000'000) fail(key, fmt::format("entry {}: no such vertex {}", result.size(), value));
      indices[i] = static_cast<int>(value);
    }
    result.push_back(indices);
  }
  return result;
}

std::vector<std::array<int, 3>> ModelReader::index_triples(const std::string& key) const {
  return index_rows<3>(key);
}

std::vector<std::array<int, 4>> ModelReader::index_quads(const std::string& key) const {
  return index_rows<4>(key);
}

bool ModelReader::flag(const std::string& key) const {
  if (!at(key).is_boolean()) fail(key, "must be true or false");
  return at(key).get<bool>();
}

std::vector<Vec3> ModelReader::vectors(const std::string& key) const {
  std::vector<Vec3> result;
  for (const json& row : rows(key, 3)) {
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

std::vector<Vec3> ModelReader::unit_vectors(const std::string& key) const {
  std::vector<Vec3> result = vectors(key);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!(std::abs(result[i].norm() - 1) <= kUnitTolerance)) {
      fail(key, fmt::format("entry {}: has length {}, must be 1", i, result[i].norm()));
    }
  }
  return result;
}

ModelReader ModelReader::inner(const std::string& key) const {
  if (!at(key).is_object()) fail(key, "must be an object");
  return {path_, at(key)};
}

const json& ModelReader::rows(const std::string& key, std::size_t size) const {
  if (!at(key).is_array()) fail(key, "must be a list");
  std::size_t i = 0;
  for (const json& row : at(key)) {
    if (!row.is_array() || row.size() != size) {
      fail(key, fmt::format("entry {}: must be a list of {} numbers", i, size));
    }
    ++i;
  }
  return at(key);
}

double ModelReader::number(const std::string& key) const {
  if (!at(key).is_number()) fail(key, "must be a number");
  const auto value = at(key).get<double>();
  if (!std::isfinite(value)) fail(key, "must be finite");
  return value;
}

int ModelReader::whole(const std::string& key) const {
  if (!at(key).is_number_integer()) fail(key, "must be a whole number");
  // unsigned numbers beyond the range of int64 come out negative
  const auto value = at(key).get<std::int64_t>();
  if (value < 0 || value > std::numeric_limits<int>::max()) fail(key, fmt::format("is {}, out of range", value));
  return static_cast<int>(value);
}

std::string json_number(double value) {
  return json(value).dump();
}

std::string json_rows(const Parameters& parameters, std::size_t first, std::size_t stride, const char* indent) {
  std::string text = "[";
  for (std::size_t i = first; i + 2 < parameters.size(); i += stride) {
    text += fmt::format("{}\n{}[{}, {}, {}]", i == first ? "" : ",", indent, json_number(parameters[i]),
                        json_number(parameters[i + 1]), json_number(parameters[i + 2]));
  }
  return text + "]";
}

std::string json_head(const char* model) {
  return fmt::format(
      "{{\n  \"format\": \"pellicle-model\",\n  \"version\": {},\n  \"model\": \"{}\",\n  \"frame\": \"LPS\",\n  "
      "\"unit\": "
      "\"mm\"",
      kModelFileVersion, model);
}

}  // namespace pellicle
