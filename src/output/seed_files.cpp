#include "pellicle/output/seed_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>

#include "pellicle/base/errors.h"
#include "pellicle/job/seeds.h"
#include "pellicle/mesh/files/point_file.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

Vec3 world_from_coords(const Vec3& x, Coords coords, const ImageGrid& grid) {
  switch (coords) {
    case Coords::lps:
      return x;
    case Coords::ras:
      return flip_lps_ras(x);
    case Coords::ijk:
      return grid.world_from_index(x);
  }
  return x;
}

MaskArgument parse_mask_argument(const std::string& argument) {
  const auto colon = argument.rfind(':');
  std::error_code ignored;
  if (colon != std::string::npos && !fs::exists(argument, ignored)) {
    int label = 0;
    const char* end = argument.data() + argument.size();
    const auto [rest, fault] = std::from_chars(argument.data() + colon + 1, end, label);
    if (fault == std::errc() && rest == end) return {argument.substr(0, colon), label};
  }
  return {argument, std::nullopt};
}

namespace {

std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  for (auto& cell : cells) {
    const auto first = cell.find_first_not_of(" \t");
    const auto last = cell.find_last_not_of(" \t");
    cell = first == std::string::npos ? "" : cell.substr(first, last - first + 1);
  }
  return cells;
}

SeedRow seed_row(const std::vector<std::string>& cells, const std::string& where) {
  if (cells.size() < 4) throw BadData(fmt::format("bad seed ({}): the columns are x,y,z,r[,label[,name]]", where));
  SeedRow row;
  try {
    for (std::size_t a = 0; a < 3; ++a) row.position[static_cast<int>(a)] = number_of(cells[a], where);
    row.radius = number_of(cells[3], where);
    if (cells.size() > 4 && !cells[4].empty()) row.label = integer_of(cells[4], where);
  } catch (const UsageError& fault) {
    throw BadData(fault.what());  // the value stands in a file, not on the command line
  }
  if (!(row.radius > 0.0)) throw BadData(fmt::format("bad seed ({}): the radius must be above 0 mm", where));
  if (row.label && (*row.label < 1 || *row.label > 65535)) {
    throw BadData(fmt::format("bad seed ({}): label {} is outside 1 to 65535", where, *row.label));
  }
  if (cells.size() > 5) row.name = cells[5];
  return row;
}

}  // namespace

std::vector<SeedRow> read_seed_table(const fs::path& path) {
  std::ifstream in(path);
  if (!in || fs::is_directory(path)) {
    throw NoInput(fmt::format("cannot open (`seeds` {}): no such file; check the path", path.string()));
  }
  std::vector<SeedRow> rows;
  std::string line;
  bool first = true;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto cells = csv_cells(line);
    if ((cells.size() == 1 && cells[0].empty()) || cells[0].rfind('#', 0) == 0) continue;
    const bool is_header = first && (cells[0] == "x" || cells[0] == "X");
    first = false;
    if (!is_header) rows.push_back(seed_row(cells, fmt::format("{}:{}", path.string(), number)));
  }
  if (rows.empty()) throw BadData(fmt::format("no seed ({}): the file holds no row x,y,z,r; add one", path.string()));
  return rows;
}

ExpertPoints read_expert_points(const SegmentSettings& settings, const ImageGrid& grid) {
  PointCloud cloud = read_points(*settings.points);
  ExpertPoints points{.points = std::move(cloud.points),
                      .weights = std::move(cloud.weights),
                      .held = settings.points_pull == PointsPull::point};
  bool inside = false;
  for (Vec3& x : points.points) {
    x = world_from_coords(x, settings.coords, grid);
    inside = inside || grid.contains(x);
  }
  if (!inside) {
    throw BadData(
        fmt::format("points outside the volume (`points` {}): none of the {} lies in it; check `coords` and "
                    "see the extent with 'pellicle info'",
                    settings.points->string(), points.points.size()));
  }
  return points;
}

void check_seed_files(const SegmentSettings& settings) {
  const auto need = [](const std::string& key, const fs::path& path) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) {
      throw NoInput(fmt::format("no such file (`{}` {}): nothing is there; check the path", key, path.string()));
    }
  };
  if (settings.seeds_file) need("seeds", *settings.seeds_file);
  if (settings.seed_model) need("seed-model", *settings.seed_model);
  if (settings.points) need("points", *settings.points);
  if (settings.seed_mask) need("seed-mask", parse_mask_argument(*settings.seed_mask).file);
}

namespace {

std::vector<ObjectSeed> seeds_from_spheres(const SegmentSettings& settings, const ImageGrid& grid) {
  std::vector<ObjectSeed> objects;
  const auto add = [&](const SeedRow& row) {
    ObjectSeed object;
    object.label = row.label.value_or(static_cast<int>(objects.size()) + 1);
    object.name = row.name;
    object.candidates = {SeedSphere{world_from_coords(row.position, settings.coords, grid), row.radius}};
    objects.push_back(std::move(object));
  };
  const auto place = [&](const SeedRow& row) {
    return fmt::format("at {},{},{} in {}", row.position[0], row.position[1], row.position[2],
                       name_of(settings.coords));
  };
  for (const auto& s : settings.all_seed_spheres()) {
    const SeedRow row{{s[0], s[1], s[2]}, s[3], {}, {}};
    add(row);
    if (!grid.contains(std::get<SeedSphere>(objects.back().candidates[0]).center)) {
      throw UsageError(
          fmt::format("seed outside the volume (seed {}): no voxel is there; check `coords` and "
                      "see the extent with 'pellicle info'",
                      place(row)));
    }
  }
  if (settings.seeds_file) {
    for (const auto& row : read_seed_table(*settings.seeds_file)) {
      add(row);
      if (!grid.contains(std::get<SeedSphere>(objects.back().candidates[0]).center)) {
        throw BadData(
            fmt::format("seed outside the volume ({}): {}; check `coords` and see the extent with 'pellicle info'",
                        settings.seeds_file->string(), place(row)));
      }
    }
  }
  return objects;
}

std::vector<ObjectSeed> seeds_from_mask(const SegmentSettings& settings) {
  const MaskArgument argument = parse_mask_argument(*settings.seed_mask);
  const LabelVolume volume = read_labels(argument.file);
  return seeds_of_labels(volume.labels, argument.label, settings.fit,
                         fmt::format("`seed-mask` {}", *settings.seed_mask));
}

ObjectSeed seed_found(const SegmentSettings& settings, const Image<float>& image) {
  ObjectSeed object = find_object(image, settings.fit);
  if (object.candidates.empty()) {
    throw BadData(
        fmt::format("nothing found ({}): the image shows no object; give a `seed-sphere`", settings.input.string()));
  }
  return object;
}

}  // namespace

std::vector<ObjectSeed> read_seeds(const SegmentSettings& settings, const ImageGrid& grid, const Image<float>& image) {
  std::vector<ObjectSeed> objects;
  const ExpertPoints points = settings.points ? read_expert_points(settings, grid) : ExpertPoints{};
  // Points all around the object say more than balls do. A few only say where it ends.
  const bool named =
      settings.seed_mask || settings.seed_model || settings.all_seed_spheres().size() > 1 || settings.seeds_file;
  const bool outlined = settings.points && !named && settings.fit.start_rule == StartRule::automatic;
  const auto from_points = outlined ? seed_of_points(points, image.grid, settings.fit) : std::nullopt;
  if (from_points) {
    objects = {{.candidates = {*from_points}}};
  } else if (!settings.all_seed_spheres().empty() || settings.seeds_file) {
    objects = seeds_from_spheres(settings, grid);
  } else if (settings.seed_mask) {
    objects = seeds_from_mask(settings);
  } else if (settings.seed_model) {
    objects = {{.candidates = {read_model(*settings.seed_model)}}};
  } else if (settings.wants_many()) {
    return {};  // found by the fit of many objects itself
  } else {
    objects = {seed_found(settings, image)};
  }
  if (objects.size() > 1 && settings.points) {
    throw SettingError("expert points of which object", "points", settings.points->string(),
                       fmt::format("there are {} objects; fit the one that they belong to alone", objects.size()));
  }
  if (settings.points) objects.front().points = points;
  return numbered(std::move(objects));
}

}  // namespace pellicle
