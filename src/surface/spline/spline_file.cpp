// Spline surfaces in model files. See model_json.h.

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/surface/internal/model_json.h"

namespace pellicle {
namespace {

template <class E>
E named(const ModelReader& reader, const std::string& key, const std::vector<E>& all) {
  const std::string name = reader.text(key);
  std::string choices;
  for (const E value : all) {
    if (to_string(value) == name) return value;
    choices += (choices.empty() ? "" : ", ") + to_string(value);
  }
  reader.fail(key, fmt::format("is \"{}\", must be one of {}", name, choices));
}

SplineModel model_from(const ModelReader& reader, std::size_t blocks) {
  SplineSettings settings;
  settings.topology = named<SplineTopology>(
      reader, "topology",
      {SplineTopology::sphere, SplineTopology::torus, SplineTopology::cylinder, SplineTopology::rectangle});
  settings.generator =
      named<SplineGenerator>(reader, "generator", {SplineGenerator::exponential, SplineGenerator::keys});
  settings.m1 = reader.whole("m1");
  settings.m2 = reader.whole("m2");
  // Sizes far from what the file holds are not worth their memory.
  if (static_cast<double>(settings.m1) * (settings.m2 - 1) > static_cast<double>(blocks)) {
    reader.fail("blocks",
                fmt::format("has {} entries, too few for m1 = {}, m2 = {}", blocks, settings.m1, settings.m2));
  }
  if (settings.topology == SplineTopology::torus) settings.reference_ratio = reader.number("reference_ratio");
  try {
    return SplineModel(settings);
  } catch (const UsageError& error) {
    throw BadData(fmt::format("model file ({}): {}", reader.path().string(), error.what()));
  }
}

}  // namespace

std::string text_of(const SplineModel& model, const Parameters& parameters) {
  const SplineSettings& s = model.settings();
  std::string text = json_head("spline") +
                     fmt::format(",\n  \"topology\": \"{}\",\n  \"m1\": {},\n  \"m2\": {},\n  \"generator\": \"{}\"",
                                 to_string(s.topology), s.m1, s.m2, to_string(s.generator));
  if (s.topology == SplineTopology::torus) text += ",\n  \"reference_ratio\": " + json_number(s.reference_ratio);
  return text + ",\n  \"blocks\": " + json_rows(parameters, 0, 3, "    ") + "\n}\n";
}

Surface read_spline_model(const ModelReader& reader) {
  const std::vector<Vec3> blocks = reader.vectors("blocks");
  SplineModel model = model_from(reader, blocks.size());
  const std::size_t wanted = model.reference().size() / 3;
  if (blocks.size() != wanted) {
    reader.fail("blocks", fmt::format("has {} entries, must have {} for a {} x {} {}", blocks.size(), wanted,
                                      model.settings().m1, model.settings().m2, to_string(model.settings().topology)));
  }
  Parameters parameters;
  parameters.reserve(3 * wanted);
  for (const Vec3& block : blocks) parameters.insert(parameters.end(), block.begin(), block.end());
  return {std::move(model), std::move(parameters)};
}

}  // namespace pellicle
