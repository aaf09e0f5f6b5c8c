#include "phantom_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_fields.h"

namespace pellicle {

namespace {

template <class E>
Words<E> named(std::initializer_list<E> values) {
  Words<E> words;
  for (const E value : values) words.emplace_back(value, name_of(value));
  return words;
}

}  // namespace

template <>
const Words<PhantomFill>& words_of() {
  static const Words<PhantomFill> all = named({PhantomFill::solid, PhantomFill::shell});
  return all;
}

template <>
const Words<PhantomNoise>& words_of() {
  static const Words<PhantomNoise> all =
      named({PhantomNoise::none, PhantomNoise::gaussian, PhantomNoise::rician, PhantomNoise::poisson});
  return all;
}

namespace cli {

namespace {

using P = PhantomCommand;

std::string shapes(const std::string& separator) {
  std::string names;
  for (const auto& shape : shape_names()) names += shape + separator;
  return names + "cluster";
}

template <class T>
std::size_t length_of(const T& value) {
  return value.size();
}
template <class T>
std::size_t length_of(const std::optional<T>& /*value*/) {
  return std::tuple_size_v<T>;
}

// A row of as many numbers as the field has; a single one stands for all of them.
template <class F>
Setting<P> numbers_row(const SettingKey& key, F field) {
  Setting<P> row = setting<P>(key, field);
  row.set = [field, key](P& p, const SettingValues& values) {
    auto& target = field(p);
    SettingValues all = values;
    if (all.size() == 1) all.resize(length_of(target), all.front());
    try {
      target = SettingValue<std::decay_t<decltype(target)>>::read(key, all);
    } catch (const SettingError& fault) {
      throw SettingError(fault.subject, fault.key, joined_by_commas(values), fault.why);
    }
  };
  return row;
}

void add_object_rows(SettingTable<P>& table) {
  table.push_back(setting<P>({"Object", "shape", shapes("|"), "the object; cluster: many ellipsoids and a label map"},
                             SETTING_FIELD(shape)));
  table.push_back(setting<P>({.group = "Object",
                              .name = "radius",
                              .placeholder = "MM",
                              .help = "mm: one scale, three half axes A,B,C, MAJOR,MINOR of a torus, or MIN,MAX of a "
                                      "cluster (default 5,8)",
                              .standard = "20"},
                             SETTING_FIELD(radius)));
  table.push_back(numbers_row({.group = "Object",
                               .name = "center",
                               .placeholder = "X,Y,Z",
                               .help = "of the object, LPS mm; the volume's centre is 0,0,0",
                               .standard = "0,0,0"},
                              SETTING_FIELD(center)));
  table.push_back(setting<P>({.group = "Object",
                              .name = "amplitude",
                              .placeholder = "A",
                              .help = "of a blob: largest relative deviation from the ball",
                              .standard = "0.35"},
                             SETTING_FIELD(amplitude)));
  table.push_back(setting<P>({.group = "Object",
                              .name = "fill",
                              .placeholder = "solid|shell",
                              .help = "solid object or membrane",
                              .standard = "solid"},
                             SETTING_FIELD(fill)));
  table.push_back(setting<P>({.group = "Object",
                              .name = "shell-thickness",
                              .placeholder = "MM",
                              .help = "of the membrane, mm; 0: three voxels",
                              .standard = "0"},
                             SETTING_FIELD(shell_thickness)));
}

void add_cluster_rows(SettingTable<P>& table) {
  table.push_back(setting<P>(
      {.group = "Cluster", .name = "count", .placeholder = "N", .help = "number of objects", .standard = "40"},
      SETTING_FIELD(count)));
  table.push_back(setting<P>({.group = "Cluster",
                              .name = "distance",
                              .placeholder = "D",
                              .help = "centres are at least D (r + r') apart; below 1 objects overlap",
                              .standard = "1"},
                             SETTING_FIELD(distance)));
  table.push_back(setting<P>({.group = "Cluster",
                              .name = "elongation",
                              .placeholder = "E",
                              .help = "largest ratio of an object's half axes, 1 to 10",
                              .standard = "1.3"},
                             SETTING_FIELD(elongation)));
  table.push_back(numbers_row({.group = "Cluster",
                               .name = "contrast-range",
                               .placeholder = "MIN,MAX",
                               .help = "contrast of an object, relative to that of `contrast`",
                               .standard = "1,1"},
                              SETTING_FIELD(contrast_range)));
}

void add_image_rows(SettingTable<P>& table) {
  table.push_back(numbers_row({"Image", "size", "NX,NY,NZ", "voxels"}, SETTING_FIELD(size)));
  table.push_back(numbers_row({"Image", "spacing", "SX,SY,SZ", "mm"}, SETTING_FIELD(spacing)));
  table.push_back(numbers_row({"Image", "direction", "RX,RY,RZ", "turns the grid about x, then y, then z, degrees"},
                              SETTING_FIELD(direction)));
  table.push_back(setting<P>({"Image", "contrast", "INSIDE,OUTSIDE", "intensities"}, SETTING_FIELD(contrast)));
  table.push_back(
      setting<P>({"Image", "blur", "MM", "standard deviation of the point spread, mm"}, SETTING_FIELD(blur_mm)));
  table.push_back(
      setting<P>({"Image", "noise", "none|gaussian|rician|poisson", "kind of noise"}, SETTING_FIELD(noise)));
  table.push_back(
      setting<P>({"Image", "snr", "S", "contrast over the standard deviation of the noise"}, SETTING_FIELD(snr)));
  table.push_back(setting<P>({"Image", "bias", "B", "smooth field from 1-B to 1+B over the volume, B in [0, 1)"},
                             SETTING_FIELD(bias)));
}

// Keys that were given and go with the other kind of phantom.
std::vector<std::string> useless_keys(const P& p) {
  const auto given = [](const std::vector<std::pair<const char*, bool>>& all) {
    std::vector<std::string> keys;
    for (const auto& [key, is_given] : all) {
      if (is_given) keys.emplace_back(key);
    }
    return keys;
  };
  if (p.is_cluster()) {
    return given({{"center", p.center.has_value()},
                  {"amplitude", p.amplitude.has_value()},
                  {"fill", p.fill.has_value()},
                  {"shell-thickness", p.shell_thickness.has_value()},
                  {"seeds", p.seeds.has_value()}});
  }
  return given({{"count", p.count.has_value()},
                {"distance", p.distance.has_value()},
                {"elongation", p.elongation.has_value()},
                {"contrast-range", p.contrast_range.has_value()}});
}

// What all phantoms have: grid, intensities, degradations.
PhantomSettings image_of(const P& p) {
  PhantomSettings settings;
  std::copy(p.size.begin(), p.size.end(), settings.size.begin());
  settings.spacing = {p.spacing[0], p.spacing[1], p.spacing[2]};
  settings.direction_degrees = {p.direction[0], p.direction[1], p.direction[2]};
  settings.inside = p.contrast[0];
  settings.outside = p.contrast[1];
  settings.blur_mm = p.blur_mm;
  settings.noise = p.noise;
  settings.snr = p.snr;
  settings.bias = p.bias;
  settings.seed = p.seed;
  return settings;
}

}  // namespace

const SettingTable<PhantomCommand>& phantom_table() {
  static const SettingTable<P> all = [] {
    SettingTable<P> table;
    table.push_back(setting<P>({.group = "Outputs",
                                .name = "output",
                                .placeholder = "DIR",
                                .help = "output folder, created if missing",
                                .short_flag = "-o",
                                .required = true},
                               SETTING_FIELD(output)));
    table.push_back(
        setting<P>({.group = "Outputs", .name = "name", .placeholder = "STEM", .help = "file stem", .required = true},
                   SETTING_FIELD(name)));
    table.push_back(setting<P>({"Outputs", "overwrite", "", "replace files that exist"}, SETTING_FIELD(overwrite)));
    add_object_rows(table);
    add_cluster_rows(table);
    add_image_rows(table);
    table.push_back(setting<P>({"Random", "seed", "INT", "of the random numbers"}, SETTING_FIELD(seed)));
    table.push_back(setting<P>({.group = "Random",
                                .name = "seeds",
                                .placeholder = "N",
                                .help = "start spheres that are drawn for the truth file",
                                .standard = "8"},
                               SETTING_FIELD(seeds)));
    table.push_back(setting<P>({"Run", "threads", "N", "threads; 0: all"}, SETTING_FIELD(threads)));
    return table;
  }();
  return all;
}

PhantomSettings PhantomCommand::phantom() const {
  PhantomSettings settings = image_of(*this);
  settings.shape = shape;
  if (radius) settings.radius = *radius;
  if (center) settings.center = {(*center)[0], (*center)[1], (*center)[2]};
  if (amplitude) settings.blob_amplitude = *amplitude;
  if (fill) settings.fill = *fill;
  if (shell_thickness) settings.shell_thickness_mm = *shell_thickness;
  return settings;
}

ClusterSettings PhantomCommand::cluster() const {
  ClusterSettings settings;
  settings.image = image_of(*this);
  if (radius) {
    settings.radius_min = radius->front();
    settings.radius_max = radius->back();
  }
  if (count) settings.count = *count;
  if (distance) settings.distance = *distance;
  if (elongation) settings.elongation = *elongation;
  if (contrast_range) {
    settings.contrast_min = (*contrast_range)[0];
    settings.contrast_max = (*contrast_range)[1];
  }
  return settings;
}

void PhantomCommand::validate() const {
  const auto& names = shape_names();
  if (!is_cluster() && std::find(names.begin(), names.end(), shape) == names.end()) {
    throw SettingError("unknown shape", "shape", shape, fmt::format("choose one of {}", shapes(", ")));
  }
  if (const auto keys = useless_keys(*this); !keys.empty()) {
    throw SettingError("setting does not apply", keys.front(),
                       fmt::format("`shape` {} has no use for it; leave it out", shape));
  }
  if (seeds && *seeds < 0) refuse_setting("seeds", fmt::format("{}", *seeds), "must be 0 or more");
  if (threads < 0) refuse_setting("threads", fmt::format("{}", threads), "must be 0 or more");
  if (name.find('/') != std::string::npos) refuse_setting("name", name, "must be a file stem without folders");
  if (is_cluster() && radius && radius->size() > 2) {
    refuse_setting("radius", fmt::format("{}", fmt::join(*radius, ",")), "MIN,MAX are needed, or one number");
  }
  if (is_cluster()) {
    cluster().validate();
  } else {
    phantom().validate();
  }
}

}  // namespace cli
}  // namespace pellicle
