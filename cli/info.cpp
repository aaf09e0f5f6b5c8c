#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "command_flags.h"
#include "command_settings.h"
#include "commands.h"
#include "flag_text.h"
#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/output/report_json.h"
#include "pellicle/surface/model_file.h"

namespace pellicle::cli {
namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

namespace {

json volume_info(const InfoSettings& settings, Console& console) {
  ReadOptions options;
  if (settings.spacing) options.spacing = Vec3((*settings.spacing)[0], (*settings.spacing)[1], (*settings.spacing)[2]);
  options.frame = 0;
  const Volume volume = read_volume(settings.file, options);
  json out = json_of(volume.header.grid);
  out["format"] = volume.header.format;
  out["component_type"] = volume.header.component_type;
  out["unit"] = volume.header.unit;
  out["spacing_known"] = volume.header.spacing_known;
  if (volume.header.frames > 1) {
    out["frames"] = volume.header.frames;
    out["frame_step"] = volume.header.frame_step;
    out["frame_unit"] = volume.header.frame_unit;
  }
  out["slope"] = volume.header.slope;
  out["intercept"] = volume.header.intercept;
  out["min"] = volume.min;
  out["max"] = volume.max;
  out["nan_count"] = volume.nan_count;
  out["inf_count"] = volume.inf_count;
  out["warnings"] = json::array();
  for (const auto& warning : volume.header.warnings) out["warnings"].push_back(with_flags(warning));
  for (const auto& warning : volume.header.warnings)
    console.warn(fmt::format("{}: {}", settings.file.string(), warning));
  return out;
}

json mesh_info(const TriangleMesh& mesh) {
  const MeshTopology topology = topology_of(mesh);
  json out;
  out["vertices"] = mesh.vertices.size();
  out["triangles"] = mesh.triangles.size();
  out["area_mm2"] = area_of(mesh);
  const bool watertight = topology.closed && topology.manifold && topology.oriented;
  out["watertight"] = watertight;
  out["volume_ml"] = watertight ? json(volume_of(mesh) / 1000.0) : json(nullptr);
  out["components"] = topology.components;
  out["genus"] = watertight ? json(topology.genus) : json(nullptr);
  out["self_intersections"] = self_intersection_count(mesh);
  out["fault"] = topology.first_fault;
  return out;
}

json model_info(const fs::path& path) {
  const Surface surface = read_model(path);
  json out{{"format", "pellicle model"},
           {"model", model_name(surface.model)},
           {"control_points", control_point_count(surface.model)},
           {"degrees_of_freedom", degrees_of_freedom(surface.model)}};
  const json mesh = mesh_info(tessellate(surface, 4));
  for (const auto& [key, value] : mesh.items()) out[key] = value;
  return out;
}

std::string text_of(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.7g}", value.get<double>());
  if (value.is_null()) return "-";
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const auto& element : value) {
    const std::string cell = element.is_array() ? fmt::format("[{}]", text_of(element)) : text_of(element);
    text += (text.empty() ? "" : " ") + cell;
  }
  return text.empty() ? "-" : text;
}

int run_info(const InfoSettings& settings, Console& console) {
  std::error_code ignored;
  if (!fs::exists(settings.file, ignored)) {
    throw NoInput(fmt::format("no such file ({}): nothing is there; check the path", settings.file.string()));
  }
  std::string extension = settings.file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  static const std::set<std::string> meshes{".ply", ".stl", ".obj", ".off", ".vtp", ".gii"};
  json out{{"file", settings.file.string()}};
  const json content = meshes.count(extension) != 0 ? mesh_info(read_mesh(settings.file))
                       : extension == ".json"       ? model_info(settings.file)
                                                    : volume_info(settings, console);
  for (const auto& [key, value] : content.items()) out[key] = value;
  if (settings.json) {
    std::cout << out.dump(2) << "\n";
  } else {
    for (const auto& [key, value] : out.items()) std::cout << fmt::format("{:<20} {}\n", key, text_of(value));
  }
  return 0;
}

}  // namespace

Run add_info(CLI::App& app) {
  app.footer(
      "Positions are LPS mm; 'orientation' says where the index axes point: RAS is +i right, +j front, +k up.\n"
      "Example: pellicle info scan.nii.gz --json");
  return settings_command<InfoSettings>(app, info_table(), run_info);
}

}  // namespace pellicle::cli
