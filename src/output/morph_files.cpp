#include "pellicle/output/morph_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/output/outputs.h"
#include "pellicle/picture/contact_sheet.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

std::string stem_of_model(const fs::path& path) {
  std::string stem = path.stem().string();
  const std::string suffix = "_model";
  if (stem.size() > suffix.size() && stem.ends_with(suffix)) stem.resize(stem.size() - suffix.size());
  return stem;
}

fs::path file_of(const MorphSettings& settings, const std::string& suffix) {
  return settings.output / (stem_of(settings) + "_morph" + suffix);
}

std::string number_of_step(std::size_t step) {
  return fmt::format("-{:03}", step + 1);
}

/// Kind and path of every file, the report last.
std::vector<std::pair<std::string, fs::path>> planned(const MorphSettings& settings) {
  std::vector<std::pair<std::string, fs::path>> files;
  const std::string extension = "_surface" + extension_of(settings.mesh_format);
  for (std::size_t i = 0; i < static_cast<std::size_t>(settings.steps); ++i) {
    files.emplace_back("mesh", file_of(settings, number_of_step(i) + extension));
    files.emplace_back("model", file_of(settings, number_of_step(i) + "_model.json"));
  }
  files.emplace_back("table", file_of(settings, ".tsv"));
  files.emplace_back("picture", file_of(settings, ".png"));
  files.emplace_back("report", file_of(settings, ".json"));
  return files;
}

std::string caption_of(const MorphStep& step) {
  return step.status == FitStatus::ok ? fmt::format("{:.4g}", step.tau)
                                      : fmt::format("{:.4g} {}", step.tau, to_string(step.status));
}

Canvas picture_of(const MorphResult& result) {
  std::vector<SheetPanel> panels;
  panels.reserve(result.morphing.steps.size());
  for (const MorphStep& step : result.morphing.steps) panels.push_back({&step.mesh, caption_of(step)});
  const MorphSettings& s = result.settings;
  return contact_sheet(panels,
                       fmt::format("{} (0) to {} (1), {}", stem_of_model(s.a), stem_of_model(s.b), name_of(s.space)));
}

std::string table_of(const MorphResult& result) {
  std::string text = "step\ttau\tvolume_ml\tarea_mm2\tself_intersections\tstatus\n";
  for (std::size_t i = 0; i < result.morphing.steps.size(); ++i) {
    const MorphStep& s = result.morphing.steps[i];
    text += fmt::format("{}\t{}\t{}\t{:.8g}\t{}\t{}\n", i + 1, s.tau,
                        s.volume_ml ? fmt::format("{:.8g}", *s.volume_ml) : "n/a", s.area_mm2, s.self_intersections,
                        to_string(s.status));
  }
  return text;
}

void write_steps(const MorphResult& result, const Observer& observer) {
  const MorphSettings& settings = result.settings;
  const std::string extension = "_surface" + extension_of(settings.mesh_format);
  for (std::size_t i = 0; i < result.morphing.steps.size(); ++i) {
    write_mesh(file_of(settings, number_of_step(i) + extension), result.morphing.steps[i].mesh, settings.mesh_format);
    write_model(file_of(settings, number_of_step(i) + "_model.json"), result.morphing.steps[i].surface);
    observer.check_stopped();
  }
}

}  // namespace

std::string stem_of(const MorphSettings& settings) {
  if (!settings.name.empty()) return settings.name;
  return stem_of_model(settings.a) + "_to_" + stem_of_model(settings.b);
}

int MorphResult::exit_code() const {
  const bool all_ok = std::all_of(morphing.steps.begin(), morphing.steps.end(),
                                  [](const MorphStep& step) { return step.status == FitStatus::ok; });
  return all_ok ? 0 : 3;
}

MorphOptions options_of(const MorphSettings& settings) {
  return {.steps = settings.steps,
          .space = settings.space,
          .from = settings.from,
          .to = settings.to,
          .mesh_level = settings.mesh_density};
}

MorphResult morph_to_files(const MorphSettings& settings, const RunRecord& record, const Observer& observer) {
  settings.validate();
  const ThreadLimit limit(settings.threads);
  const auto begin_phase = [&observer](double fraction, const std::string& what) {
    observer.tell_progress(fraction, what);
    observer.check_stopped();
  };
  const auto files = planned(settings);
  std::vector<fs::path> paths;
  paths.reserve(files.size());
  for (const auto& [kind, path] : files) paths.push_back(path);
  check_outputs(paths, settings.overwrite, {settings.a, settings.b});

  MorphResult result;
  result.settings = settings;
  PhaseClock clock;
  clock.start("read");
  begin_phase(0.0, "reading");
  const Surface a = read_model(settings.a), b = read_model(settings.b);
  result.inputs = {{"a", settings.a, sha256_of(settings.a)}, {"b", settings.b, sha256_of(settings.b)}};
  clock.stop();
  result.morphing = morph(a, b, options_of(settings), observer.part(0.1, 0.7));
  clock.add(result.morphing.seconds);
  clock.start("write");
  begin_phase(0.7, "writing");
  create_folder(settings.output);
  write_steps(result, observer);
  write_text_file(file_of(settings, ".tsv"), table_of(result));
  clock.start("picture");
  begin_phase(0.9, "drawing");
  write_png(file_of(settings, ".png"), picture_of(result));
  clock.start("provenance");
  for (const auto& [kind, file] : files) {
    if (kind != "report") result.outputs.push_back(described(kind, file));
  }
  clock.stop();
  result.seconds = clock.seconds();
  write_text_file(file_of(settings, ".json"), report_of(result, record).dump(2) + "\n");
  observer.tell_progress(1.0, "done");
  return result;
}

}  // namespace pellicle
