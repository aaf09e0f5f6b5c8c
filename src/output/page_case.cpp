#include "pellicle/output/page_case.h"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/output/viewer_files.h"
#include "pellicle/picture/slice_rows.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

namespace {

constexpr int panel_size = 240, panel_gap = 2;

std::string bytes_in(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

std::string gzip_of(const std::string& bytes) {
  z_stream stream{};
  constexpr int gzip = 16 + MAX_WBITS;
  if (deflateInit2(&stream, 9, Z_DEFLATED, gzip, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw IoError("compression failed (zlib)");
  std::string packed(deflateBound(&stream, bytes.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // NOLINT: zlib does not write there
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());  // NOLINT
  stream.avail_out = static_cast<uInt>(packed.size());
  const int outcome = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (outcome != Z_STREAM_END) throw IoError("compression failed (zlib)");
  return packed;
}

json read_report(const fs::path& path) {
  std::ifstream in(path);
  if (!in) throw NoInput(fmt::format("no such file ({}): the report cannot be opened; check the path", path.string()));
  json report = json::parse(in, nullptr, false);
  if (!report.is_object() || report.value("format", "") != "pellicle-report" || !report.contains("objects")) {
    throw BadData(fmt::format("not a report ({}): it is not what 'pellicle segment' writes; name a *_report.json",
                              path.string()));
  }
  return report;
}

// Results may have been moved as a whole since.
std::optional<fs::path> output_path(const fs::path& report, const std::string& recorded) {
  std::error_code ignored;
  for (const fs::path& path : {report.parent_path() / fs::path(recorded).filename(), fs::path(recorded)}) {
    if (fs::exists(path, ignored)) return path;
  }
  return std::nullopt;
}

std::optional<fs::path> input_path(const fs::path& report, const std::string& recorded) {
  std::error_code ignored;
  const fs::path folder = report.parent_path();
  for (const fs::path& path : {fs::path(recorded), folder / recorded, folder / fs::path(recorded).filename()}) {
    if (!recorded.empty() && fs::exists(path, ignored)) return path;
  }
  return std::nullopt;
}

std::vector<Surface> surfaces_of(const json& report, const fs::path& path) {
  std::vector<Surface> surfaces;
  for (const auto& file : report.at("outputs")) {
    if (file.value("kind", "") != "model") continue;
    const auto found = output_path(path, file.value("path", ""));
    if (!found) return {};
    surfaces.push_back(read_model(*found));
  }
  return surfaces;
}

// Without models the written meshes have to do, as fine as they are.
std::vector<TriangleMesh> meshes_of(const json& report, const fs::path& path, std::size_t most_triangles) {
  const std::vector<Surface> surfaces = surfaces_of(report, path);
  if (!surfaces.empty()) return viewing_meshes(surfaces, most_triangles);
  std::vector<TriangleMesh> meshes;
  for (const auto& file : report.at("outputs")) {
    if (file.value("kind", "") != "mesh") continue;
    if (const auto found = output_path(path, file.value("path", ""))) meshes.push_back(read_mesh(*found));
  }
  return meshes;
}

struct FoundVolume {
  std::optional<Image<float>> image;
  std::string note;  ///< why there is none
};

FoundVolume volume_of(const json& report, const fs::path& path) {
  if (!report.contains("inputs") || report.at("inputs").empty()) return {{}, "The report names no volume."};
  const json& input = report.at("inputs").front();
  const auto found = input_path(path, input.value("path", ""));
  if (!found) return {{}, "The volume was not found when the page was made."};
  if (sha256_of(*found) != input.value("sha256", "")) return {{}, "The volume has changed since it was segmented."};
  ReadOptions options;
  if (const json& s = report.at("settings"); s.contains("spacing") && s.at("spacing").is_array()) {
    options.spacing = Vec3(s.at("spacing").at(0).get<double>(), s.at("spacing").at(1).get<double>(),
                           s.at("spacing").at(2).get<double>());
  }
  if (report.at("input").contains("frame")) options.frame = report.at("input").at("frame").at("index").get<int>();
  return {in_lps_order(read_volume(*found, options).image), ""};
}

TriangleMesh joined(const std::vector<TriangleMesh>& meshes) {
  TriangleMesh all;
  for (const auto& mesh : meshes) append(all, mesh);
  return all;
}

// Three slices and a shaded view in a row.
Canvas strip_of(const Image<float>* image, const TriangleMesh& mesh) {
  const Window window = image != nullptr ? robust_window(*image) : Window{};
  const std::vector<Canvas> panels = views_of(image, window, {.title = {}, .mesh = mesh}, panel_size);
  Canvas strip(4 * (panel_size + panel_gap) - panel_gap, panel_size, {12, 13, 16});
  for (std::size_t p = 0; p < panels.size(); ++p)
    paste(strip, panels[p], static_cast<int>(p) * (panel_size + panel_gap), 0);
  return strip;
}

json object_facts(const json& object, std::size_t index) {
  const json& fit = object.at("fit");
  json facts;
  for (const char* key : {"label", "name", "status", "reason", "area_mm2", "watertight", "genus", "self_intersections",
                          "touches_border"}) {
    facts[key] = object.at(key);
  }
  facts["volume_ml"] = object.at("volume_ml").at("surface");
  facts["mask_ml"] = object.at("volume_ml").at("mask");
  facts["model"] = object.at("model").at("name");
  facts["control_points"] = object.at("model").at("control_points");
  for (const char* key :
       {"polarity", "boundary", "level_inside", "level_outside", "iterations", "convergence", "stages", "hypotheses"}) {
    facts[key] = fit.at(key);
  }
  facts["evidence"] = fit.at("evidence").at("score");
  facts["color"] = object_color(index);
  return facts;
}

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_of(" \t\n\"'\\$*?[]();&|<>`!#~") == std::string::npos;
  if (plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

json provenance_of(const json& report, const fs::path& path) {
  json facts;
  facts["finished"] = report.at("finished");
  facts["program"] = fmt::format("{} {}", report.at("program").at("name").get<std::string>(),
                                 report.at("program").at("version").get<std::string>());
  facts["libraries"] = report.at("program").at("libraries");
  std::string command;
  for (const auto& word : report.at("command_line"))
    command += (command.empty() ? "" : " ") + shell_word(word.get<std::string>());
  facts["command"] = command;
  facts["report"] = path.string();
  facts["inputs"] = report.at("inputs");
  facts["outputs"] = report.at("outputs");
  const json& grid = report.at("input").at("grid");
  facts["grid"] = fmt::format(
      "{} x {} x {} voxels of {:.4g} x {:.4g} x {:.4g} mm, {}, {}", grid.at("size").at(0).get<int>(),
      grid.at("size").at(1).get<int>(), grid.at("size").at(2).get<int>(), grid.at("spacing_mm").at(0).get<double>(),
      grid.at("spacing_mm").at(1).get<double>(), grid.at("spacing_mm").at(2).get<double>(),
      grid.at("orientation").get<std::string>(), report.at("input").at("format").get<std::string>());
  std::string seconds;
  for (const auto& [phase, time] : report.at("seconds").items())
    seconds += fmt::format("{}{} {:.2f} s", seconds.empty() ? "" : ", ", phase, time.get<double>());
  facts["seconds"] = seconds;
  facts["memory"] = fmt::format("{:.0f} MB", report.at("peak_memory_bytes").get<double>() / 1e6);
  return facts;
}

void add_report(const json& report, const fs::path& path, json& facts) {
  std::string status = "ok", reason;
  double volume = 0.0;
  json objects = json::array(), evidence = nullptr;
  for (const auto& object : report.at("objects")) {
    const auto own = object.at("status").get<std::string>();
    if ((status == "ok" && own != "ok") || reason.empty()) {
      status = own;
      reason = object.at("reason").get<std::string>();
    }
    const json& score = object.at("fit").at("evidence").at("score");
    if (score.is_number() && (evidence.is_null() || score < evidence)) evidence = score;
    if (object.at("volume_ml").at("surface").is_number()) volume += object.at("volume_ml").at("surface").get<double>();
    objects.push_back(object_facts(object, objects.size()));
  }
  facts["status"] = status;
  facts["reason"] = reason;
  facts["volume_ml"] = volume;
  facts["evidence"] = evidence;
  facts["seconds"] = report.at("seconds").at("total");
  facts["objects"] = objects;
  facts["settings"] = report.at("settings");
  facts["provenance"] = provenance_of(report, path);
  facts["warnings"] = report.at("warnings");
}

Vec3 middle_of(const TriangleMesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const auto& vertex : mesh.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return 0.5 * (low + high);
}

std::string packed_volume(const Image<std::uint8_t>& image, const fs::path& scratch) {
  VolumeHeader header;
  header.grid = image.grid;
  const fs::path path = scratch / "volume.nii.gz";
  write_volume(path, image, header);
  return bytes_in(path);
}

void add_pictures(const json& report, const fs::path& path, const PageLimits& limits, bool viewer,
                  const fs::path& scratch, PageParts& parts) {
  const std::vector<TriangleMesh> meshes = meshes_of(report, path, limits.most_triangles);
  FoundVolume volume;
  try {
    volume = volume_of(report, path);
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& fault) {
    volume.note = fault.what();
  }
  const TriangleMesh all = joined(meshes);
  if (!all.vertices.empty()) {
    write_png(scratch / "strip.png", strip_of(volume.image ? &*volume.image : nullptr, all));
    parts.facts["picture"] = "data:image/png;base64," + base64_of(bytes_in(scratch / "strip.png"));
  }
  parts.facts["volume_note"] = volume.note;
  if (!viewer || all.vertices.empty()) return;
  std::vector<Rgb> colors;
  colors.reserve(meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) colors.push_back(object_color(i));
  parts.mesh = gzip_of(mz3_of(meshes, colors));
  const Vec3 center = flip_lps_ras(middle_of(meshes.front()));
  parts.facts["center"] = {center[0], center[1], center[2]};
  if (!volume.image) return;
  const Image<std::uint8_t> small = cut_out(*volume.image, meshes, limits.edge);
  parts.volume = packed_volume(small, scratch);
  const ImageGrid& grid = small.grid;
  parts.facts["note"] =
      fmt::format("Cut out for this page: {} x {} x {} voxels of {:.3g} x {:.3g} x {:.3g} mm, 8 bit", grid.size[0],
                  grid.size[1], grid.size[2], grid.spacing[0], grid.spacing[1], grid.spacing[2]);
}

}  // namespace

std::string base64_of(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),         // NOLINT
                                     reinterpret_cast<const unsigned char*>(bytes.data()),  // NOLINT
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

PageParts page_parts(const PageCase& one, const PageLimits& limits, bool viewer, const fs::path& scratch) {
  PageParts parts;
  parts.facts = {{"name", one.name}, {"status", "pending"}, {"reason", ""}, {"objects", json::array()}};
  if (one.outcome) {
    parts.facts["status"] = one.outcome->status;
    parts.facts["reason"] = one.outcome->message;
    parts.facts["seconds"] = one.outcome->seconds ? json(*one.outcome->seconds) : json(nullptr);
  }
  if (!one.report || (one.outcome && !one.outcome->done))
    return parts;  // a report beside a failed case is an older one
  try {
    const json report = read_report(*one.report);
    add_report(report, *one.report, parts.facts);
    add_pictures(report, *one.report, limits, viewer, scratch, parts);
  } catch (const json::exception& fault) {
    throw BadData(fmt::format("not a whole report ({}): {}; write it anew", one.report->string(), fault.what()));
  }
  return parts;
}

}  // namespace pellicle
