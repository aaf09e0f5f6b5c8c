#include "hosts/boutiques_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "flag_text.h"
#include "pellicle/output/provenance.h"

namespace pellicle {

namespace {

using Json = nlohmann::ordered_json;

bool has_place_in_boutiques(const SettingKey& key) {
  static const std::vector<std::string> out{"dry-run",      "quiet",       "log-json",   "no-progress",
                                            "progress-xml", "output-mask", "output-mesh"};
  return std::find(out.begin(), out.end(), key.name) == out.end();
}

std::string underscored(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::string value_key(const std::string& name) {
  std::string key = underscored(name);
  std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::toupper(c); });
  return "[" + key + "]";
}

bool is_file(const SettingKey& key) {
  static const std::vector<std::string> files{"input", "seeds", "seed-model", "points"};
  return std::find(files.begin(), files.end(), key.name) != files.end();
}

Json input_of(const SettingEntry& entry) {
  const SettingKey& key = *entry.key;
  const std::string flag = "--" + key.name;
  const bool on_by_default = key.kind == SettingKind::flag && entry.values.at(0) == "true";
  const bool switchable = key.kind == SettingKind::flag && !on_by_default;
  Json input;
  input["id"] = underscored(key.name);
  input["name"] = key.name;
  input["description"] = cli::with_flags(key.help);
  input["value-key"] = value_key(key.name);
  input["type"] = switchable ? "Flag" : key.kind == SettingKind::number ? "Number" : is_file(key) ? "File" : "String";
  input["command-line-flag"] = flag;
  if (!switchable) input["command-line-flag-separator"] = "=";
  input["optional"] = key.name != "input" && key.name != "output" && key.name != "name";
  if (key.kind == SettingKind::number && key.whole) input["integer"] = true;
  if (key.kind == SettingKind::vectors || key.kind == SettingKind::table) {
    input["list"] = true;
    input["list-separator"] = fmt::format(" {}=", flag);  // the flag once for each value
  }
  if (on_by_default) input["value-choices"] = {"true", "false"};
  if (const auto words = key.choices(); !words.empty()) input["value-choices"] = words;
  return input;
}

Json output_of(const char* id, const char* name, const char* file, bool several) {
  Json output{{"id", id}, {"name", name}, {"path-template", fmt::format("[OUTPUT]/[NAME]_{}", file)}};
  output["optional"] = true;
  if (several) output["list"] = true;
  return output;
}

Json error_codes() {
  Json codes = Json::array();
  for (const auto& [code, text] : std::vector<std::pair<int, std::string>>{
           {1, "failure"},
           {3, "done, but an object failed its own checks; the files are there, the status says why"},
           {64, "wrong usage"},
           {65, "bad data"},
           {66, "no such input"},
           {73, "cannot create output"},
           {74, "input/output error"},
           {130, "interrupted"}}) {
    codes.push_back({{"code", code}, {"description", text}});
  }
  return codes;
}

}  // namespace

Json boutiques_description(const std::vector<SettingEntry>& settings) {
  Json tool;
  tool["name"] = "pellicle segment";
  tool["tool-version"] = program_version();
  tool["schema-version"] = "0.5";
  tool["description"] =
      "Wraps a smooth closed surface around one object, or around every one of many, in a 3D biomedical image";
  tool["author"] = "The Pellicle authors";
  std::string command = "pellicle segment";
  Json inputs = Json::array(), seeds = Json::array();
  for (const SettingEntry& entry : settings) {
    const SettingKey& key = *entry.key;
    if (!has_place_in_boutiques(key)) continue;
    command += " " + value_key(key.name);
    inputs.push_back(input_of(entry));
    const bool other_seed = key.name == "seed-mask" || key.name == "seed-model" || key.name == "seed-auto";
    if (other_seed) seeds.push_back(underscored(key.name));
  }
  tool["command-line"] = command;
  tool["inputs"] = inputs;
  tool["groups"] = Json::array({{{"id", "other_seeds"},
                                 {"name", "Seeds that are no spheres"},
                                 {"members", seeds},
                                 {"mutually-exclusive", true}}});
  tool["output-files"] = Json::array({output_of("mask_file", "Mask of one object", "mask.nii.gz", false),
                                      output_of("label_map_file", "Label map of several objects", "dseg.nii.gz", false),
                                      output_of("label_table_file", "Table of several objects", "dseg.tsv", false),
                                      output_of("mesh_files", "Meshes", "surface*", true),
                                      output_of("model_files", "Models", "model*.json", true),
                                      output_of("report_file", "Report", "report.json", false),
                                      output_of("picture_file", "Picture", "qc.png", false)});
  tool["error-codes"] = error_codes();
  tool["suggested-resources"] = {{"cpu-cores", 2}, {"ram", 4}, {"walltime-estimate", 60}};
  tool["tags"] = {{"domain", {"neuroinformatics", "bioinformatics"}}, {"purpose", "segmentation"}};
  return tool;
}

}  // namespace pellicle
