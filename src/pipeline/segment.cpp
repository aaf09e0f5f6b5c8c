#include "pellicle/pipeline/segment.h"
#include "pellicle/image/reorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/pipeline/convergence_picture.h"
#include "pellicle/pipeline/outputs.h"
#include "pellicle/pipeline/provenance.h"
#include "pellicle/pipeline/qc_picture.h"
#include "pellicle/pipeline/report.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/pipeline/segment_many.h"
#include "pellicle/pipeline/trace.h"
#include "pellicle/pipeline/voxels.h"
#include "pellicle/raster/joint_labels.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

void measure_surface(const TriangleMesh& fine, ObjectResult& object) {
  object.volume_surface_ml = volume_with_normals(fine) / 1000.0;
  object.area_mm2 = area_of(fine);
  object.topology = topology_of(object.mesh);
  object.self_intersections = self_intersection_count(object.mesh);
  if (object.self_intersections > 0 && object.fit.status == FitStatus::ok) {
    object.fit.status = FitStatus::folded;
    object.fit.reason = fmt::format("the surface cuts itself: {} pairs of facets", object.self_intersections);
  }
}

namespace {

// More facets than this add nothing: on a ball of radius R the chords of 100,000 miss the surface by 4e-5 R.
constexpr int facet_limit = 120000;

int mesh_level(const SegmentSettings& settings, const Surface& surface, const ImageGrid& grid) {
  if (settings.mesh_density) return *settings.mesh_density;
  int level = tessellation_level(surface, 0.5 * grid.mean_spacing());
  const int control_facets = base_facets(surface.model);
  while (level > 2 && (control_facets << (2 * level)) > facet_limit) --level;
  return std::max(2, level);
}

void measure(ObjectResult& object, const SegmentSettings& settings, const ImageGrid& grid) {
  object.mesh_level = mesh_level(settings, object.surface, grid);
  object.mesh = tessellate(object.surface, object.mesh_level);
  for (const auto& vertex : object.mesh.vertices) {
    if (!vertex.allFinite()) throw Error(1, "fit failed (object): the surface is not finite; please report this");
  }
  turn_outward(object.mesh);  // a surface that was turned inside out keeps its status
  // Coarse meshes that the user asked for still get the volume of the smooth surface.
  const int dense = std::max(object.mesh_level, 4);
  TriangleMesh refined;
  if (dense != object.mesh_level) {
    refined = tessellate(object.surface, dense);
    turn_outward(refined);
  }
  const TriangleMesh& fine = refined.vertices.empty() ? object.mesh : refined;
  measure_surface(fine, object);
}

/// What all objects together look like on the input's grid. Maps that nobody asked for stay empty.
struct Maps {
  Image<std::uint16_t> labels;
  Image<float> distance, fraction;
};

Maps empty_maps(const SegmentSettings& settings, const ImageGrid& grid) {
  Maps maps;
  if (!settings.wants_many()) maps.labels = Image<std::uint16_t>(grid);
  if (settings.writes("prob")) maps.fraction = Image<float>(grid);
  if (settings.writes("sdf")) maps.distance = Image<float>(grid, std::numeric_limits<float>::max());
  return maps;
}

void add_to_maps(ObjectResult& object, const SegmentSettings& settings, Maps& maps) {
  const ImageGrid& grid = maps.labels.grid;
  const Box box = box_around(object.mesh, grid, 2);
  if (!box.empty()) {
    const MaskResult raster = rasterize_mask_checked(object.mesh, box.grid);
    const Image<std::uint8_t>& mask = raster.mask;
    if (raster.openvdb_volume_mm3) object.volume_openvdb_ml = *raster.openvdb_volume_mm3 / 1000.0;
    object.volume_mesh_ml = raster.mesh_volume_mm3 / 1000.0;
    std::size_t count = 0;
    for_each_voxel(box, grid, [&](std::size_t outer, std::size_t inner, bool border) {
      if (mask.voxels[inner] == 0) return;
      ++count;
      object.touches_border = object.touches_border || border;
      maps.labels.voxels[outer] = static_cast<std::uint16_t>(object.label);
    });
    object.volume_mask_ml = static_cast<double>(count) * grid.voxel_volume() / 1000.0;
    const Image<float> fraction = rasterize_partial_volume(object.mesh, box.grid);
    double sum = 0.0;
    for (const float f : fraction.voxels) sum += static_cast<double>(f);
    object.volume_partial_ml = sum * grid.voxel_volume() / 1000.0;
    if (settings.writes("prob")) {
      for_each_voxel(box, grid, [&](std::size_t outer, std::size_t inner, bool) {
        maps.fraction.voxels[outer] = std::min(1.0F, maps.fraction.voxels[outer] + fraction.voxels[inner]);
      });
    }
  }
  if (settings.writes("sdf")) {
    const Image<float> distance = signed_distance(object.surface, object.mesh, grid);
    for (std::size_t i = 0; i < distance.voxels.size(); ++i) {
      maps.distance.voxels[i] = std::min(maps.distance.voxels[i], distance.voxels[i]);
    }
  }
}

// Voxels inside several surfaces go to the one in which they are deepest for its size.
void share_out(std::vector<ObjectResult>& objects, Maps& maps) {
  if (objects.size() < 2) return;
  std::vector<const TriangleMesh*> meshes;
  std::vector<std::uint16_t> labels;
  for (const auto& object : objects) {
    meshes.push_back(&object.mesh);
    labels.push_back(static_cast<std::uint16_t>(object.label));
  }
  JointLabels joint = label_together(meshes, labels, maps.labels.grid);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i].volume_mask_ml = static_cast<double>(joint.voxels[i]) * maps.labels.grid.voxel_volume() / 1000.0;
    objects[i].overlap_voxels = joint.shared[i];
  }
  maps.labels = std::move(joint.labels);
}

// Two seeds in one object give two surfaces of it. Sharing out its voxels would hide that.
void tell_overlaps(const RunContext& context, SegmentResult& result) {
  for (auto& object : result.objects) {
    const double own = object.volume_mask_ml * 1000.0 / result.header.grid.voxel_volume();
    const auto shared = static_cast<double>(object.overlap_voxels);
    // What was claimed: the voxels that it kept, and at most all of the shared ones beside them.
    if (!(shared > 0.05 * std::max(own, shared))) continue;
    const std::string message =
        fmt::format("{}: other objects claim {} of its voxels too; each went to the surface in which it is deepest",
                    object.name, object.overlap_voxels);
    result.warnings.push_back(message);
    if (context.warn) context.warn(message);
    if (shared > own && object.fit.status == FitStatus::ok) {
      object.fit.status = FitStatus::ambiguous;
      object.fit.reason = "most of it is claimed by other objects too: do two seeds lie in one object?";
    }
  }
}

std::string label_table(const std::vector<ObjectResult>& objects) {
  if (objects.empty() || objects.front().shape) return many_table(objects);
  std::string text = "index\tname\tvolume_ml\tstatus\n";
  for (const auto& object : objects) {
    text += fmt::format("{}\t{}\t{:.6g}\t{}\n", object.label, object.name, object.volume_mask_ml,
                        to_string(object.fit.status));
  }
  return text;
}

// 0/1 of one object, labels of several.
void write_mask(const fs::path& path, const SegmentResult& result, const Maps& maps) {
  if (result.writes_labels()) {
    write_volume(path, maps.labels, result.header);
    return;
  }
  Image<std::uint8_t> mask(maps.labels.grid);
  std::transform(maps.labels.voxels.begin(), maps.labels.voxels.end(), mask.voxels.begin(),
                 [](std::uint16_t label) { return static_cast<std::uint8_t>(label != 0 ? 1 : 0); });
  write_volume(path, mask, result.header);
}

void write_maps(const SegmentResult& result, const std::vector<PlannedFile>& plan, const Maps& maps) {
  const SegmentSettings& settings = result.settings;
  if (settings.writes("mask")) {
    write_mask(path_of(plan, "mask"), result, maps);
    if (result.writes_labels()) write_text_file(path_of(plan, "labels"), label_table(result.objects));
  }
  if (settings.writes("sdf")) write_volume(path_of(plan, "sdf"), maps.distance, result.header);
  if (settings.writes("prob")) write_volume(path_of(plan, "prob"), maps.fraction, result.header);
}

void write_objects(const SegmentResult& result, const std::vector<PlannedFile>& plan) {
  const SegmentSettings& settings = result.settings;
  if (settings.output_mesh) {
    write_mesh(*settings.output_mesh, merged_mesh(result.objects), mesh_format_of_path(*settings.output_mesh));
  }
  for (const auto& object : result.objects) {
    const int label = result.writes_labels() ? object.label : 0;
    if (settings.writes("mesh")) write_mesh(path_of(plan, "mesh", label), object.mesh, settings.mesh_format);
    if (settings.writes("model")) write_model(path_of(plan, "model", label), object.surface);
    check_interrupt();
  }
}

std::vector<fs::path> input_paths(const SegmentSettings& settings) {
  std::vector<fs::path> paths{settings.input};
  if (settings.seeds_file) paths.push_back(*settings.seeds_file);
  if (settings.seed_mask) paths.push_back(parse_mask_argument(*settings.seed_mask).file);
  if (settings.seed_model) paths.push_back(*settings.seed_model);
  if (settings.points) paths.push_back(*settings.points);
  return paths;
}

std::vector<PlannedFile> checked_plan(const SegmentSettings& settings, const std::vector<int>& labels) {
  auto plan = plan_outputs(settings, labels);
  std::vector<fs::path> paths;
  paths.reserve(plan.size());
  for (const auto& file : plan) paths.push_back(file.path);
  check_outputs(paths, settings.overwrite, input_paths(settings));
  return plan;
}

std::vector<fs::path> output_folders(const SegmentSettings& settings) {
  std::vector<fs::path> folders{settings.output};
  for (const auto& file : {settings.output_mask, settings.output_mesh}) {
    if (file) folders.push_back(file->parent_path());
  }
  return folders;
}

TraceFiles trace_files(const SegmentSettings& settings) {
  return {*settings.trace, stem_of(settings), settings.mesh_format, settings.mesh_density};
}

std::vector<PlannedFile> write_traces(const SegmentResult& result) {
  const TraceFiles files = trace_files(result.settings);
  clear_trace(files);
  std::vector<PlannedFile> written;
  for (const auto& object : result.objects) {
    const int label = result.writes_labels() ? object.label : 0;
    for (const auto& path : write_trace(files, object.trace, label)) written.push_back({"trace", label, path});
  }
  return written;
}

}  // namespace

// The labels as far as they are known without reading images.
void check_before_work(const SegmentSettings& settings) {
  settings.validate();
  std::error_code ignored;
  if (!fs::exists(settings.input, ignored)) {
    throw NoInput(fmt::format("no such file (-i {}): nothing is there; check the path", settings.input.string()));
  }
  check_seed_files(settings);
  std::vector<int> labels;
  for (std::size_t i = 0; i < settings.all_seed_spheres().size(); ++i) labels.push_back(static_cast<int>(i) + 1);
  if (settings.seeds_file) {
    for (const auto& row : read_seed_table(*settings.seeds_file)) {
      labels.push_back(row.label.value_or(static_cast<int>(labels.size()) + 1));
    }
  }
  if (labels.empty() && !settings.wants_many()) labels.push_back(1);
  checked_plan(settings, labels);
  if (settings.trace) check_trace(trace_files(settings), settings.overwrite);
}

namespace {

using Hash = std::future<std::string>;

std::vector<Hash> start_hashes(const SegmentSettings& settings) {
  std::vector<Hash> hashes;
  for (const auto& path : input_paths(settings)) hashes.push_back(std::async(std::launch::async, sha256_of, path));
  return hashes;
}

void collect_hashes(const SegmentSettings& settings, std::vector<Hash>& hashes, SegmentResult& result) {
  std::vector<std::string> roles{"volume"};
  if (settings.seeds_file) roles.emplace_back("seeds");
  if (settings.seed_mask) roles.emplace_back("seed-mask");
  if (settings.seed_model) roles.emplace_back("seed-model");
  if (settings.points) roles.emplace_back("points");
  const auto paths = input_paths(settings);
  for (std::size_t i = 0; i < paths.size(); ++i) result.inputs.push_back({roles[i], paths[i], hashes[i].get()});
}

Volume read_input(const SegmentSettings& settings, const RunContext& context, SegmentResult& result) {
  Volume volume = read_volume(settings.input, {settings.spacing, result.frame});
  result.header = volume.header;
  result.nan_count = volume.nan_count;
  result.inf_count = volume.inf_count;
  result.min = volume.min;
  result.max = volume.max;
  result.warnings = volume.header.warnings;
  if (!(volume.max > volume.min) && !settings.wants_many()) {
    throw BadData(fmt::format("constant volume ({}): every voxel is {}; there is nothing to segment",
                              settings.input.string(), volume.min));
  }
  for (const auto& warning : result.warnings) {
    if (context.warn) context.warn(fmt::format("{}: {}", settings.input.string(), warning));
  }
  // Fits see one storage order only; the outputs go on the header's grid, which is the file's own.
  volume.image = in_lps_order(std::move(volume.image));
  return volume;
}

void fit_objects(const std::vector<ObjectSeed>& seeds, const ExpertPoints& points, const Image<float>& image,
                 const RunContext& context, SegmentResult& result) {
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    check_interrupt();
    PhaseClock clock;
    clock.start("fit");
    const auto progress = [&](double share, const std::string& what) {
      if (context.progress) {
        context.progress(0.1 + 0.7 * (static_cast<double>(i) + share) / static_cast<double>(seeds.size()), what);
      }
    };
    FitResult fit = fit_surface({image, seeds[i].candidates, points}, result.settings.fit,
                                {.progress = progress, .stopped = interrupt_requested});
    ObjectResult object{.label = seeds[i].label,
                        .name = seeds[i].name,
                        .surface = std::move(fit.surface),
                        .fit = std::move(fit.summary),
                        .trace = std::move(fit.trace)};
    clock.stop();
    object.seconds = clock.seconds().front().second;
    if (context.inform) {
      context.inform(fmt::format("{}: {} ({})", object.name, to_string(object.fit.status), object.fit.reason));
    }
    result.objects.push_back(std::move(object));
  }
}

void describe_outputs(const std::vector<PlannedFile>& plan, SegmentResult& result) {
  for (const auto& file : plan) {
    if (file.kind != "report") {
      result.outputs.push_back({file.kind, file.path, sha256_of(file.path), fs::file_size(file.path)});
    }
  }
}

}  // namespace

bool SegmentResult::writes_labels() const {
  return objects.size() > 1 || settings.wants_many();
}

int SegmentResult::exit_code() const {
  const bool all_ok =
      std::all_of(objects.begin(), objects.end(), [](const ObjectResult& o) { return o.fit.status == FitStatus::ok; });
  return all_ok ? 0 : 3;
}

SegmentResult segment(const SegmentSettings& settings, const RunContext& context) {
  return segment_frame(settings, context, {});
}

SegmentResult segment_frame(const SegmentSettings& settings, const RunContext& context, const FrameStart& start) {
  const ThreadLimit limit(settings.threads);
  const auto tell = [&](double share, const std::string& what) {
    if (context.inform) context.inform(what);
    if (context.progress) context.progress(share, what);
    check_interrupt();
  };
  check_before_work(settings);
  SegmentResult result;
  result.frame = start.frame;
  result.settings = settings;
  result.settings.fit.model.kind = settings.model_kind();
  PhaseClock clock;
  auto hashes = start_hashes(settings);

  clock.start("read");
  tell(0.0, "reading");
  Volume volume = read_input(settings, context, result);
  clock.start("seed");
  tell(0.08, "seeding");
  const ExpertPoints points = settings.points ? read_expert_points(settings, result.header.grid) : ExpertPoints{};
  result.settings.fit.trace_every = settings.trace ? settings.trace_every : 0;
  const auto seeds =
      start.seeds.empty() ? make_seeds(result.settings, points, result.header.grid, volume.image) : start.seeds;
  const auto files_for = [&](const auto& list) {
    std::vector<int> labels;
    labels.reserve(list.size());
    for (const auto& one : list) labels.push_back(one.label);
    auto checked = checked_plan(settings, labels);
    if (!settings.overwrite) check_outputs(stale_outputs(settings, checked), false, {});
    return checked;
  };
  auto plan = files_for(seeds);

  clock.start("fit");
  tell(0.1, "fitting");
  if (settings.wants_many()) {
    fit_many_objects(seeds, settings.writes("qc") ? volume.image : std::move(volume.image), context, result);
    plan = files_for(result.objects);
  } else {
    fit_objects(seeds, points, volume.image, context, result);
  }
  if (!settings.writes("qc")) std::vector<float>().swap(volume.image.voxels);  // memory that the maps need

  const ImageGrid& grid = result.header.grid;
  Maps maps = empty_maps(settings, grid);
  clock.start("measure");
  tell(0.8, "measuring");
  if (settings.wants_many()) {
    maps.labels = measure_many(result, grid, maps.fraction);
    if (start.relabel) {
      start.relabel(result.objects, maps.labels);
      plan = files_for(result.objects);
    }
    if (settings.writes("sdf")) maps.distance = distance_to_all(result.objects, grid);
  } else {
    for (auto& object : result.objects) {
      clock.start("measure");
      measure(object, settings, grid);
      clock.start("rasterise");
      add_to_maps(object, settings, maps);
    }
    share_out(result.objects, maps);
    tell_overlaps(context, result);
  }

  clock.start("write");
  tell(0.9, "writing");
  for (const fs::path& folder : output_folders(settings)) create_folder(folder);
  for (const auto& path : stale_outputs(settings, plan)) {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  write_maps(result, plan, maps);
  if (settings.output_mask) write_mask(*settings.output_mask, result, maps);
  write_objects(result, plan);
  if (settings.trace) {
    const auto written = write_traces(result);
    plan.insert(plan.end(), written.begin(), written.end());
  }
  if (settings.writes("qc")) {
    clock.start("picture");
    tell(0.95, "drawing");
    const auto draw = settings.wants_many() ? write_overview : write_qc_picture;
    draw(path_of(plan, "qc"), volume.image, result.objects, stem_of(settings));
  }
  if (settings.writes("convergence")) {
    write_convergence_picture(path_of(plan, "convergence"), result.objects, stem_of(settings));
  }
  clock.start("provenance");
  collect_hashes(settings, hashes, result);
  describe_outputs(plan, result);
  clock.stop();
  result.seconds = clock.seconds();
  if (settings.writes("report")) {
    write_text_file(path_of(plan, "report"), report_of(result, context).dump(2) + "\n");
  }
  if (context.progress) context.progress(1.0, "done");
  return result;
}

}  // namespace pellicle
