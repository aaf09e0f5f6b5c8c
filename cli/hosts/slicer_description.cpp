#include "hosts/slicer_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <sstream>

#include "flag_text.h"
#include "pellicle/output/provenance.h"
#include "pellicle/settings/presets.h"

namespace pellicle {

namespace {

using Node = pugi::xml_node;

void add_text(Node parent, const char* tag, const std::string& text) {
  parent.append_child(tag).text().set(text.c_str());
}

/// How a setting is shown when its kind does not say it all.
struct Shown {
  const char* name;
  const char* tag;         ///< of Slicer's parser
  const char* type;        ///< attribute `type`; empty: none
  const char* extensions;  ///< attribute `fileExtensions`
  const char* channel;     ///< input or output; empty: none
};

constexpr Shown shown_files[] = {{"input", "image", "scalar", "", "input"},
                                 {"output-mask", "image", "label", ".nii.gz", "output"},
                                 {"output-mesh", "geometry", "model", ".vtp", "output"},
                                 {"seed-mask", "image", "label", "", "input"},
                                 {"seeds", "file", "", ".csv", "input"},
                                 {"seed-model", "file", "", ".json", "input"},
                                 {"points", "file", "", ".csv,.ply,.xyz", "input"},
                                 {"trace", "directory", "", "", ""}};

// Settings that have no place in Slicer: it names its files itself, and starts what it wants to run.
bool is_left_out(const SettingEntry& entry) {
  const SettingKey& key = *entry.key;
  static const std::vector<std::string> names{
      "seed-sphere", "coords", "spacing", "output",       "name",  "write",       "mesh-format", "dry-run",
      "overwrite",   "quiet",  "verbose", "progress-xml", "trace", "trace-every", "log-json",    "no-progress"};
  // A flag that is on by default cannot be taken back: Slicer names a flag or does not.
  const bool on = key.kind == SettingKind::flag && entry.values.at(0) == "true";
  return on || std::find(names.begin(), names.end(), key.name) != names.end();
}

std::vector<std::string> choices_of(const SettingKey& key) {
  if (key.name != "preset") return key.choices();
  std::vector<std::string> words;
  for (const auto& preset : list_presets()) words.push_back(preset.name);
  return words;
}

// The parser's tag for a setting. Numbers are text: Slicer leaves out an empty text, but hands over every number.
const char* tag_of(const SettingKey& key) {
  switch (key.kind) {
    case SettingKind::flag:
      return "boolean";
    case SettingKind::vector:
      return "double-vector";
    case SettingKind::vectors:
      return "point";
    case SettingKind::number:
    case SettingKind::text:
    case SettingKind::words:
    case SettingKind::several:
    case SettingKind::table:
      break;
  }
  return choices_of(key).empty() ? "string" : "string-enumeration";
}

void add_setting(Node group, const SettingEntry& entry) {
  const SettingKey& key = *entry.key;
  const auto* known = std::find_if(std::begin(shown_files), std::end(shown_files),
                                   [&](const Shown& shown) { return key.name == shown.name; });
  const Shown* shown = known == std::end(shown_files) ? nullptr : known;
  const std::string seed_radius = "seed-radius";  // goes with the fiducials, no matter of presets
  const bool number = key.name == seed_radius;
  Node node = group.append_child(shown != nullptr ? shown->tag : number ? "double" : tag_of(key));
  if (shown != nullptr && *shown->type != '\0') node.append_attribute("type") = shown->type;
  if (shown != nullptr && *shown->extensions != '\0') node.append_attribute("fileExtensions") = shown->extensions;
  if (key.kind == SettingKind::vectors) {
    node.append_attribute("multiple") = "true";
    node.append_attribute("coordinateSystem") = "lps";
  }
  std::string flag = key.name, label = key.name;
  std::replace(flag.begin(), flag.end(), '-', '_');
  std::replace(label.begin(), label.end(), '-', ' ');
  label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
  add_text(node, "name", flag);
  add_text(node, "longflag", flag);
  const bool unit = key.kind != SettingKind::flag && !key.placeholder.empty() && shown == nullptr &&
                    choices_of(key).empty() && key.kind != SettingKind::vectors;
  add_text(node, "label", unit ? fmt::format("{} ({})", label, key.placeholder) : label);
  add_text(node, "description", cli::with_flags(key.help));
  if (shown != nullptr && *shown->channel != '\0') add_text(node, "channel", shown->channel);
  if (number) add_text(node, "default", entry.values.at(0));
  if (key.kind == SettingKind::flag) add_text(node, "default", "false");
  const auto choices = choices_of(key);
  if (choices.empty()) return;
  add_text(node, "default", "default");
  add_text(node, "element", "default");
  for (const auto& choice : choices) add_text(node, "element", choice);
}

const SettingEntry& setting_named(const std::vector<SettingEntry>& settings, const std::string& name) {
  return *std::find_if(settings.begin(), settings.end(),
                       [&](const SettingEntry& entry) { return entry.key->name == name; });
}

Node add_group(Node executable, const std::string& label, const std::string& description, bool advanced) {
  Node group = executable.append_child("parameters");
  if (advanced) group.append_attribute("advanced") = "true";
  add_text(group, "label", label);
  add_text(group, "description", description);
  return group;
}

}  // namespace

std::string slicer_description(const std::vector<SettingEntry>& settings) {
  pugi::xml_document document;
  Node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "utf-8";
  Node executable = document.append_child("executable");
  add_text(executable, "category", "Segmentation");
  add_text(executable, "title", "Pellicle");
  add_text(executable, "description",
           "Wraps a smooth closed surface, a few-parameter deformable surface, around one object or around every one "
           "of many, and gives its mask and its mesh.");
  add_text(executable, "version", program_version());
  add_text(executable, "documentation-url", "");  // ModuleDescription.xsd demands the element; it may be empty
  add_text(executable, "license", "Apache-2.0");
  add_text(executable, "contributor", "The Pellicle authors");

  const std::vector<std::string> first{"input",  "seed-point",  "seed-radius", "objects",
                                       "preset", "output-mask", "output-mesh"};
  Node main = add_group(executable, "Volume, seeds, results",
                        "A fiducial in the middle of the object; without any the object is found", false);
  for (const auto& name : first) add_setting(main, setting_named(settings, name));
  for (const std::string group : {"Seed", "Model", "Energies", "Outputs", "Run"}) {
    Node node;
    for (const SettingEntry& entry : settings) {
      if (entry.key->group != group || is_left_out(entry)) continue;
      if (std::find(first.begin(), first.end(), entry.key->name) != first.end()) continue;
      if (!node) node = add_group(executable, group, "Left empty or at 'default': the preset decides", true);
      add_setting(node, entry);
    }
  }
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

}  // namespace pellicle
