// Surfaces over quad control meshes in model files. See model_json.h.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/surface/internal/model_json.h"

namespace pellicle {
namespace {

template <class Model>
std::string quad_text(const Model& model, const Parameters& parameters) {
  std::string text = json_head(model.name().c_str()) + ",\n  \"quads\": [";
  const std::vector<Quad>& quads = model.topology().quads;
  for (std::size_t f = 0; f < quads.size(); ++f) {
    const auto& [a, b, c, d] = quads[f];
    text += fmt::format("{}\n    [{}, {}, {}, {}]", f == 0 ? "" : ",", a, b, c, d);
  }
  text += "],\n  \"points\": " + json_rows(parameters, 0, 3, "    ");
  const QuadReference& reference = model.reference_shape();
  if (!reference.points.empty()) {
    text += fmt::format(",\n  \"reference\": {{\n    \"sphere\": {},\n    \"points\": {}}}", reference.sphere,
                        json_rows(reference.points, 0, 3, "      "));
  }
  return text + "\n}\n";
}

/// Whether an edge has one quad only; the model's constructor names every other fault.
Border border_of(const std::vector<Quad>& quads) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(4 * quads.size());
  for (const Quad& q : quads) {
    for (std::size_t i = 0; i < 4; ++i) edges.emplace_back(std::minmax(q[i], q[(i + 1) % 4]));
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool before = i > 0 && edges[i - 1] == edges[i], after = i + 1 < edges.size() && edges[i + 1] == edges[i];
    if (!before && !after) return Border::allowed;
  }
  return Border::refused;
}

}  // namespace

std::string text_of(const CatmullClarkModel& model, const Parameters& parameters) {
  return quad_text(model, parameters);
}

std::string text_of(const SlimeModel& model, const Parameters& parameters) {
  return quad_text(model, parameters);
}

Surface read_quad_model(const ModelReader& reader) {
  Parameters points = parameters_of(reader.vectors("points"));
  QuadReference reference;
  if (reader.has("reference")) {
    const ModelReader inner = reader.inner("reference");
    reference = {parameters_of(inner.vectors("points")), inner.flag("sphere")};
    if (reference.points.size() != points.size()) {
      inner.fail("points",
                 fmt::format("has {} entries, the surface has {}", reference.points.size() / 3, points.size() / 3));
    }
  }
  const std::vector<Quad> quads = reader.index_quads("quads");
  const int count = static_cast<int>(points.size() / 3);
  try {
    if (reader.text("model") == "slime") return {SlimeModel(count, quads, std::move(reference)), std::move(points)};
    return {CatmullClarkModel(count, quads, std::move(reference), border_of(quads)), std::move(points)};
  } catch (const BadData& error) {
    throw BadData(fmt::format("model file ({}): {}", reader.path().string(), error.what()));
  }
}

}  // namespace pellicle
