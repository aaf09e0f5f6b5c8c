#include "pellicle/output/report_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "pellicle/image/orientation.h"
#include "pellicle/output/provenance.h"

namespace pellicle {
using json = nlohmann::ordered_json;

json number_json(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json number_json(std::optional<double> value) {
  return value ? number_json(*value) : json(nullptr);
}

json vector_json(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

json json_of(const ImageGrid& grid) {
  json direction = json::array();
  for (int row = 0; row < 3; ++row) direction.push_back(vector_json(Vec3(grid.direction.row(row))));
  return {{"size", {grid.size[0], grid.size[1], grid.size[2]}},
          {"spacing_mm", vector_json(grid.spacing)},
          {"origin_lps_mm", vector_json(grid.origin_in_world)},
          {"direction", direction},
          {"orientation", orientation_code(grid)}};
}

json report_head(const std::string& format, const RunRecord& record, int exit_code) {
  json report;
  report["format"] = format;
  report["version"] = 1;
  json libraries = json::object();
  for (const auto& [name, version] : library_versions()) libraries[name] = version;
  report["program"] = {{"name", "pellicle"}, {"version", program_version()}, {"libraries", libraries}};
  report["command_line"] = record.command_line;
  report["finished"] = utc_time();
  report["exit_code"] = exit_code;
  return report;
}

json inputs_json(const std::vector<InputFile>& files) {
  json inputs = json::array();
  for (const auto& file : files) {
    inputs.push_back({{"role", file.role}, {"path", file.path.string()}, {"sha256", file.sha256}});
  }
  return inputs;
}

json outputs_json(const std::vector<OutputFile>& files) {
  json outputs = json::array();
  for (const auto& file : files) {
    outputs.push_back(
        {{"kind", file.kind}, {"path", file.path.string()}, {"sha256", file.sha256}, {"bytes", file.bytes}});
  }
  return outputs;
}

void add_cost(const PhaseSeconds& seconds, json& report) {
  double total = 0.0;
  json phases = json::object();
  for (const auto& [phase, time] : seconds) {
    phases[phase] = time;
    total += time;
  }
  phases["total"] = total;
  report["seconds"] = phases;
  report["peak_memory_bytes"] = peak_memory_bytes();
}

}  // namespace pellicle
