#pragma once
/// Parts of the readers and writers of all model files (model_file.h).

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pellicle/surface/surface.h"

namespace pellicle {

/// Of the model files that this program writes and reads.
inline constexpr int kModelFileVersion = 1;

/// Reads one file's keys; every complaint (BadData) names the file and the key.
class ModelReader {
 public:
  using json = nlohmann::json;
  /// \pre both outlive the reader.
  ModelReader(const std::filesystem::path& path, const json& object) : path_(path), object_(object) {}

  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& key, const std::string& why) const;
  bool has(const std::string& key) const;
  const json& at(const std::string& key) const;
  void expect(const std::string& key, const std::string& value) const;
  std::string text(const std::string& key) const;
  double number(const std::string& key) const;
  /// Anything beyond the range of int fails.
  int whole(const std::string& key) const;
  std::vector<std::array<int, 3>> index_triples(const std::string& key) const;
  std::vector<std::array<int, 4>> index_quads(const std::string& key) const;
  bool flag(const std::string& key) const;
  std::vector<Vec3> vectors(const std::string& key) const;
  std::vector<Vec3> unit_vectors(const std::string& key) const;
  ModelReader inner(const std::string& key) const;

 private:
  const json& rows(const std::string& key, std::size_t size) const;
  template <std::size_t N>
  std::vector<std::array<int, N>> index_rows(const std::string& key) const;

  const std::filesystem::path& path_;
  const json& object_;
};

/// Shortest digits that read back to the same bits.
std::string json_number(double value);
/// The vectors that start at scalar `first`, `stride` scalars apart, a line each.
std::string json_rows(const Parameters& parameters, std::size_t first, std::size_t stride, const char* indent);
/// The keys that every model file begins with, up to and without the closing comma.
std::string json_head(const char* model);

/// A file's text, and its surface again.
std::string text_of(const SplineModel& model, const Parameters& parameters);
std::string text_of(const CatmullClarkModel& model, const Parameters& parameters);
std::string text_of(const SlimeModel& model, const Parameters& parameters);
Surface read_spline_model(const ModelReader& reader);
Surface read_quad_model(const ModelReader& reader);  ///< "catmull-clark" or "slime"

}  // namespace pellicle
